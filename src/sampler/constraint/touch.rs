//! Creases that touch: if a ball touches an edge of a cube, the circles on two faces meet in a
//! point of the edge and continue. They share a corner there.
//!
//! Three branches are zero at such a point, but one of them does not change its sign along the
//! crease of the other two, so that no walk along the crease ends there, and Newton's method for
//! three functions has no single root. The point is where the third branch is extreme along the
//! crease.

use super::meeting::{FADED, Meeting, branch, is_on};
use super::{Creases, LONGEST, NEAR, ONE_CORNER};
use crate::math::Bounds;
use crate::sampler::probe::Probe;
use crate::slices::pause;
use glam::DVec3;

/// Largest distance, in steps, of a crease from the sheet of a third branch that it touches.
/// Larger: creases that pass each other closely share a corner. Smaller: rounding hides that they
/// touch.
const TOUCH: f64 = 1e-6;
/// Share of a chord by which it is extended at both ends, since an extreme at the very end of a
/// chord is not found.
const OVERLAP: f64 = 0.1;
/// Bisections of the way to a touching point.
const BISECTIONS: u32 = 30;

impl Creases {
    /// Adds a corner at each point at which a crease touches another one.
    pub(super) async fn touch(&mut self, probe: &mut Probe<'_>, step: f64) {
        // No chord is longer, and no place that is looked at is farther from it.
        let reach = (0.5 * LONGEST + NEAR) * step;
        let boxes: Vec<Bounds> =
            self.curves.iter().map(|curve| Bounds::around(curve.points.iter().copied())).collect();
        for k in 0..self.curves.len() {
            let curve = self.curves[k].clone();
            let around = boxes[k].enlarged(reach);
            for other in (0..self.curves.len()).filter(|&other| !around.is_apart_from(&boxes[other])) {
                let beside = &self.curves[other];
                let is_new = |patch: &&u32| !curve.patches.contains(patch);
                let thirds: Vec<u32> = beside.patches.iter().filter(is_new).copied().collect();
                if thirds.is_empty() {
                    continue;
                }
                let patches = [&curve.patches[..], &beside.patches].concat();
                let count = curve.chords().count();
                for (k, [here, next]) in curve.chords().enumerate() {
                    let reach = 0.5 * here.distance(next) + NEAR * step;
                    if !self.curves[other].is_near(here.midpoint(next), reach, LONGEST * step) {
                        continue;
                    }
                    pause().await;
                    let beyond = (next - here) * OVERLAP;
                    let [is_start, is_end] =
                        [k == 0, k + 1 == count].map(|is_end| is_end && !curve.is_closed);
                    let chord = [
                        if is_start { here } else { here - beyond },
                        if is_end { next } else { next + beyond },
                    ];
                    for &third in &thirds {
                        let place = touching_point(probe, curve.branches, third, chord, step);
                        if let Some(place) = place {
                            self.corner_at(place, &patches, ONE_CORNER * step);
                        }
                    }
                }
            }
        }
    }
}

impl Meeting {
    /// Whether the sheet of another branch touches the crease so near to this point that a place
    /// next to the crease may lie beyond that sheet.
    pub(super) fn is_touched(&self, probe: &mut Probe, step: f64) -> bool {
        let chord = [self.position - self.tangent * step, self.position + self.tangent * step];
        self.branches_near(probe, step).into_iter().any(|third| {
            !self.branches.contains(&third)
                && is_on(probe, third, self.position, FADED * step)
                && touching_point(probe, self.branches, third, chord, step).is_some()
        })
    }
}

/// The point on the crease of two branches, between two of its points, at which a third branch
/// vanishes and is extreme along the crease. A branch that vanishes along the crease has none.
pub(super) fn touching_point(
    probe: &mut Probe,
    branches: [u32; 2],
    third: u32,
    [mut here, mut next]: [DVec3; 2],
    step: f64,
) -> Option<DVec3> {
    let way = next - here;
    let rise = |probe: &mut Probe, p: DVec3| {
        let at = Meeting::of_branches(probe, branches, p, way.length(), FADED)?;
        let along = if at.tangent.dot(way) < 0.0 { -at.tangent } else { at.tangent };
        let (value, gradient) = branch(probe, third, at.position);
        let is_off = value.abs() > TOUCH * step * gradient.length();
        Some((at.position, gradient.dot(along), is_off))
    };
    let [(_, before, is_off), (_, after, is_off_behind)] = [rise(probe, here)?, rise(probe, next)?];
    let is_turning = before * after < 0.0 && is_off && is_off_behind;
    if !is_turning {
        return None;
    }
    for _ in 0..BISECTIONS {
        let (middle, slope, _) = rise(probe, here.midpoint(next))?;
        if slope * before > 0.0 {
            here = middle;
        } else {
            next = middle;
        }
    }
    is_on(probe, third, here, TOUCH * step).then_some(here)
}
