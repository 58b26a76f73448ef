//! The project's checks: those of every change, which continuous integration runs, and those of a
//! release.

use std::path::Path;
use std::process::Command;
use std::thread;
use std::time::{Instant, SystemTime, UNIX_EPOCH};

use anyhow::{Result, bail};
use clap::ValueEnum as _;

use crate::browsers;
use crate::bundle::{self, Bundle, Declarations, Purpose};
use crate::chromium;
use crate::deny;
use crate::native;
use crate::node;
use crate::pictures;
use crate::project::{Project, cargo};
use crate::python;
use crate::readers;
use crate::site;
use crate::step;
use crate::times;
use crate::wasm_target::{self, WasmTarget};

/// A part of the checks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Part {
    /// rustfmt.
    Format,
    /// Clippy on everything that is compiled natively for every change, warnings denied.
    Lint,
    /// Clippy on the benches and on the renderer on Vulkan, warnings denied.
    LintRest,
    /// Clippy on the library as WebAssembly, with what JavaScript sees of it, warnings denied.
    LintWasm,
    /// Unit, integration and documentation tests, and every example.
    Native,
    /// The core, the solver for points and the lesson as WebAssembly, in Node, against the digests
    /// of the native ones.
    Parity,
    /// The page: format, lint, types, unit tests and those of its engine with the core, in Node.
    Page,
    /// The built site in Chromium, at / and in a sub-path.
    Chromium,
    /// Licences, sources and duplicates of the dependencies; skipped, with the reason, without
    /// cargo-deny.
    Deny,
    /// rustdoc, warnings denied, the crate as cargo would publish it, and a program that depends on
    /// it.
    Docs,
    /// The bundles of the published site, held to their budgets and to the digests of the native
    /// core.
    Release,
    /// Mesh files against Khronos' glTF validator.
    Gltf,
    /// Files of every format in the programs that people read them with; skipped, with the reason,
    /// without Python.
    Readers,
    /// The Python package: a wheel is built, installed and tested; skipped, with the reason,
    /// without Python 3.9.
    Python,
    /// Pictures of the renderer, drawn natively by Vulkan, against those that are kept.
    Pictures,
    /// A core of the browser tests in Firefox and WebKit; skipped, with the reason, where they
    /// cannot be had.
    Browsers,
    /// Hundreds of resamplings in Chromium, after which the page holds no more memory than before.
    Soak,
}

/// The parts that run on every change.
const USUAL: [Part; 7] =
    [Part::Format, Part::Lint, Part::Native, Part::LintWasm, Part::Parity, Part::Page, Part::Chromium];

/// Everything.
const ALL: [Part; 17] = [
    Part::Format,
    Part::Deny,
    Part::Lint,
    Part::LintRest,
    Part::Native,
    Part::Docs,
    Part::LintWasm,
    Part::Gltf,
    Part::Readers,
    Part::Python,
    Part::Pictures,
    Part::Parity,
    Part::Release,
    Part::Page,
    Part::Chromium,
    Part::Browsers,
    Part::Soak,
];

/// Parts that build and check the bundles of the page. They run in parallel with native
/// compilation, because the last crate of every build uses one processor only.
const BUNDLES: [Part; 3] = [Part::Parity, Part::Release, Part::Page];

/// Parts that drive a browser, which takes all processors and waits for time to pass: they run last
/// and alone.
const BROWSERS: [Part; 3] = [Part::Chromium, Part::Browsers, Part::Soak];

/// The parts without WebAssembly and browser.
const FAST: [Part; 3] = [Part::Format, Part::Lint, Part::Native];

/// Which checks to run.
#[derive(clap::Args)]
pub(crate) struct Options {
    /// Only format, lint and native.
    #[arg(long, conflicts_with_all = ["parts", "all"])]
    fast: bool,
    /// Everything that the published site is held to: besides the usual parts the documentation,
    /// the bundles and the site as they are published, Firefox and WebKit, files in the programs
    /// that read them, the Python package, pictures drawn natively, all random cases, and a soak.
    /// With parts: these, on the published bundles and with all random cases.
    #[arg(long)]
    all: bool,
    /// The parts to run; the usual ones if none is named.
    parts: Vec<Part>,
}

impl Options {
    fn parts(&self) -> Vec<Part> {
        if self.fast {
            FAST.to_vec()
        } else if !self.parts.is_empty() {
            self.parts.clone()
        } else if self.all {
            ALL.to_vec()
        } else {
            USUAL.to_vec()
        }
    }
}

/// Data shared by the parts.
struct Checks<'a> {
    project: &'a Project,
    /// The bundles that the page and its tests use.
    purpose: Purpose,
    chromium: Option<&'a Path>,
    /// The variables that choose the random cases.
    cases: [(&'static str, String); 2],
}

/// Runs the checks. A failing part does not stop the others; the first line of each failure is
/// repeated at the end.
pub(crate) fn test(project: &Project, options: &Options) -> Result<()> {
    let started = Instant::now();
    let parts = options.parts();
    let of = |is_of: &dyn Fn(&Part) -> bool| parts.iter().copied().filter(is_of).collect::<Vec<_>>();
    let browsers = of(&|part| BROWSERS.contains(part));
    let bundles = of(&|part| BUNDLES.contains(part));
    let native = of(&|part| !BUNDLES.contains(part) && !BROWSERS.contains(part));
    // Missing tools are reported before the long builds start.
    if !browsers.is_empty() || !bundles.is_empty() || native.contains(&Part::Gltf) {
        node::prepare(project)?;
    }
    let needs_chromium = parts.iter().any(|part| matches!(part, Part::Chromium | Part::Soak));
    let chromium = if needs_chromium { Some(chromium::find(project)?) } else { None };
    let cases = random_cases(options.all);
    let checks = Checks {
        project,
        purpose: if options.all { Purpose::Site } else { Purpose::Development },
        chromium: chromium.as_deref(),
        cases,
    };
    let mut failures = thread::scope(|scope| {
        let beside = scope.spawn(|| checks.run(&bundles));
        let mut failures = checks.run(&native);
        failures.extend(beside.join().unwrap_or_else(|_| vec!["a part ended with a panic".to_owned()]));
        failures
    });
    failures.extend(checks.run(&browsers));
    times::print(started.elapsed(), &project.scratch("times")?.join("tests.txt"));
    if !failures.is_empty() {
        bail!("failed: {}", failures.join(", "));
    }
    println!("  all passed");
    Ok(())
}

/// Chooses and prints the random cases: a tenth or all of them, from today's seed unless the
/// environment sets one.
fn random_cases(is_all: bool) -> [(&'static str, String); 2] {
    const SEED: &str = "MARCHING_PARTICLES_SEED";
    const TENTHS: &str = "MARCHING_PARTICLES_TENTHS";
    let today = || SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs() / 86_400);
    let seed = std::env::var(SEED).unwrap_or_else(|_| today().to_string());
    let tenths = std::env::var(TENTHS).unwrap_or_else(|_| if is_all { "10" } else { "1" }.to_owned());
    println!("  random cases: {TENTHS}={tenths} {SEED}={seed}");
    [(SEED, seed), (TENTHS, tenths)]
}

impl Checks<'_> {
    /// Runs parts one after the other and returns the names of those that failed.
    fn run(&self, parts: &[Part]) -> Vec<String> {
        let mut failures = Vec::new();
        for part in parts {
            let started = Instant::now();
            let result = match part {
                Part::Format => format(self.project),
                Part::Deny => deny::test(self.project),
                Part::Lint => lint(self.project),
                Part::LintRest => lint_rest(self.project),
                Part::LintWasm => lint_wasm(self.project),
                Part::Docs => docs(self.project),
                Part::Native => native::test(self.project, &self.cases, self.purpose == Purpose::Site),
                Part::Parity => parity(self.project, Purpose::Development),
                Part::Release => release(self.project),
                Part::Gltf => gltf(self.project),
                Part::Readers => readers::test(self.project),
                Part::Python => python::test(self.project),
                Part::Pictures => pictures::test(self.project),
                Part::Page => self.page(),
                Part::Chromium => self.chromium(self.surveyed()),
                Part::Browsers => self.site().and_then(|()| browsers::test(self.project, self.purpose)),
                Part::Soak => self.chromium(&[("SOAK", "400")]),
            };
            let name = part.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default();
            times::part(&name, started.elapsed());
            if let Err(error) = result {
                eprintln!("\nerror: {error:#}\n");
                failures.push(name);
            }
        }
        failures
    }

    /// Builds the site of the purpose.
    fn site(&self) -> Result<()> {
        site::build(self.project, self.purpose)
    }

    fn page(&self) -> Result<()> {
        let project = self.project;
        let mut lint = node::npm()?;
        lint.args(["run", "--silent", "lint"]).current_dir(&project.www);
        step::run("page: format and lint", &mut lint, "`npm run format` in www/ puts most of it right.")?;
        bundle::build(project, &Bundle::ALL, self.purpose, Declarations::Hold)?;
        node::script(project, "page: types", "check", &[])?;
        let tested = node::script(project, "page: unit tests", "test", self.surveyed());
        times::vitest(&project.www.join("test-results/node.json"));
        tested.map(drop)
    }

    /// The variables for the page's tests: for the published site they run everything, including
    /// tests marked `@all`.
    fn surveyed(&self) -> &'static [(&'static str, &'static str)] {
        if self.purpose == Purpose::Site { &[("ALL", "1")] } else { &[] }
    }

    /// Runs the browser tests, with variables that choose among them.
    fn chromium(&self, variables: &[(&str, &str)]) -> Result<()> {
        self.site()?;
        let chromium = self.chromium.map(|path| path.to_string_lossy().into_owned()).unwrap_or_default();
        let folder = site::folder(self.project, self.purpose);
        let site = folder.to_string_lossy();
        let variables = [variables, &[("CHROMIUM_PATH", chromium.as_str()), ("SITE", &site)]].concat();
        let tested = node::script(self.project, "page: tests in Chromium", "e2e", &variables);
        times::playwright(&self.project.www.join("test-results/chromium.json"));
        tested.map(drop)
    }
}

/// Builds the bundles and the site as published, and checks their digests and budgets.
fn release(project: &Project) -> Result<()> {
    parity(project, Purpose::Site)?;
    site::build(project, Purpose::Site)?;
    site::report_sizes(project)
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
    command.args(native::TESTED).args(["--package", "xtask", "--", "--deny", "warnings"]);
    step::run("lint (native)", &mut command, "").map(drop)
}

/// Clippy on native code that is not compiled for every change: the benches, and the renderer on
/// Vulkan with its pictures.
fn lint_rest(project: &Project) -> Result<()> {
    let mut command = cargo_at_root(project, &["clippy", "--all-targets", "--locked"]);
    command.args(["--package", "benches", "--package", "marching-particles-render", "--features"]);
    command.args(["marching-particles-render/vulkan", "--", "--deny", "warnings"]);
    step::run("lint (benches, Vulkan)", &mut command, "").map(drop)
}

/// One pass for all bundles except that for WebGL2: no source line depends on the renderer's back
/// end.
fn lint_wasm(project: &Project) -> Result<()> {
    let mut command = WasmTarget::prepare(project)?.cargo(project, "clippy");
    for package in [
        "marching-particles",
        Bundle::Core.package(),
        Bundle::Points.package(),
        Bundle::Lesson.package(),
        Bundle::Webgpu.package(),
        "marching-particles-render",
        "marching-particles-values",
    ] {
        command.args(["--package", package]);
    }
    command.args(["--lib", "--locked", "--", "--deny", "warnings"]);
    step::run("lint (wasm32)", &mut command, "").map(drop)
}

fn docs(project: &Project) -> Result<()> {
    let mut command = cargo_at_root(project, &["doc", "--no-deps"]);
    command.args(native::TESTED).args(["--package", "xtask"]).env("RUSTDOCFLAGS", "--deny warnings");
    step::run("documentation", &mut command, "")?;
    let mut command = cargo_at_root(project, &["package", "--package", "marching-particles"]);
    command.args(["--package", "marching-particles-cli", "--no-verify", "--allow-dirty", "--locked"]);
    step::run("package", &mut command, "")?;
    dependent(project)
}

/// A program that depends on the library exports to WebAssembly only its own functions, none of the
/// page's.
fn dependent(project: &Project) -> Result<()> {
    let target = WasmTarget::prepare(project)?;
    let folder = project.target.join("dependent");
    let mut command = target.cargo(project, "build");
    command.args(["--release", "--locked", "--manifest-path", "tests/dependent/Cargo.toml", "--target-dir"]);
    step::run("a program that depends on the library: compile", command.arg(&folder), "")?;
    let mut command = Command::new(node::node()?);
    command.current_dir(&project.root).arg("tests/wasm/dependent.mjs");
    command.arg(folder.join(wasm_target::TARGET).join("release/dependent.wasm"));
    step::run("a program that depends on the library: exports", &mut command, "").map(drop)
}

fn parity(project: &Project, purpose: Purpose) -> Result<()> {
    bundle::build(project, &[Bundle::Core, Bundle::Points, Bundle::Lesson], purpose, Declarations::Hold)?;
    for script in ["tests/wasm/parity.mjs", "tests/wasm/points.mjs", "tests/wasm/lesson.mjs"] {
        let mut command = Command::new(node::node()?);
        command.current_dir(&project.root).arg(script);
        step::run(&format!("the same digests in WebAssembly as natively ({script})"), &mut command, "")?;
    }
    Ok(())
}

fn gltf(project: &Project) -> Result<()> {
    let mut tests = cargo_at_root(project, &["test"]);
    step::run("mesh files", tests.args(native::TESTED).args(["--test", "it", "mesh_export::"]), "")?;
    let mut command = Command::new(node::node()?);
    command.current_dir(&project.root).arg("tests/gltf/validate.mjs").arg(project.target.join("tmp"));
    step::run("mesh files: Khronos' glTF validator", &mut command, "").map(drop)
}
