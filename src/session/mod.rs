//! One user's work: a field, a sampler and the particles between them. Commands go in, changes and reports come out;
//! there is no clock, no GPU and no platform in here.

mod describe;
mod fault;
mod fitting;
mod mesh;
mod warnings;

pub use describe::{Colour, Description, Fate, Limits, ReportRow, SurfaceEntry, describe};
pub use fault::{Fault, FaultKind};
pub use fitting::Cut;
pub use mesh::{MeshAnswer, MeshComponent};

use crate::differential::{self, Curvature};
use crate::extent::Reach;
use crate::field::Field;
use crate::field::formula::{FormulaError, FormulaErrorKind, FormulaField, MathNode, Parameter};
use crate::field::gallery::{self, Surface};
use crate::field::model::ModelInfo;
use crate::field::rbf::{DataError, RbfData, RbfField};
use crate::math::Bounds;
use crate::particles::{Particles, SlotFate, Slots};
use crate::quality::{self, Figures, Histogram, Places, Sizes};
use crate::sampler::{
    FateCounts, Phase, Progress, Sampled, Sampler, Sampling, Search, Settings, SettingsError, Start,
    StopReason, bytes_per_particle,
};
use crate::slices::{self, Work};
use fitting::Fitting;
use glam::{DVec3, Vec3};
use mesh::Mesh;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Up to this many particles, the positions after the front are kept for the comparison before and after relaxation.
const MAX_KEPT: usize = 400_000;

/// Bytes per particle that a session takes beside the run: the particles kept after the front, and the report as measured.
const KEPT_BYTES: usize = 28;
const REPORT_BYTES: usize = 225;

/// What a caller asks of the field; everything is optional.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(default)]
pub struct FieldRequest {
    /// Identifier of a gallery surface to start from; without one, the present field is changed.
    pub surface: Option<String>,
    /// Text of the formula, in the place of the surface's.
    pub formula: Option<String>,
    /// Values of parameters by name.
    pub parameters: BTreeMap<String, f64>,
    /// Parameters that the formula's unknown names become.
    pub declare: Vec<Parameter>,
    /// Clip box. Without one it is that of the surface, or fitted (see [`Session::fit`]).
    pub bounds: Option<Bounds>,
}

/// What a field is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum FieldKind {
    /// A formula.
    Formula,
    /// Points with normals.
    Points,
}

/// The field as it now is.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct FieldAnswer {
    /// What it is made of.
    pub kind: FieldKind,
    /// The model, if it is made of points.
    pub model: Option<ModelInfo>,
    /// Gallery surface, if the formula is still its own.
    pub surface: Option<&'static str>,
    /// Text of the formula; empty if there is none.
    pub formula: String,
    /// Parameters with values and ranges.
    pub parameters: Vec<Parameter>,
    /// Parameters that were not declared but found in the formula.
    pub auto: Vec<String>,
    /// Clip box; before [`Session::fit`] or a start it may be that of the formula before.
    pub bounds: Bounds,
    /// How far the surface reaches, if the box was fitted to it.
    pub reach: Option<Reach>,
    /// The formula as MathML; none if there is no formula.
    pub mathml: Option<MathNode>,
}

/// Why a field was refused. The field before it stays.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FieldError {
    /// The formula has a mistake.
    #[error(transparent)]
    Formula(#[from] FormulaError),
    /// No surface of that name.
    #[error("there is no surface `{0}` in the gallery")]
    UnknownSurface(String),
    /// The box is not one.
    #[error("the box {}", Bounds::REQUIREMENT)]
    Box,
    /// The centres and coefficients make no field.
    #[error(transparent)]
    Points(#[from] DataError),
}

/// Everything worth knowing about a run.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Report {
    /// Number of particles.
    pub count: usize,
    /// Number of generation levels.
    pub levels: u32,
    /// Fronts started, each from a seed of its own.
    pub components_seeded: u32,
    /// Number of components at this radius: those of the graph of natural neighbours of the particles.
    pub components: usize,
    /// Whether it is proven that there is a witness on every component of the surface, and of each witness that it is on the
    /// component of a particle or named in `sampled`.
    pub search: Search,
    /// Which of the witnessed components hold particles.
    pub sampled: Sampled,
    /// Cells of the box in which the proof could not decide, and witnesses of which it could not; none where no proof was
    /// attempted.
    pub undecided_cells: Option<u64>,
    /// Places where f has no gradient on the surface, a curve of them counted as one; none where they were not looked for.
    pub singular_points: Option<u64>,
    /// Particles placed in gaps between fronts.
    pub gaps_filled: u64,
    /// Repulsion radius.
    pub radius: f64,
    /// Repulsion radius of the smallest particle; 0 without particles.
    pub radius_min: f64,
    /// Repulsion radius of the largest particle.
    pub radius_max: f64,
    /// Field evaluations of the whole run.
    pub evaluations: u64,
    /// Field evaluations of the front per particle.
    pub evaluations_per_particle: f64,
    /// Number of proposed children by fate.
    pub fates: FateCounts,
    /// Particles with a child that fell outside of the box.
    pub border: usize,
    /// Why there are such particles, unless the box was chosen for the surface.
    pub cut: Option<Cut>,
    /// Times that a coarse front was refined; none where it was not, or the front stands.
    pub refined_levels: Option<u32>,
    /// Why the run ended.
    pub stop_reason: Option<StopReason>,
    /// Things the user should know, in words.
    pub warnings: Vec<String>,
    /// Particles per generation level.
    pub level_counts: Vec<u32>,
    /// Energy per particle before the first relaxation step and after each; none where nothing was relaxed.
    pub energy: Option<Vec<f64>>,
    /// Digest of the particles, 16 hexadecimal digits.
    pub digest: String,
    /// Quality now.
    pub quality: Option<Figures>,
    /// Quality after the front, before the relaxation.
    pub quality_before: Option<Figures>,
    /// Nearest-neighbour distances.
    pub nearest_histogram: Histogram,
    /// Where the spacing is worst now.
    pub places: Places,
}

/// The field of a session.
#[derive(Clone)]
#[expect(clippy::large_enum_variant, reason = "there is one in a session")]
enum Source {
    Formula(FormulaField),
    Points { field: RbfField, info: ModelInfo },
}

impl Source {
    fn field(&mut self) -> &mut dyn Field {
        match self {
            Self::Formula(field) => field,
            Self::Points { field, .. } => field,
        }
    }

    /// Counts the coordinates of a formula from `origin`. Those of a model from points stay as they are.
    fn set_origin(&mut self, origin: DVec3) {
        if let Self::Formula(field) = self {
            field.set_origin(origin);
        }
    }

    fn formula(&self) -> Option<&FormulaField> {
        match self {
            Self::Formula(field) => Some(field),
            Self::Points { .. } => None,
        }
    }
}

/// A field, a sampler and a run.
pub struct Session {
    source: Source,
    /// Whether field and box are those of the last start.
    is_surveyed: bool,
    surface: Option<&'static Surface>,
    declared: Vec<Parameter>,
    /// The box that was given with the field, or that of its surface.
    own: Bounds,
    bounds: Bounds,
    fitting: Fitting,
    sampler: Sampler,
    /// Runs of more particles are refused.
    most_particles: usize,
    warnings: Vec<String>,
    last: Option<Progress>,
    /// The particles after the front, until they are measured.
    front: Option<Arc<Kept>>,
    front_figures: Option<Figures>,
    /// The measurement under way.
    measuring: Option<Work<Measured>>,
    measured: quality::Report,
    mesh: Mesh,
    /// A mesh file under way.
    file: Option<mesh::File>,
}

/// What is kept of particles for a later look at them.
struct Kept {
    position: Vec<Vec3>,
    normal: Vec<Vec3>,
    radius: Vec<f32>,
}

impl Kept {
    fn of(particles: &Particles) -> Self {
        let Particles { position, normal, radius, .. } = particles;
        Self { position: position.clone(), normal: normal.clone(), radius: radius.clone() }
    }

    /// [`quality::measure`], a slice at a time.
    async fn measure(&self, field: &mut dyn Field, bounds: &Bounds, sampling: Sampling) -> quality::Report {
        let sizes = match sampling {
            Sampling::Uniform => Sizes::None,
            Sampling::Adaptive => Sizes::Given(&self.radius),
        };
        let options = quality::Options { sizes, ..quality::Options::default() };
        quality::in_slices(&self.position, &self.normal, field, Some(bounds), &options).await
    }
}

/// What a measurement gives.
struct Measured {
    front: Option<Figures>,
    now: quality::Report,
    /// Particles that face another sheet.
    facing: usize,
}

impl Default for Session {
    fn default() -> Self {
        Self::new()
    }
}

impl Session {
    /// A session on the gallery's first surface, with nothing sampled.
    #[must_use]
    pub fn new() -> Self {
        let surface = &gallery::SURFACES[0];
        Self {
            source: Source::Formula(surface.field()),
            is_surveyed: false,
            surface: Some(surface),
            declared: surface.declared(),
            own: surface.bounds,
            bounds: surface.bounds,
            fitting: Fitting::default(),
            sampler: Sampler::new(),
            most_particles: usize::MAX,
            warnings: Vec::new(),
            last: None,
            front: None,
            front_figures: None,
            measuring: None,
            measured: quality::Report::default(),
            mesh: Mesh::None,
            file: None,
        }
    }

    /// The present field. Its [`origin`](Field::origin) is that of the particles.
    pub fn field(&mut self) -> &mut dyn Field {
        self.source.field()
    }

    /// The clip box, in the coordinates of the formula.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// The clip box, counted from the origin of the particles.
    #[must_use]
    pub fn local_bounds(&self) -> Bounds {
        self.bounds.relative_to(self.particles().origin)
    }

    /// The sampler.
    #[must_use]
    pub fn sampler(&self) -> &Sampler {
        &self.sampler
    }

    /// The particles; of a generation level under way, the columns may hold provisional ones beyond
    /// [`Session::count`].
    #[must_use]
    pub fn particles(&self) -> &Particles {
        self.sampler.particles()
    }

    /// Number of particles that will stay.
    #[must_use]
    pub fn count(&self) -> usize {
        self.last.as_ref().map_or(0, |progress| progress.particles)
    }

    /// The field as it is.
    #[must_use]
    pub fn answer(&self) -> FieldAnswer {
        match &self.source {
            Source::Formula(field) => FieldAnswer {
                kind: FieldKind::Formula,
                model: None,
                surface: self.surface.map(|surface| surface.id),
                formula: field.text().to_owned(),
                parameters: field.parameters().to_vec(),
                auto: field.auto().to_vec(),
                bounds: self.bounds,
                reach: self.fitting.reach(),
                mathml: Some(field.mathml()),
            },
            Source::Points { info, .. } => FieldAnswer {
                kind: FieldKind::Points,
                model: Some(info.clone()),
                surface: None,
                formula: String::new(),
                parameters: Vec::new(),
                auto: Vec::new(),
                bounds: self.bounds,
                reach: self.fitting.reach(),
                mathml: None,
            },
        }
    }

    /// Changes the field, which ends a run on another one. Its particles stay until the next [`Session::start`].
    ///
    /// # Errors
    ///
    /// If the surface is unknown, the formula has a mistake, a value is not finite or the box is not one; nothing is
    /// changed then.
    pub fn set_field(&mut self, request: &FieldRequest) -> Result<FieldAnswer, FieldError> {
        let surface = match &request.surface {
            Some(id) => Some(gallery::find(id).ok_or_else(|| FieldError::UnknownSurface(id.clone()))?),
            None => None,
        };
        let own = request.bounds.or(surface.map(|s| s.bounds)).unwrap_or(self.own);
        if !own.is_valid() {
            return Err(FieldError::Box);
        }
        // A box stays given while the present field is changed.
        let is_given = request.bounds.is_some() || surface.is_none() && self.fitting.is_given;
        let present = self.source.formula();
        let text = match (&request.formula, surface, present) {
            (Some(text), _, _) => text.as_str(),
            (None, Some(surface), _) => surface.formula,
            (None, None, Some(field)) => field.text(),
            // Of a model from points only the box can be changed.
            (None, None, None) => {
                self.end_run_unless(own == self.bounds);
                (self.own, self.bounds) = (own, own);
                return Ok(self.answer());
            }
        };
        let declared = self.declared_for(surface, text, request);
        let field = self.formula_field(text, &declared, request)?;
        let surface = surface
            .or(self.surface.filter(|_| request.surface.is_none()))
            .filter(|surface| surface.formula == field.text());
        self.take_formula(field, surface, (own, is_given));
        self.declared = declared;
        Ok(self.answer())
    }

    /// The parameters that are declared for a formula: those of its surface or of the present formula, and those of the request.
    fn declared_for(
        &self,
        surface: Option<&'static Surface>,
        text: &str,
        request: &FieldRequest,
    ) -> Vec<Parameter> {
        // A declared parameter that the formula does not use stays declared: it may come back with the next key.
        let mut declared = surface.map_or_else(
            || if request.formula.is_none() { self.declared.clone() } else { Vec::new() },
            Surface::declared,
        );
        // What a parameter stands for is known in the surface's own formula alone.
        if surface.is_some_and(|surface| surface.formula != text) {
            for parameter in &mut declared {
                parameter.label.clone_from(&parameter.name);
            }
        }
        for parameter in &request.declare {
            match declared.iter_mut().find(|known| known.name == parameter.name) {
                Some(known) => *known = parameter.clone(),
                None => declared.push(parameter.clone()),
            }
        }
        declared
    }

    /// The field of a formula with the values that a request asks for.
    fn formula_field(
        &self,
        text: &str,
        declared: &[Parameter],
        request: &FieldRequest,
    ) -> Result<FormulaField, FieldError> {
        let mut field = match self.source.formula() {
            Some(field) if text == field.text() && declared == self.declared => field.clone(),
            _ => FormulaField::parse(text, declared)?.without_powers(),
        };
        // A named surface begins with its own values; without one the present field is changed.
        if request.surface.is_some() {
            let usual = |p: &Parameter| declared.iter().find(|d| d.name == p.name).map(|d| d.value);
            let values: Vec<(String, f64)> = field
                .parameters()
                .iter()
                .map(|p| (p.name.clone(), usual(p).unwrap_or_else(|| Parameter::automatic(&p.name).value)))
                .collect();
            for (name, value) in values {
                field.set_parameter(&name, value)?;
            }
        }
        for (name, &value) in &request.parameters {
            match field.set_parameter(name, value) {
                // A value for a name that the formula no longer has is of no consequence.
                Err(error) if error.kind == FormulaErrorKind::BadParameter && value.is_finite() => {}
                result => result?,
            }
        }
        Ok(field)
    }

    /// Samples the field of a formula from now on, in the box `own`, which was given or is to be fitted. Ends a run on another field.
    fn take_formula(
        &mut self,
        mut field: FormulaField,
        surface: Option<&'static Surface>,
        (own, is_given): (Bounds, bool),
    ) {
        let present = self.source.formula();
        let is_same_text = present.is_some_and(|p| p.text() == field.text());
        let is_same = is_same_text && present.is_some_and(|p| p.parameters() == field.parameters());
        // A box that is to be fitted stays what it was until it is.
        let is_open = !is_given && surface.is_none();
        let keeps_box = is_same_text && self.fitting.is_fitted() && is_open;
        let bounds = if is_open { self.bounds } else { own };
        self.end_run_unless(is_same && bounds == self.bounds);
        if !keeps_box {
            self.fitting.discard();
        } else if !is_same {
            self.fitting.restart();
        }
        self.fitting.is_given = is_given;
        self.surface = surface;
        if is_same {
            field.use_double(self.sampler.double());
        }
        field.set_origin(self.particles().origin);
        self.source = Source::Formula(field);
        self.measuring = None;
        (self.own, self.bounds) = (own, bounds);
    }

    /// Changes the field to one from points, as `pointcloud::fit` makes it. [`Session::set_field`] with a surface or a formula
    /// changes it back. Both end a run on another field, whose particles stay until the next [`Session::start`].
    ///
    /// # Errors
    ///
    /// If the data makes no field or the box is not one; nothing is changed then.
    pub fn set_points(
        &mut self,
        data: RbfData,
        info: ModelInfo,
        bounds: Bounds,
    ) -> Result<FieldAnswer, FieldError> {
        if !bounds.is_valid() {
            return Err(FieldError::Box);
        }
        let changed = match &self.source {
            Source::Points { field, .. } if *field.data() == data => None,
            _ => Some(RbfField::new(data)?),
        };
        self.end_run_unless(changed.is_none() && bounds == self.bounds);
        match (changed, &mut self.source) {
            (None, Source::Points { info: present, .. }) => *present = info,
            (None, Source::Formula(_)) => {}
            (Some(field), source) => *source = Source::Points { field, info },
        }
        self.measuring = None;
        self.surface = None;
        self.declared.clear();
        self.fitting = Fitting::default();
        (self.own, self.bounds) = (bounds, bounds);
        Ok(self.answer())
    }

    /// Ends the run on a field or a box that is about to change: nothing that the sampler knows of them holds any more.
    fn end_run_unless(&mut self, is_same: bool) {
        if self.is_surveyed && !is_same {
            self.is_surveyed = false;
            self.cancel();
        }
    }

    /// Refuses, from now on, runs that need more than about `bytes` with the report on them.
    pub fn limit_memory(&mut self, bytes: usize) {
        // A refined run takes more than a front does, but before the report is made it has given most of that back.
        let with_report = bytes_per_particle(&Settings::DEFAULT) + KEPT_BYTES + REPORT_BYTES;
        self.most_particles = bytes / with_report;
    }

    /// Starts a run on the present field.
    ///
    /// # Errors
    ///
    /// If a setting is out of its range, or there is no memory for the particles to expect.
    pub fn start(&mut self, settings: &Settings) -> Result<Start, SettingsError> {
        settings.validate()?;
        while !self.fitting.is_settled {
            self.fit(settings, false, u32::MAX);
        }
        self.fitting.is_settled = false;
        self.sampler.limit_memory(self.most_particles.saturating_mul(bytes_per_particle(settings)));
        let start = if self.is_surveyed {
            self.sampler.start_again(self.source.field(), settings)?
        } else {
            self.source.set_origin(self.bounds.local_origin());
            let field = self.source.field();
            let bounds = self.bounds.relative_to(field.origin());
            self.sampler.start(field, &bounds, settings)?
        };
        self.is_surveyed = true;
        self.warnings.clone_from(&start.warnings);
        self.warnings
            .extend(self.source.formula().and_then(FormulaField::evaluated_as).map(warnings::about_powers));
        self.last = None;
        self.front = None;
        self.front_figures = None;
        self.measuring = None;
        self.measured = quality::Report::default();
        (self.mesh, self.file) = (Mesh::None, None);
        Ok(start)
    }

    /// Does up to `budget` units of work; see [`Sampler::step`].
    pub fn step(&mut self, budget: u32) -> Progress {
        let progress = self.sampler.step(self.source.field(), budget);
        let particles = self.sampler.particles();
        if progress.phase == Phase::Relaxation
            && self.front.is_none()
            && progress.relax_step == 0
            && progress.relax_steps > 0
            && progress.particles <= MAX_KEPT
        {
            self.front = Some(Arc::new(Kept::of(particles)));
        }
        self.remember(progress)
    }

    /// Asks for more relaxation steps on the particles of a finished run; [`Session::step`] does them. Nothing happens if the
    /// field or the box has changed since.
    pub fn relax(&mut self, steps: u32) {
        if !self.is_surveyed {
            return;
        }
        self.sampler.relax(steps);
        let progress = self.sampler.progress();
        self.remember(progress);
    }

    /// Ends the run; the particles placed so far stay.
    pub fn cancel(&mut self) -> Progress {
        self.sampler.cancel();
        // Marks the particles next to singular points.
        let progress = self.sampler.step(self.source.field(), 0);
        self.remember(progress)
    }

    fn remember(&mut self, progress: Progress) -> Progress {
        self.measuring = None;
        (self.mesh, self.file) = (Mesh::None, None);
        self.last = Some(progress.clone());
        progress
    }

    /// Principal curvatures (κ₁, κ₂) at the particles from `from` on, worked out now; NaN where the surface has none.
    pub fn curvatures(&mut self, from: usize) -> Vec<[f32; 2]> {
        let count = self.count();
        let positions = &self.sampler.particles().position[from.min(count)..count];
        let mut curvatures = vec![Curvature::default(); positions.len()];
        differential::curvatures(self.source.field(), positions, &mut curvatures);
        curvatures.iter().map(|curvature| [curvature.k1, curvature.k2]).collect()
    }

    /// Measures the particles, before and after the relaxation: up to `budget` slices of the work, some 10 to 50 microseconds
    /// each; the report, once it is complete. Call it when the run has ended. A measurement that anything comes between is
    /// given up, and the next call begins anew.
    pub fn measure(&mut self, budget: u32) -> Option<Report> {
        let bounds = self.local_bounds();
        let work = self.measuring.get_or_insert_with(|| {
            let front = self.front.clone().filter(|_| self.front_figures.is_none());
            let (now, mut source) = (Kept::of(self.sampler.particles()), self.source.clone());
            let sampling = self.sampler.settings().sampling;
            Box::pin(async move {
                let front = match front {
                    Some(front) => Some(front.measure(source.field(), &bounds, sampling).await.figures),
                    None => None,
                };
                let report = now.measure(source.field(), &bounds, sampling).await;
                Measured { front, now: report, facing: warnings::facing_another_sheet(&now).await }
            })
        });
        let Measured { front, now, facing } = slices::advance(work.as_mut(), budget)?;
        self.measuring = None;
        if front.is_some() {
            (self.front, self.front_figures) = (None, front);
        }
        self.measured = now;
        let mut report = self.reported(facing);
        if self.sampler.is_open_by_overflow(self.source.field()) {
            report.warnings.push(warnings::OVERFLOW.into());
        }
        Some(report)
    }

    /// [`Session::measure`] to its end.
    pub fn report(&mut self) -> Report {
        loop {
            if let Some(report) = self.measure(u32::MAX) {
                return report;
            }
        }
    }

    fn reported(&self, facing: usize) -> Report {
        let particles = self.sampler.particles();
        let count = particles.len();
        let mut level_counts = Vec::new();
        for &level in &particles.level {
            if level_counts.len() <= level as usize {
                level_counts.resize(level as usize + 1, 0);
            }
            level_counts[level as usize] += 1;
        }
        let sizes = particles.radius.iter().map(|&radius| f64::from(radius));
        let radius_max = sizes.clone().fold(0.0, f64::max);
        let radius_min = sizes.fold(radius_max, f64::min);
        let origin = particles.origin;
        let mut counts = self.sampler.counts();
        counts.refusal = counts.refusal.map(|refusal| refusal.counted_from_zero(origin));
        let evaluations =
            counts.seeding_evaluations + counts.generation_evaluations + counts.relaxation_evaluations;
        let stop_reason = self.last.as_ref().and_then(|progress| progress.stop_reason);
        let mut sampled = self.sampler.sampled();
        for witness in &mut sampled.without {
            witness.position = (origin + DVec3::from_array(witness.position)).to_array();
        }
        let mut places = self.measured.places.clone();
        for hole in &mut places.holes {
            hole.position = (origin + Vec3::from_array(hole.position).as_dvec3()).as_vec3().to_array();
        }
        let warnings = self.warnings_of_run(&counts, &sampled, facing);
        let is_outside = |slots: &&Slots| (0..Slots::COUNT).any(|slot| slots.get(slot) == SlotFate::Outside);
        let border = particles.slots.iter().filter(is_outside).count();
        Report {
            count,
            levels: level_counts.len() as u32,
            components_seeded: counts.seeds,
            components: self.measured.figures.components,
            search: self.sampler.search(),
            sampled,
            undecided_cells: self.sampler.undecided_cells(),
            singular_points: self.sampler.singular_points(),
            gaps_filled: counts.gaps_filled,
            radius: self.sampler.radius(),
            radius_min,
            radius_max,
            evaluations,
            evaluations_per_particle: counts.front_evaluations as f64 / count.max(1) as f64,
            fates: counts.fates,
            border,
            cut: self.cut(border),
            refined_levels: counts.refined_levels,
            stop_reason,
            warnings,
            level_counts,
            energy: Some(self.sampler.energy()).filter(|energy| !energy.is_empty()).map(<[f64]>::to_vec),
            digest: format!("{:016x}", particles.digest()),
            quality: (count > 0).then_some(self.measured.figures),
            quality_before: self.front_figures,
            nearest_histogram: self.measured.histogram.clone(),
            places,
        }
    }

    /// Per-particle columns of the last report.
    #[must_use]
    pub fn measured(&self) -> &quality::Report {
        &self.measured
    }
}
