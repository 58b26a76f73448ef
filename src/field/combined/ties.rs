//! Cells in which the two operands of a minimum or maximum may be equal on the surface.
//!
//! A field of the program has no bounds over a cell. In the middle of the cell |f|/|∇f| is the
//! distance from the surface to first order. A surface farther away than twice the distance of the
//! corners is assumed not to pass through the cell.

use super::evaluator::CombinationEvaluator;
use super::rule::Rule;
use crate::math::Bounds;
use crate::slices::{HEAVY, pause};
use glam::DVec3;

/// Number of cells along the longest side of the box at the start of the search. A sheet of the
/// surface that is closer to another one than a cell is wide may be missed.
const SIDE: f64 = 32.0;
/// A surface may pass through a cell up to this multiple of the distance from the middle to a
/// corner.
const SLACK: f64 = 2.0;
/// Sine of the largest angle between gradients that count as parallel: only rounding separates
/// them.
const PARALLEL: f64 = 1e-6;
/// Sine of the largest angle between two gradients in the middle of a cell where their surfaces may
/// meet without an edge, if one surface has a curvature up to a quarter of the inverse cell width.
/// Larger: smooth joins are searched for along creases that have none.
const NEARLY_PARALLEL: f64 = 0.2;
/// The largest number of cells that are divided further. Two surfaces that share a face exceed it.
const MOST_CELLS: usize = 200_000;

impl CombinationEvaluator<'_> {
    /// The cells of a box in which both parts may be zero, no wider than `width` unless they are
    /// too many.
    pub(super) async fn tied_cells(&mut self, bounds: &Bounds, width: f64) -> Vec<Bounds> {
        let first = bounds.size().max_element() / SIDE;
        let mut cells = vec![*bounds];
        while let Some(widest) = cells.iter().map(|cell| cell.size().max_element()).reduce(f64::max) {
            if widest <= first {
                let mut kept = Vec::new();
                for cells in cells.chunks(HEAVY) {
                    pause().await;
                    kept.extend(cells.iter().copied().filter(|cell| self.may_be_tied(cell)));
                }
                cells = kept;
                if widest <= width || cells.len() > MOST_CELLS {
                    break;
                }
            }
            cells = cells.iter().flat_map(Bounds::halves).collect();
        }
        cells
    }

    /// Whether the surfaces of both parts may pass through a cell without being parallel, as those
    /// of f and −f are. Parts that have several branches there may be parallel in the middle only.
    fn may_be_tied(&mut self, cell: &Bounds) -> bool {
        let reach = 0.5 * SLACK * cell.diagonal();
        let slopes = [0, 1].map(|k: usize| self.parts[k].value_and_gradient(cell.middle()));
        let [(_, u), (_, v)] = slopes;
        let are_near = slopes.iter().all(|(value, gradient)| value.abs() <= reach * gradient.length());
        let sine_sq = PARALLEL * PARALLEL * u.length_squared() * v.length_squared();
        are_near
            && (u.cross(v).length_squared() > sine_sq
                || (0..2).any(|part| self.branches_of(part, cell).is_none_or(|own| own.len() > 1)))
    }

    /// The pairs of branches, one of each part, that may meet without an edge in cells where the
    /// parts are tied.
    pub(super) async fn tangent_pairs_in(&mut self, cells: &[Bounds]) -> Vec<[u32; 2]> {
        let mut found = Vec::new();
        for cells in cells.chunks(HEAVY) {
            pause().await;
            for cell in cells {
                let middle = cell.middle();
                let branches = [0, 1].map(|part| self.branches_of(part, cell).unwrap_or_default());
                let mut slopes = [0, 1].map(|part: usize| {
                    let of = |&branch: &u32| {
                        let number = 2 * branch + part as u32;
                        (number, self.function(part, branch).value_and_gradient(middle))
                    };
                    branches[part].iter().map(of).collect::<Vec<_>>()
                });
                let reach = 0.5 * SLACK * cell.diagonal();
                for own in &mut slopes {
                    own.retain(|(_, (value, gradient))| value.abs() <= reach * gradient.length());
                }
                let [first, second] = slopes;
                for (a, (_, u)) in first {
                    for &(b, (_, v)) in &second {
                        let sizes = u.length() * v.length();
                        let is_tangent = u.dot(v) > 0.0 && u.cross(v).length() <= NEARLY_PARALLEL * sizes;
                        let pair = [a.min(b), a.max(b)];
                        if is_tangent && !found.contains(&pair) && self.may_turn(cell) {
                            found.push(pair);
                        }
                    }
                }
            }
        }
        found.sort_unstable();
        found
    }

    /// Whether one part gives f at some corners of a cell, and the other one at others.
    fn may_turn(&mut self, cell: &Bounds) -> bool {
        let parts = cell.corners().map(|corner| self.part_at(corner));
        parts.contains(&0) && parts.contains(&1)
    }

    /// Whether each part may give a point of the surface in a cell: where it is zero, and the rule
    /// does not take the other one.
    pub(super) fn may_give(&mut self, cell: &Bounds) -> [bool; 2] {
        let reach = 0.5 * SLACK * cell.diagonal();
        let sign = if self.field.rule == Rule::Least { -1.0 } else { 1.0 };
        let slopes = [0, 1].map(|k: usize| self.parts[k].value_and_gradient(cell.middle()));
        [0, 1].map(|k: usize| {
            let [(value, gradient), (other, of_other)] = [slopes[k], slopes[1 - k]];
            value.abs() <= reach * gradient.length() && sign * other <= reach * of_other.length()
        })
    }

    /// Drops the cells in which no part gives a point of the surface. `origin` is the origin of the
    /// frame, in the coordinates of the cells.
    pub(super) async fn drop_hidden(&mut self, cells: &mut Vec<Bounds>, origin: DVec3) {
        let mut kept = Vec::new();
        for cells in cells.chunks(HEAVY) {
            pause().await;
            let is_there = |cell: &&Bounds| self.may_give(&cell.relative_to(origin)).contains(&true);
            kept.extend(cells.iter().filter(is_there));
        }
        *cells = kept;
    }
}
