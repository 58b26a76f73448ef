//! The regular grid of the survey, and the values and gradients of the field at its nodes.

use crate::math::Bounds;
use crate::sampler::discovery::dips::End;
use crate::sampler::probe::{BATCH, Probe};
use glam::{DVec3, Vec3};

/// Grid cells along the longest side of the box. 32³ evaluations are a few per cent of a run with
/// 50,000 particles. Fewer: more components are left without a particle.
pub(crate) const CELLS: f64 = 32.0;
/// Grid cells along the longest side of the box for fields without bounds, whose surface only the
/// grid shows. It misses no sphere whose radius is at least 1.4 % of the box's longest side: half
/// the diagonal of a cell.
pub(crate) const DENSE_CELLS: u32 = 64;

/// The regular grid at whose nodes the field is evaluated.
pub(super) struct Grid {
    lo: DVec3,
    /// Distance between two nodes along each axis.
    pub(super) step: DVec3,
    /// Number of nodes along each axis.
    pub(super) nodes: [usize; 3],
    /// Wanted distance between two nodes; along the longest side of the box it is exact.
    pub(super) spacing: f64,
}

impl Grid {
    /// The grid over a box. A grid of `dense` cells has a whole number of blocks.
    pub(super) fn over(bounds: &Bounds, dense: Option<u32>) -> Self {
        let size = bounds.hi() - bounds.lo();
        let spacing = size.max_element() / dense.map_or(CELLS, f64::from);
        let block = if dense.is_some() { COARSEST as f64 } else { 1.0 };
        let cells = block * (size / (block * spacing)).ceil();
        let nodes = cells.to_array().map(|c| c as usize + 1);
        Self { lo: bounds.lo(), step: size / cells, nodes, spacing }
    }

    pub(super) fn node(&self, i: usize, j: usize, k: usize) -> Vec3 {
        (self.lo + self.step * DVec3::new(i as f64, j as f64, k as f64)).as_vec3()
    }

    /// Returns the number of nodes in a layer.
    fn layer(&self) -> usize {
        self.nodes[0] * self.nodes[1]
    }
}

/// The nodes of the grid that have one third coordinate.
pub(super) struct GridLayer {
    pub(super) value: Vec<f32>,
    gradient: Vec<Vec3>,
}

impl GridLayer {
    pub(super) fn new(grid: &Grid) -> Self {
        Self { value: vec![f32::NAN; grid.layer()], gradient: vec![Vec3::ZERO; grid.layer()] }
    }

    /// Evaluates the field at layer `k`, or takes it from a dense grid.
    pub(super) fn fill(&mut self, probe: &mut Probe, grid: &Grid, dense: Option<&Dense>, k: usize) {
        let count = grid.layer();
        if let Some(dense) = dense {
            let layer = k * count..(k + 1) * count;
            self.value.copy_from_slice(&dense.value[layer.clone()]);
            self.gradient.copy_from_slice(&dense.gradient[layer]);
            return;
        }
        let nx = grid.nodes[0];
        let mut points = Vec::with_capacity(BATCH);
        for first in (0..count).step_by(BATCH) {
            let last = (first + BATCH).min(count);
            points.clear();
            points.extend((first..last).map(|m| grid.node(m % nx, m / nx, k)));
            let (value, gradient) = probe.gradients(&points);
            self.value[first..last].copy_from_slice(value);
            self.gradient[first..last].copy_from_slice(gradient);
        }
    }

    /// Node (i, j) of layer `k`.
    pub(super) fn at(&self, grid: &Grid, [i, j, k]: [usize; 3]) -> End {
        let m = j * grid.nodes[0] + i;
        End { place: grid.node(i, j, k), value: self.value[m], gradient: self.gradient[m] }
    }
}

/// The nodes of a dense grid, evaluated only where the surface can be.
///
/// The box is cut into blocks of [`COARSEST`] grid cells to an edge, and those that may hold the
/// surface are halved until they are grid cells. In the others only the sign of f is known.
pub(super) struct Dense {
    value: Vec<f32>,
    gradient: Vec<Vec3>,
    /// Whether the node is a corner of a grid cell that may hold the surface.
    pub(super) is_near: Vec<bool>,
}

/// Grid cells along the edge of the first blocks of a dense grid: a power of two. Only the corners
/// of each block are evaluated, 64 times fewer than the nodes.
const COARSEST: usize = 4;
/// A block may hold the surface if at one of its corners |f| is at most the largest |∇f| at the
/// corners times this many diagonals. No point of a block is farther than half a diagonal from all
/// corners; between them |∇f| may be somewhat larger.
const REACH: f32 = 0.7;

impl Dense {
    pub(super) fn new(probe: &mut Probe, grid: &Grid) -> Self {
        let [nx, ny, nz] = grid.nodes;
        let index = |[i, j, k]: [usize; 3]| (k * ny + j) * nx + i;
        // The eight places at the corners of a cube.
        let eight = |[i, j, k]: [usize; 3], width: usize| {
            (0..8).map(move |c| [i + width * (c & 1), j + width * (c >> 1 & 1), k + width * (c >> 2)])
        };
        let nodes = nx * ny * nz;
        let mut dense = Self {
            value: vec![f32::NAN; nodes],
            gradient: vec![Vec3::ZERO; nodes],
            is_near: vec![false; nodes],
        };
        let mut is_known = vec![false; nodes];
        let mut wanted = Vec::new();
        let mut points = Vec::with_capacity(BATCH);
        let along = |n: usize| (0..n - 1).step_by(COARSEST);
        let mut blocks: Vec<[usize; 3]> =
            along(nz).flat_map(|k| along(ny).flat_map(move |j| along(nx).map(move |i| [i, j, k]))).collect();
        let mut width = COARSEST;
        loop {
            for corner in blocks.iter().flat_map(|&block| eight(block, width)) {
                if !core::mem::replace(&mut is_known[index(corner)], true) {
                    wanted.push(corner);
                }
                dense.is_near[index(corner)] = width == 1;
            }
            for chunk in wanted.chunks(BATCH) {
                points.clear();
                points.extend(chunk.iter().map(|&[i, j, k]| grid.node(i, j, k)));
                let (value, gradient) = probe.gradients(&points);
                for ((&corner, &value), &gradient) in chunk.iter().zip(value).zip(gradient) {
                    (dense.value[index(corner)], dense.gradient[index(corner)]) = (value, gradient);
                }
            }
            wanted.clear();
            if width == 1 {
                return dense;
            }
            let reach = REACH * width as f32 * grid.step.length() as f32;
            let mut halves = Vec::new();
            for block in blocks {
                let corners = || eight(block, width).map(index);
                let least = corners().fold(f32::INFINITY, |least, n| least.min(dense.value[n].abs()));
                let slope = corners().fold(0.0_f32, |most, n| most.max(dense.gradient[n].length()));
                let first = dense.value[index(block)];
                let differs = |n: usize| dense.value[n].is_nan() || (dense.value[n] <= 0.0) != (first <= 0.0);
                if least <= reach * slope || corners().any(differs) {
                    halves.extend(eight(block, width / 2));
                    continue;
                }
                let [i, j, k] = block;
                for row in (k..=k + width).flat_map(|k| (j..=j + width).map(move |j| [i, j, k])) {
                    for value in &mut dense.value[index(row)..=index(row) + width] {
                        // Any value of that sign.
                        *value = if value.is_nan() { first } else { *value };
                    }
                }
            }
            (blocks, width) = (halves, width / 2);
        }
    }
}

#[cfg(feature = "points")]
#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::model::MODELS;
    use crate::field::rbf::RbfField;
    use crate::field::{Field, Frame};
    use crate::pointcloud::fit_model;
    use crate::sampler::probe::ProbeMemory;

    #[test]
    fn a_dense_grid_tells_the_sign_at_every_node_and_the_value_near_the_surface() {
        for model in MODELS {
            let fit = fit_model(model);
            let field = RbfField::new(fit.data).expect("a field");
            let field = &mut *field.evaluator(Frame::default());
            let n = [65, 49, 57];
            let step = (fit.bounds.hi() - fit.bounds.lo()) / DVec3::new(64.0, 48.0, 56.0);
            let grid = Grid { lo: fit.bounds.lo(), step, nodes: n, spacing: step.max_element() };
            let dense = Dense::new(&mut Probe::new(field, &mut ProbeMemory::default()), &grid);
            let mut all = Vec::new();
            for k in 0..n[2] {
                for j in 0..n[1] {
                    all.extend((0..n[0]).map(|i| grid.node(i, j, k)));
                }
            }
            let mut value = vec![0.0; all.len()];
            field.values(&all, &mut value);
            let near = dense.is_near.iter().filter(|near| **near).count();
            assert!(near * 2 < all.len(), "{}: {near} of {} nodes are near", model.id, all.len());
            for (m, &exact) in value.iter().enumerate() {
                let told = dense.value[m];
                assert_eq!(told <= 0.0, exact <= 0.0, "{}: {told} for {exact} at {}", model.id, all[m]);
                assert!(!dense.is_near[m] || told == exact, "{}: {told} for {exact} at {}", model.id, all[m]);
            }
        }
    }
}
