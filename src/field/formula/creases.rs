//! The choices of a formula that crease its surface.
//!
//! Where a surface crosses the tie of a choice, at which both operands are equal, it has a crease
//! if the gradient of f jumps there, else a *smooth tie*. |x| makes one in a blend that ignores it
//! near x = 0. A minimum of functions whose zeros stay apart makes neither. A search bisects the
//! box, and excludes by interval arithmetic the cells where f has no zero, or where no choice both
//! ties and affects f. In each cell that is left, Newton's method finds a place where f and the
//! difference of the operands vanish, and the gradients on both sides of it are compared. The
//! choices that crease the surface are then narrowed down to smaller cells, in which the creases
//! are followed.

use super::branches::{Base, BranchPart, Branches, ChoiceCondition, Holds, NodeRole, taken};
use super::compiled::Compiled;
use super::graph::{Id, MIN_BLEND_WIDTH, Node};
use super::operations::Unary;
use super::{interval, scalar, steps};
use crate::field::MARGIN;
use crate::math::newton::{STEPS, step_to_curve};
use crate::math::{Bounds, Meet};
use crate::slices::pause;
use glam::DVec3;
use std::sync::Arc;

/// Number of bisections of the box before Newton's method is tried: 32 cells on every axis. Fewer
/// leave more edges open.
const DEPTH: u32 = 15;

/// Number of bisections after which a choice that can be neither excluded nor tested is judged by
/// other cells; if none of them shows how its operands meet, it counts: 256 cells on every axis.
/// Fewer leave more edges open; more take longer.
const DEEPEST: u32 = 24;

/// Maximum number of cells of a search, as many as there are after [`DEPTH`] bisections. Choices
/// that are not decided by then get as many again.
const MAX_CELLS: usize = 1 << DEPTH;

/// Maximum number of cells that are visited to narrow creases down. The cells left are then
/// returned as they are, wider.
const MOST_VISITED: usize = 1 << 18;

/// Maximum number of steps in a cell whose combinations of sides are all bounded: three at a corner
/// of a lattice, and one more.
const MOST_OPEN_STEPS: usize = 4;

/// Distance from the tie at which gradients are compared, and a hundred times the error of the
/// tie's place; as a share of the diagonal of the box.
const STEP: f64 = 1e-6;

/// How far f depends on a choice in a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum TieReach {
    /// Another choice or the box excludes it.
    Nowhere,
    /// Only blends exclude it.
    Blended,
    Reached,
}

/// A cell, with the choices that are in question there.
struct TieCell {
    bounds: Bounds,
    depth: u32,
    choices: Vec<Id>,
}

impl Branches {
    /// Cells of another box, no wider than `width`, that contain all creases in it.
    pub(super) async fn crease_cells(&mut self, values: &[f64], bounds: &Bounds, width: f64) -> Vec<Bounds> {
        let width_of_smooth = (!self.apart.is_empty()).then_some(2.0 * width);
        let found = self.search_creases(values, bounds, width, width_of_smooth).await;
        self.with_smooth(values, found)
    }

    /// The cells with creases, and those in which different patches meet without an edge.
    fn with_smooth(&mut self, values: &[f64], TieCells { mut creases, smooth, .. }: TieCells) -> Vec<Bounds> {
        let apart = self.apart.clone();
        if !apart.is_empty() {
            creases.extend(smooth.into_iter().filter(|cell| {
                let patches = self.patches_within(values, cell).unwrap_or_default();
                apart.iter().any(|pair| pair.iter().all(|patch| patches.contains(patch)))
            }));
        }
        creases
    }

    /// Cells of the box, no wider than `width`, that contain all creases of the surface of a
    /// function, and the branches of the function, joined into patches; empty if no choice makes a
    /// crease. Products are split into factors if these cross; otherwise floors, folds and ridges
    /// are choices.
    pub(super) async fn found_in(
        f: &Compiled,
        values: &[f64],
        bounds: &Bounds,
        width: f64,
    ) -> (Vec<Bounds>, Self) {
        if let Some(mut branches) = Self::of_factors(f, values) {
            let cells = branches.take_creases(values, bounds, width).await;
            if !cells.is_empty() {
                return (cells, branches);
            }
        }
        let rewritten = steps::as_choices(f, values, bounds);
        let is_rewritten = rewritten.is_some();
        let mut branches = match rewritten {
            Some((graph, root)) => Self::of(&graph, root, &[], values),
            None => Self::new(f, values),
        };
        branches.is_rewritten = is_rewritten;
        let cells = branches.take_creases(values, bounds, width).await;
        (cells, branches)
    }

    async fn take_creases(&mut self, values: &[f64], bounds: &Bounds, width: f64) -> Vec<Bounds> {
        let found = self.search_creases(values, bounds, width, Some(2.0 * width)).await;
        if found.creases.is_empty() && self.has_limits() {
            self.crease(values, bounds);
            return found.creases;
        }
        if found.creases.is_empty() {
            *self = found.tied.map_or_else(Self::default, |tied| self.separated(&tied, values));
            return found.creases;
        }
        let is_smooth = self.join_tangent(values, bounds, &found.smooth).await;
        self.crease(values, bounds);
        if is_smooth && !self.has_limits() { Vec::new() } else { self.with_smooth(values, found) }
    }

    /// Records that the branches of a surface in a box meet in creases there.
    fn crease(&mut self, values: &[f64], bounds: &Bounds) {
        self.factors.clear();
        for number in self.within(values, bounds).unwrap_or_default() {
            if !self.is_limit(number, values) {
                let count = self.compiled(number, values).map_or(0, |compiled| compiled.factors().len());
                self.factors.extend((0..count).map(|own| (number, own)));
            }
        }
        if !self.products.is_empty() {
            let (graph, root) = self.base.graph.part(self.parts[0].root);
            self.split = Some(Arc::new(Compiled::from_graph(graph, root, values)));
        }
    }

    /// Cells of a box that contain all creases of f, and all smooth ties if `width_of_smooth` is
    /// given. Empty if f has no choices that make creases, or is a product whose factors do not
    /// cross there.
    async fn search_creases(
        &mut self,
        values: &[f64],
        bounds: &Bounds,
        width: f64,
        width_of_smooth: Option<f64>,
    ) -> TieCells {
        let mut found = TieCells::default();
        let Some(part) = self.parts.first().filter(|part| part.number.is_none()) else { return found };
        let is_choice = |id: &Id| matches!(self.base.roles[*id as usize], NodeRole::Choice(_));
        let choices: Vec<Id> = part.nodes.iter().copied().filter(is_choice).collect();
        let ties = ties_of(&mut self.base, part, &choices, values);
        let steps: Vec<Id> = choices.iter().copied().filter(|&id| self.base.is_step(id)).collect();
        let around = bounds.enlarged(2.0 * MARGIN * bounds.size().max_element());
        let search = |bounds| TieSearch {
            base: &self.base,
            products: &self.products,
            part,
            ties: &ties,
            steps: &steps,
            values,
            bounds,
        };
        let mut meets = search(&around).meets(&choices).await;
        let search = search(bounds);
        // Either all products are split into factors, or none.
        if self.products.iter().any(|&id| meets[id as usize] == Some(Meet::Sharp)) {
            self.products.iter().for_each(|&id| meets[id as usize] = Some(Meet::Sharp));
        } else if !self.products.is_empty() {
            return found;
        }
        let of = |is_wanted: fn(Meet) -> bool| -> Vec<Id> {
            (0..).zip(&meets).filter(|(_, meet)| meet.is_some_and(is_wanted)).map(|(id, _)| id).collect()
        };
        found.tied = Some(of(|_| true));
        let creasing = of(|meet| meet == Meet::Sharp);
        found.creases = search.cells(&creasing, TieReach::Reached, width).await;
        if let Some(width) = width_of_smooth.filter(|_| !creasing.is_empty()) {
            found.smooth = search.cells(&of(|_| true), TieReach::Blended, width).await;
        }
        found
    }
}

/// Cells of a box in which choices may be tied on the surface.
#[derive(Default)]
struct TieCells {
    /// Cells with the choices that crease the surface somewhere.
    creases: Vec<Bounds>,
    /// Cells with all choices that are tied on the surface somewhere.
    smooth: Vec<Bounds>,
    /// The choices that are tied on the surface somewhere in the box or in the margin of the proofs
    /// around it; none if that is not known.
    tied: Option<Vec<Id>>,
}

/// f on the tie of a choice: functions that equal f where the choice is reached and its operands
/// are equal. Their bounds are tighter than those of f, and all must contain zero where the surface
/// crosses the tie.
///
/// |f| − t/2 |∇f| is the greater of f − t/2 |∇f| and −f − t/2 |∇f|. Where both are equal it is −t/2
/// |∇f|, which has no zero.
struct Tie {
    choice: Id,
    /// f with the choice replaced by its first operand, by its second one, and by half of their
    /// sum.
    roots: Vec<Id>,
    /// The nodes that the roots need and f does not, in the order of the graph.
    nodes: Vec<Id>,
}

/// The ties of these choices, in their order.
fn ties_of(base: &mut Base, part: &BranchPart, choices: &[Id], values: &[f64]) -> Vec<Tie> {
    let mut ties = Vec::with_capacity(choices.len());
    for &choice in choices {
        let tied = match base.graph.node(choice) {
            Node::Unary(Unary::Abs, _) => vec![base.graph.constant(0.0)],
            // Successive whole numbers are nowhere equal.
            Node::Select(_, _, _, a, b) if base.is_step(choice) => vec![a, b],
            Node::Binary(_, a, b) | Node::Smin(_, a, b, _) | Node::Select(_, _, _, a, b) => {
                vec![a, b, base.graph.combination([(a, 0.5), (b, 0.5)])]
            }
            _ => Vec::new(),
        };
        let roots = tied.into_iter().map(|tied| base.root_with(part, choice, tied)).collect();
        ties.push(Tie { choice, roots, nodes: Vec::new() });
    }
    base.extend(values);
    for tie in &mut ties {
        tie.nodes = base.graph.needed_by(&tie.roots);
        tie.nodes.retain(|id| part.nodes.binary_search(id).is_err());
    }
    ties
}

impl Base {
    /// Whether a node is a number, or a choice between numbers.
    fn is_step(&self, id: Id) -> bool {
        match self.graph.node(id) {
            Node::Select(_, _, _, a, b) => self.is_step(a) && self.is_step(b),
            _ => self.graph.is_uniform(id),
        }
    }

    /// The root of a part with a choice replaced by another node. Choices on the only path up from
    /// it take the operand on that path.
    fn root_with(&mut self, part: &BranchPart, choice: Id, other: Id) -> Id {
        let mut uses = vec![0_u32; self.graph.len()];
        part.nodes.iter().for_each(|&id| self.graph.node(id).operands(|operand| uses[operand as usize] += 1));
        let mut map: Vec<Id> = (0..self.graph.len() as Id).collect();
        map[choice as usize] = other;
        // The last node, so far, of the only path up from the choice.
        let mut last = Some(choice);
        for &id in part.nodes.iter().filter(|&&id| id > choice) {
            let new = |operand: Id| map[operand as usize];
            let node = self.graph.node(id);
            let mut changed = Vec::new();
            node.operands(|operand| changed.extend((new(operand) != operand).then_some(operand)));
            let Some(&operand) = changed.first() else { continue };
            let is_way = last == Some(operand) && uses[operand as usize] == 1;
            last = is_way.then_some(id);
            let is_one_of_two = matches!(self.roles[id as usize], NodeRole::Choice(_))
                && matches!(node, Node::Binary(..) | Node::Smin(..) | Node::Select(..));
            map[id as usize] =
                if is_way && is_one_of_two { new(operand) } else { self.graph.built(node.mapped(new)) };
        }
        map[part.root as usize]
    }
}

/// Memory that the cells of a search use again.
#[derive(Default)]
struct TieScratch {
    ranges: Vec<interval::Row<1>>,
    /// The bounds with each step that crosses the cell fixed to one side.
    stepped: Vec<interval::Row<1>>,
    reaches: Vec<TieReach>,
}

/// A search of a box for the places of the surface where choices are tied.
struct TieSearch<'a> {
    base: &'a Base,
    /// The choices that stand for products.
    products: &'a [Id],
    part: &'a BranchPart,
    ties: &'a [Tie],
    /// The choices between whole numbers.
    steps: &'a [Id],
    values: &'a [f64],
    bounds: &'a Bounds,
}

impl TieSearch<'_> {
    /// For each node how its operands meet, if it is one of the `choices` and tied somewhere on the
    /// surface.
    async fn meets(&self, choices: &[Id]) -> Vec<Option<Meet>> {
        let mut meets = vec![None; self.part.root as usize + 1];
        let mut open = vec![TieCell { bounds: *self.bounds, depth: 0, choices: choices.to_vec() }];
        let (mut scratch, mut jets) = (TieScratch::default(), Vec::new());
        let (mut left, mut is_extended) = (MAX_CELLS, false);
        // Choices that some cell leaves undecided.
        let mut doubted = Vec::new();
        while let Some(mut cell) = open.pop() {
            cell.choices.retain(|&id| meets[id as usize] != Some(Meet::Sharp));
            if cell.choices.is_empty() {
                continue;
            }
            if left == 0 {
                // What is known by now holds for all of the surface; the rest of the box is
                // searched for the other choices.
                if is_extended {
                    doubted.append(&mut cell.choices);
                    continue;
                }
                (is_extended, left) = (true, MAX_CELLS);
            }
            if is_extended {
                cell.choices.retain(|&id| meets[id as usize].is_none());
                if cell.choices.is_empty() {
                    continue;
                }
            }
            left -= 1;
            pause().await;
            let tied = self.tied(&cell.bounds, &cell.choices, &mut scratch);
            cell.choices.retain(|id| {
                let Some((_, reach)) = tied.iter().find(|(tied, _)| tied == id) else { return false };
                if cell.depth < DEPTH {
                    return true;
                }
                let meet = match reach {
                    TieReach::Reached => self.meet(*id, &cell.bounds, &mut scratch, &mut jets),
                    TieReach::Blended | TieReach::Nowhere => Some(Meet::Tangent),
                };
                if meet.is_none() && cell.depth < DEEPEST {
                    return true;
                }
                let known = &mut meets[*id as usize];
                *known = (*known).max(meet);
                doubted.extend(meet.is_none().then_some(*id));
                false
            });
            if !cell.choices.is_empty() {
                for half in cell.bounds.halves() {
                    open.push(TieCell { bounds: half, depth: cell.depth + 1, choices: cell.choices.clone() });
                }
            }
        }
        for id in doubted {
            meets[id as usize].get_or_insert_with(|| self.meet_in_doubt(id));
        }
        meets
    }

    /// How the operands of a choice are taken to meet if no place where they are tied is found: at
    /// an edge, unless the choice stands for a product. That is split only if its factors cross:
    /// unsplit, it shows where they touch.
    fn meet_in_doubt(&self, id: Id) -> Meet {
        if self.products.contains(&id) { Meet::Tangent } else { Meet::Sharp }
    }

    /// Cells in which one of these choices may be tied on the surface with at least this reach.
    /// They are no wider than `width`, except at the end of a long search.
    async fn cells(&self, choices: &[Id], least: TieReach, width: f64) -> Vec<Bounds> {
        let (mut scratch, mut found) = (TieScratch::default(), Vec::new());
        let mut open = if choices.is_empty() { Vec::new() } else { vec![*self.bounds] };
        let mut left = MOST_VISITED;
        while let Some(cell) = open.pop() {
            if left == 0 {
                found.push(cell);
                continue;
            }
            left -= 1;
            pause().await;
            let open_to = self.open_to(&cell, choices, &mut scratch);
            let is_tied =
                |&(id, reach): &(Id, TieReach)| reach >= least && self.may_be_tied(id, &cell, &mut scratch);
            if open_to.iter().any(is_tied) {
                if cell.size().max_element() > width {
                    let [low, high] = cell.halves();
                    open.extend([high, low]);
                } else {
                    found.push(cell);
                }
            }
        }
        found
    }

    /// The choices, out of `choices`, that may be tied somewhere in the cell, with their reach;
    /// none if f has no zero in it.
    fn tied(&self, cell: &Bounds, choices: &[Id], scratch: &mut TieScratch) -> Vec<(Id, TieReach)> {
        let mut open_to = self.open_to(cell, choices, scratch);
        open_to.retain(|&(id, _)| self.may_be_tied(id, cell, scratch));
        open_to
    }

    /// Whether f may be zero in the cell where a choice is tied, which the cell is
    /// [open to](Self::open_to).
    ///
    /// A function of a whole number that differs between two steps has wide bounds over a cell that
    /// both steps reach, however small the cell is: a hash, for one, jumps from any value to any
    /// other. So the bounds are computed anew for either side of each step.
    fn may_be_tied(&self, id: Id, cell: &Bounds, scratch: &mut TieScratch) -> bool {
        let Tie { roots, nodes, .. } = &self.ties[self.ties.partition_point(|tie| tie.choice < id)];
        let TieScratch { ranges, stepped, .. } = scratch;
        let graph = &self.base.graph;
        let may_vanish =
            |ranges: &[interval::Row<1>]| !roots.iter().any(|&root| ranges[root as usize].at(0).is_nonzero());
        interval::bounds(graph, nodes, self.values, cell, ranges);
        if !may_vanish(ranges) {
            return false;
        }
        let is_open = |&step: &Id| {
            let NodeRole::Choice(condition) = self.base.roles[step as usize] else { return false };
            step != id && condition.in_box(|id| ranges[id as usize].at(0)) == Holds::Somewhere
        };
        let open: Vec<Id> = self.steps.iter().copied().filter(is_open).collect();
        if open.is_empty() || open.len() > MOST_OPEN_STEPS {
            return true;
        }
        (0..1_u32 << open.len()).any(|sides| {
            let side_of = |node: Id| {
                let k = open.iter().position(|&step| step == node)?;
                taken(graph.node(node), sides >> k & 1 == 1)
            };
            for nodes in [&self.part.nodes, nodes] {
                interval::bounds_with(graph, nodes, self.values, cell, side_of, stepped);
            }
            may_vanish(stepped)
        })
    }

    /// The choices, out of `choices`, whose operands may be equal somewhere in the cell and on
    /// which f depends there, with their reach; none if f has no zero in it.
    fn open_to(&self, cell: &Bounds, choices: &[Id], scratch: &mut TieScratch) -> Vec<(Id, TieReach)> {
        let (base, part) = (self.base, self.part);
        let TieScratch { ranges, reaches, .. } = scratch;
        interval::bounds(&base.graph, &part.nodes, self.values, cell, ranges);
        let range = |id: Id| ranges[id as usize].at(0);
        let mut open_to = Vec::new();
        if range(part.root).is_nonzero() {
            return open_to;
        }
        reaches.clear();
        reaches.resize(part.root as usize + 1, TieReach::Nowhere);
        reaches[part.root as usize] = TieReach::Reached;
        for &id in part.nodes.iter().rev().filter(|&&id| !base.graph.is_uniform(id)) {
            let reach = reaches[id as usize];
            if reach == TieReach::Nowhere {
                continue;
            }
            let (role, node) = (base.roles[id as usize], base.graph.node(id));
            let mut need = |id: Id, reach: TieReach| reaches[id as usize] = reaches[id as usize].max(reach);
            match (role, node) {
                (NodeRole::Choice(condition), _) => {
                    let holds = condition.in_box(range);
                    if holds == Holds::Somewhere && choices.contains(&id) {
                        open_to.push((id, reach));
                    }
                    for (side, other) in [(true, Holds::Never), (false, Holds::Always)] {
                        taken(node, side)
                            .filter(|_| holds != other)
                            .into_iter()
                            .for_each(|id| need(id, reach));
                    }
                }
                (NodeRole::Raised(u), _) => need(u, reach),
                // Where the operands differ by more than the width, the blend is one of them.
                (NodeRole::Plain, Node::Smin(_, a, b, k)) => {
                    let width = range(k).bounds.hi.max(MIN_BLEND_WIDTH);
                    let is_far_below = |a: Id, b: Id| range(a).bounds.hi + width < range(b).bounds.lo;
                    need(a, if is_far_below(b, a) { TieReach::Blended } else { reach });
                    need(b, if is_far_below(a, b) { TieReach::Blended } else { reach });
                    need(k, reach);
                }
                (NodeRole::Plain, _) => node.operands(|operand| need(operand, reach)),
            }
        }
        open_to
    }

    /// How the operands of choice `id` meet at a place near the cell where they are tied; none if
    /// no such place is found.
    fn meet(
        &self,
        id: Id,
        cell: &Bounds,
        scratch: &mut TieScratch,
        jets: &mut scalar::Jets<0>,
    ) -> Option<Meet> {
        let graph = &self.base.graph;
        // A place that is farther away is found from another cell.
        let reach = 2.0 * cell.diagonal();
        let size = self.bounds.diagonal();
        let NodeRole::Choice(condition) = self.base.roles[id as usize] else { return None };
        // f and the difference of the operands, which are below f in the graph, each with its
        // gradient.
        let mut at = |p: DVec3| {
            scalar::jets(graph, self.part.root, self.values, [p], jets);
            let of = |id: Id| jets[id as usize][0].first_order();
            let tie = match condition {
                ChoiceCondition::AtMost(a, b) => {
                    let ((a, of_a), (b, of_b)) = (of(a), of(b));
                    (a - b, of_a - of_b)
                }
                ChoiceCondition::NotNegative(u) => of(u),
            };
            (of(self.part.root), tie)
        };
        let mut best = None;
        // Starts off the planes of symmetry, where other choices may be tied.
        for start in cell.spread(2) {
            let mut p = start;
            for _ in 0..STEPS {
                let ((f, g), (t, h)) = at(p);
                let (gg, hh) = (g.length_squared(), h.length_squared());
                let (step, along) = step_to_curve([(f, g), (t, h)]);
                // Written so that NaN fails: gradients that are not parallel to three digits.
                let is_angle = along.length_squared() > 1e-6 * gg * hh;
                if !is_angle {
                    let is_near = |value: f64, slope_sq: f64| value * value <= slope_sq * size * size * STEP;
                    if is_near(f, gg) && is_near(t, hh) {
                        return Some(self.meet_in_doubt(id));
                    }
                    break;
                }
                if step.length() > reach {
                    break;
                }
                p -= step;
                if step.length() > 0.01 * STEP * size {
                    continue;
                }
                let around = Bounds::new(p - STEP * size, p + STEP * size);
                if !self.bounds.holds(p) || self.tied(&around, &[id], scratch) != [(id, TieReach::Reached)] {
                    break;
                }
                let across = h * (STEP * size / hh.sqrt());
                match Meet::of_gradients([p + across, p - across].map(|p| at(p).0.1)) {
                    Some(Meet::Sharp) => return Some(Meet::Sharp),
                    Some(Meet::Tangent) => best = Some(Meet::Tangent),
                    None => return Some(self.meet_in_doubt(id)),
                }
                break;
            }
        }
        best
    }
}
