//! The surface f = 0, and how a child comes to it: on a circle around its parent (§4.3), or by Newton's method in space.

use crate::differential::{Curvature, exact_curvature};
use crate::field::Field;
use crate::math::Bounds;
use core::f64::consts::PI;
use glam::DVec3;

/// Most evaluations of Newton's method; a good guess takes two.
const MAX_NEWTON: u32 = 12;

/// Largest turn of a step on the circle, as the tangent of half the angle: about 23°.
const MAX_TURN: f64 = 0.2;

/// The circle is searched up to this angle from the tangent plane: 100°.
const MAX_THETA_RAD: f64 = PI * 5.0 / 9.0;

/// Smallest sine of the angle between circle and surface at which Newton's method is trusted.
const MIN_CROSSING: f64 = 0.1;

/// Largest ratio of |f| after a step of Newton's method to |f| before it; above it the bracketed search takes over.
const MIN_DECREASE: f64 = 0.7;

/// Intervals into which the bracketed search divides the arc.
const ARC_SAMPLES: u32 = 32;

/// Most steps in a bracket.
const MAX_BRACKET: u32 = 40;

/// The field, its box and how often it was asked.
pub(super) struct Surface {
    pub(super) field: Box<dyn Field>,
    pub(super) bounds: Bounds,
    pub(super) evaluations: u64,
}

/// f and ∇f at a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    pub(super) value: f64,
    pub(super) gradient: DVec3,
    pub(super) slope: f64,
}

impl Sample {
    /// Whether the point counts as one of the surface, with a normal.
    fn is_zero(&self, residual: f64) -> bool {
        self.slope > 0.0 && self.slope.is_finite() && self.value.abs() <= residual * self.slope
    }
}

/// An evaluation on the way to the surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trial {
    pub(super) step: u32,
    pub(super) theta_rad: Option<f64>,
    pub(super) position: DVec3,
    pub(super) sample: Sample,
    pub(super) bracket_rad: Option<[f64; 2]>,
}

/// Where a search ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Landing {
    On { position: DVec3, normal: DVec3 },
    NotConverged,
    Undefined,
}

/// The circle C(p, 2r) in the plane (p, N̂, V̂).
///
/// Its points are p + 2r (cos θ V̂ + sin θ N̂): the paper's formula leaves the centre out and takes |N| = |V| = 2r.
#[derive(Clone, Copy, Debug)]
pub(super) struct Circle {
    pub(super) centre: DVec3,
    pub(super) normal: DVec3,
    pub(super) direction: DVec3,
    pub(super) radius: f64,
}

impl Circle {
    pub(super) fn point(&self, theta_rad: f64) -> DVec3 {
        let (sin, cos) = (libm::sin(theta_rad), libm::cos(theta_rad));
        self.centre + (self.direction * cos + self.normal * sin) * self.radius
    }

    /// Derivative of the point by θ.
    fn tangent(&self, theta_rad: f64) -> DVec3 {
        let (sin, cos) = (libm::sin(theta_rad), libm::cos(theta_rad));
        (self.normal * cos - self.direction * sin) * self.radius
    }
}

impl Surface {
    pub(super) fn sample(&mut self, p: DVec3) -> Sample {
        self.evaluations += 1;
        let jet = self.field.jet(p);
        Sample { value: jet.value, gradient: jet.gradient, slope: jet.gradient.length() }
    }

    /// Second fundamental form [a, b, c] of the surface at p in the tangent frame (u, w): the normal turns by `[a b; b c]`.
    pub(super) fn second_form(&mut self, p: DVec3, u: DVec3, w: DVec3) -> [f64; 3] {
        self.evaluations += 1;
        let jet = self.field.jet(p);
        [(u, u), (u, w), (w, w)].map(|(a, b)| a.dot(jet.hessian.apply(b)) / jet.gradient.length())
    }

    /// Principal curvatures of the level set through p.
    pub(super) fn curvature(&mut self, p: DVec3) -> Curvature<f64, DVec3> {
        self.evaluations += 1;
        exact_curvature(&self.field.jet(p))
    }

    pub(super) fn contains(&self, p: DVec3) -> bool {
        p.cmpge(self.bounds.lo()).all() && p.cmple(self.bounds.hi()).all()
    }

    /// §4.3: moves a child along the circle until it has converged on the surface.
    ///
    /// # Differs from the paper
    ///
    /// The paper turns by α_j π, where α_j is f "scaled between −1 and 1". Here the turn is that of Newton's method in θ,
    /// −f / (df/dθ) to first order, limited to 23°. Where that does not converge, brackets of the arc are searched.
    pub(super) fn land_on_circle(
        &mut self,
        circle: &Circle,
        start_rad: f64,
        residual: f64,
        note: &mut dyn FnMut(Trial),
    ) -> Landing {
        let mut theta_rad = start_rad;
        let mut last = f64::INFINITY;
        for step in 0..MAX_NEWTON {
            let position = circle.point(theta_rad);
            let sample = self.sample(position);
            note(Trial { step, theta_rad: Some(theta_rad), position, sample, bracket_rad: None });
            if sample.is_zero(residual) {
                return Landing::On { position, normal: sample.gradient / sample.slope };
            }
            let derivative = sample.gradient.dot(circle.tangent(theta_rad));
            theta_rad += 2.0 * libm::atan((-0.5 * sample.value / derivative).clamp(-MAX_TURN, MAX_TURN));
            let settles = sample.value.abs() <= MIN_DECREASE * last
                && derivative.abs() > MIN_CROSSING * sample.slope * circle.radius
                && theta_rad.abs() < MAX_THETA_RAD;
            // A NaN makes it false.
            if !settles {
                return self.search_arc(circle, start_rad, residual, step + 1, note);
            }
            last = sample.value.abs();
        }
        self.search_arc(circle, start_rad, residual, MAX_NEWTON, note)
    }

    /// Looks for changes of sign on the arc and searches them, the nearest to the start first.
    fn search_arc(
        &mut self,
        circle: &Circle,
        start_rad: f64,
        residual: f64,
        mut step: u32,
        note: &mut dyn FnMut(Trial),
    ) -> Landing {
        let angle = |k: u32| MAX_THETA_RAD * (2.0 * f64::from(k) / f64::from(ARC_SAMPLES) - 1.0);
        let values: Vec<f64> = (0..=ARC_SAMPLES).map(|k| self.sample(circle.point(angle(k))).value).collect();
        let mut brackets: Vec<u32> = (0..ARC_SAMPLES)
            .filter(|&k| {
                let (a, b) = (values[k as usize], values[k as usize + 1]);
                a.is_finite() && b.is_finite() && (a <= 0.0) != (b <= 0.0)
            })
            .collect();
        let middle = |k: u32| 0.5 * (angle(k) + angle(k + 1));
        brackets.sort_by(|&a, &b| (middle(a) - start_rad).abs().total_cmp(&(middle(b) - start_rad).abs()));
        for &k in &brackets {
            let ends = [values[k as usize], values[k as usize + 1]];
            let found =
                self.search_bracket(circle, [angle(k), angle(k + 1)], ends, residual, &mut step, note);
            if let Some(landing) = found {
                return landing;
            }
        }
        let undefined = values.iter().filter(|value| !value.is_finite()).count();
        if brackets.is_empty() && 2 * undefined > ARC_SAMPLES as usize {
            Landing::Undefined
        } else {
            Landing::NotConverged
        }
    }

    /// The zero between two angles where f has the values `ends`, by the Illinois method; `None` if f changes its sign at a pole
    /// or a jump.
    fn search_bracket(
        &mut self,
        circle: &Circle,
        [mut a, mut b]: [f64; 2],
        [mut fa, mut fb]: [f64; 2],
        residual: f64,
        step: &mut u32,
        note: &mut dyn FnMut(Trial),
    ) -> Option<Landing> {
        let highest = fa.abs().max(fb.abs());
        let mut kept = 0;
        for _ in 0..MAX_BRACKET {
            let secant = (a * fb - b * fa) / (fb - fa);
            let theta_rad = if secant > a && secant < b { secant } else { 0.5 * (a + b) };
            let position = circle.point(theta_rad);
            let sample = self.sample(position);
            let bracket_rad = Some([a, b]);
            note(Trial { step: *step, theta_rad: Some(theta_rad), position, sample, bracket_rad });
            *step += 1;
            if !sample.value.is_finite() || sample.value.abs() > highest {
                return None;
            }
            if sample.is_zero(residual) {
                return Some(Landing::On { position, normal: sample.gradient / sample.slope });
            }
            if (sample.value <= 0.0) == (fa <= 0.0) {
                (a, fa) = (theta_rad, sample.value);
                fb *= if kept == 1 { 0.5 } else { 1.0 };
                kept = 1;
            } else {
                (b, fb) = (theta_rad, sample.value);
                fa *= if kept == 2 { 0.5 } else { 1.0 };
                kept = 2;
            }
        }
        None
    }

    /// "The most common technique", the Newton–Raphson method: x ← x − f ∇f / |∇f|², until the point is on the surface or has
    /// moved by more than `reach`.
    pub(super) fn land_by_newton(
        &mut self,
        start: DVec3,
        reach: f64,
        residual: f64,
        note: &mut dyn FnMut(Trial),
    ) -> Landing {
        let mut position = start;
        for step in 0..MAX_NEWTON {
            let sample = self.sample(position);
            note(Trial { step, theta_rad: None, position, sample, bracket_rad: None });
            if sample.is_zero(residual) {
                return Landing::On { position, normal: sample.gradient / sample.slope };
            }
            position -= sample.gradient * (sample.value / (sample.slope * sample.slope));
            if !position.is_finite() {
                return Landing::Undefined;
            }
            if position.distance(start) > reach {
                return Landing::NotConverged;
            }
        }
        Landing::NotConverged
    }

    /// Whether f comes to zero at a point of the surface, and not to a pole: |f| grows away from a zero.
    pub(super) fn is_zero(&mut self, position: DVec3, normal: DVec3, step: f64) -> bool {
        let [here, above, below] =
            [0.0, step, -step].map(|step| self.sample(position + normal * step).value.abs());
        above > here || below > here
    }
}
