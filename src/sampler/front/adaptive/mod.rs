//! Adaptive sampling, paper §5: a front of particles of different radii. Each places its children
//! in the free arcs between the particles around it, so that they touch it, generation level by
//! generation level.
//!
//! # Differs from the paper
//!
//! * As in the uniform front, a queue takes the place of the stack.
//! * The children of a whole level are first placed by prediction: on the surface by the parent's
//!   curvature, with the radius that the gradient of the neighbours' radii predicts. They are then
//!   projected together. Their fates are decided one by one in the order of the queue, at their
//!   final places.
//! * The children of an arc share its slack evenly; in the paper the last one gets it all.
//! * A particle whose child collided with another one places children a second time once the front
//!   is done.

mod arcs;
mod parents;
mod placement;
mod prediction;
mod vicinity;

use crate::particles::Particles;
use crate::sampler::discovery::survey::Survey;
use crate::sampler::front::adaptive::arcs::ParentFrame;
use crate::sampler::front::adaptive::parents::{LocalShape, Parent, Parents, shape_in};
use crate::sampler::front::adaptive::placement::{DirectPlacement, Proposal};
use crate::sampler::front::adaptive::vicinity::Vicinity;
use crate::sampler::front::level::{
    ChildLanding, FrontContext, FrontLevel, Placing, SlotFrame, SurfacePoint, is_on_sheet,
};
use crate::sampler::front::plan::FrontPlan;
use crate::sampler::neighbours::constants::{OVERLAP_RANGE, OVERLAP_SKIN};
use crate::sampler::probe::Probe;
use crate::sampler::projection::{ResidualLimits, Tolerance, tolerance};
use crate::sampler::sheet::{PointPair, is_level};
use core::ops::Range;
use glam::{Vec2, Vec3};

/// Radius of the query around a parent, in its radii: it covers every collision of a child of usual
/// size, 2 + 2 × 0.7, and some more. The second ring of a lattice is at 3.46.
const REACH: f32 = 3.7;

/// Particles within this share of r_i + r_j enter each other's neighbour lists for the relaxation.
const LISTED: f32 = 0.5 * (OVERLAP_RANGE + OVERLAP_SKIN);

/// Neighbours within this share of r_i + r_j count as touching: they get one of the parent's slots.
/// It moves no particle.
const TOUCHING: f32 = 1.25;

/// Neighbours within this many radii enter the fit of the radius's gradient. The rings of a lattice
/// are at 2 and at 3.46.
const RING: f32 = 2.8;

/// A child and its parent take part in the filling if the child's radius differs from the
/// prediction by more than this share: the radii around them are known by then. Holes beside small
/// particles are narrower so.
const SURPRISE: f32 = 0.1;

/// Largest number of rounds of filling. With them the largest hole of creased surfaces is narrower;
/// more rounds place no more particles.
const MAX_FILLS: u32 = 4;

/// Bound for the slope of the radius along the way to a child, above the steepest grading that a
/// run may ask for: only where the law jumps is the slope so large.
const MAX_SLOPE: f32 = 0.7;

/// The settings of a run and what its survey found, as far as the front needs them.
#[derive(Clone, Copy, Debug, Default)]
struct FrontRules {
    /// Largest change of the radius per unit of length.
    grading: f32,
    /// Least distance of two particles, as a share of r_i + r_j.
    match_tolerance: f32,
    /// Distance from a parent within which particles are gathered, in radii of the parent.
    reach: f32,
    residual_limits: ResidualLimits,
    gradient_scale: f32,
}

impl FrontRules {
    /// Tolerance for a particle of this radius.
    fn tolerance(&self, radius: f32) -> Tolerance {
        tolerance(radius, self.residual_limits, self.gradient_scale)
    }
}

/// How a front of particles of different radii places children.
#[derive(Clone, Default)]
pub(super) struct AdaptivePlacing {
    rules: FrontRules,
    parents: Parents,
    /// The problems that the children of the level pose.
    proposals: Vec<Proposal>,
    /// Landings of a batch of children.
    landings: Vec<ChildLanding>,
    /// Largest increase of a radius in this level when its child was projected.
    growth: f32,
    around: Vicinity,
    solver: DirectPlacement,
    /// Rounds of filling so far.
    fills: u32,
}

impl AdaptivePlacing {
    /// Gives back the memory that only the front needs.
    pub(super) fn release(&mut self) {
        self.parents = Parents::default();
    }

    /// Whether a settled particle of the same sheet is nearer to a place on a patch than the match
    /// tolerance allows.
    fn collides(
        &self,
        level: &mut FrontLevel,
        probe: &mut Probe,
        particles: &Particles,
        spot: &SurfacePoint,
        patch: Option<u32>,
    ) -> bool {
        let share = self.rules.match_tolerance;
        level.gather(particles, patch, spot.position, |largest| share * (spot.radius + largest));
        level.found.iter().any(|near| {
            let j = near.index as usize;
            let both = spot.radius + particles.radius[j];
            let limit = share * both;
            let pair = PointPair { offset: near.offset, normal: spot.normal, other: particles.normal[j] };
            j < level.settled
                && near.distance_sq <= limit * limit
                && is_level(pair, near.distance_sq, limit)
                && (!level.rule.is_fine() || is_on_sheet(level.rule, probe, spot.position, pair, both))
        })
    }
}

impl Placing for AdaptivePlacing {
    fn reset(&mut self, level: &mut FrontLevel, plan: &FrontPlan, survey: &Survey, _: usize) {
        let grading = plan.grading;
        // Neighbours that touch differ by this factor at most.
        let ratio = (1.0 + grading) / (1.0 - grading);
        let reach = REACH.max(LISTED * (1.0 + ratio));
        self.rules = FrontRules {
            grading,
            match_tolerance: plan.match_tolerance as f32,
            reach,
            residual_limits: survey.residual_limits(),
            gradient_scale: survey.gradient_scale,
        };
        self.clear_level();
        self.truncate(0);
        self.fills = 0;
        level.grids.reset(plan.radii(), |radius| reach * radius);
    }

    fn parents(&self) -> usize {
        self.parents.level.len()
    }

    fn add_parent(&mut self, context: &mut FrontContext, place: Vec3, particle: usize) -> f32 {
        let spot = self.solver.look(context.probe, context.sizing(), place);
        self.parents.add(particle as u32, LocalShape { curvature: spot.curvature, slope: Vec3::ZERO });
        spot.radius
    }

    /// Finds the free arcs of the parent and enters provisional children in each.
    fn place_children(&mut self, level: &mut FrontLevel, context: &mut FrontContext, which: usize) {
        let Parent { particle, has_placed, local } = self.parents.level[which];
        let parent = particle as usize;
        let FrontContext { probe, neighbours, particles, .. } = context;
        let radius = particles.radius[parent];
        let reach = self.rules.reach * radius;
        let patch = particles.patch_of(parent);
        let probe = &mut probe.on(patch);
        level.gather(particles, patch, particles.local[parent], |_| reach);
        let is_fine = level.rule.is_fine();
        if is_fine {
            level.drop_strangers(probe, particles, parent, 2.0 * radius);
        }
        // A particle gets its neighbour list when it places its children for the first time.
        debug_assert_eq!(has_placed, neighbours.len() > parent, "particle {parent}");
        let lists = (!has_placed).then_some(&mut **neighbours);
        let alone_on_sheet = self.around.read(level, lists, particles, parent, &self.rules) && !is_fine;

        let SlotFrame { n, u, w, .. } = SlotFrame::of(particles, parent, &level.along);
        let inherited = Vec2::new(local.slope.dot(u), local.slope.dot(w));
        let slope = self.around.ring.slope(u, w, radius, inherited);
        let frame = ParentFrame { radius, u, w, n, shape: shape_in(&local.curvature, u, w), slope };
        self.parents.level[which].local.slope = u * slope.x + w * slope.y;
        self.parents.level[which].has_placed = true;
        self.around.ring.find_arcs(&frame);
        self.around.begin_circle(!has_placed);
        self.predict_children(&frame, alone_on_sheet);
        self.fill_slots(level, context.particles, which, has_placed);
    }

    fn project_children(
        &mut self,
        level: &mut FrontLevel,
        context: &mut FrontContext,
        children: Range<usize>,
    ) {
        let (rules, sizing) = (&self.rules, context.sizing());
        let FrontContext { probe, particles, .. } = context;
        let probe = &mut probe.on(particles.patch_of(level.first_child + children.start));
        let tolerance = |radius| rules.tolerance(radius);
        let proposals = &self.proposals[children.clone()];
        self.solver.land(probe, sizing, proposals, &tolerance, &mut self.landings);
        for ((k, proposal), &landing) in children.zip(proposals).zip(&self.landings) {
            let mut landing = landing;
            if let ChildLanding::On(spot) = landing {
                let circle = &proposal.circle;
                let offset = spot.position - circle.centre;
                let pair = PointPair { offset, normal: circle.normal, other: spot.normal };
                if level.rule.is_fine() && !is_on_sheet(level.rule, probe, circle.centre, pair, circle.radius)
                {
                    landing = ChildLanding::NotConverged;
                } else {
                    let predicted = particles.radius[level.first_child + k];
                    self.growth = self.growth.max(spot.radius - predicted);
                }
            }
            level.note_landing(particles, k, landing);
        }
    }

    fn has_room(
        &mut self,
        level: &mut FrontLevel,
        context: &mut FrontContext,
        child: usize,
        spot: &SurfacePoint,
    ) -> bool {
        let FrontContext { probe, particles, .. } = context;
        let parent = self.parents.level[self.proposals[child].parent as usize];
        let provisional = level.first_child + child;
        let moved = (spot.position - particles.local[provisional]).length();
        let surprise = spot.radius - particles.radius[provisional];
        let grown = surprise.max(0.0) + self.growth;
        let clearance = level.children.list[child].clearance;
        let is_clear = clearance - moved - level.children.drift - self.rules.match_tolerance * grown > 0.0;
        if !is_clear && self.collides(level, probe, particles, spot, particles.patch_of(provisional)) {
            self.parents.note_seam(parent);
            return false;
        }
        let local = LocalShape { curvature: spot.curvature, slope: parent.local.slope };
        self.parents.born.push(local);
        if surprise.abs() > SURPRISE * spot.radius {
            self.parents.note_seam(parent);
            self.parents.note_seam(Parent { particle: level.settled as u32, has_placed: false, local });
        }
        level.filled += u64::from(self.fills > 0);
        true
    }

    fn end_level(&mut self, level: &FrontLevel) {
        self.parents.next_level(level.first_child);
        self.proposals.clear();
        self.growth = 0.0;
    }

    fn clear_level(&mut self) {
        self.parents.stop();
        self.proposals.clear();
        self.growth = 0.0;
    }

    fn truncate(&mut self, len: usize) {
        self.parents.truncate(len);
    }

    /// Begins a level with the parents of which a child collided.
    fn begin_filling(&mut self, level: &mut FrontLevel) -> bool {
        if self.fills >= MAX_FILLS || level.capped || !self.parents.fill() {
            return false;
        }
        self.fills += 1;
        level.begin();
        true
    }
}
