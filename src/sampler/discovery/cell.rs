//! The cells of the [octree](super::octree) and of the quadtrees and binary trees on its boundary,
//! and the conclusions from bounds over one.

use crate::field::Enclosure;
use crate::math::Bounds;
use glam::DVec3;

/// Position of the cut, and of the probe in the footprint of a decided cell, as a share of the
/// side. It is not the middle, where symmetric surfaces have their highest points and cross
/// themselves.
pub(super) const CUT: f64 = 0.4709;

/// A cell of a stratum. A side has the length 0 where a face or an edge of the box fixes the
/// coordinate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    pub(super) bounds: Bounds,
    pub(super) level: u8,
}

/// The free axes of a stratum, by their roles in the search.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axes {
    /// Sides of the footprint; none where a face or an edge of the box fixes the coordinate.
    pub(super) sides: [Option<usize>; 2],
    pub(super) up: usize,
}

impl Cell {
    /// The point of the footprint at which a decided cell is probed along up.
    pub(super) fn probe(&self) -> DVec3 {
        self.bounds.lo() + CUT * self.bounds.size()
    }

    /// The axes of the stratum.
    pub(super) fn axes(&self) -> Axes {
        let free = |axis: usize| (self.bounds.min[axis] < self.bounds.max[axis]).then_some(axis);
        match [free(0), free(1), free(2)] {
            [x, y, Some(up)] => Axes { sides: [x, y], up },
            [x, Some(up), None] => Axes { sides: [x, None], up },
            [x, None, None] => Axes { sides: [None, None], up: x.unwrap_or(0) },
        }
    }
}

/// Adds the faces and edges of a box to the cells of a level.
pub(super) fn push_boundary(level: &mut Vec<Cell>, whole: &Bounds) {
    // Each axis free, or pinned to either end.
    for stratum in 1..27 {
        let Bounds { mut min, mut max } = *whole;
        let mut rest = stratum;
        for axis in 0..3 {
            match rest % 3 {
                1 => max[axis] = min[axis],
                2 => min[axis] = max[axis],
                _ => {}
            }
            rest /= 3;
        }
        // A corner belongs to three edges.
        if min != max {
            level.push(Cell { bounds: Bounds { min, max }, level: 0 });
        }
    }
}

/// Whether a cell lies in the interior of a box.
pub(super) fn is_inside(cell: &Cell, around: &Bounds) -> bool {
    around.holds_inside(&cell.bounds)
}

/// Whether a cell lies in a box that is left out of the search.
pub(super) fn is_left_out(cell: &Cell, isolated: &[Bounds]) -> bool {
    isolated.iter().any(|around| is_inside(cell, around))
}

/// Whether no highest point lies in a cell on which f is defined and continuous.
pub(super) fn is_discarded(cell: &Cell, known: &Enclosure) -> bool {
    !known.may_vanish
        || known.value.excludes_zero()
        || cell.axes().sides.into_iter().flatten().any(|side| known.gradient[side].excludes_zero())
}

/// The most by which a surface through a box rises or falls over its footprint, from bounds of the
/// gradient over the box: by the mean value theorem it is Σ max|∂f/∂side| · width / min|∂f/∂up|.
/// None if the surface may not be a graph over the footprint: where f jumps, is undefined, or is
/// not monotone along up. An axis along which the box has no width is no side.
pub(super) fn rise(bounds: &Bounds, up: usize, known: &Enclosure) -> Option<f64> {
    let least = known.gradient[up].away_from_zero()?;
    let size = bounds.size();
    let sides = (0..3).filter(|&axis| axis != up && size[axis] > 0.0);
    let rise: f64 = sides.map(|side| known.gradient[side].magnitude() / least * size[side]).sum();
    (known.defined && known.continuous && rise.is_finite()).then_some(rise)
}
