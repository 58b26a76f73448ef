//! Plain text of a formula, which parses back to the same tree.

use super::ast::{COORDINATES, Connective, Equation, Expr, ExprKind, Factor, Function, Sign};
use crate::math::shortest_text;

/// Precedence, weakest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Precedence {
    Or,
    And,
    Comparison,
    Sum,
    /// A leading sign, with the precedence of a product whose first factor it may belong to.
    Sign,
    Product,
    Power,
    Atom,
}

pub(super) fn level(kind: &ExprKind) -> Precedence {
    match kind {
        ExprKind::Logic(Connective::Or, _) => Precedence::Or,
        ExprKind::Logic(Connective::And, _) => Precedence::And,
        ExprKind::Compare(..) | ExprKind::Not(_) => Precedence::Comparison,
        ExprKind::Sum(_) => Precedence::Sum,
        ExprKind::Negated(_) => Precedence::Sign,
        ExprKind::Product(_) => Precedence::Product,
        ExprKind::Power(_, _) => Precedence::Power,
        ExprKind::Number(_)
        | ExprKind::Constant(_)
        | ExprKind::Coordinate(_)
        | ExprKind::Parameter(_)
        | ExprKind::Argument(_)
        | ExprKind::Defined(..)
        | ExprKind::Choice(_)
        | ExprKind::Call(..) => Precedence::Atom,
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
    let mut out = String::new();
    for definition in &equation.definitions {
        out.push_str(&definition.name);
        if !definition.arguments.is_empty() {
            out.push('(');
            out.push_str(&definition.arguments.join(", "));
            out.push(')');
        }
        out.push_str(" = ");
        write(&mut out, &definition.body);
        out.push_str("; ");
    }
    // A lone name before the `=` may be read as that of the function.
    let is_lone = matches!(equation.left.kind, ExprKind::Parameter(_) | ExprKind::Constant(_));
    if equation.looks_like_definition() || is_lone && equation.right.is_some() {
        out.push('(');
        write(&mut out, &equation.left);
        out.push(')');
    } else {
        write(&mut out, &equation.left);
    }
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
            // `E^` may be meant for Euler's number, which is refused.
            let is_e = matches!(&base.kind, ExprKind::Parameter(name) if name == "E");
            if is_e {
                out.push_str("(E)");
            } else {
                write_at(out, base, Precedence::Atom);
            }
            out.push('^');
            let mut exponent = &**exponent;
            while let ExprKind::Negated(inner) = &exponent.kind {
                out.push('-');
                exponent = inner;
            }
            write_at(out, exponent, Precedence::Power);
        }
        ExprKind::Call(function, arguments) => write_call(out, function.name(), arguments),
        ExprKind::Argument(reference) => out.push_str(&reference.name),
        ExprKind::Defined(reference, arguments) if arguments.is_empty() => out.push_str(&reference.name),
        ExprKind::Defined(reference, arguments) => write_call(out, &reference.name, arguments),
        ExprKind::Choice(parts) => write_call(out, Function::If.name(), &**parts),
        ExprKind::Compare(comparison, sides) => {
            write_at(out, &sides[0], Precedence::Sum);
            out.push(' ');
            out.push_str(comparison.sign());
            out.push(' ');
            write_at(out, &sides[1], Precedence::Sum);
        }
        ExprKind::Logic(connective, conditions) => {
            let (word, least) = match connective {
                Connective::And => (" and ", Precedence::Comparison),
                Connective::Or => (" or ", Precedence::And),
            };
            for (index, condition) in conditions.iter().enumerate() {
                if index > 0 {
                    out.push_str(word);
                }
                write_at(out, condition, least);
            }
        }
        ExprKind::Not(inner) => {
            out.push_str("not ");
            write_at(out, inner, Precedence::Comparison);
        }
    }
}

fn write_call(out: &mut String, name: &str, arguments: &[Expr]) {
    out.push_str(name);
    out.push('(');
    for (index, argument) in arguments.iter().enumerate() {
        if index > 0 {
            out.push_str(", ");
        }
        write(out, argument);
    }
    out.push(')');
}
