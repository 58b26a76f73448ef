//! Steps of the relaxation: how long they are, whether they stand, and how particles move and
//! return to the surface.

use crate::math::{larger, refill};
use crate::particles::{OrientedPoint, Particles};
use crate::sampler::neighbours::constants::STALE_TURN;
use crate::sampler::neighbours::lists::NeighbourLists;
use crate::sampler::probe::{BATCH, Probe};
use crate::sampler::relaxation::MoveLimits;
use crate::sampler::relaxation::forces::Forces;
use crate::sampler::relaxation::repulsion::{LandingBatch, MAX_MOVE, Repulsion};
use core::ops::Range;
use glam::Vec3;

/// Factor by which the step size grows after a step that stands; it is halved after one that does
/// not, and recovers in 14 steps.
const GROWTH: f32 = 1.05;
/// Times that the way of a particle that has come to another sheet is halved. A choice.
const HALVINGS: u32 = 4;
/// The configuration counts as being at its minimum after more than this many rejected steps in a
/// row: the step is then shorter than a hundredth of the first.
const MAX_FAILURES: u32 = 6;

/// The step size and the state of every particle that a step changes.
#[derive(Clone, Default)]
pub(super) struct Stepper {
    limits: MoveLimits,
    pub(super) forces: Forces,
    /// Positions before the step under judgement.
    previous: Vec<Vec3>,
    /// Radii before that step; empty where radii do not change.
    previous_radius: Vec<f32>,
    /// Distance that each particle has travelled since its radius was brought up to date; empty
    /// where radii do not change.
    radius_travel: Vec<f32>,
    step_size: f32,
    /// Rejected steps in a row.
    failures: u32,
    /// Steps that stand.
    done: u32,
    /// Energy per particle before the first step and after each that stands.
    energy: Vec<f64>,
}

impl Stepper {
    /// Forgets an earlier run.
    pub(super) fn clear(&mut self) {
        self.done = 0;
        self.energy.clear();
    }

    /// Prepares for more steps; `first_size` is the size of the first step of a run.
    pub(super) fn begin(&mut self, limits: MoveLimits, particles: usize, first_size: f32, resizes: bool) {
        self.limits = limits;
        self.failures = 0;
        if self.done == 0 {
            self.step_size = first_size;
        }
        // After a stop the particles may be where no energy was measured, and after a run they have
        // been polished.
        self.energy.truncate(self.done as usize);
        self.resize(particles, resizes);
    }

    /// Prepares for particles on a surface that moves: there are no judgements, and all steps have
    /// one size.
    pub(super) fn begin_transport(&mut self, limits: MoveLimits, size: f32) {
        self.clear();
        (self.limits, self.step_size) = (limits, size);
    }

    /// Makes room for this many particles, of which nothing is known.
    pub(super) fn resize(&mut self, particles: usize, resizes: bool) {
        self.forces.reset(particles);
        refill(&mut self.previous, particles, Vec3::ZERO);
        let resized = if resizes { particles } else { 0 };
        refill(&mut self.radius_travel, resized, 0.0);
        refill(&mut self.previous_radius, resized, 0.0);
    }

    pub(super) fn done(&self) -> u32 {
        self.done
    }

    pub(super) fn energy(&self) -> &[f64] {
        &self.energy
    }

    /// Returns whether particles may come to another sheet.
    pub(super) fn may_stray(&self) -> bool {
        self.limits.largest_lift < f32::INFINITY
    }

    /// Returns whether the energy before the next step is known.
    pub(super) fn has_begun(&self) -> bool {
        self.energy.len() > self.done as usize
    }

    /// Records the energy per particle before the first step, unless that is known.
    pub(super) fn record_first(&mut self, energy: f64) {
        if !self.has_begun() {
            self.energy.push(energy);
        }
    }

    /// Accepts or rejects the last step by the energy per particle after it. Returns whether it
    /// stands: whether it has lowered the energy. The next step is a little longer then, and
    /// otherwise half as long, but never longer than `longest`.
    pub(super) fn judge(&mut self, energy: f64, longest: f32) -> bool {
        if self.energy.last().is_some_and(|&before| energy >= before) {
            self.step_size *= 0.5;
            self.failures += 1;
            return false;
        }
        self.step_size = (self.step_size * GROWTH).min(longest);
        self.failures = 0;
        self.done += 1;
        self.energy.push(energy);
        true
    }

    /// Returns whether no step of any size seems to lower the energy.
    pub(super) fn is_stuck(&self) -> bool {
        self.failures > MAX_FAILURES
    }

    /// Writes where the forces move the particles of `range`, in their tangent planes, to
    /// `landing`.
    pub(super) fn advance<L: Repulsion>(
        &mut self,
        law: &L,
        particles: &Particles,
        range: Range<usize>,
        landing: &mut LandingBatch,
    ) {
        for (point, i) in landing.position.iter_mut().zip(range) {
            let p = particles.local[i];
            let normal = particles.normal[i];
            let radius = law.radius(particles, i);
            let force = self.forces.take(i);
            let force = force - normal * normal.dot(force);
            self.previous[i] = p;
            if L::RESIZES {
                self.previous_radius[i] = radius;
            }
            *point = p + (force * self.step_size).clamp_length_max(MAX_MOVE * radius);
        }
    }

    /// Puts the particles of `range` back where they were before the step, and writes their
    /// positions to `landing`. The particles are not yet landed: their normals are still those of
    /// the positions that they have left.
    pub(super) fn take_back<L: Repulsion>(
        &mut self,
        law: &L,
        lists: &mut NeighbourLists,
        particles: &mut Particles,
        range: Range<usize>,
        landing: &mut LandingBatch,
    ) {
        for (point, i) in landing.position.iter_mut().zip(range) {
            let distance = (particles.local[i] - self.previous[i]).length();
            let radius = particles.radius[i];
            self.restore(particles, i);
            self.forces.take(i);
            if L::RESIZES {
                self.radius_travel[i] = (self.radius_travel[i] - distance).max(0.0);
            }
            add_travel(law, lists, particles, i, distance, particles.radius[i] - radius);
            *point = particles.local[i];
        }
    }

    /// Restores the position and the radius that particle `i` had before the step.
    pub(super) fn restore(&self, particles: &mut Particles, i: usize) {
        particles.local[i] = self.previous[i];
        if let Some(&radius) = self.previous_radius.get(i) {
            particles.radius[i] = radius;
        }
    }

    /// Moves the particles of `range` to where the positions in `landing` come to the surface, and
    /// gives them the normals and radii there. Those that have come there are the ones that are
    /// `ok` in `landing` then.
    ///
    /// A particle stays where it is if it lies on a crease, or cannot go: beyond the border of the
    /// box or of its patch, where the field ends, at a fold, across which its normal would turn by
    /// more than 90°, and where only another sheet is near.
    pub(super) fn land<L: Repulsion>(
        &mut self,
        law: &L,
        probe: &mut Probe,
        lists: &mut NeighbourLists,
        particles: &mut Particles,
        range: Range<usize>,
        landing: &mut LandingBatch,
    ) {
        landing.count = range.len();
        if L::RESIZES {
            landing.radius[..range.len()].copy_from_slice(&particles.radius[range.clone()]);
            for (k, i) in range.clone().enumerate() {
                let distance = (landing.position[k] - particles.local[i]).length();
                landing.radius_travel[k] = self.radius_travel[i] + distance;
            }
        }
        let goal = landing.position;
        law.land(probe, landing);
        if self.may_stray() {
            self.land_nearer(law, probe, particles, range.start, &goal, landing);
        }
        for (k, i) in range.enumerate() {
            let (position, normal) = (landing.position[k], landing.normal[k]);
            let cosine = normal.dot(particles.normal[i]);
            let is_free = i >= particles.twins.len();
            landing.ok[k] = landing.ok[k]
                && is_free
                && self.limits.bounds.contains(position)
                && cosine > 0.0
                && probe.is_on_patch(position, normal, law.radius(particles, i), particles.patch_of(i));
            if landing.ok[k] {
                // A turn of the normal counts as a move: the turn that makes a list stale as the
                // distance that does.
                let turn_sq = 2.0 - 2.0 * cosine;
                let per_turn = 0.5 * L::SKIN / STALE_TURN * law.radius(particles, i);
                let distance_sq = (position - particles.local[i]).length_squared();
                let distance = larger(distance_sq, turn_sq * (per_turn * per_turn)).sqrt();
                let mut grown = 0.0;
                if L::RESIZES {
                    grown = landing.radius[k] - particles.radius[i];
                    particles.radius[i] = landing.radius[k];
                    self.radius_travel[i] = landing.radius_travel[k];
                }
                add_travel(law, lists, particles, i, distance, grown);
                particles.local[i] = position;
                particles.normal[i] = normal;
            }
        }
    }

    /// Lands the particles of the batch that missed the surface, or came to another sheet of it,
    /// anew: nearer to where they were, on the way to the `goal`. `first` is the index of the first
    /// of the batch. Those that fail each time are not ok.
    fn land_nearer<L: Repulsion>(
        &self,
        law: &L,
        probe: &mut Probe,
        particles: &Particles,
        first: usize,
        goal: &[Vec3; BATCH],
        landing: &mut LandingBatch,
    ) {
        let has_left = |landing: &LandingBatch, k: usize| {
            let from = OrientedPoint::of(particles, first + k);
            let pair = from.pair(landing.position[k] - from.position, landing.normal[k]);
            !landing.ok[k] || pair.lift() > self.limits.largest_lift
        };
        let mut share = 1.0;
        for _ in 0..HALVINGS {
            share *= 0.5;
            let mut again = LandingBatch::new();
            (again.trust, again.renews_radii) = (landing.trust, landing.renews_radii);
            let mut which = [0; BATCH];
            for k in (0..landing.count).filter(|&k| has_left(landing, k)) {
                let (m, i) = (again.count, first + k);
                let p = particles.local[i];
                which[m] = k;
                again.position[m] = p.lerp(goal[k], share);
                if L::RESIZES {
                    again.radius[m] = particles.radius[i];
                    again.radius_travel[m] = self.radius_travel[i] + (again.position[m] - p).length();
                }
                again.count += 1;
            }
            if again.count == 0 {
                return;
            }
            law.land(probe, &mut again);
            for (m, &k) in which[..again.count].iter().enumerate() {
                (landing.position[k], landing.normal[k]) = (again.position[m], again.normal[m]);
                (landing.radius[k], landing.radius_travel[k]) = (again.radius[m], again.radius_travel[m]);
                landing.ok[k] = again.ok[m];
            }
        }
        for k in 0..landing.count {
            landing.ok[k] = !has_left(landing, k);
        }
    }
}

/// Notes in the `lists` that particle `i` has moved by `distance` and that its radius has grown by
/// `grown`.
///
/// A list serves until its particle has used up half of the skin: two such particles may have come
/// within range without being listed.
#[inline]
fn add_travel<L: Repulsion>(
    law: &L,
    lists: &mut NeighbourLists,
    particles: &Particles,
    i: usize,
    distance: f32,
    grown: f32,
) {
    let more = if L::RESIZES { 0.5 * L::RANGE * grown.max(0.0) } else { 0.0 };
    lists.add_travel(i, distance, more, 0.5 * L::SKIN * law.radius(particles, i));
}

/// The first part of a range of particles, up to where a batch of the projection ends or the
/// `patch` changes.
pub(super) fn batch(range: Range<usize>, patch: &[u32]) -> Range<usize> {
    let last = range.end.min((range.start / BATCH + 1) * BATCH);
    let is_other = |&i: &usize| patch.get(i) != patch.get(range.start);
    range.start..(range.start..last).find(is_other).unwrap_or(last)
}
