//! Periods of a formula along the axes, found in its graph.

use super::graph::{Graph, Id, Node};
use super::operations::{Binary, Unary};
use crate::math::SINGLE_ROUNDING;
use core::f64::consts::{PI, TAU};

/// Largest numerator and denominator of the ratio of two periods with a common multiple. Beyond it
/// a function counts as not periodic: of 20,000 particles each of 12³ small cells in a large one
/// has a dozen.
const MOST_PERIODS: u32 = 12;

/// The dependence of a value on one coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Along {
    /// The value does not depend on the coordinate. It is given where it depends on none.
    Constant(Option<f64>),
    /// The value is linear in the coordinate, with this factor.
    Linear(f64),
    /// The value is periodic, with this period.
    Periodic(f64),
    /// The value depends on the coordinate in another way, or in one that is not known.
    Other,
}

/// The period of node `root` along an axis, with these values of the parameters: 0 if it does not
/// change along it, none if it is not known to be periodic.
pub(super) fn period(graph: &Graph, root: Id, axis: u8, parameters: &[f64]) -> Option<f64> {
    let mut known: Vec<Along> = Vec::with_capacity(graph.len());
    for (id, &node) in (0..).zip(graph.nodes()) {
        let of = |id: Id| known[id as usize];
        let along = match node {
            _ if graph.is_uniform(id) => {
                let number =
                    |id: Id| if let Along::Constant(Some(value)) = of(id) { value } else { f64::NAN };
                Along::Constant(Some(node.evaluate(parameters, [f64::NAN; 3], number)))
            }
            _ if graph.axes(id) >> axis & 1 == 0 => Along::Constant(None),
            Node::Coordinate(_) => Along::Linear(1.0),
            Node::Unary(Unary::Neg, a) => negated(of(a)),
            Node::Binary(Binary::Add, a, b) => sum(of(a), of(b)),
            Node::Binary(Binary::Sub, a, b) => sum(of(a), negated(of(b))),
            Node::Binary(Binary::Mul, a, b) => product(of(a), of(b)),
            Node::Unary(operation @ (Unary::Sin | Unary::Cos | Unary::Tan), a) => match of(a) {
                Along::Linear(factor) => {
                    Along::Periodic(if operation == Unary::Tan { PI } else { TAU } / factor.abs())
                }
                other => joined(other, Along::Constant(None)),
            },
            node => {
                let mut all = Along::Constant(None);
                node.operands(|operand| all = joined(all, of(operand)));
                all
            }
        };
        known.push(along);
    }
    match known[root as usize] {
        Along::Constant(_) => Some(0.0),
        Along::Periodic(period) => Some(period),
        Along::Linear(_) | Along::Other => None,
    }
}

/// Whether a width is a whole number of periods. Period 0: the function does not change.
pub(super) fn is_whole(width: f64, period: f64) -> bool {
    let whole = (width / period).round();
    period == 0.0 || whole >= 1.0 && (whole * period - width).abs() <= SINGLE_ROUNDING * width
}

fn negated(value: Along) -> Along {
    match value {
        Along::Linear(factor) => Along::Linear(-factor),
        other => other,
    }
}

fn sum(a: Along, b: Along) -> Along {
    match (a, b) {
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
        let is_whole = nearest >= 1.0 && (times - nearest).abs() <= SINGLE_ROUNDING * nearest;
        (is_whole && nearest <= f64::from(MOST_PERIODS)).then_some(whole)
    })
}
