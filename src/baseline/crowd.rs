//! The particles of a baseline and the search among them.

use crate::math::tangent_frame;
use crate::spatial::{CellGrid, Neighbour};
use glam::Vec3;
use rand_core::Rng;
use rand_pcg::Pcg32;

/// Side of a grid cell over the mean reach of a particle: an iteration takes 5 % fewer instructions than with 1.25 with Witkin and
/// Heckbert, 13 % fewer with forces. Up to 3.2 makes no difference to the first.
const CELL: f32 = 1.6;

/// A reach of more cells than this is searched through all particles instead: it belongs to a particle with few
/// neighbours, of which there are a few at a time.
const FARTHEST: f32 = 4.0;

/// A particle with what an iteration finds out about it.
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
    /// How much it is pressed: an energy, or a sum of overlaps.
    pub(crate) load: f32,
    /// Σ |r|² E over its neighbours, for the change of the energy with the radius.
    pub(crate) moment: f32,
    /// Way of the last iteration, in radii.
    pub(crate) way: f32,
    /// |ṗ|/σ with Witkin and Heckbert, before it is limited.
    pub(crate) speed: f32,
    /// Way since the radius was brought up to date with the curvature.
    pub(crate) since: f32,
    /// Whether it is taken out at the end of the iteration.
    pub(crate) dies: bool,
}

impl Particle {
    /// A particle at rest on the surface.
    pub(crate) fn new(position: Vec3, normal: Vec3, radius: f32) -> Self {
        Self { position, normal, radius, ..Self::default() }
    }
}

/// What a list reaches farther than its particle, in its reach: chosen by counting instructions of a whole run.
const SKIN: f32 = 0.12;

/// Where a particle was when its list was made, and how far that reaches.
#[derive(Clone, Copy, Debug)]
struct Listed {
    position: Vec3,
    reach: f32,
    /// End of its list; it begins where that of the particle before ends.
    end: u32,
}

/// The neighbours of all particles: from a grid, and from lists as long as these serve.
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

    /// Whether there are lists of these particles, and they hold all neighbours within the `reach` of each. Nobody may have divided or
    /// died since they were made.
    pub(crate) fn serves(&self, particles: &[Particle], reach: impl Fn(f32) -> f32) -> bool {
        let way = |(listed, particle): (&Listed, &Particle)| (particle.position - listed.position).length();
        let farthest = self.listed.iter().zip(particles).map(way).fold(0.0, f32::max);
        self.listed.len() == particles.len()
            && self.listed.iter().zip(particles).all(|(listed, particle)| {
                reach(particle.radius) + way((listed, particle)) + farthest <= listed.reach
            })
    }

    /// Empties the grid and fits its cells to the mean `reach` of the particles. Lists are made for longer than this iteration if
    /// they are `to_last`.
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

    /// The particles within `reach` of particle `i`, itself among them: from its list, else from the grid. Lists are made on the way,
    /// which asks for the particles in their order.
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

/// A number from 0 up to 1, without 1.
pub(crate) fn uniform(random: &mut Pcg32) -> f32 {
    // The 24 bits that a number in single precision has room for.
    (random.next_u32() >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// A unit vector in the tangent plane, of any direction.
pub(crate) fn tangent(normal: Vec3, random: &mut Pcg32) -> Vec3 {
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
