//! Solver of a large symmetric system: blocked LU decomposition with partial pivoting, in steps.
//!
//! nalgebra factorises the panels and solves the triangular systems. The update of the columns to the right of a panel,
//! which takes nearly all of the time, is written out here. Neither uses a fused multiply-add, so the solution has the
//! same bits natively and in WebAssembly.

use nalgebra::{DMatrix, DVector};

/// Columns per panel: enough to read a panel seldom, few enough to keep its rows in the cache.
const PANEL: usize = 32;
/// Rows updated together: 64 kB of a panel, which stay in a second-level cache for all the columns they update.
const ROWS: usize = 256;
/// Maximum number of steps of Hager's estimator, which nearly always ends after two or three.
const ESTIMATOR_STEPS: usize = 5;

/// LU decomposition in progress.
#[derive(Clone, Debug)]
pub(super) struct Elimination {
    /// Remaining matrix, in which the factors L and U replace the eliminated part.
    matrix: DMatrix<f64>,
    /// Rows exchanged in each step.
    exchanges: Vec<(usize, usize)>,
    /// ‖A‖₁.
    norm: f64,
    /// First column of the current panel.
    panel: usize,
    /// First column that the panel has not yet updated, or `panel` until the panel is factorised.
    next: usize,
}

/// Error: a pivot is zero or not finite, so the matrix is singular.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Singular;

impl Elimination {
    /// Begins the decomposition of a symmetric matrix.
    pub(super) fn new(matrix: DMatrix<f64>) -> Self {
        let norm = matrix.column_iter().map(|column| column.lp_norm(1)).fold(0.0, f64::max);
        Self { matrix, exchanges: Vec::new(), norm, panel: 0, next: 0 }
    }

    /// Fraction of the work done, from 0 to 1.
    pub(super) fn fraction(&self) -> f64 {
        let n = self.matrix.nrows().max(1) as f64;
        let left = |done: usize| (n - done as f64).max(0.0) / n;
        let open = |done: usize| left(done).powi(3);
        let share = (left(self.panel) - left(self.next)) / left(self.panel).max(f64::MIN_POSITIVE);
        1.0 - open(self.panel) + share * (open(self.panel) - open(self.panel + PANEL))
    }

    /// Factorises the next panel, or updates the next [`PANEL`] columns by the current one; either takes at most 32²
    /// multiplications per row. Returns whether the decomposition is complete.
    pub(super) fn step(&mut self) -> Result<bool, Singular> {
        let n = self.matrix.nrows();
        if self.panel < n {
            if self.next == self.panel {
                self.factorise()?;
            } else {
                self.update();
            }
            self.next = (self.next + PANEL).min(n);
            if self.next == n {
                self.panel = (self.panel + PANEL).min(n);
                self.next = self.panel;
            }
        }
        Ok(self.panel == n)
    }

    /// Factorises the panel and exchanges whole rows to bring the pivots to the diagonal.
    fn factorise(&mut self) -> Result<(), Singular> {
        let (n, first) = (self.matrix.nrows(), self.panel);
        let end = (first + PANEL).min(n);
        for k in first..end {
            let pivot = k + self.matrix.column(k).rows_range(k..).icamax();
            self.matrix.swap_rows(k, pivot);
            self.exchanges.push((k, pivot));
            let diagonal = self.matrix[(k, k)];
            if !(diagonal.abs() > 0.0 && diagonal.is_finite()) {
                return Err(Singular);
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

    /// Updates the next columns by the panel: to L⁻¹ A in its rows, to A − L U below.
    fn update(&mut self) {
        let (n, first, next) = (self.matrix.nrows(), self.panel, self.next);
        let (below, width) = (first + PANEL, PANEL.min(n - next));
        let (panel, mut open) = self.matrix.columns_range_pair_mut(first..below, next..next + width);
        let mut top = open.view_mut((first, 0), (PANEL, width));
        panel.view((first, 0), (PANEL, PANEL)).solve_lower_triangular_with_diag_mut(&mut top, 1.0);

        let (eliminated, open) = self.matrix.as_mut_slice().split_at_mut(next * n);
        let panel = &eliminated[first * n..below * n];
        for start in (below..n).step_by(ROWS) {
            let rows = start..(start + ROWS).min(n);
            for column in open[..width * n].chunks_exact_mut(n) {
                let (above, target) = column[first..rows.end].split_at_mut(rows.start - first);
                for (factors, columns) in above[..PANEL].as_chunks().0.iter().zip(panel.chunks_exact(4 * n)) {
                    subtract(target, [0, 1, 2, 3].map(|k| &columns[k * n..][rows.clone()]), factors);
                }
            }
        }
    }

    /// Solves A x = `right` in place, once the decomposition is complete.
    pub(super) fn solve(&self, right: &mut DVector<f64>) -> Result<(), Singular> {
        for &(k, pivot) in &self.exchanges {
            right.swap_rows(k, pivot);
        }
        let lower = self.matrix.solve_lower_triangular_with_diag_mut(right, 1.0);
        let upper = self.matrix.solve_upper_triangular_mut(right);
        if lower && upper && right.iter().all(|x| x.is_finite()) { Ok(()) } else { Err(Singular) }
    }

    /// Lower estimate of the condition number ‖A‖₁ ‖A⁻¹‖₁, seldom too small by more than a factor of three (Hager 1984;
    /// Higham, "Accuracy and Stability of Numerical Algorithms", algorithm 15.1).
    ///
    /// The matrix is symmetric, so systems with its transpose need no solver of their own.
    pub(super) fn condition(&self) -> Result<f64, Singular> {
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

/// Subtracts four columns from `target`, each times its factor.
fn subtract(target: &mut [f64], [a, b, c, d]: [&[f64]; 4], [p, q, r, s]: &[f64; 4]) {
    let columns = a.iter().zip(b).zip(c.iter().zip(d));
    for (x, ((a, b), (c, d))) in target.iter_mut().zip(columns) {
        *x -= (a * p + b * q) + (c * r + d * s);
    }
}

#[cfg(test)]
mod tests {
    use super::{Elimination, PANEL, Singular};
    use nalgebra::{DMatrix, DVector};
    use rand_core::Rng;
    use rand_pcg::Pcg64Mcg;

    fn symmetric(n: usize, seed: u128) -> DMatrix<f64> {
        let mut random = Pcg64Mcg::new(seed);
        let entries = DMatrix::from_fn(n, n, |_, _| f64::from(random.next_u32()) / f64::from(u32::MAX) - 0.5);
        &entries + entries.transpose()
    }

    fn eliminated(matrix: &DMatrix<f64>) -> Result<Elimination, Singular> {
        let mut elimination = Elimination::new(matrix.clone());
        while !elimination.step()? {}
        Ok(elimination)
    }

    #[test]
    fn systems_of_every_size_are_solved_and_their_condition_estimated() {
        for n in [1, 2, 5, PANEL - 1, PANEL, PANEL + 1, 2 * PANEL, 3 * PANEL + 7, 300] {
            let matrix = symmetric(n, n as u128);
            let wanted = DVector::from_fn(n, |i, _| 1.0 + i as f64);
            let mut x = &matrix * &wanted;
            let elimination = eliminated(&matrix).expect("a random matrix is not singular");
            elimination.solve(&mut x).expect("a solution");
            let inverse = matrix.clone().try_inverse().expect("an inverse");
            let norm = |m: &DMatrix<f64>| m.column_iter().map(|c| c.lp_norm(1)).fold(0.0, f64::max);
            let condition = norm(&matrix) * norm(&inverse);
            let off = (&x - &wanted).amax() / wanted.amax();
            assert!(off < 1e-13 * condition, "{n}: {off} at condition {condition}");
            let estimate = elimination.condition().expect("an estimate");
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
        assert!(eliminated(&matrix).is_err());
        matrix[(40, 40)] = f64::NAN;
        assert!(eliminated(&matrix).is_err());
    }
}
