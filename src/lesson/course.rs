//! The course of a run: which chapter comes next, and the units of work in it.
//!
//! A chapter is what a snapshot is taken before: a generation level, the filling of gaps, a relaxation step, or an iteration of a
//! particle system.

use super::dynamics::Dynamics;
use super::event::{Event, Log};
use super::settings::{LessonMethod, LessonSettings, Placing, Seeding};
use crate::field::Field;
use crate::paper::{ChildSlot, Circle, ImplicitSurface, PaperRun, Particle, QueueOrder};
use crate::sampler::GapPolicy;
use glam::DVec3;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use serde::Serialize;
use std::collections::VecDeque;
use std::rc::Rc;

/// With a stack there are no rings: a chapter is this many particles.
const STACK_CHAPTER: u32 = 100;

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

/// Input of a run, which never changes.
pub(super) struct Setup {
    pub(super) settings: LessonSettings,
    /// Points of the surface at which fronts may begin, in the order in which they are tried.
    pub(super) candidates: Vec<DVec3>,
    /// Diagonal of the box around the surface.
    pub(super) diameter: f64,
}

/// Position of a run among its chapters, and the state that its next steps depend on, without the particles.
#[derive(Clone, Debug)]
pub(super) struct Cursor {
    /// The next candidate for a seed.
    candidate: usize,
    /// Number of fronts so far.
    pub(super) fronts: u32,
    /// Chapters of the present front so far.
    part: u32,
    /// Particles with a child on a seam, in the order in which they were treated.
    seams: Vec<u32>,
    /// Whether the gaps have been filled.
    is_filled: bool,
    /// Consecutive iterations of rest.
    pub(super) quiet: u32,
    /// Generator that decides deaths and the directions of fissions.
    pub(super) random: Pcg32,
}

impl Cursor {
    /// The beginning of a run.
    fn new(seed: u32) -> Self {
        let mut random = Pcg32::seed_from_u64(u64::from(seed));
        // The first number has chosen the seed.
        random.next_u64();
        Self { candidate: 0, fronts: 0, part: 0, seams: Vec::new(), is_filled: false, quiet: 0, random }
    }
}

/// State of a run between two chapters without the particles, which a snapshot holds beside it.
#[derive(Clone, Debug)]
pub(super) struct Moment {
    pub(super) cursor: Cursor,
    /// The particles that are not done, the next one first.
    pub(super) waiting: VecDeque<u32>,
    is_capped: bool,
    steps: u32,
    evaluations: u64,
}

impl Moment {
    /// The beginning of a run.
    pub(super) fn first(settings: &LessonSettings) -> Self {
        let cursor = Cursor::new(settings.seed);
        Self { cursor, waiting: VecDeque::new(), is_capped: false, steps: 0, evaluations: 0 }
    }
}

/// A child that is predicted and not projected yet.
#[derive(Clone, Debug)]
pub(super) struct Predicted {
    pub(super) child: ChildSlot,
    pub(super) circle: Circle,
    pub(super) theta_rad: f64,
    pub(super) place: DVec3,
    pub(super) normal: DVec3,
}

/// A run on its way through the chapters.
pub(super) struct Course {
    pub(super) setup: Rc<Setup>,
    pub(super) run: PaperRun<Log>,
    pub(super) cursor: Cursor,
    /// The chapter under way.
    kind: Option<ChapterKind>,
    /// Units left in the chapter under way.
    pub(super) left: u32,
    /// Children of the level that are predicted and not projected, the next one first.
    pub(super) predicted: VecDeque<Predicted>,
    /// Force and energy of each particle in an iteration of a particle system.
    pub(super) dynamics: Vec<Dynamics>,
    /// Particles that die at the end of the iteration, by index.
    pub(super) dying: Vec<u32>,
}

impl Course {
    /// A run with these particles at this moment.
    pub(super) fn at(
        setup: &Rc<Setup>,
        mut surface: ImplicitSurface,
        moment: Moment,
        particles: Vec<Particle>,
    ) -> Self {
        let Moment { cursor, waiting, is_capped, steps, evaluations } = moment;
        surface.evaluations = evaluations;
        let log = Log::new(&setup.settings);
        let mut run = PaperRun::with_particles(surface, setup.settings.rules(), particles, log);
        (run.waiting, run.is_capped, run.steps) = (waiting, is_capped, steps);
        Self {
            setup: Rc::clone(setup),
            run,
            cursor,
            kind: None,
            left: 0,
            predicted: VecDeque::new(),
            dynamics: Vec::new(),
            dying: Vec::new(),
        }
    }

    /// Returns the run at another moment.
    pub(super) fn elsewhere(&self, moment: Moment, particles: Vec<Particle>) -> Self {
        Self::at(&self.setup, self.run.surface.clone(), moment, particles)
    }

    /// Returns the run on another surface in the same box. Its particles go there by Newton's method; one that does not arrive within its
    /// radius, or comes to another side of the surface, is gone.
    pub(super) fn moved(&self, field: Box<dyn Field>) -> Self {
        let surface = ImplicitSurface::new(field, &self.run.surface.bounds);
        let mut moment = self.moment();
        (moment.cursor.quiet, moment.steps) = (0, 0);
        let mut moved = Self::at(&self.setup, surface, moment, Vec::new());
        for own in &self.run.particles {
            if let Some((position, normal)) = moved.run.come_back(own, own.p(), own.radius) {
                let (position, normal) = (position.to_array(), normal.to_array());
                moved.run.particles.push(Particle { position, normal, height: 0.0, ..*own });
            }
        }
        moved
    }

    /// The moment between two chapters.
    pub(super) fn moment(&self) -> Moment {
        Moment {
            cursor: self.cursor.clone(),
            waiting: self.run.waiting.clone(),
            is_capped: self.run.is_capped,
            steps: self.run.steps,
            evaluations: self.run.surface.evaluations,
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
        if self.run.waiting.is_empty() && !self.run.is_capped {
            self.add_seeds();
        }
        if !self.run.waiting.is_empty() {
            Some(self.begin_level())
        } else if self.setup.settings.gaps == GapPolicy::Fill
            && !self.cursor.is_filled
            && !self.cursor.seams.is_empty()
            && !self.run.is_capped
        {
            self.left = self.cursor.seams.len() as u32;
            Some(ChapterKind::Filling)
        } else if self.run.steps < self.setup.settings.relax_steps && self.run.particles.len() > 1 {
            self.left = self.run.particles.len() as u32;
            self.run.begin_step();
            Some(ChapterKind::Relaxation { step: self.run.steps + 1 })
        } else {
            None
        }
    }

    fn begin_level(&mut self) -> ChapterKind {
        let level = self.run.particles[self.run.waiting[0] as usize].level;
        let waiting = self.run.waiting.len() as u32;
        let part = self.cursor.part;
        self.cursor.part += 1;
        let front = self.cursor.fronts - 1;
        match self.setup.settings.order {
            QueueOrder::Queue => {
                self.left = waiting;
                self.run.seen.push(Event::LevelBegins { level, waiting });
                ChapterKind::Level { front, level }
            }
            QueueOrder::Stack => {
                self.left = STACK_CHAPTER;
                ChapterKind::Stack { front, part }
            }
        }
    }

    /// Does one unit of work of the chapter, and says whether that was its last.
    pub(super) fn work(&mut self) -> bool {
        match self.kind {
            None => {}
            Some(ChapterKind::Level { .. } | ChapterKind::Stack { .. }) => self.place(),
            Some(ChapterKind::Filling) => {
                let beside = self.cursor.seams[self.cursor.seams.len() - self.left as usize];
                self.fill_beside(beside);
                self.left -= 1;
                self.cursor.is_filled = self.left == 0;
            }
            Some(ChapterKind::Relaxation { .. }) => {
                self.run.move_particle(self.run.particles.len() - self.left as usize);
                self.left -= 1;
                if self.left == 0 {
                    self.run.end_step();
                }
            }
            Some(ChapterKind::Iteration { .. }) => self.iterate(),
        }
        let is_over = self.left == 0 && self.predicted.is_empty();
        if is_over {
            self.kind = None;
        }
        is_over
    }

    /// Does one unit of a generation level.
    fn place(&mut self) {
        match self.setup.settings.placing {
            Placing::OneByOne => self.run.treat_next(),
            Placing::LevelByLevel if self.left > 0 => self.predict_next(),
            Placing::LevelByLevel => self.settle_next(),
        }
        for parent in self.run.seen.seams.drain(..) {
            if self.cursor.seams.last() != Some(&parent) {
                self.cursor.seams.push(parent);
            }
        }
        self.left = self.left.saturating_sub(1);
        if self.run.is_capped {
            self.run.waiting.clear();
            self.predicted.clear();
        }
        // A stack may be empty before the end of its chapter.
        if self.run.waiting.is_empty() {
            self.left = 0;
        }
    }

    /// Puts the next seed that no particle covers into the queue, or all of them.
    pub(super) fn add_seeds(&mut self) {
        let setup = Rc::clone(&self.setup);
        let first = self.cursor.fronts;
        while let Some(&candidate) = setup.candidates.get(self.cursor.candidate) {
            self.cursor.candidate += 1;
            if self.run.particles.len() >= setup.settings.max_particles as usize {
                self.run.is_capped = true;
                return;
            }
            if self.run.begin_at(candidate, self.cursor.fronts) {
                self.cursor.fronts += 1;
                if setup.settings.seeding == Seeding::OneByOne {
                    break;
                }
            }
        }
        if self.cursor.fronts > first {
            self.cursor.part = 0;
        }
    }
}
