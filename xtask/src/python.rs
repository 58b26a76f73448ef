//! Python: the installed interpreter, environments with packages, and the tests of the Python
//! package, for which a wheel is built and installed.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result};

use crate::fingerprint::Fingerprint;
use crate::project::{Project, on_path};
use crate::step;

const LABEL: &str = "python";

/// Builds the wheel as for publishing, installs it in a fresh environment, and runs its tests
/// there. Without Python this check is skipped, and without the notebook's requirements the
/// notebook is; the reason is printed.
///
/// # Errors
///
/// If the wheel cannot be built or installed, or a test fails.
pub(crate) fn test(project: &Project) -> Result<()> {
    let interpreter = match interpreter().and_then(supported) {
        Ok(interpreter) => interpreter,
        Err(error) => {
            println!("  {LABEL} … SKIPPED: {error:#}");
            return Ok(());
        }
    };
    let (sources, scratch) = (project.root.join("python"), project.scratch("python")?);
    let tools = Environment::kept(&interpreter, scratch.join("tools"), &sources.join("tools.txt"), LABEL)?;
    let wheels = scratch.join("wheels");
    // An old wheel must not be mistaken for the one that is built now.
    if wheels.exists() {
        fs::remove_dir_all(&wheels).with_context(|| format!("could not empty {}", wheels.display()))?;
    }
    let mut build = Command::new(tools.program("maturin"));
    build.current_dir(&sources).args(["build", "--locked", "--interpreter"]).arg(tools.program("python"));
    step::run("python: build the wheel", build.arg("--out").arg(&wheels), "")?;
    let entries = fs::read_dir(&wheels).with_context(|| format!("could not read {}", wheels.display()))?;
    let wheel =
        entries.filter_map(Result::ok).map(|entry| entry.path()).next().context("maturin built no wheel")?;
    let fresh = Environment::new(&interpreter, scratch.join("fresh"), LABEL)?;
    let mut install = fresh.pip();
    install.arg(wheel).arg("--requirement").arg(sources.join("tests/requirements.txt"));
    step::run("python: install it, and what it is tested with", &mut install, "Is PyPI reachable?")?;
    let mut install = fresh.pip();
    install.arg("--requirement").arg(sources.join("notebook.txt"));
    let installing = step::Step::begin("python: install what the notebook takes");
    match step::capture(&mut install, "Is PyPI reachable?") {
        Ok(_) => installing.done(""),
        Err(error) => println!("  python: notebook … SKIPPED: {error:#}"),
    }
    let mut tests = Command::new(fresh.program("python"));
    tests.current_dir(&sources).env("PYTHONDONTWRITEBYTECODE", "1");
    tests.args(["-m", "pytest", "--quiet", "-p", "no:cacheprovider", "--strict-markers"]);
    step::run("python: tests", &mut tests, "").map(drop)
}

/// Returns the interpreter if the package supports its version.
fn supported(interpreter: PathBuf) -> Result<PathBuf> {
    let mut version = Command::new(&interpreter);
    version.args(["-c", "import sys; sys.exit(sys.version_info < (3, 9))"]);
    step::capture(&mut version, "").context("the package takes Python 3.9 or newer")?;
    Ok(interpreter)
}

/// Finds a Python that can create environments with pip.
pub(crate) fn interpreter() -> Result<PathBuf> {
    let found = ["python3", "python"].into_iter().find_map(on_path);
    let python = found.context("Python is not on the search path (https://www.python.org/downloads)")?;
    let mut modules = Command::new(&python);
    modules.args(["-c", "import ensurepip, venv"]);
    step::capture(&mut modules, "")
        .context("Python has no pip to install packages with (Debian: python3-venv)")?;
    Ok(python)
}

/// A Python environment.
pub(crate) struct Environment(PathBuf);

impl Environment {
    /// Creates an empty environment in a folder, and deletes its previous content.
    fn new(interpreter: &Path, folder: PathBuf, label: &str) -> Result<Self> {
        let mut create = Command::new(interpreter);
        create.args(["-m", "venv", "--clear"]).arg(&folder);
        step::run(&format!("{label}: Python environment"), &mut create, "")?;
        Ok(Self(folder))
    }

    /// An environment with the packages of a list. It is recreated when the list or the version of
    /// Python changes.
    pub(crate) fn kept(interpreter: &Path, folder: PathBuf, list: &Path, label: &str) -> Result<Self> {
        let version = step::capture(Command::new(interpreter).arg("--version"), "")?;
        let wanted = Fingerprint::default().file(list)?.text("python", version.trim()).finish();
        let stamp = folder.join(".installed");
        if fs::read_to_string(&stamp).is_ok_and(|have| have == wanted) {
            return Ok(Self(folder));
        }
        let own = Self::new(interpreter, folder, label)?;
        let advice = format!("Is PyPI reachable, and has it these versions for {}?", version.trim());
        step::run(&format!("{label}: pip install"), own.pip().arg("--requirement").arg(list), &advice)?;
        fs::write(&stamp, wanted).with_context(|| format!("could not write {}", stamp.display()))?;
        Ok(own)
    }

    /// A program of the environment.
    pub(crate) fn program(&self, name: &str) -> PathBuf {
        let folder = if cfg!(windows) { "Scripts" } else { "bin" };
        self.0.join(folder).join(format!("{name}{}", std::env::consts::EXE_SUFFIX))
    }

    /// `pip install`, without package names.
    fn pip(&self) -> Command {
        let mut install = Command::new(self.program("python"));
        install.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]);
        install
    }
}
