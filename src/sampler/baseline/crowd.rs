//! The particles of a baseline and the search among them.

use crate::math::tangent_frame;
use crate::spatial::{CellGrid, Neighbour};
use glam::Vec3;
use rand_core::Rng;
use rand_pcg::Pcg32;

/// Grid cells per mean reach of a particle: [`CellGrid::gather`] is fast for radii near 0.8 of a cell.
const CELL: f32 = 1.0 / 0.8;

/// A reach of more cells than this is searched through all particles instead: it belongs to a particle with few
/// neighbours, of which there are a few at a time.
const FARTHEST: f32 = 4.0;

/// A particle with what an iteration finds out about it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Particle {
    pub(super) position: Vec3,
    /// Unit outward normal: ∇f/|∇f| at the position.
    pub(super) normal: Vec3,
    /// Repulsion radius.
    pub(super) radius: f32,
    /// Signed first-order distance f/|∇f| from the surface.
    pub(super) height: f32,
    /// Sum of the forces of the neighbours.
    pub(super) force: Vec3,
    /// How much it is pressed: an energy, or a sum of overlaps.
    pub(super) load: f32,
    /// Σ |r|² E over its neighbours, for the change of the energy with the radius.
    pub(super) moment: f32,
    /// Way of the last iteration, in radii.
    pub(super) way: f32,
    /// |ṗ|/σ with Witkin and Heckbert, before it is limited.
    pub(super) speed: f32,
    /// Way since the radius was brought up to date with the curvature.
    pub(super) since: f32,
    /// Whether it is taken out at the end of the iteration.
    pub(super) dies: bool,
}

impl Particle {
    /// A particle at rest on the surface.
    pub(super) fn new(position: Vec3, normal: Vec3, radius: f32) -> Self {
        Self { position, normal, radius, ..Self::default() }
    }
}

/// The grid over the particles, as they were when it was filled.
#[derive(Clone)]
pub(super) struct Neighbourhood {
    grid: CellGrid,
    side: f32,
    found: Vec<Neighbour>,
}

impl Neighbourhood {
    pub(super) fn new() -> Self {
        Self { grid: CellGrid::new(1.0), side: 1.0, found: Vec::new() }
    }

    /// Empties the grid and fits its cells to the mean `reach` of the particles.
    pub(super) fn reset(&mut self, particles: &[Particle], reach: impl Fn(f32) -> f32) {
        let sum: f64 = particles.iter().map(|p| f64::from(reach(p.radius))).sum();
        let mean = (sum / particles.len() as f64) as f32;
        self.side = mean * CELL;
        self.grid.reset(self.side);
    }

    pub(super) fn insert(&mut self, particles: &[Particle], i: usize) {
        self.grid.insert(particles[i].position, i as u32);
    }

    /// The particles within `reach` of particle `i`, itself among them.
    pub(super) fn around(&mut self, particles: &[Particle], i: usize, reach: f32) -> &[Neighbour] {
        let centre = particles[i].position;
        if reach <= FARTHEST * self.side {
            self.grid.gather(centre, reach, &mut self.found);
        } else {
            self.found.clear();
            let all = particles.iter().enumerate().map(|(j, other)| {
                let offset = other.position - centre;
                Neighbour { index: j as u32, distance_sq: offset.length_squared(), offset }
            });
            self.found.extend(all.filter(|near| near.distance_sq <= reach * reach));
        }
        &self.found
    }
}

/// A number from 0 up to 1, without 1.
pub(super) fn uniform(random: &mut Pcg32) -> f32 {
    // The 24 bits that a number in single precision has room for.
    (random.next_u32() >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// A unit vector in the tangent plane, of any direction.
pub(super) fn tangent(normal: Vec3, random: &mut Pcg32) -> Vec3 {
    let (u, v) = tangent_frame(normal);
    // A place in the unit disc, by trial: four out of five are. That needs no sine.
    loop {
        let [a, b] = [0, 1].map(|_| 2.0 * uniform(random) - 1.0);
        let length_sq = a * a + b * b;
        if length_sq > 1e-4 && length_sq <= 1.0 {
            return (u * a + v * b) / length_sq.sqrt();
        }
    }
}
