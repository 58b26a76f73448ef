//! The steps of the [methods](super::methods), on the state of a run. A step that takes long does
//! as much as the budget allows, and returns a result once it is done.

use super::methods::Verdict;
use super::{Output, Sampler, Tools};
use crate::particles::OrientedPoint;
use crate::sampler::attempt::{Attempt, Refining};
use crate::sampler::constraint::tips::{self, Tip};
use crate::sampler::discovery::audit::holds_any;
use crate::sampler::discovery::singular::{self, Singular};
use crate::sampler::discovery::survey::Absence;
use crate::sampler::flow::{BALANCE_EVERY, FlowSurface, Settled};
use crate::sampler::front::{Front, FrontContext};
use crate::sampler::phase::{Phase, StopReason};
use crate::sampler::probe::{BATCH, Probe};
use crate::sampler::progress::RefineProgress;
use crate::sampler::refine::{Coarse, Components, MovingMesh, Next, Refinement, Refusal, SurfaceFacts, Turn};
use crate::sampler::relaxation::{MoveLimits, Relaxation, RepulsionLaw, Sweep, Swept};
use crate::sampler::settings::{GapPolicy, Method, Sampling, SizeMode};
use core::ops::Range;
use glam::{DVec3, Vec3};
use rand_core::SeedableRng;

/// Largest number of units of the search, of the audit or of the relaxation in one step, whatever
/// the budget: a caller that derives its budget from the pace of the front must not wait. A unit
/// takes 0.04 to 0.5 µs natively, a slice 0.3 to 4 ms. The limit changes no particle.
const SLICE: u32 = 8_192;
/// Seeds that an attempt may undo, plus one for every particle.
const MOST_LONE_SEEDS: usize = 256;

/// Position in the sequence of seeds: a point drawn from the surface first, and then the survey's
/// points in grid order.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SurveyCursor {
    /// Whether a point has been drawn.
    pub(super) has_drawn: bool,
    /// The survey's point that is tried next.
    pub(super) next: usize,
}

impl Sampler {
    /// Empties the columns and prepares fronts of the present radius. Returns whether an earlier
    /// coarse front is known, whose components this one covers.
    pub(super) fn begin_attempt(&mut self) -> bool {
        (self.phase, self.seeds) = (Phase::Seeding, SurveyCursor::default());
        self.output.moved = true;
        self.output.particles.clear();
        self.tools.neighbours.clear();
        self.plan = self.attempt.front(&self.settings, &self.bounds);
        // Growing by doubling would hold twice the columns, and four times while they are copied.
        let room = Attempt::reserved(self.plan.expected, &self.settings);
        self.output.particles.reserve(room);
        self.tools.neighbours.reserve(room);
        self.tools.front.reset(&self.plan, &self.survey, room);
        let is_known = self.tools.coarse.known().is_some();
        if !is_known {
            self.counts.seeds = 0;
            (self.counts.left_out, self.counts.ended_early) = (0, false);
            self.counts.front_evaluations = 0;
            self.components.restart();
        }
        is_known
    }

    /// Starts a front over a component that an earlier coarse front has covered. Returns whether it
    /// has.
    pub(super) fn begin_at_known(&mut self, probe: &mut Probe) -> bool {
        let seed = self.tools.coarse.known().map(|known| OrientedPoint::of(known, 0));
        seed.is_some_and(|seed| self.begin_front(probe, seed))
    }

    /// Looks for the next survey point that no particle covers and starts a front there. Returns
    /// whether there was one.
    pub(super) fn find_seed(&mut self, probe: &mut Probe, left: &mut u32) -> Option<bool> {
        while *left > 0 {
            if self.tools.front.level().capped || self.has_too_many_lone_seeds() {
                return Some(false);
            }
            let start = probe.evaluations();
            let mut point = None;
            if !core::mem::replace(&mut self.seeds.has_drawn, true) {
                let mut random = rand_pcg::Pcg32::seed_from_u64(self.settings.seed);
                point = self.survey.on_random_line(probe, &self.bounds, &mut random);
            }
            let Some(point) = point.or_else(|| {
                self.seeds.next += 1;
                self.survey.point(self.seeds.next - 1)
            }) else {
                return Some(false);
            };
            *left -= 1;
            let patch = self.patch_at(probe, point.position);
            let front = &mut self.tools.front;
            let own = &mut probe.on(patch);
            let is_seed = !front.is_covered(own, &self.output.particles, point, patch)
                && self.survey.is_zero(own, point);
            self.counts.seeding_evaluations += probe.evaluations() - start;
            if is_seed && self.begin_front(probe, point) {
                return Some(true);
            }
        }
        None
    }

    /// The patch of a point; none if the surface has no creases.
    fn patch_at(&self, probe: &mut Probe, point: Vec3) -> Option<u32> {
        let has_patches =
            self.creases.are_there() || !self.output.particles.patch.is_empty() || probe.field.has_limits();
        has_patches.then(|| probe.field.label(point.as_dvec3()))
    }

    /// Places particles on the creases, on the tips and around these, and starts fronts from them.
    /// Returns whether there are any.
    pub(super) fn begin_at_creases(&mut self, probe: &mut Probe) -> bool {
        let before = probe.evaluations();
        let plan = &self.plan;
        let halvings = self.attempt.refining.as_ref().map_or(0, |refining| refining.halvings);
        let sizing = plan.sizing.as_ref();
        let mut radius = |probe: &mut Probe, place| {
            sizing.map_or(plan.radius, |sizing| sizing.radius_at(probe.field, place))
        };
        // A coarse front grows beyond the box.
        let is_refined = self.attempt.refining.is_some();
        let beyond = is_refined.then(|| self.creases.beyond(probe, &self.bounds, &plan.bounds)).flatten();
        let filled = beyond.as_ref().unwrap_or(&self.creases).fill(probe, halvings, &mut radius);
        let particles = &mut self.output.particles;
        let along = filled.add_rows(probe, particles);
        let match_share = 2.0 * self.settings.match_tolerance as f32;
        tips::add(probe, &self.tips, radius, match_share, &self.bounds, particles);
        if particles.is_empty() {
            return false;
        }
        if let Some(refining) = &mut self.attempt.refining {
            refining.ladder = Some(filled.into_ladder(particles, beyond.is_some().then_some(&self.bounds)));
        }
        self.counts.seeds += self.creases.pieces() + (particles.twins.len() - along.len()) as u32;
        self.counts.seeding_evaluations += probe.evaluations() - before;
        self.with_front(probe, |front, context| front.add_creases(context, &along));
        self.phase = Phase::Generation;
        true
    }

    /// Starts a front. Returns whether it has: not if the limit on particles is reached, nor where
    /// an adaptive surface has no radius.
    fn begin_front(&mut self, probe: &mut Probe, seed: OrientedPoint) -> bool {
        if self.output.particles.len() >= self.settings.max_particles as usize {
            self.tools.front.cap();
            return false;
        }
        let patch = self.patch_at(probe, seed.position);
        if patch.is_some_and(|patch| probe.field.is_limit(patch)) {
            return false;
        }
        if patch.is_some() {
            let probe = &mut probe.on(patch);
            // Where branches are equal, on creases and where bodies share a plane, only fronts of
            // the creases begin.
            let (place, size) = (seed.position, self.plan.radius);
            let normal = probe.gradient(place).1.normalize_or_zero();
            if ![normal, -normal].into_iter().all(|aside| probe.is_on_patch(place, aside, size, patch)) {
                return false;
            }
        }
        let is_started = self.with_front(probe, |front, context| front.add_seed(context, seed, patch));
        if is_started {
            self.counts.seeds += u32::from(self.tools.coarse.known().is_none());
            self.phase = Phase::Generation;
        }
        is_started
    }

    /// Whether the front has met itself, another one or the box everywhere.
    pub(super) fn has_closed(&self) -> bool {
        self.tools.front.is_done()
    }

    /// [`Front::place_children`].
    pub(super) fn place_children(&mut self, probe: &mut Probe, left: &mut u32) -> Option<()> {
        self.spend_on_front(probe, left, Front::place_children)
    }

    /// [`Front::project_children`].
    pub(super) fn project_children(&mut self, probe: &mut Probe, left: &mut u32) -> Option<()> {
        self.spend_on_front(probe, left, Front::project_children)
    }

    /// [`Front::settle_children`].
    pub(super) fn settle_children(&mut self, probe: &mut Probe, left: &mut u32) -> Option<()> {
        self.spend_on_front(probe, left, Front::settle_children)
    }

    /// Ends a front, whose seed `is_witness` if the search has found it.
    pub(super) fn end_front(&mut self, probe: &mut Probe, is_witness: bool) {
        let is_dropped = self.drop_lone_seed(probe, is_witness);
        self.counts.left_out += u32::from(is_dropped);
        self.phase = if is_witness { Phase::Search } else { Phase::Seeding };
    }

    /// Undoes the last seed if it stayed alone next to another particle, unless it `is_witness` of
    /// a small piece of its own. Returns whether it did.
    fn drop_lone_seed(&mut self, probe: &mut Probe, is_witness: bool) -> bool {
        let is_lone = self.with_front(probe, |front, context| front.has_lone_seed(context.particles));
        let is_kept =
            is_lone && is_witness && self.tools.coarse.known().is_none() && self.is_on_own_piece(probe);
        if is_lone && !is_kept {
            self.with_front(probe, |front, context| front.drop_last_seed(context));
        }
        is_lone && !is_kept
    }

    /// Whether the last particle, a witness, is the only one on a small closed piece of the
    /// surface.
    fn is_on_own_piece(&mut self, probe: &mut Probe) -> bool {
        /// The reach of a piece is measured along a few paths; between them it may be longer.
        const ROOM: f64 = 1.05;
        let last = self.output.particles.len() - 1;
        let Some(field) = probe.field.bounded() else { return false };
        let Some((seed, reach)) = self.components.small_piece(field, self.output.particles.radius[last])
        else {
            return false;
        };
        let reach = ROOM * reach;
        let slack = f64::from(2.0 * self.plan.tolerance(&self.survey).residual);
        let others = self.tools.front.within(seed.position, reach as f32);
        let others = others.iter().map(|near| near.index as usize).filter(|&j| j != last);
        !holds_any(field, &self.output.particles, seed, reach, others, slack)
    }

    /// Calls a method of the front with its context.
    fn with_front<R>(
        &mut self,
        probe: &mut Probe,
        call: impl FnOnce(&mut Front, &mut FrontContext) -> R,
    ) -> R {
        let mut context = FrontContext {
            probe,
            sizing: self.plan.sizing.as_ref(),
            neighbours: &mut self.tools.neighbours,
            particles: &mut self.output.particles,
        };
        call(&mut self.tools.front, &mut context)
    }

    /// Calls a method of the front that spends the budget, and counts its evaluations. The method
    /// returns whether it is done.
    fn spend_on_front(
        &mut self,
        probe: &mut Probe,
        left: &mut u32,
        call: impl FnOnce(&mut Front, &mut FrontContext, &mut u32) -> bool,
    ) -> Option<()> {
        let start = probe.evaluations();
        let is_done = self.with_front(probe, |front, context| call(front, context, left));
        let evaluations = probe.evaluations() - start;
        self.counts.generation_evaluations += evaluations;
        self.counts.front_evaluations += evaluations;
        is_done.then_some(())
    }

    /// Begins the search for components that the survey has missed. Returns whether anything is
    /// left to search since an earlier front.
    pub(super) fn begin_search(&mut self) -> bool {
        self.phase = Phase::Search;
        !self.components.is_searched()
    }

    /// Looks for the next witness that no particle covers and starts a front there. Returns whether
    /// there was one: after the last one only gaps are left uncovered.
    pub(super) fn find_witness(&mut self, probe: &mut Probe, left: &mut u32) -> Option<bool> {
        if self.tools.front.level().capped {
            return Some(false);
        }
        let tolerance = self.plan.tolerance(&self.survey);
        let slice = (*left).min(SLICE);
        let least_gap = self.least_gap();
        let unused = self.components.search(probe, &self.bounds, tolerance, least_gap, slice);
        if unused == 0 {
            *left = 0;
            return None;
        }
        *left -= slice - unused;
        while *left > 0 {
            if self.tools.front.level().capped || self.has_too_many_lone_seeds() {
                return Some(false);
            }
            let (witness, unused) = self.components.next(*left);
            *left = unused;
            let Some(seed) = witness else { return Some(false) };
            let rule = self.tools.front.level().rule;
            let point = OrientedPoint { position: seed.position, normal: seed.normal };
            let patch = self.patch_at(probe, point.position);
            let near = self.tools.front.list_cover(&self.output.particles, point, patch);
            let start = probe.evaluations();
            let is_covered =
                self.components.is_covered(probe, &self.output.particles, seed, &near, tolerance, rule);
            self.counts.seeding_evaluations += probe.evaluations() - start;
            if !is_covered && self.begin_front(probe, point) {
                return Some(true);
            }
        }
        None
    }

    /// Whether so many seeds were undone, because they stayed alone next to other particles, that
    /// no more are tried. A front costs the same whether it places a particle or none: without a
    /// bound, a radius larger than the distances between thousands of sheets makes a long run of
    /// few particles.
    fn has_too_many_lone_seeds(&mut self) -> bool {
        let is_over = self.counts.left_out as usize > MOST_LONE_SEEDS + self.output.particles.len();
        self.counts.ended_early |= is_over;
        is_over
    }

    /// Lists the gaps to be filled, and returns whether there are any.
    pub(super) fn begin_filling(&mut self) -> bool {
        let front = &mut self.tools.front;
        let has_gaps =
            self.settings.gaps == GapPolicy::Fill && !front.level().capped && front.begin_filling();
        if has_gaps {
            self.phase = Phase::Generation;
        }
        has_gaps
    }

    /// [`Front::fill`].
    pub(super) fn fill(&mut self, probe: &mut Probe, left: &mut u32) -> Option<()> {
        self.spend_on_front(probe, left, Front::fill)
    }

    /// Decides what follows once the surface is covered.
    pub(super) fn judge_front(&mut self, probe: &mut Probe) -> Verdict {
        let count = self.output.particles.count();
        if count == 0 {
            return Verdict::Stands(match self.survey.absence {
                Absence::Constant => StopReason::Constant,
                Absence::Undefined | Absence::TooLarge => StopReason::Undefined,
                _ => StopReason::NoSurface,
            });
        }
        if let Some(verdict) = self.begin_refinement(probe) {
            return verdict;
        }
        let is_capped = self.tools.front.level().capped;
        if self.attempt.is_corrected(&self.settings, count, is_capped) {
            return Verdict::Again;
        }
        let is_alone = self.tools.front.level().fates.added == 0 && self.output.particles.twins.is_empty();
        if is_alone && !is_capped {
            Verdict::Stands(StopReason::OneParticle)
        } else if self.settings.relax_steps == 0 && self.settings.sampling == Sampling::Uniform {
            Verdict::Stands(self.reason_for_end())
        } else {
            Verdict::Relax
        }
    }

    /// Undoes what a stopped front has not settled.
    pub(super) fn leave_front(&mut self, _: &mut Probe) {
        self.tools.front.stop(&mut self.output.particles);
        self.output.particles =
            self.tools.coarse.end().unwrap_or(core::mem::take(&mut self.output.particles));
        self.drop_beyond();
        self.attempt.refining = None;
    }

    /// Begins to refine the front that has covered the surface, or another one over a component
    /// that may be coarser. Does nothing if the front is final.
    fn begin_refinement(&mut self, probe: &mut Probe) -> Option<Verdict> {
        let target = self.attempt.target(&self.settings)?;
        let unpinned = self.unpinned();
        let before = probe.evaluations();
        let next = if let Some(refusal) = unpinned {
            Err(refusal)
        } else if self.tools.front.level().capped {
            Err(Refusal::Full)
        } else {
            let surface = self.attempt.surface(&self.bounds);
            self.tools.coarse.take_in(probe, &surface, &mut self.output.particles, target)
        };
        self.counts.generation_evaluations += probe.evaluations() - before;
        Some(match next {
            Ok(Next::Front(fewer)) => {
                self.attempt.refining.as_mut()?.halvings = fewer;
                Verdict::Again
            }
            Ok(Next::Refine(components)) => {
                self.tools.front.release();
                // They belong to the front.
                self.tools.neighbours.clear();
                // The last front was one of several.
                self.output.moved |= self.tools.coarse.are_several;
                self.drop_beyond();
                (self.phase, self.refined) = (Phase::Refinement, RefineProgress::default());
                Verdict::Refine(components)
            }
            Err(refusal) => {
                self.refuse(refusal);
                Verdict::Again
            }
        })
    }

    /// Why the front is not refined, if there is a singular point without a particle: no tip, or
    /// one without room for it.
    fn unpinned(&self) -> Option<Refusal> {
        let Output { particles, .. } = &self.output;
        let is_near = |point: &Singular, p: DVec3| point.position.distance(p) <= singular::SAME * point.reach;
        let is_pinned = |point: &&Singular| {
            (0..particles.twins.len()).any(|row| is_near(point, particles.local[row].as_dvec3()))
        };
        let point = self.components.singular().iter().find(|point| !is_pinned(point))?;
        let at = point.position.as_vec3().into();
        let is_tip = self.tips.iter().any(|tip| is_near(point, tip.position));
        Some(if is_tip { Refusal::Doubtful { at } } else { Refusal::Singular { at } })
    }

    /// Tries a front of half the radius, or returns to one of the wanted radius. Pieces between
    /// creases are refined at least once, and so is a lone component of varying sizes.
    fn refuse(&mut self, refusal: Refusal) {
        let is_lone = !self.tools.coarse.are_several;
        self.tools.coarse.end();
        let are_graded = self.attempt.sizing.is_some();
        let least = |refining: &Refining| u32::from(refining.ladder.is_some() || is_lone && are_graded);
        if self.attempt.refining.as_mut().is_some_and(Refining::recall_nearest) {
            return;
        }
        match &mut self.attempt.refining {
            Some(refining) if refining.halvings > least(refining) && refusal.is_coarse() => {
                // The first failure is reported; the last one may only be that nothing is left to
                // try.
                refining.failure = refining.failure.or(Some(refusal));
                refining.halvings -= 1;
            }
            refining => {
                let failure = refining.as_ref().and_then(|refining| refining.failure);
                let mut refusal = failure.unwrap_or(refusal);
                let at = refusal.at().map(|at| Vec3::from(at.0).as_dvec3());
                // Within two spacings of a tip the tip itself is the obstacle.
                let is_near =
                    |tip: &&Tip| at.is_some_and(|at| tip.position.distance(at) <= 4.0 * self.attempt.radius);
                let tip = self.tips.iter().find(is_near).map(|tip| tip.position.as_vec3().into());
                self.counts.refusal = Some(tip.map_or(refusal, |at| Refusal::Tip { at }));
                self.attempt = self.attempt.without_refinement(&self.settings, self.bounds.diagonal());
            }
        }
    }

    /// Begins one of `levels` levels of a component's refinement, with `to_come` levels after it.
    /// The component has this share of its particles.
    pub(super) fn begin_level(&mut self, levels: u32, to_come: u32, share: f64) {
        self.refined.begin(levels, to_come, share);
    }

    /// [`Refinement::land`].
    pub(super) fn land(
        &mut self,
        mesh: &mut Refinement,
        coarse: &mut Coarse,
        probe: &mut Probe,
        left: &mut u32,
    ) -> Option<Result<(), Refusal>> {
        self.work_on_mesh(probe, |probe, surface| mesh.land(probe, surface, coarse, left))
    }

    /// [`Refinement::go_on`].
    pub(super) fn make_pass(
        &mut self,
        mesh: &mut Refinement,
        rest: &mut Range<u32>,
        probe: &mut Probe,
        left: &mut u32,
    ) -> Option<Result<(), Refusal>> {
        self.refined.at = mesh.share();
        self.work_on_mesh(probe, |probe, surface| mesh.go_on(probe, surface, rest, left))
    }

    /// Works on a mesh that is refined or that follows a moving surface, and counts the
    /// evaluations. The work returns whether it is done.
    fn work_on_mesh(
        &mut self,
        probe: &mut Probe,
        work: impl FnOnce(&mut Probe, &SurfaceFacts) -> Result<bool, Refusal>,
    ) -> Option<Result<(), Refusal>> {
        let before = probe.evaluations();
        let done = work(probe, &self.attempt.surface(&self.bounds));
        let evaluations = match self.phase {
            Phase::Flow => &mut self.counts.relaxation_evaluations,
            _ => &mut self.counts.generation_evaluations,
        };
        *evaluations += probe.evaluations() - before;
        match done {
            Ok(is_done) => is_done.then_some(Ok(())),
            Err(refusal) => Some(Err(refusal)),
        }
    }

    /// Shows the particles of a level that all components have finished, so that a cancelled run
    /// has all of its particles.
    pub(super) fn show_level(&mut self, components: &mut Components, to_come: u32, left: &mut u32) {
        let ladder = self.attempt.refining.as_ref().and_then(|refining| refining.ladder.as_ref());
        self.output.particles = components.particles(to_come, ladder);
        self.output.moved = true;
        *left = left.saturating_sub(self.output.particles.len() as u32);
    }

    /// Inspects the particles of a level from number `next` on: whether f vanishes at those off the
    /// creases, or whether one has been refined over an undetected edge of its patch.
    pub(super) fn inspect_level(
        &mut self,
        next: &mut usize,
        probe: &mut Probe,
        left: &mut u32,
    ) -> Option<Result<(), Refusal>> {
        /// Largest distance of a particle from the surface, in radii. It is far above the tolerance
        /// of the projection; larger: narrower strips beyond an edge are missed.
        const OFF: f32 = 0.02;
        let Output { particles, .. } = &self.output;
        if particles.patch.is_empty() {
            return Some(Ok(()));
        }
        let blur = self.survey.resolution;
        *next = (*next).max(particles.twins.len());
        while *next < particles.len() {
            if *left == 0 {
                return None;
            }
            let end = particles.len().min(*next + BATCH);
            let (value, gradient) = probe.gradients(&particles.local[*next..end]);
            for ((row, value), gradient) in (*next..end).zip(value).zip(gradient) {
                if value.abs() > gradient.length() * (OFF * particles.radius[row] + blur) {
                    return Some(Err(Refusal::Folded { at: particles.local[row].into() }));
                }
            }
            *next = end;
            *left = left.saturating_sub(BATCH as u32);
        }
        Some(Ok(()))
    }

    /// Returns whether the refined particles are final; if not, or if the refinement was given up
    /// for a `refusal`, another front is tried.
    pub(super) fn judge_refinement(&mut self, components: Components, refusal: Option<Refusal>) -> bool {
        let Some(refining) = &mut self.attempt.refining else { return true };
        // The component that was refined least sets how coarse the next front may be.
        refining.halvings = components.fewest_halvings();
        if let Some(refusal) = refusal {
            refining.failures += 1;
            refining.failure = Some(refusal);
            self.refuse(refusal);
            return false;
        }
        let count = self.output.particles.count();
        if self.attempt.is_front_corrected(&self.settings, count, components.are_in_order()) {
            return false;
        }
        self.counts.refined_levels = Some(components.most_halvings());
        self.output.corners = components.into_corners();
        self.attempt.refining = None;
        true
    }

    /// Ends a refinement that was stopped: the columns hold the last level that was finished, or
    /// the coarse front.
    pub(super) fn leave_refinement(&mut self, _: &mut Probe) {
        self.attempt.refining = None;
    }

    /// Drops the particles of a coarse front that has grown beyond the box.
    fn drop_beyond(&mut self) {
        if self.attempt.refining.is_some() {
            let count = self.output.particles.len();
            self.output.particles.keep_within(&self.bounds);
            self.output.moved |= self.output.particles.len() < count;
        }
    }

    fn law(&self) -> RepulsionLaw {
        let tolerance = self.attempt.tolerance(&self.survey);
        match self.settings.sampling {
            Sampling::Uniform => RepulsionLaw::Gaussian { radius: self.attempt.radius as f32, tolerance },
            Sampling::Adaptive => RepulsionLaw::Overlap {
                residual_limits: self.survey.residual_limits(),
                min_gradient: tolerance.min_gradient,
            },
        }
    }

    /// Begins the relaxation of the present particles.
    pub(super) fn begin_relaxation(&mut self) {
        self.phase = Phase::Relaxation;
        self.output.corners = Vec::new();
        self.tools.front.release();
        self.output.particles.shrink();
        self.tools.neighbours.shrink();
        let law = self.law();
        let steps = self.settings.relax_steps;
        let limits =
            MoveLimits { bounds: self.bounds, largest_lift: self.tools.front.level().rule.largest_lift() };
        self.tools.relaxation.begin(law, limits, steps, &self.output.particles, &mut self.tools.neighbours);
    }

    /// Begins a frame of particles that follow a moving surface with the mesh of a refined run, if
    /// one can.
    pub(super) fn begin_mesh(&mut self) -> Option<MovingMesh> {
        if self.output.corners.is_empty() || self.tools.flow.is_closed {
            return None;
        }
        let (particles, corners) = (&self.output.particles, &self.output.corners);
        let (target, spacing) = (self.attempt.moving_target(&self.settings), self.attempt.spacing());
        let turn = Turn { at: self.tools.flow.turn(), of: BALANCE_EVERY };
        MovingMesh::new(particles, corners, &self.bounds, target, spacing, turn)
    }

    /// Begins to move the particles onto the surface that has moved.
    pub(super) fn begin_transport(&mut self) {
        self.output.corners = Vec::new();
        let are_listed = self.tools.flow.begin_frame();
        let limits = MoveLimits { bounds: self.bounds, largest_lift: f32::INFINITY };
        let (law, particles) = (self.law(), &self.output.particles);
        self.tools.relaxation.begin_transport(law, limits, particles, &mut self.tools.neighbours, are_listed);
    }

    /// Lets particles be born and die after their transport to the surface. Returns the number of
    /// relaxation steps to make.
    pub(super) fn settle(&mut self, probe: &mut Probe) -> u32 {
        let Tools { relaxation, flow, neighbours, front, .. } = &mut self.tools;
        let particles = &mut self.output.particles;
        let surface = FlowSurface {
            bounds: self.bounds,
            survey: &self.survey,
            rule: front.level().rule,
            sizing: self.attempt.sizing.as_ref(),
            radius: self.attempt.radius as f32,
            count: (self.settings.size_mode == SizeMode::Count).then_some(self.settings.count),
            max_particles: self.settings.max_particles as usize,
        };
        let Settled { rows, steps } = flow.settle(probe, &surface, relaxation.lost(), neighbours, particles);
        if particles.is_empty() {
            return 0;
        }
        if let Some(rows) = rows.filter(|_| steps > 0) {
            relaxation.keep(&rows, particles, neighbours);
        }
        steps
    }

    /// Ends a frame of particles that follow a moving surface. Returns whether they must be
    /// transported once more.
    pub(super) fn end_frame(&mut self, probe: &mut Probe) -> bool {
        self.tools.flow.is_whole = true;
        if self.tools.flow.is_late() {
            return true;
        }
        if self.tools.flow.is_last() && self.tools.flow.is_seeded {
            self.join_again(probe);
        }
        false
    }

    /// Moves the particles with their mesh. Returns whether the mesh could follow; if it was given
    /// up for a `refusal`, they continue without it.
    pub(super) fn judge_mesh(&mut self, mesh: MovingMesh, refusal: Option<Refusal>) -> bool {
        if refusal.is_some() {
            self.tools.flow.hurry();
            return false;
        }
        if self.settings.size_mode == SizeMode::Count && self.attempt.sizing.is_none() {
            self.attempt.radius *= mesh.growth();
        }
        let Output { particles, corners, moved, .. } = &mut self.output;
        mesh.hand_on(self.attempt.radius as f32, particles, corners);
        *moved = true;
        if !self.tools.flow.end_with_mesh(particles, &self.survey) {
            *corners = Vec::new();
        }
        true
    }

    /// Joins the particles of a refined run to a mesh again, which they lost when the surface tore
    /// or joined.
    fn join_again(&mut self, probe: &mut Probe) {
        let is_refined = self.settings.method == Method::Refined && self.counts.refusal.is_none();
        if !is_refined {
            return;
        }
        let Output { particles, corners, .. } = &mut self.output;
        let target = self.attempt.moving_target(&self.settings);
        if let Ok(mesh) = MovingMesh::join(probe, particles, &self.bounds, target) {
            mesh.hand_on(self.attempt.radius as f32, particles, corners);
            self.tools.flow.number(particles);
            self.tools.flow.is_whole = false;
        }
    }

    /// Continues a sweep of the relaxation over all particles.
    pub(super) fn sweep(&mut self, sweep: Sweep, probe: &mut Probe, left: &mut u32) -> Option<()> {
        let start = probe.evaluations();
        let sizing = self.attempt.sizing.as_ref();
        *left = (*left).min(SLICE);
        let Output { particles, moved, .. } = &mut self.output;
        let Tools { relaxation, neighbours, .. } = &mut self.tools;
        let Swept { has_moved, is_done } =
            relaxation.go_on(sweep, probe, sizing, neighbours, particles, left);
        *moved |= has_moved;
        self.counts.relaxation_evaluations += probe.evaluations() - start;
        is_done.then_some(())
    }

    /// The relaxation.
    pub(super) fn relaxation(&mut self) -> &mut Relaxation {
        &mut self.tools.relaxation
    }

    /// Undoes a step that is only half made.
    pub(super) fn leave_step(&mut self, _: &mut Probe) {
        self.output.moved |= self.tools.relaxation.abandon(&mut self.output.particles);
    }

    /// Begins to find out which components hold particles, now that all are placed.
    pub(super) fn begin_audit(&mut self) {
        (self.phase, self.output.fraction) = (Phase::Search, 1.0);
        if self.creases.repeat_faces(&mut self.output.particles, &mut self.output.corners) {
            self.output.moved = true;
            // They belong to the particles before.
            self.tools.neighbours.clear();
        }
        self.components.restart_audit();
    }

    /// Finds out which components hold particles.
    pub(super) fn audit(&mut self, probe: &mut Probe, left: &mut u32) -> Option<()> {
        let tolerance = self.attempt.tolerance(&self.survey);
        let slice = (*left).min(SLICE);
        let start = probe.evaluations();
        let unused = self.components.audit(
            probe,
            &self.output.particles,
            self.attempt.radius,
            tolerance,
            self.tools.front.level().rule,
            slice,
        );
        self.counts.seeding_evaluations += probe.evaluations() - start;
        if unused == 0 {
            *left = 0;
            return None;
        }
        *left -= slice - unused;
        Some(())
    }

    /// Why a run ends after it has covered the surface.
    pub(super) fn reason_for_end(&self) -> StopReason {
        if self.tools.front.level().capped { StopReason::Cap } else { StopReason::Complete }
    }

    /// Marks the particles next to singular points, where there are any.
    pub(super) fn mark(&mut self, probe: &mut Probe) {
        if !self.components.singular().is_empty() {
            singular::mark(probe.field, self.components.singular(), &mut self.output.particles);
            self.output.moved = true;
            let singular = self.components.singular().to_vec();
            self.find_bare_place(probe.field, &singular);
        }
    }
}
