//! The field in single precision: SIMD lanes over points, one centre at a time broadcast to all of them.

use super::{Frame, RbfData};
use crate::math::{LANES, Lanes, Sym3};
use glam::{DVec3, Vec3};

/// Centres per tile: 16 kB, half of a small first-level cache.
const TILE: usize = 512;
/// |d| below this, in local units, counts as this in a divisor: nothing is divided by zero at a centre, and no cube of
/// the reciprocal overflows.
const LEAST_DISTANCE: f32 = 1e-12;

/// A centre with its coefficients in local coordinates, ready for the sums.
#[derive(Clone, Copy, Debug)]
struct Centre {
    place: [f32; 3],
    /// α.
    alpha: f32,
    /// 3 β.
    beta: [f32; 3],
    /// 3 α.
    alpha3: f32,
}

/// The centres in single precision.
#[derive(Clone, Debug)]
pub(super) struct Single {
    centres: Vec<Centre>,
    origin: [f32; 3],
    scale: f32,
}

impl Single {
    pub(super) fn new(data: &RbfData) -> Self {
        let frame = Frame::of(data.centres.iter().map(|&c| DVec3::from_array(c)));
        let scale = frame.scale();
        let centres = (0..data.centres.len())
            .map(|j| {
                // f(x) = g(s (x − o))/s, as in `points::fit`.
                let alpha = data.alpha[j] / (scale * scale);
                Centre {
                    place: frame.local(DVec3::from_array(data.centres[j])).as_vec3().to_array(),
                    alpha: alpha as f32,
                    beta: data.beta[j].map(|b| (3.0 * b / scale) as f32),
                    alpha3: (3.0 * alpha) as f32,
                }
            })
            .collect();
        Self { centres, origin: frame.origin().as_vec3().to_array(), scale: scale as f32 }
    }

    pub(super) fn values(&self, points: &[Vec3], value: &mut [f32]) {
        for (points, value) in points.chunks(LANES).zip(value.chunks_mut(LANES)) {
            let sums = self.sums::<1>(points);
            value.copy_from_slice(&sums[0].0[..points.len()]);
        }
    }

    pub(super) fn gradients(&self, points: &[Vec3], value: &mut [f32], gradient: &mut [Vec3]) {
        let outputs = value.chunks_mut(LANES).zip(gradient.chunks_mut(LANES));
        for (points, (value, gradient)) in points.chunks(LANES).zip(outputs) {
            let sums = self.sums::<4>(points);
            value.copy_from_slice(&sums[0].0[..points.len()]);
            for (k, gradient) in gradient.iter_mut().enumerate() {
                *gradient = Vec3::new(sums[1].0[k], sums[2].0[k], sums[3].0[k]);
            }
        }
    }

    pub(super) fn hessians(
        &self,
        points: &[Vec3],
        value: &mut [f32],
        gradient: &mut [Vec3],
        hessian: &mut [Sym3<f32>],
    ) {
        let outputs = value.chunks_mut(LANES).zip(gradient.chunks_mut(LANES)).zip(hessian.chunks_mut(LANES));
        for (points, ((value, gradient), hessian)) in points.chunks(LANES).zip(outputs) {
            let sums = self.sums::<10>(points);
            value.copy_from_slice(&sums[0].0[..points.len()]);
            for (k, (gradient, hessian)) in gradient.iter_mut().zip(hessian).enumerate() {
                let [_, gx, gy, gz, xx, xy, xz, yy, yz, zz] = sums.map(|sum| sum.0[k]);
                *gradient = Vec3::new(gx, gy, gz);
                *hessian = Sym3 { xx, xy, xz, yy, yz, zz };
            }
        }
    }

    /// The sums over all centres at up to [`LANES`] points: 1 (f), 4 (and ∇f) or 10 (and ∇∇f: xx, xy, xz, yy, yz, zz).
    fn sums<const N: usize>(&self, points: &[Vec3]) -> [Lanes; N] {
        let (scale, last) = (Lanes::splat(self.scale), points.len() - 1);
        let place = [0, 1, 2].map(|axis| {
            let lanes = Lanes(core::array::from_fn(|k| points[k.min(last)][axis]));
            (lanes - Lanes::splat(self.origin[axis])) * scale
        });
        let mut sums = [Lanes::splat(0.0); N];
        for tile in self.centres.chunks(TILE) {
            add_all(&mut sums, tile, &place);
        }
        // Gradients are those of the model; values and second derivatives have units.
        sums[0] = sums[0] * Lanes::splat(1.0 / self.scale);
        for second in sums.iter_mut().skip(4) {
            *second = *second * scale;
        }
        sums
    }
}

/// Adds all the centres' terms. Not inlined: only where lanes go in and out by memory does the compiler keep each of
/// them in registers of its own.
#[inline(never)]
fn add_all<const N: usize>(sums: &mut [Lanes; N], centres: &[Centre], place: &[Lanes; 3]) {
    let mut local = *sums;
    for centre in centres {
        add(&mut local, centre, *place);
    }
    *sums = local;
}

/// Adds one centre's terms.
#[inline(always)]
fn add<const N: usize>(sums: &mut [Lanes; N], centre: &Centre, [x, y, z]: [Lanes; 3]) {
    let [bx, by, bz] = centre.beta.map(Lanes::splat);
    let (dx, dy, dz) = (
        x - Lanes::splat(centre.place[0]),
        y - Lanes::splat(centre.place[1]),
        z - Lanes::splat(centre.place[2]),
    );
    let square = dx * dx + dy * dy + dz * dz;
    let r = square.sqrt();
    let along = bx * dx + by * dy + bz * dz;
    sums[0] += r * (Lanes::splat(centre.alpha) * square + along);
    if N == 1 {
        return;
    }
    let inverse = Lanes::splat(1.0) / r.map(|r| if r > LEAST_DISTANCE { r } else { LEAST_DISTANCE });
    let stretch = Lanes::splat(centre.alpha3) * r;
    let slope = along * inverse;
    let common = stretch + slope;
    sums[1] += dx * common + bx * r;
    sums[2] += dy * common + by * r;
    sums[3] += dz * common + bz * r;
    if N == 4 {
        return;
    }
    // 3 (α r + β·u) I + 3 (α r − β·u) u uᵀ + 3 (β uᵀ + u βᵀ): the last two together are u pᵀ + p uᵀ.
    let (ux, uy, uz) = (dx * inverse, dy * inverse, dz * inverse);
    let half = Lanes::splat(0.5) * (stretch - slope);
    let (px, py, pz) = (half * ux + bx, half * uy + by, half * uz + bz);
    let (two_x, two_y, two_z) = (ux + ux, uy + uy, uz + uz);
    sums[4] += common + two_x * px;
    sums[5] += ux * py + uy * px;
    sums[6] += ux * pz + uz * px;
    sums[7] += common + two_y * py;
    sums[8] += uy * pz + uz * py;
    sums[9] += common + two_z * pz;
}
