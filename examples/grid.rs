//! Samples a surface through values on a grid, as of a scan or a simulation: a field of one's own.
//!
//! `cargo run --release --example grid -- balls.glb`

use marching_particles::glam::DVec3;
use marching_particles::{Bounds, Field, Settings, sample};
use std::error::Error;
use std::path::PathBuf;

/// Values at the nodes of a grid of so many nodes a side over a box, interpolated linearly along
/// each axis.
struct Grid {
    bounds: Bounds,
    nodes: usize,
    values: Vec<f64>,
}

impl Field for Grid {
    fn value_and_gradient(&self, p: DVec3) -> (f64, DVec3) {
        let cells = (self.nodes - 1) as f64;
        let per_unit = cells / self.bounds.size();
        let place = ((p - self.bounds.lo()) * per_unit).clamp(DVec3::ZERO, DVec3::splat(cells));
        let cell = place.floor().min(DVec3::splat(cells - 1.0));
        let [i, j, k] = cell.to_array().map(|c| c as usize);
        let (mut value, mut slope) = (0.0, DVec3::ZERO);
        for corner in 0..8 {
            let [a, b, c] = [corner & 1, corner >> 1 & 1, corner >> 2];
            let own = self.values[((k + c) * self.nodes + j + b) * self.nodes + i + a];
            // The share of the corner along each axis, and how that changes.
            let ahead = DVec3::new(a as f64, b as f64, c as f64);
            let share = (DVec3::ONE - ahead) + (2.0 * ahead - 1.0) * (place - cell);
            let change = (2.0 * ahead - 1.0) * per_unit;
            value += own * share.x * share.y * share.z;
            slope += own * change * DVec3::new(share.y * share.z, share.x * share.z, share.x * share.y);
        }
        (value, slope)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args_os().nth(1).map_or(std::env::temp_dir().join("balls.glb"), PathBuf::from);

    // Two balls that blend, as numbers.
    let (bounds, nodes) = (Bounds::cube(2.0), 41);
    let node = |n: usize| {
        let place = DVec3::new((n % nodes) as f64, (n / nodes % nodes) as f64, (n / nodes / nodes) as f64);
        bounds.lo() + bounds.size() * place / (nodes - 1) as f64
    };
    let ball = |p: DVec3| 1.0 / (p.length_squared() + 1e-3);
    let density = |p: DVec3| 1.6 - ball(p - 0.7 * DVec3::X) - ball(p + 0.7 * DVec3::X);
    let values = (0..nodes * nodes * nodes).map(|n| density(node(n)).max(-10.0)).collect();

    let sample = sample(Grid { bounds, nodes, values }, &Settings::with_count(4_000).in_box(bounds))?;
    sample.save(&path)?;
    println!("{} particles, {} triangles", sample.report().count, sample.indices().len());
    Ok(())
}
