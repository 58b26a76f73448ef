//! A mesh file of any format, written row by row.

use super::{MeshFile, MeshFormat, glb, mesh, ply, three_mf};
use crate::particles::Particles;
use crate::quality::Measurements;
use core::ops::Range;
use std::io::{self, Write};

/// A mesh file with what it is written from. The particles are placed as they are in it.
pub(crate) struct File<'a> {
    pub(crate) wish: &'a MeshFile,
    pub(crate) particles: &'a Particles,
    pub(crate) measured: &'a Measurements,
    pub(crate) triangles: &'a [[u32; 3]],
}

impl File<'_> {
    /// Number of rows: a row takes up to a microsecond to write, but for GLB and 3MF, which are written as a whole.
    pub(crate) fn rows(&self) -> usize {
        let (particles, triangles) = (self.particles.len(), self.triangles.len());
        match self.wish.format {
            MeshFormat::Glb | MeshFormat::ThreeMf => 1,
            MeshFormat::Obj => 2 * particles + triangles,
            MeshFormat::Stl => triangles,
            MeshFormat::Ply => particles + triangles,
        }
    }

    /// Writes all rows.
    pub(crate) fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        self.write_rows(0..self.rows(), out)
    }

    /// Writes some of the rows, those at the start with what comes before them. One part after the other they make the file.
    ///
    /// # Errors
    ///
    /// The errors of `out`, and an error if the 32-bit counters of the format are too small.
    pub(crate) fn write_rows(&self, rows: Range<usize>, out: &mut dyn Write) -> io::Result<()> {
        let &Self { wish: MeshFile { format, placement, record }, particles, measured, triangles } = self;
        match format {
            MeshFormat::Glb => glb::write(particles, triangles, record, out),
            MeshFormat::ThreeMf => three_mf::write(particles, triangles, placement, record, out),
            MeshFormat::Obj => mesh::obj(particles, triangles, record, rows, out),
            MeshFormat::Stl => mesh::stl(particles, triangles, rows, out),
            MeshFormat::Ply => ply(particles, measured, Some(triangles), record, rows, out),
        }
    }
}
