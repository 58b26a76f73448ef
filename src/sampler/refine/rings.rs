//! The particles of a level in the order of their rings around the first one, as a run shows them.

use super::net::Net;
use crate::math::NONE;
use crate::particles::Particles;

/// A breadth-first walk over the surface that fills the columns.
///
/// The generation level of a particle is its distance, in edges, from the first particle of its
/// component, or from the creases around its patch, and its parent is the neighbour from which the
/// walk came to it. Particles on creases come first; their numbers stand in place of their first
/// rows.
#[derive(Clone, Debug)]
pub(super) struct Rings {
    /// Vertices in the order in which they were met.
    order: Vec<u32>,
    /// Place of each vertex in `order`.
    place: Vec<u32>,
    /// The particles in the order of `order`.
    ready: Particles,
}

impl Rings {
    /// Walks over the net. A particle of size 1 has this radius.
    pub(super) fn new(net: &Net, radius: f32) -> Self {
        let n = net.position.len();
        let mut ready = Particles::default();
        ready.reserve(n);
        let mut rings = Self { order: Vec::with_capacity(n), place: vec![NONE; n], ready };
        let last = net.on_crease.iter().filter(|&&number| number != NONE).max();
        let mut met = vec![NONE; last.map_or(0, |&last| last as usize + 1)];
        let is_held = |&(v, &number): &(u32, &u32)| number != NONE && net.mesh.has_vertex(v);
        for (v, &number) in (0..).zip(&net.on_crease).filter(is_held) {
            // Where a patch touches itself, a particle has a vertex for each of its fans. The
            // nappes at a tip keep rows of their own.
            let new = rings.order.len() as u32;
            let first = &mut met[number as usize];
            if !net.is_tip(v) {
                *first = new.min(*first);
            }
            let place = if net.is_tip(v) { new } else { *first };
            if place as usize == rings.order.len() {
                rings.meet(v, Particles::NO_PARENT, 0);
                rings.ready.twins.push(number);
            }
            rings.place[v as usize] = place;
        }
        rings.walk(net, 0);
        for root in 0..n as u32 {
            if rings.place[root as usize] == NONE && net.mesh.has_vertex(root) {
                let start = rings.order.len();
                rings.meet(root, Particles::NO_PARENT, 0);
                rings.walk(net, start);
            }
        }
        for &v in &rings.order {
            rings.ready.local.push(net.position[v as usize]);
            rings.ready.normal.push(net.normal[v as usize]);
            rings.ready.radius.push(radius * net.size_of(v));
            rings.ready.slots.push(net.fates(v));
        }
        rings
    }

    /// The place of a vertex among the particles; none if there is no such vertex.
    pub(super) fn place(&self, v: u32) -> Option<u32> {
        self.place.get(v as usize).copied()
    }

    /// The particles, in their order.
    pub(super) fn into_particles(self) -> Particles {
        self.ready
    }

    /// Goes on from the vertex that was met as number `start` to all that can be reached.
    fn walk(&mut self, net: &Net, start: usize) {
        let mut next = start;
        while let Some(&v) = self.order.get(next) {
            for other in net.mesh.neighbours(v) {
                if self.place[other as usize] == NONE {
                    self.meet(other, next as u32, self.ready.level[next] + 1);
                }
            }
            next += 1;
        }
    }

    fn meet(&mut self, v: u32, parent: u32, level: u32) {
        self.place[v as usize] = self.order.len() as u32;
        self.order.push(v);
        self.ready.parent.push(parent);
        self.ready.level.push(level);
    }
}
