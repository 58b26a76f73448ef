//! Whether a surface passes a place.

use super::Evaluator;
use super::descent::{Descent, descend};
use glam::Vec3;

/// Distances on either side of a place at which a line is tried, each half of the one before: a
/// wall is found if it is thicker than a 64th of the reach.
const HALVINGS: u32 = 6;
/// Steps of Newton's method, each of which doubles the digits.
const STEPS: u32 = 8;
/// A place at most this far from the surface, in shares of the reach, is on it. Larger: Newton's
/// method ends sooner; where it leads to a zero, it gets as near as wanted.
const ON: f32 = 1e-3;

/// Whether a sheet that faces like the unit vector `up` passes within `reach` of a place: Newton's
/// method leads to one, or along `up` f is first negative and later positive, as below a tip, where
/// f may have no gradient.
pub(crate) fn is_passed(field: &mut dyn Evaluator, place: Vec3, up: Vec3, reach: f32) -> bool {
    let (mut at, mut normal, mut ok) = ([place], [Vec3::ZERO], [false]);
    let mut limits = Descent { residual: ON * reach, reach, trust: 0.0 };
    descend(field, &mut at, &mut normal, &mut ok, 0.0, &mut limits, STEPS);
    if ok[0] && normal[0].dot(up) > 0.0 {
        return true;
    }
    let distances = (0..=HALVINGS).map(|k| reach / (1_u32 << k) as f32);
    let along = distances.clone().map(|d| -d).chain([0.0]).chain(distances.rev());
    let places: Vec<Vec3> = along.map(|d| place + up * d).collect();
    let mut values = vec![f32::NAN; places.len()];
    field.values(&places, &mut values);
    let below = values.iter().position(|&value| value < 0.0);
    below.is_some_and(|below| values[below..].iter().any(|&value| value > 0.0))
}
