//! Triangles on which only some of the stars agree: four points near a circle may each prefer another diagonal, since each sees
//! the others in its own tangent plane. On a lattice they do so everywhere.

use super::patch::Patch;
use super::{SLICE, holes};
use crate::slices::pause;

/// Adds the triangles that fewer than three corners see, where their directed edges are free: those that two corners see before
/// those that one sees, the ones with short edges first.
pub(super) async fn settle(patch: &mut Patch<'_>) {
    for (k, (_, _, [a, b, c])) in disputed(patch).await.into_iter().enumerate() {
        if k % SLICE == SLICE - 1 {
            pause().await;
        }
        let is_free = [(a, b), (b, c), (c, a)].iter().all(|&(a, b)| patch.with_side(a, b).is_none());
        if is_free && patch.agreement([a, b, c]).1 > 0.0 {
            patch.add([a, b, c]);
        }
    }
    holes::unpinch(patch);
}

/// Triangles that one corner sees or two, in the order in which they are tried: whether it is only one, the square of the
/// longest side, the corners.
async fn disputed(patch: &Patch<'_>) -> Vec<(bool, f32, [u32; 3])> {
    let stars = patch.stars;
    let mut triangles = Vec::new();
    for (k, &i) in patch.changed().iter().enumerate() {
        if k % SLICE == SLICE - 1 {
            pause().await;
        }
        let range = stars.range(i as usize);
        for entry in range.clone() {
            let a = stars.neighbour(entry);
            let Some(b) = stars.next(&range, entry) else { continue };
            let [seen_by_a, seen_by_b] = [stars.entry(a, b, i), stars.entry(b, i, a)].map(|at| at.is_some());
            // It is counted at the smallest corner that sees it.
            if !(seen_by_a && (seen_by_b || a < i) || seen_by_b && b < i) {
                let [p, q, r] = [i, a, b].map(|v| patch.position[v as usize]);
                let longest = p.distance_squared(q).max(q.distance_squared(r)).max(r.distance_squared(p));
                triangles.push((!seen_by_a && !seen_by_b, longest, [i, a, b]));
            }
        }
    }
    triangles.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
    triangles
}
