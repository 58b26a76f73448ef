//! The particles of a baseline, and the neighbour search among them.

use crate::math::tangent_frame;
use crate::spatial::{CellGrid, Neighbour};
use glam::Vec3;
use rand_core::Rng;
use rand_pcg::Pcg32;

/// Side of a grid cell over the mean reach of a particle. Compared with 1.25 an iteration takes 5 % fewer instructions
/// with Witkin and Heckbert's scheme and 13 % fewer with forces. Values up to 3.2 make no difference to the former.
const CELL: f32 = 1.6;

/// Reach, in cells, beyond which all particles are searched instead of the grid. Only a few particles at a time, which
/// have few neighbours, reach so far.
const FARTHEST: f32 = 4.0;

/// A particle, and what an iteration computes for it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Particle {
    pub(crate) position: Vec3,
    /// Unit outward normal: ∇f/|∇f| at the position.
    pub(crate) normal: Vec3,
    /// Repulsion radius.
    pub(crate) radius: f32,
    /// Signed first-order distance f/|∇f| from the surface.
    pub(crate) height: f32,
    /// Sum of the forces of the neighbours.
    pub(crate) force: Vec3,
    /// Measure of its compression: an energy, or a sum of squared overlaps.
    pub(crate) load: f32,
    /// Σ |r|² E over its neighbours, from which follows how the energy changes with the radius.
    pub(crate) moment: f32,
    /// Distance that it has moved in the last iteration, in radii.
    pub(crate) moved: f32,
    /// |ṗ|/σ with Witkin and Heckbert's scheme, before the limit on moves.
    pub(crate) speed: f32,
    /// Distance that it has travelled since its radius was brought up to date with the curvature.
    pub(crate) radius_travel: f32,
    /// Whether it is removed at the end of the iteration.
    pub(crate) dies: bool,
}

impl Particle {
    /// Returns a particle at rest on the surface.
    pub(crate) fn new(position: Vec3, normal: Vec3, radius: f32) -> Self {
        Self { position, normal, radius, ..Self::default() }
    }
}

/// Verlet skin of the lists, as a share of the reach. Instruction counts of a whole run have chosen it.
const SKIN: f32 = 0.12;

/// The position of a particle when its list was made, and the reach of the list.
#[derive(Clone, Copy, Debug)]
struct Listed {
    position: Vec3,
    reach: f32,
    /// End of the list, which begins where that of the particle before ends.
    end: u32,
}

/// Neighbour search by a grid, and by lists as long as these hold all neighbours.
#[derive(Clone)]
pub(crate) struct Neighbourhood {
    grid: CellGrid,
    side: f32,
    skin: f32,
    found: Vec<Neighbour>,
    listed: Vec<Listed>,
    lists: Vec<u32>,
}

impl Neighbourhood {
    pub(crate) fn new() -> Self {
        Self {
            grid: CellGrid::new(1.0),
            side: 1.0,
            skin: 0.0,
            found: Vec::new(),
            listed: Vec::new(),
            lists: Vec::new(),
        }
    }

    /// Returns whether there are lists of these particles and they hold all neighbours within the `reach` of each. No
    /// particle may have divided or died since they were made.
    pub(crate) fn serves(&self, particles: &[Particle], reach: impl Fn(f32) -> f32) -> bool {
        let moved = |(listed, particle): (&Listed, &Particle)| (particle.position - listed.position).length();
        let farthest = self.listed.iter().zip(particles).map(moved).fold(0.0, f32::max);
        self.listed.len() == particles.len()
            && self.listed.iter().zip(particles).all(|(listed, particle)| {
                reach(particle.radius) + moved((listed, particle)) + farthest <= listed.reach
            })
    }

    /// Empties the grid and fits its cells to the mean `reach` of the particles. With `to_last`, lists are made that
    /// serve for more than this iteration.
    pub(crate) fn reset(&mut self, particles: &[Particle], reach: impl Fn(f32) -> f32, to_last: bool) {
        let sum: f64 = particles.iter().map(|p| f64::from(reach(p.radius))).sum();
        let mean = (sum / particles.len() as f64) as f32;
        self.side = mean * CELL;
        self.grid.reset(self.side);
        self.listed.clear();
        self.lists.clear();
        self.skin = if to_last { SKIN } else { 0.0 };
    }

    pub(crate) fn insert(&mut self, particles: &[Particle], i: usize) {
        self.grid.insert(particles[i].position, i as u32);
    }

    /// Returns the particles within `reach` of particle `i`, itself among them, from its list or else from the grid.
    /// Lists are made at the same time, so particles must be queried in their order.
    pub(crate) fn around(&mut self, particles: &[Particle], i: usize, reach: f32) -> &[Neighbour] {
        let centre = particles[i].position;
        if let Some(listed) = self.listed.get(i) {
            let first = if i == 0 { 0 } else { self.listed[i - 1].end };
            let list = &self.lists[first as usize..listed.end as usize];
            self.found.clear();
            self.found.extend(list.iter().map(|&j| neighbour(particles, centre, j)));
        } else {
            let wide = reach * (1.0 + self.skin);
            if wide <= FARTHEST * self.side {
                self.grid.gather(centre, wide, &mut self.found);
            } else {
                self.found.clear();
                let all = (0..particles.len() as u32).map(|j| neighbour(particles, centre, j));
                self.found.extend(all.filter(|near| near.distance_sq <= wide * wide));
            }
            if self.skin > 0.0 {
                self.lists.extend(self.found.iter().map(|near| near.index));
                self.listed.push(Listed { position: centre, reach: wide, end: self.lists.len() as u32 });
            }
        }
        self.found.retain(|near| near.distance_sq <= reach * reach);
        &self.found
    }
}

fn neighbour(particles: &[Particle], centre: Vec3, index: u32) -> Neighbour {
    let offset = particles[index as usize].position - centre;
    Neighbour { index, distance_sq: offset.length_squared(), offset }
}

/// Returns a random number in [0, 1).
pub(crate) fn uniform(random: &mut Pcg32) -> f32 {
    // A number in single precision has 24 bits.
    (random.next_u32() >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// Returns a random unit vector in the tangent plane.
pub(crate) fn tangent(normal: Vec3, random: &mut Pcg32) -> Vec3 {
    let (u, v) = tangent_frame(normal);
    // A random point of the square is in the unit disc in four of five trials. This needs no sine.
    loop {
        let [a, b] = [0, 1].map(|_| 2.0 * uniform(random) - 1.0);
        let length_sq = a * a + b * b;
        if length_sq > 1e-4 && length_sq <= 1.0 {
            return (u * a + v * b) / length_sq.sqrt();
        }
    }
}
