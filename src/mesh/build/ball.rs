//! The points near a place, side by side in lanes, and the tangent plane that they are laid into.

use crate::math::{LANES, Lanes, tangent_frame};
use crate::spatial::LANES_OF;
use crate::spatial::tree::{Tree, unkey};
use glam::Vec3;

/// Most points of a ball.
pub(super) const MOST: usize = 64;
const BLOCKS: usize = MOST / LANES;
/// Two points are on one sheet if the sine squared of the line between them to the normal is at least this …
const MIN_FLAT: f32 = 0.2;
/// … and the line rises from one tangent plane as it sinks below the other, up to this share of its length. It tells sheets
/// that face the same way apart.
pub(super) const MAX_LIFT: f32 = 0.35;

/// The points of a tree in a box.
#[derive(Default)]
pub(super) struct Surroundings {
    index: Vec<u32>,
    /// Positions; the last lanes are infinitely far away.
    place: Vec<[Lanes; 3]>,
    /// Position and normal of each.
    point: Vec<[f32; 6]>,
}

impl Surroundings {
    /// Replaces the content by the points in the closed box from `lo` to `hi`.
    pub(super) fn gather(&mut self, tree: &Tree, normal: &[Vec3], lo: Vec3, hi: Vec3) {
        self.index.clear();
        tree.within_box(lo, hi, &mut self.index);
        self.place.clear();
        self.point.clear();
        for chunk in self.index.chunks(LANES) {
            let mut lanes = [Lanes::splat(f32::INFINITY); 3];
            for (k, &i) in chunk.iter().enumerate() {
                let (p, n) = (tree.position[i as usize], normal[i as usize]);
                (lanes[0].0[k], lanes[1].0[k], lanes[2].0[k]) = (p.x, p.y, p.z);
                self.point.push([p.x, p.y, p.z, n.x, n.y, n.z]);
            }
            self.place.push(lanes);
        }
    }
}

/// Points round a centre, in lanes. Those that are not on its sheet lie at the centre, infinitely far away.
pub(super) struct Ball {
    /// Number of points.
    count: usize,
    /// The points, by their place in the tree.
    index: [u32; MOST],
    /// Offset from the centre and normal.
    point: [[Lanes; BLOCKS]; 6],
    /// Place in the tangent plane, and the true distance, squared.
    flat: [[Lanes; BLOCKS]; 2],
    distance_sq: [Lanes; BLOCKS],
}

impl Default for Ball {
    fn default() -> Self {
        let zero = [Lanes::splat(0.0); BLOCKS];
        Self { count: 0, index: [0; MOST], point: [zero; 6], flat: [zero; 2], distance_sq: zero }
    }
}

impl Ball {
    /// Holds the points of `surroundings` nearer to `centre` than √`bound_sq`, but not `except`; whether there is room for all.
    pub(super) fn take(
        &mut self,
        surroundings: &Surroundings,
        centre: Vec3,
        bound_sq: f32,
        except: u32,
    ) -> bool {
        self.count = 0;
        let Surroundings { index, place, point } = surroundings;
        let mut hits = [0_u32; MOST + LANES];
        let mut count = 0;
        for (block, [x, y, z]) in place.iter().enumerate() {
            let dx = *x - Lanes::splat(centre.x);
            let dy = *y - Lanes::splat(centre.y);
            let dz = *z - Lanes::splat(centre.z);
            let distance_sq = dx * dx + dy * dy + dz * dz;
            let mut near = 0;
            for (lane, &distance_sq) in distance_sq.0.iter().enumerate() {
                near |= usize::from(distance_sq < bound_sq) << lane;
            }
            let lanes = &LANES_OF[near];
            for (hit, lane) in hits[count..count + LANES].iter_mut().zip(lanes.lane) {
                *hit = (block * LANES) as u32 + lane;
            }
            count += lanes.count;
            if count > MOST {
                return false;
            }
        }
        for &hit in &hits[..count] {
            let j = index[hit as usize];
            if j != except {
                let [x, y, z, a, b, c] = point[hit as usize];
                self.push(j, [x - centre.x, y - centre.y, z - centre.z, a, b, c]);
            }
        }
        true
    }

    /// Holds the points within `radius` of point `i`, or the nearest ones if those are too many; the square of the radius within
    /// which all are held.
    pub(super) fn search(&mut self, tree: &Tree, normal: &[Vec3], i: u32, radius: f32) -> f32 {
        self.count = 0;
        let centre = tree.position[i as usize];
        let mut near = Vec::new();
        let mut known_sq = radius * radius;
        if radius > 0.0 {
            tree.within_box(centre - radius, centre + radius, &mut near);
            near.retain(|&j| j != i && (tree.position[j as usize] - centre).length_squared() < known_sq);
        }
        if near.len() > MOST || radius == 0.0 {
            let mut keys = Vec::new();
            tree.nearest_many(centre, MOST, |j| j != i, &mut keys);
            known_sq = match keys.last() {
                Some(&last) if keys.len() == MOST => unkey(last).0,
                _ => f32::MAX, // Every point of the set is held.
            };
            near = keys.into_iter().map(|key| unkey(key).1).collect();
        }
        for j in near {
            let ([x, y, z], [a, b, c]) =
                ((tree.position[j as usize] - centre).to_array(), normal[j as usize].to_array());
            self.push(j, [x, y, z, a, b, c]);
        }
        known_sq
    }

    fn push(&mut self, index: u32, point: [f32; 6]) {
        let k = self.count % MOST;
        self.index[k] = index;
        for (row, value) in self.point.iter_mut().zip(point) {
            row[k / LANES].0[k % LANES] = value;
        }
        self.count = k + 1;
    }

    fn blocks(&self) -> usize {
        self.count.div_ceil(LANES).min(BLOCKS)
    }

    /// Lays the points of the centre's sheet, but those nearer than √`twin_sq`, into its tangent plane, at their true
    /// distances.
    pub(super) fn unroll(&mut self, normal: Vec3, twin_sq: f32) {
        let (u, v) = tangent_frame(normal);
        let dot = |x: Lanes, y: Lanes, z: Lanes, a: Vec3| {
            x * Lanes::splat(a.x) + y * Lanes::splat(a.y) + z * Lanes::splat(a.z)
        };
        for k in self.count..self.blocks() * LANES {
            // The facing of a zero normal is that of another sheet.
            self.point.iter_mut().for_each(|row| row[k / LANES].0[k % LANES] = 0.0);
        }
        for block in 0..self.blocks() {
            let [x, y, z, a, b, c] = &self.point;
            let (x, y, z, a, b, c) = (x[block], y[block], z[block], a[block], b[block], c[block]);
            let (along_u, along_v, rise) = (dot(x, y, z, u), dot(x, y, z, v), dot(x, y, z, normal));
            let lift = rise + (x * a + y * b + z * c);
            let facing = dot(a, b, c, normal);
            let flat_sq = along_u * along_u + along_v * along_v;
            let distance_sq = flat_sq + rise * rise;
            let stretch = (distance_sq / flat_sq).sqrt();
            let (mut flat_u, mut flat_v, mut kept) = (Lanes::default(), Lanes::default(), Lanes::default());
            for lane in 0..LANES {
                let d = distance_sq.0[lane];
                let is_near = (facing.0[lane] > 0.0)
                    & (flat_sq.0[lane] >= MIN_FLAT * d)
                    & (lift.0[lane] * lift.0[lane] <= MAX_LIFT * MAX_LIFT * d)
                    & (d > twin_sq);
                flat_u.0[lane] = if is_near { along_u.0[lane] * stretch.0[lane] } else { 0.0 };
                flat_v.0[lane] = if is_near { along_v.0[lane] * stretch.0[lane] } else { 0.0 };
                kept.0[lane] = if is_near { d } else { f32::INFINITY };
            }
            (self.flat[0][block], self.flat[1][block], self.distance_sq[block]) = (flat_u, flat_v, kept);
        }
    }

    /// The point with a number below [`MOST`], by its place in the tree.
    pub(super) fn index(&self, k: usize) -> u32 {
        self.index[k]
    }

    /// Squared distance of a point from the centre.
    pub(super) fn distance_sq(&self, k: usize) -> f32 {
        self.distance_sq[k / LANES].0[k % LANES]
    }

    /// The nearest point of the sheet.
    pub(super) fn nearest(&self) -> Option<usize> {
        let mut least = Least::default();
        for (block, &distance_sq) in self.distance_sq[..self.blocks()].iter().enumerate() {
            least.add(block, distance_sq);
        }
        least.first().map(|(_, k)| k)
    }

    /// The point after `from` in the hull of the inverted points: to its left where `side` is 1, to its right where it is −1; and
    /// the square of the diameter of the circle through both and the centre. None, and infinite, if there is none within half a
    /// turn.
    pub(super) fn next(&self, from: usize, side: f32) -> (Option<usize>, f32) {
        let [u, v] = self.flat(from);
        let (along_u, along_v) = (Lanes::splat(u), Lanes::splat(v));
        let (aside_u, aside_v) = (Lanes::splat(side * u), Lanes::splat(side * v));
        let mut least = Least::default();
        for block in 0..self.blocks() {
            let (x, y) = (self.flat[0][block], self.flat[1][block]);
            let cross = aside_u * y - aside_v * x;
            // The cotangent of the angle at the point over the chord from the centre to `from`: the circle's centre is half
            // that many chords away from the chord.
            let cotangent = (self.distance_sq[block] - (along_u * x + along_v * y)) / cross;
            least.add(block, cross.zip(cotangent, |cross, c| if cross > 0.0 { c } else { f32::INFINITY }));
        }
        let found = least.first();
        let cotangent = found.map_or(f32::INFINITY, |(cotangent, _)| cotangent);
        (found.map(|(_, k)| k), self.distance_sq(from) * (1.0 + cotangent * cotangent))
    }

    fn flat(&self, k: usize) -> [f32; 2] {
        [self.flat[0][k / LANES].0[k % LANES], self.flat[1][k / LANES].0[k % LANES]]
    }

    /// Whether the direction of `k` lies strictly between those of `a` and `b`, which are less than half a turn apart,
    /// counter-clockwise.
    pub(super) fn is_between(&self, a: usize, k: usize, b: usize) -> bool {
        let cross = |[ax, ay]: [f32; 2], [bx, by]: [f32; 2]| ax * by - ay * bx;
        let middle = self.flat(k);
        cross(self.flat(a), middle) > 0.0 && cross(middle, self.flat(b)) > 0.0
    }

    /// Whether a point before `i` in the tree is nearer to the centre than √`twin_sq`, or there.
    pub(super) fn has_earlier_twin(&self, i: u32, twin_sq: f32) -> bool {
        let [x, y, z, ..] = &self.point;
        (0..self.count).any(|k| {
            let (block, lane) = (k / LANES, k % LANES);
            let offset = Vec3::new(x[block].0[lane], y[block].0[lane], z[block].0[lane]);
            self.index[k] < i && offset.length_squared() <= twin_sq
        })
    }
}

/// The least of many numbers, lane by lane, and where it was.
struct Least {
    value: Lanes,
    block: [u32; LANES],
}

impl Default for Least {
    fn default() -> Self {
        Self { value: Lanes::splat(f32::INFINITY), block: [0; LANES] }
    }
}

impl Least {
    fn add(&mut self, block: usize, value: Lanes) {
        for (lane, least_block) in self.block.iter_mut().enumerate() {
            let is_less = value.0[lane] < self.value.0[lane];
            self.value.0[lane] = if is_less { value.0[lane] } else { self.value.0[lane] };
            *least_block = if is_less { block as u32 } else { *least_block };
        }
    }

    /// The least number and its place over all lanes, the first lane's if there are several; none if none is finite.
    fn first(&self) -> Option<(f32, usize)> {
        let mut first = (f32::INFINITY, 0);
        for (lane, (&value, &block)) in self.value.0.iter().zip(&self.block).enumerate() {
            if value < first.0 {
                first = (value, block as usize * LANES + lane);
            }
        }
        (first.0 < f32::INFINITY).then_some(first)
    }
}
