//! Gaps are filled that fronts leave along their seams. The paper's front stops there.
//!
//! Six slots per particle cover the plane without gaps as long as one lattice grows. Where two fronts meet out of step, a
//! gap can be too narrow for every slot around it and still wide enough for a particle. The pass visits each particle with a
//! slot that is matched by a particle far from the slot. It finds the widest empty circle through this particle and two of its
//! neighbours (a Delaunay triangle in the tangent plane), and places a particle at the centre if that is far enough from all
//! others.

use super::UniformFront;
use crate::math::tangent_frame;
use crate::particles::{SlotFate, Slots};
use crate::sampler::front::level::FrontContext;
use crate::sampler::neighbours::constants::{FULL_COSINE, GAUSSIAN_RANGE, GAUSSIAN_SKIN, LISTED_COSINE};
use crate::sampler::projection::{ChildCircle, CircleLanding};
use crate::spatial::Neighbour;
use glam::Vec2;

/// A slot lies on a seam if the particle that matches it is farther away than this share of 2r. Inside a lattice the distance
/// is below 0.2. With half of it random surfaces come out the same; with twice as much the gaps stay.
pub(crate) const SEAM: f32 = 0.35;

/// A gap is filled if its centre is at least this far from every particle, in 2r. The triangles of a lattice have 0.577; a
/// hole of 1.45 times the ideal size has 0.84.
const GAP: f32 = 0.8;

/// A circle of a larger radius, in 2r, lies at the border of the surface and is no gap. Twice the bound changes
/// nothing on closed random surfaces.
const WIDEST: f32 = 1.25;

/// Largest number of neighbours considered. The two rings of a lattice have 18.
const CAPACITY: usize = 24;

/// The pass over the seams and its result.
#[derive(Clone, Debug, Default)]
pub(crate) struct SeamPass {
    /// Particles on a seam, in the order of the front; the pass has visited those before `next`.
    pub(crate) seams: Vec<u32>,
    next: usize,
    /// Particles placed.
    pub(crate) filled: u64,
}

impl SeamPass {
    pub(crate) fn clear(&mut self) {
        self.seams.clear();
        self.next = 0;
        self.filled = 0;
    }

    /// Whether every particle on a seam has been visited.
    pub(crate) fn is_done(&self) -> bool {
        self.next >= self.seams.len()
    }
}

impl UniformFront {
    /// Visits up to `budget` particles on seams and returns the rest of the budget.
    pub(crate) fn fill_gaps(&mut self, context: &mut FrontContext, mut budget: u32) -> u32 {
        while budget > 0 && !self.gaps.is_done() {
            let i = self.gaps.seams[self.gaps.next] as usize;
            self.gaps.next += 1;
            budget -= 1;
            if context.particles.len() < self.level.max_particles {
                self.fill_beside(context, i);
            }
        }
        budget
    }

    /// Fills the widest gap beside particle `i`, if a particle has room there.
    fn fill_beside(&mut self, context: &mut FrontContext, i: usize) {
        let FrontContext { probe, neighbours, particles, .. } = context;
        let (p, n, patch) = (particles.position[i], particles.normal[i], particles.patch_of(i));
        probe.select(patch);
        let spacing = 2.0 * self.radius;
        self.gather(particles, patch, p, (GAUSSIAN_RANGE + GAUSSIAN_SKIN) * self.radius);
        // The neighbours of the sheet are mapped to the tangent plane: they keep their direction there and their distance in
        // space. The unit is 2r.
        let (u, w) = tangent_frame(n);
        let mut plane = [Vec2::ZERO; CAPACITY];
        let mut count = 0;
        for near in &self.found {
            let j = near.index as usize;
            let flat = Vec2::new(near.offset.dot(u), near.offset.dot(w));
            let length = flat.length();
            if j != i && count < CAPACITY && particles.normal[j].dot(n) > 0.0 && length > 0.0 {
                plane[count] = flat * (near.distance_sq.sqrt() / (length * spacing));
                count += 1;
            }
        }
        let Some(centre) = widest_gap(&plane[..count], GAP) else { return };
        let width = centre.length();
        let direction = (u * centre.x + w * centre.y) / width;
        let circle =
            ChildCircle { centre: p, normal: n, direction, radius: width * spacing, guess: [1.0, 0.0] };
        let landing = &mut self.children.solutions;
        probe.land_on_circles(&[circle], self.tolerance, landing);
        let CircleLanding::On { position, normal } = landing[0] else { return };
        let is_inside = self.level.bounds.contains(position) && probe.is_on_patch(position, patch);
        if !is_inside || normal.dot(n) <= 0.0 {
            return;
        }
        self.gather(particles, patch, position, (GAUSSIAN_RANGE + GAUSSIAN_SKIN) * self.radius);
        let same_sheet = |near: &&Neighbour| particles.normal[near.index as usize].dot(normal) > 0.0;
        let clear = GAP * spacing;
        if self.found.iter().filter(same_sheet).any(|near| near.distance_sq < clear * clear) {
            return;
        }
        let mut is_weighted = false;
        neighbours.push(self.found.iter().map(|near| {
            let along = particles.normal[near.index as usize].dot(normal);
            is_weighted |= along < FULL_COSINE;
            (near.index, along > LISTED_COSINE)
        }));
        if is_weighted {
            self.found.iter().for_each(|near| neighbours.note_weighted(near.index as usize));
            neighbours.note_weighted(particles.len());
        }
        let level = particles.level[i] + 1;
        self.grid.insert(position, particles.len() as u32);
        // The particle has neighbours all around, so it places no children.
        let mut slots = Slots::default();
        slots.set(0, SlotFate::Parent);
        (1..6).for_each(|k| slots.set(k, SlotFate::Matched));
        particles.push(position, normal, self.radius, i as u32, level, slots);
        self.gaps.filled += 1;
        self.level.settled += 1;
    }
}

/// Returns the centre of the widest empty circle through the origin and two of the `points`, if its radius is above `least`.
pub(crate) fn widest_gap(points: &[Vec2], least: f32) -> Option<Vec2> {
    let mut widest = least;
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
