//! The number types for which a closed formula is written once: `f32`, `f64` and lanes.

use super::Lanes;
use core::ops::{Add, Div, Mul, Neg, Sub};

/// A number type that closed formulas are evaluated with. Every operation is the IEEE one, on each
/// lane.
pub trait Real:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// A constant.
    #[must_use]
    fn of(value: f32) -> Self;

    /// Square root.
    #[must_use]
    fn sqrt(self) -> Self;

    /// Absolute value.
    #[must_use]
    fn abs(self) -> Self;

    /// 1 with the sign of `self`.
    #[must_use]
    fn sign(self) -> Self;

    /// `this` where `self` > 0, else (for NaN too) `other`.
    #[must_use]
    fn positive(self, this: Self, other: Self) -> Self;
}

macro_rules! real {
    ($($number:ty),*) => {$(
        impl Real for $number {
            #[inline]
            fn of(value: f32) -> Self {
                value.into()
            }
            #[inline]
            fn sqrt(self) -> Self {
                self.sqrt()
            }
            #[inline]
            fn abs(self) -> Self {
                self.abs()
            }
            #[inline]
            fn sign(self) -> Self {
                Self::copysign(1.0, self)
            }
            #[inline]
            fn positive(self, this: Self, other: Self) -> Self {
                if self > 0.0 { this } else { other }
            }
        }
    )*};
}
real!(f32, f64);

impl Real for Lanes {
    #[inline]
    fn of(value: f32) -> Self {
        Self::splat(value)
    }
    #[inline]
    fn sqrt(self) -> Self {
        Self::sqrt(self)
    }
    #[inline]
    fn abs(self) -> Self {
        Self::abs(self)
    }
    #[inline]
    fn sign(self) -> Self {
        self.map(f32::sign)
    }
    #[inline]
    fn positive(self, this: Self, other: Self) -> Self {
        Self(core::array::from_fn(|k| self.0[k].positive(this.0[k], other.0[k])))
    }
}
