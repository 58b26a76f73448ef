//! Local operations, and a journal that can undo them.

use super::{Change, HalfEdges, next, previous};
use crate::math::{NONE, grow};

impl HalfEdges {
    /// Begins a journal: every change from now on can be undone by [`HalfEdges::undo`]. An earlier
    /// journal is dropped.
    pub fn begin(&mut self) {
        self.journal.clear();
        self.is_recording = true;
    }

    /// Keeps the changes of the journal and ends it.
    pub fn keep(&mut self) {
        self.journal.clear();
        self.is_recording = false;
    }

    /// Undoes every change since [`HalfEdges::begin`], down to the numbering, and ends the journal.
    pub fn undo(&mut self) {
        self.is_recording = false;
        while let Some(change) = self.journal.pop() {
            match change {
                Change::Origin(h, old) => self.origin[h as usize] = old,
                Change::Twin(h, old) => self.twin[h as usize] = old,
                Change::Outgoing(v, old) => self.outgoing[v as usize] = old,
                Change::FaceFreed => {
                    self.free_faces.pop();
                }
                Change::FaceTaken(f) => self.free_faces.push(f),
                Change::FaceAdded => {
                    self.origin.truncate(self.origin.len() - 3);
                    self.twin.truncate(self.origin.len());
                }
                Change::VertexFreed => {
                    self.free_vertices.pop();
                }
                Change::VertexTaken(v) => self.free_vertices.push(v),
                Change::VertexAdded => {
                    self.outgoing.pop();
                }
            }
        }
    }

    /// Whether the edge of `h` can be flipped: it has two faces, and the vertices across are not
    /// yet neighbours. Both ends then keep at least three faces, because around an inner vertex
    /// with three faces all neighbours are neighbours of each other.
    #[must_use]
    pub fn can_flip(&self, h: u32) -> bool {
        let t = self.twin(h);
        if t == NONE {
            return false;
        }
        let (c, d) = (self.origin(previous(h)), self.origin(previous(t)));
        c != d && !self.is_adjacent(c, d)
    }

    /// Flips the edge of `h`: its two faces get the other diagonal of their quadrilateral. `h` then
    /// runs from the vertex opposite its twin to the one opposite itself.
    ///
    /// # Panics
    ///
    /// If `h` lies on the border. The surface stays valid only if [`HalfEdges::can_flip`].
    pub fn flip(&mut self, h: u32) {
        let t = self.twin(h);
        assert!(t != NONE, "an edge at the border cannot be flipped");
        let (h1, h2, t1, t2) = (next(h), previous(h), next(t), previous(t));
        let (a, b, c, d) = (self.origin(h), self.origin(t), self.origin(h2), self.origin(t2));
        let (bc, ca, ad, db) = (self.twin(h1), self.twin(h2), self.twin(t1), self.twin(t2));
        // Each vertex keeps a half-edge to the same neighbour, which stays the first of its fan.
        for (v, old, new) in [(b, h1, t2), (c, h2, h1), (a, t1, h2), (d, t2, t1)] {
            if self.outgoing(v) == old {
                self.set_outgoing(v, new);
            }
        }
        if self.outgoing(a) == h {
            self.set_outgoing(a, h2);
        }
        if self.outgoing(b) == t {
            self.set_outgoing(b, t2);
        }
        for (half_edge, v) in [(h, d), (h1, c), (h2, a), (t, c), (t1, d), (t2, b)] {
            self.set_origin(half_edge, v);
        }
        self.join(h1, ca);
        self.join(h2, ad);
        self.join(t1, db);
        self.join(t2, bc);
    }

    /// Inserts a new vertex into the face of `h`, which becomes three faces, and returns its
    /// number.
    pub fn insert(&mut self, h: u32) -> u32 {
        let (h1, h2) = (next(h), previous(h));
        let (a, b, c) = (self.origin(h), self.origin(h1), self.origin(h2));
        let (bc, ca) = (self.twin(h1), self.twin(h2));
        let v = self.take_vertex();
        let (p, q) = (self.take_face(), self.take_face());
        self.set_face(p, [b, c, v]);
        self.set_face(q, [c, a, v]);
        self.set_origin(h2, v);
        self.join(p, bc);
        self.join(q, ca);
        self.join(h1, p + 2);
        self.join(h2, q + 1);
        self.join(p + 1, q + 2);
        if self.outgoing(b) == h1 {
            self.set_outgoing(b, p);
        }
        if self.outgoing(c) == h2 {
            self.set_outgoing(c, q);
        }
        self.set_outgoing(v, h2);
        v
    }

    /// Splits the edge of `h` by a new vertex and returns its number; each face of the edge becomes
    /// two.
    pub fn split(&mut self, h: u32) -> u32 {
        let t = self.twin(h);
        let (h1, h2) = (next(h), previous(h));
        let (a, b, c) = (self.origin(h), self.origin(h1), self.origin(h2));
        let bc = self.twin(h1);
        let m = self.take_vertex();
        let p = self.take_face();
        self.set_face(p, [m, b, c]);
        self.set_origin(h1, m);
        self.join(p + 1, bc);
        self.join(p + 2, h1);
        self.set_outgoing(m, p);
        if self.outgoing(b) == h1 {
            self.set_outgoing(b, p + 1);
        }
        if t == NONE {
            self.set_twin(p, NONE);
            return m;
        }
        let (t1, d) = (next(t), self.origin(previous(t)));
        let ad = self.twin(t1);
        let q = self.take_face();
        self.set_face(q, [m, a, d]);
        self.set_origin(t1, m);
        self.join(q + 1, ad);
        self.join(q + 2, t1);
        self.join(q, h);
        self.join(p, t);
        if self.outgoing(a) == t1 {
            self.set_outgoing(a, q + 1);
        }
        m
    }

    /// Whether the edge of `h` can be collapsed without a change of topology. The two ends have no
    /// common neighbours except those opposite the edge, which keep at least three faces (one, at
    /// the border); and a border vertex moves only along the border.
    #[must_use]
    pub fn can_collapse(&self, h: u32) -> bool {
        let t = self.twin(h);
        let (a, b) = (self.origin(h), self.target(h));
        let c = self.origin(previous(h));
        let d = if t == NONE { NONE } else { self.origin(previous(t)) };
        if t != NONE && self.is_border(a) {
            return false;
        }
        if self.neighbours(a).any(|v| v != c && v != d && v != b && self.is_adjacent(v, b)) {
            return false;
        }
        let keeps = |v: u32| {
            let least = if self.is_border(v) { 2 } else { 4 };
            self.around(v).nth(least - 1).is_some()
        };
        // Faces that both ends need together, so that the remaining one has three, or one at the
        // border.
        let least = match (t, self.is_border(b)) {
            (NONE, _) => 3,
            (_, true) => 5,
            (_, false) => 7,
        };
        keeps(c) && (t == NONE || keeps(d)) && self.around(a).count() + self.around(b).count() >= least
    }

    /// Removes the vertex at which `h` begins: its faces are handed to the one at which `h` ends,
    /// except the two at the edge. Returns the remaining vertex.
    ///
    /// The surface stays valid only if [`HalfEdges::can_collapse`].
    pub fn collapse(&mut self, h: u32) -> u32 {
        let t = self.twin(h);
        let (a, b) = (self.origin(h), self.target(h));
        let mut at = self.outgoing(a);
        let first = at;
        // The walk reads twins and origins of half-edges that end at `a`, which do not change here.
        loop {
            self.set_origin(at, b);
            let left = self.twin(previous(at));
            if left == NONE || left == first {
                break;
            }
            at = left;
        }
        let b_side = self.close(h, b);
        let d_side = if t == NONE { NONE } else { self.close(t, b) };
        let from_b = if b_side == NONE { d_side } else { b_side };
        self.set_outgoing(b, self.first_of_fan(from_b));
        self.set_outgoing(a, NONE);
        self.free_vertices.push(a);
        self.record(Change::VertexFreed);
        b
    }

    /// Removes the face of `h`, whose edge no longer has a length, and joins its two other sides.
    /// Returns a half-edge that leaves `b`, at the end of `h`.
    fn close(&mut self, h: u32, b: u32) -> u32 {
        let (h1, h2) = (next(h), previous(h));
        let c = self.origin(h2);
        let (x1, x2) = (self.twin(h1), self.twin(h2));
        for half_edge in [h, h1, h2] {
            self.set_origin(half_edge, NONE);
            self.set_twin(half_edge, NONE);
        }
        self.free_faces.push(h / 3);
        self.record(Change::FaceFreed);
        if x1 != NONE {
            self.set_twin(x1, x2);
        }
        if x2 != NONE {
            self.set_twin(x2, x1);
        }
        // x1 leaves c, x2 leaves b, and each is followed by one that leaves the other.
        let leaving = |own: u32, other: u32| match (own, other) {
            (NONE, NONE) => NONE,
            (NONE, other) => next(other),
            (own, _) => own,
        };
        let (from_c, from_b) = (leaving(x1, x2), leaving(x2, x1));
        if from_c != NONE {
            let first = self.first_of_fan(from_c);
            self.set_outgoing(c, first);
        }
        debug_assert!(from_b == NONE || self.origin(from_b) == b, "the walk ends at the vertex that is left");
        from_b
    }

    /// Makes two half-edges twins; the second may be [`NONE`].
    fn join(&mut self, g: u32, h: u32) {
        self.set_twin(g, h);
        if h != NONE {
            self.set_twin(h, g);
        }
    }

    fn set_face(&mut self, first: u32, corners: [u32; 3]) {
        for (h, v) in (first..).zip(corners) {
            self.set_origin(h, v);
        }
    }

    fn record(&mut self, change: Change) {
        if self.is_recording {
            self.journal.push(change);
        }
    }

    fn set_origin(&mut self, h: u32, v: u32) {
        let old = core::mem::replace(&mut self.origin[h as usize], v);
        self.record(Change::Origin(h, old));
    }

    fn set_twin(&mut self, h: u32, twin: u32) {
        let old = core::mem::replace(&mut self.twin[h as usize], twin);
        self.record(Change::Twin(h, old));
    }

    fn set_outgoing(&mut self, v: u32, h: u32) {
        let old = core::mem::replace(&mut self.outgoing[v as usize], h);
        self.record(Change::Outgoing(v, old));
    }

    /// A free vertex number, a new one if necessary.
    fn take_vertex(&mut self) -> u32 {
        if let Some(v) = self.free_vertices.pop() {
            self.record(Change::VertexTaken(v));
            return v;
        }
        let v = self.outgoing.len();
        grow(&mut self.outgoing, v + 1, NONE);
        self.record(Change::VertexAdded);
        v as u32
    }

    /// The first half-edge of a free face, of a new one if necessary.
    fn take_face(&mut self) -> u32 {
        if let Some(f) = self.free_faces.pop() {
            self.record(Change::FaceTaken(f));
            return 3 * f;
        }
        let h = self.origin.len();
        grow(&mut self.origin, h + 3, NONE);
        grow(&mut self.twin, h + 3, NONE);
        self.record(Change::FaceAdded);
        h as u32
    }
}
