//! Relaxation: every particle moves against the repulsion of its neighbours in the tangent plane and is brought back onto
//! the surface, a given number of times (paper §4.5 and the end of §5).
//!
//! What repels is a law of pairs ([`Repulsion`]): a Gaussian for particles of one size, the overlap for particles of many.
//! Steps, neighbour lists and the way back onto the surface are the same.
//!
//! # Differs from the paper
//!
//! * The step is not fixed but as large as stays stable: a step that does not lower the energy is taken back and halved,
//!   so the energy falls at every step.

use super::adaptive_grid::RadiusGrids;
use super::pairs::Pairs;
use super::project::{BATCH, Projector, Tolerance};
use super::repulsion::{Gaussian, Overlap, Points, Repulsion};
use super::sizing::Sizing;
use crate::field::Field;

use crate::math::Bounds;
use crate::particles::Particles;
use crate::spatial::{Neighbour, Vicinity};
use core::ops::Range;
use glam::Vec3;

/// Range of the Gaussian, in radii.
pub(super) const CUT_OFF: f32 = Gaussian::RANGE;
/// What the neighbour lists of particles of one size reach farther, in radii.
pub(super) const SKIN: f32 = Gaussian::SKIN;
/// Step sizes halve after a failure and grow back by this factor after a success.
const GROWTH: f32 = 1.05;
/// Failures in a row after which the configuration counts as being at its minimum.
const MAX_FAILURES: u32 = 6;
/// No particle moves farther than this in one step, in radii.
pub(super) const MAX_MOVE: f32 = 0.35;
/// A Newton correction shorter than this, in radii, leaves a residual of the order of its square.
const TRUSTED_CORRECTION: f32 = 0.02;

/// What a relaxation does next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Put the particles around those who have gone far into the grid.
    Grid,
    /// Make the lists of those who have gone far anew.
    Refresh,
    Forces,
    Judge,
    Move,
    Restore,
    Polish,
    /// Lower the radii that a neighbour's does not allow: before a step and after the last.
    Grade,
    Done,
}

/// What repels, and what it takes to be on the surface.
#[derive(Clone, Copy, Debug)]
pub(super) enum Law {
    /// Particles of this radius.
    Gaussian { radius: f32, tolerance: Tolerance },
    /// Particles of many radii, on a surface that single precision resolves to `resolution`.
    Overlap { resolution: f32, min_gradient: f32 },
}

/// The surface that the particles stay on.
pub(super) struct Surface<'a> {
    pub(super) field: &'a mut dyn Field,
    pub(super) projector: &'a mut Projector,
    /// The radius field of an adaptive run.
    pub(super) sizing: Option<&'a Sizing>,
}

/// A relaxation under way.
#[derive(Clone)]
pub(super) struct Relaxation {
    law: Law,
    bounds: Bounds,
    target: u32,
    done: u32,
    stage: Stage,
    next: usize,
    grids: RadiusGrids,
    found: Vec<Neighbour>,
    list: Vec<u32>,
    /// Particles that have gone far since their lists were made.
    far: Vec<u32>,
    vicinity: Vicinity,
    /// Whether all lists are made anew.
    all: bool,
    /// Length of each particle's way since its lists were made.
    way: Vec<f32>,
    /// Sum of (p_i − p_j) exp(−d²/2σ²) over the neighbours.
    force: Vec<Vec3>,
    /// Positions before the step under judgement; empty before the first.
    previous: Vec<Vec3>,
    has_previous: bool,
    /// Radii before that step, where they change.
    previous_radius: Vec<f32>,
    /// Length of each particle's way since its radius was brought up to date, where radii change.
    since: Vec<f32>,
    /// Whether this pass over the radii has lowered one, and whether any has.
    lowered: bool,
    steep: bool,
    /// Whether only the grading is left to do.
    ending: bool,
    step_size: f32,
    failures: u32,
    /// Energy of the positions whose forces are being computed.
    sum: f64,
    pub(super) energy: Vec<f64>,
}

impl Relaxation {
    pub(super) fn new() -> Self {
        Self {
            law: Law::Gaussian { radius: 1.0, tolerance: Tolerance::default() },
            bounds: Bounds::cube(1.0),
            target: 0,
            done: 0,
            stage: Stage::Done,
            next: 0,
            grids: RadiusGrids::new(),
            found: Vec::new(),
            list: Vec::new(),
            far: Vec::new(),
            vicinity: Vicinity::default(),
            all: false,
            way: Vec::new(),
            force: Vec::new(),
            previous: Vec::new(),
            has_previous: false,
            previous_radius: Vec::new(),
            since: Vec::new(),
            lowered: false,
            steep: false,
            ending: false,
            step_size: 0.0,
            failures: 0,
            sum: 0.0,
            energy: Vec::new(),
        }
    }

    /// Forgets an earlier run.
    pub(super) fn clear(&mut self) {
        self.done = 0;
        self.stage = Stage::Done;
        self.energy.clear();
    }

    /// Goes on until `target` steps are done in all. `pairs` are the lists of the front, if it was not cut short.
    pub(super) fn begin(
        &mut self,
        law: Law,
        bounds: &Bounds,
        target: u32,
        particles: usize,
        pairs: &mut Pairs,
    ) {
        self.law = law;
        self.bounds = *bounds;
        self.target = target;
        self.has_previous = false;
        self.failures = 0;
        if self.done == 0 {
            self.step_size = match law {
                Law::Gaussian { .. } => Gaussian::STEP,
                Law::Overlap { .. } => Overlap::STEP,
            };
        }
        self.energy.truncate(self.done as usize);
        self.way.clear();
        self.way.resize(particles, 0.0);
        self.far.clear();
        self.all = false;
        self.steep = false;
        self.since.clear();
        self.previous_radius.clear();
        if matches!(law, Law::Overlap { .. }) {
            self.since.resize(particles, 0.0);
        }
        self.ending = target == 0 && matches!(law, Law::Overlap { .. });
        if pairs.len() == particles && self.done == 0 && !self.ending {
            self.after_lists(particles);
        } else {
            pairs.extend_to(particles);
            self.make_lists(particles);
        }
    }

    pub(super) fn is_done(&self) -> bool {
        self.stage == Stage::Done
    }

    pub(super) fn steps_done(&self) -> u32 {
        self.done
    }

    /// Takes back a step that is only half made. Returns whether positions changed.
    pub(super) fn abandon(&mut self, particles: &mut Particles) -> bool {
        let moved = match self.stage {
            Stage::Move => 0..self.next,
            Stage::Restore => self.next..self.previous.len(),
            _ => 0..0,
        };
        for i in moved.clone() {
            self.restore(particles, i);
        }
        self.stage = Stage::Done;
        !moved.is_empty()
    }

    fn enter(&mut self, stage: Stage) {
        self.stage = stage;
        self.next = 0;
    }

    /// Does up to `budget` units (one particle in one stage); returns what is left and whether particles moved. `sizing` is
    /// the radius field of an adaptive run.
    pub(super) fn step(
        &mut self,
        surface: &mut Surface,
        pairs: &mut Pairs,
        particles: &mut Particles,
        budget: u32,
    ) -> (u32, bool) {
        match (self.law, surface.sizing) {
            (Law::Gaussian { radius, tolerance }, _) => {
                self.run(&Gaussian::new(radius, tolerance), surface, pairs, particles, budget)
            }
            (Law::Overlap { resolution, min_gradient }, Some(sizing)) => {
                let law = Overlap { sizing, resolution, min_gradient };
                self.run(&law, surface, pairs, particles, budget)
            }
            (Law::Overlap { .. }, None) => panic!("an adaptive run has a radius field"),
        }
    }

    fn run<L: Repulsion>(
        &mut self,
        law: &L,
        surface: &mut Surface,
        pairs: &mut Pairs,
        particles: &mut Particles,
        mut budget: u32,
    ) -> (u32, bool) {
        let mut moved = false;
        while budget > 0 && self.stage != Stage::Done {
            let n = if self.stage == Stage::Refresh { self.far.len() } else { particles.len() };
            let last = n.min(self.next + budget as usize);
            let range = self.next..last;
            budget -= range.len() as u32;
            self.next = last;
            match self.stage {
                Stage::Grid => {
                    if range.start == 0 {
                        let reach = L::RANGE + L::SKIN;
                        let (smallest, largest) = law.extent(particles);
                        self.grids.reset(smallest, largest, reach);
                        if !self.all {
                            self.vicinity.reset(reach * largest, self.far.len());
                            for &i in &self.far {
                                self.vicinity.add(particles.position[i as usize]);
                            }
                        }
                    }
                    for i in range {
                        let p = particles.position[i];
                        if self.all || self.vicinity.may_hold(p) {
                            self.grids.insert(p, law.radius(particles, i), i as u32);
                        }
                    }
                    if last == n {
                        self.enter(Stage::Refresh);
                    }
                }
                Stage::Refresh => {
                    for k in range {
                        self.refresh(law, pairs, particles, self.far[k] as usize);
                    }
                    if last == n {
                        self.far.clear();
                        self.all = false;
                        self.after_lists(particles.len());
                    }
                }
                Stage::Forces => {
                    for i in range {
                        self.repel(law, pairs, particles, i);
                    }
                    if last == n {
                        self.enter(Stage::Judge);
                    }
                }
                Stage::Judge => self.judge::<L>(particles),
                Stage::Move => {
                    let mut points = Points::new();
                    for first in (range.start..last).step_by(BATCH) {
                        let range = first..last.min(first + BATCH);
                        self.advance(law, particles, range.clone(), &mut points);
                        self.land(law, surface, particles, range, &mut points, TRUSTED_CORRECTION);
                    }
                    moved |= !range.is_empty();
                    if last == n {
                        self.after_moving(n);
                    }
                }
                Stage::Restore => {
                    for i in range {
                        let back = (particles.position[i] - self.previous[i]).length();
                        let shrunk = particles.radius[i];
                        self.restore(particles, i);
                        if L::RESIZES {
                            self.since[i] = (self.since[i] - back).max(0.0);
                        }
                        self.went(law, particles, i, back, particles.radius[i] - shrunk);
                    }
                    moved = true;
                    if last == n {
                        self.has_previous = false;
                        self.after_moving(n);
                    }
                }
                Stage::Polish => {
                    let mut points = Points::new();
                    for first in (range.start..last).step_by(BATCH) {
                        let range = first..last.min(first + BATCH);
                        points.position[..range.len()].copy_from_slice(&particles.position[range.clone()]);
                        self.land(law, surface, particles, range, &mut points, 0.0);
                    }
                    moved |= !range.is_empty();
                    if last == n {
                        if L::RESIZES {
                            // The grading is a promise about all pairs: none may be missing that the front or a change of
                            // radii has left out.
                            self.ending = true;
                            self.make_lists(n);
                        } else {
                            self.enter(Stage::Done);
                        }
                    }
                }
                Stage::Grade => {
                    for i in range {
                        self.lowered |= grade(law.slope(), pairs, particles, i);
                    }
                    if last == n {
                        let lowered = core::mem::take(&mut self.lowered);
                        self.steep |= lowered;
                        if lowered {
                            self.enter(Stage::Grade);
                        } else if self.ending {
                            self.enter(Stage::Done);
                        } else {
                            self.begin_forces(n);
                        }
                    }
                }
                Stage::Done => {}
            }
        }
        (budget, moved)
    }

    /// Makes all lists anew.
    fn make_lists(&mut self, n: usize) {
        self.far.clear();
        self.far.extend(0..n as u32);
        self.all = true;
        self.enter(Stage::Grid);
    }

    /// Whether the forces of the particles as they were given have been computed.
    fn has_begun(&self) -> bool {
        self.energy.len() > self.done as usize
    }

    /// Goes on from complete lists: to the forces or, where the radii may differ too much, by way of their grading.
    fn after_lists(&mut self, n: usize) {
        let differ = match self.law {
            Law::Gaussian { .. } => false,
            Law::Overlap { .. } => self.steep || self.ending || !self.has_begun(),
        };
        if differ {
            self.enter(Stage::Grade);
        } else {
            self.begin_forces(n);
        }
    }

    fn begin_forces(&mut self, n: usize) {
        self.force.clear();
        self.force.resize(n, Vec3::ZERO);
        self.sum = 0.0;
        self.enter(Stage::Forces);
    }

    /// Goes on from new places, by way of new lists where the old ones may miss a pair.
    fn after_moving(&mut self, n: usize) {
        if self.far.is_empty() {
            self.after_lists(n);
        } else {
            self.enter(Stage::Grid);
        }
    }

    /// Notes that particle `i` has gone some way and grown: two particles of which each has used up half of its skin may
    /// have come within range without being listed.
    #[inline]
    fn went<L: Repulsion>(&mut self, law: &L, particles: &Particles, i: usize, distance: f32, grown: f32) {
        let before = self.way[i];
        let mut after = before + distance;
        if L::RESIZES {
            after += 0.5 * L::RANGE * grown.max(0.0);
        }
        self.way[i] = after;
        let limit = 0.5 * L::SKIN * law.radius(particles, i);
        if after > limit && before <= limit {
            self.far.push(i as u32);
        }
    }

    /// Makes the list of particle `i` anew: those of its sheet and of a smaller index within the range and the skin. Those of
    /// a larger index get it into their lists.
    fn refresh<L: Repulsion>(&mut self, law: &L, pairs: &mut Pairs, particles: &Particles, i: usize) {
        self.way[i] = 0.0;
        let radius = law.radius(particles, i);
        let listed = |other: f32| 0.5 * (L::RANGE + L::SKIN) * (radius + other);
        self.grids.gather(particles.position[i], listed, &mut self.found);
        let normal = particles.normal[i];
        self.list.clear();
        for &Neighbour { index: j, distance_sq, .. } in &self.found {
            if particles.normal[j as usize].dot(normal) <= 0.0 {
                continue;
            }
            if L::RESIZES {
                let reach = listed(law.radius(particles, j as usize));
                if distance_sq > reach * reach {
                    continue;
                }
            }
            if (j as usize) < i {
                self.list.push(j);
            } else if j as usize != i && !self.all {
                pairs.insert(j as usize, i as u32);
            }
        }
        pairs.replace(i, &self.list);
    }

    /// Adds the repulsion between particle `i` and its listed neighbours to the forces on both, and to the energy.
    #[inline]
    fn repel<L: Repulsion>(&mut self, law: &L, pairs: &Pairs, particles: &Particles, i: usize) {
        let p = particles.position[i];
        let radius = law.radius(particles, i);
        let mut force = Vec3::ZERO;
        let mut energy = 0.0;
        for &j in pairs.of(i) {
            let j = j as usize;
            let offset = p - particles.position[j];
            let (weight, of_pair) = law.pair(offset, 0.5 * (radius + law.radius(particles, j)));
            energy += of_pair;
            force += offset * weight;
            self.force[j] -= offset * weight;
        }
        self.force[i] += force;
        self.sum += f64::from(energy);
    }

    /// Accepts the last step or has it taken back.
    fn judge<L: Repulsion>(&mut self, particles: &Particles) {
        let energy = self.sum / particles.len() as f64;
        if self.has_previous {
            let before = self.energy.last().copied().unwrap_or(f64::INFINITY);
            if energy >= before {
                self.step_size *= 0.5;
                self.failures += 1;
                return self.enter(Stage::Restore);
            }
            self.step_size = (self.step_size * GROWTH).min(L::STEP);
            self.failures = 0;
            self.done += 1;
        }
        // After a step taken back this is the energy of the same positions again; it differs only where a normal has
        // turned past 90° from a neighbour's, on creases that the radius does not resolve.
        self.energy.truncate(self.done as usize);
        self.energy.push(energy);
        if self.done >= self.target || self.failures > MAX_FAILURES {
            self.has_previous = false;
            return self.enter(Stage::Polish);
        }
        self.previous.resize(particles.len(), Vec3::ZERO);
        if L::RESIZES {
            self.previous_radius.resize(particles.len(), 0.0);
        }
        self.has_previous = true;
        self.enter(Stage::Move);
    }

    /// Moves a batch of particles along their forces: into `points`, in the tangent planes.
    fn advance<L: Repulsion>(
        &mut self,
        law: &L,
        particles: &Particles,
        range: Range<usize>,
        points: &mut Points,
    ) {
        for (point, i) in points.position.iter_mut().zip(range) {
            let p = particles.position[i];
            let normal = particles.normal[i];
            let radius = law.radius(particles, i);
            let force = self.force[i] - normal * normal.dot(self.force[i]);
            self.previous[i] = p;
            if L::RESIZES {
                self.previous_radius[i] = radius;
            }
            *point = p + (force * self.step_size).clamp_length_max(MAX_MOVE * radius);
        }
    }

    /// Puts a batch of particles where `points` come to the surface, with their radii there.
    fn land<L: Repulsion>(
        &mut self,
        law: &L,
        surface: &mut Surface,
        particles: &mut Particles,
        range: Range<usize>,
        points: &mut Points,
        trust: f32,
    ) {
        points.count = range.len();
        if L::RESIZES {
            points.radius[..range.len()].copy_from_slice(&particles.radius[range.clone()]);
            for (k, i) in range.clone().enumerate() {
                points.since[k] = self.since[i] + (points.position[k] - particles.position[i]).length();
            }
        }
        law.land(surface.field, surface.projector, points, trust);
        for (k, i) in range.enumerate() {
            // A particle that cannot go stays: at the border of the box, where the field ends, at a fold.
            let (position, normal) = (points.position[k], points.normal[k]);
            if points.ok[k] && self.bounds.contains(position) && normal.dot(particles.normal[i]) > 0.0 {
                let distance = (position - particles.position[i]).length();
                let mut grown = 0.0;
                if L::RESIZES {
                    grown = points.radius[k] - particles.radius[i];
                    particles.radius[i] = points.radius[k];
                    self.since[i] = points.since[k];
                }
                self.went(law, particles, i, distance, grown);
                particles.position[i] = position;
                particles.normal[i] = normal;
            }
        }
    }

    /// Puts particle `i` back where the step under judgement found it.
    fn restore(&self, particles: &mut Particles, i: usize) {
        particles.position[i] = self.previous[i];
        if let Some(&radius) = self.previous_radius.get(i) {
            particles.radius[i] = radius;
        }
    }
}

/// Lowers the radius of particle `i` to what its listed neighbours allow it at this slope, and theirs to what it allows
/// them. Says whether any was lowered.
fn grade(slope: f32, pairs: &Pairs, particles: &mut Particles, i: usize) -> bool {
    let mut lowered = false;
    for &j in pairs.of(i) {
        let j = j as usize;
        let rise = slope * (particles.position[i] - particles.position[j]).length();
        let (a, b) = (particles.radius[i], particles.radius[j]);
        if a > b + rise {
            particles.radius[i] = b + rise;
            lowered = true;
        } else if b > a + rise {
            particles.radius[j] = a + rise;
            lowered = true;
        }
    }
    lowered
}
