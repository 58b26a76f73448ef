//! Reports of a run to its caller: the answer to the start, the state after a step, and the counts.

use super::{Sampler, StopReason};
use crate::particles::Particles;
use crate::sampler::fates::FateCounts;
use crate::sampler::phase::Phase;
use crate::sampler::refine::{self, Refusal};
use crate::sampler::settings::Pattern;
use serde::Serialize;

/// Cost of a relaxation step per particle, as a share of what it costs to place the particle, for
/// the display of progress. Natively it is 0.07 to 0.2.
const RELAXATION_STEP_COST: f64 = 0.125;

/// Share of the front in the cost of a pattern over it, for the display of progress.
const FRONT_OF_PATTERN: f64 = 0.25;

/// Result of [`Sampler::begin`]: the radius, and estimates for the run.
#[derive(Clone, Copy, Debug)]
pub struct Forecast {
    /// Repulsion radius of the run.
    pub radius: f64,
    /// Expected number of particles.
    pub predicted_count: u64,
    /// Estimated area of the surface in the box.
    pub area: f64,
}

/// State after a step.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Progress {
    /// Current phase.
    pub phase: Phase,
    /// Particles in the columns that will stay, each counted once.
    pub particles: usize,
    /// Rows of the columns that will stay: one for each particle, or one on each side for those on
    /// creases.
    pub rows: usize,
    /// Front under way, from 1: each attempt at a wanted number of particles begins anew, with
    /// another radius.
    pub attempt: u32,
    /// Generation level under way.
    pub level: u32,
    /// Level of the refinement under way, 1 the coarse one; 0 in every other phase.
    pub refine_level: u32,
    /// Levels that the refinement under way has.
    pub refine_levels: u32,
    /// Relaxation steps done.
    pub relax_step: u32,
    /// Relaxation steps asked for.
    pub relax_steps: u32,
    /// Points at which the survey and all phases have evaluated the field so far, whatever
    /// derivatives they asked for. A function is called more often: several times for each
    /// derivative by differences ([`FnField`](crate::field::FnField)), and for the box, the set-up
    /// and the proof, which are not counted.
    pub evaluations: u64,
    /// Estimated share of the work done. It never decreases until more work is requested.
    pub fraction: f64,
    /// Set once the run has ended.
    pub stop_reason: Option<StopReason>,
    /// A sentence for the user where the reason needs one. It may name places, which the reason
    /// does not hold.
    pub message: Option<String>,
    /// Repulsion radius.
    pub radius: f64,
    /// Whether particles that existed before this step have moved or been removed.
    pub moved: bool,
}

/// Counts of a run: evaluations by phase, and fates of the children.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Counts {
    /// Evaluations of the survey, of the radius field, of the tests whether seeds are covered, and
    /// of the audit.
    pub seeding_evaluations: u64,
    /// Evaluations of the fronts, all attempts at a wanted count.
    pub generation_evaluations: u64,
    /// Evaluations of the fronts of the last attempt, which placed the particles.
    pub front_evaluations: u64,
    /// Evaluations of the relaxation.
    pub relaxation_evaluations: u64,
    /// Fates of the children of the last attempt.
    pub fates: FateCounts,
    /// Particles placed in gaps between fronts.
    pub gaps_filled: u64,
    /// Fronts started, each from a seed of its own.
    pub seeds: u32,
    /// Seeds that stayed alone next to other particles and were undone.
    pub left_out: u32,
    /// Whether no more seeds were tried because too many had been undone.
    pub ended_early: bool,
    /// Number of refinements of the coarse front, if it was refined.
    pub refined_levels: Option<u32>,
    /// Why the front was kept although a refinement was requested.
    pub refusal: Option<Refusal>,
}

/// The progress of a refinement.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RefineProgress {
    /// Number of levels, including the coarse front.
    levels: u32,
    /// Levels still to come after the one under way.
    to_come: u32,
    /// Share of the particles of this level in components that have finished it.
    before: f64,
    /// Share of them in the component under way.
    share: f64,
    /// Share of its own work that this component has done.
    pub(super) at: f64,
}

impl RefineProgress {
    /// Begins a level of a component that has this share of its particles.
    pub(super) fn begin(&mut self, levels: u32, to_come: u32, share: f64) {
        let goes_on = (levels, to_come) == (self.levels, self.to_come);
        let before = if goes_on { self.before + self.share } else { 0.0 };
        *self = Self { levels, to_come, before, share, at: 0.0 };
    }

    /// The level under way, counted from 1, and how many there are.
    fn level(&self) -> (u32, u32) {
        (self.levels - self.to_come, self.levels)
    }

    /// Estimated share of the work done, including the coarse front.
    fn fraction(&self) -> f64 {
        // From a quarter of the share of this level to all of it.
        refine::coarse_share(self.to_come) * (1.0 + 3.0 * (self.before + self.share * self.at))
    }
}

impl Sampler<'_> {
    /// The present state. [`Progress::moved`] reports changes since the last step.
    #[must_use]
    pub fn progress(&self) -> Progress {
        let settled = self.cover.settled();
        let columns = self.cover.inside.as_ref().unwrap_or(&self.cover.particles);
        let rows = self.cover.inside.as_ref().map_or(settled, Particles::len);
        let (refine_level, refine_levels) =
            if self.cover.phase == Phase::Refinement { self.cover.refined.level() } else { (0, 0) };
        Progress {
            phase: self.cover.phase,
            particles: columns.count_of_first(rows),
            rows,
            attempt: self.cover.fronts.max(1),
            level: self.cover.particles.level[..settled].last().copied().unwrap_or(0),
            refine_level,
            refine_levels,
            relax_step: self.cover.relaxation.steps_done(),
            relax_steps: self.relax_steps(),
            evaluations: self.cover.evaluations,
            fraction: self.fraction(settled).max(self.cover.fraction),
            stop_reason: self.stop_reason,
            message: self.message(),
            radius: self.cover.attempt.radius,
            moved: self.cover.moved,
        }
    }

    /// Relaxation steps of the run: none for random patterns.
    fn relax_steps(&self) -> u32 {
        match self.settings.pattern_in_use() {
            Pattern::Hexagonal => self.settings.relax_steps,
            _ => 0,
        }
    }

    /// Estimated share of the run that is done, with so many `particles` placed for good.
    fn fraction(&self, particles: usize) -> f64 {
        let relax_steps = f64::from(self.relax_steps());
        let is_pattern = self.settings.pattern_in_use() != Pattern::Hexagonal;
        let generation =
            if is_pattern { FRONT_OF_PATTERN } else { 1.0 / (1.0 + RELAXATION_STEP_COST * relax_steps) };
        if let Some(drawn) = self.cover.drawn.filter(|_| is_pattern) {
            return generation + (1.0 - generation) * drawn.min(0.99);
        }
        match self.cover.phase {
            Phase::Idle => 0.0,
            Phase::Refinement => self.cover.refined.fraction(),
            Phase::Relaxation => {
                let relaxed = f64::from(self.cover.relaxation.steps_done()) / relax_steps.max(1.0);
                generation + (1.0 - generation) * relaxed
            }
            Phase::Done => 1.0,
            // In all other phases the number of particles grows.
            _ => {
                // A coarse front is the smaller part of its run, and so is a pilot. Any front may
                // place more particles than expected.
                let (share, expected) = match self.cover.plan.halvings {
                    Some(halvings) => (refine::coarse_share(halvings), self.cover.plan.expected),
                    None => (generation, self.cover.attempt.predicted_count(&self.settings)),
                };
                share * (particles as f64 / expected.max(1.0)).min(0.99)
            }
        }
    }
}
