//! The colours of a mesh at places near it.

use super::TriangleMesh;
use super::tree::Tree;
use glam::DVec3;
use std::sync::OnceLock;

/// A mesh with a colour at each vertex, as it was before its repair.
pub(super) struct Colours {
    /// Relative to the origin of the solid.
    mesh: TriangleMesh,
    colours: Vec<[f32; 3]>,
    /// Made when a colour is first asked for.
    tree: OnceLock<Tree>,
}

impl Colours {
    pub(super) fn new(mesh: TriangleMesh, colours: Vec<[f32; 3]>) -> Self {
        Self { mesh, colours, tree: OnceLock::new() }
    }

    /// The colour at the point of the mesh that is nearest to `p`, between those of the corners of
    /// its face.
    pub(super) fn at(&self, p: DVec3) -> [f32; 3] {
        let tree = self.tree.get_or_init(|| Tree::new(&self.mesh.all_corners()));
        let found = tree.nearest(p);
        let face = &self.mesh.faces()[found.triangle as usize];
        let corners = self.mesh.corners(face);
        let opposite = |k: usize| {
            let [a, b] = [1, 2].map(|step| corners[(k + step) % 3] - found.point);
            a.cross(b).length()
        };
        let mut shares = [0, 1, 2].map(opposite);
        let sum: f64 = shares.iter().sum();
        if sum <= 0.0 {
            // The face has no area: the colour of its nearest corner.
            let distance = |k: &usize| corners[*k].distance_squared(found.point);
            let nearest = (0..3).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0);
            return self.colours[face[nearest] as usize];
        }
        shares.iter_mut().for_each(|share| *share /= sum);
        let part = |channel: usize| {
            let own = face.iter().zip(shares);
            own.map(|(&corner, share)| f64::from(self.colours[corner as usize][channel]) * share).sum::<f64>()
                as f32
        };
        [0, 1, 2].map(part)
    }
}
