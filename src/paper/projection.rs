//! The projection of a child onto the surface, paper §4.3: along a circle around its parent.

use super::PaperRun;
use super::event::{ChildSlot, Event, Observer};
use super::particle::Particle;
use super::rules::Projection;
use super::surface::{ImplicitSurface, Landing, MAX_NEWTON, Trial};
use crate::particles::SlotFate;
use core::f64::consts::PI;
use glam::DVec3;

/// Largest turn of a step on the circle, as the tangent of half the angle: about 23°. In the fast front half and double change the
/// particles of few random surfaces, and no figure; so with the next three.
const MAX_TURN: f64 = 0.2;

/// The circle is searched up to this angle from the tangent plane, 100°: past 90° the child lies beneath its parent, behind a rim.
const MAX_THETA_RAD: f64 = PI * 5.0 / 9.0;

/// Smallest sine of the angle between circle and surface at which Newton's method is trusted: about 6°.
const MIN_CROSSING: f64 = 0.1;

/// Largest ratio of |f| after a step of Newton's method to |f| before it; above it the bracketed search takes over.
const MIN_DECREASE: f64 = 0.7;

/// Intervals into which the bracketed search divides the arc: 6° each, in which a surface that a particle's size resolves crosses the circle
/// no more than once.
const ARC_SAMPLES: u32 = 32;

/// Largest number of steps in a bracket: as many halvings make it shorter than what single precision tells apart.
const MAX_BRACKET: u32 = 40;

/// The circle C(p, 2r) in the plane (p, N̂, V̂).
///
/// The circle has the points p + 2r (cos θ V̂ + sin θ N̂): the paper's formula leaves the centre out and takes |N| = |V| = 2r.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Circle {
    /// The parent's place, p.
    pub(crate) centre: DVec3,
    /// The parent's unit normal N̂.
    pub(crate) normal: DVec3,
    /// Unit tangent vector V̂ towards the child.
    pub(crate) direction: DVec3,
    /// Radius of the circle: 2r, or in adaptive sampling r_i + r_j.
    pub(crate) radius: f64,
}

impl Circle {
    /// The point at the angle θ from the tangent plane.
    pub(crate) fn point(&self, theta_rad: f64) -> DVec3 {
        let (sin, cos) = (libm::sin(theta_rad), libm::cos(theta_rad));
        self.centre + (self.direction * cos + self.normal * sin) * self.radius
    }

    /// Derivative of the point by θ.
    fn tangent(&self, theta_rad: f64) -> DVec3 {
        let (sin, cos) = (libm::sin(theta_rad), libm::cos(theta_rad));
        (self.normal * cos - self.direction * sin) * self.radius
    }
}

impl ImplicitSurface {
    /// §4.3: moves a child along the circle until it has converged on the surface.
    ///
    /// # Differs from the paper
    ///
    /// The paper turns by α_j π, where α_j is f "scaled between −1 and 1". Here the turn is that of Newton's method in θ,
    /// −f / (df/dθ) to first order, limited to 23°. Where that does not converge, brackets of the arc are searched.
    pub(crate) fn land_on_circle(
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
}

impl<O: Observer> PaperRun<O> {
    /// Proposes a child at an angle on its circle, and returns the position there.
    pub(crate) fn propose(&mut self, child: ChildSlot, circle: &Circle, theta_rad: f64) -> DVec3 {
        let ChildSlot { parent, slot } = child;
        let position = circle.point(theta_rad);
        let (direction, place) = (circle.direction.to_array(), position.to_array());
        self.tell(Event::Slot { parent, slot, direction, theta_rad, place });
        position
    }

    /// Moves a child onto the surface (§4.3), from an angle on its circle.
    pub(crate) fn land(&mut self, child: ChildSlot, circle: &Circle, theta_rad: f64) -> Landing {
        let residual = self.rules.residual * self.particles[child.parent as usize].radius;
        let ChildSlot { parent, slot } = child;
        let (seen, particles) = (&mut self.seen, &self.particles);
        let mut note = |Trial { step, theta_rad, position, sample, bracket_rad }: Trial| {
            let (position, value, slope) = (position.to_array(), sample.value, sample.slope);
            let event = Event::Iterate { parent, slot, step, theta_rad, position, value, slope, bracket_rad };
            seen.event(event, particles);
        };
        let landing = match self.rules.projection {
            Projection::Circle => self.surface.land_on_circle(circle, theta_rad, residual, &mut note),
            Projection::Newton => {
                let start = circle.point(theta_rad);
                self.surface.land_by_newton(start, circle.radius, residual, &mut note)
            }
        };
        if let Landing::On { position, normal } = landing {
            let distance = position.distance(circle.centre);
            let (position, normal) = (position.to_array(), normal.to_array());
            self.tell(Event::Landed { parent, slot, position, normal, distance });
        }
        landing
    }

    /// The position and normal of a child that has landed, if it may be a particle there; otherwise its fate is decided.
    pub(crate) fn usable(&mut self, child: ChildSlot, landing: Landing) -> Option<(DVec3, DVec3)> {
        let fate = match landing {
            Landing::NotConverged => SlotFate::NotConverged,
            Landing::Undefined => SlotFate::Undefined,
            // The circle may meet the far side of a rim or of a thin sheet.
            Landing::On { normal, .. } if normal.dot(self.particles[child.parent as usize].n()) <= 0.0 => {
                SlotFate::NotConverged
            }
            Landing::On { position, .. } if !self.surface.bounds.holds(position) => SlotFate::Outside,
            Landing::On { position, normal } => return Some((position, normal)),
        };
        self.decide(child, fate, None);
        None
    }

    /// The position and normal of a particle that is moved to `target` and brought back to the surface; `None` at the border of the box,
    /// where the field ends, or around a fold.
    pub(crate) fn come_back(&mut self, own: &Particle, target: DVec3, reach: f64) -> Option<(DVec3, DVec3)> {
        let residual = self.rules.residual * own.radius;
        match self.surface.land_by_newton(target, reach, residual, &mut |_| {}) {
            Landing::On { position, normal }
                if self.surface.bounds.holds(position) && normal.dot(own.n()) > 0.0 =>
            {
                Some((position, normal))
            }
            _ => None,
        }
    }
}
