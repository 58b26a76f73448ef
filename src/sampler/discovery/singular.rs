//! Points of the surface where f has no gradient: cone points, cusps, and the curves on which a
//! surface crosses itself.
//!
//! # Why a box around one can be left out of the search
//!
//! Let B be a box in the interior of which f has no local extremum. Then every connected component
//! of the surface S in B reaches the boundary of B. For suppose that a component K does not. It has
//! a neighbourhood U in B on whose boundary f is not 0; take the part of U that holds K, and fill
//! its holes: an open set W with a connected boundary, on which f has one sign, say positive. Every
//! neighbourhood of a point of K holds places where f is negative, otherwise that point would be a
//! minimum. So f has a negative minimum in W: a local extremum.
//!
//! There is no extremum if the second derivative of f along one fixed direction is positive
//! throughout B, and along another one negative: at a minimum neither is negative, at a maximum
//! neither positive. This holds around a cone point, whose tangent cone is the zero set of an
//! indefinite quadratic form, up to a size that bounds of the second derivatives give.

use crate::field::{Bounded, Enclosure, Evaluator};
use crate::math::{Bounds, Forest, Interval, ROUNDING, Sym3, sort_few};
use crate::particles::{Particles, Slots};
use crate::sampler::probe::BATCH;
use crate::spatial::tree::Tree;
use core::f64::consts::TAU;
use glam::{DMat3, DVec3, Vec3};

/// Number of sizes that are tried for a box around a singular point: the longest side of the whole
/// box, then each half of the one before.
const SIZES: usize = 10;
/// Number of sizes, above the largest one that is proven as a whole, to try in sub-boxes. Without
/// any, fewer surfaces with cone points are proven.
const MOST_LARGER: usize = 2;
/// Number of sub-boxes: three along each axis.
const SUB_BOXES: usize = 27;
/// Distances of the sides of a box around a singular point from the point, in units of its size.
/// They differ, because in a symmetric box a symmetric surface has several of its highest points in
/// one place, where they cannot be separated.
const BELOW: DVec3 = DVec3::new(0.967, 0.983, 0.941);
const ABOVE: DVec3 = DVec3::new(0.953, 0.929, 0.991);

/// Largest number of Newton steps to a singular point: even if each only halves the distance, as at
/// a cusp, less than 10⁻⁷ of it is left.
const MOST_STEPS: u32 = 24;
/// Step lengths at which Newton's method ends, over the search distance: at an isolated singular
/// point, and at another one. At a cusp each step only halves the distance.
const ENDS: [f64; 2] = [1e-12, 1e-7];
/// Largest |f| that counts as zero at a saddle of f, in units of |H| d², where H is the Hessian and
/// d the search distance. It is far above rounding: cone points open where coefficients are
/// rounded. Smaller: cone points are missed; larger: necks count as cone points.
const LARGEST_VALUE: f64 = 1e-8;
/// Largest |f|, in units of |H| d², at the middle of the narrow neck that a cone point leaves when
/// it opens, which the search treats as a singular point. Smaller: fewer surfaces whose cone points
/// have opened are proven.
const LARGEST_NECK: f64 = 1e-3;
/// A direction along which the second derivatives are smaller than this share of the largest is
/// taken for the direction of a singular curve: the Newton step does not run along it. The share is
/// the root of the precision of second derivatives.
const SMALL: f64 = 1e-6;
/// Share that replaces [`SMALL`] where a Newton step leads too far: near a curve of singular points
/// the step would run along the curve. Without it curves are found in pieces.
const DAMPED: f64 = 0.1;
/// Factors by which steps shrink if the first nonzero derivatives are of third to eighth order: (n
/// − 2)/(n − 1). Such a step is lengthened to the limit of the steps. Without this some cusps are
/// missed.
const SLOW: core::ops::Range<f64> = 0.45..0.88;
/// Two singular points count as one if they are nearer to each other than this share of the search
/// distance: Newton's method ends at 10⁻¹² of it. A tip so near to one is the same point.
pub(crate) const SAME: f64 = 1e-6;
/// Distance from a point of the survey within which a singular point is searched, in spacings of
/// its grid: the diagonal of a cell.
const NEAR: f64 = 1.75;
/// Points of a curve around which the signs of f are examined.
const LOOKED_AT: usize = 8;
/// Radius of the circles for this, as a share of the search distance. Smaller: the two sides of a
/// cusp are too near to each other to be distinguished; larger: other sheets are met.
const ROUND: f64 = 0.25;
/// Points on such a circle. Sheets that cross at less than 0.4° are not recognised.
const AROUND: usize = 1024;
/// Linked points within this share of the search distance are no curve: at a point where sheets
/// touch, Newton's method ends within a hundredth of it.
const ONE_PLACE: f64 = 0.25;

/// A point where the gradient of f vanishes and f is 0, or nearly so.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Singular {
    pub(crate) position: DVec3,
    /// Distance within which the point was searched for.
    pub(crate) reach: f64,
    /// Whether f is 0 at the point: up to rounding if f has a minimum or a maximum there, around
    /// which the surface is a small sphere or tube, or empty; at a saddle up to a small neck.
    pub(crate) is_zero: bool,
    /// Whether the point is isolated: the Hessian is regular, so the gradient vanishes nowhere else
    /// near it.
    pub(crate) is_alone: bool,
    /// Whether f has both signs on lines through the point, to second order.
    pub(crate) has_two_signs: bool,
    /// Whether f changes along only one direction, to second order.
    is_flat: bool,
}

impl Singular {
    /// Whether two points belong to one place: they are equal, or on one curve and found by
    /// overlapping searches. A search counts only up to the distance `farthest`.
    fn is_linked(&self, other: &Self, farthest: f64) -> bool {
        let share = if self.is_alone { SAME } else { 2.0 };
        let most = share * self.reach.min(other.reach).min(farthest);
        self.is_alone == other.is_alone && self.position.distance_squared(other.position) <= most * most
    }
}

/// Kind of the surface at a place where the gradient vanishes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SingularKind {
    /// A point: the tip of a cone or of a cusp.
    Point,
    /// A point at which two sheets touch.
    Touch,
    /// A curve that is no crossing.
    Curve,
    /// A curve along which the surface crosses itself.
    Crossing,
    /// A curve along which the surface ends in a cusp.
    Rim,
}

/// A place where the gradient vanishes on the surface.
#[derive(Clone, Debug)]
pub(crate) struct SingularPlace {
    /// A point of the place.
    pub(crate) position: DVec3,
    pub(crate) kind: SingularKind,
    /// The known points of a curve, or the point at which sheets touch.
    pub(crate) points: Vec<Singular>,
}

impl SingularPlace {
    /// The kind of the place by the signs of f around its points. Around a crossing, and across
    /// sheets that touch, there are four changes or more, around a cusp two, close together. Second
    /// derivatives do not distinguish these: near a cusp they differ from 0, and Newton's method
    /// ends near it.
    pub(crate) fn kind_by_signs(&self, field: &mut dyn Evaluator) -> SingularKind {
        match self.kind {
            SingularKind::Touch => self.kind_of_touch(field),
            SingularKind::Curve | SingularKind::Crossing if !self.points.is_empty() => {
                self.kind_of_curve(field)
            }
            kind => kind,
        }
    }

    fn kind_of_curve(&self, field: &mut dyn Evaluator) -> SingularKind {
        let (mut crosses, mut ends) = (false, false);
        for point in self.points.iter().step_by(self.points.len().div_ceil(LOOKED_AT)) {
            let radius = ROUND * point.reach;
            // For nearer points, rounding determines the direction.
            let away = |other: &&Singular| other.position.distance_squared(point.position);
            let others = self.points.iter().filter(|other| away(other) > radius * radius);
            let nearest = others.min_by(|a, b| away(a).total_cmp(&away(b)));
            let Some(along) = nearest.and_then(|other| (other.position - point.position).try_normalize())
            else {
                continue;
            };
            let changes = sign_changes_around(field, point.position, along, radius);
            crosses |= changes.len() > 2;
            ends |= matches!(changes[..], [a, b] if (b - a).min(AROUND - (b - a)) < AROUND / 4);
        }
        match (crosses, ends) {
            (true, _) => SingularKind::Crossing,
            (false, true) => SingularKind::Rim,
            (false, false) => SingularKind::Curve,
        }
    }

    fn kind_of_touch(&self, field: &mut dyn Evaluator) -> SingularKind {
        let touches = self.points.iter().any(|point| {
            let hessian = matrix(&field.jet(point.position).hessian);
            let columns = [hessian.x_axis, hessian.y_axis, hessian.z_axis];
            let longest =
                columns.into_iter().max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
            let Some(normal) = longest.and_then(DVec3::try_normalize) else { return true };
            // Circles in planes across the sheets.
            let (u, v) = normal.any_orthonormal_pair();
            let radius = ROUND * point.reach;
            [u, v, u + v, u - v].into_iter().any(|along| {
                sign_changes_around(field, point.position, along.normalize_or_zero(), radius).len() > 2
            })
        });
        if touches { SingularKind::Touch } else { SingularKind::Point }
    }
}

/// The places on a circle around a curve, of [`AROUND`], after which f changes its sign.
fn sign_changes_around(field: &mut dyn Evaluator, at: DVec3, along: DVec3, radius: f64) -> Vec<usize> {
    let (u, v) = along.any_orthonormal_pair();
    let signs: Vec<bool> = (0..AROUND)
        .map(|k| {
            let turn = TAU * k as f64 / AROUND as f64;
            field.value_and_gradient(at + radius * (libm::cos(turn) * u + libm::sin(turn) * v)).0 < 0.0
        })
        .collect();
    (0..AROUND).filter(|&k| signs[k] != signs[(k + 1) % AROUND]).collect()
}

/// Singular points and sharp bends near the points of a survey.
#[derive(Debug, Default)]
pub(crate) struct NearSurvey {
    pub(crate) points: Vec<Singular>,
    /// Points of the survey, far from each other, around which the surface bends sharply without a
    /// singular point; the sharpest first.
    pub(crate) bends: Vec<Bend>,
}

/// A point of the surface at which the gradient turns within a cell of the survey.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bend {
    pub(crate) position: DVec3,
    /// Square of the second derivatives over the first ones.
    sharpness: f64,
}

/// The singular points near the points of a survey, on a grid of this spacing: where the gradient
/// vanishes within a distance d, it is no longer than the Hessian times d.
pub(crate) fn near_survey(
    field: &mut dyn Evaluator,
    survey: &[Vec3],
    spacing: f64,
    bounds: &Bounds,
) -> NearSurvey {
    let reach = NEAR * spacing;
    let NearSurvey { points: mut found, mut bends } = NearSurvey::default();
    let mut tried: Vec<DVec3> = Vec::new();
    let mut value = [0.0; BATCH];
    let mut gradient = [Vec3::ZERO; BATCH];
    let mut hessian = [Sym3::splat(0.0); BATCH];
    for points in survey.chunks(BATCH) {
        field.hessians(points, &mut value, &mut gradient, &mut hessian);
        for (k, p) in points.iter().enumerate() {
            let (p, slope_sq) = (p.as_dvec3(), gradient[k].as_dvec3().length_squared());
            let most_sq = size_sq(&matrix(&hessian[k].map(f64::from))) * reach * reach;
            let is_near = |other: DVec3| other.distance_squared(p) <= spacing * spacing;
            // False for NaN.
            let is_start = slope_sq <= most_sq
                && !tried.iter().rev().copied().any(is_near)
                && !found.iter().any(|point| is_near(point.position));
            if !is_start {
                continue;
            }
            tried.push(p);
            let new = singular_point(field, p, reach)
                .filter(|point| point.is_zero && bounds.holds(point.position))
                .filter(|point| !(point.is_alone && found.iter().any(|other| point.is_linked(other, reach))));
            found.extend(new);
            let is_far = |other: DVec3| other.distance_squared(p) > reach * reach;
            let is_new = bends.iter().all(|bend| is_far(bend.position))
                && found.iter().all(|point| is_far(point.position));
            if is_new {
                let sharpness = most_sq / slope_sq;
                bends.push(Bend { position: p, sharpness });
            }
        }
    }
    sort_few(&mut bends, |a, b| a.sharpness > b.sharpness);
    NearSurvey { points: found, bends }
}

impl Singular {
    /// The tip of a cone, which f need not be differentiable at.
    pub(crate) fn tip(position: DVec3, spacing: f64) -> Self {
        let reach = NEAR * spacing;
        Self { position, reach, is_zero: true, is_alone: true, has_two_signs: true, is_flat: false }
    }
}

/// Finds a singular point within `reach` of `start`, by Newton's method on the gradient.
pub(crate) fn singular_point(field: &mut dyn Evaluator, start: DVec3, reach: f64) -> Option<Singular> {
    let (mut p, mut last) = (start, f64::INFINITY);
    let mut largest_sq = 0.0_f64;
    // False for NaN.
    let is_near = |offset: DVec3| offset.length_squared() <= reach * reach;
    for k in 0..MOST_STEPS {
        let jet = field.jet(p);
        if jet.gradient == DVec3::ZERO {
            break;
        }
        let hessian = matrix(&jet.hessian);
        let size_sq = size_sq(&hessian);
        largest_sq = largest_sq.max(size_sq);
        // The least squares solution of H δ = −∇f, which does not run along a curve of such points.
        let solved = |share: f64| {
            let damping = DMat3::from_diagonal(DVec3::splat(share * share * size_sq));
            (times(&hessian, &hessian) + damping).inverse() * (hessian * jet.gradient)
        };
        let step = solved(SMALL);
        let mut step = if is_near(step) { step } else { solved(DAMPED) };
        let factor = step.length() / last;
        last = step.length();
        if k % 3 == 2 && SLOW.contains(&factor) {
            step /= 1.0 - factor;
        }
        p -= step;
        if !is_near(step) || !is_near(p - start) {
            return None;
        }
        if step.length_squared() <= ENDS[0] * ENDS[0] * reach * reach {
            break;
        }
    }
    let jet = field.jet(p);
    let hessian = matrix(&jet.hessian);
    let size = size_sq(&hessian).sqrt();
    let (value, most) = (jet.value.abs(), size * reach * reach);
    let settled = jet.gradient.length() <= LARGEST_VALUE.sqrt() * size * reach;
    (settled && value <= LARGEST_NECK * most).then(|| {
        // Where the Hessian vanishes, too, rounding decides its signs.
        let vanishes = size <= SMALL.sqrt() * largest_sq.sqrt();
        let is_alone = !vanishes && hessian.determinant().abs() > SMALL * size * size * size;
        let end = ENDS[usize::from(!is_alone)];
        // Half-way between two near sheets f has no gradient, but a minimum. What is left of the
        // gradient beside it makes the second derivatives along the sheets differ from zero.
        let left = jet.gradient.length() / reach;
        let has_two_signs = !vanishes && has_two_signs(&jet.hessian, left.max(SMALL * size));
        let is_zero = value <= end * end * most
            || value <= LARGEST_VALUE * most && (has_two_signs || may_be_zero(field, p));
        // The sum of the products of two eigenvalues.
        let trace = hessian.x_axis.x + hessian.y_axis.y + hessian.z_axis.z;
        let is_flat = !is_alone && (trace * trace - size * size).abs() < SMALL.sqrt() * size * size;
        Singular { position: p, reach, is_zero, is_alone, has_two_signs, is_flat }
    })
}

/// Whether the second derivatives along some directions are above `least`, and along others below
/// −`least`.
fn has_two_signs(hessian: &Sym3<f64>, least: f64) -> bool {
    extreme_directions(hessian)
        .is_some_and(|[up, down]| up.dot(hessian.apply(up)) > least && down.dot(hessian.apply(down)) < -least)
}

/// Whether the gradient of f may jump on the surface in a box, as at the tip of a cone where f is a
/// distance. True if f has no bounds.
pub(crate) fn may_be_rough(field: &mut dyn Evaluator, bounds: &Bounds) -> bool {
    let Some(field) = field.bounded() else { return true };
    (0..field.factors()).any(|factor| {
        let mut known = [Enclosure::UNKNOWN];
        field.enclose(factor, &[*bounds], &mut known);
        known[0].may_vanish && !(known[0].defined && known[0].smooth)
    })
}

/// Whether rounding may hide that f is 0 at a point.
fn may_be_zero(field: &mut dyn Evaluator, p: DVec3) -> bool {
    let Some(field) = field.bounded() else { return false };
    (0..field.factors()).any(|factor| {
        let mut known = [Enclosure::UNKNOWN];
        field.enclose(factor, &[Bounds::point(p)], &mut known);
        known[0].value.holds(0.0)
    })
}

/// The places of these points: isolated points, and groups of the others that are linked. `spacing`
/// is the grid spacing of the survey, which meets every curve on the surface: if two points that a
/// farther search has found are on one curve, others lie between them.
pub(crate) fn places(points: &[Singular], spacing: f64) -> Vec<SingularPlace> {
    let farthest = NEAR * spacing;
    let mut groups = Forest::new(points.len());
    for (i, point) in (0..).zip(points) {
        (0..i).filter(|&j| points[j as usize].is_linked(point, farthest)).for_each(|j| groups.join(i, j));
    }
    let mut places = Vec::new();
    for (first, point) in (0..).zip(points) {
        if groups.find(first) != first {
            continue;
        }
        let group: Vec<&Singular> = (first..)
            .zip(&points[first as usize..])
            .filter(|&(i, _)| groups.find(i) == first)
            .map(|(_, p)| p)
            .collect();
        let least = ONE_PLACE * group.iter().map(|other| other.reach).fold(0.0, f64::max);
        let is_curve =
            group.iter().any(|other| other.position.distance_squared(point.position) > least * least);
        let kind = match is_curve {
            true if group.iter().any(|point| point.has_two_signs) => SingularKind::Crossing,
            true => SingularKind::Curve,
            false if point.is_flat => SingularKind::Touch,
            false => SingularKind::Point,
        };
        let points =
            if kind == SingularKind::Point { Vec::new() } else { group.into_iter().copied().collect() };
        places.push(SingularPlace { position: point.position, kind, points });
    }
    places
}

/// Marks the particles within 2r of a singular point. The `points` of a curve are only some of it,
/// so every particle near a curve searches for the point nearest to itself.
pub(crate) fn mark(field: &mut dyn Evaluator, points: &[Singular], particles: &mut Particles) {
    let places: Vec<Vec3> = points.iter().map(|point| point.position.as_vec3()).collect();
    let tree = Tree::new(&places);
    // The smallest search distance is the distance between the points that were found last, which
    // are all along the curve.
    let on_curves = points.iter().filter(|point| !point.is_alone).map(|point| point.reach);
    let apart = on_curves.reduce(f64::min).unwrap_or(0.0);
    let mut near = Vec::new();
    for i in 0..particles.len() {
        let (p, reach) = (particles.local[i], 2.0 * particles.radius[i]);
        let around = Vec3::splat(reach + apart as f32);
        near.clear();
        tree.within_box(p - around, p + around, &mut near);
        let is_within = near.iter().any(|&k| tree.position[k as usize].distance_squared(p) <= reach * reach);
        let is_marked = is_within
            || apart > 0.0
                && !near.is_empty()
                && singular_point(field, p.as_dvec3(), f64::from(reach)).is_some_and(|point| point.is_zero);
        let slots = &mut particles.slots[i].0;
        *slots = if is_marked { *slots | Slots::SINGULAR } else { *slots & !Slots::SINGULAR };
    }
}

/// Matrix product, in a function of its own because its code is long.
fn times(a: &DMat3, b: &DMat3) -> DMat3 {
    *a * *b
}

fn matrix(h: &Sym3<f64>) -> DMat3 {
    DMat3::from_cols_array(&[h.xx, h.xy, h.xz, h.xy, h.yy, h.yz, h.xz, h.yz, h.zz])
}

fn size_sq(m: &DMat3) -> f64 {
    m.to_cols_array().iter().map(|entry| entry * entry).sum()
}

/// The largest of [`SIZES`] boxes around the singular point `at` in which one factor of the field
/// has no local extremum, inside the box `within` and disjoint from the boxes `taken`.
pub(crate) fn isolating_box(
    field: &mut dyn Bounded,
    factor: usize,
    at: DVec3,
    within: &Bounds,
    taken: &[Bounds],
) -> Option<Bounds> {
    let largest = within.size().max_element();
    let boxes: [Bounds; SIZES] = core::array::from_fn(|k| {
        let size = largest / f64::from(1_u32 << k);
        Bounds::new(at - size * BELOW, at + size * ABOVE)
    });
    let fits = |around: &Bounds| {
        within.holds_inside(around) && taken.iter().all(|taken| taken.is_apart_from(around))
    };
    let mut is_so = [false; SUB_BOXES];
    has_no_extremum(field, factor, &boxes, &mut is_so);
    let as_one = is_so[..SIZES].iter().position(|&is_so| is_so)?;
    // Larger boxes may be proven in sub-boxes, whose bounds are tighter.
    let in_sub_boxes = (as_one.saturating_sub(MOST_LARGER)..as_one).find(|&k| {
        fits(&boxes[k]) && {
            has_no_extremum(field, factor, &sub_boxes(&boxes[k]), &mut is_so);
            is_so.iter().all(|&is_so| is_so)
        }
    });
    boxes[in_sub_boxes.unwrap_or(as_one)..].iter().find(|around| fits(around)).copied()
}

/// A box cut into three along each axis.
fn sub_boxes(whole: &Bounds) -> [Bounds; SUB_BOXES] {
    let (lo, size) = (whole.lo(), whole.size());
    let third = |k: usize| if k == 3 { whole.hi() } else { lo + size * (k as f64 / 3.0) };
    core::array::from_fn(|i| {
        let [x, y, z] = [i % 3, i / 3 % 3, i / 9];
        let [lo, hi] = [0, 1].map(|end| DVec3::new(third(x + end).x, third(y + end).y, third(z + end).z));
        Bounds::new(lo, hi)
    })
}

/// For each of some boxes, whether bounds show that there is no local extremum in it: the gradient
/// vanishes nowhere, or the function [is a saddle](is_saddle) throughout.
fn has_no_extremum(field: &mut dyn Bounded, factor: usize, boxes: &[Bounds], out: &mut [bool]) {
    let mut known = [Enclosure::UNKNOWN; SUB_BOXES];
    let mut second = [Sym3::splat(Interval::EVERYTHING); SUB_BOXES];
    field.enclose(factor, boxes, &mut known);
    field.enclose_second(factor, boxes, &mut second);
    for (k, out) in out[..boxes.len()].iter_mut().enumerate() {
        let Enclosure { defined, continuous, smooth, gradient, .. } = known[k];
        let is_steep = gradient.iter().any(|slope| slope.excludes_zero());
        *out = defined && continuous && (is_steep || smooth && is_saddle(&second[k]));
    }
}

/// Whether the second derivatives along two fixed directions have different signs.
fn is_saddle(second: &Sym3<Interval>) -> bool {
    extreme_directions(&second.map(Interval::middle))
        .is_some_and(|[up, down]| along(second, up).lo > 0.0 && along(second, down).hi < 0.0)
}

/// Directions along which the second derivative is about the largest and about the smallest, if
/// these have different signs.
fn extreme_directions(second: &Sym3<f64>) -> Option<[DVec3; 2]> {
    /// Squarings of a matrix: enough to separate eigenvalues that differ by a tenth.
    const SQUARINGS: u32 = 7;
    let hessian = matrix(second);
    let size = size_sq(&hessian).sqrt();
    let directions = [1.0, -1.0].map(|sign| {
        let mut power = hessian * sign + DMat3::from_diagonal(DVec3::splat(size));
        for _ in 0..SQUARINGS {
            power = times(&power, &power);
            power *= 1.0 / size_sq(&power).sqrt();
        }
        let columns = [power.x_axis, power.y_axis, power.z_axis];
        let longest = columns.into_iter().max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
        longest.and_then(DVec3::try_normalize)
    });
    match directions {
        [Some(up), Some(down)] if up.dot(hessian * up) > 0.0 && down.dot(hessian * down) < 0.0 => {
            Some([up, down])
        }
        _ => None,
    }
}

/// Bounds of the second derivative along a direction, from bounds of the six second derivatives.
fn along(second: &Sym3<Interval>, d: DVec3) -> Interval {
    let factors = [d.x * d.x, 2.0 * d.x * d.y, 2.0 * d.x * d.z, d.y * d.y, 2.0 * d.y * d.z, d.z * d.z];
    let (mut sum, mut size) = (Interval::new(0.0, 0.0), 0.0);
    for (factor, bounds) in factors.into_iter().zip(second.entries()) {
        let term = bounds * factor;
        sum = sum + term;
        size += term.magnitude();
    }
    // Infinite bounds give infinite ends or NaN, which compares as false: no sign is proven.
    sum.widened(ROUNDING * size)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::formula::Formula;
    use crate::field::{Field, Frame};

    #[test]
    fn searches_from_afar_make_no_curve_of_a_tip() {
        let singular = |position: DVec3, reach: f64| Singular {
            position,
            reach,
            is_zero: true,
            is_alone: false,
            has_two_signs: false,
            is_flat: false,
        };
        let on_circle = |k: u32| {
            let (sine, cosine) = libm::sincos(TAU * f64::from(k) / 64.0);
            DVec3::new(cosine, sine, 0.0)
        };
        let mut points: Vec<Singular> = (0..64).map(|k| singular(on_circle(k), 0.1)).collect();
        points.extend([singular(on_circle(3), 0.8), singular(DVec3::Z, 0.1), singular(DVec3::Z, 0.8)]);
        let kinds: Vec<SingularKind> = places(&points, 0.06).iter().map(|place| place.kind).collect();
        assert_eq!(kinds, [SingularKind::Curve, SingularKind::Point]);
    }

    #[test]
    fn boxes_without_an_extremum_are_told_by_the_gradient_of_either_sign_or_by_a_saddle() {
        let boxes = [
            Bounds::cube(0.1),
            Bounds::new(DVec3::splat(0.2), DVec3::splat(0.3)),
            Bounds::new(DVec3::splat(-0.3), DVec3::splat(-0.2)),
        ];
        // Around the origin, where all coordinates are positive, and where all are negative.
        for (formula, expected) in [
            ("x", [true; 3]),
            ("-x", [true; 3]),
            ("z", [true; 3]),
            ("-z", [true; 3]),
            ("x^2 + y^2 + z^2", [false, true, true]),
            ("-x^2 - y^2 - z^2", [false, true, true]),
            ("x^2 + y^2 - z^2", [true; 3]),
            ("0.0001(x^2 + y^2 - z^2)", [true; 3]),
            ("10000(x^2 + y^2 - z^2)", [true; 3]),
            ("-0.0001 x y - 0.0001 y z - 0.0001 x z", [true; 3]),
            ("x y", [true; 3]),
            ("x y + x z + y z", [true; 3]),
            // Along no direction in the first box is the second derivative of one sign.
            ("x^3 + y^3 + z^3", [false, true, true]),
            ("1 - y^2", [false, true, true]),
            // Unbounded above at the plane that goes through the first box: not known to be
            // continuous.
            ("x + 1/y", [false, true, true]),
        ] {
            let field = Formula::as_written(formula, &[]).expect("a formula");
            let mut evaluator = field.evaluator(Frame::default());
            let mut out = [false; 3];
            has_no_extremum(evaluator.bounded().expect("a formula has bounds"), 0, &boxes, &mut out);
            assert_eq!(out, expected, "{formula}");
        }
    }
}
