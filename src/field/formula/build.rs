//! Translation of the syntax tree into the SSA graph.

use super::MAX_OPERATIONS;
use super::ast::{Equation, Expr, ExprKind, Factor, Function, Sign};
use super::error::{FormulaError, FormulaErrorKind as ErrorKind};
use super::graph::{Graph, Id, Node};
use super::operations::{Binary, Unary};

/// Adds f = left − right to `graph` and returns its node. `parameters` are the parameter names by index.
///
/// # Errors
///
/// [`ErrorKind::NotFinite`] for a constant subexpression without a finite value, [`ErrorKind::TooComplex`] if the graph
/// grows beyond [`MAX_OPERATIONS`] nodes.
pub(super) fn build(graph: &mut Graph, equation: &Equation, parameters: &[&str]) -> Result<Id, FormulaError> {
    let mut builder = Builder { graph, parameters };
    let left = builder.expression(&equation.left)?;
    let root = match &equation.right {
        None => left,
        Some(right) => {
            let right = builder.expression(right)?;
            builder.graph.sub(left, right)
        }
    };
    Ok(root)
}

struct Builder<'a> {
    graph: &'a mut Graph,
    parameters: &'a [&'a str],
}

impl Builder<'_> {
    fn expression(&mut self, expr: &Expr) -> Result<Id, FormulaError> {
        let id = match &expr.kind {
            ExprKind::Number(value) => self.graph.constant(*value),
            ExprKind::Constant(constant) => self.graph.constant(constant.value()),
            ExprKind::Coordinate(axis) => self.graph.intern(Node::Coordinate(*axis)),
            ExprKind::Parameter(name) => {
                let index = self.parameters.iter().position(|known| known == name);
                let index = index.expect("every name was resolved before the tree is built");
                self.graph.intern(Node::Parameter(u32::try_from(index).unwrap_or(u32::MAX)))
            }
            ExprKind::Negated(inner) => {
                let inner = self.expression(inner)?;
                self.graph.neg(inner)
            }
            ExprKind::Sum(terms) => self.sum(terms)?,
            ExprKind::Product(factors) => self.product(factors)?,
            ExprKind::Power(base, exponent) => {
                let base = self.expression(base)?;
                let exponent = self.expression(exponent)?;
                self.graph.pow(base, exponent)
            }
            ExprKind::Call(function, arguments) => self.call(*function, arguments)?,
        };
        if self.graph.as_constant(id).is_some_and(|value| !value.is_finite()) {
            return Err(not_finite(expr));
        }
        // Checked before differentiation, which multiplies the nodes: a hostile formula is refused cheaply.
        if self.graph.len() > MAX_OPERATIONS {
            return Err(too_complex(expr));
        }
        Ok(id)
    }

    fn sum(&mut self, terms: &[(Sign, Expr)]) -> Result<Id, FormulaError> {
        let mut total = None;
        for (sign, term) in terms {
            let term = self.expression(term)?;
            total = Some(match (total, sign) {
                (None, _) => term,
                (Some(total), Sign::Plus) => self.graph.add(total, term),
                (Some(total), Sign::Minus) => self.graph.sub(total, term),
            });
        }
        Ok(total.expect("a sum has terms"))
    }

    fn product(&mut self, factors: &[(Factor, Expr)]) -> Result<Id, FormulaError> {
        let mut total = None;
        for (relation, factor) in factors {
            let id = self.expression(factor)?;
            total = Some(match (total, relation) {
                (None, _) => id,
                (Some(total), Factor::Times) => self.graph.mul(total, id),
                (Some(total), Factor::Over) => {
                    if self.graph.as_constant(id) == Some(0.0) {
                        return Err(FormulaError::new(
                            ErrorKind::NotFinite,
                            factor.span.clone(),
                            "Division by zero has no finite value",
                        ));
                    }
                    self.graph.div(total, id)
                }
            });
        }
        Ok(total.expect("a product has factors"))
    }

    fn call(&mut self, function: Function, arguments: &[Expr]) -> Result<Id, FormulaError> {
        let mut ids = Vec::with_capacity(arguments.len());
        for argument in arguments {
            ids.push(self.expression(argument)?);
        }
        let graph = &mut *self.graph;
        Ok(match function {
            Function::Unary(operation) => graph.unary(operation, ids[0]),
            Function::Binary(operation) => fold(graph, operation, &ids),
            Function::Hypot => {
                let squares: Vec<Id> = ids.iter().map(|&id| graph.power(id, 2)).collect();
                let sum = fold(graph, Binary::Add, &squares);
                graph.unary(Unary::Sqrt, sum)
            }
            Function::Smin => graph.smin(ids[0], ids[1], ids[2]),
            // smax(a, b, k) = −smin(−a, −b, k).
            Function::Smax => {
                let (a, b) = (graph.neg(ids[0]), graph.neg(ids[1]));
                let smooth = graph.smin(a, b, ids[2]);
                graph.neg(smooth)
            }
        })
    }
}

/// Left fold ((a₀ ∘ a₁) ∘ a₂) ∘ …
fn fold(graph: &mut Graph, operation: Binary, ids: &[Id]) -> Id {
    ids[1..].iter().fold(ids[0], |total, &id| graph.binary(operation, total, id))
}

fn not_finite(expr: &Expr) -> FormulaError {
    let written = super::display::plain(expr);
    FormulaError::new(
        ErrorKind::NotFinite,
        expr.span.clone(),
        format!("`{written}` is constant and has no finite value"),
    )
}

pub(super) fn too_complex(expr: &Expr) -> FormulaError {
    FormulaError::new(
        ErrorKind::TooComplex,
        expr.span.clone(),
        format!("Too complex: a formula has at most {MAX_OPERATIONS} operations"),
    )
}
