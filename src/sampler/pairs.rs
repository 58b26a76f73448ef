//! Neighbour lists for the relaxation: every pair once, under the larger index.

/// Lists by particle. A list can be replaced; it keeps its place while it fits.
#[derive(Clone, Debug, Default)]
pub(super) struct Pairs {
    start: Vec<u32>,
    /// At `start[i]` a header (length in the low half, capacity in the high half), then the neighbours.
    entries: Vec<u32>,
}

/// Room for a header and a list of usual length: within the reach of the relaxation a lattice has 6 to 12 neighbours,
/// half of them of smaller index.
const ENTRIES_PER_LIST: usize = 6;

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
        self.entries.reserve_exact((particles * ENTRIES_PER_LIST).saturating_sub(self.entries.len()));
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
            self.make_room(1 + neighbours.len() + SPARE);
            head = self.entries.len();
            capacity = neighbours.len() + SPARE;
            self.start[i] = head as u32;
            self.entries.resize(head + 1 + capacity, 0);
        }
        self.entries[head] = neighbours.len() as u32 | (capacity as u32) << 16;
        self.entries[head + 1..head + 1 + neighbours.len()].copy_from_slice(neighbours);
    }

    /// Grows by a sixteenth where a vector would double: moved lists are few.
    fn make_room(&mut self, entries: usize) {
        if self.entries.len() + entries > self.entries.capacity() {
            self.entries.reserve_exact(entries + self.entries.len() / 16);
        }
    }

    /// Adds `j` to the list of particle `i` if it is not there.
    pub(super) fn insert(&mut self, i: usize, j: u32) {
        let head = self.start[i] as usize;
        let (len, capacity) = ((self.entries[head] & 0xffff) as usize, (self.entries[head] >> 16) as usize);
        if self.of(i).contains(&j) {
            return;
        }
        if len < capacity {
            self.entries[head] += 1;
            self.entries[head + 1 + len] = j;
        } else {
            let moved = self.entries.len();
            let capacity = len + 1 + SPARE;
            self.make_room(1 + capacity);
            self.start[i] = moved as u32;
            self.entries.push((len + 1) as u32 | (capacity as u32) << 16);
            self.entries.extend_from_within(head + 1..head + 1 + len);
            self.entries.push(j);
            self.entries.resize(moved + 1 + capacity, 0);
        }
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
                pairs.insert(i as usize, 1_000 + round);
                pairs.insert(i as usize, 1_000 + round);
                let (last, rest) = pairs.of(i as usize).split_last().expect("one was inserted");
                assert_eq!((*last, rest), (1_000 + round, list.as_slice()));
            }
        }
        assert_eq!(pairs.len(), 40);
    }
}
