//! Thickness and porosity on the command line.

use crate::cli::{fails, file, run, sample, stdout};

#[test]
fn the_mesh_has_the_porosity_that_is_wanted() {
    let path = file("porous.ply").to_str().expect("a plain path").to_owned();
    let gyroid = ["--surface", "gyroid", "--closed", "--radius", "1%"];
    for (more, wanted) in [
        (vec!["--porosity", "70%", "--mesh", &path], 0.7),
        (vec!["--porosity", "0.65", "--thickness", "1 + 0.08z", "--box", "4"], 0.65),
    ] {
        let run = sample(&[&gyroid[..], &more].concat());
        let reached = run["porosity"]["reached"].as_f64().expect("a closed mesh");
        println!("{more:?}: {} {}", run["thickness"], run["porosity"]);
        assert!((reached - wanted).abs() < 2e-3, "{}", run["porosity"]);
        assert_eq!(run["porosity"]["wanted"], wanted);
        if more.contains(&"--mesh") {
            let again = sample(&["--like", &path]);
            assert_eq!((&again["digest"], &again["thickness"]), (&run["digest"], &run["thickness"]));
        }
    }
}

#[test]
fn a_thickness_by_a_formula_reaches_the_record() {
    let path = file("graded.glb").to_str().expect("a plain path").to_owned();
    let arguments = ["--surface", "torus", "--thickness", "0.2 + 0.1 x r", "--radius", "3%", "--mesh", &path];
    let run = sample(&arguments);
    assert_eq!((&run["thickness"], &run["mesh"]["borders"]), (&"0.2 + 0.1 x r".into(), &0.into()));
    assert_eq!(sample(&["--like", &path])["digest"], run["digest"]);
}

#[test]
fn programs_have_the_thickness() {
    let printed = |language: &str| {
        let arguments = ["sample", "--surface", "gyroid", "--thickness", "0.3 + 0.02z", "--closed"];
        stdout(&run(&[&arguments[..], &["--print", language]].concat()))
    };
    assert!(printed("rust").contains(r#".thickened_by("0.3 + 0.02z")?"#), "{}", printed("rust"));
    assert!(printed("shell").contains("--closed --thickness '0.3 + 0.02z'"), "{}", printed("shell"));
}

#[test]
fn what_cannot_be_wished_is_refused() {
    let of = |more: &[&str]| fails(2, &[&["sample", "--surface", "gyroid"], more].concat());
    let message = of(&["--thickness", "0.1 + 0.05 q"]);
    assert!(message.contains("has no parameter `q`") && message.contains("(t)"), "{message}");
    assert!(message.contains("\n\n  0.1 + 0.05 q\n             ^"), "{message}");
    for (arguments, words) in [
        (vec!["--thickness", "-1"], "thickness is -1"),
        (vec!["--porosity", "70%"], "--closed"),
        (vec!["--porosity", "70", "--closed"], "between 0 and 1"),
        (vec!["--porosity", "70%", "--closed", "--thickness", "0.3"], "leave --thickness out"),
        (vec!["--porosity", "10%", "--closed", "--thickness", "x"], "the nearest is 50"),
    ] {
        let message = of(&arguments);
        assert!(message.contains(words), "{arguments:?}: {message}");
    }
}

/// The corners of the triangles of an STL file.
fn corners(path: &str) -> Vec<[f32; 3]> {
    let bytes = std::fs::read(path).expect("the tool has written it");
    let number = |at: usize| f32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes"));
    let triangles = (84..bytes.len()).step_by(50);
    triangles
        .flat_map(|at| [12, 24, 36].map(|corner| [0, 4, 8].map(|axis| number(at + corner + axis))))
        .collect()
}

fn longest_side(corners: &[[f32; 3]]) -> f32 {
    let side = |axis: usize| {
        let of = corners.iter().map(|corner| corner[axis]);
        of.clone().fold(f32::NEG_INFINITY, f32::max) - of.fold(f32::INFINITY, f32::min)
    };
    [0, 1, 2].map(side).into_iter().fold(0.0, f32::max)
}

#[test]
fn the_mesh_is_as_long_and_its_wall_as_thick_as_is_wanted() {
    let path = file("wall.stl").to_str().expect("a plain path").to_owned();
    // A shell, whose outside grows with its wall.
    let ball = ["--formula", "hypot(x, y, z) = 1", "--radius", "2%", "--mesh", &path];
    let run = sample(&[&ball[..], &["--size", "4cm", "--wall", "2mm"]].concat());
    let read = corners(&path);
    assert!((longest_side(&read) - 4.0).abs() < 1e-4, "{}", longest_side(&read));
    let from_middle = read.iter().map(|[x, y, z]| (x * x + y * y + z * z).sqrt());
    let [outer, inner] = [from_middle.clone().fold(0.0, f32::max), from_middle.fold(f32::MAX, f32::min)];
    assert!((outer - inner - 0.2).abs() < 0.004, "{outer} {inner}");
    let mesh = &run["mesh"];
    assert_eq!((&mesh["components"], &mesh["parts"], &mesh["unit"]), (&2.into(), &1.into(), &"cm".into()));
    let run = sample(&[&ball[..], &["--scale", "20", "--unit", "mm", "--wall", "1mm"]].concat());
    assert_eq!(run["thickness"], 0.05);
}

#[test]
fn the_largest_part_has_the_size_alone() {
    let path = file("largest.stl").to_str().expect("a plain path").to_owned();
    let balls = ["--formula", "min(hypot(x, y, z) - 1, hypot(x - 2, y, z) - 0.2)", "--radius", "1%"];
    let of = |more: &[&str]| sample(&[&balls[..], more, &["--size", "40mm", "--mesh", &path]].concat());
    let mesh = &of(&[])["mesh"];
    assert_eq!([&mesh["parts"], &mesh["chips"], &mesh["parts_left_out"]], [1, 1, 0]);
    let all = corners(&path).len();
    let mesh = &of(&["--largest-part"])["mesh"];
    assert_eq!([&mesh["parts"], &mesh["chips"], &mesh["parts_left_out"]], [1, 1, 1]);
    let read = corners(&path);
    assert!(read.len() < all && (longest_side(&read) - 40.0).abs() < 1e-3, "{}", longest_side(&read));
}

#[test]
fn a_size_without_a_mesh_or_beside_a_scale_is_refused() {
    let of = |more: &[&str]| fails(2, &[&["sample", "--surface", "torus"], more].concat());
    let mesh = ["--mesh", "never.stl"];
    for (arguments, words) in [
        (vec!["--size", "40mm"], "for the files of --mesh"),
        (vec!["--largest-part"], "for the files of --mesh"),
        ([&["--size", "40kg"], &mesh[..]].concat(), "40kg"),
        ([&["--size", "-4mm"], &mesh[..]].concat(), "-4mm"),
        ([&["--size", "0mm"], &mesh[..]].concat(), "a positive number with mm, cm, m or in"),
        ([&["--size", "4mm", "--scale", "2"], &mesh[..]].concat(), "--scale"),
        ([&["--wall", "2mm", "--thickness", "0.1"], &mesh[..]].concat(), "--thickness"),
    ] {
        let message = of(&arguments);
        assert!(message.contains(words), "{arguments:?}: {message}");
    }
}
