//! Coefficients of the sum: of single centres, and of the polynomials that replace many.

use crate::math::{LANES, Lanes};
use glam::DVec3;

/// Degree of the Taylor polynomials: the powers of y, from 0 up, fill the eight lanes.
pub(super) const DEGREE: usize = 7;

/// Rows of a polynomial: one for each pair of powers of z and x whose sum is at most [`DEGREE`].
pub(super) const ROWS: usize = (DEGREE + 1) * (DEGREE + 2) / 2;

/// Coefficients of a polynomial in single precision. The lanes are the powers of y. Rows go from
/// the largest power of z down, and within it from the largest power of x down. Coefficients beyond
/// the degree are zero.
pub(super) type Rows = [Lanes; ROWS];

const _: () = assert!(LANES == DEGREE + 1, "the powers of y fill the lanes");

/// A centre with its coefficients, in local coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Centre {
    pub(super) position: DVec3,
    pub(super) alpha: f64,
    pub(super) beta: DVec3,
}
