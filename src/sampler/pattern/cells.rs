//! The cells of the particles' tangent planes, and their way to the surface.

use super::{CELLS, Drawing, Ground, Random, SIDE, Spot};
use crate::differential::{Curvature, curvatures};
use crate::math::tangent_frame;
use crate::sampler::probe::{BATCH, Probe};
use core::f32::consts::SQRT_2;
use glam::Vec3;

/// Newton steps along a line. From a point of the tangent plane two or three are enough.
const STEPS: u32 = 8;
/// Smallest cosine of the angle between a line and the normal of the surface where it ends.
const LEAST_COSINE: f32 = 0.2;
/// Change of the normal from a particle of the front to the side of its square, at most, in
/// radians: more is not resolved by the front.
const BEND: f32 = 0.5;

/// A square cell of the tangent plane of a particle of the front.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Cell {
    pub(super) owner: u32,
    /// Column and row.
    at: [u16; 2],
    /// Number of times that the cells of the square were halved.
    pub(super) depth: u16,
}

/// A point of the tangent plane of a particle, in the directions of its tangent frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlanePoint {
    pub(super) owner: u32,
    pub(super) at: [f32; 2],
}

impl Cell {
    /// Halvings at most: to a thousandth of the first side. Columns and rows fit their numbers.
    pub(super) const DEEPEST: u16 = 12;

    pub(super) fn of_piece(piece: u32) -> Self {
        let (owner, cell) = (piece / CELLS, piece % CELLS);
        Self { owner, at: [(cell % SIDE) as u16, (cell / SIDE) as u16], depth: 0 }
    }

    /// The four cells that it consists of.
    pub(super) fn quarters(self) -> [Self; 4] {
        let [x, y] = self.at.map(|at| 2 * at);
        [[x, y], [x + 1, y], [x, y + 1], [x + 1, y + 1]].map(|at| Self { at, depth: self.depth + 1, ..self })
    }

    /// Its side, where half the side of the square is given.
    pub(super) fn side(self, half: f32) -> f32 {
        2.0 * half / (SIDE << self.depth) as f32
    }

    /// The largest distance of its points from the middle of the square.
    pub(super) fn farthest(self, half: f32) -> f32 {
        let far = self.point(half, [0.0; 2]).at.into_iter().zip(self.point(half, [1.0; 2]).at);
        far.map(|(a, b)| a.abs().max(b.abs()).powi(2)).sum::<f32>().sqrt()
    }

    fn point(self, half: f32, within: [f32; 2]) -> PlanePoint {
        let side = self.side(half);
        let at = [0, 1].map(|k| (f32::from(self.at[k]) + within[k]) * side - half);
        PlanePoint { owner: self.owner, at }
    }

    pub(super) fn middle(self, half: f32) -> PlanePoint {
        self.point(half, [0.5; 2])
    }

    pub(super) fn dart(self, half: f32, random: &mut Random) -> PlanePoint {
        let x = random.unit();
        self.point(half, [x, random.unit()])
    }
}

impl Drawing {
    /// A random point of a cell.
    pub(super) fn dart(&mut self, cell: Cell) -> PlanePoint {
        let half = self.half_side(cell.owner as usize);
        cell.dart(half, &mut self.random)
    }

    /// The middles of at most [`BATCH`] cells, on the surface.
    pub(super) fn land_middles(
        &self,
        ground: &Ground,
        probe: &mut Probe,
        cells: &[Cell],
    ) -> Vec<Option<Spot>> {
        let middle = |cell: &Cell| cell.middle(self.half_side(cell.owner as usize));
        let points: Vec<PlanePoint> = cells.iter().map(middle).collect();
        self.land(ground, probe, &points)
    }

    /// The distance from the middle of a cell on the surface within which all of the cell lies.
    pub(super) fn reach(&self, cell: Cell, middle: &Spot) -> f32 {
        let owner = cell.owner as usize;
        let half = self.half_side(owner);
        let flat = 0.5 * SQRT_2 * cell.side(half);
        let cosine = middle.normal.dot(self.front.normal[owner]);
        flat / (cosine - BEND * flat / half).max(LEAST_COSINE)
    }

    /// Projects at most [`BATCH`] points of tangent planes onto the surface along the normals of
    /// their owners. None where the line does not meet the surface near the plane.
    pub(super) fn land(
        &self,
        ground: &Ground,
        probe: &mut Probe,
        points: &[PlanePoint],
    ) -> Vec<Option<Spot>> {
        let mut spots = vec![None; points.len()];
        let mut order = [0_u16; BATCH];
        let order = &mut order[..points.len()];
        (0..).zip(order.iter_mut()).for_each(|(k, place)| *place = k);
        let patch_of = |k: u16| self.front.patch_of(points[k as usize].owner as usize);
        if !self.front.patch.is_empty() {
            order.sort_unstable_by_key(|&k| (patch_of(k), k));
        }
        for group in order.chunk_by(|&a, &b| patch_of(a) == patch_of(b)) {
            let probe = &mut probe.on(patch_of(group[0]));
            self.land_on_patch(ground, probe, points, group, &mut spots);
        }
        spots
    }

    fn land_on_patch(
        &self,
        ground: &Ground,
        probe: &mut Probe,
        points: &[PlanePoint],
        group: &[u16],
        spots: &mut [Option<Spot>],
    ) {
        let mut lines = [Line::default(); BATCH];
        for (line, &k) in lines.iter_mut().zip(group) {
            let PlanePoint { owner, at: [x, y] } = points[k as usize];
            let owner = owner as usize;
            let (place, normal) = (self.front.local[owner], self.front.normal[owner]);
            let (u, v) = tangent_frame(normal);
            *line = Line { place: place + u * x + v * y, along: normal, reach: self.half_side(owner), k };
        }
        let mut count = group.len();
        let mut places = [Vec3::ZERO; BATCH];
        let residual = ground.tolerance.residual;
        for _ in 0..STEPS {
            if count == 0 {
                break;
            }
            let places = &mut places[..count];
            places.iter_mut().zip(&lines).for_each(|(place, line)| *place = line.place);
            let (value, gradient) = probe.gradients(places);
            let mut kept = 0;
            for i in 0..count {
                let Line { k, along, .. } = lines[i];
                let (value, gradient) = (value[i], gradient[i]);
                let slope = gradient.length();
                let rise = gradient.dot(along);
                // False for NaN.
                if !(ground.tolerance.is_slope(slope) && rise > LEAST_COSINE * slope) {
                    continue;
                }
                if value.abs() <= residual * slope {
                    let patch = self.front.patch_of(points[k as usize].owner as usize);
                    let (position, normal) = (lines[i].place, gradient / slope);
                    spots[k as usize] = Some(Spot { position, normal, radius: ground.radius, patch });
                    continue;
                }
                let step = -value / rise;
                let left = lines[i].reach - step.abs();
                if left > 0.0 {
                    lines[kept] = Line { place: lines[i].place + along * step, reach: left, ..lines[i] };
                    kept += 1;
                }
            }
            count = kept;
        }
        self.measure_radii(ground, probe, group, spots);
    }

    /// Gives the spots of a patch their radii.
    fn measure_radii(&self, ground: &Ground, probe: &mut Probe, group: &[u16], spots: &mut [Option<Spot>]) {
        let mut radii = [ground.radius; BATCH];
        if let Some(sizing) = ground.sizing {
            let mut places = [Vec3::ZERO; BATCH];
            let mut count = 0;
            for spot in group.iter().filter_map(|&k| spots[k as usize].as_ref()) {
                places[count] = spot.position;
                count += 1;
            }
            let mut curvature = [Curvature::default(); BATCH];
            curvatures(probe.field, &places[..count], &mut curvature[..count]);
            probe.count(count as u64);
            sizing.radii(&places[..count], &curvature[..count], &mut radii[..count]);
        }
        let mut radius = radii.into_iter();
        for &k in group {
            if let Some(spot) = &mut spots[k as usize] {
                spot.radius = ground.scale * radius.next().unwrap_or(ground.radius);
            }
        }
    }

    /// Moves a spot onto the surface as closely as single precision allows.
    pub(super) fn polish(ground: &Ground, probe: &mut Probe, spot: &mut Spot) {
        /// From a spot within the tolerance one step leaves its square.
        const MOST: u32 = 2;
        let probe = &mut probe.on(spot.patch);
        for _ in 0..MOST {
            let (value, gradient) = probe.gradient(spot.position);
            let slope = gradient.length();
            if !ground.tolerance.is_slope(slope) {
                return;
            }
            spot.normal = gradient / slope;
            if value.abs() <= ground.finest * slope {
                return;
            }
            spot.position -= spot.normal * (value / slope);
        }
    }
}

/// A line along which a point goes to the surface.
#[derive(Clone, Copy, Default)]
struct Line {
    place: Vec3,
    along: Vec3,
    /// How much farther the point may go.
    reach: f32,
    k: u16,
}
