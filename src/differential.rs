//! Curvature of the surface f = const through a point: principal curvatures and directions from ∇f
//! and ∇∇f (paper §5).
//!
//! With the unit normal n = ∇f/|∇f| and a tangent basis u, v, the shape operator is [a b; b c] =
//! [uᵀHu uᵀHv; uᵀHv vᵀHv] / |∇f|, and κ = (a + c)/2 ± √(((a − c)/2)² + b²). One formula serves
//! double precision (the oracle, figures) and lanes of single precision.
//!
//! # Outcomes
//!
//! * *Umbilics* (κ₁ = κ₂: spheres, planes): every tangent direction is principal; the first one of
//!   the tangent basis is given.
//! * *Undefined*: where ∇f vanishes, where anything is not finite, and where |∇f|² leaves the range
//!   of the numbers (in single precision |∇f| below 10⁻¹⁹ or above 10¹⁹), every entry is NaN; see
//!   [`Curvature::is_defined`].

use crate::field::{BATCH, Evaluator, Jet};
use crate::math::{LANES, Lanes, Real, Sym3, frame_of};
use glam::{DVec3, Vec3};

/// Principal curvatures at a point of a surface, in units of 1/length.
///
/// The curvatures are positive where the surface bends away from its outward normal, as a sphere
/// does: that of radius R has κ₁ = κ₂ = 1/R.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Curvature<T = f32, V = Vec3> {
    /// Principal curvature κ₁, the larger one.
    pub k1: T,
    /// Principal curvature κ₂, the smaller one.
    pub k2: T,
    /// Unit principal direction of κ₁, of either sign. That of κ₂ is perpendicular to it and to the
    /// normal.
    pub direction: V,
}

impl<T: Real + PartialEq, V> Curvature<T, V> {
    /// Returns the mean curvature (κ₁ + κ₂)/2.
    #[must_use]
    pub fn mean(&self) -> T {
        T::of(0.5) * (self.k1 + self.k2)
    }

    /// Returns the Gaussian curvature κ₁ κ₂.
    #[must_use]
    pub fn gaussian(&self) -> T {
        self.k1 * self.k2
    }

    /// Returns max(|κ₁|, |κ₂|), the curvature of the most curved normal section.
    #[must_use]
    pub fn max_abs(&self) -> T {
        // The larger magnitude is |a + b|/2 + |a − b|/2, without a comparison.
        T::of(0.5) * ((self.k1 + self.k2).abs() + (self.k1 - self.k2).abs())
    }

    /// Returns whether the curvature is defined.
    #[must_use]
    pub fn is_defined(&self) -> bool {
        // Only NaN is not equal to itself.
        #[expect(clippy::eq_op, reason = "the test for NaN that every kind of number has")]
        let defined = self.k1 == self.k1;
        defined
    }
}

/// Returns the curvature in double precision: the oracle of the other functions.
#[must_use]
pub fn exact_curvature(jet: &Jet) -> Curvature<f64, DVec3> {
    let [k1, k2, x, y, z] = principal(jet.gradient.to_array(), &jet.hessian);
    Curvature { k1, k2, direction: DVec3::new(x, y, z) }
}

/// Computes the curvature at each of the `points`, of the level set of the field through it.
///
/// # Panics
///
/// If `out` is shorter than `points`.
pub fn curvatures(field: &mut dyn Evaluator, points: &[Vec3], out: &mut [Curvature]) {
    let mut value = [0.0; BATCH];
    let mut gradient = [Vec3::ZERO; BATCH];
    let mut hessian = [Sym3::default(); BATCH];
    for (points, out) in points.chunks(BATCH).zip(out[..points.len()].chunks_mut(BATCH)) {
        let n = points.len();
        field.hessians(points, &mut value[..n], &mut gradient[..n], &mut hessian[..n]);
        curvatures_of(&gradient[..n], &hessian[..n], out);
    }
}

/// Computes the curvature for each pair of a gradient and a Hessian, in lanes.
///
/// # Panics
///
/// If the slices differ in length.
pub fn curvatures_of(gradient: &[Vec3], hessian: &[Sym3<f32>], out: &mut [Curvature]) {
    assert!(gradient.len() == hessian.len() && gradient.len() == out.len(), "one curvature for each point");
    for (first, out) in (0..).step_by(LANES).zip(out.chunks_mut(LANES)) {
        let mut entries = [[0.0; LANES]; 9];
        for k in 0..LANES {
            // The first point fills up the last chunk.
            let i = first + if k < out.len() { k } else { 0 };
            let (g, h) = (&gradient[i], &hessian[i]);
            let of_point = [g.x, g.y, g.z, h.xx, h.xy, h.xz, h.yy, h.yz, h.zz];
            for (entry, value) in entries.iter_mut().zip(of_point) {
                entry[k] = value;
            }
        }
        let [x, y, z, xx, xy, xz, yy, yz, zz] = entries.map(Lanes);
        let [k1, k2, x, y, z] = principal([x, y, z], &Sym3 { xx, xy, xz, yy, yz, zz });
        for (k, out) in out.iter_mut().enumerate() {
            let direction = Vec3::new(x.0[k], y.0[k], z.0[k]);
            *out = Curvature { k1: k1.0[k], k2: k2.0[k], direction };
        }
    }
}

/// Returns κ₁, κ₂ and the direction of κ₁.
fn principal<T: Real>(gradient: [T; 3], hessian: &Sym3<T>) -> [T; 5] {
    let dot = |a: [T; 3], b: [T; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let slope_sq = dot(gradient, gradient);
    // 0/0 and ∞/∞ give NaN in all that follows.
    let inverse_slope = slope_sq.sqrt() / slope_sq;
    let (u, v) = frame_of(gradient.map(|g| g * inverse_slope));
    let (hu, hv) = (hessian.times(u), hessian.times(v));
    let (a, b, c) = (dot(u, hu), dot(v, hu), dot(v, hv));
    let half = T::of(0.5);
    let (mean, h) = (half * (a + c), half * (a - c));
    let root = (h * h + b * b).sqrt();
    // There are two forms of the eigenvector of the larger eigenvalue in (u, v); this is the one
    // without cancellation.
    let long = root + h.abs();
    let (s, t) = (h.positive(long, b), h.positive(b, long));
    let length = (s * s + t * t).sqrt();
    let (s, t) = (length.positive(s / length, T::of(1.0)), length.positive(t / length, T::of(0.0)));
    let k = [(mean + root) * inverse_slope, (mean - root) * inverse_slope];
    let d: [T; 3] = core::array::from_fn(|i| u[i] * s + v[i] * t);
    // The guard is 0, or NaN if any entry is not finite.
    let guard = (k[0] + k[1] + d[0] + d[1] + d[2]) * T::of(0.0);
    [k[0] + guard, k[1] + guard, d[0] + guard, d[1] + guard, d[2] + guard]
}
