//! Formulas in which another field is an operand, by the name [`MODEL`]: `max(model, z)`.

use super::Formula;
use super::branches::{Branches, SharedBranches};
use super::compiled::Compiled;
use super::error::{FormulaError, FormulaErrorKind};
use super::graph::{Blend, Graph, Id, Node};
use super::operations::{Binary, Unary};
use super::solids::Solid;
use crate::field::Field;
use crate::field::combined::{Combined, blended, greatest, least, turned};
use glam::DVec3;
use std::sync::Arc;

/// The name by which a formula uses the model.
pub const MODEL: &str = "model";

impl Formula {
    /// The field of this formula with another field for the parameter [`MODEL`]. The formula may
    /// use it as an operand of minima and maxima, also smooth ones, and of absolute values, negate
    /// it, and add a number to it. Edges in the rest of the formula are found as usual.
    ///
    /// # Errors
    ///
    /// [`FormulaErrorKind::ModelUse`] if the formula uses the name in another way, or nowhere.
    #[doc(hidden)]
    pub fn with_model(&self, model: &Arc<dyn Field>) -> Result<Combined, FormulaError> {
        let (graph, root) = &*self.surface;
        let number = self.parameters.iter().position(|parameter| parameter.name == MODEL);
        let mut uses = vec![false; graph.len()];
        for (id, &node) in graph.nodes().iter().enumerate() {
            let mut is_used = matches!(node, Node::Parameter(k) if Some(k as usize) == number);
            node.operands(|operand| is_used |= uses[operand as usize]);
            uses[id] = is_used;
        }
        let is_used = uses[*root as usize];
        let operands = Operands { formula: self, graph, uses, model };
        let field = if is_used { operands.field(*root) } else { None };
        field.map(Combined::new).ok_or_else(|| {
            let text = self.text();
            let at = text.find(MODEL).map_or(0..text.len(), |at| at..at + MODEL.len());
            let message = "A formula takes the model as an operand of max, min, smin, smax or abs, \
                           with or without a minus or a number that is added: `max(model, z)`, \
                           `abs(model) - 0.1`";
            FormulaError::new(FormulaErrorKind::ModelUse, at, message)
        })
    }

    /// The field of a node of this formula.
    fn part(&self, graph: &Graph, root: Id) -> Self {
        let surface = graph.part(root);
        let compiled = Compiled::from_graph(surface.0.clone(), surface.1, &self.values);
        Self {
            simplified: None,
            surface: Arc::new(surface),
            solid: Solid::default(),
            branches: SharedBranches::new(Branches::new(&compiled, &self.values)),
            compiled,
            ..self.clone()
        }
    }
}

/// A formula that has the model as an operand.
struct Operands<'a> {
    formula: &'a Formula,
    graph: &'a Graph,
    /// Whether each node depends on the model.
    uses: Vec<bool>,
    model: &'a Arc<dyn Field>,
}

impl Operands<'_> {
    /// The field of a node; none if the node uses the model in an unsupported way.
    fn field(&self, id: Id) -> Option<Arc<dyn Field>> {
        if !self.uses[id as usize] {
            return Some(Arc::new(self.formula.part(self.graph, id)));
        }
        Some(match self.graph.node(id) {
            Node::Parameter(_) => Arc::clone(self.model),
            Node::Unary(Unary::Neg, u) => turned(&self.field(u)?, true, 0.0),
            Node::Unary(Unary::Abs, u) => {
                let u = self.field(u)?;
                let opposite = turned(&u, true, 0.0);
                greatest(u, opposite)
            }
            Node::Binary(Binary::Min, a, b) => least(self.field(a)?, self.field(b)?),
            Node::Binary(Binary::Max, a, b) => greatest(self.field(a)?, self.field(b)?),
            Node::Smin(Blend::Cubic, a, b, k) => blended(self.field(a)?, self.field(b)?, self.number(k)?),
            Node::Binary(Binary::Add, a, b) if self.uses[a as usize] => {
                turned(&self.field(a)?, false, -self.number(b)?)
            }
            Node::Binary(Binary::Add, a, b) => turned(&self.field(b)?, false, -self.number(a)?),
            Node::Binary(Binary::Sub, a, b) if self.uses[a as usize] => {
                turned(&self.field(a)?, false, self.number(b)?)
            }
            Node::Binary(Binary::Sub, a, b) => turned(&self.field(b)?, true, -self.number(a)?),
            _ => return None,
        })
    }

    /// The value of a node that is the same everywhere.
    fn number(&self, id: Id) -> Option<f64> {
        let is_number = self.graph.is_uniform(id) && !self.uses[id as usize];
        is_number.then(|| self.formula.part(self.graph, id).value(DVec3::ZERO))
    }
}
