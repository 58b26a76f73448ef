//! Syntax tree of a formula.
//!
//! Sums and products are flat lists. The depth of a tree is therefore bounded by
//! [`MAX_DEPTH`](super::MAX_DEPTH), which the parser enforces, and recursive walks cannot overflow
//! the stack. Definitions are not substituted for their names: the tree would grow beyond all
//! bounds.

use super::graph::Blend;
use super::operations::{Binary, Unary};
use super::token::Comparison;
use core::ops::Range;

/// An expression and the range of bytes it was parsed from.
#[derive(Clone, Debug)]
pub(crate) struct Expr {
    pub(crate) kind: ExprKind,
    pub(crate) span: Range<usize>,
}

/// Equality compares structure only and ignores spans.
impl PartialEq for Expr {
    fn eq(&self, other: &Self) -> bool {
        self.kind == other.kind
    }
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum ExprKind {
    Number(f64),
    Constant(Constant),
    Coordinate(u8),
    Parameter(String),
    Negated(Box<Expr>),
    /// Two or more terms.
    Sum(Vec<(Sign, Expr)>),
    /// Two or more factors, from left to right; the first one is always `Times`.
    Product(Vec<(Factor, Expr)>),
    Power(Box<Expr>, Box<Expr>),
    Call(Function, Vec<Expr>),
    /// An argument, in the body of the function that it belongs to.
    Argument(Reference),
    /// A value or, with its arguments, a function that the formula defines.
    Defined(Reference, Vec<Expr>),
    /// A condition, the value where it holds, and the value elsewhere.
    Choice(Box<[Expr; 3]>),
    /// A condition, as are the two variants below. The parser allows conditions only in choices and
    /// in other conditions.
    Compare(Comparison, Box<[Expr; 2]>),
    /// Two or more conditions.
    Logic(Connective, Vec<Expr>),
    Not(Box<Expr>),
}

/// A use of a name: its index among the definitions or the arguments, and the name.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Reference {
    pub(crate) index: usize,
    pub(crate) name: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Connective {
    And,
    Or,
}

impl ExprKind {
    pub(crate) fn is_condition(&self) -> bool {
        matches!(self, Self::Compare(..) | Self::Logic(..) | Self::Not(_))
    }
}

impl Expr {
    /// Calls `visit` with each expression that is a part of this one, from left to right.
    pub(crate) fn each<'a>(&'a self, visit: &mut dyn FnMut(&'a Self)) {
        match &self.kind {
            ExprKind::Number(_)
            | ExprKind::Constant(_)
            | ExprKind::Coordinate(_)
            | ExprKind::Parameter(_)
            | ExprKind::Argument(_) => {}
            ExprKind::Negated(inner) | ExprKind::Not(inner) => visit(inner),
            ExprKind::Sum(terms) => terms.iter().for_each(|(_, term)| visit(term)),
            ExprKind::Product(factors) => factors.iter().for_each(|(_, factor)| visit(factor)),
            ExprKind::Power(base, exponent) => [base, exponent].into_iter().for_each(|part| visit(part)),
            ExprKind::Call(_, parts) | ExprKind::Defined(_, parts) | ExprKind::Logic(_, parts) => {
                parts.iter().for_each(visit);
            }
            ExprKind::Choice(parts) => parts.iter().for_each(visit),
            ExprKind::Compare(_, sides) => sides.iter().for_each(visit),
        }
    }

    /// Whether `is` holds for this expression or any part of it.
    pub(crate) fn any(&self, is: &dyn Fn(&ExprKind) -> bool) -> bool {
        let mut found = is(&self.kind);
        self.each(&mut |part| found = found || part.any(is));
        found
    }

    /// Marks the definitions that this expression names.
    fn mark_used(&self, is_used: &mut [bool]) {
        if let ExprKind::Defined(Reference { index, .. }, _) = &self.kind {
            is_used[*index] = true;
        }
        self.each(&mut |part| part.mark_used(is_used));
    }

    /// The first condition in this expression that is used as a number. The expression itself may
    /// be a condition if `is_condition`.
    pub(crate) fn misplaced_condition(&self, is_condition: bool) -> Option<&Self> {
        if self.kind.is_condition() && !is_condition {
            return Some(self);
        }
        let (mut found, mut place) = (None, 0);
        self.each(&mut |part| {
            let is_condition = match &self.kind {
                ExprKind::Choice(_) => place == 0,
                kind => matches!(kind, ExprKind::Logic(..) | ExprKind::Not(_)),
            };
            place += 1;
            found = found.or_else(|| part.misplaced_condition(is_condition));
        });
        found
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sign {
    Plus,
    Minus,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Factor {
    Times,
    Over,
}

/// The formula `left`, or the equation `left = right`, with what it defines.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Equation {
    /// Each may use those before it. A later definition of the same name replaces the earlier one
    /// from there on.
    pub(crate) definitions: Vec<Definition>,
    pub(crate) left: Expr,
    pub(crate) right: Option<Expr>,
    /// The conditions that limit the surface: it ends where one of them ceases to hold.
    pub(crate) region: Vec<Expr>,
}

/// A value that has a name, or a function.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Definition {
    pub(crate) name: String,
    /// The names of the arguments of a function.
    pub(crate) arguments: Vec<String>,
    pub(crate) body: Expr,
}

impl Equation {
    /// The names of the definitions that the surface does not depend on, each once.
    pub(crate) fn unused(&self) -> Vec<String> {
        let mut is_used = vec![false; self.definitions.len()];
        let surface = [&self.left].into_iter().chain(&self.right).chain(&self.region);
        surface.for_each(|part| part.mark_used(&mut is_used));
        for (k, definition) in self.definitions.iter().enumerate().rev() {
            if is_used[k] {
                definition.body.mark_used(&mut is_used);
            }
        }
        let mut names: Vec<String> = Vec::new();
        for (definition, is_used) in self.definitions.iter().zip(is_used) {
            if !is_used && !names.contains(&definition.name) {
                names.push(definition.name.clone());
            }
        }
        names
    }

    /// Whether `left = right` would parse as a definition without brackets around the left side: a
    /// lone name equals an expression of coordinates or definitions, or of that same name.
    pub(crate) fn looks_like_definition(&self) -> bool {
        let Some(right) = &self.right else { return false };
        match &self.left.kind {
            ExprKind::Parameter(_) | ExprKind::Constant(_) => {
                right.any(&|kind| matches!(kind, ExprKind::Coordinate(_) | ExprKind::Defined(..)))
            }
            ExprKind::Defined(own, arguments) if arguments.is_empty() => {
                right.any(&|kind| matches!(kind, ExprKind::Defined(other, _) if other.name == own.name))
            }
            _ => false,
        }
    }
}

/// Names of the coordinates, by axis.
pub(crate) const COORDINATES: [&str; 3] = ["x", "y", "z"];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Constant {
    Pi,
    E,
    Tau,
    Phi,
}

impl Constant {
    pub(crate) const ALL: [Self; 4] = [Self::Pi, Self::E, Self::Tau, Self::Phi];

    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Pi => "pi",
            Self::E => "e",
            Self::Tau => "tau",
            Self::Phi => "phi",
        }
    }

    pub(crate) const fn value(self) -> f64 {
        match self {
            Self::Pi => core::f64::consts::PI,
            Self::E => core::f64::consts::E,
            Self::Tau => core::f64::consts::TAU,
            // The golden ratio (1 + √5)/2.
            Self::Phi => 1.618_033_988_749_895,
        }
    }

    pub(crate) fn find(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|constant| constant.name() == name)
    }
}

/// A function of the language.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Function {
    /// An operation of the graph on one value.
    Unary(Unary),
    /// An operation of the graph on two values, applied to all arguments from left to right.
    Binary(Binary),
    Hypot,
    /// A smooth minimum.
    Smin(Blend),
    Smax(Blend),
    /// A choice, which has a node of its own in the tree.
    If,
    /// A function that this text defines in terms of the argument names of its signature.
    Defined(&'static str),
}

/// Entry of the function reference.
#[derive(Clone, Copy, Debug, serde::Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct FunctionInfo {
    /// Name as typed in a formula.
    pub name: &'static str,
    /// Name with its arguments.
    pub signature: &'static str,
    /// Description in one sentence.
    pub help: &'static str,
    #[serde(skip)]
    pub(crate) function: Function,
}

/// Entry of a function; its name is the signature up to the bracket.
const fn described(function: Function, signature: &'static str, help: &'static str) -> FunctionInfo {
    let mut length = 0;
    while signature.as_bytes()[length] != b'(' {
        length += 1;
    }
    FunctionInfo { name: signature.split_at(length).0, signature, help, function }
}

macro_rules! functions {
    ($($kind:ident $(($operation:expr))? $signature:literal $help:literal),* $(,)?) => {
        /// Every function of the language, in the order of the help page.
        pub const FUNCTIONS: &[FunctionInfo] =
            &[$(described(Function::$kind $(($operation))?, $signature, $help)),*];
    };
}

functions! {
    Unary(Unary::Sqrt) "sqrt(a)" "Square root; undefined for a < 0.",
    Unary(Unary::Cbrt) "cbrt(a)" "Cube root, of negative numbers too.",
    Unary(Unary::Abs) "abs(a)" "Absolute value; its slope at 0 counts as 0.",
    Unary(Unary::Sign) "sign(a)" "−1, 0 or 1; its slope counts as 0.",
    Binary(Binary::Min) "min(a, b, …)" "The least of two or more values; at a tie the slope is the first one's.",
    Binary(Binary::Max) "max(a, b, …)" "The greatest of two or more values; at a tie the slope is the first one's.",
    If "if(c, a, b)" "a where the condition c holds, else b: x < 1, not, and, or. Also written c ? a : b.",
    Unary(Unary::Floor) "floor(a)" "The greatest whole number not above a; its slope counts as 0.",
    Defined("-floor(-a)") "ceil(a)" "The least whole number not below a.",
    Defined("floor(a + 1/2)") "round(a)" "The nearest whole number; halves are rounded up.",
    Defined("a - floor(a)") "fract(a)" "What a is above floor(a), from 0 to 1.",
    Defined("a - b*floor(a/b)") "mod(a, b)" "The remainder a − b floor(a/b), with the sign of b. Also written a % b.",
    Unary(Unary::Exp) "exp(a)" "e to the power a.",
    Unary(Unary::Ln) "ln(a)" "Natural logarithm; undefined for a < 0.",
    Unary(Unary::Log10) "log10(a)" "Logarithm to base 10; undefined for a < 0.",
    Defined("ln(a)/ln(2)") "log2(a)" "Logarithm to base 2; undefined for a < 0.",
    Unary(Unary::Sin) "sin(a)" "Sine, a in radians.",
    Unary(Unary::Cos) "cos(a)" "Cosine, a in radians.",
    Unary(Unary::Tan) "tan(a)" "Tangent, a in radians.",
    Defined("1/cos(a)") "sec(a)" "Secant 1/cos(a).",
    Defined("1/sin(a)") "csc(a)" "Cosecant 1/sin(a).",
    Defined("cos(a)/sin(a)") "cot(a)" "Cotangent cos(a)/sin(a).",
    Unary(Unary::Asin) "asin(a)" "Inverse sine in radians; undefined outside −1 … 1.",
    Unary(Unary::Acos) "acos(a)" "Inverse cosine in radians; undefined outside −1 … 1.",
    Unary(Unary::Atan) "atan(a)" "Inverse tangent in radians.",
    Binary(Binary::Atan2) "atan2(a, b)" "The angle of the point (b, a), from −pi to pi.",
    Unary(Unary::Sinh) "sinh(a)" "Hyperbolic sine.",
    Unary(Unary::Cosh) "cosh(a)" "Hyperbolic cosine.",
    Unary(Unary::Tanh) "tanh(a)" "Hyperbolic tangent.",
    Defined("1/cosh(a)") "sech(a)" "Hyperbolic secant 1/cosh(a).",
    Defined("1/sinh(a)") "csch(a)" "Hyperbolic cosecant 1/sinh(a).",
    Defined("cosh(a)/sinh(a)") "coth(a)" "Hyperbolic cotangent cosh(a)/sinh(a).",
    Unary(Unary::Asinh) "asinh(a)" "Inverse hyperbolic sine.",
    Unary(Unary::Acosh) "acosh(a)" "Inverse hyperbolic cosine; undefined for a < 1.",
    Unary(Unary::Atanh) "atanh(a)" "Inverse hyperbolic tangent; undefined outside −1 … 1.",
    Unary(Unary::Erf) "erf(a)" "Error function.",
    Hypot "hypot(a, b, …)" "Length of the vector (a, b, …): sqrt(a^2 + b^2 + …). Also called length.",
    Defined("min(max(a, b), c)") "clamp(a, b, c)" "a, but no less than b and no more than c.",
    Defined("a*(1 - c) + b*c") "mix(a, b, c)" "From a, where c = 0, to b, where c = 1.",
    Defined("if(b < a, 0, 1)") "step(a, b)" "0 where b < a, else 1; its slope counts as 0.",
    Defined("clamp((c - a)/(b - a), 0, 1)^2*(3 - 2*clamp((c - a)/(b - a), 0, 1))") "smoothstep(a, b, c)"
        "From 0, where c ≤ a, smoothly to 1, where c ≥ b.",
    Smin(Blend::Cubic) "smin(a, b, k)"
        "Smooth minimum: the union of two solids, blended where |a − b| < k by a cubic polynomial.",
    Smax(Blend::Cubic) "smax(a, b, k)"
        "Smooth maximum: the intersection of two solids, blended where |a − b| < k by a cubic polynomial.",
    Smin(Blend::Quadratic) "smin2(a, b, k)" "Smooth minimum like smin, but by a quadratic polynomial, which is deeper: by k/4.",
    Smax(Blend::Quadratic) "smax2(a, b, k)" "Smooth maximum like smax, but by a quadratic polynomial.",
}

impl Function {
    pub(crate) fn find(name: &str) -> Option<Self> {
        FUNCTIONS.iter().find(|info| info.name == name).map(|info| info.function)
    }

    pub(crate) fn info(self) -> &'static FunctionInfo {
        FUNCTIONS.iter().find(|info| info.function == self).expect("every function is described")
    }

    pub(crate) fn name(self) -> &'static str {
        self.info().name
    }

    /// Minimum and maximum number of arguments, as the signature shows them; a function with `…`
    /// takes any number from the minimum on.
    pub(crate) fn arity(self) -> (usize, usize) {
        let signature = self.info().signature;
        let commas = signature.matches(',').count();
        if signature.contains('…') { (commas, usize::MAX) } else { (commas + 1, commas + 1) }
    }

    /// The names of its arguments, if it is defined by a text.
    pub(crate) fn argument_names(self) -> impl Iterator<Item = String> {
        let inside = self.info().signature.split_once('(').map_or("", |(_, inside)| inside);
        inside.trim_end_matches(')').split(", ").map(str::to_owned)
    }

    /// Whether the function can have `count` arguments.
    pub(crate) fn takes(self, count: usize) -> bool {
        let (least, most) = self.arity();
        (least..=most).contains(&count)
    }
}
