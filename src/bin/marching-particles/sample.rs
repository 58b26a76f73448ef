//! Subcommand `sample`: a run with its files and its report.

use crate::arguments::{BoxChoice, Sample, Surface};
use crate::failure::{Failure, LIMIT};
use crate::mesh::Mesh;
use crate::options::{Sampling, refusal};
use crate::outcome::{Outcome, Seconds};
use crate::{points, summary};
use indicatif::{ProgressBar, ProgressStyle};
use marching_particles::export::{self, Format, MeshFormat};
use marching_particles::extent::Reach;
use marching_particles::field::formula::Parameter;
use marching_particles::field::gallery;
use marching_particles::field::model;
use marching_particles::math::Bounds;
use marching_particles::pointcloud::fit::Fit;
use marching_particles::pointcloud::job::DEFAULT_CENTRES;
use marching_particles::sampler::{BoxMode, COUNT_ROOM, Phase, Progress, Settings, StopReason};
use marching_particles::session::{FieldAnswer, FieldError, FieldRequest, Session};
use std::fs::File;
use std::io::{BufWriter, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// Units of work between two readings of the clock. They take about 0.1 ms, which is the accuracy of the phases' times.
const BUDGET: u32 = 256;
/// Fixed box of a formula.
const FORMULA_BOX: Bounds = Bounds::cube(2.0);

/// A session with the requested surface, whose run has begun.
struct Begun {
    session: Session,
    answer: FieldAnswer,
    settings: Settings,
    predicted_count: u64,
    seconds: Seconds,
}

/// Sets the field and begins the run.
fn begin(surface: &Surface, sampling: &Sampling, quiet: bool) -> Result<Begun, Failure> {
    let mut session = Session::new();
    let mut seconds = Seconds::default();
    let clock = Clock::start();
    let answer = match fit(surface, quiet)? {
        Some(fit) => {
            seconds.points = clock.seconds();
            let bounds = surface.bounds.and_then(BoxChoice::given).unwrap_or(fit.bounds);
            session
                .set_points(fit.data, fit.info, bounds)
                .map_err(|error| Failure::Usage(error.to_string()))?
        }
        None => set_field(&mut session, surface)?,
    };
    let clock = Clock::start();
    let (answer, settings) = fit_box(&mut session, surface, sampling, answer);
    let start = session.start(&settings).map_err(|error| Failure::Usage(refusal(&error)))?;
    seconds.seeding += clock.seconds();
    Ok(Begun { session, answer, settings, predicted_count: start.predicted_count, seconds })
}

/// Finds the box, and the settings in it: lengths are shares of its diagonal, and it has room for the largest particles.
fn fit_box(
    session: &mut Session,
    surface: &Surface,
    sampling: &Sampling,
    mut answer: FieldAnswer,
) -> (FieldAnswer, Settings) {
    /// Rounds in which both follow each other.
    const ROUNDS: u32 = 4;
    let box_mode = match surface.bounds {
        None | Some(BoxChoice::Fit) => BoxMode::Fit,
        Some(BoxChoice::Fixed | BoxChoice::Given(_)) => BoxMode::Fixed,
    };
    let settings_in = |answer: &FieldAnswer| Settings { box_mode, ..sampling.settings(&answer.bounds) };
    for _ in 0..ROUNDS {
        let settings = settings_in(&answer);
        while session.fit(&settings, false, u32::MAX).is_none() {}
        answer = session.answer();
    }
    let settings = settings_in(&answer);
    (answer, settings)
}

/// Name of the surface, if it has one.
fn name(surface: &Surface, answer: &FieldAnswer) -> Option<String> {
    surface.surface.clone().filter(|_| answer.model.is_some()).or(answer.surface.map(str::to_owned))
}

/// Joins the particles to a mesh.
fn joined(session: &mut Session) -> Mesh {
    loop {
        if let Some(mesh) = session.join(u32::MAX) {
            return Mesh::new(&mesh);
        }
    }
}

pub(crate) fn run(arguments: &Sample) -> Result<ExitCode, Failure> {
    let formats = formats(&arguments.out, Format::of_extension, &Format::ALL)?;
    let mesh_formats = self::formats(&arguments.mesh, MeshFormat::of_extension, &MeshFormat::ALL)?;
    let begun = begin(&arguments.surface, &arguments.sampling, arguments.quiet)?;
    let Begun { mut session, answer, settings, predicted_count, mut seconds } = begun;
    let bar = bar(arguments.quiet);
    let last = sample(&mut session, &mut seconds, &bar);
    bar.finish_and_clear();
    let peak_sampling_mb = peak_mb();
    let count = session.count();
    if count == 0 {
        let reason = match (answer.reach, last.stop_reason) {
            (Some(Reach::Nowhere), Some(StopReason::NoSurface)) => {
                "there is no surface within ±10,000".to_owned()
            }
            _ => last.message.unwrap_or_else(|| "no particle could be placed".to_owned()),
        };
        return Err(Failure::Nothing(reason));
    }

    let clock = Clock::start();
    let report = session.report();
    seconds.quality = clock.seconds();
    let clock = Clock::start();
    let mesh = (!mesh_formats.is_empty()).then(|| joined(&mut session));
    seconds.mesh = clock.seconds();
    let clock = Clock::start();
    let (particles, measured) = (session.particles(), session.measured());
    for (path, format) in arguments.out.iter().zip(formats) {
        write_file(path, |out| export::write(format, particles, measured, out))?;
    }
    for (path, format) in arguments.mesh.iter().zip(mesh_formats) {
        write_file(path, |out| export::write_mesh(format, particles, measured, session.triangles(), out))?;
    }
    seconds.writing = clock.seconds();

    let capped = report.stop_reason == Some(StopReason::Cap);
    let outcome = Outcome {
        version: env!("CARGO_PKG_VERSION"),
        surface: name(&arguments.surface, &answer),
        model: answer.model,
        formula: answer.formula,
        parameters: answer.parameters.into_iter().map(|p| (p.name, p.value)).collect(),
        bounds: answer.bounds,
        settings,
        predicted_count,
        report,
        mesh,
        seconds,
        peak_mb: peak_mb(),
        peak_sampling_mb,
        files: arguments.out.iter().chain(&arguments.mesh).map(|path| path.display().to_string()).collect(),
    };
    let mut out = std::io::stdout().lock();
    if arguments.json {
        writeln!(out, "{}", serde_json::to_string(&outcome).map_err(std::io::Error::other)?)?;
    } else {
        summary::write(&mut out, &outcome)?;
    }
    if capped {
        eprintln!("warning: stopped: {}", over_limit(predicted_count, &settings));
        return Ok(ExitCode::from(LIMIT));
    }
    Ok(ExitCode::SUCCESS)
}

/// What to say of a run that meets the limit on particles.
fn over_limit(predicted_count: u64, settings: &Settings) -> String {
    // The prediction may be a little too low.
    let count = predicted_count.max(u64::from(settings.max_particles) + 1);
    format!(
        "about {count} particles of this radius would fit on the surface, more than the limit of {}; \
         choose a larger --radius, or allow them with --max-particles {}",
        settings.max_particles,
        (count as f64 * COUNT_ROOM).ceil()
    )
}

/// Format of each file. It is checked before any work is done.
fn formats<T>(
    paths: &[PathBuf],
    of_extension: impl Fn(&str) -> Option<T>,
    all: &[(&str, T)],
) -> Result<Vec<T>, Failure> {
    paths
        .iter()
        .map(|path| {
            let extension = path.extension().unwrap_or_default().to_string_lossy();
            of_extension(&extension).ok_or_else(|| {
                let known: Vec<&str> = all.iter().map(|(name, _)| *name).collect();
                Failure::Usage(format!(
                    "{} has no extension that names a format; known are {}",
                    path.display(),
                    known.join(", ")
                ))
            })
        })
        .collect()
}

/// Fit to a file of points or a built-in model, if one is requested.
fn fit(arguments: &Surface, quiet: bool) -> Result<Option<Fit>, Failure> {
    let model = arguments.surface.as_deref().and_then(model::find);
    let bar = bar(quiet || arguments.points.is_none() && model.is_none());
    let centres = arguments.centres.unwrap_or(DEFAULT_CENTRES);
    let fit = match (&arguments.points, model) {
        (Some(path), _) => Some(points::of_file(path, centres, &bar)?),
        (None, Some(model)) if arguments.formula.is_some() || !arguments.parameters.is_empty() => {
            return Err(Failure::Usage(format!(
                "the model `{}` is made of points: it has no formula and no parameters",
                model.id
            )));
        }
        (None, Some(model)) => Some(points::of_model(model.id, centres, &bar)?),
        (None, None) if arguments.centres.is_some() => {
            return Err(Failure::Usage(
                "--centres is for --points and for the models that are made of points".into(),
            ));
        }
        (None, None) => None,
    };
    bar.finish_and_clear();
    Ok(fit)
}

fn set_field(session: &mut Session, arguments: &Surface) -> Result<FieldAnswer, Failure> {
    let of_surface = arguments.surface.as_deref().and_then(gallery::find);
    // A formula of the user's has neither the parameters nor the box of the default surface.
    let declare = match of_surface {
        Some(_) => Vec::new(),
        None => arguments.parameters.iter().map(|(name, _)| Parameter::automatic(name)).collect(),
    };
    let own = arguments.formula.is_some() && of_surface.is_none();
    let request = FieldRequest {
        surface: arguments.surface.clone(),
        formula: arguments.formula.clone(),
        parameters: arguments.parameters.iter().cloned().collect(),
        declare: if own { declare } else { Vec::new() },
        bounds: match arguments.bounds {
            Some(BoxChoice::Given(bounds)) => Some(bounds),
            Some(BoxChoice::Fixed) if own => Some(FORMULA_BOX),
            _ => None,
        },
    };
    let answer = session.set_field(&request).map_err(|error| match error {
        FieldError::Formula(error) => {
            Failure::Formula { text: arguments.formula.clone().unwrap_or_default(), error: Box::new(error) }
        }
        FieldError::UnknownSurface(id) => Failure::Usage(unknown_surface(&id)),
        FieldError::Box | FieldError::Points(_) => Failure::Usage(error.to_string()),
    })?;
    for (name, _) in &arguments.parameters {
        if !answer.parameters.iter().any(|parameter| parameter.name == *name) {
            let known: Vec<&str> = answer.parameters.iter().map(|p| p.name.as_str()).collect();
            let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
            return Err(Failure::Usage(format!(
                "the formula has no parameter `{name}`; its parameters: {known}"
            )));
        }
    }
    Ok(answer)
}

fn unknown_surface(id: &str) -> String {
    let surfaces = gallery::SURFACES.iter().map(|surface| surface.id);
    let known: Vec<&str> = surfaces.chain(model::MODELS.iter().map(|model| model.id)).collect();
    format!("there is no surface `{id}`; known are {}", known.join(", "))
}

/// Runs the session to its end and adds the times of the phases to `seconds`.
fn sample(session: &mut Session, seconds: &mut Seconds, bar: &ProgressBar) -> Progress {
    /// Steps between two updates of the progress bar.
    const UPDATE: u32 = 64;
    let mut phase = Phase::Seeding;
    let mut steps = 0_u32;
    loop {
        let clock = Clock::start();
        let progress = session.step(BUDGET);
        let spent = clock.seconds();
        match phase {
            Phase::Relaxation => seconds.relaxation += spent,
            Phase::Generation => seconds.generation += spent,
            Phase::Refinement => seconds.refinement += spent,
            _ => seconds.seeding += spent,
        }
        if progress.stop_reason.is_some() || progress.phase == Phase::Done {
            return progress;
        }
        phase = progress.phase;
        if steps.is_multiple_of(UPDATE) {
            bar.set_position((progress.fraction * 1000.0) as u64);
            bar.set_message(match phase {
                Phase::Relaxation => {
                    format!("relaxation {}/{}", progress.relax_step, progress.relax_steps)
                }
                Phase::Refinement => format!("refining {} particles", progress.particles),
                _ => format!("level {}, {} particles", progress.level, progress.particles),
            });
        }
        steps = steps.wrapping_add(1);
    }
}

/// Progress bar on standard error, if that is a terminal.
fn bar(quiet: bool) -> ProgressBar {
    if quiet || !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(1000);
    if let Ok(style) = ProgressStyle::with_template("{bar:40} {percent:>3} %  {msg}") {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(100));
    bar
}

fn write_file(path: &Path, write: impl FnOnce(&mut dyn Write) -> std::io::Result<()>) -> Result<(), Failure> {
    let written = File::create(path).and_then(|file| {
        let mut out = BufWriter::new(file);
        write(&mut out)?;
        out.flush()
    });
    written.map_err(|error| Failure::File { path: path.to_owned(), error })
}

struct Clock(Instant);

impl Clock {
    #[allow(clippy::disallowed_methods, reason = "the tool is the core's caller, and owns the clock")]
    fn start() -> Self {
        Self(Instant::now())
    }

    fn seconds(&self) -> f64 {
        self.0.elapsed().as_secs_f64()
    }
}

/// Peak resident memory so far in 10⁶ bytes, from /proc.
fn peak_mb() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib * 1024.0 / 1e6)
}
