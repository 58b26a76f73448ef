//! Options of a measurement: the wanted radii, the exact area and Euler number where they are known, and the sampling of holes.

use crate::particles::Particles;

/// The wanted radius of each particle, for [`Edges::size_cv`](super::figures::Edges::size_cv),
/// [`cover_local`](super::figures::Coverage::cover_local) and [`overlap_min`](super::figures::Edges::overlap_min).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Sizes<'a> {
    /// There are no wanted radii, and those figures are NaN.
    #[default]
    None,
    /// The wanted radius of each particle. If the slice is too short, particles without a radius are left out.
    Given(&'a [f32]),
    /// The wanted radius is half the mean length of the particle's own edges. The figures are then small if the sizes change smoothly.
    Local,
    /// The wanted radius is 1 / clamp(max(|κ₁|, |κ₂|), lowest, highest), with the principal curvatures of the field.
    Curvature {
        /// Lower limit of the curvature, in 1/length.
        lowest: f64,
        /// Upper limit of the curvature, in 1/length.
        highest: f64,
    },
}

/// Options of a measurement: known properties of the surface, and the number of random samples.
#[derive(Clone, Copy, Debug)]
pub struct MeasureOptions<'a> {
    /// Exact area of the surface (inside the box); by default the area of the triangles found.
    pub area: Option<f64>,
    /// Euler number of the surface, for [`Connectivity::tri_ok`](super::figures::Connectivity::tri_ok); by default that of the triangles
    /// found.
    pub euler: Option<i64>,
    /// Wanted radii.
    pub sizes: Sizes<'a>,
    /// Radius of the disc of each point, for [`Coverage::uncovered`](super::figures::Coverage::uncovered); without them it is NaN.
    pub discs: &'a [f32],
    /// The particles of which patch, twins, segments and sides are used, where the surface has creases. Neighbours of a particle are looked for on
    /// its own patch, and the patches are one surface by the particles on creases. Each column is then one of rows.
    pub rows: Option<&'a Particles>,
    /// Smallest number of random samples for [`Coverage::quant`](super::figures::Coverage::quant). There is at least one for each
    /// particle, and there are at most 262,144.
    pub samples: usize,
    /// Seed of the random samples.
    pub seed: u64,
}

impl Default for MeasureOptions<'_> {
    fn default() -> Self {
        // 65,536 stratified samples give `quant` to about 0.1 %.
        Self { area: None, euler: None, sizes: Sizes::None, discs: &[], rows: None, samples: 65_536, seed: 0 }
    }
}
