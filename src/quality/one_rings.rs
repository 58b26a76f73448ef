//! One-rings: the natural neighbours of every point, counter-clockwise around its normal.

use super::cell::{MOST_POINTS, VoronoiCell};
use super::sheets::Sheets;
use crate::field::Evaluator;
use crate::math::{LANES, key, tangent_frame, unkey};
use crate::slices::pause;
use crate::spatial::tree::{Leaf, PointsInBox, Tree};
use glam::{DVec2, DVec3, Vec3};

/// Largest height of one point over the other's tangent plane, as the mean of both heights over the
/// distance, if the two are on one sheet. On a smooth surface the two heights cancel to second
/// order in the distance over the radius of curvature: the mean is 1/12 where the curvature changes
/// by its own size between the points. Smaller: more edges stay open beside creases, cone points
/// and near sheets.
const MAX_LIFT: f32 = 0.2;
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
    nearby: PointsInBox,
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
            nearby: PointsInBox::default(),
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
        RingBuffers { cell, nearby, keys, asked }: &mut RingBuffers,
    ) {
        let Sheets { tree, normal, creases, .. } = *sheets;
        let reach = leaf.reach();
        let reach_sq = reach * reach;
        nearby.gather(tree, leaf.lo - reach, leaf.hi + reach);
        for i in leaf.range {
            let p = tree.position[i];
            let mut nearest_sq = reach_sq;
            let mut faces_another = false;
            keys.clear();
            for (indices, distances_sq) in nearby.index.chunks(LANES).zip(nearby.distances_sq(p)) {
                for (&j, &d) in indices.iter().zip(&distances_sq.0) {
                    if d < reach_sq && j as usize != i && !creases.are_one(i, j as usize) {
                        nearest_sq = nearest_sq.min(d);
                        if !creases.is_one_patch(i, j as usize) {
                            continue;
                        }
                        if is_one_sheet(sheets, i, j as usize, d) {
                            keys.push(key(d, j));
                        } else {
                            faces_another |= normal[i].dot(normal[j as usize]) < 0.0;
                        }
                    }
                }
            }
            if nearest_sq >= reach_sq {
                nearest_sq = creases.nearest(tree, i).0;
            }
            self.nearest.push(nearest_sq.sqrt());
            keys.sort_unstable();
            let facing_away = if faces_another {
                let of_patch = |&j: &usize| creases.is_one_patch(i, j);
                sheets.facing_away(i, nearby.index.iter().map(|&j| j as usize).filter(of_patch))
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
                let accept = |j: u32| {
                    let distance_sq = (tree.position[j as usize] - p).length_squared();
                    j as usize != i
                        && creases.is_one_patch(i, j as usize)
                        && is_one_sheet(sheets, i, j as usize, distance_sq)
                };
                tree.nearest_many(p, MOST_POINTS, accept, keys);
                known_sq = match keys.last() {
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
        self.pairs(i).any(|pair| pair == (a, b) || pair == (b, a))
    }

    /// Returns whether `j` is a natural neighbour of `i`.
    pub(super) fn adjacent(&self, i: usize, j: usize) -> bool {
        self.of(i).any(|other| other == j)
    }
}

/// Returns whether two points at this distance count as being on one sheet: their normals are
/// within 90°, and the line between them rises from one tangent plane about as much as it falls
/// below the other, or leads to a tip.
#[inline]
fn is_one_sheet(sheets: &Sheets, i: usize, j: usize, distance_sq: f32) -> bool {
    let Sheets { tree, normal, creases, .. } = *sheets;
    let rise = (tree.position[j] - tree.position[i]).dot(normal[i] + normal[j]);
    let is_level = rise * rise <= (2.0 * MAX_LIFT) * (2.0 * MAX_LIFT) * distance_sq;
    normal[i].dot(normal[j]) > 0.0 && (is_level || creases.is_tip(i) || creases.is_tip(j))
}

/// Rotates an offset into the plane spanned by `u` and `v`, which keeps its length; `None` for one
/// perpendicular to the plane.
#[inline]
pub(super) fn unroll(offset: DVec3, u: DVec3, v: DVec3) -> Option<DVec2> {
    let flat = DVec2::new(offset.dot(u), offset.dot(v));
    let flat_sq = flat.length_squared();
    (flat_sq > 0.0).then(|| flat * (offset.length_squared() / flat_sq).sqrt())
}

/// Clips the cell of point `i` by the points of the sorted `keys` that are on no other sheet, until
/// no farther one can matter. Returns whether the cell is closed and proven complete, if every
/// point nearer than √`known_sq` is among them.
fn fill(
    cell: &mut VoronoiCell,
    tree: &Tree,
    normal: Vec3,
    i: usize,
    keys: &[u64],
    known_sq: f64,
    is_stranger: &mut impl FnMut(usize) -> bool,
) -> bool {
    let p = tree.position[i].as_dvec3();
    let (u, v) = tangent_frame(normal);
    let (u, v) = (u.as_dvec3(), v.as_dvec3());
    let farthest_sq = keys.last().map_or(1.0, |&last| f64::from(unkey(last).0));
    // A square whose sides lie beyond half the known distance has no proven corner on its sides.
    let known = if known_sq.is_finite() { known_sq } else { farthest_sq * 1e6 };
    cell.start(known.sqrt().max(f64::MIN_POSITIVE));
    for &candidate in keys {
        let (distance_sq, j) = unkey(candidate);
        // Keys are rounded to single precision. The slack costs a few needless cuts only.
        if f64::from(distance_sq) > 4.001 * cell.reach_sq() {
            break;
        }
        if let Some(q) = unroll(tree.position[j as usize].as_dvec3() - p, u, v) {
            cell.clip(q, j, || !is_stranger(j as usize));
        }
    }
    let mut corners = 0;
    cell.edges(known_sq).all(|(_, certain)| {
        corners += 1;
        certain
    }) && corners >= 3
}
