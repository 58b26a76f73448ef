//! The box of a surface whose field has no useful bounds, by the signs of f on grids.

use super::{Extent, FALLBACK, HALVES, Reach, placeable};
use crate::field::{BATCH, Evaluator, Field, Frame};
use crate::math::Bounds;
use crate::slices::pause;
use glam::{DVec3, Vec3};

/// Cells along a side of a grid: as many as those of the survey.
pub(crate) const CELLS: usize = 32;
/// The grid is laid again over what it found, with a cell around it, until that fills this share of
/// it: further grids would hardly be smaller.
const FULL: f64 = 0.6;

/// Finds the smallest cube through whose faces the surface does not pass, and its box in it. The
/// surface goes on if the grid of a larger cube shows more.
pub(super) async fn find(field: &dyn Field) -> Extent {
    // In single precision rounding decides the sign far from the origin, where terms nearly cancel.
    let mut evaluator = field.evaluator(Frame { double: Some(1.0), ..Frame::default() });
    let field = &mut *evaluator;
    let mut seen = None;
    let mut halves = HALVES.into_iter().rev();
    while let Some(half) = halves.next() {
        let cube = Bounds::cube(half);
        let Some((mut hull, passes)) = changes(field, &cube).await else { continue };
        seen = seen.or(Some(half));
        if passes {
            continue;
        }
        let mut over = cube;
        // It ends: the grids shrink, down to a box in which particles have no room.
        while hull.size().max_element() < FULL * over.size().max_element() && hull.is_valid() {
            // A cell of the grid around what it found is room for what it missed.
            over = hull;
            let Some((finer, _)) = changes(field, &over).await else { break };
            hull = finer;
        }
        let extent = Extent { bounds: placeable(&hull), reach: Reach::Bounded };
        for half in halves {
            let cube = Bounds::cube(half);
            // What a grid finds is less than two cells away, of which one is room.
            let near = hull.enlarged(2.0 * cube.size().x / CELLS as f64);
            if changes(field, &cube).await.is_some_and(|(all, _)| near.joined(&all) != near) {
                return Extent { bounds: extent.with_room(|_| 0.0), reach: Reach::Endless };
            }
        }
        return extent;
    }
    match seen {
        Some(half) => Extent { bounds: Bounds::cube(half), reach: Reach::Endless },
        None => Extent { bounds: FALLBACK, reach: Reach::Unknown },
    }
}

/// Share of the nodes of all grids at which f has a value.
pub(crate) fn defined_share(field: &mut dyn Evaluator) -> f64 {
    let mut values = [0.0; BATCH];
    let (mut defined, mut nodes) = (0, 0);
    for (half, k) in HALVES.into_iter().flat_map(|half| (0..NODES).map(move |k| (half, k))) {
        let points = layer_of(&Bounds::cube(half), k);
        for points in points.chunks(BATCH) {
            field.values(points, &mut values);
            defined += values[..points.len()].iter().filter(|value| value.is_finite()).count();
        }
        nodes += points.len();
    }
    defined as f64 / nodes as f64
}

/// Nodes along a side of a grid.
const NODES: usize = CELLS + 1;

/// The nodes of layer number `k` of the grid over a box.
fn layer_of(over: &Bounds, k: usize) -> Vec<Vec3> {
    let (lo, step) = (over.lo(), over.size() / CELLS as f64);
    let node = |m: usize| lo + step * DVec3::new((m % NODES) as f64, (m / NODES) as f64, k as f64);
    (0..NODES * NODES).map(|m| node(m).as_vec3()).collect()
}

/// The box of the cells at whose corners f changes its sign, with a cell of room, and whether one
/// of them lies at the faces.
async fn changes(field: &mut dyn Evaluator, over: &Bounds) -> Option<(Bounds, bool)> {
    let (lo, step) = (over.lo(), over.size() / CELLS as f64);
    let mut below = vec![f32::NAN; NODES * NODES];
    let mut layer = below.clone();
    let (mut first, mut last) = ([usize::MAX; 3], [0; 3]);
    for k in 0..NODES {
        field.values(&layer_of(over, k), &mut layer);
        for m in 0..NODES * NODES {
            let before = [
                (m % NODES > 0).then(|| layer[m - 1]),
                (m / NODES > 0).then(|| layer[m - NODES]),
                (k > 0).then_some(below[m]),
            ];
            let value = layer[m];
            if before
                .into_iter()
                .flatten()
                .any(|other| value < 0.0 && other >= 0.0 || value >= 0.0 && other < 0.0)
            {
                for (axis, at) in [m % NODES, m / NODES, k].into_iter().enumerate() {
                    first[axis] = first[axis].min(at.saturating_sub(1));
                    last[axis] = last[axis].max(at);
                }
            }
        }
        core::mem::swap(&mut below, &mut layer);
        pause().await;
    }
    let passes = first.contains(&0) || last.contains(&CELLS);
    let at = |node: [usize; 3], room: f64| {
        DVec3::from_array(core::array::from_fn(|axis| lo[axis] + step[axis] * (node[axis] as f64 + room)))
    };
    (first[0] != usize::MAX).then(|| (Bounds::new(at(first, -1.0), at(last, 1.0)), passes))
}
