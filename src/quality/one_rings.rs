//! One-rings: the natural neighbours of every point, counter-clockwise around its normal.

use super::cell::{MOST_POINTS, VoronoiCell};
use super::sheets::Sheets;
use crate::field::Evaluator;
use crate::math::{LANES, Lanes, key, tangent_frame, unkey};
use crate::slices::pause;
use crate::spatial::LANES_OF;
use crate::spatial::tree::{Leaf, PointsInBox, Tree};
use glam::{DVec2, DVec3, Vec3, Vec4};

/// Largest height of one point over the other's tangent plane, as the mean of both heights over the
/// distance, if the two are on one sheet. On a smooth surface the two heights cancel to second
/// order in the distance over the radius of curvature: the mean is 1/12 where the curvature changes
/// by its own size between the points. Smaller: more edges stay open beside creases, cone points
/// and near sheets.
const MAX_LIFT: f32 = 0.2;
/// The square of twice [`MAX_LIFT`], for the sum of both heights.
const LEVEL: f32 = (2.0 * MAX_LIFT) * (2.0 * MAX_LIFT);
/// Points up to this distance, squared and in units of that of the nearest one, are sorted first:
/// in an even sample they are those that bound the cell. Smaller or larger: more are sorted.
const FIRST_SQ: f32 = 2.5;
/// Marks, in [`OneRings::neighbour`], that the Voronoi corner between this neighbour and the next
/// one is proven.
const PROVEN: u32 = 1 << 31;

/// The one-rings of all points in tree order, one after the other.
#[derive(Debug)]
pub(super) struct OneRings {
    /// Index in `neighbour` at which each ring begins, and the end of the last ring.
    start: Vec<u32>,
    neighbour: Vec<u32>,
    /// Whether the Voronoi cell of each point is closed and proven complete.
    pub(super) closed: Vec<bool>,
    /// Distance to the nearest other point, of any sheet; infinite if there is none.
    pub(super) nearest: Vec<f32>,
}

/// Buffers that are reused from leaf to leaf.
struct RingBuffers {
    cell: VoronoiCell,
    nearby: Nearby,
    /// The points farther around the leaf, for the cells that the near ones do not close.
    wide: Wide,
    keys: Vec<u64>,
    /// The points that were asked for their sheet, and whether it is another one: each try asks for
    /// those of the one before.
    asked: Vec<(usize, bool)>,
}

impl OneRings {
    /// Finds the one-rings of the points. The field tells near sheets apart.
    pub(super) async fn new(sheets: &Sheets<'_>, field: &mut dyn Evaluator) -> Self {
        let n = sheets.tree.len();
        let mut rings = Self {
            start: Vec::with_capacity(n + 1),
            neighbour: Vec::with_capacity(6 * n + n / 4),
            closed: Vec::with_capacity(n),
            nearest: Vec::with_capacity(n),
        };
        rings.start.push(0);
        let mut scratch = RingBuffers {
            cell: VoronoiCell::new(),
            nearby: Nearby::default(),
            wide: Wide::default(),
            keys: Vec::new(),
            asked: Vec::new(),
        };
        for leaf in sheets.tree.leaves() {
            rings.add_leaf(sheets, field, leaf, &mut scratch);
            pause().await;
        }
        rings
    }

    /// Appends the one-rings of the points of a leaf.
    fn add_leaf(
        &mut self,
        sheets: &Sheets,
        field: &mut dyn Evaluator,
        leaf: Leaf,
        RingBuffers { cell, nearby, wide, keys, asked }: &mut RingBuffers,
    ) {
        let Sheets { tree, normal, creases, .. } = *sheets;
        let reach = leaf.reach();
        let reach_sq = reach * reach;
        nearby.gather(sheets, leaf.lo - reach, leaf.hi + reach, |_| true);
        wide.reach = 0.0;
        for i in leaf.range.clone() {
            let p = tree.position[i];
            let mut nearest_sq = reach_sq;
            let mut faces_another = false;
            keys.clear();
            nearby.look_around(p, normal[i], reach_sq);
            for (j, relation) in nearby.hits() {
                if j as usize == i || creases.are_one(i, j as usize) {
                    continue;
                }
                nearest_sq = nearest_sq.min(relation.distance_sq);
                if !creases.is_one_patch(i, j as usize) {
                    continue;
                }
                let is_tip = || creases.is_tip(i) || creases.is_tip(j as usize);
                if relation.faces_alike && (relation.is_level || is_tip()) {
                    keys.push(key(relation.distance_sq, j));
                } else {
                    faces_another |= relation.faces_away;
                }
            }
            if nearest_sq >= reach_sq {
                nearest_sq = creases.nearest(tree, i).0;
            }
            self.nearest.push(nearest_sq.sqrt());
            let facing_away = if faces_another {
                let of_patch = |&j: &usize| creases.is_one_patch(i, j);
                sheets.facing_away(i, nearby.points.index.iter().map(|&j| j as usize).filter(of_patch))
            } else {
                f64::INFINITY
            };
            asked.clear();
            let field = creases.on(field, i);
            let mut is_stranger = |j: usize| {
                if creases.is_tip(i) || creases.is_tip(j) {
                    return false;
                }
                let known = asked.iter().find(|(other, _)| *other == j).map(|&(_, is_stranger)| is_stranger);
                known.unwrap_or_else(|| {
                    let is_stranger = sheets.are_two(field, i, j, facing_away);
                    asked.push((j, is_stranger));
                    is_stranger
                })
            };
            let mut known_sq = f64::from(reach_sq);
            let mut closed = fill(cell, tree, normal[i], i, keys, known_sq, &mut is_stranger);
            // The points in the ball of the leaf are enough for most cells.
            if !closed && keys.len() < MOST_POINTS {
                if !wide.nearest(sheets, &leaf, i, keys) {
                    let accept = |j: u32| {
                        let distance_sq = (tree.position[j as usize] - p).length_squared();
                        j as usize != i
                            && creases.is_one_patch(i, j as usize)
                            && is_one_sheet(sheets, i, j as usize, distance_sq)
                    };
                    tree.nearest_many(p, MOST_POINTS, accept, keys);
                }
                known_sq = match keys.iter().max() {
                    Some(&last) if keys.len() == MOST_POINTS => f64::from(unkey(last).0),
                    _ => f64::INFINITY, // Every point is known.
                };
                closed = fill(cell, tree, normal[i], i, keys, known_sq, &mut is_stranger);
            }
            self.neighbour
                .extend(cell.edges(known_sq).map(|(j, certain)| if certain { j | PROVEN } else { j }));
            self.closed.push(closed);
            self.start.push(self.neighbour.len() as u32);
        }
    }

    /// Returns the number of points.
    pub(super) fn len(&self) -> usize {
        self.closed.len()
    }

    fn entries(&self, i: usize) -> &[u32] {
        &self.neighbour[self.start[i] as usize..self.start[i + 1] as usize]
    }

    /// Returns the number of natural neighbours of `i`.
    pub(super) fn valence(&self, i: usize) -> usize {
        self.entries(i).len()
    }

    /// Returns the natural neighbours of `i`.
    pub(super) fn of(&self, i: usize) -> impl Iterator<Item = usize> + Clone + '_ {
        self.entries(i).iter().map(|&entry| (entry & !PROVEN) as usize)
    }

    /// Returns the pairs of consecutive natural neighbours of `i` whose common corner is proven:
    /// `i` and each pair form a triangle.
    pub(super) fn pairs(&self, i: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        let entries = self.entries(i);
        (0..entries.len()).filter(|&k| entries[k] & PROVEN != 0).map(move |k| {
            let next = entries[if k + 1 == entries.len() { 0 } else { k + 1 }];
            ((entries[k] & !PROVEN) as usize, (next & !PROVEN) as usize)
        })
    }

    /// Returns whether `i` sees the triangle of itself, `a` and `b`. The orientation does not
    /// matter: points of two sheets may see the triangle from opposite sides.
    pub(super) fn sees(&self, i: usize, a: usize, b: usize) -> bool {
        let entries = self.entries(i);
        let is = |entry: u32, j: usize| (entry & !PROVEN) as usize == j;
        let Some(k) = entries.iter().position(|&entry| is(entry, a)) else { return false };
        let next = entries[if k + 1 == entries.len() { 0 } else { k + 1 }];
        let before = entries[if k == 0 { entries.len() - 1 } else { k - 1 }];
        entries[k] & PROVEN != 0 && is(next, b) || before & PROVEN != 0 && is(before, b)
    }

    /// Returns whether `j` is a natural neighbour of `i`.
    pub(super) fn adjacent(&self, i: usize, j: usize) -> bool {
        self.of(i).any(|other| other == j)
    }
}

/// The points around a leaf, with their normals, in lanes; and which of them are near a point.
#[derive(Default)]
struct Nearby {
    points: PointsInBox,
    /// Normals of the points; 0 in the lanes that are filled up.
    normal: Vec<[Lanes; 3]>,
    /// How the points of each block of lanes lie to the point that was asked for last.
    block: Vec<BlockRelation>,
    /// The points that are near it are the first `count` of these: block and lane of each, as one
    /// number.
    hits: Vec<u32>,
    count: usize,
}

/// How the points of a block of lanes lie to another one, a bit for each.
#[derive(Clone, Copy, Default)]
struct BlockRelation {
    distance_sq: [Vec4; 2],
    is_level: u32,
    faces_alike: u32,
    faces_away: u32,
}

/// How a point lies to another one.
struct Relation {
    distance_sq: f32,
    /// Whether the line between them rises from one tangent plane about as much as it falls below
    /// the other.
    is_level: bool,
    /// Whether their normals are within 90°.
    faces_alike: bool,
    /// Whether their normals are more than 90° apart.
    faces_away: bool,
}

impl Nearby {
    /// Replaces the content by the points in the closed box from `lo` to `hi` that are to be kept.
    fn gather(&mut self, sheets: &Sheets, lo: Vec3, hi: Vec3, is_kept: impl Fn(u32) -> bool) {
        self.points.gather_those(sheets.tree, lo, hi, is_kept);
        self.normal.clear();
        self.normal.extend(self.points.index.chunks(LANES).map(|chunk| {
            let mut lanes = [Lanes::splat(0.0); 3];
            for (k, &j) in chunk.iter().enumerate() {
                let n = sheets.normal[j as usize];
                (lanes[0].0[k], lanes[1].0[k], lanes[2].0[k]) = (n.x, n.y, n.z);
            }
            lanes
        }));
        self.block.resize(self.normal.len(), BlockRelation::default());
        self.hits.resize(LANES * self.normal.len(), 0);
    }

    /// Finds the points nearer to `p` than √`reach_sq`, and how they lie to it and to the plane
    /// with this normal.
    fn look_around(&mut self, p: Vec3, normal: Vec3, reach_sq: f32) {
        let mut count = 0;
        let blocks = self.points.position.iter().zip(&self.normal).zip(&mut self.block);
        for (k, ((position, normals), block)) in blocks.enumerate() {
            let mut near = 0;
            (block.is_level, block.faces_alike, block.faces_away) = (0, 0, 0);
            for (half, distance_sq) in block.distance_sq.iter_mut().enumerate() {
                let shift = 4 * half;
                let four = |lanes: &Lanes| Vec4::from_slice(&lanes.0[shift..shift + 4]);
                let [x, y, z] = position.each_ref().map(four);
                let [a, b, c] = normals.each_ref().map(four);
                let (dx, dy, dz) = (x - p.x, y - p.y, z - p.z);
                *distance_sq = dx * dx + dy * dy + dz * dz;
                let rise = dx * (a + normal.x) + dy * (b + normal.y) + dz * (c + normal.z);
                let cosine = a * normal.x + b * normal.y + c * normal.z;
                near |= distance_sq.cmplt(Vec4::splat(reach_sq)).bitmask() << shift;
                block.is_level |= (rise * rise).cmple(*distance_sq * LEVEL).bitmask() << shift;
                block.faces_alike |= cosine.cmpgt(Vec4::ZERO).bitmask() << shift;
                block.faces_away |= cosine.cmplt(Vec4::ZERO).bitmask() << shift;
            }
            let lanes = &LANES_OF[near as usize];
            for (hit, lane) in self.hits[count..count + LANES].iter_mut().zip(lanes.lane) {
                *hit = (LANES * k) as u32 + lane;
            }
            count += lanes.count;
        }
        self.count = count;
    }

    /// The points that were found near, and how each lies to the one that was asked for.
    fn hits(&self) -> impl Iterator<Item = (u32, Relation)> {
        self.hits[..self.count].iter().map(|&hit| {
            let (block, lane) = (&self.block[hit as usize / LANES], hit as usize % LANES);
            let holds = |bits: u32| bits >> lane & 1 != 0;
            let relation = Relation {
                distance_sq: block.distance_sq[lane / 4][lane % 4],
                is_level: holds(block.is_level),
                faces_alike: holds(block.faces_alike),
                faces_away: holds(block.faces_away),
            };
            (self.points.index[hit as usize], relation)
        })
    }
}

/// The points in a wide box around a leaf, for cells that the near ones do not close: most of them
/// lie at the border of a surface.
#[derive(Default)]
struct Wide {
    nearby: Nearby,
    /// Distance between the faces of the box and those of the leaf; 0 until the points are
    /// gathered.
    reach: f32,
}

impl Wide {
    /// Gathers the points in the box around the leaf that may face as one of its points does.
    fn gather(&mut self, sheets: &Sheets, leaf: &Leaf) {
        /// For the rounding of the normals.
        const SLACK: f32 = 1e-3;
        let own = &sheets.normal[leaf.range.clone()];
        let mean = own.iter().sum::<Vec3>().normalize_or_zero();
        let cosine = own.iter().map(|n| n.dot(mean)).fold(1.0, f32::min);
        // Normals within an angle of the mean, and one within 90° of any of them.
        let least = if cosine > 0.0 { -(1.0 - cosine * cosine).max(0.0).sqrt() - SLACK } else { -2.0 };
        let is_kept = |j: u32| sheets.normal[j as usize].dot(mean) >= least;
        self.nearby.gather(sheets, leaf.lo - self.reach, leaf.hi + self.reach, is_kept);
    }

    /// Replaces `keys` by those of the [`MOST_POINTS`] nearest points on the sheet and patch of
    /// point `i` of a leaf, in any order, or of all if there are fewer. Returns whether it has: a
    /// box that holds them may hold too many others.
    fn nearest(&mut self, sheets: &Sheets, leaf: &Leaf, i: usize, keys: &mut Vec<u64>) -> bool {
        /// First reach, in units of that of the leaf: on half a plane it holds some 300 points.
        const FIRST: f32 = 6.5;
        /// Number of points in a box above which the tree finds the nearest ones sooner.
        const MANY: usize = 16 * MOST_POINTS;
        let Sheets { tree, normal, creases, .. } = *sheets;
        loop {
            if self.reach == 0.0 {
                self.reach = FIRST * leaf.reach();
                self.gather(sheets, leaf);
            }
            if self.nearby.points.index.len() > MANY || self.reach <= 0.0 {
                return false;
            }
            let has_all = tree.is_within(leaf.lo - self.reach, leaf.hi + self.reach);
            let reach_sq = if has_all { f32::INFINITY } else { self.reach * self.reach };
            self.nearby.look_around(tree.position[i], normal[i], reach_sq);
            keys.clear();
            for (j, relation) in self.nearby.hits().filter(|&(j, _)| j as usize != i) {
                let is_tip = || creases.is_tip(i) || creases.is_tip(j as usize);
                let is_one_sheet = relation.faces_alike && (relation.is_level || is_tip());
                if is_one_sheet && creases.is_one_patch(i, j as usize) {
                    keys.push(key(relation.distance_sq, j));
                }
            }
            if keys.len() > MOST_POINTS {
                keys.select_nth_unstable(MOST_POINTS);
                keys.truncate(MOST_POINTS);
            }
            if keys.len() == MOST_POINTS || has_all {
                return true;
            }
            self.reach *= 1.5;
            self.gather(sheets, leaf);
        }
    }
}

/// Returns whether two points at this distance count as being on one sheet: their normals are
/// within 90°, and the line between them rises from one tangent plane about as much as it falls
/// below the other, or leads to a tip.
#[inline]
fn is_one_sheet(sheets: &Sheets, i: usize, j: usize, distance_sq: f32) -> bool {
    let Sheets { tree, normal, creases, .. } = *sheets;
    let rise = (tree.position[j] - tree.position[i]).dot(normal[i] + normal[j]);
    let is_level = rise * rise <= LEVEL * distance_sq;
    normal[i].dot(normal[j]) > 0.0 && (is_level || creases.is_tip(i) || creases.is_tip(j))
}

/// Rotates an offset into the plane spanned by `u` and `v`, which keeps its length; `None` for one
/// perpendicular to the plane.
#[inline]
fn unroll(offset: DVec3, u: DVec3, v: DVec3) -> Option<DVec2> {
    let flat = DVec2::new(offset.dot(u), offset.dot(v));
    let flat_sq = flat.length_squared();
    (flat_sq > 0.0).then(|| flat * (offset.length_squared() / flat_sq).sqrt())
}

/// Moves the keys below `bound` to the front, and returns them and the others.
fn partition(keys: &mut [u64], bound: u64) -> (&mut [u64], &mut [u64]) {
    let mut count = 0;
    // No branch depends on the keys.
    for k in 0..keys.len() {
        keys.swap(k, count);
        count += usize::from(keys[count] < bound);
    }
    keys.split_at_mut(count)
}

/// Clips the cell of point `i` by the points of `keys` that are on no other sheet, nearest first,
/// until no farther one can matter. Returns whether the cell is closed and proven complete, if
/// every point nearer than √`known_sq` is among them.
fn fill(
    cell: &mut VoronoiCell,
    tree: &Tree,
    normal: Vec3,
    i: usize,
    keys: &mut [u64],
    known_sq: f64,
    is_stranger: &mut impl FnMut(usize) -> bool,
) -> bool {
    let p = tree.position[i].as_dvec3();
    let (u, v) = tangent_frame(normal);
    let (u, v) = (u.as_dvec3(), v.as_dvec3());
    let distance_sq = |key: Option<&u64>| key.map_or(1.0, |&key| unkey(key).0);
    // A square whose sides lie beyond half the known distance has no proven corner on its sides.
    let farthest_sq = || f64::from(distance_sq(keys.iter().max()));
    let known = if known_sq.is_finite() { known_sq } else { farthest_sq() * 1e6 };
    cell.start(known.sqrt().max(f64::MIN_POSITIVE));
    // Keys are rounded to single precision. The slack costs a few needless cuts only.
    let is_beyond = |cell: &VoronoiCell, key: u64| f64::from(unkey(key).0) > 4.001 * cell.reach_sq();
    let nearest_sq = distance_sq(keys.iter().min());
    let (first, rest) = partition(keys, key(FIRST_SQ * nearest_sq, 0));
    for part in [first, rest] {
        if part.iter().min().is_none_or(|&nearest| is_beyond(cell, nearest)) {
            continue;
        }
        part.sort_unstable();
        for &candidate in &*part {
            if is_beyond(cell, candidate) {
                break;
            }
            let (_, j) = unkey(candidate);
            if let Some(q) = unroll(tree.position[j as usize].as_dvec3() - p, u, v) {
                cell.clip(q, j, || !is_stranger(j as usize));
            }
        }
    }
    let mut corners = 0;
    cell.edges(known_sq).all(|(_, certain)| {
        corners += 1;
        certain
    }) && corners >= 3
}

#[cfg(test)]
mod tests;
