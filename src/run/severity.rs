//! The severity of a warning.

use serde::Serialize;

/// A severity says what a warning means for the result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(test, derive(ts_rs::TS))]
#[non_exhaustive]
pub enum Severity {
    /// Nothing is known to be wrong, and nothing needs to be done: the warning reports what was
    /// found or done, or repeats a figure of the report.
    Note,
    /// The result may be incomplete, or less even than it could be.
    Caution,
    /// A part of the surface is missing or wrong.
    Fault,
}

impl Severity {
    /// Its name, as reports in JSON have it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Note => "note",
            Self::Caution => "caution",
            Self::Fault => "fault",
        }
    }
}
