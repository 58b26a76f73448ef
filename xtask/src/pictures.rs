//! The renderer's pictures, drawn natively and compared with the kept ones.

use std::path::Path;
use std::process::Command;

use anyhow::Result;

use crate::debian;
use crate::project::{Project, cargo};
use crate::step;

/// Folders in which Vulkan's loader on Linux looks for drivers.
const DRIVERS: [&str; 3] = ["/etc/vulkan/icd.d", "/usr/local/share/vulkan/icd.d", "/usr/share/vulkan/icd.d"];

/// Draws the pictures and compares them.
///
/// # Errors
///
/// If a picture differs, or there is no driver to draw with.
pub(crate) fn test(project: &Project) -> Result<()> {
    // Without a driver the test says what to install.
    let advice = driver().err().map(|error| format!("{error:#}")).unwrap_or_default();
    let mut tests = Command::new(cargo());
    tests.current_dir(&project.root).args(["test", "--package", "marching-particles-render", "--locked"]);
    tests.args(["--features", "vulkan", "--test", "pictures"]);
    step::run("pictures, drawn natively", &mut tests, &advice).map(drop)
}

/// Installs Debian's software driver if there is no driver.
fn driver() -> Result<()> {
    let is_driver =
        |folder: &&str| Path::new(folder).read_dir().is_ok_and(|mut files| files.next().is_some());
    let is_chosen =
        ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"].iter().any(|name| std::env::var_os(name).is_some());
    if !cfg!(target_os = "linux") || is_chosen || DRIVERS.iter().any(is_driver) {
        return Ok(());
    }
    debian::install("a driver of Vulkan that needs no graphics card", &["mesa-vulkan-drivers"])
}
