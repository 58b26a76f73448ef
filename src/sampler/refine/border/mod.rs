//! The border of a refined surface: the curves along which the faces of the box cut it.
//!
//! Every vertex knows the faces of the box on which it lies. An inner particle lies on none and moves on the surface; one on a face
//! slides along the curve in which the face cuts the surface; one on two faces is a corner, and stays.

mod clip;
mod cover;
mod mend;
#[cfg(test)]
mod tests;
mod thin;

pub(super) use clip::clip;
pub(crate) use clip::grown;
pub(super) use cover::judge_cover;

use super::layer::{Ground, Layer};
use super::walls::{Planes, Walls};
use crate::mesh::half_edge::{NONE, next, previous};
use crate::particles::{SlotFate, Slots};
use core::ops::Range;
use glam::Vec3;

/// Steps of Newton's method to a curve or a corner.
const STEPS: u32 = 8;
/// A landing is at its end when a step is shorter than this share of its reach.
const AT_REST: f32 = 1e-4;
/// Depth, as a share of the spacing, to which the middle of an edge is put that came to lie beyond a face.
const DEPTH: f32 = 0.2;
/// A border particle has two neighbours along the border and wants two more, for three triangles of 60°.
const BORDER_VALENCE: i32 = 4;
/// Cosine of 150°. A corner of an angle φ wants φ/60° triangles, rounded: one up to 90°, two up to here, then three.
const COS_150: f32 = -0.866_025_4;
/// Springs along the border are stiffer per neighbour than all round: 0.7 instead of 0.6 at θ = 0.8.
const BORDER_PACE: f32 = 0.85;

/// Moves a point onto the surface and the faces of the walls, with the normal there; none if it would move by more than `reach`, or
/// out of the box.
fn land_on(
    walls: &Walls,
    ground: &mut Ground,
    planes: Planes,
    start: Vec3,
    reach: f32,
) -> Option<(Vec3, Vec3)> {
    let place = walls.pinned(start, planes);
    let found = slide(ground, planes.free(), place, reach)?;
    let inside = found.0.clamp(walls.lo, walls.hi);
    ((found.0 - inside).abs().max_element() <= walls.slack).then_some((inside, found.1))
}

/// Moves a point onto the surface along the axes that are free.
fn slide(ground: &mut Ground, free: Vec3, start: Vec3, reach: f32) -> Option<(Vec3, Vec3)> {
    let mut p = start;
    for _ in 0..STEPS {
        let (value, gradient) = ground.probe.gradient(p);
        let slope = gradient * free;
        let step = slope * (value / slope.length_squared());
        p -= step;
        // Written so that NaN fails.
        let is_within = p.distance(start) <= reach;
        if !is_within {
            return None;
        }
        if step.length() <= AT_REST * reach {
            return gradient.try_normalize().map(|normal| (p, normal));
        }
    }
    None
}

impl Layer {
    /// The valence of a border particle without a defect.
    pub(super) fn wanted_at_border(&self, v: u32) -> i32 {
        let planes = self.walls.planes(v);
        if !planes.is_corner() {
            return BORDER_VALENCE;
        }
        // In the tangent plane the box leaves the half-planes behind its faces, whose outward normals are these.
        let n = self.normal[v as usize];
        let outward = |plane: usize| {
            let e = Vec3::AXES[plane / 2] * if plane.is_multiple_of(2) { -1.0 } else { 1.0 };
            (e - n * e.dot(n)).normalize_or_zero()
        };
        let mut faces = planes.each().map(outward);
        let (Some(a), Some(b)) = (faces.next(), faces.next()) else { return BORDER_VALENCE };
        let cos = -a.dot(b);
        1 + if cos > 0.0 {
            1
        } else if cos > COS_150 {
            2
        } else {
            3
        }
    }

    /// Whether three particles lie on one face: on the border they are on one curve, and their triangle is no part of the surface.
    #[inline]
    pub(super) fn is_along_border(&self, corners: [u32; 3]) -> bool {
        let [a, b, c] = corners.map(|v| self.walls.planes(v));
        !a.common(b).common(c).is_inner()
    }

    /// Whether a triangle at `v` has all its corners on one face.
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

    /// From a border vertex half-way to the middle between its neighbours along the border.
    pub(super) fn way_along_border(&self, v: u32) -> Vec3 {
        let [before, after] = self.border_edges(v);
        let [a, b] = [self.mesh.origin(before), self.mesh.target(after)].map(|v| self.position[v as usize]);
        ((a + b) * 0.5 - self.position[v as usize]) * 0.5
    }

    /// The fates of a particle's slots. On the border, four neighbours take half of the hexagon and its sides; the other two slots
    /// lie beyond the box.
    pub(super) fn fates(&self, v: u32) -> Slots {
        let mut fates = self.slots[v as usize];
        if !self.walls.planes(v).is_inner() {
            [4, 5].into_iter().for_each(|slot| fates.set(slot, SlotFate::Outside));
        }
        fates
    }

    /// What a step by springs is multiplied by.
    #[inline]
    pub(super) fn pace(&self, v: u32) -> f32 {
        if self.walls.planes(v).is_inner() { 1.0 } else { BORDER_PACE }
    }

    /// The faces of the particle on the middle of an edge: those on which the edge runs along the border.
    pub(super) fn planes_between(&self, a: u32, b: u32) -> Planes {
        let common = self.walls.planes(a).common(self.walls.planes(b));
        if common.is_inner() {
            return common;
        }
        let is_border = |a: u32, b: u32| self.mesh.find(a, b).is_some_and(|h| self.mesh.twin(h) == NONE);
        if is_border(a, b) || is_border(b, a) { common } else { Planes::INNER }
    }

    /// Brings a particle back that one step of Newton's method could not: one on the border by more steps, an inner one that came
    /// to lie beyond a face to a place before it. Returns whether that could be done.
    pub(super) fn rescue(&mut self, ground: &mut Ground, spacing: f32, v: u32) -> bool {
        if !self.walls.is_near() {
            return false;
        }
        let (p, walls, planes) = (self.position[v as usize], &self.walls, self.walls.planes(v));
        let landing = if planes.is_inner() {
            let margin = Vec3::splat(DEPTH * spacing).min((walls.hi - walls.lo) * 0.5);
            let inside = p.clamp(walls.lo + margin, walls.hi - margin);
            let free = Vec3::select(inside.cmpeq(p), Vec3::ONE, Vec3::ZERO);
            // Where nothing has to be moved inward, the step has failed for another reason.
            if free == Vec3::ONE { None } else { slide(ground, free, inside, spacing) }
        } else {
            land_on(walls, ground, planes, p, spacing)
        };
        let Some((position, normal)) = landing.filter(|(place, _)| walls.contains(*place)) else {
            return false;
        };
        self.position[v as usize] = position;
        self.normal[v as usize] = normal;
        true
    }

    /// Whether the surface has a border.
    pub(super) fn has_border(&self) -> bool {
        self.walls.is_near() && self.mesh.edges().any(|h| self.mesh.twin(h) == NONE)
    }

    /// Length of the border along some faces, in units of the spacing that is wanted where it is.
    pub(super) fn border_of(&self, faces: Range<u32>) -> f64 {
        if !self.walls.is_near() {
            return 0.0;
        }
        let is_border = |&h: &u32| self.mesh.has_half_edge(h) && self.mesh.twin(h) == NONE;
        let length = |h: u32| self.length(h) / self.size_between(self.mesh.origin(h), self.mesh.target(h));
        (3 * faces.start..3 * faces.end).filter(is_border).map(|h| f64::from(length(h))).sum()
    }

    /// Length of an edge.
    fn length(&self, h: u32) -> f32 {
        let [a, b] = [self.mesh.origin(h), self.mesh.target(h)];
        self.position[a as usize].distance(self.position[b as usize])
    }
}
