//! Runs a program over points, a block at a time.
//!
//! Registers hold up to [`BLOCK`] × 8 points each, so that the cost of reading an instruction is spread over many
//! points; every lane is computed by the same IEEE operations wherever it stands, so a point's result does not
//! depend on its neighbours.

use super::operations::{Binary, Unary};
use super::program::{Instruction, Op, Place, Program};
use crate::math::functions;
use crate::math::{LANES, Lanes, Sym3};
use core::cell::Cell;
use glam::Vec3;

/// Most lanes of eight points in a block.
pub(super) const BLOCK: usize = 16;

/// Bytes of the register file that should not be exceeded: half of a small first-level cache.
const FILE_BYTES: usize = 16 * 1024;

/// Registers for a block of points; grows as needed and is reused.
#[derive(Clone, Debug, Default)]
pub(super) struct Scratch {
    file: Vec<Lanes>,
}

/// Where the results of one block go.
pub(super) trait Sink {
    /// Takes the `count` results that start at point `first`; `outputs` gives lane `k` of result `n`.
    fn store(&mut self, first: usize, count: usize, outputs: &Outputs<'_>);
}

/// The results of one block.
pub(super) struct Outputs<'a> {
    program: &'a Program,
    file: &'a [Lanes],
    stride: usize,
}

impl Outputs<'_> {
    /// Lanes `8 lane ..` of result `n`.
    fn lanes(&self, n: usize, lane: usize) -> Lanes {
        match self.program.outputs[n] {
            Place::Register(register) => self.file[register as usize * self.stride + lane],
            Place::Uniform(uniform) => Lanes::splat(self.program.uniforms[uniform as usize]),
        }
    }
}

/// Evaluates `program` at `points` and hands the results to `sink`, block by block.
pub(super) fn run(program: &Program, scratch: &mut Scratch, points: &[Vec3], sink: &mut impl Sink) {
    let row_bytes = size_of::<Lanes>() * program.registers.max(1);
    let stride = (FILE_BYTES / row_bytes).clamp(1, BLOCK);
    let needed = stride * program.registers;
    if scratch.file.len() < needed {
        scratch.file.resize(needed, Lanes::default());
    }
    let file = &mut scratch.file[..needed];
    let mut first = 0;
    for block in points.chunks(stride * LANES) {
        let rows = block.len().div_ceil(LANES);
        for (axis, register) in program.coordinates.iter().enumerate() {
            if let Some(register) = register {
                load(&mut file[*register as usize * stride..][..rows], block, axis);
            }
        }
        let cells = Cell::from_mut(&mut *file).as_slice_of_cells();
        for instruction in &program.instructions {
            execute(instruction, &program.uniforms, &Rows { cells, stride, rows });
        }
        sink.store(first, block.len(), &Outputs { program, file, stride });
        first += block.len();
    }
}

/// One coordinate of every point; the last lanes are filled up with the last point.
fn load(row: &mut [Lanes], points: &[Vec3], axis: usize) {
    let (whole, rest) = points.as_chunks::<LANES>();
    for (lanes, points) in row.iter_mut().zip(whole) {
        *lanes = Lanes(core::array::from_fn(|k| points[k][axis]));
    }
    if let (Some(last), Some(lanes)) = (rest.len().checked_sub(1), row.get_mut(whole.len())) {
        *lanes = Lanes(core::array::from_fn(|k| rest[k.min(last)][axis]));
    }
}

struct Rows<'a> {
    cells: &'a [Cell<Lanes>],
    stride: usize,
    rows: usize,
}

impl<'a> Rows<'a> {
    fn row(&self, register: u32) -> &'a [Cell<Lanes>] {
        &self.cells[register as usize * self.stride..][..self.rows]
    }
}

fn unary(rows: &Rows<'_>, i: &Instruction, f: impl Fn(Lanes) -> Lanes) {
    for (out, a) in rows.row(i.out).iter().zip(rows.row(i.a)) {
        out.set(f(a.get()));
    }
}

fn binary(rows: &Rows<'_>, i: &Instruction, f: impl Fn(Lanes, Lanes) -> Lanes) {
    for ((out, a), b) in rows.row(i.out).iter().zip(rows.row(i.a)).zip(rows.row(i.b)) {
        out.set(f(a.get(), b.get()));
    }
}

/// Operands a and c.
fn binary_ac(rows: &Rows<'_>, i: &Instruction, f: impl Fn(Lanes, Lanes) -> Lanes) {
    for ((out, a), c) in rows.row(i.out).iter().zip(rows.row(i.a)).zip(rows.row(i.c)) {
        out.set(f(a.get(), c.get()));
    }
}

fn ternary(rows: &Rows<'_>, i: &Instruction, f: impl Fn(Lanes, Lanes, Lanes) -> Lanes) {
    let operands = rows.row(i.a).iter().zip(rows.row(i.b)).zip(rows.row(i.c));
    for (out, ((a, b), c)) in rows.row(i.out).iter().zip(operands) {
        out.set(f(a.get(), b.get(), c.get()));
    }
}

/// A long function, on a copy of the whole row so that its loop is one that the compiler turns into SIMD code.
/// Called through a pointer, once per row, so that the copying exists once and not per function.
fn long(rows: &Rows<'_>, i: &Instruction, f: fn(&mut [f32])) {
    let mut buffer = [0.0; BLOCK * LANES];
    let (chunks, _) = buffer.as_chunks_mut::<LANES>();
    for (chunk, a) in chunks.iter_mut().zip(rows.row(i.a)) {
        *chunk = a.get().0;
    }
    f(&mut buffer[..rows.rows * LANES]);
    let (chunks, _) = buffer.as_chunks::<LANES>();
    for (out, chunk) in rows.row(i.out).iter().zip(chunks) {
        out.set(Lanes(*chunk));
    }
}

/// Sine and cosine at once.
fn sine_cosine(rows: &Rows<'_>, i: &Instruction) {
    let mut sine = [0.0; BLOCK * LANES];
    let mut cosine = [0.0; BLOCK * LANES];
    let (chunks, _) = sine.as_chunks_mut::<LANES>();
    for (chunk, a) in chunks.iter_mut().zip(rows.row(i.a)) {
        *chunk = a.get().0;
    }
    let length = rows.rows * LANES;
    functions::sin_cos_all(&mut sine[..length], &mut cosine[..length]);
    for (register, result) in [(i.out, &sine), (i.b, &cosine)] {
        let (chunks, _) = result.as_chunks::<LANES>();
        for (out, chunk) in rows.row(register).iter().zip(chunks) {
            out.set(Lanes(*chunk));
        }
    }
}

/// A long function of two operands.
fn long_binary(rows: &Rows<'_>, i: &Instruction, b: &dyn Fn(usize) -> Lanes, f: fn(&mut [f32], &[f32])) {
    let mut first = [0.0; BLOCK * LANES];
    let mut second = [0.0; BLOCK * LANES];
    let (chunks, _) = first.as_chunks_mut::<LANES>();
    for (chunk, a) in chunks.iter_mut().zip(rows.row(i.a)) {
        *chunk = a.get().0;
    }
    let (chunks, _) = second.as_chunks_mut::<LANES>();
    for (k, chunk) in chunks.iter_mut().enumerate().take(rows.rows) {
        *chunk = b(k).0;
    }
    let length = rows.rows * LANES;
    f(&mut first[..length], &second[..length]);
    let (chunks, _) = first.as_chunks::<LANES>();
    for (out, chunk) in rows.row(i.out).iter().zip(chunks) {
        out.set(Lanes(*chunk));
    }
}

/// Exponents up to this size are products: faster than a power of two functions, and as accurate.
const MOST_SMALL_WHOLE: f32 = 8.0;

/// `exponent` as a small whole number other than 0; the exponents of parameters often are.
fn small_whole(exponent: f32) -> Option<i32> {
    let small =
        exponent != 0.0 && exponent.abs() <= MOST_SMALL_WHOLE && functions::floor(exponent) == exponent;
    #[expect(clippy::cast_possible_truncation, reason = "a small whole number")]
    small.then_some(exponent as i32)
}

/// a^n by squaring, the reciprocal's power for n < 0.
fn whole_power(a: Lanes, n: i32) -> Lanes {
    let mut square = if n < 0 { Lanes::splat(1.0) / a } else { a };
    let mut rest = n.unsigned_abs();
    let mut result = Lanes::splat(1.0);
    while rest > 0 {
        if rest & 1 == 1 {
            result = result * square;
        }
        square = square * square;
        rest >>= 1;
    }
    result
}

fn execute(i: &Instruction, uniforms: &[f32], rows: &Rows<'_>) {
    let u = |operand: u32| Lanes::splat(uniforms[operand as usize]);
    match i.op {
        Op::Splat => {
            let value = u(i.a);
            rows.row(i.out).iter().for_each(|out| out.set(value));
        }
        Op::Unary(operation) => execute_unary(operation, i, rows),
        Op::Reciprocal => unary(rows, i, |a| Lanes::splat(1.0) / a),
        Op::SineCosine => sine_cosine(rows, i),
        Op::Second => unreachable!("removed when registers are allocated"),
        Op::Binary(Binary::Add) => binary(rows, i, |a, b| a + b),
        Op::Binary(Binary::Sub) => binary(rows, i, |a, b| a - b),
        Op::Binary(Binary::Mul) => binary(rows, i, |a, b| a * b),
        Op::Binary(Binary::Div) => binary(rows, i, |a, b| a / b),
        Op::Binary(Binary::Min) => binary(rows, i, |a, b| a.zip(b, functions::min)),
        Op::Binary(Binary::Max) => binary(rows, i, |a, b| a.zip(b, functions::max)),
        Op::Binary(Binary::Pow) => {
            let b = rows.row(i.b);
            long_binary(rows, i, &|k| b[k].get(), functions::pow_all);
        }
        Op::Binary(Binary::Atan2) => {
            let b = rows.row(i.b);
            long_binary(rows, i, &|k| b[k].get(), functions::atan2_all);
        }
        Op::Uniform(operation) => {
            let b = u(i.b);
            match operation {
                Binary::Add => unary(rows, i, |a| a + b),
                Binary::Mul => unary(rows, i, |a| a * b),
                Binary::Min => unary(rows, i, |a| a.zip(b, functions::min)),
                Binary::Max => unary(rows, i, |a| a.zip(b, functions::max)),
                Binary::Pow => match small_whole(uniforms[i.b as usize]) {
                    Some(n) => unary(rows, i, |a| whole_power(a, n)),
                    None => long_binary(rows, i, &|_| b, functions::pow_all),
                },
                Binary::Sub | Binary::Div | Binary::Atan2 => unreachable!("never compiled with a uniform"),
            }
        }
        Op::Reversed(operation) => {
            let b = u(i.b);
            match operation {
                Binary::Sub => unary(rows, i, |a| b - a),
                Binary::Div => unary(rows, i, |a| b / a),
                _ => unreachable!("only differences and quotients are compiled reversed"),
            }
        }
        Op::IfLe => ternary(rows, i, |a, b, c| {
            Lanes(core::array::from_fn(|k| if a.0[k] <= b.0[k] { c.0[k] } else { 0.0 }))
        }),
        Op::IfGt => ternary(rows, i, |a, b, c| {
            Lanes(core::array::from_fn(|k| if a.0[k] <= b.0[k] { 0.0 } else { c.0[k] }))
        }),
        Op::MulAdd => ternary(rows, i, |a, b, c| a * b + c),
        Op::MulSub => ternary(rows, i, |a, b, c| a * b - c),
        Op::SubMul => ternary(rows, i, |a, b, c| c - a * b),
        Op::MulAddUniform => {
            let c = u(i.c);
            binary(rows, i, |a, b| a * b + c);
        }
        Op::ScaleAdd => {
            let b = u(i.b);
            binary_ac(rows, i, |a, c| a * b + c);
        }
        Op::ScaleAddUniform => {
            let (b, c) = (u(i.b), u(i.c));
            unary(rows, i, |a| a * b + c);
        }
        Op::SquareAdd => binary_ac(rows, i, |a, c| a * a + c),
    }
}

fn execute_unary(operation: Unary, i: &Instruction, rows: &Rows<'_>) {
    match operation {
        Unary::Neg => unary(rows, i, |a| -a),
        Unary::Square => unary(rows, i, |a| a * a),
        Unary::Sqrt => unary(rows, i, Lanes::sqrt),
        Unary::Abs => unary(rows, i, Lanes::abs),
        Unary::Sign => unary(rows, i, |a| a.map(functions::sign)),
        Unary::Floor => unary(rows, i, |a| a.map(functions::floor)),
        Unary::Cbrt => long(rows, i, functions::cbrt_all),
        Unary::Exp => long(rows, i, functions::exp_all),
        Unary::Ln => long(rows, i, functions::ln_all),
        Unary::Log10 => long(rows, i, functions::log10_all),
        Unary::Sin => long(rows, i, functions::sin_all),
        Unary::Cos => long(rows, i, functions::cos_all),
        Unary::Tan => long(rows, i, functions::tan_all),
        Unary::Asin => long(rows, i, functions::asin_all),
        Unary::Acos => long(rows, i, functions::acos_all),
        Unary::Atan => long(rows, i, functions::atan_all),
        Unary::Sinh => long(rows, i, functions::sinh_all),
        Unary::Cosh => long(rows, i, functions::cosh_all),
        Unary::Tanh => long(rows, i, functions::tanh_all),
    }
}

/// Stores result 0 as the value.
pub(super) struct Values<'a>(pub(super) &'a mut [f32]);

impl Sink for Values<'_> {
    fn store(&mut self, first: usize, count: usize, outputs: &Outputs<'_>) {
        for (lane, chunk) in self.0[first..first + count].chunks_mut(LANES).enumerate() {
            chunk.copy_from_slice(&outputs.lanes(0, lane).0[..chunk.len()]);
        }
    }
}

/// Stores results 0 … 3 as value and gradient.
pub(super) struct Gradients<'a> {
    pub(super) value: &'a mut [f32],
    pub(super) gradient: &'a mut [Vec3],
}

impl Sink for Gradients<'_> {
    fn store(&mut self, first: usize, count: usize, outputs: &Outputs<'_>) {
        Values(self.value).store(first, count, outputs);
        let (whole, rest) = self.gradient[first..first + count].as_chunks_mut::<LANES>();
        for (lane, chunk) in whole.iter_mut().enumerate() {
            let [x, y, z] = [1, 2, 3].map(|n| outputs.lanes(n, lane).0);
            for (k, gradient) in chunk.iter_mut().enumerate() {
                *gradient = Vec3::new(x[k], y[k], z[k]);
            }
        }
        let lane = whole.len();
        if !rest.is_empty() {
            let [x, y, z] = [1, 2, 3].map(|n| outputs.lanes(n, lane).0);
            for (k, gradient) in rest.iter_mut().enumerate() {
                *gradient = Vec3::new(x[k], y[k], z[k]);
            }
        }
    }
}

/// Stores results 0 … 9 as value, gradient and Hessian (xx, xy, xz, yy, yz, zz).
pub(super) struct Hessians<'a> {
    pub(super) value: &'a mut [f32],
    pub(super) gradient: &'a mut [Vec3],
    pub(super) hessian: &'a mut [Sym3<f32>],
}

impl Sink for Hessians<'_> {
    fn store(&mut self, first: usize, count: usize, outputs: &Outputs<'_>) {
        Gradients { value: self.value, gradient: self.gradient }.store(first, count, outputs);
        for (lane, chunk) in self.hessian[first..first + count].chunks_mut(LANES).enumerate() {
            let [xx, xy, xz, yy, yz, zz] = [4, 5, 6, 7, 8, 9].map(|n| outputs.lanes(n, lane).0);
            for (k, hessian) in chunk.iter_mut().enumerate() {
                *hessian = Sym3 { xx: xx[k], xy: xy[k], xz: xz[k], yy: yy[k], yz: yz[k], zz: zz[k] };
            }
        }
    }
}
