//! Open surfaces: walls below the border of a mesh, at which its surface ends.
//!
//! A *wall* stands on each edge of the border, across the surface, and reaches down from it. The
//! faces and the walls are a part with edges like any other, and inside is below the faces and
//! within the walls; but the walls only limit the surface. Their creases with the faces are its
//! rim.

use super::edges::{Edges, Side, ends_of};
use super::patch_function::{SKIRT, free_length};
use super::tree::Tree;
use super::{MeshError, MeshSolid, TriangleMesh};
use crate::math::Forest;
use glam::DVec3;
use std::sync::Arc;

/// Depth of a wall divided by the radius of the largest ball that touches the surface from below
/// and holds none of it: the wall stays nearer to its edge than to other parts of the surface.
const DEPTH: f64 = 0.5;
/// A border with a larger share of turns zigzags, as that of a cut scan does, and is smoothed.
const TURNS: f64 = 0.25;
/// Rounds in which faces that only hang on the others by one side are left out at a zigzagging
/// border. Smoothed, they would lie in it with no area.
const TRIMS: usize = 2;
/// Rounds in which a zigzagging border is smoothed. Each takes away a zigzag of single edges, and
/// nine tenths of one of twice the length.
const ROUNDS: usize = 10;
/// Shares of the way to the middle of its neighbours that a vertex goes, forth and back, so that
/// curves do not shrink (G. Taubin, "A Signal Processing Approach to Fair Surface Design", 1995).
const STEPS: [f64; 2] = [0.5, -0.53];

/// An open surface with its walls.
pub(super) struct Walled {
    /// The faces of the surface, then two for each edge of the border.
    pub(super) solid: MeshSolid,
    /// Number of faces of the surface.
    pub(super) faces: usize,
    /// Whether the border zigzagged and was smoothed.
    pub(super) is_smoothed: bool,
}

/// The borders of a mesh: its sides without a neighbour, and for each vertex on them the side that
/// ends and the side that begins there.
struct Borders {
    ends: Vec<[u32; 2]>,
    /// Vertices in ascending order, each with the vertices before and after it.
    around: Vec<(u32, u32, u32)>,
}

impl Borders {
    fn new(faces: &[[u32; 3]], edges: &Edges) -> Self {
        let lone = (0..edges.len()).filter_map(|edge| match edges.sides(edge) {
            [side] => Some(ends_of(&faces[side.face as usize], side.side)),
            _ => None,
        });
        let ends: Vec<[u32; 2]> = lone.collect();
        let mut before: Vec<(u32, u32)> = ends.iter().map(|&[a, b]| (b, a)).collect();
        before.sort_unstable();
        let mut around: Vec<(u32, u32, u32)> = Vec::with_capacity(ends.len());
        for &[a, b] in &ends {
            let at = before.partition_point(|own| own.0 < a);
            if let Some(&(vertex, from)) = before.get(at)
                && vertex == a
            {
                around.push((a, from, b));
            }
        }
        around.sort_unstable();
        // Where two borders touch at a vertex, the first one decides.
        around.dedup_by_key(|own| own.0);
        Self { ends, around }
    }

    /// Whether the border bends by more than 45° at many of its vertices.
    fn zigzags(&self, vertices: &[DVec3]) -> bool {
        const STRAIGHT: f64 = 0.7;
        let place = |vertex: u32| vertices[vertex as usize];
        let turns = self.around.iter().filter(|&&(at, from, to)| {
            let [u, v] = [place(at) - place(from), place(to) - place(at)].map(DVec3::normalize_or_zero);
            u.dot(v) < STRAIGHT
        });
        // Triangles and the like have few corners, which are kept.
        const FEWEST: usize = 16;
        self.around.len() >= FEWEST && turns.count() as f64 > TURNS * self.around.len() as f64
    }

    /// Smooths the border of these faces, but keeps vertices where a face would fold.
    fn smooth(&self, vertices: &mut [DVec3], faces: &[[u32; 3]]) {
        let before: Vec<DVec3> = self.around.iter().map(|own| vertices[own.0 as usize]).collect();
        for share in STEPS.repeat(ROUNDS) {
            let moved = |&(at, from, to): &(u32, u32, u32)| {
                let [a, b, c] = [from, at, to].map(|vertex| vertices[vertex as usize]);
                b.lerp(0.5 * (a + c), share)
            };
            let moved: Vec<DVec3> = self.around.iter().map(moved).collect();
            self.around.iter().zip(moved).for_each(|(own, place)| vertices[own.0 as usize] = place);
        }
        let place_of = |vertex: u32| self.around.binary_search_by_key(&vertex, |own| own.0).ok();
        let own: Vec<&[u32; 3]> =
            faces.iter().filter(|face| face.iter().any(|&corner| place_of(corner).is_some())).collect();
        /// Least share of its area that a face keeps along its normal.
        const KEPT: f64 = 0.2;
        let across = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a);
        // A vertex that goes back may fold another face.
        loop {
            let mut is_folded = vec![false; before.len()];
            for face in &own {
                let place = |corner: u32| vertices[corner as usize];
                let old = |corner: u32| place_of(corner).map_or(place(corner), |at| before[at]);
                let (new, old) = (across(face.map(place)), across(face.map(old)));
                if new.dot(old) < KEPT * old.length_squared() {
                    face.iter().filter_map(|&corner| place_of(corner)).for_each(|at| is_folded[at] = true);
                }
            }
            let mut is_done = true;
            for (at, _) in is_folded.iter().enumerate().filter(|own| *own.1) {
                let vertex = &mut vertices[self.around[at].0 as usize];
                is_done &= *vertex == before[at];
                *vertex = before[at];
            }
            if is_done {
                return;
            }
        }
    }
}

/// Leaves out the faces that have two sides on the border.
fn trim(faces: &mut Vec<[u32; 3]>) {
    for _ in 0..TRIMS {
        let edges = Edges::new(faces);
        let is_lone = |&edge: &u32| edges.sides(edge as usize).len() == 1;
        let lone_sides = |face: u32| edges.of_face(face).iter().filter(|edge| is_lone(edge)).count();
        let is_kept: Vec<bool> = (0..faces.len() as u32).map(|face| lone_sides(face) != 2).collect();
        let mut kept = is_kept.iter();
        faces.retain(|_| kept.next() == Some(&true));
    }
}

impl MeshSolid {
    /// This open surface with walls below its border.
    pub(super) fn walled(&self) -> Result<Walled, MeshError> {
        if self.fans > 0 {
            return Err(MeshError::Fans { count: self.fans });
        }
        if self.has_one_side() {
            return Err(MeshError::OneSided);
        }
        let (mut vertices, mut faces) = (self.mesh.vertices().to_vec(), self.mesh.faces().to_vec());
        let mut borders = Borders::new(&faces, &self.edges);
        let is_smoothed = borders.zigzags(&vertices);
        if is_smoothed {
            trim(&mut faces);
            if faces.is_empty() {
                return Err(MeshError::NoArea);
            }
            borders = Borders::new(&faces, &Edges::new(&faces));
            borders.smooth(&mut vertices, &faces);
        }
        let own_faces = faces.len();
        let mut corners: Vec<u32> = borders.ends.iter().map(|ends| ends[0]).collect();
        corners.sort_unstable();
        corners.dedup();
        let place_of = |vertex: u32| corners.partition_point(|&own| own < vertex);
        // Normals at the border, weighted by the angles of the faces.
        let mut normal = vec![DVec3::ZERO; corners.len()];
        let mut length = vec![f64::INFINITY; corners.len()];
        for face in &faces {
            for k in 0..3 {
                let at = place_of(face[k]);
                if corners.get(at) == Some(&face[k]) {
                    let [u, v] = [1, 2]
                        .map(|step| vertices[face[(k + step) % 3] as usize] - vertices[face[k] as usize]);
                    let across = u.cross(v);
                    normal[at] += libm::atan2(across.length(), u.dot(v)) * across.normalize_or_zero();
                    length[at] = length[at].min(u.length()).min(v.length());
                }
            }
        }
        let longest = SKIRT * self.mesh.bounds().diagonal();
        let first = vertices.len() as u32;
        for (at, &vertex) in corners.iter().enumerate() {
            let (p, down) = (vertices[vertex as usize], -normal[at].normalize_or(DVec3::Z));
            let is_other = |face: u32| !self.mesh.faces()[face as usize].contains(&vertex);
            let depth = DEPTH * free_length(p, down, longest, &self.tree, is_other);
            vertices.push(p + down * depth.max(0.1 * length[at]));
        }
        for &[a, b] in &borders.ends {
            let [c, d] = [a, b].map(|end| first + place_of(end) as u32);
            faces.extend([[b, a, c], [b, c, d]]);
        }
        let edges = Edges::new(&faces);
        let mesh = TriangleMesh::of_parts(vertices, faces);
        let tree = Tree::new(&mesh.all_corners());
        let mut solid = self.clone();
        (solid.mesh, solid.edges, solid.tree) = (Arc::new(mesh), Arc::new(edges), Arc::new(tree));
        Ok(Walled { solid, faces: own_faces, is_smoothed })
    }

    /// Whether two faces disagree over an edge although all were oriented: as on a Möbius strip.
    fn has_one_side(&self) -> bool {
        let ends = |side: &Side| ends_of(&self.mesh.faces()[side.face as usize], side.side);
        (0..self.edges.len()).any(|edge| matches!(self.edges.sides(edge), [a, b] if ends(a) == ends(b)))
    }

    /// The number of closed curves that the border consists of.
    #[must_use]
    pub fn border_loops(&self) -> usize {
        let ends = Borders::new(self.mesh.faces(), &self.edges).ends;
        let mut forest = Forest::new(self.mesh.vertices().len());
        ends.iter().for_each(|&[a, b]| forest.join(a, b));
        let mut roots: Vec<u32> = ends.iter().map(|&[a, _]| forest.find(a)).collect();
        roots.sort_unstable();
        roots.dedup();
        roots.len()
    }
}
