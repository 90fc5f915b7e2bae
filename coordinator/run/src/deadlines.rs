//! Limits of the waits.

use contract::configuration::Layout;
use std::time::Duration;

/// How long every kind of wait may last.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deadlines {
    /// From starting a participant to its joining the run.
    pub start: Duration,
    /// Building a model.
    pub build: Duration,
    /// One command.
    pub solve: Duration,
    /// From one heartbeat to the next.
    pub heartbeat: Duration,
}

impl Deadlines {
    /// How much longer than expected building a model may take.
    const BUILD_MARGIN: f64 = 10.0;

    /// For building the model of this layout: longer where the participant expects so.
    #[must_use]
    pub fn build_of(&self, layout: &Layout) -> Duration {
        let expected = Self::BUILD_MARGIN * layout.build_seconds;
        Duration::try_from_secs_f64(expected).map_or(self.build, |margin| margin.max(self.build))
    }
}
