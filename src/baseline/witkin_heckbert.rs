//! The particles of one size of A. P. Witkin and P. S. Heckbert, *Using Particles to Sample and Control Implicit
//! Surfaces* (SIGGRAPH 1994), §4: Gaussian repulsion, adaptive radii, fission and death.
//!
//! Particle i has the radius σᵢ, and E_ij = α exp(−|r_ij|²/2σᵢ²) is its energy due to particle j, where r_ij = p_i −
//! p_j. It moves with the velocity
//!
//! P_i = σᵢ² Σⱼ r_ij (E_ij/σᵢ² + E_ji/σⱼ²),
//!
//! of which the part along the surface is taken, less φ f ∇f/|∇f|² as feedback towards it. (Their equation 9 subtracts
//! the two terms as printed; the erratum adds them.) The radius changes so that the energy D_i = Σⱼ E_ij approaches Ê,
//!
//! σ̇ᵢ = −ρ (D_i − Ê) / (σᵢ⁻³ Σⱼ |r_ij|² E_ij + β).
//!
//! A particle near equilibrium, |ṗ| < γσ, divides into two of radius σ/√2 if σ > σ_max, or if D > νÊ and σ > σ̂. It
//! dies if σ < δσ̂ and a random number exceeds σ/(δσ̂).
//!
//! # Differs from the source
//!
//! * Energies are cut off at 3σ, where they are 1.1 % of α, so that a grid finds all neighbours.
//! * Particles whose normals are 90° or more apart do not repel each other: they are on opposite sides of a thin part.
//! * β has the unit of an inverse length. The unit here is d/2, and σ_max = d/2, where d is the diagonal of the box
//!   around the surface, √3 times the diameter of a sphere, and no less than 2σ̂.
//! * No particle moves farther than 0.35 σ in an iteration, and no radius changes by more than a factor of 2: with a
//!   finite Δt a pair that has just divided could leave the surface, or get negative radii.
//! * The children are placed σ/2 to either side of their parent in a random direction, on the surface.

use super::crowd::Particle;
use super::{Settings, SurfaceContext};
use crate::math::Bounds;
use crate::sampler::neighbours::constants::GAUSSIAN_RANGE;
use crate::sampler::projection::{BATCH, Descent, Tolerance};
use crate::sampler::relaxation::repulsion::gaussian;
use crate::sampler::relaxation::repulsion::{MAX_MOVE, TRUSTED_CORRECTION};
use crate::spatial::Neighbour;
use core::ops::Range;
use glam::{Vec3, Vec4};

/// Largest factor by which a radius changes in an iteration.
const MAX_GROWTH: f32 = 2.0;
/// Smallest radius over the wanted one. A particle as small as that dies with a probability of 13/14.
const LEAST: f32 = 0.05;
/// A particle that does not come onto the surface at the end stays if its distance is below this share of its radius.
const BESIDE: f32 = 0.02;
/// Largest number of evaluations to bring a particle onto the surface.
const MAX_NEWTON: u32 = 8;

/// The scheme, with the constants of a run in the field's units.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WitkinHeckbert {
    pub(crate) tolerance: Tolerance,
    pub(crate) bounds: Bounds,
    /// σ̂ and σ_max.
    pub(crate) wanted: f32,
    pub(crate) largest: f32,
    amplitude: f32,
    wanted_energy: f32,
    rho: f32,
    phi: f32,
    beta: f32,
    gamma: f32,
    fission_energy: f32,
    death_radius: f32,
    time_step: f32,
}

impl WitkinHeckbert {
    /// Returns the scheme for particles of the radius `wanted` on a surface of this diameter, which must not be below
    /// theirs.
    pub(crate) fn new(
        settings: &Settings,
        tolerance: Tolerance,
        bounds: &Bounds,
        wanted: f32,
        diameter: f32,
    ) -> Self {
        let wanted_energy = (settings.wanted_energy * settings.amplitude) as f32;
        Self {
            tolerance,
            bounds: *bounds,
            wanted,
            largest: 0.5 * diameter,
            amplitude: settings.amplitude as f32,
            wanted_energy,
            rho: settings.energy_feedback as f32,
            phi: settings.surface_feedback as f32,
            beta: settings.lone_growth as f32 / (0.5 * diameter),
            gamma: settings.equilibrium_speed as f32,
            fission_energy: settings.fission_energy as f32 * wanted_energy,
            death_radius: settings.death_radius as f32 * wanted,
            time_step: settings.time_step as f32,
        }
    }

    /// Returns the range of the energy of a particle of this radius.
    pub(crate) fn reach(radius: f32) -> f32 {
        GAUSSIAN_RANGE * radius
    }

    /// Adds the energies E_ij of particle `i` due to its neighbours, and their contributions to the velocities of both.
    /// Each pair is visited twice, once with the radius of either particle.
    pub(crate) fn repel(&self, particles: &mut [Particle], i: usize, near: &[Neighbour]) {
        let Particle { normal, radius, .. } = particles[i];
        let inverse_sq = 1.0 / (radius * radius);
        let (mut force, mut load, mut moment) = (Vec3::ZERO, 0.0, 0.0);
        for four in near.chunks(4) {
            // Lanes beyond the end are not read.
            let mut distance_sq = [0.0; 4];
            for (lane, other) in distance_sq.iter_mut().zip(four) {
                *lane = other.distance_sq;
            }
            // The polynomial is valid up to the cut-off, which the search may exceed by rounding.
            let most = 0.5 * GAUSSIAN_RANGE * GAUSSIAN_RANGE;
            let half_sq = (Vec4::from_array(distance_sq) * (0.5 * inverse_sq)).min(Vec4::splat(most));
            let energy = (gaussian(half_sq) * self.amplitude).to_array();
            for (other, energy) in four.iter().zip(energy) {
                let j = other.index as usize;
                if j == i || normal.dot(particles[j].normal) <= 0.0 {
                    continue;
                }
                let push = other.offset * (energy * inverse_sq);
                force -= push;
                particles[j].force += push;
                load += energy;
                moment += other.distance_sq * energy;
            }
        }
        let particle = &mut particles[i];
        particle.force += force;
        particle.load = load;
        particle.moment = moment;
    }

    /// Returns ṗ of a particle whose forces are summed: the part along the surface, and the feedback towards it.
    pub(crate) fn velocity(&self, particle: &Particle) -> Vec3 {
        let free = particle.force * (particle.radius * particle.radius);
        let normal = particle.normal;
        free - normal * (normal.dot(free) + self.phi * particle.height)
    }

    /// Returns σ̇ of a particle whose energies are summed.
    pub(crate) fn growth(&self, particle: &Particle) -> f32 {
        let radius = particle.radius;
        let stretch = particle.moment / (radius * radius * radius);
        self.rho * (self.wanted_energy - particle.load) / (stretch + self.beta)
    }

    /// Moves particles by one time step and changes their radii.
    pub(crate) fn advance(
        &self,
        surface: &mut SurfaceContext,
        particles: &mut [Particle],
        range: Range<usize>,
    ) {
        let mut position = [Vec3::ZERO; BATCH];
        let n = range.len();
        for (position, particle) in position.iter_mut().zip(&mut particles[range.clone()]) {
            let radius = particle.radius;
            let velocity = self.velocity(particle);
            let growth = self.growth(particle) * self.time_step;
            *position = particle.position + (velocity * self.time_step).clamp_length_max(MAX_MOVE * radius);
            particle.speed = velocity.length() / radius;
            particle.moved = 0.0;
            particle.radius = (radius + growth)
                .max(radius / MAX_GROWTH)
                .min(radius * MAX_GROWTH)
                .clamp(LEAST * self.wanted, self.largest);
        }
        let (value, gradient) = surface.projector.evaluate_batch(surface.field, &position[..n]);
        for (k, particle) in particles[range].iter_mut().enumerate() {
            let slope = gradient[k].length();
            let (height, normal) = (value[k] / slope, gradient[k] / slope);
            // A particle stays where it is if it cannot go: at the border of the box, where the field ends, at a fold.
            if self.tolerance.is_slope(slope)
                && height.is_finite()
                && self.bounds.contains(position[k])
                && normal.dot(particle.normal) > 0.0
            {
                particle.moved = (position[k] - particle.position).length() / particle.radius;
                particle.position = position[k];
                particle.normal = normal;
                particle.height = height;
            }
        }
    }

    fn is_near_equilibrium(&self, particle: &Particle) -> bool {
        particle.speed < self.gamma
    }

    /// Returns whether the particle dies, given a random number in [0, 1).
    pub(crate) fn dies(&self, particle: &Particle, random: f32) -> bool {
        self.is_near_equilibrium(particle)
            && particle.radius < self.death_radius
            && random > particle.radius / self.death_radius
    }

    /// Returns whether the particle divides.
    pub(crate) fn divides(&self, particle: &Particle) -> bool {
        let is_large = particle.load > self.fission_energy && particle.radius > self.wanted;
        self.is_near_equilibrium(particle) && (particle.radius >= self.largest || is_large)
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
        let mut position = [parent.position + step, parent.position - step];
        let (mut normal, mut ok) = ([Vec3::ZERO; 2], [false; 2]);
        self.land(surface, &mut position, &mut normal, &mut ok, (parent.radius, TRUSTED_CORRECTION));
        let is_good =
            (0..2).all(|k| ok[k] && self.bounds.contains(position[k]) && normal[k].dot(parent.normal) > 0.0);
        let radius = parent.radius * core::f32::consts::FRAC_1_SQRT_2;
        is_good.then(|| [0, 1].map(|k| Particle::new(position[k], normal[k], radius)))
    }

    /// Returns the particle on the surface; `None` if it is far from it. Where rounding hides the surface it stays as
    /// it is.
    pub(crate) fn landed(&self, surface: &mut SurfaceContext, particle: &Particle) -> Option<Particle> {
        let (mut position, mut normal, mut ok) = ([particle.position], [Vec3::ZERO], [false]);
        self.land(surface, &mut position, &mut normal, &mut ok, (particle.radius, 0.0));
        if ok[0] && self.bounds.contains(position[0]) {
            Some(Particle::new(position[0], normal[0], particle.radius))
        } else {
            (particle.height.abs() < BESIDE * particle.radius).then_some(*particle)
        }
    }

    /// Moves positions onto the surface, if that is within `radius`. A Newton correction shorter than `trust` radii is
    /// not checked.
    fn land(
        &self,
        surface: &mut SurfaceContext,
        position: &mut [Vec3],
        normal: &mut [Vec3],
        ok: &mut [bool],
        (radius, trust): (f32, f32),
    ) {
        let residual = self.tolerance.residual;
        let mut descent = Descent { residual, reach: radius, trust: trust * radius };
        let least = self.tolerance.min_gradient;
        surface.projector.land_along_gradient(
            surface.field,
            position,
            normal,
            ok,
            least,
            &mut descent,
            MAX_NEWTON,
        );
    }
}
