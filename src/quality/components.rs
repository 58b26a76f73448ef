//! Which connected piece of the surface each point is on, as far as the points tell.

use super::Scene;
use super::triangles::find;
use crate::math::sort_few;
use crate::pieces::{piece, ranges};

/// Two points that a triangle joins, or natural neighbours one of which is in no triangle, are on one piece if they are nearer
/// than this many times the spacing at either: across the gaps that a clip box cuts, triangles join what is not.
const NEAR: f32 = 2.0;

/// Which of a point's natural neighbours, in the order of their distance, tells the spacing there, unless it is farther than
/// [`FARTHEST`] times the first.
const TELLING: usize = 3;
const FARTHEST: f32 = 3.0;

/// Points or triangles looked at in one piece of work.
const PIECE: usize = 512;

/// Label of a point that belongs to no piece: a non-finite position.
pub(super) const NO_LABEL: u32 = u32::MAX;

/// The piece of every point, in tree order: 0 for the one with most points, ties in the order of the points given; and the
/// number of pieces.
pub(super) async fn label(scene: &Scene, mesh: &[[u32; 3]]) -> (Vec<u32>, usize) {
    let n = scene.tree.len();
    let distance = |i: usize, j: usize| scene.tree.position[i].distance(scene.tree.position[j]);
    let mut lengths = Vec::new();
    let mut spacing = Vec::with_capacity(n);
    for range in ranges(n, PIECE) {
        spacing.extend(range.map(|i| {
            lengths.clear();
            lengths.extend(scene.fans.of(i).map(|j| distance(i, j)));
            sort_few(&mut lengths, |a, b| a < b);
            let nearest: f32 = lengths.first().copied().unwrap_or(0.0);
            lengths.get(TELLING - 1).map_or(nearest, |&third| third.min(FARTHEST * nearest))
        }));
        piece().await;
    }
    let mut root: Vec<u32> = (0..n as u32).collect();
    let mut is_used = vec![false; n];
    let mut join = |i: usize, j: usize| {
        if distance(i, j) <= NEAR * spacing[i].min(spacing[j]) {
            let (a, b) = (find(&mut root, i as u32), find(&mut root, j as u32));
            root[a.max(b) as usize] = a.min(b);
        }
    };
    for chunk in mesh.chunks(PIECE) {
        for triangle in chunk {
            let [a, b, c] = triangle.map(|i| i as usize);
            for (i, j) in [(a, b), (b, c), (c, a)] {
                join(i, j);
                is_used[i] = true;
            }
        }
        piece().await;
    }
    for i in (0..n).filter(|&i| !is_used[i]) {
        scene.fans.of(i).for_each(|j| join(i, j));
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
