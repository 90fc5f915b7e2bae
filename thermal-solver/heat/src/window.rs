//! A window of time: its heat in the bodies, and its stage.

/// Heat of a window and the bodies that receive it; pairs are (upper, lower).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// Duration of the window [s]; infinite in steady motion.
    pub duration: f64,
    /// Surface speeds [m/s].
    pub speeds: [f64; 2],
    /// Shares of the heat [-].
    pub shares: [f64; 2],
}

/// Stage of a window to which a query refers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// The last solve.
    Trial,
    /// The last accepted solve.
    Accepted,
}
