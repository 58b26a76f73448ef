//! Exact derivatives by graph transformation: the partial derivatives of a node are again nodes.
//!
//! The gradient comes from one backward (reverse-mode) sweep, in which each operation passes its
//! adjoint to its operands, or from three forward-mode sweeps. The Hessian comes from sweeps of
//! either kind over the gradient. Hash-consing shares the subexpressions that sweeps have in
//! common, and the caller keeps the cheaper result (A. Griewank & A. Walther, "Evaluating
//! Derivatives", 2008). Derivatives are graphs of the same kind as the field, so the same code
//! evaluates them; multiplications by a known zero are folded away.
//!
//! A kink has the derivative of one of its sides: abs has slope 0 at 0, min and max take the slope
//! of the first operand at a tie, floor and sign have slope 0 everywhere.

use super::graph::{Blend, Graph, Id, MIN_BLEND_WIDTH, Node};
use super::operations::{Binary, Unary};
use super::program::cost;

/// Nodes of ∇root, by the cheaper of one backward and three forward sweeps.
pub(super) fn gradient(graph: &mut Graph, root: Id) -> [Id; 3] {
    let backward = backward(graph, root);
    let forward = [0, 1, 2].map(|axis| forward(graph, &[root], axis)[0]);
    let cost = |graph: &Graph, [x, y, z]: [Id; 3]| cost(graph, &[root, x, y, z]);
    if cost(graph, forward) <= cost(graph, backward) { forward } else { backward }
}

/// Nodes of the Hessian (xx, xy, xz, yy, yz, zz), by the cheaper of forward and backward sweeps
/// over the gradient.
pub(super) fn hessian(graph: &mut Graph, gradient: [Id; 3]) -> [Id; 6] {
    let columns = [0, 1, 2].map(|axis| forward(graph, &gradient, axis));
    let forward = [columns[0][0], columns[1][0], columns[2][0], columns[1][1], columns[2][1], columns[2][2]];
    let [x, y, z] = gradient.map(|component| backward(graph, component));
    let backward = [x[0], x[1], x[2], y[1], y[2], z[2]];
    let cost = |graph: &Graph, hessian: [Id; 6]| {
        let mut outputs = gradient.to_vec();
        outputs.extend(hessian);
        cost(graph, &outputs)
    };
    if cost(graph, forward) <= cost(graph, backward) { forward } else { backward }
}

/// Nodes of ∂root/∂(x, y, z), by a backward sweep.
pub(super) fn backward(graph: &mut Graph, root: Id) -> [Id; 3] {
    let nodes = graph.needed_by(&[root]);
    let mut adjoints: Vec<Option<Id>> = vec![None; graph.len()];
    let one = graph.constant(1.0);
    let zero = graph.constant(0.0);
    adjoints[root as usize] = Some(one);
    let mut gradient = [zero; 3];
    for &id in nodes.iter().rev() {
        let Some(adjoint) = adjoints[id as usize].filter(|_| !graph.is_uniform(id)) else { continue };
        if let Node::Coordinate(axis) = graph.node(id) {
            gradient[usize::from(axis)] = adjoint;
            continue;
        }
        for (operand, term) in operand_adjoints(graph, id, adjoint).into_iter().flatten() {
            let sum = &mut adjoints[operand as usize];
            *sum = Some(match *sum {
                None => term,
                Some(before) => graph.add(before, term),
            });
        }
    }
    gradient
}

/// Nodes of ∂root/∂(coordinate `axis`) for each of `roots`, by a forward sweep.
pub(super) fn forward(graph: &mut Graph, roots: &[Id], axis: u8) -> Vec<Id> {
    let nodes = graph.needed_by(roots);
    let count = graph.len();
    let zero = graph.constant(0.0);
    let one = graph.constant(1.0);
    let mut tangent: Vec<Id> = vec![zero; count];
    for id in nodes {
        if graph.axes(id) >> axis & 1 == 0 {
            continue;
        }
        tangent[id as usize] = match graph.node(id) {
            Node::Coordinate(_) => one,
            // The tangent is selected, not multiplied by 0 or 1: the branch not taken may have an
            // infinite or undefined slope.
            Node::Binary(Binary::Min, a, b) => choose(graph, a, b, tangent[a as usize], tangent[b as usize]),
            Node::Binary(Binary::Max, a, b) => choose(graph, b, a, tangent[a as usize], tangent[b as usize]),
            Node::If(at_most, a, b, v) => graph.when(at_most, a, b, tangent[v as usize]),
            Node::Select(_, a, b, u, v) => graph.select(a, b, tangent[u as usize], tangent[v as usize]),
            _ => {
                let mut total = zero;
                for (operand, slope) in operand_adjoints(graph, id, one).into_iter().flatten() {
                    let product = graph.mul(slope, tangent[operand as usize]);
                    total = graph.add(total, product);
                }
                total
            }
        };
    }
    roots.iter().map(|&root| tangent[root as usize]).collect()
}

/// Node that is `first` where a ≤ b and `second` elsewhere.
fn choose(graph: &mut Graph, a: Id, b: Id, first: Id, second: Id) -> Id {
    if first == second {
        return first;
    }
    let first = graph.when(true, a, b, first);
    let second = graph.when(false, a, b, second);
    graph.add(first, second)
}

/// Contribution adjoint · ∂id/∂operand of node `id` to the adjoint of each operand. Uniform
/// operands are left out.
fn operand_adjoints(graph: &mut Graph, id: Id, adjoint: Id) -> [Option<(Id, Id)>; 3] {
    match graph.node(id) {
        Node::Constant(_) | Node::Parameter(_) | Node::Coordinate(_) => [None; 3],
        Node::Unary(operation, a) => [Some((a, unary(graph, operation, a, id, adjoint))), None, None],
        Node::Power(a, n) => {
            let lower = graph.power(a, n - 1);
            let exponent = graph.constant(f64::from(n));
            let scaled = graph.mul(adjoint, exponent);
            [Some((a, graph.mul(scaled, lower))), None, None]
        }
        Node::Binary(operation, a, b) => binary(graph, operation, a, b, id, adjoint),
        Node::Smin(blend, a, b, k) => smin(graph, blend, a, b, k, adjoint),
        Node::If(at_most, a, b, v) => [Some((v, graph.when(at_most, a, b, adjoint))), None, None],
        Node::Select(_, a, b, u, v) => {
            let to_u = (u, graph.when(true, a, b, adjoint));
            let to_v = (v, graph.when(false, a, b, adjoint));
            [Some(to_u).filter(|_| !graph.is_uniform(u)), Some(to_v).filter(|_| !graph.is_uniform(v)), None]
        }
    }
}

/// Product of `adjoint` and d(operation(a))/da, where `id` is operation(a).
fn unary(graph: &mut Graph, operation: Unary, a: Id, id: Id, adjoint: Id) -> Id {
    match operation {
        Unary::Neg => graph.neg(adjoint),
        Unary::Limit => adjoint,
        Unary::Sqrt => {
            let half = graph.constant(0.5);
            let scaled = graph.mul(adjoint, half);
            graph.div(scaled, id)
        }
        Unary::Cbrt => {
            let third = graph.constant(1.0 / 3.0);
            let scaled = graph.mul(adjoint, third);
            let square = graph.power(id, 2);
            graph.div(scaled, square)
        }
        Unary::Abs => {
            let sign = graph.unary(Unary::Sign, a);
            graph.mul(adjoint, sign)
        }
        Unary::Sign | Unary::Floor => graph.constant(0.0),
        Unary::Exp => graph.mul(adjoint, id),
        Unary::Ln => graph.div(adjoint, a),
        Unary::Log10 => {
            let scale = graph.constant(core::f64::consts::LOG10_E);
            let scaled = graph.mul(adjoint, scale);
            graph.div(scaled, a)
        }
        Unary::Sin => {
            let slope = graph.unary(Unary::Cos, a);
            graph.mul(adjoint, slope)
        }
        Unary::Cos => {
            let sine = graph.unary(Unary::Sin, a);
            let product = graph.mul(adjoint, sine);
            graph.neg(product)
        }
        Unary::Tan => {
            let slope = one_plus_square(graph, id);
            graph.mul(adjoint, slope)
        }
        Unary::Asin | Unary::Acos => {
            let square = graph.power(a, 2);
            let one = graph.constant(1.0);
            let rest = graph.sub(one, square);
            let root = graph.unary(Unary::Sqrt, rest);
            let slope = graph.div(adjoint, root);
            if operation == Unary::Asin { slope } else { graph.neg(slope) }
        }
        Unary::Atan => {
            let denominator = one_plus_square(graph, a);
            graph.div(adjoint, denominator)
        }
        Unary::Sinh => {
            let slope = graph.unary(Unary::Cosh, a);
            graph.mul(adjoint, slope)
        }
        Unary::Cosh => {
            let slope = graph.unary(Unary::Sinh, a);
            graph.mul(adjoint, slope)
        }
        Unary::Tanh => {
            let square = graph.power(id, 2);
            let one = graph.constant(1.0);
            let slope = graph.sub(one, square);
            graph.mul(adjoint, slope)
        }
        Unary::Asinh | Unary::Acosh => {
            let square = graph.power(a, 2);
            let one = graph.constant(1.0);
            let sum = if operation == Unary::Asinh { graph.add(square, one) } else { graph.sub(square, one) };
            let root = graph.unary(Unary::Sqrt, sum);
            graph.div(adjoint, root)
        }
        Unary::Atanh => {
            let square = graph.power(a, 2);
            let one = graph.constant(1.0);
            let rest = graph.sub(one, square);
            graph.div(adjoint, rest)
        }
        Unary::Erf => {
            let square = graph.power(a, 2);
            let negated = graph.neg(square);
            let bell = graph.unary(Unary::Exp, negated);
            let scale = graph.constant(core::f64::consts::FRAC_2_SQRT_PI);
            let slope = graph.mul(bell, scale);
            graph.mul(adjoint, slope)
        }
    }
}

fn one_plus_square(graph: &mut Graph, a: Id) -> Id {
    let square = graph.power(a, 2);
    let one = graph.constant(1.0);
    graph.add(square, one)
}

/// Contributions of a binary operation, where `id` is operation(a, b).
fn binary(graph: &mut Graph, operation: Binary, a: Id, b: Id, id: Id, adjoint: Id) -> [Option<(Id, Id)>; 3] {
    let varies = |graph: &Graph, id| !graph.is_uniform(id);
    let (of_a, of_b) = (varies(graph, a), varies(graph, b));
    let (to_a, to_b);
    match operation {
        Binary::Add => (to_a, to_b) = (Some(adjoint), Some(adjoint)),
        Binary::Sub => (to_a, to_b) = (Some(adjoint), of_b.then(|| graph.neg(adjoint))),
        Binary::Mul => {
            to_a = of_a.then(|| graph.mul(adjoint, b));
            to_b = of_b.then(|| graph.mul(adjoint, a));
        }
        Binary::Div => {
            let quotient = graph.div(adjoint, b);
            to_a = Some(quotient);
            to_b = of_b.then(|| {
                let product = graph.mul(quotient, id);
                graph.neg(product)
            });
        }
        Binary::Min => {
            to_a = of_a.then(|| graph.when(true, a, b, adjoint));
            to_b = of_b.then(|| graph.when(false, a, b, adjoint));
        }
        // max(a, b) is a where b ≤ a.
        Binary::Max => {
            to_a = of_a.then(|| graph.when(true, b, a, adjoint));
            to_b = of_b.then(|| graph.when(false, b, a, adjoint));
        }
        Binary::Pow => {
            to_a = of_a.then(|| {
                let one = graph.constant(1.0);
                let lower = graph.sub(b, one);
                let power = graph.pow(a, lower);
                let slope = graph.mul(power, b);
                graph.mul(adjoint, slope)
            });
            to_b = of_b.then(|| {
                let logarithm = graph.unary(Unary::Ln, a);
                let slope = graph.mul(id, logarithm);
                graph.mul(adjoint, slope)
            });
        }
        // d atan2(a, b) = (b da − a db)/(a² + b²)
        Binary::Atan2 => {
            let (aa, bb) = (graph.power(a, 2), graph.power(b, 2));
            let sum = graph.add(aa, bb);
            let scaled = graph.div(adjoint, sum);
            to_a = of_a.then(|| graph.mul(scaled, b));
            to_b = of_b.then(|| {
                let product = graph.mul(scaled, a);
                graph.neg(product)
            });
        }
    }
    [to_a.filter(|_| of_a).map(|term| (a, term)), to_b.filter(|_| of_b).map(|term| (b, term)), None]
}

/// Contributions of a smooth minimum. With u = (a − b)/k clamped to −1 … 1 and the depth k p(u) of
/// the blend below (a + b)/2, its partial derivatives are ½ − p′ in a, ½ + p′ in b and u p′ − p in
/// k: p = 1/6 + u²/2 − |u|³/6 of a cubic blend, ¼ + u²/4 of a quadratic one. The form needs no
/// branch and is smooth at a = b.
fn smin(graph: &mut Graph, blend: Blend, a: Id, b: Id, k: Id, adjoint: Id) -> [Option<(Id, Id)>; 3] {
    let (of_a, of_b, of_k) = (!graph.is_uniform(a), !graph.is_uniform(b), !graph.is_uniform(k));
    let (_, u) = graph.blend(a, b, k);
    let half = graph.constant(0.5);
    let magnitude = graph.unary(Unary::Abs, u);
    let square = graph.mul(u, magnitude);
    let w = match blend {
        Blend::Cubic => {
            let correction = graph.mul(square, half);
            graph.sub(u, correction)
        }
        Blend::Quadratic => graph.mul(u, half),
    };
    let to_a = of_a.then(|| {
        let slope = graph.sub(half, w);
        (a, graph.mul(adjoint, slope))
    });
    let to_b = of_b.then(|| {
        let slope = graph.add(w, half);
        (b, graph.mul(adjoint, slope))
    });
    let to_k = of_k.then(|| {
        let uu = graph.power(u, 2);
        let slope = match blend {
            Blend::Cubic => {
                let (third, sixth) = (graph.constant(1.0 / 3.0), graph.constant(1.0 / 6.0));
                let uuu = graph.mul(square, u);
                let (uu, uuu) = (graph.mul(uu, half), graph.mul(uuu, third));
                let rise = graph.sub(uu, uuu);
                graph.sub(rise, sixth)
            }
            Blend::Quadratic => {
                let quarter = graph.constant(0.25);
                let rise = graph.mul(uu, quarter);
                graph.sub(rise, quarter)
            }
        };
        // The minimum does not depend on widths below the smallest one.
        let slope = graph.mul(adjoint, slope);
        let least = graph.constant(MIN_BLEND_WIDTH);
        (k, graph.when(true, least, k, slope))
    });
    [to_a, to_b, to_k]
}
