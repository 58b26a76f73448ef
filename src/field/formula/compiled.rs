//! A formula compiled for each way of evaluating it.

use super::ast::Equation;
use super::error::FormulaError;
use super::graph::{Graph, Id, Node};
use super::operations::Unary;
use super::program::Program;
use super::{MAX_OPERATIONS, Parameter, build, derivative, interval, scalar};
use crate::field::Jet;
use crate::math::Sym3;
use glam::DVec3;

/// The graph of f and its derivatives, and the programs that were compiled from it.
///
/// The Hessian and the bounds are compiled when first asked for: uniform sampling needs no Hessian, and a check of the
/// text needs neither.
#[derive(Clone, Debug)]
pub(super) struct Compiled {
    pub(super) graph: Graph,
    /// Node of f.
    pub(super) root: Id,
    gradient: [Id; 3],
    /// Nodes of the Hessian (xx, xy, xz, yy, yz, zz), once it is compiled.
    hessian: [Id; 6],
    /// Whether f is the same everywhere for any values of the parameters.
    pub(super) is_constant: bool,
    pub(super) value_program: Program,
    pub(super) gradient_program: Program,
    hessian_program: Option<Program>,
    /// The nodes that f needs, and those that f and ∇f need, in the order of the graph.
    value_nodes: Vec<Id>,
    gradient_nodes: Vec<Id>,
    /// Programs for the factors of f; empty until they are compiled.
    factors: Vec<interval::FactorProgram>,
}

impl Compiled {
    /// Compiles f and ∇f of `equation`, with the values of `parameters`.
    ///
    /// # Errors
    ///
    /// The errors of [`build::build`], and [`TooComplex`](super::FormulaErrorKind::TooComplex) beyond [`MAX_OPERATIONS`].
    pub(super) fn new(equation: &Equation, parameters: &[Parameter]) -> Result<Self, FormulaError> {
        let names: Vec<&str> = parameters.iter().map(|parameter| &*parameter.name).collect();
        let mut graph = Graph::default();
        let root = build::build(&mut graph, equation, &names)?;
        let values: Vec<f64> = parameters.iter().map(|parameter| parameter.value).collect();
        let compiled = Self::from_graph(graph, root, &values);
        if compiled.value_program.operations() > MAX_OPERATIONS {
            return Err(build::too_complex(&equation.left));
        }
        Ok(compiled)
    }

    /// Compiles node `root` of `graph` and its gradient, with these values of the parameters.
    pub(super) fn from_graph(mut graph: Graph, root: Id, values: &[f64]) -> Self {
        let value_program = Program::compile(&graph, &[root]);
        graph.let_zero_annihilate();
        let gradient = derivative::gradient(&mut graph, root);
        let gradient_program = Program::compile(&graph, &[root, gradient[0], gradient[1], gradient[2]]);
        // A step function has gradient 0 almost everywhere and is not constant.
        let has_steps = graph.nodes()[..=root as usize]
            .iter()
            .any(|node| matches!(node, Node::Unary(Unary::Floor | Unary::Sign, _) | Node::Select(..)));
        let has_zero_gradient = gradient.iter().all(|&id| graph.as_constant(id) == Some(0.0));
        let mut compiled = Self {
            is_constant: graph.is_uniform(root) || (has_zero_gradient && !has_steps),
            value_nodes: graph.needed_by(&[root]),
            gradient_nodes: graph.needed_by(&[root, gradient[0], gradient[1], gradient[2]]),
            graph,
            root,
            gradient,
            hessian: [root; 6],
            value_program,
            gradient_program,
            hessian_program: None,
            factors: Vec::new(),
        };
        compiled.set_parameters(values);
        compiled
    }

    /// Recomputes everything that depends on the parameters alone.
    pub(super) fn set_parameters(&mut self, values: &[f64]) {
        self.value_program.set_parameters(values);
        self.gradient_program.set_parameters(values);
        if let Some(program) = &mut self.hessian_program {
            program.set_parameters(values);
        }
        for factor in &mut self.factors {
            factor.set_parameters(values);
        }
    }

    /// Program of f, ∇f and ∇∇f.
    pub(super) fn hessian_program(&mut self, values: &[f64]) -> &Program {
        self.hessian_program.get_or_insert_with(|| {
            self.hessian = derivative::hessian(&mut self.graph, self.gradient);
            let mut outputs = vec![self.root];
            outputs.extend(self.gradient);
            outputs.extend(self.hessian);
            let mut program = Program::compile(&self.graph, &outputs);
            program.set_parameters(values);
            program
        })
    }

    /// Programs for the bounds of the factors of f; there is at least one.
    pub(super) fn factors(&mut self, values: &[f64]) -> &mut [interval::FactorProgram] {
        if self.factors.is_empty() {
            self.factors = interval::factors(&mut self.graph, self.root, self.gradient);
            for factor in &mut self.factors {
                factor.set_parameters(values);
            }
        }
        &mut self.factors
    }

    /// f at `p` in double precision. `scratch` keeps the values of the nodes.
    pub(super) fn value(&self, values: &[f64], p: DVec3, scratch: &mut Vec<f64>) -> f64 {
        self.graph.evaluate(&self.value_nodes, values, p, scratch);
        scratch[self.root as usize]
    }

    /// f and ∇f at `p` in double precision, from the graphs of the derivatives.
    pub(super) fn gradient(&self, values: &[f64], p: DVec3, scratch: &mut Vec<f64>) -> (f64, DVec3) {
        self.graph.evaluate(&self.gradient_nodes, values, p, scratch);
        let gradient = self.gradient.map(|id| scratch[id as usize]);
        (scratch[self.root as usize], DVec3::from_array(gradient))
    }

    /// f, ∇f and ∇∇f at `p`, as jets carried forward through the graph of f.
    pub(super) fn jet(&self, values: &[f64], p: DVec3, scratch: &mut scalar::JetScratch) -> Jet {
        scalar::jets(&self.graph, self.root, values, p, scratch);
        scratch[self.root as usize].second_order()
    }

    /// f and ∇f at `p`, the same as those of [`Compiled::jet`].
    pub(super) fn first_order(
        &self,
        values: &[f64],
        p: DVec3,
        scratch: &mut Vec<scalar::ForwardJet<0>>,
    ) -> (f64, DVec3) {
        scalar::jets(&self.graph, self.root, values, p, scratch);
        scratch[self.root as usize].first_order()
    }

    /// f, ∇f and ∇∇f at `p`, from the graphs of the derivatives.
    pub(super) fn transformed_jet(&mut self, values: &[f64], p: DVec3) -> Jet {
        self.hessian_program(values);
        let mut results: Vec<f64> = Vec::with_capacity(self.graph.len());
        for node in self.graph.nodes() {
            results.push(node.evaluate(values, p.to_array(), |id| results[id as usize]));
        }
        let result = |id: Id| results[id as usize];
        let [xx, xy, xz, yy, yz, zz] = self.hessian.map(result);
        Jet {
            value: result(self.root),
            gradient: DVec3::from_array(self.gradient.map(result)),
            hessian: Sym3 { xx, xy, xz, yy, yz, zz },
        }
    }
}
