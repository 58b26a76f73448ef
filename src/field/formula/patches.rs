//! Branches that meet without an edge, as a cylinder and the ball that rounds its end do, or the
//! faces and the rounded edges of a box. They are one patch of the surface. Its function is f with
//! only those choices left open that decide between its own branches.
//!
//! In small cells in which choices may be tied, points are projected onto the surface. Between two
//! points on different branches, bisection finds the place where the branch changes, and the
//! normals on both sides of it are compared. Branches that meet at an angle anywhere stay apart.

use super::branches::{Branches, ChoiceCondition, Holds, NodeRole, Patch, Side, resolved};
use super::compiled::Compiled;
use super::graph::Id;
use crate::math::newton::{self, STEPS, Slope, StepLimits, step_to_surface};
use crate::math::{Bounds, Meet, SHARP, SQRT_3};
use crate::slices::pause;
use glam::DVec3;
use std::sync::Arc;

/// Cosine of the largest angle between the normals of two branches in a cell where they meet
/// without an edge: each turns by less than 15° there. Smaller: smooth joins beside narrower
/// fillets are found, in more time.
const PARALLEL: f64 = 0.5 * SQRT_3;
/// Distance between the unit normals of two branches below which they do not meet at an angle
/// nearby: beside an edge that fades out there are places with a larger one.
const ALIKE: f64 = 0.5 * SHARP;
/// Distance between two points at which the normals of two branches are compared, as a share of the
/// diagonal of the box.
const APART: f64 = 1e-6;
/// Maximum number of bisections between two points. At an edge of 90° each shortens the distance by
/// at least a third.
const MOST_HALVINGS: u32 = 64;
/// A point is on the surface when a step is shorter than this share of the reach.
const AT_REST: f64 = 1e-9;
/// Maximum number of combinations of the choices of f that are tried.
const MOST_WAYS: usize = 256;

/// The branches that give f on the surface, and how they meet.
#[derive(Debug, Default)]
pub(super) struct Meetings {
    /// Their numbers, ascending.
    seen: Vec<u32>,
    /// Pairs that meet without an edge somewhere, the smaller number first.
    tangent: Vec<[u32; 2]>,
    /// Pairs that meet at an angle somewhere.
    sharp: Vec<[u32; 2]>,
    /// Cells in which they do.
    pub(super) edges: Vec<Bounds>,
    /// Pairs that meet where a gradient vanishes, so that it is unknown how.
    open: Vec<[u32; 2]>,
    /// Whether the place where some pair may meet was not found.
    is_lost: bool,
}

impl Meetings {
    /// Whether the surface may have an edge: a pair meets at an angle, of one it is unknown how it
    /// meets, or of none it is known that it meets without an edge.
    pub(super) fn may_have_edges(&self) -> bool {
        let Self { seen, tangent, sharp, open, is_lost, .. } = self;
        !sharp.is_empty()
            || open.iter().any(|pair| !tangent.contains(pair))
            || tangent.is_empty() && (*is_lost || seen.is_empty())
    }
}

/// A point of the surface, with the branch that gives f there.
#[derive(Clone, Copy)]
struct Landed {
    position: DVec3,
    branch: u32,
}

impl Branches {
    /// Joins the branches that meet without an edge into patches.
    pub(super) async fn join_tangent(&mut self, values: &[f64], meetings: Meetings) {
        let Meetings { seen, tangent, sharp, .. } = meetings;
        // One of a pair that meets in the box may give f nowhere on its surface.
        let all = seen.iter().chain(tangent.iter().flatten()).chain(sharp.iter().flatten());
        let mut patches: Vec<u32> = all.copied().max().map_or(Vec::new(), |last| (0..=last).collect());
        for &pair in tangent.iter().filter(|pair| !sharp.contains(pair)) {
            let of = |pair: [u32; 2]| ascending(pair.map(|branch| patches[branch as usize]));
            let [to, from] = of(pair);
            if to != from && !sharp.iter().any(|&edge| of(edge) == [to, from]) {
                patches.iter_mut().filter(|patch| **patch == from).for_each(|patch| *patch = to);
            }
        }
        for &first in &seen {
            pause().await;
            let branches: Vec<u32> = seen.iter().copied().filter(|&b| patches[b as usize] == first).collect();
            if branches.len() > 1
                && let Some(root) = self.patch_root(&branches, &seen, values)
            {
                let (graph, root) = self.base.graph.part(root);
                let compiled = Arc::new(Compiled::from_graph(graph, root, values));
                self.patches.push(Patch { branches, compiled });
            }
        }
        let mut apart = Vec::new();
        for pair in &tangent {
            let pair = ascending(pair.map(|branch| self.patch_of(branch)));
            if pair[0] != pair[1] && !pair.iter().any(|&patch| self.is_limit(patch, values)) {
                apart.push(pair);
            }
        }
        apart.sort_unstable();
        apart.dedup();
        self.apart = apart;
    }

    /// The number of the patch that a branch belongs to.
    fn patch_of(&self, branch: u32) -> u32 {
        let patch = self.patches.iter().find(|patch| patch.branches.contains(&branch));
        patch.map_or(branch, |patch| patch.branches[0])
    }

    /// The number of the patch at `p`.
    pub(super) fn patch_at(&mut self, values: &[f64], p: DVec3) -> u32 {
        let branch = self.at(values, p);
        self.patch_of(branch)
    }

    /// The patches of the branches that are [`Branches::within`] a box.
    pub(super) fn patches_within(&mut self, values: &[f64], bounds: &Bounds) -> Option<Vec<u32>> {
        let branches = self.within(values, bounds)?;
        let mut patches: Vec<u32> = branches.into_iter().map(|branch| self.patch_of(branch)).collect();
        patches.sort_unstable();
        patches.dedup();
        Some(patches)
    }

    /// The function of the patch of this number; none if f is smooth everywhere.
    ///
    /// # Panics
    ///
    /// If there is no such patch.
    pub(super) fn patch(&mut self, number: u32, values: &[f64]) -> Option<Arc<Compiled>> {
        match self.patches.iter().find(|patch| patch.branches[0] == number) {
            Some(patch) => Some(Arc::clone(&patch.compiled)),
            None => self.compiled(number, values),
        }
    }

    /// Finds out how the branches of the surface meet in these cells of the box.
    pub(super) async fn meetings(&mut self, values: &[f64], bounds: &Bounds, cells: &[Bounds]) -> Meetings {
        let mut found = Meetings::default();
        for cell in cells {
            pause().await;
            let branches = self.within(values, cell);
            let are_settled = |branches: Vec<u32>| {
                let mut pairs = (1..branches.len()).flat_map(|k| (0..k).map(move |j| [j, k]));
                pairs.all(|pair| self.is_settled(values, pair.map(|k| branches[k]), cell.middle(), &found))
            };
            if !branches.is_some_and(are_settled) {
                self.look_into(values, bounds, cell, &mut found);
            }
        }
        found.seen.sort_unstable();
        for pairs in [&mut found.tangent, &mut found.sharp] {
            pairs.sort_unstable();
            pairs.dedup();
        }
        found
    }

    /// Whether two branches need no further look near a point: it is known that they meet at an
    /// angle somewhere and without an edge elsewhere, or one of the two is known, and the normals
    /// near the point exclude the other.
    fn is_settled(&mut self, values: &[f64], pair: [u32; 2], p: DVec3, found: &Meetings) -> bool {
        let is_known = [&found.tangent, &found.sharp].map(|pairs| pairs.contains(&pair));
        if is_known[0] == is_known[1] {
            return is_known[0];
        }
        let [u, v] = pair.map(|branch| {
            let branch = self.compiled(branch, values);
            let slope = branch.map(|branch| branch.first_order([p], &mut self.jets)[0]);
            slope.map_or(DVec3::ZERO, |(_, gradient)| gradient.normalize_or_zero())
        });
        // A vanishing gradient says nothing.
        let are_there = u != DVec3::ZERO && v != DVec3::ZERO;
        are_there && if is_known[0] { u.distance(v) < ALIKE } else { u.dot(v) < PARALLEL }
    }

    /// Projects points of a cell onto the surface, and finds out how the branches there meet.
    fn look_into(&mut self, values: &[f64], bounds: &Bounds, cell: &Bounds, found: &mut Meetings) {
        let reach = 2.0 * cell.diagonal();
        let mut landed: Vec<Landed> = Vec::new();
        // They lie a little outside of the corners: no smooth join passes between two cells.
        let around = Bounds::new(cell.lo() - 0.65 * cell.size(), cell.hi() + 0.85 * cell.size());
        for start in around.spread(2) {
            let Some(place) = self.landed(values, start, reach).filter(|place| bounds.holds(place.position))
            else {
                continue;
            };
            if !found.seen.contains(&place.branch) {
                found.seen.push(place.branch);
            }
            if landed.iter().all(|other| other.branch != place.branch) {
                landed.push(place);
            }
        }
        for k in 1..landed.len() {
            for j in 0..k {
                let pair = ascending([landed[j].branch, landed[k].branch]);
                let [is_limit, other] = pair.map(|branch| self.is_limit(branch, values));
                if is_limit != other || self.is_settled(values, pair, landed[k].position, found) {
                    continue;
                }
                match self.between(values, [landed[j], landed[k]], APART * bounds.diagonal()) {
                    Some((pair, _)) if self.is_limit(pair[0], values) != self.is_limit(pair[1], values) => {}
                    Some((pair, Some(Meet::Sharp))) => {
                        found.sharp.push(pair);
                        found.edges.push(*cell);
                    }
                    Some((pair, Some(Meet::Tangent))) => found.tangent.push(pair),
                    Some((pair, None)) => found.open.push(pair),
                    None => found.is_lost = true,
                }
            }
        }
    }

    /// The two branches that meet between two points of the surface, and how they do, if no
    /// gradient vanishes there. None if the surface is not found between the points.
    fn between(&mut self, values: &[f64], ends: [Landed; 2], apart: f64) -> Option<([u32; 2], Option<Meet>)> {
        let [mut from, mut to] = ends;
        let mut halvings = 0..MOST_HALVINGS;
        while from.position.distance(to.position) > apart {
            halvings.next()?;
            let distance = from.position.distance(to.position);
            let middle = self.landed(values, 0.5 * (from.position + to.position), 0.5 * distance)?;
            if middle.branch == from.branch {
                from = middle;
            } else {
                to = middle;
            }
        }
        let meet = Meet::of_gradients([from, to].map(|end| self.slope(values, end.position).1));
        Some((ascending([from.branch, to.branch]), meet))
    }

    /// The point of the surface to which Newton's method leads from `start`, within `reach`.
    fn landed(&mut self, values: &[f64], start: DVec3, reach: f64) -> Option<Landed> {
        let limits = StepLimits { reach, at_rest: AT_REST * reach, ..StepLimits::steps(STEPS) };
        let (position, ()) =
            newton::land(start, limits, |p| Some((step_to_surface(self.slope(values, p)), ())))?;
        Some(Landed { position, branch: self.at(values, position) })
    }

    /// f and its gradient, by the branch at a point: f itself may have none where a choice is tied.
    fn slope(&mut self, values: &[f64], p: DVec3) -> Slope {
        let number = self.at(values, p);
        let Some(branch) = self.compiled(number, values) else { return (f64::NAN, DVec3::ZERO) };
        let [slope] = branch.first_order([p], &mut self.jets);
        slope
    }

    /// The node of a function whose zeros are the patch of these branches: f with each choice
    /// resolved that takes the same side on all of them. None if another branch of the surface
    /// could still be reached.
    fn patch_root(&mut self, members: &[u32], seen: &[u32], values: &[f64]) -> Option<Id> {
        let mut allowed: Vec<Side> = Vec::new();
        let ways = self.ways(0, MOST_WAYS, &mut |_| Holds::Somewhere);
        if ways.len() == MOST_WAYS {
            return None;
        }
        for way in ways {
            let reached = self.reached(&way.holds, values)?;
            if reached.iter().any(|branch| members.contains(branch)) {
                allowed.extend(way.sides());
            }
        }
        let only = |condition: ChoiceCondition| match [true, false]
            .map(|holds| allowed.contains(&(condition, holds)))
        {
            [true, false] => Holds::Always,
            [false, true] => Holds::Never,
            _ => Holds::Somewhere,
        };
        // Choices left open independently may combine to branches of other patches.
        for way in self.ways(0, MOST_WAYS, &mut |condition| only(condition)) {
            let is_other = |branch: &u32| seen.contains(branch) && !members.contains(branch);
            if self.reached(&way.holds, values)?.iter().any(is_other) {
                return None;
            }
        }
        let nodes = self.parts[0].nodes.clone();
        let mut map: Vec<Id> = (0..self.base.graph.len() as Id).collect();
        let graph = &mut self.base.graph;
        let zero = graph.constant(0.0);
        for id in nodes {
            let new = |id: Id| map[id as usize];
            let node = graph.node(id);
            let NodeRole::Choice(condition) = self.base.roles[id as usize] else {
                map[id as usize] = graph.built(node.mapped(new));
                continue;
            };
            let mut operand = |holds: bool| resolved(graph, node, holds, new);
            map[id as usize] = match only(condition) {
                Holds::Always => operand(true),
                Holds::Never => operand(false),
                Holds::Somewhere => {
                    let [u, v] = [true, false].map(operand);
                    match condition {
                        ChoiceCondition::AtMost(a, b) => graph.select(a, b, u, v),
                        ChoiceCondition::NotNegative(a) => graph.select(zero, a, u, v),
                    }
                }
            };
        }
        let root = map[self.parts[0].root as usize];
        self.base.extend(values);
        Some(root)
    }

    /// The branches that a combination of sides of the choices of f leads to; none if there are too
    /// many.
    fn reached(&mut self, holds: &[bool], values: &[f64]) -> Option<Vec<u32>> {
        let mut reached = Vec::new();
        let mut open = vec![(0, holds.to_vec())];
        while let Some((of, holds)) = open.pop() {
            let part = self.taken(of, &holds, values);
            if part.is_tie {
                continue;
            }
            match self.parts[part.index].number {
                Some(number) => reached.push(number),
                None => {
                    let ways = self.ways(part.index, MOST_WAYS, &mut |_| Holds::Somewhere);
                    open.extend(ways.into_iter().map(|way| (part.index, way.holds)));
                }
            }
            if open.len() + reached.len() > MOST_WAYS {
                return None;
            }
        }
        Some(reached)
    }
}

fn ascending([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}
