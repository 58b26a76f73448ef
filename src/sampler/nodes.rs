//! Points of the surface where f has no gradient: cone points, cusps, and the curves on which a surface crosses itself.
//!
//! # Why a box around one can be left out of the search
//!
//! Let B be a box in the interior of which f has no local extremum. Then every connected piece of the surface S in B reaches
//! the boundary of B. For suppose that a piece K does not. It has a neighbourhood U in B on whose boundary f is not 0; take the
//! part of U that holds K, and with it the holes in it: an open set W with a connected boundary, on which f has one sign, say
//! the positive one. Every neighbourhood of a point of K holds places where f is negative, else that point were a minimum. So f
//! has a negative minimum in W: a local extremum.
//!
//! There is none where the second derivative of f along one fixed direction is positive throughout B, and along another one
//! negative: at a minimum neither is negative, at a maximum neither positive. This is so around a cone point, whose tangent
//! cone is that of an indefinite quadratic form, up to a size that bounds of the second derivatives tell.

use crate::field::{Enclosure, Field};
use crate::math::Sym3;
use glam::{DMat3, DVec3};

/// Sizes of a box around a singular point that are tried: the largest is this share of the longest side of the whole box, each
/// of the others half of the one before it.
const LARGEST: f64 = 0.25;
const SIZES: usize = 9;
/// How far the sides of such a box are from the point, in units of its size: not equally, because where they are, symmetric
/// surfaces have more of their highest points in one place than can be told apart.
const BELOW: DVec3 = DVec3::new(0.967, 0.983, 0.941);
const ABOVE: DVec3 = DVec3::new(0.953, 0.929, 0.991);

/// Most Newton steps to a singular point: at a cusp each only halves the distance.
const MOST_STEPS: u32 = 24;
/// Most that f may be there, in what its second derivatives make of it over the distance to the point; far above what
/// rounding leaves of a zero.
const LARGEST_VALUE: f64 = 1e-8;
/// Where the second derivatives along a direction are smaller than this share of the largest, a singular point is looked for
/// across that direction only.
const SMALL: f64 = 1e-6;

/// A point near `start`, not farther than `reach`, where f and its gradient vanish; found by Newton's method on the gradient.
pub(super) fn singular_point(field: &mut dyn Field, start: DVec3, reach: f64) -> Option<DVec3> {
    let mut p = start;
    // False for NaN.
    let is_near = |offset: DVec3| offset.length_squared() <= reach * reach;
    for _ in 0..MOST_STEPS {
        let jet = field.jet(p);
        let hessian = matrix(&jet.hessian);
        let size_sq = size_sq(&hessian);
        // The least squares solution of H δ = −∇f, which does not run along a curve of such points.
        let normal = hessian * hessian + DMat3::from_diagonal(DVec3::splat(SMALL * SMALL * size_sq));
        let step = normal.inverse() * (hessian * jet.gradient);
        p -= step;
        if !is_near(step) || !is_near(p - start) {
            return None;
        }
        if step.length_squared() <= 1e-24 * reach * reach {
            break;
        }
    }
    let jet = field.jet(p);
    let size = size_sq(&matrix(&jet.hessian)).sqrt();
    let vanishes = jet.value.abs() <= LARGEST_VALUE * size * reach * reach
        && jet.gradient.length() <= LARGEST_VALUE.sqrt() * size * reach;
    vanishes.then_some(p)
}

fn matrix(h: &Sym3<f64>) -> DMat3 {
    DMat3::from_cols_array(&[h.xx, h.xy, h.xz, h.xy, h.yy, h.yz, h.xz, h.yz, h.zz])
}

fn size_sq(m: &DMat3) -> f64 {
    m.to_cols_array().iter().map(|entry| entry * entry).sum()
}

/// The largest of a number of boxes around the singular point `at` of one part of the field in which that part has no local
/// extremum, in the box from `lo` to `hi` and away from those `taken`.
pub(super) fn isolating_box(
    field: &mut dyn Field,
    part: usize,
    at: DVec3,
    [lo, hi]: [DVec3; 2],
    taken: &[[DVec3; 2]],
) -> Option<[DVec3; 2]> {
    let mut boxes = [[at; 2]; SIZES + 1];
    let mut size = LARGEST * (hi - lo).max_element();
    for around in &mut boxes[1..] {
        *around = [at - size * BELOW, at + size * ABOVE];
        size *= 0.5;
    }
    let mut known = [Enclosure::UNKNOWN; SIZES + 1];
    let mut second = [[[0.0; 2]; 6]; SIZES + 1];
    field.enclose(part, &boxes, &mut known);
    field.enclose_second(part, &boxes, &mut second);
    let here = second[0].map(|[lo, hi]| 0.5 * (lo + hi));
    let [up, down] = extreme_directions(here)?;
    (1..=SIZES).find_map(|k| {
        let [bottom, top] = boxes[k];
        let is_free = |&[a, b]: &[DVec3; 2]| a.cmpgt(top).any() || b.cmplt(bottom).any();
        let fits = bottom.cmpgt(lo).all() && top.cmplt(hi).all() && taken.iter().all(is_free);
        let regular = known[k].defined && known[k].continuous && known[k].smooth;
        (fits && regular && along(&second[k], up)[0] > 0.0 && along(&second[k], down)[1] < 0.0)
            .then_some(boxes[k])
    })
}

/// Directions along which the second derivative is about the largest and about the smallest, if these have different signs.
fn extreme_directions([xx, xy, xz, yy, yz, zz]: [f64; 6]) -> Option<[DVec3; 2]> {
    /// Squarings of a matrix: enough to tell eigenvalues apart that differ by a tenth.
    const SQUARINGS: u32 = 7;
    let hessian = DMat3::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz]);
    let size = size_sq(&hessian).sqrt();
    let directions = [1.0, -1.0].map(|sign| {
        let mut power = hessian * sign + DMat3::from_diagonal(DVec3::splat(size));
        for _ in 0..SQUARINGS {
            power = power * power;
            power = power * (1.0 / size_sq(&power).sqrt());
        }
        let columns = [power.x_axis, power.y_axis, power.z_axis];
        let longest = columns.into_iter().max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
        longest.and_then(DVec3::try_normalize)
    });
    match directions {
        [Some(up), Some(down)] if up.dot(hessian * up) > 0.0 && down.dot(hessian * down) < 0.0 => {
            Some([up, down])
        }
        _ => None,
    }
}

/// Bounds of the second derivative along a direction, from those of the six.
fn along(second: &[[f64; 2]; 6], d: DVec3) -> [f64; 2] {
    /// What the few operations here may have been rounded by.
    const ROUNDING: f64 = 32.0 * f64::EPSILON;
    let factors = [d.x * d.x, 2.0 * d.x * d.y, 2.0 * d.x * d.z, d.y * d.y, 2.0 * d.y * d.z, d.z * d.z];
    let (mut lo, mut hi, mut size) = (0.0, 0.0, 0.0);
    for (factor, [least, most]) in factors.into_iter().zip(second) {
        let (a, b) = (factor * least, factor * most);
        lo += a.min(b);
        hi += a.max(b);
        size += a.abs().max(b.abs());
    }
    // NaN, from bounds that are infinite, is no sign.
    [lo - ROUNDING * size, hi + ROUNDING * size]
}
