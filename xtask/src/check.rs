//! The project's checks, which are also what runs in continuous integration.

use std::path::Path;
use std::process::Command;
use std::thread;

use anyhow::{Result, bail};
use clap::ValueEnum as _;
use serde_json::Value;

use crate::bundle::{self, Bundle, Purpose};
use crate::chromium;
use crate::deny;
use crate::engines;
use crate::node;
use crate::project::{Project, cargo};
use crate::site;
use crate::step;
use crate::wasm_target::WasmTarget;

/// A part of the checks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Part {
    /// rustfmt.
    Format,
    /// Licences, sources and duplicates of the dependencies; skipped, with the reason, without cargo-deny.
    Deny,
    /// Clippy on everything that is compiled natively, warnings denied.
    Lint,
    /// Clippy on the library as WebAssembly, with what JavaScript sees of it, warnings denied.
    LintWasm,
    /// rustdoc, warnings denied.
    Docs,
    /// Unit, integration and documentation tests, and every example.
    Native,
    /// The core, the solver for points and the lesson as WebAssembly, in Node, against the digests of the native ones.
    Parity,
    /// Mesh files against Khronos' glTF validator.
    Gltf,
    /// The page: format, lint, types, unit tests and those of its engine with the core, in Node.
    Page,
    /// The built site in Chromium, at / and in a sub-path.
    Browser,
    /// A core of the browser tests in Firefox and WebKit; skipped, with the reason, where they cannot be had.
    Engines,
}

/// Everything, the quick checks first.
const ALL: [Part; 11] = [
    Part::Format,
    Part::Deny,
    Part::Lint,
    Part::Native,
    Part::Docs,
    Part::LintWasm,
    Part::Parity,
    Part::Gltf,
    Part::Page,
    Part::Browser,
    Part::Engines,
];

/// Parts that make and check the bundles of the page. These parts run beside those that compile natively, because the last crate of
/// every build takes one processor only.
const BUNDLES: [Part; 2] = [Part::Parity, Part::Page];

/// Parts that drive a browser, which takes all processors and waits for time to pass: they run last and alone.
const BROWSERS: [Part; 2] = [Part::Browser, Part::Engines];

/// Without WebAssembly and a browser.
const FAST: [Part; 3] = [Part::Format, Part::Lint, Part::Native];

/// Which checks to run.
#[derive(clap::Args)]
pub(crate) struct Options {
    /// Only format, lint and native.
    #[arg(long, conflicts_with = "parts")]
    fast: bool,
    /// The parts to run; everything if none is named.
    parts: Vec<Part>,
}

impl Options {
    fn parts(&self) -> Vec<Part> {
        if self.fast {
            FAST.to_vec()
        } else if self.parts.is_empty() {
            ALL.to_vec()
        } else {
            self.parts.clone()
        }
    }
}

/// Runs the checks. Parts that fail do not keep the others from running; the first line of each failure is repeated at
/// the end.
pub(crate) fn test(project: &Project, options: &Options) -> Result<()> {
    let parts = options.parts();
    // What may be missing is looked for before the long builds start.
    if parts
        .iter()
        .any(|part| matches!(part, Part::Parity | Part::Gltf | Part::Page | Part::Browser | Part::Engines))
    {
        node::prepare(project)?;
    }
    let chromium = if parts.contains(&Part::Browser) { Some(chromium::find(project)?) } else { None };
    let of = |is_of: &dyn Fn(&Part) -> bool| parts.iter().copied().filter(is_of).collect::<Vec<_>>();
    let browsers = of(&|part| BROWSERS.contains(part));
    let bundles = of(&|part| BUNDLES.contains(part));
    let native = of(&|part| !BUNDLES.contains(part) && !BROWSERS.contains(part));
    let chromium = chromium.as_deref();
    let mut failures = thread::scope(|scope| {
        let beside = scope.spawn(|| run(project, &bundles, chromium));
        let mut failures = run(project, &native, chromium);
        failures.extend(beside.join().unwrap_or_else(|_| vec!["a part ended with a panic".to_owned()]));
        failures
    });
    failures.extend(run(project, &browsers, chromium));
    if !failures.is_empty() {
        bail!("failed: {}", failures.join(", "));
    }
    println!("  all passed");
    Ok(())
}

/// Runs parts one after the other and returns the names of those that failed.
fn run(project: &Project, parts: &[Part], chromium: Option<&Path>) -> Vec<String> {
    let mut failures = Vec::new();
    for part in parts {
        let result = match part {
            Part::Format => format(project),
            Part::Deny => deny::test(project),
            Part::Lint => lint(project),
            Part::LintWasm => lint_wasm(project),
            Part::Docs => docs(project),
            Part::Native => native(project),
            Part::Parity => parity(project),
            Part::Gltf => gltf(project),
            Part::Page => page(project),
            Part::Browser => browser(project, chromium),
            Part::Engines => site::build(project).and_then(|()| engines::test(project)),
        };
        if let Err(error) = result {
            eprintln!("\nerror: {error:#}\n");
            failures
                .push(part.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default());
        }
    }
    failures
}

fn cargo_at_root(project: &Project, arguments: &[&str]) -> Command {
    let mut command = Command::new(cargo());
    command.current_dir(&project.root).args(arguments);
    command
}

fn format(project: &Project) -> Result<()> {
    let mut command = cargo_at_root(project, &["fmt", "--all", "--check"]);
    step::run("format", &mut command, "`cargo fmt --all` puts it right.").map(drop)
}

fn lint(project: &Project) -> Result<()> {
    let mut command = cargo_at_root(project, &["clippy", "--all-targets"]);
    command.args(TESTED).args(["--", "--deny", "warnings"]);
    step::run("lint (native)", &mut command, "").map(drop)
}

/// One pass for all bundles: their features can be had together. That for WebGL2 is left out, because no line of the sources
/// depends on which back end the renderer has.
fn lint_wasm(project: &Project) -> Result<()> {
    let features =
        [Bundle::Core, Bundle::Points, Bundle::Lesson, Bundle::Webgpu].map(Bundle::features).join(",");
    let mut command = WasmTarget::prepare(project)?.cargo(project, "clippy");
    command.args([
        "--package",
        "marching-particles",
        "--lib",
        "--no-default-features",
        "--features",
        &features,
    ]);
    command.args(["--locked", "--", "--deny", "warnings"]);
    step::run("lint (wasm32)", &mut command, "").map(drop)
}

fn docs(project: &Project) -> Result<()> {
    let mut command = cargo_at_root(project, &["doc", "--no-deps"]);
    command.args(TESTED).env("RUSTDOCFLAGS", "--deny warnings");
    step::run("documentation", &mut command, "")?;
    let mut command = cargo_at_root(project, &["package", "--package", "marching-particles"]);
    command.args(["--no-verify", "--allow-dirty", "--locked"]);
    step::run("package", &mut command, "").map(drop)
}

/// What is compiled natively. Every command names it, because another choice of features has cargo compile everything again.
const TESTED: [&str; 4] = ["--workspace", "--features", "marching-particles/cli", "--locked"];

fn native(project: &Project) -> Result<()> {
    let mut build = cargo_at_root(project, &["test", "--no-run", "--message-format=json-render-diagnostics"]);
    let messages = step::run("native tests: compile", build.args(TESTED), "")?;
    let mut tests = cargo_at_root(project, &["test", "--no-fail-fast"]);
    step::run("native tests", tests.args(TESTED), "")?;
    examples(project, &messages)
}

/// Runs every example that cargo says it has compiled, in a folder of its own, where it may write files.
fn examples(project: &Project, messages: &str) -> Result<()> {
    let folder = project.scratch("examples")?;
    let mut found = false;
    for message in messages.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok()) {
        let target = &message["target"];
        let (Some("example"), Some(name)) = (target["kind"][0].as_str(), target["name"].as_str()) else {
            continue;
        };
        let Some(executable) = message["executable"].as_str() else { continue };
        step::run(&format!("example {name}"), Command::new(executable).current_dir(&folder), "")?;
        found = true;
    }
    if !found && project.root.join("examples").is_dir() {
        bail!("cargo compiled no example of examples/");
    }
    Ok(())
}

fn parity(project: &Project) -> Result<()> {
    bundle::build(project, &[Bundle::Core, Bundle::Points, Bundle::Lesson], Purpose::Site)?;
    for script in ["tests/wasm/parity.mjs", "tests/wasm/points.mjs", "tests/wasm/lesson.mjs"] {
        let mut command = Command::new(node::node()?);
        command.current_dir(&project.root).arg(script);
        step::run(&format!("the same digests in WebAssembly as natively ({script})"), &mut command, "")?;
    }
    Ok(())
}

fn gltf(project: &Project) -> Result<()> {
    let mut tests = cargo_at_root(project, &["test"]);
    step::run("mesh files", tests.args(TESTED).args(["--test", "it", "mesh_export::"]), "")?;
    let mut command = Command::new(node::node()?);
    command.current_dir(&project.root).arg("tests/gltf/validate.mjs").arg(project.target.join("tmp"));
    step::run("mesh files: Khronos' glTF validator", &mut command, "").map(drop)
}

fn page(project: &Project) -> Result<()> {
    let mut lint = node::npm()?;
    lint.args(["run", "--silent", "lint"]).current_dir(&project.www);
    step::run("page: format and lint", &mut lint, "`npm run format` in www/ puts most of it right.")?;
    bundle::build(project, &Bundle::ALL, Purpose::Site)?;
    node::script(project, "page: types", "check", &[])?;
    node::script(project, "page: unit tests", "test", &[]).map(drop)
}

fn browser(project: &Project, chromium: Option<&Path>) -> Result<()> {
    site::build(project)?;
    site::report_sizes(project)?;
    let chromium = chromium.map(|path| path.to_string_lossy().into_owned()).unwrap_or_default();
    let told = node::script(project, "page: browser tests", "e2e", &[("CHROMIUM_PATH", &chromium)])?;
    for line in flaky(&told) {
        println!("{line}");
    }
    Ok(())
}

/// The part of Playwright's summary that names the tests which passed only when they were repeated.
fn flaky(told: &str) -> impl Iterator<Item = &str> {
    told.lines().skip_while(|line| !line.ends_with(" flaky")).take_while(|line| !line.contains(" passed ("))
}

#[cfg(test)]
mod tests {
    #[test]
    fn only_repeated_tests_are_told_of() {
        let told = "  \u{2713} 1 a test\n\n  1 flaky\n    [webgl2] another test\n  2 passed (1.0m)\n";
        assert_eq!(super::flaky(told).collect::<Vec<_>>(), ["  1 flaky", "    [webgl2] another test"]);
        assert_eq!(super::flaky("  3 passed (1.0m)\n").count(), 0);
    }
}
