//! Relaxation. In uniform sampling (§4.5): the repulsion of Witkin and Heckbert 1994, §4, without
//! fission, death and adaptive radii. In non-uniform sampling (§5.4): forces between overlapping
//! discs.

use super::{Buckets, Observer, PaperRun, Particle, RadiusRule};
use glam::DVec3;

/// The repulsion of a particle by one neighbour.
pub(crate) struct Push {
    /// Repulsion by that particle, along the offset between the two.
    force: DVec3,
    /// Energy of the pair.
    pub(crate) energy: f64,
}

/// Result of moving a particle.
pub(crate) struct Move {
    /// Target of the move.
    pub(crate) target: DVec3,
    /// Whether the particle kept its place, because the move leads out of the box, off the surface
    /// or around a fold.
    pub(crate) is_kept: bool,
}

/// Particles of one size repel each other up to this distance, in σ, where the energy exp(−d²/2σ²)
/// is 1 % of that at 0.
pub(crate) const GAUSSIAN_REACH: f64 = 3.0;

/// Discs of varying sizes push each other up to this distance, in r_i + r_j: discs that barely
/// touch would not push into gaps. With less or more, holes are wider.
pub(crate) const OVERLAP_REACH: f64 = 1.15;

/// Largest move of a particle in a step, in radii, well below the distance 2 to its neighbours.
pub(crate) const MAX_MOVE: f64 = 0.35;

/// Weight of a pair by the cosine between its normals: 1 on one sheet, 0 on two sheets that face
/// away from each other.
fn same_sheet_weight(cosine: f64) -> f64 {
    (0.5 + cosine).clamp(0.0, 1.0)
}

/// Force over offset, and energy, of a pair of particles of one radius: E = exp(−d²/2σ²) with σ =
/// r, and each particle moves along the offset times E. The energy is cut off at 3σ and shifted to
/// zero there.
fn gaussian(distance: f64, sigma: f64) -> (f64, f64) {
    let share = distance / sigma;
    let energy = libm::exp(-0.5 * share * share);
    (energy, energy - libm::exp(-0.5 * GAUSSIAN_REACH * GAUSSIAN_REACH))
}

/// Force over offset, and energy, of two discs whose radii add up to `both`: they push each other
/// apart by their overlap. The paper gives no formula.
pub(crate) fn overlap(distance: f64, both: f64) -> (f64, f64) {
    let overlap = (OVERLAP_REACH * both - distance).max(0.0);
    let share = 2.0 * overlap / both;
    // Two particles at one position have no direction to move apart in.
    (if distance > 0.0 { overlap / distance } else { 0.0 }, share * share)
}

impl<O: Observer> PaperRun<O> {
    /// A relaxation step: all forces, then all moves.
    pub fn relax(&mut self) {
        self.regroup();
        let forces: Vec<DVec3> = (0..self.particles.len()).map(|i| self.force(i as u32)).collect();
        for (particle, force) in forces.into_iter().enumerate() {
            self.move_particle(particle, force * self.rules.step_size);
        }
    }

    /// Rebuilds the buckets, because particles may have moved.
    pub(crate) fn regroup(&mut self) {
        self.buckets = Buckets::new(2.0 * self.rules.sizes.largest(), &self.particles);
    }

    /// The force on a particle, in its tangent plane.
    pub(crate) fn force(&self, particle: u32) -> DVec3 {
        let force: DVec3 = self.pushes(particle).map(|push| push.force).sum();
        let normal = self.particles[particle as usize].n();
        force - normal * normal.dot(force)
    }

    /// The repulsion of a particle by each of its neighbours.
    ///
    /// # Differs from the paper
    ///
    /// Pairs on two different sheets are ignored.
    pub(crate) fn pushes(&self, particle: u32) -> impl Iterator<Item = Push> {
        let own = &self.particles[particle as usize];
        let sizes = self.rules.sizes;
        let reach = match sizes {
            RadiusRule::Same(_) => GAUSSIAN_REACH * own.radius,
            RadiusRule::ByCurvature { most, .. } => OVERLAP_REACH * (own.radius + most),
        };
        let around = self.buckets.near(&self.particles, own.p(), reach).into_iter();
        around.filter(move |near| near.particle != particle).map(move |near| {
            let other = &self.particles[near.particle as usize];
            let (push, pair) = match sizes {
                RadiusRule::Same(_) => gaussian(near.distance, own.radius),
                RadiusRule::ByCurvature { .. } => overlap(near.distance, own.radius + other.radius),
            };
            let weight = same_sheet_weight(own.n().dot(other.n()));
            let force = (own.p() - other.p()) * (weight * push);
            Push { force, energy: weight * pair }
        })
    }

    /// Moves a particle in its tangent plane and brings it back onto the surface.
    pub(crate) fn move_particle(&mut self, particle: usize, way: DVec3) -> Move {
        let own = self.particles[particle];
        let reach = MAX_MOVE * own.radius;
        let target = own.p() + way.clamp_length_max(reach);
        let landed = self.come_back(&own, target, reach);
        if let Some((position, normal)) = landed {
            let radius = self.radius_at(position).unwrap_or(own.radius);
            let (position, normal) = (position.to_array(), normal.to_array());
            self.particles[particle] = Particle { position, normal, radius, ..own };
        }
        Move { target, is_kept: landed.is_none() }
    }
}
