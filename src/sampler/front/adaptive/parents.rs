//! Who places children in a level of the adaptive front, and what they know. It is kept for the level under way, for those
//! born in it and for those that are to look for room again, not for the particles behind the front.

use crate::differential::Curvature;
use glam::Vec3;

/// What a particle knows of the surface and of the radii around it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bend {
    pub(crate) curvature: Curvature,
    /// Gradient of the radius; that of its parent until the particle places its children.
    pub(crate) slope: Vec3,
}

/// A particle that places children.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Parent {
    pub(crate) particle: u32,
    /// Whether it has placed some before.
    pub(crate) has_placed: bool,
    pub(crate) bend: Bend,
}

/// The parents of a level and of those to come.
#[derive(Clone, Debug, Default)]
pub(crate) struct Parents {
    /// Of the level under way.
    pub(crate) level: Vec<Parent>,
    /// What the particles born in this level know, in their order.
    pub(crate) born: Vec<Bend>,
    /// Those that lost a child to another particle, or were surprised by a radius.
    seams: Vec<Parent>,
}

impl Parents {
    pub(crate) fn clear(&mut self) {
        self.level.clear();
        self.born.clear();
        self.seams.clear();
    }

    /// Adds a particle that has placed no children to the level.
    pub(crate) fn add(&mut self, particle: u32, bend: Bend) {
        self.level.push(Parent { particle, has_placed: false, bend });
    }

    /// Goes on to the particles born, the first of which is `first`.
    pub(crate) fn next_level(&mut self, first: usize) {
        self.level.clear();
        let born = (first as u32..).zip(self.born.drain(..));
        self.level.extend(born.map(|(particle, bend)| Parent { particle, has_placed: false, bend }));
    }

    /// Ends the level and begins no other.
    pub(crate) fn stop(&mut self) {
        self.level.clear();
        self.born.clear();
    }

    /// Has a particle look for room again.
    pub(crate) fn note_seam(&mut self, parent: Parent) {
        // The children of a parent come one after the other.
        if self.seams.last().is_none_or(|last| last.particle != parent.particle) {
            self.seams.push(parent);
        }
    }

    /// Forgets the particles from `len` on.
    pub(crate) fn truncate(&mut self, len: usize) {
        self.seams.retain(|parent| (parent.particle as usize) < len);
    }

    /// Goes on to the particles that are to look for room again; false if there are none.
    pub(crate) fn fill(&mut self) -> bool {
        core::mem::swap(&mut self.level, &mut self.seams);
        self.seams.clear();
        // What a particle knew when it placed its children is newer than what it knew when it was placed.
        self.level.sort_unstable_by_key(|parent| (parent.particle, !parent.has_placed));
        self.level.dedup_by_key(|parent| parent.particle);
        !self.level.is_empty()
    }
}

/// Second fundamental form in the frame (u, w).
pub(crate) fn shape_in(curvature: &Curvature, u: Vec3, w: Vec3) -> [f32; 3] {
    let d = curvature.direction;
    let (x, y) = (d.dot(u), d.dot(w));
    // The direction of κ₂ is that of κ₁ turned by 90°.
    let (k1, k2) = (curvature.k1, curvature.k2);
    let shape = [k1 * x * x + k2 * y * y, (k1 - k2) * x * y, k1 * y * y + k2 * x * x];
    if shape.iter().all(|k| k.is_finite()) { shape } else { [0.0; 3] }
}
