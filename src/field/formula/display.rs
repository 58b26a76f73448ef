//! Plain text of a formula, which parses back to the same tree.

use super::ast::{COORDINATES, Equation, Expr, ExprKind, Factor, Sign};
use crate::math::shortest_text;

/// Precedence, weakest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Precedence {
    Sum,
    /// A leading sign, with the precedence of a product whose first factor it may belong to.
    Sign,
    Product,
    Power,
    Atom,
}

pub(super) fn level(kind: &ExprKind) -> Precedence {
    match kind {
        ExprKind::Sum(_) => Precedence::Sum,
        ExprKind::Negated(_) => Precedence::Sign,
        ExprKind::Product(_) => Precedence::Product,
        ExprKind::Power(_, _) => Precedence::Power,
        ExprKind::Number(_)
        | ExprKind::Constant(_)
        | ExprKind::Coordinate(_)
        | ExprKind::Parameter(_)
        | ExprKind::Call(_, _) => Precedence::Atom,
    }
}

/// Text of an expression.
pub(super) fn plain(expr: &Expr) -> String {
    let mut out = String::new();
    write(&mut out, expr);
    out
}

/// Text of an equation.
pub(super) fn plain_equation(equation: &Equation) -> String {
    let mut out = plain(&equation.left);
    if let Some(right) = &equation.right {
        out.push_str(" = ");
        write(&mut out, right);
    }
    out
}

/// Writes `expr`, in brackets if its precedence is below `least`.
fn write_at(out: &mut String, expr: &Expr, least: Precedence) {
    if level(&expr.kind) < least {
        out.push('(');
        write(out, expr);
        out.push(')');
    } else {
        write(out, expr);
    }
}

fn write(out: &mut String, expr: &Expr) {
    match &expr.kind {
        ExprKind::Number(value) => out.push_str(&shortest_text(*value)),
        ExprKind::Constant(constant) => out.push_str(constant.name()),
        ExprKind::Coordinate(axis) => out.push_str(COORDINATES[usize::from(*axis)]),
        ExprKind::Parameter(name) => out.push_str(name),
        ExprKind::Negated(inner) => {
            out.push('-');
            write_at(out, inner, Precedence::Sign);
        }
        ExprKind::Sum(terms) => {
            for (index, (sign, term)) in terms.iter().enumerate() {
                match (index, sign) {
                    (0, _) => {}
                    (_, Sign::Plus) => out.push_str(" + "),
                    (_, Sign::Minus) => out.push_str(" - "),
                }
                write_at(out, term, Precedence::Sign);
            }
        }
        ExprKind::Product(factors) => {
            for (index, (relation, factor)) in factors.iter().enumerate() {
                match (index, relation) {
                    (0, _) => {}
                    (_, Factor::Times) => out.push('*'),
                    (_, Factor::Over) => out.push('/'),
                }
                write_at(out, factor, Precedence::Power);
            }
        }
        ExprKind::Power(base, exponent) => {
            write_at(out, base, Precedence::Atom);
            out.push('^');
            let mut exponent = &**exponent;
            while let ExprKind::Negated(inner) = &exponent.kind {
                out.push('-');
                exponent = inner;
            }
            write_at(out, exponent, Precedence::Power);
        }
        ExprKind::Call(function, arguments) => {
            out.push_str(function.name());
            out.push('(');
            for (index, argument) in arguments.iter().enumerate() {
                if index > 0 {
                    out.push_str(", ");
                }
                write(out, argument);
            }
            out.push(')');
        }
    }
}
