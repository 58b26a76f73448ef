//! The number of threads changes nothing but the time.

use crate::cli::{file, sample};
use marching_particles::{Formula, Run, Sample, Settings};
use serde_json::Value;
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

/// All that is said of a sample but the seconds, the memory and the files' names, and its mesh.
fn told(threads: &str, arguments: &[&str]) -> (Value, Vec<u8>) {
    let mesh = file(&format!("threads-{threads}.ply"));
    let path = mesh.to_str().expect("a path of letters");
    let mut said = sample(&[&["--threads", threads, "--mesh", path], arguments].concat());
    let all = said.as_object_mut().expect("an object");
    for own in ["seconds", "peak_mb", "peak_sampling_mb", "files"] {
        assert!(all.remove(own).is_some(), "{own}");
    }
    (said, std::fs::read(mesh).expect("a mesh"))
}

#[test]
fn any_number_of_threads_gives_the_same_sample_report_and_mesh() {
    let points = file("threads.xyz");
    let points = points.to_str().expect("a path of letters");
    sample(&["--surface", "bunny", "--count", "1500", "--report", "none", "--out", points]);
    for arguments in [
        &["--surface", "gyroid", "--count", "4000", "--report", "full"][..],
        &["--surface", "ellipsoid", "--adaptive", "--count", "3000"],
        &["--formula", "max(hypot(x,y,z)-1, abs(z)-0.4)", "--count", "3000"],
        &["--points", points, "--centres", "150", "--count", "2000"],
    ] {
        let one = told("1", arguments);
        for threads in ["2", "3", "16"] {
            assert!(told(threads, arguments) == one, "{threads} threads: {arguments:?}");
        }
    }
}

/// A sample that was not measured, so that its mesh finds the natural neighbours.
fn unmeasured() -> Sample {
    let sphere = Formula::parse("x^2 + y^2 + z^2 = 1").expect("a formula");
    let mut run = Run::start(sphere, &Settings::with_count(20_000)).expect("a run");
    while run.step(u32::MAX).stop_reason.is_none() {}
    run.finish_with(marching_particles::run::Measured::Nothing).expect("particles")
}

#[test]
fn jobs_of_one_pool_may_all_ask_for_one_mesh() {
    let (told, heard) = mpsc::channel();
    // In a thread of its own: a job that waits for itself would never end.
    thread::spawn(move || {
        let unmeasured = unmeasured();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().expect("threads");
        for _ in 0..10 {
            let sample = unmeasured.clone();
            // Whichever of the two threads that make the mesh is the first to have nothing to do
            // takes the second job.
            pool.in_place_scope(|scope| {
                for _ in 0..2 {
                    scope.spawn(|_| assert!(sample.mesh().topology.is_closed()));
                    thread::sleep(Duration::from_millis(3));
                }
            });
        }
        let _ = told.send(());
    });
    heard.recv_timeout(Duration::from_secs(120)).expect("no job waits for itself");
}
