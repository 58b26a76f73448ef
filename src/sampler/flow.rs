//! Particles that follow a surface while it moves, frame by frame: the idea of Witkin and Heckbert
//! 1994 (§4), starting from the paper's fronts.
//!
//! A frame has three parts. The particles are *transported* down the gradient onto the new surface;
//! one that does not reach it dies. Every few frames they are *balanced*. Then they make a step of
//! the [relaxation](super::relaxation). The surface is surveyed in the frame after a balance, so
//! that no frame takes much longer than another. After a leap, which some particles cannot make,
//! both happen at once. The balance:
//!
//! * Of two particles that crowd each other the younger one dies. So does a particle whose energy
//!   is too large and larger than that of all around it.
//! * Children are placed as a front places them wherever a sector around a particle is open: where
//!   a sheet tears, widens or comes into the box. A point of a new survey that no particle is near
//!   is a seed, of a component that was born.
//! * A particle whose energy is too small and smaller than that of all around it gets a child in
//!   the widest gap next to it.
//!
//! Births and deaths at extrema of the energy are spread evenly, and hold the density. They leave
//! the disorder of Witkin and Heckbert's system: only a new run restores the order of the fronts.
//! The particles of a refined run keep their order as long as they move with its
//! [mesh](crate::sampler::refine::MovingMesh).
//!
//! # Differs from Witkin and Heckbert
//!
//! * Velocities are not integrated: a particle goes to the new surface by Newton's method, so that
//!   it never drifts from it.
//! * The run's radii are kept and do not adapt (their §4.3); fission is a birth in a gap.

use crate::field::Evaluator;
use crate::math::functions::{atan2, cos, sin};
use crate::math::{Bounds, place_text, refill, sort_few, tangent_frame};
use crate::particles::{OrientedPoint, Particles, SlotFate, Slots};
use crate::sampler::discovery::survey::{SAMPLES, Survey};
use crate::sampler::front::widest_gap;
use crate::sampler::neighbours::constants::GAUSSIAN_RANGE;
use crate::sampler::neighbours::grids::{GridHandle, RadiusGrids, RadiusRange};
use crate::sampler::neighbours::packed::PackedNeighbours;
use crate::sampler::probe::Probe;
use crate::sampler::projection::{ChildCircle, CircleLanding, tolerance};
use crate::sampler::relaxation::TRANSPORT_REACH;
use crate::sampler::relaxation::repulsion::{END_ENERGY, pair_energy};
use crate::sampler::sheet::{SheetRule, UNCOVERED, is_cover, is_level};
use crate::sampler::sizing::Sizing;
use crate::spatial::Neighbour;
use core::f32::consts::{FRAC_PI_3, PI, TAU};
use core::f64::consts::E;
use glam::{Vec2, Vec3};

/// Frames from one balance to the next. Smaller: on the sweeps of `benches/flow.rs` fewer of the
/// first particles survive; larger: holes are wider.
pub(crate) const BALANCE_EVERY: u32 = 4;

/// Steps of relaxation after a balance; every other frame has one. With one the closest pairs of
/// the sweeps of `benches/flow.rs` are nearer; a third changes nothing.
const STEPS_AFTER_BALANCE: u32 = 2;

/// Two particles nearer than this, over the sum of their radii, crowd each other: a front matches a
/// child so near to a particle with it. With less or more, the count is farther off.
const CROWDED: f32 = 0.7;

/// The energy, over the usual one, below which a particle gets a child if no neighbour has less,
/// and above which it dies if none has more. If the second is smaller, more particles die in a
/// sweep.
const LEAST_ENERGY: f32 = 0.9;
const MOST_ENERGY: f32 = 1.3;

/// The energy, over the usual one, below which a particle gets a child in a wide gap next to it,
/// whatever its neighbours have: on a surface that grows everywhere extrema are too few. Without
/// this rule growing spheres have too few particles.
const SPARSE_ENERGY: f32 = 0.8;

/// Radii of gaps, over the sum of two radii: from the first on an extremum has room for a child,
/// from the second on a gap is wide. In a lattice gaps have 0.577. Smaller second: fewer particles
/// have six neighbours; larger: the count is farther off.
const GAP: f32 = 0.5;
const WIDE_GAP: f32 = 0.7;

/// Energy of a pair of neighbours in a lattice: exp(−2) less the energy at the end of the range.
const LATTICE_PAIR: f64 = 1.0 / (E * E) - END_ENERGY as f64;

/// A sector without a neighbour is open above this angle: in a lattice it has 60°, and 120° where
/// one neighbour is missing.
const OPEN_SECTOR: f32 = 100.0 / 180.0 * PI;

/// As in a front, a child is placed 60° from the neighbour at which an open sector begins. In a
/// sector too narrow for two it is placed in the middle: below halfway between 120° and the 180°
/// that two need.
const NARROW_SECTOR: f32 = 150.0 / 180.0 * PI;

/// Distance that a child in an open sector needs from all others, over the sum of the radii.
/// Smaller: the count is farther off.
const CLEAR: f32 = 0.8;

/// Largest share of the particles that may be farther from the new surface than from each other.
/// Larger: after a leap the count is farther off, and fewer particles have six neighbours.
const MOST_FAR: f64 = 0.1;

/// Least share of such particles that makes the frame a leap, in which the others are balanced at
/// once: fewer may lie where the gradient vanishes. Without the balance a leap may leave wide
/// holes.
const LEAP: f64 = 0.01;

/// Why particles cannot follow a surface. Nothing changes then: a run under way continues, and a
/// finished one keeps its particles.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FollowError {
    /// The run is under way.
    #[error("the run has not ended, and goes on: let its particles follow when it has")]
    UnderWay,
    /// No particles cover the surface: the run was cut short or has fewer than two particles, or no
    /// run has these settings.
    #[error(
        "no particles cover the surface, of a run with these settings that has come to its end: start one"
    )]
    NotCovered,
    /// Blue noise or random points, whose pattern would be lost.
    #[error("a pattern of random points cannot follow a moving surface: start a run on the new one")]
    Pattern,
    /// The old or the new surface has creases or smooth joins, or the new one may have some in the
    /// box.
    #[error(
        "the surface has creases, smooth joins or tips in the box, on which particles cannot follow: start a run on the new one"
    )]
    Creased,
    /// The surface is gone, or it has moved too far: more than a tenth of the particles are farther
    /// from it than from each other.
    #[error(
        "{:.0} % of the particles, first near {}, are farther from the new surface than from each other: it has moved too far, or is gone. \
         Move it there in smaller steps, or start a run on it",
        100.0 * share, place_text(*position, *length)
    )]
    TooFar {
        /// The share of such particles.
        share: f64,
        /// The first of them, in the coordinates of the field.
        position: [f64; 3],
        /// Radius of the run.
        length: f64,
    },
}

/// The settings of the run that births and deaths in a frame depend on.
pub(crate) struct FlowSurface<'a> {
    pub(crate) bounds: Bounds,
    pub(crate) survey: &'a Survey,
    pub(crate) rule: SheetRule,
    /// The radius field of an adaptive run.
    pub(crate) sizing: Option<&'a Sizing>,
    /// The radius of a uniform run.
    pub(crate) radius: f32,
    /// The wanted number of particles, if there is one.
    pub(crate) count: Option<u32>,
    pub(crate) max_particles: usize,
}

/// The outcome of a frame's births and deaths.
pub(crate) struct Settled {
    /// The new row of each particle, including those born; none if no rows were added or removed.
    pub(crate) rows: Option<Vec<u32>>,
    /// Steps of relaxation that the frame has.
    pub(crate) steps: u32,
}

/// A neighbour in the tangent plane of a particle: its direction, and its distance over the sum of
/// the radii.
#[derive(Clone, Copy)]
struct Bearing {
    angle: f32,
    distance: f32,
    index: u32,
}

/// A particle with too little energy. It gets a child in a gap next to it that has at least this
/// radius.
struct Sparse {
    parent: usize,
    least: f32,
}

/// Particles that follow a surface.
#[derive(Clone, Default)]
pub(crate) struct Flow {
    /// Frames since the last balance; a survey begins the first of them.
    frames: u32,
    /// Whether the surface has moved too far for some particles in this frame, which therefore has
    /// a survey and a balance, whatever its turn.
    is_leap: bool,
    /// Whether particles are neither born nor die, except those that the transport loses.
    pub(crate) is_closed: bool,
    /// Whether a survey has found no place without particles since they have moved with a mesh.
    pub(crate) is_seeded: bool,
    /// Whether the last frame was finished, so that the neighbour lists match these particles.
    pub(crate) is_whole: bool,
    /// Whether the neighbour lists matched these particles at the beginning of this frame.
    are_listed: bool,
    /// The number of the next particle that is born.
    next_identity: u32,
    /// Mean energy of the particles at the end of the run, at which none dies or gets a child; none
    /// before the first balance.
    usual_energy: Option<f32>,
    /// Factor by which radii had to grow at the last balance to keep the wanted count.
    growth: f64,
    columns: BalanceColumns,
    /// Particles that crowd an older one.
    crowded: Vec<u32>,
    /// Particles whose open sectors are to be closed, oldest first.
    open: Vec<u32>,
    grids: RadiusGrids,
    found: Vec<Neighbour>,
    around: Vec<Bearing>,
    landing: Vec<CircleLanding>,
}

/// Columns of a balance: a value for every particle.
#[derive(Clone, Default)]
struct BalanceColumns {
    handle: Vec<GridHandle>,
    /// Energy, by [`pair_energy`], without neighbours that have died; next to an open sector it
    /// includes what the missing neighbours would add.
    energy: Vec<f32>,
    is_open: Vec<bool>,
    is_dead: Vec<bool>,
}

impl Flow {
    /// Begins with the particles of a run, each identified by its row, unless they are numbered
    /// already.
    pub(crate) fn begin(&mut self, particles: &mut Particles) {
        if particles.identity.is_empty() {
            let n = particles.len() as u32;
            particles.identity.extend(0..n);
            *self = Self { next_identity: n, growth: 1.0, ..Self::default() };
        }
    }

    /// Marks this frame for a survey and a balance.
    pub(crate) fn leap(&mut self) {
        self.is_leap = true;
    }

    /// Begins a frame without a mesh. Returns whether the neighbour lists match these particles.
    pub(crate) fn begin_frame(&mut self) -> bool {
        self.are_listed = core::mem::take(&mut self.is_whole);
        self.are_listed
    }

    /// Factor by which radii had to grow at the last balance to keep the wanted count.
    pub(crate) fn growth(&self) -> f64 {
        self.growth
    }

    /// Ends a frame of particles that have moved with a mesh. Returns whether they cover the
    /// surface, according to a survey if there was one; if not, the next frame balances them.
    pub(crate) fn end_with_mesh(&mut self, particles: &mut Particles, survey: &Survey) -> bool {
        let is_surveyed = self.is_due();
        self.end_turn();
        self.growth = 1.0;
        self.is_seeded = false;
        self.number(particles);
        if !is_surveyed {
            return true;
        }
        refill(&mut self.columns.is_dead, particles.len(), false);
        self.fill_grids(particles);
        let covers =
            survey.position.iter().zip(&survey.normal).all(|(&p, &n)| self.is_covered(particles, p, n));
        if !covers {
            self.hurry();
        }
        covers
    }

    /// Has the particles balanced as soon as their neighbours are known.
    pub(crate) fn hurry(&mut self) {
        self.frames = BALANCE_EVERY - 1;
    }

    /// Numbers the particles that were born.
    pub(crate) fn number(&mut self, particles: &mut Particles) {
        while particles.identity.len() < particles.len() {
            particles.identity.push(self.next_identity);
            self.next_identity += 1;
        }
    }

    fn end_turn(&mut self) {
        let after = if core::mem::take(&mut self.is_leap) { 0 } else { self.frames };
        self.frames = (after + 1) % BALANCE_EVERY;
    }

    /// Whether the surface is surveyed in the next frame.
    pub(crate) fn is_due(&self) -> bool {
        self.frames == 0 || self.is_leap
    }

    /// The turn of the next frame, counted from the last balance.
    pub(crate) fn turn(&self) -> u32 {
        self.frames
    }

    /// Whether the particles are balanced in the next frame.
    pub(crate) fn is_last(&self) -> bool {
        self.frames == BALANCE_EVERY - 1 || self.is_leap
    }

    /// Whether the particles should have been balanced in this frame, and can be now that their
    /// neighbours are known.
    pub(crate) fn is_late(&self) -> bool {
        self.is_last() && !self.are_listed && !self.is_closed
    }

    /// Removes the particles that the transport has lost, and balances the others if that is due.
    /// `pairs` are the neighbours of the particles before the transport; in the first frame without
    /// a mesh there are none, and there is no balance.
    pub(crate) fn settle(
        &mut self,
        probe: &mut Probe,
        surface: &FlowSurface,
        lost: &[u32],
        pairs: &PackedNeighbours,
        particles: &mut Particles,
    ) -> Settled {
        let n = particles.len();
        refill(&mut self.columns.is_dead, n, false);
        lost.iter().for_each(|&i| self.columns.is_dead[i as usize] = true);
        let mut steps = 1;
        if self.are_listed {
            if !self.is_closed && lost.len() < n {
                self.balance(probe, surface, pairs, particles);
            }
            if self.is_last() {
                steps = STEPS_AFTER_BALANCE;
            }
            self.end_turn();
        }
        let is_dead = &self.columns.is_dead;
        let has_changed = particles.len() > n || is_dead.contains(&true);
        Settled { rows: has_changed.then(|| particles.keep(|i| !is_dead[i])), steps }
    }

    /// Places seeds after a survey, and lets particles die and be born, if due.
    fn balance(
        &mut self,
        probe: &mut Probe,
        surface: &FlowSurface,
        pairs: &PackedNeighbours,
        particles: &mut Particles,
    ) {
        if !self.is_due() && !self.is_last() {
            return;
        }
        self.fill_grids(particles);
        self.open.clear();
        let mut sparse = Vec::new();
        if self.is_last() || self.usual_energy.is_none() {
            self.find_energies(particles, pairs);
            let usual = self.find_growth(surface);
            if self.is_last() {
                self.find_open_sectors(particles, usual);
                sparse = self.find_extrema(particles, usual);
            }
        }
        if self.is_due() {
            self.is_seeded = true;
            self.add_seeds(probe, surface, particles);
        }
        let mut next = 0;
        while let Some(&parent) = self.open.get(next) {
            next += 1;
            self.march(probe, surface, particles, parent as usize);
        }
        for sparse in sparse {
            self.fill_gap(probe, surface, particles, &sparse);
        }
    }

    fn fill_grids(&mut self, particles: &Particles) {
        let radii = RadiusRange::among(&particles.radius);
        self.grids.reset(radii, |radius| GAUSSIAN_RANGE * radius);
        self.columns.handle.clear();
        for i in 0..particles.len() {
            let handle = self.grids.insert(particles.local[i], particles.radius[i], i as u32);
            self.columns.handle.push(handle);
            if self.columns.is_dead[i] {
                self.grids.remove(handle);
            }
        }
    }

    /// Lets a particle die, and updates the neighbours that have been found for it.
    fn kill(&mut self, particles: &Particles, i: usize) {
        self.columns.is_dead[i] = true;
        self.grids.remove(self.columns.handle[i]);
        for near in &self.found {
            let j = near.index as usize;
            self.columns.energy[j] -= energy_of(near.distance_sq, particles.radius[i] + particles.radius[j]);
        }
    }

    /// Whether a particle whose neighbours have been found crowds an older one.
    fn is_crowded(&self, particles: &Particles, i: usize) -> bool {
        self.found.iter().any(|near| {
            let j = near.index as usize;
            let crowd = CROWDED * (particles.radius[i] + particles.radius[j]);
            j < i && near.distance_sq < crowd * crowd
        })
    }

    /// Finds the particles on the sheet of a point of the surface that are nearer than `share`
    /// times the sum of the radii.
    fn gather(&mut self, particles: &Particles, point: OrientedPoint, radius: f32, share: f32) {
        self.grids.gather(point.position, |largest| share * (radius + largest), &mut self.found);
        self.found.retain(|near| {
            let j = near.index as usize;
            let sum = radius + particles.radius[j];
            let pair = point.pair(near.offset, particles.normal[j]);
            near.distance_sq <= (share * sum) * (share * sum) && is_level(pair, near.distance_sq, sum)
        });
    }

    /// Finds the particles of the same sheet within the range of the repulsion of a particle.
    fn gather_neighbours(&mut self, particles: &Particles, i: usize) {
        let own = OrientedPoint::of(particles, i);
        self.gather(particles, own, particles.radius[i], 0.5 * GAUSSIAN_RANGE);
        self.found.retain(|near| near.index as usize != i);
    }

    /// Finds the energy of every particle. The younger one of two that crowd each other dies.
    fn find_energies(&mut self, particles: &Particles, pairs: &PackedNeighbours) {
        refill(&mut self.columns.energy, particles.len(), 0.0);
        self.crowded.clear();
        for i in 0..pairs.len() {
            pairs.near(i).for_each(|j| self.add_energy(particles, i, j));
        }
        pairs.far().iter().for_each(|&[i, j]| self.add_energy(particles, i as usize, j as usize));
        for k in 0..self.crowded.len() {
            let i = self.crowded[k] as usize;
            if !self.columns.is_dead[i] {
                self.gather_neighbours(particles, i);
                // The other one may have died.
                if self.is_crowded(particles, i) {
                    self.kill(particles, i);
                }
            }
        }
    }

    /// Finds the particles with an open sector among those with too little energy, and adds what
    /// the missing neighbours would contribute.
    fn find_open_sectors(&mut self, particles: &Particles, usual: f32) {
        refill(&mut self.columns.is_open, particles.len(), false);
        for i in 0..particles.len() {
            if self.columns.is_dead[i] || self.columns.energy[i] > LEAST_ENERGY * usual {
                continue;
            }
            self.gather_neighbours(particles, i);
            self.look_around(particles, i);
            if let Some(sector) = widest_sector(&self.around) {
                self.open.push(i as u32);
                self.columns.is_open[i] = true;
                self.columns.energy[i] *= TAU / (TAU + FRAC_PI_3 - sector.width);
            }
        }
    }

    /// Adds the energy of two particles, if they are neighbours.
    fn add_energy(&mut self, particles: &Particles, i: usize, j: usize) {
        let offset = particles.local[j] - particles.local[i];
        let (sum, distance_sq) = (particles.radius[i] + particles.radius[j], offset.length_squared());
        let reach = 0.5 * GAUSSIAN_RANGE * sum;
        let pair = OrientedPoint::of(particles, i).pair(offset, particles.normal[j]);
        let BalanceColumns { energy, is_dead, .. } = &mut self.columns;
        if distance_sq <= reach * reach && !is_dead[i] && !is_dead[j] && is_level(pair, distance_sq, sum) {
            let more = energy_of(distance_sq, sum);
            energy[i] += more;
            energy[j] += more;
            if distance_sq < (CROWDED * sum) * (CROWDED * sum) {
                self.crowded.push(i.max(j) as u32);
            }
        }
    }

    /// Sorts the neighbours found around particle `i` by their directions.
    fn look_around(&mut self, particles: &Particles, i: usize) {
        let (u, w) = tangent_frame(particles.normal[i]);
        self.around.clear();
        self.around.extend(self.found.iter().map(|near| Bearing {
            angle: direction_angle(near.offset.dot(u), near.offset.dot(w)),
            distance: near.distance_sq.sqrt() / (particles.radius[i] + particles.radius[near.index as usize]),
            index: near.index,
        }));
        sort_few(&mut self.around, |a, b| (a.angle, a.index) < (b.angle, b.index));
    }

    /// Compares the mean energy with the mean at the end of the run, and returns the latter.
    fn find_growth(&mut self, surface: &FlowSurface) -> f32 {
        let BalanceColumns { energy, is_dead, .. } = &self.columns;
        let living = energy.iter().zip(is_dead).filter(|(_, is_dead)| !**is_dead);
        let (sum, n) = living.fold((0.0, 0.0), |(sum, n), (&energy, _)| (sum + f64::from(energy), n + 1.0));
        let mean = sum / n;
        let usual = *self.usual_energy.get_or_insert(mean as f32);
        // The energy of a pair in a lattice that has grown by g is exp(−2 g²), less that at the end
        // of the range.
        let pair = LATTICE_PAIR * mean / f64::from(usual);
        let grown_sq = -0.5 * libm::log(pair + f64::from(END_ENERGY));
        let more = surface.count.map_or(1.0, |count| (n / f64::from(count)).sqrt());
        let growth = grown_sq.max(0.0).sqrt() * more;
        // The energy of a few particles without neighbours says nothing.
        self.growth = if growth.is_finite() { growth.clamp(0.9, 1.1) } else { 1.0 };
        usual
    }

    /// Lets each particle die whose energy is too large and exceeds its neighbours'.
    /// Returns those with too little energy.
    fn find_extrema(&mut self, particles: &Particles, usual: f32) -> Vec<Sparse> {
        let mut sparse = Vec::new();
        for i in 0..particles.len() {
            let BalanceColumns { energy, is_open, is_dead, .. } = &self.columns;
            let share = energy[i] / usual;
            // An open sector gets children of its own.
            let (is_low, is_high) = (share < LEAST_ENERGY && !is_open[i], share > MOST_ENERGY);
            if is_dead[i] || !(is_low || is_high) {
                continue;
            }
            self.gather_neighbours(particles, i);
            let sign = if is_low { -1.0 } else { 1.0 };
            let rank = |j: usize| (sign * self.columns.energy[j], j);
            let is_extreme = self.found.iter().all(|near| rank(near.index as usize) < rank(i));
            if is_high && is_extreme {
                self.kill(particles, i);
            } else if is_low && (is_extreme || share < SPARSE_ENERGY) {
                sparse.push(Sparse { parent: i, least: if is_extreme { GAP } else { WIDE_GAP } });
            }
        }
        sparse
    }

    /// Adds a seed at every point of the survey that no particle of its sheet is near.
    fn add_seeds(&mut self, probe: &mut Probe, surface: &FlowSurface, particles: &mut Particles) {
        let survey = surface.survey;
        for (&position, &normal) in survey.position.iter().zip(&survey.normal) {
            let is_covered = self.is_covered(particles, position, normal);
            if !is_covered && particles.len() < surface.max_particles {
                self.add(probe, surface, particles, OrientedPoint { position, normal }, None);
            }
        }
    }

    /// Whether a particle of its sheet is near a point of the surface.
    fn is_covered(&mut self, particles: &Particles, position: Vec3, normal: Vec3) -> bool {
        self.grids.gather(position, |largest| UNCOVERED * largest, &mut self.found);
        self.found.iter().any(|near| is_cover(particles, near, normal))
    }

    /// Places children in the open sectors of a particle.
    fn march(&mut self, probe: &mut Probe, surface: &FlowSurface, particles: &mut Particles, parent: usize) {
        if self.columns.is_dead[parent] {
            return;
        }
        let (u, w) = tangent_frame(particles.normal[parent]);
        self.gather_neighbours(particles, parent);
        self.look_around(particles, parent);
        while let Some(sector) = widest_sector(&self.around) {
            let turn = if sector.width < NARROW_SECTOR { 0.5 * sector.width } else { FRAC_PI_3 };
            let angle = (sector.from + turn) % TAU;
            let direction = u * cos(angle) + w * sin(angle);
            let circle = circle_around(particles, parent, direction, 1.0);
            self.try_child(probe, surface, particles, parent, &circle, CLEAR);
            // A direction without room for a child counts as taken, too.
            let at = self.around.partition_point(|other| other.angle < angle);
            self.around.insert(at, Bearing { angle, distance: 1.0, index: parent as u32 });
        }
    }

    /// Places a child in the widest gap next to a particle.
    fn fill_gap(
        &mut self,
        probe: &mut Probe,
        surface: &FlowSurface,
        particles: &mut Particles,
        &Sparse { parent, least }: &Sparse,
    ) {
        if self.columns.is_dead[parent] {
            return;
        }
        self.gather_neighbours(particles, parent);
        self.look_around(particles, parent);
        let plane: Vec<Vec2> = self
            .around
            .iter()
            .map(|near| Vec2::new(cos(near.angle), sin(near.angle)) * near.distance)
            .collect();
        let Some(centre) = widest_gap(&plane, least) else { return };
        let width = centre.length();
        let (u, w) = tangent_frame(particles.normal[parent]);
        let direction = (u * centre.x + w * centre.y) / width;
        let circle = circle_around(particles, parent, direction, width);
        self.try_child(probe, surface, particles, parent, &circle, least);
    }

    /// Places a child where a circle meets the surface, if it is in the box, on the sheet of its
    /// parent, and farther from all others than `clear` times the sum of the radii.
    fn try_child(
        &mut self,
        probe: &mut Probe,
        surface: &FlowSurface,
        particles: &mut Particles,
        parent: usize,
        circle: &ChildCircle,
        clear: f32,
    ) {
        let FlowSurface { survey, rule, .. } = *surface;
        let (own, radius) = (OrientedPoint::of(particles, parent), particles.radius[parent]);
        let limits = tolerance(radius, survey.residual_limits(), survey.gradient_scale);
        probe.land_on_circles(&[*circle], limits, &mut self.landing);
        let CircleLanding::On { position, normal } = self.landing[0] else { return };
        let pair = own.pair(position - own.position, normal);
        let is_own = rule.is_own(probe, own.position, pair, circle.radius);
        if !is_own || !surface.bounds.contains(position) || particles.len() >= surface.max_particles {
            return;
        }
        let point = OrientedPoint { position, normal };
        self.gather(particles, point, radius, clear);
        if self.found.is_empty() {
            self.add(probe, surface, particles, point, Some(parent));
        }
    }

    /// Adds a particle, a seed unless it has a parent; its own sectors get their turn later.
    fn add(
        &mut self,
        probe: &mut Probe,
        surface: &FlowSurface,
        particles: &mut Particles,
        OrientedPoint { position, normal }: OrientedPoint,
        parent: Option<usize>,
    ) {
        let row = particles.len() as u32;
        let radius = surface.sizing.map_or(surface.radius, |sizing| sizing.radius_at(probe.field, position));
        let mut slots = Slots::default();
        let (mut level, mut of) = (0, Particles::NO_PARENT);
        if let Some(parent) = parent {
            slots.set(0, SlotFate::Parent);
            (level, of) = (particles.level[parent] + 1, parent as u32);
        }
        particles.push(position, normal, radius, of, level, slots);
        self.columns.handle.push(self.grids.insert(position, radius, row));
        self.columns.is_dead.push(false);
        self.number(particles);
        self.open.push(row);
    }
}

/// The energy of two particles at a distance, with this sum of their radii.
fn energy_of(distance_sq: f32, sum: f32) -> f32 {
    pair_energy(4.0 * distance_sq / (sum * sum))
}

/// The circle on which a child of a particle is placed in a direction. Its radius is `share` times
/// that of the circle of a front.
fn circle_around(particles: &Particles, parent: usize, direction: Vec3, share: f32) -> ChildCircle {
    let OrientedPoint { position, normal } = OrientedPoint::of(particles, parent);
    let radius = 2.0 * particles.radius[parent] * share;
    ChildCircle { centre: position, normal, direction, radius, guess: [1.0, 0.0] }
}

/// A sector without a neighbour: the angle at which it begins, and how wide it is.
struct Sector {
    from: f32,
    width: f32,
}

/// Returns the widest sector between neighbours in the order of their angles, if it is open.
fn widest_sector(around: &[Bearing]) -> Option<Sector> {
    let Some(last) = around.last() else { return Some(Sector { from: 0.0, width: TAU }) };
    let mut widest = Sector { from: last.angle, width: around[0].angle + TAU - last.angle };
    for pair in around.windows(2) {
        let width = pair[1].angle - pair[0].angle;
        if width > widest.width {
            widest = Sector { from: pair[0].angle, width };
        }
    }
    (widest.width > OPEN_SECTOR).then_some(widest)
}

/// The angle of a direction, from 0 to 2π.
fn direction_angle(x: f32, y: f32) -> f32 {
    let angle = atan2(y, x);
    if angle < 0.0 { angle + TAU } else { angle }
}

/// Whether the step to a field's surface is a leap: whether some particles are farther from it than
/// they can be transported.
///
/// # Errors
///
/// If there are too many such particles.
pub(crate) fn is_leap(
    field: &mut dyn Evaluator,
    particles: &Particles,
    length: f64,
) -> Result<bool, FollowError> {
    let mut is_near = |i: usize| {
        let (value, gradient) = field.value_and_gradient(particles.local[i].as_dvec3());
        let reach = f64::from(TRANSPORT_REACH * particles.radius[i]);
        value.abs() <= reach * gradient.length()
    };
    let looked_at = (0..particles.len()).step_by(particles.len().div_ceil(SAMPLES));
    let looks = looked_at.len() as f64;
    let far: Vec<usize> = looked_at.filter(|&i| !is_near(i)).collect();
    let share = far.len() as f64 / looks;
    match far.first() {
        Some(&first) if share > MOST_FAR => {
            Err(FollowError::TooFar { share, position: particles.place(first).to_array(), length })
        }
        _ => Ok(share > LEAP),
    }
}
