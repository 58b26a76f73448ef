//! A grid of values, and the points of the surface on its edges.

use super::sampled::{Bracket, Sampled};
use crate::math::{Bounds, NONE};
use crate::slices::{HEAVY, pause};
use glam::DVec3;

/// A node, by its number along each axis.
type Node = [usize; 3];

/// Distance from the first node to the box, in cells. These numbers are no simple fractions, so
/// that the faces of a typical solid do not lie on nodes.
const SHIFT: DVec3 = DVec3::new(1.381_966, 1.430_519, 1.302_776);
/// Cells that are sampled beyond the box.
const BEYOND: f64 = 1.5;
/// Largest |f| at a corner of a coarse cell through which the surface may pass, as a share of the
/// difference of the values there.
const NEAR: f64 = 0.5;
/// Maximum number of evaluations that find the zero of f on an edge of the grid.
const STEPS: u32 = 24;
/// A point is on the surface when it moves less than this share of a cell.
const AT_REST: f64 = 1e-12;

/// Values of f at the nodes of a grid; NaN in cells through which the surface cannot pass.
pub(super) struct Grid {
    lo: DVec3,
    /// The side of a cell.
    side: f64,
    /// Number of nodes along each axis.
    count: Node,
    values: Vec<f64>,
}

impl Grid {
    /// Samples a box with cells of this width.
    pub(super) async fn sample(f: &Sampled<'_>, bounds: &Bounds, width: f64) -> Self {
        let cells = (bounds.size() / width + SHIFT + BEYOND).ceil();
        // An even number of cells: two of them make a coarse one.
        let count = cells.to_array().map(|cells| 2 * (0.5 * cells).ceil() as usize + 1);
        let mut grid = Self {
            lo: bounds.lo() - width * SHIFT,
            side: width,
            count,
            values: vec![f64::NAN; count.into_iter().product()],
        };
        let mut coarse = Vec::new();
        for z in (0..count[2]).step_by(2) {
            for y in (0..count[1]).step_by(2) {
                coarse.extend((0..count[0]).step_by(2).map(|x| [x, y, z]));
            }
        }
        grid.fill(f, &coarse).await;
        let mut wanted: Vec<usize> = Vec::new();
        for &node in &coarse {
            if grid.has(beyond(node, [2; 3])) && grid.may_be_passed(node) {
                wanted.extend((0..27).map(|k| grid.index(beyond(node, [k % 3, k / 3 % 3, k / 9]))));
            }
        }
        wanted.sort_unstable();
        wanted.dedup();
        wanted.retain(|&index| grid.values[index].is_nan());
        let wanted: Vec<Node> = wanted.into_iter().map(|index| grid.node(index)).collect();
        grid.fill(f, &wanted).await;
        grid
    }

    async fn fill(&mut self, f: &Sampled<'_>, nodes: &[Node]) {
        let mut values = Vec::new();
        for nodes in nodes.chunks(8 * HEAVY) {
            pause().await;
            let places: Vec<DVec3> = nodes.iter().map(|&node| self.place(node)).collect();
            values.resize(places.len(), 0.0);
            f.field.values(&places, &mut values);
            for (&node, &value) in nodes.iter().zip(&values) {
                let index = self.index(node);
                self.values[index] = value;
            }
        }
    }

    fn has(&self, node: Node) -> bool {
        node.iter().zip(self.count).all(|(&k, count)| k < count)
    }

    fn index(&self, node: Node) -> usize {
        (node[2] * self.count[1] + node[1]) * self.count[0] + node[0]
    }

    fn node(&self, index: usize) -> Node {
        let (row, x) = (index / self.count[0], index % self.count[0]);
        [x, row % self.count[1], row / self.count[1]]
    }

    fn place(&self, node: Node) -> DVec3 {
        self.lo + self.side * DVec3::from_array(node.map(|k| k as f64))
    }

    /// Whether the surface may pass through the coarse cell with this first node.
    fn may_be_passed(&self, node: Node) -> bool {
        let corner =
            |k: usize| self.values[self.index(beyond(node, [0, 1, 2].map(|axis| k >> axis << 1 & 2)))];
        let (mut least, mut most, mut nearest) = (f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY);
        for value in (0..8).map(corner) {
            least = least.min(value);
            most = most.max(value);
            nearest = nearest.min(value.abs());
        }
        nearest <= NEAR * (most - least)
    }

    /// The points of the surface on the edges of the grid, and for each edge the number of its
    /// point: those of node n begin at 3n.
    pub(super) async fn points(&self, f: &Sampled<'_>) -> (Vec<DVec3>, Vec<u32>) {
        let mut edges = Vec::new();
        for index in 0..self.values.len() {
            let node = self.node(index);
            for axis in 0..3 {
                let next = beyond(node, unit(axis));
                if self.has(next) {
                    let ends = [self.values[index], self.values[self.index(next)]];
                    // NaN is on no side.
                    if ends[0] < 0.0 && ends[1] >= 0.0 || ends[0] >= 0.0 && ends[1] < 0.0 {
                        edges.push((3 * index + axis, ends));
                    }
                }
            }
        }
        let (mut points, mut of_edge) = (Vec::new(), vec![NONE; 3 * self.values.len()]);
        for edges in edges.chunks(HEAVY) {
            pause().await;
            for (&(edge, _), p) in edges.iter().zip(self.zeros(f, edges)) {
                of_edge[edge] = points.len() as u32;
                points.push(p);
            }
        }
        (points, of_edge)
    }

    /// The zeros of f on edges of the grid, each given with the values at its ends.
    fn zeros(&self, f: &Sampled<'_>, edges: &[(usize, [f64; 2])]) -> Vec<DVec3> {
        let mut open: Vec<usize> = (0..edges.len()).collect();
        let mut brackets: Vec<Bracket> =
            edges.iter().map(|&(_, values)| Bracket::new([0.0, 1.0], values)).collect();
        let mut roots = vec![0.5; edges.len()];
        let place = |k: usize, share: f64| {
            let (edge, _) = edges[k];
            self.place(self.node(edge / 3)) + DVec3::AXES[edge % 3] * (share * self.side)
        };
        let (mut places, mut values) = (Vec::new(), Vec::new());
        for _ in 0..STEPS {
            if open.is_empty() {
                break;
            }
            open.iter().for_each(|&k| roots[k] = brackets[k].root());
            places.clear();
            places.extend(open.iter().map(|&k| place(k, roots[k])));
            values.resize(places.len(), 0.0);
            f.field.values(&places, &mut values);
            let mut values = values.iter();
            open.retain(|&k| {
                let value = *values.next().expect("a value for each place");
                let moved = brackets[k].narrow(roots[k], value);
                moved > AT_REST && brackets[k].width() > AT_REST
            });
        }
        (0..edges.len()).map(|k| place(k, roots[k])).collect()
    }

    /// Pairs of edges between which the surface passes through a face of a cell.
    pub(super) fn links(&self, f: &Sampled<'_>) -> Vec<[usize; 2]> {
        let mut links = Vec::new();
        for index in 0..self.values.len() {
            let node = self.node(index);
            for [a, b] in [[0, 1], [0, 2], [1, 2]] {
                let [right, up] = [unit(a), unit(b)];
                let across = beyond(beyond(node, right), up);
                if !self.has(across) {
                    continue;
                }
                let corners =
                    [node, beyond(node, right), across, beyond(node, up)].map(|node| self.index(node));
                let values = corners.map(|corner| self.values[corner]);
                let edges = [3 * index + a, 3 * corners[1] + b, 3 * corners[3] + a, 3 * index + b];
                let is_inside = values.map(|value| value < 0.0);
                let passed: Vec<usize> = (0..4).filter(|&k| is_inside[k] != is_inside[(k + 1) % 4]).collect();
                if values.iter().any(|value| value.is_nan()) {
                    continue;
                }
                match passed[..] {
                    [k, l] => links.push([edges[k], edges[l]]),
                    [_, _, _, _] => {
                        let middle = self.place(node) + 0.5 * self.side * (DVec3::AXES[a] + DVec3::AXES[b]);
                        // What is like the middle hangs together through it.
                        let first = usize::from((f.value(middle) < 0.0) != is_inside[0]);
                        links
                            .extend([0, 2].map(|k| [edges[(k + 4 - first) % 4], edges[(k + 1 - first) % 4]]));
                    }
                    _ => {}
                }
            }
        }
        links
    }
}

fn unit(axis: usize) -> Node {
    [0, 1, 2].map(|k| usize::from(k == axis))
}

fn beyond(node: Node, step: Node) -> Node {
    [0, 1, 2].map(|axis| node[axis] + step[axis])
}
