//! A particle, and its tangent frame.

use crate::particles::Slots;
use glam::DVec3;
use serde::Serialize;

/// A particle: position p, normal N̂ and repulsion radius r (§4.2), with its parent, level, front and slots.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "LessonParticle"))]
pub struct Particle {
    /// Position on the surface.
    pub position: [f64; 3],
    /// Unit outward normal.
    pub normal: [f64; 3],
    /// Repulsion radius.
    pub radius: f64,
    /// The particle that placed this one; none for a seed and in particle systems, where no index lasts.
    pub parent: Option<u32>,
    /// Generation level; in a particle system the number of fissions since the first particle.
    pub level: u32,
    /// Number of the front, from 0.
    pub front: u32,
    /// Fates of the slots, three bits each.
    #[serde(skip)]
    pub slots: Slots,
    /// Whether the particle has placed its children.
    #[serde(skip)]
    pub is_done: bool,
    /// Signed distance f/|∇f| from the surface, to first order. Only Witkin and Heckbert's particles are beside it for long.
    #[serde(skip)]
    pub(crate) height: f64,
}

impl Particle {
    /// A particle on the surface that no other has placed.
    pub(crate) fn seed(position: DVec3, normal: DVec3, radius: f64, front: u32) -> Self {
        Self { front, ..Self::placed(position, normal, radius, None, 0) }
    }

    /// A particle of the first front that is not treated yet.
    #[must_use]
    pub fn placed(position: DVec3, normal: DVec3, radius: f64, parent: Option<u32>, level: u32) -> Self {
        Self {
            position: position.to_array(),
            normal: normal.to_array(),
            radius,
            parent,
            level,
            front: 0,
            slots: Slots::default(),
            is_done: false,
            height: 0.0,
        }
    }

    /// Position as a vector.
    #[must_use]
    pub fn p(&self) -> DVec3 {
        self.position.into()
    }

    /// Normal as a vector.
    #[must_use]
    pub fn n(&self) -> DVec3 {
        self.normal.into()
    }
}

/// The tangent frame of a particle (Fig. 3).
#[derive(Clone, Copy, Debug)]
pub struct TangentFrame {
    /// Unit normal N̂.
    pub(crate) n: DVec3,
    /// V̂⁰: unit tangent vector towards the first child.
    pub(crate) u: DVec3,
    /// N̂ × V̂⁰.
    pub(crate) w: DVec3,
    /// Whether the particle is a seed, whose first child is no parent.
    pub(crate) is_seed: bool,
}
