//! Triangle meshes of particles as files, and the formats of text and STL among them.

use super::{File, Placement, RecordText};
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
    /// Wavefront OBJ: triangles and normals, as text.
    Obj,
    /// Binary STL: triangles with their own normals. Single precision, no connectivity.
    Stl,
    /// Binary little-endian PLY: the columns of the particles, and the triangles.
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

/// A file of a mesh: its format, the place of the mesh in it, and the record that it carries.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshFile {
    /// Format of the file.
    pub format: MeshFormat,
    /// Size and orientation of the mesh in it.
    pub placement: Placement,
    /// The record that it carries, but for STL.
    pub record: RecordText,
}

impl From<MeshFormat> for MeshFile {
    fn from(format: MeshFormat) -> Self {
        Self { format, placement: Placement::default(), record: RecordText::default() }
    }
}

/// Writes the `triangles` over `particles` to `out`, which should be buffered: triples of indices, counter-clockwise seen
/// from outside, as [`triangulate`](crate::mesh::build::triangulate) makes them. Every row of a particle is a vertex, so that normals are
/// split at creases, whether it is in a triangle or not, so that indices stay; but in 3MF, which has no normals, every particle is one.
/// `measured` is as for [`write`](super::write).
///
/// # Errors
///
/// The errors of `out`, and an error if the 32-bit counters of the format are too small.
///
/// # Panics
///
/// If a triangle names a particle that is not there.
pub fn write_mesh(
    file: &MeshFile,
    particles: &Particles,
    measured: &quality::Measurements,
    triangles: &[[u32; 3]],
    out: &mut dyn Write,
) -> io::Result<()> {
    let placed = file.placement.placed(file.format, particles, measured);
    let (particles, measured) = placed.as_ref().map_or((particles, measured), |(p, m)| (p, m));
    File { wish: file, particles, measured, triangles }.write(out)
}

pub(super) fn obj(
    particles: &Particles,
    triangles: &[[u32; 3]],
    record: &RecordText,
    rows: Range<usize>,
    out: &mut dyn Write,
) -> io::Result<()> {
    if rows.start == 0 {
        write!(out, "# Marching Particles\n{}", record.comment("#"))?;
    }
    let n = particles.len();
    for row in rows {
        if row < n {
            let [x, y, z] = super::coordinates(particles, row);
            writeln!(out, "v {x} {y} {z}")?;
        } else if let Some(normal) = particles.normal.get(row - n) {
            writeln!(out, "vn {} {} {}", normal.x, normal.y, normal.z)?;
        } else {
            // Counted from 1; the normal has the number of the vertex.
            let [a, b, c] = triangles[row - 2 * n].map(|v| v + 1);
            writeln!(out, "f {a}//{a} {b}//{b} {c}//{c}")?;
        }
    }
    Ok(())
}

pub(super) fn stl(
    particles: &Particles,
    triangles: &[[u32; 3]],
    rows: Range<usize>,
    out: &mut dyn Write,
) -> io::Result<()> {
    if rows.start == 0 {
        let mut header = [b' '; 80];
        // It must not begin with "solid", which marks the text form.
        header[..18].copy_from_slice(b"Marching Particles");
        out.write_all(&header)?;
        let count = u32::try_from(triangles.len()).map_err(io::Error::other)?;
        out.write_all(&count.to_le_bytes())?;
    }
    for triangle in &triangles[rows] {
        let [a, b, c] = triangle.map(|v| particles.place(v as usize));
        let normal = (b - a).cross(c - a).normalize_or_zero();
        // Four vectors, and two bytes that nobody uses.
        let mut record = [0; 50];
        let floats = [normal, a, b, c].into_iter().flat_map(|v| v.as_vec3().to_array());
        for (bytes, value) in record.chunks_exact_mut(4).zip(floats) {
            bytes.copy_from_slice(&value.to_le_bytes());
        }
        out.write_all(&record)?;
    }
    Ok(())
}
