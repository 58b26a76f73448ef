//! Uniform sampling, paper §4: a front of particles that places six children around each, 60° apart
//! in the tangent plane and 2r away on the surface, generation level by generation level.
//!
//! # Differs from the paper
//!
//! * The paper speaks of a stack of untreated particles; its rings (Fig. 11) are those of a queue,
//!   used here.
//! * "If an existing particle corresponds": a child corresponds when a particle of the same sheet
//!   is within the match radius, a share of 2r. The paper takes a matched particle out of the
//!   neighbours, so that two children cannot match it; here it stays, which makes the match radius
//!   a lower bound on all distances.
//! * A child is first placed on the circle by the curvature of the particles around its parent,
//!   without evaluating the field, and compared with the particles there at that place. Only a free
//!   child is projected, at about two evaluations, and then compared again at its final place. All
//!   free children of a level are projected together.

pub(super) mod gaps;
mod surroundings;

use crate::differential::Curvature;
use crate::field::Evaluator;
use crate::particles::{OrientedPoint, Particles, SlotFate};
use crate::sampler::discovery::survey::Survey;
use crate::sampler::front::level::{
    ChildLanding, FrontContext, FrontLevel, Placing, SlotFrame, SurfacePoint,
};
use crate::sampler::front::plan::FrontPlan;
use crate::sampler::front::uniform::gaps::SEAM;
use crate::sampler::front::uniform::surroundings::{SecondForm, Surroundings};
use crate::sampler::front::{MAX_DIP, SIN_60};
use crate::sampler::neighbours::constants::{GAUSSIAN_RANGE, GAUSSIAN_SKIN};
use crate::sampler::neighbours::packed::PackedNeighbours;
use crate::sampler::probe::Probe;
use crate::sampler::projection::{ChildCircle, CircleLanding, Tolerance};
use crate::sampler::sheet::{PointPair, is_level, level_slack_sq};
use crate::spatial::Neighbour;
use core::ops::Range;
use glam::Vec3;

/// Directions of the six slots in the frame (V̂⁰, N̂ × V̂⁰): paper §4.2.
const SLOT_DIRECTION: [[f32; 2]; 6] =
    [[1.0, 0.0], [0.5, SIN_60], [-0.5, SIN_60], [-1.0, 0.0], [-0.5, -SIN_60], [0.5, -SIN_60]];

/// Allowance for the distance between a provisional and a final place, in r. Children of smooth
/// surfaces move by a hundredth of it; those that move farther are compared again.
const DRIFT_ROOM: f32 = 0.2;

/// A predicted child, on the circle around its parent.
struct Prediction {
    /// Offset from the parent.
    offset: Vec3,
    /// Normal, of any length.
    normal: Vec3,
    /// cos θ and sin θ on the circle.
    turn: [f32; 2],
}

/// How a front of particles of one radius places children.
#[derive(Clone, Default)]
pub(super) struct UniformPlacing {
    radius: f32,
    match_radius: f32,
    tolerance: Tolerance,
    /// Particles of the level, which place children.
    parents: Range<usize>,
    /// The circles on which the children of the level have their places.
    circles: Vec<ChildCircle>,
    /// Landings of a batch of children.
    landings: Vec<CircleLanding>,
    around: Surroundings,
    /// Particles on a seam, in the order of the front; those before `next_seam` have been visited.
    seams: Vec<u32>,
    next_seam: usize,
}

impl UniformPlacing {
    /// Radius of the query around a parent: it covers every collision of a child and every
    /// neighbour that repels the parent.
    fn reach(&self) -> f32 {
        self.collision_reach().max((GAUSSIAN_RANGE + GAUSSIAN_SKIN) * self.radius)
    }

    /// Largest distance between a parent and a particle with which its children can collide.
    fn collision_reach(&self) -> f32 {
        2.0 * self.radius + self.known_reach()
    }

    /// Distance around a provisional place within which every particle is known: the match radius,
    /// and the distance that a child and its neighbours may move when they are projected.
    fn known_reach(&self) -> f32 {
        self.match_radius + DRIFT_ROOM * self.radius
    }

    /// Predicts the child of a parent in the direction (cos, sin) of its frame, on the circle of
    /// radius 2r around it.
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

    /// Copies the particles that were found around `parent` to the surroundings, and those before
    /// it that repel it to its neighbour list. All of the latter are final, so the list is
    /// complete. Returns whether some may be on another sheet that faces the same way.
    fn read_surroundings(
        &mut self,
        level: &FrontLevel,
        neighbours: &mut PackedNeighbours,
        particles: &Particles,
        parent: usize,
    ) -> bool {
        let repulsion = (GAUSSIAN_RANGE + GAUSSIAN_SKIN) * self.radius;
        let normal = particles.normal[parent];
        self.around.clear();
        neighbours.list(&level.found, |near| {
            let j = near.index as usize;
            let other = particles.normal[j];
            self.around.push(near.offset, other, j < level.settled);
            let is_near = (j < parent) & (near.distance_sq <= repulsion * repulsion);
            (is_near, other.dot(normal))
        });
        let spacing = 2.0 * self.radius;
        // The normals of children under way are only predicted, but they belong to this front.
        (level.rule.is_fine() || self.around.are_doubtful(normal, spacing))
            && level.found.iter().any(|near| {
                let other = particles.normal[near.index as usize];
                let pair = PointPair { offset: near.offset, normal, other };
                (near.index as usize) < level.settled
                    && pair.faces_one_way()
                    && level.rule.is_doubtful(pair, spacing)
            })
    }

    /// Whether a final particle of the same sheet is within the match radius of a point on a patch.
    fn collides(
        &self,
        level: &mut FrontLevel,
        probe: &mut Probe,
        particles: &Particles,
        point: OrientedPoint,
        patch: Option<u32>,
    ) -> bool {
        level.gather(particles, patch, point.position, |_| self.match_radius);
        level.found.retain(|near| {
            let pair = point.pair(near.offset, particles.normal[near.index as usize]);
            (near.index as usize) < level.settled
                && is_level(pair, near.offset.length_squared(), self.match_radius)
        });
        // Where a crease ends, the normal of a patch may jump, as that of a fillet does whose width
        // falls to 0, and the field cannot tell one sheet from two.
        let is_one = |near: &Neighbour| {
            (near.index as usize) < particles.twins.len()
                && near.distance_sq <= level_slack_sq(self.match_radius)
        };
        let spacing = 2.0 * self.radius;
        level.found.iter().any(is_one)
            || level.rule.is_near_own(probe, particles, point, &level.found, |_| spacing)
    }

    /// The place of a child on a circle, if the search there has led to its own sheet: the circle
    /// may meet the far side of a rim or of a thin sheet, which is no place for a child.
    fn on_own_sheet(
        &self,
        level: &FrontLevel,
        probe: &mut Probe,
        circle: &ChildCircle,
        landing: CircleLanding,
    ) -> ChildLanding {
        let (position, normal) = match landing {
            CircleLanding::On { position, normal } => (position, normal),
            CircleLanding::NotConverged => return ChildLanding::NotConverged,
            CircleLanding::Undefined => return ChildLanding::Undefined,
        };
        let &ChildCircle { centre, normal: above, .. } = circle;
        let pair = PointPair { offset: position - centre, normal: above, other: normal };
        if !level.rule.is_own(probe, centre, pair, 2.0 * self.radius) {
            return ChildLanding::NotConverged;
        }
        let curvature = Curvature::default();
        ChildLanding::On(SurfacePoint { position, normal, radius: self.radius, curvature })
    }
}

impl Placing for UniformPlacing {
    fn reset(&mut self, level: &mut FrontLevel, plan: &FrontPlan, survey: &Survey, room: usize) {
        let radius = plan.radius;
        self.radius = radius;
        self.match_radius = 2.0 * radius * plan.match_tolerance as f32;
        self.tolerance = plan.tolerance(survey);
        self.clear_level();
        self.truncate(0);
        self.next_seam = 0;
        level.grids.reset(plan.radii(), |_| self.reach());
        level.grids.reserve(room);
    }

    fn parents(&self) -> usize {
        self.parents.len()
    }

    fn add_parent(&mut self, _: &mut FrontContext, _: Vec3, particle: usize) -> f32 {
        let first = if self.parents.is_empty() { particle } else { self.parents.start };
        self.parents = first..particle + 1;
        self.radius
    }

    // Paper §4.2 and §4.4.
    fn place_children(&mut self, level: &mut FrontLevel, context: &mut FrontContext, parent: usize) {
        let parent = self.parents.start + parent;
        let FrontContext { probe, neighbours, particles, .. } = context;
        let p = particles.local[parent];
        let patch = particles.patch_of(parent);
        let probe = &mut probe.on(patch);
        level.gather(particles, patch, p, |_| self.reach());
        let is_doubtful = self.read_surroundings(level, neighbours, particles, parent);
        if is_doubtful {
            level.drop_strangers(probe, particles, parent, 2.0 * self.radius);
            self.around.clear();
            for near in &level.found {
                let j = near.index as usize;
                self.around.push(near.offset, particles.normal[j], j < level.settled);
            }
        }

        let frame = SlotFrame::of(particles, parent, &level.along);
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
            if is_matched || particles.len() >= level.max_particles {
                let fate = if is_matched { SlotFate::Matched } else { SlotFate::Capped };
                is_seam |= is_matched && nearest_sq > (SEAM * distance) * (SEAM * distance);
                level.capped |= !is_matched;
                slots.set(k, fate);
                level.fates.count(fate);
                continue;
            }
            let (position, normal) = (p + offset, normal.normalize_or(n));
            // The distances to the particles that were dropped are not known.
            let clearance = if is_doubtful { 0.0 } else { any_sq.sqrt().min(self.known_reach()) };
            let curvature = Curvature::default();
            let spot = SurfacePoint { position, normal, radius: self.radius, curvature };
            level.enter(particles, parent, k, &spot, clearance);
            let direction = u * direction[0] + w * direction[1];
            let circle = ChildCircle { centre: p, normal: n, direction, radius: distance, guess: turn };
            self.circles.push(circle);
            self.around.push(offset, normal, false);
        }
        if is_seam {
            self.seams.push(parent as u32);
        }
        particles.slots[parent] = slots;
    }

    fn project_children(
        &mut self,
        level: &mut FrontLevel,
        context: &mut FrontContext,
        children: Range<usize>,
    ) {
        let FrontContext { probe, particles, .. } = context;
        let probe = &mut probe.on(particles.patch_of(level.first_child + children.start));
        let mut landings = core::mem::take(&mut self.landings);
        probe.land_on_circles(&self.circles[children.clone()], self.tolerance, &mut landings);
        for (k, &on_circle) in children.zip(&landings) {
            let circle = &self.circles[k];
            let mut landing = self.on_own_sheet(level, probe, circle, on_circle);
            let is_lost = matches!(on_circle, CircleLanding::On { .. })
                && matches!(landing, ChildLanding::NotConverged);
            if is_lost && level.rule.is_fine() {
                let walked = probe.walk(circle, self.tolerance);
                landing = self.on_own_sheet(level, probe, circle, walked);
            }
            level.note_landing(particles, k, landing);
        }
        self.landings = landings;
    }

    fn has_room(
        &mut self,
        level: &mut FrontLevel,
        context: &mut FrontContext,
        child: usize,
        spot: &SurfacePoint,
    ) -> bool {
        let FrontContext { probe, particles, .. } = context;
        let &SurfacePoint { position, normal, .. } = spot;
        let provisional = level.first_child + child;
        let moved = (position - particles.local[provisional]).length();
        // No particle is nearer than the clearance minus the distances that both have moved. The
        // clearance counts all sheets, because the final normal may belong to another sheet than
        // the provisional one.
        let is_clear =
            level.children.list[child].clearance - moved - level.children.drift > self.match_radius;
        let patch = particles.patch_of(provisional);
        is_clear || !self.collides(level, probe, particles, OrientedPoint { position, normal }, patch)
    }

    fn end_level(&mut self, level: &FrontLevel) {
        self.parents = level.first_child..level.settled;
        self.circles.clear();
    }

    fn clear_level(&mut self) {
        self.parents = 0..0;
        self.circles.clear();
    }

    fn truncate(&mut self, len: usize) {
        self.seams.retain(|&i| (i as usize) < len);
    }

    fn begin_filling(&mut self, _: &mut FrontLevel) -> bool {
        self.next_seam < self.seams.len()
    }
}

/// Second fundamental form at a seed, from the Hessian: [uᵀHu uᵀHw; · wᵀHw]/|∇f|.
fn second_form_at(field: &mut dyn Evaluator, p: Vec3, u: Vec3, w: Vec3) -> SecondForm {
    let jet = field.jet(p.as_dvec3());
    let (u, w) = (u.as_dvec3(), w.as_dvec3());
    let slope = jet.gradient.length();
    let entry = |a: glam::DVec3, b: glam::DVec3| {
        let k = (a.dot(jet.hessian.apply(b)) / slope) as f32;
        if k.is_finite() { k } else { 0.0 }
    };
    SecondForm { a: entry(u, u), b: entry(u, w), c: entry(w, w) }
}
