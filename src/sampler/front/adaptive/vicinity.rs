//! The vicinity of a parent: the particles near it, and the arcs of directions that they and its
//! children occupy.

use super::{FrontRules, LISTED, RING, TOUCHING};
use crate::particles::Particles;
use crate::sampler::front::adaptive::arcs::{ParentRing, PredictedChild};
use crate::sampler::front::level::FrontLevel;
use crate::sampler::neighbours::packed::PackedNeighbours;
use crate::sampler::sheet::{PointPair, is_level};
use crate::spatial::Neighbour;
use core::f32::consts::TAU;

/// A particle or a child on the circle around a parent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Occupant {
    /// Direction in the tangent plane, from 0 to 2π.
    pub(super) angle: f32,
    /// A child to be projected; none for a particle that was there, or a child that matched such a
    /// one.
    pub(super) child: Option<PredictedChild>,
}

/// The surroundings of the parent that places its children.
#[derive(Clone, Debug, Default)]
pub(super) struct Vicinity {
    /// The particles of the sheet of the parent.
    pub(super) ring: ParentRing,
    /// Numbers in the ring of those that touch the parent, but for the one that placed it.
    touching: Vec<u32>,
    /// Particles and children on the circle around the parent, in the order of their angles.
    pub(super) occupants: Vec<Occupant>,
}

impl Vicinity {
    /// Reads the particles that were found around `parent`: into the ring those that its children
    /// may collide with, and into the neighbour `lists`, if it has none there yet, those before it
    /// that repel it. The ones before it are final, and so is its list. Settled particles have
    /// their exact radius. Says whether all that were found are of the parent's sheet.
    pub(super) fn read(
        &mut self,
        level: &FrontLevel,
        lists: Option<&mut PackedNeighbours>,
        particles: &Particles,
        parent: usize,
        rules: &FrontRules,
    ) -> bool {
        let (normal, radius) = (particles.normal[parent], particles.radius[parent]);
        let exact_sq = (RING * radius) * (RING * radius);
        let grandparent = particles.parent[parent];
        self.ring.clear();
        self.touching.clear();
        let mut alone = true;
        let mut read = |near: &Neighbour| {
            let j = near.index as usize;
            if j == parent {
                return (false, 1.0);
            }
            let (other, both) = (particles.normal[j], radius + particles.radius[j]);
            let pair = PointPair { offset: near.offset, normal, other };
            if is_level(pair, near.distance_sq, rules.match_tolerance * both) {
                if near.distance_sq <= (TOUCHING * both) * (TOUCHING * both) && near.index != grandparent {
                    self.touching.push(self.ring.len() as u32);
                }
                let is_exact = j < level.settled && near.distance_sq <= exact_sq;
                self.ring.push(near.offset, particles.radius[j], is_exact);
            } else {
                alone = false;
            }
            let reach = LISTED * both;
            ((j < parent) & (near.distance_sq <= reach * reach), other.dot(normal))
        };
        match lists {
            Some(lists) => lists.list(&level.found, read),
            None => level.found.iter().for_each(|near| {
                read(near);
            }),
        }
        alone
    }

    /// Empties the circle, or has it begin with the particles that touch the parent.
    pub(super) fn begin_circle(&mut self, with_touching: bool) {
        self.occupants.clear();
        let touching = if with_touching { self.touching.len() } else { 0 };
        for k in 0..touching {
            let angle = self.ring.angle(self.touching[k] as usize);
            let angle = if angle < 0.0 { angle + TAU } else { angle };
            self.enter(Occupant { angle, child: None });
        }
    }

    /// Enters an occupant in the order of the angles.
    pub(super) fn enter(&mut self, occupant: Occupant) {
        let mut at = self.occupants.len();
        self.occupants.push(occupant);
        while at > 0 && self.occupants[at - 1].angle > occupant.angle {
            self.occupants.swap(at, at - 1);
            at -= 1;
        }
    }
}
