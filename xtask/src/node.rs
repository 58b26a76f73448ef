//! Node, npm and the page's packages.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::fingerprint::Fingerprint;
use crate::project::{Project, on_path};
use crate::step;

/// The oldest Node that the page's tools run on.
const MINIMUM_NODE: (u32, u32) = (20, 19);

const GET_NODE: &str = "Install Node.js 20.19 or newer with npm: https://nodejs.org/en/download, or a package such as `nodejs npm`.";

/// Checks that Node and npm are installed, and installs the page's packages as in its lock file.
pub(crate) fn prepare(project: &Project) -> Result<()> {
    let node = node()?;
    let version = step::capture(Command::new(&node).arg("--version"), GET_NODE)?;
    let found = parse_version(&version).with_context(|| format!("`node --version` answered {version:?}"))?;
    if found < MINIMUM_NODE {
        bail!("Node {} is too old.\n\n{GET_NODE}", version.trim());
    }
    let manifest = project.www.join("package.json");
    if !manifest.is_file() {
        bail!(
            "{} is missing: the page's packages cannot be installed",
            project.relative(&manifest).display()
        );
    }
    let wanted = Fingerprint::default()
        .file(&manifest)?
        .file(&project.www.join("package-lock.json"))?
        .text("node", version.trim())
        .finish();
    let stamp = project.www.join("node_modules/.installed");
    if fs::read_to_string(&stamp).is_ok_and(|have| have == wanted) {
        return Ok(());
    }
    let advice = "Is the npm registry reachable? If package.json and package-lock.json disagree, run `npm install` in www/ and commit the lock file.";
    step::run("page packages (npm ci)", npm()?.arg("ci").current_dir(&project.www), advice)?;
    fs::write(&stamp, wanted).with_context(|| format!("could not write {}", stamp.display()))
}

/// Runs one of the page's npm scripts as a step.
pub(crate) fn script(
    project: &Project,
    label: &str,
    name: &str,
    environment: &[(&str, &str)],
) -> Result<String> {
    let mut command = npm()?;
    command.args(["run", "--silent", name]).current_dir(&project.www).envs(environment.iter().copied());
    step::run(label, &mut command, &format!("To see it alone: cd www && npm run {name}"))
}

/// The Node executable.
pub(crate) fn node() -> Result<PathBuf> {
    on_path("node").with_context(|| format!("`node` is not on the search path.\n\n{GET_NODE}"))
}

/// A command that starts npm.
pub(crate) fn npm() -> Result<Command> {
    let name = if cfg!(windows) { "npm.cmd" } else { "npm" };
    if !cfg!(windows) && on_path(name).is_none() {
        bail!("`npm` is not on the search path.\n\n{GET_NODE}");
    }
    Ok(Command::new(name))
}

fn parse_version(text: &str) -> Option<(u32, u32)> {
    let mut numbers = text.trim().strip_prefix('v')?.split('.');
    Some((numbers.next()?.parse().ok()?, numbers.next()?.parse().ok()?))
}

#[cfg(test)]
mod tests {
    use super::parse_version;

    #[test]
    fn node_versions_are_read() {
        assert_eq!(parse_version("v20.19.1\n"), Some((20, 19)));
        assert_eq!(parse_version("20"), None);
    }
}
