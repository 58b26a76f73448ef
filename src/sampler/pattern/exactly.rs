//! A front with exactly the wanted number of particles: some are removed where they are most
//! crowded, or added in the largest holes, before the relaxation evens them out.

use super::cells::Cell;
use super::taken::Taken;
use super::{CELLS, Drawing, Ground};
use crate::math::{signed_key, sort_by_key};
use crate::particles::Particles;
use crate::sampler::front::FrontPlan;
use crate::sampler::neighbours::grids::RadiusRange;
use crate::sampler::probe::{BATCH, Probe};
use crate::sampler::sheet::SheetRule;

/// No hole of a front is smaller than this factor on the radii: in a lattice it is 1.15.
const LEAST_HOLE: f32 = 0.5;
/// No hole is larger.
const LARGEST_HOLE: f32 = 4.0;

impl Drawing {
    /// Begins to bring the particles of a front of this plan to the number `wanted`.
    pub(in super::super) fn correction(
        particles: &Particles,
        plan: &FrontPlan,
        rule: SheetRule,
        wanted: usize,
    ) -> Self {
        let mut taken = Taken::of(particles, RadiusRange::among(&particles.radius));
        taken.shrink = LARGEST_HOLE;
        Self {
            taken,
            least: LEAST_HOLE,
            count: particles.count(),
            limit: usize::MAX,
            wanted: Some(wanted),
            ..Self::over(particles.clone(), plan, rule)
        }
    }

    /// Whether particles must be removed.
    pub(in super::super) fn has_too_many(&self) -> bool {
        self.wanted.is_some_and(|wanted| self.count > wanted)
    }

    /// Measures how crowded each particle is, and removes the most crowded ones, none of them next
    /// to another one. Returns whether there are as many as wanted.
    pub(in super::super) fn remove_crowded(
        &mut self,
        ground: &Ground,
        _: &mut Probe,
        particles: &mut Particles,
        left: &mut u32,
    ) -> Option<bool> {
        // Particles on creases stay.
        let (fixed, rows) = (particles.twins.len(), particles.len());
        while self.crowding.len() < rows - fixed {
            let first = fixed + self.crowding.len();
            if *left == 0 {
                return None;
            }
            let range = first..(first + BATCH).min(rows);
            *left = left.saturating_sub(range.len() as u32);
            for row in range {
                self.crowding.push(self.taken.room_beside(ground, particles, row));
            }
        }
        let crowding = core::mem::take(&mut self.crowding);
        let mut order: Vec<u32> = (fixed as u32..rows as u32).collect();
        sort_by_key(&mut order, |&row| signed_key(crowding[row as usize - fixed], row));
        let mut surplus = self.count - self.wanted.unwrap_or(self.count);
        let mut is_kept = vec![true; rows];
        // Neighbours of one that is removed have room afterwards.
        let mut is_eased = vec![false; rows];
        for row in order {
            let row = row as usize;
            if surplus == 0 {
                break;
            }
            if !is_eased[row] {
                is_kept[row] = false;
                surplus -= 1;
                self.count -= 1;
                self.taken.around(particles, row).for_each(|j| is_eased[j] = true);
            }
        }
        particles.keep(|row| is_kept[row]);
        self.taken = Taken::of(particles, RadiusRange::among(&particles.radius));
        // Without any but those on creases nothing is left to remove.
        Some(surplus == 0 || particles.len() == fixed)
    }

    /// Finds the holes of a front.
    pub(in super::super) fn list_holes(
        &mut self,
        ground: &Ground,
        probe: &mut Probe,
        particles: &mut Particles,
        left: &mut u32,
    ) -> Option<()> {
        let all = self.front.len() * CELLS as usize;
        while self.next < all {
            let range = self.afford(all, left)?;
            let cells = range.map(|piece| Cell::of_piece(piece as u32)).collect();
            self.sift(ground, probe, particles, cells);
        }
        Some(())
    }
}
