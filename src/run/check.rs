//! Checks a field and its box: the gradient must match the values, and the surface must stay in the
//! box.

use crate::field::{Evaluator, difference_step};
use crate::math::newton::{self, StepLimits, step_to_curve};
use crate::math::{Bounds, SINGLE_ROUNDING};
use glam::DVec3;

/// Points along each axis of the box: 27 are checked in all, and half of them must differ.
const SIDE: usize = 3;
/// Least relative difference of a gradient that counts as wrong. For a closure in single precision
/// the median difference is up to 0.8 %; for fields with kinks and for sines of up to 1,000 radians
/// per unit it is below 2·10⁻⁵. Larger: more wrong gradients are missed.
const DIFFERENT: f64 = 0.02;

/// A point of the box, relative to the origin of the frame, at which the gradient disagrees with
/// differences of f; none if it does at fewer than half of the points, as at the kinks of a correct
/// field.
pub(super) fn wrong_gradient(field: &mut dyn Evaluator, bounds: &Bounds) -> Option<DVec3> {
    let mut wrong = Vec::new();
    let mut looked_at = 0;
    for p in bounds.spread(SIDE) {
        let (_, given) = field.value_and_gradient(p);
        let h = difference_step(field.frame().place(p));
        let mut along = |d: DVec3| {
            (field.value_and_gradient(p + h * d).0 - field.value_and_gradient(p - h * d).0) / (2.0 * h)
        };
        let found = DVec3::from_array(DVec3::AXES.map(&mut along));
        if found.is_finite() && found != DVec3::ZERO {
            looked_at += 1;
            let error = (given - found).length();
            if error.is_nan() || error > DIFFERENT * found.length() {
                wrong.push(p);
            }
        }
    }
    wrong.first().copied().filter(|_| 2 * wrong.len() > looked_at)
}

/// Whether the surface passes through a face of the box, in the plane across `axis` at this
/// coordinate, within `reach` of its point `p`.
pub(super) fn passes_plane(
    field: &mut dyn Evaluator,
    bounds: &Bounds,
    p: DVec3,
    reach: f64,
    axis: usize,
    at: f64,
) -> bool {
    let slack = SINGLE_ROUNDING * reach;
    let limits = StepLimits { reach, at_rest: slack, ..StepLimits::steps(newton::STEPS) };
    let step_at = |p: DVec3| {
        let slope = field.value_and_gradient(p);
        Some((step_to_curve([slope, (p[axis] - at, DVec3::AXES[axis])]).0, ()))
    };
    newton::land(p, limits, step_at).is_some_and(|(place, ())| bounds.enlarged(slack).holds(place))
}
