//! Subcommand `sample`: a run with its files and its report.

use crate::arguments::{SampleArguments, SurfaceArguments};
use crate::bar::bar;
use crate::failure::{Failure, LIMIT};
use crate::outcome::{MeshCounts, Outcome, Seconds};
use crate::output::{OutputFile, STANDARD, record_path};
use crate::porosity::Wish;
use crate::spacing::space;
use crate::surface::{Origin, choose, fit, read_text};
use crate::wall::Wall;
use crate::{code, summary};
use indicatif::ProgressBar;
use marching_particles::export::{MeshFile, ParticleFile, Placement, RecordText, VERTICES, Vertices};
use marching_particles::internal::math::grouped;
use marching_particles::internal::session::{Fault, FileRecord, Session, Source, ValueText};
use marching_particles::run::{Reach, Value};
use marching_particles::sampler::{COUNT_ROOM, Phase, SizeMode};
use marching_particles::{Bounds, Error, Format, MeshFormat, Run, Settings, StopReason};
use std::borrow::Cow;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

/// Units of work between two readings of the clock: about 2 ms, the accuracy of the phases' times.
/// With far fewer, handing the particles over takes a noticeable share of a run.
const BUDGET: u32 = 4_096;
/// Slices of triangulation between two updates of the progress bar: about 6 ms.
const SLICES: u32 = 256;

/// Reads the record of how a file was made, from the file or from the .json file next to it.
fn read_record(path: &Path, surface: &SurfaceArguments) -> Result<FileRecord, Failure> {
    let unreadable = |error| Failure::Unreadable { path: path.to_owned(), error };
    let bytes = std::fs::read(path).map_err(unreadable)?;
    let no_record = || {
        let name = path.display();
        Failure::Usage(format!(
            "{name} does not say what it was made from: it holds no record of this program, and there is no {name}.json beside it"
        ))
    };
    let beside = || RecordText::find(&std::fs::read(record_path(path)).ok()?);
    let json = RecordText::find(&bytes).or_else(beside).ok_or_else(no_record)?;
    let record: FileRecord = serde_json::from_str(&json).map_err(|error| {
        Failure::Usage(format!("the record in {} could not be read: {error}", path.display()))
    })?;
    match &record.model {
        Some(model)
            if surface.surface.is_none()
                && surface.points.is_none()
                && surface.image.is_none()
                && surface.mesh.mesh_in.is_none() =>
        {
            Err(Failure::Usage(format!(
                "{} was made from points, {model}: name them with --surface or --points, beside --like",
                path.display()
            )))
        }
        _ => Ok(record),
    }
}

pub(crate) fn run(mut arguments: SampleArguments) -> Result<ExitCode, Failure> {
    read_text(&mut arguments.surface)?;
    if let Some(path) = &arguments.like {
        let record = read_record(path, &arguments.surface)?;
        arguments.complete(record);
    }
    let spacing = arguments.spacing_text()?;
    arguments.sampling.check(spacing.is_some())?;
    let arguments = &arguments;
    if let Some((_, language)) = arguments.print {
        return code::print(arguments, spacing, language);
    }
    let is_mesh =
        |extension: &str| MeshFormat::of_extension(extension).map(|_| "--mesh, which has triangles");
    let is_points = |extension: &str| Format::of_extension(extension).map(|_| "--out, which has points");
    let formats = formats(arguments, &arguments.out, Format::of_extension, &Format::ALL, is_mesh)?;
    let mesh_formats =
        self::formats(arguments, &arguments.mesh, MeshFormat::of_extension, &MeshFormat::ALL, is_points)?;
    let is_piped = arguments.out.iter().chain(&arguments.mesh).any(|path| is_standard(path));
    if arguments.format.is_some() && !is_piped {
        return Err(Failure::Usage("--format is for standard output: --out - or --mesh -".to_owned()));
    }
    check_vertices(arguments)?;
    check_placement(arguments)?;
    let records: Vec<PathBuf> = (arguments.out.iter().zip(&formats))
        .filter(|(path, format)| {
            let has_record = arguments.surface.image.is_none() && arguments.surface.mesh.mesh_in.is_none();
            **format == Format::Csv && !is_standard(path) && has_record
        })
        .map(|(path, _)| record_path(path))
        .collect();
    let paths: Vec<&PathBuf> = arguments.out.iter().chain(&arguments.mesh).chain(&records).collect();
    let mut outputs = OutputFile::beside(&paths)?.into_iter();
    let mut seconds = Seconds::default();
    let mut session = Session::without_surface();
    let origin = timed(&mut seconds.points, || choose(&mut session, &arguments.surface, arguments.quiet))?;
    if matches!(origin, Origin::Formula) {
        seconds.points = 0.0;
    }
    space(&mut session, spacing)?;
    let values = values(&arguments.values, &session)?;
    let settings_in = |bounds: &Bounds| {
        let mut settings = arguments.sampling.settings(bounds);
        settings.bounds = arguments.surface.sampled;
        settings
    };
    let mut wish = match arguments.porosity {
        Some(wanted) => {
            let solid = arguments.surface.solid();
            let begin = || Wish::begin(&mut session, solid, wanted, &settings_in);
            Some(timed(&mut seconds.seeding, begin)?)
        }
        None => None,
    };
    let mut wall = match arguments.wall_share() {
        Some(share) => {
            let solid = arguments.surface.solid();
            let begin = || Wall::begin(&mut session, solid, share, &settings_in);
            Some(timed(&mut seconds.seeding, begin)?)
        }
        None => None,
    };
    let bar = bar(arguments.quiet);
    let measured = arguments.report.measured();
    // The new mesh is compared with the given one.
    let is_remeshed = matches!(origin, Origin::Mesh(_)) && arguments.surface.formula.is_none();
    let is_mesh = !mesh_formats.is_empty() || wish.is_some() || is_remeshed;
    let (settings, predicted_count, is_joined, peak_sampling_mb) = loop {
        bar.set_message("looking for the box and the edges");
        let (settings, start) = timed(&mut seconds.seeding, || {
            let settings = fit(&mut session, &settings_in, false)?;
            Ok::<_, Failure>((settings, session.start(&settings)?))
        })?;
        session.run.plan(measured, is_mesh);
        step_to_end(&mut session.run, &mut seconds, &bar);
        let peak = peak_mb();
        let is_joined = is_mesh && session.run.count() > 0;
        let volume = if is_joined { join(&mut session.run, &mut seconds, &bar) } else { None };
        let is_corrected = match (&mut wish, &mut wall) {
            (Some(wish), _) => timed(&mut seconds.seeding, || wish.corrects(&mut session, volume))?,
            (None, Some(wall)) => wall.corrects(&mut session, arguments.bodies())?,
            (None, None) => false,
        };
        if !is_corrected {
            break (settings, start.predicted_count, is_joined, peak);
        }
    };
    let reach = session.run.reach();
    let bounds = session.run.bounds();
    let field = session.run.field().clone();
    bar.set_message("measuring");
    let sample = timed(&mut seconds.quality, || {
        session.finish(measured, |fraction| {
            set_fraction(&bar, fraction);
            Ok(())
        })
    });
    bar.finish_and_clear();
    let mut sample = sample.map_err(|error| match error {
        Error::Nothing { reason: StopReason::NoSurface, .. } if reach == Some(Reach::Nowhere) => {
            Failure::Nothing("there is no surface within ±10,000".to_owned())
        }
        Error::Settings(error) => error.into(),
        error => Failure::Nothing(refusal_of_run(&error)),
    })?;
    for (name, value) in values {
        sample
            .add_value(&*field, name, &value)
            .map_err(|error| Failure::Usage(format!("--value: {error}")))?;
    }
    // A record cannot hold an image or a mesh.
    let mut made = sample.file_record();
    if let Some(made) = &mut made
        && matches!(origin, Origin::Points(_))
    {
        made.surface.clone_from(&arguments.surface.surface);
    }
    let bodies = if is_joined { sample.mesh().bodies(sample.particles()) } else { Vec::new() };
    let placement = arguments.placement(arguments.bodies().size(&bodies).max_element());
    let mesh = is_joined.then(|| MeshCounts::new(&sample, &bodies, arguments.bodies(), placement));
    let is_printed =
        mesh_formats.iter().any(|format| matches!(format, MeshFormat::Stl | MeshFormat::ThreeMf));
    let record = made.as_ref().map_or_else(RecordText::default, FileRecord::text);
    timed(&mut seconds.writing, || {
        for (format, output) in formats.into_iter().zip(outputs.by_ref()) {
            let file = ParticleFile { format, record: record.clone() };
            output.write(|out| sample.write(file, out))?;
        }
        for (format, output) in mesh_formats.into_iter().zip(outputs.by_ref()) {
            let (vertices, bodies) = (arguments.vertices, arguments.bodies());
            let file = MeshFile { format, placement, vertices, bodies, record: record.clone() };
            output.write(|out| sample.write_mesh(file, out))?;
        }
        let document = record.document().unwrap_or_default();
        for output in outputs {
            output.write(|out| out.write_all(document.as_bytes()))?;
        }
        Ok::<_, Failure>(())
    })?;

    let report = sample.report().clone();
    let capped = report.stop_reason == Some(StopReason::Cap);
    let (mut model, mut image, mut remesh) = (None, None, None);
    match origin {
        Origin::Formula => {}
        Origin::Points(info) => model = Some(info),
        Origin::Image(info) => image = Some(info),
        Origin::Mesh(own) => {
            let (field, mut info) = *own;
            if is_remeshed && is_joined {
                timed(&mut seconds.quality, || info.compare(&field, &sample));
            }
            remesh = Some(info);
        }
    }
    let mut sampled = settings;
    sampled.bounds = None;
    let thickness = made.as_ref().and_then(|made| made.solid.thickened().cloned());
    let spacing = made.as_ref().and_then(|made| made.spacing.clone());
    let (surface, formula, parameters) =
        made.map_or_else(Default::default, |made| (made.surface, made.formula, made.parameters));
    let outcome = Outcome {
        version: env!("CARGO_PKG_VERSION"),
        surface,
        model,
        image,
        remesh,
        formula,
        parameters,
        bounds,
        settings: sampled,
        thickness,
        spacing,
        porosity: wish.map(|wish| wish.outcome()),
        predicted_count,
        report,
        mesh,
        seconds,
        peak_mb: peak_mb(),
        peak_sampling_mb,
        files: paths.iter().map(|path| path.display().to_string()).collect(),
        is_printed,
    };
    let mut out: Box<dyn Write> =
        if is_piped { Box::new(std::io::stderr()) } else { Box::new(std::io::stdout()) };
    if arguments.json {
        writeln!(out, "{}", serde_json::to_string(&outcome).map_err(std::io::Error::other)?)?;
    } else if !arguments.quiet {
        summary::write(&mut out, &outcome)?;
    }
    if capped {
        eprintln!("warning: stopped: {}", over_limit(predicted_count, &settings));
        return Ok(ExitCode::from(LIMIT));
    }
    Ok(ExitCode::SUCCESS)
}

/// The values of the requested columns; their formulas may use the surface's parameters.
fn values<'a>(given: &'a [ValueText], session: &Session) -> Result<Vec<(&'a str, Value)>, Failure> {
    let parameters = session.answer().parameters;
    let value = |ValueText { name, formula }: &'a ValueText| match Value::of_formula(formula, &parameters) {
        Ok(value) => Ok((name.as_str(), value)),
        Err(error) => {
            let fault = Fault::in_formula(error, formula);
            let message = format!("--value {name}: {}", fault.message);
            Err(Failure::Formula { text: formula.clone(), fault: Box::new(Fault { message, ..fault }) })
        }
    };
    given.iter().map(value).collect()
}

/// Why there is no sample, with the names of the options.
fn refusal_of_run(error: &Error) -> String {
    let message = error.to_string();
    match error {
        Error::NoBox { .. } => message.replace("`Settings::in_box`", "--box"),
        _ => message,
    }
}

/// Warning about a run that reaches the limit of particles.
fn over_limit(predicted_count: u64, settings: &Settings) -> String {
    let limit = settings.max_particles;
    if settings.size_mode == SizeMode::Count && settings.count > limit {
        let (wanted, room) = (settings.count, (f64::from(settings.count) * COUNT_ROOM).ceil());
        return format!(
            "the {wanted} particles that are wanted are more than the limit of {limit}; ask for a smaller --count, or allow them with \
             --max-particles {room}"
        );
    }
    // The prediction may be slightly too low.
    let count = predicted_count.max(u64::from(limit) + 1);
    format!(
        "about {count} particles of this radius would fit on the surface, more than the limit of {limit}; \
         choose a larger --radius, or allow them with --max-particles {}",
        (count as f64 * COUNT_ROOM).ceil()
    )
}

/// Refuses a choice of vertices that changes none of the files.
fn check_vertices(arguments: &SampleArguments) -> Result<(), Failure> {
    let choice = VERTICES.iter().find(|choice| choice.value == arguments.vertices);
    let known = choice.map_or(&[][..], |choice| choice.formats);
    let is_of = |path: &PathBuf| {
        let extension = extension(arguments, path);
        known.iter().any(|known| extension.eq_ignore_ascii_case(known))
    };
    if arguments.vertices == Vertices::default() || arguments.mesh.iter().any(is_of) {
        return Ok(());
    }
    Err(Failure::Usage(format!(
        "--vertices {} is for files of --mesh with the extension {}",
        arguments.vertices.name(),
        known.join(" or ")
    )))
}

/// Refuses options for mesh files if there is no mesh file.
fn check_placement(arguments: &SampleArguments) -> Result<(), Failure> {
    let usual = Placement::default();
    let Placement { scale, unit, up } = arguments.placement(0.0);
    let given = [
        ("--size", arguments.size.is_some()),
        ("--wall", arguments.wall.is_some()),
        ("--largest-part", arguments.largest_part),
        ("--scale", scale != usual.scale),
        ("--unit", unit != usual.unit),
        ("--up", up != usual.up),
    ];
    match given.into_iter().find(|(_, is_given)| *is_given) {
        Some((option, _)) if arguments.mesh.is_empty() => Err(Failure::Usage(format!(
            "{option} is for the files of --mesh: the points of --out stay as they are in the formula"
        ))),
        _ => Ok(()),
    }
}

/// The format of each file, checked before any work. An error suggests the other `option`.
fn formats<T>(
    arguments: &SampleArguments,
    paths: &[PathBuf],
    of_extension: impl Fn(&str) -> Option<T>,
    all: &[(&str, T)],
    of_other: impl Fn(&str) -> Option<&'static str>,
) -> Result<Vec<T>, Failure> {
    paths
        .iter()
        .map(|path| {
            of_extension(&extension(arguments, path)).ok_or_else(|| {
                let known: Vec<&str> = all.iter().map(|(name, _)| *name).collect();
                let known = known.join(", ");
                let name = path.display();
                Failure::Usage(if let Some(option) = of_other(&extension(arguments, path)) {
                    format!("{name} is a file of {option}; formats here are {known}")
                } else if is_standard(path) {
                    format!("standard output takes its format from --format; formats here are {known}")
                } else {
                    format!("{name} has no extension that names a format; formats here are {known}")
                })
            })
        })
        .collect()
}

/// Whether a file to write is standard output.
fn is_standard(path: &Path) -> bool {
    path == Path::new(STANDARD)
}

/// The extension that determines the format of a file.
fn extension<'a>(arguments: &'a SampleArguments, path: &'a Path) -> Cow<'a, str> {
    match &arguments.format {
        Some(format) if is_standard(path) => format.into(),
        _ => path.extension().unwrap_or_default().to_string_lossy(),
    }
}

/// Runs to the end and adds the times of the phases to `seconds`.
fn step_to_end(run: &mut Run<'_, Source>, seconds: &mut Seconds, bar: &ProgressBar) {
    /// Steps of [`BUDGET`] units between two updates of the progress bar: about 8 ms.
    const UPDATE: u32 = 4;
    let mut phase = Phase::Seeding;
    let mut steps = 0_u32;
    loop {
        let of_phase = match phase {
            Phase::Relaxation => &mut seconds.relaxation,
            Phase::Generation => &mut seconds.generation,
            Phase::Refinement => &mut seconds.refinement,
            _ => &mut seconds.seeding,
        };
        let progress = timed(of_phase, || run.step(BUDGET));
        if progress.stop_reason.is_some() || progress.phase == Phase::Done {
            return;
        }
        phase = progress.phase;
        if steps.is_multiple_of(UPDATE) {
            set_fraction(bar, progress.fraction);
            bar.set_message(match phase {
                Phase::Relaxation => {
                    format!("relaxation {}/{}", progress.relax_step, progress.relax_steps)
                }
                Phase::Refinement => format!("refining {} particles", grouped(progress.particles)),
                _ => {
                    let attempt = match progress.attempt {
                        1 => String::new(),
                        attempt => format!("attempt {attempt}, "),
                    };
                    let particles = grouped(progress.particles);
                    format!("{attempt}level {}, {particles} particles", progress.level)
                }
            });
        }
        steps = steps.wrapping_add(1);
    }
}

/// Triangulates the particles of a run and adds the time to `seconds`. Returns the volume of the
/// mesh, if it is closed.
fn join(run: &mut Run<'_, Source>, seconds: &mut Seconds, bar: &ProgressBar) -> Option<f64> {
    bar.set_message("joining the particles");
    timed(&mut seconds.mesh, || {
        loop {
            match run.join(SLICES) {
                Some(mesh) => break mesh.volume,
                None => set_fraction(bar, run.fraction()),
            }
        }
    })
}

fn set_fraction(bar: &ProgressBar, fraction: f64) {
    bar.set_position((fraction * 1000.0) as u64);
}

/// Does `work`, and adds the time that it takes to `seconds`.
#[allow(clippy::disallowed_methods, reason = "the tool is the core's caller, and owns the clock")]
fn timed<T>(seconds: &mut f64, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    *seconds += start.elapsed().as_secs_f64();
    result
}

/// Peak resident memory so far in 10⁶ bytes, from /proc.
fn peak_mb() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib * 1024.0 / 1e6)
}
