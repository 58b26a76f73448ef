//! The rim of a surface: edges at which it is known to end, such as the creases around a patch.
//! Each of them becomes a side of a triangle on its left, and no triangle beyond remains.

use super::patch::{Gap, Patch, quarter_turns};
use crate::math::{NONE, sort_by_key, sort_pairs, tangent_frame};
use crate::slices::{MEDIUM, pause};
use glam::Vec3;

/// Edges with the surface on their left, seen from outside, by indices of a tree.
#[derive(Debug, Default)]
pub(super) struct Rim {
    /// The edges, sorted.
    edges: Vec<[u32; 2]>,
    /// The ways of the rim through its vertices, sorted: vertex, the one before it and the one
    /// after it, [`NONE`] at an end. A vertex where the rim meets itself has several.
    ways: Vec<[u32; 3]>,
}

impl Rim {
    /// The rim of points with normals.
    pub(super) fn new(mut edges: Vec<[u32; 2]>, position: &[Vec3], normal: &[Vec3]) -> Self {
        sort_pairs(&mut edges);
        edges.dedup();
        // The ends of the edges at each vertex: those that lead to it, and those that lead from it.
        let mut ends: Vec<[u32; 3]> = edges.iter().flat_map(|&[a, b]| [[a, NONE, b], [b, a, NONE]]).collect();
        sort_by_key(&mut ends, |end| end[2].into());
        sort_by_key(&mut ends, |end| u64::from(end[0]) << 32 | u64::from(end[1]));
        let mut ways = Vec::new();
        for at in ends.chunk_by(|one, other| one[0] == other[0]) {
            let v = at[0][0];
            let turns = AnglesAround::new(position, normal, v);
            let mut after: Vec<u32> = at.iter().map(|end| end[2]).filter(|&w| w != NONE).collect();
            for before in at.iter().map(|end| end[1]).filter(|&u| u != NONE) {
                // The sector beyond the rim runs counter-clockwise from the way in to the next way
                // out.
                let turn = |w: u32| turns.between(before, w);
                let next = (0..after.len()).min_by(|&k, &l| turn(after[k]).total_cmp(&turn(after[l])));
                ways.push([v, before, next.map_or(NONE, |k| after.swap_remove(k))]);
            }
            ways.extend(after.into_iter().map(|after| [v, NONE, after]));
        }
        Self { edges, ways }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.edges.is_empty()
    }

    /// Whether the way from `a` to `b` is an edge of the rim.
    pub(super) fn has(&self, a: u32, b: u32) -> bool {
        self.edges.binary_search(&[a, b]).is_ok()
    }

    /// The ways of the rim through a vertex.
    fn ways(&self, v: u32) -> &[[u32; 3]] {
        let start = self.ways.partition_point(|way| way[0] < v);
        let end = self.ways.partition_point(|way| way[0] <= v);
        &self.ways[start..end]
    }

    /// Whether a vertex lies on the rim.
    pub(super) fn holds(&self, v: u32) -> bool {
        !self.ways(v).is_empty()
    }

    /// Number of fans that a vertex may have: one, or one between every two ways of the rim that
    /// meet there.
    pub(super) fn fans(&self, v: u32) -> usize {
        self.ways(v).len().max(1)
    }

    /// Whether a loop around a hole, which lies on the left, has an edge of the rim and none of its
    /// ends: it is then no border of the surface, since the rim ends at a border.
    pub(super) fn is_along(&self, hole: &[u32]) -> bool {
        let is_end = |&v: &u32| self.ways(v).iter().any(|way| way[1..].contains(&NONE));
        (0..hole.len()).any(|k| self.has(hole[k], hole[(k + 1) % hole.len()])) && !hole.iter().any(is_end)
    }

    /// Removes the triangles across the edges of the rim and beyond it.
    pub(super) async fn clear(&self, patch: &mut Patch<'_>) {
        for (k, &[a, b]) in self.edges.iter().enumerate() {
            patch.list(a);
            patch.list(b);
            if !patch.has_edge(a, b) {
                clear_between(patch, a, b);
            }
            if k.is_multiple_of(MEDIUM) {
                pause().await;
            }
        }
        // There are no points beyond the rim, so that the triangles there have all their corners on
        // it.
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

    /// Removes the sectors beyond the rim from the gaps of a vertex, from number `first` on.
    pub(super) fn narrow(&self, patch: &Patch, v: u32, gaps: &mut Vec<Gap>, first: usize) {
        let ways = self.ways(v);
        let turns = AnglesAround::new(patch.position, patch.normal, v);
        if gaps.len() == first {
            // Without a triangle each sector on the left of the rim is a gap.
            for &[_, _, after] in ways.iter().filter(|way| way[2] != NONE) {
                let before = ways.iter().map(|way| way[1]).filter(|&before| before != NONE);
                let to_next = |u: &u32| turns.between(after, *u);
                if let Some(from) = before.min_by(|one, other| to_next(one).total_cmp(&to_next(other))) {
                    gaps.push(Gap { vertex: v, to: after, from });
                }
            }
            return;
        }
        for &[_, before, after] in ways {
            let is_beyond = |k: &usize| turns.is_beyond(gaps[*k], before, after);
            let Some(k) = (first..gaps.len()).find(is_beyond) else { continue };
            let Gap { to, from, .. } = gaps.remove(k);
            if before != NONE && to != before {
                gaps.push(Gap { vertex: v, to, from: before });
            }
            if after != NONE && from != after {
                gaps.push(Gap { vertex: v, to: after, from });
            }
        }
    }
}

/// Angles around a vertex, counter-clockwise seen from outside, in quarter turns.
struct AnglesAround<'a> {
    position: &'a [Vec3],
    centre: Vec3,
    frame: (Vec3, Vec3),
}

impl<'a> AnglesAround<'a> {
    fn new(position: &'a [Vec3], normal: &[Vec3], v: u32) -> Self {
        Self { position, centre: position[v as usize], frame: tangent_frame(normal[v as usize]) }
    }

    /// The angle from one vertex to another, in 0 … 4; 4 from a vertex to itself.
    fn between(&self, from: u32, to: u32) -> f32 {
        let [from, to] = [from, to].map(|v| {
            let offset = self.position[v as usize] - self.centre;
            quarter_turns(offset.dot(self.frame.0), offset.dot(self.frame.1))
        });
        let turn = to - from;
        if turn > 0.0 { turn } else { turn + 4.0 }
    }

    /// Whether a gap contains the sector beyond a way of the rim: counter-clockwise from the vertex
    /// `before` to the vertex `after`, of which one may be [`NONE`].
    fn is_beyond(&self, Gap { to, from, .. }: Gap, before: u32, after: u32) -> bool {
        if to == before || from == after {
            return true;
        }
        let end = self.between(to, from);
        let is_in = |w: u32| w == NONE || self.between(to, w) < end;
        let is_ordered =
            before == NONE || after == NONE || self.between(to, before) < self.between(to, after);
        is_in(before) && is_in(after) && is_ordered
    }
}

/// Removes the triangles that the edge from `a` to `b` crosses, seen along the normals there.
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
