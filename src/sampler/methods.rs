//! The three methods, from top to bottom: a front with its relaxation or refinement, more steps of
//! the relaxation, and particles that follow a moving surface. A method puts together stages of
//! [`stages`](super::stages); [`Task`] says how they are done in slices.

use super::attempt::MOST_FRONTS;
use super::count::Search;
use super::cover::Cover;
use super::discovery::singular;
use super::discovery::survey::Absence;
use super::pace::{SLICE, Stopped, Task};
use super::phase::{Phase, StopReason};
use super::refine::{CoarseFronts, Next, Refusal};
use super::settings::{Pattern, Sampling};
use super::stages::coarse::Refining;
use super::stages::covering::cover_surface;
use super::stages::drawing::{correct_count, draw_pattern};
use super::stages::following::follow_surface;
use super::stages::refining::{Halt, refine};
use super::stages::relaxing::relax;
use crate::particles::OrientedPoint;
use crate::slices::Work;
use glam::Vec3;

/// The paper's method (§4 and §5), or the refined one if coarse fronts are planned and none has to
/// be given up.
pub(super) fn sample<'t>(
    task: &'t mut Task,
    cover: &'t mut Cover,
    refining: Option<Refining>,
) -> Work<'t, StopReason> {
    Box::pin(async move {
        let reason = place(task, cover, refining).await;
        ended(task, cover, reason)
    })
}

async fn place(
    task: &mut Task<'_>,
    cover: &mut Cover,
    refining: Option<Refining>,
) -> Result<StopReason, Stopped> {
    let reason = match refining {
        None => front(task, cover).await?,
        Some(refining) => match refined(task, cover, refining).await {
            Ok(reason) => reason,
            Err(Halt::Stopped) => return Err(Stopped),
            Err(Halt::Refused(refusal)) => {
                cover.refuse(task, refusal);
                front(task, cover).await?
            }
        },
    };
    audit(task, cover).await?;
    Ok(reason)
}

/// Fronts whose radius meets the wanted number of particles, and the relaxation of the last one; or
/// one front, and a pattern that is drawn over it.
async fn front(task: &mut Task<'_>, cover: &mut Cover) -> Result<StopReason, Stopped> {
    let is_drawn = task.settings.pattern_in_use() != Pattern::Hexagonal;
    let mut search = Search::new(MOST_FRONTS);
    loop {
        let plan = cover.attempt.front(&task.settings, &task.surface.bounds);
        cover_surface(task, cover, plan, None).await?;
        if let Some(reason) = cover.why_empty(task) {
            return Ok(reason);
        }
        let (count, is_capped) = (cover.particles.count(), cover.front.level().capped);
        // A pattern meets the wanted number by itself.
        let stands = is_drawn && !is_capped;
        if stands || !cover.attempt.is_corrected(&mut search, &task.settings, count, is_capped) {
            break;
        }
    }
    if is_drawn {
        task.turn(cover).await?;
        draw_pattern(task, cover).await?;
        return Ok(cover.reason_for_end());
    }
    let is_alone = cover.front.level().fates.added == 0 && cover.particles.twins.is_empty();
    if is_alone && !cover.front.level().capped {
        return Ok(StopReason::OneParticle);
    }
    let is_corrected = correct_count(task, cover).await?;
    if is_corrected || task.settings.relax_steps > 0 || task.settings.sampling == Sampling::Adaptive {
        cover.begin_relaxation(task.surface, &task.settings);
        task.turn(cover).await?;
        relax(task, cover).await?;
    }
    Ok(cover.reason_for_end())
}

/// Coarse fronts, of all components and then of each that may be coarser, until their refinement
/// meets the wanted number of particles.
async fn refined(task: &mut Task<'_>, cover: &mut Cover, mut refining: Refining) -> Result<StopReason, Halt> {
    let mut coarse = CoarseFronts::default();
    loop {
        let plan = refining.front(&mut cover.attempt, &task.settings, &task.surface.bounds);
        let known = coarse.known().map(|known| OrientedPoint::of(known, 0));
        let is_first = known.is_none();
        match cover_surface(task, cover, plan, known).await {
            Ok(ladder) if is_first => refining.ladder = ladder,
            Ok(_) => {}
            Err(stopped) => {
                if let Some(first) = coarse.end() {
                    cover.particles = first;
                    cover.drop_beyond(task);
                }
                return Err(stopped.into());
            }
        }
        if let Some(reason) = cover.why_empty(task) {
            return Ok(reason);
        }
        let mut components = match cover.judge_coarse(task, &refining, &mut coarse) {
            Ok(Next::Refine(components)) => components,
            Ok(Next::Front(halvings)) => {
                refining.halvings = halvings;
                continue;
            }
            Err(refusal) => {
                coarse.end();
                refining.refuse(refusal, &cover.attempt, !coarse.are_several)?;
                continue;
            }
        };
        match refine(task, cover, &refining, &mut components).await {
            Ok(()) if refining.is_corrected(&task.settings, cover.particles.count(), &components) => {}
            Ok(()) => {
                cover.counts.refined_levels = Some(components.most_halvings());
                cover.corners = components.into_corners();
                return Ok(StopReason::Complete);
            }
            Err(Halt::Refused(refusal)) => {
                coarse.end();
                refining.fail(refusal, &components, &cover.attempt, !coarse.are_several)?;
            }
            Err(stopped) => return Err(stopped),
        }
    }
}

/// More steps of a relaxation that has begun, on the particles of a finished run.
pub(super) fn relax_further<'t>(task: &'t mut Task, cover: &'t mut Cover) -> Work<'t, StopReason> {
    Box::pin(async move {
        let reason = async {
            relax(task, cover).await?;
            audit(task, cover).await?;
            Ok(cover.reason_for_end())
        };
        let reason = reason.await;
        ended(task, cover, reason)
    })
}

/// A frame of particles that follow a moving surface: with the mesh of a refined run, as long as
/// the mesh can follow.
pub(super) fn follow<'t>(task: &'t mut Task, cover: &'t mut Cover) -> Work<'t, StopReason> {
    Box::pin(async move { follow_surface(task, cover).await.unwrap_or(StopReason::Cancelled) })
}

/// Finds out which components hold particles, now that all are placed.
async fn audit(task: &mut Task<'_>, cover: &mut Cover) -> Result<(), Stopped> {
    (cover.phase, cover.fraction) = (Phase::Search, 1.0);
    if task.surface.creases.repeat_faces(&mut cover.particles, &mut cover.corners) {
        cover.moved = true;
        // They belong to the particles before.
        cover.neighbours.clear();
    }
    cover.components.restart_audit();
    task.until(cover, Cover::audit).await
}

/// Marks the particles next to singular points, even if the run was stopped. Returns the reason for
/// its end.
fn ended(task: &mut Task, cover: &mut Cover, reason: Result<StopReason, Stopped>) -> StopReason {
    let singular = cover.components.singular();
    if !singular.is_empty() {
        singular::mark(task.probe.field, singular, &mut cover.particles);
        cover.moved = true;
        cover.bare = task.surface.find_bare_place(&mut task.probe, singular);
    }
    reason.unwrap_or(StopReason::Cancelled)
}

impl Cover {
    /// If the fronts have placed no particle, the reason for it, with which the run ends.
    fn why_empty(&self, task: &Task) -> Option<StopReason> {
        self.particles.is_empty().then_some(match task.surface.survey.absence {
            Absence::Constant => StopReason::Constant,
            Absence::Undefined | Absence::TooLarge => StopReason::Undefined,
            _ => StopReason::NoSurface,
        })
    }

    /// Notes why the surface is not refined, and goes on to fronts of the wanted radius.
    fn refuse(&mut self, task: &Task, mut refusal: Refusal) {
        let at = refusal.at().map(|at| Vec3::from(at.0).as_dvec3());
        // Within two spacings of a tip the tip itself is the obstacle.
        let reach = 4.0 * self.attempt.radius;
        let tip =
            task.surface.tips.iter().find(|tip| at.is_some_and(|at| tip.position.distance(at) <= reach));
        let at = tip.map(|tip| tip.position.as_vec3().into());
        self.counts.refusal = Some(at.map_or(refusal, |at| Refusal::Tip { at }));
        self.attempt = self.attempt.without_refinement(&task.settings, task.surface.bounds.diagonal());
    }

    /// Why a run ends after it has covered the surface.
    fn reason_for_end(&self) -> StopReason {
        if self.front.level().capped { StopReason::Cap } else { StopReason::Complete }
    }

    fn audit(&mut self, task: &mut Task, left: &mut u32) -> Option<()> {
        let tolerance = self.attempt.tolerance(&task.surface.survey);
        let slice = (*left).min(SLICE);
        let (start, rule) = (task.probe.evaluations(), self.front.level().rule);
        let Self { components, particles, attempt, .. } = self;
        let unused = components.audit(&mut task.probe, particles, attempt.radius, tolerance, rule, slice);
        self.counts.seeding_evaluations += task.probe.evaluations() - start;
        if unused == 0 {
            *left = 0;
            return None;
        }
        *left -= slice - unused;
        Some(())
    }
}
