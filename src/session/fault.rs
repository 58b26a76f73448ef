//! Why a command was refused. A refused command changes nothing.

use crate::field::formula::{FormulaError, FormulaErrorKind, Mended};
use core::fmt;
use serde::Serialize;

/// Kind of the error with which a command is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum FaultKind {
    /// The request is not JSON, or not of the right form.
    Request,
    /// A setting is out of its range, or the memory does not hold the run.
    Settings,
    /// The formula of the thickness has a mistake; the span is in it.
    Thickness,
    /// The formula of the spacing has a mistake; the span is in it.
    Spacing,
    /// The formula of a value at the particles has a mistake; the span is in it.
    Value,
    /// A run would have more particles than the limit allows, see [`Fault::excess`].
    TooMany,
    /// There is no surface of that name.
    UnknownSurface,
    /// The clip box is not valid.
    Box,
    /// The centres and coefficients do not describe a field.
    Points,
    /// The file is no image, or the image has no such surface.
    Image,
    /// The file is no mesh, or the mesh has no such surface.
    Mesh,
    /// The file of a mesh has only points.
    NoFaces,
    /// The mesh encloses nothing.
    NoSolid,
    /// The formula has this mistake.
    #[serde(untagged)]
    Formula(FormulaErrorKind),
}

/// The error with which a command is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error, Serialize)]
#[error("{message}")]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Fault {
    /// Kind of the error.
    pub kind: FaultKind,
    /// The error as a sentence for the user, in plain text.
    pub message: String,
    /// Start of the mistake in the formula, in UTF-16 code units, as the selection of a text field
    /// counts.
    pub start: u32,
    /// End of the mistake in the formula, in UTF-16 code units.
    pub end: u32,
    /// Text that would correct the span, if there is a good guess.
    pub suggestion: Option<String>,
    /// Texts for the span, each with another meaning, where the formula has several readings.
    pub choices: Box<[String]>,
    /// The formula with every mistake of this kind corrected, if there are several.
    pub mended: Option<Box<Mended>>,
    /// The unknown name, which could become a slider.
    pub name: Option<String>,
    /// The excess of particles, if the error is [`FaultKind::TooMany`].
    pub excess: Option<Box<Excess>>,
}

/// Excess of the expected particles of a run over the limit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Excess {
    /// Expected number of particles.
    pub expected: u32,
    /// Largest number of particles that a run may have.
    pub limit: u32,
    /// Factor on all radii that keeps the run within the limit.
    pub factor: f64,
}

impl Fault {
    /// An error that is not about a formula.
    #[must_use]
    pub fn new(kind: FaultKind, message: &impl fmt::Display) -> Self {
        let message = message.to_string();
        Self {
            kind,
            message,
            start: 0,
            end: 0,
            suggestion: None,
            choices: Box::default(),
            mended: None,
            name: None,
            excess: None,
        }
    }

    /// An error in the formula `text`.
    #[must_use]
    pub fn in_formula(error: FormulaError, text: &str) -> Self {
        let span = error.utf16_span(text);
        Self {
            start: span.start as u32,
            end: span.end as u32,
            suggestion: error.suggestion,
            choices: error.choices,
            mended: error.mended,
            name: error.name,
            ..Self::new(FaultKind::Formula(error.kind), &error.message)
        }
    }

    /// An error in the formula `text` of the thickness.
    #[must_use]
    pub fn in_thickness(error: FormulaError, text: &str) -> Self {
        let message = format!("Thickness: {}", error.message);
        Self { kind: FaultKind::Thickness, message, ..Self::in_formula(error, text) }
    }

    /// An error in the formula `text` of the spacing.
    #[must_use]
    pub fn in_spacing(error: FormulaError, text: &str) -> Self {
        let message = format!("Spacing: {}", error.message);
        Self { kind: FaultKind::Spacing, message, ..Self::in_formula(error, text) }
    }
}
