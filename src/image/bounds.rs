//! Bounds of the spline and its derivatives over boxes of indices.
//!
//! Over up to 27 cells they are the hull of the Bézier points of each cell's part in the box, exact
//! for single points. Over more cells they are the hull of the coefficients and their differences,
//! and over many blocks the bounds that are stored for each.

use super::bricks::{Brick, Bricks, ORDERS, SIDE, WIDE, for_each_cell, interval};
use super::kernel::bezier_weights;
use crate::math::{Bounds, Interval};
use core::ops::Range;

/// Bounds of the derivatives of [`ORDERS`], over indices.
pub(super) type Derivatives = [Interval; 10];

/// Number of cells up to which a box is bounded by Bézier points, cell by cell. A voxel of an image
/// that is rotated in space lies in a box of up to three cells along each axis.
const FEW: usize = 27;
/// Number of blocks along each axis up to which their bounds are joined. Over more blocks the
/// derivatives are bounded by those of the whole image.
const BLOCKS: usize = 4;
/// Tolerance, in cells, within which a box counts as part of one cell, although a face was rounded
/// outward. Beyond their common face the polynomials of two cells differ only by the cube of the
/// distance.
const BESIDE: f64 = 1e-9;
/// Rounding errors of the sums of 64 products, and of second derivatives [`BESIDE`] a cell, as a
/// share of the largest coefficient.
const ROUNDING: f64 = 1e-13;
const ROUNDING_OF_SECOND: f64 = 2e-8;

/// Bounds over a box, and whether the spline is defined in all of it.
pub(super) struct Found {
    pub(super) derivatives: Derivatives,
    pub(super) is_inside: bool,
}

impl Bricks {
    /// Bounds of the derivatives of the [`ORDERS`] in `wanted` over a box of voxel indices; none
    /// where the spline is not defined. The other derivatives are empty.
    pub(super) fn enclose(&self, indices: &Bounds, wanted: Range<usize>) -> Option<Found> {
        let (mut first, mut last) = ([0; 3], [0; 3]);
        let (mut from, mut to) = ([0.0; 3], [0.0; 3]);
        let mut is_inside = true;
        for axis in 0..3 {
            // Voxel 0 lies at the end of cell 0.
            let (lo, hi) = (indices.min[axis] + 1.0, indices.max[axis] + 1.0);
            let end = self.cells[axis] as f64;
            if !(hi >= 0.0 && lo <= end) {
                return None;
            }
            is_inside &= lo >= 0.0 && hi <= end;
            (from[axis], to[axis]) = (lo.max(0.0), hi.min(end));
            let cell = |x: f64| (x.max(0.0) as usize).min(self.cells[axis] - 1);
            (first[axis], last[axis]) = (cell(from[axis] + BESIDE), cell(to[axis] - BESIDE));
            last[axis] = last[axis].max(first[axis]);
        }
        let count: usize = (0..3).map(|axis| last[axis] - first[axis] + 1).product();
        let mut derivatives = [Interval::NOTHING; 10];
        if count <= FEW {
            for_each_cell(first, last, |cell| {
                let part = |axis: usize| {
                    let start = cell[axis] as f64;
                    let ends = [from[axis] - start, to[axis] - start];
                    ends.map(|t| t.clamp(-BESIDE, 1.0 + BESIDE))
                };
                self.in_cell(cell, [part(0), part(1), part(2)], &wanted, &mut derivatives);
            });
        } else {
            self.over_cells(first, last, &wanted, &mut derivatives);
        }
        Some(Found { derivatives, is_inside })
    }

    /// Extends `found` by the bounds over a part of a cell.
    fn in_cell(&self, cell: [usize; 3], part: [[f64; 2]; 3], wanted: &Range<usize>, found: &mut Derivatives) {
        let block = cell.map(|c| c / SIDE);
        match self.brick(block) {
            Some(brick) => bezier(brick, cell.map(|c| c % SIDE), part, wanted, found),
            None => {
                let known = self.derivatives(block);
                wanted.clone().for_each(|n| found[n] = hull(found[n], interval(known[n])));
            }
        }
    }

    /// Extends `found` by the bounds over many cells.
    fn over_cells(
        &self,
        first: [usize; 3],
        last: [usize; 3],
        wanted: &Range<usize>,
        found: &mut Derivatives,
    ) {
        let blocks = [first, last].map(|cell| cell.map(|c| c / SIDE));
        let [first_block, last_block] = blocks;
        if (0..3).any(|axis| last_block[axis] - first_block[axis] >= BLOCKS) {
            for n in wanted.clone() {
                let known = if n == 0 { self.values(first_block, last_block) } else { self.everywhere[n] };
                found[n] = interval(known);
            }
            return;
        }
        for_each_cell(first_block, last_block, |block| {
            let within = |cell: [usize; 3], of_end: usize| {
                [0, 1, 2]
                    .map(|a| if block[a] == blocks[of_end][a] { cell[a] % SIDE } else { of_end * (SIDE - 1) })
            };
            let (lo, hi) = (within(first, 0), within(last, 1));
            let is_whole = lo == [0; 3] && hi == [SIDE - 1; 3];
            let brick = self.brick(block).filter(|_| !is_whole);
            let known = if brick.is_none() { self.derivatives(block) } else { [[0.0; 2]; 10] };
            for n in wanted.clone() {
                let own = brick.map_or(known[n], |brick| brick.hull(lo, hi, ORDERS[n]));
                found[n] = hull(found[n], interval(own));
            }
        });
    }
}

fn hull(a: Interval, b: Interval) -> Interval {
    Interval::new(a.lo.min(b.lo), a.hi.max(b.hi))
}

/// Extends `found` by the hull of the Bézier points over a part of a cell, axis by axis.
fn bezier(
    brick: Brick,
    cell: [usize; 3],
    part: [[f64; 2]; 3],
    wanted: &Range<usize>,
    found: &mut Derivatives,
) {
    let [x, y, z] = part.map(|[from, to]| bezier_weights(from, to));
    let dot = |w: &[f64; 4], c: &[f64; 4]| (w[0] * c[0] + w[1] * c[1]) + (w[2] * c[2] + w[3] * c[3]);
    let mut rows = [[[0.0_f64; 4]; 4]; 4];
    let mut largest = 0.0_f64;
    for (k, plane) in rows.iter_mut().enumerate() {
        for (j, row) in plane.iter_mut().enumerate() {
            let at = cell[0] + WIDE * (cell[1] + j + WIDE * (cell[2] + k));
            *row = core::array::from_fn(|i| f64::from(brick.0[at + i]));
            largest = row.iter().fold(largest, |largest, c: &f64| largest.max(c.abs()));
        }
    }
    for along_x in 0..3 {
        let is_wanted = |n: &usize| ORDERS[*n][0] == along_x;
        if !wanted.clone().any(|n| is_wanted(&n)) {
            continue;
        }
        for weights_x in &x[along_x][..4 - along_x] {
            // The coefficients along y and z at this Bézier point along x.
            let plane = rows.map(|plane| plane.map(|row| dot(weights_x, &row)));
            for n in wanted.clone().filter(is_wanted) {
                let [_, along_y, along_z] = ORDERS[n];
                let second = ORDERS[n].iter().sum::<usize>() == 2;
                let slack = largest * if second { ROUNDING_OF_SECOND } else { ROUNDING };
                for weights_y in &y[along_y][..4 - along_y] {
                    let column = plane.map(|row| dot(weights_y, &row));
                    for weights_z in &z[along_z][..4 - along_z] {
                        let point = dot(weights_z, &column);
                        found[n] = hull(found[n], Interval::new(point - slack, point + slack));
                    }
                }
            }
        }
    }
}
