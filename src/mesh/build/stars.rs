//! The natural neighbours of every point, counter-clockwise round its normal, in single precision.
//!
//! The points of the same sheet are unrolled to the tangent plane of a point, keeping their true distance. The point's
//! neighbours in the Delaunay triangulation there are found one after the other, from the nearest one on: the next
//! neighbour is the point to the left whose circle through the centre and the last neighbour is the smallest on that side.

use crate::math::{LANES, Lanes, sort_few, tangent_frame};
use crate::spatial::tree::{Tree, unkey};
use core::ops::Range;
use glam::Vec3;

/// Radius of the first ball that is searched, over the diagonal of the leaf's box: a leaf of 8 to 16 points of spacing d
/// spans 3 to 5 d, so the ball reaches about 2 d.
const BALL: f32 = 0.45;
/// Most points of a ball.
const MOST: usize = 64;
const BLOCKS: usize = MOST / LANES;
/// Most neighbours of a point; one with more gets none.
const MOST_NEIGHBOURS: usize = 32;
/// Two points are on one sheet if the sine squared of the line between them to the normal is at least this …
const MIN_FLAT: f32 = 0.2;
/// … and the line rises from one tangent plane as it sinks below the other, up to this share of its length. It tells sheets
/// that face the same way apart.
pub(super) const MAX_LIFT: f32 = 0.35;
/// Largest circumradius of a triangle, in units of the spacing at the corner.
pub(super) const WIDEST: f32 = 2.0;
/// Points nearer than this share of the ball's radius are one point.
const TWIN: f32 = 1e-5;
/// No neighbour.
const NONE: usize = usize::MAX;
/// Marks, in [`Stars::entry`], that the triangle with this neighbour and the next one is narrow enough to be one of the mesh.
const WEDGE: u32 = 1 << 31;

/// Natural neighbours in tree order, all stars one after the other.
#[derive(Debug)]
pub(super) struct Stars {
    start: Vec<u32>,
    entry: Vec<u32>,
    /// Median distance of the neighbours.
    pub(super) spacing: Vec<f32>,
    /// Whether the star has a gap: two neighbours in a row without a triangle between them.
    pub(super) is_open: Vec<bool>,
    /// Points at the place of an earlier one.
    pub(super) twins: Vec<u32>,
}

/// The points near a leaf.
#[derive(Default)]
struct Surroundings {
    index: Vec<u32>,
    place: Vec<[Lanes; 3]>,
}

/// Points round a centre, in lanes. Those that do not count lie at the centre, infinitely far away.
struct Ball {
    index: [u32; MOST],
    offset: [[Lanes; BLOCKS]; 3],
    normal: [[Lanes; BLOCKS]; 3],
    flat: [[Lanes; BLOCKS]; 2],
    distance_sq: [Lanes; BLOCKS],
    count: usize,
}

/// What is used again from leaf to leaf.
#[derive(Default)]
struct Scratch {
    surroundings: Surroundings,
    ball: Ball,
    star: Star,
}

/// A star under construction: neighbours with the squares of the widths of the wedges after them, the diameters of the circles through
/// the centre, the neighbour and the next one.
#[derive(Default)]
struct Star {
    neighbours: Vec<(usize, f32)>,
    before: Vec<(usize, f32)>,
}

impl Stars {
    /// The stars of the points of `tree` with the unit `normal`s (in tree order).
    pub(super) fn new(tree: &Tree, normal: &[Vec3]) -> Self {
        let n = tree.len();
        let mut stars = Self {
            start: Vec::with_capacity(n + 1),
            entry: Vec::with_capacity(6 * n + n / 4),
            spacing: Vec::with_capacity(n),
            is_open: Vec::with_capacity(n),
            twins: Vec::new(),
        };
        stars.start.push(0);
        let mut scratch = Scratch::default();
        for (range, lo, hi) in tree.leaves() {
            if lo == hi && range.len() > 1 {
                stars.add_twins(range);
                continue;
            }
            let reach = BALL * (hi - lo).length();
            scratch.surroundings.gather(tree, lo - reach, hi + reach);
            range.for_each(|i| stars.add(tree, normal, i, reach, &mut scratch));
        }
        stars
    }

    /// Adds the points of a leaf that are all at one place.
    fn add_twins(&mut self, range: Range<usize>) {
        self.twins.extend(range.start as u32 + 1..range.end as u32);
        for _ in range {
            self.spacing.push(0.0);
            self.is_open.push(true);
            self.start.push(self.entry.len() as u32);
        }
    }

    /// Adds the star of point `i`, of a leaf whose surroundings reach as far as told.
    fn add(&mut self, tree: &Tree, normal: &[Vec3], i: usize, reach: f32, scratch: &mut Scratch) {
        let Scratch { surroundings, ball, star } = scratch;
        let centre = tree.position[i];
        let reach_sq = reach * reach;
        ball.count = 0;
        let mut known_sq = if surroundings.within(centre, reach_sq, i as u32, ball) { reach_sq } else { 0.0 };
        let mut spacing = star.make(ball, normal, i, known_sq);
        // What may be narrow enough to matter lies within this.
        let wanted = 2.0 * WIDEST * spacing;
        if spacing == 0.0 || known_sq < wanted * wanted && !star.is_certain(known_sq) {
            known_sq = ball.search(tree, centre, i as u32, wanted);
            spacing = star.make(ball, normal, i, known_sq);
        }
        self.push(i, ball, star, spacing, known_sq);
    }

    fn push(&mut self, i: usize, ball: &Ball, star: &Star, spacing: f32, known_sq: f32) {
        if ball.has_earlier_twin(i as u32, TWIN * TWIN * known_sq) {
            self.twins.push(i as u32);
        }
        let widest = 2.0 * WIDEST * spacing;
        let widest_sq = (widest * widest).min(known_sq);
        let mut is_open = star.neighbours.is_empty();
        for &(k, width_sq) in &star.neighbours {
            let is_narrow = width_sq <= widest_sq;
            is_open |= !is_narrow;
            self.entry.push(ball.index[k] | if is_narrow { WEDGE } else { 0 });
        }
        self.spacing.push(spacing);
        self.is_open.push(is_open);
        self.start.push(self.entry.len() as u32);
    }

    /// Number of points.
    pub(super) fn len(&self) -> usize {
        self.spacing.len()
    }

    /// Where the entries of `i` are.
    pub(super) fn range(&self, i: usize) -> Range<usize> {
        self.start[i] as usize..self.start[i + 1] as usize
    }

    /// Number of entries.
    pub(super) fn entry_count(&self) -> usize {
        self.entry.len()
    }

    /// The neighbour of an entry.
    pub(super) fn neighbour(&self, entry: usize) -> u32 {
        self.entry[entry] & !WEDGE
    }

    /// The entry of `i` that holds `a`, if `b` is the next one and makes a triangle with it.
    pub(super) fn entry(&self, i: u32, a: u32, b: u32) -> Option<usize> {
        let range = self.range(i as usize);
        range.clone().find(|&entry| self.entry[entry] == a | WEDGE && self.next(&range, entry) == Some(b))
    }

    /// The next neighbour of `i`, if it makes a triangle with that of `entry`.
    pub(super) fn next(&self, range: &Range<usize>, entry: usize) -> Option<u32> {
        let next = if entry + 1 == range.end { range.start } else { entry + 1 };
        (self.entry[entry] & WEDGE != 0).then(|| self.neighbour(next))
    }
}

impl Surroundings {
    fn gather(&mut self, tree: &Tree, lo: Vec3, hi: Vec3) {
        self.index.clear();
        tree.within_box(lo, hi, &mut self.index);
        self.place.clear();
        self.place.extend(self.index.chunks(LANES).map(|chunk| {
            let mut lanes = [Lanes::splat(f32::INFINITY); 3];
            for (k, &i) in chunk.iter().enumerate() {
                let p = tree.position[i as usize];
                (lanes[0].0[k], lanes[1].0[k], lanes[2].0[k]) = (p.x, p.y, p.z);
            }
            lanes
        }));
    }

    /// Adds every point but `except` nearer to `centre` than √`bound_sq` to the ball; whether there was room for all.
    fn within(&self, centre: Vec3, bound_sq: f32, except: u32, ball: &mut Ball) -> bool {
        for ([x, y, z], index) in self.place.iter().zip(self.index.chunks(LANES)) {
            let dx = *x - Lanes::splat(centre.x);
            let dy = *y - Lanes::splat(centre.y);
            let dz = *z - Lanes::splat(centre.z);
            let distance_sq = dx * dx + dy * dy + dz * dz;
            for (k, &j) in index.iter().enumerate() {
                if distance_sq.0[k] < bound_sq && j != except {
                    if ball.count == MOST {
                        return false;
                    }
                    ball.push(j, Vec3::new(dx.0[k], dy.0[k], dz.0[k]));
                }
            }
        }
        true
    }
}

impl Default for Ball {
    fn default() -> Self {
        Self {
            index: [0; MOST],
            offset: [[Lanes::splat(0.0); BLOCKS]; 3],
            normal: [[Lanes::splat(0.0); BLOCKS]; 3],
            flat: [[Lanes::splat(0.0); BLOCKS]; 2],
            distance_sq: [Lanes::splat(0.0); BLOCKS],
            count: 0,
        }
    }
}

impl Ball {
    fn push(&mut self, index: u32, offset: Vec3) {
        let (block, lane) = (self.count / LANES, self.count % LANES);
        self.index[self.count] = index;
        for (row, c) in self.offset.iter_mut().zip(offset.to_array()) {
            row[block].0[lane] = c;
        }
        self.count += 1;
    }

    /// Holds the points within `radius`, or the nearest ones if those are too many; the square of the radius within which
    /// all are held.
    fn search(&mut self, tree: &Tree, centre: Vec3, except: u32, radius: f32) -> f32 {
        self.count = 0;
        let mut near = Vec::new();
        if radius > 0.0 {
            tree.within_box(centre - radius, centre + radius, &mut near);
            let bound_sq = radius * radius;
            let near = near.iter().map(|&j| (j, tree.position[j as usize] - centre));
            let within = |&(j, offset): &(u32, Vec3)| j != except && offset.length_squared() < bound_sq;
            if near.clone().filter(within).count() <= MOST {
                near.filter(within).for_each(|(j, offset)| self.push(j, offset));
                return bound_sq;
            }
        }
        let mut keys = Vec::new();
        tree.nearest_many(centre, MOST, |j| j != except, &mut keys);
        for &key in &keys {
            let j = unkey(key).1;
            self.push(j, tree.position[j as usize] - centre);
        }
        match keys.last() {
            Some(&last) if keys.len() == MOST => unkey(last).0,
            _ => f32::MAX, // Every point of the set is held.
        }
    }

    fn blocks(&self) -> usize {
        self.count.div_ceil(LANES)
    }

    fn load_normals(&mut self, normal: &[Vec3]) {
        for k in 0..self.count {
            let n = normal[self.index[k] as usize];
            let (block, lane) = (k / LANES, k % LANES);
            for (row, c) in self.normal.iter_mut().zip(n.to_array()) {
                row[block].0[lane] = c;
            }
        }
        for k in self.count..self.blocks() * LANES {
            let (block, lane) = (k / LANES, k % LANES);
            for c in 0..3 {
                self.offset[c][block].0[lane] = 0.0;
                self.normal[c][block].0[lane] = 0.0;
            }
        }
    }

    /// Lays the points of the centre's sheet into its tangent plane, at their true distances.
    fn unroll(&mut self, normal: Vec3, twin_sq: f32) {
        let (u, v) = tangent_frame(normal);
        let dot = |[x, y, z]: [Lanes; 3], a: Vec3| {
            x * Lanes::splat(a.x) + y * Lanes::splat(a.y) + z * Lanes::splat(a.z)
        };
        for block in 0..self.blocks() {
            let o = self.offset.map(|row| row[block]);
            let m = self.normal.map(|row| row[block]);
            let (x, y, rise) = (dot(o, u), dot(o, v), dot(o, normal));
            let lift = rise + (o[0] * m[0] + o[1] * m[1] + o[2] * m[2]);
            let facing = dot(m, normal);
            let flat_sq = x * x + y * y;
            let distance_sq = flat_sq + rise * rise;
            let stretch = (distance_sq / flat_sq).sqrt();
            for lane in 0..LANES {
                let d = distance_sq.0[lane];
                let lift = lift.0[lane];
                let is_near = facing.0[lane] > 0.0
                    && flat_sq.0[lane] >= MIN_FLAT * d
                    && lift * lift <= MAX_LIFT * MAX_LIFT * d
                    && d > twin_sq;
                self.flat[0][block].0[lane] = if is_near { x.0[lane] * stretch.0[lane] } else { 0.0 };
                self.flat[1][block].0[lane] = if is_near { y.0[lane] * stretch.0[lane] } else { 0.0 };
                self.distance_sq[block].0[lane] = if is_near { d } else { f32::INFINITY };
            }
        }
    }

    fn distance_sq(&self, k: usize) -> f32 {
        self.distance_sq[k / LANES].0[k % LANES]
    }

    fn flat(&self, k: usize) -> [f32; 2] {
        self.flat.map(|row| row[k / LANES].0[k % LANES])
    }

    /// The nearest point of the sheet.
    fn nearest(&self) -> usize {
        let mut best = (f32::INFINITY, NONE);
        for k in 0..self.count {
            if self.distance_sq(k) < best.0 {
                best = (self.distance_sq(k), k);
            }
        }
        best.1
    }

    /// The neighbour after `from`: to its left where `side` is 1, to its right where it is −1; and the square of the width
    /// of the wedge between the two. None and infinite if there is none within half a turn.
    fn next(&self, from: usize, side: f32) -> (usize, f32) {
        let [u, v] = self.flat(from);
        let (sideways, v_sided) = (Lanes::splat(side * u), Lanes::splat(side * v));
        let mut best = Lanes::splat(f32::INFINITY);
        let mut best_block = [0_u32; LANES];
        for block in 0..self.blocks() {
            let (x, y) = (self.flat[0][block], self.flat[1][block]);
            let cross = sideways * y - v_sided * x;
            let excess = self.distance_sq[block] - (Lanes::splat(u) * x + Lanes::splat(v) * y);
            let along = excess / cross;
            for (lane, best_block) in best_block.iter_mut().enumerate() {
                let is_better = cross.0[lane] > 0.0 && along.0[lane] < best.0[lane];
                best.0[lane] = if is_better { along.0[lane] } else { best.0[lane] };
                *best_block = if is_better { block as u32 } else { *best_block };
            }
        }
        let mut least = (f32::INFINITY, NONE);
        for (lane, (&along, &block)) in best.0.iter().zip(&best_block).enumerate() {
            if along < least.0 {
                least = (along, block as usize * LANES + lane);
            }
        }
        (least.1, self.distance_sq(from) * (1.0 + least.0 * least.0))
    }

    /// Whether the direction of `k` lies strictly between those of `a` and `b`, which are less than half a turn apart,
    /// counter-clockwise.
    fn is_between(&self, a: usize, k: usize, b: usize) -> bool {
        let cross = |[ax, ay]: [f32; 2], [bx, by]: [f32; 2]| ax * by - ay * bx;
        let middle = self.flat(k);
        cross(self.flat(a), middle) > 0.0 && cross(middle, self.flat(b)) > 0.0
    }

    fn has_earlier_twin(&self, i: u32, twin_sq: f32) -> bool {
        (0..self.count).any(|k| {
            let offset = self.offset.map(|row| row[k / LANES].0[k % LANES]);
            self.index[k] < i && Vec3::from_array(offset).length_squared() <= twin_sq
        })
    }
}

impl Star {
    /// The star of point `i` among the points of the ball, which are all within √`known_sq`; the spacing.
    fn make(&mut self, ball: &mut Ball, normal: &[Vec3], i: usize, known_sq: f32) -> f32 {
        ball.load_normals(normal);
        ball.unroll(normal[i], TWIN * TWIN * known_sq);
        self.walk(ball);
        self.spacing(ball)
    }

    /// Finds the neighbours of the centre.
    fn walk(&mut self, ball: &Ball) {
        self.neighbours.clear();
        let first = ball.nearest();
        if first == NONE {
            return;
        }
        let mut k = first;
        loop {
            let (mut next, width_sq) = ball.next(k, 1.0);
            if next != NONE && k != first && ball.is_between(k, first, next) {
                next = first; // Rounding has led past the first one.
            }
            self.neighbours.push((k, width_sq));
            if next == first {
                return;
            }
            if next == NONE {
                break;
            }
            if self.neighbours.len() == MOST_NEIGHBOURS {
                self.neighbours.clear();
                return;
            }
            k = next;
        }
        // Nothing follows the last one: go on at the other side of the first.
        self.before.clear();
        k = first;
        loop {
            let (next, width_sq) = ball.next(k, -1.0);
            if next == NONE {
                break;
            }
            if self.neighbours.len() + self.before.len() == MOST_NEIGHBOURS {
                self.neighbours.clear();
                return;
            }
            self.before.push((next, width_sq));
            k = next;
        }
        self.before.reverse();
        self.before.append(&mut self.neighbours);
        core::mem::swap(&mut self.neighbours, &mut self.before);
    }

    /// Whether no point farther than √`known_sq` can matter.
    fn is_certain(&self, known_sq: f32) -> bool {
        self.neighbours.iter().all(|&(_, width_sq)| width_sq <= known_sq)
    }

    /// The median distance of the neighbours; 0 if there is none.
    fn spacing(&self, ball: &Ball) -> f32 {
        let mut lengths = [0.0; MOST_NEIGHBOURS];
        let count = self.neighbours.len();
        for (length, &(k, _)) in lengths.iter_mut().zip(&self.neighbours) {
            *length = ball.distance_sq(k);
        }
        sort_few(&mut lengths[..count], |a, b| a < b);
        lengths[count.saturating_sub(1) / 2].sqrt()
    }
}
