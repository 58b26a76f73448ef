//! Tells sheets apart that face the same way and lie near each other, by the field between them.
//!
//! Two sheets that face the same way always have a third sheet between them, which faces the other
//! way. A pair of points is therefore doubtful only if such a third sheet is near, and if the
//! *lift* of the pair is comparable with the distance to it. The lift is the mean height of each
//! point above the tangent plane at the other. On one sheet it is of third order in the distance of
//! the points.
//!
//! The points are taken to lie where their residuals say, so that the lift does not suffer from
//! their distances from the surface.

use super::creases::CreaseRows;
use crate::field::Evaluator;
use crate::math::SINGLE_ROUNDING;
use crate::spatial::tree::Tree;
use glam::{DVec3, Vec3};

/// A pair is doubtful from this share of the distance of the sheet that faces the other way: those
/// on either side of it are farther apart than that.
const SHARE: f64 = 0.5;
/// Steps of the way along the surface from one point to another. At an eighth of the distance d a
/// step leaves the surface by d³/3000 times the change of the curvature, which must be less than
/// the distance to another sheet.
const STEPS: u32 = 8;

/// The points, in tree order, with the normals and heights that tell sheets apart.
pub(super) struct Sheets<'a> {
    pub(super) tree: &'a Tree,
    /// Unit normals.
    pub(super) normal: &'a [Vec3],
    /// First-order heights f/|∇f| above the surface.
    pub(super) height: &'a [f64],
    pub(super) creases: &'a CreaseRows,
}

impl Sheets<'_> {
    /// Point `i` led onto the surface, and its normal.
    fn on_surface(&self, i: usize) -> (DVec3, DVec3) {
        let normal = self.normal[i].as_dvec3();
        let height = self.height[i];
        let height = if height.is_finite() { height } else { 0.0 };
        (self.tree.position[i].as_dvec3() - normal * height, normal)
    }

    /// The distance along the normal of point `i` of the nearest sheet that faces the other way, by
    /// those of the points `near`; infinite if there is none.
    pub(super) fn facing_away(&self, i: usize, near: impl Iterator<Item = usize>) -> f64 {
        let (p, n) = self.on_surface(i);
        let distances = near.filter(|&j| self.normal[i].dot(self.normal[j]) < 0.0).map(|j| {
            let (q, m) = self.on_surface(j);
            (0.5 * (q - p).dot(n - m)).abs()
        });
        distances.fold(f64::INFINITY, f64::min)
    }

    /// Whether two points that face the same way are on two sheets, where one that faces the other
    /// way is `facing_away` from the first: if doubtful, whether the way along the surface from one
    /// leads past the other.
    pub(super) fn are_two(&self, field: &mut dyn Evaluator, i: usize, j: usize, facing_away: f64) -> bool {
        if facing_away == f64::INFINITY {
            return false;
        }
        let ((p, n), (q, m)) = (self.on_surface(i), self.on_surface(j));
        let lift = (0.5 * (q - p).dot(n + m)).abs();
        if lift <= SHARE * facing_away || lift <= SINGLE_ROUNDING * (q - p).length() {
            return false;
        }
        let (mut at, mut normal) = (p, n);
        for left in (0..=STEPS).rev() {
            // One Newton step to the surface.
            let jet = field.jet(at);
            let slope = jet.gradient.length();
            at -= jet.gradient * (jet.value / (slope * slope));
            normal = jet.gradient / slope;
            if left > 0 {
                let ahead = q - at;
                let ahead = ahead - normal * ahead.dot(normal);
                let (direction, length) = (ahead.normalize_or_zero(), ahead.length() / f64::from(left));
                let curvature = direction.dot(jet.hessian.apply(direction)) / slope;
                at += direction * length - normal * (0.5 * curvature * length * length);
            }
        }
        // False for NaN: where the way ends at a singular point nothing is known.
        (q - at).dot(normal).abs() > 0.5 * lift
    }
}
