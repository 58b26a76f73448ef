//! Runs the commands and the Rust programs of `docs/cookbook.md` and holds their particles to
//! `tests/golden/cookbook.json`, as the tests of the packages do with the programs in Python and
//! JavaScript.
//!
//! A change that is meant to alter particles rewrites the file: `UPDATE_GOLDEN=1 cargo test --test
//! cookbook`.
#![cfg(unix)]

#[path = "../../../tests/it/golden.rs"]
#[expect(dead_code, reason = "no bytes are digested here")]
mod golden;

use marching_particles::Sample;
use serde::{Deserialize, Serialize};
use std::error::Error;
use std::path::Path;
use std::process::Command;
use std::{env, fs};

const TOOL: &str = env!("CARGO_BIN_EXE_marching-particles");

/// A task of the cookbook.
#[derive(Serialize, Deserialize)]
struct Task {
    title: String,
    /// Digest of the particles that each of its programs makes.
    digest: String,
}

/// The title of each task with its text.
fn tasks(page: &str) -> Vec<(&str, &str)> {
    page.split("\n## ").skip(1).map(|task| task.split_once('\n').expect("a title and a text")).collect()
}

/// The program of a task in a language.
fn program<'a>(text: &'a str, language: &str) -> Option<&'a str> {
    let (_, rest) = text.split_once(&format!("```{language}\n"))?;
    rest.split_once("```").map(|(program, _)| program)
}

/// Runs the commands of a task and returns the digest of their sample.
fn sampled_by_shell(script: &str) -> String {
    let tools = Path::new(TOOL).parent().expect("the folder of the tool").display();
    let path = format!("{tools}:{}", env::var("PATH").unwrap_or_default());
    let run = Command::new("sh").args(["-e", "-c", script]).env("PATH", path).output().expect("a shell");
    assert!(run.status.success(), "{script}{}", String::from_utf8_lossy(&run.stderr));
    let report = String::from_utf8(run.stdout).expect("text");
    let mut digests = report.lines().filter_map(|line| line.strip_prefix("digest "));
    digests.next_back().unwrap_or_else(|| panic!("{script} prints no digest")).to_owned()
}

/// A program that makes a sample.
type Program = fn() -> Result<Sample, Box<dyn Error>>;

/// A program of the cookbook as it is compiled, and its text.
macro_rules! program {
    ($particles:ident: $($line:tt)*) => {{
        let run = || -> Result<Sample, Box<dyn Error>> {
            $($line)*
            Ok($particles)
        };
        (run as Program, stringify!($($line)*))
    }};
}

/// The programs in Rust, in the order of the tasks.
#[rustfmt::skip]
fn programs() -> Vec<(Program, &'static str)> {
    vec![
        program! { particles:
            use marching_particles::{Formula, Settings, sample};

            let surface = Formula::parse("x^4 + y^4 + z^4 = 1")?;
            let particles = sample(surface, &Settings::with_count(5_000))?;
            particles.save("points.ply")?;
        },
        program! { particles:
            use marching_particles::{Formula, Settings, sample};

            let drilled = Formula::parse("max(abs(x) - 1, abs(y) - 1, abs(z) - 1, 0.5 - hypot(x, y))")?;
            let particles = sample(drilled, &Settings::with_count(5_000).refined())?;
            particles.save("part.stl")?;
        },
        program! { particles:
            use marching_particles::{Formula, Radius, Settings, sample};

            let sphere = Formula::parse("x^2 + y^2 + z^2 = 1")?;
            let particles = sample(sphere, &Settings::with_radius(Radius::Length(0.05)))?;
        },
        program! { particles:
            use marching_particles::{Formula, Settings, sample};

            let ellipsoid = Formula::parse("x^2/9 + y^2 + z^2 = 1")?;
            let particles = sample(ellipsoid, &Settings::with_count(3_000).adaptive())?;
        },
        program! { particles:
            use marching_particles::{Formula, Settings, Spacing, sample};

            let sphere = Formula::parse("x^2 + y^2 + z^2 = 1")?;
            let spacing = Spacing::parse("0.02 + 0.1 hypot(x, y)")?;
            let particles = sample(sphere, &Settings::default().spaced(spacing))?;
        },
        program! { particles:
            use marching_particles::{Formula, Pattern, Settings, sample};

            let sphere = Formula::parse("x^2 + y^2 + z^2 = 1")?;
            let particles = sample(sphere, &Settings::with_count(3_000).with_pattern(Pattern::Blue))?;
            particles.save("stipples.ply")?;
        },
        program! { particles:
            use marching_particles::run::Value;
            use marching_particles::{Formula, Settings, sample};

            let torus = Formula::parse("(sqrt(x^2 + y^2) - 1)^2 + z^2 = 0.16")?;
            let mut particles = sample(&torus, &Settings::with_count(3_000))?;
            particles.add_value(&torus, "H", &Value::parse("(k_1 + k_2)/2")?)?;
            particles.save("curvature.csv")?;
        },
        program! { particles:
            use marching_particles::{Bounds, Formula, Settings, sample};

            let gyroid = Formula::parse("sin(x)cos(y) + sin(y)cos(z) + sin(z)cos(x)")?;
            let shell = gyroid.thickened(0.4).closed_by(&Bounds::cube(3.0));
            let particles = sample(shell, &Settings::with_count(8_000))?;
            particles.save("gyroid.3mf")?;
        },
        program! { particles:
            use marching_particles::{Bounds, Settings, glam::DVec3, sample};

            let puck = |p: DVec3| (p.truncate().length() - 1.0).max(p.z.abs() - 0.5);
            let particles = sample(puck, &Settings::with_count(3_000).in_box(Bounds::cube(2.0)))?;
        },
        program! { particles:
            use marching_particles::{Settings, fit_points, sample};

            let fit = fit_points("scan.xyz", std::fs::read("scan.xyz")?, 200)?;
            let particles = sample(fit.field(), &Settings::with_count(3_000).in_box(fit.bounds))?;
        },
        program! { particles:
            use marching_particles::{Image, Settings, sample};

            let image = Image::open("scan.npy")?;
            let particles = sample(image.at(100.0)?, &Settings::with_count(3_000))?;
        },
        program! { particles:
            use marching_particles::remesh::MeshOptions;
            use marching_particles::{Settings, TriangleMesh, sample};

            let solid = TriangleMesh::open("part.stl")?.solid()?;
            let field = solid.field(&MeshOptions::default())?;
            let particles = sample(field, &Settings::with_count(3_000).refined())?;
            particles.save("even.stl")?;
        },
    ]
}

/// Points of a sphere with their normals, a line each: those of two grids under the stereographic
/// projection.
fn points() -> String {
    let grid = || (-9..=9).map(|k| f64::from(k) / 9.0);
    let mut lines = String::new();
    for (u, v, side) in grid().flat_map(|u| grid().flat_map(move |v| [(u, v, 1.0), (u, v, -1.0)])) {
        let square = u * u + v * v;
        let [x, y, z] = [2.0 * u, 2.0 * v, side * (1.0 - square)].map(|c| c / (1.0 + square));
        lines += &format!("{x} {y} {z} {x} {y} {z}\n");
    }
    lines
}

/// An image of 32 voxels a side in the format of NumPy: 300 minus the squared distance from its
/// middle.
fn image() -> Vec<u8> {
    let header = "{'descr': '<i2', 'fortran_order': False, 'shape': (32, 32, 32), }";
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend(118_u16.to_le_bytes());
    file.extend(format!("{header:<117}\n").bytes());
    let squares = |k: i16| (k - 16) * (k - 16);
    for (i, j, k) in (0..32).flat_map(|i| (0..32).flat_map(move |j| (0..32).map(move |k| (i, j, k)))) {
        file.extend((300 - squares(i) - squares(j) - squares(k)).to_le_bytes());
    }
    file
}

#[test]
fn every_program_makes_the_particles_of_its_task() {
    let page = fs::read_to_string(golden::checkout().join("docs/cookbook.md")).expect("the cookbook");
    let mut kept: Vec<Task> = golden::read("cookbook.json");
    let tasks = tasks(&page);
    kept.resize_with(tasks.len(), || Task { title: String::new(), digest: String::new() });
    let folder = tempfile::tempdir().expect("a folder");
    env::set_current_dir(&folder).expect("the folder");
    fs::write("scan.xyz", points()).expect("points");
    fs::write("scan.npy", image()).expect("an image");

    let without_space = |text: &str| text.split_whitespace().collect::<String>();
    let (mut faults, mut commands) = (Vec::new(), 0);
    let programs = programs();
    assert_eq!(programs.len(), tasks.len(), "each task has a program in Rust");
    for (((title, text), (run, lines)), kept) in tasks.iter().zip(programs).zip(&mut kept) {
        let printed = program(text, "rust").unwrap_or_else(|| panic!("{title}: no program in Rust"));
        assert_eq!(without_space(printed), without_space(lines), "{title}: the test has another program");
        let sample = run().unwrap_or_else(|error| panic!("{title}: {error}"));
        let digest = format!("{:016x}", sample.particles().digest());
        if let Some(script) = program(text, "sh") {
            assert_eq!(sampled_by_shell(script), digest, "{title}: the command makes other particles");
            commands += 1;
        }
        kept.title = (*title).to_owned();
        golden::compare(title, &mut kept.digest, digest, &mut faults);
    }
    assert!(commands > 8, "{commands} commands were run");
    golden::finish("cookbook.json", &kept, &faults, "cookbook");
}
