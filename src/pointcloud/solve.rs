//! Solver of a large system: blocked LU decomposition with partial pivoting, in slices.
//!
//! nalgebra factorises the panels and solves the triangular systems. The update of the columns to
//! the right of a panel takes nearly all of the time and is implemented here. Neither uses fused
//! multiply-add, so the solution has the same bits natively and in WebAssembly.

use crate::slices::{self, pause, ranges};
use core::ops::Range;
use nalgebra::{DMatrix, DMatrixView, DMatrixViewMut, DVector};

/// Columns per panel: enough to read a panel seldom, few enough to keep its rows in the cache.
/// Larger: longer slices.
const PANEL: usize = 32;
/// Rows updated together: 64 kB of a panel, which stay in a second-level cache while all columns
/// are updated.
const ROWS: usize = 256;
/// Most steps of Hager's estimator, which nearly always ends after two or three. LAPACK's DLACN2
/// has the same limit.
const ESTIMATOR_STEPS: usize = 5;

/// LU decomposition of a matrix.
#[derive(Clone, Debug)]
pub(super) struct Decomposition {
    /// The factors L and U; until they are complete, they replace the eliminated part of the
    /// matrix.
    matrix: DMatrix<f64>,
    /// Rows exchanged in each step.
    exchanges: Vec<(usize, usize)>,
    /// Norm ‖A‖₁ of the matrix.
    norm: f64,
}

/// A matrix is singular: a pivot is zero or not finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct SingularMatrix;

impl Decomposition {
    /// Decomposes a matrix. A slice factorises a panel, or updates [`PANEL`] columns by it, with at
    /// most 32² multiplications per row. `tell` gets the fraction of the work done.
    pub(super) async fn new(matrix: DMatrix<f64>, tell: impl Fn(f64)) -> Result<Self, SingularMatrix> {
        let norm = matrix.column_iter().map(|column| column.lp_norm(1)).fold(0.0, f64::max);
        let n = matrix.nrows();
        let mut this = Self { matrix, exchanges: Vec::new(), norm };
        // The remaining work is about the cube of the remaining columns.
        let left = |column: usize| (n.saturating_sub(column) as f64 / n as f64).powi(3);
        for range in ranges(n, PANEL) {
            tell(1.0 - left(range.start));
            let (first, end) = (range.start, range.end);
            this.factorise(range)?;
            pause().await;
            let (eliminated, open) = this.matrix.as_mut_slice().split_at_mut(end * n);
            let panel = &eliminated[first * n..];
            slices::change(open, PANEL * n, |_, columns| update(panel, first, columns, n)).await;
        }
        Ok(this)
    }

    /// Factorises the panel; exchanges whole rows to bring the pivots to the diagonal.
    fn factorise(&mut self, panel: Range<usize>) -> Result<(), SingularMatrix> {
        let end = panel.end;
        for k in panel {
            let pivot = k + self.matrix.column(k).rows_range(k..).icamax();
            self.matrix.swap_rows(k, pivot);
            self.exchanges.push((k, pivot));
            let diagonal = self.matrix[(k, k)];
            if !(diagonal.abs() > 0.0 && diagonal.is_finite()) {
                return Err(SingularMatrix);
            }
            let (mut factors, mut rest) = self.matrix.columns_range_pair_mut(k, k + 1..end);
            let mut factors = factors.rows_range_mut(k + 1..);
            factors *= 1.0 / diagonal;
            let (pivots, mut below) = rest.rows_range_pair_mut(k, k + 1..);
            for (mut column, pivot) in below.column_iter_mut().zip(pivots.iter()) {
                column.axpy(-pivot, &factors, 1.0);
            }
        }
        Ok(())
    }

    /// Solves A x = `right` in place.
    pub(super) fn solve(&self, right: &mut DVector<f64>) -> Result<(), SingularMatrix> {
        for &(k, pivot) in &self.exchanges {
            right.swap_rows(k, pivot);
        }
        let lower = self.matrix.solve_lower_triangular_with_diag_mut(right, 1.0);
        let upper = self.matrix.solve_upper_triangular_mut(right);
        if lower && upper && right.iter().all(|x| x.is_finite()) { Ok(()) } else { Err(SingularMatrix) }
    }

    /// Lower estimate of the condition number ‖A‖₁ ‖A⁻¹‖₁, seldom too small by more than a factor
    /// of three (Hager 1984; Higham, "Accuracy and Stability of Numerical Algorithms", algorithm
    /// 15.1).
    ///
    /// The method also solves systems with the transposed matrix. The matrix of a fit is symmetric,
    /// or nearly so where cells have several points, and is used instead: the estimate remains a
    /// lower bound.
    pub(super) fn condition(&self) -> Result<f64, SingularMatrix> {
        let n = self.matrix.nrows();
        let mut x = DVector::from_element(n, 1.0 / n as f64);
        let mut estimate = 0.0;
        for _ in 0..ESTIMATOR_STEPS {
            self.solve(&mut x)?;
            let norm = x.lp_norm(1);
            if norm <= estimate {
                break;
            }
            estimate = norm;
            let mut slope = x.map(f64::signum);
            self.solve(&mut slope)?;
            x.fill(0.0);
            x[slope.icamax()] = 1.0;
        }
        Ok(self.norm * estimate)
    }
}

/// Updates the columns `open`, of `n` rows each, by the panel that begins at column `first`: to L⁻¹
/// A in the rows of the panel, and to A − L U below.
fn update(panel: &[f64], first: usize, open: &mut [f64], n: usize) {
    let below = first + PANEL;
    let mut columns = DMatrixViewMut::from_slice(open, n, open.len() / n);
    let mut top = columns.rows_range_mut(first..below);
    let lower = DMatrixView::from_slice(panel, n, PANEL);
    lower.rows_range(first..below).solve_lower_triangular_with_diag_mut(&mut top, 1.0);
    for start in (below..n).step_by(ROWS) {
        let rows = start..(start + ROWS).min(n);
        for column in open.chunks_exact_mut(n) {
            let (above, target) = column[first..rows.end].split_at_mut(rows.start - first);
            for (factors, columns) in above[..PANEL].as_chunks().0.iter().zip(panel.chunks_exact(4 * n)) {
                subtract(target, [0, 1, 2, 3].map(|k| &columns[k * n..][rows.clone()]), factors);
            }
        }
    }
}

/// Subtracts four columns from `target`, each times its factor.
fn subtract(target: &mut [f64], [a, b, c, d]: [&[f64]; 4], [p, q, r, s]: &[f64; 4]) {
    let columns = a.iter().zip(b).zip(c.iter().zip(d));
    for (x, ((a, b), (c, d))) in target.iter_mut().zip(columns) {
        *x -= (a * p + b * q) + (c * r + d * s);
    }
}

#[cfg(test)]
mod tests {
    use super::{Decomposition, PANEL, SingularMatrix};
    use crate::slices::complete;
    use nalgebra::{DMatrix, DVector};
    use rand_core::Rng;
    use rand_pcg::Pcg64Mcg;

    fn symmetric(n: usize, seed: u128) -> DMatrix<f64> {
        let mut random = Pcg64Mcg::new(seed);
        let entries = DMatrix::from_fn(n, n, |_, _| f64::from(random.next_u32()) / f64::from(u32::MAX) - 0.5);
        &entries + entries.transpose()
    }

    fn decomposed(matrix: &DMatrix<f64>) -> Result<Decomposition, SingularMatrix> {
        complete(Decomposition::new(matrix.clone(), |_| {}))
    }

    #[test]
    fn systems_of_every_size_are_solved_and_their_condition_estimated() {
        for n in [1, 2, 5, PANEL - 1, PANEL, PANEL + 1, 2 * PANEL, 3 * PANEL + 7, 300] {
            let matrix = symmetric(n, n as u128);
            let wanted = DVector::from_fn(n, |i, _| 1.0 + i as f64);
            let mut x = &matrix * &wanted;
            let decomposition = decomposed(&matrix).expect("a random matrix is not singular");
            decomposition.solve(&mut x).expect("a solution");
            let inverse = matrix.clone().try_inverse().expect("an inverse");
            let norm = |m: &DMatrix<f64>| m.column_iter().map(|c| c.lp_norm(1)).fold(0.0, f64::max);
            let condition = norm(&matrix) * norm(&inverse);
            let off = (&x - &wanted).amax() / wanted.amax();
            assert!(off < 1e-13 * condition, "{n}: {off} at condition {condition}");
            let estimate = decomposition.condition().expect("an estimate");
            assert!(
                estimate <= condition * 1.000_001 && estimate > condition / 3.0,
                "{n}: {estimate} {condition}"
            );
        }
    }

    #[test]
    fn a_singular_system_is_told() {
        let mut matrix = symmetric(50, 3);
        matrix.row_mut(40).fill(0.0);
        matrix.column_mut(40).fill(0.0);
        assert!(decomposed(&matrix).is_err());
        matrix[(40, 40)] = f64::NAN;
        assert!(decomposed(&matrix).is_err());
    }
}
