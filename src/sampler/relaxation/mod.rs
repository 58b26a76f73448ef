//! Relaxation: every particle moves against the repulsion of its neighbours in the tangent plane
//! and is brought back onto the surface, a given number of times (paper §4.5 and the end of §5).
//!
//! The repulsion is a law for pairs of particles ([`Repulsion`]): a Gaussian for particles of one
//! size, the overlap of discs for particles of many. Steps, neighbour lists and the return to the
//! surface are the same for both.
//!
//! A relaxation is a sequence of [sweeps](Sweep) over all particles; `methods::relax` has the
//! order.
//!
//! # Differs from the paper
//!
//! * The step size is not fixed but as large as stays stable. A step that does not lower the energy
//!   is taken back and the step size is halved, so the energy falls at every step that stands. This
//!   holds because the energy is one function of positions and normals: no pair within range is
//!   missing from the lists, and each counts with the weight of its present normals
//!   ([`sheet::repulsion_weight`]). Where nearly every particle has a neighbour across a bend that
//!   the radius does not resolve, no step along these forces may lower the energy further; the
//!   relaxation then ends before its last step.

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

/// Units of work that the renewal of a list counts for: it takes ten times as long as the forces on
/// a particle.
const RENEWAL_UNITS: u32 = 10;

/// A sweep of the relaxation does one thing for each particle in turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sweep {
    /// Bring the particles to a surface that has moved.
    Transport,
    /// Put all particles into the grid.
    FillGrid,
    /// Renew the stale neighbour lists.
    RenewLists,
    /// Lower radii that are too large beside a neighbour's.
    Grade,
    /// Sum the forces, and the energy of all particles.
    SumForces,
    /// Move the particles along the forces.
    Move,
    /// Put the particles back where they were before the last move.
    TakeBack,
    /// Bring the particles onto the surface as close as single precision allows.
    Polish,
}

/// When radii are graded, where they differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Grading {
    /// At the first step, and once a radius had to be lowered at every step.
    WhereUneven,
    /// In any case.
    Always,
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
    /// The sweep under way, and the next particle in it.
    sweep: Option<Sweep>,
    next: usize,
    /// Energy per particle, as the last forces gave it.
    sum: f64,
    /// Whether the last grading has lowered a radius.
    has_lowered: bool,
    /// Whether the grid holds the particles where they are.
    grid_serves: bool,
    /// Whether a grading has lowered a radius, so that radii are graded before every step.
    is_steep: bool,
    lists: NeighbourLists,
    stepper: Stepper,
    /// Particles that the transport has not brought to the surface, in ascending order.
    lost: Vec<u32>,
}

/// What a slice of a sweep has done.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Swept {
    pub(crate) has_moved: bool,
    /// Whether it has come through all particles.
    pub(crate) is_done: bool,
}

/// Largest distance, in radii, that a particle is transported: that of its neighbours. A surface
/// that has moved farther is sampled anew.
pub(crate) const TRANSPORT_REACH: f32 = 2.0;

/// A Newton correction shorter than this, in radii, ends the transport: what it leaves is far below
/// the step that follows, which lands particles as closely as any.
const TRANSPORT_TRUST: f32 = 0.1;

impl Relaxation {
    /// Goes on until `target` steps are done in all. `pairs` are the lists of the front, if it was
    /// not cut short. Where the largest lift is finite, particles of different sheets that face the
    /// same way do not repel each other.
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
        (self.sweep, self.grid_serves) = (None, false);
        self.is_steep = false;
        // A first step that was cancelled has moved particles, so the lists of the front no longer
        // hold.
        let is_first = self.stepper.energy().is_empty();
        self.stepper.begin(limits, particles, law.first_step(), law.resizes());
        self.lists.reset(particles);
        self.lists.sheets = sheets;
        // The front's lists may hold pairs on two near sheets.
        let are_lists_right = pairs.len() == particles && is_first && self.lists.sheets.is_empty();
        if !are_lists_right || self.is_only_graded() {
            pairs.extend_to(particles);
            self.lists.make_all_stale();
        }
    }

    /// Brings the particles to the surface of a field that has changed. `are_listed` says whether
    /// the lists were those of these particles before.
    pub(crate) fn begin_transport(
        &mut self,
        law: RepulsionLaw,
        limits: MoveLimits,
        particles: &Particles,
        pairs: &mut PackedNeighbours,
        are_listed: bool,
    ) {
        self.law = law;
        (self.sweep, self.grid_serves) = (None, false);
        self.stepper.begin_transport(limits, law.first_step());
        if !are_listed {
            self.list_anew(particles, pairs);
        }
        self.lost.clear();
    }

    /// Keeps the lists of those particles that have a new row, [`Particles::NO_PARENT`] for one
    /// that is gone. Those that came after the listed ones are listed in the next step.
    pub(crate) fn keep(&mut self, rows: &[u32], particles: &Particles, pairs: &mut PackedNeighbours) {
        pairs.extend_to(rows.len());
        pairs.keep(rows, Particles::NO_PARENT);
        self.lists.keep(rows, Particles::NO_PARENT);
        self.stepper.resize(particles.len(), self.law.resizes());
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

    /// Whether there is no step to be made, and the radii are only graded.
    pub(crate) fn is_only_graded(&self) -> bool {
        self.target == 0 && self.law.resizes()
    }

    /// Whether all steps are done, or none lowers the energy any more.
    pub(crate) fn is_even(&self) -> bool {
        self.stepper.done() >= self.target || self.stepper.is_stuck()
    }

    /// Whether lists have to be renewed, and the grid filled before.
    pub(crate) fn wants_lists(&self) -> (bool, bool) {
        let has_stale = self.lists.has_stale();
        (has_stale, has_stale && !self.grid_serves)
    }

    /// Whether radii are to be graded.
    pub(crate) fn wants_grading(&self, grading: Grading) -> bool {
        self.law.resizes() && (grading == Grading::Always || self.is_steep || !self.stepper.has_begun())
    }

    /// Whether the last grading has lowered a radius.
    pub(crate) fn has_lowered(&self) -> bool {
        self.has_lowered
    }

    /// Takes the energy of the last forces as that before the first step, unless that is known.
    pub(crate) fn record_first(&mut self) {
        self.stepper.record_first(self.sum);
    }

    /// Whether the last step stands: whether it has lowered the energy.
    pub(crate) fn judge(&mut self) -> bool {
        self.stepper.judge(self.sum, self.law.first_step())
    }

    /// Has the grid filled before lists are renewed: particles may have been born or have died.
    pub(crate) fn distrust_grid(&mut self) {
        self.grid_serves = false;
    }

    /// Has all lists made anew. The grading is a promise about all pairs: none may be missing that
    /// the front or a change of radii has left out.
    pub(crate) fn distrust_lists(&mut self) -> bool {
        if self.law.resizes() {
            self.lists.make_all_stale();
            self.distrust_grid();
        }
        self.law.resizes()
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
        let moved = match self.sweep {
            Some(Sweep::Move) => 0..self.next,
            Some(Sweep::TakeBack) => self.next..particles.len(),
            _ => 0..0,
        };
        for i in moved.clone() {
            self.stepper.restore(particles, i);
        }
        self.sweep = None;
        !moved.is_empty()
    }

    /// Goes on with a sweep over all particles, as far as `left` of a budget allows: one unit a
    /// particle, more for a costly one. Returns whether particles moved, once it has come to the
    /// end. Particles of many radii need the radius field `sizing` of their run.
    ///
    /// # Panics
    ///
    /// If particles of many radii come without a radius field.
    pub(crate) fn go_on(
        &mut self,
        sweep: Sweep,
        probe: &mut Probe,
        sizing: Option<&Sizing>,
        pairs: &mut PackedNeighbours,
        particles: &mut Particles,
        left: &mut u32,
    ) -> Swept {
        match (self.law, sizing) {
            (RepulsionLaw::Gaussian { radius, tolerance }, _) => {
                self.run(sweep, &Gaussian::new(radius, tolerance), probe, pairs, particles, left)
            }
            (RepulsionLaw::Overlap { residual_limits, min_gradient }, Some(sizing)) => {
                let law = Overlap { sizing, residual_limits, min_gradient };
                self.run(sweep, &law, probe, pairs, particles, left)
            }
            (RepulsionLaw::Overlap { .. }, None) => panic!("an adaptive run has a radius field"),
        }
    }

    fn run<L: Repulsion>(
        &mut self,
        sweep: Sweep,
        law: &L,
        probe: &mut Probe,
        pairs: &mut PackedNeighbours,
        particles: &mut Particles,
        left: &mut u32,
    ) -> Swept {
        let n = particles.len();
        if self.sweep.replace(sweep) != Some(sweep) {
            self.next = 0;
            (self.sum, self.has_lowered) = (0.0, false);
        }
        let mut has_moved = false;
        let range = self.affordable(sweep, left, n);
        self.next = range.end;
        match sweep {
            Sweep::FillGrid => self.fill_grid(law, particles, range),
            Sweep::RenewLists => self.renew_lists(pairs, particles, range),
            Sweep::Grade => {
                self.has_lowered |= grading::grade_near(law.slope(), pairs, particles, range);
            }
            Sweep::SumForces => {
                let last = range.end;
                for first in range.step_by(BATCH_PARTICLES) {
                    let few = first..last.min(first + BATCH_PARTICLES);
                    self.stepper.forces.add_near(law, pairs, particles, few, &mut self.sum);
                }
            }
            Sweep::Transport | Sweep::Move | Sweep::TakeBack | Sweep::Polish => {
                has_moved |= !range.is_empty();
                self.displace(sweep, law, probe, pairs, particles, range);
            }
        }
        let is_done = self.next == n;
        if is_done {
            self.end(sweep, law, pairs, particles);
        }
        Swept { has_moved, is_done }
    }

    /// Ends a sweep that has come through all particles.
    fn end<L: Repulsion>(
        &mut self,
        sweep: Sweep,
        law: &L,
        pairs: &PackedNeighbours,
        particles: &mut Particles,
    ) {
        self.sweep = None;
        match sweep {
            Sweep::FillGrid => self.grid_serves = true,
            Sweep::RenewLists => self.lists.end_renewal(),
            Sweep::Grade => {
                self.has_lowered |= grading::grade_far(law.slope(), pairs, particles);
                self.is_steep |= self.has_lowered;
            }
            Sweep::SumForces => {
                self.stepper.forces.add_far(law, pairs, particles, &mut self.sum);
                self.sum /= particles.len() as f64;
            }
            Sweep::Transport | Sweep::Move | Sweep::TakeBack => {
                self.grid_serves = self.lists.end_move(L::SLACK * law.radius(particles, 0));
            }
            Sweep::Polish => {}
        }
    }

    /// The particles that a sweep comes through with what is `left` of a budget, which pays for
    /// them: the last one may go beyond it.
    fn affordable(&self, sweep: Sweep, left: &mut u32, n: usize) -> Range<usize> {
        let cost = |i: usize| match sweep {
            Sweep::RenewLists if self.lists.is_stale(i) => RENEWAL_UNITS,
            _ => 1,
        };
        let mut last = self.next;
        while last < n && *left > 0 {
            *left = left.saturating_sub(cost(last));
            last += 1;
        }
        self.next..last
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
        for i in range {
            if self.lists.is_stale(i) {
                self.lists.renew(pairs, particles, i);
            }
        }
    }

    /// Moves the particles of `range` as a sweep says, and lands them.
    fn displace<L: Repulsion>(
        &mut self,
        sweep: Sweep,
        law: &L,
        probe: &mut Probe,
        pairs: &PackedNeighbours,
        particles: &mut Particles,
        range: Range<usize>,
    ) {
        let Self { lists, stepper, lost, .. } = self;
        let is_transport = sweep == Sweep::Transport;
        let mut landing = LandingBatch::new();
        let mut next = range.start;
        while next < range.end {
            let range = batch(next..range.end, &particles.patch);
            next = range.end;
            let probe = &mut probe.on(particles.patch_of(range.start));
            let is_checked = pairs.any_weighted(&range) || stepper.may_stray();
            // Near a bend the energy depends on the normal, which is therefore evaluated at the
            // final position; and near another sheet a short correction may lead far away.
            landing.trust = if is_checked { 0.0 } else { TRUSTED_CORRECTION };
            match sweep {
                Sweep::Move => stepper.advance(law, particles, range.clone(), &mut landing),
                Sweep::TakeBack => {
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
}
