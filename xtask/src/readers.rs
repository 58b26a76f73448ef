//! The files of the command line against the programs that people read them with: MeshLab, trimesh,
//! Open3D, libigl, meshio, pygltflib, pandas and NumPy, in a Python environment of the project's
//! own. Without Python the check is skipped, and the reason is printed.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result, bail};

use crate::debian;
use crate::fingerprint::Fingerprint;
use crate::native;
use crate::project::{Project, cargo, on_path};
use crate::step;

const LABEL: &str = "files: the programs that read them";

/// Packages of Debian with what MeshLab and Open3D are linked to.
const LIBRARIES: [&str; 5] = ["libgl1", "libopengl0", "libusb-1.0-0", "libgomp1", "libx11-6"];

/// Writes files of every format and has each program read them. Prints a table of programs and
/// formats.
///
/// # Errors
///
/// If the environment cannot be made, or a program finds a file faulty.
pub(crate) fn test(project: &Project) -> Result<()> {
    let python = match python() {
        Ok(python) => python,
        Err(error) => {
            println!("  {LABEL} … SKIPPED: {error:#}");
            return Ok(());
        }
    };
    let environment = environment(project, &python)?;
    let mut build = Command::new(cargo());
    // The executable that the native tests run.
    build.current_dir(&project.root).args(["build", "--profile", "test"]).args(native::TESTED);
    step::run("command line: compile", build.args(["--bin", "marching-particles"]), "")?;
    let mut read = Command::new(environment);
    read.current_dir(&project.root)
        .arg("tests/readers/read.py")
        .arg(project.target.join("debug").join(format!("marching-particles{}", std::env::consts::EXE_SUFFIX)))
        .arg(project.scratch("readers/files")?);
    print!("{}", step::run(LABEL, &mut read, "")?);
    Ok(())
}

/// Finds a Python that makes environments with pip in them.
fn python() -> Result<PathBuf> {
    let found = ["python3", "python"].into_iter().find_map(on_path);
    let python = found.context("Python is not on the search path (https://www.python.org/downloads)")?;
    let mut modules = Command::new(&python);
    modules.args(["-c", "import ensurepip, venv"]);
    step::capture(&mut modules, "")
        .context("Python has no pip to install packages with (Debian: python3-venv)")?;
    Ok(python)
}

/// The Python of an environment with the programs of the list.
fn environment(project: &Project, python: &Path) -> Result<PathBuf> {
    let list = project.root.join("tests/readers/requirements.txt");
    let version = step::capture(Command::new(python).arg("--version"), "")?;
    let wanted = Fingerprint::default().file(&list)?.text("python", version.trim()).finish();
    let folder = project.scratch("readers")?.join("python");
    let own = folder.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" });
    let stamp = folder.join(".installed");
    if !fs::read_to_string(&stamp).is_ok_and(|have| have == wanted) {
        let mut create = Command::new(python);
        create.args(["-m", "venv", "--clear"]).arg(&folder);
        step::run("files: Python environment", &mut create, "")?;
        let mut install = Command::new(&own);
        install
            .args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--requirement"])
            .arg(&list);
        let advice = format!("Is PyPI reachable, and has it these versions for {}?", version.trim());
        step::run("files: the programs that read them (pip install)", &mut install, &advice)?;
        if imports(&own).is_err() {
            debian::install("libraries of MeshLab and Open3D", &LIBRARIES)?;
            if let Err(error) = imports(&own) {
                bail!("{error:#}\n\nInstall the libraries that it misses.");
            }
        }
        fs::write(&stamp, wanted).with_context(|| format!("could not write {}", stamp.display()))?;
    }
    Ok(own)
}

/// Loads the programs that need libraries of the system.
fn imports(python: &Path) -> Result<()> {
    step::capture(Command::new(python).args(["-c", "import pymeshlab, open3d"]), "").map(drop)
}
