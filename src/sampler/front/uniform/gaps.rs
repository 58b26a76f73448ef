//! Gaps are filled that fronts leave along their seams. The paper's front stops there.
//!
//! Six slots per particle cover the plane without gaps as long as one lattice grows. Where two
//! fronts meet out of step, a gap can be too narrow for every slot around it and still wide enough
//! for a particle. The pass visits each particle with a slot that is matched by a particle far from
//! the slot. It finds the widest empty circle through this particle and two of its neighbours (a
//! Delaunay triangle in the tangent plane), and places a particle at the centre if that is far
//! enough from all others.

use super::UniformPlacing;
use crate::math::tangent_frame;
use crate::particles::{SlotFate, Slots};
use crate::sampler::front::level::{FrontContext, FrontLevel, Placing};
use crate::sampler::neighbours::constants::{GAUSSIAN_RANGE, GAUSSIAN_SKIN};
use crate::sampler::projection::{ChildCircle, CircleLanding};
use crate::sampler::sheet::face_one_way;
use crate::spatial::Neighbour;
use glam::Vec2;

/// A slot lies on a seam if the particle that matches it is farther away than this share of 2r.
/// Inside a lattice the distance is below 0.2. Larger: gaps stay.
pub(crate) const SEAM: f32 = 0.35;

/// A gap is filled if its centre is at least this far from every particle, in 2r. The triangles of
/// a lattice have 0.577; a hole of 1.45 times the ideal size has 0.84. Smaller: holes are smaller,
/// and so are the smallest angles of triangles.
const GAP: f32 = 0.8;

/// A circle of a larger radius, in 2r, lies at the border of the surface and is no gap.
const WIDEST: f32 = 1.25;

/// Largest number of neighbours considered. The two rings of a lattice have 18.
const CAPACITY: usize = 24;

impl UniformPlacing {
    /// Visits up to `budget` particles on seams and returns the rest of the budget.
    pub(in crate::sampler::front) fn fill_gaps(
        &mut self,
        level: &mut FrontLevel,
        context: &mut FrontContext,
        mut budget: u32,
    ) -> u32 {
        while budget > 0 && self.begin_filling(level) {
            let i = self.seams[self.next_seam] as usize;
            self.next_seam += 1;
            budget -= 1;
            if context.particles.len() < level.max_particles {
                self.fill_beside(level, context, i);
            }
        }
        budget
    }

    /// Fills the widest gap beside particle `i`, if a particle has room there.
    fn fill_beside(&mut self, level: &mut FrontLevel, context: &mut FrontContext, i: usize) {
        let FrontContext { probe, neighbours, particles, .. } = context;
        let (p, n, patch) = (particles.local[i], particles.normal[i], particles.patch_of(i));
        let probe = &mut probe.on(patch);
        let spacing = 2.0 * self.radius;
        let reach = (GAUSSIAN_RANGE + GAUSSIAN_SKIN) * self.radius;
        level.gather(particles, patch, p, |_| reach);
        // The neighbours of the sheet are mapped to the tangent plane: they keep their direction
        // there and their distance in space. The unit is 2r.
        let (u, w) = tangent_frame(n);
        let mut plane = [Vec2::ZERO; CAPACITY];
        let mut count = 0;
        for near in &level.found {
            let j = near.index as usize;
            let flat = Vec2::new(near.offset.dot(u), near.offset.dot(w));
            let length = flat.length();
            if j != i && count < CAPACITY && face_one_way(particles.normal[j], n) && length > 0.0 {
                plane[count] = flat * (near.distance_sq.sqrt() / (length * spacing));
                count += 1;
            }
        }
        let Some(centre) = widest_gap(&plane[..count], GAP) else { return };
        let width = centre.length();
        let direction = (u * centre.x + w * centre.y) / width;
        let circle =
            ChildCircle { centre: p, normal: n, direction, radius: width * spacing, guess: [1.0, 0.0] };
        probe.land_on_circles(&[circle], self.tolerance, &mut self.landings);
        let CircleLanding::On { position, normal } = self.landings[0] else { return };
        let is_inside =
            level.bounds.contains(position) && probe.is_on_patch(position, normal, self.radius, patch);
        if !is_inside || !face_one_way(normal, n) {
            return;
        }
        level.gather(particles, patch, position, |_| reach);
        let same_sheet = |near: &&Neighbour| face_one_way(particles.normal[near.index as usize], normal);
        let clear = GAP * spacing;
        if level.found.iter().filter(same_sheet).any(|near| near.distance_sq < clear * clear) {
            return;
        }
        neighbours.list(&level.found, |near| (true, particles.normal[near.index as usize].dot(normal)));
        level.grids.insert(position, self.radius, particles.len() as u32);
        // The particle has neighbours all around, so it places no children.
        let mut slots = Slots::default();
        slots.set(0, SlotFate::Parent);
        (1..6).for_each(|k| slots.set(k, SlotFate::Matched));
        particles.push(position, normal, self.radius, i as u32, particles.level[i] + 1, slots);
        level.filled += 1;
        level.settled += 1;
    }
}

/// Returns the centre of the widest empty circle through the origin and two of the `points`, if its
/// radius is above `least`.
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
                // Rounding may put the three points themselves inside.
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
