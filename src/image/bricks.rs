//! The coefficients of the spline in bricks near the surface, and bounds of its values everywhere.
//!
//! The cells between voxels are grouped in *blocks* of 8³. A block is near the surface if the hull
//! of its cells' coefficients contains the iso value. Only then its coefficients are stored, as a
//! *brick* of 11³ numbers. In other blocks f does not change sign.

use super::Image;
use super::filter::{BEFORE, BEYOND, Planes};
use crate::math::{Bounds, Interval};
use crate::slices::Meter;
use glam::DVec3;
use std::collections::VecDeque;

/// Cells along each side of a block. Larger blocks store more coefficients far from the surface;
/// smaller ones store more of them twice.
pub(super) const SIDE: usize = 8;
/// Coefficients along each side of a brick.
pub(super) const WIDE: usize = SIDE + 3;
/// Coefficients of a brick.
const VOLUME: usize = WIDE * WIDE * WIDE;
/// The slot of a block that is far from the surface.
const FAR: u32 = u32::MAX;
/// Error of truncated and rounded coefficients, as a share of the image's range. By so much a voxel
/// may appear on the wrong side of the iso value.
const SLACK: f32 = 1e-5;

/// The smallest and the largest of some numbers.
pub(super) type Range = [f32; 2];

const NOTHING: Range = [f32::INFINITY, f32::NEG_INFINITY];

#[inline]
pub(super) fn joined(a: Range, b: Range) -> Range {
    // No number is NaN. Unlike `f32::min`, a comparison is one instruction in WebAssembly, too.
    [if b[0] < a[0] { b[0] } else { a[0] }, if b[1] > a[1] { b[1] } else { a[1] }]
}

fn range(numbers: impl Iterator<Item = f32>) -> Range {
    numbers.fold(NOTHING, |range, number| joined(range, [number, number]))
}

/// The smallest and the largest number in the first `width` columns of some rows, column by column,
/// which takes a few instructions a row.
fn range_of_rows<'a>(rows: impl Iterator<Item = &'a [f32; WIDE]>, width: usize) -> Range {
    let (mut lo, mut hi) = ([f32::INFINITY; WIDE], [f32::NEG_INFINITY; WIDE]);
    for row in rows {
        for i in 0..WIDE {
            lo[i] = if row[i] < lo[i] { row[i] } else { lo[i] };
            hi[i] = if row[i] > hi[i] { row[i] } else { hi[i] };
        }
    }
    let [lo, hi] = [lo, hi].map(|ends| range(ends.into_iter().take(width)));
    [lo[0], hi[1]]
}

/// Orders of the derivatives along the three axes: the value, three slopes and six second
/// derivatives.
pub(super) const ORDERS: [[usize; 3]; 10] = [
    [0, 0, 0],
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
    [2, 0, 0],
    [1, 1, 0],
    [1, 0, 1],
    [0, 2, 0],
    [0, 1, 1],
    [0, 0, 2],
];

/// Bounds of the value in blocks; each block holds eight of the level before.
struct Level {
    count: [usize; 3],
    values: Vec<Range>,
}

/// The spline of f over the cells of an image. Cell (0, 0, 0) lies before the first voxel of each
/// axis, so there is one more cell than voxels along each.
pub(super) struct Bricks {
    /// Cells along each axis.
    pub(super) cells: [usize; 3],
    /// Blocks along each axis.
    count: [usize; 3],
    /// The brick of each block, or [`FAR`].
    slots: Vec<u32>,
    coefficients: Vec<f32>,
    /// The block of each brick.
    near: Vec<u32>,
    /// Bounds of the derivatives of all orders in each brick.
    derivatives: Vec<[Range; 10]>,
    /// Bounds of the value in all blocks, then in ever larger groups of them.
    levels: Vec<Level>,
    /// Bounds of all derivatives over the whole image.
    pub(super) everywhere: [Range; 10],
    /// The first and the last cell along each axis that the surface may enter; none without a
    /// surface.
    pub(super) surface: Option<[[usize; 3]; 2]>,
}

/// A brick: 11³ coefficients, the first axis fastest.
#[derive(Clone, Copy)]
pub(super) struct Brick<'a>(pub(super) &'a [f32]);

impl Brick<'_> {
    /// The forward difference of these orders of the coefficients at (i, j, k).
    #[inline]
    pub(super) fn difference(&self, at: [usize; 3], orders: [usize; 3]) -> f32 {
        let start = at[0] + WIDE * (at[1] + WIDE * at[2]);
        let c = |steps: [usize; 3]| self.0[start + steps[0] + WIDE * (steps[1] + WIDE * steps[2])];
        let unit = |axis: usize, length: usize| {
            let mut steps = [0; 3];
            steps[axis] = length;
            steps
        };
        match orders.iter().position(|&order| order == 2) {
            Some(axis) => (c(unit(axis, 2)) - c(unit(axis, 1))) - (c(unit(axis, 1)) - c([0; 3])),
            None => match orders {
                [0, 0, 0] => c([0; 3]),
                [1, 0, 0] | [0, 1, 0] | [0, 0, 1] => c(orders) - c([0; 3]),
                [a, b, 0] => (c([a, b, 0]) - c([a, 0, 0])) - (c([0, b, 0]) - c([0; 3])),
                [a, 0, b] => (c([a, 0, b]) - c([a, 0, 0])) - (c([0, 0, b]) - c([0; 3])),
                [_, a, b] => (c([0, a, b]) - c([0, a, 0])) - (c([0, 0, b]) - c([0; 3])),
            },
        }
    }

    /// Bounds of a derivative over the cells from `first` to `last`: the hull of the coefficients'
    /// differences, rounded outward.
    pub(super) fn hull(&self, first: [usize; 3], last: [usize; 3], orders: [usize; 3]) -> Range {
        let along = |axis: usize| first[axis]..=last[axis] + 3 - orders[axis];
        let mut hull = NOTHING;
        for k in along(2) {
            for j in along(1) {
                let row = along(0).map(|i| self.difference([i, j, k], orders));
                hull = joined(hull, range(row));
            }
        }
        if orders == [0, 0, 0] {
            return hull;
        }
        // Each of the two subtractions rounds once.
        let rounding = 4.0 * f32::EPSILON * range(self.0.iter().map(|c| c.abs()))[1];
        [hull[0] - rounding, hull[1] + rounding]
    }

    /// [`Brick::hull`] over all cells, for all [`ORDERS`], by differences of whole rows.
    fn whole_hulls(&self) -> [Range; 10] {
        let mut largest = 0.0_f32;
        for c in self.0 {
            largest = if c.abs() > largest { c.abs() } else { largest };
        }
        // Each of the two subtractions rounds once.
        let rounding = 4.0 * f32::EPSILON * largest;
        let mut differences = vec![0.0; VOLUME];
        ORDERS.map(|orders| {
            differences.copy_from_slice(self.0);
            // The last axis first, as in [`Brick::difference`].
            for axis in (0..3).rev() {
                let stride = [1, WIDE, WIDE * WIDE][axis];
                for _ in 0..orders[axis] {
                    for at in 0..VOLUME - stride {
                        differences[at] = differences[at + stride] - differences[at];
                    }
                }
            }
            let rows = differences.as_chunks::<WIDE>().0;
            let [width, height, depth] = orders.map(|order| WIDE - order);
            let all = (0..depth).flat_map(|k| &rows[WIDE * k..][..height]);
            let [lo, hi] = range_of_rows(all, width);
            if orders == [0, 0, 0] { [lo, hi] } else { [lo - rounding, hi + rounding] }
        })
    }

    /// Bounds of the value over each of the 8³ cells: the hull of its 4³ coefficients.
    pub(super) fn cell_hulls(&self) -> Vec<Range> {
        let mut ranges: Vec<Range> = self.0.iter().map(|&c| [c, c]).collect();
        let mut sides = [WIDE; 3];
        for axis in 0..3 {
            let mut next = sides;
            next[axis] = SIDE;
            let stride = [1, sides[0], sides[0] * sides[1]];
            let mut out = Vec::with_capacity(next.iter().product());
            for k in 0..next[2] {
                for j in 0..next[1] {
                    for i in 0..next[0] {
                        let at = i + stride[1] * j + stride[2] * k;
                        let along = (0..4).map(|step| ranges[at + step * stride[axis]]);
                        out.push(along.fold(NOTHING, joined));
                    }
                }
            }
            (ranges, sides) = (out, next);
        }
        ranges
    }
}

/// Calls `visit` with the indices of all cells from `first` to `last`, the first axis fastest.
pub(super) fn for_each_cell(first: [usize; 3], last: [usize; 3], mut visit: impl FnMut([usize; 3])) {
    for k in first[2]..=last[2] {
        for j in first[1]..=last[1] {
            for i in first[0]..=last[0] {
                visit([i, j, k]);
            }
        }
    }
}

impl Bricks {
    /// The spline of iso − value; if `is_inverted`, of value − iso. Made in slices of work.
    pub(super) async fn made(image: &Image, iso: f64, is_inverted: bool) -> Self {
        let cells = image.size.map(|n| n + 1);
        let count = cells.map(|n| n.div_ceil(SIDE));
        let mut bricks = Self {
            cells,
            count,
            slots: Vec::with_capacity(count.iter().product()),
            coefficients: Vec::new(),
            near: Vec::new(),
            derivatives: Vec::new(),
            levels: Vec::new(),
            everywhere: [NOTHING; 10],
            surface: None,
        };
        let level = (iso - image.middle()) as f32;
        let slack = SLACK * (image.range[1] - image.range[0]) as f32;
        let mut values = Vec::with_capacity(count.iter().product());
        let (mut planes, mut meter) = (Planes::new(image), Meter::default());
        let mut window: VecDeque<Vec<f32>> = VecDeque::new();
        let sizes = image.size.map(|n| n + BEYOND);
        let mut brick = vec![0.0; VOLUME];
        for z in 0..count[2] {
            window.drain(..window.len().min(SIDE));
            let depth = WIDE.min(sizes[2] - SIDE * z);
            while window.len() < depth {
                let mut plane = planes.next_plane(&mut meter).await;
                for c in &mut plane {
                    *c = if is_inverted { *c - level } else { level - *c };
                }
                window.push_back(plane);
            }
            for y in 0..count[1] {
                for x in 0..count[0] {
                    let (height, width) = (WIDE.min(sizes[1] - SIDE * y), WIDE.min(sizes[0] - SIDE * x));
                    // Copies of the border pad the brick; they do not change its bounds.
                    for k in 0..WIDE {
                        let plane = &window[k.min(depth - 1)];
                        for j in 0..WIDE {
                            let row = sizes[0] * (SIDE * y + j.min(height - 1)) + SIDE * x;
                            let row = &plane[row..row + width];
                            let out = &mut brick[WIDE * (j + WIDE * k)..][..WIDE];
                            out[..width].copy_from_slice(row);
                            out[width..].fill(row[width - 1]);
                        }
                    }
                    let hull = range_of_rows(brick.as_chunks().0.iter(), WIDE);
                    values.push(hull);
                    let is_near = hull[0] <= slack && hull[1] >= -slack;
                    bricks.add([x, y, z], is_near.then_some(Brick(&brick)), hull);
                    // Bounds of all derivatives take about as long as four passes over the voxels.
                    meter.add(if is_near { 4 } else { 1 } * SIDE * SIDE * SIDE).await;
                }
            }
        }
        bricks.add_levels(values);
        bricks
    }

    /// Adds a block, with its coefficients if it is near the surface.
    fn add(&mut self, block: [usize; 3], brick: Option<Brick>, hull: Range) {
        let derivatives = match brick {
            None => {
                self.slots.push(FAR);
                far_derivatives(hull)
            }
            Some(brick) => {
                self.near.push(self.slots.len() as u32);
                self.slots.push(self.derivatives.len() as u32);
                self.coefficients.extend_from_slice(brick.0);
                let derivatives = brick.whole_hulls();
                self.derivatives.push(derivatives);
                for (at, hull) in brick.cell_hulls().into_iter().enumerate() {
                    let within = [at % SIDE, at / SIDE % SIDE, at / SIDE / SIDE];
                    let cell: [usize; 3] = core::array::from_fn(|a| SIDE * block[a] + within[a]);
                    let is_cell = (0..3).all(|axis| cell[axis] < self.cells[axis]);
                    if is_cell && hull[0] <= 0.0 && hull[1] >= 0.0 {
                        let [lo, hi] = self.surface.unwrap_or([cell, cell]);
                        let ends = |a: usize| (lo[a].min(cell[a]), hi[a].max(cell[a]));
                        self.surface = Some([[0, 1, 2].map(|a| ends(a).0), [0, 1, 2].map(|a| ends(a).1)]);
                    }
                }
                derivatives
            }
        };
        for (all, own) in self.everywhere.iter_mut().zip(derivatives) {
            *all = joined(*all, own);
        }
    }

    /// Builds the pyramid of bounds from those of the blocks.
    fn add_levels(&mut self, values: Vec<Range>) {
        self.levels.push(Level { count: self.count, values });
        loop {
            let below = &self.levels[self.levels.len() - 1];
            if below.values.len() == 1 {
                return;
            }
            let count = below.count.map(|n| n.div_ceil(2));
            let mut values = vec![NOTHING; count.iter().product()];
            for_each_cell([0; 3], below.count.map(|n| n - 1), |[i, j, k]| {
                let own = below.values[i + below.count[0] * (j + below.count[1] * k)];
                let above = &mut values[i / 2 + count[0] * (j / 2 + count[1] * (k / 2))];
                *above = joined(*above, own);
            });
            self.levels.push(Level { count, values });
        }
    }

    fn block(&self, block: [usize; 3]) -> usize {
        block[0] + self.count[0] * (block[1] + self.count[1] * block[2])
    }

    /// The brick of a block, if it is near the surface.
    #[inline]
    pub(super) fn brick(&self, block: [usize; 3]) -> Option<Brick<'_>> {
        let slot = self.slots[self.block(block)];
        (slot != FAR).then(|| Brick(&self.coefficients[VOLUME * slot as usize..][..VOLUME]))
    }

    /// Bounds of the derivatives of all orders in a block.
    pub(super) fn derivatives(&self, block: [usize; 3]) -> [Range; 10] {
        let at = self.block(block);
        match self.slots[at] {
            FAR => far_derivatives(self.levels[0].values[at]),
            slot => self.derivatives[slot as usize],
        }
    }

    /// Bounds of the value over the blocks from `first` to `last`, by at most 4³ groups of them.
    pub(super) fn values(&self, first: [usize; 3], last: [usize; 3]) -> Range {
        let is_fine = |shift: usize| (0..3).all(|axis| (last[axis] >> shift) - (first[axis] >> shift) < 4);
        let shift = (0..self.levels.len()).find(|&shift| is_fine(shift)).unwrap_or(self.levels.len() - 1);
        let level = &self.levels[shift];
        let mut hull = NOTHING;
        for_each_cell(first.map(|b| b >> shift), last.map(|b| b >> shift), |[i, j, k]| {
            hull = joined(hull, level.values[i + level.count[0] * (j + level.count[1] * k)]);
        });
        hull
    }

    /// Number of blocks that are near the surface.
    pub(super) fn near_count(&self) -> usize {
        self.near.len()
    }

    /// The indices of such a block.
    pub(super) fn near_block(&self, number: usize) -> [usize; 3] {
        let (at, [x, y, _]) = (self.near[number] as usize, self.count);
        [at % x, at / x % y, at / x / y]
    }

    /// Bytes of memory that the bricks and bounds take.
    pub(super) fn bytes(&self) -> usize {
        let levels: usize = self.levels.iter().map(|level| size_of_val(&*level.values)).sum();
        size_of_val(&*self.slots)
            + size_of_val(&*self.coefficients)
            + size_of_val(&*self.derivatives)
            + levels
    }

    /// The box, in voxel indices, in which the surface may lie, and whether it reaches the border
    /// of the image at the lower and upper end of each axis.
    pub(super) fn surface_box(&self) -> Option<(Bounds, [[bool; 2]; 3])> {
        let [lo, hi] = self.surface?;
        // Cell c lies between voxels c − 1 and c.
        let cut = [0, 1, 2].map(|a| [lo[a] == 0, hi[a] == self.cells[a] - 1]);
        let last = |a: usize| (self.cells[a] - 2) as f64;
        let end = |a: usize, x: usize| (x as f64).clamp(0.0, last(a));
        let min = [0, 1, 2].map(|a| end(a, lo[a].saturating_sub(1)));
        let max = [0, 1, 2].map(|a| end(a, hi[a]));
        Some((Bounds::new(DVec3::from_array(min), DVec3::from_array(max)), cut))
    }
}

/// Bounds of the derivatives of all orders where the coefficients are in a range: their differences
/// cannot exceed its width.
fn far_derivatives([lo, hi]: Range) -> [Range; 10] {
    let width = (hi - lo) * (1.0 + f32::EPSILON);
    ORDERS.map(|orders| match orders.iter().sum::<usize>() {
        0 => [lo, hi],
        1 => [-width, width],
        _ => [-2.0 * width, 2.0 * width],
    })
}

/// A range as an interval.
pub(super) fn interval([lo, hi]: Range) -> Interval {
    Interval::new(lo.into(), hi.into())
}

/// The coefficients of cell c begin at index c of a row of [`Planes`].
const _: () = assert!(BEFORE == 2, "cell 0 takes the coefficients −2 to 1");

#[cfg(test)]
mod tests {
    use super::*;
    use rand_core::{Rng, SeedableRng};
    use rand_pcg::Pcg32;

    #[test]
    fn bounds_of_a_whole_brick_are_those_of_all_its_cells() {
        let mut random = Pcg32::seed_from_u64(6);
        for _ in 0..20 {
            let coefficients: Vec<f32> =
                (0..VOLUME).map(|_| random.next_u32() as f32 / 1e6 - 2000.0).collect();
            let brick = Brick(&coefficients);
            let cells = ORDERS.map(|orders| brick.hull([0; 3], [SIDE - 1; 3], orders));
            assert_eq!(brick.whole_hulls(), cells);
        }
    }
}
