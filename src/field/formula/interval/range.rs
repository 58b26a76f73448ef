//! A single interval, with the operations that are too rare or too long for [rows](super::rows).

use super::flags::{CONTINUOUS, DEFINED, EMPTY, NONZERO, REGULAR, joined};
use crate::field::formula::graph::{MIN_BLEND_WIDTH, smin};
use crate::field::formula::operations::{Binary, Unary, sign};

/// Bounds of the values of an operation over a box, with its [other properties](super::flags).
#[derive(Clone, Copy, Debug)]
pub(super) struct Range {
    pub(super) lo: f64,
    pub(super) hi: f64,
    pub(super) flags: u8,
}

/// Relative widening of a bound that `libm` computed. Its functions err by less than two units in the last place.
const LIBRARY_ERROR: f64 = 8.0 * f64::EPSILON;

/// Largest argument of tangent whose position relative to the poles is trusted. Nothing is known of larger ones.
const TRUSTED_ANGLE: f64 = 1e9;

/// The empty range.
const NOTHING: Range = Range { lo: f64::INFINITY, hi: f64::NEG_INFINITY, flags: EMPTY };

/// Lower bound of a result that IEEE arithmetic rounded to `value`, at least one unit in the last place below it.
///
/// Subnormal results, which are below 2⁻¹⁰²² and have fewer digits, are taken for exact. NaN, from ∞ − ∞, becomes −∞.
pub(super) fn down(value: f64) -> f64 {
    widened(value, -f64::EPSILON, f64::NEG_INFINITY)
}

/// Upper bound of a result; see [`down`].
pub(super) fn up(value: f64) -> f64 {
    widened(value, f64::EPSILON, f64::INFINITY)
}

/// `value` moved by `share` of its magnitude, or `otherwise` for NaN.
pub(super) fn widened(value: f64, share: f64, otherwise: f64) -> f64 {
    let moved = value + value.abs() * share;
    if moved.is_nan() { otherwise } else { moved }
}

/// Lower bound of a result that a library function rounded to `value`.
fn well_below(value: f64) -> f64 {
    widened(value, -LIBRARY_ERROR, f64::NEG_INFINITY)
}

/// Upper bound of a result that a library function rounded to `value`.
fn well_above(value: f64) -> f64 {
    widened(value, LIBRARY_ERROR, f64::INFINITY)
}

/// Product of bounds. 0 · ∞ is 0, because an infinite bound stands for arbitrarily large finite values.
pub(super) fn product(a: f64, b: f64) -> f64 {
    let product = a * b;
    if product.is_nan() { 0.0 } else { product }
}

impl Range {
    /// The range from `lo` to `hi`. A NaN is replaced by an infinite bound.
    fn new(lo: f64, hi: f64, flags: u8) -> Self {
        let lo = if lo.is_nan() { f64::NEG_INFINITY } else { lo };
        let hi = if hi.is_nan() { f64::INFINITY } else { hi };
        Self { lo, hi, flags }
    }

    /// The unbounded range, of an operation that may have a pole.
    fn everything(flags: u8) -> Self {
        Self { lo: f64::NEG_INFINITY, hi: f64::INFINITY, flags: flags & EMPTY }
    }

    pub(super) fn exactly(value: f64) -> Self {
        if value.is_nan() { NOTHING } else { Self { lo: value, hi: value, flags: REGULAR } }
    }

    pub(super) fn is_empty(self) -> bool {
        self.flags & EMPTY != 0
    }

    /// Whether 0 is certainly not among the values.
    pub(super) fn is_nonzero(self) -> bool {
        self.flags & (NONZERO | EMPTY) != 0 || self.lo > 0.0 || self.hi < 0.0
    }

    fn holds(self, value: f64) -> bool {
        self.lo <= value && value <= self.hi
    }

    /// Intersection with `lo … hi`. If that is smaller, the operation is not defined everywhere in the box.
    fn cut(self, lo: f64, hi: f64) -> Self {
        let cut = Self { lo: self.lo.max(lo), hi: self.hi.min(hi), flags: self.flags };
        if cut.lo > cut.hi {
            NOTHING
        } else if self.lo >= lo && self.hi <= hi {
            cut
        } else {
            Self { flags: self.flags & !DEFINED, ..cut }
        }
    }

    /// Range of an increasing library function.
    fn increasing(self, f: fn(f64) -> f64) -> Self {
        Self::new(well_below(f(self.lo)), well_above(f(self.hi)), joined(self.flags, self.flags))
    }

    fn neg(self) -> Self {
        Self { lo: -self.hi, hi: -self.lo, flags: self.flags }
    }

    fn add(self, other: Self) -> Self {
        Self::new(down(self.lo + other.lo), up(self.hi + other.hi), joined(self.flags, other.flags))
    }

    fn mul(self, other: Self) -> Self {
        let corners = [
            product(self.lo, other.lo),
            product(self.lo, other.hi),
            product(self.hi, other.lo),
            product(self.hi, other.hi),
        ];
        let lo = corners.into_iter().fold(f64::INFINITY, f64::min);
        let hi = corners.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let nonzero = if self.is_nonzero() && other.is_nonzero() { NONZERO } else { 0 };
        Self::new(down(lo), up(hi), joined(self.flags, other.flags) | nonzero)
    }

    pub(super) fn reciprocal(self) -> Self {
        let flags = joined(self.flags, self.flags);
        if self.lo > 0.0 || self.hi < 0.0 {
            return Self::new(down(1.0 / self.hi), up(1.0 / self.lo), flags);
        }
        // There is a pole. On one side of it the values keep their sign; on both sides they are still not 0.
        let flags = flags & EMPTY | NONZERO;
        if self.lo == 0.0 && self.hi > 0.0 {
            Self { lo: down(1.0 / self.hi), hi: f64::INFINITY, flags }
        } else if self.hi == 0.0 && self.lo < 0.0 {
            Self { lo: f64::NEG_INFINITY, hi: up(1.0 / self.lo), flags }
        } else {
            Self { lo: f64::NEG_INFINITY, hi: f64::INFINITY, flags }
        }
    }

    fn abs(self) -> Self {
        if self.lo >= 0.0 {
            self
        } else if self.hi <= 0.0 {
            self.neg()
        } else {
            Self { lo: 0.0, hi: self.hi.max(-self.lo), flags: self.flags }
        }
    }

    fn tangent(self) -> Self {
        let size = self.lo.abs().max(self.hi.abs());
        let slack = 1e-15 * size + 1e-15;
        let (lo, hi) = (self.lo / core::f64::consts::PI, self.hi / core::f64::consts::PI);
        let trusted = size <= TRUSTED_ANGLE;
        let pole = !trusted || libm::floor(hi + 0.5 + slack) > libm::floor(lo + 0.5 - slack);
        if !pole {
            return self.increasing(libm::tan);
        }
        // Zeros are at integer multiples of π.
        let zero = !trusted || libm::floor(hi + slack) > libm::floor(lo - slack);
        let everything = Self::everything(self.flags);
        Self { flags: everything.flags | if zero { 0 } else { NONZERO }, ..everything }
    }

    pub(super) fn unary(self, operation: Unary) -> Self {
        if self.is_empty() {
            return NOTHING;
        }
        let flags = joined(self.flags, self.flags);
        match operation {
            Unary::Neg => self.neg(),
            Unary::Square => self.mul(self),
            Unary::Sqrt => {
                let cut = self.cut(0.0, f64::INFINITY);
                if cut.is_empty() {
                    return NOTHING;
                }
                Self::new(down(cut.lo.sqrt()), up(cut.hi.sqrt()), joined(cut.flags, cut.flags))
            }
            Unary::Cbrt => self.increasing(libm::cbrt),
            Unary::Abs => self.abs(),
            Unary::Sign => {
                let (lo, hi) = (sign(self.lo), sign(self.hi));
                Self { lo, hi, flags: if lo == hi { flags } else { flags & !CONTINUOUS } }
            }
            Unary::Floor => {
                let (lo, hi) = (libm::floor(self.lo), libm::floor(self.hi));
                Self { lo, hi, flags: if lo == hi { flags } else { flags & !CONTINUOUS } }
            }
            Unary::Exp => {
                let bounds = self.increasing(libm::exp);
                Self { lo: bounds.lo.max(0.0), ..bounds }
            }
            Unary::Ln | Unary::Log10 => {
                let cut = self.cut(0.0, f64::INFINITY);
                if cut.is_empty() {
                    return NOTHING;
                }
                let bounds = cut.increasing(if operation == Unary::Ln { libm::log } else { libm::log10 });
                Self { flags: if cut.lo > 0.0 { bounds.flags } else { bounds.flags & !DEFINED }, ..bounds }
            }
            Unary::Sin | Unary::Cos => unreachable!("computed in rows"),
            Unary::Tan => self.tangent(),
            Unary::Asin | Unary::Acos => {
                let cut = self.cut(-1.0, 1.0);
                if cut.is_empty() {
                    NOTHING
                } else if operation == Unary::Asin {
                    cut.increasing(libm::asin)
                } else {
                    let (lo, hi) = (libm::acos(cut.hi), libm::acos(cut.lo));
                    Self::new(well_below(lo), well_above(hi), joined(cut.flags, cut.flags))
                }
            }
            Unary::Atan => self.increasing(libm::atan),
            Unary::Sinh => self.increasing(libm::sinh),
            Unary::Cosh => {
                let bounds = self.abs().increasing(libm::cosh);
                Self { lo: bounds.lo.max(1.0), ..bounds }
            }
            Unary::Tanh => {
                let bounds = self.increasing(libm::tanh);
                Self { lo: bounds.lo.max(-1.0), hi: bounds.hi.min(1.0), ..bounds }
            }
        }
    }

    pub(super) fn binary(self, operation: Binary, other: Self) -> Self {
        if self.is_empty() || other.is_empty() {
            return NOTHING;
        }
        let flags = joined(self.flags, other.flags);
        match operation {
            Binary::Add => self.add(other),
            Binary::Sub => self.add(other.neg()),
            Binary::Mul => self.mul(other),
            Binary::Div => self.mul(other.reciprocal()),
            Binary::Min => Self { lo: self.lo.min(other.lo), hi: self.hi.min(other.hi), flags },
            Binary::Max => Self { lo: self.lo.max(other.lo), hi: self.hi.max(other.hi), flags },
            Binary::Pow => self.real_power(other),
            Binary::Atan2 => self.angle(other),
        }
    }

    /// Range of self^exponent for any exponent.
    fn real_power(self, exponent: Self) -> Self {
        let whole = exponent.lo == exponent.hi && exponent.lo == libm::trunc(exponent.lo);
        if self.lo < 0.0 && whole {
            // An integer exponent whose value comes from the parameters. The power is monotone in |x|, and the parity
            // of the exponent gives its sign.
            let size = self.abs().real_power(exponent);
            let symmetric = Self { lo: -size.hi, ..size };
            return if libm::fmod(exponent.lo, 2.0) == 0.0 { size } else { symmetric };
        }
        // Negative numbers have powers for integer exponents only, which may be positive or negative.
        let has_negative = self.lo < 0.0;
        let base = self.cut(0.0, f64::INFINITY);
        if has_negative && exponent.lo < exponent.hi {
            return Self::everything(0);
        }
        if base.is_empty() {
            return NOTHING;
        }
        // On x ≥ 0 x^p is monotone in x and in p, so the extremes are at the corners.
        let corners = [
            libm::pow(base.lo, exponent.lo),
            libm::pow(base.lo, exponent.hi),
            libm::pow(base.hi, exponent.lo),
            libm::pow(base.hi, exponent.hi),
        ];
        let flags = joined(base.flags, exponent.flags);
        // 0^p jumps at p = 0 and has a pole for p < 0.
        if base.lo == 0.0 && exponent.lo <= 0.0 {
            return Self { lo: 0.0, hi: f64::INFINITY, flags: flags & !REGULAR };
        }
        let lo = corners.into_iter().fold(f64::INFINITY, f64::min);
        let hi = corners.into_iter().fold(f64::NEG_INFINITY, f64::max);
        Self::new(well_below(lo).max(0.0), well_above(hi), flags)
    }

    /// Range of the angle atan2(self, across) of the point (across, self).
    fn angle(self, across: Self) -> Self {
        let flags = joined(self.flags, across.flags);
        let pi = well_above(core::f64::consts::PI);
        // The box meets the branch cut along the negative axis, or the origin.
        if across.lo <= 0.0 && self.holds(0.0) {
            return Self { lo: -pi, hi: pi, flags: flags & !CONTINUOUS };
        }
        // Away from the branch cut the extremes are at the corners.
        let corners = [
            libm::atan2(self.lo, across.lo),
            libm::atan2(self.lo, across.hi),
            libm::atan2(self.hi, across.lo),
            libm::atan2(self.hi, across.hi),
        ];
        let lo = corners.into_iter().fold(f64::INFINITY, f64::min);
        let hi = corners.into_iter().fold(f64::NEG_INFINITY, f64::max);
        Self::new(well_below(lo), well_above(hi), flags)
    }

    /// Range of the smooth minimum, which increases with a and b and decreases with k.
    pub(super) fn smooth_minimum(a: Self, b: Self, k: Self) -> Self {
        if a.is_empty() || b.is_empty() || k.is_empty() {
            return NOTHING;
        }
        let flags = joined(joined(a.flags, b.flags), k.flags);
        let widest = k.hi.max(MIN_BLEND_WIDTH);
        let narrowest = k.lo.max(MIN_BLEND_WIDTH);
        if !widest.is_finite() {
            return Self::everything(0);
        }
        let scale = LIBRARY_ERROR * (a.lo.abs().min(b.lo.abs()) + a.hi.abs().min(b.hi.abs()) + widest);
        let least = |x: f64, y: f64, k: f64| {
            if x.is_infinite() || y.is_infinite() { x.min(y) } else { smin(x, y, k) }
        };
        let lo = least(a.lo, b.lo, widest) - scale;
        let hi = least(a.hi, b.hi, narrowest) + scale;
        Self::new(well_below(lo), well_above(hi), flags)
    }

    /// Range of self^n for an integer n other than 0.
    pub(super) fn power(self, n: i32) -> Self {
        let natural = n.unsigned_abs();
        let even = natural.is_multiple_of(2);
        let base = if even { self.abs() } else { self };
        // There are at most 2 log₂ n products, each with an error of half a unit; squaring doubles a relative error.
        let error = 2.0 * f64::from(natural) * f64::EPSILON;
        let lo = widened(integer_power(base.lo, natural), -error, f64::NEG_INFINITY);
        let hi = widened(integer_power(base.hi, natural), error, f64::INFINITY);
        let flags = joined(self.flags, self.flags) | self.flags & NONZERO;
        let bounds = Self { lo: if even { lo.max(0.0) } else { lo }, hi, flags };
        if n < 0 { bounds.reciprocal() } else { bounds }
    }

    /// Range of a choice: `value` where a ≤ b and 0 elsewhere, or the reverse if not `where_at_most`.
    pub(super) fn choice(a: Self, b: Self, value: Self, where_at_most: bool) -> Self {
        if a.is_empty() || b.is_empty() || value.is_empty() {
            return NOTHING;
        }
        let flags = joined(joined(a.flags, b.flags), value.flags);
        let (always, never) = (a.hi <= b.lo, a.lo > b.hi);
        let (always_value, always_zero) = if where_at_most { (always, never) } else { (never, always) };
        if always_value {
            Self { flags, ..value }
        } else if always_zero {
            Self { lo: 0.0, hi: 0.0, flags }
        } else {
            Self { lo: value.lo.min(0.0), hi: value.hi.max(0.0), flags: flags & !CONTINUOUS }
        }
    }
}

/// x^n for n ≥ 1 by repeated products.
pub(super) fn integer_power(x: f64, n: u32) -> f64 {
    let (mut result, mut square, mut rest) = (1.0, x, n);
    while rest > 0 {
        if rest & 1 == 1 {
            result *= square;
        }
        rest >>= 1;
        if rest > 0 {
            square *= square;
        }
    }
    result
}
