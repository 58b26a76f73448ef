//! Particles on a surface with creases: each patch is a sheet of its own, which ends at its creases.

use crate::math::unkey;
use crate::particles::Particles;
use crate::spatial::tree::Tree;
use glam::Vec3;

/// A row of particles votes for the side of a crease on which it lies if it is nearer to a segment of it than this many lengths of
/// the segment. In a hexagonal lattice the nearest is 0.87 away; farther ones may belong to another part of the patch.
const NEAR: f32 = 2.0;

/// Least sine of the angle between a segment and the way from its middle to a row that votes: one ahead says nothing. It is that
/// of 30°: in a lattice that of the nearest row is 1.
const BESIDE: f32 = 0.5;

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
        let [inner, others] = [&position[on_creases..], &position[..on_creases]].map(Tree::new);
        let mut border = Vec::with_capacity(segments.len());
        let chains = chains(segments, position.len());
        let mut chain_of = vec![usize::MAX; on_creases];
        for (k, chain) in chains.iter().enumerate() {
            chain.as_flattened().iter().for_each(|&v| chain_of[v as usize] = k);
        }
        let mut keys = Vec::new();
        for (k, mut chain) in chains.into_iter().enumerate() {
            // The rows beside the chain: those on no crease, or else those of other creases around a narrow patch.
            let mut votes = |tree: &Tree, is_beside: &dyn Fn(usize) -> bool| {
                let side = |&[a, b]: &[u32; 2]| {
                    let (p, q) = (position[a as usize], position[b as usize]);
                    let (middle, reach) = (0.5 * (p + q), NEAR * p.distance(q));
                    tree.nearest_many(middle, 1, |j| is_beside(tree.origin[j as usize] as usize), &mut keys);
                    let nearest = keys.first().map(|&key| tree.position[unkey(key).1 as usize]);
                    let left = (normal(a) + normal(b)).cross(q - p).normalize_or_zero();
                    let beside = nearest.map(|at| at - middle).filter(|beside| beside.length() < reach);
                    let sine = beside.map_or(0.0, |beside| beside.normalize_or_zero().dot(left));
                    if sine.abs() > BESIDE { sine.signum() } else { 0.0 }
                };
                chain.iter().map(side).sum::<f32>()
            };
            let mut on_left = votes(&inner, &|_| true);
            if on_left == 0.0 {
                on_left = votes(&others, &|v| chain_of[v] != k);
                // A crease of another part of the patch may be near a few of the segments.
                if 2.0 * on_left.abs() <= chain.len() as f32 {
                    on_left = 0.0;
                }
            }
            if on_left == 0.0 {
                // There is no row but those of the chain: the way leads counter-clockwise round the patch.
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
