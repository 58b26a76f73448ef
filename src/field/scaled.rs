//! A field times a constant. With the right one, squares of values and gradients neither overflow nor underflow in
//! single precision, whatever units a formula is in.

use super::{BATCH, Bounded, Branched, Enclosure, Field, Jet, UnitCell};
use crate::math::{Bounds, Interval, Sym3, median, power_of_two};
use glam::{DVec3, Vec3};

/// Largest gradient that needs no scale, and the inverse of the smallest. The square of such a gradient, and of a value a million
/// times smaller or larger, is a normal number in single precision.
const COMFORTABLE: f64 = (1_u64 << 40) as f64;

/// A field times a positive power of two, which has the same surface. No digit is lost.
pub(crate) struct Scaled<'a> {
    field: &'a mut dyn Field,
    scale: f32,
}

impl<'a> Scaled<'a> {
    /// `field` times `scale`, which [`comfortable_scale`] gives.
    pub(crate) fn new(field: &'a mut dyn Field, scale: f32) -> Self {
        Self { field, scale }
    }

    /// The other field, which has bounds wherever [`Field::bounded`] gives this one.
    fn bounded_field(&mut self) -> &mut dyn Bounded {
        self.field.bounded().expect("a field keeps its bounds")
    }
}

/// Power of two that brings the median magnitude of the gradient near 1, or 1 if that is not needed.
///
/// The gradient is sampled at no more than one batch of `points`. Because only the exponent of the median counts, nearly all
/// choices of points give the same scale.
pub(crate) fn comfortable_scale(field: &mut dyn Field, points: impl ExactSizeIterator<Item = Vec3>) -> f32 {
    let stride = points.len().div_ceil(BATCH).max(1);
    let points: Vec<Vec3> = points.step_by(stride).collect();
    let (mut value, mut gradient) = (vec![0.0; points.len()], vec![Vec3::ZERO; points.len()]);
    field.gradients(&points, &mut value, &mut gradient);
    let sizes = gradient.iter().map(|g| g.abs().max_element()).filter(|s| s.is_finite() && *s > 0.0);
    let Some(size) = median(sizes.collect()) else { return 1.0 };
    let size = power_of_two(size.into());
    if (1.0 / COMFORTABLE..=COMFORTABLE).contains(&size) {
        return 1.0;
    }
    (1.0 / size).clamp(f32::MIN_POSITIVE.into(), (1.0 / f32::MIN_POSITIVE).into()) as f32
}

/// Points of a coarse grid in a box, off its faces and its planes of symmetry.
pub(crate) fn spread(bounds: &Bounds) -> impl ExactSizeIterator<Item = Vec3> {
    /// 125 points fill one batch.
    const SIDE: usize = 5;
    bounds.spread(SIDE).map(|p| p.as_vec3())
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

    fn value_and_gradient(&mut self, p: DVec3) -> (f64, DVec3) {
        let scale = f64::from(self.scale);
        let (value, gradient) = self.field.value_and_gradient(p);
        (value * scale, gradient * scale)
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

    fn use_double(&mut self, scale: Option<f64>) {
        self.field.use_double(scale);
    }

    fn bounded(&mut self) -> Option<&mut dyn Bounded> {
        if self.field.bounded().is_some() { Some(self) } else { None }
    }

    fn origin(&self) -> DVec3 {
        self.field.origin()
    }

    fn set_origin(&mut self, origin: DVec3) {
        self.field.set_origin(origin);
    }

    fn sampled_as(&self) -> Option<String> {
        self.field.sampled_as()
    }

    fn why_constant(&self) -> Option<String> {
        self.field.why_constant()
    }

    /// The branches of the other field: what they are has no scale.
    fn branched(&mut self) -> Option<&mut dyn Branched> {
        self.field.branched()
    }

    fn periods(&self) -> [Option<f64>; 3] {
        self.field.periods()
    }

    fn unit_cell(&self) -> Option<UnitCell> {
        self.field.unit_cell()
    }
}

impl Bounded for Scaled<'_> {
    fn operations(&mut self) -> usize {
        self.bounded_field().operations()
    }

    fn factors(&mut self) -> usize {
        self.bounded_field().factors()
    }

    fn is_zero_of(&mut self, factor: usize, zero: DVec3) -> bool {
        self.bounded_field().is_zero_of(factor, zero)
    }

    fn enclose(&mut self, factor: usize, boxes: &[Bounds], out: &mut [Enclosure]) {
        let scale = f64::from(self.scale);
        self.bounded_field().enclose(factor, boxes, out);
        if scale != 1.0 {
            for known in &mut out[..boxes.len()] {
                known.value = known.value * scale;
                known.gradient = known.gradient.map(|slope| slope * scale);
            }
        }
    }

    fn enclose_second(&mut self, factor: usize, boxes: &[Bounds], out: &mut [Sym3<Interval>]) {
        let scale = f64::from(self.scale);
        self.bounded_field().enclose_second(factor, boxes, out);
        if scale != 1.0 {
            for known in &mut out[..boxes.len()] {
                *known = known.map(|bounds| bounds * scale);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::formula::Formula;

    #[test]
    fn a_scaled_field_is_the_other_field_in_every_way_but_its_size() {
        let formula = || Formula::as_written("exp(100 cos(x)) (cos(2y) + z)", &[]).expect("a formula");
        let (mut own, mut other) = (formula(), formula());
        own.set_origin(DVec3::new(0.5, 0.25, 0.125));
        other.set_origin(own.origin());
        let scaled = &mut Scaled::new(&mut other, 4.0);
        assert_eq!(scaled.periods(), own.periods());
        assert!(own.periods()[0].is_some() && own.periods()[2].is_none());
        assert_eq!(scaled.origin(), own.origin());
        let p = [Vec3::splat(0.1)];
        for double in [None, Some(1e9), None] {
            own.use_double(double);
            scaled.use_double(double);
            let ([mut a, mut b], [mut g, mut h]) = ([[0.0]; 2], [[Vec3::ZERO]; 2]);
            own.gradients(&p, &mut a, &mut g);
            scaled.gradients(&p, &mut b, &mut h);
            assert_eq!((4.0 * a[0], 4.0 * g[0]), (b[0], h[0]), "{double:?}");
            assert_eq!(4.0 * own.jet(DVec3::splat(0.1)).value, scaled.jet(DVec3::splat(0.1)).value);
        }
        let boxes = [Bounds::new(DVec3::ZERO, DVec3::splat(0.1))];
        let scaled = scaled.bounded().expect("a formula has bounds");
        assert_eq!((own.factors(), scaled.factors()), (2, 2));
        for factor in 0..2 {
            let [mut a, mut b] = [[Enclosure::UNKNOWN]; 2];
            own.enclose(factor, &boxes, &mut a);
            scaled.enclose(factor, &boxes, &mut b);
            assert_eq!(
                (a[0].value * 4.0, a[0].gradient.map(|slope| slope * 4.0)),
                (b[0].value, b[0].gradient)
            );
            let [mut a, mut b] = [[Sym3::splat(Interval::EVERYTHING)]; 2];
            own.enclose_second(factor, &boxes, &mut a);
            scaled.enclose_second(factor, &boxes, &mut b);
            assert_eq!(a[0].map(|bounds| bounds * 4.0), b[0]);
        }
        struct Unbounded;
        impl Field for Unbounded {
            fn value_and_gradient(&mut self, _: DVec3) -> (f64, DVec3) {
                (1.0, DVec3::X)
            }
        }
        assert!(Scaled::new(&mut Unbounded, 4.0).bounded().is_none());
    }

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
