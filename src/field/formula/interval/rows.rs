//! Interval arithmetic over a few boxes at once, in arrays that the compiler vectorises, or over a
//! single one.
//!
//! Only the most frequent operations are written out here. The others go through [`Range`], box by
//! box.

use super::flags::{CONTINUOUS, DEFINED, EMPTY, NONZERO, REGULAR, joined};
use super::range::{Range, absolute, down, greatest, least, up, widened};
use crate::field::formula::graph::whole_power;
use crate::field::formula::operations::sign;
use crate::math::Interval;
use crate::math::functions::{HALF_PI, ROUNDER_F64};
use crate::math::interval::product;
use core::ops::Mul;

/// Bounds of an operation over up to `N` boxes.
#[derive(Clone, Copy, Debug)]
pub(in crate::field::formula) struct Row<const N: usize> {
    lo: [f64; N],
    hi: [f64; N],
    flags: [u8; N],
}

/// The lower or the upper ends of a row.
#[derive(Clone, Copy)]
struct Ends<const N: usize>([f64; N]);

impl<const N: usize> Mul for Ends<N> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self(core::array::from_fn(|k| self.0[k] * other.0[k]))
    }
}

impl<const N: usize> Row<N> {
    pub(super) const ZERO: Self = Self { lo: [0.0; N], hi: [0.0; N], flags: [REGULAR; N] };

    /// Bounds over box `k`.
    pub(in crate::field::formula) fn at(&self, k: usize) -> Range {
        Range { bounds: self.interval(k), flags: self.flags[k] }
    }

    fn interval(&self, k: usize) -> Interval {
        Interval::new(self.lo[k], self.hi[k])
    }

    /// Returns a row with the same bounds over every box.
    pub(super) fn fill(range: Range) -> Self {
        Self { lo: [range.bounds.lo; N], hi: [range.bounds.hi; N], flags: [range.flags; N] }
    }

    /// `f` over each of the first `n` boxes.
    pub(super) fn each(n: usize, f: impl Fn(usize) -> Range) -> Self {
        let mut out = Self::ZERO;
        for k in 0..n {
            let range = f(k);
            (out.lo[k], out.hi[k], out.flags[k]) = (range.bounds.lo, range.bounds.hi, range.flags);
        }
        out
    }

    /// Row with the bounds that `f` gives for each box.
    fn bounds(f: impl Fn(usize) -> (f64, f64), flags: [u8; N]) -> Self {
        let mut out = Self { flags, ..Self::ZERO };
        for k in 0..N {
            (out.lo[k], out.hi[k]) = f(k);
        }
        out
    }

    fn joined(&self, other: &Self) -> [u8; N] {
        core::array::from_fn(|k| joined(self.flags[k], other.flags[k]))
    }

    pub(super) fn neg(&self) -> Self {
        Self::bounds(|k| (-self.hi[k], -self.lo[k]), self.flags)
    }

    pub(super) fn add(&self, other: &Self) -> Self {
        let sum = |k: usize| (down(self.lo[k] + other.lo[k]), up(self.hi[k] + other.hi[k]));
        Self::bounds(sum, self.joined(other))
    }

    pub(super) fn sub(&self, other: &Self) -> Self {
        let difference = |k: usize| (down(self.lo[k] - other.hi[k]), up(self.hi[k] - other.lo[k]));
        Self::bounds(difference, self.joined(other))
    }

    pub(super) fn mul(&self, other: &Self) -> Self {
        let mut out = Self::bounds(
            |k| {
                let (a, b, c, d) = (self.lo[k], self.hi[k], other.lo[k], other.hi[k]);
                let (p, q, r, s) = (product(a, c), product(a, d), product(b, c), product(b, d));
                (down(least(least(p, q), least(r, s))), up(greatest(greatest(p, q), greatest(r, s))))
            },
            self.joined(other),
        );
        for k in 0..N {
            out.flags[k] |= self.nonzero(k) & other.nonzero(k);
        }
        out
    }

    /// Product with an exact number.
    pub(super) fn scale(&self, factor: f64) -> Self {
        let flags = core::array::from_fn(|k| joined(self.flags[k], self.flags[k]));
        Self::bounds(
            |k| {
                let (p, q) = (product(self.lo[k], factor), product(self.hi[k], factor));
                (down(least(p, q)), up(greatest(p, q)))
            },
            flags,
        )
    }

    /// [`NONZERO`] if box `k` certainly has no value 0, else no flag.
    fn nonzero(&self, k: usize) -> u8 {
        self.flags[k] & NONZERO | if self.lo[k] > 0.0 || self.hi[k] < 0.0 { NONZERO } else { 0 }
    }

    /// Power with a natural exponent.
    pub(super) fn power(&self, n: u32) -> Self {
        let flags = core::array::from_fn(|k| joined(self.flags[k], self.flags[k]) | self.flags[k] & NONZERO);
        let base = if n.is_multiple_of(2) { self.abs() } else { *self };
        let ends = |ends: [f64; N]| whole_power(Ends([1.0; N]), Ends(ends), n).0;
        let (lo, hi) = (ends(base.lo), ends(base.hi));
        // There are at most 2 log₂ n products, each with an error of half a unit; squaring doubles
        // a relative error.
        let error = 2.0 * f64::from(n) * f64::EPSILON;
        Self::bounds(
            |k| (widened(lo[k], -error, f64::NEG_INFINITY), widened(hi[k], error, f64::INFINITY)),
            flags,
        )
    }

    pub(super) fn abs(&self) -> Self {
        let absolute = |k: usize| {
            let Interval { lo, hi } = absolute(self.interval(k));
            (lo, hi)
        };
        Self::bounds(absolute, self.flags)
    }

    pub(super) fn min(&self, other: &Self) -> Self {
        let lesser = |k: usize| (least(self.lo[k], other.lo[k]), least(self.hi[k], other.hi[k]));
        Self::bounds(lesser, self.joined(other))
    }

    pub(super) fn max(&self, other: &Self) -> Self {
        let greater = |k: usize| (greatest(self.lo[k], other.lo[k]), greatest(self.hi[k], other.hi[k]));
        Self::bounds(greater, self.joined(other))
    }

    pub(super) fn sqrt(&self) -> Self {
        let mut out = Self::bounds(
            |k| (down(greatest(self.lo[k], 0.0).sqrt()), up(greatest(self.hi[k], 0.0).sqrt())),
            core::array::from_fn(|k| joined(self.flags[k], self.flags[k])),
        );
        for k in 0..N {
            out.flags[k] &= if self.lo[k] < 0.0 { !DEFINED } else { !0 };
            out.flags[k] |= if self.hi[k] < 0.0 { EMPTY } else { 0 };
        }
        out
    }

    /// Sign, as the derivative of the absolute value: between −1 and 1 where the argument changes
    /// its sign.
    pub(super) fn sign(&self) -> Self {
        let mut out = Self::bounds(|k| (sign(self.lo[k]), sign(self.hi[k])), self.flags);
        for k in 0..N {
            out.flags[k] = joined(self.flags[k], self.flags[k]);
            out.flags[k] &= if out.lo[k] == out.hi[k] { !0 } else { !CONTINUOUS };
        }
        out
    }

    /// Sine or cosine of arguments with midpoint m and half-width h. The bounds follow from sin(m +
    /// t) = sin m cos t + cos m sin t with 1 − h²/2 ≤ cos t ≤ 1 and |sin t| ≤ h. They are wider
    /// than the range by a term of second order in h.
    pub(super) fn sine(&self, cosine: bool) -> Self {
        let flags = core::array::from_fn(|k| joined(self.flags[k], self.flags[k]));
        Self::bounds(
            |k| {
                let middle = 0.5 * (self.lo[k] + self.hi[k]);
                let half = greatest(middle - self.lo[k], self.hi[k] - middle);
                let (s, c) = sine_cosine(middle);
                // The derivative of the cosine is −sin m, but only its magnitude matters below.
                let (value, slope) = if cosine { (c, s) } else { (s, c) };
                let least_cosine = 1.0 - 0.5 * half * half;
                let other = value * least_cosine;
                let swing = slope.abs() * half + SINE_SLACK;
                let lo = greatest(least(value, other) - swing, -1.0);
                let hi = least(greatest(value, other) + swing, 1.0);
                // Both comparisons are false for NaN.
                let trusted = half <= 1.0 && middle.abs() <= LARGEST_SINE;
                if trusted { (lo, hi) } else { (-1.0, 1.0) }
            },
            flags,
        )
    }
}

/// Bound of the rounding error of [`Row::sine`], and more than twice that: sine and cosine err by
/// less than 10⁻¹⁵ each, as the test below shows, and neither factor of theirs is above 1; six
/// operations on numbers up to 2 err by 2⁻⁵² each.
const SINE_SLACK: f64 = 1e-14;

/// Largest angle for which [`sine_cosine`] is accurate to [`SINE_SLACK`]: it has less than 2¹⁶
/// quadrants.
const LARGEST_SINE: f64 = 1e5;

/// Sine and cosine for |x| ≤ 10⁵ with an error of a few 10⁻¹⁶.
///
/// The nearest multiple of π/2 is subtracted in two parts (W. J. Cody & W. Waite, "Software Manual
/// for the Elementary Functions", 1980). The Taylor series follows; its first omitted terms are
/// below 10⁻¹⁷ for |r| ≤ π/4.
#[inline]
fn sine_cosine(x: f64) -> (f64, f64) {
    let shifted = x * core::f64::consts::FRAC_2_PI + ROUNDER_F64;
    let quadrant = shifted.to_bits();
    let turns = shifted - ROUNDER_F64;
    let r = (x - turns * HALF_PI[0]) - turns * HALF_PI[1];
    let q = r * r;
    let mut sine = -1.0 / 1_307_674_368_000.0;
    for inverse in
        [1.0 / 6_227_020_800.0, -1.0 / 39_916_800.0, 1.0 / 362_880.0, -1.0 / 5_040.0, 1.0 / 120.0, -1.0 / 6.0]
    {
        sine = sine * q + inverse;
    }
    let sine = r + r * q * sine;
    let mut cosine = 1.0 / 20_922_789_888_000.0;
    for inverse in [
        -1.0 / 87_178_291_200.0,
        1.0 / 479_001_600.0,
        -1.0 / 3_628_800.0,
        1.0 / 40_320.0,
        -1.0 / 720.0,
        1.0 / 24.0,
        -0.5,
    ] {
        cosine = cosine * q + inverse;
    }
    let cosine = 1.0 + q * cosine;
    let swap = quadrant & 1 != 0;
    let (s, c) = if swap { (cosine, sine) } else { (sine, cosine) };
    let s = if quadrant & 2 != 0 { -s } else { s };
    let c = if (quadrant + 1) & 2 != 0 { -c } else { c };
    (s, c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sine_and_cosine_are_those_of_the_library() {
        for k in -200_000..200_000 {
            let x = f64::from(k) * 0.499_873;
            let (s, c) = sine_cosine(x);
            assert!((s - libm::sin(x)).abs() < 1e-15 && (c - libm::cos(x)).abs() < 1e-15, "{x}: {s} {c}");
        }
    }
}
