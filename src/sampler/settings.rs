//! What a caller may choose, with the paper's values as defaults.
//!
//! A setting is one entry of the table below. From it follow its field in [`Settings`], the default, the check, the reader of
//! requests and links, the control of the page, the option of the command line and the row in the README.

use super::setting::{Choice, Condition, Group, Scale, Setting, Value, choices};
use crate::math::{Bounds, shortest_text};
use core::fmt;
use core::ops::RangeInclusive;
use serde::{Deserialize, Serialize};

choices! {
    /// Whether all particles have one size.
    Sampling {
        /// One radius everywhere (paper §4).
        Uniform "uniform" "Uniform",
        /// The radius follows the curvature (paper §5).
        Adaptive "adaptive" "Adaptive",
    }
}

choices! {
    /// How the particles' size is given.
    SizeMode {
        /// By [`Settings::radius_share`].
        Radius "radius" "Radius",
        /// By [`Settings::count`].
        Count "count" "Count",
    }
}

choices! {
    /// How the radius of an adaptive particle follows from the principal curvatures κ₁ and κ₂.
    LawKind {
        /// Every triangle of neighbours stays within [`Settings::chord_error`] of the surface.
        ChordError "chord_error" "Chord error",
        /// [`Settings::curvature_scale`] / max(|κ₁|, |κ₂|).
        MaxCurvature "max_curvature" "Largest curvature",
        /// [`Settings::curvature_scale`] / |κ₁ + κ₂|, the paper's choice (§5).
        SumOfCurvatures "sum_of_curvatures" "Sum of curvatures",
    }
}

choices! {
    /// How the particles are brought onto the surface and into order.
    Method {
        /// A front of the wanted radius, and relaxation (paper §4 and §5).
        Front "front" "Front",
        /// A coarse front, brought into order and refined. Where that cannot be done, the front stands.
        Refined "refined" "Refined",
    }
}

choices! {
    /// Which box the surface of a formula is sampled in.
    BoxMode {
        /// One that fits it, where none is given. A surface of the gallery keeps its own.
        Fit "fit" "Fit",
        /// The one that is given, or that of the surface with which the formula began.
        Fixed "fixed" "Fixed",
    }
}

choices! {
    /// What becomes of gaps between fronts that are wide enough for a particle.
    GapPolicy {
        /// A particle is placed in the middle.
        Fill "fill" "Fill",
        /// They stay, as in the paper.
        Leave "leave" "Leave",
    }
}

/// Makes [`Settings`], its defaults and its table from the entries.
macro_rules! settings {
    ($($name:ident: $type:ty = $default:expr => {
        label: $label:literal, help: $help:literal, $($field:ident: $value:expr,)*
    })*) => {
        /// Settings of a run. `Default` gives the paper's values where it names them.
        #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(default)]
        pub struct Settings {
            $(#[doc = $help] pub $name: $type,)*
        }

        impl Settings {
            /// The values that `Default` gives.
            pub const DEFAULT: Self = Self { $($name: $default,)* };

            /// Every setting, in the order in which they are shown.
            #[must_use]
            pub fn table() -> Vec<Setting> {
                const ENTRIES: &[Setting] = &[$(Setting {
                    name: stringify!($name),
                    label: $label,
                    help: $help,
                    $($field: $value,)*
                    ..Setting::COMMON
                }),*];
                let with_default = |(entry, default): (&Setting, Value)| Setting { default, kind: default.kind(), ..*entry };
                ENTRIES.iter().zip(Self::DEFAULT.values()).map(with_default).collect()
            }

            /// The values, in the order of [`Settings::table`].
            #[must_use]
            pub fn values(&self) -> Vec<Value> {
                vec![$(self.$name.into()),*]
            }
        }
    };
}

const fn when(name: &'static str, value: &'static str) -> Condition {
    Condition { name, value, equal: true }
}

const UNIFORM: Condition = when("sampling", "uniform");
const ADAPTIVE: Condition = when("sampling", "adaptive");

settings! {
    // It acts before a run, in `session`: a sampler has the box that it is given.
    box_mode: BoxMode = BoxMode::Fit => {
        label: "Box",
        help: "Fit: around the surface of a formula, with 5 % to spare; what goes on for ever is cut. Fixed: as it is.",
        choices: BoxMode::CHOICES,
        option: Some("box"),
    }
    sampling: Sampling = Sampling::Uniform => {
        label: "Sampling",
        help: "One size everywhere, or sizes that follow the curvature: small particles where the surface bends, large ones where it is flat.",
        choices: Sampling::CHOICES,
        option: Some("adaptive"),
    }
    size_mode: SizeMode = SizeMode::Radius => {
        label: "Size by",
        help: "Give the size of the particles (or, for adaptive sampling, its law), or how many there should be.",
        choices: SizeMode::CHOICES,
        option: Some("count"),
    }
    radius_share: f64 = 0.006 => {
        label: "Radius",
        help: "Repulsion radius r as a share of the box diagonal; neighbours sit 2r apart. The paper shows 2 % and 0.6 %.",
        min: 1e-4,
        max: 0.2,
        step: 0.01,
        scale: Scale::Log,
        unit: "%",
        when: &[UNIFORM, when("size_mode", "radius")],
        option: Some("radius"),
    }
    count: u32 = 20_000 => {
        label: "Count",
        help: "Wanted number of particles, met within 3 %. Adaptive sampling scales all radii by one factor.",
        min: 1.0,
        max: MOST_PARTICLES,
        step: 0.01,
        scale: Scale::Log,
        unit: "particles",
        when: &[when("size_mode", "count")],
    }
    radius_law: LawKind = LawKind::ChordError => {
        label: "Radius law",
        help: "How the radius follows from the principal curvatures. The paper takes their sum, which vanishes on saddles.",
        choices: LawKind::CHOICES,
        when: &[ADAPTIVE],
        option: Some("law"),
    }
    // With this the ellipsoid of the gallery takes about 16,000 particles, the sphere 13,000.
    chord_error: f64 = 4.5e-5 => {
        label: "Chord error",
        help: "Largest gap between the surface and a triangle of neighbours, as a share of the box diagonal.",
        min: 1e-7,
        max: 0.01,
        step: 0.01,
        scale: Scale::Log,
        unit: "%",
        when: &[ADAPTIVE, when("radius_law", "chord_error")],
    }
    curvature_scale: f64 = 0.015 => {
        label: "Curvature scale",
        help: "Radius of a particle over the radius of curvature under it: half the angle between the normals of neighbours.",
        min: 1e-3,
        max: 0.5,
        step: 0.01,
        scale: Scale::Log,
        unit: "× 1/κ",
        when: &[ADAPTIVE, Condition { equal: false, ..when("radius_law", "chord_error") }],
    }
    radius_min_share: f64 = 0.001 => {
        label: "Smallest radius",
        help: "No particle is smaller than this share of the box diagonal.",
        group: Group::Advanced,
        min: 1e-4,
        max: 0.2,
        step: 0.01,
        scale: Scale::Log,
        unit: "%",
        when: &[ADAPTIVE],
        option: Some("radius-min"),
    }
    radius_max_share: f64 = 0.03 => {
        label: "Largest radius",
        help: "No particle is larger than this share of the box diagonal.",
        group: Group::Advanced,
        min: 1e-4,
        max: 0.2,
        step: 0.01,
        scale: Scale::Log,
        unit: "%",
        when: &[ADAPTIVE],
        option: Some("radius-max"),
    }
    // The Lipschitz constant of the radius: |r(x) − r(y)| ≤ L |x − y|.
    grading: f64 = 0.2 => {
        label: "Grading",
        help: "Slope L of the radius along the surface. The radii of neighbours differ by the factor (1 + L)/(1 − L) at most: 1.5 for 0.2.",
        group: Group::Advanced,
        min: 0.01,
        max: 0.5,
        step: 0.01,
        when: &[ADAPTIVE],
    }
    relax_steps: u32 = 10 => {
        label: "Relaxation",
        help: "Steps of repulsion after the generation: Gaussian for one size, by overlap for many. The paper takes ten.",
        max: 100.0,
        accepted_max: Some(1000.0),
        step: 1.0,
        unit: "steps",
        option: Some("relax"),
    }
    method: Method = Method::Front => {
        label: "Method",
        help: "A front and relaxation, as in the paper, or a coarse front that is brought into order and refined: more even, on smooth surfaces.",
        group: Group::Advanced,
        choices: Method::CHOICES,
    }
    // The paper names no tolerance; 0.7 gives the most particles with six neighbours on smooth surfaces.
    match_tolerance: f64 = 0.7 => {
        label: "Match tolerance",
        help: "A child joins an existing particle within this distance. Smaller places more and closer particles where fronts meet, larger leaves wider gaps.",
        group: Group::Advanced,
        min: 0.5,
        max: 0.9,
        step: 0.01,
        unit: "× 2r",
    }
    gaps: GapPolicy = GapPolicy::Fill => {
        label: "Gaps",
        help: "Where fronts meet, gaps can be wide enough for a particle. The paper leaves them to the relaxation.",
        group: Group::Advanced,
        choices: GapPolicy::CHOICES,
    }
    seed: u64 = 0 => {
        label: "Seed",
        help: "Chooses the point on the surface where the front begins.",
        group: Group::Advanced,
        max: 999_999.0,
        accepted_max: Some(u64::MAX as f64),
        step: 1.0,
    }
    // A wanted count up to it may be missed upwards like any other.
    max_particles: u32 = 200_000 => {
        label: "Limit",
        help: "The run stops when it has placed this many.",
        group: Group::Advanced,
        min: 1.0,
        max: MOST_PARTICLES,
        step: 0.01,
        scale: Scale::Log,
        unit: "particles",
    }
}

/// More particles than this are not placed.
const MOST_PARTICLES: f64 = 4e6;

/// Room for the particles that are expected, as a multiple of them: a wanted count is met within 3 %, but an attempt at it may
/// overshoot.
pub const COUNT_ROOM: f64 = 1.1;

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
    /// The entry of the table with this name.
    ///
    /// # Panics
    ///
    /// If there is none.
    #[must_use]
    pub fn setting(name: &str) -> Setting {
        let found = Self::table().into_iter().find(|setting| setting.name == name);
        found.unwrap_or_else(|| panic!("there is no setting `{name}`"))
    }

    /// Checks every value against its range, and that the smallest radius is not above the largest.
    ///
    /// # Errors
    ///
    /// The first setting found out of range.
    pub fn validate(&self) -> Result<(), SettingsError> {
        let refused = |name, value, range: RangeInclusive<f64>| {
            let (min, max) = range.into_inner();
            Err(SettingsError::OutOfRange { name, value, min, max })
        };
        for (setting, value) in Self::table().into_iter().zip(self.values()) {
            if let Some(value) = value.as_number()
                && !setting.accepted().contains(&value)
            {
                return refused(setting.name, value, setting.accepted());
            }
        }
        if self.radius_min_share > self.radius_max_share {
            let least = *Self::setting("radius_min_share").accepted().start();
            return refused("radius_min_share", self.radius_min_share, least..=self.radius_max_share);
        }
        Ok(())
    }
}
