//! Formulas built by a program instead of read from text.

use super::ast::{self, Equation, ExprKind, Factor, Function, Sign};
use super::operations::{Binary, Unary};
use super::{Formula, MAX_DEPTH, MAX_OPERATIONS, display};
use core::ops::{Add, Div, Mul, Neg, Sub};

/// An expression in x, y and z, which becomes a [`Formula`]. As for a formula read from text, its
/// derivatives and bounds are exact, and its edges are found.
///
/// Operators take expressions, references to them and numbers. The common functions are methods;
/// [`Expr::call`] calls any function of the language.
///
/// ```
/// use marching_particles::field::formula::Expr;
/// use marching_particles::{Formula, Settings, sample};
///
/// let [x, y, z] = Expr::axes();
/// let tower = (x.powi(4) + y.powi(4)).sqrt() - 1.0;
/// let cut = Formula::from(tower.max(z.abs() - Expr::parameter("h"))).with("h", 1.5)?;
/// assert_eq!(cut.text(), "max(sqrt(x^4 + y^4) - 1, abs(z) - h)");
/// assert!(sample(cut, &Settings::with_count(1_000))?.mesh().topology.is_closed());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Expr {
    tree: ast::Expr,
    /// Height of the tree.
    depth: usize,
}

impl Expr {
    fn of(kind: ExprKind, parts: &[usize]) -> Self {
        let depth = parts.iter().max().map_or(0, |deepest| deepest + 1);
        Self { tree: ast::Expr { kind, span: 0..0 }, depth }
    }

    /// The coordinates x, y and z.
    #[must_use]
    pub fn axes() -> [Self; 3] {
        [0, 1, 2].map(|axis| Self::of(ExprKind::Coordinate(axis), &[]))
    }

    /// A named number, which has the value 1 until [`Formula::with`] gives it another.
    ///
    /// # Panics
    ///
    /// If the formula language gives the name another meaning, or it is not a name: a letter, then
    /// letters and digits.
    #[must_use]
    pub fn parameter(name: &str) -> Self {
        let is_name = super::lex::is_name(name) && !super::spelling::is_known(name);
        assert!(
            is_name && !matches!(name, "and" | "or" | "not"),
            "`{name}` cannot be the name of a parameter"
        );
        Self::of(ExprKind::Parameter(name.to_owned()), &[])
    }

    /// Calls a function of the formula language by its name: see [`FUNCTIONS`](super::FUNCTIONS).
    ///
    /// # Panics
    ///
    /// If there is no such function, or it takes another number of arguments.
    #[must_use]
    pub fn call(name: &str, arguments: impl IntoIterator<Item = Self>) -> Self {
        let function = Function::find(name).filter(|function| *function != Function::If);
        let function = function.unwrap_or_else(|| panic!("there is no function `{name}` of expressions"));
        Self::of_function(function, arguments.into_iter().collect())
    }

    fn of_function(function: Function, arguments: Vec<Self>) -> Self {
        let info = function.info();
        assert!(function.takes(arguments.len()), "{} takes {} arguments", info.signature, arguments.len());
        let depths: Vec<usize> = arguments.iter().map(|argument| argument.depth).collect();
        let trees = arguments.into_iter().map(|argument| argument.tree).collect();
        Self::of(ExprKind::Call(function, trees), &depths)
    }

    fn unary(&self, operation: Unary) -> Self {
        Self::of_function(Function::Unary(operation), vec![self.clone()])
    }

    fn binary(&self, operation: Binary, other: impl Into<Self>) -> Self {
        Self::of_function(Function::Binary(operation), vec![self.clone(), other.into()])
    }

    /// The expression to a power.
    #[must_use]
    pub fn pow(&self, exponent: impl Into<Self>) -> Self {
        let exponent = exponent.into();
        let depths = [self.depth, exponent.depth];
        Self::of(ExprKind::Power(Box::new(self.tree.clone()), Box::new(exponent.tree)), &depths)
    }

    /// The expression to a whole power.
    #[must_use]
    pub fn powi(&self, exponent: i32) -> Self {
        self.pow(f64::from(exponent))
    }

    /// Square root; undefined for negative values.
    #[must_use]
    pub fn sqrt(&self) -> Self {
        self.unary(Unary::Sqrt)
    }

    /// Absolute value.
    #[must_use]
    pub fn abs(&self) -> Self {
        self.unary(Unary::Abs)
    }

    /// Sine, of an angle in radians.
    #[must_use]
    pub fn sin(&self) -> Self {
        self.unary(Unary::Sin)
    }

    /// Cosine, of an angle in radians.
    #[must_use]
    pub fn cos(&self) -> Self {
        self.unary(Unary::Cos)
    }

    /// e to the power of the expression.
    #[must_use]
    pub fn exp(&self) -> Self {
        self.unary(Unary::Exp)
    }

    /// Natural logarithm; undefined for negative values.
    #[must_use]
    pub fn ln(&self) -> Self {
        self.unary(Unary::Ln)
    }

    /// The smaller of two values: the union of two solids, with a crease where they meet.
    #[must_use]
    pub fn min(&self, other: impl Into<Self>) -> Self {
        self.binary(Binary::Min, other)
    }

    /// The larger of two values: the intersection of two solids, with a crease where they meet.
    #[must_use]
    pub fn max(&self, other: impl Into<Self>) -> Self {
        self.binary(Binary::Max, other)
    }

    /// Length of the vector (self, other) in the plane.
    #[must_use]
    pub fn hypot(&self, other: impl Into<Self>) -> Self {
        Self::of_function(Function::Hypot, vec![self.clone(), other.into()])
    }

    fn sum(self, sign: Sign, other: Self) -> Self {
        let depths = [self.depth, other.depth];
        let term = (sign, other.tree);
        match self.tree.kind {
            // A sum of many terms is flat.
            ExprKind::Sum(mut terms) => {
                terms.push(term);
                Self::of(ExprKind::Sum(terms), &[depths[0].saturating_sub(1), depths[1]])
            }
            kind => {
                let first = (Sign::Plus, ast::Expr { kind, span: 0..0 });
                Self::of(ExprKind::Sum(vec![first, term]), &depths)
            }
        }
    }

    fn product(self, factor: Factor, other: Self) -> Self {
        let depths = [self.depth, other.depth];
        let next = (factor, other.tree);
        match self.tree.kind {
            ExprKind::Product(mut factors) => {
                factors.push(next);
                Self::of(ExprKind::Product(factors), &[depths[0].saturating_sub(1), depths[1]])
            }
            kind => {
                let first = (Factor::Times, ast::Expr { kind, span: 0..0 });
                Self::of(ExprKind::Product(vec![first, next]), &depths)
            }
        }
    }
}

impl From<f64> for Expr {
    /// # Panics
    ///
    /// If the number is not finite.
    fn from(number: f64) -> Self {
        assert!(number.is_finite(), "{number} in an expression");
        let size = Self::of(ExprKind::Number(number.abs()), &[]);
        if number.is_sign_negative() { -size } else { size }
    }
}

impl From<&Self> for Expr {
    fn from(other: &Self) -> Self {
        other.clone()
    }
}

impl Neg for Expr {
    type Output = Self;

    fn neg(self) -> Self {
        Self::of(ExprKind::Negated(Box::new(self.tree)), &[self.depth])
    }
}

impl Neg for &Expr {
    type Output = Expr;

    fn neg(self) -> Expr {
        -self.clone()
    }
}

macro_rules! operators {
    ($($name:ident $method:ident $call:ident $how:expr;)*) => {$(
        impl<T: Into<Expr>> $name<T> for Expr {
            type Output = Self;

            fn $method(self, other: T) -> Self {
                self.$call($how, other.into())
            }
        }

        impl<T: Into<Expr>> $name<T> for &Expr {
            type Output = Expr;

            fn $method(self, other: T) -> Expr {
                self.clone().$call($how, other.into())
            }
        }

        impl $name<Expr> for f64 {
            type Output = Expr;

            fn $method(self, other: Expr) -> Expr {
                Expr::from(self).$call($how, other)
            }
        }

        impl $name<&Expr> for f64 {
            type Output = Expr;

            fn $method(self, other: &Expr) -> Expr {
                Expr::from(self).$call($how, other.clone())
            }
        }
    )*};
}

operators! {
    Add add sum Sign::Plus;
    Sub sub sum Sign::Minus;
    Mul mul product Factor::Times;
    Div div product Factor::Over;
}

impl From<Expr> for Formula {
    /// The field of an expression, as [`Formula::parse`] makes it of a text.
    ///
    /// # Panics
    ///
    /// If the expression is nested deeper than [`MAX_DEPTH`], or has more operations than
    /// [`MAX_OPERATIONS`].
    fn from(Expr { tree, depth }: Expr) -> Self {
        assert!(depth <= MAX_DEPTH, "an expression is nested {depth} deep, and {MAX_DEPTH} are possible");
        let equation = Equation { definitions: Vec::new(), left: tree, right: None, region: Vec::new() };
        let text = display::plain_equation(&equation);
        let mut names: Vec<String> = Vec::new();
        collect_names(&equation.left, &mut names);
        let formula = Self::of_equation(&text, equation, names)
            .unwrap_or_else(|error| panic!("{}: at most {MAX_OPERATIONS} operations", error.message));
        formula.for_sampling()
    }
}

/// The names of the parameters in an expression, in their order.
fn collect_names(tree: &ast::Expr, names: &mut Vec<String>) {
    if let ExprKind::Parameter(name) = &tree.kind
        && !names.contains(name)
    {
        names.push(name.clone());
    }
    tree.each(&mut |part| collect_names(part, names));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Field;
    use glam::DVec3;

    #[test]
    fn an_expression_is_the_formula_of_its_text() {
        let [x, y, z] = Expr::axes();
        let a = Expr::parameter("a");
        let r = x.hypot(&y);
        let two_minus = 2.0 - &x * 3.0;
        for (expression, text) in [
            (&x * &x + &y * 2.0 - z.powi(2) / &a, "x*x + y*2 - z^2/a"),
            ((&r - 1.0).powi(2) + z.powi(2) - 0.1, "(hypot(x, y) - 1)^2 + z^2 - 0.1"),
            (-(x.sin() * y.cos()) + z.exp().ln(), "-(sin(x)*cos(y)) + ln(exp(z))"),
            (two_minus.max(-(&z - -1.5)).min(y.abs()), "min(max(2 - x*3, -(z - (-1.5))), abs(y))"),
            (
                Expr::call("smin", [x.clone(), y.clone(), Expr::from(0.25)]) / (1.0 + &z),
                "smin(x, y, 0.25)/(1 + z)",
            ),
            (x.pow(a.clone() + 1.0) - (&y - (&z - &x)), "x^(a + 1) - (y - (z - x))"),
        ] {
            let built = Formula::from(expression);
            let read = Formula::parse(text).expect("a formula");
            for p in [DVec3::new(0.3, 0.7, 0.2), DVec3::new(1.3, -0.4, 0.9)] {
                let [own, other] = [&built, &read].map(|field| format!("{:?}", field.jet(p)));
                assert_eq!(own, other, "{text}");
            }
            assert_eq!(built.parameters(), read.parameters());
            assert!(Formula::parse(built.text()).expect("its text").same_tree(&built), "{}", built.text());
        }
    }

    #[test]
    fn a_sum_of_many_terms_is_flat_and_deep_nesting_a_mistake() {
        let [x, ..] = Expr::axes();
        let sum = (0..500).fold(x.clone(), |sum, k| sum + x.powi(2) * f64::from(k));
        assert_eq!(Formula::from(sum).jet(DVec3::X).value, 124_751.0);
        let nested = (0..=MAX_DEPTH).fold(x, |nested, _| nested.sin());
        assert!(std::panic::catch_unwind(|| Formula::from(nested)).is_err());
        assert!(std::panic::catch_unwind(|| Expr::parameter("sin")).is_err());
    }
}
