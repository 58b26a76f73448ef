//! Exact derivatives by transforming the graph: the partial derivatives of a node are again nodes.
//!
//! The gradient comes from one backward sweep (each operation passes its adjoint to its operands) or from three
//! forward sweeps, the Hessian from forward or backward sweeps over the gradient; hash-consing shares what the
//! sweeps have in common, and the caller keeps the cheaper result. Being graphs of the same kind, derivatives are
//! evaluated by the same code as the field itself, without a single multiplication by a known zero.
//!
//! At a kink the rules choose one side: abs and sign have slope 0 at 0, min and max take the first operand's slope
//! at a tie, floor and sign have slope 0 everywhere.

use super::graph::{Graph, Id, Node, SMIN_LEAST_WIDTH};
use super::operations::{Binary, Unary};

/// ∂root/∂(x, y, z), by a backward sweep.
pub(super) fn backward(graph: &mut Graph, root: Id) -> [Id; 3] {
    let live = graph.live(&[root]);
    let one = graph.constant(1.0);
    let zero = graph.constant(0.0);
    let mut adjoint: Vec<Option<Id>> = vec![None; live.len()];
    adjoint[root as usize] = Some(one);
    let mut gradient = [zero; 3];
    for id in (0..=root).rev() {
        let Some(seed) = adjoint[id as usize] else { continue };
        if !live[id as usize] || graph.is_uniform(id) {
            continue;
        }
        if let Node::Coordinate(axis) = graph.node(id) {
            gradient[usize::from(axis)] = seed;
            continue;
        }
        for (operand, share) in shares(graph, id, seed).into_iter().flatten() {
            let slot = &mut adjoint[operand as usize];
            *slot = Some(match *slot {
                None => share,
                Some(before) => graph.add(before, share),
            });
        }
    }
    gradient
}

/// ∂roots/∂(coordinate `axis`), by a forward sweep.
pub(super) fn forward(graph: &mut Graph, roots: &[Id], axis: u8) -> Vec<Id> {
    let live = graph.live(roots);
    let zero = graph.constant(0.0);
    let one = graph.constant(1.0);
    let mut tangent: Vec<Id> = vec![zero; live.len()];
    for id in 0..u32::try_from(live.len()).unwrap_or(u32::MAX) {
        if !live[id as usize] || graph.axes(id) >> axis & 1 == 0 {
            continue;
        }
        tangent[id as usize] = match graph.node(id) {
            Node::Coordinate(_) => one,
            // A choice between branches chooses between their tangents, so that the branch not taken cannot spoil
            // the result, whatever its slope.
            Node::Binary(Binary::Min, a, b) => choose(graph, a, b, tangent[a as usize], tangent[b as usize]),
            Node::Binary(Binary::Max, a, b) => choose(graph, b, a, tangent[a as usize], tangent[b as usize]),
            Node::IfLe(a, b, v) => {
                let tangent = tangent[v as usize];
                graph.if_le(a, b, tangent)
            }
            Node::IfGt(a, b, v) => {
                let tangent = tangent[v as usize];
                graph.if_gt(a, b, tangent)
            }
            _ => {
                let mut total = zero;
                for (operand, slope) in shares(graph, id, one).into_iter().flatten() {
                    let product = graph.mul(slope, tangent[operand as usize]);
                    total = graph.add(total, product);
                }
                total
            }
        };
    }
    roots.iter().map(|&root| tangent[root as usize]).collect()
}

/// `first` where a ≤ b, else `second`.
fn choose(graph: &mut Graph, a: Id, b: Id, first: Id, second: Id) -> Id {
    if first == second {
        return first;
    }
    let first = graph.if_le(a, b, first);
    let second = graph.if_gt(a, b, second);
    graph.add(first, second)
}

/// What the operands of `id` receive of its adjoint `seed`: seed · ∂id/∂operand. Operands that no coordinate
/// reaches are left out.
fn shares(graph: &mut Graph, id: Id, seed: Id) -> [Option<(Id, Id)>; 3] {
    match graph.node(id) {
        Node::Constant(_) | Node::Parameter(_) | Node::Coordinate(_) => [None; 3],
        Node::Unary(operation, a) => [Some((a, unary(graph, operation, a, id, seed))), None, None],
        Node::Power(a, n) => {
            let lower = graph.power(a, n - 1);
            let exponent = graph.constant(f64::from(n));
            let scaled = graph.mul(seed, exponent);
            [Some((a, graph.mul(scaled, lower))), None, None]
        }
        Node::Binary(operation, a, b) => binary(graph, operation, a, b, id, seed),
        Node::Smin(a, b, k) => smin(graph, a, b, k, seed),
        Node::IfLe(a, b, v) => [Some((v, graph.if_le(a, b, seed))), None, None],
        Node::IfGt(a, b, v) => [Some((v, graph.if_gt(a, b, seed))), None, None],
    }
}

/// seed · d(operation(a))/da, where `id` is operation(a).
fn unary(graph: &mut Graph, operation: Unary, a: Id, id: Id, seed: Id) -> Id {
    match operation {
        Unary::Neg => graph.neg(seed),
        Unary::Square => {
            let two = graph.constant(2.0);
            let slope = graph.mul(a, two);
            graph.mul(seed, slope)
        }
        Unary::Sqrt => {
            let half = graph.constant(0.5);
            let scaled = graph.mul(seed, half);
            graph.div(scaled, id)
        }
        Unary::Cbrt => {
            let third = graph.constant(1.0 / 3.0);
            let scaled = graph.mul(seed, third);
            let square = graph.power(id, 2);
            graph.div(scaled, square)
        }
        Unary::Abs => {
            let sign = graph.unary(Unary::Sign, a);
            graph.mul(seed, sign)
        }
        Unary::Sign | Unary::Floor => graph.constant(0.0),
        Unary::Exp => graph.mul(seed, id),
        Unary::Ln => graph.div(seed, a),
        Unary::Log10 => {
            let scale = graph.constant(core::f64::consts::LOG10_E);
            let scaled = graph.mul(seed, scale);
            graph.div(scaled, a)
        }
        Unary::Sin => {
            let slope = graph.unary(Unary::Cos, a);
            graph.mul(seed, slope)
        }
        Unary::Cos => {
            let sine = graph.unary(Unary::Sin, a);
            let product = graph.mul(seed, sine);
            graph.neg(product)
        }
        Unary::Tan => {
            let slope = one_plus_square(graph, id);
            graph.mul(seed, slope)
        }
        Unary::Asin | Unary::Acos => {
            let square = graph.power(a, 2);
            let one = graph.constant(1.0);
            let rest = graph.sub(one, square);
            let root = graph.unary(Unary::Sqrt, rest);
            let slope = graph.div(seed, root);
            if operation == Unary::Asin { slope } else { graph.neg(slope) }
        }
        Unary::Atan => {
            let denominator = one_plus_square(graph, a);
            graph.div(seed, denominator)
        }
        Unary::Sinh => {
            let slope = graph.unary(Unary::Cosh, a);
            graph.mul(seed, slope)
        }
        Unary::Cosh => {
            let slope = graph.unary(Unary::Sinh, a);
            graph.mul(seed, slope)
        }
        Unary::Tanh => {
            let square = graph.power(id, 2);
            let one = graph.constant(1.0);
            let slope = graph.sub(one, square);
            graph.mul(seed, slope)
        }
    }
}

fn one_plus_square(graph: &mut Graph, a: Id) -> Id {
    let square = graph.power(a, 2);
    let one = graph.constant(1.0);
    graph.add(square, one)
}

fn binary(graph: &mut Graph, operation: Binary, a: Id, b: Id, id: Id, seed: Id) -> [Option<(Id, Id)>; 3] {
    let varies = |graph: &Graph, id| !graph.is_uniform(id);
    let (of_a, of_b) = (varies(graph, a), varies(graph, b));
    let (to_a, to_b);
    match operation {
        Binary::Add => (to_a, to_b) = (Some(seed), Some(seed)),
        Binary::Sub => (to_a, to_b) = (Some(seed), of_b.then(|| graph.neg(seed))),
        Binary::Mul => {
            to_a = of_a.then(|| graph.mul(seed, b));
            to_b = of_b.then(|| graph.mul(seed, a));
        }
        Binary::Div => {
            let share = graph.div(seed, b);
            to_a = Some(share);
            to_b = of_b.then(|| {
                let product = graph.mul(share, id);
                graph.neg(product)
            });
        }
        Binary::Min => {
            to_a = of_a.then(|| graph.if_le(a, b, seed));
            to_b = of_b.then(|| graph.if_gt(a, b, seed));
        }
        // max(a, b) is a where b ≤ a.
        Binary::Max => {
            to_a = of_a.then(|| graph.if_le(b, a, seed));
            to_b = of_b.then(|| graph.if_gt(b, a, seed));
        }
        Binary::Pow => {
            to_a = of_a.then(|| {
                let one = graph.constant(1.0);
                let lower = graph.sub(b, one);
                let power = graph.pow(a, lower);
                let slope = graph.mul(power, b);
                graph.mul(seed, slope)
            });
            to_b = of_b.then(|| {
                let logarithm = graph.unary(Unary::Ln, a);
                let slope = graph.mul(id, logarithm);
                graph.mul(seed, slope)
            });
        }
        // d atan2(a, b) = (b da − a db)/(a² + b²)
        Binary::Atan2 => {
            let (aa, bb) = (graph.power(a, 2), graph.power(b, 2));
            let sum = graph.add(aa, bb);
            let share = graph.div(seed, sum);
            to_a = of_a.then(|| graph.mul(share, b));
            to_b = of_b.then(|| {
                let product = graph.mul(share, a);
                graph.neg(product)
            });
        }
    }
    [to_a.filter(|_| of_a).map(|share| (a, share)), to_b.filter(|_| of_b).map(|share| (b, share)), None]
}

/// With u = (a − b)/k cut to −1 … 1 and w = u − u|u|/2, the slopes of the smooth minimum are ½ − w in a, ½ + w in
/// b and u²/2 − |u|³/3 − 1/6 in k: no branch, and smooth where a = b.
fn smin(graph: &mut Graph, a: Id, b: Id, k: Id, seed: Id) -> [Option<(Id, Id)>; 3] {
    let (of_a, of_b, of_k) = (!graph.is_uniform(a), !graph.is_uniform(b), !graph.is_uniform(k));
    let least = graph.constant(SMIN_LEAST_WIDTH);
    let width = graph.binary(Binary::Max, k, least);
    let difference = graph.sub(a, b);
    let ratio = graph.div(difference, width);
    let (one, minus_one, half) = (graph.constant(1.0), graph.constant(-1.0), graph.constant(0.5));
    let below = graph.binary(Binary::Min, ratio, one);
    let u = graph.binary(Binary::Max, below, minus_one);
    let magnitude = graph.unary(Unary::Abs, u);
    let square = graph.mul(u, magnitude);
    let bend = graph.mul(square, half);
    let w = graph.sub(u, bend);
    let to_a = of_a.then(|| {
        let slope = graph.sub(half, w);
        (a, graph.mul(seed, slope))
    });
    let to_b = of_b.then(|| {
        let slope = graph.add(w, half);
        (b, graph.mul(seed, slope))
    });
    let to_k = of_k.then(|| {
        let (third, sixth) = (graph.constant(1.0 / 3.0), graph.constant(1.0 / 6.0));
        let (uu, uuu) = (graph.power(u, 2), graph.mul(square, u));
        let (uu, uuu) = (graph.mul(uu, half), graph.mul(uuu, third));
        let rise = graph.sub(uu, uuu);
        let slope = graph.sub(rise, sixth);
        // Below the least width the minimum does not depend on k.
        let slope = graph.mul(seed, slope);
        (k, graph.if_le(least, k, slope))
    });
    [to_a, to_b, to_k]
}
