//! One run of a method on a job: particles, steps, times and figures.

use glam::Vec3;
use marching_particles::Bounds;
use marching_particles::field::rbf::RbfField;
use marching_particles::field::{Field, gallery, model};
use marching_particles::internal::lesson::{self, ChapterKind, Lesson};
use marching_particles::internal::paper::Particle;
use marching_particles::pointcloud::fit_model;
use marching_particles::quality::{self, Figures};
use marching_particles::sampler::Phase;
use marching_particles::{LawKind, Run, Sampling, Settings, SizeMode};
use std::time::Instant;

/// A surface that the paper samples, or what stands in for it.
pub(crate) struct Surface {
    make: Box<dyn Fn() -> Box<dyn Field>>,
    pub(crate) bounds: Bounds,
}

impl Surface {
    /// A surface of the gallery or a model.
    pub(crate) fn of(id: &str) -> Self {
        if let Some(surface) = gallery::find(id) {
            let field = surface.field();
            return Self { make: Box::new(move || Box::new(field.clone())), bounds: surface.bounds };
        }
        let model = model::find(id).expect("a surface or a model");
        let fit = fit_model(model);
        let data = fit.data;
        let make =
            move || Box::new(RbfField::new(data.clone()).expect("a solved system is a field")) as Box<_>;
        Self { make: Box::new(make), bounds: fit.bounds }
    }

    pub(crate) fn field(&self) -> Box<dyn Field> {
        (self.make)()
    }
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    /// The run has ended by its own rule.
    Done,
    /// The run was cut off at the limit of processor time.
    CutOff,
}

/// A set of particles.
#[derive(Clone, Debug, Default)]
pub(crate) struct Set {
    pub(crate) position: Vec<Vec3>,
    pub(crate) normal: Vec<Vec3>,
    pub(crate) radius: Vec<f32>,
    pub(crate) level: Vec<u32>,
}

impl Set {
    pub(crate) fn of_faithful(particles: &[Particle]) -> Self {
        Self {
            position: particles.iter().map(|particle| particle.p().as_vec3()).collect(),
            normal: particles.iter().map(|particle| particle.n().as_vec3()).collect(),
            radius: particles.iter().map(|particle| particle.radius as f32).collect(),
            level: particles.iter().map(|particle| particle.level).collect(),
        }
    }
}

/// Result of a run. Times are seconds of processor time.
#[derive(Clone, Debug)]
pub(crate) struct Outcome {
    pub(crate) set: Set,
    /// Relaxation steps, or iterations.
    pub(crate) steps: u32,
    pub(crate) end: End,
    /// Time of all but the relaxation.
    pub(crate) generation: f64,
    pub(crate) relaxation: f64,
    pub(crate) last_step: f64,
    pub(crate) evaluations: u64,
    pub(crate) figures: Figures,
}

impl Outcome {
    pub(crate) fn count(&self) -> usize {
        self.set.position.len()
    }

    pub(crate) fn total(&self) -> f64 {
        self.generation + self.relaxation
    }
}

/// Processor time of this thread, so that other work on the machine does not count, or wall time if
/// the system does not report it.
struct Stopwatch(Instant, f64);

impl Stopwatch {
    fn start() -> Self {
        let mut clock = Self(Instant::now(), 0.0);
        clock.1 = clock.now();
        clock
    }

    fn now(&self) -> f64 {
        std::fs::read_to_string("/proc/thread-self/schedstat")
            .ok()
            .and_then(|text| text.split(' ').next()?.parse::<f64>().ok())
            .map_or_else(|| self.0.elapsed().as_secs_f64(), |nanoseconds| nanoseconds * 1e-9)
    }

    fn seconds(&self) -> f64 {
        self.now() - self.1
    }
}

/// A job: a surface to be sampled, with the sizes of the particles.
pub(crate) struct Job {
    pub(crate) surface: Surface,
    /// Settings of the sampler: of given size.
    pub(crate) sizes: Settings,
    /// The radius, or that of as many particles of one size.
    pub(crate) radius: f64,
}

/// Limits that no job meets.
const MOST_PARTICLES: u32 = 200_000;
const MOST_ITERATIONS: u32 = 10_000;

/// The largest and the smallest radius of adaptive particles, in radii of as many particles of one
/// size. The paper has such limits and does not name them.
const RADII: [f64; 2] = [0.4, 2.0];

impl Job {
    /// The job of sampling this surface with about so many particles: the sizes with which the fast
    /// sampler places them.
    pub(crate) fn new(id: &str, sampling: Sampling, count: u32) -> Self {
        let surface = Surface::of(id);
        let wanted = settings!(size_mode: SizeMode::Count, count; ..Settings::default());
        let diagonal = surface.bounds.diagonal();
        let radius = sampled(&surface, &wanted, |_| {}).progress().map_or(0.0, |progress| progress.radius);
        let mut sizes = settings!(radius_share: radius / diagonal; ..Settings::default());
        if sampling == Sampling::Adaptive {
            let share = radius / diagonal;
            sizes = settings!(sampling,
                radius_law: LawKind::SumOfCurvatures,
                curvature_scale: 0.05,
                radius_min_share: RADII[0] * share,
                radius_max_share: RADII[1] * share; ..sizes);
            // The count falls with the square of the scale where no limit acts.
            let (least, most) = Settings::range("curvature_scale").expect("it is a number").into_inner();
            for _ in 0..8 {
                let found = sampled(&surface, &sizes, |_| {}).particles().len() as f64;
                let factor = (found / f64::from(count)).sqrt();
                sizes.curvature_scale = (sizes.curvature_scale * factor).clamp(least, most);
            }
        }
        Self { surface, sizes, radius }
    }

    /// Settings of the lesson for these sizes, with the paper's choices.
    pub(crate) fn faithful(&self) -> lesson::LessonSettings {
        let diagonal = self.surface.bounds.diagonal();
        lesson::LessonSettings {
            sampling: self.sizes.sampling,
            radius: self.radius,
            law: self.sizes.radius_law,
            law_scale: self.sizes.curvature_scale,
            radius_min: self.sizes.radius_min_share * diagonal,
            radius_max: if self.sizes.sampling == Sampling::Adaptive {
                self.sizes.radius_max_share * diagonal
            } else {
                0.0
            },
            max_particles: MOST_PARTICLES,
            max_iterations: MOST_ITERATIONS,
            ..lesson::LessonSettings::default()
        }
    }

    fn figures(&self, set: &Set) -> Figures {
        let radii = (self.sizes.sampling == Sampling::Adaptive).then_some(&set.radius[..]);
        let options = quality::MeasureOptions { radii, ..quality::MeasureOptions::default() };
        let field = &mut *self.surface.field();
        quality::measure(&set.position, &set.normal, field, Some(&self.surface.bounds), &options).figures
    }

    /// The fast sampler.
    pub(crate) fn run_fast(&self) -> Outcome {
        let clock = Stopwatch::start();
        let mut relaxation = 0.0;
        let mut begun = 0.0;
        let run = sampled(&self.surface, &self.sizes, |phase| {
            let now = clock.seconds();
            if phase == Phase::Relaxation {
                relaxation += now - begun;
            }
            begun = now;
        });
        let total = clock.seconds();
        let particles = run.particles();
        let set = Set {
            position: particles.local.clone(),
            normal: particles.normal.clone(),
            radius: particles.radius.clone(),
            level: particles.level.clone(),
        };
        let steps = self.sizes.relax_steps;
        Outcome {
            steps,
            end: End::Done,
            generation: total - relaxation,
            relaxation,
            last_step: relaxation / f64::from(steps),
            evaluations: run.progress().map_or(0, |progress| progress.evaluations),
            figures: self.figures(&set),
            set,
        }
    }

    /// A method as it is written.
    pub(crate) fn run_faithful(&self, settings: &lesson::LessonSettings, limit_s: f64) -> Outcome {
        let clock = Stopwatch::start();
        let mut run =
            Lesson::new(self.surface.field(), &self.surface.bounds, settings).expect("valid settings");
        let [mut generation, mut relaxation, mut last_step] = [clock.seconds(), 0.0, 0.0];
        let mut chapter = 0;
        let mut end = End::Done;
        while !run.progress().is_done {
            let begun = clock.seconds();
            let progress = run.step(UNITS);
            let took = clock.seconds() - begun;
            let Some(last) = run.chapters().last() else { continue };
            if matches!(last.kind, ChapterKind::Relaxation { .. } | ChapterKind::Iteration { .. }) {
                relaxation += took;
                // A chapter with a new number has begun within this step: what the step took is
                // counted as its own.
                last_step = if progress.chapters == chapter { last_step + took } else { took };
            } else {
                generation += took;
            }
            chapter = progress.chapters;
            if clock.seconds() > limit_s && !progress.is_done {
                end = End::CutOff;
                break;
            }
        }
        run.seek(u32::MAX);
        let set = Set::of_faithful(run.particles());
        let progress = run.progress();
        let figures = self.figures(&set);
        let (steps, evaluations) = (progress.steps, progress.evaluations);
        Outcome { set, steps, end, generation, relaxation, last_step, evaluations, figures }
    }
}

/// Units of work of the lesson between two looks at the clock.
const UNITS: u32 = 500;

/// The fast sampler at its end. `each` is told the phase of every step.
fn sampled(
    surface: &Surface,
    settings: &Settings,
    mut each: impl FnMut(Phase),
) -> Run<'static, Box<dyn Field>> {
    let mut run = Run::start(surface.field(), &settings.in_box(surface.bounds)).expect("valid settings");
    loop {
        let progress = run.step(4_096);
        each(progress.phase);
        if progress.stop_reason.is_some() {
            return run;
        }
    }
}
