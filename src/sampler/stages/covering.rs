//! The stage that covers a surface with particles.

use crate::math::Bounds;
use crate::particles::OrientedPoint;
use crate::sampler::attempt::Attempt;
use crate::sampler::constraint::{CreaseLadder, tips};
use crate::sampler::cover::Cover;
use crate::sampler::discovery::audit::holds_any;
use crate::sampler::front::{Front, FrontContext, FrontPlan};
use crate::sampler::pace::{SLICE, Stopped, Task};
use crate::sampler::phase::Phase;
use crate::sampler::probe::Probe;
use crate::sampler::settings::{GapPolicy, Sampling};
use crate::sampler::surface::Surface;
use glam::Vec3;
use rand_core::SeedableRng;

/// Seeds that an attempt may undo, plus one for every particle.
const MOST_LONE_SEEDS: usize = 256;

/// Covers the surface: from its creases and tips, from seeds of the survey, from witnesses of
/// components that the survey has missed, and in the gaps that are left. If a particle of an
/// earlier front is `known`, its component is covered alone, with other radii. Returns the
/// particles on creases at every level of a refinement, if the front is to be refined. What a
/// stopped front has not settled is undone.
pub(in crate::sampler) async fn cover_surface(
    task: &mut Task<'_>,
    cover: &mut Cover,
    plan: FrontPlan,
    known: Option<OrientedPoint>,
) -> Result<Option<CreaseLadder>, Stopped> {
    let covered = grow_fronts(task, cover, plan, known).await;
    if covered.is_err() {
        cover.front.stop(&mut cover.particles);
        if cover.plan.halvings.is_some() {
            cover.drop_beyond(task);
        }
    }
    covered
}

async fn grow_fronts(
    task: &mut Task<'_>,
    cover: &mut Cover,
    plan: FrontPlan,
    known: Option<OrientedPoint>,
) -> Result<Option<CreaseLadder>, Stopped> {
    task.check()?;
    cover.begin_attempt(task, plan, known.is_some());
    let mut ladder = None;
    if let Some(seed) = known {
        // One seed is enough.
        if task.until(cover, |cover, task, _| Some(cover.begin_front(task, seed))).await? {
            grow(task, cover, Origin::Known).await?;
        }
    } else {
        let on_creases = task.until(cover, |cover, task, _| Some(cover.begin_at_creases(task))).await?;
        if let Some(filled) = on_creases {
            ladder = filled;
            grow(task, cover, Origin::Survey).await?;
        }
        let mut seeds = Seeds::default();
        while task.until(cover, |cover, task, left| cover.find_seed(task, &mut seeds, left)).await? {
            grow(task, cover, Origin::Survey).await?;
        }
        cover.phase = Phase::Search;
        // An earlier front may have searched.
        if !cover.components.is_searched() {
            task.turn(cover).await?;
        }
        while task.until(cover, Cover::find_witness).await? {
            grow(task, cover, Origin::Witness).await?;
        }
    }
    while cover.begin_filling(task) {
        task.until(cover, |cover, task, left| {
            cover.on_front(task, |front, context| front.fill(context, left))
        })
        .await?;
        grow_levels(task, cover).await?;
    }
    Ok(ladder)
}

/// Grows a front.
async fn grow(task: &mut Task<'_>, cover: &mut Cover, origin: Origin) -> Result<(), Stopped> {
    grow_levels(task, cover).await?;
    cover.end_front(task, origin);
    Ok(())
}

/// Lets a front grow level by level, until it has met itself, another one or the box everywhere
/// (paper §4.2 to §4.4): parents predict children, these are projected onto the surface, and those
/// that find room are the parents of the next level.
async fn grow_levels(task: &mut Task<'_>, cover: &mut Cover) -> Result<(), Stopped> {
    while !cover.front.is_done() {
        for step in [Front::place_children, Front::project_children, Front::settle_children] {
            task.until(cover, |cover, task, left| {
                cover.on_front(task, |front, context| step(front, context, left))
            })
            .await?;
        }
    }
    Ok(())
}

/// Where the first particles of a front come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Origin {
    /// The creases, or a point of the survey.
    Survey,
    /// A witness of a component that the survey has missed.
    Witness,
    /// A particle of an earlier front.
    Known,
}

/// Position in the sequence of seeds: a point drawn from the surface first, and then the survey's
/// points in grid order.
#[derive(Clone, Copy, Debug, Default)]
struct Seeds {
    /// Whether a point has been drawn.
    has_drawn: bool,
    /// The survey's point that is tried next.
    next: usize,
}

impl Cover {
    /// Empties the columns and prepares fronts of a plan. If an earlier coarse front `is_known`,
    /// they cover one of its components anew.
    fn begin_attempt(&mut self, task: &Task, plan: FrontPlan, is_known: bool) {
        self.phase = Phase::Seeding;
        self.moved = true;
        self.particles.clear();
        self.neighbours.clear();
        self.plan = plan;
        // Growing by doubling would hold twice the columns, and four times while they are copied.
        let room = Attempt::reserved(self.plan.expected, &task.settings);
        self.particles.reserve(room);
        self.neighbours.reserve(room);
        self.front.reset(&self.plan, &task.surface.survey, room);
        if !is_known {
            self.fronts += 1;
            self.counts.seeds = 0;
            (self.counts.left_out, self.counts.ended_early) = (0, false);
            self.counts.front_evaluations = 0;
            self.components.restart();
        }
    }

    /// Looks for the next point of the surface that no particle covers and starts a front there.
    /// Returns whether there was one.
    fn find_seed(&mut self, task: &mut Task, seeds: &mut Seeds, left: &mut u32) -> Option<bool> {
        let Surface { survey, bounds, .. } = task.surface;
        while *left > 0 {
            if self.front.level().capped || self.has_too_many_lone_seeds() {
                return Some(false);
            }
            let start = task.probe.evaluations();
            let mut point = None;
            if !core::mem::replace(&mut seeds.has_drawn, true) {
                let mut random = rand_pcg::Pcg32::seed_from_u64(task.settings.seed);
                point = survey.on_random_line(&mut task.probe, bounds, &mut random);
            }
            let Some(point) = point.or_else(|| {
                seeds.next += 1;
                survey.point(seeds.next - 1)
            }) else {
                return Some(false);
            };
            *left -= 1;
            let patch = self.patch_at(task, point.position);
            let own = &mut task.probe.on(patch);
            let is_seed =
                !self.front.is_covered(own, &self.particles, point, patch) && survey.is_zero(own, point);
            self.counts.seeding_evaluations += task.probe.evaluations() - start;
            if is_seed && self.begin_front(task, point) {
                self.counts.seeds += 1;
                return Some(true);
            }
        }
        None
    }

    /// The patch of a point; none if the surface has no creases.
    fn patch_at(&self, task: &mut Task, point: Vec3) -> Option<u32> {
        let has_patches = task.surface.creases.are_there()
            || !self.particles.patch.is_empty()
            || task.probe.field.has_limits();
        has_patches.then(|| task.probe.field.label(point.as_dvec3()))
    }

    /// Places particles on the creases, on the tips and around these, and starts fronts from them.
    /// Returns nothing if there are none; otherwise, if the front is to be refined, where they lie
    /// at every level.
    fn begin_at_creases(&mut self, task: &mut Task) -> Option<Option<CreaseLadder>> {
        let Surface { creases, tips, bounds, .. } = task.surface;
        let before = task.probe.evaluations();
        let plan = &self.plan;
        let sizing = plan.sizing.as_ref();
        let mut radius = |probe: &mut Probe, place| {
            sizing.map_or(plan.radius, |sizing| sizing.radius_at(probe.field, place))
        };
        // A coarse front grows beyond the box.
        let is_refined = plan.halvings.is_some();
        let beyond = is_refined.then(|| creases.beyond(&mut task.probe, bounds, &plan.bounds)).flatten();
        let halvings = plan.halvings.unwrap_or(0);
        let creases = beyond.as_ref().unwrap_or(creases);
        let filled = creases.fill(&mut task.probe, halvings, f64::round, &mut radius);
        let particles = &mut self.particles;
        let along = filled.add_rows(&mut task.probe, particles);
        let match_share = 2.0 * task.settings.match_tolerance as f32;
        tips::add(&mut task.probe, tips, radius, match_share, bounds, particles);
        if particles.is_empty() {
            return None;
        }
        self.counts.seeds += creases.pieces() + (particles.twins.len() - along.len()) as u32;
        let ladder = is_refined.then(|| filled.into_ladder(particles, beyond.is_some().then_some(bounds)));
        self.counts.seeding_evaluations += task.probe.evaluations() - before;
        self.with_front(&mut task.probe, |front, context| front.add_creases(context, &along));
        self.phase = Phase::Generation;
        Some(ladder)
    }

    /// Starts a front. Returns whether it has: not if the limit on particles is reached, nor where
    /// an adaptive surface has no radius.
    fn begin_front(&mut self, task: &mut Task, seed: OrientedPoint) -> bool {
        if self.particles.len() >= self.plan.max_particles {
            self.front.cap();
            return false;
        }
        let patch = self.patch_at(task, seed.position);
        if patch.is_some_and(|patch| task.probe.field.is_limit(patch)) {
            return false;
        }
        if patch.is_some() {
            let probe = &mut task.probe.on(patch);
            // Where branches are equal, on creases and where bodies share a plane, only fronts of
            // the creases begin.
            let (place, size) = (seed.position, self.plan.radius);
            // Inside a solid f may be zero on the plane that two bodies share, and be no piece.
            let around = Bounds::point(place.as_dvec3()).enlarged(size.into());
            if !probe.may_have_zeros(patch, &around) {
                return false;
            }
            let normal = probe.gradient(place).1.normalize_or_zero();
            if ![normal, -normal].into_iter().all(|aside| probe.is_on_patch(place, aside, size, patch)) {
                return false;
            }
        }
        let is_started =
            self.with_front(&mut task.probe, |front, context| front.add_seed(context, seed, patch));
        if is_started {
            self.phase = Phase::Generation;
        }
        is_started
    }

    /// A step of the front, which says whether it is done.
    fn on_front(
        &mut self,
        task: &mut Task,
        step: impl FnOnce(&mut Front, &mut FrontContext) -> bool,
    ) -> Option<()> {
        let start = task.probe.evaluations();
        let is_done = self.with_front(&mut task.probe, step);
        let evaluations = task.probe.evaluations() - start;
        self.counts.generation_evaluations += evaluations;
        self.counts.front_evaluations += evaluations;
        is_done.then_some(())
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
            neighbours: &mut self.neighbours,
            particles: &mut self.particles,
        };
        call(&mut self.front, &mut context)
    }

    /// Ends a front. Undoes its seed if that stayed alone next to another particle, unless it is a
    /// witness of a small piece of its own.
    fn end_front(&mut self, task: &mut Task, origin: Origin) {
        let is_lone = self.front.has_lone_seed(&self.particles);
        if is_lone && !(origin == Origin::Witness && self.is_on_own_piece(task)) {
            self.with_front(&mut task.probe, |front, context| front.drop_last_seed(context));
            self.counts.left_out += 1;
        }
        self.phase = if origin == Origin::Survey { Phase::Seeding } else { Phase::Search };
    }

    /// Whether the last particle, a witness, is the only one on a small closed piece of the
    /// surface.
    fn is_on_own_piece(&mut self, task: &mut Task) -> bool {
        /// The reach of a piece is measured along a few paths; between them it may be longer.
        const ROOM: f64 = 1.05;
        let last = self.particles.len() - 1;
        let Some(field) = task.probe.field.bounded() else { return false };
        let Some((seed, reach)) = self.components.small_piece(field, self.particles.radius[last]) else {
            return false;
        };
        let reach = ROOM * reach;
        let slack = f64::from(2.0 * self.plan.tolerance(&task.surface.survey).residual);
        let others = self.front.within(seed.position, reach as f32);
        let others = others.iter().map(|near| near.index as usize).filter(|&j| j != last);
        !holds_any(field, &self.particles, seed, reach, others, slack)
    }

    /// Looks for the next witness that no particle covers and starts a front there. Returns whether
    /// there was one: after the last one only gaps are left uncovered.
    fn find_witness(&mut self, task: &mut Task, left: &mut u32) -> Option<bool> {
        if self.front.level().capped {
            return Some(false);
        }
        let tolerance = self.plan.tolerance(&task.surface.survey);
        let slice = (*left).min(SLICE);
        let least_gap = task.surface.survey.least_gap(task.settings.sampling == Sampling::Adaptive);
        let unused =
            self.components.search(&mut task.probe, &task.surface.bounds, tolerance, least_gap, slice);
        if unused == 0 {
            *left = 0;
            return None;
        }
        *left -= slice - unused;
        while *left > 0 {
            if self.front.level().capped || self.has_too_many_lone_seeds() {
                return Some(false);
            }
            let (witness, unused) = self.components.next(*left);
            *left = unused;
            let Some(seed) = witness else { return Some(false) };
            let rule = self.front.level().rule;
            let point = OrientedPoint { position: seed.position, normal: seed.normal };
            let patch = self.patch_at(task, point.position);
            let near = self.front.list_cover(&self.particles, point, patch);
            let start = task.probe.evaluations();
            let is_covered =
                self.components.is_covered(&mut task.probe, &self.particles, seed, &near, tolerance, rule);
            self.counts.seeding_evaluations += task.probe.evaluations() - start;
            if !is_covered && self.begin_front(task, point) {
                self.counts.seeds += 1;
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
        let is_over = self.counts.left_out as usize > MOST_LONE_SEEDS + self.particles.len();
        self.counts.ended_early |= is_over;
        is_over
    }

    /// Lists the gaps to be filled, and returns whether there are any.
    fn begin_filling(&mut self, task: &Task) -> bool {
        let front = &mut self.front;
        let has_gaps =
            task.settings.gaps == GapPolicy::Fill && !front.level().capped && front.begin_filling();
        if has_gaps {
            self.phase = Phase::Generation;
        }
        has_gaps
    }

    /// Drops the particles of a coarse front that has grown beyond the box.
    pub(in crate::sampler) fn drop_beyond(&mut self, task: &Task) {
        let count = self.particles.len();
        self.particles.keep_within(&task.surface.bounds);
        self.moved |= self.particles.len() < count;
        self.plan.halvings = None;
    }
}
