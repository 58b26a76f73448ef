//! Centres and coefficients, their encoding as bytes, and the field in double precision.

use super::border::{Ball, Border};
use crate::field::Jet;
use crate::math::{Bounds, Sym3};
use core::array;
use glam::{DVec3, Vec3};

/// First bytes of the encoding, with its version.
const MAGIC: [u8; 8] = *b"mp-hrbf1";
/// First bytes of the encoding of centres with a border.
const MAGIC_WITH_BORDER: [u8; 8] = *b"mp-hrbf2";
/// Number of doubles of a ball of the border: centre, radius.
const OF_BALL: usize = 4;
/// Number of doubles per centre: position, α, β.
const NUMBERS: usize = 7;
/// Number of points that are evaluated together in double precision: two SIMD registers of
/// WebAssembly, one of AVX.
const QUAD: usize = 4;

/// Centres and coefficients of f(x) = Σ αⱼ φ(|x − cⱼ|) + βⱼ · ∇φ(x − cⱼ) with φ(r) = r³. The three
/// lists have equal lengths. The border of the points is included if the surface continues beyond
/// it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RbfData {
    /// Centres cⱼ.
    pub centres: Vec<[f64; 3]>,
    /// Coefficients αⱼ.
    pub alpha: Vec<f64>,
    /// Coefficients βⱼ.
    pub beta: Vec<[f64; 3]>,
    /// The border of the points, if the surface continues beyond it.
    pub border: Option<Border>,
}

/// Why the data does not describe a field.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DataError {
    /// There is no centre.
    #[error("a field needs at least one centre")]
    Empty,
    /// The lengths of the lists differ.
    #[error("{centres} centres with {alpha} and {beta} coefficients")]
    Lengths {
        /// Length of the list of centres.
        centres: usize,
        /// Length of the list of α.
        alpha: usize,
        /// Length of the list of β.
        beta: usize,
    },
    /// A number is not finite.
    #[error("centre {index} or its coefficients are not finite")]
    NotFinite {
        /// Index of the centre.
        index: usize,
    },
    /// A pull tears the surface, or one of its numbers is not finite.
    #[error("pull {index} is not finite or longer than half its reach")]
    Pull {
        /// Index of the pull.
        index: usize,
    },
    /// The bytes are of another kind, version or length.
    #[error("these bytes are not the centres and coefficients of a field")]
    Bytes,
}

impl RbfData {
    /// Checks that the lists have equal lengths and are not empty, and that all numbers are finite.
    ///
    /// # Errors
    ///
    /// The first [`DataError`] that is found.
    pub fn check(&self) -> Result<(), DataError> {
        let (centres, alpha, beta) = (self.centres.len(), self.alpha.len(), self.beta.len());
        if centres != alpha || centres != beta {
            return Err(DataError::Lengths { centres, alpha, beta });
        }
        if centres == 0 {
            return Err(DataError::Empty);
        }
        match (0..centres).find(|&j| !self.numbers(j).iter().all(|number| number.is_finite())) {
            Some(index) => Err(DataError::NotFinite { index }),
            None => Ok(()),
        }
    }

    /// Numbers of centre `j`, in the order of the encoding.
    fn numbers(&self, j: usize) -> [f64; NUMBERS] {
        let ([x, y, z], a, [u, v, w]) = (self.centres[j], self.alpha[j], self.beta[j]);
        [x, y, z, a, u, v, w]
    }

    /// Encodes the data as bytes: eight magic bytes, then seven little-endian doubles per centre.
    /// Before the centres come the numbers of the border, if there is one: the number of its balls,
    /// the corners of its box, and four doubles per ball.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut numbers = Vec::new();
        if let Some(border) = &self.border {
            numbers.push(border.balls().len() as f64);
            numbers.extend(border.bounds().min.into_iter().chain(border.bounds().max));
            for Ball { centre, radius } in border.balls() {
                numbers.extend([centre.x, centre.y, centre.z, *radius]);
            }
        }
        numbers.extend((0..self.centres.len()).flat_map(|j| self.numbers(j)));
        let magic = if self.border.is_some() { MAGIC_WITH_BORDER } else { MAGIC };
        magic.into_iter().chain(numbers.into_iter().flat_map(f64::to_le_bytes)).collect()
    }

    /// Decodes and checks bytes from [`RbfData::to_bytes`].
    ///
    /// # Errors
    ///
    /// If the bytes have another format, or if the data fails [`RbfData::check`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, DataError> {
        let (magic, body) = bytes.split_first_chunk().ok_or(DataError::Bytes)?;
        let (numbers, rest) = body.as_chunks::<{ size_of::<f64>() }>();
        let numbers: Vec<f64> = numbers.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
        let (border, numbers) = match *magic {
            MAGIC => (None, numbers.as_slice()),
            MAGIC_WITH_BORDER => border_of(&numbers).ok_or(DataError::Bytes)?,
            _ => return Err(DataError::Bytes),
        };
        let (rows, short) = numbers.as_chunks::<NUMBERS>();
        if !rest.is_empty() || !short.is_empty() {
            return Err(DataError::Bytes);
        }
        let mut data = Self { border, ..Self::default() };
        for &[x, y, z, a, u, v, w] in rows {
            data.centres.push([x, y, z]);
            data.alpha.push(a);
            data.beta.push([u, v, w]);
        }
        data.check()?;
        Ok(data)
    }

    /// f, ∇f and ∇∇f at `p`, summed over the centres in order. At a centre its own term counts as
    /// zero.
    #[must_use]
    pub fn jet(&self, p: DVec3) -> Jet {
        let mut value = 0.0;
        let mut gradient = DVec3::ZERO;
        let [mut xx, mut xy, mut xz, mut yy, mut yz, mut zz] = [0.0; 6];
        for j in 0..self.centres.len() {
            let d = p - DVec3::from_array(self.centres[j]);
            let r = d.length();
            if r == 0.0 {
                continue;
            }
            let (alpha, beta) = (self.alpha[j], DVec3::from_array(self.beta[j]));
            let (u, along) = (d / r, beta.dot(d));
            value += r * (alpha * r * r + 3.0 * along);
            gradient += 3.0 * (alpha * r + along / r) * d + 3.0 * r * beta;
            // ∇∇(β·∇φ) = 3 ((β·u)(I − u uᵀ) + β uᵀ + u βᵀ) with u = d/r.
            let slope = beta.dot(u);
            let (identity, outer) = (3.0 * (alpha * r + slope), 3.0 * (alpha * r - slope));
            let entry = |a: usize, b: usize| outer * u[a] * u[b] + 3.0 * (beta[a] * u[b] + u[a] * beta[b]);
            xx += identity + entry(0, 0);
            xy += entry(0, 1);
            xz += entry(0, 2);
            yy += identity + entry(1, 1);
            yz += entry(1, 2);
            zz += identity + entry(2, 2);
        }
        Jet { value, gradient, hessian: Sym3 { xx, xy, xz, yy, yz, zz } }
    }

    /// f and ∇f at `p`, equal to those of [`RbfData::jet`].
    pub(super) fn slope(&self, p: DVec3) -> (f64, DVec3) {
        let mut value = 0.0;
        let mut gradient = DVec3::ZERO;
        let coefficients = self.alpha.iter().zip(&self.beta);
        for (&centre, (&alpha, &beta)) in self.centres.iter().zip(coefficients) {
            let d = p - DVec3::from_array(centre);
            let r = d.length();
            if r == 0.0 {
                continue;
            }
            let beta = DVec3::from_array(beta);
            let along = beta.dot(d);
            value += r * (alpha * r * r + 3.0 * along);
            gradient += 3.0 * (alpha * r + along / r) * d + 3.0 * r * beta;
        }
        (value, gradient)
    }

    /// f and ∇f at each of `points`, relative to `origin`, four at a time, equal to those of
    /// [`RbfData::jet`] up to rounding.
    pub(super) fn gradients(
        &self,
        origin: DVec3,
        points: &[Vec3],
        value: &mut [f64],
        gradient: &mut [DVec3],
    ) {
        for ((points, value), gradient) in
            points.chunks(QUAD).zip(value.chunks_mut(QUAD)).zip(gradient.chunks_mut(QUAD))
        {
            let last = points.len() - 1;
            let sums = self.sums(
                &[0, 1, 2]
                    .map(|axis| array::from_fn(|k| origin[axis] + f64::from(points[k.min(last)][axis]))),
            );
            for k in 0..points.len() {
                value[k] = sums[0][k];
                gradient[k] = DVec3::new(sums[1][k], sums[2][k], sums[3][k]);
            }
        }
    }

    /// f and the entries of ∇f at four points.
    // Not inlined, for the SIMD registers: inlined, it takes half as many instructions again.
    #[inline(never)]
    fn sums(&self, [x, y, z]: &[[f64; QUAD]; 3]) -> [[f64; QUAD]; 4] {
        let mut sums = [[0.0; QUAD]; 4];
        let coefficients = self.alpha.iter().zip(&self.beta);
        for ([cx, cy, cz], (alpha, [bx, by, bz])) in self.centres.iter().zip(coefficients) {
            for k in 0..QUAD {
                let (dx, dy, dz) = (x[k] - cx, y[k] - cy, z[k] - cz);
                let square = dx * dx + dy * dy + dz * dz;
                let r = square.sqrt();
                let along = bx * dx + by * dy + bz * dz;
                // At a centre `along` is 0, so the bounded inverse gives the term 0.
                let inverse = 1.0 / if r > 1e-300 { r } else { 1e-300 };
                let common = alpha * r + along * inverse;
                sums[0][k] += r * (alpha * square + 3.0 * along);
                sums[1][k] += 3.0 * (common * dx + r * bx);
                sums[2][k] += 3.0 * (common * dy + r * by);
                sums[3][k] += 3.0 * (common * dz + r * bz);
            }
        }
        sums
    }
}

/// The border at the start of the numbers of an encoding, and the numbers after it.
fn border_of(numbers: &[f64]) -> Option<(Option<Border>, &[f64])> {
    let (&[count, a, b, c, d, e, f], rest) = numbers.split_first_chunk()?;
    let (balls, rest) = rest.split_at_checked(OF_BALL.checked_mul(count as usize)?)?;
    let ball = |&[x, y, z, radius]: &[f64; OF_BALL]| Ball { centre: DVec3::new(x, y, z), radius };
    let balls = balls.as_chunks().0.iter().map(ball).collect();
    Some((Some(Border::new(balls, Bounds { min: [a, b, c], max: [d, e, f] })?), rest))
}
