//! A run: one field, sampled in one box, from the first survey to particles, report and mesh.
//!
//! This is the door of the crate. [`sample`] is the whole job in one call. A [`Run`] is the same in
//! steps, for a caller that shows progress, cancels, relaxes further or measures in slices. What
//! either leads to is a [`Sample`].

mod check;
mod jumps;
mod measuring;
mod mesh;
mod plan;
mod report;
mod sample;
mod severity;
mod warning;

pub use measuring::Measured;
pub use mesh::{MeshAnswer, MeshComponent};
pub use report::{Cut, Growth, Measures, Proof, Radii, Report, Reporting};
pub use sample::{Sample, sample};
pub use severity::Severity;
pub use warning::Warning;

use crate::differential::{self, Curvature};
use crate::extent::{self, Reach};
use crate::field::{Creased, Evaluator, Field, FieldError, Frame, IntoField};
use crate::math::Bounds;
use crate::particles::Particles;
use crate::quality;
use crate::sampler::{
    self, FollowError, FoundCreases, Phase, Progress, Sampler, Settings, SettingsError, StopReason,
    bytes_per_particle,
};
use crate::slices::{self, Work};
use core::fmt::{self, Debug, Formatter};
use glam::DVec3;
use measuring::Measuring;
use mesh::Meshing;
use plan::{Plan, Shares};
use serde::Serialize;
use std::sync::Arc;

/// Bytes of a particle that is kept after the front: its position, normal and radius.
const KEPT_BYTES: usize = 12 + 12 + 4;
/// Bytes per particle that a report takes while it is made, in WebAssembly, whose memory never
/// shrinks: with the bytes kept and those of the sampler these are the 425 by which that of a front
/// and its report grows from 100,000 to 400,000 particles of an ellipsoid. Of a gyroid it is 433,
/// with sizes that differ 415, and refined 333; natively 378 are resident at the peak.
const REPORT_BYTES: usize = 302;

/// Why there is no sample of a surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A setting or the box is out of its range, or the memory does not hold the particles.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// No box was given, and none was found: f changes its sign nowhere on the grids that were laid
    /// over cubes around the origin. A surface that is smaller than their cells, or farther away,
    /// needs its box: [`Settings::in_box`].
    #[error("{} (`Settings::in_box`)", no_box(halves, *cells, *defined))]
    NoBox {
        /// Half-widths of the cubes, the largest first.
        halves: &'static [f64],
        /// Cells along each side of a cube.
        cells: usize,
        /// Share of the nodes of the grids at which f has a value.
        defined: f64,
    },
    /// A function of the program has failed: its error.
    #[error("the function that is sampled has failed: {0}")]
    Field(FieldError),
    /// The run was ended before its first particle: nothing is known of the surface.
    #[error("the run was ended before its first particle was placed: let it go on, or start it again")]
    Cancelled,
    /// No particle could be placed.
    #[error("{message}")]
    Nothing {
        /// Why the run ended.
        reason: StopReason,
        /// The reason and the remedy, in a sentence.
        message: String,
    },
}

/// Why no box was found, up to how to give one.
fn no_box(halves: &[f64], cells: usize, defined: f64) -> String {
    let (smallest, largest) = (halves[halves.len() - 1], halves[0]);
    let grids = format!(
        "grids of {cells} cells a side over cubes around the origin, from \u{b1}{smallest} to \u{b1}{largest}"
    );
    if defined == 0.0 {
        return format!(
            "no box was given, and f has no value at any node of {grids}: a surface in a small region where f has one needs its box"
        );
    }
    let where_defined = if defined < 1.0 {
        format!(" between the {:.2} % of the nodes at which it has a value", 100.0 * defined)
    } else {
        String::new()
    };
    format!(
        "no box was given, and on {grids}, f changes its sign nowhere{where_defined}: a surface that is smaller than the cells or farther \
         away needs its box"
    )
}

/// Report on the start of a run: the radius, estimates and warnings.
#[derive(Clone, Debug, Default, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Start {
    /// Repulsion radius of the run, in the units of the field's coordinates.
    pub radius: f64,
    /// Number of particles to expect.
    pub predicted_count: u64,
    /// Estimated area of the surface in the box.
    pub area: f64,
    /// Warnings that are known before the first particle is placed.
    #[cfg_attr(test, ts(as = "Vec<warning::Told>"))]
    pub warnings: Vec<Warning>,
}

/// What the sampler knows of the present field and box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Known {
    Nothing,
    /// The particles, which have followed the surface.
    Particles,
    /// The survey of the last start, too.
    Survey,
}

/// The sampling of one surface, in steps.
///
/// A run owns its field, or borrows it where `F` is a reference. A budget is a count of work, never
/// a time: however a run is cut into steps, its particles are the same to the last bit.
///
/// ```
/// use marching_particles::{Formula, Run, Settings};
///
/// let surface = Formula::parse("x^2 + y^2 + z^2 = 1")?;
/// let mut run = Run::start(surface, &Settings::with_count(500))?;
/// let mut progress = run.step(100);
/// while progress.stop_reason.is_none() {
///     assert!(progress.fraction <= 1.0);
///     progress = run.step(100);
/// }
/// let sample = run.finish()?;
/// assert_eq!(sample.report().proof.components, 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Run<F> {
    field: RunField<F>,
    /// The clip box, in the coordinates of the field.
    bounds: Bounds,
    /// Whether the surface is bounded, if its box was fitted; none if the box was given.
    reach: Option<Reach>,
    sampler: Sampler,
    known: Known,
    /// The creases of the surface in the box, if they were found before the start.
    creases: Option<FoundCreases>,
    /// Limit on the number of particles: a run that expects more is refused.
    most_particles: usize,
    /// The report on the start.
    start: Start,
    last: Option<Progress>,
    /// The plan that fractions are shares of.
    plan: Plan,
    measuring: Measuring,
    meshing: Meshing,
}

/// The field of a run.
struct RunField<F> {
    given: F,
    /// Calls of its functions before this run.
    calls: u64,
    /// The function that is sampled in its place, see [`FoundCreases::function`].
    creased: Option<Arc<dyn Creased>>,
}

impl<F: Field> RunField<F> {
    fn new(given: F) -> Self {
        Self { calls: given.calls().unwrap_or(0), given, creased: None }
    }

    /// Calls of its functions by this run.
    fn calls(&self) -> Option<u64> {
        self.given.calls().map(|calls| calls - self.calls)
    }

    fn function(&self) -> &dyn Field {
        self.creased.as_ref().map_or(&self.given, |creased| creased)
    }

    /// This field with another one in its place, of whose branches is known what is known of those
    /// of this one.
    fn followed_by(&self, given: F) -> Self {
        let both = given.creased().zip(self.creased.as_deref());
        let creased = both.map(|(given, known)| given.with_branches_of(known));
        Self { creased, ..Self::new(given) }
    }
}

impl<F> Debug for Run<F> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_struct("Run").field("bounds", &self.bounds).field("last", &self.last).finish_non_exhaustive()
    }
}

impl<F: Field> Run<F> {
    /// Starts a run on the surface of `field`: in the box of the settings, or in one that fits the
    /// surface.
    ///
    /// The start surveys the box and fixes the radius. A fitted box is found by bounds of the field
    /// where it has any, and by the signs of f on grids where it has none, with some hundred
    /// thousand evaluations: [`FnField`](crate::FnField) says what these can miss.
    ///
    /// # Errors
    ///
    /// If a setting or the box is out of its range, the memory does not hold the particles to
    /// expect, or a function of the program fails.
    pub fn start<Kind>(field: impl IntoField<Kind, Field = F>, settings: &Settings) -> Result<Self, Error> {
        settings.validate()?;
        let field = RunField::new(field.into_field());
        let (bounds, reach) = match settings.bounds {
            Some(bounds) => (bounds, None),
            None => {
                let extent = extent::find(&field.given);
                (extent.with_room(|bounds| settings.largest_share(bounds)), Some(extent.reach))
            }
        };
        let mut run = Self { reach, ..Self::of(field, bounds) };
        let begun = run.begin(settings);
        run.check_field()?;
        begun?;
        Ok(run)
    }

    /// A run that has not begun.
    pub(crate) fn idle(field: F, bounds: Bounds) -> Self {
        Self::of(RunField::new(field), bounds)
    }

    fn of(field: RunField<F>, bounds: Bounds) -> Self {
        Self {
            field,
            bounds,
            reach: None,
            sampler: Sampler::default(),
            known: Known::Nothing,
            creases: None,
            most_particles: usize::MAX,
            start: Start::default(),
            last: None,
            plan: Plan::default(),
            measuring: Measuring::default(),
            meshing: Meshing::default(),
        }
    }

    /// Begins a run in the present box; the survey is kept if field and box are those of the last
    /// start.
    pub(crate) fn begin(&mut self, settings: &Settings) -> Result<Start, SettingsError> {
        settings.validate()?;
        self.bounds.check()?;
        let settings = &settings.in_shares_of(&self.bounds)?;
        self.sampler.limit_memory(self.most_particles.saturating_mul(bytes_per_particle(settings)));
        self.sampler.set_box_given(self.reach.is_none());
        let origin = self.bounds.local_origin();
        let bounds = self.bounds.relative_to(origin);
        let is_surveyed =
            self.known == Known::Survey && self.sampler.settings().survey_cells == settings.survey_cells;
        let creases = (!is_surveyed).then(|| {
            let known = self.creases.take();
            let search = || slices::complete(sampler::find_creases(&self.field.given, origin, &bounds));
            let FoundCreases { creases, function } = known.unwrap_or_else(search);
            self.field.creased = function;
            creases
        });
        let start = self.sampler.begin(self.field.function(), origin, &bounds, settings, creases)?;
        self.known = Known::Survey;
        self.last = None;
        self.measuring = Measuring::default();
        self.meshing = Meshing::default();
        let sampler::Forecast { radius, predicted_count, area } = start;
        let warnings = self.known_at_start(predicted_count, settings.max_particles);
        self.start = Start { radius, predicted_count, area, warnings };
        Ok(self.start.clone())
    }

    /// Starts anew with other settings. The survey is kept, unless the settings name another box.
    ///
    /// # Errors
    ///
    /// The errors of [`Run::start`].
    pub fn restart(&mut self, settings: &Settings) -> Result<Start, Error> {
        if let Some(bounds) = settings.bounds.filter(|bounds| *bounds != self.bounds) {
            self.set_bounds(bounds, None);
        }
        Ok(self.begin(settings)?)
    }

    /// Says what the caller is going to do once the run has ended, measure and [join](Run::join)
    /// the particles, so that [`Progress::fraction`], [`Run::fraction`] and [`Reporting::fraction`]
    /// are shares of all of it. Without a plan they are shares of the run alone.
    pub fn plan(&mut self, measured: Measured, is_joined: bool) {
        self.plan = Plan { measured, is_joined };
    }

    /// Estimated share of the work that is done: of the run and of what is [planned](Run::plan).
    #[must_use]
    pub fn fraction(&self) -> f64 {
        let shares = self.shares();
        let run = self.last.as_ref().map_or(0.0, |progress| progress.fraction);
        run + shares.measuring * self.measuring.fraction() + shares.mesh * self.meshing.fraction()
    }

    /// The shares of a call by the plan.
    fn shares(&self) -> Shares {
        self.plan.shares(self.sampler.settings().method)
    }

    /// Does up to `budget` units of work: a particle's slots, a child's projection, a particle's
    /// share of a relaxation step. It returns early now and then, so that a caller can show the
    /// particles. The run has ended when [`Progress::stop_reason`] is set: it is
    /// [cancelled](StopReason::Cancelled) where a function of the program [has
    /// failed](Run::check_field).
    pub fn step(&mut self, budget: u32) -> Progress {
        let progress = self.sampler.step(self.field.function(), budget);
        if self.field.given.failure().is_some() && progress.stop_reason.is_none() {
            return self.cancel();
        }
        if progress.phase == Phase::Relaxation && progress.relax_step == 0 && progress.relax_steps > 0 {
            self.measuring.keep_front(self.sampler.particles(), progress.rows);
        }
        self.remember(progress)
    }

    /// Has the particles of a finished run follow its surface to that of `field`, in the same box,
    /// which has moved but little; [`Run::step`] does it. Each call is a frame of a motion: the
    /// transport of the particles, births and deaths where they become sparse or crowd, and a step
    /// of relaxation. The same sequence of fields gives the same particles to the last bit.
    ///
    /// The box stays what it is: one that was fitted to the first surface cuts what grows out of
    /// it, which the report says ([`Cut::Outgrown`]).
    ///
    /// The order of the fronts is lost where particles are born and die; those of a refined run
    /// move with its mesh, and keep theirs, until the surface tears or joins. Components are no
    /// longer searched beyond a survey.
    ///
    /// # Errors
    ///
    /// If the particles cannot follow: the error says why, and what to do. The run is then as if
    /// this had not been called, with its field.
    ///
    /// ```
    /// use marching_particles::{Bounds, Formula, Run, Settings};
    ///
    /// let ellipsoid = |a: f64| Formula::parse("x^2/a^2 + y^2 + z^2 = 1").and_then(|formula| formula.with("a", a));
    /// let mut run = Run::start(ellipsoid(1.0)?, &Settings::with_count(1_000).in_box(Bounds::cube(1.5)))?;
    /// while run.step(u32::MAX).stop_reason.is_none() {}
    /// for frame in 1..=10 {
    ///     run.follow(ellipsoid(1.0 + 0.01 * f64::from(frame))?)?;
    ///     while run.step(u32::MAX).stop_reason.is_none() {}
    /// }
    /// // Most of the particles are those of the beginning.
    /// assert!(run.particles().identity.iter().filter(|&&number| number < 1_000).count() > 900);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn follow(&mut self, field: F) -> Result<(), FollowError> {
        let next = self.field.followed_by(field);
        let before = core::mem::replace(&mut self.field, next);
        let followed = self.follow_field(false);
        if followed.is_err() {
            self.field = before;
        }
        followed
    }

    /// [`Run::follow`] to the surface of the field that the run has, in its box: both may have
    /// changed since the last step. `is_closed`: no particle is born, and none dies but where it
    /// does not come to the surface.
    pub(crate) fn follow_field(&mut self, is_closed: bool) -> Result<(), FollowError> {
        let bounds = self.local_bounds();
        self.sampler.follow(self.field.function(), &bounds, is_closed)?;
        self.known = Known::Particles;
        self.creases = None;
        self.remember(self.sampler.progress());
        Ok(())
    }

    /// Asks for more relaxation steps on the particles of a run that has ended; [`Run::step`] does
    /// them. Returns whether there are particles to relax: while the run is under way there are
    /// none, and its steps are those of its [settings](Settings::relax_steps).
    #[must_use]
    pub fn relax(&mut self, steps: u32) -> bool {
        let can_relax = self.known != Known::Nothing && self.sampler.relax(steps);
        if can_relax {
            let progress = self.sampler.progress();
            self.remember(progress);
        }
        can_relax
    }

    /// Ends the run where it is; the particles placed so far stay.
    pub fn cancel(&mut self) -> Progress {
        self.sampler.cancel();
        // Marks the particles next to singular points.
        let progress = self.sampler.step(self.field.function(), 0);
        self.remember(progress)
    }

    fn remember(&mut self, mut progress: Progress) -> Progress {
        self.forget_results();
        progress.fraction *= self.shares().run;
        if progress.stop_reason == Some(StopReason::Constant)
            && let (Some(message), Some(cause)) =
                (&mut progress.message, self.field.given.facts().why_constant)
        {
            *message = format!("{message} {cause}");
        }
        self.last = Some(progress.clone());
        progress
    }

    /// Drops a measurement under way and the mesh: they are of other particles, or of another
    /// field.
    fn forget_results(&mut self) {
        self.measuring.stop();
        self.meshing = Meshing::default();
    }

    /// Measures the particles and makes a [`Sample`] of the run, where it stands.
    ///
    /// # Errors
    ///
    /// If there is no particle, or a function of the program has failed: the error says why. A run
    /// that was ended before its first particle is [`Error::Cancelled`].
    pub fn finish(self) -> Result<Sample, Error> {
        self.finish_with(Measured::Particles)
    }

    /// [`Run::finish`], with other particles measured, or none: measuring can take longer than
    /// sampling.
    ///
    /// # Errors
    ///
    /// The error of [`Run::finish`].
    pub fn finish_with(mut self, measured: Measured) -> Result<Sample, Error> {
        self.check_not_empty()?;
        let mut report = self.report_with(measured);
        if self.measuring.measured.opening.is_some() {
            // Only the field can say which of the gaps are surface.
            slices::in_pool(|| while self.join(u32::MAX).is_none() {});
            report = self.reported();
        }
        self.check_field()?;
        Ok(Sample::new(self, report))
    }

    /// The error of a function of the program that has failed. The run has ended then, and its
    /// particles are those of before.
    ///
    /// # Errors
    ///
    /// [`Error::Field`], if it has.
    pub fn check_field(&self) -> Result<(), Error> {
        self.field.given.failure().map_or(Ok(()), |error| Err(Error::Field(error)))
    }

    /// Returns the reason if there is no particle, or its field has failed.
    pub(crate) fn check_not_empty(&mut self) -> Result<(), Error> {
        self.check_field()?;
        if self.count() > 0 {
            return Ok(());
        }
        let progress = self.last.clone().unwrap_or_else(|| self.sampler.progress());
        let Some(reason) = progress.stop_reason.filter(|reason| *reason != StopReason::Cancelled) else {
            return Err(Error::Cancelled);
        };
        if self.reach == Some(Reach::Unknown) && self.sampler.shows_nothing() {
            let defined = extent::defined_share(&mut *self.field.given.evaluator(Frame::default()));
            return Err(Error::NoBox { halves: &extent::HALVES, cells: extent::CELLS, defined });
        }
        let mut message = progress.message.unwrap_or_else(|| "no particle could be placed".to_owned());
        if let Some(cause) =
            self.start.warnings.iter().find(|warning| matches!(warning, Warning::Gradient { .. }))
        {
            message = format!("{message} {cause}");
        }
        Err(Error::Nothing { reason, message })
    }

    /// The particles so far; of a generation level under way, the columns may hold provisional rows
    /// beyond [`Run::rows`].
    #[must_use]
    pub fn particles(&self) -> &Particles {
        self.sampler.particles()
    }

    /// Number of particles that will stay.
    #[must_use]
    pub fn count(&self) -> usize {
        self.last.as_ref().map_or(0, |progress| progress.particles)
    }

    /// Rows of the columns that will stay: more than there are particles where some lie on creases,
    /// with a row on each side.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.last.as_ref().map_or(0, |progress| progress.rows)
    }

    /// The clip box, in the coordinates of the field as it was given.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Returns whether the surface is bounded, if its box was fitted; none if the box was given.
    #[must_use]
    pub fn reach(&self) -> Option<Reach> {
        self.reach
    }

    /// The report on the start of the run.
    #[must_use]
    pub fn start_report(&self) -> &Start {
        &self.start
    }

    /// The state after the last step; none before the first.
    #[must_use]
    pub fn progress(&self) -> Option<&Progress> {
        self.last.as_ref()
    }

    /// The field, as it was given.
    #[must_use]
    pub fn field(&self) -> &F {
        &self.field.given
    }

    /// An evaluator of the field in the frame of the particles: places are counted from their
    /// origin. It knows the patches of the surface.
    #[must_use]
    pub fn evaluator(&self) -> Box<dyn Evaluator + '_> {
        self.field.function().evaluator(self.sampler.frame())
    }

    /// Ends the run and returns the field.
    #[must_use]
    pub fn into_field(self) -> F {
        self.field.given
    }

    /// Refuses, from now on, runs that need more than about `bytes` with the report on them.
    pub fn limit_memory(&mut self, bytes: usize) {
        // A refined run takes more than a front does, but before the report is made it has given
        // most of that back.
        let with_report = bytes_per_particle(&Settings::DEFAULT) + KEPT_BYTES + REPORT_BYTES;
        self.most_particles = bytes / with_report;
    }

    /// Principal curvatures (κ₁, κ₂) at the particles from `from` on, in inverse units of length;
    /// NaN where the surface has none.
    pub fn curvatures(&self, from: usize) -> Vec<[f32; 2]> {
        let count = self.rows();
        let positions = &self.sampler.particles().local[from.min(count)..count];
        let mut curvatures = vec![Curvature::default(); positions.len()];
        let field = &mut *self.evaluator();
        differential::curvatures(field, positions, &mut curvatures);
        curvatures.iter().map(|curvature| [curvature.k1, curvature.k2]).collect()
    }

    /// The measurements of the last report, in columns with a value for each particle.
    #[must_use]
    pub fn measured(&self) -> &quality::Measurements {
        &self.measuring.measured
    }

    /// The sampler, for what the report leaves out.
    #[doc(hidden)]
    #[must_use]
    pub fn sampler(&self) -> &Sampler {
        &self.sampler
    }

    /// Ends the run and returns its sampler, with the method where it is.
    #[doc(hidden)]
    #[must_use]
    pub fn into_sampler(self) -> Sampler {
        self.sampler
    }

    /// The clip box, counted from the origin of the particles.
    pub(crate) fn local_bounds(&self) -> Bounds {
        self.bounds.relative_to(self.particles().origin)
    }

    /// Takes another box for the next start, which ends a run in the one before.
    pub(crate) fn set_bounds(&mut self, bounds: Bounds, reach: Option<Reach>) {
        self.reach = reach;
        if bounds != self.bounds {
            self.bounds = bounds;
            self.creases = None;
            self.end();
        }
    }

    /// Takes another field for the next start. The particles stay until then. A field that
    /// `is_same` gives the same surface: the survey stays good.
    pub(crate) fn set_field(&mut self, field: F, is_same: bool) {
        if !is_same {
            self.end();
        }
        self.field = self.field.followed_by(field);
        self.measuring.stop();
        self.creases = None;
    }

    /// Whether the next start has nothing to find out about the creases of the surface.
    pub(crate) fn knows_creases(&self) -> bool {
        self.known == Known::Survey || self.creases.is_some()
    }

    /// Finds the creases of the surface in the box, in slices, for [`Run::know_creases`].
    pub(crate) fn find_creases(&self) -> Work<'static, FoundCreases>
    where
        F: Clone + 'static,
    {
        let (field, origin) = (self.field.given.clone(), self.bounds.local_origin());
        let bounds = self.bounds.relative_to(origin);
        Box::pin(async move { sampler::find_creases(&field, origin, &bounds).await })
    }

    /// Takes the creases of the surface for the next start.
    pub(crate) fn know_creases(&mut self, found: FoundCreases) {
        self.creases = Some(found);
    }

    /// Ends the run on a field or a box that is about to change: nothing that the sampler knows of
    /// them holds any more.
    fn end(&mut self) {
        if self.known != Known::Nothing {
            self.known = Known::Nothing;
            self.cancel();
        }
    }

    /// The place of a point that is counted from the origin of the particles.
    fn place(&self, position: [f64; 3]) -> [f64; 3] {
        (self.particles().origin + DVec3::from_array(position)).to_array()
    }
}
