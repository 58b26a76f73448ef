//! The files that the tool writes.

use crate::failure::Failure;
use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::{Builder, NamedTempFile};

/// The file name that stands for standard output or input.
pub(crate) const STANDARD: &str = "-";

/// A file that is written under another name in the same folder and replaces an existing file only
/// when complete. Standard output is written directly.
#[derive(Debug)]
pub(crate) struct OutputFile {
    path: PathBuf,
}

impl OutputFile {
    /// A file for each of the paths.
    ///
    /// # Errors
    ///
    /// If a directory is not writable, a path is a directory, or two paths are the same file.
    pub(crate) fn beside(paths: &[&PathBuf]) -> Result<Vec<Self>, Failure> {
        let mut outputs: Vec<Self> = Vec::new();
        for &path in paths {
            let output = Self::open(path).map_err(|error| Failure::File { path: path.clone(), error })?;
            if outputs.iter().any(|other| other.path == output.path) {
                return Err(Failure::Usage(format!(
                    "{} is to be written twice: give each file a name of its own",
                    path.display()
                )));
            }
            outputs.push(output);
        }
        Ok(outputs)
    }

    fn open(path: &Path) -> io::Result<Self> {
        if path == Path::new(STANDARD) {
            return Ok(Self { path: path.to_owned() });
        }
        let output = Self { path: resolved(path)? };
        if output.path.is_dir() {
            return Err(io::ErrorKind::IsADirectory.into());
        }
        // Shows before a long run whether the directory is writable. The file itself is created
        // after the run, so that an interrupted run leaves nothing behind.
        output.file_beside()?;
        Ok(output)
    }

    /// An empty file in the directory of the path.
    fn file_beside(&self) -> io::Result<NamedTempFile> {
        let mut builder = Builder::new();
        builder.prefix(".marching-particles-");
        #[cfg(unix)]
        builder
            .permissions(fs::metadata(&self.path).map_or_else(|_| new_file(), |there| there.permissions()));
        builder.tempfile_in(self.path.parent().unwrap_or(Path::new(".")))
    }

    /// Writes the file and moves it to its path.
    pub(crate) fn write(self, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Failure> {
        if self.path == Path::new(STANDARD) {
            let mut out = BufWriter::new(io::stdout().lock());
            return Ok(write(&mut out).and_then(|()| out.flush())?);
        }
        let written = || {
            let mut out = BufWriter::new(self.file_beside()?);
            write(&mut out)?;
            let file = out.into_inner().map_err(io::IntoInnerError::into_error)?;
            file.persist(&self.path).map(drop).map_err(|error| error.error)
        };
        written().map_err(|error| Failure::File { path: self.path.clone(), error })
    }
}

/// The path of the record of a file that cannot contain it: the file's name with .json appended.
pub(crate) fn record_path(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".json");
    name.into()
}

/// The path of the file itself, with links and `..` resolved.
fn resolved(path: &Path) -> io::Result<PathBuf> {
    match path.canonicalize() {
        Ok(path) => Ok(path),
        Err(_) => {
            let directory = path.parent().filter(|parent| !parent.as_os_str().is_empty());
            let directory = directory.unwrap_or(Path::new("."));
            let directory = directory.canonicalize().map_err(|error| match error.kind() {
                kind @ io::ErrorKind::NotFound => {
                    io::Error::new(kind, format!("there is no folder {}", directory.display()))
                }
                _ => error,
            })?;
            Ok(directory.join(path.file_name().unwrap_or_default()))
        }
    }
}

/// Permissions of a new file, before the system applies the user's mask.
#[cfg(unix)]
fn new_file() -> fs::Permissions {
    use std::os::unix::fs::PermissionsExt as _;
    fs::Permissions::from_mode(0o666)
}
