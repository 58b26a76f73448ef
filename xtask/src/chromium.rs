//! A Chromium for the browser tests and the browser bench.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Result, bail};

use crate::debian;
use crate::node;
use crate::project::{Project, on_path};
use crate::step;

/// Variables that give the path of an executable; the one that the page's tests read comes first.
const VARIABLES: [&str; 2] = ["CHROMIUM_PATH", "CHROME"];

/// Names of the headless build on different systems, which uses a third less of the processor.
const HEADLESS: [&str; 2] = ["chromium-headless-shell", "chrome-headless-shell"];

/// Names of the full browser on different systems.
const NAMES: [&str; 5] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome"];

/// Paths outside the search path.
const PLACES: [&str; 3] = [
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
    "/Applications/Chromium.app/Contents/MacOS/Chromium",
    r"C:\Program Files\Google\Chrome\Application\chrome.exe",
];

/// Finds a working Chromium, or installs one: Debian's headless package if the system may be
/// changed, else Playwright's, which goes into the user's cache.
pub(crate) fn find(project: &Project) -> Result<PathBuf> {
    for variable in VARIABLES {
        if let Some(path) = env::var_os(variable).map(PathBuf::from) {
            if starts(&path) {
                return Ok(path);
            }
            bail!("{variable} is {}, which does not start", path.display());
        }
    }
    if let Some(path) = headless() {
        return Ok(path);
    }
    let mut attempts = Vec::new();
    attempts.extend(debian::install("headless Chromium", &["chromium-headless-shell"]).err());
    if let Some(path) = headless().or_else(|| installed(project)) {
        return Ok(path);
    }
    let mut playwright = Command::new(node::node()?);
    playwright.current_dir(&project.www).args([
        "node_modules/@playwright/test/cli.js",
        "install",
        "chromium",
    ]);
    attempts.extend(step::run("Chromium (Playwright's download)", &mut playwright, "").err());
    if let Some(path) = installed(project) {
        return Ok(path);
    }
    // The advice comes last, because the output of the attempts is long.
    bail!(
        "{}\n\nNo Chromium was found, and none could be installed. Any one of these helps:\n\
         \x20 apt-get install chromium-headless-shell      (Debian, as root)\n\
         \x20 cd www && npx playwright install chromium    (Playwright's own)\n\
         \x20 CHROME=/path/to/chrome cargo xtask test      (one that is installed elsewhere)\n\
         \x20 cargo xtask test --fast                      (the tests that need no browser)",
        attempts.iter().map(|error| format!("{error:#}")).collect::<Vec<_>>().join("\n\n")
    )
}

/// The first headless Chromium that starts.
fn headless() -> Option<PathBuf> {
    HEADLESS.iter().filter_map(|name| on_path(name)).find(|path| starts(path))
}

/// The first installed Chromium that starts.
fn installed(project: &Project) -> Option<PathBuf> {
    let named = NAMES.iter().filter_map(|name| on_path(name));
    let placed = PLACES.iter().map(PathBuf::from).filter(|path| path.is_file());
    named.chain(placed).chain(playwrights(project)).find(|path| starts(path))
}

/// The path at which Playwright would install its own.
fn playwrights(project: &Project) -> Option<PathBuf> {
    let ask = "import('@playwright/test').then(({ chromium }) => console.log(chromium.executablePath()))";
    let mut command = Command::new(node::node().ok()?);
    command.current_dir(&project.www).args(["--input-type=module", "--eval", ask]);
    let path = PathBuf::from(step::capture(&mut command, "").ok()?.trim());
    path.is_file().then_some(path)
}

/// Whether the executable starts: a download without the system libraries it needs does not.
fn starts(path: &Path) -> bool {
    // Chrome on Windows prints no version; its existence must suffice.
    cfg!(windows) && path.is_file() || step::capture(Command::new(path).arg("--version"), "").is_ok()
}
