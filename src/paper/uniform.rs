//! Uniform sampling, paper §4: every particle has six children at the distance 2r.
//!
//! Six neighbours in a hexagon are the ideal (Fig. 2). In the plane they can be placed at once, so each particle works in its tangent
//! plane (§4.2) and brings its children back to the surface (§4.3). Most of them are there already: the first one is the father, and
//! a child near another particle becomes that particle (§4.4). Only what is left is added and has its own turn later.
//!
//! # Differs from the paper
//!
//! * The paper does not say when a particle corresponds to a child. Here it is within the match radius, on the same sheet of the
//!   surface: two sheets may be nearer than that.

use super::PaperRun;
use super::buckets::Nearby;
use super::observer::{ChildSlot, Moment, Observer};
use super::particle::{Particle, TangentFrame};
use super::projection::Circle;
use super::rules::{Matched, SearchStart};
use super::surface::Landing;
use crate::math::{SQRT_3, frame_of};
use crate::particles::SlotFate;
use glam::DVec3;

/// Directions of the six children in the frame (V̂⁰, N̂ × V̂⁰): §4.2, (cos iπ/3, sin iπ/3).
pub(crate) const DIRECTIONS: [[f64; 2]; 6] = {
    const SIN_60: f64 = 0.5 * SQRT_3;
    [[1.0, 0.0], [0.5, SIN_60], [-0.5, SIN_60], [-1.0, 0.0], [-0.5, -SIN_60], [0.5, -SIN_60]]
};

/// Neighbours are gathered within this many radii: a child at 2r meets particles up to 2r + the match radius from its parent, which
/// is below 2r.
pub(crate) const REACH: f64 = 4.0;

/// Largest |sin θ₀|: at 1 the surface would curve with the radius r, which particles of this size do not resolve. On 16 random surfaces half of
/// it changes no count of small particles, and that of large ones by 0.5 %; with 1 a tenth more searches find no surface.
const STEEPEST: f64 = 0.9;

impl TangentFrame {
    /// Direction V̂ⁱ of a child.
    pub(crate) fn direction(&self, slot: usize) -> DVec3 {
        let [cos, sin] = DIRECTIONS[slot];
        self.u * cos + self.w * sin
    }

    /// The children that are still to be placed: all six of a seed, five of any other particle.
    pub(crate) fn slots(&self) -> core::ops::Range<usize> {
        usize::from(!self.is_seed)..6
    }
}

/// Angle θ₀ at which the surface leaves the tangent plane in the direction `d` of a frame in which its second form is [a, b, c]:
/// it falls away by κ l²/2 in a distance l, hence sin θ = −κ_V r at l = 2r.
pub(crate) fn predicted_angle([a, b, c]: [f64; 3], [cos, sin]: [f64; 2], radius: f64) -> f64 {
    let curvature = (a * cos + b * sin) * cos + (b * cos + c * sin) * sin;
    libm::asin((-curvature * radius).clamp(-STEEPEST, STEEPEST))
}

impl<O: Observer> PaperRun<O> {
    /// Treats a particle: the body of Algorithm 2.
    pub(super) fn treat_uniform(&mut self, particle: u32, radius: f64) {
        let child = |slot: usize| ChildSlot { parent: particle, slot: slot as u32 };
        let centre = self.particles[particle as usize].p();
        let frame = self.tangent_frame(particle);
        let form = match self.rules.start {
            SearchStart::Tangent => None,
            SearchStart::Curvature => Some(self.surface.second_form(centre, frame.u, frame.w)),
        };
        self.tell(child(0), Moment::Frame { frame: &frame, form });

        // "Place its six children on the surface."
        let landings: Vec<(usize, Landing)> = frame
            .slots()
            .map(|slot| {
                let direction = frame.direction(slot);
                let circle = Circle { centre, normal: frame.n, direction, radius: 2.0 * radius };
                let theta_rad = form.map_or(0.0, |form| predicted_angle(form, DIRECTIONS[slot], radius));
                let position = circle.point(theta_rad);
                self.tell(child(slot), Moment::Proposed { direction, theta_rad, position });
                (slot, self.land(child(slot), &circle, theta_rad))
            })
            .collect();

        // "Gather its neighboring particles."
        let mut neighbours = self.gather(particle, REACH * radius);
        if let Some(parent) = self.particles[particle as usize].parent {
            // "For each particle, we define its first child as being its father."
            if self.rules.matched == Matched::Leave {
                neighbours.retain(|near| near.particle != parent);
            }
            self.decide(child(0), SlotFate::Parent, Some(parent));
        }

        // "For all of its six children."
        for (slot, landing) in landings {
            let Some(place) = self.usable(child(slot), landing) else { continue };
            let placed = self.child(particle, place, radius);
            if let Some(other) = self.corresponding(child(slot), &placed, self.candidates(&neighbours)) {
                // The child is that particle, which leaves the neighbouring particles.
                self.decide(child(slot), SlotFate::Matched, Some(other));
                if self.rules.matched == Matched::Leave {
                    neighbours.retain(|near| near.particle != other);
                }
            } else if let Some(added) = self.add_child(child(slot), placed)
                && self.rules.matched == Matched::Stay
            {
                neighbours.push(Nearby { particle: added, distance: placed.p().distance(centre) });
            }
        }
    }

    /// The frame in which the children of a particle are placed. The first one is its father; that of a seed is arbitrary (Fig. 3).
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
        TangentFrame { n, u, w, is_seed: own.parent.is_none() }
    }

    /// The particles within `reach` of another one.
    pub(crate) fn gather(&mut self, particle: u32, reach: f64) -> Vec<Nearby> {
        let mut neighbours = self.buckets.near(&self.particles, self.particles[particle as usize].p(), reach);
        neighbours.retain(|near| near.particle != particle);
        self.tell(
            ChildSlot { parent: particle, slot: 0 },
            Moment::Gathered { reach, neighbours: &neighbours },
        );
        neighbours
    }

    /// "If an existing particle corresponds": the number of the candidate of the child's sheet that is nearest, in r_i + r_j, if it is
    /// within the match tolerance.
    pub(crate) fn corresponding(
        &mut self,
        child: ChildSlot,
        placed: &Particle,
        candidates: impl IntoIterator<Item = (u32, Particle)>,
    ) -> Option<u32> {
        let tolerance = self.rules.match_tolerance;
        let nearest = candidates
            .into_iter()
            .filter(|(_, other)| self.rules.is_same_sheet(placed, other))
            .map(|(number, other)| (placed.p().distance(other.p()), placed.radius + other.radius, number))
            .min_by(|a, b| (a.0 / a.1).total_cmp(&(b.0 / b.1)));
        let alone = placed.radius + self.particles[child.parent as usize].radius;
        let limit = tolerance * nearest.map_or(alone, |(_, both, _)| both);
        let distance = nearest.map(|(distance, ..)| distance);
        let against = nearest.map(|(.., number)| number);
        let corresponds = distance.is_some_and(|distance| distance <= limit);
        let position = placed.p();
        self.tell(child, Moment::Compared { position, against, distance, limit, corresponds });
        against.filter(|_| corresponds)
    }

    /// The particles around a child, with which it is compared.
    pub(crate) fn candidates(&self, neighbours: &[Nearby]) -> Vec<(u32, Particle)> {
        neighbours.iter().map(|near| (near.particle, self.particles[near.particle as usize])).collect()
    }
}
