//! The extent of a surface: the box that fits it.
//!
//! A scan of a cube by interval arithmetic finds the cells in which the surface may have an extreme
//! along an axis, and whether it continues through the faces of the cube. The first cube reaches to
//! ±10⁴. If the surface stays inside, its box is that of the extremes. If it is endless, smaller
//! cubes follow, until it stays inside one (a sphere and a far plane), shows where its bends are,
//! or is known to pass near the origin. What intervals do not decide is examined on a grid, and
//! parts that are thinner than its cells are followed to their ends on the surface.
//!
//! The work is counted in cells and can be interrupted and continued; the result is the same to the
//! last bit everywhere.

mod grid;
mod sampled;
mod scan;
mod walk;

pub(crate) use grid::CELLS;
pub(crate) use sampled::defined_share;

use crate::field::{Bounded, Field, Frame, Within};
use crate::math::Bounds;
use crate::slices::{self, pause};
use glam::DVec3;
use scan::{Effort, Scan};
use serde::Serialize;

/// Half-widths of the cubes that are searched, the largest first, each about a fifth of the one
/// before. An endless surface gets the smallest of them as its box, so that another choice gives it
/// another box.
pub(crate) const HALVES: [f64; 6] = [10_000.0, 2_000.0, 400.0, 80.0, 16.0, 4.0];
/// Half-width of the box of an endless surface that passes near the origin: the smallest cube that
/// is searched. A gyroid has one and a quarter periods in it.
const USUAL_HALF: f64 = HALVES[HALVES.len() - 1];
/// A surface with a shorter period gets a box of two periods instead: [`USUAL_HALF`] would show
/// more than four.
const SHORT_PERIOD: f64 = 0.5 * USUAL_HALF;
/// The box if there is no surface, or nothing is known of it. A unit sphere fills half of its
/// width.
pub const FALLBACK: Bounds = Bounds::cube(2.0);
/// Room around the bends of an endless surface on every side, as a share of their box, so that they
/// fill two thirds of it. A larger room shows more of the surface beyond, and the bends smaller.
const ROOM: f64 = 0.25;
/// Room around a surface on every side, as a share of its box. It is three radii of a hundredth of
/// the diagonal, so that the box is the same for all smaller particles. A larger room leaves less
/// of the box to the surface, and a smaller one makes the box depend on the radius more often.
const MARGIN: f64 = 0.05;
/// Room around a surface in radii of particles: children are proposed at two radii, and a third one
/// keeps them off the faces.
const MARGIN_RADII: f64 = 3.0;
/// Largest room by radii, as a share of the longest side: the surface fills at least half of it.
const MOST_MARGIN: f64 = 0.5;
/// A box by bounds that is too large is replaced by one that grids show, if that is smaller than
/// this share of it: in the larger one, particles of a usual size would be as large as the surface.
const WASTED: f64 = 0.1;
/// Most cells visited for a short formula: 20 to 50 milliseconds. Fewer make the box wider.
const MOST_CELLS: usize = 32_768;
/// Largest number of operations of a formula that may have [`MOST_CELLS`]. A longer one may have
/// fewer cells, in inverse proportion, so that it takes as long.
const SHORT: usize = 64;

/// Whether a surface is bounded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Reach {
    /// The surface within ±10⁴ lies in the box: by proof or, where bounds do not decide, by grids
    /// and by walks to the ends of thin parts.
    Bounded,
    /// The surface continues outside the box.
    Endless,
    /// There is no surface within ±10⁴.
    Nowhere,
    /// Neither intervals nor a grid decide whether the surface is bounded.
    #[default]
    Unknown,
}

/// The box around a surface, without room, and whether the surface is bounded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// Box around all bounded components and a part of each endless one.
    pub bounds: Bounds,
    /// Whether the surface is bounded.
    pub reach: Reach,
}

impl Extent {
    /// The box with room for particles whose radius is at most a share of its diagonal, which may
    /// depend on the box: 5 % on every side, and three radii. A box that cuts the surface has room
    /// already.
    #[must_use]
    pub fn with_room(&self, share_in: impl Fn(&Bounds) -> f64) -> Bounds {
        if self.reach != Reach::Bounded {
            return self.bounds;
        }
        /// Rounds in which room and diagonal are adapted to each other; the error of the room falls
        /// by a factor of ten in each for usual radii.
        const ROUNDS: u32 = 8;
        let size = self.bounds.size();
        let most = MOST_MARGIN * size.max_element();
        let around = |room: DVec3| placeable(&Bounds::new(self.bounds.lo() - room, self.bounds.hi() + room));
        let mut room = MARGIN * size;
        for _ in 0..ROUNDS {
            let share = share_in(&around(room));
            let radii = (MARGIN_RADII * share * (size + 2.0 * room).length()).min(most);
            room = (MARGIN * size).max(DVec3::splat(radii));
        }
        around(room)
    }
}

/// Finds the box of the surface of a field.
#[must_use]
pub fn find(field: &dyn Field) -> Extent {
    slices::complete(find_in_slices(field))
}

/// [`find`] in slices of some 32 cells each.
pub(crate) async fn find_in_slices(field: &dyn Field) -> Extent {
    if let Some(Within { bounds, is_cut }) = field.facts().within {
        let reach = if is_cut { Reach::Endless } else { Reach::Bounded };
        return Extent { bounds: placeable(&bounds), reach };
    }
    let mut evaluator = field.evaluator(Frame::default());
    let found = match evaluator.bounded() {
        Some(bounded) => scanned(field, bounded).await,
        None => sampled::find(field).await,
    };
    match (found.reach, of_periods(field.facts().periods)) {
        (Reach::Endless | Reach::Unknown, Some(bounds)) => Extent { bounds, reach: found.reach },
        _ => found,
    }
}

/// Finds the box of a surface from the bounds of its field.
async fn scanned(field: &dyn Field, bounded: &mut dyn Bounded) -> Extent {
    let cells = MOST_CELLS * SHORT / bounded.operations().max(SHORT);
    // A plain scan that decides nothing may have used all of its cells.
    let (mut left, mut more) = (cells, cells);
    let mut bends: Option<Bounds> = None;
    let mut before = None;
    for half in HALVES {
        let is_first = before.is_none();
        let mut found = scan::scan(bounded, half, Effort::Plain, &mut left).await;
        pause().await;
        if found == Scan::Undecided && is_first {
            found = scan::scan(bounded, half, Effort::Thorough, &mut more).await;
            pause().await;
        }
        if let Scan::TooLarge(hull) = found {
            let closer = scan::scan(bounded, half, Effort::Thorough, &mut more).await;
            pause().await;
            // The surface is in both boxes. Without the other one, the first still holds it.
            let common = |other: Bounds| Bounds {
                min: core::array::from_fn(|axis| hull.min[axis].max(other.min[axis])),
                max: core::array::from_fn(|axis| hull.max[axis].min(other.max[axis])),
            };
            let hull = if let Scan::Inside(other) = closer { common(other) } else { hull };
            if is_first
                && let seen = sampled::find(field).await
                && seen.reach == Reach::Bounded
                && seen.bounds.size().max_element() < WASTED * hull.size().max_element()
            {
                return seen;
            }
            found = Scan::Inside(hull);
        }
        match found {
            Scan::Inside(hull) => {
                let reach = if is_first { Reach::Bounded } else { Reach::Endless };
                let bounds = placeable(&hull);
                // A surface beyond the box does not affect the room inside.
                let extent = Extent { bounds, reach: Reach::Bounded };
                return if is_first { extent } else { Extent { bounds: extent.with_room(|_| 0.0), reach } };
            }
            Scan::Empty => {
                return match before {
                    None => Extent { bounds: FALLBACK, reach: Reach::Nowhere },
                    Some(half) => Extent { bounds: Bounds::cube(half), reach: Reach::Endless },
                };
            }
            Scan::Crossing(hull) => bends = bends.or(hull),
            Scan::Undecided if is_first => return sampled::find(field).await,
            Scan::Undecided | Scan::TooLarge(_) => {}
        }
        before = Some(half);
    }
    Extent { bounds: around(bends), reach: Reach::Endless }
}

/// The box of an endless surface with these bends, if known.
fn around(bends: Option<Bounds>) -> Bounds {
    let usual = Bounds::cube(USUAL_HALF);
    let Some(bends) = bends else { return usual };
    if usual.holds(bends.lo()) && usual.holds(bends.hi()) {
        return usual;
    }
    placeable(&Bounds::point(bends.middle()).enlarged((0.5 + ROOM) * bends.size().max_element()))
}

/// The box of a surface that is periodic along every axis: of a short period two; none if none is
/// short.
fn of_periods(periods: [Option<f64>; 3]) -> Option<Bounds> {
    let [Some(x), Some(y), Some(z)] = periods else { return None };
    let of = |period: f64| if period < SHORT_PERIOD { period } else { USUAL_HALF };
    let longest = x.max(y).max(z);
    let is_short = [x, y, z].into_iter().any(|period| period > 0.0 && period < SHORT_PERIOD);
    // Along an axis on which nothing changes, the box is as wide as along the widest other one.
    let half = [x, y, z].map(|period| of(if period > 0.0 { period } else { longest }));
    is_short.then(|| placeable(&Bounds::symmetric(half)))
}

/// A box of one period along every axis on which the surface of a field has one, and as wide as
/// `bounds` along the others. Any such box holds all of the surface. This one has its corners far
/// from the surface, where |f| is largest on a grid, and its faces away from planes of symmetry,
/// which often touch the surface: then creases are plain curves.
#[must_use]
pub fn unit_cell(field: &dyn Field, periods: [Option<f64>; 3], bounds: &Bounds) -> Bounds {
    /// Places of the corner along each axis. Fewer get less close to the largest |f| in the cell.
    const SIDE: u32 = 8;
    /// Place of the first one, as a share of the distance between two: by the golden ratio, since
    /// planes of symmetry are at simple fractions.
    const ASIDE: f64 = 0.382;
    let periods = DVec3::from_array(periods.map(Option::unwrap_or_default));
    let is_repeated = periods.cmpgt(DVec3::ZERO);
    let first = DVec3::select(is_repeated, bounds.middle() - 0.5 * periods, bounds.lo());
    let corner = |k: u32| {
        let share = DVec3::new(k.into(), (k / SIDE).into(), (k / SIDE.pow(2)).into()) % f64::from(SIDE);
        first + periods * ((share.floor() + ASIDE) / f64::from(SIDE))
    };
    let mut field = field.evaluator(Frame::default());
    let mut best = (first, -1.0);
    for corner in (0..SIDE.pow(3)).map(corner) {
        let (value, _) = field.value_and_gradient(corner);
        if value.abs() > best.1 {
            best = (corner, value.abs());
        }
    }
    Bounds::new(best.0, DVec3::select(is_repeated, best.0 + periods, bounds.hi()))
}

/// The box, enlarged around its middle until particles can be put in it.
fn placeable(wanted: &Bounds) -> Bounds {
    let (middle, mut half) = (wanted.middle(), 0.5 * wanted.size());
    // A flat box has no room across.
    half = half.max(DVec3::splat(1e-6 * half.max_element()).max(DVec3::splat(f64::MIN_POSITIVE)));
    loop {
        let bounds = Bounds::new(middle - half, middle + half);
        if bounds.is_valid() || !half.is_finite() {
            return bounds;
        }
        half *= 2.0;
    }
}

#[cfg(test)]
mod tests;
