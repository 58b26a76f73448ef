//! The points near a place, side by side in lanes, and their places in its tangent plane.

use super::StarPoints;
use crate::math::{LANES, Lanes, tangent_frame, unkey};
use crate::spatial::LANES_OF;
use crate::spatial::tree::{PointsInBox, Tree};
use glam::{Vec3, Vec4};

/// Largest number of points in a ball, and of neighbours of a point, if holes do not matter. In a
/// hexagonal lattice the first ball that is searched holds some 18.
pub(super) const NEAR: usize = 64;
/// Largest number of points in a ball. Fewer leave more points without their neighbours across a
/// hole.
pub(super) const MOST: usize = 256;
/// Numbers that are processed at once: the lanes of a SIMD register.
const WIDTH: usize = 4;
/// Two points are on one sheet only if the squared sine of the angle between their line and the
/// normal is at least this: the line rises by 63° at most.
pub(super) const MIN_FLAT: f32 = 0.2;
/// Two points are on one sheet only if their line rises from one tangent plane as it sinks below
/// the other, up to this share of its length: that separates sheets that face the same way.
/// Smaller: more particles are in no triangle; larger: a surface that crosses itself gets holes.
pub(crate) const MAX_LIFT: f32 = 0.35;

/// Two points are collinear with the centre if the sine of the angle between them is at most this.
/// Rounding in single precision turns the line between two points by 6·10⁻⁸ times their coordinates
/// over their distance: this is enough up to a thousand spacings from the origin. The circle
/// through three such points is 10⁴ times as wide as they are apart, so no triangle of a mesh is
/// lost.
const COLLINEAR: f32 = 1e-4;

/// The points of a tree in a box, with their normals.
#[derive(Default)]
pub(super) struct BallPoints {
    near: PointsInBox,
    /// Position and normal of each point.
    point: Vec<[f32; 6]>,
}

impl BallPoints {
    /// Replaces the content by the points in the closed box from `lo` to `hi`.
    pub(super) fn gather(&mut self, tree: &Tree, normal: &[Vec3], lo: Vec3, hi: Vec3) {
        self.near.gather(tree, lo, hi);
        self.point.clear();
        self.point.extend(self.near.index.iter().map(|&i| {
            let (p, n) = (tree.position[i as usize], normal[i as usize]);
            [p.x, p.y, p.z, n.x, n.y, n.z]
        }));
    }
}

/// A column with a number for each point of a ball.
type PerPoint = [f32; MOST];

/// Four numbers of a row.
fn four(row: &PerPoint, block: usize) -> Vec4 {
    Vec4::from_array(row.as_chunks().0[block])
}

/// Points around a centre, in blocks of four. Points on another sheet are put at the centre,
/// infinitely far away.
pub(super) struct Ball {
    /// Number of points.
    count: usize,
    /// The points, by their indices in the tree.
    index: [u32; MOST],
    /// Offset from the centre and normal.
    point: [PerPoint; 6],
    /// Place in the tangent plane, and the true distance, squared.
    flat: [PerPoint; 2],
    distance_sq: PerPoint,
    /// Squared distance of the nearest point, whatever its sheet.
    nearest_sq: f32,
    /// Whether a point faces another way than the centre.
    faces_another: bool,
}

impl Default for Ball {
    fn default() -> Self {
        let zero = [0.0; MOST];
        Self {
            count: 0,
            index: [0; MOST],
            point: [zero; 6],
            flat: [zero; 2],
            distance_sq: zero,
            nearest_sq: f32::INFINITY,
            faces_another: false,
        }
    }
}

impl Ball {
    /// Takes the points of `surroundings` nearer to `centre` than √`bound_sq`, but not `except`.
    /// Returns whether there is room for all.
    pub(super) fn take(
        &mut self,
        surroundings: &BallPoints,
        centre: Vec3,
        bound_sq: f32,
        except: u32,
    ) -> bool {
        self.count = 0;
        let BallPoints { near: PointsInBox { index, position }, point } = surroundings;
        let mut hits = [0_u32; NEAR + LANES];
        let mut count = 0;
        let bound_sq = Vec4::splat(bound_sq);
        for (block, [x, y, z]) in position.iter().enumerate() {
            let near = |first: usize| {
                let offset = |row: &Lanes, c: f32| Vec4::from_slice(&row.0[first..first + WIDTH]) - c;
                let (dx, dy, dz) = (offset(x, centre.x), offset(y, centre.y), offset(z, centre.z));
                (dx * dx + dy * dy + dz * dz).cmplt(bound_sq).bitmask()
            };
            let near = (near(0) | near(WIDTH) << WIDTH) as usize & 0xff;
            let lanes = &LANES_OF[near];
            for (hit, lane) in hits[count..count + LANES].iter_mut().zip(lanes.lane) {
                *hit = (block * LANES) as u32 + lane;
            }
            count += lanes.count;
            if count > NEAR {
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

    /// Takes the points within `radius` of point `i`, or the `most` nearest ones if there are more.
    /// Returns the squared radius within which all are held.
    pub(super) fn search(
        &mut self,
        &StarPoints { tree, normal, .. }: &StarPoints<'_>,
        i: u32,
        radius: f32,
        most: usize,
    ) -> f32 {
        self.count = 0;
        let centre = tree.position[i as usize];
        let mut near = Vec::new();
        let mut known_sq = radius * radius;
        if radius > 0.0 {
            tree.within_box(centre - radius, centre + radius, &mut near);
            near.retain(|&j| j != i && (tree.position[j as usize] - centre).length_squared() < known_sq);
        }
        if near.len() > most || radius == 0.0 {
            let mut keys = Vec::new();
            tree.nearest_many(centre, most, |j| j != i, &mut keys);
            known_sq = match keys.last() {
                Some(&last) if keys.len() == most => unkey(last).0,
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
            row[k] = value;
        }
        self.count = k + 1;
    }

    /// If the centre `is_tip` of a cone, lays the points that face the same way into its tangent
    /// plane, with the normal `normal`; else gives that normal to the `tips` among the points,
    /// which see the centre far above their own plane.
    pub(super) fn level(&mut self, tips: &[u32], normal: Vec3, is_tip: bool) {
        if tips.is_empty() {
            return;
        }
        for k in 0..self.count.min(MOST) {
            let [x, y, z, a, b, c] = self.point.each_ref().map(|row| row[k]);
            let (offset, other) = (Vec3::new(x, y, z), Vec3::new(a, b, c));
            if other.dot(normal) <= 0.0 || !(is_tip || tips.binary_search(&self.index[k]).is_ok()) {
                continue;
            }
            let flat = (offset - normal * offset.dot(normal)).normalize_or_zero() * offset.length();
            let laid = if is_tip { flat } else { offset };
            for (row, value) in
                self.point.iter_mut().zip(laid.to_array().into_iter().chain(normal.to_array()))
            {
                row[k] = value;
            }
        }
    }

    fn blocks(&self) -> usize {
        self.count.div_ceil(WIDTH)
    }

    /// Lays the points of the centre's sheet, except those nearer than √`twin_sq`, into its tangent
    /// plane, at their true distances.
    pub(super) fn unroll(&mut self, normal: Vec3, twin_sq: f32) {
        let (u, v) = tangent_frame(normal);
        let dot = |x: Vec4, y: Vec4, z: Vec4, a: Vec3| x * a.x + y * a.y + z * a.z;
        let padding = self.count..self.blocks() * WIDTH;
        // Far away, and on no sheet.
        for (row, value) in self.point.iter_mut().zip([f32::MAX, 0.0, 0.0, 0.0, 0.0, 0.0]) {
            row[padding.clone()].fill(value);
        }
        let mut nearest_sq = Vec4::INFINITY;
        self.faces_another = false;
        for block in 0..self.blocks() {
            let [x, y, z, a, b, c] = &self.point;
            let [x, y, z, a, b, c] = [x, y, z, a, b, c].map(|row| four(row, block));
            let (along_u, along_v, rise) = (dot(x, y, z, u), dot(x, y, z, v), dot(x, y, z, normal));
            let lift = rise + (x * a + y * b + z * c);
            let flat_sq = along_u * along_u + along_v * along_v;
            let distance_sq = flat_sq + rise * rise;
            nearest_sq = nearest_sq.min(x * x + y * y + z * z);
            let cosine = dot(a, b, c, normal);
            self.faces_another |= cosine.cmplt(Vec4::ZERO).any();
            let stretch = Vec4::from_array((distance_sq / flat_sq).to_array().map(f32::sqrt));
            let is_near = cosine.cmpgt(Vec4::ZERO)
                & flat_sq.cmpge(distance_sq * MIN_FLAT)
                & (lift * lift).cmple(distance_sq * (MAX_LIFT * MAX_LIFT))
                & distance_sq.cmpgt(Vec4::splat(twin_sq));
            let kept = |value: Vec4, other: Vec4| Vec4::select(is_near, value, other).to_array();
            self.flat[0].as_chunks_mut().0[block] = kept(along_u * stretch, Vec4::ZERO);
            self.flat[1].as_chunks_mut().0[block] = kept(along_v * stretch, Vec4::ZERO);
            self.distance_sq.as_chunks_mut().0[block] = kept(distance_sq, Vec4::INFINITY);
        }
        self.nearest_sq = nearest_sq.min_element();
    }

    /// Number of points.
    pub(super) fn len(&self) -> usize {
        self.count
    }

    /// The point with a number below [`MOST`], by its index in the tree.
    pub(super) fn index(&self, k: usize) -> u32 {
        self.index[k]
    }

    /// The points, by their indices in the tree.
    pub(super) fn indices(&self) -> impl Iterator<Item = u32> {
        self.index[..self.count].iter().copied()
    }

    /// Whether a point faces another way than the centre.
    pub(super) fn faces_another(&self) -> bool {
        self.faces_another
    }

    /// Distance of the nearest point, on any sheet; infinite if there is none.
    pub(super) fn nearest_of_all(&self) -> f32 {
        self.nearest_sq.sqrt()
    }

    /// Removes a point from the sheet of the centre.
    pub(super) fn leave_out(&mut self, k: usize) {
        (self.flat[0][k], self.flat[1][k], self.distance_sq[k]) = (0.0, 0.0, f32::INFINITY);
    }

    /// Squared distance of a point from the centre.
    pub(super) fn distance_sq(&self, k: usize) -> f32 {
        self.distance_sq[k]
    }

    /// The nearest point of the sheet.
    pub(super) fn nearest(&self) -> Option<usize> {
        self.least(|block| four(&self.distance_sq, block)).map(|(_, k)| k)
    }

    /// The point after `from` in the hull of the inverted points: on its left if `side` is 1, on
    /// its right if it is −1; and the squared diameter of the circle through both and the centre.
    /// None, and infinite, if there is none within half a turn, up to [`COLLINEAR`].
    pub(super) fn next(&self, from: usize, side: f32) -> (Option<usize>, f32) {
        let [u, v] = self.flat(from);
        let over_from_sq = self.distance_sq(from).recip();
        let found = self.least(|block| {
            let [x, y] = [&self.flat[0], &self.flat[1]].map(|row| four(row, block));
            let distance_sq = four(&self.distance_sq, block);
            let cross = y * (side * u) - x * (side * v);
            // The cotangent of the angle at the point over the chord from the centre to `from`: the
            // circle's centre is half that many chords away from the chord.
            let cotangent = (distance_sq - (x * u + y * v)) / cross;
            // The squared sine is at most one: no product of two small numbers is rounded to zero.
            let is_beside = cross.cmpgt(Vec4::ZERO)
                & ((cross * over_from_sq) * cross).cmpgt(distance_sq * (COLLINEAR * COLLINEAR));
            Vec4::select(is_beside, cotangent, Vec4::INFINITY)
        });
        let cotangent = found.map_or(f32::INFINITY, |(cotangent, _)| cotangent);
        (found.map(|(_, k)| k), self.distance_sq(from) * (1.0 + cotangent * cotangent))
    }

    /// The least of the numbers of the points, and the first point that has it; none if no number
    /// is finite.
    #[inline]
    fn least(&self, numbers: impl Fn(usize) -> Vec4) -> Option<(f32, usize)> {
        // For each lane, and the block in which it was first found.
        let (mut least, mut met_in) = (Vec4::INFINITY, Vec4::ZERO);
        for block in 0..self.blocks() {
            let value = numbers(block);
            let is_less = value.cmplt(least);
            least = Vec4::select(is_less, value, least);
            met_in = Vec4::select(is_less, Vec4::splat(block as f32), met_in);
        }
        let value = least.min_element();
        let lanes = (0..WIDTH).filter(|&lane| least[lane] == value);
        let first = lanes.map(|lane| WIDTH * met_in[lane] as usize + lane).min();
        first.filter(|_| value < f32::INFINITY).map(|first| (value, first))
    }

    /// Cotangent of the angle at the point `at`, opposite the chord from the centre to `end`.
    pub(super) fn cotangent(&self, end: usize, at: usize) -> f32 {
        let ([u, v], [x, y]) = (self.flat(end), self.flat(at));
        (self.distance_sq[at] - (x * u + y * v)) / (x * v - y * u).abs()
    }

    fn flat(&self, k: usize) -> [f32; 2] {
        [self.flat[0][k], self.flat[1][k]]
    }

    /// Whether the direction of `k` lies strictly between those of `a` and `b`, counter-clockwise,
    /// which are less than half a turn apart.
    pub(super) fn is_between(&self, a: usize, k: usize, b: usize) -> bool {
        let cross = |[ax, ay]: [f32; 2], [bx, by]: [f32; 2]| ax * by - ay * bx;
        let middle = self.flat(k);
        cross(self.flat(a), middle) > 0.0 && cross(middle, self.flat(b)) > 0.0
    }

    /// Whether an earlier point of the tree than `i` is nearer to the centre than √`twin_sq`, or
    /// there.
    pub(super) fn has_earlier_twin(&self, i: u32, twin_sq: f32) -> bool {
        if self.nearest_sq > twin_sq {
            return false;
        }
        let [x, y, z, ..] = &self.point;
        (0..self.count).any(|k| self.index[k] < i && Vec3::new(x[k], y[k], z[k]).length_squared() <= twin_sq)
    }
}
