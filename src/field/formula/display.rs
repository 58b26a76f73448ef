//! Plain text of a formula, which parses back to the same tree.

use super::ast::{COORDINATES, Equation, Expr, Factor, Kind, Sign};
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

pub(super) fn level(kind: &Kind) -> Precedence {
    match kind {
        Kind::Sum(_) => Precedence::Sum,
        Kind::Negated(_) => Precedence::Sign,
        Kind::Product(_) => Precedence::Product,
        Kind::Power(_, _) => Precedence::Power,
        Kind::Number(_) | Kind::Constant(_) | Kind::Coordinate(_) | Kind::Parameter(_) | Kind::Call(_, _) => {
            Precedence::Atom
        }
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
        Kind::Number(value) => out.push_str(&shortest_text(*value)),
        Kind::Constant(constant) => out.push_str(constant.name()),
        Kind::Coordinate(axis) => out.push_str(COORDINATES[usize::from(*axis)]),
        Kind::Parameter(name) => out.push_str(name),
        Kind::Negated(inner) => {
            out.push('-');
            write_at(out, inner, Precedence::Sign);
        }
        Kind::Sum(terms) => {
            for (index, (sign, term)) in terms.iter().enumerate() {
                match (index, sign) {
                    (0, _) => {}
                    (_, Sign::Plus) => out.push_str(" + "),
                    (_, Sign::Minus) => out.push_str(" - "),
                }
                write_at(out, term, Precedence::Sign);
            }
        }
        Kind::Product(factors) => {
            for (index, (relation, factor)) in factors.iter().enumerate() {
                match (index, relation) {
                    (0, _) => {}
                    (_, Factor::Times) => out.push('*'),
                    (_, Factor::Over) => out.push('/'),
                }
                write_at(out, factor, Precedence::Power);
            }
        }
        Kind::Power(base, exponent) => {
            write_at(out, base, Precedence::Atom);
            out.push('^');
            let mut exponent = &**exponent;
            while let Kind::Negated(inner) = &exponent.kind {
                out.push('-');
                exponent = inner;
            }
            write_at(out, exponent, Precedence::Power);
        }
        Kind::Call(function, arguments) => {
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
