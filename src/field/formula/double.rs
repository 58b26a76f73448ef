//! Evaluation of batches in double precision, for formulas whose values single precision cannot hold.
//!
//! In place of f stands arsinh(f/s), which has the same zeros and signs. Near the surface it is f/s; where f grows
//! beyond all bounds it grows like a logarithm, so that a number in single precision holds it.

use super::Jet;
use crate::math::Sym3;
use glam::Vec3;

/// The second-order jet of arsinh(f/s) in single precision, for that of f and a positive s; not finite where f is not.
pub(super) fn compressed(jet: &Jet, scale: f64) -> (f32, Vec3, Sym3<f32>) {
    let value = libm::asinh(jet.value / scale) as f32;
    // d/df arsinh(f/s) = 1/√(s² + f²), and its derivative is −f/√(s² + f²)³.
    let size = libm::hypot(scale, jet.value);
    let gradient = jet.gradient / size;
    let bend = -jet.value / size;
    let second = |h: f64, a: f64, b: f64| (h / size + bend * a * b) as f32;
    let (h, g) = (&jet.hessian, gradient);
    let hessian = Sym3 {
        xx: second(h.xx, g.x, g.x),
        xy: second(h.xy, g.x, g.y),
        xz: second(h.xz, g.x, g.z),
        yy: second(h.yy, g.y, g.y),
        yz: second(h.yz, g.y, g.z),
        zz: second(h.zz, g.z, g.z),
    };
    (value, gradient.as_vec3(), hessian)
}

/// The jet of f/s.
pub(super) fn scaled(jet: Jet, scale: f64) -> Jet {
    let hessian = jet.hessian.map(|entry| entry / scale);
    Jet { value: jet.value / scale, gradient: jet.gradient / scale, hessian }
}
