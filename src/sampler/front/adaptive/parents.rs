//! The parents of a level of the adaptive front, with the curvature and the gradient of the radius
//! at each. These are kept for the level under way, for its children and for the parents of a later
//! filling, not for the particles behind the front.

use crate::differential::Curvature;
use crate::math::sort_by_key;
use glam::Vec3;

/// The second-order shape of the surface at a particle and the gradient of the radius there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalShape {
    pub(crate) curvature: Curvature,
    /// Gradient of the radius along the surface. Until the particle places its children it is the
    /// parent's.
    pub(crate) slope: Vec3,
}

/// A particle that places children.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Parent {
    pub(crate) particle: u32,
    /// Whether the particle has placed children before.
    pub(crate) has_placed: bool,
    pub(crate) local: LocalShape,
}

/// The parents of this level, of the next one and of the next filling.
#[derive(Clone, Debug, Default)]
pub(crate) struct Parents {
    /// Parents of the level under way.
    pub(crate) level: Vec<Parent>,
    /// The local shapes at the children placed in this level, in their order.
    pub(crate) born: Vec<LocalShape>,
    /// Parents of the next filling: a child of theirs collided, or a radius differed much from its
    /// prediction.
    seams: Vec<Parent>,
}

impl Parents {
    /// Adds a particle that has placed no children to this level.
    pub(crate) fn add(&mut self, particle: u32, local: LocalShape) {
        self.level.push(Parent { particle, has_placed: false, local });
    }

    /// Makes the children the parents of the next level. `first` is the index of the first of them.
    pub(crate) fn next_level(&mut self, first: usize) {
        self.level.clear();
        let born = (first as u32..).zip(self.born.drain(..));
        self.level.extend(born.map(|(particle, local)| Parent { particle, has_placed: false, local }));
    }

    /// Ends the level and begins no other.
    pub(crate) fn stop(&mut self) {
        self.level.clear();
        self.born.clear();
    }

    /// Makes a particle a parent of the next filling.
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

    /// Begins a level with the parents of the filling. Returns false if there are none.
    pub(crate) fn fill(&mut self) -> bool {
        core::mem::swap(&mut self.level, &mut self.seams);
        self.seams.clear();
        // The local shape from the time when a particle placed its children is newer than the one
        // from its own placement.
        sort_by_key(&mut self.level, |parent| {
            u64::from(parent.particle) << 1 | u64::from(!parent.has_placed)
        });
        self.level.dedup_by_key(|parent| parent.particle);
        // One that was noted when it was placed has placed its children since.
        self.level.iter_mut().for_each(|parent| parent.has_placed = true);
        !self.level.is_empty()
    }
}

/// Returns the second fundamental form in the frame (u, w): a, b, c of [a b; b c].
pub(crate) fn shape_in(curvature: &Curvature, u: Vec3, w: Vec3) -> [f32; 3] {
    let d = curvature.direction;
    let (x, y) = (d.dot(u), d.dot(w));
    // The direction of κ₂ is that of κ₁ turned by 90°.
    let (k1, k2) = (curvature.k1, curvature.k2);
    let shape = [k1 * x * x + k2 * y * y, (k1 - k2) * x * y, k1 * y * y + k2 * x * x];
    if shape.iter().all(|k| k.is_finite()) { shape } else { [0.0; 3] }
}
