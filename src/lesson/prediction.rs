//! Predicts the angle of a child on its circle from the curvature of the surface at its parent.

use crate::paper::{DIRECTIONS, ImplicitSurface, TangentFrame};

/// Largest |sin θ₀|. At 1 the surface would have the radius of curvature r, which particles of this
/// size cannot resolve. Larger: more searches find no surface.
const STEEPEST: f64 = 0.9;

/// Angles θ₀ at which the curvature of the surface predicts the children of a particle.
pub(super) fn predicted_angles(surface: &mut ImplicitSurface, frame: &TangentFrame, radius: f64) -> [f64; 6] {
    let form = second_form(surface, frame);
    DIRECTIONS.map(|direction| predicted_angle(form, direction, radius))
}

/// Second fundamental form [a, b, c] of the surface in a tangent frame (u, w): the derivative of
/// the normal is `[a b; b c]`.
pub(super) fn second_form(
    surface: &mut ImplicitSurface,
    &TangentFrame { p, u, w, .. }: &TangentFrame,
) -> [f64; 3] {
    let jet = surface.jet(p);
    [(u, u), (u, w), (w, w)].map(|(a, b)| a.dot(jet.hessian.apply(b)) / jet.gradient.length())
}

/// Angle θ₀ at which the surface leaves the tangent plane in the direction (cos, sin) of a frame,
/// where its second fundamental form is [a, b, c]. At distance l the surface has fallen by κ l²/2;
/// with l = 2r this gives sin θ = −κ_V r.
pub(super) fn predicted_angle([a, b, c]: [f64; 3], [cos, sin]: [f64; 2], radius: f64) -> f64 {
    let curvature = (a * cos + b * sin) * cos + (b * cos + c * sin) * sin;
    libm::asin((-curvature * radius).clamp(-STEEPEST, STEEPEST))
}
