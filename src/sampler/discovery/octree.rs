//! The search for a point on every connected component of the surface, with proof: interval
//! arithmetic drives a subdivision of the box.
//!
//! # The argument
//!
//! Let S be the zero set of f in the box and K a connected component of it. K is compact, so that
//! it has a highest point: of its points with the largest z those with the largest y, of these the
//! one with the largest x. Where that point q lies inside the box and f has a gradient there, no
//! direction on the surface goes up from it: ∂f/∂x = ∂f/∂y = 0. Where it lies inside a face x =
//! const., q is the highest point of K in the face, and ∂f/∂y = 0; inside a face y = const.,
//! ∂f/∂x = 0; and inside a face z = const. it is the point of the largest y there, and ∂f/∂x = 0.
//! On an edge of the box there is no condition. (Computing one point in every component from the
//! critical points of a coordinate: F. Rouillier, M.-F. Roy, M. Safey El Din, "Finding at least one
//! point in each connected component of a real algebraic set defined by a single equation", J.
//! Complexity 16, 2000.) In each of these 1 + 6 + 12 *strata* of the box one coordinate is *up*,
//! the other free ones are *sides*, and q satisfies as many equations as there are free
//! coordinates: as a rule such points are isolated, and few.
//!
//! Each stratum is therefore subdivided (an octree inside, quadtrees on the faces, binary trees on
//! the edges). A cell is *discarded* if an interval shows that f, or the derivative along a side,
//! vanishes nowhere in it. It is *decided* if f is monotone along up, not only in the cell C but in
//! a taller one H on the same footprint, and H is so tall that the surface through any point of C
//! cannot leave it over that footprint: by the mean value theorem it rises or falls by no more than
//! t = Σ max|∂f/∂side| · width / min|∂f/∂up|, all over H. Then the surface in H is the graph of a
//! function over the whole footprint, connected, and meets the line through any place of it in one
//! point, the *witness*; or C holds no point of it. (Snyder, "Interval analysis for computer
//! graphics", SIGGRAPH 1992, calls this global parametrisability; Plantinga & Vegter, "Isotopic
//! approximation of implicit curves and surfaces", SGP 2004, ask for a small variation of the
//! normal instead, of every cell that meets the surface, and obtain its topology; one point on each
//! component is cheaper.) If the highest point of a component lies in C, the witness lies on that
//! component: along the graph it never leaves through the top of the box, because nothing of the
//! component is higher, and a graph that might leave through the bottom is not accepted.
//!
//! The bounds come from the expressions and, since these are loose in all but small cells, also
//! from the mean value forms: g(C) ⊆ g(m) + g′(C)(C − m) with m the middle of C, for the
//! derivatives (with bounds of the second derivatives) and for f itself. Their excess falls with
//! the square of the width (Moore 1966). A product is searched factor by factor: near the zeros of
//! one factor the others do not matter, and where two vanish together the product has no gradient
//! but each factor has. So are the sheets that a minimum, a maximum or an absolute value keeps
//! apart: each component is one of the zeros of the operand that gives f there.
//!
//! A surface with edges is searched as a whole, by [bounds of its pieces](super::creased). If that
//! leaves a cell undecided, its patches are searched one by one, as the factors are: then each
//! component without an edge has a witness.
//!
//! Around a point where f has no gradient no cell can be decided. A [box](super::singular) around
//! it through whose boundary every component in it passes is left out of the search, as if it did
//! not belong to the box; its faces and edges are strata of the rest.
//!
//! A cell that is neither discarded nor decided is [narrowed](super::interval_newton) to the part
//! that can hold a highest point. The rest is halved along its longer sides, down to [`DEPTH`].
//! Cells that are still open then are *undecided* and reported: where the gradient vanishes on the
//! surface no interval decides.
//!
//! # What is proven
//!
//! If no cell is left undecided, every connected component of the surface in the box holds a
//! witness; without a witness there is no surface. For this the box is enlarged by [`MARGIN`], so
//! that a surface that touches it from inside is inside. At kinks the bounds hold the generalised
//! gradient, for which both arguments are the same. Where f jumps, has a pole or is not defined the
//! surface may end, and nothing is concluded from slopes.

use crate::field::{Bounded, Enclosure, MARGIN};
use crate::math::{Bounds, sort_by_key};
use crate::sampler::discovery::cell::{Axes, CUT, Cell, is_inside, is_left_out, push_boundary};
use crate::sampler::discovery::creased::Pieces;
use crate::sampler::discovery::fate::{Fate, Judge};
use crate::sampler::discovery::singular::{SAME, Singular, isolating_box, singular_point};
use crate::slices::HEAVY;
use core::ops::Range;
use glam::{DVec3, Vec3};
use std::collections::VecDeque;

/// Halvings after which a cell is left undecided: 2⁻¹⁶ of the box, a sixth of the smallest particle
/// allowed. With fewer, fewer surfaces are proven; with more, there are more cells.
const DEPTH: u8 = 16;
/// Halvings after which a cell is left undecided where f jumps or is undefined. Such cells lie
/// along curves and faces, so there are many. More halvings prove no more.
const IRREGULAR_DEPTH: u8 = 6;
/// Largest number of cells visited. A cell takes about a third of the time of a particle. Most
/// smooth surfaces of the gallery take 100 to 8,000 cells, and two take 60,000 to 70,000. Sixteen
/// cone points add none; Barth's sextic with fifty takes 36,000.
const MOST_CELLS: usize = 32_768;
/// Largest number of cells visited for f as a whole, if it has edges: its patches may have to be
/// searched after that.
const MOST_OF_EDGED: usize = 8_192;
/// Largest number of cells visited where each level has hardly more of them than the one before it:
/// the search is then near its end.
const MOST_AT_THE_END: usize = 65_536;
const HARDLY_MORE: f64 = 1.3;
/// Halvings before singular points are searched in a cell, and halvings between two tries. A
/// choice.
const SINGULAR_FROM: u8 = 3;
const SINGULAR_EVERY: u8 = 2;
/// Largest number of cells of a factor in which singular points are searched for. A curve of them
/// takes more; half as many cells then give half as many of its points.
const MOST_TRIED: usize = 512;
/// Units of work that a cell counts for. One takes 8,000 to 30,000 instructions, and a unit of the
/// front 2,400 to 5,100.
const UNITS: u32 = 8;
/// A cell is halved along the sides that are longer than this share of the longest: those closer to
/// the longest than to its half. Halving all sides makes more cells.
const LONG: f64 = 0.7;

/// The state of the search.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum SearchState {
    /// The field has no bounds.
    #[default]
    Unavailable,
    /// No cell has been visited, and whether the bounds are finite is unknown.
    Ready,
    Running,
    Done,
}

/// A point of the surface, and the factor of the field that vanishes there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Witness {
    pub(crate) position: DVec3,
    pub(crate) factor: usize,
}

/// A witness on the surface as single precision computes it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seed {
    pub(crate) position: Vec3,
    pub(crate) normal: Vec3,
    /// The witness itself.
    pub(crate) exact: DVec3,
    /// The factor of the field that vanishes at the witness.
    pub(crate) factor: usize,
}

/// The region in which components of the surface are searched for.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Region {
    /// The box of the run with a margin around it.
    pub(crate) bounds: Bounds,
    /// Width of the margin.
    pub(crate) margin: f64,
}

/// The search for witnesses, and what it has found.
#[derive(Clone, Debug, Default)]
pub(crate) struct Octree {
    state: SearchState,
    /// The region searched.
    pub(crate) region: Region,
    /// The search under way.
    search: FactorSearch,
    turns: Turns,
    judge: Judge,
    /// The number of f as a whole, if it has edges and is searched instead of its factors.
    pub(crate) edged: Option<usize>,
    /// Number of singular points that were known before the search.
    given: usize,
    /// Points where f and its gradient vanish; of curves of such points a selection.
    pub(crate) singular: Vec<Singular>,
    /// Witnesses, at least one on every component of the surface.
    pub(crate) witnesses: Vec<Witness>,
    /// The cells left undecided.
    pub(crate) undecided: Vec<Bounds>,
}

/// The search of one factor of the field.
#[derive(Clone, Debug, Default)]
struct FactorSearch {
    factor: usize,
    unnamed: Unnamed,
    /// Cells of the level under way; those before `next` have been visited.
    level: Vec<Cell>,
    next: usize,
    /// Whether the level has hardly more cells than the one before it.
    is_ending: bool,
    /// Cells of the level after it.
    halves: Vec<Cell>,
    /// Number of cells visited in this turn.
    cells: usize,
    /// Boxes left out of the search.
    isolated: Vec<Bounds>,
    /// Number of cells in which a singular point was searched for.
    searched: usize,
    /// Singular points found so far, so that each is treated once.
    met: Vec<DVec3>,
}

/// The strata of the box and the parts of the field whose cells the field has yet to name.
#[derive(Clone, Debug, Default)]
struct Unnamed {
    strata: Vec<Cell>,
    parts: usize,
    /// The next part.
    next: usize,
}

/// The searches of the factors take turns, so that those that need few cells leave their share to
/// the others: in each round every unfinished search may visit an equal share of the cells that are
/// left.
#[derive(Clone, Debug, Default)]
struct Turns {
    /// The searches that wait for a turn.
    waiting: VecDeque<FactorSearch>,
    /// Number of turns in this round, and how many of them are still to come.
    in_round: usize,
    left: usize,
    /// Number of cells visited before this round, and until now.
    before: usize,
    visited: usize,
}

impl Octree {
    /// Begins the search on a new field.
    pub(crate) fn begin(&mut self, field: Option<&mut dyn Bounded>, bounds: &Bounds) {
        self.witnesses.clear();
        self.undecided.clear();
        self.singular.clear();
        let margin = MARGIN * bounds.size().max_element();
        self.region = Region { bounds: bounds.enlarged(margin), margin };
        self.state = if field.is_some() { SearchState::Ready } else { SearchState::Unavailable };
        self.edged = field.and_then(|field| field.edged());
    }

    /// The search of a factor of the field, which begins with the box, its faces and its edges, or
    /// with the cells that the field names in these.
    fn search_of(&self, field: &mut dyn Bounded, factor: usize) -> FactorSearch {
        let mut strata = vec![Cell { bounds: self.region.bounds, level: 0 }];
        push_boundary(&mut strata, &self.region.bounds);
        let search = FactorSearch { factor, ..FactorSearch::default() };
        match field.parts(factor) {
            0 => FactorSearch { level: strata, ..search },
            parts => FactorSearch { unnamed: Unnamed { strata, parts, next: 0 }, ..search },
        }
    }

    /// Lets the field name the cells of one of its parts in all strata, and returns their number.
    fn name_cells(&mut self, field: &mut dyn Bounded) -> usize {
        let whole = self.region.bounds.size().max_element();
        let FactorSearch { factor, unnamed, level, .. } = &mut self.search;
        let (before, mut found) = (level.len(), Vec::new());
        for stratum in &unnamed.strata {
            let sides: Vec<usize> = stratum.axes().sides.into_iter().flatten().collect();
            found.clear();
            field.cells(*factor, unnamed.next, &stratum.bounds, &sides, &mut found);
            level.extend(found.iter().map(|&bounds| {
                // The level that halvings lead to at this size.
                let share = (whole / bounds.size().max_element()).clamp(1.0, f64::from(1_u32 << DEPTH));
                Cell { bounds, level: libm::floor(libm::log2(share)) as u8 }
            }));
        }
        unnamed.next += 1;
        level.len() - before
    }

    /// Gives the next search its turn. Searches with no cells left to visit end; their open cells
    /// are undecided.
    fn begin_turn(&mut self) {
        while let Some(next) = self.turns.waiting.pop_front() {
            if self.turns.left == 0 {
                self.turns.in_round = self.turns.waiting.len() + 1;
                self.turns.left = self.turns.in_round;
                self.turns.before = self.turns.visited;
            }
            self.turns.left -= 1;
            self.search = FactorSearch { cells: 0, ..next };
            if self.allowed() > 0 {
                return;
            }
            let open = self.search.level[self.search.next..].iter().chain(&self.search.halves);
            let open = open.filter(|cell| !is_left_out(cell, &self.search.isolated));
            self.undecided.extend(open.map(|cell| cell.bounds));
        }
        self.state = SearchState::Done;
        self.search = FactorSearch::default();
        // Turns separate those of a factor.
        sort_by_key(&mut self.witnesses, |witness| witness.factor as u64);
    }

    /// Number of cells that the search may visit in this turn.
    fn allowed(&self) -> usize {
        let usual = if self.edged.is_some() { MOST_OF_EDGED } else { MOST_CELLS };
        let most = if self.search.is_ending { usual.max(MOST_AT_THE_END) } else { usual };
        most.saturating_sub(self.turns.before) / self.turns.in_round
    }

    /// Whether the field can be searched by bounds.
    pub(crate) fn is_available(&self) -> bool {
        self.state != SearchState::Unavailable
    }

    /// Whether the search is complete, or not available.
    pub(crate) fn is_done(&self) -> bool {
        !matches!(self.state, SearchState::Ready | SearchState::Running)
    }

    /// Does up to `budget` units of work, rounded up to whole chunks of cells, and returns what is
    /// left.
    pub(crate) fn step(&mut self, field: &mut dyn Bounded, mut budget: u32) -> u32 {
        if self.state == SearchState::Ready {
            if bounds_say_something(field, &self.region.bounds) {
                self.given = self.singular.len();
                self.begin_searches(field);
            } else {
                self.state = SearchState::Unavailable;
            }
        }
        while budget > 0 && !self.is_done() {
            if self.search.unnamed.next < self.search.unnamed.parts {
                let named = self.name_cells(field);
                budget = budget.saturating_sub(UNITS * (1 + named) as u32);
                continue;
            }
            let count = HEAVY.min(self.search.level.len() - self.search.next);
            self.visit(field, self.search.next..self.search.next + count);
            self.search.next += count;
            self.search.cells += count;
            self.turns.visited += count;
            budget = budget.saturating_sub(UNITS * HEAVY as u32);
            if self.search.next == self.search.level.len() {
                self.search.is_ending =
                    (self.search.halves.len() as f64) < HARDLY_MORE * self.search.level.len() as f64;
                self.search.level.clear();
                core::mem::swap(&mut self.search.level, &mut self.search.halves);
                self.search.next = 0;
            }
            if self.search.level.is_empty() {
                self.begin_turn();
            } else if self.search.cells >= self.allowed() {
                self.turns.waiting.push_back(core::mem::take(&mut self.search));
                self.begin_turn();
            }
            if self.edged.is_some() && !self.undecided.is_empty() {
                self.edged = None;
                self.witnesses.clear();
                self.undecided.clear();
                self.singular.truncate(self.given);
                self.begin_searches(field);
            }
        }
        budget
    }

    /// Begins the searches of f as a whole or of its factors.
    fn begin_searches(&mut self, field: &mut dyn Bounded) {
        self.state = SearchState::Running;
        let searched = self.edged.map_or(0..field.factors(), |whole| whole..whole + 1);
        let waiting = searched.map(|factor| self.search_of(field, factor)).collect();
        self.turns = Turns { waiting, ..Turns::default() };
        self.begin_turn();
    }

    /// Visits the cells of the level in this range: each is discarded, decided, left out or halved.
    fn visit(&mut self, field: &mut dyn Bounded, range: Range<usize>) {
        let FactorSearch { factor, level, isolated, .. } = &self.search;
        let factor = *factor;
        let searched: Vec<Cell> =
            level[range].iter().filter(|cell| !is_left_out(cell, isolated)).copied().collect();
        let region = self.region.bounds;
        let fates = if self.edged == Some(factor) {
            let mut pieces = Pieces::default();
            searched.iter().filter_map(|cell| pieces.fate(field, factor, cell, &region)).collect()
        } else {
            self.judge.fates(field, factor, &region, &searched)
        };
        for fate in fates {
            match fate {
                Fate::Halved(cell) => self.halve(field, cell, DEPTH),
                Fate::Irregular(cell) => self.halve(field, cell, IRREGULAR_DEPTH),
                Fate::Doubtful(cell, known) => {
                    if !self.is_isolated(field, &cell, &known) {
                        self.halve(field, cell, DEPTH);
                    }
                }
                Fate::Decided(position) => self.witnesses.push(Witness { position, factor }),
            }
        }
    }

    /// Whether the cell lies in a box that is left out of the search: a known one, or a new one
    /// around a singular point in or near the cell.
    fn is_isolated(&mut self, field: &mut dyn Bounded, cell: &Cell, known: &Enclosure) -> bool {
        if is_left_out(cell, &self.search.isolated) {
            return true;
        }
        if known.gradient.iter().any(|slope| slope.excludes_zero()) {
            // f need not be differentiable at the tip of a cone.
            return self.isolate_tip(field, cell, 0.0);
        }
        let Axes { sides, .. } = cell.axes();
        let is_tried = cell.level >= SINGULAR_FROM
            && (cell.level - SINGULAR_FROM).is_multiple_of(SINGULAR_EVERY)
            && self.search.searched < MOST_TRIED
            && sides.iter().all(Option::is_some);
        if !is_tried {
            return false;
        }
        self.search.searched += 1;
        let reach = cell.bounds.diagonal();
        let Some(point) = singular_point(field, cell.probe(), reach) else { return false };
        let at = point.position;
        let is_known = |p: &DVec3| (*p - at).length_squared() <= SAME * SAME * reach * reach;
        if self.search.met.iter().any(is_known) {
            return false;
        }
        self.search.met.push(at);
        if point.is_zero && self.region.bounds.holds(at) {
            self.singular.push(point);
        }
        // A curve of such points passes through the faces of the box.
        point.is_alone && self.isolate(field, cell, at)
    }

    /// Leaves out a box around a known singular point in the cell, or within `room` of it; returns
    /// whether the cell lies in that box.
    fn isolate_tip(&mut self, field: &mut dyn Bounded, cell: &Cell, room: f64) -> bool {
        let around = cell.bounds.enlarged(room);
        let tip = self.singular.iter().map(|point| point.position).find(|&at| around.holds(at));
        tip.is_some_and(|at| self.isolate(field, cell, at))
    }

    /// Leaves out a box around a singular point, if possible; returns whether the cell lies in it.
    fn isolate(&mut self, field: &mut dyn Bounded, cell: &Cell, at: DVec3) -> bool {
        let isolated = &self.search.isolated;
        let Some(around) = isolating_box(field, self.search.factor, at, &self.region.bounds, isolated) else {
            return false;
        };
        self.search.isolated.push(around);
        push_boundary(&mut self.search.halves, &around);
        is_inside(cell, &around)
    }

    /// Halves a cell along its longer sides, unless it has been halved `depth` times.
    fn halve(&mut self, field: &mut dyn Bounded, cell: Cell, depth: u8) {
        if cell.level >= depth {
            // The tip of a branch need not be a tip of f, where another branch gives f next to it.
            if !self.isolate_tip(field, &cell, self.region.margin) {
                self.undecided.push(cell.bounds);
            }
            return;
        }
        let size = cell.bounds.size();
        let middle = cell.bounds.lo() + CUT * size;
        let long = LONG * size.max_element();
        let pieces = |axis: usize| if size[axis] > long { 2 } else { 1 };
        for z in 0..pieces(2) {
            for y in 0..pieces(1) {
                for x in 0..pieces(0) {
                    let mut half = Cell { level: cell.level + 1, ..cell };
                    for (axis, piece) in [x, y, z].into_iter().enumerate() {
                        if pieces(axis) == 2 {
                            let end = if piece == 0 { &mut half.bounds.max } else { &mut half.bounds.min };
                            end[axis] = middle[axis];
                        }
                    }
                    self.search.halves.push(half);
                }
            }
        }
    }
}

/// Whether the field has finite bounds at all, tested on a small box off the middle, where f may
/// have a pole.
fn bounds_say_something(field: &mut dyn Bounded, bounds: &Bounds) -> bool {
    let boxes: Vec<Bounds> = bounds.spread(1).map(|p| Bounds::new(p, p + MARGIN * bounds.size())).collect();
    let mut known = [Enclosure::UNKNOWN];
    field.enclose(0, &boxes, &mut known);
    known[0].value != Enclosure::UNKNOWN.value
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::formula::Formula;
    use crate::field::{Field, Frame};

    #[test]
    fn a_cell_has_the_same_fate_in_a_batch_as_alone() {
        // The search of one factor, with small spheres around a large one.
        let text =
            "atan((x^2 + y^2 + z^2 - 0.25)((x-0.6)^2 + y^2 + z^2 - 0.003)(x^2 + (y+0.3)^2 + z^2 - 0.01))";
        let field = Formula::as_written(text, &[]).expect("a formula");
        let mut evaluator = field.evaluator(Frame::default());
        let field = evaluator.bounded().expect("a formula has bounds");
        let begun = |field: &mut dyn Bounded| {
            let mut octree = Octree::default();
            octree.begin(Some(&mut *field), &Bounds::cube(1.0));
            octree.search = octree.search_of(field, 0);
            octree
        };
        // All results of visiting the cells, including the cells of the next level.
        let visited = |field: &mut dyn Bounded, cells: &[Cell]| {
            let mut octree = begun(field);
            octree.search.level = cells.to_vec();
            octree.visit(field, 0..cells.len());
            let mut all: Vec<Bounds> = octree.search.halves.iter().map(|cell| cell.bounds).collect();
            all.extend(octree.witnesses.iter().map(|witness| Bounds::point(witness.position)));
            all.extend(octree.undecided);
            (all, octree.search.halves)
        };
        let sorted = |all: Vec<Bounds>| {
            let mut all: Vec<[[f64; 3]; 2]> = all.into_iter().map(|cell| [cell.min, cell.max]).collect();
            all.sort_by(|a, b| a.partial_cmp(b).expect("finite corners"));
            all
        };
        let (mut cells, mut several) = (begun(field).search.level, 0);
        while !cells.is_empty() {
            let mut next = Vec::new();
            for batch in cells.chunks(HEAVY) {
                let (together, halves) = visited(field, batch);
                let alone = batch.iter().flat_map(|&cell| visited(field, &[cell]).0).collect();
                assert_eq!(sorted(together), sorted(alone), "level {}", batch[0].level);
                several += usize::from(batch.len() > 1);
                next.extend(halves);
            }
            cells = next;
        }
        assert!(several > 1, "{several} batches of several cells");
    }
}
