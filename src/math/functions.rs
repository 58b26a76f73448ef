//! Elementary functions in single precision, with the same bits on every platform.
//!
//! Each function is straight-line code over additions, products, quotients, square roots,
//! comparisons and shifts, so that [`Lanes::map`](super::Lanes::map) of it becomes SIMD code; no
//! platform library and no fused multiply-add is involved. Errors are given in units in the last
//! place (ulp) of the exact result, and are held to double-precision references in
//! `tests/it/formula_functions.rs`.
//!
//! Conventions: NaN in, NaN out, always; NaN where a function is undefined; ±∞ at poles.
//!
//! The minimax coefficients of exp, ln, sin, cos, asin, atan, sinh and tanh are those of Moshier,
//! *Methods and Programs for Mathematical Functions* (1989), single precision.

#![expect(clippy::excessive_precision, reason = "a coefficient's digits are those of its source, or exact")]

use core::f32::consts::{FRAC_PI_2, FRAC_PI_4};

/// 1.5 · 2²³: adding it to a number with an absolute value below 2²² rounds that number to an
/// integer, which is then in the low bits of the sum.
pub(crate) const ROUNDER: f32 = 12_582_912.0;

/// 1.5 · 2⁵²: [`ROUNDER`] in double precision.
pub(crate) const ROUNDER_F64: f64 = 6_755_399_441_055_744.0;

/// π/2 in two parts, the first of 33 bits, so that its multiples by up to 2²⁰ are exact.
pub(crate) const HALF_PI: [f64; 2] = [1.570_796_326_734_125_6, 6.077_100_506_506_192e-11];

/// 2²³: from here on every single-precision number is an integer.
const ALL_INTEGERS: f32 = 8_388_608.0;

/// Sign of a number: −1, 0 or 1.
#[inline]
#[must_use]
pub fn sign(a: f32) -> f32 {
    let unit = 1.0_f32.copysign(a);
    if a == 0.0 || a.is_nan() { a } else { unit }
}

/// The lesser of two numbers.
#[inline]
#[must_use]
pub fn min(a: f32, b: f32) -> f32 {
    let least = if a < b { a } else { b };
    if a.is_nan() { a } else { least }
}

/// The greater of two numbers.
#[inline]
#[must_use]
pub fn max(a: f32, b: f32) -> f32 {
    let most = if a > b { a } else { b };
    if a.is_nan() { a } else { most }
}

/// The greatest integer not above `a`; exact.
#[inline]
#[must_use]
pub fn floor(a: f32) -> f32 {
    let size = a.abs();
    let rounded = ((size + ALL_INTEGERS) - ALL_INTEGERS).copysign(a);
    let floor = if rounded > a { rounded - 1.0 } else { rounded };
    if size < ALL_INTEGERS { floor } else { a }
}

/// `a` clamped to `lo … hi`; NaN stays NaN.
#[inline]
fn cut(a: f32, lo: f32, hi: f32) -> f32 {
    let a = if a < lo { lo } else { a };
    if a > hi { hi } else { a }
}

/// 2^k for −126 ≤ k ≤ 127.
#[inline]
fn two_to(k: i32) -> f32 {
    f32::from_bits((k.wrapping_add(127) as u32) << 23)
}

/// m · 2^k, rounded once more if the result is subnormal; |k| ≤ 252.
#[inline]
fn scaled(m: f32, k: i32) -> f32 {
    let half = k >> 1;
    m * two_to(half) * two_to(k.wrapping_sub(half))
}

/// e^a · 2^shift.
#[inline]
fn exp_scaled(a: f32, shift: i32) -> f32 {
    /// ln 2 in two parts, the first of 9 bits, so that its multiples by up to 2¹⁴ are exact.
    const LN_2: [f32; 2] = [0.693_359_375, -2.121_944_4e-4];
    // Beyond these the result is 0 or infinite, shifted or not.
    let a = cut(a, -105.0, 91.0);
    let t = a * core::f32::consts::LOG2_E + ROUNDER;
    let n = t - ROUNDER;
    let k = t.to_bits().wrapping_sub(ROUNDER.to_bits()) as i32;
    let r = (a - n * LN_2[0]) - n * LN_2[1];
    let p = ((((1.987_569_1e-4 * r + 1.398_2e-3) * r + 8.333_452e-3) * r + 4.166_579_6e-2) * r
        + 1.666_666_5e-1)
        * r
        + 5.000_000_1e-1;
    scaled(p * (r * r) + r + 1.0, k.wrapping_add(shift))
}

/// e^a.
#[inline]
#[must_use]
pub fn exp(a: f32) -> f32 {
    exp_scaled(a, 0)
}

/// Natural logarithm: −∞ at 0, NaN below.
#[inline]
#[must_use]
pub fn ln(a: f32) -> f32 {
    let (e, m) = exponent_and_mantissa(a);
    let f = m - 1.0;
    let z = f * f;
    let p = (((((((7.037_683_6e-2 * f - 1.151_461e-1) * f + 1.167_699_9e-1) * f - 1.242_014_1e-1) * f
        + 1.424_932_3e-1)
        * f
        - 1.666_805_8e-1)
        * f
        + 2.000_071_5e-1)
        * f
        - 2.499_999_4e-1)
        * f
        + 3.333_333_1e-1;
    // ln 2 in two parts, as for the exponential.
    let low = p * f * z - 2.121_944_4e-4 * e - 0.5 * z;
    let result = f + low + 0.693_359_375 * e;
    logarithm_edges(a, result)
}

/// Logarithm to base 10: −∞ at 0, NaN below.
#[inline]
#[must_use]
pub fn log10(a: f32) -> f32 {
    ln(a) * core::f32::consts::LOG10_E
}

/// `result` for positive finite `a`, else the limits.
#[inline]
fn logarithm_edges(a: f32, result: f32) -> f32 {
    let result = if a < f32::INFINITY { result } else { a };
    let result = if a == 0.0 { f32::NEG_INFINITY } else { result };
    if a < 0.0 { f32::NAN } else { result }
}

/// e and m with a = m · 2^e and √½ ≤ m < √2, for positive finite `a`.
#[inline]
fn exponent_and_mantissa(a: f32) -> (f32, f32) {
    /// √½.
    const LEAST: u32 = 0x3f35_04f3;
    let subnormal = a < f32::MIN_POSITIVE;
    let a = if subnormal { a * ALL_INTEGERS } else { a };
    let offset = a.to_bits().wrapping_sub(LEAST);
    let e = (offset as i32) >> 23;
    let m = f32::from_bits((offset & 0x007f_ffff).wrapping_add(LEAST));
    let e = e as f32;
    (if subnormal { e - 23.0 } else { e }, m)
}

/// The quadrant k of an angle and the remainder: a = k π/2 + r, |r| ≤ π/4. The reduction is in
/// double precision, so that r keeps its relative accuracy up to |a| of about 10⁶.
#[inline]
fn quadrant(a: f32) -> (u32, f32) {
    let a = f64::from(a);
    let t = a * core::f64::consts::FRAC_2_PI + ROUNDER_F64;
    let n = t - ROUNDER_F64;
    let r = (a - n * HALF_PI[0]) - n * HALF_PI[1];
    // Past 10¹⁵ the rounding fails; clamping keeps sine and cosine within −1 … 1 there.
    (t.to_bits() as u32, cut(r as f32, -FRAC_PI_4, FRAC_PI_4))
}

/// sin r for |r| ≤ π/4.
#[inline]
fn sine_polynomial(r: f32) -> f32 {
    let z = r * r;
    ((-1.951_529_6e-4 * z + 8.332_161e-3) * z - 1.666_665_5e-1) * z * r + r
}

/// cos r for |r| ≤ π/4.
#[inline]
fn cosine_polynomial(r: f32) -> f32 {
    let z = r * r;
    ((2.443_315_7e-5 * z - 1.388_731_6e-3) * z + 4.166_664_6e-2) * z * z - 0.5 * z + 1.0
}

/// The sine in quadrant `k`, from the sine and cosine of the remainder.
#[inline]
fn turned(k: u32, sine: f32, cosine: f32) -> f32 {
    let value = if k & 1 == 0 { sine } else { cosine };
    f32::from_bits(value.to_bits() ^ ((k & 2) << 30))
}

/// Sine of an angle in radians; NaN at ±∞. Accurate to 2 ulp up to |a| = 10⁶, and to 10⁻⁶ in the
/// value up to 10⁹.
#[inline]
#[must_use]
pub fn sin(a: f32) -> f32 {
    let (k, r) = quadrant(a);
    turned(k, sine_polynomial(r), cosine_polynomial(r))
}

/// Cosine of an angle in radians; accurate like [`sin`].
#[inline]
#[must_use]
pub fn cos(a: f32) -> f32 {
    let (k, r) = quadrant(a);
    turned(k.wrapping_add(1), sine_polynomial(r), cosine_polynomial(r))
}

/// Tangent of an angle in radians, to 4 ulp up to |a| = 10⁶.
#[inline]
#[must_use]
pub fn tan(a: f32) -> f32 {
    let (k, r) = quadrant(a);
    let (sine, cosine) = (sine_polynomial(r), cosine_polynomial(r));
    let odd = k & 1 == 1;
    let above = if odd { -cosine } else { sine };
    let below = if odd { sine } else { cosine };
    above / below
}

/// Difference between π/2 and its value in single precision.
const HALF_PI_REST: f32 = -4.371_139e-8;

/// For 0 ≤ a ≤ 1: asin of a where a ≤ ½, and of √((1 − a)/2), half of acos a, elsewhere.
#[inline]
fn asin_core(a: f32) -> f32 {
    let large = a > 0.5;
    let z = if large { 0.5 * (1.0 - a) } else { a * a };
    let root = z.sqrt();
    let s = if large { root } else { a };
    ((((4.216_32e-2 * z + 2.418_131_1e-2) * z + 4.547_002_6e-2) * z + 7.495_300_3e-2) * z + 1.666_675_2e-1)
        * z
        * s
        + s
}

/// Inverse sine in radians; NaN outside −1 … 1.
#[inline]
#[must_use]
pub fn asin(a: f32) -> f32 {
    let size = a.abs();
    let p = asin_core(size);
    let result = if size > 0.5 { FRAC_PI_2 - (2.0 * p - HALF_PI_REST) } else { p };
    result.copysign(a)
}

/// Inverse cosine in radians; NaN outside −1 … 1.
#[inline]
#[must_use]
pub fn acos(a: f32) -> f32 {
    let size = a.abs();
    let p = asin_core(size);
    let far = if a > 0.0 { 2.0 * p } else { core::f32::consts::PI - 2.0 * p };
    let near = FRAC_PI_2 - (p.copysign(a) - HALF_PI_REST);
    if size > 0.5 { far } else { near }
}

/// atan q for |q| ≤ tan(π/8).
#[inline]
fn atan_polynomial(q: f32) -> f32 {
    let z = q * q;
    (((8.053_744_5e-2 * z - 1.387_768_6e-1) * z + 1.997_771_1e-1) * z - 3.333_295e-1) * z * q + q
}

/// Inverse tangent in radians.
#[inline]
#[must_use]
pub fn atan(a: f32) -> f32 {
    /// tan(3π/8) and tan(π/8).
    const STEPS: [f32; 2] = [2.414_213_6, 0.414_213_57];
    let size = a.abs();
    let (far, middle) = (size > STEPS[0], size > STEPS[1]);
    let above = if middle { size - 1.0 } else { size };
    let above = if far { -1.0 } else { above };
    let below = if middle { size + 1.0 } else { 1.0 };
    let below = if far { size } else { below };
    let base = if middle { FRAC_PI_4 } else { 0.0 };
    let base = if far { FRAC_PI_2 } else { base };
    (base + atan_polynomial(above / below)).copysign(a)
}

/// The angle of the point (`across`, `up`) in radians, −π to π; at the origin 0 or ±π, by the signs
/// of the zeros.
#[inline]
#[must_use]
pub fn atan2(up: f32, across: f32) -> f32 {
    /// tan(π/8).
    const STEP: f32 = 0.414_213_57;
    let (y, x) = (up.abs(), across.abs());
    let steep = y > x;
    let (lesser, greater) = if steep { (x, y) } else { (y, x) };
    let quotient = lesser / greater;
    let quotient = if greater == 0.0 { 0.0 } else { quotient };
    let quotient = if lesser == f32::INFINITY { 1.0 } else { quotient };
    let middle = quotient > STEP;
    let above = if middle { quotient - 1.0 } else { quotient };
    let below = if middle { quotient + 1.0 } else { 1.0 };
    let base = if middle { FRAC_PI_4 } else { 0.0 };
    let angle = base + atan_polynomial(above / below);
    let angle = if steep { FRAC_PI_2 - angle } else { angle };
    let angle = if across.is_sign_negative() { core::f32::consts::PI - angle } else { angle };
    let angle = angle.copysign(up);
    if up.is_nan() || across.is_nan() { f32::NAN } else { angle }
}

/// Hyperbolic sine.
#[inline]
#[must_use]
pub fn sinh(a: f32) -> f32 {
    let size = a.abs();
    let z = a * a;
    let near = ((2.037_219_1e-4 * z + 8.330_284e-3) * z + 1.666_671_6e-1) * z * a + a;
    let half = exp_scaled(size, -1);
    let far = (half - 0.25 / half).copysign(a);
    if size < 1.0 { near } else { far }
}

/// Hyperbolic cosine.
#[inline]
#[must_use]
pub fn cosh(a: f32) -> f32 {
    let half = exp_scaled(a.abs(), -1);
    half + 0.25 / half
}

/// Hyperbolic tangent.
#[inline]
#[must_use]
pub fn tanh(a: f32) -> f32 {
    let size = a.abs();
    let z = a * a;
    let near = ((((-5.704_988_7e-3 * z + 2.063_908_9e-2) * z - 5.373_971_6e-2) * z + 1.333_144_2e-1) * z
        - 3.333_328e-1)
        * z
        * a
        + a;
    let far = (1.0 - 2.0 / (exp(2.0 * size) + 1.0)).copysign(a);
    if size < 0.625 { near } else { far }
}

/// Cube root, also of negative numbers; correct to the last bit except for rare ties.
#[inline]
#[must_use]
pub fn cbrt(a: f32) -> f32 {
    /// A third of the exponent's bias, shifted so that the first guess errs by at most 4 %.
    const GUESS: u32 = 0x2a51_1d55;
    /// 2²⁴, whose cube root is 2⁸.
    const LIFT: f32 = 16_777_216.0;
    let size = a.abs();
    let subnormal = size < f32::MIN_POSITIVE;
    let lifted = if subnormal { size * LIFT } else { size };
    let guess = f64::from(f32::from_bits(lifted.to_bits() / 3 + GUESS));
    // Two steps of Halley's method: 4 % → 2e-5 → 1e-14.
    let x = f64::from(lifted);
    let step = |t: f64| {
        let cube = t * t * t;
        t * (x + x + cube) / (x + cube + cube)
    };
    let root = step(step(guess)) as f32;
    let root = if subnormal { root / 256.0 } else { root };
    let root = root.copysign(a);
    if a == 0.0 || size == f32::INFINITY { a } else { root }
}

/// a^b: for negative `a`, a number if `b` is an integer, else NaN; a^0 = 1; NaN if either is NaN.
/// The logarithm and the exponential are in double precision, for an error of 1 ulp at any size of
/// the result.
#[inline]
#[must_use]
pub fn pow(a: f32, b: f32) -> f32 {
    let size = a.abs();
    let (e, m) = exponent_and_mantissa(size);
    let m = f64::from(m);
    // ln m = 2 artanh s by its series: s² ≤ 0.0295, the first omitted term is below 2e-12.
    let s = (m - 1.0) / (m + 1.0);
    let z = s * s;
    let series = (((((z * (1.0 / 13.0) + 1.0 / 11.0) * z + 1.0 / 9.0) * z + 1.0 / 7.0) * z + 1.0 / 5.0) * z
        + 1.0 / 3.0)
        * z
        + 1.0;
    let logarithm = f64::from(e) * core::f64::consts::LN_2 + 2.0 * s * series;
    let logarithm = if size < f32::INFINITY { logarithm } else { f64::INFINITY };
    let logarithm = if size == 0.0 { f64::NEG_INFINITY } else { logarithm };
    let exponent = logarithm * f64::from(b);
    let w = if exponent < -105.0 { -105.0 } else { exponent };
    let w = if w > 90.0 { 90.0 } else { w };
    let t = w * core::f64::consts::LOG2_E + ROUNDER_F64;
    let r = w - (t - ROUNDER_F64) * core::f64::consts::LN_2;
    let k = t.to_bits() as i32;
    // e^r by its series: |r| ≤ 0.35, the first omitted term is below 3e-10.
    let p = (((((((r * (1.0 / 40320.0) + 1.0 / 5040.0) * r + 1.0 / 720.0) * r + 1.0 / 120.0) * r
        + 1.0 / 24.0)
        * r
        + 1.0 / 6.0)
        * r
        + 0.5)
        * r
        + 1.0)
        * r
        + 1.0;
    let positive = scaled(p as f32, k);
    // The exponent 0 · ∞ is NaN: 0^0, ∞^0 and 1^∞ are all 1.
    let positive = if exponent.is_nan() { 1.0 } else { positive };
    let whole = floor(b) == b;
    let half = 0.5 * b;
    let odd = whole && floor(half) != half;
    let flipped = if odd { -positive } else { positive };
    let defined = if whole { flipped } else { f32::NAN };
    let result = if a.is_sign_negative() { defined } else { positive };
    // −0 has a sign bit, but its powers are those of 0.
    let result = if a == 0.0 && !whole { positive } else { result };
    if a.is_nan() || b.is_nan() { f32::NAN } else { result }
}

/// [`sin`] and [`cos`] of the same angle.
#[inline]
#[must_use]
pub fn sin_cos(a: f32) -> (f32, f32) {
    let (k, r) = quadrant(a);
    let (sine, cosine) = (sine_polynomial(r), cosine_polynomial(r));
    (turned(k, sine, cosine), turned(k.wrapping_add(1), sine, cosine))
}
