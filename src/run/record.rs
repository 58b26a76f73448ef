//! The record in a file: the surface and the settings of a run, from which it can be repeated.

use super::{BoxCell, BoxFaces, RunState, SolidSettings};
use crate::export::RecordText;
use crate::field::formula::{Formula, Parameter};
use crate::field::rbf::Pull;
use crate::math::Bounds;
use crate::particles::Particles;
use crate::quality::NamedValues;
use crate::sampler::{Method, Radius, Settings, SizeMode, Spacing, StopReason};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The record in a file, from which the same particles can be made again. Files store it as JSON
/// ([`RecordText`]).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct FileRecord {
    /// Version of the program.
    pub version: String,
    /// Digest of the particles, 16 hexadecimal digits.
    pub digest: String,
    /// Link to the page in this state, if the page made the file.
    #[serde(default)]
    pub link: Option<String>,
    /// Gallery surface whose formula it is.
    #[serde(default)]
    pub surface: Option<String>,
    /// Model from points, instead of a formula.
    #[serde(default)]
    pub model: Option<String>,
    /// Pulls on the surface of the model.
    #[serde(default)]
    pub pulls: Vec<Pull>,
    /// Text of the formula; empty for a model alone.
    pub formula: String,
    /// Values of its parameters.
    #[serde(default)]
    pub parameters: BTreeMap<String, f64>,
    /// Box of the run.
    pub bounds: Bounds,
    /// Box whose faces close the solid, if they do.
    #[serde(default)]
    pub faces: Option<Bounds>,
    /// Settings of the solid that is made of the surface before it is sampled.
    #[serde(default)]
    #[cfg_attr(test, ts(type = "Record<string, number | string>"))]
    pub solid: SolidSettings,
    /// Spacing of the run, if it is by a formula.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, ts(optional))]
    pub spacing: Option<SpacingText>,
    /// Columns that formulas added.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(test, ts(as = "Option<Vec<ValueText>>", optional))]
    pub values: Vec<ValueText>,
    /// Settings of the run.
    #[cfg_attr(test, ts(type = "Record<string, number | string>"))]
    pub settings: Settings,
}

/// A column of numbers at the particles, by a formula that may use the parameters of the surface.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct ValueText {
    /// Name of the column.
    pub name: String,
    /// Text of the formula.
    pub formula: String,
}

/// A spacing by a formula, as text: see [`Spacing`]. A record stores it next to the settings.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct SpacingText {
    /// Distance between neighbours, in x, y, z and the parameters of the formula whose surface is
    /// sampled, such as `0.02 + 0.1 hypot(x, y)`.
    pub formula: String,
    /// Smallest distance, used wherever the formula is below it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, ts(optional))]
    pub smallest: Option<f64>,
    /// Largest distance, used wherever the formula is above it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, ts(optional))]
    pub largest: Option<f64>,
}

/// The surface of a run as its record names it.
pub(crate) struct NamedSurface {
    /// [`FileRecord::surface`].
    pub(crate) surface: Option<String>,
    /// [`FileRecord::model`].
    pub(crate) model: Option<String>,
    /// [`FileRecord::pulls`].
    pub(crate) pulls: Vec<Pull>,
    /// [`FileRecord::formula`].
    pub(crate) formula: String,
    /// [`FileRecord::parameters`].
    pub(crate) parameters: BTreeMap<String, f64>,
    /// [`FileRecord::faces`].
    pub(crate) faces: Option<Bounds>,
    /// [`FileRecord::solid`].
    pub(crate) solid: SolidSettings,
}

impl NamedSurface {
    /// A formula, with the solid that is made of its surface.
    pub(crate) fn of(field: &Formula) -> Self {
        let faces = field.closing_box();
        Self {
            surface: field.surface().map(|surface| surface.id.to_owned()),
            faces,
            solid: SolidSettings {
                box_faces: if faces.is_some() { BoxFaces::Closed } else { BoxFaces::Open },
                box_cell: if field.is_cell() { BoxCell::Periodic } else { BoxCell::Lone },
                thickness: field.thickness().cloned().unwrap_or_default(),
                ..SolidSettings::default()
            },
            ..Self::of_text(field.text().to_owned(), field.parameters())
        }
    }

    /// A formula with these parameters.
    pub(crate) fn of_text(formula: String, parameters: &[Parameter]) -> Self {
        // Collecting a map at once sorts it, by a stable sort that takes 3 kB.
        let mut values = BTreeMap::new();
        values.extend(parameters.iter().map(|p| (p.name.to_string(), p.value)));
        Self {
            surface: None,
            model: None,
            pulls: Vec::new(),
            formula,
            parameters: values,
            faces: None,
            solid: SolidSettings::default(),
        }
    }
}

impl FileRecord {
    /// The record of a run that starts now; none if a function of the program gives the spacing,
    /// which a record cannot hold.
    pub(super) fn beginning(
        named: NamedSurface,
        bounds: Bounds,
        settings: &Settings,
        spacing: Option<&Spacing>,
    ) -> Option<Self> {
        let spacing = match spacing {
            Some(spacing) => Some(SpacingText::of(spacing)?),
            None => None,
        };
        let NamedSurface { surface, model, pulls, formula, parameters, faces, solid } = named;
        Some(Self {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            digest: String::new(),
            link: None,
            surface,
            model,
            pulls,
            formula,
            parameters,
            bounds,
            faces,
            solid,
            spacing,
            values: Vec::new(),
            settings: as_given(settings),
        })
    }

    /// The record with the digest of these particles and the columns that formulas gave.
    pub(super) fn of(self, particles: &Particles, values: &[NamedValues]) -> Self {
        Self { digest: format!("{:016x}", particles.digest()), values: ValueText::of(values), ..self }
    }

    /// The record as files hold it.
    ///
    /// # Panics
    ///
    /// Never: all of it can be JSON.
    #[must_use]
    pub fn text(&self) -> RecordText {
        RecordText::new(&serde_json::to_string(self).expect("a record is data"))
    }
}

/// The settings of a run as a record states them, without the box, which the record has itself. A
/// length stays a length; a share of the diagonal has one name.
fn as_given(settings: &Settings) -> Settings {
    let settings = Settings { bounds: None, ..*settings };
    match settings.radius {
        Some(Radius::Share(radius_share)) => {
            Settings { radius: None, radius_share, size_mode: SizeMode::Radius, ..settings }
        }
        _ => settings,
    }
}

impl ValueText {
    /// The columns that formulas gave; a record cannot hold functions.
    #[must_use]
    pub fn of(added: &[NamedValues]) -> Vec<Self> {
        let text =
            |own: &NamedValues| own.formula.clone().map(|formula| Self { name: own.name.clone(), formula });
        added.iter().filter_map(text).collect()
    }
}

impl SpacingText {
    /// The text of a spacing; none if a function of the program gives it.
    fn of(spacing: &Spacing) -> Option<Self> {
        let [smallest, largest] = spacing.limits();
        spacing.text().map(|text| Self { formula: text.to_owned(), smallest, largest })
    }

    /// Whether there is a smallest or a largest distance.
    pub(crate) fn is_limited(&self) -> bool {
        self.smallest.or(self.largest).is_some()
    }
}

impl RunState<'_> {
    /// The record of the present run, without the digest and the columns of its particles; none if
    /// a record cannot hold its surface or its spacing, or if the particles have followed a moving
    /// surface.
    pub(super) fn beginning(&self) -> Option<FileRecord> {
        let mut record = self.made.clone()?;
        if let (Method::Front, Some(progress)) = (record.settings.method, &self.last) {
            let is_whole = progress.stop_reason.is_some_and(|reason| reason != StopReason::Cancelled);
            let wanted = if is_whole { record.settings.relax_steps } else { 0 };
            // Steps made after the run count as its own: ten and one are eleven. An even surface
            // takes fewer than are wanted.
            record.settings.relax_steps = progress.relax_step.max(wanted);
        }
        Some(record)
    }

    /// The record of the present particles.
    pub(super) fn record(&self) -> Option<FileRecord> {
        Some(self.beginning()?.of(self.particles(), &self.measuring.measured.values))
    }
}
