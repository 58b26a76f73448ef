//! An event log of the adaptive front at one chosen particle, with which Figures 7 and 8 of the paper can be replayed: the
//! neighbours gathered, where each child starts, how it is pushed, how its angle φ compares with the free one τ, and its
//! fate.
//!
//! While nothing is followed it costs a comparison per particle, and no memory.

use crate::particles::{Particles, SlotFate};
use glam::Vec3;

/// What happened at the particle that is followed: [`Event::Parent`], the neighbours, then the children. Children that are
/// pushed come one after the other; those that are placed directly all start before the first one lands.
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
    /// A particle was gathered (Fig. 8a).
    Neighbour {
        /// Index of the particle, or of its provisional place.
        particle: u32,
        /// Its position.
        position: Vec3,
        /// Its radius.
        radius: f32,
        /// Its direction in the tangent plane, in radians.
        angle_rad: f32,
    },
    /// Something happened to a child.
    Child {
        /// Number of the child, from 0.
        child: u32,
        /// What it was.
        step: Step,
    },
}

/// What happens to a child.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// Where it begins: the point s on the circle of the parent (Fig. 7a and 7c), or the place predicted.
    Start {
        /// Its centre.
        position: Vec3,
        /// The radius there.
        radius: f32,
    },
    /// A push away from the parent (Fig. 7b and 7e).
    Push {
        /// Its centre after it.
        position: Vec3,
        /// The radius there.
        radius: f32,
    },
    /// A push along the circle (Fig. 7f).
    PushOnCircle {
        /// Its centre after it.
        position: Vec3,
        /// The radius there.
        radius: f32,
        /// Largest share of r_i + r_j by which it overlaps another particle.
        overlap: f32,
    },
    /// The comparison that decides (Fig. 7g, 8c and 8e).
    Room {
        /// φ, the angle that it takes.
        phi_rad: f32,
        /// τ, the angle that is free.
        tau_rad: f32,
    },
    /// It came to lie on the surface.
    Landed {
        /// Its position.
        position: Vec3,
        /// Its unit normal.
        normal: Vec3,
        /// Its radius.
        radius: f32,
    },
    /// What became of it.
    Fate {
        /// The fate.
        fate: SlotFate,
        /// Index of the new particle; [`Particles::NO_PARENT`] if there is none.
        particle: u32,
    },
}

/// The log.
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
    /// Follows a particle, or none, from the next run on.
    pub fn follow(&mut self, particle: Option<u32>) {
        self.followed = particle.unwrap_or(Particles::NO_PARENT);
        self.events = Vec::new();
    }

    /// Whether this particle is followed.
    #[must_use]
    pub fn follows(&self, particle: u32) -> bool {
        self.followed == particle
    }

    /// Notes an event at `particle`; made only if that is followed.
    pub fn note(&mut self, particle: u32, event: impl FnOnce() -> Event) {
        if self.followed == particle {
            self.events.push(event());
        }
    }

    /// Notes what happens to a child of `particle`; made only if that is followed.
    pub fn note_child(&mut self, particle: u32, child: u32, step: impl FnOnce() -> Step) {
        if self.followed == particle {
            self.events.push(Event::Child { child, step: step() });
        }
    }

    /// Forgets the events of an earlier run.
    pub fn clear(&mut self) {
        self.events.clear();
    }

    /// The events so far.
    #[must_use]
    pub fn events(&self) -> &[Event] {
        &self.events
    }
}
