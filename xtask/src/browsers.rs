//! A part of the browser tests in Firefox and in WebKit. An engine that is not available is
//! skipped, and the reason is printed.

use std::path::PathBuf;
use std::process::Command;
use std::{env, fs};

use anyhow::{Context as _, Result};

use crate::bundle::Purpose;
use crate::debian;
use crate::node;
use crate::project::{Project, on_path};
use crate::site;
use crate::step;

/// Runs the tests in each engine.
///
/// # Errors
///
/// If a test fails in an engine.
pub(crate) fn test(project: &Project, purpose: Purpose) -> Result<()> {
    for (engine, command) in [("Firefox", firefox()), ("WebKit", webkit())] {
        let label = format!("page: browser tests in {engine}");
        match command {
            Ok(mut command) => {
                command.current_dir(&project.www).env("SITE", site::folder(project, purpose));
                step::run(&label, &mut command, "")?;
            }
            Err(error) => println!("  {label} … SKIPPED: {error:#}"),
        }
    }
    Ok(())
}

/// The tests, for Node's own test runner.
const SUITE: [&str; 2] = ["--test", "tests/browsers/suite.js"];

/// Returns the command that tests Firefox.
fn firefox() -> Result<Command> {
    let installed = || on_path("firefox-esr").or_else(|| on_path("firefox"));
    let path = or_install(installed, "Firefox", &["firefox-esr"])?;
    let mut command = Command::new(node::node()?);
    command.args(SUITE).env("ENGINE", "firefox").env("FIREFOX_PATH", path);
    Ok(command)
}

/// Returns the command that tests WebKitGTK, on a virtual screen if there is no other.
fn webkit() -> Result<Command> {
    let packages = ["webkit2gtk-driver", "xvfb", "xauth"];
    let driver = or_install(|| on_path("WebKitWebDriver"), "WebKit", &packages)?;
    let browser = mini_browser().context("WebKitWebDriver is there, but no MiniBrowser")?;
    let mut command = if env::var_os("DISPLAY").is_some() {
        Command::new(node::node()?)
    } else {
        let mut screen = Command::new(or_install(|| on_path("xvfb-run"), "a virtual screen", &packages)?);
        screen.arg("--auto-servernum").arg(node::node()?);
        screen
    };
    command.args(SUITE).env("ENGINE", "webkit").env("WEBKIT_DRIVER", driver).env("WEBKIT_BROWSER", browser);
    Ok(command)
}

/// Returns WebKitGTK's own test browser, which is on no search path.
fn mini_browser() -> Option<PathBuf> {
    let libraries = fs::read_dir("/usr/lib").ok()?.flatten().map(|entry| entry.path());
    libraries
        .flat_map(|folder| {
            ["4.1", "4.0"].map(|version| folder.join(format!("webkit2gtk-{version}/MiniBrowser")))
        })
        .find(|path| path.is_file())
}

/// Returns what `installed` finds, if necessary after installing the packages.
fn or_install(installed: impl Fn() -> Option<PathBuf>, what: &str, packages: &[&str]) -> Result<PathBuf> {
    if let Some(path) = installed() {
        return Ok(path);
    }
    debian::install(what, packages).with_context(|| format!("{what} is not installed"))?;
    installed().with_context(|| format!("the packages {} brought no {what}", packages.join(", ")))
}
