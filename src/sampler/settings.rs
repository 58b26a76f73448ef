//! Settings of a run, with the paper's values as defaults.

use crate::field::FieldError;
use crate::math::{Bounds, BoxError, grouped, place_text, shortest_text};
use core::fmt;
use core::ops::RangeInclusive;
use serde::de::{self, IgnoredAny, MapAccess, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Whether all particles have one size.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Sampling {
    /// All particles have one radius (paper §4).
    #[default]
    Uniform,
    /// The radius follows the curvature (paper §5).
    Adaptive,
}

/// The quantity by which the size of the particles is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum SizeMode {
    /// The size is given by [`Settings::radius_share`], or by the radius law of adaptive sampling.
    Radius,
    /// The size follows from the wanted number of particles, [`Settings::count`].
    Count,
}

/// Law for the radius of an adaptive particle, given the principal curvatures κ₁ and κ₂.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum LawKind {
    /// The radius at which an equilateral triangle of neighbours has its middle at the distance
    /// [`Settings::chord_error`] from a surface of the larger curvature. Triangles of other shapes
    /// come up to twice as far from it.
    ChordError,
    /// The radius is [`Settings::curvature_scale`] / max(|κ₁|, |κ₂|).
    MaxCurvature,
    /// The radius is [`Settings::curvature_scale`] / |κ₁ + κ₂|, the paper's choice (§5).
    SumOfCurvatures,
}

/// Method by which the particles are placed and evened out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Method {
    /// A front of the wanted radius, and relaxation (paper §4 and §5).
    Front,
    /// A coarse front, brought into order and refined. If that is impossible, the front is kept.
    Refined,
}

/// Treatment of gaps between fronts that are wide enough for a particle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum GapPolicy {
    /// A particle is placed in the middle of each gap.
    Fill,
    /// The gaps stay, as in the paper.
    Leave,
}

/// Pattern of the particles of a front, see [`Settings::pattern`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Pattern {
    /// Hexagons, as the front and its relaxation make them.
    #[default]
    Hexagonal,
    /// Blue noise, the maximal Poisson-disk sampling: random points none of which is nearer to
    /// another than the sum of their radii, and so many that no more fit.
    Blue,
    /// Independent random points, even by area; where sizes vary, their density goes with 1/r².
    Random,
}

/// How closely a wanted count is met.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Counting {
    /// To within 3 %.
    Nearly,
    /// Exactly: of a front some per cent of the particles at most are removed where they are
    /// crowded, or added in the widest gaps, before the relaxation.
    Exactly,
}

/// The repulsion radius of a run. As text, a length is a number and a share an object:
/// `{"share": 0.01}`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Radius {
    /// As a length, in the units of the coordinates.
    Length(f64),
    /// As a share of the diagonal of the box.
    Share(f64),
}

impl Radius {
    /// The radius as a share of the diagonal of a box.
    fn share_of(self, bounds: &Bounds) -> f64 {
        match self {
            Self::Length(length) => length / bounds.diagonal(),
            Self::Share(share) => share,
        }
    }
}

impl Serialize for Radius {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match *self {
            Self::Length(length) => serializer.serialize_f64(length),
            Self::Share(share) => serializer.collect_map([("share", share)]),
        }
    }
}

impl<'de> Deserialize<'de> for Radius {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ReadRadius)
    }
}

struct ReadRadius;

impl<'de> Visitor<'de> for ReadRadius {
    type Value = Radius;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a length, or {\"share\": a share of the diagonal of the box}")
    }

    fn visit_f64<E: de::Error>(self, length: f64) -> Result<Radius, E> {
        Ok(Radius::Length(length))
    }

    fn visit_i64<E: de::Error>(self, length: i64) -> Result<Radius, E> {
        Ok(Radius::Length(length as f64))
    }

    fn visit_u64<E: de::Error>(self, length: u64) -> Result<Radius, E> {
        Ok(Radius::Length(length as f64))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Radius, A::Error> {
        match (map.next_entry::<String, f64>()?, map.next_key::<IgnoredAny>()?) {
            (Some((key, share)), None) if key == "share" => Ok(Radius::Share(share)),
            _ => Err(de::Error::invalid_type(Unexpected::Map, &self)),
        }
    }
}

/// Settings of a run. `Default` gives the paper's values where it names them. As text, unknown keys
/// are errors.
///
/// ```
/// use marching_particles::{Bounds, Settings};
///
/// let mut settings = Settings::with_count(5_000).in_box(Bounds::cube(1.2)).seeded(7);
/// settings.relax_steps = 20;
/// assert!(settings.validate().is_ok());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct Settings {
    /// Box that is sampled, in the coordinates of the field. Without one a surface of the
    /// [gallery](crate::gallery) has its own, and around others it is fitted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bounds: Option<Bounds>,
    /// Repulsion radius r of particles of one size. If it is given, `size_mode` and `radius_share`
    /// are ignored.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radius: Option<Radius>,
    /// Grid cells along the longest side of the box, to find a surface whose field has no
    /// [bounds](crate::field::Bounded), and its edges if the field does not tell its pieces: a part
    /// smaller than a cell may be missed. The number of evaluations grows with the square of this
    /// one. The default is 64; edges are searched with at most 256.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub survey_cells: Option<u32>,
    /// Uniform or adaptive sampling.
    pub sampling: Sampling,
    /// The quantity by which the size of the particles is given.
    pub size_mode: SizeMode,
    /// Repulsion radius r as a share of the box diagonal; neighbours sit 2r apart. The paper shows
    /// 2 % and 0.6 % (§6).
    pub radius_share: f64,
    /// Target count, met as `counting` says. Adaptive sampling scales all radii by one factor.
    pub count: u32,
    /// How closely the count of a front is met. Blue noise and random points have it exactly, the
    /// refined method nearly.
    pub counting: Counting,
    /// Law for the radius of an adaptive particle, given the principal curvatures.
    pub radius_law: LawKind,
    /// Wanted distance between the surface and a triangle of neighbours, as a share of the box
    /// diagonal; the limits on the radii take precedence. With the default the ellipsoid of the
    /// gallery takes about 16,000 particles, the sphere 13,000.
    pub chord_error: f64,
    /// Radius of a particle over the surface's radius of curvature there.
    pub curvature_scale: f64,
    /// Radius of the smallest particle as a share of the box diagonal.
    pub radius_min_share: f64,
    /// Radius of the largest particle as a share of the box diagonal.
    pub radius_max_share: f64,
    /// Lipschitz constant L of the radius along the surface: |r(x) − r(y)| ≤ L |x − y|.
    pub grading: f64,
    /// Relaxation steps after the generation. The paper takes ten.
    pub relax_steps: u32,
    /// Method by which the particles are placed and evened out.
    pub method: Method,
    /// Pattern of the particles, for the method of a front. Blue noise and random points are drawn
    /// over a front and are not relaxed.
    pub pattern: Pattern,
    /// A child joins an existing particle within this distance, in units of 2r. The paper names no
    /// tolerance. With 0.7 most particles have six neighbours on smooth surfaces.
    pub match_tolerance: f64,
    /// Treatment of gaps where fronts meet.
    pub gaps: GapPolicy,
    /// Seed of the random choice of the point where the front begins.
    pub seed: u64,
    /// The run stops when it has placed this many: a limit on time and memory, by default the
    /// largest number that is accepted. A wanted count up to this limit may be missed upwards like
    /// any other.
    pub max_particles: u32,
}

/// Largest number of particles that may be wanted. With spare columns and the report they take 1.5
/// to 1.7 GB, less than half of what WebAssembly addresses.
const MOST_WANTED: f64 = 4e6;

/// Room for the expected particles, as a multiple of them: a wanted count is met within 3 %, and a
/// first attempt may place some too many.
#[doc(hidden)]
pub const COUNT_ROOM: f64 = 1.1;

/// Largest number of particles of a run.
const MOST_PARTICLES: u32 = (COUNT_ROOM * MOST_WANTED) as u32;

/// The smallest and the largest radius that are accepted, as shares of the diagonal: on an area of
/// one squared diagonal they give 29 million particles and 7.
pub(crate) const LEAST_SHARE: f64 = 1e-4;
pub(crate) const MOST_SHARE: f64 = 0.2;

/// A setting that is a number: its name, its smallest and largest value, and how it is read.
type Number = (&'static str, f64, f64, fn(&Settings) -> f64);

const NUMBERS: [Number; 11] = [
    ("radius_share", LEAST_SHARE, MOST_SHARE, |s| s.radius_share),
    ("count", 1.0, MOST_WANTED, |s| s.count.into()),
    // On a sphere that fills its box, radii of 2·10⁻⁴ to 0.065 of the diagonal.
    ("chord_error", 1e-7, 0.01, |s| s.chord_error),
    // On such a sphere from 3·10⁻⁴ on, up to 57° between the normals of neighbours: from 60° on
    // they may be on two sheets.
    ("curvature_scale", 1e-3, 0.5, |s| s.curvature_scale),
    ("radius_min_share", LEAST_SHARE, MOST_SHARE, |s| s.radius_min_share),
    ("radius_max_share", LEAST_SHARE, MOST_SHARE, |s| s.radius_max_share),
    // The radii of neighbours differ by 2 % to a factor of three.
    ("grading", 0.01, 0.5, |s| s.grading),
    // A limit on time: a hundred times the paper's steps.
    ("relax_steps", 0.0, 1000.0, |s| s.relax_steps.into()),
    // Below, children overlap by half; at 1 they match the particles next to them in a lattice.
    ("match_tolerance", 0.5, 0.9, |s| s.match_tolerance),
    ("seed", 0.0, u64::MAX as f64, |s| s.seed as f64),
    ("max_particles", 1.0, MOST_PARTICLES as f64, |s| s.max_particles.into()),
];

impl Default for Settings {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// A setting out of its range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
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
    /// A [radius](Settings::radius) is given although sizes follow the curvature or a
    /// [spacing](super::Spacing).
    #[error("a radius is for particles of one size: sizes that vary take a count or a chord error instead")]
    RadiusOfVarying,
    /// The box cannot be sampled.
    #[error(transparent)]
    Box(#[from] BoxError),
    /// The columns of that many particles do not fit into the memory.
    #[error(
        "there is not enough memory for about {} particles: choose fewer, or a larger radius",
        grouped(particles)
    )]
    Memory {
        /// Expected number of particles.
        particles: u64,
    },
    /// A [spacing](super::Spacing) is not above 0 at a place of the surface, or is undefined there.
    #[error(fmt = no_length)]
    Spacing {
        /// The spacing there, NaN if it is undefined.
        value: f64,
        /// The place, in the coordinates of the field.
        position: [f64; 3],
    },
    /// The function of a [spacing](super::Spacing) has failed with this error.
    #[error("the function of the spacing has failed: {0}")]
    SpacingFunction(FieldError),
}

fn out_of_range(name: &str, value: &f64, min: &f64, max: &f64, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let [value, min, max] = [*value, *min, *max].map(shortest_text);
    write!(f, "{name} is {value}, but must lie between {min} and {max}")
}

fn no_length(value: &f64, position: &[f64; 3], f: &mut fmt::Formatter<'_>) -> fmt::Result {
    // Six digits of the largest coordinate.
    let length = position.iter().fold(0.0, |a: f64, x| a.max(x.abs())) * 1e-2;
    let place = place_text(*position, length);
    if value.is_nan() {
        return write!(f, "the spacing has no value at {place}, on the surface: it must be a number there");
    }
    let value = shortest_text(*value);
    write!(
        f,
        "the spacing is {value} at {place}, on the surface, but must be above 0: change it, or give a \
         smallest spacing"
    )
}

impl Settings {
    /// The values that `Default` gives. The radius is the smaller one of the paper (§6). With the
    /// chord error most surfaces take about as many particles as the default count, with the
    /// largest curvature more. On a sphere the limits of the radii give 300,000 particles and 340.
    /// The limit on particles is the largest one, so that it stops no run of an accepted count.
    pub const DEFAULT: Self = Self {
        bounds: None,
        radius: None,
        survey_cells: None,
        sampling: Sampling::Uniform,
        size_mode: SizeMode::Radius,
        radius_share: 0.006,
        count: 20_000,
        counting: Counting::Nearly,
        radius_law: LawKind::ChordError,
        chord_error: 4.5e-5,
        curvature_scale: 0.015,
        radius_min_share: 0.001,
        radius_max_share: 0.03,
        grading: 0.2,
        relax_steps: 10,
        method: Method::Front,
        pattern: Pattern::Hexagonal,
        match_tolerance: 0.7,
        gaps: GapPolicy::Fill,
        seed: 0,
        max_particles: MOST_PARTICLES,
    };

    /// Default settings for about `count` particles, met within 3 %.
    #[must_use]
    pub fn with_count(count: u32) -> Self {
        Self { size_mode: SizeMode::Count, count, ..Self::DEFAULT }
    }

    /// Default settings for particles of one size whose neighbours are this far apart, in the units
    /// of the coordinates: for a radius of half the length. [`Settings::spaced`] takes a spacing
    /// that varies.
    ///
    /// ```
    /// use marching_particles::{Radius, Settings};
    ///
    /// assert_eq!(Settings::with_spacing(0.1), Settings::with_radius(Radius::Length(0.05)));
    /// ```
    #[must_use]
    pub fn with_spacing(length: f64) -> Self {
        Self::with_radius(Radius::Length(0.5 * length))
    }

    /// Default settings for particles with this repulsion radius; neighbours sit two radii apart.
    /// [Adaptive](Self::adaptive) sampling refuses them: it takes its radii from the curvature.
    ///
    /// ```
    /// use marching_particles::{Radius, Settings, sample};
    ///
    /// let sphere = |p: marching_particles::glam::DVec3| p.length() - 1.0;
    /// let even = sample(sphere, &Settings::with_radius(Radius::Length(0.05)))?;
    /// assert!((even.report().sizes.radius - 0.05).abs() < 1e-9);
    /// # Ok::<(), marching_particles::Error>(())
    /// ```
    #[must_use]
    pub fn with_radius(radius: Radius) -> Self {
        Self { radius: Some(radius), ..Self::DEFAULT }
    }

    /// Default settings for adaptive sampling in which triangles of neighbours stay within this
    /// distance from the surface: a length over [`Bounds::diagonal`] of the given box.
    #[must_use]
    pub fn with_chord_error(share: f64) -> Self {
        Self { radius_law: LawKind::ChordError, chord_error: share, ..Self::DEFAULT.adaptive() }
    }

    /// Sets the box that is sampled and returns the settings.
    #[must_use]
    pub fn in_box(self, bounds: Bounds) -> Self {
        Self { bounds: Some(bounds), ..self }
    }

    /// Chooses adaptive sampling (paper §5), in which the repulsion radius follows the curvature,
    /// and returns the settings. A given radius is [refused](SettingsError::RadiusOfVarying) when
    /// a run starts: give a count or a chord error.
    #[must_use]
    pub fn adaptive(self) -> Self {
        Self { sampling: Sampling::Adaptive, ..self }
    }

    /// Chooses the refined method, which orders and subdivides a coarse front, and returns the
    /// settings.
    #[must_use]
    pub fn refined(self) -> Self {
        Self { method: Method::Refined, ..self }
    }

    /// Chooses the pattern of the particles and returns the settings.
    ///
    /// ```
    /// use marching_particles::{Pattern, Settings, sample};
    ///
    /// let sphere = |p: marching_particles::glam::DVec3| p.length() - 1.0;
    /// let blue = sample(sphere, &Settings::with_count(1_000).with_pattern(Pattern::Blue))?;
    /// assert_eq!(blue.positions().len(), 1_000);
    /// # Ok::<(), marching_particles::Error>(())
    /// ```
    #[must_use]
    pub fn with_pattern(self, pattern: Pattern) -> Self {
        Self { pattern, ..self }
    }

    /// Has a wanted count met exactly, not only to within 3 %, and returns the settings. The
    /// refined method does not do so.
    #[must_use]
    pub fn exactly(self) -> Self {
        Self { counting: Counting::Exactly, ..self }
    }

    /// The pattern of the particles: that of the refined method is hexagonal.
    pub(crate) fn pattern_in_use(&self) -> Pattern {
        match self.method {
            Method::Front => self.pattern,
            Method::Refined => Pattern::Hexagonal,
        }
    }

    /// Sets the seed of the random choice of the point where the front begins, and returns the
    /// settings.
    #[must_use]
    pub fn seeded(self, seed: u64) -> Self {
        Self { seed, ..self }
    }

    /// Smallest and largest value of a numeric setting; none for other settings.
    #[must_use]
    pub fn range(name: &str) -> Option<RangeInclusive<f64>> {
        NUMBERS.iter().find(|number| number.0 == name).map(|&(_, min, max, _)| min..=max)
    }

    /// The radius of the largest particle as a share of the diagonal of this box, estimated if a
    /// number of particles is wanted; at most the largest accepted.
    #[must_use]
    pub fn largest_share(&self, bounds: &Bounds) -> f64 {
        let share = match (self.size_mode, self.sampling, self.radius) {
            (_, Sampling::Uniform, Some(radius)) => radius.share_of(bounds),
            (SizeMode::Radius, Sampling::Uniform, None) => self.radius_share,
            // For an area of one squared diagonal, about that of a sphere; each particle takes 2√3
            // r².
            (SizeMode::Count, _, None) => (1.0 / (12_f64.sqrt() * f64::from(self.count))).sqrt(),
            (_, Sampling::Adaptive, _) => self.radius_max_share,
        };
        share.min(MOST_SHARE)
    }

    /// These settings with the radius as a share of the diagonal of a box.
    ///
    /// # Errors
    ///
    /// If the radius is a length that is out of range there.
    pub(crate) fn in_shares_of(self, bounds: &Bounds) -> Result<Self, SettingsError> {
        let radius_share = match self.radius {
            None => return Ok(self),
            Some(Radius::Share(share)) => share,
            Some(Radius::Length(length)) => {
                let diagonal = bounds.diagonal();
                let (min, max) = (LEAST_SHARE * diagonal, MOST_SHARE * diagonal);
                if !(min..=max).contains(&length) {
                    return Err(SettingsError::OutOfRange { name: "radius", value: length, min, max });
                }
                (length / diagonal).clamp(LEAST_SHARE, MOST_SHARE)
            }
        };
        Ok(Self { radius_share, size_mode: SizeMode::Radius, ..self })
    }

    /// Checks every value against its range, and that the smallest radius is not above the largest.
    ///
    /// # Errors
    ///
    /// The first setting found out of range.
    pub fn validate(&self) -> Result<(), SettingsError> {
        let numbers = NUMBERS.iter().map(|&(name, min, max, read)| (name, min, max, read(self)));
        let cells = self.survey_cells.map(|cells| ("survey_cells", 8.0, 512.0, cells.into()));
        // The smallest radius is not above the largest.
        let least = ("radius_min_share", LEAST_SHARE, self.radius_max_share, self.radius_min_share);
        let share = match self.radius {
            Some(Radius::Share(share)) => Some(("radius", LEAST_SHARE, MOST_SHARE, share)),
            _ => None,
        };
        for (name, min, max, value) in numbers.chain([least]).chain(cells).chain(share) {
            if !(min..=max).contains(&value) {
                return Err(SettingsError::OutOfRange { name, value, min, max });
            }
        }
        if self.sampling == Sampling::Adaptive && self.radius.is_some() {
            return Err(SettingsError::RadiusOfVarying);
        }
        Ok(self.bounds.map_or(Ok(()), |bounds| bounds.check())?)
    }
}
