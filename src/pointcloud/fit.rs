//! Interpolation of points with normals by Hermite radial basis functions.
//!
//! The function is f(x) = Σ αⱼ φ(|x − cⱼ|) + βⱼ · ∇φ(x − cⱼ) with φ(r) = r³. The conditions f = 0 and ∇f = n at each of
//! N centres are 4 N linear equations for the 4 N coefficients (I. Macêdo, J. P. Gois & L. Velho, "Hermite Radial Basis
//! Functions Implicits", 2011). With −β as unknown the matrix is symmetric. The system is set up in local coordinates,
//! in which the centres fill a box of about one unit, and solved in double precision.

use super::solve::{Elimination, Singular};
use super::thin::check_spread;
use super::{Cloud, CloudError, ModelInfo};
use crate::field::Field;
use crate::field::rbf::{Frame, RbfData, RbfField};
use crate::math::{Bounds, sort_numbers};
use glam::{DVec3, Vec3};
use nalgebra::{DMatrix, DVector};

/// Minimum number of centres: fewer bound no volume.
const MIN_CENTRES: usize = 4;
/// Maximum number of centres: the matrix of so many takes 128 MB, and solving it takes minutes in a browser.
const MAX_CENTRES: usize = 1000;
/// Distance below which two centres count as one, as a share of the diagonal of their box. In single precision, in
/// which the surface is sampled, they coincide.
const DUPLICATE_SHARE: f64 = 1e-6;
/// Condition number from which a solution is refused: fewer than three digits are left in double precision.
const MAX_CONDITION: f64 = 1e13;
/// Condition number above which the user is warned.
const WARN_CONDITION: f64 = 1e10;
/// Margin around the points for the surface, which bulges between them, as a share of the diagonal of their box.
const MARGIN: f64 = 0.06;
/// Number of points at which a unit of work takes the residual.
const BATCH: usize = 1024;
/// Number of centres whose equations a unit of work writes.
const ASSEMBLY_BATCH: usize = 8;
/// Fraction of the whole work at which the elimination begins and ends, for the display of progress.
const ELIMINATION_SPAN: [f64; 2] = [0.1, 0.9];

/// A field that interpolates points, with the box to sample in and a report.
#[derive(Clone, Debug)]
pub struct Fit {
    /// Centres and coefficients.
    pub data: RbfData,
    /// Box to sample in: that of all points, with a margin.
    pub bounds: Bounds,
    /// Report for the user.
    pub info: ModelInfo,
}

impl Fit {
    /// The field of the surface.
    ///
    /// # Panics
    ///
    /// Never: what was solved is finite.
    #[must_use]
    pub fn field(&self) -> RbfField {
        RbfField::new(self.data.clone()).unwrap_or_else(|error| panic!("a solved system is a field: {error}"))
    }
}

/// Why points cannot be interpolated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// There are too few centres to bound a volume.
    #[error("{count} points are too few: at least {MIN_CENTRES} are needed, and a few hundred are better")]
    TooFew {
        /// Number of centres.
        count: usize,
    },
    /// There are more centres than can be solved for.
    #[error("{count} centres are more than {MAX_CENTRES}")]
    TooMany {
        /// Number of centres.
        count: usize,
    },
    /// The numbers of points and of normals differ.
    #[error("there are {points} points and {normals} normals")]
    Normals {
        /// Number of points.
        points: usize,
        /// Number of normals.
        normals: usize,
    },
    /// A coordinate is not finite, or a normal has no direction.
    #[error("point {index} is not finite or its normal has no direction")]
    NotFinite {
        /// Index of the centre.
        index: usize,
    },
    /// Two centres coincide.
    #[error("points {first} and {second} are the same: each place may be given once")]
    Duplicate {
        /// Index of the first one.
        first: usize,
        /// Index of the second one.
        second: usize,
    },
    /// All centres lie in a plane or on a line, or there is not enough memory for their equations.
    #[error(transparent)]
    Cloud(#[from] CloudError),
    /// The system is singular or too ill-conditioned.
    #[error(
        "the points contradict each other: the system for the surface cannot be solved (condition {condition:.0e})"
    )]
    Singular {
        /// Estimated condition number, which is infinite if a pivot vanished.
        condition: f64,
    },
}

impl From<Singular> for FitError {
    fn from(_: Singular) -> Self {
        Self::Singular { condition: f64::INFINITY }
    }
}

/// Computes a [`Fit`] in slices of bounded work.
#[derive(Debug)]
pub struct Fitter {
    frame: Frame,
    /// In local coordinates.
    centres: Vec<DVec3>,
    normals: Vec<DVec3>,
    /// All points, at which the residual is taken.
    given: Vec<DVec3>,
    info: ModelInfo,
    stage: FitStage,
}

#[derive(Debug)]
enum FitStage {
    /// Writes the equations; those of centre `next` come next.
    Assembling {
        matrix: DMatrix<f64>,
        next: usize,
    },
    Eliminating(Elimination),
    /// Measures the distances of the points from the surface; point `next` comes next.
    Measuring {
        field: Box<RbfField>,
        condition: f64,
        next: usize,
        residuals: Vec<f32>,
    },
    /// Finished or failed.
    Over,
}

impl Fitter {
    /// Begins the interpolation of `centres`. The residual will be taken at all points `given`. The fit's report has
    /// the name, credit and warnings of `info`.
    ///
    /// # Errors
    ///
    /// If there are too few or too many centres, if they are not finite, coincide or lie in one plane, or if memory
    /// runs out.
    pub fn new(centres: &Cloud, given: Vec<DVec3>, info: ModelInfo) -> Result<Self, FitError> {
        let count = centres.len();
        match count {
            ..MIN_CENTRES => return Err(FitError::TooFew { count }),
            _ if count > MAX_CENTRES => return Err(FitError::TooMany { count }),
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
        // The centres are rounded to single precision, so that sampling finds exactly the same ones.
        let local: Vec<DVec3> =
            centres.position.iter().map(|&p| frame.local(p).as_vec3().as_dvec3()).collect();
        check_centres(&local)?;
        let info = ModelInfo {
            points: given.len().max(count) as u32,
            centres: count as u32,
            normals: centres.source,
            ..info
        };
        let stage = FitStage::Assembling { matrix: equations(count)?, next: 0 };
        Ok(Self { frame, centres: local, normals, given, info, stage })
    }

    /// Fraction of the work done, from 0 to 1.
    #[must_use]
    pub fn fraction(&self) -> f64 {
        let share = |done: usize, of: usize| done as f64 / of.max(1) as f64;
        let [begin, end] = ELIMINATION_SPAN;
        match &self.stage {
            FitStage::Assembling { next, .. } => begin * share(*next, self.centres.len()),
            FitStage::Eliminating(elimination) => begin + (end - begin) * elimination.fraction(),
            FitStage::Measuring { next, .. } => end + (1.0 - end) * share(*next, self.given.len()),
            FitStage::Over => 1.0,
        }
    }

    /// Does up to `budget` units of work, of about a millisecond each. Returns the fit once it is complete.
    ///
    /// # Errors
    ///
    /// If the system cannot be solved.
    ///
    /// # Panics
    ///
    /// If called after it has returned a fit or an error.
    pub fn step(&mut self, budget: u32) -> Result<Option<Fit>, FitError> {
        for _ in 0..budget {
            let stage = core::mem::replace(&mut self.stage, FitStage::Over);
            self.stage = match stage {
                FitStage::Assembling { mut matrix, next } => {
                    let end = (next + ASSEMBLY_BATCH).min(self.centres.len());
                    for j in next..end {
                        assemble(&mut matrix, &self.centres, j);
                    }
                    if end < self.centres.len() {
                        FitStage::Assembling { matrix, next: end }
                    } else {
                        FitStage::Eliminating(Elimination::new(matrix))
                    }
                }
                FitStage::Eliminating(mut elimination) => {
                    if elimination.step()? {
                        self.solved(&elimination)?
                    } else {
                        FitStage::Eliminating(elimination)
                    }
                }
                FitStage::Measuring { mut field, condition, next, mut residuals } => {
                    let end = (next + BATCH).min(self.given.len());
                    measure(&mut field, &self.given[next..end], &mut residuals);
                    if end == self.given.len() {
                        return Ok(Some(self.measured(&field, condition, residuals)));
                    }
                    FitStage::Measuring { field, condition, next: end, residuals }
                }
                FitStage::Over => panic!("this fit is over"),
            };
        }
        Ok(None)
    }

    /// Does all remaining work.
    ///
    /// # Errors
    ///
    /// Those of [`Fitter::step`].
    pub fn finish(mut self) -> Result<Fit, FitError> {
        loop {
            if let Some(fit) = self.step(u32::MAX)? {
                return Ok(fit);
            }
        }
    }

    /// Solves the eliminated system for the coefficients and begins to measure.
    fn solved(&mut self, elimination: &Elimination) -> Result<FitStage, FitError> {
        let mut x = DVector::zeros(4 * self.centres.len());
        for (i, normal) in self.normals.iter().enumerate() {
            for axis in 0..3 {
                x[4 * i + 1 + axis] = normal[axis];
            }
        }
        elimination.solve(&mut x)?;
        let condition = elimination.condition()?;
        if condition.is_nan() || condition >= MAX_CONDITION {
            return Err(FitError::Singular { condition });
        }
        let mut data = RbfData::default();
        let scale = self.frame.scale();
        for (i, &centre) in self.centres.iter().enumerate() {
            // With g the function in local coordinates, f(x) = g(s (x − o))/s has the same gradients; its coefficients
            // are α s² and β s.
            data.centres.push(self.frame.world(centre).to_array());
            data.alpha.push(x[4 * i] * scale * scale);
            data.beta.push([1, 2, 3].map(|k| -x[4 * i + k] * scale));
        }
        match RbfField::new(data) {
            Ok(field) => Ok(FitStage::Measuring {
                field: Box::new(field),
                condition,
                next: 0,
                residuals: Vec::with_capacity(self.given.len()),
            }),
            Err(_) => Err(FitError::Singular { condition }),
        }
    }

    /// Fit with its report, after all distances are measured.
    fn measured(&mut self, field: &RbfField, condition: f64, mut residuals: Vec<f32>) -> Fit {
        let centres = field.data().centres.iter().map(|&c| DVec3::from_array(c));
        let (lo, hi) = corners(self.given.iter().copied().chain(centres));
        let diagonal = (hi - lo).length();
        let margin = DVec3::splat(MARGIN * diagonal);
        let mut info = core::mem::take(&mut self.info);
        info.condition = condition;
        let sum: f64 = residuals.iter().copied().map(f64::from).sum();
        info.residual_mean = sum / residuals.len().max(1) as f64 / diagonal;
        sort_numbers(&mut residuals);
        let of_share = |share: f64| {
            let at = (share * residuals.len() as f64).ceil() as usize;
            residuals.get(at.saturating_sub(1)).map_or(0.0, |&residual| f64::from(residual) / diagonal)
        };
        (info.residual_95, info.residual_max) = (of_share(0.95), of_share(1.0));
        if condition > WARN_CONDITION {
            info.warnings.push(format!(
                "The points nearly contradict each other (condition {condition:.0e}); expect a rough surface."
            ));
        }
        let bounds = Bounds { min: (lo - margin).to_array(), max: (hi + margin).to_array() };
        Fit { data: field.data().clone(), bounds, info }
    }
}

/// Smallest and largest corner of the box of the points.
fn corners(points: impl Iterator<Item = DVec3>) -> (DVec3, DVec3) {
    let none = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    points.fold(none, |(lo, hi), p| (lo.min(p), hi.max(p)))
}

/// Checks that the centres are distinct and not in one plane.
fn check_centres(centres: &[DVec3]) -> Result<(), FitError> {
    check_spread(centres)?;
    let (lo, hi) = corners(centres.iter().copied());
    let tolerance = DUPLICATE_SHARE * (hi - lo).length();
    for (second, p) in centres.iter().enumerate() {
        if let Some(first) = centres[..second].iter().position(|q| p.distance(*q) <= tolerance) {
            return Err(FitError::Duplicate { first, second });
        }
    }
    Ok(())
}

/// Zero matrix for the equations of `count` centres.
fn equations(count: usize) -> Result<DMatrix<f64>, CloudError> {
    let side = 4 * count;
    let mut entries = Vec::new();
    entries.try_reserve_exact(side * side).map_err(|_| CloudError::Memory)?;
    entries.resize(side * side, 0.0);
    Ok(DMatrix::from_vec(side, side, entries))
}

/// Writes the columns of the unknowns α and −β of centre `j`, in the rows of f and ∇f at every centre.
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

/// Adds the residuals |f|/|∇f| of the points; there is none where ∇f vanishes.
fn measure(field: &mut RbfField, points: &[DVec3], residuals: &mut Vec<f32>) {
    let points: Vec<Vec3> = points.iter().map(|p| p.as_vec3()).collect();
    let mut value = vec![0.0; points.len()];
    let mut gradient = vec![Vec3::ZERO; points.len()];
    field.gradients(&points, &mut value, &mut gradient);
    for (value, gradient) in value.iter().zip(&gradient) {
        let residual = value.abs() / gradient.length();
        if residual.is_finite() {
            residuals.push(residual);
        }
    }
}
