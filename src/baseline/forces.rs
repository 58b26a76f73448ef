//! The scheme of forces to which the paper compares its adaptive sampling (§6, Table 1): discs whose radii follow the curvature
//! push each other apart where they overlap, and "we split a particle when no force is applied on it".
//!
//! Forces by distance, radii and the way back onto the surface are those of our own relaxation, [`Overlap`]: "we used the same code for the
//! relaxations of our methods and for the comparative techniques (with the exception of the split criterion)".
//!
//! # Differs from the paper
//!
//! * The paper names no death, and does not say how its counts settle. Here a particle that is pressed as if in a lattice with δ = 0.7
//!   of the wanted spacing, or more, dies with the same chance as with Witkin and Heckbert: what is pressed in the last gap
//!   from all sides leaves again.
//! * Two particles push each other in full up to normals 90° apart, and beyond that not at all; with our own relaxation that fades
//!   between 60° and 120°.
//! * "No force" has a tolerance, [`Settings::free_load`]: two discs that push each other apart never quite come apart.
//! * Only particles that have come to rest divide or die, as with Witkin and Heckbert.
//! * The children sit half a radius to either side of their parent in a random direction, on the surface, with the radii there.

use super::crowd::Particle;
use super::{Ground, Settings};
use crate::math::Bounds;
use crate::sampler::projection::BATCH;
use crate::sampler::relaxation::repulsion::{LandingBatch, Overlap, Repulsion};
use crate::sampler::relaxation::repulsion::{MAX_MOVE, TRUSTED_CORRECTION};
use crate::sampler::sizing::Sizing;
use crate::spatial::Neighbour;
use core::ops::Range;
use glam::{Vec3, Vec4};

/// A particle that has gone less than this share of its radius in an iteration counts as at rest: γΔt of Witkin and Heckbert, whose
/// γ is 4 and whose Δt is 0.03.
const REST: f32 = 0.12;

/// The scheme with the constants of a run.
#[derive(Clone, Debug)]
pub(crate) struct Forces {
    pub(crate) sizing: Sizing,
    pub(crate) bounds: Bounds,
    pub(crate) resolution: f32,
    pub(crate) min_gradient: f32,
    /// Σ (overlap / mean radius)² of a particle below which it divides.
    free: f32,
    /// The same above which it may die.
    crowded: f32,
}

impl Forces {
    pub(crate) fn new(
        settings: &Settings,
        sizing: Sizing,
        bounds: &Bounds,
        resolution: f32,
        min_gradient: f32,
    ) -> Self {
        // Six neighbours at δ of the spacing 2r.
        let overlap = Overlap::RANGE - 2.0 * settings.death_radius as f32;
        let (free, crowded) = (settings.free_load as f32, 6.0 * overlap * overlap);
        Self { sizing, bounds: *bounds, resolution, min_gradient, free, crowded }
    }

    pub(crate) fn law(&self) -> Overlap<'_> {
        Overlap { sizing: &self.sizing, resolution: self.resolution, min_gradient: self.min_gradient }
    }

    /// How far a particle of this radius reaches to one no larger.
    pub(crate) fn reach(radius: f32) -> f32 {
        Overlap::RANGE * radius
    }

    /// Adds the forces between particle `i` and its neighbours of a smaller radius or, where the radii are equal, index.
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
    pub(crate) fn advance(&self, ground: &mut Ground, particles: &mut [Particle], range: Range<usize>) {
        let mut landing = LandingBatch::new();
        for (k, particle) in particles[range.clone()].iter().enumerate() {
            let (force, normal) = (particle.force, particle.normal);
            let along = force - normal * normal.dot(force);
            let step = (along * Overlap::STEP).clamp_length_max(MAX_MOVE * particle.radius);
            landing.position[k] = particle.position + step;
            landing.radius[k] = particle.radius;
            landing.radius_travel[k] = particle.since + step.length();
        }
        landing.count = range.len();
        landing.trust = TRUSTED_CORRECTION;
        self.law().land(ground.field, ground.projector, &mut landing);
        for (k, particle) in particles[range].iter_mut().enumerate() {
            let (position, normal) = (landing.position[k], landing.normal[k]);
            particle.way = 0.0;
            // A particle that cannot go stays: at the border of the box, where the field ends, at a fold.
            if landing.ok[k] && self.bounds.contains(position) && normal.dot(particle.normal) > 0.0 {
                particle.way = (position - particle.position).length() / particle.radius;
                particle.position = position;
                particle.normal = normal;
                particle.radius = landing.radius[k];
                particle.since = landing.radius_travel[k];
            }
        }
    }

    /// Whether the particle dies, if the random number comes out against it.
    pub(crate) fn dies(&self, particle: &Particle, random: f32) -> bool {
        particle.way < REST && particle.load > self.crowded && random > self.crowded / particle.load
    }

    /// Whether the particle divides.
    pub(crate) fn divides(&self, particle: &Particle) -> bool {
        particle.way < REST && particle.load < self.free
    }

    /// The two children of a particle, `direction` apart; none where they do not come to the surface.
    pub(crate) fn children(
        &self,
        ground: &mut Ground,
        parent: &Particle,
        direction: Vec3,
    ) -> Option<[Particle; 2]> {
        let step = direction * (0.5 * parent.radius);
        let places = [parent.position + step, parent.position - step];
        let landed = self.land(
            ground,
            places.map(|place| Particle { position: place, ..*parent }),
            TRUSTED_CORRECTION,
        );
        let is_good =
            |child: &Particle| self.bounds.contains(child.position) && child.normal.dot(parent.normal) > 0.0;
        landed.filter(|children| children.iter().all(is_good))
    }

    /// Particles brought onto the surface with their radii there; none if one does not come to it. A correction shorter than `trust`
    /// radii is not checked.
    pub(crate) fn land<const N: usize>(
        &self,
        ground: &mut Ground,
        particles: [Particle; N],
        trust: f32,
    ) -> Option<[Particle; N]> {
        const { assert!(N <= BATCH) };
        let mut landing = LandingBatch::new();
        landing.count = N;
        for (k, particle) in particles.iter().enumerate() {
            landing.position[k] = particle.position;
            landing.radius[k] = particle.radius;
            // Its curvature is asked for.
            landing.radius_travel[k] = f32::INFINITY;
        }
        landing.trust = trust;
        self.law().land(ground.field, ground.projector, &mut landing);
        landing.ok[..N].iter().all(|&ok| ok).then(|| {
            core::array::from_fn(|k| Particle::new(landing.position[k], landing.normal[k], landing.radius[k]))
        })
    }

    /// The particle on the surface to the last; as it is where rounding in single precision hides the surface: it has always been on it.
    pub(crate) fn landed(&self, ground: &mut Ground, particle: &Particle) -> Particle {
        match self.land(ground, [*particle], 0.0) {
            Some([landed]) if self.bounds.contains(landed.position) => landed,
            _ => *particle,
        }
    }
}
