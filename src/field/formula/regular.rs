//! Solids in their regular form: they end where one of their functions is undefined, and have no
//! skins. Surfaces that end where their function is undefined.
//!
//! A solid combines functions, its *faces*, by minima and maxima, and lies where the result is at
//! most 0. Only the sign of a face matters, so a face can be replaced by another function of the
//! same sign:
//!
//! - a − c √u has no value where u < 0, and an infinite slope where u = 0. It is at most 0 where
//!   max(a/c, 0)² − u is, which has values and slopes everywhere. So the ball under z = √(1 − x² −
//!   y²) ends at its equator, and a solid that lies deeper ends at a wall below it.
//! - A sum of several roots, or a root within another function, is continued beyond its end by
//!   √|u|, with −u as a further face: max(f, −u) is at most 0 where f is, and ends with it.
//!   Likewise u |u|ᵖ⁻¹ replaces uᵖ with p > 1.
//! - Where a cutter lies flush with a face g of the solid, as in max(g, min(h, −g)), both are 0
//!   where h < 0: a skin without thickness. The solid without its skins (the closure of its
//!   interior; A. Requicha, "Representations for rigid solids", 1980) is max(g, h).
//!
//! The function of a surface f = 0 is replaced in the same way, with a [limit](Unary::Limit)
//! instead of a further face: a − c √u = 0 is (a/c)² − u = 0 within a/c > 0. So the surface z = √(1
//! − x² − y²) ends in a rim.
//!
//! The factor c may depend on parameters. Its sign decides which function replaces a − c √u; for c
//! = 0 it is a itself, which ends where u < 0. The form is computed again when a [sign](Scales)
//! changes.

use super::graph::{Graph, Id, Node};
use super::operations::{Binary, Unary};
use super::solids::{Opened, Signed};
use core::f64::consts::{FRAC_PI_2, PI};
use glam::DVec3;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;

/// Maximum number of faces of a solid that is looked at; a function in k absolute values, one in
/// the other, has 2ᵏ.
const MAX_FACES: usize = 128;
/// Maximum number of roots in each other that a face may have.
const MAX_ROOTS: usize = 8;
/// Half-widths of the boxes around the origin in which faces are compared: bends may be millimetres
/// or units away, and next to a high power a constant matters only near the origin.
const HALVES: [f64; 6] = [0.1, 1.0, 10.0, 100.0, 1e3, 1e4];
/// Number of places in each of the boxes.
const PLACES: usize = 8;
/// Least number of places at which both faces have a value, where they are compared.
const LEAST_KNOWN: usize = 8;
/// Largest relative difference, by rounding, of faces that count as equal.
const ROUNDING: f64 = 1e-9;

/// A solid in its regular form.
pub(super) struct Regular {
    pub(super) graph: Graph,
    pub(super) root: Id,
    /// The faces with which a cutter lies flush, as nodes of the graph.
    pub(super) flush: Vec<Id>,
}

/// The factors of roots that depend on parameters, each with the sign that it had when a form was
/// made.
#[derive(Clone, Debug, Default)]
pub(super) struct Scales {
    /// The graph of the factors.
    graph: Graph,
    signs: Vec<(Id, f64)>,
}

impl Scales {
    /// Records and returns the sign of a factor: 1 or −1, or 0 if it is 0 or not finite.
    fn sign(&mut self, graph: &Graph, scale: Id, parameters: &[f64]) -> f64 {
        let own = self.graph.add_part(graph, scale);
        let sign = self.sign_now(own, parameters);
        if self.signs.iter().all(|&(known, _)| known != own) {
            self.signs.push((own, sign));
        }
        sign
    }

    fn sign_now(&self, scale: Id, parameters: &[f64]) -> f64 {
        let mut results = Vec::new();
        self.graph.evaluate(&self.graph.needed_by(&[scale]), parameters, DVec3::ZERO, &mut results);
        match results[scale as usize] {
            value if value.is_finite() && value != 0.0 => value.signum(),
            _ => 0.0,
        }
    }

    /// Whether these parameters change the sign of a factor, and so the form.
    pub(super) fn have_turned(&self, parameters: &[f64]) -> bool {
        self.signs.iter().any(|&(scale, sign)| self.sign_now(scale, parameters) != sign)
    }
}

/// The regular form of a solid for these values of the parameters; none if it has that form, is one
/// face, or is the surface alone within limits. Notes the factors whose signs it depends on.
pub(super) fn regular(graph: &Graph, root: Id, parameters: &[f64], scales: &mut Scales) -> Option<Regular> {
    if graph.limited(root).is_some() {
        return None;
    }
    let mut forming = Forming::new(graph, parameters, scales);
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

/// The surface of one function within the limits in which the function is defined, for these values
/// of the parameters; none if it is defined everywhere, or combines several functions. Notes the
/// factors whose signs it depends on.
pub(super) fn within_limits(
    graph: &Graph,
    root: Id,
    parameters: &[f64],
    scales: &mut Scales,
) -> Option<(Graph, Id)> {
    let mut forming = Forming::new(graph, parameters, scales);
    let (f, limit) = match graph.limited(root) {
        Some([f, limit]) => (f, Some(limit)),
        None => (root, None),
    };
    let whole = Signed::of(&mut forming.graph, f, false);
    if !matches!(forming.opened(whole), Solid::Face(_)) || forming.graph.factors(f).len() > 1 {
        return None;
    }
    let (mut f, mut limits, mut reaches_end) = (f, Vec::new(), false);
    for _ in 0..MAX_ROOTS {
        let Some(Exchanged { other, within, level }) = forming.without_inverse(f) else { break };
        f = other;
        limits.extend(within);
        // A root equals a positive number only away from its end.
        reaches_end |= !forming.graph.is_uniform(level);
    }
    if let Some((other, within)) = forming.extended(f) {
        f = other;
        limits.extend(within);
    }
    let mut graph = forming.graph;
    limits.retain(|&limit| graph.as_constant(limit).is_none_or(|limit| limit > 0.0));
    if limits.is_empty() && !reaches_end {
        return None;
    }
    if let Some(limit) = limits.into_iter().chain(limit).reduce(|a, b| graph.binary(Binary::Max, a, b)) {
        let limit = graph.unary(Unary::Limit, limit);
        f = graph.binary(Binary::Max, f, limit);
    }
    Some(graph.part(f))
}

/// A solid, by the nodes of its faces. Each face is at most 0 on its inner side.
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
    /// Replaces faces by the solids that `change` gives for them.
    fn with_faces(self, change: &mut dyn FnMut(Id) -> Option<Self>) -> Self {
        let mut each = |parts: Vec<Self>| parts.into_iter().map(|part| part.with_faces(change)).collect();
        match self {
            Self::All(parts) => Self::All(each(parts)),
            Self::Any(parts) => Self::Any(each(parts)),
            Self::Face(face) => change(face).unwrap_or(Self::Face(face)),
        }
    }
}

struct Forming<'a> {
    graph: Graph,
    /// Number of faces that may still be added.
    left: usize,
    /// The values of the parameters.
    parameters: &'a [f64],
    /// The factors whose signs the form depends on.
    scales: &'a mut Scales,
    /// Values of faces at some places, for those that have been compared.
    values: Vec<(Id, Vec<f64>)>,
    /// The faces with which a cutter lies flush.
    flush: Vec<Id>,
}

impl<'a> Forming<'a> {
    fn new(graph: &Graph, parameters: &'a [f64], scales: &'a mut Scales) -> Self {
        let (values, flush) = (Vec::new(), Vec::new());
        Self { graph: graph.clone(), left: MAX_FACES, parameters, scales, values, flush }
    }

    /// Whether the solid lies where f is positive, as for min(√u − a, b): f is a minimum whose
    /// faces have roots, all with a positive sign.
    fn is_solid_where_positive(&mut self, root: Id) -> bool {
        let whole = Signed::of(&mut self.graph, root, false);
        let Opened::Both { is_max: false, .. } = whole.opened(&mut self.graph) else { return false };
        let mut signs = [false; 2];
        let parts = self.opened(whole);
        parts.with_faces(&mut |face| {
            if let Some(end) = self.root_of(face) {
                signs[usize::from(end.term.is_positive)] = true;
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

    /// The solid behind a face that ends at roots, by faces that are defined everywhere. Roots may
    /// be nested `most` deep. None if no root ends the face.
    fn ended(&mut self, face: Id, most: usize) -> Option<Solid> {
        let Some(end) = self.root_of(face).filter(|_| most > 0) else {
            let (face, ends) = self.extended(face)?;
            return Some(Solid::All([face].into_iter().chain(ends).map(Solid::Face).collect()));
        };
        let level = self.level_of(face, &end.term);
        let End { term, base, inverse } = end;
        let faces = if !term.is_positive {
            // Inside where the root is at least the level.
            let zero = self.graph.constant(0.0);
            let above = if is_never_negative(&self.graph, level) {
                level
            } else {
                self.graph.binary(Binary::Max, level, zero)
            };
            let raise = self.graph.constant(inverse);
            let power = self.graph.pow(above, raise);
            vec![self.graph.sub(power, base)]
        } else {
            // Inside where it is at most the level, and is a number.
            let power = self.odd_power(level, inverse);
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

    /// The level of a summand: the value that it has, without its factor, where the face is zero.
    /// With g for the summand without its factor, the face is factor · (g − level).
    fn level_of(&mut self, face: Id, term: &Term) -> Id {
        let rest = self.graph.combination([(face, 1.0), (term.node, -term.share)]);
        let inverse = self.graph.constant(-1.0 / term.factor);
        let level = self.graph.mul(rest, inverse);
        term.scale.map_or(level, |scale| self.graph.div(level, scale))
    }

    /// u |u|ᵖ⁻¹ for p > 1, which is uᵖ where that is defined.
    fn odd_power(&mut self, u: Id, p: f64) -> Id {
        let size = self.graph.unary(Unary::Abs, u);
        let one_less = self.graph.constant(p - 1.0);
        let size = self.graph.pow(size, one_less);
        self.graph.mul(u, size)
    }

    /// The function that replaces `f`, with the only root, arcsine or arccosine among its summands
    /// inverted.
    fn without_inverse(&mut self, f: Id) -> Option<Exchanged> {
        if let Some(end) = self.root_of(f) {
            let level = self.level_of(f, &end.term);
            let raise = self.graph.constant(end.inverse);
            let is_whole = end.inverse.fract() == 0.0;
            let power =
                if is_whole { self.graph.pow(level, raise) } else { self.odd_power(level, end.inverse) };
            let other = if end.term.is_positive {
                self.graph.sub(end.base, power)
            } else {
                self.graph.sub(power, end.base)
            };
            let limit = (!is_never_negative(&self.graph, level)).then(|| self.graph.neg(level));
            return Some(Exchanged { other, within: limit.into_iter().collect(), level });
        }
        let (term, (is_sine, u)) = self.only_summand(f, Self::arc)?;
        let level = self.level_of(f, &term);
        let (operation, least, most) =
            if is_sine { (Unary::Sin, -FRAC_PI_2, FRAC_PI_2) } else { (Unary::Cos, 0.0, PI) };
        let value = self.graph.unary(operation, level);
        // The arccosine falls where its argument grows.
        let is_turned = term.is_positive != is_sine;
        let other = if is_turned { self.graph.sub(value, u) } else { self.graph.sub(u, value) };
        let [least, most] = [least, most].map(|end| self.graph.constant(end));
        let within = vec![self.graph.sub(least, level), self.graph.sub(level, most)];
        Some(Exchanged { other, within, level })
    }

    /// The only root among the summands of a face whose argument may be negative.
    fn root_of(&mut self, face: Id) -> Option<End> {
        let root = |forming: &mut Self, node: Id| forming.ending_power(node).filter(|(_, p)| *p < 1.0);
        let (term, (base, exponent)) = self.only_summand(face, root)?;
        Some(End { term, base, inverse: 1.0 / exponent })
    }

    /// The only summand of a face for which `kind` has an answer, with the answer; none if there
    /// are several. Factors without coordinates are split off before `kind` sees the summand.
    fn only_summand<T>(
        &mut self,
        face: Id,
        mut kind: impl FnMut(&mut Self, Id) -> Option<T>,
    ) -> Option<(Term, T)> {
        let mut found = None;
        for (term, share) in self.graph.summands(face) {
            let (mut node, mut factor, mut scale) = (term, share, None);
            while let Node::Binary(operation @ (Binary::Mul | Binary::Div), v, u) = self.graph.node(node)
                && self.graph.is_uniform(u)
            {
                match (self.graph.as_constant(u), operation) {
                    (Some(number), Binary::Mul) => factor *= number,
                    (Some(number), _) => factor /= number,
                    (None, _) => {
                        let so_far = scale.unwrap_or_else(|| self.graph.constant(1.0));
                        scale = Some(self.graph.binary(operation, so_far, u));
                    }
                }
                node = v;
            }
            if factor == 0.0 {
                continue;
            }
            let Some(kind) = kind(self, node) else { continue };
            let sign = scale.map_or(1.0, |scale| self.scales.sign(&self.graph, scale, self.parameters));
            if sign == 0.0 {
                continue;
            }
            let term = Term { node: term, share, factor, scale, is_positive: factor * sign > 0.0 };
            if found.replace((term, kind)).is_some() {
                return None;
            }
        }
        found
    }

    /// Whether a node is an arcsine, or with `false` an arccosine, and its argument, if that may be
    /// beyond −1 … 1.
    fn arc(&mut self, node: Id) -> Option<(bool, Id)> {
        let (is_sine, u) = match self.graph.node(node) {
            Node::Unary(Unary::Asin, u) => (true, u),
            Node::Unary(Unary::Acos, u) => (false, u),
            _ => return None,
        };
        let ends = !self.graph.is_uniform(u) && self.values_of(u).iter().any(|value| value.abs() > 1.0);
        ends.then_some((is_sine, u))
    }

    /// The base and the exponent of a power that is undefined for a negative base, if its base may
    /// be negative.
    fn ending_power(&mut self, node: Id) -> Option<(Id, f64)> {
        let (base, exponent) = match self.graph.node(node) {
            Node::Unary(Unary::Sqrt, base) => (base, 0.5),
            Node::Power(root, n) if n > 0 && n % 2 != 0 => match self.graph.node(root) {
                Node::Unary(Unary::Sqrt, base) => (base, 0.5 * f64::from(n)),
                _ => return None,
            },
            Node::Binary(Binary::Pow, base, exponent) => (base, self.graph.as_constant(exponent)?),
            _ => return None,
        };
        let may_end = exponent > 0.0 && exponent.fract() != 0.0 && !self.graph.is_uniform(base);
        let ends = may_end
            && !is_never_negative(&self.graph, base)
            && self.values_of(base).iter().any(|&value| value < 0.0);
        ends.then_some((base, exponent))
    }

    /// A face continued beyond the places where its powers are defined, and functions that are at
    /// most 0 where they are; none if they are defined everywhere.
    fn extended(&mut self, face: Id) -> Option<(Id, Vec<Id>)> {
        let nodes = self.graph.needed_by(&[face]);
        let (mut map, mut ends): (Vec<Id>, Vec<Id>) = ((0..self.graph.len() as Id).collect(), Vec::new());
        for id in nodes {
            map[id as usize] = match self.ending_power(id) {
                None => {
                    let node = self.graph.node(id).mapped(|operand| map[operand as usize]);
                    self.graph.built(node)
                }
                Some((base, exponent)) => {
                    let base = map[base as usize];
                    let end = self.graph.neg(base);
                    if !ends.contains(&end) {
                        ends.push(end);
                    }
                    if exponent > 1.0 {
                        self.odd_power(base, exponent)
                    } else {
                        let size = self.graph.unary(Unary::Abs, base);
                        let exponent = self.graph.constant(exponent);
                        self.graph.pow(size, exponent)
                    }
                }
            };
        }
        (!ends.is_empty()).then(|| (map[face as usize], ends))
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
            // Operands of one choice are not compared: max(g, −g) is a surface.
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

    /// Whether two faces are the same function up to a positive factor, or, with `false`, up to a
    /// negative one; none if they are different functions.
    fn compared(&mut self, face: Id, other: Id) -> Option<bool> {
        let [a, b] = [face, other].map(|face| self.values_of(face));
        let pairs = || a.iter().zip(&b).filter(|(a, b)| a.is_finite() && b.is_finite());
        // A face with one value at all places, as beyond its bends, shows nothing.
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

    /// The values of a face at some places, with other parameters at each: a relation that holds
    /// for some values only is no reason to leave a face out.
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
            let parameters: Vec<f64> = self.parameters.iter().map(|_| between(0.25, 2.25)).collect();
            self.graph.evaluate(&nodes, &parameters, point, &mut results);
            values.push(results[face as usize]);
        }
        self.values.push((face, values.clone()));
        values
    }
}

/// A function that has the zeros of another one.
struct Exchanged {
    other: Id,
    /// Functions that are at most 0 where both functions have the same zeros.
    within: Vec<Id>,
    /// The value that the root, arcsine or arccosine has at these zeros.
    level: Id,
}

/// A summand of a face.
struct Term {
    node: Id,
    /// Its coefficient in the face.
    share: f64,
    /// The factor, in the face, of the rest of the summand.
    factor: f64,
    /// A further factor that depends on parameters.
    scale: Option<Id>,
    /// Whether both factors together are positive.
    is_positive: bool,
}

/// A root that ends a face: factor · scale · base^(1/inverse).
struct End {
    term: Term,
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
