//! Errors of the tool, with their messages and exit codes.

use marching_particles::Settings;
use marching_particles::field::formula::{FormulaErrorKind, Mended};
use marching_particles::internal::math::{shortest_text, significant};
use marching_particles::internal::session::{Fault, FaultKind, settings};
use marching_particles::sampler::SettingsError;
use std::fmt;
use std::path::PathBuf;
use std::process::ExitCode;

/// Exit code: a file could not be read or written.
pub(crate) const FILE: u8 = 1;
/// Exit code: an argument, the formula, a setting or a file of points is invalid. clap uses the
/// same code.
pub(crate) const USAGE: u8 = 2;
/// Exit code: no particle could be placed.
pub(crate) const NOTHING: u8 = 3;
/// Exit code: the limit of particles was reached.
pub(crate) const LIMIT: u8 = 4;

/// Why the tool stops with an error.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The formula is invalid.
    Formula { text: String, fault: Box<Fault> },
    /// An argument other than the formula is invalid.
    Usage(String),
    /// No particle could be placed.
    Nothing(String),
    /// A file could not be opened or read.
    Unreadable { path: PathBuf, error: std::io::Error },
    /// A file could not be written.
    File { path: PathBuf, error: std::io::Error },
    /// The reader of standard output closed it, which is not an error.
    Output,
}

impl Failure {
    pub(crate) fn code(&self) -> ExitCode {
        ExitCode::from(match self {
            Self::Formula { .. } | Self::Usage(_) => USAGE,
            Self::Nothing(_) => NOTHING,
            Self::File { .. } | Self::Unreadable { .. } => FILE,
            Self::Output => 0,
        })
    }
}

impl From<SettingsError> for Failure {
    /// The message names the options instead of the settings.
    fn from(error: SettingsError) -> Self {
        Self::Usage(refusal(&error))
    }
}

impl From<std::io::Error> for Failure {
    fn from(error: std::io::Error) -> Self {
        if error.kind() == std::io::ErrorKind::BrokenPipe {
            Self::Output
        } else {
            Self::File { path: PathBuf::from("standard output"), error }
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Formula { text, fault } => formula(f, text, fault),
            Self::Usage(message) | Self::Nothing(message) => write!(f, "error: {message}"),
            Self::Unreadable { path, error } => {
                write!(f, "error: {} could not be read: {error}", path.display())
            }
            Self::File { path, error } => {
                write!(f, "error: {} could not be written: {error}", path.display())
            }
            Self::Output => Ok(()),
        }
    }
}

/// Writes the message, the formula with carets under the span, and suggestions.
fn formula(f: &mut fmt::Formatter<'_>, text: &str, fault: &Fault) -> fmt::Result {
    write!(f, "error: {}", fault.message)?;
    // A formula of more than three terminal lines is wrapped, which would misplace the carets; an
    // error in --param has no span.
    const LONGEST: usize = 240;
    let has_span = fault.kind != FaultKind::Formula(FormulaErrorKind::BadParameter);
    if has_span && !text.is_empty() && text.len() <= LONGEST {
        // The span counts in UTF-16 code units, columns are characters.
        let units: Vec<u16> = text.encode_utf16().collect();
        let [before, end] =
            [fault.start, fault.end].map(|unit| String::from_utf16_lossy(&units[..unit as usize]));
        let first = before.rfind('\n').map_or(0, |at| at + 1);
        let last = text[before.len()..].find('\n').map_or(text.len(), |at| before.len() + at);
        // Tabs would shift the carets, so each is shown as one column.
        let line: String = text[first..last].chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
        let column = before[first..].chars().count();
        let marked = end.len().min(last).saturating_sub(before.len());
        let marked = text[before.len()..before.len() + marked].chars().count().max(1);
        write!(f, "\n\n  {line}\n  {:column$}{}", "", "^".repeat(marked))?;
    }
    if let Some(suggestion) = &fault.suggestion {
        match suggestion.as_str() {
            "" => write!(f, "\n\nhelp: leave that out")?,
            _ => write!(f, "\n\nhelp: try `{suggestion}` there")?,
        }
    }
    if !fault.choices.is_empty() {
        let choices: Vec<String> = fault
            .choices
            .iter()
            .map(|choice| if choice.is_empty() { "nothing".to_owned() } else { format!("`{choice}`") })
            .collect();
        write!(f, "\n\nhelp: try {} there", choices.join(" or "))?;
    }
    if let Some(Mended { text, places }) = fault.mended.as_deref() {
        write!(f, "\n\nhelp: mended in all {places} places: {text}")?;
    }
    if let Some(name) = &fault.name {
        write!(f, "\n\nhelp: to make it a parameter, add --param {name}=1")?;
    }
    Ok(())
}

/// Why settings are refused, with the option's name and shares in percent.
fn refusal(error: &SettingsError) -> String {
    let (name, value, min, max) = match error {
        SettingsError::OutOfRange { name, value, min, max } => (name, value, min, max),
        SettingsError::Spacing { value, .. } if !value.is_nan() => return format!("{error} (--spacing-min)"),
        _ => return error.to_string(),
    };
    // A radius that was given as a length, in the box that was found.
    if *name == "radius" {
        let [value, min, max] = [*value, *min, *max].map(significant);
        let share = Settings::range("radius_share").unwrap_or(0.0..=0.0);
        let [least, most] = [share.start(), share.end()].map(|&share| percent(share));
        return format!(
            "--radius is {value}, but must lie between {least} and {most} of the box diagonal, here {min} and {max}"
        );
    }
    let setting = settings().into_iter().find(|setting| setting.name == *name);
    let option = match setting {
        Some(setting) => setting.option(),
        // A length that is not in the table of settings, such as `spacing_max`.
        None => name.replace('_', "-"),
    };
    if setting.is_some_and(|setting| setting.is_share()) {
        let [value, min, max] = [*value, *min, *max].map(percent);
        return format!("--{option} is {value} of the box diagonal, but must lie between {min} and {max}");
    }
    let [value, min, max] = [*value, *min, *max].map(shortest_text);
    format!("--{option} is {value}, but must lie between {min} and {max}")
}

/// A share in percent, as the user types it.
pub(crate) fn percent(share: f64) -> String {
    format!("{}%", significant(100.0 * share))
}
