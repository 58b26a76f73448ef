//! A run: one field, sampled in one box, from the first survey to particles, report and mesh.
//!
//! This is the entry of the crate. [`sample`] does the whole job in one call. A [`Run`] does the
//! same in steps, for a caller that shows progress, cancels, relaxes further or measures in slices.
//! The result of either is a [`Sample`].

mod check;
mod jumps;
mod measuring;
mod mesh;
mod plan;
mod record;
mod report;
mod sample;
mod severity;
mod solid;
mod state;
mod values;
mod warning;

pub use measuring::Measured;
pub use mesh::{MeshAnswer, MeshComponent};
pub use report::{Cut, EdgeSearch, Growth, Measures, Proof, Radii, Report, Reporting};
pub use sample::{Sample, sample};
pub use severity::Severity;
pub use values::ValueError;
pub use warning::Warning;

#[doc(hidden)]
pub use record::{FileRecord, SpacingText, ValueText};
#[doc(hidden)]
pub use solid::{BeyondPoints, BoxCell, BoxFaces, BoxMode, SolidSettings};

pub(crate) use record::NamedSurface;

pub use crate::extent::Reach;
pub use crate::field::Value;
pub use crate::math::BoxError;

use crate::differential::{self, Curvature};
use crate::field::edges::KnownPieces;
use crate::field::{Evaluator, Field, FieldError, IntoField};
use crate::math::Bounds;
use crate::particles::Particles;
use crate::quality;
use crate::sampler::{
    self, FollowError, FoundCreases, Progress, Sampler, Settings, SettingsError, SpacedSettings, Spacing,
    StopReason, bytes_per_particle,
};
use crate::slices::Work;
use core::fmt::{self, Debug, Formatter};
use measuring::Measuring;
use mesh::Meshing;
use plan::Plan;
use serde::Serialize;
use std::sync::Arc;

/// Bytes of a particle that is kept after the front: its position, normal and radius.
const KEPT_BYTES: usize = 12 + 12 + 4;
/// Bytes per particle that a report takes while it is made, in WebAssembly, whose memory never
/// shrinks. With the bytes kept and the sampler's it makes 425: the memory of a front with its
/// report grows by as many bytes per particle from 100,000 to 400,000 particles of an ellipsoid. On
/// a gyroid it grows by 433, with varying sizes by 415, refined by 333; natively the peak is 378.
const REPORT_BYTES: usize = 302;

/// Why there is no sample of a surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A setting or the box is out of its range, or there is no memory for the particles.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// No box was given, and none was found: f never changes its sign on grids over cubes around
    /// the origin. A surface that is smaller than their cells, or farther away, needs a box:
    /// [`Settings::in_box`].
    #[error("{} (`Settings::in_box`)", no_box(halves, *cells, *defined))]
    NoBox {
        /// Half-widths of the cubes, the largest first.
        halves: &'static [f64],
        /// Cells along each side of a cube.
        cells: usize,
        /// Share of the nodes of the grids at which f is defined.
        defined: f64,
    },
    /// A function of the program has failed with this error.
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

/// Why no box was found; how to give one follows.
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
    /// Expected number of particles.
    pub predicted_count: u64,
    /// Estimated area of the surface in the box.
    pub area: f64,
    /// Warnings that are known before the first particle is placed.
    #[cfg_attr(test, ts(as = "Vec<warning::Told>"))]
    pub warnings: Vec<Warning>,
}

/// How much the sampler knows of the present field and box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Known {
    Nothing,
    /// The particles, which have followed the surface.
    Particles,
    /// Also the survey of the last start.
    Survey,
}

/// The state of a run, without its field. Every call lends it the field, whatever its type, so that
/// this code is compiled only once.
struct RunState<'f> {
    field: FieldState,
    /// The clip box, in the coordinates of the field.
    bounds: Bounds,
    /// Whether the surface is bounded, if its box was fitted; none if the box was given.
    reach: Option<Reach>,
    sampler: Sampler<'f>,
    known: Known,
    /// The creases of the surface in the box, if they were found before the start.
    creases: Option<FoundCreases>,
    /// The spacing that the next run takes from a function; none if the settings give the sizes.
    spacing: Option<Spacing>,
    /// Why the particles of a finished run do not have that spacing.
    spacing_error: Option<SettingsError>,
    /// Limit on the number of particles: a run that expects more is refused.
    most_particles: usize,
    /// The report on the start.
    start: Start,
    /// The record of the start; none if a record cannot hold the surface or the spacing, or if the
    /// particles have followed a moving surface.
    made: Option<FileRecord>,
    last: Option<Progress>,
    /// The plan that fractions refer to.
    plan: Plan,
    measuring: Measuring<'f>,
    meshing: Meshing,
}

/// Facts about the field of a run.
#[derive(Clone, Default)]
struct FieldState {
    /// Calls of the program's functions before this run.
    calls: u64,
    /// The pieces found, if the field has edges.
    pieces: Option<KnownPieces>,
}

/// The sampling of one surface, in steps.
///
/// A run owns its field, or borrows it for `'f` where `F` is a reference: the run of a field that
/// borrows nothing is a `Run<'static, F>`. A budget is a count of work, never a time: however a run
/// is cut into steps, its particles are the same to the last bit.
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
pub struct Run<'f, F> {
    /// The field, as it was given.
    field: Arc<F>,
    state: RunState<'f>,
}

/// A field of whatever type, shared with the methods that evaluate it.
fn shared<'f, F: Field + 'f>(field: &Arc<F>) -> Arc<dyn Field + 'f> {
    Arc::<F>::clone(field)
}

impl<F> Debug for Run<'_, F> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_struct("Run")
            .field("bounds", &self.state.bounds)
            .field("last", &self.state.last)
            .finish_non_exhaustive()
    }
}

impl<'f, F: Field + 'f> Run<'f, F> {
    /// Starts a run on the surface of `field`, in the box of the settings or in one that fits the
    /// surface.
    ///
    /// The start surveys the box and fixes the radius. A fitted box is found by bounds of the field
    /// if it has any, otherwise by the signs of f on grids, with some hundred thousand evaluations:
    /// [`FnField`](crate::field::FnField) says what these can miss.
    ///
    /// # Errors
    ///
    /// If a setting or the box is out of its range, there is no memory for the expected particles,
    /// or a function of the program fails.
    pub fn start<Kind, S>(field: impl IntoField<Kind, Field = F>, settings: &S) -> Result<Self, Error>
    where
        SpacedSettings: for<'a> From<&'a S>,
    {
        let SpacedSettings { settings, spacing } = SpacedSettings::from(settings);
        settings.validate()?;
        let field = Arc::new(field.into_field());
        let state = RunState::started(&shared(&field), &settings, spacing)?;
        Ok(Self { field, state })
    }

    /// A run that has not begun.
    pub(crate) fn idle(field: F, bounds: Bounds) -> Self {
        Self { state: RunState::new(&field, bounds), field: Arc::new(field) }
    }

    /// Begins a run in the present box; the survey is kept if field and box are those of the last
    /// start. `named` is the surface as its record names it, if a record can.
    pub(crate) fn begin(
        &mut self,
        settings: &Settings,
        named: Option<NamedSurface>,
    ) -> Result<Start, SettingsError> {
        self.state.begin(&shared(&self.field), settings, named)
    }

    /// The record of the last start, without what its particles add.
    pub(crate) fn made(&self) -> Option<&FileRecord> {
        self.state.made.as_ref()
    }

    /// The record of the present particles, which begins with their run; none before the first run.
    pub(crate) fn record(&self) -> Option<FileRecord> {
        self.state.record()
    }

    /// Sets the spacing by a function for the next start.
    pub(crate) fn set_spacing(&mut self, spacing: Option<Spacing>) {
        self.state.spacing = spacing;
    }

    /// Starts again with other settings. The survey is kept, unless the settings name another box.
    ///
    /// # Errors
    ///
    /// The errors of [`Run::start`].
    pub fn restart<S>(&mut self, settings: &S) -> Result<Start, Error>
    where
        SpacedSettings: for<'a> From<&'a S>,
    {
        let SpacedSettings { settings, spacing } = SpacedSettings::from(settings);
        self.set_spacing(spacing);
        if let Some(bounds) = settings.bounds.filter(|bounds| *bounds != self.bounds()) {
            self.set_bounds(bounds, None);
        }
        let named = self.field.formula().map(NamedSurface::of);
        Ok(self.begin(&settings, named)?)
    }

    /// Announces what the caller will do after the run, measure and [join](Run::join) the
    /// particles, so that [`Progress::fraction`], [`Run::fraction`] and [`Reporting::fraction`] are
    /// shares of all of it. Without a plan they are shares of the run alone.
    pub fn plan(&mut self, measured: Measured, is_joined: bool) {
        self.state.plan = Plan { measured, is_joined };
    }

    /// Estimated share of the work that is done: of the run and of what is [planned](Run::plan).
    #[must_use]
    pub fn fraction(&self) -> f64 {
        self.state.fraction()
    }

    /// Does up to `budget` units of work: a particle's slots, a child's projection, a particle's
    /// share of a relaxation step. It returns early now and then, so that a caller can show the
    /// particles. The run has ended when [`Progress::stop_reason`] is set. It is
    /// [cancelled](StopReason::Cancelled) if a function of the program [has
    /// failed](Run::check_field).
    pub fn step(&mut self, budget: u32) -> Progress {
        self.state.step(&self.field, budget)
    }

    /// Lets the particles of a finished run follow its surface to the surface of `field`, in the
    /// same box, which has moved only a little; [`Run::step`] does it. Each call is a frame of a
    /// motion: the transport of the particles, births and deaths where they become sparse or crowd,
    /// and a step of relaxation. The same sequence of fields gives the same particles to the last
    /// bit.
    ///
    /// The box stays the same: one that was fitted to the first surface cuts what grows out of it,
    /// which the report says ([`Cut::Outgrown`]).
    ///
    /// Births and deaths destroy the order of the fronts; particles of a refined run move with its
    /// mesh and keep their order, until the surface tears or joins. Components that a survey misses
    /// are no longer searched for.
    ///
    /// # Errors
    ///
    /// If the particles cannot follow: the error says why, and what to do. The run and its field
    /// are then as before the call.
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
    /// // Most of the particles were there at the beginning.
    /// assert!(run.particles().identity.iter().filter(|&&number| number < 1_000).count() > 900);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn follow(&mut self, field: F) -> Result<(), FollowError> {
        let next = self.state.field.followed_by(&field);
        let (given, known) = (
            core::mem::replace(&mut self.field, Arc::new(field)),
            core::mem::replace(&mut self.state.field, next),
        );
        let followed = self.follow_field(false);
        if followed.is_err() {
            (self.field, self.state.field) = (given, known);
        }
        followed
    }

    /// [`Run::follow`] to the surface of the run's own field, in its box: both may have changed
    /// since the last step. If `is_closed`, particles are neither added nor removed, except those
    /// that do not reach the surface.
    pub(crate) fn follow_field(&mut self, is_closed: bool) -> Result<(), FollowError> {
        self.state.follow(&shared(&self.field), is_closed)
    }

    /// Requests more relaxation steps on the particles of a finished run; [`Run::step`] does them.
    /// Returns whether there are particles to relax: not while the run is under way, whose steps
    /// are set by its [settings](Settings::relax_steps).
    #[must_use]
    pub fn relax(&mut self, steps: u32) -> bool {
        self.state.relax(&shared(&self.field), steps)
    }

    /// Ends the run where it is; the particles placed so far stay.
    pub fn cancel(&mut self) -> Progress {
        self.state.cancel(&self.field)
    }

    /// Carries the run out, and makes a [`Sample`] of it in which these particles are measured, or
    /// none: [`sample`] measures them.
    ///
    /// ```
    /// use marching_particles::run::Measured;
    /// use marching_particles::{Formula, Run, Settings};
    ///
    /// let surface = Formula::parse("x^2 + y^2 + z^2 = 1")?;
    /// let run = Run::start(surface, &Settings::with_count(500))?;
    /// let sample = run.complete(Measured::Nothing)?;
    /// assert_eq!(sample.report().measures.quality, None);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// The error of [`Run::finish`].
    pub fn complete(mut self, measured: Measured) -> Result<Sample, Error> {
        while self.step(u32::MAX).stop_reason.is_none() {}
        self.finish_with(measured)
    }

    /// Measures the particles and makes a [`Sample`] of the run in its present state.
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
    pub fn finish_with(self, measured: Measured) -> Result<Sample, Error> {
        self.state.finished(&self.field, measured)
    }

    /// The error of a function of the program that has failed. The run has ended then; its
    /// particles are those placed before.
    ///
    /// # Errors
    ///
    /// [`Error::Field`] if a function of the field has failed; [`Error::Settings`] if the function
    /// of a [`Spacing`] has, or if the spacing is not above 0 at a particle.
    pub fn check_field(&self) -> Result<(), Error> {
        self.state.check_functions(&self.field)
    }

    /// Returns the reason if there is no particle, or its field has failed.
    pub(crate) fn check_not_empty(&mut self) -> Result<(), Error> {
        self.state.check_not_empty(&self.field)
    }

    /// The sample of a run that has ended, with this report on it.
    pub(crate) fn into_sample(self, report: Report) -> Sample {
        Sample::new(self.state, report)
    }

    /// A copy of the particles of a run that has ended, with this report on them.
    pub(crate) fn sampled(&self, report: Report) -> Sample {
        Sample::copied(&self.state, report)
    }

    /// The particles so far. While a generation level is under way, the columns may hold
    /// provisional rows beyond [`Run::rows`].
    #[must_use]
    pub fn particles(&self) -> &Particles {
        self.state.sampler.particles()
    }

    /// Number of particles that will stay.
    #[must_use]
    pub fn count(&self) -> usize {
        self.state.count()
    }

    /// Rows of the columns that will stay: more than there are particles if some lie on creases,
    /// with a row on each side.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.state.rows()
    }

    /// The clip box, in the coordinates of the field as it was given.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        self.state.bounds
    }

    /// Returns whether the surface is bounded, if its box was fitted; none if the box was given.
    #[must_use]
    pub fn reach(&self) -> Option<Reach> {
        self.state.reach
    }

    /// The report on the start of the run.
    #[must_use]
    pub fn start_report(&self) -> &Start {
        &self.state.start
    }

    /// The state after the last step; none before the first.
    #[must_use]
    pub fn progress(&self) -> Option<&Progress> {
        self.state.last.as_ref()
    }

    /// The field, as it was given.
    #[must_use]
    pub fn field(&self) -> &F {
        &self.field
    }

    /// An evaluator of the field in the frame of the particles: places are relative to their
    /// origin. It knows the patches of the surface.
    #[must_use]
    pub fn evaluator(&self) -> Box<dyn Evaluator + '_> {
        self.state.evaluator(&self.field)
    }

    /// Ends the run and returns the field, which a [method under way](Run::step) shared.
    #[must_use]
    pub fn into_field(self) -> Arc<F> {
        self.field
    }

    /// Refuses, from now on, runs that need more than about `bytes` with the report on them.
    pub fn limit_memory(&mut self, bytes: usize) {
        // A refined run takes more than a front, but has freed most of that before the report is
        // made.
        let with_report = bytes_per_particle(&Settings::DEFAULT) + KEPT_BYTES + REPORT_BYTES;
        self.state.most_particles = bytes / with_report;
    }

    /// Principal curvatures (κ₁, κ₂) at the particles from `from` on, in inverse units of length;
    /// NaN where they are undefined.
    pub fn curvatures(&self, from: usize) -> Vec<[f32; 2]> {
        let count = self.rows();
        let positions = &self.particles().local[from.min(count)..count];
        let mut curvatures = vec![Curvature::default(); positions.len()];
        let field = &mut *self.evaluator();
        differential::curvatures(field, positions, &mut curvatures);
        curvatures.iter().map(|curvature| [curvature.k1, curvature.k2]).collect()
    }

    /// The measurements of the last report, in columns with a value for each particle.
    #[must_use]
    pub fn measured(&self) -> &quality::Measurements {
        &self.state.measuring.measured
    }

    fn measured_mut(&mut self) -> &mut quality::Measurements {
        &mut self.state.measuring.measured
    }

    /// The sampler, for facts that the report omits.
    #[doc(hidden)]
    #[must_use]
    pub fn sampler(&self) -> &Sampler<'f> {
        &self.state.sampler
    }

    /// Ends the run and returns its sampler, with the method where it stopped.
    #[doc(hidden)]
    #[must_use]
    pub fn into_sampler(self) -> Sampler<'f> {
        self.state.sampler
    }

    /// Sets the box of the next start, which ends a run in the box before.
    pub(crate) fn set_bounds(&mut self, bounds: Bounds, reach: Option<Reach>) {
        self.state.set_bounds(&self.field, bounds, reach);
    }

    /// Sets the field of the next start. The particles stay until then. A field that `is_same` has
    /// the same surface: the survey remains valid.
    pub(crate) fn set_field(&mut self, field: F, is_same: bool) {
        self.state.leave_field(&self.field, &field, is_same);
        self.field = Arc::new(field);
    }

    /// Whether the next start needs no search for the creases of the surface.
    pub(crate) fn knows_creases(&self) -> bool {
        self.state.knows_creases()
    }

    /// Finds the creases of the surface in the box, in slices, for [`Run::know_creases`].
    pub(crate) fn find_creases(&self) -> Work<'f, FoundCreases> {
        let (field, origin) = (shared(&self.field), self.bounds().local_origin());
        let bounds = self.bounds().relative_to(origin);
        Box::pin(async move { sampler::find_creases(&field, origin, &bounds, None).await })
    }

    /// Sets the creases of the surface for the next start.
    pub(crate) fn know_creases(&mut self, found: FoundCreases) {
        self.state.creases = Some(found);
    }
}
