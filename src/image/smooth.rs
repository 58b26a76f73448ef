//! Gaussians against noise, and the noise of an image.

use super::otsu::Histogram;
use super::voxels::Voxels;
use super::{Image, ImageError};
use crate::math::median;

/// Weights of a Gaussian end where they are below e^−8, a three-thousandth of the middle one.
const REACH: f64 = 4.0;
/// Voxels along each axis at which the noise is measured at most; their median hardly changes with
/// more.
const SAMPLED: usize = 32;
/// Noise that is left on purpose, as a share of the contrast: it moves the surface of an edge that
/// is blurred by a voxel by some fiftieth of a voxel. More leaves specks, less rounds what is
/// small.
const LEFT: f64 = 0.01;
/// Widths of the Gaussian against noise, in voxels: narrower ones hardly lower it, and wider ones
/// remove what is a few voxels wide.
const WIDTHS: [f64; 2] = [0.7, 2.0];

/// The standard deviations along the axes, in voxels, of a Gaussian that is `width` voxels of the
/// coarser in-plane axis wide in space. The slices of a scan lie across the axis with the largest
/// spacing.
pub(super) fn deviations(image: &Image, width: f64) -> [f64; 3] {
    let mut sorted = image.placement.spacing();
    let spacing = sorted;
    sorted.sort_by(f64::total_cmp);
    spacing.map(|own| width * sorted[1] / own)
}

/// The weights of a Gaussian at 0, 1, 2, …; they add up to 1 with those of the other side.
fn gaussian(deviation: f64) -> Vec<f32> {
    let reach = libm::ceil(REACH * deviation) as usize;
    let weight = |k: usize| {
        if k == 0 { 1.0 } else { libm::exp(-0.5 * (k as f64 / deviation) * (k as f64 / deviation)) }
    };
    let weights: Vec<f64> = (0..=reach).map(weight).collect();
    let sum = weights[0] + 2.0 * weights[1..].iter().sum::<f64>();
    weights.iter().map(|weight| (weight / sum) as f32).collect()
}

/// Filters voxels by a Gaussian along each axis in turn. Beyond the border they are those of the
/// border.
pub(crate) fn blur(size: [usize; 3], voxels: &mut [f32], deviations: [f64; 3]) {
    let strides = [1, size[0], size[0] * size[1]];
    for axis in 0..3 {
        let weights = gaussian(deviations[axis]);
        if weights.len() == 1 {
            continue;
        }
        let (n, stride) = (size[axis], strides[axis]);
        // Lines along the axis that lie side by side are filtered together.
        let mut lines = vec![0.0; n * stride];
        for voxels in voxels.chunks_mut(n * stride) {
            lines.copy_from_slice(voxels);
            for (at, out) in voxels.chunks_mut(stride).enumerate() {
                let line = |k: usize| &lines[k * stride..][..stride];
                for (out, middle) in out.iter_mut().zip(line(at)) {
                    *out = weights[0] * middle;
                }
                for (k, weight) in weights.iter().enumerate().skip(1) {
                    let (behind, ahead) = (line(at.saturating_sub(k)), line((at + k).min(n - 1)));
                    for ((out, behind), ahead) in out.iter_mut().zip(behind).zip(ahead) {
                        *out += weight * (behind + ahead);
                    }
                }
            }
        }
    }
}

impl Image {
    /// The image blurred by a Gaussian, whose standard deviation is `width` voxels of the coarser
    /// of the two axes with the smaller spacings, the same length along all axes. It lowers noise,
    /// and moves a surface of mean curvature H by about H times the square of that length towards
    /// the inside of its bends. The voxels become numbers in single precision.
    ///
    /// # Errors
    ///
    /// [`ImageError::Width`] if the width is not between 0 and 100, [`ImageError::Constant`] if all
    /// voxels become the same.
    pub fn smoothed(&self, width: f64) -> Result<Self, ImageError> {
        if !(0.0..=100.0).contains(&width) {
            return Err(ImageError::Width { width });
        }
        let zero = self.middle();
        let mut voxels = vec![0.0; self.voxels.len()];
        self.voxels.write(0, zero, &mut voxels);
        blur(self.size, &mut voxels, deviations(self, width));
        // The numbers of the file again.
        voxels.iter_mut().for_each(|value| *value = (f64::from(*value) + zero) as f32);
        let image = Self::of(self.size, Voxels::new(&voxels))?;
        Ok(Self { placement: self.placement, notes: self.notes.clone(), ..image })
    }

    /// The standard deviation of the noise in the values of the voxels. It is measured by the
    /// differences of second order along all three axes at once, which vanish on everything that is
    /// smooth along one of them, as the median of their sizes at up to 32³ places (after J.
    /// Immerkær, "Fast Noise Variance Estimation", Computer Vision and Image Understanding 64,
    /// 1996, who takes the mean in two dimensions). Noise must be independent from voxel to voxel;
    /// that of a scan that was resampled is underestimated.
    #[must_use]
    pub fn noise(&self) -> f64 {
        /// √(1² + 2² + 1²)³, by which the differences are larger than the noise.
        const GAIN: f64 = 14.696_938_456_699_069;
        /// The median of the size of a normal variable.
        const MEDIAN: f64 = 0.674_489_750_196_081_7;
        if self.size.iter().any(|&n| n < 3) {
            return 0.0;
        }
        let step = self.size.map(|n| (n - 2).div_ceil(SAMPLED));
        let places = |axis: usize| (0..self.size[axis] - 2).step_by(step[axis]);
        let mut sizes: Vec<f64> = Vec::new();
        for k in places(2) {
            for j in places(1) {
                for i in places(0) {
                    let mut difference = 0.0;
                    for at in 0..27 {
                        let steps = [at % 3, at / 3 % 3, at / 9];
                        let weight: f64 =
                            steps.iter().map(|&step| if step == 1 { -2.0 } else { 1.0 }).product();
                        difference += weight * self.voxel([i + steps[0], j + steps[1], k + steps[2]]);
                    }
                    sizes.push(difference.abs());
                }
            }
        }
        median(sizes).unwrap_or(0.0) / (MEDIAN * GAIN)
    }

    /// The width of the Gaussian, for [`Image::smoothed`], that lowers the [noise](Image::noise) to
    /// a hundredth of the difference between the mean values of dark and bright voxels, the two
    /// classes of [Otsu's](Image::otsu) method: from 0.7 to 2 voxels, or 0 where there is less
    /// noise. A Gaussian of σ voxels lowers independent noise by the factor (4πσ²)^(3/4).
    #[must_use]
    pub fn width_against_noise(&self) -> f64 {
        let [dark, bright] = Histogram::of(self).means();
        let excess = self.noise() / (LEFT * (bright - dark));
        if excess.is_nan() || excess <= 1.0 {
            return 0.0;
        }
        let width = libm::cbrt(excess * excess) / libm::sqrt(4.0 * core::f64::consts::PI);
        width.clamp(WIDTHS[0], WIDTHS[1])
    }
}
