//! Tests of the command that moves a surface.

use crate::cli::{fails, file, run, stderr, stdout};
use std::path::PathBuf;

/// The lines of a CSV file without its head, each with the values of two columns.
fn columns_of(text: &str, names: [&str; 2]) -> Vec<[String; 2]> {
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let head: Vec<&str> = lines.next().expect("a head").split(',').collect();
    let at = names.map(|name| head.iter().position(|column| *column == name).expect(name));
    lines
        .map(|line| {
            let values: Vec<&str> = line.split(',').collect();
            at.map(|k| values[k].to_owned())
        })
        .collect()
}

/// An empty folder for frames.
fn folder(name: &str) -> PathBuf {
    let directory = file(name);
    let _ = std::fs::remove_dir_all(&directory);
    directory
}

#[test]
fn a_sweep_writes_a_file_for_each_frame_with_particles_that_are_known_by_their_numbers() {
    let directory = folder("frames");
    let formula = "x^2/q^2 + y^2/0.49 + z^2/0.25 = 1";
    let path = directory.to_str().expect("a path");
    let output = run(&[
        "sweep",
        "--formula",
        formula,
        "--sweep",
        "q=1..1.2",
        "--frames",
        "10",
        "--count",
        "800",
        "--format",
        "csv",
        "--out",
        path,
    ]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(stdout(&output).starts_with("11 files in "), "{}", stdout(&output));
    let frame = |k: usize| {
        let text = std::fs::read_to_string(directory.join(format!("{k:02}.csv"))).expect("a file");
        columns_of(&text, ["identity", "level"])
    };
    let (first, last) = (frame(0), frame(10));
    assert!(first.iter().enumerate().all(|(i, [identity, _])| *identity == i.to_string()));
    let kept = last.iter().filter(|&row| first.contains(row)).count();
    assert!(kept > 700, "{kept} of {} particles are those of the first frame, with their levels", last.len());
    // Where no particle can follow another run begins, with other numbers.
    let output = run(&[
        "sweep",
        "--formula",
        "(x-q)^2 + y^2 + z^2 = 0.25",
        "--sweep",
        "q=-3..3",
        "--frames",
        "2",
        "--count",
        "300",
        "--format",
        "csv",
        "--out",
        path,
    ]);
    let said = "of 3 runs; in frame 1 the second begins: 100 % of the particles, first near (";
    assert!(stdout(&output).contains(said), "{}{}", stdout(&output), stderr(&output));
    let identity = |name: &str| {
        let text = std::fs::read_to_string(directory.join(name)).expect("a file");
        columns_of(&text, ["identity", "level"])[0][0].clone()
    };
    assert_ne!(identity("0.csv"), identity("1.csv"));
    let message = fails(2, &["sweep", "--formula", "x^2+y^2+z^2=q", "--sweep", "a=1..2", "--out", path]);
    assert!(message.contains('a'), "{message}");
    fails(2, &["sweep", "--formula", "x^2+y^2+z^2=q", "--sweep", "q=1", "--out", path]);
}

#[test]
fn a_particle_on_an_edge_has_one_number() {
    let directory = folder("edges");
    let path = directory.to_str().expect("a path");
    let cube = ["sweep", "--formula", "max(|x|, |y|, |z|) = q", "--sweep", "q=1..1.1", "--frames", "1"];
    let output = run(&[&cube[..], &["--count", "500", "--format", "csv", "--out", path]].concat());
    let mut particles = 0;
    for name in ["0.csv", "1.csv"] {
        let text = std::fs::read_to_string(directory.join(name)).expect("a file");
        let rows = columns_of(&text, ["identity", "particle"]);
        let distinct = |column: usize| {
            let mut all: Vec<&str> = rows.iter().map(|row| &*row[column]).collect();
            all.sort_unstable();
            all.dedup();
            all.len()
        };
        let mut pairs = rows.clone();
        pairs.sort_unstable();
        pairs.dedup();
        assert!(pairs.len() < rows.len(), "particles on edges have several rows");
        assert_eq!([distinct(0), distinct(1)], [pairs.len(); 2]);
        particles += pairs.len();
    }
    assert!(stdout(&output).contains(&format!("particles, {particles} in all")), "{}", stdout(&output));
}

#[test]
fn frames_without_a_surface_and_at_the_limit_are_told() {
    let directory = folder("told");
    let path = directory.to_str().expect("a path");
    let ball = ["sweep", "--formula", "x^2 + y^2 + z^2 = q", "--frames", "2", "--out", path, "--quiet"];
    let swept = |more: &[&str]| {
        let output = run(&[&ball[..], more].concat());
        (output.status.code(), stderr(&output))
    };
    let (code, message) = swept(&["--sweep", "q=-1..1", "--count", "300"]);
    assert_eq!((code, &*message), (Some(0), "warning: there is no surface in 2 of 3 frames\n"));
    let (code, message) = swept(&["--sweep", "q=1..1.1", "--radius", "1%", "--max-particles", "100"]);
    assert!(code == Some(4) && message.starts_with("warning: 3 of 3 frames stopped"), "{message}");
    let (code, message) = swept(&["--sweep", "q=-2..-1", "--count", "300"]);
    assert!(code == Some(3) && message.contains("no surface in any frame"), "{code:?} {message}");
}
