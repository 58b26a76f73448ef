//! The session of a user: a field that is changed by requests, and runs on it. Commands go in,
//! changes and reports come out; there is no clock, no GPU and no platform in here.

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
pub use fitting::{BeyondPoints, BoxCell, BoxFaces, BoxMode, SolidSettings};
pub use image::{ImageFacts, ImageInfo, ImagePromise, LabelFacts};
#[cfg(all(feature = "images", feature = "points"))]
pub use mesh::OpenedMesh;
pub use mesh::{MeshInfo, MeshPart, MeshScan};
#[cfg(feature = "images")]
pub use opened::OpenedSource;
pub use record::{FileRecord, FileRequest};
pub use setting::{
    Choice, Condition, Setting, SettingGroup, SettingKind, SettingScale, SettingValue, settings,
    without_effect,
};
pub use spacing::SpacingText;

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
    /// Text of the formula, in the place of the surface's.
    pub formula: Option<String>,
    /// Values of parameters by name.
    pub parameters: BTreeMap<String, f64>,
    /// Parameters that the formula's unknown names become.
    pub declare: Vec<Parameter>,
    /// Clip box. Without one it is that of the surface, or fitted (see [`Session::fit`]).
    pub bounds: Option<Bounds>,
    /// Points that the surface is to pass through: the parameters change for it
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
    /// Clip box, whose faces close the solid where they are to; before [`Session::fit`] or a start
    /// it may be that of the formula before.
    pub bounds: Bounds,
    /// Whether the surface, closed by no box, is bounded, if the box was fitted to it.
    pub reach: Option<Reach>,
    /// Period of the surface along each axis: 0 if it does not change along it, none if it is not
    /// known to be periodic.
    pub periods: [Option<f64>; 3],
    /// The formula as MathML; none if there is no formula.
    pub mathml: Option<MathNode>,
    /// What has become of the surface that was to pass through the pins of the request; none
    /// without pins.
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
        /// The formula whose operand the model is, if one is sampled in its place.
        within: Option<ModelFormula>,
    },
    /// The surface of an image or a triangle mesh.
    #[cfg(feature = "images")]
    Opened(Box<OpenedSource>),
    /// The field of a function of the program.
    Function(Arc<dyn Field>),
}

/// A formula in which the model from points is an operand, by the name [`MODEL`].
#[derive(Clone, Debug)]
pub struct ModelFormula {
    text: String,
    parameters: Vec<Parameter>,
    /// The names among the parameters that were not declared.
    auto: Vec<String>,
    mathml: MathNode,
    field: Combined,
}

/// Two are equal that are written and set alike, whatever the model.
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
    /// The run. Its field and its box change through the session alone.
    pub run: Run<Source>,
    surface: Option<&'static Surface>,
    declared: Vec<Parameter>,
    /// The box that was given with the field, or that of its surface.
    own: Bounds,
    /// The clip box. A run samples in it, or in a box around the solid that it closes.
    clip: Bounds,
    /// Whether the surface, closed by no box, is bounded, if the clip box was fitted to it.
    reach: Option<Reach>,
    fitting: Fitting,
    /// The spacing of the next runs, where a formula gives it.
    spacing: Option<SpacingText>,
    /// The spacing of the next runs, where a function of the program gives it.
    spacing_function: Option<Spacing>,
    /// The record of the present run.
    made: Option<FileRecord>,
    /// Whether the box of the present run is the one that a search for it finds.
    is_box_found: bool,
    /// The settings of the last start, and its spacing by a formula.
    started: Option<Settings>,
    spaced: Option<SpacingText>,
    /// How far the joined mesh is from the one that was opened.
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
            made: None,
            is_box_found: false,
            started: None,
            spaced: None,
            #[cfg(all(feature = "images", feature = "points"))]
            comparison: mesh::Comparison::None,
        }
    }

    /// A session whose first formula is that of no surface of the gallery, whatever its text.
    #[must_use]
    pub fn without_surface() -> Self {
        Self { surface: None, declared: Vec::new(), own: FALLBACK, clip: FALLBACK, ..Self::new() }
    }

    fn source(&self) -> &Source {
        self.run.field()
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
    /// [`Session::start`]. A thickness by a formula ends with a field that does not have its names:
    /// the solid is to be [chosen](Session::choose) again.
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
        // A box stays given while the present field is changed.
        let is_given = request.bounds.is_some() || surface.is_none() && self.fitting.is_given;
        let present = self.source().formula();
        let text = match (&request.formula, surface, present) {
            (Some(text), _, _) => text.as_str(),
            (None, Some(surface), _) => surface.formula,
            (None, None, Some(field)) => field.text(),
            // Of a model from points or a function only the box can be changed.
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

    /// The parameters that are declared for a formula: those of its surface or of the present
    /// formula, and those of the request.
    fn declared_for(
        &self,
        surface: Option<&'static Surface>,
        text: &str,
        request: &FieldRequest,
    ) -> Vec<Parameter> {
        // A declared parameter that the formula does not use stays declared: it may come back with
        // the next key.
        let mut declared = surface.map_or_else(
            || if request.formula.is_none() { self.declared.clone() } else { Vec::new() },
            |surface| surface.parameters.to_vec(),
        );
        // What a parameter stands for, and which values it can have, is known in the surface's own
        // formula alone.
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

    /// The field of a formula with the values that a request asks for.
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

    /// Samples the field of a formula from now on, in the box `own`, which was given or is to be
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
        // A formula that was compiled anew is not yet made to the solid that is to be sampled.
        let is_same = is_same_text
            && present.is_some_and(|p| {
                p.parameters() == field.parameters()
                    && (p.thickness(), p.closing_box()) == (field.thickness(), field.closing_box())
            });
        // A box that is to be fitted stays what it was until it is.
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
    /// request on its surface, in the box of the request or in that of the model with room for the
    /// pulls. A formula of the request has the model as an operand, see [`Formula::with_model`].
    /// [`Session::set_field`] with a surface or a formula changes the field back. Both end a run on
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

    /// The formula of a request, in which the model is an operand.
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

    /// Changes the field to that of a function of the program, in this box or in one that is fitted
    /// to its surface. Ends a run on another field, whose particles stay until the next
    /// [`Session::start`].
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

    /// Changes the field to another one, or to the formula of a request in which it is an operand
    /// by the name [`MODEL`], in the box of the request or in one that is fitted: see
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
    /// If a setting is out of its range, or there is no memory for the particles to expect.
    pub fn start(&mut self, settings: &Settings) -> Result<Start, SettingsError> {
        settings.validate()?;
        while !self.fitting.is_settled {
            self.fit(&|_| *settings, false, u32::MAX);
        }
        self.fitting.is_settled = false;
        self.made = self.beginning(settings);
        self.is_box_found = self.fitting.is_fitted && !self.fitting.is_grown;
        self.started = Some(*settings);
        self.spaced = self.spacing.clone();
        self.run.set_spacing(self.next_spacing());
        self.run.begin(settings)
    }

    /// Has the particles of the last run, which had these settings, [follow](Run::follow) its
    /// surface to the present field, in the box that [`Session::fit`] has found. What they have
    /// become is made from no record. `is_closed`: no particle is born, and none dies but where it
    /// does not come to the surface.
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
        self.made = None;
        Ok(())
    }

    /// [`Run::report`] in slices, with what the session knows of the surface. No cause is told why
    /// particles lie at the border of a model or an image, or of an open surface of the gallery,
    /// whose box was chosen for it. A closed one fills its box for the values that its sliders
    /// offer.
    pub fn measure(&mut self, measured: Measured, budget: u32) -> Option<Report> {
        self.run.measure_copy(measured, budget).map(|report| self.completed(report))
    }

    fn completed(&self, mut report: Report) -> Report {
        let has_own_box = self.run.reach().is_none()
            && self.surface.is_some_and(|surface| !surface.closed)
            && !self.fitting.is_given;
        let has_no_cause = match self.source() {
            Source::Formula(field) => field.is_constant(),
            Source::Points { .. } => true,
            // Beyond the border of an image a larger box finds nothing.
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
        #[cfg(all(feature = "images", feature = "points"))]
        if self.run.mesh().is_none() {
            self.comparison = mesh::Comparison::None;
        }
        self.run.join(budget)
    }

    /// Measures the particles at once: [`Session::measure`].
    pub fn report(&mut self) -> Report {
        let report = self.run.report_with(Measured::FrontToo);
        self.completed(report)
    }

    /// [`Run::finish_with`], with the report of the session. `tell` is called now and then with the
    /// [share of the work](crate::Reporting::fraction) that is done.
    ///
    /// # Errors
    ///
    /// The error of [`Run::finish`], and that of `tell`, which ends the measurement.
    pub fn finish<E: From<Error>>(
        mut self,
        measured: Measured,
        mut tell: impl FnMut(f64) -> Result<(), E>,
    ) -> Result<Sample, E> {
        /// Slices between two calls, some 6 ms.
        const SLICES: u32 = 256;
        self.run.check_not_empty()?;
        let mut reporting = self.run.measure(measured);
        let mut report = loop {
            match reporting.step(SLICES) {
                Some(report) => break report,
                None => tell(reporting.fraction())?,
            }
        };
        drop(reporting);
        if self.run.measured().opening.is_some() {
            // Only the field can say which of the gaps are surface.
            while self.join(SLICES).is_none() {
                tell(1.0)?;
            }
            report = self.run.reported();
        }
        let report = self.completed(report);
        Ok(self.run.into_sample(report))
    }
}

/// Sets those of the parameters that a formula has: a value for a name that it no longer has is of
/// no consequence.
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
