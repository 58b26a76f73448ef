//! The voxels in a plane, to be shown as a picture.

use super::Image;
use super::bricks::for_each_cell;
use glam::DVec3;

/// A grid of points in a plane: `corner` + i · `steps[0]` + j · `steps[1]` for i, j from 0 to the
/// `size` along each direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    /// The first point.
    pub corner: DVec3,
    /// The steps between neighbouring points along the two directions.
    pub steps: [DVec3; 2],
    /// Points along the two directions.
    pub size: [usize; 2],
}

impl Image {
    /// The values of the voxels at the points of a section, the first direction fastest: those of
    /// the nearest voxels, or, if `is_linear`, interpolated between them. NaN outside the image:
    /// more than half a voxel from the outermost centres.
    #[must_use]
    pub fn section(&self, section: &Section, is_linear: bool) -> Vec<f32> {
        let Section { corner, steps, size } = *section;
        let mut values = Vec::with_capacity(size[0] * size[1]);
        for j in 0..size[1] {
            let start = corner + steps[1] * j as f64;
            values.extend((0..size[0]).map(|i| self.value_at(start + steps[0] * i as f64, is_linear)));
        }
        values
    }

    /// The value at a point.
    fn value_at(&self, p: DVec3, is_linear: bool) -> f32 {
        let index = self.placement.index(p).to_array();
        let last = self.size.map(|n| (n - 1) as f64);
        if !(0..3).all(|axis| index[axis] >= -0.5 && index[axis] <= last[axis] + 0.5) {
            return f32::NAN;
        }
        let within: [f64; 3] = core::array::from_fn(|axis| index[axis].clamp(0.0, last[axis]));
        if !is_linear {
            return self.voxel(within.map(|x| libm::floor(x + 0.5) as usize)) as f32;
        }
        let first: [usize; 3] = core::array::from_fn(|axis| (within[axis] as usize).min(self.size[axis] - 2));
        let mut value = 0.0;
        for_each_cell([0; 3], [1; 3], |side| {
            let weight = |axis: usize| {
                let t = within[axis] - first[axis] as f64;
                if side[axis] == 1 { t } else { 1.0 - t }
            };
            let voxel = [0, 1, 2].map(|axis| first[axis] + side[axis]);
            value += weight(0) * weight(1) * weight(2) * self.voxel(voxel);
        });
        value as f32
    }
}
