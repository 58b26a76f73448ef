//! The front of a run: the uniform one of paper §4 or the adaptive one of §5, and what fills the
//! gaps behind it.
//!
//! A front grows in generation levels (`methods::grow`). Every parent of a level predicts its
//! children, which get provisional places in the particle columns. All children are projected onto
//! the surface, a batch at a time: this is where the front differs from the paper, which projects
//! them one by one. Their fates are then decided in the order of the queue, and those that are
//! placed close up over those that are not. The two kinds of front differ in how they place
//! children ([`Placing`]).

mod adaptive;
mod level;
mod plan;
mod uniform;

pub(crate) use level::{FrontContext, is_on_sheet};
pub(crate) use plan::FrontPlan;
pub(crate) use uniform::gaps::widest_gap;

use crate::math::{SQRT_3, sort_few};
use crate::particles::{OrientedPoint, Particles, SlotFate, Slots};
use crate::sampler::discovery::survey::Survey;
use crate::sampler::front::adaptive::AdaptivePlacing;
use crate::sampler::front::level::{ChildLanding, FrontLevel, Placing};
use crate::sampler::front::uniform::UniformPlacing;
use crate::sampler::neighbours::grids::GridHandle;
use crate::sampler::probe::{BATCH, Probe};
use crate::sampler::settings::Sampling;
use crate::sampler::sheet::{UNCOVERED, is_cover};
use crate::spatial::Neighbour;
use glam::Vec3;

/// Largest sine of the angle by which the way to a child is predicted to dip below the tangent
/// plane, or to rise above it. Beyond it the radius does not resolve the curvature. Smaller leaves
/// wider holes, and so does a value close to 1.
const MAX_DIP: f32 = 0.9;

/// Sine of 60°.
const SIN_60: f32 = 0.5 * SQRT_3 as f32;

/// A front of either kind. The kind that does not work keeps its memory.
#[derive(Clone, Default)]
pub(crate) struct Front {
    sampling: Sampling,
    level: FrontLevel,
    /// Handle of the last seed in the grids.
    seed: GridHandle,
    uniform: UniformPlacing,
    adaptive: AdaptivePlacing,
}

impl Front {
    /// Prepares the front of a plan, with room for so many particles, and forgets an earlier one.
    pub(crate) fn reset(&mut self, plan: &FrontPlan, survey: &Survey, room: usize) {
        self.sampling = if plan.sizing.is_some() { Sampling::Adaptive } else { Sampling::Uniform };
        self.level = FrontLevel {
            bounds: plan.bounds,
            max_particles: plan.max_particles,
            rule: plan.rule(survey),
            grids: core::mem::take(&mut self.level.grids),
            ..FrontLevel::default()
        };
        let (level, placing) = self.parts();
        placing.reset(level, plan, survey, room);
    }

    /// Gives back the memory that only the fronts need.
    pub(crate) fn release(&mut self) {
        self.level.grids.release();
        self.adaptive.release();
    }

    /// The state of the level, and the kind of front that works.
    fn parts(&mut self) -> (&mut FrontLevel, &mut dyn Placing) {
        match self.sampling {
            Sampling::Uniform => (&mut self.level, &mut self.uniform),
            Sampling::Adaptive => (&mut self.level, &mut self.adaptive),
        }
    }

    /// The state of the front within its level.
    pub(crate) fn level(&self) -> &FrontLevel {
        &self.level
    }

    /// Notes that the limit on particles was reached.
    pub(crate) fn cap(&mut self) {
        self.level.capped = true;
    }

    /// Number of parents in the level.
    fn parents(&self) -> usize {
        match self.sampling {
            Sampling::Uniform => self.uniform.parents(),
            Sampling::Adaptive => self.adaptive.parents(),
        }
    }

    /// Whether every particle has placed its children.
    pub(crate) fn is_done(&self) -> bool {
        self.parents() == 0
    }

    /// Predicts the children of each parent of the level (paper §4.2), as far as `left` of a budget
    /// allows. Says whether the last parent has predicted its own.
    pub(crate) fn place_children(&mut self, context: &mut FrontContext, left: &mut u32) -> bool {
        while self.level.next < self.parents() && *left > 0 {
            let (level, placing) = self.parts();
            placing.place_children(level, context, level.next);
            level.next += 1;
            *left -= 1;
        }
        let parents = self.parents();
        self.level.has_reached(parents)
    }

    /// Projects the children of the level onto the surface (paper §4.3), as far as `left` of a
    /// budget allows. Says whether all are projected.
    pub(crate) fn project_children(&mut self, context: &mut FrontContext, left: &mut u32) -> bool {
        let children = self.level.children.list.len();
        while self.level.next < children && *left > 0 {
            let next = self.level.next;
            let most = (children - next).min(BATCH).min(*left as usize);
            let count = self.on_one_patch(context.particles, next, most);
            let (level, placing) = self.parts();
            placing.project_children(level, context, next..next + count);
            level.next += count;
            *left -= count as u32;
        }
        self.level.has_reached(children)
    }

    /// Decides the fates of the children of the level (paper §4.4), as far as `left` of a budget
    /// allows. Says whether the level is at its end; those that were placed are the next parents.
    pub(crate) fn settle_children(&mut self, context: &mut FrontContext, left: &mut u32) -> bool {
        let children = self.level.children.list.len();
        let (level, placing) = self.parts();
        while level.next < children && *left > 0 {
            settle_child(level, placing, context, level.next);
            level.next += 1;
            *left -= 1;
        }
        let is_done = level.has_reached(children);
        if is_done {
            context.particles.truncate(level.settled);
            placing.end_level(level);
            level.children.clear();
            if level.capped {
                placing.clear_level();
            }
            level.begin();
        }
        is_done
    }

    /// Number of children from child `first` on, `most` at most, that lie on one patch.
    fn on_one_patch(&self, particles: &Particles, first: usize, most: usize) -> usize {
        let first = self.level.first_child + first;
        let patch = particles.patch_of(first);
        let is_on = |&k: &usize| particles.is_on(first + k, patch);
        if patch.is_none() { most } else { (0..most).take_while(is_on).count() }
    }

    /// Ends the front where it is: what is not final is dropped.
    pub(crate) fn stop(&mut self, particles: &mut Particles) {
        let (level, placing) = self.parts();
        particles.truncate(level.settled);
        placing.clear_level();
        level.children.clear();
    }

    /// Adds a seed on a patch, between two levels. Says whether it could: an adaptive one needs a
    /// curvature.
    pub(crate) fn add_seed(
        &mut self,
        context: &mut FrontContext,
        seed: OrientedPoint,
        patch: Option<u32>,
    ) -> bool {
        let OrientedPoint { position, normal } = seed;
        debug_assert!(self.is_done(), "a seed is added between two levels");
        let index = context.particles.len();
        let (level, placing) = self.parts();
        let radius = context.on(patch, |context| placing.add_parent(context, position, index));
        if radius.is_nan() || radius <= 0.0 {
            placing.clear_level();
            return false;
        }
        let handle = level.grids.insert(position, radius, index as u32);
        context.particles.push_seed(position, normal, radius, patch);
        level.settled = index + 1;
        level.begin();
        self.seed = handle;
        true
    }

    /// Takes in the rows of the particles on creases, which are the only ones so far: they are the
    /// parents of the first level. Each has a direction along its crease in `along`.
    pub(crate) fn add_creases(&mut self, context: &mut FrontContext, along: &[Vec3]) {
        let (level, placing) = self.parts();
        level.along.extend_from_slice(along);
        for i in 0..context.particles.len() {
            let position = context.particles.local[i];
            let patch = context.particles.patch_of(i);
            context.on(patch, |context| placing.add_parent(context, position, i));
            level.grids.insert(position, context.particles.radius[i], i as u32);
        }
        level.settled = context.particles.len();
        // The slots of tips are taken.
        let slots = context.particles.slots.iter();
        let fates = slots.flat_map(|slots| (0..Slots::COUNT).map(|k| slots.get(k)));
        fates.for_each(|fate| level.fates.count(fate));
        level.begin();
    }

    /// Whether the last seed stayed alone and touches another particle, of whatever sheet: it is
    /// the far side of something too small for the radius.
    pub(crate) fn has_lone_seed(&mut self, particles: &Particles) -> bool {
        let is_seed = particles.parent.last() == Some(&Particles::NO_PARENT);
        if !is_seed || particles.len() <= particles.twins.len() {
            return false;
        }
        let last = particles.len() - 1;
        let radius = particles.radius[last];
        let FrontLevel { grids, found, .. } = &mut self.level;
        grids.gather(particles.local[last], |largest| radius + largest, found);
        found.iter().any(|near| {
            let j = near.index as usize;
            j != last && near.distance_sq.sqrt() <= radius + particles.radius[j]
        })
    }

    /// Takes the last seed back, which stayed alone.
    pub(crate) fn drop_last_seed(&mut self, context: &mut FrontContext) {
        let last = context.particles.len() - 1;
        let seed = self.seed;
        let (level, placing) = self.parts();
        level.grids.remove(seed);
        placing.truncate(last);
        for k in 0..Slots::COUNT {
            level.fates.uncount(context.particles.slots[last].get(k));
        }
        level.settled = last;
        context.particles.truncate(last);
        context.neighbours.truncate(last);
    }

    /// The particles within a distance of a place, of whatever sheet.
    pub(crate) fn within(&mut self, position: Vec3, distance: f32) -> &[Neighbour] {
        let FrontLevel { grids, found, .. } = &mut self.level;
        grids.gather(position, |_| distance, found);
        found
    }

    /// Collects the particles on the patch of a `point` that face the same way and are so near that
    /// no front need start there.
    fn gather_cover(&mut self, particles: &Particles, point: OrientedPoint, patch: Option<u32>) {
        self.level.gather(particles, patch, point.position, |largest| UNCOVERED * largest);
        self.level.found.retain(|near| is_cover(particles, near, point.normal));
    }

    /// Whether a particle of the sheet of a `point` is so near that no front need start there.
    /// `patch` is that of the point.
    pub(crate) fn is_covered(
        &mut self,
        probe: &mut Probe,
        particles: &Particles,
        point: OrientedPoint,
        patch: Option<u32>,
    ) -> bool {
        self.gather_cover(particles, point, patch);
        let spacing = |j: usize| 2.0 * particles.radius[j];
        self.level.rule.is_near_own(probe, particles, point, &self.level.found, spacing)
    }

    /// The particles on the patch of a `point` that face the same way and are so near that no front
    /// need start there, the nearest first.
    pub(crate) fn list_cover(
        &mut self,
        particles: &Particles,
        point: OrientedPoint,
        patch: Option<u32>,
    ) -> Vec<u32> {
        self.gather_cover(particles, point, patch);
        let found = &mut self.level.found;
        sort_few(found, |a, b| (a.distance_sq, a.index) < (b.distance_sq, b.index));
        found.iter().map(|found| found.index).collect()
    }

    /// Goes on to the gaps, once the surface is covered; false if there is none to fill.
    pub(crate) fn begin_filling(&mut self) -> bool {
        let (level, placing) = self.parts();
        placing.begin_filling(level)
    }

    /// Fills gaps, as far as `left` of a budget allows. Says whether that is all: an adaptive front
    /// grows into its gaps.
    pub(crate) fn fill(&mut self, context: &mut FrontContext, left: &mut u32) -> bool {
        if self.sampling == Sampling::Uniform {
            *left = self.uniform.fill_gaps(&mut self.level, context, *left);
        }
        true
    }
}

/// Decides the fate of a child (paper §4.4, Algorithm 2).
fn settle_child(level: &mut FrontLevel, placing: &mut dyn Placing, context: &mut FrontContext, child: usize) {
    let patch = context.particles.patch_of(level.first_child + child);
    context.on(patch, |context| settle_on_patch(level, placing, context, child, patch));
}

fn settle_on_patch(
    level: &mut FrontLevel,
    placing: &mut dyn Placing,
    context: &mut FrontContext,
    child: usize,
    patch: Option<u32>,
) {
    let level::Child { slot, handle, .. } = level.children.list[child];
    let provisional = level.first_child + child;
    let parent = context.particles.parent[provisional];
    let landing = level.children.landings[child];
    let fate = match landing {
        ChildLanding::NotConverged => SlotFate::NotConverged,
        ChildLanding::Undefined => SlotFate::Undefined,
        ChildLanding::On(spot)
            if !level.bounds.contains(spot.position)
                || !context.probe.is_on_patch(spot.position, spot.normal, spot.radius, patch) =>
        {
            SlotFate::Outside
        }
        ChildLanding::On(spot) if placing.has_room(level, context, child, &spot) => {
            let (index, particles) = (level.settled, &mut *context.particles);
            level.grids.update(handle, spot.position, spot.radius, index as u32);
            particles.local[index] = spot.position;
            particles.normal[index] = spot.normal;
            particles.radius[index] = spot.radius;
            particles.parent[index] = parent;
            particles.level[index] = particles.level[provisional];
            particles.set_patch(index, patch);
            level.settled += 1;
            SlotFate::Added
        }
        ChildLanding::On(_) => SlotFate::Matched,
    };
    if fate != SlotFate::Added {
        level.grids.remove(handle);
    }
    level.fates.count(fate);
    context.particles.slots[parent as usize].set(slot as usize, fate);
}
