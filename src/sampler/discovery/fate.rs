//! A [`Judge`] decides for each cell of the [octree](super::octree) whether it is discarded, halved
//! or replaced by a witness. It evaluates bounds of f and its derivatives over the cell; the module
//! of the octree explains why they suffice.

use crate::field::{Bounded, Enclosure};
use crate::math::{Bounds, Interval, Sym3};
use crate::sampler::discovery::cell::{Axes, CUT, Cell, is_discarded, rise};
use crate::sampler::discovery::interval_newton::narrowed;
use glam::DVec3;

/// A taller cell reaches this many times as far as the slopes of the cell itself require. A choice.
const RISE_ROOM: f64 = 2.0;
/// A taller cell reaches at least this share of its height, because it may be flat.
const LEAST_RISE: f64 = 0.02;
/// Largest height difference between a witness and the surface, as a share of the rise over the
/// footprint: the longer part of a side.
const BESIDE: f64 = 1.0 - CUT;

/// What happens next to a cell that is not discarded.
#[derive(Clone, Copy, Debug)]
pub(super) enum Fate {
    /// It is halved, or its part that can hold a highest point is.
    Halved(Cell),
    /// It is halved: f jumps in it or is undefined.
    Irregular(Cell),
    /// f may not be monotone along up in it, as next to a singular point.
    Doubtful(Cell, Enclosure),
    /// It is decided, and this is its witness.
    Decided(DVec3),
}

/// Decides the fates of cells, a batch at a time; it reuses its memory.
#[derive(Clone, Debug, Default)]
pub(super) struct Judge {
    bounds: BoxBounds,
    /// Cells that the bounds of the expressions do not decide.
    open: Vec<Cell>,
    tall: Vec<Tall>,
    lines: Vec<Line>,
    fates: Vec<Fate>,
}

/// A cell that is made taller.
#[derive(Clone, Copy, Debug)]
struct Tall {
    cell: Cell,
    /// Length added to the cell at each end.
    room: f64,
    /// Largest rise of the surface over the footprint; none if the surface may not be a graph.
    rise: Option<f64>,
}

impl Tall {
    /// The taller cell.
    fn bounds(&self) -> Bounds {
        let up = self.cell.axes().up;
        let Bounds { mut min, mut max } = self.cell.bounds;
        (min[up], max[up]) = (min[up] - self.room, max[up] + self.room);
        Bounds { min, max }
    }
}

/// A line through a tall cell that meets the surface.
#[derive(Clone, Copy, Debug)]
struct Line {
    /// Index of the cell.
    tall: usize,
    /// Lower and upper end of the line.
    lo: f64,
    hi: f64,
    /// Present estimate of the point at which the line meets the surface.
    root: f64,
}

/// Boxes and the bounds of the field over them.
#[derive(Clone, Debug, Default)]
struct BoxBounds {
    boxes: Vec<Bounds>,
    known: Vec<Enclosure>,
    second: Vec<Sym3<Interval>>,
}

impl BoxBounds {
    /// Bounds f and its gradient over the boxes.
    fn enclose(&mut self, field: &mut dyn Bounded, factor: usize) {
        let n = self.boxes.len();
        self.known.resize(n.max(self.known.len()), Enclosure::UNKNOWN);
        field.enclose(factor, &self.boxes, &mut self.known[..n]);
    }

    /// Bounds f and its gradient over the boxes, including the mean value forms. The bounds in the
    /// middles of the boxes are appended.
    fn refine(&mut self, field: &mut dyn Bounded, factor: usize) {
        let n = self.boxes.len();
        if n == 0 {
            return;
        }
        for k in 0..n {
            self.boxes.push(Bounds::point(self.boxes[k].middle()));
        }
        self.enclose(field, factor);
        self.boxes.truncate(n);
        self.second.resize(n.max(self.second.len()), Sym3::splat(Interval::EVERYTHING));
        field.enclose_second(factor, &self.boxes, &mut self.second[..n]);
        for k in 0..n {
            let middle = self.known[n + k];
            self.known[k].tighten(&middle, &self.second[k], 0.5 * self.boxes[k].size());
        }
    }
}

impl Judge {
    /// The fates of the cells of a batch in the search of a factor in a region, without those that
    /// are discarded. A fate does not depend on the other cells.
    pub(super) fn fates(
        &mut self,
        field: &mut dyn Bounded,
        factor: usize,
        region: &Bounds,
        cells: &[Cell],
    ) -> Vec<Fate> {
        self.bounds.boxes.clear();
        self.bounds.boxes.extend(cells.iter().map(|cell| cell.bounds));
        self.bounds.enclose(field, factor);
        self.open.clear();
        for (&cell, known) in cells.iter().zip(&self.bounds.known) {
            if !known.may_vanish {
                continue;
            }
            if !(known.defined && known.continuous) {
                self.fates.push(Fate::Irregular(cell));
            } else if !is_discarded(&cell, known) {
                self.open.push(cell);
            }
        }
        self.bounds.boxes.clear();
        self.bounds.boxes.extend(self.open.iter().map(|cell| cell.bounds));
        self.bounds.refine(field, factor);
        self.tall.clear();
        for (k, &open) in self.open.iter().enumerate() {
            let mut cell = open;
            let (known, middle) = (self.bounds.known[k], self.bounds.known[self.open.len() + k]);
            if is_discarded(&cell, &known) {
                continue;
            }
            let left = narrowed(&cell, &known, &middle, &self.bounds.second[k]);
            let Some(left) = left else { continue };
            let up = cell.axes().up;
            // The height is that of the whole cell, because the narrowed one may be flat.
            let height = cell.bounds.max[up] - cell.bounds.min[up];
            cell.bounds = left;
            match rise(&cell.bounds, up, &known) {
                Some(t) => {
                    let room = RISE_ROOM * t + LEAST_RISE * height;
                    self.tall.push(Tall { cell, room, rise: None });
                }
                None => self.fates.push(Fate::Doubtful(cell, known)),
            }
        }
        if !self.tall.is_empty() {
            self.decide(field, factor, region);
        }
        core::mem::take(&mut self.fates)
    }

    /// Decides the cells that are to be made taller, or marks them for halving.
    fn decide(&mut self, field: &mut dyn Bounded, factor: usize, region: &Bounds) {
        self.bounds.boxes.clear();
        self.bounds.boxes.extend(self.tall.iter().map(Tall::bounds));
        self.bounds.refine(field, factor);
        for (tall, known) in self.tall.iter_mut().zip(&self.bounds.known) {
            tall.rise = rise(&tall.cell.bounds, tall.cell.axes().up, known).filter(|t| *t <= tall.room);
        }
        // Both ends of a line through each.
        self.bounds.boxes.clear();
        for tall in &self.tall {
            let up = tall.cell.axes().up;
            let Bounds { min, max } = tall.bounds();
            self.bounds.boxes.extend([min, max].map(|end| {
                let mut p = tall.cell.probe();
                p[up] = end[up];
                Bounds::point(p)
            }));
        }
        self.bounds.enclose(field, factor);
        self.lines.clear();
        for k in 0..self.tall.len() {
            let Tall { cell, rise, .. } = self.tall[k];
            let [bottom, top] = [2 * k, 2 * k + 1].map(|end| self.bounds.known[end].value);
            if rise.is_none() || !bottom.excludes_zero() || !top.excludes_zero() {
                self.fates.push(Fate::Halved(cell));
            } else if (bottom.lo > 0.0) != (top.lo > 0.0) {
                let up = cell.axes().up;
                let [lo, hi] = [2 * k, 2 * k + 1].map(|end| self.bounds.boxes[end].min[up]);
                self.lines.push(Line { tall: k, lo, hi, root: 0.5 * (lo + hi) });
            }
        }
        self.find_roots(field, factor);
        for line in 0..self.lines.len() {
            let Line { tall, root: height, .. } = self.lines[line];
            let Tall { cell, rise, .. } = self.tall[tall];
            let Axes { sides, up } = cell.axes();
            let beside = BESIDE * rise.unwrap_or(0.0);
            let [bottom, top] = [region.min[up], region.max[up]];
            if height + beside < bottom || height > top && height - beside >= bottom {
                continue;
            }
            // Over a footprint of one point the graph cannot leave the box.
            if height - beside >= bottom || sides == [None; 2] {
                let mut position = cell.probe();
                position[up] = height;
                self.fates.push(Fate::Decided(position));
            } else {
                self.fates.push(Fate::Halved(cell));
            }
        }
    }

    /// Finds the zero of f on each of the lines, at whose ends f has different signs, by Newton's
    /// method safeguarded by bisection.
    fn find_roots(&mut self, field: &mut dyn Bounded, factor: usize) {
        let mut settled = self.lines.is_empty();
        // As many steps as a number has digits: bisection alone gains one in each.
        for _ in 0..f64::MANTISSA_DIGITS {
            if settled {
                break;
            }
            self.bounds.boxes.clear();
            for &Line { tall, root, .. } in &self.lines {
                let cell = self.tall[tall].cell;
                let mut p = cell.probe();
                p[cell.axes().up] = root;
                self.bounds.boxes.push(Bounds::point(p));
            }
            self.bounds.enclose(field, factor);
            settled = true;
            for (line, known) in self.lines.iter_mut().zip(&self.bounds.known) {
                let Line { tall, lo, hi, root } = *line;
                if !known.value.excludes_zero() {
                    continue;
                }
                let slope = known.gradient[self.tall[tall].cell.axes().up];
                let rising = slope.lo > 0.0;
                let (lo, hi) = if (known.value.lo > 0.0) == rising { (lo, root) } else { (root, hi) };
                let newton = root - (known.value.lo + known.value.hi) / (slope.lo + slope.hi);
                let next = if newton > lo && newton < hi { newton } else { 0.5 * (lo + hi) };
                settled &= (next - root).abs() <= f64::EPSILON * (lo.abs() + hi.abs());
                *line = Line { tall, lo, hi, root: next };
            }
        }
    }
}
