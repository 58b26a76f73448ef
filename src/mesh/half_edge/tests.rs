//! Every operation on half-edges is held to the invariants, on surfaces with and without a border.

use super::{HalfEdges, NONE, Subdivision, next, previous};
use proptest::prelude::*;

impl HalfEdges {
    /// Holds the surface to the invariants of the module's documentation.
    ///
    /// Cost: linear, as long as no vertex has very many faces.
    ///
    /// # Errors
    ///
    /// A sentence that names the invariant that does not hold, and the place.
    pub(crate) fn check(&self) -> Result<(), String> {
        let slots = self.origin.len() as u32;
        let mut faces_at = vec![0_usize; self.outgoing.len()];
        let mut is_free = vec![false; self.origin.len() / 3];
        self.free_faces.iter().for_each(|&f| is_free[f as usize] = true);
        for f in 0..slots / 3 {
            let corners: [u32; 3] = core::array::from_fn(|k| self.origin(3 * f + k as u32));
            let is_there = corners[0] != NONE;
            if is_there == is_free[f as usize] {
                return Err(format!("face {f} is both there and free, or neither"));
            }
            if !is_there {
                continue;
            }
            if corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0] {
                return Err(format!("face {f} has a vertex twice: {corners:?}"));
            }
            for &v in &corners {
                if v as usize >= self.outgoing.len() || !self.has_vertex(v) {
                    return Err(format!("face {f} has the vertex {v}, which is not there"));
                }
                faces_at[v as usize] += 1;
            }
            for h in 3 * f..3 * f + 3 {
                let t = self.twin(h);
                if t != NONE && (t >= slots || self.twin(t) != h) {
                    return Err(format!("the twin {t} of half-edge {h} has another twin"));
                }
                if t != NONE && (self.origin(t) != self.target(h) || self.target(t) != self.origin(h)) {
                    return Err(format!("half-edge {h} and its twin {t} run between different vertices"));
                }
            }
        }
        if let Some(v) = self.free_vertices.iter().find(|&&v| self.has_vertex(v)) {
            return Err(format!("vertex {v} is both there and free"));
        }
        (0..)
            .zip(faces_at)
            .filter(|&(v, _)| self.has_vertex(v))
            .try_for_each(|(v, faces)| self.check_fan(v, faces))
    }

    /// Holds the fan at `v`, which has so many faces, to the invariants.
    fn check_fan(&self, v: u32, faces: usize) -> Result<(), String> {
        if self.origin(self.outgoing(v)) != v {
            return Err(format!("the half-edge of vertex {v} leaves another"));
        }
        let fan = self.around(v).take(faces + 1).count();
        if fan != faces {
            return Err(format!("the fan at vertex {v} has {fan} of its {faces} faces"));
        }
        let is_open = self.around(v).any(|h| self.twin(previous(h)) == NONE);
        if is_open != self.is_border(v) {
            return Err(format!("the half-edge of the border vertex {v} is not the first of its fan"));
        }
        let neighbours: Vec<u32> = self.neighbours(v).collect();
        if neighbours.iter().enumerate().any(|(k, other)| neighbours[..k].contains(other)) {
            return Err(format!("vertex {v} has a neighbour twice: {neighbours:?}"));
        }
        Ok(())
    }
}

/// An octahedron: closed, Euler number 2.
fn octahedron() -> HalfEdges {
    let triangles = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    HalfEdges::from_triangles(6, &triangles).expect("an octahedron is a surface")
}

/// A grid of `columns` × `rows` squares, each cut in two; `closed` joins opposite sides to a torus.
fn grid(columns: u32, rows: u32, closed: bool) -> HalfEdges {
    let (width, height) = if closed { (columns, rows) } else { (columns + 1, rows + 1) };
    let vertex = |i: u32, j: u32| (j % height) * width + i % width;
    let triangles: Vec<[u32; 3]> = (0..rows)
        .flat_map(|j| (0..columns).map(move |i| (i, j)))
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    HalfEdges::from_triangles((width * height) as usize, &triangles).expect("a grid is a surface")
}

fn surface(kind: u8) -> HalfEdges {
    match kind % 4 {
        0 => octahedron(),
        1 => grid(5, 6, true),
        2 => grid(4, 5, false),
        _ => subdivided(&octahedron()).0,
    }
}

fn subdivided(mesh: &HalfEdges) -> (HalfEdges, Vec<[u32; 2]>) {
    let mut subdivision = Subdivision::new(mesh);
    assert!(subdivision.step(mesh, u32::MAX));
    subdivision.finish()
}

/// Does the operation of the given kind at the half-edge chosen by `place`, if it is allowed there.
fn operate(mesh: &mut HalfEdges, kind: u8, place: u32) -> bool {
    let h = place % mesh.half_edge_slots() as u32;
    if !mesh.has_half_edge(h) {
        return false;
    }
    match kind % 4 {
        0 if mesh.can_flip(h) => mesh.flip(h),
        1 if mesh.can_collapse(h) => {
            let (gone, kept) = (mesh.origin(h), mesh.target(h));
            assert_eq!(mesh.collapse(h), kept);
            assert!(!mesh.has_vertex(gone) && mesh.has_vertex(kept));
        }
        2 => {
            let v = mesh.insert(h);
            assert_eq!(mesh.valence(v), 3);
        }
        3 => {
            let expected = if mesh.twin(h) == NONE { 3 } else { 4 };
            let v = mesh.split(h);
            assert_eq!(mesh.valence(v), expected);
        }
        _ => return false,
    }
    true
}

/// Border half-edges, which no operation but a split or a collapse of one changes.
fn border(mesh: &HalfEdges) -> usize {
    (0..mesh.half_edge_slots() as u32).filter(|&h| mesh.has_half_edge(h) && mesh.twin(h) == NONE).count()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn operations_keep_the_invariants_and_the_euler_number(
        kind in 0_u8..4,
        operations in prop::collection::vec((0_u8..4, any::<u32>()), 1..80),
    ) {
        let mut mesh = surface(kind);
        let euler = mesh.euler();
        let has_border = border(&mesh) > 0;
        for (operation, place) in operations {
            if operate(&mut mesh, operation, place) {
                prop_assert_eq!(mesh.check(), Ok(()), "operation {} at {}", operation, place);
                prop_assert_eq!(mesh.euler(), euler);
                prop_assert_eq!(border(&mesh) > 0, has_border);
            }
        }
        let again = HalfEdges::from_triangles(
            mesh.vertex_slots(),
            &mesh.triangles().collect::<Vec<_>>(),
        );
        prop_assert_eq!(again.map(|mesh| mesh.check()), Some(Ok(())), "the triangles are a surface again");
    }

    #[test]
    fn undoing_restores_every_number(
        kind in 0_u8..4,
        before in prop::collection::vec((0_u8..4, any::<u32>()), 0..20),
        operations in prop::collection::vec((0_u8..4, any::<u32>()), 1..40),
    ) {
        let mut mesh = surface(kind);
        for (operation, place) in before {
            operate(&mut mesh, operation, place);
        }
        let text = format!("{mesh:?}");
        mesh.begin();
        for (operation, place) in operations {
            operate(&mut mesh, operation, place);
        }
        mesh.undo();
        prop_assert_eq!(format!("{mesh:?}"), text);
    }

    #[test]
    fn a_subdivision_adds_no_defect(
        kind in 0_u8..4,
        operations in prop::collection::vec((0_u8..4, any::<u32>()), 0..30),
        budget in 1_u32..50,
    ) {
        let mut mesh = surface(kind);
        for (operation, place) in operations {
            operate(&mut mesh, operation, place);
        }
        let (fine, ends) = subdivided(&mesh);
        prop_assert_eq!(fine.check(), Ok(()));
        prop_assert_eq!(fine.euler(), mesh.euler());
        prop_assert_eq!(fine.faces(), 4 * mesh.faces());
        prop_assert_eq!(border(&fine), 2 * border(&mesh));
        for (v, [a, b]) in (0..).zip(ends.iter().copied()) {
            if b == NONE {
                prop_assert_eq!(fine.valence(v), mesh.valence(a));
            } else {
                prop_assert!(mesh.is_adjacent(a, b));
                prop_assert_eq!(fine.valence(v), if fine.is_border(v) { 4 } else { 6 });
            }
        }
        // In small slices it is the same.
        let mut sliced = Subdivision::new(&mesh);
        while !sliced.step(&mesh, budget) {}
        let (other, other_ends) = sliced.finish();
        prop_assert_eq!(format!("{other:?}"), format!("{fine:?}"));
        prop_assert_eq!(other_ends, ends);
    }

    #[test]
    fn flipping_four_times_restores_the_faces(place in any::<u32>()) {
        let mut mesh = subdivided(&octahedron()).0;
        let h = place % mesh.half_edge_slots() as u32;
        if mesh.can_flip(h) {
            let turned = |mesh: &HalfEdges| {
                let mut all: Vec<[u32; 3]> = mesh.triangles().map(|t| {
                    let least = (0..3).min_by_key(|&k| t[k]).expect("three corners");
                    [t[least], t[(least + 1) % 3], t[(least + 2) % 3]]
                }).collect();
                all.sort_unstable();
                all
            };
            let before = turned(&mesh);
            mesh.flip(h);
            prop_assert_ne!(turned(&mesh), before.clone());
            mesh.flip(h);
            prop_assert_eq!(turned(&mesh), before);
        }
    }
}

#[test]
fn what_is_no_surface_is_refused() {
    let three_at_an_edge = [[0, 1, 2], [1, 0, 3], [0, 1, 4]];
    assert!(HalfEdges::from_triangles(5, &three_at_an_edge).is_none(), "two triangles run along one edge");
    let two_fans = [[0, 1, 2], [0, 3, 4]];
    assert!(HalfEdges::from_triangles(5, &two_fans).is_none(), "two fans at one vertex");
    for bad in [[0, 1, 1], [0, 1, 9]] {
        assert!(HalfEdges::from_triangles(3, &[[0, 1, 2], bad]).is_none(), "{bad:?}");
    }
    let turned = [[0, 1, 2], [0, 1, 3]];
    assert!(HalfEdges::from_triangles(4, &turned).is_none(), "two triangles of opposite orientation");
}

#[test]
fn a_border_vertex_has_one_neighbour_more_than_faces() {
    let mesh = grid(3, 3, false);
    assert_eq!(mesh.check(), Ok(()));
    let corner = 0;
    assert!(mesh.is_border(corner));
    assert_eq!(mesh.around(corner).count(), 2);
    assert_eq!(mesh.neighbours(corner).collect::<Vec<_>>(), [1, 5, 4]);
    assert_eq!(mesh.euler(), 1);
    assert_eq!(grid(4, 4, true).euler(), 0);
    assert_eq!(octahedron().euler(), 2);
}

#[test]
fn a_tetrahedron_cannot_be_made_smaller() {
    let mesh =
        HalfEdges::from_triangles(4, &[[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]]).expect("a surface");
    for h in 0..12 {
        assert!(!mesh.can_collapse(h) && !mesh.can_flip(h));
        assert_eq!(mesh.origin(next(h)), mesh.target(h));
    }
}
