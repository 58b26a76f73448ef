//! The front and the refined method over the gallery and the models: the table of
//! `docs/results.md`.
//!
//! `cargo bench -p benches --bench methods > docs/tables/methods.md` measures every surface with
//! 4,000 and with 20,000 particles. `--count N` takes another number, `--seeds K` reports the worst
//! of the seeds 0 to K − 1 in each column, `--adaptive` lets sizes follow the curvature, and names
//! of surfaces restrict the run to these. Then `UPDATE_GOLDEN=1 cargo test --test it docs::` writes
//! the summary in `docs/results.md`.
#![allow(clippy::disallowed_methods, reason = "a bench measures time")]

#[path = "../tests/it/settings.rs"]
#[macro_use]
mod settings;

use marching_particles::Bounds;
use marching_particles::field::formula::Formula;
use marching_particles::field::rbf::RbfField;
use marching_particles::field::{Field, gallery, model};
use marching_particles::pointcloud::fit_model;
use marching_particles::quality::Figures;
use marching_particles::{Method, Run, Sampling, Settings, SizeMode, Warning};
use std::io::{self, Write};
use std::time::Instant;

/// Numbers of particles.
const COUNTS: [u32; 2] = [4_000, 20_000];
/// Runs of which the mean counts: the system counts time in ticks of a few milliseconds.
const RUNS: u32 = 3;

/// Text above the tables.
const HEAD: &str = "\
Written by `cargo bench -p benches --bench methods > docs/tables/methods.md`. [Results](../results.md#both-methods) explains
the columns.";

/// Plan of a measurement.
struct Plan {
    names: Vec<String>,
    counts: Vec<u32>,
    seeds: u64,
    sampling: Sampling,
}

impl Plan {
    /// The plan of the command line.
    fn of(mut arguments: impl Iterator<Item = String>) -> Self {
        let mut plan = Self { names: Vec::new(), counts: Vec::new(), seeds: 1, sampling: Sampling::Uniform };
        while let Some(argument) = arguments.next() {
            let mut number = || {
                let number = arguments.next().and_then(|number| number.parse().ok());
                number.unwrap_or_else(|| panic!("{argument} takes a whole number"))
            };
            match argument.as_str() {
                "--count" => plan.counts.push(number()),
                "--seeds" => plan.seeds = u64::from(number()),
                "--adaptive" => plan.sampling = Sampling::Adaptive,
                // From cargo.
                "--bench" => {}
                name => plan.names.push(name.to_owned()),
            }
        }
        if plan.counts.is_empty() {
            plan.counts.extend(COUNTS);
        }
        plan
    }

    fn has(&self, id: &str) -> bool {
        self.names.is_empty() || self.names.iter().any(|name| name == id)
    }
}

/// The worst figures of some runs.
struct Row {
    particles: usize,
    /// Times that the coarse front was refined, the fewest; or why it was not.
    levels: Result<u32, String>,
    figures: Figures,
    /// Seconds of processor time of a run, with the fastest of the seeds.
    seconds: f64,
}

/// Processor time of this thread in seconds, so that other work on the machine does not count, or
/// wall time if the system does not report it.
fn processor_seconds(start: Instant) -> f64 {
    std::fs::read_to_string("/proc/thread-self/schedstat")
        .ok()
        .and_then(|text| text.split(' ').next()?.parse::<f64>().ok())
        .map_or_else(|| start.elapsed().as_secs_f64(), |nanoseconds| nanoseconds * 1e-9)
}

/// The worse of two in each figure of the table.
fn worse(mut a: Figures, b: Figures) -> Figures {
    a.order.six_neighbours = a.order.six_neighbours.min(b.order.six_neighbours);
    a.angles.mean_smallest_angle = a.angles.mean_smallest_angle.min(b.angles.mean_smallest_angle);
    a.angles.smallest_angle = a.angles.smallest_angle.min(b.angles.smallest_angle);
    a.angles.triangles_above_90 = a.angles.triangles_above_90.max(b.angles.triangles_above_90);
    a.spacing.rho = a.spacing.rho.min(b.spacing.rho);
    a.coverage.cover = a.coverage.cover.max(b.coverage.cover);
    a.edges.size_variation = a.edges.size_variation.max(b.edges.size_variation);
    a
}

/// Runs with all seeds, on a field of which a new one is made for each run.
fn row(make: &dyn Fn() -> Box<dyn Field>, bounds: &Bounds, settings: Settings, seeds: u64) -> Row {
    let start = Instant::now();
    let mut row: Option<Row> = None;
    for seed in 0..seeds {
        let settings = settings!(seed; ..settings).in_box(*bounds);
        let mut seconds = 0.0;
        let mut last = None;
        for _ in 0..RUNS {
            let field = make();
            let begun = processor_seconds(start);
            let mut run = Run::start(field, &settings).expect("valid settings");
            while run.step(65_536).stop_reason.is_none() {}
            seconds += (processor_seconds(start) - begun) / f64::from(RUNS);
            last = Some(run);
        }
        let report = last.expect("there is a run").report();
        let refusal = report.warnings.iter().find(|warning| matches!(warning, Warning::NotRefined(_)));
        let reason = || refusal.map(ToString::to_string).unwrap_or_default();
        let next = Row {
            particles: report.count,
            levels: report.growth.refined_levels.ok_or_else(reason),
            figures: report.measures.quality.expect("there are particles"),
            seconds,
        };
        row = Some(match row.take() {
            None => next,
            Some(row) => Row {
                particles: row.particles,
                levels: row.levels.and_then(|levels| next.levels.map(|other| levels.min(other))),
                figures: worse(row.figures, next.figures),
                seconds: row.seconds.min(next.seconds),
            },
        });
    }
    row.expect("at least one seed")
}

fn write_row(out: &mut dyn Write, name: &str, method: &str, row: &Row, is_adaptive: bool) -> io::Result<()> {
    let f = &row.figures;
    let evenness = if is_adaptive {
        format!("{:.2} %", 100.0 * f.edges.size_variation)
    } else {
        format!("{:.3} | {:.3}", f.coverage.cover, f.spacing.rho)
    };
    writeln!(
        out,
        "| {name} | {method} | {} | {:.2} % | {:.2} | {:.1} | {:.4} % | {evenness} | {:.2} |",
        row.particles,
        100.0 * f.order.six_neighbours,
        f.angles.mean_smallest_angle,
        f.angles.smallest_angle,
        100.0 * f.angles.triangles_above_90,
        1e6 * row.seconds / row.particles as f64
    )
}

/// A surface: its identifier, its field and its box.
type Source = (&'static str, Box<dyn Fn() -> Box<dyn Field>>, Bounds);

fn sources(plan: &Plan) -> Vec<Source> {
    let surfaces = gallery::SURFACES.iter().filter(|surface| plan.has(surface.id)).map(|surface| {
        let field: Formula = surface.field();
        let make: Box<dyn Fn() -> Box<dyn Field>> = Box::new(move || Box::new(field.clone()));
        (surface.id, make, surface.bounds)
    });
    let models = model::MODELS.iter().filter(|model| plan.has(model.id)).map(|model| {
        let fit = fit_model(model);
        let data = fit.data.clone();
        let make: Box<dyn Fn() -> Box<dyn Field>> =
            Box::new(move || Box::new(RbfField::new(data.clone()).expect("a solved system is a field")));
        (model.id, make, fit.bounds)
    });
    surfaces.chain(models).collect()
}

fn main() -> io::Result<()> {
    let plan = Plan::of(std::env::args().skip(1));
    let is_adaptive = plan.sampling == Sampling::Adaptive;
    let out = &mut io::stdout();
    writeln!(out, "# Both methods over the gallery: all figures\n\n{HEAD}")?;
    for &count in &plan.counts {
        let evenness = if is_adaptive { "`size_variation`" } else { "Largest hole | Closest pair" };
        writeln!(out, "\n## {count} particles\n")?;
        writeln!(
            out,
            "| Surface | Method | Particles | Six neighbours | Mean smallest angle | Smallest angle | Triangles > 90° | \
             {evenness} | µs per particle |"
        )?;
        writeln!(
            out,
            "|---|---|---:|---:|---:|---:|---:|---:|{}---:|",
            if is_adaptive { "" } else { "---:|" }
        )?;
        let mut reasons = Vec::new();
        for (id, make, bounds) in sources(&plan) {
            let settings = settings!(size_mode: SizeMode::Count,
                count,
                sampling: plan.sampling,
                max_particles: count.saturating_mul(2); ..Settings::default());
            let front = row(&*make, &bounds, settings, plan.seeds);
            write_row(out, id, "front", &front, is_adaptive)?;
            let refined = row(&*make, &bounds, settings!(method: Method::Refined; ..settings), plan.seeds);
            match &refined.levels {
                Ok(levels) => {
                    write_row(out, "", &format!("refined {levels} ×"), &refined, is_adaptive)?;
                }
                Err(reason) => reasons.push((id, reason.clone())),
            }
        }
        if !reasons.is_empty() {
            writeln!(out, "\nWhere the front stands:\n")?;
        }
        for (id, reason) in reasons {
            writeln!(out, "- {id}: {reason}")?;
        }
    }
    Ok(())
}
