//! Data about the field for drawings, which no event holds: the curve in which a plane cuts the
//! surface, and the iterates of Newton's method in space from a given point.

use super::Lesson;
use super::event::Vector;
use crate::paper::Trial;
use glam::DVec3;
use serde::Serialize;

/// A step of Newton's method in space.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "LessonIterate"))]
pub struct Iterate {
    /// Position.
    pub position: Vector,
    /// Value f at the position.
    pub value: f64,
    /// Length |∇f| of the gradient at the position.
    pub slope: f64,
}

impl Lesson {
    /// The curve f = 0 in the plane through a point and two perpendicular unit vectors, within the
    /// square of half side `half`: line segments x₀, y₀, x₁, y₁ with x along `right` and y along
    /// `up`, from a grid of `cells`² cells, at least one.
    pub fn section(&self, centre: Vector, right: Vector, up: Vector, half: f64, cells: u32) -> Vec<[f64; 4]> {
        let cells = cells.max(1) as usize;
        let mut surface = self.course.run.surface.clone();
        let [centre, right, up] = [centre, right, up].map(DVec3::from);
        let at = |k: usize| half * (2.0 * k as f64 / cells as f64 - 1.0);
        let values: Vec<f64> = (0..(cells + 1) * (cells + 1))
            .map(|k| {
                let (x, y) = (at(k % (cells + 1)), at(k / (cells + 1)));
                surface.jet(centre + right * x + up * y).value
            })
            .collect();
        let node = |i: usize, j: usize| ([at(i), at(j)], values[j * (cells + 1) + i]);
        let mut segments = Vec::new();
        for j in 0..cells {
            for i in 0..cells {
                let [a, b, c, d] = [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)];
                // Two triangles, each with at most one segment of the curve.
                for [p, q, r] in [[a, b, c], [a, c, d]] {
                    let crossings: Vec<[f64; 2]> =
                        [(p, q), (q, r), (r, p)].into_iter().filter_map(|(s, t)| crossing(s, t)).collect();
                    if let [[x0, y0], [x1, y1]] = crossings[..] {
                        segments.push([x0, y0, x1, y1]);
                    }
                }
            }
        }
        segments
    }

    /// The steps of Newton's method from a point, until it reaches the surface or leaves the
    /// neighbourhood of radius `reach`.
    pub fn newton(&self, start: Vector, reach: f64) -> Vec<Iterate> {
        let rules = &self.course.run.rules;
        let residual = rules.residual * rules.sizes.largest();
        let mut steps = Vec::new();
        let mut note = |trial: Trial| {
            steps.push(Iterate {
                position: trial.position.to_array(),
                value: trial.value,
                slope: trial.slope,
            });
        };
        // The recorded steps already tell how the method ended.
        let _ = self.course.run.surface.clone().land_by_newton(start.into(), reach, residual, &mut note);
        steps
    }
}

/// The zero of f between two nodes, if f changes sign.
fn crossing((a, fa): ([f64; 2], f64), (b, fb): ([f64; 2], f64)) -> Option<[f64; 2]> {
    if !(fa.is_finite() && fb.is_finite()) || (fa <= 0.0) == (fb <= 0.0) {
        return None;
    }
    let t = fa / (fa - fb);
    Some([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])])
}
