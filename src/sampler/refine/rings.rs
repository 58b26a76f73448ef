//! The particles of a level in the order of their rings around the first one, as a run shows them.

use super::layer::Layer;
use crate::mesh::half_edge::NONE;
use crate::particles::Particles;

/// Particles handed on in one slice of work.
const SLICE: usize = 256;

/// A breadth-first walk over the surface that fills the columns.
///
/// The generation level of a particle is its distance, in edges, from the first particle of its component, and its parent is the
/// neighbour from which the walk came to it.
#[derive(Clone, Debug)]
pub(super) struct Rings {
    /// Vertices in the order in which they were met.
    order: Vec<u32>,
    /// Place of each vertex in that order.
    place: Vec<u32>,
    /// Parents and levels, in that order.
    parent: Vec<u32>,
    level: Vec<u32>,
    next: usize,
    /// Vertices below this one have been met.
    root: u32,
    is_walked: bool,
    /// The particles in that order, as far as they are there.
    ready: Particles,
}

impl Rings {
    pub(super) fn new(layer: &Layer) -> Self {
        let n = layer.position.len();
        let column = || Vec::with_capacity(n);
        Self {
            order: column(),
            place: vec![NONE; n],
            parent: column(),
            level: column(),
            next: 0,
            root: 0,
            is_walked: false,
            ready: Particles::default(),
        }
    }

    /// Goes on for a slice. Returns whether all is done; `particles` then has the particles of the layer, with this radius
    /// where their size is 1. Until then it stays as it is, so that a run that is cancelled has a whole level.
    pub(super) fn step(&mut self, layer: &Layer, radius: f32, particles: &mut Particles) -> bool {
        if !self.is_walked {
            self.is_walked = !(0..SLICE).all(|_| self.walk(layer));
            if self.is_walked {
                self.ready.reserve(self.order.len());
            }
            return false;
        }
        let start = self.ready.len();
        let end = self.order.len().min(start + SLICE);
        for k in start..end {
            let v = self.order[k] as usize;
            self.ready.push(
                layer.position[v],
                layer.normal[v],
                radius * layer.size_of(v as u32),
                self.parent[k],
                self.level[k],
                layer.fates(v as u32),
            );
        }
        let is_done = end == self.order.len();
        if is_done {
            core::mem::swap(particles, &mut self.ready);
        }
        is_done
    }

    /// Visits the neighbours of the next vertex; false if there is none.
    fn walk(&mut self, layer: &Layer) -> bool {
        if self.next == self.order.len() {
            let slots = self.place.len() as u32;
            let is_new = |&v: &u32| self.place[v as usize] == NONE && layer.mesh.has_vertex(v);
            let Some(root) = (self.root..slots).find(is_new) else { return false };
            self.root = root + 1;
            self.meet(root, Particles::NO_PARENT, 0);
        }
        let k = self.next;
        self.next += 1;
        for other in layer.mesh.neighbours(self.order[k]) {
            if self.place[other as usize] == NONE {
                self.meet(other, k as u32, self.level[k] + 1);
            }
        }
        true
    }

    fn meet(&mut self, v: u32, parent: u32, level: u32) {
        self.place[v as usize] = self.order.len() as u32;
        self.order.push(v);
        self.parent.push(parent);
        self.level.push(level);
    }
}
