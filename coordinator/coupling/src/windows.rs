//! Windows of a run in time, fixed or adaptive.
//!
//! [`Windows`] holds the settings of the case. A [`Controller`] decides, window by window, on the
//! length of the next window and on the acceptance of the last one.

mod control;
mod local_error;

pub use control::{Acceptance, Cause, Controller, WindowState};
pub use local_error::LocalError;

use std::sync::Arc;

/// Relative difference of times that counts as rounding.
const ROUNDING: f64 = 1e-9;

/// Windows in time.
#[derive(Clone, Debug, PartialEq)]
pub enum Windows {
    /// One window without duration.
    Steady,
    /// Windows without duration, at these times [s].
    Sequence(Arc<[f64]>),
    /// Equal windows; the last one ends at the end of the run.
    Fixed {
        /// Length of a window [s].
        window: f64,
        /// End of the run [s].
        end: f64,
    },
    /// Windows that the driver requests one by one, without an end.
    Open {
        /// Default length of a window [s]; `None` for windows without duration.
        window: Option<f64>,
    },
    /// Windows as long as the error allows.
    Adaptive {
        /// Target of the relative error of the exchanged values [-].
        tolerance: f64,
        /// Shortest window, with which the run begins [s].
        shortest: f64,
        /// Longest window [s].
        longest: f64,
        /// End of the run [s].
        end: f64,
    },
}

impl Windows {
    /// Returns the number of windows, if known before the run. A remainder below a billionth of the
    /// whole is rounding, not a window.
    #[must_use]
    pub fn count(&self) -> Option<u64> {
        match self {
            Self::Steady => Some(1),
            Self::Sequence(times) => Some(times.len() as u64),
            Self::Fixed { window, end } => {
                let ratio = end / window;
                let count = if is_whole(ratio) { ratio.round() } else { ratio.ceil() };
                Some((count as u64).max(1))
            }
            Self::Open { .. } | Self::Adaptive { .. } => None,
        }
    }

    /// Returns whether all windows are known to have the same length, within rounding.
    #[must_use]
    pub fn are_equal(&self) -> bool {
        match self {
            Self::Fixed { window, end } => window >= end || is_whole(end / window),
            Self::Adaptive { .. } => false,
            Self::Steady | Self::Sequence(_) | Self::Open { .. } => true,
        }
    }

    /// Returns the end time of a run whose windows have a duration [s]; otherwise 0.
    #[must_use]
    pub fn end(&self) -> f64 {
        match self {
            Self::Steady | Self::Sequence(_) | Self::Open { .. } => 0.0,
            Self::Fixed { end, .. } | Self::Adaptive { end, .. } => *end,
        }
    }

    /// Returns the start and end [s] of window `index`, which begins at `start` and should have
    /// this length [s]. Fixed windows have the length of the case, counted from 0.
    #[must_use]
    pub fn interval(&self, index: u64, start: f64, length: f64) -> (f64, f64) {
        match self {
            Self::Steady => (0.0, 0.0),
            Self::Sequence(times) => {
                let time = usize::try_from(index).ok().and_then(|row| times.get(row));
                time.map_or((start, start), |time| (*time, *time))
            }
            Self::Fixed { window, end } => {
                let last = Some(index + 1) == self.count();
                let stop = if last { *end } else { (index + 1) as f64 * window };
                (index as f64 * window, stop)
            }
            Self::Open { window } => (start, start + window.unwrap_or(0.0)),
            Self::Adaptive { end, .. } => (start, adaptive_end(start, length, *end)),
        }
    }
}

/// Returns whether the ratio is a whole number, within rounding.
fn is_whole(ratio: f64) -> bool {
    (ratio - ratio.round()).abs() <= ROUNDING * ratio
}

/// Returns the end of a window of about this length. The end of the run is met exactly: the window
/// before the last takes half of the remaining time, which avoids a tiny last window.
fn adaptive_end(start: f64, length: f64, end: f64) -> f64 {
    let left = end - start;
    if left <= length * (1.0 + ROUNDING) {
        end
    } else if left < 2.0 * length {
        start + 0.5 * left
    } else {
        start + length
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_cover_the_time_exactly() {
        let windows = Windows::Fixed { window: 0.1, end: 0.3 };
        assert_eq!(windows.count(), Some(3), "0.3 / 0.1 is a rounding error above 2");
        assert_eq!(windows.interval(2, 0.0, 0.0).1, 0.3);
        let cut = Windows::Fixed { window: 0.4, end: 1.0 };
        assert_eq!(cut.count(), Some(3));
        assert!(windows.are_equal() && !cut.are_equal());
        assert_eq!(cut.interval(2, 0.0, 0.0), (0.8, 1.0));
        assert_eq!(Windows::Fixed { window: 2.0, end: 1.0 }.count(), Some(1));
        let long = Windows::Fixed { window: 5.23e-05, end: 18647.8858082 };
        let (start, end) = long.interval(long.count().unwrap() - 1, 0.0, 0.0);
        assert!(start < end, "every window has a length");
        let rows = Windows::Sequence([0.5, 0.5, 2.0].into());
        assert_eq!((rows.count(), rows.interval(2, 0.5, 0.0)), (Some(3), (2.0, 2.0)));
        assert_eq!(Windows::Steady.count(), Some(1));
        assert_eq!(Windows::Steady.interval(0, 0.0, 0.0), (0.0, 0.0));
    }

    #[test]
    fn adaptive_windows_end_at_the_end_without_a_crumb() {
        assert_eq!(adaptive_end(0.2, 0.3, 1.0), 0.5);
        assert_eq!(adaptive_end(0.5, 0.3, 1.0), 0.75, "0.2 would be left");
        assert_eq!(adaptive_end(0.7, 0.3, 1.0), 1.0, "1 - 0.7 is a rounding error above 0.3");
        assert_eq!(adaptive_end(0.9, 0.3, 1.0), 1.0);
    }
}
