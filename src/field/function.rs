//! Fields given by functions of the program.

use super::{
    Evaluator, Field, Frame, Jet, MaybeSend, MaybeSync, Pointwise, difference_step, jet_by_differences,
};
use crate::math::Sym3;
use glam::DVec3;

/// Steps of second differences are this many times those of first ones: ε^¼ in place of ε^⅓, the best compromise between the error
/// of the formula, of order h², and that of rounding, of order ε/h².
pub(super) const SECOND: f64 = 20.0;

/// A field given by a function of a point, with its gradient or without.
///
/// f is negative inside the surface; where it is undefined it returns NaN. Derivatives that are not
/// given are found by differences, with four evaluations for a gradient and nineteen for a Hessian:
/// a gradient makes sampling several times as fast. There are no bounds to prove by that every
/// component of the surface was found, and edges are not known: a surface with edges, as the union
/// of two bodies by `min`, is sampled as if it were smooth, and its mesh may be open there. A
/// [`Formula`](crate::Formula) with `min`, `max` and `abs` has its edges.
///
/// Give the box of the surface where it is known ([`Settings::in_box`](crate::Settings::in_box)). Without one, grids of 32 cells a side look
/// for changes of sign over cubes around the origin, from ±4 to ±10,000, each four or five times as wide as the one before. The box is fitted to
/// what lies in the smallest cube through whose faces the surface does not pass. What is smaller than the cells of its grid is not seen, and a
/// small part far away is missed without a word. Where a larger grid shows more, a warning says so
/// ([`Warning::Beyond`](crate::Warning::Beyond)); where none shows anything, [`Error::NoBox`](crate::Error::NoBox) does.
///
/// ```
/// use glam::DVec3;
/// use marching_particles::{FnField, Settings, sample};
///
/// let sphere = FnField::new(|p: DVec3| p.length() - 1.0).with_gradient(|p| p.normalize_or_zero());
/// assert_eq!(sample(sphere, &Settings::with_count(500))?.report().proof.components, 1);
/// # Ok::<(), marching_particles::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct FnField<F, G = fn(DVec3) -> DVec3> {
    value: F,
    gradient: Option<G>,
}

impl<F: Fn(DVec3) -> f64> FnField<F> {
    /// The field with the function `value`.
    pub fn new(value: F) -> Self {
        Self { value, gradient: None }
    }
}

impl<F, G> FnField<F, G> {
    /// Returns the field with `gradient` as its gradient function.
    pub fn with_gradient<H: Fn(DVec3) -> DVec3>(self, gradient: H) -> FnField<F, H> {
        FnField { value: self.value, gradient: Some(gradient) }
    }
}

impl<F, G> Field for FnField<F, G>
where
    F: Fn(DVec3) -> f64 + MaybeSend + MaybeSync,
    G: Fn(DVec3) -> DVec3 + MaybeSend + MaybeSync,
{
    fn value(&self, p: DVec3) -> f64 {
        (self.value)(p)
    }

    fn value_and_gradient(&self, p: DVec3) -> (f64, DVec3) {
        if let Some(gradient) = &self.gradient {
            return ((self.value)(p), gradient(p));
        }
        let jet = self.jet(p);
        (jet.value, jet.gradient)
    }

    fn jet(&self, p: DVec3) -> Jet {
        Stepped { field: self, step: &difference_step }.jet(p)
    }

    /// Derivatives that are not given are differences over steps that suit the frame, those of
    /// first order forward ones.
    fn evaluator(&self, frame: Frame) -> Box<dyn Evaluator + '_> {
        Box::new(Pointwise { field: Stepped { field: self, step: move |p| frame.step(p) }, frame })
    }
}

/// The field with steps of this length at a point.
struct Stepped<'a, F, G, S> {
    field: &'a FnField<F, G>,
    step: S,
}

impl<F, G, S> Field for Stepped<'_, F, G, S>
where
    F: Fn(DVec3) -> f64 + MaybeSend + MaybeSync,
    G: Fn(DVec3) -> DVec3 + MaybeSend + MaybeSync,
    S: Fn(DVec3) -> f64 + MaybeSend + MaybeSync,
{
    fn value(&self, p: DVec3) -> f64 {
        (self.field.value)(p)
    }

    fn value_and_gradient(&self, p: DVec3) -> (f64, DVec3) {
        if self.field.gradient.is_some() {
            return self.field.value_and_gradient(p);
        }
        let h = (self.step)(p);
        let f = core::array::from_fn(|k| self.value(at_slope(p, k, h)));
        (f[0], slope(f, h))
    }

    fn jet(&self, p: DVec3) -> Jet {
        let h = (self.step)(p);
        if self.field.gradient.is_some() {
            return jet_by_differences(self, p, h);
        }
        jet(core::array::from_fn(|k| self.value(at_jet(p, k, SECOND * h))), SECOND * h)
    }
}

/// Place `k` of the four whose values give a gradient: the point itself, then one ahead along each axis.
pub(super) fn at_slope(p: DVec3, k: usize, h: f64) -> DVec3 {
    if k == 0 { p } else { p + DVec3::AXES[k - 1] * h }
}

/// The gradient by forward differences, from the values at the places of [`at_slope`]. Its error is
/// of order h: less than a ten-thousandth where the surface bends within a twentieth of the box,
/// and no more where a function computes in single precision.
pub(super) fn slope(f: [f64; SLOPE], h: f64) -> DVec3 {
    (DVec3::new(f[1], f[2], f[3]) - DVec3::splat(f[0])) / h
}

/// Number of values that a gradient takes, and a second-order jet.
pub(super) const SLOPE: usize = 4;
pub(super) const JET: usize = 19;

/// Place `k` of those whose values give a second-order jet: the point itself, one ahead and one
/// behind on each axis, and four around it in each plane of two axes.
pub(super) fn at_jet(p: DVec3, k: usize, h: f64) -> DVec3 {
    const SIGNS: [[f64; 2]; 4] = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];
    const PLANES: [[usize; 2]; 3] = [[0, 1], [0, 2], [1, 2]];
    match k.checked_sub(1) {
        None => p,
        Some(k @ 0..6) => p + DVec3::AXES[k / 2] * if k % 2 == 0 { h } else { -h },
        Some(k) => {
            let ([a, b], [s, t]) = (PLANES[(k - 6) / 4], SIGNS[(k - 6) % 4]);
            p + DVec3::AXES[a] * (s * h) + DVec3::AXES[b] * (t * h)
        }
    }
}

/// The second-order jet by central differences, from the values at the places of [`at_jet`].
pub(super) fn jet(f: [f64; JET], h: f64) -> Jet {
    let value = f[0];
    let [x, y, z] = [1, 3, 5].map(|k| (f[k] - f[k + 1]) / (2.0 * h));
    let [xx, yy, zz] = [1, 3, 5].map(|k| (f[k] - 2.0 * value + f[k + 1]) / (h * h));
    let [xy, xz, yz] = [7, 11, 15].map(|k| (f[k] - f[k + 1] - f[k + 2] + f[k + 3]) / (4.0 * h * h));
    Jet { value, gradient: DVec3::new(x, y, z), hessian: Sym3 { xx, xy, xz, yy, yz, zz } }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Frame;

    /// f = x² y + sin z, with all derivatives known.
    fn value(p: DVec3) -> f64 {
        p.x * p.x * p.y + libm::sin(p.z)
    }

    fn gradient(p: DVec3) -> DVec3 {
        DVec3::new(2.0 * p.x * p.y, p.x * p.x, libm::cos(p.z))
    }

    fn assert_is_near(jet: &Jet, p: DVec3) {
        assert!((jet.value - value(p)).abs() < 1e-14, "{jet:?}");
        assert!((jet.gradient - gradient(p)).length() < 1e-8, "{jet:?}");
        let Sym3 { xx, xy, xz, yy, yz, zz } = jet.hessian;
        let expected = [2.0 * p.y, 2.0 * p.x, 0.0, 0.0, 0.0, -libm::sin(p.z)];
        for (found, expected) in [xx, xy, xz, yy, yz, zz].into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-5, "{jet:?}");
        }
    }

    #[test]
    fn derivatives_by_differences_are_near_the_known_ones_around_any_origin() {
        for origin in [DVec3::ZERO, DVec3::new(3.0, -2.0, 1.0)] {
            for p in [DVec3::new(0.3, -0.7, 0.4), DVec3::new(-1.2, 0.1, 2.0)] {
                let plain = FnField::new(value);
                assert_is_near(&plain.evaluator(Frame::around(origin)).jet(p - origin), p);
                let given = FnField::new(value).with_gradient(gradient);
                assert_is_near(&given.evaluator(Frame::around(origin)).jet(p - origin), p);
            }
        }
    }
}
