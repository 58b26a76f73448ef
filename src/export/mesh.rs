//! Triangle meshes of particles as files: GLB, OBJ, STL and PLY.

use super::glb;
use crate::particles::Particles;
use crate::quality;
use core::ops::Range;
use std::io::{self, Write};

/// A file format for triangles over particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshFormat {
    /// Binary glTF 2.0: triangles, normals, and generation levels as colours.
    Glb,
    /// Wavefront OBJ: triangles and normals, as text.
    Obj,
    /// Binary STL: triangles with their own normals. Single precision, no connectivity.
    Stl,
    /// Binary little-endian PLY: the columns of the particles, and the triangles.
    Ply,
}

impl MeshFormat {
    /// Every format with its file name extension.
    pub const ALL: [(&str, Self); 4] =
        [("glb", Self::Glb), ("obj", Self::Obj), ("stl", Self::Stl), ("ply", Self::Ply)];

    /// The format that a file name's extension stands for, in either case; none for any other.
    #[must_use]
    pub fn of_extension(extension: &str) -> Option<Self> {
        Self::ALL.iter().find(|(name, _)| name.eq_ignore_ascii_case(extension)).map(|&(_, format)| format)
    }
}

/// Writes the `triangles` over `particles` to `out`, which should be buffered: triples of indices, counter-clockwise seen
/// from outside, as [`triangulate`](crate::mesh::build::triangulate) makes them. Every row of a particle is a vertex, so that normals are
/// split at creases, whether it is in a
/// triangle or not, so that indices stay. `measured` is as for [`write`](super::write).
///
/// # Errors
///
/// The errors of `out`, and an error if the 32-bit counters of the format are too small.
///
/// # Panics
///
/// If a triangle names a particle that is not there.
pub fn write_mesh(
    format: MeshFormat,
    particles: &Particles,
    measured: &quality::Measurements,
    triangles: &[[u32; 3]],
    out: &mut dyn Write,
) -> io::Result<()> {
    let all = rows(format, particles, triangles);
    write_rows(format, particles, measured, triangles, 0..all, out)
}

/// Number of rows of a file: a row takes up to a microsecond to write, but for GLB, which is written as a whole.
pub(crate) fn rows(format: MeshFormat, particles: &Particles, triangles: &[[u32; 3]]) -> usize {
    match format {
        MeshFormat::Glb => 1,
        MeshFormat::Obj => 2 * particles.len() + triangles.len(),
        MeshFormat::Stl => triangles.len(),
        MeshFormat::Ply => particles.len() + triangles.len(),
    }
}

/// Writes some of the rows of a file, those at the start with what comes before them. One part after the other they make the file
/// of [`write_mesh`], with its errors.
pub(crate) fn write_rows(
    format: MeshFormat,
    particles: &Particles,
    measured: &quality::Measurements,
    triangles: &[[u32; 3]],
    rows: Range<usize>,
    out: &mut dyn Write,
) -> io::Result<()> {
    match format {
        MeshFormat::Glb => glb::write(particles, triangles, out),
        MeshFormat::Obj => obj(particles, triangles, rows, out),
        MeshFormat::Stl => stl(particles, triangles, rows, out),
        MeshFormat::Ply => super::ply(particles, measured, Some(triangles), rows, out),
    }
}

fn obj(
    particles: &Particles,
    triangles: &[[u32; 3]],
    rows: Range<usize>,
    out: &mut dyn Write,
) -> io::Result<()> {
    if rows.start == 0 {
        writeln!(out, "# Marching Particles")?;
    }
    let n = particles.len();
    for row in rows {
        if row < n {
            out.write_all(b"v")?;
            for axis in 0..3 {
                out.write_all(b" ")?;
                super::coordinate(particles, row, axis).write_text(out)?;
            }
            out.write_all(b"\n")?;
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

fn stl(
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
