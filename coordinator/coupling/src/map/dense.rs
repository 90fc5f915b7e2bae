//! Dense linear systems, factorised and solved in blocks of columns.
//!
//! P A = L U with partial pivoting. Beyond the diagonal blocks all work is products of matrices,
//! which keep to the caches: for two thousand unknowns this is several times as fast as a column at
//! a time. Source: G. H. Golub, C. F. Van Loan, *Matrix Computations*, 4th ed. (2013), section
//! 3.2.11.

use nalgebra::DMatrix;
use std::ops::Range;

/// Number of columns in a block.
const BLOCK: usize = 64;

/// A factorised matrix: L below the diagonal, whose own diagonal is one, and U.
pub(super) struct Factorised {
    factors: DMatrix<f64>,
    /// Row that is exchanged with each row, in ascending order of rows.
    pivots: Vec<usize>,
}

/// Returns the ranges of all blocks.
fn blocks(size: usize) -> impl DoubleEndedIterator<Item = Range<usize>> {
    (0..size.div_ceil(BLOCK)).map(move |n| n * BLOCK..((n + 1) * BLOCK).min(size))
}

impl Factorised {
    /// Factorises a square matrix.
    pub(super) fn new(matrix: DMatrix<f64>) -> Self {
        let size = matrix.nrows();
        let mut factorised = Self { factors: matrix, pivots: Vec::with_capacity(size) };
        for block in blocks(size) {
            factorised.eliminate(block.clone());
            let (factors, rest) = (&mut factorised.factors, block.end..size);
            let lower = factors.view_range(block.clone(), block.clone()).into_owned();
            let mut upper = factors.view_range(block.clone(), rest.clone()).into_owned();
            lower.solve_lower_triangular_with_diag_mut(&mut upper, 1.0);
            factors.view_range_mut(block.clone(), rest.clone()).copy_from(&upper);
            let left = factors.view_range(rest.clone(), block).into_owned();
            factors.view_range_mut(rest.clone(), rest).gemm(-1.0, &left, &upper, 1.0);
        }
        factorised
    }

    /// Eliminates the columns of a block below the diagonal, and updates the block alone.
    fn eliminate(&mut self, block: Range<usize>) {
        let factors = &mut self.factors;
        for column in block.clone() {
            let below = factors.view_range(column.., column..=column);
            let pivot = column + below.column(0).icamax();
            self.pivots.push(pivot);
            factors.swap_rows(column, pivot);
            let (mut own, mut others) =
                factors.columns_range_pair_mut(column..column + 1, column + 1..block.end);
            let diagonal = own[column];
            let mut multipliers = own.rows_range_mut(column + 1..);
            if diagonal != 0.0 {
                multipliers /= diagonal;
            }
            for mut other in others.column_iter_mut() {
                let top = other[column];
                other.rows_range_mut(column + 1..).axpy(-top, &multipliers.column(0), 1.0);
            }
        }
    }

    /// Replaces right-hand sides by their solutions; NaN if the matrix is singular.
    pub(super) fn solve(&self, sides: &mut DMatrix<f64>) {
        let size = self.pivots.len();
        for (row, pivot) in self.pivots.iter().enumerate() {
            sides.swap_rows(row, *pivot);
        }
        let mut regular = true;
        let mut step = |block: Range<usize>, others: Range<usize>, is_lower: bool| {
            let own = self.factors.view_range(block.clone(), block.clone());
            let mut solved = sides.rows_range(block.clone()).into_owned();
            if is_lower {
                own.solve_lower_triangular_with_diag_mut(&mut solved, 1.0);
            } else {
                regular &= own.solve_upper_triangular_mut(&mut solved);
            }
            sides.rows_range_mut(block.clone()).copy_from(&solved);
            let coefficients = self.factors.view_range(others.clone(), block);
            sides.rows_range_mut(others).gemm(-1.0, &coefficients, &solved, 1.0);
        };
        blocks(size).for_each(|block| step(block.clone(), block.end..size, true));
        blocks(size).rev().for_each(|block| step(block.clone(), 0..block.start, false));
        if !regular {
            sides.fill(f64::NAN);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{BLOCK, Factorised};
    use nalgebra::DMatrix;

    /// Matrix without order or dominant diagonal; every pivot is elsewhere.
    fn matrix(rows: usize, columns: usize) -> DMatrix<f64> {
        DMatrix::from_fn(rows, columns, |m, n| ((1 + m * 37 + n * 101 + m * n * 13) as f64).sin())
    }

    /// Sizes around a block. Tolerance: rounding, times the condition number.
    #[test]
    fn solutions_solve() {
        for size in [1, 2, BLOCK - 1, BLOCK, BLOCK + 1, 3 * BLOCK + 5] {
            let (system, expected) = (matrix(size, size), matrix(size, 7));
            let mut sides = &system * &expected;
            Factorised::new(system).solve(&mut sides);
            let error = (sides - expected).amax();
            assert!(error < 1e-9, "{size}: {error:e}");
        }
    }

    #[test]
    fn a_singular_system_has_no_solution() {
        let mut system = matrix(BLOCK + 9, BLOCK + 9);
        system.column_mut(BLOCK + 3).fill(0.0);
        let mut sides = matrix(BLOCK + 9, 2);
        Factorised::new(system).solve(&mut sides);
        assert!(sides.iter().all(|value| value.is_nan()));
    }
}
