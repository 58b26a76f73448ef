//! A first look at the box: points of the surface at which fronts may begin, and the area that each stands for.

use crate::paper::ImplicitSurface;
use glam::DVec3;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;

/// Cells of the grid along the longest side of the box. A component smaller than a cell may be missed.
const CELLS: f64 = 32.0;

/// A point near the surface, and the part of the surface around it.
pub(super) struct SurfacePatch {
    pub(super) point: DVec3,
    /// Area of that part.
    pub(super) area: f64,
}

/// Points spread over the surface, in the order of a grid. Every edge of the grid at whose ends f differs in sign gives one.
///
/// The area follows from the edges by Cauchy's formula: an edge along an axis crosses the surface once in s² of projected area,
/// where s is the spacing, so each crossing stands for s²/(|n_x| + |n_y| + |n_z|) of true area.
pub(super) fn survey(surface: &mut ImplicitSurface) -> Vec<SurfacePatch> {
    let (lo, size) = (surface.bounds.lo(), surface.bounds.hi() - surface.bounds.lo());
    let cells = (size * (CELLS / size.max_element())).ceil();
    let step = size / cells;
    let nodes = cells.to_array().map(|count| count as usize + 1);
    let at = |[i, j, k]: [usize; 3]| lo + step * DVec3::new(i as f64, j as f64, k as f64);
    let index = |[i, j, k]: [usize; 3]| (k * nodes[1] + j) * nodes[0] + i;
    let mut values = Vec::with_capacity(nodes.iter().product());
    for k in 0..nodes[2] {
        for j in 0..nodes[1] {
            values.extend((0..nodes[0]).map(|i| surface.sample(at([i, j, k])).value));
        }
    }
    let mut patches = Vec::new();
    for k in 0..nodes[2] {
        for j in 0..nodes[1] {
            for i in 0..nodes[0] {
                for axis in 0..3 {
                    let mut end = [i, j, k];
                    end[axis] += 1;
                    if end[axis] == nodes[axis] {
                        continue;
                    }
                    let (a, b) = (values[index([i, j, k])], values[index(end)]);
                    if !(a.is_finite() && b.is_finite()) || (a <= 0.0) == (b <= 0.0) {
                        continue;
                    }
                    let point = at([i, j, k]).lerp(at(end), a / (a - b));
                    let gradient = surface.sample(point).gradient.abs();
                    // The other two spacings.
                    let section = step.x * step.y * step.z / step[axis];
                    let area = section * gradient.length() / (gradient.x + gradient.y + gradient.z);
                    if area.is_finite() {
                        patches.push(SurfacePatch { point, area });
                    }
                }
            }
        }
    }
    patches
}

/// The points with one first that `seed` chooses.
pub(super) fn shuffled(mut points: Vec<DVec3>, seed: u32) -> Vec<DVec3> {
    if !points.is_empty() {
        let random = Pcg32::seed_from_u64(u64::from(seed)).next_u64();
        let first = points.remove((random % points.len() as u64) as usize);
        points.insert(0, first);
    }
    points
}
