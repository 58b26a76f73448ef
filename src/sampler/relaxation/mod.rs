//! Relaxation: every particle moves against the repulsion of its neighbours in the tangent plane and is brought back
//! onto the surface, a given number of times (paper §4.5 and the end of §5).
//!
//! The repulsion is a law for pairs of particles ([`Repulsion`]): a Gaussian for particles of one size, the overlap of
//! discs for particles of many. Steps, neighbour lists and the return to the surface are the same for both.
//!
//! ```text
//!            ┌────────────── next pass ─┐
//! FillGrid → RenewLists → Grade ────────┴─→ SumForces → Move ────┐   (after the last step) → Polish → Done
//!    ↑            ↑         ↑                ↑      └→ TakeBack ─┤
//!    └────────────┴─────────┴────────────────┴──────────────────┘
//! ```
//!
//! Lists are renewed only where they are stale, and only adaptive particles are graded. After the polish adaptive
//! particles go through the grid, the lists and the grading once more.
//!
//! # Differs from the paper
//!
//! * The step size is not fixed but as large as stays stable. A step that does not lower the energy is taken back and
//!   the step size is halved, so the energy falls at every step that stands. This holds because the energy is one
//!   function of positions and normals: no pair within range is missing from the lists, and each counts with the weight
//!   of its present normals ([`sheet::repulsion_weight`]). Where nearly every particle has a neighbour across a
//!   bend that the radius does not resolve, no step along these forces may lower the energy further; the relaxation
//!   then ends before its last step.

mod forces;
mod grading;
pub(crate) mod repulsion;
mod stepper;

use crate::math::Bounds;
use crate::particles::Particles;
use crate::sampler::neighbours::lists::NeighbourLists;
use crate::sampler::neighbours::packed::PackedNeighbours;
use crate::sampler::probe::Probe;
use crate::sampler::projection::{ResidualLimits, TRUSTED_CORRECTION, Tolerance};
use crate::sampler::relaxation::forces::BATCH_PARTICLES;
use crate::sampler::relaxation::repulsion::{Gaussian, LandingBatch, Overlap, Repulsion};
use crate::sampler::relaxation::stepper::{Stepper, batch};
use crate::sampler::sheet;
use crate::sampler::sizing::Sizing;
use core::ops::Range;

/// Units of work that the renewal of a list counts for: it takes ten times as long as the forces on a particle.
const RENEWAL_UNITS: u32 = 10;

/// Stage of a relaxation: the work that is done for each particle in turn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum RelaxationStage {
    /// Bring the particles to a surface that has moved.
    Transport,
    /// Put all particles into the grid.
    FillGrid,
    /// Renew the stale neighbour lists.
    RenewLists,
    /// Lower radii that are too large beside a neighbour's. This takes as many passes as lower one.
    Grade { has_lowered: bool },
    /// Sum the forces, and the energy of all particles.
    SumForces { energy: f64 },
    /// Move the particles along the forces.
    Move,
    /// Put the particles back where they were before the last move.
    TakeBack,
    /// Bring the particles onto the surface as close as single precision allows.
    Polish,
    /// The relaxation has ended.
    #[default]
    Done,
}

/// Purpose for which the lists are renewed and the radii graded: the part of the relaxation that follows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Purpose {
    /// The next step: the particles have not moved, or were put back.
    Step,
    /// The judgement of the step just made, and then the next step.
    Judge,
    /// The one step of particles on a surface that moves: it stands, whatever it does to the energy.
    Follow,
    /// The end of the relaxation.
    #[default]
    End,
}

/// A law of repulsion, with the tolerance for particles on the surface.
#[derive(Clone, Copy, Debug)]
pub(crate) enum RepulsionLaw {
    /// Gaussian repulsion, for particles of this radius.
    Gaussian { radius: f32, tolerance: Tolerance },
    /// Overlap of discs, for particles of many radii.
    Overlap { residual_limits: ResidualLimits, min_gradient: f32 },
}

impl Default for RepulsionLaw {
    fn default() -> Self {
        Self::Gaussian { radius: 1.0, tolerance: Tolerance::default() }
    }
}

impl RepulsionLaw {
    fn resizes(self) -> bool {
        matches!(self, Self::Overlap { .. })
    }

    /// Size of the first step, and the largest.
    fn first_step(self) -> f32 {
        match self {
            Self::Gaussian { .. } => Gaussian::STEP,
            Self::Overlap { .. } => Overlap::STEP,
        }
    }
}

/// Limits on the moves of particles, which keep them in the box and on their sheets.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct MoveLimits {
    /// The box that is sampled.
    pub(crate) bounds: Bounds,
    /// Lift of a move above which a particle has left its sheet; infinite where no others are near.
    pub(crate) largest_lift: f32,
}

/// A relaxation under way.
#[derive(Clone, Default)]
pub(crate) struct Relaxation {
    law: RepulsionLaw,
    /// Steps to be done in all.
    target: u32,
    stage: RelaxationStage,
    purpose: Purpose,
    /// The next particle in this stage.
    next: usize,
    /// Units done beyond the budgets so far, to be paid from the next ones.
    debt: u32,
    /// Whether a grading has lowered a radius, so that radii are graded before every step.
    is_steep: bool,
    lists: NeighbourLists,
    stepper: Stepper,
    /// Particles that the transport has not brought to the surface, in ascending order.
    lost: Vec<u32>,
}

/// Largest distance, in radii, that a particle is transported: that of its neighbours. A surface that has moved farther is sampled anew.
pub(crate) const TRANSPORT_REACH: f32 = 2.0;

/// A Newton correction shorter than this, in radii, ends the transport: what it leaves is far below the step that follows, which lands
/// particles as closely as any. With a tenth, half and double of it the figures of 16 random motions are the same within 1 %.
const TRANSPORT_TRUST: f32 = 0.1;

impl Relaxation {
    /// Forgets an earlier run.
    pub(crate) fn clear(&mut self) {
        self.stage = RelaxationStage::Done;
        self.stepper.clear();
    }

    /// Goes on until `target` steps are done in all. `pairs` are the lists of the front, if it was not cut short. Where the
    /// largest lift is finite, particles of different sheets that face the same way do not repel each other.
    pub(crate) fn begin(
        &mut self,
        law: RepulsionLaw,
        limits: MoveLimits,
        target: u32,
        particles: &Particles,
        pairs: &mut PackedNeighbours,
    ) {
        let sheets = if limits.largest_lift < f32::INFINITY {
            sheet::numbers(limits.largest_lift, particles, pairs)
        } else {
            particles.patch.clone()
        };
        let particles = particles.len();
        self.law = law;
        self.target = target;
        self.purpose = if target == 0 && law.resizes() { Purpose::End } else { Purpose::Step };
        self.next = 0;
        self.debt = 0;
        self.is_steep = false;
        // A first step that was cancelled has moved particles, so the lists of the front no longer hold.
        let is_first = self.stepper.energy().is_empty();
        self.stepper.begin(limits, particles, law.first_step(), law.resizes());
        self.lists.reset(particles);
        self.lists.sheets = sheets;
        // The front's lists may hold pairs on two near sheets.
        let are_lists_right = pairs.len() == particles && is_first && self.lists.sheets.is_empty();
        self.stage = if are_lists_right && self.purpose != Purpose::End {
            self.after_lists()
        } else {
            pairs.extend_to(particles);
            self.lists.make_all_stale();
            RelaxationStage::FillGrid
        };
    }

    /// Brings the particles to the surface of a field that has changed. `are_listed` says whether the lists were those of these particles
    /// before.
    pub(crate) fn begin_transport(
        &mut self,
        law: RepulsionLaw,
        limits: MoveLimits,
        particles: &Particles,
        pairs: &mut PackedNeighbours,
        are_listed: bool,
    ) {
        self.law = law;
        self.purpose = Purpose::Follow;
        self.stepper.follow(limits, law.first_step());
        if !are_listed {
            self.list_anew(particles, pairs);
        }
        self.lost.clear();
        (self.next, self.debt) = (0, 0);
        self.stage = RelaxationStage::Transport;
    }

    /// Keeps the lists of those particles that have a new row, [`Particles::NO_PARENT`] for one that is gone. Those that came after the listed
    /// ones are listed in the next step.
    pub(crate) fn keep(&mut self, rows: &[u32], particles: &Particles, pairs: &mut PackedNeighbours) {
        pairs.extend_to(rows.len());
        pairs.keep(rows, Particles::NO_PARENT);
        self.lists.keep(rows, Particles::NO_PARENT);
        self.stepper.resize(particles.len(), self.law.resizes());
    }

    /// Makes a step on the surface to which the particles were transported.
    pub(crate) fn begin_following(&mut self) {
        (self.next, self.debt) = (0, 0);
        self.stage = if self.lists.has_stale() { RelaxationStage::FillGrid } else { self.after_lists() };
    }

    /// Makes all lists stale, for rows that may be others than before.
    fn list_anew(&mut self, particles: &Particles, pairs: &mut PackedNeighbours) {
        let n = particles.len();
        pairs.clear();
        pairs.extend_to(n);
        self.stepper.resize(n, self.law.resizes());
        self.lists.reset(n);
        self.lists.sheets = Vec::new();
        self.lists.make_all_stale();
    }

    /// The particles that the last transport has not brought to the surface, in ascending order.
    pub(crate) fn lost(&self) -> &[u32] {
        &self.lost
    }

    pub(crate) fn is_done(&self) -> bool {
        self.stage == RelaxationStage::Done
    }

    pub(crate) fn steps_done(&self) -> u32 {
        self.stepper.done()
    }

    /// Energy per particle before the first step and after each.
    pub(crate) fn energy(&self) -> &[f64] {
        self.stepper.energy()
    }

    /// Takes back a step that is only half made, and ends. Returns whether positions changed.
    pub(crate) fn abandon(&mut self, particles: &mut Particles) -> bool {
        let moved = match self.stage {
            RelaxationStage::Move => 0..self.next,
            RelaxationStage::TakeBack => self.next..particles.len(),
            _ => 0..0,
        };
        for i in moved.clone() {
            self.stepper.restore(particles, i);
        }
        self.stage = RelaxationStage::Done;
        !moved.is_empty()
    }

    /// Does up to `budget` units of work and returns whether particles moved. A unit is one particle in one stage;
    /// costly ones count for several. It returns early where a step stands, so that its particles can be looked at.
    /// Particles of many radii need the radius field `sizing` of their run.
    ///
    /// # Panics
    ///
    /// If particles of many radii come without a radius field.
    pub(crate) fn step(
        &mut self,
        probe: &mut Probe,
        sizing: Option<&Sizing>,
        pairs: &mut PackedNeighbours,
        particles: &mut Particles,
        budget: u32,
    ) -> bool {
        match (self.law, sizing) {
            (RepulsionLaw::Gaussian { radius, tolerance }, _) => {
                self.run(&Gaussian::new(radius, tolerance), probe, pairs, particles, budget)
            }
            (RepulsionLaw::Overlap { residual_limits, min_gradient }, Some(sizing)) => {
                let law = Overlap { sizing, residual_limits, min_gradient };
                self.run(&law, probe, pairs, particles, budget)
            }
            (RepulsionLaw::Overlap { .. }, None) => panic!("an adaptive run has a radius field"),
        }
    }

    fn run<L: Repulsion>(
        &mut self,
        law: &L,
        probe: &mut Probe,
        pairs: &mut PackedNeighbours,
        particles: &mut Particles,
        mut budget: u32,
    ) -> bool {
        let n = particles.len();
        let mut has_moved = false;
        let paid = self.debt.min(budget);
        self.debt -= paid;
        budget -= paid;
        let steps = self.stepper.done();
        while budget > 0 && self.stage != RelaxationStage::Done && self.stepper.done() == steps {
            let (last, units) = self.affordable(budget, n);
            let range = self.next..last;
            self.debt = units.saturating_sub(budget);
            budget = budget.saturating_sub(units);
            self.next = last;
            match &mut self.stage {
                RelaxationStage::FillGrid => self.fill_grid(law, particles, range),
                RelaxationStage::RenewLists => self.renew_lists(pairs, particles, range),
                RelaxationStage::Grade { has_lowered } => {
                    *has_lowered |= grading::grade_near(law.slope(), pairs, particles, range);
                }
                RelaxationStage::SumForces { energy } => {
                    for first in range.step_by(BATCH_PARTICLES) {
                        let few = first..last.min(first + BATCH_PARTICLES);
                        self.stepper.forces.add_near(law, pairs, particles, few, energy);
                    }
                }
                RelaxationStage::Transport
                | RelaxationStage::Move
                | RelaxationStage::TakeBack
                | RelaxationStage::Polish => {
                    has_moved |= !range.is_empty();
                    self.displace(law, probe, pairs, particles, range);
                }
                RelaxationStage::Done => {}
            }
            if last == n {
                self.next = 0;
                self.stage = self.following(law, pairs, particles);
            }
        }
        has_moved
    }

    /// Returns how far this stage comes with a budget, and the units that takes: the last particle may go beyond the
    /// budget.
    fn affordable(&self, budget: u32, n: usize) -> (usize, u32) {
        let cost = |i: usize| match self.stage {
            RelaxationStage::RenewLists if self.lists.is_stale(i) => RENEWAL_UNITS,
            _ => 1,
        };
        let (mut last, mut units) = (self.next, 0);
        while last < n && units < budget {
            units += cost(last);
            last += 1;
        }
        (last, units)
    }

    fn fill_grid<L: Repulsion>(&mut self, law: &L, particles: &Particles, range: Range<usize>) {
        if range.start == 0 {
            self.lists.empty_grid(law.extent(particles), L::RANGE + L::SKIN, L::SLACK, particles.len());
        }
        for i in range {
            self.lists.insert(particles, i);
        }
    }

    fn renew_lists(&mut self, pairs: &mut PackedNeighbours, particles: &Particles, range: Range<usize>) {
        if range.start == 0 {
            self.lists.begin_renewal(pairs);
        }
        let last = range.end;
        for i in range {
            if self.lists.is_stale(i) {
                let renewed = self.lists.renew(pairs, particles, i);
                let beyond = renewed.iter().filter(|&&j| j as usize >= last).count() as u32;
                self.debt += beyond * RENEWAL_UNITS;
            }
        }
    }

    /// Moves the particles of `range` as this stage says, and lands them.
    fn displace<L: Repulsion>(
        &mut self,
        law: &L,
        probe: &mut Probe,
        pairs: &PackedNeighbours,
        particles: &mut Particles,
        range: Range<usize>,
    ) {
        let Self { stage, lists, stepper, lost, .. } = self;
        let is_transport = *stage == RelaxationStage::Transport;
        let mut landing = LandingBatch::new();
        let mut next = range.start;
        while next < range.end {
            let range = batch(next..range.end, &particles.patch);
            next = range.end;
            let probe = &mut probe.on(particles.patch_of(range.start));
            let is_checked = pairs.any_weighted(&range) || stepper.may_stray();
            // Near a bend the energy depends on the normal, which is therefore evaluated at the final position; and near another
            // sheet a short correction may lead far away.
            landing.trust = if is_checked { 0.0 } else { TRUSTED_CORRECTION };
            match *stage {
                RelaxationStage::Move => stepper.advance(law, particles, range.clone(), &mut landing),
                RelaxationStage::TakeBack => {
                    stepper.take_back(law, lists, particles, range.clone(), &mut landing);
                }
                _ => {
                    landing.trust = 0.0;
                    if is_transport {
                        (landing.trust, landing.reach) = (TRANSPORT_TRUST, TRANSPORT_REACH);
                    }
                    landing.renews_radii = true;
                    landing.position[..range.len()].copy_from_slice(&particles.local[range.clone()]);
                }
            }
            stepper.land(law, probe, lists, particles, range.clone(), &mut landing);
            if is_transport {
                lost.extend(range.clone().filter(|i| !landing.ok[i - range.start]).map(|i| i as u32));
            }
        }
    }

    /// Returns the stage that follows, once all particles have been through the present one.
    fn following<L: Repulsion>(
        &mut self,
        law: &L,
        pairs: &PackedNeighbours,
        particles: &mut Particles,
    ) -> RelaxationStage {
        match self.stage {
            RelaxationStage::FillGrid => RelaxationStage::RenewLists,
            RelaxationStage::RenewLists => {
                self.lists.end_renewal();
                self.after_lists()
            }
            RelaxationStage::Grade { mut has_lowered } => {
                has_lowered |= grading::grade_far(law.slope(), pairs, particles);
                self.is_steep |= has_lowered;
                match self.purpose {
                    _ if has_lowered => RelaxationStage::Grade { has_lowered: false },
                    Purpose::End => RelaxationStage::Done,
                    _ => RelaxationStage::SumForces { energy: 0.0 },
                }
            }
            RelaxationStage::SumForces { mut energy } => {
                self.stepper.forces.add_far(law, pairs, particles, &mut energy);
                if self.purpose == Purpose::Follow {
                    return RelaxationStage::Move;
                }
                self.after_forces::<L>(energy / particles.len() as f64)
            }
            RelaxationStage::Move if self.purpose != Purpose::Follow => self.after_moving(law, particles),
            RelaxationStage::Transport | RelaxationStage::Move => {
                self.lists.end_move(L::SLACK * law.radius(particles, 0));
                RelaxationStage::Done
            }
            RelaxationStage::TakeBack => {
                self.purpose = Purpose::Step;
                self.after_moving(law, particles)
            }
            RelaxationStage::Polish if L::RESIZES => {
                // The grading is a promise about all pairs: none may be missing that the front or a change of radii has
                // left out.
                self.purpose = Purpose::End;
                self.lists.make_all_stale();
                RelaxationStage::FillGrid
            }
            RelaxationStage::Polish | RelaxationStage::Done => RelaxationStage::Done,
        }
    }

    /// Returns what follows complete lists: the forces, or the grading if radii may be too different.
    fn after_lists(&self) -> RelaxationStage {
        let is_uneven = match self.purpose {
            Purpose::End | Purpose::Follow => true,
            Purpose::Step | Purpose::Judge => self.is_steep || !self.stepper.has_begun(),
        };
        if self.law.resizes() && is_uneven {
            RelaxationStage::Grade { has_lowered: false }
        } else {
            RelaxationStage::SumForces { energy: 0.0 }
        }
    }

    /// Returns what follows a move: first the renewal of the stale lists, if there are any.
    fn after_moving<L: Repulsion>(&mut self, law: &L, particles: &Particles) -> RelaxationStage {
        let grid_serves = self.lists.end_move(L::SLACK * law.radius(particles, 0));
        if !self.lists.has_stale() {
            self.after_lists()
        } else if grid_serves {
            RelaxationStage::RenewLists
        } else {
            RelaxationStage::FillGrid
        }
    }

    /// Returns what follows the forces: the next step, the end, or the return from a step that has not lowered the
    /// energy.
    fn after_forces<L: Repulsion>(&mut self, energy: f64) -> RelaxationStage {
        if self.purpose != Purpose::Judge {
            self.stepper.record_first(energy);
        } else if !self.stepper.judge(energy, L::STEP) {
            return RelaxationStage::TakeBack;
        }
        if self.stepper.done() >= self.target || self.stepper.is_stuck() {
            return RelaxationStage::Polish;
        }
        self.purpose = Purpose::Judge;
        RelaxationStage::Move
    }
}
