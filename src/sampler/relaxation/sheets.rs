//! Numbers of the sheets that particles lie on, where sheets are too near for their normals to tell them apart.

use crate::math::Forest;
use crate::particles::Particles;
use crate::sampler::discovery::sheets::lift;
use crate::sampler::neighbours::packed::PackedNeighbours;

/// Returns a number for each particle, equal for those of one front, and of fronts that meet: that have two neighbours whose lift
/// is at most `largest_lift`.
pub(super) fn numbers(largest_lift: f32, particles: &Particles, neighbours: &PackedNeighbours) -> Vec<u32> {
    let mut number = particles.fronts();
    let mut met = Forest::new(number.len());
    let near = (0..neighbours.len()).flat_map(|i| neighbours.near(i).map(move |j| (i, j)));
    let far = neighbours.far().iter().map(|&[i, j]| (i as usize, j as usize));
    for (i, j) in near.chain(far).filter(|&(i, j)| number[i] != number[j]) {
        let (n, m) = (particles.normal[i], particles.normal[j]);
        let offset = particles.position[j] - particles.position[i];
        if n.dot(m) > 0.0 && lift(offset, n, m) <= largest_lift {
            met.join(number[i], number[j]);
        }
    }
    number.iter_mut().for_each(|front| *front = met.find(*front));
    number
}
