//! Proves by bounds of the gradient that two points lie on one sheet: that the surface connects
//! them. The rules of [`sheet`](crate::sampler::sheet) decide without proof.

use crate::field::{Bounded, Enclosure};
use crate::math::newton::{self, StepLimits, step_to_surface};
use crate::math::{Bounds, Interval, ROUNDING};
use crate::sampler::discovery::cell::rise;
use crate::sampler::discovery::creased::Pieces;
use crate::sampler::discovery::octree::Region;
use glam::DVec3;

/// Largest number of segments tested in one call, and so of the nearest points to which a
/// connection is tried. A choice.
pub(crate) const TOGETHER: usize = 10;

/// A point of the surface in double precision, and the unit normal there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ExactPoint {
    pub(crate) position: DVec3,
    pub(crate) normal: DVec3,
}

/// Two points of the surface, the first with its normal.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Segment {
    pub(crate) from: ExactPoint,
    pub(crate) to: DVec3,
}

/// Proves connections on one factor of a field.
pub(crate) struct Prover<'a> {
    pub(crate) field: &'a mut dyn Bounded,
    pub(crate) factor: usize,
    /// Largest distance of the points from the surface.
    pub(crate) slack: f64,
    /// The region in which the surface is searched for.
    pub(crate) region: Region,
}

impl Prover<'_> {
    /// For each of at most [`TOGETHER`] segments, whether bounds of the gradient prove that the
    /// surface connects its ends, in the box `within`, if there is one.
    ///
    /// The proof is the one of the [octree](super::octree), on a box around both points. f is
    /// monotone along the axis nearest the normal, and the surface through the first point leaves
    /// the box only through its sides. So it is the graph of a function over the rectangle between
    /// the two, and meets the line through the second point exactly once. On a surface with edges
    /// the proof is that of its [pieces](Pieces::connect).
    pub(crate) fn are_connected(
        &mut self,
        segments: &[Segment],
        within: Option<&Bounds>,
    ) -> [bool; TOGETHER] {
        let slack = self.slack;
        if self.field.edged() == Some(self.factor) {
            let (mut pieces, region) = (Pieces::default(), self.region.bounds);
            return core::array::from_fn(|k| {
                segments.get(k).is_some_and(|&Segment { from, to }| {
                    pieces.connect(self.field, self.factor, [from.position, to], slack, &region)
                })
            });
        }
        let mut boxes = [Bounds::point(DVec3::ZERO); 3 * TOGETHER];
        let mut known = [Enclosure::UNKNOWN; 3 * TOGETHER];
        for (k, segment) in segments.iter().enumerate() {
            let ends = [segment.from.position, segment.to].map(Bounds::point);
            boxes[3 * k..3 * k + 3].copy_from_slice(&[
                GraphBox::around(segment, slack).bounds,
                ends[0],
                ends[1],
            ]);
        }
        self.field.enclose(self.factor, &boxes[..3 * segments.len()], &mut known);
        core::array::from_fn(|k| {
            let Some(segment) = segments.get(k) else { return false };
            let GraphBox { bounds, up, room } = GraphBox::around(segment, slack);
            let [known, ends @ ..] = [0, 1, 2].map(|m| known[3 * k + m]);
            let Interval { lo, hi } = known.gradient[up];
            let least = lo.abs().min(hi.abs());
            // Ends slightly off the surface have it within 2 slacks above or below.
            within.is_none_or(|within| within.holds(bounds.lo()) && within.holds(bounds.hi()))
                && rise(&bounds, up, &known).is_some_and(|rise| rise <= room - 4.0 * slack)
                && ends.iter().all(|end| end.value.magnitude() <= 2.0 * slack * least)
        })
    }

    /// Whether two points of the surface are proven to be connected, directly or by a detour.
    pub(crate) fn is_connected(&mut self, segment: Segment) -> bool {
        self.is_connected_by_segments(segment) || self.is_connected_around(segment)
    }

    /// Whether the ends of a segment are connected by a chain of [proven](Self::are_connected)
    /// segments. If the surface bends too much between the ends for one box, it takes more than
    /// one: a segment without a proof is halved at a point of the surface in the region.
    pub(crate) fn is_connected_by_segments(&mut self, whole: Segment) -> bool {
        /// Largest number of rounds; each halves the segments without a proof.
        const MOST_ROUNDS: u32 = 8;
        let mut waiting = vec![whole];
        for _ in 0..MOST_ROUNDS {
            let tried = waiting.split_off(waiting.len().saturating_sub(TOGETHER));
            let connected = self.are_connected(&tried, None);
            for (&Segment { from, to }, _) in tried.iter().zip(connected).filter(|(_, connected)| !connected)
            {
                let chord = to - from.position;
                let middle_of_chord = from.position + 0.5 * chord;
                let Some(middle) = self.land_inside(middle_of_chord) else { return false };
                // A point farther than half the chord from its middle does not lie between the two.
                let offset = middle.position - middle_of_chord;
                if offset.length_squared() > 0.25 * chord.length_squared() {
                    return false;
                }
                waiting.push(Segment { from, to: middle.position });
                waiting.push(Segment { from: middle, to });
            }
            if waiting.is_empty() {
                return true;
            }
        }
        false
    }

    /// Whether the ends of a segment are connected by two such chains, through a point next to
    /// their chord. On a small piece the middle of the chord between opposite points lies inside
    /// the piece, where no step leads to the surface.
    fn is_connected_around(&mut self, Segment { from, to }: Segment) -> bool {
        let chord = to - from.position;
        let Some(direction) = chord.try_normalize() else { return false };
        let (u, v) = crate::math::tangent_frame(direction.as_vec3());
        let (u, v) = (u.as_dvec3(), v.as_dvec3());
        [u, -u, v, -v].into_iter().any(|side| {
            let beside = from.position + 0.5 * (chord + side * chord.length());
            self.land(beside).is_some_and(|middle| {
                self.is_connected_by_segments(Segment { from, to: middle.position })
                    && self.is_connected_by_segments(Segment { from: middle, to })
            })
        })
    }

    /// The point of the surface that Newton's method along the gradient finds from `p`, to full
    /// precision.
    pub(crate) fn land(&mut self, p: DVec3) -> Option<ExactPoint> {
        let limits = StepLimits { share_at_rest: ROUNDING, ..StepLimits::steps(newton::STEPS) };
        let (position, gradient) = newton::land(p, limits, |p| Some(self.newton_step(p)))?;
        gradient.try_normalize().map(|normal| ExactPoint { position, normal })
    }

    /// A point of the surface in the region, found from `p` by Newton's method: a point outside is
    /// moved inside.
    fn land_inside(&mut self, p: DVec3) -> Option<ExactPoint> {
        let landed = self.land(p)?;
        let bounds = self.region.bounds;
        if bounds.holds(landed.position) {
            return Some(landed);
        }
        let inside = self.moved_inside(landed.position, &bounds)?;
        self.land(inside).filter(|landed| bounds.holds(landed.position))
    }

    /// A point in a box, within a thousandth of the margin of the surface, near `p` in the margin
    /// outside: found by alternating between the nearest point of the box without its margin and
    /// one step to the surface. None if the surface does not reach into the box there.
    pub(crate) fn moved_inside(&mut self, mut p: DVec3, bounds: &Bounds) -> Option<DVec3> {
        /// Each turn shortens the distance by the cosine squared of the angle between surface and
        /// face: at 26° this many turns shorten it by a thousand.
        const MOST_TURNS: u32 = 32;
        let margin = self.region.margin;
        let inner = bounds.enlarged(-margin);
        for _ in 0..MOST_TURNS {
            p = p.clamp(inner.lo(), inner.hi());
            let (step, _) = self.newton_step(p);
            if !step.is_finite() || step.length_squared() < 1e-6 * margin * margin {
                break;
            }
            p -= step;
        }
        bounds.holds(p).then_some(p)
    }

    /// The step of Newton's method along the gradient, to be subtracted from `p`, and the gradient
    /// at `p`.
    fn newton_step(&mut self, p: DVec3) -> (DVec3, DVec3) {
        let slope = value_at(self.field, self.factor, p);
        (step_to_surface(slope), slope.1)
    }
}

/// Value and gradient of a factor of the field at a point: the middles of their bounds.
pub(crate) fn value_at(field: &mut dyn Bounded, factor: usize, p: DVec3) -> (f64, DVec3) {
    let mut known = [Enclosure::UNKNOWN];
    field.enclose(factor, &[Bounds::point(p)], &mut known);
    known[0].middle()
}

/// The box of one segment.
struct GraphBox {
    bounds: Bounds,
    /// The axis nearest the normal.
    up: usize,
    /// Distance by which the box extends beyond the ends along that axis.
    room: f64,
}

impl GraphBox {
    fn around(&Segment { from, to }: &Segment, slack: f64) -> Self {
        /// Room above and below the ends, over the rise of the tangent plane between them. Less
        /// proves fewer connections, more no more.
        const RISES: f64 = 1.5;
        /// Room for the bending of the surface, as a share of the longest side. Without it proofs
        /// take longer.
        const BEND: f64 = 0.25;
        /// Room for the slack: twice what the proof needs. With just that, small components may
        /// count twice.
        const SLACKS: f64 = 8.0;
        let size = from.normal.abs();
        let up = size.max_position();
        let (mut lo, mut hi) = (from.position.min(to), from.position.max(to));
        let reach = (to - from.position).abs();
        let slope: f64 =
            (0..3).filter(|&axis| axis != up).map(|axis| size[axis] / size[up] * reach[axis]).sum();
        let room = RISES * slope + BEND * reach.max_element() + SLACKS * slack;
        lo[up] -= room;
        hi[up] += room;
        Self { bounds: Bounds::new(lo, hi), up, room }
    }
}
