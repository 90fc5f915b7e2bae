//! Least squares over the secant columns, from their Gram matrix.
//!
//! The coefficients c minimise ‖r + ΔRc‖. With D the diagonal of the columns' norms, LLᵀ is the
//! Cholesky factorisation of D⁻¹ΔRᵀΔRD⁻¹, columns from the newest to the oldest. L is therefore the
//! transpose of the R of a QR factorisation of the scaled columns, and c = −D⁻¹L⁻ᵀL⁻¹D⁻¹ΔRᵀr. A
//! diagonal entry of L is the part of its column that is orthogonal to the newer ones. A column
//! with an entry below `filter` is dropped, the oldest therefore first. This is the filter QR2 of
//! Haelterman, Bogaers, Scheufele, Uekermann & Mehl, *Comput. Struct.* 171 (2016), without the QR.
//! The matrix holds the orthogonal part squared, so `filter` cannot be below 10⁻⁷, and the residual
//! of the minimum is exact to about 10⁻¹⁶/`filter` of ‖r‖.
//!
//! The multi-vector rule takes the columns of each window separately, the newest window first. Each
//! window explains what the newer ones have left. With V_w, W_w the columns of a window and J₀ = 0,
//! the inverse Jacobian J_w = J_{w−1} + (W_w − J_{w−1}V_w)(V_wᵀV_w)⁻¹V_wᵀ, applied to a residual,
//! is J_w r = W_w a + J_{w−1}(r − V_w a) with a = (V_wᵀV_w)⁻¹V_wᵀr. No Jacobian is stored.
//! Discarded windows have no influence: J begins after them. Source: Lindner, Mehl, Scheufele &
//! Uekermann, *A comparison of various quasi-Newton schemes for partitioned FSI* (2015).

use super::columns::SecantColumns;
use super::kernels;
use crate::vector::dot;
use std::ops::Range;

/// Working memory, and the last solution.
#[derive(Clone, Debug)]
pub(super) struct LeastSquares {
    filter: f64,
    capacity: usize,
    /// Lᵀ, one row for every column, followed by the entry of −L⁻¹D⁻¹ΔRᵀr. Rows of dropped columns
    /// are unused.
    factor: Vec<f64>,
    /// D⁻¹; 0 for a column without a norm.
    scales: Vec<f64>,
    /// Rows of the columns that were kept.
    kept: Vec<usize>,
    /// Scratch buffer: the entries of the rows above in one column.
    above: Vec<f64>,
    solution: Vec<f64>,
    coefficients: Vec<f64>,
    holds: Vec<bool>,
}

impl LeastSquares {
    pub(super) fn new(capacity: usize, filter: f64) -> Self {
        Self {
            filter,
            capacity,
            factor: vec![0.0; capacity * (capacity + 1)],
            scales: vec![0.0; capacity],
            kept: Vec::with_capacity(capacity),
            above: Vec::with_capacity(capacity),
            solution: vec![0.0; capacity],
            coefficients: vec![0.0; capacity],
            holds: vec![false; capacity],
        }
    }

    /// Returns the coefficients by age; 0 for a dropped column.
    pub(super) fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }

    /// Returns whether the column of this age was kept.
    pub(super) fn holds(&self, age: usize) -> bool {
        self.holds[age]
    }

    /// Minimises over all columns at once.
    pub(super) fn solve(&mut self, columns: &SecantColumns, weights: &[f64]) {
        self.begin(columns.count());
        self.solve_block(columns, weights, 0..columns.count());
    }

    /// Minimises window by window, from the newest to the oldest.
    pub(super) fn solve_windows(&mut self, columns: &SecantColumns, weights: &[f64]) {
        let count = columns.count();
        self.begin(count);
        let mut start = 0;
        while start < count {
            let window = columns.window(start);
            let end = (start..count).find(|&age| columns.window(age) != window).unwrap_or(count);
            self.solve_block(columns, weights, start..end);
            start = end;
        }
    }

    fn begin(&mut self, count: usize) {
        self.coefficients.resize(count, 0.0);
        self.coefficients.fill(0.0);
        self.holds.resize(count, false);
        self.holds.fill(false);
    }

    /// Solves for the columns of a range of ages. Coefficients of newer columns are already known.
    fn solve_block(&mut self, columns: &SecantColumns, weights: &[f64], ages: Range<usize>) {
        let (first, count) = (ages.start, ages.len());
        self.kept.clear();
        for (scale, age) in self.scales.iter_mut().zip(ages) {
            let norm = columns.inner(age, age, weights).sqrt();
            *scale = if norm.is_finite() && norm > 0.0 { norm.recip() } else { 0.0 };
        }
        for row in 0..count {
            self.fill(columns, weights, first, row, count);
            self.eliminate(row, count);
            self.holds[first + row] = self.kept.last() == Some(&row);
        }
        self.solution[..count].fill(0.0);
        for &row in self.kept.iter().rev() {
            let factor = &self.factor[row * (self.capacity + 1)..][row..=count];
            let (pivot, right) = (factor[0], factor[count - row]);
            let known = dot(&factor[1..count - row], &self.solution[row + 1..count]);
            self.solution[row] = (right - known) / pivot;
            self.coefficients[first + row] = self.solution[row] * self.scales[row];
        }
    }

    /// Fills a row of the scaled Gram matrix, from the diagonal on, and its right-hand side.
    fn fill(
        &mut self,
        columns: &SecantColumns,
        weights: &[f64],
        first: usize,
        row: usize,
        count: usize,
    ) {
        let (age, scale) = (first + row, self.scales[row]);
        let explained = |other| self.coefficients[other] * columns.inner(age, other, weights);
        let rest = columns.product(age, weights) + (0..first).map(explained).sum::<f64>();
        let factor = &mut self.factor[row * (self.capacity + 1)..][..=count];
        for (other, entry) in factor[..count].iter_mut().enumerate().skip(row) {
            let scales = scale * self.scales[other];
            // A column without a norm may hold NaN.
            let inner = || columns.inner(age, first + other, weights) * scales;
            *entry = if scales == 0.0 { 0.0 } else { inner() };
        }
        factor[count] = -rest * scale;
    }

    /// Subtracts the projections of the rows above, and keeps the row if enough of it is left.
    fn eliminate(&mut self, row: usize, count: usize) {
        let width = self.capacity + 1;
        let (done, new) = self.factor.split_at_mut(row * width);
        let new = &mut new[row..=count];
        self.above.clear();
        self.above.extend(self.kept.iter().map(|other| done[other * width + row]));
        let held = |other: usize| &done[other * width..][row..=count];
        kernels::combine(new, &self.kept, &self.above, -1.0, held);
        // The diagonal of the scaled matrix is 1.
        let square = new[0];
        if self.scales[row] > 0.0 && square > self.filter * self.filter {
            let pivot = square.sqrt();
            new[0] = pivot;
            new[1..].iter_mut().for_each(|entry| *entry /= pivot);
            self.kept.push(row);
        }
    }
}
