//! The log of the chapter under way, and the seams of the fronts.

use super::settings::LessonSettings;
use crate::paper::{Event, Observer, Particle};
use crate::sampler::Sampling;

/// A child that meets a particle farther away than this share of 2r is out of step with it. In a lattice it is below 0.2.
const SEAM: f64 = 0.35;

/// The events of the chapter under way, as the run tells them.
#[derive(Clone, Debug)]
pub(super) struct Log {
    pub(super) events: Vec<Event>,
    /// A child that meets a particle farther away than this is on a seam of the fronts; adaptive sampling knows no step to be out of.
    seam: f64,
    /// Particles with a child on a seam, in the order in which they were treated.
    pub(super) seams: Vec<u32>,
}

impl Log {
    pub(super) fn new(settings: &LessonSettings) -> Self {
        let seam = match settings.sampling {
            Sampling::Uniform => SEAM * 2.0 * settings.radius,
            Sampling::Adaptive => f64::INFINITY,
        };
        Self { events: Vec::new(), seam, seams: Vec::new() }
    }

    pub(super) fn push(&mut self, event: Event) {
        self.events.push(event);
    }
}

impl Observer for Log {
    fn event(&mut self, event: Event, particles: &[Particle]) {
        let meeting = match event {
            Event::Compared {
                parent, slot, against, distance: Some(distance), corresponds: true, ..
            } if distance > self.seam => Some((parent, slot, against)),
            _ => None,
        };
        self.push(event);
        let Some((parent, slot, against)) = meeting else { return };
        if self.seams.last() != Some(&parent) {
            self.seams.push(parent);
        }
        if let Some(particle) = against {
            let is_other = particles[parent as usize].front != particles[particle as usize].front;
            self.push(Event::FrontsMeet { parent, slot, particle, is_other });
        }
    }
}
