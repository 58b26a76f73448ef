//! The stage that moves a cover with its surface, by a frame.

use super::refining::{Halt, make_passes};
use super::relaxing::{sum_forces, sweep};
use crate::sampler::cover::Cover;
use crate::sampler::flow::{BALANCE_EVERY, FlowSurface, Settled};
use crate::sampler::pace::{Stopped, Task};
use crate::sampler::phase::StopReason;
use crate::sampler::refine::{MovingMesh, Turn};
use crate::sampler::relaxation::{Grading, MoveLimits, Sweep};
use crate::sampler::settings::{Method, SizeMode};

/// Moves the particles onto the surface, with the mesh between them if there is one that can
/// follow.
pub(in crate::sampler) async fn follow_surface(
    task: &mut Task<'_>,
    cover: &mut Cover,
) -> Result<StopReason, Stopped> {
    task.check()?;
    if let Some(mut mesh) = cover.begin_mesh(task) {
        match make_passes(task, cover, None, &mut mesh.refinement).await {
            Ok(()) => {
                cover.take_mesh(task, mesh);
                return Ok(StopReason::Complete);
            }
            Err(Halt::Refused(_)) => cover.flow.hurry(),
            Err(Halt::Stopped) => return Err(Stopped),
        }
    }
    loop {
        cover.begin_transport(task);
        sweep(task, cover, Sweep::Transport).await?;
        for _ in 0..cover.settle(task) {
            cover.relaxation.distrust_grid();
            sum_forces(task, cover, Grading::Always).await?;
            sweep(task, cover, Sweep::Move).await?;
        }
        if cover.particles.is_empty() {
            return Ok(StopReason::NoSurface);
        }
        cover.flow.is_whole = true;
        if !cover.flow.is_late() {
            break;
        }
    }
    if cover.flow.is_last() && cover.flow.is_seeded {
        cover.join_again(task);
    }
    Ok(StopReason::Complete)
}

impl Cover {
    /// Begins a frame with the mesh of a refined run, if there is one that can follow.
    fn begin_mesh(&self, task: &Task) -> Option<MovingMesh> {
        if self.corners.is_empty() || self.flow.is_closed {
            return None;
        }
        let (target, spacing) = (self.attempt.target(&task.settings, 0), self.attempt.spacing());
        let turn = Turn { at: self.flow.turn(), of: BALANCE_EVERY };
        MovingMesh::new(&self.particles, &self.corners, &task.surface.bounds, target, spacing, turn)
    }

    /// Takes the particles from a mesh that has followed the surface.
    fn take_mesh(&mut self, task: &Task, mesh: MovingMesh) {
        if task.settings.size_mode == SizeMode::Count && self.attempt.sizing.is_none() {
            self.attempt.radius *= mesh.growth();
        }
        mesh.hand_on(self.attempt.radius as f32, &mut self.particles, &mut self.corners);
        self.moved = true;
        if !self.flow.end_with_mesh(&mut self.particles, &task.surface.survey) {
            self.corners = Vec::new();
        }
    }

    /// Begins to move the particles without a mesh.
    fn begin_transport(&mut self, task: &Task) {
        self.corners = Vec::new();
        let are_listed = self.flow.begin_frame();
        let limits = MoveLimits { bounds: task.surface.bounds, largest_lift: f32::INFINITY };
        let law = self.law(task.surface, &task.settings);
        let Self { relaxation, particles, neighbours, .. } = self;
        relaxation.begin_transport(law, limits, particles, neighbours, are_listed);
    }

    /// Lets particles be born and die after their transport to the surface. Returns the number of
    /// relaxation steps to make.
    fn settle(&mut self, task: &mut Task) -> u32 {
        let Self { relaxation, flow, neighbours, front, particles, attempt, .. } = self;
        let surface = FlowSurface {
            bounds: task.surface.bounds,
            survey: &task.surface.survey,
            rule: front.level().rule,
            sizing: attempt.sizing.as_ref(),
            radius: attempt.radius as f32,
            count: (task.settings.size_mode == SizeMode::Count).then_some(task.settings.count),
            max_particles: task.settings.max_particles as usize,
        };
        let Settled { rows, steps } =
            flow.settle(&mut task.probe, &surface, relaxation.lost(), neighbours, particles);
        if particles.is_empty() {
            return 0;
        }
        if let Some(rows) = rows.filter(|_| steps > 0) {
            relaxation.keep(&rows, particles, neighbours);
        }
        steps
    }

    /// Joins the particles of a refined run to a mesh again, which they lost when the surface tore
    /// or joined.
    fn join_again(&mut self, task: &mut Task) {
        let is_refined = task.settings.method == Method::Refined && self.counts.refusal.is_none();
        if !is_refined {
            return;
        }
        let target = self.attempt.target(&task.settings, 0);
        let Self { particles, corners, .. } = self;
        if let Ok(mesh) = MovingMesh::join(&mut task.probe, particles, &task.surface.bounds, target) {
            mesh.hand_on(self.attempt.radius as f32, particles, corners);
            self.flow.number(particles);
            self.flow.is_whole = false;
        }
    }
}
