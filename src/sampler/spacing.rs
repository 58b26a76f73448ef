//! The wanted distance between neighbours as a function of position.

use super::settings::{MOST_SHARE, Sampling, Settings, SettingsError, SizeMode};
use crate::field::formula::{Formula, FormulaError, Noun, Parameter};
use crate::field::{BATCH, Field, FieldError, Frame, IntoField};
use crate::math::Bounds;
use core::fmt::{self, Debug, Formatter};
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// Wanted distance between neighbours as a function s(x, y, z) of position, in the units of the
/// coordinates: twice the repulsion radius.
///
/// It is evaluated in the coordinates of the field, on the surface or near it, at many points at a
/// time. The run uses the largest spacing of slope 2 [`Settings::grading`] that is nowhere above s,
/// so that sizes change gradually next to a jump of s;
/// [`Warning::Smoothed`](crate::Warning::Smoothed) says where that is less than s. The grading is
/// computed on a grid of 32 cells along the longest side of the box: within a cell, s itself is
/// used.
///
/// With [`SizeMode::Count`](crate::SizeMode::Count) s gives the ratio of the distances, and the
/// count their scale. With adaptive sampling the smaller one of s and the spacing that follows the
/// curvature is used. The radius stays between 0.01 % and 20 % of the diagonal of the box.
///
/// If s is not above 0 on the surface, or undefined, there is no sample, and the error says where;
/// [`Spacing::at_least`] replaces sizes of 0 and below.
///
/// ```
/// use marching_particles::{Settings, Spacing, sample};
///
/// let sphere = |p: marching_particles::glam::DVec3| p.length() - 1.0;
/// // Finer towards the pole: neighbours are 0.04 apart there, and 0.16 on the other side.
/// let spacing = Spacing::parse("0.1 - 0.06 z")?;
/// let fine = sample(sphere, &Settings::default().spaced(spacing))?;
/// assert!(fine.report().sizes.radius_max > 3.0 * fine.report().sizes.radius_min);
///
/// // The same by a function, scaled to a number of particles.
/// let spacing = Spacing::by(|p: marching_particles::glam::DVec3| 0.1 - 0.06 * p.z);
/// let counted = sample(sphere, &Settings::with_count(2_000).spaced(spacing))?;
/// assert!(counted.report().count.abs_diff(2_000) <= 60);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct Spacing {
    function: Arc<dyn Field>,
    /// The formula of the function, if it is one.
    text: Option<Arc<str>>,
    smallest: Option<f64>,
    largest: Option<f64>,
}

/// Formulas are equal if they are written alike, functions if they are the same object.
impl PartialEq for Spacing {
    fn eq(&self, other: &Self) -> bool {
        let is_same = match (&self.text, &other.text) {
            (None, None) => Arc::ptr_eq(&self.function, &other.function),
            (own, other) => own == other,
        };
        is_same && (self.smallest, self.largest) == (other.smallest, other.largest)
    }
}

impl Debug for Spacing {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_struct("Spacing")
            .field("text", &self.text)
            .field("smallest", &self.smallest)
            .field("largest", &self.largest)
            .finish_non_exhaustive()
    }
}

/// How errors name a spacing.
const NOUN: Noun = Noun {
    name: "spacing",
    unknown: "The formula has no parameter",
    others: "the parameters of the formula",
    examples: ["0.1", "0.02 + 0.1 hypot(x, y)", "if(z > 0, 0.02, 0.1)"],
};

impl Spacing {
    /// The spacing by a formula of x, y and z, such as `0.02 + 0.1 hypot(x, y)`, in the language of
    /// [`Formula`].
    ///
    /// # Errors
    ///
    /// Any of [`FormulaErrorKind`](crate::field::formula::FormulaErrorKind), with its span in bytes
    /// of `text`: `UnknownName` for another name.
    pub fn parse(text: &str) -> Result<Self, FormulaError> {
        Self::of_formula(text, &[])
    }

    /// [`Spacing::parse`], with these parameters, and their values.
    ///
    /// # Errors
    ///
    /// The errors of [`Spacing::parse`].
    pub(crate) fn of_formula(text: &str, parameters: &[Parameter]) -> Result<Self, FormulaError> {
        let function = Arc::new(Formula::expression(text, parameters, &NOUN)?);
        Ok(Self { function, text: Some(text.into()), smallest: None, largest: None })
    }

    /// The spacing by a function of the program, which is anything that can be
    /// [sampled](IntoField): a function of a point, or one of a batch of points that may fail. A
    /// [`FnField`](crate::field::FnField) or [`BatchField`](crate::field::BatchField) may also
    /// [limit](crate::field::FnField::limit_calls) the points of a call. If the function fails
    /// there is no sample, and the error is [`SettingsError::SpacingFunction`].
    pub fn by<Kind>(function: impl IntoField<Kind, Field: 'static>) -> Self {
        Self { function: Arc::new(function.into_field()), text: None, smallest: None, largest: None }
    }

    /// Uses `smallest` wherever the function is below it, even at 0 or below.
    #[must_use]
    pub fn at_least(self, smallest: f64) -> Self {
        Self { smallest: Some(smallest), ..self }
    }

    /// Uses `largest` wherever the function is above it.
    #[must_use]
    pub fn at_most(self, largest: f64) -> Self {
        Self { largest: Some(largest), ..self }
    }

    /// The formula, if it is given by one.
    #[must_use]
    pub fn text(&self) -> Option<&str> {
        self.text.as_deref()
    }

    /// Smallest and largest spacing, where they were set.
    #[must_use]
    pub fn limits(&self) -> [Option<f64>; 2] {
        [self.smallest, self.largest]
    }

    /// Checks that the limits are lengths, the smallest one not above the largest.
    ///
    /// # Errors
    ///
    /// [`SettingsError::OutOfRange`] if they are not.
    pub(crate) fn check_limits(&self) -> Result<(), SettingsError> {
        let (min, max) = Bounds::DIAGONALS.into_inner();
        let check = |name, value: Option<f64>, max| match value {
            Some(value) if !(min..=max).contains(&value) => {
                Err(SettingsError::OutOfRange { name, value, min, max })
            }
            _ => Ok(()),
        };
        check("spacing_max", self.largest, max)?;
        check("spacing_min", self.smallest, self.largest.unwrap_or(max))
    }

    /// Why the function gives no values any more, if it has failed.
    pub(crate) fn failure(&self) -> Option<FieldError> {
        self.function.failure()
    }

    /// The wanted radii at places relative to `origin`, within the limits; NaN where the function
    /// is undefined.
    pub(crate) fn radii(&self, origin: DVec3, places: &[Vec3], radii: &mut [f32]) {
        let evaluator = &mut *self.function.evaluator(Frame::around(origin));
        for (places, radii) in places.chunks(BATCH).zip(radii.chunks_mut(BATCH)) {
            evaluator.values(places, radii);
        }
        let [least, greatest] = self.limits().map(|limit| limit.map(|limit| (0.5 * limit) as f32));
        for radius in radii {
            // Comparisons leave NaN as it is.
            *radius *= 0.5;
            *radius = least.filter(|least| *radius < *least).unwrap_or(*radius);
            *radius = greatest.filter(|greatest| *radius > *greatest).unwrap_or(*radius);
        }
    }

    /// Checks the wanted radii at places relative to `origin`.
    ///
    /// # Errors
    ///
    /// If the function has failed, or the first place at which it is not above 0.
    pub(crate) fn check(&self, origin: DVec3, places: &[Vec3], radii: &[f32]) -> Result<(), SettingsError> {
        if let Some(error) = self.failure() {
            return Err(SettingsError::SpacingFunction(error));
        }
        let bad = places.iter().zip(radii).find(|(_, radius)| radius.is_nan() || **radius <= 0.0);
        bad.map_or(Ok(()), |(place, radius)| {
            let position = (origin + place.as_dvec3()).to_array();
            Err(SettingsError::Spacing { value: 2.0 * f64::from(*radius), position })
        })
    }
}

/// Settings of a run with a spacing by a function, as [`Settings::spaced`] makes them.
#[derive(Clone, Debug, PartialEq)]
pub struct SpacedSettings {
    /// The settings. A spacing overrides their radius.
    pub settings: Settings,
    /// The spacing; none if particles have one size, or sizes that follow the curvature alone.
    pub spacing: Option<Spacing>,
}

impl From<&Settings> for SpacedSettings {
    fn from(settings: &Settings) -> Self {
        Self { settings: *settings, spacing: None }
    }
}

impl From<&SpacedSettings> for SpacedSettings {
    fn from(settings: &SpacedSettings) -> Self {
        settings.clone()
    }
}

impl Settings {
    /// Sets the distance between neighbours as a function of position, and returns the settings
    /// with it. With [`Settings::adaptive`] the smaller one of it and the spacing by curvature is
    /// used. A given [`Settings::radius`] is [refused](SettingsError::RadiusOfVarying) when a run
    /// starts.
    #[must_use]
    pub fn spaced(self, spacing: Spacing) -> SpacedSettings {
        SpacedSettings { settings: self, spacing: Some(spacing) }
    }

    /// [`Settings::largest_share`], with a spacing by a function: by its largest value at points
    /// spread over the box.
    pub(crate) fn largest_share_with(&self, bounds: &Bounds, spacing: Option<&Spacing>) -> f64 {
        /// Points along each axis.
        const SIDE: usize = 5;
        let Some(spacing) = spacing.filter(|_| self.size_mode == SizeMode::Radius) else {
            return self.largest_share(bounds);
        };
        let places: Vec<Vec3> = bounds.spread(SIDE).map(|p| p.as_vec3()).collect();
        let mut radii = vec![0.0; places.len()];
        spacing.radii(DVec3::ZERO, &places, &mut radii);
        let largest = radii.into_iter().filter(|radius| radius.is_finite()).fold(0.0, f32::max);
        let most = match self.sampling {
            Sampling::Uniform => MOST_SHARE,
            Sampling::Adaptive => self.radius_max_share,
        };
        (f64::from(largest) / bounds.diagonal()).min(most)
    }
}
