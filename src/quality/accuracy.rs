//! Figures of accuracy: how far the points are from the surface, and how far their normals are from
//! its normals.

use super::figures::Accuracy;
use super::moments::Moments;
use crate::field::{Evaluator, difference_step};
use glam::{DVec3, Vec3};

/// Returns the first-order height f/|∇f| of a point above the surface; its size is the distance.
pub(super) fn first_order_height(value: f64, slope: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value / slope }
}

/// Returns the height f/slope of a place where f has this value and no gradient, as at the tip of a
/// cone: with the slope to the steeper side along the unit normal.
pub(super) fn height_along(field: &mut dyn Evaluator, place: DVec3, normal: Vec3, value: f64) -> f64 {
    let h = difference_step(field.frame().place(place));
    let mut slope =
        |way: f64| (field.value_and_gradient(place + way * normal.as_dvec3()).0 - value).abs() / h;
    let slope = slope(h).max(slope(-h));
    first_order_height(value, slope)
}

/// Accuracy of points with these first-order distances and of their normals, whose angles are
/// `normals`.
pub(super) fn measure(residual: &[f64], normals: &NormalAngles, d_hex: f64) -> Accuracy {
    let mut err = Moments::default();
    let (mut largest, mut undefined) = (f64::NAN, 0);
    for &distance in residual {
        if distance.is_finite() {
            err.add(distance);
            largest = largest.max(distance);
        } else {
            undefined += 1;
        }
    }
    let (normal_error_mean, normal_error_max) = normals.figures();
    Accuracy {
        error_max: largest / d_hex,
        error_mean: err.mean() / d_hex,
        undefined,
        normal_error_mean,
        normal_error_max,
    }
}

/// Angle between a normal and a gradient in degrees, if both have a direction.
pub(super) fn angle_between(normal: Vec3, gradient: DVec3) -> Option<f64> {
    let normal = normal.as_dvec3();
    let (across, along) = (normal.cross(gradient).length(), normal.dot(gradient).abs());
    let has_angle = across + along > 0.0 && across.is_finite() && along.is_finite();
    has_angle.then(|| libm::atan2(across, along).to_degrees())
}

/// Angles between the given normals and the gradient.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct NormalAngles {
    angle: Moments,
    largest: f64,
}

impl NormalAngles {
    /// Takes in an angle in degrees.
    pub(super) fn add(&mut self, angle: f64) {
        self.angle.add(angle);
        self.largest = self.largest.max(angle);
    }

    /// Returns the mean and the largest angle in degrees; NaN of no angles.
    fn figures(&self) -> (f64, f64) {
        let mean = self.angle.mean();
        (mean, if mean.is_nan() { mean } else { self.largest })
    }
}
