//! Neighbour lists made anew: for some of the particles of a cell at a time, which share most of their neighbours.

use crate::particles::Particles;
use crate::sampler::neighbours::constants::{FULL_COSINE, LISTED_COSINE};
use crate::sampler::neighbours::grids::RadiusChains;
use crate::sampler::neighbours::packed::PackedNeighbours;
use glam::{BVec4A, Vec4};

/// Most particles whose lists are made together.
const GROUP: usize = 32;

/// Particles in a chunk.
const CHUNK: usize = 4;

/// Where neighbours are looked for, and those found.
#[derive(Clone)]
pub(crate) struct NeighbourLists {
    grid: RadiusChains,
    /// Two particles within this share of the sum of their radii are listed.
    share: f32,
    /// The farthest that a particle can have gone since it was put into the grid.
    pub(crate) travelled: f32,
    /// Particles whose lists are made together.
    group: Vec<u32>,
    /// All around them, and their positions x, y, z, normals x, y, z and radii by chunks.
    found: Vec<u32>,
    chunks: Vec<[[f32; CHUNK]; 7]>,
    /// Neighbours of one of the group.
    near: Vec<u32>,
    /// Whether a particle within its reach may repel it less than in full.
    is_weighted: bool,
}

impl NeighbourLists {
    pub(crate) fn new() -> Self {
        Self {
            grid: RadiusChains::new(),
            share: 1.0,
            travelled: f32::INFINITY,
            group: Vec::new(),
            found: Vec::new(),
            chunks: Vec::new(),
            near: Vec::new(),
            is_weighted: false,
        }
    }

    /// Empties the grid for particles as they are now, with radii from `smallest` to `largest`: those within `reach` mean
    /// radii are to be listed, and until the next time they go up to `slack` more.
    pub(crate) fn reset(
        &mut self,
        (smallest, largest): (f32, f32),
        (reach, slack): (f32, f32),
        particles: usize,
    ) {
        self.grid.reset(smallest, largest, reach + slack, particles);
        self.share = 0.5 * reach;
        self.travelled = 0.0;
    }

    /// Puts particle `i` into the grid.
    pub(crate) fn insert(&mut self, particles: &Particles, i: usize) {
        self.grid.insert(particles.position[i], particles.radius[i], i as u32);
    }

    /// Makes anew the list of particle `i` and those of others in its cell whose `force` says so: those of its sheet and of a
    /// smaller index within the reach. Those of a larger index get it into their lists. Returns whose lists
    /// were made.
    pub(crate) fn make(
        &mut self,
        pairs: &mut PackedNeighbours,
        particles: &Particles,
        force: &mut [Vec4],
        i: usize,
    ) -> &[u32] {
        self.gather(particles, force, i);
        for k in 0..self.group.len() {
            let i = self.group[k];
            self.find(particles, i as usize);
            pairs.fill(i as usize, self.near.iter().map(|&j| (j, j < i)));
            if self.is_weighted {
                // In the lists of the others it may stand from when it repelled them in full.
                self.found.iter().for_each(|&j| pairs.note_weighted(j as usize));
            }
            for &j in self.near.iter().filter(|&&j| j > i) {
                // Those whose own lists are made anew find it themselves.
                if force[j as usize].w.is_finite() {
                    pairs.insert(j as usize, i);
                }
            }
            force[i as usize].w = f32::NEG_INFINITY;
        }
        &self.group
    }

    /// Forms the group, and collects all particles around it.
    fn gather(&mut self, particles: &Particles, force: &[Vec4], i: usize) {
        let positions = &particles.position;
        let p = positions[i];
        let (mut lo, mut hi, mut largest) = (p, p, particles.radius[i]);
        self.group.clear();
        self.group.push(i as u32);
        let others =
            self.grid.beside(positions, (p, largest), |j| j as usize != i && is_stale(force[j as usize]));
        for index in others.take(GROUP - 1) {
            let j = index as usize;
            self.group.push(index);
            (lo, hi) = (lo.min(positions[j]), hi.max(positions[j]));
            largest = largest.max(particles.radius[j]);
        }
        let (share, travelled, found) = (self.share, self.travelled, &mut self.found);
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
                // Written in any case: a branch would be mispredicted for every other one.
                found[count] = index;
                count += usize::from(beyond.length_squared() <= reach * reach);
            },
        );
        self.found.truncate(count);
        self.chunks.clear();
        for chunk in self.found.chunks(CHUNK) {
            // Lanes without a particle are infinitely far and have no normal and no radius.
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

    /// Finds the neighbours of particle `i` of the group, and itself, among those collected.
    #[inline]
    fn find(&mut self, particles: &Particles, i: usize) {
        let (p, n, radius) = (particles.position[i], particles.normal[i], particles.radius[i]);
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
            // All are written down: a branch would be mispredicted for every other one.
            for (lane, &j) in others.iter().enumerate() {
                self.near[len] = j;
                len += (mask >> lane & 1) as usize;
            }
        }
        self.near.truncate(len);
        self.is_weighted = weighted.any();
    }
}

/// Whether the list of a particle with this force is to be made anew.
pub(crate) fn is_stale(force: Vec4) -> bool {
    force.w == f32::INFINITY
}
