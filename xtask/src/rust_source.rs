//! Finding the source of the standard library for one exact compiler version.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::fingerprint::sha256_of;
use crate::project::{Project, on_path, rustc};
use crate::step;

/// Path of the source of the standard library in the sysroot of a toolchain.
pub(crate) const SOURCE_IN_SYSROOT: &str = "lib/rustlib/src/rust/library";

/// Debian's archive. Its index files are fetched over TLS and state each package's SHA-256.
const DEBIAN: &str = "https://deb.debian.org/debian";

/// The suites that may contain a compiler version, those with recent compilers first.
const SUITES: [&str; 8] = [
    "sid",
    "forky",
    "trixie-backports",
    "trixie",
    "trixie-security",
    "bookworm-backports",
    "bookworm",
    "experimental",
];

/// The packages with the compiler's source: the suite's own compiler, and the one kept for building
/// browsers.
const PACKAGES: [&str; 2] = ["rust-src", "rust-web-src"];

/// The `library` folder of the compiler's source, from the first place that has it:
/// `RUST_SRC_PATH`, another toolchain of the same compiler, a package installed under `/usr/src`,
/// or Debian's archive.
pub(crate) fn find(project: &Project, version: &str, release: &str) -> Result<PathBuf> {
    if let Some(path) = env::var_os("RUST_SRC_PATH").map(PathBuf::from) {
        if is_library(&path) {
            return Ok(path);
        }
        bail!("RUST_SRC_PATH is {}, which holds no std/Cargo.toml", path.display());
    }
    if let Some(path) = in_other_toolchains(version)? {
        return Ok(path);
    }
    let packaged = Path::new("/usr/src").join(format!("rustc-{release}/library"));
    if is_library(&packaged) {
        return Ok(packaged);
    }
    from_debian(project, release)
}

fn is_library(path: &Path) -> bool {
    path.join("std/Cargo.toml").is_file()
}

fn in_other_toolchains(version: &str) -> Result<Option<PathBuf>> {
    let home = env::var_os("RUSTUP_HOME")
        .map(PathBuf::from)
        .or_else(|| env::home_dir().map(|home| home.join(".rustup")))
        .unwrap_or_default();
    let Ok(toolchains) = fs::read_dir(home.join("toolchains")) else { return Ok(None) };
    for toolchain in toolchains {
        let sysroot = toolchain?.path();
        let source = sysroot.join(SOURCE_IN_SYSROOT);
        if !is_library(&source) {
            continue;
        }
        let compiler = sysroot.join("bin").join(rustc().file_name().unwrap_or_default());
        if step::capture(Command::new(compiler).arg("-vV"), "").is_ok_and(|theirs| theirs == version) {
            return Ok(Some(source));
        }
    }
    Ok(None)
}

/// Downloads and unpacks the Debian package with the source of `release`.
fn from_debian(project: &Project, release: &str) -> Result<PathBuf> {
    let folder = project.scratch("rust-src")?;
    let unpacked = folder.join("unpacked");
    let library = unpacked.join(format!("usr/src/rustc-{release}/library"));
    if is_library(&library) {
        return Ok(library);
    }
    for tool in ["curl", "xz", "dpkg-deb"] {
        if on_path(tool).is_none() {
            bail!(
                "no source of std {release} on this machine, and without `{tool}` it cannot be taken from Debian's archive"
            );
        }
    }
    let package = find_package(&folder, release)?
        .with_context(|| format!("no suite of Debian's archive holds the source of rustc {release}"))?;
    let file = folder.join("rust-src.deb");
    let url = format!("{DEBIAN}/{}", package.path);
    step::run(&format!("source of std {release}: {}", package.path), &mut fetch(&url, &file), "")?;
    let found = sha256_of(&file)?;
    if found != package.sha256 {
        bail!("{url} has the SHA-256 {found}, but the archive's index says {}", package.sha256);
    }
    step::run(
        "source of std: unpack",
        Command::new("dpkg-deb").arg("--extract").args([&file, &unpacked]),
        "",
    )?;
    fs::remove_file(&file)?;
    if !is_library(&library) {
        bail!("{} unpacked without {}", package.path, library.display());
    }
    Ok(library)
}

/// A package in Debian's archive.
#[derive(Debug, PartialEq)]
struct Package {
    path: String,
    sha256: String,
}

fn find_package(folder: &Path, release: &str) -> Result<Option<Package>> {
    let index = folder.join("Packages.xz");
    for suite in SUITES {
        let url = format!("{DEBIAN}/dists/{suite}/main/binary-all/Packages.xz");
        // If a suite has been archived or does not exist, the others are searched.
        if step::run(&format!("Debian's index of {suite}"), &mut fetch(&url, &index), "").is_err() {
            continue;
        }
        let text = step::capture(Command::new("xz").args(["--decompress", "--stdout"]).arg(&index), "")?;
        if let Some(package) = package_in(&text, release) {
            return Ok(Some(package));
        }
    }
    Ok(None)
}

fn fetch(url: &str, to: &Path) -> Command {
    let mut command = Command::new("curl");
    command.args([
        "--fail",
        "--silent",
        "--show-error",
        "--location",
        "--retry",
        "2",
        "--connect-timeout",
        "15",
        "--output",
    ]);
    command.arg(to).arg(url);
    command
}

/// The package of `release` in the text of a `Packages` file.
fn package_in(index: &str, release: &str) -> Option<Package> {
    index.split("\n\n").find_map(|stanza| {
        let field = |name: &str| stanza.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(": "));
        let wanted = PACKAGES.contains(&field("Package")?)
            // "1.95.0+dfsg1-2": the upstream version ends where Debian's part begins.
            && field("Version")?.split(['+', '-', '~']).next() == Some(release);
        wanted.then_some(())?;
        Some(Package { path: field("Filename")?.to_owned(), sha256: field("SHA256")?.to_owned() })
    })
}

#[cfg(test)]
mod tests {
    use super::{Package, package_in};

    const INDEX: &str = "Package: rust-doc\nVersion: 1.95.0+dfsg1-2\nFilename: doc.deb\nSHA256: 00\n\n\
                         Package: rust-src\nSource: rustc\nVersion: 1.95.0+dfsg1-2~bpo13+1\nFilename: pool/r.deb\nSHA256: ab\n";

    #[test]
    fn the_package_of_the_exact_release_is_found() {
        assert_eq!(
            package_in(INDEX, "1.95.0"),
            Some(Package { path: "pool/r.deb".into(), sha256: "ab".into() })
        );
    }

    #[test]
    fn another_release_is_not_accepted() {
        assert_eq!(package_in(INDEX, "1.95.1"), None);
        assert_eq!(package_in(INDEX, "1.95"), None);
    }
}
