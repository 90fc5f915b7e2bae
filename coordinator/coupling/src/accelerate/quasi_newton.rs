//! Interface quasi-Newton methods and Anderson mixing. With the secant columns ΔR, ΔX̃ of earlier
//! iterations, the next iterate is
//!
//! x ↦ x̃ + ΔX̃c, r + ΔRc ≈ 0.
//!
//! - `iqn-ils`: c minimises ‖r + ΔRc‖ over the columns of this window and of the `reuse_windows`
//!   windows before (Degroote, Bathe & Vierendeels, *Comput. Struct.* 87 (2009)).
//! - `iqn-imvj`: each window's columns correct the inverse Jacobian of the window before
//!   ([`super::least_squares`]).
//! - `anderson`: c as in `iqn-ils`, over this window alone. The part of the residual that the
//!   columns cannot explain enters with the factor β = `relaxation` (Walker & Ni, *SIAM J. Numer.
//!   Anal.* 49 (2011)). With β = 1 the method is `iqn-ils` without reuse.
//!
//! The first iteration of a window uses the columns of earlier windows. Without such columns the
//! step is a relaxation by `relaxation`. The last iteration of a window also gives a column.
//!
//! Columns of earlier windows describe the problem as it was. If the step that they give in the
//! first iteration of a window increases the weighted residual, they are removed (our addition):
//! friction that changes, or a mesh that moves, has made them wrong.

use super::accelerator::AccelerationStats;
use super::accelerator::Accelerator;
use super::accelerator::PATIENCE;
use super::accelerator::relax;
use super::columns::SecantColumns;
use super::least_squares::LeastSquares;
use super::weights::Weights;
use crate::settings::{Acceleration, Implicit};
use crate::vector::Part;
use crate::vector::{StateMismatch, StateReader};

/// Rule that turns secant columns into the next iterate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// `anderson`.
    Anderson,
    /// `iqn-ils`.
    LeastSquares,
    /// `iqn-imvj`.
    MultiVector,
}

impl Rule {
    /// Returns the rule of an acceleration that keeps secant columns; `None` for one that keeps
    /// none.
    #[must_use]
    pub fn of(acceleration: Acceleration) -> Option<Self> {
        match acceleration {
            Acceleration::Anderson => Some(Self::Anderson),
            Acceleration::Auto | Acceleration::IqnIls => Some(Self::LeastSquares),
            Acceleration::IqnImvj => Some(Self::MultiVector),
            Acceleration::None | Acceleration::Constant | Acceleration::Aitken => None,
        }
    }
}

/// Accelerator that approximates the inverse Jacobian from secant columns.
#[derive(Clone, Debug)]
pub struct QuasiNewton {
    rule: Rule,
    relaxation: f64,
    mixing: f64,
    reuse_windows: u64,
    columns: SecantColumns,
    least_squares: LeastSquares,
    weights: Weights,
    /// Windows accepted so far.
    window: u64,
    /// Squares of the residual in the first iteration of the window; empty in later ones.
    first: Vec<f64>,
}

impl QuasiNewton {
    /// Creates the accelerator for these fields. Allocates all memory.
    #[must_use]
    pub fn new(rule: Rule, settings: &Implicit, parts: &[Part]) -> Self {
        let columns = SecantColumns::new(parts, settings.max_columns, settings.threads);
        let anderson = rule == Rule::Anderson;
        Self {
            rule,
            relaxation: settings.relaxation,
            mixing: if anderson { settings.relaxation } else { 1.0 },
            reuse_windows: if anderson { 0 } else { settings.reuse_windows },
            least_squares: LeastSquares::new(columns.capacity(), settings.filter),
            weights: Weights::new(settings.preconditioner, parts.len()),
            columns,
            window: 0,
            first: Vec::with_capacity(parts.len()),
        }
    }

    /// Removes the columns of earlier windows if their first step has increased the residual.
    fn judge_reuse(&mut self, starts: bool) {
        let Self { columns, weights, first, window, .. } = self;
        let residual = columns.squares().0;
        if starts {
            first.clear();
            first.extend_from_slice(residual);
            return;
        }
        let norm = |squares: &[f64]| -> f64 {
            squares.iter().zip(weights.squares()).map(|(square, weight)| square * weight).sum()
        };
        if !first.is_empty() && norm(residual) > norm(first) {
            columns.retain(|_, of| of == *window);
        }
        first.clear();
    }

    /// Computes the coefficients, drops linearly dependent columns and returns the number of
    /// dropped columns.
    fn solve(&mut self) -> usize {
        let Self { columns, least_squares, weights, .. } = self;
        match self.rule {
            Rule::MultiVector => least_squares.solve_windows(columns, weights.squares()),
            Rule::Anderson | Rule::LeastSquares => {
                least_squares.solve(columns, weights.squares());
            }
        }
        columns.count() - (0..columns.count()).filter(|&age| least_squares.holds(age)).count()
    }
}

impl Accelerator for QuasiNewton {
    fn patience(&self) -> u32 {
        let columns = u32::try_from(self.columns.capacity()).unwrap_or(u32::MAX);
        columns.saturating_mul(2).max(PATIENCE)
    }

    fn advice(&self) -> &'static str {
        "raise coupling.max_columns"
    }

    fn begin_window(&mut self) {
        let window = self.window;
        self.columns.retain(|_, of| of != window);
        self.columns.interrupt();
        self.weights.begin_window();
    }

    fn next(&mut self, sent: &mut [f64], returned: &[f64]) -> AccelerationStats {
        let starts = !self.columns.continues();
        self.columns.learn(sent, returned, self.window);
        let (residual, values) = self.columns.squares();
        self.weights.update(residual, values);
        self.judge_reuse(starts);
        let dropped = self.solve();
        let columns = self.columns.count() - dropped;
        let relaxation = (columns == 0).then_some(self.relaxation);
        if relaxation.is_some() {
            relax(self.relaxation, sent, returned);
        } else {
            self.columns.combine(self.least_squares.coefficients(), self.mixing, sent);
        }
        if dropped > 0 {
            self.columns.retain(|age, _| self.least_squares.holds(age));
        }
        AccelerationStats { relaxation, columns: Some(columns), dropped }
    }

    fn accept_window(&mut self, sent: &[f64], returned: &[f64]) {
        let (window, reuse) = (self.window + 1, self.reuse_windows);
        self.columns.retain(|_, of| of + reuse >= window);
        if reuse > 0 {
            self.columns.learn_last(sent, returned, self.window);
        }
        self.columns.interrupt();
        self.window = window;
    }

    fn save(&mut self, into: &mut Vec<u8>) {
        into.extend(self.window.to_le_bytes());
        self.columns.save(into);
    }

    fn restore(&mut self, from: &mut StateReader<'_>) -> Result<(), StateMismatch> {
        self.window = from.u64()?;
        self.columns.restore(from)
    }
}
