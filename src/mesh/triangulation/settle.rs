//! Triangles on which only some stars agree: four points near a circle may each prefer another
//! diagonal, since each sees the others in its own tangent plane. On a lattice this happens
//! everywhere.

use super::holes;
use super::patch::Patch;
use super::rim::Rim;
use crate::slices::{MEDIUM, pause};

/// Adds the triangles that fewer than three corners see, if their directed edges are free: those
/// that two corners see before those that one sees, and short edges first.
pub(super) async fn settle(patch: &mut Patch<'_>) {
    for (k, dispute) in disputed(patch).await.into_iter().enumerate() {
        if k % MEDIUM == MEDIUM - 1 {
            pause().await;
        }
        let [a, b, c] = [64, 32, 0].map(|shift| (dispute >> shift) as u32);
        let is_free = [(a, b), (b, c), (c, a)].iter().all(|&(a, b)| patch.with_side(a, b).is_none());
        if is_free && patch.agreement([a, b, c]).1 > 0.0 {
            patch.add([a, b, c]);
        }
    }
    holes::unpinch(patch, &Rim::default());
}

/// Triangles that only one or two corners see, in the order in which they are tried. From the top
/// bit on, a key holds whether it is only one, the square of the longest side, and the corners with
/// 32 bits each.
async fn disputed(patch: &Patch<'_>) -> Vec<u128> {
    let stars = patch.stars;
    let mut triangles = Vec::new();
    for (k, &i) in patch.changed().iter().enumerate() {
        if k % MEDIUM == MEDIUM - 1 {
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
                let by_one = u32::from(!seen_by_a && !seen_by_b) << 31;
                let words = [by_one | longest.to_bits(), i, a, b];
                triangles.push(words.iter().fold(0, |key, &word| key << 32 | u128::from(word)));
            }
        }
    }
    triangles.sort_unstable();
    triangles
}
