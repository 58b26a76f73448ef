//! Samples a surface through an array of numbers, as of a scan or a simulation.
//!
//! `cargo run --release --example grid -- balls.glb`

use marching_particles::glam::DVec3;
use marching_particles::{Image, Settings, sample};
use std::error::Error;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args_os().nth(1).map_or(std::env::temp_dir().join("balls.glb"), PathBuf::from);

    // Two balls that blend, as numbers at the nodes of a grid; x changes fastest.
    let (nodes, first, step) = (41, DVec3::splat(-2.0), 0.1);
    let ball = |p: DVec3| 1.0 / (p.length_squared() + 1e-3);
    let density = |p: DVec3| ball(p - 0.7 * DVec3::X) + ball(p + 0.7 * DVec3::X);
    let node = |n: usize| [n % nodes, n / nodes % nodes, n / nodes / nodes].map(|k| k as f64);
    let place = |n: usize| first + step * DVec3::from_array(node(n));
    let values: Vec<f32> = (0..nodes.pow(3)).map(|n| density(place(n)).min(10.0) as f32).collect();

    // Where the numbers are larger is inside; `ImageField::inverted` has it the other way round.
    let grid = Image::new([nodes; 3], values)?.with_spacing([step; 3])?.with_origin(first)?;
    let sample = sample(grid.at(1.6)?, &Settings::with_count(4_000))?;
    sample.save(&path)?;
    println!("{} particles, {} triangles", sample.report().count, sample.indices().len());
    Ok(())
}
