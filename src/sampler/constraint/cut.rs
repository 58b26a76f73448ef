//! Creases that run to the box: they are followed beyond it, and cut where they pass its faces.
//!
//! A coarse front grows beyond the box and is clipped there. So that the creases fit its mesh on both sides of a face, one that passes the
//! face has a corner on it, at the common point of both branches and the plane.

use super::meeting::{Third, common_point};
use super::{Crease, Creases, ONE_CORNER};
use crate::field::BranchNumbers;
use crate::math::Bounds;
use crate::sampler::probe::Probe;
use crate::slices::complete;

impl Creases {
    /// The creases in a `wide` box around `bounds`, cut at the faces of that; none if no crease runs to it.
    pub(in super::super) fn beyond(&self, probe: &mut Probe, bounds: &Bounds, wide: &Bounds) -> Option<Self> {
        self.at_box()?;
        probe.select(None);
        let width = Self::width(wide);
        let cells = complete(probe.field.branched()?.crease_cells(wide, width, BranchNumbers::Kept));
        let mut creases = complete(Self::find(probe, wide, &cells));
        let [lo, hi] = bounds.single().map(|corner| corner.as_dvec3());
        for axis in 0..3 {
            for offset in [lo[axis], hi[axis]] {
                for curve in core::mem::take(&mut creases.curves) {
                    creases.cut(probe, curve, axis, offset, ONE_CORNER * 0.5 * width);
                }
            }
        }
        Some(creases)
    }

    /// Adds the pieces into which the plane across an axis at `offset` cuts a curve. What is shorter than `slack` is none.
    fn cut(&mut self, probe: &mut Probe, curve: Crease, axis: usize, offset: f64, slack: f64) {
        let third = Third::Plane { axis, offset };
        let mut pieces =
            vec![Crease { points: Vec::new(), corners: [curve.corners[0], None], ..curve.clone() }];
        let first = curve.is_closed.then(|| curve.points[0]);
        for &next in curve.points.iter().chain(&first) {
            let last = pieces.len() - 1;
            if let Some(&here) = pieces[last].points.last()
                && (here[axis] < offset) != (next[axis] < offset)
            {
                let way = next - here;
                let start = here + way * ((offset - here[axis]) / way[axis]);
                if let Some(mut place) = common_point(probe, curve.branches, third, start, way.length()) {
                    place[axis] = offset;
                    let corner = self.corner_at(place, &curve.patches, slack);
                    self.corners[corner].position[axis] = offset;
                    pieces[last].points.push(place);
                    pieces[last].corners[1] = Some(corner);
                    let (points, corners) = (vec![place], [Some(corner), None]);
                    pieces.push(Crease { points, corners, ..curve.clone() });
                }
            }
            let last = pieces.len() - 1;
            pieces[last].points.push(next);
        }
        if let [.., last] = &mut pieces[..] {
            last.corners[1] = curve.corners[1];
        }
        if pieces.len() == 1 {
            self.curves.push(curve);
            return;
        }
        if curve.is_closed {
            // The last piece goes on with the first one.
            let first = core::mem::take(&mut pieces[0].points);
            let corners = pieces[0].corners;
            pieces.remove(0);
            if let Some(last) = pieces.last_mut() {
                last.points.extend_from_slice(&first[1..]);
                last.corners[1] = corners[1];
            }
        }
        let length =
            |piece: &Crease| piece.points.windows(2).map(|pair| pair[0].distance(pair[1])).sum::<f64>();
        pieces.retain(|piece| length(piece) > slack);
        self.curves.extend(pieces.into_iter().map(|piece| Crease { is_closed: false, ..piece }));
    }
}
