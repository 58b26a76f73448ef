//! The paper, word for word, in one readable place: its algorithms written sequentially in double precision, with a log of
//! every event.
//!
//! Each block stands under the paper's own number. §4.2 to §4.4 with Algorithm 2 are in `uniform`, §4.3 in `surface`, §4.5 in
//! `relaxation`, §5 in `adaptive`. The two particle systems that the paper compares them with are beside them: the general scheme of
//! §3 in `system`, what each makes of it in `witkin_heckbert` and `forces` (§6, Table 1). What the paper discusses or leaves open is an
//! option ([`Settings`]). Nothing here is made for speed. The tests hold the fast fronts to it, particle by particle.
//!
//! A run is a list of [chapters](Chapter): generation levels, the filling of gaps, relaxation steps, iterations of a particle
//! system. Before each chapter a snapshot is taken, or in long runs before some of them. The events of a chapter are not kept: they
//! are made again from its snapshot, which gives the same events to the last bit. So [`Reference::seek`] goes to any event,
//! forwards or backwards.
//!
//! ```
//! use marching_particles::field::gallery;
//! use marching_particles::reference::{Event, Reference, Settings};
//!
//! let sphere = gallery::find("sphere").expect("a surface of the gallery");
//! let settings = Settings { radius: 0.1, relax_steps: 2, ..Settings::default() };
//! let mut lesson = Reference::new(Box::new(sphere.field()), &sphere.bounds, &settings)?;
//! while !lesson.step(1_000).is_done {}
//!
//! // The first level treats the seed: all six children are new.
//! let first = lesson.chapters()[0].clone();
//! assert_eq!(first.fates.added, 6);
//! let events = lesson.events(first.first_event, first.events);
//! assert!(matches!(events[0], Event::Seed { particle: 0, .. }));
//! // Back to the moment before the first event.
//! lesson.seek(first.first_event);
//! assert!(lesson.particles().is_empty());
//! # Ok::<(), marching_particles::reference::ReferenceError>(())
//! ```
//!
//! # Differs from the paper
//!
//! * Fronts begin at the seeds that are given, or where a grid of the box shows the surface and no particle covers it.
//!   Components smaller than a cell of the grid may stay without particles.
//! * A child whose search does not converge is not placed; the paper says nothing of it.

mod adaptive;
mod buckets;
mod event;
mod felt;
mod forces;
mod gaps;
mod outlook;
mod relaxation;
mod run;
mod section;
mod settings;
mod snapshots;
mod state;
mod surface;
mod system;
mod uniform;
mod walk;
mod witkin_heckbert;

pub use event::{Event, Nearby, Vector};
pub use relaxation::Push;
pub use section::Iterate;
pub use settings::{
    LessonField, MAX_PARTICLES, Matched, Method, Order, Placing, Projection, ReferenceError, Seeding,
    Settings, Start,
};
pub use state::{Particle, digest};
pub use walk::ChapterKind;

use crate::field::Field;
use crate::math::{Bounds, SQRT_3};
use crate::sampler::{FateCounts, Sampling};
use glam::DVec3;
use outlook::{look_around, shuffled};
use serde::Serialize;
use snapshots::Snapshots;
use surface::Surface;
use system::QUIET;
use walk::{Place, Setup, Walk};

/// A part of a run, before which a snapshot is taken.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "LessonChapter"))]
pub struct Chapter {
    /// Kind of the chapter.
    #[serde(flatten)]
    pub kind: ChapterKind,
    /// Number of its first event in the run.
    pub first_event: u32,
    /// Number of its events so far.
    pub events: u32,
    /// Particles when it begins.
    pub before: u32,
    /// Particles when it ends.
    pub after: u32,
    /// Number of proposed children by fate.
    pub fates: FateCounts,
    /// Energy per particle when a relaxation step ends, or when an iteration of a particle system begins.
    pub energy: Option<f64>,
    /// Longest move, in radii, of relaxation steps and iterations.
    pub largest_move: Option<f64>,
    /// Particles that have divided.
    pub fissions: u32,
    /// Particles that have died.
    pub deaths: u32,
    /// Whether it is over.
    pub is_over: bool,
}

/// How far a run has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "LessonProgress"))]
pub struct Progress {
    /// Chapters so far.
    pub chapters: u32,
    /// Events so far.
    pub events: u32,
    /// Particles so far.
    pub particles: u32,
    /// Evaluations of the field so far.
    pub evaluations: u64,
    /// Relaxation steps, or iterations of a particle system, that are over.
    pub steps: u32,
    /// Whether a particle system has come to rest.
    pub is_settled: bool,
    /// Whether the limit on particles was reached.
    pub is_capped: bool,
    /// Whether the run has ended.
    pub is_done: bool,
}

/// When a particle was added, was treated and was done: numbers of events.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "LessonLife"))]
pub struct Life {
    /// It was added.
    pub born: Option<u32>,
    /// It was taken from the queue.
    pub taken: Option<u32>,
    /// It was marked as done.
    pub done: Option<u32>,
}

/// The moment of the run that is shown.
#[derive(Default)]
struct View {
    /// The chapter whose events are at hand.
    chapter: Option<usize>,
    events: Vec<Event>,
    /// Number of events of the run that have happened.
    at: u32,
    particles: Vec<Particle>,
}

/// A run of the paper's algorithms, and the place in it that is looked at.
pub struct Reference {
    setup: Setup,
    surface: Surface,
    /// The end of the run so far.
    walk: Walk,
    /// Events of the chapter under way.
    log: Vec<Event>,
    chapters: Vec<Chapter>,
    snapshots: Snapshots,
    lives: Vec<Life>,
    is_done: bool,
    view: View,
}

impl Reference {
    /// Prepares a run on the surface of `field` in a box, at which it takes a first look: some 36,000 evaluations.
    ///
    /// # Errors
    ///
    /// If a setting or the box is invalid, or if more particles are to be expected than [`MAX_PARTICLES`] and
    /// [`Settings::max_particles`].
    pub fn new(field: Box<dyn Field>, bounds: &Bounds, settings: &Settings) -> Result<Self, ReferenceError> {
        settings.validate()?;
        if !bounds.is_valid() {
            return Err(ReferenceError::Box);
        }
        let mut surface = Surface { field, bounds: *bounds, evaluations: 0 };
        let outlook = look_around(&mut surface);
        let diameter = extent(outlook.iter().map(|part| part.point));
        let mut setup = Setup { settings: settings.clone(), candidates: Vec::new(), diameter };
        let cell = |radius: f64| 2.0 * SQRT_3 * radius * radius;
        let expected: f64 = outlook
            .iter()
            .filter_map(|part| Some(part.area / cell(setup.radius_at(&mut surface, part.point)?)))
            .sum();
        surface.evaluations = 0;
        let most = settings.max_particles.max(MAX_PARTICLES);
        let limit = f64::from(most);
        if expected > limit {
            // A little more, since the area is an estimate and the number is shown rounded.
            let factor = 1.01 * (expected / limit).sqrt();
            let (expected, limit) = (expected as u64, most);
            return Err(match settings.sampling {
                Sampling::Uniform => {
                    let radius = factor * settings.radius;
                    ReferenceError::TooMany { expected, limit, radius }
                }
                Sampling::Adaptive => ReferenceError::TooManySizes { expected, limit, factor },
            });
        }
        setup.candidates = if settings.seeds.is_empty() {
            shuffled(outlook.iter().map(|part| part.point).collect(), settings.seed)
        } else {
            settings.seeds.iter().map(|&seed| seed.into()).collect()
        };
        Ok(Self {
            walk: Walk::at(&setup, Place::new(settings.seed), Vec::new()),
            setup,
            surface,
            log: Vec::new(),
            chapters: Vec::new(),
            snapshots: Snapshots::new(),
            lives: Vec::new(),
            is_done: false,
            view: View::default(),
        })
    }

    /// Prepares a run as [`Reference::new`] does that goes on from particles that are there, of which those from number `first` on
    /// wait to be treated, in their order. A front in single precision can so be followed level by level without its rounding
    /// adding up.
    ///
    /// # Errors
    ///
    /// As [`Reference::new`].
    pub fn going_on(
        field: Box<dyn Field>,
        bounds: &Bounds,
        settings: &Settings,
        particles: Vec<Particle>,
        first: u32,
    ) -> Result<Self, ReferenceError> {
        let mut run = Self::new(field, bounds, settings)?;
        let mut place = Place::new(settings.seed);
        place.waiting = (first..particles.len() as u32).collect();
        place.fronts = 1;
        run.lives = vec![Life::default(); particles.len()];
        run.walk = Walk::at(&run.setup, place, particles);
        Ok(run)
    }

    /// Goes on with the run by up to `budget` units of work: a particle that is treated, or moved. How a run is divided into
    /// steps does not change it.
    pub fn step(&mut self, budget: u32) -> Progress {
        let mut left = budget;
        while left > 0 && !self.is_done {
            if !self.walk.is_in_chapter() {
                self.begin_chapter();
                continue;
            }
            let is_over = self.walk.work(&mut self.surface, &self.setup, &mut self.log);
            left -= 1;
            if is_over {
                self.close_chapter(true);
                self.log.clear();
            }
        }
        if self.walk.is_in_chapter() {
            self.close_chapter(false);
        }
        self.progress()
    }

    /// How far the run has come.
    #[must_use]
    pub fn progress(&self) -> Progress {
        Progress {
            chapters: self.chapters.len() as u32,
            events: self.events_so_far(),
            particles: self.walk.particles.len() as u32,
            evaluations: self.walk.place.evaluations,
            steps: self.walk.place.steps,
            is_settled: self.walk.place.quiet >= QUIET,
            is_capped: self.walk.place.is_capped,
            is_done: self.is_done,
        }
    }

    fn events_so_far(&self) -> u32 {
        self.chapters.last().map_or(0, |last| last.first_event + last.events)
    }

    /// The chapters so far.
    #[must_use]
    pub fn chapters(&self) -> &[Chapter] {
        &self.chapters
    }

    /// When a particle was added, treated and done, as far as the run has come; `None` if there is none of this number.
    #[must_use]
    pub fn life(&self, particle: u32) -> Option<Life> {
        self.lives.get(particle as usize).copied()
    }

    /// Up to `count` events from number `first` on. Those of an earlier chapter are made again from its snapshot.
    pub fn events(&mut self, first: u32, count: u32) -> Vec<Event> {
        let end = first.saturating_add(count).min(self.events_so_far());
        let mut found = Vec::new();
        let mut next = first;
        while next < end {
            let chapter = self.chapter_of(next);
            self.open(chapter);
            let Chapter { first_event, events, .. } = self.chapters[chapter];
            let last = end.min(first_event + events);
            found.extend_from_slice(
                &self.view.events[(next - first_event) as usize..(last - first_event) as usize],
            );
            next = last;
        }
        found
    }

    /// Goes to the moment before event number `event`, or to the end of the run so far, and returns the number of events that
    /// have happened then.
    pub fn seek(&mut self, event: u32) -> u32 {
        let event = event.min(self.events_so_far());
        if self.chapters.is_empty() {
            return 0;
        }
        if event == self.events_so_far() {
            // The end is at hand.
            self.view = View { at: event, particles: self.walk.particles.clone(), ..View::default() };
            return event;
        }
        // The end of a chapter is looked at as its end, not as the beginning of the next one.
        let chapter = self.chapter_of(event.saturating_sub(1));
        let is_ahead = self.view.chapter == Some(chapter) && event >= self.view.at;
        self.open(chapter);
        let first = self.chapters[chapter].first_event;
        if !is_ahead || self.view.at < first {
            self.view.particles = self.walk_to(chapter).particles;
            self.view.at = first;
        }
        for k in self.view.at..event {
            self.view.events[(k - first) as usize].apply(&mut self.view.particles);
        }
        self.view.at = event;
        event
    }

    /// The particles at the moment that was sought.
    #[must_use]
    pub fn particles(&self) -> &[Particle] {
        &self.view.particles
    }

    /// Returns the repulsion of a particle by each of its neighbours at the moment that was sought; none if there is no such
    /// particle. The tangential part of the sum is the force of [`Event::Moved`].
    #[must_use]
    pub fn pushes(&self, particle: u32) -> Vec<Push> {
        if particle as usize >= self.view.particles.len() {
            return Vec::new();
        }
        let walk = Walk::at(&self.setup, Place::new(0), self.view.particles.clone());
        walk.pushes(&self.setup, particle).collect()
    }

    /// The box that is sampled.
    #[must_use]
    pub fn bounds(&self) -> &Bounds {
        &self.surface.bounds
    }

    fn begin_chapter(&mut self) {
        let before = self.walk.particles.len();
        let place = self.walk.place.clone();
        let Some(kind) = self.walk.begin_chapter(&mut self.surface, &self.setup, &mut self.log) else {
            self.is_done = true;
            return;
        };
        match kind {
            ChapterKind::Relaxation { .. } | ChapterKind::Iteration { .. } => {
                // The first iteration begins with the seed, which its events add.
                self.snapshots.add_moving(place, &self.walk.particles[..before]);
            }
            _ => self.snapshots.add_placed(place, before),
        }
        self.chapters.push(Chapter {
            kind,
            first_event: self.events_so_far(),
            events: 0,
            before: before as u32,
            after: before as u32,
            fates: FateCounts::default(),
            energy: None,
            largest_move: None,
            fissions: 0,
            deaths: 0,
            is_over: false,
        });
    }

    /// Brings what is said of the last chapter up to date with its events.
    fn close_chapter(&mut self, is_over: bool) {
        let after = self.walk.particles.len();
        let Some(chapter) = self.chapters.last_mut() else { return };
        for (event, number) in
            self.log[chapter.events as usize..].iter().zip(chapter.first_event + chapter.events..)
        {
            match *event {
                Event::Seed { .. } | Event::Added { .. } => {
                    self.lives.push(Life { born: Some(number), ..Life::default() });
                }
                Event::Divided { particle, .. } => {
                    let life = Life { born: Some(number), ..Life::default() };
                    self.lives[particle as usize] = life;
                    self.lives.push(life);
                    chapter.fissions += 1;
                }
                Event::Died { particle, .. } => {
                    self.lives.remove(particle as usize);
                    chapter.deaths += 1;
                }
                Event::Taken { particle } => self.lives[particle as usize].taken = Some(number),
                Event::Done { particle, .. } => self.lives[particle as usize].done = Some(number),
                Event::Fate { fate, .. } if chapter.kind != ChapterKind::Filling => chapter.fates.count(fate),
                Event::StepEnds { energy, largest_move, .. } => {
                    (chapter.energy, chapter.largest_move) = (Some(energy), Some(largest_move));
                }
                Event::IterationBegins { energy, .. } => chapter.energy = Some(energy),
                Event::IterationEnds { largest_move, .. } => chapter.largest_move = Some(largest_move),
                _ => {}
            }
        }
        chapter.events = self.log.len() as u32;
        chapter.after = after as u32;
        chapter.is_over = is_over;
    }

    /// The chapter to which an event belongs.
    fn chapter_of(&self, event: u32) -> usize {
        self.chapters.partition_point(|chapter| chapter.first_event <= event).saturating_sub(1)
    }

    /// Has the events of a chapter at hand.
    fn open(&mut self, chapter: usize) {
        let known = &self.chapters[chapter];
        if self.view.chapter == Some(chapter) && self.view.events.len() == known.events as usize {
            return;
        }
        self.view.events = if known.is_over { self.replay(chapter) } else { self.log.clone() };
        if self.view.chapter != Some(chapter) {
            // No particle has been looked at in this chapter yet.
            self.view.at = 0;
        }
        self.view.chapter = Some(chapter);
    }

    /// Makes the events of a chapter that is over again.
    fn replay(&mut self, chapter: usize) -> Vec<Event> {
        let mut walk = self.walk_to(chapter);
        let mut log = Vec::with_capacity(self.chapters[chapter].events as usize);
        walk.do_chapter(&mut self.surface, &self.setup, &mut log);
        debug_assert_eq!(log.len(), self.chapters[chapter].events as usize, "a replay gives the same events");
        log
    }

    /// The run at the beginning of a chapter.
    fn walk_to(&mut self, chapter: usize) -> Walk {
        let (from, place, particles) = self.snapshots.before(chapter, &self.walk.particles);
        let mut walk = Walk::at(&self.setup, place, particles);
        let mut log = Vec::new();
        for _ in from..chapter {
            walk.do_chapter(&mut self.surface, &self.setup, &mut log);
            log.clear();
        }
        walk
    }
}

/// Length of the diagonal of the box around some points; 0 if there is none.
fn extent(points: impl Iterator<Item = DVec3>) -> f64 {
    let infinite = DVec3::splat(f64::INFINITY);
    let (lo, hi) = points.fold((infinite, -infinite), |(lo, hi), p| (lo.min(p), hi.max(p)));
    (hi - lo).max(DVec3::ZERO).length()
}

#[cfg(test)]
mod tests {
    use super::snapshots::Snapshots;
    use super::{Event, Method, Reference, Settings, digest};
    use crate::field::gallery;

    #[test]
    fn back_is_exact_where_most_snapshots_have_been_dropped() {
        let sphere = gallery::find("sphere").expect("a surface of the gallery");
        let settings = Settings {
            method: Method::WitkinHeckbert,
            radius: 0.15,
            max_iterations: 100,
            ..Settings::default()
        };
        let start =
            || Reference::new(Box::new(sphere.field()), &sphere.bounds, &settings).expect("valid settings");
        let (mut all, mut few) = (start(), start());
        few.snapshots = Snapshots::with_most(1_000);
        while !all.step(1_000).is_done {}
        while !few.step(1_000).is_done {}
        assert_eq!(all.progress(), few.progress());
        let kept = few.snapshots.kept();
        assert!(kept * 5 < all.snapshots.kept(), "{kept} of {} are kept", all.snapshots.kept());
        let events = all.events(0, u32::MAX);
        assert!(events == few.events(0, u32::MAX));
        let mut particles = Vec::new();
        for (k, event) in events.iter().enumerate() {
            if k % 997 == 0 {
                few.seek(k as u32);
                assert_eq!(digest(few.particles()), digest(&particles), "event {k}");
            }
            event.apply(&mut particles);
        }
        assert!(events.iter().any(|event| matches!(event, Event::Divided { .. })));
    }
}
