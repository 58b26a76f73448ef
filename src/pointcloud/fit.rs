//! Interpolation of points with normals by Hermite radial basis functions.
//!
//! The function is f(x) = Σ αⱼ φ(|x − cⱼ|) + βⱼ · ∇φ(x − cⱼ) with φ(r) = r³. The conditions f = 0 and ∇f = n at each of
//! N centres are 4 N linear equations for the 4 N coefficients (I. Macêdo, J. P. Gois & L. Velho, "Hermite Radial Basis
//! Functions Implicits", 2011). With −β as unknown the matrix is symmetric. The system is set up in local coordinates,
//! in which the centres fill a box of about one unit, and solved in double precision.

use super::solve::{Decomposition, SingularMatrix};
use super::thin::{check_spread, corners};
use super::{Cloud, CloudError, ModelInfo};
use crate::field::Field;
use crate::field::rbf::{CentredFrame, RbfData, RbfField};
use crate::math::{Bounds, sort_numbers};
use crate::slices::{pause, ranges};
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
/// Condition number above which the user is warned: fewer than six digits are left, as many as single precision shows.
const WARN_CONDITION: f64 = 1e10;
/// Margin around the points for the surface, which bulges between them, as a share of the diagonal of their box. Half and twice
/// as much hold the same surfaces of twelve random clouds.
const MARGIN: f64 = 0.06;
/// Number of points at which a slice of work takes the residual. It changes no figure.
const BATCH: usize = 1024;
/// Number of centres whose columns a slice of work writes: 32 columns, as many as a panel of the solver has.
const ASSEMBLY_BATCH: usize = 8;
/// Fraction of the work at which the elimination begins and ends, for the display of progress.
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

impl From<SingularMatrix> for FitError {
    fn from(_: SingularMatrix) -> Self {
        Self::Singular { condition: f64::INFINITY }
    }
}

/// Interpolates `centres`. The residual is taken at all points `given`. The fit's report has the name, credit and warnings of `info`.
/// `tell` gets the fraction of the work done.
///
/// # Errors
///
/// If there are too few or too many centres, if they are not finite, coincide or lie in one plane, if the system cannot be solved,
/// or if memory runs out.
pub async fn interpolate(
    centres: &Cloud,
    given: &[DVec3],
    info: ModelInfo,
    tell: impl Fn(f64),
) -> Result<Fit, FitError> {
    let normals = check_numbers(centres)?;
    let frame = CentredFrame::of(centres.position.iter().copied());
    // The centres are rounded to single precision, so that sampling finds exactly the same ones.
    let local: Vec<DVec3> = centres.position.iter().map(|&p| frame.local(p).as_vec3().as_dvec3()).collect();
    check_centres(&local)?;
    let [begin, end] = ELIMINATION_SPAN;
    let matrix = assemble(&local, |share| tell(begin * share)).await?;
    let decomposition = Decomposition::new(matrix, |share| tell(begin + (end - begin) * share)).await?;
    let condition = decomposition.condition()?;
    if condition.is_nan() || condition >= MAX_CONDITION {
        return Err(FitError::Singular { condition });
    }
    let data = coefficients(&decomposition, &frame, &local, &normals)?;
    let mut field = RbfField::new(data).map_err(|_| FitError::Singular { condition })?;
    let residuals = residuals(&mut field, given, |share| tell(end + (1.0 - end) * share)).await;
    let info = ModelInfo {
        points: given.len().max(centres.len()) as u32,
        centres: centres.len() as u32,
        normals: centres.source,
        condition,
        ..info
    };
    Ok(reported(&field, given, residuals, info))
}

/// Unit normals of the centres, whose number and numbers are checked.
fn check_numbers(centres: &Cloud) -> Result<Vec<DVec3>, FitError> {
    let count = centres.len();
    match count {
        ..MIN_CENTRES => return Err(FitError::TooFew { count }),
        _ if count > MAX_CENTRES => return Err(FitError::TooMany { count }),
        _ if count != centres.normal.len() => {
            return Err(FitError::Normals { points: count, normals: centres.normal.len() });
        }
        _ => {}
    }
    let pairs = centres.position.iter().zip(&centres.normal).enumerate();
    pairs
        .map(|(index, (p, n))| {
            n.try_normalize().filter(|_| p.is_finite()).ok_or(FitError::NotFinite { index })
        })
        .collect()
}

/// Solves for the coefficients of the function.
fn coefficients(
    decomposition: &Decomposition,
    frame: &CentredFrame,
    centres: &[DVec3],
    normals: &[DVec3],
) -> Result<RbfData, SingularMatrix> {
    let mut x = DVector::zeros(4 * centres.len());
    for (i, normal) in normals.iter().enumerate() {
        for axis in 0..3 {
            x[4 * i + 1 + axis] = normal[axis];
        }
    }
    decomposition.solve(&mut x)?;
    let mut data = RbfData::default();
    let scale = frame.scale();
    for (i, &centre) in centres.iter().enumerate() {
        // With g the function in local coordinates, f(x) = g(s (x − o))/s has the same gradients; its coefficients
        // are α s² and β s.
        data.centres.push(frame.world(centre).to_array());
        data.alpha.push(x[4 * i] * scale * scale);
        data.beta.push([1, 2, 3].map(|k| -x[4 * i + k] * scale));
    }
    Ok(data)
}

/// The fit with its report.
fn reported(field: &RbfField, given: &[DVec3], mut residuals: Vec<f32>, mut info: ModelInfo) -> Fit {
    let centres: Vec<DVec3> = field.data().centres.iter().map(|&c| DVec3::from_array(c)).collect();
    let (lo, hi) = corners(given.iter().chain(&centres));
    let diagonal = (hi - lo).length();
    let margin = DVec3::splat(MARGIN * diagonal);
    let sum: f64 = residuals.iter().copied().map(f64::from).sum();
    info.residual_mean = sum / residuals.len().max(1) as f64 / diagonal;
    sort_numbers(&mut residuals);
    let of_share = |share: f64| {
        let at = (share * residuals.len() as f64).ceil() as usize;
        residuals.get(at.saturating_sub(1)).map_or(0.0, |&residual| f64::from(residual) / diagonal)
    };
    (info.residual_95, info.residual_max) = (of_share(0.95), of_share(1.0));
    if info.condition > WARN_CONDITION {
        info.warnings.push(format!(
            "The points nearly contradict each other (condition {:.0e}); expect a rough surface.",
            info.condition
        ));
    }
    let bounds = Bounds { min: (lo - margin).to_array(), max: (hi + margin).to_array() };
    Fit { data: field.data().clone(), bounds, info }
}

/// Checks that the centres are distinct and not in one plane.
fn check_centres(centres: &[DVec3]) -> Result<(), FitError> {
    check_spread(centres)?;
    let (lo, hi) = corners(centres);
    let tolerance = DUPLICATE_SHARE * (hi - lo).length();
    for (second, p) in centres.iter().enumerate() {
        if let Some(first) = centres[..second].iter().position(|q| p.distance(*q) <= tolerance) {
            return Err(FitError::Duplicate { first, second });
        }
    }
    Ok(())
}

/// The equations for the coefficients: the columns of the unknowns α and −β of each centre, in the rows of f and ∇f at every centre.
async fn assemble(centres: &[DVec3], tell: impl Fn(f64)) -> Result<DMatrix<f64>, CloudError> {
    let side = 4 * centres.len();
    let mut entries = Vec::new();
    entries.try_reserve_exact(side * side).map_err(|_| CloudError::Memory)?;
    entries.resize(side * side, 0.0);
    let mut matrix = DMatrix::from_vec(side, side, entries);
    for columns in ranges(centres.len(), ASSEMBLY_BATCH) {
        tell(columns.start as f64 / centres.len() as f64);
        for j in columns {
            assemble_columns(&mut matrix, centres, j);
        }
        pause().await;
    }
    Ok(matrix)
}

/// Writes the columns of centre `j`.
fn assemble_columns(matrix: &mut DMatrix<f64>, centres: &[DVec3], j: usize) {
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

/// Residuals |f|/|∇f| of the points; there is none where ∇f vanishes.
async fn residuals(field: &mut RbfField, points: &[DVec3], tell: impl Fn(f64)) -> Vec<f32> {
    let mut residuals = Vec::with_capacity(points.len());
    for range in ranges(points.len(), BATCH) {
        tell(range.start as f64 / points.len() as f64);
        let batch: Vec<Vec3> = points[range].iter().map(|p| p.as_vec3()).collect();
        let mut value = vec![0.0; batch.len()];
        let mut gradient = vec![Vec3::ZERO; batch.len()];
        field.gradients(&batch, &mut value, &mut gradient);
        let of_each = value.iter().zip(&gradient).map(|(value, gradient)| value.abs() / gradient.length());
        residuals.extend(of_each.filter(|residual| residual.is_finite()));
        pause().await;
    }
    residuals
}
