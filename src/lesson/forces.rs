//! Particles of many sizes: the "scheme based on forces" that the paper compares its non-uniform
//! sampling with (§6, Table 1).
//!
//! Discs whose radii follow the curvature push each other apart where they overlap, and "we split a
//! particle when no force is applied on it". "We used the same code for the relaxations of our
//! methods and for the comparative techniques (with the exception of the split criterion)": so
//! forces, step and return to the surface are those of `paper::relaxation`.
//!
//! # Differences from the paper
//!
//! * The paper mentions no death and does not say how the number of particles settles. Here a
//!   particle that is compressed at least as much as in a lattice with 0.7 of the wanted spacing
//!   dies with the same probability as in Witkin and Heckbert's system. This removes particles that
//!   were squeezed into the last gap.
//! * "No force" has a tolerance, [`FREE`]: discs that push each other apart never separate
//!   completely.
//! * Only particles at rest divide or die, as in Witkin and Heckbert's system.

use super::dynamics::Dynamics;
use super::log::Log;
use super::witkin_heckbert::{GAMMA, TIME_STEP};
use crate::paper::{Move, OVERLAP_REACH, OVERLAP_STEP, PaperRun, Particle, overlap};
use glam::DVec3;

/// A particle that moved by less than this, in radii, is at rest: γΔt of Witkin and Heckbert.
pub(super) const AT_REST: f64 = GAMMA * TIME_STEP;

/// Σ (overlap / mean radius)² below which a particle counts as free and divides: a single overlap
/// of 5 % of the spacing. Larger: more particles.
const FREE: f64 = 0.01;

/// Σ (overlap / mean radius)² above which a particle may die: that of six neighbours at 0.7 of the
/// spacing 2r.
const CROWDED: f64 = {
    let overlap = 2.0 * (OVERLAP_REACH - 0.7);
    6.0 * overlap * overlap
};

/// "Compute the energy", "compute the velocity": two discs that overlap push each other. A pair is
/// visited from the larger one.
pub(super) fn interact(
    dynamics: &mut [Dynamics],
    (i, own): (usize, &Particle),
    (j, other): (usize, &Particle),
) {
    let is_met_here = other.radius < own.radius || other.radius == own.radius && j < i;
    if !is_met_here {
        return;
    }
    let offset = own.p() - other.p();
    let (push, energy) = overlap(offset.length(), own.radius + other.radius);
    dynamics[i].force += offset * push;
    dynamics[j].force -= offset * push;
    dynamics[i].energy += energy;
    dynamics[j].energy += energy;
}

/// "Update the position": one relaxation step. Returns the force in the tangent plane, and the
/// move.
pub(super) fn step(run: &mut PaperRun<Log>, i: usize, dynamics: &Dynamics) -> (DVec3, Move) {
    let normal = run.particles[i].n();
    let force = dynamics.force - normal * normal.dot(dynamics.force);
    (force, run.move_particle(i, force * OVERLAP_STEP))
}

/// Whether a particle dies, given a random number in [0, 1).
pub(super) fn dies(dynamics: &Dynamics, chance: f64) -> bool {
    dynamics.is_at_rest && dynamics.energy > CROWDED && chance > CROWDED / dynamics.energy
}

/// Whether a particle divides.
pub(super) fn divides(dynamics: &Dynamics) -> bool {
    dynamics.is_at_rest && dynamics.energy < FREE
}
