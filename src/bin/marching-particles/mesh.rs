//! Counts of the mesh of `--mesh`, for the output.

use marching_particles::MeshAnswer;
use serde::Serialize;

/// Counts of a mesh, as the output gives them.
#[derive(Debug, Serialize)]
pub(crate) struct Mesh {
    pub(crate) triangles: usize,
    pub(crate) components: usize,
    /// Sum over the components.
    pub(crate) euler: i64,
    /// Border loops where the surface ends.
    pub(crate) borders: usize,
    /// Border loops where no manifold could be had.
    pub(crate) holes: usize,
    /// Particles in no triangle.
    pub(crate) left_out: usize,
    /// Volume that it encloses; none where it is open.
    pub(crate) volume: Option<f64>,
    /// Smallest angle of any triangle in degrees, those at borders among them.
    pub(crate) smallest_angle: Option<f64>,
}

impl Mesh {
    pub(crate) fn new(mesh: &MeshAnswer) -> Self {
        Self {
            triangles: mesh.triangles,
            components: mesh.components.len(),
            euler: mesh.components.iter().map(|component| component.euler).sum(),
            borders: mesh.borders,
            holes: mesh.unfilled,
            left_out: mesh.left_out,
            volume: mesh.volume,
            smallest_angle: mesh.smallest_angle,
        }
    }
}
