//! A formula compiled for each way of evaluating it.

use super::ast::Equation;
use super::error::FormulaError;
use super::graph::{Graph, Id, Node};
use super::operations::{Binary, Unary};
use super::program::Program;
use super::{MAX_OPERATIONS, Parameter, build, derivative, interval, scalar};
use crate::field::Jet;
use crate::math::{Bounds, Interval, Sym3};
use glam::DVec3;
use std::sync::{Arc, OnceLock};

/// The graph of f and its derivatives, and the programs that were compiled from it.
///
/// The Hessian and the bounds are compiled when first asked for: uniform sampling needs no Hessian,
/// and a check of the text needs neither. Copies share what does not depend on the values of the
/// parameters.
#[derive(Clone, Debug)]
pub(super) struct Compiled {
    pub(super) graph: Arc<Graph>,
    /// Node of f.
    pub(super) root: Id,
    gradient: [Id; 3],
    /// Values of the parameters.
    values: Vec<f64>,
    /// Whether f is the same everywhere for any values of the parameters.
    pub(super) is_constant: bool,
    pub(super) value_program: Program,
    pub(super) gradient_program: Program,
    hessian_program: OnceLock<Program>,
    /// The nodes that f needs, and those that f and ∇f need, in the order of the graph.
    value_nodes: Arc<[Id]>,
    gradient_nodes: Arc<[Id]>,
    /// Programs for the factors of f.
    factors: OnceLock<Vec<interval::FactorProgram>>,
}

impl Compiled {
    /// Compiles f and ∇f of `equation`, with the values of `parameters`.
    ///
    /// # Errors
    ///
    /// The errors of [`build::build`], and [`TooComplex`](super::FormulaErrorKind::TooComplex)
    /// beyond [`MAX_OPERATIONS`].
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
        let value_program = Program::compile(&graph, &[root], values);
        graph.let_zero_annihilate();
        let gradient = derivative::gradient(&mut graph, root);
        let gradient_program =
            Program::compile(&graph, &[root, gradient[0], gradient[1], gradient[2]], values);
        // A step function has gradient 0 almost everywhere and is not constant.
        let has_steps = graph.nodes()[..=root as usize]
            .iter()
            .any(|node| matches!(node, Node::Unary(Unary::Floor | Unary::Sign, _) | Node::Select(..)));
        let has_zero_gradient = gradient.iter().all(|&id| graph.as_constant(id) == Some(0.0));
        Self {
            is_constant: graph.is_uniform(root) || (has_zero_gradient && !has_steps),
            value_nodes: graph.needed_by(&[root]).into(),
            gradient_nodes: graph.needed_by(&[root, gradient[0], gradient[1], gradient[2]]).into(),
            graph: Arc::new(graph),
            root,
            gradient,
            values: values.to_vec(),
            value_program,
            gradient_program,
            hessian_program: OnceLock::new(),
            factors: OnceLock::new(),
        }
    }

    /// Recomputes everything that depends on the parameters alone.
    pub(super) fn set_parameters(&mut self, values: &[f64]) {
        self.values.clear();
        self.values.extend_from_slice(values);
        self.value_program.set_parameters(values);
        self.gradient_program.set_parameters(values);
        if let Some(program) = self.hessian_program.get_mut() {
            program.set_parameters(values);
        }
        for factor in self.factors.get_mut().into_iter().flatten() {
            factor.set_parameters(values);
        }
    }

    /// The graph of f and its Hessian, and the nodes of f, ∇f and ∇∇f.
    fn with_hessian(&self) -> (Graph, Vec<Id>) {
        let mut graph = (*self.graph).clone();
        let hessian = derivative::hessian(&mut graph, self.gradient);
        let mut outputs = vec![self.root];
        outputs.extend(self.gradient);
        outputs.extend(hessian);
        (graph, outputs)
    }

    /// Program of f, ∇f and ∇∇f.
    pub(super) fn hessian_program(&self) -> &Program {
        self.hessian_program.get_or_init(|| {
            let (graph, outputs) = self.with_hessian();
            Program::compile(&graph, &outputs, &self.values)
        })
    }

    /// Programs for the bounds of the factors of f; there is at least one.
    pub(super) fn factors(&self) -> &[interval::FactorProgram] {
        self.factors.get_or_init(|| {
            let mut graph = (*self.graph).clone();
            let mut factors = interval::factors(&mut graph, self.root, self.gradient, self.root);
            factors.iter_mut().for_each(|factor| factor.set_parameters(&self.values));
            factors
        })
    }

    /// The program for the bounds of f itself, whatever its factors.
    pub(super) fn whole(&self) -> interval::FactorProgram {
        let mut graph = (*self.graph).clone();
        let mut whole = interval::FactorProgram::of(&mut graph, self.root, self.gradient, self.root);
        whole.set_parameters(&self.values);
        whole
    }

    /// f at `p` in double precision. `scratch` keeps the values of the nodes.
    pub(super) fn value(&self, p: DVec3, scratch: &mut Vec<f64>) -> f64 {
        self.graph.evaluate(&self.value_nodes, &self.values, p, scratch);
        scratch[self.root as usize]
    }

    /// f and ∇f at `p` in double precision, from the graphs of the derivatives.
    pub(super) fn gradient(&self, p: DVec3, scratch: &mut Vec<f64>) -> (f64, DVec3) {
        self.graph.evaluate(&self.gradient_nodes, &self.values, p, scratch);
        let gradient = self.gradient.map(|id| scratch[id as usize]);
        (scratch[self.root as usize], DVec3::from_array(gradient))
    }

    /// f, ∇f and ∇∇f at `p`, as jets carried forward through the graph of f.
    pub(super) fn jet(&self, p: DVec3, scratch: &mut scalar::JetScratch) -> Jet {
        scalar::jets(&self.graph, self.root, &self.values, [p], scratch);
        scratch[self.root as usize][0].second_order()
    }

    /// f and ∇f at each of these points, equal to those of [`Compiled::jet`].
    pub(super) fn first_order<const POINTS: usize>(
        &self,
        points: [DVec3; POINTS],
        scratch: &mut scalar::Jets<0, POINTS>,
    ) -> [(f64, DVec3); POINTS] {
        scalar::jets(&self.graph, self.root, &self.values, points, scratch);
        scratch[self.root as usize].map(|jet| jet.first_order())
    }

    /// f, ∇f and ∇∇f at `p`, from the graphs of the derivatives.
    pub(super) fn transformed_jet(&self, p: DVec3) -> Jet {
        let (graph, outputs) = self.with_hessian();
        let mut results: Vec<f64> = Vec::with_capacity(graph.len());
        for node in graph.nodes() {
            results.push(node.evaluate(&self.values, p.to_array(), |id| results[id as usize]));
        }
        let result = |n: usize| results[outputs[n] as usize];
        let [xx, xy, xz, yy, yz, zz] = [4, 5, 6, 7, 8, 9].map(result);
        Jet {
            value: result(0),
            gradient: DVec3::from_array([1, 2, 3].map(result)),
            hessian: Sym3 { xx, xy, xz, yy, yz, zz },
        }
    }

    /// Bounds on the differences that rounding makes between [`Compiled::jet`] and
    /// [`Compiled::transformed_jet`] at each of `points`: of the value, the gradient and the
    /// Hessian.
    ///
    /// Both ways of deriving f are bounded at the point in interval arithmetic, which rounds
    /// outward at every operation, and the widths add up. A difference that cancels is as wide as
    /// its terms.
    ///
    /// Within a node, jets form powers up to the third, which may leave the range of the numbers:
    /// where a result is beyond 10¹⁰⁰ or, other than 0, below 10⁻¹⁰⁰, any difference is possible.
    pub(super) fn rounding(&self, points: &[DVec3]) -> Vec<[f64; 10]> {
        let (mut graph, mut outputs) = self.with_hessian();
        graph.keep_sums();
        let forward = [0, 1, 2].map(|axis| derivative::forward(&mut graph, &[self.root], axis)[0]);
        let columns = [0, 1, 2].map(|axis| derivative::forward(&mut graph, &forward, axis));
        outputs.push(self.root);
        outputs.extend(forward);
        outputs.extend(scalar::PAIRS.map(|(i, j)| columns[j][i]));
        let nodes = graph.needed_by(&outputs);
        let mut rows = Vec::new();
        let widths = points.iter().map(|&p| {
            interval::bounds(&graph, &nodes, &self.values, &Bounds::point(p), &mut rows);
            let bounds = |id: Id| rows[id as usize].at(0).bounds;
            let is_held = |end: f64| end == 0.0 || (1e-100..=1e100).contains(&end.abs());
            // Such a power is 0 only by underflow.
            let underflows = |id: Id, end: f64| {
                let node = graph.node(id);
                let is_power = matches!(
                    node,
                    Node::Power(..) | Node::Binary(Binary::Pow, ..) | Node::Unary(Unary::Exp, _)
                );
                let mut holds_zero = false;
                node.operands(|operand| holds_zero |= bounds(operand).holds(0.0));
                end == 0.0 && is_power && (!holds_zero || matches!(node, Node::Unary(..)))
            };
            let is_extreme = |id: &Id| {
                let Interval { lo, hi } = bounds(*id);
                lo <= hi && [lo, hi].iter().any(|&end| !is_held(end) || underflows(*id, end))
            };
            let leaves_range = nodes.iter().any(is_extreme);
            let width = |n: usize| {
                let Interval { lo, hi } = bounds(outputs[n]);
                if lo <= hi && !leaves_range { hi - lo } else { f64::INFINITY }
            };
            core::array::from_fn(|n| width(n) + width(n + 10))
        });
        widths.collect()
    }
}
