//! Event log of the adaptive front at one chosen particle, from which Figures 7 and 8 of the paper can be replayed.
//!
//! It records the neighbours gathered and, for each child, its start, the pushes, the comparison of its angle φ with
//! the free angle τ, and its fate. If no particle is followed, the log costs a comparison per particle and no memory.

use crate::particles::{Particles, SlotFate};
use glam::Vec3;

/// Event at the followed particle: [`Event::Parent`], then the neighbours, then the children.
///
/// Pushed children come one after the other. Children that are placed directly all start before the first one lands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// The particle begins to place its children.
    Parent {
        /// Its position.
        position: Vec3,
        /// Its unit normal.
        normal: Vec3,
        /// Its repulsion radius.
        radius: f32,
        /// Direction of angle 0 in its tangent plane: towards its own parent.
        zero: Vec3,
    },
    /// A neighbour was gathered (Fig. 8a).
    Neighbour {
        /// Index of the neighbour, which may be a provisional particle.
        particle: u32,
        /// Its position.
        position: Vec3,
        /// Its repulsion radius.
        radius: f32,
        /// Its direction in the tangent plane, in radians.
        angle_rad: f32,
    },
    /// Something happened to a child.
    Child {
        /// Number of the child, from 0.
        child: u32,
        /// What happened.
        step: Step,
    },
}

/// Step in the placement of a child.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// The start: the point s on the circle of the parent (Fig. 7a and 7c), or the predicted position.
    Start {
        /// Position of the child.
        position: Vec3,
        /// Repulsion radius there.
        radius: f32,
    },
    /// A push away from the parent (Fig. 7b and 7e).
    Push {
        /// Position after the push.
        position: Vec3,
        /// Repulsion radius there.
        radius: f32,
    },
    /// A push along the circle (Fig. 7f).
    PushOnCircle {
        /// Position after the push.
        position: Vec3,
        /// Repulsion radius there.
        radius: f32,
        /// Largest overlap with another particle, as a share of r_i + r_j.
        overlap: f32,
    },
    /// The comparison of angles that decides whether there is room (Fig. 7g, 8c and 8e).
    Room {
        /// Angle φ that the child takes.
        phi_rad: f32,
        /// Angle τ that is free.
        tau_rad: f32,
    },
    /// The child was projected onto the surface.
    Landed {
        /// Its position.
        position: Vec3,
        /// Its unit normal.
        normal: Vec3,
        /// Its repulsion radius.
        radius: f32,
    },
    /// The fate of the child.
    Fate {
        /// The fate.
        fate: SlotFate,
        /// Index of the new particle, or [`Particles::NO_PARENT`] if there is none.
        particle: u32,
    },
}

/// Event log.
#[derive(Clone, Debug)]
pub struct Trace {
    followed: u32,
    events: Vec<Event>,
}

impl Default for Trace {
    fn default() -> Self {
        Self { followed: Particles::NO_PARENT, events: Vec::new() }
    }
}

impl Trace {
    /// Chooses the particle to follow, or none, from the next run on, and discards all events.
    pub fn follow(&mut self, particle: Option<u32>) {
        self.followed = particle.unwrap_or(Particles::NO_PARENT);
        self.events = Vec::new();
    }

    /// Whether `particle` is followed.
    #[must_use]
    pub fn follows(&self, particle: u32) -> bool {
        self.followed == particle
    }

    /// Records an event at `particle`. `event` is called only if that is followed.
    pub fn note(&mut self, particle: u32, event: impl FnOnce() -> Event) {
        if self.followed == particle {
            self.events.push(event());
        }
    }

    /// Records a step of a child of `particle`. `step` is called only if that is followed.
    pub fn note_child(&mut self, particle: u32, child: u32, step: impl FnOnce() -> Step) {
        if self.followed == particle {
            self.events.push(Event::Child { child, step: step() });
        }
    }

    /// Discards the events of an earlier run.
    pub fn clear(&mut self) {
        self.events.clear();
    }

    /// Recorded events, in order.
    #[must_use]
    pub fn events(&self) -> &[Event] {
        &self.events
    }
}
