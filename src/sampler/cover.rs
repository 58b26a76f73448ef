//! The particles on a surface, with the mesh, the counts and the progress that belong to them.

use super::attempt::Attempt;
use super::discovery::search::ComponentSearch;
use super::flow::Flow;
use super::front::{Front, FrontPlan};
use super::neighbours::packed::PackedNeighbours;
use super::phase::Phase;
use super::progress::{Counts, RefineProgress};
use super::relaxation::{MoveLimits, Relaxation, RepulsionLaw};
use super::settings::{Sampling, Settings};
use super::surface::Surface;
use crate::math::Bounds;
use crate::particles::Particles;
use glam::DVec3;

/// A cover of a surface by particles. A method works on it, and its caller looks at it in between.
#[derive(Default)]
pub(super) struct Cover {
    pub(super) particles: Particles,
    /// The particles of a coarse front that lie in the box, while the front marches beyond.
    pub(super) inside: Option<Particles>,
    /// The mesh of a refinement: the particles at the corners of its faces.
    pub(super) corners: Vec<u32>,
    /// Whether particles have moved or been removed since the last step.
    pub(super) moved: bool,
    pub(super) phase: Phase,
    /// Number of the front under way, from 1.
    pub(super) fronts: u32,
    /// The radii.
    pub(super) attempt: Attempt,
    /// The plan of the front.
    pub(super) plan: FrontPlan,
    pub(super) front: Front,
    /// Share of the particles of a pattern that are drawn, while one is drawn.
    pub(super) drawn: Option<f64>,
    pub(super) neighbours: PackedNeighbours,
    pub(super) relaxation: Relaxation,
    pub(super) flow: Flow,
    /// The progress of the refinement of a coarse front, while there is one.
    pub(super) refined: RefineProgress,
    /// Which components have witnesses, and which hold particles.
    pub(super) components: ComponentSearch,
    /// A place where f vanishes only on a curve or at an isolated point, if this run has found one.
    pub(super) bare: Option<DVec3>,
    pub(super) counts: Counts,
    /// Evaluations so far.
    pub(super) evaluations: u64,
    /// The largest share of the work reported so far, since work was last requested.
    pub(super) fraction: f64,
}

impl Cover {
    /// Rows of the columns that will stay.
    pub(super) fn settled(&self) -> usize {
        match self.phase {
            Phase::Generation if self.drawn.is_none() => self.front.level().settled,
            _ => self.particles.len(),
        }
    }

    /// The law by which the particles repel each other.
    pub(super) fn law(&self, surface: &Surface, settings: &Settings) -> RepulsionLaw {
        let tolerance = self.attempt.tolerance(&surface.survey);
        match settings.sampling {
            Sampling::Uniform => RepulsionLaw::Gaussian { radius: self.attempt.radius as f32, tolerance },
            Sampling::Adaptive => RepulsionLaw::Overlap {
                residual_limits: surface.survey.residual_limits(),
                min_gradient: tolerance.min_gradient,
            },
        }
    }

    /// Begins the relaxation of the present particles.
    pub(super) fn begin_relaxation(&mut self, surface: &Surface, settings: &Settings) {
        self.phase = Phase::Relaxation;
        self.corners = Vec::new();
        self.front.release();
        self.particles.shrink();
        self.neighbours.shrink();
        let law = self.law(surface, settings);
        let limits =
            MoveLimits { bounds: surface.bounds, largest_lift: self.front.level().rule.largest_lift() };
        self.relaxation.begin(law, limits, settings.relax_steps, &self.particles, &mut self.neighbours);
    }

    /// Finds the particles to be shown of a front that marches beyond the box.
    pub(super) fn look_inside(&mut self, bounds: &Bounds) {
        let is_marching = match self.phase {
            Phase::Seeding | Phase::Generation | Phase::Search => self.plan.halvings.is_some(),
            _ => false,
        };
        let settled = self.settled();
        self.inside = None;
        if is_marching && self.particles.local[..settled].iter().any(|&p| !bounds.contains(p)) {
            let mut inside = self.particles.clone();
            inside.truncate(settled);
            inside.keep_within(bounds);
            self.inside = Some(inside);
        }
    }
}
