//! The program that makes the particles of a run: in Rust with the library, in JavaScript with the
//! package for npm, in Python with its package, and as a command. It contains only what differs
//! from the defaults.

use super::setting::{Setting, SettingGroup, SettingValue, with_values};
use super::{BoxCell, BoxFaces, BoxMode, FileRecord, Session, SpacingText, ValueText};
use crate::field::formula::Thickness;
use crate::field::gallery;
use crate::math::{Bounds, grouped, shortest_text};
use crate::sampler::{Method, Radius, Sampling, Settings, SizeMode};
use core::fmt::Write as _;
use serde::Serialize;
use std::collections::BTreeMap;

/// A language in which a program can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    /// Rust, with the library.
    Rust,
    /// JavaScript, with the package for npm.
    JavaScript,
    /// Python, with its package.
    Python,
    /// A command for a POSIX shell.
    Shell,
}

impl Language {
    /// Every language, with the word that selects it.
    pub const ALL: [(&'static str, Self); 4] =
        [("rust", Self::Rust), ("js", Self::JavaScript), ("python", Self::Python), ("shell", Self::Shell)];

    /// The language that a word selects.
    #[must_use]
    pub fn named(word: &str) -> Option<Self> {
        Self::ALL.iter().find(|(name, _)| *name == word).map(|&(_, language)| language)
    }

    /// What runs a program in this language.
    fn runner(self) -> &'static str {
        match self {
            Self::Rust => "the library",
            Self::JavaScript => "the package for npm",
            Self::Python => "the Python package",
            Self::Shell => "the command line",
        }
    }
}

/// A program.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Code {
    /// Its text, which ends with a line break.
    pub text: String,
}

/// Maximum length of a line that can be broken.
const WIDTH: usize = 100;

/// The settings that every language has a word of its own for.
const NAMED: [&str; 6] = ["sampling", "size_mode", "radius_share", "count", "method", "seed"];

/// The largest number up to which JavaScript represents all whole numbers.
const LAST_SAFE: u64 = (1 << 53) - 1;

impl Session {
    /// The program that makes the particles of the last run again, if the run is on a formula: all
    /// of them, even if the run was stopped; and these values at them.
    ///
    /// # Errors
    ///
    /// Why there is no such program, in a sentence.
    pub fn code(&self, language: Language, values: &[ValueText]) -> Result<Code, String> {
        let (Some(record), Some(settings)) = (self.run.made(), self.started) else {
            let why =
                "these particles are of no run on a formula, or have followed a moving surface: sample again";
            return Err(why.to_owned());
        };
        if let Some(model) = &record.model {
            return Err(format!("{model} is fitted to points, and there is code for formulas alone"));
        }
        let mut settings = settings;
        // Steps that were made after the run belong to it.
        if let (Method::Front, Some(progress)) = (settings.method, self.run.progress()) {
            settings.relax_steps = settings.relax_steps.max(progress.relax_step);
        }
        let program = Program { record, values, settings, is_box_found: self.is_box_found };
        let text = match language {
            Language::Rust => program.rust(),
            Language::JavaScript => program.javascript()?,
            Language::Python => program.python()?,
            Language::Shell => program.shell()?,
        };
        Ok(Code { text })
    }
}

/// A run to write programs for.
struct Program<'a> {
    record: &'a FileRecord,
    values: &'a [ValueText],
    /// The settings of the run; a box in them is always written.
    settings: Settings,
    /// Whether the search for a box finds the one of the run.
    is_box_found: bool,
}

impl Program<'_> {
    fn is_closed(&self) -> bool {
        self.record.solid.box_faces == BoxFaces::Closed
    }

    fn is_adaptive(&self) -> bool {
        self.settings.sampling == Sampling::Adaptive
    }

    /// Whether a curvature law or a spacing, and no radius, determines the sizes.
    fn are_graded(&self) -> bool {
        self.is_adaptive() || self.record.spacing.is_some()
    }

    /// The radius, if it determines the sizes and is not the default.
    fn radius(&self) -> Option<Radius> {
        let Settings { size_mode, radius, radius_share, .. } = self.settings;
        if self.are_graded() || size_mode == SizeMode::Count {
            return None;
        }
        let is_own = radius_share != Settings::DEFAULT.radius_share;
        radius.or(is_own.then_some(Radius::Share(radius_share)))
    }

    /// The sampled box, if it has to be written. Around a closed solid it is only the box of the
    /// settings.
    fn sampled_box(&self) -> Option<Bounds> {
        let own = (!self.is_closed() && !self.is_box_found).then_some(self.record.bounds);
        self.settings.bounds.or(own)
    }

    /// The settings that have an effect and differ from the values that a size alone implies,
    /// without the [`NAMED`] ones.
    fn others(&self) -> Vec<Setting> {
        let usual = match self.settings.size_mode {
            SizeMode::Count => Settings::with_count(self.settings.count),
            SizeMode::Radius => Settings::DEFAULT,
        };
        let (values, usual) = (with_values(&self.settings), with_values(&usual));
        let is_effective = |setting: &Setting| {
            let is_grading = setting.name == "grading" && self.are_graded();
            is_grading
                || setting.when.iter().filter(|condition| setting.depends_on(condition)).all(|condition| {
                    let holds = values.iter().any(|other| {
                        other.name == condition.name && other.default == SettingValue::Choice(condition.value)
                    });
                    holds == condition.equal
                })
        };
        let is_other = |(value, usual): &(&Setting, Setting)| {
            let is_own = value.group == SettingGroup::Box || NAMED.contains(&value.name);
            !is_own && value.default != usual.default && is_effective(value)
        };
        values.iter().zip(usual).filter(is_other).map(|(value, _)| *value).collect()
    }

    /// Refuses what a package cannot express.
    fn check_plain(&self, language: Language) -> Result<(), String> {
        if self.is_closed() && self.settings.bounds.is_some() {
            let name = language.runner();
            return Err(format!(
                "{name} chooses the box around a closed solid itself: Rust can take another"
            ));
        }
        if language == Language::JavaScript && self.settings.seed > LAST_SAFE {
            let name = language.runner();
            return Err(format!(
                "{name} cannot take a seed above {LAST_SAFE}: Rust and the command line can"
            ));
        }
        if self.record.spacing.as_ref().is_some_and(SpacingText::is_limited) {
            let name = language.runner();
            return Err(format!(
                "{name} cannot limit a spacing (--spacing-min, --spacing-max): Rust and the command line can"
            ));
        }
        Ok(())
    }

    fn rust(&self) -> String {
        let Self { record, settings, .. } = self;
        let mut imports = vec!["Formula", "Settings", "sample"];
        let mut surface = vec![format!("Formula::parse({:?})?", record.formula)];
        surface.extend(record.parameters.iter().map(|(name, value)| format!(".with({name:?}, {value:?})?")));
        match record.solid.thickened() {
            Some(Thickness::Number(thickness)) => surface.push(format!(".thickened({thickness:?})")),
            Some(Thickness::Formula(text)) => surface.push(format!(".thickened_by({text:?})?")),
            None => {}
        }
        if let Some(faces) = record.faces {
            imports.push("Bounds");
            let close = if record.solid.box_cell == BoxCell::Periodic { "repeated_in" } else { "closed_by" };
            surface.push(format!(".{close}(&{})", rust_box(&faces)));
        }
        let mut made = vec![match settings.size_mode {
            SizeMode::Count => {
                format!("Settings::with_count({})", grouped(settings.count as usize).replace(',', "_"))
            }
            SizeMode::Radius => "Settings::default()".to_owned(),
        }];
        if self.is_adaptive() {
            made.push(".adaptive()".to_owned());
        }
        if settings.method == Method::Refined {
            made.push(".refined()".to_owned());
        }
        if settings.seed != 0 {
            made.push(format!(".seeded({})", settings.seed));
        }
        if let Some(bounds) = self.sampled_box() {
            imports.push("Bounds");
            made.push(format!(".in_box({})", rust_box(&bounds)));
        }
        let mut assigned = Vec::new();
        if let Some(radius) = self.radius() {
            imports.push("Radius");
            assigned.push(format!("settings.radius = Some(Radius::{radius:?});"));
        }
        for setting in self.others() {
            let value = match setting.default {
                SettingValue::Number(number) => format!("{number:?}"),
                SettingValue::Integer(whole) => grouped(whole as usize).replace(',', "_"),
                SettingValue::Choice(word) => {
                    let kind = match setting.name {
                        "gaps" => "GapPolicy",
                        "pattern" => "Pattern",
                        "counting" => "Counting",
                        _ => "LawKind",
                    };
                    imports.push(kind);
                    format!("{kind}::{}", variant(word))
                }
            };
            assigned.push(format!("settings.{} = {value};", setting.name));
        }
        if record.spacing.is_some() {
            imports.push("Spacing");
        }
        imports.sort_unstable();
        imports.dedup();
        let mut text = String::new();
        if !self.values.is_empty() {
            text.push_str("use marching_particles::run::Value;\n");
        }
        let _ = writeln!(text, "use marching_particles::{{{}}};\n", imports.join(", "));
        text.push_str("fn main() -> Result<(), Box<dyn std::error::Error>> {\n");
        push_chain(&mut text, "let surface = ", &surface, ";");
        if assigned.is_empty() {
            push_chain(&mut text, "let settings = ", &made, ";");
        } else {
            push_chain(&mut text, "let mut settings = ", &made, ";");
            assigned.iter().for_each(|line| push_line(&mut text, line));
        }
        // The surface gives the curvatures of values.
        let (particles, sampled) = if self.values.is_empty() {
            ("let particles", "surface")
        } else {
            ("let mut particles", "&surface")
        };
        match &record.spacing {
            None => push_line(&mut text, &format!("{particles} = sample({sampled}, &settings)?;")),
            Some(written @ SpacingText { smallest, largest, .. }) => {
                let formula = alone(&written.formula, &record.parameters);
                let mut spacing = vec![format!("Spacing::parse({formula:?})?")];
                spacing.extend(smallest.map(|length| format!(".at_least({length:?})")));
                spacing.extend(largest.map(|length| format!(".at_most({length:?})")));
                push_chain(&mut text, "let spacing = ", &spacing, ";");
                push_line(
                    &mut text,
                    &format!("{particles} = sample({sampled}, &settings.spaced(spacing))?;"),
                );
            }
        }
        for ValueText { name, formula } in self.values {
            let formula = alone(formula, &record.parameters);
            let value = format!("&Value::parse({formula:?})?");
            push_line(&mut text, &format!("particles.add_value(&surface, {name:?}, {value})?;"));
        }
        push_line(&mut text, "println!(\"{} particles\", particles.report().count);");
        push_line(&mut text, "Ok(())");
        text.push_str("}\n");
        text
    }

    /// The arguments besides the formula, as Python and JavaScript name them.
    fn arguments(&self, language: Language) -> Result<Vec<String>, String> {
        self.check_plain(language)?;
        let Self { record, settings, .. } = self;
        let is_python = language == Language::Python;
        let (quote, is, yes) = if is_python { ('"', "=", "True") } else { ('\'', ": ", "true") };
        let mut given = Vec::new();
        if !record.parameters.is_empty() {
            let entries = record.parameters.iter().map(|(name, value)| {
                let is_plain = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
                let key = if is_plain && !is_python { name.clone() } else { quoted(name, quote) };
                format!("{key}: {}", shortest_text(*value))
            });
            given.push(("params", braced(&entries.collect::<Vec<_>>(), is_python)));
        }
        if settings.size_mode == SizeMode::Count {
            given.push(("count", settings.count.to_string()));
        }
        given.extend(self.radius().map(|radius| {
            let text = match radius {
                Radius::Length(length) => shortest_text(length),
                Radius::Share(share) => quoted(&percent_text(share), quote),
            };
            ("radius", text)
        }));
        if let Some(spacing) = &record.spacing {
            given.push(("spacing", quoted(&spacing.formula, quote)));
        }
        // Around a closed solid the box is the one whose faces close it.
        if let Some(Bounds { min, max }) = record.faces.or(self.sampled_box()) {
            let [min, max] = [min, max].map(|corner| corner.map(shortest_text).join(", "));
            given.push((
                "bounds",
                if is_python {
                    format!("(({min}), ({max}))")
                } else {
                    format!("{{ min: [{min}], max: [{max}] }}")
                },
            ));
        }
        if self.is_closed() {
            given.push(("closed", yes.to_owned()));
        }
        if self.is_closed() && record.solid.box_cell == BoxCell::Periodic {
            given.push(("periodic", yes.to_owned()));
        }
        match record.solid.thickened() {
            Some(Thickness::Number(thickness)) => given.push(("thickness", shortest_text(*thickness))),
            Some(Thickness::Formula(text)) => given.push(("thickness", quoted(text, quote))),
            None => {}
        }
        if self.is_adaptive() {
            given.push(("adaptive", yes.to_owned()));
        }
        if settings.method == Method::Refined {
            given.push(("method", quoted("refined", quote)));
        }
        if settings.seed != 0 {
            given.push(("seed", settings.seed.to_string()));
        }
        for setting in self.others() {
            let value = match setting.default {
                SettingValue::Number(share) if setting.is_share() => quoted(&percent_text(share), quote),
                SettingValue::Number(number) => shortest_text(number),
                SettingValue::Integer(whole) => whole.to_string(),
                SettingValue::Choice("exactly") => yes.to_owned(),
                SettingValue::Choice(word) => quoted(word, quote),
            };
            given.push((setting.argument(), value));
        }
        if !self.values.is_empty() {
            let entries = self.values.iter().map(|ValueText { name, formula }| {
                let key = if is_python { quoted(name, quote) } else { name.clone() };
                format!("{key}: {}", quoted(formula, quote))
            });
            given.push(("values", braced(&entries.collect::<Vec<_>>(), is_python)));
        }
        let given = given
            .into_iter()
            .map(|(name, value)| (if is_python { name.to_owned() } else { camel(name) }, value));
        Ok(given.map(|(name, value)| format!("{name}{is}{value}")).collect())
    }

    fn javascript(&self) -> Result<String, String> {
        let options = self.arguments(Language::JavaScript)?;
        let head = format!("const particles = await sample({}", quoted(&self.record.formula, '\''));
        let line = match &options[..] {
            [] => format!("{head});"),
            _ => format!("{head}, {{ {} }});", options.join(", ")),
        };
        let call = if options.is_empty() || line.chars().count() <= WIDTH {
            line
        } else {
            format!("{head}, {{\n  {},\n}});", options.join(",\n  "))
        };
        Ok(format!("import {{ sample }} from 'marching-particles';\n\n{call}\n"))
    }

    fn python(&self) -> Result<String, String> {
        let mut arguments = vec![quoted(&self.record.formula, '"')];
        arguments.extend(self.arguments(Language::Python)?);
        let line = format!("particles = mp.sample({})", arguments.join(", "));
        let call = if line.chars().count() <= WIDTH {
            line
        } else {
            format!("particles = mp.sample(\n    {},\n)", arguments.join(",\n    "))
        };
        Ok(format!("import marching_particles as mp\n\n{call}\n"))
    }

    fn shell(&self) -> Result<String, String> {
        let Self { record, settings, .. } = self;
        let solid = &record.solid;
        if self.is_closed() && settings.bounds.is_some() {
            let why = "the command line chooses the box around a closed solid itself: Rust can take another";
            return Err(why.to_owned());
        }
        let named = record.surface.as_deref().and_then(gallery::find);
        let mut words = vec!["marching-particles sample".to_owned()];
        match named {
            Some(surface) => words.push(format!("--surface {}", surface.id)),
            None => words.push(format!("--formula {}", in_shell(&record.formula))),
        }
        for (name, &value) in &record.parameters {
            let usual = named.map(|surface| surface.parameters.iter().find(|p| p.name == *name));
            if usual.is_none_or(|usual| usual.is_none_or(|usual| usual.value != value)) {
                words.push(format!("--param {}", in_shell(&format!("{name}={}", shortest_text(value)))));
            }
        }
        // The box of a named surface has room for a unit cell.
        let clip = record.faces.unwrap_or(record.bounds);
        let is_fixed = solid.box_mode == BoxMode::Fixed && solid.box_cell == BoxCell::Periodic;
        let is_own = named.is_some_and(|surface| solid.own_box(surface) == clip) && !is_fixed;
        let is_found = self.is_box_found || is_own;
        if let Some(bounds) = settings.bounds.or((!is_found).then_some(clip)) {
            words.push(format!("--box {}", shell_box(&bounds)));
        }
        if self.is_closed() {
            words.push("--closed".to_owned());
        }
        if solid.box_cell == BoxCell::Periodic && self.is_closed() {
            words.push("--periodic".to_owned());
        }
        if let Some(thickness) = solid.thickened() {
            words.push(format!("--thickness {}", in_shell(&thickness.to_string())));
        }
        if settings.size_mode == SizeMode::Count {
            words.push(format!("--count {}", settings.count));
        }
        words.extend(self.radius().map(|radius| match radius {
            Radius::Length(length) => format!("--radius {}", shortest_text(length)),
            Radius::Share(share) => format!("--radius {}", percent_text(share)),
        }));
        if self.is_adaptive() {
            words.push("--adaptive".to_owned());
        }
        if let Some(SpacingText { formula, smallest, largest }) = &record.spacing {
            words.push(format!("--spacing {}", in_shell(formula)));
            words.extend(smallest.map(|length| format!("--spacing-min {}", shortest_text(length))));
            words.extend(largest.map(|length| format!("--spacing-max {}", shortest_text(length))));
        }
        if settings.method == Method::Refined {
            words.push("--method refined".to_owned());
        }
        if settings.seed != 0 {
            words.push(format!("--seed {}", settings.seed));
        }
        for setting in self.others() {
            let value = match setting.default {
                SettingValue::Number(share) if setting.is_share() => percent_text(share),
                SettingValue::Number(number) => shortest_text(number),
                SettingValue::Integer(whole) => whole.to_string(),
                SettingValue::Choice(word) => word.replace('_', "-"),
            };
            words.push(format!("--{} {value}", setting.option()));
        }
        let values = self.values.iter().map(|ValueText { name, formula }| format!("{name}={formula}"));
        words.extend(values.map(|value| format!("--value {}", in_shell(&value))));
        Ok(format!("{}\n", words.join(" ")))
    }
}

/// The entries of a dictionary of Python or an object of JavaScript.
fn braced(entries: &[String], is_python: bool) -> String {
    let entries = entries.join(", ");
    if is_python { format!("{{{entries}}}") } else { format!("{{ {entries} }}") }
}

/// A formula with the values of these parameters of the surface, usable on its own.
fn alone(formula: &str, parameters: &BTreeMap<String, f64>) -> String {
    let used = parameters.iter().filter(|(name, _)| formula.contains(name.as_str()));
    let mut text: String =
        used.map(|(name, value)| format!("{name} = {}; ", shortest_text(*value))).collect();
    text.push_str(formula);
    text
}

/// A name in the camel case of JavaScript.
fn camel(name: &str) -> String {
    let mut words = name.split('_');
    let mut text = words.next().unwrap_or_default().to_owned();
    for word in words {
        let (first, rest) = word.split_at(1);
        text += &(first.to_uppercase() + rest);
    }
    text
}

/// A share in per cent that reads back as the same number: its decimal point moves by two digits.
fn percent_text(share: f64) -> String {
    let text = share.to_string();
    let (whole, fraction) = text.split_once('.').unwrap_or((&text, ""));
    let fraction = format!("{fraction:0<2}");
    let (moved, rest) = fraction.split_at(2);
    let digits = format!("{whole}{moved}");
    let whole = match digits.trim_start_matches('0') {
        "" => "0",
        digits => digits,
    };
    if rest.is_empty() { format!("{whole}%") } else { format!("{whole}.{rest}%") }
}

/// A text between quotes, as Python and JavaScript read it.
fn quoted(text: &str, quote: char) -> String {
    let mut out = String::from(quote);
    for c in text.chars() {
        match c {
            '\n' => out.push_str("\\n"),
            '\\' => out.push_str("\\\\"),
            c if c == quote => out.extend(['\\', c]),
            c if c.is_ascii_control() => {
                let _ = write!(out, "\\x{:02x}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push(quote);
    out
}

/// A text as a word of a shell.
fn in_shell(text: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_=.,-+".contains(c);
    if !text.is_empty() && text.chars().all(is_plain) {
        return text.to_owned();
    }
    format!("'{}'", text.replace('\'', "'\\''"))
}

/// The half-width of a box, if it is a cube around the origin.
fn half_width(bounds: &Bounds) -> Option<f64> {
    let half = bounds.max[0];
    (*bounds == Bounds::cube(half)).then_some(half)
}

fn shell_box(bounds: &Bounds) -> String {
    let Bounds { min, max } = *bounds;
    match half_width(bounds) {
        Some(half) => shortest_text(half),
        None if *bounds == Bounds::symmetric(max) => max.map(shortest_text).join(","),
        None => [min, max].map(|corner| corner.map(shortest_text).join(",")).join(","),
    }
}

fn rust_box(bounds: &Bounds) -> String {
    match half_width(bounds) {
        Some(half) => format!("Bounds::cube({half:?})"),
        None => format!("Bounds {{ min: {:?}, max: {:?} }}", bounds.min, bounds.max),
    }
}

/// The variant of a choice: `max_curvature` is `MaxCurvature`.
fn variant(word: &str) -> String {
    let mut name = String::new();
    for part in word.split('_') {
        let mut letters = part.chars();
        name.extend(letters.next().map(|first| first.to_ascii_uppercase()));
        name.push_str(letters.as_str());
    }
    name
}

/// Adds an indented line to a function of Rust.
fn push_line(text: &mut String, line: &str) {
    let _ = writeln!(text, "    {line}");
}

/// Adds a chain of calls, one per line if it is too long for a single line.
fn push_chain(text: &mut String, head: &str, links: &[String], tail: &str) {
    let line = format!("{head}{}{tail}", links.concat());
    if links.len() == 1 || line.chars().count() + 4 <= WIDTH {
        push_line(text, &line);
    } else {
        push_line(text, &format!("{head}{}{tail}", links.join("\n        ")));
    }
}
