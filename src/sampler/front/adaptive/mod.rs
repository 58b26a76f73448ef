//! Adaptive sampling, paper §5: a front of particles of different radii. Each places its children in the free arcs between
//! the particles around it, so that they touch it, generation level by generation level.
//!
//! # Differs from the paper
//!
//! * As in the uniform front, a queue takes the place of the stack.
//! * The children of a whole level are first placed by prediction: on the surface by the parent's curvature, with the
//!   radius that the gradient of the neighbours' radii predicts. They are then projected together. Their fates are decided one
//!   by one in the order of the queue, at their final places.
//! * The children of an arc share its slack evenly; in the paper the last one gets it all.
//! * A particle whose child collided with another one places children a second time once the front is done.

mod arcs;
mod parents;
mod placement;
mod prediction;
mod vicinity;

use crate::particles::{Particles, SlotFate};
use crate::sampler::front::UNCOVERED;
use crate::sampler::front::adaptive::arcs::ParentFrame;
use crate::sampler::front::adaptive::parents::{LocalShape, Parent, Parents, shape_in};
use crate::sampler::front::adaptive::placement::{DirectLanding, DirectPlacement, Proposal, SurfacePoint};
use crate::sampler::front::adaptive::vicinity::Vicinity;
use crate::sampler::front::level::{
    FrontContext, FrontLevel, FrontSetup, LevelFront, ProvisionalChildren, SlotFrame,
};
use crate::sampler::neighbours::constants::{OVERLAP_RANGE, OVERLAP_SKIN};
use crate::sampler::neighbours::grids::{GridHandle, RadiusGrids};
use crate::sampler::probe::Probe;
use crate::sampler::projection::{ResidualLimits, Tolerance, tolerance};
use crate::sampler::sheet::{OrientedPoint, PointPair, SheetRule, is_level};
use crate::spatial::Neighbour;
use core::ops::Range;
use glam::{Vec2, Vec3};

/// Radius of the query around a parent, in its radii: it covers every collision of a child of usual size, 2 + 2 × 0.7, and some
/// more. The second ring of a lattice is at 3.46.
const REACH: f32 = 3.7;

/// Particles within this share of r_i + r_j enter each other's neighbour lists for the relaxation.
const LISTED: f32 = 0.5 * (OVERLAP_RANGE + OVERLAP_SKIN);

/// Neighbours within this share of r_i + r_j count as touching: they get one of the parent's slots. It moves no particle.
const TOUCHING: f32 = 1.25;

/// Neighbours within this many radii enter the fit of the radius's gradient: those between the rings of a lattice, which are at 2
/// and at 3.46. From 2.2 to 3.5 the figures of random surfaces are the same within 2 %.
const RING: f32 = 2.8;

/// A child and its parent take part in the filling if the child's radius differs from the prediction by more than this share:
/// the radii around them are known by then. On creased surfaces the holes beside small particles are 1 % narrower so.
const SURPRISE: f32 = 0.1;

/// Largest number of rounds of filling. On creased surfaces the largest hole is 3 % narrower with them. Two place as many
/// particles on most, but not on all; eight place no more.
const MAX_FILLS: u32 = 4;

/// Bound for the slope of the radius along the way to a child, above the steepest grading that a run may ask for: only where the
/// law jumps is the slope so large.
const MAX_SLOPE: f32 = 0.7;

/// A child on its way to the surface. Its provisional place stands in the particle columns.
#[derive(Clone, Copy, Debug)]
struct AdaptiveChild {
    proposal: Proposal,
    slot: u32,
    handle: GridHandle,
    /// Number of the parent in the level.
    parent: u32,
    /// Distance to the nearest collision when it was predicted.
    clearance: f32,
}

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
    sheets: SheetRule,
}

impl FrontRules {
    /// Tolerance for a particle of this radius.
    fn tolerance(&self, radius: f32) -> Tolerance {
        tolerance(radius, self.residual_limits, self.gradient_scale)
    }
}

/// The front of particles of different radii.
#[derive(Clone, Default)]
pub(crate) struct AdaptiveFront {
    rules: FrontRules,
    level: FrontLevel,
    parents: Parents,
    children: ProvisionalChildren<AdaptiveChild, Proposal, DirectLanding>,
    /// Largest increase of a radius in this level when its child was projected.
    growth: f32,
    grids: RadiusGrids,
    /// Handle of the last seed in the grids.
    seed: GridHandle,
    /// The particles that the last query of the grids found.
    found: Vec<Neighbour>,
    around: Vicinity,
    solver: DirectPlacement,
    /// Rounds of filling so far, and particles placed in them.
    fills: u32,
    filled: u64,
    /// Direction along the crease for each row of a particle on one.
    along: Vec<Vec3>,
}

impl AdaptiveFront {
    /// Makes a child a particle at its final place, unless another particle is in its way.
    fn settle_at(&mut self, context: &mut FrontContext, child: usize, spot: SurfacePoint) -> SlotFate {
        let FrontContext { probe, particles, .. } = context;
        let AdaptiveChild { handle, parent, clearance, .. } = self.children.list[child];
        let parent = self.parents.level[parent as usize];
        let provisional = self.level.first_child + child;
        let moved = (spot.position - particles.position[provisional]).length();
        let grown = (spot.radius - particles.radius[provisional]).max(0.0) + self.growth;
        let room = clearance - moved - self.children.drift - self.rules.match_tolerance * grown;
        let is_clear = room > 0.0;
        if !is_clear && self.collides(probe, particles, &spot, particles.patch_of(provisional)) {
            self.parents.note_seam(parent);
            return SlotFate::Matched;
        }
        let index = self.level.settled;
        let surprise = spot.radius - particles.radius[provisional];
        let local = LocalShape { curvature: spot.curvature, slope: parent.local.slope };
        self.parents.born.push(local);
        if surprise.abs() > SURPRISE * spot.radius {
            self.parents.note_seam(parent);
            self.parents.note_seam(Parent { particle: index as u32, has_placed: false, local });
        }
        self.grids.update(handle, spot.position, spot.radius, index as u32);
        particles.position[index] = spot.position;
        particles.normal[index] = spot.normal;
        particles.radius[index] = spot.radius;
        particles.parent[index] = particles.parent[provisional];
        particles.level[index] = particles.level[provisional];
        particles.set_patch(index, particles.patch_of(provisional));
        self.level.settled += 1;
        self.filled += u64::from(self.fills > 0);
        SlotFate::Added
    }

    /// Whether a settled particle of the same sheet is nearer to a place on a patch than the match tolerance allows.
    fn collides(
        &mut self,
        probe: &mut Probe,
        particles: &Particles,
        spot: &SurfacePoint,
        patch: Option<u32>,
    ) -> bool {
        let sheets = self.rules.sheets;
        let share = self.rules.match_tolerance;
        self.grids.gather(spot.position, |largest| share * (spot.radius + largest), &mut self.found);
        let settled = self.level.settled;
        self.found.iter().any(|near| {
            let j = near.index as usize;
            let both = spot.radius + particles.radius[j];
            let limit = share * both;
            let pair = PointPair { offset: near.offset, normal: spot.normal, other: particles.normal[j] };
            j < settled
                && particles.is_on(j, patch)
                && near.distance_sq <= limit * limit
                && is_level(pair, near.distance_sq, limit)
                && (!sheets.is_fine() || is_on_sheet(sheets, probe, spot.position, pair))
        })
    }

    /// Removes the particles on another sheet that faces the same way as `parent` from those found around it.
    fn drop_strangers(&self, context: &mut FrontContext, parent: usize, found: &mut Vec<Neighbour>) {
        let FrontContext { probe, particles, .. } = context;
        let from = OrientedPoint::of(particles, parent);
        let (sheets, settled) = (self.rules.sheets, self.level.settled);
        found.retain(|near| {
            let j = near.index as usize;
            let pair = from.pair(near.offset, particles.normal[j]);
            j == parent
                || j >= settled
                || !pair.faces_one_way()
                || is_on_sheet(sheets, probe, from.position, pair)
        });
    }
}

impl LevelFront for AdaptiveFront {
    fn rule(&self) -> SheetRule {
        self.rules.sheets
    }

    fn reset(&mut self, setup: &FrontSetup) {
        let &FrontSetup { settings, bounds, survey, radii, .. } = setup;
        let grading = settings.grading as f32;
        // Neighbours that touch differ by this factor at most.
        let ratio = (1.0 + grading) / (1.0 - grading);
        self.rules = FrontRules {
            grading,
            match_tolerance: settings.match_tolerance as f32,
            reach: REACH.max(LISTED * (1.0 + ratio)),
            residual_limits: survey.residual_limits(),
            gradient_scale: survey.gradient_scale,
            sheets: setup.rule(radii),
        };
        self.level = FrontLevel::new(*bounds, settings.max_particles as usize);
        self.parents.clear();
        self.children.clear();
        self.growth = 0.0;
        self.grids.reset(radii, self.rules.reach);
        (self.fills, self.filled) = (0, 0);
        self.along.clear();
    }

    fn release(&mut self) {
        self.grids.release();
        self.parents = Parents::default();
    }

    fn level(&self) -> &FrontLevel {
        &self.level
    }

    fn level_mut(&mut self) -> &mut FrontLevel {
        &mut self.level
    }

    fn parents(&self) -> usize {
        self.parents.level.len()
    }

    fn children(&self) -> usize {
        self.children.list.len()
    }

    /// Finds the free arcs of the parent and enters provisional children in each.
    fn place_children(&mut self, context: &mut FrontContext, which: usize) {
        let Parent { particle, has_placed, local } = self.parents.level[which];
        let parent = particle as usize;
        let particles = &*context.particles;
        let radius = particles.radius[parent];
        let reach = self.rules.reach * radius;
        let mut found = core::mem::take(&mut self.found);
        let patch = particles.patch_of(parent);
        context.probe.select(patch);
        self.grids.gather(particles.position[parent], |_| reach, &mut found);
        if patch.is_some() {
            found.retain(|near| particles.is_on(near.index as usize, patch));
        }
        let is_fine = self.rules.sheets.is_fine();
        if is_fine {
            self.drop_strangers(context, parent, &mut found);
        }
        let particles = &*context.particles;
        // A particle gets its neighbour list when it places its children for the first time.
        debug_assert_eq!(has_placed, context.neighbours.len() > parent, "particle {parent}");
        let lists = (!has_placed).then_some(&mut *context.neighbours);
        let alone_on_sheet =
            self.around.read(&found, lists, particles, parent, &self.rules, self.level.settled) && !is_fine;

        let SlotFrame { n, u, w, .. } = SlotFrame::of(particles, parent, &self.along);
        let inherited = Vec2::new(local.slope.dot(u), local.slope.dot(w));
        let slope = self.around.ring.slope(u, w, radius, inherited);
        let frame = ParentFrame { radius, u, w, n, shape: shape_in(&local.curvature, u, w), slope };
        self.parents.level[which].local.slope = u * slope.x + w * slope.y;
        self.parents.level[which].has_placed = true;
        self.around.ring.find_arcs(&frame);
        self.found = found;
        self.around.begin_circle(!has_placed);
        self.predict_children(&frame, alone_on_sheet);
        self.fill_slots(context.particles, which, has_placed);
    }

    fn project_children(&mut self, context: &mut FrontContext, children: Range<usize>) {
        context.probe.select(context.particles.patch_of(self.level.first_child + children.start));
        let ProvisionalChildren { list, landings, drift, problems, solutions } = &mut self.children;
        problems.clear();
        problems.extend(list[children.clone()].iter().map(|child| child.proposal));
        let (rules, sizing) = (&self.rules, context.sizing());
        let tolerance = |radius| rules.tolerance(radius);
        self.solver.land(context.probe, sizing, problems, &tolerance, solutions);
        for (k, landing) in solutions.iter_mut().enumerate() {
            if let DirectLanding::On(spot) = landing {
                let circle = &problems[k].circle;
                let offset = spot.position - circle.centre;
                let pair = PointPair { offset, normal: circle.normal, other: spot.normal };
                if rules.sheets.is_fine() && !is_on_sheet(rules.sheets, context.probe, circle.centre, pair) {
                    *landing = DirectLanding::NotConverged;
                    continue;
                }
                let provisional = self.level.first_child + children.start + k;
                let moved = (spot.position - context.particles.position[provisional]).length();
                *drift = drift.max(moved);
                self.growth = self.growth.max(spot.radius - context.particles.radius[provisional]);
            }
        }
        landings.extend_from_slice(solutions);
    }

    fn settle_child(&mut self, context: &mut FrontContext, child: usize) {
        let AdaptiveChild { slot, handle, .. } = self.children.list[child];
        let provisional = self.level.first_child + child;
        let (parent, patch) =
            (context.particles.parent[provisional], context.particles.patch_of(provisional));
        context.probe.select(patch);
        let fate = match self.children.landings[child] {
            DirectLanding::NotConverged => SlotFate::NotConverged,
            DirectLanding::Undefined => SlotFate::Undefined,
            DirectLanding::On(spot)
                if !self.level.bounds.contains(spot.position)
                    || !context.probe.is_on_patch(spot.position, patch) =>
            {
                SlotFate::Outside
            }
            DirectLanding::On(spot) => self.settle_at(context, child, spot),
        };
        if fate != SlotFate::Added {
            self.grids.remove(handle);
        }
        self.level.fates.count(fate);
        context.particles.slots[parent as usize].set(slot as usize, fate);
    }

    fn end_level(&mut self) {
        self.parents.next_level(self.level.first_child);
        self.children.clear();
        self.growth = 0.0;
    }

    fn clear_level(&mut self) {
        self.parents.stop();
        self.children.clear();
        self.growth = 0.0;
    }

    fn add_seed(&mut self, context: &mut FrontContext, seed: OrientedPoint, patch: Option<u32>) -> bool {
        let OrientedPoint { position, normal } = seed;
        debug_assert!(self.is_done(), "a seed is added between two levels");
        let sizing = context.sizing();
        let spot = self.solver.look(context.probe, sizing, position);
        if spot.radius.is_nan() || spot.radius <= 0.0 {
            return false;
        }
        let index = context.particles.len();
        self.seed = self.grids.insert(position, spot.radius, index as u32);
        context.particles.push_seed(position, normal, spot.radius, patch);
        self.parents.add(index as u32, LocalShape { curvature: spot.curvature, slope: Vec3::ZERO });
        self.level.settled = index + 1;
        self.level.begin();
        true
    }

    fn add_creases(&mut self, context: &mut FrontContext, along: &[Vec3]) {
        self.along.extend_from_slice(along);
        let sizing = context.sizing();
        for i in 0..context.particles.len() {
            context.probe.select(context.particles.patch_of(i));
            let spot = self.solver.look(context.probe, sizing, context.particles.position[i]);
            self.grids.insert(context.particles.position[i], context.particles.radius[i], i as u32);
            self.parents.add(i as u32, LocalShape { curvature: spot.curvature, slope: Vec3::ZERO });
        }
        self.level.settled = context.particles.len();
        self.level.count_known(&context.particles.slots);
        self.level.begin();
    }

    fn is_seed_crowded(&mut self, particles: &Particles) -> bool {
        let last = particles.len() - 1;
        let radius = particles.radius[last];
        self.grids.gather(particles.position[last], |largest| radius + largest, &mut self.found);
        self.found.iter().any(|near| {
            let (j, d) = (near.index as usize, near.distance_sq.sqrt());
            j != last && d <= radius + particles.radius[j]
        })
    }

    fn forget_seed(&mut self, seed: usize) {
        self.grids.remove(self.seed);
        self.parents.truncate(seed);
    }

    fn within(&mut self, position: Vec3, distance: f32) -> &[Neighbour] {
        self.grids.gather(position, |_| distance, &mut self.found);
        &self.found
    }

    fn gather_cover(
        &mut self,
        particles: &Particles,
        point: OrientedPoint,
        patch: Option<u32>,
    ) -> &mut Vec<Neighbour> {
        self.grids.gather(point.position, |largest| UNCOVERED * largest, &mut self.found);
        self.found.retain(|near| {
            let j = near.index as usize;
            let reach = UNCOVERED * particles.radius[j];
            particles.is_on(j, patch)
                && particles.normal[j].dot(point.normal) > 0.0
                && near.distance_sq <= reach * reach
        });
        &mut self.found
    }

    /// Begins a level with the parents of which a child collided.
    fn begin_filling(&mut self) -> bool {
        if self.fills >= MAX_FILLS || self.level.capped || !self.parents.fill() {
            return false;
        }
        self.fills += 1;
        self.level.begin();
        true
    }

    fn fill(&mut self, context: &mut FrontContext, budget: u32) -> u32 {
        self.step(context, budget)
    }

    fn is_filled(&self) -> bool {
        self.is_done()
    }

    fn filled(&self) -> u64 {
        self.filled
    }
}

/// Whether two points that face the same way, the first at `position`, lie on one sheet: the pair is not doubtful, or the field
/// between them says so.
fn is_on_sheet(sheets: SheetRule, probe: &mut Probe, position: Vec3, pair: PointPair) -> bool {
    pair.lift() <= sheets.suspicious(0.0) || sheets.is_one_sheet(probe, position, pair)
}
