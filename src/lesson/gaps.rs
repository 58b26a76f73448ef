//! Fills the gaps that fronts leave where they meet. The paper leaves them to the relaxation
//! (§4.5).

use super::course::Course;
use super::event::Event;
use crate::math::frame_of;
use crate::paper::{ChildSlot, Circle};
use crate::particles::SlotFate;
use glam::{DVec2, DVec3};

/// A gap is filled if its centre is at least this far from every particle, in 2r. In the triangles
/// of a lattice the distance is 0.577. Smaller: more particles are added; larger: wider holes stay.
const NARROWEST: f64 = 0.8;

/// A wider circle, in 2r, touches the border of the surface.
const WIDEST: f64 = 1.25;

/// Neighbours within this many radii surround a gap: the lattice's first ring is at 2, and the
/// narrowest circle's diameter ends at 3.2.
const REACH: f64 = 3.4;

impl Course {
    /// Fills the widest gap next to a particle if a new particle has room there.
    pub(super) fn fill_beside(&mut self, beside: u32) {
        let run = &mut self.run;
        let own = run.particles[beside as usize];
        let (p, n, r) = (own.p(), own.n(), self.setup.settings.radius);
        let (u, w) = frame_of(own.normal);
        let (u, w): (DVec3, DVec3) = (u.into(), w.into());
        // Neighbours keep their direction in the tangent plane and their distance in space. Lengths
        // are in 2r.
        let plane: Vec<DVec2> = run
            .buckets
            .near(&run.particles, p, REACH * r)
            .iter()
            .filter_map(|near| {
                let other = &run.particles[near.particle as usize];
                let flat = DVec2::new((other.p() - p).dot(u), (other.p() - p).dot(w));
                let is_listed = near.particle != beside && other.n().dot(n) > 0.0 && flat.length() > 0.0;
                is_listed.then(|| flat * (near.distance / (flat.length() * 2.0 * r)))
            })
            .collect();
        let centre = widest_gap(&plane);
        run.seen.push(Event::Gap { particle: beside, width: centre.map(|centre| centre.length() * 2.0 * r) });
        let Some(centre) = centre else { return };
        if run.particles.len() >= run.rules.max_particles {
            return;
        }
        let direction = (u * centre.x + w * centre.y) / centre.length();
        let radius = centre.length() * 2.0 * r;
        let circle = Circle { centre: p, normal: n, direction, radius, start_rad: 0.0 };
        let Ok((position, normal)) = run.surface.land_on_circle(&circle, run.rules.residual * r, &mut |_| {})
        else {
            return;
        };
        let is_free = run
            .buckets
            .near(&run.particles, position, NARROWEST * 2.0 * r)
            .iter()
            .all(|near| run.particles[near.particle as usize].n().dot(normal) <= 0.0);
        if !is_free || !run.surface.bounds.holds(position) || normal.dot(n) <= 0.0 {
            return;
        }
        // It is surrounded by neighbours and places no children.
        let placed = run.child(beside, (position, normal), r);
        let parent = run.enter(placed);
        run.seen.push(Event::Added { particle: parent, data: placed });
        run.decide(ChildSlot { parent, slot: 0 }, SlotFate::Parent, Some(beside));
        for slot in 1..6 {
            run.decide(ChildSlot { parent, slot }, SlotFate::Matched, None);
        }
        self.finish(parent);
    }
}

/// Centre of the widest empty circle through the origin and two of the points, if that is a gap.
fn widest_gap(points: &[DVec2]) -> Option<DVec2> {
    let mut widest = NARROWEST;
    let mut found = None;
    for (k, &a) in points.iter().enumerate() {
        for &b in &points[..k] {
            let twice_area = a.perp_dot(b);
            let (aa, bb) = (a.length_squared(), b.length_squared());
            let centre = DVec2::new(b.y * aa - a.y * bb, a.x * bb - b.x * aa) / (2.0 * twice_area);
            let width = centre.length();
            let is_empty = || points.iter().all(|q| q.distance(centre) >= width * (1.0 - 5e-5));
            if width > widest && width < WIDEST && is_empty() {
                (widest, found) = (width, Some(centre));
            }
        }
    }
    found
}
