//! Tests of `--value`, and of what a first try of the command meets.

use crate::cli::{fails, file, sample};

#[test]
fn a_file_repeats_the_values_of_the_run_that_wrote_it() {
    let [first, again] = ["values.ply", "values-again.ply"].map(|name| file(name).display().to_string());
    let torus = ["--surface", "torus", "--count", "300"];
    let values = ["--value", "H=(k_1+k_2)/2", "--value", "share=z/r"];
    sample(&[&torus[..], &values, &["--out", &first]].concat());
    sample(&["--like", &first, "--value", "share=1", "--value", "more=x", "--out", &again]);
    let columns = |path: &str| {
        let bytes = std::fs::read(path).expect("a file");
        let head = String::from_utf8_lossy(&bytes).into_owned();
        let (head, _) = head.split_once("end_header").expect("the end of the head");
        let names = head.lines().filter_map(|line| line.strip_prefix("property float "));
        names.filter(|name| ["H", "share", "more"].contains(name)).map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(columns(&first), ["H", "share"]);
    assert_eq!(columns(&again), ["H", "share", "more"]);
    // With another surface only the settings are taken from it.
    sample(&["--like", &again, "--surface", "sphere", "--out", &first]);
    assert_eq!(columns(&first), [] as [&str; 0]);
}

#[test]
fn a_surface_without_a_command_and_a_range_without_a_sweep_are_told_where_they_belong() {
    let message = fails(2, &["x^2 + y^2 + z^2 = 1"]);
    assert!(message.ends_with("a surface follows a command: sample \"x^2 + y^2 + z^2 = 1\"\n"), "{message}");
    let message = fails(2, &["sweep", "torus", "--param", "r=0.2..0.5"]);
    assert!(message.contains("takes --sweep r=0.2..0.5"), "{message}");
}
