//! Presentation MathML of a formula, with fractions, roots, powers and Greek letters.

use super::Formula;
use super::ast::{COORDINATES, Connective, Constant, Equation, Expr, ExprKind, Factor, Function, Sign};
use super::display::{Precedence, level};
use super::latex::greek;
use super::operations::Unary;
use super::token::Comparison;
use crate::math::shortest_text;
use serde::Serialize;

/// Element of MathML Core with child elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "lowercase")]
pub enum MathGroup {
    /// Two or more elements side by side.
    Mrow,
    /// A numerator and a denominator.
    Mfrac,
    /// A base and a superscript.
    Msup,
    /// A base and a subscript.
    Msub,
    /// The radicand of a square root: one or more elements side by side.
    Msqrt,
    /// The radicand of a root, and its degree.
    Mroot,
    /// Rows of a table.
    Mtable,
    /// Cells of a row.
    Mtr,
    /// One or more elements in a cell.
    Mtd,
}

/// Element of MathML Core with text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "lowercase")]
pub enum MathToken {
    /// An identifier.
    Mi,
    /// A number.
    Mn,
    /// An operator or a fence.
    Mo,
}

/// MathML element with its content.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(untagged)]
pub enum MathNode {
    /// An element with text.
    Token {
        /// Name of the element.
        tag: MathToken,
        /// The text, not escaped.
        text: String,
    },
    /// An element with child elements.
    Group {
        /// Name of the element.
        tag: MathGroup,
        /// The child elements, in order.
        children: Vec<MathNode>,
    },
}

/// Content of the `math` element for an equation. A formula without `=` gets `= 0`. With
/// definitions or colours it is a table, and the surface is its last row.
pub(super) fn equation(equation: &Equation, colours: &[(&'static str, Formula)]) -> MathNode {
    let right = equation.right.as_ref().map_or_else(|| mn("0"), expression);
    let mut parts = vec![expression(&equation.left), mo("="), right];
    for (index, condition) in equation.region.iter().enumerate() {
        let before = if index == 0 { &[EM_SPACE, "{"][..] } else { &[","] };
        parts.extend(before.iter().map(|&text| mo(text)));
        parts.push(expression(condition));
    }
    if !equation.region.is_empty() {
        parts.push(mo("}"));
    }
    let surface = row(parts);
    if equation.definitions.is_empty() && colours.is_empty() {
        return surface;
    }
    let definitions = equation.definitions.iter().map(|definition| {
        let name = parameter(&definition.name);
        let head = if definition.arguments.is_empty() {
            name
        } else {
            applied(name, definition.arguments.iter().map(|argument| parameter(argument)))
        };
        row([head, mo("="), expression(&definition.body)])
    });
    let colours = colours
        .iter()
        .map(|(name, colour)| row([parameter(name), mo("="), expression(&colour.written.equation.left)]));
    table(definitions.chain(colours).chain([surface]).map(|row| vec![row]))
}

fn table(rows: impl Iterator<Item = Vec<MathNode>>) -> MathNode {
    let cell = |content: MathNode| group(MathGroup::Mtd, [content]);
    let rows = rows.map(|row| group(MathGroup::Mtr, row.into_iter().map(cell).collect::<Vec<_>>()));
    group(MathGroup::Mtable, rows.collect::<Vec<_>>())
}

/// U+2003 EM SPACE.
const EM_SPACE: &str = "\u{2003}";
/// U+2062 INVISIBLE TIMES.
const INVISIBLE_TIMES: &str = "\u{2062}";
/// U+2061 FUNCTION APPLICATION.
const APPLY: &str = "\u{2061}";

fn mi(text: &str) -> MathNode {
    MathNode::Token { tag: MathToken::Mi, text: text.to_owned() }
}

fn mn(text: &str) -> MathNode {
    MathNode::Token { tag: MathToken::Mn, text: text.to_owned() }
}

fn mo(text: &str) -> MathNode {
    MathNode::Token { tag: MathToken::Mo, text: text.to_owned() }
}

fn group(tag: MathGroup, children: impl Into<Vec<MathNode>>) -> MathNode {
    MathNode::Group { tag, children: children.into() }
}

fn row(children: impl Into<Vec<MathNode>>) -> MathNode {
    group(MathGroup::Mrow, children)
}

fn msup(base: MathNode, exponent: MathNode) -> MathNode {
    group(MathGroup::Msup, [base, exponent])
}

/// Row of an element between two fences.
fn fenced([open, close]: [&str; 2], inner: MathNode) -> MathNode {
    row([mo(open), inner, mo(close)])
}

fn bracketed(inner: MathNode) -> MathNode {
    fenced(["(", ")"], inner)
}

/// `expr` as one element, in brackets if its precedence is below `least`.
fn at(expr: &Expr, least: Precedence) -> MathNode {
    if level(&expr.kind) < least { bracketed(expression(expr)) } else { expression(expr) }
}

/// `expr` as one element.
fn expression(expr: &Expr) -> MathNode {
    match &expr.kind {
        ExprKind::Number(value) => number(*value),
        ExprKind::Constant(constant) => mi(constant_letter(*constant)),
        ExprKind::Coordinate(axis) => mi(COORDINATES[usize::from(*axis)]),
        ExprKind::Parameter(name) => parameter(name),
        ExprKind::Negated(inner) => row([mo("−"), at(inner, Precedence::Product)]),
        ExprKind::Sum(terms) => sum(terms),
        ExprKind::Product(factors) => product(factors),
        ExprKind::Power(base, exponent) => power(base, exponent),
        ExprKind::Call(function, arguments) => call(*function, arguments),
        ExprKind::Argument(reference) => parameter(&reference.name),
        ExprKind::Defined(reference, inputs) if inputs.is_empty() => parameter(&reference.name),
        ExprKind::Defined(reference, inputs) => {
            applied(parameter(&reference.name), inputs.iter().map(expression))
        }
        ExprKind::Choice(parts) => {
            let [condition, first, second] = &**parts;
            let cases = [
                vec![expression(first), row([mi("if\u{a0}"), expression(condition)])],
                vec![expression(second), mi("otherwise")],
            ];
            row([mo("{"), table(cases.into_iter())])
        }
        ExprKind::Compare(comparison, sides) => {
            let sign = match comparison {
                Comparison::Less => "<",
                Comparison::AtMost => "≤",
                Comparison::Greater => ">",
                Comparison::AtLeast => "≥",
            };
            row([at(&sides[0], Precedence::Sum), mo(sign), at(&sides[1], Precedence::Sum)])
        }
        ExprKind::Logic(connective, conditions) => {
            let (sign, least) = match connective {
                Connective::And => ("∧", Precedence::Comparison),
                Connective::Or => ("∨", Precedence::And),
            };
            row(separated(conditions.iter().map(|condition| at(condition, least)), sign))
        }
        ExprKind::Not(inner) => row([mo("¬"), at(inner, Precedence::Atom)]),
    }
}

fn number(value: f64) -> MathNode {
    let text = shortest_text(value);
    match text.split_once('e') {
        None => mn(&text),
        Some((mantissa, exponent)) => {
            row([mn(mantissa), mo("⋅"), msup(mn("10"), mn(&exponent.replace('-', "−")))])
        }
    }
}

fn sum(terms: &[(Sign, Expr)]) -> MathNode {
    let mut out = Vec::new();
    for (index, (sign, term)) in terms.iter().enumerate() {
        if index > 0 {
            out.push(mo(if *sign == Sign::Plus { "+" } else { "−" }));
        }
        out.push(at(term, if index == 0 { Precedence::Sign } else { Precedence::Product }));
    }
    row(out)
}

/// Product of the factors, where a division has everything before it as numerator.
fn product(factors: &[(Factor, Expr)]) -> MathNode {
    let Some(last) = factors.iter().rposition(|(relation, _)| *relation == Factor::Over) else {
        return match factors {
            [(_, only)] => expression(only),
            _ => row(side_by_side(factors, None)),
        };
    };
    let fraction = group(MathGroup::Mfrac, [product(&factors[..last]), expression(&factors[last].1)]);
    match &factors[last + 1..] {
        [] => fraction,
        rest => row(side_by_side(rest, Some(fraction))),
    }
}

/// Factors side by side, after the element `before` them.
fn side_by_side(factors: &[(Factor, Expr)], before: Option<MathNode>) -> Vec<MathNode> {
    let mut out: Vec<MathNode> = before.into_iter().collect();
    for (_, factor) in factors {
        if !out.is_empty() {
            out.push(mo(if starts_with_digit(factor) { "⋅" } else { INVISIBLE_TIMES }));
        }
        out.push(at(factor, Precedence::Product));
    }
    out
}

fn power(base: &Expr, exponent: &Expr) -> MathNode {
    // The power of a function is written sin²(x).
    if let (ExprKind::Call(function, inputs), ExprKind::Number(n)) = (&base.kind, &exponent.kind)
        && let Some(name) = plain_name(*function)
        && *n >= 2.0
    {
        return applied(msup(mi(name), number(*n)), inputs.iter().map(expression));
    }
    let exponential = matches!(base.kind, ExprKind::Call(Function::Unary(Unary::Exp | Unary::Log10), _));
    let long_number = matches!(base.kind, ExprKind::Number(value) if shortest_text(value).contains('e'));
    let base =
        if exponential || long_number { bracketed(expression(base)) } else { at(base, Precedence::Atom) };
    msup(base, expression(exponent))
}

fn call(function: Function, inputs: &[Expr]) -> MathNode {
    let first = || expression(&inputs[0]);
    match function {
        Function::Unary(Unary::Sqrt) => group(MathGroup::Msqrt, [first()]),
        Function::Unary(Unary::Cbrt) => group(MathGroup::Mroot, [first(), mn("3")]),
        Function::Unary(Unary::Abs) => fenced(["|", "|"], first()),
        Function::Unary(Unary::Floor) => fenced(["⌊", "⌋"], first()),
        Function::Unary(Unary::Exp) => msup(mi(constant_letter(Constant::E)), first()),
        Function::Hypot => {
            let squares = inputs.iter().map(|input| msup(at(input, Precedence::Atom), mn("2")));
            group(MathGroup::Msqrt, separated(squares, "+"))
        }
        _ if function.name() == "ceil" => fenced(["⌈", "⌉"], first()),
        _ => {
            let name = match plain_name(function) {
                Some(name) => mi(name),
                None => group(MathGroup::Msub, [mi("log"), mn(function.name().trim_start_matches("log"))]),
            };
            applied(name, inputs.iter().map(expression))
        }
    }
}

/// A function with its arguments.
fn applied(name: MathNode, arguments: impl Iterator<Item = MathNode>) -> MathNode {
    row([name, mo(APPLY), listed(arguments)])
}

fn listed(arguments: impl Iterator<Item = MathNode>) -> MathNode {
    let mut out = vec![mo("(")];
    out.extend(separated(arguments, ","));
    out.push(mo(")"));
    row(out)
}

/// Elements with an operator between them.
fn separated(elements: impl Iterator<Item = MathNode>, operator: &str) -> Vec<MathNode> {
    let mut out = Vec::new();
    for element in elements {
        if !out.is_empty() {
            out.push(mo(operator));
        }
        out.push(element);
    }
    out
}

/// Name of a parameter. The name of a Greek letter becomes the letter; trailing digits, or what
/// follows `_`, become a subscript.
fn parameter(name: &str) -> MathNode {
    let (stem, index) = match name.split_once('_') {
        Some((stem, index)) if !index.is_empty() => (stem, index),
        _ => name
            .split_at_checked(name.trim_end_matches(|c: char| c.is_ascii_digit()).len())
            .unwrap_or((name, "")),
    };
    let stem = mi(greek(stem).unwrap_or(stem));
    if index.is_empty() {
        return stem;
    }
    let is_number = index.bytes().all(|b| b.is_ascii_digit());
    let index = greek(index).unwrap_or(index);
    group(MathGroup::Msub, [stem, if is_number { mn(index) } else { mi(index) }])
}

fn constant_letter(constant: Constant) -> &'static str {
    match constant {
        Constant::Pi => "π",
        Constant::E => "e",
        Constant::Tau => "τ",
        Constant::Phi => "φ",
    }
}

/// Name of a function that is written with its name and brackets; `None` for one with a notation of
/// its own.
fn plain_name(function: Function) -> Option<&'static str> {
    Some(match function {
        Function::Hypot
        | Function::Unary(
            Unary::Sqrt | Unary::Cbrt | Unary::Abs | Unary::Floor | Unary::Exp | Unary::Log10,
        ) => return None,
        Function::Unary(Unary::Sign) => "sgn",
        Function::Unary(Unary::Asin) => "arcsin",
        Function::Unary(Unary::Acos) => "arccos",
        Function::Unary(Unary::Atan) => "arctan",
        Function::Unary(Unary::Asinh) => "arsinh",
        Function::Unary(Unary::Acosh) => "arcosh",
        Function::Unary(Unary::Atanh) => "artanh",
        other if matches!(other.name(), "log2" | "ceil") => return None,
        other => other.name(),
    })
}

/// Whether the typeset `expr` begins with a digit.
fn starts_with_digit(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Number(_) => true,
        ExprKind::Power(base, _) => starts_with_digit(base),
        ExprKind::Product(factors) => starts_with_digit(&factors[0].1),
        _ => false,
    }
}
