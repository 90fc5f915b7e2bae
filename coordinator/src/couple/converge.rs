//! When a window is done.

/// What a convergence measure decides after an iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// The window is done; the residual, if there is anything to measure.
    Done {
        /// Residual of the last iteration.
        residual: Option<f64>,
    },
    /// Another iteration.
    Continue,
}

/// Measures the distance between what went into an iteration and what came out.
pub trait Convergence {
    /// Judges iteration `iteration` (from 1) of the current window.
    fn judge(&mut self, iteration: u32, sent: &[f64], returned: &[f64]) -> Verdict;
}

/// An explicit scheme is done after one pass, whatever came out.
#[derive(Clone, Copy, Debug, Default)]
pub struct OnePass;

impl Convergence for OnePass {
    fn judge(&mut self, _iteration: u32, _sent: &[f64], _returned: &[f64]) -> Verdict {
        Verdict::Done { residual: None }
    }
}
