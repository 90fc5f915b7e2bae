//! Least squares over the secant columns, from their Gram matrix.
//!
//! Wanted is the c that minimises ‖r + ΔRc‖. With D the diagonal of the columns' norms, LLᵀ is the
//! Cholesky factorisation of D⁻¹ΔRᵀΔRD⁻¹, columns from the newest to the oldest, so that L is the
//! transpose of the R that a QR factorisation of the scaled columns would give, and
//! c = −D⁻¹L⁻ᵀL⁻¹D⁻¹ΔRᵀr. A diagonal entry of L is the part of its column that the newer ones do
//! not hold; a column where it is below `filter` is dropped, the oldest therefore first. This is
//! the filter QR2 of Haelterman, Bogaers, Scheufele, Uekermann & Mehl, *Comput. Struct.* 171 (2016),
//! without the QR: the new part stands in the matrix squared, so that `filter` cannot be below
//! 10⁻⁷, and the residual of the minimum is exact to about 10⁻¹⁶/`filter` of ‖r‖.
//!
//! The multi-vector rule takes the columns of each window by themselves, the newest first, and
//! lets each explain what the newer ones have left: with V_w, W_w the columns of a window and J₀ = 0
//! the inverse Jacobian J_w = J_{w−1} + (W_w − J_{w−1}V_w)(V_wᵀV_w)⁻¹V_wᵀ, applied to a residual, is
//! J_w r = W_w a + J_{w−1}(r − V_w a) with a = (V_wᵀV_w)⁻¹V_wᵀr. No Jacobian is ever stored, and
//! windows that are forgotten leave no trace: J begins after them. Source: Lindner, Mehl, Scheufele
//! & Uekermann, *A comparison of various quasi-Newton schemes for partitioned FSI* (2015).

use super::columns::SecantColumns;
use crate::part::dot;
use std::ops::Range;

/// Working memory, and the last solution.
#[derive(Clone, Debug)]
pub(super) struct LeastSquares {
    filter: f64,
    capacity: usize,
    /// Lower triangle, a row for every column that was kept.
    factor: Vec<f64>,
    /// D of the columns that were kept.
    norms: Vec<f64>,
    /// Ages of the columns that were kept.
    kept: Vec<usize>,
    solution: Vec<f64>,
    coefficients: Vec<f64>,
    holds: Vec<bool>,
}

impl LeastSquares {
    pub(super) fn new(capacity: usize, filter: f64) -> Self {
        Self {
            filter,
            capacity,
            factor: vec![0.0; capacity * capacity],
            norms: vec![0.0; capacity],
            kept: Vec::with_capacity(capacity),
            solution: vec![0.0; capacity],
            coefficients: vec![0.0; capacity],
            holds: vec![false; capacity],
        }
    }

    /// The coefficients by age; those of columns that are dropped are 0.
    pub(super) fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }

    /// The column of this age was kept.
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

    /// Solves for the columns of some ages; those of newer ones have their coefficients.
    fn solve_block(&mut self, columns: &SecantColumns, weights: &[f64], ages: Range<usize>) {
        let newer = ages.start;
        self.kept.clear();
        for age in ages {
            self.append(columns, weights, age);
        }
        let count = self.kept.len();
        for row in 0..count {
            let age = self.kept[row];
            let explained = |other| self.coefficients[other] * columns.inner(age, other, weights);
            let rest = columns.product(age, weights) + (0..newer).map(explained).sum::<f64>();
            let right = -rest / self.norms[row];
            let known = dot(self.row(row), &self.solution[..row]);
            self.solution[row] = (right - known) / self.pivot(row);
        }
        for row in (0..count).rev() {
            let value = self.solution[row] / self.pivot(row);
            self.coefficients[self.kept[row]] = value / self.norms[row];
            let factor = &self.factor[row * self.capacity..][..row];
            for (solution, entry) in self.solution.iter_mut().zip(factor) {
                *solution -= entry * value;
            }
        }
    }

    /// Appends a column to the factorisation, if enough of it is new.
    fn append(&mut self, columns: &SecantColumns, weights: &[f64], age: usize) {
        let norm = columns.inner(age, age, weights).sqrt();
        if !(norm > 0.0 && norm.is_finite()) {
            return;
        }
        let count = self.kept.len();
        let (done, new) = self.factor.split_at_mut(count * self.capacity);
        let mut square = 1.0;
        for (row, &other) in self.kept.iter().enumerate() {
            let factor = &done[row * self.capacity..][..=row];
            let cosine = columns.inner(age, other, weights) / (norm * self.norms[row]);
            new[row] = (cosine - dot(&factor[..row], &new[..row])) / factor[row];
            square -= new[row] * new[row];
        }
        if square > self.filter * self.filter {
            new[count] = square.sqrt();
            self.norms[count] = norm;
            self.kept.push(age);
            self.holds[age] = true;
        }
    }

    /// What stands left of the diagonal.
    fn row(&self, row: usize) -> &[f64] {
        &self.factor[row * self.capacity..][..row]
    }

    fn pivot(&self, row: usize) -> f64 {
        self.factor[row * self.capacity + row]
    }
}
