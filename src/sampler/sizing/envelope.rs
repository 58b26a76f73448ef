//! The envelope of the radius: the largest function of limited slope that is not above given radii
//! at points of the surface.

use crate::math::{Bounds, SQRT_3};
use crate::sampler::discovery::grid::CELLS;
use glam::Vec3;

/// Largest number of passes forwards and backwards over the nodes. One would be enough on a full
/// grid; in a thin band of nodes the shortest path may turn back around a bend.
const ROUNDS: usize = 2;

/// A function on the nodes of a regular grid. Only the values at the nodes near the surface, the
/// *active* ones, have a meaning.
#[derive(Clone, Debug)]
pub(super) struct Envelope {
    /// Position of the first node.
    lo: Vec3,
    inverse_cell: f32,
    pub(super) cell: f32,
    /// Last position of the box that lies in a cell, in units of cells.
    last: Vec3,
    /// Number of nodes along each axis. The outermost nodes are never active, so an active node has
    /// all its neighbours.
    nodes: [usize; 3],
    value: Vec<f32>,
    /// Indices of the active nodes, in ascending order.
    active: Vec<u32>,
}

/// Cells of the grid beyond the box on each side: an active node lies within two cells of a point
/// in the box.
const MARGIN: usize = 2;

/// Distance of the last position in the box from its last node, in cells, so that it falls into the
/// last cell: far above the last digit of a coordinate of 37 cells in single precision.
const LAST_CELL: f32 = 1e-4;

impl Envelope {
    /// Makes the grid of a box, with as many cells as that of the survey, so that a cell that the
    /// surface meets holds some of its points. The nodes near the `points` are active.
    pub(super) fn new(bounds: &Bounds, points: impl Iterator<Item = Vec3>) -> Self {
        let size = (bounds.hi() - bounds.lo()).as_vec3();
        let cell = size.max_element() / CELLS as f32;
        let nodes = (size / cell).ceil().to_array().map(|c| (c as usize).max(1) + 2 * MARGIN + 1);
        let mut envelope = Self {
            lo: bounds.lo().as_vec3() - cell * MARGIN as f32,
            inverse_cell: 1.0 / cell,
            cell,
            last: Vec3::from_array(nodes.map(|n| (n - 1 - MARGIN) as f32)) - LAST_CELL,
            nodes,
            value: vec![0.0; nodes.iter().product()],
            active: Vec::new(),
        };
        let mut near = vec![false; envelope.value.len()];
        let [_, row, layer] = envelope.strides();
        for p in points {
            // These are the nodes of the cell that holds the point and of the cells around it.
            let (first, _) = envelope.locate(p);
            let start = first - 1 - row - layer;
            for corner in 0..64 {
                near[start + (corner & 3) + (corner >> 2 & 3) * row + (corner >> 4) * layer] = true;
            }
        }
        envelope.active.extend((0..near.len() as u32).filter(|&n| near[n as usize]));
        envelope
    }

    /// Returns the index steps from a node to the next one along each axis.
    fn strides(&self) -> [usize; 3] {
        [1, self.nodes[0], self.nodes[0] * self.nodes[1]]
    }

    /// Returns the first node of the cell that holds `p`, or of the nearest cell in the box, and
    /// the position in that cell, from 0 to 1 along each axis.
    fn locate(&self, p: Vec3) -> (usize, Vec3) {
        // NaN becomes the first position.
        let position = ((p - self.lo) * self.inverse_cell).max(Vec3::splat(MARGIN as f32)).min(self.last);
        let cell = position.to_array().map(|c| c as u32);
        let rest = position - Vec3::from_array(cell.map(|c| c as f32));
        let [x, y, z] = cell.map(|c| c as usize);
        let [_, row, layer] = self.strides();
        let first = x + y * row + z * layer;
        (first, rest)
    }

    /// Sets all nodes to one value.
    pub(super) fn fill(&mut self, value: f32) {
        self.value.fill(value);
    }

    /// Lowers the nodes of the cell around `p` to at most `radius` plus `slope` times their
    /// distance from `p`.
    pub(super) fn lower(&mut self, p: Vec3, radius: f32, slope: f32) {
        let (first, t) = self.locate(p);
        let [_, row, layer] = self.strides();
        for corner in 0..8 {
            let (i, j, k) = (corner & 1, corner >> 1 & 1, corner >> 2);
            let distance = (t - Vec3::new(i as f32, j as f32, k as f32)).length() * self.cell;
            let value = &mut self.value[first + i + j * row + k * layer];
            *value = value.min(radius + slope * distance);
        }
    }

    /// Lowers every active node to what the others allow at this slope, with distances along paths
    /// through active nodes.
    pub(super) fn spread(&mut self, slope: f32) {
        let steps = [1.0, core::f32::consts::SQRT_2, SQRT_3 as f32].map(|length| slope * length * self.cell);
        for _ in 0..ROUNDS {
            let mut lowered = false;
            for k in 0..self.active.len() {
                let n = self.active[k] as usize;
                lowered |= self.lower_node(n, steps, |distance| n - distance);
            }
            for k in (0..self.active.len()).rev() {
                let n = self.active[k] as usize;
                lowered |= self.lower_node(n, steps, |distance| n + distance);
            }
            if !lowered {
                break;
            }
        }
    }

    /// Lowers node `n` to what thirteen of its neighbours allow: those before it or those after it
    /// in the order of the nodes. `steps` are the rises to a neighbour across a face, an edge and a
    /// corner. Returns whether the node was lowered.
    fn lower_node(&mut self, n: usize, steps: [f32; 3], at: impl Fn(usize) -> usize) -> bool {
        let [_, row, layer] = self.strides();
        let least = |a: f32, b: f32| if b < a { b } else { a };
        let of = |distance: usize| self.value[at(distance)];
        let face = [row, layer].map(of).into_iter().fold(of(1), least);
        let edge = [row + 1, layer - 1, layer + 1, layer - row, layer + row]
            .map(of)
            .into_iter()
            .fold(of(row - 1), least);
        let corner = [layer - row + 1, layer + row - 1, layer + row + 1]
            .map(of)
            .into_iter()
            .fold(of(layer - row - 1), least);
        let value = least(least(face + steps[0], edge + steps[1]), corner + steps[2]);
        let lower = value < self.value[n];
        if lower {
            self.value[n] = value;
        }
        lower
    }

    /// Returns the function at `p` by trilinear interpolation.
    #[inline]
    pub(super) fn at(&self, p: Vec3) -> f32 {
        let (first, t) = self.locate(p);
        let [_, row, layer] = self.strides();
        let along_x = |offset: usize| {
            let ends = &self.value[first + offset..first + offset + 2];
            ends[0] + (ends[1] - ends[0]) * t.x
        };
        let along_y = |offset: usize| {
            let (a, b) = (along_x(offset), along_x(offset + row));
            a + (b - a) * t.y
        };
        let (a, b) = (along_y(0), along_y(layer));
        a + (b - a) * t.z
    }
}
