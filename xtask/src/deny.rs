//! Licences, sources and duplicates of the dependencies, checked by cargo-deny with `deny.toml`.
//!
//! The check reads only files of this machine. So it does not fail because a registry is
//! unreachable or a vulnerability has become known. If it cannot run, the reason is printed and it
//! is skipped.

use std::process::Command;

use anyhow::{Context as _, Result, bail};

use crate::project::{Project, cargo, on_path};
use crate::step;

const LABEL: &str = "dependencies: licences, sources, duplicates";

/// Checks the dependencies.
///
/// # Errors
///
/// If a dependency breaks a rule of `deny.toml`.
pub(crate) fn test(project: &Project) -> Result<()> {
    if let Err(error) = prepare(project) {
        println!("  {LABEL} … SKIPPED: {error:#}");
        return Ok(());
    }
    let mut command = Command::new(cargo());
    command
        .current_dir(&project.root)
        .args(["deny", "--workspace", "--locked", "--offline", "--log-level", "warn"])
        .args(["check", "--hide-inclusion-graph", "licenses", "bans", "sources"]);
    step::run(LABEL, &mut command, "deny.toml has the rules.").map(drop)
}

/// Finds cargo-deny and every dependency of every platform.
fn prepare(project: &Project) -> Result<()> {
    if on_path("cargo-deny").is_none() {
        bail!("cargo-deny is not installed (`cargo install --locked cargo-deny` takes some minutes)");
    }
    let mut fetch = Command::new(cargo());
    fetch.current_dir(&project.root).args(["fetch", "--locked", "--quiet"]);
    step::capture(&mut fetch, "").context("the sources of the dependencies are not all here").map(drop)
}
