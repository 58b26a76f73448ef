//! The session of a user: a field that requests change, and runs on it. Commands go in, changes and
//! reports come out; it uses no clock, no GPU and no platform function.

mod asked;
mod code;
mod describe;
mod fault;
mod fitting;
mod image;
mod mesh;
#[cfg(feature = "images")]
mod opened;
mod record;
mod setting;
mod spacing;

pub use asked::{Asked, Lengths};
pub use code::{Code, Language};
pub use describe::{Colour, Description, Fate, Limits, ReportRow, SurfaceEntry, describe};
pub use fault::{Excess, Fault, FaultKind};
pub use image::{ImageFacts, ImageInfo, ImagePromise, LabelFacts};
#[cfg(all(feature = "images", feature = "points"))]
pub use mesh::OpenedMesh;
pub use mesh::{MeshBorder, MeshInfo, MeshPart, MeshScan, MeshUnion};
#[cfg(feature = "images")]
pub use opened::OpenedSource;
pub use record::FileRequest;
pub use setting::{
    Choice, Condition, Setting, SettingGroup, SettingKind, SettingScale, SettingValue, settings,
    without_effect,
};

pub use crate::run::{
    BeyondPoints, BoxCell, BoxFaces, BoxMode, FileRecord, SolidSettings, SpacingText, ValueText,
};

use crate::extent::{FALLBACK, Reach};
use crate::field::formula::{Formula, FormulaError, FormulaErrorKind, Grip, MODEL, MathNode, Parameter};
use crate::field::gallery::{self, Surface};
use crate::field::model::ModelInfo;
use crate::field::rbf::{Pull, RbfData, RbfField, pulled_box};
use crate::field::{Combined, Field};
use crate::math::Bounds;
use crate::run::{Error, Measured, MeshAnswer, Report, Run, Sample, Start, Warning};
use crate::sampler::{FollowError, Settings, SettingsError, Spacing};
use core::ops::Deref;
use fitting::Fitting;
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Request for a field. All members are optional.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(default)]
pub struct FieldRequest {
    /// Identifier of a gallery surface to start from; without one, the present field is changed.
    pub surface: Option<String>,
    /// Text of the formula, which replaces the surface's own.
    pub formula: Option<String>,
    /// Values of parameters by name.
    pub parameters: BTreeMap<String, f64>,
    /// Parameters that the formula's unknown names become.
    pub declare: Vec<Parameter>,
    /// Clip box. Without one the surface's own is used, or one is fitted (see [`Session::fit`]).
    pub bounds: Option<Bounds>,
    /// Points that the surface should pass through; this changes parameters
    /// ([`Formula::pass_through`]).
    pub pins: Vec<[f64; 3]>,
    /// Pulls on the surface of a model from points, one after the other.
    pub pulls: Vec<Pull>,
}

/// The field as it now is.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct FieldAnswer {
    /// The model, if the field is made of points; else it is a formula.
    pub model: Option<ModelInfo>,
    /// The image, if the field is a surface of one.
    pub image: Option<ImageInfo>,
    /// The triangle mesh, if the field is the surface of one.
    pub mesh: Option<MeshInfo>,
    /// Gallery surface, if the formula is still its own.
    pub surface: Option<&'static str>,
    /// Text of the formula; empty if there is none.
    pub formula: String,
    /// Parameters with values and ranges.
    pub parameters: Vec<Parameter>,
    /// Parameters that were not declared but found in the formula.
    pub auto: Vec<String>,
    /// Clip box; its faces close the solid if that is chosen. Before [`Session::fit`] or a start it
    /// may still be the previous formula's box.
    pub bounds: Bounds,
    /// Whether the surface, before a box closes it, is bounded, if the box was fitted to it.
    pub reach: Option<Reach>,
    /// Period of the surface along each axis: 0 if it does not change along it, none if no period
    /// is known.
    pub periods: [Option<f64>; 3],
    /// The formula as MathML; none if there is no formula.
    pub mathml: Option<MathNode>,
    /// Whether the surface passes through the pins of the request, and how; none without pins.
    pub grip: Option<Grip>,
}

/// The field of a session.
#[derive(Clone)]
#[expect(clippy::large_enum_variant, reason = "there is one in a session")]
pub enum Source {
    /// The field of a formula.
    Formula(Formula),
    /// The field of a model from points.
    Points {
        /// The field.
        field: RbfField,
        /// Report of the model.
        info: ModelInfo,
        /// The formula that uses the model as an operand, if it is sampled instead.
        within: Option<ModelFormula>,
    },
    /// The surface of an image or a triangle mesh.
    #[cfg(feature = "images")]
    Opened(Box<OpenedSource>),
    /// The field of a function of the program.
    Function(Arc<dyn Field>),
}

/// A formula with the model from points as an operand, by the name [`MODEL`].
#[derive(Clone, Debug)]
pub struct ModelFormula {
    text: String,
    parameters: Vec<Parameter>,
    /// The names among the parameters that were not declared.
    auto: Vec<String>,
    mathml: MathNode,
    field: Combined,
}

/// Two are equal if their texts and parameters are, whatever the model.
impl PartialEq for ModelFormula {
    fn eq(&self, other: &Self) -> bool {
        (&self.text, &self.parameters) == (&other.text, &other.parameters)
    }
}

impl Source {
    fn formula(&self) -> Option<&Formula> {
        match self {
            Self::Formula(field) => Some(field),
            _ => None,
        }
    }

    fn shared(&self) -> Arc<dyn Field> {
        match self {
            Self::Formula(field) => Arc::new(field.clone()),
            Self::Points { within: Some(formula), .. } => Arc::new(formula.field.clone()),
            Self::Points { field, .. } => Arc::new(field.clone()),
            #[cfg(feature = "images")]
            Self::Opened(opened) => opened.shared(),
            Self::Function(field) => Arc::clone(field),
        }
    }
}

impl Deref for Source {
    type Target = dyn Field;

    fn deref(&self) -> &Self::Target {
        match self {
            Self::Formula(field) => field,
            Self::Points { within: Some(formula), .. } => &*formula.field,
            Self::Points { field, .. } => field,
            #[cfg(feature = "images")]
            Self::Opened(opened) => opened.field(),
            Self::Function(field) => &**field,
        }
    }
}

/// A run whose field is changed by requests.
pub struct Session {
    /// The run. Only the session changes its field and its box.
    pub run: Run<'static, Source>,
    surface: Option<&'static Surface>,
    declared: Vec<Parameter>,
    /// The box given with the field, or the box of its surface.
    own: Bounds,
    /// The clip box. A run samples in it, or in a box around the solid that it closes.
    clip: Bounds,
    /// Whether the surface, before a box closes it, is bounded, if the clip box was fitted to it.
    reach: Option<Reach>,
    fitting: Fitting,
    /// The spacing of the next runs, if a formula gives it.
    spacing: Option<SpacingText>,
    /// The spacing of the next runs, if a function of the program gives it.
    spacing_function: Option<Spacing>,
    /// Whether the box of the present run is the one that a search for it finds.
    is_box_found: bool,
    /// The settings of the last start, and its spacing by a formula.
    started: Option<Settings>,
    spaced: Option<SpacingText>,
    /// The surface of a file that is made for the next change of the field.
    #[cfg(feature = "images")]
    making: Option<Box<opened::Making>>,
    /// The comparison of the joined mesh with the opened one.
    #[cfg(all(feature = "images", feature = "points"))]
    comparison: mesh::Comparison,
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
            run: Run::idle(Source::Formula(surface.field()), surface.bounds),
            surface: Some(surface),
            declared: surface.parameters.to_vec(),
            own: surface.bounds,
            clip: surface.bounds,
            reach: None,
            fitting: Fitting::default(),
            spacing: None,
            spacing_function: None,
            is_box_found: false,
            started: None,
            spaced: None,
            #[cfg(feature = "images")]
            making: None,
            #[cfg(all(feature = "images", feature = "points"))]
            comparison: mesh::Comparison::None,
        }
    }

    /// A session whose first formula never counts as a surface of the gallery.
    #[must_use]
    pub fn without_surface() -> Self {
        Self { surface: None, declared: Vec::new(), own: FALLBACK, clip: FALLBACK, ..Self::new() }
    }

    fn source(&self) -> &Source {
        self.run.field()
    }

    /// The present field, to be combined with others.
    #[must_use]
    pub fn field(&self) -> Arc<dyn Field> {
        self.source().shared()
    }

    /// The description of the present field.
    #[must_use]
    pub fn answer(&self) -> FieldAnswer {
        let answer = FieldAnswer {
            model: None,
            image: None,
            mesh: None,
            surface: self.surface.map(|surface| surface.id),
            formula: String::new(),
            parameters: Vec::new(),
            auto: Vec::new(),
            bounds: self.clip,
            reach: self.reach,
            periods: [None; 3],
            mathml: None,
            grip: None,
        };
        match self.source() {
            Source::Formula(field) => FieldAnswer {
                formula: field.text().to_owned(),
                parameters: field.parameters().to_vec(),
                auto: field.auto().to_vec(),
                periods: field.surface_periods(),
                mathml: Some(field.mathml()),
                ..answer
            },
            Source::Points { info, within, .. } => {
                let answer = FieldAnswer { model: Some(info.clone()), ..answer };
                match within {
                    Some(ModelFormula { text, parameters, auto, mathml, .. }) => FieldAnswer {
                        formula: text.clone(),
                        parameters: parameters.clone(),
                        auto: auto.clone(),
                        mathml: Some(mathml.clone()),
                        ..answer
                    },
                    None => answer,
                }
            }
            #[cfg(feature = "images")]
            Source::Opened(opened) => opened.answer(answer),
            Source::Function(_) => answer,
        }
    }

    /// Changes the field, which ends a run on another one. Its particles stay until the next
    /// [`Session::start`]. A thickness by a formula is dropped if the new field does not have its
    /// names: the solid has to be [chosen](Session::choose) again.
    ///
    /// # Errors
    ///
    /// If the surface is unknown, the formula has a mistake, a value is not finite or the box is
    /// not one; nothing is changed then.
    pub fn set_field(&mut self, request: &FieldRequest) -> Result<FieldAnswer, Fault> {
        #[cfg(feature = "images")]
        if request.surface.is_none()
            && request.formula.is_none()
            && let Some(answer) = self.change_opened(request)
        {
            return answer;
        }
        let surface = match &request.surface {
            Some(id) => Some(gallery::find(id).ok_or_else(|| {
                let message = format!("there is no surface `{id}` in the gallery");
                Fault::new(FaultKind::UnknownSurface, &message)
            })?),
            None => None,
        };
        let own = request.bounds.or(surface.map(|s| s.bounds)).unwrap_or(self.own);
        check_box(&own)?;
        // A given box stays while the present field is changed.
        let is_given = request.bounds.is_some() || surface.is_none() && self.fitting.is_given;
        let present = self.source().formula();
        let text = match (&request.formula, surface, present) {
            (Some(text), _, _) => text.as_str(),
            (None, Some(surface), _) => surface.formula,
            (None, None, Some(field)) => field.text(),
            // For a model from points or a function only the box can be changed.
            (None, None, None) => {
                (self.own, self.clip, self.reach) = (own, own, None);
                self.run.set_bounds(own, None);
                return Ok(self.answer());
            }
        };
        let declared = self.declared_for(surface, text, request);
        let mut field =
            self.formula_field(text, &declared, request).map_err(|error| Fault::in_formula(error, text))?;
        let pins: Vec<DVec3> = request.pins.iter().map(|&pin| pin.into()).collect();
        let grip = (!pins.is_empty()).then(|| field.pass_through(&pins));
        let surface = surface
            .or(self.surface.filter(|_| request.surface.is_none()))
            .filter(|surface| surface.formula == field.text());
        self.take_formula(field, surface, own, is_given);
        self.declared = declared;
        Ok(FieldAnswer { grip, ..self.answer() })
    }

    /// The declared parameters of a formula: those of its surface or of the present formula, and
    /// those of the request.
    fn declared_for(
        &self,
        surface: Option<&'static Surface>,
        text: &str,
        request: &FieldRequest,
    ) -> Vec<Parameter> {
        // A declared parameter that the formula does not use stays declared: the next key may bring
        // it back.
        let mut declared = surface.map_or_else(
            || if request.formula.is_none() { self.declared.clone() } else { Vec::new() },
            |surface| surface.parameters.to_vec(),
        );
        // Only in the surface's own formula are the meaning and the range of a parameter known.
        if surface.is_some_and(|surface| surface.formula != text) {
            for parameter in &mut declared {
                *parameter = Parameter::automatic(&parameter.name);
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

    /// The field of a formula with the values of a request.
    fn formula_field(
        &self,
        text: &str,
        declared: &[Parameter],
        request: &FieldRequest,
    ) -> Result<Formula, FormulaError> {
        let mut field = match self.source().formula() {
            Some(field) if text == field.text() && declared == self.declared => field.clone(),
            _ => Formula::as_written(text, declared)?.for_sampling(),
        };
        // A named surface begins with its own values; without one the present field is changed.
        if request.surface.is_some() {
            let usual = |p: &Parameter| declared.iter().find(|d| d.name == p.name).map(|d| d.value);
            let values: Vec<(String, f64)> = field
                .parameters()
                .iter()
                .map(|p| {
                    (p.name.to_string(), usual(p).unwrap_or_else(|| Parameter::automatic(&p.name).value))
                })
                .collect();
            for (name, value) in values {
                field.set_parameter(&name, value)?;
            }
        }
        set_known(&mut field, &request.parameters)?;
        Ok(field)
    }

    /// Makes the field of a formula the present one, in the box `own`, which was given or is to be
    /// fitted. Ends a run on another field.
    fn take_formula(
        &mut self,
        field: Formula,
        surface: Option<&'static Surface>,
        own: Bounds,
        is_given: bool,
    ) {
        self.keep_thickness_of(&field);
        let present = self.source().formula();
        let is_same_text = present.is_some_and(|p| p.text() == field.text());
        // A newly compiled formula has not yet been made into the solid.
        let is_same = is_same_text
            && present.is_some_and(|p| {
                p.parameters() == field.parameters()
                    && (p.thickness(), p.closing_box()) == (field.thickness(), field.closing_box())
            });
        // A box that is to be fitted stays as it was until then.
        let is_open = !is_given && surface.is_none();
        let keeps_box = is_same_text && self.fitting.is_fitted && is_open;
        self.run.set_field(Source::Formula(field), is_same);
        if !is_same {
            self.fitting.restart();
        }
        if !keeps_box {
            self.fitting.discard();
        }
        self.fitting.is_given = is_given;
        self.surface = surface;
        self.own = own;
        self.reach = self.reach.filter(|_| keeps_box && is_same);
        if !is_open {
            self.clip = self.own_box();
        }
        // The box around a closed solid is known once it is fitted.
        if self.fitting.choice.box_faces == BoxFaces::Open {
            self.run.set_bounds(self.clip, self.reach);
        }
    }

    /// Changes the field to one from points, as `pointcloud::fit` makes it, with the pulls of a
    /// request on its surface. The box is that of the request, or the model's with room for the
    /// pulls. A formula of the request has the model as an operand, see [`Formula::with_model`].
    /// [`Session::set_field`] with a surface or a formula replaces the field. Both end a run on
    /// another field, whose particles stay until the next [`Session::start`].
    ///
    /// # Errors
    ///
    /// If the data makes no field, a pull tears the surface, the formula has a mistake or the box
    /// is not one; nothing is changed then.
    pub fn set_points(
        &mut self,
        data: impl Into<Arc<RbfData>>,
        info: ModelInfo,
        bounds: Bounds,
        request: &FieldRequest,
    ) -> Result<FieldAnswer, Fault> {
        let pulls = request.pulls.as_slice();
        let bounds = request.bounds.unwrap_or_else(|| pulled_box(&bounds, pulls));
        check_box(&bounds)?;
        let data = data.into();
        let (known, before) = match self.source() {
            Source::Points { field, within, .. } if *field.data() == data => {
                (Some(field.clone()), within.clone())
            }
            _ => (None, None),
        };
        let has_same_pulls = known.as_ref().is_some_and(|field| field.pulls() == pulls);
        let refused = |error| Fault::new(FaultKind::Points, &error);
        let mut field = known.map_or_else(|| RbfField::new(data), Ok).map_err(refused)?.untrimmed();
        field.pull(pulls).map_err(refused)?;
        let within = match &request.formula {
            Some(text) => {
                let model: Arc<dyn Field> = Arc::new(field.clone());
                Some(Self::model_formula(text, &model, request)?)
            }
            None => None,
        };
        let is_same = has_same_pulls && within == before;
        if self.fitting.choice.beyond_points == BeyondPoints::Cut {
            field = field.trimmed();
        }
        self.run.set_field(Source::Points { field, info, within }, is_same);
        self.run.set_bounds(bounds, None);
        self.surface = None;
        self.declared.clear();
        self.fitting.discard();
        (self.own, self.clip, self.reach) = (bounds, bounds, None);
        Ok(self.answer())
    }

    /// The formula of a request, with the model as an operand.
    fn model_formula(
        text: &str,
        model: &Arc<dyn Field>,
        request: &FieldRequest,
    ) -> Result<ModelFormula, Fault> {
        let mut declared = request.declare.clone();
        declared.retain(|parameter| parameter.name != MODEL);
        declared.push(Parameter::automatic(MODEL));
        let combined = || {
            let mut formula = Formula::as_written(text, &declared)?;
            set_known(&mut formula, &request.parameters)?;
            let field = formula.with_model(model)?;
            let mut parameters = formula.parameters().to_vec();
            parameters.retain(|parameter| parameter.name != MODEL);
            let (auto, mathml) = (formula.auto().to_vec(), formula.mathml());
            Ok(ModelFormula { text: text.to_owned(), parameters, auto, mathml, field })
        };
        combined().map_err(|error| Fault::in_formula(error, text))
    }

    /// Changes the field to a function of the program, in this box or in one fitted to its surface.
    /// Ends a run on another field, whose particles stay until the next [`Session::start`].
    ///
    /// # Errors
    ///
    /// If the box is not one; nothing is changed then.
    pub fn set_function(
        &mut self,
        function: Arc<dyn Field>,
        bounds: Option<Bounds>,
    ) -> Result<FieldAnswer, Fault> {
        let own = bounds.unwrap_or(FALLBACK);
        check_box(&own)?;
        self.run.set_field(Source::Function(function), false);
        self.run.set_bounds(own, None);
        self.surface = None;
        self.declared.clear();
        self.fitting.restart();
        self.fitting.discard();
        self.fitting.is_given = bounds.is_some();
        (self.own, self.clip, self.reach) = (own, own, None);
        Ok(self.answer())
    }

    /// Changes the field to another one, or to a formula of the request that uses it as an operand
    /// by the name [`MODEL`], in the box of the request or in a fitted one: see
    /// [`Session::set_function`]. The answer has the parameters of the formula.
    ///
    /// # Errors
    ///
    /// If the formula has a mistake or the box is not one; nothing is changed then.
    pub fn set_model(&mut self, model: Arc<dyn Field>, request: &FieldRequest) -> Result<FieldAnswer, Fault> {
        let Some(text) = &request.formula else { return self.set_function(model, request.bounds) };
        let ModelFormula { text, parameters, auto, mathml, field } =
            Self::model_formula(text, &model, request)?;
        let answer = self.set_function(Arc::new(field), request.bounds)?;
        Ok(FieldAnswer { formula: text, parameters, auto, mathml: Some(mathml), ..answer })
    }

    /// Starts a run on the present field.
    ///
    /// # Errors
    ///
    /// If a setting is out of its range, or there is no memory for the expected particles.
    pub fn start(&mut self, settings: &Settings) -> Result<Start, SettingsError> {
        settings.validate()?;
        while !self.fitting.is_settled {
            self.fit(&|_| *settings, false, u32::MAX);
        }
        self.fitting.is_settled = false;
        self.is_box_found = self.fitting.is_fitted && !self.fitting.is_grown;
        self.started = Some(*settings);
        self.spaced = self.spacing.clone();
        self.run.set_spacing(self.next_spacing());
        self.run.begin(settings, self.named_surface())
    }

    /// Lets the particles of the last run, which had these settings, [follow](Run::follow) its
    /// surface to the present field, in the box that [`Session::fit`] has found. They then have no
    /// record. If `is_closed`, particles are neither added nor removed, except those that do not
    /// reach the surface.
    ///
    /// # Errors
    ///
    /// If they cannot follow: a run has to start.
    pub fn follow(&mut self, settings: &Settings, is_closed: bool) -> Result<(), FollowError> {
        let is_same = self.started == Some(*settings) && self.spaced == self.spacing;
        if !self.fitting.is_settled || !is_same {
            return Err(FollowError::NotCovered);
        }
        self.run.follow_field(is_closed)?;
        self.fitting.is_settled = false;
        Ok(())
    }

    /// [`Run::report`] in slices, with what the session knows of the surface. No cause is given for
    /// particles at the border of a model or an image, or of an open surface of the gallery, whose
    /// box was chosen for it. A closed one fits into its box for all values of its sliders.
    pub fn measure(&mut self, measured: Measured, budget: u32) -> Option<Report> {
        self.forget_comparison();
        let report = self.run.measure_freely(measured, budget)?;
        Some(self.completed(report))
    }

    fn completed(&self, mut report: Report) -> Report {
        let has_own_box = self.run.reach().is_none()
            && self.surface.is_some_and(|surface| !surface.closed)
            && !self.fitting.is_given;
        let has_no_cause = match self.source() {
            Source::Formula(field) => field.is_constant(),
            Source::Points { .. } => true,
            // Beyond the border of an image a larger box adds nothing.
            #[cfg(feature = "images")]
            Source::Opened(opened) => opened.is_bordered() && !self.fitting.is_given,
            Source::Function(_) => false,
        };
        if has_own_box || has_no_cause {
            report.cut = None;
        }
        if let Source::Points { info, field, within: None } = self.source()
            && field.pulls().is_empty()
        {
            let differs = Warning::of_file(info, &report);
            report.warnings.extend(differs);
        }
        report
    }

    /// [`Run::join`], after which [`Session::compare`] has another mesh to compare.
    pub fn join(&mut self, budget: u32) -> Option<MeshAnswer> {
        self.forget_comparison();
        self.run.join(budget)
    }

    /// Forgets the comparison of a mesh that the run has no more.
    fn forget_comparison(&mut self) {
        #[cfg(all(feature = "images", feature = "points"))]
        if self.run.mesh().is_none() {
            self.comparison = mesh::Comparison::None;
        }
    }

    /// Measures the particles at once: [`Session::measure`].
    pub fn report(&mut self) -> Report {
        let report = self.run.report_with(Measured::FrontToo);
        self.completed(report)
    }

    /// [`Run::finish_with`], with the report of the session. `tell` is called now and then with the
    /// finished [share of the work](crate::run::Reporting::fraction).
    ///
    /// # Errors
    ///
    /// The error of [`Run::finish`], or of `tell`, which ends the measurement.
    pub fn finish<E: From<Error>>(
        mut self,
        measured: Measured,
        tell: impl FnMut(f64) -> Result<(), E>,
    ) -> Result<Sample, E> {
        let report = self.reported(measured, tell)?;
        Ok(self.run.into_sample(report))
    }

    /// [`Session::finish`] for a session that goes on, and whose particles may follow another
    /// surface: the sample has copies of them.
    ///
    /// # Errors
    ///
    /// Those of [`Session::finish`].
    pub fn sample<E: From<Error>>(
        &mut self,
        measured: Measured,
        tell: impl FnMut(f64) -> Result<(), E>,
    ) -> Result<Sample, E> {
        let report = self.reported(measured, tell)?;
        Ok(self.run.sampled(report))
    }

    fn reported<E: From<Error>>(
        &mut self,
        measured: Measured,
        mut tell: impl FnMut(f64) -> Result<(), E>,
    ) -> Result<Report, E> {
        /// Slices between two calls, some 6 ms.
        const SLICES: u32 = 256;
        self.run.check_not_empty()?;
        let mut reporting = self.run.measure(measured);
        let report = loop {
            match reporting.step(SLICES) {
                Some(report) => break report,
                None => tell(reporting.fraction())?,
            }
        };
        drop(reporting);
        Ok(self.completed(report))
    }
}

/// Sets the parameters that a formula has; values for other names are ignored.
fn set_known(field: &mut Formula, values: &BTreeMap<String, f64>) -> Result<(), FormulaError> {
    for (name, &value) in values {
        match field.set_parameter(name, value) {
            Err(error) if error.kind == FormulaErrorKind::BadParameter && value.is_finite() => {}
            result => result?,
        }
    }
    Ok(())
}

/// Checks that a box can be sampled.
fn check_box(bounds: &Bounds) -> Result<(), Fault> {
    bounds.check().map_err(|error| Fault::new(FaultKind::Box, &error))
}
