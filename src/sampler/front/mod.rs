//! The front of a run: the uniform one of paper §4 or the adaptive one of §5, and what fills the gaps behind it.

mod adaptive;
mod level;
mod uniform;

pub(crate) use level::{FrontContext, FrontSetup, LevelFront};
pub(crate) use uniform::gaps::widest_gap;

use crate::math::SQRT_3;
use crate::sampler::front::adaptive::AdaptiveFront;
use crate::sampler::front::uniform::UniformFront;
use crate::sampler::settings::Sampling;

/// A survey point farther than this many radii from every particle of its sheet starts a front of its own: a closed
/// cover has no hole larger than 1.85 (1.6 of the ideal).
pub(crate) const UNCOVERED: f32 = 2.0;

/// Largest sine of the angle by which the way to a child is predicted to dip below the tangent plane, or to rise above it. Beyond
/// it the radius does not resolve the curvature.
const MAX_DIP: f32 = 0.9;

/// Sine of 60°.
const SIN_60: f32 = 0.5 * SQRT_3 as f32;

/// The fronts of both kinds, of which one works. The other one keeps its memory.
#[derive(Clone, Default)]
pub(crate) struct Front {
    sampling: Sampling,
    uniform: UniformFront,
    adaptive: AdaptiveFront,
}

impl Front {
    /// Prepares the front that the settings ask for.
    pub(crate) fn reset(&mut self, setup: &FrontSetup) {
        self.sampling = setup.settings.sampling;
        self.active_mut().reset(setup);
    }

    /// Gives back the memory that only the fronts need.
    pub(crate) fn release(&mut self) {
        self.uniform.release();
        self.adaptive.release();
    }

    /// The front that works.
    pub(crate) fn active(&self) -> &dyn LevelFront {
        match self.sampling {
            Sampling::Uniform => &self.uniform,
            Sampling::Adaptive => &self.adaptive,
        }
    }

    /// The front that works, for changes.
    pub(crate) fn active_mut(&mut self) -> &mut dyn LevelFront {
        match self.sampling {
            Sampling::Uniform => &mut self.uniform,
            Sampling::Adaptive => &mut self.adaptive,
        }
    }

    /// Whether the limit on particles was reached.
    pub(crate) fn is_capped(&self) -> bool {
        self.active().level().capped
    }
}
