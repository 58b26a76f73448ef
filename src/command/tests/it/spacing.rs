//! Spacing on the command line.

use crate::cli::{fails, file, run, sample, stdout};
use serde_json::Value;

fn sizes(run: &Value) -> [f64; 2] {
    ["radius_min", "radius_max"].map(|name| 2.0 * run[name].as_f64().expect("a size"))
}

#[test]
fn sizes_are_those_of_the_formula_and_reach_the_record() {
    let paths =
        ["spaced.ply", "spaced.csv"].map(|name| file(name).to_str().expect("a plain path").to_owned());
    let spacing = ["--spacing", "a + 0.04 z", "--spacing-min", "0.05", "--spacing-max", "0.13"];
    let surface = ["--formula", "x^2 + y^2 + z^2 = a/0.1", "--param", "a=0.1"];
    let made = sample(&[&surface[..], &spacing, &["--out", &paths[0], "--out", &paths[1]]].concat());
    let [smallest, largest] = sizes(&made);
    assert!((smallest - 0.06).abs() < 0.002 && (largest - 0.13).abs() < 0.002, "{smallest} to {largest}");
    assert_eq!(made["spacing"]["formula"], "a + 0.04 z");
    assert_eq!(made["settings"]["sampling"], "uniform");
    for path in &paths {
        let again = sample(&["--like", path]);
        assert_eq!((&again["digest"], &again["spacing"]), (&made["digest"], &made["spacing"]));
    }
    // A radius asks for one size, and another spacing takes the place of the file's.
    let one_size = sample(&["--like", &paths[0], "--radius", "0.1"]);
    assert_eq!((one_size["spacing"].is_null(), sizes(&one_size)[0]), (true, sizes(&one_size)[1]));
    let counted = sample(&["--like", &paths[0], "--count", "2000"]);
    let count = counted["count"].as_u64().expect("a number");
    assert!(count.abs_diff(2_000) <= 60, "{count}");
    let [smallest, largest] = sizes(&counted);
    assert!((largest / smallest - 0.13 / 0.06).abs() < 0.1, "{smallest} to {largest}");
}

#[test]
fn a_spacing_that_is_a_number_is_twice_the_radius() {
    let torus = ["--surface", "torus"];
    for (spacing, radius) in [("0.1", "0.05"), ("2%", "1%"), ("1/10", "0.05")] {
        let [spaced, even] =
            [["--spacing", spacing], ["--radius", radius]].map(|size| sample(&[&torus[..], &size].concat()));
        assert_eq!(spaced["digest"], even["digest"], "{spacing}");
    }
    let both =
        sample(&["--surface", "ellipsoid", "--adaptive", "--chord-error", "0.05%", "--spacing", "0.1"]);
    let alone = sample(&["--surface", "ellipsoid", "--adaptive", "--chord-error", "0.05%"]);
    assert!(
        sizes(&alone)[1] > 0.102 && sizes(&both)[1] <= 0.100_001,
        "{:?} {:?}",
        sizes(&alone),
        sizes(&both)
    );
}

#[test]
fn it_is_said_where_sizes_are_smoothed() {
    let run = sample(&["--surface", "sphere", "--spacing", "if(x > 0, 0.05, 0.3)", "--grading", "0.1"]);
    let told = run["warnings"].as_array().expect("a list").iter().find(|told| told["code"] == "smoothed");
    assert!(told.is_some_and(|told| told["severity"] == "note"), "{}", run["warnings"]);
}

#[test]
fn programs_have_the_spacing() {
    let printed = |language: &str| {
        let arguments = ["sample", "--formula", "x^2/b + y^2 + z^2 = 1", "--param", "b=2"];
        let spacing = ["--spacing", "0.1 b + 0.05 z", "--print", language];
        stdout(&run(&[&arguments[..], &spacing].concat()))
    };
    let rust = printed("rust");
    assert!(rust.contains(r#"let spacing = Spacing::parse("b = 2; 0.1 b + 0.05 z")?;"#), "{rust}");
    assert!(rust.contains("sample(surface, &settings.spaced(spacing))?"), "{rust}");
    for (language, words) in
        [("shell", "--spacing '0.1 b + 0.05 z'"), ("python", "spacing=\"0.1 b + 0.05 z\"")]
    {
        assert!(printed(language).contains(words), "{}", printed(language));
    }
}

#[test]
fn what_cannot_be_had_is_refused() {
    let of = |more: &[&str]| fails(2, &[&["sample", "--surface", "sphere"], more].concat());
    let message = of(&["--spacing", "0.1 + 0.05 q"]);
    assert!(message.contains("has no parameter `q`"), "{message}");
    assert!(message.contains("\n\n  0.1 + 0.05 q\n             ^"), "{message}");
    for (arguments, words) in [
        (&["--spacing", "0"][..], "must be positive"),
        (&["--spacing", "0.1", "--radius", "0.1"], "cannot be used with"),
        (&["--spacing", "0.1", "--count", "500"], "leave out --spacing"),
        (&["--spacing", "0.1", "--spacing-min", "0.05"], "without a formula"),
        (&["--spacing-min", "0.05"], "--spacing"),
        (&["--spacing", "2%", "--adaptive"], "not a share"),
        (&["--spacing", "0.1 z"], "must be above 0: change it, or give a smallest spacing (--spacing-min)"),
        (&["--spacing", "0.1 sqrt(z)"], "the spacing has no value at ("),
        (&["--spacing", "0.1 + z", "--spacing-min", "0.2", "--spacing-max", "0.1"], "--spacing-min is 0.2"),
        (&["--grading", "0.1"], "--grading has no effect without --adaptive or a --spacing by a formula"),
    ] {
        let message = of(arguments);
        assert!(message.contains(words), "{arguments:?}: {message}");
    }
}
