//! How far a run is.

/// Shows how far a run is; one that shows nothing is `()`.
pub trait Progress {
    /// `done` windows are done, up to the time `reached` [s].
    fn window(&mut self, done: u64, reached: f64);

    /// The run is over.
    fn finish(&mut self);
}

impl Progress for () {
    fn window(&mut self, _done: u64, _reached: f64) {}

    fn finish(&mut self) {}
}
