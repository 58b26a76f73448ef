//! Tests of `sample --print`: the command and the Rust program are run here, the programs in Python
//! and JavaScript by the tests of their packages, all from `tests/golden/code.json`.
//!
//! A change that is meant to alter programs or particles rewrites the file: `UPDATE_GOLDEN=1 cargo
//! test --test it code::`.

use crate::golden;
use marching_particles::Sample;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::error::Error;
use std::process::{Command, Output};

const TOOL: &str = env!("CARGO_BIN_EXE_marching-particles");
const LANGUAGES: [&str; 4] = ["rust", "js", "python", "shell"];

/// Arguments of `sample`, and what comes of them.
#[derive(Serialize, Deserialize)]
struct Case {
    arguments: Vec<String>,
    /// Digest of the particles.
    digest: String,
    /// The program in each language, or why there is none.
    programs: BTreeMap<String, String>,
}

fn text(bytes: Vec<u8>) -> String {
    String::from_utf8(bytes).expect("text")
}

fn digest(output: Output) -> String {
    assert!(output.status.success(), "{}", text(output.stderr));
    let run: serde_json::Value = serde_json::from_slice(&output.stdout).expect("a line of JSON");
    run["digest"].as_str().expect("a digest").to_owned()
}

fn sampled(arguments: &[String]) -> String {
    let mut tool = Command::new(TOOL);
    digest(tool.args(["sample", "--json", "--report", "none"]).args(arguments).output().expect("the tool"))
}

/// The program, or the message in its place.
fn printed(arguments: &[String], language: &str) -> String {
    let mut tool = Command::new(TOOL);
    let output = tool.arg("sample").args(arguments).args(["--print", language]).output().expect("the tool");
    if output.status.success() { text(output.stdout) } else { text(output.stderr) }
}

/// Runs a printed command and returns the digest of its sample.
fn sampled_by_shell(command: &str) -> String {
    let arguments = command.trim_end().strip_prefix("marching-particles ").expect("a command");
    let script = format!("\"$0\" {arguments} --json --report none");
    digest(Command::new("sh").args(["-c", &script, TOOL]).output().expect("a shell"))
}

#[test]
fn programs_are_kept() {
    let mut cases: Vec<Case> = golden::read("code.json");
    assert!(cases.len() > 8);
    let mut faults = Vec::new();
    for Case { arguments, digest, programs } in &mut cases {
        let name = arguments.join(" ");
        golden::compare(&name, digest, sampled(arguments), &mut faults);
        let found = LANGUAGES.map(|language| (language.to_owned(), printed(arguments, language)));
        golden::compare(&name, programs, found.into(), &mut faults);
    }
    golden::finish("code.json", &cases, &faults, "code");
}

#[test]
#[cfg(unix)]
fn a_printed_command_makes_the_same_particles() {
    for Case { arguments, digest, programs } in golden::read::<Vec<Case>>("code.json") {
        let command = &programs["shell"];
        assert_eq!(sampled_by_shell(command), digest, "{} became {command}", arguments.join(" "));
    }
}

/// The lines of a printed program that make the particles, with the items that they name.
fn lines_of(program: &str) -> String {
    let inner = program.lines().filter(|line| line.starts_with("use ") || line.starts_with("    "));
    inner.take_while(|line| !line.contains("println!")).collect()
}

/// Lines of a program in Rust: what they sample, and themselves.
macro_rules! lines {
    ($particles:ident: $($line:tt)*) => {{
        let run = || -> Result<Sample, Box<dyn Error>> {
            $($line)*
            Ok($particles)
        };
        (run().expect("particles"), stringify!($($line)*))
    }};
}

#[test]
fn a_printed_program_in_rust_makes_the_same_particles() {
    let compiled = [
        lines! { particles:
            use marching_particles::{Formula, Settings, sample};
            let surface = Formula::parse("x^4 + y^4 + z^4 = a")?.with("a", 0.5)?;
            let settings = Settings::with_count(2_000).refined();
            let particles = sample(surface, &settings)?;
        },
        lines! { particles:
            use marching_particles::{Bounds, Formula, Radius, Settings, sample};
            let surface = Formula::parse("(sqrt(x^2 + y^2) - R)^2 + z^2 = r^2")?
                .with("R", 1.0)?
                .with("r", 0.25)?;
            let mut settings = Settings::default()
                .in_box(Bounds { min: [-1.65, -1.65, -0.55], max: [1.65, 1.65, 0.55] });
            settings.radius = Some(Radius::Share(0.02));
            let particles = sample(surface, &settings)?;
        },
        lines! { particles:
            use marching_particles::{Formula, GapPolicy, Radius, Settings, sample};
            let surface = Formula::parse("max(abs(x), abs(y), abs(z)) - 1")?;
            let mut settings = Settings::default().seeded(7);
            settings.radius = Some(Radius::Length(0.08));
            settings.relax_steps = 3;
            settings.gaps = GapPolicy::Leave;
            let particles = sample(surface, &settings)?;
        },
        lines! { particles:
            use marching_particles::{Bounds, Formula, Radius, Settings, sample};
            let surface = Formula::parse("x^2 + y^2 = 1 + z^2")?
                .thickened(0.2)
                .closed_by(&Bounds::cube(4.0));
            let mut settings = Settings::default();
            settings.radius = Some(Radius::Share(0.03));
            let particles = sample(surface, &settings)?;
        },
        lines! { particles:
            use marching_particles::run::Value;
            use marching_particles::{Formula, Settings, sample};
            let surface = Formula::parse("(hypot(x, y) - 1)^2 + z^2 = r^2")?.with("r", 0.4)?;
            let settings = Settings::with_count(500);
            let mut particles = sample(&surface, &settings)?;
            particles.add_value(&surface, "H", &Value::parse("(k_1+k_2)/2")?)?;
            particles.add_value(&surface, "share", &Value::parse("r = 0.4; z/r")?)?;
        },
    ];
    let cases: Vec<Case> = golden::read("code.json");
    let without_space = |text: &str| text.split_whitespace().collect::<String>();
    for (sample, lines) in compiled {
        let is_same = |case: &&Case| without_space(&lines_of(&case.programs["rust"])) == without_space(lines);
        let case = cases.iter().find(is_same).unwrap_or_else(|| panic!("no case prints {lines}"));
        assert_eq!(format!("{:016x}", sample.particles().digest()), case.digest, "{lines}");
    }
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn a_file_prints_the_program_that_makes_it() {
    let arguments = ["--surface", "gyroid", "--closed", "--thickness", "0.4", "--count", "800"];
    let path = concat!(env!("CARGO_TARGET_TMPDIR"), "/printed.glb");
    let made =
        sampled(&arguments.iter().chain(&["--mesh", path]).map(|a| (*a).to_owned()).collect::<Vec<_>>());
    let again = ["--like", path].map(str::to_owned);
    assert_eq!(sampled(&again), made);
    assert_eq!(sampled_by_shell(&printed(&again, "shell")), made);
}

#[test]
#[cfg(unix)]
fn the_documents_show_what_is_printed() {
    let page = include_str!("../../../../docs/command-line.md");
    let (_, shown) = page.split_once("$ marching-particles sample --formula").expect("a command");
    let (arguments, rest) = shown.split_once('\n').expect("what it prints");
    let script = format!("\"$0\" sample --formula{arguments}");
    let output = Command::new("sh").args(["-c", &script, TOOL]).output().expect("a shell");
    assert_eq!(rest.split("```").next(), Some(&*text(output.stdout)));
}

#[test]
fn there_is_no_program_for_points() {
    for arguments in [["--surface", "bunny"], ["--points", "scan.ply"]] {
        let message = printed(&arguments.map(str::to_owned), "python");
        assert_eq!(message, "error: --print is for formulas, not for models from points\n");
    }
}
