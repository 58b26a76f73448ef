//! Points in linked lists by cell: made in one pass and in little memory, for queries that are few. The points stay where
//! they are; the lists hold their indices.

use super::{NONE, Neighbour, coordinate};
use glam::Vec3;

/// Points per list head, over all cells: of more heads most would stay empty, of fewer many would be shared.
const POINTS_PER_HEAD: usize = 4;

/// Multiplied by these, the coordinates of neighbouring cells are spread over all 32-bit numbers: primes near 2³² times the
/// powers of the inverse of 1.2207, the root of x⁴ = x + 1, whose multiples are spread evenly in three dimensions.
const FACTORS: [u32; 3] = [0xd1b5_4a45, 0xabc9_839f, 0x8cb9_2bad];

/// Linked lists of points, each for the cells with one hash. Points can be kept in *layers* of cells of different sizes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Chains {
    /// One over the side of the cells, by layer.
    inverse_side: Vec<f32>,
    head: Vec<u32>,
    /// The point after each in its list.
    next: Vec<u32>,
    /// Heads of the query under way.
    wanted: Vec<u32>,
}

impl Chains {
    /// Forgets all points; up to `points` will be added. Fast for queries with a radius of half the `sides`.
    pub(crate) fn reset(&mut self, sides: impl IntoIterator<Item = f32>, points: usize) {
        self.inverse_side.clear();
        self.inverse_side.extend(sides.into_iter().map(|side| 1.0 / side));
        self.head.clear();
        self.head.reserve_exact(points / POINTS_PER_HEAD + 1);
        self.head.resize(points / POINTS_PER_HEAD + 1, NONE);
        self.next.reserve_exact(points.saturating_sub(self.next.len()));
        self.next.resize(points, NONE);
    }

    /// Adds a point to a layer; `index` is below the number of points, and its own.
    #[inline(always)]
    pub(crate) fn insert(&mut self, layer: usize, point: Vec3, index: u32) {
        let inverse_side = self.inverse_side[layer];
        let [x, y, z] = point.to_array().map(|c| coordinate(c * inverse_side));
        let head = self.head_of(layer, x, y, z);
        self.next[index as usize] = self.head[head as usize];
        self.head[head as usize] = index;
    }

    /// Collects every point within `reach[k]` of `centre` that was added to layer k, and maybe some of other layers within
    /// the largest reach, by where `points` has them now, no point twice. They have to be in the cells in which they were
    /// added. Replaces the content of `found`.
    pub(crate) fn gather(
        &mut self,
        points: &[Vec3],
        centre: Vec3,
        reach: impl IntoIterator<Item = f32>,
        found: &mut Vec<Neighbour>,
    ) {
        found.clear();
        let mut wanted = core::mem::take(&mut self.wanted);
        wanted.clear();
        let mut largest = 0.0;
        for (layer, (&inverse_side, radius)) in self.inverse_side.iter().zip(reach).enumerate() {
            largest = if radius > largest { radius } else { largest };
            let lo = (centre - radius).to_array().map(|c| coordinate(c * inverse_side));
            let hi = (centre + radius).to_array().map(|c| coordinate(c * inverse_side));
            for z in lo[2]..=hi[2] {
                for y in lo[1]..=hi[1] {
                    for x in lo[0]..=hi[0] {
                        wanted.push(self.head_of(layer, x, y, z));
                    }
                }
            }
        }
        // Cells share lists.
        wanted.sort_unstable();
        wanted.dedup();
        for &head in &wanted {
            let mut index = self.head[head as usize];
            while index != NONE {
                let offset = points[index as usize] - centre;
                let distance_sq = offset.length_squared();
                if distance_sq <= largest * largest {
                    found.push(Neighbour { index, distance_sq, offset });
                }
                index = self.next[index as usize];
            }
        }
        self.wanted = wanted;
    }

    #[inline(always)]
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
    use super::super::gather_naive;
    use super::super::tests::cloud;
    use super::*;

    #[test]
    fn gather_finds_what_the_naive_search_finds() {
        let points = cloud(3000);
        let mut chains = Chains::default();
        for side in [0.3, 1.7] {
            chains.reset([side, 2.0 * side], points.len());
            for (i, &p) in points.iter().enumerate() {
                chains.insert(i % 2, p, i as u32);
            }
            let mut found = Vec::new();
            for &centre in points.iter().step_by(37) {
                for radius in [0.0, 0.1, 0.4] {
                    chains.gather(&points, centre, [radius; 2], &mut found);
                    let mut got: Vec<u32> = found.iter().map(|n| n.index).collect();
                    got.sort_unstable();
                    assert_eq!(got, gather_naive(&points, centre, radius), "side {side} radius {radius}");
                }
            }
        }
    }
}
