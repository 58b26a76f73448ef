//! The sampler covers a surface with particles and relaxes them.
//!
//! [`Sampler::begin`] surveys the field and fixes the radius; each [`Sampler::step`] then does a
//! given number of units of work. A budget is a count, never a time, and how a run is cut into
//! steps does not change its result by a bit. Placing and relaxing particles allocates only the
//! growth of the columns; the search for components, the audit and the refinement have memory of
//! their own.

mod attempt;
mod constraint;
mod desk;
mod discovery;
mod fates;
mod flow;
mod front;
mod message;
mod methods;
mod neighbours;
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
mod steps;

pub use discovery::completeness::{Doubt, Sampled, Search, Unsampled};
pub use fates::FateCounts;
pub use flow::FollowError;
pub use phase::{Phase, StopReason};
pub use progress::{Counts, Forecast, Progress};
pub use refine::{Refusal, Spot};
pub use settings::{
    COUNT_ROOM, GapPolicy, LawKind, Method, Radius, Sampling, Settings, SettingsError, SizeMode,
};
pub use spacing::{SpacedSettings, Spacing};

pub(crate) use attempt::COUNT_TOLERANCE;
pub(crate) use discovery::precision::Blur;
pub(crate) use discovery::singular::{SingularKind, SingularPlace};
pub(crate) use sizing::Smoothing;

use crate::field::edges::{self, KnownPieces};
use crate::field::{Evaluator, Field, Frame, Pieces};
use crate::math::Bounds;
use crate::particles::Particles;
use crate::slices::Work;
use attempt::Attempt;
pub use constraint::Creases;
use constraint::tips::Tip;
use core::hint::black_box;
use desk::{MethodUnderWay, Request};
use discovery::grid::DENSE_CELLS;
use discovery::search::ComponentSearch;
use discovery::singular::{Bend, NearSurvey, Singular};
use discovery::survey::{Absence, Survey, bare_among, bare_size, spacing, survey};
use discovery::{precision, singular};
use flow::Flow;
use front::{Front, FrontPlan};
use glam::{DVec3, Vec3};
use neighbours::packed::PackedNeighbours;
use probe::{Probe, ProbeMemory};
use progress::RefineProgress;
use refine::CoarseFronts;
use relaxation::Relaxation;
use sizing::{Sizing, Wish};
use steps::SurveyCursor;

/// Bytes per particle that must be free before a run. For a front: the columns, neighbour lists and
/// grid, and most of what its relaxation adds. For a refined run: the columns and the last two
/// levels of its mesh, with the wanted sizes if they vary. tests/memory.rs checks this against what
/// runs take. Not more, since WebAssembly never gives memory back.
pub(crate) fn bytes_per_particle(settings: &Settings) -> usize {
    match (settings.method, settings.sampling) {
        (Method::Front, _) => 95,
        (Method::Refined, Sampling::Uniform) => 130,
        (Method::Refined, Sampling::Adaptive) => 136,
    }
}

/// A sampler, which covers one surface at a time with particles. A new one has nothing to do.
#[derive(Default)]
pub struct Sampler {
    settings: Settings,
    /// The spacing by a function, if there is one, and whether sizes also follow the curvature.
    spacing: Option<(Spacing, bool)>,
    bounds: Bounds,
    survey: Survey,
    /// The frame in which the field is evaluated.
    frame: Frame,
    creases: Creases,
    /// The singular points near those of the survey.
    singular: Vec<Singular>,
    tips: Vec<Tip>,
    attempt: Attempt,
    /// The front of this attempt.
    plan: FrontPlan,
    /// The method under way, if any.
    method: Option<MethodUnderWay>,
    phase: Phase,
    /// Why the last method has ended; none while one is under way.
    stop_reason: Option<StopReason>,
    /// The next seed of the survey.
    seeds: SurveyCursor,
    /// The progress of the refinement of a coarse front, while there is one.
    refined: RefineProgress,
    components: ComponentSearch,
    tools: Tools,
    output: Output,
    counts: Counts,
    /// Whether a person gave the box.
    is_box_given: bool,
    /// Limit on the memory of a run, in bytes; none if the memory is not limited.
    memory_limit: Option<usize>,
}

/// The fronts and the relaxation, with their buffers, which are reused from one run to the next.
#[derive(Clone, Default)]
struct Tools {
    memory: ProbeMemory,
    front: Front,
    /// Coarse fronts, one for each component that is refined.
    coarse: CoarseFronts,
    relaxation: Relaxation,
    flow: Flow,
    neighbours: PackedNeighbours,
}

/// Results of a run so far.
#[derive(Clone, Default)]
struct Output {
    particles: Particles,
    /// The particles of a coarse front that lie in the box, while the front marches beyond.
    inside: Option<Particles>,
    /// The mesh of a refinement: the particles at the corners of its faces.
    corners: Vec<u32>,
    /// Whether particles have moved or been removed since the last step.
    moved: bool,
    /// The largest share of the work reported so far, since work was last requested.
    fraction: f64,
}

/// The creases of a surface in a box, and the function whose patches they separate.
#[derive(Clone, Default)]
pub(crate) struct FoundCreases {
    pub(crate) creases: Creases,
    /// What is known of the pieces of the field; those that meet smoothly on the surface are one.
    pub(crate) known: Option<KnownPieces>,
}

/// Finds, in slices, the creases of the surface of a field in a box given relative to `origin`.
pub(crate) fn find_creases<'a>(
    field: &'a dyn Field,
    origin: DVec3,
    bounds: &Bounds,
) -> Work<'a, FoundCreases> {
    let bounds = *bounds;
    Box::pin(async move {
        let (outward, width) = (Frame::around(origin).outward(&bounds), Creases::width(&bounds));
        let found = edges::known_in(field, &outward, width).await;
        let Some((cells, known)) = found else { return FoundCreases::default() };
        let function = KnownPieces::of(known.as_ref(), field);
        let creases = if cells.is_empty() {
            Creases::default()
        } else {
            let cells: Vec<Bounds> = cells.iter().map(|cell| cell.relative_to(origin)).collect();
            let unit_cell = function.facts().unit_cell.map(|cell| cell.relative_to(origin));
            let mut evaluator = function.evaluator(frame_for(&function, origin, &bounds));
            let mut memory = ProbeMemory::default();
            let probe = &mut Probe::new(&mut *evaluator, &mut memory);
            Creases::find(probe, &bounds, &cells, unit_cell).await
        };
        FoundCreases { creases, known }
    })
}

/// The frame that scales values and gradients of a field in a box into the range of the numbers
/// they are computed with.
fn frame_for(field: &dyn Field, origin: DVec3, bounds: &Bounds) -> Frame {
    /// Points along each axis: 125 of them, off the faces of the box and its planes of symmetry,
    /// fill one batch.
    const SIDE: usize = 5;
    let frame = Frame { length: bounds.diagonal(), ..Frame::around(origin) };
    let double = precision::double_scale(&mut *field.evaluator(frame), bounds);
    let spread: Vec<Vec3> = bounds.spread(SIDE).map(|p| p.as_vec3()).collect();
    Frame { double, ..frame }.scaled_to(field, spread.into_iter())
}

impl Sampler {
    /// The particles so far. Those of a level under way may be provisional: [`Progress::particles`]
    /// says how many stay. Particles that a coarse front has placed beyond the box are left out.
    #[must_use]
    pub fn particles(&self) -> &Particles {
        self.output.inside.as_ref().unwrap_or(&self.output.particles)
    }

    /// The [`Sampler::particles`], without a copy.
    pub(crate) fn into_particles(self) -> Particles {
        self.output.inside.unwrap_or(self.output.particles)
    }

    /// The mesh of a refined run: triples of particles, counter-clockwise seen from outside, an
    /// oriented manifold whose border lies on the box. It is empty for a front, before the end of
    /// the run, and once the particles are relaxed.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        self.output.corners.as_chunks().0
    }

    /// Counts of the run so far.
    #[must_use]
    pub fn counts(&self) -> Counts {
        let level = self.tools.front.level();
        Counts { fates: level.fates, gaps_filled: level.filled, ..self.counts.clone() }
    }

    /// Energy per particle before the first relaxation step and after each. For uniform sampling it
    /// is Σ s (exp(−d²/2σ²) − exp(−9/2)) over the pairs nearer than 3σ. The factor s is 1 for pairs
    /// whose normals are within 60°, 0 beyond 120°, and ½ + cosine in between.
    #[must_use]
    pub fn energy(&self) -> &[f64] {
        self.tools.relaxation.energy()
    }

    /// Repulsion radius r of the run.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.attempt.radius
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
        let mut doubts = self.components.doubts(self.survey.nearness, self.least_gap());
        let has_creases = self.creases.are_there() || self.creases.bare.is_some();
        doubts.extend(has_creases.then_some(Doubt::Creases));
        doubts
    }

    /// Sheets nearer to each other than this are not told apart.
    fn least_gap(&self) -> f64 {
        self.survey.least_gap(self.settings.sampling == Sampling::Adaptive)
    }

    /// The components that hold particles, and the witnessed ones that do not.
    #[must_use]
    pub fn sampled(&self) -> Sampled {
        self.components.sampled(self.doubts().is_empty())
    }

    /// Number of cells that the proof left undecided on whether they hold the first point of a
    /// component, plus the witnesses for which it could not decide whether their component holds a
    /// particle; `None` if no proof was attempted.
    #[must_use]
    pub fn undecided_cells(&self) -> Option<u64> {
        self.components.open_questions()
    }

    /// Number of points of the surface where f has no gradient, a curve of them counted as one;
    /// `None` if they were not searched for.
    #[must_use]
    pub fn singular_points(&self) -> Option<u64> {
        self.components.open_questions().map(|_| self.singular_places().len() as u64)
    }

    /// The known places of the surface where f has no gradient.
    pub(crate) fn singular_places(&self) -> Vec<SingularPlace> {
        let mut places = singular::places(self.components.singular(), spacing(&self.bounds));
        let passed = self.creases.passed.map(|position| SingularPlace {
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
        self.frame
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
        field: &dyn Field,
        origin: DVec3,
        bounds: &Bounds,
        settings: &Settings,
        creases: Option<Creases>,
    ) -> Result<Forecast, SettingsError> {
        self.settings = *settings;
        self.bounds = *bounds;
        self.output.particles.clear();
        self.output.particles.origin = origin;
        self.output.inside = None;
        self.output.corners = Vec::new();
        self.tools.coarse = CoarseFronts::default();
        self.tools.relaxation.clear();
        self.counts = Counts::default();
        self.tools.memory.evaluations = 0;
        self.look_over(field, creases);
        let field = &mut *field.evaluator(self.frame);
        let wish = self.wish();
        let sizing = (settings.sampling == Sampling::Adaptive).then(|| {
            let probe = &mut Probe::new(field, &mut self.tools.memory);
            Sizing::new(probe, bounds, settings, wish, &self.survey, &self.creases)
        });
        if let Some(Err(error)) = sizing.as_ref().map(Sizing::check) {
            (self.method, self.stop_reason, self.phase) = (None, None, Phase::Idle);
            return Err(error);
        }
        self.counts.seeding_evaluations = self.tools.memory.evaluations;
        self.attempt = Attempt::first(settings, self.survey.area, bounds.diagonal(), sizing);
        if settings.method == Method::Refined {
            let mut curvature = refine::largest_curvatures(field, &self.survey.position);
            for (curvature, &p) in curvature.iter_mut().zip(&self.survey.position) {
                if self.tips.iter().any(|tip| tip.explains(p, *curvature)) {
                    *curvature = 0.0;
                }
            }
            self.counts.refusal = match self.creases.passed {
                Some(at) => Some(Refusal::Singular { at: at.as_vec3().into() }),
                None => {
                    self.attempt.refine(settings, &self.survey.position, curvature, self.creases.are_there())
                }
            };
        }
        let predicted = self.attempt.predicted_count(settings);
        self.components.expect(predicted.min(f64::from(settings.max_particles)));
        if settings.size_mode == SizeMode::Count && settings.count <= settings.max_particles {
            let room = (f64::from(settings.count) * COUNT_ROOM) as u32;
            self.settings.max_particles = settings.max_particles.max(room);
        }
        if !self.has_room_for(Attempt::reserved(predicted, &self.settings)) {
            (self.method, self.stop_reason, self.phase) = (None, None, Phase::Idle);
            return Err(SettingsError::Memory { particles: predicted as u64 });
        }
        self.carry_out(MethodUnderWay::begin(methods::sample), Phase::Seeding);
        let (radius, area) = (self.attempt.radius, self.survey.area);
        Ok(Forecast { radius, predicted_count: predicted as u64, area })
    }

    /// Surveys the field, unless no creases are given and the last survey holds. If the survey
    /// finds no point, the search is completed at once: the area is then estimated by spheres with
    /// the curvature at the points that it finds.
    fn look_over(&mut self, function: &dyn Field, creases: Option<Creases>) {
        // A survey that found nothing by itself is repeated: what was added to it since depends on
        // the run.
        let is_known = self.survey.area > 0.0 && !self.survey.is_adopted;
        let creases = creases.or_else(|| (!is_known).then(|| core::mem::take(&mut self.creases)));
        if let Some(creases) = creases {
            self.singular.clear();
            self.tips.clear();
            self.tools.memory.evaluations += creases.evaluations;
            self.creases = creases;
            self.frame = frame_for(function, self.output.particles.origin, &self.bounds);
            let field = &mut *function.evaluator(self.frame);
            let is_dense = field.bounded().is_none();
            let cells = is_dense.then(|| self.settings.survey_cells.unwrap_or(DENSE_CELLS));
            self.survey = survey(&mut Probe::new(field, &mut self.tools.memory), &self.bounds, cells);
            self.survey.absence = match self.survey.absence {
                Absence::Undefined if precision::overflows_double(field, &self.bounds) => Absence::TooLarge,
                Absence::Constant if precision::varies(field, &self.bounds) => Absence::NotSeen,
                absence => absence,
            };
            // Where f touches zero only, all of the surface is singular.
            if !is_dense && !self.survey.touches {
                self.find_singular_points(&mut Probe::new(field, &mut ProbeMemory::default()));
                let singular = self.singular.clone();
                self.find_bare_place(field, &singular);
            }
        }
        let field = &mut *function.evaluator(self.frame);
        self.components.begin(field, &self.bounds, &self.singular);
        self.components.leave_out_bare(self.bare_place().map(|_| bare_size(spacing(&self.bounds))));
        self.components.expect(0.0);
        if self.survey.area == 0.0 {
            let (tolerance, least_gap) = (self.survey.tolerance(), self.least_gap());
            let probe = &mut Probe::new(field, &mut self.tools.memory);
            while self.components.search(probe, &self.bounds, tolerance, least_gap, u32::MAX) == 0 {}
            let found = self.components.points().iter().map(|seed| (seed.position, seed.normal));
            // Where branches meet, f may be zero on a curve or at a point that has no highest point
            // of either.
            let search = if self.creases.is_open { Search::Searched } else { self.components.witnessed() };
            self.survey.adopt(probe.field, found, &self.bounds, search);
            if self.survey.position.is_empty() {
                let singular = self.components.singular().to_vec();
                self.find_bare_place(field, &singular);
                let is_bare = self.bare_place().is_some();
                self.survey.absence = if is_bare { Absence::Bare } else { self.survey.absence };
            }
        }
        if let (Absence::Bare, Some(place)) = (self.survey.absence, self.bare_place()) {
            let probe = &mut Probe::new(field, &mut self.tools.memory);
            self.survey.level = probe.level_around(place, &self.bounds);
        }
    }

    /// Looks among singular points for a zero of f on a curve or at an isolated point, if none is
    /// known.
    fn find_bare_place(&mut self, field: &mut dyn Evaluator, singular: &[Singular]) {
        if self.bare_place().is_none() {
            let probe = &mut Probe::new(field, &mut self.tools.memory);
            let extrema = singular.iter().filter(|point| !point.has_two_signs);
            let (creases, spacing) = (&self.creases, spacing(&self.bounds));
            let places = extrema.map(|point| point.position);
            let places = places.filter(|&place| !creases.has_corner(place, bare_size(spacing)));
            self.survey.bare = bare_among(probe, places, spacing);
        }
    }

    /// Finds the singular points near the points of the survey, for each patch by itself.
    fn find_singular_points(&mut self, probe: &mut Probe) {
        let spacing = spacing(&self.bounds);
        // Points without a patch come first.
        let mut patches: Vec<Vec<Vec3>> = Vec::new();
        for &p in &self.survey.position {
            let patch = self.creases.are_there().then(|| probe.field.label(p.as_dvec3()));
            let place = patch.map_or(0, |patch| patch as usize + 1);
            patches.resize_with(patches.len().max(place + 1), Vec::new);
            patches[place].push(p);
        }
        for (place, points) in (0_u32..).zip(patches).filter(|(_, points)| !points.is_empty()) {
            let patch = place.checked_sub(1);
            let probe = &mut probe.on(patch);
            let mut near = singular::near_survey(probe.field, &points, spacing, &self.bounds);
            self.find_tips(probe, patch, &near, spacing);
            // At a tip another branch may be zero, too.
            near.points.retain(|point| {
                let is_tip = |tip: &Tip| Some(tip.patch) == patch && tip.position == point.position;
                self.tips.iter().any(is_tip)
                    || probe.is_on_patch(point.position.as_vec3(), Vec3::ZERO, 0.0, patch)
                        && probe.may_have_zeros(patch, &Bounds::point(point.position).enlarged(spacing))
            });
            self.singular.extend_from_slice(&near.points);
        }
    }

    /// Finds the tips among the singular points of a patch, and those near bends where f has no
    /// second derivative.
    fn find_tips(&mut self, probe: &mut Probe, patch: Option<u32>, near: &NearSurvey, spacing: f64) {
        /// Maximum number of bends with a possible jump of the gradient that are examined. Most
        /// surfaces have none; around a tip where f has a gradient they are the sharpest. More take
        /// longer on a much bent surface.
        const MOST: usize = 16;
        for place in singular::places(&near.points, spacing) {
            if place.kind == SingularKind::Point {
                self.tips.extend(Tip::at(probe, patch, place.position, spacing));
            }
        }
        let reach = Tip::REACH * spacing;
        let may_be_tip =
            |bend: &&Bend| singular::may_be_rough(probe.field, &Bounds::point(bend.position).enlarged(reach));
        let bends: Vec<&Bend> = near.bends.iter().filter(may_be_tip).take(MOST).collect();
        for bend in bends {
            let Some(tip) = Tip::near(probe, patch, bend.position, spacing) else { continue };
            let known: Vec<u32> = (self.tips.iter())
                .filter(|known| known.position.distance(tip.position) <= spacing)
                .map(|known| known.patch)
                .collect();
            if !self.bounds.holds(tip.position) || known.contains(&tip.patch) {
                continue;
            }
            // Several patches may have their tips at one point.
            if known.is_empty() {
                self.singular.push(Singular::tip(tip.position, spacing));
            }
            self.tips.push(tip);
        }
    }

    /// Whether f touches zero without changing its sign, so that both sides of the surface are
    /// sampled.
    pub(crate) fn touches(&self) -> bool {
        self.survey.touches
    }

    /// A place where f vanishes only on a curve or at an isolated point, if one was found. At a
    /// corner there is a surface, though the solid may be too thin for f to show it.
    pub(crate) fn bare_place(&self) -> Option<DVec3> {
        let reach = bare_size(spacing(&self.bounds));
        let is_alone = |place: &DVec3| !self.creases.has_corner(*place, reach);
        [self.survey.bare, self.creases.bare].into_iter().flatten().find(is_alone)
    }

    /// Whether no surface was found and none was ruled out: f may have one that is small compared
    /// with the box, or beyond it.
    pub(crate) fn shows_nothing(&self) -> bool {
        let absence = self.survey.absence;
        let is_unseen = matches!(absence, Absence::NotSeen | Absence::Undefined | Absence::Constant);
        is_unseen && self.components.singular().is_empty()
    }

    /// Sets whether the user gave the box of the next run, which messages depend on.
    pub(crate) fn set_box_given(&mut self, is_given: bool) {
        self.is_box_given = is_given;
    }

    /// Whether the search for components was left undecided in a box where f overflows double
    /// precision in places.
    pub(crate) fn is_open_by_overflow(&self, field: &dyn Field) -> bool {
        self.undecided_cells().is_some_and(|cells| cells > 0)
            && precision::overflows_double(&mut *field.evaluator(self.frame), &self.bounds)
    }

    /// The particle that rounding in double precision moves most, if by more than a particle may
    /// lie off the surface.
    pub(crate) fn blur(&self, field: &dyn Field) -> Option<Blur> {
        precision::blur(&mut *field.evaluator(self.frame), &self.output.particles)
    }

    /// Sets the spacing of the next start, whose settings must be adaptive, and whether sizes also
    /// follow the curvature.
    pub(crate) fn set_spacing(&mut self, spacing: Option<(Spacing, bool)>) {
        self.spacing = spacing;
    }

    /// The wanted spacing, in the frame of the run.
    fn wish(&self) -> Option<Wish> {
        let (spacing, bends) = self.spacing.clone()?;
        Some(Wish { spacing, bends, origin: self.frame.origin })
    }

    /// Where the slope keeps the radius of the start below the one that a spacing asks for.
    pub(crate) fn smoothing(&self) -> Option<Smoothing> {
        self.attempt.sizing.as_ref()?.smoothing()
    }

    /// Refuses runs that need more than about `bytes` from now on.
    pub fn limit_memory(&mut self, bytes: usize) {
        self.memory_limit = Some(bytes);
    }

    /// Whether there is memory for a run of `particles`. It is allocated at once and freed again,
    /// because an allocation that fails in the middle of a run cannot be caught.
    fn has_room_for(&self, particles: usize) -> bool {
        let bytes = |particles: usize| particles.checked_mul(bytes_per_particle(&self.settings));
        let more = particles.saturating_sub(self.output.particles.local.capacity());
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
    /// does them. Returns whether there are particles to relax; if not, nothing has changed.
    #[must_use]
    pub fn relax(&mut self, steps: u32) -> bool {
        let can_relax = self.stop_reason.is_some() && self.output.particles.len() > 1;
        if can_relax {
            self.settings.relax_steps = self.tools.relaxation.steps_done() + steps;
            self.begin_relaxation();
            self.carry_out(MethodUnderWay::begin(methods::relax_further), Phase::Relaxation);
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
        field: &dyn Field,
        bounds: &Bounds,
        is_closed: bool,
    ) -> Result<(), FollowError> {
        let particles = &self.output.particles;
        // A front that was stopped has not covered the surface.
        let covers = match (self.phase, self.stop_reason) {
            (Phase::Done, reason) => reason == Some(StopReason::Complete) || !particles.identity.is_empty(),
            // An unfinished frame: the next one continues from where the particles are.
            (Phase::Flow, _) => true,
            (Phase::Idle, _) => false,
            _ => return Err(FollowError::UnderWay),
        };
        if !covers || particles.len() < 2 {
            return Err(FollowError::NotCovered);
        }
        let mut evaluator = field.evaluator(self.frame);
        let has_several =
            |patches: &mut dyn Pieces| patches.labels_in(bounds).is_none_or(|all| all.len() > 1);
        let is_smooth = particles.patch.is_empty() && !self.creases.are_there();
        if !is_smooth || evaluator.pieces().is_some_and(has_several) {
            return Err(FollowError::Creased);
        }
        let is_leap = flow::is_leap(&mut *evaluator, particles, self.attempt.radius)?;
        self.tools.flow.begin(&mut self.output.particles);
        if is_leap {
            self.tools.flow.leap();
        }
        self.tools.flow.is_closed = is_closed;
        self.bounds = *bounds;
        if self.tools.flow.is_due() {
            self.look_again(field);
        }
        self.carry_out(MethodUnderWay::begin(methods::follow), Phase::Flow);
        Ok(())
    }

    /// Surveys a surface that has moved. The packing stays as measured; proofs about the surface
    /// before no longer hold.
    fn look_again(&mut self, function: &dyn Field) {
        let bounds = &{ self.bounds };
        let frame = frame_for(function, self.output.particles.origin, bounds);
        let field = &mut *function.evaluator(frame);
        let wish = self.wish();
        let probe = &mut Probe::new(field, &mut self.tools.memory);
        let seen = survey(probe, bounds, None);
        if seen.area == 0.0 {
            // What remains is not seen on the grid.
            return;
        }
        (self.survey, self.frame) = (seen, frame);
        let sizing = (self.settings.sampling == Sampling::Adaptive)
            .then(|| Sizing::new(probe, bounds, &self.settings, wish, &self.survey, &self.creases));
        let (area, growth) = (self.survey.area, self.tools.flow.growth());
        self.attempt.move_on(&self.settings, area, bounds.diagonal(), sizing, growth);
        self.components.begin(field, bounds, &[]);
        self.plan = self.attempt.front(&self.settings, bounds);
        self.tools.front.reset(&self.plan, &self.survey, 0);
        if self.attempt.sizing.is_none() {
            self.output.particles.radius.fill(self.attempt.radius as f32);
        }
    }

    /// Makes a method the one under way.
    fn carry_out(&mut self, method: MethodUnderWay, phase: Phase) {
        (self.method, self.stop_reason, self.phase) = (Some(method), None, phase);
        self.output.fraction = 0.0;
    }

    /// Ends the run where it is; the particles placed so far stay. The next step tidies up, even if
    /// its budget is 0.
    pub fn cancel(&mut self) {
        self.output.inside = None;
        if let Some(method) = &mut self.method {
            method.stop();
        }
    }

    /// Does up to `budget` units of work: a particle's slots, a child's projection, a particle's
    /// share of a relaxation step. Returns early when the search or the relaxation begins, and now
    /// and then during both, so that the caller can show the particles.
    pub fn step(&mut self, field: &dyn Field, budget: u32) -> Progress {
        let field = &mut *field.evaluator(self.frame);
        let mut memory = core::mem::take(&mut self.tools.memory);
        let probe = &mut Probe::new(field, &mut memory);
        let mut left = budget;
        while let Some(method) = &mut self.method {
            match method.request(left) {
                Request::Slice(slice) => slice(self, probe, &mut left),
                Request::Step => break,
                Request::End(reason) => {
                    (self.method, self.stop_reason, self.phase) = (None, Some(reason), Phase::Done);
                }
            }
        }
        self.tools.memory = memory;
        // The refinement makes new particles.
        self.output.particles.origin = self.frame.origin;
        self.look_inside();
        let progress = self.progress();
        (self.output.moved, self.output.fraction) = (false, progress.fraction);
        progress
    }

    /// Finds the particles to be shown of a front that marches beyond the box.
    fn look_inside(&mut self) {
        let is_marching = match self.phase {
            Phase::Seeding | Phase::Generation | Phase::Search => self.attempt.refining.is_some(),
            _ => false,
        };
        let settled = self.settled();
        let is_beyond = |p: &Vec3| !self.bounds.contains(*p);
        self.output.inside = None;
        if !is_marching || !self.output.particles.local[..settled].iter().any(is_beyond) {
            return;
        }
        let mut inside = self.output.particles.clone();
        inside.truncate(settled);
        inside.keep_within(&self.bounds);
        self.output.inside = Some(inside);
    }
}
