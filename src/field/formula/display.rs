//! Plain text of a formula, which parses back to the same tree.

use super::Parameter;
use super::ast::{COORDINATES, Connective, Equation, Expr, ExprKind, Factor, Function, Sign};
use super::graph::{Graph, Id, Node};
use super::operations::{Binary, Unary};
use super::token::Comparison;
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

/// Text of a node of a graph.
pub(super) fn node(graph: &Graph, id: Id, parameters: &[Parameter]) -> String {
    plain(&tree(graph, id, parameters))
}

/// The expression of a node of a graph, without spans.
fn tree(graph: &Graph, id: Id, parameters: &[Parameter]) -> Expr {
    let of = |id: Id| tree(graph, id, parameters);
    let with = |kind: ExprKind| Expr { kind, span: 0..0 };
    let call = |function: Function, operands: &[Id]| {
        ExprKind::Call(function, operands.iter().map(|&operand| of(operand)).collect())
    };
    let power = |base: Id, exponent: ExprKind| ExprKind::Power(Box::new(of(base)), Box::new(with(exponent)));
    with(match graph.node(id) {
        Node::Constant(bits) if f64::from_bits(bits) < 0.0 => {
            ExprKind::Negated(Box::new(with(ExprKind::Number(-f64::from_bits(bits)))))
        }
        Node::Constant(bits) => ExprKind::Number(f64::from_bits(bits)),
        Node::Parameter(index) => ExprKind::Parameter(parameters[index as usize].name.to_string()),
        Node::Coordinate(axis) => ExprKind::Coordinate(axis),
        Node::Unary(Unary::Limit, a) => of(a).kind,
        Node::Unary(Unary::Neg, a) => ExprKind::Negated(Box::new(of(a))),
        Node::Unary(operation, a) => call(Function::Unary(operation), &[a]),
        Node::Binary(Binary::Add, a, b) => match graph.as_constant(b).filter(|&b| b < 0.0) {
            Some(b) => ExprKind::Sum(vec![(Sign::Plus, of(a)), (Sign::Minus, with(ExprKind::Number(-b)))]),
            None => ExprKind::Sum(vec![(Sign::Plus, of(a)), (Sign::Plus, of(b))]),
        },
        Node::Binary(Binary::Sub, a, b) => ExprKind::Sum(vec![(Sign::Plus, of(a)), (Sign::Minus, of(b))]),
        Node::Binary(Binary::Mul, a, b) if graph.is_uniform(b) => {
            ExprKind::Product(vec![(Factor::Times, of(b)), (Factor::Times, of(a))])
        }
        Node::Binary(Binary::Mul, a, b) => {
            ExprKind::Product(vec![(Factor::Times, of(a)), (Factor::Times, of(b))])
        }
        Node::Binary(Binary::Div, a, b) => {
            ExprKind::Product(vec![(Factor::Times, of(a)), (Factor::Over, of(b))])
        }
        Node::Binary(Binary::Pow, a, b) => power(a, of(b).kind),
        Node::Binary(operation, a, b) => call(Function::Binary(operation), &[a, b]),
        Node::Power(a, n) if n < 0 => {
            power(a, ExprKind::Negated(Box::new(with(ExprKind::Number(-f64::from(n))))))
        }
        Node::Power(a, n) => power(a, ExprKind::Number(f64::from(n))),
        Node::Smin(blend, a, b, k) => call(Function::Smin(blend), &[a, b, k]),
        Node::If(is_where, a, b, v) => {
            let zero = with(ExprKind::Number(0.0));
            chosen([of(a), of(b)], if is_where { [of(v), zero] } else { [zero, of(v)] })
        }
        Node::Select(_, a, b, u, v) => chosen([of(a), of(b)], [of(u), of(v)]),
    })
}

/// The first value where the first side is at most the second, else the other.
fn chosen(sides: [Expr; 2], [u, v]: [Expr; 2]) -> ExprKind {
    let condition = Expr { kind: ExprKind::Compare(Comparison::AtMost, Box::new(sides)), span: 0..0 };
    ExprKind::Choice(Box::new([condition, u, v]))
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
    // A lone name before the `=` may be read as the function's name.
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
    for (index, condition) in equation.region.iter().enumerate() {
        out.push_str(if index == 0 { " {" } else { ", " });
        write(&mut out, condition);
    }
    if !equation.region.is_empty() {
        out.push('}');
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
            // `E^` is refused: it may be meant for Euler's number.
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
