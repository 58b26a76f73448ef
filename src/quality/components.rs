//! Connected components of the surface, as shown by the points.

use super::gaps::LONG;
use super::points::MeasuredPoints;
use crate::math::{Forest, NONE};
use crate::slices::{MEDIUM, pause};

/// Returns the component of every point, in tree order, and the number of components. Component 0
/// has the most points; ties are in the order of the points as given.
///
/// Two points are on one component if a triangle joins them. If one of two natural neighbours is in
/// no triangle, they are on one component unless their distance is [`LONG`] at either. `welded` are
/// the triangles by vertices, which the patches share.
pub(super) async fn label(
    points: &MeasuredPoints,
    spacing: &[f32],
    mesh: &[[u32; 3]],
    welded: &[[u32; 3]],
) -> (Vec<u32>, usize) {
    let n = points.tree.len();
    let distance_sq = |i: usize, j: usize| points.tree.position[i].distance_squared(points.tree.position[j]);
    let mut forest = Forest::new(n);
    let mut is_used = vec![false; n];
    let mut join = |i: usize, j: usize| {
        let most = LONG * spacing[i].min(spacing[j]);
        if distance_sq(i, j) <= most * most {
            forest.join(i as u32, j as u32);
        }
    };
    // The vertex of each point; if bodies touch in the point, the vertex of one of them.
    let mut vertex: Vec<u32> = (0..n).map(|i| points.creases.first(i) as u32).collect();
    for (chunk, welded) in mesh.chunks(MEDIUM).zip(welded.chunks(MEDIUM)) {
        for (rows, &[a, b, c]) in chunk.iter().zip(welded) {
            for (&row, (i, j)) in rows.iter().zip([(a, b), (b, c), (c, a)]) {
                join(i as usize, j as usize);
                (vertex[row as usize], is_used[row as usize]) = (i, true);
            }
        }
        pause().await;
    }
    for i in (0..n).filter(|&i| !is_used[i]) {
        points.stars.of(i).for_each(|j| join(i, j));
    }
    // Particles on creases join the patches.
    (0..).zip(&vertex).for_each(|(i, &vertex)| forest.join(i, vertex));
    let root: Vec<u32> = (0..n as u32).map(|i| forest.find(i)).collect();

    // At the root of each component: the number of points, and the first of them in the order
    // given.
    let mut count = vec![0_u32; n];
    let mut first = vec![NONE; n];
    for (i, (&r, &origin)) in root.iter().zip(&points.tree.origin).enumerate() {
        count[r as usize] += u32::from(points.creases.is_first(i));
        first[r as usize] = first[r as usize].min(origin);
    }
    // The key decreases with the count, so the component with the most points is first.
    let key = |r: u32| u64::from(u32::MAX - count[r as usize]) << 32 | u64::from(first[r as usize]);
    let mut order: Vec<u64> = (0..n as u32).filter(|&r| count[r as usize] > 0).map(key).collect();
    order.sort_unstable();
    let label = |r: u32| order.partition_point(|&other| other < key(r)) as u32;
    let labels: Vec<u32> =
        (0..n as u32).map(|r| if count[r as usize] > 0 { label(r) } else { NONE }).collect();
    (root.iter().map(|&r| labels[r as usize]).collect(), order.len())
}
