//! The particles of a level in the order of their rings around the first one, as a run shows them.

use super::net::Net;
use crate::mesh::half_edge::NONE;
use crate::particles::Particles;

/// Particles handed on in one slice of work.
const SLICE: usize = 256;

/// A breadth-first walk over the surface that fills the columns.
///
/// The generation level of a particle is its distance, in edges, from the first particle of its component, or from the creases around
/// its patch, and its parent is the neighbour from which the walk came to it. Particles on creases come first; their numbers stand in
/// place of their first rows.
#[derive(Clone, Debug)]
pub(super) struct Rings {
    /// Vertices in the order in which they were met.
    order: Vec<u32>,
    /// Place of each vertex in `order`.
    place: Vec<u32>,
    next: usize,
    /// Vertices below this one have been met.
    root: u32,
    is_walked: bool,
    /// The particles in the order of `order`, as far as they are there: at first their parents and levels alone.
    ready: Particles,
}

impl Rings {
    pub(super) fn new(net: &Net) -> Self {
        let n = net.position.len();
        let mut ready = Particles::default();
        ready.reserve(n);
        let mut rings = Self {
            order: Vec::with_capacity(n),
            place: vec![NONE; n],
            next: 0,
            root: 0,
            is_walked: false,
            ready,
        };
        let last = net.on_crease.iter().filter(|&&number| number != NONE).max();
        let mut met = vec![NONE; last.map_or(0, |&last| last as usize + 1)];
        let is_held = |&(v, &number): &(u32, &u32)| number != NONE && net.mesh.has_vertex(v);
        for (v, &number) in (0..).zip(&net.on_crease).filter(is_held) {
            // Where a patch touches itself, a particle has a vertex for each of its fans. The nappes at a tip keep rows of their own.
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

    /// Goes on for a slice. Returns whether the particles of the net are all there, with this radius where their size is 1. Only
    /// then are they handed on, so that a run that is cancelled has a whole level.
    pub(super) fn step(&mut self, net: &Net, radius: f32) -> bool {
        if !self.is_walked {
            self.is_walked = !(0..SLICE).all(|_| self.walk(net));
            return false;
        }
        let start = self.ready.len();
        let end = self.order.len().min(start + SLICE);
        for &v in &self.order[start..end] {
            self.ready.position.push(net.position[v as usize]);
            self.ready.normal.push(net.normal[v as usize]);
            self.ready.radius.push(radius * net.size_of(v));
            self.ready.slots.push(net.fates(v));
        }
        end == self.order.len()
    }

    /// The place of a vertex among the particles; none if there is no such vertex.
    pub(super) fn place(&self, v: u32) -> Option<u32> {
        self.place.get(v as usize).copied()
    }

    /// Puts the particles into the columns of the run.
    pub(super) fn hand_on(mut self, particles: &mut Particles) {
        core::mem::swap(particles, &mut self.ready);
    }

    /// Visits the neighbours of the next vertex; false if there is none.
    fn walk(&mut self, net: &Net) -> bool {
        if self.next == self.order.len() {
            let slots = self.place.len() as u32;
            let is_new = |&v: &u32| self.place[v as usize] == NONE && net.mesh.has_vertex(v);
            let Some(root) = (self.root..slots).find(is_new) else { return false };
            self.root = root + 1;
            self.meet(root, Particles::NO_PARENT, 0);
        }
        let k = self.next;
        self.next += 1;
        for other in net.mesh.neighbours(self.order[k]) {
            if self.place[other as usize] == NONE {
                self.meet(other, k as u32, self.ready.level[k] + 1);
            }
        }
        true
    }

    fn meet(&mut self, v: u32, parent: u32, level: u32) {
        self.place[v as usize] = self.order.len() as u32;
        self.order.push(v);
        self.ready.parent.push(parent);
        self.ready.level.push(level);
    }
}
