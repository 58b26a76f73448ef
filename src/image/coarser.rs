//! Fewer voxels, for images that do not fit into memory.

use super::voxels::Voxels;
use super::{Image, ImageError};
use crate::slices::{self, Meter};

impl Image {
    /// The image of every `step`-th voxel along each axis, in the same place, with a
    /// [note](Image::notes). Details between these voxels are lost.
    ///
    /// # Errors
    ///
    /// [`ImageError::Flat`] if a single voxel is left along an axis, and
    /// [`ImageError::Constant`] if all that are left have the same value.
    ///
    /// # Panics
    ///
    /// If the step is 0.
    pub fn coarser(&self, step: usize) -> Result<Self, ImageError> {
        slices::complete(self.coarser_in_slices(step))
    }

    /// [`Image::coarser`] in slices of work.
    ///
    /// # Errors
    ///
    /// As for [`Image::coarser`].
    #[doc(hidden)]
    pub async fn coarser_in_slices(&self, step: usize) -> Result<Self, ImageError> {
        assert!(step > 0, "a step from voxel to voxel is at least 1");
        let size = self.size.map(|n| n.div_ceil(step));
        if size.contains(&1) {
            return Err(ImageError::Flat { size: self.order.sorted(size) });
        }
        let (mut bytes, mut meter) = (Vec::new(), Meter::default());
        for k in (0..self.size[2]).step_by(step) {
            for j in (0..self.size[1]).step_by(step) {
                let row = self.size[0] * (j + self.size[1] * k);
                for i in (0..self.size[0]).step_by(step) {
                    bytes.extend_from_slice(self.voxels.bytes_of(row + i));
                }
                meter.add(size[0]).await;
            }
        }
        let (layout, len) = (self.voxels.packed(), size.iter().product());
        let voxels = Voxels::of_file(bytes, layout, len).expect("as many voxels as were kept");
        let image = Self::of(self.order.sorted(size), self.order, voxels).await?;
        let [x, y, z] = self.size();
        let note = format!("Of {x} × {y} × {z} voxels, one in {step} along each axis was kept.");
        let notes = self.notes.iter().cloned().chain([note]).collect();
        Ok(Self { placement: self.placement.coarser(step as f64)?, notes, ..image })
    }
}
