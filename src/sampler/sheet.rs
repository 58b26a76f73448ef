//! Whether two points of the surface lie on one sheet, or on two that come near each other.
//!
//! Points whose normals are more than 90° apart always count as on two sheets. For points that face
//! the same way each purpose has its rule:
//!
//! | Purpose | Rule |
//! |---|---|
//! | whether a particle near a child's place may be the one that sits there | [`is_level`]: by the directions alone |
//! | which particles around a point a front takes for its own | [`SheetRule`]: by the lift, then by the field |
//! | how much two particles repel each other | [`repulsion_weight`]: continuous in their normals |
//! | which particles repel each other beside near sheets | [`numbers`]: those of fronts that have met |
//! | which particles may be corners of one triangle | `mesh::stars`: by directions and heights, and once the run has ended by `quality::sheets`, which asks the field |
//!
//! `discovery::sheets` *proves* that points are connected. `quality::sheets` shares nothing with
//! the rules of this module, so that a fault here shows there.
//!
//! The *lift* of two points is the mean height of each above the tangent plane at the other, along
//! the normals. On one sheet the two heights have opposite signs and cancel up to the change of the
//! curvature, so the lift is of third order in the distance. Between two sheets at a distance g the
//! lift is about g. Two sheets that face the same way always have a third one between them that
//! faces the other way.

use crate::field::descent;
use crate::math::Forest;
use crate::particles::{OrientedPoint, Particles};
use crate::sampler::neighbours::grids::RadiusRange;
use crate::sampler::neighbours::packed::PackedNeighbours;
use crate::sampler::probe::Probe;
use crate::sampler::projection::ResidualLimits;
use crate::spatial::Neighbour;
use glam::Vec3;

impl OrientedPoint {
    /// The pair of this point and one at `offset` from it with the unit normal `other`.
    pub(crate) fn pair(self, offset: Vec3, other: Vec3) -> PointPair {
        PointPair { offset, normal: self.normal, other }
    }
}

/// Two points of the surface, as seen from the first.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PointPair {
    /// Offset of the second point from the first.
    pub(crate) offset: Vec3,
    /// Unit normal at the first point.
    pub(crate) normal: Vec3,
    /// Unit normal at the second point.
    pub(crate) other: Vec3,
}

impl PointPair {
    /// The lift of the two points.
    pub(crate) fn lift(self) -> f32 {
        (0.5 * self.offset.dot(self.normal + self.other)).abs()
    }

    /// Whether the two points [face the same way](face_one_way).
    pub(crate) fn faces_one_way(self) -> bool {
        face_one_way(self.normal, self.other)
    }
}

/// Whether two points of the surface with these normals face the same way: the normals are within
/// 90°.
pub(crate) fn face_one_way(one: Vec3, other: Vec3) -> bool {
    one.dot(other) > 0.0
}

/// A point of the surface farther than this many radii from every particle of its sheet is not
/// covered: a closed cover has no hole larger than 1.85 (1.6 of the ideal).
pub(crate) const UNCOVERED: f32 = 2.0;

/// Whether the particle `near` a point of the surface, which has this unit normal, covers it: it
/// faces the same way and is within [`UNCOVERED`] of its radii.
pub(crate) fn is_cover(particles: &Particles, near: &Neighbour, normal: Vec3) -> bool {
    let j = near.index as usize;
    let reach = UNCOVERED * particles.radius[j];
    face_one_way(particles.normal[j], normal) && near.distance_sq <= reach * reach
}

/// sin² 45°: the steepest direction from a point to one on its sheet, above the tangent plane. A
/// sheet that bends by 45° over the distance of two neighbours is not resolved by its particles.
pub(crate) const MAX_RISE_SQ: f32 = 0.5;

/// Square of half the match radius: nearer particles count as one, whatever the direction between
/// them.
pub(crate) fn level_slack_sq(match_radius: f32) -> f32 {
    (0.5 * match_radius) * (0.5 * match_radius)
}

/// Whether two particles that are `distance_sq` apart face the same way, and the second rises from
/// the tangent plane at the first by at most 45°, or is too near to tell.
pub(crate) fn is_level(pair: PointPair, distance_sq: f32, match_radius: f32) -> bool {
    let rise = pair.offset.dot(pair.normal);
    pair.faces_one_way() && rise * rise <= MAX_RISE_SQ * (distance_sq + level_slack_sq(match_radius))
}

/// Returns the weight of the repulsion of two particles whose unit normals have this cosine: 1 up
/// to 60°, where they are neighbours on one sheet of the surface, and 0 from 120°, where they are
/// on two.
///
/// In between the weight is linear in the cosine, so no pair appears or disappears suddenly, and
/// the energy is a continuous function of the positions. The force is the derivative by the
/// distance alone and ignores the change of the weight, so the ramp must not be steep.
pub(crate) fn repulsion_weight(cosine: f32) -> f32 {
    (0.5 + cosine).clamp(0.0, 1.0)
}

/// Lift, in spacings, above which two particles a spacing apart may lie on two sheets. On one sheet
/// such a lift needs a change of the curvature, over one spacing, by 0.24 of an inverse spacing.
/// Smaller: more children find no place; larger: the closest pairs are nearer.
pub(crate) const MAX_LIFT: f32 = 0.02;

/// Whether two points that face the same way may lie on two sheets: their lift is larger than
/// [`MAX_LIFT`] allows at that distance.
fn is_doubtful(pair: PointPair, spacing: f32) -> bool {
    let lift = pair.lift();
    // The lift grows with the third power of the distance.
    let share = pair.offset.length_squared() / (spacing * spacing);
    lift * lift > (MAX_LIFT * spacing) * (MAX_LIFT * spacing) * (share * share * share).max(1.0)
}

/// Rule that decides whether two points that face the same way are on one sheet or on two.
///
/// Normally a large lift makes a pair doubtful, and one evaluation between the two decides. This
/// misses sheets nearer to each other than such a lift. If the survey has found sheets as near as
/// that, every pair is doubtful whose lift can be told from 0, and the field is followed from one
/// point to the other.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SheetRule {
    /// Least distance at which sheets are distinguished, if some may be so near.
    resolved: Option<f32>,
}

impl SheetRule {
    /// The rule for particles of these radii, on a surface where the next two sheets are `crowding`
    /// away from a point.
    pub(crate) fn new(crowding: f32, radii: RadiusRange, residual_limits: ResidualLimits) -> Self {
        let is_crowded = crowding <= MAX_LIFT * 2.0 * radii.largest;
        // Both particles of a pair may be a residual away from the surface.
        Self { resolved: is_crowded.then_some(4.0 * residual_limits.residual(radii.smallest)) }
    }

    /// Lift above which a particle that has moved is on another sheet; infinite if no sheets are
    /// that near.
    pub(crate) fn largest_lift(self) -> f32 {
        self.resolved.unwrap_or(f32::INFINITY)
    }

    /// Whether sheets may be nearer than the usual rule distinguishes.
    pub(crate) fn is_fine(self) -> bool {
        self.resolved.is_some()
    }

    /// Whether two points that face the same way may lie on two sheets.
    pub(crate) fn is_doubtful(self, pair: PointPair, spacing: f32) -> bool {
        match self.resolved {
            Some(least) => pair.lift() > least,
            None => is_doubtful(pair, spacing),
        }
    }

    /// Lift above which a pair near a doubtful one is examined, wherever the two are.
    pub(crate) fn suspicious(self, spacing: f32) -> f32 {
        // Where there is another sheet, a particle of it can be far away to the side, and the limit
        // does not grow with the distance.
        self.resolved.unwrap_or(0.5 * MAX_LIFT * spacing)
    }

    /// Whether the field shows that two points which face the same way, the first at `position`,
    /// lie on one sheet.
    pub(crate) fn is_one_sheet(self, probe: &mut Probe, position: Vec3, pair: PointPair) -> bool {
        /// Times that the path between the two points is halved: the error of the curve between
        /// them falls by a factor of 16 each time.
        const HALVINGS: u32 = 3;
        let Some(least) = self.resolved else {
            return is_one_sheet(probe, position, pair);
        };
        let from = OrientedPoint { position, normal: pair.normal };
        let to = OrientedPoint { position: position + pair.offset, normal: pair.other };
        is_one_sheet_between(probe, from, to, least, HALVINGS)
    }

    /// Whether two points, the first at `position`, are on one sheet: they face the same way, and
    /// if their lift leaves a doubt, the field decides.
    pub(crate) fn is_own(self, probe: &mut Probe, position: Vec3, pair: PointPair, spacing: f32) -> bool {
        pair.faces_one_way() && (!self.is_doubtful(pair, spacing) || self.is_one_sheet(probe, position, pair))
    }

    /// Whether one of the particles `near` a point lies on the point's sheet. All of them face the
    /// same way as the point; `spacing` is the usual distance between particles at each.
    pub(crate) fn is_near_own(
        self,
        probe: &mut Probe,
        particles: &Particles,
        point: OrientedPoint,
        near: &[Neighbour],
        spacing: impl Fn(usize) -> f32,
    ) -> bool {
        let pair = |near: &Neighbour| point.pair(near.offset, particles.normal[near.index as usize]);
        near.iter().any(|near| !self.is_doubtful(pair(near), spacing(near.index as usize)))
            || near.iter().any(|near| self.is_one_sheet(probe, point.position, pair(near)))
    }
}

/// Whether two points of the surface, the first at `position`, seem to lie on one sheet. One
/// evaluation of the field between them decides.
///
/// The evaluation is made at the middle of the cubic curve that is tangent to the surface at both
/// points. On one sheet the distance of this middle from the surface is of fourth order, far less
/// than half the lift, and the gradient there faces the same way. Between two sheets the middle is
/// half the lift away from both.
fn is_one_sheet(probe: &mut Probe, position: Vec3, pair: PointPair) -> bool {
    /// Smallest lift, as a share of the distance, that rounding leaves meaningful.
    const ROUNDING: f32 = 0.01;
    /// The surface has to be within this share of the lift from the middle. It is 0 on one sheet
    /// and ½ on two; this is halfway. Smaller: more children find no place; larger: the closest
    /// pairs are nearer.
    const NEAR: f32 = 0.25;
    let PointPair { offset, normal, other } = pair;
    let length = offset.length();
    let along = |n: Vec3| (offset - n * offset.dot(n)).normalize_or_zero() * length;
    let middle = position + offset * 0.5 + (along(normal) - along(other)) * 0.125;
    let (value, gradient) = probe.gradient(middle);
    let reach = NEAR * pair.lift().max(ROUNDING * length);
    gradient.dot(normal + other) > 0.0 && value.abs() <= reach * gradient.length()
}

/// Points of the cubic curve that is tangent to the surface at both ends, at a quarter, a half and
/// three quarters of the way.
fn along_the_way(from: OrientedPoint, to: OrientedPoint) -> [Vec3; 3] {
    let offset = to.position - from.position;
    let tangent = |n: Vec3| (offset - n * offset.dot(n)).normalize_or_zero() * offset.length();
    let (a, b) = (tangent(from.normal), tangent(to.normal));
    [0.25_f32, 0.5, 0.75].map(|t| {
        let (t2, u) = (t * t, 1.0 - t);
        from.position + offset * (t2 * (3.0 - 2.0 * t)) + a * (t * u * u) - b * (t2 * u)
    })
}

/// Whether the field shows one sheet all the way between two points of the surface: at three places
/// the surface is far nearer than the two points' lift, and faces the same way. If it is not, the
/// path is halved at the surface. Sheets nearer than `least` count as one.
fn is_one_sheet_between(
    probe: &mut Probe,
    from: OrientedPoint,
    to: OrientedPoint,
    least: f32,
    halvings: u32,
) -> bool {
    /// The surface has to be within this share of the lift from the curve. The curve of two sheets
    /// is at least 5/32 away from both at each of the three places. Smaller: more evaluations.
    const NEAR: f32 = 0.05;
    /// Newton steps to the surface. With fewer, more children find no place.
    const STEPS: u32 = 4;
    /// Longest of these steps, as a share of the way. A choice.
    const LONGEST: f32 = 0.25;
    let (pair, facing) = (from.pair(to.position - from.position, to.normal), from.normal + to.normal);
    if !pair.faces_one_way() {
        return false;
    }
    let lift = pair.lift();
    let way = along_the_way(from, to);
    let near = (NEAR * lift).max(0.5 * least);
    let (value, gradient) = probe.gradients(&way);
    let is_on = |k: usize| gradient[k].dot(facing) > 0.0 && value[k].abs() <= near * gradient[k].length();
    if (0..3).all(is_on) || lift <= least && gradient[1].dot(facing) > 0.0 {
        return true;
    }
    let (mut middle, mut slope) = (way[1], gradient[1]);
    let mut step = descent::step(value[1], slope);
    let longest = LONGEST * pair.offset.length();
    for _ in 0..STEPS {
        // False for NaN.
        let is_near = step.length_squared() <= longest * longest && slope.dot(facing) > 0.0;
        if halvings == 0 || !is_near {
            return false;
        }
        middle -= step;
        let (value, gradient) = probe.gradient(middle);
        slope = gradient;
        step = descent::step(value, gradient);
        // Within a quarter of the distance that is not resolved.
        if step.length_squared() <= 0.0625 * least * least {
            let middle = OrientedPoint { position: middle, normal: gradient.normalize_or_zero() };
            return middle.normal.dot(facing) > 0.0
                && is_one_sheet_between(probe, from, middle, least, halvings - 1)
                && is_one_sheet_between(probe, middle, to, least, halvings - 1);
        }
    }
    false
}

/// Returns a number for each particle, equal for particles of one front, and for fronts that meet
/// on one patch: that have two neighbours whose lift is at most `largest_lift`.
pub(crate) fn numbers(largest_lift: f32, particles: &Particles, neighbours: &PackedNeighbours) -> Vec<u32> {
    let mut number = particles.fronts();
    let mut met = Forest::new(number.len());
    let near = (0..neighbours.len()).flat_map(|i| neighbours.near(i).map(move |j| (i, j)));
    let far = neighbours.far().iter().map(|&[i, j]| (i as usize, j as usize));
    let is_joinable =
        |&(i, j): &(usize, usize)| number[i] != number[j] && particles.patch_of(i) == particles.patch_of(j);
    for (i, j) in near.chain(far).filter(is_joinable) {
        let one = OrientedPoint::of(particles, i);
        let pair = one.pair(particles.local[j] - one.position, particles.normal[j]);
        if pair.faces_one_way() && pair.lift() <= largest_lift {
            met.join(number[i], number[j]);
        }
    }
    number.iter_mut().for_each(|front| *front = met.find(*front));
    number
}
