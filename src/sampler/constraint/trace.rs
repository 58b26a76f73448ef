//! Follows a crease from one of its points to both ends.

use super::meeting::{FADED, MOST_TURN, Meeting, Third, common_point, touching_point};
use super::{BESIDE, Crease, Creases, NEAR, ONE_CORNER, ONE_END, smooth, touch};
use crate::math::Bounds;
use crate::sampler::probe::Probe;
use crate::slices::{Work, pause};
use glam::DVec3;

/// Largest number of halvings of a step: a closed crease as wide as a thousandth of the usual step,
/// in twelve turns of 30°, is traced.
const HALVINGS: u32 = 12;
/// Bisections of the way to the end of a crease that ends at no corner: it is found to a billionth
/// of a step.
const BISECTIONS: u32 = 30;
/// Largest number of steps on one curve: 80 times the diagonal of the box. A longer one is divided,
/// so that no walk is endless.
pub(super) const MOST_STEPS: usize = 20_000;

/// Largest distance, in steps, from the end of a smooth join to that of the crease that fades out
/// there: where its angle is small, neither is known exactly.
const AHEAD: f64 = 4.0;

/// Largest number of corners within one step of a walk, one before the other, each of a branch that
/// gives f at no other.
const MOST_RETREATS: u32 = 8;

/// How a walk along a crease ended.
enum WalkEnd {
    /// The walk has come back to its start.
    Closed,
    /// At the box.
    Open,
    /// At the corner of this number, or where the crease fades out or is divided.
    Corner(usize),
}

/// Traces the crease through `start` and adds it with its corners. Next to a point at which another
/// sheet touches the crease nothing is traced.
pub(super) fn trace<'a>(
    probe: &'a mut Probe<'_>,
    bounds: &'a Bounds,
    creases: &'a mut Creases,
    start: Meeting,
    step: f64,
) -> Work<'a, ()> {
    Box::pin(async move {
        if !start.is_smooth() && start.is_touched(probe, step) {
            return;
        }
        let patches = if start.is_smooth() { start.branches.to_vec() } else { start.patches(probe, step) };
        let are_left = start.are_left(probe, &patches, step);
        let mut walk = Walk { probe, bounds, start, patches: &patches, are_left: are_left.as_deref(), step };
        let mut points = vec![start.position];
        let (mut corners, mut is_closed) = ([None; 2], false);
        for (way, corner) in [start.tangent, -start.tangent].into_iter().zip(&mut corners) {
            match walk.run(creases, way, &mut points).await {
                WalkEnd::Closed => {
                    is_closed = true;
                    break;
                }
                WalkEnd::Open => {}
                WalkEnd::Corner(index) => *corner = Some(index),
            }
            points.reverse();
        }
        // A crease that starts on the box has its first point twice.
        points.dedup();
        // A start may also be a corner at which two patches meet that share nothing else.
        let length: f64 = points.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
        if !is_closed && length <= ONE_CORNER * step {
            return;
        }
        let [end, first] = corners;
        // The points are in the direction of the tangent at the start.
        let on = |left: bool| {
            let sides = patches.iter().zip(are_left.iter().flatten());
            sides.filter(move |&(_, &is_left)| is_left == left).map(|(&patch, _)| patch)
        };
        let sides = on(true).zip(on(false)).map(|(left, right)| [left, right]).collect();
        creases.curves.push(Crease {
            branches: start.branches,
            patches,
            sides,
            points,
            corners: [first, end],
            is_closed,
            is_smooth: start.is_smooth(),
            image: None,
        });
    })
}

/// A walk along a crease, from one of its points.
struct Walk<'a, 'f> {
    probe: &'a mut Probe<'f>,
    bounds: &'a Bounds,
    start: Meeting,
    /// The patches that meet.
    patches: &'a [u32],
    /// Whether each is on the left: where a ridge becomes a groove, one crease ends and another
    /// begins.
    are_left: Option<&'a [bool]>,
    /// Usual length of a step.
    step: f64,
}

impl Walk<'_, '_> {
    /// Continues from the last of the `points`, and adds the points on the way.
    async fn run(&mut self, creases: &mut Creases, direction: DVec3, points: &mut Vec<DVec3>) -> WalkEnd {
        let origin = self.start.position;
        let (mut last, mut direction) = (self.start, direction);
        let is_forward = self.start.tangent.dot(direction) > 0.0;
        let mut left_start = false;
        while points.len() < MOST_STEPS {
            pause().await;
            let here = last.position;
            let next = if self.start.is_smooth() {
                self.next_of_smooth_join(&last, direction, is_forward)
            } else {
                self.next(here, direction)
            };
            let Some((next, length)) = next else {
                if self.start.is_smooth()
                    && let Some(corner) =
                        creases.corner_ahead(here, direction, self.start.branches, AHEAD * self.step)
                {
                    points.push(creases.corners[corner].position);
                    return WalkEnd::Corner(corner);
                }
                return WalkEnd::Corner(creases.corner_at(here, self.patches, ONE_END * self.step));
            };
            let is_smooth = self.start.is_smooth();
            if !is_smooth && (next.tangent.dot(direction) > 0.0) != is_forward {
                let end = self.turn(last, next, direction, is_forward);
                return self.end_at(creases, [here, end], self.patches, ONE_END, points);
            }
            if !is_smooth && !self.is_same_crease(&next, self.step) && !self.is_touched(here, &next) {
                return self.end_before(creases, here, &next, points);
            }
            if !self.bounds.holds(next.position) {
                return self.end_at_box(here, next.position, points);
            }
            if let Some((_, corner)) = creases.corner_on(
                self.probe,
                self.start.branches,
                [here, next.position],
                0.0,
                self.step,
                [None; 2],
            ) {
                let end = creases.corners[corner].position;
                return self.end_at(creases, [here, end], self.patches, ONE_CORNER, points);
            }
            // The part of 1.2 above 1 allows for the turn of a step.
            let to_start = origin - here;
            let is_back = to_start.dot(direction) > 0.0 && to_start.length() <= 1.2 * length;
            if left_start && is_back && next.position.distance(origin) <= length {
                return WalkEnd::Closed;
            }
            left_start |= next.position.distance(origin) > length;
            direction = if is_forward { next.tangent } else { -next.tangent };
            last = next;
            points.push(next.position);
        }
        WalkEnd::Corner(creases.corner_at(last.position, self.patches, ONE_CORNER * self.step))
    }

    /// The next point of the curve on which both branches vanish, and the length of the step.
    fn next(&mut self, here: DVec3, direction: DVec3) -> Option<(Meeting, f64)> {
        let mut length = self.step;
        for _ in 0..=HALVINGS {
            let guess = here + direction * length;
            let next = Meeting::of_branches(self.probe, self.start.branches, guess, length, FADED);
            if let Some(next) = next
                && next.tangent.dot(direction).abs() >= MOST_TURN
                && (next.position - here).dot(direction) >= MOST_TURN * next.position.distance(here)
            {
                return Some((next, length));
            }
            length *= 0.5;
        }
        None
    }

    /// The next point of a smooth join, and the length of the step.
    fn next_of_smooth_join(
        &mut self,
        last: &Meeting,
        direction: DVec3,
        is_forward: bool,
    ) -> Option<(Meeting, f64)> {
        let [a, b] = self.start.branches;
        let is_first_left = self.are_left.is_some_and(|are_left| are_left[0]) == is_forward;
        let sides = if is_first_left { [a, b] } else { [b, a] };
        let mut lengths = core::iter::successors(Some(self.step), |length| Some(0.5 * length));
        let ahead = lengths
            .by_ref()
            .take(HALVINGS as usize + 1)
            .find_map(|length| Some((last.along_smooth_join(self.probe, sides, direction, length)?, length)));
        let (mut next, length) = ahead.or_else(|| {
            let length = BESIDE * self.step;
            Some((last.around_kink(self.probe, sides, length)?, length))
        })?;
        if !is_forward {
            next.tangent = -next.tangent;
        }
        Some((next, length))
    }

    /// The point, between the last one of the walk and one after it, where the angle between the
    /// branches changes its sign: the crease fades out there, and another one may begin.
    fn turn(&mut self, mut before: Meeting, mut after: Meeting, direction: DVec3, is_forward: bool) -> DVec3 {
        let branches = self.start.branches;
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (before.position + after.position);
            let reach = before.position.distance(after.position);
            let Some(point) = Meeting::of_branches(self.probe, branches, middle, reach, FADED) else {
                // The sine changes evenly where it is small.
                let share = before.sine / (before.sine + after.sine);
                return touching_point(self.probe, branches, before.position.lerp(after.position, share));
            };
            if (point.tangent.dot(direction) > 0.0) == is_forward {
                before = point;
            } else {
                after = point;
            }
        }
        before.position
    }

    /// Ends the walk between its last point and the point `beyond`, where other branches give f: at
    /// a corner, if a third branch vanishes there.
    fn end_before(
        &mut self,
        creases: &mut Creases,
        here: DVec3,
        beyond: &Meeting,
        points: &mut Vec<DVec3>,
    ) -> WalkEnd {
        let branches = self.start.branches;
        let mut beyond = *beyond;
        'nearer: for _ in 0..MOST_RETREATS {
            let way = beyond.position - here;
            for third in self.branches_around(beyond.position) {
                let corner =
                    common_point(self.probe, branches, Third::Branch(third), here + 0.5 * way, way.length());
                if let Some(corner) = corner
                    && (corner - here).dot(way) > 0.0
                    && corner.distance(here) <= (1.0 + BESIDE) * way.length()
                {
                    // There may be a corner before this one, of a branch that gives f at neither
                    // end of the step.
                    let share = (corner.distance(here) - BESIDE * self.step) / way.length();
                    if share > 0.0
                        && share < 1.0 - BESIDE
                        && let Some(before) =
                            Meeting::of_branches(self.probe, branches, here + way * share, self.step, FADED)
                        && !self.is_same_crease(&before, self.step)
                    {
                        beyond = before;
                        continue 'nearer;
                    }
                    let patches = [self.patches, &[third]].concat();
                    return self.end_at(creases, [here, corner], &patches, ONE_CORNER, points);
                }
            }
            break;
        }
        let way = beyond.position - here;
        let (mut active, mut inactive) = (here, beyond.position);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (active + inactive);
            let point = Meeting::of_branches(self.probe, branches, middle, way.length(), FADED);
            match point {
                Some(point) if self.is_same_crease(&point, ONE_CORNER * self.step) => {
                    active = point.position;
                }
                _ => inactive = middle,
            }
        }
        let corner = self.corner_beside(here, way, active);
        if let Some((corner, third)) = corner {
            let patches = [self.patches, &[third]].concat();
            return self.end_at(creases, [here, corner], &patches, ONE_CORNER, points);
        }
        self.end_at(creases, [here, active], self.patches, ONE_END, points)
    }

    /// The corner nearest to the end of a crease, within a step and ahead of `here`, and its third
    /// branch, which has another crease there. At a reflex corner that branch gives f nowhere along
    /// this one, and where pieces are extrapolated the end is known less well.
    fn corner_beside(&mut self, here: DVec3, way: DVec3, end: DVec3) -> Option<(DVec3, u32)> {
        let mut nearest: Option<(DVec3, u32)> = None;
        for third in self.others_around(Bounds::new(end - self.step, end + self.step)) {
            let corner = common_point(self.probe, self.start.branches, Third::Branch(third), end, self.step);
            let corner = corner.filter(|corner| {
                (*corner - here).dot(way) > 0.0
                    && nearest.is_none_or(|(known, _)| corner.distance(end) < known.distance(end))
            });
            let ends = |walk: &mut Self, corner, b| {
                !Meeting::beside_corner(walk.probe, [b, third], corner, walk.step).is_empty()
            };
            if let Some(corner) = corner
                && self.start.branches.into_iter().any(|b| ends(self, corner, b))
            {
                nearest = Some((corner, third));
            }
        }
        nearest
    }

    /// Ends the walk on its way from one point to another: at the corner of these patches there,
    /// which is a known one within a `share` of a step, or at the box, if the corner lies beyond it
    /// by more than rounding.
    fn end_at(
        &mut self,
        creases: &mut Creases,
        [here, end]: [DVec3; 2],
        patches: &[u32],
        share: f64,
        points: &mut Vec<DVec3>,
    ) -> WalkEnd {
        let inside = end.clamp(self.bounds.lo(), self.bounds.hi());
        if inside.distance(end) > ONE_CORNER * self.step {
            return self.end_at_box(here, end, points);
        }
        points.push(inside);
        WalkEnd::Corner(creases.corner_at(inside, patches, share * self.step))
    }

    /// Whether the patches are on the same sides of the curve at a point as at its start.
    fn is_same_crease(&mut self, point: &Meeting, reach: f64) -> bool {
        point.are_left(self.probe, self.patches, reach).as_deref() == self.are_left
    }

    /// Whether another branch touches the crease on the way to a point or soon after it, and gives
    /// f next to it there, but not farther on.
    fn is_touched(&mut self, here: DVec3, next: &Meeting) -> bool {
        let (branches, way) = (self.start.branches, next.position - here);
        let behind = next.position + way;
        let behind = Meeting::of_branches(self.probe, branches, behind, way.length(), FADED);
        behind.is_some_and(|behind| {
            let chord = [here, behind.position];
            self.is_same_crease(&behind, self.step)
                && self.others_along(chord).into_iter().any(|third| {
                    touch::touching_point(self.probe, branches, third, chord, self.step).is_some()
                })
        })
    }

    /// The branches, other than those of the walk, that may give f along a chord.
    fn others_along(&mut self, [a, b]: [DVec3; 2]) -> Vec<u32> {
        self.others_around(Bounds::new(a.min(b) - NEAR * self.step, a.max(b) + NEAR * self.step))
    }

    /// The branches, other than those of the walk, that may give f in a box.
    fn others_around(&mut self, around: Bounds) -> Vec<u32> {
        let mut found = self.probe.field.labels_in(&around).unwrap_or_default();
        found.retain(|branch| !self.patches.contains(branch));
        found
    }

    /// The branches, other than those of the walk, that give f at a point and around it.
    fn branches_around(&mut self, p: DVec3) -> Vec<u32> {
        let aside = BESIDE * self.step;
        let offsets = [DVec3::ZERO, DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
        let mut found: Vec<u32> = Vec::new();
        for offset in offsets {
            let branch = self.probe.field.label(p + offset * aside);
            if !self.patches.contains(&branch) && !found.contains(&branch) {
                found.push(branch);
            }
        }
        found
    }

    /// Ends the walk where the curve leaves the box, on its way from one point to another outside.
    fn end_at_box(&mut self, here: DVec3, outside: DVec3, points: &mut Vec<DVec3>) -> WalkEnd {
        let way = outside - here;
        let mut share = 1.0;
        let mut plane = Third::Plane { axis: 0, offset: self.bounds.max[0] };
        for axis in 0..3 {
            for offset in [self.bounds.min[axis], self.bounds.max[axis]] {
                let t = (offset - here[axis]) / way[axis];
                let is_left = (outside[axis] - offset) * (here[axis] - offset) <= 0.0;
                if is_left && t < share {
                    (share, plane) = (t, Third::Plane { axis, offset });
                }
            }
        }
        let place = here + way * share;
        let branches = self.start.branches;
        let end = match plane {
            Third::Plane { axis, offset } if self.start.is_smooth() => {
                smooth::in_plane(self.probe, branches[0], axis, offset, place, way.length())
            }
            _ => common_point(self.probe, branches, plane, place, way.length()),
        };
        let end = end.unwrap_or(place);
        points.push(end.clamp(self.bounds.lo(), self.bounds.hi()));
        WalkEnd::Open
    }
}
