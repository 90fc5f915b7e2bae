//! A solve: its window and iteration, and the model's report.

/// One iteration of one window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Number of the window, from 0.
    pub window: u64,
    /// Iteration within the window, from 1; 0 marks the first outputs before any solve.
    pub iteration: u32,
    /// Start of the window [s].
    pub start: f64,
    /// End of the window [s]; equal to `start` in a steady case.
    pub end: f64,
}

impl Step {
    /// The single window of a steady case.
    pub const STEADY: Step = Step { window: 0, iteration: 1, start: 0.0, end: 0.0 };

    /// Length of the window [s].
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.end - self.start
    }
}

/// Report of a solve, besides its outputs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepReport {
    /// Number of steps inside the window.
    pub substeps: u32,
    /// Number of iterations of the inner solver.
    pub inner_iterations: u32,
    /// Number of elementary operations in the model's own unit, for snapshots of work.
    pub work: u64,
    /// Mean power received through conservative inputs over the window [W]; `None` for a model that
    /// receives none.
    pub received_power: Option<f64>,
    /// Longest window that the model accepts from the start of this one [s], limited by an event or
    /// by accuracy. Adaptive windows respect a value shorter than the window solved.
    pub wanted_window: Option<f64>,
}

impl StepReport {
    /// Describes the first invalid quantity, if any.
    #[must_use]
    pub fn fault(&self) -> Option<String> {
        if let Some(power) = self.received_power.filter(|power| !power.is_finite()) {
            return Some(format!("the model reports a received power of {power} W"));
        }
        let wrong = |wish: &f64| !(wish.is_finite() && *wish >= 0.0);
        let wish = self.wanted_window.filter(wrong)?;
        Some(format!("the model wants a window of {wish} s"))
    }
}
