//! The course of a run: which chapter comes next, and the units of work in it.

use super::event::Event;
use super::settings::{Method, Order, Placing, Seeding};
use super::state::Particle;
use super::surface::{Landing, Surface};
use super::walk::{ChapterKind, Setup, Walk};
use crate::sampler::{GapPolicy, Sampling};

/// With a stack there are no rings: a chapter is this many particles.
const STACK_CHAPTER: u32 = 100;

/// A candidate for a seed is covered by a particle of its sheet within this many radii.
const COVERED: f64 = 2.0;

/// Distance at which the size of f tells a zero from a pole, in radii.
const POLE_PROBE: f64 = 1e-3;

impl Walk {
    /// Whether a chapter is under way.
    pub(super) fn is_in_chapter(&self) -> bool {
        self.kind.is_some()
    }

    /// Does a whole chapter.
    pub(super) fn do_chapter(&mut self, surface: &mut Surface, setup: &Setup, log: &mut Vec<Event>) {
        if self.begin_chapter(surface, setup, log).is_some() {
            while !self.work(surface, setup, log) {}
        }
    }

    /// Begins the next chapter; `None` at the end of the run.
    pub(super) fn begin_chapter(
        &mut self,
        surface: &mut Surface,
        setup: &Setup,
        log: &mut Vec<Event>,
    ) -> Option<ChapterKind> {
        surface.evaluations = self.place.evaluations;
        self.kind = match setup.settings.method {
            Method::Front => self.begin_part_of_front(surface, setup, log),
            Method::WitkinHeckbert | Method::Forces => self.begin_iteration(surface, setup, log),
        };
        self.place.evaluations = surface.evaluations;
        self.kind
    }

    fn begin_part_of_front(
        &mut self,
        surface: &mut Surface,
        setup: &Setup,
        log: &mut Vec<Event>,
    ) -> Option<ChapterKind> {
        if self.place.waiting.is_empty() && !self.place.is_capped {
            self.add_seeds(surface, setup, log);
        }
        if !self.place.waiting.is_empty() {
            Some(self.begin_level(setup, log))
        } else if setup.settings.gaps == GapPolicy::Fill
            && !self.place.is_filled
            && !self.place.seams.is_empty()
            && !self.place.is_capped
        {
            self.left = self.place.seams.len() as u32;
            Some(ChapterKind::Filling)
        } else if self.place.steps < setup.settings.relax_steps && self.particles.len() > 1 {
            self.left = self.particles.len() as u32;
            self.begin_step(setup, log);
            Some(ChapterKind::Relaxation { step: self.place.steps + 1 })
        } else {
            None
        }
    }

    fn begin_level(&mut self, setup: &Setup, log: &mut Vec<Event>) -> ChapterKind {
        let next = self.particles[self.place.waiting[0] as usize];
        let waiting = self.place.waiting.len() as u32;
        let part = self.place.part;
        self.place.part += 1;
        let front = self.place.fronts - 1;
        match setup.settings.order {
            Order::Queue => {
                self.left = waiting;
                log.push(Event::LevelBegins { level: next.level, waiting });
                ChapterKind::Level { front, level: next.level }
            }
            Order::Stack => {
                self.left = STACK_CHAPTER;
                ChapterKind::Stack { front, part }
            }
        }
    }

    /// Does one unit of work of the chapter, and says whether that was its last.
    pub(super) fn work(&mut self, surface: &mut Surface, setup: &Setup, log: &mut Vec<Event>) -> bool {
        surface.evaluations = self.place.evaluations;
        match self.kind {
            None => {}
            Some(ChapterKind::Level { .. } | ChapterKind::Stack { .. }) => {
                match setup.settings.placing {
                    Placing::OneByOne if setup.settings.sampling == Sampling::Adaptive => {
                        self.treat_adaptive(surface, setup, log);
                    }
                    Placing::OneByOne => self.treat_next(surface, setup, log),
                    Placing::LevelByLevel if self.left > 0 => self.predict_next(surface, setup, log),
                    Placing::LevelByLevel => self.settle_next(surface, setup, log),
                }
                self.left = self.left.saturating_sub(1);
                if self.place.is_capped {
                    self.place.waiting.clear();
                    self.children.clear();
                    self.left = 0;
                }
                // A stack may be empty before the end of its chapter.
                if self.place.waiting.is_empty() {
                    self.left = 0;
                }
            }
            Some(ChapterKind::Filling) => {
                let beside = self.place.seams[self.place.seams.len() - self.left as usize];
                self.fill_beside(surface, setup, beside, log);
                self.left -= 1;
                self.place.is_filled = self.left == 0;
            }
            Some(ChapterKind::Relaxation { .. }) => {
                let particle = self.particles.len() - self.left as usize;
                self.move_particle(surface, setup, particle, log);
                self.left -= 1;
                if self.left == 0 {
                    self.end_step(setup, log);
                }
            }
            Some(ChapterKind::Iteration { .. }) => self.iterate(surface, setup, log),
        }
        self.place.evaluations = surface.evaluations;
        let is_over = self.left == 0 && self.children.is_empty();
        if is_over {
            self.kind = None;
        }
        is_over
    }

    /// Puts the next seed that no particle covers into the queue, or all of them.
    pub(super) fn add_seeds(&mut self, surface: &mut Surface, setup: &Setup, log: &mut Vec<Event>) {
        let first = self.place.fronts;
        while let Some(&candidate) = setup.candidates.get(self.place.candidate) {
            self.place.candidate += 1;
            if self.particles.len() >= setup.settings.max_particles as usize {
                self.place.is_capped = true;
                return;
            }
            let reach = 2.0 * setup.largest();
            let residual = setup.residual(setup.smallest());
            let Landing::On { position, normal } =
                surface.land_by_newton(candidate, reach, residual, &mut |_| {})
            else {
                continue;
            };
            let Some(r) = setup.radius_at(surface, position) else { continue };
            let is_covered = self
                .buckets
                .near(&self.particles, position, COVERED * r)
                .iter()
                .any(|near| self.particles[near.particle as usize].n().dot(normal) > 0.0);
            if is_covered || !surface.contains(position) || !surface.is_zero(position, normal, POLE_PROBE * r)
            {
                continue;
            }
            let particle = self.particles.len() as u32;
            let data = Particle::seed(position, normal, r, self.place.fronts);
            self.particles.push(data);
            self.buckets.insert(position, particle);
            self.place.waiting.push_back(particle);
            self.place.fronts += 1;
            log.push(Event::Seed { particle, data });
            if setup.settings.seeding == Seeding::OneByOne {
                break;
            }
        }
        if self.place.fronts > first {
            self.place.part = 0;
        }
    }
}
