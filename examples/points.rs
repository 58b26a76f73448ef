//! Reads a file of points, with normals or without, fits a surface to them and samples it.
//!
//! `cargo run --release --example points -- scan.xyz`; without a file, points of a ball are taken.

use marching_particles::glam::DVec2;
use marching_particles::{Settings, fit_points, sample};
use std::error::Error;

/// Points of a ball as lines of text, along a spiral of equal steps in height.
fn ball() -> Vec<u8> {
    const COUNT: u32 = 600;
    let line = |k: u32| {
        let z = 1.0 - (2.0 * f64::from(k) + 1.0) / f64::from(COUNT);
        let around = (1.0 - z * z).sqrt() * DVec2::from_angle(2.4 * f64::from(k));
        format!("{} {} {z}\n", around.x, around.y)
    };
    (0..COUNT).map(line).collect::<String>().into_bytes()
}

fn main() -> Result<(), Box<dyn Error>> {
    let (name, bytes) = match std::env::args().nth(1) {
        Some(path) => (path.clone(), std::fs::read(path)?),
        None => ("ball.xyz".to_owned(), ball()),
    };
    let fit = fit_points(&name, bytes, 200)?;
    println!("a surface from {} centres near {} points", fit.info.centres, fit.info.points);

    let sample = sample(fit.field(), &Settings::with_count(3_000).in_box(fit.bounds))?;
    println!("{} particles, {} component", sample.report().count, sample.report().proof.components);
    Ok(())
}
