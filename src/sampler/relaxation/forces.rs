//! Sums of the pair forces over the neighbour lists.
//!
//! A list holds the neighbours of a smaller index, so a pair is met once and its force goes to both
//! particles. Each thread sums the forces on particles of its own; a pair of two threads is
//! evaluated by both. Every force is summed in the order of the lists, whatever the number of
//! threads.

use crate::math::refill;
use crate::particles::Particles;
use crate::sampler::neighbours::packed::{PackedNeighbours, ROOM};
use crate::sampler::relaxation::repulsion::Repulsion;
use crate::sampler::sheet::repulsion_weight;
use crate::slices;
use core::ops::Range;
use glam::{Mat4, Vec3, Vec4};

/// Particles whose pairs are evaluated in one batch: the pairs take 8 kB, a quarter of a small
/// first-level cache.
const BATCH_PARTICLES: usize = 32;
/// Largest number of pairs in a batch.
const MOST_PAIRS: usize = BATCH_PARTICLES * ROOM;

/// The pairs of a few particles, one particle after the other.
///
/// The pairs are collected first and evaluated four at a time, without a branch on the distance:
/// such a branch is mispredicted for every other pair.
#[derive(Clone, Debug)]
struct PairBatch {
    /// Position of the particle less that of its neighbour.
    offset: [Vec4; MOST_PAIRS],
    /// Mean radius of the pair; 1 where all radii are equal.
    mean: [f32; MOST_PAIRS],
    /// Force over offset.
    weight: [f32; MOST_PAIRS],
    energy: [f32; MOST_PAIRS],
    /// The neighbour, which has the smaller index.
    other: [u32; MOST_PAIRS],
}

impl Default for PairBatch {
    fn default() -> Self {
        Self {
            offset: [Vec4::ZERO; MOST_PAIRS],
            mean: [1.0; MOST_PAIRS],
            weight: [0.0; MOST_PAIRS],
            energy: [0.0; MOST_PAIRS],
            other: [0; MOST_PAIRS],
        }
    }
}

/// The force on every particle.
#[derive(Clone, Default)]
pub(super) struct Forces {
    /// Sum of `offset * weight` over the pairs of a particle, in x, y and z; w is 0. Four lanes are
    /// added in one instruction.
    force: Vec<Vec4>,
}

/// The particles of a thread and the forces on them.
struct Share<'a> {
    /// The first particle.
    first: usize,
    force: &'a mut [Vec4],
    /// The first particle whose pairs may act on them.
    from: usize,
}

impl Forces {
    /// Sets the forces on this many particles to zero.
    pub(super) fn reset(&mut self, particles: usize) {
        refill(&mut self.force, particles, Vec4::ZERO);
    }

    /// The force on particle `i`.
    pub(super) fn of(&self, i: usize) -> Vec3 {
        self.force[i].truncate()
    }

    /// Sets the forces on the particles of `range` to zero.
    pub(super) fn clear(&mut self, range: Range<usize>) {
        self.force[range].fill(Vec4::ZERO);
    }

    /// Adds the forces between the particles of `range` and their near neighbours to the forces on
    /// both, and the energies of these pairs to `energy`.
    pub(super) fn add_near<L: Repulsion>(
        &mut self,
        law: &L,
        pairs: &PackedNeighbours,
        particles: &Particles,
        range: Range<usize>,
        energy: &mut f64,
    ) {
        let mut shares = Vec::new();
        let (mut first, mut rest) = (0, &mut self.force[..range.end]);
        let batches = range.len().div_ceil(BATCH_PARTICLES);
        let size = batches.div_ceil(slices::threads()) * BATCH_PARTICLES;
        for from in range.clone().step_by(size.max(1)) {
            let end = range.end.min(from + size);
            let (force, others) = rest.split_at_mut(end - first);
            shares.push(Share { first, force, from });
            (first, rest) = (end, others);
        }
        let each: Vec<Range<usize>> = slices::ranges(shares.len(), 1).collect();
        let mut energies = Vec::with_capacity(each.len());
        let add = |share: &mut Share, _| share.add_near(law, pairs, particles, range.end);
        slices::share_out(&mut shares, &each, &add, &mut energies);
        for of_particle in energies.into_iter().flatten() {
            *energy += f64::from(of_particle);
        }
    }

    /// Adds the forces and the energies of the far pairs.
    pub(super) fn add_far<L: Repulsion>(
        &mut self,
        law: &L,
        pairs: &PackedNeighbours,
        particles: &Particles,
        energy: &mut f64,
    ) {
        for &[i, j] in pairs.far() {
            let (i, j) = (i as usize, j as usize);
            let offset = particles.local[i] - particles.local[j];
            let mean = 0.5 * (law.radius(particles, i) + law.radius(particles, j));
            let (weight, of_pair) = law.pairs(Vec4::splat(offset.length_squared()), Vec4::splat(mean));
            let share = repulsion_weight(particles.normal[i].dot(particles.normal[j]));
            let push = offset.extend(0.0) * (weight.x * share);
            self.force[i] += push;
            self.force[j] -= push;
            *energy += f64::from(of_pair.x * share);
        }
    }
}

impl Share<'_> {
    /// Adds the forces of all near pairs whose later particle is before `end`. Returns the energies
    /// of the pairs of each of its particles, in order.
    fn add_near<L: Repulsion>(
        &mut self,
        law: &L,
        pairs: &PackedNeighbours,
        particles: &Particles,
        end: usize,
    ) -> Vec<f32> {
        let own = self.first..self.first + self.force.len();
        let mut batch = PairBatch::default();
        let mut energies = Vec::with_capacity(own.end - self.from);
        for first in (self.from..end).step_by(BATCH_PARTICLES) {
            let range = first..end.min(first + BATCH_PARTICLES);
            let acts = |i: usize| pairs.near(i).any(|j| j < own.end);
            if first >= own.end && !range.clone().any(acts) {
                continue;
            }
            let ends = batch.collect::<L>(pairs, particles, range.clone());
            batch.evaluate(law, ends[range.len() - 1]);
            if pairs.any_weighted(&range) {
                batch.weigh(particles, range.clone(), &ends);
            }
            let mut first = 0;
            for (&end, i) in ends.iter().zip(range) {
                let mut force = Vec4::ZERO;
                let mut energy = 0.0;
                for k in first..end {
                    let k = k % MOST_PAIRS;
                    let push = batch.offset[k] * batch.weight[k];
                    force += push;
                    energy += batch.energy[k];
                    let other = (batch.other[k] as usize).wrapping_sub(own.start);
                    if let Some(other) = self.force.get_mut(other) {
                        *other -= push;
                    }
                }
                if i < own.end {
                    self.force[i - own.start] += force;
                    energies.push(energy);
                }
                first = end;
            }
        }
        energies
    }
}

impl PairBatch {
    /// Collects the near pairs of the particles of `range`. Returns, for each, the end of its pairs
    /// in the batch.
    fn collect<L: Repulsion>(
        &mut self,
        pairs: &PackedNeighbours,
        particles: &Particles,
        range: Range<usize>,
    ) -> [usize; BATCH_PARTICLES] {
        let mut count = 0;
        let mut ends = [0; BATCH_PARTICLES];
        for (end, i) in ends.iter_mut().zip(range) {
            let p = particles.local[i].extend(0.0);
            for j in pairs.near(i) {
                // A list holds at most ROOM neighbours, so the remainder is the count itself; it
                // spares the bounds checks.
                let k = count % MOST_PAIRS;
                self.offset[k] = p - particles.local[j].extend(0.0);
                self.other[k] = j as u32;
                if L::RESIZES {
                    self.mean[k] = 0.5 * (particles.radius[i] + particles.radius[j]);
                }
                count += 1;
            }
            *end = count;
        }
        ends
    }

    /// Evaluates the law for the first `count` pairs.
    fn evaluate<L: Repulsion>(&mut self, law: &L, count: usize) {
        for first in (0..MOST_PAIRS).step_by(4).take_while(|&first| first < count) {
            let [a, b, c, d] = [0, 1, 2, 3].map(|k| self.offset[first + k]);
            let lanes = Mat4::from_cols(a, b, c, d).transpose();
            let (x, y, z) = (lanes.x_axis, lanes.y_axis, lanes.z_axis);
            let mean = Vec4::from_slice(&self.mean[first..first + 4]);
            let (weight, energy) = law.pairs(x * x + y * y + z * z, mean);
            weight.write_to_slice(&mut self.weight[first..first + 4]);
            energy.write_to_slice(&mut self.energy[first..first + 4]);
        }
    }

    /// Multiplies the forces and energies by the weight of two normals.
    fn weigh(&mut self, particles: &Particles, range: Range<usize>, ends: &[usize; BATCH_PARTICLES]) {
        let mut first = 0;
        for (&end, i) in ends.iter().zip(range) {
            for k in first..end {
                let other = particles.normal[self.other[k] as usize];
                let share = repulsion_weight(particles.normal[i].dot(other));
                self.weight[k] *= share;
                self.energy[k] *= share;
            }
            first = end;
        }
    }
}
