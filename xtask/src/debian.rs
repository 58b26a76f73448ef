//! Packages of Debian, and of the systems that are made from it.

use std::fs;
use std::process::Command;
use std::sync::OnceLock;

use anyhow::{Result, bail};

use crate::project::on_path;
use crate::step;

/// Installs packages, which bring what is called `what`, where the variable `CI` says that the
/// machine is there for these checks: a system that belongs to somebody is not changed unasked.
///
/// # Errors
///
/// If it is not set, this is no such system, this process may not install packages, or the packages
/// cannot be had. The error says which command installs them.
pub(crate) fn install(what: &str, packages: &[&str]) -> Result<()> {
    /// Whether the index of packages has been fetched. It is fetched once.
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
