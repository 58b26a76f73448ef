//! Neighbour lists for the relaxation: every pair once, under the larger index.

/// Lists by particle. A list can be replaced; it keeps its place while it fits.
#[derive(Clone, Debug, Default)]
pub(super) struct Pairs {
    start: Vec<u32>,
    /// At `start[i]` a header (length in the low half, capacity in the high half), then the neighbours.
    entries: Vec<u32>,
}

/// Entries that a moved list gets beyond its length, so that it moves seldom.
const SPARE: usize = 2;

impl Pairs {
    pub(super) fn clear(&mut self) {
        self.start.clear();
        self.entries.clear();
    }

    /// Makes room for `particles` lists of usual length.
    pub(super) fn reserve(&mut self, particles: usize) {
        self.start.reserve_exact(particles.saturating_sub(self.start.len()));
        // On a hexagonal lattice each particle has three neighbours of smaller index; seams have more.
        self.entries.reserve_exact((particles * 9 / 2).saturating_sub(self.entries.len()));
    }

    /// Number of lists.
    pub(super) fn len(&self) -> usize {
        self.start.len()
    }

    pub(super) fn truncate(&mut self, len: usize) {
        self.start.truncate(len);
    }

    /// Adds empty lists up to `len`.
    pub(super) fn extend_to(&mut self, len: usize) {
        while self.start.len() < len {
            self.push([]);
        }
    }

    /// Adds the list of the next particle.
    #[inline]
    pub(super) fn push(&mut self, neighbours: impl IntoIterator<Item = u32>) {
        let head = self.entries.len();
        self.start.push(head as u32);
        self.entries.push(0);
        self.entries.extend(neighbours);
        let len = (self.entries.len() - head - 1) as u32;
        self.entries[head] = len | len << 16;
    }

    /// Replaces the list of particle `i`.
    pub(super) fn replace(&mut self, i: usize, neighbours: &[u32]) {
        let mut head = self.start[i] as usize;
        let mut capacity = (self.entries[head] >> 16) as usize;
        if neighbours.len() > capacity {
            head = self.entries.len();
            capacity = neighbours.len() + SPARE;
            self.start[i] = head as u32;
            self.entries.resize(head + 1 + capacity, 0);
        }
        self.entries[head] = neighbours.len() as u32 | (capacity as u32) << 16;
        self.entries[head + 1..head + 1 + neighbours.len()].copy_from_slice(neighbours);
    }

    /// Neighbours of particle `i` with a smaller index.
    #[inline(always)]
    pub(super) fn of(&self, i: usize) -> &[u32] {
        let head = self.start[i] as usize;
        let len = (self.entries[head] & 0xffff) as usize;
        &self.entries[head + 1..head + 1 + len]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_hold_what_was_put_last() {
        let mut pairs = Pairs::default();
        for i in 0..40_u32 {
            pairs.push((0..i % 7).map(|k| k + i));
        }
        for round in 0..5_u32 {
            for i in (0..40).filter(|i| i % 3 == round % 3) {
                let list: Vec<u32> = (0..(i + round) % 9).map(|k| k * i + round).collect();
                pairs.replace(i as usize, &list);
                assert_eq!(pairs.of(i as usize), list);
            }
        }
        assert_eq!(pairs.of(0), (0..3).map(|_| 3).collect::<Vec<u32>>().as_slice());
        assert_eq!(pairs.len(), 40);
    }
}
