//! What more threads save.
//!
//! `cargo bench -p benches --features parallel --bench threads -- 2 5` does a few whole calls with
//! one thread and with two, five times each, and prints the medians of the seconds and how many
//! times as fast the call was. Without numbers it does 1, 2, 4, … threads up to the processors of
//! the machine, three times each. Other work on the machine disturbs it: it is wall time.
#![allow(clippy::disallowed_methods, reason = "a bench measures time")]

use marching_particles::field::gallery;
use marching_particles::{Method, Settings, fit_points, sample};
use std::hint::black_box;
use std::time::Instant;

/// A call to be timed.
type Job<'a> = (&'static str, Box<dyn Fn() + Sync + 'a>);

/// A call of `sample` and the mesh over its particles.
fn whole(id: &str, method: Method, count: u32) {
    let surface = gallery::find(id).expect("a gallery surface");
    let mut settings = Settings::with_count(count).in_box(surface.bounds);
    settings.method = method;
    black_box(sample(surface.field(), &settings).expect("particles").mesh());
}

/// Points of the tanglecube as lines of text.
fn points() -> Vec<u8> {
    let surface = gallery::find("tanglecube").expect("a gallery surface");
    let settings = Settings::with_count(5_000).in_box(surface.bounds);
    let sample = sample(surface.field(), &settings).expect("particles");
    sample.positions().iter().map(|[x, y, z]| format!("{x} {y} {z}\n")).collect::<String>().into_bytes()
}

fn main() {
    let numbers: Vec<usize> = std::env::args().filter_map(|argument| argument.parse().ok()).collect();
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    let (counts, rounds) = match numbers[..] {
        [threads, rounds] => (vec![1, threads], rounds),
        _ => (std::iter::successors(Some(1), |n| Some(2 * n)).take_while(|&n| n <= processors).collect(), 3),
    };
    let cloud = points();
    let jobs: [Job<'_>; 4] = [
        ("ellipsoid, 50,000 particles of a front", Box::new(|| whole("ellipsoid", Method::Front, 50_000))),
        ("gyroid, 50,000 refined particles", Box::new(|| whole("gyroid", Method::Refined, 50_000))),
        (
            "ellipsoid, 1,000,000 particles of a front",
            Box::new(|| whole("ellipsoid", Method::Front, 1_000_000)),
        ),
        (
            "5,000 points, a fit of 800 centres",
            Box::new(|| drop(black_box(fit_points("tanglecube.xyz", cloud.clone(), 800)))),
        ),
    ];
    for (name, job) in &jobs {
        let mut seconds = vec![Vec::new(); counts.len()];
        // Numbers of threads take turns, so that other work on the machine disturbs all alike.
        for _ in 0..rounds {
            for (&threads, seconds) in counts.iter().zip(&mut seconds) {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
                let start = Instant::now();
                pool.install(job);
                seconds.push(start.elapsed().as_secs_f64());
            }
        }
        let median = |seconds: &mut Vec<f64>| {
            seconds.sort_by(f64::total_cmp);
            seconds[seconds.len() / 2]
        };
        let medians: Vec<f64> = seconds.iter_mut().map(median).collect();
        println!("{name}");
        for (threads, seconds) in counts.iter().zip(&medians) {
            println!("  {threads} threads: {seconds:.3} s, {:.2} times as fast", medians[0] / seconds);
        }
    }
}
