//! The state of a generation level, which both kinds of front share, and the trait of the steps in
//! which they differ.

use crate::differential::Curvature;
use crate::math::{Bounds, tangent_frame};
use crate::particles::{OrientedPoint, Particles, SlotFate, Slots};
use crate::sampler::discovery::survey::Survey;
use crate::sampler::fates::FateCounts;
use crate::sampler::front::plan::FrontPlan;
use crate::sampler::neighbours::grids::{GridHandle, RadiusGrids};
use crate::sampler::neighbours::packed::PackedNeighbours;
use crate::sampler::probe::Probe;
use crate::sampler::sheet::{PointPair, SheetRule};
use crate::sampler::sizing::Sizing;
use crate::spatial::Neighbour;
use core::ops::Range;
use glam::Vec3;

/// The probe, the radius field, the neighbour lists and the particles that a front works on.
pub(crate) struct FrontContext<'a, 'f> {
    pub(crate) probe: &'a mut Probe<'f>,
    /// The radius field, which the adaptive front needs.
    pub(crate) sizing: Option<&'a Sizing>,
    pub(crate) neighbours: &'a mut PackedNeighbours,
    pub(crate) particles: &'a mut Particles,
}

impl<'a> FrontContext<'a, '_> {
    /// The radius field of an adaptive run.
    pub(crate) fn sizing(&self) -> &'a Sizing {
        self.sizing.expect("an adaptive run begins with a radius field")
    }

    /// Calls a function with the context in which f is the smooth function of a patch, if there is
    /// one.
    pub(crate) fn on<R>(&mut self, patch: Option<u32>, call: impl FnOnce(&mut FrontContext) -> R) -> R {
        let Self { probe, sizing, neighbours, particles } = self;
        call(&mut FrontContext { probe: &mut probe.on(patch), sizing: *sizing, neighbours, particles })
    }
}

/// A point of the surface, with the radius and the curvature there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfacePoint {
    pub(crate) position: Vec3,
    pub(crate) normal: Vec3,
    pub(crate) radius: f32,
    /// Curvature, in an adaptive front.
    pub(crate) curvature: Curvature,
}

/// The place to which the projection has led a child.
#[derive(Clone, Copy, Debug)]
pub(crate) enum ChildLanding {
    /// A place on the surface at which the child touches its parent.
    On(SurfacePoint),
    /// No place on the surface was found at which the child touches its parent.
    NotConverged,
    /// The field has no value there, or its gradient vanishes.
    Undefined,
}

/// A child on its way to the surface. Its provisional place stands in the particle columns.
#[derive(Clone, Copy, Debug)]
pub(super) struct Child {
    /// The slot of its parent.
    pub(super) slot: u32,
    pub(super) handle: GridHandle,
    /// Distance to the nearest place at which the child would have collided when it was predicted,
    /// as far as that is known.
    pub(super) clearance: f32,
}

/// State of a front within its level, and its limits.
#[derive(Clone, Default)]
pub(crate) struct FrontLevel {
    /// The parent or the child that is next.
    pub(super) next: usize,
    /// Index that the first child of this level has while it is provisional, and that the first one
    /// placed keeps.
    pub(super) first_child: usize,
    /// Particles before this index are final. Provisional children stand from here on.
    pub(crate) settled: usize,
    pub(super) bounds: Bounds,
    pub(super) max_particles: usize,
    pub(crate) fates: FateCounts,
    /// Particles placed in gaps.
    pub(crate) filled: u64,
    /// Whether the limit on particles was reached.
    pub(crate) capped: bool,
    /// The rule that tells sheets apart.
    pub(crate) rule: SheetRule,
    pub(super) grids: RadiusGrids,
    /// The particles that the last query of the grids found.
    pub(super) found: Vec<Neighbour>,
    /// Direction along the crease for each row of a particle on one.
    pub(super) along: Vec<Vec3>,
    pub(super) children: ProvisionalChildren,
}

impl FrontLevel {
    /// Begins a level. Its children follow the particles that are final.
    pub(super) fn begin(&mut self) {
        self.next = 0;
        self.first_child = self.settled;
    }

    /// Whether all of so many have had their turn; the first is next then.
    pub(super) fn has_reached(&mut self, count: usize) -> bool {
        let is_done = self.next >= count;
        if is_done {
            self.next = 0;
        }
        is_done
    }

    /// Finds the particles of a patch around a place: of each layer of radii those within `reach`
    /// of its largest one.
    pub(super) fn gather(
        &mut self,
        particles: &Particles,
        patch: Option<u32>,
        place: Vec3,
        reach: impl Fn(f32) -> f32,
    ) {
        self.grids.gather(place, reach, &mut self.found);
        if patch.is_some() {
            self.found.retain(|near| particles.is_on(near.index as usize, patch));
        }
    }

    /// Removes the particles on another sheet that face the same way as `parent` from those found
    /// around it. They stay in the neighbour lists of the relaxation, which tells sheets apart by
    /// the normals alone.
    pub(super) fn drop_strangers(
        &mut self,
        probe: &mut Probe,
        particles: &Particles,
        parent: usize,
        spacing: f32,
    ) {
        let from = OrientedPoint::of(particles, parent);
        self.found.retain(|near| {
            let pair = from.pair(near.offset, particles.normal[near.index as usize]);
            near.index as usize >= self.settled
                || !pair.faces_one_way()
                || is_on_sheet(self.rule, probe, from.position, pair, spacing)
        });
    }

    /// Puts a provisional child into the columns and the grids.
    pub(super) fn enter(
        &mut self,
        particles: &mut Particles,
        parent: usize,
        slot: usize,
        spot: &SurfacePoint,
        clearance: f32,
    ) {
        let &SurfacePoint { position, normal, radius, .. } = spot;
        let handle = self.grids.insert(position, radius, particles.len() as u32);
        let level = particles.level[parent] + 1;
        particles.push(position, normal, radius, parent as u32, level, initial_slots());
        self.children.list.push(Child { slot: slot as u32, handle, clearance });
    }

    /// Notes to where child `k` of the level was projected.
    pub(super) fn note_landing(&mut self, particles: &Particles, k: usize, landing: ChildLanding) {
        if let ChildLanding::On(spot) = landing {
            let moved = (spot.position - particles.local[self.first_child + k]).length();
            self.children.drift = self.children.drift.max(moved);
        }
        self.children.landings.push(landing);
    }
}

/// Whether two points that face the same way, the first at `position`, lie on one sheet: the pair
/// is not doubtful, or the field between them says so.
pub(crate) fn is_on_sheet(
    rule: SheetRule,
    probe: &mut Probe,
    position: Vec3,
    pair: PointPair,
    spacing: f32,
) -> bool {
    pair.lift() <= rule.suspicious(spacing) || rule.is_one_sheet(probe, position, pair)
}

/// The children of a level between their prediction and their fate.
#[derive(Clone, Debug, Default)]
pub(super) struct ProvisionalChildren {
    /// The children, in the order of their provisional places.
    pub(super) list: Vec<Child>,
    /// Landing of each child, in the order of `list`.
    pub(super) landings: Vec<ChildLanding>,
    /// Largest distance between a provisional and a final place in this level.
    pub(super) drift: f32,
}

impl ProvisionalChildren {
    pub(super) fn clear(&mut self) {
        self.list.clear();
        self.landings.clear();
        self.drift = 0.0;
    }
}

/// The steps of a level in which uniform and adaptive fronts differ. [`Front`](super::Front) does
/// the steps that are the same for both.
pub(super) trait Placing {
    /// Forgets an earlier run, and prepares the grids for so many particles.
    fn reset(&mut self, level: &mut FrontLevel, plan: &FrontPlan, survey: &Survey, room: usize);

    /// Number of parents in the level; none if the front has come to its end.
    fn parents(&self) -> usize;

    /// Makes a particle at a place a parent of the level that is about to begin. Returns the radius
    /// that a particle has there.
    fn add_parent(&mut self, context: &mut FrontContext, place: Vec3, particle: usize) -> f32;

    /// Finds the free slots of a parent of the level and enters a provisional child in each.
    fn place_children(&mut self, level: &mut FrontLevel, context: &mut FrontContext, parent: usize);

    /// Projects a batch of children onto the surface.
    fn project_children(
        &mut self,
        level: &mut FrontLevel,
        context: &mut FrontContext,
        children: Range<usize>,
    );

    /// Whether a child has room at its final place; if so, it is about to become the next settled
    /// particle.
    fn has_room(
        &mut self,
        level: &mut FrontLevel,
        context: &mut FrontContext,
        child: usize,
        spot: &SurfacePoint,
    ) -> bool;

    /// Makes the children that were placed the parents of the next level.
    fn end_level(&mut self, level: &FrontLevel);

    /// Drops the parents and the provisional children.
    fn clear_level(&mut self);

    /// Forgets the particles from `len` on.
    fn truncate(&mut self, len: usize);

    /// Goes on to the gaps, once the surface is covered; false if there is none to fill.
    fn begin_filling(&mut self, level: &mut FrontLevel) -> bool;
}

/// The directions in the tangent plane of a parent from which the angles of its slots are measured.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SlotFrame {
    /// Unit normal.
    pub(crate) n: Vec3,
    /// Unit tangent vector at angle 0, where the parent's own parent is (paper §4.4).
    pub(crate) u: Vec3,
    /// Unit tangent vector at 90°.
    pub(crate) w: Vec3,
    /// Whether the parent has no parent, and any direction will do.
    pub(crate) is_seed: bool,
}

impl SlotFrame {
    /// The frame of a particle. That of one on a crease has its first axis in the direction in
    /// `along`, which has an entry for each of them.
    pub(crate) fn of(particles: &Particles, particle: usize, along: &[Vec3]) -> Self {
        let (p, n) = (particles.local[particle], particles.normal[particle]);
        let parent = particles.parent[particle];
        let is_seed = parent == Particles::NO_PARENT;
        let towards = if is_seed {
            along.get(particle).copied().unwrap_or(Vec3::ZERO)
        } else {
            particles.local[parent as usize] - p
        };
        let towards = (towards - n * towards.dot(n)).normalize_or_zero();
        let (u, w) = if towards == Vec3::ZERO { tangent_frame(n) } else { (towards, n.cross(towards)) };
        Self { n, u, w, is_seed }
    }
}

/// Slots of a new particle: the first one is its parent's.
pub(crate) fn initial_slots() -> Slots {
    let mut slots = Slots::default();
    slots.set(0, SlotFate::Parent);
    slots
}
