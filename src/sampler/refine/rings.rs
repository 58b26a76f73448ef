//! The particles of a level in the order of their rings around the first one, as a run shows them.

use super::net::Net;
use crate::math::NONE;
use crate::particles::Particles;

/// A breadth-first walk over the surface that fills the columns. It can be interrupted and
/// continued.
///
/// The generation level of a particle is its distance, in edges, from the first particle of its
/// component, or from the creases around its patch. Its parent is the neighbour from which the walk
/// reached it. Particles on creases come first, with their numbers instead of their first rows.
#[derive(Debug, Default)]
pub(crate) struct Rings {
    /// Vertices in the order in which the walk met them.
    order: Vec<u32>,
    /// Place in `order` of the vertex whose neighbours are visited next.
    next: usize,
    /// Vertex from which the search for the next root starts, once the walk is stuck.
    root: u32,
    /// Radius of a particle of size 1.
    radius: f32,
    /// Place of each vertex in `order`.
    place: Vec<u32>,
    /// The particles in the order of `order`.
    ready: Particles,
}

impl Rings {
    /// Begins a walk over a net. A particle of size 1 has this radius.
    pub(super) fn new(net: &Net, radius: f32) -> Self {
        let n = net.position.len();
        let mut ready = Particles::default();
        ready.reserve(n);
        let order = Vec::with_capacity(n);
        let mut rings = Self { order, next: 0, root: 0, radius, place: vec![NONE; n], ready };
        let last = net.on_crease.iter().filter(|&&number| number != NONE).max();
        let mut met = vec![NONE; last.map_or(0, |&last| last as usize + 1)];
        let is_held = |&(v, &number): &(u32, &u32)| number != NONE && net.mesh.has_vertex(v);
        for (v, &number) in (0..).zip(&net.on_crease).filter(is_held) {
            // Where a patch touches itself, a particle has a vertex for each of its fans. The
            // nappes at a tip keep their own rows.
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
        rings
    }

    /// Continues for `left` particles. Returns whether all are in order.
    pub(super) fn go_on(&mut self, net: &Net, left: &mut u32) -> bool {
        while *left > 0 {
            *left -= 1;
            if let Some(&v) = self.order.get(self.next) {
                self.pass(net, v);
            } else {
                let is_unmet = |&v: &u32| self.place[v as usize] == NONE && net.mesh.has_vertex(v);
                let Some(root) = (self.root..self.place.len() as u32).find(is_unmet) else { return true };
                self.root = root + 1;
                self.meet(root, Particles::NO_PARENT, 0);
            }
        }
        false
    }

    /// Visits the neighbours of a vertex, and writes its own row.
    fn pass(&mut self, net: &Net, v: u32) {
        for other in net.mesh.neighbours(v) {
            if self.place[other as usize] == NONE {
                self.meet(other, self.next as u32, self.ready.level[self.next] + 1);
            }
        }
        self.next += 1;
        self.ready.local.push(net.position[v as usize]);
        self.ready.normal.push(net.normal[v as usize]);
        self.ready.radius.push(self.radius * net.size_of(v));
        self.ready.slots.push(net.fates(v));
    }

    /// The place of a vertex among the particles; none if there is no such vertex.
    pub(super) fn place(&self, v: u32) -> Option<u32> {
        self.place.get(v as usize).copied()
    }

    /// The particles, in their order.
    pub(super) fn into_particles(self) -> Particles {
        self.ready
    }

    fn meet(&mut self, v: u32, parent: u32, level: u32) {
        self.place[v as usize] = self.order.len() as u32;
        self.order.push(v);
        self.ready.parent.push(parent);
        self.ready.level.push(level);
    }
}
