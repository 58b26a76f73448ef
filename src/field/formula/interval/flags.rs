//! What is known of an operation's values over a box beside their bounds, a bit each.

/// Every value is a number: no NaN, and no pole at which it would be an infinity outside the bounds.
pub(super) const DEFINED: u8 = 1;
/// The values depend continuously on the point: no jump.
pub(super) const CONTINUOUS: u8 = 2;
/// No value is 0, even where the bounds have both signs: a reciprocal on both sides of its pole.
pub(super) const NONZERO: u8 = 4;
/// There is no value at all: the operation is undefined on the whole box.
pub(super) const EMPTY: u8 = 8;

/// Defined and continuous.
pub(super) const REGULAR: u8 = DEFINED | CONTINUOUS;

/// Flags of an operation that is itself defined and continuous: it is where both operands are, and empty where one is.
pub(super) fn joined(a: u8, b: u8) -> u8 {
    a & b & REGULAR | (a | b) & EMPTY
}
