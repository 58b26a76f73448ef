//! Benchmark of whole runs and their phases on the ellipsoid with semi-axes 1, 0.7 and 0.5, beside
//! a mesher.
//!
//! `cargo bench -p benches --bench whole -- quick` runs the sizes of the paper's smaller tables,
//! `-- full` runs a million particles, and without an argument both run. Each ends with three
//! measurements:
//!
//! * the ratio of the whole run to naive surface nets (`fast-surface-nets`) with as many vertices
//!   on the same field, timed alternately so that a busy machine disturbs both alike;
//! * the share of the run that the search for all components takes;
//! * the whole run on the bunny of 200 points, uniform and adaptive, alternating with the uniform
//!   one on the ellipsoid.
#![allow(clippy::disallowed_methods, reason = "a bench measures time")]
#![allow(missing_docs, reason = "the macros' items have none")]

#[path = "../tests/it/settings.rs"]
#[macro_use]
mod settings;

use criterion::{BatchSize, Criterion, Throughput, criterion_group};
use fast_surface_nets::ndshape::{RuntimeShape, Shape};
use fast_surface_nets::{SurfaceNetsBuffer, surface_nets};
use glam::Vec3;
use marching_particles::Bounds;
use marching_particles::field::formula::Formula;
use marching_particles::field::rbf::RbfField;
use marching_particles::field::{Field, gallery, model};
use marching_particles::pointcloud::fit_model;
use marching_particles::quality::{MeasureOptions, measure};
use marching_particles::sampler::Phase;
use marching_particles::{Radius, Run, Sampling, Settings, SizeMode, StopReason};
use std::hint::black_box;
use std::time::{Duration, Instant};

/// Numbers of particles of the quick set, which are those of the paper's uniform ellipsoids.
const QUICK: [u32; 2] = [13_923, 55_748];
const FULL: u32 = 1_000_000;
/// Half-widths of the ellipsoid.
const HALF: [f32; 3] = [1.0, 0.7, 0.5];

struct Job {
    field: Formula,
    bounds: Bounds,
    settings: Settings,
}

impl Job {
    /// Job whose radius gives about `count` particles. A run that meets the count finds the radius,
    /// so that the timed runs do the front once.
    fn new(count: u32) -> Self {
        let surface = gallery::find("ellipsoid").expect("the gallery has the ellipsoid");
        let by_count = settings!(size_mode: SizeMode::Count,
            count,
            relax_steps: 0,
            max_particles: count + count / 10; ..Settings::default());
        let mut job = Self { field: surface.field(), bounds: surface.bounds, settings: by_count };
        let found = job.run();
        let radius_share = radius(&found) / job.bounds.diagonal();
        job.settings = settings!(size_mode: SizeMode::Radius, radius_share, relax_steps: 10; ..by_count);
        job
    }

    fn run(&self) -> Run<'static, Formula> {
        finished(self.field.clone(), &self.settings.in_box(self.bounds))
    }
}

/// A run to its end.
fn finished<'f, F: Field + 'f>(field: F, settings: &Settings) -> Run<'f, F> {
    let mut run = Run::start(field, settings).expect("valid settings");
    finish(&mut run);
    run
}

/// Radius of a run that has ended.
fn radius<'f, F: Field + 'f>(run: &Run<'f, F>) -> f64 {
    run.progress().expect("it has ended").radius
}

fn finish<'f, F: Field + 'f>(run: &mut Run<'f, F>) {
    let reason = loop {
        if let Some(reason) = run.step(65_536).stop_reason {
            break reason;
        }
    };
    assert_eq!(reason, StopReason::Complete);
}

/// A mesher, which samples the field on a grid with the same batched evaluation and extracts the
/// surface.
struct Mesher {
    field: Formula,
    shape: RuntimeShape<u32, 3>,
    size: [u32; 3],
    step: f32,
    points: Vec<Vec3>,
    values: Vec<f32>,
    buffer: SurfaceNetsBuffer,
}

impl Mesher {
    /// Mesher with a grid on the ellipsoid's box, one cell wider, with `resolution` cells along x.
    fn new(resolution: u32) -> Self {
        let step = 2.0 * HALF[0] / resolution as f32;
        let size = HALF.map(|half| (2.0 * half / step).ceil() as u32 + 3);
        let shape = RuntimeShape::<u32, 3>::new(size);
        Self {
            field: gallery::find("ellipsoid").expect("the gallery has the ellipsoid").field(),
            points: vec![Vec3::ZERO; size[0] as usize],
            values: vec![0.0; shape.usize()],
            shape,
            size,
            step,
            buffer: SurfaceNetsBuffer::default(),
        }
    }

    /// Mesher with about `count` vertices.
    fn with_vertices(count: u32) -> Self {
        // The number of vertices grows with the square of the resolution.
        let mut resolution = 100.0;
        for _ in 0..4 {
            let found = Self::new(resolution as u32).run();
            resolution *= (f64::from(count) / found as f64).sqrt();
        }
        Self::new(resolution.round() as u32)
    }

    /// Evaluates, extracts, and counts the vertices.
    fn run(&mut self) -> usize {
        let [nx, ny, nz] = self.size;
        let place = |k: u32, half: f32| (k as f32 - 1.0) * self.step - half;
        let mut field = self.field.evaluator(marching_particles::field::Frame::default());
        for (row, values) in self.values.chunks_exact_mut(nx as usize).enumerate() {
            let (y, z) = (place(row as u32 % ny, HALF[1]), place(row as u32 / ny, HALF[2]));
            for (i, point) in self.points.iter_mut().enumerate() {
                *point = Vec3::new(place(i as u32, HALF[0]), y, z);
            }
            field.values(&self.points, values);
        }
        surface_nets(&self.values, &self.shape, [0; 3], [nx - 1, ny - 1, nz - 1], &mut self.buffer);
        self.buffer.positions.len()
    }
}

fn parts(criterion: &mut Criterion, set: &str, count: u32) {
    let mut group = criterion.benchmark_group(format!("{set}/{count}"));
    group.sample_size(10).warm_up_time(Duration::from_millis(500));
    let mut job = Job::new(count);
    let sampled = job.run();
    let particles = sampled.particles();
    group.throughput(Throughput::Elements(particles.len() as u64));

    let whole = job.settings;
    job.settings.relax_steps = 0;
    group.bench_function("front", |bencher| bencher.iter(|| black_box(job.run())));
    group.bench_function("ten relaxation steps", |bencher| {
        bencher.iter_batched(
            || job.run(),
            |mut run| {
                assert!(run.relax(10));
                finish(&mut run);
                run
            },
            BatchSize::PerIteration,
        );
    });
    job.settings = whole;
    group.bench_function("whole job", |bencher| bencher.iter(|| black_box(job.run())));
    job.settings = settings!(size_mode: SizeMode::Count; ..whole);
    group.bench_function("whole job by count", |bencher| bencher.iter(|| black_box(job.run())));
    let options = MeasureOptions::default();
    group.bench_function("quality", |bencher| {
        let (field, bounds) = (&mut job.field, &job.bounds);
        bencher.iter(|| measure(&particles.local, &particles.normal, field, Some(bounds), &options));
    });
    let mut mesher = Mesher::with_vertices(count);
    group.bench_function("surface nets", |bencher| bencher.iter(|| mesher.run()));
    group.finish();
}

fn quick(criterion: &mut Criterion) {
    for count in QUICK {
        parts(criterion, "quick", count);
    }
}

fn full(criterion: &mut Criterion) {
    // Setting the job up takes seconds, so it is skipped if the benchmark is filtered out.
    if !std::env::args().any(|argument| argument == "quick") {
        parts(criterion, "full", FULL);
    }
}

/// Processor time of this thread in seconds, so that other work on the machine does not count, or
/// wall time if the system does not report it.
fn processor_seconds(start: Instant) -> f64 {
    std::fs::read_to_string("/proc/thread-self/schedstat")
        .ok()
        .and_then(|text| text.split(' ').next()?.parse::<f64>().ok())
        .map_or_else(|| start.elapsed().as_secs_f64(), |nanoseconds| nanoseconds * 1e-9)
}

/// Prints the medians over rounds of the processor time of the front, the whole job and the mesher,
/// and of the ratio of the last two.
fn ratio(count: u32, rounds: usize) {
    /// Number of runs of the mesher in a round. The system counts time in ticks of a few
    /// milliseconds.
    const REPEAT: u32 = 8;
    let job = Job::new(count);
    let mut front = Job::new(count);
    front.settings.relax_steps = 0;
    let mut mesher = Mesher::with_vertices(count);
    let start = Instant::now();
    let mut times: Vec<[f64; 4]> = Vec::new();
    let (mut particles, mut vertices) = (0, 0);
    for _ in 0..rounds {
        let mut clock = [0.0_f64; 4];
        clock[0] = processor_seconds(start);
        black_box(front.run());
        clock[1] = processor_seconds(start);
        particles = black_box(job.run()).particles().len();
        clock[2] = processor_seconds(start);
        for _ in 0..REPEAT {
            vertices = black_box(mesher.run());
        }
        clock[3] = processor_seconds(start);
        let whole = clock[2] - clock[1];
        let mesh = (clock[3] - clock[2]) / f64::from(REPEAT);
        times.push([clock[1] - clock[0], whole, mesh, whole / mesh]);
    }
    let [front, whole, mesh, ratio] = [0, 1, 2, 3].map(|k| median(&times, k));
    let each = |seconds: f64| seconds * 1e6 / particles as f64;
    println!(
        "{count}: whole job {:.1} ms, {:.2} µs for each of {particles} particles (front {:.2}, relaxation {:.2}); \
         surface nets {:.2} ms for {vertices} vertices; ratio {ratio:.1}",
        whole * 1e3,
        each(whole),
        each(front),
        each(whole - front),
        mesh * 1e3
    );
}

/// Prints the share of a run of `count` particles that finding a first point on every component
/// takes: the survey, the proof, and the check of every candidate.
fn search_share(id: &str, count: u32, rounds: usize) {
    let surface = gallery::find(id).expect("a gallery surface");
    let mut settings =
        settings!(size_mode: SizeMode::Count, count; ..Settings::default()).in_box(surface.bounds);
    let mut shares: Vec<[f64; 3]> = Vec::new();
    let mut cells = None;
    for round in 0..=rounds {
        let field = surface.field();
        let start = Instant::now();
        let mut run = Run::start(field, &settings).expect("valid settings");
        let surveyed = start.elapsed().as_secs_f64();
        let (mut seeding, mut phase) = (0.0, Phase::Seeding);
        let reason = loop {
            let before = start.elapsed().as_secs_f64();
            // The steps are small, so that hardly any work of the front is included.
            let is_seeding = matches!(phase, Phase::Seeding | Phase::Search);
            let progress = run.step(if is_seeding { 64 } else { 4_096 });
            if is_seeding {
                seeding += start.elapsed().as_secs_f64() - before;
            }
            phase = progress.phase;
            if let Some(reason) = progress.stop_reason {
                break reason;
            }
        };
        assert_eq!(reason, StopReason::Complete);
        let whole = start.elapsed().as_secs_f64();
        if round == 0 {
            // A wanted count runs the front twice; from here on the radius is given, and it runs
            // once.
            let radius_share = radius(&run) / surface.bounds.diagonal();
            settings = Settings::with_radius(Radius::Share(radius_share)).in_box(surface.bounds);
        } else {
            shares.push([surveyed, seeding, (surveyed + seeding) / whole]);
            cells = run.sampler().undecided_cells();
        }
    }
    let [survey, seeding, share] = [0, 1, 2].map(|k| median(&shares, k));
    println!(
        "{id}, {count}: finding every piece takes {:.1} % of the job (survey {:.2} ms, proof and cover {:.2} ms), \
         undecided cells {cells:?}",
        share * 100.0,
        survey * 1e3,
        seeding * 1e3
    );
}

/// Prints the time per particle of a whole run on the bunny, for the first run, which makes the
/// field's cells, and for later ones. They alternate with the uniform run on the ellipsoid, which
/// shows how busy the machine is.
fn bunny(count: u32, rounds: usize) {
    let model = model::find("bunny").expect("the bunny is a model");
    let fit = fit_model(model);
    let mut field = RbfField::new(fit.data.clone()).expect("a field");
    let ellipsoid = Job::new(count);
    for sampling in [Sampling::Uniform, Sampling::Adaptive] {
        let by_count = settings!(size_mode: SizeMode::Count, count, relax_steps: 0; ..Settings::default());
        let start = Instant::now();
        let run = |field: &mut RbfField, settings: &Settings| {
            let before = processor_seconds(start);
            let run = finished(field, &settings.in_box(fit.bounds));
            (processor_seconds(start) - before, radius(&run), run.count())
        };
        let settings = if sampling == Sampling::Uniform {
            // A run that meets a count does the front twice, so the timed runs are given the
            // radius.
            let radius_share = run(&mut field, &by_count).1 / fit.bounds.diagonal();
            settings!(radius_share; ..Settings::default())
        } else {
            settings!(sampling; ..Settings::default())
        };
        let mut times: Vec<[f64; 3]> = Vec::new();
        let mut particles = 0;
        for _ in 0..rounds {
            let mut cold = RbfField::new(fit.data.clone()).expect("a field");
            let (first, ..) = run(&mut cold, &settings);
            let (again, _, count) = run(&mut field, &settings);
            let before = processor_seconds(start);
            let other = black_box(ellipsoid.run()).particles().len();
            let other = (processor_seconds(start) - before) / other as f64;
            particles = count;
            times.push([first / particles as f64, again / particles as f64, other]);
        }
        let [first, again, other] = [0, 1, 2].map(|k| median(&times, k) * 1e6);
        println!(
            "bunny, {sampling:?}: {again:.2} µs for each of {particles} particles, {first:.2} in the first run; \
             the ellipsoid {other:.2}"
        );
    }
}

/// Median of a column.
fn median<const N: usize>(rows: &[[f64; N]], k: usize) -> f64 {
    let mut column: Vec<f64> = rows.iter().map(|row| row[k]).collect();
    column.sort_by(f64::total_cmp);
    column[column.len() / 2]
}

criterion_group!(sets, quick, full);

fn main() {
    sets();
    for count in QUICK {
        ratio(count, 15);
    }
    for id in ["ellipsoid", "torus", "tanglecube"] {
        search_share(id, 50_000, 9);
    }
    bunny(QUICK[1], 5);
    Criterion::default().configure_from_args().final_summary();
}
