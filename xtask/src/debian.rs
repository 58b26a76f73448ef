//! Packages of Debian and derived systems.

use std::fs;
use std::process::Command;
use std::sync::OnceLock;

use anyhow::{Result, bail};

use crate::project::on_path;
use crate::step;

/// Installs packages, which provide `what`, if the variable `CI` marks the machine as one for
/// checks: a person's system is not changed without asking.
///
/// # Errors
///
/// If `CI` is not set, the system is not derived from Debian, this process may not install
/// packages, or they cannot be downloaded. The error names the command that installs them.
pub(crate) fn install(what: &str, packages: &[&str]) -> Result<()> {
    /// Whether the package index has been fetched, which is done once.
    static INDEX: OnceLock<()> = OnceLock::new();

    let line = format!("apt-get install {}", packages.join(" "));
    if std::env::var_os("CI").is_none_or(|value| value.is_empty()) {
        bail!("{what} is missing: `{line}` installs it on Debian; with CI=1 this task does that itself");
    }
    if on_path("apt-get").is_none() || !is_root() {
        bail!("{what} is missing, and `{line}` can be run only by root and where there is apt-get");
    }
    if INDEX.set(()).is_ok() {
        step::run("Debian's package index (apt-get update)", Command::new("apt-get").arg("update"), "")?;
    }
    let mut install = Command::new("apt-get");
    install
        .args(["install", "--yes", "--no-install-recommends"])
        .args(packages)
        .env("DEBIAN_FRONTEND", "noninteractive");
    step::run(&format!("{what} (Debian's package)"), &mut install, "").map(drop)
}

/// Whether this process may install packages of the system.
fn is_root() -> bool {
    fs::read_to_string("/proc/self/status").is_ok_and(|status| {
        status
            .lines()
            .find_map(|line| line.strip_prefix("Uid:"))
            .is_some_and(|ids| ids.split_whitespace().nth(1) == Some("0"))
    })
}
