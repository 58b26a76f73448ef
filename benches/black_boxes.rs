//! Solids of which nothing but a function is known: which of their meshes are closed and right.
//!
//! `cargo bench -p benches --bench black_boxes --profile dev -- FOLDER` writes the mesh of each
//! solid to that folder, with its function at random points and at the nodes of a grid. `python
//! benches/black_boxes.py FOLDER` then judges the meshes by these, with NumPy alone. A second
//! argument is a part of the names of the solids to take.
#![allow(clippy::disallowed_methods, reason = "a bench measures time")]

#[path = "../tests/it/black_box_table.rs"]
mod black_box_table;

use black_box_table::{Function, Solid, fading_solids, more_solids, solids};
use glam::{DMat3, DVec3, dvec3};
use marching_particles::{Bounds, MeshFormat, Settings, sample};
use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::PathBuf;

/// Numbers of particles.
const COUNT: u32 = 8_000;
/// Half a side of the box that holds every solid.
const HALF: f64 = 1.8;
/// Nodes along each side of the grid.
const SIDE: usize = 180;
/// Points at which the volume is measured.
const POINTS: u32 = 2_000_000;

/// The share of the box in which f is negative, by a Kronecker sequence: multiples of the powers of
/// the reciprocal of the root of x⁴ = x + 1.
fn inside(f: &Function) -> f64 {
    const BASE: f64 = 1.220_744_084_605_759_5;
    let steps = dvec3(1.0 / BASE, 1.0 / (BASE * BASE), 1.0 / (BASE * BASE * BASE));
    let place = |k: u32| ((f64::from(k) + 0.5) * steps).fract() * (2.0 * HALF) - HALF;
    f64::from((0..POINTS).filter(|&k| f(place(k)) < 0.0).count() as u32) / f64::from(POINTS)
}

/// Whether f is negative at the nodes of the grid, a byte each, the first axis fastest.
fn nodes(f: &Function) -> Vec<u8> {
    let at = |k: usize| -HALF + 2.0 * HALF * (k as f64 + 0.413) / SIDE as f64;
    let nodes = (0..SIDE.pow(3)).map(|k| dvec3(at(k % SIDE), at(k / SIDE % SIDE), at(k / SIDE / SIDE)));
    nodes.map(|p| u8::from(f(p) < 0.0)).collect()
}

fn main() -> io::Result<()> {
    // Cargo adds an option of its own.
    let mut arguments = std::env::args().skip(1).filter(|argument| !argument.starts_with('-'));
    let folder = PathBuf::from(arguments.next().expect("the folder for the meshes"));
    let part = arguments.next().unwrap_or_default();
    fs::create_dir_all(&folder)?;
    let known = solids().into_iter().chain(fading_solids()).map(|solid| {
        let Solid { name, euler, creases, corners, volume, f } = solid;
        (name, f, Some((euler, creases, corners)), volume)
    });
    let all = known.chain(more_solids().into_iter().map(|(name, f)| (name, f, None, None)));
    let turn = DMat3::from_axis_angle(dvec3(1.0, 2.0, 3.0).normalize_or_zero(), 0.7);
    println!("name,turned,particles,calls,seconds,closed,shape,warnings");
    for (name, f, shape, volume) in all.filter(|(name, ..)| name.contains(&part)) {
        let f: std::sync::Arc<Function> = std::sync::Arc::new(f);
        let straight = std::sync::Arc::clone(&f);
        let forms: [(&str, Function); 2] = [
            ("straight", Box::new(move |p| straight(p))),
            ("turned", Box::new(move |p: DVec3| f(turn * (p - dvec3(0.123, -0.2, 0.1))))),
        ];
        for (form, f) in forms {
            let nodes = nodes(&f);
            let volume = volume.unwrap_or_else(|| inside(&f) * (2.0 * HALF).powi(3));
            let settings = Settings::with_count(COUNT).in_box(Bounds::cube(HALF));
            let start = std::time::Instant::now();
            let sample = match sample(f, &settings) {
                Ok(sample) => sample,
                Err(error) => {
                    println!("{name},{form},,,,,,\"{error}\"");
                    continue;
                }
            };
            let path = folder.join(format!("{name}, {form}"));
            fs::write(path.with_extension("nodes"), nodes)?;
            fs::write(path.with_extension("volume"), volume.to_string())?;
            let mesh = &mut BufWriter::new(File::create(path.with_extension("obj"))?);
            sample.write_mesh(MeshFormat::Obj, mesh)?;
            let report = sample.report();
            let warnings: Vec<String> = report.warnings.iter().map(ToString::to_string).collect();
            let (topology, proof) = (&sample.mesh().topology, &report.proof);
            let found =
                (topology.euler(), proof.creases.unwrap_or_default(), proof.corners.unwrap_or_default());
            let shape = match shape {
                Some(shape) if shape != found => format!("{found:?} of {shape:?}"),
                _ => format!("{found:?}"),
            };
            println!(
                "{name},{form},{},{},{:.1},{},\"{shape}\",\"{}\"",
                report.count,
                report.growth.calls.unwrap_or(0),
                start.elapsed().as_secs_f64(),
                topology.is_closed(),
                warnings.join(" | ").replace('"', "'")
            );
        }
    }
    Ok(())
}
