//! `history.csv`: one row for every accepted window, and for every row of a sequence without an answer, written as the run goes.
//!
//! | column | |
//! |---|---|
//! | `window`, `start_s`, `end_s` | from 0; the window |
//! | `status` | `converged`, `not-converged`, `completed` for an explicit scheme, or `no-answer` |
//! | `iterations` | that it took |
//! | keys of the summary | the figures that participants describe, as of the end of the window; empty where there is none |

use super::derived::ratio;
use super::rows::{Rows, cell, push};
use crate::error::RunError;
use contract::figure::{Derived, FigureSpec};
use contract::step::Step;
use std::path::Path;

/// Name of the file.
pub const FILE: &str = "history.csv";

/// The table being written.
#[derive(Debug)]
pub struct HistoryTable {
    rows: Rows,
    /// By their keys.
    columns: Vec<(String, Column)>,
}

/// Where the value of a column comes from: places in the list of what participants give.
#[derive(Clone, Debug, PartialEq)]
enum Column {
    Given(usize),
    Ratio { of: Vec<Option<usize>>, over: Option<usize> },
}

/// A window.
#[derive(Clone, Copy, Debug)]
pub struct HistoryRecord<'a> {
    /// The window.
    pub step: &'a Step,
    /// How it has ended.
    pub status: &'a str,
    /// How many there were.
    pub iterations: u32,
    /// What the participants give, in the plan's order; NaN for what there is not, and `None` for a
    /// window without an answer.
    pub given: Option<&'a [f64]>,
}

impl HistoryTable {
    /// Creates the file with a column for each of these figures that there is once, of which
    /// participants give those of the keys `given`.
    ///
    /// # Errors
    /// The file system.
    pub fn create(path: &Path, figures: &[FigureSpec], given: &[&str]) -> Result<Self, RunError> {
        let mut head = b"window,start_s,end_s,status,iterations".to_vec();
        for figure in listed(figures) {
            push(&mut head, format_args!(",{}", figure.key));
        }
        head.push(b'\n');
        Ok(Self { rows: Rows::create(path, head)?, columns: columns(figures, given) })
    }

    /// Opens the table of a run that is resumed, and forgets what comes after its first `bytes` bytes.
    ///
    /// # Errors
    /// The file is shorter, or cannot be opened.
    pub fn resume(
        path: &Path,
        bytes: u64,
        figures: &[FigureSpec],
        given: &[&str],
    ) -> Result<Self, RunError> {
        Ok(Self { rows: Rows::resume(path, bytes)?, columns: columns(figures, given) })
    }

    /// The keys of its figures, in the order of the columns.
    pub fn keys(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().map(|(key, _)| key.as_str())
    }

    /// The figures of a window, in the order of the columns, of what the participants give.
    #[must_use]
    pub fn values(&self, given: &[f64]) -> Vec<Option<f64>> {
        self.columns.iter().map(|(_, column)| column.value(given)).collect()
    }

    /// Adds the row of a window.
    ///
    /// # Errors
    /// The file system.
    pub fn row(&mut self, record: &HistoryRecord<'_>) -> Result<(), RunError> {
        let Self { rows, columns } = self;
        rows.add(|out| write_row(out, record, columns))
    }

    /// Flushes everything to the disk; the length of the file \[byte\].
    ///
    /// # Errors
    /// The file system.
    pub fn seal(&mut self) -> Result<u64, RunError> {
        self.rows.seal()
    }

    /// Writes what is not in the file yet; its length \[byte\].
    ///
    /// # Errors
    /// The file system.
    pub fn mark(&mut self) -> Result<u64, RunError> {
        self.rows.mark()
    }

    /// Forgets what comes after a length, and gives it.
    ///
    /// # Errors
    /// The file system.
    pub fn cut(&mut self, bytes: u64) -> Result<Vec<u8>, RunError> {
        self.rows.cut(bytes)
    }

    /// Adds rows that were cut.
    ///
    /// # Errors
    /// The file system.
    pub fn append(&mut self, rows: &[u8]) -> Result<(), RunError> {
        self.rows.append(rows)
    }

    /// Writes what is not in the file yet.
    ///
    /// # Errors
    /// The file system.
    pub fn flush(&mut self) -> Result<(), RunError> {
        self.rows.flush()
    }
}

fn listed(figures: &[FigureSpec]) -> impl Iterator<Item = &FigureSpec> {
    figures.iter().filter(|figure| !figure.is_of_a_list())
}

fn columns(figures: &[FigureSpec], given: &[&str]) -> Vec<(String, Column)> {
    let place = |key: &String| given.iter().position(|given| given == key);
    let column = |figure: &FigureSpec| match &figure.derived {
        Some(Derived::Ratio { of, over }) => {
            Column::Ratio { of: of.iter().map(place).collect(), over: place(over) }
        }
        Some(Derived::Within { .. }) => unreachable!("a figure of a list has no column"),
        None => Column::Given(place(&figure.key).expect("what is not derived is given")),
    };
    listed(figures).map(|figure| (figure.key.clone(), column(figure))).collect()
}

impl Column {
    fn value(&self, given: &[f64]) -> Option<f64> {
        let at = |place: Option<usize>| place.map(|place| given[place]).filter(|v| v.is_finite());
        match self {
            Self::Given(place) => at(Some(*place)),
            Self::Ratio { of, over } => ratio(of.iter().map(|place| at(*place)), at(*over)),
        }
    }
}

fn write_row(out: &mut Vec<u8>, record: &HistoryRecord<'_>, columns: &[(String, Column)]) {
    let HistoryRecord { step, status, iterations, given } = record;
    let Step { window, start, end, .. } = step;
    push(out, format_args!("{window},{start},{end},{status},{iterations}"));
    for (_, column) in columns {
        cell(out, given.and_then(|given| column.value(given)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_has_what_is_given_and_what_follows_from_it() {
        let figure = |key: &str| FigureSpec::new(key, "1", "a figure");
        let figures = [
            figure("heat.x_over_a").ratio(&["heat.x_m"], "contact.a_m"),
            figure("heat.x_m"),
            figure("contact.each.#.y_m"),
            figure("contact.other").ratio(&["heat.x_m"], "contact.nowhere"),
            figure("contact.a_m"),
        ];
        let columns = columns(&figures, &["contact.a_m", "heat.x_m"]);
        let row = |given: Option<[f64; 2]>, status: &str| {
            let mut out = Vec::new();
            let step = Step { window: 3, iteration: 7, start: 0.5, end: 1.0 };
            let given = given.as_ref().map(<[f64; 2]>::as_slice);
            let record = HistoryRecord { step: &step, status, iterations: 7, given };
            write_row(&mut out, &record, &columns);
            String::from_utf8(out).unwrap()
        };
        assert_eq!(row(Some([2.0, -1.0]), "converged"), "3,0.5,1,converged,7,-5e-1,-1e0,,2e0");
        assert_eq!(row(Some([f64::NAN, 1.0]), "not-converged"), "3,0.5,1,not-converged,7,,1e0,,");
        assert_eq!(row(None, "no-answer"), "3,0.5,1,no-answer,7,,,,");
    }
}
