//! The same surface with every factor once.
//!
//! Where f is a power u^n, or a product that holds one, its gradient vanishes on the surface u = 0: there is no normal, and
//! |f|/|∇f| is no distance. The zeros of u are the same, and it has a gradient there. So is a root or an absolute value, whose
//! slope jumps or is infinite at 0, no worse than what it is taken of.

use super::ast::{Equation, Expr, Factor, Function, Kind, Sign};
use super::build::build;
use super::graph::Graph;

/// The equation of the same surface without powers of factors and without repeated factors; none if it has none of them.
pub(super) fn without_powers(equation: &Equation) -> Option<Equation> {
    let is_zero = |side: &Expr| constant(side) == Some(0.0);
    let simple = match &equation.right {
        None => Equation { left: reduced(&equation.left, true), right: None },
        Some(right) if is_zero(right) => {
            Equation { left: reduced(&equation.left, true), right: equation.right.clone() }
        }
        Some(right) if is_zero(&equation.left) => {
            Equation { left: equation.left.clone(), right: Some(reduced(right, true)) }
        }
        Some(_) => return None,
    };
    (simple != *equation).then_some(simple)
}

/// The expression without powers of factors. Roots that are not defined everywhere go only where the expression is `alone`: in
/// a product they say where the zeros of the other factors count.
fn reduced(expr: &Expr, alone: bool) -> Expr {
    if !varies(expr) {
        return expr.clone();
    }
    let with = |kind: Kind| Expr { kind, span: expr.span.clone() };
    match &expr.kind {
        Kind::Negated(inner) => with(Kind::Negated(Box::new(reduced(inner, alone)))),
        Kind::Power(base, exponent) => {
            let Some(n) = constant(exponent).filter(|&n| n > 0.0) else { return expr.clone() };
            let is_root = n.fract() != 0.0;
            if is_root && !alone {
                return expr.clone();
            }
            let base = reduced(base, alone);
            let Kind::Product(factors) = base.kind else { return base };
            if is_root && factors.iter().any(|(relation, factor)| is_pole(*relation, factor)) {
                return expr.clone();
            }
            // The order of a pole stays, and with it whether f has the same sign on both sides.
            let factors = factors.into_iter().map(|(relation, factor)| match relation {
                Factor::Times => (relation, factor),
                Factor::Over => (relation, with(Kind::Power(Box::new(factor), exponent.clone()))),
            });
            with(Kind::Product(factors.collect()))
        }
        Kind::Call(Function::Sqrt, arguments) if alone => reduced(&arguments[0], true),
        Kind::Call(Function::Cbrt | Function::Abs, arguments) => reduced(&arguments[0], alone),
        // A pole could be where a factor is zero: then the order of the zero counts.
        Kind::Product(factors) if !factors.iter().any(|(relation, factor)| is_pole(*relation, factor)) => {
            let varying = factors.iter().filter(|(_, factor)| varies(factor)).count();
            product(factors, alone && varying == 1, with)
        }
        _ => expr.clone(),
    }
}

/// Whether a factor may be a divisor that comes to zero.
fn is_pole(relation: Factor, factor: &Expr) -> bool {
    relation == Factor::Over && varies(factor) && least(factor) != Some(Least::Positive)
}

/// What an expression is never below.
#[derive(Clone, Copy, PartialEq)]
enum Least {
    /// At least 0.
    Zero,
    /// More than 0.
    Positive,
}

/// What the expression is never below, as far as its form tells.
fn least(expr: &Expr) -> Option<Least> {
    if let Some(value) = constant(expr) {
        return match value {
            value if value > 0.0 => Some(Least::Positive),
            0.0 => Some(Least::Zero),
            _ => None,
        };
    }
    let or_zero = |least: Option<Least>| Some(least.unwrap_or(Least::Zero));
    match &expr.kind {
        Kind::Sum(terms) => {
            terms.iter().try_fold(Least::Zero, |sum, (sign, term)| match (sign, least(term)?) {
                (Sign::Minus, _) => None,
                (Sign::Plus, Least::Positive) => Some(Least::Positive),
                (Sign::Plus, Least::Zero) => Some(sum),
            })
        }
        Kind::Power(base, exponent) => match constant(exponent) {
            Some(n) if n > 0.0 && n % 2.0 == 0.0 => or_zero(least(base)),
            _ => least(base),
        },
        Kind::Call(Function::Exp, _) => Some(Least::Positive),
        Kind::Call(Function::Abs | Function::Sqrt, arguments) => or_zero(least(&arguments[0])),
        _ => None,
    }
}

fn product(factors: &[(Factor, Expr)], alone: bool, with: impl Fn(Kind) -> Expr) -> Expr {
    let mut kept: Vec<(Factor, Expr)> = Vec::new();
    let mut add = |relation: Factor, factor: Expr| {
        let is_repeated =
            relation == Factor::Times && varies(&factor) && kept.contains(&(relation, factor.clone()));
        if !is_repeated {
            kept.push((relation, factor));
        }
    };
    for (relation, factor) in factors {
        match relation {
            Factor::Times => match reduced(factor, alone).kind {
                Kind::Product(inner) => {
                    inner.into_iter().for_each(|(relation, factor)| add(relation, factor));
                }
                kind => add(Factor::Times, Expr { kind, span: factor.span.clone() }),
            },
            Factor::Over => add(Factor::Over, factor.clone()),
        }
    }
    match kept.len() {
        1 => kept.remove(0).1,
        _ => with(Kind::Product(kept)),
    }
}

/// Whether the expression depends on a coordinate.
fn varies(expr: &Expr) -> bool {
    any(expr, &|kind| matches!(kind, Kind::Coordinate(_)))
}

/// The value of an expression without coordinates and parameters.
fn constant(expr: &Expr) -> Option<f64> {
    if any(expr, &|kind| matches!(kind, Kind::Coordinate(_) | Kind::Parameter(_))) {
        return None;
    }
    let mut graph = Graph::default();
    let root = build(&mut graph, &Equation { left: expr.clone(), right: None }, &[]).ok()?;
    graph.as_constant(root)
}

/// Whether any part of the expression `is` so.
fn any(expr: &Expr, is: &impl Fn(&Kind) -> bool) -> bool {
    is(&expr.kind)
        || match &expr.kind {
            Kind::Number(_) | Kind::Constant(_) | Kind::Coordinate(_) | Kind::Parameter(_) => false,
            Kind::Negated(inner) => any(inner, is),
            Kind::Sum(terms) => terms.iter().any(|(_, term)| any(term, is)),
            Kind::Product(factors) => factors.iter().any(|(_, factor)| any(factor, is)),
            Kind::Power(base, exponent) => any(base, is) || any(exponent, is),
            Kind::Call(_, arguments) => arguments.iter().any(|argument| any(argument, is)),
        }
}
