//! Figures relative to the wanted radius of each point.

use super::places::Pairs;
use super::points::MeasuredPoints;
use crate::math::{HEXAGONAL_CELL, SQRT_3};
use crate::slices::{MEDIUM, pause, ranges};

/// Radius of a hole in a hexagonal lattice of radius 1: the circumradius of a triangle of side 2.
const HOLE: f64 = 2.0 / SQRT_3;

/// The wanted radii, in tree order; NaN for a point without one.
pub(super) struct WantedRadii {
    pub(super) radius: Vec<f64>,
    /// Radius of an ideal hole over the wanted radius, with all radii scaled so that their
    /// hexagonal cells have the area of the surface.
    pub(super) hole: f64,
}

impl WantedRadii {
    /// The `radii` of points on a surface of this `area`, in the order of the particles.
    pub(super) fn new(points: &MeasuredPoints, radii: &[f32], area: f64) -> Self {
        let of = |&i: &u32| radii.get(i as usize).map_or(f64::NAN, |&r| f64::from(r));
        let radius: Vec<f64> = points.tree.origin.iter().map(of).collect();
        let once = (0..radius.len()).filter(|&i| points.creases.is_first(i)).map(|i| radius[i]);
        let cells: f64 = once.filter(|r| r.is_finite()).map(|r| HEXAGONAL_CELL * r * r).sum();
        Self { radius, hole: HOLE * (area / cells).sqrt() }
    }

    /// Returns the distance of two points over the sum of their radii.
    pub(super) fn ratio(&self, points: &MeasuredPoints, i: usize, j: usize) -> f64 {
        points.distance(i, j) / (self.radius[i] + self.radius[j])
    }

    /// Returns the radius of an ideal hole between some points; NaN if one of them has no radius.
    pub(super) fn hole_between(&self, points: &[u32]) -> f32 {
        let sum: f64 = points.iter().map(|&i| self.radius[i as usize]).sum();
        (self.hole * sum / points.len() as f64) as f32
    }
    /// Adds the pairs of natural neighbours with at least one `inner` point, by their ratios.
    /// Returns the smallest ratio; NaN if there is none.
    pub(super) async fn add_pairs(&self, points: &MeasuredPoints, inner: &[bool], pairs: &mut Pairs) -> f64 {
        let MeasuredPoints { tree, stars, creases, .. } = points;
        let mut least = f64::NAN;
        for range in ranges(inner.len(), MEDIUM) {
            for i in range.filter(|&i| inner[i]) {
                for j in stars.of(i) {
                    let ratio = self.ratio(points, i, j);
                    least = least.min(ratio);
                    // A pair of inner points that are mutual neighbours is seen from both; it is
                    // added at the earlier one.
                    let is_seen_again = j < i && inner[j] && stars.adjacent(j, i);
                    if ratio.is_finite() && !is_seen_again && creases.is_first_pair(i, j) {
                        pairs.add(ratio, creases.particle(tree, i), creases.particle(tree, j));
                    }
                }
            }
            pause().await;
        }
        least
    }
}
