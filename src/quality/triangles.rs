//! Triangles of natural neighbours that their corners agree on, and what they add up to.

use super::fans::Fans;
use crate::spatial::tree::{key, unkey};
use glam::{DVec3, Vec3};

/// The triangles of a set of points; indices in tree order, counter-clockwise round the normal of the first corner.
#[derive(Debug)]
pub(super) struct Triangles {
    /// Kept triangles: at least two of their three corners see them. All three do for the first `unanimous` ones.
    pub(super) kept: Vec<[u32; 3]>,
    /// Number of triangles that all three corners see.
    pub(super) unanimous: usize,
    /// Triangles that one corner alone sees.
    pub(super) single: Vec<[u32; 3]>,
}

impl Triangles {
    /// Counts, for each triangle that a corner sees, how many of its corners do.
    pub(super) fn new(fans: &Fans) -> Self {
        let mut kept = Vec::with_capacity(2 * fans.len());
        let (mut majority, mut single) = (Vec::new(), Vec::new());
        for i in 0..fans.len() {
            for (a, b) in fans.pairs(i) {
                let (by_a, by_b) = (fans.sees(a, b, i), fans.sees(b, i, a));
                // The smallest corner that sees a triangle accounts for it.
                if by_a && a < i || by_b && b < i {
                    continue;
                }
                let triangle = [i as u32, a as u32, b as u32];
                match u8::from(by_a) + u8::from(by_b) {
                    2 => kept.push(triangle),
                    1 => majority.push(triangle),
                    _ => single.push(triangle),
                }
            }
        }
        let unanimous = kept.len();
        kept.extend(majority);
        Self { kept, unanimous, single }
    }

    /// The kept triangles with the quarrels settled: no directed edge belongs to two of them.
    ///
    /// Four nearly cocircular points may each prefer another diagonal, since each sees the others in its own tangent
    /// plane. When two stand against two, the kept triangles overlap or leave a gap. Here the undisputed ones stay; the
    /// others follow, those with short edges first, if their directed edges are free; then those that one
    /// corner alone sees, if at least two of their sides are still open.
    pub(super) fn settled(&self, position: &[Vec3]) -> Vec<[u32; 3]> {
        let majority = &self.kept[self.unanimous..];
        let mut mesh = self.kept[..self.unanimous].to_vec();
        if majority.is_empty() && self.single.is_empty() {
            return mesh;
        }
        // Only edges between corners of disputed triangles can matter.
        let mut hot = vec![false; position.len()];
        for &i in majority.iter().chain(&self.single).flatten() {
            hot[i as usize] = true;
        }
        let between = |&(a, b): &(u32, u32)| hot[a as usize] && hot[b as usize];
        let undisputed =
            || self.kept[..self.unanimous].iter().flat_map(|&triangle| sides(triangle)).filter(between);
        let mut taken = Sides::new(undisputed().count() + 3 * (majority.len() + self.single.len()));
        undisputed().for_each(|side| taken.insert(side));
        let longest = |triangle: [u32; 3]| {
            sides(triangle)
                .map(|(a, b)| (position[a as usize] - position[b as usize]).length_squared())
                .into_iter()
                .fold(0.0, f32::max)
        };
        for (disputed, needed) in [(majority, 0), (&self.single[..], 2)] {
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
