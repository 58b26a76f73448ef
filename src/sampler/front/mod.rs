//! The front of a run: the uniform one of paper §4 or the adaptive one of §5, and what fills the gaps behind it.

pub(crate) mod adaptive;
mod uniform;

use crate::field::Field;
use crate::math::Bounds;
use crate::particles::Particles;
use crate::sampler::discovery::survey::Survey;
use crate::sampler::fates::FateCounts;
use crate::sampler::front::adaptive::{AdaptiveFront, Surface};
use crate::sampler::front::uniform::UniformFront;
use crate::sampler::front::uniform::gaps::{Gaps, Ground};
use crate::sampler::neighbours::packed::PackedNeighbours;
use crate::sampler::projection::{Projector, tolerance};
use crate::sampler::settings::{Sampling, Settings};
use crate::trace::Trace;
use glam::Vec3;

/// A survey point farther than this many radii from every particle of its sheet starts a front of its own: a closed
/// cover has no hole larger than 1.85 (1.6 of the ideal).
const UNCOVERED: f32 = 2.0;

/// Either front.
#[derive(Clone)]
pub(crate) struct Front {
    sampling: Sampling,
    uniform: UniformFront,
    adaptive: AdaptiveFront,
    gaps: Gaps,
    /// Whether the surface is covered and the gaps are being filled.
    filling: bool,
    /// What the uniform front works with.
    radius: f32,
    bounds: Bounds,
    max_particles: usize,
    survey: (f32, f32),
}

impl Front {
    pub(crate) fn new() -> Self {
        Self {
            sampling: Sampling::Uniform,
            uniform: UniformFront::new(),
            adaptive: AdaptiveFront::new(),
            gaps: Gaps::default(),
            filling: false,
            radius: 1.0,
            bounds: Bounds::cube(1.0),
            max_particles: 0,
            survey: (0.0, 1.0),
        }
    }

    /// Prepares for a run of `expected` particles: of the one `radius`, or of radii between two.
    pub(crate) fn reset(
        &mut self,
        settings: &Settings,
        (radius, radii): (f32, [f32; 2]),
        survey: &Survey,
        bounds: &Bounds,
        expected: usize,
    ) {
        self.sampling = settings.sampling;
        self.radius = radius;
        self.bounds = *bounds;
        self.max_particles = settings.max_particles as usize;
        self.survey = (survey.resolution, survey.gradient_scale);
        self.filling = false;
        self.gaps.clear();
        let match_tolerance = settings.match_tolerance as f32;
        match self.sampling {
            Sampling::Uniform => {
                self.uniform.grid.reserve(expected);
                let tolerance = tolerance(radius, survey.resolution, survey.gradient_scale);
                self.uniform.reset(radius, match_tolerance, tolerance, bounds, self.max_particles);
            }
            Sampling::Adaptive => {
                self.adaptive.reset(settings, radii, self.survey, bounds);
            }
        }
    }

    /// Gives back what only the front needs.
    pub(crate) fn release(&mut self) {
        self.uniform.grid.release();
        self.adaptive.release();
    }

    /// Whether a particle of the sheet of (`position`, `normal`) is so near that no front need start there.
    pub(crate) fn is_covered(
        &mut self,
        field: &mut dyn Field,
        projector: &mut Projector,
        particles: &Particles,
        point: (Vec3, Vec3),
    ) -> bool {
        match self.sampling {
            Sampling::Uniform => {
                self.uniform.is_covered(field, projector, particles, point, UNCOVERED * self.radius)
            }
            Sampling::Adaptive => self.adaptive.is_covered(field, projector, particles, point, UNCOVERED),
        }
    }

    /// Those particles, nearest first, in `near`.
    pub(crate) fn near(&mut self, particles: &Particles, position: Vec3, normal: Vec3, near: &mut Vec<u32>) {
        match self.sampling {
            Sampling::Uniform => {
                self.uniform.near(particles, position, normal, UNCOVERED * self.radius, near);
            }
            Sampling::Adaptive => self.adaptive.near(particles, position, normal, UNCOVERED, near),
        }
    }

    /// Adds a first particle. Says whether it could be: an adaptive one needs a curvature.
    pub(crate) fn add_seed(&mut self, surface: &mut Surface, position: Vec3, normal: Vec3) -> bool {
        match self.sampling {
            Sampling::Uniform => {
                self.uniform.add_seed(surface.particles, position, normal);
                true
            }
            Sampling::Adaptive => self.adaptive.add_seed(surface, position, normal),
        }
    }

    /// Takes the last seed back if it stayed alone within reach of another particle.
    pub(crate) fn drop_lone_seed(&mut self, pairs: &mut PackedNeighbours, particles: &mut Particles) {
        match self.sampling {
            Sampling::Uniform => self.uniform.drop_lone_seed(pairs, particles),
            Sampling::Adaptive => self.adaptive.drop_lone_seed(pairs, particles),
        }
    }

    /// Does up to `budget` units and returns what is left.
    pub(crate) fn step(&mut self, surface: &mut Surface, budget: u32) -> u32 {
        match self.sampling {
            Sampling::Uniform if self.filling => {
                let mut ground = Ground {
                    radius: self.radius,
                    tolerance: tolerance(self.radius, self.survey.0, self.survey.1),
                    bounds: self.bounds,
                    max_particles: self.max_particles,
                    grid: &mut self.uniform.grid,
                    pairs: surface.pairs,
                    particles: surface.particles,
                };
                self.gaps.step(surface.field, surface.projector, &mut ground, budget)
            }
            Sampling::Uniform => {
                let Surface { field, projector, pairs, particles, .. } = surface;
                self.uniform.step(*field, projector, pairs, particles, budget)
            }
            Sampling::Adaptive => self.adaptive.step(surface, budget),
        }
    }

    /// Whether the front, or the filling of the gaps, has come to its end.
    pub(crate) fn is_done(&self) -> bool {
        match self.sampling {
            Sampling::Uniform if self.filling => self.gaps.is_done(),
            Sampling::Uniform => self.uniform.is_done(),
            Sampling::Adaptive => self.adaptive.is_done(),
        }
    }

    /// Goes on to the gaps, when the whole surface is covered; false if there is none to fill.
    pub(crate) fn fill(&mut self) -> bool {
        match self.sampling {
            Sampling::Uniform if self.filling || self.uniform.seams.is_empty() => return false,
            Sampling::Uniform => self.gaps.begin(&mut self.uniform.seams),
            Sampling::Adaptive if !self.adaptive.fill() => return false,
            Sampling::Adaptive => {}
        }
        self.filling = true;
        true
    }

    /// Ends the front where it is: what is not final is dropped.
    pub(crate) fn stop(&mut self, particles: &mut Particles) {
        match self.sampling {
            Sampling::Uniform if self.filling => {}
            Sampling::Uniform => self.uniform.stop(particles),
            Sampling::Adaptive => self.adaptive.stop(particles),
        }
    }

    /// Particles that are final, of `all`.
    pub(crate) fn settled(&self, all: usize) -> usize {
        match self.sampling {
            Sampling::Uniform if self.filling => all,
            Sampling::Uniform => self.uniform.settled(),
            Sampling::Adaptive => self.adaptive.settled(),
        }
    }

    /// What became of the children.
    pub(crate) fn fates(&self) -> FateCounts {
        match self.sampling {
            Sampling::Uniform => self.uniform.fates,
            Sampling::Adaptive => self.adaptive.fates,
        }
    }

    /// Particles placed in gaps.
    pub(crate) fn filled(&self) -> u64 {
        match self.sampling {
            Sampling::Uniform => self.gaps.filled,
            Sampling::Adaptive => self.adaptive.filled,
        }
    }

    /// The log of the adaptive front.
    pub(crate) fn trace(&self) -> &Trace {
        &self.adaptive.trace
    }

    /// Follows a particle, or none.
    pub(crate) fn follow(&mut self, particle: Option<u32>) {
        self.adaptive.trace.follow(particle);
    }

    /// Whether the limit on particles was reached.
    pub(crate) fn capped(&self) -> bool {
        match self.sampling {
            Sampling::Uniform => self.uniform.capped,
            Sampling::Adaptive => self.adaptive.capped,
        }
    }

    /// Notes that the limit on particles was reached.
    pub(crate) fn cap(&mut self) {
        match self.sampling {
            Sampling::Uniform => self.uniform.capped = true,
            Sampling::Adaptive => self.adaptive.capped = true,
        }
    }
}
