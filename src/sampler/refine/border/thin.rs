//! Acute corners: where two planes of the box cut the surface at a small angle, the particles along
//! both curves come near each other. One of each pair that crowds is taken out.

use super::super::net::Net;
use crate::math::{key, sort_by_key};

/// Two particles of which one lies on the border are crowded if they are nearer than this share of
/// the spacing. Without one of the two an edge of the border is no longer than 1.6 spacings, and
/// the hole beside it no larger than one inside may be. Half of it would leave an edge that a plane
/// of the box cuts in two.
const CROWDED: f32 = 0.6;

impl Net {
    /// Whether an edge with an end on the border is so short that its ends crowd each other.
    pub(super) fn is_short_at_border(&self, h: u32, spacing: f32) -> bool {
        let [a, b] = [self.mesh.origin(h), self.mesh.target(h)];
        (self.mesh.is_border(a) || self.mesh.is_border(b))
            && self.length(h) < CROWDED * spacing * self.size_between(a, b)
    }

    /// Takes a particle out at each of the edges that is
    /// [short at the border](Self::is_short_at_border), the shortest first: an inner one, else the
    /// one that has another neighbour nearer. From an acute corner on this leaves particles on one
    /// curve and the other in turn. None moves. Returns whether one was taken out.
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

    /// Distance of a particle on the border from the nearest of its neighbours but `other`, and 0
    /// for one inside.
    fn room(&self, v: u32, other: u32) -> f32 {
        if !self.mesh.is_border(v) {
            return 0.0;
        }
        let p = self.position[v as usize];
        let others = self.mesh.neighbours(v).filter(|&w| w != other);
        others.map(|w| self.position[w as usize].distance(p)).fold(f32::INFINITY, f32::min)
    }

    /// Merges a particle into the nearest of its neighbours for which that is allowed; whether it
    /// did.
    fn take_out(&mut self, v: u32, spacing: f32) -> bool {
        if self.walls.planes(v).is_corner() {
            return false;
        }
        let mut ways: Vec<u32> = self.mesh.around(v).collect();
        sort_by_key(&mut ways, |&h| key(self.length(h), h));
        ways.into_iter().any(|h| super::clip::collapse(self, h, spacing))
    }
}
