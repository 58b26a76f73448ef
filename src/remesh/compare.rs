//! How far a new mesh is from the old one.

use super::tree::Tree;
use super::{MeshField, TriangleMesh};
use crate::math::sort_numbers;
use crate::slices;
use glam::DVec3;
use serde::Serialize;

/// Points within the faces of each mesh from which distances are measured, besides its vertices.
const POINTS: f64 = 50_000.0;
/// Points in a slice of work.
const AT_ONCE: usize = 32;

/// Distances of points from a surface, in the units of the mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[non_exhaustive]
pub struct MeshDistances {
    /// Mean distance.
    pub mean: f64,
    /// 99th percentile.
    pub most: f64,
    /// Largest distance.
    pub largest: f64,
}

/// The comparison of a mesh with the one that was sampled from it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[non_exhaustive]
pub struct MeshChange {
    /// Diagonal of the box of the old mesh.
    pub diagonal: f64,
    /// Distances of points of the old mesh from the new one.
    pub to_new: MeshDistances,
    /// Distances of points of the new mesh from the old one.
    pub to_old: MeshDistances,
    /// Volume of the old and the new mesh; for an open mesh it depends on the origin.
    pub volume: [f64; 2],
    /// Area of the old and the new mesh.
    pub area: [f64; 2],
    /// Largest distance from the sharp edges of the old mesh to the new mesh; none without sharp
    /// edges.
    pub edges: Option<f64>,
}

impl MeshField {
    /// Compares a mesh of this field, such as [`buffers`](crate::Sample::buffers), with the mesh
    /// that the field was made from.
    ///
    /// # Panics
    ///
    /// If an index is beyond the vertices.
    #[must_use]
    pub fn compare(&self, vertices: &[DVec3], faces: &[[u32; 3]]) -> MeshChange {
        let work = || slices::complete(self.clone().compared(vertices.to_vec(), faces.to_vec()));
        slices::in_pool(work)
    }

    /// [`MeshField::compare`] in slices.
    pub(crate) async fn compared(self, mut vertices: Vec<DVec3>, faces: Vec<[u32; 3]>) -> MeshChange {
        vertices.iter_mut().for_each(|p| *p -= self.solid().origin());
        let (old, new) = (self.solid().mesh(), TriangleMesh::of_parts(vertices, faces));
        let tree = Tree::new(&new.all_corners());
        let to_new = from_all(&tree, &points_on(old)).await;
        let to_old = from_all(&self.solid().tree, &points_on(&new)).await;
        let edges = from_all(&tree, &self.edge_points()).await;
        MeshChange {
            diagonal: old.bounds().diagonal(),
            to_new: summary(to_new),
            to_old: summary(to_old),
            volume: [old.volume(), new.volume()],
            area: [old.area(), new.area()],
            edges: edges.into_iter().reduce(f64::max),
        }
    }
}

/// The vertices of the faces, and points within the faces in proportion to their areas.
fn points_on(mesh: &TriangleMesh) -> Vec<DVec3> {
    /// Steps of the two coordinates of evenly spread points: 1/p and 1/p² with p³ = p + 1 (M.
    /// Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018).
    const STEPS: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];
    let mut used: Vec<u32> = mesh.faces().as_flattened().to_vec();
    used.sort_unstable();
    used.dedup();
    let mut points: Vec<DVec3> = used.iter().map(|&vertex| mesh.vertices()[vertex as usize]).collect();
    let (total, mut sum, mut made) = (mesh.area(), 0.0, 0.0);
    for (face, vector) in mesh.faces().iter().zip(mesh.area_vectors()) {
        let [a, b, c] = mesh.corners(face);
        sum += vector.length();
        while made + 0.5 < POINTS * sum / total {
            made += 1.0;
            let [mut u, mut v] = STEPS.map(|step| (made * step).fract());
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            points.push(a + (b - a) * u + (c - a) * v);
        }
    }
    points
}

async fn from_all(tree: &Tree, points: &[DVec3]) -> Vec<f64> {
    let distance = |p: &DVec3| libm::sqrt(tree.nearest(*p).distance_sq);
    let found = slices::map(
        points.len(),
        AT_ONCE,
        || (),
        |(), range| points[range].iter().map(distance).collect::<Vec<_>>(),
    );
    found.await.into_iter().flatten().collect()
}

fn summary(mut distances: Vec<f64>) -> MeshDistances {
    let mean = distances.iter().sum::<f64>() / distances.len().max(1) as f64;
    sort_numbers(&mut distances);
    let at = |share: f64| distances.get((share * distances.len() as f64) as usize).copied();
    let largest = distances.last().copied().unwrap_or(f64::NAN);
    MeshDistances { mean, most: at(0.99).unwrap_or(largest), largest }
}
