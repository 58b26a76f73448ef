//! Figures of the nearest-neighbour distances.

use super::figures::{Figures, Spacing};
use super::moments::Moments;
use super::places::{CROWDED, Pairs};
use super::points::MeasuredPoints;
use crate::math::{key, unkey};
use crate::slices::{MEDIUM, pause, ranges};
use serde::Serialize;

/// Histogram of the nearest-neighbour distances over the ideal ones: the ideal spacing, or twice
/// the particle's wanted radius if given. Bins are equal, and values outside are counted in the
/// outermost.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Histogram {
    /// Lower end of the first bin.
    pub min: f64,
    /// Upper end of the last bin.
    pub max: f64,
    /// Number of distances in each bin.
    pub bins: Vec<u32>,
}

impl Histogram {
    /// The range is fixed, so that two runs can be compared; the perfect lattice is at 1. Hardly
    /// any particle has a larger distance.
    const RANGE: (f64, f64) = (0.0, 1.2);
    /// A bin is 0.01 wide: a fifth of the standard deviation of the distances on a relaxed surface.
    const BINS: usize = 120;

    /// Counts the distances `nearest` of particles over the ideal one of each. NaN is left out.
    pub(super) fn new(nearest: impl IntoIterator<Item = (usize, f32)>, ideal: impl Fn(usize) -> f64) -> Self {
        let (min, max) = Self::RANGE;
        let mut bins = vec![0; Self::BINS];
        for (i, distance) in nearest {
            let place = (f64::from(distance) / ideal(i) - min) / (max - min) * Self::BINS as f64;
            if !place.is_nan() {
                bins[(place as usize).min(Self::BINS - 1)] += 1;
            }
        }
        Self { min, max, bins }
    }
}

/// Adds the pairs of points with at least one `inner` point, by their distance over d_hex.
pub(super) async fn add_pairs(points: &MeasuredPoints, inner: &[bool], d_hex: f64, pairs: &mut Pairs) {
    let MeasuredPoints { tree, creases, .. } = points;
    let reach = (CROWDED * d_hex) as f32;
    let mut near = Vec::new();
    for range in ranges(inner.len(), MEDIUM) {
        for i in range.filter(|&i| inner[i] && creases.is_first(i)) {
            let nearest = f64::from(points.nearest_kept(i)) / d_hex;
            if !nearest.is_finite() || !pairs.matters(nearest) {
                continue;
            }
            let p = tree.position[i];
            near.clear();
            if nearest < CROWDED {
                tree.within_box(p - reach, p + reach, &mut near);
            } else {
                near.push(creases.first(creases.nearest(tree, i).1 as usize) as u32);
            }
            for &j in &near {
                let j = j as usize;
                // A pair of two inner points is added at the earlier one.
                if j != i && creases.is_first(j) && (j > i || !inner[j] || nearest >= CROWDED) {
                    pairs.add(points.distance(i, j) / d_hex, tree.origin[i], tree.origin[j]);
                }
            }
        }
        pause().await;
    }
}

/// Nearest-neighbour distances of the `inner` points, without dropped points, and of `duplicates`.
pub(super) fn measure(points: &MeasuredPoints, inner: &[bool], duplicates: usize, d_hex: f64) -> Spacing {
    // Distances are sorted as keys. A dropped duplicate is a point too, at distance 0 from the one
    // it equals.
    let mut sorted: Vec<u64> = (0..inner.len())
        .filter(|&i| inner[i])
        .map(|i| points.nearest(i))
        .filter(|d| d.is_finite())
        .chain(core::iter::repeat_n(0.0, duplicates))
        .map(|d| key(d, 0))
        .collect();
    if sorted.is_empty() {
        return Figures::default().spacing;
    }
    sorted.sort_unstable();
    let distance = |k: usize| f64::from(unkey(sorted[k]).0);
    let mut moments = Moments::default();
    (0..sorted.len()).for_each(|k| moments.add(distance(k)));
    // The first percentile is interpolated linearly between two distances.
    let place = 0.01 * (sorted.len() - 1) as f64;
    let (below, above) = (distance(place as usize), distance((place as usize + 1).min(sorted.len() - 1)));
    Spacing {
        nearest_min: distance(0) / d_hex,
        rho: distance(0) / d_hex,
        nearest_mean: moments.mean() / d_hex,
        spacing_variation: moments.variation(),
        nearest_ratio: distance(0) / moments.mean(),
        nearest_percentile_1: (below + (above - below) * place.fract()) / d_hex,
        crowded: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_distance_counts_by_the_ideal_one_of_its_particle() {
        let diameters = [0.2, 2.0, 20.0, 20.0, 2.0];
        let Histogram { bins, .. } =
            Histogram::new((0..).zip([0.2, 1.99, 20.0, 500.0, f32::NAN]), |i| diameters[i]);
        let found: Vec<(usize, u32)> = bins.into_iter().enumerate().filter(|&(_, count)| count > 0).collect();
        assert_eq!(found, [(99, 1), (100, 2), (119, 1)]);
    }
}
