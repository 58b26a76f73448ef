//! Elementary functions in single precision.
#![allow(missing_docs)]

/// −1, 0 or 1; NaN for NaN.
#[inline(always)]
#[must_use]
pub fn sign(a: f32) -> f32 {
    if a == 0.0 {
        0.0
    } else if a.is_nan() {
        a
    } else {
        1.0_f32.copysign(a)
    }
}
#[inline(always)]
#[must_use]
pub fn min(a: f32, b: f32) -> f32 {
    let least = if a < b { a } else { b };
    if a.is_nan() { a } else { least }
}
#[inline(always)]
#[must_use]
pub fn max(a: f32, b: f32) -> f32 {
    let most = if a > b { a } else { b };
    if a.is_nan() { a } else { most }
}
#[inline(always)]
#[must_use]
pub fn floor(a: f32) -> f32 {
    libm::floorf(a)
}
macro_rules! all { ($($name:ident $f:path),*) => { $(pub fn $name(values: &mut [f32]) { for v in values { *v = $f(f64::from(*v)) as f32; } })* } }
all!(cbrt_all libm::cbrt, exp_all libm::exp, ln_all libm::log, log10_all libm::log10, sin_all libm::sin, cos_all libm::cos, tan_all libm::tan, asin_all libm::asin, acos_all libm::acos, atan_all libm::atan, sinh_all libm::sinh, cosh_all libm::cosh, tanh_all libm::tanh);
pub fn pow_all(a: &mut [f32], b: &[f32]) {
    for (a, b) in a.iter_mut().zip(b) {
        *a = if a.is_nan() || b.is_nan() { f32::NAN } else { libm::pow(f64::from(*a), f64::from(*b)) as f32 }
    }
}
pub fn atan2_all(a: &mut [f32], b: &[f32]) {
    for (a, b) in a.iter_mut().zip(b) {
        *a = libm::atan2(f64::from(*a), f64::from(*b)) as f32
    }
}
