//! Placement of children as the paper has it, §5.1 and Fig. 7: each is pushed in small steps, with the radius evaluated
//! anew at every one, until it touches its parent and overlaps the others least.
//!
//! # Differs from the paper
//!
//! * The paper names no step lengths.
//! * After the projection on the circle C(p, r_i + r_j) the radius is evaluated once more, on the surface.

use super::parents::Bend;
use super::{AdaptiveFront, MAX_CHILDREN, Occupant, SLOTS, Surface, What, initial_slots};
use crate::math::functions::{atan2, cos, sin};
use crate::particles::{Particles, SlotFate};
use crate::sampler::front::adaptive::arcs::{Arc, Base, FIT, Room};
use crate::sampler::projection::{Circle, Landing, tolerance};
use crate::trace::Step;
use core::f32::consts::TAU;
use glam::{Vec2, Vec3};

/// Length of a push away from the parent, in radii of the parent.
const PUSH: f32 = 1.0 / 16.0;

/// Angle of a push along the circle, in radians.
const TURN: f32 = 1.0 / 32.0;

/// Most pushes of a child each way: the radius grows no faster than a child is pushed, so it comes to touch long before.
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
    pub(crate) fn push_children(&mut self, surface: &mut Surface, parent: usize, base: &Base) {
        for k in 0..self.ring.arcs.len() {
            let arc = self.ring.arcs[k];
            self.push_into(surface, parent, base, arc);
        }
    }

    fn push_into(&mut self, surface: &mut Surface, parent: usize, base: &Base, arc: Arc) {
        let disc = |front: &Self, i: usize| {
            let (centre, radius) = front.ring.disc(i, base);
            Disc { centre, radius }
        };
        let ends = self.ring.ends(arc).map(|(before, behind)| (disc(self, before), disc(self, behind)));
        let mut last = ends.map(|(before, _)| before);
        let mut behind = ends.map(|(_, behind)| behind);
        let mut at = arc.start;
        for _ in 0..MAX_CHILDREN {
            // Every child needs a slot to tell its fate in.
            if self.born as usize + 1 >= SLOTS {
                break;
            }
            let child = self.pushed(surface, parent, base, last);
            let angle = child.angle();
            // Angles grow along the arc.
            let angle = if angle < at { angle + TAU } else { angle };
            let angle = if angle < at { angle + TAU } else { angle };
            let room = match (last, behind) {
                (Some(last), Some(behind)) => {
                    let (d, e) = ((last.centre, last.radius), (behind.centre, behind.radius));
                    Room::between(base.radius, child.radius, d, e)
                }
                _ => Room::whole(base.radius, child.radius),
            };
            let id = parent as u32;
            self.trace.note_child(id, self.born, || Step::Room { phi_rad: room.phi, tau_rad: room.tau });
            let fits = room.tau >= FIT * room.phi;
            let fate =
                if fits { self.settle_pushed(surface, parent, base, child) } else { SlotFate::Matched };
            let particle =
                if fate == SlotFate::Added { self.settled as u32 - 1 } else { Particles::NO_PARENT };
            self.trace.note_child(id, self.born, || Step::Fate { fate, particle });
            self.born += 1;
            let around = if angle >= TAU { angle - TAU } else { angle };
            self.enter(Occupant { angle: around, what: What::Known(fate) });
            if !fits {
                break;
            }
            at = angle;
            last = Some(child);
            behind = behind.or(last);
        }
    }

    /// The child beside `last` after all pushes.
    fn pushed(&mut self, surface: &mut Surface, parent: usize, base: &Base, last: Option<Disc>) -> Disc {
        let id = parent as u32;
        let p = surface.particles.position[parent];
        let place = |c: Vec2| p + base.u * c.x + base.w * c.y;
        // Start, Fig. 7c: I lies on the circle of the last child, square to the way there; s on the circle of the parent.
        let way = match last {
            None => Vec2::X,
            Some(last) => {
                (last.centre + last.centre.perp().normalize_or_zero() * last.radius).normalize_or(Vec2::X)
            }
        };
        let mut child =
            Disc { centre: way * base.radius, radius: self.radius_at(surface, place(way * base.radius)) };
        self.trace.note_child(id, self.born, || Step::Start {
            position: place(child.centre),
            radius: child.radius,
        });
        // Along V̂ until parent and child touch, Fig. 7b and 7e.
        for _ in 0..MAX_PUSHES {
            if child.centre.length() >= base.radius + child.radius {
                break;
            }
            child.centre += way * (PUSH * base.radius);
            child.radius = self.radius_at(surface, place(child.centre));
            self.trace.note_child(id, self.born, || Step::Push {
                position: place(child.centre),
                radius: child.radius,
            });
        }
        // Along the circle until it overlaps least, Fig. 7f.
        let mut overlap = self.overlap(base, child);
        let mut angle = child.angle();
        for _ in 0..MAX_PUSHES {
            if overlap <= 0.0 {
                break;
            }
            let turned = Vec2::new(cos(angle + TURN), sin(angle + TURN));
            let centre = turned * (base.radius + child.radius);
            let radius = self.radius_at(surface, place(centre));
            let next = Disc { centre: turned * (base.radius + radius), radius };
            let next_overlap = self.overlap(base, next);
            if next_overlap >= overlap {
                break;
            }
            (child, overlap, angle) = (next, next_overlap, angle + TURN);
            self.trace.note_child(id, self.born, || Step::PushOnCircle {
                position: place(child.centre),
                radius,
                overlap,
            });
        }
        child
    }

    fn radius_at(&mut self, surface: &mut Surface, position: Vec3) -> f32 {
        let sizing = surface.sizing();
        self.placement.look(surface.field, surface.projector, sizing, position).radius
    }

    /// Largest share of r_i + r_j by which a disc overlaps a neighbour; negative if it overlaps none.
    fn overlap(&self, base: &Base, child: Disc) -> f32 {
        (0..self.ring.len()).fold(f32::NEG_INFINITY, |most, i| {
            let (centre, radius) = self.ring.disc(i, base);
            let overlap = 1.0 - (centre - child.centre).length() / (child.radius + radius);
            if overlap > most { overlap } else { most }
        })
    }

    /// Projects a child that has room and adds it, if no particle is in its way.
    fn settle_pushed(&mut self, surface: &mut Surface, parent: usize, base: &Base, child: Disc) -> SlotFate {
        let id = parent as u32;
        let distance = child.centre.length();
        let way = child.centre / distance;
        let circle = Circle {
            centre: surface.particles.position[parent],
            normal: base.n,
            direction: base.u * way.x + base.w * way.y,
            radius: distance,
            guess: [1.0, 0.0],
        };
        if surface.particles.len() >= self.max_particles {
            self.capped = true;
            return SlotFate::Capped;
        }
        let allowed = tolerance(child.radius, self.resolution, self.gradient_scale);
        surface.projector.land_on_circles(surface.field, &[circle], allowed, &mut self.landing);
        let position = match self.landing[0] {
            Landing::On { position, .. } => position,
            Landing::NotConverged => return SlotFate::NotConverged,
            Landing::Undefined => return SlotFate::Undefined,
        };
        if !self.bounds.contains(position) {
            return SlotFate::Outside;
        }
        let sizing = surface.sizing();
        let spot = self.placement.look(surface.field, surface.projector, sizing, position);
        let (normal, radius) = (spot.normal, spot.radius);
        if !(radius > 0.0 && normal.is_finite()) {
            return SlotFate::Undefined;
        }
        self.trace.note_child(id, self.born, || Step::Landed { position, normal, radius });
        if self.collides(surface.particles, position, normal, radius) {
            return SlotFate::Matched;
        }
        let particles: &mut Particles = surface.particles;
        let level = particles.level[parent] + 1;
        self.grids.insert(position, radius, self.settled as u32);
        particles.push(position, normal, radius, id, level, initial_slots());
        self.parents.born.push(Bend { curvature: spot.curvature, slope: Vec3::ZERO });
        self.settled += 1;
        self.filled += u64::from(self.fills > 0);
        self.ring.push(position - circle.centre, radius, true);
        SlotFate::Added
    }
}
