//! Samples a surface with particles whose size follows the curvature, a step at a time, and tells
//! how far it is.
//!
//! `cargo run --release --example adaptive`

use marching_particles::{Run, Settings, gallery};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let ellipsoid = gallery::find("ellipsoid").ok_or("the gallery has no such surface")?;
    let settings = Settings::with_count(6_000).adaptive();

    let mut run = Run::start(ellipsoid.field(), &settings)?;
    let mut told = 0.0;
    loop {
        // A budget is a count of work. To cancel a run is to step it no more, or to call `cancel`.
        let progress = run.step(2_000);
        if progress.stop_reason.is_some() {
            break;
        }
        if progress.fraction >= told {
            println!(
                "{:3.0} %  {:?}, {} particles",
                100.0 * progress.fraction,
                progress.phase,
                progress.particles
            );
            told += 0.1;
        }
    }
    let sample = run.finish()?;
    let sizes = sample.report().sizes;
    println!("radii from {:.4} to {:.4}", sizes.radius_min, sizes.radius_max);
    Ok(())
}
