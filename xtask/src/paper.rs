//! Reproduces the paper's tables and figures: `docs/tables/paper.md` and the pictures in
//! `docs/images/paper`.

use std::fs;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};

use crate::bench::machine;
use crate::chromium;
use crate::node;
use crate::project::{Project, cargo};
use crate::step;

/// How long to run.
#[derive(clap::Args)]
pub(crate) struct Options {
    /// Cut a run of the particle systems off after so many seconds of processor time.
    #[arg(long, value_name = "SECONDS", default_value_t = 30)]
    limit: u32,
    /// Run so many jobs at a time, each in a thread of its own.
    #[arg(long, value_name = "N", default_value_t = 1)]
    threads: u32,
}

/// Runs the jobs, then writes the tables and the pictures.
pub(crate) fn paper(project: &Project, options: &Options) -> Result<()> {
    node::prepare(project)?;
    let chromium = chromium::find(project)?;
    let machine = machine(project);
    println!("  {machine}");
    let drawn = project.scratch("paper")?;
    let mut bench = Command::new(cargo());
    bench.current_dir(&project.root).args([
        "bench",
        "--package",
        "benches",
        "--locked",
        "--bench",
        "paper",
        "--",
    ]);
    bench.args(["--limit", &options.limit.to_string(), "--threads", &options.threads.to_string()]);
    bench.args(["--machine", &machine, "--pictures"]).arg(&drawn);
    let line = step::command_line(&bench);
    let output =
        bench.stderr(Stdio::inherit()).output().with_context(|| format!("could not start `{line}`"))?;
    if !output.status.success() {
        bail!("`{line}` failed ({})", output.status);
    }
    let docs = project.root.join("docs");
    let pictures = docs.join("images/paper");
    if pictures.exists() {
        fs::remove_dir_all(&pictures).context("could not replace the pictures of the paper")?;
    }
    fs::create_dir_all(&pictures).context("could not create docs/images/paper")?;
    let mut convert = Command::new(node::node()?);
    convert.current_dir(&project.www).arg("pictures/paper.js").args([&drawn, &pictures]);
    step::run("pictures (WebP)", convert.env("CHROMIUM_PATH", chromium), "")?;
    let tables = docs.join("tables").join("paper.md");
    fs::write(&tables, output.stdout).with_context(|| format!("could not write {}", tables.display()))?;
    println!("  wrote {}", project.relative(&tables).display());
    Ok(())
}
