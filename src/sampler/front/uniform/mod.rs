//! Uniform sampling, paper §4: a front of particles that places six children around each, 60° apart in the tangent
//! plane and 2r away on the surface, generation level by generation level.
//!
//! # Differs from the paper
//!
//! * The paper speaks of a stack of untreated particles; its rings (Fig. 11) are those of a queue, used here.
//! * "If an existing particle corresponds": a child corresponds when a particle of the same sheet is within the match
//!   radius, a share of 2r. The paper takes a matched particle out of the neighbours, so that two children cannot match
//!   it; here it stays, which makes the match radius a lower bound on all distances.
//! * A child is first placed on the circle by the curvature of the particles around its parent, without evaluating the
//!   field, and compared with the particles there at that place. Only a free child is projected, at about two
//!   evaluations, and then compared again at its final place. All free children of a level are projected together.

pub(super) mod gaps;
mod surroundings;

use crate::field::Field;
use crate::particles::{Particles, SlotFate};
use crate::sampler::front::level::{
    FrontContext, FrontLevel, FrontSetup, LevelFront, ProvisionalChildren, SlotFrame, initial_slots,
};
use crate::sampler::front::uniform::gaps::{SEAM, SeamPass};
use crate::sampler::front::uniform::surroundings::{SecondForm, Surroundings};
use crate::sampler::front::{MAX_DIP, SIN_60, UNCOVERED};
use crate::sampler::neighbours::constants::{
    CELL_PER_REACH, FULL_COSINE, GAUSSIAN_RANGE, GAUSSIAN_SKIN, LISTED_COSINE,
};
use crate::sampler::neighbours::grids::RadiusRange;
use crate::sampler::neighbours::packed::PackedNeighbours;
use crate::sampler::probe::Probe;
use crate::sampler::projection::{ChildCircle, CircleLanding, Tolerance, tolerance};
use crate::sampler::sheet::{OrientedPoint, PointPair, SheetRule, is_level, level_slack_sq};
use crate::spatial::{CellGrid, CellHandle, Neighbour};
use core::ops::Range;
use glam::Vec3;

/// Directions of the six slots in the frame (V̂⁰, N̂ × V̂⁰): paper §4.2.
const SLOT_DIRECTION: [[f32; 2]; 6] =
    [[1.0, 0.0], [0.5, SIN_60], [-0.5, SIN_60], [-1.0, 0.0], [-0.5, -SIN_60], [0.5, -SIN_60]];

/// Allowance for the distance between a provisional and a final place, in r. Children of smooth surfaces move by a hundredth
/// of it; those that move farther are compared again.
const DRIFT_ROOM: f32 = 0.2;

/// A child on its way to the surface. Its provisional place stands in the particle columns.
#[derive(Clone, Copy, Debug)]
struct UniformChild {
    circle: ChildCircle,
    slot: u32,
    handle: CellHandle,
    /// Distance to the nearest particle, of whatever sheet, when it was found free; at most the known reach.
    clearance: f32,
}

/// A predicted child, on the circle around its parent.
struct Prediction {
    /// Offset from the parent.
    offset: Vec3,
    /// Normal, of any length.
    normal: Vec3,
    /// cos θ and sin θ on the circle.
    turn: [f32; 2],
}

/// The front of particles of one radius.
#[derive(Clone, Default)]
pub(crate) struct UniformFront {
    radius: f32,
    match_radius: f32,
    tolerance: Tolerance,
    rule: SheetRule,
    level: FrontLevel,
    /// Particles of the level, which place children.
    parents: Range<usize>,
    children: ProvisionalChildren<UniformChild, ChildCircle, CircleLanding>,
    grid: CellGrid,
    /// Handle of the last seed in the grid.
    seed: CellHandle,
    /// The particles that the last query of the grid found.
    found: Vec<Neighbour>,
    around: Surroundings,
    gaps: SeamPass,
    /// Direction along the crease for each row of a particle on one.
    along: Vec<Vec3>,
}

impl UniformFront {
    /// Radius of the query around a parent: it covers every collision of a child and every neighbour that repels the parent.
    fn reach(&self) -> f32 {
        self.collision_reach().max((GAUSSIAN_RANGE + GAUSSIAN_SKIN) * self.radius)
    }

    /// Largest distance between a parent and a particle with which its children can collide.
    fn collision_reach(&self) -> f32 {
        2.0 * self.radius + self.known_reach()
    }

    /// Distance around a provisional place within which every particle is known: the match radius, and the distance that a child
    /// and its neighbours may move when they are projected.
    fn known_reach(&self) -> f32 {
        self.match_radius + DRIFT_ROOM * self.radius
    }

    /// Finds the particles of a patch within a distance of a place.
    fn gather(&mut self, particles: &Particles, patch: Option<u32>, place: Vec3, distance: f32) {
        self.grid.gather(place, distance, &mut self.found);
        if patch.is_some() {
            self.found.retain(|near| particles.is_on(near.index as usize, patch));
        }
    }

    /// Predicts the child of a parent in the direction (cos, sin) of its frame, on the circle of radius 2r around it.
    fn predict(&self, frame: &SlotFrame, form: &SecondForm, [cos, sin]: [f32; 2]) -> Prediction {
        let &SlotFrame { n, u, w, .. } = frame;
        let distance = 2.0 * self.radius;
        // The surface falls away by κ d²/2 in a distance d, hence sin θ = −κ_V r at d = 2r.
        let (su, sw) = (form.a * cos + form.b * sin, form.b * cos + form.c * sin);
        let curvature = su * cos + sw * sin;
        let sin_theta = (-curvature * self.radius).clamp(-MAX_DIP, MAX_DIP);
        let cos_theta = (1.0 - sin_theta * sin_theta).sqrt();
        let offset = ((u * cos + w * sin) * cos_theta + n * sin_theta) * distance;
        // The turn is tangential, so the sum is never shorter than n.
        let normal = n + (u * su + w * sw) * (distance * cos_theta);
        Prediction { offset, normal, turn: [cos_theta, sin_theta] }
    }

    /// Copies the particles `found` around `parent` to the surroundings, and those before it that repel it to its neighbour list.
    /// All of the latter are final, so the list is complete. Returns whether some may be on another sheet that faces the same
    /// way.
    fn read_surroundings(
        &mut self,
        found: &[Neighbour],
        neighbours: &mut PackedNeighbours,
        particles: &Particles,
        parent: usize,
    ) -> bool {
        let repulsion = (GAUSSIAN_RANGE + GAUSSIAN_SKIN) * self.radius;
        let normal = particles.normal[parent];
        self.around.clear();
        let mut is_weighted = false;
        neighbours.push(found.iter().map(|near| {
            let j = near.index as usize;
            let other = particles.normal[j];
            self.around.push(near.offset, other, j < self.level.settled);
            let along = other.dot(normal);
            let is_listed = (j < parent) & (near.distance_sq <= repulsion * repulsion);
            is_weighted |= is_listed & (along < FULL_COSINE);
            (near.index, is_listed & (along > LISTED_COSINE))
        }));
        if is_weighted {
            found.iter().for_each(|near| neighbours.note_weighted(near.index as usize));
        }
        let spacing = 2.0 * self.radius;
        // The normals of children under way are only predicted, but they belong to this front.
        (self.rule.is_fine() || self.around.are_doubtful(normal, spacing))
            && found.iter().any(|near| {
                let other = particles.normal[near.index as usize];
                let pair = PointPair { offset: near.offset, normal, other };
                (near.index as usize) < self.level.settled
                    && pair.faces_one_way()
                    && self.rule.is_doubtful(pair, spacing)
            })
    }

    /// Removes the particles on another sheet that face the same way as `parent` from `found` and from the surroundings. They
    /// stay in the neighbour lists of the relaxation, which tells sheets apart by the normals alone.
    fn drop_strangers(
        &mut self,
        probe: &mut Probe,
        particles: &Particles,
        parent: usize,
        found: &mut Vec<Neighbour>,
    ) {
        let parent = OrientedPoint::of(particles, parent);
        let suspicious = self.rule.suspicious(2.0 * self.radius);
        found.retain(|near| {
            let pair = parent.pair(near.offset, particles.normal[near.index as usize]);
            near.index as usize >= self.level.settled
                || !pair.faces_one_way()
                || pair.lift() <= suspicious
                || self.rule.is_one_sheet(probe, parent.position, pair)
        });
        self.around.clear();
        for near in &*found {
            let j = near.index as usize;
            self.around.push(near.offset, particles.normal[j], j < self.level.settled);
        }
    }

    /// Whether a final particle of the same sheet is within the match radius of a point on a patch.
    fn collides(
        &mut self,
        probe: &mut Probe,
        particles: &Particles,
        point: OrientedPoint,
        patch: Option<u32>,
    ) -> bool {
        self.gather(particles, patch, point.position, self.match_radius);
        self.found.retain(|near| {
            let pair = point.pair(near.offset, particles.normal[near.index as usize]);
            (near.index as usize) < self.level.settled
                && is_level(pair, near.offset.length_squared(), self.match_radius)
        });
        let spacing = 2.0 * self.radius;
        self.rule.is_near_own(probe, particles, point, &self.found, |_| spacing)
    }
}

impl LevelFront for UniformFront {
    fn rule(&self) -> SheetRule {
        self.rule
    }

    fn reset(&mut self, setup: &FrontSetup) {
        let &FrontSetup { settings, bounds, survey, radius, .. } = setup;
        self.radius = radius;
        self.match_radius = 2.0 * radius * settings.match_tolerance as f32;
        self.tolerance = tolerance(radius, survey.residual_limits(), survey.gradient_scale);
        self.rule = setup.rule(RadiusRange::of(radius));
        self.level = FrontLevel::new(*bounds, settings.max_particles as usize);
        self.parents = 0..0;
        self.children.clear();
        self.grid.reserve(setup.expected);
        self.grid.reset(CELL_PER_REACH * self.reach());
        self.gaps.clear();
        self.along.clear();
    }

    fn release(&mut self) {
        self.grid.release();
    }

    fn level(&self) -> &FrontLevel {
        &self.level
    }

    fn level_mut(&mut self) -> &mut FrontLevel {
        &mut self.level
    }

    fn parents(&self) -> usize {
        self.parents.len()
    }

    fn children(&self) -> usize {
        self.children.list.len()
    }

    // Paper §4.2 and §4.4.
    fn place_children(&mut self, context: &mut FrontContext, parent: usize) {
        let parent = self.parents.start + parent;
        let FrontContext { probe, neighbours, particles, .. } = context;
        let (p, level) = (particles.position[parent], particles.level[parent] + 1);
        let patch = particles.patch_of(parent);
        probe.select(patch);
        self.gather(particles, patch, p, self.reach());
        let mut found = core::mem::take(&mut self.found);
        let is_doubtful = self.read_surroundings(&found, neighbours, particles, parent);
        if is_doubtful {
            self.drop_strangers(probe, particles, parent, &mut found);
        }
        self.found = found;

        let frame = SlotFrame::of(particles, parent, &self.along);
        let &SlotFrame { n, u, w, is_seed } = &frame;
        let form = if is_seed {
            second_form_at(probe.field, p, u, w)
        } else {
            self.around.fit_second_form(self.radius, n, u, w)
        };
        let (distance, slack_sq) = (2.0 * self.radius, level_slack_sq(self.match_radius));
        let mut slots = particles.slots[parent];
        let mut is_seam = false;
        for (k, &direction) in SLOT_DIRECTION.iter().enumerate() {
            // Slot 0 of every particle but a seed is its parent; those of a tip are taken.
            if slots.get(k) != SlotFate::Open {
                continue;
            }
            let Prediction { offset, normal, turn } = self.predict(&frame, &form, direction);
            let (nearest_sq, any_sq) = self.around.nearest_sq(offset, normal, slack_sq);
            let is_matched = nearest_sq <= self.match_radius * self.match_radius;
            if is_matched || particles.len() >= self.level.max_particles {
                let fate = if is_matched { SlotFate::Matched } else { SlotFate::Capped };
                is_seam |= is_matched && nearest_sq > (SEAM * distance) * (SEAM * distance);
                self.level.capped |= !is_matched;
                slots.set(k, fate);
                self.level.fates.count(fate);
                continue;
            }
            let (index, position) = (particles.len() as u32, p + offset);
            let normal = normal.normalize_or(n);
            particles.push(position, normal, self.radius, parent as u32, level, initial_slots());
            let direction = u * direction[0] + w * direction[1];
            self.children.list.push(UniformChild {
                circle: ChildCircle { centre: p, normal: n, direction, radius: distance, guess: turn },
                slot: k as u32,
                handle: self.grid.insert(position, index),
                // The distances to the particles that were dropped are not known.
                clearance: if is_doubtful { 0.0 } else { any_sq.sqrt().min(self.known_reach()) },
            });
            self.around.push(offset, normal, false);
        }
        if is_seam {
            self.gaps.seams.push(parent as u32);
        }
        particles.slots[parent] = slots;
    }

    fn project_children(&mut self, context: &mut FrontContext, children: Range<usize>) {
        let FrontContext { probe, particles, .. } = context;
        probe.select(particles.patch_of(self.level.first_child + children.start));
        let ProvisionalChildren { list, landings, drift, problems, solutions } = &mut self.children;
        problems.clear();
        problems.extend(list[children.clone()].iter().map(|child| child.circle));
        probe.land_on_circles(problems, self.tolerance, solutions);
        for (k, landing) in solutions.iter_mut().enumerate() {
            // The circle may meet the far side of a rim or of a thin sheet, which is no place for a child.
            let (rule, spacing) = (self.rule, 2.0 * self.radius);
            let is_stranger = |probe: &mut Probe, position: Vec3, normal: Vec3| {
                let ChildCircle { centre, normal: above, .. } = problems[k];
                let pair = PointPair { offset: position - centre, normal: above, other: normal };
                !pair.faces_one_way()
                    || rule.is_doubtful(pair, spacing) && !rule.is_one_sheet(probe, centre, pair)
            };
            if let CircleLanding::On { position, normal } = *landing
                && is_stranger(probe, position, normal)
            {
                *landing = CircleLanding::NotConverged;
                if rule.is_fine() {
                    *landing = probe.walk(&problems[k], self.tolerance);
                    if let CircleLanding::On { position, normal } = *landing
                        && is_stranger(probe, position, normal)
                    {
                        *landing = CircleLanding::NotConverged;
                    }
                }
            }
            if let CircleLanding::On { position, .. } = *landing {
                let provisional = particles.position[self.level.first_child + children.start + k];
                *drift = drift.max((position - provisional).length());
            }
        }
        landings.extend_from_slice(solutions);
    }

    // Paper §4.4, Algorithm 2.
    fn settle_child(&mut self, context: &mut FrontContext, child: usize) {
        let FrontContext { probe, particles, .. } = context;
        let UniformChild { slot, handle, clearance, .. } = self.children.list[child];
        let provisional = self.level.first_child + child;
        let parent = particles.parent[provisional] as usize;
        let patch = particles.patch_of(provisional);
        probe.select(patch);
        let fate = match self.children.landings[child] {
            CircleLanding::NotConverged => SlotFate::NotConverged,
            CircleLanding::Undefined => SlotFate::Undefined,
            CircleLanding::On { position, .. }
                if !self.level.bounds.contains(position) || !probe.is_on_patch(position, patch) =>
            {
                SlotFate::Outside
            }
            CircleLanding::On { position, normal } => {
                let moved = (position - particles.position[provisional]).length();
                // No particle is nearer than the clearance minus the distances that both have moved. The clearance counts all
                // sheets, because the final normal may belong to another sheet than the provisional one.
                let is_clear = clearance - moved - self.children.drift > self.match_radius;
                if !is_clear && self.collides(probe, particles, OrientedPoint { position, normal }, patch) {
                    SlotFate::Matched
                } else {
                    let index = self.level.settled;
                    self.grid.update(handle, position, index as u32);
                    particles.position[index] = position;
                    particles.normal[index] = normal;
                    particles.parent[index] = parent as u32;
                    particles.set_patch(index, patch);
                    self.level.settled += 1;
                    SlotFate::Added
                }
            }
        };
        if fate != SlotFate::Added {
            self.grid.remove(handle);
        }
        self.level.fates.count(fate);
        particles.slots[parent].set(slot as usize, fate);
    }

    fn end_level(&mut self) {
        self.parents = self.level.first_child..self.level.settled;
        self.children.clear();
    }

    fn clear_level(&mut self) {
        self.parents = 0..0;
        self.children.clear();
    }

    fn add_seed(&mut self, context: &mut FrontContext, seed: OrientedPoint, patch: Option<u32>) -> bool {
        let OrientedPoint { position, normal } = seed;
        debug_assert!(self.is_done(), "a seed is added between two levels");
        let index = context.particles.len();
        self.seed = self.grid.insert(position, index as u32);
        context.particles.push_seed(position, normal, self.radius, patch);
        self.parents = index..index + 1;
        self.level.settled = index + 1;
        self.level.begin();
        true
    }

    fn add_creases(&mut self, context: &mut FrontContext, along: &[Vec3]) {
        self.along.extend_from_slice(along);
        for (&position, i) in context.particles.position.iter().zip(0..) {
            self.grid.insert(position, i);
        }
        self.level.settled = context.particles.len();
        self.parents = 0..self.level.settled;
        self.level.count_known(&context.particles.slots);
        self.level.begin();
    }

    fn is_seed_crowded(&mut self, particles: &Particles) -> bool {
        let last = particles.len() - 1;
        self.grid.gather(particles.position[last], 2.0 * self.radius, &mut self.found);
        self.found.len() > 1
    }

    fn forget_seed(&mut self, seed: usize) {
        self.grid.remove(self.seed);
        self.gaps.seams.retain(|&i| (i as usize) < seed);
    }

    fn within(&mut self, position: Vec3, distance: f32) -> &[Neighbour] {
        self.grid.gather(position, distance, &mut self.found);
        &self.found
    }

    fn gather_cover(
        &mut self,
        particles: &Particles,
        point: OrientedPoint,
        patch: Option<u32>,
    ) -> &mut Vec<Neighbour> {
        self.gather(particles, patch, point.position, UNCOVERED * self.radius);
        self.found.retain(|near| particles.normal[near.index as usize].dot(point.normal) > 0.0);
        &mut self.found
    }

    fn begin_filling(&mut self) -> bool {
        !self.gaps.is_done()
    }

    fn fill(&mut self, context: &mut FrontContext, budget: u32) -> u32 {
        self.fill_gaps(context, budget)
    }

    fn is_filled(&self) -> bool {
        self.gaps.is_done()
    }

    fn filled(&self) -> u64 {
        self.gaps.filled
    }
}

/// Second fundamental form at a seed, from the Hessian: [uᵀHu uᵀHw; · wᵀHw]/|∇f|.
fn second_form_at(field: &mut dyn Field, p: Vec3, u: Vec3, w: Vec3) -> SecondForm {
    let jet = field.jet(p.as_dvec3());
    let (u, w) = (u.as_dvec3(), w.as_dvec3());
    let slope = jet.gradient.length();
    let entry = |a: glam::DVec3, b: glam::DVec3| {
        let k = (a.dot(jet.hessian.apply(b)) / slope) as f32;
        if k.is_finite() { k } else { 0.0 }
    };
    SecondForm { a: entry(u, u), b: entry(u, w), c: entry(w, w) }
}
