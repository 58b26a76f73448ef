//! Decides whether two points of the surface lie on one sheet or on two sheets that come near each other.
//!
//! The test is the *lift*: the mean height of each point above the tangent plane at the other, along the normals. On one sheet
//! the two heights have opposite signs and cancel but for the change of the curvature, so the lift is of third order in the
//! distance. Between two sheets at a distance g the lift is about g. Two sheets that face the same way always have a third one
//! between them that faces the other way.

use crate::field::{Enclosure, Field};
use crate::particles::Particles;
use crate::sampler::projection::Projector;
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
pub(crate) fn is_doubtful(offset: Vec3, normal: Vec3, other: Vec3, spacing: f32) -> bool {
    let lift = lift(offset, normal, other);
    // The lift grows with the third power of the distance.
    let share = offset.length_squared() / (spacing * spacing);
    lift * lift > (MAX_LIFT * spacing) * (MAX_LIFT * spacing) * (share * share * share).max(1.0)
}

/// Whether one of the particles `near` a point lies on the point's sheet. All of them face the same way as the point;
/// `spacing` is the usual distance between particles at each.
pub(crate) fn is_near_own(
    field: &mut dyn Field,
    projector: &mut Projector,
    particles: &Particles,
    (position, normal): (Vec3, Vec3),
    near: &[Neighbour],
    spacing: impl Fn(usize) -> f32,
) -> bool {
    let other = |near: &Neighbour| particles.normal[near.index as usize];
    near.iter().any(|near| !is_doubtful(near.offset, normal, other(near), spacing(near.index as usize)))
        || near
            .iter()
            .any(|near| is_one_sheet(field, projector, (position, normal), near.offset, other(near)))
}

/// Whether a point of the surface with the unit normal `normal` and another one at `offset` from it, with the unit normal
/// `other`, seem to lie on one sheet. One evaluation of the field between them decides.
///
/// It is made at the middle of the cubic curve that is tangent to the surface at both points. On one sheet the distance of
/// this middle from the surface is of fourth order, far less than half the lift, and the gradient there faces the same way. Between
/// two sheets the middle is half the lift away from both.
pub(crate) fn is_one_sheet(
    field: &mut dyn Field,
    projector: &mut Projector,
    (position, normal): (Vec3, Vec3),
    offset: Vec3,
    other: Vec3,
) -> bool {
    /// Smallest lift, as a share of the distance, that rounding leaves meaningful.
    const ROUNDING: f32 = 0.01;
    /// Share of the lift within which the surface has to be of the middle.
    const NEAR: f32 = 0.25;
    let length = offset.length();
    let along = |n: Vec3| (offset - n * offset.dot(n)).normalize_or_zero() * length;
    let middle = position + offset * 0.5 + (along(normal) - along(other)) * 0.125;
    let (value, gradient) = projector.evaluate(field, middle);
    let reach = NEAR * lift(offset, normal, other).max(ROUNDING * length);
    gradient.dot(normal + other) > 0.0 && value.abs() <= reach * gradient.length()
}

/// Pairs of points that are tested in one call: a pair needs three boxes, and a chunk of the field holds 32.
pub(crate) const TOGETHER: usize = 10;

/// A point of the surface, and the unit normal there.
pub(crate) type Oriented = (DVec3, DVec3);

/// For each of at most [`TOGETHER`] pairs of points of the surface, the first with its normal: whether bounds of the gradient
/// prove that the surface connects them. The points may be up to `slack` away from the surface. With corners `within`, the
/// connection has to stay between them.
///
/// The proof is that of the [octree](super::octree), on a box around both points. f is monotone along the axis nearest the
/// normal, and the surface through the first point leaves the box through its sides only. So it is the graph of a function over
/// the rectangle between the two, and meets the line through the second point exactly once.
pub(crate) fn are_connected(
    field: &mut dyn Field,
    part: usize,
    pairs: &[(Oriented, DVec3)],
    slack: f64,
    within: Option<[DVec3; 2]>,
) -> [bool; TOGETHER] {
    let mut boxes = [[DVec3::ZERO; 2]; 3 * TOGETHER];
    let mut known = [Enclosure::UNKNOWN; 3 * TOGETHER];
    for (k, &((a, normal), b)) in pairs.iter().enumerate() {
        let (around, _, _) = graph_box(a, b, normal, slack);
        boxes[3 * k..3 * k + 3].copy_from_slice(&[around, [a, a], [b, b]]);
    }
    field.enclose(part, &boxes[..3 * pairs.len()], &mut known);
    core::array::from_fn(|k| {
        let Some(&((a, normal), b)) = pairs.get(k) else { return false };
        let (around, up, room) = graph_box(a, b, normal, slack);
        let [known, ends @ ..] = [0, 1, 2].map(|part| known[3 * k + part]);
        let least = known.gradient[up][0].abs().min(known.gradient[up][1].abs());
        // Ends that are not quite on the surface have it within 2 slacks above or below.
        within.is_none_or(|[lo, hi]| around[0].cmpge(lo).all() && around[1].cmple(hi).all())
            && proves_graph(&known, around, up, room - 4.0 * slack)
            && ends.iter().all(|end| end.value[1].max(-end.value[0]) <= 2.0 * slack * least)
    })
}

/// Whether two points of the surface are connected by a chain of segments, each of which [is proven](are_connected). Points
/// between which the surface bends too much for one box need more than one segment: a segment without a proof is halved, at a point
/// of the surface in the box from `lo` to `hi`. A midpoint outside that box is moved `margin` inside and back to the surface, by
/// turns.
pub(crate) fn is_connected_by_segments(
    field: &mut dyn Field,
    part: usize,
    from: Oriented,
    to: DVec3,
    slack: f64,
    ([lo, hi], margin): ([DVec3; 2], f64),
) -> bool {
    /// Largest number of turns.
    const MOST_TURNS: u32 = 8;
    /// Largest number of rounds, and of segments without a proof.
    const MOST_ROUNDS: u32 = 8;
    const MOST_WAITING: usize = 3 * TOGETHER;
    let is_inside = |p: DVec3| p.cmpge(lo).all() && p.cmple(hi).all();
    let mut waiting = [(from, to); MOST_WAITING];
    let mut count = 1;
    for _ in 0..MOST_ROUNDS {
        let tried = count.min(TOGETHER);
        count -= tried;
        let mut pairs = [(from, to); TOGETHER];
        pairs[..tried].copy_from_slice(&waiting[count..count + tried]);
        let connected = are_connected(field, part, &pairs[..tried], slack, None);
        for k in (0..tried).filter(|&k| !connected[k]) {
            let (start, end) = pairs[k];
            let chord = end - start.0;
            let Some(mut middle) = land(field, start.0 + 0.5 * chord) else { return false };
            for _ in 0..MOST_TURNS {
                if is_inside(middle.0) {
                    break;
                }
                let Some(next) = land(field, middle.0.clamp(lo + margin, hi - margin)) else { return false };
                middle = next;
            }
            // A midpoint far from that of the chord does not lie between the two.
            let offset = middle.0 - (start.0 + 0.5 * chord);
            if count + 2 > MOST_WAITING
                || offset.length_squared() > 0.25 * chord.length_squared()
                || !is_inside(middle.0)
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

/// The point of the surface that Newton's method along the gradient finds from `p`, and the unit normal there.
fn land(field: &mut dyn Field, mut p: DVec3) -> Option<Oriented> {
    const STEPS: u32 = 8;
    for _ in 0..STEPS {
        let jet = field.jet(p);
        let step = jet.gradient * (jet.value / jet.gradient.length_squared());
        if !step.is_finite() {
            return None;
        }
        p -= step;
        if step.length_squared() <= 1e-24 * p.length_squared() {
            return jet.gradient.try_normalize().map(|normal| (p, normal));
        }
    }
    None
}

/// The box of one segment, the axis nearest its normal, and how far the box reaches beyond the ends along that axis.
fn graph_box(a: DVec3, b: DVec3, normal: DVec3, slack: f64) -> ([DVec3; 2], usize, f64) {
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
    let room = 1.5 * slope + 0.25 * reach.max_element() + 8.0 * slack;
    lo[up] -= room;
    hi[up] += room;
    ([lo, hi], up, room)
}

/// Whether the surface through any point of a box is a graph over the whole box, if the point is at least `room` away from the
/// lower and the upper face.
fn proves_graph(known: &Enclosure, [lo, hi]: [DVec3; 2], up: usize, room: f64) -> bool {
    let [least, most] = known.gradient[up];
    if !(known.defined && known.continuous) || least <= 0.0 && most >= 0.0 {
        return false;
    }
    let least = least.abs().min(most.abs());
    let t: f64 = (0..3)
        .filter(|&axis| axis != up)
        .map(|axis| known.gradient[axis][1].max(-known.gradient[axis][0]) / least * (hi[axis] - lo[axis]))
        .sum();
    t <= room
}
