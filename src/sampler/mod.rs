//! How a surface is covered with particles: the settings, and what a run tells of itself.
//!
//! [`Sampler::begin`] surveys the field and fixes the radius; each [`Sampler::step`] then does a
//! given number of units of work. A budget is a count, never a time, and how a run is cut into
//! steps does not change its result by a bit. Placing and relaxing particles allocates only the
//! growth of the columns; the search for components, the audit and the refinement have memory of
//! their own.

mod attempt;
mod constraint;
mod count;
mod cover;
mod discovery;
mod fates;
mod flow;
mod front;
mod message;
mod methods;
mod neighbours;
mod pace;
mod pattern;
mod phase;
pub(crate) mod probe;
mod progress;
mod projection;
mod refine;
mod relaxation;
mod settings;
pub(crate) mod sheet;
mod sizing;
mod spacing;
mod stages;
mod surface;

pub use discovery::completeness::{Doubt, Sampled, Search, Unsampled};
pub use fates::FateCounts;
pub use flow::FollowError;
pub use phase::{Phase, StopReason};
pub use progress::{Counts, Forecast, Progress};
pub use refine::{Refusal, Spot};
pub use settings::{
    COUNT_ROOM, Counting, GapPolicy, LawKind, Method, Pattern, Radius, Sampling, Settings, SettingsError,
    SizeMode,
};
pub use spacing::{SpacedSettings, Spacing};

pub(crate) use attempt::COUNT_TOLERANCE;
pub(crate) use discovery::precision::Blur;
pub(crate) use discovery::singular::{SingularKind, SingularPlace};
pub(crate) use sizing::Smoothing;
pub(crate) use surface::{FoundCreases, find_creases};

use crate::field::{Field, Frame, Pieces};
use crate::math::Bounds;
use crate::particles::Particles;
use crate::slices::Work;
use attempt::Attempt;
#[doc(hidden)]
pub use constraint::Creases;
use core::hint::black_box;
use cover::Cover;
use discovery::precision;
use discovery::singular;
use discovery::survey::{Absence, spacing};
use glam::DVec3;
use pace::{MethodUnderWay, Task};
use probe::{Probe, ProbeMemory};
use sizing::{Sizing, Wish};
use stages::coarse::Refining;
use std::sync::Arc;
use surface::Surface;

/// Bytes per particle that must be free before a run. For a front: the columns, neighbour lists and
/// grid, and most of what its relaxation adds. For a refined run: the columns and the last two
/// levels of its mesh, with the wanted sizes if they vary. tests/memory.rs checks this against what
/// runs take. Not more, since WebAssembly never gives memory back.
pub(crate) fn bytes_per_particle(settings: &Settings) -> usize {
    // A pattern has a front of about as many particles under it, and cells of their squares.
    if settings.pattern_in_use() != Pattern::Hexagonal {
        return 230;
    }
    match (settings.method, settings.sampling) {
        (Method::Front, _) => 95,
        (Method::Refined, Sampling::Uniform) => 130,
        (Method::Refined, Sampling::Adaptive) => 136,
    }
}

/// A sampler, which covers one surface at a time with particles. A new one has nothing to do.
#[derive(Default)]
#[doc(hidden)]
pub struct Sampler<'f> {
    settings: Settings,
    /// The spacing by a function, if there is one, and whether sizes also follow the curvature.
    spacing: Option<(Spacing, bool)>,
    surface: Arc<Surface>,
    /// What the last method has made of the surface, or what the one under way has made so far.
    cover: Cover,
    /// The method under way, if any.
    method: Option<MethodUnderWay<'f>>,
    /// Why the last method has ended; none while one is under way.
    stop_reason: Option<StopReason>,
    /// Whether a person gave the box.
    is_box_given: bool,
    /// Limit on the memory of a run, in bytes; none if the memory is not limited.
    memory_limit: Option<usize>,
}

impl<'f> Sampler<'f> {
    /// The particles so far. Those of a level under way may be provisional: [`Progress::particles`]
    /// says how many stay. Particles that a coarse front has placed beyond the box are left out.
    #[must_use]
    pub fn particles(&self) -> &Particles {
        self.cover.inside.as_ref().unwrap_or(&self.cover.particles)
    }

    /// The [`Sampler::particles`], without a copy.
    pub(crate) fn into_particles(self) -> Particles {
        self.cover.inside.unwrap_or(self.cover.particles)
    }

    /// The mesh of a refined run: triples of particles, counter-clockwise seen from outside, an
    /// oriented manifold whose border lies on the box. It is empty for a front, before the end of
    /// the run, and once the particles are relaxed.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        self.cover.corners.as_chunks().0
    }

    /// Counts of the run so far.
    #[must_use]
    pub fn counts(&self) -> Counts {
        let level = self.cover.front.level();
        Counts { fates: level.fates, gaps_filled: level.filled, ..self.cover.counts.clone() }
    }

    /// Energy per particle before the first relaxation step and after each. For uniform sampling it
    /// is Σ s (exp(−d²/2σ²) − exp(−9/2)) over the pairs nearer than 3σ. The factor s is 1 for pairs
    /// whose normals are within 60°, 0 beyond 120°, and ½ + cosine in between.
    #[must_use]
    pub fn energy(&self) -> &[f64] {
        self.cover.relaxation.energy()
    }

    /// Repulsion radius r of the run.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.cover.attempt.radius
    }

    /// Whether it is proven that every connected component has a witness, and that every witness is
    /// on the component of a particle or [named](Sampled::without).
    #[must_use]
    pub fn search(&self) -> Search {
        if self.doubts().is_empty() { Search::Proven } else { Search::Searched }
    }

    /// The doubts that are left about the components; empty if everything is proven.
    #[must_use]
    pub fn doubts(&self) -> Vec<Doubt> {
        let mut doubts = self.cover.components.doubts(self.surface.survey.nearness, self.least_gap());
        let creases = &self.surface.creases;
        let is_searched = creases.are_there() && !self.cover.components.proves_edges();
        doubts.extend((is_searched || creases.bare.is_some()).then_some(Doubt::Creases));
        doubts
    }

    /// Sheets nearer to each other than this are not told apart.
    fn least_gap(&self) -> f64 {
        self.surface.survey.least_gap(self.settings.sampling == Sampling::Adaptive)
    }

    /// The components that hold particles, and the witnessed ones that do not.
    #[must_use]
    pub fn sampled(&self) -> Sampled {
        self.cover.components.sampled(self.doubts().is_empty())
    }

    /// Number of cells that the proof left undecided on whether they hold the first point of a
    /// component, plus the witnesses for which it could not decide whether their component holds a
    /// particle; `None` if no proof was attempted.
    #[must_use]
    pub fn undecided_cells(&self) -> Option<u64> {
        self.cover.components.open_questions()
    }

    /// Number of points of the surface where f has no gradient, a curve of them counted as one;
    /// `None` if they were not searched for.
    #[must_use]
    pub fn singular_points(&self) -> Option<u64> {
        self.cover.components.open_questions().map(|_| self.singular_places().len() as u64)
    }

    /// The known places of the surface where f has no gradient.
    pub(crate) fn singular_places(&self) -> Vec<SingularPlace> {
        let mut places = singular::places(self.cover.components.singular(), spacing(&self.surface.bounds));
        let passed = self.surface.creases.passed.map(|position| SingularPlace {
            position,
            kind: SingularKind::Crossing,
            points: Vec::new(),
        });
        places.extend(passed.filter(|passed| places.iter().all(|place| place.kind != passed.kind)));
        places
    }

    /// The frame in which the field was evaluated since the last start.
    #[must_use]
    pub fn frame(&self) -> Frame {
        self.surface.frame
    }

    /// The settings of the run.
    #[must_use]
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Starts a run, with valid settings in a valid box: surveys the field (about 40,000
    /// evaluations, 80,000 for a field without bounds to prove by) and fixes the radius. Particles
    /// of an earlier run are dropped. The box, like the particles, is relative to `origin`.
    /// `creases` are the creases of the surface in the box; without them everything known of field
    /// and box is kept from the last start, with its survey.
    ///
    /// # Errors
    ///
    /// If there is no memory for the expected particles; no run is started then.
    pub fn begin(
        &mut self,
        field: &Arc<dyn Field + 'f>,
        origin: DVec3,
        bounds: &Bounds,
        settings: &Settings,
        creases: Option<Creases>,
    ) -> Result<Forecast, SettingsError> {
        (self.settings, self.method, self.stop_reason) = (*settings, None, None);
        // The columns keep their memory.
        let mut particles = core::mem::take(&mut self.cover.particles);
        particles.clear();
        particles.origin = origin;
        let searched = core::mem::take(&mut self.cover.components).into_octree();
        self.cover = Cover { particles, ..Cover::default() };
        let mut memory = ProbeMemory::default();
        let surface = Arc::make_mut(&mut self.surface);
        surface.searched = searched.or_else(|| surface.searched.take());
        let creases =
            creases.or_else(|| (!surface.is_surveyed()).then(|| core::mem::take(&mut surface.creases)));
        if let Some(creases) = creases {
            *surface = Surface::find(field, origin, bounds, settings.survey_cells, creases, &mut memory);
        }
        let is_adaptive = settings.sampling == Sampling::Adaptive;
        let components = surface.begin_search(field, is_adaptive, &mut memory);
        let surface = &*self.surface;
        let evaluator = &mut *field.evaluator(surface.frame);
        let wish = self.wish();
        let sizing = is_adaptive.then(|| {
            let probe = &mut Probe::new(evaluator, &mut memory);
            Sizing::new(probe, bounds, settings, wish, &surface.survey, &surface.creases)
        });
        sizing.as_ref().map_or(Ok(()), Sizing::check)?;
        let counts = &mut self.cover.counts;
        counts.seeding_evaluations = memory.evaluations;
        let mut attempt = Attempt::first(settings, surface.survey.area, bounds.diagonal(), sizing);
        let refining = (settings.method == Method::Refined)
            .then(|| Refining::new(&mut attempt, evaluator, surface, settings));
        counts.refusal = refining.as_ref().and_then(|refining| refining.as_ref().err().copied());
        let predicted = attempt.predicted_count(settings);
        if settings.size_mode == SizeMode::Count && settings.count <= settings.max_particles {
            let room = (f64::from(settings.count) * COUNT_ROOM) as u32;
            self.settings.max_particles = settings.max_particles.max(room);
        }
        if !self.has_room_for(Attempt::reserved(predicted, &self.settings)) {
            return Err(SettingsError::Memory { particles: predicted as u64 });
        }
        let (radius, area) = (attempt.radius, surface.survey.area);
        self.cover.evaluations = memory.evaluations;
        (self.cover.attempt, self.cover.components) = (attempt, components);
        let refining = refining.and_then(Result::ok);
        self.carry_out(move |task, cover| methods::sample(task, cover, refining), field, Phase::Seeding);
        Ok(Forecast { radius, predicted_count: predicted as u64, area })
    }

    /// Whether f touches zero without changing its sign, so that both sides of the surface are
    /// sampled.
    pub(crate) fn touches(&self) -> bool {
        self.surface.survey.touches
    }

    /// A place where f vanishes only on a curve or at an isolated point, if one was found.
    pub(crate) fn bare_place(&self) -> Option<DVec3> {
        self.surface.bare_place().or(self.cover.bare)
    }

    /// Whether no surface was found and none was ruled out: f may have one that is small compared
    /// with the box, or beyond it.
    pub(crate) fn shows_nothing(&self) -> bool {
        let absence = self.surface.survey.absence;
        let is_unseen = matches!(absence, Absence::NotSeen | Absence::Undefined | Absence::Constant);
        is_unseen && self.cover.components.singular().is_empty()
    }

    /// Sets whether the user gave the box of the next run, which messages depend on.
    pub(crate) fn set_box_given(&mut self, is_given: bool) {
        self.is_box_given = is_given;
    }

    /// Whether the search for components was left undecided in a box where f overflows double
    /// precision in places.
    pub(crate) fn is_open_by_overflow(&self, field: &dyn Field) -> bool {
        self.undecided_cells().is_some_and(|cells| cells > 0)
            && precision::overflows_double(&mut *field.evaluator(self.surface.frame), &self.surface.bounds)
    }

    /// The particle that rounding in double precision moves most, if by more than a particle may
    /// lie off the surface.
    pub(crate) fn blur(&self, field: &dyn Field) -> Option<Blur> {
        precision::blur(&mut *field.evaluator(self.surface.frame), &self.cover.particles)
    }

    /// Sets the spacing of the next start, whose settings must be adaptive, and whether sizes also
    /// follow the curvature.
    pub(crate) fn set_spacing(&mut self, spacing: Option<(Spacing, bool)>) {
        self.spacing = spacing;
    }

    /// The wanted spacing, in the frame of the run.
    fn wish(&self) -> Option<Wish> {
        let (spacing, bends) = self.spacing.clone()?;
        Some(Wish { spacing, bends, origin: self.surface.frame.origin })
    }

    /// Where the slope keeps the radius of the start below the one that a spacing asks for.
    pub(crate) fn smoothing(&self) -> Option<Smoothing> {
        self.cover.attempt.sizing.as_ref()?.smoothing()
    }

    /// Refuses runs that need more than about `bytes` from now on.
    pub fn limit_memory(&mut self, bytes: usize) {
        self.memory_limit = Some(bytes);
    }

    /// Whether there is memory for a run of `particles`. It is allocated at once and freed again,
    /// because an allocation that fails in the middle of a run cannot be caught.
    fn has_room_for(&self, particles: usize) -> bool {
        let bytes = |particles: usize| particles.checked_mul(bytes_per_particle(&self.settings));
        let more = particles.saturating_sub(self.cover.particles.local.capacity());
        let is_there = |more: usize| {
            let mut memory = Vec::<u8>::new();
            let is_there = memory.try_reserve_exact(more).is_ok();
            // The compiler leaves out an allocation that nobody uses, and takes it for one that
            // succeeds.
            black_box(&memory);
            is_there
        };
        bytes(particles).is_some_and(|all| self.memory_limit.is_none_or(|limit| all <= limit))
            && bytes(more).is_some_and(is_there)
    }

    /// Requests `steps` more relaxation steps on the particles of a finished run; [`Sampler::step`]
    /// does them. Returns whether there are particles to relax; if not, nothing has changed. Blue
    /// noise and random points are not relaxed: they would lose their pattern.
    #[must_use]
    pub fn relax(&mut self, field: &Arc<dyn Field + 'f>, steps: u32) -> bool {
        let can_relax = self.stop_reason.is_some()
            && self.cover.particles.len() > 1
            && self.settings.pattern_in_use() == Pattern::Hexagonal;
        if can_relax {
            self.settings.relax_steps = self.cover.relaxation.steps_done() + steps;
            self.cover.begin_relaxation(&self.surface, &self.settings);
            self.carry_out(methods::relax_further, field, Phase::Relaxation);
        }
        can_relax
    }

    /// Begins a frame of particles that follow a surface: those of a finished run are moved onto
    /// the surface of `field` in a box, which has changed only a little; [`Sampler::step`] does it.
    /// If it `is_closed`, particles are neither added nor removed, except those that lost the
    /// surface.
    ///
    /// # Errors
    ///
    /// If the particles cannot follow. Nothing has changed then.
    pub(crate) fn follow(
        &mut self,
        field: &Arc<dyn Field + 'f>,
        bounds: &Bounds,
        is_closed: bool,
    ) -> Result<(), FollowError> {
        let particles = &self.cover.particles;
        // A front that was stopped has not covered the surface.
        let covers = match (self.cover.phase, self.stop_reason) {
            (Phase::Done, reason) => reason == Some(StopReason::Complete) || !particles.identity.is_empty(),
            // An unfinished frame: the next one continues from where the particles are.
            (Phase::Flow, _) => true,
            (Phase::Idle, _) => false,
            _ => return Err(FollowError::UnderWay),
        };
        if !covers || particles.len() < 2 {
            return Err(FollowError::NotCovered);
        }
        let mut evaluator = field.evaluator(self.surface.frame);
        let has_several =
            |patches: &mut dyn Pieces| patches.labels_in(bounds).is_none_or(|all| all.len() > 1);
        let is_smooth = particles.patch.is_empty() && !self.surface.creases.are_there();
        if !is_smooth || evaluator.pieces().is_some_and(has_several) {
            return Err(FollowError::Creased);
        }
        let is_leap = flow::is_leap(&mut *evaluator, particles, self.cover.attempt.radius)?;
        self.cover.flow.begin(&mut self.cover.particles);
        if is_leap {
            self.cover.flow.leap();
        }
        self.cover.flow.is_closed = is_closed;
        Arc::make_mut(&mut self.surface).bounds = *bounds;
        if self.cover.flow.is_due() {
            self.look_again(field, bounds);
        }
        self.carry_out(methods::follow, field, Phase::Flow);
        Ok(())
    }

    /// Surveys a surface that has moved. The packing stays as measured; proofs about the surface
    /// before no longer hold.
    fn look_again(&mut self, field: &dyn Field, bounds: &Bounds) {
        let mut memory = ProbeMemory { evaluations: self.cover.evaluations, ..ProbeMemory::default() };
        let moved = self.surface.moved_to(field, bounds, &mut memory);
        if let Some(moved) = moved {
            self.surface = Arc::new(moved);
            let (surface, wish) = (&*self.surface, self.wish());
            let evaluator = &mut *field.evaluator(surface.frame);
            let cover = &mut self.cover;
            let sizing = (self.settings.sampling == Sampling::Adaptive).then(|| {
                let probe = &mut Probe::new(evaluator, &mut memory);
                Sizing::new(probe, bounds, &self.settings, wish, &surface.survey, &surface.creases)
            });
            let (area, growth) = (surface.survey.area, cover.flow.growth());
            cover.attempt.move_on(&self.settings, area, bounds.diagonal(), sizing, growth);
            cover.components.begin(evaluator, bounds, &[]);
            cover.plan = cover.attempt.front(&self.settings, bounds);
            cover.front.reset(&cover.plan, &surface.survey, 0);
            if cover.attempt.sizing.is_none() {
                cover.particles.radius.fill(cover.attempt.radius as f32);
            }
        }
        self.cover.evaluations = memory.evaluations;
    }

    /// Makes a method the one under way.
    fn carry_out(
        &mut self,
        method: impl for<'t> FnOnce(&'t mut Task<'_>, &'t mut Cover) -> Work<'t, StopReason> + Send + 'static,
        field: &Arc<dyn Field + 'f>,
        phase: Phase,
    ) {
        let method =
            MethodUnderWay::begin(method, Arc::clone(field), Arc::clone(&self.surface), self.settings);
        (self.method, self.stop_reason) = (Some(method), None);
        (self.cover.phase, self.cover.fraction) = (phase, 0.0);
    }

    /// Ends the run where it is; the particles placed so far stay. The next step tidies up, even if
    /// its budget is 0.
    pub fn cancel(&mut self) {
        self.cover.inside = None;
        if let Some(method) = &mut self.method {
            method.stop();
        }
    }

    /// Does up to `budget` units of work: a particle's slots, a child's projection, a particle's
    /// share of a relaxation step. Returns early when the search or the relaxation begins, and now
    /// and then during both, so that the caller can show the particles.
    pub fn step(&mut self, budget: u32) -> Progress {
        let ended = self.method.as_mut().and_then(|method| method.step(&mut self.cover, budget));
        if ended.is_some() {
            (self.method, self.stop_reason, self.cover.phase) = (None, ended, Phase::Done);
        }
        self.cover.look_inside(&self.surface.bounds);
        let progress = self.progress();
        (self.cover.moved, self.cover.fraction) = (false, progress.fraction);
        progress
    }
}
