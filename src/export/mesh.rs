//! Triangle meshes of particles as files; writes the formats OBJ and STL.

use super::vertices::{Indexed, Vertices};
use super::{File, FileContent, Placement, RecordText};
use crate::mesh::bodies::Bodies;
use crate::mesh::triangulation::Triangulation;
use crate::particles::Particles;
use crate::quality;
use core::ops::Range;
use std::io::{self, Write};

/// A file format for triangles over particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshFormat {
    /// Binary glTF 2.0: triangles, normals, and generation levels as colours.
    Glb,
    /// Wavefront OBJ: triangles and normals, as text. With [`Vertices::Split`] the normals are
    /// numbered apart from the points.
    Obj,
    /// Binary STL: triangles with their own normals. Single precision, no connectivity.
    Stl,
    /// Binary little-endian PLY: points with normals, and the triangles; with [`Vertices::Columns`]
    /// all columns of the particles.
    Ply,
    /// 3MF: triangles and their unit, for printers.
    ThreeMf,
}

impl MeshFormat {
    /// Every format with its file name extension.
    pub const ALL: [(&str, Self); 5] = [
        ("glb", Self::Glb),
        ("3mf", Self::ThreeMf),
        ("stl", Self::Stl),
        ("obj", Self::Obj),
        ("ply", Self::Ply),
    ];

    /// The format that a file name's extension stands for, in either case; none for any other.
    #[must_use]
    pub fn of_extension(extension: &str) -> Option<Self> {
        Self::ALL.iter().find(|(name, _)| name.eq_ignore_ascii_case(extension)).map(|&(_, format)| format)
    }
}

/// A mesh file: its format, the placement of the mesh, and the record.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshFile {
    /// Format of the file.
    pub format: MeshFormat,
    /// Size and orientation of the mesh in it.
    pub placement: Placement,
    /// The vertices of the particles on sharp edges, in GLB, OBJ and PLY.
    pub vertices: Vertices,
    /// The bodies in the file. With [`Vertices::Columns`] the particles of other bodies stay rows.
    pub bodies: Bodies,
    /// The record, which every format except STL carries.
    pub record: RecordText,
}

impl From<MeshFormat> for MeshFile {
    fn from(format: MeshFormat) -> Self {
        Self {
            format,
            placement: Placement::default(),
            vertices: Vertices::default(),
            bodies: Bodies::default(),
            record: RecordText::default(),
        }
    }
}

/// Writes the mesh over `particles` to `out`, which should be buffered. Closed parts and their
/// normals face outward, whether f is smaller or larger inside; open parts face as f does.
/// `measured` is as for [`write`](super::write).
///
/// # Errors
///
/// The errors of `out`, and an error if the 32-bit counters of the format are too small.
///
/// # Panics
///
/// If the mesh is not one of these particles.
pub fn write_mesh(
    file: &MeshFile,
    particles: &Particles,
    measured: &quality::Measurements,
    mesh: &Triangulation,
    out: &mut dyn Write,
) -> io::Result<()> {
    let content = FileContent::new(file, particles, measured, mesh);
    File::new(file, particles, measured, &content).write(out)
}

/// Writes rows of points, of the `normals` and of triangles.
pub(super) fn obj(
    particles: &Particles,
    [vertices, normals]: [&Indexed; 2],
    record: &RecordText,
    rows: Range<usize>,
    out: &mut dyn Write,
) -> io::Result<()> {
    if rows.start == 0 {
        write!(out, "# Marching Particles\n{}", record.comment("#"))?;
    }
    let (points, all) = (vertices.rows.len(), vertices.rows.len() + normals.normals.len());
    for row in rows {
        if let Some(&vertex) = vertices.rows.get(row) {
            let [x, y, z] = super::coordinates(particles, vertex as usize);
            writeln!(out, "v {x} {y} {z}")?;
        } else if let Some(normal) = normals.normals.get(row - points) {
            writeln!(out, "vn {} {} {}", normal.x, normal.y, normal.z)?;
        } else {
            // Counted from 1.
            let [a, b, c] = vertices.triangles[row - all].map(|v| v + 1);
            let [na, nb, nc] = normals.triangles[row - all].map(|v| v + 1);
            writeln!(out, "f {a}//{na} {b}//{nb} {c}//{nc}")?;
        }
    }
    Ok(())
}

/// Writes rows of triangles.
pub(super) fn stl(
    particles: &Particles,
    vertices: &Indexed,
    rows: Range<usize>,
    out: &mut dyn Write,
) -> io::Result<()> {
    if rows.start == 0 {
        let mut header = [b' '; 80];
        // It must not begin with "solid", which marks the text form.
        header[..18].copy_from_slice(b"Marching Particles");
        out.write_all(&header)?;
        let count = u32::try_from(vertices.triangles.len()).map_err(io::Error::other)?;
        out.write_all(&count.to_le_bytes())?;
    }
    for triangle in &vertices.triangles[rows] {
        let [a, b, c] = triangle.map(|v| particles.place(vertices.rows[v as usize] as usize));
        let normal = (b - a).cross(c - a).normalize_or_zero();
        // Four vectors, and two unused bytes.
        let mut record = [0; 50];
        let floats = [normal, a, b, c].into_iter().flat_map(|v| v.as_vec3().to_array());
        for (bytes, value) in record.chunks_exact_mut(4).zip(floats) {
            bytes.copy_from_slice(&value.to_le_bytes());
        }
        out.write_all(&record)?;
    }
    Ok(())
}
