//! Linked lists of points by cell, made in one pass with little memory. The points stay in their
//! columns; the lists hold indices.

use super::cell;
use crate::math::NONE;
use glam::Vec3;

/// Points per list head. With more heads most lists would be empty, with fewer heads many cells
/// would share a list.
const POINTS_PER_HEAD: usize = 4;

/// Hash factors of the coordinates: multiplication by them spreads neighbouring cells over all
/// 32-bit numbers. They are primes near 2³² times the powers of 1/1.2207, where 1.2207 is the root
/// of x⁴ = x + 1, whose multiples are evenly spread in three dimensions.
const FACTORS: [u32; 3] = [0xd1b5_4a45, 0xabc9_839f, 0x8cb9_2bad];

/// Linked lists of points, one for all cells with the same hash. Points can be in *layers* with
/// cells of different sizes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Chains {
    /// 1 over the side of the cells, for each layer.
    inverse_side: Vec<f32>,
    head: Vec<u32>,
    /// For each point the one after it in its list.
    next: Vec<u32>,
    /// Buffer for the heads of a visit.
    wanted: Vec<u64>,
}

impl Chains {
    /// Empties the lists for up to `points` points, in layers with cells of these `sides`. Queries
    /// are fast for radii of half a side.
    pub(crate) fn reset(&mut self, sides: impl IntoIterator<Item = f32>, points: usize) {
        self.inverse_side.clear();
        self.inverse_side.extend(sides.into_iter().map(|side| 1.0 / side));
        self.head.clear();
        self.head.reserve_exact(points / POINTS_PER_HEAD + 1);
        self.head.resize(points / POINTS_PER_HEAD + 1, NONE);
        self.next.reserve_exact(points.saturating_sub(self.next.len()));
        self.next.resize(points, NONE);
    }

    /// Adds a point to a layer. Its `index` must be below the number of points, and unique.
    pub(crate) fn insert(&mut self, layer: usize, point: Vec3, index: u32) {
        let inverse_side = self.inverse_side[layer];
        let [x, y, z] = cell(point * inverse_side);
        let head = self.head_of(layer, x, y, z);
        self.next[index as usize] = self.head[head as usize];
        self.head[head as usize] = index;
    }

    /// Returns those of `points` that were added to the cell of `place` in a layer, are still in it
    /// and pass `meant`.
    pub(crate) fn beside(
        &self,
        points: &[Vec3],
        layer: usize,
        place: Vec3,
        meant: impl Fn(u32) -> bool,
    ) -> impl Iterator<Item = u32> {
        let inverse_side = self.inverse_side[layer];
        let [x, y, z] = cell(place * inverse_side);
        let list = self.list(self.head_of(layer, x, y, z));
        let is_beside = move |p: Vec3| cell(p * inverse_side) == [x, y, z];
        list.filter(move |&index| meant(index) && is_beside(points[index as usize]))
    }

    /// Visits every point that was added to layer k within `reach[k]` of the box from `lo` to `hi`,
    /// and some points beyond, each once.
    pub(crate) fn visit(
        &mut self,
        [lo, hi]: [Vec3; 2],
        reach: impl IntoIterator<Item = f32>,
        mut visit: impl FnMut(u32),
    ) {
        let mut wanted = core::mem::take(&mut self.wanted);
        wanted.clear();
        for (layer, (&inverse_side, reach)) in self.inverse_side.iter().zip(reach).enumerate() {
            let (lo, hi) = (cell((lo - reach) * inverse_side), cell((hi + reach) * inverse_side));
            for z in lo[2]..=hi[2] {
                for y in lo[1]..=hi[1] {
                    for x in lo[0]..=hi[0] {
                        wanted.push(u64::from(self.head_of(layer, x, y, z)));
                    }
                }
            }
        }
        // Several cells may share a list.
        wanted.sort_unstable();
        wanted.dedup();
        wanted.iter().for_each(|&head| self.list(head as u32).for_each(&mut visit));
        self.wanted = wanted;
    }

    /// Returns the points of a list.
    fn list(&self, head: u32) -> impl Iterator<Item = u32> {
        let mut index = self.head[head as usize];
        core::iter::from_fn(move || {
            let this = index;
            (this != NONE).then(|| {
                index = self.next[this as usize];
                this
            })
        })
    }

    fn head_of(&self, layer: usize, x: u32, y: u32, z: u32) -> u32 {
        let hash = FACTORS
            .iter()
            .zip([x, y, z])
            .fold(layer as u32, |hash, (factor, c)| hash.wrapping_add(factor.wrapping_mul(c)));
        ((u64::from(hash) * self.head.len() as u64) >> 32) as u32
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{cloud, gather_naive};
    use super::*;

    #[test]
    fn visit_comes_to_all_that_the_naive_search_finds_once() {
        let points = cloud(3000);
        let mut chains = Chains::default();
        for side in [0.3, 1.7] {
            chains.reset([side, 2.0 * side], points.len());
            for (i, &p) in points.iter().enumerate() {
                chains.insert(i % 2, p, i as u32);
            }
            for (&a, &b) in points.iter().zip(&points[1..]).step_by(37) {
                let (lo, hi) = (a.min(b), a.max(b).min(a + 0.2));
                for reach in [0.0, 0.1, 0.4] {
                    let mut visited = vec![0; points.len()];
                    chains.visit([lo, hi], [reach; 2], |index| visited[index as usize] += 1);
                    assert!(visited.iter().all(|&times| times <= 1), "side {side} reach {reach}");
                    for centre in [lo, hi, 0.5 * (lo + hi)] {
                        for index in gather_naive(&points, centre, reach) {
                            assert_eq!(visited[index as usize], 1, "side {side} reach {reach}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn those_beside_a_point_are_all_in_one_cell() {
        let points = cloud(3000);
        let mut chains = Chains::default();
        let side = 0.3;
        chains.reset([side, 2.0 * side], points.len());
        for (i, &p) in points.iter().enumerate() {
            chains.insert(0, p, i as u32);
        }
        let mut times = vec![0; points.len()];
        for &p in &points {
            for index in chains.beside(&points, 0, p, |index| index % 3 > 0) {
                assert!(index % 3 > 0);
                assert!((points[index as usize] - p).abs().max_element() <= side);
                times[index as usize] += 1;
            }
        }
        // Every point is beside as many points as there are in its cell, itself among them.
        assert!(times.iter().enumerate().all(|(index, &times)| (times > 0) == (index % 3 > 0)));
    }
}
