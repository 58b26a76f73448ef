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

pub(crate) mod gaps;
mod surroundings;

use crate::field::Field;
use crate::math::{Bounds, sort_few, tangent_frame};
use crate::particles::{Particles, SlotFate, Slots};
use crate::sampler::discovery::sheets::{MAX_LIFT, is_doubtful, is_near_own, is_one_sheet, lift};
use crate::sampler::fates::FateCounts;
use crate::sampler::front::uniform::gaps::SEAM;
use crate::sampler::front::uniform::surroundings::{MAX_RISE_SQ, Shape, Surroundings};
use crate::sampler::neighbours::constants::{
    CELL_PER_REACH, FULL_COSINE, GAUSSIAN_RANGE, GAUSSIAN_SKIN, LISTED_COSINE,
};
use crate::sampler::neighbours::packed::PackedNeighbours;
use crate::sampler::projection::{BATCH, Circle, Landing, Projector, Tolerance};
use crate::spatial::{CellGrid, CellHandle, Neighbour};
use glam::Vec3;

/// Directions of the six slots in the frame (V̂⁰, N̂ × V̂⁰): paper §4.2.
const SLOT_DIRECTION: [[f32; 2]; 6] = {
    const SIN_60: f32 = 0.866_025_4;
    [[1.0, 0.0], [0.5, SIN_60], [-0.5, SIN_60], [-1.0, 0.0], [-0.5, -SIN_60], [0.5, -SIN_60]]
};

/// Distance, as a share of the match radius, below which the direction between two particles tells nothing.
const RISE_SLACK: f32 = 0.5;

/// Room for the way from a provisional to a final place, in r. Children of smooth surfaces move by a hundredth of it; those
/// that move farther are compared again.
const DRIFT_ROOM: f32 = 0.2;

/// A free child on its way to the surface. Its provisional place stands in the particle columns.
#[derive(Clone, Copy, Debug)]
struct Child {
    circle: Circle,
    slot: u32,
    place: CellHandle,
    /// Distance to the nearest particle, of whatever sheet, when it was found free; at most what was looked at.
    clearance: f32,
}

/// What the front does next within a level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Find the free slots of particle `next`.
    Place,
    /// Project the children from `next` on.
    Project,
    /// Decide the final fate of child `next`.
    Settle,
}

/// The advancing front.
#[derive(Clone)]
pub(crate) struct UniformFront {
    radius: f32,
    match_radius: f32,
    tolerance: Tolerance,
    bounds: Bounds,
    max_particles: usize,
    pub(crate) grid: CellGrid,
    found: Vec<Neighbour>,
    around: Surroundings,
    stage: Stage,
    next: usize,
    seed_place: CellHandle,
    /// Particles of the level under way.
    level: core::ops::Range<usize>,
    /// Particles before this index are final; provisional children stand from here on.
    settled: usize,
    children: Vec<Child>,
    circles: Vec<Circle>,
    landings: Vec<Landing>,
    batch: Vec<Landing>,
    /// Largest distance between a provisional and a final place in this level.
    drift: f32,
    /// Particles with a slot taken by a particle far from it.
    pub(crate) seams: Vec<u32>,
    pub(crate) fates: FateCounts,
    pub(crate) capped: bool,
}

impl UniformFront {
    pub(crate) fn new() -> Self {
        Self {
            radius: 1.0,
            match_radius: 1.0,
            tolerance: Tolerance::default(),
            bounds: Bounds::cube(1.0),
            max_particles: 0,
            grid: CellGrid::new(1.0),
            found: Vec::new(),
            around: Surroundings::default(),
            stage: Stage::Place,
            next: 0,
            seed_place: CellHandle::default(),
            level: 0..0,
            settled: 0,
            children: Vec::new(),
            circles: Vec::with_capacity(BATCH),
            landings: Vec::new(),
            batch: Vec::with_capacity(BATCH),
            drift: 0.0,
            seams: Vec::new(),
            fates: FateCounts::default(),
            capped: false,
        }
    }

    /// Prepares for particles of one radius; `match_tolerance` is the match radius as a share of 2r.
    pub(crate) fn reset(
        &mut self,
        radius: f32,
        match_tolerance: f32,
        tolerance: Tolerance,
        bounds: &Bounds,
        max_particles: usize,
    ) {
        self.radius = radius;
        self.match_radius = 2.0 * radius * match_tolerance;
        self.tolerance = tolerance;
        self.bounds = *bounds;
        self.max_particles = max_particles;
        self.grid.reset(CELL_PER_REACH * self.reach());
        self.stage = Stage::Place;
        self.next = 0;
        self.level = 0..0;
        self.settled = 0;
        self.children.clear();
        self.landings.clear();
        self.drift = 0.0;
        self.seams.clear();
        self.fates = FateCounts::default();
        self.capped = false;
    }

    /// Everything that a child can collide with, and every neighbour that repels a particle, is within this distance.
    fn reach(&self) -> f32 {
        self.collision_reach().max((GAUSSIAN_RANGE + GAUSSIAN_SKIN) * self.radius)
    }

    /// Everything that a child can collide with is within this distance of its parent.
    fn collision_reach(&self) -> f32 {
        2.0 * self.radius + self.looked_at()
    }

    /// Distance around a provisional place within which every particle is looked at: the match radius, and what a child
    /// and its neighbours may move when they are projected.
    fn looked_at(&self) -> f32 {
        self.match_radius + DRIFT_ROOM * self.radius
    }

    /// Whether every particle has placed its children.
    pub(crate) fn is_done(&self) -> bool {
        self.level.is_empty()
    }

    /// Particles that are final.
    pub(crate) fn settled(&self) -> usize {
        self.settled
    }

    /// Whether a particle of the sheet of (`position`, `normal`) is within `distance` of it.
    pub(crate) fn is_covered(
        &mut self,
        field: &mut dyn Field,
        projector: &mut Projector,
        particles: &Particles,
        (position, normal): (Vec3, Vec3),
        distance: f32,
    ) -> bool {
        self.grid.gather(position, distance, &mut self.found);
        self.found.retain(|near| particles.normal[near.index as usize].dot(normal) > 0.0);
        let spacing = 2.0 * self.radius;
        is_near_own(field, projector, particles, (position, normal), &self.found, |_| spacing)
    }

    /// Particles within `distance` of `position` whose normals are within 90° of `normal`, nearest first, in `near`.
    pub(crate) fn near(
        &mut self,
        particles: &Particles,
        position: Vec3,
        normal: Vec3,
        distance: f32,
        near: &mut Vec<u32>,
    ) {
        self.grid.gather(position, distance, &mut self.found);
        self.found.retain(|found| particles.normal[found.index as usize].dot(normal) > 0.0);
        sort_few(&mut self.found, |a, b| (a.distance_sq, a.index) < (b.distance_sq, b.index));
        near.clear();
        near.extend(self.found.iter().map(|found| found.index));
    }

    /// Takes the last seed back if it stayed alone and any other particle, of whatever sheet, is within 2r: a lone
    /// particle there is the far side of something too small for the radius.
    pub(crate) fn drop_lone_seed(&mut self, pairs: &mut PackedNeighbours, particles: &mut Particles) {
        let last = particles.len() - 1;
        if particles.parent[last] == Particles::NO_PARENT {
            self.grid.gather(particles.position[last], 2.0 * self.radius, &mut self.found);
            if self.found.len() > 1 {
                self.grid.remove(self.seed_place);
                for k in 0..6 {
                    self.fates.uncount(particles.slots[last].get(k));
                }
                particles.truncate(last);
                self.seams.retain(|&i| (i as usize) < last);
                pairs.truncate(last);
                self.settled = last;
                self.level = last..last;
            }
        }
    }

    /// Adds a first particle. Only between levels.
    pub(crate) fn add_seed(&mut self, particles: &mut Particles, position: Vec3, normal: Vec3) {
        debug_assert!(self.is_done());
        let index = particles.len();
        self.seed_place = self.grid.insert(position, index as u32);
        particles.push(position, normal, self.radius, Particles::NO_PARENT, 0, Slots::default());
        self.level = index..index + 1;
        self.settled = index + 1;
        self.stage = Stage::Place;
        self.next = index;
    }

    /// Does up to `budget` units (a particle's slots, a child's projection, a child's fate) and returns what is left.
    pub(crate) fn step(
        &mut self,
        field: &mut dyn Field,
        projector: &mut Projector,
        pairs: &mut PackedNeighbours,
        particles: &mut Particles,
        mut budget: u32,
    ) -> u32 {
        while budget > 0 && !self.is_done() {
            match self.stage {
                Stage::Place => {
                    if self.next < self.level.end {
                        self.place_children(field, projector, pairs, particles, self.next);
                        self.next += 1;
                        budget -= 1;
                    } else {
                        (self.stage, self.next) = (Stage::Project, 0);
                        self.landings.clear();
                        self.drift = 0.0;
                    }
                }
                Stage::Project => {
                    let count = (self.children.len() - self.next).min(BATCH).min(budget as usize);
                    if count > 0 {
                        self.project_children(field, projector, particles, count);
                        self.next += count;
                        budget -= count as u32;
                    } else {
                        (self.stage, self.next) = (Stage::Settle, 0);
                    }
                }
                Stage::Settle => {
                    if self.next < self.children.len() {
                        self.settle_child(field, projector, particles, self.next);
                        self.next += 1;
                        budget -= 1;
                    } else {
                        particles.truncate(self.settled);
                        self.children.clear();
                        self.level = self.level.end..self.settled;
                        (self.stage, self.next) = (Stage::Place, self.level.start);
                        if self.capped {
                            self.level = self.settled..self.settled;
                        }
                    }
                }
            }
        }
        budget
    }

    /// Ends the front where it is: provisional children are dropped.
    pub(crate) fn stop(&mut self, particles: &mut Particles) {
        particles.truncate(self.settled);
        self.children.clear();
        self.level = self.settled..self.settled;
    }

    /// Finds the free slots of particle `parent` and enters a provisional child in each: paper §4.2 and §4.4.
    fn place_children(
        &mut self,
        field: &mut dyn Field,
        projector: &mut Projector,
        pairs: &mut PackedNeighbours,
        particles: &mut Particles,
        parent: usize,
    ) {
        let (p, n) = (particles.position[parent], particles.normal[parent]);
        let reach = self.reach();
        let mut found = core::mem::take(&mut self.found);
        self.grid.gather(p, reach, &mut found);
        let wary = self.read_surroundings(&found, pairs, particles, parent);
        if wary {
            self.drop_strangers(field, projector, particles, parent, &mut found);
        }

        let grandparent = particles.parent[parent];
        let is_seed = grandparent == Particles::NO_PARENT;
        let (u, w) = if is_seed {
            tangent_frame(n)
        } else {
            // Slot 0 of every particle but a seed is its parent (paper §4.4).
            let towards = particles.position[grandparent as usize] - p;
            let u = (towards - n * towards.dot(n)).normalize_or_zero();
            if u == Vec3::ZERO { tangent_frame(n) } else { (u, n.cross(u)) }
        };
        let shape =
            if is_seed { shape_at(field, p, u, w) } else { self.around.fit_shape(self.radius, n, u, w) };

        let (distance, slack_sq) = (2.0 * self.radius, self.slack_sq());
        let level = particles.level[parent] + 1;
        let mut slots = particles.slots[parent];
        let mut seam = false;
        if !is_seed {
            slots.set(0, SlotFate::Parent);
        }
        for (k, &[cos, sin]) in SLOT_DIRECTION.iter().enumerate().skip(usize::from(!is_seed)) {
            let direction = u * cos + w * sin;
            // The surface falls away by κ d²/2 in a distance d, hence sin θ = −κ_V r at d = 2r.
            let (su, sw) = (shape.a * cos + shape.b * sin, shape.b * cos + shape.c * sin);
            let curvature = su * cos + sw * sin;
            let sin_theta = (-curvature * self.radius).clamp(-0.9, 0.9);
            let cos_theta = (1.0 - sin_theta * sin_theta).sqrt();
            let offset = (direction * cos_theta + n * sin_theta) * distance;
            // The turn is tangential, so the sum is never shorter than n.
            let normal = n + (u * su + w * sw) * (distance * cos_theta);

            let (nearest_sq, any_sq) = self.around.nearest_sq(offset, normal, slack_sq);
            if nearest_sq <= self.match_radius * self.match_radius {
                seam |= nearest_sq > (SEAM * distance) * (SEAM * distance);
                slots.set(k, SlotFate::Matched);
                self.fates.count(SlotFate::Matched);
                continue;
            }
            if particles.len() >= self.max_particles {
                slots.set(k, SlotFate::Capped);
                self.fates.count(SlotFate::Capped);
                self.capped = true;
                continue;
            }
            let index = particles.len() as u32;
            let position = p + offset;
            let normal = normal.normalize_or(n);
            particles.push(position, normal, self.radius, parent as u32, level, initial_slots());
            self.children.push(Child {
                circle: Circle {
                    centre: p,
                    normal: n,
                    direction,
                    radius: distance,
                    guess: [cos_theta, sin_theta],
                },
                slot: k as u32,
                place: self.grid.insert(position, index),
                // Strangers have not been looked at.
                clearance: if wary { 0.0 } else { any_sq.sqrt().min(self.looked_at()) },
            });
            self.around.push(offset, normal, false);
        }
        if seam {
            self.seams.push(parent as u32);
        }
        particles.slots[parent] = slots;
        self.found = found;
    }

    /// Reads what was gathered around `parent`: what its children may collide with, and, into `pairs`, the particles
    /// before it that repel it. All of those are final, so the list is complete. Says whether some may be on another sheet
    /// that faces the same way.
    fn read_surroundings(
        &mut self,
        found: &[Neighbour],
        pairs: &mut PackedNeighbours,
        particles: &Particles,
        parent: usize,
    ) -> bool {
        let repulsion = (GAUSSIAN_RANGE + GAUSSIAN_SKIN) * self.radius;
        let normal = particles.normal[parent];
        self.around.clear();
        let mut is_weighted = false;
        pairs.push(found.iter().map(|near| {
            let j = near.index as usize;
            let other = particles.normal[j];
            self.around.push(near.offset, other, j < self.settled);
            let along = other.dot(normal);
            let is_listed = (j < parent) & (near.distance_sq <= repulsion * repulsion);
            is_weighted |= is_listed & (along < FULL_COSINE);
            (near.index, is_listed & (along > LISTED_COSINE))
        }));
        if is_weighted {
            found.iter().for_each(|near| pairs.note_weighted(near.index as usize));
        }
        let spacing = 2.0 * self.radius;
        // The normals of children under way are only predicted, but they belong to this front.
        self.around.are_doubtful(normal, spacing)
            && found.iter().any(|near| {
                let other = particles.normal[near.index as usize];
                (near.index as usize) < self.settled
                    && other.dot(normal) > 0.0
                    && is_doubtful(near.offset, normal, other, spacing)
            })
    }

    /// Takes the particles out of `found`, and of what children may collide with, that face the way of `parent` but are on
    /// another sheet. They stay in the lists of the relaxation, which knows no sheets beyond the normals.
    fn drop_strangers(
        &mut self,
        field: &mut dyn Field,
        projector: &mut Projector,
        particles: &Particles,
        parent: usize,
        found: &mut Vec<Neighbour>,
    ) {
        let (p, n) = (particles.position[parent], particles.normal[parent]);
        // Where there is another sheet, its particles far away to the side are as suspicious as those near by.
        let suspicious = 0.5 * MAX_LIFT * 2.0 * self.radius;
        found.retain(|near| {
            let other = particles.normal[near.index as usize];
            near.index as usize >= self.settled
                || other.dot(n) <= 0.0
                || lift(near.offset, n, other) <= suspicious
                || is_one_sheet(field, projector, (p, n), near.offset, other)
        });
        self.around.clear();
        for near in &*found {
            let j = near.index as usize;
            self.around.push(near.offset, particles.normal[j], j < self.settled);
        }
    }

    fn project_children(
        &mut self,
        field: &mut dyn Field,
        projector: &mut Projector,
        particles: &Particles,
        count: usize,
    ) {
        self.circles.clear();
        self.circles.extend(self.children[self.next..self.next + count].iter().map(|child| child.circle));
        let mut batch = core::mem::take(&mut self.batch);
        projector.land_on_circles(field, &self.circles, self.tolerance, &mut batch);
        for (k, landing) in batch.iter_mut().enumerate() {
            if let Landing::On { position, normal } = *landing {
                let Circle { centre, normal: above, .. } = self.circles[k];
                let offset = position - centre;
                // Round a rim or a thin sheet's edge: the other side is not a child's place.
                let is_stranger = normal.dot(above) <= 0.0
                    || is_doubtful(offset, above, normal, 2.0 * self.radius)
                        && !is_one_sheet(field, projector, (centre, above), offset, normal);
                if is_stranger {
                    *landing = Landing::NotConverged;
                    continue;
                }
                let provisional = particles.position[self.settled + self.next + k];
                self.drift = self.drift.max((position - provisional).length());
            }
        }
        self.landings.extend_from_slice(&batch);
        self.batch = batch;
    }

    /// Final fate of child `k` of the level, in queue order: paper §4.4, Algorithm 2.
    fn settle_child(
        &mut self,
        field: &mut dyn Field,
        projector: &mut Projector,
        particles: &mut Particles,
        k: usize,
    ) {
        let child = self.children[k];
        // Settled children close up over those that were not added.
        let provisional = self.level.end + k;
        let parent = particles.parent[provisional] as usize;
        let fate = match self.landings[k] {
            Landing::NotConverged => SlotFate::NotConverged,
            Landing::Undefined => SlotFate::Undefined,
            Landing::On { position, .. } if !self.bounds.contains(position) => SlotFate::Outside,
            Landing::On { position, normal } => {
                let moved = (position - particles.position[provisional]).length();
                // Nothing can be nearer than the clearance less what both have moved. The clearance is from all sheets:
                // the final normal may be that of another sheet than the provisional one.
                let safe = child.clearance - moved - self.drift > self.match_radius;
                if !safe && self.collides(field, projector, particles, (position, normal)) {
                    SlotFate::Matched
                } else {
                    let index = self.settled;
                    self.grid.update(child.place, position, index as u32);
                    particles.position[index] = position;
                    particles.normal[index] = normal;
                    particles.parent[index] = parent as u32;
                    self.settled += 1;
                    SlotFate::Added
                }
            }
        };
        if fate != SlotFate::Added {
            self.grid.remove(child.place);
        }
        self.fates.count(fate);
        particles.slots[parent].set(child.slot as usize, fate);
    }

    /// Squared slack of [`RISE_SLACK`].
    fn slack_sq(&self) -> f32 {
        (RISE_SLACK * self.match_radius) * (RISE_SLACK * self.match_radius)
    }

    /// Whether a particle at `offset` with the normal `other` belongs to the sheet of a point with the normal `normal`.
    fn same_sheet(&self, offset: Vec3, normal: Vec3, other: Vec3) -> bool {
        let rise = offset.dot(normal);
        normal.dot(other) > 0.0 && rise * rise <= MAX_RISE_SQ * (offset.length_squared() + self.slack_sq())
    }

    /// Whether a settled particle of the same sheet is within the match radius.
    fn collides(
        &mut self,
        field: &mut dyn Field,
        projector: &mut Projector,
        particles: &Particles,
        (position, normal): (Vec3, Vec3),
    ) -> bool {
        self.grid.gather(position, self.match_radius, &mut self.found);
        let mut near = core::mem::take(&mut self.found);
        near.retain(|near| {
            let j = near.index as usize;
            j < self.settled && self.same_sheet(near.offset, normal, particles.normal[j])
        });
        let spacing = 2.0 * self.radius;
        let collides = is_near_own(field, projector, particles, (position, normal), &near, |_| spacing);
        self.found = near;
        collides
    }
}

/// Second fundamental form at a seed, from the Hessian: [uᵀHu uᵀHw; · wᵀHw]/|∇f|.
fn shape_at(field: &mut dyn Field, p: Vec3, u: Vec3, w: Vec3) -> Shape {
    let jet = field.jet(p.as_dvec3());
    let (u, w) = (u.as_dvec3(), w.as_dvec3());
    let slope = jet.gradient.length();
    let entry = |a: glam::DVec3, b: glam::DVec3| {
        let k = (a.dot(jet.hessian.apply(b)) / slope) as f32;
        if k.is_finite() { k } else { 0.0 }
    };
    Shape { a: entry(u, u), b: entry(u, w), c: entry(w, w) }
}

/// Slots of a new particle: the parent's is known.
fn initial_slots() -> Slots {
    let mut slots = Slots::default();
    slots.set(0, SlotFate::Parent);
    slots
}
