//! The rim of a surface: edges along which it is known to end, such as the creases around a patch. Each of them becomes a side of a
//! triangle on its left, and no triangle stays beyond.

use super::SLICE;
use super::patch::{Gap, NONE, Patch, quarter_turns};
use crate::math::tangent_frame;
use crate::slices::pause;

/// Edges with the surface on their left, seen from outside, in the numbers of a tree.
#[derive(Debug, Default)]
pub(super) struct Rim {
    /// The edges, sorted.
    edges: Vec<[u32; 2]>,
    /// The vertices before and after each vertex along the rim; none off the rim, at an end of it, and where it meets itself.
    previous: Vec<u32>,
    next: Vec<u32>,
}

impl Rim {
    /// The rim of `count` vertices.
    pub(super) fn new(mut edges: Vec<[u32; 2]>, count: usize) -> Self {
        if edges.is_empty() {
            return Self::default();
        }
        edges.sort_unstable();
        edges.dedup();
        let (mut previous, mut next) = (vec![NONE; count], vec![NONE; count]);
        let (mut ways_in, mut ways_out) = (vec![0_u32; count], vec![0_u32; count]);
        for &[a, b] in &edges {
            let (a, b) = (a as usize, b as usize);
            (next[a], previous[b]) = (b as u32, a as u32);
            (ways_out[a], ways_in[b]) = (ways_out[a] + 1, ways_in[b] + 1);
        }
        for v in (0..count).filter(|&v| ways_in[v].max(ways_out[v]) > 1) {
            (previous[v], next[v]) = (NONE, NONE);
        }
        Self { edges, previous, next }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.edges.is_empty()
    }

    /// Whether the way from `a` to `b` is an edge of the rim.
    pub(super) fn has(&self, a: u32, b: u32) -> bool {
        self.edges.binary_search(&[a, b]).is_ok()
    }

    /// Whether a vertex lies on the rim.
    pub(super) fn holds(&self, v: u32) -> bool {
        let at = |list: &[u32]| list.get(v as usize).is_some_and(|&other| other != NONE);
        at(&self.previous) || at(&self.next)
    }

    /// Whether a loop around a hole, which lies on the left, has an edge of the rim.
    pub(super) fn is_along(&self, hole: &[u32]) -> bool {
        (0..hole.len()).any(|k| self.has(hole[k], hole[(k + 1) % hole.len()]))
    }

    /// Clears the way for the edges of the rim, and removes the triangles beyond it.
    pub(super) async fn clear(&self, patch: &mut Patch<'_>) {
        for (k, &[a, b]) in self.edges.iter().enumerate() {
            patch.touch(a);
            patch.touch(b);
            if !patch.has_edge(a, b) {
                clear_between(patch, a, b);
            }
            if k % (SLICE / 16) == 0 {
                pause().await;
            }
        }
        // Nothing lies beyond the rim, so that the triangles there have all their corners on it.
        let mut beyond: Vec<u32> = self.edges.iter().filter_map(|&[a, b]| patch.with_side(b, a)).collect();
        while let Some(id) = beyond.pop() {
            if patch.is_removed(id) {
                continue;
            }
            let [a, b, c] = patch.triangle(id);
            patch.remove(id);
            for (a, b) in [(a, b), (b, c), (c, a)] {
                if !self.has(b, a)
                    && let Some(behind) = patch.with_side(b, a)
                    && patch.triangle(behind).iter().all(|&v| self.holds(v))
                {
                    beyond.push(behind);
                }
            }
        }
    }

    /// Takes what lies beyond the rim out of the gaps of a vertex, those from `first` on.
    pub(super) fn narrow(&self, patch: &Patch, v: u32, gaps: &mut Vec<Gap>, first: usize) {
        if !self.holds(v) {
            return;
        }
        let (before, after) = (self.previous[v as usize], self.next[v as usize]);
        if gaps.len() == first {
            // Without a triangle the whole sector on the left of the rim is a gap.
            if before != NONE && after != NONE {
                gaps.push(Gap { vertex: v, to: after, from: before });
            }
            return;
        }
        let Some(k) = (first..gaps.len()).find(|&k| is_beyond(patch, gaps[k], before, after)) else { return };
        let Gap { to, from, .. } = gaps.remove(k);
        if before != NONE && to != before {
            gaps.push(Gap { vertex: v, to, from: before });
        }
        if after != NONE && from != after {
            gaps.push(Gap { vertex: v, to: after, from });
        }
    }
}

/// Whether a gap holds the outside of the rim, counter-clockwise from the vertex `before` to the one `after`, of which one may be
/// none.
fn is_beyond(patch: &Patch, gap: Gap, before: u32, after: u32) -> bool {
    if gap.to == before || gap.from == after {
        return true;
    }
    let (x, y) = tangent_frame(patch.normal[gap.vertex as usize]);
    let angle = |w: u32| {
        let offset = patch.position[w as usize] - patch.position[gap.vertex as usize];
        quarter_turns(offset.dot(x), offset.dot(y))
    };
    let start = angle(gap.to);
    let turn = |w: u32| (angle(w) - start + 4.0) % 4.0;
    let end = turn(gap.from);
    // A lone fan without breadth starts where it ends: its gap is a whole turn.
    let end = if end == 0.0 { 4.0 } else { end };
    let is_in = |w: u32| w == NONE || turn(w) < end;
    let is_ordered = before == NONE || after == NONE || turn(before) < turn(after);
    is_in(before) && is_in(after) && is_ordered
}

/// Removes the triangles that the edge between `a` and `b` crosses, seen along the normals there.
fn clear_between(patch: &mut Patch, a: u32, b: u32) {
    let up = (patch.normal[a as usize] + patch.normal[b as usize]).as_dvec3().normalize_or_zero();
    let start = patch.place(a);
    let ahead = patch.place(b) - start;
    let length = ahead.length();
    let across = up.cross(ahead).normalize_or_zero();
    let along = ahead / length;
    let mut near: Vec<u32> = Vec::new();
    for v in [a, b] {
        near.extend(patch.around(v));
        for entry in patch.stars.range(v as usize) {
            near.extend(patch.around(patch.stars.neighbour(entry)));
        }
    }
    near.sort_unstable();
    near.dedup();
    near.retain(|&id| {
        let triangle = patch.triangle(id);
        let is_crossed = |p: u32, q: u32| {
            if [p, q].iter().any(|v| [a, b].contains(v)) {
                return false;
            }
            let [(s, t, h), (u, v, g)] = [p, q].map(|v| {
                let offset = patch.place(v) - start;
                (offset.dot(along), offset.dot(across), offset.dot(up))
            });
            let at = s + (u - s) * t / (t - v);
            t * v < 0.0 && 0.0 < at && at < length && h.abs().max(g.abs()) < length
        };
        let [p, q, r] = triangle;
        patch.area_vector(triangle).dot(up) > 0.0
            && (is_crossed(p, q) || is_crossed(q, r) || is_crossed(r, p))
    });
    near.into_iter().for_each(|id| patch.remove(id));
}
