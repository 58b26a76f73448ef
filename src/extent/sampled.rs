//! The box of a surface whose field has no useful bounds, by the signs of f on grids.

use super::grid::{CELLS, Changes, Counted, NODES, changes, layer_of};
use super::walk::{Walked, walk};
use super::{Extent, FALLBACK, HALVES, Reach, placeable};
use crate::field::{BATCH, Evaluator, Field, Frame};
use crate::math::Bounds;

/// The grid is laid again over what it found, with a margin of one cell, until that fills this
/// share of the grid: further grids would hardly be smaller.
const FULL: f64 = 0.6;
/// A larger grid must show the surface this many of its cells farther out than a smaller one to
/// count.
const NEAR: f64 = 2.1;

/// Finds the smallest cube through whose faces the surface does not pass, and its box in it. The
/// surface is endless if the grid of a larger cube shows more, or a thin part leads out of the
/// largest one.
pub(super) async fn find(field: &dyn Field) -> Extent {
    // In single precision rounding decides the sign far from the origin, where terms nearly cancel.
    let mut evaluator = field.evaluator(Frame { double: Some(1.0), ..Frame::default() });
    for counted in [Counted::Zeros, Counted::All] {
        if let Some(extent) = find_by(&mut *evaluator, counted).await {
            return extent;
        }
    }
    Extent { bounds: FALLBACK, reach: Reach::Unknown }
}

/// The extent that [`find`] finds by the changes of sign that are `counted`, if there are any.
async fn find_by(field: &mut dyn Evaluator, counted: Counted) -> Option<Extent> {
    let mut seen = None;
    let mut halves = HALVES.into_iter().rev();
    while let Some(half) = halves.next() {
        let cube = Bounds::cube(half);
        let Some(found) = changes(field, &cube, counted).await else { continue };
        if found.passes {
            seen.get_or_insert((cube, found));
            continue;
        }
        let extent = settle(field, cube, found, counted).await;
        for half in halves {
            let cube = Bounds::cube(half);
            // A larger grid reaches up to two cells farther, one of them its margin, or finds a
            // jump of f next to the surface that passes for a zero on it.
            let near = extent.bounds.enlarged(NEAR * cube.size().x / CELLS as f64);
            let all = changes(field, &cube, counted).await;
            if all.is_some_and(|all| near.joined(&all.hull) != near) {
                return Some(Extent { bounds: extent.with_room(|_| 0.0), reach: Reach::Endless });
            }
        }
        return Some(extent);
    }
    let (cube, found) = seen?;
    // Only thin parts may leave the cube, which the grids of larger cubes do not show.
    if let Walked::To(reached) = walk(field, &found, &cube).await {
        let over = cube.joined(&reached).enlarged(found.step.max_element());
        if let Some(found) = changes(field, &over, counted).await.filter(|found| !found.passes) {
            return Some(settle(field, over, found, counted).await);
        }
    }
    Some(Extent { bounds: cube, reach: Reach::Endless })
}

/// The extent of a surface that does not pass through the faces of the grid `over` a box.
async fn settle(field: &mut dyn Evaluator, mut over: Bounds, mut found: Changes, counted: Counted) -> Extent {
    // The surface is bounded: the grids shrink, down to a box in which particles have no room.
    while found.hull.size().max_element() < FULL * over.size().max_element() && found.hull.is_valid() {
        // The margin of one cell covers what the grid missed.
        over = found.hull;
        let Some(finer) = changes(field, &over, counted).await else { break };
        found = finer;
    }
    let extent = Extent { bounds: placeable(&found.hull), reach: Reach::Bounded };
    let roomy = extent.with_room(|_| 0.0);
    match walk(field, &found, &roomy).await {
        Walked::Inside => extent,
        Walked::To(reached) => Extent { bounds: placeable(&found.hull.joined(&reached)), ..extent },
        Walked::Away => Extent { bounds: roomy, reach: Reach::Endless },
    }
}

/// Share of the nodes of all grids at which f is defined.
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
