//! Newton's method along the gradient, in single precision: from points near a surface to points on
//! it, a batch at a time.
//!
//! Seeds, the relaxation and the figures move their points here, each with its own limits. Other
//! Newton methods move one point:
//!
//! * [`newton`](crate::math::newton) moves it in double precision.
//! * `sampler::discovery::nearness` too, and it uses the second derivative at each step.
//! * `sampler::constraint::tips` moves a direction along a sphere, and `sampler::projection` an
//!   angle along a circle.
//! * `sampler::refine` moves a particle along planes of the box, and `sampler::sheet` checks after
//!   each step whether there is one sheet; both use the [`step`] of this file.
//! * `quality::sheets` takes one step at a time along a surface, `sampler::discovery::sheets`
//!   alternates with a box, and `sampler::discovery::audit` stays in a plane.
//! * `sampler::discovery::singular` looks for a zero of the gradient, and `field::formula::creases`
//!   for one of two functions at once.

use super::{BATCH, Evaluator};
use glam::Vec3;

/// Below this |∇f|, its square is subnormal and has lost digits.
const FAINT: f32 = 1e-18;

/// The unit normal ∇f/|∇f|.
pub(crate) fn unit(gradient: Vec3, slope: f32) -> Vec3 {
    if slope < FAINT { (gradient / FAINT).normalize_or_zero() } else { gradient / slope }
}

/// The step of least length after which f is zero to first order, to be subtracted from the point.
#[inline]
pub(crate) fn step(value: f32, gradient: Vec3) -> Vec3 {
    gradient * (value / gradient.length_squared())
}

/// Limits of the path of a point along the gradient; the default sets none.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Descent {
    /// Largest |f|/|∇f| at which the point is on the surface.
    pub(crate) residual: f32,
    /// Largest distance from the starting point; a point that moves farther is given up.
    pub(crate) reach: f32,
    /// Length of a correction below which the point is not evaluated again. Newton's method
    /// converges quadratically, so the residual is then below the order of the tolerance. The
    /// normal is taken before the correction.
    pub(crate) trust: f32,
}

impl Default for Descent {
    fn default() -> Self {
        Self { residual: 0.0, reach: f32::INFINITY, trust: 0.0 }
    }
}

/// Limits and evaluations of a batch of points.
pub(crate) trait Descents {
    /// Returns the limits of point `i`.
    fn of(&self, i: usize) -> Descent;

    /// Evaluates the field at `points`, whose indices in the batch are `which`.
    fn evaluate(
        &mut self,
        field: &mut dyn Evaluator,
        which: &[u32],
        points: &[Vec3],
        value: &mut [f32],
        gradient: &mut [Vec3],
    ) {
        let _ = which;
        field.gradients(points, value, gradient);
    }
}

/// Limits that are the same for all points.
impl Descents for Descent {
    fn of(&self, _: usize) -> Descent {
        *self
    }
}

/// Limits for each point of the batch.
impl Descents for [Descent; BATCH] {
    fn of(&self, i: usize) -> Descent {
        self[i]
    }
}

/// Moves each of at most [`BATCH`] points onto the surface along the gradient. Returns the number
/// of evaluations.
///
/// `normal[i]` becomes the unit normal, and `ok[i]` whether the point is on the surface within the
/// limits of `descents`. A point is given up after `max_steps` evaluations, when it has moved too
/// far, and where the field is undefined or its gradient is not above `min_gradient`; it stays
/// where its last step has led.
pub(crate) fn descend(
    field: &mut dyn Evaluator,
    points: &mut [Vec3],
    normal: &mut [Vec3],
    ok: &mut [bool],
    min_gradient: f32,
    descents: &mut impl Descents,
    max_steps: u32,
) -> u64 {
    let n = points.len();
    debug_assert!(n <= BATCH);
    let (mut value, mut gradient) = ([0.0; BATCH], [Vec3::ZERO; BATCH]);
    let mut start = [Vec3::ZERO; BATCH];
    start[..n].copy_from_slice(points);
    // The first `count` entries of both are the points under way: their places and their indices.
    let mut at = start;
    let mut active: [u32; BATCH] = core::array::from_fn(|i| i as u32);
    ok[..n].fill(false);
    let (mut count, mut evaluations) = (n, 0);
    for _ in 0..max_steps {
        if count == 0 {
            break;
        }
        evaluations += count as u64;
        let (value, gradient) = (&mut value[..count], &mut gradient[..count]);
        descents.evaluate(field, &active[..count], &at[..count], value, gradient);
        let mut kept = 0;
        for k in 0..count {
            let i = active[k] as usize;
            let Descent { residual, reach, trust } = descents.of(i);
            let (value, gradient) = (value[k], gradient[k]);
            let slope_sq = gradient.length_squared();
            let inverse_slope = 1.0 / slope_sq.sqrt();
            let slope = slope_sq * inverse_slope;
            // The condition is false for NaN.
            if !(slope > min_gradient && slope.is_finite() && value.is_finite()) {
                continue;
            }
            normal[i] = if slope < FAINT { unit(gradient, slope) } else { gradient * inverse_slope };
            let distance = value.abs() * inverse_slope;
            if distance <= residual {
                ok[i] = true;
                continue;
            }
            points[i] -= normal[i] * (value * inverse_slope);
            if (points[i] - start[i]).length_squared() > reach * reach {
                continue;
            }
            if distance <= trust {
                ok[i] = true;
                continue;
            }
            (active[kept], at[kept]) = (i as u32, points[i]);
            kept += 1;
        }
        count = kept;
    }
    evaluations
}
