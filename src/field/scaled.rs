//! A field times a constant. With the right one, squares of values and gradients neither overflow nor underflow in
//! single precision, whatever units a formula is in.

use super::{Enclosure, Field, Interval, Jet};
use crate::math::{Bounds, Sym3, sort_numbers};
use glam::{DVec3, Vec3};

/// Maximum number of points at which the magnitude of the gradient is sampled: one batch.
const SAMPLES: usize = 128;

/// Largest |exponent| of a gradient that needs no scale. The square of such a gradient, and of a value a million times
/// smaller or larger, is a normal number in single precision.
const COMFORTABLE: i32 = 40;

/// Another field times a positive power of two. The surface is the same, and no digit is lost.
pub(crate) struct Scaled<'a> {
    field: &'a mut dyn Field,
    scale: f32,
}

impl<'a> Scaled<'a> {
    /// `field` times `scale`, which [`comfortable_scale`] gives.
    pub(crate) fn new(field: &'a mut dyn Field, scale: f32) -> Self {
        Self { field, scale }
    }
}

/// Power of two that brings the median magnitude of the gradient near 1, or 1 if that is not needed.
///
/// The gradient is sampled at no more than 128 of `points`. Because only the exponent of the median counts, nearly all
/// choices of points give the same scale.
pub(crate) fn comfortable_scale(field: &mut dyn Field, points: impl ExactSizeIterator<Item = Vec3>) -> f32 {
    let stride = points.len().div_ceil(SAMPLES).max(1);
    let points: Vec<Vec3> = points.step_by(stride).collect();
    let (mut value, mut gradient) = (vec![0.0; points.len()], vec![Vec3::ZERO; points.len()]);
    field.gradients(&points, &mut value, &mut gradient);
    let mut size: Vec<f32> =
        gradient.iter().map(|g| g.abs().max_element()).filter(|s| s.is_finite() && *s > 0.0).collect();
    sort_numbers(&mut size);
    let Some(&median) = size.get(size.len() / 2) else { return 1.0 };
    let exponent = exponent(median);
    if exponent.abs() <= COMFORTABLE { 1.0 } else { power_of_two(-exponent) }
}

/// Points of a coarse grid in a box, off its faces and its planes of symmetry.
pub(crate) fn spread(bounds: &Bounds) -> impl ExactSizeIterator<Item = Vec3> {
    const SIDE: usize = 5;
    bounds.spread(SIDE).map(|p| p.as_vec3())
}

/// Exponent of a positive number. A subnormal one counts as the smallest normal number.
fn exponent(x: f32) -> i32 {
    ((x.to_bits() >> 23 & 0xff) as i32).max(1) - 127
}

/// 2^`exponent`, for −126 ≤ `exponent` ≤ 127.
fn power_of_two(exponent: i32) -> f32 {
    f32::from_bits(((exponent.clamp(-126, 127) + 127) as u32) << 23)
}

impl Field for Scaled<'_> {
    fn values(&mut self, points: &[Vec3], value: &mut [f32]) {
        self.field.values(points, value);
        if self.scale != 1.0 {
            value[..points.len()].iter_mut().for_each(|v| *v *= self.scale);
        }
    }

    fn gradients(&mut self, points: &[Vec3], value: &mut [f32], gradient: &mut [Vec3]) {
        self.field.gradients(points, value, gradient);
        if self.scale != 1.0 {
            value[..points.len()].iter_mut().for_each(|v| *v *= self.scale);
            gradient[..points.len()].iter_mut().for_each(|g| *g *= self.scale);
        }
    }

    fn hessians(
        &mut self,
        points: &[Vec3],
        value: &mut [f32],
        gradient: &mut [Vec3],
        hessian: &mut [Sym3<f32>],
    ) {
        self.field.hessians(points, value, gradient, hessian);
        if self.scale != 1.0 {
            value[..points.len()].iter_mut().for_each(|v| *v *= self.scale);
            gradient[..points.len()].iter_mut().for_each(|g| *g *= self.scale);
            hessian[..points.len()].iter_mut().for_each(|h| *h = h.map(|entry| entry * self.scale));
        }
    }

    fn jet(&mut self, p: DVec3) -> Jet {
        let scale = f64::from(self.scale);
        let jet = self.field.jet(p);
        Jet {
            value: jet.value * scale,
            gradient: jet.gradient * scale,
            hessian: jet.hessian.map(|entry| entry * scale),
        }
    }

    fn exact_gradients(&mut self, points: &[Vec3], value: &mut [f64], gradient: &mut [DVec3]) {
        self.field.exact_gradients(points, value, gradient);
        if self.scale != 1.0 {
            let scale = f64::from(self.scale);
            value[..points.len()].iter_mut().for_each(|v| *v *= scale);
            gradient[..points.len()].iter_mut().for_each(|g| *g *= scale);
        }
    }

    fn interval(&mut self, lo: DVec3, hi: DVec3) -> Interval {
        let scale = f64::from(self.scale);
        let range = self.field.interval(lo, hi);
        Interval { lo: range.lo * scale, hi: range.hi * scale, ..range }
    }

    fn has_bounds(&self) -> bool {
        self.field.has_bounds()
    }

    fn origin(&self) -> DVec3 {
        self.field.origin()
    }

    fn factors(&mut self) -> usize {
        self.field.factors()
    }

    fn enclose(&mut self, factor: usize, boxes: &[[DVec3; 2]], out: &mut [Enclosure]) {
        let scale = f64::from(self.scale);
        self.field.enclose(factor, boxes, out);
        if scale != 1.0 {
            for known in &mut out[..boxes.len()] {
                known.value = known.value.map(|bound| bound * scale);
                known.gradient = known.gradient.map(|bounds| bounds.map(|bound| bound * scale));
            }
        }
    }

    fn enclose_second(&mut self, factor: usize, boxes: &[[DVec3; 2]], out: &mut [[[f64; 2]; 6]]) {
        let scale = f64::from(self.scale);
        self.field.enclose_second(factor, boxes, out);
        if scale != 1.0 {
            for known in &mut out[..boxes.len()] {
                *known = known.map(|bounds| bounds.map(|bound| bound * scale));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_cell_of_the_coarse_grid_holds_one_point() {
        let bounds = Bounds { min: [-1.0, 10.0, -300.0], max: [1.0, 15.0, 200.0] };
        let size = bounds.hi() - bounds.lo();
        let mut cells: Vec<[i32; 3]> = spread(&bounds)
            .map(|p| ((p.as_dvec3() - bounds.lo()) / size * 5.0).to_array().map(|k| k.floor() as i32))
            .collect();
        cells.sort_unstable();
        let all = (0..125).map(|i| [i / 25, i / 5 % 5, i % 5]);
        assert_eq!(cells, all.collect::<Vec<_>>());
    }
}
