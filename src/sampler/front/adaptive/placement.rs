//! Direct placement of children, the paper's "way to directly place the children even for the
//! non-uniform sampling" (§7):
//! |c − p| = r_p + r(c) with c on the surface, solved for the angle on the circle and the distance at once, a batch at a
//! time.

use crate::differential::{Curvature, curvatures_of};
use crate::math::Sym3;
use crate::sampler::front::adaptive::MAX_SLOPE;
use crate::sampler::front::level::{ChildLanding, SurfacePoint};
use crate::sampler::probe::{BATCH, Probe};
use crate::sampler::projection::{
    ChildCircle, CircleLanding, MAX_TURN, MIN_COS, MIN_CROSSING, Tolerance, turned,
};
use crate::sampler::sizing::Sizing;
use glam::Vec3;

/// Largest difference between the distance from the parent and r_p + r_c, as a share of r_c.
pub(crate) const TOUCH: f32 = 2e-3;

/// A correction of the distance shorter than this share of r_c is accepted without another
/// evaluation. The error that remains is the change of the radius beyond its slope. Smaller: more
/// evaluations.
const TRUSTED_PULL: f32 = 0.02;

/// Largest number of evaluations of Newton's method. A good guess takes one or two; where it has
/// not come to its end by then, the search goes on in brackets.
const MAX_STEPS: u32 = 8;

/// Largest change of the distance in a step, as a share of the distance: it stays positive. Only
/// creased surfaces meet the bound.
const MAX_PULL: f32 = 0.3;

/// Rounds of the safeguarded search, of which each finds a root on the circle and then corrects the
/// distance. Children take some where the surface bends within a particle, and where f ends.
const MAX_ROUNDS: u32 = 6;

/// Where the radius jumps, no distance fits exactly. A child is accepted if it misses by at most
/// this share of its radius.
const LOOSE_TOUCH: f32 = 0.5;

/// A child to be placed: the data of the problem |c − p| = r_p + r(c).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Proposal {
    /// The circle of the first guess; its radius is the guessed distance from the parent.
    pub(crate) circle: ChildCircle,
    /// Number of the parent in its level.
    pub(crate) parent: u32,
    /// Radius of the parent.
    pub(crate) parent_radius: f32,
    /// Change of the radius per length away from the parent, as guessed.
    pub(crate) slope: f32,
    /// Largest radius that the particles around allow.
    pub(crate) largest: f32,
}

impl Proposal {
    /// Limits the radius that the sizing law gives to what the particles around allow: never less
    /// than `least`, the smallest radius of the law.
    fn graded(&self, radius: f32, least: f32) -> f32 {
        let largest = if self.largest > least { self.largest } else { least };
        // NaN stays.
        if radius > largest { largest } else { radius }
    }
}

/// A proposal that is not solved yet.
#[derive(Clone, Copy)]
struct ActiveProposal {
    proposal: u32,
    steps: u32,
    turn: [f32; 2],
    distance: f32,
    slope: f32,
    /// Distance and radius of the previous step.
    last: [f32; 2],
    last_value: f32,
}

/// Solver for batches of proposals, with its buffers.
#[derive(Clone, Debug, Default)]
pub(crate) struct DirectPlacement {
    points: Vec<Vec3>,
    value: Vec<f32>,
    gradient: Vec<Vec3>,
    hessian: Vec<Sym3<f32>>,
    curvature: Vec<Curvature>,
    /// Radii of the law at the points.
    radius: Vec<f32>,
    landing: Vec<CircleLanding>,
}

impl DirectPlacement {
    fn evaluate(&mut self, probe: &mut Probe, sizing: &Sizing) {
        let n = self.points.len();
        self.value.resize(BATCH, 0.0);
        self.gradient.resize(BATCH, Vec3::ZERO);
        self.hessian.resize(BATCH, Sym3::default());
        self.curvature.resize(BATCH, Curvature::default());
        self.radius.resize(BATCH, 0.0);
        probe.hessians(&self.points, &mut self.value[..n], &mut self.gradient[..n], &mut self.hessian[..n]);
        curvatures_of(&self.gradient[..n], &self.hessian[..n], &mut self.curvature[..n]);
        sizing.radii(&self.points, &self.curvature[..n], &mut self.radius[..n]);
    }

    /// Evaluates normal, radius and curvature at one point on the surface or near it.
    pub(crate) fn look(&mut self, probe: &mut Probe, sizing: &Sizing, position: Vec3) -> SurfacePoint {
        self.points.clear();
        self.points.push(position);
        self.evaluate(probe, sizing);
        let (curvature, radius) = (self.curvature[0], self.radius[0]);
        SurfacePoint { position, normal: self.gradient[0] / self.gradient[0].length(), radius, curvature }
    }

    /// Solves at most [`BATCH`] proposals: Newton's method in the angle and a secant in the
    /// distance, together; a bracketed search on the circle, by turns with the distance, where
    /// those do not settle. `landed[i]` belongs to `proposals[i]`.
    pub(crate) fn land(
        &mut self,
        probe: &mut Probe,
        sizing: &Sizing,
        proposals: &[Proposal],
        tolerance: &dyn Fn(f32) -> Tolerance,
        landed: &mut Vec<ChildLanding>,
    ) {
        debug_assert!(proposals.len() <= BATCH);
        landed.clear();
        landed.resize(proposals.len(), ChildLanding::NotConverged);
        let idle = ActiveProposal {
            proposal: 0,
            steps: 0,
            turn: [1.0, 0.0],
            distance: 0.0,
            slope: 0.0,
            last: [0.0; 2],
            last_value: f32::INFINITY,
        };
        let mut active = [idle; BATCH];
        for (i, proposal) in proposals.iter().enumerate() {
            active[i] = ActiveProposal {
                proposal: i as u32,
                turn: proposal.circle.guess,
                distance: proposal.circle.radius,
                slope: proposal.slope,
                ..idle
            };
        }
        let mut unsettled = [0_u32; BATCH];
        let mut unsettled_count = 0;
        let mut count = proposals.len();
        while count > 0 {
            self.points.clear();
            self.points.extend(active[..count].iter().map(|a| {
                ChildCircle { radius: a.distance, ..proposals[a.proposal as usize].circle }.point(a.turn)
            }));
            self.evaluate(probe, sizing);
            let mut kept = 0;
            for k in 0..count {
                let mut a = active[k];
                let i = a.proposal as usize;
                match self.advance(sizing, &proposals[i], tolerance, k, &mut a) {
                    NewtonStep::Landed(spot) => landed[i] = ChildLanding::On(spot),
                    NewtonStep::Again => {
                        active[kept] = a;
                        kept += 1;
                    }
                    NewtonStep::Lost => {
                        unsettled[unsettled_count] = a.proposal;
                        unsettled_count += 1;
                    }
                }
            }
            count = kept;
        }
        for &i in &unsettled[..unsettled_count] {
            landed[i as usize] = self.search(probe, sizing, &proposals[i as usize], tolerance);
        }
    }

    /// Makes one step in the two unknowns, from the evaluation at place `k` of the batch.
    fn advance(
        &self,
        sizing: &Sizing,
        proposal: &Proposal,
        tolerance: &dyn Fn(f32) -> Tolerance,
        k: usize,
        a: &mut ActiveProposal,
    ) -> NewtonStep {
        let (position, value, gradient) = (self.points[k], self.value[k], self.gradient[k]);
        let hessian = &self.hessian[k];
        let curvature = self.curvature[k];
        let slope = gradient.length();
        let radius = proposal.graded(self.radius[k], sizing.least());
        let tolerance = tolerance(radius);
        let residual = tolerance.residual;
        // NaN is never greater.
        if !(tolerance.is_slope(slope) && radius > 0.0) {
            return NewtonStep::Lost;
        }
        let touch = a.distance - proposal.parent_radius - radius;
        let way = a.distance - a.last[0];
        if a.steps > 0 && way.abs() > TOUCH * radius {
            a.slope = ((radius - a.last[1]) / way).clamp(-MAX_SLOPE, MAX_SLOPE);
        }
        a.last = [a.distance, radius];
        let circle = ChildCircle { radius: a.distance, ..proposal.circle };
        // The limits are constants, in shares of the distance: with others `clamp` can panic, and
        // its message would have to be linked.
        let pull = (-touch / ((1.0 - a.slope) * a.distance)).clamp(-MAX_PULL, MAX_PULL) * a.distance;
        let radial = (position - circle.centre) / a.distance;
        let derivative = gradient.dot(circle.tangent(a.turn));
        let half = (-0.5 * (value + gradient.dot(radial) * pull) / derivative).clamp(-MAX_TURN, MAX_TURN);
        a.turn = turned(a.turn, half);
        a.distance += pull;
        a.steps += 1;
        // The Hessian predicts f at the corrected place. If that is within the tolerance, no
        // evaluation is needed there.
        let corrected = ChildCircle { radius: a.distance, ..proposal.circle }.point(a.turn);
        let moved = corrected - position;
        let corrected_gradient = gradient + hessian.apply(moved);
        let corrected_slope = corrected_gradient.length();
        let left = value + 0.5 * (gradient + corrected_gradient).dot(moved);
        if left.abs() <= 0.5 * residual * corrected_slope
            && tolerance.is_slope(corrected_slope)
            && moved.length_squared() <= (TRUSTED_MOVE * radius) * (TRUSTED_MOVE * radius)
            && pull.abs() <= TRUSTED_PULL * radius
        {
            return NewtonStep::Landed(SurfacePoint {
                position: corrected,
                normal: corrected_gradient / corrected_slope,
                radius: a.distance - proposal.parent_radius,
                curvature,
            });
        }
        if value.abs() <= residual * slope && touch.abs() <= TOUCH * radius {
            return NewtonStep::Landed(SurfacePoint {
                position,
                normal: gradient / slope,
                radius,
                curvature,
            });
        }
        let settles = value.abs() <= a.last_value
            && derivative.abs() > MIN_CROSSING * slope * circle.radius
            && a.turn[0] > MIN_COS
            && a.steps < MAX_STEPS
            && half.is_finite()
            && a.distance.is_finite();
        // |f| need not fall in a step that mostly changes the distance: it moves along the surface.
        a.last_value = value.abs() + residual * slope;
        if settles { NewtonStep::Again } else { NewtonStep::Lost }
    }

    /// Solves for the root on the circle and for the distance by turns. It ends on any field.
    fn search(
        &mut self,
        probe: &mut Probe,
        sizing: &Sizing,
        proposal: &Proposal,
        tolerance: &dyn Fn(f32) -> Tolerance,
    ) -> ChildLanding {
        let mut circle = proposal.circle;
        let guess = circle.radius;
        // The sign of the miss brackets the distance that fits.
        let (mut near, mut far) = (0.0_f32, f32::INFINITY);
        let mut best: Option<(f32, SurfacePoint)> = None;
        for _ in 0..MAX_ROUNDS {
            let allowed = tolerance(circle.radius - proposal.parent_radius);
            let mut landing = core::mem::take(&mut self.landing);
            probe.land_on_circles(&[circle], allowed, &mut landing);
            let result = landing[0];
            self.landing = landing;
            let position = match result {
                CircleLanding::On { position, .. } => position,
                CircleLanding::Undefined if best.is_none() => return ChildLanding::Undefined,
                _ => break,
            };
            let mut spot = self.look(probe, sizing, position);
            spot.radius = proposal.graded(spot.radius, sizing.least());
            if !(spot.radius > 0.0 && spot.normal.is_finite()) {
                return ChildLanding::Undefined;
            }
            let miss = circle.radius - proposal.parent_radius - spot.radius;
            let relative = miss.abs() / spot.radius;
            if best.is_none_or(|(least, _)| relative < least) {
                best = Some((relative, spot));
            }
            if relative <= TOUCH {
                break;
            }
            if miss < 0.0 {
                near = near.max(circle.radius);
            } else {
                far = far.min(circle.radius);
            }
            let next = circle.radius - miss;
            circle.radius =
                if next > near && next < far { next } else { 0.5 * (near + far.min(2.0 * guess)) };
        }
        match best {
            Some((miss, spot)) if miss <= LOOSE_TOUCH => ChildLanding::On(spot),
            _ => ChildLanding::NotConverged,
        }
    }
}

/// A correction shorter than this share of the radius is accepted without another evaluation: the
/// third-order term that the Hessian leaves out is then below a thousandth of the radius.
const TRUSTED_MOVE: f32 = 0.06;

/// The outcome of a step of Newton's method.
enum NewtonStep {
    Landed(SurfacePoint),
    Again,
    Lost,
}
