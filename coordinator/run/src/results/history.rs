//! `history.csv`: one row for every accepted window, and for every row of a sequence without an answer, written as the run goes.
//!
//! | column | |
//! |---|---|
//! | `window`, `start_s`, `end_s` | from 0; the window |
//! | `status` | `converged`, `not-converged`, `completed` for an explicit scheme, or `no-answer` |
//! | `iterations` | that it took |
//! | keys of the case, with units | the inputs that vary, as they are in the window: columns of tables and live values |
//! | keys of the summary | the figures that participants describe, as of the end of the window; empty where there is none |
//!
//! When the run is complete, columns without any value are removed ([`finish`]).

use super::derived::ratio;
use super::extremes::Extremes;
use super::rows::{Rows, cell, push};
use super::write::create;
use crate::error::{RunError, file_failure};
use contract::figure::{Derived, FigureSpec};
use contract::step::Step;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Write};
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
    /// The inputs that vary, in the order in which the table was created.
    pub inputs: &'a [Option<f64>],
    /// What the participants give, in the plan's order; NaN for what there is not, and `None` for a
    /// window without an answer.
    pub given: Option<&'a [f64]>,
}

impl HistoryTable {
    /// Creates the file with a column for each of these inputs, and for each of these figures that there
    /// is once, of which participants give those of the keys `given`.
    ///
    /// # Errors
    /// The file system.
    pub fn create(
        path: &Path,
        inputs: &[String],
        figures: &[FigureSpec],
        given: &[&str],
    ) -> Result<Self, RunError> {
        let mut head = OWN.join(",").into_bytes();
        for input in inputs {
            push(&mut head, format_args!(",{input}"));
        }
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

/// The columns of every table.
const OWN: [&str; 5] = ["window", "start_s", "end_s", "status", "iterations"];

/// Removes the columns without any value from the table of a complete run; the extremes of the figures
/// that stand large.
///
/// # Errors
/// The file system.
pub fn finish(path: &Path, figures: &[FigureSpec]) -> Result<Extremes, RunError> {
    let read = || File::open(path).map(|file| BufReader::new(file).lines());
    let survey = || -> io::Result<_> {
        let mut lines = read()?;
        let head: Vec<String> = match lines.next() {
            Some(line) => line?.split(',').map(str::to_owned).collect(),
            None => Vec::new(),
        };
        let mut filled: Vec<bool> = (0..head.len()).map(|column| column < OWN.len()).collect();
        let mut extremes = Extremes::of(&head, figures);
        for line in lines {
            let line = line?;
            let cells: Vec<&str> = line.split(',').collect();
            filled.iter_mut().zip(&cells).for_each(|(filled, cell)| *filled |= !cell.is_empty());
            extremes.add(&cells);
        }
        Ok((filled, extremes))
    };
    let (filled, extremes) = survey().map_err(|error| file_failure(path, &error))?;
    if !filled.iter().all(|filled| *filled) {
        create(path, |out| {
            for line in read()? {
                let line = line?;
                let cells = line.split(',').zip(&filled).filter(|(_, filled)| **filled);
                let cells: Vec<&str> = cells.map(|(cell, _)| cell).collect();
                writeln!(out, "{}", cells.join(","))?;
            }
            Ok(())
        })?;
    }
    Ok(extremes)
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
    let HistoryRecord { step, status, iterations, inputs, given } = record;
    let Step { window, start, end, .. } = step;
    push(out, format_args!("{window},{start},{end},{status},{iterations}"));
    inputs.iter().for_each(|input| cell(out, *input));
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
            let inputs = &[Some(4.0)];
            let record = HistoryRecord { step: &step, status, iterations: 7, inputs, given };
            write_row(&mut out, &record, &columns);
            String::from_utf8(out).unwrap()
        };
        assert_eq!(row(Some([2.0, -1.0]), "converged"), "3,0.5,1,converged,7,4e0,-5e-1,-1e0,,2e0");
        assert_eq!(
            row(Some([f64::NAN, 1.0]), "not-converged"),
            "3,0.5,1,not-converged,7,4e0,,1e0,,"
        );
        assert_eq!(row(None, "no-answer"), "3,0.5,1,no-answer,7,4e0,,,,");
    }

    /// A complete table has no empty columns, and its extremes have their rows.
    #[test]
    fn a_complete_table_has_no_empty_columns() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(FILE);
        let figures = [
            FigureSpec::new("wheelset.z_m", "m", "height").headline(),
            FigureSpec::new("heat.rise_k", "K", "rise").headline(),
        ];
        let given = ["wheelset.z_m", "heat.rise_k"];
        let inputs = ["motion.speed [m/s]".to_owned()];
        let mut table = HistoryTable::create(&path, &inputs, &figures, &given).unwrap();
        for (window, rise) in [(0, 30.0), (1, 73.8), (2, 36.7)] {
            let end = 0.5 * window as f64;
            let step = Step { window, iteration: 1, start: end, end };
            let record = HistoryRecord {
                step: &step,
                status: "completed",
                iterations: 1,
                inputs: &[Some(20.0)],
                given: Some(&[f64::NAN, rise]),
            };
            table.row(&record).unwrap();
        }
        table.flush().unwrap();
        let extremes = finish(&path, &figures).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        assert_eq!(
            text,
            "window,start_s,end_s,status,iterations,motion.speed [m/s],heat.rise_k\n\
             0,0,0,completed,1,2e1,3e1\n1,0.5,0.5,completed,1,2e1,7.38e1\n\
             2,1,1,completed,1,2e1,3.67e1\n"
        );
        let told = extremes.section(true).unwrap();
        assert_eq!(told["largest"]["heat"]["rise_k"], 73.8);
        assert_eq!(told["smallest"]["heat"]["rise_k"], 30.0);
        let place = &told["places"][0];
        assert_eq!((&place["largest_row"], &place["largest_s"]), (&2.into(), &0.5.into()));
    }
}
