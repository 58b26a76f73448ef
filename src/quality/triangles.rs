//! Triangles of natural neighbours that their corners agree on, and the figures of their angles.
//!
//! Doubtful triangles are left out. [`crate::mesh::triangulation`] makes one manifold from the same
//! stars and fills such places, which must not make the surface look closed here.

use super::figures::Angles;
use super::moments::{Moments, share};
use crate::math::{IndexTable, SQRT_3, hash, key, unkey};
use crate::mesh::stars::Stars;
use crate::slices::{self, MEDIUM};
use glam::{DVec3, Vec3};

/// The triangles of a set of points, as indices in tree order, counter-clockwise around the normal
/// of the first corner.
#[derive(Debug, Default)]
pub(super) struct Triangles {
    /// Triangles that all three corners see.
    pub(super) unanimous: Vec<[u32; 3]>,
    /// Triangles that two of the three corners see.
    pub(super) majority: Vec<[u32; 3]>,
    /// Triangles that only one corner sees.
    pub(super) single: Vec<[u32; 3]>,
}

impl Triangles {
    /// Counts, for each triangle that a corner sees, how many of its corners do.
    pub(super) async fn new(stars: &Stars) -> Self {
        let parts = slices::map(
            stars.len(),
            MEDIUM,
            || (),
            |(), range| {
                let mut part = Self::default();
                range.for_each(|i| part.add(stars, i as u32));
                part
            },
        );
        let mut triangles = Self { unanimous: Vec::with_capacity(2 * stars.len()), ..Self::default() };
        for mut part in parts.await {
            triangles.unanimous.append(&mut part.unanimous);
            triangles.majority.append(&mut part.majority);
            triangles.single.append(&mut part.single);
        }
        triangles
    }

    /// The triangles of a mesh: those that all corners see are unanimous, and the others count as
    /// majority.
    pub(super) fn seen(stars: &Stars, mesh: &[[u32; 3]]) -> Self {
        let is_seen =
            |&[a, b, c]: &[u32; 3]| stars.sees(a, b, c) && stars.sees(b, c, a) && stars.sees(c, a, b);
        let (unanimous, majority) = mesh.iter().partition(|triangle| is_seen(triangle));
        Self { unanimous, majority, single: Vec::new() }
    }

    /// Adds the triangles for which `i` is the smallest corner that sees them, so that each is
    /// added once.
    fn add(&mut self, stars: &Stars, i: u32) {
        let range = stars.range(i as usize);
        for entry in range.clone() {
            let a = stars.neighbour(entry);
            let Some(b) = stars.next(&range, entry) else { continue };
            let by_a = stars.sees(a, b, i);
            if by_a && a < i {
                continue;
            }
            let by_b = stars.sees(b, i, a);
            if by_b && b < i {
                continue;
            }
            let list = match u8::from(by_a) + u8::from(by_b) {
                2 => &mut self.unanimous,
                1 => &mut self.majority,
                _ => &mut self.single,
            };
            list.push([i, a, b]);
        }
    }

    /// Returns the triangles that count: those that at least two of their three corners see.
    pub(super) fn kept(&self) -> impl Iterator<Item = &[u32; 3]> {
        self.unanimous.iter().chain(&self.majority)
    }

    /// Returns triangles without conflicts: no directed edge belongs to two of them.
    ///
    /// Four nearly cocircular points may disagree about the diagonal, because each sees the others
    /// in its own tangent plane. Where two of them disagree with the other two, the triangles that
    /// count overlap or leave a gap. Here the unanimous triangles stay. Those of a majority follow,
    /// in the order of their longest edge, if their directed edges are free; then those that only
    /// one corner sees, if at least two of their sides are still open.
    pub(super) fn settled(&self, position: &[Vec3]) -> Vec<[u32; 3]> {
        let mut mesh = self.unanimous.clone();
        if self.majority.is_empty() && self.single.is_empty() {
            return mesh;
        }
        // Only edges between corners of disputed triangles can be in conflict.
        let mut hot = vec![false; position.len()];
        for &i in self.majority.iter().chain(&self.single).flatten() {
            hot[i as usize] = true;
        }
        let between = |&(a, b): &(u32, u32)| hot[a as usize] && hot[b as usize];
        let mut taken = Sides::default();
        self.unanimous
            .iter()
            .flat_map(|&triangle| sides(triangle))
            .filter(between)
            .for_each(|side| taken.insert(side));
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
#[derive(Default)]
struct Sides {
    all: Vec<(u32, u32)>,
    table: IndexTable,
}

impl Sides {
    fn hash((a, b): (u32, u32)) -> u32 {
        hash([u64::from(a) << 32 | u64::from(b)])
    }

    fn contains(&self, side: (u32, u32)) -> bool {
        self.table.find(Self::hash(side), |k| self.all[k] == side).is_some()
    }

    fn insert(&mut self, side: (u32, u32)) {
        let fresh = self.all.len();
        self.all.push(side);
        self.table.find_or_add(Self::hash(side), fresh, |k| self.all[k] == side);
    }
}

/// Returns the directed edges of a triangle.
fn sides([a, b, c]: [u32; 3]) -> [(u32, u32); 3] {
    [(a, b), (b, c), (c, a)]
}

/// Returns twice the area vector of a triangle.
pub(super) fn area_vector(position: &[Vec3], [a, b, c]: [u32; 3]) -> DVec3 {
    let a = position[a as usize].as_dvec3();
    (position[b as usize].as_dvec3() - a).cross(position[c as usize].as_dvec3() - a)
}

/// Returns the total area of triangles.
pub(super) fn area(position: &[Vec3], mesh: &[[u32; 3]]) -> f64 {
    mesh.iter().map(|&triangle| 0.5 * area_vector(position, triangle).length()).sum()
}

/// Angles of the triangles added so far.
#[derive(Default)]
pub(super) struct TriangleAngles {
    pub(super) count: usize,
    smallest: Moments,
    least: Option<f64>,
    triangles_below_30: usize,
    triangles_above_90: usize,
    angles_below_30: usize,
    angles_above_90: usize,
}

impl TriangleAngles {
    pub(super) fn add(&mut self, position: &[Vec3], triangle: [u32; 3]) {
        let corner = triangle.map(|i| position[i as usize].as_dvec3());
        let twice_area = area_vector(position, triangle).length();
        // At each corner the product of the sides is |a||b| cos; |a||b| sin is twice the area.
        let cosines: [f64; 3] =
            core::array::from_fn(|k| (corner[(k + 1) % 3] - corner[k]).dot(corner[(k + 2) % 3] - corner[k]));
        // The sine term is the same at all corners, so the smallest angle has the largest cosine.
        // It is below 30° if tan < 1/√3.
        let sharp = cosines.iter().filter(|&&c| twice_area * SQRT_3 < c).count();
        let blunt = cosines.iter().filter(|&&c| c < 0.0).count();
        self.count += 1;
        self.angles_below_30 += sharp;
        self.angles_above_90 += blunt;
        self.triangles_below_30 += usize::from(sharp > 0);
        self.triangles_above_90 += usize::from(blunt > 0);
        let largest_cosine = cosines[0].max(cosines[1]).max(cosines[2]);
        let angle = libm::atan2(twice_area, largest_cosine).to_degrees();
        self.smallest.add(angle);
        self.least = Some(self.least.unwrap_or(angle).min(angle));
    }

    /// Adds the triangles of others.
    pub(super) fn join(&mut self, other: &Self) {
        self.count += other.count;
        self.smallest.join(&other.smallest);
        self.least = self.least.into_iter().chain(other.least).reduce(f64::min);
        self.triangles_below_30 += other.triangles_below_30;
        self.triangles_above_90 += other.triangles_above_90;
        self.angles_below_30 += other.angles_below_30;
        self.angles_above_90 += other.angles_above_90;
    }

    pub(super) fn figures(&self) -> Angles {
        Angles {
            smallest_angle: self.least.unwrap_or(f64::NAN),
            mean_smallest_angle: self.smallest.mean(),
            triangles_below_30: share(self.triangles_below_30, self.count),
            triangles_above_90: share(self.triangles_above_90, self.count),
            angles_below_30: share(self.angles_below_30, 3 * self.count),
            angles_above_90: share(self.angles_above_90, 3 * self.count),
        }
    }
}
