//! Triangles across gaps of the surface. Where a box cuts the surface into pieces, or where it ends, points on both sides of the gap
//! are natural neighbours, and nothing between them is surface.

use super::scene::Scene;
use crate::field::Field;
use crate::math::{Bounds, sort_few};
use crate::slices::{pause, ranges};
use glam::DVec3;

/// An edge may lead across a gap if it is longer than this many times the spacing at either end.
pub(super) const LONG: f32 = 2.0;
/// The distance of the natural neighbour with this rank is the spacing at a point, but at most [`FARTHEST`] times that of the one
/// before it. A single neighbour may be far too near.
const RANK: usize = 3;
const FARTHEST: f32 = 3.0;
/// Newton steps from the middle of an edge to the surface.
const STEPS: u32 = 3;
/// Largest distance of the surface from the middle of an edge, lifted to the circle through its ends, over the edge's length.
const REACH: f64 = 0.125;
/// Distance from the surface at which a place is on it, and from the box at which it is in it, over the edge's length.
const NEAR: f64 = 0.02;
/// Points or triangles that are looked at in one slice of work.
const SLICE: usize = 512;

/// Returns the spacing at every point.
pub(super) async fn spacing_of(scene: &Scene) -> Vec<f32> {
    let n = scene.tree.len();
    let mut lengths = Vec::new();
    let mut spacing = Vec::with_capacity(n);
    for range in ranges(n, SLICE) {
        spacing.extend(range.map(|i| {
            let p = scene.tree.position[i];
            lengths.clear();
            lengths.extend(scene.rings.of(i).map(|j| p.distance(scene.tree.position[j])));
            sort_few(&mut lengths, |a, b| a < b);
            let before: f32 = lengths.get(RANK - 2).or(lengths.first()).copied().unwrap_or(0.0);
            lengths.get(RANK - 1).map_or(before, |&third| third.min(FARTHEST * before))
        }));
        pause().await;
    }
    spacing
}

/// Where the surface is: by the field, in the box that was sampled.
pub(super) struct Gaps<'a> {
    pub(super) scene: &'a Scene,
    pub(super) spacing: &'a [f32],
    pub(super) bounds: Option<&'a Bounds>,
}

impl Gaps<'_> {
    /// Keeps the triangles that lead across no gap.
    pub(super) async fn drop_across(&self, field: &mut dyn Field, triangles: &mut Vec<[u32; 3]>) {
        let mut kept = 0;
        for range in ranges(triangles.len(), SLICE) {
            for k in range {
                let [a, b, c] = triangles[k];
                if ![(a, b), (b, c), (c, a)]
                    .into_iter()
                    .any(|(i, j)| self.is_across(field, i as usize, j as usize))
                {
                    triangles[kept] = triangles[k];
                    kept += 1;
                }
            }
            pause().await;
        }
        triangles.truncate(kept);
    }

    /// Whether an edge is long, and its middle not near the surface.
    fn is_across(&self, field: &mut dyn Field, i: usize, j: usize) -> bool {
        let position = &self.scene.tree.position;
        if position[i].distance(position[j]) <= LONG * self.spacing[i].min(self.spacing[j]) {
            return false;
        }
        let [p, q] = [i, j].map(|k| position[k].as_dvec3());
        let [n, m] = [i, j].map(|k| self.scene.normal[k].as_dvec3());
        let length = p.distance(q);
        let up = (n + m).normalize_or(n);
        let middle = 0.5 * (p + q) + up * (0.125 * (q - p).dot(m - n));
        let mut at = middle;
        for _ in 0..=STEPS {
            let jet = field.jet(at);
            let slope_sq = jet.gradient.length_squared();
            if jet.value.abs() <= NEAR * length * slope_sq.sqrt() && jet.gradient.dot(up) > 0.0 {
                return !self.is_inside(at, NEAR * length);
            }
            at -= jet.gradient * (jet.value / slope_sq);
            // Written so that NaN leads away.
            let is_within = at.distance(middle) <= REACH * length;
            if !is_within {
                return true;
            }
        }
        true
    }

    fn is_inside(&self, p: DVec3, slack: f64) -> bool {
        self.bounds
            .is_none_or(|bounds| p.cmpge(bounds.lo() - slack).all() && p.cmple(bounds.hi() + slack).all())
    }
}
