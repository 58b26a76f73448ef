//! Radius laws: the radius of a particle as a function of the curvature of the surface (paper §5).
//!
//! A law gives a radius from 0 to ∞; [`SizingLaw`] clamps it to the smallest and largest radius of
//! the run. Where the curvature is undefined (see [`Curvature::is_defined`]: cone points, creases,
//! the border of the domain of f) every law gives the smallest radius, which is also its limit as
//! the curvature grows.

use crate::differential::Curvature;
use crate::sampler::settings::{LawKind, Settings};

/// Returns the radius that a law gives for a curvature. For the chord error, `size` is the error ε,
/// a length; for the other laws it is the factor s, a pure number.
///
/// * Chord error: the middle of an equilateral triangle of side h, inscribed in a sphere of radius
///   R, is ε away from the sphere if h = √(6εR − 3ε²). With R = 1/max(|κ₁|, |κ₂|) and neighbours 2r
///   apart, r = h/2: infinite on a plane, 0 where R is below ε/2. This law is the default, since
///   its parameter is the easiest to understand.
/// * Largest curvature: r = s / max(|κ₁|, |κ₂|), infinite on a plane. The normals of neighbours
///   differ by about 2s radians in the direction of the largest curvature.
/// * Sum of curvatures: r = s / |κ₁ + κ₂|, the paper's law (§5, "we define the curvature at a point
///   to be κ = κ₁ + κ₂"). The sum vanishes on symmetric saddles, where the radius is infinite.
fn law_radius(law: LawKind, size: f32, curvature: &Curvature) -> f32 {
    match law {
        LawKind::ChordError => {
            let bend_radius = 1.0 / curvature.max_abs();
            0.5 * (3.0 * size * (2.0 * bend_radius - size)).max(0.0).sqrt()
        }
        LawKind::MaxCurvature => size / curvature.max_abs(),
        LawKind::SumOfCurvatures => size / (2.0 * curvature.mean().abs()),
    }
}

/// A law of the curvature with its smallest and largest radius.
#[derive(Clone, Copy, Debug)]
struct Bend {
    law: LawKind,
    /// Chord error or factor of the law.
    size: f32,
    least: f32,
    greatest: f32,
}

/// The law of a run: the radius that follows the curvature, the one requested at a place, or the
/// smaller of both, with its clamp and the factor on all radii that makes the count match.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SizingLaw {
    /// The law of the curvature, if the radius follows it.
    bend: Option<Bend>,
    /// Smallest and largest radius, before the factor.
    least: f32,
    greatest: f32,
    factor: f32,
}

impl SizingLaw {
    /// Returns the law that `settings` request in a box with this diagonal, of radii that follow
    /// the curvature.
    pub(crate) fn new(settings: &Settings, diagonal: f64) -> Self {
        let law = settings.radius_law;
        let size = match law {
            LawKind::ChordError => settings.chord_error * diagonal,
            LawKind::MaxCurvature | LawKind::SumOfCurvatures => settings.curvature_scale,
        };
        let least = (settings.radius_min_share * diagonal) as f32;
        let greatest = (settings.radius_max_share * diagonal) as f32;
        let bend = Bend { law, size: size as f32, least, greatest };
        Self { bend: Some(bend), least, greatest, factor: 1.0 }
    }

    /// Returns the law of a spacing by a function, whose radii lie between `least` and `greatest`.
    /// If a law of the curvature is given, too, a particle has the smaller of both radii.
    pub(crate) fn asked(bend: Option<Self>, [least, greatest]: [f32; 2]) -> Self {
        Self { bend: bend.and_then(|law| law.bend), least, greatest, factor: 1.0 }
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

    /// Returns the radius for this curvature and the radius `asked`, the one requested at the
    /// place; infinity if none is.
    #[inline]
    pub(crate) fn radius(&self, asked: f32, curvature: &Curvature) -> f32 {
        let bend = self.bend.as_ref().map_or(f32::INFINITY, |bend| {
            let radius = law_radius(bend.law, bend.size, curvature);
            // NaN, which stands for an undefined curvature, is not above the smallest radius.
            if radius > bend.least { radius.min(bend.greatest) } else { bend.least }
        });
        // The minimum of a number and NaN is the number.
        let radius = bend.min(asked);
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
            let radius = f64::from(law_radius(
                LawKind::ChordError,
                error as f32,
                &curved(1.0 / bend_radius as f32, 0.0),
            ));
            // A side of 2r puts the corners at circumradius 2r/√3 from the foot of the sphere's
            // centre.
            let corner_sq = 4.0 * radius * radius / 3.0;
            let gap = bend_radius - (bend_radius * bend_radius - corner_sq).sqrt();
            assert!(
                (gap / error - 1.0).abs() < 1e-3,
                "asked {error}, got {gap} on a sphere of {bend_radius}"
            );
        }
        assert_eq!(law_radius(LawKind::ChordError, 0.1, &curved(100.0, 0.0)), 0.0);
        assert_eq!(law_radius(LawKind::ChordError, 0.1, &curved(0.0, 0.0)), f32::INFINITY);
    }

    #[test]
    fn curvature_laws_are_reciprocal() {
        assert_eq!(law_radius(LawKind::MaxCurvature, 0.5, &curved(1.0, -4.0)), 0.125);
        assert_eq!(law_radius(LawKind::SumOfCurvatures, 0.5, &curved(1.0, -5.0)), 0.125);
        assert_eq!(law_radius(LawKind::SumOfCurvatures, 0.5, &curved(3.0, -3.0)), f32::INFINITY);
    }

    #[test]
    fn every_law_stays_in_its_clamp_and_scales_with_its_factor() {
        for radius_law in [LawKind::ChordError, LawKind::MaxCurvature, LawKind::SumOfCurvatures] {
            let settings = Settings { radius_law, ..Settings::default() };
            let law = SizingLaw::new(&settings, 2.0);
            let larger = law.scaled(3.0);
            let nowhere = curved(f32::NAN, f32::NAN);
            assert_eq!(law.radius(f32::INFINITY, &nowhere), law.least(), "{radius_law:?}");
            assert_eq!(law.radius(f32::INFINITY, &curved(1e30, 1e30)), law.least(), "{radius_law:?}");
            assert_eq!(law.radius(f32::INFINITY, &curved(0.0, 0.0)), law.greatest(), "{radius_law:?}");
            let mut before = law.greatest();
            for k in -40..60 {
                let curvature = curved(libm::powf(1.3, k as f32), 0.0);
                let radius = law.radius(f32::INFINITY, &curvature);
                assert!(radius >= law.least() && radius <= before, "{radius_law:?} at {curvature:?}");
                assert!((larger.radius(f32::INFINITY, &curvature) / radius - 3.0).abs() < 1e-5);
                before = radius;
            }
        }
    }
}
