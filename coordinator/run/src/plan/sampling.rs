//! Peaks of a history between the middles of windows.
//!
//! A window takes the values of a table at its middle. A peak that rises and falls between two
//! middles is in no window: the run never sees it.

use super::contents::Participant;
use crate::warnings::{Warning, plain};
use case::Case;
use contract::history::Histories;
use contract::step::Step;
use coupling::windows::Windows;

/// Part of a column's largest magnitude by which its peaks may exceed the values of the windows.
const MISSED: f64 = 0.05;
/// Parts of a window that are tried as shorter windows.
const PARTS: [f64; 15] =
    [2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1e3, 2e3, 5e3, 1e4, 2e4, 5e4, 1e5];
/// Largest number of windows that advice asks for.
const MOST_WINDOWS: u64 = 1_000_000;

/// A peak that no window uses.
#[derive(Clone, Copy, Debug, PartialEq)]
struct MissedPeak {
    /// Time of the peak [s].
    time: f64,
    /// Value of the peak.
    value: f64,
    /// Value in a window that is nearest to it.
    used: f64,
}

/// Returns a warning for each column with a peak that none of the fixed windows uses.
pub(super) fn warnings<'a>(
    case: &Case,
    participants: impl Iterator<Item = &'a Participant> + Clone,
    windows: &Windows,
) -> Vec<Warning> {
    let (Some(histories), &Windows::Fixed { window, end }) = (&case.histories, windows) else {
        return Vec::new();
    };
    if histories.rows || histories.live.is_some() {
        return Vec::new();
    }
    let of = |key: &String| {
        let read =
            |p: &Participant| p.configuration.histories.as_ref()?.values.get(key).map(|_| ());
        let reader = participants.clone().find(|participant| read(participant).is_some())?;
        let MissedPeak { time, value, used } = missed(histories, key, (window, end))?;
        let unit = match reader.description.key(key).map_or("1", |spec| spec.kind.unit()) {
            "1" => String::new(),
            unit => format!(" {unit}"),
        };
        let reason = format!(
            "reaches {}{unit} at {} s, between the middles of two windows; the nearest value that a window uses is \
             {}{unit}",
            plain(value),
            plain(time),
            plain(used)
        );
        let rounded = |part: &f64| plain(window / part).parse::<f64>().ok();
        let shorter = PARTS.iter().filter_map(rounded).find(|window| {
            end / window <= MOST_WINDOWS as f64 && missed(histories, key, (*window, end)).is_none()
        });
        let fix = match shorter {
            Some(window) => format!("write time.window = \"{} s\"", plain(window)),
            None => "divide the run: its windows would be too many".to_owned(),
        };
        Some(case.problem_at(key, reason, fix).into())
    };
    histories.values.keys().filter_map(of).collect()
}

/// Returns the largest or smallest value of a column between the first and the last middle of a
/// window, if no window has nearly that value.
fn missed(histories: &Histories, key: &str, (window, end): (f64, f64)) -> Option<MissedPeak> {
    let column = histories.values.get(key)?;
    let windows = Windows::Fixed { window, end };
    let last = windows.count()? - 1;
    let step = |window: u64| {
        let (start, end) = windows.interval(window, 0.0, 0.0);
        Step { window, start, end, ..Step::STEADY }
    };
    let middle = |window: u64| 0.5 * (step(window).start + step(window).end);
    let middles = [middle(0), middle(last)];
    let rows = histories.times.iter().zip(column);
    let inside: Vec<(f64, f64)> = rows
        .map(|(time, value)| (*time, *value))
        .filter(|(time, _)| middles[0] < *time && *time < middles[1])
        .collect();
    let size = inside.iter().map(|(_, value)| value.abs()).fold(0.0, f64::max);
    // Between two rows the column is straight: its extremes are in the windows next to rows.
    let near = |time: &f64| {
        let before = (time / window - 1.5).floor().max(0.0) as u64;
        (before..=before + 3).map(|window| window.min(last))
    };
    let values = || {
        let windows = histories.times.iter().flat_map(near);
        windows.filter_map(|window| histories.value(key, &step(window)))
    };
    // Peaks upwards, then downwards.
    [1.0, -1.0].into_iter().find_map(|sign| {
        let (time, value) =
            inside.iter().copied().max_by(|a, b| (sign * a.1).total_cmp(&(sign * b.1)))?;
        let used = sign * values().map(|value| sign * value).fold(f64::NEG_INFINITY, f64::max);
        (sign * (value - used) > MISSED * size).then_some(MissedPeak { time, value, used })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A load of 100 that rises to `peak` for 1 ms about the time `at`.
    fn with_peak(at: f64, peak: f64) -> Histories {
        let times = vec![0.0, at - 1e-3, at, at + 1e-3, 1.0];
        let values = [("load".to_owned(), vec![100.0, 100.0, peak, 100.0, 100.0])];
        Histories { rows: false, times, values: values.into(), live: None }
    }

    #[test]
    fn a_peak_between_two_middles_is_found() {
        let windows = (20e-3, 1.0);
        let peak = MissedPeak { time: 0.5, value: 300.0, used: 100.0 };
        assert_eq!(missed(&with_peak(0.5, 300.0), "load", windows), Some(peak));
        assert_eq!(missed(&with_peak(0.51, 300.0), "load", windows), None, "a middle");
        assert_eq!(missed(&with_peak(0.5, 104.0), "load", windows), None, "small");
        let hollow = missed(&with_peak(0.5, -50.0), "load", windows).unwrap();
        assert_eq!((hollow.value, hollow.used), (-50.0, 100.0));
        // Values before the first middle and behind the last one belong to these windows.
        assert_eq!(missed(&with_peak(2e-3, 300.0), "load", windows), None);
        assert_eq!(missed(&with_peak(0.5, 300.0), "load", (0.2e-4, 1.0)), None);
    }
}
