//! Varying case values: columns of a table over time, a sequence of steady contacts, or values
//! given from outside during the run.

use crate::live::Live;
use crate::params::Params;
use crate::step::Step;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

/// Values of every row of a table, by dotted key of the case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Histories {
    /// Each row is a steady contact, solved in a window of its own. Otherwise rows are times, with
    /// linear interpolation between them.
    pub rows: bool,
    /// Times of the rows [s]: at least one, non-decreasing; strictly increasing if rows are times.
    pub times: Vec<f64>,
    /// One value per row for every varying key, in SI units.
    pub values: BTreeMap<String, Vec<f64>>,
    /// All the keys are given from outside, solve by solve. The rows then come from
    /// [`Histories::live`]; they span the range that a model must be laid out for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub live: Option<Live>,
}

impl Histories {
    /// Returns the histories of keys given from outside, from the first value and the limits of
    /// each key. The first row holds the first values; each further row is a corner of the box of
    /// limits. With `steady`, each row is a steady contact; otherwise a value holds over its
    /// window.
    #[must_use]
    pub fn live(steady: bool, keys: &BTreeMap<String, (f64, [f64; 2])>) -> Self {
        let corners = 1_usize << keys.len().min(Live::MOST);
        let column = |(place, (first, limits)): (usize, &(f64, [f64; 2]))| {
            let corner = |corner: usize| limits[corner >> place & 1];
            std::iter::once(*first).chain((0..corners).map(corner)).collect()
        };
        let columns = keys.values().enumerate().map(column);
        let limits = keys.iter().map(|(key, (_, limits))| (key.clone(), *limits));
        Self {
            rows: steady,
            times: (0..=corners).map(|row| row as f64).collect(),
            values: keys.keys().cloned().zip(columns).collect(),
            live: Some(Live::within(limits.collect())),
        }
    }

    /// Checks histories received from another process.
    ///
    /// # Errors
    /// Fails without rows, for a column whose length differs from that of the times, for a value
    /// that is not finite, and for times that fall.
    pub fn check(&self) -> Result<(), String> {
        if self.times.is_empty() {
            return Err("a history has no rows".to_owned());
        }
        let rising = match self.rows {
            true => self.times.is_sorted(),
            false => self.times.is_sorted_by(|a, b| a < b),
        };
        if !rising || self.times.iter().any(|time| !time.is_finite()) {
            return Err("the times of a history do not rise".to_owned());
        }
        if let Some(live) = &self.live {
            live.check(self.values.keys())?;
        }
        for (key, column) in &self.values {
            if column.len() != self.times.len() {
                let (found, expected) = (column.len(), self.times.len());
                return Err(format!("the history of `{key}` has {found} rows, not {expected}"));
            }
            if let Some(row) = column.iter().position(|value| !value.is_finite()) {
                return Err(format!("the history of `{key}` is not finite in row {row}"));
            }
        }
        Ok(())
    }

    /// Returns the case in a window: at its row, or at its midpoint. Midpoint values equal window
    /// means to second order in the window length.
    #[must_use]
    pub fn at(&self, case: &Params, step: &Step) -> Params {
        let mut case = case.clone();
        self.put(&mut case, step);
        case
    }

    /// Overwrites the varying values of a case with those of a window; live keys take the latest
    /// value.
    pub fn put(&self, case: &mut Params, step: &Step) {
        if let Some(live) = &self.live {
            for (key, column) in &self.values {
                put(&mut case.0, key, live.value(key).unwrap_or(column[0]));
            }
            return;
        }
        match self.rows {
            true => self.put_row(case, row_of(step)),
            false => self.put_time(case, middle(step)),
        }
    }

    /// Returns the value of a key in a window, as in [`Histories::put`]; `None` if the key does not
    /// vary.
    #[must_use]
    pub fn value(&self, key: &str, step: &Step) -> Option<f64> {
        let column = self.values.get(key)?;
        let live = self.live.as_ref().map(|live| live.value(key).unwrap_or(column[0]));
        Some(live.unwrap_or_else(|| match self.rows {
            true => at_row(column, row_of(step)),
            false => self.between(middle(step))(column),
        }))
    }

    /// Overwrites the varying values of a case with those of a row.
    pub fn put_row(&self, case: &mut Params, row: usize) {
        self.put_values(case, |column| at_row(column, row));
    }

    /// Overwrites the varying values of a case with those at a time [s]; constant beyond the first
    /// and last row.
    fn put_time(&self, case: &mut Params, time: f64) {
        self.put_values(case, self.between(time));
    }

    /// Returns the interpolation of a column at a time [s].
    fn between(&self, time: f64) -> impl Fn(&[f64]) -> f64 + use<> {
        let right = self.times.partition_point(|at| *at <= time);
        let last = self.times.len() - 1;
        let (left, right) = (right.saturating_sub(1), right.min(last));
        let span = self.times[right] - self.times[left];
        let share = if span > 0.0 { (time - self.times[left]).max(0.0) / span } else { 0.0 };
        move |column| column[left] + share * (column[right] - column[left])
    }

    fn put_values(&self, case: &mut Params, value: impl Fn(&[f64]) -> f64) {
        for (key, column) in &self.values {
            put(&mut case.0, key, value(column));
        }
    }
}

fn row_of(step: &Step) -> usize {
    usize::try_from(step.window).unwrap_or(usize::MAX)
}

/// Midpoint of a window [s].
fn middle(step: &Step) -> f64 {
    0.5 * (step.start + step.end)
}

/// Value of a column in a row; the last value beyond the last row.
fn at_row(column: &[f64], row: usize) -> f64 {
    column[row.min(column.len() - 1)]
}

fn put(at: &mut Value, key: &str, number: f64) {
    let mut at = at;
    for part in key.split('.') {
        if !at.is_object() {
            *at = Value::Object(serde_json::Map::new());
        }
        at = &mut at[part];
    }
    *at = number.into();
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn histories(rows: bool) -> Histories {
        let values = [("load.normal_force".to_owned(), vec![1.0, 3.0, 2.0])];
        Histories { rows, times: vec![0.0, 1.0, 3.0], values: values.into(), live: None }
    }

    fn case() -> Params {
        Params(json!({"load": {"normal_force": 1.0, "other": 5.0}}))
    }

    #[test]
    fn instants_have_straight_lines_between_and_hold_beyond() {
        let load = |time: f64| {
            let mut case = case();
            histories(false).put_time(&mut case, time);
            case.number("load.normal_force")
        };
        for (time, expected) in [(-1.0, 1.0), (0.5, 2.0), (1.0, 3.0), (2.0, 2.5), (9.0, 2.0)] {
            assert_eq!(load(time), Ok(expected), "{time}");
        }
        let step = Step { start: 0.0, end: 1.0, ..Step::STEADY };
        assert_eq!(histories(false).at(&case(), &step).number("load.normal_force"), Ok(2.0));
        assert_eq!(histories(false).value("load.normal_force", &step), Some(2.0));
        assert_eq!(histories(false).at(&case(), &step).number("load.other"), Ok(5.0));
    }

    #[test]
    fn a_window_is_a_row() {
        let step = Step { window: 2, start: 3.0, end: 3.0, iteration: 1 };
        assert_eq!(histories(true).value("load.normal_force", &step), Some(2.0));
        assert_eq!(histories(true).value("load.other", &step), None);
        assert_eq!(histories(true).at(&case(), &step).number("load.normal_force"), Ok(2.0));
    }

    #[test]
    fn what_came_from_outside_is_checked() {
        assert_eq!(histories(true).check(), Ok(()));
        let wrong = |change: fn(&mut Histories)| {
            let mut histories = histories(false);
            change(&mut histories);
            histories.check().unwrap_err()
        };
        assert!(wrong(|h| h.times.clear()).contains("no rows"));
        assert!(wrong(|h| h.times[1] = 0.0).contains("do not rise"));
        assert!(wrong(|h| h.times.push(9.0)).contains("has 3 rows, not 4"));
        let nan = |h: &mut Histories| h.values.values_mut().for_each(|c| c[1] = f64::NAN);
        assert!(wrong(nan).contains("not finite in row 1"));
    }

    #[test]
    fn live_values_are_those_given_last_and_plans_see_the_corners() {
        let keys = [
            ("load.normal_force".to_owned(), (2.0, [1.0, 3.0])),
            ("load.other".to_owned(), (5.0, [4.0, 6.0])),
        ];
        let histories = Histories::live(true, &keys.into());
        assert_eq!(histories.check(), Ok(()));
        let corners: Vec<_> = (0..histories.times.len())
            .map(|row| {
                let mut case = case();
                histories.put_row(&mut case, row);
                [case.number("load.normal_force").unwrap(), case.number("load.other").unwrap()]
            })
            .collect();
        assert_eq!(corners, [[2.0, 5.0], [1.0, 4.0], [3.0, 4.0], [1.0, 6.0], [3.0, 6.0]]);
        let copy = histories.clone();
        let at = |histories: &Histories| {
            histories.at(&case(), &Step { window: 7, ..Step::STEADY }).number("load.normal_force")
        };
        assert_eq!(at(&copy), Ok(2.0), "the first value until one is given");
        histories.live.as_ref().unwrap().give("load.normal_force", 2.5);
        assert_eq!(at(&copy), Ok(2.5), "copies share what is given");
        let text = serde_json::to_string(&histories).unwrap();
        let travelled: Histories = serde_json::from_str(&text).unwrap();
        assert_eq!(travelled, histories);
        assert_eq!(at(&travelled), Ok(2.0));
    }

    #[test]
    fn live_keys_from_outside_are_checked() {
        let wrong = |limits: &[(&str, [f64; 2])]| {
            let limits = limits.iter().map(|(key, limits)| ((*key).to_owned(), *limits));
            let live = Some(Live::within(limits.collect()));
            Histories { live, ..histories(true) }.check().unwrap_err()
        };
        assert!(wrong(&[]).contains("`load.normal_force`"));
        assert!(wrong(&[("load.normal_force", [3.0, 1.0])]).contains("limits"));
        assert!(wrong(&[("load.normal_force", [0.0, f64::INFINITY])]).contains("limits"));
        assert!(wrong(&[("load.normal_force", [1.0, 3.0]), ("a", [0.0, 1.0])]).contains("`a`"));
    }
}
