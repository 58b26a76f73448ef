//! What a caller may choose, with the paper's values as defaults.

use crate::math::Bounds;
use crate::math::shortest_text;
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

/// How the particles are brought onto the surface and into order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// A front of the wanted radius, and relaxation (paper §4 and §5).
    #[default]
    Front,
    /// A coarse front, brought into order and refined. Where that cannot be done, the front stands.
    Refined,
}

/// Whether all particles have one size.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Sampling {
    /// One radius everywhere (paper §4).
    #[default]
    Uniform,
    /// The radius follows the curvature (paper §5).
    Adaptive,
}

/// How the radius of an adaptive particle follows from the principal curvatures κ₁ and κ₂.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LawKind {
    /// Every triangle of neighbours stays within [`Settings::chord_error`] of the surface.
    #[default]
    ChordError,
    /// [`Settings::curvature_scale`] / max(|κ₁|, |κ₂|).
    MaxCurvature,
    /// [`Settings::curvature_scale`] / |κ₁ + κ₂|, the paper's choice (§5).
    SumOfCurvatures,
}

/// How a child of an adaptive particle is placed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Placement {
    /// The equations of tangency are solved.
    #[default]
    Direct,
    /// The child is pushed step by step until it touches, as in the paper (§5).
    Faithful,
}

/// Settings of a run. `Default` gives the paper's values where it names them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// How the particles are brought onto the surface and into order.
    pub method: Method,
    /// Whether all particles have one size.
    pub sampling: Sampling,
    /// Whether the radius or the wanted count decides the size. With adaptive sampling the count scales all radii by one
    /// factor.
    pub size_mode: SizeMode,
    /// Repulsion radius of uniform sampling as a share of the box diagonal (paper §6: 2 % and 0.6 %).
    pub radius_share: f64,
    /// How the radius of adaptive sampling follows from the curvature.
    pub radius_law: LawKind,
    /// Largest gap between the surface and a triangle of neighbours, as a share of the box diagonal, for
    /// [`LawKind::ChordError`].
    pub chord_error: f64,
    /// Repulsion radius times curvature, for the other two laws: half the angle between the normals of neighbours.
    pub curvature_scale: f64,
    /// Smallest radius of adaptive sampling, as a share of the box diagonal.
    pub radius_min_share: f64,
    /// Largest radius of adaptive sampling, as a share of the box diagonal.
    pub radius_max_share: f64,
    /// Lipschitz slope L of the radius: |r(x) − r(y)| ≤ L |x − y|, so that the radii of neighbours that touch differ by
    /// the factor (1 + L)/(1 − L) at most.
    pub grading: f64,
    /// How children are placed by adaptive sampling.
    pub placement: Placement,
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
        Self::DEFAULT
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
    /// The clip box is not [valid](Bounds::is_valid).
    #[error("the box {}", Bounds::REQUIREMENT)]
    Box,
    /// The columns of that many particles do not fit into the memory.
    #[error("there is not enough memory for about {particles} particles: choose fewer, or a larger radius")]
    Memory {
        /// Particles to expect.
        particles: u64,
    },
}

fn out_of_range(name: &str, value: &f64, min: &f64, max: &f64, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let [value, min, max] = [*value, *min, *max].map(shortest_text);
    write!(f, "{name} is {value}, but must lie between {min} and {max}")
}

impl Settings {
    /// The values that `Default` gives.
    pub const DEFAULT: Self = Self {
        method: Method::Front,
        sampling: Sampling::Uniform,
        size_mode: SizeMode::Radius,
        radius_share: 0.006,
        radius_law: LawKind::ChordError,
        // With this the ellipsoid of the gallery takes about 16,000 particles, the sphere 13,000.
        chord_error: 4.5e-5,
        curvature_scale: 0.015,
        radius_min_share: 0.001,
        radius_max_share: 0.03,
        grading: 0.2,
        placement: Placement::Direct,
        count: 20_000,
        relax_steps: 10,
        match_tolerance: 0.7,
        gaps: GapPolicy::Fill,
        seed: 0,
        max_particles: 200_000,
    };

    /// Ranges of the numeric settings: name, smallest and largest value.
    pub const RANGES: [(&'static str, f64, f64); 10] = [
        ("radius_share", 1e-4, 0.2),
        ("chord_error", 1e-7, 0.01),
        ("curvature_scale", 1e-3, 0.5),
        ("radius_min_share", 1e-4, 0.2),
        ("radius_max_share", 1e-4, 0.2),
        ("grading", 0.01, 0.5),
        ("count", 1.0, 4e6),
        ("relax_steps", 0.0, 1000.0),
        ("match_tolerance", 0.5, 0.9),
        ("max_particles", 1.0, 4e6),
    ];

    /// Checks every value against its range, and that the smallest radius is not above the largest.
    ///
    /// # Errors
    ///
    /// The first setting found out of range.
    pub fn validate(&self) -> Result<(), SettingsError> {
        let values = [
            self.radius_share,
            self.chord_error,
            self.curvature_scale,
            self.radius_min_share,
            self.radius_max_share,
            self.grading,
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
        if self.radius_min_share > self.radius_max_share {
            let (min, max) = (Self::RANGES[3].1, self.radius_max_share);
            let (name, value) = ("radius_min_share", self.radius_min_share);
            return Err(SettingsError::OutOfRange { name, value, min, max });
        }
        Ok(())
    }
}
