//! Reduction of an equation to one of the same surface without multiple factors.
//!
//! The gradient of a power u^n, or of a product with such a factor, vanishes on the surface u = 0. There is no normal,
//! and the residual |f|/|∇f| is no distance. The function u has the same zeros and a gradient there. Roots and absolute
//! values are replaced by their arguments too, since their slope at 0 is infinite or jumps.
//! The syntax tree is changed and not the graph, because the user is shown the equation that is sampled.

use super::ast::{Equation, Expr, ExprKind, Factor, Function, Sign};
use super::build::build;
use super::graph::Graph;
use super::operations::Unary;

/// Equation of the same surface without powers of factors and without repeated factors, or `None` if there are none.
///
/// An equation with two sides other than zero is not a product and is left alone.
pub(super) fn without_powers(equation: &Equation) -> Option<Equation> {
    let is_zero = |side: &Expr| constant(side) == Some(0.0);
    let simplified = match &equation.right {
        None => Equation { left: reduced(&equation.left, true), right: None },
        Some(right) if is_zero(right) => {
            Equation { left: reduced(&equation.left, true), right: equation.right.clone() }
        }
        Some(right) if is_zero(&equation.left) => {
            Equation { left: equation.left.clone(), right: Some(reduced(right, true)) }
        }
        Some(_) => return None,
    };
    (simplified != *equation).then_some(simplified)
}

/// Expression without powers of factors. A root that is not defined everywhere is removed only if the expression is the
/// `sole` varying factor: in a product, its domain decides which zeros of the other factors count.
fn reduced(expr: &Expr, sole: bool) -> Expr {
    if !varies(expr) {
        return expr.clone();
    }
    let with = |kind: ExprKind| Expr { kind, span: expr.span.clone() };
    match &expr.kind {
        ExprKind::Negated(inner) => with(ExprKind::Negated(Box::new(reduced(inner, sole)))),
        ExprKind::Power(base, exponent) => {
            let Some(n) = constant(exponent).filter(|&n| n > 0.0) else { return expr.clone() };
            let is_root = n.fract() != 0.0;
            if is_root && !sole {
                return expr.clone();
            }
            let base = reduced(base, sole);
            let ExprKind::Product(factors) = base.kind else { return base };
            if is_root && factors.iter().any(|(relation, factor)| is_pole(*relation, factor)) {
                return expr.clone();
            }
            // The order of a pole is kept, because it decides whether f changes its sign there.
            let factors = factors.into_iter().map(|(relation, factor)| match relation {
                Factor::Times => (relation, factor),
                Factor::Over => (relation, with(ExprKind::Power(Box::new(factor), exponent.clone()))),
            });
            with(ExprKind::Product(factors.collect()))
        }
        ExprKind::Call(Function::Unary(Unary::Sqrt), arguments) if sole => reduced(&arguments[0], true),
        ExprKind::Call(Function::Unary(Unary::Cbrt | Unary::Abs), arguments) => reduced(&arguments[0], sole),
        // Without poles only: where a pole meets a zero, the order of the zero matters.
        ExprKind::Product(factors)
            if !factors.iter().any(|(relation, factor)| is_pole(*relation, factor)) =>
        {
            let varying = factors.iter().filter(|(_, factor)| varies(factor)).count();
            product(factors, sole && varying == 1, with)
        }
        _ => expr.clone(),
    }
}

/// Whether the factor is a divisor that may vanish.
fn is_pole(relation: Factor, factor: &Expr) -> bool {
    relation == Factor::Over && varies(factor) && lower_bound(factor) != Some(LowerBound::Positive)
}

/// Lower bound of an expression.
#[derive(Clone, Copy, PartialEq)]
enum LowerBound {
    /// The expression is at least 0.
    Zero,
    /// The expression is more than 0.
    Positive,
}

/// Lower bound of the expression, as far as its form shows one.
fn lower_bound(expr: &Expr) -> Option<LowerBound> {
    if let Some(value) = constant(expr) {
        return match value {
            value if value > 0.0 => Some(LowerBound::Positive),
            0.0 => Some(LowerBound::Zero),
            _ => None,
        };
    }
    let or_zero = |bound: Option<LowerBound>| Some(bound.unwrap_or(LowerBound::Zero));
    match &expr.kind {
        ExprKind::Sum(terms) => {
            terms.iter().try_fold(LowerBound::Zero, |sum, (sign, term)| match (sign, lower_bound(term)?) {
                (Sign::Minus, _) => None,
                (Sign::Plus, LowerBound::Positive) => Some(LowerBound::Positive),
                (Sign::Plus, LowerBound::Zero) => Some(sum),
            })
        }
        ExprKind::Power(base, exponent) => match constant(exponent) {
            Some(n) if n > 0.0 && n % 2.0 == 0.0 => or_zero(lower_bound(base)),
            _ => lower_bound(base),
        },
        ExprKind::Call(Function::Unary(Unary::Exp), _) => Some(LowerBound::Positive),
        ExprKind::Call(Function::Unary(Unary::Abs | Unary::Sqrt), arguments) => {
            or_zero(lower_bound(&arguments[0]))
        }
        _ => None,
    }
}

/// Product of the reduced `factors`, in which a repeated varying factor stands once.
fn product(factors: &[(Factor, Expr)], sole: bool, with: impl Fn(ExprKind) -> Expr) -> Expr {
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
            Factor::Times => match reduced(factor, sole).kind {
                ExprKind::Product(inner) => {
                    inner.into_iter().for_each(|(relation, factor)| add(relation, factor));
                }
                kind => add(Factor::Times, Expr { kind, span: factor.span.clone() }),
            },
            Factor::Over => add(Factor::Over, factor.clone()),
        }
    }
    match kept.len() {
        1 => kept.remove(0).1,
        _ => with(ExprKind::Product(kept)),
    }
}

/// Whether the expression depends on a coordinate.
fn varies(expr: &Expr) -> bool {
    any(expr, &|kind| matches!(kind, ExprKind::Coordinate(_)))
}

/// Value of an expression without coordinates and parameters.
fn constant(expr: &Expr) -> Option<f64> {
    if any(expr, &|kind| matches!(kind, ExprKind::Coordinate(_) | ExprKind::Parameter(_))) {
        return None;
    }
    let mut graph = Graph::default();
    let root = build(&mut graph, &Equation { left: expr.clone(), right: None }, &[]).ok()?;
    graph.as_constant(root)
}

/// Whether `is` holds for any node of the expression.
fn any(expr: &Expr, is: &impl Fn(&ExprKind) -> bool) -> bool {
    is(&expr.kind)
        || match &expr.kind {
            ExprKind::Number(_)
            | ExprKind::Constant(_)
            | ExprKind::Coordinate(_)
            | ExprKind::Parameter(_) => false,
            ExprKind::Negated(inner) => any(inner, is),
            ExprKind::Sum(terms) => terms.iter().any(|(_, term)| any(term, is)),
            ExprKind::Product(factors) => factors.iter().any(|(_, factor)| any(factor, is)),
            ExprKind::Power(base, exponent) => any(base, is) || any(exponent, is),
            ExprKind::Call(_, arguments) => arguments.iter().any(|argument| any(argument, is)),
        }
}
