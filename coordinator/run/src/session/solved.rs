//! What a participant reported of its last solve.

use contract::message::Reply;

/// What one participant reported of its last solve.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolveRecord {
    /// Seconds in the model.
    pub model_seconds: f64,
    /// Work in the model's own measure.
    pub work: u64,
    /// Substeps.
    pub substeps: u32,
    /// Iterations of the inner solver.
    pub inner_iterations: u32,
    /// Power in the conservative inputs that it was assigned [W].
    pub heat_sent: Option<f64>,
    /// Mean power received through conservative inputs, as it reports [W].
    pub heat_received: Option<f64>,
    /// Longest window that it would take from the start of this one [s].
    pub wanted_window: Option<f64>,
}

impl SolveRecord {
    /// What a reply says.
    pub(super) fn of(reply: &Reply) -> Self {
        Self {
            model_seconds: reply.model_seconds,
            work: reply.work,
            substeps: reply.substeps,
            inner_iterations: reply.inner_iterations,
            heat_sent: None,
            heat_received: Some(reply.heat_received).filter(|heat| !heat.is_nan()),
            wanted_window: Some(reply.wanted_window).filter(|w| *w > 0.0 && w.is_finite()),
        }
    }
}
