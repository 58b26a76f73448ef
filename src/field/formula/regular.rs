//! Solids in their regular form: they end where one of their functions has no value, and have no
//! skin.
//!
//! A solid is put together by minima and maxima of functions, its *faces*, and lies where the whole
//! comes to at most 0. Where only signs count, a face can be exchanged for another function of the
//! same sign:
//!
//! - a − c √u has no value where u < 0, and an infinite slope where u = 0. It is at most 0 where
//!   max(a/c, 0)² − u is, which has values and slopes everywhere. So the ball under z = √(1 − x² −
//!   y²) ends at its equator, and a solid that lies deeper ends at a wall below it.
//! - Where a cutter lies flush with a face g of the solid, as in max(g, min(h, −g)), both are 0
//!   where h < 0: a skin without thickness. The solid without its skins (the closure of its
//!   interior; A. Requicha, "Representations for rigid solids", 1980) is max(g, h).

use super::graph::{Graph, Id, Node};
use super::operations::{Binary, Unary};
use super::solids::{Opened, Signed};
use glam::DVec3;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;

/// Maximum number of faces of a solid that is looked at; a function in k absolute values, one in
/// the other, has 2ᵏ.
const MAX_FACES: usize = 128;
/// Maximum number of roots in each other that a face may have.
const MAX_ROOTS: usize = 8;
/// Half-widths of the boxes around the origin in which faces are compared: a bend in millimetres
/// lies far from one in units, and beside a high power a number counts near the origin alone.
const HALVES: [f64; 6] = [0.1, 1.0, 10.0, 100.0, 1e3, 1e4];
/// Number of places in each of the boxes.
const PLACES: usize = 8;
/// Least number of places at which both faces have a value, where they are compared.
const LEAST_KNOWN: usize = 8;
/// Largest difference of faces that count as equal, as a share of them: rounding makes it.
const ROUNDING: f64 = 1e-9;

/// A solid in its regular form.
pub(super) struct Regular {
    pub(super) graph: Graph,
    pub(super) root: Id,
    /// The faces with which a cutter lies flush, as nodes of the graph.
    pub(super) flush: Vec<Id>,
}

/// The regular form of a solid; none if it has that form, is one face, or is the surface alone
/// within limits.
pub(super) fn regular(graph: &Graph, root: Id) -> Option<Regular> {
    if graph.limited(root).is_some() {
        return None;
    }
    let parameter = |node: &Node| match node {
        Node::Parameter(index) => Some(*index as usize + 1),
        _ => None,
    };
    let parameters = graph.nodes().iter().filter_map(parameter).max().unwrap_or(0);
    let graph = graph.clone();
    let mut forming = Forming { graph, left: MAX_FACES, parameters, values: Vec::new(), flush: Vec::new() };
    let negative = forming.is_solid_where_positive(root);
    let whole = Signed::of(&mut forming.graph, root, negative);
    let parts = forming.opened(whole);
    if matches!(parts, Solid::Face(_)) {
        return None;
    }
    let mut is_new = false;
    let parts = parts.with_faces(&mut |face| {
        let ended = forming.ended(face, MAX_ROOTS);
        is_new |= ended.is_some();
        ended
    });
    let parts = match forming.without_skins(parts, &mut Vec::new(), &mut is_new) {
        Sided::Parts(parts) if is_new => parts,
        _ => return None,
    };
    let solid = forming.node(&parts);
    let solid = if negative { forming.graph.neg(solid) } else { solid };
    let outputs: Vec<Id> = [solid].into_iter().chain(forming.flush).collect();
    let (graph, nodes) = forming.graph.rewritten(&outputs, Graph::intern);
    Some(Regular { graph, root: nodes[0], flush: nodes[1..].to_vec() })
}

/// A solid, by the nodes of its faces, each of which is at most 0 on its inner side.
enum Solid {
    Face(Id),
    /// The intersection of solids.
    All(Vec<Self>),
    /// The union of solids.
    Any(Vec<Self>),
}

/// A part of a solid, in a place where the signs of some faces are known.
enum Sided {
    /// The part fills the place.
    Inside,
    /// The part has nothing in the place.
    Outside,
    /// The part ends in the place, at these faces.
    Parts(Solid),
}

impl Solid {
    /// Puts the solids that `change` gives in the place of faces.
    fn with_faces(self, change: &mut dyn FnMut(Id) -> Option<Self>) -> Self {
        let mut each = |parts: Vec<Self>| parts.into_iter().map(|part| part.with_faces(change)).collect();
        match self {
            Self::All(parts) => Self::All(each(parts)),
            Self::Any(parts) => Self::Any(each(parts)),
            Self::Face(face) => change(face).unwrap_or(Self::Face(face)),
        }
    }
}

struct Forming {
    graph: Graph,
    /// Number of faces that may still be added.
    left: usize,
    /// Number of parameters.
    parameters: usize,
    /// Values of faces at some places, for those that have been compared.
    values: Vec<(Id, Vec<f64>)>,
    /// The faces with which a cutter lies flush.
    flush: Vec<Id>,
}

impl Forming {
    /// Whether the solid lies where f is positive, as that of min(√u − a, b) does: the faces of a
    /// minimum have roots, and all of these count positively.
    fn is_solid_where_positive(&mut self, root: Id) -> bool {
        let whole = Signed::of(&mut self.graph, root, false);
        let Opened::Both { is_max: false, .. } = whole.opened(&mut self.graph) else { return false };
        let mut signs = [false; 2];
        let parts = self.opened(whole);
        parts.with_faces(&mut |face| {
            if let Some(end) = self.root_of(face) {
                signs[usize::from(end.factor > 0.0)] = true;
            }
            None
        });
        self.left = MAX_FACES;
        signs == [false, true]
    }

    /// The solid where a function is at most 0.
    fn opened(&mut self, f: Signed) -> Solid {
        match f.opened(&mut self.graph) {
            Opened::Both { is_max, operands } if self.left > 1 => {
                self.left -= 1;
                let mut parts = Vec::new();
                for operand in operands {
                    match (self.opened(operand), is_max) {
                        (Solid::All(more), true) | (Solid::Any(more), false) => parts.extend(more),
                        (part, _) => parts.push(part),
                    }
                }
                if is_max { Solid::All(parts) } else { Solid::Any(parts) }
            }
            Opened::Face(face) => Solid::Face(face.value(&mut self.graph)),
            _ => Solid::Face(f.value(&mut self.graph)),
        }
    }

    /// The node of a function that is at most 0 in the solid.
    fn node(&mut self, solid: &Solid) -> Id {
        let (operation, parts) = match solid {
            Solid::Face(face) => return *face,
            Solid::All(parts) => (Binary::Max, parts),
            Solid::Any(parts) => (Binary::Min, parts),
        };
        let nodes: Vec<Id> = parts.iter().map(|part| self.node(part)).collect();
        nodes[1..].iter().fold(nodes[0], |total, &node| self.graph.binary(operation, total, node))
    }

    /// The solid behind a face that a root ends, by faces that end nowhere. Roots may be nested
    /// `most` deep. None if the face has no such root, or several.
    fn ended(&mut self, face: Id, most: usize) -> Option<Solid> {
        let End { term, share, factor, base, inverse } = self.root_of(face).filter(|_| most > 0)?;
        // The face is rest + factor · base^(1/inverse).
        let rest = self.graph.combination([(face, 1.0), (term, -share)]);
        let scale = self.graph.constant(-1.0 / factor);
        let level = self.graph.mul(rest, scale);
        let one_less = self.graph.constant(inverse - 1.0);
        let raise = self.graph.constant(inverse);
        let faces = if factor < 0.0 {
            // Inside where the root is at least the level.
            let zero = self.graph.constant(0.0);
            let above = if is_never_negative(&self.graph, level) {
                level
            } else {
                self.graph.binary(Binary::Max, level, zero)
            };
            let power = self.graph.pow(above, raise);
            vec![self.graph.sub(power, base)]
        } else {
            // Inside where it is at most the level, and is a number.
            let size = self.graph.unary(Unary::Abs, level);
            let size = self.graph.pow(size, one_less);
            let power = self.graph.mul(level, size);
            vec![self.graph.neg(base), self.graph.sub(base, power)]
        };
        let mut parts: Vec<Solid> = Vec::new();
        for face in faces {
            match self.ended(face, most - 1) {
                Some(Solid::All(more)) => parts.extend(more),
                Some(part) => parts.push(part),
                None => parts.push(Solid::Face(face)),
            }
        }
        Some(if parts.len() == 1 { parts.remove(0) } else { Solid::All(parts) })
    }

    /// The only root among the summands of a face whose argument may be negative.
    fn root_of(&self, face: Id) -> Option<End> {
        let mut found = None;
        for (term, share) in self.graph.summands(face) {
            let (mut node, mut factor) = (term, share);
            while let Node::Binary(operation @ (Binary::Mul | Binary::Div), v, u) = self.graph.node(node)
                && let Some(number) = self.graph.as_constant(u)
            {
                factor = if operation == Binary::Mul { factor * number } else { factor / number };
                node = v;
            }
            let (base, inverse) = match self.graph.node(node) {
                Node::Unary(Unary::Sqrt, base) => (base, 2.0),
                Node::Binary(Binary::Pow, base, exponent) => {
                    match self.graph.as_constant(exponent).filter(|p| (0.0..1.0).contains(p)) {
                        Some(exponent) => (base, 1.0 / exponent),
                        None => continue,
                    }
                }
                _ => continue,
            };
            if factor == 0.0 || self.graph.is_uniform(base) || is_never_negative(&self.graph, base) {
                continue;
            }
            if found.replace(End { term, share, factor, base, inverse }).is_some() {
                return None;
            }
        }
        found
    }

    /// The solid without its skins, in a place where each of the `known` faces is at most 0, or,
    /// with `false`, at least 0.
    fn without_skins(&mut self, solid: Solid, known: &mut Vec<(Id, bool)>, is_new: &mut bool) -> Sided {
        let (parts, is_all) = match solid {
            Solid::Face(face) => {
                for &(other, is_inside) in known.iter() {
                    let Some(is_same) = self.compared(face, other) else { continue };
                    *is_new = true;
                    if !is_same && is_inside && !self.flush.contains(&other) {
                        self.flush.push(other);
                    }
                    return if is_same == is_inside { Sided::Inside } else { Sided::Outside };
                }
                return Sided::Parts(Solid::Face(face));
            }
            Solid::All(parts) => (parts, true),
            Solid::Any(parts) => (parts, false),
        };
        let (faces, others): (Vec<Solid>, Vec<Solid>) =
            parts.into_iter().partition(|part| matches!(part, Solid::Face(_)));
        let mut kept = Vec::new();
        let before = known.len();
        for part in faces.into_iter().chain(others) {
            let first = if matches!(part, Solid::Face(_)) { before } else { known.len() };
            // Faces beside each other are not compared: max(g, −g) is a surface.
            let beside = known.split_off(first);
            let part = self.without_skins(part, known, is_new);
            known.extend(beside);
            match part {
                Sided::Parts(part) => {
                    if let Solid::Face(face) = part {
                        known.push((face, is_all));
                    }
                    kept.push(part);
                }
                Sided::Inside if is_all => {}
                Sided::Outside if !is_all => {}
                decided => {
                    known.truncate(before);
                    return decided;
                }
            }
        }
        known.truncate(before);
        match kept.len() {
            0 if is_all => Sided::Inside,
            0 => Sided::Outside,
            1 => Sided::Parts(kept.remove(0)),
            _ => Sided::Parts(if is_all { Solid::All(kept) } else { Solid::Any(kept) }),
        }
    }

    /// Whether two faces are the same function but for a positive factor, or, with `false`, for a
    /// negative one; none if they are different functions.
    fn compared(&mut self, face: Id, other: Id) -> Option<bool> {
        let [a, b] = [face, other].map(|face| self.values_of(face));
        let pairs = || a.iter().zip(&b).filter(|(a, b)| a.is_finite() && b.is_finite());
        // A face that is one number at all places, as beyond its bends, tells nothing.
        let is_known = pairs().count() >= LEAST_KNOWN && pairs().any(|(value, _)| *value != a[0]);
        if !is_known {
            return None;
        }
        let (first, other_first) = pairs().max_by(|(a, _), (b, _)| a.abs().total_cmp(&b.abs()))?;
        let is_one = pairs().all(|(a, b)| {
            let [here, there] = [a * other_first, b * first];
            (here - there).abs() <= ROUNDING * here.abs().max(there.abs())
        });
        (is_one && first * other_first != 0.0).then_some(first * other_first > 0.0)
    }

    /// The values of a face at some places, with other parameters at each: what holds for some
    /// values of the parameters alone is no reason to leave a face out.
    fn values_of(&mut self, face: Id) -> Vec<f64> {
        if let Some((_, values)) = self.values.iter().find(|(known, _)| *known == face) {
            return values.clone();
        }
        let nodes = self.graph.needed_by(&[face]);
        let (mut results, mut random) = (Vec::new(), Pcg32::seed_from_u64(0));
        let mut between =
            |lo: f64, hi: f64| lo + (hi - lo) * f64::from(random.next_u32()) / f64::from(u32::MAX);
        let mut values = Vec::with_capacity(HALVES.len() * PLACES);
        for half in HALVES.into_iter().flat_map(|half| [half; PLACES]) {
            let point = DVec3::from_array([0, 1, 2].map(|_| between(-half, half)));
            let parameters: Vec<f64> = (0..self.parameters).map(|_| between(0.25, 2.25)).collect();
            self.graph.evaluate(&nodes, &parameters, point, &mut results);
            values.push(results[face as usize]);
        }
        self.values.push((face, values.clone()));
        values
    }
}

/// A root that ends a face: factor · base^(1/inverse).
struct End {
    /// The summand that holds it, and how often it stands in the face.
    term: Id,
    share: f64,
    factor: f64,
    base: Id,
    inverse: f64,
}

/// Whether the value of a node is never negative, as far as its form shows that.
fn is_never_negative(graph: &Graph, id: Id) -> bool {
    let is = |id: Id| is_never_negative(graph, id);
    match graph.node(id) {
        Node::Constant(bits) => f64::from_bits(bits) >= 0.0,
        Node::Unary(Unary::Abs | Unary::Sqrt | Unary::Exp | Unary::Cosh, _) => true,
        Node::Power(a, n) => n % 2 == 0 || is(a),
        Node::Binary(Binary::Mul, a, b) => a == b || is(a) && is(b),
        Node::Binary(Binary::Add | Binary::Div | Binary::Min, a, b) => is(a) && is(b),
        Node::Binary(Binary::Max, a, b) => is(a) || is(b),
        _ => false,
    }
}
