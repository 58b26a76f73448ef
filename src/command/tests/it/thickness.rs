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
