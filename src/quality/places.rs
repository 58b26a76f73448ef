//! The places with the worst spacing: crowded pairs and wide holes.

use crate::math::{key_of, sort_by_key};
use crate::slices::{HEAVY, pause};
use glam::Vec3;
use serde::Serialize;

/// Distance, over the ideal one, below which two particles are a crowded pair. The front places
/// children that are 0.7 of the ideal distance from a particle, and relaxation moves such pairs
/// apart.
pub const CROWDED: f64 = 0.75;
/// Radius, over the ideal one, above which a hole is wide. A lattice with one particle missing has
/// a hole of √3; half that excess is 1.37.
pub const WIDE: f64 = 1.4;
/// Largest number of places of each kind that are listed: enough to examine one by one. The figures
/// count all of them.
const MOST: usize = 64;

/// Two particles and their distance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Pair {
    /// Indices of the particles, the smaller one first.
    pub particles: [u32; 2],
    /// Distance over the ideal spacing or, if radii are wanted, over their sum.
    pub ratio: f64,
}

/// A disc on the surface without a particle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Hole {
    /// Position of the middle, in the field's units.
    pub position: [f32; 3],
    /// Distance to the nearest particle, in the field's units.
    pub radius: f64,
    /// Radius over that in the perfect lattice or, if radii are wanted, in the lattice of those
    /// around it.
    pub ratio: f64,
}

/// The worst places, the worst first, at most 64 of each kind: the crowded pairs and the wide holes
/// or, if there are none, the closest pair and the largest hole.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Places {
    /// Crowded pairs.
    pub pairs: Vec<Pair>,
    /// Wide holes.
    pub holes: Vec<Hole>,
}

/// Counts crowded pairs and keeps the worst.
#[derive(Debug, Default)]
pub(super) struct Pairs {
    pub(super) crowded: usize,
    kept: Vec<Pair>,
}

impl Pairs {
    /// Returns whether a pair at this distance would be counted or kept, so that it must be added.
    pub(super) fn matters(&self, ratio: f64) -> bool {
        ratio < CROWDED || self.kept.first().is_none_or(|closest| ratio < closest.ratio)
    }

    /// Adds a pair. Each pair must be added once.
    pub(super) fn add(&mut self, ratio: f64, i: u32, j: u32) {
        if !self.matters(ratio) {
            return;
        }
        self.crowded += usize::from(ratio < CROWDED);
        let pair = Pair { particles: [i.min(j), i.max(j)], ratio };
        let is_closest = self.kept.first().is_none_or(|closest| ratio < closest.ratio);
        self.kept.push(pair);
        if is_closest {
            let last = self.kept.len() - 1;
            self.kept.swap(0, last);
        }
        if self.kept.len() >= 4 * MOST {
            self.settle();
        }
    }

    fn settle(&mut self) {
        sort_by_key(&mut self.kept, |&Pair { particles: [i, j], .. }| u64::from(i) << 32 | u64::from(j));
        sort_by_key(&mut self.kept, |pair| key_of(pair.ratio));
        self.kept.truncate(MOST);
    }

    /// Returns the pairs to be reported.
    pub(super) fn reported(mut self) -> Vec<Pair> {
        self.settle();
        self.kept.truncate(self.crowded.max(1));
        self.kept
    }
}

/// Returns the number of wide holes, and the holes to be reported, from the empty discs that were
/// found.
///
/// Several empty discs may show one hole: if the middle of one disc lies in another, only the one
/// with the larger ratio of its radius to the ideal one counts.
pub(super) async fn distinct(mut found: Vec<Hole>) -> (usize, Vec<Hole>) {
    let bits = |hole: &Hole| hole.position.map(|c| u64::from(c.to_bits()));
    sort_by_key(&mut found, |hole| bits(hole)[2]);
    sort_by_key(&mut found, |hole| bits(hole)[0] << 32 | bits(hole)[1]);
    sort_by_key(&mut found, |hole| !key_of(hole.ratio));
    let mut holes: Vec<Hole> = Vec::new();
    for (k, hole) in found.into_iter().enumerate() {
        let at = Vec3::from(hole.position);
        let is_apart =
            |other: &Hole| f64::from(Vec3::from(other.position).distance(at)) > hole.radius.max(other.radius);
        if holes.iter().all(is_apart) {
            holes.push(hole);
        }
        if k.is_multiple_of(HEAVY) {
            pause().await;
        }
    }
    let wide = holes.iter().filter(|hole| hole.ratio > WIDE).count();
    holes.truncate(wide.clamp(1, MOST));
    (wide, holes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::slices::complete;

    fn hole(x: f32, ratio: f64) -> Hole {
        Hole { position: [x, 0.0, 0.0], radius: ratio, ratio }
    }

    #[test]
    fn pairs_are_counted_and_the_worst_are_told() {
        let mut pairs = Pairs::default();
        for (k, ratio) in [0.9, 0.8, 0.95, 0.7, 0.5, 0.74].into_iter().enumerate() {
            pairs.add(ratio, k as u32 + 10, k as u32);
        }
        assert_eq!(pairs.crowded, 3);
        let reported = pairs.reported();
        assert_eq!(reported.iter().map(|pair| pair.ratio).collect::<Vec<_>>(), [0.5, 0.7, 0.74]);
        assert_eq!(reported[0].particles, [4, 14]);
    }

    #[test]
    fn of_many_pairs_the_count_is_whole_and_the_worst_are_told() {
        let mut pairs = Pairs::default();
        for k in (0..2000).rev() {
            pairs.add(f64::from(k) / 2000.0, k, k + 1);
        }
        assert_eq!(pairs.crowded, 1500);
        let reported = pairs.reported();
        assert_eq!(reported.len(), MOST);
        assert!(reported.iter().enumerate().all(|(k, pair)| pair.particles[0] == k as u32));
    }

    #[test]
    fn without_a_crowded_pair_the_closest_is_told() {
        let mut pairs = Pairs::default();
        [0.9, 0.85, 0.95].iter().for_each(|&ratio| pairs.add(ratio, 1, 2));
        assert_eq!((pairs.crowded, pairs.reported()), (0, vec![Pair { particles: [1, 2], ratio: 0.85 }]));
        assert!(Pairs::default().reported().is_empty());
    }

    #[test]
    fn discs_in_one_hole_are_one_hole() {
        // The first two overlap, the third lies apart, and the last is not wide.
        let found = vec![hole(0.0, 1.5), hole(1.0, 1.6), hole(5.0, 1.45), hole(9.0, 1.3)];
        let (wide, reported) = complete(distinct(found));
        assert_eq!((wide, reported), (2, vec![hole(1.0, 1.6), hole(5.0, 1.45)]));
        assert_eq!(complete(distinct(vec![hole(0.0, 1.1)])), (0, vec![hole(0.0, 1.1)]));
        assert_eq!(complete(distinct(Vec::new())), (0, Vec::new()));
    }
}
