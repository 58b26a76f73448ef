//! Why a command was refused, as the page shows it.

use super::FieldError;
use crate::field::formula::{FormulaError, FormulaErrorKind, Mended};
use core::fmt;
use serde::Serialize;

/// What a refused command was about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum FaultKind {
    /// The request is not JSON, or not of the right form.
    Request,
    /// A setting is out of its range, or the memory does not hold the run.
    Settings,
    /// A run would have more particles than are followed, see [`Fault::excess`].
    TooMany,
    /// No surface of that name.
    UnknownSurface,
    /// The clip box is not one.
    Box,
    /// The points make no field.
    Points,
    /// The formula has this mistake.
    #[serde(untagged)]
    Formula(FormulaErrorKind),
}

/// The error with which a command is refused.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Fault {
    /// What it is about.
    pub kind: FaultKind,
    /// One sentence for a person; plain text.
    pub message: String,
    /// Where the mistake begins in the formula, in UTF-16 code units, as the selection of a text field counts.
    pub start: usize,
    /// Where it ends.
    pub end: usize,
    /// Text that would mend the span, if there is a good guess.
    pub suggestion: Option<String>,
    /// The formula with every mistake of this kind mended, if there are several.
    pub mended: Option<Box<Mended>>,
    /// Unknown names that could become sliders.
    pub names: Vec<String>,
    /// By how much there would be too many particles, if that is what it is about.
    pub excess: Option<Excess>,
}

/// By how much a run would have more particles than are followed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Excess {
    /// Particles to expect.
    pub expected: u32,
    /// The most that are followed.
    pub limit: u32,
    /// By what all radii have to be multiplied.
    pub factor: f64,
}

impl Fault {
    /// What is wrong with anything but a formula.
    #[must_use]
    pub fn new(kind: FaultKind, message: &impl fmt::Display) -> Self {
        let message = message.to_string();
        Self {
            kind,
            message,
            start: 0,
            end: 0,
            suggestion: None,
            mended: None,
            names: Vec::new(),
            excess: None,
        }
    }

    /// What is wrong with the formula `text`.
    #[must_use]
    pub fn in_formula(error: FormulaError, text: &str) -> Self {
        let span = error.utf16_span(text);
        Self {
            kind: FaultKind::Formula(error.kind),
            message: error.message,
            start: span.start,
            end: span.end,
            suggestion: error.suggestion,
            mended: error.mended,
            names: error.names,
            excess: None,
        }
    }

    /// Why a field was refused whose formula, if it has one, is `text`.
    #[must_use]
    pub fn in_field(error: FieldError, text: &str) -> Self {
        match error {
            FieldError::Formula(error) => Self::in_formula(error, text),
            FieldError::UnknownSurface(_) => Self::new(FaultKind::UnknownSurface, &error),
            FieldError::Box => Self::new(FaultKind::Box, &error),
            FieldError::Points(_) => Self::new(FaultKind::Points, &error),
        }
    }
}
