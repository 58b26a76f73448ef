//! Sums of the pair forces over the neighbour lists.

use crate::math::refill;
use crate::particles::Particles;
use crate::sampler::neighbours::packed::{PackedNeighbours, ROOM};
use crate::sampler::relaxation::repulsion::Repulsion;
use crate::sampler::sheet::repulsion_weight;
use core::ops::Range;
use glam::{Mat4, Vec3, Vec4};

/// Particles whose pairs are evaluated in one batch: the pairs take 8 kB, a quarter of a small
/// first-level cache.
pub(super) const BATCH_PARTICLES: usize = 32;
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

/// The force on every particle.
#[derive(Clone)]
pub(super) struct Forces {
    /// Sum of `offset * weight` over the pairs of a particle, in x, y and z; w is 0. Four lanes are
    /// added in one instruction.
    force: Vec<Vec4>,
    batch: Box<PairBatch>,
}

impl Default for Forces {
    fn default() -> Self {
        let batch = PairBatch {
            offset: [Vec4::ZERO; MOST_PAIRS],
            mean: [1.0; MOST_PAIRS],
            weight: [0.0; MOST_PAIRS],
            energy: [0.0; MOST_PAIRS],
            other: [0; MOST_PAIRS],
        };
        Self { force: Vec::new(), batch: Box::new(batch) }
    }
}

impl Forces {
    /// Sets the forces on this many particles to zero.
    pub(super) fn reset(&mut self, particles: usize) {
        refill(&mut self.force, particles, Vec4::ZERO);
    }

    /// Returns the force on particle `i` and sets it to zero.
    pub(super) fn take(&mut self, i: usize) -> Vec3 {
        core::mem::take(&mut self.force[i]).truncate()
    }

    /// Adds the forces between the particles of `range`, at most [`BATCH_PARTICLES`], and their
    /// near neighbours to the forces on both, and the energies of these pairs to `energy`.
    pub(super) fn add_near<L: Repulsion>(
        &mut self,
        law: &L,
        pairs: &PackedNeighbours,
        particles: &Particles,
        range: Range<usize>,
        energy: &mut f64,
    ) {
        let batch = &mut *self.batch;
        let ends = batch.collect::<L>(pairs, particles, range.clone());
        batch.evaluate(law, ends[range.len() - 1]);
        if pairs.any_weighted(&range) {
            batch.weigh(particles, range.clone(), &ends);
        }
        let mut first = 0;
        for (&end, i) in ends.iter().zip(range) {
            let mut force = Vec4::ZERO;
            let mut sum = 0.0;
            for k in first..end {
                let k = k % MOST_PAIRS;
                let push = batch.offset[k] * batch.weight[k];
                force += push;
                self.force[batch.other[k] as usize] -= push;
                sum += batch.energy[k];
            }
            self.force[i] += force;
            *energy += f64::from(sum);
            first = end;
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
        let pairs = self.offset.as_chunks().0.iter().zip(self.mean.as_chunks().0);
        let results = self.weight.as_chunks_mut().0.iter_mut().zip(self.energy.as_chunks_mut().0);
        for ((&[a, b, c, d], &mean), (weight, energy)) in pairs.zip(results).take(count.div_ceil(4)) {
            let lanes = Mat4::from_cols(a, b, c, d).transpose();
            let (x, y, z) = (lanes.x_axis, lanes.y_axis, lanes.z_axis);
            let of_four = law.pairs(x * x + y * y + z * z, Vec4::from_array(mean));
            (*weight, *energy) = (of_four.0.to_array(), of_four.1.to_array());
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
