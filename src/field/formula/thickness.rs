//! The thickness of a shell: a number, or an expression in the coordinates and the parameters of
//! the formula whose surface it thickens.

use super::ast::{Equation, Expr, ExprKind, Factor};
use super::error::FormulaError;
use super::expression::Noun;
use super::graph::{Graph, Id};
use super::{Parameter, build, display, number};
use core::fmt::{self, Display, Formatter};
use serde::de::{self, Deserializer, Visitor};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Thickness of the shell that is sampled instead of a surface, in the units of the coordinates: a
/// number or a text in JSON.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Thickness {
    /// A thickness that is the same everywhere.
    Number(f64),
    /// An expression in x, y, z and the parameters of the formula, such as `0.1 + 0.05 z`. There is
    /// no shell where it is negative or zero.
    Formula(String),
}

impl Default for Thickness {
    /// No shell.
    fn default() -> Self {
        Self::Number(0.0)
    }
}

impl From<f64> for Thickness {
    fn from(thickness: f64) -> Self {
        Self::Number(thickness)
    }
}

impl From<&str> for Thickness {
    /// A number if the text is one, else a formula, which
    /// [`Formula::thickened_by`](super::Formula::thickened_by) checks.
    fn from(text: &str) -> Self {
        number(text).map_or_else(|_| Self::Formula(text.to_owned()), Self::Number)
    }
}

impl Display for Thickness {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(thickness) => f.write_str(&crate::math::shortest_text(*thickness)),
            Self::Formula(text) => f.write_str(text),
        }
    }
}

impl Thickness {
    /// The thickness times a number, for a formula with these parameters.
    pub(super) fn scaled(&self, factor: f64, parameters: &[Parameter]) -> Result<Self, FormulaError> {
        Ok(match self {
            Self::Number(thickness) => Self::Number(factor * thickness),
            Self::Formula(text) => {
                let mut expression = expression(text, parameters)?;
                let number = Expr { kind: ExprKind::Number(factor), span: 0..0 };
                let factors = vec![(Factor::Times, number), (Factor::Times, expression.left)];
                expression.left = Expr { kind: ExprKind::Product(factors), span: 0..0 };
                Self::Formula(display::plain_equation(&expression))
            }
        })
    }
}

impl<'de> Deserialize<'de> for Thickness {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        // What serde derives for this takes several kilobytes of WebAssembly.
        struct NumberOrText;
        impl Visitor<'_> for NumberOrText {
            type Value = Thickness;

            fn expecting(&self, f: &mut Formatter<'_>) -> fmt::Result {
                f.write_str("a number or a formula")
            }

            fn visit_f64<E: de::Error>(self, value: f64) -> Result<Thickness, E> {
                Ok(Thickness::Number(value))
            }

            fn visit_i64<E: de::Error>(self, value: i64) -> Result<Thickness, E> {
                Ok(Thickness::Number(value as f64))
            }

            fn visit_u64<E: de::Error>(self, value: u64) -> Result<Thickness, E> {
                Ok(Thickness::Number(value as f64))
            }

            fn visit_str<E: de::Error>(self, text: &str) -> Result<Thickness, E> {
                Ok(Thickness::Formula(text.to_owned()))
            }
        }
        deserializer.deserialize_any(NumberOrText)
    }
}

/// The shell around the surface of a formula.
#[derive(Clone, Debug)]
pub(super) struct Shell {
    pub(super) thickness: Thickness,
    /// The graph of half of the thickness, and its node.
    half: Arc<(Graph, Id)>,
}

impl PartialEq for Shell {
    fn eq(&self, other: &Self) -> bool {
        self.thickness == other.thickness
    }
}

impl Shell {
    /// The shell of a thickness that is the same everywhere.
    pub(super) fn even(thickness: f64) -> Self {
        let mut graph = Graph::default();
        let half = graph.constant(0.5 * thickness);
        Self { thickness: thickness.into(), half: Arc::new((graph, half)) }
    }

    /// The shell of a thickness, around the surface of a formula with these parameters.
    pub(super) fn new(thickness: &Thickness, parameters: &[Parameter]) -> Result<Self, FormulaError> {
        let text = match thickness {
            Thickness::Number(thickness) => return Ok(Self::even(*thickness)),
            Thickness::Formula(text) => text,
        };
        let expression = expression(text, parameters)?;
        let names: Vec<&str> = parameters.iter().map(|parameter| &*parameter.name).collect();
        let mut graph = Graph::default();
        let whole = build::build(&mut graph, &expression, &names)?;
        let half = graph.constant(0.5);
        let half = graph.mul(whole, half);
        Ok(Self { thickness: thickness.clone(), half: Arc::new(graph.part(half)) })
    }

    /// The node of half of the thickness, in a graph to which it is added.
    pub(super) fn half(&self, graph: &mut Graph) -> Id {
        let (half, root) = &*self.half;
        graph.add_part(half, *root)
    }
}

/// A thickness in the words of errors.
const NOUN: Noun = Noun {
    name: "thickness",
    unknown: "The formula has no parameter",
    others: "the parameters of the formula",
    examples: ["0.2", "0.1 + 0.05 z", "if(z > 0, 0.2, 0.1)"],
};

/// The syntax tree of a thickness in which every name is a parameter.
fn expression(text: &str, parameters: &[Parameter]) -> Result<Equation, FormulaError> {
    super::expression::expression(text, parameters, &NOUN)
}
