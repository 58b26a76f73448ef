//! Construction of half-edges from a list of triangles.

use super::{HalfEdges, next};
use crate::math::NONE;

impl HalfEdges {
    /// The surface of some triangles over `vertices` vertices, counter-clockwise seen from outside.
    /// Face `f` is triangle `f`. None if they are not an oriented surface: a corner does not exist
    /// or is repeated, two triangles run along the same edge in the same direction, or those at a
    /// vertex form more than one fan.
    ///
    /// Vertices in no triangle have no half-edge. Edges of one triangle form the border.
    ///
    /// Cost: linear, and n log n if a vertex has very many triangles.
    #[must_use]
    pub fn from_triangles(vertices: usize, triangles: &[[u32; 3]]) -> Option<Self> {
        let is_triangle = |&[a, b, c]: &[u32; 3]| {
            a != b && b != c && c != a && [a, b, c].iter().all(|&v| (v as usize) < vertices)
        };
        if !triangles.iter().all(is_triangle) {
            return None;
        }
        let origin: Vec<u32> = triangles.iter().flatten().copied().collect();
        let mut mesh = Self {
            twin: vec![NONE; origin.len()],
            outgoing: vec![NONE; vertices],
            origin,
            ..Self::default()
        };
        (mesh.pair() && mesh.choose_outgoing()).then_some(mesh)
    }

    /// Finds the twins: each half-edge is sorted into the bucket of its smaller end, and within it
    /// by the larger end. Returns whether no two of them run between the same vertices in the same
    /// direction.
    fn pair(&mut self) -> bool {
        let mut start = vec![0_u32; self.outgoing.len() + 1];
        let ends = |mesh: &Self, h: u32| {
            let (a, b) = (mesh.origin(h), mesh.target(h));
            (a.min(b), a.max(b))
        };
        let half_edges = self.origin.len() as u32;
        for h in 0..half_edges {
            start[ends(self, h).0 as usize + 1] += 1;
        }
        for v in 0..self.outgoing.len() {
            start[v + 1] += start[v];
        }
        let mut fill = start.clone();
        // The larger end in the high bits, the half-edge in the low ones.
        let mut buckets = vec![0_u64; self.origin.len()];
        for h in 0..half_edges {
            let (low, high) = ends(self, h);
            buckets[fill[low as usize] as usize] = u64::from(high) << 32 | u64::from(h);
            fill[low as usize] += 1;
        }
        for range in start.windows(2) {
            let bucket = &mut buckets[range[0] as usize..range[1] as usize];
            bucket.sort_unstable();
            for at in 1..bucket.len() {
                if bucket[at - 1] >> 32 != bucket[at] >> 32 {
                    continue;
                }
                let (g, h) = (bucket[at - 1] as u32, bucket[at] as u32);
                let is_third = self.twin(g) != NONE;
                if is_third || self.origin(g) == self.origin(h) {
                    return false;
                }
                self.twin[g as usize] = h;
                self.twin[h as usize] = g;
            }
        }
        true
    }

    /// Chooses the half-edge stored for each vertex. Returns whether the faces of each vertex form
    /// one fan.
    fn choose_outgoing(&mut self) -> bool {
        let mut faces_at = vec![0_usize; self.outgoing.len()];
        for h in 0..self.origin.len() as u32 {
            let v = self.origin(h) as usize;
            faces_at[v] += 1;
            if self.outgoing[v] == NONE || self.twin(h) == NONE {
                self.outgoing[v] = h;
            }
        }
        (0..).zip(faces_at).all(|(v, faces)| self.around(v).take(faces + 1).count() == faces)
    }

    /// The first half-edge of a fan, of which `h` is one that leaves the vertex: the one without a
    /// twin, or `h` itself.
    pub(super) fn first_of_fan(&self, h: u32) -> u32 {
        let mut at = h;
        loop {
            let twin = self.twin(at);
            if twin == NONE {
                return at;
            }
            at = next(twin);
            if at == h {
                return h;
            }
        }
    }
}
