//! Surveys the box: points of the surface where fronts may begin, and the area around each.

use crate::paper::ImplicitSurface;
use glam::DVec3;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;

/// Cells of the grid along the longest side of the box, as in the sampler's survey. A component
/// smaller than a cell may be missed.
const CELLS: f64 = 32.0;

/// A point near the surface, which represents a part of it.
pub(super) struct SurfacePatch {
    pub(super) point: DVec3,
    /// Area of that part.
    pub(super) area: f64,
}

/// Points spread over the surface, in the order of the grid: one on each edge between nodes with f
/// of different sign.
///
/// The area follows from the edges by Cauchy's formula. Edges along an axis cross the surface once
/// per s² of projected area, where s is the spacing, so each crossing represents an area of
/// s²/(|n_x| + |n_y| + |n_z|).
pub(super) fn survey(surface: &mut ImplicitSurface) -> Vec<SurfacePatch> {
    let (lo, size) = (surface.bounds.lo(), surface.bounds.hi() - surface.bounds.lo());
    let cells = (size * (CELLS / size.max_element())).ceil();
    let step = size / cells;
    let nodes = cells.to_array().map(|count| count as usize + 1);
    let at = |[i, j, k]: [usize; 3]| lo + step * DVec3::new(i as f64, j as f64, k as f64);
    // In the order of the grid, x first.
    let strides = [1, nodes[0], nodes[0] * nodes[1]];
    let node = |index: usize| [index % nodes[0], index / strides[1] % nodes[1], index / strides[2]];
    let count: usize = nodes.iter().product();
    let values: Vec<f64> = (0..count).map(|index| surface.jet(at(node(index))).value).collect();
    let mut patches = Vec::new();
    for index in 0..count {
        for axis in 0..3 {
            let start = node(index);
            if start[axis] + 1 == nodes[axis] {
                continue;
            }
            let (a, b) = (values[index], values[index + strides[axis]]);
            if !(a.is_finite() && b.is_finite()) || (a <= 0.0) == (b <= 0.0) {
                continue;
            }
            let point = at(start).lerp(at(node(index + strides[axis])), a / (a - b));
            let gradient = surface.jet(point).gradient.abs();
            // The product of the other two spacings.
            let section = step.x * step.y * step.z / step[axis];
            let area = section * gradient.length() / (gradient.x + gradient.y + gradient.z);
            if area.is_finite() {
                patches.push(SurfacePatch { point, area });
            }
        }
    }
    patches
}

/// The points, beginning with one that `seed` chooses.
pub(super) fn shuffled(mut points: Vec<DVec3>, seed: u32) -> Vec<DVec3> {
    if !points.is_empty() {
        let random = Pcg32::seed_from_u64(u64::from(seed)).next_u64();
        let first = points.remove((random % points.len() as u64) as usize);
        points.insert(0, first);
    }
    points
}
