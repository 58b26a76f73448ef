//! Eigenvalues and eigenvectors of symmetric 3×3 matrices.

use crate::math::Sym3;
use glam::DVec3;

/// Most sweeps of Jacobi's method. It converges quadratically; five sweeps give a 3×3 matrix all
/// its digits.
const SWEEPS: usize = 12;

/// Eigenvalues in ascending order and their unit eigenvectors, by Jacobi rotations (Golub & Van
/// Loan, "Matrix Computations", §8.5).
///
/// The method is accurate for any ratio of eigenvalues and uses only +, −, ×, ÷ and √, so its
/// results have the same bits everywhere. If an entry of the matrix is not finite, neither are the
/// eigenvalues.
pub(super) fn symmetric(m: &Sym3<f64>) -> ([f64; 3], [DVec3; 3]) {
    let mut a = [[m.xx, m.xy, m.xz], [m.xy, m.yy, m.yz], [m.xz, m.yz, m.zz]];
    let mut v = [DVec3::X, DVec3::Y, DVec3::Z];
    for _ in 0..SWEEPS {
        if a[0][1] == 0.0 && a[0][2] == 0.0 && a[1][2] == 0.0 {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            rotate(&mut a, &mut v, p, q);
        }
    }
    let mut order = [0, 1, 2];
    crate::math::sort_few(&mut order, |&i, &j| a[i][i] < a[j][j]);
    (order.map(|i| a[i][i]), order.map(|i| v[i]))
}

/// Applies the rotation in the plane of axes p and q that makes entry (p, q) zero.
fn rotate(a: &mut [[f64; 3]; 3], v: &mut [DVec3; 3], p: usize, q: usize) {
    let off = a[p][q];
    if off == 0.0 {
        return;
    }
    // t is the smaller root of t² + 2τt − 1. For a large τ it underflows to 0, which is correct.
    let tau = (a[q][q] - a[p][p]) / (2.0 * off);
    let t = 1.0_f64.copysign(tau) / (tau.abs() + (1.0 + tau * tau).sqrt());
    let c = 1.0 / (1.0 + t * t).sqrt();
    let s = t * c;
    let r = 3 - p - q;
    let (arp, arq) = (a[r][p], a[r][q]);
    a[p][p] -= t * off;
    a[q][q] += t * off;
    a[p][q] = 0.0;
    a[q][p] = 0.0;
    a[r][p] = c * arp - s * arq;
    a[p][r] = a[r][p];
    a[r][q] = s * arp + c * arq;
    a[q][r] = a[r][q];
    (v[p], v[q]) = (c * v[p] - s * v[q], s * v[p] + c * v[q]);
}

#[cfg(test)]
mod tests {
    use super::symmetric;
    use crate::math::Sym3;
    use rand_core::{Rng as _, SeedableRng as _};

    #[test]
    fn eigenvectors_are_what_they_say() {
        let mut random = rand_pcg::Pcg32::seed_from_u64(7);
        let mut next = || f64::from(random.next_u32()) / f64::from(u32::MAX) - 0.5;
        for k in 0..1000 {
            let scale = 10.0_f64.powi(k % 9 - 4);
            let [xx, xy, xz, yy, yz, zz] = std::array::from_fn(|_| scale * next());
            // Some matrices have rank 1.
            let m =
                if k % 10 == 0 { Sym3 { xx, ..Sym3::default() } } else { Sym3 { xx, xy, xz, yy, yz, zz } };
            let (values, vectors) = symmetric(&m);
            assert!(values[0] <= values[1] && values[1] <= values[2], "{values:?}");
            for (i, (value, vector)) in values.iter().zip(&vectors).enumerate() {
                assert!(
                    (m.apply(*vector) - *value * *vector).length() < 1e-14 * scale,
                    "{m:?}: {value} {vector}"
                );
                for (j, other) in vectors.iter().enumerate() {
                    let dot = vector.dot(*other);
                    assert!((dot - f64::from(u8::from(i == j))).abs() < 1e-14, "{m:?}");
                }
            }
        }
    }
}
