//! Newton's method for one point in double precision: to a surface, to the intersection curve of
//! two, or to a common point of three.
//!
//! Each step is the shortest that makes the functions zero to first order. `field::descent` moves
//! batches of points in single precision.

use glam::{DMat3, DVec3};

/// Value and gradient of a function at a point.
pub(crate) type Slope = (f64, DVec3);

/// The step to the zeros of one function, to be subtracted from the point.
pub(crate) fn step_to_surface((f, u): Slope) -> DVec3 {
    u * (f / u.length_squared())
}

/// The step to the common zeros of two functions, to be subtracted from the point, and the cross
/// product of their gradients, which is tangent to the curve.
pub(crate) fn step_to_curve([(f, u), (g, v)]: [Slope; 2]) -> (DVec3, DVec3) {
    let tangent = u.cross(v);
    ((v.cross(tangent) * f + tangent.cross(u) * g) / tangent.length_squared(), tangent)
}

/// The step to the common zero of three functions, to be subtracted from the point, and the volume
/// spanned by the unit vectors along their gradients.
pub(crate) fn step_to_corner(slopes: [Slope; 3]) -> (DVec3, f64) {
    let [(f, u), (g, v), (h, w)] = slopes.map(|(value, gradient)| {
        let slope = gradient.length();
        (value / slope, gradient / slope)
    });
    let rows = DMat3::from_cols(u, v, w).transpose();
    (rows.inverse() * DVec3::new(f, g, h), rows.determinant().abs())
}

/// Largest number of evaluations of Newton's method. From a good guess two to five suffice, since
/// each step doubles the digits.
pub(crate) const STEPS: u32 = 12;

/// Limits of Newton's method for a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StepLimits {
    /// Largest number of steps.
    pub(crate) steps: u32,
    /// Largest distance from the start.
    pub(crate) reach: f64,
    /// Length of a step after which the point is at rest.
    pub(crate) at_rest: f64,
    /// Length of a step after which the point is at rest, over the point's distance from the
    /// origin. The larger of both lengths counts.
    pub(crate) share_at_rest: f64,
}

impl StepLimits {
    /// Only the number of steps is limited.
    pub(crate) const fn steps(steps: u32) -> Self {
        Self { steps, reach: f64::MAX, at_rest: 0.0, share_at_rest: 0.0 }
    }
}

/// The point at which the steps from `start` come to rest within these limits, with the second
/// value of `step_at` at the last step. None if they do not, or `step_at` returns none or NaN.
pub(crate) fn land<T>(
    start: DVec3,
    limits: StepLimits,
    mut step_at: impl FnMut(DVec3) -> Option<(DVec3, T)>,
) -> Option<(DVec3, T)> {
    let mut p = start;
    for _ in 0..limits.steps {
        let (step, found) = step_at(p)?;
        p -= step;
        // Written so that NaN fails.
        let is_near = p.distance(start) <= limits.reach;
        if !is_near {
            return None;
        }
        if step.length() <= limits.at_rest.max(limits.share_at_rest * p.length()) {
            return Some((p, found));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sphere around a point, as a function that is zero on it.
    fn sphere(centre: DVec3, p: DVec3) -> Slope {
        ((p - centre).length_squared() - 1.0, 2.0 * (p - centre))
    }

    const CENTRES: [DVec3; 3] = [DVec3::ZERO, DVec3::new(0.6, 0.0, 0.0), DVec3::new(0.0, 0.6, 0.0)];
    const START: DVec3 = DVec3::new(0.35, 0.2, 0.8);

    #[test]
    fn points_come_to_rest_on_one_sphere_on_two_and_on_three() {
        let limits = StepLimits { at_rest: 1e-12, ..StepLimits::steps(12) };
        let of = |p| CENTRES.map(|centre| sphere(centre, p));
        let on = [
            land(START, limits, |p| Some((step_to_surface(of(p)[0]), ()))),
            land(START, limits, |p| Some((step_to_curve([of(p)[0], of(p)[1]]).0, ()))),
            land(START, limits, |p| Some((step_to_corner(of(p)).0, ()))),
        ];
        for (k, landed) in on.into_iter().enumerate() {
            let (p, ()) = landed.expect("the start is near");
            assert!(of(p)[..=k].iter().all(|(value, _)| value.abs() < 1e-12), "{} spheres: {p}", k + 1);
        }
    }

    #[test]
    fn points_that_go_too_far_or_nowhere_do_not_land() {
        let step_at = |p| Some((step_to_surface(sphere(DVec3::ZERO, p)), ()));
        let limits = StepLimits { at_rest: 1e-12, ..StepLimits::steps(12) };
        assert_eq!(land(3.0 * START, StepLimits { reach: 0.5, ..limits }, step_at), None);
        assert_eq!(land(3.0 * START, StepLimits::steps(2), step_at), None);
        assert_eq!(land(DVec3::ZERO, limits, step_at), None, "the gradient is zero there");
    }
}
