//! The paper's placement of children, §5.1 and Fig. 7. Each child is pushed in small steps, and its radius is evaluated after
//! every step, until it touches its parent and overlaps the other particles least.
//!
//! # Differs from the paper
//!
//! * The paper names no step lengths.
//! * After the projection on the circle C(p, r_i + r_j) the radius is evaluated once more, on the surface.

use super::AdaptiveFront;
use crate::math::functions::{atan2, cos, sin};
use crate::particles::{Particles, SlotFate, Slots};
use crate::sampler::front::adaptive::arcs::{Arc, FIT, MAX_CHILDREN, ParentFrame, Room};
use crate::sampler::front::adaptive::parents::LocalShape;
use crate::sampler::front::adaptive::vicinity::{Occupant, OccupantKind};
use crate::sampler::front::level::{FrontContext, initial_slots};
use crate::sampler::projection::{Circle, Landing};
use core::f32::consts::TAU;
use glam::{Vec2, Vec3};

/// Length of a push away from the parent, as a share of the parent's radius.
const PUSH: f32 = 1.0 / 16.0;

/// Angle of a push along the circle, in radians.
const TURN: f32 = 1.0 / 32.0;

/// Largest number of pushes in each direction. The radius grows more slowly than the distance, so a child touches its parent
/// long before.
const MAX_PUSHES: u32 = 200;

/// A particle as a disc in the tangent plane, at its true distance from the parent.
#[derive(Clone, Copy, Debug)]
struct Disc {
    centre: Vec2,
    radius: f32,
}

impl Disc {
    fn angle(&self) -> f32 {
        atan2(self.centre.y, self.centre.x)
    }
}

impl AdaptiveFront {
    /// Places the children of `parent` in its free arcs one by one.
    pub(super) fn push_children(&mut self, context: &mut FrontContext, parent: usize, frame: &ParentFrame) {
        for k in 0..self.around.ring.arcs.len() {
            let arc = self.around.ring.arcs[k];
            self.push_into(context, parent, frame, arc);
        }
    }

    /// Places children in one arc, from its beginning on, until the next one has no room.
    fn push_into(&mut self, context: &mut FrontContext, parent: usize, frame: &ParentFrame, arc: Arc) {
        let disc = |front: &Self, i: usize| {
            let (centre, radius) = front.around.ring.disc(i, frame);
            Disc { centre, radius }
        };
        let ends =
            self.around.ring.ends(arc).map(|(before, behind)| (disc(self, before), disc(self, behind)));
        let mut last = ends.map(|(before, _)| before);
        let mut behind = ends.map(|(_, behind)| behind);
        let mut at = arc.start;
        for _ in 0..MAX_CHILDREN {
            // Every child needs a slot for its fate.
            if self.around.born as usize + 1 >= Slots::COUNT {
                break;
            }
            let child = self.pushed(context, parent, frame, last);
            let angle = child.angle();
            // Angles grow along the arc.
            let angle = if angle < at { angle + TAU } else { angle };
            let angle = if angle < at { angle + TAU } else { angle };
            let room = match (last, behind) {
                (Some(last), Some(behind)) => {
                    let (d, e) = ((last.centre, last.radius), (behind.centre, behind.radius));
                    Room::between(frame.radius, child.radius, d, e)
                }
                _ => Room::whole(frame.radius, child.radius),
            };
            let fits = room.tau >= FIT * room.phi;
            let fate =
                if fits { self.settle_pushed(context, parent, frame, child) } else { SlotFate::Matched };
            self.around.born += 1;
            let around = if angle >= TAU { angle - TAU } else { angle };
            self.around.enter(Occupant { angle: around, kind: OccupantKind::Known(fate) });
            if !fits {
                break;
            }
            at = angle;
            last = Some(child);
            behind = behind.or(last);
        }
    }

    /// Pushes the child beside `last` until it touches the parent and overlaps least.
    fn pushed(
        &mut self,
        context: &mut FrontContext,
        parent: usize,
        frame: &ParentFrame,
        last: Option<Disc>,
    ) -> Disc {
        let p = context.particles.position[parent];
        let place = |c: Vec2| p + frame.u * c.x + frame.w * c.y;
        // Start, Fig. 7c: I lies on the circle of the last child, square to the way there; s on the circle of the parent.
        let way = match last {
            None => Vec2::X,
            Some(last) => {
                (last.centre + last.centre.perp().normalize_or_zero() * last.radius).normalize_or(Vec2::X)
            }
        };
        let mut child =
            Disc { centre: way * frame.radius, radius: self.radius_at(context, place(way * frame.radius)) };
        // Along V̂ until parent and child touch, Fig. 7b and 7e.
        for _ in 0..MAX_PUSHES {
            if child.centre.length() >= frame.radius + child.radius {
                break;
            }
            child.centre += way * (PUSH * frame.radius);
            child.radius = self.radius_at(context, place(child.centre));
        }
        // Along the circle until it overlaps least, Fig. 7f.
        let mut overlap = self.overlap(frame, child);
        let mut angle = child.angle();
        for _ in 0..MAX_PUSHES {
            if overlap <= 0.0 {
                break;
            }
            let turned = Vec2::new(cos(angle + TURN), sin(angle + TURN));
            let centre = turned * (frame.radius + child.radius);
            let radius = self.radius_at(context, place(centre));
            let next = Disc { centre: turned * (frame.radius + radius), radius };
            let next_overlap = self.overlap(frame, next);
            if next_overlap >= overlap {
                break;
            }
            (child, overlap, angle) = (next, next_overlap, angle + TURN);
        }
        child
    }

    fn radius_at(&mut self, context: &mut FrontContext, position: Vec3) -> f32 {
        let sizing = context.sizing();
        self.solver.look(context.field, context.projector, sizing, position).radius
    }

    /// Returns the largest overlap of a disc with a neighbour, as a share of r_i + r_j; negative if there is none.
    fn overlap(&self, frame: &ParentFrame, child: Disc) -> f32 {
        (0..self.around.ring.len()).fold(f32::NEG_INFINITY, |most, i| {
            let (centre, radius) = self.around.ring.disc(i, frame);
            let overlap = 1.0 - (centre - child.centre).length() / (child.radius + radius);
            if overlap > most { overlap } else { most }
        })
    }

    /// Projects a child that has room and adds it, unless a particle is in its way.
    fn settle_pushed(
        &mut self,
        context: &mut FrontContext,
        parent: usize,
        frame: &ParentFrame,
        child: Disc,
    ) -> SlotFate {
        let id = parent as u32;
        let distance = child.centre.length();
        let way = child.centre / distance;
        let circle = Circle {
            centre: context.particles.position[parent],
            normal: frame.n,
            direction: frame.u * way.x + frame.w * way.y,
            radius: distance,
            guess: [1.0, 0.0],
        };
        if context.particles.len() >= self.level.max_particles {
            self.level.capped = true;
            return SlotFate::Capped;
        }
        let allowed = self.rules.tolerance(child.radius);
        context.projector.land_on_circles(context.field, &[circle], allowed, &mut self.landing);
        let position = match self.landing[0] {
            Landing::On { position, .. } => position,
            Landing::NotConverged => return SlotFate::NotConverged,
            Landing::Undefined => return SlotFate::Undefined,
        };
        if !self.level.bounds.contains(position) {
            return SlotFate::Outside;
        }
        let sizing = context.sizing();
        let spot = self.solver.look(context.field, context.projector, sizing, position);
        let (normal, radius) = (spot.normal, spot.radius);
        if !(radius > 0.0 && normal.is_finite()) {
            return SlotFate::Undefined;
        }
        let FrontContext { field, projector, particles, .. } = context;
        if self.collides(*field, projector, particles, (position, normal, radius)) {
            return SlotFate::Matched;
        }
        let particles: &mut Particles = context.particles;
        let level = particles.level[parent] + 1;
        self.grids.insert(position, radius, self.level.settled as u32);
        particles.push(position, normal, radius, id, level, initial_slots());
        self.parents.born.push(LocalShape { curvature: spot.curvature, slope: Vec3::ZERO });
        self.level.settled += 1;
        self.filled += u64::from(self.fills > 0);
        self.around.ring.push(position - circle.centre, radius, true);
        SlotFate::Added
    }
}
