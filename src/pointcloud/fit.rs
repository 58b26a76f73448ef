//! Fits a smooth function to points with normals: Hermite radial basis functions at centres, with
//! as much smoothing as cross-validation chooses.
//!
//! The function is f(x) = Σ αⱼ φ(|x − cⱼ|) + βⱼ · ∇φ(x − cⱼ) with φ(r) = r³ (I. Macêdo, J. P. Gois
//! & L. Velho, "Hermite Radial Basis Functions Implicits", 2011). N of the points are its centres,
//! and every point is in the cell of the nearest centre. The means of f and of ∇f − n over each
//! cell shall vanish: 4 N linear equations for the 4 N coefficients. If every point is a centre,
//! the function interpolates them. For smoothing, each equation of a cell with nⱼ points has λ/nⱼ
//! times the unknown of its own centre, αⱼ or −βⱼ, added, as in a smoothing spline (G. Wahba,
//! "Spline Models for Observational Data", 1990, §1.3). Cross-validation chooses λ so that the
//! function of one half of the points is near the other half.
//!
//! The system is set up in local coordinates, in which the centres fill a box of about one unit,
//! and solved in double precision.

use super::solve::{Decomposition, SingularMatrix};
use super::thin::check_spread;
use super::{Cloud, CloudError, ModelInfo, border};
use crate::field::rbf::{CentredFrame, RbfData, RbfField};
use crate::field::{Field, Frame};
use crate::math::{Bounds, significant, sort_numbers};
use crate::slices::{self, HEAVY, LIGHT};
use glam::{BVec3, DVec3, Vec3};
use nalgebra::{DMatrix, DMatrixViewMut, DVector};
use std::sync::Arc;

/// Fewest centres: fewer bound no volume.
const MIN_CENTRES: usize = 4;
/// Condition number above which a solution is refused: fewer than three digits remain in double
/// precision.
const MAX_CONDITION: f64 = 1e13;
/// Condition number above which the user is warned: fewer than six digits remain, about those of
/// single precision.
const WARN_CONDITION: f64 = 1e10;
/// Margin around the points for the surface, which bulges between them, as a share of the diagonal
/// of their box.
const MARGIN: f64 = 0.06;
/// Largest smoothing term λ that is tried.
const LARGEST_SMOOTHING: f64 = 4.0;
/// Ratio of consecutive trial terms. Smaller: fewer trials, a coarser choice.
const SMOOTHING_STEP: f64 = 0.25;
/// Most terms that are tried; the last one is 10⁻⁵.
const SMOOTHING_TRIALS: u32 = 10;
/// Most centres with which the terms are tried. λ weighs points, not centres, so it is valid for
/// more centres, too, whose systems take up to 64 times as long.
const TRIAL_CENTRES: usize = 200;
/// Fractions of the work at which the trials end, and at which the elimination begins and ends, for
/// the display of progress.
const TRIALS_END: f64 = 0.4;
const ELIMINATION_SPAN: [f64; 2] = [0.5, 0.9];

/// A field near points, with a box for sampling and a report.
#[derive(Clone, Debug)]
pub struct Fit {
    /// Centres and coefficients.
    #[doc(hidden)]
    pub data: Arc<RbfData>,
    /// Box for sampling: the box of all points, with a margin.
    pub bounds: Bounds,
    /// Report for the user.
    pub info: ModelInfo,
}

impl Fit {
    /// The field of the surface, cut at the border of the points. See [`RbfField::untrimmed`].
    ///
    /// # Panics
    ///
    /// Never: solved coefficients are finite.
    #[must_use]
    pub fn field(&self) -> RbfField {
        let field = RbfField::new(self.data.clone());
        field.unwrap_or_else(|error| panic!("a solved system is a field: {error}")).trimmed()
    }

    /// Finds the border of the points and reports how much of the surface lies beyond it.
    pub(super) async fn trim(&mut self, points: &[DVec3], centres: &[DVec3]) {
        let found = border::find(&self.field().untrimmed(), points, centres, &self.bounds).await;
        let Some((border, share)) = found else { return };
        self.info.beyond_share = share;
        let percent = significant((100.0 * share).max(0.1));
        self.info.warnings.push(format!(
            "The fitted surface goes on beyond its points, with {percent} % of its area: by itself it ends at their \
             border, unless you choose to keep what lies beyond."
        ));
        let mut data = RbfData::clone(&self.data);
        data.border = Some(border);
        self.data = Arc::new(data);
    }
}

/// Why no function can be fitted to points.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// There are too few centres to bound a volume.
    #[error("{count} points are too few: at least {MIN_CENTRES} are needed, and a few hundred are better")]
    TooFew {
        /// Number of centres.
        count: usize,
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

/// Fits a function to the points of `cloud`. The indices `chosen` select its centres. Residuals are
/// measured at all points `given`. The fit's report takes its name, credit and warnings from
/// `info`. `tell` gets the fraction of the work done.
///
/// # Errors
///
/// If there are too few centres, if they lie in one plane, if the system cannot be solved, or if
/// memory runs out.
///
/// # Panics
///
/// If a point has no normal.
pub async fn approximate(
    cloud: &Cloud,
    chosen: &[u32],
    given: &[DVec3],
    info: ModelInfo,
    tell: impl Fn(f64),
) -> Result<Fit, FitError> {
    assert_eq!(cloud.len(), cloud.normal.len(), "every point has a normal");
    if chosen.len() < MIN_CENTRES {
        return Err(FitError::TooFew { count: chosen.len() });
    }
    let frame = CentredFrame::of(cloud.only(chosen).position.into_iter());
    // Positions are rounded to single precision, so that sampling uses exactly the same centres.
    let local: Vec<DVec3> = cloud.position.iter().map(|&p| frame.local(p).as_vec3().as_dvec3()).collect();
    let centres: Vec<DVec3> = chosen.iter().map(|&i| local[i as usize]).collect();
    check_spread(&centres)?;
    let points: Vec<CellPoint> = local
        .into_iter()
        .zip(&cloud.normal)
        .map(|(position, normal)| CellPoint { position, normal: normal.normalize_or_zero(), cell: 0 })
        .collect();
    let smoothing = smoothing(&points, &centres, |share| tell(TRIALS_END * share)).await?;
    let [begin, end] = ELIMINATION_SPAN;
    let (points, distance_sq) = in_cells(points, &centres).await;
    let of_system = |share| tell(TRIALS_END + (begin - TRIALS_END) * share);
    let system = System::new(&points, &centres, of_system).await?;
    let smoothing = Smoothing { value: smoothing, distance_sq };
    let (x, condition) = system.solve(smoothing, |share| tell(begin + (end - begin) * share)).await?;
    if condition.is_nan() || condition >= MAX_CONDITION {
        return Err(FitError::Singular { condition });
    }
    let field = field_of(&x, &centres, &frame)?;
    let (residuals, farthest) = residuals(&field, given, |share| tell(end + (1.0 - end) * share)).await;
    let info = ModelInfo {
        farthest: farthest.to_array(),
        points: given.len().max(cloud.len()) as u32,
        centres: centres.len() as u32,
        normals: cloud.source,
        condition,
        ..info
    };
    Ok(reported(&field, given, residuals, info))
}

/// A point in local coordinates.
#[derive(Clone, Copy)]
struct CellPoint {
    position: DVec3,
    normal: DVec3,
    /// Index of the nearest centre.
    cell: u32,
}

/// Assigns each point to the cell of its nearest centre; ties go to the smaller index. Also returns
/// the mean squared distance from the points to their centres.
async fn in_cells(mut points: Vec<CellPoint>, centres: &[DVec3]) -> (Vec<CellPoint>, f64) {
    let nearest = |point: &CellPoint| {
        let (mut least, mut cell) = (f64::INFINITY, 0);
        for (j, centre) in centres.iter().enumerate() {
            let distance_sq = centre.distance_squared(point.position);
            if distance_sq < least {
                (least, cell) = (distance_sq, j as u32);
            }
        }
        (least, cell)
    };
    let parts = slices::map(
        points.len(),
        LIGHT.div_ceil(centres.len()),
        || (),
        |(), range| points[range].iter().map(nearest).collect::<Vec<_>>(),
    );
    let (mut sum, nearest) = (0.0, parts.await.concat());
    for (point, (distance_sq, cell)) in points.iter_mut().zip(nearest) {
        point.cell = cell;
        sum += distance_sq;
    }
    let count = points.len() as f64;
    (points, sum / count)
}

/// The smoothing term for which the function of one half of the points is nearest to the other
/// half; 0 if nearly every point is a centre.
///
/// The points of each cell go to the two halves alternately. The error is the mean of f² and (d |∇f
/// − n|)², where d is the distance of the points from their centres. Terms are tried in descending
/// order until the error grows.
async fn smoothing(points: &[CellPoint], centres: &[DVec3], tell: impl Fn(f64)) -> Result<f64, FitError> {
    if 2 * (points.len() - centres.len()) < centres.len() {
        return Ok(0.0);
    }
    let centres = &centres[..centres.len().min(TRIAL_CENTRES)];
    let (points, distance_sq) = in_cells(points.to_vec(), centres).await;
    let mut count = vec![0_u32; centres.len()];
    let (fitted, left_out): (Vec<CellPoint>, Vec<CellPoint>) = points.into_iter().partition(|point| {
        let count = &mut count[point.cell as usize];
        *count += 1;
        !count.is_multiple_of(2)
    });
    let system = System::new(&fitted, centres, |_| {}).await?;
    let (mut least, mut best, mut tried) = (f64::INFINITY, LARGEST_SMOOTHING, LARGEST_SMOOTHING);
    for trial in 0..SMOOTHING_TRIALS {
        tell(f64::from(trial) / f64::from(SMOOTHING_TRIALS));
        let (x, _) = system.clone().solve(Smoothing { value: tried, distance_sq }, |_| {}).await?;
        let field = field_of(&x, centres, &CentredFrame::default())?;
        let error = error_at(&field, &left_out, distance_sq).await;
        if error.is_nan() || error >= least {
            break;
        }
        (least, best) = (error, tried);
        tried *= SMOOTHING_STEP;
    }
    Ok(best)
}

/// Sum of f² and `distance_sq` |∇f − n|² over the points.
async fn error_at(field: &RbfField, points: &[CellPoint], distance_sq: f64) -> f64 {
    let new_scratch = || field.evaluator(Frame::default());
    let parts = slices::map(points.len(), HEAVY, new_scratch, |field, range| {
        let points = &points[range];
        let positions: Vec<Vec3> = points.iter().map(|point| point.position.as_vec3()).collect();
        let (mut value, mut gradient) = (vec![0.0; points.len()], vec![DVec3::ZERO; points.len()]);
        field.exact_gradients(&positions, &mut value, &mut gradient);
        let error = |(point, (value, gradient)): (&CellPoint, (f64, DVec3))| {
            value * value + distance_sq * gradient.distance_squared(point.normal)
        };
        points.iter().zip(value.into_iter().zip(gradient)).map(error).collect::<Vec<f64>>()
    });
    parts.await.into_iter().flatten().sum()
}

/// The field with the unknowns `x`: α and −β of each centre, in local coordinates.
fn field_of(x: &DVector<f64>, centres: &[DVec3], frame: &CentredFrame) -> Result<RbfField, FitError> {
    let mut data = RbfData::default();
    let scale = frame.scale();
    for (i, &centre) in centres.iter().enumerate() {
        // With g as the function in local coordinates, f(x) = g(s (x − o))/s has the same
        // gradients; its coefficients are α s² and β s.
        data.centres.push(frame.world(centre).to_array());
        data.alpha.push(x[4 * i] * scale * scale);
        data.beta.push([1, 2, 3].map(|k| -x[4 * i + k] * scale));
    }
    RbfField::new(data).map_err(|_| FitError::Singular { condition: f64::INFINITY })
}

/// The fit with its report.
fn reported(field: &RbfField, given: &[DVec3], mut residuals: Vec<f32>, mut info: ModelInfo) -> Fit {
    let centres = field.data().centres.iter().map(|&c| DVec3::from_array(c));
    let bounds = Bounds::around(given.iter().copied().chain(centres));
    let diagonal = bounds.diagonal();
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
    let bounds = bounds.enlarged(MARGIN * diagonal);
    let [lo, hi] = [bounds.lo(), bounds.hi()];
    let corner = |k: u32| DVec3::select(BVec3::new(k & 1 > 0, k & 2 > 0, k & 4 > 0), hi, lo);
    if (0..8).all(|k| field.value_and_gradient(corner(k)).0 < 0.0) {
        info.warnings.push(
            "The normals point inward: the solid is what lies around the points, and the volume of its mesh is negative. Turn them round if \
             the inside is meant."
                .into(),
        );
    }
    Fit { data: field.data().clone(), bounds, info }
}

/// The equations for α and −β of each centre: the means of f and ∇f over each centre's cell.
#[derive(Clone)]
struct System {
    matrix: DMatrix<f64>,
    /// Means of the normals, on the right side of the equations of ∇f.
    right: DVector<f64>,
    /// Number of points in each cell.
    count: Vec<f64>,
}

/// The smoothing term λ of f. For ∇f it is divided by the mean squared distance of the points from
/// their centres, over which an error of the slope becomes one of the height.
struct Smoothing {
    value: f64,
    /// Mean of the squared distances.
    distance_sq: f64,
}

impl System {
    /// The equations without smoothing. `tell` gets the fraction of the work done.
    async fn new(points: &[CellPoint], centres: &[DVec3], tell: impl Fn(f64)) -> Result<Self, CloudError> {
        let side = 4 * centres.len();
        let mut entries = Vec::new();
        entries.try_reserve_exact(side * side).map_err(|_| CloudError::Memory)?;
        entries.resize(side * side, 0.0);
        let mut this = Self {
            matrix: DMatrix::from_vec(side, side, entries),
            right: DVector::zeros(side),
            count: vec![0.0; centres.len()],
        };
        for point in points {
            this.count[point.cell as usize] += 1.0;
        }
        let count = &this.count;
        let of_centres = LIGHT.div_ceil(points.len());
        let tenth = centres.len().div_ceil(10);
        let tenths = this.matrix.as_mut_slice().chunks_mut(4 * side * tenth).zip(centres.chunks(tenth));
        for (done, (columns, centres)) in (0..).zip(tenths) {
            tell(f64::from(done) / 10.0);
            slices::change(columns, 4 * side * of_centres, |k, columns| {
                for (columns, &centre) in columns.chunks_exact_mut(4 * side).zip(&centres[k * of_centres..]) {
                    let columns = &mut DMatrixViewMut::from_slice(columns, side, 4);
                    add_columns(points, count, centre, columns);
                }
            })
            .await;
        }
        for point in points {
            let (cell, count) = (point.cell as usize, this.count[point.cell as usize]);
            for axis in 0..3 {
                this.right[4 * cell + 1 + axis] += point.normal[axis] / count;
            }
        }
        Ok(this)
    }

    /// Solves for the unknowns, and estimates the condition number. `tell` gets the fraction of the
    /// work done.
    async fn solve(
        mut self,
        smoothing: Smoothing,
        tell: impl Fn(f64),
    ) -> Result<(DVector<f64>, f64), FitError> {
        // A term of 0 is not added, since the one of the slope may be 0/0.
        for (j, count) in self.count.iter().enumerate().filter(|_| smoothing.value > 0.0) {
            let of_value = smoothing.value / count;
            let of_slope = of_value / smoothing.distance_sq;
            for (row, term) in (4 * j..).zip([of_value, of_slope, of_slope, of_slope]) {
                self.matrix[(row, row)] += term;
            }
        }
        let decomposition = Decomposition::new(self.matrix, tell).await?;
        decomposition.solve(&mut self.right)?;
        Ok((self.right, decomposition.condition()?))
    }
}

/// Writes the four columns of a centre. `count` is the number of points in each cell.
fn add_columns(points: &[CellPoint], count: &[f64], centre: DVec3, columns: &mut DMatrixViewMut<'_, f64>) {
    for point in points {
        let (cell, d) = (point.cell as usize, point.position - centre);
        let r = d.length();
        if r == 0.0 {
            continue;
        }
        let share = 1.0 / count[cell];
        let gradient = 3.0 * r * d * share;
        let mut block = columns.rows_range_mut(4 * cell..4 * cell + 4);
        block[(0, 0)] += r * r * r * share;
        for a in 0..3 {
            block[(0, 1 + a)] -= gradient[a];
            block[(1 + a, 0)] += gradient[a];
            for b in 0..3 {
                let identity = if a == b { r } else { 0.0 };
                block[(1 + a, 1 + b)] -= 3.0 * (identity + d[a] * d[b] / r) * share;
            }
        }
    }
}

/// Residuals |f|/|∇f| of the points, and the point with the largest one. Points where ∇f vanishes
/// have none.
async fn residuals(field: &RbfField, points: &[DVec3], tell: impl Fn(f64)) -> (Vec<f32>, DVec3) {
    let new_scratch = || field.evaluator(Frame::default());
    let mut all: Vec<f32> = Vec::with_capacity(points.len());
    for (done, points) in (0..).zip(points.chunks(points.len().div_ceil(10).max(1))) {
        tell(f64::from(done) / 10.0);
        let parts = slices::map(points.len(), HEAVY, new_scratch, |field, range| {
            let batch: Vec<Vec3> = points[range].iter().map(|p| p.as_vec3()).collect();
            let mut value = vec![0.0; batch.len()];
            let mut gradient = vec![Vec3::ZERO; batch.len()];
            field.gradients(&batch, &mut value, &mut gradient);
            let residual = |(value, gradient): (&f32, &Vec3)| value.abs() / gradient.length();
            value.iter().zip(&gradient).map(residual).collect::<Vec<f32>>()
        });
        all.extend(parts.await.concat());
    }
    let mut residuals = Vec::with_capacity(points.len());
    let (mut largest, mut farthest) = (0.0, DVec3::ZERO);
    for (p, residual) in points.iter().zip(all) {
        if residual.is_finite() {
            residuals.push(residual);
        }
        if residual.is_finite() && residual > largest {
            (largest, farthest) = (residual, *p);
        }
    }
    (residuals, farthest)
}
