//! Surgery along the border: edges of it are collapsed and split as particles inside are.

use super::super::layer::{Ground, Layer};
use super::super::surgery::{Aim, Operation, Surgeon};
use crate::mesh::half_edge::{next, previous};

/// Edges of the border outside this range of lengths, in spacings, are tried even where there is no defect.
const SHORT: f32 = 0.85;
const LONG: f32 = 1.18;

impl Surgeon {
    /// Tries to mend a border vertex, if it has too few or too many triangles, or an edge of the border at it is short or long.
    /// Returns whether it was tried.
    pub(in super::super) fn mend_border(
        &mut self,
        layer: &mut Layer,
        ground: &mut Ground,
        aim: Aim,
        v: u32,
    ) -> bool {
        let size = layer.size_of(v);
        let operations = operations(layer, aim.springs.spacing * size, v);
        let is_tried = operations.iter().any(Option::is_some);
        for operation in operations.into_iter().flatten() {
            // The first one that pays is kept.
            if self.attempt(layer, ground, aim, operation, size) {
                break;
            }
        }
        is_tried
    }
}

/// What may mend a border vertex, in the order in which it is tried.
fn operations(layer: &Layer, spacing: f32, v: u32) -> [Option<Operation>; 2] {
    let mesh = &layer.mesh;
    let [before, after] = layer.border_edges(v);
    let (short, long) =
        if layer.length(before) <= layer.length(after) { (before, after) } else { (after, before) };
    let is_corner = layer.walls.planes(v).is_corner();
    let excess = if is_corner { 0 } else { layer.excess(v) };
    let collapse = || layer.can_merge(short).then_some(Operation::Collapse(short));
    if layer.length(short) < SHORT * spacing || excess < 0 {
        [collapse(), None]
    } else if excess > 0 {
        let area =
            |h: u32| layer.area_vector([h, next(h), previous(h)].map(|h| mesh.origin(h))).length_squared();
        let widest = mesh.around(v).max_by(|&g, &h| area(g).total_cmp(&area(h)));
        [Some(Operation::Split(long)), widest.map(Operation::Insert)]
    } else {
        [(layer.length(long) > LONG * spacing).then_some(Operation::Split(long)), None]
    }
}
