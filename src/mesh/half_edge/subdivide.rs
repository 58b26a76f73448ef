//! Subdivision of every face into four, with a new vertex on the middle of every edge.

use super::{HalfEdges, NONE, next};

/// The stages of a subdivision, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Make room for the finer surface.
    Room,
    /// Number the vertices of the finer surface.
    Vertices,
    /// Write the faces of the finer surface.
    Faces,
    /// The subdivision is complete.
    Done,
}

/// A subdivision under way: it can be left and gone on with.
///
/// Old vertices keep their valence and new ones have six neighbours, four on the border: a subdivision adds no defect. A vertex is
/// followed by the middles of those of its edges that no earlier vertex has, so that what is near on the surface stays near in
/// memory, level after level.
#[derive(Clone, Debug)]
pub struct Subdivision {
    fine: HalfEdges,
    ends: Vec<[u32; 2]>,
    /// Vertex of the finer surface at each old one.
    kept: Vec<u32>,
    /// Vertex of the finer surface on the middle of each old half-edge.
    middle: Vec<u32>,
    /// Place of each old face among those that are there.
    rank: Vec<u32>,
    ranked: u32,
    stage: Stage,
    next: u32,
}

impl Subdivision {
    /// Begins to subdivide `coarse`, which must stay as it is until the end.
    #[must_use]
    pub fn new(coarse: &HalfEdges) -> Self {
        let (faces, vertices) = (coarse.faces(), coarse.vertex_slots());
        let slots = coarse.half_edge_slots();
        // A closed surface has half as many edges as half-edges; a border adds a few, for which there is room to grow.
        let expected = vertices + 3 * faces / 2;
        let fine = HalfEdges {
            origin: Vec::with_capacity(12 * faces),
            twin: Vec::with_capacity(12 * faces),
            outgoing: Vec::with_capacity(expected),
            ..HalfEdges::default()
        };
        Self {
            fine,
            ends: Vec::with_capacity(expected),
            kept: Vec::with_capacity(vertices),
            middle: Vec::with_capacity(slots),
            rank: Vec::with_capacity(slots / 3),
            ranked: 0,
            stage: Stage::Room,
            next: 0,
        }
    }

    /// The stage of the subdivision.
    #[must_use]
    pub fn stage(&self) -> Stage {
        self.stage
    }

    /// Goes on with up to `budget` vertices or faces of `coarse`, and returns what is left of it.
    pub fn step(&mut self, coarse: &HalfEdges, mut budget: u32) -> u32 {
        while budget > 0 && self.stage != Stage::Done {
            let vertices = coarse.vertex_slots() as u32;
            let faces = (coarse.half_edge_slots() / 3) as u32;
            let slots = match self.stage {
                Stage::Room => vertices.max(faces),
                Stage::Vertices => vertices,
                Stage::Faces | Stage::Done => faces,
            };
            let end = slots.min(self.next.saturating_add(budget));
            if self.stage == Stage::Room {
                self.make_room(coarse, end as usize);
            }
            for at in self.next..end {
                match self.stage {
                    Stage::Vertices => self.number(coarse, at),
                    Stage::Faces => self.write(coarse, at),
                    Stage::Room | Stage::Done => {}
                }
            }
            budget -= end - self.next;
            self.next = end;
            if end == slots {
                self.next = 0;
                self.stage = match self.stage {
                    Stage::Room => Stage::Vertices,
                    Stage::Vertices => Stage::Faces,
                    Stage::Faces | Stage::Done => Stage::Done,
                };
            }
        }
        budget
    }

    /// Fills the columns up to vertex or face `end` of `coarse`: memory that is first touched takes longer than what is then done
    /// with it.
    fn make_room(&mut self, coarse: &HalfEdges, end: usize) {
        self.kept.resize(coarse.vertex_slots().min(end), NONE);
        let end = (coarse.half_edge_slots() / 3).min(end);
        self.rank.resize(end, NONE);
        self.middle.resize(3 * end, NONE);
        let fine = (12 * end).min(12 * coarse.faces());
        self.fine.origin.resize(fine, NONE);
        self.fine.twin.resize(fine, NONE);
    }

    /// The finer surface, and for each of its vertices the two ends of the edge that it halves; `[v, NONE]` where it is the old
    /// vertex v.
    ///
    /// # Panics
    ///
    /// If the subdivision is not complete.
    #[must_use]
    pub fn finish(self) -> (HalfEdges, Vec<[u32; 2]>) {
        assert!(self.stage == Stage::Done, "the subdivision is not at its end");
        (self.fine, self.ends)
    }

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
            if self.middle[h as usize] == NONE {
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

    /// Writes the four faces of the old face `f`: the face at a corner begins with the first half of the half-edge that leaves the
    /// corner, and the last one lies in the middle.
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
            // The inner face begins at the middle of half-edge 0; the edge that cuts corner k off ends there.
            let across = inner + (k + 2) % 3;
            self.fine.origin[(inner + k) as usize] = m;
            self.fine.twin[here + 1] = across;
            self.fine.twin[across as usize] = here as u32 + 1;
            let second = self.corner(next(h)) + 2;
            let twin = coarse.twin(h);
            if twin != NONE {
                // Each half of the edge lies beside the other half of the twin.
                self.fine.twin[here] = self.corner(next(twin)) + 2;
                self.fine.twin[second as usize] = self.corner(twin);
            }
            if h < twin {
                self.fine.outgoing[m as usize] = second;
            }
            if coarse.outgoing(coarse.origin(h)) == h {
                self.fine.outgoing[v as usize] = here as u32;
            }
        }
    }
}
