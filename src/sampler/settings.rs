//! What a caller may choose, with the paper's values as defaults.

use crate::math::decimal::text;
use core::fmt;
use serde::{Deserialize, Serialize};

/// How the particles' size is given.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SizeMode {
    /// By [`Settings::radius_share`].
    #[default]
    Radius,
    /// By [`Settings::count`].
    Count,
}

/// What becomes of gaps between fronts that are wide enough for a particle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GapPolicy {
    /// A particle is placed in the middle.
    #[default]
    Fill,
    /// They stay, as in the paper.
    Leave,
}

/// Settings of a run. `Default` gives the paper's values where it names them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// Whether the radius or the wanted count decides the size.
    pub size_mode: SizeMode,
    /// Repulsion radius as a share of the box diagonal (paper §6: 2 % and 0.6 %).
    pub radius_share: f64,
    /// Wanted number of particles, met within 3 %.
    pub count: u32,
    /// Relaxation steps after the generation (paper §4.5: ten).
    pub relax_steps: u32,
    /// Distance within which a child corresponds to an existing particle, as a share of 2r. The paper names none; 0.7
    /// gives the most particles with six neighbours on smooth surfaces.
    pub match_tolerance: f64,
    /// Whether gaps between fronts are filled after the generation.
    pub gaps: GapPolicy,
    /// Chooses the first point among those found on the surface.
    pub seed: u64,
    /// Most particles generated; a run that reaches it stops with what it has. A wanted count up to it may be missed
    /// upwards like any other.
    pub max_particles: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            size_mode: SizeMode::Radius,
            radius_share: 0.006,
            count: 20_000,
            relax_steps: 10,
            match_tolerance: 0.7,
            gaps: GapPolicy::Fill,
            seed: 0,
            max_particles: 200_000,
        }
    }
}

/// A setting out of its range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SettingsError {
    /// The value is not a number within the range.
    #[error(fmt = out_of_range)]
    OutOfRange {
        /// Name of the setting.
        name: &'static str,
        /// The value given.
        value: f64,
        /// Smallest value allowed.
        min: f64,
        /// Largest value allowed.
        max: f64,
    },
    /// The clip box has no volume or a corner that is not a number.
    #[error("the box must have finite corners and a positive size on every axis")]
    Box,
    /// The columns of that many particles do not fit into the memory.
    #[error("there is not enough memory for about {particles} particles: choose fewer, or a larger radius")]
    Memory {
        /// Particles to expect.
        particles: u64,
    },
}

fn out_of_range(name: &str, value: &f64, min: &f64, max: &f64, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    write!(f, "{name} is {}, but must lie between {} and {}", text(*value), text(*min), text(*max))
}

impl Settings {
    /// Ranges of the numeric settings: name, smallest and largest value.
    pub const RANGES: [(&'static str, f64, f64); 5] = [
        ("radius_share", 1e-4, 0.2),
        ("count", 1.0, 4e6),
        ("relax_steps", 0.0, 1000.0),
        ("match_tolerance", 0.5, 0.9),
        ("max_particles", 1.0, 4e6),
    ];

    /// Checks every value against its range.
    ///
    /// # Errors
    ///
    /// The first setting found out of range.
    pub fn validate(&self) -> Result<(), SettingsError> {
        let values = [
            self.radius_share,
            f64::from(self.count),
            f64::from(self.relax_steps),
            self.match_tolerance,
            f64::from(self.max_particles),
        ];
        for ((name, min, max), value) in Self::RANGES.into_iter().zip(values) {
            if !(value >= min && value <= max) {
                return Err(SettingsError::OutOfRange { name, value, min, max });
            }
        }
        Ok(())
    }
}
