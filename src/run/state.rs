//! The state of a run, without its field: the same code for fields of any type.

use super::measuring::Measuring;
use super::mesh::Meshing;
use super::plan::{Plan, Shares};
use super::{
    Error, FieldState, FileRecord, Known, Measured, NamedSurface, RunState, Sample, SolidSettings, Start,
    Warning,
};
use crate::extent::{self, Reach};
use crate::field::edges::{EdgeTable, KnownField, KnownPieces};
use crate::field::{Evaluator, Field, Frame};
use crate::math::Bounds;
use crate::particles::Particles;
use crate::sampler::{
    self, FollowError, FoundCreases, Phase, Progress, Sampler, Sampling, Settings, SettingsError, Spacing,
    StopReason, bytes_per_particle,
};
use crate::slices;
use glam::DVec3;
use std::sync::Arc;

impl FieldState {
    fn new(given: &dyn Field) -> Self {
        Self { calls: given.calls().unwrap_or(0), pieces: None }
    }

    /// Calls of its functions by this run.
    pub(super) fn calls(&self, given: &dyn Field) -> Option<u64> {
        given.calls().map(|calls| calls - self.calls)
    }

    /// [`FieldState::function`], shared with the sampler.
    pub(super) fn shared<'f>(&self, given: &Arc<dyn Field + 'f>) -> Arc<dyn Field + 'f> {
        KnownPieces::of_shared(self.pieces.as_ref(), given)
    }

    /// The sampled field.
    pub(super) fn function<'a>(&'a self, given: &'a dyn Field) -> KnownField<&'a dyn Field, &'a EdgeTable> {
        KnownPieces::of(self.pieces.as_ref(), given)
    }

    /// The state for `given`, which replaces the last field and keeps what was found about that
    /// field's branches.
    pub(super) fn followed_by(&self, given: &dyn Field) -> Self {
        let pieces = match (given.piecewise(), &self.pieces) {
            (Some(given), Some(KnownPieces::Own(known))) => {
                Some(KnownPieces::Own(given.with_pieces_of(&**known)))
            }
            _ => None,
        };
        Self { pieces, ..Self::new(given) }
    }
}

/// The error of a field whose functions have failed.
fn failure_of(field: &dyn Field) -> Result<(), Error> {
    field.failure().map_or(Ok(()), |error| Err(Error::Field(error)))
}

impl<'f> RunState<'f> {
    /// A run that has not begun.
    pub(super) fn new(field: &dyn Field, bounds: Bounds) -> Self {
        Self {
            field: FieldState::new(field),
            bounds,
            reach: None,
            sampler: Sampler::default(),
            known: Known::Nothing,
            creases: None,
            spacing: None,
            spacing_error: None,
            most_particles: usize::MAX,
            start: Start::default(),
            made: None,
            last: None,
            plan: Plan::default(),
            measuring: Measuring::default(),
            meshing: Meshing::default(),
        }
    }

    /// [`Run::start`](super::Run::start), by settings that are valid.
    pub(super) fn started(
        field: &Arc<dyn Field + 'f>,
        settings: &Settings,
        spacing: Option<Spacing>,
    ) -> Result<Self, Error> {
        let own = || field.formula().and_then(SolidSettings::box_of);
        let (bounds, reach) = match settings.bounds.or_else(own) {
            Some(bounds) => (bounds, None),
            None => {
                let extent = extent::find(field);
                let share = |bounds: &Bounds| settings.largest_share_with(bounds, spacing.as_ref());
                (extent.with_room(share), Some(extent.reach))
            }
        };
        let mut run = Self { reach, spacing, ..Self::new(field, bounds) };
        let begun = run.begin(field, settings, field.formula().map(NamedSurface::of));
        failure_of(field)?;
        begun?;
        Ok(run)
    }

    /// [`Run::begin`](super::Run::begin).
    pub(super) fn begin(
        &mut self,
        field: &Arc<dyn Field + 'f>,
        settings: &Settings,
        named: Option<NamedSurface>,
    ) -> Result<Start, SettingsError> {
        settings.validate()?;
        self.bounds.check()?;
        if self.spacing.is_some() && settings.radius.is_some() {
            return Err(SettingsError::RadiusOfVarying);
        }
        let made = named
            .and_then(|named| FileRecord::beginning(named, self.bounds, settings, self.spacing.as_ref()));
        let mut settings = settings.in_shares_of(&self.bounds)?;
        if let Some(spacing) = &self.spacing {
            spacing.check_limits()?;
            let bends = settings.sampling == Sampling::Adaptive;
            self.sampler.set_spacing(Some((spacing.clone(), bends)));
            // Whatever sizes follow, the sampler makes them vary.
            settings.sampling = Sampling::Adaptive;
        } else {
            self.sampler.set_spacing(None);
        }
        let settings = &settings;
        self.sampler.limit_memory(self.most_particles.saturating_mul(bytes_per_particle(settings)));
        self.sampler.set_box_given(self.reach.is_none());
        let origin = self.bounds.local_origin();
        let bounds = self.bounds.relative_to(origin);
        let is_surveyed =
            self.known == Known::Survey && self.sampler.settings().survey_cells == settings.survey_cells;
        let creases = (!is_surveyed).then(|| {
            let found = self.creases.take();
            let search =
                || slices::complete(sampler::find_creases(field, origin, &bounds, settings.survey_cells));
            let FoundCreases { creases, known } = found.unwrap_or_else(search);
            self.field.pieces = known;
            creases
        });
        let start = self.sampler.begin(&self.field.shared(field), origin, &bounds, settings, creases)?;
        self.known = Known::Survey;
        self.made = made;
        self.last = None;
        self.measuring = Measuring::default();
        self.meshing = Meshing::default();
        let warnings = self.known_at_start(field, start, settings.max_particles);
        let sampler::Forecast { radius, predicted_count, area } = start;
        self.start = Start { radius, predicted_count, area, warnings };
        Ok(self.start.clone())
    }

    /// [`Run::fraction`](super::Run::fraction).
    pub(super) fn fraction(&self) -> f64 {
        let shares = self.shares();
        let run = self.last.as_ref().map_or(0.0, |progress| progress.fraction);
        run + shares.measuring * self.measuring.fraction() + shares.mesh * self.meshing.fraction()
    }

    /// The shares of a call by the plan.
    pub(super) fn shares(&self) -> Shares {
        self.plan.shares(self.sampler.settings().method)
    }

    /// [`Run::step`](super::Run::step).
    pub(super) fn step(&mut self, field: &dyn Field, budget: u32) -> Progress {
        let progress = self.sampler.step(budget);
        let has_failed = field.failure().is_some()
            || self.spacing.as_ref().is_some_and(|spacing| spacing.failure().is_some());
        if has_failed && progress.stop_reason.is_none() {
            return self.cancel(field);
        }
        if progress.phase == Phase::Relaxation && progress.relax_step == 0 && progress.relax_steps > 0 {
            self.measuring.keep_front(self.sampler.particles(), progress.rows);
        }
        self.remember(field, progress)
    }

    /// [`Run::follow_field`](super::Run::follow_field).
    pub(super) fn follow(&mut self, field: &Arc<dyn Field + 'f>, is_closed: bool) -> Result<(), FollowError> {
        let bounds = self.local_bounds();
        self.sampler.follow(&self.field.shared(field), &bounds, is_closed)?;
        self.known = Known::Particles;
        self.made = None;
        self.creases = None;
        self.remember(field, self.sampler.progress());
        Ok(())
    }

    /// [`Run::relax`](super::Run::relax).
    pub(super) fn relax(&mut self, field: &Arc<dyn Field + 'f>, steps: u32) -> bool {
        let can_relax = self.known != Known::Nothing && self.sampler.relax(&self.field.shared(field), steps);
        if can_relax {
            let progress = self.sampler.progress();
            self.remember(field, progress);
        }
        can_relax
    }

    /// [`Run::cancel`](super::Run::cancel).
    pub(super) fn cancel(&mut self, field: &dyn Field) -> Progress {
        self.sampler.cancel();
        // Marks the particles next to singular points.
        let progress = self.sampler.step(0);
        self.remember(field, progress)
    }

    fn remember(&mut self, field: &dyn Field, mut progress: Progress) -> Progress {
        self.forget_results();
        progress.fraction *= self.shares().run;
        if progress.stop_reason == Some(StopReason::Constant)
            && let (Some(message), Some(cause)) = (&mut progress.message, field.facts().why_constant)
        {
            *message = format!("{message} {cause}");
        }
        self.spacing_error = None;
        if progress.stop_reason.is_some()
            && let Some(spacing) = &self.spacing
        {
            let Particles { local, origin, .. } = self.sampler.particles();
            let mut radii = vec![0.0; local.len()];
            spacing.radii(*origin, local, &mut radii);
            self.spacing_error = spacing.check(*origin, local, &radii).err();
        }
        self.last = Some(progress.clone());
        progress
    }

    /// [`Run::check_field`](super::Run::check_field).
    pub(super) fn check_functions(&self, field: &dyn Field) -> Result<(), Error> {
        failure_of(field)?;
        self.spacing_error.clone().map_or(Ok(()), |error| Err(error.into()))
    }

    /// Drops a measurement under way and the mesh, which belong to other particles or another
    /// field.
    fn forget_results(&mut self) {
        self.measuring.stop();
        self.meshing = Meshing::default();
    }

    /// [`Run::finish_with`](super::Run::finish_with).
    pub(super) fn finished(mut self, field: &dyn Field, measured: Measured) -> Result<Sample, Error> {
        self.check_not_empty(field)?;
        let report = self.report_with(field, measured);
        failure_of(field)?;
        Ok(Sample::new(self, report))
    }

    /// [`Run::check_not_empty`](super::Run::check_not_empty).
    pub(super) fn check_not_empty(&self, field: &dyn Field) -> Result<(), Error> {
        self.check_functions(field)?;
        if self.count() > 0 {
            return Ok(());
        }
        let progress = self.last.clone().unwrap_or_else(|| self.sampler.progress());
        let Some(reason) = progress.stop_reason.filter(|reason| *reason != StopReason::Cancelled) else {
            return Err(Error::Cancelled);
        };
        if self.reach == Some(Reach::Unknown) && self.sampler.shows_nothing() {
            let defined = extent::defined_share(&mut *field.evaluator(Frame::default()));
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

    /// The particles so far.
    pub(super) fn particles(&self) -> &Particles {
        self.sampler.particles()
    }

    /// Number of particles that will stay.
    pub(super) fn count(&self) -> usize {
        self.last.as_ref().map_or(0, |progress| progress.particles)
    }

    /// Rows of the columns that will stay.
    pub(super) fn rows(&self) -> usize {
        self.last.as_ref().map_or(0, |progress| progress.rows)
    }

    /// [`Run::evaluator`](super::Run::evaluator).
    pub(super) fn evaluator<'a>(&'a self, field: &'a dyn Field) -> Box<dyn Evaluator + 'a> {
        self.field.function(field).into_evaluator(self.sampler.frame())
    }

    /// The clip box, relative to the origin of the particles.
    pub(super) fn local_bounds(&self) -> Bounds {
        self.bounds.relative_to(self.particles().origin)
    }

    /// [`Run::set_bounds`](super::Run::set_bounds).
    pub(super) fn set_bounds(&mut self, field: &dyn Field, bounds: Bounds, reach: Option<Reach>) {
        self.reach = reach;
        if bounds != self.bounds {
            self.bounds = bounds;
            self.creases = None;
            self.end(field);
        }
    }

    /// Replaces the field by `next`: [`Run::set_field`](super::Run::set_field).
    pub(super) fn leave_field(&mut self, field: &dyn Field, next: &dyn Field, is_same: bool) {
        if !is_same {
            self.end(field);
        }
        self.field = self.field.followed_by(next);
        self.measuring.stop();
        self.creases = None;
    }

    /// Whether the next start needs no search for the creases of the surface.
    pub(super) fn knows_creases(&self) -> bool {
        self.known == Known::Survey || self.creases.is_some()
    }

    /// Ends the run on a field or a box that is about to change: the sampler's knowledge of them
    /// becomes invalid.
    fn end(&mut self, field: &dyn Field) {
        if self.known != Known::Nothing {
            self.known = Known::Nothing;
            self.cancel(field);
        }
    }

    /// The place of a point relative to the origin of the particles.
    pub(super) fn place(&self, position: [f64; 3]) -> [f64; 3] {
        (self.particles().origin + DVec3::from_array(position)).to_array()
    }
}
