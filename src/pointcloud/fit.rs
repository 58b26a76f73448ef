//! The function through points with normals: Hermite radial basis functions.
//!
//! f(x) = Σ αⱼ φ(|x − cⱼ|) + βⱼ · ∇φ(x − cⱼ) with φ(r) = r³; f = 0 and ∇f = n at every centre are 4 n equations for the
//! 4 n coefficients. With −β for β the matrix is symmetric. The system is set up in local coordinates, in which the
//! centres fill a box of about one unit, and solved in double precision.

use super::solve::{Elimination, Singular};
use super::thin::check_spread;
use super::{Cloud, CloudError, ModelInfo};
use crate::field::Field;
use crate::field::rbf::{Frame, RbfData, RbfField};
use crate::math::Bounds;
use glam::{DVec3, Vec3};
use nalgebra::{DMatrix, DVector};

/// Fewer centres bound no volume.
const FEWEST: usize = 4;
/// The matrix of more takes more than 128 MB, and its solution minutes in a browser.
const MOST: usize = 1000;
/// Centres nearer to each other than this share of the diagonal are the same point: in single precision, in which the
/// surface is sampled, they are.
const DUPLICATE_SHARE: f64 = 1e-6;
/// A larger condition number leaves fewer than three digits in double precision.
const HOPELESS: f64 = 1e13;
/// From here on the user is told.
const DOUBTFUL: f64 = 1e10;
/// Room around the points, as a share of the diagonal of their box: the surface bulges between them.
const MARGIN: f64 = 0.06;
/// Points at which the residual is taken per unit of work.
const BATCH: usize = 1024;
/// Centres whose equations are written per unit of work.
const ASSEMBLED: usize = 8;
/// Shares of the work before and with the elimination, for the display of progress.
const STAGES: [f64; 2] = [0.1, 0.9];

/// A field from points and what is known of it.
#[derive(Clone, Debug)]
pub struct Fit {
    /// Centres and coefficients.
    pub data: RbfData,
    /// The box to sample in: that of all points, with room around it.
    pub bounds: Bounds,
    /// What to tell of it.
    pub info: ModelInfo,
}

/// Why no field could be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FitError {
    /// Too few centres to bound a volume.
    #[error("{count} points are too few: at least {FEWEST} are needed, and a few hundred are better")]
    TooFew {
        /// Number of centres.
        count: usize,
    },
    /// More centres than can be solved for.
    #[error("{count} centres are more than {MOST}")]
    TooMany {
        /// Number of centres.
        count: usize,
    },
    /// A point without a normal.
    #[error("there are {points} points and {normals} normals")]
    Normals {
        /// Number of points.
        points: usize,
        /// Number of normals.
        normals: usize,
    },
    /// A coordinate is infinite or not a number, or a normal has no direction.
    #[error("point {index} is not finite or its normal has no direction")]
    NotFinite {
        /// Index of the centre.
        index: usize,
    },
    /// Two centres at the same place.
    #[error("points {first} and {second} are the same: each place may be given once")]
    Duplicate {
        /// Index of one.
        first: usize,
        /// Index of the other.
        second: usize,
    },
    /// All centres lie in a plane or on a line, or the memory does not hold their equations.
    #[error(transparent)]
    Cloud(#[from] CloudError),
    /// The system has no solution that could be trusted.
    #[error(
        "the points contradict each other: the system for the surface cannot be solved (condition {condition:.0e})"
    )]
    Singular {
        /// Estimated condition number, infinite where a pivot vanished.
        condition: f64,
    },
}

impl From<Singular> for FitError {
    fn from(_: Singular) -> Self {
        Self::Singular { condition: f64::INFINITY }
    }
}

/// Makes a [`Fit`], a bounded piece of work at a time.
#[derive(Debug)]
pub struct Fitter {
    frame: Frame,
    /// In local coordinates.
    centres: Vec<DVec3>,
    normals: Vec<DVec3>,
    /// Points at which the residual is taken.
    given: Vec<DVec3>,
    info: ModelInfo,
    stage: Stage,
}

#[derive(Debug)]
enum Stage {
    /// Writes the equations of centre `next` and on.
    Assembling {
        matrix: DMatrix<f64>,
        next: usize,
    },
    Eliminating(Elimination),
    /// Measures the distance of the points from `next` on.
    Measuring {
        field: Box<RbfField>,
        condition: f64,
        next: usize,
        sum: f64,
        largest: f64,
    },
    /// Finished or failed.
    Over,
}

impl Fitter {
    /// Begins a field through `centres`, to be compared with all points `given`. Of `info` the name, credit and warnings are
    /// kept.
    ///
    /// # Errors
    ///
    /// If the centres are too few or too many, not finite, twice the same, or in one plane; if memory runs out.
    pub fn new(centres: &Cloud, given: Vec<DVec3>, info: ModelInfo) -> Result<Self, FitError> {
        let count = centres.len();
        match count {
            ..FEWEST => return Err(FitError::TooFew { count }),
            _ if count > MOST => return Err(FitError::TooMany { count }),
            _ if count != centres.normal.len() => {
                return Err(FitError::Normals { points: count, normals: centres.normal.len() });
            }
            _ => {}
        }
        let mut normals = Vec::with_capacity(count);
        for (index, (p, n)) in centres.position.iter().zip(&centres.normal).enumerate() {
            match n.try_normalize() {
                Some(n) if p.is_finite() => normals.push(n),
                _ => return Err(FitError::NotFinite { index }),
            }
        }
        let frame = Frame::of(centres.position.iter().copied());
        // Single precision knows the centres as they are used here, to the last bit.
        let local: Vec<DVec3> =
            centres.position.iter().map(|&p| frame.local(p).as_vec3().as_dvec3()).collect();
        check_places(&local)?;
        let info = ModelInfo {
            points: given.len().max(count) as u32,
            centres: count as u32,
            normals: centres.source,
            ..info
        };
        let stage = Stage::Assembling { matrix: equations(count)?, next: 0 };
        Ok(Self { frame, centres: local, normals, given, info, stage })
    }

    /// Share of the work done.
    #[must_use]
    pub fn fraction(&self) -> f64 {
        let share = |done: usize, of: usize| done as f64 / of.max(1) as f64;
        let [before, until] = STAGES;
        match &self.stage {
            Stage::Assembling { next, .. } => before * share(*next, self.centres.len()),
            Stage::Eliminating(elimination) => before + (until - before) * elimination.fraction(),
            Stage::Measuring { next, .. } => until + (1.0 - until) * share(*next, self.given.len()),
            Stage::Over => 1.0,
        }
    }

    /// Does up to `budget` units of work, each a millisecond or so; the field once it is done.
    ///
    /// # Errors
    ///
    /// If the system cannot be solved.
    ///
    /// # Panics
    ///
    /// If called again after the field or an error has been returned.
    pub fn step(&mut self, budget: u32) -> Result<Option<Fit>, FitError> {
        for _ in 0..budget {
            let stage = core::mem::replace(&mut self.stage, Stage::Over);
            self.stage = match stage {
                Stage::Assembling { mut matrix, next } => {
                    let end = (next + ASSEMBLED).min(self.centres.len());
                    for j in next..end {
                        assemble(&mut matrix, &self.centres, j);
                    }
                    if end < self.centres.len() {
                        Stage::Assembling { matrix, next: end }
                    } else {
                        Stage::Eliminating(Elimination::new(matrix))
                    }
                }
                Stage::Eliminating(mut elimination) => {
                    if elimination.step()? {
                        self.solved(&elimination)?
                    } else {
                        Stage::Eliminating(elimination)
                    }
                }
                Stage::Measuring { mut field, condition, next, mut sum, mut largest } => {
                    let end = (next + BATCH).min(self.given.len());
                    measure(&mut field, &self.given[next..end], &mut sum, &mut largest);
                    if end == self.given.len() {
                        return Ok(Some(self.measured(&field, condition, sum, largest)));
                    }
                    Stage::Measuring { field, condition, next: end, sum, largest }
                }
                Stage::Over => panic!("this fit is over"),
            };
        }
        Ok(None)
    }

    /// Does all that is left.
    ///
    /// # Errors
    ///
    /// As [`Fitter::step`].
    pub fn finish(mut self) -> Result<Fit, FitError> {
        loop {
            if let Some(fit) = self.step(u32::MAX)? {
                return Ok(fit);
            }
        }
    }

    /// The field, from the eliminated system.
    fn solved(&mut self, elimination: &Elimination) -> Result<Stage, FitError> {
        let mut x = DVector::zeros(4 * self.centres.len());
        for (i, normal) in self.normals.iter().enumerate() {
            for axis in 0..3 {
                x[4 * i + 1 + axis] = normal[axis];
            }
        }
        elimination.solve(&mut x)?;
        let condition = elimination.condition()?;
        if condition.is_nan() || condition >= HOPELESS {
            return Err(FitError::Singular { condition });
        }
        let mut data = RbfData::default();
        let scale = self.frame.scale();
        for (i, &centre) in self.centres.iter().enumerate() {
            // f(x) = g(s (x − o))/s keeps the gradients: α s², β s.
            data.centres.push(self.frame.world(centre).to_array());
            data.alpha.push(x[4 * i] * scale * scale);
            data.beta.push([1, 2, 3].map(|k| -x[4 * i + k] * scale));
        }
        match RbfField::new(data) {
            Ok(field) => {
                Ok(Stage::Measuring { field: Box::new(field), condition, next: 0, sum: 0.0, largest: 0.0 })
            }
            Err(_) => Err(FitError::Singular { condition }),
        }
    }

    fn measured(&mut self, field: &RbfField, condition: f64, sum: f64, largest: f64) -> Fit {
        let centres = field.data().centres.iter().map(|&c| DVec3::from_array(c));
        let (lo, hi) = corners(self.given.iter().copied().chain(centres));
        let diagonal = (hi - lo).length();
        let margin = DVec3::splat(MARGIN * diagonal);
        let mut info = core::mem::take(&mut self.info);
        info.condition = condition;
        info.residual_mean = sum / self.given.len().max(1) as f64 / diagonal;
        info.residual_max = largest / diagonal;
        if condition > DOUBTFUL {
            info.warnings.push(format!(
                "The points nearly contradict each other (condition {condition:.0e}); expect a rough surface."
            ));
        }
        let bounds = Bounds { min: (lo - margin).to_array(), max: (hi + margin).to_array() };
        Fit { data: field.data().clone(), bounds, info }
    }
}

fn corners(points: impl Iterator<Item = DVec3>) -> (DVec3, DVec3) {
    let none = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    points.fold(none, |(lo, hi), p| (lo.min(p), hi.max(p)))
}

/// Whether the places are distinct and do not lie in one plane.
fn check_places(places: &[DVec3]) -> Result<(), FitError> {
    check_spread(places)?;
    let (lo, hi) = corners(places.iter().copied());
    let near = DUPLICATE_SHARE * (hi - lo).length();
    for (second, p) in places.iter().enumerate() {
        if let Some(first) = places[..second].iter().position(|q| p.distance(*q) <= near) {
            return Err(FitError::Duplicate { first, second });
        }
    }
    Ok(())
}

/// Room for the equations of `count` centres, all zero.
fn equations(count: usize) -> Result<DMatrix<f64>, CloudError> {
    let side = 4 * count;
    let mut entries = Vec::new();
    entries.try_reserve_exact(side * side).map_err(|_| CloudError::Memory)?;
    entries.resize(side * side, 0.0);
    Ok(DMatrix::from_vec(side, side, entries))
}

/// Writes the columns of centre `j`: of its α and −β, in the rows of f and ∇f at every centre.
fn assemble(matrix: &mut DMatrix<f64>, centres: &[DVec3], j: usize) {
    for (i, &centre) in centres.iter().enumerate() {
        let d = centre - centres[j];
        let r = d.length();
        if r == 0.0 {
            continue;
        }
        let gradient = 3.0 * r * d;
        let mut block = matrix.view_mut((4 * i, 4 * j), (4, 4));
        block[(0, 0)] = r * r * r;
        for a in 0..3 {
            block[(0, 1 + a)] = -gradient[a];
            block[(1 + a, 0)] = gradient[a];
            for b in 0..3 {
                let identity = if a == b { r } else { 0.0 };
                block[(1 + a, 1 + b)] = -3.0 * (identity + d[a] * d[b] / r);
            }
        }
    }
}

/// Adds the distances of the points from the surface to `sum`, and the largest to `largest`.
fn measure(field: &mut RbfField, points: &[DVec3], sum: &mut f64, largest: &mut f64) {
    let points: Vec<Vec3> = points.iter().map(|p| p.as_vec3()).collect();
    let mut value = vec![0.0; points.len()];
    let mut gradient = vec![Vec3::ZERO; points.len()];
    field.gradients(&points, &mut value, &mut gradient);
    for (value, gradient) in value.iter().zip(&gradient) {
        let distance = f64::from(value.abs()) / f64::from(gradient.length());
        if distance.is_finite() {
            *sum += distance;
            *largest = largest.max(distance);
        }
    }
}
