//! Follows the front level by level: how many particles each generation places, and what became of
//! their children.
//!
//! `cargo run --release --example levels`

use marching_particles::{Formula, Radius, Run, Settings};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let mut settings = Settings::with_radius(Radius::Share(0.02));
    settings.relax_steps = 0;
    let mut run = Run::start(Formula::parse("x^2 + 2y^2 + 4z^2 = 1")?, &settings)?;
    while run.step(500).stop_reason.is_none() {}

    let particles = run.particles();
    let levels = particles.level.iter().max().map_or(0, |last| last + 1);
    for level in 0..levels {
        let count = particles.level.iter().filter(|&&of| of == level).count();
        println!("{level:3} {}", "o".repeat(count));
    }
    // The first particle is the seed; a child's parent comes before it.
    let seed = particles.local[0];
    let children = particles.parent.iter().filter(|&&parent| parent == 0).count();
    println!("the seed at {seed} has {children} children");
    println!("{:?}", run.finish()?.report().growth.fates);
    Ok(())
}
