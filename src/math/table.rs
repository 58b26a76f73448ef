//! A hash table of indices into a column of items of any type.

/// Golden ratio times 2⁶⁴. Multiplication by it spreads keys that differ in a few bits over the top
/// bits (Fibonacci hashing).
pub(crate) const GOLDEN_RATIO: u64 = 0x9e37_79b9_7f4a_7c15;

/// Hash of words, the same on every machine.
pub(crate) fn hash(words: impl IntoIterator<Item = u64>) -> u32 {
    let hash =
        words.into_iter().fold(0, |hash: u64, word| (hash.rotate_left(29) ^ word).wrapping_mul(GOLDEN_RATIO));
    // The low bits of a round number are 0, and the low bits of a product depend only on lower
    // bits: mix in the top bits.
    ((hash ^ (hash >> 32)).wrapping_mul(GOLDEN_RATIO) >> 32) as u32
}

/// Open-addressing hash table, at most half full. The items stay in the caller's column: a table of
/// the standard library would hold a second copy of each, and files have millions of points.
///
/// It is never iterated over, so results do not depend on the order of its buckets.
#[derive(Debug, Default)]
pub(crate) struct IndexTable {
    /// Hash of an item in the upper half, its index plus one in the lower; 0 for an empty bucket.
    /// The length is a power of two.
    buckets: Vec<u64>,
    used: usize,
}

impl IndexTable {
    /// The index of the item with this hash that satisfies `is_it`.
    pub(crate) fn find(&self, hash: u32, is_it: impl Fn(usize) -> bool) -> Option<u32> {
        if self.buckets.is_empty() {
            return None;
        }
        index_in(self.buckets[self.bucket(hash, is_it)])
    }

    /// The index of the item with this hash that satisfies `is_it`. If there is none, `fresh` is
    /// added and returned; the caller must then store the item there. None if memory runs out.
    pub(crate) fn find_or_add(
        &mut self,
        hash: u32,
        fresh: usize,
        is_it: impl Fn(usize) -> bool,
    ) -> Option<u32> {
        if 2 * (self.used + 1) > self.buckets.len() {
            self.grow()?;
        }
        let bucket = self.bucket(hash, is_it);
        if self.buckets[bucket] == 0 {
            self.buckets[bucket] = u64::from(hash) << 32 | u64::from(u32::try_from(fresh + 1).ok()?);
            self.used += 1;
        }
        index_in(self.buckets[bucket])
    }

    /// Bucket of the item, or the empty bucket for it.
    fn bucket(&self, hash: u32, is_it: impl Fn(usize) -> bool) -> usize {
        let mask = self.buckets.len() - 1;
        let is_here = |entry: u64| {
            entry == 0
                || (entry >> 32) as u32 == hash && index_in(entry).is_some_and(|index| is_it(index as usize))
        };
        let mut bucket = hash as usize & mask;
        while !is_here(self.buckets[bucket]) {
            bucket = (bucket + 1) & mask;
        }
        bucket
    }

    fn grow(&mut self) -> Option<()> {
        let size = (2 * self.buckets.len()).max(2);
        let mut fresh = Vec::new();
        fresh.try_reserve_exact(size).ok()?;
        fresh.resize(size, 0);
        let old = core::mem::replace(&mut self.buckets, fresh);
        for entry in old.into_iter().filter(|&entry| entry != 0) {
            // All entries are of different items.
            let bucket = self.bucket((entry >> 32) as u32, |_| false);
            self.buckets[bucket] = entry;
        }
        Some(())
    }
}

fn index_in(entry: u64) -> Option<u32> {
    (entry as u32).checked_sub(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_with_equal_hashes_are_told_apart() {
        let items: Vec<u64> = (0..1000).map(|k| k * k % 701).collect();
        let mut table = IndexTable::default();
        for (k, &item) in items.iter().enumerate() {
            let hash = hash([item % 10]);
            let first = items.iter().position(|&other| other == item).expect("it is one of them");
            assert_eq!(table.find(hash, |k| items[k] == item).is_some(), first < k);
            assert_eq!(table.find_or_add(hash, k, |k| items[k] == item), Some(first as u32));
        }
    }
}
