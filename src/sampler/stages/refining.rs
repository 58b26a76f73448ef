//! The stage that refines a coarse front.

use super::coarse::Refining;
use crate::particles::Particles;
use crate::sampler::constraint::tips::Tip;
use crate::sampler::cover::Cover;
use crate::sampler::discovery::singular::{self, Singular};
use crate::sampler::pace::{Stopped, Task};
use crate::sampler::phase::Phase;
use crate::sampler::probe::{BATCH, Probe};
use crate::sampler::progress::RefineProgress;
use crate::sampler::refine::{CoarseFronts, Components, Next, Refinement, Refusal, SurfaceFacts};
use glam::DVec3;

/// Why the work on a mesh ends early.
pub(in crate::sampler) enum Halt {
    Stopped,
    Refused(Refusal),
}

impl From<Stopped> for Halt {
    fn from(_: Stopped) -> Self {
        Self::Stopped
    }
}

impl From<Refusal> for Halt {
    fn from(refusal: Refusal) -> Self {
        Self::Refused(refusal)
    }
}

/// Refines the components of a coarse front: orders its few particles, and keeps that order while
/// each level multiplies their number by four. Each level is checked against f itself, since
/// patches are refined by their own functions.
pub(in crate::sampler) async fn refine(
    task: &mut Task<'_>,
    cover: &mut Cover,
    refining: &Refining,
    components: &mut Components,
) -> Result<(), Halt> {
    cover.front.release();
    // They belong to the front.
    cover.neighbours.clear();
    cover.drop_beyond(task);
    (cover.phase, cover.refined) = (Phase::Refinement, RefineProgress::default());
    let levels = components.most_halvings() + 1;
    for to_come in (0..levels).rev() {
        for (k, share) in components.at_level(to_come) {
            cover.refined.begin(levels, to_come, share);
            let mesh = components.refinement(k);
            if mesh.to_come() > to_come {
                divide(task, cover, refining, mesh).await?;
            }
            make_passes(task, cover, Some(refining), mesh).await?;
            let mut rings = mesh.begin_order();
            let ordered = task.until(cover, |_, _, left| mesh.put_in_order(&mut rings, left)).await?;
            components.end_level(k, ordered);
        }
        let mut inspected = None;
        task.until(cover, |cover, task, left| {
            if inspected.is_none() {
                let ladder = refining.ladder.as_ref();
                cover.take_level(task, components.particles(to_come, ladder), left);
            }
            cover.inspect_level(task, inspected.get_or_insert(0), left)
        })
        .await??;
    }
    Ok(())
}

/// Divides every face into four, and projects the particles of the finer mesh onto the surface.
async fn divide(
    task: &mut Task<'_>,
    cover: &mut Cover,
    refining: &Refining,
    mesh: &mut Refinement,
) -> Result<(), Halt> {
    let mut division = mesh.begin_division();
    let mut coarse = task.until(cover, |_, _, left| mesh.divide(&mut division, left)).await?;
    let land = |cover: &mut Cover, task: &mut Task, left: &mut u32| {
        cover.on_mesh(task, Some(refining), |probe, surface| mesh.land(probe, surface, &mut coarse, left))
    };
    Ok(task.until(cover, land).await??)
}

/// Makes the passes of a level, or of a frame of a mesh that follows a surface, by its recipe.
pub(in crate::sampler) async fn make_passes(
    task: &mut Task<'_>,
    cover: &mut Cover,
    refining: Option<&Refining>,
    mesh: &mut Refinement,
) -> Result<(), Halt> {
    while let Some(mut rest) = mesh.begin_pass() {
        task.until(cover, |cover, task, left| {
            cover.refined.at = mesh.share();
            cover.on_mesh(task, refining, |probe, surface| mesh.go_on(probe, surface, &mut rest, left))
        })
        .await??;
    }
    Ok(())
}

impl Cover {
    /// Judges the coarse front that has covered the surface.
    ///
    /// # Errors
    ///
    /// Why the front is not refined.
    pub(in crate::sampler) fn judge_coarse(
        &mut self,
        task: &mut Task,
        refining: &Refining,
        coarse: &mut CoarseFronts,
    ) -> Result<Next, Refusal> {
        if let Some(refusal) = self.unpinned(&task.surface.tips) {
            return Err(refusal);
        }
        if self.front.level().capped {
            return Err(Refusal::Full);
        }
        let before = task.probe.evaluations();
        let facts = refining.facts(&self.attempt, &task.surface.bounds);
        let target = refining.target(&self.attempt, &task.settings);
        let next = coarse.take_in(&mut task.probe, &facts, &mut self.particles, target);
        // The last front was one of several.
        self.moved |= coarse.are_several && matches!(next, Ok(Next::Refine(_)));
        self.counts.generation_evaluations += task.probe.evaluations() - before;
        next
    }

    /// Why the front is not refined, if there is a singular point without a particle: no tip, or
    /// one without room for it.
    fn unpinned(&self, tips: &[Tip]) -> Option<Refusal> {
        let particles = &self.particles;
        let is_near = |point: &Singular, p: DVec3| point.position.distance(p) <= singular::SAME * point.reach;
        let is_pinned = |point: &&Singular| {
            (0..particles.twins.len()).any(|row| is_near(point, particles.local[row].as_dvec3()))
        };
        let point = self.components.singular().iter().find(|point| !is_pinned(point))?;
        let at = point.position.as_vec3().into();
        let is_tip = tips.iter().any(|tip| is_near(point, tip.position));
        Some(if is_tip { Refusal::Doubtful { at } } else { Refusal::Singular { at } })
    }

    /// Works on a mesh that is refined or that follows a moving surface, and counts the
    /// evaluations. The work returns whether it is done.
    fn on_mesh(
        &mut self,
        task: &mut Task,
        refining: Option<&Refining>,
        work: impl FnOnce(&mut Probe, &SurfaceFacts) -> Result<bool, Refusal>,
    ) -> Option<Result<(), Refusal>> {
        let before = task.probe.evaluations();
        let (attempt, bounds) = (&self.attempt, &task.surface.bounds);
        let surface = refining.map_or_else(
            || SurfaceFacts { bounds: *bounds, sizing: attempt.sizing.as_ref(), ..SurfaceFacts::default() },
            |refining| refining.facts(attempt, bounds),
        );
        let done = work(&mut task.probe, &surface);
        let evaluations = match self.phase {
            Phase::Flow => &mut self.counts.relaxation_evaluations,
            _ => &mut self.counts.generation_evaluations,
        };
        *evaluations += task.probe.evaluations() - before;
        match done {
            Ok(is_done) => is_done.then_some(Ok(())),
            Err(refusal) => Some(Err(refusal)),
        }
    }

    /// Takes the particles of a level that all components have finished, so that a cancelled run
    /// has all of its particles.
    fn take_level(&mut self, task: &Task, particles: Particles, left: &mut u32) {
        *left = left.saturating_sub(particles.len() as u32);
        self.particles = particles;
        self.particles.origin = task.surface.frame.origin;
        self.moved = true;
    }

    /// Inspects the particles of a level from number `next` on: whether f vanishes at those off the
    /// creases, or whether one has been refined over an undetected edge of its patch.
    fn inspect_level(
        &self,
        task: &mut Task,
        next: &mut usize,
        left: &mut u32,
    ) -> Option<Result<(), Refusal>> {
        /// Largest distance of a particle from the surface, in radii. It is far above the tolerance
        /// of the projection; larger: narrower strips beyond an edge are missed.
        const OFF: f32 = 0.02;
        let particles = &self.particles;
        if particles.patch.is_empty() {
            return Some(Ok(()));
        }
        let blur = task.surface.survey.resolution;
        *next = (*next).max(particles.twins.len());
        while *next < particles.len() {
            if *left == 0 {
                return None;
            }
            let end = particles.len().min(*next + BATCH);
            let (value, gradient) = task.probe.gradients(&particles.local[*next..end]);
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
}
