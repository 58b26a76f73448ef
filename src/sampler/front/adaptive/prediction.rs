//! Prediction of the children of a parent: how many each free arc takes, which slots they get, and
//! where they stand until they are projected.

use super::AdaptivePlacing;
use crate::differential::Curvature;
use crate::particles::{Particles, SlotFate, Slots};
use crate::sampler::front::adaptive::arcs::{ParentFrame, PredictedChild};
use crate::sampler::front::adaptive::placement::Proposal;
use crate::sampler::front::adaptive::vicinity::Occupant;
use crate::sampler::front::level::{FrontLevel, SurfacePoint};
use crate::sampler::projection::ChildCircle;
use core::f32::consts::TAU;

impl AdaptivePlacing {
    /// Spreads children over the free arcs.
    pub(super) fn predict_children(&mut self, frame: &ParentFrame, alone_on_sheet: bool) {
        for k in 0..self.around.ring.arcs.len() {
            let arc = self.around.ring.arcs[k];
            let count = self.around.ring.spread(frame, arc).len();
            for m in 0..count {
                let angle = self.around.ring.children[m];
                let (mut child, room) = self.predict_child(frame, angle);
                // Only the particles within the reach are known.
                let beyond = 2.0 * self.rules.match_tolerance * child.radius;
                let seen = self.rules.reach * frame.radius - child.distance - beyond;
                child.clearance = if alone_on_sheet { room.min(seen) } else { 0.0 };
                let turn = if angle < 0.0 { TAU } else { 0.0 } - if angle >= TAU { TAU } else { 0.0 };
                let fits = room >= 0.0;
                self.around.enter(Occupant { angle: angle + turn, child: fits.then_some(child) });
                if fits {
                    self.around.ring.push(child.offset, child.radius, false);
                }
            }
        }
    }

    /// Predicts the child at an angle, no larger than its neighbours allow; and the room beyond the
    /// match tolerance that they leave it, negative if it is in their way.
    fn predict_child(&self, frame: &ParentFrame, angle: f32) -> (PredictedChild, f32) {
        let limits = |child: &PredictedChild| {
            let (share, grading) = (self.rules.match_tolerance, self.rules.grading);
            self.around.ring.limits(child.offset, child.radius, share, grading)
        };
        let mut child = frame.child_at(angle, f32::INFINITY);
        let (mut room, largest) = limits(&child);
        if child.radius > largest {
            child = frame.child_at(angle, largest);
            (room, _) = limits(&child);
        }
        child.largest = largest.min(frame.radius + self.rules.grading * child.distance);
        (child, room)
    }

    /// Gives every occupant of the circle around parent `which` of the level a slot, and the
    /// children a provisional place. A parent that places children `again` keeps the slots that it
    /// has filled.
    pub(super) fn fill_slots(
        &mut self,
        level: &mut FrontLevel,
        particles: &mut Particles,
        which: usize,
        again: bool,
    ) {
        let parent = self.parents.level[which].particle as usize;
        let mut slots = particles.slots[parent];
        let mut children = self.around.occupants.iter().filter(|occupant| occupant.child.is_some()).count();
        // A bit for every slot given out here.
        let mut given = 0_u32;
        if !again && particles.parent[parent] != Particles::NO_PARENT {
            slots.set(0, SlotFate::Parent);
            given = 1;
        }
        for k in 0..self.around.occupants.len() {
            let child = self.around.occupants[k].child;
            children -= usize::from(child.is_some());
            // If there are more occupants than slots, the ones that were there before get none.
            if child.is_none() && (again || given.count_ones() as usize + children >= Slots::COUNT) {
                continue;
            }
            let is = |k: usize, fate| given >> k & 1 == 0 && slots.get(k) == fate;
            let Some(slot) = (0..Slots::COUNT)
                .find(|&k| is(k, SlotFate::Open))
                .or_else(|| (0..Slots::COUNT).rev().find(|&k| is(k, SlotFate::Matched)))
            else {
                break;
            };
            given |= 1 << slot;
            level.fates.uncount(slots.get(slot));
            let fate = match child {
                None => SlotFate::Matched,
                Some(_) if particles.len() >= level.max_particles => {
                    level.capped = true;
                    SlotFate::Capped
                }
                Some(child) => {
                    let (centre, normal) = (particles.local[parent], particles.normal[parent]);
                    let PredictedChild { direction, distance, turn, slope, largest, .. } = child;
                    let circle = ChildCircle { centre, normal, direction, radius: distance, guess: turn };
                    let parent_radius = particles.radius[parent];
                    let proposal = Proposal { circle, parent: which as u32, parent_radius, slope, largest };
                    self.proposals.push(proposal);
                    let (position, normal, radius) = (centre + child.offset, child.normal, child.radius);
                    let spot = SurfacePoint { position, normal, radius, curvature: Curvature::default() };
                    level.enter(particles, parent, slot, &spot, child.clearance);
                    SlotFate::Open
                }
            };
            slots.set(slot, fate);
            level.fates.count(fate);
        }
        particles.slots[parent] = slots;
    }
}
