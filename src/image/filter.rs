//! The coefficients of the spline through the voxels, plane by plane.
//!
//! A cubic B-spline with coefficients c has the values (c[i−1] + 4 c[i] + c[i+1]) / 6 at whole
//! numbers. The inverse is a two-sided filter, c[i] = √3 Σ z^|k| s[i+k] with z = √3 − 2 (Unser
//! 1999, box 2), applied along each axis in turn. It is cut off where its weights fall below the
//! rounding of single precision. So a coefficient depends only on the voxels around it, and has the
//! same bits whichever part of an image is computed, in whichever order.
//!
//! Beyond its ends a row of voxels continues as its reflection at the last point, s[−i] = 2 s[0] −
//! s[i]. This makes the spline a *natural* one, whose second derivative vanishes at the ends. The
//! usual reflection s[−i] = s[i] would make the slope vanish there, and tilt the normals of a
//! surface that the border cuts.

use super::Image;
use super::smooth::add_up;
use crate::slices::{LIGHT, Meter};
use std::collections::VecDeque;

/// Weights of the filter on each side. The next weight would be 6 · 10⁻⁸ of the middle one, the
/// rounding of single precision.
pub(super) const REACH: usize = 12;

/// Coefficients that are computed before the first voxel of a row: one for the first cell, and one
/// for the cell beyond the border.
pub(super) const BEFORE: usize = 2;
/// By how many a row has more coefficients than voxels.
pub(super) const BEYOND: usize = 2 * BEFORE;

/// The weights √3 z^k for k = 0..=REACH, scaled so that the filter keeps a constant.
fn weights() -> [f32; REACH + 1] {
    let z = libm::sqrt(3.0) - 2.0;
    let mut weights = [1.0; REACH + 1];
    for k in 1..=REACH {
        weights[k] = weights[k - 1] * z;
    }
    let sum = weights[0] + 2.0 * weights[1..].iter().sum::<f64>();
    weights.map(|weight| (weight / sum) as f32)
}

/// A value beyond the end of a row: `sign` times the value at `at`, plus `first` times the first
/// value and `last` times the last one.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Reflected {
    at: usize,
    sign: f32,
    first: f32,
    last: f32,
}

/// How the value at `i` follows from those of a row of `n` ≥ 2 values.
fn reflected(mut i: isize, n: usize) -> Reflected {
    let end = n as isize - 1;
    let (mut sign, mut first, mut last) = (1.0, 0.0, 0.0);
    loop {
        if i < 0 {
            (first, sign, i) = (first + 2.0 * sign, -sign, -i);
        } else if i > end {
            (last, sign, i) = (last + 2.0 * sign, -sign, 2 * end - i);
        } else {
            return Reflected { at: i as usize, sign, first, last };
        }
    }
}

impl Reflected {
    /// Writes the value, or those of several rows at once.
    fn write<'a>(self, row: impl Fn(usize) -> &'a [f32], end: usize, out: &mut [f32]) {
        let (at, first, last) = (row(self.at), row(0), row(end));
        for (k, out) in out.iter_mut().enumerate() {
            *out = self.sign * at[k] + (self.first * first[k] + self.last * last[k]);
        }
    }
}

/// The coefficients of an image, one plane of the third axis after the other.
pub(super) struct Planes<'a> {
    image: &'a Image,
    weights: [f32; REACH + 1],
    /// Coefficients along the first and second axis.
    width: usize,
    height: usize,
    /// Planes that are filtered along the first two axes, from index `first` on. The filter along
    /// the third axis still needs them.
    window: VecDeque<Vec<f32>>,
    first: isize,
    /// The first and the last plane of the image, filtered in the same way.
    ends: Option<[Vec<f32>; 2]>,
    /// Index of the next plane of coefficients, from −[`BEFORE`] on.
    next: isize,
}

impl<'a> Planes<'a> {
    pub(super) fn new(image: &'a Image) -> Self {
        let reach = (BEFORE + REACH) as isize;
        Self {
            image,
            weights: weights(),
            width: image.size[0] + BEYOND,
            height: image.size[1] + BEYOND,
            window: VecDeque::new(),
            first: -reach,
            ends: None,
            next: -(BEFORE as isize),
        }
    }

    /// The next plane of coefficients, relative to the middle of the image's range: rows of
    /// `size[0]` + [`BEYOND`] values. There are `size[2]` + [`BEYOND`] planes.
    pub(super) async fn next_plane(&mut self, meter: &mut Meter) -> Vec<f32> {
        let reach = REACH as isize;
        while self.first < self.next - reach {
            self.window.pop_front();
            self.first += 1;
        }
        while self.first + (self.window.len() as isize) <= self.next + reach {
            let plane = self.plane_at(self.first + self.window.len() as isize, meter).await;
            self.window.push_back(plane);
        }
        let mut out = vec![0.0; self.width * self.height];
        let middle = self.next - self.first;
        for (n, out) in out.chunks_mut(LIGHT).enumerate() {
            let part = n * LIGHT..n * LIGHT + out.len();
            let at = |k: isize| &self.window[(middle + k) as usize][part.clone()];
            add_up(&self.weights, at, out);
            meter.add(out.len()).await;
        }
        self.next += 1;
        out
    }

    /// A plane that is filtered along the first two axes; `k` may lie beyond the image.
    async fn plane_at(&mut self, k: isize, meter: &mut Meter) -> Vec<f32> {
        let depth = self.image.size[2];
        if (0..depth as isize).contains(&k) {
            return self.filtered(k as usize, meter).await;
        }
        let ends = match self.ends.take() {
            Some(ends) => ends,
            None => [self.filtered(0, meter).await, self.filtered(depth - 1, meter).await],
        };
        let place = reflected(k, depth);
        let held = (place.at as isize - self.first) as usize;
        let is_held = self.window.get(held).is_some();
        let own = if is_held { Vec::new() } else { self.filtered(place.at, meter).await };
        let at: &[f32] = if is_held { &self.window[held] } else { &own };
        let mut out = vec![0.0; at.len()];
        let row = |j: usize| {
            if j == 0 {
                ends[0].as_slice()
            } else if j == depth - 1 {
                ends[1].as_slice()
            } else {
                at
            }
        };
        place.write(row, depth - 1, &mut out);
        self.ends = Some(ends);
        out
    }

    /// A plane of the image, filtered along the first two axes.
    async fn filtered(&self, k: usize, meter: &mut Meter) -> Vec<f32> {
        let [width, height, _] = self.image.size;
        let room = BEFORE + REACH;
        let zero = self.image.middle();
        // Rows that are filtered along the first axis, including rows beyond the image.
        let mut rows = vec![0.0; self.width * (height + 2 * room)];
        let mut line = vec![0.0; width + 2 * room];
        for j in 0..height {
            self.image.row(j, k, zero, &mut line[room..room + width]);
            extend(&mut line, 1, width);
            let out = &mut rows[self.width * (j + room)..][..self.width];
            let at = |step: isize| &line[(REACH as isize + step) as usize..][..self.width];
            add_up(&self.weights, at, out);
            meter.add(self.width).await;
        }
        extend(&mut rows, self.width, height);
        let mut out = vec![0.0; self.width * self.height];
        for (j, out) in out.chunks_mut(self.width).enumerate() {
            let at = |step: isize| &rows[self.width * ((j + REACH) as isize + step) as usize..][..self.width];
            add_up(&self.weights, at, out);
            meter.add(self.width).await;
        }
        out
    }
}

/// Writes the values beyond the ends of `n` rows of `width` values. There is room for [`BEFORE`] +
/// [`REACH`] rows at each end.
fn extend(rows: &mut [f32], width: usize, n: usize) {
    let room = (BEFORE + REACH) as isize;
    let (before, rest) = rows.split_at_mut(room as usize * width);
    let (row, behind) = rest.split_at_mut(n * width);
    let row = |j: usize| &row[j * width..][..width];
    let beyond = before.chunks_mut(width).zip(-room..).chain(behind.chunks_mut(width).zip(n as isize..));
    for (out, i) in beyond {
        reflected(i, n).write(row, n - 1, out);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::slices::complete;
    use rand_core::{Rng, SeedableRng};
    use rand_pcg::Pcg32;

    /// The coefficients −1..=n of the natural spline through `s`, by elimination of the tridiagonal
    /// system, in double precision.
    fn solved(s: &[f64]) -> Vec<f64> {
        let n = s.len();
        let mut c = s.to_vec();
        let mut pivot = vec![4.0; n];
        c[1..n - 1].iter_mut().for_each(|c| *c *= 6.0);
        // The ends are known: c[0] = s[0] and c[n−1] = s[n−1].
        for k in 1..n - 1 {
            let factor = if k == 1 { 1.0 } else { 1.0 / pivot[k - 1] };
            c[k] -= factor * c[k - 1];
            if k > 1 {
                pivot[k] -= factor;
            }
        }
        for k in (1..n - 1).rev() {
            c[k] = (c[k] - c[k + 1]) / pivot[k];
        }
        let (before, behind) = (2.0 * c[0] - c[1], 2.0 * c[n - 1] - c[n - 2]);
        [&[before], c.as_slice(), &[behind]].concat()
    }

    /// [`solved`] along each axis: coefficients −1..=n of every axis.
    fn oracle(size: [usize; 3], voxels: &[f64]) -> Vec<f64> {
        let (mut values, mut size) = (voxels.to_vec(), size);
        for axis in 0..3 {
            let n = size[axis];
            let stride: usize = size[..axis].iter().product();
            let mut wider = size;
            wider[axis] += 2;
            let mut out = vec![0.0; wider.iter().product()];
            for line in 0..values.len() / n {
                let (low, high) = (line % stride, line / stride);
                let row: Vec<f64> = (0..n).map(|k| values[low + stride * (k + n * high)]).collect();
                for (k, c) in solved(&row).into_iter().enumerate() {
                    out[low + stride * (k + wider[axis] * high)] = c;
                }
            }
            (values, size) = (out, wider);
        }
        values
    }

    #[test]
    fn coefficients_are_those_of_the_natural_spline() {
        let mut random = Pcg32::seed_from_u64(7);
        for size in [[2, 2, 2], [3, 2, 5], [4, 9, 3], [17, 6, 31], [40, 33, 5]] {
            let count: usize = size.iter().product();
            let voxels: Vec<f64> = (0..count).map(|_| f64::from(random.next_u32()) / 4e9).collect();
            let image = Image::new(size, &voxels).expect("an image");
            let wanted = oracle(size, &voxels);
            let (mut planes, mut meter) = (Planes::new(&image), Meter::default());
            let mut worst = 0.0_f64;
            let (width, height) = (size[0] + BEYOND, size[1] + BEYOND);
            for k in 0..size[2] + BEYOND {
                let plane = complete(planes.next_plane(&mut meter));
                for (at, found) in plane.iter().enumerate() {
                    let [i, j] = [at % width, at / width];
                    // The outermost coefficients are beyond those of the oracle.
                    let is_inner = |at: usize, n: usize| (1..n - 1).contains(&at);
                    if is_inner(i, width) && is_inner(j, height) && is_inner(k, size[2] + BEYOND) {
                        let wanted = wanted[i - 1 + (size[0] + 2) * (j - 1 + (size[1] + 2) * (k - 1))];
                        worst = worst.max((f64::from(*found) + image.middle() - wanted).abs());
                    }
                }
            }
            // Coefficients of noise are up to 27 times as large as it, rounded and cut off along
            // three axes.
            assert!(worst < 1e-5, "{size:?}: {worst}");
        }
    }

    #[test]
    fn rows_go_on_as_their_reflection_at_a_point() {
        let row = [1.0_f32, 4.0, 2.0];
        let value = |i: isize| {
            let Reflected { at, sign, first, last } = reflected(i, 3);
            sign * row[at] + first * row[0] + last * row[2]
        };
        let found: Vec<f32> = (-5..=6).map(value).collect();
        let wanted: Vec<f32> = (-5..=6).map(|i| direct(&row, i)).collect();
        assert_eq!(found, wanted);
    }

    /// The definition, without its closed form.
    fn direct(row: &[f32; 3], i: isize) -> f32 {
        match i {
            0..=2 => row[i as usize],
            ..0 => 2.0 * row[0] - direct(row, -i),
            _ => 2.0 * row[2] - direct(row, 4 - i),
        }
    }
}
