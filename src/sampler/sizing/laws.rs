//! Radius laws: the radius of a particle as a function of the curvature of the surface (paper §5).
//!
//! A law gives a radius from 0 to ∞; [`SizingLaw`] clamps it to the smallest and largest radius of the run. Where the
//! curvature is undefined (see [`Curvature::is_defined`]: cone points, creases, the border of the domain of f) every
//! law gives the smallest radius, which is also the limit if the curvature grows towards such a point.

use crate::differential::Curvature;
use crate::sampler::settings::{LawKind, Settings};

/// Law by the chord error: the gap between the surface and a triangle of neighbours is at most ε.
///
/// The middle of an equilateral triangle of side h, inscribed in a sphere of radius R, is ε away from the sphere if h =
/// √(6εR − 3ε²). With R = 1/max(|κ₁|, |κ₂|) and neighbours 2r apart, r = h/2. This law is the default, since its
/// parameter is the easiest to understand.
///
/// # Differs from the paper
///
/// The paper scales κ₁ + κ₂; see [`SumOfCurvatures`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChordError {
    /// Chord error ε, a length.
    pub error: f64,
}

/// Law by the largest curvature, r = s / max(|κ₁|, |κ₂|): the normals of neighbours differ by about 2s radians in the
/// direction of the largest curvature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaxCurvature {
    /// Factor s of the law, a pure number.
    pub scale: f64,
}

/// The paper's law, r = s / |κ₁ + κ₂| (§5, "we define the curvature at a point to be κ = κ₁ + κ₂"). The sum vanishes on
/// symmetric saddles, which get the largest radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SumOfCurvatures {
    /// Factor s of the law, a pure number.
    pub scale: f64,
}

impl ChordError {
    /// Returns the radius of a particle: infinite on a plane, 0 where the radius of curvature is below ε/2.
    #[must_use]
    pub fn radius(&self, curvature: &Curvature) -> f32 {
        let error = self.error as f32;
        let bend_radius = 1.0 / curvature.max_abs();
        0.5 * (3.0 * error * (2.0 * bend_radius - error)).max(0.0).sqrt()
    }
}

impl MaxCurvature {
    /// Returns the radius of a particle: infinite on a plane.
    #[must_use]
    pub fn radius(&self, curvature: &Curvature) -> f32 {
        self.scale as f32 / curvature.max_abs()
    }
}

impl SumOfCurvatures {
    /// Returns the radius of a particle: infinite where the mean curvature vanishes.
    #[must_use]
    pub fn radius(&self, curvature: &Curvature) -> f32 {
        self.scale as f32 / (2.0 * curvature.mean().abs())
    }
}

/// A law for the radius, with its parameters.
#[derive(Clone, Copy, Debug)]
enum Law {
    ChordError(ChordError),
    MaxCurvature(MaxCurvature),
    SumOfCurvatures(SumOfCurvatures),
}

/// The law of a run, with its clamp, and the factor on all radii that makes the count match.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SizingLaw {
    law: Law,
    /// Smallest and largest radius, before the factor.
    least: f32,
    greatest: f32,
    factor: f32,
}

impl SizingLaw {
    /// Returns the law that `settings` ask for in a box with this diagonal.
    pub(crate) fn new(settings: &Settings, diagonal: f64) -> Self {
        let scale = settings.curvature_scale;
        Self {
            law: match settings.radius_law {
                LawKind::ChordError => Law::ChordError(ChordError { error: settings.chord_error * diagonal }),
                LawKind::MaxCurvature => Law::MaxCurvature(MaxCurvature { scale }),
                LawKind::SumOfCurvatures => Law::SumOfCurvatures(SumOfCurvatures { scale }),
            },
            least: (settings.radius_min_share * diagonal) as f32,
            greatest: (settings.radius_max_share * diagonal) as f32,
            factor: 1.0,
        }
    }

    /// Returns the law with all radii and the clamp multiplied by `factor`.
    pub(crate) fn scaled(self, factor: f64) -> Self {
        Self { factor: self.factor * factor as f32, ..self }
    }

    /// Returns the law without any factor.
    pub(crate) fn unscaled(self) -> Self {
        Self { factor: 1.0, ..self }
    }

    /// Returns the smallest radius that the law gives.
    pub(crate) fn least(&self) -> f32 {
        self.least * self.factor
    }

    /// Returns the largest radius that the law gives.
    pub(crate) fn greatest(&self) -> f32 {
        self.greatest * self.factor
    }

    /// Returns the radius where the surface has this curvature.
    #[inline]
    pub(crate) fn radius(&self, curvature: &Curvature) -> f32 {
        let radius = match self.law {
            Law::ChordError(law) => law.radius(curvature),
            Law::MaxCurvature(law) => law.radius(curvature),
            Law::SumOfCurvatures(law) => law.radius(curvature),
        };
        // NaN, which stands for an undefined curvature, is not above the smallest radius.
        let radius = if radius > self.least { radius.min(self.greatest) } else { self.least };
        radius * self.factor
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn curved(k1: f32, k2: f32) -> Curvature {
        Curvature { k1, k2, direction: Vec3::X }
    }

    #[test]
    fn chord_error_is_the_gap_of_an_inscribed_triangle() {
        for (error, bend_radius) in [(1e-3, 1.0), (1e-4, 0.3), (0.05, 0.2)] {
            let radius = f64::from(ChordError { error }.radius(&curved(1.0 / bend_radius as f32, 0.0)));
            // A side of 2r puts the corners at circumradius 2r/√3 from the foot of the sphere's centre.
            let corner_sq = 4.0 * radius * radius / 3.0;
            let gap = bend_radius - (bend_radius * bend_radius - corner_sq).sqrt();
            assert!(
                (gap / error - 1.0).abs() < 1e-3,
                "asked {error}, got {gap} on a sphere of {bend_radius}"
            );
        }
        assert_eq!(ChordError { error: 0.1 }.radius(&curved(100.0, 0.0)), 0.0);
        assert_eq!(ChordError { error: 0.1 }.radius(&curved(0.0, 0.0)), f32::INFINITY);
    }

    #[test]
    fn curvature_laws_are_reciprocal() {
        assert_eq!(MaxCurvature { scale: 0.5 }.radius(&curved(1.0, -4.0)), 0.125);
        assert_eq!(SumOfCurvatures { scale: 0.5 }.radius(&curved(1.0, -5.0)), 0.125);
        assert_eq!(SumOfCurvatures { scale: 0.5 }.radius(&curved(3.0, -3.0)), f32::INFINITY);
    }

    #[test]
    fn every_law_stays_in_its_clamp_and_scales_with_its_factor() {
        for radius_law in [LawKind::ChordError, LawKind::MaxCurvature, LawKind::SumOfCurvatures] {
            let settings = Settings { radius_law, ..Settings::default() };
            let law = SizingLaw::new(&settings, 2.0);
            let larger = law.scaled(3.0);
            let nowhere = curved(f32::NAN, f32::NAN);
            assert_eq!(law.radius(&nowhere), law.least(), "{radius_law:?}");
            assert_eq!(law.radius(&curved(1e30, 1e30)), law.least(), "{radius_law:?}");
            assert_eq!(law.radius(&curved(0.0, 0.0)), law.greatest(), "{radius_law:?}");
            let mut before = law.greatest();
            for k in -40..60 {
                let curvature = curved(libm::powf(1.3, k as f32), 0.0);
                let radius = law.radius(&curvature);
                assert!(radius >= law.least() && radius <= before, "{radius_law:?} at {curvature:?}");
                assert!((larger.radius(&curvature) / radius - 3.0).abs() < 1e-5);
                before = radius;
            }
        }
    }
}
