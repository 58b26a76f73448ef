//! The stages that follow a front where its hexagons are not what is wanted: a pattern is drawn
//! over it, or its particles are brought to an exact number.

use crate::particles::Particles;
use crate::sampler::cover::Cover;
use crate::sampler::pace::{Stopped, Task};
use crate::sampler::pattern::{Drawing, Ground};
use crate::sampler::phase::Phase;
use crate::sampler::probe::Probe;
use crate::sampler::settings::{Counting, Method, Pattern, Settings, SizeMode};
use crate::sampler::sheet::SheetRule;
use crate::sampler::surface::Surface;
use core::mem::take;

/// Draws random points or blue noise over the front that covers the surface. If the run is stopped,
/// the particles drawn so far stay.
pub(in crate::sampler) async fn draw_pattern(task: &mut Task<'_>, cover: &mut Cover) -> Result<(), Stopped> {
    let start = task.probe.evaluations();
    let mut drawing = cover.begin_drawing(task);
    let drawn = draw(task, cover, &mut drawing).await;
    if drawn.is_ok() {
        cover.end_drawing(&drawing);
    }
    let evaluations = task.probe.evaluations() - start;
    cover.counts.generation_evaluations += evaluations;
    cover.counts.front_evaluations += evaluations;
    cover.drawn = None;
    drawn
}

/// Throws darts onto the surface, which are kept if they do not collide, until it is covered; then
/// the rest of a wanted count goes into the largest holes. Random points may collide.
async fn draw(task: &mut Task<'_>, cover: &mut Cover, drawing: &mut Drawing) -> Result<(), Stopped> {
    step(task, cover, drawing, Drawing::list_pieces).await?;
    step(task, cover, drawing, Drawing::measure_surface).await?;
    if drawing.is_random() {
        return step(task, cover, drawing, Drawing::draw_points).await;
    }
    let Surface { creases, tips, .. } = task.surface;
    loop {
        step(task, cover, drawing, |drawing, ground, probe, particles, _| {
            drawing.begin_trial(ground, probe, particles, (creases, tips));
            Some(())
        })
        .await?;
        cover.moved = true;
        step(task, cover, drawing, Drawing::throw_darts).await?;
        step(task, cover, drawing, Drawing::cover_squares).await?;
        step(task, cover, drawing, Drawing::fill_largest).await?;
        if drawing.is_accepted() {
            return Ok(());
        }
    }
}

/// Brings a front to exactly the wanted number, if that is asked for: removes particles where they
/// are most crowded, or adds some in the largest holes. Returns whether it had another number.
pub(in crate::sampler) async fn correct_count(
    task: &mut Task<'_>,
    cover: &mut Cover,
) -> Result<bool, Stopped> {
    if !cover.misses_count(&task.settings) {
        return Ok(false);
    }
    let mut drawing = cover.begin_correction(task);
    let corrected = correct(task, cover, &mut drawing).await;
    (cover.drawn, cover.moved) = (None, true);
    corrected.map(|()| true)
}

async fn correct(task: &mut Task<'_>, cover: &mut Cover, drawing: &mut Drawing) -> Result<(), Stopped> {
    if drawing.has_too_many() {
        while !step(task, cover, drawing, Drawing::remove_crowded).await? {
            cover.moved = true;
        }
        return Ok(());
    }
    step(task, cover, drawing, Drawing::list_holes).await?;
    step(task, cover, drawing, Drawing::fill_largest).await
}

/// Makes a step of a drawing.
async fn step<R>(
    task: &mut Task<'_>,
    cover: &mut Cover,
    drawing: &mut Drawing,
    mut slice: impl FnMut(&mut Drawing, &Ground, &mut Probe, &mut Particles, &mut u32) -> Option<R>,
) -> Result<R, Stopped> {
    task.until(cover, |cover, task, left| {
        let Surface { survey, bounds, .. } = task.surface;
        let Cover { attempt, plan, particles, drawn, .. } = cover;
        let ground = Ground::of(attempt, plan, survey, bounds, drawing.scale());
        let result = slice(drawing, &ground, &mut task.probe, particles, left);
        *drawn = Some(drawing.share());
        result
    })
    .await
}

impl Cover {
    /// Takes the front away that covers the surface, and begins to draw a pattern over it.
    fn begin_drawing(&mut self, task: &Task) -> Drawing {
        self.phase = Phase::Generation;
        let front = take(&mut self.particles);
        self.particles.origin = front.origin;
        let rule = self.leave_front();
        let drawing = Drawing::begun(front, &self.plan, rule, &task.settings, self.attempt.packing());
        self.drawn = Some(drawing.share());
        drawing
    }

    /// Takes the radii at which a pattern has come out.
    fn end_drawing(&mut self, drawing: &Drawing) {
        if drawing.is_cut_short() {
            self.front.cap();
        }
        let shrink = drawing.shrink();
        self.particles.radius.iter_mut().for_each(|radius| *radius *= shrink);
        self.particles.shrink();
        self.attempt.resize(f64::from(drawing.scale()) * f64::from(shrink));
        self.moved = true;
    }

    /// Whether a front must be brought to the wanted number.
    fn misses_count(&self, settings: &Settings) -> bool {
        settings.counting == Counting::Exactly
            && settings.size_mode == SizeMode::Count
            && settings.pattern_in_use() == Pattern::Hexagonal
            && settings.method == Method::Front
            && !self.front.level().capped
            && self.particles.count() != settings.count as usize
    }

    fn begin_correction(&mut self, task: &Task) -> Drawing {
        let rule = self.leave_front();
        let drawing = Drawing::correction(&self.particles, &self.plan, rule, task.settings.count as usize);
        self.drawn = Some(drawing.share());
        drawing
    }

    /// Frees the memory of a front that is done, and of what belongs to its particles. Returns the
    /// rule that tells its sheets apart.
    fn leave_front(&mut self) -> SheetRule {
        let rule = self.front.level().rule;
        self.front.release();
        self.neighbours.clear();
        self.moved = true;
        rule
    }
}
