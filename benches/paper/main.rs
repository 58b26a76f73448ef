//! The paper's jobs and figures, made again: `cargo xtask paper` runs this and writes its output to
//! `docs/tables/paper.md`.
//!
//! `--threads N` runs so many jobs at a time, each in a thread of its own. `--limit S` stops a
//! particle system after so many seconds of processor time, `--pictures FOLDER` says where the
//! figures go, `--machine TEXT` names machine and commit, and `--quick` takes a twentieth of the
//! particles, to try it out. Then `UPDATE_GOLDEN=1 cargo test --test it docs::` writes the summary
//! in `docs/results.md`.
#![allow(clippy::disallowed_methods, reason = "a bench measures time")]

#[path = "../../tests/it/settings.rs"]
#[macro_use]
mod settings;
mod draw;
mod printed;
mod runs;
mod steps;

use draw::{Colour, View, draw, write_row};
use glam::Vec3;
use marching_particles::internal::lesson::{self, Lesson, LessonMethod, QueueOrder};
use marching_particles::internal::math::grouped;
use marching_particles::quality;
use marching_particles::sampler::{LawKind, Sampling};
use printed::{Line, Printed, TABLE_1, TABLE_2};
use runs::{End, Job, Outcome, Set, Surface};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::{env, fs, thread};
use steps::Treated;

/// The system counts processor time no finer than this.
const CLOCK_TICK_S: f64 = 5e-3;

/// Side of a square of the figures, in pixels.
const SIDE: usize = 420;

struct Plan {
    limit_s: f64,
    pictures: PathBuf,
    machine: String,
    /// Particles over those of the paper.
    share: f64,
    /// Jobs at a time.
    threads: usize,
}

impl Plan {
    fn of(mut arguments: impl Iterator<Item = String>) -> Self {
        let mut plan = Self {
            limit_s: 30.0,
            pictures: env::temp_dir().join("paper"),
            machine: "a machine that was not named".to_owned(),
            share: 1.0,
            threads: 1,
        };
        while let Some(argument) = arguments.next() {
            let mut text = || arguments.next().unwrap_or_else(|| panic!("{argument} takes a value"));
            match argument.as_str() {
                "--limit" => plan.limit_s = text().parse().expect("--limit takes seconds"),
                "--pictures" => plan.pictures = text().into(),
                "--machine" => plan.machine = text(),
                "--threads" => plan.threads = text().parse().expect("--threads takes a number"),
                "--quick" => plan.share = 0.05,
                // From cargo.
                "--bench" => {}
                other => panic!("{other} is no option"),
            }
        }
        plan
    }

    fn count(&self, printed: u32) -> u32 {
        (f64::from(printed) * self.share).round() as u32
    }

    /// What a function makes of every item, some at a time.
    fn each<T: Sync, R: Send>(&self, items: &[T], work: impl Fn(&T) -> R + Sync) -> Vec<R> {
        let next = AtomicUsize::new(0);
        let results = Mutex::new(Vec::new());
        thread::scope(|scope| {
            for _ in 0..self.threads.clamp(1, items.len()) {
                scope.spawn(|| {
                    while let Some((k, item)) =
                        Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|k| Some((k, items.get(k)?)))
                    {
                        let result = work(item);
                        results.lock().expect("no thread has panicked").push((k, result));
                    }
                });
            }
        });
        let mut results = results.into_inner().expect("no thread has panicked");
        results.sort_by_key(|(k, _)| *k);
        results.into_iter().map(|(_, result)| result).collect()
    }
}

fn main() -> io::Result<()> {
    let plan = Plan::of(env::args().skip(1));
    fs::create_dir_all(&plan.pictures)?;
    let out = &mut io::stdout().lock();
    head(out, &plan)?;
    let mut shown = Shown::default();
    table_1(out, &plan, &mut shown)?;
    table_2(out, &plan)?;
    figures(out, &plan, &shown)
}

fn head(out: &mut dyn Write, plan: &Plan) -> io::Result<()> {
    // Processor time is longer where other work takes the caches.
    let load =
        fs::read_to_string("/proc/loadavg").ok().and_then(|text| Some(text.split(' ').next()?.to_owned()));
    let load = load.unwrap_or_else(|| "unknown".to_owned());
    writeln!(
        out,
        "\
# The paper, reproduced: all figures

Written by `cargo xtask paper`. [Results](../results.md#the-paper-reproduced) explains rows and columns.

{}; {} jobs at a time, load average {load} at the start; particle systems stopped after {} s.
",
        plan.machine, plan.threads, plan.limit_s
    )
}

/// Sets that the figures show again.
#[derive(Default)]
struct Shown {
    bunny_uniform: Option<Set>,
    bunny_adaptive: Option<Set>,
}

/// The runs of a line of Table 1.
struct Runs {
    /// The paper's method as it is written.
    ours: Outcome,
    fast: Outcome,
    /// The method that the paper compares its own with, as it is written.
    other: Outcome,
}

fn run_line(line: &Line, plan: &Plan) -> Runs {
    let job = Job::new(line.id, line.sampling, plan.count(line.count));
    let method = other_method(line).1;
    let settings = job.faithful();
    let system = lesson::LessonSettings { method, ..settings.clone() };
    let runs = Runs {
        ours: job.run_faithful(&settings, f64::INFINITY),
        fast: job.run_fast(),
        other: job.run_faithful(&system, plan.limit_s),
    };
    eprintln!("{} {:?} {}", line.model, line.sampling, line.count);
    runs
}

/// Name of the method that the paper compares with.
fn other_method(line: &Line) -> (&'static str, LessonMethod) {
    if line.sampling == Sampling::Uniform {
        ("Witkin–Heckbert", LessonMethod::WitkinHeckbert)
    } else {
        ("Forces", LessonMethod::Forces)
    }
}

fn table_1(out: &mut dyn Write, plan: &Plan, shown: &mut Shown) -> io::Result<()> {
    writeln!(out, "## Table 1")?;
    let all = plan.each(&TABLE_1, |line| run_line(line, plan));
    for (line, runs) in TABLE_1.iter().zip(all) {
        write_line(out, line, &runs)?;
        // The smaller of the two jobs of each kind comes first.
        if line.id == "bunny-joined" {
            let is_uniform = line.sampling == Sampling::Uniform;
            let shown = if is_uniform { &mut shown.bunny_uniform } else { &mut shown.bunny_adaptive };
            shown.get_or_insert(runs.ours.set);
        }
    }
    Ok(())
}

/// A line of Table 1 as a table of its own: what was measured in rows, who in columns.
fn write_line(out: &mut dyn Write, line: &Line, runs: &Runs) -> io::Result<()> {
    let name = other_method(line).0;
    let kind = if line.sampling == Sampling::Uniform { "uniform" } else { "non-uniform" };
    writeln!(out, "\n### {}, {kind}, {} particles\n", line.model, grouped(line.count as usize))?;
    writeln!(
        out,
        "| | Marching, printed | faithful | fast | {name}, printed | faithful |\n|---|---:|---:|---:|---:|---:|"
    )?;
    let mut row =
        |label: &str, printed: [&dyn Fn(&Printed) -> String; 2], of: &dyn Fn(&Outcome) -> String| {
            let [a, b, c] = [&runs.ours, &runs.fast, &runs.other].map(of);
            writeln!(
                out,
                "| {label} | {} | {a} | {b} | {} | {c} |",
                printed[0](&line.ours),
                printed[1](&line.other)
            )
        };
    let none = |_: &Printed| String::new();
    let wanted = |printed: &Printed| {
        let last = grouped(printed.last_particles as usize);
        if printed.particles == last { last } else { format!("{last} of {}, cut off", printed.particles) }
    };
    row("Particles", [&wanted, &wanted], &|outcome| match outcome.end {
        End::Done => grouped(outcome.count()),
        End::CutOff => format!("{}, cut off", grouped(outcome.count())),
    })?;
    let steps = |printed: &Printed| grouped(printed.steps as usize);
    row("Steps", [&steps, &steps], &|outcome| grouped(outcome.steps as usize))?;
    let last = |printed: &Printed| format!("{:.2} s", printed.last_step);
    row("Last step", [&last, &last], &|outcome| seconds(outcome.last_step))?;
    let total = |printed: &Printed| {
        format!("{}{} s", grouped(printed.total as usize), &format!("{:.2}", printed.total.fract())[1..])
    };
    row("Total time", [&total, &total], &|outcome| seconds(outcome.total()))?;
    row("Evaluations", [&none, &none], &|outcome| grouped(outcome.evaluations as usize))?;
    row("Six neighbours", [&none, &none], &|outcome| {
        format!("{:.1} %", 100.0 * outcome.figures.order.six_neighbours)
    })?;
    row("Mean smallest angle", [&none, &none], &|outcome| {
        format!("{:.1}°", outcome.figures.angles.mean_smallest_angle)
    })?;
    let is_uniform = line.sampling == Sampling::Uniform;
    row("Largest hole", [&none, &none], &|outcome| {
        let figures = &outcome.figures;
        format!("{:.2}", if is_uniform { figures.coverage.cover } else { figures.coverage.cover_local })
    })?;
    row("Closest pair", [&none, &none], &|outcome| {
        let figures = &outcome.figures;
        format!("{:.2}", if is_uniform { figures.spacing.rho } else { figures.edges.overlap_min })
    })?;
    write!(
        out,
        "\nThe time of {name} over that of the front: {:.1} in the paper",
        line.other.total / line.ours.total
    )?;
    let sign = if runs.other.end == End::CutOff { "more than " } else { "" };
    writeln!(out, ", {sign}{:.1} here.", runs.other.total() / runs.ours.total())
}

fn table_2(out: &mut dyn Write, plan: &Plan) -> io::Result<()> {
    writeln!(
        out,
        "\n## Table 2\n\nThe analytic ellipsoid: time of the generation and of the ten relaxation steps, printed in seconds.\n\n\
         | Particles, printed | faithful | fast | Generation, printed | faithful | fast | Relaxation, printed | faithful | fast |\n\
         |---:|---:|---:|---:|---:|---:|---:|---:|---:|"
    )?;
    let all = plan.each(&TABLE_2, |&(count, _)| {
        let job = Job::new("ellipsoid", Sampling::Uniform, plan.count(count));
        (job.run_faithful(&job.faithful(), f64::INFINITY), job.run_fast())
    });
    for ((count, [generation, relaxation, _]), (slow, fast)) in TABLE_2.iter().zip(all) {
        writeln!(
            out,
            "| {} | {} | {} | {generation:.2} | {} | {} | {relaxation:.2} | {} | {} |",
            grouped(*count as usize),
            grouped(slow.count()),
            grouped(fast.count()),
            coarse(slow.generation),
            coarse(fast.generation),
            coarse(slow.relaxation),
            coarse(fast.relaxation)
        )?;
    }
    Ok(())
}

/// Writes a figure and its caption.
struct Album<'a> {
    out: &'a mut dyn Write,
    folder: &'a Path,
}

impl Album<'_> {
    fn squares(&mut self, number: u32, squares: &[Vec<u8>], caption: &str) -> io::Result<()> {
        write_row(&self.folder.join(format!("fig-{number}.rgba")), squares, SIDE)?;
        self.caption(number, "webp", caption)
    }

    fn drawing(&mut self, number: u32, text: &str, caption: &str) -> io::Result<()> {
        fs::write(self.folder.join(format!("fig-{number}.svg")), text)?;
        self.caption(number, "svg", caption)
    }

    fn caption(&mut self, number: u32, extension: &str, caption: &str) -> io::Result<()> {
        let plain = caption.replace('*', "");
        writeln!(
            self.out,
            "\n### Fig. {number}\n\n![{plain}](../images/paper/fig-{number}.{extension})\n\n{caption}"
        )
    }
}

/// Where the eye is: in front, to the right and above.
const EYE: Vec3 = Vec3::new(0.72, -0.55, 0.42);
const BUNNY_EYE: Vec3 = Vec3::new(0.35, -0.85, 0.4);

fn all_of(set: &Set, up: Vec3, back: Vec3, colour: Colour) -> Vec<u8> {
    draw(set, &View::of(set, back, up), colour, SIDE)
}

/// A bunny, from its side.
fn bunny(set: &Set, colour: Colour) -> Vec<u8> {
    all_of(set, Vec3::Z, BUNNY_EYE, colour)
}

fn figures(out: &mut dyn Write, plan: &Plan, shown: &Shown) -> io::Result<()> {
    writeln!(
        out,
        "\n## Figures\n\nDrawn from the particles of the runs as discs of their repulsion radius; of the faithful method \
         unless the caption says otherwise."
    )?;
    let album = &mut Album { out, folder: &plan.pictures };
    let particles = |set: &Set| grouped(set.position.len());
    if let (Some(uniform), Some(adaptive)) = (&shown.bunny_uniform, &shown.bunny_adaptive) {
        let squares = [bunny(uniform, Colour::Plain), bunny(adaptive, Colour::Radius)];
        let words = format!(
            "The bunny: *left* {} uniform particles, *right* {} non-uniform ones, coloured by radius.",
            particles(uniform),
            particles(adaptive)
        );
        album.squares(1, &squares, &words)?;
    }
    figure_5(album, plan)?;
    figures_7_and_8(album)?;
    figure_9(album, plan)?;
    figure_10(album, plan)?;
    figure_11(album)?;
    figure_12(album, plan)
}

fn faithful(job: &Job, change: impl FnOnce(&mut lesson::LessonSettings)) -> Set {
    let mut settings = job.faithful();
    change(&mut settings);
    job.run_faithful(&settings, f64::INFINITY).set
}

fn figure_5(album: &mut Album, plan: &Plan) -> io::Result<()> {
    let job = Job::new("bunny-joined", Sampling::Uniform, plan.count(6_000));
    let before = faithful(&job, |settings| settings.relax_steps = 0);
    let after = faithful(&job, |_| {});
    let surface = &job.surface;
    let options = quality::MeasureOptions::default();
    let report = quality::measure(
        &before.position,
        &before.normal,
        &*surface.field(),
        Some(&surface.bounds),
        &options,
    );
    let Some(hole) = report.places.holes.first() else { return Ok(()) };
    let target = Vec3::from_array(hole.position);
    let nearest = (0..before.position.len())
        .min_by(|&a, &b| before.position[a].distance(target).total_cmp(&before.position[b].distance(target)))
        .unwrap_or_default();
    let view = View { target, back: before.normal[nearest], up: Vec3::Z, half: 11.0 * job.radius as f32 };
    let squares = [&before, &after].map(|set| draw(set, &view, Colour::Plain, SIDE));
    album.squares(
        5,
        &squares,
        &format!(
            "The widest hole that the fronts leave on the bunny, {:.2} times that of a lattice: *left* after the generation, *right* after ten \
             relaxation steps.",
            hole.ratio
        ),
    )
}

fn figures_7_and_8(album: &mut Album) -> io::Result<()> {
    let surface = Surface::of("ellipsoid");
    let settings = lesson::LessonSettings {
        sampling: Sampling::Adaptive,
        law: LawKind::SumOfCurvatures,
        law_scale: 0.2,
        radius_min: 0.03,
        radius_max: 0.15,
        relax_steps: 0,
        ..lesson::LessonSettings::default()
    };
    let mut run = Lesson::new(surface.field(), &surface.bounds, &settings).expect("valid settings");
    while !run.step(1_000).is_done {}
    let events = run.events(0, u32::MAX);
    run.seek(u32::MAX);
    let treated = Treated::all(&events, run.particles());
    album.drawing(
        7,
        &steps::first_two(&treated[0]),
        "The first two children of the seed on the ellipsoid, in its tangent plane, from the event log of the run.",
    )?;
    if let Some(telling) = treated.iter().find(|treated| treated.is_telling()) {
        album.drawing(
            8,
            &steps::among_neighbours(telling),
            "A particle of the same run among its neighbours (red) and its father (green): each child that it tries (orange), and the \
             result: added (blue), without room (violet).",
        )?;
    }
    Ok(())
}

fn figure_9(album: &mut Album, plan: &Plan) -> io::Result<()> {
    let job = Job::new("bunny-joined", Sampling::Uniform, plan.count(10_000));
    let ours = faithful(&job, |_| {});
    let theirs = faithful(&job, |settings| settings.method = LessonMethod::WitkinHeckbert);
    let words = format!(
        "The bunny with the same wanted radius: *left* {} particles of the paper's method, *right* {} of Witkin and Heckbert's.",
        grouped(ours.position.len()),
        grouped(theirs.position.len())
    );
    album.squares(9, &[&ours, &theirs].map(|set| bunny(set, Colour::Plain)), &words)
}

fn figure_10(album: &mut Album, plan: &Plan) -> io::Result<()> {
    let coarse = faithful(&Job::new("rabbit", Sampling::Uniform, plan.count(2_449)), |_| {});
    let fine = faithful(&Job::new("rabbit", Sampling::Uniform, plan.count(25_702)), |_| {});
    let words = format!(
        "A rabbit of our own, which stands in for the paper's: *left* with {} particles, *right* with {}.",
        grouped(coarse.position.len()),
        grouped(fine.position.len())
    );
    album.squares(10, &[&coarse, &fine].map(|set| rabbit(set, Colour::Plain)), &words)
}

fn rabbit(set: &Set, colour: Colour) -> Vec<u8> {
    all_of(set, Vec3::Z, EYE, colour)
}

fn figure_11(album: &mut Album) -> io::Result<()> {
    let surface = Surface::of("sphere");
    let seed = EYE.normalize_or(Vec3::Z).as_dvec3().to_array();
    let of = |order| {
        let settings = lesson::LessonSettings {
            radius: 0.035,
            order,
            seeds: vec![seed],
            relax_steps: 0,
            ..lesson::LessonSettings::default()
        };
        let mut run = Lesson::new(surface.field(), &surface.bounds, &settings).expect("valid settings");
        while !run.step(1_000).is_done {}
        run.seek(u32::MAX);
        Set::of_faithful(run.particles())
    };
    let squares =
        [of(QueueOrder::Queue), of(QueueOrder::Stack)].map(|set| all_of(&set, Vec3::Z, EYE, Colour::Level));
    album.squares(
        11,
        &squares,
        "The sphere, each generation level in another colour. *Left* with a queue, whose levels are the rings of the paper's figure; *right* \
         with a stack, as the paper's text says, whose levels are not.",
    )
}

fn figure_12(album: &mut Album, plan: &Plan) -> io::Result<()> {
    let mut squares = Vec::new();
    for sampling in [Sampling::Uniform, Sampling::Adaptive] {
        let colour = if sampling == Sampling::Uniform { Colour::Plain } else { Colour::Radius };
        let of = |id| faithful(&Job::new(id, sampling, plan.count(6_000)), |_| {});
        squares.push(rabbit(&of("sack-and-hat"), colour));
        if sampling == Sampling::Adaptive {
            squares.push(rabbit(&of("rabbit"), colour));
        }
    }
    album.squares(
        12,
        &squares,
        "More examples with about 6,000 particles: a figure with sack and hat, which stands in for the paper's Santa, uniform and non-uniform; \
         and the rabbit, non-uniform.",
    )
}

/// A time of which the clock's ticks may be a large part.
fn coarse(time: f64) -> String {
    if time < CLOCK_TICK_S { format!("< {:.0} ms", 1e3 * CLOCK_TICK_S) } else { seconds(time) }
}

/// A time with three digits.
fn seconds(time: f64) -> String {
    match time {
        t if t >= 10.0 => format!("{t:.1} s"),
        t if t >= 1.0 => format!("{t:.2} s"),
        t if t >= 0.01 => format!("{:.0} ms", 1e3 * t),
        t => format!("{:.1} ms", 1e3 * t),
    }
}
