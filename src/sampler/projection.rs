//! Projection of points onto the surface: on a circle around the parent, which keeps the distance
//! (paper §4.3), or [along the gradient](crate::field::descent) (for seeds and the relaxation).
//! Points are projected in batches, so that the field is evaluated in SIMD lanes.

use crate::field::descent::{self, Descents, descend, unit};
use crate::math::{newton, sort_few};
use crate::sampler::probe::{BATCH, Probe, ProbeMemory};
use glam::Vec3;

/// A Newton correction shorter than this, in radii, is not checked by another evaluation: the
/// residual that it leaves is of the order of its square. Smaller: more evaluations.
pub(crate) const TRUSTED_CORRECTION: f32 = 0.02;

/// Largest number of steps of the bracketed search, over all brackets of a circle: with those of
/// Newton's method 50.
const MAX_BRACKET_STEPS: u32 = 38;

/// Largest turn of a Newton step on a circle, as the tangent of half the angle: about 23°.
pub(crate) const MAX_TURN: f32 = 0.2;

/// Smallest cos θ: the circle is searched up to about 100° from the tangent plane, as far as the
/// bracketed search goes.
pub(crate) const MIN_COS: f32 = -0.18;

/// Smallest sine of the angle between circle and surface at which Newton's method is trusted: about
/// 6°.
pub(crate) const MIN_CROSSING: f32 = 0.1;

/// Largest ratio of |f| after a Newton step to |f| before it; above it the bracketed search takes
/// over.
const MAX_RATIO: f32 = 0.7;

/// Number of intervals into which the bracketed search divides the arc. Two crossings in one of
/// them, of 6.3° or a fifth of the repulsion radius, are not seen.
const ARC_SAMPLES: usize = 32;

/// The circle C(p, 2r) in the plane of the parent's normal and one tangent direction.
///
/// The circle has the points p + 2r (cos θ V̂ + sin θ N̂), which is the paper's formula with the
/// centre added.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChildCircle {
    /// Parent position p.
    pub(crate) centre: Vec3,
    /// Parent normal N̂.
    pub(crate) normal: Vec3,
    /// Unit tangent direction V̂ of the slot.
    pub(crate) direction: Vec3,
    /// Distance 2r between parent and child.
    pub(crate) radius: f32,
    /// cos θ and sin θ of the guess.
    pub(crate) guess: [f32; 2],
}

impl ChildCircle {
    /// Returns the point at an angle, given by its cosine and sine.
    pub(crate) fn point(&self, [cos, sin]: [f32; 2]) -> Vec3 {
        self.centre + (self.direction * cos + self.normal * sin) * self.radius
    }

    /// Returns the derivative of the point by θ.
    pub(crate) fn tangent(&self, [cos, sin]: [f32; 2]) -> Vec3 {
        (self.normal * cos - self.direction * sin) * self.radius
    }
}

/// Result of the search on a circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum CircleLanding {
    /// The search has met the surface.
    On {
        /// Point of the surface.
        position: Vec3,
        /// Unit outward normal there.
        normal: Vec3,
    },
    /// The search has met no point of the surface.
    NotConverged,
    /// The field is undefined there, or its gradient counts as zero.
    Undefined,
}

/// Criterion for a point to be on the surface.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tolerance {
    /// Largest |f|/|∇f|.
    pub(crate) residual: f32,
    /// Largest |∇f| that counts as zero, where the surface has no normal.
    pub(crate) min_gradient: f32,
}

impl Tolerance {
    /// Returns whether |∇f| can be divided by: it does not count as zero, and does not overflow, as
    /// it does next to a pole, where any value would be small compared with it.
    pub(crate) fn is_slope(&self, slope: f32) -> bool {
        slope > self.min_gradient && slope < f32::INFINITY
    }
}

/// The search on a circle, by Newton's method, under way.
#[derive(Clone, Copy)]
struct Active {
    /// Index of the circle in the batch.
    circle: u32,
    steps: u32,
    /// cos θ and sin θ of the next point.
    turn: [f32; 2],
    /// |f| at the last point.
    last: f32,
}

/// Two neighbouring samples of an arc, between which f changes its sign.
#[derive(Clone, Copy, Debug)]
struct Bracket {
    /// cos θ and sin θ of the first sample.
    turn: [f32; 2],
    /// f at the first sample.
    first: f32,
    /// f at the last sample.
    last: f32,
}

impl Probe<'_> {
    /// Finds the point of the surface nearest to the guess on each of at most [`BATCH`] circles.
    /// `landing[i]` belongs to `circles[i]`.
    ///
    /// Newton's method in θ takes two evaluations from a good guess. If it does not converge, a
    /// bracketed search follows. Both together take at most 50 steps, so the search ends on any
    /// field.
    pub(crate) fn land_on_circles(
        &mut self,
        circles: &[ChildCircle],
        tolerance: Tolerance,
        landing: &mut Vec<CircleLanding>,
    ) {
        debug_assert!(circles.len() <= BATCH);
        landing.clear();
        landing.resize(circles.len(), CircleLanding::NotConverged);
        let mut active = [Active { circle: 0, steps: 0, turn: [1.0, 0.0], last: f32::INFINITY }; BATCH];
        for (i, circle) in circles.iter().enumerate() {
            active[i].circle = i as u32;
            active[i].turn = circle.guess;
        }
        let mut unsettled = [0_u32; BATCH];
        let mut unsettled_count = 0;
        let mut count = circles.len();
        while count > 0 {
            let ProbeMemory { points, value, gradient, evaluations, .. } = &mut *self.memory;
            points.clear();
            points.extend(active[..count].iter().map(|a| circles[a.circle as usize].point(a.turn)));
            *evaluations += count as u64;
            self.field.gradients(points, &mut value[..count], &mut gradient[..count]);
            let mut kept = 0;
            for k in 0..count {
                let mut a = active[k];
                let circle = &circles[a.circle as usize];
                let (value, gradient) = (value[k], gradient[k]);
                let slope = gradient.length();
                if value.abs() <= tolerance.residual * slope && tolerance.is_slope(slope) {
                    landing[a.circle as usize] =
                        CircleLanding::On { position: points[k], normal: unit(gradient, slope) };
                    continue;
                }
                a.steps += 1;
                let derivative = gradient.dot(circle.tangent(a.turn));
                let half = (-0.5 * value / derivative).clamp(-MAX_TURN, MAX_TURN);
                a.turn = turned(a.turn, half);
                let settles = value.abs() <= MAX_RATIO * a.last
                    && derivative.abs() > MIN_CROSSING * slope * circle.radius
                    && a.turn[0] > MIN_COS
                    && a.steps < newton::STEPS;
                a.last = value.abs();
                // A NaN either makes `settles` false or stays in the position until it does.
                if settles && half.is_finite() && tolerance.is_slope(slope) {
                    active[kept] = a;
                    kept += 1;
                } else {
                    unsettled[unsettled_count] = a.circle;
                    unsettled_count += 1;
                }
            }
            count = kept;
        }
        for &i in &unsettled[..unsettled_count] {
            landing[i as usize] = self.search_arc(&circles[i as usize], tolerance);
        }
    }

    /// Walks along the surface from the centre of a circle to the circle, in small steps, so that
    /// it stays on the sheet of the centre where others are near.
    pub(crate) fn walk(&mut self, circle: &ChildCircle, tolerance: Tolerance) -> CircleLanding {
        /// Steps from the centre to the circle. A choice.
        const STEPS: u32 = 8;
        /// Newton steps in the plane of the circle after each. More take more evaluations.
        const LANDINGS: u32 = 2;
        let &ChildCircle { centre, normal, direction, radius, .. } = circle;
        let plane = |v: Vec3| direction * v.dot(direction) + normal * v.dot(normal);
        let step = radius / STEPS as f32;
        let (mut p, mut n) = (centre, normal);
        // The turn of the normal over a step, as a rise: κ step²/2, with sin θ = −κ r on the circle
        // of radius 2r.
        let mut rise = circle.guess[1] * step / STEPS as f32;
        for _ in 0..STEPS {
            let ahead = direction * n.dot(normal) - normal * n.dot(direction);
            let before = n;
            p += ahead * step + n * rise;
            for _ in 0..LANDINGS {
                let (value, gradient) = self.gradient(p);
                let within = plane(gradient);
                p -= descent::step(value, within);
                n = within.normalize_or_zero();
            }
            if n == Vec3::ZERO || !p.is_finite() || n.dot(before) <= 0.0 {
                return CircleLanding::NotConverged;
            }
            rise = -0.5 * step * (n - before).dot(ahead);
        }
        let offset = p - centre;
        let [cos, sin] = [offset.dot(direction), offset.dot(normal)];
        let length = (cos * cos + sin * sin).sqrt();
        let mut landing = Vec::new();
        let circle = ChildCircle { guess: [cos / length, sin / length], ..*circle };
        self.land_on_circles(&[circle], tolerance, &mut landing);
        landing[0]
    }

    /// Finds the root on the arc that is nearest to the guess, by bracketing and the Illinois
    /// method.
    fn search_arc(&mut self, circle: &ChildCircle, tolerance: Tolerance) -> CircleLanding {
        // θ runs over ±100° in equal steps from the tangent plane.
        let half = HALF_TURN;
        let mut turns = [[1.0, 0.0]; ARC_SAMPLES + 1];
        for k in 0..ARC_SAMPLES / 2 {
            turns[ARC_SAMPLES / 2 + k + 1] = turned(turns[ARC_SAMPLES / 2 + k], half);
            turns[ARC_SAMPLES / 2 - k - 1] = turned(turns[ARC_SAMPLES / 2 - k], -half);
        }
        let points = turns.map(|turn| circle.point(turn));
        let mut f = [0.0; ARC_SAMPLES + 1];
        self.field.values(&points, &mut f);
        self.count(f.len() as u64);
        if f.iter().all(|v| !v.is_finite()) {
            return CircleLanding::Undefined;
        }
        // Brackets are tried in the order of their angle to the guess: its cosine falls.
        let nearness = |k: usize| {
            let middle = turned(turns[k], 0.5 * half);
            middle[0] * circle.guess[0] + middle[1] * circle.guess[1]
        };
        let mut brackets = [(f32::NEG_INFINITY, 0_usize); ARC_SAMPLES];
        let mut count = 0;
        for k in 0..ARC_SAMPLES {
            if f[k].is_finite() && f[k + 1].is_finite() && (f[k] <= 0.0) != (f[k + 1] <= 0.0) {
                brackets[count] = (nearness(k), k);
                count += 1;
            }
        }
        sort_few(&mut brackets[..count], |a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)).is_lt());
        let mut budget = MAX_BRACKET_STEPS;
        for &(_, k) in &brackets[..count] {
            let bracket = Bracket { turn: turns[k], first: f[k], last: f[k + 1] };
            let found = self.illinois(circle, tolerance, bracket, &mut budget);
            if let Some(landing) = found {
                return landing;
            }
        }
        let undefined = f.iter().filter(|v| !v.is_finite()).count();
        if count == 0 && undefined > ARC_SAMPLES / 2 {
            CircleLanding::Undefined
        } else {
            CircleLanding::NotConverged
        }
    }

    /// Finds the root in a bracket; `None` if the sign changes at a pole or a jump.
    fn illinois(
        &mut self,
        circle: &ChildCircle,
        tolerance: Tolerance,
        Bracket { turn, first: mut fa, last: mut fb }: Bracket,
        budget: &mut u32,
    ) -> Option<CircleLanding> {
        // The unknown t is the tangent of half the angle from the start of the bracket.
        let (mut a, mut b) = (0.0, HALF_TURN);
        let end = fa.abs().max(fb.abs());
        let mut side = 0;
        while *budget > 0 {
            *budget -= 1;
            let mut t = (a * fb - b * fa) / (fb - fa);
            if !(t > a && t < b) {
                t = 0.5 * (a + b);
            }
            let position = circle.point(turned(turn, t));
            let (value, gradient) = self.gradient(position);
            if !value.is_finite() || value.abs() > end {
                return None;
            }
            let slope = gradient.length();
            if value.abs() <= tolerance.residual * slope {
                return Some(if tolerance.is_slope(slope) {
                    CircleLanding::On { position, normal: unit(gradient, slope) }
                } else {
                    CircleLanding::Undefined
                });
            }
            if b - a <= f32::EPSILON {
                return None;
            }
            if (value <= 0.0) == (fa <= 0.0) {
                (a, fa) = (t, value);
                if side == 1 {
                    fb *= 0.5;
                }
                side = 1;
            } else {
                (b, fb) = (t, value);
                if side == 2 {
                    fa *= 0.5;
                }
                side = 2;
            }
        }
        None
    }

    /// Calls [`descend`] and counts its evaluations.
    pub(crate) fn land_along_gradient(
        &mut self,
        points: &mut [Vec3],
        normal: &mut [Vec3],
        ok: &mut [bool],
        min_gradient: f32,
        descents: &mut impl Descents,
        max_steps: u32,
    ) {
        let evaluations = descend(self.field, points, normal, ok, min_gradient, descents, max_steps);
        self.count(evaluations);
    }
}

/// Tangent of half the angle between two samples of the arc: 16 steps of 6.3° to either side, which
/// reach [`MIN_COS`]. With a smaller angle, and so a shorter arc, more children find no place.
const HALF_TURN: f32 = 0.055;

/// Rotates (cos θ, sin θ) by the angle whose half has the tangent `t`, by arithmetic alone and
/// exactly up to rounding.
pub(crate) fn turned([cos, sin]: [f32; 2], t: f32) -> [f32; 2] {
    let scale = 1.0 / (1.0 + t * t);
    let (c, s) = ((1.0 - t * t) * scale, 2.0 * t * scale);
    [cos * c - sin * s, sin * c + cos * s]
}

/// Limits for the residual |f|/|∇f| of a particle. The paper stops "when the child has converged"
/// (§4.3) and gives no number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ResidualLimits {
    /// The smallest distance that single precision resolves on this field.
    pub(crate) finest: f32,
    /// The distance within which a particle cannot be mistaken for one of another sheet.
    pub(crate) coarsest: f32,
}

impl ResidualLimits {
    /// Nothing is known of the field.
    pub(crate) const UNLIMITED: Self = Self { finest: 0.0, coarsest: f32::INFINITY };

    /// Returns the largest |f|/|∇f| allowed for a particle of a radius: 10⁻⁴ r, within these
    /// limits. A smaller share takes more evaluations.
    pub(crate) fn residual(self, radius: f32) -> f32 {
        (1e-4 * radius).min(self.coarsest).max(self.finest)
    }
}

/// Returns the tolerance for particles of a radius. A gradient below a millionth of the usual
/// `gradient_scale` is cancellation noise at a singular point.
pub(crate) fn tolerance(radius: f32, residual_limits: ResidualLimits, gradient_scale: f32) -> Tolerance {
    Tolerance { residual: residual_limits.residual(radius), min_gradient: 1e-6 * gradient_scale }
}
