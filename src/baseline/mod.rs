//! The methods that the paper compares its own with (§3 and §6, Table 1): particle systems that start from one particle
//! and cover the surface by fission and death.
//!
//! For particles of one size this is the system of Witkin and Heckbert (`witkin_heckbert`); for particles whose size
//! follows the curvature it is a scheme of forces (`forces`). An iteration of either (paper §3) computes forces and
//! energies, moves the particles, and lets them divide or die. A run ends when nothing happens any more, or after a
//! given number of iterations.
//!
//! The same methods written for reading are in `src/reference`, to which `tests/it/systems.rs` holds these.
//!
//! The implementations are meant to be strong opponents. Neighbours come from the grid of the front, so an iteration is
//! linear in the number of particles, and from lists that serve for several iterations once no particle divides or
//! dies. A particle takes one evaluation of the field in an iteration, in batches. The survey, the radius law, the
//! forces between discs and the projection onto the surface are those of the sampler. The module is not part of the
//! page.
//!
//! # Differs from the paper
//!
//! * The paper detects convergence by the number of particles and their residual motion and gives no numbers (§3). Here
//!   a run has settled after [`Settings::quiet_iterations`] consecutive iterations without fission and death and with a
//!   mean motion of at most [`Settings::rest`].
//! * At the end all particles are brought onto the surface within the tolerance of the sampler, and those that are far
//!   from it are dropped.

mod crowd;
mod forces;
mod settings;
mod witkin_heckbert;

pub use settings::Settings;

use crate::field::Field;
use crate::field::scaled::{Scaled, comfortable_scale, spread};
use crate::math::{Bounds, SQRT_3};
use crate::sampler::discovery::survey::{Survey, survey};
use crate::sampler::projection::{BATCH, Projector, tolerance};
use crate::sampler::relaxation::repulsion::TRUSTED_CORRECTION;
use crate::sampler::sizing::Sizing;
use crate::sampler::{Sampling, SettingsError, SizeMode};
use core::ops::Range;
use crowd::{Neighbourhood, Particle, tangent, uniform};
use forces::Forces;
use glam::Vec3;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use serde::Serialize;
use witkin_heckbert::WitkinHeckbert;

/// Why a baseline ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum StopReason {
    /// The particles have come to rest: no fission, no death, hardly any motion.
    Settled,
    /// The limit on iterations was reached; particles still move, divide or die.
    Iterations,
    /// The limit on particles was reached.
    Cap,
    /// The caller has stopped the run; its particles stay.
    Cancelled,
    /// There is no particle: the survey has found no surface in the box, or the first particle would have no radius.
    NoSurface,
}

/// State after a step.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Progress {
    /// Iterations done.
    pub iterations: u32,
    /// Particles now.
    pub particles: usize,
    /// Particles that have divided so far.
    pub fissions: u64,
    /// Particles that have died so far.
    pub deaths: u64,
    /// Particles dropped at the end because they did not come to the surface.
    pub dropped: u64,
    /// Mean distance that a particle has moved in the last iteration, in radii.
    pub motion: f64,
    /// Field evaluations so far, including those of the survey.
    pub evaluations: u64,
    /// Set once the run has ended.
    pub stop_reason: Option<StopReason>,
}

/// The surface that the particles are on.
struct SurfaceContext<'a> {
    field: &'a mut dyn Field,
    projector: &'a mut Projector,
}

#[derive(Clone)]
enum Scheme {
    WitkinHeckbert(WitkinHeckbert),
    Forces(Box<Forces>),
}

impl Scheme {
    /// Returns the scheme for particles of one radius.
    fn uniform(settings: &Settings, survey: &Survey, bounds: &Bounds, radius: f32) -> Self {
        let infinite = Vec3::splat(f32::INFINITY);
        let lo = survey.position.iter().fold(infinite, |lo, &p| lo.min(p));
        let hi = survey.position.iter().fold(-infinite, |hi, &p| hi.max(p));
        let diameter = (hi - lo).length().max(2.0 * radius);
        let tolerance = tolerance(radius, survey.accuracy(), survey.gradient_scale);
        Self::WitkinHeckbert(WitkinHeckbert::new(settings, tolerance, bounds, radius, diameter))
    }

    /// Returns the distance within which a particle of this radius has neighbours.
    fn reach(&self, radius: f32) -> f32 {
        match self {
            Self::WitkinHeckbert(_) => WitkinHeckbert::reach(radius),
            Self::Forces(_) => Forces::reach(radius),
        }
    }
}

/// What a run does next, particle by particle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// Put all particles into the grid.
    FillGrid,
    /// Sum the forces.
    Repel,
    /// Move the particles.
    Move,
    /// Let particles divide or die.
    Decide,
    /// Bring all particles onto the surface, before the run ends for this reason.
    Polish(StopReason),
    /// Nothing: the run has ended.
    Done,
}

/// What happens in an iteration.
#[derive(Clone, Copy, Debug, Default)]
struct Activity {
    /// Sum of the distances that particles have moved in this iteration, in radii.
    motion: f64,
    /// Fissions and deaths of the run when the iteration began.
    events: u64,
    /// Whether no particle divided or died in the last iteration.
    is_calm: bool,
    /// Consecutive iterations in which particles were at rest.
    quiet: u32,
}

/// One run of a baseline at a time.
#[derive(Clone)]
pub struct Baseline {
    settings: Settings,
    scheme: Scheme,
    bounds: Bounds,
    factor: f32,
    radius: f64,
    projector: Projector,
    particles: Vec<Particle>,
    neighbourhood: Neighbourhood,
    random: Pcg32,
    phase: Phase,
    /// The next particle in this phase.
    next: usize,
    /// Number of particles when the phase began.
    living: usize,
    activity: Activity,
    progress: Progress,
}

impl Baseline {
    /// Begins a run: surveys the field and puts the first particle on the surface.
    ///
    /// # Errors
    ///
    /// If a setting or the box is invalid.
    pub fn start(field: &mut dyn Field, bounds: &Bounds, settings: &Settings) -> Result<Self, SettingsError> {
        settings.validate()?;
        if !bounds.is_valid() {
            return Err(SettingsError::Box);
        }
        let factor = comfortable_scale(field, spread(bounds));
        let is_dense = !field.has_bounds();
        let field = &mut Scaled::new(field, factor);
        let mut projector = Projector::new();
        let survey = survey(field, bounds, is_dense, &mut projector);
        let sizes = &settings.sizes;
        let radius_of = |count: f64| (survey.area / (2.0 * SQRT_3 * count)).sqrt();
        // A surface that f touches without crossing has no known area, and then no radius is better than another.
        let by_share = sizes.radius_share * bounds.diagonal();
        let mut radius = match sizes.size_mode {
            SizeMode::Count if survey.area > 0.0 => radius_of(f64::from(sizes.count)),
            _ => by_share,
        };
        let scheme = match sizes.sampling {
            Sampling::Uniform => Scheme::uniform(settings, &survey, bounds, radius as f32),
            Sampling::Adaptive => {
                let mut sizing = Sizing::new(field, bounds, sizes, &survey, &mut projector.evaluations);
                if sizes.size_mode == SizeMode::Count {
                    sizing.scale_to(f64::from(sizes.count));
                }
                if sizing.predicted_count() > 0.0 {
                    radius = radius_of(sizing.predicted_count());
                }
                let least = tolerance(0.0, survey.accuracy(), survey.gradient_scale).min_gradient;
                Scheme::Forces(Box::new(Forces::new(settings, sizing, bounds, survey.accuracy(), least)))
            }
        };
        let mut random = Pcg32::seed_from_u64(sizes.seed);
        let count = survey.position.len();
        let first = if count == 0 { 0 } else { (random.next_u64() % count as u64) as usize };
        let zero = (0..count)
            .map(|k| (first + k) % count)
            .find(|&i| survey.is_zero(field, &mut projector, i))
            .map(|i| Particle::new(survey.position[i], survey.normal[i], radius as f32));
        let surface = &mut SurfaceContext { field, projector: &mut projector };
        let seed = zero.and_then(|seed| match &scheme {
            Scheme::WitkinHeckbert(_) => Some(seed),
            Scheme::Forces(forces) => forces.land(surface, [seed], TRUSTED_CORRECTION).map(|[seed]| seed),
        });
        let stop_reason = seed.is_none().then_some(StopReason::NoSurface);
        Ok(Self {
            settings: *settings,
            scheme,
            bounds: *bounds,
            factor,
            radius,
            particles: seed.into_iter().collect(),
            neighbourhood: Neighbourhood::new(),
            random,
            phase: if stop_reason.is_some() { Phase::Done } else { Phase::FillGrid },
            next: 0,
            living: 0,
            activity: Activity::default(),
            progress: Progress {
                iterations: 0,
                particles: 0,
                fissions: 0,
                deaths: 0,
                dropped: 0,
                motion: 0.0,
                evaluations: 0,
                stop_reason,
            },
            projector,
        })
    }

    /// Returns the wanted repulsion radius σ̂. If radii follow the curvature, it is that of as many particles of one
    /// size.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Returns the radius at which a particle of Witkin and Heckbert's system divides whatever it feels: half of the surface's
    /// diameter. There is none in the scheme of forces.
    #[must_use]
    pub fn largest_radius(&self) -> Option<f64> {
        match &self.scheme {
            Scheme::WitkinHeckbert(scheme) => Some(f64::from(scheme.largest)),
            Scheme::Forces(_) => None,
        }
    }

    /// Returns the box that is sampled.
    #[must_use]
    pub fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    /// Returns the positions of the particles.
    #[must_use]
    pub fn positions(&self) -> Vec<Vec3> {
        self.particles.iter().map(|particle| particle.position).collect()
    }

    /// Returns the unit outward normals of the particles.
    #[must_use]
    pub fn normals(&self) -> Vec<Vec3> {
        self.particles.iter().map(|particle| particle.normal).collect()
    }

    /// Returns the repulsion radii of the particles.
    #[must_use]
    pub fn radii(&self) -> Vec<f32> {
        self.particles.iter().map(|particle| particle.radius).collect()
    }

    /// Returns the present state.
    #[must_use]
    pub fn progress(&self) -> Progress {
        Progress { particles: self.particles.len(), evaluations: self.projector.evaluations, ..self.progress }
    }

    /// Ends the run: the next steps only bring the particles onto the surface.
    pub fn cancel(&mut self) {
        if self.phase != Phase::Done {
            self.end(StopReason::Cancelled);
        }
    }

    /// Does up to `budget` units of work; a unit is a particle in one phase. Returns early at the end of an iteration,
    /// so that each can be looked at. How a run is divided into steps does not change it.
    pub fn step(&mut self, field: &mut dyn Field, mut budget: u32) -> Progress {
        let field = &mut Scaled::new(field, self.factor);
        let iteration = self.progress.iterations;
        while budget > 0 && self.phase != Phase::Done && self.progress.iterations == iteration {
            if self.next == 0 {
                self.begin_phase();
            }
            let last = self.living.min(self.next + budget as usize);
            let range = self.next..last;
            budget -= range.len() as u32;
            self.next = last;
            match self.phase {
                Phase::FillGrid => range.for_each(|i| self.neighbourhood.insert(&self.particles, i)),
                Phase::Repel => self.repel(range),
                Phase::Move => self.advance(field, range),
                Phase::Decide => self.decide(field, range),
                Phase::Polish(_) => self.polish(field, range),
                Phase::Done => {}
            }
            if self.next == self.living {
                self.end_phase();
            }
        }
        self.progress()
    }

    fn enter(&mut self, phase: Phase) {
        self.phase = phase;
        self.next = 0;
    }

    fn end(&mut self, reason: StopReason) {
        self.particles.retain(|particle| !particle.dies);
        self.enter(Phase::Polish(reason));
    }

    fn begin_phase(&mut self) {
        // Children that are born in this phase have their turn in the next iteration.
        self.living = self.particles.len();
        match self.phase {
            Phase::FillGrid => {
                for particle in &mut self.particles {
                    (particle.force, particle.load, particle.moment) = (Vec3::ZERO, 0.0, 0.0);
                }
                let reach = |radius| self.scheme.reach(radius);
                if self.activity.is_calm && self.neighbourhood.serves(&self.particles, reach) {
                    self.enter(Phase::Repel);
                } else {
                    self.neighbourhood.reset(&self.particles, reach, self.activity.is_calm);
                }
            }
            Phase::Decide => {
                self.activity.motion = 0.0;
                self.activity.events = self.progress.fissions + self.progress.deaths;
            }
            _ => {}
        }
    }

    fn end_phase(&mut self) {
        match self.phase {
            Phase::FillGrid => self.enter(Phase::Repel),
            Phase::Repel => self.enter(Phase::Move),
            Phase::Move => self.enter(Phase::Decide),
            Phase::Decide => self.end_iteration(),
            Phase::Polish(reason) => {
                let before = self.particles.len();
                self.particles.retain(|particle| !particle.dies);
                self.progress.dropped += (before - self.particles.len()) as u64;
                self.progress.stop_reason = Some(reason);
                self.enter(Phase::Done);
            }
            Phase::Done => {}
        }
    }

    fn end_iteration(&mut self) {
        self.particles.retain(|particle| !particle.dies);
        self.progress.iterations += 1;
        self.progress.motion = self.activity.motion / self.living as f64;
        self.activity.is_calm = self.activity.events == self.progress.fissions + self.progress.deaths;
        let is_quiet = self.activity.is_calm && self.progress.motion <= self.settings.rest;
        self.activity.quiet = if is_quiet { self.activity.quiet + 1 } else { 0 };
        if self.is_full() {
            self.end(StopReason::Cap);
        } else if self.activity.quiet >= self.settings.quiet_iterations {
            self.end(StopReason::Settled);
        } else if self.progress.iterations >= self.settings.max_iterations {
            self.end(StopReason::Iterations);
        } else {
            self.enter(Phase::FillGrid);
        }
    }

    fn is_full(&self) -> bool {
        self.particles.len() >= self.settings.sizes.max_particles as usize
    }

    fn repel(&mut self, range: Range<usize>) {
        for i in range {
            let reach = self.scheme.reach(self.particles[i].radius);
            let near = self.neighbourhood.around(&self.particles, i, reach);
            match &self.scheme {
                Scheme::WitkinHeckbert(scheme) => scheme.repel(&mut self.particles, i, near),
                Scheme::Forces(scheme) => scheme.repel(&mut self.particles, i, near),
            }
        }
    }

    fn advance(&mut self, field: &mut dyn Field, range: Range<usize>) {
        let surface = &mut SurfaceContext { field, projector: &mut self.projector };
        for first in range.clone().step_by(BATCH) {
            let part = first..range.end.min(first + BATCH);
            match &self.scheme {
                Scheme::WitkinHeckbert(scheme) => scheme.advance(surface, &mut self.particles, part),
                Scheme::Forces(scheme) => scheme.advance(surface, &mut self.particles, part),
            }
        }
    }

    /// Lets particles divide or die.
    fn decide(&mut self, field: &mut dyn Field, range: Range<usize>) {
        for i in range {
            let particle = self.particles[i];
            self.activity.motion += f64::from(particle.moved);
            let random = uniform(&mut self.random);
            let (dies, divides) = match &self.scheme {
                Scheme::WitkinHeckbert(scheme) => (scheme.dies(&particle, random), scheme.divides(&particle)),
                Scheme::Forces(scheme) => (scheme.dies(&particle, random), scheme.divides(&particle)),
            };
            // The first particle does not die, so that there is always one.
            if dies && i > 0 {
                self.particles[i].dies = true;
                self.progress.deaths += 1;
            } else if divides && !self.is_full() {
                let surface = &mut SurfaceContext { field, projector: &mut self.projector };
                let direction = tangent(particle.normal, &mut self.random);
                let children = match &self.scheme {
                    Scheme::WitkinHeckbert(scheme) => scheme.children(surface, &particle, direction),
                    Scheme::Forces(scheme) => scheme.children(surface, &particle, direction),
                };
                if let Some([one, other]) = children {
                    self.particles[i] = one;
                    self.particles.push(other);
                    self.progress.fissions += 1;
                }
            }
        }
    }

    /// Brings particles onto the surface within the tolerance.
    fn polish(&mut self, field: &mut dyn Field, range: Range<usize>) {
        let surface = &mut SurfaceContext { field, projector: &mut self.projector };
        for particle in &mut self.particles[range] {
            let landed = match &self.scheme {
                Scheme::WitkinHeckbert(scheme) => scheme.landed(surface, particle),
                Scheme::Forces(scheme) => Some(scheme.landed(surface, particle)),
            };
            match landed {
                Some(landed) => *particle = landed,
                None => particle.dies = true,
            }
        }
    }
}

#[cfg(test)]
mod tests;
