//! The cells of the box in which more than one branch may give points of the surface.

use crate::field::Field;
use crate::math::Bounds;

/// A cell, with the branches that may give points of the surface in it, in ascending order.
pub(super) struct CreaseCell {
    pub(super) bounds: Bounds,
    pub(super) branches: Vec<u32>,
}

/// Cells no wider than `width` in which more than one branch may be zero, in a fixed order. A field without creases has none, at the
/// cost of one question.
pub(super) fn cells(field: &mut dyn Field, bounds: &Bounds, width: f64) -> Vec<CreaseCell> {
    let mut found = Vec::new();
    let mut open = vec![*bounds];
    while let Some(cell) = open.pop() {
        let branches = field.branches_in(&cell);
        if branches.as_ref().is_some_and(|branches| branches.len() < 2) {
            continue;
        }
        let size = cell.size();
        if size.max_element() > width {
            let axis = if size.x >= size.y.max(size.z) {
                0
            } else if size.y >= size.z {
                1
            } else {
                2
            };
            let (mut low, mut high) = (cell, cell);
            low.max[axis] = cell.middle()[axis];
            high.min[axis] = low.max[axis];
            open.extend([high, low]);
        } else if let Some(mut branches) = branches {
            branches.sort_unstable();
            found.push(CreaseCell { bounds: cell, branches });
        }
    }
    found
}
