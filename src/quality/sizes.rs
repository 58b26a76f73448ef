//! Figures relative to the wanted radius of each point.

use super::moments::Moments;
use super::places::Pairs;
use super::points::MeasuredPoints;
use crate::math::{HEXAGONAL_CELL, SQRT_3};

/// Radius of a hole in a hexagonal lattice of radius 1: the circumradius of a triangle of side 2.
const HOLE: f64 = 2.0 / SQRT_3;

/// The wanted radii, in tree order; NaN for a point without one.
pub(super) struct WantedRadii {
    radius: Vec<f64>,
    /// Radius of an ideal hole over the wanted radius, if all radii are scaled so that their hexagonal cells have the
    /// area of the surface.
    hole: f64,
}

impl WantedRadii {
    /// Takes the `radii` of points on a surface of this `area`, in the order of the particles.
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
}

/// Statistics of the edge lengths over the sums of the wanted radii at their ends.
pub(super) struct EdgeRatios {
    /// Ratios of the edges between mutual natural neighbours.
    pub(super) edge: Moments,
    /// Smallest ratio of two natural neighbours.
    pub(super) least: f64,
    /// Pairs of natural neighbours by their ratios.
    pub(super) pairs: Pairs,
}

impl Default for EdgeRatios {
    fn default() -> Self {
        Self { edge: Moments::default(), least: f64::NAN, pairs: Pairs::default() }
    }
}

impl EdgeRatios {
    /// Takes in the edges of point `i`.
    pub(super) fn add(&mut self, wanted: &WantedRadii, points: &MeasuredPoints, inner: &[bool], i: usize) {
        points
            .mutual(inner, i)
            .filter(|&j| points.creases.is_first_pair(i, j))
            .map(|j| wanted.ratio(points, i, j))
            .filter(|ratio| ratio.is_finite())
            .for_each(|ratio| self.edge.add(ratio));
        for j in points.rings.of(i) {
            let ratio = wanted.ratio(points, i, j);
            self.least = self.least.min(ratio);
            // A pair of inner points that are neighbours of each other is seen from both; it is added at the earlier one.
            let is_seen_again = j < i && inner[j] && points.rings.adjacent(j, i);
            if ratio.is_finite() && !is_seen_again && points.creases.is_first_pair(i, j) {
                let [i, j] = [i, j].map(|i| points.creases.particle(&points.tree, i));
                self.pairs.add(ratio, i, j);
            }
        }
    }
}
