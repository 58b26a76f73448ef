//! Acute corners: where two planes of the box cut the surface at a small angle, the particles along
//! both curves come near each other. One of each crowded pair is removed.

use super::super::net::Net;
use crate::math::{key, sort_by_key};

/// A particle on the border and another one crowd each other if they are nearer than this share of
/// the spacing. With one of them removed, an edge of the border is at most 1.6 spacings long, and
/// the hole next to it no larger than holes inside may be. With half of it, a plane of the box
/// could still cut an edge in two.
const CROWDED: f32 = 0.6;

impl Net {
    /// Whether an edge with an end on the border is so short that its ends crowd each other.
    pub(super) fn is_short_at_border(&self, h: u32, spacing: f32) -> bool {
        let [a, b] = [self.mesh.origin(h), self.mesh.target(h)];
        (self.mesh.is_border(a) || self.mesh.is_border(b))
            && self.length(h) < CROWDED * spacing * self.size_between(a, b)
    }

    /// Removes a particle at each edge that is [short at the border](Self::is_short_at_border), the
    /// shortest first: an inner particle, else the one whose other neighbours are nearer. From an
    /// acute corner on, this leaves particles on both curves alternately. None moves. Returns
    /// whether one was removed.
    pub(in super::super) fn thin(&mut self, spacing: f32) -> bool {
        let mut short: Vec<u32> =
            self.mesh.edges().filter(|&h| self.is_short_at_border(h, spacing)).collect();
        sort_by_key(&mut short, |&h| key(self.length(h), h));
        let mut has_changed = false;
        for h in short {
            if !self.mesh.has_half_edge(h) || !self.is_short_at_border(h, spacing) {
                continue;
            }
            let [a, b] = [self.mesh.origin(h), self.mesh.target(h)];
            let (first, second) = if self.room(a, b) <= self.room(b, a) { (a, b) } else { (b, a) };
            has_changed |= self.take_out(first, spacing) || self.take_out(second, spacing);
        }
        has_changed
    }

    /// Distance of a particle on the border from its nearest neighbour except `other`; 0 for one
    /// inside.
    fn room(&self, v: u32, other: u32) -> f32 {
        if !self.mesh.is_border(v) {
            return 0.0;
        }
        let p = self.position[v as usize];
        let others = self.mesh.neighbours(v).filter(|&w| w != other);
        others.map(|w| self.position[w as usize].distance(p)).fold(f32::INFINITY, f32::min)
    }

    /// Merges a particle into the nearest neighbour for which that is allowed; returns whether
    /// there was one.
    fn take_out(&mut self, v: u32, spacing: f32) -> bool {
        if self.walls.planes(v).is_corner() {
            return false;
        }
        let mut ways: Vec<u32> = self.mesh.around(v).collect();
        sort_by_key(&mut ways, |&h| key(self.length(h), h));
        ways.into_iter().any(|h| super::clip::collapse(self, h, spacing))
    }
}
