//! Particles on a surface with creases: each patch is a sheet of its own, which ends at its creases.

use crate::particles::Particles;
use crate::spatial::tree::Tree;
use glam::Vec3;

/// A row of particles votes for the side of a crease on which it lies if it is nearer to a segment of it than this many lengths of
/// the segment. In a hexagonal lattice the nearest is 0.87 away; farther ones may belong to another part of the patch.
const NEAR: f32 = 2.0;

/// The rows of one patch, and its border.
#[derive(Debug, Default)]
pub(super) struct Sheet {
    /// The rows, in ascending order.
    pub(super) rows: Vec<u32>,
    /// Pairs of places in `rows` that follow each other along a crease, with the patch on the left.
    pub(super) border: Vec<[u32; 2]>,
}

impl Sheet {
    /// The sheets of all patches, in the order of their numbers.
    pub(super) fn all(particles: &Particles) -> Vec<Self> {
        let mut rows: Vec<(u32, u32)> = particles.patch.iter().copied().zip(0..).collect();
        rows.sort_unstable();
        let mut sheets: Vec<Self> = Vec::new();
        // Number of the sheet of each row, and the row's place in it.
        let mut place = vec![(0, 0); rows.len()];
        let mut last = None;
        for (patch, row) in rows {
            if last.replace(patch) != Some(patch) {
                sheets.push(Self::default());
            }
            let number = sheets.len() - 1;
            place[row as usize] = (number, sheets[number].rows.len() as u32);
            sheets[number].rows.push(row);
        }
        // The rows of each particle on a crease, one particle after the other.
        let mut of_first: Vec<(u32, u32)> = particles.twins.iter().copied().zip(0..).collect();
        of_first.sort_unstable();
        let rows_of = |first: u32| {
            let start = of_first.partition_point(|&(other, _)| other < first);
            of_first[start..].iter().take_while(move |&&(other, _)| other == first).map(|&(_, row)| row)
        };
        let mut segments: Vec<Vec<[u32; 2]>> = vec![Vec::new(); sheets.len()];
        for &[a, b] in &particles.segments {
            for i in rows_of(a) {
                for j in rows_of(b) {
                    let ((sheet, i), (other, j)) = (place[i as usize], place[j as usize]);
                    if sheet == other {
                        segments[sheet].push([i, j]);
                    }
                }
            }
        }
        for (sheet, segments) in sheets.iter_mut().zip(&segments) {
            sheet.border = sheet.directed(particles, segments);
        }
        sheets
    }

    /// The segments, each with the patch on its left.
    fn directed(&self, particles: &Particles, segments: &[[u32; 2]]) -> Vec<[u32; 2]> {
        let position: Vec<Vec3> = self.rows.iter().map(|&row| particles.position[row as usize]).collect();
        let normal = |v: u32| particles.normal[self.rows[v as usize] as usize];
        let on_creases = self.rows.partition_point(|&row| (row as usize) < particles.twins.len());
        let inner = Tree::new(&position[on_creases..]);
        let mut border = Vec::with_capacity(segments.len());
        for mut chain in chains(segments, position.len()) {
            let side = |&[a, b]: &[u32; 2]| {
                let (p, q) = (position[a as usize], position[b as usize]);
                let (middle, reach) = (0.5 * (p + q), NEAR * p.distance(q));
                let left = (normal(a) + normal(b)).cross(q - p);
                let (_, nearest) = inner.nearest(middle, u32::MAX, reach * reach);
                inner.position.get(nearest as usize).map_or(0.0, |at| (at - middle).dot(left).signum())
            };
            let mut on_left: f32 = chain.iter().map(side).sum();
            if on_left == 0.0 {
                // No row but those on the creases: the way leads counter-clockwise round the patch.
                let start = position[chain[0][0] as usize];
                let area = |&[a, b]: &[u32; 2]| {
                    (position[a as usize] - start)
                        .cross(position[b as usize] - start)
                        .dot(normal(a) + normal(b))
                };
                on_left = chain.iter().map(area).sum();
            }
            if on_left < 0.0 {
                chain.iter_mut().for_each(|segment| segment.reverse());
            }
            border.extend(chain);
        }
        border
    }
}

/// The segments in chains, each of which follows the one before it. A chain ends where not just two segments meet.
fn chains(segments: &[[u32; 2]], count: usize) -> Vec<Vec<[u32; 2]>> {
    let mut at: Vec<Vec<usize>> = vec![Vec::new(); count];
    for (k, segment) in segments.iter().enumerate() {
        segment.iter().for_each(|&v| at[v as usize].push(k));
    }
    let mut is_used = vec![false; segments.len()];
    let mut all = Vec::new();
    for first in 0..segments.len() {
        if core::mem::replace(&mut is_used[first], true) {
            continue;
        }
        let mut chain = vec![segments[first]];
        // On from its end, then, turned round, on from its start.
        for _ in 0..2 {
            while let Some([_, v]) = chain.last().copied()
                && let ways = &at[v as usize]
                && ways.len() == 2
                && let Some(&next) = ways.iter().find(|&&k| !is_used[k])
            {
                is_used[next] = true;
                let [a, b] = segments[next];
                chain.push(if a == v { [a, b] } else { [b, a] });
            }
            chain.reverse();
            chain.iter_mut().for_each(|segment| segment.reverse());
        }
        all.push(chain);
    }
    all
}
