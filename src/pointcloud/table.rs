//! Hash table of points.

use glam::DVec3;

/// Open-addressing hash table over a column of points, by their exact coordinates.
///
/// It holds indices only and is never iterated over, so results do not depend on the order of its buckets.
#[derive(Debug, Default)]
pub(super) struct PointTable {
    /// Index of a point plus one, or 0 for an empty bucket. The length is a power of two.
    buckets: Vec<u32>,
    used: usize,
}

/// Golden ratio times 2⁶⁴. Multiplication by it spreads keys that differ in a few bits over the top bits (Fibonacci
/// hashing).
const GOLDEN_RATIO: u64 = 0x9e37_79b9_7f4a_7c15;
/// Number of buckets of the first table.
const FIRST: usize = 1024;

fn hash(p: DVec3) -> u64 {
    let hash = p.to_array().into_iter().fold(0, |hash: u64, value| {
        // Adding 0 maps −0 to +0, which it is equal to.
        (hash.rotate_left(29) ^ (value + 0.0).to_bits()).wrapping_mul(GOLDEN_RATIO)
    });
    // The low bits of a round number are 0, and the low bits of a product depend on no higher ones: mix in the top
    // bits.
    (hash ^ (hash >> 32)).wrapping_mul(GOLDEN_RATIO)
}

impl PointTable {
    /// Index in `points` of the point equal to `p`, or `fresh` if there is none.
    ///
    /// In the latter case `p` must be stored at `fresh` before the next call. `points` must be the same column in every
    /// call. Returns `None` if there is not enough memory.
    pub(super) fn index_of(&mut self, p: DVec3, fresh: usize, points: &[DVec3]) -> Option<u32> {
        if 2 * (self.used + 1) > self.buckets.len() {
            self.grow(points)?;
        }
        let bucket = self.bucket(p, points);
        if self.buckets[bucket] == 0 {
            self.buckets[bucket] = u32::try_from(fresh + 1).ok()?;
            self.used += 1;
        }
        Some(self.buckets[bucket] - 1)
    }

    /// Index in `points` of the point equal to `p`, which is appended if there is none; see [`PointTable::index_of`].
    pub(super) fn find_or_add(&mut self, p: DVec3, points: &mut Vec<DVec3>) -> Option<u32> {
        if points.len() == points.capacity() {
            points.try_reserve_exact((points.len() / 2).max(FIRST)).ok()?;
        }
        let index = self.index_of(p, points.len(), points)?;
        if index as usize == points.len() {
            points.push(p);
        }
        Some(index)
    }

    /// Bucket that holds `p`, or the empty one where it belongs.
    fn bucket(&self, p: DVec3, points: &[DVec3]) -> usize {
        let mask = self.buckets.len() - 1;
        let mut bucket = (hash(p) >> 32) as usize & mask;
        while self.buckets[bucket] != 0 && points[self.buckets[bucket] as usize - 1] != p {
            bucket = (bucket + 1) & mask;
        }
        bucket
    }

    fn grow(&mut self, points: &[DVec3]) -> Option<()> {
        let size = (2 * self.buckets.len()).max(FIRST);
        let mut fresh = Vec::new();
        fresh.try_reserve_exact(size).ok()?;
        fresh.resize(size, 0);
        let old = core::mem::replace(&mut self.buckets, fresh);
        for index in old.into_iter().filter(|&index| index != 0) {
            let bucket = self.bucket(points[index as usize - 1], points);
            self.buckets[bucket] = index;
        }
        Some(())
    }
}
