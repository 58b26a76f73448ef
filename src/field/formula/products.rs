//! Products split into their factors: where factors cross, the product has no gradient, but each
//! factor has one.

use super::graph::{Graph, Id, Node};
use super::operations::{Binary, Unary};

/// Maximum number of products that are split into factors: five factors need four and give 46
/// cases, fewer than are listed for a box.
const MAX_PRODUCTS: usize = 4;

/// The node of a function with the signs, and so with the zeros, of node `root`, with choices
/// instead of the products that decide them: ab has the signs of max(min(a, b), min(−a, −b)), which
/// is ±a or ±b, whichever is smaller. The choices are added to `choices`.
pub(super) fn by_signs(graph: &mut Graph, root: Id, choices: &mut Vec<Id>) -> Id {
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
