//! Relaxation: every particle moves against the repulsion of its neighbours in the tangent plane and is brought back onto
//! the surface, a given number of times (paper §4.5 and the end of §5).
//!
//! What repels is a law of pairs ([`Repulsion`]): a Gaussian for particles of one size, the overlap for particles of many.
//! Steps, neighbour lists and the way back onto the surface are the same.
//!
//! # Differs from the paper
//!
//! * The step is not fixed but as large as stays stable: a step that does not lower the energy is taken back and halved,
//!   so the energy falls at every step. That holds because the energy is one function of places and normals: no pair within
//!   range is missing from the lists, and each takes part as its normals say now ([`same_sheet_weight`]). Where nearly every particle
//!   has a neighbour across a bend that the radius does not resolve, no step along these forces may lower it further; the
//!   relaxation then ends before its last step.

pub(crate) mod repulsion;

use crate::field::Field;
use crate::math::Bounds;
use crate::particles::Particles;
use crate::sampler::neighbours::constants::MAX_TURN;
use crate::sampler::neighbours::lists::{NeighbourLists, is_stale};
use crate::sampler::neighbours::packed::{PackedNeighbours, ROOM};
use crate::sampler::projection::{BATCH, Projector, Tolerance};
use crate::sampler::relaxation::repulsion::{
    Gaussian, MAX_MOVE, Overlap, Points, Repulsion, TRUSTED_CORRECTION, same_sheet_weight,
};
use crate::sampler::sizing::Sizing;
use core::ops::Range;
use glam::{Mat4, Vec3, Vec4};

/// Step sizes halve after a failure and grow back by this factor after a success.
const GROWTH: f32 = 1.05;
/// Failures in a row after which the configuration counts as being at its minimum.
const MAX_FAILURES: u32 = 6;

/// So short is no correction: where the energy depends on the normals, they have to be those of the very places.
const CHECKED: f32 = f32::MIN_POSITIVE;

/// Units that a new list counts for: it takes ten times as long as a particle's forces.
const REFRESH_UNITS: u32 = 10;

/// What a relaxation does next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Put all particles into the grid.
    Grid,
    /// Make the lists of those who have gone far anew.
    Refresh,
    Forces,
    Move,
    Restore,
    Polish,
    /// Lower the radii that a neighbour's does not allow: before a step and after the last.
    Grade,
    Done,
}

/// What repels, and what it takes to be on the surface.
#[derive(Clone, Copy, Debug)]
pub(crate) enum RepulsionLaw {
    /// Particles of this radius.
    Gaussian { radius: f32, tolerance: Tolerance },
    /// Particles of many radii, on a surface that single precision resolves to `resolution`.
    Overlap { resolution: f32, min_gradient: f32 },
}

/// The surface that the particles stay on.
pub(crate) struct SurfaceContext<'a> {
    pub(crate) field: &'a mut dyn Field,
    pub(crate) projector: &'a mut Projector,
    /// The radius field of an adaptive run.
    pub(crate) sizing: Option<&'a Sizing>,
}

/// Particles whose pairs are worked out together, and the most pairs they have.
const BUNDLE: usize = 32;
const MOST_PAIRS: usize = BUNDLE * ROOM;

/// The pairs of some particles, one after the other, to be worked out in lanes: with no branch that depends on a distance,
/// which would be mispredicted for every other pair.
#[derive(Clone, Debug)]
struct Bundle {
    offset: [Vec4; MOST_PAIRS],
    /// Mean radius, where radii differ.
    mean: [f32; MOST_PAIRS],
    weight: [f32; MOST_PAIRS],
    energy: [f32; MOST_PAIRS],
    /// Smaller index.
    other: [u32; MOST_PAIRS],
}

impl Bundle {
    fn new() -> Self {
        Self {
            offset: [Vec4::ZERO; MOST_PAIRS],
            mean: [1.0; MOST_PAIRS],
            weight: [0.0; MOST_PAIRS],
            energy: [0.0; MOST_PAIRS],
            other: [0; MOST_PAIRS],
        }
    }
}

/// A relaxation under way.
#[derive(Clone)]
pub(crate) struct Relaxation {
    law: RepulsionLaw,
    bounds: Bounds,
    target: u32,
    done: u32,
    stage: Stage,
    next: usize,
    lists: NeighbourLists,
    /// The farthest that a particle has gone in this move.
    farthest: f32,
    /// Units done beyond the budgets so far, to be paid from the next ones.
    debt: u32,
    /// Whether a list is to be made anew.
    is_stale: bool,
    /// Force on each particle, the sum of `offset * weight` over its pairs, zero when the summation begins; and in `w` the
    /// length of its way since its list was made. That is infinite if the list is to be made anew, and minus infinity from
    /// when it was until the particle moves.
    force: Vec<Vec4>,
    bundle: Box<Bundle>,
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
    pub(crate) energy: Vec<f64>,
}

impl Relaxation {
    pub(crate) fn new() -> Self {
        Self {
            law: RepulsionLaw::Gaussian { radius: 1.0, tolerance: Tolerance::default() },
            bounds: Bounds::cube(1.0),
            target: 0,
            done: 0,
            stage: Stage::Done,
            next: 0,
            lists: NeighbourLists::new(),
            farthest: 0.0,
            debt: 0,
            is_stale: false,
            force: Vec::new(),
            bundle: Box::new(Bundle::new()),
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
    pub(crate) fn clear(&mut self) {
        self.done = 0;
        self.stage = Stage::Done;
        self.energy.clear();
    }

    /// Goes on until `target` steps are done in all. `pairs` are the lists of the front, if it was not cut short.
    pub(crate) fn begin(
        &mut self,
        law: RepulsionLaw,
        bounds: &Bounds,
        target: u32,
        particles: usize,
        pairs: &mut PackedNeighbours,
    ) {
        self.law = law;
        self.bounds = *bounds;
        self.target = target;
        self.has_previous = false;
        self.failures = 0;
        if self.done == 0 {
            self.step_size = match law {
                RepulsionLaw::Gaussian { .. } => Gaussian::STEP,
                RepulsionLaw::Overlap { .. } => Overlap::STEP,
            };
        }
        // A first step that was cancelled has moved particles, and the lists of the front no longer hold.
        let is_first = self.energy.is_empty();
        // After a stop the particles may stand where nothing has judged them, and after a run they have been polished.
        self.energy.truncate(self.done as usize);
        fill(&mut self.force, particles, Vec4::ZERO);
        fill(&mut self.previous, particles, Vec3::ZERO);
        self.farthest = 0.0;
        self.lists.travelled = f32::INFINITY;
        self.sum = 0.0;
        self.debt = 0;
        self.is_stale = false;
        self.steep = false;
        let resized = if matches!(law, RepulsionLaw::Overlap { .. }) { particles } else { 0 };
        fill(&mut self.since, resized, 0.0);
        fill(&mut self.previous_radius, resized, 0.0);
        self.ending = target == 0 && matches!(law, RepulsionLaw::Overlap { .. });
        if pairs.len() == particles && is_first && !self.ending {
            self.after_lists();
        } else {
            pairs.extend_to(particles);
            self.make_lists();
        }
    }

    pub(crate) fn is_done(&self) -> bool {
        self.stage == Stage::Done
    }

    pub(crate) fn steps_done(&self) -> u32 {
        self.done
    }

    /// Takes back a step that is only half made. Returns whether positions changed.
    pub(crate) fn abandon(&mut self, particles: &mut Particles) -> bool {
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

    /// Does up to `budget` units (one particle in one stage, a dear one for several); returns whether particles moved. `sizing` is
    /// the radius field of an adaptive run.
    pub(crate) fn step(
        &mut self,
        surface: &mut SurfaceContext,
        pairs: &mut PackedNeighbours,
        particles: &mut Particles,
        budget: u32,
    ) -> bool {
        match (self.law, surface.sizing) {
            (RepulsionLaw::Gaussian { radius, tolerance }, _) => {
                self.run(&Gaussian::new(radius, tolerance), surface, pairs, particles, budget)
            }
            (RepulsionLaw::Overlap { resolution, min_gradient }, Some(sizing)) => {
                let law = Overlap { sizing, resolution, min_gradient };
                self.run(&law, surface, pairs, particles, budget)
            }
            (RepulsionLaw::Overlap { .. }, None) => panic!("an adaptive run has a radius field"),
        }
    }

    fn run<L: Repulsion>(
        &mut self,
        law: &L,
        surface: &mut SurfaceContext,
        pairs: &mut PackedNeighbours,
        particles: &mut Particles,
        mut budget: u32,
    ) -> bool {
        let n = particles.len();
        let mut moved = false;
        let paid = self.debt.min(budget);
        self.debt -= paid;
        budget -= paid;
        while budget > 0 && self.stage != Stage::Done {
            let (last, units) = self.affordable::<L>(budget, n);
            let range = self.next..last;
            self.debt = units.saturating_sub(budget);
            budget = budget.saturating_sub(units);
            self.next = last;
            match self.stage {
                Stage::Grid => {
                    if range.start == 0 {
                        self.lists.reset(law.extent(particles), (L::RANGE + L::SKIN, L::SLACK), n);
                    }
                    for i in range {
                        self.lists.insert(particles, i);
                    }
                    if last == n {
                        self.enter(Stage::Refresh);
                    }
                }
                Stage::Refresh => {
                    if range.start == 0 {
                        pairs.drop_far(|i| is_stale(self.force[i]));
                    }
                    for i in range {
                        if is_stale(self.force[i]) {
                            let made = self.lists.make(pairs, particles, &mut self.force, i);
                            let beyond = made.iter().filter(|&&j| j as usize >= last).count() as u32;
                            self.debt += beyond * REFRESH_UNITS;
                        }
                    }
                    if last == n {
                        self.is_stale = false;
                        self.after_lists();
                    }
                }
                Stage::Forces => {
                    for first in (range.start..last).step_by(BUNDLE) {
                        self.repel(law, pairs, particles, first..last.min(first + BUNDLE));
                    }
                    if last == n {
                        self.repel_far(law, pairs, particles);
                        self.judge::<L>(n);
                    }
                }
                Stage::Move => {
                    let mut points = Points::new();
                    for range in parts(range.clone()) {
                        self.advance(law, particles, range.clone(), &mut points);
                        let trust = if pairs.any_weighted(&range) { CHECKED } else { TRUSTED_CORRECTION };
                        self.land(law, surface, particles, range, &mut points, trust);
                    }
                    moved |= !range.is_empty();
                    if last == n {
                        self.after_moving(law, particles);
                    }
                }
                Stage::Restore => {
                    let mut points = Points::new();
                    for range in parts(range.clone()) {
                        for (point, i) in points.position.iter_mut().zip(range.clone()) {
                            let back = (particles.position[i] - self.previous[i]).length();
                            let shrunk = particles.radius[i];
                            self.restore(particles, i);
                            self.take_force(i);
                            if L::RESIZES {
                                self.since[i] = (self.since[i] - back).max(0.0);
                            }
                            self.add_travel(law, particles, i, back, particles.radius[i] - shrunk);
                            *point = particles.position[i];
                        }
                        // The normal is that of the place left.
                        let trust = if pairs.any_weighted(&range) { CHECKED } else { TRUSTED_CORRECTION };
                        self.land(law, surface, particles, range, &mut points, trust);
                    }
                    moved = true;
                    if last == n {
                        self.has_previous = false;
                        self.after_moving(law, particles);
                    }
                }
                Stage::Polish => {
                    let mut points = Points::new();
                    for range in parts(range.clone()) {
                        points.position[..range.len()].copy_from_slice(&particles.position[range.clone()]);
                        self.land(law, surface, particles, range, &mut points, 0.0);
                    }
                    moved |= !range.is_empty();
                    if last == n {
                        if L::RESIZES {
                            // The grading is a promise about all pairs: none may be missing that the front or a change of
                            // radii has left out.
                            self.ending = true;
                            self.make_lists();
                        } else {
                            self.enter(Stage::Done);
                        }
                    }
                }
                Stage::Grade => {
                    for i in range {
                        for j in pairs.near(i) {
                            self.lowered |= grade(law.slope(), particles, i, j);
                        }
                    }
                    if last == n {
                        for &[i, j] in pairs.far() {
                            self.lowered |= grade(law.slope(), particles, i as usize, j as usize);
                        }
                        let lowered = core::mem::take(&mut self.lowered);
                        self.steep |= lowered;
                        if lowered {
                            self.enter(Stage::Grade);
                        } else if self.ending {
                            self.enter(Stage::Done);
                        } else {
                            self.enter(Stage::Forces);
                        }
                    }
                }
                Stage::Done => {}
            }
        }
        moved
    }

    /// Where the stage comes to with a budget, and the units that takes: the last particle may go beyond it.
    fn affordable<L: Repulsion>(&self, budget: u32, n: usize) -> (usize, u32) {
        let cost = |i: usize| match self.stage {
            Stage::Refresh if is_stale(self.force[i]) => REFRESH_UNITS,
            Stage::Polish => L::POLISH_UNITS,
            _ => 1,
        };
        let (mut last, mut units) = (self.next, 0);
        while last < n && units < budget {
            units += cost(last);
            last += 1;
        }
        (last, units)
    }

    /// Makes all lists anew.
    fn make_lists(&mut self) {
        self.is_stale = true;
        self.force.iter_mut().for_each(|force| force.w = f32::INFINITY);
        self.enter(Stage::Grid);
    }

    /// Whether the forces of the particles as they were given have been computed.
    fn has_begun(&self) -> bool {
        self.energy.len() > self.done as usize
    }

    /// Goes on from complete lists: to the forces or, where the radii may differ too much, by way of their grading.
    fn after_lists(&mut self) {
        let differ = match self.law {
            RepulsionLaw::Gaussian { .. } => false,
            RepulsionLaw::Overlap { .. } => self.steep || self.ending || !self.has_begun(),
        };
        if differ {
            self.enter(Stage::Grade);
        } else {
            self.enter(Stage::Forces);
        }
    }

    /// Goes on from new places, by way of new lists where the old ones may miss a pair.
    fn after_moving<L: Repulsion>(&mut self, law: &L, particles: &Particles) {
        self.lists.travelled += core::mem::take(&mut self.farthest);
        if !self.is_stale {
            self.after_lists();
        } else if self.lists.travelled < L::SLACK * law.radius(particles, 0) {
            self.enter(Stage::Refresh);
        } else {
            self.enter(Stage::Grid);
        }
    }

    /// Notes that particle `i` has gone some way and grown: two particles of which each has used up half of its skin may
    /// have come within range without being listed. A turn of the normal counts as some way.
    #[inline]
    fn add_travel<L: Repulsion>(
        &mut self,
        law: &L,
        particles: &Particles,
        i: usize,
        distance: f32,
        grown: f32,
    ) {
        self.farthest = larger(self.farthest, distance);
        let mut way = self.force[i].w + distance;
        if L::RESIZES {
            way += 0.5 * L::RANGE * grown.max(0.0);
        }
        if way > 0.5 * L::SKIN * law.radius(particles, i) {
            self.is_stale = true;
            way = f32::INFINITY;
        }
        self.force[i].w = way;
    }

    /// Adds the repulsion between each particle of a bundle and its listed neighbours to the forces on both, and to the
    /// energy.
    fn repel<L: Repulsion>(
        &mut self,
        law: &L,
        pairs: &PackedNeighbours,
        particles: &Particles,
        range: Range<usize>,
    ) {
        let Bundle { offset, mean, weight, energy, other } = &mut *self.bundle;
        // A list has at most the room it has: the remainders only tell the compiler that.
        let mut count = 0;
        let mut end = [0; BUNDLE];
        for (end, i) in end.iter_mut().zip(range.clone()) {
            let p = particles.position[i].extend(0.0);
            for j in pairs.near(i) {
                let k = count % MOST_PAIRS;
                offset[k] = p - particles.position[j].extend(0.0);
                other[k] = j as u32;
                if L::RESIZES {
                    mean[k] = 0.5 * (particles.radius[i] + particles.radius[j]);
                }
                count += 1;
            }
            *end = count;
        }
        for first in (0..MOST_PAIRS).step_by(4).take_while(|&first| first < count) {
            let [a, b, c, d] = [0, 1, 2, 3].map(|k| offset[first + k]);
            let lanes = Mat4::from_cols(a, b, c, d).transpose();
            let (x, y, z) = (lanes.x_axis, lanes.y_axis, lanes.z_axis);
            let mean = Vec4::from_slice(&mean[first..first + 4]);
            let (of_weight, of_energy) = law.pairs(x * x + y * y + z * z, mean);
            of_weight.write_to_slice(&mut weight[first..first + 4]);
            of_energy.write_to_slice(&mut energy[first..first + 4]);
        }
        if pairs.any_weighted(&range) {
            let mut first = 0;
            for (&end, i) in end.iter().zip(range.clone()) {
                for k in first..end {
                    let other = particles.normal[other[k] as usize];
                    let share = same_sheet_weight(particles.normal[i].dot(other));
                    weight[k] *= share;
                    energy[k] *= share;
                }
                first = end;
            }
        }
        let mut count = 0;
        for (&end, i) in end.iter().zip(range) {
            let mut force = Vec4::ZERO;
            let mut sum = 0.0;
            for k in count..end {
                let k = k % MOST_PAIRS;
                let push = offset[k] * weight[k];
                force += push;
                self.force[other[k] as usize] -= push;
                sum += energy[k];
            }
            self.force[i] += force;
            self.sum += f64::from(sum);
            count = end;
        }
    }

    /// The same for the far pairs.
    fn repel_far<L: Repulsion>(&mut self, law: &L, pairs: &PackedNeighbours, particles: &Particles) {
        for &[i, j] in pairs.far() {
            let (i, j) = (i as usize, j as usize);
            let offset = particles.position[i] - particles.position[j];
            let mean = 0.5 * (law.radius(particles, i) + law.radius(particles, j));
            let (weight, energy) = law.pairs(Vec4::splat(offset.length_squared()), Vec4::splat(mean));
            let share = same_sheet_weight(particles.normal[i].dot(particles.normal[j]));
            let push = offset.extend(0.0) * (weight.x * share);
            self.force[i] += push;
            self.force[j] -= push;
            self.sum += f64::from(energy.x * share);
        }
    }

    /// Accepts the last step or has it taken back. After that the energy stands as it was: the places are those it was of.
    fn judge<L: Repulsion>(&mut self, particles: usize) {
        let energy = core::mem::take(&mut self.sum) / particles as f64;
        if !self.has_begun() {
            self.energy.push(energy);
        } else if self.has_previous {
            if self.energy.last().is_some_and(|&before| energy >= before) {
                self.step_size *= 0.5;
                self.failures += 1;
                return self.enter(Stage::Restore);
            }
            self.step_size = (self.step_size * GROWTH).min(L::STEP);
            self.failures = 0;
            self.done += 1;
            self.energy.push(energy);
        }
        if self.done >= self.target || self.failures > MAX_FAILURES {
            self.has_previous = false;
            return self.enter(Stage::Polish);
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
            let force = self.take_force(i);
            let force = force - normal * normal.dot(force);
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
        surface: &mut SurfaceContext,
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
            let cosine = normal.dot(particles.normal[i]);
            if points.ok[k] && self.bounds.contains(position) && cosine > 0.0 {
                // The turn that has a list made anew counts as the way that does.
                let turn_sq = 2.0 - 2.0 * cosine;
                let per_turn = 0.5 * L::SKIN / MAX_TURN * law.radius(particles, i);
                let distance_sq = (position - particles.position[i]).length_squared();
                let distance = larger(distance_sq, turn_sq * (per_turn * per_turn)).sqrt();
                let mut grown = 0.0;
                if L::RESIZES {
                    grown = points.radius[k] - particles.radius[i];
                    particles.radius[i] = points.radius[k];
                    self.since[i] = points.since[k];
                }
                self.add_travel(law, particles, i, distance, grown);
                particles.position[i] = position;
                particles.normal[i] = normal;
            }
        }
    }

    /// The force on particle `i`, which is about to move; it is zero then.
    fn take_force(&mut self, i: usize) -> Vec3 {
        let force = self.force[i];
        self.force[i] = Vec4::new(0.0, 0.0, 0.0, larger(force.w, 0.0));
        force.truncate()
    }

    /// Puts particle `i` back where the step under judgement found it.
    fn restore(&self, particles: &mut Particles, i: usize) {
        particles.position[i] = self.previous[i];
        if let Some(&radius) = self.previous_radius.get(i) {
            particles.radius[i] = radius;
        }
    }
}

/// The larger of two numbers, of which neither is a NaN: a maximum that knows NaN takes five instructions.
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The batches that a range of particles belongs to, as far as it does.
fn parts(range: Range<usize>) -> impl Iterator<Item = Range<usize>> {
    (range.start / BATCH..range.end.div_ceil(BATCH))
        .map(move |batch| range.start.max(batch * BATCH)..range.end.min((batch + 1) * BATCH))
}

/// Makes a column of `len` times `value`, in no more memory than it takes.
fn fill<T: Clone>(column: &mut Vec<T>, len: usize, value: T) {
    column.clear();
    column.reserve_exact(len);
    column.resize(len, value);
}

/// Lowers the larger of two radii to what the smaller allows it at this slope, on one sheet. Says whether it was lowered.
fn grade(slope: f32, particles: &mut Particles, i: usize, j: usize) -> bool {
    let rise = slope * (particles.position[i] - particles.position[j]).length();
    let (a, b) = (particles.radius[i], particles.radius[j]);
    let is_steep = (a > b + rise || b > a + rise) && particles.normal[i].dot(particles.normal[j]) > 0.0;
    if is_steep && a > b {
        particles.radius[i] = b + rise;
    } else if is_steep {
        particles.radius[j] = a + rise;
    }
    is_steep
}
