//! The places where the pieces of a formula's surface meet.
//!
//! Where a surface crosses the tie of a choice, at which both operands are equal, two branches of f
//! meet: at an edge if the gradient of f jumps there, else smoothly, as in |x|³, or with the same
//! function on both sides. A minimum of functions whose zeros stay apart has no such place. A
//! search bisects the box, and excludes by interval arithmetic the cells where f has no zero, or
//! where no choice both ties and affects f. In the cells that are left, [`patches`](super::patches)
//! finds out how the branches meet.

use super::branches::{Base, BranchPart, Branches, Holds, NodeRole, taken};
use super::compiled::Compiled;
use super::graph::{Id, Node};
use super::operations::Unary;
use super::{interval, steps};
use crate::field::MARGIN;
use crate::math::Bounds;
use crate::slices::pause;
use std::sync::Arc;

/// Maximum number of cells that a search visits. The cells left are then returned as they are,
/// wider.
const MOST_VISITED: usize = 1 << 17;

/// A choice keeps sheets apart if no cell of the search, divided to this share of its width, may
/// contain its tie: 300 cells along each axis.
const FINEST: f64 = 0.25;

/// Maximum number of steps in a cell whose combinations of sides are all bounded: three at a corner
/// of a lattice, and one more.
const MOST_OPEN_STEPS: usize = 4;

impl Branches {
    /// Cells of another box, no wider than `width`, that contain all places where patches meet.
    pub(super) async fn cells_between(&mut self, values: &[f64], bounds: &Bounds, width: f64) -> Vec<Bounds> {
        let Some(ties) = Ties::of(self, values) else { return Vec::new() };
        let found = ties.search(self, values).cells(&ties.choices, vec![*bounds], width, usize::MAX).await;
        self.between_patches(values, found).await
    }

    /// Those of the cells that more than one patch may pass.
    async fn between_patches(&mut self, values: &[f64], cells: Vec<Bounds>) -> Vec<Bounds> {
        let mut found = Vec::new();
        for cell in cells {
            pause().await;
            let patches = self.patches_within(values, &cell);
            found.extend(patches.is_none_or(|patches| patches.len() > 1).then_some(cell));
        }
        found
    }

    /// Cells of the box, no wider than `width`, that contain all places where patches of the
    /// surface meet, and the branches of the function, joined into patches; no cells if the surface
    /// has no edge. Products are split into factors if these cross; otherwise floors, folds and
    /// ridges are choices.
    pub(super) async fn found_in(
        f: &Compiled,
        values: &[f64],
        bounds: &Bounds,
        width: f64,
    ) -> (Vec<Bounds>, Self) {
        if let Some(mut branches) = Self::of_factors(f, values) {
            let cells = branches.take_patches(values, bounds, width).await;
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
        let cells = branches.take_patches(values, bounds, width).await;
        (cells, branches)
    }

    /// Finds out how the branches meet in the box, and joins those that meet without an edge into
    /// patches. Returns the cells between patches. If no edge is found the surface is one patch, in
    /// as many sheets as its choices keep apart.
    async fn take_patches(&mut self, values: &[f64], bounds: &Bounds, width: f64) -> Vec<Bounds> {
        let Some(ties) = Ties::of(self, values) else {
            *self = Self::default();
            return Vec::new();
        };
        // What is proven holds in a margin around the box, too.
        let around = bounds.enlarged(2.0 * MARGIN * bounds.size().max_element());
        let mut cells = ties.search(self, values).cells(&ties.choices, vec![around], width, usize::MAX).await;
        let meetings = self.meetings(values, &around, &cells).await;
        if !self.products.is_empty() {
            let search = ties.search(self, values);
            if !meetings.edges.iter().any(|edge| search.is_tied(edge, &self.products)) {
                return Vec::new();
            }
        }
        if !self.has_limits() && (cells.is_empty() || !meetings.may_have_edges()) {
            let tied = ties.search(self, values).tied_in(&ties.choices, &cells, FINEST * width).await;
            *self = self.separated(&tied, values);
            return Vec::new();
        }
        self.join_tangent(values, meetings).await;
        self.crease(values, bounds);
        cells.retain(|cell| !cell.is_apart_from(bounds));
        self.between_patches(values, cells).await
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

/// The choices of a function, each with its tie.
struct Ties {
    choices: Vec<Id>,
    ties: Vec<Tie>,
    /// The choices between whole numbers.
    steps: Vec<Id>,
}

impl Ties {
    /// The ties of the choices that f depends on; none if it depends on no choice.
    fn of(branches: &mut Branches, values: &[f64]) -> Option<Self> {
        let Branches { base, parts, .. } = branches;
        let part = parts.first().filter(|part| part.number.is_none())?;
        let is_choice = |id: &Id| matches!(base.roles[*id as usize], NodeRole::Choice(_));
        let choices: Vec<Id> = part.nodes.iter().copied().filter(is_choice).collect();
        let mut ties = Vec::with_capacity(choices.len());
        for &choice in &choices {
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
        let steps = choices.iter().copied().filter(|&id| base.is_step(id)).collect();
        Some(Self { choices, ties, steps })
    }

    fn search<'a>(&'a self, branches: &'a Branches, values: &'a [f64]) -> TieSearch<'a> {
        let Branches { base, parts, .. } = branches;
        TieSearch { base, part: &parts[0], ties: &self.ties, steps: &self.steps, values }
    }
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
    /// Whether f depends on each node in the cell.
    is_reached: Vec<bool>,
}

/// A search of a box for the places of the surface where choices are tied.
struct TieSearch<'a> {
    base: &'a Base,
    part: &'a BranchPart,
    ties: &'a [Tie],
    /// The choices between whole numbers.
    steps: &'a [Id],
    values: &'a [f64],
}

impl TieSearch<'_> {
    /// Cells within those of `open` in which one of these choices may be tied on the surface, at
    /// most so many. They are no wider than `width`, except at the end of a long search.
    async fn cells(&self, choices: &[Id], mut open: Vec<Bounds>, width: f64, most: usize) -> Vec<Bounds> {
        let (mut scratch, mut found) = (TieScratch::default(), Vec::new());
        let mut left = MOST_VISITED;
        while found.len() < most
            && let Some(cell) = open.pop()
        {
            if left == 0 {
                found.push(cell);
                continue;
            }
            left -= 1;
            pause().await;
            let open_to = self.open_to(&cell, choices, &mut scratch);
            if open_to.iter().any(|&id| self.may_be_tied(id, &cell, &mut scratch)) {
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

    /// Those of these choices that cells of this width in one of `cells` do not exclude from being
    /// tied on the surface.
    async fn tied_in(&self, choices: &[Id], cells: &[Bounds], width: f64) -> Vec<Id> {
        let (mut scratch, mut tied, mut apart) = (TieScratch::default(), Vec::new(), choices.to_vec());
        for cell in cells {
            pause().await;
            for id in self.open_to(cell, &apart, &mut scratch) {
                if !self.cells(&[id], vec![*cell], width, 1).await.is_empty() {
                    tied.push(id);
                }
            }
            apart.retain(|id| !tied.contains(id));
        }
        tied
    }

    /// Whether one of these choices may be tied on the surface in the cell.
    fn is_tied(&self, cell: &Bounds, choices: &[Id]) -> bool {
        let mut scratch = TieScratch::default();
        let open_to = self.open_to(cell, choices, &mut scratch);
        open_to.iter().any(|&id| self.may_be_tied(id, cell, &mut scratch))
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
    /// which f depends there; none if f has no zero in it.
    fn open_to(&self, cell: &Bounds, choices: &[Id], scratch: &mut TieScratch) -> Vec<Id> {
        let (base, part) = (self.base, self.part);
        let TieScratch { ranges, is_reached, .. } = scratch;
        interval::bounds(&base.graph, &part.nodes, self.values, cell, ranges);
        let range = |id: Id| ranges[id as usize].at(0);
        let mut open_to = Vec::new();
        if range(part.root).is_nonzero() {
            return open_to;
        }
        is_reached.clear();
        is_reached.resize(part.root as usize + 1, false);
        is_reached[part.root as usize] = true;
        for &id in part.nodes.iter().rev().filter(|&&id| !base.graph.is_uniform(id)) {
            if !is_reached[id as usize] {
                continue;
            }
            let (role, node) = (base.roles[id as usize], base.graph.node(id));
            let mut need = |id: Id| is_reached[id as usize] = true;
            match role {
                NodeRole::Choice(condition) => {
                    let holds = condition.in_box(range);
                    if holds == Holds::Somewhere && choices.contains(&id) {
                        open_to.push(id);
                    }
                    for (side, other) in [(true, Holds::Never), (false, Holds::Always)] {
                        taken(node, side).filter(|_| holds != other).into_iter().for_each(&mut need);
                    }
                }
                NodeRole::Raised(u) => need(u),
                NodeRole::Plain => node.operands(need),
            }
        }
        open_to
    }
}
