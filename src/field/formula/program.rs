//! Compiler from a graph to a straight-line program over a small register file, for batches of
//! points.
//!
//! A node that depends on no coordinate is a *uniform*. It is computed once, in double precision,
//! whenever a parameter changes, and enters the instructions as a broadcast operand. The varying
//! nodes are lowered: integer powers become products, smooth minima their polynomial, choices sums
//! of two. A register is reused as soon as its value is dead, so that a block of points stays in
//! the first-level cache.

use super::graph::{Blend, Graph, Id, Node};
use super::operations::{Binary, Unary};
use core::ops::Deref;
use std::sync::Arc;

/// Operation of an instruction. R\[·\] is the value of a register, U\[·\] that of a uniform.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Op {
    /// U[a]
    Splat,
    /// f(R[a])
    Unary(Unary),
    /// sin R[a]; register b receives cos R[a]
    SineCosine,
    /// R[a] ∘ R[b]
    Binary(Binary),
    /// R[a] ∘ U[b]
    Uniform(Binary),
    /// R[c] where R[a] ≤ R[b], or, with `false`, where R[a] > R[b]; else 0, and NaN where either is
    /// NaN
    If(bool),
}

/// An instruction. Unused operands are 0, and the result may overwrite an operand.
#[derive(Clone, Copy, Debug)]
pub(super) struct Instruction {
    pub(super) op: Op,
    pub(super) out: u32,
    pub(super) a: u32,
    pub(super) b: u32,
    pub(super) c: u32,
}

/// A compiled graph with any number of results, and the values of its uniforms. Copies share the
/// instructions.
#[derive(Clone, Debug)]
pub(super) struct Program {
    tape: Arc<Tape>,
    /// Values of the uniforms.
    pub(super) uniforms: Vec<f32>,
}

impl Deref for Program {
    type Target = Tape;

    fn deref(&self) -> &Tape {
        &self.tape
    }
}

/// The instructions of a program, which do not depend on the values of parameters.
#[derive(Debug, Default)]
pub(super) struct Tape {
    /// Uniform nodes; their operands are indices into this list.
    uniform_nodes: Vec<Node>,
    pub(super) instructions: Vec<Instruction>,
    /// Register of each coordinate that is used.
    pub(super) coordinates: [Option<u32>; 3],
    /// Register of each result after a run.
    pub(super) outputs: Vec<u32>,
    /// Number of registers.
    pub(super) registers: usize,
}

impl Program {
    /// Compiles the nodes `outputs` of `graph`, with these values of the parameters.
    pub(super) fn compile(graph: &Graph, outputs: &[Id], parameters: &[f64]) -> Self {
        let (low, outputs) = graph.rewritten(outputs, |low, node| match node {
            Node::Smin(blend, a, b, k) => smooth_minimum(low, blend, a, b, k),
            Node::Select(_, a, b, u, v) => {
                let (u, v) = (low.when(true, a, b, u), low.when(false, a, b, v));
                low.add(u, v)
            }
            Node::Power(a, n) => integer_power(low, a, n),
            node => low.intern(node),
        });
        let tape = Compiler::new(&low, &outputs).compile();
        let mut program = Self { tape: Arc::new(tape), uniforms: Vec::new() };
        program.set_parameters(parameters);
        program
    }

    /// Recomputes the uniforms from the values of the parameters.
    #[expect(clippy::cast_possible_truncation, reason = "instructions take single precision")]
    pub(super) fn set_parameters(&mut self, parameters: &[f64]) {
        let mut doubles: Vec<f64> = Vec::with_capacity(self.tape.uniform_nodes.len());
        for node in &self.tape.uniform_nodes {
            doubles.push(node.evaluate(parameters, [f64::NAN; 3], |id| doubles[id as usize]));
        }
        self.uniforms.clear();
        self.uniforms.extend(doubles.iter().map(|&value| value as f32));
    }

    /// Number of operations, which [`MAX_OPERATIONS`](super::MAX_OPERATIONS) bounds.
    pub(super) fn operations(&self) -> usize {
        self.instructions.len() + self.uniform_nodes.len()
    }
}

/// Number of operations that compute `outputs` at a point, to choose between forward and backward
/// differentiation. Each operation counts as one: weights would hardly ever change the choice.
pub(super) fn cost(graph: &Graph, outputs: &[Id]) -> usize {
    let is_operation = |&id: &Id| !graph.is_uniform(id) && !matches!(graph.node(id), Node::Coordinate(_));
    graph.needed_by(outputs).iter().filter(|id| is_operation(id)).count()
}

/// The smooth minimum as min(a, b) − k (1 − |u|)³/6, or min(a, b) − k (1 − |u|)²/4, with u = (a −
/// b)/k clamped to −1 … 1.
fn smooth_minimum(low: &mut Graph, blend: Blend, a: Id, b: Id, k: Id) -> Id {
    let (width, u) = low.blend(a, b, k);
    let magnitude = low.unary(Unary::Abs, u);
    let one = low.constant(1.0);
    let gap = low.sub(one, magnitude);
    let (degree, share) = match blend {
        Blend::Cubic => (3, 1.0 / 6.0),
        Blend::Quadratic => (2, 0.25),
    };
    let power = integer_power(low, gap, degree);
    let share = low.constant(share);
    let depth = low.mul(width, share);
    let depth = low.mul(power, depth);
    let least = low.binary(Binary::Min, a, b);
    low.sub(least, depth)
}

/// x^n, as products, of 1/x for negative n, if it varies.
fn integer_power(low: &mut Graph, x: Id, n: i32) -> Id {
    /// x^n for n ≥ 1 by squaring: x^(2m) = (x^m)², x^(2m+1) = x · x^(2m).
    fn product(low: &mut Graph, x: Id, n: u32) -> Id {
        if n == 1 {
            return x;
        }
        let half = product(low, x, n / 2);
        let square = low.intern(Node::Binary(Binary::Mul, half, half));
        if n.is_multiple_of(2) { square } else { low.intern(Node::Binary(Binary::Mul, square, x)) }
    }
    if low.is_uniform(x) {
        return low.intern(Node::Power(x, n));
    }
    let base = if n < 0 {
        let one = low.constant(1.0);
        low.intern(Node::Binary(Binary::Div, one, x))
    } else {
        x
    };
    product(low, base, n.unsigned_abs())
}

/// Compiler of a lowered graph.
struct Compiler<'a> {
    graph: &'a Graph,
    outputs: &'a [Id],
    tape: Tape,
    /// The nodes that the outputs need, in the order of the graph and of the instructions.
    needed: Vec<Id>,
    /// Index in `uniform_nodes` of each uniform node that is needed.
    uniform: Vec<u32>,
    /// Instructions over virtual registers, each set once. The coordinates have the first three,
    /// used or not.
    code: Vec<Instruction>,
    /// Number of virtual registers.
    values: usize,
    /// Virtual register of each varying node.
    register: Vec<Option<u32>>,
}

impl<'a> Compiler<'a> {
    fn new(graph: &'a Graph, outputs: &'a [Id]) -> Self {
        Self {
            graph,
            outputs,
            tape: Tape::default(),
            needed: graph.needed_by(outputs),
            uniform: vec![0; graph.len()],
            code: Vec::new(),
            values: 3,
            register: vec![None; graph.len()],
        }
    }

    fn compile(mut self) -> Tape {
        for at in 0..self.needed.len() {
            let id = self.needed[at];
            if self.graph.is_uniform(id) {
                let node = self.graph.node(id).mapped(|operand| self.uniform[operand as usize]);
                self.uniform[id as usize] = index(self.tape.uniform_nodes.len());
                self.tape.uniform_nodes.push(node);
            } else if self.register[id as usize].is_none() {
                self.register[id as usize] = Some(self.emit(id));
            }
        }
        for &output in self.outputs {
            let register = self.operand(output);
            self.tape.outputs.push(register);
        }
        self.allocate();
        self.tape
    }

    fn push(&mut self, op: Op, [a, b, c]: [u32; 3]) -> u32 {
        let out = self.new_value();
        self.code.push(Instruction { op, out, a, b, c });
        out
    }

    /// A virtual register that has no value yet.
    fn new_value(&mut self) -> u32 {
        self.values += 1;
        index(self.values - 1)
    }

    /// Virtual register of an operand or a result. A uniform one is broadcast into a register.
    fn operand(&mut self, id: Id) -> u32 {
        if self.graph.is_uniform(id) {
            self.push(Op::Splat, [self.uniform[id as usize], 0, 0])
        } else {
            self.register[id as usize].expect("operands come first")
        }
    }

    /// Emits the instruction of a varying node and returns its virtual register.
    fn emit(&mut self, id: Id) -> u32 {
        match self.graph.node(id) {
            Node::Coordinate(axis) => u32::from(axis),
            Node::Unary(operation @ (Unary::Sin | Unary::Cos), a) => self.emit_sine_or_cosine(operation, a),
            Node::Unary(operation, a) => {
                let a = self.operand(a);
                self.push(Op::Unary(operation), [a, 0, 0])
            }
            Node::Binary(operation, a, b) => self.emit_binary(operation, a, b),
            Node::If(at_most, a, b, c) => {
                let operands = [self.operand(a), self.operand(b), self.operand(c)];
                self.push(Op::If(at_most), operands)
            }
            Node::Constant(_) | Node::Parameter(_) | Node::Power(..) | Node::Smin(..) | Node::Select(..) => {
                unreachable!("uniform nodes have no instruction, powers and what is like them were expanded")
            }
        }
    }

    /// Emits a sine or cosine. If the graph has both of one angle, one instruction computes them:
    /// they share the argument reduction.
    fn emit_sine_or_cosine(&mut self, operation: Unary, a: Id) -> u32 {
        let angle = self.operand(a);
        let other = if operation == Unary::Sin { Unary::Cos } else { Unary::Sin };
        let partner = self.graph.find(Node::Unary(other, a)).filter(|partner| {
            self.needed.binary_search(partner).is_ok() && self.register[*partner as usize].is_none()
        });
        let Some(partner) = partner else { return self.push(Op::Unary(operation), [angle, 0, 0]) };
        let cosine = self.new_value();
        let sine = self.push(Op::SineCosine, [angle, cosine, 0]);
        let (own, partners) = if operation == Unary::Sin { (sine, cosine) } else { (cosine, sine) };
        self.register[partner as usize] = Some(partners);
        own
    }

    fn emit_binary(&mut self, operation: Binary, a: Id, b: Id) -> u32 {
        let commutes = matches!(operation, Binary::Add | Binary::Mul | Binary::Min | Binary::Max);
        let (a, b) = if commutes && self.graph.is_uniform(a) { (b, a) } else { (a, b) };
        let first = self.operand(a);
        let (op, second) = if self.graph.is_uniform(b) {
            (Op::Uniform(operation), self.uniform[b as usize])
        } else {
            (Op::Binary(operation), self.operand(b))
        };
        self.push(op, [first, second, 0])
    }

    /// Assigns real registers to virtual ones: each is free after the last use of its value.
    fn allocate(&mut self) {
        /// The last use of a value that is a result of the program.
        const NEVER: usize = usize::MAX;
        let mut last_use = vec![None; self.values];
        for (at, instruction) in self.code.iter().enumerate() {
            registers(instruction).for_each(|value| last_use[value as usize] = Some(at));
        }
        for &output in &self.tape.outputs {
            last_use[output as usize] = Some(NEVER);
        }
        let (mut real, mut is_free) = (vec![0; self.values], Vec::new());
        for (axis, coordinate) in self.tape.coordinates.iter_mut().enumerate() {
            *coordinate = last_use[axis].map(|_| lowest_free(&mut is_free));
            real[axis] = coordinate.unwrap_or(0);
        }
        for (at, instruction) in self.code.iter().enumerate() {
            let mut mapped = substituted(instruction, &real);
            for value in registers(instruction).filter(|&value| last_use[value as usize] == Some(at)) {
                is_free[real[value as usize] as usize] = true;
            }
            mapped.out = lowest_free(&mut is_free);
            real[instruction.out as usize] = mapped.out;
            if instruction.op == Op::SineCosine {
                mapped.b = lowest_free(&mut is_free);
                real[instruction.b as usize] = mapped.b;
            }
            self.tape.instructions.push(mapped);
        }
        for output in &mut self.tape.outputs {
            *output = real[*output as usize];
        }
        self.tape.registers = is_free.len();
    }
}

/// Takes the lowest free register.
fn lowest_free(is_free: &mut Vec<bool>) -> u32 {
    let lowest = is_free.iter().position(|&is_free| is_free).unwrap_or_else(|| {
        is_free.push(true);
        is_free.len() - 1
    });
    is_free[lowest] = false;
    index(lowest)
}

fn index(length: usize) -> u32 {
    u32::try_from(length).expect("programs are far shorter than 2^32")
}

/// Whether each of the operands a, b and c is a register.
fn register_operands(op: Op) -> [bool; 3] {
    match op {
        Op::Splat => [false; 3],
        Op::Unary(_) | Op::SineCosine | Op::Uniform(_) => [true, false, false],
        Op::Binary(_) => [true, true, false],
        Op::If(_) => [true; 3],
    }
}

/// Register operands of the instruction.
fn registers(instruction: &Instruction) -> impl Iterator<Item = u32> {
    let operands = [instruction.a, instruction.b, instruction.c];
    let used = register_operands(instruction.op);
    (0..3).filter(move |&k| used[k]).map(move |k| operands[k])
}

/// Instruction with its register operands replaced through `real`.
fn substituted(instruction: &Instruction, real: &[u32]) -> Instruction {
    let [a, b, c] = register_operands(instruction.op);
    let replaced = |used: bool, operand: u32| if used { real[operand as usize] } else { operand };
    Instruction {
        a: replaced(a, instruction.a),
        b: replaced(b, instruction.b),
        c: replaced(c, instruction.c),
        ..*instruction
    }
}
