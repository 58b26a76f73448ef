//! The surface f = 0, and the projection of a child onto it, paper §4.3: along a circle around its
//! parent.

use super::{ChildSlot, Moment, Observer, PaperRun, Particle};
use crate::field::{Field, Jet};
use crate::math::Bounds;
use crate::particles::SlotFate;
use core::f64::consts::PI;
use glam::DVec3;
use std::sync::Arc;

/// Largest number of evaluations in Newton's method. From a good guess it takes two.
const MAX_NEWTON: u32 = 12;

/// Largest turn of a step on the circle, as the tangent of half the angle: about 23°. With a
/// smaller one, large particles take more evaluations.
const MAX_TURN: f64 = 0.2;

/// Angle from the tangent plane at which the search stops, 100°: past 90° the child lies beneath
/// its parent, behind a rim.
const MAX_THETA_RAD: f64 = PI * 5.0 / 9.0;

/// "Require: an implicit surface": f = 0 in a box. Clones share the field but count evaluations
/// separately.
#[derive(Clone)]
pub struct ImplicitSurface {
    field: Arc<dyn Field>,
    pub(crate) bounds: Bounds,
    /// Evaluations of the field.
    pub(crate) evaluations: u64,
}

/// An evaluation on the way to the surface.
#[derive(Clone, Copy, Debug)]
pub struct Trial {
    /// Number of the evaluation, from 0.
    pub(crate) step: u32,
    /// Angle on the circle; none for steps in space.
    pub(crate) theta_rad: Option<f64>,
    /// Position of the evaluation.
    pub(crate) position: DVec3,
    /// Value f at the position.
    pub(crate) value: f64,
    /// Length |∇f| of the gradient at the position.
    pub(crate) slope: f64,
}

/// A callback that receives each evaluation of a search, in order.
pub(crate) type Note<'a> = &'a mut dyn FnMut(Trial);

/// Result of a search for the surface: a point of it with its unit normal, or the fate of a child
/// that found none.
pub(crate) type Landing = Result<(DVec3, DVec3), SlotFate>;

/// The circle C(p, 2r) in the plane (p, N̂, V̂).
///
/// Its points are p + 2r (cos θ V̂ + sin θ N̂): the paper's formula omits the centre and takes |N|
/// = |V| = 2r.
#[derive(Clone, Copy, Debug)]
pub struct Circle {
    /// The parent's place, p.
    pub(crate) centre: DVec3,
    /// The parent's unit normal N̂.
    pub(crate) normal: DVec3,
    /// Unit tangent vector V̂ towards the child.
    pub(crate) direction: DVec3,
    /// Radius of the circle: 2r, or in adaptive sampling r_i + r_j.
    pub(crate) radius: f64,
    /// Angle θ₀ at which the search for the surface starts.
    pub(crate) start_rad: f64,
}

impl Circle {
    /// The point at the angle θ from the tangent plane.
    pub(crate) fn point(&self, theta_rad: f64) -> DVec3 {
        let (sin, cos) = (libm::sin(theta_rad), libm::cos(theta_rad));
        self.centre + (self.direction * cos + self.normal * sin) * self.radius
    }

    /// Derivative of the point with respect to θ.
    fn tangent(&self, theta_rad: f64) -> DVec3 {
        let (sin, cos) = (libm::sin(theta_rad), libm::cos(theta_rad));
        (self.normal * cos - self.direction * sin) * self.radius
    }
}

impl ImplicitSurface {
    /// The zeros of `field` in a box.
    #[must_use]
    pub fn new(field: Box<dyn Field>, bounds: &Bounds) -> Self {
        Self { field: field.into(), bounds: *bounds, evaluations: 0 }
    }

    /// f, ∇f and ∇∇f at a point.
    pub(crate) fn jet(&mut self, p: DVec3) -> Jet {
        self.evaluations += 1;
        self.field.jet(p)
    }

    /// §4.3: moves a child along the circle until it has converged on the surface.
    ///
    /// # Differs from the paper
    ///
    /// The paper turns by α_j π, where α_j is f "scaled between −1 and 1". Here the turn is that of
    /// Newton's method in θ, −f / (df/dθ) to first order, limited to 23°.
    pub(crate) fn land_on_circle(&mut self, circle: &Circle, residual: f64, note: Note) -> Landing {
        let mut theta_rad = circle.start_rad;
        for step in 0..MAX_NEWTON {
            let position = circle.point(theta_rad);
            let Jet { value, gradient, .. } = self.jet(position);
            let slope = gradient.length();
            note(Trial { step, theta_rad: Some(theta_rad), position, value, slope });
            if is_zero(value, slope, residual) {
                return Ok((position, gradient / slope));
            }
            let derivative = gradient.dot(circle.tangent(theta_rad));
            theta_rad += 2.0 * libm::atan((-0.5 * value / derivative).clamp(-MAX_TURN, MAX_TURN));
            if !theta_rad.is_finite() {
                return Err(SlotFate::Undefined);
            }
            if theta_rad.abs() >= MAX_THETA_RAD {
                break;
            }
        }
        Err(SlotFate::NotConverged)
    }

    /// "The most common technique", the Newton–Raphson method: x ← x − f ∇f / |∇f|², until the
    /// point is on the surface or more than `reach` from its start. It projects seeds and moved
    /// particles.
    pub(crate) fn land_by_newton(&mut self, start: DVec3, reach: f64, residual: f64, note: Note) -> Landing {
        let mut position = start;
        for step in 0..MAX_NEWTON {
            let Jet { value, gradient, .. } = self.jet(position);
            let slope = gradient.length();
            note(Trial { step, theta_rad: None, position, value, slope });
            if is_zero(value, slope, residual) {
                return Ok((position, gradient / slope));
            }
            position -= gradient * (value / (slope * slope));
            if !position.is_finite() {
                return Err(SlotFate::Undefined);
            }
            if position.distance(start) > reach {
                break;
            }
        }
        Err(SlotFate::NotConverged)
    }
}

/// Whether a point counts as on the surface and has a normal.
fn is_zero(value: f64, slope: f64, residual: f64) -> bool {
    slope > 0.0 && slope.is_finite() && value.abs() <= residual * slope
}

impl<O: Observer> PaperRun<O> {
    /// Moves a child onto the surface (§4.3).
    pub(crate) fn land(&mut self, child: ChildSlot, circle: &Circle) -> Landing {
        let residual = self.rules.residual * self.particles[child.parent as usize].radius;
        let (seen, particles) = (&mut self.seen, &self.particles);
        let mut note = |trial: Trial| seen.see(child, Moment::Tried(trial), particles);
        let landing = (self.rules.projection)(&mut self.surface, circle, residual, &mut note);
        if let Ok((position, normal)) = landing {
            self.tell(child, Moment::Landed { position, normal });
        }
        landing
    }

    /// The position and normal of a child that has landed and may become a particle; otherwise
    /// decides its fate.
    pub(crate) fn usable(&mut self, child: ChildSlot, landing: Landing) -> Option<(DVec3, DVec3)> {
        let fate = match landing {
            Err(fate) => fate,
            // The circle may meet the far side of a rim or of a thin sheet.
            Ok((_, normal)) if normal.dot(self.particles[child.parent as usize].n()) <= 0.0 => {
                SlotFate::NotConverged
            }
            Ok((position, _)) if !self.surface.bounds.holds(position) => SlotFate::Outside,
            Ok(place) => return Some(place),
        };
        self.decide(child, fate, None);
        None
    }

    /// The position and normal of a particle that is moved to `target` and projected to the
    /// surface; `None` beyond the box or the domain of f, or around a fold.
    pub(crate) fn come_back(&mut self, own: &Particle, target: DVec3, reach: f64) -> Option<(DVec3, DVec3)> {
        let residual = self.rules.residual * own.radius;
        let landing = self.surface.land_by_newton(target, reach, residual, &mut |_| {}).ok();
        landing.filter(|&(position, normal)| self.surface.bounds.holds(position) && normal.dot(own.n()) > 0.0)
    }
}
