//! Proves by bounds of the gradient that two points lie on one sheet: that the surface connects them. What only seems so is told by
//! the rules of [`sheet`](crate::sampler::sheet).

use crate::field::{Bounded, Enclosure};
use crate::math::{Bounds, Interval};
use crate::sampler::discovery::octree::Region;
use glam::DVec3;

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
