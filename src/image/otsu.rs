//! The histogram of an image, and Otsu's threshold in it.

use super::Image;

/// Bins of a histogram: Otsu's threshold is one of their edges.
const BINS: usize = 256;

/// The numbers of voxels whose values lie in each of [`BINS`] bins of equal width, from the
/// smallest value to the largest.
#[derive(Debug)]
pub(crate) struct Histogram {
    counts: Vec<u64>,
    /// The smallest value.
    min: f64,
    /// Width of a bin.
    width: f64,
}

impl Histogram {
    /// Counts the voxels in slices of work.
    pub(super) async fn of(image: &Image) -> Self {
        let [min, max] = image.range;
        let width = (max - min) / BINS as f64;
        let mut counts = vec![0; BINS];
        let count = |_: usize, values: &[f64]| {
            for value in values {
                counts[(((value - min) / width) as usize).min(BINS - 1)] += 1;
            }
        };
        image.voxels.for_each(count).await;
        Self { counts, min, width }
    }

    /// Number of voxels in each bin.
    pub(crate) fn counts(&self) -> &[u64] {
        &self.counts
    }

    /// The edge between two bins for which the variance between the classes, w₀ w₁ (μ₁ − μ₀)², is
    /// largest (Otsu's equation 14). If several edges tie, as between two peaks, the middle one.
    pub(crate) fn otsu(&self) -> f64 {
        let [first, last] = self.best();
        self.min + self.width * (0.5 * (first + last) as f64 + 1.0)
    }

    /// The first and the last of the bins after which a threshold separates the classes best.
    fn best(&self) -> [usize; 2] {
        let total: u64 = self.counts.iter().sum();
        let all: u64 = (0..).zip(&self.counts).map(|(bin, count)| bin * count).sum();
        let (mut below, mut sum) = (0, 0);
        let (mut best, mut first, mut last) = (-1.0, 0, 0);
        for (bin, &count) in self.counts.iter().enumerate().take(BINS - 1) {
            below += count;
            sum += bin as u64 * count;
            let above = total - below;
            if below == 0 || above == 0 {
                continue;
            }
            let apart = (all - sum) as f64 / above as f64 - sum as f64 / below as f64;
            let between = below as f64 * above as f64 * apart * apart;
            if between > best {
                (best, first) = (between, bin);
            }
            if between >= best {
                last = bin;
            }
        }
        [first, last]
    }
}
