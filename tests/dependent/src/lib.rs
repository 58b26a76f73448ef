//! Particles on a sphere, for a host without JavaScript.

use marching_particles::glam::DVec3;
use marching_particles::{Settings, sample};
use std::rc::Rc;

/// Number of particles of a sample of so many.
#[unsafe(no_mangle)]
pub extern "C" fn count(wanted: u32) -> u32 {
    // As a function of JavaScript, this one cannot go to another thread.
    let centre = Rc::new(DVec3::X);
    let sample = sample(move |p: DVec3| p.distance(*centre) - 1.0, &Settings::with_count(wanted));
    sample.map_or(0, |sample| sample.report().count as u32)
}
