//! The plan of a front.

use crate::math::Bounds;
use crate::sampler::discovery::survey::Survey;
use crate::sampler::neighbours::grids::RadiusRange;
use crate::sampler::projection::{Tolerance, tolerance};
use crate::sampler::sheet::SheetRule;
use crate::sampler::sizing::Sizing;

/// The plan of a front says in which box it grows, and how large its particles are.
#[derive(Clone, Default)]
pub(crate) struct FrontPlan {
    /// The box in which the front grows.
    pub(crate) bounds: Bounds,
    /// Radius of the particles. Where sizes differ, it is the one at which as many of one size
    /// would cover the surface.
    pub(crate) radius: f32,
    /// The radius field, where sizes differ.
    pub(crate) sizing: Option<Sizing>,
    /// Largest slope of the radius along the surface, where sizes differ.
    pub(crate) grading: f32,
    /// A child joins a particle that is nearer than this share of the spacing.
    pub(crate) match_tolerance: f64,
    /// The front ends when there are so many particles.
    pub(crate) max_particles: usize,
    /// Particles that are expected.
    pub(crate) expected: f64,
    /// How often the front is to be refined; none if it is no coarse one. A coarse front grows
    /// beyond the box.
    pub(crate) halvings: Option<u32>,
}

impl FrontPlan {
    /// Smallest and largest radius of a particle.
    pub(crate) fn radii(&self) -> RadiusRange {
        match &self.sizing {
            Some(sizing) => RadiusRange { smallest: sizing.smallest(), largest: sizing.largest() },
            None => RadiusRange::of(self.radius),
        }
    }

    /// Tolerance for the particles.
    pub(crate) fn tolerance(&self, survey: &Survey) -> Tolerance {
        tolerance(self.radius, survey.residual_limits(), survey.gradient_scale)
    }

    /// The rule that tells the sheets of the particles apart.
    pub(super) fn rule(&self, survey: &Survey) -> SheetRule {
        SheetRule::new(survey.crowding, self.radii(), survey.residual_limits())
    }
}
