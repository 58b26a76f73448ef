//! The border of a refined surface: the curves along which the planes of the box cut it.
//!
//! Every vertex stores the planes of the box on which it lies. An inner particle lies on none and
//! moves on the surface; one on a plane slides along the curve in which the plane cuts the surface;
//! one on two planes is a corner, and is fixed.

mod clip;
mod mend;
#[cfg(test)]
mod tests;
mod thin;

pub(super) use clip::clip;
pub(crate) use clip::grown;

use super::net::{Ground, Net};
use super::refusal::Refusal;
use super::walls::{AT_REST, Planes, Site, Walls};
use crate::field::descent;
use crate::math::NONE;
use crate::math::newton::STEPS;
use crate::mesh::half_edge::{next, previous};
use crate::particles::{SlotFate, Slots};
use core::ops::Range;
use glam::Vec3;

/// Moves a point onto the surface and planes of the box; none if it would move by more than
/// `reach`, or out of the box.
fn land_on(walls: &Walls, ground: &mut Ground, planes: Planes, start: Vec3, reach: f32) -> Option<Site> {
    let place = walls.pinned(start, planes);
    let found = slide(ground, planes, place, reach)?;
    let inside = found.position.clamp(walls.lo, walls.hi);
    let is_within = (found.position - inside).abs().max_element() <= walls.slack;
    is_within.then_some(Site { position: inside, ..found })
}

/// Moves a point on planes of the box onto the surface, along those planes; none if it would move
/// by more than `reach`.
fn slide(ground: &mut Ground, planes: Planes, start: Vec3, reach: f32) -> Option<Site> {
    let (mut p, free) = (start, planes.free());
    for _ in 0..STEPS {
        let (value, gradient) = ground.probe.gradient(p);
        let step = descent::step(value, gradient * free);
        p -= step;
        // Written so that NaN fails.
        let is_within = p.distance(start) <= reach;
        if !is_within {
            return None;
        }
        if step.length() <= AT_REST * reach {
            return gradient.try_normalize().map(|normal| Site::smooth(p, normal, planes));
        }
    }
    None
}

impl Net {
    /// Whether three particles lie on one plane, or along one crease: on the border they are on one
    /// curve, and their triangle is not part of the surface.
    #[inline]
    pub(super) fn is_along_border(&self, corners: [u32; 3]) -> bool {
        let [a, b, c] = corners.map(|v| self.walls.planes(v));
        let common = a.common(b).common(c);
        !common.is_inner() && (!common.is_crease() || self.is_flat(corners))
    }

    /// Whether a triangle has an angle of 126° or more, like three successive particles on a
    /// crease.
    fn is_flat(&self, corners: [u32; 3]) -> bool {
        let [a, b, c] = corners.map(|v| self.position[v as usize]);
        let longest_sq = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
        self.area_vector(corners).length() < 0.25 * longest_sq
    }

    /// Whether a triangle at `v` has all its corners on one plane.
    pub(super) fn has_face_along_border(&self, v: u32) -> bool {
        self.walls.is_near()
            && self
                .mesh
                .around(v)
                .any(|h| self.is_along_border([h, next(h), previous(h)].map(|h| self.mesh.origin(h))))
    }

    /// The half-edges of the border that end and begin at a border vertex.
    fn border_edges(&self, v: u32) -> [u32; 2] {
        let first = self.mesh.outgoing(v);
        let last = self.mesh.around(v).last().unwrap_or(first);
        [previous(last), first]
    }

    /// Vector from a border vertex halfway to the middle between its neighbours along the border.
    /// Moving by it shortens the longest edges of the border.
    pub(super) fn way_along_border(&self, v: u32) -> Vec3 {
        let [before, after] = self.border_edges(v);
        let [a, b] = [self.mesh.origin(before), self.mesh.target(after)].map(|v| self.position[v as usize]);
        ((a + b) * 0.5 - self.position[v as usize]) * 0.5
    }

    /// The fates of a particle's slots. On the border, four neighbours take half of the hexagon and
    /// its sides; the other two slots lie beyond the box.
    pub(super) fn fates(&self, v: u32) -> Slots {
        let mut fates = self.slots[v as usize];
        if self.walls.is_near() && self.mesh.is_border(v) {
            [4, 5].into_iter().for_each(|slot| fates.set(slot, SlotFate::Outside));
        }
        fates
    }

    /// The planes common to both particles: planes of the box, or of a crease. Two ends of creases
    /// on one face of the box share that face.
    pub(super) fn common_planes(&self, a: u32, b: u32) -> Planes {
        let common = self.walls.planes(a).common(self.walls.planes(b));
        if common.of_box().is_inner() { common } else { common.of_box() }
    }

    /// The planes of a particle in the middle of an edge: those along which the edge runs, if it is
    /// on the border.
    pub(super) fn planes_between(&self, a: u32, b: u32) -> Planes {
        let common = self.common_planes(a, b);
        if common.is_inner() {
            return common;
        }
        if self.is_border_edge(a, b) { self.arc_between(a, b).unwrap_or(common) } else { Planes::INNER }
    }

    /// If two particles lie on one edge of the box: the plane along which the border runs between
    /// them. At each of them the border changes from one face at the edge to the other.
    fn arc_between(&self, a: u32, b: u32) -> Option<Planes> {
        let common = self.common_planes(a, b).of_box();
        if common.count() != 2 {
            return None;
        }
        [[a, b], [b, a]].into_iter().find_map(|[v, w]| {
            let [before, after] = self.border_edges(v);
            let beside = [self.mesh.origin(before), self.mesh.target(after)].into_iter().find(|&u| u != w)?;
            let other = self.common_planes(beside, v);
            (other.count() == 1 && other.common(common) == other).then(|| common.without(other))
        })
    }

    /// Whether the border of the surface runs along the edge between two particles.
    pub(super) fn is_border_edge(&self, a: u32, b: u32) -> bool {
        let is_border = |a: u32, b: u32| self.mesh.find(a, b).is_some_and(|h| self.mesh.twin(h) == NONE);
        is_border(a, b) || is_border(b, a)
    }

    /// Moves particles onto the surface by one step of Newton's method, like [`land`](Self::land);
    /// border particles for which one is not enough take several.
    ///
    /// # Errors
    ///
    /// If a particle does not reach the surface.
    pub(super) fn land_all(
        &mut self,
        ground: &mut Ground,
        spacing: f32,
        particles: Range<u32>,
        may_leave: bool,
    ) -> Result<(), Refusal> {
        self.land(ground, spacing, particles, may_leave);
        let refused = core::mem::take(&mut ground.block.refused);
        match refused.iter().find(|&&v| !self.rescue(ground, spacing, v, may_leave)) {
            Some(&v) => Err(Refusal::Folded { at: self.position[v as usize].into() }),
            None => Ok(()),
        }
    }

    /// Moves a border particle back onto the surface by several steps of Newton's method. Returns
    /// whether it got there.
    fn rescue(&mut self, ground: &mut Ground, spacing: f32, v: u32, may_leave: bool) -> bool {
        let (p, planes) = (self.position[v as usize], self.walls.planes(v));
        if planes.is_inner() {
            return false;
        }
        let site = if may_leave {
            slide(ground, planes, p, spacing)
        } else {
            land_on(&self.walls, ground, planes, p, spacing)
        };
        if let Some(site) = site {
            self.put(v, site);
        }
        site.is_some()
    }

    /// Whether the surface has a border.
    pub(super) fn has_border(&self) -> bool {
        self.walls.is_near() && self.mesh.edges().any(|h| self.mesh.twin(h) == NONE)
    }

    /// Length of the border at the box along some faces, in units of the local wanted spacing.
    pub(super) fn border_of(&self, faces: Range<u32>) -> f64 {
        if !self.walls.is_near() {
            return 0.0;
        }
        let is_border = |&h: &u32| {
            let is_at_end = self.mesh.has_half_edge(h) && self.mesh.twin(h) == NONE;
            is_at_end && !self.common_planes(self.mesh.origin(h), self.mesh.target(h)).is_crease()
        };
        let length = |h: u32| self.length(h) / self.size_between(self.mesh.origin(h), self.mesh.target(h));
        (3 * faces.start..3 * faces.end).filter(is_border).map(|h| f64::from(length(h))).sum()
    }

    /// Length of an edge.
    fn length(&self, h: u32) -> f32 {
        let [a, b] = [self.mesh.origin(h), self.mesh.target(h)];
        self.position[a as usize].distance(self.position[b as usize])
    }
}
