//! Benches, native and in a browser, with what a figure needs to be cited: machine and commit.

use std::fs;
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::bundle::{self, Bundle, Declarations, Purpose};
use crate::chromium;
use crate::node;
use crate::project::{Project, cargo, rustc};
use crate::step;

/// Which benches to run.
#[derive(clap::Args)]
pub(crate) struct Options {
    /// The whole job in a worker of headless Chromium, in place of the native benches.
    #[arg(long)]
    web: bool,
    /// Natively: the job with a million particles as well.
    #[arg(long, conflicts_with = "web")]
    full: bool,
}

/// Runs the benches and prints their figures.
pub(crate) fn bench(project: &Project, options: &Options) -> Result<()> {
    println!("  {}", machine(project));
    if options.web {
        node::prepare(project)?;
        let chromium = chromium::find(project)?;
        bundle::build(project, &[Bundle::Core], Purpose::Site, Declarations::Hold)?;
        let mut command = Command::new(node::node()?);
        return show(
            command.current_dir(&project.root).arg("tests/wasm/bench.mjs").env("CHROMIUM_PATH", chromium),
        );
    }
    let mut formula = Command::new(cargo());
    show(formula.current_dir(&project.root).args([
        "bench",
        "--package",
        "benches",
        "--locked",
        "--bench",
        "formula",
        "--",
        "--quick",
    ]))?;
    let mut whole = Command::new(cargo());
    whole.current_dir(&project.root).args(["bench", "--package", "benches", "--locked", "--bench", "whole"]);
    if !options.full {
        whole.args(["--", "quick"]);
    }
    show(&mut whole)
}

/// Runs a command and shows its output.
fn show(command: &mut Command) -> Result<()> {
    let line = step::command_line(command);
    let status = command.status().with_context(|| format!("could not start `{line}`"))?;
    if !status.success() {
        bail!("`{line}` failed ({status})");
    }
    Ok(())
}

/// Processor, compiler and commit, as far as they are known.
pub(crate) fn machine(project: &Project) -> String {
    let answer = |program: &str, arguments: &[&str]| {
        let mut command = Command::new(program);
        step::capture(command.args(arguments).current_dir(&project.root), "")
            .map(|text| text.trim().to_owned())
            .ok()
    };
    let processor = fs::read_to_string("/proc/cpuinfo")
        .ok()
        .and_then(|text| {
            text.lines()
                .find_map(|line| line.strip_prefix("model name")?.split_once(": "))
                .map(|(_, name)| name.to_owned())
        })
        .or_else(|| answer("sysctl", &["-n", "machdep.cpu.brand_string"]))
        .unwrap_or_else(|| std::env::consts::ARCH.to_owned());
    let cores = std::thread::available_parallelism().map_or(0, std::num::NonZero::get);
    let compiler = answer(&rustc().to_string_lossy(), &["--version"]).unwrap_or_default();
    let commit = answer("git", &["describe", "--always", "--dirty"])
        .map_or_else(|| "no commit".to_owned(), |name| format!("commit {name}"));
    format!("{processor}, {cores} cores; {compiler}; {commit}")
}
