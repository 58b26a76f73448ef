//! Translation of the syntax tree into the SSA graph.

use super::MAX_OPERATIONS;
use super::ast::{Connective, Definition, Equation, Expr, ExprKind, Factor, Function, Sign};
use super::error::{FormulaError, FormulaErrorKind as ErrorKind};
use super::graph::{Graph, Id, Node};
use super::operations::{Binary, Unary};
use super::statements;
use super::token::Comparison;

/// Adds f = left − right to `graph`, or max(f, [limit](Unary::Limit)) if the equation has limits,
/// and returns its node. `parameters` are the parameter names by index.
///
/// # Errors
///
/// [`ErrorKind::NotFinite`] for a constant subexpression without a finite value,
/// [`ErrorKind::TooComplex`] if the graph grows beyond [`MAX_OPERATIONS`] nodes.
pub(super) fn build(graph: &mut Graph, equation: &Equation, parameters: &[&str]) -> Result<Id, FormulaError> {
    let definitions = &equation.definitions;
    let mut builder =
        Builder { graph, parameters, definitions, values: Vec::new(), arguments: Vec::new(), expressions: 0 };
    for definition in definitions {
        // A function is translated at each of its calls.
        let value = if definition.arguments.is_empty() { builder.expression(&definition.body)? } else { 0 };
        builder.values.push(value);
    }
    let left = builder.expression(&equation.left)?;
    let root = match &equation.right {
        None => left,
        Some(right) => {
            let right = builder.expression(right)?;
            builder.graph.sub(left, right)
        }
    };
    let Some(limit) = builder.limit(&equation.region)? else { return Ok(root) };
    let limit = builder.graph.unary(Unary::Limit, limit);
    Ok(builder.graph.binary(Binary::Max, root, limit))
}

/// Maximum number of expressions to translate. Each call translates a defined function again;
/// without such calls there are no more expressions than bytes.
const MAX_EXPRESSIONS: usize = 16 * MAX_OPERATIONS;

struct Builder<'a> {
    graph: &'a mut Graph,
    parameters: &'a [&'a str],
    definitions: &'a [Definition],
    /// The node of each definition so far, if it is a value.
    values: Vec<Id>,
    /// The nodes of the arguments of the function whose body is being translated.
    arguments: Vec<Id>,
    /// Number of expressions that were translated so far.
    expressions: usize,
}

impl Builder<'_> {
    fn expression(&mut self, expr: &Expr) -> Result<Id, FormulaError> {
        self.expressions += 1;
        let id = match &expr.kind {
            ExprKind::Number(value) => self.graph.constant(*value),
            ExprKind::Constant(constant) => self.graph.constant(constant.value()),
            ExprKind::Coordinate(axis) => self.graph.intern(Node::Coordinate(*axis)),
            ExprKind::Parameter(name) => {
                let index = self.parameters.iter().position(|known| known == name);
                let index = index.expect("every name was resolved before the tree is built");
                self.graph.intern(Node::Parameter(u32::try_from(index).unwrap_or(u32::MAX)))
            }
            ExprKind::Argument(argument) => self.arguments[argument.index],
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
            ExprKind::Call(function, arguments) => self.call(expr, *function, arguments)?,
            ExprKind::Defined(name, arguments) if arguments.is_empty() => self.values[name.index],
            ExprKind::Defined(name, arguments) => {
                let arguments = self.all(arguments)?;
                let definitions = self.definitions;
                self.applied(expr, &definitions[name.index].body, arguments)?
            }
            ExprKind::Choice(parts) => {
                let [condition, first, second] = &**parts;
                let (first, second) = (self.expression(first)?, self.expression(second)?);
                self.choice(condition, first, second)?
            }
            ExprKind::Compare(..) | ExprKind::Logic(..) | ExprKind::Not(_) => {
                unreachable!("the parser lets conditions stand in choices alone")
            }
        };
        if self.graph.as_constant(id).is_some_and(|value| !value.is_finite()) {
            return Err(not_finite(expr));
        }
        // Checked before differentiation, which multiplies the nodes: a hostile formula is refused
        // cheaply.
        if self.graph.len() > MAX_OPERATIONS || self.expressions > MAX_EXPRESSIONS {
            return Err(too_complex(expr));
        }
        Ok(id)
    }

    /// The node of a function that is at most 0 where all of these conditions hold; none without
    /// conditions.
    fn limit(&mut self, conditions: &[Expr]) -> Result<Option<Id>, FormulaError> {
        let limits: Result<Vec<Id>, FormulaError> =
            conditions.iter().map(|condition| self.excess(condition)).collect();
        let limits = limits?;
        Ok((!limits.is_empty()).then(|| fold(self.graph, Binary::Max, &limits)))
    }

    /// The node of a function that is at most 0 where a condition holds, or at its end.
    fn excess(&mut self, condition: &Expr) -> Result<Id, FormulaError> {
        Ok(match &condition.kind {
            ExprKind::Compare(comparison, sides) => {
                let (a, b) = (self.expression(&sides[0])?, self.expression(&sides[1])?);
                match comparison {
                    Comparison::Less | Comparison::AtMost => self.graph.sub(a, b),
                    Comparison::Greater | Comparison::AtLeast => self.graph.sub(b, a),
                }
            }
            ExprKind::Logic(connective, conditions) => {
                let parts: Result<Vec<Id>, FormulaError> =
                    conditions.iter().map(|condition| self.excess(condition)).collect();
                let operation = match connective {
                    Connective::And => Binary::Max,
                    Connective::Or => Binary::Min,
                };
                fold(self.graph, operation, &parts?)
            }
            ExprKind::Not(inner) => {
                let inner = self.excess(inner)?;
                self.graph.neg(inner)
            }
            _ => unreachable!("the parser has checked conditions"),
        })
    }

    fn all(&mut self, arguments: &[Expr]) -> Result<Vec<Id>, FormulaError> {
        arguments.iter().map(|argument| self.expression(argument)).collect()
    }

    /// The node of a function's `body` with these arguments. Errors in it point at the `call`.
    fn applied(&mut self, call: &Expr, body: &Expr, arguments: Vec<Id>) -> Result<Id, FormulaError> {
        let outside = core::mem::replace(&mut self.arguments, arguments);
        let result = self.expression(body);
        self.arguments = outside;
        result.map_err(|error| match error.kind {
            ErrorKind::NotFinite => not_finite(call),
            _ => FormulaError { span: call.span.clone(), ..error },
        })
    }

    /// The node of `first` where the condition holds, and of `second` elsewhere.
    fn choice(&mut self, condition: &Expr, first: Id, second: Id) -> Result<Id, FormulaError> {
        match &condition.kind {
            ExprKind::Compare(comparison, sides) => {
                let (a, b) = (self.expression(&sides[0])?, self.expression(&sides[1])?);
                Ok(match comparison {
                    Comparison::AtMost => self.graph.select(a, b, first, second),
                    Comparison::AtLeast => self.graph.select(b, a, first, second),
                    Comparison::Less => self.graph.select(b, a, second, first),
                    Comparison::Greater => self.graph.select(a, b, second, first),
                })
            }
            ExprKind::Logic(connective, conditions) => {
                let (mut first, mut second) = (first, second);
                for condition in conditions.iter().rev() {
                    match connective {
                        Connective::And => first = self.choice(condition, first, second)?,
                        Connective::Or => second = self.choice(condition, first, second)?,
                    }
                }
                Ok(if *connective == Connective::And { first } else { second })
            }
            ExprKind::Not(inner) => self.choice(inner, second, first),
            _ => unreachable!("the parser has checked conditions"),
        }
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

    fn call(&mut self, call: &Expr, function: Function, arguments: &[Expr]) -> Result<Id, FormulaError> {
        let ids = self.all(arguments)?;
        if let Function::Defined(text) = function {
            let body = statements::body(text, function.argument_names()).expect("the language defines it");
            return self.applied(call, &body, ids);
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
            Function::Smin(blend) => graph.smin(blend, ids[0], ids[1], ids[2]),
            // smax(a, b, k) = −smin(−a, −b, k).
            Function::Smax(blend) => {
                let (a, b) = (graph.neg(ids[0]), graph.neg(ids[1]));
                let smooth = graph.smin(blend, a, b, ids[2]);
                graph.neg(smooth)
            }
            Function::If | Function::Defined(_) => unreachable!("a choice has a node of its own"),
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
