//! Uniform sampling, paper §4: every particle has six children at the distance 2r.
//!
//! Six neighbours in a hexagon are the ideal (Fig. 2). In the plane they can be placed directly, so
//! each particle works in its tangent plane (§4.2) and projects its children to the surface (§4.3).
//! Most of them exist already: the first is the father, and a child near another particle becomes
//! that particle (§4.4). Only the others are added, to be treated later.
//! # Differs from the paper
//!
//! * The paper does not define when a particle corresponds to a child. Here it must be within the
//!   match radius and on the same sheet: two sheets may be nearer than that.

use super::{ChildSlot, Circle, Moment, Nearby, Observer, PaperRun, Particle};
use crate::math::{SQRT_3, frame_of};
use crate::particles::SlotFate;
use glam::DVec3;

/// sin π/3.
const SIN_60: f64 = 0.5 * SQRT_3;

/// Directions of the six children in the frame (V̂⁰, N̂ × V̂⁰): §4.2, (cos iπ/3, sin iπ/3).
pub(crate) const DIRECTIONS: [[f64; 2]; 6] =
    [[1.0, 0.0], [0.5, SIN_60], [-0.5, SIN_60], [-1.0, 0.0], [-0.5, -SIN_60], [0.5, -SIN_60]];

/// Neighbours are gathered within this many radii: a child at 2r meets particles at up to 2r plus
/// the match radius, which is below 2r, from its parent.
pub(crate) const REACH: f64 = 4.0;

/// The tangent frame of a particle (Fig. 3).
#[derive(Clone, Copy, Debug)]
pub struct TangentFrame {
    /// The particle's place, p.
    pub(crate) p: DVec3,
    /// Unit normal N̂.
    pub(crate) n: DVec3,
    /// V̂⁰: unit tangent vector towards the first child.
    pub(crate) u: DVec3,
    /// N̂ × V̂⁰.
    pub(crate) w: DVec3,
    /// Whether the particle is a seed, whose first child is no parent.
    pub(crate) is_seed: bool,
}

impl TangentFrame {
    /// The circle of a child, in the direction V̂ⁱ at the distance 2r.
    pub(crate) fn circle(&self, slot: usize, radius: f64, start_rad: f64) -> Circle {
        let [cos, sin] = DIRECTIONS[slot];
        let direction = self.u * cos + self.w * sin;
        Circle { centre: self.p, normal: self.n, direction, radius: 2.0 * radius, start_rad }
    }

    /// The slots to fill: all six of a seed, five of any other particle.
    pub(crate) fn slots(&self) -> core::ops::Range<usize> {
        usize::from(!self.is_seed)..6
    }
}

impl<O: Observer> PaperRun<O> {
    /// Treats a particle: the body of Algorithm 2.
    pub(super) fn treat_uniform(&mut self, particle: u32, radius: f64) {
        let child = |slot: usize| ChildSlot { parent: particle, slot: slot as u32 };
        let frame = self.tangent_frame(particle);
        self.tell(child(0), Moment::Frame(&frame));

        // "Place its six children on the surface."
        let start_angles = (self.rules.start_angles)(&mut self.surface, &frame, radius);
        let landings: Vec<_> = frame
            .slots()
            .map(|slot| {
                let circle = frame.circle(slot, radius, start_angles[slot]);
                self.tell(child(slot), Moment::Proposed(&circle));
                (slot, self.land(child(slot), &circle))
            })
            .collect();

        // "Gather its neighboring particles."
        let mut neighbours = self.gather(particle, REACH * radius);
        if let Some(parent) = self.particles[particle as usize].parent {
            // "For each particle, we define its first child as being its father."
            if self.rules.removes_matched {
                neighbours.retain(|near| near.particle != parent);
            }
            self.decide(child(0), SlotFate::Parent, Some(parent));
        }

        // "For all of its six children."
        for (slot, landing) in landings {
            let Some(place) = self.usable(child(slot), landing) else { continue };
            let placed = self.child(particle, place, radius);
            let (_, is_now) = self.settle(child(slot), placed, &neighbours);
            if self.rules.removes_matched {
                // "Remove this particle from the neighboring particles."
                neighbours.retain(|near| Some(near.particle) != is_now);
            } else if let Some(particle) = is_now {
                neighbours.push(Nearby { particle, distance: placed.p().distance(frame.p) });
            }
        }
    }

    /// The frame in which the children of a particle are placed. The first one is its father; that
    /// of a seed is arbitrary (Fig. 3).
    pub(crate) fn tangent_frame(&self, particle: u32) -> TangentFrame {
        let own = &self.particles[particle as usize];
        let (p, n) = (own.p(), own.n());
        let towards = own.parent.and_then(|parent| {
            let towards = self.particles[parent as usize].p() - p;
            (towards - n * towards.dot(n)).try_normalize()
        });
        let (u, w) = match towards {
            Some(u) => (u, n.cross(u)),
            None => {
                let (u, w) = frame_of(own.normal);
                (u.into(), w.into())
            }
        };
        TangentFrame { p, n, u, w, is_seed: own.parent.is_none() }
    }

    /// The particles within `reach` of another one.
    pub(crate) fn gather(&mut self, particle: u32, reach: f64) -> Vec<Nearby> {
        let mut neighbours = self.buckets.near(&self.particles, self.particles[particle as usize].p(), reach);
        neighbours.retain(|near| near.particle != particle);
        let first = ChildSlot { parent: particle, slot: 0 };
        self.tell(first, Moment::Gathered { reach, neighbours: &neighbours });
        neighbours
    }

    /// "If an existing particle corresponds, the child is replaced by it", otherwise "the child is
    /// added to the particle set", unless the limit on particles is reached. Returns the child's
    /// fate and the particle that it became.
    pub(crate) fn settle(
        &mut self,
        child: ChildSlot,
        placed: Particle,
        neighbours: &[Nearby],
    ) -> (SlotFate, Option<u32>) {
        let (fate, particle) = match self.corresponding(child, &placed, self.candidates(neighbours)) {
            Some(other) => (SlotFate::Matched, Some(other)),
            None if self.particles.len() >= self.rules.max_particles => (SlotFate::Capped, None),
            None => (SlotFate::Added, Some(self.enter(placed))),
        };
        self.decide(child, fate, particle);
        (fate, particle)
    }

    /// "If an existing particle corresponds": the number of the nearest candidate, in r_i + r_j, on
    /// the child's sheet, if it is within the match tolerance.
    pub(crate) fn corresponding(
        &mut self,
        child: ChildSlot,
        placed: &Particle,
        candidates: impl IntoIterator<Item = (u32, Particle)>,
    ) -> Option<u32> {
        let nearest = candidates
            .into_iter()
            .filter(|(_, other)| self.rules.is_same_sheet(placed, other))
            .map(|(number, other)| (number, placed.p().distance(other.p()), placed.radius + other.radius))
            .min_by(|a, b| (a.1 / a.2).total_cmp(&(b.1 / b.2)));
        let alone = placed.radius + self.particles[child.parent as usize].radius;
        let limit = self.rules.match_tolerance * nearest.map_or(alone, |(.., both)| both);
        let nearest = nearest.map(|(particle, distance, _)| Nearby { particle, distance });
        let found = nearest.filter(|near| near.distance <= limit);
        let (position, corresponds) = (placed.p(), found.is_some());
        self.tell(child, Moment::Compared { position, nearest, limit, corresponds });
        found.map(|near| near.particle)
    }

    /// The particles around a child, with which it is compared.
    pub(crate) fn candidates(&self, neighbours: &[Nearby]) -> Vec<(u32, Particle)> {
        neighbours.iter().map(|near| (near.particle, self.particles[near.particle as usize])).collect()
    }
}
