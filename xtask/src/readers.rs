//! Files of the command line, opened by other programs: MeshLab, trimesh, Open3D, libigl, meshio,
//! pygltflib, pandas and NumPy, in a Python environment of the project. Without Python the check is
//! skipped, and the reason is printed.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Result, bail};

use crate::debian;
use crate::native;
use crate::project::{Project, cargo};
use crate::python::{self, Environment};
use crate::step;

const LABEL: &str = "files: the programs that read them";

/// Packages of Debian with libraries that MeshLab and Open3D need.
const LIBRARIES: [&str; 5] = ["libgl1", "libopengl0", "libusb-1.0-0", "libgomp1", "libx11-6"];

/// Writes files of every format and has each program read them. Prints a table of programs and
/// formats.
///
/// # Errors
///
/// If the environment cannot be created, or a program rejects a file.
pub(crate) fn test(project: &Project) -> Result<()> {
    let python = match python::interpreter() {
        Ok(python) => python,
        Err(error) => {
            println!("  {LABEL} … SKIPPED: {error:#}");
            return Ok(());
        }
    };
    let environment = environment(project, &python)?;
    let mut build = Command::new(cargo());
    // The executable of the native tests.
    build.current_dir(&project.root).arg("build").args(native::TESTED);
    step::run("command line: compile", build.args(["--bin", "marching-particles"]), "")?;
    let mut read = Command::new(environment);
    read.current_dir(&project.root)
        .arg("tests/readers/read.py")
        .arg(project.target.join("debug").join(format!("marching-particles{}", std::env::consts::EXE_SUFFIX)))
        .arg(project.scratch("readers/files")?);
    print!("{}", step::run(LABEL, &mut read, "")?);
    Ok(())
}

/// The Python of an environment with the listed programs.
fn environment(project: &Project, interpreter: &Path) -> Result<PathBuf> {
    let list = project.root.join("tests/readers/requirements.txt");
    let folder = project.scratch("readers")?.join("python");
    let own = Environment::kept(interpreter, folder, &list, "files")?.program("python");
    if imports(&own).is_err() {
        debian::install("libraries of MeshLab and Open3D", &LIBRARIES)?;
        if let Err(error) = imports(&own) {
            bail!("{error:#}\n\nInstall the libraries that it misses.");
        }
    }
    Ok(own)
}

/// Imports the programs that need system libraries.
fn imports(python: &Path) -> Result<()> {
    step::capture(Command::new(python).args(["-c", "import pymeshlab, open3d"]), "").map(drop)
}
