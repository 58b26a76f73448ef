//! A point of the surface on every connected piece of it, by proof: subdivision of the box, driven by intervals.
//!
//! # The argument
//!
//! Let S be the zero set of f in the box and K a connected piece of it. K is compact, so that it has a highest point: of
//! its points with the largest z those with the largest y, of these the one with the largest x. Where that point q lies
//! inside the box and f has a gradient there, no direction on the surface goes up from it: ∂f/∂x = ∂f/∂y = 0. Where it lies
//! inside a face x = const., q is the highest point of K in the face, and ∂f/∂y = 0; inside a face y = const., ∂f/∂x = 0; and
//! inside a face z = const. it is the point of the largest y there, and ∂f/∂x = 0. On an edge of the box nothing is asked.
//! (Computing one point in every component from the critical points of a coordinate: F. Rouillier, M.-F. Roy, M. Safey El
//! Din, "Finding at least one point in each connected component of a real algebraic set defined by a single equation",
//! J. Complexity 16, 2000.) In each of these 1 + 6 + 12 *strata* of the box one coordinate is *up*, the other free ones are
//! *sides*, and q satisfies as many equations as there are free coordinates: as a rule such points are isolated, and few.
//!
//! So each stratum is subdivided (an octree inside, quadtrees on the faces, binary trees on the edges). A cell is *discarded*
//! if an interval shows that f, or the derivative along a side, vanishes nowhere in it. It is *decided* if f is monotone along
//! up, not only in the cell C but in a taller one H on the same footprint, and H is so tall that the surface through any point of
//! C cannot leave it over that footprint: by the mean value theorem it rises or falls by no more than
//! t = Σ max|∂f/∂side| · width / min|∂f/∂up|, all over H. Then the surface in H is the graph of a function over the whole
//! footprint, connected, and meets the line through any place of it in one point, the *witness*; or C holds no point of it. (Snyder,
//! "Interval analysis for computer graphics", SIGGRAPH 1992, calls this global parametrisability; Plantinga & Vegter, "Isotopic
//! approximation of implicit curves and surfaces", SGP 2004, ask for a small variation of the normal instead, of every cell that
//! meets the surface, and obtain its topology; one point on each piece is cheaper.) If the highest point of a piece lies in C, the
//! witness lies on that piece: along the graph it never leaves through the top of the box, because nothing of the piece is
//! higher, and a graph that might leave through the bottom is not accepted.
//!
//! The bounds are those of the expressions, and, since these are loose in all but small cells, also those of the mean value forms:
//! g(C) ⊆ g(m) + g′(C)(C − m) with m the middle of C, for the derivatives (with bounds of the second derivatives) and for f itself.
//! Their excess falls with the square of the width (Moore 1966). A product is searched factor by factor: near the zeros of
//! one factor the others do not matter, and where two vanish together the product has no gradient but each factor has.
//!
//! Around a point where f has no gradient no cell can be decided. A [box](super::singular) around it through whose boundary every
//! piece in it passes is left out of the search, as if it did not belong to the box; its faces and edges are strata of the rest.
//!
//! Of the others only the [part](super::interval_newton) is kept that can hold a highest point. What is neither is halved along its longer sides, down to [`DEPTH`]; the cells still open then are *undecided* and reported:
//! where the gradient vanishes on the surface no interval decides.
//!
//! # What is proven
//!
//! If no cell is left undecided, every connected piece of the surface in the box holds a witness; without a witness there is no
//! surface. The box is enlarged by [`MARGIN`] for it, so that a surface that touches its box from inside is inside. At
//! kinks the bounds hold the generalised gradient, for which both arguments are the same. Where f jumps, has a pole or is not
//! defined the surface may end, and nothing is concluded from slopes.

use crate::field::{Enclosure, Field};
use crate::math::Bounds;
use crate::sampler::discovery::interval_newton::narrowed;
use crate::sampler::discovery::singular::{Singular, isolating_box, singular_point};
use glam::DVec3;

/// Halvings after which a cell is left undecided: 2⁻¹⁶ of the box, a sixth of the smallest particle allowed.
const DEPTH: u8 = 16;
/// Halvings after which a cell is left undecided where f jumps or is not defined: such cells line up along curves and faces.
const IRREGULAR_DEPTH: u8 = 6;
/// Most cells looked at, and how many more for every particle that the run will have: a cell takes about as long as a third of a
/// particle. Smooth surfaces of the gallery take a hundred to eight thousand, but for two that take sixty and seventy thousand,
/// and those with up to sixteen cone points no more; the fifty of Barth's sextic take 36,000.
const MOST_CELLS: usize = 8_192;
const CELLS_PER_PARTICLE: f64 = 0.5;
/// Most cells looked at where each level has hardly more of them than the one before it, so that the end is near.
const MOST_AT_THE_END: usize = 65_536;
const HARDLY_MORE: f64 = 1.3;
/// Halvings before singular points are looked for in a cell, and how many there are between two tries.
const SINGULAR_FROM: u8 = 3;
const SINGULAR_EVERY: u8 = 2;
/// Most cells in which they are looked for, in a part: there are more where they form a curve.
const MOST_TRIED: usize = 512;
/// Singular points nearer to each other than this share of a cell are one.
const SAME: f64 = 1e-6;
/// Cells looked at together; how a budget cuts the work does not change what is found.
const CHUNK: usize = 32;
/// Units of work that a cell is charged for: on long formulas it takes as long as several particles.
const UNITS: u32 = 8;
/// The box is enlarged by this share of its longest side.
const MARGIN: f64 = 1.0 / 65_536.0;
/// A taller cell reaches this much farther than the slopes of the cell itself ask for, and at least by [`LEAST_RISE`] of its
/// height.
const RISE_ROOM: f64 = 2.0;
const LEAST_RISE: f64 = 0.02;
/// A cell is halved rather than made taller than this many times its height, each way.
const MOST_RISE: f64 = 2.0;
/// Halved are the sides longer than this share of the longest.
const LONG: f64 = 0.7;
/// Where they are cut, and where the footprint of a decided cell is probed, not quite in the middle: the highest points of
/// symmetric surfaces, and the places where they cross themselves, lie there.
const CUT: f64 = 0.4709;
/// Most that the surface is above or below a witness, in what it rises over the footprint.
const BESIDE: f64 = 1.0 - CUT;

/// A part of a stratum: sides of length 0 are those that a face or an edge of the box pins.
#[derive(Clone, Copy, Debug)]
struct Cell {
    lo: DVec3,
    hi: DVec3,
    level: u8,
}

impl Cell {
    /// The place at which a decided cell is probed along up.
    fn probe(&self) -> DVec3 {
        self.lo + CUT * (self.hi - self.lo)
    }

    /// The free axes but up, then up.
    fn axes(&self) -> ([Option<usize>; 2], usize) {
        let free = |axis: usize| (self.lo[axis] < self.hi[axis]).then_some(axis);
        match [free(0), free(1), free(2)] {
            [x, y, Some(z)] => ([x, y], z),
            [x, Some(y), None] => ([x, None], y),
            [x, None, None] => ([None, None], x.unwrap_or(0)),
        }
    }
}

/// Bounds of second derivatives that say nothing.
const UNBOUNDED: [[f64; 2]; 6] = [[f64::NEG_INFINITY, f64::INFINITY]; 6];

/// How far a search has come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum State {
    /// The field has no bounds to search by.
    #[default]
    Unavailable,
    /// Nothing has been looked at, nor whether the bounds say anything.
    Ready,
    Running,
    Done,
}

/// A point of the surface, and of which of its parts it is a zero.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Witness {
    pub(crate) position: DVec3,
    pub(crate) part: usize,
}

/// A search for witnesses.
#[derive(Clone, Debug, Default)]
pub(crate) struct Octree {
    state: State,
    margin: f64,
    lo: DVec3,
    hi: DVec3,
    /// The part under way, and how many there are.
    part: usize,
    parts: usize,
    /// Cells of the level under way, and how many have been looked at.
    level: Vec<Cell>,
    next: usize,
    /// Whether the level has hardly more cells than the one before it.
    is_ending: bool,
    /// Cells of the level after it.
    halves: Vec<Cell>,
    /// Cells of the part looked at, and how many it may take.
    cells: usize,
    most: usize,
    boxes: Vec<[DVec3; 2]>,
    known: Vec<Enclosure>,
    second: Vec<[[f64; 2]; 6]>,
    /// Cells whose fate the bounds of the expressions leave open.
    open: Vec<Cell>,
    /// Cells to be made taller, and by how much each way.
    tall: Vec<(Cell, f64)>,
    /// Most that the surface rises over the footprint of each; none where it may not be a graph.
    rises: Vec<Option<f64>>,
    /// Lines that meet the surface: index of the tall cell, lower and upper end, the place under way.
    lines: Vec<(usize, f64, f64, f64)>,
    /// Boxes left out of the search of the part.
    isolated: Vec<[DVec3; 2]>,
    /// Cells in which singular points were looked for.
    tries: usize,
    /// Points around which such a box was looked for.
    tried: Vec<DVec3>,
    /// Points where f and its gradient vanish; of curves of them a selection.
    pub(crate) singular: Vec<Singular>,
    /// At least one on every piece of the surface.
    pub(crate) witnesses: Vec<Witness>,
    /// Smallest and largest corners of the cells left undecided.
    pub(crate) undecided: Vec<[DVec3; 2]>,
}

/// Whether the bounds leave 0 out; and then the least size within them.
fn away_from_zero([lo, hi]: [f64; 2]) -> Option<f64> {
    if lo > 0.0 {
        Some(lo)
    } else if hi < 0.0 {
        Some(-hi)
    } else {
        None
    }
}

fn largest([lo, hi]: [f64; 2]) -> f64 {
    hi.max(-lo)
}

impl Octree {
    /// Starts on a new field.
    pub(crate) fn begin(&mut self, has_bounds: bool, bounds: &Bounds) {
        self.witnesses.clear();
        self.undecided.clear();
        self.singular.clear();
        self.halves.clear();
        self.margin = MARGIN * (bounds.hi() - bounds.lo()).max_element();
        let margin = DVec3::splat(self.margin);
        (self.lo, self.hi) = (bounds.lo() - margin, bounds.hi() + margin);
        self.state = if has_bounds { State::Ready } else { State::Unavailable };
    }

    fn begin_part(&mut self, part: usize) {
        self.part = part;
        (self.next, self.cells, self.is_ending) = (0, 0, false);
        self.level.clear();
        self.isolated.clear();
        self.tried.clear();
        self.tries = 0;
        self.level.push(Cell { lo: self.lo, hi: self.hi, level: 0 });
        push_boundary(&mut self.level, [self.lo, self.hi]);
    }

    /// Smallest and largest corner of what is searched: the box and the margin around it.
    pub(crate) fn searched(&self) -> [DVec3; 2] {
        [self.lo, self.hi]
    }

    /// What the box is enlarged by.
    pub(crate) fn margin(&self) -> f64 {
        self.margin
    }

    /// Says how many particles the run will have, which decides how many cells are looked at.
    pub(crate) fn expect(&mut self, particles: f64) {
        self.most = MOST_CELLS + (CELLS_PER_PARTICLE * particles) as usize;
    }

    /// How many cells of the part may be looked at.
    fn allowed(&self) -> usize {
        let most = if self.is_ending { self.most.max(MOST_AT_THE_END) } else { self.most };
        most / self.parts
    }

    /// Whether the field can be searched by bounds.
    pub(crate) fn is_available(&self) -> bool {
        self.state != State::Unavailable
    }

    /// Whether there is nothing left to do.
    pub(crate) fn is_done(&self) -> bool {
        !matches!(self.state, State::Ready | State::Running)
    }

    /// Does up to `budget` units of work, rounded up to whole chunks of cells, and returns what is left.
    pub(crate) fn step(&mut self, field: &mut dyn Field, mut budget: u32) -> u32 {
        if self.state == State::Ready {
            self.parts = field.parts();
            if bounds_say_something(field, [self.lo, self.hi]) {
                self.state = State::Running;
                self.begin_part(0);
            } else {
                self.state = State::Unavailable;
            }
        }
        while budget > 0 && !self.is_done() {
            let count = CHUNK.min(self.level.len() - self.next);
            self.look_at(field, self.next..self.next + count);
            self.next += count;
            self.cells += count;
            budget = budget.saturating_sub(UNITS * CHUNK as u32);
            if self.next == self.level.len() {
                self.is_ending = (self.halves.len() as f64) < HARDLY_MORE * self.level.len() as f64;
                self.level.clear();
                core::mem::swap(&mut self.level, &mut self.halves);
                self.next = 0;
            }
            if self.level.is_empty() || self.cells >= self.allowed() {
                let open = self.level[self.next..].iter().chain(&self.halves);
                let open = open.filter(|cell| !is_left_out(cell, &self.isolated));
                self.undecided.extend(open.map(|cell| [cell.lo, cell.hi]));
                self.halves.clear();
                if self.part + 1 < self.parts {
                    self.begin_part(self.part + 1);
                } else {
                    self.state = State::Done;
                }
            }
        }
        budget
    }

    fn look_at(&mut self, field: &mut dyn Field, range: core::ops::Range<usize>) {
        self.open.clear();
        let searched = self.level[range].iter().filter(|cell| !is_left_out(cell, &self.isolated));
        self.open.extend(searched);
        self.boxes.clear();
        self.boxes.extend(self.open.iter().map(|cell| [cell.lo, cell.hi]));
        self.enclose(field);
        let mut kept = 0;
        for k in 0..self.open.len() {
            let (cell, known) = (self.open[k], self.known[k]);
            if !known.may_vanish {
                continue;
            }
            if !(known.defined && known.continuous) {
                self.halve(cell, IRREGULAR_DEPTH);
            } else if !is_discarded(&cell, &known) {
                self.open[kept] = cell;
                kept += 1;
            }
        }
        self.open.truncate(kept);
        self.boxes.clear();
        self.boxes.extend(self.open.iter().map(|cell| [cell.lo, cell.hi]));
        self.refine(field);
        self.tall.clear();
        for k in 0..self.open.len() {
            let (mut cell, known, middle) = (self.open[k], self.known[k], self.known[self.open.len() + k]);
            if is_discarded(&cell, &known) {
                continue;
            }
            let corners = [cell.lo, cell.hi];
            let left = narrowed(corners, cell.axes(), &known, &middle, &self.second[k]);
            let Some([lo, hi]) = left else { continue };
            let (_, up) = cell.axes();
            // That of the whole cell: the part may be flat.
            let height = cell.hi[up] - cell.lo[up];
            (cell.lo, cell.hi) = (lo, hi);
            match rise(&cell, &known) {
                Some(t) if t <= MOST_RISE * height => {
                    self.tall.push((cell, RISE_ROOM * t + LEAST_RISE * height));
                }
                _ if self.is_isolated(field, &cell, &known) => {}
                _ => self.halve(cell, DEPTH),
            }
        }
        if !self.tall.is_empty() {
            self.decide(field);
        }
    }

    /// Whether the cell lies in a box that is left out of the search: one there is already, or a new one around a singular
    /// point in or near the cell.
    fn is_isolated(&mut self, field: &mut dyn Field, cell: &Cell, known: &Enclosure) -> bool {
        if is_left_out(cell, &self.isolated) {
            return true;
        }
        let (sides, _) = cell.axes();
        let is_tried = cell.level >= SINGULAR_FROM
            && (cell.level - SINGULAR_FROM).is_multiple_of(SINGULAR_EVERY)
            && self.tries < MOST_TRIED
            && sides.iter().all(Option::is_some)
            && known.gradient.iter().all(|&bounds| away_from_zero(bounds).is_none());
        if !is_tried {
            return false;
        }
        self.tries += 1;
        let reach = (cell.hi - cell.lo).length();
        let Some(point) = singular_point(field, cell.probe(), reach) else { return false };
        let at = point.position;
        let is_known = |p: &DVec3| (*p - at).length_squared() <= SAME * SAME * reach * reach;
        if self.tried.iter().any(is_known) {
            return false;
        }
        self.tried.push(at);
        if point.is_zero && at.cmpge(self.lo).all() && at.cmple(self.hi).all() {
            self.singular.push(point);
        }
        // Through the faces of a box on a curve of such points the curve goes on.
        if !point.is_alone {
            return false;
        }
        let within = [self.lo, self.hi];
        let Some(around) = isolating_box(field, self.part, at, within, &self.isolated) else { return false };
        self.isolated.push(around);
        push_boundary(&mut self.halves, around);
        is_inside(cell, &around)
    }

    /// Decides the cells in `tall`, or halves them.
    fn decide(&mut self, field: &mut dyn Field) {
        let taller = |&(cell, room): &(Cell, f64)| {
            let (_, up) = cell.axes();
            let (mut lo, mut hi) = (cell.lo, cell.hi);
            (lo[up], hi[up]) = (lo[up] - room, hi[up] + room);
            [lo, hi]
        };
        self.boxes.clear();
        self.boxes.extend(self.tall.iter().map(taller));
        self.refine(field);
        // The most that the surface rises, where it is a graph over the whole footprint.
        self.rises.clear();
        self.rises.extend(self.tall.iter().zip(&self.known).map(|((cell, room), known)| {
            let regular = known.defined && known.continuous;
            if regular { rise(cell, known).filter(|t| t <= room) } else { None }
        }));
        // Both ends of a line through each.
        self.boxes.clear();
        for tall in &self.tall {
            let (cell, _) = tall;
            let (_, up) = cell.axes();
            self.boxes.extend(taller(tall).map(|end| {
                let mut p = cell.probe();
                p[up] = end[up];
                [p, p]
            }));
        }
        self.enclose(field);
        self.lines.clear();
        for k in 0..self.tall.len() {
            let (cell, _) = self.tall[k];
            let [bottom, top] = [2 * k, 2 * k + 1].map(|end| self.known[end].value);
            let known = away_from_zero(bottom).and(away_from_zero(top)).is_some();
            if self.rises[k].is_none() || !known {
                self.halve(cell, DEPTH);
            } else if (bottom[0] > 0.0) != (top[0] > 0.0) {
                let (_, up) = cell.axes();
                let (lo, hi) = (self.boxes[2 * k][0][up], self.boxes[2 * k + 1][0][up]);
                self.lines.push((k, lo, hi, 0.5 * (lo + hi)));
            }
        }
        self.find_roots(field);
        for line in 0..self.lines.len() {
            let (k, _, _, height) = self.lines[line];
            let (cell, _) = self.tall[k];
            let (sides, up) = cell.axes();
            let beside = BESIDE * self.rises[k].unwrap_or(0.0);
            if height + beside < self.lo[up] || height > self.hi[up] && height - beside >= self.lo[up] {
                continue;
            }
            // Over a single point there is nothing to leave by.
            if height - beside >= self.lo[up] || sides == [None; 2] {
                let mut position = cell.probe();
                position[up] = height;
                self.witnesses.push(Witness { position, part: self.part });
            } else {
                self.halve(cell, DEPTH);
            }
        }
    }

    /// The zero of f on each of the `lines`, at whose ends it has different signs: Newton's method, kept between the ends by
    /// bisection.
    fn find_roots(&mut self, field: &mut dyn Field) {
        /// Bisection alone would exhaust the digits of a number.
        const MOST_STEPS: u32 = 60;
        let mut settled = self.lines.is_empty();
        for _ in 0..MOST_STEPS {
            if settled {
                break;
            }
            self.boxes.clear();
            for &(k, _, _, height) in &self.lines {
                let (cell, _) = self.tall[k];
                let mut p = cell.probe();
                p[cell.axes().1] = height;
                self.boxes.push([p, p]);
            }
            self.enclose(field);
            settled = true;
            for (line, known) in self.lines.iter_mut().zip(&self.known) {
                let (k, lo, hi, height) = *line;
                let [least, most] = known.value;
                if away_from_zero(known.value).is_none() {
                    continue;
                }
                let slope = known.gradient[self.tall[k].0.axes().1];
                let rising = slope[0] > 0.0;
                let (lo, hi) = if (least > 0.0) == rising { (lo, height) } else { (height, hi) };
                let newton = height - (least + most) / (slope[0] + slope[1]);
                let next = if newton > lo && newton < hi { newton } else { 0.5 * (lo + hi) };
                settled &= (next - height).abs() <= f64::EPSILON * (lo.abs() + hi.abs());
                *line = (k, lo, hi, next);
            }
        }
    }

    fn enclose(&mut self, field: &mut dyn Field) {
        let n = self.boxes.len();
        self.known.resize(n.max(self.known.len()), Enclosure::UNKNOWN);
        field.enclose(self.part, &self.boxes, &mut self.known[..n]);
    }

    /// Bounds over the boxes, the mean value forms included.
    fn refine(&mut self, field: &mut dyn Field) {
        let n = self.boxes.len();
        if n == 0 {
            return;
        }
        for k in 0..n {
            let [lo, hi] = self.boxes[k];
            let middle = 0.5 * (lo + hi);
            self.boxes.push([middle, middle]);
        }
        self.enclose(field);
        self.boxes.truncate(n);
        self.second.resize(n.max(self.second.len()), UNBOUNDED);
        field.enclose_second(self.part, &self.boxes, &mut self.second[..n]);
        for k in 0..n {
            let [lo, hi] = self.boxes[k];
            let middle = self.known[n + k];
            if self.known[k].defined && self.known[k].continuous {
                tighten(&mut self.known[k], &middle, &self.second[k], 0.5 * (hi - lo));
            }
        }
    }

    /// Halves a cell along its longer sides, unless it has been halved `depth` times.
    fn halve(&mut self, cell: Cell, depth: u8) {
        if cell.level >= depth {
            self.undecided.push([cell.lo, cell.hi]);
            return;
        }
        let size = cell.hi - cell.lo;
        let middle = cell.lo + CUT * size;
        let long = LONG * size.max_element();
        let parts = |axis: usize| if size[axis] > long { 2 } else { 1 };
        for z in 0..parts(2) {
            for y in 0..parts(1) {
                for x in 0..parts(0) {
                    let mut half = Cell { level: cell.level + 1, ..cell };
                    for (axis, part) in [x, y, z].into_iter().enumerate() {
                        if parts(axis) == 2 {
                            let end = if part == 0 { &mut half.hi } else { &mut half.lo };
                            end[axis] = middle[axis];
                        }
                    }
                    self.halves.push(half);
                }
            }
        }
    }
}

/// Adds the faces and edges of a box to the cells of a level.
fn push_boundary(level: &mut Vec<Cell>, [bottom, top]: [DVec3; 2]) {
    // Each axis free, or pinned to either end.
    for stratum in 1..27 {
        let (mut lo, mut hi) = (bottom, top);
        let mut rest = stratum;
        for axis in 0..3 {
            match rest % 3 {
                1 => hi[axis] = lo[axis],
                2 => lo[axis] = hi[axis],
                _ => {}
            }
            rest /= 3;
        }
        // A corner belongs to three edges.
        if lo != hi {
            level.push(Cell { lo, hi, level: 0 });
        }
    }
}

/// Whether a cell lies in the interior of a box.
fn is_inside(cell: &Cell, [lo, hi]: &[DVec3; 2]) -> bool {
    cell.lo.cmpgt(*lo).all() && cell.hi.cmplt(*hi).all()
}

/// Whether a cell lies in a box that is left out of the search.
fn is_left_out(cell: &Cell, isolated: &[[DVec3; 2]]) -> bool {
    isolated.iter().any(|around| is_inside(cell, around))
}

/// Whether no highest point lies in a cell on which f is defined and continuous.
fn is_discarded(cell: &Cell, known: &Enclosure) -> bool {
    let (sides, _) = cell.axes();
    !known.may_vanish
        || away_from_zero(known.value).is_some()
        || sides.into_iter().flatten().any(|side| away_from_zero(known.gradient[side]).is_some())
}

/// Most that the surface rises or falls over the footprint of the cell, by the bounds of the gradient; none where f is
/// not monotone along up.
fn rise(cell: &Cell, known: &Enclosure) -> Option<f64> {
    let (sides, up) = cell.axes();
    let least = away_from_zero(known.gradient[up])?;
    let t: f64 = sides
        .into_iter()
        .flatten()
        .map(|side| largest(known.gradient[side]) / least * (cell.hi[side] - cell.lo[side]))
        .sum();
    t.is_finite().then_some(t)
}

/// Intersects bounds over a box with the mean value forms around its middle; `half` is half its size.
fn tighten(known: &mut Enclosure, middle: &Enclosure, second: &[[f64; 2]; 6], half: DVec3) {
    /// Entries of a row of second derivatives.
    const ROWS: [[usize; 3]; 3] = [[0, 1, 2], [1, 3, 4], [2, 4, 5]];
    for (axis, row) in ROWS.into_iter().enumerate().filter(|_| known.smooth) {
        let swing: f64 = (0..3).filter(|&k| half[k] > 0.0).map(|k| largest(second[row[k]]) * half[k]).sum();
        narrow(&mut known.gradient[axis], middle.gradient[axis], swing);
    }
    let swing: f64 = (0..3).filter(|&k| half[k] > 0.0).map(|k| largest(known.gradient[k]) * half[k]).sum();
    narrow(&mut known.value, middle.value, swing);
}

/// Intersects bounds with those around a middle.
fn narrow(bounds: &mut [f64; 2], middle: [f64; 2], swing: f64) {
    /// What the few operations that lead here may have been rounded by.
    const ROUNDING: f64 = 16.0 * f64::EPSILON;
    let slack = ROUNDING * (swing + middle[0].abs() + middle[1].abs());
    let (lo, hi) = (middle[0] - swing - slack, middle[1] + swing + slack);
    // False for NaN, where nothing is known.
    if lo > bounds[0] {
        bounds[0] = lo;
    }
    if hi < bounds[1] {
        bounds[1] = hi;
    }
}

/// Whether the field bounds its values at all: asked of small boxes here and there.
fn bounds_say_something(field: &mut dyn Field, [lo, hi]: [DVec3; 2]) -> bool {
    const SIDE: usize = 3;
    let size = hi - lo;
    let boxes: [[DVec3; 2]; SIDE * SIDE * SIDE] = core::array::from_fn(|i| {
        let node = DVec3::new((i % SIDE) as f64, (i / SIDE % SIDE) as f64, (i / SIDE / SIDE) as f64);
        let corner = lo + size * (node + DVec3::new(0.41, 0.37, 0.43)) / SIDE as f64;
        [corner, corner + MARGIN * size]
    });
    let mut known = [Enclosure::UNKNOWN; SIDE * SIDE * SIDE];
    field.enclose(0, &boxes, &mut known);
    known.iter().any(|known| known.value != Enclosure::UNKNOWN.value)
}
