//! A surface that the border of an image cuts, closed there.

use super::smooth::in_plane;
use super::{Image, ImageError};
use crate::slices::Meter;

/// Voxels that are added at each border, so that the end of the spline does not bend the cap.
const ADDED: usize = 4;

impl Image {
    /// The image with [`ADDED`] voxels more at each border and a cap half a voxel beyond the
    /// outermost centres, at the faces of the outermost voxels. It is the intersection of the solid
    /// with a box: a voxel's distance from `iso` is that of the nearest one of the image, or that
    /// of the box if it is less, which rises by the slope of the values at the surface. So the
    /// edges of the cap are rounded by about a voxel. Made in slices of work.
    pub(super) async fn closed_at(&self, iso: f64, is_dark_inside: bool) -> Result<Self, ImageError> {
        let sign = if is_dark_inside { -1.0 } else { 1.0 };
        let size = self.size.map(|n| n + 2 * ADDED);
        let slope = self.slope(iso, 0.0).await;
        let slope = if slope.is_finite() { slope } else { 0.25 * (self.range[1] - self.range[0]) };
        // The slope is that over a length; along each axis a voxel has its own.
        let spacing = self.placement.spacing();
        // The nearest voxel of the image, and the distance from the cap, positive inside.
        let known = |axis: usize, at: usize| {
            let (own, last) = (at as f64 - ADDED as f64, (self.size[axis] - 1) as f64);
            let depth = (own + 0.5).min(last + 0.5 - own);
            (own.clamp(0.0, last) as usize, depth * slope * spacing[axis] / in_plane(spacing))
        };
        let mut voxels = Vec::with_capacity(size.iter().product());
        let mut row = vec![0.0; self.size[0]];
        let mut meter = Meter::default();
        for k in 0..size[2] {
            let (from_z, under_z) = known(2, k);
            for j in 0..size[1] {
                let (from_y, under_y) = known(1, j);
                self.row(from_y, from_z, iso, &mut row);
                voxels.extend((0..size[0]).map(|i| {
                    let (from_x, under_x) = known(0, i);
                    let own = sign * f64::from(row[from_x]);
                    (iso + sign * own.min(under_x).min(under_y).min(under_z)) as f32
                }));
                meter.add(size[0]).await;
            }
        }
        let placement = self.placement.at_index([-(ADDED as f64); 3].into())?;
        Ok(Self {
            placement,
            order: self.order,
            notes: self.notes.clone(),
            ..Self::filtered(size, voxels).await?
        })
    }
}
