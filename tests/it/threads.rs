//! The number of threads changes nothing but the time.

use crate::cli::{file, sample};
use serde_json::Value;

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
