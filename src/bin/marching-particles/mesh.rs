//! `--mesh`: the triangles over the particles, and what is told of them.

use marching_particles::math::Bounds;
use marching_particles::mesh::build::{Options, Triangulation, triangulate};
use marching_particles::particles::Particles;
use serde::Serialize;

/// What the output tells of a mesh.
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
}

/// The triangles over the particles, whose surface the box cuts.
pub(crate) fn of(particles: &Particles, bounds: &Bounds) -> Triangulation {
    let options = Options { bounds: Some(bounds), ..Options::default() };
    triangulate(&particles.position, &particles.normal, &options)
}

impl Mesh {
    pub(crate) fn new(mesh: &Triangulation) -> Self {
        Self {
            triangles: mesh.triangles.len(),
            components: mesh.topology.components.len(),
            euler: mesh.topology.euler(),
            borders: mesh.topology.borders.len() - mesh.unfilled.len(),
            holes: mesh.unfilled.len(),
            left_out: mesh.left_out.len(),
        }
    }
}
