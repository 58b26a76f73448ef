//! Tests of the command-line tool, which run the binary.

use serde_json::Value;
use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

pub(crate) fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_marching-particles"))
        .args(arguments)
        .output()
        .expect("the tool was built with this test")
}

pub(crate) fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("text on standard output")
}

pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).expect("text on standard error")
}

/// Runs `sample --json` with `arguments` and returns the line that it prints.
#[track_caller]
pub(crate) fn sample(arguments: &[&str]) -> Value {
    let output = run(&[&["sample", "--json"], arguments].concat());
    assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
    assert_eq!(stderr(&output), "", "no bar and no chatter without a terminal");
    let text = stdout(&output);
    assert_eq!(text.lines().count(), 1);
    serde_json::from_str(&text).expect("a line of JSON")
}

/// Runs the tool, which must fail with `code` and print nothing on standard output, and returns its
/// message.
#[track_caller]
pub(crate) fn fails(code: i32, arguments: &[&str]) -> String {
    let output = run(arguments);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {}", stderr(&output));
    assert_eq!(stdout(&output), "");
    stderr(&output)
}

pub(crate) fn file(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name)
}

#[test]
fn json_line_holds_the_figures_of_the_run() {
    let run = sample(&["--surface", "ellipsoid", "--count", "3000", "--report", "full"]);
    let count = run["count"].as_f64().expect("a count");
    assert!((count / 3000.0 - 1.0).abs() <= 0.03, "{count} particles");
    assert_eq!(run["surface"], "ellipsoid");
    assert_eq!(run["stop_reason"], "complete");
    assert_eq!(run["parameters"]["b"], 0.7);
    assert!(run["levels"].as_u64() > Some(10));
    assert!(run["evaluations"].as_u64() > Some(3000));
    for phase in ["seeding", "generation", "relaxation", "quality"] {
        assert!(run["seconds"][phase].as_f64() > Some(0.0), "{phase}");
    }
    for figure in [
        "six_neighbours",
        "bond_order",
        "cover",
        "rho",
        "spacing_variation",
        "mean_smallest_angle",
        "error_max",
        "quantization_error",
    ] {
        assert!(run["quality"][figure].as_f64() > Some(0.0), "{figure}");
        assert!(run["quality_before"][figure].as_f64() > Some(0.0), "{figure} before");
    }
    assert_eq!(run["quality"]["euler"], 2);
    let fates = &run["fates"];
    let others = ["components_seeded", "gaps_filled"].map(|key| run[key].as_f64().expect(key));
    assert_eq!(fates["added"].as_f64(), Some(count - others[0] - others[1]));
    let digest = run["digest"].as_str().expect("a digest");
    assert!(digest.len() == 16 && digest.chars().all(|c| c.is_ascii_hexdigit()), "{digest}");
    if cfg!(target_os = "linux") {
        assert!(run["peak_mb"].as_f64() > Some(1.0));
    }
}

#[test]
fn same_command_gives_the_same_particles_and_another_seed_others() {
    let digest =
        |seed: &str| sample(&["--surface", "torus", "--count", "2000", "--seed", seed])["digest"].clone();
    assert_eq!(digest("1"), digest("1"));
    assert_ne!(digest("1"), digest("2"));
}

#[test]
fn radius_as_a_share_and_as_a_length_are_the_same() {
    // The diagonal of the box from −1.5 to 1.5 is 3√3.
    let common = ["--formula", "x^2 + y^2 + z^2 = 1", "--box", "1.5"];
    let share = sample(&[&common[..], &["--radius", "2%"]].concat());
    let length = sample(&[&common[..], &["--radius", "0.103923048454132638"]].concat());
    assert_eq!(share["digest"], length["digest"]);
    assert_eq!(share["bounds"]["max"][0], 1.5);
}

#[test]
fn parameters_reach_the_formula() {
    let arguments = ["--formula", "x^2 + y^2 + z^2 = a b c d k", "--radius", "0.05"];
    let values =
        ["--param", "a=4", "--param", "b=0.25", "--param", "c=1", "--param", "d=1", "--param", "k=0.25"];
    let run = sample(&[&arguments[..], &values].concat());
    // The surface is a sphere of radius 1/2.
    let area = run["quality"]["area"].as_f64().expect("an area");
    assert!((area / std::f64::consts::PI - 1.0).abs() < 0.1, "area {area}");
}

#[test]
fn files_hold_every_particle() {
    let files = ["a.ply", "a.csv", "a.xyz", "a.npy"].map(file);
    let mut arguments = vec!["--surface", "sphere", "--radius", "2%"];
    for path in &files {
        arguments.extend(["--out", path.to_str().expect("a plain path")]);
    }
    let run = sample(&arguments);
    let count = run["count"].as_u64().expect("a count") as usize;
    let [ply, csv, xyz, npy] = files.map(|path| std::fs::read(path).expect("the file was written"));

    let header = ply.windows(11).position(|w| w == b"end_header\n").expect("a header") + 11;
    let records: Vec<&[u8]> = ply[header..].chunks(46).collect();
    assert_eq!(records.len(), count);
    let float = |bytes: &[u8]| f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
    let mut six = 0;
    for record in records {
        let v: Vec<f32> = record[..28].chunks(4).map(float).collect();
        let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
        assert!((length - 1.0).abs() < 1e-3, "a particle at {length} from the centre");
        let outward = v[0] * v[3] + v[1] * v[4] + v[2] * v[5];
        assert!((outward - 1.0).abs() < 1e-3, "a normal that does not point outward: {outward}");
        six += usize::from(record[36] == 6);
    }
    let share = six as f64 / count as f64;
    assert!((share - run["quality"]["six_neighbours"].as_f64().expect("a share")).abs() < 1e-9);

    let lines = |bytes: &[u8]| bytes.iter().filter(|&&b| b == b'\n').count();
    // The names of the columns, and a line for each particle.
    assert_eq!((lines(&csv), lines(&xyz)), (count + 1, count));
    assert!(csv.starts_with(b"x,y,z,nx,ny,nz,radius,level,parent,"));
    let beside = std::fs::read(file("a.csv.json")).expect("the record was written");
    let record: Value = serde_json::from_slice(&beside).expect("JSON");
    assert_eq!(record["marching_particles"]["surface"], "sphere");
    assert_eq!(run["files"].as_array().map(Vec::len), Some(5));
    let comments = ply[..header].split(|&byte| byte == b'\n').map(<[u8]>::len).max();
    assert!(comments <= Some(200), "MeshLab reads lines of up to 512 characters");
    assert_eq!((npy.len() - 24 * count) % 64, 0);
}

#[test]
fn a_formula_or_a_name_needs_no_option() {
    let digest = |arguments: &[&str]| sample(&[arguments, &["--count", "200"]].concat())["digest"].clone();
    let formula = "x^2 + 2y^2 + z^2 = a";
    let given = ["--param", "a=2"];
    assert_eq!(
        digest(&[&[formula][..], &given].concat()),
        digest(&[&["--formula", formula][..], &given].concat())
    );
    assert_eq!(digest(&["torus"]), digest(&["--surface", "torus"]));
    let name_with_formula = ["--surface", "torus", formula];
    assert_eq!(digest(&name_with_formula), digest(&["--surface", "torus", "--formula", formula]));
    let message = fails(2, &["sample", "tours"]);
    assert!(message.contains("there is no surface `tours`: did you mean `torus`?"), "{message}");
    let scan = file("scan.xyz").display().to_string();
    std::fs::write(&scan, "0 0 0\n").expect("a writable folder");
    assert!(fails(2, &["sample", &scan]).contains("is a file: --points, --mesh-in or --image takes it"));
    assert!(fails(2, &["sample", formula, "--formula", "x"]).contains("cannot be used with"));
    assert!(fails(2, &["sample", formula, "--cuont", "200"]).contains("'--count'"));
}

#[test]
fn mesh_files_hold_a_closed_mesh() {
    let files = ["tube.glb", "tube.obj", "tube.stl", "tube.PLY", "tube.3mf"].map(file);
    let mut arguments = vec!["--surface", "torus", "--radius", "1%"];
    for path in &files {
        arguments.extend(["--mesh", path.to_str().expect("a plain path")]);
    }
    let run = sample(&arguments);
    assert_eq!(run["digest"], sample(&arguments[..4])["digest"], "the particles depend on what is written");
    let mesh = &run["mesh"];
    assert_eq!(mesh["triangles"].as_u64(), run["count"].as_u64().map(|count| 2 * count));
    for (key, expected) in [("components", 1), ("euler", 0), ("borders", 0), ("holes", 0), ("left_out", 0)] {
        assert_eq!(mesh[key], expected, "{key}");
    }
    assert_eq!(run["files"].as_array().map(Vec::len), Some(5));
    let [glb, obj, stl, ply, three_mf] = files.map(|path| std::fs::read(path).expect("the file was written"));
    assert!(
        three_mf.starts_with(b"PK")
            && glb.starts_with(b"glTF")
            && obj.starts_with(b"# ")
            && ply.starts_with(b"ply\n")
    );
    let triangles = mesh["triangles"].as_u64().expect("a count") as usize;
    assert_eq!(stl.len(), 84 + 50 * triangles);
    assert_eq!(String::from_utf8_lossy(&obj).matches("\nf ").count(), triangles);

    let text = run_text(&["--surface", "schwarz-p", "--count", "3000", "--mesh"], "cut.obj");
    assert!(text.contains("1 component, Euler number -32, 24 border loops"), "{text}");
    let message = fails(2, &["sample", "--surface", "torus", "--mesh", "torus.xyz"]);
    assert!(message.contains("glb, 3mf, stl, obj, ply"), "{message}");
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn a_file_says_how_to_make_it_again() {
    let path = |name: &str| file(name).to_str().expect("a plain path").to_owned();
    let files = ["again.glb", "again.obj", "again.ply", "again.3mf"].map(path);
    let points = ["again-points.csv", "again-points.ply"].map(path);
    let mut arguments =
        vec!["--formula", "x^2 + |y|^k + z^2 = 0.3", "--param", "k=2.5", "--closed", "--box", "0.4"];
    arguments.extend(["--radius", "0.021", "--seed", "4"]);
    files.iter().for_each(|path| arguments.extend(["--mesh", path]));
    points.iter().for_each(|path| arguments.extend(["--out", path]));
    let made = sample(&arguments);
    let beside = format!("{}.json", points[0]);
    for path in files.iter().chain(&points).chain([&beside]) {
        let again = sample(&["--like", path]);
        for key in ["digest", "formula", "parameters", "bounds", "settings"] {
            assert_eq!(again[key], made[key], "{key} of {path}");
        }
    }
    // What else is given takes the place of the file's.
    let other = sample(&["--like", &files[0], "--param", "k=3", "--radius", "0.03"]);
    assert_eq!((&other["parameters"]["k"], &other["settings"]["seed"]), (&3.0.into(), &4.into()));
    assert_ne!(other["digest"], made["digest"]);
    let settings = &sample(&["--like", &files[0], "--surface", "torus"]);
    assert_eq!((&settings["surface"], &settings["settings"]["seed"]), (&"torus".into(), &4.into()));

    // Who asks for a radius asks for one size, and for no number.
    let [law, counted] = ["law.ply", "counted.ply"].map(path);
    let egg = ["--formula", "x^2 + 2y^2 + z^2 = 1", "--adaptive"];
    let made = sample(&[&egg[..], &["--chord-error", "0.1%", "--out", &law]].concat());
    sample(&[&egg[..], &["--count", "900", "--out", &counted]].concat());
    for path in [&law, &counted] {
        let one_size = sample(&["--like", path, "--radius", "4%"]);
        assert_eq!(one_size["radius_min"], one_size["radius_max"]);
        assert_eq!(one_size["settings"]["size_mode"], "radius");
    }
    let finer = sample(&["--like", &law, "--chord-error", "0.05%"]);
    assert!(finer["count"].as_u64() > made["count"].as_u64(), "{finer}");

    // A fitted box and a surface of the gallery with its own box and values.
    for (arguments, name) in [
        (vec!["--formula", "x^4 + y^4 + z^4 = 1", "--count", "900"], "fitted.glb"),
        (vec!["--surface", "gyroid", "--thickness", "0.6", "--radius", "2%"], "shell.glb"),
        (vec!["--surface", "gyroid", "--closed", "--periodic", "--radius", "2%"], "cell.glb"),
    ] {
        let path = path(name);
        let made = sample(&[&arguments[..], &["--mesh", &path]].concat());
        assert_eq!(sample(&["--like", &path])["digest"], made["digest"], "{name}");
    }

    // A model, whose points no file holds, with a pull on it.
    let bunny = |more: &[&str]| sample(&[&["--surface", "bunny", "--radius", "2%"], more].concat());
    let [own, changed, pulled] = ["own.csv", "changed.csv", "pulled.csv"].map(path);
    let made = bunny(&["--out", &own]);
    let pull = r#""pulls":[{"at":[0.0,0.0,1.0],"by":[0.0,0.1,0.2],"reach":0.6}]"#;
    let [own_record, changed_record] = [&own, &changed].map(|path| format!("{path}.json"));
    let text = std::fs::read_to_string(&own_record).expect("a text");
    assert!(text.contains(r#""pulls":[]"#), "{text}");
    std::fs::write(&changed_record, text.replace(r#""pulls":[]"#, pull)).expect("a file");
    std::fs::copy(&own, &changed).expect("a file");
    assert_eq!(bunny(&["--like", &own])["digest"], made["digest"]);
    let other = bunny(&["--like", &changed, "--out", &pulled]);
    assert_ne!(other["digest"], made["digest"]);
    assert_eq!(bunny(&["--like", &pulled])["digest"], other["digest"]);
    let message = fails(2, &["sample", "--like", &own]);
    assert!(message.contains("--surface or --points"), "{message}");

    let plain = path("plain.stl");
    sample(&["--surface", "sphere", "--mesh", &plain]);
    let message = fails(2, &["sample", "--like", &plain]);
    assert!(message.contains("holds no record"), "{message}");
}

#[test]
fn a_record_of_one_line_is_read_as_before() {
    // As files of earlier versions have it.
    let path = file("old.csv").to_str().expect("a plain path").to_owned();
    let new = file("old.ply").to_str().expect("a plain path").to_owned();
    let made = sample(&["--formula", "x^2 + y^2 + z^2 = 1", "--radius", "4%", "--out", &new]);
    let ply = String::from_utf8_lossy(&std::fs::read(&new).expect("a file")).into_owned();
    let json: String =
        ply.lines().filter_map(|line| line.strip_prefix("comment marching_particles ")).collect();
    std::fs::write(&path, format!("# marching_particles {json}\nx,y,z\n0,0,1\n")).expect("a file");
    assert_eq!(sample(&["--like", &path])["digest"], made["digest"]);
}

#[test]
fn a_solid_in_which_f_is_larger_is_turned_and_told() {
    let text = run_text(&["--formula", "1 - x^2 - y^2 - z^2", "--count", "1500", "--mesh"], "turned.stl");
    assert!(
        text.contains("volume 4.1") && text.contains("turned to face outward: f is larger inside"),
        "{text}"
    );
    assert!(text.contains("f > 0") && text.contains("note: f is larger inside"), "{text}");
    let text = run_text(&["--formula", "x^2 + y^2 + z^2 - 1", "--count", "1500", "--mesh"], "as-it-is.stl");
    assert!(!text.contains("larger inside") && text.contains("f < 0"), "{text}");
}

#[test]
fn ways_to_write_vertices_are_for_formats_that_know_them() {
    let path = |name: &str| file(name).to_str().expect("a plain path").to_owned();
    let cube = ["--formula", "max(|x|, |y|, |z|) = 1", "--count", "500", "--vertices"];
    let header = |way: &str| {
        let path = path(&format!("{way}-cube.ply"));
        let run = sample(&[&cube[..], &[way, "--mesh", &path]].concat());
        let bytes = std::fs::read(&path).expect("a file");
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let count =
            text.split("element vertex ").nth(1).and_then(|rest| rest.lines().next()?.parse::<u64>().ok());
        (
            count.expect("a number"),
            run["count"].as_u64().expect("a number"),
            text.contains("property uint level"),
        )
    };
    let (joined, count, _) = header("joined");
    assert_eq!(joined, count);
    let (split, count, has_levels) = header("split");
    assert!(split > count && !has_levels);
    let (all, _, has_levels) = header("columns");
    assert!(all == split && has_levels);
    for (way, name) in [("split", "cube.stl"), ("columns", "cube.glb")] {
        let message = fails(2, &[&["sample"], &cube[..], &[way, "--mesh", &path(name)]].concat());
        assert!(message.contains(&format!("--vertices {way} is for files of --mesh")), "{message}");
    }
    let help = stdout(&run(&["sample", "--help"]));
    assert!(help.contains("Split") || help.contains("a vertex for each side"), "{help}");
}

#[test]
fn a_unit_cell_says_which_particles_repeat() {
    let path = file("cell.csv");
    let text =
        run_text(&["--formula", "cos x + cos y + cos z", "--closed", "--periodic", "--out"], "cell.csv");
    assert!(text.contains("Periodic pairs") && !text.contains("warning"), "{text}");
    let csv = std::fs::read_to_string(path).expect("the file was written");
    assert_eq!(csv.lines().next().and_then(|names| names.split(',').next_back()), Some("periodic"));
    let closed = run_text(&["--formula", "x^2 + y^2 + z^2 = 1", "--closed", "--out"], "ball.csv");
    assert!(!closed.contains("Periodic pairs"), "{closed}");

    let cell = ["sample", "--closed", "--periodic", "--formula"];
    let message = fails(2, &[&cell[..], &["x^2 + y^2 + z^2 = 1"]].concat());
    assert!(message.contains("surfaces that repeat along x, y or z"), "{message}");
    let message = fails(2, &[&cell[..], &["sin x + sin 2y = z", "--box", "3"]].concat());
    assert!(
        message.contains("a period of 6.283185307179586 along x, 3.141592653589793 along y"),
        "{message}"
    );
    fails(2, &["sample", "--surface", "gyroid", "--periodic"]);
}

/// Runs `sample` with a file as the last argument; the text that it prints.
#[track_caller]
fn run_text(arguments: &[&str], name: &str) -> String {
    let path = file(name);
    let output = run(&[&["sample"], arguments, &[path.to_str().expect("a plain path")]].concat());
    assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
    stdout(&output)
}

#[cfg(unix)]
#[test]
fn file_with_a_name_that_is_not_unicode_is_written_and_reported() {
    use std::os::unix::ffi::OsStrExt;
    let path = file("").join(std::ffi::OsStr::from_bytes(b"odd \xff.xyz"));
    let output = Command::new(env!("CARGO_BIN_EXE_marching-particles"))
        .args(["sample", "--surface", "sphere", "--radius", "5%", "--json", "--out"])
        .arg(&path)
        .output()
        .expect("the tool was built with this test");
    assert!(output.status.success(), "{}", stderr(&output));
    let run: Value = serde_json::from_str(&stdout(&output)).expect("a line of JSON");
    assert!(
        run["files"][0].as_str().is_some_and(|name| name.ends_with("odd \u{FFFD}.xyz")),
        "{}",
        run["files"]
    );
    let lines = std::fs::read_to_string(&path).expect("the file was written").lines().count();
    assert_eq!(Some(lines as u64), run["count"].as_u64());
}

#[test]
fn existing_file_is_replaced() {
    let path = file("replaced.csv");
    std::fs::write(&path, "old ".repeat(1_000_000)).expect("the directory can be written");
    sample(&["--surface", "sphere", "--radius", "5%", "--out", path.to_str().expect("a plain path")]);
    let text = std::fs::read_to_string(&path).expect("the file is there");
    assert!(text.starts_with("x,y,z,") && !text.contains("old"));
}

#[test]
fn text_report_names_the_figures_before_and_after() {
    let output = run(&["sample", "--surface", "torus", "--count", "1500", "--report", "full"]);
    assert!(output.status.success());
    let text = stdout(&output);
    for part in ["torus: ", "particles of radius", "after front", "relaxed", "Six neighbours", "digest "] {
        assert!(text.contains(part), "no `{part}` in:\n{text}");
    }
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split("  ").map(str::trim).collect()).collect();
    for (label, figure) in [
        ("Sample Euler number", "0"),
        ("Sample components", "1"),
        ("All components found", "proven"),
        ("Undecided cells", "0"),
    ] {
        let row = rows.iter().find(|row| row[0] == label);
        assert!(row.is_some_and(|row| row[1..].contains(&figure)), "{label} {figure} is not in:\n{text}");
    }
    let torus = ["sample", "--surface", "torus", "--count", "1500"];
    for without in [&["--report", "full", "--relax", "0"][..], &[]] {
        let text = stdout(&run(&[&torus, without].concat()));
        assert!(text.contains("Six neighbours") && !text.contains("after front"), "{text}");
    }
}

#[test]
fn a_run_without_a_report_has_the_same_particles_and_says_what_is_missing() {
    let path = file("unmeasured.csv");
    let name = path.to_str().expect("a plain path");
    let arguments = ["--surface", "torus", "--count", "1500"];
    let unmeasured = sample(&[&arguments[..], &["--report", "none", "--out", name]].concat());
    let measured = sample(&arguments);
    assert_eq!(unmeasured["digest"], measured["digest"]);
    assert_eq!(measured["components"], 1);
    for missing in ["quality", "quality_before", "components"] {
        assert!(unmeasured[missing].is_null(), "{missing}: {}", unmeasured[missing]);
    }
    assert_eq!(
        (&unmeasured["search"], &unmeasured["level_counts"]),
        (&measured["search"], &measured["level_counts"])
    );
    let text = std::fs::read_to_string(&path).expect("the file was written");
    assert_eq!(text.lines().next(), Some("x,y,z,nx,ny,nz,radius,level,parent,singular"));
    assert!(text.lines().all(|line| line.split(',').count() == 10));
    let summary = stdout(&run(&[&["sample", "--report", "none"], &arguments[..]].concat()));
    assert!(summary.contains("not measured: ") && !summary.contains("Six neighbours"), "{summary}");
}

#[test]
fn formula_error_is_marked_under_its_span() {
    let message = fails(2, &["sample", "--formula", "x^2 + α)"]);
    let lines: Vec<&str> = message.lines().collect();
    assert!(lines[0].starts_with("error: "), "{message}");
    let caret = lines.iter().position(|line| line.contains('^') && !line.contains('x')).expect("a caret");
    let column = lines[caret].chars().position(|c| c == '^').expect("a caret");
    let marked = lines[caret - 1].chars().nth(column);
    assert!(marked == Some('α') || marked == Some(')'), "{message}");
}

#[test]
fn each_invalid_argument_has_its_message() {
    assert!(
        fails(2, &["sample", "--surface", "teapot"]).contains("`marching-particles surfaces` lists them")
    );
    assert_eq!(
        fails(2, &["sample", "--surface", "elipsoid"]).trim(),
        "error: there is no surface `elipsoid`: did you mean `ellipsoid`?"
    );
    assert!(fails(2, &["sample", "--count", "0"]).contains("0 is not in 1..=4000000"));
    assert!(fails(2, &["sample", "--surface", "sphere", "--param", "q=1"]).contains("its parameters: r"));
    assert!(fails(2, &["sample", "--param", "a"]).contains("NAME=VALUE"));
    assert!(fails(2, &["sample", "--radius", "0"]).contains("positive"));
    let range = "is 90% of the box diagonal, but must lie between 0.01% and 20%";
    assert!(fails(2, &["sample", "--radius", "90%"]).contains(&format!("--radius {range}")));
    assert!(
        fails(2, &["sample", "--adaptive", "--radius-min", "90%"]).contains(&format!("--radius-min {range}"))
    );
    assert!(
        fails(2, &["sample", "--radius", "1e-9"])
            .contains("--radius is 1e-9, but must lie between 0.01% and 20% of the box diagonal, here 0.0")
    );
    assert!(fails(2, &["sample", "--radius", "1%", "--count", "10"]).contains("cannot be used with"));
    assert!(fails(2, &["sample", "--box", "1,2"]).contains("one, three or six"));
    assert!(fails(2, &["sample", "--box", "1;2;3"]).contains("separated by commas"));
    assert!(fails(2, &["sample", "--scale", "1e300"]).contains("1e300 is not between 1e-12 and 1e12"));
    for (given, needed) in [
        (&["--law", "max-curvature"][..], "--law has no effect without --adaptive"),
        (&["--adaptive", "--curvature-scale", "0.1"], "without --law max-curvature or"),
        (&["--adaptive", "--law", "max-curvature", "--chord-error", "1%"], "without --law chord-error"),
    ] {
        let message = fails(2, &[&["sample"], given].concat());
        assert!(message.contains(needed), "{message}");
    }
    for (bad, fault) in [
        ("1,1,0", "have a positive size on every axis"),
        ("1e39", "have a diagonal between 1e-12 and 1e12"),
        ("1e-310", "have a diagonal between 1e-12 and 1e12"),
        ("1,1,1e-100", "be no thinner than 1e-12 of its diagonal"),
    ] {
        let message = fails(2, &["sample", "--formula", "x + y + z", "--box", bad]);
        assert!(message.contains(&format!("the box must {fault}: give half-widths")), "{bad}: {message}");
    }
    let far = fails(2, &["sample", "--formula", "x + y + z", "--box", "1e9,0,0,1000000001,1,1"]);
    assert!(far.contains("shift it and the formula to the origin") && !far.contains("half-widths"), "{far}");
    for (option, range) in
        [("--match-tolerance", "0.5 and 0.9"), ("--relax", "0 and 1000"), ("--count", "1 and 4000000")]
    {
        let message = fails(2, &["sample", option, "5000000"]);
        assert!(message.contains(&format!("{option} is 5000000, but must lie between {range}")), "{message}");
    }
    // A name that no parameter can have is reported without a span of the formula.
    let message = fails(2, &["sample", "--formula", "x = a", "--param", "a b=2"]);
    assert!(
        message.contains("`a b` cannot be the name of a parameter: a name is a letter, then")
            && !message.contains('^'),
        "{message}"
    );
    let out = file("mesh.obj");
    let message = fails(2, &["sample", "--out", out.to_str().expect("a plain path")]);
    assert!(message.contains("ply, csv, xyz, npy"), "{message}");
    assert!(!out.exists());
}

#[test]
fn nothing_to_sample_has_its_own_exit_code() {
    for formula in ["x^2 + y^2 + z^2 + 1", "1", "x - x", "log10(-1 - x^2)"] {
        let message = fails(3, &["sample", "--formula", formula]);
        assert!(message.starts_with("error: ") && message.len() > 20, "{formula}: {message}");
    }
}

#[test]
fn a_run_that_meets_the_limit_prints_what_it_has_and_says_how_many_would_fit() {
    let output = run(&["sample", "--surface", "plane", "--max-particles", "5", "--json"]);
    assert_eq!(output.status.code(), Some(4));
    let json: Value = serde_json::from_slice(&output.stdout).expect("a line of JSON");
    assert_eq!((json["count"].as_u64(), json["stop_reason"].as_str()), (Some(5), Some("cap")));
    let message = String::from_utf8_lossy(&output.stderr);
    let wanted = message.split("--max-particles ").nth(1).expect("advice");
    assert!(wanted.trim().parse::<u64>().expect("a number") > 1_000, "{message}");
}

#[test]
fn a_file_that_cannot_be_written_is_named_before_anything_is_sampled() {
    let message = fails(1, &["sample", "--count", "4000000", "--out", "/nonexistent/points.ply"]);
    assert!(
        message.contains("/nonexistent/points.ply could not be written: there is no folder"),
        "{message}"
    );
}

#[test]
fn standard_output_takes_a_file_and_standard_input_points() {
    let named = file("piped.ply");
    let given = ["sample", "--surface", "sphere", "--radius", "5%"];
    let path = named.to_str().expect("a plain path");
    assert!(run(&[&given[..], &["--out", path]].concat()).status.success());
    let wanted = std::fs::read(&named).expect("the file is there");
    let piped = run(&[&given[..], &["--out", "-", "--format", "ply"]].concat());
    assert_eq!(piped.stdout, wanted);
    assert!(stderr(&piped).contains("digest ") && stderr(&piped).contains("wrote -"));

    let mut child = Command::new(env!("CARGO_BIN_EXE_marching-particles"))
        .args(["sample", "--points", "-", "--radius", "5%", "--json"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the tool was built with this test");
    child.stdin.take().expect("a pipe").write_all(&wanted).expect("it is read");
    let output = child.wait_with_output().expect("it ends");
    let json: Value = serde_json::from_slice(&output.stdout).expect("a line of JSON");
    assert_eq!(json["model"]["name"], "standard input");

    let mesh = [&given[..], &["--mesh", "-"]].concat();
    assert!(fails(2, &mesh).contains("--format; formats here are glb, "));
    assert!(fails(2, &[&mesh[..], &["--format", "csv"]].concat()).contains("formats here are glb, "));
    assert!(fails(2, &[&given[..], &["--format", "ply"]].concat()).contains("--out - or --mesh -"));
    let twice = [&mesh[..], &["--out", "-", "--format", "ply"]].concat();
    assert!(fails(2, &twice).contains("- is to be written twice"));
}

#[test]
fn a_quiet_run_prints_nothing_but_errors() {
    let path = file("quiet.xyz");
    let quiet = ["sample", "--radius", "5%", "--quiet", "--out", path.to_str().expect("a plain path")];
    let output = run(&quiet);
    assert!(output.status.success() && path.exists());
    assert_eq!((stdout(&output), stderr(&output)), (String::new(), String::new()));
    assert!(fails(2, &["sample", "--quiet", "--count", "0"]).contains("1..=4000000"));
}

#[test]
fn an_open_mesh_for_a_printer_is_told() {
    let open = ["--formula", "x^2 + y^2 = 1", "--box", "2", "--radius", "5%", "--mesh"];
    assert!(run_text(&open, "open.stl").contains("warning: the mesh is open, with 2 border loops"));
    assert!(!run_text(&open, "open.obj").contains("the mesh is open"));
    let closed = [&["--closed"], &open[..]].concat();
    assert!(!run_text(&closed, "closed.stl").contains("the mesh is open"));
}

#[test]
fn shells_complete_options_and_each_command_has_a_manual_page() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = stdout(&run(&["completions", shell]));
        assert!(script.contains("chord-error") && script.contains("sweep"), "{shell}");
    }
    let directory = file("man");
    assert!(run(&["man", directory.to_str().expect("a plain path")]).status.success());
    let page = |name: &str| std::fs::read_to_string(directory.join(name)).expect("a page");
    assert!(page("marching-particles.1").contains("completions"));
    assert!(page("marching-particles-sample.1").contains(r"\-\-chord\-error"));
}

#[test]
fn one_file_is_not_written_twice() {
    let [path, again] = ["twice.ply", "./twice.ply"].map(file);
    let [path, again] = [&path, &again].map(|path| path.to_str().expect("a plain path"));
    let message = fails(2, &["sample", "--radius", "5%", "--out", path, "--mesh", again]);
    assert!(message.contains("twice.ply"), "{message}");
    assert!(!PathBuf::from(path).exists());
}

#[test]
fn a_run_that_fails_leaves_the_file_that_is_there() {
    let directory = file("kept");
    std::fs::create_dir_all(&directory).expect("the directory can be made");
    let path = directory.join("kept.csv");
    std::fs::write(&path, "good").expect("the directory can be written");
    fails(3, &["sample", "--formula", "x^2+1", "--box", "1", "--out", path.to_str().expect("a plain path")]);
    assert_eq!(std::fs::read_to_string(&path).expect("the file is there"), "good");
    let names: Vec<_> = std::fs::read_dir(&directory).expect("the directory is there").collect();
    assert_eq!(names.len(), 1, "nothing else is left: {names:?}");
}

#[test]
fn models_from_points_are_sampled_by_name() {
    let text = stdout(&run(&["sample", "--surface", "bunny", "--radius", "2%", "--relax", "0"]));
    assert!(text.starts_with("bunny: Stanford bunny, Stanford Computer Graphics Laboratory\n"), "{text}");
    let json = run(&["sample", "--surface", "bunny-joined", "--radius", "0.6%", "--json"]);
    let json: Value = serde_json::from_str(&stdout(&json)).expect("a line of JSON");
    assert_eq!(
        (json["surface"].as_str(), json["model"]["centres"].as_u64()),
        (Some("bunny-joined"), Some(200))
    );
    assert_eq!(json["quality"]["euler"], 0);
    for (more, says) in [
        (["--formula", "x = 0"], "takes the model as an operand"),
        (["--param", "a=1"], "a model from points has none"),
    ] {
        let message = fails(2, &["sample", "--surface", "bunny", more[0], more[1]]);
        assert!(message.contains(says), "{message}");
    }
}

#[test]
fn surfaces_lists_the_gallery() {
    let text = stdout(&run(&["surfaces"]));
    let json: Value = serde_json::from_str(&stdout(&run(&["surfaces", "--json"]))).expect("a line of JSON");
    let surfaces = json.as_array().expect("a list");
    let named =
        marching_particles::field::gallery::SURFACES.len() + marching_particles::field::model::MODELS.len();
    assert_eq!(surfaces.len(), named);
    for surface in surfaces {
        let id = surface["id"].as_str().expect("an identifier");
        assert!(text.lines().any(|line| line.starts_with(&format!("{id}  "))), "no {id}");
    }
}

#[test]
fn every_setting_is_an_option() {
    let help = stdout(&run(&["sample", "--help"]));
    for setting in marching_particles::internal::session::settings() {
        assert!(help.contains(&format!("--{}", setting.option())), "--{} is not there", setting.option());
    }
}

#[test]
fn help_explains_units_defaults_and_examples() {
    let help = stdout(&run(&["sample", "--help"]));
    for part in ["Formulas:", "Examples:", "Exit codes:", "0.6%", "smin(a,b,k)", "4,400,000"] {
        assert!(help.contains(part), "no `{part}` in the help");
    }
    // The default limit in the text is the actual one.
    assert_eq!(marching_particles::sampler::Settings::default().max_particles, 4_400_000);
    assert!(run(&["--version"]).status.success());
    assert_eq!(run(&[]).status.code(), Some(2));
}

#[test]
fn points_of_a_file_become_a_surface_that_is_sampled() {
    let [cloud, even, obj] = ["cloud.xyz", "even.ply", "box.obj"].map(file);
    let path = |path: &PathBuf| path.to_str().expect("a plain path").to_owned();
    sample(&["--surface", "torus", "--radius", "2%", "--out", &path(&cloud)]);
    let again = sample(&["--points", &path(&cloud), "--radius", "2%", "--out", &path(&even)]);
    let model = &again["model"];
    assert_eq!((model["name"].as_str(), model["normals"].as_str()), (Some("cloud.xyz"), Some("given")));
    assert_eq!((model["centres"].as_u64(), again["quality"]["euler"].as_i64()), (Some(200), Some(0)));
    assert!(
        model["residual_max"].as_f64() < Some(0.01) && model["condition"].as_f64() > Some(1e3),
        "{model}"
    );
    assert!(again["seconds"]["points"].as_f64() > Some(0.0));
    assert_eq!(again["surface"], Value::Null);

    let more = sample(&["--points", &path(&even), "--centres", "300", "--radius", "2%", "--relax", "0"]);
    assert_eq!((more["model"]["centres"].as_u64(), &more["model"]["points"]), (Some(300), &again["count"]));

    // The second file has no normals, and the report is text.
    let text = std::fs::read_to_string(&cloud).expect("the file was written");
    let bare: String =
        text.lines().map(|line| line.split(' ').take(3).collect::<Vec<_>>().join(" ") + "\n").collect();
    std::fs::write(&cloud, bare).expect("a file can be written");
    let words = stdout(&run(&["sample", "--points", &path(&cloud), "--radius", "2%", "--relax", "0"]));
    assert!(words.starts_with("points: cloud.xyz\na surface from 200 centres near "), "{words}");
    assert!(
        words.contains("normals estimated, condition ")
            && words.contains("\nwarning: The points have no normals"),
        "{words}"
    );

    std::fs::write(&obj, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n").expect("a file can be written");
    let message = fails(2, &["sample", "--points", &path(&obj)]);
    assert!(
        message.ends_with("box.obj: line 4: the face has vertex 4, and 3 stand before this line\n"),
        "{message}"
    );
    let message = fails(1, &["sample", "--points", "no such file"]);
    assert!(message.starts_with("error: no such file could not be read: "), "{message}");
    for (more, says) in
        [(["--surface", "torus"], "cannot be used with"), (["--param", "a=2"], "parameters are for formulas")]
    {
        let message = fails(2, &["sample", "--points", "a.ply", more[0], more[1]]);
        assert!(message.contains(says), "{message}");
    }
    let message = fails(2, &["sample", "--surface", "bunny", "--formula", "max(2model, z)"]);
    assert!(message.contains("takes the model as an operand"), "{message}");
    let message = fails(2, &["sample", "--formula", "max(model, z)"]);
    assert!(message.contains("give its points with --points"), "{message}");
    for centres in ["99", "801"] {
        let message = fails(2, &["sample", "--points", "a.ply", "--centres", centres]);
        assert!(message.contains("100..=800"), "{message}");
    }
    let message = fails(2, &["sample", "--surface", "torus", "--centres", "150"]);
    assert!(message.contains("--centres is for --points and for the models"), "{message}");
    let fewer = sample(&["--surface", "bunny", "--centres", "150", "--radius", "3%", "--relax", "0"]);
    let model = &fewer["model"];
    assert_eq!((model["centres"].as_u64(), model["points"].as_u64()), (Some(150), Some(200)));
    let residual = |key: &str| model[key].as_f64().expect("a residual");
    assert!(residual("residual_mean") < residual("residual_95"), "{model}");
    assert!(residual("residual_95") < residual("residual_max"), "{model}");
}

#[test]
fn a_file_of_two_gigabytes_is_refused_before_it_is_read() {
    let path = file("huge.ply");
    // The file is sparse: it has a size and no content.
    let huge = std::fs::File::create(&path).expect("a file can be created");
    huge.set_len(2_000_000_000).expect("a size can be set");
    let message = fails(2, &["sample", "--points", path.to_str().expect("a plain path")]);
    std::fs::remove_file(&path).expect("the file can be removed");
    assert!(message.contains("the file has 2000 MB, and up to 50 MB are read"), "{message}");
}

#[test]
fn a_formula_has_a_box_that_fits_and_a_surface_that_is_cut_is_told_with_what_to_do() {
    let fast = ["--radius", "2%", "--relax", "0"];
    let text = |more: &[&str]| String::from_utf8_lossy(&run(&[more, &fast].concat()).stdout).into_owned();
    let tangle = ["sample", "--formula", "x^4-5x^2+y^4-5y^2+z^4-5z^2+11.8"];
    let whole = text(&tangle);
    assert!(!whole.contains("cuts the surface") && !whole.contains("beyond the box"), "{whole}");
    let cut = text(&[&tangle[..], &["--box", "2"]].concat());
    assert!(cut.contains("cuts the surface") && cut.contains("--box fit"), "{cut}");
    let fixed = text(&[&tangle[..], &["--box", "fixed"]].concat());
    assert!(fixed.contains("from -2,-2,-2 to 2,2,2 cuts the surface"), "{fixed}");
    let endless = text(&["sample", "--formula", "z = 0"]);
    assert!(endless.contains("continues outside the box from -4,-4,-4 to 4,4,4"), "{endless}");
    assert!(fails(3, &["sample", "--formula", "x^2 = -1"]).contains("±10,000"));
    // A closed surface of the gallery that is larger than its box, and an endless one.
    let large = text(&["sample", "--surface", "torus", "--param", "R=1.4"]);
    assert!(large.contains("cuts the surface") && large.contains("enlarge it with --box"), "{large}");
    let gyroid = text(&["sample", "--surface", "gyroid"]);
    assert!(!gyroid.contains("cuts") && !gyroid.contains("continues"), "{gyroid}");
    let small = text(&["sample", "--formula", "x^2+y^2+z^2=1e-12"]);
    assert!(small.contains("e-8 in 1"), "{small}");
    assert!(fails(2, &["sample", "--formula", "x2 + y2 = 1"]).contains("in all 2 places: x^2 + y^2 = 1"));
}
