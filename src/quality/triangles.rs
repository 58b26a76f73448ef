//! Triangles of natural neighbours that their corners agree on, and what they add up to.

use super::fans::Fans;
use crate::pieces::{piece, ranges};
use crate::spatial::tree::{key, unkey};
use glam::{DVec3, Vec3};

/// Points whose triangles are found in one piece of work.
const PIECE: usize = 64;

/// The triangles of a set of points; indices in tree order, counter-clockwise round the normal of the first corner.
#[derive(Debug, Default)]
pub(super) struct Triangles {
    /// Those that all three corners see.
    pub(super) unanimous: Vec<[u32; 3]>,
    /// Those that two of the three corners see.
    pub(super) majority: Vec<[u32; 3]>,
    /// Those that one corner alone sees.
    pub(super) single: Vec<[u32; 3]>,
}

impl Triangles {
    /// Counts, for each triangle that a corner sees, how many of its corners do.
    pub(super) async fn new(fans: &Fans) -> Self {
        let mut triangles = Self { unanimous: Vec::with_capacity(2 * fans.len()), ..Self::default() };
        for range in ranges(fans.len(), PIECE) {
            range.for_each(|i| triangles.add(fans, i));
            piece().await;
        }
        triangles
    }

    /// Adds the triangles that point `i` accounts for: those of which it is the smallest corner that sees them.
    fn add(&mut self, fans: &Fans, i: usize) {
        for (a, b) in fans.pairs(i) {
            let (by_a, by_b) = (fans.sees(a, b, i), fans.sees(b, i, a));
            if by_a && a < i || by_b && b < i {
                continue;
            }
            let list = match u8::from(by_a) + u8::from(by_b) {
                2 => &mut self.unanimous,
                1 => &mut self.majority,
                _ => &mut self.single,
            };
            list.push([i as u32, a as u32, b as u32]);
        }
    }

    /// The triangles that count: at least two of their three corners see them.
    pub(super) fn kept(&self) -> impl Iterator<Item = &[u32; 3]> {
        self.unanimous.iter().chain(&self.majority)
    }

    /// The kept triangles with the quarrels settled: no directed edge belongs to two of them.
    ///
    /// Four nearly cocircular points may each prefer another diagonal, since each sees the others in its own tangent
    /// plane. When two stand against two, the kept triangles overlap or leave a gap. Here the undisputed ones stay; the
    /// others follow, those with short edges first, if their directed edges are free; then those that one
    /// corner alone sees, if at least two of their sides are still open.
    pub(super) fn settled(&self, position: &[Vec3]) -> Vec<[u32; 3]> {
        let mut mesh = self.unanimous.clone();
        if self.majority.is_empty() && self.single.is_empty() {
            return mesh;
        }
        // Only edges between corners of disputed triangles can matter.
        let mut hot = vec![false; position.len()];
        for &i in self.majority.iter().chain(&self.single).flatten() {
            hot[i as usize] = true;
        }
        let between = |&(a, b): &(u32, u32)| hot[a as usize] && hot[b as usize];
        let undisputed = || self.unanimous.iter().flat_map(|&triangle| sides(triangle)).filter(between);
        let mut taken = Sides::new(undisputed().count() + 3 * (self.majority.len() + self.single.len()));
        undisputed().for_each(|side| taken.insert(side));
        let longest = |triangle: [u32; 3]| {
            sides(triangle)
                .map(|(a, b)| (position[a as usize] - position[b as usize]).length_squared())
                .into_iter()
                .fold(0.0, f32::max)
        };
        for (disputed, needed) in [(&self.majority, 0), (&self.single, 2)] {
            let mut order: Vec<u64> =
                disputed.iter().enumerate().map(|(k, &triangle)| key(longest(triangle), k as u32)).collect();
            order.sort_unstable();
            for next in order {
                let triangle = disputed[unkey(next).1 as usize];
                let sides = sides(triangle);
                let open = sides.iter().filter(|&&(a, b)| taken.contains((b, a))).count();
                if open >= needed && !sides.iter().any(|&side| taken.contains(side)) {
                    sides.into_iter().for_each(|side| taken.insert(side));
                    mesh.push(triangle);
                }
            }
        }
        mesh
    }
}

/// A set of directed edges.
struct Sides {
    /// Open addressing, at most half full.
    slots: Vec<(u32, u32)>,
}

impl Sides {
    /// No edge goes from a point to itself.
    const EMPTY: (u32, u32) = (u32::MAX, u32::MAX);

    /// A set with room for `most` edges.
    fn new(most: usize) -> Self {
        Self { slots: vec![Self::EMPTY; (2 * most + 1).next_power_of_two()] }
    }

    /// The slot of `side`, or the empty one where it would go.
    fn slot(&self, side: (u32, u32)) -> usize {
        let mask = self.slots.len() - 1;
        let mixed = (u64::from(side.0) << 32 | u64::from(side.1)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let mut slot = (mixed >> 32) as usize & mask;
        while self.slots[slot] != side && self.slots[slot] != Self::EMPTY {
            slot = (slot + 1) & mask;
        }
        slot
    }

    fn contains(&self, side: (u32, u32)) -> bool {
        self.slots[self.slot(side)] == side
    }

    fn insert(&mut self, side: (u32, u32)) {
        let slot = self.slot(side);
        self.slots[slot] = side;
    }
}

/// The directed edges of a triangle.
fn sides([a, b, c]: [u32; 3]) -> [(u32, u32); 3] {
    [(a, b), (b, c), (c, a)]
}

/// Twice the area vector of a triangle.
pub(super) fn area_vector(position: &[Vec3], [a, b, c]: [u32; 3]) -> DVec3 {
    let a = position[a as usize].as_dvec3();
    (position[b as usize].as_dvec3() - a).cross(position[c as usize].as_dvec3() - a)
}

/// Euler number of a set of triangles over `points` points; points in no triangle do not count.
pub(super) fn topology(points: usize, triangles: &[[u32; 3]]) -> i64 {
    // Each edge is written once, by its smaller end; the lists are short, so a linear look is enough.
    let mut start = vec![0_u32; points + 1];
    for triangle in triangles {
        for k in 0..3 {
            start[triangle[k].min(triangle[(k + 1) % 3]) as usize + 1] += 1;
        }
    }
    for i in 0..points {
        start[i + 1] += start[i];
    }
    let mut fill: Vec<u32> = start[..points].to_vec();
    let mut other = vec![0_u32; 3 * triangles.len()];
    let mut edges = 0_i64;
    let mut used = vec![false; points];
    for triangle in triangles {
        for k in 0..3 {
            let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
            let (a, b) = (a.min(b), a.max(b));
            let list = start[a as usize] as usize..fill[a as usize] as usize;
            if !other[list].contains(&b) {
                other[fill[a as usize] as usize] = b;
                fill[a as usize] += 1;
                edges += 1;
            }
            used[a as usize] = true;
            used[b as usize] = true;
        }
    }
    let vertices = used.iter().filter(|&&used| used).count();
    vertices as i64 - edges + triangles.len() as i64
}

/// Representative of `i`, halving the path to it.
pub(super) fn find(root: &mut [u32], mut i: u32) -> u32 {
    while root[i as usize] != i {
        root[i as usize] = root[root[i as usize] as usize];
        i = root[i as usize];
    }
    i
}
