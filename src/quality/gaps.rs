//! Triangles across gaps of the surface. If a box cuts the surface into pieces, or if it ends,
//! points on both sides of the gap are natural neighbours without any surface between them.

use super::points::MeasuredPoints;
use super::projection::STEPS;
use crate::field::descent::{Descent, descend};
use crate::field::{BATCH, Evaluator};
use crate::math::{Bounds, sort_few};
use crate::slices::{self, MEDIUM};
use glam::Vec3;

/// An edge may lead across a gap if it is longer than this many times the spacing at either end.
/// Smaller: surfaces fall into pieces; larger: pieces on either side of a gap may count as one.
pub(super) const LONG: f32 = 2.0;
/// The spacing at a point is the distance of its natural neighbour of this rank, or of the last one
/// if there are fewer: a single neighbour may be far too close.
const RANK: usize = 3;
/// Largest distance of the surface from the middle of an edge, lifted to the circle through its
/// ends, over the edge's length: the sagitta of an arc that turns by one radian is an eighth of its
/// chord.
const REACH: f32 = 0.125;
/// Largest distance of a place on the surface from it, and of a place in the box, over the edge's
/// length. Larger: pieces on either side of a gap may count as one.
const NEAR: f32 = 0.02;

/// Returns the spacing at every point.
pub(super) async fn spacing_of(points: &MeasuredPoints) -> Vec<f32> {
    let n = points.tree.len();
    let of_point = |lengths_sq: &mut Vec<f32>, i: usize| {
        let p = points.tree.position[i];
        lengths_sq.clear();
        lengths_sq.extend(points.stars.of(i).map(|j| p.distance_squared(points.tree.position[j])));
        sort_few(lengths_sq, |a, b| a < b);
        lengths_sq.get(RANK - 1).or(lengths_sq.last()).copied().unwrap_or(0.0_f32).sqrt()
    };
    let parts = slices::map(n, MEDIUM, Vec::new, |lengths_sq, range| {
        range.map(|i| of_point(lengths_sq, i)).collect::<Vec<f32>>()
    });
    parts.await.concat()
}

/// Search for triangles that lead across a gap of the surface.
pub(super) struct Gaps<'a> {
    pub(super) points: &'a MeasuredPoints,
    pub(super) spacing: &'a [f32],
    pub(super) bounds: Option<&'a Bounds>,
}

impl Gaps<'_> {
    /// Keeps the triangles that lead across no gap.
    pub(super) async fn drop_across(&self, field: &dyn Evaluator, triangles: &mut Vec<[u32; 3]>) {
        let parts = slices::map(
            triangles.len(),
            MEDIUM,
            || field.another(),
            |field, range| self.are_across(&mut **field, &triangles[range]),
        );
        let mut is_across = parts.await.into_iter().flatten();
        triangles.retain(|_| !is_across.next().unwrap_or_default());
    }

    /// Whether each triangle leads across a gap.
    fn are_across(&self, field: &mut dyn Evaluator, triangles: &[[u32; 3]]) -> Vec<bool> {
        let mut is_across = vec![false; triangles.len()];
        let mut long = Vec::new();
        for (triangle, &[a, b, c]) in triangles.iter().enumerate() {
            let edges = [(a, b), (b, c), (c, a)].into_iter();
            long.extend(edges.filter_map(|(i, j)| self.long_edge(triangle, i as usize, j as usize)));
        }
        for edges in long.chunks(BATCH) {
            self.look_across(field, edges, &mut is_across);
        }
        is_across
    }

    /// The edge of a triangle, if it is too long.
    fn long_edge(&self, triangle: usize, i: usize, j: usize) -> Option<LongEdge> {
        let [p, q] = [i, j].map(|k| self.points.tree.position[k]);
        let (length_sq, most) = (p.distance_squared(q), LONG * self.spacing[i].min(self.spacing[j]));
        if length_sq <= most * most {
            return None;
        }
        let length = length_sq.sqrt();
        let [n, m] = [i, j].map(|k| self.points.normal[k]);
        let up = (n + m).normalize_or(n);
        let middle = 0.5 * (p + q) + up * (0.125 * (q - p).dot(m - n));
        Some(LongEdge { triangle, middle, up, length })
    }

    /// Marks the triangles with an edge whose middle is not near the surface in the box.
    fn look_across(&self, field: &mut dyn Evaluator, edges: &[LongEdge], is_across: &mut [bool]) {
        let (mut at, mut normal, mut ok) = ([Vec3::ZERO; BATCH], [Vec3::ZERO; BATCH], [false; BATCH]);
        let mut limits = [Descent::default(); BATCH];
        for (k, edge) in edges.iter().enumerate() {
            at[k] = edge.middle;
            limits[k] = Descent { residual: NEAR * edge.length, reach: REACH * edge.length, trust: 0.0 };
        }
        descend(field, &mut at[..edges.len()], &mut normal, &mut ok, 0.0, &mut limits, STEPS);
        for (k, edge) in edges.iter().enumerate() {
            let is_surface =
                ok[k] && normal[k].dot(edge.up) > 0.0 && self.is_inside(at[k], NEAR * edge.length);
            is_across[edge.triangle] |= !is_surface;
        }
    }

    fn is_inside(&self, p: Vec3, slack: f32) -> bool {
        self.bounds.is_none_or(|bounds| bounds.enlarged(f64::from(slack)).holds(p.as_dvec3()))
    }
}

/// An edge that may lead across a gap.
struct LongEdge {
    /// Index of the triangle in its slice.
    triangle: usize,
    /// The middle of the edge, lifted to the circle through the two ends.
    middle: Vec3,
    /// The mean of the unit normals at the two ends, a unit vector.
    up: Vec3,
    length: f32,
}
