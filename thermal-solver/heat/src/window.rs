//! A window of time: how its heat enters the bodies, and whether it is accepted.

/// Heat of a window and the bodies that it enters; pairs are (upper, lower).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// Length of the window [s]; infinite in steady motion.
    pub duration: f64,
    /// Surface speeds [m/s].
    pub speeds: [f64; 2],
    /// Shares of the heat [-].
    pub shares: [f64; 2],
}

/// The stage of a window that a question is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// The last solve.
    Trial,
    /// The last accepted one.
    Accepted,
}
