//! Properties of an operation over a box other than its bounds, one bit each.

/// Every value is a number: there is no NaN, and no pole, where the value would be an infinity
/// outside the bounds.
pub(super) const DEFINED: u8 = 1;
/// The values depend continuously on the point.
pub(super) const CONTINUOUS: u8 = 2;
/// No value is 0, even if the bounds have both signs, as for a reciprocal on both sides of its
/// pole.
pub(super) const NONZERO: u8 = 4;
/// The operation is undefined on the whole box.
pub(super) const EMPTY: u8 = 8;

/// Defined and continuous.
pub(super) const REGULAR: u8 = DEFINED | CONTINUOUS;

/// Flags of an operation that is defined and continuous wherever both operands are.
pub(super) fn joined(a: u8, b: u8) -> u8 {
    a & b & REGULAR | (a | b) & EMPTY
}
