//! The smooth branches of a formula.
//!
//! A *choice* is an operation that returns one of two smooth operands: a minimum, a maximum, an
//! absolute value (u or −u), a smooth minimum whose blend has no width, or a conditional. Once
//! every choice that f depends on has taken a side, f is a smooth function, its *branch*. The graph
//! of a branch is the graph of f with each choice replaced by the operand taken. Equal operations
//! stay one node: branches with the same root are the same function, as both sides of |x| are in
//! |x|².
//!
//! An absolute value to a power above 1 has a gradient at 0 and is no choice. Neither is an
//! operation that depends on no coordinate.

use super::compiled::Compiled;
use super::graph::{Graph, Id, MIN_BLEND_WIDTH, Node};
use super::interval::{self, FactorProgram, Range};
use super::operations::{Binary, Unary};
use super::products::{by_signs, may_cross};
use super::scalar;
use crate::math::Bounds;
use glam::DVec3;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Maximum number of branches that are listed for a box: four choices beyond those at a corner of
/// three faces that meet in |x|, |y| and |z|. A smaller box has fewer.
const MAX_LISTED: usize = 64;

/// The first branches, at most this many, are numbered by the formula alone; later ones in the
/// order in which they are met. Eight choices have 256.
const MAX_NUMBERED: usize = 256;

/// Condition that decides which operand a choice takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ChoiceCondition {
    /// The first node is at most the second.
    AtMost(Id, Id),
    /// The node is at least 0.
    NotNegative(Id),
}

/// Role of a node in the walk from f down to its operands: a choice leads to one operand, any other
/// node to all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum NodeRole {
    /// The node is no choice: it takes all of its operands.
    Plain,
    /// A power above 1 of the absolute value of this node, which is smooth.
    Raised(Id),
    /// One value where the condition holds, another elsewhere.
    Choice(ChoiceCondition),
}

/// A condition on the way from f to a branch, and whether it holds.
pub(super) type Side = (ChoiceCondition, bool);

/// The operand that a choice takes where its condition `holds` or does not; none if it takes a
/// number there.
pub(super) fn taken(choice: Node, holds: bool) -> Option<Id> {
    match choice {
        Node::Binary(_, a, b) | Node::Smin(_, a, b, _) | Node::Select(_, _, _, a, b) => {
            Some(if holds { a } else { b })
        }
        Node::Unary(Unary::Abs, u) => Some(u),
        Node::If(at_most, _, _, value) => (holds == at_most).then_some(value),
        _ => None,
    }
}

/// Where in a box, or at a point, a condition holds.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Holds {
    Always,
    Never,
    Somewhere,
}

/// The node that replaces a choice once its condition is known. `new` maps each operand to its own
/// replacement.
pub(super) fn resolved(graph: &mut Graph, choice: Node, holds: bool, new: impl Fn(Id) -> Id) -> Id {
    match taken(choice, holds).map(new) {
        _ if matches!(choice, Node::Unary(Unary::Sign, _)) => graph.constant(if holds { 1.0 } else { -1.0 }),
        Some(u) if !holds && matches!(choice, Node::Unary(Unary::Abs, _)) => graph.neg(u),
        Some(operand) => operand,
        None => graph.constant(0.0),
    }
}

impl ChoiceCondition {
    /// The nodes that are compared.
    pub(super) fn operands(self) -> impl Iterator<Item = Id> {
        let (first, second) = match self {
            Self::AtMost(a, b) => (a, Some(b)),
            Self::NotNegative(u) => (u, None),
        };
        core::iter::once(first).chain(second)
    }

    pub(super) fn at_point(self, value: impl Fn(Id) -> f64) -> Holds {
        let holds = match self {
            Self::AtMost(a, b) => value(a) <= value(b),
            Self::NotNegative(u) => value(u) >= 0.0,
        };
        if holds { Holds::Always } else { Holds::Never }
    }

    /// Where the condition holds in a box, from the bounds of the nodes. A tie belongs to both
    /// sides.
    pub(super) fn in_box(self, range: impl Fn(Id) -> Range) -> Holds {
        let below = |a: Id, b: Id| range(a).bounds.hi < range(b).bounds.lo;
        let (always, never) = match self {
            Self::AtMost(a, b) => (below(a, b), below(b, a)),
            Self::NotNegative(u) => (range(u).bounds.lo > 0.0, range(u).bounds.hi < 0.0),
        };
        if always {
            Holds::Always
        } else if never {
            Holds::Never
        } else {
            Holds::Somewhere
        }
    }
}

/// f, or a function that f reduces to once some choices have taken sides.
#[derive(Clone, Debug)]
pub(super) struct BranchPart {
    pub(super) root: Id,
    /// The nodes that the root needs, in the order of the graph.
    pub(super) nodes: Vec<Id>,
    /// The number of the branch; none while choices remain.
    pub(super) number: Option<u32>,
    /// The part for each combination of sides, in the order of [`BranchWalk`]; sorted.
    taken: Vec<(Vec<bool>, TakenPart)>,
    /// The branch, compiled when first needed.
    compiled: Option<Arc<Compiled>>,
}

/// The part that another part reduces to once all conditions of that part are decided.
#[derive(Clone, Copy, Debug)]
pub(super) struct TakenPart {
    /// Index of the part.
    pub(super) index: usize,
    /// Whether these sides can hold together only where operands tie, as u ≥ 0 and u ≤ 0. Other
    /// sides hold around such a place.
    pub(super) is_tie: bool,
    /// Whether zeros of f need it. In ties they do not: other parts give f there as well.
    has_zeros: bool,
}

/// A walk over the nodes of a part, from its root down through the operands taken.
#[derive(Clone, Debug, Default)]
pub(super) struct BranchWalk {
    /// Number of nodes that are still to be visited.
    left: usize,
    /// Whether each node is on the way; false for all at the end.
    needed: Vec<bool>,
    /// The conditions of the choices on the way.
    conditions: Vec<ChoiceCondition>,
    /// Whether each condition holds.
    pub(super) holds: Vec<bool>,
}

impl BranchWalk {
    /// The conditions on the way, each with whether it holds.
    pub(super) fn sides(&self) -> impl Iterator<Item = Side> {
        self.conditions.iter().copied().zip(self.holds.iter().copied())
    }

    fn begin(&mut self, part: &BranchPart, graph: &Graph) {
        self.needed.resize(graph.len(), false);
        self.needed[part.root as usize] = true;
        self.left = part.nodes.len();
        self.conditions.clear();
        self.holds.clear();
    }

    /// Walks to the end. `decide` is called with each new condition; if that holds in a part of the
    /// box only, this walk assumes that it holds, and a walk for the other side goes to `forks`.
    /// `visit` is called with each node on the way and whether its condition holds.
    fn run(
        &mut self,
        nodes: &[Id],
        base: &Base,
        decide: &mut dyn FnMut(ChoiceCondition) -> Holds,
        visit: &mut dyn FnMut(Id, bool),
        forks: &mut Vec<Self>,
    ) {
        while self.left > 0 {
            let id = nodes[self.left - 1];
            if !self.needed[id as usize] {
                self.left -= 1;
                continue;
            }
            let mut holds = true;
            if let NodeRole::Choice(condition) = base.roles[id as usize] {
                holds = match self.conditions.iter().position(|&known| known == condition) {
                    Some(known) => self.holds[known],
                    None => {
                        let mut holds = decide(condition);
                        if holds == Holds::Somewhere && base.has_ties {
                            holds = base.where_free(&self.conditions, &self.holds, condition);
                        }
                        self.conditions.push(condition);
                        if holds == Holds::Somewhere {
                            // The other walk finds the condition known when it comes to this node
                            // again.
                            let mut fork = self.clone();
                            fork.holds.push(false);
                            forks.push(fork);
                        }
                        self.holds.push(holds != Holds::Never);
                        holds != Holds::Never
                    }
                };
            }
            visit(id, holds);
            let mut need = |operand: Id| self.needed[operand as usize] = true;
            match base.roles[id as usize] {
                NodeRole::Plain => base.graph.node(id).operands(need),
                NodeRole::Raised(u) => need(u),
                NodeRole::Choice(_) => taken(base.graph.node(id), holds).into_iter().for_each(need),
            }
            self.needed[id as usize] = false;
            self.left -= 1;
        }
    }
}

/// Whether `ordered`, with its nodes replaced through `map`, contains this pair.
fn holds_in(ordered: &[[Id; 2]], map: &[Id], pair: [Id; 2]) -> bool {
    ordered.iter().any(|known| known.map(|id| map[id as usize]) == pair)
}

/// The graph of f and of its branches.
#[derive(Clone, Debug, Default)]
pub(super) struct Base {
    pub(super) graph: Graph,
    pub(super) roles: Vec<NodeRole>,
    /// Values of the nodes that depend on no coordinate; NaN for the others.
    uniforms: Vec<f64>,
    /// Whether some combination of sides met so far is possible only in ties.
    has_ties: bool,
}

impl Base {
    /// Finds the roles of the nodes from number `roles.len()` on.
    pub(super) fn extend(&mut self, values: &[f64]) {
        for id in self.roles.len() as Id..self.graph.len() as Id {
            let node = self.graph.node(id);
            let is_uniform = self.graph.is_uniform(id);
            let value = node.evaluate(values, [f64::NAN; 3], |id| self.uniforms[id as usize]);
            self.uniforms.push(if is_uniform { value } else { f64::NAN });
            let uniform = |id: Id| self.uniforms[id as usize];
            let magnitude = |id: Id| match self.graph.node(id) {
                Node::Unary(Unary::Abs, u) => Some(u),
                _ => None,
            };
            let role = match node {
                _ if is_uniform => NodeRole::Plain,
                Node::Binary(Binary::Min, a, b) => NodeRole::Choice(ChoiceCondition::AtMost(a, b)),
                Node::Binary(Binary::Max, a, b) => NodeRole::Choice(ChoiceCondition::AtMost(b, a)),
                Node::Smin(_, a, b, k) if uniform(k) <= MIN_BLEND_WIDTH => {
                    NodeRole::Choice(ChoiceCondition::AtMost(a, b))
                }
                Node::Unary(Unary::Abs, u) => NodeRole::Choice(ChoiceCondition::NotNegative(u)),
                // The slopes of minima, maxima and absolute values.
                Node::If(_, a, b, _) | Node::Select(_, a, b, ..) => {
                    NodeRole::Choice(ChoiceCondition::AtMost(a, b))
                }
                Node::Unary(Unary::Sign, u) if self.graph.find(Node::Unary(Unary::Abs, u)).is_some() => {
                    NodeRole::Choice(ChoiceCondition::NotNegative(u))
                }
                Node::Power(a, n) if n > 1 => magnitude(a).map_or(NodeRole::Plain, NodeRole::Raised),
                Node::Binary(Binary::Pow, a, b) if uniform(b) > 1.0 => {
                    magnitude(a).map_or(NodeRole::Plain, NodeRole::Raised)
                }
                _ => NodeRole::Plain,
            };
            self.roles.push(role);
        }
    }

    /// The node that `part` reduces to when its conditions take the values in `holds`. With it,
    /// whether that combination is possible only in ties, and, if the root vanishes only in ties,
    /// the functions at [its edge](Branches::edges).
    fn specialised(
        &mut self,
        part: &BranchPart,
        holds: &[bool],
        values: &[f64],
        walk: &mut BranchWalk,
    ) -> (Id, bool, Option<Vec<Id>>) {
        let (mut way, mut rest) = (Vec::new(), holds.iter());
        let mut next = |_| if rest.next() == Some(&true) { Holds::Always } else { Holds::Never };
        walk.begin(part, &self.graph);
        walk.run(&part.nodes, self, &mut next, &mut |id, holds| way.push((id, holds)), &mut Vec::new());
        let zero = self.graph.constant(0.0);
        let ordered = self.ordered(&walk.conditions, holds);
        let graph = &mut self.graph;
        let mut map: Vec<Id> = (0..graph.len() as Id).collect();
        for (id, holds) in way.into_iter().rev() {
            let new = |id: Id| map[id as usize];
            let node = graph.node(id);
            let built = match (self.roles[id as usize], node) {
                (NodeRole::Plain, _) => graph.built(node.mapped(new)),
                (NodeRole::Raised(u), _) => {
                    let (u, size) = (new(u), graph.find(Node::Unary(Unary::Abs, u)));
                    let new_size = graph.unary(Unary::Abs, u);
                    // The exponent depends on no coordinate and stays.
                    graph.built(node.mapped(|operand| if Some(operand) == size { new_size } else { operand }))
                }
                (NodeRole::Choice(_), _) => resolved(graph, node, holds, new),
            };
            // |u| is u or −u where the conditions give the sign of u.
            map[id as usize] = match graph.node(built) {
                Node::Unary(Unary::Abs, u) if built != id && holds_in(&ordered, &map, [zero, u]) => u,
                Node::Unary(Unary::Abs, u) if built != id && holds_in(&ordered, &map, [u, zero]) => {
                    graph.neg(u)
                }
                _ => built,
            };
        }
        let root = map[part.root as usize];
        self.extend(values);
        // √(u² + v²) vanishes where both do: on an edge of this part, if its conditions give the
        // sign of u or v.
        let squares = self.graph.squares(root);
        let mut rising = Vec::new();
        for &u in &squares {
            if holds_in(&ordered, &map, [zero, u]) {
                rising.push(u);
            } else if holds_in(&ordered, &map, [u, zero]) {
                rising.push(self.graph.neg(u));
            }
        }
        let edge = (squares.len() > 1 && !rising.is_empty()).then(|| {
            let (norm, is_falling) = match self.graph.node(root) {
                Node::Unary(Unary::Neg, norm) => (norm, true),
                _ => (root, false),
            };
            if rising.len() < squares.len() || !self.graph.is_norm(norm) {
                return Vec::new();
            }
            if is_falling {
                rising.iter_mut().for_each(|u| *u = self.graph.neg(*u));
            }
            rising
        });
        self.extend(values);
        (root, self.are_tied(ordered), edge)
    }

    /// Pairs of nodes, the lesser first, as these conditions order them.
    fn ordered(&self, conditions: &[ChoiceCondition], holds: &[bool]) -> Vec<[Id; 2]> {
        let zero = self.graph.find(Node::constant(0.0));
        let pairs = conditions.iter().zip(holds).filter_map(|(&condition, &holds)| {
            let [a, b] = match condition {
                ChoiceCondition::AtMost(a, b) => [a, b],
                ChoiceCondition::NotNegative(u) => [zero?, u],
            };
            Some(if holds { [a, b] } else { [b, a] })
        });
        pairs.collect()
    }

    /// Whether the sides already taken decide this condition. Combinations that are possible only
    /// where operands tie are ignored.
    fn where_free(&self, known: &[ChoiceCondition], holds: &[bool], condition: ChoiceCondition) -> Holds {
        let [is_tie, is_tie_else] = [true, false].map(|side| {
            let mut ordered = self.ordered(&[condition], &[side]);
            ordered.extend(self.ordered(known, holds));
            self.are_tied(ordered)
        });
        match (is_tie, is_tie_else) {
            (true, false) => Holds::Never,
            (false, true) => Holds::Always,
            _ => Holds::Somewhere,
        }
    }

    /// Whether these inequalities, the first of each pair at most the second, force some pair to be
    /// equal.
    fn are_tied(&self, mut ordered: Vec<[Id; 2]>) -> bool {
        let pairs = ordered.clone();
        let mut next = 0;
        while let Some(&[a, b]) = ordered.get(next) {
            next += 1;
            let more = match (self.graph.node(a), self.graph.node(b)) {
                (Node::Binary(Binary::Max, u, v), _) => [[u, b], [v, b]],
                (_, Node::Binary(Binary::Min, u, v)) => [[a, u], [a, v]],
                _ => continue,
            };
            for pair in more {
                if !ordered.contains(&pair) {
                    ordered.push(pair);
                }
            }
        }
        let mut found = Vec::new();
        pairs.into_iter().any(|[a, b]| self.is_at_most(&ordered, &mut found, [b, a]))
    }

    /// Whether `known` inequalities, or those `found` from them, imply that the first node is at
    /// most the second. Only inequalities between a number and a function that is constant on no
    /// volume are used: max(u, v) = u, or |u| = u, may hold in a solid.
    fn is_at_most(&self, known: &[[Id; 2]], found: &mut Vec<[Id; 2]>, [a, b]: [Id; 2]) -> bool {
        let parts = match (self.graph.node(a), self.graph.node(b)) {
            _ if found.contains(&[a, b]) => return true,
            (Node::Binary(Binary::Max, u, v), _) => [[u, b], [v, b]],
            (_, Node::Binary(Binary::Min, u, v)) => [[a, u], [a, v]],
            _ => {
                let is_number = [a, b].map(|id| self.graph.is_uniform(id));
                return known.contains(&[a, b])
                    && is_number[0] != is_number[1]
                    && self.is_nowhere_level(if is_number[0] { b } else { a });
            }
        };
        let is_at_most = parts.into_iter().all(|pair| self.is_at_most(known, found, pair));
        found.extend(is_at_most.then_some([a, b]));
        is_at_most
    }

    /// Whether a node is a smooth function, or the absolute value of one, up to numbers that are
    /// added or multiplied.
    fn is_nowhere_level(&self, mut id: Id) -> bool {
        loop {
            id = match self.graph.node(id) {
                Node::Unary(Unary::Neg | Unary::Abs, u) => u,
                Node::Binary(Binary::Add | Binary::Sub | Binary::Mul, a, b) if self.graph.is_uniform(b) => a,
                Node::Binary(Binary::Add | Binary::Sub | Binary::Mul, a, b) if self.graph.is_uniform(a) => b,
                _ => break,
            }
        }
        let is_smooth = |&id: &Id| {
            let node = self.graph.node(id);
            !matches!(
                node,
                Node::Binary(Binary::Min | Binary::Max, ..)
                    | Node::Unary(Unary::Abs | Unary::Sign | Unary::Floor, _)
                    | Node::Smin(..)
                    | Node::If(..)
                    | Node::Select(..)
            )
        };
        self.graph.needed_by(&[id]).iter().all(is_smooth)
    }
}

/// The branches of a formula, found when needed and shared by its evaluators. The order of requests
/// affects only the numbers of branches beyond the first [`MAX_NUMBERED`].
#[derive(Debug, Default)]
pub(super) struct SharedBranches(Mutex<Branches>);

impl SharedBranches {
    pub(super) fn new(branches: Branches) -> Self {
        Self(Mutex::new(branches))
    }

    /// A panic does no harm: a half-finished part is computed again.
    pub(super) fn lock(&self) -> MutexGuard<'_, Branches> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn set_parameters(&mut self, values: &[f64]) {
        self.lock().set_parameters(values);
    }
}

impl Clone for SharedBranches {
    fn clone(&self) -> Self {
        Self::new(self.lock().clone())
    }
}

/// A smooth part of the surface that several branches share.
#[derive(Clone, Debug)]
pub(super) struct Patch {
    /// Its branches, ascending. It has the number of the first.
    pub(super) branches: Vec<u32>,
    /// The function whose zero set it is.
    pub(super) compiled: Arc<Compiled>,
}

/// The function of a sheet: f with some choices fixed to one side.
#[derive(Clone, Debug)]
pub(super) struct Sheet {
    /// The conditions of these choices, and whether they hold on the sheet.
    pub(super) sides: Vec<Side>,
    /// The nodes that the conditions need, in the order of the graph.
    pub(super) nodes: Vec<Id>,
    /// Programs for the factors of the function.
    pub(super) programs: Vec<FactorProgram>,
}

/// The branches of f that have been met, with their numbers. A formula without choices has none.
#[derive(Clone, Debug, Default)]
pub(super) struct Branches {
    pub(super) base: Base,
    /// f, then the functions that it reduces to.
    pub(super) parts: Vec<BranchPart>,
    /// The part of each branch, by its number.
    numbered: Vec<usize>,
    /// The patches of several branches.
    pub(super) patches: Vec<Patch>,
    /// Pairs of patches that meet without an edge somewhere.
    pub(super) apart: Vec<[u32; 2]>,
    /// The factors of the branches in a box, each by its branch and its index there, if some of
    /// them meet in creases in that box.
    pub(super) factors: Vec<(u32, usize)>,
    /// The sheets that choices keep apart, if the surface has no creases.
    pub(super) sheets: Vec<Sheet>,
    /// The choices that [stand for products](by_signs).
    pub(super) products: Vec<Id>,
    /// The function that replaces f where factors of a product cross, since its gradient does not
    /// vanish there: the function of the graph.
    pub(super) split: Option<Arc<Compiled>>,
    /// The parts that vanish only at an edge of theirs, by their index. Such a part is the norm
    /// √(u² + v² + …), or its negative, of functions of one sign: these follow, if they are known.
    pub(super) edges: Vec<(usize, Vec<Id>)>,
    /// Whether f is equal to the function of the graph only up to [steps and
    /// ridges](super::steps).
    pub(super) is_rewritten: bool,
    walk: BranchWalk,
    /// The roles for the previous parameters; the memory is reused.
    before: Vec<NodeRole>,
    pub(super) doubles: Vec<f64>,
    pub(super) ranges: Vec<interval::Row<1>>,
    pub(super) jets: scalar::Jets<0>,
}

impl Branches {
    /// The branches of a function, with these values of the parameters; found when first needed.
    pub(super) fn new(f: &Compiled, values: &[f64]) -> Self {
        Self::of(&f.graph, f.root, &[], values)
    }

    /// The branches of a function with its products [split into factors](by_signs); none if it
    /// has no products, or is one whose factors cannot cross.
    pub(super) fn of_factors(f: &Compiled, values: &[f64]) -> Option<Self> {
        let (mut products, mut graph) = (Vec::new(), (*f.graph).clone());
        if matches!(graph.node(f.root), Node::Binary(Binary::Mul, ..)) && !may_cross(&mut graph, f.root) {
            return None;
        }
        let root = by_signs(&mut graph, f.root, &mut products);
        (!products.is_empty()).then(|| Self::of(&graph, root, &products, values))
    }

    pub(super) fn of(graph: &Graph, root: Id, products: &[Id], values: &[f64]) -> Self {
        let mut branches = Self::default();
        let is_choice = |&id: &Id| {
            let node = graph.node(id);
            let may_choose = matches!(
                node,
                Node::Binary(Binary::Min | Binary::Max, ..)
                    | Node::Unary(Unary::Abs, _)
                    | Node::Smin(..)
                    | Node::Select(..)
            );
            may_choose && !graph.is_uniform(id)
        };
        let nodes = graph.needed_by(&[root]);
        if nodes.iter().any(is_choice) {
            // The indices of the products in the graph of these nodes alone.
            branches.products =
                products.iter().filter_map(|id| nodes.binary_search(id).ok()).map(|k| k as Id).collect();
            branches.begin(graph, root, values);
        }
        branches
    }

    fn begin(&mut self, graph: &Graph, root: Id, values: &[f64]) {
        let (graph, root) = graph.part(root);
        let base = Base { graph, ..Base::default() };
        let products = core::mem::take(&mut self.products);
        *self = Self { base, products, ..Self::default() };
        self.base.extend(values);
        self.part(root);
    }

    /// Index of the part with this root.
    fn part(&mut self, root: Id) -> usize {
        if let Some(known) = self.parts.iter().position(|part| part.root == root) {
            return known;
        }
        let part = BranchPart {
            root,
            nodes: self.base.graph.needed_by(&[root]),
            number: None,
            taken: Vec::new(),
            compiled: None,
        };
        let index = self.parts.len();
        let mut has_choice = false;
        let mut look = |_| {
            has_choice = true;
            Holds::Always
        };
        self.walk.begin(&part, &self.base.graph);
        self.walk.run(&part.nodes, &self.base, &mut look, &mut |_, _| {}, &mut Vec::new());
        self.parts.push(part);
        if !has_choice {
            self.parts[index].number = Some(self.numbered.len() as u32);
            self.numbered.push(index);
        }
        index
    }

    /// The part that part `of` reduces to when its conditions take the values in `holds`.
    pub(super) fn taken(&mut self, of: usize, holds: &[bool], values: &[f64]) -> TakenPart {
        let known = &self.parts[of].taken;
        let place = match known.binary_search_by(|(way, _)| way.as_slice().cmp(holds)) {
            Ok(place) => return known[place].1,
            Err(place) => place,
        };
        let (root, is_tie, edge) = self.base.specialised(&self.parts[of], holds, values, &mut self.walk);
        self.base.has_ties |= is_tie;
        let index = self.part(root);
        let part = TakenPart { index, is_tie, has_zeros: !is_tie && edge.is_none() };
        if let Some(edge) = edge.filter(|_| !is_tie) {
            match self.edges.iter_mut().find(|known| known.0 == index) {
                Some(known) if known.1 != edge => known.1.clear(),
                Some(_) => {}
                None => self.edges.push((index, edge)),
            }
        }
        self.parts[of].taken.insert(place, (holds.to_vec(), part));
        part
    }

    /// At most `limit` combinations of the conditions of part `of`, `true` before `false`.
    pub(super) fn ways(
        &self,
        of: usize,
        limit: usize,
        decide: &mut dyn FnMut(ChoiceCondition) -> Holds,
    ) -> Vec<BranchWalk> {
        let part = &self.parts[of];
        let mut first = BranchWalk::default();
        first.begin(part, &self.base.graph);
        let (mut open, mut found) = (vec![first], Vec::new());
        while found.len() < limit
            && let Some(mut walk) = open.pop()
        {
            walk.run(&part.nodes, &self.base, decide, &mut |_, _| {}, &mut open);
            found.push(walk);
        }
        found
    }

    /// Numbers at most `left` branches of part `of`, in an order that depends on the formula alone.
    fn number(&mut self, of: usize, left: &mut usize, values: &[f64]) {
        if self.parts[of].number.is_some() {
            *left = left.saturating_sub(1);
            return;
        }
        for BranchWalk { holds, .. } in self.ways(of, *left, &mut |_| Holds::Somewhere) {
            let part = self.taken(of, &holds, values);
            self.number(part.index, left, values);
        }
    }

    fn number_first(&mut self, values: &[f64]) {
        if self.numbered.is_empty() {
            self.number(0, &mut { MAX_NUMBERED }, values);
        }
    }

    /// The number of the branch at `p`.
    pub(super) fn at(&mut self, values: &[f64], p: DVec3) -> u32 {
        if self.parts.is_empty() {
            return 0;
        }
        self.number_first(values);
        let mut at = 0;
        loop {
            let part = &self.parts[at];
            if let Some(number) = part.number {
                return number;
            }
            self.base.graph.evaluate(&part.nodes, values, p, &mut self.doubles);
            self.walk.begin(part, &self.base.graph);
            let mut decide = |condition: ChoiceCondition| condition.at_point(|id| self.doubles[id as usize]);
            self.walk.run(&part.nodes, &self.base, &mut decide, &mut |_, _| {}, &mut Vec::new());
            let holds = core::mem::take(&mut self.walk.holds);
            let part = self.taken(at, &holds, values);
            self.walk.holds = holds;
            if part.is_tie
                && let Some(&number) = self.within(values, &Bounds::point(p)).unwrap_or_default().first()
            {
                return number;
            }
            at = part.index;
        }
    }

    /// The numbers of the branches that may have zeros of f in the box, ascending; none if more
    /// than [`MAX_LISTED`] combinations of conditions are possible there.
    pub(super) fn within(&mut self, values: &[f64], bounds: &Bounds) -> Option<Vec<u32>> {
        self.met_in(values, bounds).map(|(numbers, _)| numbers)
    }

    /// The branches [`within`](Self::within) a box, and the indices of the parts that vanish only
    /// at their edge. Those are no branches there: other branches are zero at the same place.
    pub(super) fn met_in(&mut self, values: &[f64], bounds: &Bounds) -> Option<(Vec<u32>, Vec<usize>)> {
        if self.parts.is_empty() {
            return Some((vec![0], Vec::new()));
        }
        self.number_first(values);
        let (mut open, mut numbers, mut edges, mut ways) = (vec![0], Vec::new(), Vec::new(), 0);
        while let Some(at) = open.pop() {
            let part = &self.parts[at];
            interval::bounds(&self.base.graph, &part.nodes, values, bounds, &mut self.ranges);
            let range = |id: Id| self.ranges[id as usize].at(0);
            if range(part.root).is_nonzero() {
                continue;
            }
            if let Some(number) = part.number {
                numbers.push(number);
                continue;
            }
            let found = self.ways(at, MAX_LISTED + 1 - ways, &mut |condition| condition.in_box(range));
            ways += found.len();
            if ways > MAX_LISTED {
                return None;
            }
            for BranchWalk { holds, .. } in found {
                let part = self.taken(at, &holds, values);
                open.extend(part.has_zeros.then_some(part.index));
                edges.extend((!part.has_zeros && !part.is_tie).then_some(part.index));
            }
        }
        numbers.sort_unstable();
        numbers.dedup();
        Some((numbers, edges))
    }

    /// The node of a branch.
    pub(super) fn root_of(&self, number: u32) -> Id {
        self.parts[self.numbered[number as usize]].root
    }

    /// Whether f includes limits.
    pub(super) fn has_limits(&self) -> bool {
        self.parts.first().is_some_and(|whole| self.base.graph.limited(whole.root).is_some())
    }

    /// Whether the zeros of a branch only limit the surface and are not part of it.
    pub(super) fn is_limit(&mut self, number: u32, values: &[f64]) -> bool {
        if !self.has_limits() {
            return false;
        }
        self.number_first(values);
        let part = self.numbered.get(number as usize).map(|&index| self.parts[index].root);
        part.is_some_and(|root| matches!(self.base.graph.node(root), Node::Unary(Unary::Limit, _)))
    }

    /// The branch of this number, compiled; none if f is its only branch.
    ///
    /// # Panics
    ///
    /// If there is no such branch.
    pub(super) fn compiled(&mut self, number: u32, values: &[f64]) -> Option<Arc<Compiled>> {
        let is_piecewise = self.parts.first().is_some_and(|part| part.number.is_none());
        if !is_piecewise {
            return None;
        }
        self.number_first(values);
        let index = *self.numbered.get(number as usize).expect("a number that a branch was given");
        let part = &mut self.parts[index];
        if part.compiled.is_none() {
            let (graph, root) = self.base.graph.part(part.root);
            part.compiled = Some(Arc::new(Compiled::from_graph(graph, root, values)));
        }
        part.compiled.clone()
    }

    /// Recomputes everything that depends on the parameters alone. If other operations are choices
    /// now, the search for branches starts again.
    pub(super) fn set_parameters(&mut self, values: &[f64]) {
        let of_sheets = self.sheets.iter_mut().flat_map(|sheet| &mut sheet.programs);
        of_sheets.for_each(|program| program.set_parameters(values));
        if self.parts.is_empty() {
            return;
        }
        core::mem::swap(&mut self.base.roles, &mut self.before);
        self.base.roles.clear();
        self.base.uniforms.clear();
        self.base.extend(values);
        if self.base.roles == self.before {
            let compiled = self.parts.iter_mut().filter_map(|part| part.compiled.as_mut());
            let of_patches = self.patches.iter_mut().map(|patch| &mut patch.compiled);
            compiled
                .chain(of_patches)
                .chain(&mut self.split)
                .for_each(|compiled| Arc::make_mut(compiled).set_parameters(values));
        } else {
            let (graph, root) = (core::mem::take(&mut self.base.graph), self.parts[0].root);
            self.begin(&graph, root, values);
        }
    }
}
