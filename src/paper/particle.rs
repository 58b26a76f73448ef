//! A particle, and the space partitioning by which the particles near a point are found (§4.4, "any
//! other hierarchical partitioning should work fine"): cubes of one size in an ordered map.

use crate::particles::Slots;
use glam::DVec3;
use serde::Serialize;
use std::collections::BTreeMap;

/// A particle: position p, normal N̂ and repulsion radius r (§4.2), with its parent, level, front
/// and slots.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "LessonParticle"))]
pub struct Particle {
    /// Position on the surface.
    pub position: [f64; 3],
    /// Unit outward normal.
    pub normal: [f64; 3],
    /// Repulsion radius.
    pub radius: f64,
    /// The particle that placed this one; none for a seed, and in particle systems, whose indices
    /// change.
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
    /// Signed distance f/|∇f| from the surface, to first order. Only Witkin and Heckbert's
    /// particles may be off it for several steps.
    #[serde(skip)]
    pub(crate) height: f64,
}

impl Particle {
    /// A particle of the first front that is not treated yet.
    #[must_use]
    pub fn placed(position: DVec3, normal: DVec3, radius: f64, parent: Option<u32>, level: u32) -> Self {
        Self {
            position: position.to_array(),
            normal: normal.to_array(),
            radius,
            parent,
            level,
            ..Self::default()
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

/// A particle near another one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "LessonNearby"))]
pub struct Nearby {
    /// Index of the particle.
    pub particle: u32,
    /// Distance to the particle.
    pub distance: f64,
}

/// Particles by the cube that contains them.
#[derive(Clone, Debug)]
pub(crate) struct Buckets {
    side: f64,
    cubes: BTreeMap<[i32; 3], Vec<u32>>,
}

impl Buckets {
    pub(crate) fn new(side: f64, particles: &[Particle]) -> Self {
        let mut buckets = Self { side, cubes: BTreeMap::new() };
        for (i, particle) in particles.iter().enumerate() {
            buckets.insert(particle.p(), i as u32);
        }
        buckets
    }

    fn cube(&self, p: DVec3) -> [i32; 3] {
        (p / self.side).floor().to_array().map(|k| k as i32)
    }

    pub(crate) fn insert(&mut self, p: DVec3, particle: u32) {
        self.cubes.entry(self.cube(p)).or_default().push(particle);
    }

    /// The particles within `reach` of a point, by index.
    pub(crate) fn near(&self, particles: &[Particle], centre: DVec3, reach: f64) -> Vec<Nearby> {
        let ([x0, y0, z0], [x1, y1, z1]) = (self.cube(centre - reach), self.cube(centre + reach));
        let mut found = Vec::new();
        for x in x0..=x1 {
            for y in y0..=y1 {
                for (_, cube) in self.cubes.range([x, y, z0]..=[x, y, z1]) {
                    for &particle in cube {
                        let distance = particles[particle as usize].p().distance(centre);
                        if distance <= reach {
                            found.push(Nearby { particle, distance });
                        }
                    }
                }
            }
        }
        found.sort_by_key(|near| near.particle);
        found
    }
}
