//! Patterns without rows: blue noise and random points, drawn over the front that covers the
//! surface.
//!
//! 1. *Cells.* Every point of the surface belongs to the particle of the front that is nearest to
//!    it. A square in the tangent plane of the particle holds its share, and is divided into
//!    cells ([`cells`]).
//! 2. *Darts.* A point drawn evenly from a cell is projected along the particle's normal. It
//!    counts if the particle is the nearest one. So points are even by area up to the slope
//!    between the plane and the surface, which is known.
//! 3. *Blue noise.* Darts are thrown into the cells in random order, and one that collides with an
//!    earlier one is dropped. Then, square by square in random order, cells that are covered by the
//!    discs of the points are dropped and the others divided, with a dart into each that is left,
//!    until all are covered: M. S. Ebeida, S. A. Mitchell, A. Patney, A. A. Davidson, J. D. Owens,
//!    "A Simple Algorithm for Maximal Poisson-Disk Sampling in High Dimensions", 2012, which goes
//!    through all cells of a size before it divides them.
//! 4. *Count.* The radius of a wanted count is chosen slightly too large. The points that are
//!    missing then are put into the largest holes, one by one, and the radius shrinks to that of
//!    the last hole. So the count is exact, and no hole is larger than a disc.
//!
//! Particles on creases and corners stay in even rows, as those of the front.

mod cells;
mod exactly;
mod holes;
mod steps;
mod taken;

use crate::math::Bounds;
use crate::particles::Particles;
use crate::sampler::attempt::Attempt;
use crate::sampler::discovery::survey::Survey;
use crate::sampler::front::{FrontPlan, is_on_sheet};
use crate::sampler::neighbours::grids::{RadiusGrids, RadiusRange};
use crate::sampler::probe::Probe;
use crate::sampler::projection::Tolerance;
use crate::sampler::settings::Pattern;
use crate::sampler::sheet::{PointPair, SheetRule, UNCOVERED, face_one_way};
use crate::sampler::sizing::Sizing;
use crate::spatial::Neighbour;
use cells::Cell;
use glam::Vec3;
use holes::Bound;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use std::collections::BinaryHeap;
use taken::Taken;

/// Divisions of the square of a particle along each side.
const SIDE: u32 = 4;
/// Cells of a square.
const CELLS: u32 = SIDE * SIDE;

/// The surface as the particles of a pattern are placed on it.
pub(super) struct Ground<'a> {
    sizing: Option<&'a Sizing>,
    /// Radius of a particle, if there is one size.
    radius: f32,
    /// Radius of the front's particles.
    front_radius: f32,
    /// Factor on all radii.
    scale: f32,
    tolerance: Tolerance,
    /// The smallest residual that single precision resolves.
    finest: f32,
    bounds: Bounds,
}

impl<'a> Ground<'a> {
    pub(super) fn of(
        attempt: &'a Attempt,
        plan: &FrontPlan,
        survey: &Survey,
        bounds: &Bounds,
        scale: f32,
    ) -> Self {
        Self {
            sizing: attempt.sizing.as_ref(),
            radius: attempt.radius as f32,
            front_radius: plan.radius,
            scale,
            tolerance: plan.tolerance(survey),
            finest: survey.residual_limits().finest,
            bounds: *bounds,
        }
    }

    /// Largest slope of the radius.
    fn slope(&self) -> f32 {
        self.sizing.map_or(0.0, |sizing| self.scale * sizing.slope())
    }

    /// The radius of a particle at a place of the patch that the probe evaluates.
    fn radius_at(&self, probe: &mut Probe, place: Vec3) -> f32 {
        self.scale * self.sizing.map_or(self.radius, |sizing| sizing.radius_at(probe.field, place))
    }
}

/// A place on the surface for a particle.
#[derive(Clone, Copy, Debug)]
struct Spot {
    position: Vec3,
    normal: Vec3,
    radius: f32,
    patch: Option<u32>,
}

impl Spot {
    /// The place of a particle.
    fn of(particles: &Particles, row: usize) -> Self {
        Self {
            position: particles.local[row],
            normal: particles.normal[row],
            radius: particles.radius[row],
            patch: particles.patch_of(row),
        }
    }
}

/// The pattern that is being drawn.
#[derive(Default)]
pub(super) struct Drawing {
    pattern: Pattern,
    /// The front whose particles share out the surface.
    front: Particles,
    grid: RadiusGrids,
    found: Vec<Neighbour>,
    rule: SheetRule,
    /// Half the side of a particle's square, in its radii.
    half: f32,
    /// Factor on all radii.
    scale: f32,
    /// The cells of squares that may hold some of the surface: [`CELLS`] times the number of the
    /// particle, plus that of the cell.
    pieces: Vec<u32>,
    /// Largest number of particles, and the wanted one.
    limit: usize,
    wanted: Option<usize>,
    /// The particles so far.
    count: usize,
    /// Whether another one was found that there is no room for.
    is_full: bool,
    trials: u32,
    /// Particles that are expected per hexagonal cell 2√3 r².
    packing: f64,
    seed: u64,
    random: Random,
    /// The next item of the part under way.
    next: usize,
    /// Sum over the darts that count.
    tally: f64,
    /// Rounds of darts thrown.
    round: usize,
    taken: Taken,
    /// The squares in random order, each by the place of its first piece.
    squares: Vec<u32>,
    /// While the cells of one square are judged, the particles of the front that may be nearer than
    /// the square's to places up to a distance from it.
    around: Option<(f32, Vec<Neighbour>)>,
    /// Cells that would be uncovered if all radii shrank to a factor above the `least`.
    reserve: BinaryHeap<Bound>,
    least: f32,
    /// For the particles of a front, the factor on the radii at which each would touch another.
    crowding: Vec<f32>,
}

impl Drawing {
    /// A drawing over a front of this plan.
    fn over(front: Particles, plan: &FrontPlan, rule: SheetRule) -> Self {
        /// Half the side of a square is at most so many radii of its particle.
        const MOST: f32 = 3.0;
        // A cover has no hole wider than UNCOVERED radii; they grow away from a small particle.
        let slope = plan.sizing.as_ref().map_or(0.0, Sizing::slope);
        let half = UNCOVERED / (1.0 - UNCOVERED * slope).max(UNCOVERED / MOST);
        let mut grid = RadiusGrids::default();
        grid.reset(RadiusRange::among(&front.radius), |radius| UNCOVERED * radius);
        grid.reserve(front.len());
        for (i, (&position, &radius)) in (0..).zip(front.local.iter().zip(&front.radius)) {
            grid.insert(position, radius, i);
        }
        Self { front, grid, rule, half, scale: 1.0, ..Self::default() }
    }

    /// Half the side of the square of particle `i`.
    fn half_side(&self, i: usize) -> f32 {
        self.half * self.front.radius[i]
    }

    /// The area of the surface over a cell of a particle's square that is parallel to it at a spot,
    /// over the square of the radius there.
    fn area_over_radius_sq(&self, owner: u32, spot: &Spot) -> f32 {
        let owner = owner as usize;
        let side = 2.0 * self.half_side(owner) / SIDE as f32 / spot.radius;
        side * side / spot.normal.dot(self.front.normal[owner])
    }

    /// That of a particle of the front, where it is parallel to the square.
    fn usual_area_over_radius_sq(&self, front_radius: f32) -> f32 {
        let side = 2.0 * self.half / SIDE as f32 * front_radius;
        side * side
    }

    /// Makes it faster to judge these cells of the square of a particle, whose radius over that of
    /// the front is `ratio`.
    fn look_around(&mut self, owner: usize, cells: &[Cell], ratio: f32) {
        /// Room for the bend of the surface, and for radii that vary: places and radii beyond are
        /// looked up one by one.
        const MORE: f32 = 1.1;
        let (half, centre) = (self.half_side(owner), self.front.local[owner]);
        let farthest = cells.iter().map(|cell| cell.farthest(half)).fold(0.0, f32::max);
        let distance = MORE * farthest;
        let mut around = self.around.take().unwrap_or_default();
        self.grid.gather(centre, |_| 2.0 * distance, &mut around.1);
        around.0 = distance;
        self.around = Some(around);
        self.taken.look_around(centre, distance, MORE * ratio * self.front.radius[owner]);
    }

    /// Judges cells of any square from now on.
    fn look_anywhere(&mut self) {
        self.around = None;
        self.taken.look_anywhere();
    }

    /// Whether particle `owner` may be the nearest one to a point at most `reach` from a spot.
    fn may_own(&mut self, probe: &mut Probe, owner: usize, spot: &Spot, reach: f32) -> bool {
        let Self { front, grid, found, rule, around, .. } = self;
        let own_sq = front.local[owner].distance_squared(spot.position);
        let found = match around {
            Some((distance, around)) if own_sq <= *distance * *distance => &*around,
            _ => {
                grid.gather(spot.position, |_| own_sq.sqrt(), found);
                &*found
            }
        };
        found.iter().all(|near| {
            let j = near.index as usize;
            let (other, offset) = (front.normal[j], front.local[j] - spot.position);
            let surplus = own_sq - offset.length_squared();
            // Which of two places is nearer to a point is told by a linear function of the point.
            j == owner
                || surplus <= 0.0
                || surplus <= 2.0 * reach * front.local[j].distance(front.local[owner])
                || !front.is_on(j, spot.patch)
                || !face_one_way(spot.normal, other)
                || {
                    let pair = PointPair { offset, normal: spot.normal, other };
                    let probe = &mut probe.on(spot.patch);
                    !is_on_sheet(*rule, probe, spot.position, pair, 2.0 * spot.radius)
                }
        })
    }
}

/// The random numbers of a pattern.
#[derive(Clone, Debug)]
struct Random(Pcg32);

impl Default for Random {
    fn default() -> Self {
        Self::seeded(0)
    }
}

impl Random {
    fn seeded(seed: u64) -> Self {
        Self(Pcg32::seed_from_u64(seed))
    }

    /// A number from 0 to below 1.
    fn unit(&mut self) -> f32 {
        /// One over the number of values.
        const STEP: f32 = 1.0 / (1 << 24) as f32;
        (self.0.next_u32() >> 8) as f32 * STEP
    }

    /// A whole number below `count`.
    fn below(&mut self, count: usize) -> usize {
        ((u64::from(self.0.next_u32()) * count as u64) >> 32) as usize
    }

    /// Puts items into random order (Fisher and Yates).
    fn shuffle<T>(&mut self, items: &mut [T]) {
        for last in (1..items.len()).rev() {
            items.swap(last, self.below(last + 1));
        }
    }
}
