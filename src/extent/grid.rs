//! The grids on which the surface of a field without useful bounds is searched for: changes of the
//! sign of f between their nodes, and which of them are zeros.

use crate::field::Evaluator;
use crate::math::Bounds;
use crate::slices::pause;
use glam::{DVec3, Vec3};

/// Cells along a side of a grid, as in the survey.
pub(crate) const CELLS: usize = 32;
/// Where |f| is less than this share of its values at the ends of an edge, f reaches zero there; at
/// a jump it stays as large, and at a pole it grows. Smaller: roots of a high order are missed.
const ZERO_SHARE: f64 = 1.0 / 16.0;
/// At a zero |f| is also less than this share of its values at the ends of a [short part](NEAR) of
/// the edge. A jump next to a surface that is smaller than a cell fails this: f is far smaller
/// there than at the ends of the edge, but no smaller than next to the jump.
const NEAR_SHARE: f64 = 0.5;
/// Number of divisions of an edge that lead to the short part, 1/64 of the edge. Fewer: f may halve
/// on the way to a jump. More: rounding errors of terms that nearly cancel may be as large as f in
/// a part that small.
const NEAR: u32 = 2;

/// Parts into which an edge is divided at a time.
const PARTS: usize = 8;
/// Edges that are divided together.
const TOGETHER: usize = 8;

/// Changes of sign that count as the surface.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Counted {
    /// Those at which f reaches zero.
    Zeros,
    /// Jumps and poles, too.
    All,
}

/// Nodes along a side of a grid.
pub(super) const NODES: usize = CELLS + 1;

/// The nodes of layer number `k` of the grid over a box.
pub(super) fn layer_of(over: &Bounds, k: usize) -> Vec<Vec3> {
    let (lo, step) = (over.lo(), over.size() / CELLS as f64);
    let node = |m: usize| lo + step * DVec3::new((m % NODES) as f64, (m / NODES) as f64, k as f64);
    (0..NODES * NODES).map(|m| node(m).as_vec3()).collect()
}

/// A change of the sign of f between a node and the one before it along an axis.
#[derive(Clone, Copy)]
pub(super) struct Change {
    /// The node: its numbers along the axes.
    pub(super) node: [usize; 3],
    /// Both ends, and the value of f there.
    ends: [(Vec3, f32); 2],
}

impl Change {
    /// Where f would be zero if it were linear.
    pub(super) fn place(&self) -> Vec3 {
        let [(a, f), (b, g)] = self.ends;
        a + (b - a) * (f / (f - g))
    }
}

/// The surface as a grid shows it.
pub(super) struct Changes {
    /// The changes of sign, in the order of the nodes.
    pub(super) list: Vec<Change>,
    /// The box of their cells, with a margin of one cell.
    pub(super) hull: Bounds,
    /// Whether one of them lies at the faces of the grid.
    pub(super) passes: bool,
    /// Size of a cell.
    pub(super) step: DVec3,
}

/// The changes of the sign of f between neighbouring nodes of a grid. On every side, the outermost
/// changes are `counted` ones.
pub(super) async fn changes(field: &mut dyn Evaluator, over: &Bounds, counted: Counted) -> Option<Changes> {
    let (lo, step) = (over.lo(), over.size() / CELLS as f64);
    let mut below = (vec![Vec3::NAN; NODES * NODES], vec![f32::NAN; NODES * NODES]);
    let mut layer = below.clone();
    let mut list = Vec::new();
    for k in 0..NODES {
        layer.0 = layer_of(over, k);
        field.values(&layer.0, &mut layer.1);
        for m in 0..NODES * NODES {
            let own = |m: usize| (layer.0[m], layer.1[m]);
            let before = [
                (m % NODES > 0).then(|| own(m - 1)),
                (m / NODES > 0).then(|| own(m - NODES)),
                (k > 0).then(|| (below.0[m], below.1[m])),
            ];
            let here = own(m);
            let differs = |f: f32, g: f32| f < 0.0 && g >= 0.0 || f >= 0.0 && g < 0.0;
            let ends = before.into_iter().flatten().filter(|other| differs(here.1, other.1));
            list.extend(ends.map(|other| Change { node: [m % NODES, m / NODES, k], ends: [other, here] }));
        }
        core::mem::swap(&mut below, &mut layer);
        pause().await;
    }
    if counted == Counted::Zeros {
        for side in 0..6 {
            drop_jumps_at(field, &mut list, side);
            pause().await;
        }
    }
    let (mut first, mut last) = ([usize::MAX; 3], [0; 3]);
    for change in &list {
        for (axis, at) in change.node.into_iter().enumerate() {
            first[axis] = first[axis].min(at.saturating_sub(1));
            last[axis] = last[axis].max(at);
        }
    }
    if list.is_empty() {
        return None;
    }
    let at = |node: [usize; 3], room: f64| {
        DVec3::from_array(core::array::from_fn(|axis| lo[axis] + step[axis] * (node[axis] as f64 + room)))
    };
    let hull = Bounds::new(at(first, -1.0), at(last, 1.0));
    Some(Changes { list, hull, passes: first.contains(&0) || last.contains(&CELLS), step })
}

/// Drops the layers of changes at a side of the grid in which f nowhere reaches zero.
fn drop_jumps_at(field: &mut dyn Evaluator, list: &mut Vec<Change>, side: usize) {
    let at = |change: &Change| change.node[side / 2];
    let outermost = |list: &[Change]| {
        let all = list.iter().map(at);
        if side.is_multiple_of(2) { all.min() } else { all.max() }
    };
    while let Some(layer) = outermost(list) {
        let outer: Vec<Change> = list.iter().filter(|change| at(change) == layer).copied().collect();
        if outer.chunks(TOGETHER).any(|changes| has_zero(field, changes)) {
            return;
        }
        list.retain(|change| at(change) != layer);
    }
}

/// Whether f reaches zero at one of these changes of sign: a part of each edge in which the sign
/// changes is divided into [`PARTS`], until single precision divides it no further.
fn has_zero(field: &mut dyn Evaluator, changes: &[Change]) -> bool {
    const BETWEEN: usize = PARTS - 1;
    let mut ends: Vec<[(Vec3, f32); 2]> = changes.iter().map(|change| change.ends).collect();
    let mut values = [0.0; BETWEEN * TOGETHER];
    let mut near = Vec::new();
    for division in 0..f32::MANTISSA_DIGITS / PARTS.ilog2() {
        if division == NEAR {
            near.clone_from(&ends);
        }
        let between = |[(a, _), (b, _)]: &[(Vec3, f32); 2]| {
            let (a, way) = (*a, (*b - *a) / PARTS as f32);
            (1..PARTS).map(move |k| a + way * k as f32)
        };
        let places: Vec<Vec3> = ends.iter().flat_map(between).collect();
        field.values(&places, &mut values[..places.len()]);
        for (k, ends) in ends.iter_mut().enumerate() {
            let own = (BETWEEN * k..BETWEEN * (k + 1)).map(|at| (places[at], values[at]));
            let [first, last] = *ends;
            let mut before = first;
            for next in own.chain([last]) {
                if (next.1 < 0.0) != (first.1 < 0.0) {
                    *ends = [before, next];
                    break;
                }
                before = next;
            }
        }
    }
    // The values are arsinh f. At a pole they may be infinite; at a jump f may happen to be 0.
    let size = |value: f32| libm::sinh(value.abs().into());
    let largest = |ends: &[(Vec3, f32); 2]| {
        let sizes = ends.map(|(_, value)| size(value)).into_iter().filter(|size| size.is_finite());
        sizes.fold(0.0, f64::max)
    };
    changes.iter().zip(&near).zip(&ends).any(|((change, near), [a, b])| {
        let last = size(a.1).max(size(b.1));
        last <= ZERO_SHARE * largest(&change.ends) && last <= NEAR_SHARE * largest(near)
    })
}
