//! Particles of one size: A. P. Witkin and P. S. Heckbert, *Using Particles to Sample and Control
//! Implicit Surfaces* (SIGGRAPH 1994), §4. The paper compares its uniform sampling with this system
//! (Table 1).
//!
//! The symbols are those of the source: σ is the radius of a particle, σ̂ the wanted radius, and
//! r_ij = p_i − p_j.
//!
//! # Differences from the source
//!
//! * Energies are cut off at 3σ, where they are 1.1 % of α.
//! * β has the unit of an inverse length. The unit of length is d/2, where d is the diagonal of the
//!   box around the surface. σ_max = d/2, but at least 2σ̂.
//! * In an iteration no particle moves farther than 0.35 σ, and no radius changes by more than a
//!   factor of 2. The time step is not small: without these limits a pair that has just divided
//!   could leave the surface or get negative radii.
//! * The source samples closed surfaces. A particle that would leave the box stays and counts as
//!   near equilibrium. At the border it has neighbours on one side only, so it divides more often,
//!   and an open surface gets more particles than a front places.

use super::course::Setup;
use super::dynamics::Dynamics;
use crate::field::Jet;
use crate::paper::{ImplicitSurface, MAX_MOVE, Move, Particle};
use glam::DVec3;

// The values of the source.
/// Δt: time step.
pub(super) const TIME_STEP: f64 = 0.03;
/// α: repulsion amplitude.
const ALPHA: f64 = 6.0;
/// Ê: wanted energy.
const WANTED_ENERGY: f64 = 0.8 * ALPHA;
/// ρ: feedback of the energy.
const RHO: f64 = 15.0;
/// φ: feedback of the distance from the surface.
const PHI: f64 = 15.0;
/// β: keeps the growth of a lone particle finite, in 1 / (d/2).
const BETA: f64 = 10.0;
/// γ: a particle slower than this, in σ per unit of time, is near equilibrium.
pub(super) const GAMMA: f64 = 4.0;
/// ν: share of the wanted energy above which a large particle divides.
const NU: f64 = 0.2;
/// δ: share of σ̂ below which a particle may die.
const DELTA: f64 = 0.7;

/// Largest factor by which a radius changes in an iteration, as by two fissions.
const MAX_GROWTH: f64 = 2.0;
/// Smallest σ, in σ̂; a particle of this size dies with a probability of 13/14.
const LEAST: f64 = 0.05;

/// The wanted radius σ̂.
pub(super) fn wanted(setup: &Setup) -> f64 {
    setup.settings.radius
}

/// The largest radius σ_max, which is d/2.
fn largest(setup: &Setup) -> f64 {
    match setup.settings.radius_max {
        0.0 => (0.5 * setup.diameter).max(wanted(setup)),
        given => given,
    }
}

/// "Compute the energy of the set of particles": E_ij = α exp(−|r_ij|²/2σ_i²), the energy of
/// particle i due to j, and its contribution to the velocities of both.
///
/// D_i = Σⱼ E_ij, and P_i = σ_i² Σⱼ r_ij (E_ij/σ_i² + E_ji/σ_j²). Equation 9 of the source
/// subtracts the two terms as printed; its erratum adds them. Every pair is visited from both
/// sides, each with its own σ.
pub(super) fn interact(
    dynamics: &mut [Dynamics],
    (i, own): (usize, &Particle),
    (j, other): (usize, &Particle),
) {
    let offset = own.p() - other.p();
    let sigma_sq = own.radius * own.radius;
    let energy = ALPHA * libm::exp(-offset.length_squared() / (2.0 * sigma_sq));
    dynamics[i].energy += energy;
    dynamics[i].moment += offset.length_squared() * energy;
    dynamics[i].force += offset * (energy / sigma_sq);
    dynamics[j].force -= offset * (energy / sigma_sq);
}

/// "Compute the repulsion radius", "update the position": one time step.
///
/// σ̇ = −ρ (D − Ê) / (σ⁻³ Σⱼ |r_ij|² E_ij + β) brings D to Ê. ṗ is the part of P along the surface
/// minus φ f ∇f/|∇f|², which leads back to the surface. Returns P, and the move.
pub(super) fn step(
    surface: &mut ImplicitSurface,
    setup: &Setup,
    own: &mut Particle,
    dynamics: &mut Dynamics,
) -> (DVec3, Move) {
    let sigma = own.radius;
    let normal = own.n();
    let force = dynamics.force * (sigma * sigma);
    let velocity = force - normal * (normal.dot(force) + PHI * own.height);

    let stretch = dynamics.moment / (sigma * sigma * sigma);
    let growth = RHO * (WANTED_ENERGY - dynamics.energy) / (stretch + BETA / largest(setup));
    // The radius changes even if the particle cannot move.
    own.radius = (sigma + growth * TIME_STEP)
        .max(sigma / MAX_GROWTH)
        .min(sigma * MAX_GROWTH)
        .clamp(LEAST * wanted(setup), largest(setup));

    let target = own.p() + (velocity * TIME_STEP).clamp_length_max(MAX_MOVE * sigma);
    let Jet { value, gradient, .. } = surface.jet(target);
    let slope = gradient.length();
    let (height, there) = (value / slope, gradient / slope);
    let can_go = height.is_finite() && surface.bounds.holds(target) && there.dot(normal) > 0.0;
    dynamics.is_at_rest = !can_go || velocity.length() < GAMMA * sigma;
    if can_go {
        (own.position, own.normal, own.height) = (target.to_array(), there.to_array(), height);
    }
    (force, Move { target, is_kept: !can_go })
}

/// Whether a particle dies: near equilibrium, σ < δσ̂, and a random number above σ/(δσ̂).
pub(super) fn dies(setup: &Setup, own: &Particle, dynamics: &Dynamics, chance: f64) -> bool {
    let share = own.radius / (DELTA * wanted(setup));
    dynamics.is_at_rest && share < 1.0 && chance > share
}

/// Whether a particle divides: near equilibrium, and either σ ≥ σ_max, or D > νÊ and σ > σ̂.
pub(super) fn divides(setup: &Setup, own: &Particle, dynamics: &Dynamics) -> bool {
    let is_large = dynamics.energy > NU * WANTED_ENERGY && own.radius > wanted(setup);
    dynamics.is_at_rest && (own.radius >= largest(setup) || is_large)
}
