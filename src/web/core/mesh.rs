//! The edges of the opened triangle mesh, to mark some of them as sharp.

use super::{Core, Opened};
use glam::DVec3;
use wasm_bindgen::prelude::wasm_bindgen;

#[wasm_bindgen]
impl Core {
    /// Keeps the edges of the last opened mesh along these segments sharp, six numbers each, in the
    /// next field that is set; none keeps those that its angle tells. Does nothing for an image.
    pub fn mark_edges(&mut self, segments: &[f64]) {
        let segments: Vec<[DVec3; 2]> = segments
            .as_chunks::<6>()
            .0
            .iter()
            .map(|&[a, b, c, d, e, f]| [DVec3::new(a, b, c), DVec3::new(d, e, f)])
            .collect();
        if let Some((_, Opened::Mesh(mesh))) = &mut self.opened {
            *mesh = mesh.clone().with_edges_along(&segments);
        }
    }

    /// Three coordinates for each vertex of the last opened mesh, as it was repaired; empty for an
    /// image.
    pub fn mesh_vertices(&self) -> Vec<f64> {
        let Some((_, Opened::Mesh(mesh))) = &self.opened else { return Vec::new() };
        let solid = mesh.solid();
        solid.mesh().vertices().iter().flat_map(|&p| (solid.origin() + p).to_array()).collect()
    }

    /// The three vertices of each of its faces, counter-clockwise seen from outside.
    pub fn mesh_faces(&self) -> Vec<u32> {
        let Some((_, Opened::Mesh(mesh))) = &self.opened else { return Vec::new() };
        mesh.solid().mesh().faces().as_flattened().to_vec()
    }
}
