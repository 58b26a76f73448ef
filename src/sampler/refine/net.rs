//! The particles of one level and the surface between them: sweeps, flips and the return to the
//! surface.

use super::walls::{Planes, Site, Walls};
use crate::differential::Curvature;
use crate::math::{NONE, grow};
use crate::mesh::half_edge::{HalfEdges, next, previous};
use crate::particles::Slots;
use crate::sampler::constraint::{CreaseLadder, tips::LEAST_RING};
use crate::sampler::probe::{BATCH, Probe};
use glam::Vec3;

/// Particles that are moved before they return to the surface together. A choice.
pub(super) const BLOCK: usize = 64;

/// No move is longer than this share of the spacing. Larger: more narrow wedges are refused;
/// smaller: fewer. Elsewhere it hardly matters.
const MAX_MOVE: f32 = 0.3;
/// A particle whose correction is longer than this share of the spacing has left the surface and is
/// put back. Larger: a mesh may get an Euler number that the surface does not have.
const MAX_CORRECTION: f32 = 0.5;
/// No step to a surface that has moved is longer than this share of the spacing, as for particles
/// without a mesh.
const LONGEST_WAY: f32 = 1.0;
/// An edge is flipped only if its angles exceed π by more than rounding, which could flip it back
/// on a symmetric surface.
const FLIP_SLACK: f32 = 1e-5;

/// Neighbours nearer to each other than this share of the spacing move apart in Lloyd's method.
/// Smaller: the closest pairs are nearer, and the smallest angles smaller.
const SHORT: f32 = 0.86;
/// Share of the missing length by which each of the two moves. With halves one edge would be
/// restored, but a particle with several short ones would move too far.
const PUSH: f32 = 1.0 / 3.0;

/// The springs between neighbours: their energy is Σ (l − θa)² over the edges.
///
/// At θ = 1 the rest length is the spacing of the lattice. Below it the springs pull against a
/// surface that cannot shrink, which makes the lattice stiffer in shear: its bulk modulus over its
/// shear modulus is 2θ/(4 − 3θ).
#[derive(Clone, Copy, Debug)]
pub(super) struct Springs {
    /// Spacing a of the hexagonal lattice with the wanted number of particles, where the size of a
    /// particle is 1.
    pub(super) spacing: f32,
    /// Rest length over spacing, θ.
    pub(super) theta: f32,
    /// Over-relaxation factor ω. With 1 a particle moves to the equilibrium of its springs with all
    /// others held.
    pub(super) omega: f32,
}

impl Springs {
    pub(super) fn rest(&self) -> f32 {
        self.theta * self.spacing
    }
}

/// The field, with the buffers for evaluating it at blocks of particles.
pub(super) struct Ground<'a, 'field> {
    pub(super) probe: &'a mut Probe<'field>,
    pub(super) block: &'a mut MovedBlock,
}

/// Particles that have been moved and not yet returned to the surface.
#[derive(Clone, Debug, Default)]
pub(super) struct MovedBlock {
    which: Vec<u32>,
    /// Positions of the particles of the block before the move.
    before: Vec<Vec3>,
    points: Vec<Vec3>,
    /// Principal curvatures at the particles of the block, which determine their sizes.
    pub(super) curvature: Vec<Curvature>,
    /// Particles that could not return to the surface.
    pub(super) refused: Vec<u32>,
}

impl MovedBlock {
    fn clear(&mut self) {
        self.which.clear();
        self.before.clear();
        self.points.clear();
    }

    fn add(&mut self, v: u32, before: Vec3, after: Vec3) {
        self.which.push(v);
        self.before.push(before);
        self.points.push(after);
    }
}

/// Particles and the surface between them. Vertex `v` of the surface is particle `v` of every
/// column.
#[derive(Clone, Debug, Default)]
pub(super) struct Net {
    pub(super) mesh: HalfEdges,
    pub(super) position: Vec<Vec3>,
    pub(super) normal: Vec<Vec3>,
    /// Fates of the slots of the particles that the front placed; undecided for all others.
    pub(super) slots: Vec<Slots>,
    /// Wanted spacing at each particle, in units of the springs' spacing. Empty if it is the same
    /// everywhere.
    pub(super) size: Vec<f32>,
    /// The box, and its planes on which the particles lie.
    pub(super) walls: Walls,
    /// The number of each particle on a crease or a tip: see [`CreaseLadder`]. [`NONE`] for the
    /// others; empty if the surface has neither.
    pub(super) on_crease: Vec<u32>,
    /// Whether each particle was born since the surface moved. Empty if no surface moves.
    pub(super) is_born: Vec<bool>,
}

impl Net {
    /// A net over the surface with columns still to be filled.
    pub(super) fn with_room(mesh: HalfEdges, count: usize) -> Self {
        Self {
            mesh,
            position: Vec::with_capacity(count),
            normal: Vec::with_capacity(count),
            slots: Vec::with_capacity(count),
            ..Self::default()
        }
    }

    /// Wanted spacing at `v`, in units of the springs' spacing.
    #[inline]
    pub(super) fn size_of(&self, v: u32) -> f32 {
        self.size.get(v as usize).copied().unwrap_or(1.0)
    }

    /// Whether sizes vary.
    pub(super) fn is_graded(&self) -> bool {
        !self.size.is_empty()
    }

    /// Wanted length of the edge between two particles, in units of the spacing.
    #[inline]
    pub(super) fn size_between(&self, a: u32, b: u32) -> f32 {
        0.5 * (self.size_of(a) + self.size_of(b))
    }

    /// Moves each particle by its springs, and then returns them to the surface together.
    ///
    /// As in the Gauss–Seidel method, a particle sees the new places of those before it. These are
    /// not yet back on the surface, which changes distances only in second order.
    #[inline]
    pub(super) fn relax(
        &mut self,
        ground: &mut Ground,
        springs: Springs,
        particles: impl Iterator<Item = u32>,
    ) {
        self.shift(ground, springs.spacing, particles, |net, v| net.pull(springs, v));
    }

    /// Moves each particle by its springs along its tangent plane, without returning it to the
    /// surface.
    pub(super) fn drift(&mut self, springs: Springs, particles: impl Iterator<Item = u32>) {
        for v in particles.filter(|&v| self.mesh.has_vertex(v)) {
            self.position[v as usize] = self.moved(v, springs.spacing, self.pull(springs, v));
        }
    }

    /// The step by which the springs move a particle.
    #[inline]
    fn pull(&self, springs: Springs, v: u32) -> Vec3 {
        let rest = springs.rest();
        // The second derivative of the energy, averaged over all directions, is this per neighbour.
        let stiffness = 1.0 - 0.5 * springs.theta;
        let p = self.position[v as usize];
        let (mut force, mut degree) = (Vec3::ZERO, 0.0_f32);
        for other in self.mesh.neighbours(v) {
            let offset = p - self.position[other as usize];
            force += offset * (rest * self.size_between(v, other) / offset.length() - 1.0);
            degree += 1.0;
        }
        force * (springs.omega / (degree * stiffness))
    }

    /// Mean length of the edges of `v`, relative to the wanted lengths.
    pub(super) fn mean_stretch(&self, springs: Springs, v: u32) -> f32 {
        let p = self.position[v as usize];
        let (mut sum, mut degree) = (0.0, 0.0_f32);
        for other in self.mesh.neighbours(v) {
            let wanted = springs.spacing * self.size_between(v, other);
            sum += (self.position[other as usize] - p).length() / wanted;
            degree += 1.0;
        }
        sum / degree
    }

    /// Moves each particle to the centre of its Voronoi cell, with the over-relaxation of the
    /// springs, and away from neighbours that are too near: Lloyd's method keeps short the edges of
    /// a five, and the edge across a face from a seven.
    pub(super) fn centre(
        &mut self,
        ground: &mut Ground,
        springs: Springs,
        particles: impl Iterator<Item = u32>,
    ) {
        self.shift(ground, springs.spacing, particles, |net, v| {
            if net.mesh.is_border(v) {
                net.way_along_border(v)
            } else {
                net.way_to_centre(v) * springs.omega + net.way_apart(springs.spacing, v)
            }
        });
    }

    /// The step of `v` away from neighbours that are too near.
    fn way_apart(&self, spacing: f32, v: u32) -> Vec3 {
        let p = self.position[v as usize];
        let mut step = Vec3::ZERO;
        for other in self.mesh.neighbours(v) {
            let offset = p - self.position[other as usize];
            let missing = SHORT * spacing * self.size_between(v, other) / offset.length() - 1.0;
            step += offset * (PUSH * missing.max(0.0));
        }
        step
    }

    /// Vector from `v` to the centre of its Voronoi cell, whose corners are the circumcentres of
    /// the faces around it.
    fn way_to_centre(&self, v: u32) -> Vec3 {
        let (p, n) = (self.position[v as usize], self.normal[v as usize]);
        let circumcentre = |h: u32| {
            let b = self.position[self.mesh.target(h) as usize] - p;
            let c = self.position[self.mesh.origin(previous(h)) as usize] - p;
            let normal = b.cross(c);
            (normal.cross(b) * c.length_squared() + c.cross(normal) * b.length_squared())
                / (2.0 * normal.length_squared())
        };
        let mut around = self.mesh.around(v);
        let Some(first) = around.next().map(circumcentre) else { return Vec3::ZERO };
        let (mut last, mut moment, mut area) = (first, Vec3::ZERO, 0.0);
        let mut add = |a: Vec3, b: Vec3| {
            let twice = a.cross(b).dot(n);
            moment += (a + b) * twice;
            area += twice;
        };
        for h in around {
            let here = circumcentre(h);
            add(last, here);
            last = here;
        }
        add(last, first);
        moment / (3.0 * area)
    }

    /// Moves each particle by the tangential part of `step`, one after the other, and returns all
    /// to the surface.
    #[inline]
    fn shift(
        &mut self,
        ground: &mut Ground,
        spacing: f32,
        particles: impl Iterator<Item = u32>,
        step: impl Fn(&Self, u32) -> Vec3,
    ) {
        ground.block.clear();
        for v in particles {
            if !self.mesh.has_vertex(v) || self.is_pinned(v) {
                continue;
            }
            let p = self.position[v as usize];
            let moved = self.moved(v, spacing, step(self, v));
            self.position[v as usize] = moved;
            ground.block.add(v, p, moved);
        }
        self.settle(ground, spacing, false);
    }

    /// The position of a particle after the tangential part of a step, at most a share of the
    /// spacing long.
    #[inline]
    fn moved(&self, v: u32, spacing: f32, step: Vec3) -> Vec3 {
        let (p, n) = (self.position[v as usize], self.normal[v as usize]);
        let planes = self.walls.planes(v);
        let mut step =
            if planes.is_inner() { step - n * step.dot(n) } else { self.walls.along(planes, n, step) };
        let length = step.length();
        let farthest = MAX_MOVE * spacing * self.size_of(v);
        if length > farthest {
            step *= farthest / length;
        }
        // Two particles at one place define no direction.
        if step.is_finite() { p + step } else { p }
    }

    /// Moves particles near the surface onto it, or particles of a moved surface onto the new one:
    /// out of the box if they `may_leave` it.
    pub(super) fn land(
        &mut self,
        ground: &mut Ground,
        spacing: f32,
        particles: impl Iterator<Item = u32>,
        may_leave: bool,
    ) {
        ground.block.clear();
        for v in particles.filter(|&v| self.mesh.has_vertex(v) && !self.is_pinned(v)) {
            let p = self.position[v as usize];
            ground.block.add(v, p, p);
        }
        self.settle(ground, spacing, may_leave);
    }

    /// Returns the particles of the block to the surface by one step of Newton's method along the
    /// gradient, and to their planes of the box, out of the box if they `may_leave` it. Particles
    /// that cannot return are put back.
    fn settle(&mut self, ground: &mut Ground, spacing: f32, may_leave: bool) {
        let MovedBlock { which, before, points, refused, .. } = &mut *ground.block;
        refused.clear();
        for first in (0..points.len()).step_by(BATCH) {
            let range = first..points.len().min(first + BATCH);
            let (value, gradient) = ground.probe.gradients(&points[range.clone()]);
            let moved = which[range.clone()].iter().zip(&before[range.clone()]).zip(&points[range]);
            for (((&v, &before), &p), (&value, &gradient)) in moved.zip(value.iter().zip(gradient)) {
                if let Some((position, normal)) = self.landing(v, p, value, gradient, spacing, may_leave) {
                    self.position[v as usize] = position;
                    self.normal[v as usize] = normal;
                } else {
                    self.position[v as usize] = before;
                    refused.push(v);
                }
            }
        }
    }

    /// The position of a particle at `p` after one step of Newton's method, and the normal there;
    /// none if it cannot return.
    #[inline]
    fn landing(
        &self,
        v: u32,
        p: Vec3,
        value: f32,
        gradient: Vec3,
        spacing: f32,
        may_leave: bool,
    ) -> Option<(Vec3, Vec3)> {
        let inverse_slope = 1.0 / gradient.length();
        let normal = gradient * inverse_slope;
        let correction = value * inverse_slope;
        let share = if may_leave { LONGEST_WAY } else { MAX_CORRECTION };
        let longest = share * spacing * self.size_of(v);
        let planes = self.walls.planes(v);
        let position = if self.walls.is_near() {
            self.walls.landing(planes, p, value, gradient, longest, may_leave)
        } else {
            (correction.abs() <= longest).then(|| p - normal * correction)
        };
        // A particle on a crease keeps its normal where f is infinitely steep.
        let normal = if normal.is_finite() { normal } else { self.normal[v as usize] };
        position.map(|position| (position, normal))
    }

    /// Whether the two angles under which the edge of `h` is seen add up to more than π, so that
    /// the other diagonal of its quadrilateral is Delaunay's, and the flip is allowed.
    #[inline]
    pub(super) fn wants_flip(&self, h: u32) -> bool {
        let t = self.mesh.twin(h);
        if t == NONE {
            return false;
        }
        let at = |h: u32| self.position[self.mesh.origin(h) as usize];
        let (a, b, c, d) = (at(h), at(t), at(previous(h)), at(previous(t)));
        let (ca, cb, da, db) = (a - c, b - c, a - d, b - d);
        let (cos_c, cos_d) = (ca.dot(cb), da.dot(db));
        // Two angles that are not obtuse: nearly every edge.
        if cos_c >= 0.0 && cos_d >= 0.0 {
            return false;
        }
        let (sin_c, sin_d) = (ca.cross(cb).length(), da.cross(db).length());
        let slack = FLIP_SLACK * (sin_c + sin_d) * (ca.length_squared() + da.length_squared());
        // The sine of the sum, times the lengths.
        if cos_c * sin_d + sin_c * cos_d >= -slack {
            return false;
        }
        let [v, w, x, y] = [h, t, previous(h), previous(t)].map(|h| self.mesh.origin(h));
        if self.walls.is_near()
            && (self.is_along_border([v, x, y])
                || self.is_along_border([w, x, y])
                || [v, w].into_iter().any(|v| self.is_narrow_tip(v)))
        {
            return false;
        }
        // Both new faces must look outward.
        let up = self.normal[self.mesh.origin(previous(h)) as usize]
            + self.normal[self.mesh.origin(previous(t)) as usize];
        (d - a).cross(c - a).dot(up) > 0.0 && (c - b).cross(d - b).dot(up) > 0.0 && self.mesh.can_flip(h)
    }

    /// Flips the edges of these half-edges that are not Delaunay; each edge is examined once.
    pub(super) fn flip(&mut self, half_edges: core::ops::Range<u32>) {
        for h in half_edges {
            if self.mesh.has_half_edge(h) && h < self.mesh.twin(h) && self.wants_flip(h) {
                self.mesh.flip(h);
            }
        }
    }

    /// Twice the area of a face, as a vector outward.
    pub(super) fn area_vector(&self, [a, b, c]: [u32; 3]) -> Vec3 {
        let a = self.position[a as usize];
        (self.position[b as usize] - a).cross(self.position[c as usize] - a)
    }

    /// Whether a face with this [area vector](Self::area_vector) faces as the surface does at its
    /// corner `v`: the cosine of the angle between them is above `least`. At a tip, where the
    /// surface has no normal, any face does.
    pub(super) fn faces_as(&self, area: Vec3, v: u32, least: f32) -> bool {
        // Written so that NaN does not.
        area.dot(self.normal[v as usize]) > least * area.length() || self.is_tip(v)
    }

    /// A half-edge of the widest face at `v`.
    pub(super) fn widest(&self, v: u32) -> Option<u32> {
        let corners = |h: u32| [h, next(h), previous(h)].map(|h| self.mesh.origin(h));
        let area = |h: u32| self.area_vector(corners(h)).length_squared();
        self.mesh.around(v).max_by(|&g, &h| area(g).total_cmp(&area(h)))
    }

    /// The site of a particle.
    pub(super) fn site(&self, v: u32) -> Site {
        Site {
            position: self.position[v as usize],
            normal: self.normal[v as usize],
            planes: self.walls.planes(v),
            number: self.on_crease.get(v as usize).copied().unwrap_or(NONE),
        }
    }

    /// The normals at two neighbours. A tip has none: along a ray of a cone the normal is
    /// everywhere that of the other end.
    fn normals(&self, a: u32, b: u32) -> [Vec3; 2] {
        let own = |v: u32, other: u32| self.normal[if self.is_tip(v) { other } else { v } as usize];
        [own(a, b), own(b, a)]
    }

    /// The middle of the edge between two particles, lifted to the circle through them with their
    /// normals, and the outward unit normal there.
    #[inline]
    fn lifted(&self, a: u32, b: u32) -> (Vec3, Vec3) {
        let (p, q) = (self.position[a as usize], self.position[b as usize]);
        let [n, m] = self.normals(a, b);
        let (normal, turn) = ((n + m).normalize_or(n), m - n);
        ((p + q) * 0.5 + normal * (0.125 * (q - p).dot(turn)), normal)
    }

    /// The middle of the edge between two particles, [lifted](Self::lifted).
    #[inline]
    pub(super) fn middle(&self, a: u32, b: u32) -> Vec3 {
        self.lifted(a, b).0
    }

    /// The site of a particle that halves the edge between two others.
    pub(super) fn halfway(&self, a: u32, b: u32) -> Site {
        let (position, normal) = self.lifted(a, b);
        Site::smooth(position, normal, self.planes_between(a, b))
    }

    /// Whether a particle is fixed, with its normal: creases end there, or it is a tip, where f has
    /// no gradient.
    #[inline]
    fn is_pinned(&self, v: u32) -> bool {
        self.walls.planes(v).is_crease_end()
    }

    /// Whether a particle is a tip, where the surface has no normal.
    #[inline]
    pub(super) fn is_tip(&self, v: u32) -> bool {
        self.is_pinned(v) && !self.mesh.is_border(v)
    }

    /// Whether a particle is a tip that can spare no neighbour: three faces around it would face
    /// away from each other.
    fn is_narrow_tip(&self, v: u32) -> bool {
        self.is_tip(v) && self.mesh.valence(v) <= LEAST_RING as usize
    }

    /// Difference between a particle's valence and the valence without a defect: six, and four on
    /// the border, where three triangles of 60° fill the half-plane. Where creases end and at tips
    /// every valence is good.
    #[inline]
    pub(super) fn excess(&self, v: u32) -> i32 {
        if self.is_pinned(v) {
            return 0;
        }
        let wanted = if self.walls.is_near() && self.mesh.is_border(v) { 4 } else { 6 };
        self.mesh.valence(v) as i32 - wanted
    }

    /// The site of the particle that is bound to more planes, `b` if both are bound to equally
    /// many.
    pub(super) fn more_bound(&self, a: u32, b: u32) -> Site {
        let [first, second] = [a, b].map(|v| self.site(v));
        if first.planes.count() > second.planes.count() { first } else { second }
    }

    /// Resizes every filled column to this many rows; new rows have to be [put](Self::put_new)
    /// somewhere.
    pub(super) fn resize(&mut self, rows: usize) {
        fn resize<T: Copy>(column: &mut Vec<T>, rows: usize, value: T) {
            if !column.is_empty() {
                grow(column, rows, value);
            }
        }
        resize(&mut self.position, rows, Vec3::ZERO);
        resize(&mut self.normal, rows, Vec3::ZERO);
        resize(&mut self.slots, rows, Slots::default());
        resize(&mut self.size, rows, 1.0);
        resize(&mut self.walls.planes, rows, Planes::INNER);
        resize(&mut self.on_crease, rows, NONE);
        resize(&mut self.is_born, rows, true);
    }

    /// Puts a new particle of this size at a site. Its number is the next one, or that of a merged
    /// particle.
    pub(super) fn put_new(&mut self, v: u32, site: Site, size: f32) {
        self.resize(self.position.len().max(v as usize + 1));
        self.put(v, site);
        self.slots[v as usize] = Slots::default();
        if let Some(own) = self.size.get_mut(v as usize) {
            *own = size;
        }
        if let Some(is_born) = self.is_born.get_mut(v as usize) {
            *is_born = true;
        }
    }

    /// Moves a particle to a site.
    pub(super) fn put(&mut self, v: u32, site: Site) {
        self.position[v as usize] = site.position;
        self.normal[v as usize] = site.normal;
        self.walls.set(v, site.planes);
        if let Some(number) = self.on_crease.get_mut(v as usize) {
            *number = site.number;
        }
    }

    /// Fixes the particles on creases, which have these numbers.
    pub(super) fn hold_creases(&mut self, ladder: &CreaseLadder, numbers: Vec<u32>) {
        self.walls.planes.resize(self.position.len(), Planes::INNER);
        for (v, &number) in (0..).zip(&numbers).filter(|(_, number)| **number != NONE) {
            let planes = if ladder.is_at_box(number) {
                Planes::CREASE_END.joined(self.walls.planes_at(self.position[v as usize]))
            } else if ladder.is_corner(number) {
                Planes::CREASE_END
            } else {
                Planes::CREASE
            };
            self.walls.set(v, planes);
        }
        self.on_crease = numbers;
    }

    /// Whether the patch ends at creases.
    pub(super) fn is_creased(&self) -> bool {
        let is_at_end = |v: u32| self.mesh.has_vertex(v) && self.mesh.is_border(v);
        self.on_crease.iter().zip(0..).any(|(&number, v)| number != NONE && is_at_end(v))
    }

    /// The number and the position of the particle that halves an edge along a crease; none for
    /// other edges.
    pub(super) fn middle_on_crease(&self, ladder: &CreaseLadder, a: u32, b: u32) -> Option<(u32, Vec3)> {
        let [m, n] = [a, b].map(|v| self.on_crease[v as usize]);
        let is_between = m != NONE && n != NONE && self.is_border_edge(a, b);
        if is_between { ladder.middle(m, n) } else { None }
    }

    /// Adds the next particle of a level finer than `coarse`: the middle of an edge between two of
    /// its particles, or the old one v if the ends are `[v, NONE]`. On creases the ladder's
    /// particle is used.
    pub(super) fn push_from(&mut self, coarse: &Self, ends: [u32; 2], ladder: Option<&CreaseLadder>) {
        let (mut site, slots, size) = match ends {
            [old, NONE] => (coarse.site(old), coarse.slots[old as usize], coarse.size_of(old)),
            [a, b] => (coarse.halfway(a, b), Slots::default(), coarse.size_between(a, b)),
        };
        if let Some(ladder) = ladder {
            if let [a, b] = ends
                && b != NONE
                && let Some((number, position)) = coarse.middle_on_crease(ladder, a, b)
            {
                site = Site { position, planes: Planes::CREASE, number, ..site };
            }
            self.on_crease.push(site.number);
        }
        self.position.push(self.walls.pinned(site.position, site.planes));
        self.normal.push(site.normal);
        self.slots.push(slots);
        self.size.extend(coarse.is_graded().then_some(size));
        self.walls.planes.extend(coarse.walls.is_near().then_some(site.planes));
    }

    /// Whether the two ends of a half-edge can be merged: the mesh keeps its topology, corners
    /// stay, and a particle on the border is merged only along the border. A particle on a crease
    /// stays, and only takes in one next to it on a face of the box.
    pub(super) fn can_merge(&self, h: u32) -> bool {
        let [m, n] = [self.mesh.origin(h), self.mesh.target(h)].map(|v| self.walls.planes(v));
        let is_along_box = self.mesh.twin(h) == NONE && !m.common(n).of_box().is_inner();
        if !self.mesh.can_collapse(h) || m.is_crease() && (n.is_crease() || !is_along_box) {
            return false;
        }
        // The corners across from the edge lose a neighbour.
        let across = [h, self.mesh.twin(h)].into_iter().filter(|&h| h != NONE);
        if across.map(|h| self.mesh.origin(previous(h))).any(|v| self.is_narrow_tip(v)) {
            return false;
        }
        if m.is_inner() && n.is_inner() {
            return true;
        }
        if self.mesh.twin(h) != NONE {
            // An inner particle is merged into the border; the other way would move the border.
            return m.is_inner();
        }
        !(m.common(n).is_inner() || m.is_corner() && n.is_corner())
    }
}
