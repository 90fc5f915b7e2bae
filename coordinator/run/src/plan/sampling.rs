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
    /// Largest distance between two middles of windows that do not miss it [s].
    resolved: f64,
}

impl MissedPeak {
    /// Returns the reason of a warning; `unit` is the unit of the column.
    fn reason(&self, unit: &str) -> String {
        let unit = if unit == "1" { String::new() } else { format!(" {unit}") };
        format!(
            "reaches {}{unit} at {} s, between the middles of two windows; the nearest value that a window uses is \
             {}{unit}",
            plain(self.value),
            plain(self.time),
            plain(self.used)
        )
    }
}

/// Middles of the windows of a run, and the values of a column there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sampled {
    /// First and last middle [s].
    middles: [f64; 2],
    /// Least and greatest value.
    values: [f64; 2],
}

impl Sampled {
    /// No window.
    pub(crate) const NONE: Self = Self {
        middles: [f64::INFINITY, f64::NEG_INFINITY],
        values: [f64::INFINITY, f64::NEG_INFINITY],
    };

    /// Adds the value of a window.
    pub(crate) fn add(&mut self, step: &Step, value: f64) {
        let extend = |of: &mut [f64; 2], by: f64| *of = [of[0].min(by), of[1].max(by)];
        extend(&mut self.middles, 0.5 * (step.start + step.end));
        extend(&mut self.values, value);
    }

    /// Returns the largest or smallest value of a column between the first and the last middle, if
    /// no window has nearly that value.
    fn missed(&self, times: &[f64], column: &[f64]) -> Option<MissedPeak> {
        let inside = |row: &usize| (self.middles[0]..self.middles[1]).contains(&times[*row]);
        let rows: Vec<usize> = (0..times.len()).filter(inside).collect();
        let size = rows.iter().map(|row| column[*row].abs()).fold(0.0, f64::max);
        let steepness = |row: usize| {
            let slope = |i: usize| ((column[i + 1] - column[i]) / (times[i + 1] - times[i])).abs();
            let before = if row > 0 { slope(row - 1) } else { 0.0 };
            before.max(if row + 1 < times.len() { slope(row) } else { 0.0 })
        };
        // Peaks upwards, then downwards.
        [(1.0, self.values[1]), (-1.0, self.values[0])].into_iter().find_map(|(sign, used)| {
            let highest =
                |a: &&usize, b: &&usize| (sign * column[**a]).total_cmp(&(sign * column[**b]));
            let row = *rows.iter().max_by(highest)?;
            let (time, value) = (times[row], column[row]);
            let resolved = 2.0 * MISSED * size / steepness(row);
            let missed = sign * (value - used) > MISSED * size;
            missed.then_some(MissedPeak { time, value, used, resolved })
        })
    }

    /// Returns a warning if the windows of a run with adaptive windows have missed a peak of a
    /// column; `unit` is that of its key.
    pub(crate) fn warning(&self, histories: &Histories, key: &str, unit: &str) -> Option<Warning> {
        let peak = self.missed(&histories.times, histories.values.get(key)?)?;
        let longest = plain(0.9 * peak.resolved);
        let fix = format!("write time.window_max = \"{longest} s\", and time.window at most that");
        Some(Warning::remark(key, peak.reason(unit), &fix))
    }
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
        let peak = missed(histories, key, (window, end))?;
        let reason = peak.reason(reader.description.key(key).map_or("1", |spec| spec.kind.unit()));
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

/// Returns a peak of a column that fixed windows miss.
fn missed(histories: &Histories, key: &str, (window, end): (f64, f64)) -> Option<MissedPeak> {
    let column = histories.values.get(key)?;
    let windows = Windows::Fixed { window, end };
    let last = windows.count()? - 1;
    let step = |window: u64| {
        let (start, end) = windows.interval(window, 0.0, 0.0);
        Step { window, start, end, ..Step::STEADY }
    };
    let mut sampled = Sampled::NONE;
    let mut add = |window: u64| {
        let step = step(window);
        histories.value(key, &step).into_iter().for_each(|value| sampled.add(&step, value));
    };
    // Between two rows the column is straight: its extremes are in the windows next to rows.
    for time in &histories.times {
        let before = (time / window - 1.5).floor().max(0.0) as u64;
        (before..=before + 3).for_each(|window| add(window.min(last)));
    }
    [0, last].into_iter().for_each(add);
    sampled.missed(&histories.times, column)
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
        // A distance of 0.15 ms leaves at most 0.075 ms to the peak, and 200 per ms are 15 of 300.
        let peak = MissedPeak { time: 0.5, value: 300.0, used: 100.0, resolved: 1.5e-4 };
        let found = missed(&with_peak(0.5, 300.0), "load", windows).unwrap();
        assert!((found.resolved / peak.resolved - 1.0).abs() < 1e-9, "{found:?}");
        assert_eq!(found, MissedPeak { resolved: found.resolved, ..peak });
        assert_eq!(missed(&with_peak(0.5, 300.0), "load", (0.9 * found.resolved, 1.0)), None);
        assert_eq!(missed(&with_peak(0.51, 300.0), "load", windows), None, "a middle");
        assert_eq!(missed(&with_peak(0.5, 104.0), "load", windows), None, "small");
        let hollow = missed(&with_peak(0.5, -50.0), "load", windows).unwrap();
        assert_eq!((hollow.value, hollow.used), (-50.0, 100.0));
        // Values before the first middle and behind the last one belong to these windows.
        assert_eq!(missed(&with_peak(2e-3, 300.0), "load", windows), None);
        assert_eq!(missed(&with_peak(0.5, 300.0), "load", (0.2e-4, 1.0)), None);
    }
}
