//! The surface f = 0, and the way to it by Newton's method in space.

use crate::differential::{Curvature, exact_curvature};
use crate::field::Field;
use crate::math::Bounds;
use crate::particles::SlotFate;
use glam::DVec3;
use std::cell::RefCell;
use std::rc::Rc;

/// Largest number of evaluations in Newton's method. From a good guess it takes two. With six of them three of 24 random
/// surfaces get other particles, with 24 none, or one where particles are large.
pub(super) const MAX_NEWTON: u32 = 12;

/// "Require: an implicit surface": f = 0 in a box. Clones share the field, and count their evaluations apart.
#[derive(Clone)]
pub struct ImplicitSurface {
    field: Rc<RefCell<Box<dyn Field>>>,
    pub(crate) bounds: Bounds,
    /// Evaluations of the field.
    pub(crate) evaluations: u64,
}

/// f and ∇f at a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FieldSample {
    pub(crate) value: f64,
    pub(crate) gradient: DVec3,
    /// The length |∇f| of the gradient.
    pub(crate) slope: f64,
}

impl FieldSample {
    /// Whether the point counts as a point of the surface that has a normal.
    pub(super) fn is_zero(&self, residual: f64) -> bool {
        self.slope > 0.0 && self.slope.is_finite() && self.value.abs() <= residual * self.slope
    }
}

/// An evaluation on the way to the surface.
#[derive(Clone, Copy, Debug)]
pub struct Trial {
    /// Number of the evaluation, from 0.
    pub(crate) step: u32,
    /// Angle on the circle; none in space.
    pub(crate) theta_rad: Option<f64>,
    /// Position of the evaluation.
    pub(crate) position: DVec3,
    /// The field at that position.
    pub(crate) sample: FieldSample,
}

/// Result of a search for the surface: a point of it with the unit normal there, or the fate of a child that finds none.
pub(crate) type Landing = Result<(DVec3, DVec3), SlotFate>;

impl ImplicitSurface {
    /// The zeros of `field` in a box.
    #[must_use]
    pub fn new(field: Box<dyn Field>, bounds: &Bounds) -> Self {
        Self { field: Rc::new(RefCell::new(field)), bounds: *bounds, evaluations: 0 }
    }

    pub(crate) fn sample(&mut self, p: DVec3) -> FieldSample {
        self.evaluations += 1;
        let jet = self.field.borrow_mut().jet(p);
        FieldSample { value: jet.value, gradient: jet.gradient, slope: jet.gradient.length() }
    }

    /// Second fundamental form [a, b, c] of the surface at p in the tangent frame (u, w): the normal turns by `[a b; b c]`.
    pub(crate) fn second_form(&mut self, p: DVec3, u: DVec3, w: DVec3) -> [f64; 3] {
        self.evaluations += 1;
        let jet = self.field.borrow_mut().jet(p);
        [(u, u), (u, w), (w, w)].map(|(a, b)| a.dot(jet.hessian.apply(b)) / jet.gradient.length())
    }

    /// Principal curvatures of the level set through p.
    pub(crate) fn curvature(&mut self, p: DVec3) -> Curvature<f64, DVec3> {
        self.evaluations += 1;
        exact_curvature(&self.field.borrow_mut().jet(p))
    }

    /// "The most common technique", the Newton–Raphson method: x ← x − f ∇f / |∇f|², until the point is on the surface or has
    /// moved by more than `reach`.
    pub(crate) fn land_by_newton(
        &mut self,
        start: DVec3,
        reach: f64,
        residual: f64,
        note: &mut dyn FnMut(Trial),
    ) -> Landing {
        let mut position = start;
        for step in 0..MAX_NEWTON {
            let sample = self.sample(position);
            note(Trial { step, theta_rad: None, position, sample });
            if sample.is_zero(residual) {
                return Ok((position, sample.gradient / sample.slope));
            }
            position -= sample.gradient * (sample.value / (sample.slope * sample.slope));
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
