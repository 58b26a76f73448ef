//! Options of a measurement: what is known of the surface and its particles.

use crate::particles::Particles;

/// Options of a measurement: what is known of the surface and its particles.
#[derive(Clone, Copy, Debug, Default)]
pub struct MeasureOptions<'a> {
    /// Exact area of the surface (inside the box); by default the area of the triangles found.
    pub area: Option<f64>,
    /// The wanted radius of each particle, for
    /// [`Edges::size_variation`](super::figures::Edges::size_variation),
    /// [`Coverage::cover_local`](super::figures::Coverage::cover_local) and
    /// [`Edges::overlap_min`](super::figures::Edges::overlap_min); without them these are NaN. If
    /// the slice is too short, particles without a radius are left out.
    pub radii: Option<&'a [f32]>,
    /// The particles. Their radii are those of the discs for
    /// [`Coverage::uncovered`](super::figures::Coverage::uncovered), which is NaN without them. If
    /// the surface has creases, patch, twins, segments and sides are also used: neighbours of a
    /// particle are then searched for on its own patch, the particles on creases join the patches
    /// to one surface, and each column has one entry for each row.
    pub rows: Option<&'a Particles>,
}
