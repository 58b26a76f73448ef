//! A job that takes a file or a built-in model to a field, in slices of bounded work.

use super::fit::{Fit, FitError, Fitter};
use super::models;
use super::normals::Estimator;
use super::read::{FileMesh, ReadError, Reader};
use super::thin::{Merger, Spreader, Thinner, check_spread, corners};
use super::{Cloud, CloudError, ModelInfo};
use crate::field::model;
pub use crate::field::model::{CENTRES, DEFAULT_CENTRES};
use glam::DVec3;
use serde::Serialize;

/// Rows of a file read per unit of work. This and the following numbers make a unit of work take up to about a tenth of
/// a millisecond natively.
const ROWS: u32 = 500;
/// Faces summed per unit of work.
const FACES: u32 = 2000;
/// Points merged or thinned out per unit of work.
const POINTS: u32 = 1000;
/// Normals estimated per unit of work.
const PLANES: u32 = 20;

/// Distance from the origin, in diagonals of the points' box, beyond which the points are moved to the origin. Within
/// it, single precision, in which the surface is sampled, resolves a millionth of the diagonal.
const FAR: f64 = 10.0;

/// The stage of a job, as the page shows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum JobStage {
    /// The file is read.
    Reading,
    /// Normals are taken from the faces, or estimated.
    Normals,
    /// Equal points are merged, and few of many are chosen.
    Thinning,
    /// The system is set up and solved, and the distances of the points from the surface are measured.
    Solving,
    /// The field is complete.
    Done,
}

/// Progress of a job.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "PointsProgress"))]
pub struct Progress {
    /// Current stage.
    pub stage: JobStage,
    /// Current stage in words.
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
    /// The points cannot be interpolated.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// There is no built-in model with this identifier.
    #[error("there is no model `{id}`; known are {}", names())]
    UnknownModel {
        /// The identifier.
        id: String,
    },
    /// The number of centres is not in [`CENTRES`].
    #[error("{count} centres: choose {} to {}", CENTRES.start(), CENTRES.end())]
    Centres {
        /// The number.
        count: u32,
    },
}

impl JobError {
    /// Kind of error as a word in snake case, for programs.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Read(error) => error.kind(),
            Self::Cloud(_) | Self::Fit(_) => "points",
            Self::UnknownModel { .. } => "unknown_model",
            Self::Centres { .. } => "centres",
        }
    }

    /// Number, from 1, of the line of a text file that is in error.
    #[must_use]
    pub fn line(&self) -> Option<u64> {
        match self {
            Self::Read(ReadError::Line { line, .. }) => Some(*line),
            _ => None,
        }
    }
}

/// Error of a job, as the page shows it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS), ts(rename = "PointsFault"))]
pub struct Fault {
    /// Kind of error as a word in snake case.
    pub kind: &'static str,
    /// One sentence for the user, in plain text.
    pub message: String,
    /// Number, from 1, of the line of a text file that is in error.
    pub line: Option<u64>,
}

impl From<&JobError> for Fault {
    fn from(error: &JobError) -> Self {
        Self { kind: error.kind(), message: error.to_string(), line: error.line() }
    }
}

/// Identifiers of the built-in models.
fn names() -> String {
    let names: Vec<&str> = model::MODELS.iter().map(|model| model.id).collect();
    names.join(", ")
}

/// A file or a built-in model on its way to a field.
pub struct Job {
    state: State,
    info: ModelInfo,
    /// Number of centres to choose.
    wanted: u32,
    /// All distinct points, once they are known; the fitter takes them.
    given: Vec<DVec3>,
    /// The centres, once they are chosen.
    centres: Vec<DVec3>,
}

/// State of the current stage.
enum State {
    Reading(Box<Reader>),
    Facing(FileMesh),
    Merging(Merger),
    Thinning(Thinner),
    Estimating(Cloud, Box<Estimator>),
    Spreading(Cloud, Spreader),
    Solving(Box<Fitter>),
    Done(Box<Fit>),
    Failed(JobError),
}

impl Job {
    /// Job for a file. As many of its points as `centres` says (see [`CENTRES`]) will be interpolated; `name` is for
    /// reports.
    ///
    /// # Errors
    ///
    /// If the number of centres is out of range, or if the size, format or header of the file is wrong.
    pub fn file(name: &str, bytes: Vec<u8>, centres: u32) -> Result<Self, JobError> {
        if !CENTRES.contains(&centres) {
            return Err(JobError::Centres { count: centres });
        }
        let reader = Box::new(Reader::new(name, bytes)?);
        let info = ModelInfo { name: name.to_owned(), ..ModelInfo::default() };
        Ok(Self {
            state: State::Reading(reader),
            info,
            wanted: centres,
            given: Vec::new(),
            centres: Vec::new(),
        })
    }

    /// Job for a built-in model. As many of its points as `centres` says (see [`CENTRES`]) will be interpolated, or all of them if
    /// there are no more.
    ///
    /// # Errors
    ///
    /// If the number of centres is out of range, or if there is no model with this identifier.
    pub fn model(id: &str, centres: u32) -> Result<Self, JobError> {
        if !CENTRES.contains(&centres) {
            return Err(JobError::Centres { count: centres });
        }
        let unknown = || JobError::UnknownModel { id: id.to_owned() };
        let model = model::find(id).ok_or_else(unknown)?;
        let cloud = models::cloud(id).ok_or_else(unknown)?;
        let mut job = Self {
            state: State::Failed(unknown()),
            info: models::info(model),
            wanted: centres,
            given: cloud.position.clone(),
            centres: Vec::new(),
        };
        job.state = if centres as usize >= cloud.len() {
            job.centres.clone_from(&cloud.position);
            State::Solving(Box::new(models::begin(model)))
        } else {
            job.spread(cloud)
        };
        Ok(job)
    }

    /// Current progress.
    #[must_use]
    pub fn progress(&self) -> Progress {
        // Begin and length of the stage as shares of the whole time, for a file of some megabytes. A smaller one is
        // done at once.
        let (stage, label, begins, length, share) = match &self.state {
            State::Reading(reader) => (JobStage::Reading, "Reading the file", 0.0, 0.4, reader.fraction()),
            State::Facing(mesh) => {
                (JobStage::Normals, "Finding normals from the faces", 0.4, 0.05, mesh.fraction_summed())
            }
            State::Merging(merger) => {
                (JobStage::Thinning, "Joining equal points", 0.45, 0.15, merger.fraction())
            }
            // The number of grids that thinning will take is not known.
            State::Thinning(_) => (JobStage::Thinning, "Thinning out", 0.6, 0.05, 0.0),
            State::Estimating(_, estimator) => {
                (JobStage::Normals, "Estimating normals", 0.65, 0.1, estimator.fraction())
            }
            State::Spreading(_, spreader) => {
                (JobStage::Thinning, "Choosing centres", 0.75, 0.05, spreader.fraction())
            }
            State::Solving(fitter) => {
                (JobStage::Solving, "Solving for the surface", 0.8, 0.2, fitter.fraction())
            }
            State::Done(_) | State::Failed(_) => (JobStage::Done, "Done", 1.0, 0.0, 0.0),
        };
        let done = matches!(self.state, State::Done(_));
        Progress { stage, label, fraction: begins + share * length, done }
    }

    /// Does up to `budget` units of work and returns the progress.
    ///
    /// A unit takes about a tenth of a millisecond natively; between two stages of a file with millions of points it may take some
    /// tens of milliseconds.
    ///
    /// # Errors
    ///
    /// What is wrong with the file, the points or the system. Every later call returns the same error.
    pub fn step(&mut self, budget: u32) -> Result<Progress, JobError> {
        for _ in 0..budget {
            let state = match &self.state {
                State::Done(_) => break,
                State::Failed(error) => return Err(error.clone()),
                _ => core::mem::replace(&mut self.state, State::Failed(CloudError::Memory.into())),
            };
            self.state = self.advance(state).unwrap_or_else(State::Failed);
        }
        match &self.state {
            State::Failed(error) => Err(error.clone()),
            _ => Ok(self.progress()),
        }
    }

    /// The field, once it is complete.
    #[must_use]
    pub fn fit(&self) -> Option<&Fit> {
        match &self.state {
            State::Done(fit) => Some(fit),
            _ => None,
        }
    }

    /// Points that are interpolated, once they are chosen.
    #[must_use]
    pub fn centres(&self) -> &[DVec3] {
        &self.centres
    }

    /// Does one unit of work and returns the next state.
    fn advance(&mut self, state: State) -> Result<State, JobError> {
        Ok(match state {
            State::Reading(mut reader) => {
                if reader.step(ROWS)? {
                    let mesh = reader.into_mesh();
                    self.info.points = mesh.position.len() as u32;
                    State::Facing(mesh)
                } else {
                    State::Reading(reader)
                }
            }
            State::Facing(mut mesh) => {
                if mesh.sum_areas(FACES)? {
                    let (cloud, warnings) = mesh.into_cloud();
                    self.info.warnings = warnings;
                    self.info.normals = cloud.source;
                    State::Merging(Merger::new(cloud))
                } else {
                    State::Facing(mesh)
                }
            }
            State::Merging(mut merger) => {
                if merger.step(POINTS)? {
                    let (mut cloud, _) = merger.finish();
                    check_spread(&cloud.position)?;
                    self.bring_near(&mut cloud.position);
                    self.given.clone_from(&cloud.position);
                    State::Thinning(Thinner::new(cloud))
                } else {
                    State::Merging(merger)
                }
            }
            State::Thinning(mut thinner) => {
                if !thinner.step(POINTS)? {
                    return Ok(State::Thinning(thinner));
                }
                let cloud = thinner.finish();
                if cloud.normal.is_empty() {
                    let estimator = Estimator::new(&cloud.position);
                    State::Estimating(cloud, Box::new(estimator))
                } else {
                    self.spread(cloud)
                }
            }
            State::Estimating(mut cloud, mut estimator) => {
                if estimator.step(PLANES) {
                    self.info.warnings.extend(estimator.finish(&mut cloud)?);
                    self.spread(cloud)
                } else {
                    State::Estimating(cloud, estimator)
                }
            }
            State::Spreading(cloud, mut spreader) => {
                if spreader.step(&cloud.position) {
                    let chosen = cloud.only(spreader.chosen());
                    self.centres.clone_from(&chosen.position);
                    let given = core::mem::take(&mut self.given);
                    let fitter = Fitter::new(&chosen, given, self.info.clone())?;
                    State::Solving(Box::new(fitter))
                } else {
                    State::Spreading(cloud, spreader)
                }
            }
            State::Solving(mut fitter) => match fitter.step(1)? {
                Some(mut fit) => {
                    // The fit counts only distinct points.
                    fit.info.points = self.info.points.max(fit.info.points);
                    State::Done(Box::new(fit))
                }
                None => State::Solving(fitter),
            },
            over @ (State::Done(_) | State::Failed(_)) => over,
        })
    }

    fn spread(&self, cloud: Cloud) -> State {
        let spreader = Spreader::new(&cloud.position, self.wanted as usize);
        State::Spreading(cloud, spreader)
    }

    /// Moves points far from the origin, relative to their size, by round numbers to the origin, and warns of it.
    fn bring_near(&mut self, points: &mut [DVec3]) {
        let (lo, hi) = corners(points);
        let (middle, diagonal) = ((lo + hi) / 2.0, (hi - lo).length());
        if middle.abs().max_element() <= FAR * diagonal {
            return;
        }
        let moved = middle.map(|x| round_to(-x, diagonal));
        for p in points {
            *p += moved;
        }
        self.info.warnings.push(format!(
            "The points lie far from the origin for their size and were moved by {}, {}, {}: single precision would lose \
             their last digits.",
            moved.x, moved.y, moved.z
        ));
    }
}

/// Multiple nearest to `x` of the largest power of ten not above `unit`.
fn round_to(x: f64, unit: f64) -> f64 {
    let (mut power, mut inverse) = (1.0, 1.0);
    while power * 10.0 <= unit {
        power *= 10.0;
    }
    while power / inverse > unit {
        inverse *= 10.0;
    }
    // Division by integers gives the double nearest to the decimal. Adding 0 avoids a negative zero.
    (x / power * inverse).round() / inverse * power + 0.0
}
