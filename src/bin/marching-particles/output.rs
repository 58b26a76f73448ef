//! The files that the tool writes.

use crate::failure::Failure;
use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::{Builder, NamedTempFile};

/// The name of standard output among files, and of standard input.
pub(crate) const STANDARD: &str = "-";

/// A file that is written beside its path and takes the place of what is there when it is complete.
/// One that is dropped before is removed, and what is there stays. Standard output has nothing
/// beside it.
#[derive(Debug)]
pub(crate) struct OutputFile {
    path: PathBuf,
    beside: Option<NamedTempFile>,
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
            return Ok(Self { path: path.to_owned(), beside: None });
        }
        let path = resolved(path)?;
        let mut builder = Builder::new();
        builder.prefix(".marching-particles-");
        let there = fs::metadata(&path).ok();
        if there.as_ref().is_some_and(fs::Metadata::is_dir) {
            return Err(io::ErrorKind::IsADirectory.into());
        }
        #[cfg(unix)]
        builder.permissions(there.map_or_else(new_file, |there| there.permissions()));
        let directory = path.parent().unwrap_or(Path::new("."));
        Ok(Self { beside: Some(builder.tempfile_in(directory)?), path })
    }

    /// Writes the file and puts it in its place.
    pub(crate) fn write(self, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Failure> {
        let Self { path, beside } = self;
        let Some(beside) = beside else {
            let mut out = BufWriter::new(io::stdout().lock());
            return Ok(write(&mut out).and_then(|()| out.flush())?);
        };
        let mut out = BufWriter::new(beside);
        let written = write(&mut out)
            .and_then(|()| out.into_inner().map_err(io::IntoInnerError::into_error))
            .and_then(|beside| beside.persist(&path).map_err(|error| error.error));
        written.map(drop).map_err(|error| Failure::File { path, error })
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
            let directory = directory.unwrap_or(Path::new(".")).canonicalize()?;
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
