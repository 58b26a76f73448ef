//! Floors, folded angles and ridges as choices.
//!
//! In a box ⌊u⌋ takes few values. It then becomes a chain of choices between them, by whether u has
//! reached the next one. asin(sin u) and acos(cos u) are folded lines: u or −u, shifted by a
//! multiple of π, between folds. So the search for creases finds the edges of roofs, triangle waves
//! and repeated cells like the edges of a minimum.
//!
//! |u|ᵖ with p < 2 has a ridge at u = 0: its slope jumps or its curvature has no bound, and neither
//! uᵖ nor (−u)ᵖ continues beyond it. Close to 0 its tangent replaces it, so that the ridge is a
//! crease between two functions that are defined on both sides.

use super::compiled::Compiled;
use super::graph::{Blend, Graph, Id, MIN_BLEND_WIDTH, Node};
use super::interval;
use super::operations::{Binary, Unary};
use crate::math::{Bounds, Interval};
use core::f64::consts::PI;

/// Maximum number of steps of a node in the enlarged box. A node with more stays as it is.
const MOST_STEPS: f64 = 64.0;
/// Margin around the box in which the choices still give f, as a share of its longest side: a
/// coarse front marches some spacings beyond the box.
const MARGIN: f64 = 0.5;
/// Half-width of the strip in which a power is straight, as a share of the largest |u|.
const STRIP: f64 = 1e-6;

/// The graph of f with its floors, folds and ridges as choices, equal to f in and around the box;
/// none if f has none, or only some with too many steps.
pub(super) fn as_choices(f: &Compiled, values: &[f64], bounds: &Bounds) -> Option<(Graph, Id)> {
    let graph = &*f.graph;
    let nodes = graph.needed_by(&[f.root]);
    if !nodes.iter().any(|&id| Fold::of(graph, id).is_some() || Ridge::of(graph, id).is_some()) {
        return None;
    }
    let around = bounds.enlarged(MARGIN * bounds.size().max_element());
    let mut ranges = Vec::new();
    interval::bounds(graph, &nodes, values, &around, &mut ranges);
    let (mut other, mut map, mut is_new) = (Graph::default(), vec![0; graph.len()], false);
    for id in nodes {
        let range = |id: Id| ranges[id as usize].at(0).bounds;
        let new = |id: Id| map[id as usize];
        let choice = if let Some(fold) = Fold::of(graph, id) {
            fold.chain(&mut other, new(fold.argument()), range(fold.argument()))
        } else if let Some(ridge) = Ridge::of(graph, id) {
            ridge.straight(&mut other, new, range)
        } else {
            None
        };
        is_new |= choice.is_some();
        let plain = graph.node(id).mapped(|operand| map[operand as usize]);
        map[id as usize] = choice.unwrap_or_else(|| other.intern(plain));
    }
    let root = map[f.root as usize];
    is_new.then_some((other, root))
}

/// A function of u with steps or folds at equal distances.
#[derive(Clone, Copy)]
enum Fold {
    /// ⌊u⌋.
    Floor(Id),
    /// asin(sin u).
    Sine(Id),
    /// acos(cos u).
    Cosine(Id),
}

impl Fold {
    fn of(graph: &Graph, id: Id) -> Option<Self> {
        let fold = match graph.node(id) {
            Node::Unary(Unary::Floor, u) => Self::Floor(u),
            Node::Unary(Unary::Asin, inner) => match graph.node(inner) {
                Node::Unary(Unary::Sin, u) => Self::Sine(u),
                _ => return None,
            },
            Node::Unary(Unary::Acos, inner) => match graph.node(inner) {
                Node::Unary(Unary::Cos, u) => Self::Cosine(u),
                _ => return None,
            },
            _ => return None,
        };
        (!graph.is_uniform(fold.argument())).then_some(fold)
    }

    fn argument(self) -> Id {
        let (Self::Floor(u) | Self::Sine(u) | Self::Cosine(u)) = self;
        u
    }

    /// The place of step k: from it to the next one the function is [piece](Self::piece) k.
    fn step(self, k: f64) -> f64 {
        match self {
            Self::Floor(_) => k,
            Self::Sine(_) => (k - 0.5) * PI,
            Self::Cosine(_) => k * PI,
        }
    }

    /// The number of the piece at a value of u.
    fn number(self, u: f64) -> f64 {
        let steps = match self {
            Self::Floor(_) => u,
            Self::Sine(_) => u / PI + 0.5,
            Self::Cosine(_) => u / PI,
        };
        libm::floor(steps)
    }

    /// The function between step k and the next one.
    fn piece(self, graph: &mut Graph, u: Id, k: f64) -> Id {
        let is_even = k % 2.0 == 0.0;
        let (number, turn) = match self {
            Self::Floor(_) => return graph.constant(k),
            Self::Sine(_) => (k * PI, is_even),
            Self::Cosine(_) => (if is_even { k } else { k + 1.0 } * PI, is_even),
        };
        let number = graph.constant(number);
        if turn { graph.sub(u, number) } else { graph.sub(number, u) }
    }

    /// The function over a range of u as a chain of choices; none if it has too many steps there.
    fn chain(self, graph: &mut Graph, u: Id, range: Interval) -> Option<Id> {
        let [first, last] = [range.lo, range.hi].map(|end| self.number(end));
        // Written so that an infinite range has too many.
        let is_short = last - first <= MOST_STEPS;
        if !is_short {
            return None;
        }
        let mut chain = self.piece(graph, u, last);
        let mut k = last;
        while k > first {
            let step = graph.constant(self.step(k));
            let before = self.piece(graph, u, k - 1.0);
            chain = graph.select(step, u, chain, before);
            k -= 1.0;
        }
        Some(chain)
    }
}

/// The power (factor · |u|ⁿ)ᵉ, with an exponent that depends on no coordinate.
struct Ridge {
    factor: f64,
    u: Id,
    n: f64,
    exponent: Exponent,
}

#[derive(Clone, Copy)]
enum Exponent {
    Number(f64),
    Node(Id),
}

impl Ridge {
    fn of(graph: &Graph, id: Id) -> Option<Self> {
        let (mut base, exponent) = match graph.node(id) {
            Node::Unary(Unary::Sqrt, base) => (base, Exponent::Number(1.0 / 2.0)),
            Node::Unary(Unary::Cbrt, base) => (base, Exponent::Number(1.0 / 3.0)),
            Node::Binary(Binary::Pow, base, exponent) if graph.is_uniform(exponent) => {
                (base, Exponent::Node(exponent))
            }
            _ => return None,
        };
        let mut factor = 1.0;
        while let Node::Binary(operation @ (Binary::Mul | Binary::Div), v, number) = graph.node(base)
            && let Some(number) = graph.as_constant(number)
        {
            factor = if operation == Binary::Mul { factor * number } else { factor / number };
            base = v;
        }
        let (u, n) = match graph.node(base) {
            Node::Unary(Unary::Abs, u) => (u, 1.0),
            Node::Power(u, n) if n > 0 && n % 2 == 0 => (u, f64::from(n)),
            _ => return None,
        };
        (factor > 0.0 && !graph.is_uniform(u)).then_some(Self { factor, u, n, exponent })
    }

    /// The power as a function of w = |u| that is defined for negative w, too: with p = n · e it is
    /// wᵖ above a small δ, and below δ the tangent there. None if p is not between 0 and 2, or is
    /// 1.
    fn straight(
        self,
        graph: &mut Graph,
        map: impl Fn(Id) -> Id,
        range: impl Fn(Id) -> Interval,
    ) -> Option<Id> {
        let (value, exponent) = match self.exponent {
            Exponent::Number(e) => (e, graph.constant(e)),
            Exponent::Node(id) => (range(id).middle(), map(id)),
        };
        let p = self.n * value;
        let Interval { lo, hi } = range(self.u);
        // Wide enough for a blend.
        let delta = (STRIP * lo.abs().max(hi.abs())).max(2.0 * MIN_BLEND_WIDTH);
        if !(p > 0.0 && p < 2.0 && (p - 1.0).abs() > STRIP && delta.is_finite()) {
            return None;
        }
        let n = graph.constant(self.n);
        let p = graph.mul(exponent, n);
        let [zero, one, delta] = [0.0, 1.0, delta].map(|number| graph.constant(number));
        let size = graph.unary(Unary::Abs, map(self.u));
        let beyond = graph.sub(size, delta);
        let below = graph.smin(Blend::Cubic, beyond, zero, delta);
        let above = graph.sub(size, below);
        let power = graph.pow(above, p);
        let less = graph.sub(p, one);
        let slope = graph.pow(delta, less);
        let slope = graph.mul(p, slope);
        let line = graph.mul(slope, below);
        let sum = graph.add(power, line);
        let factor = graph.constant(self.factor);
        let factor = graph.pow(factor, exponent);
        Some(graph.mul(sum, factor))
    }
}
