//! The edges of a mesh, and the faces that meet at each.

use crate::math::sort_by_key;

/// A side of a face: from its corner `side` to the next one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Side {
    pub(super) face: u32,
    pub(super) side: u32,
}

/// The sides of all faces, sorted so that the sides of one edge are adjacent.
pub(super) struct Edges {
    sides: Vec<Side>,
    /// Where each edge begins in `sides`, and the end.
    first: Vec<u32>,
    /// The ends of each edge, the smaller one first.
    ends: Vec<[u32; 2]>,
    /// The edge at each side of each face.
    of_face: Vec<[u32; 3]>,
}

/// The ends of a side, in the order in which its face lists them.
pub(super) fn ends_of(face: &[u32; 3], side: u32) -> [u32; 2] {
    [face[side as usize], face[(side as usize + 1) % 3]]
}

impl Edges {
    pub(super) fn new(faces: &[[u32; 3]]) -> Self {
        let mut sides: Vec<Side> = Vec::with_capacity(3 * faces.len());
        sides.extend((0..faces.len() as u32).flat_map(|face| (0..3).map(move |side| Side { face, side })));
        let key = |at: &Side| {
            let [a, b] = ends_of(&faces[at.face as usize], at.side);
            u64::from(a.min(b)) << 32 | u64::from(a.max(b))
        };
        sort_by_key(&mut sides, key);
        let (mut first, mut ends) = (Vec::new(), Vec::new());
        let mut of_face = vec![[0; 3]; faces.len()];
        let mut at = 0;
        for own in sides.chunk_by(|a, b| key(a) == key(b)) {
            for side in own {
                of_face[side.face as usize][side.side as usize] = ends.len() as u32;
            }
            first.push(at);
            at += own.len() as u32;
            ends.push([(key(&own[0]) >> 32) as u32, key(&own[0]) as u32]);
        }
        first.push(at);
        Self { sides, first, ends, of_face }
    }

    pub(super) fn len(&self) -> usize {
        self.ends.len()
    }

    /// The sides at an edge, in the order of their faces.
    pub(super) fn sides(&self, edge: usize) -> &[Side] {
        &self.sides[self.first[edge] as usize..self.first[edge + 1] as usize]
    }

    pub(super) fn ends(&self, edge: usize) -> [u32; 2] {
        self.ends[edge]
    }

    /// The edges at the three sides of a face.
    pub(super) fn of_face(&self, face: u32) -> [u32; 3] {
        self.of_face[face as usize]
    }

    /// The number of edges whose number of sides satisfies `is_meant`.
    pub(super) fn count(&self, is_meant: impl Fn(usize) -> bool) -> usize {
        (0..self.len()).filter(|&edge| is_meant(self.sides(edge).len())).count()
    }
}
