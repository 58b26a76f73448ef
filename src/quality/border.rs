//! Which points lie near the border that a clip box cuts into the surface.

use crate::field::Field;
use crate::math::Bounds;
use glam::{DVec3, Vec3};

/// Points nearer to the border than this many d_hex are left out of the per-point figures: their neighbourhood is cut.
pub(super) const MARGIN: f64 = 4.0;
/// The surface must rise this far beyond a face, in d_hex, before it counts as cut: a surface that touches its box from
/// inside is whole.
const BEYOND: f64 = 0.05;

/// Whether the surface through `p` leaves `bounds` within the length `margin` of it.
///
/// The surface is followed to second order: from `p` along the unit tangent t that climbs towards a face with outward
/// normal e, its height is s (t·e) − s² κ (n·e)/2 with the normal curvature κ along t. It is cut when that height
/// exceeds the distance to the face for some s ≤ `margin`.
pub(super) fn is_near(p: Vec3, field: &mut dyn Field, bounds: &Bounds, d_hex: f64) -> bool {
    let p = p.as_dvec3();
    let margin = MARGIN * d_hex;
    let (below, above) = (p - bounds.lo(), bounds.hi() - p);
    if below.min_element().min(above.min_element()) > margin {
        return false;
    }
    let jet = field.jet(p);
    let slope = jet.gradient.length();
    let normal = jet.gradient / slope;
    (0..3).any(|axis| {
        [(-1.0, below[axis]), (1.0, above[axis])].into_iter().any(|(sign, distance)| {
            let need = distance.max(0.0) + BEYOND * d_hex;
            if need > margin {
                return false;
            }
            let mut outward = DVec3::ZERO;
            outward[axis] = sign;
            let along = outward - normal * outward.dot(normal);
            let rise = along.length();
            let tangent = along / rise;
            if !tangent.is_finite() {
                return distance <= 0.0;
            }
            let bend = 0.5 * jet.hessian.apply(tangent).dot(tangent) / slope * normal.dot(outward);
            // The highest place within the margin.
            let top = if bend > 0.0 { (0.5 * rise / bend).min(margin) } else { margin };
            top * rise - top * top * bend >= need
        })
    })
}
