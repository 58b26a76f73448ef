//! The particles around a parent of the uniform front, processed four at a time: second fundamental
//! form, nearest particle, sheet test.

use crate::sampler::neighbours::constants::CHUNK;
use crate::sampler::sheet::{MAX_LIFT, MAX_RISE_SQ};
use glam::{Vec3, Vec4};

/// Particles within this many radii of a parent enter the fit of its curvature. The six ideal
/// neighbours are at 2, the next ring at 3.46.
const RING: f32 = 2.6;

/// Weight of the prior "equal curvature in all directions" in the fit. It decides where the
/// neighbours determine no curvature, and hardly matters elsewhere.
const ISOTROPY: f32 = 0.005;

/// The particles around a parent: offset x, y, z from the parent, normal x, y, z, and whether the
/// particle is final.
#[derive(Clone, Debug, Default)]
pub(crate) struct Surroundings {
    len: usize,
    chunks: Vec<[[f32; CHUNK]; 7]>,
}

/// Second fundamental form in a frame (u, w): the normal turns by `[a b; b c] · offset`.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SecondForm {
    pub(crate) a: f32,
    pub(crate) b: f32,
    pub(crate) c: f32,
}

impl Surroundings {
    pub(crate) fn clear(&mut self) {
        self.len = 0;
    }

    // As a call it costs a run on the ellipsoid 2 % more instructions.
    #[inline(always)]
    pub(crate) fn push(&mut self, offset: Vec3, normal: Vec3, is_final: bool) {
        let (chunk, lane) = (self.len / CHUNK, self.len % CHUNK);
        if chunk == self.chunks.len() {
            self.chunks.push([[0.0; CHUNK]; 7]);
        }
        let columns = &mut self.chunks[chunk];
        if lane == 0 {
            // Lanes without a particle are infinitely far and have no normal.
            let (far, none) = ([f32::INFINITY; CHUNK], [0.0; CHUNK]);
            *columns = [far, far, far, none, none, none, none];
        }
        let tells = f32::from(u8::from(is_final));
        let values = [offset.x, offset.y, offset.z, normal.x, normal.y, normal.z, tells];
        for (column, value) in columns.iter_mut().zip(values) {
            column[lane] = value;
        }
        self.len += 1;
    }

    fn chunks(&self) -> impl Iterator<Item = [Vec4; 7]> {
        let lanes = Vec4::from_array;
        self.chunks[..self.len.div_ceil(CHUNK)].iter().map(move |&[x, y, z, mx, my, mz, tells]| {
            [lanes(x), lanes(y), lanes(z), lanes(mx), lanes(my), lanes(mz), lanes(tells)]
        })
    }

    /// Whether any of the particles is [doubtful](crate::sampler::sheet::SheetRule::is_doubtful)
    /// for a parent with the unit normal `normal`.
    pub(crate) fn are_doubtful(&self, normal: Vec3, spacing: f32) -> bool {
        let unit = 1.0 / (spacing * spacing);
        // The lift is half of what is summed here.
        let limit = (2.0 * MAX_LIFT * spacing) * (2.0 * MAX_LIFT * spacing);
        self.chunks().any(|[x, y, z, mx, my, mz, _]| {
            let along = mx * normal.x + my * normal.y + mz * normal.z;
            let lift = x * (normal.x + mx) + y * (normal.y + my) + z * (normal.z + mz);
            let share = (x * x + y * y + z * z) * unit;
            let cube = share * share * share;
            let growth = Vec4::select(cube.cmpgt(Vec4::ONE), cube, Vec4::ONE);
            (along.cmpgt(Vec4::ZERO) & (lift * lift).cmpgt(growth * limit)).any()
        })
    }

    /// Least-squares fit of the second fundamental form to the normals of the final particles
    /// within [`RING`] radii of the parent, whose normal is `n`.
    pub(crate) fn fit_second_form(&self, radius: f32, n: Vec3, u: Vec3, w: Vec3) -> SecondForm {
        let reach_sq = Vec4::splat((RING * radius) * (RING * radius));
        let [mut xx, mut xy, mut yy, mut xp, mut yp, mut xq, mut yq] = [Vec4::ZERO; 7];
        for [x, y, z, mx, my, mz, tells] in self.chunks() {
            let (tx, ty, tz) = (mx - n.x, my - n.y, mz - n.z);
            // A normal that differs by more than 60° belongs to another sheet or lies beyond a
            // crease: it says nothing about the curvature.
            let is_told = tells.cmpgt(Vec4::ZERO)
                & (x * x + y * y + z * z).cmple(reach_sq)
                & (tx * tx + ty * ty + tz * tz).cmple(Vec4::ONE);
            let told = |value: Vec4| Vec4::select(is_told, value, Vec4::ZERO);
            let (p, q) = (told(tx * u.x + ty * u.y + tz * u.z), told(tx * w.x + ty * w.y + tz * w.z));
            let (x, y) = (told(x * u.x + y * u.y + z * u.z), told(x * w.x + y * w.y + z * w.z));
            xx += x * x;
            xy += x * y;
            yy += y * y;
            xp += x * p;
            yp += y * p;
            xq += x * q;
            yq += y * q;
        }
        let [xx, xy, yy, xp, yp, xq, yq] =
            [xx, xy, yy, xp, yp, xq, yq].map(|sum| (sum.x + sum.y) + (sum.z + sum.w));
        let prior = ISOTROPY * (xx + yy);
        // Normal equations of a x + b y = p, b x + c y = q with the prior (a − c)² + b², solved by
        // Cramer's rule.
        let (m11, m12, m13) = (xx + prior, xy, -prior);
        let (m22, m23, m33) = (xx + yy + prior, xy, yy + prior);
        let (r1, r2, r3) = (xp, yp + xq, yq);
        let (c11, c12, c13) = (m22 * m33 - m23 * m23, m13 * m23 - m12 * m33, m12 * m23 - m13 * m22);
        let determinant = m11 * c11 + m12 * c12 + m13 * c13;
        let (c22, c23, c33) = (m11 * m33 - m13 * m13, m12 * m13 - m11 * m23, m11 * m22 - m12 * m12);
        let inverse = 1.0 / determinant;
        let form = SecondForm {
            a: (c11 * r1 + c12 * r2 + c13 * r3) * inverse,
            b: (c12 * r1 + c22 * r2 + c23 * r3) * inverse,
            c: (c13 * r1 + c23 * r2 + c33 * r3) * inverse,
        };
        if form.a.is_finite() && form.b.is_finite() && form.c.is_finite() {
            form
        } else {
            SecondForm::default()
        }
    }

    /// Squared distance from `offset` to the nearest particle on the sheet of a point whose normal
    /// has the direction of `normal`, of whatever length; and to the nearest of any sheet.
    pub(crate) fn nearest_sq(&self, offset: Vec3, normal: Vec3, slack_sq: f32) -> (f32, f32) {
        let max_rise_sq = MAX_RISE_SQ * normal.length_squared();
        let far = Vec4::splat(f32::INFINITY);
        let (mut nearest, mut any) = (far, far);
        for [x, y, z, mx, my, mz, _] in self.chunks() {
            let (dx, dy, dz) = (x - offset.x, y - offset.y, z - offset.z);
            let distance_sq = dx * dx + dy * dy + dz * dz;
            let rise = dx * normal.x + dy * normal.y + dz * normal.z;
            let along = mx * normal.x + my * normal.y + mz * normal.z;
            // In lanes without a particle, which may hold a NaN, this is false.
            let is_same =
                along.cmpgt(Vec4::ZERO) & (rise * rise).cmple((distance_sq + slack_sq) * max_rise_sq);
            any = any.min(distance_sq);
            nearest = nearest.min(Vec4::select(is_same, distance_sq, far));
        }
        (nearest.min_element(), any.min_element())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampler::sheet::{PointPair, SheetRule};
    use rand_core::{Rng, SeedableRng};
    use rand_pcg::Pcg32;

    #[test]
    fn four_at_a_time_are_doubtful_where_one_of_them_is() {
        let mut random = Pcg32::seed_from_u64(3);
        let mut number = |size: f32| size * (random.next_u32() as f32 / u32::MAX as f32 - 0.5);
        let (spacing, mut doubtful) = (0.2, 0);
        for case in 0..4_000 {
            let mut vector = |size: f32| Vec3::new(number(size), number(size), number(size));
            let normal = (Vec3::Z + vector(0.5)).normalize_or(Vec3::Z);
            let mut around = Surroundings::default();
            let mut expected = false;
            for k in 0..1 + case % 7 {
                let offset = vector(4.0 * spacing) * Vec3::new(1.0, 1.0, 0.02);
                // Now and then one that faces the other way, which is never doubtful.
                let other = (normal + vector(0.1)).normalize_or(normal) * if k % 3 == 2 { -1.0 } else { 1.0 };
                let offset = offset - normal * offset.dot(normal) * 0.98;
                around.push(offset, other, true);
                let is_one = SheetRule::default().is_doubtful(PointPair { offset, normal, other }, spacing);
                expected |= is_one && other.dot(normal) > 0.0;
            }
            assert_eq!(around.are_doubtful(normal, spacing), expected, "case {case}");
            doubtful += u32::from(expected);
        }
        assert!((100..3_900).contains(&doubtful), "{doubtful} of 4,000 cases are doubtful");
    }
}
