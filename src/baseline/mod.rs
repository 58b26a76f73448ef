//! What the paper compares its method with (§3 and §6, Table 1): particle systems that begin with one particle and cover the surface
//! by fission and death.
//!
//! For particles of one size that is the system of Witkin and Heckbert (`witkin_heckbert`), for those whose size follows the
//! curvature a scheme of forces (`forces`). Both do, over and over (paper §3): compute forces and energies, move the particles,
//! split or kill them; until nothing more happens, or the iterations are at their end.
//!
//! They are built to be hard to beat: neighbours come from the grid of the front, so that an iteration is linear in the particles, and
//! from lists that serve for several iterations once no particle divides or dies; a particle takes one evaluation of the field in an iteration, in batches; the survey, the radius law, the forces between
//! discs and the way back onto the surface are those of the sampler. Only the page is without them.
//!
//! # Differs from the paper
//!
//! * The paper detects convergence by the number of particles and their residual motion, without numbers (§3). Here a run has settled
//!   after [`Settings::quiet_iterations`] in a row without fission and death and with the mean motion below [`Settings::rest`].
//! * At the end all particles are brought onto the surface to the tolerance of the sampler; those that are not beside it are dropped.

mod crowd;
mod forces;
mod settings;
mod witkin_heckbert;

pub use settings::Settings;

use crate::field::Field;
use crate::field::scaled::{Scaled, comfortable_factor, spread};
use crate::math::{Bounds, SQRT_3};
use crate::sampler::discovery::survey::survey;
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
    /// Nothing more happens: no fission, no death, hardly any motion.
    Settled,
    /// The iterations are at their end; particles still move, divide or die.
    Iterations,
    /// The limit on particles was reached.
    Cap,
    /// Stopped by the caller; what was there stays.
    Cancelled,
    /// No particle: the survey has met no surface in the box, or no radius where the first particle would be.
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
    /// Mean way of the particles in the last iteration, in radii.
    pub motion: f64,
    /// Field evaluations so far, of the survey too.
    pub evaluations: u64,
    /// Set once the run has ended.
    pub stop_reason: Option<StopReason>,
}

/// What the particles stand on.
struct Ground<'a> {
    field: &'a mut dyn Field,
    projector: &'a mut Projector,
}

#[derive(Clone)]
enum Scheme {
    WitkinHeckbert(WitkinHeckbert),
    Forces(Box<Forces>),
}

impl Scheme {
    fn reach(&self, radius: f32) -> f32 {
        match self {
            Self::WitkinHeckbert(_) => WitkinHeckbert::reach(radius),
            Self::Forces(_) => Forces::reach(radius),
        }
    }
}

/// What an iteration does next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Put all particles into the grid.
    Grid,
    Repel,
    Move,
    /// Split and kill.
    Fate,
    /// Bring all onto the surface, at the end.
    Polish,
    Done,
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
    stage: Stage,
    /// The reason for the end, once that has come.
    ending: StopReason,
    next: usize,
    /// Particles when the stage began.
    living: usize,
    /// Sum of the ways of the particles in this iteration, in radii.
    way: f64,
    /// Fissions and deaths when the iteration began.
    events: u64,
    /// Whether no particle has divided or died in the last iteration.
    is_calm: bool,
    quiet: u32,
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
        let factor = comfortable_factor(field, spread(bounds));
        let is_dense = !field.has_bounds();
        let field = &mut Scaled::new(field, factor);
        let mut projector = Projector::new();
        let survey = survey(field, bounds, is_dense, &mut projector);
        let sizes = &settings.sizes;
        let radius_of = |count: f64| (survey.area / (2.0 * SQRT_3 * count)).sqrt();
        // A surface that f touches without crossing it has no known area: any radius is as good.
        let by_share = sizes.radius_share * bounds.diagonal();
        let mut radius = match sizes.size_mode {
            SizeMode::Count if survey.area > 0.0 => radius_of(f64::from(sizes.count)),
            _ => by_share,
        };
        let (resolution, scale) = (survey.resolution, survey.gradient_scale);
        let scheme = match sizes.sampling {
            Sampling::Uniform => {
                let infinite = Vec3::splat(f32::INFINITY);
                let lo = survey.position.iter().fold(infinite, |lo, &p| lo.min(p));
                let hi = survey.position.iter().fold(-infinite, |hi, &p| hi.max(p));
                let diameter = (hi - lo).length().max(2.0 * radius as f32);
                let tolerance = tolerance(radius as f32, resolution, scale);
                let scheme = WitkinHeckbert::new(settings, tolerance, bounds, radius as f32, diameter);
                Scheme::WitkinHeckbert(scheme)
            }
            Sampling::Adaptive => {
                let mut sizing = Sizing::new(field, bounds, sizes, &survey, &mut projector.evaluations);
                if sizes.size_mode == SizeMode::Count {
                    sizing.scale_to(f64::from(sizes.count));
                }
                if sizing.predicted_count() > 0.0 {
                    radius = radius_of(sizing.predicted_count());
                }
                let least = tolerance(0.0, 0.0, scale).min_gradient;
                Scheme::Forces(Box::new(Forces::new(settings, sizing, bounds, resolution, least)))
            }
        };
        let mut random = Pcg32::seed_from_u64(sizes.seed);
        let count = survey.position.len();
        let first = if count == 0 { 0 } else { (random.next_u64() % count as u64) as usize };
        let zero = (0..count)
            .map(|k| (first + k) % count)
            .find(|&i| survey.is_zero(field, &mut projector, i))
            .map(|i| Particle::new(survey.position[i], survey.normal[i], radius as f32));
        let ground = &mut Ground { field, projector: &mut projector };
        let seed = zero.and_then(|seed| match &scheme {
            Scheme::WitkinHeckbert(_) => Some(seed),
            Scheme::Forces(forces) => forces.land(ground, [seed], TRUSTED_CORRECTION).map(|[seed]| seed),
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
            stage: if stop_reason.is_some() { Stage::Done } else { Stage::Grid },
            ending: StopReason::Settled,
            next: 0,
            living: 0,
            way: 0.0,
            events: 0,
            is_calm: false,
            quiet: 0,
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

    /// Wanted repulsion radius σ̂; with radii that follow the curvature, that of as many particles of one size.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The box.
    #[must_use]
    pub fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    /// Positions of the particles.
    #[must_use]
    pub fn positions(&self) -> Vec<Vec3> {
        self.particles.iter().map(|particle| particle.position).collect()
    }

    /// Unit outward normals of the particles.
    #[must_use]
    pub fn normals(&self) -> Vec<Vec3> {
        self.particles.iter().map(|particle| particle.normal).collect()
    }

    /// Repulsion radii of the particles.
    #[must_use]
    pub fn radii(&self) -> Vec<f32> {
        self.particles.iter().map(|particle| particle.radius).collect()
    }

    /// The state as of now.
    #[must_use]
    pub fn progress(&self) -> Progress {
        Progress { particles: self.particles.len(), evaluations: self.projector.evaluations, ..self.progress }
    }

    /// Ends the run where it is; the next steps only bring the particles onto the surface.
    pub fn cancel(&mut self) {
        if self.stage != Stage::Done {
            self.end(StopReason::Cancelled);
        }
    }

    /// Does up to `budget` units of work: a particle in one stage of an iteration. Returns early where an iteration ends, so that
    /// each can be looked at. How a run is cut into steps does not change it.
    pub fn step(&mut self, field: &mut dyn Field, mut budget: u32) -> Progress {
        let field = &mut Scaled::new(field, self.factor);
        let iteration = self.progress.iterations;
        while budget > 0 && self.stage != Stage::Done && self.progress.iterations == iteration {
            if self.next == 0 {
                self.begin_stage();
            }
            let last = self.living.min(self.next + budget as usize);
            let range = self.next..last;
            budget -= range.len() as u32;
            self.next = last;
            match self.stage {
                Stage::Grid => range.for_each(|i| self.neighbourhood.insert(&self.particles, i)),
                Stage::Repel => self.repel(range),
                Stage::Move => self.advance(field, range),
                Stage::Fate => self.decide(field, range),
                Stage::Polish => self.polish(field, range),
                Stage::Done => {}
            }
            if self.next == self.living {
                self.end_stage();
            }
        }
        self.progress()
    }

    fn enter(&mut self, stage: Stage) {
        self.stage = stage;
        self.next = 0;
    }

    fn end(&mut self, reason: StopReason) {
        self.ending = reason;
        self.particles.retain(|particle| !particle.dies);
        self.enter(Stage::Polish);
    }

    fn begin_stage(&mut self) {
        // Children that come in the meantime have their turn in the next iteration.
        self.living = self.particles.len();
        match self.stage {
            Stage::Grid => {
                for particle in &mut self.particles {
                    (particle.force, particle.load, particle.moment) = (Vec3::ZERO, 0.0, 0.0);
                }
                let reach = |radius| self.scheme.reach(radius);
                if self.is_calm && self.neighbourhood.serves(&self.particles, reach) {
                    self.enter(Stage::Repel);
                } else {
                    self.neighbourhood.reset(&self.particles, reach, self.is_calm);
                }
            }
            Stage::Fate => {
                self.way = 0.0;
                self.events = self.progress.fissions + self.progress.deaths;
            }
            _ => {}
        }
    }

    fn end_stage(&mut self) {
        match self.stage {
            Stage::Grid => self.enter(Stage::Repel),
            Stage::Repel => self.enter(Stage::Move),
            Stage::Move => self.enter(Stage::Fate),
            Stage::Fate => self.end_iteration(),
            Stage::Polish => {
                let before = self.particles.len();
                self.particles.retain(|particle| !particle.dies);
                self.progress.dropped += (before - self.particles.len()) as u64;
                self.progress.stop_reason = Some(self.ending);
                self.enter(Stage::Done);
            }
            Stage::Done => {}
        }
    }

    fn end_iteration(&mut self) {
        self.particles.retain(|particle| !particle.dies);
        self.progress.iterations += 1;
        self.progress.motion = self.way / self.living as f64;
        self.is_calm = self.events == self.progress.fissions + self.progress.deaths;
        let is_quiet = self.is_calm && self.progress.motion <= self.settings.rest;
        self.quiet = if is_quiet { self.quiet + 1 } else { 0 };
        if self.is_full() {
            self.end(StopReason::Cap);
        } else if self.quiet >= self.settings.quiet_iterations {
            self.end(StopReason::Settled);
        } else if self.progress.iterations >= self.settings.max_iterations {
            self.end(StopReason::Iterations);
        } else {
            self.enter(Stage::Grid);
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
        let ground = &mut Ground { field, projector: &mut self.projector };
        for first in range.clone().step_by(BATCH) {
            let part = first..range.end.min(first + BATCH);
            match &self.scheme {
                Scheme::WitkinHeckbert(scheme) => scheme.advance(ground, &mut self.particles, part),
                Scheme::Forces(scheme) => scheme.advance(ground, &mut self.particles, part),
            }
        }
    }

    /// Splits and kills particles.
    fn decide(&mut self, field: &mut dyn Field, range: Range<usize>) {
        for i in range {
            let particle = self.particles[i];
            self.way += f64::from(particle.way);
            let random = uniform(&mut self.random);
            let (dies, divides) = match &self.scheme {
                Scheme::WitkinHeckbert(scheme) => (scheme.dies(&particle, random), scheme.divides(&particle)),
                Scheme::Forces(scheme) => (scheme.dies(&particle, random), scheme.divides(&particle)),
            };
            // The first stays, so that there is always one.
            if dies && i > 0 {
                self.particles[i].dies = true;
                self.progress.deaths += 1;
            } else if divides && !self.is_full() {
                let ground = &mut Ground { field, projector: &mut self.projector };
                let direction = tangent(particle.normal, &mut self.random);
                let children = match &self.scheme {
                    Scheme::WitkinHeckbert(scheme) => scheme.children(ground, &particle, direction),
                    Scheme::Forces(scheme) => scheme.children(ground, &particle, direction),
                };
                if let Some([one, other]) = children {
                    self.particles[i] = one;
                    self.particles.push(other);
                    self.progress.fissions += 1;
                }
            }
        }
    }

    /// Brings particles onto the surface for good.
    fn polish(&mut self, field: &mut dyn Field, range: Range<usize>) {
        let ground = &mut Ground { field, projector: &mut self.projector };
        for particle in &mut self.particles[range] {
            let landed = match &self.scheme {
                Scheme::WitkinHeckbert(scheme) => scheme.landed(ground, particle),
                Scheme::Forces(scheme) => Some(scheme.landed(ground, particle)),
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
