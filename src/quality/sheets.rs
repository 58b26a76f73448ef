//! Distinguishes sheets that face the same way and lie near each other, by the field between them.
//!
//! Two sheets that face the same way always have a third sheet between them, which faces the other
//! way. A pair of points is therefore doubtful only if such a third sheet is near, and if the
//! *lift* of the pair is comparable with the distance to it. The lift is the mean height of each
//! point above the tangent plane at the other. On one sheet it is of third order in the distance of
//! the points.
//!
//! The points are first moved by their residuals, so that their distances from the surface do not
//! enter the lift.

use super::accuracy::first_order_height;
use crate::field::Evaluator;
use crate::math::SINGLE_ROUNDING;
use crate::mesh::stars::TellsApart;
use crate::particles::OrientedPoint;
use glam::DVec3;

/// Lift from which a pair is doubtful, as a share of the distance of the sheet that faces the other
/// way: points on either side of that sheet are farther apart.
const SHARE: f64 = 0.5;
/// Number of steps along the surface from one point to another. At an eighth of the distance d a
/// step leaves the surface by d³/3000 times the change of the curvature, which must be less than
/// the distance to another sheet.
const STEPS: u32 = 8;

/// Distinguishes sheets by the field.
pub(crate) struct ByField<'a> {
    field: Box<dyn Evaluator + 'a>,
    patch: Option<u32>,
}

impl<'a> ByField<'a> {
    pub(crate) fn new(field: &'a dyn Evaluator) -> Self {
        Self { field: field.another(), patch: None }
    }

    /// The point moved onto the surface, and its normal.
    fn on_surface(&mut self, OrientedPoint { position, normal }: OrientedPoint) -> (DVec3, DVec3) {
        let (position, normal) = (position.as_dvec3(), normal.as_dvec3());
        let (value, gradient) = self.field.on(self.patch).value_and_gradient(position);
        let height = first_order_height(value, gradient.length());
        (position - normal * if height.is_finite() { height } else { 0.0 }, normal)
    }

    fn way(&mut self, one: OrientedPoint, other: OrientedPoint) -> Way {
        let ((from, n), (to, m)) = (self.on_surface(one), self.on_surface(other));
        let lift = (0.5 * (to - from).dot(n + m)).abs();
        Way { from, to, lift, rounding: SINGLE_ROUNDING * (to - from).length() }
    }

    /// Whether two points of one patch face the same way, and the way along the surface from one
    /// leads to the other.
    pub(crate) fn leads(&mut self, patch: Option<u32>, one: OrientedPoint, other: OrientedPoint) -> bool {
        self.patch = patch;
        let way = self.way(one, other);
        one.normal.dot(other.normal) > 0.0 && way.missed(self.field.on(patch)) <= way.allowed()
    }
}

/// A way along the surface from one point to another.
struct Way {
    from: DVec3,
    to: DVec3,
    /// Lift of the two points.
    lift: f64,
    /// Lift that rounding leaves meaningless.
    rounding: f64,
}

impl Way {
    /// Largest distance at which the way passes a point of its own sheet.
    fn allowed(&self) -> f64 {
        0.5 * self.lift.max(self.rounding)
    }

    /// Distance at which the way passes the point that it should lead to; NaN if it ends at a
    /// singular point.
    fn missed(&self, field: &mut dyn Evaluator) -> f64 {
        let (mut at, mut normal) = (self.from, DVec3::NAN);
        for left in (0..=STEPS).rev() {
            // One Newton step to the surface.
            let jet = field.jet(at);
            let slope = jet.gradient.length();
            at -= jet.gradient * (jet.value / (slope * slope));
            normal = jet.gradient / slope;
            if left > 0 {
                let ahead = self.to - at;
                let ahead = ahead - normal * ahead.dot(normal);
                let (direction, length) = (ahead.normalize_or_zero(), ahead.length() / f64::from(left));
                let curvature = direction.dot(jet.hessian.apply(direction)) / slope;
                at += direction * length - normal * (0.5 * curvature * length * length);
            }
        }
        (self.to - at).dot(normal).abs()
    }
}

impl TellsApart for ByField<'_> {
    fn on(&self, patch: Option<u32>) -> Box<dyn TellsApart + '_> {
        Box::new(ByField { field: self.field.another(), patch })
    }

    fn facing_away(&mut self, point: OrientedPoint, others: &[OrientedPoint]) -> f64 {
        let (p, n) = self.on_surface(point);
        let distances = others.iter().map(|&other| {
            let (q, m) = self.on_surface(other);
            (0.5 * (q - p).dot(n - m)).abs()
        });
        distances.fold(f64::INFINITY, f64::min)
    }

    /// If the pair is doubtful, whether the way along the surface from one point leads past the
    /// other.
    fn are_two(&mut self, one: OrientedPoint, other: OrientedPoint, facing_away: f64) -> bool {
        let way = self.way(one, other);
        // False for NaN: if the way ends at a singular point, nothing is known.
        way.lift > (SHARE * facing_away).max(way.rounding)
            && way.missed(self.field.on(self.patch)) > way.allowed()
    }
}
