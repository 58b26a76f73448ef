//! The dynamics of a particle in a relaxation step or an iteration of a particle system.

use glam::DVec3;

/// Sums of force and energy over the neighbours of a particle.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Dynamics {
    /// Sum of the repulsion.
    pub(super) force: DVec3,
    /// Energy, a measure of compression: D_i of Witkin and Heckbert, or Σ (overlap / mean radius)².
    pub(super) energy: f64,
    /// Σ |r_ij|² E_ij, from which follows how D_i changes with σ_i.
    pub(super) moment: f64,
    /// Whether the particle is near equilibrium.
    pub(super) is_at_rest: bool,
    /// Distance that the particle has moved, in radii.
    pub(super) moved: f64,
    /// Whether the particle dies at the end of the iteration.
    pub(super) dies: bool,
}

/// Longest move of the particles, in radii.
pub(super) fn largest_move(dynamics: &[Dynamics]) -> f64 {
    dynamics.iter().fold(0.0, |most, own| own.moved.max(most))
}
