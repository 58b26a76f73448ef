//! Syntax tree of a formula.
//!
//! Sums and products are flat lists. The depth of a tree is therefore bounded by [`MAX_DEPTH`](super::MAX_DEPTH), which
//! the parser enforces, and recursive walks cannot overflow the stack.

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

macro_rules! functions {
    ($($variant:ident $name:literal $signature:literal $least:literal..=$most:literal $help:literal),* $(,)?) => {
        /// A function of the language.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(crate) enum Function { $($variant),* }

        impl Function {
            pub(crate) const ALL: &[Self] = &[$(Self::$variant),*];

            pub(crate) const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name),* }
            }

            /// Minimum and maximum number of arguments.
            pub(crate) const fn arity(self) -> (usize, usize) {
                match self { $(Self::$variant => ($least, $most)),* }
            }

            /// Whether it can have so many arguments.
            pub(crate) fn takes(self, count: usize) -> bool {
                let (least, most) = self.arity();
                (least..=most).contains(&count)
            }

            pub(crate) const fn signature(self) -> &'static str {
                match self { $(Self::$variant => $signature),* }
            }
        }

        /// Every function of the language, in the order of the help page.
        pub const FUNCTIONS: &[FunctionInfo] =
            &[$(FunctionInfo { name: $name, signature: $signature, help: $help }),*];
    };
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
}

functions! {
    Sqrt "sqrt" "sqrt(a)" 1..=1 "Square root; undefined for a < 0.",
    Cbrt "cbrt" "cbrt(a)" 1..=1 "Cube root, of negative numbers too.",
    Abs "abs" "abs(a)" 1..=1 "Absolute value; its slope at 0 counts as 0.",
    Sign "sign" "sign(a)" 1..=1 "−1, 0 or 1; its slope counts as 0.",
    Min "min" "min(a, b, …)" 2..=16 "The least of two or more values; at a tie the slope is the first one's.",
    Max "max" "max(a, b, …)" 2..=16 "The greatest of two or more values; at a tie the slope is the first one's.",
    Floor "floor" "floor(a)" 1..=1 "The greatest whole number not above a; its slope counts as 0.",
    Exp "exp" "exp(a)" 1..=1 "e to the power a.",
    Ln "ln" "ln(a)" 1..=1 "Natural logarithm; undefined for a < 0.",
    Log10 "log10" "log10(a)" 1..=1 "Logarithm to base 10; undefined for a < 0.",
    Sin "sin" "sin(a)" 1..=1 "Sine, a in radians.",
    Cos "cos" "cos(a)" 1..=1 "Cosine, a in radians.",
    Tan "tan" "tan(a)" 1..=1 "Tangent, a in radians.",
    Asin "asin" "asin(a)" 1..=1 "Inverse sine in radians; undefined outside −1 … 1.",
    Acos "acos" "acos(a)" 1..=1 "Inverse cosine in radians; undefined outside −1 … 1.",
    Atan "atan" "atan(a)" 1..=1 "Inverse tangent in radians.",
    Atan2 "atan2" "atan2(a, b)" 2..=2 "The angle of the point (b, a), from −pi to pi.",
    Sinh "sinh" "sinh(a)" 1..=1 "Hyperbolic sine.",
    Cosh "cosh" "cosh(a)" 1..=1 "Hyperbolic cosine.",
    Tanh "tanh" "tanh(a)" 1..=1 "Hyperbolic tangent.",
    Hypot "hypot" "hypot(a, b, …)" 2..=16 "Length of the vector (a, b, …): sqrt(a^2 + b^2 + …).",
    Smin "smin" "smin(a, b, k)" 3..=3 "Smooth minimum: the union of two solids, blended where |a − b| < k.",
    Smax "smax" "smax(a, b, k)" 3..=3 "Smooth maximum: the intersection of two solids, blended where |a − b| < k.",
}

impl Function {
    pub(crate) fn find(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|function| function.name() == name)
    }
}
