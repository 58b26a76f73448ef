//! What a whole call of `sample` spends: the run, the report on it and the mesh over its particles,
//! each in processor time of one thread.
//!
//! `cargo bench -p benches --bench call -- 50000 9` samples an ellipsoid and a gyroid with 50,000
//! particles nine times and prints the medians, among them that of the ratio of the whole call to
//! the run alone. The feature `parallel` must be off, since only this thread is timed. Parts of one
//! round are timed one after the other in one process, so that other work on the machine disturbs
//! all alike. Without numbers it does 50,000 and a million; `ellipsoid` or `gyroid` among the
//! arguments chooses one of them.
#![allow(clippy::disallowed_methods, reason = "a bench measures time")]

use marching_particles::field::gallery;
use marching_particles::{Run, Settings};
use std::hint::black_box;
use std::time::Instant;

/// Processor time of this thread in seconds, or wall time if the system does not report it.
fn processor_seconds(start: Instant) -> f64 {
    std::fs::read_to_string("/proc/thread-self/schedstat")
        .ok()
        .and_then(|text| text.split(' ').next()?.parse::<f64>().ok())
        .map_or_else(|| start.elapsed().as_secs_f64(), |nanoseconds| nanoseconds * 1e-9)
}

/// Prints the medians over rounds of the time of each part, and of its ratio to the run.
fn parts(id: &str, count: u32, rounds: usize) {
    let surface = gallery::find(id).expect("a gallery surface");
    let settings = Settings::with_count(count).in_box(surface.bounds);
    let start = Instant::now();
    let mut times: Vec<[f64; 6]> = Vec::new();
    let mut particles = 0;
    for _ in 0..rounds {
        let mut clock = [processor_seconds(start); 4];
        let mut run = Run::start(surface.field(), &settings).expect("valid settings");
        while run.step(u32::MAX).stop_reason.is_none() {}
        clock[1] = processor_seconds(start);
        let sample = run.finish().expect("particles");
        clock[2] = processor_seconds(start);
        black_box(sample.mesh());
        clock[3] = processor_seconds(start);
        particles = sample.report().count;
        let [run, report, mesh] = [0, 1, 2].map(|k| clock[k + 1] - clock[k]);
        times.push([run, report, mesh, report / run, mesh / run, (run + report + mesh) / run]);
    }
    let [run, report, mesh, report_share, mesh_share, whole] = [0, 1, 2, 3, 4, 5].map(|k| {
        let mut column: Vec<f64> = times.iter().map(|row| row[k]).collect();
        column.sort_by(f64::total_cmp);
        column[column.len() / 2]
    });
    println!(
        "{id}, {particles}: run {:.1} ms, report {:.1} ms ({report_share:.2} of the run), mesh {:.1} ms \
         ({mesh_share:.2}); the whole call is {whole:.2} times the run",
        run * 1e3,
        report * 1e3,
        mesh * 1e3,
    );
}

fn main() {
    let numbers: Vec<u32> = std::env::args().filter_map(|argument| argument.parse().ok()).collect();
    let sizes = match numbers[..] {
        [count, rounds] => vec![(count, rounds)],
        [count] => vec![(count, 1)],
        _ => vec![(50_000, 9), (1_000_000, 3)],
    };
    let has_ids = std::env::args().any(|argument| gallery::find(&argument).is_some());
    for (count, rounds) in sizes {
        for id in ["ellipsoid", "gyroid"]
            .into_iter()
            .filter(|id| !has_ids || std::env::args().any(|argument| argument == *id))
        {
            parts(id, count, rounds as usize);
        }
    }
}
