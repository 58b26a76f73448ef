//! Triangle meshes, sampled anew.

use crate::cli::{fails, file, run, sample, stdout};
use std::fs;

/// Writes a box of the sides 1, 2 and 3 as OBJ, with quadrangles, of which the last one is left out
/// if it `is_open`.
fn cuboid(name: &str, is_open: bool) -> String {
    let mut text = String::new();
    for k in 0..8 {
        text += &format!("v {} {} {}\n", k & 1, 2 * (k >> 1 & 1), 3 * (k >> 2));
    }
    text += "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\n";
    if !is_open {
        text += "f 2 4 8 6\n";
    }
    let path = file(name);
    fs::write(&path, text).expect("written");
    path.display().to_string()
}

#[test]
fn a_mesh_is_sampled_anew_and_compared_with_the_new_one() {
    let (path, new) = (cuboid("box.obj", false), file("new.stl").display().to_string());
    let run_of = sample(&["--mesh-in", &path, "--count", "1500", "--mesh", &new]);
    let remesh = &run_of["remesh"];
    assert_eq!((&remesh["faces"], &remesh["vertices"]), (&12.into(), &8.into()));
    assert_eq!(run_of["creases"], 12);
    let edges = remesh["change"]["edges"].as_f64().expect("a distance");
    assert!(edges < 1e-6, "{edges}");
    assert!((run_of["mesh"]["volume"].as_f64().expect("a volume") - 6.0).abs() < 1e-6);
    let text = stdout(&run(&["sample", "--mesh-in", &path, "--count", "500"]));
    assert!(
        text.starts_with("mesh: box.obj\n12 faces with 8 vertices in 1 piece\na part with edges: 6 patches"),
        "{text}"
    );
    assert!(text.contains("distance of the old mesh from the new one: mean "), "{text}");
    assert!(text.contains("volume 6 → 6 ("), "{text}");
}

#[test]
fn a_mesh_is_an_operand_of_a_formula() {
    let path = cuboid("operand.obj", false);
    let cut = sample(&[
        "--mesh-in",
        &path,
        "--formula",
        "max(model, z - h)",
        "--param",
        "h=1.5",
        "--count",
        "1500",
        "--mesh",
        &file("cut.stl").display().to_string(),
    ]);
    assert!((cut["mesh"]["volume"].as_f64().expect("a volume") - 3.0).abs() < 1e-6);
    let message = fails(2, &["sample", "--mesh-in", &path, "--formula", "max(model, z)", "--param", "q=1"]);
    assert!(message.contains("no parameter `q`"), "{message}");
}

#[test]
fn an_open_box_keeps_its_border_if_asked_for() {
    let open = cuboid("tub.obj", true);
    let given = ["--mesh-in", &open, "--mesh-borders", "keep", "--count", "1500", "--mesh"];
    let run_of = sample(&[&given[..], &[&file("tub.stl").display().to_string()]].concat());
    assert_eq!(run_of["remesh"]["part"]["rim"]["loops"], 1);
    assert_eq!((&run_of["mesh"]["borders"], &run_of["mesh"]["volume"]), (&1.into(), &().into()));
    let area = run_of["remesh"]["change"]["area"][1].as_f64().expect("an area");
    assert!((area - 16.0).abs() < 1e-6, "{area}");
    let text = stdout(&run(&["sample", "--mesh-in", &open, "--mesh-borders", "keep", "--count", "500"]));
    assert!(text.contains("an open surface, which ends at its border: 1 closed curve of 4 edges"), "{text}");
}

#[test]
fn meshes_that_cannot_be_sampled_are_refused() {
    let open = cuboid("open.obj", true);
    let message = fails(2, &["sample", "--mesh-in", &open, "--mesh-edges", "30"]);
    assert!(
        message.contains("4 edges with one face") && message.contains("--mesh-borders keep"),
        "{message}"
    );
    assert!(fails(2, &["sample", "--mesh-edges", "30"]).contains("--mesh-in"));
    assert!(fails(2, &["sample", "--mesh-in", &open, "--points", &open]).contains("cannot be used with"));
    let empty = file("empty.stl");
    fs::write(&empty, "").expect("written");
    let message = fails(2, &["sample", "--mesh-in", &empty.display().to_string()]);
    assert!(message.contains("the file is empty"), "{message}");
}
