//! A single interval, with the operations that are too rare or too long for [rows](super::rows).

use super::flags::{CONTINUOUS, DEFINED, EMPTY, NONZERO, REGULAR, joined};
use crate::field::formula::graph::{Blend, MIN_BLEND_WIDTH, smin};
use crate::field::formula::operations::Unary;
use crate::math::{Bounds, Interval};

/// Bounds of the values of an operation over a box, with its [other properties](super::flags).
#[derive(Clone, Copy, Debug)]
pub(in crate::field::formula) struct Range {
    pub(in crate::field::formula) bounds: Interval,
    pub(super) flags: u8,
}

/// Relative widening of a bound that `libm` computed. Its functions err by less than two units in
/// the last place.
const LIBRARY_ERROR: f64 = 8.0 * f64::EPSILON;

/// Largest argument of the tangent whose position between the poles is trusted: its rounding may be
/// a millionth of their distance. Nothing is known of larger ones.
const LARGEST_TANGENT: f64 = 1e9;

/// The empty range.
const NOTHING: Range = Range { bounds: Interval::NOTHING, flags: EMPTY };

/// Lower bound of a result that IEEE arithmetic rounded to `value`, at least one unit in the last
/// place below it.
///
/// Subnormal results, which are below 2⁻¹⁰²² and have fewer digits, are taken for exact. NaN, from
/// ∞ − ∞, becomes −∞.
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

pub(super) fn least(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

pub(super) fn greatest(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The absolute values of numbers.
pub(super) fn absolute(Interval { lo, hi }: Interval) -> Interval {
    Interval::new(greatest(0.0, greatest(lo, -hi)), greatest(-lo, hi))
}

/// Lower bound of a result that a library function rounded to `value`.
fn well_below(value: f64) -> f64 {
    widened(value, -LIBRARY_ERROR, f64::NEG_INFINITY)
}

/// Upper bound of a result that a library function rounded to `value`.
fn well_above(value: f64) -> f64 {
    widened(value, LIBRARY_ERROR, f64::INFINITY)
}

impl Range {
    /// The range from `lo` to `hi`. A NaN is replaced by an infinite bound.
    fn new(lo: f64, hi: f64, flags: u8) -> Self {
        let lo = if lo.is_nan() { f64::NEG_INFINITY } else { lo };
        let hi = if hi.is_nan() { f64::INFINITY } else { hi };
        Self { bounds: Interval::new(lo, hi), flags }
    }

    /// The range whose ends IEEE arithmetic rounded to `bounds`.
    fn rounded(bounds: Interval, flags: u8) -> Self {
        Self { bounds: Interval::new(down(bounds.lo), up(bounds.hi)), flags }
    }

    /// The range whose ends a library function rounded to the least and the greatest of these
    /// values.
    fn among(corners: [f64; 4], flags: u8) -> Self {
        let lo = corners.into_iter().fold(f64::INFINITY, f64::min);
        let hi = corners.into_iter().fold(f64::NEG_INFINITY, f64::max);
        Self::new(well_below(lo), well_above(hi), flags)
    }

    /// The unbounded range, of an operation that may have a pole.
    fn everything(flags: u8) -> Self {
        Self { bounds: Interval::EVERYTHING, flags: flags & EMPTY }
    }

    pub(super) fn exactly(value: f64) -> Self {
        if value.is_nan() { NOTHING } else { Self { bounds: Interval::new(value, value), flags: REGULAR } }
    }

    /// The values of a coordinate in a box, whose corners may be in either order.
    pub(super) fn of_coordinate(bounds: &Bounds, axis: u8) -> Self {
        let [a, b] = [bounds.min, bounds.max].map(|corner| corner[usize::from(axis)]);
        Self { bounds: Interval::new(a.min(b), a.max(b)), flags: REGULAR }
    }

    pub(super) fn is_empty(self) -> bool {
        self.flags & EMPTY != 0
    }

    /// Whether 0 is certainly not among the values.
    pub(in crate::field::formula) fn is_nonzero(self) -> bool {
        self.flags & (NONZERO | EMPTY) != 0 || self.bounds.excludes_zero()
    }

    /// Intersection with `lo … hi`. If that is smaller, the operation is not defined everywhere in
    /// the box.
    fn cut(self, lo: f64, hi: f64) -> Self {
        let bounds = self.bounds.cut_to(Interval::new(lo, hi));
        if bounds.lo > bounds.hi {
            NOTHING
        } else if self.bounds.lo >= lo && self.bounds.hi <= hi {
            self
        } else {
            Self { bounds, flags: self.flags & !DEFINED }
        }
    }

    /// Range of an increasing library function.
    fn increasing(self, f: fn(f64) -> f64) -> Self {
        Self::new(
            well_below(f(self.bounds.lo)),
            well_above(f(self.bounds.hi)),
            joined(self.flags, self.flags),
        )
    }

    /// The range of values that are no smaller than `least`, whatever rounding says.
    fn at_least(self, least: f64) -> Self {
        Self { bounds: Interval::new(self.bounds.lo.max(least), self.bounds.hi), flags: self.flags }
    }

    #[inline]
    pub(super) fn reciprocal(self) -> Self {
        if self.is_empty() {
            return NOTHING;
        }
        let flags = joined(self.flags, self.flags);
        let Interval { lo, hi } = self.bounds;
        let inverse = Interval::new(1.0 / hi, 1.0 / lo);
        if self.bounds.excludes_zero() {
            return Self::rounded(inverse, flags);
        }
        // There is a pole. On one side of it the values keep their sign; on both sides they are
        // still not 0.
        let flags = flags & EMPTY | NONZERO;
        if lo == 0.0 && hi > 0.0 {
            Self { bounds: Interval::new(down(inverse.lo), f64::INFINITY), flags }
        } else if hi == 0.0 && lo < 0.0 {
            Self { bounds: Interval::new(f64::NEG_INFINITY, up(inverse.hi)), flags }
        } else {
            Self { bounds: Interval::EVERYTHING, flags }
        }
    }

    fn abs(self) -> Self {
        Self { bounds: absolute(self.bounds), ..self }
    }

    fn tangent(self) -> Self {
        let size = self.bounds.magnitude();
        let slack = 1e-15 * size + 1e-15;
        let (lo, hi) = (self.bounds.lo / core::f64::consts::PI, self.bounds.hi / core::f64::consts::PI);
        let trusted = size <= LARGEST_TANGENT;
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
        match operation {
            Unary::Limit => self,
            Unary::Neg | Unary::Sqrt | Unary::Abs | Unary::Sign | Unary::Sin | Unary::Cos => {
                unreachable!("computed in rows")
            }
            Unary::Cbrt => self.increasing(libm::cbrt),
            Unary::Floor => {
                let (lo, hi) = (libm::floor(self.bounds.lo), libm::floor(self.bounds.hi));
                let flags = joined(self.flags, self.flags);
                let flags = if lo == hi { flags } else { flags & !CONTINUOUS };
                Self { bounds: Interval::new(lo, hi), flags }
            }
            Unary::Exp => self.increasing(libm::exp).at_least(0.0),
            Unary::Ln | Unary::Log10 => {
                let cut = self.cut(0.0, f64::INFINITY);
                if cut.is_empty() {
                    return NOTHING;
                }
                let range = cut.increasing(if operation == Unary::Ln { libm::log } else { libm::log10 });
                Self {
                    flags: if cut.bounds.lo > 0.0 { range.flags } else { range.flags & !DEFINED },
                    ..range
                }
            }
            Unary::Tan => self.tangent(),
            Unary::Asin | Unary::Acos => {
                let cut = self.cut(-1.0, 1.0);
                if cut.is_empty() {
                    NOTHING
                } else if operation == Unary::Asin {
                    cut.increasing(libm::asin)
                } else {
                    let (lo, hi) = (libm::acos(cut.bounds.hi), libm::acos(cut.bounds.lo));
                    Self::new(well_below(lo), well_above(hi), joined(cut.flags, cut.flags))
                }
            }
            Unary::Atan => self.increasing(libm::atan),
            Unary::Sinh => self.increasing(libm::sinh),
            Unary::Cosh => self.abs().increasing(libm::cosh).at_least(1.0),
            Unary::Tanh => {
                let range = self.increasing(libm::tanh);
                Self { bounds: range.bounds.cut_to(Interval::symmetric(1.0)), ..range }
            }
            Unary::Asinh => self.increasing(libm::asinh),
            Unary::Acosh => {
                let cut = self.cut(1.0, f64::INFINITY);
                if cut.is_empty() { NOTHING } else { cut.increasing(libm::acosh).at_least(0.0) }
            }
            Unary::Atanh => {
                let cut = self.cut(-1.0, 1.0);
                if cut.is_empty() {
                    return NOTHING;
                }
                // There are poles at both ends.
                let range = cut.increasing(libm::atanh);
                let is_inside = cut.bounds.lo > -1.0 && cut.bounds.hi < 1.0;
                Self { flags: if is_inside { range.flags } else { range.flags & !DEFINED }, ..range }
            }
            Unary::Erf => {
                let range = self.increasing(libm::erf);
                Self { bounds: range.bounds.cut_to(Interval::symmetric(1.0)), ..range }
            }
        }
    }

    /// Range of self^exponent for any exponent.
    pub(super) fn real_power(self, exponent: Self) -> Self {
        if self.is_empty() || exponent.is_empty() {
            return NOTHING;
        }
        let Interval { lo: least, hi: greatest } = exponent.bounds;
        let has_negative = self.bounds.lo < 0.0;
        if has_negative && least == greatest && least == libm::trunc(least) {
            // An integer exponent whose value comes from the parameters. The power is monotone in
            // |x|, and the parity of the exponent gives its sign.
            let size = self.abs().real_power(exponent);
            let symmetric = Self { bounds: Interval::symmetric(size.bounds.hi), ..size };
            return if libm::fmod(least, 2.0) == 0.0 { size } else { symmetric };
        }
        // Negative numbers have powers for integer exponents only, which may be positive or
        // negative.
        let base = self.cut(0.0, f64::INFINITY);
        if has_negative && least < greatest {
            return Self::everything(0);
        }
        if base.is_empty() {
            return NOTHING;
        }
        let flags = joined(base.flags, exponent.flags);
        let Interval { lo, hi } = base.bounds;
        // 0^p jumps at p = 0 and has a pole for p < 0.
        if lo == 0.0 && least <= 0.0 {
            return Self { bounds: Interval::new(0.0, f64::INFINITY), flags: flags & !REGULAR };
        }
        // On x ≥ 0 x^p is monotone in x and in p, so the extremes are at the corners.
        let corners =
            [libm::pow(lo, least), libm::pow(lo, greatest), libm::pow(hi, least), libm::pow(hi, greatest)];
        Self::among(corners, flags).at_least(0.0)
    }

    /// Range of the angle atan2(self, across) of the point (across, self).
    pub(super) fn angle(self, across: Self) -> Self {
        if self.is_empty() || across.is_empty() {
            return NOTHING;
        }
        let flags = joined(self.flags, across.flags);
        let (y, x) = (self.bounds, across.bounds);
        // The box meets the branch cut along the negative axis, or the origin.
        if x.lo <= 0.0 && y.holds(0.0) {
            let pi = well_above(core::f64::consts::PI);
            return Self { bounds: Interval::symmetric(pi), flags: flags & !CONTINUOUS };
        }
        // Away from the branch cut the extremes are at the corners.
        let corners = [
            libm::atan2(y.lo, x.lo),
            libm::atan2(y.lo, x.hi),
            libm::atan2(y.hi, x.lo),
            libm::atan2(y.hi, x.hi),
        ];
        Self::among(corners, flags)
    }

    /// Range of the smooth minimum, which increases with a and b and decreases with k.
    pub(super) fn smooth_minimum(blend: Blend, a: Self, b: Self, k: Self) -> Self {
        if a.is_empty() || b.is_empty() || k.is_empty() {
            return NOTHING;
        }
        let flags = joined(joined(a.flags, b.flags), k.flags);
        let (a, b) = (a.bounds, b.bounds);
        let widest = k.bounds.hi.max(MIN_BLEND_WIDTH);
        let narrowest = k.bounds.lo.max(MIN_BLEND_WIDTH);
        if !widest.is_finite() {
            return Self::everything(0);
        }
        let scale = LIBRARY_ERROR * (a.lo.abs().min(b.lo.abs()) + a.hi.abs().min(b.hi.abs()) + widest);
        let least = |x: f64, y: f64, k: f64| {
            if x.is_infinite() || y.is_infinite() { x.min(y) } else { smin(blend, x, y, k) }
        };
        let lo = least(a.lo, b.lo, widest) - scale;
        let hi = least(a.hi, b.hi, narrowest) + scale;
        Self::new(well_below(lo), well_above(hi), flags)
    }

    /// Range of a choice: `value` where a ≤ b and 0 elsewhere, or the reverse if not
    /// `where_at_most`.
    pub(super) fn choice(a: Self, b: Self, value: Self, where_at_most: bool) -> Self {
        if a.is_empty() || b.is_empty() || value.is_empty() {
            return NOTHING;
        }
        let flags = joined(joined(a.flags, b.flags), value.flags);
        let (always, never) = (a.bounds.hi <= b.bounds.lo, a.bounds.lo > b.bounds.hi);
        let (always_value, always_zero) = if where_at_most { (always, never) } else { (never, always) };
        if always_value {
            Self { flags, ..value }
        } else if always_zero {
            Self { bounds: Interval::new(0.0, 0.0), flags }
        } else {
            let Interval { lo, hi } = value.bounds;
            Self { bounds: Interval::new(lo.min(0.0), hi.max(0.0)), flags: flags & !CONTINUOUS }
        }
    }

    /// Range of a choice: `u` where a ≤ b, `v` elsewhere. It `joins` them if they are equal where a
    /// = b.
    pub(super) fn select(joins: bool, a: Self, b: Self, u: Self, v: Self) -> Self {
        if a.is_empty() || b.is_empty() {
            return NOTHING;
        }
        let of_condition = joined(a.flags, b.flags);
        let only = |taken: Self| Self {
            flags: joined(of_condition, taken.flags) | taken.flags & (NONZERO | EMPTY),
            ..taken
        };
        if a.bounds.hi <= b.bounds.lo || v.is_empty() && u.is_empty() {
            return only(u);
        }
        if a.bounds.lo > b.bounds.hi {
            return only(v);
        }
        // Where the value taken is undefined, so is the choice.
        let either = match (u.is_empty(), v.is_empty()) {
            (true, _) => Self { flags: v.flags & !DEFINED, ..v },
            (_, true) => Self { flags: u.flags & !DEFINED, ..u },
            _ => Self {
                bounds: Interval::new(u.bounds.lo.min(v.bounds.lo), u.bounds.hi.max(v.bounds.hi)),
                flags: u.flags & v.flags,
            },
        };
        let lost = if joins { 0 } else { CONTINUOUS };
        Self { flags: joined(of_condition, either.flags) & !lost | either.flags & NONZERO, ..either }
    }
}
