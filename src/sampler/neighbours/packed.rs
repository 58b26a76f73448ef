//! Neighbour lists of the relaxation, 16 bytes for each particle: every pair is stored once, with
//! the larger index.

use crate::math::push_gently;
use crate::sampler::neighbours::constants::{FULL_COSINE, LISTED_COSINE};
use crate::sampler::probe::BATCH;
use crate::spatial::Neighbour;
use core::ops::Range;

/// Neighbours that a list has room for. In a lattice a particle has 6 to 12 neighbours within the
/// reach of the relaxation, half of them with a smaller index; one particle in a hundred has more
/// than eight of these.
pub(crate) const ROOM: usize = 8;

/// The neighbour lists of all particles.
///
/// A neighbour is stored as the difference of the indices. The front numbers particles level by
/// level, so neighbours are of the same level or of one shortly before, and the difference fits
/// into 16 bits. Other pairs are *far* pairs and are stored with both indices.
#[derive(Clone, Debug, Default)]
pub(crate) struct PackedNeighbours {
    /// Differences of the indices to those of the neighbours; 0 after the last.
    near: Vec<[u16; ROOM]>,
    /// Larger and smaller index of the far pairs: in crowds, whose lists are full, and where two
    /// fronts meet whose indices are far apart.
    far: Vec<[u32; 2]>,
    /// Whether a particle of each block may have a pair of a weight below 1: those of a block land
    /// in one batch.
    is_weighted: Vec<bool>,
}

impl PackedNeighbours {
    pub(crate) fn clear(&mut self) {
        self.near.clear();
        self.far.clear();
        self.is_weighted.clear();
    }

    /// Allocates exactly what `particles` lists take.
    pub(crate) fn reserve(&mut self, particles: usize) {
        self.near.reserve_exact(particles.saturating_sub(self.near.len()));
    }

    /// Notes that particle `i` may have a pair of a weight below 1: its normal may differ from a
    /// neighbour's by more than 60°.
    #[cold]
    pub(crate) fn note_weighted(&mut self, i: usize) {
        let block = i / BATCH;
        if block >= self.is_weighted.len() {
            self.is_weighted.resize(block + 1, false);
        }
        self.is_weighted[block] = true;
    }

    /// Returns whether a particle in the blocks of `range` may have a pair of a weight below 1.
    pub(crate) fn any_weighted(&self, range: &Range<usize>) -> bool {
        (range.start / BATCH..range.end.div_ceil(BATCH))
            .any(|block| self.is_weighted.get(block) == Some(&true))
    }

    /// Frees the memory that the lists do not use.
    pub(crate) fn shrink(&mut self) {
        self.near.shrink_to_fit();
        self.far.shrink_to_fit();
    }

    /// Returns the number of lists.
    pub(crate) fn len(&self) -> usize {
        self.near.len()
    }

    pub(crate) fn truncate(&mut self, len: usize) {
        self.near.truncate(len);
        self.far.retain(|pair| (pair[0] as usize) < len);
    }

    /// Keeps the lists of those particles that have a new row, and in them the particles that have
    /// one. The rows ascend; `none` marks a particle without.
    pub(crate) fn keep(&mut self, rows: &[u32], none: u32) {
        let weighted = core::mem::take(&mut self.is_weighted);
        let mut kept = 0;
        for i in (0..self.near.len()).filter(|&i| rows[i] != none) {
            let mut list = [0; ROOM];
            let others = self.near(i).map(|j| rows[j]).filter(|&row| row != none);
            for (entry, row) in list.iter_mut().zip(others) {
                // Rows only come nearer to each other.
                *entry = (rows[i] - row) as u16;
            }
            if weighted.get(i / BATCH) == Some(&true) {
                self.note_weighted(kept);
            }
            self.near[kept] = list;
            kept += 1;
        }
        self.near.truncate(kept);
        self.far.iter_mut().for_each(|pair| *pair = pair.map(|i| rows[i as usize]));
        self.far.retain(|pair| !pair.contains(&none));
    }

    /// Appends empty lists until there are `len`.
    pub(crate) fn extend_to(&mut self, len: usize) {
        self.near.resize(len.max(self.near.len()), [0; ROOM]);
    }

    /// Appends the list of the next particle: the `candidates`, all of a smaller index, that are
    /// paired with `true`.
    #[inline]
    pub(crate) fn push(&mut self, candidates: impl IntoIterator<Item = (u32, bool)>) {
        let i = self.near.len();
        self.near.push([0; ROOM]);
        self.fill(i, candidates);
    }

    /// Appends the list of the next particle: those `found` of which `read` says that they are near
    /// and of a smaller index, and whose normals do not face away. `read` gives the cosine of the
    /// two normals, too.
    #[inline]
    pub(crate) fn list(&mut self, found: &[Neighbour], mut read: impl FnMut(&Neighbour) -> (bool, f32)) {
        let mut is_weighted = false;
        self.push(found.iter().map(|near| {
            let (is_near, cosine) = read(near);
            is_weighted |= is_near & (cosine < FULL_COSINE);
            (near.index, is_near & (cosine > LISTED_COSINE))
        }));
        if is_weighted {
            found.iter().for_each(|near| self.note_weighted(near.index as usize));
            self.note_weighted(self.near.len() - 1);
        }
    }

    /// Replaces the list of particle `i`, which must have no [far](Self::far) pairs, by the
    /// `candidates` that are paired with `true`.
    #[inline]
    pub(crate) fn fill(&mut self, i: usize, candidates: impl IntoIterator<Item = (u32, bool)>) {
        let mut list = [0; ROOM + 1];
        let mut len = 0;
        for (j, belongs) in candidates {
            let back = (i as u32).wrapping_sub(j);
            if belongs && (len == ROOM || back > u32::from(u16::MAX)) {
                push_gently(&mut self.far, [i as u32, j]);
                continue;
            }
            // The entry is written in any case: a branch is mispredicted for every other candidate.
            list[len] = back as u16;
            len += usize::from(belongs);
        }
        list[len] = 0;
        self.near[i].copy_from_slice(&list[..ROOM]);
    }

    /// Adds `j` to the list of particle `i`, unless it is in it. The two must not be a
    /// [far](Self::far) pair: a renewal drops those of `j` first.
    pub(crate) fn insert(&mut self, i: usize, j: u32) {
        let back = i as u32 - j;
        if let Ok(back) = u16::try_from(back) {
            let list = &mut self.near[i];
            if let Some(place) = list.iter().position(|&other| other == back || other == 0) {
                list[place] = back;
                return;
            }
        }
        push_gently(&mut self.far, [i as u32, j]);
    }

    /// Drops the far pairs of the particles that pass `is_renewed`.
    pub(crate) fn drop_far(&mut self, is_renewed: impl Fn(usize) -> bool) {
        self.far.retain(|pair| !pair.iter().any(|&i| is_renewed(i as usize)));
    }

    /// Returns the neighbours of particle `i` that have a smaller index, without those of far
    /// pairs.
    pub(crate) fn near(&self, i: usize) -> impl Iterator<Item = usize> {
        self.near[i].iter().take_while(|&&back| back != 0).map(move |&back| i - usize::from(back))
    }

    /// Returns the far pairs, as larger and smaller index.
    pub(crate) fn far(&self) -> &[[u32; 2]] {
        &self.far
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all_of(pairs: &PackedNeighbours, i: usize) -> Vec<usize> {
        let far = pairs.far().iter().filter(|pair| pair[0] as usize == i).map(|pair| pair[1] as usize);
        let mut all: Vec<usize> = pairs.near(i).chain(far).collect();
        all.sort_unstable();
        all
    }

    #[test]
    fn lists_hold_what_was_put_last() {
        // Farther back than 16 bits reach, and more neighbours than a list has room for.
        let first = 70_000;
        let mut pairs = PackedNeighbours::default();
        pairs.extend_to(first);
        for i in 0..40 {
            pairs.push((0..13).map(|k| (k * 1_741, k < i % 11)));
        }
        for round in 0..5 {
            let is_renewed = |i: usize| i >= first && i % 3 == round as usize % 3;
            pairs.drop_far(is_renewed);
            for i in (first..first + 40).filter(|&i| is_renewed(i)) {
                let list = (0..(i as u32 + round) % 12).map(|k| k * 1_741 + round);
                pairs.fill(i, list.clone().map(|j| (j, true)));
                let mut expected: Vec<usize> = list.map(|j| j as usize).collect();
                assert_eq!(all_of(&pairs, i), expected);
                pairs.insert(i, 69_000);
                expected.push(69_000);
                assert_eq!(all_of(&pairs, i), expected);
                if expected.len() <= 2 {
                    pairs.insert(i, 69_000);
                    assert_eq!(all_of(&pairs, i), expected);
                }
            }
        }
        assert_eq!(pairs.len(), first + 40);
        pairs.truncate(first);
        assert_eq!(pairs.far(), [[0; 2]; 0]);
    }
}
