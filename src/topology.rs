//! Components, borders and Euler number of a list of triangles, counted from the list alone.

use crate::math::{Forest, NONE};
use crate::slices::{self, LIGHT, MEDIUM, pause};
use core::ops::Range;

/// A connected part of a mesh: vertices that edges join.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Component {
    /// Number of vertices.
    pub vertices: u32,
    /// Number of edges, border edges included.
    pub edges: u32,
    /// Number of triangles.
    pub triangles: u32,
    /// Number of edges with one triangle.
    pub border_edges: u32,
}

impl Component {
    /// Euler number: vertices − edges + triangles. It is 2 − 2g for a closed oriented surface of
    /// genus g, and one less for each border loop.
    #[must_use]
    pub fn euler(&self) -> i64 {
        i64::from(self.vertices) - i64::from(self.edges) + i64::from(self.triangles)
    }
}

/// The connectivity of a list of triangles.
///
/// The triangles form an oriented manifold, closed or with border, if [`Topology::is_manifold`]
/// says so.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Topology {
    /// Connected components in the order of their first vertices. Vertices without a triangle
    /// belong to none.
    pub components: Vec<Component>,
    /// Border loops: vertices in order, the mesh on the left. A loop that meets a vertex with
    /// several fans ends there.
    pub borders: Vec<Vec<u32>>,
    /// Directed edges that belong to more than one triangle: two triangles there have opposite
    /// orientations, or there are more than two.
    pub crowded_edges: Vec<[u32; 2]>,
    /// Vertices whose triangles form more than one fan.
    pub pinched_vertices: Vec<u32>,
    /// Edges of one triangle alone, the smaller end first.
    pub(crate) lone_edges: Vec<[u32; 2]>,
    /// The component of each vertex; [`NONE`] for one without a triangle.
    pub(crate) component_of: Vec<u32>,
}

/// The corners of all triangles, sorted by their vertex.
struct Corners {
    /// Corners of vertex `v`: `start[v]..start[v + 1]`.
    start: Vec<u32>,
    /// The vertices after and before `v` in the corner's triangle.
    ends: Vec<[u32; 2]>,
}

impl Corners {
    async fn new(triangles: &[[u32; 3]], vertex_count: usize) -> Self {
        let mut start = vec![0_u32; vertex_count + 2];
        for slice in triangles.chunks(LIGHT) {
            for &v in slice.iter().flatten() {
                start[v as usize + 2] += 1;
            }
            pause().await;
        }
        for v in 2..start.len() {
            start[v] += start[v - 1];
        }
        pause().await;
        let mut ends = vec![[0; 2]; 3 * triangles.len()];
        for slice in triangles.chunks(LIGHT) {
            for &[a, b, c] in slice {
                for (v, next, previous) in [(a, b, c), (b, c, a), (c, a, b)] {
                    let end = &mut start[v as usize + 1];
                    ends[*end as usize] = [next, previous];
                    *end += 1;
                }
            }
            pause().await;
        }
        Self { start, ends }
    }

    fn range(&self, v: usize) -> Range<usize> {
        self.start[v] as usize..self.start[v + 1] as usize
    }
}

/// The neighbours and border edges of a vertex, counted over the triangle corners at it.
#[derive(Clone, Copy, Default)]
struct StarCounts {
    /// Number of neighbours.
    degree: u32,
    /// Number of border edges that leave the vertex.
    border: u32,
    /// The end of such an edge, if the vertex has one open fan and nothing else.
    border_to: Option<u32>,
}

impl Topology {
    /// The connectivity of `triangles` over the vertices `0..vertex_count`. Linear in both, while
    /// no vertex has very many triangles.
    ///
    /// # Panics
    ///
    /// If a triangle names a vertex that is not below `vertex_count`.
    #[must_use]
    pub fn new(triangles: &[[u32; 3]], vertex_count: usize) -> Self {
        slices::complete(Self::in_slices(triangles, vertex_count))
    }

    /// [`Topology::new`] in slices of work.
    pub(crate) async fn in_slices(triangles: &[[u32; 3]], vertex_count: usize) -> Self {
        let corners = Corners::new(triangles, vertex_count).await;
        let parts = slices::map(vertex_count, MEDIUM, Vec::new, |own, vertices| {
            let mut part = Self::default();
            let add = |v: usize| {
                own.clear();
                own.extend_from_slice(&corners.ends[corners.range(v)]);
                part.add_vertex(v as u32, own)
            };
            let stars: Vec<StarCounts> = vertices.map(add).collect();
            (part, stars)
        });
        let mut topology = Self::default();
        let mut stars = Vec::with_capacity(vertex_count);
        for (part, own) in parts.await {
            topology.crowded_edges.extend(part.crowded_edges);
            topology.pinched_vertices.extend(part.pinched_vertices);
            topology.lone_edges.extend(part.lone_edges);
            stars.extend(own);
        }
        topology.count_components(&corners, &stars).await;
        topology.trace_borders(&mut stars);
        topology
    }

    /// Whether every edge has one or two triangles of equal orientation and every vertex one fan of
    /// them.
    #[must_use]
    pub fn is_manifold(&self) -> bool {
        self.crowded_edges.is_empty() && self.pinched_vertices.is_empty()
    }

    /// Whether there are triangles, and they form a manifold without border.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.is_manifold() && self.encloses()
    }

    /// Whether there are triangles, and every edge has two of equal orientation, so that they
    /// enclose a volume. They may touch each other at vertices.
    #[must_use]
    pub fn encloses(&self) -> bool {
        !self.components.is_empty() && self.crowded_edges.is_empty() && self.borders.is_empty()
    }

    /// Sum of the Euler numbers of the components.
    #[must_use]
    pub fn euler(&self) -> i64 {
        self.components.iter().map(Component::euler).sum()
    }

    /// Takes part in turning the triangles round: those around the vertices for which `is_turned`
    /// holds are now counter-clockwise seen from the other side.
    pub(crate) fn turn(&mut self, is_turned: impl Fn(u32) -> bool) {
        self.borders
            .iter_mut()
            .filter(|border| is_turned(border[0]))
            .for_each(|border| border[1..].reverse());
        self.crowded_edges.iter_mut().filter(|edge| is_turned(edge[0])).for_each(|edge| edge.swap(0, 1));
    }

    /// Looks at the corners of a vertex: its crowded edges, its fans and its border edges.
    fn add_vertex(&mut self, v: u32, corners: &mut [[u32; 2]]) -> StarCounts {
        let mut is_simple = true;
        for (k, &[next, previous]) in corners.iter().enumerate() {
            if corners[..k].iter().any(|earlier| earlier[0] == next) {
                self.crowded_edges.push([v, next]);
                is_simple = false;
            }
            is_simple &= corners[..k].iter().all(|earlier| earlier[1] != previous);
        }
        if corners.is_empty() {
            return StarCounts::default();
        }
        let count = corners.len() as u32;
        if is_simple && is_one_fan(corners) {
            let (first, last) = (corners[0][0], corners[corners.len() - 1][1]);
            return if first == last {
                StarCounts { degree: count, border: 0, border_to: None }
            } else {
                self.lone_edges.extend([first, last].into_iter().filter(|&w| v < w).map(|w| [v, w]));
                StarCounts { degree: count + 1, border: 1, border_to: Some(first) }
            };
        }
        if is_simple {
            self.pinched_vertices.push(v);
        }
        let ends = corners.as_flattened();
        let degree = (0..ends.len()).filter(|&k| !ends[..k].contains(&ends[k])).count() as u32;
        let is_lone = |w: &&u32| v < **w && ends.iter().filter(|end| end == w).count() == 1;
        self.lone_edges.extend(ends.iter().filter(is_lone).map(|&w| [v, w]));
        let leaves = |corner: &&[u32; 2]| corners.iter().all(|other| other[1] != corner[0]);
        StarCounts { degree, border: corners.iter().filter(leaves).count() as u32, border_to: None }
    }

    fn trace_borders(&mut self, stars: &mut [StarCounts]) {
        for start in 0..stars.len() {
            let mut border = Vec::new();
            let mut v = start as u32;
            while let Some(next) = stars[v as usize].border_to.take() {
                border.push(v);
                v = next;
            }
            if !border.is_empty() {
                self.borders.push(border);
            }
        }
    }

    async fn count_components(&mut self, corners: &Corners, stars: &[StarCounts]) {
        let mut component_of = vec![NONE; stars.len()];
        let mut open = Vec::new();
        let mut looked_at = 0_usize;
        for first in 0..stars.len() {
            if component_of[first] != NONE || corners.range(first).is_empty() {
                continue;
            }
            let number = self.components.len() as u32;
            let mut component = Component::default();
            let (mut corner_count, mut edge_ends) = (0, 0_u64);
            component_of[first] = number;
            open.push(first as u32);
            while let Some(v) = open.pop() {
                looked_at += 1;
                if looked_at.is_multiple_of(MEDIUM) {
                    pause().await;
                }
                let star = &stars[v as usize];
                let corners = &corners.ends[corners.range(v as usize)];
                component.vertices += 1;
                component.border_edges += star.border;
                corner_count += corners.len();
                edge_ends += u64::from(star.degree);
                for &[next, previous] in corners {
                    for w in [next, previous] {
                        if component_of[w as usize] == NONE {
                            component_of[w as usize] = number;
                            open.push(w);
                        }
                    }
                }
            }
            component.triangles = (corner_count / 3) as u32;
            component.edges = (edge_ends / 2) as u32;
            self.components.push(component);
        }
        self.component_of = component_of;
    }
}

/// Gives the fans of triangles around pinched vertices vertices of their own, as far as `corners`
/// tell them apart: the same triangles by rows, of which a vertex may have several. A fan takes the
/// first row that no other fan of its vertex has. So bodies that touch in a point are two.
pub(crate) fn separate_fans(triangles: &mut [[u32; 3]], corners: &[[u32; 3]], pinched: &[u32]) {
    if pinched.is_empty() {
        return;
    }
    // The corners at each pinched vertex, by triangle and place in it.
    let mut around: Vec<(u32, [usize; 2])> = Vec::new();
    for (k, triangle) in triangles.iter().enumerate() {
        let corners = triangle.iter().enumerate();
        around.extend(
            corners.filter(|(_, v)| pinched.binary_search(v).is_ok()).map(|(corner, &v)| (v, [k, corner])),
        );
    }
    around.sort_unstable();
    for of_vertex in around.chunk_by(|one, other| one.0 == other.0) {
        let v = of_vertex[0].0;
        let mut fans = Forest::new(of_vertex.len());
        for (i, &(_, [k, _])) in (0..).zip(of_vertex) {
            for (j, &(_, [l, _])) in (0..i).zip(of_vertex) {
                if triangles[k].iter().any(|&w| w != v && triangles[l].contains(&w)) {
                    fans.join(i, j);
                }
            }
        }
        let mut rows: Vec<(u32, u32)> =
            (0..).zip(of_vertex).map(|(i, &(_, [k, corner]))| (corners[k][corner], fans.find(i))).collect();
        rows.sort_unstable();
        // The first row of each fan, in the order of the rows.
        let mut named: Vec<(u32, u32)> = Vec::new();
        for of_row in rows.chunk_by(|one, other| one.0 == other.0) {
            let (row, fan) = of_row[0];
            if of_row.iter().all(|other| other.1 == fan) && named.iter().all(|other| other.1 != fan) {
                named.push((row, fan));
            }
        }
        for (i, &(_, [k, corner])) in (0..).zip(of_vertex) {
            let fan = fans.find(i);
            triangles[k][corner] = named.iter().find(|named| named.1 == fan).map_or(v, |named| named.0);
        }
    }
}

/// Whether the corners, no two of which have the same vertex before or after them, form one fan; if
/// so, they are put in its order, counter-clockwise.
fn is_one_fan(corners: &mut [[u32; 2]]) -> bool {
    let mut count = 1;
    while count < corners.len() {
        let (first, last) = (corners[0][0], corners[count - 1][1]);
        if let Some(k) = (count..corners.len()).find(|&k| corners[k][0] == last) {
            corners.swap(count, k);
        } else if let Some(k) = (count..corners.len()).find(|&k| corners[k][1] == first) {
            corners.swap(count, k);
            corners[..=count].rotate_right(1);
        } else {
            return false;
        }
        count += 1;
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];

    fn shifted(triangles: &[[u32; 3]], by: u32) -> impl Iterator<Item = [u32; 3]> {
        triangles.iter().map(move |triangle| triangle.map(|v| v + by))
    }

    /// A torus of `columns` × `rows` squares, each cut by a diagonal.
    fn torus(columns: u32, rows: u32) -> Vec<[u32; 3]> {
        let at = |i: u32, j: u32| i % columns + j % rows * columns;
        let square = |i: u32, j: u32| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        };
        (0..rows).flat_map(|j| (0..columns).flat_map(move |i| square(i, j))).collect()
    }

    #[test]
    fn closed_surfaces_have_their_euler_numbers() {
        for (triangles, count, euler) in
            [(TETRAHEDRON.to_vec(), 4, 2), (torus(3, 3), 9, 0), (torus(8, 5), 40, 0)]
        {
            let topology = Topology::new(&triangles, count);
            assert!(topology.is_closed(), "{topology:?}");
            assert_eq!((topology.components.len(), topology.euler()), (1, euler));
            assert_eq!(topology.components[0].vertices as usize, count);
        }
    }

    #[test]
    fn components_are_told_apart_and_lone_vertices_belong_to_none() {
        let triangles: Vec<_> = shifted(&TETRAHEDRON, 1).chain(shifted(&torus(4, 3), 5)).collect();
        let topology = Topology::new(&triangles, 18);
        assert!(topology.is_closed());
        let euler: Vec<i64> = topology.components.iter().map(Component::euler).collect();
        assert_eq!(euler, [2, 0]);
    }

    #[test]
    fn borders_are_loops_with_the_mesh_on_their_left() {
        let topology = Topology::new(&TETRAHEDRON[..3], 4);
        assert!(topology.is_manifold() && !topology.is_closed());
        assert_eq!(topology.borders, [[1, 2, 3]]);
        assert_eq!((topology.euler(), topology.components[0].border_edges), (1, 3));
        // A torus without one of its triangles, and without two that share a vertex only.
        let mut triangles = torus(6, 6);
        triangles.remove(0);
        let topology = Topology::new(&triangles, 36);
        assert_eq!((topology.borders.len(), topology.euler()), (1, -1));
    }

    #[test]
    fn faults_are_named() {
        let pinched: Vec<_> = TETRAHEDRON
            .into_iter()
            .chain(TETRAHEDRON.map(|triangle| triangle.map(|v| if v == 0 { 0 } else { v + 3 })))
            .collect();
        let topology = Topology::new(&pinched, 7);
        assert_eq!((topology.pinched_vertices, topology.crowded_edges), (vec![0], vec![]));
        let mut turned = TETRAHEDRON;
        turned[3].swap(0, 1);
        assert_eq!(Topology::new(&turned, 4).crowded_edges.len(), 3);
        let doubled: Vec<_> = TETRAHEDRON.into_iter().chain([[0, 1, 2]]).collect();
        assert!(!Topology::new(&doubled, 4).is_manifold());
    }
}
