//! Gaussians against noise, and estimates of the noise of an image.

use super::{Image, ImageError};
use crate::math::{median, sort_numbers};
use crate::slices::{self, LIGHT, Meter};
use core::ops::Range;
use std::collections::VecDeque;

/// The weights of a Gaussian end below e^−8, a three-thousandth of the middle one.
const REACH: f64 = 4.0;
/// Number of voxels along each axis at which the noise is measured, at most; the median hardly
/// changes with more.
const SAMPLED: usize = 32;
/// Distance, in voxels, by which noise may still move the surface: its standard deviation divided
/// by the slope of the values. At an edge that a scanner has blurred by 0.8 voxels it is one
/// hundredth of the contrast. More leaves specks and dents; less rounds small details.
const LEFT: f64 = 0.02;
/// Range of the Gaussian's width against noise, in voxels. Narrower ones hardly lower noise, and
/// wider ones remove what is a few voxels wide.
const WIDTHS: [f64; 2] = [0.7, 2.0];
/// Widths are multiples of a tenth of a voxel, so that they seldom change with the iso value.
pub(super) const WIDTHS_IN_A_VOXEL: f64 = 10.0;
/// Standard deviation of the error of rounding to whole numbers, 1/√12.
const ROUNDING: f64 = 0.288_675_134_594_812_9;
/// Number of voxels along each axis at which the slope is measured, at most; those near the surface
/// count.
const SCANNED: usize = 64;

/// The length that counts as a voxel: the spacing of the coarser in-plane axis. The slices of a
/// scan lie across the axis with the largest spacing.
pub(super) fn in_plane(mut spacing: [f64; 3]) -> f64 {
    sort_numbers(&mut spacing);
    spacing[1]
}

/// The standard deviations of a Gaussian of `width` voxels along the axes, in voxels of each. Its
/// length in space is the same along all of them.
pub(super) fn deviations(image: &Image, width: f64) -> [f64; 3] {
    let spacing = image.placement.spacing();
    spacing.map(|own| width * in_plane(spacing) / own)
}

/// The weights of a Gaussian at 0, 1, 2, …; with those at −1, −2, … they add up to 1.
fn gaussian(deviation: f64) -> Vec<f32> {
    let reach = libm::ceil(REACH * deviation) as usize;
    let weight = |k: usize| {
        if k == 0 { 1.0 } else { libm::exp(-0.5 * (k as f64 / deviation) * (k as f64 / deviation)) }
    };
    let weights: Vec<f64> = (0..=reach).map(weight).collect();
    let sum = weights[0] + 2.0 * weights[1..].iter().sum::<f64>();
    weights.iter().map(|weight| (weight / sum) as f32).collect()
}

/// Blurs voxels by a Gaussian along each axis in turn, in slices of work. Voxels beyond the border
/// have the value of the border. A deviation is at most the width of the image.
pub(crate) async fn blur(size: [usize; 3], voxels: &mut [f32], deviations: [f64; 3]) {
    let mut meter = Meter::default();
    let weights = core::array::from_fn::<_, 3, _>(|axis| gaussian(deviations[axis].min(size[axis] as f64)));
    if weights[0].len() > 1 {
        let reach = weights[0].len() - 1;
        let mut line = vec![0.0; size[0] + 2 * reach];
        for row in voxels.chunks_mut(size[0]) {
            line[..reach].fill(row[0]);
            line[reach..][..row.len()].copy_from_slice(row);
            line[reach + row.len()..].fill(row[row.len() - 1]);
            add_up(&weights[0], |k| &line[(reach as isize + k) as usize..], row);
            meter.add(row.len()).await;
        }
    }
    for (axis, stride) in [(1, size[0]), (2, size[0] * size[1])] {
        if weights[axis].len() == 1 {
            continue;
        }
        for voxels in voxels.chunks_mut(size[axis] * stride) {
            // Adjacent lines along the axis are filtered together, as many as fit the cache.
            for first in (0..stride).step_by(LIGHT) {
                let lines = first..stride.min(first + LIGHT);
                blur_lines(voxels, stride, lines, &weights[axis], &mut meter).await;
            }
        }
    }
}

/// Blurs adjacent lines, whose voxels are `stride` apart.
async fn blur_lines(
    voxels: &mut [f32],
    stride: usize,
    lines: Range<usize>,
    weights: &[f32],
    meter: &mut Meter,
) {
    let last = voxels.len() / stride - 1;
    // The voxels at the present place of the lines and before it, which have been overwritten.
    let mut before: VecDeque<Vec<f32>> = VecDeque::with_capacity(weights.len());
    for at in 0..=last {
        let mut own =
            if before.len() == weights.len() { before.pop_front() } else { None }.unwrap_or_default();
        let (done, rest) = voxels.split_at_mut((at + 1) * stride);
        let out = &mut done[at * stride..][lines.clone()];
        own.clear();
        own.extend_from_slice(out);
        before.push_back(own);
        let behind = |k: usize| before[before.len() - 1 - k.min(at)].as_slice();
        let ahead = |k: usize| match k.min(last - at) {
            0 => behind(0),
            k => &rest[(k - 1) * stride..][lines.clone()],
        };
        add_up(weights, |k| if k < 0 { behind(k.unsigned_abs()) } else { ahead(k as usize) }, out);
        meter.add(out.len()).await;
    }
}

/// Filters several values at once by symmetric weights: `of(k)` returns the values k steps further
/// along the axis.
pub(super) fn add_up<'a>(weights: &[f32], of: impl Fn(isize) -> &'a [f32], out: &mut [f32]) {
    /// Values whose sums stay in registers.
    const AT_ONCE: usize = 32;
    for (n, out) in out.chunks_mut(AT_ONCE).enumerate() {
        let part = |k: isize| &of(k)[AT_ONCE * n..][..out.len()];
        let mut sums = [0.0; AT_ONCE];
        for (sum, middle) in sums.iter_mut().zip(part(0)) {
            *sum = weights[0] * middle;
        }
        // The smallest weights are added last, always in the same order.
        for (k, weight) in (0..).zip(weights).skip(1) {
            let (behind, ahead) = (part(-k), part(k));
            if let ([behind], [ahead]) = (behind.as_chunks::<AT_ONCE>().0, ahead.as_chunks::<AT_ONCE>().0) {
                for i in 0..AT_ONCE {
                    sums[i] += weight * (behind[i] + ahead[i]);
                }
            } else {
                for (sum, (behind, ahead)) in sums.iter_mut().zip(behind.iter().zip(ahead)) {
                    *sum += weight * (behind + ahead);
                }
            }
        }
        out.copy_from_slice(&sums[..out.len()]);
    }
}

impl Image {
    /// The image blurred by a Gaussian. Its standard deviation is the same length along all axes:
    /// `width` voxels of the coarser of the two axes with the smaller spacings. It lowers noise,
    /// and moves a surface of mean curvature H by about H times the square of that length, towards
    /// its concave side. The voxels become single precision.
    ///
    /// # Errors
    ///
    /// [`ImageError::Width`] if the width is not in 0 to 100, [`ImageError::Constant`] if all
    /// voxels become equal.
    pub fn smoothed(&self, width: f64) -> Result<Self, ImageError> {
        slices::complete(self.blurred(width))
    }

    /// [`Image::smoothed`] in slices of work.
    pub(super) async fn blurred(&self, width: f64) -> Result<Self, ImageError> {
        if !(0.0..=100.0).contains(&width) {
            return Err(ImageError::Width { width });
        }
        let zero = self.middle();
        let mut voxels = vec![0.0; self.voxels.len()];
        for (k, voxels) in voxels.chunks_mut(LIGHT).enumerate() {
            self.voxels.write(LIGHT * k, zero, voxels);
            slices::pause().await;
        }
        blur(self.size, &mut voxels, deviations(self, width)).await;
        // Relative to zero again, as in the file.
        for voxels in voxels.chunks_mut(LIGHT) {
            voxels.iter_mut().for_each(|value| *value = (f64::from(*value) + zero) as f32);
            slices::pause().await;
        }
        let image = Self::filtered(self.size, voxels).await?;
        Ok(Self { placement: self.placement, order: self.order, notes: self.notes.clone(), ..image })
    }

    /// The standard deviation of the noise in the voxel values. It is estimated from second
    /// differences along all three axes at once, which vanish for anything smooth along one of
    /// them: the median of their sizes at up to 32³ voxels (after J. Immerkær, "Fast Noise Variance
    /// Estimation", Computer Vision and Image Understanding 64, 1996, who takes the mean in two
    /// dimensions). It assumes noise that is independent between voxels; in a resampled scan it is
    /// underestimated.
    #[must_use]
    pub fn noise(&self) -> f64 {
        slices::complete(self.measured_noise())
    }

    /// [`Image::noise`] in slices of work.
    pub(super) async fn measured_noise(&self) -> f64 {
        /// √(1² + 2² + 1²)³, by which the noise is amplified in these differences.
        const GAIN: f64 = 14.696_938_456_699_069;
        /// The median of the absolute value of a standard normal variable.
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
                slices::pause().await;
            }
        }
        median(sizes).unwrap_or(0.0) / (MEDIAN * GAIN)
    }

    /// The width of the Gaussian for [`Image::smoothed`] with which noise moves the surface at the
    /// value `iso` by a fiftieth of a voxel, to first order: 0.7 to 2 voxels in steps of a tenth,
    /// or 0 if the noise moves it less without a Gaussian. The [noise](Image::noise) is compared
    /// with the slope of the values at the surface. Rounding to whole numbers counts as noise, too,
    /// with a standard deviation of 0.29 steps: where the slope is shallow, it makes the surface
    /// rough. Against rounding alone the width is at most that [against
    /// steps](Image::width_against_steps): a mask of 0 and 1 holds no details that a wider Gaussian
    /// could reveal.
    ///
    /// A Gaussian of σ voxels lowers independent noise by the factor (4πσ²)^(3/4).
    #[must_use]
    pub fn width_against_noise(&self, iso: f64) -> f64 {
        slices::complete(async { self.width_at(iso, self.measured_noise().await).await })
    }

    /// [`Image::width_against_noise`] for noise that is known, in slices of work.
    pub(super) async fn width_at(&self, iso: f64, noise: f64) -> f64 {
        let rounding = ROUNDING * self.voxels.step();
        let slope = self.slope(iso, noise.max(rounding)).await;
        let width_for = |deviation: f64, widest: f64| {
            // Without a slope there is no surface, and any width will do.
            let excess = deviation / (LEFT * slope);
            if excess.is_nan() || excess <= 1.0 {
                return 0.0;
            }
            let width = libm::cbrt(excess * excess) / libm::sqrt(4.0 * core::f64::consts::PI);
            (libm::ceil(width * WIDTHS_IN_A_VOXEL) / WIDTHS_IN_A_VOXEL).clamp(WIDTHS[0], widest)
        };
        // The measured noise includes rounding, except where many voxels are equal.
        let beside = libm::sqrt((noise * noise - rounding * rounding).max(0.0));
        let against_noise = width_for(beside, WIDTHS[1]);
        against_noise.max(width_for(noise.max(rounding), self.width_against_steps()))
    }

    /// The median size of the gradient where the values cross `iso` between two neighbours, per
    /// voxel of the coarser of the two smaller spacings, less the contribution of noise with this
    /// standard deviation; infinite if there is no such point.
    pub(super) async fn slope(&self, iso: f64, noise: f64) -> f64 {
        let mut squares = self.squared_slopes(iso, self.size.map(|n| n.div_ceil(SCANNED))).await;
        if squares.is_empty() {
            // Small parts may lie between the measured voxels.
            squares = self.squared_slopes(iso, [1; 3]).await;
        }
        let Some(median) = median(squares) else { return f64::INFINITY };
        // The variance of one difference, and of the means of two in [`Image::squared_slope`].
        let inflated: f64 = 2.0 + 2.0 * 0.25;
        libm::sqrt((median - inflated * noise * noise).max(0.0))
    }

    /// The squared gradients at voxels that are these steps apart.
    async fn squared_slopes(&self, iso: f64, steps: [usize; 3]) -> Vec<f64> {
        let [width, height, depth] = self.size;
        let zero = self.middle();
        let level = (iso - zero) as f32;
        let spacing = self.placement.spacing();
        let scale = spacing.map(|own| in_plane(spacing) / own);
        let mut squares = Vec::new();
        let mut rows = [vec![0.0_f32; width], vec![0.0; width], vec![0.0; width]];
        for k in (0..depth).step_by(steps[2]) {
            for j in (0..height).step_by(steps[1]) {
                let [row, above, behind] = &mut rows;
                self.row(j, k, zero, row);
                self.row((j + 1).min(height - 1), k, zero, above);
                self.row(j, (k + 1).min(depth - 1), zero, behind);
                for (i, &value) in row.iter().enumerate().step_by(steps[0]) {
                    let ahead = row.get(i + 1).copied().unwrap_or(value);
                    for (axis, other) in [ahead, above[i], behind[i]].into_iter().enumerate() {
                        if (value < level) != (other < level) {
                            squares.push(self.squared_slope(i + width * (j + height * k), axis, scale));
                        }
                    }
                }
                slices::pause().await;
            }
        }
        squares
    }

    /// The squared gradient halfway between a voxel and the next one along an axis: the difference
    /// of the two along it, and the means of central differences along the others.
    fn squared_slope(&self, first: usize, axis: usize, scale: [f64; 3]) -> f64 {
        let strides = [1, self.size[0], self.size[0] * self.size[1]];
        let second = first + strides[axis];
        let across = |other: usize| {
            let (n, stride) = (self.size[other], strides[other]);
            let index = first / stride % n;
            let (down, up) = (usize::from(index > 0), usize::from(index + 1 < n));
            let difference = |at: usize| {
                (self.voxels.at(at + up * stride) - self.voxels.at(at - down * stride)) / (down + up) as f64
            };
            0.5 * (difference(first) + difference(second))
        };
        let along = self.voxels.at(second) - self.voxels.at(first);
        (0..3)
            .map(|other| scale[other] * if other == axis { along } else { across(other) })
            .map(|slope| slope * slope)
            .sum()
    }
}
