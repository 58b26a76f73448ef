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
    /// Particles whose lists are made together.
    group: Vec<u32>,
    /// All particles around the group.
    found: Vec<u32>,
    /// Positions x, y, z, normals x, y, z and radii of the particles in `found`, by chunks.
    chunks: Vec<[[f32; CHUNK]; 7]>,
    /// Neighbours of one particle of the group.
    near: Vec<u32>,
    /// Whether a particle within its reach may repel it with a weight below 1.
    is_weighted: bool,
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

    /// Renews the list of particle `i` and other stale lists in its cell. Returns the particles
    /// whose lists were renewed.
    ///
    /// A list holds the particles of the same sheet and of a smaller index within the reach.
    /// Particles of a larger index get `i` into their own lists.
    pub(crate) fn renew(&mut self, pairs: &mut PackedNeighbours, particles: &Particles, i: usize) -> &[u32] {
        self.gather(particles, i);
        for k in 0..self.group.len() {
            let i = self.group[k];
            self.find(particles, i as usize);
            pairs.fill(i as usize, self.near.iter().map(|&j| (j, j < i)));
            if self.is_weighted {
                // The other lists may hold this particle from a time when the weight was 1.
                self.found.iter().for_each(|&j| pairs.note_weighted(j as usize));
            }
            for &j in self.near.iter().filter(|&&j| j > i) {
                // A list that is renewed too finds the particle itself.
                if self.travel[j as usize].is_kept() {
                    pairs.insert(j as usize, i);
                }
            }
            self.travel[i as usize] = Travel::RENEWED;
        }
        &self.group
    }

    /// Ends a renewal: no list is stale.
    pub(crate) fn end_renewal(&mut self) {
        self.has_stale = false;
        for travel in &mut self.travel {
            *travel = if *travel > Travel::ZERO { *travel } else { Travel::ZERO };
        }
    }

    /// Forms the group around particle `i`, and collects all particles near it.
    fn gather(&mut self, particles: &Particles, i: usize) {
        let positions = &particles.local;
        let p = positions[i];
        let (mut lo, mut hi, mut largest) = (p, p, particles.radius[i]);
        self.group.clear();
        self.group.push(i as u32);
        let travel = &self.travel;
        let is_other = |j: u32| j as usize != i && travel[j as usize] == Travel::STALE;
        let others = self.grid.beside(positions, p, largest, is_other);
        for index in others.take(GROUP - 1) {
            let j = index as usize;
            self.group.push(index);
            (lo, hi) = (lo.min(positions[j]), hi.max(positions[j]));
            largest = largest.max(particles.radius[j]);
        }
        let (share, travelled, found) = (self.share, self.grid_travel, &mut self.found);
        let (low, high) = (lo.extend(0.0), hi.extend(0.0));
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
        self.found.truncate(count);
        self.chunks.clear();
        for chunk in self.found.chunks(CHUNK) {
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
            self.chunks.push(columns);
        }
        self.found.resize(self.chunks.len() * CHUNK, 0);
    }

    /// Finds the neighbours of particle `i` of the group, itself among them, in what
    /// [`Self::gather`] has collected.
    #[inline]
    fn find(&mut self, particles: &Particles, i: usize) {
        let (p, n, radius) = (particles.local[i], particles.normal[i], particles.radius[i]);
        self.near.resize(self.found.len(), 0);
        let mut len = 0;
        let mut weighted = BVec4A::FALSE;
        for (chunk, others) in self.chunks.iter().zip(self.found.chunks_exact(CHUNK)) {
            let [x, y, z, mx, my, mz, other] = chunk.map(Vec4::from_array);
            let (dx, dy, dz) = (x - p.x, y - p.y, z - p.z);
            let along = mx * n.x + my * n.y + mz * n.z;
            let reach = (other + radius) * self.share;
            let is_near = (dx * dx + dy * dy + dz * dz).cmple(reach * reach);
            weighted |= is_near & along.cmplt(Vec4::splat(FULL_COSINE));
            let mask = (is_near & along.cmpgt(Vec4::splat(LISTED_COSINE))).bitmask();
            // All four are written: a branch is mispredicted for every other particle.
            for (lane, &j) in others.iter().enumerate() {
                self.near[len] = j;
                len += (mask >> lane & 1) as usize;
            }
        }
        self.near.truncate(len);
        if let Some(&own) = self.sheets.get(i) {
            let sheets = &self.sheets;
            self.near.retain(|&j| sheets[j as usize] == own);
        }
        self.is_weighted = weighted.any();
    }
}
