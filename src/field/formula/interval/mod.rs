//! Interval arithmetic over the graph: bounds of f and ∇f over boxes, many boxes at a time.
//!
//! The bounds hold at every point of a box. Every operation rounds outward (R. E. Moore, "Interval Analysis", 1966): by
//! at least one unit in the last place where IEEE arithmetic rounds correctly, by several where the value comes from a
//! mathematical library with an error of up to two. The bounds of the gradient are those of the derivative expressions.
//! At a kink (abs, min, max) they contain every slope between the one-sided ones (F. H. Clarke's generalised gradient,
//! 1975), so that the mean value theorem holds there too.

mod flags;
mod range;
mod rows;

use super::MAX_OPERATIONS;
use super::derivative;
use super::graph::{Graph, Id, Node};
use super::operations::{Binary, Unary};
use super::registers::RegisterAllocator;
use crate::field::Enclosure;
use crate::math::{Bounds, Interval, Sym3};
pub(super) use range::Range;
use rows::{BOXES, Row};

/// Operation of a step. Its operands a, b and c are rows unless stated otherwise.
#[derive(Clone, Copy, Debug)]
enum BoxOp {
    /// Uniform a over every box.
    Fill,
    Unary(Unary),
    Power(i32),
    Binary(Binary),
    /// Row a times uniform b.
    Scale,
    Smin,
    /// Row c where row a is at most row b, or, with `false`, where it is not; else 0.
    If(bool),
}

#[derive(Clone, Copy, Debug)]
struct BoxStep {
    op: BoxOp,
    out: u32,
    operands: [u32; 3],
}

/// A graph compiled for boxes.
#[derive(Clone, Debug, Default)]
pub(super) struct BoxProgram {
    /// Nodes that depend on no coordinate; their operands are indices into this list.
    uniform_nodes: Vec<Node>,
    /// Current bounds of the uniform nodes. They contain the rounding errors, so they are seldom single numbers.
    uniforms: Vec<Range>,
    steps: Vec<BoxStep>,
    /// Rows of the results.
    outputs: Vec<u32>,
    /// The first three are the coordinates.
    rows: Vec<Row>,
}

impl BoxProgram {
    /// Compiles the nodes `outputs` of `graph`. Bounds may be asked for once [`BoxProgram::set_parameters`] is called.
    pub(super) fn compile(graph: &Graph, outputs: &[Id]) -> Self {
        let mut program = Self::default();
        let mut uniform = vec![0_u32; graph.len()];
        // Virtual row of each node, later replaced by a real one.
        let mut row = vec![u32::MAX; graph.len()];
        let mut next = 3_u32;
        for id in graph.needed_by(outputs) {
            let node = graph.node(id);
            if graph.is_uniform(id) {
                uniform[id as usize] = program.uniform_nodes.len() as u32;
                program.uniform_nodes.push(node.mapped(|operand| uniform[operand as usize]));
                continue;
            }
            if let Node::Coordinate(axis) = node {
                row[id as usize] = u32::from(axis);
                continue;
            }
            let exact = |operand: Id| graph.is_uniform(operand);
            let scaled = matches!(node, Node::Binary(Binary::Mul, _, b) if exact(b));
            let mut operands = [0; 3];
            let mut k = 0;
            node.operands(|operand| {
                operands[k] = if scaled && k == 1 {
                    uniform[operand as usize]
                } else {
                    program.row_of(graph, operand, &uniform, &mut row, &mut next)
                };
                k += 1;
            });
            let op = match node {
                Node::Unary(operation, _) => BoxOp::Unary(operation),
                Node::Power(_, n) => BoxOp::Power(n),
                Node::Binary(_, _, _) if scaled => BoxOp::Scale,
                Node::Binary(operation, _, _) => BoxOp::Binary(operation),
                Node::Smin(_, _, _) => BoxOp::Smin,
                Node::If(at_most, ..) => BoxOp::If(at_most),
                Node::Constant(_) | Node::Parameter(_) | Node::Coordinate(_) => {
                    unreachable!("dealt with above")
                }
            };
            row[id as usize] = next;
            program.steps.push(BoxStep { op, out: next, operands });
            next += 1;
        }
        for &id in outputs {
            let output = program.row_of(graph, id, &uniform, &mut row, &mut next);
            program.outputs.push(output);
        }
        program.allocate(next);
        program
    }

    /// Virtual row of a node. A uniform node is broadcast into a row.
    fn row_of(&mut self, graph: &Graph, id: Id, uniform: &[u32], row: &mut [u32], next: &mut u32) -> u32 {
        if graph.is_uniform(id) && row[id as usize] == u32::MAX {
            self.steps.push(BoxStep { op: BoxOp::Fill, out: *next, operands: [uniform[id as usize], 0, 0] });
            row[id as usize] = *next;
            *next += 1;
        }
        row[id as usize]
    }

    /// Assigns real rows to virtual ones.
    fn allocate(&mut self, count: u32) {
        let uses = self.steps.iter().enumerate().flat_map(|(at, step)| step.rows().map(move |row| (at, row)));
        // The coordinates are filled in anew for each batch of boxes.
        let kept = self.outputs.iter().copied().chain(0..3);
        let mut real = RegisterAllocator::new(count as usize, uses, kept);
        (0..3).for_each(|axis| _ = real.assign(axis));
        for (at, step) in self.steps.iter_mut().enumerate() {
            let used = *step;
            for (operand, is_row) in step.operands.iter_mut().zip(step.op.row_operands()) {
                if is_row {
                    *operand = real.of(*operand);
                }
            }
            real.free(at, used.rows());
            step.out = real.assign(used.out);
        }
        self.outputs.iter_mut().for_each(|row| *row = real.of(*row));
        self.rows = vec![Row::ZERO; real.count()];
    }

    /// Recomputes the bounds of the uniform nodes from the values of the parameters.
    pub(super) fn set_parameters(&mut self, parameters: &[f64]) {
        self.uniforms.clear();
        for &node in &self.uniform_nodes {
            let coordinate = |_| unreachable!("a coordinate is not uniform");
            let range = range_of(node, parameters, coordinate, |id| self.uniforms[id as usize]);
            self.uniforms.push(range);
        }
    }

    /// Number of operations.
    pub(super) fn operations(&self) -> usize {
        self.steps.len()
    }

    /// Calls `take` with the index of each box and a function that gives the bounds of result `n` over it.
    fn run(&mut self, boxes: &[Bounds], mut take: impl FnMut(usize, &dyn Fn(usize) -> Range)) {
        for (first, boxes) in (0..).step_by(BOXES).zip(boxes.chunks(BOXES)) {
            let n = boxes.len();
            for axis in 0..3 {
                let row = &mut self.rows[axis];
                for k in 0..BOXES {
                    // The last box pads the row: arbitrary numbers could be slow in some lanes.
                    let Bounds { min, max } = boxes[k.min(n - 1)];
                    (row.lo[k], row.hi[k]) = (min[axis].min(max[axis]), min[axis].max(max[axis]));
                }
            }
            for at in 0..self.steps.len() {
                let step = self.steps[at];
                self.rows[step.out as usize] = self.execute(&step, n);
            }
            for k in 0..n {
                take(first + k, &|output| self.rows[self.outputs[output] as usize].at(k));
            }
        }
    }

    /// Bounds of results 0 … 3, a function and its gradient. Result 4 tells where the whole field is defined and
    /// continuous.
    pub(super) fn enclose(&mut self, boxes: &[Bounds], out: &mut [Enclosure]) {
        self.run(boxes, |i, result| out[i] = enclosure([0, 1, 2, 3, 4].map(result)));
    }

    /// Bounds of results 0 … 5, the second derivatives.
    pub(super) fn enclose_second(&mut self, boxes: &[Bounds], out: &mut [Sym3<Interval>]) {
        self.run(boxes, |i, result| {
            let [xx, xy, xz, yy, yz, zz] = [0, 1, 2, 3, 4, 5].map(|output| slope(result(output)));
            out[i] = Sym3 { xx, xy, xz, yy, yz, zz };
        });
    }

    fn execute(&self, step: &BoxStep, n: usize) -> Row {
        let [a, b, c] = step.operands;
        let row = |operand: u32| &self.rows[operand as usize];
        match step.op {
            BoxOp::Fill => Row::fill(self.uniforms[a as usize]),
            BoxOp::Unary(operation) => match operation {
                Unary::Neg => row(a).neg(),
                Unary::Square => row(a).square(),
                Unary::Abs => row(a).abs(),
                Unary::Sqrt => row(a).sqrt(),
                Unary::Sign => row(a).sign(),
                Unary::Sin => row(a).sine(false),
                Unary::Cos => row(a).sine(true),
                _ => Row::each(n, |k| row(a).at(k).unary(operation)),
            },
            BoxOp::Power(2) => row(a).square(),
            BoxOp::Power(n_th) => Row::each(n, |k| row(a).at(k).power(n_th)),
            BoxOp::Scale => {
                let factor = self.uniforms[b as usize];
                if factor.bounds.lo == factor.bounds.hi && !factor.is_empty() {
                    row(a).scale(factor.bounds.lo)
                } else {
                    row(a).mul(&Row::fill(factor))
                }
            }
            BoxOp::Binary(operation) => match operation {
                Binary::Add => row(a).add(row(b)),
                Binary::Sub => row(a).sub(row(b)),
                Binary::Mul => row(a).mul(row(b)),
                Binary::Min => row(a).min(row(b)),
                Binary::Max => row(a).max(row(b)),
                _ => Row::each(n, |k| row(a).at(k).binary(operation, row(b).at(k))),
            },
            BoxOp::Smin => Row::each(n, |k| Range::smooth_minimum(row(a).at(k), row(b).at(k), row(c).at(k))),
            BoxOp::If(at_most) => {
                Row::each(n, |k| Range::choice(row(a).at(k), row(b).at(k), row(c).at(k), at_most))
            }
        }
    }
}

/// Bounds of a node, from those of the coordinates and of its operands.
fn range_of(
    node: Node,
    parameters: &[f64],
    coordinate: impl Fn(u8) -> Range,
    known: impl Fn(Id) -> Range,
) -> Range {
    match node {
        Node::Constant(bits) => Range::exactly(f64::from_bits(bits)),
        Node::Parameter(index) => Range::exactly(parameters[index as usize]),
        Node::Coordinate(axis) => coordinate(axis),
        Node::Unary(operation @ (Unary::Sin | Unary::Cos), a) => {
            Row::fill(known(a)).sine(operation == Unary::Cos).at(0)
        }
        Node::Unary(operation, a) => known(a).unary(operation),
        Node::Power(a, n) => known(a).power(n),
        Node::Binary(operation, a, b) => known(a).binary(operation, known(b)),
        Node::Smin(a, b, k) => Range::smooth_minimum(known(a), known(b), known(k)),
        Node::If(at_most, a, b, v) => Range::choice(known(a), known(b), known(v), at_most),
    }
}

/// Bounds of `nodes` over a box: `ranges` gets those of each at its index. The operands of each have to be among them.
pub(super) fn bounds(
    graph: &Graph,
    nodes: &[Id],
    parameters: &[f64],
    bounds: &Bounds,
    ranges: &mut Vec<Range>,
) {
    ranges.resize(graph.len().max(ranges.len()), Range::exactly(0.0));
    for &id in nodes {
        let coordinate =
            |axis: u8| Range::between(bounds.min[usize::from(axis)], bounds.max[usize::from(axis)]);
        let range = range_of(graph.node(id), parameters, coordinate, |id| ranges[id as usize]);
        ranges[id as usize] = range;
    }
}

impl BoxOp {
    /// Whether each of the operands is a row.
    fn row_operands(self) -> [bool; 3] {
        match self {
            Self::Fill => [false; 3],
            Self::Unary(_) | Self::Power(_) | Self::Scale => [true, false, false],
            Self::Binary(_) => [true, true, false],
            Self::Smin | Self::If(_) => [true; 3],
        }
    }
}

impl BoxStep {
    /// Operands that are rows.
    fn rows(&self) -> impl Iterator<Item = u32> {
        let (used, operands) = (self.op.row_operands(), self.operands);
        (0..3).filter(move |&k| used[k]).map(move |k| operands[k])
    }
}

/// Bounds of a derivative. Nothing is known of one that is defined nowhere in the box.
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

/// A factor of the field, whose zeros are among those of the field, compiled for boxes.
#[derive(Clone, Debug)]
pub(super) struct FactorProgram {
    /// The factor and its gradient, with the whole field as result 4.
    pub(super) first: BoxProgram,
    /// The second derivatives of the factor; `None` if they take more than [`MAX_SECOND_OPERATIONS`].
    pub(super) second: Option<BoxProgram>,
}

impl FactorProgram {
    /// Recomputes the bounds of what depends on the parameters alone.
    pub(super) fn set_parameters(&mut self, parameters: &[f64]) {
        self.first.set_parameters(parameters);
        if let Some(program) = &mut self.second {
            program.set_parameters(parameters);
        }
    }
}

/// Maximum number of operations of a program for second derivatives. Those of a formula that takes more are unbounded.
const MAX_SECOND_OPERATIONS: usize = 2 * MAX_OPERATIONS;

/// Maximum number of factors. A product of more is taken as one function.
const MAX_FACTORS: usize = 16;

/// The functions whose zeros together are those of `root`.
///
/// A product is taken apart into its factors, a power into its base, and a function that vanishes only at 0 into its
/// argument. A factor is simpler than the product, and it has a gradient where two factors vanish together.
pub(super) fn factors(graph: &mut Graph, root: Id, gradient: [Id; 3]) -> Vec<FactorProgram> {
    let mut factors = Vec::new();
    let mut open = vec![root];
    while let Some(id) = open.pop() {
        match graph.node(id) {
            _ if graph.is_uniform(id) => {}
            Node::Binary(Binary::Mul, a, b) => open.extend([b, a]),
            Node::Binary(Binary::Div, a, _) => open.push(a),
            Node::Power(a, n) if n > 0 => open.push(a),
            Node::Power(_, _) => {}
            Node::Unary(
                Unary::Neg
                | Unary::Square
                | Unary::Sqrt
                | Unary::Cbrt
                | Unary::Abs
                | Unary::Atan
                | Unary::Sinh
                | Unary::Tanh,
                a,
            ) => open.push(a),
            _ if factors.contains(&id) => {}
            _ => factors.push(id),
        }
    }
    if factors.is_empty() || factors.len() > MAX_FACTORS {
        factors = vec![root];
    }
    factors
        .into_iter()
        .map(|f| {
            let [x, y, z] = if f == root { gradient } else { derivative::gradient(graph, f) };
            let first = BoxProgram::compile(graph, &[f, x, y, z, root]);
            let second = (first.operations() <= MAX_SECOND_OPERATIONS)
                .then(|| derivative::hessian(graph, [x, y, z]))
                .map(|second| BoxProgram::compile(graph, &second))
                .filter(|second| second.operations() <= MAX_SECOND_OPERATIONS);
            FactorProgram { first, second }
        })
        .collect()
}
