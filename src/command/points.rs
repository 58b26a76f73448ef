//! Fields from the points of a file or of a built-in model.

use crate::failure::Failure;
use crate::output::STANDARD;
use indicatif::ProgressBar;
use marching_particles::field::model;
use marching_particles::pointcloud::fit::Fit;
use marching_particles::pointcloud::job::{Job, JobError};
use marching_particles::pointcloud::read::check_size;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// Slices of work between two updates of the progress bar: 1 to 5 ms.
const BUDGET: u32 = 100;

/// Fits a field to the points of a file.
pub(crate) fn of_file(path: &Path, centres: u32, bar: &ProgressBar) -> Result<Fit, Failure> {
    if path == Path::new(STANDARD) {
        return of_standard_input(centres, bar);
    }
    let wrong = |error: JobError| Failure::Usage(format!("{}: {error}", path.display()));
    let unreadable = |error| Failure::Unreadable { path: path.to_owned(), error };
    let file = File::open(path).map_err(unreadable)?;
    let metadata = file.metadata().map_err(unreadable)?;
    // The size of a regular file is checked first; from others at most the limit is read.
    if metadata.is_file() {
        check_size(metadata.len()).map_err(|error| wrong(error.into()))?;
    }
    let bytes = read(file).map_err(unreadable)?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    solve(Job::file(&name, bytes, centres), bar).map_err(wrong)
}

/// Fits a field to the points from standard input, whose content tells the format.
fn of_standard_input(centres: u32, bar: &ProgressBar) -> Result<Fit, Failure> {
    const NAME: &str = "standard input";
    let bytes = read(io::stdin()).map_err(|error| Failure::Unreadable { path: NAME.into(), error })?;
    solve(Job::file(NAME, bytes, centres), bar).map_err(|error| Failure::Usage(format!("{NAME}: {error}")))
}

/// The content of a file, but at most one byte more than the limit.
fn read(file: impl Read) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    file.take(u64::from(model::MAX_FILE_BYTES) + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Fits a field to a built-in model.
pub(crate) fn of_model(id: &str, centres: u32, bar: &ProgressBar) -> Result<Fit, Failure> {
    solve(Job::model(id, centres), bar).map_err(|error| Failure::Usage(error.to_string()))
}

fn solve(job: Result<Job, JobError>, bar: &ProgressBar) -> Result<Fit, JobError> {
    let mut job = job?;
    loop {
        let progress = job.step(BUDGET)?;
        bar.set_position((progress.fraction * 1000.0) as u64);
        bar.set_message(progress.label);
        if let Some(fit) = job.fit() {
            return Ok(fit.clone());
        }
    }
}
