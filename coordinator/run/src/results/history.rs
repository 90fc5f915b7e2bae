//! `history.csv`: one row for every accepted window, and for every row of a sequence without an
//! answer, written during the run.
//!
//! | column | |
//! |---|---|
//! | `window`, `start_s`, `end_s` | from 0; the window |
//! | `status` | `converged`, `not-converged`, `completed` for an explicit scheme, or `no-answer` |
//! | `iterations` | number of iterations |
//! | keys of the case, with units | the inputs that vary, with their values in the window: columns of tables and live values |
//! | keys of the summary | the figures that participants describe, at the end of the window; empty where there is none |
//!
//! When the summary of a complete run is written, columns without any value are removed ([`trim`]).
//! Until then a run that is killed can be resumed, because its checkpoints hold the length of the
//! file.
//!
//! All other figures of a summary describe the last window. In a sequence of steady contacts this
//! is one contact of many. Therefore the summary also holds the smallest and largest value over all
//! windows, with the windows in which they occur: section `extremes` ([`Extremes`]). Implausible
//! values are sought in all windows as well.

use super::derived::ratio;
use super::extremes::{Extremes, FigureRange, WindowValue};
use super::rows::{Rows, cell, push};
use super::write::create;
use crate::error::{RunError, file_failure};
use crate::format::Scale;
use contract::figure::{Derived, FigureSpec};
use contract::plausible::Plausible;
use contract::step::Step;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Write};
use std::path::Path;

/// Name of the file.
pub const FILE: &str = "history.csv";

/// Writer of the table.
#[derive(Debug)]
pub struct HistoryTable {
    pub(crate) rows: Rows,
    /// Columns with their keys.
    columns: Vec<(String, Column)>,
}

/// Source of the values of a column: indices in the list of figures that participants give.
#[derive(Clone, Debug, PartialEq)]
enum Column {
    Given(usize),
    Ratio { of: Vec<Option<usize>>, over: Option<usize> },
}

/// Content of a row.
#[derive(Clone, Copy, Debug)]
pub struct HistoryRecord<'a> {
    /// The window.
    pub step: &'a Step,
    /// Status of the window.
    pub status: &'a str,
    /// Number of iterations.
    pub iterations: u32,
    /// Varying inputs, in the order in which the table was created.
    pub inputs: &'a [Option<f64>],
    /// Figures of the participants, in the order of the plan; `None` for unknown ones, and for
    /// a window without an answer.
    pub given: Option<&'a [Option<f64>]>,
}

impl HistoryTable {
    /// Creates the file, with a column for each input and for each figure that is not in a list.
    /// `given` holds the keys of the figures that participants give.
    ///
    /// # Errors
    /// The file cannot be created.
    pub fn create(
        path: &Path,
        inputs: &[String],
        figures: &[FigureSpec],
        given: &[&str],
    ) -> Result<Self, RunError> {
        let mut head = OWN.join(",").into_bytes();
        for input in inputs {
            push(&mut head, format_args!(",{}", quoted(input)));
        }
        for figure in listed(figures) {
            push(&mut head, format_args!(",{}", figure.key));
        }
        head.push(b'\n');
        Ok(Self { rows: Rows::create(path, head)?, columns: columns(figures, given) })
    }

    /// Opens the table of a resumed run, and discards the content after the first `bytes` bytes.
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

    /// Returns the keys of the figures, in the order of the columns.
    pub fn keys(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().map(|(key, _)| key.as_str())
    }

    /// Returns the figures of a window in the order of the columns, from the figures that
    /// participants give.
    #[must_use]
    pub fn values(&self, given: &[Option<f64>]) -> Vec<Option<f64>> {
        self.columns.iter().map(|(_, column)| column.value(given)).collect()
    }

    /// Adds the row of a window.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn row(&mut self, record: &HistoryRecord<'_>) -> Result<(), RunError> {
        let Self { rows, columns } = self;
        rows.add(|out| write_row(out, record, columns))
    }
}

/// Columns of every table.
const OWN: [&str; 5] = ["window", "start_s", "end_s", "status", "iterations"];

/// A complete table, read once.
#[derive(Debug)]
pub struct Survey {
    /// Extremes of the headline figures, and implausible values.
    pub ranges: HistoryRanges,
    /// Columns that hold a value in at least one row.
    filled: Vec<bool>,
}

impl Survey {
    /// Reads the table of a complete run.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn read(path: &Path, figures: &[FigureSpec]) -> Result<Self, RunError> {
        let survey = || -> io::Result<_> {
            let mut lines = lines(path)?;
            let head = match lines.next() {
                Some(line) => names(&line?),
                None => Vec::new(),
            };
            let mut filled: Vec<bool> = (0..head.len()).map(|column| column < OWN.len()).collect();
            let mut ranges = HistoryRanges::of(&head, figures);
            for line in lines {
                let line = line?;
                let cells: Vec<&str> = line.split(',').collect();
                filled
                    .iter_mut()
                    .zip(&cells)
                    .for_each(|(filled, cell)| *filled |= !cell.is_empty());
                ranges.add(&cells);
            }
            Ok(Self { ranges, filled })
        };
        survey().map_err(|error| file_failure(path, &error))
    }

    /// Removes the columns without any value from the table.
    ///
    /// # Errors
    /// The file cannot be read or written.
    pub fn trim(&self, path: &Path) -> Result<(), RunError> {
        if self.filled.iter().all(|filled| *filled) {
            return Ok(());
        }
        create(path, |out| {
            for (row, line) in lines(path)?.enumerate() {
                let line = line?;
                let cells = match row {
                    0 => names(&line).iter().map(|cell| quoted(cell)).collect(),
                    _ => line.split(',').map(str::to_owned).collect::<Vec<_>>(),
                };
                let kept = cells.into_iter().zip(&self.filled).filter(|(_, filled)| **filled);
                let kept: Vec<String> = kept.map(|(cell, _)| cell).collect();
                writeln!(out, "{}", kept.join(","))?;
            }
            Ok(())
        })
    }
}

fn lines(path: &Path) -> io::Result<io::Lines<BufReader<File>>> {
    File::open(path).map(|file| BufReader::new(file).lines())
}

/// Quotes a cell that holds a comma or a quotation mark, as RFC 4180 does. Only keys of a case can.
fn quoted(cell: &str) -> String {
    match cell.contains([',', '"']) {
        true => format!("\"{}\"", cell.replace('"', "\"\"")),
        false => cell.to_owned(),
    }
}

/// Splits a head into the names of its columns, which may be quoted.
#[must_use]
pub fn names(line: &str) -> Vec<String> {
    let (mut cells, mut inside) = (vec![String::new()], false);
    let mut letters = line.chars().peekable();
    while let Some(letter) = letters.next() {
        let cell = cells.last_mut().expect("there is at least one cell");
        match letter {
            '"' if inside && letters.peek() == Some(&'"') => cell.extend(letters.next()),
            '"' => inside = !inside,
            ',' if !inside => cells.push(String::new()),
            other => cell.push(other),
        }
    }
    cells
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
    fn value(&self, given: &[Option<f64>]) -> Option<f64> {
        let at =
            |place: Option<usize>| place.and_then(|place| given[place]).filter(|v| v.is_finite());
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

/// Smallest and largest values of some columns of the history.
#[derive(Clone, Debug, PartialEq)]
pub struct HistoryRanges {
    columns: Vec<Range>,
    /// Columns whose values have a plausible range.
    judged: Vec<Judged>,
    /// Number of windows with an answer.
    windows: u64,
}

/// Extremes of a column.
#[derive(Clone, Debug, PartialEq)]
struct Range {
    key: String,
    /// Index of the column in a row.
    at: usize,
    /// Smallest and largest value.
    bounds: Option<[Bound; 2]>,
}

/// Value, and window in which it occurs.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Bound {
    value: f64,
    window: f64,
    end: f64,
}

/// Column whose values have a plausible range.
#[derive(Clone, Debug, PartialEq)]
struct Judged {
    key: String,
    plausible: Plausible,
    /// Index of the column in a row.
    at: usize,
    /// Values farthest below and above the range, and the factors by which they are.
    worst: [Option<(f64, Bound)>; 2],
}

/// An implausible value of a figure, and its window.
#[derive(Clone, Debug, PartialEq)]
pub struct Unexpected {
    /// Value in the unit of the figure.
    pub value: f64,
    /// Window or row, and its time.
    pub place: String,
}

impl HistoryRanges {
    /// Extremes of the headline figures, in a table with this header.
    fn of(head: &[String], figures: &[FigureSpec]) -> Self {
        let large = figures.iter().filter(|figure| figure.headline && !figure.is_of_a_list());
        let column = |figure: &FigureSpec| {
            let at = head.iter().position(|name| *name == figure.key)?;
            Some(Range { key: figure.key.clone(), at, bounds: None })
        };
        let judged = figures.iter().filter_map(|figure| {
            let plausible = figure.plausible.clone()?;
            let at = head.iter().position(|name| *name == figure.key)?;
            Some(Judged { key: figure.key.clone(), plausible, at, worst: [None; 2] })
        });
        let judged = judged.collect();
        Self { columns: large.filter_map(column).collect(), judged, windows: 0 }
    }

    /// Returns the least plausible value of a figure outside its range, if there is one. A lower
    /// bound holds for rows, each a contact of its own. In time a contact that opens or closes
    /// passes through every size.
    #[must_use]
    pub fn unexpected(&self, key: &str, rows: bool) -> Option<Unexpected> {
        let judged = self.judged.iter().find(|judged| judged.key == key)?;
        let [below, above] = judged.worst;
        let all = below.filter(|_| rows).into_iter().chain(above);
        let (_, Bound { value, window, end }) = all.max_by(|a, b| a.0.total_cmp(&b.0))?;
        let place = match rows {
            true => format!("row {}", window as u64 + 1),
            false => format!("window {window} (at {})", Scale::of("s", end).show(end, 4)),
        };
        Some(Unexpected { value, place })
    }

    /// Counts a row. Its first cells are window number, start and end.
    fn add(&mut self, cells: &[&str]) {
        let number = |at: usize| cells.get(at)?.parse::<f64>().ok();
        let (Some(window), Some(end)) = (number(0), number(2)) else { return };
        for Judged { at, plausible, worst, .. } in &mut self.judged {
            let Some(value) = number(*at) else { continue };
            let Some(excess) = plausible.excess(value) else { continue };
            let side = usize::from(plausible.most.is_some_and(|most| value.abs() > most));
            if worst[side].is_none_or(|(most, _)| excess > most) {
                worst[side] = Some((excess, Bound { value, window, end }));
            }
        }
        let mut answered = false;
        for Range { at, bounds, .. } in &mut self.columns {
            let Some(value) = number(*at) else { continue };
            answered = true;
            let own = Bound { value, window, end };
            let [least, most] = bounds.get_or_insert([own; 2]);
            if value < least.value {
                *least = own;
            }
            if value > most.value {
                *most = own;
            }
        }
        self.windows += u64::from(answered);
    }

    /// Returns the section of the summary; `None` if there is only one window, or if no value has
    /// changed.
    #[must_use]
    pub fn section(&self, rows: bool) -> Option<Extremes> {
        let at = |bound: Bound| WindowValue {
            value: bound.value,
            window: bound.window as u64 + u64::from(rows),
            end: bound.end,
        };
        let changed = self.columns.iter().filter_map(|column| {
            let [least, most] = column.bounds.filter(|[least, most]| least.value < most.value)?;
            Some(FigureRange { key: column.key.clone(), least: at(least), most: at(most) })
        });
        let figures: Vec<FigureRange> = changed.collect();
        let windows = self.windows;
        (windows > 1 && !figures.is_empty()).then_some(Extremes { rows, windows, figures })
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
        let row = |given: Option<[Option<f64>; 2]>, status: &str| {
            let mut out = Vec::new();
            let step = Step { window: 3, iteration: 7, start: 0.5, end: 1.0 };
            let given = given.as_ref().map(<[Option<f64>; 2]>::as_slice);
            let inputs = &[Some(4.0)];
            let record = HistoryRecord { step: &step, status, iterations: 7, inputs, given };
            write_row(&mut out, &record, &columns);
            String::from_utf8(out).unwrap()
        };
        assert_eq!(
            row(Some([Some(2.0), Some(-1.0)]), "converged"),
            "3,0.5,1,converged,7,4e0,-5e-1,-1e0,,2e0"
        );
        assert_eq!(
            row(Some([None, Some(1.0)]), "not-converged"),
            "3,0.5,1,not-converged,7,4e0,,1e0,,"
        );
        assert_eq!(row(None, "no-answer"), "3,0.5,1,no-answer,7,4e0,,,,");
    }

    /// A contact that closes has few elements at first; a row with few elements is coarse.
    #[test]
    fn a_lower_bound_is_judged_in_rows() {
        let figures = [
            FigureSpec::new("contact.elements_across", "1", "elements").expected_above(8.0, "few"),
            FigureSpec::new("heat.rise_k", "K", "rise").expected_below(700.0, "hot"),
        ];
        let head = ["window", "start_s", "end_s", "contact.elements_across", "heat.rise_k"];
        let mut ranges = HistoryRanges::of(&head.map(str::to_owned), &figures);
        for row in ["0,0,0,2,900", "1,0,1,20,7000", "2,0,2,20,30"] {
            ranges.add(&row.split(',').collect::<Vec<_>>());
        }
        let told = |key, rows| ranges.unexpected(key, rows).map(|one| (one.value, one.place));
        let elements = "contact.elements_across";
        assert_eq!(told(elements, true), Some((2.0, "row 1".to_owned())));
        assert_eq!(told(elements, false), None);
        assert_eq!(told("heat.rise_k", true), Some((7000.0, "row 2".to_owned())));
        assert_eq!(told("heat.rise_k", false).unwrap().0, 7000.0);
    }

    #[test]
    fn a_name_with_a_comma_keeps_its_column() {
        let all = ["end_s", "bodies.rail, \"left\".start_rise [K]", "contact.a_m"];
        let head = all.map(quoted).join(",");
        assert_eq!(head, "end_s,\"bodies.rail, \"\"left\"\".start_rise [K]\",contact.a_m");
        assert_eq!(names(&head), all);
    }

    /// A complete table has no empty columns, and the extremes name their rows.
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
                given: Some(&[None, Some(rise)]),
            };
            table.row(&record).unwrap();
        }
        table.rows.flush().unwrap();
        let before = std::fs::read_to_string(&path).unwrap();
        let survey = Survey::read(&path, &figures).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), before, "reading changes nothing");
        survey.trim(&path).unwrap();
        let (ranges, text) = (survey.ranges, std::fs::read_to_string(&path).unwrap());
        assert_eq!(
            text,
            "window,start_s,end_s,status,iterations,motion.speed [m/s],heat.rise_k\n\
             0,0,0,completed,1,2e1,3e1\n1,0.5,0.5,completed,1,2e1,7.38e1\n\
             2,1,1,completed,1,2e1,3.67e1\n"
        );
        let rise = ranges.section(true).unwrap().of("heat.rise_k").cloned().unwrap();
        assert_eq!(rise.least, WindowValue { value: 30.0, window: 1, end: 0.0 });
        assert_eq!(rise.most, WindowValue { value: 73.8, window: 2, end: 0.5 });
    }
}
