//! Subdivision of every face into four, with a new vertex on the middle of every edge.

use super::{HalfEdges, next};
use crate::math::NONE;

/// A subdivision under way: it can be interrupted and continued.
///
/// Old vertices keep their valence and new ones have six neighbours, four on the border: a
/// subdivision adds no defect. A vertex is followed by the middles of those of its edges that no
/// earlier vertex has, so that vertices near on the surface stay near in memory, level after level.
#[derive(Clone, Debug, Default)]
pub struct Subdivision {
    fine: HalfEdges,
    ends: Vec<[u32; 2]>,
    /// Vertex of the finer surface at each existing old one.
    kept: Vec<u32>,
    /// Vertex of the finer surface on the middle of each old half-edge; 0, the number of an old
    /// vertex, before it is numbered.
    middle: Vec<u32>,
    /// Rank of each old face among the existing ones, in the order in which the vertices reach
    /// them.
    rank: Vec<u32>,
    ranked: u32,
    /// Number of vertices of the coarse surface, and then of its faces, that are done.
    done: u32,
}

impl Subdivision {
    /// Begins to subdivide `coarse`, which must stay as it is until the end.
    #[must_use]
    pub fn new(coarse: &HalfEdges) -> Self {
        let (faces, vertices) = (coarse.faces(), coarse.vertex_slots());
        let slots = coarse.half_edge_slots();
        // A closed surface has half as many edges as half-edges; a border adds a few, for which the
        // vectors may grow.
        let expected = vertices + 3 * faces / 2;
        // Zeros are allocated without touching the memory: the first access takes longer than the
        // work that follows.
        let fine = HalfEdges {
            origin: vec![0; 12 * faces],
            twin: vec![0; 12 * faces],
            outgoing: Vec::with_capacity(expected),
            ..HalfEdges::default()
        };
        Self {
            fine,
            ends: Vec::with_capacity(expected),
            kept: vec![0; vertices],
            middle: vec![0; slots],
            rank: vec![NONE; slots / 3],
            ranked: 0,
            done: 0,
        }
    }

    /// Continues with up to `budget` vertices or faces of `coarse`. Returns whether the subdivision
    /// is complete.
    pub fn step(&mut self, coarse: &HalfEdges, budget: u32) -> bool {
        let vertices = coarse.vertex_slots() as u32;
        let all = vertices + (coarse.half_edge_slots() / 3) as u32;
        let end = all.min(self.done.saturating_add(budget));
        for at in self.done..end {
            if at < vertices { self.number(coarse, at) } else { self.write(coarse, at - vertices) }
        }
        self.done = end;
        end == all
    }

    /// The finer surface, once the subdivision is complete, and for each of its vertices the two
    /// ends of the edge that it halves; `[v, NONE]` for the old vertex v.
    #[must_use]
    pub fn finish(self) -> (HalfEdges, Vec<[u32; 2]>) {
        (self.fine, self.ends)
    }

    /// Numbers the vertices of the finer surface at an old vertex and on its edges.
    fn number(&mut self, coarse: &HalfEdges, v: u32) {
        if !coarse.has_vertex(v) {
            return;
        }
        self.kept[v as usize] = self.add([v, NONE]);
        for h in coarse.around(v) {
            if self.rank[h as usize / 3] == NONE {
                self.rank[h as usize / 3] = self.ranked;
                self.ranked += 1;
            }
            if self.middle[h as usize] == 0 {
                let m = self.add([v, coarse.target(h)]);
                self.middle[h as usize] = m;
                if coarse.twin(h) != NONE {
                    self.middle[coarse.twin(h) as usize] = m;
                }
            }
        }
    }

    /// Adds a vertex of the finer surface.
    fn add(&mut self, ends: [u32; 2]) -> u32 {
        self.ends.push(ends);
        self.fine.outgoing.push(NONE);
        self.ends.len() as u32 - 1
    }

    /// First half-edge of the new face at the corner of an old face at which `h` begins.
    fn corner(&self, h: u32) -> u32 {
        3 * (4 * self.rank[h as usize / 3] + h % 3)
    }

    /// Writes the four faces of the old face `f`: the face at a corner begins with the first half
    /// of the half-edge that leaves the corner, and the last one lies in the middle.
    fn write(&mut self, coarse: &HalfEdges, f: u32) {
        if !coarse.has_half_edge(3 * f) {
            return;
        }
        let inner = 3 * (4 * self.rank[f as usize] + 3);
        for k in 0..3 {
            let h = 3 * f + k;
            let (here, before) = (self.corner(h) as usize, 3 * f + (k + 2) % 3);
            let (v, m) = (self.kept[coarse.origin(h) as usize], self.middle[h as usize]);
            self.fine.origin[here..here + 3].copy_from_slice(&[v, m, self.middle[before as usize]]);
            // The inner face begins at the middle of half-edge 0; the edge that cuts off corner k
            // ends there.
            let across = inner + (k + 2) % 3;
            self.fine.origin[(inner + k) as usize] = m;
            self.fine.twin[here + 1] = across;
            self.fine.twin[across as usize] = here as u32 + 1;
            let second = self.corner(next(h)) + 2;
            let twin = coarse.twin(h);
            // The twin of each half of the edge is the other half of the twin edge.
            let beside =
                if twin == NONE { [NONE; 2] } else { [self.corner(next(twin)) + 2, self.corner(twin)] };
            [self.fine.twin[here], self.fine.twin[second as usize]] = beside;
            if h < twin {
                self.fine.outgoing[m as usize] = second;
            }
            if coarse.outgoing(coarse.origin(h)) == h {
                self.fine.outgoing[v as usize] = here as u32;
            }
        }
    }
}
