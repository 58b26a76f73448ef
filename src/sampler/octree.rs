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
//! footprint, connected, and meets the line through its middle in one point, the *witness*; or C holds no point of it. (Snyder,
//! "Interval analysis for computer graphics", SIGGRAPH 1992, calls this global parametrisability; Plantinga & Vegter, "Isotopic
//! approximation of implicit curves and surfaces", SGP 2004, ask for a small variation of the normal instead, of every cell that
//! meets the surface, and obtain its topology; one point on each piece is cheaper.) If the highest point of a piece lies in C, the
//! witness lies on that piece: along the graph it never leaves through the top of the box, because nothing of the piece is
//! higher, and a graph that might leave through the bottom is not accepted.
//!
//! What is neither is halved along its longer sides, down to [`DEPTH`]; the cells still open then are *undecided* and reported:
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
use glam::DVec3;

/// Halvings after which a cell is left undecided: 2⁻¹⁶ of the box, a sixth of the smallest particle allowed.
const DEPTH: u8 = 16;
/// Halvings after which a cell is left undecided where f jumps or is not defined: such cells line up along curves and faces.
const IRREGULAR_DEPTH: u8 = 6;
/// Most cells looked at. Surfaces without singular curves take a few hundred to ten thousand.
const MOST_CELLS: usize = 40_000;
/// Cells looked at together; how a budget cuts the work does not change what is found.
const CHUNK: usize = 32;
/// The box is enlarged by this share of its longest side.
const MARGIN: f64 = 1.0 / 65_536.0;
/// A taller cell reaches this much farther than the slopes of the cell itself ask for, and at least by [`LEAST_RISE`] of its
/// height.
const RISE_ROOM: f64 = 1.25;
const LEAST_RISE: f64 = 0.02;
/// A cell is halved rather than made taller than this many times its height, each way.
const MOST_RISE: f64 = 2.0;
/// Halved are the sides longer than this share of the longest.
const LONG: f64 = 0.7;

/// A part of a stratum: sides of length 0 are those that a face or an edge of the box pins.
#[derive(Clone, Copy, Debug)]
struct Cell {
    lo: DVec3,
    hi: DVec3,
    level: u8,
}

impl Cell {
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

/// How far a search has come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum State {
    /// The field has no bounds to search by.
    #[default]
    Unavailable,
    Running,
    Done,
}

/// A search for witnesses.
#[derive(Clone, Debug, Default)]
pub(super) struct Octree {
    state: State,
    margin: f64,
    lo: DVec3,
    hi: DVec3,
    /// Cells of the level under way, and how many have been looked at.
    level: Vec<Cell>,
    next: usize,
    /// Cells of the level after it.
    halves: Vec<Cell>,
    cells: usize,
    boxes: Vec<[DVec3; 2]>,
    known: Vec<Enclosure>,
    tall: Vec<(Cell, f64)>,
    /// Points of the surface, at least one on every piece.
    pub(super) witnesses: Vec<DVec3>,
    /// Smallest and largest corners of the cells left undecided.
    pub(super) undecided: Vec<[DVec3; 2]>,
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
    pub(super) fn begin(&mut self, field: &mut dyn Field, bounds: &Bounds) {
        self.witnesses.clear();
        self.undecided.clear();
        self.level.clear();
        self.halves.clear();
        (self.next, self.cells) = (0, 0);
        self.margin = MARGIN * (bounds.hi() - bounds.lo()).max_element();
        let margin = DVec3::splat(self.margin);
        (self.lo, self.hi) = (bounds.lo() - margin, bounds.hi() + margin);
        if !has_bounds(field, bounds) {
            self.state = State::Unavailable;
            return;
        }
        self.state = State::Running;
        // Each axis free, or pinned to either end.
        for stratum in 0..27 {
            let (mut lo, mut hi) = (self.lo, self.hi);
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
                self.level.push(Cell { lo, hi, level: 0 });
            }
        }
    }

    /// What the box is enlarged by.
    pub(super) fn margin(&self) -> f64 {
        self.margin
    }

    /// Whether the field can be searched by bounds.
    pub(super) fn is_available(&self) -> bool {
        self.state != State::Unavailable
    }

    /// Whether there is nothing left to do.
    pub(super) fn is_done(&self) -> bool {
        self.state != State::Running
    }

    /// Looks at up to `budget` cells, rounded up to whole chunks, and returns what is left.
    pub(super) fn step(&mut self, field: &mut dyn Field, mut budget: u32) -> u32 {
        while budget > 0 && !self.is_done() {
            let count = CHUNK.min(self.level.len() - self.next);
            self.look_at(field, self.next..self.next + count);
            self.next += count;
            self.cells += count;
            budget = budget.saturating_sub(CHUNK as u32);
            if self.next == self.level.len() {
                self.level.clear();
                core::mem::swap(&mut self.level, &mut self.halves);
                self.next = 0;
            }
            if self.level.is_empty() || self.cells >= MOST_CELLS {
                let open = self.level[self.next..].iter().chain(&self.halves);
                self.undecided.extend(open.map(|cell| [cell.lo, cell.hi]));
                self.level.clear();
                self.halves.clear();
                self.state = State::Done;
            }
        }
        budget
    }

    fn look_at(&mut self, field: &mut dyn Field, range: core::ops::Range<usize>) {
        self.boxes.clear();
        self.boxes.extend(self.level[range.clone()].iter().map(|cell| [cell.lo, cell.hi]));
        self.enclose(field);
        self.tall.clear();
        for (k, at) in range.enumerate() {
            let (cell, known) = (self.level[at], self.known[k]);
            let (sides, up) = cell.axes();
            if !known.may_vanish {
                continue;
            }
            if !(known.defined && known.continuous) {
                self.halve(cell, IRREGULAR_DEPTH);
                continue;
            }
            if sides.into_iter().flatten().any(|side| away_from_zero(known.gradient[side]).is_some()) {
                continue;
            }
            let height = cell.hi[up] - cell.lo[up];
            match rise(&cell, &known) {
                Some(t) if t <= MOST_RISE * height => {
                    self.tall.push((cell, RISE_ROOM * t + LEAST_RISE * height));
                }
                _ => self.halve(cell, DEPTH),
            }
        }
        self.decide(field);
    }

    /// Decides the cells in `tall`, or halves them.
    fn decide(&mut self, field: &mut dyn Field) {
        // For each the taller cell, and the lower and upper end of the line through its middle.
        self.boxes.clear();
        for &(cell, room) in &self.tall {
            let (_, up) = cell.axes();
            let (mut lo, mut hi) = (cell.lo, cell.hi);
            (lo[up], hi[up]) = (lo[up] - room, hi[up] + room);
            let (mut bottom, mut top) = (0.5 * (lo + hi), 0.5 * (lo + hi));
            (bottom[up], top[up]) = (lo[up], hi[up]);
            self.boxes.extend([[lo, hi], [bottom, bottom], [top, top]]);
        }
        self.enclose(field);
        for k in 0..self.tall.len() {
            let (cell, room) = self.tall[k];
            let [known, bottom, top] = [0, 1, 2].map(|part| self.known[3 * k + part]);
            let t = if known.defined && known.continuous { rise(&cell, &known) } else { None };
            let graph = t.filter(|&t| t <= room);
            let ends = away_from_zero(bottom.value).and(away_from_zero(top.value));
            let (Some(t), Some(_)) = (graph, ends) else {
                self.halve(cell, DEPTH);
                continue;
            };
            if (bottom.value[0] > 0.0) == (top.value[0] > 0.0) {
                continue;
            }
            let (_, up) = cell.axes();
            let witness = root(field, up, self.boxes[3 * k + 1][0], self.boxes[3 * k + 2][0]);
            let height = witness[up];
            if height + 0.5 * t < self.lo[up] || height > self.hi[up] && height - 0.5 * t >= self.lo[up] {
                continue;
            }
            if height - 0.5 * t >= self.lo[up] || pinned_below(&cell, up, self.lo[up], t) {
                self.witnesses.push(witness);
            } else {
                self.halve(cell, DEPTH);
            }
        }
    }

    fn enclose(&mut self, field: &mut dyn Field) {
        self.known.resize(self.boxes.len().max(self.known.len()), Enclosure::UNKNOWN);
        field.enclose(&self.boxes, &mut self.known[..self.boxes.len()]);
    }

    /// Halves a cell along its longer sides, unless it has been halved `depth` times.
    fn halve(&mut self, cell: Cell, depth: u8) {
        if cell.level >= depth {
            self.undecided.push([cell.lo, cell.hi]);
            return;
        }
        let size = cell.hi - cell.lo;
        let middle = 0.5 * (cell.lo + cell.hi);
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

/// A single point on an edge of the box, which has no footprint to leave.
fn pinned_below(cell: &Cell, up: usize, lowest: f64, t: f64) -> bool {
    t == 0.0 && cell.lo[up] == lowest
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

/// Whether the field bounds its values at all: asked of small boxes here and there.
fn has_bounds(field: &mut dyn Field, bounds: &Bounds) -> bool {
    const SIDE: usize = 3;
    let (lo, size) = (bounds.lo(), bounds.hi() - bounds.lo());
    let boxes: [[DVec3; 2]; SIDE * SIDE * SIDE] = core::array::from_fn(|i| {
        let node = DVec3::new((i % SIDE) as f64, (i / SIDE % SIDE) as f64, (i / SIDE / SIDE) as f64);
        let corner = lo + size * (node + DVec3::new(0.41, 0.37, 0.43)) / SIDE as f64;
        [corner, corner + MARGIN * size]
    });
    let mut known = [Enclosure::UNKNOWN; SIDE * SIDE * SIDE];
    field.enclose(&boxes, &mut known);
    known.iter().any(|known| known.value != Enclosure::UNKNOWN.value)
}

/// The zero of f on the line along `up` between two points where it has different signs: Newton's method, kept between
/// the ends by bisection.
fn root(field: &mut dyn Field, up: usize, bottom: DVec3, top: DVec3) -> DVec3 {
    /// Bisection alone would exhaust the digits of a number.
    const MOST_STEPS: u32 = 60;
    let (mut a, mut b) = (bottom[up], top[up]);
    let below = field.jet(bottom).value > 0.0;
    let settled = 1e-14 * (a.abs() + b.abs());
    let mut p = bottom;
    p[up] = 0.5 * (a + b);
    for _ in 0..MOST_STEPS {
        let jet = field.jet(p);
        if (jet.value > 0.0) == below {
            a = p[up];
        } else {
            b = p[up];
        }
        let newton = p[up] - jet.value / jet.gradient[up];
        let next = if newton > a && newton < b { newton } else { 0.5 * (a + b) };
        let moved = (next - p[up]).abs();
        p[up] = next;
        if moved <= settled || jet.value == 0.0 {
            break;
        }
    }
    p
}
