//! The weights of the cubic B-spline on one cell, and those of its Bézier points.
//!
//! On the cell between voxels m and m + 1 the spline is Σ wⱼ(t) c[m−1+j] over j = 0..4, with t from
//! 0 to 1 (M. Unser, "Splines: A Perfect Fit for Signal and Image Processing", IEEE Signal
//! Processing Magazine 16, 1999).

use core::ops::{Add, Mul, Sub};

/// The number types in which the spline is evaluated.
pub(super) trait Number:
    Copy + From<f32> + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
    /// 1/6, rounded once.
    const SIXTH: Self;
}

impl Number for f32 {
    const SIXTH: Self = 1.0 / 6.0;
}

impl Number for f64 {
    const SIXTH: Self = 1.0 / 6.0;
}

/// The weights of the four coefficients at `t`, for the value, the slope and the second derivative.
#[inline(always)]
pub(super) fn weights<T: Number>(t: T) -> [[T; 4]; 3] {
    let n = |x: f32| T::from(x);
    let (o, t2) = (n(1.0) - t, t * t);
    let (o2, half) = (o * o, n(0.5));
    [
        [
            o2 * o * T::SIXTH,
            (n(3.0) * t2 * t - n(6.0) * t2 + n(4.0)) * T::SIXTH,
            (n(3.0) * o2 * o - n(6.0) * o2 + n(4.0)) * T::SIXTH,
            t2 * t * T::SIXTH,
        ],
        [n(0.0) - half * o2, n(1.5) * t2 - n(2.0) * t, n(2.0) * o - n(1.5) * o2, half * t2],
        [o, n(3.0) * t - n(2.0), n(3.0) * o - n(2.0), t],
    ]
}

/// For each order of derivative, the weights of the Bézier points of the spline over `from..to` in
/// the cell: 4 points for the value, 3 for the slope and 2 for the second derivative. The spline
/// there lies in the hull of these points. They are values of its polar form (L. Ramshaw, "Blossoms
/// Are Polar Forms", Computer Aided Geometric Design 6, 1989).
pub(super) fn bezier_weights(from: f64, to: f64) -> [[[f64; 4]; 4]; 3] {
    let value = |u: f64, v: f64, w: f64| {
        let (e1, e2, e3) = (u + v + w, u * v + u * w + v * w, u * v * w);
        let o3 = (1.0 - u) * (1.0 - v) * (1.0 - w);
        [o3 / 6.0, (3.0 * e3 - 2.0 * e2 + 4.0) / 6.0, (1.0 + e1 + e2 - 3.0 * e3) / 6.0, e3 / 6.0]
    };
    let slope = |u: f64, v: f64| {
        let (e1, e2) = (u + v, u * v);
        let o2 = (1.0 - u) * (1.0 - v);
        [-0.5 * o2, 1.5 * e2 - e1, 0.5 * (1.0 + e1) - 1.5 * e2, 0.5 * e2]
    };
    let bend = |u: f64| [1.0 - u, 3.0 * u - 2.0, 1.0 - 3.0 * u, u];
    let (a, b) = (from, to);
    let none = [0.0; 4];
    [
        [value(a, a, a), value(a, a, b), value(a, b, b), value(b, b, b)],
        [slope(a, a), slope(a, b), slope(b, b), none],
        [bend(a), bend(b), none, none],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The truncated-power form of the B-spline, another one than that of the weights.
    fn b_spline(x: f64) -> f64 {
        let power = |x: f64| if x > 0.0 { x * x * x } else { 0.0 };
        (power(x + 2.0) - 4.0 * power(x + 1.0) + 6.0 * power(x) - 4.0 * power(x - 1.0) + power(x - 2.0)) / 6.0
    }

    #[test]
    fn weights_are_those_of_truncated_powers_and_their_derivatives() {
        for k in 0..=16 {
            let t = f64::from(k) / 16.0;
            let [value, slope, bend] = weights(t);
            for j in 0..4 {
                // Coefficient j lies at j − 1.
                let at = |t: f64| b_spline(t + 1.0 - j as f64);
                assert!((value[j] - at(t)).abs() < 1e-14, "{t} {j}");
                let h = 1e-5;
                assert!((slope[j] - (at(t + h) - at(t - h)) / (2.0 * h)).abs() < 1e-9, "{t} {j}");
                let h = 1e-3;
                let second = (at(t + h) - 2.0 * at(t) + at(t - h)) / (h * h);
                // The third derivative jumps at a knot, so there the difference is off by about h.
                assert!((bend[j] - second).abs() < 2.0 * h, "{t} {j}");
            }
        }
    }

    #[test]
    fn bezier_points_of_a_point_are_the_weights() {
        for k in 0..=16 {
            let t = f64::from(k) / 16.0;
            let (points, weights) = (bezier_weights(t, t), weights(t));
            for (order, count) in [(0, 4), (1, 3), (2, 2)] {
                for point in &points[order][..count] {
                    for (a, b) in point.iter().zip(weights[order]) {
                        assert!((a - b).abs() < 1e-14, "{t} {order}");
                    }
                }
            }
        }
    }
}
