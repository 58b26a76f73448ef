//! Which of the points so far is equal to a given one.

use glam::DVec3;

/// An open-addressing hash table over a column of points, by their exact coordinates. It holds indices only, and nothing
/// goes through it in its own order, so that what comes out depends on the points alone.
#[derive(Debug, Default)]
pub(super) struct Table {
    /// Index of a point plus one, 0 for an empty place; the length is a power of two.
    places: Vec<u32>,
    used: usize,
}

/// The golden ratio in 64 bits: multiplied by it, keys that differ in a few bits are spread well in the top ones.
const GOLDEN_RATIO: u64 = 0x9e37_79b9_7f4a_7c15;
/// Places of the first table.
const FIRST: usize = 1024;

fn hash(p: DVec3) -> u64 {
    let hash = p.to_array().into_iter().fold(0, |hash: u64, value| {
        // Adding 0 makes the negative zero a positive one, which it is equal to.
        (hash.rotate_left(29) ^ (value + 0.0).to_bits()).wrapping_mul(GOLDEN_RATIO)
    });
    // The lowest bits of a round number are 0, and those of a product depend on lower ones alone: the top ones go round again.
    (hash ^ (hash >> 32)).wrapping_mul(GOLDEN_RATIO)
}

impl Table {
    /// The index in `points` of the one equal to `p`; if there is none, that index is `fresh`, and `p` must stand there before
    /// the next call. `points` must be the same column in every call. None if there is no memory for it.
    pub(super) fn index_of(&mut self, p: DVec3, fresh: usize, points: &[DVec3]) -> Option<u32> {
        if 2 * (self.used + 1) > self.places.len() {
            self.grow(points)?;
        }
        let place = self.place(p, points);
        if self.places[place] == 0 {
            self.places[place] = u32::try_from(fresh + 1).ok()?;
            self.used += 1;
        }
        Some(self.places[place] - 1)
    }

    /// The index in `points` of the one equal to `p`, which is appended if there is none; otherwise as [`Table::index_of`].
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

    /// Where `p` is, or would be.
    fn place(&self, p: DVec3, points: &[DVec3]) -> usize {
        let mask = self.places.len() - 1;
        let mut place = (hash(p) >> 32) as usize & mask;
        while self.places[place] != 0 && points[self.places[place] as usize - 1] != p {
            place = (place + 1) & mask;
        }
        place
    }

    fn grow(&mut self, points: &[DVec3]) -> Option<()> {
        let size = (2 * self.places.len()).max(FIRST);
        let mut fresh = Vec::new();
        fresh.try_reserve_exact(size).ok()?;
        fresh.resize(size, 0);
        let old = core::mem::replace(&mut self.places, fresh);
        for index in old.into_iter().filter(|&index| index != 0) {
            let place = self.place(points[index as usize - 1], points);
            self.places[place] = index;
        }
        Some(())
    }
}
