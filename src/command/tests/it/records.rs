//! Tests of `sample --like` on files that a program in Rust has saved.

use crate::cli::{fails, file, sample as command};
use marching_particles::export::RecordText;
use marching_particles::glam::DVec3;
use marching_particles::run::Value;
use marching_particles::{
    Bounds, Formula, GapPolicy, Pattern, Radius, Run, Sample, Settings, Spacing, gallery, offset, sample,
};
use std::f64::consts::PI;
use std::fs;
use std::path::Path;

fn formula(text: &str) -> Formula {
    Formula::parse(text).expect("a formula")
}

fn digest(sample: &Sample) -> String {
    format!("{:016x}", sample.particles().digest())
}

fn record_of(path: &Path) -> serde_json::Value {
    let json = RecordText::find(&fs::read(path).expect("a file")).expect("a record");
    serde_json::from_str(&json).expect("JSON")
}

/// Samples that a program makes, each with the arguments of the command that makes the same one.
fn samples() -> Vec<(Sample, Vec<&'static str>)> {
    let small = Settings::with_count(900);
    let of = |field: Formula, settings: &Settings| sample(field, settings).expect("particles");
    let cushion = formula("x^2 + |y|^k + z^2 = 0.3").with("k", 2.5).expect("a parameter");
    let gyroid = || gallery::find("gyroid").expect("a surface");
    let cell = formula("sin(x)cos(y) + sin(y)cos(z) + sin(z)cos(x)").repeated_in(&Bounds::cube(PI));
    let share = Settings::with_radius(Radius::Share(0.02));
    let egg = formula("x^2 + 2y^2 + z^2 = 1");
    let mut steps = small.seeded(7).refined();
    (steps.relax_steps, steps.gaps) = (3, GapPolicy::Leave);
    let mut spaced = sample(
        &egg,
        &Settings::default().spaced(Spacing::parse("0.1 + 0.2 z").expect("a formula").at_least(0.08)),
    )
    .expect("particles");
    spaced.add_value(&egg, "H", &Value::parse("(k_1 + k_2)/2").expect("a formula")).expect("values");
    spaced.add_value(&egg, "own", &Value::by(|p: DVec3| p.x)).expect("values");
    vec![
        (
            of(
                cushion.closed_by(&Bounds::cube(0.4)),
                &Settings::with_radius(Radius::Length(0.021)).seeded(4),
            ),
            vec![
                "x^2 + |y|^k + z^2 = 0.3",
                "--param",
                "k=2.5",
                "--closed",
                "--box",
                "0.4",
                "--radius",
                "0.021",
                "--seed",
                "4",
            ],
        ),
        (of(formula("x^4 + y^4 + z^4 = 1"), &small), vec!["x^4 + y^4 + z^4 = 1", "--count", "900"]),
        (
            of(formula("max(|x|, |y|, |z|) = 1"), &steps),
            vec![
                "max(|x|, |y|, |z|) = 1",
                "--count",
                "900",
                "--seed",
                "7",
                "--method",
                "refined",
                "--relax",
                "3",
                "--gaps",
                "leave",
            ],
        ),
        (
            of(formula("x^2 + y^2 + z^2 = 1"), &small.with_pattern(Pattern::Blue)),
            vec!["x^2 + y^2 + z^2 = 1", "--count", "900", "--pattern", "blue"],
        ),
        (of(egg.clone(), &small.adaptive()), vec!["x^2 + 2y^2 + z^2 = 1", "--count", "900", "--adaptive"]),
        (
            spaced,
            vec![
                "x^2 + 2y^2 + z^2 = 1",
                "--spacing",
                "0.1 + 0.2 z",
                "--spacing-min",
                "0.08",
                "--value",
                "H=(k_1 + k_2)/2",
            ],
        ),
        (
            of(cell, &share),
            vec![
                "sin(x)cos(y) + sin(y)cos(z) + sin(z)cos(x)",
                "--box",
                "3.141592653589793",
                "--closed",
                "--periodic",
                "--radius",
                "2%",
            ],
        ),
        (of(gyroid().field().thickened(0.6), &share), vec!["gyroid", "--thickness", "0.6", "--radius", "2%"]),
    ]
}

#[test]
fn the_command_repeats_what_a_program_in_rust_has_saved() {
    for (number, (sample, arguments)) in samples().into_iter().enumerate() {
        let of_program = file(&format!("program-{number}.ply"));
        let of_command = file(&format!("command-{number}.ply"));
        sample.save(&of_program).expect("a file");
        let [path, other] = [&of_program, &of_command].map(|path| path.to_str().expect("a plain path"));
        let made = command(&[&arguments[..], &["--out", other]].concat());
        assert_eq!(made["digest"], digest(&sample), "{arguments:?}");
        assert_eq!(command(&["--like", path])["digest"], digest(&sample), "{arguments:?}");
        assert_eq!(record_of(&of_program), record_of(&of_command), "{arguments:?}");
    }
}

#[test]
fn a_length_stays_a_length_in_the_record_and_what_is_given_beside_it_replaces_it() {
    let sphere = ["x^2 + y^2 + z^2 = 1", "--box", "1.25"];
    let sized = |name: &str, size: [&str; 2]| {
        let path = file(name).to_str().expect("a plain path").to_owned();
        (command(&[&sphere[..], &size, &["--out", &path]].concat()), path)
    };
    let (by_length, length) = sized("length.ply", ["--spacing", "0.16"]);
    assert_eq!(record_of(length.as_ref())["settings"]["radius"], 0.08);
    let (by_count, count) = sized("count.ply", ["--count", "700"]);
    let (by_share, _) = sized("share.ply", ["--radius", "3%"]);
    for (like, size, made) in [
        (&length, ["--radius", "3%"], &by_share),
        (&length, ["--count", "700"], &by_count),
        (&count, ["--spacing", "0.16"], &by_length),
        (&count, ["--spacing", "6%"], &by_share),
        (&count, ["--radius", "0.08"], &by_length),
    ] {
        let again = command(&[&["--like", like][..], &size].concat());
        assert_eq!(again["digest"], made["digest"], "{size:?} beside {like}");
    }
    for sizes in [&["--spacing", "0.1 + 0.02 z"][..], &["--adaptive", "--chord-error", "0.05%"]] {
        let varying = command(&[&["--like", &length][..], sizes].concat());
        assert!(varying["radius_min"].as_f64() < varying["radius_max"].as_f64(), "{sizes:?}");
    }
}

#[test]
fn a_record_of_former_versions_is_repeated() {
    // Lengths were shares of the diagonal, and there was room for 200,000 particles.
    let record = serde_json::json!({
        "version": "0.1.0", "digest": "", "formula": "x^2 + y^2 + z^2 = 1",
        "bounds": { "min": [-1.25, -1.25, -1.25], "max": [1.25, 1.25, 1.25] },
        "settings": { "radius_share": 0.08 / (2.5 * 3_f64.sqrt()), "max_particles": 200_000 },
    });
    let path = file("former.json");
    let document = RecordText::new(&record.to_string()).document().expect("a record");
    fs::write(&path, document).expect("a file");
    let again = command(&["--like", path.to_str().expect("a plain path")]);
    let now = command(&["x^2 + y^2 + z^2 = 1", "--box", "1.25", "--radius", "0.08"]);
    assert_eq!(again["count"], now["count"]);
    assert_eq!(again["settings"]["max_particles"], 200_000);
}

#[test]
fn every_format_that_can_holds_the_record() {
    let made = sample(formula("x^2 + y^2 + z^2 = 1"), &Settings::with_count(500)).expect("particles");
    let json = RecordText::find(made.record().document().expect("a record").as_bytes()).expect("a record");
    for name in ["record.ply", "record.csv", "record.glb", "record.3mf", "record.obj"] {
        let path = file(name);
        made.save(&path).expect("a file");
        let path = if name.ends_with(".csv") { file("record.csv.json") } else { path };
        assert_eq!(
            record_of(&path),
            serde_json::from_str::<serde_json::Value>(&json).expect("JSON"),
            "{name}"
        );
    }
    let mesh = file("record-mesh.ply");
    made.save_mesh(&mesh).expect("a file");
    assert_eq!(record_of(&mesh)["digest"], digest(&made));
}

#[test]
fn what_no_record_can_hold_has_none() {
    let small = Settings::with_count(500).in_box(Bounds::cube(1.5));
    let ball = |p: DVec3| p.length() - 1.0;
    let sphere = formula("x^2 + y^2 + z^2 = 1");
    let spacing = Spacing::by(|p: DVec3| 0.2 + 0.05 * p.z);
    let mut run = Run::start(sphere.clone(), &small).expect("a run");
    while run.step(u32::MAX).stop_reason.is_none() {}
    run.follow(formula("x^2 + y^2 + z^2 = 1.01")).expect("a small motion");
    while run.step(u32::MAX).stop_reason.is_none() {}
    let moved = run.finish().expect("particles");
    for (made, name) in [
        (sample(ball, &small).expect("particles"), "closure"),
        (sample(&sphere, &small.spaced(spacing)).expect("particles"), "spacing"),
        (sample(offset(sphere, 0.1), &small).expect("particles"), "offset"),
        (moved, "moved"),
    ] {
        assert_eq!(made.record(), RecordText::default(), "{name}");
        let path = file(&format!("{name}.ply"));
        made.save(&path).expect("a file");
        let path = path.to_str().expect("a plain path");
        let message = fails(2, &["sample", "--like", path]);
        assert!(message.contains("does not say what it was made from"), "{name}: {message}");
        let table = file(&format!("{name}.csv"));
        made.save(&table).expect("a file");
        assert!(!file(&format!("{name}.csv.json")).exists(), "{name}");
    }
}
