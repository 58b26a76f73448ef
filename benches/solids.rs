//! Solids with sharp edges by both methods: the table of `docs/results.md`.
//!
//! `cargo bench -p benches --bench solids --profile dev > docs/tables/solids.md` measures every
//! solid with 1,500, 6,000 and 24,000 particles. With `-- FOLDER` it also writes every mesh to that
//! folder, for `benches/tetrahedra.py`. Then `UPDATE_GOLDEN=1 cargo test --test it docs::` writes
//! the summary in `docs/results.md`.
#![allow(clippy::disallowed_methods, reason = "a bench measures time")]

#[path = "../tests/it/solid_table.rs"]
mod solid_table;

use core::f64::consts::PI;
use marching_particles::field::Evaluator;
use marching_particles::particles::Particles;
use marching_particles::{Bounds, Formula, MeshFormat, Method, Run, Settings, sample};
use solid_table::SOLIDS;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Numbers of particles.
const COUNTS: [u32; 3] = [1_500, 6_000, 24_000];
/// Runs of which the fastest counts.
const RUNS: u32 = 3;

/// Text above the tables.
const HEAD: &str = "\
Written by `cargo bench -p benches --bench solids --profile dev > docs/tables/solids.md`.
[Results](../results.md#solids-with-sharp-edges) explains the columns.";

/// A solid: its name, its field, and its exact volume, Euler number and numbers of creases and
/// corners, where they are known.
struct Solid {
    name: &'static str,
    field: Formula,
    volume: Option<f64>,
    shape: Option<(i64, [usize; 2])>,
}

/// The solids of the tests, a cone and a thick gyroid that its box closes.
fn solids() -> Vec<Solid> {
    let parse = |text| Formula::parse(text).expect("a formula");
    let mut solids: Vec<Solid> = SOLIDS
        .iter()
        .map(|solid| Solid {
            name: solid.name,
            field: parse(solid.formula),
            volume: Some(solid.volume),
            shape: Some((solid.euler, solid.creases)),
        })
        .collect();
    let cone = parse("max(hypot(x, y) + z - 1, -z)");
    solids.push(Solid { name: "cone", field: cone, volume: Some(PI / 3.0), shape: None });
    let gyroid = parse("sin(x)*cos(y) + sin(y)*cos(z) + sin(z)*cos(x)");
    let gyroid = gyroid.thickened(0.6).closed_by(&Bounds::cube(4.0));
    solids.push(Solid { name: "gyroid, 0.6 thick", field: gyroid, volume: None, shape: None });
    solids
}

/// Largest distance of a row on a crease from the surface of its patch, over the spacing.
fn off_the_edge(particles: &Particles, field: &mut dyn Evaluator) -> f64 {
    let mut farthest = 0.0_f64;
    for row in 0..particles.twins.len() {
        let place = particles.local[row].as_dvec3();
        let (value, gradient) = field.on(particles.patch_of(row)).value_and_gradient(place);
        let spacing = 2.0 * f64::from(particles.radius[row]);
        farthest = farthest.max(value.abs() / gradient.length() / spacing);
    }
    farthest
}

fn write_row(
    out: &mut dyn Write,
    folder: Option<&Path>,
    solid: &Solid,
    settings: &Settings,
) -> io::Result<()> {
    let mut seconds = f64::INFINITY;
    let mut off = 0.0;
    for _ in 0..RUNS {
        let field = solid.field.clone();
        let start = Instant::now();
        let mut run = Run::start(field, settings).expect("valid settings");
        while run.step(65_536).stop_reason.is_none() {}
        seconds = seconds.min(start.elapsed().as_secs_f64());
        let particles = run.particles().clone();
        off = off_the_edge(&particles, &mut *run.evaluator());
    }
    let sample = sample(solid.field.clone(), settings).expect("particles");
    let report = sample.report();
    if let Some(folder) = folder {
        let name = format!("{} {} {:?}.obj", solid.name, report.count, settings.method);
        sample.write_mesh(MeshFormat::Obj, &mut BufWriter::new(File::create(folder.join(name))?))?;
    }
    let method = match (settings.method, report.growth.refined_levels) {
        (Method::Front, _) => "front".to_owned(),
        (Method::Refined, Some(levels)) => format!("refined {levels} ×"),
        _ => "the front stands".to_owned(),
    };
    let components = &sample.mesh().topology.components;
    let euler: i64 = components.iter().map(|component| component.euler()).sum();
    let creases = [report.proof.creases, report.proof.corners].map(Option::unwrap_or_default);
    if let Some(expected) = solid.shape {
        assert_eq!((euler, creases), expected, "{}: Euler number, creases and corners", solid.name);
    }
    let open: u32 = components.iter().map(|component| component.border_edges).sum();
    let volume = match (sample.volume(), solid.volume) {
        (Some(volume), Some(exact)) => format!("{:.4}", volume / exact),
        (Some(volume), None) => format!("({volume:.2})"),
        (None, _) => format!("{open} open edges"),
    };
    let figures = report.measures.quality.as_ref().expect("figures");
    writeln!(
        out,
        "| {} | {method} | {} | {euler} | {volume} | {off:.0e} | {:.1} % | {:.1} | {:.2} | {:.2} | {:.2} |",
        solid.name,
        report.count,
        100.0 * figures.order.six_neighbours,
        figures.angles.smallest_angle,
        figures.coverage.cover,
        figures.spacing.rho,
        1e6 * seconds / report.count as f64
    )
}

fn main() -> io::Result<()> {
    let out = &mut io::stdout();
    // Cargo adds an option of its own.
    let folder = std::env::args().skip(1).find(|argument| !argument.starts_with('-')).map(PathBuf::from);
    folder.as_ref().map_or(Ok(()), fs::create_dir_all)?;
    writeln!(out, "# Solids with sharp edges: all figures\n\n{HEAD}")?;
    for count in COUNTS {
        writeln!(out, "\n## {count} particles\n")?;
        writeln!(
            out,
            "| Solid | Method | Particles | Euler number | Volume | Off the edge | Six neighbours | Smallest angle | Largest hole | \
             Closest pair | µs per particle |"
        )?;
        writeln!(out, "|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|")?;
        for solid in &solids() {
            let settings = Settings::with_count(count);
            write_row(out, folder.as_deref(), solid, &settings)?;
            write_row(out, folder.as_deref(), solid, &settings.refined())?;
        }
    }
    Ok(())
}
