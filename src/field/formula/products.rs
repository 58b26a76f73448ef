//! Products split into their factors: where factors cross, the product has no gradient, but each
//! factor has one.

use super::graph::{Graph, Id, Node};
use super::operations::{Binary, Unary};

/// Maximum number of products that are split into factors: five factors need four and give 46
/// cases, fewer than are listed for a box.
const MAX_PRODUCTS: usize = 4;

/// The node of a function with the signs, and so with the zeros, of node `root`, with choices
/// instead of the products and differences of squares that decide them: ab has the signs of
/// max(min(a, b), min(−a, −b)), which is ±a or ±b, whichever is smaller. The choices are added to
/// `choices`.
pub(super) fn by_signs(graph: &mut Graph, root: Id, choices: &mut Vec<Id>) -> Id {
    let root = conjugates(graph, root).map_or(root, |[a, b]| graph.mul(a, b));
    match graph.node(root) {
        Node::Unary(Unary::Neg, u) => {
            let u = by_signs(graph, u, choices);
            graph.neg(u)
        }
        Node::Binary(operation @ (Binary::Min | Binary::Max | Binary::Mul), a, b) => {
            let [a, b] = [a, b].map(|id| by_signs(graph, id, choices));
            let is_told = operation == Binary::Mul && choices.len() < 3 * MAX_PRODUCTS;
            if !is_told || graph.is_uniform(a) || graph.is_uniform(b) {
                return graph.binary(operation, a, b);
            }
            let (minus_a, minus_b) = (graph.neg(a), graph.neg(b));
            let (same, other) =
                (graph.binary(Binary::Min, a, b), graph.binary(Binary::Min, minus_a, minus_b));
            choices.extend([same, other, graph.binary(Binary::Max, same, other)]);
            choices[choices.len() - 1]
        }
        _ => root,
    }
}

/// Whether the zeros of factors of a product may cross. They do not if the factors differ by
/// constants, as for concentric spheres.
pub(super) fn may_cross(graph: &mut Graph, root: Id) -> bool {
    let factors = graph.factors(root);
    factors.iter().skip(1).any(|&factor| {
        let difference = graph.combination([(factor, 1.0), (factors[0], -1.0)]);
        !graph.is_uniform(difference)
    })
}

/// The factors u − v and u + v of a function u² − v²; none of another one, or if no coordinate
/// enters one of the squares: then the factors differ by a number.
fn conjugates(graph: &mut Graph, root: Id) -> Option<[Id; 2]> {
    let [first, second] = graph.summands(root)[..] else { return None };
    if graph.is_uniform(first.0) || graph.is_uniform(second.0) {
        return None;
    }
    let mut side = |(id, share): (Id, f64)| {
        let (sign, root) = root_of_square(graph, id)?;
        let scale = graph.constant(share.abs().sqrt());
        Some((sign * share, graph.mul(root, scale)))
    };
    let ((one, u), (other, v)) = (side(first)?, side(second)?);
    (one * other < 0.0).then(|| [graph.sub(u, v), graph.add(u, v)])
}

/// The sign s and the function u with which a node is s u², as far as its form shows them.
fn root_of_square(graph: &mut Graph, id: Id) -> Option<(f64, Id)> {
    match graph.node(id) {
        Node::Constant(bits) => {
            let value = f64::from_bits(bits);
            (value != 0.0).then(|| (value.signum(), graph.constant(value.abs().sqrt())))
        }
        Node::Power(u, n) if n % 2 == 0 => Some((1.0, graph.power(u, n / 2))),
        Node::Unary(Unary::Neg, u) => root_of_square(graph, u).map(|(sign, u)| (-sign, u)),
        Node::Binary(operation @ (Binary::Mul | Binary::Div), a, b) => {
            let ((s, a), (t, b)) = (root_of_square(graph, a)?, root_of_square(graph, b)?);
            Some((s * t, graph.binary(operation, a, b)))
        }
        _ => None,
    }
}
