//! The features that hold particles in place: creases, along which f changes from one smooth branch
//! to another, corners, where more than two branches meet, and the [tips] of cones.
//!
//! A formula with maxima, minima and absolute values has a surface of *patches*. On each one smooth
//! branch gives f, or several that meet without an edge
//! ([`Pieces::label`](crate::field::Pieces::label)). Two patches meet along a *crease*, the curve
//! on which both branches vanish; it ends at a corner or at the box, or is closed. Where the
//! factors of a product cross, four patches meet: each factor is two branches, one on either side
//! of the other factor. Pieces that meet without an edge, yet are not one patch, have a
//! [smooth join](smooth) instead of a crease.
//!
//! 1. *Search.* The field lists the small cells of the box that may hold creases. In each cell
//!    Newton's method searches for a point on each pair of branches.
//! 2. *Trace.* From such a point the curve is traced both ways until another branch takes over, at
//!    a corner. The other creases of the corner are traced from there. A crease that passes a
//!    corner of others is divided there, and so are creases that touch.
//! 3. *Fill.* Particles are put on corners and along curves at equal distances, as many as fit
//!    best. They stay fixed: fronts start and end at them, patch by patch. For a refinement they
//!    are placed for all levels at once and, if creases reach the box, also at its faces and
//!    beyond.

mod cell;
mod cut;
mod fill;
mod ladder;
mod meeting;
mod smooth;
#[cfg(test)]
mod tests;
pub(super) mod tips;
mod touch;
mod trace;

use crate::field::UnitCell;
use crate::math::{Bounds, Forest, SHARP};
use crate::sampler::probe::Probe;
use crate::slices::pause;
use cell::{FacePair, Image};
use glam::{DVec3, Vec3};
pub(super) use ladder::CreaseLadder;
use meeting::Meeting;

/// Side of the smallest cells of the search, and about twice the step along a curve, as a share of
/// the diagonal of the box.
const CELL: f64 = 1.0 / 128.0;
/// Corners closer than this share of a step are the same one; it is the width of the smallest
/// crease that is traced. A corner and a tip closer than this share of a radius are the same, too.
const ONE_CORNER: f64 = 1e-3;
/// Distance from a corner, in steps, at which the creases that end there are searched for: ten
/// times the width of the smallest one.
const BESIDE: f64 = 10.0 * ONE_CORNER;
/// Ends of fading creases within this share of a step are one corner, and corners on opposite faces
/// images. Such ends are known less precisely than corners: a walk may end at an angle of
/// [`meeting::FADED`], on three crossing cylinders a twentieth of a step before.
const ONE_END: f64 = 0.1;

/// A point at most this far from the chord between two points of a curve, in steps, lies on the
/// curve: the chord of a curve that turns by 60° in two steps is a seventh of a step away.
const NEAR: f64 = 0.2;

/// Upper bound of the length of a chord, in steps: a step leads at most as far beyond its end, and
/// its last one along the box as far again.
const LONGEST: f64 = 4.0;

/// Newton's method stops once a step is shorter than this share of the reach: it squares the share,
/// to below any rounding.
const AT_REST: f64 = 1e-9;

/// A curve along which patches meet: two, or four where two sheets cross.
#[derive(Clone, Debug)]
pub(super) struct Crease {
    /// Two of the patches, at an angle, whose branches are zero together on the curve.
    branches: [u32; 2],
    /// The patches, in ascending order.
    patches: Vec<u32>,
    /// Pairs of a patch on the left and one on the right, seen from outside.
    sides: Vec<[u32; 2]>,
    /// Points along the curve, in its order.
    points: Vec<DVec3>,
    /// Corners at its start and its end; none if the curve ends at the box or is closed.
    corners: [Option<usize>; 2],
    /// Whether the last point is followed by the first.
    is_closed: bool,
    /// Whether the patches meet without an edge.
    is_smooth: bool,
    /// If this is an image: the crease that it repeats, on the opposite face of a cell.
    image: Option<Image>,
}

impl Crease {
    /// The pairs of successive points.
    fn chords(&self) -> impl Iterator<Item = [DVec3; 2]> {
        let closing = self.is_closed.then(|| [self.points[self.points.len() - 1], self.points[0]]);
        self.points.windows(2).map(|pair| [pair[0], pair[1]]).chain(closing)
    }

    /// Whether a chord comes within `reach` of a point. No chord is longer than `longest`: after a
    /// chord far away, those that cannot have come near yet are skipped.
    fn is_near(&self, p: DVec3, reach: f64, longest: f64) -> bool {
        let points = &self.points;
        let count = points.len() - usize::from(!self.is_closed);
        let mut k = 0;
        while k < count {
            let (a, b) = (points[k], points[(k + 1) % points.len()]);
            let way = b - a;
            let t = ((p - a).dot(way) / way.length_squared()).clamp(0.0, 1.0);
            let distance = (a + way * t).distance(p);
            if distance <= reach {
                return true;
            }
            k += (((distance - reach) / longest).ceil() as usize).max(1);
        }
        false
    }

    fn length(&self) -> f64 {
        self.chords().map(|[a, b]| a.distance(b)).sum()
    }
}

/// A point at which creases end.
#[derive(Clone, Debug)]
pub(super) struct Corner {
    position: DVec3,
    /// The patches that meet there, in ascending order.
    patches: Vec<u32>,
    /// If this is an image: the corner that it repeats, on the opposite face of a cell.
    image: Option<Image>,
}

/// The creases and corners of a surface in a box.
#[derive(Clone, Debug, Default)]
pub struct Creases {
    curves: Vec<Crease>,
    corners: Vec<Corner>,
    /// The cell that closes the surface, if one does.
    unit_cell: Option<UnitCell>,
    /// Opposite faces of the cell with the same creases.
    faces: Vec<FacePair>,
    /// A place on a curve that is not traced, since sheets cross there and no patch ends: three
    /// planes through one line, say.
    pub(super) passed: Option<DVec3>,
    /// A place where branches vanish together and f vanishes only on a curve or at a point, as
    /// |x| + |y| does.
    pub(super) bare: Option<DVec3>,
    /// Whether there may be a crease where none was found.
    pub(super) is_open: bool,
    /// Number of evaluations that the search took.
    pub(super) evaluations: u64,
}

impl Creases {
    /// Width of the [cells](crate::field::Pieces::edge_cells) in which creases are searched for.
    pub(super) fn width(bounds: &Bounds) -> f64 {
        CELL * bounds.diagonal()
    }

    /// Finds the creases of a field in `bounds`, which lie in these cells, in slices. Those on
    /// opposite faces of a unit cell are the same.
    pub(super) async fn find(
        probe: &mut Probe<'_>,
        bounds: &Bounds,
        cells: &[Bounds],
        unit_cell: Option<UnitCell>,
    ) -> Self {
        let mut creases = Self { unit_cell, ..Self::default() };
        let start = probe.evaluations();
        let step = 0.5 * Self::width(bounds);
        for cell in cells {
            pause().await;
            let branches = probe.field.labels_in(cell).unwrap_or_default();
            for (k, &a) in branches.iter().enumerate() {
                for &b in &branches[..k] {
                    let meeting = Meeting::of_branches(probe, [b, a], cell.middle(), 2.0 * step, SHARP)
                        .filter(|meeting| {
                            bounds.holds(meeting.position)
                                && !creases.has_point(meeting.position, meeting.branches, step)
                        });
                    let Some(meeting) = meeting else { continue };
                    if meeting.are_left(probe, &[b, a], step).is_some() {
                        trace::trace(probe, bounds, &mut creases, meeting, step).await;
                    } else if creases.passed.is_none() && meeting.is_passed(probe, step) {
                        creases.passed = Some(meeting.position);
                    } else if creases.bare.is_none() && meeting.is_bare(probe, step) {
                        creases.bare = Some(meeting.position);
                    }
                }
            }
        }
        creases.trace_from_corners(probe, bounds, step).await;
        creases.trace_smooth_joins(probe, bounds, cells, step).await;
        creases.touch(probe, step).await;
        creases.divide(probe, step);
        if let Some(cell) = unit_cell {
            creases.repeat(probe, &cell, step);
        }
        creases.end_at_limits(probe);
        creases.is_open = !cells.is_empty() && !creases.are_there();
        creases.evaluations = probe.evaluations() - start;
        creases
    }

    /// Traces the smooth joins, where different patches meet without an edge, and the creases that
    /// start at their ends.
    async fn trace_smooth_joins(
        &mut self,
        probe: &mut Probe<'_>,
        bounds: &Bounds,
        cells: &[Bounds],
        step: f64,
    ) {
        let pairs = probe.field.tangent_pairs();
        if pairs.is_empty() {
            return;
        }
        for cell in cells {
            pause().await;
            let branches = probe.field.labels_in(cell).unwrap_or_default();
            for pair in pairs.iter().filter(|pair| pair.iter().all(|patch| branches.contains(patch))) {
                if self.runs_by(cell.middle(), *pair, 0.5 * cell.diagonal(), step) {
                    continue;
                }
                let start = Meeting::on_smooth_join(probe, *pair, cell).filter(|start| {
                    bounds.holds(start.position) && !self.has_point(start.position, *pair, step)
                });
                if let Some(start) = start
                    && start.are_left(probe, pair, step).is_some()
                {
                    trace::trace(probe, bounds, self, start, step).await;
                }
            }
        }
        self.trace_from_corners(probe, bounds, step).await;
    }

    /// Traces the creases between patches that meet at a corner: the search may miss one shorter
    /// than a cell.
    async fn trace_from_corners(&mut self, probe: &mut Probe<'_>, bounds: &Bounds, step: f64) {
        let mut next = 0;
        while let Some(Corner { position, patches, .. }) = self.corners.get(next).cloned() {
            next += 1;
            pause().await;
            for (k, &a) in patches.iter().enumerate() {
                for &b in &patches[..k] {
                    for meeting in Meeting::beside_corner(probe, [b, a], position, step) {
                        let is_new = bounds.holds(meeting.position)
                            && !self.has_point(meeting.position, meeting.branches, step);
                        if is_new {
                            trace::trace(probe, bounds, self, meeting, step).await;
                        }
                    }
                }
            }
        }
    }

    /// Whether a known crease of two branches runs through a point.
    fn has_point(&self, p: DVec3, branches: [u32; 2], step: f64) -> bool {
        self.runs_by(p, branches, NEAR * step, step)
    }

    /// Whether a known crease of two branches comes within `reach` of a point.
    fn runs_by(&self, p: DVec3, branches: [u32; 2], reach: f64, step: f64) -> bool {
        let has_both = |curve: &&Crease| branches.iter().all(|branch| curve.patches.contains(branch));
        self.curves.iter().filter(has_both).any(|curve| curve.is_near(p, reach, LONGEST * step))
    }

    /// The first corner on a chord of a crease of these branches, farther along it than `after` and
    /// not one of the `others`: how far along it lies, and its number.
    fn corner_on(
        &self,
        probe: &mut Probe,
        branches: [u32; 2],
        [here, next]: [DVec3; 2],
        after: f64,
        step: f64,
        others: [Option<usize>; 2],
    ) -> Option<(f64, usize)> {
        let length = here.distance(next);
        let way = (next - here) / length;
        let mut first = None;
        for (index, &Corner { position, .. }) in self.corners.iter().enumerate() {
            let along = (position - here).dot(way);
            let is_first = along > after && along <= first.map_or(length, |(least, _)| least);
            if is_first
                && (here + way * along).distance(position) <= NEAR * step
                && !others.contains(&Some(index))
                && branches.into_iter().all(|b| meeting::is_on(probe, b, position, ONE_CORNER * step))
            {
                first = Some((along, index));
            }
        }
        first
    }

    /// Divides creases at corners of other creases that lie on them. A corner keeps the patches
    /// that meet along its creases.
    fn divide(&mut self, probe: &mut Probe, step: f64) {
        for curve in core::mem::take(&mut self.curves) {
            let mut cuts = Vec::new();
            for (k, chord) in curve.chords().enumerate() {
                // Each corner is farther along the chord than the one before, so that none is found
                // twice.
                let mut after = 0.0;
                while let Some((along, corner)) =
                    self.corner_on(probe, curve.branches, chord, after, step, curve.corners)
                {
                    after = along;
                    self.corner_at(self.corners[corner].position, &curve.patches, 0.0);
                    cuts.push((k, corner));
                }
            }
            self.add_pieces(curve, &cuts, ONE_CORNER * step);
        }
        // A corner may also lie on the sheet of a branch that gives f nowhere around it; that
        // branch has no patch there.
        for (index, corner) in self.corners.iter_mut().enumerate() {
            let ending = self.curves.iter().filter(|curve| curve.corners.contains(&Some(index)));
            let patches: Vec<u32> = ending.flat_map(|curve| curve.patches.iter().copied()).collect();
            if !patches.is_empty() {
                corner.patches.retain(|patch| patches.contains(patch));
            }
        }
    }

    /// Drops the patches that limit the surface, and the curves and corners where only these meet.
    /// The remaining curves are the rim of the surface.
    fn end_at_limits(&mut self, probe: &mut Probe) {
        if !probe.field.has_limits() {
            return;
        }
        let mut keep = |patches: &mut Vec<u32>| {
            patches.retain(|&patch| !probe.field.is_limit(patch));
            !patches.is_empty()
        };
        self.curves.retain_mut(|curve| keep(&mut curve.patches));
        let mut place = Vec::with_capacity(self.corners.len());
        let mut kept = 0;
        for corner in &mut self.corners {
            let is_kept = keep(&mut corner.patches);
            place.push(is_kept.then_some(kept));
            kept += usize::from(is_kept);
        }
        self.corners.retain(|corner| !corner.patches.is_empty());
        for curve in &mut self.curves {
            curve.corners = curve.corners.map(|corner| corner.and_then(|corner| place[corner]));
        }
    }

    /// The nearest corner of two patches ahead of a place, within `reach`.
    fn corner_ahead(&self, p: DVec3, way: DVec3, patches: [u32; 2], reach: f64) -> Option<usize> {
        let ahead = self.corners.iter().enumerate().filter(|(_, corner)| {
            patches.iter().all(|patch| corner.patches.contains(patch))
                && corner.position.distance(p) <= reach
                && (corner.position - p).dot(way) > 0.0
        });
        let distance = |corner: &Corner| corner.position.distance_squared(p);
        ahead.min_by(|(_, a), (_, b)| distance(a).total_cmp(&distance(b))).map(|(index, _)| index)
    }

    /// Number of the corner at a position, which is added if it is new.
    fn corner_at(&mut self, position: DVec3, patches: &[u32], slack: f64) -> usize {
        let known = self.corners.iter().position(|corner| corner.position.distance(position) <= slack);
        let index = known.unwrap_or_else(|| {
            self.corners.push(Corner { position, patches: Vec::new(), image: None });
            self.corners.len() - 1
        });
        let own = &mut self.corners[index].patches;
        own.extend_from_slice(patches);
        own.sort_unstable();
        own.dedup();
        index
    }

    /// Points along all curves and at all corners, each with the patches that meet there.
    pub(super) fn points(&self) -> impl Iterator<Item = (Vec3, &[u32])> {
        let on_curves = self
            .curves
            .iter()
            .flat_map(|curve| curve.points.iter().map(|point| (point.as_vec3(), &curve.patches[..])));
        let corners = self.corners.iter().map(|corner| (corner.position.as_vec3(), &corner.patches[..]));
        on_curves.chain(corners)
    }

    /// Whether a corner lies within `reach` of a point.
    pub(super) fn has_corner(&self, p: DVec3, reach: f64) -> bool {
        self.corners.iter().any(|corner| corner.position.distance(p) <= reach)
    }

    /// Whether there are creases or corners.
    pub(super) fn are_there(&self) -> bool {
        !(self.curves.is_empty() && self.corners.is_empty())
    }

    /// Number of connected components of creases and corners.
    pub(super) fn pieces(&self) -> u32 {
        let mut joined = Forest::new(self.corners.len() + self.curves.len());
        for (k, curve) in (self.corners.len() as u32..).zip(&self.curves) {
            curve.corners.into_iter().flatten().for_each(|corner| joined.join(k, corner as u32));
        }
        (0..(self.corners.len() + self.curves.len()) as u32).filter(|&k| joined.find(k) == k).count() as u32
    }

    /// A point at which a crease ends at the box, if there is one.
    fn at_box(&self) -> Option<Vec3> {
        let mut ends = self.curves.iter().filter(|curve| !curve.is_closed).flat_map(|curve| {
            let points = [curve.points.first(), curve.points.last()];
            points.into_iter().flatten().zip(curve.corners)
        });
        ends.find(|(_, corner)| corner.is_none()).map(|(point, _)| point.as_vec3())
    }
}
