//! The native tests: compiled once, then each executable run separately, so that the time of every
//! test is measured.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result, bail};
use serde_json::Value;

use crate::project::{Project, cargo};
use crate::step;
use crate::times;

/// The packages tested natively. Every command names all of them, because with another set of
/// packages, and so of features, cargo would recompile everything.
pub(crate) const TESTED: [&str; 9] = [
    "--package",
    "marching-particles",
    "--package",
    "marching-particles-cli",
    "--package",
    "marching-particles-render",
    "--package",
    "tests",
    "--locked",
];

/// An executable that cargo has compiled.
struct Executable {
    name: String,
    path: PathBuf,
    /// The folder of its package.
    folder: PathBuf,
    is_example: bool,
}

/// Compiles and runs the tests and all examples. `variables` are set for the tests. With `is_all`,
/// slow tests, which are otherwise ignored, run, too.
pub(crate) fn test(project: &Project, variables: &[(&str, String)], is_all: bool) -> Result<()> {
    let mut executables = Vec::new();
    for (label, package) in
        [("native tests: compile", &TESTED[..]), ("xtask: compile", &["--package", "xtask"])]
    {
        let mut build = cargo_test(project);
        build.args(package).args(["--no-run", "--message-format=json-render-diagnostics"]);
        executables.extend(compiled(&step::run(label, &mut build, "")?)?);
    }
    let mut failures = Vec::new();
    let scratch = project.scratch("examples")?;
    for executable in &executables {
        let mut command = Command::new(&executable.path);
        command.envs(variables.iter().map(|(name, value)| (name, value)));
        let label = format!("native: {}", executable.name);
        let result = if executable.is_example {
            step::run(&label, command.current_dir(&scratch), "").map(drop)
        } else {
            if is_all {
                // The test that regenerates data needs files that are not in the repository.
                command.args(["--include-ignored", "--skip", "the_bunnies_are_vertices"]);
            }
            step::task(&label, || run(command.current_dir(&executable.folder)))
        };
        if let Err(error) = result {
            eprintln!("\n{error:#}\n");
            failures.push(executable.name.as_str());
        }
    }
    let mut documentation = cargo_test(project);
    step::run("native: documentation", documentation.args(TESTED).arg("--doc"), "")?;
    if !failures.is_empty() {
        bail!("failed: {}", failures.join(", "));
    }
    Ok(())
}

fn cargo_test(project: &Project) -> Command {
    let mut command = Command::new(cargo());
    command.current_dir(&project.root).arg("test");
    command
}

/// The tests and examples in cargo's messages.
fn compiled(messages: &str) -> Result<Vec<Executable>> {
    let mut found = Vec::new();
    for message in messages.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok()) {
        let Some(path) = message["executable"].as_str() else { continue };
        let target = &message["target"];
        let is_example = target["kind"][0] == "example";
        if !is_example && message["profile"]["test"] != true {
            continue;
        }
        let name = target["name"].as_str().unwrap_or_default();
        let kind = target["kind"][0].as_str().unwrap_or_default();
        let manifest = message["manifest_path"].as_str().context("cargo names no manifest")?;
        found.push(Executable {
            name: if matches!(kind, "lib" | "rlib" | "bin") {
                format!("{name} ({kind})")
            } else {
                name.to_owned()
            },
            path: path.into(),
            folder: Path::new(manifest).parent().context("a manifest is in a folder")?.to_owned(),
            is_example,
        });
    }
    if found.is_empty() {
        bail!("cargo compiled no test");
    }
    Ok(found)
}

/// Runs the tests of an executable and records the time of each. The stable compiler's test harness
/// reports times as JSON only if it is treated as a nightly one.
fn run(command: &mut Command) -> Result<()> {
    command.args(["-Z", "unstable-options", "--report-time", "--format", "json"]).env("RUSTC_BOOTSTRAP", "1");
    let output = command.output().with_context(|| format!("could not start {command:?}"))?;
    let told = String::from_utf8_lossy(&output.stdout);
    let (mut failures, mut count) = (String::new(), 0);
    for event in told.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok()) {
        let (Some(name), true) = (event["name"].as_str(), event["type"] == "test") else { continue };
        match event["event"].as_str() {
            Some("ok") => count += 1,
            Some("failed") => {
                let said = event["stdout"].as_str().unwrap_or_default();
                failures.push_str(&format!("\n{name} failed:\n{said}"));
            }
            _ => continue,
        }
        times::test(name, event["exec_time"].as_f64().unwrap_or_default());
    }
    if !failures.is_empty() {
        bail!("{failures}");
    }
    if !output.status.success() {
        bail!("{}\n{told}\n{}", output.status, String::from_utf8_lossy(&output.stderr));
    }
    if count == 0 {
        bail!("it ran no test");
    }
    Ok(())
}
