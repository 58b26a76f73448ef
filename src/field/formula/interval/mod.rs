//! Interval arithmetic over the graph: bounds of f and ∇f over boxes, a few boxes at a time.
//!
//! The bounds hold at every point of a box. Every operation rounds outward (R. E. Moore, "Interval
//! Analysis", 1966): by at least one unit in the last place where IEEE arithmetic rounds correctly,
//! by several where the value comes from a mathematical library with an error of up to two. The
//! gradient is bounded through its derivative expressions. At a kink (abs, min, max) they contain
//! every slope between the one-sided ones (F. H. Clarke's generalised gradient, 1975), so that the
//! mean value theorem holds there too.

mod flags;
mod range;
mod rows;

use super::MAX_OPERATIONS;
use super::derivative;
use super::graph::{Graph, Id, Node};
use super::operations::{Binary, Unary};
use crate::field::Enclosure;
use crate::math::{Bounds, Interval, Sym3};
pub(super) use range::Range;
pub(super) use rows::Row;
use std::sync::Arc;

/// Number of boxes whose bounds are computed together. Most calls have eight boxes or fewer. Both
/// fewer and more at once take longer.
const BOXES: usize = 4;

/// A graph compiled for boxes.
#[derive(Clone, Debug)]
pub(super) struct BoxProgram {
    /// The nodes that the results need.
    graph: Arc<Graph>,
    /// Bounds of the nodes that depend on no coordinate. As they contain the rounding errors they
    /// are seldom single numbers.
    uniforms: Vec<Row<BOXES>>,
    /// Nodes of the results.
    outputs: Vec<Id>,
}

/// Memory of one [`BoxProgram`]: the bounds of each node over the current boxes; empty at first.
#[derive(Debug, Default)]
pub(super) struct BoxRows(Vec<Row<BOXES>>);

impl BoxProgram {
    /// Compiles the nodes `outputs` of `graph`. [`BoxProgram::set_parameters`] has to be called
    /// before bounds are computed.
    pub(super) fn compile(graph: &Graph, outputs: &[Id]) -> Self {
        let (graph, outputs) = graph.rewritten(outputs, Graph::intern);
        Self { uniforms: vec![Row::ZERO; graph.len()], graph: Arc::new(graph), outputs }
    }

    /// Recomputes the bounds of the nodes that depend on no coordinate from the values of the
    /// parameters.
    pub(super) fn set_parameters(&mut self, parameters: &[f64]) {
        for (id, &node) in (0..).zip(self.graph.nodes()).filter(|&(id, _)| self.graph.is_uniform(id)) {
            let none = |_| unreachable!("a coordinate varies");
            self.uniforms[id as usize] =
                row_of(node, BOXES, parameters, none, |id| &self.uniforms[id as usize]);
        }
    }

    /// Number of operations for each box.
    pub(super) fn operations(&self) -> usize {
        (0..self.graph.len() as Id).filter(|&id| !self.graph.is_uniform(id)).count()
    }

    /// The operand and the number of a product with an exact number, which takes half the time of
    /// other products.
    fn scaled(&self, node: Node) -> Option<(Id, f64)> {
        let Node::Binary(Binary::Mul, a, b) = node else { return None };
        let factor = self.uniforms[b as usize].at(0);
        let Interval { lo, hi } = factor.bounds;
        (self.graph.is_uniform(b) && lo == hi && !factor.is_empty()).then_some((a, lo))
    }

    /// Calls `take` with the index of each box and a function that gives the bounds of result `n`
    /// over it.
    fn run(
        &self,
        rows: &mut BoxRows,
        boxes: &[Bounds],
        mut take: impl FnMut(usize, &dyn Fn(usize) -> Range),
    ) {
        let rows = &mut rows.0;
        if rows.is_empty() {
            rows.clone_from(&self.uniforms);
        }
        for (first, boxes) in (0..).step_by(BOXES).zip(boxes.chunks(BOXES)) {
            let n = boxes.len();
            // The last box pads the row: arbitrary numbers could be slow in some lanes.
            let coordinate =
                |axis: u8| Row::each(BOXES, |k| Range::of_coordinate(&boxes[k.min(n - 1)], axis));
            for (id, &node) in (0..).zip(self.graph.nodes()).filter(|&(id, _)| !self.graph.is_uniform(id)) {
                rows[id as usize] = match self.scaled(node) {
                    Some((a, factor)) => rows[a as usize].scale(factor),
                    None => row_of(node, n, &[], coordinate, |id| &rows[id as usize]),
                };
            }
            for k in 0..n {
                take(first + k, &|output| rows[self.outputs[output] as usize].at(k));
            }
        }
    }

    /// Bounds of results 0 … 3, a function and its gradient. Result 4 tells where the whole field
    /// is defined and continuous.
    pub(super) fn enclose(&self, rows: &mut BoxRows, boxes: &[Bounds], out: &mut [Enclosure]) {
        self.run(rows, boxes, |i, result| out[i] = enclosure([0, 1, 2, 3, 4].map(result)));
    }

    /// Bounds of results 0 … 5, the second derivatives.
    pub(super) fn enclose_second(&self, rows: &mut BoxRows, boxes: &[Bounds], out: &mut [Sym3<Interval>]) {
        self.run(rows, boxes, |i, result| {
            let [xx, xy, xz, yy, yz, zz] = [0, 1, 2, 3, 4, 5].map(|output| slope(result(output)));
            out[i] = Sym3 { xx, xy, xz, yy, yz, zz };
        });
    }
}

/// Bounds of a node over the first `n` boxes of a row, from those of the coordinates and of its
/// operands.
fn row_of<'a, const N: usize>(
    node: Node,
    n: usize,
    parameters: &[f64],
    coordinate: impl Fn(u8) -> Row<N>,
    known: impl Fn(Id) -> &'a Row<N>,
) -> Row<N> {
    match node {
        Node::Constant(bits) => Row::fill(Range::exactly(f64::from_bits(bits))),
        Node::Parameter(index) => Row::fill(Range::exactly(parameters[index as usize])),
        Node::Coordinate(axis) => coordinate(axis),
        Node::Unary(operation, a) => {
            let a = known(a);
            match operation {
                Unary::Neg => a.neg(),
                Unary::Abs => a.abs(),
                Unary::Sqrt => a.sqrt(),
                Unary::Sign => a.sign(),
                Unary::Sin => a.sine(false),
                Unary::Cos => a.sine(true),
                _ => Row::each(n, |k| a.at(k).unary(operation)),
            }
        }
        Node::Power(a, exponent) => {
            let power = known(a).power(exponent.unsigned_abs());
            if exponent < 0 { Row::each(n, |k| power.at(k).reciprocal()) } else { power }
        }
        Node::Binary(operation, a, b) => {
            let (a, b) = (known(a), known(b));
            match operation {
                Binary::Add => a.add(b),
                Binary::Sub => a.sub(b),
                Binary::Mul => a.mul(b),
                Binary::Div => a.mul(&Row::each(n, |k| b.at(k).reciprocal())),
                Binary::Min => a.min(b),
                Binary::Max => a.max(b),
                Binary::Pow => Row::each(n, |k| a.at(k).real_power(b.at(k))),
                Binary::Atan2 => Row::each(n, |k| a.at(k).angle(b.at(k))),
            }
        }
        Node::Smin(blend, a, b, width) => {
            let [a, b, width] = [a, b, width].map(known);
            Row::each(n, |k| Range::smooth_minimum(blend, a.at(k), b.at(k), width.at(k)))
        }
        Node::If(at_most, a, b, value) => {
            let [a, b, value] = [a, b, value].map(known);
            Row::each(n, |k| Range::choice(a.at(k), b.at(k), value.at(k), at_most))
        }
        Node::Select(joins, a, b, u, v) => {
            let [a, b, u, v] = [a, b, u, v].map(known);
            Row::each(n, |k| Range::select(joins, a.at(k), b.at(k), u.at(k), v.at(k)))
        }
    }
}

/// Bounds of `nodes` over a box, written to `rows` at the index of each. The operands of each must
/// be among the nodes.
pub(super) fn bounds(
    graph: &Graph,
    nodes: &[Id],
    parameters: &[f64],
    bounds: &Bounds,
    rows: &mut Vec<Row<1>>,
) {
    bounds_with(graph, nodes, parameters, bounds, |_| None, rows);
}

/// [`bounds`], with each node replaced for which `instead_of` names another.
pub(super) fn bounds_with(
    graph: &Graph,
    nodes: &[Id],
    parameters: &[f64],
    bounds: &Bounds,
    instead_of: impl Fn(Id) -> Option<Id>,
    rows: &mut Vec<Row<1>>,
) {
    rows.resize(graph.len().max(rows.len()), Row::ZERO);
    for &id in nodes {
        let coordinate = |axis: u8| Row::fill(Range::of_coordinate(bounds, axis));
        rows[id as usize] = match instead_of(id) {
            Some(other) => rows[other as usize],
            None => row_of(graph.node(id), 1, parameters, coordinate, |id| &rows[id as usize]),
        };
    }
}

/// Bounds of a derivative; unlimited if it is defined nowhere in the box.
fn slope(range: Range) -> Interval {
    if range.is_empty() { Interval::EVERYTHING } else { range.bounds }
}

/// Enclosure from the bounds of a function, of its gradient and of the whole field.
fn enclosure([f, x, y, z, whole]: [Range; 5]) -> Enclosure {
    if f.is_empty() || whole.is_empty() {
        return Enclosure::NOWHERE;
    }
    let flags = f.flags & whole.flags;
    Enclosure {
        value: f.bounds,
        gradient: [x, y, z].map(slope),
        defined: flags & flags::DEFINED != 0,
        continuous: flags & flags::CONTINUOUS != 0,
        smooth: flags & x.flags & y.flags & z.flags & flags::REGULAR == flags::REGULAR,
        may_vanish: !f.is_nonzero(),
    }
}

/// A factor of the field, compiled for boxes. Its zeros are zeros of the field.
#[derive(Clone, Debug)]
pub(super) struct FactorProgram {
    /// The factor and its gradient, with the whole field as result 4.
    pub(super) first: BoxProgram,
    /// The second derivatives of the factor; `None`, and unbounded, if they take more operations
    /// than a formula may have.
    pub(super) second: Option<BoxProgram>,
}

impl FactorProgram {
    /// The program of a function with this gradient, whose zeros are zeros of the field, node
    /// `whole`.
    pub(super) fn of(graph: &mut Graph, function: Id, gradient: [Id; 3], whole: Id) -> Self {
        let [x, y, z] = gradient;
        let first = BoxProgram::compile(graph, &[function, x, y, z, whole]);
        let second = (first.operations() <= MAX_OPERATIONS)
            .then(|| derivative::hessian(graph, gradient))
            .map(|second| BoxProgram::compile(graph, &second))
            .filter(|second| second.operations() <= MAX_OPERATIONS);
        Self { first, second }
    }

    /// Recomputes the bounds that depend on the parameters alone.
    pub(super) fn set_parameters(&mut self, parameters: &[f64]) {
        self.first.set_parameters(parameters);
        if let Some(program) = &mut self.second {
            program.set_parameters(parameters);
        }
    }
}

/// Maximum number of factors; a product of more is one function. Each program holds the whole
/// product too, for its domain, so that their total size grows with the square of the number.
const MAX_FACTORS: usize = 16;

/// Programs for the [factors](Graph::factors) of a function with this gradient, or for the function
/// alone. A factor is simpler than the product, and it has a gradient where two factors vanish
/// together. Zeros of the function must be zeros of the field, node `whole`.
pub(super) fn factors(graph: &mut Graph, function: Id, gradient: [Id; 3], whole: Id) -> Vec<FactorProgram> {
    let mut factors = graph.factors(function);
    if factors.is_empty() || factors.len() > MAX_FACTORS {
        factors = vec![function];
    }
    factors
        .into_iter()
        .map(|f| {
            let gradient = if f == function { gradient } else { derivative::gradient(graph, f) };
            FactorProgram::of(graph, f, gradient, whole)
        })
        .collect()
}
