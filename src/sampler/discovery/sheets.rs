//! Decides whether two points of the surface lie on one sheet or on two sheets that come near each other.
//!
//! The test is the *lift*: the mean height of each point above the tangent plane at the other, along the normals. On one sheet
//! the two heights have opposite signs and cancel but for the change of the curvature, so the lift is of third order in the
//! distance. Between two sheets at a distance g the lift is about g. Two sheets that face the same way always have a third one
//! between them that faces the other way.

use crate::field::{Bounded, Enclosure};
use crate::math::{Bounds, Interval};
use crate::particles::Particles;
use crate::sampler::discovery::octree::Region;
use crate::sampler::probe::Probe;
use crate::sampler::projection::Accuracy;
use crate::spatial::Neighbour;
use glam::{DVec3, Vec3};

/// The lift of two points at this offset from each other, with these unit normals.
pub(crate) fn lift(offset: Vec3, normal: Vec3, other: Vec3) -> f32 {
    (0.5 * offset.dot(normal + other)).abs()
}

/// Lift, in spacings, above which two particles a spacing apart may lie on two sheets. On one sheet such a lift needs a change
/// of the curvature, over one spacing, by 0.24 of an inverse spacing.
pub(crate) const MAX_LIFT: f32 = 0.02;

/// Whether a particle at `offset` with the unit normal `other` may lie on another sheet than a point with the unit normal
/// `normal` that faces the same way: the lift is larger than [`MAX_LIFT`] allows at that distance.
fn is_doubtful(offset: Vec3, normal: Vec3, other: Vec3, spacing: f32) -> bool {
    let lift = lift(offset, normal, other);
    // The lift grows with the third power of the distance.
    let share = offset.length_squared() / (spacing * spacing);
    lift * lift > (MAX_LIFT * spacing) * (MAX_LIFT * spacing) * (share * share * share).max(1.0)
}

/// How two points that face the same way are told to be on one sheet or on two.
///
/// As a rule a large lift makes a pair doubtful, and one evaluation between the two decides. That misses sheets nearer to each
/// other than such a lift. Where the survey has seen sheets as near as that, every pair is doubtful whose lift can be told from 0,
/// and the field is followed from one point to the other.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SheetRule {
    /// Least distance at which sheets are told apart, where some may be so near.
    resolved: Option<f32>,
}

impl SheetRule {
    /// The rule for particles of a radius from `smallest` to `largest`, on a surface where another sheet and a third one lie
    /// `crowding` away from a point.
    pub(crate) fn new(crowding: f32, [smallest, largest]: [f32; 2], accuracy: Accuracy) -> Self {
        let is_crowded = crowding <= MAX_LIFT * 2.0 * largest;
        // Both particles of a pair may be a residual away from the surface.
        Self { resolved: is_crowded.then_some(4.0 * accuracy.residual(smallest)) }
    }

    /// Lift above which a particle that has moved is on another sheet; infinite where sheets are not as near.
    pub(crate) fn largest_lift(self) -> f32 {
        self.resolved.unwrap_or(f32::INFINITY)
    }

    /// Whether sheets may be nearer than the usual rule tells apart.
    pub(crate) fn is_fine(self) -> bool {
        self.resolved.is_some()
    }

    /// [`is_doubtful`], by this rule.
    pub(crate) fn is_doubtful(self, offset: Vec3, normal: Vec3, other: Vec3, spacing: f32) -> bool {
        match self.resolved {
            Some(least) => lift(offset, normal, other) > least,
            None => is_doubtful(offset, normal, other, spacing),
        }
    }

    /// Lift above which a pair near a doubtful one is looked at, wherever the two are.
    pub(crate) fn suspicious(self, spacing: f32) -> f32 {
        // Where there is another sheet, a particle of it can be far away to the side, and the limit does not grow with the
        // distance.
        self.resolved.unwrap_or(0.5 * MAX_LIFT * spacing)
    }

    /// [`is_one_sheet`], by this rule.
    pub(crate) fn is_one_sheet(
        self,
        probe: &mut Probe,
        from: (Vec3, Vec3),
        offset: Vec3,
        other: Vec3,
    ) -> bool {
        /// Times that the way between the two points is halved: the error of the curve between them falls by 16 each time.
        const HALVINGS: u32 = 3;
        match self.resolved {
            Some(least) => is_one_sheet_between(probe, from, (from.0 + offset, other), least, HALVINGS),
            None => is_one_sheet(probe, from, offset, other),
        }
    }
}

/// Points of the cubic curve that is tangent to the surface at both ends, at a quarter, a half and three quarters of the way.
fn along_the_way((p, n): (Vec3, Vec3), (q, m): (Vec3, Vec3)) -> [Vec3; 3] {
    let offset = q - p;
    let tangent = |n: Vec3| (offset - n * offset.dot(n)).normalize_or_zero() * offset.length();
    let (a, b) = (tangent(n), tangent(m));
    [0.25_f32, 0.5, 0.75].map(|t| {
        let (t2, u) = (t * t, 1.0 - t);
        p + offset * (t2 * (3.0 - 2.0 * t)) + a * (t * u * u) - b * (t2 * u)
    })
}

/// Whether the field between two points of the surface shows one sheet from one to the other: at three places along the way the
/// surface is far nearer than the two points' lift, and faces the same way. Where it is not, the way is halved at the surface.
/// Sheets nearer than `least` count as one.
fn is_one_sheet_between(
    probe: &mut Probe,
    from: (Vec3, Vec3),
    to: (Vec3, Vec3),
    least: f32,
    halvings: u32,
) -> bool {
    /// Share of the lift within which the surface has to be of the curve. The curve of two sheets is at least 5/32 away from both
    /// at each of the three places.
    const NEAR: f32 = 0.05;
    /// Newton steps to the surface, and the largest one as a share of the way.
    const STEPS: u32 = 4;
    const LONGEST: f32 = 0.25;
    let (offset, facing) = (to.0 - from.0, from.1 + to.1);
    if from.1.dot(to.1) <= 0.0 {
        return false;
    }
    let lift = lift(offset, from.1, to.1);
    let way = along_the_way(from, to);
    let near = (NEAR * lift).max(0.5 * least);
    let (value, gradient) = probe.gradients(&way);
    let is_on = |k: usize| gradient[k].dot(facing) > 0.0 && value[k].abs() <= near * gradient[k].length();
    if (0..3).all(is_on) || lift <= least && gradient[1].dot(facing) > 0.0 {
        return true;
    }
    let mut middle = (way[1], gradient[1]);
    let mut step = gradient[1] * (value[1] / gradient[1].length_squared());
    let longest = LONGEST * offset.length();
    for _ in 0..STEPS {
        // False for NaN.
        let is_near = step.length_squared() <= longest * longest && middle.1.dot(facing) > 0.0;
        if halvings == 0 || !is_near {
            return false;
        }
        middle.0 -= step;
        let (value, gradient) = probe.gradient(middle.0);
        middle.1 = gradient;
        step = gradient * (value / gradient.length_squared());
        if step.length_squared() <= 0.0625 * least * least {
            let normal = gradient.normalize_or_zero();
            let middle = (middle.0, normal);
            return normal.dot(facing) > 0.0
                && is_one_sheet_between(probe, from, middle, least, halvings - 1)
                && is_one_sheet_between(probe, middle, to, least, halvings - 1);
        }
    }
    false
}

/// Whether one of the particles `near` a point lies on the point's sheet. All of them face the same way as the point;
/// `spacing` is the usual distance between particles at each.
pub(crate) fn is_near_own(
    rule: SheetRule,
    probe: &mut Probe,
    particles: &Particles,
    (position, normal): (Vec3, Vec3),
    near: &[Neighbour],
    spacing: impl Fn(usize) -> f32,
) -> bool {
    let other = |near: &Neighbour| particles.normal[near.index as usize];
    near.iter().any(|near| !rule.is_doubtful(near.offset, normal, other(near), spacing(near.index as usize)))
        || near.iter().any(|near| rule.is_one_sheet(probe, (position, normal), near.offset, other(near)))
}

/// Whether a point of the surface with the unit normal `normal` and another one at `offset` from it, with the unit normal
/// `other`, seem to lie on one sheet. One evaluation of the field between them decides.
///
/// It is made at the middle of the cubic curve that is tangent to the surface at both points. On one sheet the distance of
/// this middle from the surface is of fourth order, far less than half the lift, and the gradient there faces the same way. Between
/// two sheets the middle is half the lift away from both.
fn is_one_sheet(probe: &mut Probe, (position, normal): (Vec3, Vec3), offset: Vec3, other: Vec3) -> bool {
    /// Smallest lift, as a share of the distance, that rounding leaves meaningful.
    const ROUNDING: f32 = 0.01;
    /// Share of the lift within which the surface has to be of the middle.
    const NEAR: f32 = 0.25;
    let length = offset.length();
    let along = |n: Vec3| (offset - n * offset.dot(n)).normalize_or_zero() * length;
    let middle = position + offset * 0.5 + (along(normal) - along(other)) * 0.125;
    let (value, gradient) = probe.gradient(middle);
    let reach = NEAR * lift(offset, normal, other).max(ROUNDING * length);
    gradient.dot(normal + other) > 0.0 && value.abs() <= reach * gradient.length()
}

/// Pairs of points that are tested in one call: a pair needs three boxes, and a chunk of the field holds 32.
pub(crate) const TOGETHER: usize = 10;

/// A point of the surface, and the unit normal there.
pub(crate) type Oriented = (DVec3, DVec3);

/// For each of at most [`TOGETHER`] pairs of points of the surface, the first with its normal: whether bounds of the gradient
/// prove that the surface connects them. The points may be up to `slack` away from the surface. The connection has to stay in the
/// box `within`, if there is one.
///
/// The proof is that of the [octree](super::octree), on a box around both points. f is monotone along the axis nearest the
/// normal, and the surface through the first point leaves the box through its sides only. So it is the graph of a function over
/// the rectangle between the two, and meets the line through the second point exactly once.
pub(crate) fn are_connected(
    field: &mut dyn Bounded,
    factor: usize,
    pairs: &[(Oriented, DVec3)],
    slack: f64,
    within: Option<&Bounds>,
) -> [bool; TOGETHER] {
    let mut boxes = [Bounds::point(DVec3::ZERO); 3 * TOGETHER];
    let mut known = [Enclosure::UNKNOWN; 3 * TOGETHER];
    for (k, &((a, normal), b)) in pairs.iter().enumerate() {
        let (around, _, _) = graph_box(a, b, normal, slack);
        boxes[3 * k..3 * k + 3].copy_from_slice(&[around, Bounds::point(a), Bounds::point(b)]);
    }
    field.enclose(factor, &boxes[..3 * pairs.len()], &mut known);
    core::array::from_fn(|k| {
        let Some(&((a, normal), b)) = pairs.get(k) else { return false };
        let (around, up, room) = graph_box(a, b, normal, slack);
        let [known, ends @ ..] = [0, 1, 2].map(|m| known[3 * k + m]);
        let Interval { lo, hi } = known.gradient[up];
        let least = lo.abs().min(hi.abs());
        // Ends that are not quite on the surface have it within 2 slacks above or below.
        within.is_none_or(|within| within.holds(around.lo()) && within.holds(around.hi()))
            && proves_graph(&known, &around, up, room - 4.0 * slack)
            && ends.iter().all(|end| end.value.magnitude() <= 2.0 * slack * least)
    })
}

/// Whether two points of the surface are connected by a chain of segments, each of which [is proven](are_connected). Points
/// between which the surface bends too much for one box need more than one segment: a segment without a proof is halved, at a point
/// of the surface in the `region`. A midpoint outside it is moved inside by its margin and back to the surface, by turns.
pub(crate) fn is_connected_by_segments(
    field: &mut dyn Bounded,
    factor: usize,
    from: Oriented,
    to: DVec3,
    slack: f64,
    region: &Region,
) -> bool {
    /// Largest number of turns.
    const MOST_TURNS: u32 = 8;
    /// Largest number of rounds, and of segments without a proof.
    const MOST_ROUNDS: u32 = 8;
    const MOST_WAITING: usize = 3 * TOGETHER;
    let inner = region.bounds.enlarged(-region.margin);
    let mut waiting = [(from, to); MOST_WAITING];
    let mut count = 1;
    for _ in 0..MOST_ROUNDS {
        let tried = count.min(TOGETHER);
        count -= tried;
        let mut pairs = [(from, to); TOGETHER];
        pairs[..tried].copy_from_slice(&waiting[count..count + tried]);
        let connected = are_connected(field, factor, &pairs[..tried], slack, None);
        for k in (0..tried).filter(|&k| !connected[k]) {
            let (start, end) = pairs[k];
            let chord = end - start.0;
            let Some(mut middle) = land(field, factor, start.0 + 0.5 * chord) else { return false };
            for _ in 0..MOST_TURNS {
                if region.bounds.holds(middle.0) {
                    break;
                }
                let Some(next) = land(field, factor, middle.0.clamp(inner.lo(), inner.hi())) else {
                    return false;
                };
                middle = next;
            }
            // A midpoint far from that of the chord does not lie between the two.
            let offset = middle.0 - (start.0 + 0.5 * chord);
            if count + 2 > MOST_WAITING
                || offset.length_squared() > 0.25 * chord.length_squared()
                || !region.bounds.holds(middle.0)
            {
                return false;
            }
            waiting[count] = (start, middle.0);
            waiting[count + 1] = (middle, end);
            count += 2;
        }
        if count == 0 {
            return true;
        }
    }
    false
}

/// Whether two points of the surface are connected by two such chains, by way of a point beside their chord. On a small piece the
/// middle of the chord between opposite points lies inside the piece, where no step leads to the surface.
pub(crate) fn is_connected_around(
    field: &mut dyn Bounded,
    factor: usize,
    from: Oriented,
    to: DVec3,
    slack: f64,
    region: &Region,
) -> bool {
    let chord = to - from.0;
    let Some(direction) = chord.try_normalize() else { return false };
    let (u, v) = crate::math::tangent_frame(direction.as_vec3());
    let (u, v) = (u.as_dvec3(), v.as_dvec3());
    [u, -u, v, -v].into_iter().any(|side| {
        let beside = from.0 + 0.5 * (chord + side * chord.length());
        land(field, factor, beside).is_some_and(|middle| {
            is_connected_by_segments(field, factor, from, middle.0, slack, region)
                && is_connected_by_segments(field, factor, middle, to, slack, region)
        })
    })
}

/// The point at which Newton's method along the gradient finds, from `p`, a zero of a factor of the field; and the unit normal
/// there.
fn land(field: &mut dyn Bounded, factor: usize, mut p: DVec3) -> Option<Oriented> {
    const STEPS: u32 = 8;
    for _ in 0..STEPS {
        let (value, gradient) = value_at(field, factor, p);
        let step = gradient * (value / gradient.length_squared());
        if !step.is_finite() {
            return None;
        }
        p -= step;
        if step.length_squared() <= 1e-24 * p.length_squared() {
            return gradient.try_normalize().map(|normal| (p, normal));
        }
    }
    None
}

/// Value and gradient of a factor of the field at a point: the middles of their bounds.
pub(crate) fn value_at(field: &mut dyn Bounded, factor: usize, p: DVec3) -> (f64, DVec3) {
    let mut known = [Enclosure::UNKNOWN];
    field.enclose(factor, &[Bounds::point(p)], &mut known);
    known[0].middle()
}

/// The box of one segment, the axis nearest its normal, and how far the box reaches beyond the ends along that axis.
fn graph_box(a: DVec3, b: DVec3, normal: DVec3, slack: f64) -> (Bounds, usize, f64) {
    /// Room above and below the ends: times the rise of the tangent plane between them; as a share of the longest side, for what the
    /// surface bends; and for the slack, of which [`are_connected`] takes four.
    const RISES: f64 = 1.5;
    const BEND: f64 = 0.25;
    const SLACKS: f64 = 8.0;
    let size = normal.abs();
    let up = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    let (mut lo, mut hi) = (a.min(b), a.max(b));
    let reach = (b - a).abs();
    let slope: f64 = (0..3).filter(|&axis| axis != up).map(|axis| size[axis] / size[up] * reach[axis]).sum();
    let room = RISES * slope + BEND * reach.max_element() + SLACKS * slack;
    lo[up] -= room;
    hi[up] += room;
    (Bounds::new(lo, hi), up, room)
}

/// Whether the surface through any point of a box is a graph over the whole box, if the point is at least `room` away from the
/// lower and the upper face.
fn proves_graph(known: &Enclosure, around: &Bounds, up: usize, room: f64) -> bool {
    let Some(least) = known.gradient[up].away_from_zero() else { return false };
    let size = around.size();
    let t: f64 = (0..3)
        .filter(|&axis| axis != up)
        .map(|axis| known.gradient[axis].magnitude() / least * size[axis])
        .sum();
    known.defined && known.continuous && t <= room
}
