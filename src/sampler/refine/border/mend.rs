//! Surgery along the border: its edges are collapsed and split like edges inside.

use super::super::net::Net;
use super::super::surgery::Operation;
use crate::math::NONE;
use core::cmp::Ordering;

/// Edges of the border outside this range of lengths, in spacings, are tried even where there is no
/// defect. Without this longer edges stay.
const SHORT: f32 = 0.85;
const LONG: f32 = 1.18;

impl Net {
    /// The operations that may mend a border vertex, in the order to try them: it has too few or
    /// too many triangles, or an edge of the border at it is short or long.
    pub(in super::super) fn operations_at_border(&self, spacing: f32, v: u32) -> [Option<Operation>; 2] {
        let planes = self.walls.planes(v);
        if planes.is_crease() {
            return [self.operation_at_crease(v), None];
        }
        let [before, after] = self.border_edges(v);
        let (short, long) =
            if self.length(before) <= self.length(after) { (before, after) } else { (after, before) };
        let excess = if planes.is_corner() { 0 } else { self.excess(v) };
        if self.length(short) < SHORT * spacing || excess < 0 {
            [self.can_merge(short).then_some(Operation::Collapse(short)), None]
        } else if excess > 0 {
            [Some(Operation::Split(long)), self.widest(v).map(Operation::Insert)]
        } else {
            [(self.length(long) > LONG * spacing).then_some(Operation::Split(long)), None]
        }
    }

    /// The operation that may mend a particle on a crease, which stays: the nearest one inside is
    /// merged into it, or another one is inserted into the widest of its faces.
    fn operation_at_crease(&self, v: u32) -> Option<Operation> {
        match self.excess(v).cmp(&0) {
            Ordering::Less => {
                let ways = self
                    .mesh
                    .around(v)
                    .map(|h| self.mesh.twin(h))
                    .filter(|&h| h != NONE && self.can_merge(h));
                ways.min_by(|&g, &h| self.length(g).total_cmp(&self.length(h))).map(Operation::Collapse)
            }
            Ordering::Greater => self.widest(v).map(Operation::Insert),
            Ordering::Equal => None,
        }
    }
}
