//! Jets of first and second order in double precision, carried forward through the graph of f.
//!
//! Forward accumulation shares no code with the graphs of the derivatives, so that tests can check
//! one by the other.

use super::graph::{Blend, Graph, Id, MIN_BLEND_WIDTH, Node, power, smin};
use super::operations::{Binary, Unary};
use crate::field::Jet;
use crate::math::Sym3;
use glam::DVec3;

/// Jet: value, gradient, and the first `N` entries of the Hessian in the order xx, xy, xz, yy, yz,
/// zz: all six, or none.
#[derive(Clone, Copy, Debug)]
pub(super) struct ForwardJet<const N: usize> {
    value: f64,
    first: [f64; 3],
    second: [f64; N],
}

/// Number of entries of a Hessian.
const ENTRIES: usize = 6;

/// Axes of the entries of the Hessian.
pub(super) const PAIRS: [(usize, usize); ENTRIES] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];

impl<const N: usize> ForwardJet<N> {
    fn uniform(value: f64) -> Self {
        Self { value, first: [0.0; 3], second: [0.0; N] }
    }

    /// Value and gradient.
    pub(super) fn first_order(&self) -> (f64, DVec3) {
        (self.value, DVec3::from_array(self.first))
    }

    /// Jet of f(self) by the chain rule, where f has the given value and first two derivatives.
    /// Derivatives along axes outside `axes` stay 0 even where f has an infinite derivative.
    fn apply(&self, [value, d1, d2]: [f64; 3], axes: u8) -> Self {
        let has = |k: usize| axes >> k & 1 == 1;
        let mut out = Self::uniform(value);
        for (k, first) in out.first.iter_mut().enumerate().filter(|(k, _)| has(*k)) {
            *first = d1 * self.first[k];
        }
        for ((i, j), (second, own)) in PAIRS.into_iter().zip(out.second.iter_mut().zip(self.second)) {
            if has(i) && has(j) {
                let curve = d2 * (self.first[i] * self.first[j]);
                *second = d1 * own + curve;
            }
        }
        out
    }

    fn add(&self, other: &Self) -> Self {
        Self {
            value: self.value + other.value,
            first: core::array::from_fn(|k| self.first[k] + other.first[k]),
            second: core::array::from_fn(|k| self.second[k] + other.second[k]),
        }
    }

    fn scale(&self, factor: f64) -> Self {
        Self {
            value: self.value * factor,
            first: self.first.map(|v| v * factor),
            second: self.second.map(|v| v * factor),
        }
    }

    fn mul(&self, other: &Self) -> Self {
        let mut out = Self::uniform(self.value * other.value);
        for k in 0..3 {
            out.first[k] = self.value * other.first[k] + other.value * self.first[k];
        }
        for (n, (i, j)) in PAIRS.into_iter().enumerate().take(N) {
            let crossed = self.first[i] * other.first[j] + self.first[j] * other.first[i];
            out.second[n] = self.value * other.second[n] + other.value * self.second[n] + crossed;
        }
        out
    }

    /// The quotient by a divisor that depends on `axes`. The rules for it divide by the divisor
    /// once: its square may overflow where the quotient does not.
    fn div(&self, divisor: &Self, axes: u8) -> Self {
        let has = |k: usize| axes >> k & 1 == 1;
        // An operand has derivative 0 along axes that it does not depend on, even where the rest is
        // infinite.
        let product = |k: usize, factor: f64, slope: f64| if has(k) { factor * slope } else { 0.0 };
        let mut out = Self::uniform(self.value / divisor.value);
        for k in 0..3 {
            out.first[k] = (self.first[k] - product(k, out.value, divisor.first[k])) / divisor.value;
        }
        for (n, (i, j)) in PAIRS.into_iter().enumerate().take(N) {
            let curve = if has(i) { product(j, out.value, divisor.second[n]) } else { 0.0 };
            let crossed =
                product(j, out.first[i], divisor.first[j]) + product(i, out.first[j], divisor.first[i]);
            out.second[n] = (self.second[n] - curve - crossed) / divisor.value;
        }
        out
    }
}

/// The jets of every node at some points, as [`jets`] writes them: with a Hessian of N entries, or
/// with none.
pub(super) type Jets<const N: usize, const POINTS: usize = 1> = Vec<[ForwardJet<N>; POINTS]>;

/// Jets up to second order at a point.
pub(super) type JetScratch = Jets<ENTRIES>;

impl ForwardJet<ENTRIES> {
    /// Value, gradient and Hessian.
    pub(super) fn second_order(&self) -> Jet {
        let (value, gradient) = self.first_order();
        let [xx, xy, xz, yy, yz, zz] = self.second;
        Jet { value, gradient, hessian: Sym3 { xx, xy, xz, yy, yz, zz } }
    }
}

/// Number of points for which [`jets`] visits each node once.
pub(super) const ABREAST: usize = 8;

/// Writes the jets of all nodes up to `root` at these points to `scratch`. The jets at one point do
/// not depend on the other points.
pub(super) fn jets<const N: usize, const POINTS: usize>(
    graph: &Graph,
    root: Id,
    parameters: &[f64],
    points: [DVec3; POINTS],
    scratch: &mut Jets<N, POINTS>,
) {
    let points = points.map(|p| p.to_array());
    scratch.clear();
    for (id, &node) in graph.nodes()[..=root as usize].iter().enumerate() {
        let axes = graph.axes(u32::try_from(id).unwrap_or(u32::MAX));
        let at = |id: Id| &scratch[id as usize];
        let both = |a: Id, b: Id, f: fn(&ForwardJet<N>, &ForwardJet<N>) -> ForwardJet<N>| {
            let (a, b) = (at(a), at(b));
            core::array::from_fn(|k| f(&a[k], &b[k]))
        };
        let results = match node {
            _ if axes == 0 => {
                let value = node.evaluate(parameters, points[0], |id| at(id)[0].value);
                [ForwardJet::uniform(value); POINTS]
            }
            Node::Binary(Binary::Add, a, b) => both(a, b, ForwardJet::add),
            Node::Binary(Binary::Sub, a, b) => both(a, b, |a, b| a.add(&b.scale(-1.0))),
            Node::Binary(Binary::Mul, a, b) => both(a, b, ForwardJet::mul),
            _ => core::array::from_fn(|k| {
                order(node, points[k], axes, |id| Operand { jet: at(id)[k], axes: graph.axes(id) })
            }),
        };
        scratch.push(results);
    }
}

/// Jet of an operand, and the axes that it depends on: bit k stands for axis k.
struct Operand<const N: usize> {
    jet: ForwardJet<N>,
    axes: u8,
}

/// Jet of a node that depends on `axes`.
fn order<const N: usize>(
    node: Node,
    point: [f64; 3],
    axes: u8,
    operand: impl Fn(Id) -> Operand<N>,
) -> ForwardJet<N> {
    match node {
        Node::Constant(_) | Node::Parameter(_) => ForwardJet::uniform(0.0),
        Node::Coordinate(axis) => {
            let mut out = ForwardJet::uniform(point[usize::from(axis)]);
            out.first[usize::from(axis)] = 1.0;
            out
        }
        Node::Unary(operation, a) => {
            let a = operand(a).jet;
            a.apply(operation.jet(a.value), axes)
        }
        Node::Power(a, n) => {
            let a = operand(a).jet;
            let degree = f64::from(n);
            // Saturation concerns exponents at the lower end of the range of i32 only.
            let d1 = degree * power(a.value, n.saturating_sub(1));
            let d2 = degree * (degree - 1.0) * power(a.value, n.saturating_sub(2));
            a.apply([power(a.value, n), d1, d2], axes)
        }
        Node::Binary(operation, a, b) => binary(operation, operand(a), operand(b), axes),
        Node::Smin(blend, a, b, k) => {
            smooth_minimum(blend, &operand(a).jet, &operand(b).jet, &operand(k).jet, axes)
        }
        Node::If(at_most, a, b, v) => {
            let (a, b, v) = (operand(a).jet.value, operand(b).jet.value, operand(v).jet);
            if a.is_nan() || b.is_nan() {
                v.scale(f64::NAN)
            } else if (a <= b) == at_most {
                v
            } else {
                ForwardJet::uniform(0.0)
            }
        }
        Node::Select(_, a, b, u, v) => {
            let (a, b) = (operand(a).jet.value, operand(b).jet.value);
            if a.is_nan() || b.is_nan() {
                ForwardJet::uniform(0.0).scale(f64::NAN)
            } else {
                operand(if a <= b { u } else { v }).jet
            }
        }
    }
}

fn binary<const N: usize>(
    operation: Binary,
    first: Operand<N>,
    second: Operand<N>,
    axes: u8,
) -> ForwardJet<N> {
    let (Operand { jet: a, axes: of_a }, Operand { jet: b, axes: of_b }) = (first, second);
    match operation {
        Binary::Add => a.add(&b),
        Binary::Sub => a.add(&b.scale(-1.0)),
        Binary::Mul => a.mul(&b),
        Binary::Div => a.div(&b, of_b),
        Binary::Min if a.value <= b.value => a,
        Binary::Max if a.value >= b.value => a,
        Binary::Min | Binary::Max if a.value.is_nan() || b.value.is_nan() => a.add(&b).scale(f64::NAN),
        Binary::Min | Binary::Max => b,
        Binary::Pow => {
            let value = operation.evaluate(a.value, b.value);
            let slope = |n: f64| operation.evaluate(a.value, b.value - n);
            let fixed = || {
                let d1 = b.value * slope(1.0);
                let d2 = b.value * (b.value - 1.0) * slope(2.0);
                a.apply([value, d1, d2], of_a)
            };
            if of_b == 0 {
                return fixed();
            }
            // With the exponent's value n, a^b = a^n exp((b − n) ln a).
            let change = ForwardJet { value: 0.0, ..b };
            if of_a == 0 {
                return change.scale(libm::log(a.value)).apply([value; 3], of_b);
            }
            let logarithm = a.apply(Unary::Ln.jet(a.value), of_a);
            let factor = change.mul(&logarithm).apply([1.0; 3], axes);
            ForwardJet { value, ..fixed().mul(&factor) }
        }
        Binary::Atan2 => {
            // Differentiates atan(a/b), or −atan(b/a) where that is better conditioned.
            let angle = operation.evaluate(a.value, b.value);
            let jet = if a.value.abs() <= b.value.abs() {
                let ratio = a.div(&b, of_b);
                ratio.apply(Unary::Atan.jet(ratio.value), axes)
            } else {
                let ratio = b.div(&a, of_a);
                ratio.apply(Unary::Atan.jet(ratio.value), axes).scale(-1.0)
            };
            ForwardJet { value: angle, ..jet }
        }
    }
}

/// Jet of the smooth minimum: (a + b)/2 − k (1/6 + u²/2 − |u|³/6) with u = (a − b)/k where |a − b|
/// < k, or (a + b)/2 − k (1/4 + u²/4), else the smaller of a and b.
fn smooth_minimum<const N: usize>(
    blend: Blend,
    a: &ForwardJet<N>,
    b: &ForwardJet<N>,
    k: &ForwardJet<N>,
    axes: u8,
) -> ForwardJet<N> {
    let value = smin(blend, a.value, b.value, k.value);
    let k = if k.value > MIN_BLEND_WIDTH { *k } else { ForwardJet::uniform(MIN_BLEND_WIDTH) };
    let difference = a.add(&b.scale(-1.0));
    let u = difference.div(&k, axes);
    if u.value >= 1.0 {
        return ForwardJet { value, ..*b };
    }
    if u.value <= -1.0 {
        return ForwardJet { value, ..*a };
    }
    let (u_value, size) = (u.value, u.value.abs());
    let depth = u.apply(
        match blend {
            Blend::Cubic => [
                1.0 / 6.0 + 0.5 * u_value * u_value - size * size * size / 6.0,
                u_value - 0.5 * u_value * size,
                1.0 - size,
            ],
            Blend::Quadratic => [0.25 + 0.25 * u_value * u_value, 0.5 * u_value, 0.5],
        },
        axes,
    );
    ForwardJet { value, ..a.add(b).scale(0.5).add(&k.mul(&depth).scale(-1.0)) }
}
