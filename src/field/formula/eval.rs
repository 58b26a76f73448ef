//! Interpreter of a program over points, a block at a time.
//!
//! A register holds up to [`BLOCK`] × 8 points, which spreads the cost of decoding an instruction
//! over many points. The same IEEE operations are applied in every lane, so the result at a point
//! does not depend on the other points.

use super::graph::whole_power;
use super::operations::{Binary, Unary};
use super::program::{Instruction, Op, Program};
use crate::field::BATCH;
use crate::math::functions;
use crate::math::{LANES, Lanes};
use core::cell::Cell;
use core::iter::repeat;
use glam::Vec3;

/// Maximum number of [`Lanes`] in a block: one batch.
pub(super) const BLOCK: usize = BATCH / LANES;

/// Intended maximum size of the register file in bytes: half of a small first-level cache.
const FILE_BYTES: usize = 16 * 1024;

/// Evaluates `program` at `points`. For every eight points, `store` gets the index of the first and
/// the first `N` results at all of them. `file` is the memory of the registers, which grows as
/// needed and is reused.
pub(super) fn run<const N: usize>(
    program: &Program,
    file: &mut Vec<Lanes>,
    points: &[Vec3],
    mut store: impl FnMut(usize, [&Lanes; N]),
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
        for group in 0..groups {
            store(first, core::array::from_fn(|n| &file[program.outputs[n] as usize * stride + group]));
            first += LANES;
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
}

fn unary(registers: &RegisterCells<'_>, i: &Instruction, f: impl Fn(Lanes) -> Lanes) {
    for (out, a) in registers.get(i.out).iter().zip(registers.get(i.a)) {
        out.set(f(a.get()));
    }
}

/// Applies an operation to pairs of operands, group by group.
fn binary(
    operation: Binary,
    out: &[Cell<Lanes>],
    a: impl Iterator<Item = Lanes>,
    b: impl Iterator<Item = Lanes>,
) {
    let groups = out.iter().zip(a.zip(b));
    match operation {
        Binary::Add => groups.for_each(|(out, (a, b))| out.set(a + b)),
        Binary::Sub => groups.for_each(|(out, (a, b))| out.set(a - b)),
        Binary::Mul => groups.for_each(|(out, (a, b))| out.set(a * b)),
        Binary::Div => groups.for_each(|(out, (a, b))| out.set(a / b)),
        Binary::Min => groups.for_each(|(out, (a, b))| out.set(a.zip(b, functions::min))),
        Binary::Max => groups.for_each(|(out, (a, b))| out.set(a.zip(b, functions::max))),
        Binary::Pow => groups.for_each(|(out, (a, b))| out.set(a.zip(b, functions::pow))),
        Binary::Atan2 => groups.for_each(|(out, (a, b))| out.set(a.zip(b, functions::atan2))),
    }
}

/// Computes sine and cosine together.
fn sine_cosine(registers: &RegisterCells<'_>, i: &Instruction) {
    for ((sine, cosine), a) in registers.get(i.out).iter().zip(registers.get(i.b)).zip(registers.get(i.a)) {
        let mut results = [Lanes::default(); 2];
        let [sines, cosines] = &mut results;
        for ((sine, cosine), angle) in sines.0.iter_mut().zip(&mut cosines.0).zip(a.get().0) {
            (*sine, *cosine) = functions::sin_cos(angle);
        }
        sine.set(results[0]);
        cosine.set(results[1]);
    }
}

/// Largest exponent of a parameter that is evaluated by products, which are faster than exp(b ln
/// a). They are as accurate: eight factors err by seven roundings, which is 4·10⁻⁷ at most.
const MAX_SMALL_INTEGER: f32 = 8.0;

/// `exponent` as an integer, if it is small and not 0, as the exponents of parameters often are.
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
        Op::SineCosine => sine_cosine(registers, i),
        Op::Binary(operation) => {
            let (a, b) = (registers.get(i.a), registers.get(i.b));
            binary(operation, registers.get(i.out), a.iter().map(Cell::get), b.iter().map(Cell::get));
        }
        Op::Uniform(Binary::Pow) if let Some(n) = small_integer(uniforms[i.b as usize]) => {
            unary(registers, i, |a| integer_power(a, n));
        }
        Op::Uniform(operation) => {
            let a = registers.get(i.a).iter().map(Cell::get);
            binary(operation, registers.get(i.out), a, repeat(u(i.b)));
        }
        Op::If(at_most) => {
            let (a, b, c) = (registers.get(i.a), registers.get(i.b), registers.get(i.c));
            for (k, out) in registers.get(i.out).iter().enumerate() {
                let (a, b, c) = (a[k].get().0, b[k].get().0, c[k].get().0);
                let value = |k: usize| {
                    let (below, above) = (a[k] <= b[k], a[k] > b[k]);
                    match if at_most { (below, above) } else { (above, below) } {
                        (true, _) => c[k],
                        (_, true) => 0.0,
                        _ => f32::NAN,
                    }
                };
                out.set(Lanes(core::array::from_fn(value)));
            }
        }
    }
}

fn execute_unary(operation: Unary, i: &Instruction, registers: &RegisterCells<'_>) {
    match operation {
        Unary::Neg => unary(registers, i, |a| -a),
        Unary::Limit => unary(registers, i, |a| a),
        Unary::Sqrt => unary(registers, i, Lanes::sqrt),
        Unary::Abs => unary(registers, i, Lanes::abs),
        Unary::Sign => unary(registers, i, |a| a.map(functions::sign)),
        Unary::Floor => unary(registers, i, |a| a.map(functions::floor)),
        Unary::Cbrt => unary(registers, i, |a| a.map(functions::cbrt)),
        Unary::Exp => unary(registers, i, |a| a.map(functions::exp)),
        Unary::Ln => unary(registers, i, |a| a.map(functions::ln)),
        Unary::Log10 => unary(registers, i, |a| a.map(functions::log10)),
        Unary::Sin => unary(registers, i, |a| a.map(functions::sin)),
        Unary::Cos => unary(registers, i, |a| a.map(functions::cos)),
        Unary::Tan => unary(registers, i, |a| a.map(functions::tan)),
        Unary::Asin => unary(registers, i, |a| a.map(functions::asin)),
        Unary::Acos => unary(registers, i, |a| a.map(functions::acos)),
        Unary::Atan => unary(registers, i, |a| a.map(functions::atan)),
        Unary::Sinh => unary(registers, i, |a| a.map(functions::sinh)),
        Unary::Cosh => unary(registers, i, |a| a.map(functions::cosh)),
        Unary::Tanh => unary(registers, i, |a| a.map(functions::tanh)),
        Unary::Asinh | Unary::Acosh | Unary::Atanh | Unary::Erf => {
            unary(registers, i, |a| a.map(|a| operation.evaluate(f64::from(a)) as f32));
        }
    }
}
