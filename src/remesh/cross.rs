//! Faces of a mesh that intersect each other.

use super::MeshSolid;
use crate::math::Bounds;
use crate::slices;
use glam::DVec3;

/// Faces in a slice of work.
const AT_ONCE: usize = 32;

/// Number of slices that [`MeshSolid::intersection`] takes.
pub(super) fn slices(solid: &MeshSolid) -> u64 {
    solid.mesh().faces().len().div_ceil(AT_ONCE) as u64
}

impl MeshSolid {
    /// A point where a side of one face pierces another face; none if no two faces intersect. Faces
    /// that share a corner are not compared. Found in slices of work.
    pub(super) async fn intersection(&self) -> Option<DVec3> {
        let (mesh, tree) = (&*self.mesh, &*self.tree);
        let of_face = |face: usize| {
            let own = mesh.faces()[face];
            let corners = mesh.corners(&own);
            let mut found = None;
            tree.in_box(&Bounds::around(corners), |other| {
                let others = mesh.faces()[other as usize];
                if found.is_none() && !own.iter().any(|corner| others.contains(corner)) {
                    let other = mesh.corners(&others);
                    found = (0..3).find_map(|k| crossing(corners[k], corners[(k + 1) % 3], &other));
                }
            });
            found
        };
        let count = mesh.faces().len();
        let all = slices::map(count, AT_ONCE, || (), |(), mut range| range.find_map(of_face));
        all.await.into_iter().flatten().next()
    }
}

/// The point where a segment passes through the inside of a triangle.
fn crossing(a: DVec3, b: DVec3, [p, q, r]: &[DVec3; 3]) -> Option<DVec3> {
    /// Share of the sizes that counts as touching.
    const TOUCHING: f64 = 1e-6;
    let normal = (*q - *p).cross(*r - *p);
    let [u, v] = [a, b].map(|end| (end - *p).dot(normal));
    if u * v >= 0.0 || u.abs().min(v.abs()) <= TOUCHING * (u - v).abs() {
        return None;
    }
    let at = a.lerp(b, u / (u - v));
    let least = TOUCHING * normal.length_squared();
    let is_left = |from: DVec3, to: DVec3| (to - from).cross(at - from).dot(normal) > least;
    (is_left(*p, *q) && is_left(*q, *r) && is_left(*r, *p)).then_some(at)
}
