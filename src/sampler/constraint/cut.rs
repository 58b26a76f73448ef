//! Creases that reach the box: they are traced beyond it and cut at its faces.
//!
//! A coarse front grows beyond the box and is clipped at its faces. A crease that crosses a face
//! gets a corner on it, at the common point of both branches and the plane, so that the creases fit
//! the mesh on both sides.

use super::meeting::{Third, common_point};
use super::{Crease, Creases, ONE_CORNER, smooth};
use crate::math::Bounds;
use crate::sampler::probe::Probe;
use crate::slices::complete;

impl Creases {
    /// The creases in a `wide` box around `bounds`, cut at the faces of `bounds`; none if no crease
    /// reaches those.
    pub(in super::super) fn beyond(&self, probe: &mut Probe, bounds: &Bounds, wide: &Bounds) -> Option<Self> {
        self.at_box()?;
        let width = Self::width(wide);
        let cells = probe.field.pieces()?.edge_cells(wide, width);
        let mut creases = complete(Self::find(probe, wide, &cells, self.unit_cell));
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

    /// Divides a curve at the plane across an axis at `offset`.
    fn cut(&mut self, probe: &mut Probe, curve: Crease, axis: usize, offset: f64, slack: f64) {
        let third = Third::Plane { axis, offset };
        let mut cuts = Vec::new();
        for (k, [here, next]) in curve.chords().enumerate() {
            if (here[axis] < offset) == (next[axis] < offset) {
                continue;
            }
            let way = next - here;
            let start = here + way * ((offset - here[axis]) / way[axis]);
            let place = if curve.is_smooth {
                smooth::in_plane(probe, curve.branches[0], axis, offset, start, way.length())
            } else {
                common_point(probe, curve.branches, third, start, way.length())
            };
            if let Some(mut place) = place {
                place[axis] = offset;
                let corner = self.corner_at(place, &curve.patches, slack);
                self.corners[corner].position[axis] = offset;
                cuts.push((k, corner));
            }
        }
        self.add_pieces(curve, &cuts, slack);
    }

    /// Adds the pieces of a curve. Each of the `cuts` is the number of a point and that of the
    /// corner after it. Pieces shorter than `slack` are dropped.
    pub(super) fn add_pieces(&mut self, curve: Crease, cuts: &[(usize, usize)], slack: f64) {
        if cuts.is_empty() {
            self.curves.push(curve);
            return;
        }
        let piece = |points, corners| Crease { points, corners, is_closed: false, ..curve.clone() };
        let mut pieces = Vec::with_capacity(cuts.len() + 1);
        let (mut points, mut from, mut cuts) = (Vec::new(), curve.corners[0], cuts.iter().peekable());
        for (k, &point) in curve.points.iter().enumerate() {
            points.push(point);
            while let Some(&(_, corner)) = cuts.next_if(|cut| cut.0 == k) {
                let place = self.corners[corner].position;
                points.push(place);
                pieces.push(piece(core::mem::replace(&mut points, vec![place]), [from, Some(corner)]));
                from = Some(corner);
            }
        }
        let mut last = piece(points, [from, curve.corners[1]]);
        if curve.is_closed {
            // The last piece of a closed curve continues with the first one.
            let first = pieces.remove(0);
            last.points.extend(first.points);
            last.corners[1] = first.corners[1];
        }
        pieces.push(last);
        self.curves.extend(pieces.into_iter().filter(|piece| piece.length() > slack));
    }
}
