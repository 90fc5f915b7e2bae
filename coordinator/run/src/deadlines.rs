//! Longest waits for participants.

use contract::configuration::Layout;
use std::time::Duration;

/// Longest duration of each kind of wait.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deadlines {
    /// Time from the start of a participant to its joining the run.
    pub start: Duration,
    /// Time for building a model.
    pub build: Duration,
    /// Time for any other command.
    pub solve: Duration,
    /// Time from one heartbeat to the next.
    pub heartbeat: Duration,
}

impl Deadlines {
    /// Factor by which building a model may take longer than expected.
    const BUILD_MARGIN: f64 = 10.0;

    /// Returns the limit for building the model of this layout. It grows with the time that the
    /// participant expects.
    #[must_use]
    pub fn build_of(&self, layout: &Layout) -> Duration {
        let expected = Self::BUILD_MARGIN * layout.build_seconds;
        Duration::try_from_secs_f64(expected).map_or(self.build, |margin| margin.max(self.build))
    }
}
