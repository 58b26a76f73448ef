//! Projection of sample points onto the surface.

use crate::field::descent::{Descent, descend};
use crate::field::{BATCH, Evaluator};
use glam::Vec3;

/// Largest number of Newton steps of a projection: each doubles the digits.
pub(super) const STEPS: u32 = 3;
/// A step shorter than this share of the leash is the last one.
///
/// A step of length s is about the sagitta κℓ²/2 of a chord of the length ℓ of the leash. The error
/// that it leaves is about κs² = 2 s³/ℓ², which changes the distance to a point ℓ away by the share
/// 2 (s/ℓ)⁶: 3·10⁻⁸.
pub(super) const LAST_STEP: f32 = 0.05;

/// Moves each sample onto the surface along the gradient, by at most [`STEPS`] Newton steps. A step
/// shorter than the share `last` of the sample's `leash` is its last one. A sample that would move
/// farther than its leash stays where it is.
pub(super) fn project(field: &mut dyn Evaluator, sample: &mut [Vec3], leash: &[f32], last: f32) {
    for (sample, leash) in sample.chunks_mut(BATCH).zip(leash.chunks(BATCH)) {
        let mut moved = [Vec3::ZERO; BATCH];
        moved[..sample.len()].copy_from_slice(sample);
        let (mut normal, mut ok) = ([Vec3::ZERO; BATCH], [false; BATCH]);
        // A step may lead beyond the leash, and the next one back.
        let mut limits = [Descent::default(); BATCH];
        for (limits, leash) in limits.iter_mut().zip(leash) {
            limits.trust = last * leash;
        }
        descend(field, &mut moved[..sample.len()], &mut normal, &mut ok, 0.0, &mut limits, STEPS);
        for ((sample, moved), leash) in sample.iter_mut().zip(moved).zip(leash) {
            // This is false for NaN.
            if (moved - *sample).length_squared() <= leash * leash {
                *sample = moved;
            }
        }
    }
}

/// Returns whether a projected sample is on the surface, up to another last step. The circumcentre
/// of an almost flat triangle, as at the border of a box, is far from the surface, and its
/// projection may fail.
pub(super) fn is_reached(field: &mut dyn Evaluator, sample: Vec3, leash: f32) -> bool {
    let (mut value, mut gradient) = ([0.0], [Vec3::ZERO]);
    field.gradients(&[sample], &mut value, &mut gradient);
    value[0].abs() <= LAST_STEP * leash * gradient[0].length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::formula::Formula;
    use crate::field::{Field, Frame};

    #[test]
    fn a_sample_is_led_onto_a_surface_that_bends_by_more_than_one_step() {
        let field = Formula::as_written("x^2 + y^2 + z^2 - 1", &[]).expect("a formula");
        let field = &mut *field.evaluator(Frame::default());
        let mut sample = [Vec3::new(0.0, 0.48, 0.64), Vec3::new(-1.3, 0.0, 0.0), Vec3::new(3.0, 0.0, 0.0)];
        project(field, &mut sample, &[0.5; 3], LAST_STEP);
        // One step ends at 1.025 and at 1.035.
        for p in &sample[..2] {
            assert!((p.length() - 1.0).abs() < 1e-3, "{p}");
            assert!(is_reached(field, *p, 0.5));
        }
        // A sample that would move farther than its leash stays where it is, and is known not to be
        // on the surface.
        assert_eq!(sample[2], Vec3::new(3.0, 0.0, 0.0));
        assert!(!is_reached(field, sample[2], 0.5));
    }
}
