//! A mesh file of any format, written row by row.

use super::vertices::{Indexed, Vertices, outward_normals};
use super::{MeshFile, MeshFormat, glb, mesh, ply_columns, ply_mesh, three_mf};
use crate::mesh::triangulation::Triangulation;
use crate::particles::Particles;
use crate::quality::Measurements;
use core::ops::Range;
use std::io::{self, Write};

/// The particles as placed in the file and facing outward, with their measurements; none if they
/// are unchanged.
type Placed = Option<(Particles, Measurements)>;

/// The vertices and faces of a mesh file, in the file's order.
pub(crate) struct FileContent {
    placed: Placed,
    /// The vertices.
    vertices: Indexed,
    /// The normals of OBJ, which are numbered separately, if they differ from the points.
    normals: Option<Indexed>,
}

impl FileContent {
    pub(crate) fn new(
        wish: &MeshFile,
        particles: &Particles,
        measured: &Measurements,
        mesh: &Triangulation,
    ) -> Self {
        let mesh = &*mesh.only(wish.bodies, particles);
        let mut placed = wish.placement.placed(wish.format, particles, measured);
        let of_file = placed.as_ref().map_or(particles, |(particles, _)| particles);
        if let Some(normal) = outward_normals(mesh, of_file) {
            let (placed, _) = placed.get_or_insert_with(|| (particles.clone(), measured.clone()));
            placed.normal = normal;
        }
        let particles = placed.as_ref().map_or(particles, |(particles, _)| particles);
        let indexed = |vertices| Indexed::new(mesh, particles, &particles.normal, vertices);
        let vertices = indexed(match (wish.format, wish.vertices) {
            (MeshFormat::Ply, vertices) => vertices,
            (MeshFormat::Glb, Vertices::Split | Vertices::Columns) => Vertices::Split,
            _ => Vertices::Joined,
        });
        let is_split = wish.vertices != Vertices::Joined && mesh.has_corners();
        let has_normals_apart = wish.format == MeshFormat::Obj && is_split;
        let normals = has_normals_apart.then(|| indexed(Vertices::Split));
        Self { vertices, normals, placed }
    }
}

/// A mesh file and the data it is written from.
pub(crate) struct File<'a> {
    wish: &'a MeshFile,
    particles: &'a Particles,
    measured: &'a Measurements,
    content: &'a FileContent,
}

impl<'a> File<'a> {
    /// The file of these particles.
    pub(crate) fn new(
        wish: &'a MeshFile,
        particles: &'a Particles,
        measured: &'a Measurements,
        content: &'a FileContent,
    ) -> Self {
        let (particles, measured) = content.placed.as_ref().map_or((particles, measured), |(p, m)| (p, m));
        Self { wish, particles, measured, content }
    }

    fn normals(&self) -> &'a Indexed {
        self.content.normals.as_ref().unwrap_or(&self.content.vertices)
    }

    /// Number of rows. A row takes up to a microsecond to write; GLB and 3MF are written as one
    /// row.
    pub(crate) fn rows(&self) -> usize {
        let Indexed { rows, triangles, .. } = &self.content.vertices;
        match self.wish.format {
            MeshFormat::Glb | MeshFormat::ThreeMf => 1,
            MeshFormat::Obj => rows.len() + self.normals().rows.len() + triangles.len(),
            MeshFormat::Stl => triangles.len(),
            MeshFormat::Ply => rows.len() + triangles.len(),
        }
    }

    /// Writes all rows.
    pub(crate) fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        self.write_rows(0..self.rows(), out)
    }

    /// Writes some of the rows, and the header before the first. All parts in order make the file.
    ///
    /// # Errors
    ///
    /// The errors of `out`, and an error if the 32-bit counters of the format are too small.
    pub(crate) fn write_rows(&self, rows: Range<usize>, out: &mut dyn Write) -> io::Result<()> {
        let &Self { wish: MeshFile { format, placement, record, vertices: way, .. }, particles, .. } = self;
        let vertices = &self.content.vertices;
        match format {
            MeshFormat::Glb => glb::write(particles, self.measured, vertices, record, out),
            MeshFormat::ThreeMf => three_mf::write(particles, vertices, placement, record, out),
            MeshFormat::Obj => mesh::obj(particles, [vertices, self.normals()], record, rows, out),
            MeshFormat::Stl => mesh::stl(particles, vertices, rows, out),
            MeshFormat::Ply if *way == Vertices::Columns => {
                ply_columns(particles, self.measured, Some(&vertices.triangles), record, rows, out)
            }
            MeshFormat::Ply => ply_mesh(particles, self.measured, vertices, record, rows, out),
        }
    }
}
