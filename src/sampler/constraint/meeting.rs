//! Points where several branches of f vanish.

use super::{AT_REST, BESIDE};
use crate::math::newton::{self, STEPS, StepLimits, step_to_corner, step_to_curve, step_to_surface};
use crate::math::{Bounds, SHARP, SQRT_3};
use crate::sampler::probe::Probe;
use glam::DVec3;

/// Least sine of the angle between two branches at which their crease is traced; below it the
/// crease has faded out. At the distance [`ASIDE`] the angle then still outweighs the bend of a
/// branch, which is half of `ASIDE` squared if the radius of curvature is the reach.
pub(super) const FADED: f64 = 10.0 * ASIDE;
/// Distance from a crease, as a share of the reach, at which the evaluator is asked which branch
/// gives f. The branches differ there by [`FADED`] times that distance, far above rounding.
pub(super) const ASIDE: f64 = 1e-4;

/// Cosine of the largest turn of a crease in one step, 30°. A step with a larger turn is halved.
pub(super) const MOST_TURN: f64 = 0.5 * SQRT_3;

/// A point where two patches meet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Meeting {
    pub(super) position: DVec3,
    /// The branches, in ascending order.
    pub(super) branches: [u32; 2],
    /// Unit vector along the crease.
    pub(super) tangent: DVec3,
    /// Sine of the angle between the branches; 0 on a [smooth join](super::smooth).
    pub(super) sine: f64,
}

/// Limits of a search within `reach`.
pub(super) fn limits(reach: f64) -> StepLimits {
    StepLimits { reach, at_rest: AT_REST * reach, ..StepLimits::steps(STEPS) }
}

/// Value and gradient of a branch at a point.
pub(super) fn branch(probe: &mut Probe, branch: u32, p: DVec3) -> (f64, DVec3) {
    probe.count(1);
    probe.on(Some(branch)).field.value_and_gradient(p)
}

/// Whether a point lies on the sheet of a branch, up to a distance.
pub(super) fn is_on(probe: &mut Probe, b: u32, p: DVec3, slack: f64) -> bool {
    let (value, gradient) = branch(probe, b, p);
    value.abs() <= slack * gradient.length()
}

/// The point on the surface near a place where two branches touch without an angle, so that a point
/// on one branch is on the other, too.
pub(super) fn touching_point(probe: &mut Probe, [first, _]: [u32; 2], start: DVec3) -> DVec3 {
    let mut p = start;
    // Each step doubles the number of correct digits; the start has some.
    for _ in 0..4 {
        p -= step_to_surface(branch(probe, first, p));
    }
    if p.is_finite() { p } else { start }
}

impl Meeting {
    /// The point near `start`, within `reach`, where both branches vanish and meet at an angle of
    /// at least this sine, whichever branch gives f there.
    pub(super) fn of_branches(
        probe: &mut Probe,
        branches: [u32; 2],
        start: DVec3,
        reach: f64,
        least_sine: f64,
    ) -> Option<Self> {
        let step_at = |p| {
            let slopes = branches.map(|b| branch(probe, b, p));
            let (step, tangent) = step_to_curve(slopes);
            let [(_, u), (_, v)] = slopes;
            let scale_sq = u.length_squared() * v.length_squared();
            let is_angle = tangent.length_squared() > (least_sine * least_sine) * scale_sq;
            is_angle.then_some((step, (tangent, scale_sq)))
        };
        let (position, (tangent, scale_sq)) = newton::land(start, limits(reach), step_at)?;
        let length = tangent.length();
        Some(Self { position, branches, tangent: tangent / length, sine: length / scale_sq.sqrt() })
    }

    /// Points of the creases of two branches that end at a corner.
    pub(super) fn beside_corner(probe: &mut Probe, [a, b]: [u32; 2], corner: DVec3, step: f64) -> Vec<Self> {
        let branches = [a.min(b), a.max(b)];
        let reach = BESIDE * step;
        let Some(at_corner) = Self::of_branches(probe, branches, corner, reach, SHARP) else {
            return Vec::new();
        };
        let places = [at_corner.tangent, -at_corner.tangent].map(|way| corner + way * reach);
        let points = places.map(|place| Self::of_branches(probe, branches, place, reach, SHARP));
        let mut points: Vec<Self> = points.into_iter().flatten().collect();
        points.retain(|point| point.are_left(probe, &branches, step).is_some());
        points
    }

    /// Whether the patches of these branches are on the left of the crease, in the direction of its
    /// tangent and seen from outside. There is no crease if one of the branches gives f on neither
    /// side, or on both.
    pub(super) fn are_left(&self, probe: &mut Probe, branches: &[u32], reach: f64) -> Option<Vec<bool>> {
        let mut are_left = Vec::with_capacity(branches.len());
        for &b in branches {
            let [left, right] = self.gives(probe, b, reach)?;
            if left == right {
                return None;
            }
            are_left.push(left);
        }
        Some(are_left)
    }

    /// Whether a branch gives f outside its sheet, on the left and on the right of the tangent;
    /// none if it has no sheet there.
    fn gives(&self, probe: &mut Probe, b: u32, reach: f64) -> Option<[bool; 2]> {
        let (_, gradient) = branch(probe, b, self.position);
        let aside = gradient.cross(self.tangent).try_normalize()?;
        // √(u² + v²) vanishes on a curve, not on a sheet: its gradient points away from the curve.
        let (_, beside) = branch(probe, b, self.position + aside * (ASIDE * reach));
        if gradient.dot(beside) < MOST_TURN * gradient.length() * beside.length() {
            return None;
        }
        let (outward, apart) = (gradient.normalize_or_zero(), ASIDE * reach);
        let mut is_given = |way: DVec3| {
            probe.count(1);
            probe.on(Some(b)).gives_beside(self.position + way * apart, outward, apart, b)
        };
        Some([aside, -aside].map(&mut is_given))
    }

    /// Whether each branch gives f on both sides: their sheets cross, and no patch ends.
    pub(super) fn is_passed(&self, probe: &mut Probe, reach: f64) -> bool {
        self.branches.into_iter().all(|b| self.gives(probe, b, reach) == Some([true; 2]))
    }

    /// Whether f vanishes at the point without a surface there.
    pub(super) fn is_bare(&self, probe: &mut Probe, reach: f64) -> bool {
        probe.is_bare_zero(self.position, reach)
    }

    /// The branches that may give f near the point.
    pub(super) fn branches_near(&self, probe: &mut Probe, step: f64) -> Vec<u32> {
        let around = Bounds::new(self.position - BESIDE * step, self.position + BESIDE * step);
        probe.field.labels_in(&around).unwrap_or_default()
    }

    /// The patches that meet along the crease, in ascending order: those of its branches, and of
    /// other branches that vanish on it.
    pub(super) fn patches(&self, probe: &mut Probe, reach: f64) -> Vec<u32> {
        let others = self.branches_near(probe, reach);
        let mut patches = self.branches.to_vec();
        for other in others.into_iter().filter(|other| !self.branches.contains(other)) {
            let (value, gradient) = branch(probe, other, self.position);
            let is_zero = value.abs() <= ASIDE * ASIDE * reach * gradient.length()
                && gradient.dot(self.tangent).abs() <= FADED * gradient.length();
            if is_zero && self.are_left(probe, &[other], reach).is_some() {
                patches.push(other);
            }
        }
        patches.sort_unstable();
        patches
    }
}

/// The point near `start`, within `reach`, where a plane and two branches, or three branches,
/// vanish.
pub(super) fn common_point(
    probe: &mut Probe,
    branches: [u32; 2],
    third: Third,
    start: DVec3,
    reach: f64,
) -> Option<DVec3> {
    let step_at = |p| {
        let [first, second] = branches.map(|b| branch(probe, b, p));
        let third = match third {
            Third::Branch(b) => branch(probe, b, p),
            Third::Plane { axis, offset } => (p[axis] - offset, DVec3::AXES[axis]),
        };
        let (step, volume) = step_to_corner([first, second, third]);
        (volume > FADED * FADED).then_some((step, ()))
    };
    newton::land(start, limits(reach), step_at).map(|(p, ())| p)
}

/// The third function that vanishes at a corner, in addition to two branches.
#[derive(Clone, Copy, Debug)]
pub(super) enum Third {
    /// A third branch.
    Branch(u32),
    /// The plane across an axis at this coordinate.
    Plane { axis: usize, offset: f64 },
}
