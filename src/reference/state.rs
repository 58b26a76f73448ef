//! The particles of the reference.

use crate::particles::Slots;
use glam::DVec3;
use serde::Serialize;

/// A particle: position p, normal N̂ and repulsion radius r (§4.2), and how it came to be.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "LessonParticle"))]
pub struct Particle {
    /// Position on the surface.
    pub position: [f64; 3],
    /// Unit outward normal.
    pub normal: [f64; 3],
    /// Repulsion radius.
    pub radius: f64,
    /// The particle that placed it; none for a seed and in particle systems, where no index lasts.
    pub parent: Option<u32>,
    /// Generation level; in a particle system the number of fissions since the first particle.
    pub level: u32,
    /// Number of the front: that of its seed, from 0.
    pub front: u32,
    /// Fates of its slots, three bits each.
    #[serde(skip)]
    pub slots: Slots,
    /// Whether its children have been placed.
    #[serde(skip)]
    pub is_done: bool,
    /// Signed distance f/|∇f| from the surface, to first order. Only Witkin and Heckbert's particles are beside it for long.
    #[serde(skip)]
    pub(super) height: f64,
}

impl Particle {
    /// A particle on the surface that no other has placed.
    pub(super) fn seed(position: DVec3, normal: DVec3, radius: f64, front: u32) -> Self {
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

    /// The particle as it was before it was treated.
    pub(super) fn untreated(mut self) -> Self {
        self.is_done = false;
        self.slots = Slots::default();
        self
    }
}

/// FNV-1a hash of the bits of all particles.
#[must_use]
pub fn digest(particles: &[Particle]) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut word = |bits: u64| {
        for byte in bits.to_le_bytes() {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    };
    for particle in particles {
        let vectors = [particle.position, particle.normal];
        vectors.as_flattened().iter().chain([&particle.radius]).for_each(|number| word(number.to_bits()));
        word(u64::from(particle.parent.unwrap_or(u32::MAX)));
        word(u64::from(particle.level));
        word(u64::from(particle.slots.0) << 1 | u64::from(particle.is_done));
    }
    hash
}

/// Whether a particle at `offset` from a point with the unit normal `normal` is of the same sheet: it faces the same way, and
/// rises by no more than 45° from the tangent plane. Below the distance `slack` the direction between the two tells nothing.
#[must_use]
pub(super) fn is_same_sheet(offset: DVec3, normal: DVec3, other: DVec3, slack: f64) -> bool {
    let rise = offset.dot(normal);
    normal.dot(other) > 0.0 && rise * rise <= 0.5 * (offset.length_squared() + slack * slack)
}
