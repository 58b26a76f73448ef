//! The places that are taken by particles of a pattern.

use super::{Ground, Spot};
use crate::math::NONE;
use crate::particles::Particles;
use crate::sampler::neighbours::grids::{RadiusGrids, RadiusRange};
use crate::spatial::Neighbour;
use glam::Vec3;

/// Cosine between the normals of two points of different sheets, at most: beyond 120° two points
/// are never on two sides of an edge, but on two sides of a thin body.
const APART: f32 = -0.5;

/// The particles so far, by their places, and the factor on their radii.
#[derive(Default)]
pub(super) struct Taken {
    grid: RadiusGrids,
    found: Vec<Neighbour>,
    /// The particles around the place that is looked at, if it is one alone.
    around: Option<Around>,
    /// Factor on all radii, which shrink until the wanted number fits.
    pub(super) shrink: f32,
}

/// The particles around a place: their rows and positions.
struct Around {
    place: Vec3,
    /// Asked for at places within this distance, for radii up to the largest.
    distance: f32,
    largest: f32,
    list: Vec<(u32, Vec3)>,
}

impl Taken {
    /// Takes the places of these particles.
    pub(super) fn of(particles: &Particles, radii: RadiusRange) -> Self {
        let mut grid = RadiusGrids::default();
        grid.reset(radii, |radius| 2.0 * radius);
        let mut taken = Self { grid, shrink: 1.0, ..Self::default() };
        (0..particles.len()).for_each(|row| taken.enter(particles, row));
        taken
    }

    fn enter(&mut self, particles: &Particles, row: usize) {
        self.grid.insert(particles.local[row], particles.radius[row], row as u32);
        if let Some(around) = &mut self.around {
            around.list.push((row as u32, particles.local[row]));
        }
    }

    /// Makes it faster to ask for particles of a radius up to `largest` within `distance` of a
    /// place.
    pub(super) fn look_around(&mut self, place: Vec3, distance: f32, largest: f32) {
        self.grid.gather(place, |radius| distance + largest + radius, &mut self.found);
        let mut list = self.around.take().map_or_else(Vec::new, |around| around.list);
        list.clear();
        list.extend(self.found.iter().map(|near| (near.index, place + near.offset)));
        self.around = Some(Around { place, distance, largest, list });
    }

    /// Asks for any places from now on.
    pub(super) fn look_anywhere(&mut self) {
        self.around = None;
    }

    /// Adds a particle.
    pub(super) fn add(&mut self, particles: &mut Particles, spot: &Spot, level: u32) {
        let row = particles.len();
        particles.push_seed(spot.position, spot.normal, spot.radius, spot.patch);
        particles.level[row] = level;
        self.enter(particles, row);
    }

    /// The factor on all radii at which the particle that is nearest to touching one at a spot
    /// would touch it, if it is below `most`; infinity otherwise. With a `reach` it is an upper
    /// bound of that factor for all places within it. The search ends at a factor not above
    /// `enough`.
    pub(super) fn room(
        &mut self,
        ground: &Ground,
        particles: &Particles,
        spot: &Spot,
        reach: f32,
        [enough, most]: [f32; 2],
    ) -> f32 {
        self.room_without(ground, particles, (spot, reach), [enough, most], NONE)
    }

    /// [`Taken::room`] at the place of a particle, without itself, up to a factor of 1.
    pub(super) fn room_beside(&mut self, ground: &Ground, particles: &Particles, row: usize) -> f32 {
        let spot = Spot::of(particles, row);
        self.room_without(ground, particles, (&spot, 0.0), [0.0, 1.0], row as u32)
    }

    fn room_without(
        &mut self,
        ground: &Ground,
        particles: &Particles,
        (spot, reach): (&Spot, f32),
        [enough, most]: [f32; 2],
        but: u32,
    ) -> f32 {
        let Self { grid, found, around, .. } = self;
        let radius = spot.radius - ground.slope() * reach;
        let mut least = f32::INFINITY;
        let mut meet = |row: u32, offset: Vec3| {
            let j = row as usize;
            let touching = (offset.length() + reach) / (radius + particles.radius[j]);
            let is_nearer = touching < least && touching < most && row != but;
            if is_nearer && keeps_away(particles, spot, j) {
                least = touching;
            }
            least <= enough
        };
        // At a factor above 1 particles farther away count, too.
        let serves = |around: &&Around| {
            most <= 1.0
                && spot.radius <= around.largest
                && spot.position.distance_squared(around.place) <= around.distance * around.distance
        };
        if let Some(around) = around.as_ref().filter(serves) {
            let _ = around.list.iter().any(|&(row, place)| meet(row, place - spot.position));
        } else {
            grid.gather(spot.position, |largest| most * (spot.radius + largest), found);
            let _ = found.iter().any(|near| meet(near.index, near.offset));
        }
        least
    }

    /// The rows of the particles around one, up to its second neighbours.
    pub(super) fn around(&mut self, particles: &Particles, row: usize) -> impl Iterator<Item = usize> {
        let radius = particles.radius[row];
        self.grid.gather(particles.local[row], |largest| 2.0 * (radius + largest), &mut self.found);
        self.found.iter().map(|near| near.index as usize)
    }
}

/// Whether a particle keeps others away from a spot: straight through space, unless the two are on
/// two sides of a body.
fn keeps_away(particles: &Particles, spot: &Spot, j: usize) -> bool {
    spot.normal.dot(particles.normal[j]) > APART
}
