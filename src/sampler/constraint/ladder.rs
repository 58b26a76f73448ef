//! Particles on creases and tips, level by level: at each level of a refinement a new particle
//! halves the way between two successive ones on a crease.

use crate::math::{Bounds, sort_by_key};
use crate::particles::Particles;
use glam::Vec3;

/// The particles on creases and tips at every level of a refinement. All are computed before it
/// begins, so that the patches that meet at a crease have them at the same places.
///
/// A crease particle of the coarse front has the number of its first row; those of finer levels
/// follow.
#[derive(Clone, Debug)]
pub(in super::super) struct CreaseLadder {
    /// Pairs of successive particles of the coarse front along a crease.
    segments: Vec<[u32; 2]>,
    /// For each segment, the patches on its left and on its right.
    sides: Vec<Vec<[u32; 2]>>,
    /// Number of equal parts of a segment at the last level.
    parts: usize,
    /// Number of rows of the coarse front.
    rows: u32,
    /// Positions of the particles that divide the segments, segment by segment from its first end
    /// to its second.
    between: Vec<Vec3>,
    /// For every two particles that are successive at some level, the lower number first, the
    /// number of the particle midway between them. Sorted.
    middles: Vec<([u32; 2], u32)>,
    /// Number of segments that end at each row of the coarse front.
    ends: Vec<u32>,
    /// Whether a crease continues beyond the box from each row.
    is_at_box: Vec<bool>,
}

impl CreaseLadder {
    /// The ladder over the rows of a coarse front. The points `between` divide its segments,
    /// equally many in each. If creases continue beyond the box, segments outside are left out.
    pub(super) fn new(rows: &Particles, mut between: Vec<Vec3>, bounds: Option<&Bounds>) -> Self {
        let count = rows.twins.len();
        let (mut segments, mut sides) = (Vec::new(), Vec::new());
        let (mut ends, mut is_at_box) = (vec![0; count], vec![false; count]);
        let inner = between.len() / rows.segments.len().max(1);
        let parts = inner + 1;
        let mut kept = 0;
        for (k, (segment, own)) in rows.segments.iter().zip(&rows.sides).enumerate() {
            let points = k * inner..(k + 1) * inner;
            let is_beyond = |&middle: &Vec3| bounds.is_some_and(|bounds| !bounds.contains(middle));
            if between[points.clone()].get(inner / 2).is_some_and(is_beyond) {
                segment.iter().for_each(|&row| is_at_box[row as usize] = true);
                continue;
            }
            segments.push(*segment);
            sides.push(own.clone());
            segment.iter().for_each(|&row| ends[row as usize] += 1);
            between.copy_within(points, kept);
            kept += inner;
        }
        between.truncate(kept);
        let mut ladder = Self {
            segments,
            sides,
            parts,
            rows: count as u32,
            between,
            middles: Vec::new(),
            ends,
            is_at_box,
        };
        let mut half = parts / 2;
        while half > 0 {
            for segment in 0..ladder.segments.len() {
                for k in (half..parts).step_by(2 * half) {
                    let [a, middle, b] = [k - half, k, k + half].map(|k| ladder.number(segment, k));
                    ladder.middles.push(([a.min(b), a.max(b)], middle));
                }
            }
            half /= 2;
        }
        sort_by_key(&mut ladder.middles, |&([a, b], _)| u64::from(a) << 32 | u64::from(b));
        ladder
    }

    /// The number of the particle `part` parts along a segment.
    fn number(&self, segment: usize, part: usize) -> u32 {
        let [start, end] = self.segments[segment];
        match part {
            0 => start,
            part if part == self.parts => end,
            part => self.rows + (segment * (self.parts - 1) + part - 1) as u32,
        }
    }

    /// The highest number of a particle, plus one.
    pub(in super::super) fn len(&self) -> usize {
        self.rows as usize + self.between.len()
    }

    /// Whether creases meet or end at a particle.
    pub(in super::super) fn is_corner(&self, number: u32) -> bool {
        self.ends.get(number as usize).is_some_and(|&ends| ends != 2)
    }

    /// Whether a crease ends at a particle because the box does.
    pub(in super::super) fn is_at_box(&self, number: u32) -> bool {
        self.is_at_box.get(number as usize).copied().unwrap_or(false)
    }

    /// The number and the position of the particle midway between two; none if these are successive
    /// at no level before the last.
    pub(in super::super) fn middle(&self, a: u32, b: u32) -> Option<(u32, Vec3)> {
        let place = self.middles.binary_search_by_key(&[a.min(b), a.max(b)], |&(pair, _)| pair).ok()?;
        let number = self.middles[place].1;
        Some((number, self.between[(number - self.rows) as usize]))
    }

    /// The pairs of successive particles at the level that `to_come` more levels follow, each with
    /// the patches on its left and on its right.
    pub(in super::super) fn pairs(&self, to_come: u32) -> impl Iterator<Item = ([u32; 2], &[[u32; 2]])> {
        let stride = 1 << to_come;
        (0..self.segments.len()).flat_map(move |segment| {
            let starts = (0..self.parts).step_by(stride);
            let pair = move |k| [k, k + stride].map(|k| self.number(segment, k));
            starts.map(move |k| (pair(k), &self.sides[segment][..]))
        })
    }

    /// A particle of the coarse front, if any, that two creases connect directly to the same other
    /// one, so that a mesh edge does not show on which of them it lies.
    pub(in super::super) fn ambiguous(&self) -> Option<u32> {
        let same = self.middles.windows(2).find(|pair| pair[0].0 == pair[1].0);
        same.map(|pair| pair[0].0[0])
    }
}
