//! Evaluation in single precision, in two ways that give the same bits: at one point, with SIMD
//! lanes over the coefficients of a cell's polynomial and over its near centres, and at eight
//! points of one cell, with lanes over the points.
//!
//! Consecutive points of a front or of a relaxation step mostly share a cell, but not all do. Eight
//! together take 5.8 times the instructions of one. If points alone in their cell took eight lanes
//! too, a run on the bunny would take 19 % more.

use super::coefficients::{Centre, DEGREE, Rows};
use crate::math::{LANES, Lanes};

/// Smallest |d| that is divided by, in local units, so that nothing is divided by zero at a centre:
/// far below the rounding of positions, 10⁻⁷.
const LEAST_DISTANCE: f32 = 1e-12;
/// Eight near centres, in lanes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near {
    place: [Lanes; 3],
    /// Coefficients α.
    alpha: Lanes,
    /// Coefficients 3 α.
    alpha3: Lanes,
    /// Coefficients 3 β.
    beta: [Lanes; 3],
}

impl Near {
    /// Packs up to eight centres; the other lanes have the weight 0.
    pub(super) fn new(centres: &[Centre]) -> Self {
        let lanes = |of: &dyn Fn(&Centre) -> f64| {
            Lanes(core::array::from_fn(|k| centres.get(k).map_or(0.0, |centre| of(centre) as f32)))
        };
        Self {
            place: [0, 1, 2].map(|axis| lanes(&|c| c.position[axis])),
            alpha: lanes(&|c| c.alpha),
            alpha3: lanes(&|c| 3.0 * c.alpha),
            beta: [0, 1, 2].map(|axis| lanes(&|c| 3.0 * c.beta[axis])),
        }
    }

    /// Returns centre `k` in every lane.
    // As a call it costs `add_lane` 6 % more instructions.
    #[inline(always)]
    fn splat(&self, k: usize) -> Self {
        let lane = |lanes: &Lanes| Lanes::splat(lanes.0[k]);
        Self {
            place: [lane(&self.place[0]), lane(&self.place[1]), lane(&self.place[2])],
            alpha: lane(&self.alpha),
            alpha3: lane(&self.alpha3),
            beta: [lane(&self.beta[0]), lane(&self.beta[1]), lane(&self.beta[2])],
        }
    }
}

/// A point, and its position in the cell that holds it.
pub(super) struct LocalPoint {
    /// Position in local coordinates.
    pub(super) local: [f32; 3],
    /// Offset from the middle of the cell, in units of its half-width.
    pub(super) offset: [f32; 3],
    /// 1 over the half-width of the cell.
    pub(super) inverse: f32,
}

/// Returns f and ∇f, and for `N` = 10 also ∇∇f (xx, xy, xz, yy, yz, zz), in local units.
///
/// The functions that it calls are not inlined: the compiler keeps lanes in registers only if they
/// enter and leave through memory. Inlining them and those of [`sums_of_eight`] makes a uniform run
/// on the bunny take 39 % more instructions.
pub(super) fn sums<const N: usize>(rows: &Rows, near: &[Near], point: &LocalPoint) -> [f32; N] {
    let [x, y, z] = point.offset.map(Lanes::splat);
    let mut planes = [Lanes::splat(0.0); 6];
    polynomial::<N>(&mut planes, rows, &x, &z);
    let mut sums = [Lanes::splat(0.0); N];
    weigh(&mut sums, &planes, &powers(y.0[0]), point.inverse);
    if !near.is_empty() {
        add(&mut sums, near, &point.local.map(Lanes::splat));
    }
    sums.map(Lanes::sum)
}

/// Evaluates the polynomial and its derivatives by x and z by Horner's rule along both: f, ∂x, ∂z,
/// ½ ∂xx, ∂xz, ½ ∂zz. The lanes hold the powers of y, which are still to be summed.
// Not inlined, for the registers: see `sums`.
#[inline(never)]
fn polynomial<const N: usize>(planes: &mut [Lanes; 6], rows: &Rows, x: &Lanes, z: &Lanes) {
    let (x, z) = (*x, *z);
    let mut nested = *planes;
    let mut rest = rows.as_slice();
    for i in (0..=DEGREE).rev() {
        let (plane, others) = rest.split_at(DEGREE - i + 1);
        rest = others;
        nest::<N>(&mut nested, x, z, plane.iter().copied());
    }
    *planes = nested;
}

/// Does one step of Horner's rule along z. `row` are the coefficients of the polynomial in x of the
/// next smaller power of z, from the largest power of x down.
// Inlined, so that the lanes stay in registers from call to call.
#[inline(always)]
fn nest<const N: usize>(planes: &mut [Lanes; 6], x: Lanes, z: Lanes, row: impl Iterator<Item = Lanes>) {
    let [mut f, mut fx, mut fz, mut fxx, mut fxz, mut fzz] = *planes;
    let [mut value, mut first, mut second] = [Lanes::splat(0.0); 3];
    for coefficient in row {
        if N == 10 {
            second = second * x + first;
        }
        first = first * x + value;
        value = value * x + coefficient;
    }
    if N == 10 {
        fzz = fzz * z + fz;
        fxz = fxz * z + fx;
        fxx = fxx * z + second;
    }
    fz = fz * z + f;
    fx = fx * z + first;
    f = f * z + value;
    *planes = [f, fx, fz, fxx, fxz, fzz];
}

/// Returns yʲ in lane j.
// Not inlined, for the registers: see `sums`.
#[inline(never)]
fn powers(y: f32) -> Lanes {
    let mut power = [1.0; LANES];
    for j in 1..LANES {
        power[j] = power[j - 1] * y;
    }
    Lanes(power)
}

/// Returns j yʲ⁻¹ in lane j, from yʲ.
fn slope(power: Lanes) -> Lanes {
    Lanes(core::array::from_fn(|j| if j < 1 { 0.0 } else { j as f32 * power.0[j - 1] }))
}

/// Multiplies the planes by the powers of y, and turns derivatives by the offset into derivatives
/// by the position.
// Not inlined, for the registers: see `sums`.
#[inline(never)]
fn weigh<const N: usize>(sums: &mut [Lanes; N], planes: &[Lanes; 6], powers: &Lanes, inverse: f32) {
    let [f, fx, fz, fxx, fxz, fzz] = *planes;
    let mut power = *powers;
    sums[0] = f * power;
    let inverse = Lanes::splat(inverse);
    power = power * inverse;
    let mut first = slope(power);
    sums[1] = fx * power;
    sums[2] = f * first;
    sums[3] = fz * power;
    if N == 4 {
        return;
    }
    (power, first) = (power * inverse, first * inverse);
    sums[4] = (fxx + fxx) * power;
    sums[5] = fx * first;
    sums[6] = fxz * power;
    sums[7] = f * slope(first);
    sums[8] = fz * first;
    sums[9] = (fzz + fzz) * power;
}

/// Adds the terms of near centres.
// Not inlined, for the registers: see `sums`.
#[inline(never)]
fn add<const N: usize>(sums: &mut [Lanes; N], centres: &[Near], place: &[Lanes; 3]) {
    let mut local = *sums;
    let place = *place;
    for near in centres {
        add_term(&mut local, &place, near);
    }
    *sums = local;
}

/// Adds the terms of eight centres, lane by lane.
// Inlined, so that the lanes stay in registers from call to call.
#[inline(always)]
fn add_term<const N: usize>(sums: &mut [Lanes; N], &[x, y, z]: &[Lanes; 3], near: &Near) {
    let ([cx, cy, cz], [bx, by, bz]) = (near.place, near.beta);
    let (dx, dy, dz) = (x - cx, y - cy, z - cz);
    let square = dx * dx + dy * dy + dz * dz;
    let r = square.sqrt();
    let along = bx * dx + by * dy + bz * dz;
    sums[0] += r * (near.alpha * square + along);
    let inverse = Lanes::splat(1.0) / r.map(|r| if r > LEAST_DISTANCE { r } else { LEAST_DISTANCE });
    let stretch = near.alpha3 * r;
    let slope = along * inverse;
    let common = stretch + slope;
    sums[1] += dx * common + bx * r;
    sums[2] += dy * common + by * r;
    sums[3] += dz * common + bz * r;
    if N == 4 {
        return;
    }
    // 3 (α r + β·u) I + 3 (α r − β·u) u uᵀ + 3 (β uᵀ + u βᵀ): the last two together are u pᵀ + p
    // uᵀ.
    let (ux, uy, uz) = (dx * inverse, dy * inverse, dz * inverse);
    let half = Lanes::splat(0.5) * (stretch - slope);
    let (px, py, pz) = (half * ux + bx, half * uy + by, half * uz + bz);
    sums[4] += common + (ux + ux) * px;
    sums[5] += ux * py + uy * px;
    sums[6] += ux * pz + uz * px;
    sums[7] += common + (uy + uy) * py;
    sums[8] += uy * pz + uz * py;
    sums[9] += common + (uz + uz) * pz;
}

/// Does what [`sums`] does for eight points of one cell, with the same bits.
///
/// The lanes are the points here. The eight lanes of [`sums`] are eight partial sums, which are
/// added in the same order.
pub(super) fn sums_of_eight<const N: usize>(
    rows: &Rows,
    near: &[Near],
    centres: usize,
    points: &LocalPoints,
    inverse: f32,
) -> [Lanes; N] {
    let mut sums = [[Lanes::splat(0.0); N]; LANES];
    expand(&mut sums, rows, &points.offset, inverse);
    for (k, sums) in sums.iter_mut().enumerate() {
        add_lane(sums, near, k, centres, &points.local);
    }
    core::array::from_fn(|n| {
        let v = |k: usize| sums[k][n];
        ((v(0) + v(4)) + (v(2) + v(6))) + ((v(1) + v(5)) + (v(3) + v(7)))
    })
}

/// Eight points of one cell, as [`LocalPoint`] has one.
pub(super) struct LocalPoints {
    pub(super) local: [Lanes; 3],
    pub(super) offset: [Lanes; 3],
}

/// Evaluates the polynomial's part of each partial sum, as [`polynomial`] and [`weigh`] do.
// Not inlined, for the registers: see `sums`.
#[inline(never)]
fn expand<const N: usize>(sums: &mut [[Lanes; N]; LANES], rows: &Rows, offset: &[Lanes; 3], inverse: f32) {
    let [x, y, z] = *offset;
    let inverse = Lanes::splat(inverse);
    // These are yʲ, and the weights of the first two derivatives by the position for the power
    // before.
    let mut power = Lanes::splat(1.0);
    let [mut power_before, mut first_before] = [Lanes::splat(0.0); 2];
    for (j, sums) in sums.iter_mut().enumerate() {
        let mut planes = [Lanes::splat(0.0); 6];
        for i in (0..=DEGREE - j).rev() {
            // The rows of this power of z come after those of larger powers.
            let last = (DEGREE - i + 1) * (DEGREE - i + 2) / 2;
            let row = rows[last - (DEGREE - i - j + 1)..last].iter();
            nest::<N>(&mut planes, x, z, row.map(|row| Lanes::splat(row.0[j])));
        }
        let [f, fx, fz, fxx, fxz, fzz] = planes;
        sums[0] = f * power;
        let scaled = power * inverse;
        let first = Lanes::splat(j as f32) * power_before;
        sums[1] = fx * scaled;
        sums[2] = f * first;
        sums[3] = fz * scaled;
        power_before = scaled;
        if N == 10 {
            let (scaled, first) = (scaled * inverse, first * inverse);
            sums[4] = (fxx + fxx) * scaled;
            sums[5] = fx * first;
            sums[6] = fxz * scaled;
            sums[7] = f * (Lanes::splat(j as f32) * first_before);
            sums[8] = fz * first;
            sums[9] = (fzz + fzz) * scaled;
            first_before = first;
        }
        power = power * y;
    }
}

/// Adds the terms of every eighth centre, from centre `k` on, to eight points.
// Not inlined, for the registers: see `sums`.
#[inline(never)]
fn add_lane<const N: usize>(
    sums: &mut [Lanes; N],
    near: &[Near],
    k: usize,
    centres: usize,
    place: &[Lanes; 3],
) {
    let mut local = *sums;
    let place = *place;
    for near in near.iter().take((centres + LANES - 1 - k) / LANES) {
        add_term(&mut local, &place, &near.splat(k));
    }
    *sums = local;
}
