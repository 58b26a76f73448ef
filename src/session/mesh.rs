//! The mesh over the particles of a session: joined when it is asked for, in slices, and dropped when they change.

use super::Session;
use crate::export::{MeshFormat, write_mesh};
use crate::mesh::build::{self, Options, Triangulation};
use crate::mesh::topology::Component;
use crate::slices::{self, Work};
use serde::Serialize;
use std::io;

/// What a mesh adds up to.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct MeshAnswer {
    /// Triangles.
    pub triangles: usize,
    /// Connected components, in the order of their first particles.
    pub components: Vec<MeshComponent>,
    /// Border loops where no manifold could be had, other than those where the surface ends.
    pub unfilled: usize,
    /// Particles in no triangle.
    pub left_out: usize,
}

/// A connected part of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct MeshComponent {
    /// Triangles.
    pub triangles: u32,
    /// Vertices − edges + triangles: 2 − 2g for a closed surface of genus g.
    pub euler: i64,
    /// Edges with one triangle.
    pub open_edges: u32,
}

/// The mesh, as far as it is there.
#[derive(Default)]
pub(super) enum Mesh {
    /// Nobody has asked for it since the particles have changed.
    #[default]
    None,
    /// Under way.
    Joining(Work<Triangulation>),
    /// Complete.
    Joined(Triangulation),
}

impl MeshAnswer {
    fn of(mesh: &Triangulation) -> Self {
        let component = |component: &Component| MeshComponent {
            triangles: component.triangles,
            euler: component.euler(),
            open_edges: component.border_edges,
        };
        Self {
            triangles: mesh.triangles.len(),
            components: mesh.topology.components.iter().map(component).collect(),
            unfilled: mesh.unfilled.len(),
            left_out: mesh.left_out.len(),
        }
    }
}

impl Session {
    /// Joins the particles to a mesh: up to `budget` slices of the work, some 10 to 50 microseconds each; what it adds up to, once
    /// it is complete. Call it when the run has ended. The mesh stays until the particles change.
    pub fn join(&mut self, budget: u32) -> Option<MeshAnswer> {
        if let Mesh::None = self.mesh {
            let count = self.count();
            let particles = self.sampler.particles();
            let (position, normal) =
                (particles.position[..count].to_vec(), particles.normal[..count].to_vec());
            let bounds = self.bounds;
            self.mesh = Mesh::Joining(Box::pin(async move {
                let options = Options { bounds: Some(&bounds), ..Options::default() };
                build::in_slices(&position, &normal, &options).await
            }));
        }
        if let Mesh::Joining(work) = &mut self.mesh {
            self.mesh = Mesh::Joined(slices::advance(work.as_mut(), budget)?);
        }
        let Mesh::Joined(mesh) = &self.mesh else { return None };
        Some(MeshAnswer::of(mesh))
    }

    /// The triangles: triples of particles, counter-clockwise seen from outside. There are none before [`Session::join`] is done.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        match &self.mesh {
            Mesh::Joined(mesh) => &mesh.triangles,
            _ => &[],
        }
    }

    /// The mesh as a file, with what was measured of the particles.
    ///
    /// # Errors
    ///
    /// Where a format's own counters, of 32 bits, are too small.
    pub fn mesh_file(&self, format: MeshFormat) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        write_mesh(format, self.particles(), self.measured(), self.triangles(), &mut bytes)?;
        Ok(bytes)
    }
}
