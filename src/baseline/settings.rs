//! Settings of a baseline. The defaults are the values of Witkin and Heckbert 1994.

use crate::sampler::{Settings as Sizes, SettingsError};
use serde::Serialize;

/// Settings of a baseline.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Settings {
    /// Wanted sizes, as for the sampler. The sampling chooses the scheme:
    /// [`Uniform`](crate::sampler::Sampling::Uniform) is that of Witkin and Heckbert,
    /// [`Adaptive`](crate::sampler::Sampling::Adaptive) that of forces. A count stands for the radius with which so
    /// many particles cover the surface in perfect hexagons. The seed chooses the first particle and everything that is
    /// random, and the limit on particles applies. Settings of the front and the relaxation have no meaning here.
    pub sizes: Sizes,
    /// Largest number of iterations.
    pub max_iterations: u32,
    /// Number of consecutive iterations without fission, death and motion after which the particles count as settled.
    pub quiet_iterations: u32,
    /// Mean motion in an iteration, in radii, up to which particles count as not moving.
    pub rest: f64,
    /// Δt: time step of an iteration, for Witkin and Heckbert's scheme.
    pub time_step: f64,
    /// α: repulsion amplitude.
    pub amplitude: f64,
    /// Ê/α: wanted energy of a particle over the repulsion amplitude.
    pub wanted_energy: f64,
    /// ρ: feedback gain of the energy.
    pub energy_feedback: f64,
    /// φ: feedback gain of the distance from the surface.
    pub surface_feedback: f64,
    /// β: limits the growth of the radius of a lone particle, in units of 1 / (half the diameter of the surface).
    pub lone_growth: f64,
    /// γ: speed below which a particle is near equilibrium, in radii per unit of time. Only then does it divide or die.
    pub equilibrium_speed: f64,
    /// ν: share of the wanted energy above which a particle larger than the wanted radius divides.
    pub fission_energy: f64,
    /// Σ (overlap / mean radius)² below which a particle counts as free of forces and divides, for the scheme of
    /// forces. 0.01 is one overlap of a twentieth of the spacing. A larger value gives more particles: with 0.5, at
    /// which a lattice of the wanted spacing is hardly compressed, about a third more.
    pub free_load: f64,
    /// δ: share of the wanted radius below which a particle may die, or that its compression corresponds to.
    pub death_radius: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            sizes: Sizes::DEFAULT,
            max_iterations: 3_000,
            quiet_iterations: 20,
            rest: 0.005,
            time_step: 0.03,
            amplitude: 6.0,
            wanted_energy: 0.8,
            energy_feedback: 15.0,
            surface_feedback: 15.0,
            lone_growth: 10.0,
            equilibrium_speed: 4.0,
            fission_energy: 0.2,
            free_load: 0.01,
            death_radius: 0.7,
        }
    }
}

impl Settings {
    /// Ranges of the settings except the sizes: name, smallest and largest value.
    pub const RANGES: [(&'static str, f64, f64); 13] = [
        ("max_iterations", 1.0, 1e6),
        ("quiet_iterations", 1.0, 1e4),
        ("rest", 0.0, 1.0),
        // Above this, the feedback of energy and surface overshoots, and the closest pairs oscillate.
        ("time_step", 1e-4, 0.06),
        ("amplitude", 0.1, 10.0),
        ("wanted_energy", 0.1, 3.0),
        ("energy_feedback", 0.0, 16.0),
        ("surface_feedback", 0.0, 16.0),
        ("lone_growth", 1e-3, 1e3),
        ("equilibrium_speed", 1e-3, 1e3),
        ("fission_energy", 0.0, 1.0),
        ("free_load", 1e-6, 1.0),
        // Both children of a particle of the wanted radius have 0.707 of it: above this, they might die at once.
        ("death_radius", 0.0, 0.707),
    ];

    /// Checks every value against its range, including the sizes.
    ///
    /// # Errors
    ///
    /// The first setting found out of range.
    pub fn validate(&self) -> Result<(), SettingsError> {
        self.sizes.validate()?;
        let values = [
            f64::from(self.max_iterations),
            f64::from(self.quiet_iterations),
            self.rest,
            self.time_step,
            self.amplitude,
            self.wanted_energy,
            self.energy_feedback,
            self.surface_feedback,
            self.lone_growth,
            self.equilibrium_speed,
            self.fission_energy,
            self.free_load,
            self.death_radius,
        ];
        for ((name, min, max), value) in Self::RANGES.into_iter().zip(values) {
            if !(value >= min && value <= max) {
                return Err(SettingsError::OutOfRange { name, value, min, max });
            }
        }
        Ok(())
    }
}
