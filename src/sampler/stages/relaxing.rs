//! The stage that relaxes a cover (paper §4.5 and the end of §5).

use crate::sampler::cover::Cover;
use crate::sampler::pace::{SLICE, Stopped, Task};
use crate::sampler::relaxation::{Grading, Sweep, Swept};

/// Makes the steps of a relaxation that [has begun](Cover::begin_relaxation). If the run is
/// stopped, a step that is only half made is undone.
pub(in crate::sampler) async fn relax(task: &mut Task<'_>, cover: &mut Cover) -> Result<(), Stopped> {
    let result = make_steps(task, cover).await;
    if result.is_err() {
        cover.moved |= cover.relaxation.abandon(&mut cover.particles);
    }
    result
}

/// A step is kept only if it lowers the energy. At the end all particles are projected onto the
/// surface as closely as single precision allows, and radii that vary are graded once more.
async fn make_steps(task: &mut Task<'_>, cover: &mut Cover) -> Result<(), Stopped> {
    if !cover.relaxation.is_only_graded() {
        sum_forces(task, cover, Grading::WhereUneven).await?;
        cover.relaxation.record_first();
        while !cover.relaxation.is_even() {
            sweep(task, cover, Sweep::Move).await?;
            sum_forces(task, cover, Grading::WhereUneven).await?;
            if cover.relaxation.judge() {
                task.turn(cover).await?;
            } else {
                sweep(task, cover, Sweep::TakeBack).await?;
                sum_forces(task, cover, Grading::WhereUneven).await?;
            }
        }
        sweep(task, cover, Sweep::Polish).await?;
        if !cover.relaxation.distrust_lists() {
            return Ok(());
        }
    }
    list_neighbours(task, cover, Grading::Always).await
}

/// The forces on all particles and their energy, from complete lists of neighbours.
pub(in crate::sampler) async fn sum_forces(
    task: &mut Task<'_>,
    cover: &mut Cover,
    grading: Grading,
) -> Result<(), Stopped> {
    list_neighbours(task, cover, grading).await?;
    sweep(task, cover, Sweep::SumForces).await
}

/// Lists the neighbours of particles whose lists are stale, and lowers radii that are too large
/// compared with a neighbour's.
async fn list_neighbours(task: &mut Task<'_>, cover: &mut Cover, grading: Grading) -> Result<(), Stopped> {
    let (wants_lists, wants_grid) = cover.relaxation.wants_lists();
    if wants_grid {
        sweep(task, cover, Sweep::FillGrid).await?;
    }
    if wants_lists {
        sweep(task, cover, Sweep::RenewLists).await?;
    }
    if cover.relaxation.wants_grading(grading) {
        sweep(task, cover, Sweep::Grade).await?;
        while cover.relaxation.has_lowered() {
            sweep(task, cover, Sweep::Grade).await?;
        }
    }
    Ok(())
}

/// A sweep over all particles.
pub(in crate::sampler) async fn sweep(
    task: &mut Task<'_>,
    cover: &mut Cover,
    sweep: Sweep,
) -> Result<(), Stopped> {
    task.until(cover, |cover, task, left| {
        *left = (*left).min(SLICE);
        let start = task.probe.evaluations();
        let Cover { relaxation, attempt, neighbours, particles, .. } = cover;
        let Swept { has_moved, is_done } =
            relaxation.go_on(sweep, &mut task.probe, attempt.sizing.as_ref(), neighbours, particles, left);
        cover.moved |= has_moved;
        cover.counts.relaxation_evaluations += task.probe.evaluations() - start;
        is_done.then_some(())
    })
    .await
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Field;
    use crate::field::formula::Formula;
    use crate::math::Bounds;
    use crate::particles::{Particles, Slots};
    use crate::sampler::pace::MethodUnderWay;
    use crate::sampler::phase::StopReason;
    use crate::sampler::settings::Settings;
    use crate::sampler::surface::Surface;
    use glam::Vec3;
    use std::sync::Arc;

    /// The unit sphere, as a survey would find it, and particles on it along a spiral, whose
    /// neighbours are at any angle.
    fn spiral(count: u32) -> (Surface, Cover) {
        let mut surface = Surface { bounds: Bounds::cube(1.5), ..Surface::default() };
        surface.survey.gradient_scale = 2.0;
        surface.survey.crowding = f32::INFINITY;
        let mut cover = Cover::default();
        cover.attempt.radius = 1.9 / f64::from(count).sqrt();
        let radius = cover.attempt.radius as f32;
        for k in 0..count {
            let z = 1.0 - (2 * k + 1) as f32 / count as f32;
            let (sine, cosine) = libm::sincosf(2.399_963 * k as f32);
            let p = Vec3::new(cosine * (1.0 - z * z).sqrt(), sine * (1.0 - z * z).sqrt(), z);
            cover.particles.push(p, p, radius, Particles::NO_PARENT, 0, Slots::default());
        }
        (surface, cover)
    }

    /// Relaxes the spiral in steps of a budget, until so many of them are done.
    fn relaxed(budget: u32, most: usize) -> (Cover, Option<StopReason>) {
        let (surface, mut cover) = spiral(500);
        let settings = Settings { relax_steps: 5, ..Settings::DEFAULT };
        let field: Arc<dyn Field> =
            Arc::new(Formula::as_written("x^2 + y^2 + z^2 = 1", &[]).expect("a formula"));
        cover.begin_relaxation(&surface, &settings);
        let mut method = MethodUnderWay::begin(
            |task, cover| {
                Box::pin(async {
                    relax(task, cover).await.map_or(StopReason::Cancelled, |()| StopReason::Complete)
                })
            },
            field,
            Arc::new(surface),
            settings,
        );
        let mut reason = None;
        for _ in 0..most {
            reason = method.step(&mut cover, budget);
            if reason.is_some() {
                return (cover, reason);
            }
        }
        method.stop();
        let stopped = method.step(&mut cover, 0);
        (cover, reason.or(stopped))
    }

    #[test]
    fn a_cover_made_by_hand_is_relaxed_alone() {
        let (cover, reason) = relaxed(u32::MAX, usize::MAX);
        assert_eq!(reason, Some(StopReason::Complete));
        let energy = cover.relaxation.energy();
        assert_eq!(energy.len(), 6);
        assert!(energy.windows(2).all(|pair| pair[1] < pair[0]), "{energy:?}");
        assert!(cover.particles.local.iter().all(|p| (p.length() - 1.0).abs() < 1e-4));
        let (sliced, _) = relaxed(7, usize::MAX);
        assert_eq!(sliced.particles.digest(), cover.particles.digest());
    }

    #[test]
    fn a_stage_that_is_stopped_leaves_no_step_half_made() {
        let (before, _) = relaxed(1, 0);
        // Amid the first lists, and amid the first move.
        for most in [700, 1_700] {
            let (cover, reason) = relaxed(1, most);
            assert_eq!(reason, Some(StopReason::Cancelled), "{most}");
            let moved = |cover: &Cover| cover.particles.local != before.particles.local;
            assert!(!moved(&cover) && cover.relaxation.steps_done() == 0, "{most}");
        }
    }
}
