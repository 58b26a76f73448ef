//! The lesson's engine: runs of the paper's algorithms, and of the two systems that the paper
//! compares them with, with a log of every event.
//!
//! The engine drives the parts of [`paper`](crate::paper). It adds the choice of seeds and the
//! order of treatment (`course`), the same front level by level (`levels`), the filling of gaps
//! between fronts (`gaps`), and the two particle systems of the paper's Table 1: the general scheme
//! of §3 in `system`, and the rules of each in `witkin_heckbert` and `forces`. [`LessonSettings`]
//! chooses among them.
//!
//! A run is a list of [chapters](Chapter): generation levels, the filling of gaps, relaxation
//! steps, iterations of a particle system. A snapshot is kept before each chapter, or in long runs
//! before some. Events of earlier chapters are not kept: running a chapter again from its snapshot
//! gives the same events to the last bit. So [`Lesson::seek`] can go to any event, forwards or
//! backwards.
//!
//! ```
//! use marching_particles::field::gallery;
//! use marching_particles::internal::lesson::{Event, Lesson, LessonSettings};
//!
//! let sphere = gallery::find("sphere").expect("a surface of the gallery");
//! let settings = LessonSettings { radius: 0.1, relax_steps: 2, ..LessonSettings::default() };
//! let mut lesson = Lesson::new(Box::new(sphere.field()), &sphere.bounds, &settings)?;
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
//! # Ok::<(), marching_particles::internal::lesson::LessonError>(())
//! ```
//!
//! Fronts begin at the given seeds, or at points that a grid in the box finds on the surface, if no
//! particle covers them. Components smaller than a cell of the grid may be missed.

mod course;
mod dynamics;
mod event;
mod forces;
mod gaps;
mod levels;
mod log;
mod prediction;
mod section;
mod settings;
mod snapshots;
mod survey;
mod system;
mod witkin_heckbert;

pub use course::ChapterKind;
pub use event::{Event, Vector};
pub use section::Iterate;
pub use settings::{
    LessonError, LessonField, LessonMethod, LessonPlacing, LessonSettings, MAX_PARTICLES, Matched,
    Projection, QueueOrder, SearchStart,
};

use crate::field::Field;
use crate::math::{Bounds, FNV_START, HEXAGONAL_CELL, fnv};
use crate::paper::{ImplicitSurface, Particle};
use crate::sampler::FateCounts;
use course::{Course, Setup};
use glam::DVec3;
use serde::Serialize;
use snapshots::Snapshots;
use survey::{SurfacePatch, shuffled, survey};
use system::QUIET;

/// A part of a run; a snapshot may be kept before it.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "LessonChapter"))]
pub struct Chapter {
    /// Kind of the chapter.
    #[serde(flatten)]
    pub kind: ChapterKind,
    /// Number of the first event of the chapter in the run.
    pub first_event: u32,
    /// Number of events of the chapter so far.
    pub events: u32,
    /// Number of particles at the beginning of the chapter.
    pub before: u32,
    /// Number of particles at the end of the chapter.
    pub after: u32,
    /// Number of proposed children by fate.
    pub fates: FateCounts,
    /// Energy per particle when a relaxation step ends, or when an iteration of a particle system
    /// begins.
    pub energy: Option<f64>,
    /// Longest move, in radii, of relaxation steps and iterations.
    pub largest_move: Option<f64>,
    /// Particles that have divided.
    pub fissions: u32,
    /// Particles that have died.
    pub deaths: u32,
    /// Evaluations of the field in the run until the end of the chapter.
    pub evaluations: u64,
    /// Whether the chapter is over.
    pub is_over: bool,
}

/// Progress of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct LessonProgress {
    /// Chapters so far.
    pub chapters: u32,
    /// Events so far.
    pub events: u32,
    /// Particles so far.
    pub particles: u32,
    /// Evaluations of the field so far.
    pub evaluations: u64,
    /// Pushes of one particle by another that were summed for moves so far.
    pub interactions: u64,
    /// Number of completed relaxation steps or iterations.
    pub steps: u32,
    /// Whether a particle system has settled.
    pub is_settled: bool,
    /// Whether the limit on particles was reached.
    pub is_capped: bool,
    /// Whether the run has ended.
    pub is_done: bool,
}

/// The numbers of the events at which a particle was added, treated and done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "LessonLife"))]
pub struct Life {
    /// The event at which the particle was added.
    pub born: Option<u32>,
    /// The event at which the particle was taken from the queue.
    pub taken: Option<u32>,
    /// The event at which the particle was marked as done.
    pub done: Option<u32>,
}

/// A chapter whose events are loaded.
struct OpenChapter {
    /// Number of the chapter.
    chapter: usize,
    /// The particles before its first event.
    before: Vec<Particle>,
    /// The events of the chapter so far.
    events: Vec<Event>,
}

/// A run of the paper's algorithms, or of a system that it compares them with, and the moment of
/// the run that is shown.
pub struct Lesson {
    /// The state at the end of the run so far, with the events of the current chapter.
    course: Course,
    chapters: Vec<Chapter>,
    snapshots: Snapshots,
    lives: Vec<Life>,
    is_done: bool,
    /// The chapter that was loaded last.
    open: Option<OpenChapter>,
    /// The particles at the moment that was last sought.
    shown: Vec<Particle>,
}

impl Lesson {
    /// Prepares a run on the surface of `field` in a box, whose first survey takes about 36,000
    /// evaluations.
    ///
    /// # Errors
    ///
    /// If a setting or the box is invalid, or if about more particles are expected than
    /// [`MAX_PARTICLES`] or [`LessonSettings::max_particles`] allow.
    pub fn new(
        field: Box<dyn Field>,
        bounds: &Bounds,
        settings: &LessonSettings,
    ) -> Result<Self, LessonError> {
        settings.validate()?;
        bounds.check()?;
        let mut surface = ImplicitSurface::new(field, bounds);
        let patches = survey(&mut surface);
        check_count(&patches, &mut surface, settings)?;
        let setup = Setup {
            settings: settings.clone(),
            diameter: extent(patches.iter().map(|patch| patch.point)),
            candidates: if settings.seeds.is_empty() {
                shuffled(patches.iter().map(|patch| patch.point).collect(), settings.seed)
            } else {
                settings.seeds.iter().map(|&seed| seed.into()).collect()
            },
        };
        Ok(Self {
            course: Course::new(setup, surface),
            chapters: Vec::new(),
            snapshots: Snapshots::new(),
            lives: Vec::new(),
            is_done: false,
            open: None,
            shown: Vec::new(),
        })
    }

    /// Continues the run by up to `budget` units of work; a unit treats or moves one particle. The
    /// division into steps does not change the run.
    pub fn step(&mut self, budget: u32) -> LessonProgress {
        let mut left = budget;
        while left > 0 && !self.is_done {
            if !self.course.is_in_chapter() {
                self.begin_chapter();
                continue;
            }
            let is_over = self.course.work();
            left -= 1;
            if is_over {
                self.close_chapter(true);
                self.course.run.seen.events.clear();
            }
        }
        if self.course.is_in_chapter() {
            self.close_chapter(false);
        }
        self.progress()
    }

    /// The progress of the run.
    #[must_use]
    pub fn progress(&self) -> LessonProgress {
        LessonProgress {
            chapters: self.chapters.len() as u32,
            events: self.events_so_far(),
            particles: self.course.run.particles.len() as u32,
            evaluations: self.course.run.surface.evaluations,
            interactions: self.course.interactions,
            steps: self.course.steps,
            is_settled: self.course.quiet >= QUIET,
            is_capped: self.course.run.seen.is_capped,
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

    /// The events at which a particle was added, treated and done so far; `None` if there is no
    /// particle with this number.
    #[must_use]
    pub fn life(&self, particle: u32) -> Option<Life> {
        self.lives.get(particle as usize).copied()
    }

    /// Up to `count` events from number `first` on. Events of earlier chapters are computed again
    /// from a snapshot.
    pub fn events(&mut self, first: u32, count: u32) -> Vec<Event> {
        let end = first.saturating_add(count).min(self.events_so_far());
        let mut found = Vec::new();
        let mut next = first;
        while next < end {
            let chapter = self.chapter_of(next);
            let Chapter { first_event, events, .. } = self.chapters[chapter];
            let last = end.min(first_event + events);
            let range = (next - first_event) as usize..(last - first_event) as usize;
            found.extend_from_slice(&self.open(chapter).events[range]);
            next = last;
        }
        found
    }

    /// Goes to the moment before event number `event`, or to the end of the run so far. Returns the
    /// number of events before that moment.
    pub fn seek(&mut self, event: u32) -> u32 {
        let event = event.min(self.events_so_far());
        if event == self.events_so_far() {
            // The end is already available.
            self.shown.clone_from(&self.course.run.particles);
            return event;
        }
        // The end of a chapter belongs to that chapter, not to the next one.
        let chapter = self.chapter_of(event.saturating_sub(1));
        let happened = event - self.chapters[chapter].first_event;
        let open = self.open(chapter);
        let mut particles = open.before.clone();
        for event in &open.events[..happened as usize] {
            event.apply(&mut particles);
        }
        self.shown = particles;
        event
    }

    /// The particles at the moment that was last sought.
    #[must_use]
    pub fn particles(&self) -> &[Particle] {
        &self.shown
    }

    /// The box that is sampled.
    #[must_use]
    pub fn bounds(&self) -> &Bounds {
        &self.course.run.surface.bounds
    }

    fn begin_chapter(&mut self) {
        let before = self.course.run.particles.len();
        self.snapshots.add(self.chapters.len(), &self.course);
        let kind = self.course.begin_chapter();
        let evaluations = self.course.run.surface.evaluations;
        // The search for the next seed belongs to the previous chapter; without another seed, it
        // ends the placing.
        if let Some(last) = self.chapters.last_mut() {
            last.evaluations = evaluations;
        }
        let Some(kind) = kind else {
            self.is_done = true;
            return;
        };
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
            evaluations,
            is_over: false,
        });
    }

    /// Updates the figures of the last chapter from its events.
    fn close_chapter(&mut self, is_over: bool) {
        let after = self.course.run.particles.len();
        let log = &self.course.run.seen.events;
        let Some(chapter) = self.chapters.last_mut() else { return };
        for (event, number) in
            log[chapter.events as usize..].iter().zip(chapter.first_event + chapter.events..)
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
        chapter.events = log.len() as u32;
        chapter.after = after as u32;
        chapter.evaluations = self.course.run.surface.evaluations;
        chapter.is_over = is_over;
    }

    /// The chapter to which an event belongs.
    fn chapter_of(&self, event: u32) -> usize {
        self.chapters.partition_point(|chapter| chapter.first_event <= event).saturating_sub(1)
    }

    /// Loads the events of a chapter. If it is over, they are computed again.
    fn open(&mut self, chapter: usize) -> &OpenChapter {
        let Chapter { events: count, is_over, .. } = self.chapters[chapter];
        let known = self.open.take();
        let is_known = |open: &OpenChapter| open.chapter == chapter && open.events.len() == count as usize;
        let open = known.filter(is_known).unwrap_or_else(|| {
            let mut course = self.snapshots.at(chapter);
            let before = course.run.particles.clone();
            let events = if is_over {
                course.do_chapter();
                course.run.seen.events
            } else {
                self.course.run.seen.events.clone()
            };
            debug_assert_eq!(events.len(), count as usize, "a replay gives the same events");
            OpenChapter { chapter, before, events }
        });
        self.open.insert(open)
    }
}

/// Refuses a run with too many particles.
fn check_count(
    patches: &[SurfacePatch],
    surface: &mut ImplicitSurface,
    settings: &LessonSettings,
) -> Result<(), LessonError> {
    let sizes = settings.rules().sizes;
    let cell = |radius: f64| HEXAGONAL_CELL * radius * radius;
    let expected: f64 = patches
        .iter()
        .filter_map(|patch| Some(patch.area / cell(sizes.radius_at(surface, patch.point)?)))
        .sum();
    let most = settings.max_particles.max(MAX_PARTICLES);
    let limit = f64::from(most);
    if expected <= limit {
        return Ok(());
    }
    // Slightly more, since the area is an estimate and the number is shown rounded.
    let factor = 1.01 * (expected / limit).sqrt();
    Err(LessonError::TooMany { expected: expected as u32, limit: most, factor })
}

/// FNV-1a hash of the bits of all particles.
#[must_use]
pub fn digest(particles: &[Particle]) -> u64 {
    let mut hash = FNV_START;
    let mut word = |bits: u64| hash = fnv(hash, &bits.to_le_bytes());
    for particle in particles {
        let vectors = [particle.position, particle.normal];
        vectors.as_flattened().iter().chain([&particle.radius]).for_each(|number| word(number.to_bits()));
        word(u64::from(particle.parent.unwrap_or(u32::MAX)));
        word(u64::from(particle.level));
        word(u64::from(particle.slots.0) << 1 | u64::from(particle.is_done));
    }
    hash
}

/// Length of the diagonal of the box around some points; 0 without points.
fn extent(points: impl Iterator<Item = DVec3>) -> f64 {
    Bounds::around(points).size().max(DVec3::ZERO).length()
}

#[cfg(test)]
mod tests {
    use super::snapshots::Snapshots;
    use super::{Event, Lesson, LessonMethod, LessonSettings, Life, digest};
    use crate::field::gallery;
    use crate::paper::Particle;
    use crate::particles::Particles;
    use crate::run::Run;
    use crate::sampler::{GapPolicy, Settings};
    use glam::DVec3;

    /// Goes on from particles, of which those from number `first` on wait to be treated, in their
    /// order.
    fn go_on(run: &mut Lesson, particles: &[Particle], first: u32) {
        for &particle in particles {
            run.course.run.enter(particle);
        }
        run.lives = vec![Life::default(); particles.len()];
        run.course.waiting = (first..particles.len() as u32).collect();
        run.course.fronts = particles.last().expect("a particle").front + 1;
    }

    #[test]
    fn fronts_of_two_seeds_meet() {
        let sphere = gallery::find("sphere").expect("a surface of the gallery");
        let settings = LessonSettings { radius: 0.08, relax_steps: 0, ..LessonSettings::default() };
        let mut run =
            Lesson::new(Box::new(sphere.field()), &sphere.bounds, &settings).expect("valid settings");
        let seeds = [(0, DVec3::Z), (1, DVec3::NEG_Z)].map(|(front, pole)| Particle {
            front,
            ..Particle::placed(pole, pole, settings.radius, None, 0)
        });
        go_on(&mut run, &seeds, 0);
        while !run.step(1_000).is_done {}
        run.seek(u32::MAX);
        let events = run.events(0, u32::MAX);
        assert!(events.iter().any(|event| matches!(event, Event::FrontsMeet { is_other: true, .. })));
        assert_eq!(run.particles().iter().filter(|particle| particle.parent.is_none()).count(), 2);
    }

    #[test]
    fn back_is_exact_where_most_snapshots_have_been_dropped() {
        let sphere = gallery::find("sphere").expect("a surface of the gallery");
        let settings = LessonSettings {
            method: LessonMethod::WitkinHeckbert,
            radius: 0.15,
            max_iterations: 100,
            ..LessonSettings::default()
        };
        let start =
            || Lesson::new(Box::new(sphere.field()), &sphere.bounds, &settings).expect("valid settings");
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

    /// The reference makes each level from the particles of the fast front's level before it, so
    /// that roundings do not add up: every particle is compared, also those after the first close
    /// call. With larger particles, at whose size the surface folds, the fast search gives children
    /// up that the reference's search finds.
    #[test]
    #[ignore = "slow: for cargo xtask test --all"]
    fn every_level_of_the_front_is_what_the_reference_makes_of_the_one_before() {
        for (id, share) in
            [("tanglecube", 0.006), ("tanglecube", 0.008), ("ellipsoid", 0.012), ("torus", 0.02)]
        {
            let surface = gallery::find(id).expect("a gallery surface");
            let settings = Settings {
                radius_share: share,
                relax_steps: 0,
                gaps: GapPolicy::Leave,
                ..Settings::default()
            };
            let mut sampled =
                Run::start(surface.field(), &settings.in_box(surface.bounds)).expect("valid settings");
            while sampled.step(u32::MAX).stop_reason.is_none() {}
            let (fast, radius) = (sampled.particles(), f64::from(sampled.sampler().radius() as f32));
            let settings = LessonSettings {
                radius,
                seeds: vec![fast.local[0].as_dvec3().to_array()],
                relax_steps: 0,
                ..LessonSettings::of_fast_front()
            };
            let placed: Vec<Particle> = (0..fast.len())
                .map(|i| {
                    let parent = Some(fast.parent[i]).filter(|&parent| parent != Particles::NO_PARENT);
                    let (position, normal) = (fast.local[i].as_dvec3(), fast.normal[i].as_dvec3());
                    Particle::placed(position, normal, radius, parent, fast.level[i])
                })
                .collect();
            let mut farthest = 0.0_f64;
            for level in 0..=*fast.level.last().expect("a level") {
                let [first, end, next] =
                    [level, level + 1, level + 2].map(|k| fast.level.partition_point(|&own| own < k));
                let field = Box::new(surface.field());
                let mut run = Lesson::new(field, &surface.bounds, &settings)
                    .unwrap_or_else(|error| panic!("{id}: {error}"));
                go_on(&mut run, &placed[..end], first as u32);
                while !run.chapters().first().is_some_and(|chapter| chapter.is_over) {
                    run.step(1);
                }
                run.seek(u32::MAX);
                let made = run.particles();
                assert_eq!(made.len(), next, "{id}, {share}: level {level}");
                for (i, particle) in made.iter().enumerate().skip(first) {
                    if i < end {
                        assert_eq!(
                            fast.slots[i], particle.slots,
                            "{id}, {share}: level {level}, particle {i}"
                        );
                    } else {
                        assert_eq!(Some(fast.parent[i]), particle.parent, "{id}, {share}: child {i}");
                        farthest = farthest.max(fast.local[i].as_dvec3().distance(particle.p()) / radius);
                    }
                }
            }
            // Children end where f is small enough: within 10⁻⁴ r of the surface, and as much along
            // it.
            assert!(farthest < 2e-4, "{id}, {share}: a child is {farthest} r apart");
        }
    }
}
