//! Interface quasi-Newton methods and Anderson mixing.
//! With the secant columns ΔR, ΔX̃ of earlier iterations, the next iterate is
//!
//! x ↦ x̃ + ΔX̃c, r + ΔRc ≈ 0.
//!
//! - `iqn-ils`: c minimises ‖r + ΔRc‖ over the columns of this window and of `reuse_windows` before
//!   (Degroote, Bathe & Vierendeels, *Comput. Struct.* 87 (2009)).
//! - `iqn-imvj`: each window's columns correct the inverse Jacobian of the window before
//!   ([`super::least_squares`]).
//! - `anderson`: c as in `iqn-ils`, over this window alone; what the columns cannot explain enters
//!   by the factor β = `relaxation` (Walker & Ni, *SIAM J. Numer. Anal.* 49 (2011)): with β = 1 it is
//!   `iqn-ils` without reuse.
//!
//! The first iteration of a window uses the columns of earlier windows, if there are any, and a
//! relaxation by `relaxation` if there are none. The last iteration of a window, which is not
//! followed by another one, gives a column too.

use super::accelerator::Accelerator;
use super::accelerator::PATIENCE;
use super::accelerator::StepTaken;
use super::columns::SecantColumns;
use super::least_squares::LeastSquares;
use super::relaxation::relax;
use super::weights::Weights;
use crate::part::Part;
use crate::settings::{Acceleration, Implicit};
use crate::state::{Reader, StateMismatch};

/// How the columns are used.
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
    /// Returns the rule of an acceleration that keeps secant columns; `None` for one that keeps none.
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

/// An accelerator that learns how the participants answer.
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
}

impl QuasiNewton {
    /// With the settings of a case, for these fields. All memory is taken here.
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
        }
    }

    /// Finds the coefficients and drops what holds nothing new; the number of columns dropped.
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
    fn name(&self) -> &'static str {
        match self.rule {
            Rule::Anderson => "anderson",
            Rule::LeastSquares => "iqn-ils",
            Rule::MultiVector => "iqn-imvj",
        }
    }

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

    fn next(&mut self, sent: &mut [f64], returned: &[f64]) -> StepTaken {
        self.columns.learn(sent, returned, self.window);
        let (residual, values) = self.columns.squares();
        self.weights.update(residual, values);
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
        StepTaken { relaxation, columns: Some(columns), dropped }
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

    fn restore(&mut self, from: &mut Reader<'_>) -> Result<(), StateMismatch> {
        self.window = from.u64()?;
        self.columns.restore(from)
    }
}
