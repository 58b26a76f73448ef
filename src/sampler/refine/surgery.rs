//! Surgery: trials with one particle more or one fewer at a defect. Those that pay are kept.

use super::net::{Ground, Net, Springs};
use super::walls::{Planes, Site};
use crate::math::{NONE, grow, sort_by_key};
use crate::mesh::half_edge::{HalfEdges, next, previous};
use core::cmp::Ordering;
use glam::Vec3;

/// Rings around a defect that a trial moves. Fewer: angles are smaller. More: they are larger, and
/// a run takes longer.
const RINGS: u32 = 2;
/// Sweeps over the patch of a trial. More are no better.
const SWEEPS: u32 = 2;
/// Over-relaxation of the steps of surgery: less than in sweeps over all particles, since the patch
/// must come to rest within a few. With less or more, fewer particles have six neighbours.
const OMEGA: f32 = 1.3;
/// A trial ends early if the gain of its last sweep, times this, would not be enough. In 19 of 20
/// trials a sweep gains at most 0.35 of what the sweep before gained, so all that follow gain at
/// most 0.54 of it.
const STILL_TO_GAIN: f32 = 0.5;
/// Price of a particle, in units of the spacing squared, per share of faces above the wanted
/// number. Smaller: the count is farther off; larger: fewer particles have six neighbours.
const COUNT_PRICE: f32 = 20.0;

/// Least cosine of the angle between the normal of a face after a trial and the surface normal at
/// its corners: cos 60°. Without this rule a body may lose a thin ear; with a smaller cosine fewer
/// such bodies are refined.
const LEAST_AGREEMENT: f32 = 0.5;

/// Parameters of a round of surgery.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aim {
    pub(super) springs: Springs,
    /// Price δ of a defect, in units of the spacing squared: δ Σ (valence − wanted)².
    pub(super) delta: f32,
    /// Wanted number of faces.
    pub(super) faces: f32,
    /// Loss up to which a trial is still kept, in units of the spacing squared.
    pub(super) loss: f32,
    /// A particle without a defect is tried as well if its edges are too short or too long by this
    /// share on average.
    pub(super) stretch: f32,
}

/// Operation of a trial.
#[derive(Clone, Copy)]
pub(super) enum Operation {
    /// Merge the particle at which the half-edge begins into the one at which it ends.
    Collapse(u32),
    /// Insert a particle into the face of the half-edge.
    Insert(u32),
    /// Split the edge of the half-edge, on the border.
    Split(u32),
}

/// Effect of an operation on the particles and their valences.
struct Effect {
    /// The particle that was added, or into which another one was merged.
    at: u32,
    /// Change of Σ (valence − wanted)².
    badness: i32,
    /// Particles added; one on the border counts half, since it has half the faces.
    added: f32,
}

/// The memory of the trials.
#[derive(Clone, Debug, Default)]
pub(super) struct Surgeon {
    /// The particles that a trial moves.
    patch: Vec<u32>,
    /// The last trial that had each particle in its patch.
    stamp: Vec<u32>,
    trial: u32,
    /// Number of neighbours that a particle had when it was last tried, in vain; 0 if its
    /// surroundings have changed since.
    tried: Vec<u32>,
    /// Whether a trial was kept.
    has_kept: bool,
    /// Site of each particle of the patch before the trial.
    saved: Vec<Site>,
    /// A half-edge of every edge with an end in the patch.
    edges: Vec<u32>,
}

impl Surgeon {
    /// Tries to mend `v`, if it does not have six neighbours or if its edges are too short or too
    /// long: with too few neighbours it is merged with the nearest of them, with too many another
    /// particle is inserted into the widest of its faces. A failed trial is repeated only when
    /// something around it has changed. Returns whether it was tried.
    pub(super) fn mend(&mut self, net: &mut Net, ground: &mut Ground, aim: Aim, v: u32) -> bool {
        if !net.mesh.has_vertex(v) || self.tried.get(v as usize) == Some(&(net.mesh.valence(v) as u32)) {
            return false;
        }
        let operations = if net.mesh.is_border(v) {
            net.operations_at_border(aim.springs.spacing * net.size_of(v), v)
        } else {
            [operation(net, aim, v), None]
        };
        let mut is_tried = false;
        for operation in operations.into_iter().flatten() {
            let valence = net.mesh.valence(v) as u32;
            is_tried = true;
            // The first one that pays is kept.
            if self.attempt(net, ground, aim, operation, net.size_of(v)) {
                break;
            }
            self.tried[v as usize] = valence;
        }
        is_tried
    }

    /// Whether a trial was kept since the last call.
    pub(super) fn take_kept(&mut self) -> bool {
        core::mem::take(&mut self.has_kept)
    }

    /// Forgets which trials have failed.
    pub(super) fn forget(&mut self) {
        self.tried.clear();
    }

    /// Does the operation and relaxes the particles around it, and undoes both unless they lower
    /// the energy enough. Returns whether they are kept. `size` is the size of the particles there.
    ///
    /// The particles move in their tangent planes, which changes distances only in second order.
    /// After a trial that is kept they return to the surface.
    fn attempt(
        &mut self,
        net: &mut Net,
        ground: &mut Ground,
        aim: Aim,
        operation: Operation,
        size: f32,
    ) -> bool {
        let a = aim.springs.spacing * size;
        let a_sq = a * a;
        self.gather(net, operation);
        let before = self.energy(net, aim.springs);
        self.saved.clear();
        self.saved.extend(self.patch.iter().map(|&v| net.site(v)));
        let slots = net.position.len();
        net.mesh.begin();
        let Effect { at, badness: mut defects, added } = self.operate(net, operation);
        let is_flat = net.has_face_along_border(at);
        self.collect_edges(net);
        defects += self.flip(net);
        // Half-way through the operation, so that it and its opposite cost the same.
        let excess = net.mesh.faces() as f32 - added - aim.faces;
        // On a surface of fixed area, a particle more lowers the energy of the springs by the first
        // term.
        let theta = aim.springs.theta;
        let potential = 3.0 * theta * (1.0 - theta) + COUNT_PRICE * excess / aim.faces;
        let gain_of = |surgeon: &Self, net: &Net, defects: i32| {
            let price = a_sq * (potential * added + aim.delta * defects as f32);
            before - surgeon.energy(net, aim.springs) - price
        };
        let springs = Springs { omega: OMEGA, ..aim.springs };
        let least = -aim.loss * a_sq;
        let mut gain = gain_of(self, net, defects);
        for _ in 0..SWEEPS {
            net.drift(springs, self.patch.iter().copied());
            defects += self.flip(net);
            let last = core::mem::replace(&mut gain, gain_of(self, net, defects));
            if gain + STILL_TO_GAIN * (gain - last) <= least {
                break;
            }
        }
        if gain > least && !is_flat {
            net.land(ground, springs.spacing, self.patch.iter().copied(), false);
            if ground.block.refused.is_empty() && self.lies_on_surface(net) {
                net.mesh.keep();
                self.add_rings(&net.mesh, 1);
                self.patch.iter().for_each(|&v| self.tried[v as usize] = 0);
                self.has_kept = true;
                return true;
            }
        }
        net.mesh.undo();
        // A particle that the trial added comes after the existing ones.
        for (&v, &site) in self.patch.iter().zip(&self.saved) {
            net.put(v, site);
        }
        net.resize(slots);
        false
    }

    /// Adds [`RINGS`] rings to some particles; all are then in ascending order.
    pub(super) fn widen(&mut self, mesh: &HalfEdges, particles: &mut Vec<u32>) {
        self.stamp.resize(mesh.vertex_slots() + 1, 0);
        core::mem::swap(&mut self.patch, particles);
        self.trial += 1;
        self.patch.iter().for_each(|&v| self.stamp[v as usize] = self.trial);
        self.add_rings(mesh, RINGS);
        sort_by_key(&mut self.patch, |&v| u64::from(v));
        core::mem::swap(&mut self.patch, particles);
    }

    fn add_rings(&mut self, mesh: &HalfEdges, rings: u32) {
        let mut first = 0;
        for _ in 0..rings {
            let end = self.patch.len();
            for k in first..end {
                for other in mesh.neighbours(self.patch[k]) {
                    if self.stamp[other as usize] != self.trial {
                        self.stamp[other as usize] = self.trial;
                        self.patch.push(other);
                    }
                }
            }
            first = end;
        }
    }

    /// Gathers the patch: [`RINGS`] rings around the particle that is merged or inserted.
    fn gather(&mut self, net: &Net, operation: Operation) {
        let mesh = &net.mesh;
        self.trial += 1;
        self.patch.clear();
        // One more than at present: an insertion may take it.
        let rows = mesh.vertex_slots() + 1;
        grow(&mut self.stamp, rows, 0);
        grow(&mut self.tried, rows, 0);
        let rings = match operation {
            Operation::Collapse(h) => {
                self.patch.extend([mesh.origin(h), mesh.target(h)]);
                RINGS
            }
            // The corners are the first ring.
            Operation::Insert(h) | Operation::Split(h) => {
                self.patch.extend([h, next(h), previous(h)].map(|h| mesh.origin(h)));
                RINGS - 1
            }
        };
        self.patch.iter().for_each(|&v| self.stamp[v as usize] = self.trial);
        self.add_rings(mesh, rings);
    }

    fn is_in(&self, v: u32) -> bool {
        self.stamp[v as usize] == self.trial
    }

    /// Energy of the edges with an end in the patch.
    fn energy(&self, net: &Net, springs: Springs) -> f32 {
        let rest = springs.rest();
        let mut sum = 0.0;
        for &v in self.patch.iter().filter(|&&v| net.mesh.has_vertex(v)) {
            let p = net.position[v as usize];
            for other in net.mesh.neighbours(v) {
                if other > v || !self.is_in(other) {
                    let rest = rest * net.size_between(v, other);
                    let stretch = (net.position[other as usize] - p).length() - rest;
                    sum += stretch * stretch;
                }
            }
        }
        sum
    }

    /// Does the operation.
    fn operate(&mut self, net: &mut Net, operation: Operation) -> Effect {
        match operation {
            Operation::Collapse(h) => {
                let mesh = &net.mesh;
                let (a, b, twin) = (mesh.origin(h), mesh.target(h), mesh.twin(h));
                // At the border there is one face only.
                let d = if twin == NONE { b } else { mesh.origin(previous(twin)) };
                let around = [b, mesh.origin(previous(h)), d];
                let around = &around[..if twin == NONE { 2 } else { 3 }];
                let before = badness(net, around) + badness(net, &[a]);
                let [first, second] = [a, b].map(|v| net.site(v));
                let mut merged = net.more_bound(a, b);
                if first.planes == second.planes {
                    merged.position = (first.position + second.position) * 0.5;
                }
                net.mesh.collapse(h);
                net.put(b, merged);
                let added = if twin == NONE { -0.5 } else { -1.0 };
                Effect { at: b, badness: badness(net, around) - before, added }
            }
            Operation::Insert(h) | Operation::Split(h) => {
                let corners = [h, next(h), previous(h)].map(|h| net.mesh.origin(h));
                let before = badness(net, &corners);
                let is_split = matches!(operation, Operation::Split(_));
                let (site, size, added) = if is_split {
                    let [a, b, _] = corners;
                    (net.halfway(a, b), net.size_between(a, b), 0.5)
                } else {
                    let mean = |of: &[Vec3]| corners.iter().map(|&v| of[v as usize]).sum::<Vec3>() / 3.0;
                    let (position, normal) = (mean(&net.position), mean(&net.normal));
                    let normal = normal.normalize_or(net.normal[corners[0] as usize]);
                    let size = corners.iter().map(|&v| net.size_of(v)).sum::<f32>() / 3.0;
                    (Site::smooth(position, normal, Planes::INNER), size, 1.0)
                };
                let v = if is_split { net.mesh.split(h) } else { net.mesh.insert(h) };
                self.add(net, v, site, size);
                Effect { at: v, badness: badness(net, &corners) + badness(net, &[v]) - before, added }
            }
        }
    }

    /// Whether each face around a particle of the patch is within 60° of the surface there. Without
    /// this rule trials shorten a thin part of the surface from its rim: each leaves a narrow face
    /// across the rim, between the two sides.
    fn lies_on_surface(&self, net: &Net) -> bool {
        let area_of = |h: u32| net.area_vector([h, next(h), previous(h)].map(|h| net.mesh.origin(h)));
        let mut patch = self.patch.iter().copied().filter(|&v| net.mesh.has_vertex(v));
        patch.all(|v| net.mesh.around(v).all(|h| net.faces_as(area_of(h), v, LEAST_AGREEMENT)))
    }

    /// Adds a new particle to the columns and to the patch.
    fn add(&mut self, net: &mut Net, v: u32, site: Site, size: f32) {
        net.put_new(v, site, size);
        self.stamp[v as usize] = self.trial;
        self.patch.push(v);
    }

    fn collect_edges(&mut self, net: &Net) {
        self.edges.clear();
        for &v in self.patch.iter().filter(|&&v| net.mesh.has_vertex(v)) {
            for h in net.mesh.around(v) {
                let other = net.mesh.target(h);
                if other > v || !self.is_in(other) {
                    self.edges.push(h);
                }
            }
        }
    }

    /// Flips the edges of the patch that are not Delaunay; returns the change of Σ (valence −
    /// wanted)². An edge must keep an end in the patch, else its energy would be lost.
    fn flip(&mut self, net: &mut Net) -> i32 {
        let mut change = 0;
        for &h in &self.edges {
            if !net.wants_flip(h) {
                continue;
            }
            let mesh = &net.mesh;
            let t = mesh.twin(h);
            let (c, d) = (mesh.origin(previous(h)), mesh.origin(previous(t)));
            if !self.is_in(c) && !self.is_in(d) {
                continue;
            }
            let corners = [mesh.origin(h), mesh.origin(t), c, d];
            let before = badness(net, &corners);
            net.mesh.flip(h);
            change += badness(net, &corners) - before;
        }
        change
    }
}

/// Σ (valence − wanted)² over some particles.
fn badness(net: &Net, particles: &[u32]) -> i32 {
    particles
        .iter()
        .map(|&v| {
            let excess = net.excess(v);
            excess * excess
        })
        .sum()
}

/// The operation that may mend an inner particle, if any: with too few neighbours it is merged with
/// the nearest of them, with too many another one is inserted into the widest of its faces. With as
/// many as wanted, the lengths of its edges decide.
fn operation(net: &Net, aim: Aim, v: u32) -> Option<Operation> {
    let mesh = &net.mesh;
    let p = net.position[v as usize];
    let by_length = || match net.mean_stretch(aim.springs, v) {
        stretch if stretch < 1.0 - aim.stretch => Ordering::Less,
        stretch if stretch > 1.0 + aim.stretch => Ordering::Greater,
        _ => Ordering::Equal,
    };
    match net.excess(v).cmp(&0).then_with(by_length) {
        Ordering::Less => {
            let length = |h: u32| (net.position[mesh.target(h) as usize] - p).length_squared();
            let shortest = mesh.around(v).min_by(|&g, &h| length(g).total_cmp(&length(h)));
            shortest.filter(|&h| net.can_merge(h)).map(Operation::Collapse)
        }
        Ordering::Greater => net.widest(v).map(Operation::Insert),
        Ordering::Equal => None,
    }
}
