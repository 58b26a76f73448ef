//! Intervals of numbers.

use super::ROUNDING;
use core::ops::{Add, Mul, Neg};

/// A closed interval of numbers. It is empty if the lower end exceeds the upper.
///
/// The operators take ends that are not NaN. They do not round outward: a proof that uses them
/// [adds a slack](Interval::widened) for rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower end, which may be −∞.
    pub lo: f64,
    /// Upper end, which may be +∞.
    pub hi: f64,
}

impl Interval {
    /// All numbers.
    pub const EVERYTHING: Self = Self::new(f64::NEG_INFINITY, f64::INFINITY);
    /// No number.
    pub const NOTHING: Self = Self::new(f64::INFINITY, f64::NEG_INFINITY);

    /// The interval from `lo` to `hi`.
    #[must_use]
    pub const fn new(lo: f64, hi: f64) -> Self {
        Self { lo, hi }
    }

    /// The interval from `-size` to `size`.
    #[must_use]
    pub const fn symmetric(size: f64) -> Self {
        Self::new(-size, size)
    }

    /// The number halfway between the ends.
    #[must_use]
    pub fn middle(self) -> f64 {
        0.5 * (self.lo + self.hi)
    }

    /// Largest absolute value.
    #[must_use]
    pub fn magnitude(self) -> f64 {
        self.hi.abs().max(self.lo.abs())
    }

    /// Least absolute value, if 0 is excluded.
    #[must_use]
    pub fn away_from_zero(self) -> Option<f64> {
        if self.lo > 0.0 {
            Some(self.lo)
        } else if self.hi < 0.0 {
            Some(-self.hi)
        } else {
            None
        }
    }

    /// Whether 0 is outside; false if an end is NaN.
    #[must_use]
    pub fn excludes_zero(self) -> bool {
        self.lo > 0.0 || self.hi < 0.0
    }

    /// Whether `value` lies within.
    #[must_use]
    pub fn holds(self, value: f64) -> bool {
        self.lo <= value && value <= self.hi
    }

    /// The interval with both ends moved outward by `slack`.
    #[must_use]
    pub fn widened(self, slack: f64) -> Self {
        Self::new(self.lo - slack, self.hi + slack)
    }

    /// The interval widened by `swing`, and by the rounding of the few operations that led to it.
    /// This is the mean value form (Moore 1966): the interval bounds a function at the centre of a
    /// box, and the function changes by at most `swing` from there.
    #[must_use]
    pub fn mean_value(self, swing: f64) -> Self {
        let slack = ROUNDING * (swing + self.lo.abs() + self.hi.abs());
        Self::new(self.lo - swing - slack, self.hi + swing + slack)
    }

    /// The intersection with another interval; an end that is NaN does not cut.
    #[must_use]
    pub fn cut_to(self, other: Self) -> Self {
        let lo = if other.lo > self.lo { other.lo } else { self.lo };
        let hi = if other.hi < self.hi { other.hi } else { self.hi };
        Self::new(lo, hi)
    }
}

impl Neg for Interval {
    type Output = Self;

    fn neg(self) -> Self {
        Self::new(-self.hi, -self.lo)
    }
}

impl Add for Interval {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::new(self.lo + other.lo, self.hi + other.hi)
    }
}

impl Mul<f64> for Interval {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        let (a, b) = (product(self.lo, factor), product(self.hi, factor));
        if factor < 0.0 { Self::new(b, a) } else { Self::new(a, b) }
    }
}

impl Mul for Interval {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let (p, q) = (self * other.lo, self * other.hi);
        Self::new(p.lo.min(q.lo), p.hi.max(q.hi))
    }
}

/// Product of ends. 0 · ∞ is 0, because an infinite end stands for arbitrarily large finite values.
pub(crate) fn product(a: f64, b: f64) -> f64 {
    let product = a * b;
    if product.is_nan() { 0.0 } else { product }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn operators_hold_every_result_of_numbers_within() {
        let ends = [f64::NEG_INFINITY, -2.0, -0.5, 0.0, 0.25, 3.0, f64::INFINITY];
        let pairs = || ends.into_iter().flat_map(|lo| ends.map(|hi| Interval::new(lo, hi)));
        let intervals =
            || pairs().filter(|interval| interval.lo <= interval.hi && interval.lo < f64::INFINITY);
        let numbers = |of: Interval| ends.into_iter().filter(move |&x| x.is_finite() && of.holds(x));
        let mut seen = 0;
        for (a, b) in intervals().flat_map(|a| intervals().map(move |b| (a, b))) {
            for (x, y) in numbers(a).flat_map(|x| numbers(b).map(move |y| (x, y))) {
                assert!((a + b).holds(x + y) && (a * b).holds(x * y), "{a:?} {b:?}");
                assert!((a * y).holds(x * y) && (-a).holds(-x) && a.magnitude() >= x.abs(), "{a:?} {y}");
                assert!(a.away_from_zero().is_none_or(|least| least <= x.abs()), "{a:?}");
                assert_eq!(a.cut_to(b).holds(x), b.holds(x), "{a:?} {b:?}");
                seen += 1;
            }
            assert_eq!(a.excludes_zero(), a.away_from_zero().is_some());
            assert_eq!(a.excludes_zero(), !a.holds(0.0));
        }
        assert!(seen > 1000);
        assert_eq!(Interval::new(-1.0, 2.0) * Interval::new(-3.0, 1.0), Interval::new(-6.0, 3.0));
        let nan = Interval::new(f64::NAN, f64::NAN);
        assert!(!nan.excludes_zero() && Interval::symmetric(1.0).cut_to(nan) == Interval::symmetric(1.0));
    }

    #[test]
    fn a_mean_value_form_holds_the_function() {
        // x² over [1, 1.5]: its slope is at most 3.
        let form = Interval::new(1.25 * 1.25, 1.25 * 1.25).mean_value(0.25 * 3.0);
        assert!(form.holds(1.0) && form.holds(2.25) && form.lo > 0.8 && form.hi < 2.32, "{form:?}");
    }
}
