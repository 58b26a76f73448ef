//! The scan of a cube, which is divided into eighths repeatedly; cells without surface are dropped.
//!
//! A point at which a component reaches farthest along an axis, inside the cube, has no slope along
//! the other two: else the surface would continue. So, besides the cells at the faces of the cube,
//! only those are kept whose bounds allow that for some axis: for a sphere a few around its six
//! poles. Bounds of the value are those of the expression and of the mean value form, as in the
//! search for components.
//!
//! Bounds are wide if a cell is large compared with the distances over which f bends: over a cell
//! on both sides of x = 0 those of x³(x − 2) reach far below the least value, and hundreds of cells
//! far from the surface are kept. A thorough scan looks [into](look_into) each such cell before it
//! keeps it: the cell is halved along the axis that widens its bounds most, and again, as long as
//! few parts are left. It is made if a plain scan decides nothing, or leaves a box at one of whose
//! sides no part of the surface is [seen](is_loose).

use crate::field::{Bounded, Enclosure};
use crate::math::{Bounds, key_of, sort_by_key};
use crate::slices::{HEAVY, pause};
use glam::DVec3;

/// The cubes are not centred on the origin, where many surfaces have planes of symmetry that would
/// run along the faces of cells.
const OFF_CENTRE: DVec3 = DVec3::new(0.013, 0.007, 0.019);
/// Factor by which the cube is enlarged, so that it reaches its half-width on every side although
/// its centre is shifted: 1 plus the largest component of [`OFF_CENTRE`], rounded up.
const LARGER: f64 = 1.02;
/// The extremes are found to this share of the longest side of their box: a third of the room
/// around it.
const FINE: f64 = 1.0 / 64.0;
/// This share is enough if no cells are left to visit. With [`FINE`] instead some boxes would be
/// larger.
const COARSE: f64 = 1.0 / 16.0;
/// Number of halvings after which the surface in the cells at the faces, a 128th of the cube wide,
/// counts as passing through them: a test holds a scan to a fiftieth of its half-width.
const FACE_LEVEL: u32 = 7;
/// Largest number of halvings, for an isolated point: places are counted in 32 bits.
const DEPTH: u32 = 30;
/// Number of cells of a level that is large while some lie at the faces: their eighths are a third
/// of the cells that a scan may visit.
const MANY_AT_FACES: usize = 1_500;
/// If a level of this depth, which has 512 cells, drops less than a tenth of them, the bounds say
/// nothing. Without this rule surfaces of short periods would take many more cells.
const IDLE_LEVEL: u32 = 3;
const IDLE_SHARE: f64 = 0.9;
/// Largest number of parts of a cell that are examined at a time: two for each of the eight parts
/// that meet at a point, where the bounds are widest. A cell that the surface passes has more.
const MOST_PARTS: usize = 16;
/// Largest number of halvings of a cell for that: ten along each axis, which turn a cell that is a
/// 128th of the largest cube into one of 0.15.
const HALVINGS: u32 = 30;
/// Share of a box at each of its sides in which a cell with the surface is searched for. A box
/// without one is too large.
const OUTER: f64 = 0.25;
/// Cells that are examined for that at each side, the outermost first.
const MOST_OUTER: usize = 64;
/// If a box around the bends shrinks below this share of itself when the cells are halved, its size
/// came from the cells, not from the bends.
const STEADY: f64 = 0.75;
/// The box that holds nothing.
const NOWHERE: Bounds = Bounds::new(DVec3::INFINITY, DVec3::NEG_INFINITY);

/// The result of a scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Scan {
    /// There is no surface in the cube.
    Empty,
    /// The surface in the cube lies in this box.
    Inside(Bounds),
    /// As [`Scan::Inside`], but at a side of the box no part of the surface is seen.
    TooLarge(Bounds),
    /// The surface passes through the faces of the cube: f changes its sign there. The box is that
    /// of its bends, if there are few.
    Crossing(Option<Bounds>),
    /// The bounds do not decide.
    Undecided,
}

/// How thoroughly a scan examines cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Effort {
    /// A cell is dropped by its own bounds.
    Plain,
    /// A cell is dropped by the bounds of its parts.
    Thorough,
}

/// Place of a cell in the grid of its level.
type CellPlace = [u32; 3];

/// A cell that may hold surface.
#[derive(Clone, Copy)]
struct OpenCell {
    at: CellPlace,
    /// The axes along which the surface may have an extreme in the cell.
    extremes: [bool; 3],
}

/// The grid of a level.
#[derive(Clone, Copy)]
struct ScanLevel {
    lo: DVec3,
    size: f64,
    /// Number of cells along a side.
    cells: u32,
    /// Number of halvings.
    depth: u32,
}

impl ScanLevel {
    fn cell(&self, at: CellPlace) -> Bounds {
        let [lo, hi] =
            [0, 1].map(|end| self.lo + self.size * DVec3::from_array(at.map(|k| f64::from(k + end))));
        Bounds::new(lo, hi)
    }

    fn is_at_face(&self, at: CellPlace) -> bool {
        at.into_iter().any(|k| k == 0 || k + 1 == self.cells)
    }
}

/// Scans the cube of this half-width around the origin in about `left` cells, and subtracts those
/// visited. Only a plain scan checks whether the box that it finds is too large.
pub(super) async fn scan(field: &mut dyn Bounded, half: f64, effort: Effort, left: &mut usize) -> Scan {
    let side = 2.0 * half * LARGER;
    let lo = side * (OFF_CENTRE / 2.0 - 0.5);
    let mut places = vec![[0; 3]];
    for depth in 0.. {
        let cells = 1_u32 << depth;
        let level = ScanLevel { lo, size: side / f64::from(cells), cells, depth };
        let kept = visit(field, &level, &places, effort, left).await;
        match result(field, &level, &kept, *left).await {
            None => places = eighths(&kept),
            Some(Scan::Crossing(_)) => return Scan::Crossing(bends(field, level, kept, effort, left).await),
            Some(Scan::Inside(hull))
                if effort == Effort::Plain && is_loose(field, &level, &kept, &hull).await =>
            {
                return Scan::TooLarge(hull);
            }
            Some(found) => return found,
        }
    }
    unreachable!("a level of the largest depth is the last")
}

/// The places of the eighths of the cells in the next level.
fn eighths(cells: &[OpenCell]) -> Vec<CellPlace> {
    let of =
        |cell: &OpenCell, eighth: u32| core::array::from_fn(|axis| 2 * cell.at[axis] + (eighth >> axis & 1));
    cells.iter().flat_map(|cell| (0..8).map(move |eighth| of(cell, eighth))).collect()
}

/// The result of the scan except for the bends, if a level with these cells is the last one.
async fn result(field: &mut dyn Bounded, level: &ScanLevel, kept: &[OpenCell], left: usize) -> Option<Scan> {
    if kept.is_empty() {
        return Some(Scan::Empty);
    }
    let is_last = level.depth >= DEPTH || left == 0;
    let is_idle =
        level.depth >= IDLE_LEVEL && kept.len() as f64 > IDLE_SHARE * f64::from(level.cells).powi(3);
    if kept.iter().any(|cell| level.is_at_face(cell.at)) {
        if !(is_last || is_idle || level.depth >= FACE_LEVEL || kept.len() > MANY_AT_FACES) {
            return None;
        }
        let is_crossing = crosses_faces(field, level, kept).await;
        return Some(if is_crossing { Scan::Crossing(None) } else { Scan::Undecided });
    }
    let share = if is_last { COARSE } else { FINE };
    let hull = hull(level, kept);
    if is_fine(level, &hull, share) {
        return Some(Scan::Inside(hull));
    }
    is_last.then_some(Scan::Undecided)
}

/// Whether the cells of a level are at most this share of a box wide.
fn is_fine(level: &ScanLevel, hull: &Bounds, share: f64) -> bool {
    level.size <= share * hull.size().max_element()
}

/// The box of the extremes.
fn hull(level: &ScanLevel, kept: &[OpenCell]) -> Bounds {
    let Bounds { mut min, mut max } = NOWHERE;
    for cell in kept {
        let own = level.cell(cell.at);
        for axis in (0..3).filter(|&axis| cell.extremes[axis]) {
            min[axis] = min[axis].min(own.min[axis]);
            max[axis] = max[axis].max(own.max[axis]);
        }
    }
    Bounds { min, max }
}

/// The box of the bends of an endless surface: of the cells with an extreme, if there are few and
/// none lies at the faces.
async fn bends(
    field: &mut dyn Bounded,
    mut level: ScanLevel,
    mut kept: Vec<OpenCell>,
    effort: Effort,
    left: &mut usize,
) -> Option<Bounds> {
    // A box that is fine enough; the next level shows whether it is [`STEADY`].
    let mut fine: Option<Bounds> = None;
    loop {
        kept.retain(|cell| cell.extremes != [false; 3]);
        if kept.is_empty() || kept.len() > MANY_AT_FACES || kept.iter().any(|cell| level.is_at_face(cell.at))
        {
            return None;
        }
        let hull = kept.iter().fold(NOWHERE, |hull, cell| hull.joined(&level.cell(cell.at)));
        if let Some(fine) = fine
            && hull.size().max_element() >= STEADY * fine.size().max_element()
        {
            return Some(fine);
        }
        if level.depth >= DEPTH || *left == 0 {
            return Some(hull);
        }
        fine = is_fine(&level, &hull, FINE).then_some(hull);
        level = ScanLevel { size: 0.5 * level.size, cells: 2 * level.cells, depth: level.depth + 1, ..level };
        kept = visit(field, &level, &eighths(&kept), effort, left).await;
    }
}

/// The cells that may hold surface, and are at the faces of the cube or may hold an extreme.
async fn visit(
    field: &mut dyn Bounded,
    level: &ScanLevel,
    cells: &[CellPlace],
    effort: Effort,
    left: &mut usize,
) -> Vec<OpenCell> {
    *left = left.saturating_sub(cells.len());
    let factors = field.factors();
    let mut kept = Vec::new();
    let mut batch = BoundsBatch::default();
    for chunk in cells.chunks(HEAVY) {
        let mut extremes = [None; HEAVY];
        for factor in 0..factors {
            batch.enclose(field, factor, level, chunk, effort, left, &mut extremes);
        }
        for (&at, extremes) in chunk.iter().zip(extremes) {
            if let Some(extremes) = extremes
                && (extremes != [false; 3] || level.is_at_face(at))
            {
                kept.push(OpenCell { at, extremes });
            }
        }
        pause().await;
    }
    kept
}

/// Whether a box is too large: at one of its sides no cell, once its parts are examined, may still
/// hold the extreme there.
async fn is_loose(field: &mut dyn Bounded, level: &ScanLevel, kept: &[OpenCell], hull: &Bounds) -> bool {
    let mut batch = BoundsBatch::default();
    let room = OUTER * hull.size().max_element();
    for axis in 0..3 {
        for is_upper in [false, true] {
            let mut outer: Vec<(f64, Bounds)> = kept
                .iter()
                .filter(|cell| cell.extremes[axis])
                .map(|cell| level.cell(cell.at))
                .map(|own| {
                    let inward = if is_upper {
                        hull.max[axis] - own.max[axis]
                    } else {
                        own.min[axis] - hull.min[axis]
                    };
                    (inward, own)
                })
                .filter(|&(inward, _)| inward <= room)
                .collect();
            sort_by_key(&mut outer, |&(inward, _)| key_of(inward));
            let mut is_seen = false;
            for (_, own) in outer.into_iter().take(MOST_OUTER) {
                is_seen = (0..field.factors()).any(|factor| {
                    let found = batch.look_into(field, factor, own, &mut { usize::MAX });
                    found.is_some_and(|extremes| extremes[axis])
                });
                pause().await;
                if is_seen {
                    break;
                }
            }
            if !is_seen {
                return true;
            }
        }
    }
    false
}

/// Bounds over a box in which f may vanish.
#[derive(Clone, Copy)]
struct Part {
    own: Bounds,
    /// The axes along which the surface may have an extreme.
    extremes: [bool; 3],
    /// The axis along which f changes most by its bounds.
    widest: usize,
    /// The sign of f in the middle; 0 if unknown.
    sign: i8,
}

/// Boxes and bounds over them.
#[derive(Default)]
struct BoundsBatch {
    boxes: Vec<Bounds>,
    known: Vec<Enclosure>,
    /// Indices of the boxes that the bounds of the expression do not exclude.
    open: Vec<usize>,
    middles: Vec<Bounds>,
    at_middle: Vec<Enclosure>,
    /// The boxes in which f may vanish, each with its index.
    parts: Vec<(usize, Part)>,
}

impl BoundsBatch {
    /// Notes the extremes that a factor of the field may have in cells where it may vanish.
    #[expect(clippy::too_many_arguments, reason = "those of a scan")]
    fn enclose(
        &mut self,
        field: &mut dyn Bounded,
        factor: usize,
        level: &ScanLevel,
        cells: &[CellPlace],
        effort: Effort,
        left: &mut usize,
        extremes: &mut [Option<[bool; 3]>; HEAVY],
    ) {
        self.boxes.clear();
        self.boxes.extend(cells.iter().map(|&at| level.cell(at)));
        self.find_parts(field, factor);
        for (k, part) in core::mem::take(&mut self.parts) {
            let of_parts = match effort {
                Effort::Plain => Some(part.extremes),
                Effort::Thorough => self.look_into(field, factor, part.own, left),
            };
            let Some(new) = of_parts else { continue };
            let found = extremes[k].get_or_insert([false; 3]);
            for (found, new) in found.iter_mut().zip(new) {
                *found |= new;
            }
        }
    }

    /// Finds the boxes in which a factor of the field may vanish, by the bounds of the expression
    /// and the mean value form.
    fn find_parts(&mut self, field: &mut dyn Bounded, factor: usize) {
        self.known.resize(self.boxes.len(), Enclosure::UNKNOWN);
        field.enclose(factor, &self.boxes, &mut self.known);
        self.open.clear();
        let may_vanish = |known: &Enclosure| known.value.holds(0.0) && known.may_vanish;
        self.open.extend((0..self.boxes.len()).filter(|&k| may_vanish(&self.known[k])));
        self.middles.clear();
        self.middles.extend(self.open.iter().map(|&k| Bounds::point(self.boxes[k].middle())));
        self.at_middle.resize(self.middles.len(), Enclosure::UNKNOWN);
        field.enclose(factor, &self.middles, &mut self.at_middle);
        self.parts.clear();
        for (&k, middle) in self.open.iter().zip(&self.at_middle) {
            let (known, own) = (&self.known[k], self.boxes[k]);
            let is_regular = known.defined && known.continuous;
            let half = 0.5 * own.size();
            let swings: [f64; 3] = core::array::from_fn(|axis| known.gradient[axis].magnitude() * half[axis]);
            if is_regular && middle.value.mean_value(swings.iter().sum()).excludes_zero() {
                continue;
            }
            let extremes = core::array::from_fn(|axis| {
                let others = [(axis + 1) % 3, (axis + 2) % 3];
                !is_regular || others.iter().all(|&other| known.gradient[other].holds(0.0))
            });
            // If nothing is known, it is the longest side.
            let is_known = swings.iter().all(|swing| swing.is_finite());
            let weight = |axis: &usize| if is_known { swings[*axis] } else { half[*axis] };
            let widest = (0..3).max_by(|a, b| weight(a).total_cmp(&weight(b))).unwrap_or(0);
            let sign = match middle.value {
                value if is_regular && value.lo > 0.0 => 1,
                value if is_regular && value.hi < 0.0 => -1,
                _ => 0,
            };
            self.parts.push((k, Part { own, extremes, widest, sign }));
        }
    }

    /// The extremes that a factor of the field may have in a cell, by the bounds of its parts; none
    /// if it vanishes nowhere. The parts are subtracted from `left`.
    fn look_into(
        &mut self,
        field: &mut dyn Bounded,
        factor: usize,
        cell: Bounds,
        left: &mut usize,
    ) -> Option<[bool; 3]> {
        self.boxes.clear();
        self.boxes.push(cell);
        for _ in 0..HALVINGS {
            *left = left.saturating_sub(self.boxes.len());
            self.find_parts(field, factor);
            if self.parts.is_empty() {
                return None;
            }
            let is_passed = |sign: i8| self.parts.iter().any(|(_, part)| part.sign == sign);
            if self.parts.len() > MOST_PARTS || *left == 0 || is_passed(1) && is_passed(-1) {
                break;
            }
            self.boxes.clear();
            self.boxes.extend(self.parts.iter().flat_map(|(_, part)| part.halves()));
        }
        let mut extremes = [false; 3];
        for (_, part) in &self.parts {
            for (found, new) in extremes.iter_mut().zip(part.extremes) {
                *found |= new;
            }
        }
        Some(extremes)
    }
}

impl Part {
    /// The two halves along the widest axis.
    fn halves(&self) -> [Bounds; 2] {
        let middle = self.own.middle()[self.widest];
        let (mut lower, mut upper) = (self.own, self.own);
        (lower.max[self.widest], upper.min[self.widest]) = (middle, middle);
        [lower, upper]
    }
}

/// Whether f changes its sign between corners of a cell at the faces in which it is continuous.
async fn crosses_faces(field: &mut dyn Bounded, level: &ScanLevel, kept: &[OpenCell]) -> bool {
    let factors = field.factors();
    for cell in kept.iter().filter(|cell| level.is_at_face(cell.at)) {
        let own = level.cell(cell.at);
        let mut boxes = vec![own];
        boxes.extend((0..8).map(|corner| {
            let pick = |axis: usize| if corner >> axis & 1 == 0 { own.min[axis] } else { own.max[axis] };
            Bounds::point(DVec3::new(pick(0), pick(1), pick(2)))
        }));
        let mut known = [Enclosure::UNKNOWN; 9];
        for factor in 0..factors {
            field.enclose(factor, &boxes, &mut known);
            let corners = &known[1..];
            let is_regular = known[0].defined && known[0].continuous;
            if is_regular
                && corners.iter().any(|corner| corner.value.hi < 0.0)
                && corners.iter().any(|corner| corner.value.lo > 0.0)
            {
                return true;
            }
        }
        pause().await;
    }
    false
}
