//! Periods of a formula along the axes, found in its syntax tree.

use super::ast::{Constant, Equation, Expr, ExprKind, Factor, Function, Sign};
use core::f64::consts::{PI, TAU};

/// Largest numerator and denominator of the ratio of two periods that have a common multiple. What comes together only after
/// more of them is taken for not periodic.
const MOST_PERIODS: u32 = 12;
/// Largest relative error of such a ratio, by rounding: far below 1/144, by which two of them differ at least.
const ROUNDING: f64 = 1e-9;

/// The dependence of a value on one coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Along {
    /// The value does not depend on the coordinate. It is given where it is a number.
    Constant(Option<f64>),
    /// The value is linear in the coordinate, with this factor.
    Linear(f64),
    /// The value is periodic, with this period.
    Periodic(f64),
    /// The value depends on the coordinate in another way, or in one that is not known.
    Other,
}

/// The period of f along an axis: 0 if f does not change along it, none if f is not known to be periodic.
pub(super) fn period(equation: &Equation, axis: u8, parameter: &dyn Fn(&str) -> Option<f64>) -> Option<f64> {
    let finder = PeriodFinder { axis, parameter };
    let left = finder.along(&equation.left);
    let whole = match &equation.right {
        Some(right) => sum(left, negated(finder.along(right))),
        None => left,
    };
    match whole {
        Along::Constant(_) => Some(0.0),
        Along::Periodic(period) => Some(period),
        Along::Linear(_) | Along::Other => None,
    }
}

/// Largest part of a width by which it may miss a whole number of periods: single precision, in which particles are kept, holds no
/// more, and seven digits of a period are enough.
const SLACK: f64 = 1e-6;

/// Whether a width is a whole number of periods, of which 0 is that of what does not change.
pub(super) fn is_whole(width: f64, period: f64) -> bool {
    let whole = (width / period).round();
    period == 0.0 || whole >= 1.0 && (whole * period - width).abs() <= SLACK * width
}

/// Finder of the dependence of expressions on one coordinate.
struct PeriodFinder<'a> {
    axis: u8,
    parameter: &'a dyn Fn(&str) -> Option<f64>,
}

impl PeriodFinder<'_> {
    fn along(&self, expr: &Expr) -> Along {
        match &expr.kind {
            ExprKind::Number(value) => Along::Constant(Some(*value)),
            ExprKind::Constant(constant) => Along::Constant(Some(Constant::value(*constant))),
            ExprKind::Parameter(name) => Along::Constant((self.parameter)(name)),
            ExprKind::Coordinate(axis) if *axis == self.axis => Along::Linear(1.0),
            ExprKind::Coordinate(_) => Along::Constant(None),
            ExprKind::Negated(inner) => negated(self.along(inner)),
            ExprKind::Sum(terms) => terms.iter().fold(Along::Constant(Some(0.0)), |before, (sign, term)| {
                let term = self.along(term);
                sum(before, if *sign == Sign::Minus { negated(term) } else { term })
            }),
            ExprKind::Product(factors) => {
                factors.iter().fold(Along::Constant(Some(1.0)), |before, (factor, term)| {
                    let term = self.along(term);
                    product(before, if *factor == Factor::Over { inverse(term) } else { term })
                })
            }
            ExprKind::Power(base, exponent) => joined(self.along(base), self.along(exponent)),
            ExprKind::Call(function, arguments) => self.call(*function, arguments),
        }
    }

    fn call(&self, function: Function, arguments: &[Expr]) -> Along {
        let turn = match function {
            Function::Sin | Function::Cos => Some(TAU),
            Function::Tan => Some(PI),
            _ => None,
        };
        let values: Vec<Along> = arguments.iter().map(|argument| self.along(argument)).collect();
        match (turn, values.as_slice()) {
            (Some(turn), [Along::Linear(factor)]) => Along::Periodic(turn / factor.abs()),
            _ => values.into_iter().fold(Along::Constant(None), joined),
        }
    }
}

fn negated(value: Along) -> Along {
    match value {
        Along::Constant(Some(value)) => Along::Constant(Some(-value)),
        Along::Linear(factor) => Along::Linear(-factor),
        other => other,
    }
}

fn inverse(value: Along) -> Along {
    match value {
        Along::Constant(Some(value)) if value != 0.0 => Along::Constant(Some(1.0 / value)),
        Along::Constant(_) => Along::Constant(None),
        Along::Periodic(period) => Along::Periodic(period),
        Along::Linear(_) | Along::Other => Along::Other,
    }
}

fn sum(a: Along, b: Along) -> Along {
    match (a, b) {
        (Along::Constant(Some(a)), Along::Constant(Some(b))) => Along::Constant(Some(a + b)),
        (Along::Linear(a), Along::Linear(b)) if a + b == 0.0 => Along::Constant(None),
        (Along::Linear(a), Along::Linear(b)) => Along::Linear(a + b),
        (Along::Linear(factor), Along::Constant(_)) | (Along::Constant(_), Along::Linear(factor)) => {
            Along::Linear(factor)
        }
        (a, b) => joined(a, b),
    }
}

fn product(a: Along, b: Along) -> Along {
    match (a, b) {
        (Along::Constant(Some(a)), Along::Constant(Some(b))) => Along::Constant(Some(a * b)),
        (Along::Linear(factor), Along::Constant(Some(by)))
        | (Along::Constant(Some(by)), Along::Linear(factor))
            if by != 0.0 =>
        {
            Along::Linear(factor * by)
        }
        (a, b) => joined(a, b),
    }
}

/// The dependence of a function of two values, from the dependence of each value.
fn joined(a: Along, b: Along) -> Along {
    match (a, b) {
        (Along::Constant(_), Along::Constant(_)) => Along::Constant(None),
        (Along::Periodic(period), Along::Constant(_)) | (Along::Constant(_), Along::Periodic(period)) => {
            Along::Periodic(period)
        }
        (Along::Periodic(a), Along::Periodic(b)) => common(a, b).map_or(Along::Other, Along::Periodic),
        _ => Along::Other,
    }
}

/// The least common multiple of two periods, if it is at most [`MOST_PERIODS`] times each.
fn common(a: f64, b: f64) -> Option<f64> {
    (1..=MOST_PERIODS).find_map(|n| {
        let whole = f64::from(n) * a;
        let times = whole / b;
        let nearest = times.round();
        let is_whole = nearest >= 1.0 && (times - nearest).abs() <= ROUNDING * nearest;
        (is_whole && nearest <= f64::from(MOST_PERIODS)).then_some(whole)
    })
}
