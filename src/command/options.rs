//! The options that say how a surface is sampled, one for each setting in the table.

use crate::failure::{Failure, percent};
use clap::builder::PossibleValuesParser;
use clap::error::ErrorKind;
use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgMatches, Args, Command, Error, FromArgMatches};
use marching_particles::Bounds;
use marching_particles::Settings;
use marching_particles::field::formula;
use marching_particles::field::formula::FormulaErrorKind;
use marching_particles::internal::math::{grouped, shortest_text};
use marching_particles::internal::session::{
    Setting, SettingGroup, SettingKind, SettingValue, SolidSettings, settings, without_effect,
};
use serde_json::{Map, Value as Json};
use std::ops::RangeInclusive;

/// The option for sizes that follow the curvature, and the setting whose value it chooses.
const ADAPTIVE: &str = "adaptive";
const UNIFORM: &str = "uniform";
const SAMPLING: &str = "sampling";
/// How the sizes follow the curvature.
const LAW: &str = "radius_law";
/// The option for a number of particles. It also chooses the size mode.
const COUNT: &str = "count";
const SIZE_MODE: &str = "size_mode";
/// The option for exactly that number, and the setting whose value it chooses.
const EXACTLY: &str = "exactly";
const COUNTING: &str = "counting";
/// The method and the pattern of a front, which others need.
const METHOD: &str = "method";
const PATTERN: &str = "pattern";
/// The option for a radius.
const RADIUS: &str = "radius_share";
/// The largest slope of the sizes, with or without a curvature.
const GRADING: &str = "grading";
/// The setting that holds a radius as a length, and prevails over the share.
const LENGTH: &str = "radius";

/// A length on the command line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Length {
    /// Share of the box diagonal.
    Share(f64),
    /// In the field's units.
    Units(f64),
}

impl Length {
    /// The length as a share of the box diagonal.
    fn share(self, diagonal: f64) -> f64 {
        match self {
            Self::Share(share) => share,
            Self::Units(length) => length / diagonal,
        }
    }
}

/// A number from an argument, in the language of formulas: `0.5`, `pi/2`, `2*10^5`.
pub(crate) fn number(text: &str) -> Result<f64, String> {
    formula::number(text).map_err(|error| match error.kind {
        FormulaErrorKind::Empty => format!("`{text}` is not a number"),
        _ => error.message,
    })
}

/// A whole number from an argument.
pub(crate) fn whole(text: &str, range: &RangeInclusive<u64>) -> Result<u64, String> {
    whole_up_to(text, range, *range.end())
}

/// A whole number from an argument. Numbers above the range, up to `taken`, are accepted here;
/// whoever uses them refuses them.
fn whole_up_to(text: &str, range: &RangeInclusive<u64>, taken: u64) -> Result<u64, String> {
    let number = number(text)?;
    let (least, most) = (*range.start(), *range.end());
    if number.fract() != 0.0 {
        return Err(format!("{} is not a whole number", shortest_text(number)));
    }
    if number < least as f64 || number > taken as f64 {
        return Err(format!("{} is not in {least}..={most}", shortest_text(number)));
    }
    Ok(number as u64)
}

/// The parts of a text between commas outside brackets.
pub(crate) fn list(text: &str) -> Vec<&str> {
    let (mut depth, mut start, mut parts) = (0_i32, 0, Vec::new());
    for (at, c) in text.char_indices() {
        match c {
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(&text[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    parts.push(&text[start..]);
    parts
}

/// A length from an argument.
pub(crate) fn length(text: &str) -> Result<Length, String> {
    let length = match text.strip_suffix('%').map(str::trim) {
        // The decimal is rounded only once, so that every share can be given.
        Some(percent) => match format!("{percent}e-2").parse() {
            Ok(share) => Length::Share(share),
            Err(_) => Length::Share(number(percent)? / 100.0),
        },
        None => Length::Units(number(text)?),
    };
    match length {
        Length::Share(value) | Length::Units(value) if value > 0.0 => Ok(length),
        _ => Err("it must be positive".to_owned()),
    }
}

/// The sampling settings from the options. Lengths, except for the radius, become shares of the
/// box's diagonal once the box is known.
#[derive(Clone, Debug, Default)]
pub(crate) struct SamplingOptions {
    values: Map<String, Json>,
    lengths: Vec<(&'static str, Length)>,
    /// The settings that were given on the command line.
    given: Vec<Setting>,
}

impl SamplingOptions {
    /// The settings for a box, with defaults for options that were not given.
    ///
    /// # Panics
    ///
    /// Never: clap has checked every value.
    pub(crate) fn settings(&self, bounds: &Bounds) -> Settings {
        let mut values = self.values.clone();
        for (name, length) in &self.lengths {
            let (name, value) = match (*name, *length) {
                (RADIUS, Length::Units(length)) => (LENGTH, length),
                (name, length) => (name, length.share(bounds.diagonal())),
            };
            values.insert(name.to_owned(), value.into());
        }
        serde_json::from_value(values.into()).expect("clap has checked the values")
    }

    /// Whether a radius was given.
    pub(crate) fn has_radius(&self) -> bool {
        self.lengths.iter().any(|(given, _)| *given == RADIUS)
    }

    /// Whether sizes that follow the curvature were requested.
    pub(crate) fn is_adaptive(&self) -> bool {
        self.values.get(SAMPLING).is_some_and(|sampling| sampling == ADAPTIVE)
    }

    /// Whether a number of particles was given.
    pub(crate) fn is_counted(&self) -> bool {
        self.given.iter().any(|setting| setting.name == COUNT)
    }

    /// Requests particles of one size with this spacing.
    pub(crate) fn space_evenly(&mut self, spacing: Length) {
        let radius = match spacing {
            Length::Share(share) => Length::Share(0.5 * share),
            Length::Units(length) => Length::Units(0.5 * length),
        };
        self.lengths.push((RADIUS, radius));
    }

    /// Fills in from `settings` what was not given. A spacing by a formula, if it `is_spaced`,
    /// replaces a radius.
    pub(crate) fn complete(&mut self, settings: &Settings, is_spaced: bool) {
        // A given radius excludes a wanted number and varying sizes.
        if self.has_radius() {
            self.values.entry(SIZE_MODE).or_insert("radius".into());
            self.values.entry(SAMPLING).or_insert(UNIFORM.into());
        }
        let is_sized = is_spaced || self.has_radius() || self.is_counted() || self.is_adaptive();
        let Ok(Json::Object(known)) = serde_json::to_value(settings) else { return };
        for (name, value) in known {
            let is_length = self.lengths.iter().any(|(given, _)| *given == name);
            if !(is_length || is_sized && name == LENGTH) {
                self.values.entry(name).or_insert(value);
            }
        }
    }

    /// Checks that every given setting has an effect together with the others and, if `is_spaced`,
    /// with a spacing by a formula.
    pub(crate) fn check(&self, is_spaced: bool) -> Result<(), Failure> {
        let given: Vec<&str> = self.given.iter().map(|setting| setting.name).collect();
        let values = self.settings(&Bounds::cube(1.0));
        match without_effect(&given, &values, &SolidSettings::default(), is_spaced) {
            None => Ok(()),
            Some((setting, condition)) => {
                let needed = match (condition.name, condition.equal) {
                    (SAMPLING, _) if setting.name == GRADING => "--adaptive or a --spacing by a formula",
                    (SAMPLING, _) => "--adaptive",
                    (PATTERN, _) => "--pattern hexagonal",
                    (METHOD, _) => "--method front",
                    (LAW, true) => "--law chord-error",
                    (LAW, false) => "--law max-curvature or --law sum-of-curvatures",
                    (name, _) => name,
                };
                let option = setting.option();
                Err(Failure::Usage(format!("--{option} has no effect without {needed}")))
            }
        }
    }

    /// Whether a given length becomes a share of the box in the settings.
    pub(crate) fn depends_on_box(&self) -> bool {
        self.lengths.iter().any(|(name, length)| *name != RADIUS && matches!(length, Length::Units(_)))
    }
}

impl Args for SamplingOptions {
    fn augment_args(command: Command) -> Command {
        command.args(settings().iter().filter(|setting| is_of_run(setting)).map(option))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for SamplingOptions {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        let mut sampling = Self::default();
        sampling.update_from_arg_matches(matches)?;
        Ok(sampling)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        let missing = |name: &str| Error::raw(ErrorKind::InvalidValue, format!("--{name} has no value"));
        for setting in settings() {
            let name = setting.name;
            if !is_of_run(&setting) || matches.value_source(name) != Some(ValueSource::CommandLine) {
                continue;
            }
            self.given.push(setting);
            let value: Json = match setting.kind {
                SettingKind::Choice if name == SAMPLING => ADAPTIVE.into(),
                SettingKind::Choice if name == COUNTING => EXACTLY.into(),
                SettingKind::Text => {
                    matches.get_one::<String>(name).ok_or_else(|| missing(name))?.as_str().into()
                }
                SettingKind::Choice => {
                    let word: &String = matches.get_one(name).ok_or_else(|| missing(name))?;
                    word.replace('-', "_").into()
                }
                SettingKind::Integer => (*matches.get_one::<u64>(name).ok_or_else(|| missing(name))?).into(),
                SettingKind::Number if setting.is_share() => {
                    let length = *matches.get_one(name).ok_or_else(|| missing(name))?;
                    self.lengths.push((name, length));
                    continue;
                }
                SettingKind::Number | SettingKind::Formula => {
                    (*matches.get_one::<f64>(name).ok_or_else(|| missing(name))?).into()
                }
            };
            if name == COUNT {
                self.values.insert(SIZE_MODE.to_owned(), COUNT.into());
            }
            self.values.insert(name.to_owned(), value);
        }
        Ok(())
    }
}

/// Whether a setting has an option here. The options of the surface include more detailed ones for
/// the box.
fn is_of_run(setting: &Setting) -> bool {
    setting.name != SIZE_MODE && setting.group != SettingGroup::Box
}

/// The option of a setting.
fn option(setting: &Setting) -> Arg {
    let needs_adaptive = setting.needs(SAMPLING, ADAPTIVE);
    let heading = if needs_adaptive || setting.name == SAMPLING { "Adaptive sampling" } else { "Sampling" };
    let mut arg = Arg::new(setting.name).long(setting.option()).help(help(setting)).help_heading(heading);
    if setting.needs(SAMPLING, UNIFORM) {
        arg = arg.conflicts_with(SAMPLING);
    }
    if setting.needs(SIZE_MODE, "radius") {
        arg = arg.conflicts_with(COUNT);
    }
    if setting.name == COUNTING {
        return arg.action(ArgAction::SetTrue).requires(COUNT);
    }
    if setting.name == SAMPLING {
        return arg.action(ArgAction::SetTrue);
    }
    match setting.kind {
        SettingKind::Text => arg.value_name("FORMULA"),
        SettingKind::Choice => {
            let words = setting.choices.iter().map(|choice| choice.value.replace('_', "-"));
            arg.value_name("WORD").value_parser(PossibleValuesParser::new(words.collect::<Vec<_>>()))
        }
        SettingKind::Integer => {
            let (min, max) = setting.accepted().into_inner();
            // Counts that are too large are left to the settings, whose message says what they
            // count.
            let largest = if max > f64::from(u32::MAX) { u64::MAX } else { u32::MAX.into() };
            let range = min as u64..=max as u64;
            arg.value_name("N").value_parser(move |text: &str| whole_up_to(text, &range, largest))
        }
        SettingKind::Number if setting.is_share() => arg.value_name("SHARE%|LENGTH").value_parser(length),
        SettingKind::Number | SettingKind::Formula => arg.value_name("NUMBER").value_parser(number),
    }
}

/// Help text of the option of a setting, with its default.
fn help(setting: &Setting) -> String {
    let help = setting.help.trim_end_matches('.');
    let default = match setting.default {
        _ if [SAMPLING, COUNT, COUNTING].contains(&setting.name) => return help.to_owned(),
        SettingValue::Choice(value) => value.replace('_', "-"),
        SettingValue::Integer(whole) => grouped(whole as usize),
        SettingValue::Number(share) if setting.is_share() => percent(share),
        SettingValue::Number(number) => shortest_text(number),
    };
    format!("{help} [default: {default}]")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn length_is_a_share_or_in_units() {
        assert_eq!(length("0.6%"), Ok(Length::Share(0.006)));
        assert_eq!(length("2 %"), Ok(Length::Share(0.02)));
        assert_eq!(length("0.7%"), Ok(Length::Share(0.007)));
        assert_eq!(length("0.01"), Ok(Length::Units(0.01)));
        assert_eq!(length("sqrt(2)/4"), Ok(Length::Units(2_f64.sqrt() / 4.0)));
        assert_eq!(length("1/2%"), Ok(Length::Share(0.005)));
        for bad in ["0", "-1%", "nan", "inf", "", "%", "1%%"] {
            assert!(length(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn counts_and_lists_are_numbers_of_the_formula_language() {
        assert_eq!(whole("2*10^5", &(1..=1_000_000)), Ok(200_000));
        assert_eq!(whole("1e3", &(1..=1_000)), Ok(1_000));
        for bad in ["0", "1001", "1/3", "x", "", "-1"] {
            assert!(whole(bad, &(1..=1_000)).is_err(), "{bad}");
        }
        assert_eq!(list("max(1, 2),-pi"), ["max(1, 2)", "-pi"]);
    }
}
