//! Syntax tree of a formula.
//!
//! Sums and products are flat lists. The depth of a tree is therefore bounded by [`MAX_DEPTH`](super::MAX_DEPTH), which
//! the parser enforces, and recursive walks cannot overflow the stack.

use super::operations::{Binary, Unary};
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

/// The formula `left`, or the equation `left = right`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Equation {
    pub(crate) left: Expr,
    pub(crate) right: Option<Expr>,
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
    Smin,
    Smax,
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

/// Entry of a function, whose name is what stands before the bracket of its signature.
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
    Unary(Unary::Floor) "floor(a)" "The greatest whole number not above a; its slope counts as 0.",
    Unary(Unary::Exp) "exp(a)" "e to the power a.",
    Unary(Unary::Ln) "ln(a)" "Natural logarithm; undefined for a < 0.",
    Unary(Unary::Log10) "log10(a)" "Logarithm to base 10; undefined for a < 0.",
    Unary(Unary::Sin) "sin(a)" "Sine, a in radians.",
    Unary(Unary::Cos) "cos(a)" "Cosine, a in radians.",
    Unary(Unary::Tan) "tan(a)" "Tangent, a in radians.",
    Unary(Unary::Asin) "asin(a)" "Inverse sine in radians; undefined outside −1 … 1.",
    Unary(Unary::Acos) "acos(a)" "Inverse cosine in radians; undefined outside −1 … 1.",
    Unary(Unary::Atan) "atan(a)" "Inverse tangent in radians.",
    Binary(Binary::Atan2) "atan2(a, b)" "The angle of the point (b, a), from −pi to pi.",
    Unary(Unary::Sinh) "sinh(a)" "Hyperbolic sine.",
    Unary(Unary::Cosh) "cosh(a)" "Hyperbolic cosine.",
    Unary(Unary::Tanh) "tanh(a)" "Hyperbolic tangent.",
    Hypot "hypot(a, b, …)" "Length of the vector (a, b, …): sqrt(a^2 + b^2 + …).",
    Smin "smin(a, b, k)" "Smooth minimum: the union of two solids, blended where |a − b| < k.",
    Smax "smax(a, b, k)" "Smooth maximum: the intersection of two solids, blended where |a − b| < k.",
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

    /// Minimum and maximum number of arguments, as the signature shows them; a function with `…` takes any number from the minimum on.
    pub(crate) fn arity(self) -> (usize, usize) {
        let signature = self.info().signature;
        let commas = signature.matches(',').count();
        if signature.contains('…') { (commas, usize::MAX) } else { (commas + 1, commas + 1) }
    }

    /// Whether the function can have `count` arguments.
    pub(crate) fn takes(self, count: usize) -> bool {
        let (least, most) = self.arity();
        (least..=most).contains(&count)
    }
}
