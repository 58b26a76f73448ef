//! The files that the tool writes.

use crate::failure::Failure;
use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::{Builder, NamedTempFile};

/// The name of standard output among files, and of standard input.
pub(crate) const STANDARD: &str = "-";

/// A file that is written beside its path and takes the place of what is there when it is complete.
/// Until then what is there stays. Standard output has nothing beside it.
#[derive(Debug)]
pub(crate) struct OutputFile {
    path: PathBuf,
}

impl OutputFile {
    /// A file for each of the paths.
    ///
    /// # Errors
    ///
    /// If a directory does not take files, a path is that of a directory, or two paths are of one
    /// file.
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
        // Whether the directory takes files is known before a long run. The file itself is made
        // after it: a run that is interrupted leaves nothing there.
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

    /// Writes the file and puts it in its place.
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

/// The path of the record of a file that has no place for one in it: beside it, with .json after
/// its name.
pub(crate) fn record_path(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".json");
    name.into()
}

/// The path of the file itself, where `path` is a link or has steps back.
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

/// Permissions of a new file, of which the system takes the user's mask away.
#[cfg(unix)]
fn new_file() -> fs::Permissions {
    use std::os::unix::fs::PermissionsExt as _;
    fs::Permissions::from_mode(0o666)
}
