//! The cells that particles leave uncovered, and the largest hole.

use super::cells::Cell;
use super::{Drawing, Ground, Spot};
use crate::math::Bounds;
use crate::particles::Particles;
use crate::sampler::probe::Probe;
use core::cmp::Ordering;
use glam::Vec3;

/// Halvings after which a cell is dropped if its middle has no place on the surface or on the
/// patch: a sixteenth of a first cell, or a twelfth of a radius.
const DEEP: u16 = 4;

/// A cell with an upper bound of the factor on all radii at which a particle in it would touch
/// another one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bound {
    pub(super) room: f32,
    pub(super) cell: Cell,
}

impl Ord for Bound {
    fn cmp(&self, other: &Self) -> Ordering {
        self.room.total_cmp(&other.room).then(self.cell.cmp(&other.cell))
    }
}

impl PartialOrd for Bound {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Bound {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Bound {}

/// What is known of a cell.
#[derive(Clone, Copy, Debug)]
pub(super) enum State {
    /// It holds nothing of the surface that belongs to its particle, or is covered at any radius
    /// in question.
    Gone,
    /// An upper bound of the factor at which it is covered.
    Covered(f32),
    /// It may not be covered.
    Open,
}

impl Drawing {
    /// Whether some of the surface in the box may belong to a cell, whose middle is at this spot.
    pub(super) fn may_hold(
        &mut self,
        ground: &Ground,
        probe: &mut Probe,
        cell: Cell,
        middle: Option<&Spot>,
    ) -> bool {
        let Some(spot) = middle else { return cell.depth < DEEP };
        let reach = self.reach(cell, spot);
        ground.bounds.enlarged(f64::from(reach)).contains(spot.position)
            && self.may_be_on_patch(probe, cell, spot, reach)
            && self.may_own(probe, cell.owner as usize, spot, reach)
    }

    /// Whether some of a cell may lie on the patch of its particle.
    fn may_be_on_patch(&self, probe: &mut Probe, cell: Cell, spot: &Spot, reach: f32) -> bool {
        let around = Bounds::point(spot.position.as_dvec3()).enlarged(f64::from(reach));
        spot.patch.is_none()
            || is_on_patch(probe, spot)
            || cell.depth < DEEP && probe.may_have_zeros(spot.patch, &around)
    }

    /// The state of a cell whose middle is at this spot.
    pub(super) fn judge(
        &mut self,
        ground: &Ground,
        probe: &mut Probe,
        particles: &Particles,
        cell: Cell,
        middle: Option<&Spot>,
    ) -> State {
        let Some(spot) = middle else {
            return if cell.depth < DEEP { State::Open } else { State::Gone };
        };
        let reach = self.reach(cell, spot);
        let wanted = [self.least, self.taken.shrink];
        let room = self.taken.room(ground, particles, spot, reach, wanted);
        if room <= self.least {
            return State::Gone;
        }
        if !self.may_hold(ground, probe, cell, middle) {
            return State::Gone;
        }
        if room < self.taken.shrink { State::Covered(room) } else { State::Open }
    }

    /// Whether a spot belongs to its owner, and lies in the box and on the patch.
    pub(super) fn is_own(&mut self, ground: &Ground, probe: &mut Probe, owner: u32, spot: &Spot) -> bool {
        ground.bounds.contains(spot.position)
            && self.may_own(probe, owner as usize, spot, 0.0)
            && is_on_patch(probe, spot)
    }
}

impl Drawing {
    /// Takes the cell with the largest bound: fills it if it is small, or divides it. Returns
    /// whether there is another one that may be uncovered before all radii shrink to the least
    /// factor.
    pub(super) fn fill_hole(
        &mut self,
        ground: &Ground,
        probe: &mut Probe,
        particles: &mut Particles,
    ) -> bool {
        /// A hole is found within this share of a radius.
        const NEAR: f32 = 4e-3;
        /// A bound that has fallen by more than this share is not the largest any more.
        const STALE: f32 = 1e-3;
        const MORE: f32 = 1.05;
        let Some(Bound { room, cell }) = self.reserve.pop() else { return false };
        let middle = self.land_middles(ground, probe, &[cell])[0];
        let Some(mut spot) = middle else {
            if cell.depth < DEEP {
                self.reserve.extend(cell.quarters().map(|cell| Bound { room, cell }));
            }
            return true;
        };
        let reach = self.reach(cell, &spot);
        // Its own bound is hardly above that of the cell that it is a part of.
        let wanted = [self.least, MORE * room];
        let now = self.taken.room(ground, particles, &spot, reach, wanted);
        if now <= self.least || !self.may_hold(ground, probe, cell, Some(&spot)) {
            return true;
        }
        if now < (1.0 - STALE) * room {
            self.reserve.push(Bound { room: now, cell });
            return true;
        }
        if reach > NEAR * spot.radius && cell.depth < Cell::DEEPEST {
            let room = room.min(now);
            self.reserve.extend(cell.quarters().map(|cell| Bound { room, cell }));
            return true;
        }
        if self.is_own(ground, probe, cell.owner, &spot) {
            Self::polish(ground, probe, &mut spot);
            let touching = self.taken.room(ground, particles, &spot, 0.0, wanted);
            if touching > self.least && self.count >= self.limit {
                self.is_full = true;
            } else if touching > self.least {
                self.taken.shrink = self.taken.shrink.min(touching);
                self.taken.add(particles, &spot, self.round as u32);
                self.count += 1;
            }
        }
        true
    }
}

/// Whether a spot lies on its patch, and not where another one gives the surface.
fn is_on_patch(probe: &mut Probe, spot: &Spot) -> bool {
    let Spot { position, normal, radius, patch } = *spot;
    let normal: Vec3 = normal;
    patch.is_none() || probe.on(patch).is_on_patch(position, normal, radius, patch)
}
