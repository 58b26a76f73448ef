//! Evaluation of batches in double precision, for formulas whose coordinates or values single precision cannot hold.
//!
//! Where it cannot hold the values, arsinh(f/s) stands in place of f. It has the same zeros and signs. Near the surface it is
//! f/s; where f grows beyond all bounds it grows like a logarithm, so that a number in single precision holds it.

use super::Jet;
use crate::math::Sym3;
use glam::{DVec3, Vec3};

/// f in single precision or, with a scale s, arsinh(f/s).
pub(super) fn value(f: f64, scale: Option<f64>) -> f32 {
    scale.map_or(f, |scale| libm::asinh(f / scale)) as f32
}

/// f and ∇f in single precision or, with a scale s, those of arsinh(f/s); not finite where f is not.
pub(super) fn gradient((f, gradient): (f64, DVec3), scale: Option<f64>) -> (f32, Vec3) {
    // d/df arsinh(f/s) = 1/√(s² + f²)
    let size = scale.map_or(1.0, |scale| libm::hypot(scale, f));
    (value(f, scale), (gradient / size).as_vec3())
}

/// The second-order jet of f in single precision or, with a scale s, that of arsinh(f/s); not finite where f is not.
pub(super) fn hessian(jet: &Jet, scale: Option<f64>) -> (f32, Vec3, Sym3<f32>) {
    let (value, slope) = gradient((jet.value, jet.gradient), scale);
    let Some(scale) = scale else {
        return (value, slope, jet.hessian.map(|entry| entry as f32));
    };
    // The second derivative of arsinh(f/s) is −f/√(s² + f²)³.
    let size = libm::hypot(scale, jet.value);
    let (g, bend) = (jet.gradient / size, -jet.value / size);
    let second = |h: f64, a: f64, b: f64| (h / size + bend * a * b) as f32;
    let h = &jet.hessian;
    let hessian = Sym3 {
        xx: second(h.xx, g.x, g.x),
        xy: second(h.xy, g.x, g.y),
        xz: second(h.xz, g.x, g.z),
        yy: second(h.yy, g.y, g.y),
        yz: second(h.yz, g.y, g.z),
        zz: second(h.zz, g.z, g.z),
    };
    (value, slope, hessian)
}

/// The jet of f/s.
pub(super) fn scaled(jet: Jet, scale: f64) -> Jet {
    let hessian = jet.hessian.map(|entry| entry / scale);
    Jet { value: jet.value / scale, gradient: jet.gradient / scale, hessian }
}
