//! A formula as presentation MathML: fractions, roots, powers and Greek letters, as one would write it by hand.
//!
//! Text comes from the tree, whose names hold letters, digits and underscores only, and is escaped all the same.

use super::ast::{COORDINATES, Constant, Equation, Expr, Factor, Function, Kind, Sign};
use super::display::{Level, level, number};

/// The equation as a `math` element; a formula without `=` gets `= 0`.
pub(super) fn equation(equation: &Equation) -> String {
    let mut out = Writer::default();
    out.raw("<math xmlns=\"http://www.w3.org/1998/Math/MathML\" display=\"block\">");
    out.row(|out| {
        out.expression(&equation.left);
        out.operator("=");
        match &equation.right {
            Some(right) => out.expression(right),
            None => out.leaf("mn", "0"),
        }
    });
    out.raw("</math>");
    out.text
}

/// U+2062 INVISIBLE TIMES.
const INVISIBLE_TIMES: &str = "\u{2062}";
/// U+2061 FUNCTION APPLICATION.
const APPLY: &str = "\u{2061}";

#[derive(Default)]
struct Writer {
    text: String,
}

impl Writer {
    fn raw(&mut self, markup: &str) {
        self.text.push_str(markup);
    }

    fn element(&mut self, name: &str, inner: impl FnOnce(&mut Self)) {
        self.text.extend(["<", name, ">"]);
        inner(self);
        self.text.extend(["</", name, ">"]);
    }

    fn row(&mut self, inner: impl FnOnce(&mut Self)) {
        self.element("mrow", inner);
    }

    fn leaf(&mut self, name: &str, text: &str) {
        self.element(name, |out| {
            for c in text.chars() {
                match c {
                    '&' => out.raw("&amp;"),
                    '<' => out.raw("&lt;"),
                    '>' => out.raw("&gt;"),
                    '"' => out.raw("&quot;"),
                    _ => out.text.push(c),
                }
            }
        });
    }

    fn operator(&mut self, text: &str) {
        self.leaf("mo", text);
    }

    /// A row between two fences.
    fn fenced(&mut self, [open, close]: [&str; 2], inner: impl FnOnce(&mut Self)) {
        self.row(|out| {
            out.operator(open);
            inner(out);
            out.operator(close);
        });
    }

    /// `expr` as one element, in brackets if it binds weaker than `least`.
    fn at(&mut self, expr: &Expr, least: Level) {
        if level(&expr.kind) < least {
            self.fenced(["(", ")"], |out| out.expression(expr));
        } else {
            self.expression(expr);
        }
    }

    /// `expr` as one element.
    fn expression(&mut self, expr: &Expr) {
        match &expr.kind {
            Kind::Number(value) => self.number(*value),
            Kind::Constant(constant) => self.leaf("mi", constant_letter(*constant)),
            Kind::Coordinate(axis) => self.leaf("mi", COORDINATES[usize::from(*axis)]),
            Kind::Parameter(name) => self.name(name),
            Kind::Negated(inner) => self.row(|out| {
                out.operator("−");
                out.at(inner, Level::Product);
            }),
            Kind::Sum(terms) => self.row(|out| {
                for (index, (sign, term)) in terms.iter().enumerate() {
                    if index > 0 {
                        out.operator(if *sign == Sign::Plus { "+" } else { "−" });
                    }
                    out.at(term, if index == 0 { Level::Sign } else { Level::Product });
                }
            }),
            Kind::Product(factors) => self.product(factors),
            Kind::Power(base, exponent) => self.power(base, exponent),
            Kind::Call(function, arguments) => self.call(*function, arguments),
        }
    }

    fn number(&mut self, value: f64) {
        let text = number(value);
        match text.split_once('e') {
            None => self.leaf("mn", &text),
            Some((mantissa, exponent)) => self.row(|out| {
                out.leaf("mn", mantissa);
                out.operator("⋅");
                out.element("msup", |out| {
                    out.leaf("mn", "10");
                    out.leaf("mn", &exponent.replace('-', "−"));
                });
            }),
        }
    }

    /// Factors from left to right; a division puts everything before it over the divisor.
    fn product(&mut self, factors: &[(Factor, Expr)]) {
        let Some(at) = factors.iter().rposition(|(relation, _)| *relation == Factor::Over) else {
            return match factors {
                [(_, only)] => self.expression(only),
                _ => self.row(|out| out.factors(factors, false)),
            };
        };
        let fraction = |out: &mut Self| {
            out.element("mfrac", |out| {
                out.product(&factors[..at]);
                out.expression(&factors[at].1);
            });
        };
        match &factors[at + 1..] {
            [] => fraction(self),
            rest => self.row(|out| {
                fraction(out);
                out.factors(rest, true);
            }),
        }
    }

    /// Factors one after the other; `continued` if others stand before them.
    fn factors(&mut self, factors: &[(Factor, Expr)], continued: bool) {
        for (index, (_, factor)) in factors.iter().enumerate() {
            if index > 0 || continued {
                self.operator(if starts_with_digit(factor) { "⋅" } else { INVISIBLE_TIMES });
            }
            self.at(factor, Level::Product);
        }
    }

    fn power(&mut self, base: &Expr, exponent: &Expr) {
        // sin²(x), as it is written by hand.
        if let (Kind::Call(function, arguments), Kind::Number(n)) = (&base.kind, &exponent.kind)
            && let Some(name) = plain_name(*function)
            && *n >= 2.0
        {
            return self.row(|out| {
                out.element("msup", |out| {
                    out.leaf("mi", name);
                    out.number(*n);
                });
                out.operator(APPLY);
                out.arguments(arguments);
            });
        }
        self.element("msup", |out| {
            let exponential = matches!(base.kind, Kind::Call(Function::Exp | Function::Log10, _));
            let long_number = matches!(base.kind, Kind::Number(value) if number(value).contains('e'));
            if exponential || long_number {
                out.fenced(["(", ")"], |out| out.expression(base));
            } else {
                out.at(base, Level::Atom);
            }
            out.expression(exponent);
        });
    }

    fn call(&mut self, function: Function, arguments: &[Expr]) {
        let first = &arguments[0];
        match function {
            Function::Sqrt => self.element("msqrt", |out| out.expression(first)),
            Function::Cbrt => self.element("mroot", |out| {
                out.expression(first);
                out.leaf("mn", "3");
            }),
            Function::Abs => self.fenced(["|", "|"], |out| out.expression(first)),
            Function::Floor => self.fenced(["⌊", "⌋"], |out| out.expression(first)),
            Function::Exp => self.element("msup", |out| {
                out.leaf("mi", constant_letter(Constant::E));
                out.expression(first);
            }),
            Function::Hypot => self.element("msqrt", |out| {
                for (index, argument) in arguments.iter().enumerate() {
                    if index > 0 {
                        out.operator("+");
                    }
                    out.element("msup", |out| {
                        out.at(argument, Level::Atom);
                        out.leaf("mn", "2");
                    });
                }
            }),
            _ => self.row(|out| {
                match plain_name(function) {
                    Some(name) => out.leaf("mi", name),
                    None => out.element("msub", |out| {
                        out.leaf("mi", "log");
                        out.leaf("mn", "10");
                    }),
                }
                out.operator(APPLY);
                out.arguments(arguments);
            }),
        }
    }

    fn arguments(&mut self, arguments: &[Expr]) {
        self.fenced(["(", ")"], |out| {
            for (index, argument) in arguments.iter().enumerate() {
                if index > 0 {
                    out.operator(",");
                }
                out.expression(argument);
            }
        });
    }

    /// A parameter's name: Greek letters by their names, digits at the end and what follows `_` as an index.
    fn name(&mut self, name: &str) {
        let (stem, index) = match name.split_once('_') {
            Some((stem, index)) if !index.is_empty() => (stem, index),
            _ => name
                .split_at_checked(name.trim_end_matches(|c: char| c.is_ascii_digit()).len())
                .unwrap_or((name, "")),
        };
        let stem = greek(stem).unwrap_or(stem);
        if index.is_empty() {
            return self.leaf("mi", stem);
        }
        self.element("msub", |out| {
            out.leaf("mi", stem);
            let digits = index.bytes().all(|b| b.is_ascii_digit());
            out.leaf(if digits { "mn" } else { "mi" }, greek(index).unwrap_or(index));
        });
    }
}

fn constant_letter(constant: Constant) -> &'static str {
    match constant {
        Constant::Pi => "π",
        Constant::E => "e",
        Constant::Tau => "τ",
        Constant::Phi => "φ",
    }
}

/// The name in front of the brackets, for functions that are written so.
fn plain_name(function: Function) -> Option<&'static str> {
    Some(match function {
        Function::Sqrt
        | Function::Cbrt
        | Function::Abs
        | Function::Floor
        | Function::Exp
        | Function::Hypot
        | Function::Log10 => return None,
        Function::Sign => "sgn",
        Function::Asin => "arcsin",
        Function::Acos => "arccos",
        Function::Atan => "arctan",
        other => other.name(),
    })
}

/// Whether the leftmost symbol of `expr`, as it is set, is a digit.
fn starts_with_digit(expr: &Expr) -> bool {
    match &expr.kind {
        Kind::Number(_) => true,
        Kind::Power(base, _) => starts_with_digit(base),
        Kind::Product(factors) => starts_with_digit(&factors[0].1),
        _ => false,
    }
}

/// The Greek letter of this name.
fn greek(name: &str) -> Option<&'static str> {
    Some(match name {
        "alpha" => "α",
        "beta" => "β",
        "gamma" => "γ",
        "delta" => "δ",
        "epsilon" => "ε",
        "zeta" => "ζ",
        "eta" => "η",
        "theta" => "θ",
        "iota" => "ι",
        "kappa" => "κ",
        "lambda" => "λ",
        "mu" => "μ",
        "nu" => "ν",
        "xi" => "ξ",
        "rho" => "ρ",
        "sigma" => "σ",
        "upsilon" => "υ",
        "chi" => "χ",
        "psi" => "ψ",
        "omega" => "ω",
        "Gamma" => "Γ",
        "Delta" => "Δ",
        "Theta" => "Θ",
        "Lambda" => "Λ",
        "Xi" => "Ξ",
        "Sigma" => "Σ",
        "Phi" => "Φ",
        "Psi" => "Ψ",
        "Omega" => "Ω",
        _ => return None,
    })
}
