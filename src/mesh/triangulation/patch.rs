//! The triangles on which stars agree, and local changes to them.

use crate::math::{NONE, sort_few, tangent_frame};
use crate::mesh::stars::Stars;
use crate::slices::{LIGHT, MEDIUM, pause, ranges};
use glam::{DVec3, Vec3};

/// A triangle that has been removed.
const REMOVED: [u32; 3] = [NONE; 3];

/// Triangles that can be added and removed. Before any change the triangles of a vertex are found
/// through its star; a vertex where something changes gets its own list.
pub(super) struct Patch<'a> {
    pub(super) position: &'a [Vec3],
    pub(super) normal: &'a [Vec3],
    pub(super) stars: &'a Stars,
    triangles: Vec<[u32; 3]>,
    /// The triangle of each entry of a star with the next entry.
    of_entry: Vec<u32>,
    /// Number of the list of each vertex that has its own.
    list_of: Vec<u32>,
    lists: Vec<Vec<u32>>,
    /// The vertices with lists, in the order of the lists.
    changed: Vec<u32>,
}

/// The gap that follows a fan of a vertex, counter-clockwise round the normal.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gap {
    pub(super) vertex: u32,
    /// The last vertex of the fan before the gap: it follows `vertex` along the hole, which lies on
    /// the left.
    pub(super) to: u32,
    /// The first vertex of the fan after the gap: `vertex` follows it along the hole.
    pub(super) from: u32,
}

impl<'a> Patch<'a> {
    /// The triangles that all their three corners see. No directed edge belongs to two of them, and
    /// each is counter-clockwise in the tangent planes of its corners.
    pub(super) async fn new(position: &'a [Vec3], normal: &'a [Vec3], stars: &'a Stars) -> Self {
        let mut patch = Self {
            position,
            normal,
            stars,
            triangles: Vec::with_capacity(2 * stars.len()),
            of_entry: vec![NONE; stars.entry_count()],
            list_of: vec![NONE; stars.len()],
            lists: Vec::new(),
            changed: Vec::new(),
        };
        for range in ranges(stars.len(), MEDIUM) {
            for i in range.start as u32..range.end as u32 {
                patch.add_agreed(i);
            }
            pause().await;
        }
        for range in ranges(stars.len(), LIGHT) {
            for i in range {
                if patch.of_entry[stars.range(i)].contains(&NONE) {
                    patch.list(i as u32);
                }
            }
            pause().await;
        }
        patch
    }

    /// Adds the triangles of `i` with later vertices that all three see.
    fn add_agreed(&mut self, i: u32) {
        let stars = self.stars;
        let range = stars.range(i as usize);
        for entry in range.clone() {
            let a = stars.neighbour(entry);
            if i < a
                && let Some(b) = stars.next(&range, entry).filter(|&b| i < b)
                && let Some(at_a) = stars.entry(a, b, i)
                && let Some(at_b) = stars.entry(b, i, a)
            {
                let id = self.triangles.len() as u32;
                self.triangles.push([i, a, b]);
                for entry in [entry, at_a, at_b] {
                    self.of_entry[entry] = id;
                }
            }
        }
    }

    /// The triangles.
    pub(super) fn triangles(&self) -> impl Iterator<Item = [u32; 3]> {
        self.triangles.iter().copied().filter(|&triangle| triangle != REMOVED)
    }

    /// The vertices that have had a gap or a change so far.
    pub(super) fn changed(&self) -> &[u32] {
        &self.changed
    }

    /// The triangles of `v`, by number.
    pub(super) fn around(&self, v: u32) -> impl Iterator<Item = u32> + Clone {
        let own = self.lists.get(self.list_of[v as usize] as usize);
        let entries = if own.is_some() { 0..0 } else { self.stars.range(v as usize) };
        let of_star = self.of_entry[entries].iter().filter(|&&id| id != NONE);
        own.into_iter().flatten().chain(of_star).copied()
    }

    /// The triangle with a number, which has not been removed.
    pub(super) fn triangle(&self, id: u32) -> [u32; 3] {
        self.triangles[id as usize]
    }

    /// The vertices before and after `v` in each of its triangles.
    pub(super) fn corners(&self, v: u32) -> impl Iterator<Item = (u32, u32)> + Clone {
        self.around(v).map(move |id| {
            let [a, b, c] = self.triangle(id);
            if a == v {
                (b, c)
            } else if b == v {
                (c, a)
            } else {
                (a, b)
            }
        })
    }

    /// Whether a triangle has the edge between `a` and `b`.
    pub(super) fn has_edge(&self, a: u32, b: u32) -> bool {
        self.corners(a).any(|(next, previous)| next == b || previous == b)
    }

    /// The number of the own list of `v`: its place in [`Patch::changed`].
    pub(super) fn list_number(&self, v: u32) -> Option<usize> {
        Some(self.list_of[v as usize]).filter(|&list| list != NONE).map(|list| list as usize)
    }

    /// The triangle with the directed edge from `a` to `b`.
    pub(super) fn with_side(&self, a: u32, b: u32) -> Option<u32> {
        self.around(a).zip(self.corners(a)).find(|&(_, (next, _))| next == b).map(|(id, _)| id)
    }

    /// The corner of a triangle other than `a` and `b`.
    pub(super) fn opposite(&self, id: u32, a: u32, b: u32) -> u32 {
        let [i, j, k] = self.triangle(id);
        if i != a && i != b {
            i
        } else if j != a && j != b {
            j
        } else {
            k
        }
    }

    /// The triangles of `v`, fan by fan.
    pub(super) fn fans(&self, v: u32) -> Vec<Vec<u32>> {
        let mut open: Vec<(u32, (u32, u32))> = self.around(v).zip(self.corners(v)).collect();
        let mut fans = Vec::new();
        while let Some((id, (mut first, mut last))) = open.pop() {
            let mut fan = vec![id];
            while let Some(k) =
                open.iter().position(|&(_, (next, previous))| next == last || previous == first)
            {
                let (id, (next, previous)) = open.swap_remove(k);
                fan.push(id);
                if next == last {
                    last = previous;
                } else {
                    first = next;
                }
            }
            fans.push(fan);
        }
        fans
    }

    /// Whether the triangle with a number has been removed.
    pub(super) fn is_removed(&self, id: u32) -> bool {
        self.triangles[id as usize] == REMOVED
    }

    /// The own list of `v`, which is made if necessary; `v` then takes part in the search for
    /// holes.
    pub(super) fn list(&mut self, v: u32) -> &mut Vec<u32> {
        if self.list_of[v as usize] == NONE {
            let list = self.around(v).collect();
            self.list_of[v as usize] = self.lists.len() as u32;
            self.lists.push(list);
            self.changed.push(v);
        }
        &mut self.lists[self.list_of[v as usize] as usize]
    }

    /// Adds a triangle.
    pub(super) fn add(&mut self, triangle: [u32; 3]) {
        let id = self.triangles.len() as u32;
        self.triangles.push(triangle);
        for v in triangle {
            self.list(v).push(id);
        }
    }

    /// Removes a triangle.
    pub(super) fn remove(&mut self, id: u32) {
        for v in self.triangle(id) {
            self.list(v).retain(|&other| other != id);
        }
        self.triangles[id as usize] = REMOVED;
    }

    /// Removes all triangles of a vertex.
    pub(super) fn clear(&mut self, v: u32) {
        let ids: Vec<u32> = self.around(v).collect();
        ids.into_iter().for_each(|id| self.remove(id));
    }

    /// Appends the gaps of `v` to `gaps`.
    pub(super) fn gaps(&self, v: u32, gaps: &mut Vec<Gap>) {
        let first_gap = gaps.len();
        let corners = self.corners(v);
        for (first, _) in corners.clone() {
            if corners.clone().any(|(_, previous)| previous == first) {
                continue;
            }
            // A fan starts here and is followed to its end. If two triangles lie on one side of an
            // edge, a fan may lead back into itself.
            let mut last = first;
            for _ in corners.clone() {
                let Some((_, previous)) = corners.clone().find(|&(next, _)| next == last) else { break };
                last = previous;
            }
            gaps.push(Gap { vertex: v, to: last, from: first });
        }
        let gaps = &mut gaps[first_gap..];
        if gaps.len() > 1 {
            // The fans in the order of the angles of their first vertices.
            let (x, y) = tangent_frame(self.normal[v as usize]);
            let centre = self.position[v as usize];
            let angle = |gap: &Gap| {
                let offset = self.position[gap.from as usize] - centre;
                quarter_turns(offset.dot(x), offset.dot(y))
            };
            sort_few(gaps, |a, b| angle(a).total_cmp(&angle(b)).then(a.from.cmp(&b.from)).is_lt());
            // Each gap ends where the next fan begins.
            let starts: Vec<u32> = gaps.iter().map(|gap| gap.from).collect();
            for (k, gap) in gaps.iter_mut().enumerate() {
                gap.from = starts[(k + 1) % starts.len()];
            }
        }
    }

    /// Mean distance of the natural neighbours of `v`; 0 if it has none.
    pub(super) fn spacing(&self, v: u32) -> f64 {
        let range = self.stars.range(v as usize);
        let count = range.len().max(1) as f64;
        range.map(|entry| self.place(v).distance(self.place(self.stars.neighbour(entry)))).sum::<f64>()
            / count
    }

    /// Position in double precision.
    pub(super) fn place(&self, v: u32) -> DVec3 {
        self.position[v as usize].as_dvec3()
    }

    /// Twice the area vector of a triangle.
    pub(super) fn area_vector(&self, [a, b, c]: [u32; 3]) -> DVec3 {
        let origin = self.place(a);
        (self.place(b) - origin).cross(self.place(c) - origin)
    }

    /// Cosines of the angles between the normal of a triangle and those at its corners: the least
    /// one, and that for the mean of the three. Both −1 for a triangle without a normal.
    pub(super) fn agreement(&self, triangle: [u32; 3]) -> (f64, f64) {
        let corners = triangle.map(|v| self.normal[v as usize].as_dvec3());
        let mean = (corners[0] + corners[1] + corners[2]).try_normalize();
        let (Some(normal), Some(mean)) = (self.area_vector(triangle).try_normalize(), mean) else {
            return (-1.0, -1.0);
        };
        (corners.into_iter().map(|corner| normal.dot(corner)).fold(1.0, f64::min), normal.dot(mean))
    }
}

/// A number in 0 … 4 that grows with the angle of (x, y) from the x axis, one for each quarter
/// turn.
pub(super) fn quarter_turns(x: f32, y: f32) -> f32 {
    let size = x.abs() + y.abs();
    let share = if size > 0.0 { y / size } else { 0.0 };
    if x < 0.0 {
        2.0 - share
    } else if y < 0.0 {
        4.0 + share
    } else {
        share
    }
}

/// Calls `work` with the patch of these triangles over points with the normals of the plane z = 0,
/// with the points' tree, and with the number of each point there.
#[cfg(test)]
pub(super) fn with_plane<T>(
    points: &[Vec3],
    triangles: &[[u32; 3]],
    work: impl FnOnce(&mut Patch, &crate::spatial::tree::Tree, &[u32]) -> T,
) -> T {
    use crate::mesh::stars::{ByDirection, StarPoints};
    use crate::{slices, spatial::tree::Tree};
    let tree = Tree::new(points);
    let normal = vec![Vec3::Z; points.len()];
    let of_tree = StarPoints { tree: &tree, normal: &normal, tips: &[], patch: None };
    let stars = slices::complete(Stars::new(&of_tree, &ByDirection));
    let mut patch = slices::complete(Patch::new(&tree.position, &normal, &stars));
    let mut in_tree: Vec<u32> = (0..points.len() as u32).collect();
    in_tree.iter().for_each(|&v| patch.clear(v));
    in_tree.sort_by_key(|&v| tree.origin[v as usize]);
    triangles.iter().for_each(|triangle| patch.add(triangle.map(|v| in_tree[v as usize])));
    work(&mut patch, &tree, &in_tree)
}
