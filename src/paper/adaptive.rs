//! Non-uniform sampling, paper §5: children of different sizes, pushed until they touch their
//! parent (Figs 7 and 8).
//!
//! # Differs from the paper
//!
//! * The paper names no step lengths.
//! * A child is added if the free angle τ is at least a share of φ
//!   ([`Rules::fit`](super::Rules::fit)).
//! * The radius of a child is evaluated again where it lands. A child nearer to a particle than the
//!   match tolerance is not added.

use super::{ChildSlot, Circle, Moment, Observer, PaperRun, TangentFrame};
use crate::particles::{SlotFate, Slots};
use core::f64::consts::TAU;
use glam::{DVec2, DVec3};

/// Neighbours within this many radii of the parent are gathered: a disc that touches the parent
/// from farther away is twice as large.
const REACH: f64 = 3.7;

/// A neighbour within this share of r_i + r_j lies on the circle around the parent. In a lattice
/// the first ring is at 1, the next at 1.73.
const TOUCHING: f64 = 1.25;

/// Length of a push away from the parent, as a share of the parent's radius: a child ends within 3
/// % of the distance at which it touches.
const PUSH: f64 = 1.0 / 16.0;

/// Angle of a push along the circle, in radians: 1.8°, or 3 % of the 60° that a child of the
/// parent's size takes.
const TURN_RAD: f64 = 1.0 / 32.0;

/// Largest number of pushes in each direction: as many turns go around the circle once.
const MAX_PUSHES: u32 = 200;

/// A particle as a disc in the tangent plane, at its true distance from the parent.
#[derive(Clone, Copy, Debug)]
struct Disc {
    centre: DVec2,
    radius: f64,
}

impl Disc {
    /// Direction in the tangent plane, from 0 to 2π.
    fn angle(&self) -> f64 {
        let angle = libm::atan2(self.centre.y, self.centre.x);
        if angle < 0.0 { angle + TAU } else { angle }
    }
}

/// The parent whose children are placed, with the particles of its sheet around it.
struct Circumference {
    /// The next child.
    child: ChildSlot,
    radius: f64,
    frame: TangentFrame,
    around: Vec<Disc>,
}

impl Circumference {
    fn place(&self, centre: DVec2) -> DVec3 {
        self.frame.p + self.frame.u * centre.x + self.frame.w * centre.y
    }

    fn disc(&self, position: DVec3, radius: f64) -> Disc {
        let offset = position - self.frame.p;
        let flat = DVec2::new(offset.dot(self.frame.u), offset.dot(self.frame.w));
        Disc { centre: flat.normalize_or_zero() * offset.length(), radius }
    }

    /// Largest overlap of a disc with a gathered particle, as a share of r_i + r_j; negative if
    /// there is none.
    fn overlap(&self, child: Disc) -> f64 {
        let shares = self
            .around
            .iter()
            .map(|other| 1.0 - other.centre.distance(child.centre) / (child.radius + other.radius));
        shares.fold(f64::NEG_INFINITY, f64::max)
    }

    /// The angle φ that the diameter of a child takes on the circle.
    fn taken(&self, child: Disc) -> f64 {
        2.0 * libm::asin(child.radius / (self.radius + child.radius))
    }

    /// Angle at the parent between a child that touches it and another disc that touches the child.
    fn beside(&self, child: Disc, other: Disc) -> f64 {
        let (d, e) = (self.radius + child.radius, other.centre.length());
        let apart = child.radius + other.radius;
        libm::acos(((d * d + e * e - apart * apart) / (2.0 * d * e)).clamp(-1.0, 1.0))
    }

    /// The free angle τ between two discs; it equals φ if the child just fits between them.
    fn free(&self, child: Disc, before: Disc, behind: Disc) -> f64 {
        let apart = behind.angle() - before.angle();
        let apart = if apart <= 0.0 { apart + TAU } else { apart };
        apart - self.beside(child, before) - self.beside(child, behind) + self.taken(child)
    }
}

impl<O: Observer> PaperRun<O> {
    /// Treats a particle: places children in each of the free spaces around it (§5.3).
    pub(super) fn treat_adaptive(&mut self, particle: u32) {
        let own = self.particles[particle as usize];
        // Gather the neighbouring particles (Fig. 8a).
        let neighbours = self.gather(particle, REACH * own.radius);
        let frame = self.tangent_frame(particle);
        let child = ChildSlot { parent: particle, slot: 0 };
        self.tell(child, Moment::Frame(&frame));
        let mut ring = Circumference { child, radius: own.radius, frame, around: Vec::new() };
        let mut touching = Vec::new();
        for near in neighbours {
            let other = &self.particles[near.particle as usize];
            if self.rules.is_same_sheet(&own, other) {
                let disc = ring.disc(other.p(), other.radius);
                ring.around.push(disc);
                if near.distance <= TOUCHING * (own.radius + other.radius) {
                    touching.push((near.particle, disc));
                }
            }
        }
        if let Some(parent) = own.parent {
            self.decide(child, SlotFate::Parent, Some(parent));
            ring.child.slot = 1;
        }
        // "If we have n existing particles we have n free available spaces."
        touching.sort_by(|(_, a), (_, b)| a.angle().total_cmp(&b.angle()));
        if touching.is_empty() {
            self.fill_space(&mut ring, None);
        }
        for (k, &before) in touching.iter().enumerate() {
            self.fill_space(&mut ring, Some([before, touching[(k + 1) % touching.len()]]));
        }
    }

    /// Places children in a free space, starting at its beginning, until the next one has no room
    /// (Fig. 8).
    fn fill_space(&mut self, ring: &mut Circumference, ends: Option<[(u32, Disc); 2]>) {
        let angles_rad = ends.map_or([0.0, TAU], |ends| ends.map(|(_, end)| end.angle()));
        let particles = ends.map(|ends| ends.map(|(particle, _)| particle));
        self.tell(ring.child, Moment::Space { ends: particles, angles_rad });
        let mut last = ends.map(|[(_, before), _]| before);
        let mut behind = ends.map(|[_, (_, behind)]| behind);
        while (ring.child.slot as usize) < Slots::COUNT {
            let child = self.pushed(ring, last);
            // "The projection of its diameter", φ, and "the actual free circumference", τ (Fig.
            // 7g).
            let phi_rad = ring.taken(child);
            let tau_rad = match (last, behind) {
                (Some(last), Some(behind)) => ring.free(child, last, behind),
                _ => TAU,
            };
            let fits = tau_rad >= self.rules.fit * phi_rad;
            self.tell(ring.child, Moment::Room { phi_rad, tau_rad, fits });
            if !fits {
                self.decide(ring.child, SlotFate::Matched, None);
                ring.child.slot += 1;
                return;
            }
            self.project(ring, child);
            ring.child.slot += 1;
            last = Some(child);
            behind = behind.or(last);
        }
    }

    /// A child beside `last`, pushed until it touches its parent and overlaps the others least
    /// (§5.1, Fig. 7).
    fn pushed(&mut self, ring: &Circumference, last: Option<Disc>) -> Disc {
        // I lies on the circle of the last child, perpendicular to the way there; s on the circle
        // of the parent (Fig. 7c).
        let tangent = last.map(|last| last.centre + last.centre.perp().normalize_or_zero() * last.radius);
        let way = tangent.map_or(DVec2::X, |tangent| tangent.normalize_or(DVec2::X));
        let mut child = self.sized(ring, way * ring.radius);
        let tangent = tangent.map(|tangent| ring.place(tangent));
        let Disc { centre, radius } = child;
        self.tell(ring.child, Moment::Started { tangent, position: ring.place(centre), radius });
        // Along V̂ until parent and child do not overlap any more (Fig. 7b and 7e).
        for _ in 0..MAX_PUSHES {
            if child.centre.length() >= ring.radius + child.radius {
                break;
            }
            child = self.sized(ring, child.centre + way * (PUSH * ring.radius));
            let Disc { centre, radius } = child;
            self.tell(ring.child, Moment::Pushed { position: ring.place(centre), radius });
        }
        // Along the circle until it overlaps least (Fig. 7f).
        let mut overlap = ring.overlap(child);
        let mut angle = child.angle();
        for _ in 0..MAX_PUSHES {
            if overlap <= 0.0 {
                break;
            }
            angle += TURN_RAD;
            let turned = DVec2::new(libm::cos(angle), libm::sin(angle));
            let radius = self.sized(ring, turned * (ring.radius + child.radius)).radius;
            let next = Disc { centre: turned * (ring.radius + radius), radius };
            let next_overlap = ring.overlap(next);
            if next_overlap >= overlap {
                break;
            }
            (child, overlap) = (next, next_overlap);
            self.tell(ring.child, Moment::Turned { position: ring.place(child.centre), radius, overlap });
        }
        child
    }

    /// A child in the tangent plane, with the radius there: "at each step we evaluate the
    /// curvature".
    fn sized(&mut self, ring: &Circumference, centre: DVec2) -> Disc {
        // If the curvature is undefined, the smallest radius is that of its limit.
        let radius = self.radius_at(ring.place(centre)).unwrap_or(self.rules.sizes.smallest());
        Disc { centre, radius }
    }

    /// "Finally we re-project the children of P on the surface" (§5.1): adds the child unless it
    /// overlaps a particle.
    fn project(&mut self, ring: &mut Circumference, child: Disc) {
        let of = ring.child;
        let distance = child.centre.length();
        let direction = (ring.frame.u * child.centre.x + ring.frame.w * child.centre.y) / distance;
        let (centre, normal) = (ring.frame.p, ring.frame.n);
        let circle = Circle { centre, normal, direction, radius: distance, start_rad: 0.0 };
        let landing = self.land(of, &circle);
        let landing = landing.and_then(|at| self.radius_at(at.0).map(|_| at).ok_or(SlotFate::Undefined));
        let Some((position, normal)) = self.usable(of, landing) else { return };
        let Some(radius) = self.radius_at(position) else { return };
        let placed = self.child(of.parent, (position, normal), radius);
        let reach = self.rules.match_tolerance * (radius + self.rules.sizes.largest());
        let near = self.buckets.near(&self.particles, position, reach);
        match self.settle(of, placed, &near).0 {
            SlotFate::Added => ring.around.push(ring.disc(position, radius)),
            // No other child is tried.
            SlotFate::Capped => ring.child.slot = Slots::COUNT as u32,
            _ => {}
        }
    }
}
