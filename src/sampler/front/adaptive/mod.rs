//! Adaptive sampling, paper §5: a front of particles of different radii. Each places its children in the free arcs between
//! the particles around it, so that they touch it, generation level by generation level.
//!
//! # Differs from the paper
//!
//! * As in the uniform front, a queue takes the place of the stack.
//! * The children of a whole level are first placed by prediction: on the surface by the parent's curvature, with the
//!   radius that the neighbours' radii foretell. They are then projected together, and their fates decided one by one in the
//!   order of the queue, at their final places.
//! * The children of an arc share its slack evenly; in the paper the last one gets it all.
//! * A particle whose child was lost to another one looks for room a second time once the front is done.

mod arcs;
mod parents;
mod placement;
mod pushing;

use self::parents::{Bend, Parent, Parents, shape_in};
use crate::field::Field;
use crate::math::functions::atan2;
use crate::math::{Bounds, sort_few, tangent_frame};
use crate::particles::{Particles, SlotFate, Slots};
use crate::sampler::discovery::sheets::is_near_own;
use crate::sampler::fates::FateCounts;
use crate::sampler::front::adaptive::arcs::{Base, Guess, MAX_CHILDREN, Ring, Room};
use crate::sampler::front::adaptive::placement::{Landed, Placement, Proposal, Spot};
use crate::sampler::neighbours::constants::{FULL_COSINE, LISTED_COSINE, OVERLAP_RANGE, OVERLAP_SKIN};
use crate::sampler::neighbours::grids::{GridHandle, RadiusGrids};
use crate::sampler::neighbours::packed::PackedNeighbours;
use crate::sampler::projection::{BATCH, Circle, Landing, Projector, tolerance};
use crate::sampler::settings::{Placement as Method, Settings};
use crate::sampler::sizing::Sizing;
use crate::spatial::Neighbour;
use crate::trace::{Event, Step, Trace};
use core::f32::consts::TAU;
use glam::{Vec2, Vec3};

/// Everything that a child of usual size can collide with is within this many radii of the parent; the second ring of a
/// lattice is at 3.46.
const REACH: f32 = 3.7;

/// Particles within this share of r_i + r_j are listed for the relaxation.
const LISTED: f32 = 0.5 * (OVERLAP_RANGE + OVERLAP_SKIN);

/// Neighbours within this share of r_i + r_j count as touching.
const TOUCHING: f32 = 1.25;

/// Neighbours within this many radii tell the gradient of the radius.
const RING: f32 = 2.8;

/// Two particles belong to one sheet if their normals are within 90° and one rises from the other's tangent plane by
/// no more than 45°, give or take [`RISE_SLACK`]: this is sin² 45°.
const MAX_RISE_SQ: f32 = 0.5;

/// Distance, as a share of r_i + r_j, below which the direction between two particles tells nothing.
const RISE_SLACK: f32 = 0.35;

/// Slots of a particle, at most.
const SLOTS: usize = 10;

/// A child whose radius was foretold worse than this has it and its parent look again for room, when the radii around are
/// known.
const SURPRISE: f32 = 0.1;

/// Rounds in which particles that lost a child look for room again.
const MAX_FILLS: u32 = 4;

/// A child on its way to the surface. Its provisional place stands in the particle columns.
#[derive(Clone, Copy, Debug)]
struct Child {
    proposal: Proposal,
    slot: u32,
    /// Number among the children of its parent.
    number: u32,
    held: GridHandle,
    /// Place of its parent in the level.
    of: u32,
    /// Distance to the nearest collision when it was placed.
    clearance: f32,
}

/// Someone on the circle around a parent.
#[derive(Clone, Copy, Debug)]
struct Occupant {
    /// Direction in the tangent plane, from 0 to 2π.
    angle: f32,
    what: What,
}

/// What is known of an occupant.
#[derive(Clone, Copy, Debug)]
enum What {
    /// A particle that was there, or a child whose fate is known.
    Known(SlotFate),
    /// A child to be projected, with its number and its distance to the nearest collision.
    Child(Guess, u32, f32),
}

/// What the front does next within a level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Find the free arcs of parent `next`.
    Place,
    /// Project the children from `next` on.
    Project,
    /// Decide the final fate of child `next`.
    Settle,
}

/// What a front works with and on, besides itself.
pub(crate) struct Surface<'a> {
    pub(crate) field: &'a mut dyn Field,
    pub(crate) projector: &'a mut Projector,
    /// The radius field, which adaptive fronts need.
    pub(crate) sizing: Option<&'a Sizing>,
    pub(crate) pairs: &'a mut PackedNeighbours,
    pub(crate) particles: &'a mut Particles,
}

impl<'a> Surface<'a> {
    fn sizing(&self) -> &'a Sizing {
        self.sizing.expect("an adaptive run begins with a radius field")
    }
}

/// The advancing front.
#[derive(Clone)]
pub(crate) struct AdaptiveFront {
    method: Method,
    grading: f32,
    match_tolerance: f32,
    resolution: f32,
    gradient_scale: f32,
    bounds: Bounds,
    max_particles: usize,
    grids: RadiusGrids,
    /// Radii of the parent within which others are gathered.
    reach: f32,
    found: Vec<Neighbour>,
    ring: Ring,
    /// Places in the ring of those that touch the parent, but for the one that placed it.
    touching: Vec<u32>,
    circle: Vec<Occupant>,
    /// Children of the present parent so far, placed or not.
    born: u32,
    /// Position of the present parent.
    origin: Vec3,
    stage: Stage,
    next: usize,
    seed_place: GridHandle,
    parents: Parents,
    /// Particles before the level under way.
    first: usize,
    /// Particles before this index are final; provisional children stand from here on.
    settled: usize,
    children: Vec<Child>,
    proposals: Vec<Proposal>,
    landings: Vec<Landed>,
    batch: Vec<Landed>,
    landing: Vec<Landing>,
    placement: Placement,
    /// Largest distance between a provisional and a final place in this level, and by how much a radius grew.
    drift: f32,
    growth: f32,
    fills: u32,
    /// What is noted of a particle that is followed.
    pub(crate) trace: Trace,
    /// Particles placed since the filling began.
    pub(crate) filled: u64,
    pub(crate) fates: FateCounts,
    pub(crate) capped: bool,
}

impl AdaptiveFront {
    pub(crate) fn new() -> Self {
        Self {
            method: Method::Direct,
            grading: 0.2,
            match_tolerance: 0.7,
            resolution: 0.0,
            gradient_scale: 1.0,
            bounds: Bounds::cube(1.0),
            max_particles: 0,
            grids: RadiusGrids::new(),
            reach: REACH,
            found: Vec::new(),
            ring: Ring::default(),
            touching: Vec::new(),
            circle: Vec::new(),
            born: 0,
            origin: Vec3::ZERO,
            stage: Stage::Place,
            next: 0,
            seed_place: GridHandle::default(),
            parents: Parents::default(),
            first: 0,
            settled: 0,
            children: Vec::new(),
            proposals: Vec::with_capacity(BATCH),
            landings: Vec::new(),
            batch: Vec::with_capacity(BATCH),
            landing: Vec::new(),
            placement: Placement::new(),
            drift: 0.0,
            growth: 0.0,
            fills: 0,
            trace: Trace::default(),
            filled: 0,
            fates: FateCounts::default(),
            capped: false,
        }
    }

    /// Prepares for particles of radii from `radii[0]` to `radii[1]`; `resolution` and `gradient_scale` are what the survey
    /// found.
    pub(crate) fn reset(
        &mut self,
        settings: &Settings,
        radii: [f32; 2],
        (resolution, gradient_scale): (f32, f32),
        bounds: &Bounds,
    ) {
        self.grading = settings.grading as f32;
        self.method = settings.placement;
        self.match_tolerance = settings.match_tolerance as f32;
        self.resolution = resolution;
        self.gradient_scale = gradient_scale;
        self.bounds = *bounds;
        self.max_particles = settings.max_particles as usize;
        self.filled = 0;
        // Neighbours that touch differ by this factor at most.
        let ratio = (1.0 + settings.grading as f32) / (1.0 - settings.grading as f32);
        self.reach = REACH.max(LISTED * (1.0 + ratio));
        self.grids.reset(radii[0], radii[1], self.reach);
        self.stage = Stage::Place;
        self.next = 0;
        self.parents.clear();
        self.first = 0;
        self.settled = 0;
        self.children.clear();
        self.landings.clear();
        self.fills = 0;
        self.trace.clear();
        self.fates = FateCounts::default();
        self.capped = false;
    }

    /// Whether every particle has placed its children.
    pub(crate) fn is_done(&self) -> bool {
        self.parents.level.is_empty()
    }

    /// Particles that are final.
    pub(crate) fn settled(&self) -> usize {
        self.settled
    }

    /// Gives back what only the front needs.
    pub(crate) fn release(&mut self) {
        self.grids.release();
        self.parents = Parents::default();
    }

    /// Whether a particle of the sheet of (`position`, `normal`) is within `share` of its own radii.
    pub(crate) fn is_covered(
        &mut self,
        field: &mut dyn Field,
        projector: &mut Projector,
        particles: &Particles,
        (position, normal): (Vec3, Vec3),
        share: f32,
    ) -> bool {
        self.gather_cover(particles, position, normal, share);
        let spacing = |j: usize| 2.0 * particles.radius[j];
        is_near_own(field, projector, particles, (position, normal), &self.found, spacing)
    }

    /// Those particles, nearest first, in `near`.
    pub(crate) fn near(
        &mut self,
        particles: &Particles,
        position: Vec3,
        normal: Vec3,
        share: f32,
        near: &mut Vec<u32>,
    ) {
        self.gather_cover(particles, position, normal, share);
        sort_few(&mut self.found, |a, b| (a.distance_sq, a.index) < (b.distance_sq, b.index));
        near.clear();
        near.extend(self.found.iter().map(|found| found.index));
    }

    fn gather_cover(&mut self, particles: &Particles, position: Vec3, normal: Vec3, share: f32) {
        self.grids.gather(position, |largest| share * largest, &mut self.found);
        self.found.retain(|near| {
            let j = near.index as usize;
            let reach = share * particles.radius[j];
            particles.normal[j].dot(normal) > 0.0 && near.distance_sq <= reach * reach
        });
    }

    /// Takes the last seed back if it stayed alone and touches another particle, of whatever sheet: see the uniform front.
    pub(crate) fn drop_lone_seed(&mut self, pairs: &mut PackedNeighbours, particles: &mut Particles) {
        let last = particles.len() - 1;
        if particles.parent[last] != Particles::NO_PARENT {
            return;
        }
        let radius = particles.radius[last];
        self.grids.gather(particles.position[last], |largest| radius + largest, &mut self.found);
        let touches = self.found.iter().any(|near| {
            let (j, d) = (near.index as usize, near.distance_sq.sqrt());
            j != last && d <= radius + particles.radius[j]
        });
        if touches {
            self.grids.remove(self.seed_place);
            for k in 0..SLOTS {
                self.fates.uncount(particles.slots[last].get(k));
            }
            particles.truncate(last);
            self.parents.truncate(last);
            pairs.truncate(last);
            self.settled = last;
        }
    }

    /// Adds a first particle. Only between levels. Says whether the place has a radius.
    pub(crate) fn add_seed(&mut self, surface: &mut Surface, position: Vec3, normal: Vec3) -> bool {
        debug_assert!(self.is_done());
        let sizing = surface.sizing();
        let spot = self.placement.look(surface.field, surface.projector, sizing, position);
        if spot.radius.is_nan() || spot.radius <= 0.0 {
            return false;
        }
        let index = surface.particles.len();
        self.seed_place = self.grids.insert(position, spot.radius, index as u32);
        surface.particles.push(position, normal, spot.radius, Particles::NO_PARENT, 0, Slots::default());
        let bend = Bend { curvature: spot.curvature, slope: Vec3::ZERO };
        self.parents.add(index as u32, bend);
        self.settled = index + 1;
        self.begin_level();
        true
    }

    fn begin_level(&mut self) {
        self.first = self.settled;
        (self.stage, self.next) = (Stage::Place, 0);
    }

    /// Has the particles that lost a child look for room again; false if there is nothing more to do.
    pub(crate) fn fill(&mut self) -> bool {
        if self.fills >= MAX_FILLS || self.capped || !self.parents.fill() {
            return false;
        }
        self.fills += 1;
        self.begin_level();
        true
    }

    /// Does up to `budget` units (a particle's arcs, a child's projection, a child's fate) and returns what is left.
    pub(crate) fn step(&mut self, surface: &mut Surface, mut budget: u32) -> u32 {
        while budget > 0 && !self.is_done() {
            match self.stage {
                Stage::Place => {
                    if self.next < self.parents.level.len() {
                        self.place_children(surface, self.next);
                        self.next += 1;
                        budget -= 1;
                    } else {
                        (self.stage, self.next) = (Stage::Project, 0);
                        self.landings.clear();
                        (self.drift, self.growth) = (0.0, 0.0);
                    }
                }
                Stage::Project => {
                    let count = (self.children.len() - self.next).min(BATCH).min(budget as usize);
                    if count > 0 {
                        self.project_children(surface, count);
                        self.next += count;
                        budget -= count as u32;
                    } else {
                        (self.stage, self.next) = (Stage::Settle, 0);
                    }
                }
                Stage::Settle => {
                    if self.next < self.children.len() {
                        self.settle_child(surface.particles, self.next);
                        self.next += 1;
                        budget -= 1;
                    } else {
                        surface.particles.truncate(self.settled);
                        self.children.clear();
                        self.parents.next_level(self.first);
                        if self.capped {
                            self.parents.stop();
                        }
                        self.begin_level();
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
        self.parents.stop();
    }

    /// Finds the free arcs of parent `which` of the level and enters provisional children in each.
    fn place_children(&mut self, surface: &mut Surface, which: usize) {
        let Parent { particle, bend, .. } = self.parents.level[which];
        let parent = particle as usize;
        let particles = &*surface.particles;
        let (p, n, radius) = (particles.position[parent], particles.normal[parent], particles.radius[parent]);
        let reach = self.reach * radius;
        let mut found = core::mem::take(&mut self.found);
        self.grids.gather(p, |_| reach, &mut found);
        // Every particle gets its list when it places its children for the first time.
        let again = surface.pairs.len() > parent;
        let alone_on_sheet = self.read_surroundings(&found, surface.pairs, particles, parent);

        self.origin = p;
        let grandparent = particles.parent[parent];
        let is_seed = grandparent == Particles::NO_PARENT;
        let (u, w) = if is_seed {
            tangent_frame(n)
        } else {
            let towards = particles.position[grandparent as usize] - p;
            let u = (towards - n * towards.dot(n)).normalize_or_zero();
            if u == Vec3::ZERO { tangent_frame(n) } else { (u, n.cross(u)) }
        };
        let mut base = Base { radius, u, w, n, shape: [0.0; 3], slope: Vec2::ZERO };
        if self.method == Method::Direct {
            base.shape = shape_in(&bend.curvature, u, w);
            let inherited = bend.slope;
            base.slope = self.ring.slope(u, w, radius, Vec2::new(inherited.dot(u), inherited.dot(w)));
            self.parents.level[which].bend.slope = u * base.slope.x + w * base.slope.y;
        }
        self.parents.level[which].has_placed = true;
        self.ring.find_arcs(&base);
        if self.trace.follows(parent as u32) {
            self.note_surroundings(&found, particles, parent, &base);
        }

        self.circle.clear();
        self.born = 0;
        if !again {
            for k in 0..self.touching.len() {
                let angle = self.ring.angle(self.touching[k] as usize);
                let angle = if angle < 0.0 { angle + TAU } else { angle };
                self.enter(Occupant { angle, what: What::Known(SlotFate::Matched) });
            }
        }
        match self.method {
            Method::Direct => self.predict_children(parent, &base, alone_on_sheet),
            Method::Faithful => self.push_children(surface, parent, &base),
        }
        self.fill_slots(surface.particles, parent, again);
        self.found = found;
    }

    /// Spreads children over the free arcs, by prediction.
    fn predict_children(&mut self, parent: usize, base: &Base, alone_on_sheet: bool) {
        let id = parent as u32;
        for k in 0..self.ring.arcs.len() {
            let arc = self.ring.arcs[k];
            let count = self.ring.spread(base, arc).len();
            for m in 0..count {
                let angle = self.ring.children[m];
                let mut guess = base.child_at(angle, f32::INFINITY);
                let limits = |ring: &Ring, guess: &Guess| {
                    ring.limits(guess.offset, guess.radius, self.match_tolerance, self.grading)
                };
                let (mut room, largest) = limits(&self.ring, &guess);
                if guess.radius > largest {
                    guess = base.child_at(angle, largest);
                    (room, _) = limits(&self.ring, &guess);
                }
                guess.largest = largest.min(base.radius + self.grading * guess.distance);
                // The gathered particles are those within the reach; beyond it anything may be.
                let seen =
                    self.reach * base.radius - guess.distance - 2.0 * self.match_tolerance * guess.radius;
                let clearance = if alone_on_sheet { room.min(seen) } else { 0.0 };
                let turn = if angle < 0.0 { TAU } else { 0.0 } - if angle >= TAU { TAU } else { 0.0 };
                let fits = room >= 0.0;
                let what = if fits {
                    What::Child(guess, self.born, clearance)
                } else {
                    What::Known(SlotFate::Matched)
                };
                self.enter(Occupant { angle: angle + turn, what });
                if self.trace.follows(id) {
                    let Room { phi, tau } = self.ring.room(base, arc, m, guess.radius);
                    let position = self.origin + guess.offset;
                    let radius = guess.radius;
                    self.trace.note_child(id, self.born, || Step::Start { position, radius });
                    self.trace.note_child(id, self.born, || Step::Room { phi_rad: phi, tau_rad: tau });
                    if !fits {
                        let (fate, particle) = (SlotFate::Matched, Particles::NO_PARENT);
                        self.trace.note_child(id, self.born, || Step::Fate { fate, particle });
                    }
                }
                self.born += 1;
                if fits {
                    self.ring.push(guess.offset, guess.radius, false);
                }
            }
        }
    }

    /// Notes a parent that is followed and what was gathered around it.
    fn note_surroundings(&mut self, found: &[Neighbour], particles: &Particles, parent: usize, base: &Base) {
        let position = particles.position[parent];
        self.trace.note(parent as u32, || Event::Parent {
            position,
            normal: base.n,
            radius: base.radius,
            zero: base.u,
        });
        for near in found {
            let j = near.index as usize;
            let radius = particles.radius[j];
            if j != parent && same_sheet(near, base.n, particles.normal[j], base.radius + radius) {
                self.trace.note(parent as u32, || Event::Neighbour {
                    particle: near.index,
                    position: particles.position[j],
                    radius,
                    angle_rad: atan2(near.offset.dot(base.w), near.offset.dot(base.u)),
                });
            }
        }
    }

    /// Enters an occupant of the circle around a parent in the order of the angles.
    fn enter(&mut self, occupant: Occupant) {
        let mut at = self.circle.len();
        self.circle.push(occupant);
        while at > 0 && self.circle[at - 1].angle > occupant.angle {
            self.circle.swap(at, at - 1);
            at -= 1;
        }
    }

    /// Gives every occupant of the circle a slot, and the children a provisional place. A parent that looks for room `again`
    /// keeps the slots it has filled.
    fn fill_slots(&mut self, particles: &mut Particles, parent: usize, again: bool) {
        let mut slots = particles.slots[parent];
        let was_there = |what: What| matches!(what, What::Known(SlotFate::Matched));
        let mut children = self.circle.iter().filter(|occupant| !was_there(occupant.what)).count();
        // A bit for every slot given out here.
        let mut given = 0_u32;
        if !again && particles.parent[parent] != Particles::NO_PARENT {
            slots.set(0, SlotFate::Parent);
            given = 1;
        }
        for k in 0..self.circle.len() {
            let what = self.circle[k].what;
            children -= usize::from(!was_there(what));
            // Where there are more occupants than slots, those that were there before stand back.
            if was_there(what) && (again || given.count_ones() as usize + children >= SLOTS) {
                continue;
            }
            let is = |k: usize, fate| given >> k & 1 == 0 && slots.get(k) == fate;
            let Some(slot) = (0..SLOTS)
                .find(|&k| is(k, SlotFate::Open))
                .or_else(|| (0..SLOTS).rev().find(|&k| is(k, SlotFate::Matched)))
            else {
                break;
            };
            given |= 1 << slot;
            self.fates.uncount(slots.get(slot));
            let fate = match what {
                What::Known(fate) => fate,
                What::Child(..) if particles.len() >= self.max_particles => {
                    self.capped = true;
                    SlotFate::Capped
                }
                What::Child(guess, number, clearance) => {
                    self.enter_child(particles, parent, slot as u32, (guess, number, clearance));
                    SlotFate::Open
                }
            };
            slots.set(slot, fate);
            self.fates.count(fate);
        }
        particles.slots[parent] = slots;
    }

    /// Gives a child its provisional place.
    fn enter_child(
        &mut self,
        particles: &mut Particles,
        parent: usize,
        slot: u32,
        (guess, number, clearance): (Guess, u32, f32),
    ) {
        let index = particles.len() as u32;
        let (centre, normal) = (particles.position[parent], particles.normal[parent]);
        let position = centre + guess.offset;
        let level = particles.level[parent] + 1;
        particles.push(position, guess.normal, guess.radius, parent as u32, level, initial_slots());
        let circle =
            Circle { centre, normal, direction: guess.direction, radius: guess.distance, guess: guess.turn };
        self.children.push(Child {
            proposal: Proposal {
                circle,
                parent_radius: particles.radius[parent],
                slope: guess.slope,
                largest: guess.largest,
            },
            slot,
            number,
            held: self.grids.insert(position, guess.radius, index),
            of: self.next as u32,
            clearance,
        });
    }

    /// Reads what was gathered around `parent`: into the ring what its children may collide with, and into `pairs` the
    /// particles before it that repel it. All of those are final, so the list is complete. Says whether all that was found
    /// is of the parent's sheet.
    fn read_surroundings(
        &mut self,
        found: &[Neighbour],
        pairs: &mut PackedNeighbours,
        particles: &Particles,
        parent: usize,
    ) -> bool {
        let (normal, radius) = (particles.normal[parent], particles.radius[parent]);
        let settled = self.settled;
        let exact_sq = (RING * radius) * (RING * radius);
        let grandparent = particles.parent[parent];
        self.ring.clear();
        self.touching.clear();
        let mut alone = true;
        let mut is_weighted = false;
        let list = found.iter().map(|near| {
            let j = near.index as usize;
            if j == parent {
                return (near.index, false);
            }
            let (other, both) = (particles.normal[j], radius + particles.radius[j]);
            if same_sheet(near, normal, other, both) {
                if near.distance_sq <= (TOUCHING * both) * (TOUCHING * both) && near.index != grandparent {
                    self.touching.push(self.ring.len() as u32);
                }
                self.ring.push(near.offset, particles.radius[j], j < settled && near.distance_sq <= exact_sq);
            } else {
                alone = false;
            }
            let reach = LISTED * both;
            let along = other.dot(normal);
            let is_listed = (j < parent) & (near.distance_sq <= reach * reach);
            is_weighted |= is_listed & (along < FULL_COSINE);
            (near.index, is_listed & (along > LISTED_COSINE))
        });
        if pairs.len() == parent {
            pairs.push(list);
            if is_weighted {
                found.iter().for_each(|near| pairs.note_weighted(near.index as usize));
            }
        } else {
            list.for_each(drop);
        }
        alone
    }

    fn project_children(&mut self, surface: &mut Surface, count: usize) {
        self.proposals.clear();
        self.proposals.extend(self.children[self.next..self.next + count].iter().map(|child| child.proposal));
        let (resolution, gradient_scale) = (self.resolution, self.gradient_scale);
        let sizing = surface.sizing();
        self.placement.land(
            surface.field,
            surface.projector,
            sizing,
            &self.proposals,
            &|radius| tolerance(radius, resolution, gradient_scale),
            &mut self.batch,
        );
        for (k, landing) in self.batch.iter().enumerate() {
            if let Landed::On(spot) = landing {
                let provisional = self.first + self.next + k;
                let moved = (spot.position - surface.particles.position[provisional]).length();
                self.drift = self.drift.max(moved);
                self.growth = self.growth.max(spot.radius - surface.particles.radius[provisional]);
            }
        }
        self.landings.extend_from_slice(&self.batch);
    }

    /// Final fate of child `k` of the level, in queue order.
    fn settle_child(&mut self, particles: &mut Particles, k: usize) {
        let child = self.children[k];
        // Settled children close up over those that were not added.
        let provisional = self.first + k;
        let parent = particles.parent[provisional];
        let fate = match self.landings[k] {
            Landed::NotConverged => SlotFate::NotConverged,
            Landed::Undefined => SlotFate::Undefined,
            Landed::On(spot) if !self.bounds.contains(spot.position) => SlotFate::Outside,
            Landed::On(spot) => {
                let moved = (spot.position - particles.position[provisional]).length();
                let grown = (spot.radius - particles.radius[provisional]).max(0.0) + self.growth;
                let safe = child.clearance - moved - self.drift - self.match_tolerance * grown > 0.0;
                if !safe && self.collides(particles, spot.position, spot.normal, spot.radius) {
                    self.parents.note_seam(self.parents.level[child.of as usize]);
                    SlotFate::Matched
                } else {
                    let index = self.settled;
                    let surprise = spot.radius - particles.radius[provisional];
                    let of = self.parents.level[child.of as usize];
                    let bend = Bend { curvature: spot.curvature, slope: of.bend.slope };
                    self.parents.born.push(bend);
                    if surprise.abs() > SURPRISE * spot.radius {
                        self.parents.note_seam(of);
                        self.parents.note_seam(Parent { particle: index as u32, has_placed: false, bend });
                    }
                    self.grids.update(child.held, spot.position, spot.radius, index as u32);
                    particles.position[index] = spot.position;
                    particles.normal[index] = spot.normal;
                    particles.radius[index] = spot.radius;
                    particles.parent[index] = parent;
                    particles.level[index] = particles.level[provisional];
                    self.settled += 1;
                    self.filled += u64::from(self.fills > 0);
                    SlotFate::Added
                }
            }
        };
        if fate != SlotFate::Added {
            self.grids.remove(child.held);
        }
        if self.trace.follows(parent) {
            if let Landed::On(Spot { position, normal, radius, .. }) = self.landings[k] {
                self.trace.note_child(parent, child.number, || Step::Landed { position, normal, radius });
            }
            let particle =
                if fate == SlotFate::Added { self.settled as u32 - 1 } else { Particles::NO_PARENT };
            self.trace.note_child(parent, child.number, || Step::Fate { fate, particle });
        }
        self.fates.count(fate);
        particles.slots[parent as usize].set(child.slot as usize, fate);
    }

    /// Whether a settled particle of the same sheet is nearer than the match tolerance allows.
    fn collides(&mut self, particles: &Particles, position: Vec3, normal: Vec3, radius: f32) -> bool {
        let share = self.match_tolerance;
        self.grids.gather(position, |largest| share * (radius + largest), &mut self.found);
        let settled = self.settled;
        self.found.iter().any(|near| {
            let j = near.index as usize;
            let both = radius + particles.radius[j];
            let limit = share * both;
            j < settled
                && near.distance_sq <= limit * limit
                && same_sheet(near, normal, particles.normal[j], both)
        })
    }
}

/// Whether a particle with the normal `other` belongs to the sheet of a point with the normal `normal` from which it was
/// found; `both` is r_i + r_j.
fn same_sheet(near: &Neighbour, normal: Vec3, other: Vec3, both: f32) -> bool {
    let rise = near.offset.dot(normal);
    let slack = RISE_SLACK * both;
    normal.dot(other) > 0.0 && rise * rise <= MAX_RISE_SQ * (near.distance_sq + slack * slack)
}

/// Slots of a new particle: the parent's is known.
fn initial_slots() -> Slots {
    let mut slots = Slots::default();
    slots.set(0, SlotFate::Parent);
    slots
}
