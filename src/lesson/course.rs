//! The course of a run: which chapter comes next, and the units of work in it.
//!
//! Before each chapter a snapshot can be taken. A chapter is a generation level, the filling of
//! gaps, a relaxation step, or an iteration of a particle system.

use super::dynamics::{Dynamics, largest_move};
use super::event::Event;
use super::log::Log;
use super::settings::{LessonMethod, LessonPlacing, LessonSettings, QueueOrder};
use crate::paper::{ChildSlot, Circle, ImplicitSurface, Move, PaperRun, Particle};
use crate::sampler::GapPolicy;
use crate::sampler::sheet::UNCOVERED;
use glam::DVec3;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use serde::Serialize;
use std::collections::VecDeque;
use std::rc::Rc;

/// Distance, in radii, at which |f| distinguishes a zero from a pole. It is ten times the residual:
/// there |f| near a pole has shrunk to a tenth, and |f| near a zero has grown tenfold.
const POLE_PROBE: f64 = 1e-3;

/// Kind of a chapter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "LessonChapterKind"))]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum ChapterKind {
    /// The particles of a generation level place their children.
    Level {
        /// Number of the front.
        front: u32,
        /// Number of the level.
        level: u32,
    },
    /// The next particles of the stack place their children.
    Stack {
        /// Number of the front.
        front: u32,
        /// Number of the part, from 0.
        part: u32,
    },
    /// Gaps are filled.
    Filling,
    /// A relaxation step.
    Relaxation {
        /// Number of the step, from 1.
        step: u32,
    },
    /// An iteration of a particle system.
    Iteration {
        /// Number of the iteration, from 1.
        iteration: u32,
    },
}

/// The input of a run, which never changes.
pub(super) struct Setup {
    pub(super) settings: LessonSettings,
    /// Points of the surface where fronts may begin, in the order in which they are tried.
    pub(super) candidates: Vec<DVec3>,
    /// Diagonal of the box around the surface.
    pub(super) diameter: f64,
}

/// A child that has been predicted but not yet projected.
#[derive(Clone, Debug)]
pub(super) struct Predicted {
    pub(super) child: ChildSlot,
    pub(super) circle: Circle,
    /// The child as a particle at its predicted position.
    pub(super) placed: Particle,
}

/// The state of a run. A clone continues to the same end.
#[derive(Clone)]
pub(super) struct Course {
    pub(super) setup: Rc<Setup>,
    pub(super) run: PaperRun<Log>,
    /// Particles that are not done, in the order of their creation.
    pub(super) waiting: VecDeque<u32>,
    /// Number of completed relaxation steps or iterations.
    pub(super) steps: u32,
    /// Number of pushes of one particle by another that have been summed for moves.
    pub(super) interactions: u64,
    /// The next candidate for a seed.
    candidate: usize,
    /// Number of fronts so far.
    pub(super) fronts: u32,
    /// Chapters of the current front so far.
    part: u32,
    /// Whether the gaps have been filled.
    is_filled: bool,
    /// Consecutive quiet iterations.
    pub(super) quiet: u32,
    /// Random numbers that decide deaths and the directions of fissions.
    pub(super) random: Pcg32,
    /// The current chapter.
    kind: Option<ChapterKind>,
    /// Units left in the current chapter.
    pub(super) left: u32,
    /// Children of the level that are predicted but not projected; the next one comes first.
    pub(super) predicted: VecDeque<Predicted>,
    /// The force on each particle and its results, in the current relaxation step or iteration.
    pub(super) dynamics: Vec<Dynamics>,
}

impl Course {
    /// A run before its first chapter.
    pub(super) fn new(setup: Setup, mut surface: ImplicitSurface) -> Self {
        surface.evaluations = 0;
        let settings = &setup.settings;
        let mut random = Pcg32::seed_from_u64(u64::from(settings.seed));
        // The first number was used to choose the seed.
        random.next_u64();
        let run = PaperRun::new(surface, settings.rules(), Log::new(settings));
        Self {
            setup: Rc::new(setup),
            run,
            waiting: VecDeque::new(),
            steps: 0,
            interactions: 0,
            candidate: 0,
            fronts: 0,
            part: 0,
            is_filled: false,
            quiet: 0,
            random,
            kind: None,
            left: 0,
            predicted: VecDeque::new(),
            dynamics: Vec::new(),
        }
    }

    /// Whether a chapter is under way.
    pub(super) fn is_in_chapter(&self) -> bool {
        self.kind.is_some()
    }

    /// Does a whole chapter.
    pub(super) fn do_chapter(&mut self) {
        if self.begin_chapter().is_some() {
            while !self.work() {}
        }
    }

    /// Begins the next chapter; `None` at the end of the run.
    pub(super) fn begin_chapter(&mut self) -> Option<ChapterKind> {
        self.kind = match self.setup.settings.method {
            LessonMethod::Front => self.begin_part_of_front(),
            LessonMethod::WitkinHeckbert | LessonMethod::Forces => self.begin_iteration(),
        };
        self.kind
    }

    fn begin_part_of_front(&mut self) -> Option<ChapterKind> {
        if self.waiting.is_empty() && !self.run.seen.is_capped {
            self.add_seeds();
        }
        if !self.waiting.is_empty() {
            Some(self.begin_level())
        } else if self.setup.settings.gaps == GapPolicy::Fill
            && !self.is_filled
            && !self.run.seen.seams.is_empty()
            && !self.run.seen.is_capped
        {
            self.left = self.run.seen.seams.len() as u32;
            Some(ChapterKind::Filling)
        } else if self.steps < self.setup.settings.relax_steps && self.run.particles.len() > 1 {
            self.left = self.run.particles.len() as u32;
            let (energy, pushes) = self.repulsion();
            self.interactions += pushes;
            let dynamics = |i| Dynamics { force: self.run.force(i), ..Dynamics::default() };
            self.dynamics = (0..self.left).map(dynamics).collect();
            let (step, size) = (self.steps + 1, self.run.rules.step_size);
            self.run.seen.push(Event::StepBegins { step, size, energy });
            Some(ChapterKind::Relaxation { step })
        } else {
            None
        }
    }

    fn begin_level(&mut self) -> ChapterKind {
        let level = self.run.particles[self.waiting[0] as usize].level;
        let waiting = self.waiting.len() as u32;
        let part = self.part;
        self.part += 1;
        let front = self.fronts - 1;
        self.left = waiting;
        match self.setup.settings.order {
            QueueOrder::Queue => {
                self.run.seen.push(Event::LevelBegins { level, waiting });
                ChapterKind::Level { front, level }
            }
            // A stack has no rings: a chapter treats as many particles as waited at its start.
            QueueOrder::Stack => ChapterKind::Stack { front, part },
        }
    }

    /// Does one unit of work of the chapter. Returns whether it was the last.
    pub(super) fn work(&mut self) -> bool {
        match self.kind {
            None => {}
            Some(ChapterKind::Level { .. } | ChapterKind::Stack { .. }) => self.place(),
            Some(ChapterKind::Filling) => {
                let seams = &self.run.seen.seams;
                let beside = seams[seams.len() - self.left as usize];
                self.fill_beside(beside);
                self.left -= 1;
                self.is_filled = self.left == 0;
            }
            Some(ChapterKind::Relaxation { .. }) => {
                self.relax_next();
            }
            Some(ChapterKind::Iteration { .. }) => self.iterate(),
        }
        let is_over = self.left == 0 && self.predicted.is_empty();
        if is_over {
            self.kind = None;
        }
        is_over
    }

    /// Does one unit of a relaxation step.
    fn relax_next(&mut self) {
        let i = self.run.particles.len() - self.left as usize;
        let own = self.run.particles[i];
        let force = self.dynamics[i].force;
        let moved = self.run.move_particle(i, force * self.run.rules.step_size);
        self.dynamics[i].moved = self.run.particles[i].p().distance(own.p()) / own.radius;
        self.tell_move(i, force, &moved);
        self.left -= 1;
        if self.left == 0 {
            self.steps += 1;
            let (energy, _) = self.repulsion();
            let (step, largest_move) = (self.steps, largest_move(&self.dynamics));
            self.run.seen.push(Event::StepEnds { step, energy, largest_move });
        }
    }

    /// Energy per particle now, and the number of pushes of one particle by another.
    fn repulsion(&mut self) -> (f64, u64) {
        self.run.regroup();
        let (mut energy, mut count) = (0.0, 0);
        for push in (0..self.run.particles.len() as u32).flat_map(|i| self.run.pushes(i)) {
            // Each pair is visited twice.
            energy += 0.5 * push.energy;
            count += 1;
        }
        (energy / self.run.particles.len() as f64, count)
    }

    /// Records how a force has moved a particle to its current position.
    pub(super) fn tell_move(&mut self, i: usize, force: DVec3, moved: &Move) {
        let Particle { position, normal, radius, .. } = self.run.particles[i];
        let (particle, is_kept) = (i as u32, moved.is_kept);
        let (force, target) = (force.to_array(), moved.target.to_array());
        self.run.seen.push(Event::Moved { particle, force, target, position, normal, radius, is_kept });
    }

    /// Marks a particle as done.
    pub(super) fn finish(&mut self, particle: u32) {
        self.run.particles[particle as usize].is_done = true;
        self.run.seen.push(Event::Done { particle, evaluations: self.run.surface.evaluations });
    }

    /// Does one unit of a generation level.
    fn place(&mut self) {
        let LessonSettings { placing, order, .. } = self.setup.settings;
        let before = self.run.particles.len() as u32;
        let next = |waiting: &mut VecDeque<u32>| match order {
            QueueOrder::Queue => waiting.pop_front(),
            QueueOrder::Stack => waiting.pop_back(),
        };
        if placing == LessonPlacing::LevelByLevel && self.left == 0 {
            self.settle_next();
        } else if let Some(particle) = next(&mut self.waiting) {
            self.run.seen.push(Event::Taken { particle });
            match placing {
                LessonPlacing::OneByOne => self.run.treat(particle),
                LessonPlacing::LevelByLevel => self.predict(particle),
            }
            self.finish(particle);
        }
        self.waiting.extend(before..self.run.particles.len() as u32);
        self.left = self.left.saturating_sub(1);
        if self.run.seen.is_capped {
            self.waiting.clear();
            self.predicted.clear();
            self.left = 0;
        }
    }

    /// Puts the next seed that no particle covers into the queue.
    pub(super) fn add_seeds(&mut self) {
        let setup = Rc::clone(&self.setup);
        while let Some(&candidate) = setup.candidates.get(self.candidate) {
            self.candidate += 1;
            if self.run.particles.len() >= setup.settings.max_particles as usize {
                self.run.seen.is_capped = true;
                return;
            }
            let seed = self.run.seed_at(candidate, self.fronts);
            if let Some(seed) = seed.filter(|seed| !self.is_covered(seed) && self.is_zero(seed)) {
                let particle = self.run.enter(seed);
                self.waiting.push_back(particle);
                self.run.seen.push(Event::Seed { particle, data: seed });
                self.fronts += 1;
                self.part = 0;
                return;
            }
        }
    }

    /// Whether a particle of the same sheet is so near a seed that its front has been there.
    fn is_covered(&self, seed: &Particle) -> bool {
        let near = self.run.buckets.near(&self.run.particles, seed.p(), f64::from(UNCOVERED) * seed.radius);
        near.iter().any(|near| self.run.particles[near.particle as usize].n().dot(seed.n()) > 0.0)
    }

    /// Whether f has a zero at a seed rather than a pole: |f| grows away from a zero.
    fn is_zero(&mut self, seed: &Particle) -> bool {
        let step = POLE_PROBE * seed.radius;
        let [here, above, below] =
            [0.0, step, -step].map(|step| self.run.surface.jet(seed.p() + seed.n() * step).value.abs());
        above > here || below > here
    }
}
