//! Energy of every point with its natural neighbours, by which particles can be coloured.

use super::points::MeasuredPoints;
use super::sizes::WantedRadii;
use crate::math::functions::exp;
use crate::slices::{self, MEDIUM};
use core::f64::consts::E;

/// Energy of six neighbours at the ideal distance: 6 exp(−2).
const SIX: f32 = (6.0 / (E * E)) as f32;

/// Returns the energy of each point, Σ exp(−2 s²) over its natural neighbours, over that of six at
/// the ideal distance, s = 1.
///
/// s is the distance over that of a hexagonal lattice of as many points or, if sizes are wanted,
/// over the sum of both radii. With s = d/2r it is the Gaussian energy exp(−d²/2σ²) of the
/// relaxation, whose σ is r; neighbours farther away add less than 2 %.
pub(super) async fn of_points(points: &MeasuredPoints, wanted: Option<&WantedRadii>, d_hex: f64) -> Vec<f32> {
    let n = points.tree.len();
    let inverse = 1.0 / d_hex;
    let of_point = |i: usize| {
        let pair = |j: usize| {
            let share = match wanted {
                Some(wanted) => wanted.ratio(points, i, j),
                None => points.distance(i, j) * inverse,
            } as f32;
            exp(-2.0 * share * share)
        };
        points.stars.of(i).map(pair).sum::<f32>() / SIX
    };
    let parts = slices::map(n, MEDIUM, || (), |(), range| range.map(of_point).collect::<Vec<f32>>());
    parts.await.concat()
}
