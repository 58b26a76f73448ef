//! Which connected piece of the surface each point is on, as far as the points tell.

use super::triangles::find;
use super::{Scene, Sizes};

/// A point in no triangle belongs to the piece of a natural neighbour nearer than this many d_hex, or, where the radii are
/// known, nearer than this many times the sum of the two.
const NEAR: f64 = 2.0;

/// Label of a point that belongs to no piece: a non-finite position.
pub(super) const NO_LABEL: u32 = u32::MAX;

/// The piece of every point, in tree order: 0 for the one with most points, ties in the order of the points given; and the
/// number of pieces.
///
/// Points joined by a triangle are on one piece; `root` names one point for each set of points so joined. A point in no
/// triangle joins its natural neighbours if they are near, and is a piece of its own if none is.
pub(super) fn label(scene: &Scene, mut root: Vec<u32>, sizes: Sizes, d_hex: f64) -> (Vec<u32>, usize) {
    let n = scene.tree.len();
    let mut size = vec![0_u32; n];
    root.iter().for_each(|&r| size[r as usize] += 1);
    let radius = |k: usize| match sizes {
        Sizes::Given(given) => given.get(scene.tree.origin[k] as usize).map(|&r| f64::from(r)),
        _ => None,
    };
    let alone: Vec<usize> = (0..n).filter(|&i| size[root[i] as usize] == 1).collect();
    for i in alone {
        for j in scene.fans.of(i) {
            let reach = match (radius(i), radius(j)) {
                (Some(a), Some(b)) => NEAR * (a + b),
                _ => NEAR * d_hex,
            };
            if f64::from(scene.tree.position[i].distance(scene.tree.position[j])) < reach {
                let (a, b) = (find(&mut root, i as u32), find(&mut root, j as u32));
                root[a.max(b) as usize] = a.min(b);
            }
        }
    }
    let root: Vec<u32> = (0..n as u32).map(|i| find(&mut root, i)).collect();

    // Per piece, at its root: how many points, and the first of them in the order given.
    let mut count = vec![0_u32; n];
    let mut first = vec![u32::MAX; n];
    for (&r, &origin) in root.iter().zip(&scene.tree.origin) {
        count[r as usize] += 1;
        first[r as usize] = first[r as usize].min(origin);
    }
    // Most points first: the key falls with the count.
    let key = |r: u32| u64::from(u32::MAX - count[r as usize]) << 32 | u64::from(first[r as usize]);
    let mut order: Vec<u64> = (0..n as u32).filter(|&r| count[r as usize] > 0).map(key).collect();
    order.sort_unstable();
    let label = |r: u32| order.partition_point(|&other| other < key(r)) as u32;
    let labels: Vec<u32> =
        (0..n as u32).map(|r| if count[r as usize] > 0 { label(r) } else { NO_LABEL }).collect();
    (root.iter().map(|&r| labels[r as usize]).collect(), order.len())
}
