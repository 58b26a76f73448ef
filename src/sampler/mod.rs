//! The sampler: a state machine that covers a surface with particles and relaxes them.
//!
//! [`Sampler::start`] surveys the field and fixes the radius; [`Sampler::step`] then does a given number of units of
//! work and returns, as often as the caller likes. A budget is a count, never a time, and how a run is cut into steps
//! does not change its result by a bit. Nothing is allocated inside a step but the growth of the columns.

pub(crate) mod discovery;
mod fates;
mod front;
mod message;
pub(crate) mod neighbours;
mod phase;
pub(crate) mod projection;
pub(crate) mod relaxation;
mod settings;
pub(crate) mod sizing;

pub use discovery::completeness::Search;
pub use fates::FateCounts;
pub use phase::{Phase, StopReason};
pub use settings::{GapPolicy, LawKind, Placement, Sampling, Settings, SettingsError, SizeMode};
pub use sizing::{ChordError, MaxCurvature, SumOfCurvatures};

use crate::field::Field;
use crate::field::scaled::{Scaled, comfortable_factor, spread};
use crate::math::{Bounds, SQRT_3};
use crate::particles::Particles;
use crate::trace::Trace;
use discovery::seeds::{Place, Seeds};
use discovery::survey::{Absence, Survey, survey};
use front::Front;
use front::adaptive::Surface;
use glam::Vec3;
use neighbours::packed::PackedNeighbours;
use projection::{Projector, Tolerance, tolerance};
use rand_core::{Rng, SeedableRng};
use relaxation::Relaxation;
use serde::Serialize;
use sizing::Sizing;

/// Particles that a front places per hexagonal cell 2√3 r², as a first guess: rows squeezed by positive curvature make
/// it more than one, seams less. Measured on sphere, ellipsoid, torus and tanglecube: 1.02 to 1.12.
const PACKING: f64 = 1.08;

/// The same for the adaptive front, whose arcs bend with the surface: 1.00 to 1.05 on the same surfaces.
const ADAPTIVE_PACKING: f64 = 1.02;

/// A wanted count above this is approached through a pilot run with [`PILOT_SHARE`] of it, which shows the packing.
const PILOT_FROM: f64 = 8_000.0;
/// Size of a pilot run as a share of the wanted count.
const PILOT_SHARE: f64 = 1.0 / 20.0;

/// Room made in advance, as a multiple of the expected count.
const RESERVE: f64 = 1.05;

/// A wanted count counts as met within this share.
pub(crate) const COUNT_TOLERANCE: f64 = 0.03;

/// Attempts at meeting a wanted count.
const MAX_ATTEMPTS: u32 = 4;

/// Attempts at a wanted count may overshoot it by this factor before they run into the limit on particles.
const COUNT_ROOM: f64 = 1.1;

/// Bytes to ask for per particle before a run: its columns, neighbour lists and grid, and most of what the relaxation adds,
/// but no more than the peak that tests/memory.rs holds it to.
const BYTES_PER_PARTICLE: usize = 95;

/// Most units of the search for first points in one step, however large its budget: a unit takes far longer there on some
/// formulas than elsewhere, and a caller that has learnt its pace elsewhere must not be kept waiting.
const SEARCH_SLICE: u32 = 8_192;
/// The same of the relaxation, whose stages differ tenfold in the time of a unit.
const RELAXATION_SLICE: u32 = 16_384;

/// What [`Sampler::start`] found out.
#[derive(Clone, Debug, Serialize)]
pub struct Start {
    /// Repulsion radius of the run.
    pub radius: f64,
    /// Particles to expect.
    pub predicted_count: u64,
    /// Estimated area of the surface in the box.
    pub area: f64,
    /// Things the user should know, in words.
    pub warnings: Vec<String>,
}

/// State after a step.
#[derive(Clone, Debug, Serialize)]
pub struct Progress {
    /// Current phase.
    pub phase: Phase,
    /// Particles in the columns that will stay.
    pub particles: usize,
    /// Generation level under way.
    pub level: u32,
    /// Relaxation steps done.
    pub relax_step: u32,
    /// Relaxation steps asked for.
    pub relax_steps: u32,
    /// Field evaluations so far, all phases.
    pub evaluations: u64,
    /// Estimated share of the work done.
    pub fraction: f64,
    /// Set once the run has ended.
    pub stop_reason: Option<StopReason>,
    /// A sentence for the user where the reason needs one.
    pub message: Option<String>,
    /// Repulsion radius.
    pub radius: f64,
    /// Whether particles that were there before this step have moved or gone.
    pub moved: bool,
}

/// Evaluations by phase, and what became of the children.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Counts {
    /// Evaluations of the survey.
    pub seeding_evaluations: u64,
    /// Evaluations of the fronts, all attempts at a wanted count.
    pub generation_evaluations: u64,
    /// Evaluations of the fronts of the last attempt, which placed the particles.
    pub front_evaluations: u64,
    /// Evaluations of the relaxation.
    pub relaxation_evaluations: u64,
    /// Fates of the children of the last attempt.
    pub fates: FateCounts,
    /// Particles placed in gaps between fronts.
    pub gaps_filled: u64,
    /// Fronts started, each from a seed of its own.
    pub seeds: u32,
    /// Seeds that stayed alone beside other particles and were taken back.
    pub left_out: u32,
}

/// Samples one surface at a time.
#[derive(Clone)]
pub struct Sampler {
    settings: Settings,
    bounds: Bounds,
    /// What the field is multiplied by, so that its gradient can be squared.
    factor: f32,
    radius: f64,
    tolerance: Tolerance,
    phase: Phase,
    stop_reason: Option<StopReason>,
    survey: Survey,
    /// First points that the survey may have missed.
    seeds: Seeds,
    /// Next survey point to check for cover.
    next_seed: usize,
    /// Survey points in the order in which they are tried: this one first, the others in grid order.
    first_seed: usize,
    attempt: u32,
    /// Particles per hexagonal cell 2√3 r²: a guess, then what the attempts have shown.
    packing: f64,
    /// Whether the attempt under way only measures the packing.
    pilot: bool,
    projector: Projector,
    front: Front,
    /// The radius field of an adaptive run.
    sizing: Option<Sizing>,
    relaxation: Relaxation,
    pairs: PackedNeighbours,
    particles: Particles,
    counts: Counts,
    moved: bool,
    /// Whether the particles next to singular points are still to be marked.
    is_unmarked: bool,
    /// Most bytes that a run may need.
    memory_limit: usize,
}

impl Default for Sampler {
    fn default() -> Self {
        Self::new()
    }
}

impl Sampler {
    /// A sampler with nothing to do.
    #[must_use]
    pub fn new() -> Self {
        Self {
            settings: Settings::default(),
            bounds: Bounds::cube(1.0),
            factor: 1.0,
            radius: 1.0,
            tolerance: Tolerance::default(),
            phase: Phase::Idle,
            stop_reason: None,
            survey: Survey::default(),
            seeds: Seeds::default(),
            next_seed: 0,
            first_seed: 0,
            attempt: 0,
            packing: PACKING,
            pilot: false,
            projector: Projector::new(),
            front: Front::new(),
            sizing: None,
            relaxation: Relaxation::new(),
            pairs: PackedNeighbours::default(),
            particles: Particles::default(),
            counts: Counts::default(),
            moved: false,
            is_unmarked: false,
            memory_limit: usize::MAX,
        }
    }

    /// The particles so far. Those of a level under way may be provisional: [`Progress::particles`] says how many stay.
    #[must_use]
    pub fn particles(&self) -> &Particles {
        &self.particles
    }

    /// Counts of the run so far.
    #[must_use]
    pub fn counts(&self) -> Counts {
        Counts { fates: self.front.fates(), gaps_filled: self.front.filled(), ..self.counts.clone() }
    }

    /// Energy per particle before the first relaxation step and after each. Of uniform sampling it is Σ s (exp(−d²/2σ²) −
    /// exp(−9/2)) over the pairs nearer than 3σ, where s goes from 1 for pairs whose normals are within 60° to 0 for those
    /// beyond 120°: ½ + cosine in between.
    #[must_use]
    pub fn energy(&self) -> &[f64] {
        &self.relaxation.energy
    }

    /// Has the adaptive front of the next run keep a log of what happens at the particle with this index, or none.
    pub fn follow(&mut self, particle: Option<u32>) {
        self.front.follow(particle);
    }

    /// What happened at the particle that is followed.
    #[must_use]
    pub fn trace(&self) -> &Trace {
        self.front.trace()
    }

    /// Repulsion radius r of the run.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Whether every connected piece is proven to have been found.
    #[must_use]
    pub fn search(&self) -> Search {
        self.seeds.verdict()
    }

    /// Cells of the box in which the proof could not decide whether a piece of its own begins there; `None` where no proof
    /// was attempted.
    #[must_use]
    pub fn undecided_cells(&self) -> Option<u64> {
        self.seeds.open_cells()
    }

    /// Places where f has no gradient on the surface, a curve of them counted as one; `None` where they were not looked for.
    #[must_use]
    pub fn singular_points(&self) -> Option<u64> {
        self.seeds.open_cells().map(|_| discovery::singular::places(self.seeds.singular()))
    }

    /// The settings of the run.
    #[must_use]
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Starts a run: surveys the field (about 40,000 evaluations, 80,000 where a field has no bounds to prove by) and fixes
    /// the radius. Particles of an earlier run are dropped.
    ///
    /// # Errors
    ///
    /// If a setting or the box is invalid; an earlier run is then left as it is. If there is no memory for the particles
    /// to expect; there is no run then.
    pub fn start(
        &mut self,
        field: &mut dyn Field,
        bounds: &Bounds,
        settings: &Settings,
    ) -> Result<Start, SettingsError> {
        self.begin(field, bounds, settings, false)
    }

    /// [`Sampler::start`] on the field and the box of the last start, without surveying them again.
    ///
    /// # Errors
    ///
    /// Those of [`Sampler::start`].
    pub fn start_again(
        &mut self,
        field: &mut dyn Field,
        settings: &Settings,
    ) -> Result<Start, SettingsError> {
        let bounds = self.bounds;
        // A survey that has found nothing by itself is made again: what it was given since depends on the run.
        let is_known = self.survey.area > 0.0 && !self.survey.is_adopted;
        self.begin(field, &bounds, settings, is_known)
    }

    fn begin(
        &mut self,
        field: &mut dyn Field,
        bounds: &Bounds,
        settings: &Settings,
        is_known: bool,
    ) -> Result<Start, SettingsError> {
        settings.validate()?;
        if !bounds.is_valid() {
            return Err(SettingsError::Box);
        }
        self.settings = *settings;
        self.bounds = *bounds;
        self.particles.clear();
        self.relaxation.clear();
        self.counts = Counts::default();
        self.projector.evaluations = 0;
        self.stop_reason = None;
        self.attempt = 0;
        self.pilot = false;
        self.seeds.begin(field, bounds);
        self.seeds.expect(0.0);
        if !is_known {
            self.factor = comfortable_factor(field, spread(bounds));
            let is_dense = !field.has_bounds();
            let field_in_units = &mut Scaled::new(field, self.factor);
            self.survey = survey(field_in_units, bounds, is_dense, &mut self.projector);
        }
        if self.survey.area == 0.0 {
            self.search_all(field);
        }
        self.counts.seeding_evaluations = self.projector.evaluations;

        self.sizing = None;
        self.packing = PACKING;
        if settings.sampling == Sampling::Adaptive {
            let mut field = Scaled::new(field, self.factor);
            let evaluations = &mut self.counts.seeding_evaluations;
            self.sizing = Some(Sizing::new(&mut field, bounds, settings, &self.survey, evaluations));
            self.packing = ADAPTIVE_PACKING;
        }

        let area = self.survey.area;
        // Hexagonal packing: each particle takes 2√3 r².
        let per_radius_sq = area * self.packing / (2.0 * SQRT_3);
        self.radius = match settings.size_mode {
            SizeMode::Radius => settings.radius_share * bounds.diagonal(),
            SizeMode::Count => {
                let wanted = f64::from(settings.count);
                self.pilot = wanted > PILOT_FROM;
                let first = if self.pilot { (wanted * PILOT_SHARE).max(1_500.0) } else { wanted };
                let radius = (per_radius_sq / first).sqrt();
                if radius > 0.0 { radius } else { settings.radius_share * bounds.diagonal() }
            }
        };
        if let Some(sizing) = &mut self.sizing {
            if settings.size_mode == SizeMode::Count {
                sizing.scale_to(per_radius_sq / (self.radius * self.radius) / self.packing);
            }
            self.radius = typical_radius(&self.survey, sizing, self.radius);
        }
        let predicted = match settings.size_mode {
            SizeMode::Radius => (per_radius_sq / (self.radius * self.radius)).round(),
            SizeMode::Count => f64::from(settings.count),
        };
        self.seeds.expect(predicted.min(f64::from(settings.max_particles)));
        let mut warnings = Vec::new();
        if predicted > f64::from(settings.max_particles) {
            warnings.push(format!(
                "about {} particles would fit, more than the limit of {}; the run will stop there.",
                predicted as u64, settings.max_particles
            ));
        }
        if self.survey.touches {
            warnings.push(
                "f touches zero without changing its sign: both sides of the surface are sampled, which covers it twice. \
                 If f is a square, enter what is squared instead."
                    .into(),
            );
        }
        if settings.size_mode == SizeMode::Count && settings.count <= settings.max_particles {
            let room = (f64::from(settings.count) * COUNT_ROOM) as u32;
            self.settings.max_particles = settings.max_particles.max(room);
        }
        let most = (predicted * RESERVE).min(f64::from(self.settings.max_particles)) as usize;
        if !self.has_room_for(most) {
            self.phase = Phase::Idle;
            return Err(SettingsError::Memory { particles: predicted as u64 });
        }
        self.begin_attempt();
        Ok(Start { radius: self.radius, predicted_count: predicted as u64, area, warnings })
    }

    /// Refuses runs that need more than about `bytes` from now on.
    pub fn limit_memory(&mut self, bytes: usize) {
        self.memory_limit = bytes;
    }

    /// Finishes the search for first points at once, where the survey has found none: the area is that of spheres with the
    /// curvature at those points.
    #[inline(never)]
    fn search_all(&mut self, field: &mut dyn Field) {
        let field = &mut Scaled::new(field, self.factor);
        let tolerance = self.survey.tolerance();
        while self.seeds.search(field, &mut self.projector, &self.bounds, tolerance, u32::MAX) == 0 {}
        let found = self.seeds.points().iter().map(|seed| (seed.position, seed.normal));
        self.survey.adopt(field, found, &self.bounds, self.seeds.verdict());
    }

    /// Whether the memory holds a run of `particles`: asked for as one piece and given back, since what fails in the midst
    /// of a run cannot be caught.
    fn has_room_for(&self, particles: usize) -> bool {
        let bytes = |particles: usize| particles.checked_mul(BYTES_PER_PARTICLE);
        let more = particles.saturating_sub(self.particles.position.capacity());
        bytes(particles).is_some_and(|all| all <= self.memory_limit)
            && bytes(more).is_some_and(|more| Vec::<u8>::new().try_reserve_exact(more).is_ok())
    }

    /// Empties the columns and prepares a front of the present radius.
    fn begin_attempt(&mut self) {
        self.moved = true;
        self.is_unmarked = false;
        self.particles.clear();
        self.pairs.clear();
        // Growing by doubling would hold twice the columns, and four times while they are copied.
        let expected = (self.expected_count() * RESERVE).min(f64::from(self.settings.max_particles)) as usize;
        self.particles.reserve(expected);
        self.pairs.reserve(expected);
        self.tolerance = tolerance(self.radius as f32, self.survey.resolution, self.survey.gradient_scale);
        let radii = match &self.sizing {
            Some(sizing) => [sizing.smallest(), sizing.largest()],
            None => [self.radius as f32; 2],
        };
        self.front.reset(&self.settings, (self.radius as f32, radii), &self.survey, &self.bounds, expected);
        self.counts.seeds = 0;
        self.counts.left_out = 0;
        self.counts.front_evaluations = 0;
        self.next_seed = 0;
        self.seeds.restart();
        let candidates = self.survey.position.len() as u64;
        self.phase = Phase::Seeding;
        self.first_seed = if candidates == 0 {
            0
        } else {
            (rand_pcg::Pcg32::seed_from_u64(self.settings.seed).next_u64() % candidates) as usize
        };
    }

    /// Particles that a front of the present radius is expected to place.
    fn expected_count(&self) -> f64 {
        self.survey.area * self.packing / (2.0 * SQRT_3 * self.radius * self.radius)
    }

    /// Asks for `steps` more relaxation steps on the particles of a finished run; [`Sampler::step`] does them.
    pub fn relax(&mut self, steps: u32) {
        if self.phase == Phase::Done && self.particles.len() > 1 {
            self.settings.relax_steps = self.relaxation.steps_done() + steps;
            self.stop_reason = None;
            self.phase = Phase::Relaxation;
            self.begin_relaxation();
        }
    }

    /// Ends the run where it is; the particles placed so far stay. The next step, of no budget even, marks those next to singular
    /// points.
    pub fn cancel(&mut self) {
        if !matches!(self.phase, Phase::Idle | Phase::Done) {
            if self.phase == Phase::Relaxation {
                self.moved |= self.relaxation.abandon(&mut self.particles);
            }
            if self.phase != Phase::Relaxation {
                self.front.stop(&mut self.particles);
            }
            self.finish(StopReason::Cancelled);
        }
    }

    /// Does up to `budget` units of work: a particle's slots, a child's projection, a particle's share of a
    /// relaxation step. Returns early where a search begins and where the relaxation does, so that the particles of the front
    /// can be seen, and now and then within both.
    pub fn step(&mut self, field: &mut dyn Field, budget: u32) -> Progress {
        let field = &mut Scaled::new(field, self.factor);
        let mut left = budget;
        let before = self.projector.evaluations;
        let first = self.phase;
        while left > 0 && (self.phase == first || !self.is_turning()) {
            match self.phase {
                Phase::Idle | Phase::Done => break,
                Phase::Seeding => left = self.seed(field, left),
                Phase::Search => left = self.look_for_pieces(field, left),
                Phase::Generation => {
                    let start = self.projector.evaluations;
                    let mut surface = Surface {
                        field,
                        projector: &mut self.projector,
                        sizing: self.sizing.as_ref(),
                        pairs: &mut self.pairs,
                        particles: &mut self.particles,
                    };
                    left = self.front.step(&mut surface, left);
                    self.counts.generation_evaluations += self.projector.evaluations - start;
                    self.counts.front_evaluations += self.projector.evaluations - start;
                    if !self.front.is_done() {
                    } else if self.front.is_filling() {
                        if !self.front.fill() {
                            self.end_generation();
                        }
                    } else {
                        let placed = self.particles.len();
                        self.front.drop_lone_seed(&mut self.pairs, &mut self.particles);
                        self.counts.left_out += u32::from(self.particles.len() < placed);
                        self.phase = if self.front.capped() { Phase::Search } else { Phase::Seeding };
                    }
                }
                Phase::Relaxation => {
                    let start = self.projector.evaluations;
                    let mut surface = relaxation::SurfaceContext {
                        field: &mut *field,
                        projector: &mut self.projector,
                        sizing: self.sizing.as_ref(),
                    };
                    let slice = left.min(RELAXATION_SLICE);
                    self.moved |=
                        self.relaxation.step(&mut surface, &mut self.pairs, &mut self.particles, slice);
                    left = 0;
                    self.counts.relaxation_evaluations += self.projector.evaluations - start;
                    if self.relaxation.is_done() {
                        let reason = if self.front.capped() { StopReason::Cap } else { StopReason::Complete };
                        self.finish(reason);
                    }
                }
            }
        }
        if self.phase == Phase::Done && core::mem::take(&mut self.is_unmarked) {
            discovery::singular::mark(field, self.seeds.singular(), &mut self.particles);
            self.moved = true;
        }
        debug_assert!(self.projector.evaluations >= before);
        self.progress()
    }

    /// Whether what comes next is the search or the relaxation.
    fn is_turning(&self) -> bool {
        match self.phase {
            Phase::Search => !self.seeds.is_searched(),
            phase => phase == Phase::Relaxation,
        }
    }

    /// The state as of now; the `moved` flag is cleared by reading it.
    pub fn progress(&mut self) -> Progress {
        let particles = match self.phase {
            Phase::Generation => self.front.settled(self.particles.len()),
            _ => self.particles.len(),
        };
        let expected = self.expected_count();
        let relax_steps = f64::from(self.settings.relax_steps);
        // A relaxation step costs about a quarter of the generation per particle.
        let generation = 1.0 / (1.0 + 0.25 * relax_steps);
        let fraction = match self.phase {
            Phase::Idle => 0.0,
            Phase::Seeding | Phase::Generation | Phase::Search => {
                generation * (particles as f64 / expected.max(1.0)).min(0.99)
            }
            Phase::Relaxation => {
                generation
                    + (1.0 - generation) * f64::from(self.relaxation.steps_done()) / relax_steps.max(1.0)
            }
            Phase::Done => 1.0,
        };
        Progress {
            phase: self.phase,
            particles,
            level: self.particles.level[..particles].last().copied().unwrap_or(0),
            relax_step: self.relaxation.steps_done(),
            relax_steps: self.settings.relax_steps,
            evaluations: self.projector.evaluations,
            fraction,
            stop_reason: self.stop_reason,
            message: self.message(),
            radius: self.radius,
            moved: core::mem::take(&mut self.moved),
        }
    }

    /// Looks for the next survey point that no particle covers and starts a front there.
    fn seed(&mut self, field: &mut dyn Field, mut budget: u32) -> u32 {
        let count = self.survey.position.len();
        while budget > 0 {
            if self.next_seed >= count {
                self.phase = Phase::Search;
                return budget;
            }
            budget -= 1;
            let i = match self.next_seed {
                0 => self.first_seed,
                k if k <= self.first_seed => k - 1,
                k => k,
            };
            self.next_seed += 1;
            let (position, normal) = (self.survey.position[i], self.survey.normal[i]);
            let start = self.projector.evaluations;
            let covered =
                self.front.is_covered(field, &mut self.projector, &self.particles, (position, normal));
            self.counts.seeding_evaluations += self.projector.evaluations - start;
            if !covered {
                let start = self.projector.evaluations;
                let is_zero = self.survey.is_zero(field, &mut self.projector, i);
                self.counts.seeding_evaluations += self.projector.evaluations - start;
                if !is_zero {
                    continue;
                }
                if self.begin_front(field, position, normal) {
                    return budget;
                }
            }
        }
        budget
    }

    /// Looks for the next witness that no particle covers and starts a front there; after the last, or where the limit on
    /// particles is reached, the generation is at its end.
    #[inline(never)]
    fn look_for_pieces(&mut self, field: &mut dyn Field, mut budget: u32) -> u32 {
        if self.front.capped() {
            self.end_generation();
            return budget;
        }
        let slice = budget.min(SEARCH_SLICE);
        let left = self.seeds.search(field, &mut self.projector, &self.bounds, self.tolerance, slice);
        if left == 0 {
            return 0;
        }
        budget -= slice - left;
        while budget > 0 {
            let (witness, left) = self.seeds.next(budget);
            budget = left;
            let Some(seed) = witness else {
                if self.settings.gaps == GapPolicy::Fill && self.front.fill() {
                    self.phase = Phase::Generation;
                } else {
                    self.end_generation();
                }
                return budget;
            };
            let mut near = self.seeds.take_near();
            self.front.near(&self.particles, seed.position, seed.normal, &mut near);
            let start = self.projector.evaluations;
            let place =
                self.seeds.place(field, &mut self.projector, &self.particles, seed, near, self.tolerance);
            self.counts.seeding_evaluations += self.projector.evaluations - start;
            if place == Place::Bare && self.begin_front(field, seed.position, seed.normal) {
                return budget;
            }
        }
        budget
    }

    /// Starts a front, unless the limit on particles is reached. Says whether the seeding stops here: an adaptive front cannot
    /// start where the surface has no radius.
    fn begin_front(&mut self, field: &mut dyn Field, position: Vec3, normal: Vec3) -> bool {
        if self.particles.len() >= self.settings.max_particles as usize {
            self.front.cap();
            self.phase = Phase::Search;
            return true;
        }
        let mut surface = Surface {
            field,
            projector: &mut self.projector,
            sizing: self.sizing.as_ref(),
            pairs: &mut self.pairs,
            particles: &mut self.particles,
        };
        let started = self.front.add_seed(&mut surface, position, normal);
        if started {
            self.counts.seeds += 1;
            self.phase = Phase::Generation;
        }
        started
    }

    /// Decides, once the surface is covered, whether the count is met, and goes on to the relaxation.
    #[inline(never)]
    fn end_generation(&mut self) {
        let count = self.particles.len();
        if count == 0 {
            let reason = match self.survey.absence {
                Absence::Constant => StopReason::Constant,
                Absence::Undefined => StopReason::Undefined,
                _ => StopReason::NoSurface,
            };
            return self.finish(reason);
        }
        let wanted = f64::from(self.settings.count);
        let miss = count as f64 / wanted;
        self.attempt += 1;
        if self.settings.size_mode == SizeMode::Count
            && (self.pilot || (miss - 1.0).abs() > COUNT_TOLERANCE)
            && self.attempt < MAX_ATTEMPTS
            && !self.front.capped()
        {
            self.packing *= count as f64 / self.expected_count();
            self.radius *= miss.sqrt();
            if let Some(sizing) = &mut self.sizing {
                sizing.scale(miss.sqrt());
                self.radius = typical_radius(&self.survey, sizing, self.radius);
            }
            self.pilot = false;
            return self.begin_attempt();
        }
        if self.front.fates().added == 0 && !self.front.capped() {
            self.finish(StopReason::OneParticle);
        } else if self.settings.relax_steps == 0 && self.settings.sampling == Sampling::Uniform {
            self.finish(if self.front.capped() { StopReason::Cap } else { StopReason::Complete });
        } else {
            self.phase = Phase::Relaxation;
            self.begin_relaxation();
        }
    }

    #[inline(never)]
    fn begin_relaxation(&mut self) {
        self.front.release();
        self.particles.shrink();
        self.pairs.shrink();
        let law = match self.settings.sampling {
            Sampling::Uniform => {
                relaxation::RepulsionLaw::Gaussian { radius: self.radius as f32, tolerance: self.tolerance }
            }
            Sampling::Adaptive => relaxation::RepulsionLaw::Overlap {
                resolution: self.survey.resolution,
                min_gradient: self.tolerance.min_gradient,
            },
        };
        self.relaxation.begin(
            law,
            &self.bounds,
            self.settings.relax_steps,
            self.particles.len(),
            &mut self.pairs,
        );
    }

    fn finish(&mut self, reason: StopReason) {
        self.stop_reason = Some(reason);
        self.phase = Phase::Done;
        self.is_unmarked = !self.seeds.singular().is_empty();
    }
}

/// The radius of which as many uniform particles would cover the surface as the `sizing` asks for; `other` where there is no
/// surface.
fn typical_radius(survey: &Survey, sizing: &Sizing, other: f64) -> f64 {
    let radius = (survey.area / (2.0 * SQRT_3 * sizing.predicted_count())).sqrt();
    if radius > 0.0 && radius.is_finite() { radius } else { other }
}
