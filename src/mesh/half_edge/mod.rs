//! A triangle surface as half-edges: its connectivity, and the operations that change it.
//!
//! Face `f` has the half-edges `3f`, `3f + 1` and `3f + 2`, counter-clockwise seen from outside, so
//! that the next and the previous one follow from the number. Stored are the vertex at which each
//! half-edge begins, its twin in the face on the other side, and one half-edge that leaves each
//! vertex. The surface knows no positions: the owner of the particles decides what to change.
//!
//! # Invariants
//!
//! A test checks these after every operation:
//!
//! * Twins refer to each other and run between the same two vertices in opposite directions. A
//!   half-edge without a twin lies on the border.
//! * The faces at a vertex form one fan. At a border vertex the stored half-edge is the first of
//!   the fan, the one without a twin, so that a walk counter-clockwise meets every face.
//! * No two half-edges run from the same vertex to the same other, and no face has a vertex twice.
//!
//! Source of the structure: the directed edges of S. Campagna, L. Kobbelt and H.-P. Seidel,
//! "Directed Edges: A Scalable Representation for Triangle Meshes", Journal of Graphics Tools
//! 3(4), 1998.

mod build;
mod edit;
mod subdivide;
#[cfg(test)]
mod tests;

pub use subdivide::Subdivision;

use crate::math::NONE;

/// A surface of triangles.
#[derive(Clone, Debug, Default)]
pub struct HalfEdges {
    /// The vertex at which each half-edge begins; [`NONE`] for those of a removed face.
    origin: Vec<u32>,
    /// The half-edge on the other side; [`NONE`] at the border.
    twin: Vec<u32>,
    /// A half-edge that leaves the vertex; [`NONE`] for a vertex without faces.
    outgoing: Vec<u32>,
    free_faces: Vec<u32>,
    free_vertices: Vec<u32>,
    /// The changes since the beginning of the journal, newest last.
    journal: Vec<Change>,
    is_recording: bool,
}

/// A change of the mesh, with the values that undo it.
#[derive(Clone, Copy, Debug)]
enum Change {
    /// The half-edge began at this vertex.
    Origin(u32, u32),
    /// The half-edge had this twin.
    Twin(u32, u32),
    /// The vertex had this half-edge.
    Outgoing(u32, u32),
    /// A face was removed.
    FaceFreed,
    /// A removed face was used again.
    FaceTaken(u32),
    /// A face was added at the end.
    FaceAdded,
    /// A vertex was removed.
    VertexFreed,
    /// A removed vertex was used again.
    VertexTaken(u32),
    /// A vertex was added at the end.
    VertexAdded,
}

/// The half-edge that follows `h` in its face.
#[inline]
#[must_use]
pub fn next(h: u32) -> u32 {
    if h % 3 == 2 { h - 2 } else { h + 1 }
}

/// The half-edge before `h` in its face.
#[inline]
#[must_use]
pub fn previous(h: u32) -> u32 {
    if h.is_multiple_of(3) { h + 2 } else { h - 1 }
}

impl HalfEdges {
    /// Vertex numbers lie below this; some may have been removed.
    #[must_use]
    pub fn vertex_slots(&self) -> usize {
        self.outgoing.len()
    }

    /// Half-edge numbers lie below this; some may have been removed.
    #[must_use]
    pub fn half_edge_slots(&self) -> usize {
        self.origin.len()
    }

    /// Number of faces.
    #[must_use]
    pub fn faces(&self) -> usize {
        self.origin.len() / 3 - self.free_faces.len()
    }

    /// Whether the vertex exists and has a face.
    #[inline]
    #[must_use]
    pub fn has_vertex(&self, v: u32) -> bool {
        self.outgoing[v as usize] != NONE
    }

    /// Whether the half-edge belongs to a face that exists.
    #[inline]
    #[must_use]
    pub fn has_half_edge(&self, h: u32) -> bool {
        self.origin[h as usize] != NONE
    }

    /// The vertex at which `h` begins.
    #[inline]
    #[must_use]
    pub fn origin(&self, h: u32) -> u32 {
        self.origin[h as usize]
    }

    /// The vertex at which `h` ends.
    #[inline]
    #[must_use]
    pub fn target(&self, h: u32) -> u32 {
        self.origin[next(h) as usize]
    }

    /// The half-edge on the other side; [`NONE`] at the border.
    #[inline]
    #[must_use]
    pub fn twin(&self, h: u32) -> u32 {
        self.twin[h as usize]
    }

    /// A half-edge that leaves `v`, the first of the fan at a border vertex; [`NONE`] for a vertex
    /// without faces.
    #[inline]
    #[must_use]
    pub fn outgoing(&self, v: u32) -> u32 {
        self.outgoing[v as usize]
    }

    /// Whether `v` lies on the border.
    #[inline]
    #[must_use]
    pub fn is_border(&self, v: u32) -> bool {
        let h = self.outgoing(v);
        h != NONE && self.twin(h) == NONE
    }

    /// The half-edges that leave `v`, counter-clockwise, one for each of its faces. A border vertex
    /// has one neighbour more: the origin of the half-edge before the last.
    #[inline]
    pub fn around(&self, v: u32) -> Around<'_> {
        let first = self.outgoing(v);
        Around { mesh: self, first, at: first }
    }

    /// The neighbours of `v`, counter-clockwise.
    #[inline]
    pub fn neighbours(&self, v: u32) -> Neighbours<'_> {
        let first = self.outgoing(v);
        let vertex = if first == NONE { NONE } else { self.target(first) };
        Neighbours { mesh: self, first, at: first, vertex }
    }

    /// Number of neighbours of `v`.
    #[must_use]
    pub fn valence(&self, v: u32) -> usize {
        self.neighbours(v).count()
    }

    /// The half-edge from `a` to `b`, if there is one.
    #[must_use]
    pub fn find(&self, a: u32, b: u32) -> Option<u32> {
        self.around(a).find(|&h| self.target(h) == b)
    }

    /// Whether `a` and `b` are neighbours.
    #[must_use]
    pub fn is_adjacent(&self, a: u32, b: u32) -> bool {
        self.neighbours(a).any(|other| other == b)
    }

    /// The half-edges of all existing faces, each edge once: by the half-edge with the smaller
    /// number, or by the only one.
    pub fn edges(&self) -> impl Iterator<Item = u32> + '_ {
        // At the border the twin is the largest number.
        (0..self.origin.len() as u32).filter(|&h| self.has_half_edge(h) && h < self.twin(h))
    }

    /// The vertices of face `f`, if it exists.
    #[inline]
    #[must_use]
    pub fn face(&self, f: u32) -> Option<[u32; 3]> {
        let corners = &self.origin[3 * f as usize..3 * f as usize + 3];
        (corners[0] != NONE).then(|| [corners[0], corners[1], corners[2]])
    }

    /// The existing faces, by their vertices.
    pub fn triangles(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        self.origin.chunks_exact(3).filter(|corners| corners[0] != NONE).map(|c| [c[0], c[1], c[2]])
    }

    /// The vertices at which the half-edges begin, face by face, [`NONE`] for those of removed
    /// faces; all else is freed.
    #[must_use]
    pub fn into_corners(self) -> Vec<u32> {
        self.origin
    }

    /// Euler number V − E + F; vertices without faces do not count.
    #[must_use]
    pub fn euler(&self) -> i64 {
        let vertices = self.outgoing.iter().filter(|&&h| h != NONE).count() as i64;
        vertices - self.edges().count() as i64 + self.faces() as i64
    }
}

/// The half-edges that leave a vertex: see [`HalfEdges::around`].
#[derive(Clone, Debug)]
pub struct Around<'a> {
    mesh: &'a HalfEdges,
    first: u32,
    at: u32,
}

impl Iterator for Around<'_> {
    type Item = u32;

    #[inline]
    fn next(&mut self) -> Option<u32> {
        let here = self.at;
        if here == NONE {
            return None;
        }
        let left = self.mesh.twin(previous(here));
        self.at = if left == self.first { NONE } else { left };
        Some(here)
    }
}

/// The neighbours of a vertex: see [`HalfEdges::neighbours`].
#[derive(Clone, Debug)]
pub struct Neighbours<'a> {
    mesh: &'a HalfEdges,
    first: u32,
    /// The half-edge whose face has the neighbour after the next one.
    at: u32,
    /// The next neighbour.
    vertex: u32,
}

impl Iterator for Neighbours<'_> {
    type Item = u32;

    #[inline]
    fn next(&mut self) -> Option<u32> {
        let here = self.vertex;
        if here == NONE {
            return None;
        }
        self.vertex = NONE;
        if self.at != NONE {
            let across = previous(self.at);
            self.at = self.mesh.twin(across);
            if self.at != self.first {
                self.vertex = self.mesh.origin(across);
            }
        }
        Some(here)
    }
}
