//! Interval arithmetic over the graph: bounds that hold for every point of a box.
//!
//! Each operation rounds outward: by one unit in the last place where IEEE arithmetic rounds correctly, by a few
//! where the value comes from a mathematical library whose error is below one or two.

use super::graph::{Graph, Id, Node, SMIN_LEAST_WIDTH, smin};
use super::operations::{Binary, Unary};
use crate::field::Interval;
use glam::DVec3;

/// Bounds of a node's values over the box. `lo > hi` (the empty set) means that it is defined nowhere.
#[derive(Clone, Copy, Debug)]
pub(super) struct Range {
    lo: f64,
    hi: f64,
    /// Whether every operation so far was defined on all of its operands' values.
    defined: bool,
}

/// Scratch for [`interval`].
pub(super) type RangeScratch = Vec<Range>;

/// Relative widening of a bound that comes from `libm`, whose functions err by less than two units in the last
/// place.
const LIBRARY_ERROR: f64 = 8.0 * f64::EPSILON;

/// Largest argument whose place in the period of sine is trusted; beyond it the bounds are −1 … 1.
const TRUSTED_ANGLE: f64 = 1e9;

const EMPTY: Range = Range { lo: f64::INFINITY, hi: f64::NEG_INFINITY, defined: false };
const EVERYTHING: Range = Range { lo: f64::NEG_INFINITY, hi: f64::INFINITY, defined: false };

fn down(value: f64) -> f64 {
    value.next_down()
}

fn up(value: f64) -> f64 {
    value.next_up()
}

/// A lower bound for what a library function returned.
fn well_below(value: f64) -> f64 {
    (value - value.abs() * LIBRARY_ERROR).next_down()
}

fn well_above(value: f64) -> f64 {
    (value + value.abs() * LIBRARY_ERROR).next_up()
}

impl Range {
    /// The bounds `lo` and `hi`, or everything if one of them is NaN (∞ − ∞, 0 · ∞).
    fn new(lo: f64, hi: f64, defined: bool) -> Self {
        if lo.is_nan() || hi.is_nan() { EVERYTHING } else { Self { lo, hi, defined } }
    }

    fn exactly(value: f64) -> Self {
        if value.is_nan() { EMPTY } else { Self { lo: value, hi: value, defined: true } }
    }

    fn is_empty(self) -> bool {
        self.lo > self.hi
    }

    fn holds(self, value: f64) -> bool {
        self.lo <= value && value <= self.hi
    }

    /// The part inside `lo … hi`; not defined everywhere if something was cut off.
    fn cut(self, lo: f64, hi: f64) -> Self {
        let cut = Self { lo: self.lo.max(lo), hi: self.hi.min(hi), ..self };
        if cut.is_empty() {
            EMPTY
        } else {
            Self { defined: self.defined && self.lo >= lo && self.hi <= hi, ..cut }
        }
    }

    /// An increasing library function.
    fn increasing(self, f: fn(f64) -> f64) -> Self {
        Self::new(well_below(f(self.lo)), well_above(f(self.hi)), self.defined)
    }

    fn neg(self) -> Self {
        Self { lo: -self.hi, hi: -self.lo, ..self }
    }

    fn add(self, other: Self) -> Self {
        let defined = self.defined && other.defined;
        Self::new(down(self.lo + other.lo), up(self.hi + other.hi), defined)
    }

    fn mul(self, other: Self) -> Self {
        let product = |a: f64, b: f64| if a == 0.0 || b == 0.0 { 0.0 } else { a * b };
        let corners = [
            product(self.lo, other.lo),
            product(self.lo, other.hi),
            product(self.hi, other.lo),
            product(self.hi, other.hi),
        ];
        let lo = corners.into_iter().fold(f64::INFINITY, f64::min);
        let hi = corners.into_iter().fold(f64::NEG_INFINITY, f64::max);
        Self::new(down(lo), up(hi), self.defined && other.defined)
    }

    fn reciprocal(self) -> Self {
        if self.lo > 0.0 || self.hi < 0.0 {
            return Self::new(down(1.0 / self.hi), up(1.0 / self.lo), self.defined);
        }
        // A pole: on one side of it the values still have a sign.
        if self.lo == 0.0 && self.hi > 0.0 {
            Self { lo: down(1.0 / self.hi), hi: f64::INFINITY, defined: false }
        } else if self.hi == 0.0 && self.lo < 0.0 {
            Self { lo: f64::NEG_INFINITY, hi: up(1.0 / self.lo), defined: false }
        } else {
            EVERYTHING
        }
    }

    fn abs(self) -> Self {
        if self.lo >= 0.0 {
            self
        } else if self.hi <= 0.0 {
            self.neg()
        } else {
            Self { lo: 0.0, hi: self.hi.max(-self.lo), ..self }
        }
    }

    /// x^n for n ≥ 1.
    fn natural_power(self, n: u32) -> Self {
        let base = if n.is_multiple_of(2) { self.abs() } else { self };
        let bound = |x: f64, outward: fn(f64) -> f64| {
            // By repeated products, each rounded away from zero or towards it so that the result is a bound.
            let mut result: f64 = 1.0;
            let mut square = x.abs();
            let mut rest = n;
            let grow = (x < 0.0) != (outward(0.0) > 0.0);
            let round = |value: f64| if grow { value.next_up() } else { value.next_down().max(0.0) };
            while rest > 0 {
                if rest & 1 == 1 {
                    result = if result == 1.0 { square } else { round(result * square) };
                }
                rest >>= 1;
                if rest > 0 {
                    square = round(square * square);
                }
            }
            if x < 0.0 { -result } else { result }
        };
        Self::new(bound(base.lo, down), bound(base.hi, up), self.defined)
    }

    fn power(self, n: i32) -> Self {
        let positive = self.natural_power(n.unsigned_abs());
        if n < 0 { positive.reciprocal() } else { positive }
    }

    fn sine(self, phase: f64, f: fn(f64) -> f64) -> Self {
        let size = self.lo.abs().max(self.hi.abs());
        if !size.is_finite() {
            return Self { lo: -1.0, hi: 1.0, defined: false };
        }
        if size > TRUSTED_ANGLE {
            return Self { lo: -1.0, hi: 1.0, ..self };
        }
        // Maxima lie at phase + 2πk; a slack covers the rounding of the quotients.
        let reaches = |phase: f64| {
            let turns = |angle: f64| (angle - phase) / core::f64::consts::TAU;
            let slack = 1e-15 * size + 1e-15;
            libm::floor(turns(self.hi) + slack) > libm::floor(turns(self.lo) - slack)
        };
        let (a, b) = (f(self.lo), f(self.hi));
        let hi = if reaches(phase) { 1.0 } else { well_above(a.max(b)).min(1.0) };
        let opposite = phase + core::f64::consts::PI;
        let lo = if reaches(opposite) { -1.0 } else { well_below(a.min(b)).max(-1.0) };
        Self { lo, hi, ..self }
    }

    fn tangent(self) -> Self {
        let size = self.lo.abs().max(self.hi.abs());
        let slack = 1e-15 * size + 1e-15;
        let branch = |angle: f64| libm::floor(angle / core::f64::consts::PI + 0.5);
        let pole = size > TRUSTED_ANGLE
            || libm::floor(self.hi / core::f64::consts::PI + 0.5 + slack)
                > libm::floor(self.lo / core::f64::consts::PI + 0.5 - slack);
        if pole || branch(self.lo) != branch(self.hi) { EVERYTHING } else { self.increasing(libm::tan) }
    }

    fn unary(self, operation: Unary) -> Self {
        match operation {
            Unary::Neg => self.neg(),
            Unary::Square => self.natural_power(2),
            Unary::Sqrt => {
                let cut = self.cut(0.0, f64::INFINITY);
                if cut.is_empty() {
                    return EMPTY;
                }
                Self::new(down(cut.lo.sqrt()).max(0.0), up(cut.hi.sqrt()), cut.defined)
            }
            Unary::Cbrt => self.increasing(libm::cbrt),
            Unary::Abs => self.abs(),
            Unary::Sign => {
                let sign = super::operations::sign;
                Self { lo: sign(self.lo), hi: sign(self.hi), ..self }
            }
            Unary::Floor => Self { lo: libm::floor(self.lo), hi: libm::floor(self.hi), ..self },
            Unary::Exp => {
                let bounds = self.increasing(libm::exp);
                Self { lo: bounds.lo.max(0.0), ..bounds }
            }
            Unary::Ln | Unary::Log10 => {
                let cut = self.cut(0.0, f64::INFINITY);
                if cut.is_empty() {
                    return EMPTY;
                }
                let f = if operation == Unary::Ln { libm::log } else { libm::log10 };
                Self { defined: cut.defined && cut.lo > 0.0, ..cut.increasing(f) }
            }
            Unary::Sin => self.sine(core::f64::consts::FRAC_PI_2, libm::sin),
            Unary::Cos => self.sine(0.0, libm::cos),
            Unary::Tan => self.tangent(),
            Unary::Asin | Unary::Acos => {
                let cut = self.cut(-1.0, 1.0);
                if cut.is_empty() {
                    EMPTY
                } else if operation == Unary::Asin {
                    cut.increasing(libm::asin)
                } else {
                    Self::new(well_below(libm::acos(cut.hi)), well_above(libm::acos(cut.lo)), cut.defined)
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

    fn binary(self, operation: Binary, other: Self) -> Self {
        let defined = self.defined && other.defined;
        match operation {
            Binary::Add => self.add(other),
            Binary::Sub => self.add(other.neg()),
            Binary::Mul => self.mul(other),
            Binary::Div => self.mul(other.reciprocal()),
            Binary::Min => Self { lo: self.lo.min(other.lo), hi: self.hi.min(other.hi), defined },
            Binary::Max => Self { lo: self.lo.max(other.lo), hi: self.hi.max(other.hi), defined },
            Binary::Pow => self.real_power(other),
            Binary::Atan2 => self.angle(other),
        }
    }

    fn real_power(self, exponent: Self) -> Self {
        let whole = exponent.lo == exponent.hi && exponent.lo == libm::trunc(exponent.lo);
        if self.lo < 0.0 && whole {
            // A whole exponent, known only when the parameters are: monotone in |x|, the sign by parity.
            let size = self.abs().real_power(exponent);
            let symmetric = Self { lo: -size.hi, ..size };
            return if libm::fmod(exponent.lo, 2.0) == 0.0 { size } else { symmetric };
        }
        // Negative numbers have powers for whole exponents only, of either sign.
        let strays = self.lo < 0.0;
        let base = self.cut(0.0, f64::INFINITY);
        if strays && exponent.lo < exponent.hi {
            return EVERYTHING;
        }
        if base.is_empty() {
            return EMPTY;
        }
        // x^p is monotone in x and in p on x ≥ 0, so that the extremes are at the corners.
        let corners = [
            libm::pow(base.lo, exponent.lo),
            libm::pow(base.lo, exponent.hi),
            libm::pow(base.hi, exponent.lo),
            libm::pow(base.hi, exponent.hi),
        ];
        // 0^p jumps at p = 0 and has a pole for p < 0.
        let jump = base.lo == 0.0 && exponent.lo <= 0.0;
        let lo = corners.into_iter().fold(f64::INFINITY, f64::min);
        let hi = corners.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let defined = base.defined && exponent.defined && !jump;
        let (lo, hi) = if jump { (0.0, f64::INFINITY) } else { (well_below(lo).max(0.0), well_above(hi)) };
        Self::new(lo, hi, defined)
    }

    /// The angle of the point (`across`, self).
    fn angle(self, across: Self) -> Self {
        let defined = self.defined && across.defined;
        let pi = well_above(core::f64::consts::PI);
        // The cut along the negative axis, and the origin.
        if across.lo <= 0.0 && self.holds(0.0) {
            return Self { lo: -pi, hi: pi, defined };
        }
        // Elsewhere the extremes are at the corners of the box.
        let corners = [
            libm::atan2(self.lo, across.lo),
            libm::atan2(self.lo, across.hi),
            libm::atan2(self.hi, across.lo),
            libm::atan2(self.hi, across.hi),
        ];
        let lo = corners.into_iter().fold(f64::INFINITY, f64::min);
        let hi = corners.into_iter().fold(f64::NEG_INFINITY, f64::max);
        Self::new(well_below(lo), well_above(hi), defined)
    }

    /// Rising in a and b, falling in k.
    fn smooth_minimum(a: Self, b: Self, k: Self) -> Self {
        let widest = k.hi.max(SMIN_LEAST_WIDTH);
        let narrowest = k.lo.max(SMIN_LEAST_WIDTH);
        if !widest.is_finite() {
            return EVERYTHING;
        }
        let scale = LIBRARY_ERROR * (a.lo.abs().min(b.lo.abs()) + a.hi.abs().min(b.hi.abs()) + widest);
        let least = |x: f64, y: f64, k: f64| {
            if x.is_infinite() || y.is_infinite() { x.min(y) } else { smin(x, y, k) }
        };
        let lo = least(a.lo, b.lo, widest) - scale;
        let hi = least(a.hi, b.hi, narrowest) + scale;
        Self::new(well_below(lo), well_above(hi), a.defined && b.defined && k.defined)
    }
}

/// Bounds of node `root` over the box `lo … hi`.
pub(super) fn interval(
    graph: &Graph,
    root: Id,
    parameters: &[f64],
    [lo, hi]: [DVec3; 2],
    scratch: &mut RangeScratch,
) -> Interval {
    scratch.clear();
    for &node in &graph.nodes()[..=root as usize] {
        let range = node_range(node, parameters, [lo, hi], scratch);
        scratch.push(range);
    }
    let Range { lo, hi, defined } = scratch[root as usize];
    Interval { lo, hi, defined }
}

fn node_range(node: Node, parameters: &[f64], [lo, hi]: [DVec3; 2], known: &[Range]) -> Range {
    let range = |id: Id| known[id as usize];
    let mut empty = false;
    node.operands(|operand| empty |= range(operand).is_empty());
    if empty {
        return EMPTY;
    }
    match node {
        Node::Constant(bits) => Range::exactly(f64::from_bits(bits)),
        Node::Parameter(index) => Range::exactly(parameters[index as usize]),
        Node::Coordinate(axis) => {
            let (lo, hi) = (lo[usize::from(axis)], hi[usize::from(axis)]);
            Range::new(lo.min(hi), hi.max(lo), true)
        }
        Node::Unary(operation, a) => range(a).unary(operation),
        Node::Power(a, n) => range(a).power(n),
        Node::Binary(operation, a, b) => range(a).binary(operation, range(b)),
        Node::Smin(a, b, k) => Range::smooth_minimum(range(a), range(b), range(k)),
        Node::IfLe(a, b, v) | Node::IfGt(a, b, v) => {
            let (a, b, v) = (range(a), range(b), range(v));
            let (always, never) = (a.hi <= b.lo, a.lo > b.hi);
            let defined = a.defined && b.defined && v.defined;
            let taken = if matches!(node, Node::IfLe(_, _, _)) { always } else { never };
            let left = if matches!(node, Node::IfLe(_, _, _)) { never } else { always };
            if taken {
                Range { defined, ..v }
            } else if left {
                Range { lo: 0.0, hi: 0.0, defined }
            } else {
                Range { lo: v.lo.min(0.0), hi: v.hi.max(0.0), defined }
            }
        }
    }
}
