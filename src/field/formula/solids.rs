//! Solids made of the surface of a formula: a shell of some thickness, and what the faces of a box
//! close.
//!
//! Both are further nodes of the graph of f, so that derivatives, bounds and branches are found as
//! for any formula.

use super::derivative;
use super::graph::{Graph, Id, Node};
use super::operations::{Binary, Unary};
use super::products::by_signs;
use super::thickness::Shell;
use crate::math::Bounds;

/// Maximum number of smooth functions that make up the shells of a thickened surface; k nested
/// absolute values take 2ᵏ. Beyond it a choice of f gets one shell as a whole, whose edges may be
/// off where gradients of different length meet.
const MAX_SHELLS: usize = 128;

/// The solid that is made of a surface: its shell and the box that closes it. Without both it is
/// the surface itself.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Solid {
    /// The shell around the surface.
    pub(super) shell: Option<Shell>,
    /// The box whose faces close the solid.
    pub(super) closed: Option<Bounds>,
    /// Whether that box is a [cell](crate::field::UnitCell).
    pub(super) is_cell: bool,
    /// Whether the function that is sampled is the negative of the solid's.
    is_negative: bool,
    /// The number that is then subtracted.
    shift: f64,
}

impl Solid {
    /// Replaces the function g of the solid by g − shift, or −g − shift.
    pub(super) fn turn(&mut self, is_negative: bool, shift: f64) {
        self.shift = shift + if is_negative { -self.shift } else { self.shift };
        self.is_negative ^= is_negative;
    }

    /// Whether the function of the solid is [replaced](Self::turn).
    pub(super) fn is_turned(&self) -> bool {
        self.is_negative || self.shift != 0.0
    }

    /// The node of the function that is at most 0 in the solid made of f, which is node `root`.
    pub(super) fn made_of(&self, graph: &mut Graph, root: Id) -> Id {
        // The limits of the surface become faces of a shell or of a closed solid.
        let is_solid = self.shell.is_some() || self.closed.is_some();
        let limited = graph.limited(root).filter(|_| is_solid);
        let surface = limited.map_or(root, |[f, _]| f);
        let mut solid = surface;
        if let Some(shell) = &self.shell {
            graph.let_zero_annihilate();
            let apart = by_signs(graph, surface, &mut Vec::new());
            let half = shell.half(graph);
            solid = thickened(graph, apart, half);
        }
        if let Some([_, limit]) = limited {
            solid = graph.binary(Binary::Max, solid, limit);
        }
        if let Some(bounds) = &self.closed {
            for axis in 0..3_u8 {
                let at = graph.intern(Node::Coordinate(axis));
                let [low, high] =
                    [bounds.min, bounds.max].map(|corner| graph.constant(corner[usize::from(axis)]));
                for face in [graph.sub(at, high), graph.sub(low, at)] {
                    solid = graph.binary(Binary::Max, solid, face);
                }
            }
        }
        if self.is_negative {
            solid = graph.neg(solid);
        }
        let shift = graph.constant(self.shift);
        if self.shift == 0.0 { solid } else { graph.sub(solid, shift) }
    }
}

/// The node of |f| − t/2 |∇f|, which is at most 0 where the distance from the surface is at most
/// t/2 to first order; `half` is the node of t/2. A varying t is taken at the place itself, not at
/// the nearest point of the surface, which differs by about |∇t| t/2.
///
/// Each operand of a choice in f gets a shell by its own gradient: max(a, b) = 0 those around a = 0
/// and b = 0, which meet in edges. With the one gradient of max(a, b) they would miss each other by
/// the jump of |∇f|. Factors of a product get a shell each, too: where they cross, the product has
/// no gradient.
fn thickened(graph: &mut Graph, root: Id, half: Id) -> Id {
    let mut shells = ShellBuilder { graph, half, left: MAX_SHELLS };
    let [above, below] = [false, true].map(|is_negative| {
        let f = Signed::of(shells.graph, root, is_negative);
        shells.side(f)
    });
    graph.binary(Binary::Max, above, below)
}

/// The function shift + node, or shift − node; the shift depends on no coordinate.
#[derive(Clone, Copy)]
pub(super) struct Signed {
    pub(super) node: Id,
    is_negative: bool,
    shift: Id,
}

/// The outermost operation of a function, of those that decide its sign.
pub(super) enum Opened {
    /// The greater or the lesser of two functions.
    Both { is_max: bool, operands: [Signed; 2] },
    /// The third where the first node is at most the second, else the fourth.
    Chosen([Id; 2], [Signed; 2]),
    /// None of these.
    Face(Signed),
}

impl Signed {
    /// The function of a node, or its negative.
    pub(super) fn of(graph: &mut Graph, node: Id, is_negative: bool) -> Self {
        Self { node, is_negative, shift: graph.constant(0.0) }
    }

    /// The node of the function.
    pub(super) fn value(&self, graph: &mut Graph) -> Id {
        if self.is_negative { graph.sub(self.shift, self.node) } else { graph.add(self.node, self.shift) }
    }

    /// Strips signs, summands without coordinates and constant factors, and opens what is left.
    pub(super) fn opened(self, graph: &mut Graph) -> Opened {
        let Self { node, is_negative, shift } = self;
        let shifted = |node: Id, shift: Id| Self { node, is_negative, shift };
        let turned = |node: Id, shift: Id| Self { node, is_negative: !is_negative, shift };
        let moved = |graph: &mut Graph, u: Id| {
            if is_negative { graph.sub(shift, u) } else { graph.add(shift, u) }
        };
        match graph.node(node) {
            Node::Unary(Unary::Neg, u) => turned(u, shift).opened(graph),
            Node::Binary(Binary::Add, v, u) if graph.is_uniform(u) => {
                let shift = moved(graph, u);
                shifted(v, shift).opened(graph)
            }
            Node::Binary(Binary::Sub, u, v) if graph.is_uniform(u) => {
                let shift = moved(graph, u);
                turned(v, shift).opened(graph)
            }
            // The zeros agree with v + shift/factor.
            Node::Binary(Binary::Mul, v, u) if graph.as_constant(u).is_some_and(|u| u != 0.0) => {
                let size = graph.unary(Unary::Abs, u);
                let shift = graph.div(shift, size);
                let is_reversed = graph.as_constant(u) < Some(0.0);
                if is_reversed { turned(v, shift) } else { shifted(v, shift) }.opened(graph)
            }
            Node::Binary(operation @ (Binary::Min | Binary::Max), a, b) => Opened::Both {
                is_max: (operation == Binary::Max) != is_negative,
                operands: [shifted(a, shift), shifted(b, shift)],
            },
            Node::Unary(Unary::Abs, u) => {
                Opened::Both { is_max: !is_negative, operands: [shifted(u, shift), turned(u, shift)] }
            }
            Node::Select(_, a, b, u, v) => Opened::Chosen([a, b], [shifted(u, shift), shifted(v, shift)]),
            _ => Opened::Face(self),
        }
    }
}

struct ShellBuilder<'a> {
    graph: &'a mut Graph,
    /// Node of half of the thickness.
    half: Id,
    /// Number of smooth functions that may still be added.
    left: usize,
}

impl ShellBuilder<'_> {
    /// The node of a function that is at most 0 where f/|∇f| ≤ t/2, for the function f.
    fn side(&mut self, f: Signed) -> Id {
        match f.opened(self.graph) {
            Opened::Face(face) => self.shell(face),
            _ if self.left <= 1 => self.shell(f),
            Opened::Both { is_max, operands } => {
                self.left -= 1;
                let [a, b] = operands.map(|operand| self.side(operand));
                self.graph.binary(if is_max { Binary::Max } else { Binary::Min }, a, b)
            }
            Opened::Chosen([a, b], operands) => {
                self.left -= 1;
                let [u, v] = operands.map(|operand| self.side(operand));
                self.graph.select(a, b, u, v)
            }
        }
    }

    /// The node of f − t/2 |∇f|.
    fn shell(&mut self, f: Signed) -> Id {
        let gradient = derivative::gradient(self.graph, f.node);
        let squares = gradient.map(|slope| self.graph.power(slope, 2));
        let sum = self.graph.add(squares[0], squares[1]);
        let sum = self.graph.add(sum, squares[2]);
        let slope = self.graph.unary(Unary::Sqrt, sum);
        let value = f.value(self.graph);
        let offset = self.graph.mul(slope, self.half);
        self.graph.sub(value, offset)
    }
}
