//! Reduction of an equation to one of the same surface without multiple factors.
//!
//! The gradient of a power u^n, or of a product with such a factor, vanishes on the surface u = 0.
//! There is no normal, and the residual |f|/|∇f| is no distance. The function u has the same zeros
//! and a gradient there. Roots and absolute values are replaced by their arguments too, since their
//! slope at 0 is infinite or jumps. The syntax tree is changed and not the graph, because the user
//! is shown the equation that is sampled.

use super::ast::{Definition, Equation, Expr, ExprKind, Factor, Function, Sign};
use super::build::build;
use super::graph::Graph;
use super::operations::Unary;

/// Equation of the same surface without powers of factors and without repeated factors, or `None`
/// if there are none.
///
/// An equation with two sides other than zero is not a product and is left alone.
pub(super) fn without_powers(equation: &Equation) -> Option<Equation> {
    let reducer = Reducer { definitions: &equation.definitions };
    let side = |side: &Expr| reducer.side(side);
    let simplified = match &equation.right {
        None => Equation { left: side(&equation.left), ..equation.clone() },
        Some(right) if reducer.is_zero(right) => Equation { left: side(&equation.left), ..equation.clone() },
        Some(right) if reducer.is_zero(&equation.left) => {
            Equation { right: Some(side(right)), ..equation.clone() }
        }
        Some(_) => return None,
    };
    (simplified != *equation).then_some(simplified)
}

/// The reduction of one side of an equation. A value that the formula defines is a factor like any
/// other, unless it is the whole side.
struct Reducer<'a> {
    definitions: &'a [Definition],
}

impl Reducer<'_> {
    fn is_zero(&self, side: &Expr) -> bool {
        self.constant(side) == Some(0.0)
    }

    /// The side without powers of factors; unchanged if it has none.
    fn side(&self, side: &Expr) -> Expr {
        let mut whole = side;
        // Each definition refers to earlier ones.
        while let ExprKind::Defined(name, arguments) = &whole.kind
            && arguments.is_empty()
        {
            whole = &self.definitions[name.index].body;
        }
        let reduced = self.reduced(whole, true);
        if reduced == *whole { side.clone() } else { reduced }
    }

    /// Expression without powers of factors. A root that is not defined everywhere is removed only
    /// if the expression is the `sole` varying factor: in a product, its domain decides which zeros
    /// of the other factors count.
    fn reduced(&self, expr: &Expr, sole: bool) -> Expr {
        if !varies(expr) {
            return expr.clone();
        }
        let with = |kind: ExprKind| Expr { kind, span: expr.span.clone() };
        match &expr.kind {
            ExprKind::Negated(inner) => with(ExprKind::Negated(Box::new(self.reduced(inner, sole)))),
            ExprKind::Power(base, exponent) => {
                let Some(n) = self.constant(exponent).filter(|&n| n > 0.0) else { return expr.clone() };
                let is_root = n.fract() != 0.0;
                if is_root && !sole {
                    return expr.clone();
                }
                let base = self.reduced(base, sole);
                let ExprKind::Product(factors) = base.kind else { return base };
                if is_root && factors.iter().any(|(relation, factor)| self.is_pole(*relation, factor)) {
                    return expr.clone();
                }
                // The order of a pole is kept, because it decides whether f changes its sign there.
                let factors = factors.into_iter().map(|(relation, factor)| match relation {
                    Factor::Times => (relation, factor),
                    Factor::Over => (relation, with(ExprKind::Power(Box::new(factor), exponent.clone()))),
                });
                with(ExprKind::Product(factors.collect()))
            }
            ExprKind::Call(Function::Unary(Unary::Sqrt), arguments) if sole => {
                self.reduced(&arguments[0], true)
            }
            ExprKind::Call(Function::Unary(Unary::Cbrt | Unary::Abs), arguments) => {
                self.reduced(&arguments[0], sole)
            }
            // Without poles only: where a pole meets a zero, the order of the zero matters.
            ExprKind::Product(factors)
                if !factors.iter().any(|(relation, factor)| self.is_pole(*relation, factor)) =>
            {
                let varying = factors.iter().filter(|(_, factor)| varies(factor)).count();
                self.product(factors, sole && varying == 1, with)
            }
            _ => expr.clone(),
        }
    }

    /// Whether the factor is a divisor that may vanish.
    fn is_pole(&self, relation: Factor, factor: &Expr) -> bool {
        relation == Factor::Over && varies(factor) && self.lower_bound(factor) != Some(LowerBound::Positive)
    }

    /// Lower bound of the expression, as far as its form shows one.
    fn lower_bound(&self, expr: &Expr) -> Option<LowerBound> {
        if let Some(value) = self.constant(expr) {
            return match value {
                value if value > 0.0 => Some(LowerBound::Positive),
                0.0 => Some(LowerBound::Zero),
                _ => None,
            };
        }
        let or_zero = |bound: Option<LowerBound>| Some(bound.unwrap_or(LowerBound::Zero));
        match &expr.kind {
            ExprKind::Sum(terms) => terms.iter().try_fold(LowerBound::Zero, |sum, (sign, term)| {
                match (sign, self.lower_bound(term)?) {
                    (Sign::Minus, _) => None,
                    (Sign::Plus, LowerBound::Positive) => Some(LowerBound::Positive),
                    (Sign::Plus, LowerBound::Zero) => Some(sum),
                }
            }),
            ExprKind::Power(base, exponent) => match self.constant(exponent) {
                Some(n) if n > 0.0 && n % 2.0 == 0.0 => or_zero(self.lower_bound(base)),
                _ => self.lower_bound(base),
            },
            ExprKind::Call(Function::Unary(Unary::Exp), _) => Some(LowerBound::Positive),
            ExprKind::Call(Function::Unary(Unary::Abs | Unary::Sqrt), arguments) => {
                or_zero(self.lower_bound(&arguments[0]))
            }
            _ => None,
        }
    }

    /// Product of the reduced `factors`, with a repeated varying factor kept once.
    fn product(&self, factors: &[(Factor, Expr)], sole: bool, with: impl Fn(ExprKind) -> Expr) -> Expr {
        let mut kept: Vec<(Factor, Expr)> = Vec::new();
        let mut add = |relation: Factor, factor: Expr| {
            let is_repeated =
                relation == Factor::Times && varies(&factor) && kept.contains(&(relation, factor.clone()));
            if !is_repeated {
                kept.push((relation, factor));
            }
        };
        for (relation, factor) in factors {
            match relation {
                Factor::Times => match self.reduced(factor, sole).kind {
                    ExprKind::Product(inner) => {
                        inner.into_iter().for_each(|(relation, factor)| add(relation, factor));
                    }
                    kind => add(Factor::Times, Expr { kind, span: factor.span.clone() }),
                },
                Factor::Over => add(Factor::Over, factor.clone()),
            }
        }
        match kept.len() {
            1 => kept.remove(0).1,
            _ => with(ExprKind::Product(kept)),
        }
    }

    /// Value of an expression without coordinates and parameters.
    fn constant(&self, expr: &Expr) -> Option<f64> {
        if !self.is_constant(expr) {
            return None;
        }
        let mut graph = Graph::default();
        let has_names = expr.any(&|kind| matches!(kind, ExprKind::Defined(..)));
        // Other definitions may hold parameters.
        let definitions = if has_names { self.constants() } else { Vec::new() };
        let equation = Equation { definitions, left: expr.clone(), right: None, region: Vec::new() };
        let root = build(&mut graph, &equation, &[]).ok()?;
        graph.as_constant(root)
    }

    /// The definitions, with 0 for those that are not constant.
    fn constants(&self) -> Vec<Definition> {
        let zero = |body: &Expr| Expr { kind: ExprKind::Number(0.0), span: body.span.clone() };
        let constant = |definition: &Definition| match self.is_constant(&definition.body) {
            true => definition.clone(),
            false => Definition { body: zero(&definition.body), ..definition.clone() },
        };
        self.definitions.iter().map(constant).collect()
    }

    /// Whether an expression has neither coordinates nor parameters. Calls of defined functions
    /// count as if they had.
    fn is_constant(&self, expr: &Expr) -> bool {
        !expr.any(&|kind| match kind {
            ExprKind::Coordinate(_) | ExprKind::Parameter(_) | ExprKind::Argument(_) => true,
            ExprKind::Defined(name, arguments) => {
                !arguments.is_empty() || !self.is_constant(&self.definitions[name.index].body)
            }
            _ => false,
        })
    }
}

/// Lower bound of an expression.
#[derive(Clone, Copy, PartialEq)]
enum LowerBound {
    /// The expression is at least 0.
    Zero,
    /// The expression is more than 0.
    Positive,
}

/// Whether the expression depends on a coordinate; defined names count as if they did.
fn varies(expr: &Expr) -> bool {
    expr.any(&|kind| matches!(kind, ExprKind::Coordinate(_) | ExprKind::Defined(..)))
}
