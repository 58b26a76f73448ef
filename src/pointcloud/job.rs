//! A job that turns a file or a built-in model into a field, in slices of bounded work.

use super::fit::{Fit, FitError, approximate};
use super::models;
use super::normals::{Changes, settle};
use super::read::{ReadError, Reader};
use super::thin::{check_spread, merge, spread, thin};
use super::{Cloud, CloudError, ModelInfo};
use crate::field::model;
pub use crate::field::model::{CENTRES, DEFAULT_CENTRES};
use crate::math::Bounds;
use crate::slices;
use core::cell::{Cell, OnceCell};
use core::pin::Pin;
use glam::DVec3;
use serde::Serialize;
use std::rc::Rc;

/// Distance from the origin, in diagonals of the points' box, beyond which the points are moved to
/// the origin. Up to this distance the sampler's single precision resolves a millionth of the
/// diagonal.
const FAR: f64 = 10.0;

/// Progress of a job.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct PointsProgress {
    /// The stage of the job in words.
    pub label: &'static str,
    /// Fraction of the whole work, from 0 to 1. It never decreases.
    pub fraction: f64,
    /// Whether the field is complete.
    pub done: bool,
}

/// Why a job failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum JobError {
    /// The file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// No surface can be fitted to the points.
    #[error(transparent)]
    Cloud(#[from] CloudError),
    /// No function can be fitted to the points.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// There is no built-in model with this identifier.
    #[error("there is no model `{id}`; known are {}", names())]
    UnknownModel {
        /// The identifier.
        id: String,
    },
    /// The number of centres is not one of [`CENTRES`](crate::pointcloud::CENTRES).
    #[error("{count} centres: choose {} to {}", CENTRES.start(), CENTRES.end())]
    Centres {
        /// Number of centres that was given.
        count: u32,
    },
}

/// Identifiers of the built-in models.
fn names() -> String {
    let names: Vec<&str> = model::MODELS.iter().map(|model| model.id).collect();
    names.join(", ")
}

/// The name of a stage, and when it begins and how long it takes as shares of the whole time.
struct JobPart {
    label: &'static str,
    begins: f64,
    length: f64,
}

const fn part(label: &'static str, begins: f64, length: f64) -> JobPart {
    JobPart { label, begins, length }
}

const READING: JobPart = part("Reading the file", 0.0, 0.1);
const FACING: JobPart = part("Finding normals from the faces", 0.1, 0.02);
const MERGING: JobPart = part("Joining equal points", 0.12, 0.02);
/// How many grids thinning takes is unknown, so its progress is not shown.
const THINNING: JobPart = part("Thinning out", 0.14, 0.01);
const ESTIMATING: JobPart = part("Estimating normals", 0.15, 0.04);
const COMPARING: JobPart = part("Comparing normals", 0.15, 0.04);
const SPREADING: JobPart = part("Choosing centres", 0.19, 0.01);
const SOLVING: JobPart = part("Solving for the surface", 0.2, 0.8);
const DONE: JobPart = part("Done", 1.0, 0.0);

/// Status of a job, which its work updates while it runs.
struct JobStatus {
    progress: Cell<PointsProgress>,
    centres: OnceCell<Vec<DVec3>>,
}

impl JobStatus {
    fn new(first: &JobPart) -> Rc<Self> {
        Rc::new(Self { progress: Cell::new(first.at(0.0)), centres: OnceCell::new() })
    }

    /// Begins a part of the job. Returns a function that takes the completed fraction of that part.
    fn begin(&self, part: &'static JobPart) -> impl Fn(f64) {
        self.progress.set(part.at(0.0));
        |share| self.progress.set(part.at(share))
    }
}

impl JobPart {
    fn at(&self, share: f64) -> PointsProgress {
        let fraction = self.begins + share * self.length;
        PointsProgress { label: self.label, fraction, done: self.begins == DONE.begins }
    }
}

/// The conversion of a file or a built-in model to a field.
pub struct Job {
    state: JobState,
    status: Rc<JobStatus>,
}

enum JobState {
    Working(Pin<Box<dyn Future<Output = Result<Fit, JobError>>>>),
    Done(Box<Fit>),
    Failed(JobError),
}

impl Job {
    /// Job for a file. A function with this number of `centres` (see [`CENTRES`]) is fitted to all
    /// of its points; `name` appears in reports.
    ///
    /// # Errors
    ///
    /// If the number of centres is out of range, or if the size or format of the file is wrong.
    pub fn file(name: &str, bytes: Vec<u8>, centres: u32) -> Result<Self, JobError> {
        check_number(centres)?;
        let reader = Reader::new(name, bytes)?;
        let info = ModelInfo { name: name.to_owned(), ..ModelInfo::default() };
        let status = JobStatus::new(&READING);
        let work = Box::pin(of_file(reader, centres as usize, info, status.clone()));
        Ok(Self { state: JobState::Working(work), status })
    }

    /// Job for a built-in model. A function with this number of `centres` (see [`CENTRES`]), or as
    /// many as the model has points, is fitted to them.
    ///
    /// # Errors
    ///
    /// If the number of centres is out of range, or if there is no model with this identifier.
    pub fn model(id: &str, centres: u32) -> Result<Self, JobError> {
        check_number(centres)?;
        let unknown = || JobError::UnknownModel { id: id.to_owned() };
        let info = models::info(model::find(id).ok_or_else(unknown)?);
        let cloud = models::cloud(id).ok_or_else(unknown)?;
        let status = JobStatus::new(&SPREADING);
        let given = cloud.position.clone();
        let work = Box::pin(of_cloud(cloud, given, centres as usize, info, status.clone()));
        Ok(Self { state: JobState::Working(work), status })
    }

    /// Current progress.
    #[must_use]
    pub fn progress(&self) -> PointsProgress {
        self.status.progress.get()
    }

    /// Does up to `budget` slices of the work and returns the progress.
    ///
    /// A slice takes about a tenth of a millisecond natively, or a millisecond while solving.
    /// Between two stages of a file with millions of points it may take some tens of milliseconds.
    ///
    /// # Errors
    ///
    /// The error of the file, the points or the system. Every later call returns the same error.
    pub fn step(&mut self, budget: u32) -> Result<PointsProgress, JobError> {
        if let JobState::Working(work) = &mut self.state
            && let Some(result) = slices::advance(work.as_mut(), budget)
        {
            self.state = result.map_or_else(JobState::Failed, |fit| JobState::Done(Box::new(fit)));
        }
        match &self.state {
            JobState::Failed(error) => Err(error.clone()),
            _ => Ok(self.progress()),
        }
    }

    /// Does all remaining work and returns the field.
    ///
    /// # Errors
    ///
    /// The errors of [`Job::step`].
    pub fn complete(mut self) -> Result<Fit, JobError> {
        loop {
            self.step(u32::MAX)?;
            if let JobState::Done(fit) = self.state {
                return Ok(*fit);
            }
        }
    }

    /// The field, once it is complete.
    #[must_use]
    pub fn fit(&self) -> Option<&Fit> {
        match &self.state {
            JobState::Done(fit) => Some(fit),
            _ => None,
        }
    }

    /// The centres, once they are chosen.
    #[must_use]
    pub fn centres(&self) -> &[DVec3] {
        self.status.centres.get().map_or(&[], Vec::as_slice)
    }
}

fn check_number(centres: u32) -> Result<(), JobError> {
    if CENTRES.contains(&centres) { Ok(()) } else { Err(JobError::Centres { count: centres }) }
}

/// The work of a job for a file, from the file to a field.
async fn of_file(
    reader: Reader,
    wanted: usize,
    mut info: ModelInfo,
    status: Rc<JobStatus>,
) -> Result<Fit, JobError> {
    let mesh = reader.read(status.begin(&READING)).await?;
    info.points = mesh.position.len() as u32;
    let has_faces = !mesh.faces.is_empty();
    info.mesh = mesh.given().await?;
    let on_faces = match &info.mesh {
        Some(given) => mesh.on_faces(given.area).await,
        None => Cloud::default(),
    };
    let (mut cloud, warnings) = mesh.into_cloud(status.begin(&FACING)).await?;
    info.warnings = warnings;
    if !(cloud.normal.is_empty() || on_faces.is_empty()) {
        let count = on_faces.len();
        info.points += count as u32;
        info.warnings.push(format!(
            "{count} points were put on faces that are large, so that the surface follows these."
        ));
        cloud.position.extend(on_faces.position);
        cloud.normal.extend(on_faces.normal);
    }
    let mut cloud = merge(cloud, status.begin(&MERGING)).await?;
    check_spread(&cloud.position)?;
    info.warnings.extend(bring_near(&mut cloud.position));
    let mut given = cloud.position.clone();
    status.begin(&THINNING)(0.0);
    let mut cloud = thin(cloud).await?;
    // The faces of a mesh tell which points are connected, and their normals.
    if cloud.normal.is_empty() || !has_faces {
        let part = if cloud.normal.is_empty() { &ESTIMATING } else { &COMPARING };
        let Changes { outliers, warnings } = settle(&mut cloud, status.begin(part)).await;
        given.retain(|p| !outliers.contains(p));
        info.warnings.extend(warnings);
    }
    of_cloud(cloud, given, wanted, info, status).await
}

/// The work from points with normals to a field. Distances from the surface are measured at the
/// points `given`.
async fn of_cloud(
    cloud: Cloud,
    given: Vec<DVec3>,
    wanted: usize,
    info: ModelInfo,
    status: Rc<JobStatus>,
) -> Result<Fit, JobError> {
    // Of nearly coincident points only one is chosen, however few points there are.
    let mut chosen = spread(&cloud.position, wanted, status.begin(&SPREADING)).await;
    if chosen.len() == cloud.len() {
        // The centres are all points, in the order of the file.
        chosen = (0..cloud.len() as u32).collect();
    }
    status.centres.get_or_init(|| cloud.only(&chosen).position);
    // The points of a file were counted before equal ones were merged.
    let points = info.points;
    let is_closed = info.mesh.and_then(|mesh| mesh.topology).is_some_and(|topology| topology.borders == 0);
    let is_scan = points > 0 && !is_closed;
    let mut fit = approximate(&cloud, &chosen, &given, info, status.begin(&SOLVING)).await?;
    fit.info.points = fit.info.points.max(points);
    if is_scan {
        fit.trim(&cloud.position, &cloud.only(&chosen).position).await;
    }
    status.begin(&DONE)(0.0);
    Ok(fit)
}

/// Moves points that are far from the origin for their size near it, by round numbers, and returns
/// a warning.
fn bring_near(points: &mut [DVec3]) -> Option<String> {
    let bounds = Bounds::around(points.iter().copied());
    let (middle, diagonal) = (bounds.middle(), bounds.diagonal());
    if middle.abs().max_element() <= FAR * diagonal {
        return None;
    }
    let moved = middle.map(|x| round_to(-x, diagonal));
    for p in points {
        *p += moved;
    }
    Some(format!(
        "The points lie far from the origin for their size and were moved by {}, {}, {}: single precision would lose \
         their last digits.",
        moved.x, moved.y, moved.z
    ))
}

/// Rounds `x` to a multiple of the largest power of ten that is not above `unit`.
fn round_to(x: f64, unit: f64) -> f64 {
    let (mut power, mut inverse) = (1.0, 1.0);
    while power * 10.0 <= unit {
        power *= 10.0;
    }
    while power / inverse > unit {
        inverse *= 10.0;
    }
    // Division by an integer gives the double nearest to the decimal. Adding 0 avoids a negative
    // zero.
    (x / power * inverse).round() / inverse * power + 0.0
}
