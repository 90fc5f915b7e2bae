//! Columns of tables in the place of numbers: `{ file = "run.csv", column = "Q", unit = "kN" }`.
//!
//! All columns of a case come from one table ([`contract::table`]); one of them, `time.history` or
//! `time.distance`, says where its rows are in time.

use super::check::Fault;
use super::checker::{Checker, Columns, put};
use super::example::{in_range, range, with_unit};
use super::known::Known;
use super::schema::{BEYOND, DISTANCE, TIME};
use super::tree::{Node, Origin, Table, Value};
use contract::description::KeyKind;
use contract::history::Histories;
use contract::table::{Reading, Table as DataTable, TableError};
use serde_json::Value as Json;
use std::path::{Path, PathBuf};

/// The speed with which a distance is covered.
const SPEED: &str = "motion.speed";
/// What a reference to a column may say.
const ENTRIES: [&str; 3] = ["file", "column", "unit"];
/// How a reference is written.
const FORM: &str = "write { file = \"run.csv\", column = \"Q\", unit = \"kN\" }";
/// Larger tables are refused [byte].
const MOST_BYTES: u64 = 1 << 30;
/// A window may be outside its history by this part of the run: rounding of decimal times.
const ROUNDING: f64 = 1e-9;

/// Which column a key is, as the case says.
struct Reference<'a> {
    file: PathBuf,
    column: &'a str,
    unit: Option<&'a str>,
}

impl Checker<'_> {
    /// A table at a key that takes a number: a column of a table of data.
    pub(super) fn column(&mut self, key: &str, node: &Node, table: &Table, readers: &[&Known<'_>]) {
        match self.read_column(node, table, readers) {
            Ok(values) => {
                put(&mut self.values.0, key, Json::from(values[0]));
                if let Some(Value::Text(name)) = table.get("column").map(|node| &node.value) {
                    self.columns.names.insert(key.to_owned(), name.clone());
                }
                self.columns.values.insert(key.to_owned(), values);
            }
            Err(fault) => {
                self.columns.incomplete = true;
                if let Some(Fault { reason, fix }) = fault {
                    self.fault(key, reason, fix);
                }
            }
        }
    }

    /// The values of a column; what is wrong with it, unless that has been reported of its table.
    fn read_column(
        &mut self,
        node: &Node,
        table: &Table,
        readers: &[&Known<'_>],
    ) -> Result<Vec<f64>, Option<Fault>> {
        let fault = |reason: String, fix: &str| Some(Fault { reason, fix: fix.to_owned() });
        let active: Vec<&&Known<'_>> = readers.iter().filter(|known| known.active).collect();
        let readers = if active.is_empty() { readers.iter().collect() } else { active };
        if let Some(constant) = readers.iter().find(|known| !known.spec.varies) {
            let reason = format!("is a column, and {} reads one number", constant.owner);
            return Err(fault(reason, "write a number"));
        }
        let Some(KeyKind::Quantity { unit: si }) = readers.first().map(|k| &k.spec.kind) else {
            return Err(fault("is a table, not a value".to_owned(), "write a value"));
        };
        let reference = reference(table, &self.origin(node))?;
        let data = self.table(&reference.file)?;
        let values = data.column(reference.column, reference.unit, si).map_err(|error| {
            let fix = match &error {
                TableError::UnitsDiffer { .. } => {
                    "remove one of the units, or correct it".to_owned()
                }
                TableError::Unit { .. } => format!("give a unit that {si} can be made of"),
                TableError::NoColumn { .. } => "name a column of the header".to_owned(),
                _ => "correct the table; docs/how-to/use-a-table.md has the format".to_owned(),
            };
            Fault { reason: format!("`{}` {error}", reference.file.display()), fix }
        })?;
        for known in readers {
            let outside = |value: &f64| !in_range(&known.spec, *value);
            if let Some(row) = values.iter().position(outside) {
                let (value, line) = (with_unit(values[row], si), data.line(row));
                let reason = format!("{value} in line {line} is not {}", range(&known.spec, si));
                return Err(fault(reason, "correct the table, or the unit"));
            }
        }
        Ok(values)
    }

    /// The folder from which a file named here is meant.
    fn origin(&self, node: &Node) -> PathBuf {
        match node.origin {
            Origin::Argument(_) => PathBuf::new(),
            Origin::File { .. } => self.case.folder().to_owned(),
        }
    }

    /// The table of a file, read once; there is one.
    fn table(&mut self, file: &Path) -> Result<&DataTable, Option<Fault>> {
        let known = self.columns.table.as_ref().map(|(known, _)| known);
        if let Some(known) = known.filter(|known| *known != file) {
            return Err(Some(Fault {
                reason: format!(
                    "is of `{}`, and other columns are of `{}`",
                    file.display(),
                    known.display()
                ),
                fix: "put all columns into one file".to_owned(),
            }));
        }
        if known.is_none() {
            let table = DataTable::read(file, MOST_BYTES, Reading::NUMBERS);
            let fault = table.as_ref().err().map(|error| Fault {
                reason: format!("`{}` {error}", file.display()),
                fix: "give a header with the names of the columns, and lines of as many cells; \
                      docs/how-to/use-a-table.md has the format"
                    .to_owned(),
            });
            self.columns.table = Some((file.to_owned(), table.ok()));
            if fault.is_some() {
                return Err(fault);
            }
        }
        self.columns.table.as_ref().and_then(|(_, table)| table.as_ref()).ok_or(None)
    }

    /// Where the rows are in time, and whether they suit the kind of case; the histories of the case.
    pub(super) fn histories(&mut self) -> Option<Histories> {
        let Columns { mut values, names, table, incomplete } = std::mem::take(&mut self.columns);
        let mode = self.values.get("time.mode").and_then(Json::as_str).unwrap_or("steady");
        let (steady, rows) = (mode == "steady", mode == "sequence");
        for axis in [TIME, DISTANCE] {
            if self.values.has(axis) && !values.contains_key(axis) {
                self.fault(axis, "is a number, not a column of a table", FORM);
            }
        }
        if !self.live.is_empty() {
            return self.live_histories(!values.is_empty());
        }
        if incomplete {
            return None;
        }
        let varying = values.keys().find(|key| ![TIME, DISTANCE].contains(&key.as_str()));
        let Some(key) = varying.cloned() else {
            if rows {
                let reason =
                    "a sequence has the rows of a table, and no key of this case is a column";
                self.fault("time.mode", reason, FORM);
            }
            return None;
        };
        if steady {
            let reason = "is a column, and a steady case is one instant";
            let fix =
                "write time.mode = \"sequence\" for a steady contact of every row, or a number";
            self.fault(&key, reason, fix);
            return None;
        }
        let count = values[&key].len();
        let (time, distance) = (values.remove(TIME), values.remove(DISTANCE));
        let axis = if time.is_none() && distance.is_some() { DISTANCE } else { TIME };
        let along = time.as_ref().or(distance.as_ref());
        let (file, table) = table.and_then(|(file, table)| Some((file, table?)))?;
        if let Some(Err(error)) = along.map(|along| table.check_rising(&names[axis], along, rows)) {
            let reason = format!("`{}` {error}", file.display());
            self.fault(axis, reason, "sort the rows by time");
            return None;
        }
        let times = match (time, distance) {
            (Some(times), _) => times,
            (None, Some(distances)) => self.covered(&distances, values.get(SPEED), &table)?,
            (None, None) if rows => vec![0.0; count],
            (None, None) => {
                let reason = format!("missing; `{key}` is a column over time");
                self.fault(TIME, reason, "add `time.history = { file = ..., column = \"t\" }`");
                return None;
            }
        };
        if !rows {
            self.refuse_beyond(axis, &times);
        }
        let histories = Histories { rows, times, values, live: None };
        if let Err(why) = histories.check() {
            self.fault(axis, why, "sort the rows by time");
            return None;
        }
        Some(histories)
    }

    /// Refuses a run with a window outside its history, unless the case says that the values of the first and
    /// the last row hold there. A window has the values of its middle; that of an adaptive one is not known.
    fn refuse_beyond(&mut self, axis: &str, times: &[f64]) {
        let number = |key: &str| self.values.get(key).and_then(Json::as_f64);
        let word = |key: &str| self.values.get(key).and_then(Json::as_str);
        let (Some(window), Some(end)) = (number("time.window"), number("time.end")) else { return };
        let (Some(first), Some(last)) = (times.first(), times.last()) else { return };
        let before_last = (end / window * (1.0 - ROUNDING)).floor().max(0.0) * window;
        let [from, to] = match word("time.control") {
            Some("adaptive") => [0.0, end],
            _ => [0.5 * window, 0.5 * (before_last + end)],
        };
        let within = *first <= from + ROUNDING * end && *last >= to - ROUNDING * end;
        if word(BEYOND) != Some("hold") && !within {
            let reason =
                format!("the rows are from {first} to {last} s, and the run is from 0 to {end} s");
            let fix = format!(
                "extend the table, change time.end, or write {BEYOND} = \"hold\" to keep the values of the first and the last row"
            );
            self.fault(axis, reason, fix);
        }
    }

    /// The times at which distances are reached, with the mean of the speeds at both ends of every way.
    fn covered(
        &mut self,
        distances: &[f64],
        speeds: Option<&Vec<f64>>,
        table: &DataTable,
    ) -> Option<Vec<f64>> {
        let constant = self.values.get(SPEED).and_then(Json::as_f64).unwrap_or(0.0);
        let speed = |row: usize| speeds.map_or(constant, |speeds| speeds[row]);
        let mut times = vec![0.0];
        for row in 1..distances.len() {
            let mean = 0.5 * (speed(row - 1) + speed(row));
            let time = times[row - 1] + (distances[row] - distances[row - 1]) / mean;
            if !time.is_finite() {
                let reason =
                    format!("line {} of the table is reached at no speed", table.line(row));
                self.fault(DISTANCE, reason, format!("give a `{SPEED}` above 0 m/s, or {TIME}"));
                return None;
            }
            times.push(time);
        }
        Some(times)
    }
}

fn reference<'a>(table: &'a Table, folder: &Path) -> Result<Reference<'a>, Fault> {
    let text = |name: &str| match table.get(name).map(|node| &node.value) {
        Some(Value::Text(text)) => Ok(Some(text.as_str())),
        Some(_) => Err(Fault { reason: format!("`{name}` is no text"), fix: FORM.to_owned() }),
        None => Ok(None),
    };
    if let Some((name, _)) =
        table.entries.iter().find(|(name, _)| !ENTRIES.contains(&name.as_str()))
    {
        return Err(Fault { reason: format!("unknown key `{name}`"), fix: FORM.to_owned() });
    }
    let missing =
        |name: &str| Fault { reason: format!("`{name}` is missing"), fix: FORM.to_owned() };
    let file = text("file")?.ok_or_else(|| missing("file"))?;
    let column = text("column")?.ok_or_else(|| missing("column"))?;
    Ok(Reference { file: folder.join(file), column, unit: text("unit")? })
}
