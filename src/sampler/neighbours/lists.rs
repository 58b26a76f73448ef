//! Renewal of neighbour lists (Verlet lists): which of them are stale, and how they are made anew.
//!
//! A list reaches farther than the repulsion, by a *skin*. It holds every neighbour in range until
//! its particle has travelled half of that skin; then it is *stale*. Stale lists are renewed for a
//! group of particles in one cell at a time, because these share most of their neighbours.

use crate::math::{larger, refill};
use crate::particles::Particles;
use crate::sampler::neighbours::constants::{CHUNK, FULL_COSINE, LISTED_COSINE};
use crate::sampler::neighbours::grids::{RadiusChains, RadiusRange};
use crate::sampler::neighbours::packed::PackedNeighbours;
use core::ops::Range;
use glam::{BVec4A, Vec4};

/// Largest number of particles whose lists are renewed together. It limits the candidates of a
/// list, and changes no particle.
const GROUP: usize = 32;

/// Distance that a particle has travelled since its list was made, or one of two marks beyond all
/// distances.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
struct Travel(f32);

impl Travel {
    const ZERO: Self = Self(0.0);
    /// The list is to be renewed.
    const STALE: Self = Self(f32::INFINITY);
    /// The list was made in the renewal under way.
    const RENEWED: Self = Self(f32::NEG_INFINITY);

    /// Whether the list stays as it is in the renewal under way.
    fn is_kept(self) -> bool {
        self.0.is_finite()
    }
}

/// The state of all neighbour lists, and the grid from which they are renewed.
#[derive(Clone, Default)]
pub(crate) struct NeighbourLists {
    /// Distance that each particle has travelled since its list was made.
    travel: Vec<Travel>,
    has_stale: bool,
    /// Numbers of the sheets of the particles, if only particles of the same one are listed.
    pub(crate) sheets: Vec<u32>,
    grid: RadiusChains,
    /// Two particles are listed if their distance is at most this share of the sum of their radii.
    share: f32,
    /// Largest distance that a particle can have travelled since it was put into the grid; infinite
    /// if none is in it.
    grid_travel: f32,
    /// Largest distance that a particle has travelled in the move under way.
    farthest: f32,
}

/// The neighbours of a group of particles.
#[derive(Default)]
pub(crate) struct GroupNeighbours {
    /// The neighbours of one particle of the group after the other, each of which is among its own.
    near: Vec<u32>,
    /// For each particle of the group the end of its neighbours.
    ends: Vec<usize>,
    /// All particles around the group, if one of them may repel one of the group with a weight
    /// below 1.
    weighted: Vec<u32>,
}

/// All particles around a group.
struct Around {
    /// Their indices, up to a multiple of [`CHUNK`].
    found: Vec<u32>,
    /// Their positions x, y, z, normals x, y, z and radii, by chunks.
    chunks: Vec<[[f32; CHUNK]; 7]>,
}

impl NeighbourLists {
    /// Takes the lists of this many particles as just made, and the grid as empty.
    pub(crate) fn reset(&mut self, particles: usize) {
        refill(&mut self.travel, particles, Travel::ZERO);
        self.has_stale = false;
        self.grid_travel = f32::INFINITY;
        self.farthest = 0.0;
    }

    /// Keeps the state of those particles that have a new row. Those that came after them have
    /// stale lists.
    pub(crate) fn keep(&mut self, rows: &[u32], none: u32) {
        let known = self.travel.len();
        self.has_stale |= rows.len() > known;
        self.travel.resize(rows.len(), Travel::STALE);
        let mut rows = rows.iter();
        self.travel.retain(|_| rows.next() != Some(&none));
        self.grid_travel = f32::INFINITY;
    }

    /// Marks all lists as stale.
    pub(crate) fn make_all_stale(&mut self) {
        self.has_stale = true;
        self.travel.fill(Travel::STALE);
    }

    /// Returns whether the list of particle `i` is stale.
    pub(crate) fn is_stale(&self, i: usize) -> bool {
        self.travel[i] == Travel::STALE
    }

    /// Returns whether any list is stale.
    pub(crate) fn has_stale(&self) -> bool {
        self.has_stale
    }

    /// Adds to the travelled distance of particle `i`, and marks its list as stale if that exceeds
    /// `limit`.
    ///
    /// `distance` is what it has moved; `more` is what the growth of its radius counts for.
    pub(crate) fn add_travel(&mut self, i: usize, distance: f32, more: f32, limit: f32) {
        self.farthest = larger(self.farthest, distance);
        let travelled = self.travel[i].0 + distance + more;
        let is_stale = travelled > limit;
        self.has_stale |= is_stale;
        self.travel[i] = if is_stale { Travel::STALE } else { Travel(travelled) };
    }

    /// Ends a move of all particles. Returns whether none can have left its cell of the grid by
    /// more than `slack`.
    pub(crate) fn end_move(&mut self, slack: f32) -> bool {
        self.grid_travel += core::mem::take(&mut self.farthest);
        self.grid_travel < slack
    }

    /// Empties the grid for this many particles. Those within `reach` mean radii will be listed,
    /// and before the grid is emptied again they may move by `slack` more.
    pub(crate) fn empty_grid(&mut self, radii: RadiusRange, reach: f32, slack: f32, particles: usize) {
        self.grid.reset(radii, reach + slack, particles);
        self.share = 0.5 * reach;
        self.grid_travel = 0.0;
    }

    /// Puts particle `i` into the grid.
    pub(crate) fn insert(&mut self, particles: &Particles, i: usize) {
        self.grid.insert(particles.local[i], particles.radius[i], i as u32);
    }

    /// Begins a renewal: drops the far pairs of stale lists.
    pub(crate) fn begin_renewal(&self, pairs: &mut PackedNeighbours) {
        pairs.drop_far(|i| self.is_stale(i));
    }

    /// Divides the particles of stale lists into groups, each in one cell: those of `range` and
    /// others in their cells. Their lists count as renewed.
    pub(crate) fn groups(&mut self, particles: &Particles, range: Range<usize>) -> Vec<Vec<u32>> {
        let mut groups = Vec::new();
        for i in range {
            if self.is_stale(i) {
                self.travel[i] = Travel::RENEWED;
                let (travel, p) = (&self.travel, particles.local[i]);
                let is_stale = |j: u32| travel[j as usize] == Travel::STALE;
                let others = self.grid.beside(&particles.local, p, particles.radius[i], is_stale);
                let group: Vec<u32> = core::iter::once(i as u32).chain(others.take(GROUP - 1)).collect();
                group.iter().for_each(|&j| self.travel[j as usize] = Travel::RENEWED);
                groups.push(group);
            }
        }
        groups
    }

    /// Finds the neighbours of the particles of a group: those of the same sheet within the reach.
    pub(crate) fn neighbours(&self, particles: &Particles, group: &[u32]) -> GroupNeighbours {
        let around = self.around(particles, group);
        let mut neighbours = GroupNeighbours::default();
        let mut is_weighted = false;
        for &i in group {
            is_weighted |= self.find(particles, &around, i as usize, &mut neighbours.near);
            neighbours.ends.push(neighbours.near.len());
        }
        if is_weighted {
            neighbours.weighted = around.found;
        }
        neighbours
    }

    /// Makes the lists of a group anew. A list holds neighbours of a smaller index; those of a
    /// larger one get the particle into their own lists.
    pub(crate) fn write(&self, pairs: &mut PackedNeighbours, group: &[u32], neighbours: &GroupNeighbours) {
        let mut first = 0;
        for (&i, &end) in group.iter().zip(&neighbours.ends) {
            let near = &neighbours.near[first..end];
            pairs.fill(i as usize, near.iter().map(|&j| (j, j < i)));
            for &j in near.iter().filter(|&&j| j > i) {
                // A list that is renewed too finds the particle itself.
                if self.travel[j as usize].is_kept() {
                    pairs.insert(j as usize, i);
                }
            }
            first = end;
        }
        // Other lists may hold the group from a time when the weight was 1.
        neighbours.weighted.iter().for_each(|&j| pairs.note_weighted(j as usize));
    }

    /// Ends a renewal: no list is stale.
    pub(crate) fn end_renewal(&mut self) {
        self.has_stale = false;
        for travel in &mut self.travel {
            *travel = if *travel > Travel::ZERO { *travel } else { Travel::ZERO };
        }
    }

    /// Collects all particles within the reach of a group.
    fn around(&self, particles: &Particles, group: &[u32]) -> Around {
        let positions = &particles.local;
        let first = positions[group[0] as usize];
        let (mut lo, mut hi, mut largest) = (first, first, 0.0_f32);
        for &i in group {
            let (p, radius) = (positions[i as usize], particles.radius[i as usize]);
            (lo, hi, largest) = (lo.min(p), hi.max(p), largest.max(radius));
        }
        let (share, travelled) = (self.share, self.grid_travel);
        let (low, high) = (lo.extend(0.0), hi.extend(0.0));
        let mut found = Vec::new();
        let mut count = 0;
        self.grid.visit(
            [lo, hi],
            |other| share * (largest + other) + travelled,
            |index| {
                let q = positions[index as usize].extend(0.0);
                let beyond = (low - q).max(q - high).max(Vec4::ZERO);
                let reach = share * (largest + particles.radius[index as usize]);
                if count == found.len() {
                    found.push(0);
                }
                // The index is written in any case: a branch is mispredicted for every other
                // particle.
                found[count] = index;
                count += usize::from(beyond.length_squared() <= reach * reach);
            },
        );
        found.truncate(count);
        let mut chunks = Vec::with_capacity(found.len().div_ceil(CHUNK));
        for chunk in found.chunks(CHUNK) {
            // Lanes without a particle are infinitely far away and have no normal and no radius.
            let (far, none) = ([f32::INFINITY; CHUNK], [0.0; CHUNK]);
            let mut columns = [far, far, far, none, none, none, none];
            for (lane, &j) in chunk.iter().enumerate() {
                let j = j as usize;
                let (q, n, radius) = (positions[j], particles.normal[j], particles.radius[j]);
                for (column, value) in columns.iter_mut().zip([q.x, q.y, q.z, n.x, n.y, n.z, radius]) {
                    column[lane] = value;
                }
            }
            chunks.push(columns);
        }
        found.resize(chunks.len() * CHUNK, 0);
        Around { found, chunks }
    }

    /// Appends the neighbours of a particle of a group, itself among them, to `near`. Says whether
    /// a particle within its reach may repel it with a weight below 1.
    #[inline]
    fn find(&self, particles: &Particles, around: &Around, i: usize, near: &mut Vec<u32>) -> bool {
        let (p, n, radius) = (particles.local[i], particles.normal[i], particles.radius[i]);
        let mut len = near.len();
        near.resize(len + around.found.len(), 0);
        let own = len;
        let mut weighted = BVec4A::FALSE;
        for (chunk, others) in around.chunks.iter().zip(around.found.chunks_exact(CHUNK)) {
            let [x, y, z, mx, my, mz, other] = chunk.map(Vec4::from_array);
            let (dx, dy, dz) = (x - p.x, y - p.y, z - p.z);
            let along = mx * n.x + my * n.y + mz * n.z;
            let reach = (other + radius) * self.share;
            let is_near = (dx * dx + dy * dy + dz * dz).cmple(reach * reach);
            weighted |= is_near & along.cmplt(Vec4::splat(FULL_COSINE));
            let mask = (is_near & along.cmpgt(Vec4::splat(LISTED_COSINE))).bitmask();
            // All four are written: a branch is mispredicted for every other particle.
            for (lane, &j) in others.iter().enumerate() {
                near[len] = j;
                len += (mask >> lane & 1) as usize;
            }
        }
        near.truncate(len);
        if let Some(sheet) = self.sheets.get(i) {
            let mut kept = own;
            for k in own..len {
                near[kept] = near[k];
                kept += usize::from(self.sheets[near[k] as usize] == *sheet);
            }
            near.truncate(kept);
        }
        weighted.any()
    }
}
