//! A fixed-width vector of `f32` that LLVM turns into SIMD instructions.
//!
//! Every operation is the IEEE operation on each lane, written as a loop over an array: the result
//! has the same bits on SSE2, AVX and wasm `simd128`, and nothing is contracted into fused
//! multiply-adds.

use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// Lanes in a [`Lanes`]: two SSE2 or wasm registers, one AVX register.
pub const LANES: usize = 8;

/// Eight `f32` values operated on together.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(16))]
pub struct Lanes(pub [f32; LANES]);

impl Default for Lanes {
    fn default() -> Self {
        Self::splat(0.0)
    }
}

impl Lanes {
    /// Returns lanes that all have the same value.
    #[inline]
    #[must_use]
    pub const fn splat(value: f32) -> Self {
        Self([value; LANES])
    }

    /// `f` applied to every lane.
    #[inline]
    #[must_use]
    pub fn map(self, f: impl Fn(f32) -> f32) -> Self {
        Self(core::array::from_fn(|i| f(self.0[i])))
    }

    /// `f` applied to every pair of lanes.
    #[inline]
    #[must_use]
    pub fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Self(core::array::from_fn(|i| f(self.0[i], other.0[i])))
    }

    /// Square root of every lane.
    #[inline]
    #[must_use]
    pub fn sqrt(self) -> Self {
        self.map(f32::sqrt)
    }

    /// The smaller of every pair of lanes, of numbers that are not NaN.
    #[inline]
    #[must_use]
    pub fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if b < a { b } else { a })
    }

    /// Absolute value of every lane.
    #[inline]
    #[must_use]
    pub fn abs(self) -> Self {
        self.map(f32::abs)
    }

    /// Sum of the lanes, by halves: ((0+4)+(2+6)) + ((1+5)+(3+7)). The order is part of the result.
    #[inline]
    #[must_use]
    pub fn sum(self) -> f32 {
        let v = self.0;
        ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]))
    }
}

macro_rules! lanewise {
    ($($operator:ident $method:ident $symbol:tt),*) => {$(
        impl $operator for Lanes {
            type Output = Self;
            #[inline]
            fn $method(self, other: Self) -> Self {
                self.zip(other, |a, b| a $symbol b)
            }
        }
    )*};
}
lanewise!(Add add +, Sub sub -, Mul mul *, Div div /);

impl Neg for Lanes {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}

impl AddAssign for Lanes {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
