//! Subcommand `compare`: samples a surface by this method and by the one that the paper compares it with (§6, Table 1).

use crate::arguments::Compare;
use crate::failure::{Failure, LIMIT};
use crate::options::refusal;
use crate::outcome::Seconds;
use crate::sample::{self, Begun, Clock, bar, begin};
use crate::summary::{COLUMN, LABEL, figure, time};
use indicatif::ProgressBar;
use marching_particles::baseline::{self, Baseline};
use marching_particles::math::{Bounds, grouped};
use marching_particles::quality::{self, Figures, Sizes};
use marching_particles::sampler::{Sampling, Settings, SizeMode, StopReason};
use marching_particles::session::{Session, describe};
use serde::Serialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::{self, Write};
use std::process::ExitCode;

/// Limit of particles of the other method, relative to the number that this method places.
const LIMIT_RATIO: usize = 2;

/// Result of one of the two methods.
#[derive(Debug, Serialize)]
struct Side<S, R> {
    method: &'static str,
    count: usize,
    /// Wanted repulsion radius. In adaptive sampling, the radius of as many particles of equal size.
    radius: f64,
    /// Number of relaxation steps, or of iterations.
    steps: u32,
    evaluations: u64,
    seconds: S,
    stop_reason: R,
    /// Quality before the relaxation, if there is one.
    quality_before: Option<Figures>,
    quality: Option<Figures>,
}

/// Wall times of the other method in seconds.
#[derive(Clone, Copy, Debug, Default, Serialize)]
struct OtherSeconds {
    total: f64,
    /// Time of the last iteration, as in Table 1 of the paper.
    last_step: f64,
    quality: f64,
}

/// Results of both methods, as `--json` prints them.
#[derive(Debug, Serialize)]
struct Comparison {
    version: &'static str,
    surface: Option<String>,
    formula: String,
    parameters: BTreeMap<String, f64>,
    bounds: Bounds,
    settings: Settings,
    other_settings: baseline::Settings,
    ours: Side<Seconds, Option<StopReason>>,
    other: Side<OtherSeconds, Option<baseline::StopReason>>,
    fissions: u64,
    deaths: u64,
    /// Number of particles dropped at the end because they did not reach the surface.
    dropped: u64,
    /// Mean displacement of the particles in the last iteration, in radii.
    motion: f64,
}

pub(crate) fn run(arguments: &Compare) -> Result<ExitCode, Failure> {
    let begun = begin(&arguments.surface, &arguments.sampling, arguments.quiet)?;
    let Begun { mut session, answer, settings, predicted_count, mut seconds } = begun;
    // Methods of which one is stopped cannot be compared.
    if predicted_count > u64::from(settings.max_particles) {
        return Err(Failure::Limit(sample::over_limit(predicted_count, &settings)));
    }
    let other_settings = baseline::Settings {
        sizes: settings,
        max_iterations: arguments.iterations,
        rest: arguments.rest,
        ..baseline::Settings::default()
    };
    other_settings.validate().map_err(|error| Failure::Usage(refusal(&error)))?;
    let progress = bar(arguments.quiet);
    let last = sample::sample(&mut session, &mut seconds, &progress);
    progress.finish_and_clear();
    if session.count() == 0 {
        let reason = last.message.unwrap_or_else(|| "no particle could be placed".to_owned());
        return Err(Failure::Nothing(reason));
    }
    let clock = Clock::start();
    let report = session.report();
    seconds.quality = clock.seconds();

    let other_settings = baseline::Settings { sizes: same_size(&session, &settings)?, ..other_settings };
    let progress = bar(arguments.quiet);
    let other = sample_other(&mut session, &other_settings, &progress)?;
    progress.finish_and_clear();
    let (state, method) = (other.state, method(&settings));
    let comparison = Comparison {
        version: env!("CARGO_PKG_VERSION"),
        surface: sample::name(&arguments.surface, &answer),
        formula: answer.formula,
        parameters: answer.parameters.into_iter().map(|p| (p.name, p.value)).collect(),
        bounds: answer.bounds,
        settings,
        other_settings,
        ours: Side {
            method: "marching_particles",
            count: report.count,
            radius: report.radius,
            steps: report.energy.map_or(0, |energy| energy.len().saturating_sub(1)) as u32,
            evaluations: report.evaluations,
            seconds,
            stop_reason: report.stop_reason,
            quality_before: report.quality_before,
            quality: report.quality,
        },
        other: Side {
            method: method.0,
            count: state.particles,
            radius: other.radius,
            steps: state.iterations,
            evaluations: state.evaluations,
            seconds: other.seconds,
            stop_reason: state.stop_reason,
            quality_before: None,
            quality: other.quality,
        },
        fissions: state.fissions,
        deaths: state.deaths,
        dropped: state.dropped,
        motion: state.motion,
    };
    let mut out = io::stdout().lock();
    if arguments.json {
        writeln!(out, "{}", serde_json::to_string(&comparison).map_err(io::Error::other)?)?;
    } else {
        write(&mut out, &comparison, method.1)?;
    }
    let capped =
        report.stop_reason == Some(StopReason::Cap) || state.stop_reason == Some(baseline::StopReason::Cap);
    Ok(if capped { ExitCode::from(LIMIT) } else { ExitCode::SUCCESS })
}

/// Name of the other method, in JSON and in text.
fn method(settings: &Settings) -> (&'static str, &'static str) {
    match settings.sampling {
        Sampling::Uniform => ("witkin_heckbert", "Witkin–Heckbert"),
        Sampling::Adaptive => ("forces", "forces"),
    }
}

/// Settings of the other method with the same particle size: the radius of this run, or the same radius law.
fn same_size(session: &Session, settings: &Settings) -> Result<Settings, Failure> {
    let accepted = |name| Settings::setting(name).accepted();
    let room = (LIMIT_RATIO * session.count()).min(*accepted("max_particles").end() as usize) as u32;
    let sizes = Settings { max_particles: settings.max_particles.max(room), ..*settings };
    if settings.sampling == Sampling::Adaptive {
        return Ok(sizes);
    }
    let radius_share = session.sampler().radius() / session.bounds().diagonal();
    let (least, largest) = accepted("radius_share").into_inner();
    if !(least..=largest).contains(&radius_share) {
        return Err(Failure::Usage(format!(
            "{} particles have a radius of {:.2e} of the box's diagonal, and the other method takes {least} to {largest}; \
             give another --count, or a --box that fits the surface",
            session.count(),
            radius_share
        )));
    }
    Ok(Settings { size_mode: SizeMode::Radius, radius_share, ..sizes })
}

/// Run of the other method.
struct Other {
    state: baseline::Progress,
    radius: f64,
    seconds: OtherSeconds,
    quality: Option<Figures>,
}

/// Runs the other method to its end.
fn sample_other(
    session: &mut Session,
    settings: &baseline::Settings,
    bar: &ProgressBar,
) -> Result<Other, Failure> {
    let bounds = session.local_bounds();
    let field = session.field();
    let mut seconds = OtherSeconds::default();
    let clock = Clock::start();
    let mut other = Baseline::start(field, &bounds, settings).map_err(|e| Failure::Usage(refusal(&e)))?;
    let mut state = other.progress();
    while state.stop_reason.is_none() {
        // A step ends with an iteration, whatever is left of its budget.
        let step = Clock::start();
        let iterations = state.iterations;
        state = other.step(field, u32::MAX);
        if state.iterations > iterations {
            seconds.last_step = step.seconds();
        }
        bar.set_position(1_000 * u64::from(state.iterations) / u64::from(settings.max_iterations));
        bar.set_message(format!("iteration {}, {} particles", state.iterations, state.particles));
    }
    seconds.total = clock.seconds();
    let clock = Clock::start();
    let radii = other.radii();
    let sizes = match settings.sizes.sampling {
        Sampling::Uniform => Sizes::None,
        Sampling::Adaptive => Sizes::Given(&radii),
    };
    let options = quality::Options { sizes, ..quality::Options::default() };
    let quality = (state.particles > 0).then(|| {
        quality::measure(&other.positions(), &other.normals(), field, Some(&bounds), &options).figures
    });
    seconds.quality = clock.seconds();
    Ok(Other { state, radius: other.radius(), seconds, quality })
}

fn write(out: &mut impl Write, comparison: &Comparison, method: &str) -> io::Result<()> {
    let Comparison { ours, other, .. } = comparison;
    writeln!(out, "{}: {}", comparison.surface.as_deref().unwrap_or("formula"), comparison.formula)?;
    if !comparison.parameters.is_empty() {
        let values: Vec<String> =
            comparison.parameters.iter().map(|(name, value)| format!("{name} = {value}")).collect();
        writeln!(out, "{}", values.join(", "))?;
    }
    writeln!(out)?;
    let line = |out: &mut dyn Write, label: &str, cells: [&str; 4]| {
        let [front, ours, other, ideal] = cells;
        let width = OTHER;
        let line = format!("{label:LABEL$}{front:>COLUMN$}{ours:>COLUMN$}{other:>width$}{ideal:>COLUMN$}");
        writeln!(out, "{}", line.trim_end())
    };
    line(out, "", ["after front", "relaxed", method, "ideal"])?;
    let s = &ours.seconds;
    let front = s.seeding + s.generation + s.refinement;
    let ours_total = front + s.relaxation;
    let step =
        |seconds: f64| if ours.steps > 0 { time(seconds / f64::from(ours.steps)) } else { "–".into() };
    for (label, cells) in [
        ("Particles", ["".into(), grouped(ours.count), grouped(other.count)]),
        ("Radius", ["".into(), format!("{:.6}", ours.radius), format!("{:.6}", other.radius)]),
        ("Steps", ["".into(), grouped(ours.steps as usize), grouped(other.steps as usize)]),
        ("Time", [time(front), time(ours_total), time(other.seconds.total)]),
        ("Time of the last step", ["".into(), step(s.relaxation), time(other.seconds.last_step)]),
        ("Evaluations", ["".into(), grouped(ours.evaluations as usize), grouped(other.evaluations as usize)]),
        ("Ended", ["".into(), word(&ours.stop_reason), word(&other.stop_reason)]),
    ] {
        line(out, label, [&cells[0], &cells[1], &cells[2], ""])?;
    }
    writeln!(out)?;
    let values =
        [&ours.quality_before, &ours.quality, &other.quality].map(|figures| json!({ "quality": figures }));
    let value = |side: usize, path: &str| {
        path.split('.').try_fold(&values[side], |value, key| value.get(key)).filter(|value| !value.is_null())
    };
    let has_front = ours.quality_before.is_some();
    for row in describe().report.iter().filter(|row| row.to.is_none()) {
        // The number of components is among the quality figures too. All other rows outside of them concern the run.
        let path = if row.key == "components" { "quality.components" } else { row.key };
        let is_known = path.starts_with("quality.") && value(1, path).is_some();
        if !is_known || row.unless.is_some_and(|path| value(1, path).is_some()) {
            continue;
        }
        let [front, ours, other] = [0, 1, 2].map(|side| figure(row, value(side, path)));
        line(out, row.label, [if has_front { &front } else { "" }, &ours, &other, row.ideal])?;
    }
    writeln!(
        out,
        "\n{method} took {:.1} times as long and {:.1} times as many evaluations; {} fissions, {} deaths{}",
        other.seconds.total / ours_total,
        other.evaluations as f64 / ours.evaluations as f64,
        grouped(comparison.fissions as usize),
        grouped(comparison.deaths as usize),
        if comparison.dropped > 0 {
            format!("; {} dropped off the surface", comparison.dropped)
        } else {
            String::new()
        }
    )
}

/// Width of the column of the other method, which has a long name.
const OTHER: usize = 18;

/// Word for a stop reason, as in JSON but with spaces.
fn word(reason: &impl Serialize) -> String {
    match serde_json::to_value(reason) {
        Ok(Value::String(word)) => word.replace('_', " "),
        _ => "–".to_owned(),
    }
}
