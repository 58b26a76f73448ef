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
    /// Volume of the old and the new mesh; for an open mesh it depends on the origin. That of old
    /// bodies that intersect is the volume of their union, estimated from points on its surface to
    /// about a thousandth.
    pub volume: [f64; 2],
    /// Area of the old and the new mesh; of a union estimated, too.
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
        let old_surface = self.surface();
        let places = |surface: &[SurfacePoint]| surface.iter().map(|own| own.place).collect::<Vec<_>>();
        let to_new = from_all(&tree, &places(&old_surface)).await;
        let to_old = from_all(&self.solid().tree, &places(&points_on(&new))).await;
        let edges = from_all(&tree, &self.edge_points()).await;
        let (old_volume, old_area) = if self.bodies().is_empty() {
            (old.volume(), old.area())
        } else {
            // Divergence theorem.
            let volume = old_surface.iter().map(|own| own.place.dot(own.vector) / 3.0).sum();
            (volume, old_surface.iter().map(|own| own.vector.length()).sum())
        };
        MeshChange {
            diagonal: old.bounds().diagonal(),
            to_new: summary(to_new),
            to_old: summary(to_old),
            volume: [old_volume, new.volume()],
            area: [old_area, new.area()],
            edges: edges.into_iter().reduce(f64::max),
        }
    }

    /// Points of the surface of the old mesh, relative to its origin: those of its faces, and of
    /// bodies that intersect those that are in no other.
    fn surface(&self) -> Vec<SurfacePoint> {
        /// Share of the diagonal, above the precision of a file with single-precision numbers.
        const OUTSIDE: f64 = 1e-5;
        let bodies = self.bodies();
        if bodies.is_empty() {
            return points_on(self.solid().mesh());
        }
        let of_body = |k: usize| {
            let origin = bodies[k].solid().origin();
            let own = points_on(bodies[k].solid().mesh()).into_iter();
            // A face that is flush with one of another body is in that body, seen from just
            // outside.
            let lift = OUTSIDE * self.solid().mesh().bounds().diagonal();
            let outermost = own.filter(move |own| {
                self.is_outermost(k, origin + own.place + lift * own.vector.normalize_or_zero())
            });
            outermost
                .map(move |own| SurfacePoint { place: own.place + (origin - self.solid().origin()), ..own })
        };
        (0..bodies.len()).flat_map(of_body).collect()
    }
}

/// A point of a mesh.
struct SurfacePoint {
    place: DVec3,
    /// The area for which it stands, times the unit normal; zero for a vertex.
    vector: DVec3,
}

/// The vertices of the faces, and points within the faces in proportion to their areas.
fn points_on(mesh: &TriangleMesh) -> Vec<SurfacePoint> {
    /// Steps of the two coordinates of evenly spread points: 1/p and 1/p² with p³ = p + 1 (M.
    /// Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018).
    const STEPS: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];
    let mut used: Vec<u32> = mesh.faces().as_flattened().to_vec();
    used.sort_unstable();
    used.dedup();
    let at = |&vertex: &u32| SurfacePoint { place: mesh.vertices()[vertex as usize], vector: DVec3::ZERO };
    let mut points: Vec<SurfacePoint> = used.iter().map(at).collect();
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
            let place = a + (b - a) * u + (c - a) * v;
            points.push(SurfacePoint { place, vector: vector * (total / (POINTS * vector.length())) });
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
