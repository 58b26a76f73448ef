//! Interpreter of a program over points, a block at a time.
//!
//! A register holds up to [`BLOCK`] × 8 points, which spreads the cost of decoding an instruction over many points. The
//! same IEEE operations are applied in every lane, so the result at a point does not depend on the other points.

use super::graph::whole_power;
use super::operations::{Binary, Unary};
use super::program::{Instruction, Op, Program};
use crate::math::functions;
use crate::math::{LANES, Lanes};
use core::cell::Cell;
use glam::Vec3;

/// Maximum number of [`Lanes`], of eight points each, in a block.
pub(super) const BLOCK: usize = 16;

/// Intended maximum size of the register file in bytes: half of a small first-level cache.
const FILE_BYTES: usize = 16 * 1024;

/// Evaluates `program` at `points`, and calls `store` with the index of each and the first `N` results there. `file` is the memory of the
/// registers, which grows as needed and is reused.
pub(super) fn run<const N: usize>(
    program: &Program,
    file: &mut Vec<Lanes>,
    points: &[Vec3],
    mut store: impl FnMut(usize, [f32; N]),
) {
    let bytes_per_group = size_of::<Lanes>() * program.registers.max(1);
    let stride = (FILE_BYTES / bytes_per_group).clamp(1, BLOCK);
    let needed = stride * program.registers;
    if file.len() < needed {
        file.resize(needed, Lanes::default());
    }
    let file = &mut file[..needed];
    let mut first = 0;
    for block in points.chunks(stride * LANES) {
        let groups = block.len().div_ceil(LANES);
        for (axis, register) in program.coordinates.iter().enumerate() {
            if let Some(register) = register {
                load(&mut file[*register as usize * stride..][..groups], block, axis);
            }
        }
        let cells = Cell::from_mut(&mut *file).as_slice_of_cells();
        for instruction in &program.instructions {
            execute(instruction, &program.uniforms, &RegisterCells { cells, stride, groups });
        }
        for (group, points) in block.chunks(LANES).enumerate() {
            let results: [Lanes; N] =
                core::array::from_fn(|n| file[program.outputs[n] as usize * stride + group]);
            (0..points.len()).for_each(|lane| store(first + lane, results.map(|lanes| lanes.0[lane])));
            first += points.len();
        }
    }
}

/// Loads one coordinate of every point. The last lanes are padded with the last point.
fn load(register: &mut [Lanes], points: &[Vec3], axis: usize) {
    let (whole, rest) = points.as_chunks::<LANES>();
    for (lanes, points) in register.iter_mut().zip(whole) {
        *lanes = Lanes(core::array::from_fn(|k| points[k][axis]));
    }
    if let (Some(last), Some(lanes)) = (rest.len().checked_sub(1), register.get_mut(whole.len())) {
        *lanes = Lanes(core::array::from_fn(|k| rest[k.min(last)][axis]));
    }
}

/// The register file as cells, since the result of an instruction may replace one of its operands.
struct RegisterCells<'a> {
    cells: &'a [Cell<Lanes>],
    /// Distance between registers in the file.
    stride: usize,
    /// Number of [`Lanes`] in use of each register.
    groups: usize,
}

impl<'a> RegisterCells<'a> {
    #[inline]
    fn get(&self, register: u32) -> &'a [Cell<Lanes>] {
        &self.cells[register as usize * self.stride..][..self.groups]
    }

    /// Sets a register to the numbers of a buffer.
    fn set(&self, register: u32, buffer: &[f32; BLOCK * LANES]) {
        for (out, chunk) in self.get(register).iter().zip(buffer.as_chunks().0) {
            out.set(Lanes(*chunk));
        }
    }
}

/// A buffer that begins with the numbers of `lanes`.
fn copied(lanes: impl Iterator<Item = Lanes>) -> [f32; BLOCK * LANES] {
    let mut buffer = [0.0; BLOCK * LANES];
    for (chunk, lanes) in buffer.as_chunks_mut().0.iter_mut().zip(lanes) {
        *chunk = lanes.0;
    }
    buffer
}

fn unary(registers: &RegisterCells<'_>, i: &Instruction, f: impl Fn(Lanes) -> Lanes) {
    for (out, a) in registers.get(i.out).iter().zip(registers.get(i.a)) {
        out.set(f(a.get()));
    }
}

fn binary(registers: &RegisterCells<'_>, i: &Instruction, f: impl Fn(Lanes, Lanes) -> Lanes) {
    for ((out, a), b) in registers.get(i.out).iter().zip(registers.get(i.a)).zip(registers.get(i.b)) {
        out.set(f(a.get(), b.get()));
    }
}

/// Applies a long function `f` to a copy of the register, in one loop that the compiler vectorises. A function pointer,
/// called once per register, keeps a single copy of this code.
fn long(registers: &RegisterCells<'_>, i: &Instruction, f: fn(&mut [f32])) {
    let mut buffer = copied(registers.get(i.a).iter().map(Cell::get));
    f(&mut buffer[..registers.groups * LANES]);
    registers.set(i.out, &buffer);
}

/// Computes sine and cosine together.
fn sine_cosine(registers: &RegisterCells<'_>, i: &Instruction) {
    let mut sine = copied(registers.get(i.a).iter().map(Cell::get));
    let mut cosine = [0.0; BLOCK * LANES];
    let length = registers.groups * LANES;
    functions::sin_cos_all(&mut sine[..length], &mut cosine[..length]);
    registers.set(i.out, &sine);
    registers.set(i.b, &cosine);
}

/// Applies a long function of two operands; see [`long`].
fn long_binary(
    registers: &RegisterCells<'_>,
    i: &Instruction,
    b: &dyn Fn(usize) -> Lanes,
    f: fn(&mut [f32], &[f32]),
) {
    let mut first = copied(registers.get(i.a).iter().map(Cell::get));
    let second = copied((0..registers.groups).map(b));
    let length = registers.groups * LANES;
    f(&mut first[..length], &second[..length]);
    registers.set(i.out, &first);
}

/// Largest exponent of a parameter that is evaluated by products, which are faster than exp(b ln a). They are as accurate: eight factors err by
/// seven roundings, which is 4·10⁻⁷ at most; thirty were found to err by 1.1·10⁻⁶.
const MAX_SMALL_INTEGER: f32 = 8.0;

/// `exponent` as an integer, if it is a small one other than 0. The exponents of parameters often are.
fn small_integer(exponent: f32) -> Option<i32> {
    let small =
        exponent != 0.0 && exponent.abs() <= MAX_SMALL_INTEGER && functions::floor(exponent) == exponent;
    #[expect(clippy::cast_possible_truncation, reason = "a small integer")]
    small.then_some(exponent as i32)
}

/// a^n. For n < 0 the reciprocal is raised to −n.
fn integer_power(a: Lanes, n: i32) -> Lanes {
    let one = Lanes::splat(1.0);
    whole_power(one, if n < 0 { one / a } else { a }, n.unsigned_abs())
}

fn execute(i: &Instruction, uniforms: &[f32], registers: &RegisterCells<'_>) {
    let u = |operand: u32| Lanes::splat(uniforms[operand as usize]);
    match i.op {
        Op::Splat => {
            let value = u(i.a);
            registers.get(i.out).iter().for_each(|out| out.set(value));
        }
        Op::Unary(operation) => execute_unary(operation, i, registers),
        Op::Reciprocal => unary(registers, i, |a| Lanes::splat(1.0) / a),
        Op::SineCosine => sine_cosine(registers, i),
        Op::Binary(Binary::Add) => binary(registers, i, |a, b| a + b),
        Op::Binary(Binary::Sub) => binary(registers, i, |a, b| a - b),
        Op::Binary(Binary::Mul) => binary(registers, i, |a, b| a * b),
        Op::Binary(Binary::Div) => binary(registers, i, |a, b| a / b),
        Op::Binary(Binary::Min) => binary(registers, i, |a, b| a.zip(b, functions::min)),
        Op::Binary(Binary::Max) => binary(registers, i, |a, b| a.zip(b, functions::max)),
        Op::Binary(Binary::Pow) => {
            let b = registers.get(i.b);
            long_binary(registers, i, &|k| b[k].get(), functions::pow_all);
        }
        Op::Binary(Binary::Atan2) => {
            let b = registers.get(i.b);
            long_binary(registers, i, &|k| b[k].get(), functions::atan2_all);
        }
        Op::Uniform(operation) => {
            let b = u(i.b);
            match operation {
                Binary::Add => unary(registers, i, |a| a + b),
                Binary::Mul => unary(registers, i, |a| a * b),
                Binary::Min => unary(registers, i, |a| a.zip(b, functions::min)),
                Binary::Max => unary(registers, i, |a| a.zip(b, functions::max)),
                Binary::Pow => match small_integer(uniforms[i.b as usize]) {
                    Some(n) => unary(registers, i, |a| integer_power(a, n)),
                    None => long_binary(registers, i, &|_| b, functions::pow_all),
                },
                Binary::Sub | Binary::Div | Binary::Atan2 => unreachable!("never compiled with a uniform"),
            }
        }
        Op::Reversed(operation) => {
            let b = u(i.b);
            match operation {
                Binary::Sub => unary(registers, i, |a| b - a),
                Binary::Div => unary(registers, i, |a| b / a),
                _ => unreachable!("only differences and quotients are compiled reversed"),
            }
        }
        Op::If(at_most) => {
            let [a, b, c] = [i.a, i.b, i.c].map(|operand| registers.get(operand));
            for (k, out) in registers.get(i.out).iter().enumerate() {
                let [a, b, c] = [a, b, c].map(|operand| operand[k].get().0);
                let value = |k: usize| if (a[k] <= b[k]) == at_most { c[k] } else { 0.0 };
                out.set(Lanes(core::array::from_fn(value)));
            }
        }
    }
}

fn execute_unary(operation: Unary, i: &Instruction, registers: &RegisterCells<'_>) {
    match operation {
        Unary::Neg => unary(registers, i, |a| -a),
        Unary::Sqrt => unary(registers, i, Lanes::sqrt),
        Unary::Abs => unary(registers, i, Lanes::abs),
        Unary::Sign => unary(registers, i, |a| a.map(functions::sign)),
        Unary::Floor => unary(registers, i, |a| a.map(functions::floor)),
        Unary::Cbrt => long(registers, i, functions::cbrt_all),
        Unary::Exp => long(registers, i, functions::exp_all),
        Unary::Ln => long(registers, i, functions::ln_all),
        Unary::Log10 => long(registers, i, functions::log10_all),
        Unary::Sin => long(registers, i, functions::sin_all),
        Unary::Cos => long(registers, i, functions::cos_all),
        Unary::Tan => long(registers, i, functions::tan_all),
        Unary::Asin => long(registers, i, functions::asin_all),
        Unary::Acos => long(registers, i, functions::acos_all),
        Unary::Atan => long(registers, i, functions::atan_all),
        Unary::Sinh => long(registers, i, functions::sinh_all),
        Unary::Cosh => long(registers, i, functions::cosh_all),
        Unary::Tanh => long(registers, i, functions::tanh_all),
    }
}
