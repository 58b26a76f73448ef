//! Samples the surface of a formula and writes its particles to a PLY file.
//!
//! `cargo run --release --example formula -- cushion.ply`

use marching_particles::{Format, Formula, Settings, sample};
use std::error::Error;
use std::fs::File;
use std::io::BufWriter;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args_os().nth(1).map_or(std::env::temp_dir().join("cushion.ply"), PathBuf::from);

    let surface = Formula::parse("x^4 + y^4 + z^4 = a")?.with("a", 0.5)?;
    let sample = sample(surface, &Settings::with_count(5_000))?;
    sample.write(Format::Ply, &mut BufWriter::new(File::create(&path)?))?;

    let report = sample.report();
    println!("{} particles on {} component in {}", report.count, report.proof.components, path.display());
    for warning in &report.warnings {
        println!("{warning}");
    }
    Ok(())
}
