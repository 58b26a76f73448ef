//! The whole way from a file or a built-in model to a field, a bounded piece of work at a time.

use super::fit::{Fit, FitError, Fitter};
use super::models;
use super::normals::Estimator;
use super::read::{Mesh, ReadError, Reader};
use super::thin::{Merger, Spreader, Thinner, check_spread, corners};
use super::{Cloud, CloudError, ModelInfo};
use crate::field::model;
use core::ops::RangeInclusive;
use glam::DVec3;
use serde::Serialize;

/// How many centres can be asked for.
pub const CENTRES: RangeInclusive<u32> = 100..=800;
/// Centres where nothing is asked for: the number that the paper's models have (§6).
pub const DEFAULT_CENTRES: u32 = 200;

/// Pieces of the quick stages that are done at once, so that each takes up to about a tenth of a millisecond natively.
const ROWS: u32 = 500;
const FACES: u32 = 2000;
const POINTS: u32 = 1000;
const PLANES: u32 = 20;

/// Points whose distance from the origin is more than this many diagonals of their box are moved to it. Single precision, in
/// which the surface is sampled, then tells places apart that are a millionth of the diagonal from each other.
const FAR: f64 = 10.0;

/// What a job is at, as the page tells it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// The file is read.
    Reading,
    /// Normals are taken from the faces, or estimated.
    Normals,
    /// Equal points are joined, and few of many chosen.
    Thinning,
    /// The system is set up and solved, and the field compared with the points.
    Solving,
    /// The field is there.
    Done,
}

/// How far a job has come.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Progress {
    /// What it is at.
    pub stage: Stage,
    /// The same in words.
    pub label: &'static str,
    /// Share of the whole, from 0 to 1; it never falls.
    pub fraction: f64,
    /// Whether the field is there.
    pub done: bool,
}

/// Why a job came to nothing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum JobError {
    /// The file is not read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// Nothing can be made of its points.
    #[error(transparent)]
    Cloud(#[from] CloudError),
    /// No field goes through them.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// There is no such model.
    #[error("there is no model `{id}`; known are {}", names())]
    UnknownModel {
        /// What was asked for.
        id: String,
    },
    /// More or fewer centres than are allowed.
    #[error("{count} centres: choose {} to {}", CENTRES.start(), CENTRES.end())]
    Centres {
        /// What was asked for.
        count: u32,
    },
}

impl JobError {
    /// A word for the kind of mistake, for programs.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Read(error) => error.kind(),
            Self::Cloud(_) | Self::Fit(_) => "points",
            Self::UnknownModel { .. } => "unknown_model",
            Self::Centres { .. } => "centres",
        }
    }

    /// Number of the line of a text file that is wrong.
    #[must_use]
    pub fn line(&self) -> Option<u64> {
        match self {
            Self::Read(ReadError::Line { line, .. }) => Some(*line),
            _ => None,
        }
    }
}

/// The built-in models by their identifiers.
fn names() -> String {
    let names: Vec<&str> = model::MODELS.iter().map(|model| model.id).collect();
    names.join(", ")
}

/// A file or a model on its way to a field.
pub struct Job {
    work: Work,
    info: ModelInfo,
    wanted: u32,
    centres: Vec<DVec3>,
}

/// What there is of the present stage.
enum Work {
    Reading(Box<Reader>),
    Facing(Mesh),
    Merging(Merger),
    Thinning(Thinner),
    Estimating(Cloud, Box<Estimator>),
    Spreading(Cloud, Spreader),
    Solving(Box<Fitter>),
    Done(Box<Fit>),
    Failed(JobError),
}

impl Job {
    /// Begins with a file, of whose points `centres` (see [`CENTRES`]) will be interpolated. `name` is for reports.
    ///
    /// # Errors
    ///
    /// If the number of centres is out of its range, or the file's size, kind or header is wrong.
    pub fn file(name: &str, bytes: Vec<u8>, centres: u32) -> Result<Self, JobError> {
        if !CENTRES.contains(&centres) {
            return Err(JobError::Centres { count: centres });
        }
        let reader = Box::new(Reader::new(name, bytes)?);
        let info = ModelInfo { name: name.to_owned(), ..ModelInfo::default() };
        Ok(Self { work: Work::Reading(reader), info, wanted: centres, centres: Vec::new() })
    }

    /// Begins with a built-in model, all of whose points are interpolated.
    ///
    /// # Errors
    ///
    /// If there is none of this name.
    pub fn model(id: &str) -> Result<Self, JobError> {
        let unknown = || JobError::UnknownModel { id: id.to_owned() };
        let model = model::find(id).ok_or_else(unknown)?;
        let centres = models::cloud(id).ok_or_else(unknown)?.position;
        Ok(Self {
            work: Work::Solving(Box::new(models::begin(model))),
            info: ModelInfo::default(),
            wanted: centres.len() as u32,
            centres,
        })
    }

    /// How far it has come.
    #[must_use]
    pub fn progress(&self) -> Progress {
        // Where the part begins and how long it is, as shares of the whole time: of a file of some megabytes, since a small
        // one is over before anyone looks.
        let (stage, label, begins, length, share) = match &self.work {
            Work::Reading(reader) => (Stage::Reading, "Reading the file", 0.0, 0.4, reader.fraction()),
            Work::Facing(mesh) => {
                (Stage::Normals, "Finding normals from the faces", 0.4, 0.05, mesh.summed())
            }
            Work::Merging(merger) => (Stage::Thinning, "Joining equal points", 0.45, 0.15, merger.fraction()),
            // How many grids it will take is not known.
            Work::Thinning(_) => (Stage::Thinning, "Thinning out", 0.6, 0.05, 0.0),
            Work::Estimating(_, estimator) => {
                (Stage::Normals, "Estimating normals", 0.65, 0.1, estimator.fraction())
            }
            Work::Spreading(_, spreader) => {
                (Stage::Thinning, "Choosing centres", 0.75, 0.05, spreader.fraction())
            }
            Work::Solving(fitter) => (Stage::Solving, "Solving for the surface", 0.8, 0.2, fitter.fraction()),
            Work::Done(_) | Work::Failed(_) => (Stage::Done, "Done", 1.0, 0.0, 0.0),
        };
        let done = matches!(self.work, Work::Done(_));
        Progress { stage, label, fraction: begins + share * length, done }
    }

    /// Does up to `budget` pieces of work, each of a millisecond at most; but between two stages of a file with millions of
    /// points there may be some tens of them.
    ///
    /// # Errors
    ///
    /// What is wrong with the file, the points or the system; the same again in every later call.
    pub fn step(&mut self, budget: u32) -> Result<Progress, JobError> {
        for _ in 0..budget {
            let work = match &self.work {
                Work::Done(_) => break,
                Work::Failed(error) => return Err(error.clone()),
                _ => core::mem::replace(&mut self.work, Work::Failed(CloudError::Memory.into())),
            };
            self.work = self.advance(work).unwrap_or_else(Work::Failed);
        }
        match &self.work {
            Work::Failed(error) => Err(error.clone()),
            _ => Ok(self.progress()),
        }
    }

    /// The field, once it is there.
    #[must_use]
    pub fn fit(&self) -> Option<&Fit> {
        match &self.work {
            Work::Done(fit) => Some(fit),
            _ => None,
        }
    }

    /// The points that are interpolated, once they are chosen.
    #[must_use]
    pub fn centres(&self) -> &[DVec3] {
        &self.centres
    }

    fn advance(&mut self, work: Work) -> Result<Work, JobError> {
        Ok(match work {
            Work::Reading(mut reader) => {
                if reader.step(ROWS)? {
                    let mesh = reader.into_mesh();
                    self.info.points = mesh.position.len() as u32;
                    Work::Facing(mesh)
                } else {
                    Work::Reading(reader)
                }
            }
            Work::Facing(mut mesh) => {
                if mesh.sum_areas(FACES)? {
                    let (cloud, warnings) = mesh.into_cloud();
                    self.info.warnings = warnings;
                    self.info.normals = cloud.source;
                    Work::Merging(Merger::new(cloud))
                } else {
                    Work::Facing(mesh)
                }
            }
            Work::Merging(mut merger) => {
                if merger.step(POINTS)? {
                    let (mut cloud, _) = merger.finish();
                    check_spread(&cloud.position)?;
                    self.bring_near(&mut cloud.position);
                    Work::Thinning(Thinner::new(cloud))
                } else {
                    Work::Merging(merger)
                }
            }
            Work::Thinning(mut thinner) => {
                if !thinner.step(POINTS)? {
                    return Ok(Work::Thinning(thinner));
                }
                let cloud = thinner.finish();
                if cloud.normal.is_empty() {
                    let estimator = Estimator::new(&cloud.position);
                    Work::Estimating(cloud, Box::new(estimator))
                } else {
                    self.spread(cloud)
                }
            }
            Work::Estimating(mut cloud, mut estimator) => {
                if estimator.step(PLANES) {
                    self.info.warnings.extend(estimator.finish(&mut cloud)?);
                    self.spread(cloud)
                } else {
                    Work::Estimating(cloud, estimator)
                }
            }
            Work::Spreading(cloud, mut spreader) => {
                if spreader.step(&cloud.position) {
                    let chosen = cloud.only(spreader.chosen());
                    self.centres.clone_from(&chosen.position);
                    let fitter = Fitter::new(&chosen, cloud.position, self.info.clone())?;
                    Work::Solving(Box::new(fitter))
                } else {
                    Work::Spreading(cloud, spreader)
                }
            }
            Work::Solving(mut fitter) => match fitter.step(1)? {
                Some(mut fit) => {
                    // The fit knows the points that were left after thinning.
                    fit.info.points = self.info.points.max(fit.info.points);
                    Work::Done(Box::new(fit))
                }
                None => Work::Solving(fitter),
            },
            over @ (Work::Done(_) | Work::Failed(_)) => over,
        })
    }

    fn spread(&self, cloud: Cloud) -> Work {
        let spreader = Spreader::new(&cloud.position, self.wanted as usize);
        Work::Spreading(cloud, spreader)
    }

    /// Moves points that lie far away for their size to the origin, by round numbers, and says so.
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

/// The multiple of a power of ten, the largest one up to `unit`, that is nearest to `x`.
fn round_to(x: f64, unit: f64) -> f64 {
    let (mut power, mut inverse) = (1.0, 1.0);
    while power * 10.0 <= unit {
        power *= 10.0;
    }
    while power / inverse > unit {
        inverse *= 10.0;
    }
    // Divided by whole numbers, so that the result is the double nearest to its decimals; and no negative zero.
    (x / power * inverse).round() / inverse * power + 0.0
}
