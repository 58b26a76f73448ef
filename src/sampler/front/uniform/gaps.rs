//! Filling the gaps that fronts leave where they meet: beyond the paper, whose front stops there.
//!
//! Six slots per particle cover the plane without gaps as long as one lattice grows. Where two fronts meet out of step, a
//! gap can be too narrow for every slot around it and still wide enough for a particle. This looks at each particle that
//! had a slot taken by a particle far from the slot, finds the widest empty circle through it and two of its neighbours
//! (a Delaunay triangle, in the tangent plane), and places a particle at its centre if it is far enough from all others.

use crate::field::Field;
use crate::math::{Bounds, tangent_frame};
use crate::particles::{Particles, SlotFate, Slots};
use crate::sampler::neighbours::constants::{FULL_COSINE, GAUSSIAN_RANGE, GAUSSIAN_SKIN, LISTED_COSINE};
use crate::sampler::neighbours::packed::PackedNeighbours;
use crate::sampler::projection::{Circle, Landing, Projector, Tolerance};
use crate::spatial::{CellGrid, Neighbour};
use glam::Vec2;

/// A slot taken by a particle farther from it than this share of 2r marks a seam. Inside a lattice it is below 0.2.
pub(crate) const SEAM: f32 = 0.35;

/// A gap is filled if its centre is at least this far, in 2r, from every particle. A lattice's triangles have 0.577; a
/// hole of 1.45 times the ideal has 0.84.
const GAP: f32 = 0.8;

/// Wider circles than this, in 2r, are the border of the surface, not a gap.
const WIDEST: f32 = 1.25;

/// Most neighbours looked at; the two rings of a lattice have 18.
const CAPACITY: usize = 24;

/// The pass over the seams.
#[derive(Clone, Debug, Default)]
pub(crate) struct Gaps {
    /// Particles on a seam, in the order of the front.
    seams: Vec<u32>,
    next: usize,
    found: Vec<Neighbour>,
    landing: Vec<Landing>,
    /// Particles placed.
    pub(crate) filled: u64,
}

/// What the pass works on.
pub(crate) struct Ground<'a> {
    pub(crate) radius: f32,
    pub(crate) tolerance: Tolerance,
    pub(crate) bounds: Bounds,
    pub(crate) max_particles: usize,
    pub(crate) grid: &'a mut CellGrid,
    pub(crate) pairs: &'a mut PackedNeighbours,
    pub(crate) particles: &'a mut Particles,
}

impl Gaps {
    pub(crate) fn clear(&mut self) {
        self.seams.clear();
        self.next = 0;
        self.filled = 0;
    }

    /// Takes over the seams of a front that is done.
    pub(crate) fn begin(&mut self, seams: &mut Vec<u32>) {
        core::mem::swap(&mut self.seams, seams);
    }

    pub(crate) fn is_done(&self) -> bool {
        self.next >= self.seams.len()
    }

    /// Looks at up to `budget` particles and returns what is left.
    pub(crate) fn step(
        &mut self,
        field: &mut dyn Field,
        projector: &mut Projector,
        ground: &mut Ground,
        mut budget: u32,
    ) -> u32 {
        while budget > 0 && !self.is_done() {
            let i = self.seams[self.next] as usize;
            self.next += 1;
            budget -= 1;
            if ground.particles.len() < ground.max_particles {
                self.fill_beside(field, projector, ground, i);
            }
        }
        budget
    }

    fn fill_beside(
        &mut self,
        field: &mut dyn Field,
        projector: &mut Projector,
        ground: &mut Ground,
        i: usize,
    ) {
        let (p, n) = (ground.particles.position[i], ground.particles.normal[i]);
        let spacing = 2.0 * ground.radius;
        ground.grid.gather(p, (GAUSSIAN_RANGE + GAUSSIAN_SKIN) * ground.radius, &mut self.found);
        // Neighbours of the sheet, unrolled to the tangent plane: direction there, distance in space, in units of 2r.
        let (u, w) = tangent_frame(n);
        let mut plane = [Vec2::ZERO; CAPACITY];
        let mut count = 0;
        for near in &self.found {
            let j = near.index as usize;
            let flat = Vec2::new(near.offset.dot(u), near.offset.dot(w));
            let length = flat.length();
            if j != i && count < CAPACITY && ground.particles.normal[j].dot(n) > 0.0 && length > 0.0 {
                plane[count] = flat * (near.distance_sq.sqrt() / (length * spacing));
                count += 1;
            }
        }
        let Some(centre) = widest_gap(&plane[..count]) else { return };
        let width = centre.length();
        let direction = (u * centre.x + w * centre.y) / width;
        let circle = Circle { centre: p, normal: n, direction, radius: width * spacing, guess: [1.0, 0.0] };
        projector.land_on_circles(field, &[circle], ground.tolerance, &mut self.landing);
        let Landing::On { position, normal } = self.landing[0] else { return };
        if !ground.bounds.contains(position) || normal.dot(n) <= 0.0 {
            return;
        }
        ground.grid.gather(position, (GAUSSIAN_RANGE + GAUSSIAN_SKIN) * ground.radius, &mut self.found);
        let same_sheet = |near: &&Neighbour| ground.particles.normal[near.index as usize].dot(normal) > 0.0;
        let clear = GAP * spacing;
        if self.found.iter().filter(same_sheet).any(|near| near.distance_sq < clear * clear) {
            return;
        }
        let mut is_weighted = false;
        ground.pairs.push(self.found.iter().map(|near| {
            let along = ground.particles.normal[near.index as usize].dot(normal);
            is_weighted |= along < FULL_COSINE;
            (near.index, along > LISTED_COSINE)
        }));
        if is_weighted {
            self.found.iter().for_each(|near| ground.pairs.note_weighted(near.index as usize));
            ground.pairs.note_weighted(ground.particles.len());
        }
        let level = ground.particles.level[i] + 1;
        ground.grid.insert(position, ground.particles.len() as u32);
        // It has neighbours all around, so it places no children.
        let mut slots = Slots::default();
        slots.set(0, SlotFate::Parent);
        (1..6).for_each(|k| slots.set(k, SlotFate::Matched));
        ground.particles.push(position, normal, ground.radius, i as u32, level, slots);
        self.filled += 1;
    }
}

/// Centre of the widest empty circle through the origin and two of `points`, if it is wide enough to be a gap.
fn widest_gap(points: &[Vec2]) -> Option<Vec2> {
    let mut widest = GAP;
    let mut found = None;
    for (a, &p) in points.iter().enumerate() {
        for &q in &points[..a] {
            let twice_area = p.perp_dot(q);
            let (pp, qq) = (p.length_squared(), q.length_squared());
            let centre = Vec2::new(q.y * pp - p.y * qq, p.x * qq - q.x * pp) / (2.0 * twice_area);
            let width = centre.length();
            if width > widest && width < WIDEST {
                let inside = width * width * (1.0 - 1e-4);
                if points.iter().all(|r| (*r - centre).length_squared() >= inside) {
                    widest = width;
                    found = Some(centre);
                }
            }
        }
    }
    found
}
