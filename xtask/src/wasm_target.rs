//! The compiler's `wasm32-unknown-unknown` target.
//!
//! If it is missing it is added through rustup. If rustup or its server is not available, the
//! standard library is compiled from source in every wasm build (cargo's `-Zbuild-std`, which the
//! stable compiler accepts with `RUSTC_BOOTSTRAP=1`). The compiler looks for that source in its own
//! folder, so it is put into a copy of the toolchain made of hard links; the toolchain itself is
//! not changed.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::project::{Project, cargo, on_path, rustc};
use crate::rust_source::{self, SOURCE_IN_SYSROOT};
use crate::step;

/// The target's name.
pub(crate) const TARGET: &str = "wasm32-unknown-unknown";

/// A way to compile for the target.
pub(crate) struct WasmTarget {
    /// The compiler to use instead of cargo's own.
    rustc: Option<PathBuf>,
    /// Whether the standard library is compiled from source.
    from_source: bool,
    /// Identifies the compiler: the output of `rustc -vV`.
    pub(crate) version: String,
}

impl WasmTarget {
    /// Finds the target, or installs it.
    pub(crate) fn prepare(project: &Project) -> Result<Self> {
        let version = step::capture(Command::new(rustc()).arg("-vV").current_dir(&project.root), "")?;
        let sysroot =
            step::capture(Command::new(rustc()).args(["--print", "sysroot"]).current_dir(&project.root), "")?;
        let sysroot = PathBuf::from(sysroot.trim());
        if has_target(&sysroot) {
            return Ok(Self { rustc: None, from_source: false, version });
        }
        let rustup_failure = match add_by_rustup(project) {
            Ok(()) if has_target(&sysroot) => return Ok(Self { rustc: None, from_source: false, version }),
            Ok(()) => "rustup reported success, but this compiler still lacks the target; is it another toolchain's?".to_owned(),
            Err(error) => format!("{error:#}"),
        };
        let rustc = toolchain_with_source(project, &sysroot, &version).with_context(|| {
            format!(
                "The compiler target {TARGET} is missing and could not be set up.\n\
                 Any one of these helps:\n\
                 \x20 rustup target add {TARGET}\n\
                 \x20 apt-get install libstd-rust-dev-wasm32      (where rustc is Debian's)\n\
                 \x20 RUST_SRC_PATH=…/library cargo xtask …      (source of the standard library of this compiler's version)\n\n\
                 Adding it through rustup failed:\n{rustup_failure}\n\nCompiling the standard library failed"
            )
        })?;
        println!("  {TARGET}: its standard library is compiled from source");
        let version = format!("{version}\nstd from source");
        Ok(Self { rustc, from_source: true, version })
    }

    /// A `cargo SUBCOMMAND --target wasm32-unknown-unknown`.
    pub(crate) fn cargo(&self, project: &Project, subcommand: &str) -> Command {
        let mut command = Command::new(cargo());
        command.current_dir(&project.root).args([subcommand, "--target", TARGET]);
        if let Some(rustc) = &self.rustc {
            command.env("RUSTC", rustc);
            // Clippy's driver looks for its sysroot here first.
            if let Some(sysroot) = rustc.ancestors().nth(2) {
                command.env("SYSROOT", sysroot);
            }
        }
        if self.from_source {
            command.env("RUSTC_BOOTSTRAP", "1").arg("-Zbuild-std=std,panic_abort");
        }
        command
    }
}

fn has_target(sysroot: &Path) -> bool {
    let folder = sysroot.join("lib/rustlib").join(TARGET).join("lib");
    fs::read_dir(folder).is_ok_and(|entries| {
        entries.flatten().any(|entry| entry.file_name().to_string_lossy().starts_with("libstd-"))
    })
}

fn add_by_rustup(project: &Project) -> Result<()> {
    if on_path("rustup").is_none() {
        bail!("there is no rustup on the search path");
    }
    let mut command = Command::new("rustup");
    command.args(["target", "add", TARGET]).current_dir(&project.root);
    step::run(&format!("compiler target {TARGET} (rustup)"), &mut command, "").map(drop)
}

/// A compiler whose sysroot contains the standard library's source; `None` if cargo's own does.
fn toolchain_with_source(project: &Project, sysroot: &Path, version: &str) -> Result<Option<PathBuf>> {
    if sysroot.join(SOURCE_IN_SYSROOT).join("std/Cargo.toml").is_file() {
        return Ok(None);
    }
    let release = version
        .lines()
        .find_map(|line| line.strip_prefix("release: "))
        .context("`rustc -vV` states no release")?;
    let copy = project.scratch("toolchain")?.join(release);
    let rustc = copy.join("bin").join(format!("rustc{}", std::env::consts::EXE_SUFFIX));
    let complete = copy.join("complete");
    if fs::read_to_string(&complete).is_ok_and(|of| of == version) {
        return Ok(Some(rustc));
    }
    let source = rust_source::find(project, version, release)?;
    step::task(&format!("copy of the toolchain by hard links, with the source of std {release}"), || {
        if copy.exists() {
            fs::remove_dir_all(&copy).with_context(|| format!("could not remove {}", copy.display()))?;
        }
        link_toolchain(sysroot, &copy)?;
        link_tree(&source, &copy.join(SOURCE_IN_SYSROOT))?;
        fs::write(&complete, version)?;
        Ok(())
    })?;
    Ok(Some(rustc))
}

/// Links the compiler, its libraries and the host's standard library, but not documentation and
/// sources.
fn link_toolchain(sysroot: &Path, copy: &Path) -> Result<()> {
    let executable = format!("bin/rustc{}", std::env::consts::EXE_SUFFIX);
    link_file(&sysroot.join(&executable), &copy.join(&executable))?;
    let libraries = sysroot.join("lib");
    for entry in
        fs::read_dir(&libraries).with_context(|| format!("could not list {}", libraries.display()))?
    {
        let path = entry?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        // A distribution's compiler lives in /usr, whose lib folder holds everything else too.
        if path.is_file() && (name.contains("rustc_driver") || name.contains("LLVM") || name.contains("std-"))
        {
            link_file(&path, &copy.join("lib").join(&name))?;
        }
    }
    link_tree(&libraries.join("rustlib"), &copy.join("lib/rustlib"))
}

fn link_tree(from: &Path, to: &Path) -> Result<()> {
    for file in crate::fingerprint::files_under(from)? {
        link_file(&file, &to.join(file.strip_prefix(from)?))?;
    }
    Ok(())
}

/// A hard link, or a copy on another file system.
fn link_file(from: &Path, to: &Path) -> Result<()> {
    if let Some(parent) = to.parent() {
        fs::create_dir_all(parent).with_context(|| format!("could not create {}", parent.display()))?;
    }
    if fs::hard_link(from, to).is_ok() {
        return Ok(());
    }
    fs::copy(from, to).with_context(|| format!("could not copy {} to {}", from.display(), to.display()))?;
    Ok(())
}
