//! Samples the surface of a closure, joins the particles to a mesh and writes it to a GLB file.
//!
//! `cargo run --release --example closure -- horn.glb`

use marching_particles::glam::DVec3;
use marching_particles::{MeshFormat, Settings, sample};
use std::error::Error;
use std::fs::File;
use std::io::BufWriter;
use std::path::PathBuf;

/// A torus around the z axis, whose tube becomes thinner on one side. Its derivatives are found by
/// differences.
fn horn(p: DVec3) -> f64 {
    let ring = p.truncate().length() - 1.0;
    let tube = 0.3 + 0.15 * p.x;
    ring * ring + p.z * p.z - tube * tube
}

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args_os().nth(1).map_or(std::env::temp_dir().join("horn.glb"), PathBuf::from);

    let sample = sample(horn, &Settings::with_count(4_000).refined())?;
    sample.write_mesh(MeshFormat::Glb, &mut BufWriter::new(File::create(&path)?))?;

    for component in &sample.mesh().topology.components {
        println!("{} triangles, Euler number {}", component.triangles, component.euler());
    }
    Ok(())
}
