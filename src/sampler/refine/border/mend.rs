//! Surgery along the border: edges of it are collapsed and split as particles inside are. Without it the longest of the border is 1.47
//! spacings in the mean of 32 surfaces in random boxes, in place of 1.21.

use super::super::net::{Ground, Net};
use super::super::surgery::{Aim, Operation, Surgeon};
use crate::mesh::half_edge::{next, previous};

/// Edges of the border outside this range of lengths, in spacings, are tried even where there is no defect. Without it the longest is
/// 1.26 spacings in the mean of 32 surfaces in random boxes, in place of 1.21.
const SHORT: f32 = 0.85;
const LONG: f32 = 1.18;

impl Surgeon {
    /// Tries to mend a border vertex, if it has too few or too many triangles, or an edge of the border at it is short or long.
    /// Returns whether it was tried.
    pub(in super::super) fn mend_border(
        &mut self,
        net: &mut Net,
        ground: &mut Ground,
        aim: Aim,
        v: u32,
    ) -> bool {
        let size = net.size_of(v);
        let operations = operations(net, aim.springs.spacing * size, v);
        let is_tried = operations.iter().any(Option::is_some);
        for operation in operations.into_iter().flatten() {
            // The first one that pays is kept.
            if self.attempt(net, ground, aim, operation, size) {
                break;
            }
        }
        is_tried
    }
}

/// The operations that may mend a border vertex, in the order in which they are tried.
fn operations(net: &Net, spacing: f32, v: u32) -> [Option<Operation>; 2] {
    let mesh = &net.mesh;
    let [before, after] = net.border_edges(v);
    let (short, long) =
        if net.length(before) <= net.length(after) { (before, after) } else { (after, before) };
    let is_corner = net.walls.planes(v).is_corner();
    let excess = if is_corner { 0 } else { net.excess(v) };
    let collapse = || net.can_merge(short).then_some(Operation::Collapse(short));
    if net.length(short) < SHORT * spacing || excess < 0 {
        [collapse(), None]
    } else if excess > 0 {
        let area =
            |h: u32| net.area_vector([h, next(h), previous(h)].map(|h| mesh.origin(h))).length_squared();
        let widest = mesh.around(v).max_by(|&g, &h| area(g).total_cmp(&area(h)));
        [Some(Operation::Split(long)), widest.map(Operation::Insert)]
    } else {
        [(net.length(long) > LONG * spacing).then_some(Operation::Split(long)), None]
    }
}
