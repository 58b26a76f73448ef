//! The log of the current chapter, which turns the moments of the paper's run into events, and the
//! seams of the fronts.

use super::event::Event;
use super::settings::LessonSettings;
use crate::paper::{ChildSlot, Moment, Observer, Particle, Trial};
use crate::particles::SlotFate;
use crate::sampler::Sampling;

/// A child that meets a particle farther away than this share of 2r is out of step with it. The
/// match radius, beyond which children meet nothing, is twice as far.
const SEAM: f64 = 0.35;

/// The events of the current chapter, as the run reports them.
#[derive(Clone, Debug)]
pub(super) struct Log {
    pub(super) events: Vec<Event>,
    /// A child that meets a particle farther away than this is on a seam between fronts. Infinite
    /// in adaptive sampling, which has no lattice to be out of step with.
    seam: f64,
    /// Particles with a child on a seam, in the order in which they were treated.
    pub(super) seams: Vec<u32>,
    /// Whether the limit on particles was reached.
    pub(super) is_capped: bool,
}

impl Log {
    pub(super) fn new(settings: &LessonSettings) -> Self {
        let seam = match settings.sampling {
            Sampling::Uniform => SEAM * 2.0 * settings.radius,
            Sampling::Adaptive => f64::INFINITY,
        };
        Self { events: Vec::new(), seam, seams: Vec::new(), is_capped: false }
    }

    pub(super) fn push(&mut self, event: Event) {
        self.events.push(event);
    }
}

impl Observer for Log {
    fn see(&mut self, child: ChildSlot, moment: Moment<'_>, particles: &[Particle]) {
        let ChildSlot { parent, slot } = child;
        self.is_capped |= matches!(moment, Moment::Decided { fate: SlotFate::Capped, .. });
        if let Moment::Decided { fate: SlotFate::Added, particle: Some(particle) } = moment {
            self.push(Event::Added { particle, data: particles[particle as usize] });
        }
        self.push(match moment {
            Moment::Frame(frame) => {
                let [normal, u, w] = [frame.n, frame.u, frame.w].map(|v| v.to_array());
                Event::Frame { particle: parent, normal, u, w }
            }
            Moment::Proposed(circle) => {
                let theta_rad = circle.start_rad;
                let (direction, place) = (circle.direction.to_array(), circle.point(theta_rad).to_array());
                Event::Slot { parent, slot, direction, theta_rad, place }
            }
            Moment::Tried(Trial { step, theta_rad, position, value, slope }) => {
                let position = position.to_array();
                Event::Iterate { parent, slot, step, theta_rad, position, value, slope }
            }
            Moment::Landed { position, normal } => {
                let distance = position.distance(particles[parent as usize].p());
                let (position, normal) = (position.to_array(), normal.to_array());
                Event::Landed { parent, slot, position, normal, distance }
            }
            Moment::Gathered { reach, neighbours } => {
                Event::Gathered { particle: parent, reach, neighbours: neighbours.to_vec() }
            }
            Moment::Compared { position, nearest, limit, corresponds } => {
                let (position, distance) = (position.to_array(), nearest.map(|near| near.distance));
                // A child that is not yet projected is not a particle.
                let against = nearest.map(|near| near.particle).filter(|&k| (k as usize) < particles.len());
                Event::Compared { parent, slot, position, against, distance, limit, corresponds }
            }
            Moment::Decided { fate, particle } => Event::Fate { parent, slot, fate, particle },
            Moment::Space { ends, angles_rad } => {
                let [before, behind] = ends.map_or([None; 2], |both| both.map(Some));
                Event::Arc { parent, before, behind, angles_rad }
            }
            Moment::Started { tangent, position, radius } => {
                let (tangent, position) = (tangent.map(|tangent| tangent.to_array()), position.to_array());
                Event::Start { parent, slot, tangent, position, radius }
            }
            Moment::Pushed { position, radius } => {
                Event::Push { parent, slot, position: position.to_array(), radius }
            }
            Moment::Turned { position, radius, overlap } => {
                Event::PushOnCircle { parent, slot, position: position.to_array(), radius, overlap }
            }
            Moment::Room { phi_rad, tau_rad, fits } => Event::Room { parent, slot, phi_rad, tau_rad, fits },
        });
        let Moment::Compared { nearest: Some(near), corresponds: true, .. } = moment else { return };
        if near.distance <= self.seam {
            return;
        }
        if self.seams.last() != Some(&parent) {
            self.seams.push(parent);
        }
        if let Some(other) = particles.get(near.particle as usize) {
            let is_other = particles[parent as usize].front != other.front;
            self.push(Event::FrontsMeet { parent, slot, particle: near.particle, is_other });
        }
    }
}
