//! The scheme of forces with which the paper compares its adaptive sampling (§6, Table 1): discs whose radii follow the
//! curvature push each other apart where they overlap, and "we split a particle when no force is applied on it".
//!
//! The forces, the radii and the projection onto the surface are those of our own relaxation, [`Overlap`]: "we used the
//! same code for the relaxations of our methods and for the comparative techniques (with the exception of the split
//! criterion)".
//!
//! # Differs from the paper
//!
//! * The paper mentions no death and does not say how its counts settle. Here a particle that is compressed at least as
//!   much as in a lattice with δ = 0.7 of the wanted spacing dies with the same probability as in Witkin and Heckbert's
//!   scheme, so that a particle squeezed into the last gap is removed again.
//! * Two particles repel each other with the weight 1 if their normals are within 90°, and not at all otherwise. In our
//!   own relaxation the weight falls from 1 to 0 between 60° and 120°.
//! * "No force" has a tolerance, [`Settings::free_load`]: discs that push each other apart never separate completely.
//! * Only particles that have come to rest divide or die, as in Witkin and Heckbert's scheme.
//! * The children are placed half a radius to either side of their parent in a random direction, on the surface, with
//!   the radii there.

use super::crowd::Particle;
use super::{Settings, SurfaceContext};
use crate::math::Bounds;
use crate::sampler::projection::{Accuracy, BATCH};
use crate::sampler::relaxation::repulsion::{LandingBatch, Overlap, Repulsion};
use crate::sampler::relaxation::repulsion::{MAX_MOVE, TRUSTED_CORRECTION};
use crate::sampler::sizing::Sizing;
use crate::spatial::Neighbour;
use core::ops::Range;
use glam::{Vec3, Vec4};

/// A particle that has moved by less than this share of its radius in an iteration counts as at rest. This is γΔt of
/// Witkin and Heckbert, with γ = 4 and Δt = 0.03.
const REST: f32 = 0.12;

/// The scheme, with the constants of a run.
#[derive(Clone, Debug)]
pub(crate) struct Forces {
    pub(crate) sizing: Sizing,
    pub(crate) bounds: Bounds,
    pub(crate) accuracy: Accuracy,
    pub(crate) min_gradient: f32,
    /// Σ (overlap / mean radius)² of a particle below which it divides.
    free: f32,
    /// The same sum above which it may die.
    crowded: f32,
}

impl Forces {
    pub(crate) fn new(
        settings: &Settings,
        sizing: Sizing,
        bounds: &Bounds,
        accuracy: Accuracy,
        min_gradient: f32,
    ) -> Self {
        // A particle is compressed as much by six neighbours at δ of the spacing 2r.
        let overlap = Overlap::RANGE - 2.0 * settings.death_radius as f32;
        let (free, crowded) = (settings.free_load as f32, 6.0 * overlap * overlap);
        Self { sizing, bounds: *bounds, accuracy, min_gradient, free, crowded }
    }

    pub(crate) fn law(&self) -> Overlap<'_> {
        Overlap { sizing: &self.sizing, accuracy: self.accuracy, min_gradient: self.min_gradient }
    }

    /// Returns the distance at which a particle of this radius repels one that is not larger.
    pub(crate) fn reach(radius: f32) -> f32 {
        Overlap::RANGE * radius
    }

    /// Adds the forces between particle `i` and those neighbours that have a smaller radius or, at equal radii, a
    /// smaller index.
    pub(crate) fn repel(&self, particles: &mut [Particle], i: usize, near: &[Neighbour]) {
        let Particle { normal, radius, .. } = particles[i];
        let law = self.law();
        let (mut force, mut load) = (Vec3::ZERO, 0.0);
        for four in near.chunks(4) {
            let (mut distance_sq, mut mean) = ([0.0; 4], [1.0; 4]);
            for (lane, other) in four.iter().enumerate() {
                distance_sq[lane] = other.distance_sq;
                mean[lane] = 0.5 * (radius + particles[other.index as usize].radius);
            }
            let (weight, energy) = law.pairs(Vec4::from_array(distance_sq), Vec4::from_array(mean));
            let (weight, energy) = (weight.to_array(), energy.to_array());
            for (lane, near) in four.iter().enumerate() {
                let j = near.index as usize;
                let other = &mut particles[j];
                let is_met_here = other.radius < radius || other.radius == radius && j < i;
                if !is_met_here || normal.dot(other.normal) <= 0.0 {
                    continue;
                }
                let push = near.offset * weight[lane];
                force -= push;
                other.force += push;
                load += energy[lane];
                other.load += energy[lane];
            }
        }
        particles[i].force += force;
        particles[i].load += load;
    }

    /// Moves particles along their forces by one step of the relaxation.
    pub(crate) fn advance(
        &self,
        surface: &mut SurfaceContext,
        particles: &mut [Particle],
        range: Range<usize>,
    ) {
        let mut landing = LandingBatch::new();
        for (k, particle) in particles[range.clone()].iter().enumerate() {
            let (force, normal) = (particle.force, particle.normal);
            let along = force - normal * normal.dot(force);
            let step = (along * Overlap::STEP).clamp_length_max(MAX_MOVE * particle.radius);
            landing.position[k] = particle.position + step;
            landing.radius[k] = particle.radius;
            landing.radius_travel[k] = particle.radius_travel + step.length();
        }
        landing.count = range.len();
        landing.trust = TRUSTED_CORRECTION;
        self.law().land(surface.field, surface.projector, &mut landing);
        for (k, particle) in particles[range].iter_mut().enumerate() {
            let (position, normal) = (landing.position[k], landing.normal[k]);
            particle.moved = 0.0;
            // A particle stays where it is if it cannot go: at the border of the box, where the field ends, at a fold.
            if landing.ok[k] && self.bounds.contains(position) && normal.dot(particle.normal) > 0.0 {
                particle.moved = (position - particle.position).length() / particle.radius;
                particle.position = position;
                particle.normal = normal;
                particle.radius = landing.radius[k];
                particle.radius_travel = landing.radius_travel[k];
            }
        }
    }

    /// Returns whether the particle dies, given a random number in [0, 1).
    pub(crate) fn dies(&self, particle: &Particle, random: f32) -> bool {
        particle.moved < REST && particle.load > self.crowded && random > self.crowded / particle.load
    }

    /// Returns whether the particle divides.
    pub(crate) fn divides(&self, particle: &Particle) -> bool {
        particle.moved < REST && particle.load < self.free
    }

    /// Returns the two children of a particle, on either side of it in `direction`; `None` if one does not come to the
    /// surface.
    pub(crate) fn children(
        &self,
        surface: &mut SurfaceContext,
        parent: &Particle,
        direction: Vec3,
    ) -> Option<[Particle; 2]> {
        let step = direction * (0.5 * parent.radius);
        let children = [parent.position + step, parent.position - step];
        let landed =
            self.land(surface, children.map(|position| Particle { position, ..*parent }), TRUSTED_CORRECTION);
        let is_good =
            |child: &Particle| self.bounds.contains(child.position) && child.normal.dot(parent.normal) > 0.0;
        landed.filter(|children| children.iter().all(is_good))
    }

    /// Returns the particles on the surface, with the radii there; `None` if one does not come to it. A Newton
    /// correction shorter than `trust` radii is not checked.
    pub(crate) fn land<const N: usize>(
        &self,
        surface: &mut SurfaceContext,
        particles: [Particle; N],
        trust: f32,
    ) -> Option<[Particle; N]> {
        const { assert!(N <= BATCH) };
        let mut landing = LandingBatch::new();
        landing.count = N;
        for (k, particle) in particles.iter().enumerate() {
            landing.position[k] = particle.position;
            landing.radius[k] = particle.radius;
            // So its radius is brought up to date.
            landing.radius_travel[k] = f32::INFINITY;
        }
        landing.trust = trust;
        self.law().land(surface.field, surface.projector, &mut landing);
        landing.ok[..N].iter().all(|&ok| ok).then(|| {
            core::array::from_fn(|k| Particle::new(landing.position[k], landing.normal[k], landing.radius[k]))
        })
    }

    /// Returns the particle on the surface within the tolerance. Where rounding hides the surface the particle stays as
    /// it is: it has always been on the surface.
    pub(crate) fn landed(&self, surface: &mut SurfaceContext, particle: &Particle) -> Particle {
        match self.land(surface, [*particle], 0.0) {
            Some([landed]) if self.bounds.contains(landed.position) => landed,
            _ => *particle,
        }
    }
}
