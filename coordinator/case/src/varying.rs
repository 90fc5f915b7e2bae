//! Varying values in place of numbers:
//!
//! - a column of a table, `{ file = "run.csv", column = "Q", unit = "kN" }`;
//! - a live value, set from outside during the run,
//!   `{ at = "134 kN", from = "60 kN", to = "140 kN" }`.
//!
//! All columns of a case come from one table ([`contract::table`]). One of them, `time.history` or
//! `time.distance`, gives the times of its rows.

use super::check::{Fault, check, in_range, range, with_unit};
use super::checked_keys::{CheckedKeys, Columns, LIVE_ENTRIES, LiveKey, put};
use super::filled_case::FilledCase;
use super::known::KnownKey;
use super::schema::{BEYOND, DISTANCE, TIME};
use super::settings::{Beyond, Lengths, TimeMode};
use super::tree::{Node, Origin, Table, Value};
use contract::description::KeyKind;
use contract::grid::check_dotted;
use contract::history::Histories;
use contract::live::Live;
use contract::table::{Reading, Table as DataTable, TableError};
use serde_json::Value as Json;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Key of the speed that converts distances to times.
const SPEED: &str = "motion.speed";
/// Entries of a reference to a column.
const COLUMN_ENTRIES: [&str; 3] = ["file", "column", "unit"];
/// Form of a reference, for messages.
const COLUMN_FORM: &str = "write { file = \"run.csv\", column = \"Q\", unit = \"kN\" }";
/// Largest table file [byte].
const MOST_BYTES: u64 = 1 << 30;
/// Fraction of the run by which a window may lie outside its history: rounding of decimal times.
const ROUNDING: f64 = 1e-9;

/// Form of a live value, for messages.
const LIVE_FORM: &str = "write { at = \"134 kN\", from = \"60 kN\", to = \"140 kN\" }";

/// A reference to a column of a table.
struct Reference<'a> {
    file: PathBuf,
    column: &'a str,
    unit: Option<&'a str>,
}

impl CheckedKeys<'_> {
    /// Reads a table at a numeric key as a reference to a column of a data file.
    pub(super) fn column(
        &mut self,
        key: &str,
        node: &Node,
        table: &Table,
        readers: &[&KnownKey<'_>],
    ) {
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
                    self.faults.at(key, reason, fix);
                }
            }
        }
    }

    /// Reads the values of a column. Returns its fault, unless the table has already been reported.
    fn read_column(
        &mut self,
        node: &Node,
        table: &Table,
        readers: &[&KnownKey<'_>],
    ) -> Result<Vec<f64>, Option<Fault>> {
        let fault = |reason: String, fix: &str| Some(Fault { reason, fix: fix.to_owned() });
        let active: Vec<&&KnownKey<'_>> = readers.iter().filter(|known| known.active).collect();
        let readers = if active.is_empty() { readers.iter().collect() } else { active };
        if let Some(constant) = readers.iter().find(|known| !known.spec.varies) {
            let reason = format!("is a column, and {} accepts only a number", constant.owner);
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
                TableError::Unit { .. } => format!("give a unit that converts to {si}"),
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

    /// Returns the folder against which a file name is resolved.
    fn origin(&self, node: &Node) -> PathBuf {
        match node.origin {
            Origin::Argument(_) => PathBuf::new(),
            Origin::File { .. } => self.scope.case.folder().to_owned(),
        }
    }

    /// Returns the table of a file, read once. A case has only one table.
    fn table(&mut self, file: &Path) -> Result<&DataTable, Option<Fault>> {
        let known = self.columns.table.as_ref().map(|(known, _)| known);
        if let Some(known) = known.filter(|known| *known != file) {
            return Err(Some(Fault {
                reason: format!(
                    "is from `{}`, and other columns are from `{}`",
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

    /// Reads a table at a numeric key as a live value.
    pub(super) fn live(
        &mut self,
        key: &str,
        node: &Node,
        table: &Table,
        readers: &[&KnownKey<'_>],
    ) {
        match self.read_live(key, table, readers) {
            Ok(live) => {
                put(&mut self.values.0, key, Json::from(live.first));
                self.live.insert(key.to_owned(), live);
            }
            Err(Fault { reason, fix }) => self.faults.at_name(node, key, reason, fix),
        }
    }

    fn read_live(
        &self,
        key: &str,
        table: &Table,
        readers: &[&KnownKey<'_>],
    ) -> Result<LiveKey, Fault> {
        let fault = |reason: String, fix: &str| Fault { reason, fix: fix.to_owned() };
        let active: Vec<&&KnownKey<'_>> = readers.iter().filter(|known| known.active).collect();
        let readers = if active.is_empty() { readers.iter().collect() } else { active };
        if let Some(constant) = readers.iter().find(|known| !known.spec.varies) {
            let reason = format!("is a live value, and {} accepts only a number", constant.owner);
            return Err(fault(reason, "write a number"));
        }
        let Some((known, KeyKind::Quantity { unit })) =
            readers.first().map(|known| (known, &known.spec.kind))
        else {
            return Err(fault("is a table, not a value".to_owned(), "write a value"));
        };
        if let Some((name, _)) =
            table.entries.iter().find(|(name, _)| !LIVE_ENTRIES.contains(&name.as_str()))
        {
            return Err(fault(format!("unknown key `{name}` of a live value"), LIVE_FORM));
        }
        let value = |name: &str| {
            let node = table.get(name);
            let node = node.ok_or_else(|| fault(format!("`{name}` is missing"), LIVE_FORM))?;
            let mut value = Json::Null;
            for known in &readers {
                value = check(known, node, self.scope.case.folder()).map_err(
                    |Fault { reason, fix }| Fault { reason: format!("`{name}` {reason}"), fix },
                )?;
            }
            value.as_f64().ok_or_else(|| fault(format!("`{name}` is not a number"), LIVE_FORM))
        };
        let [first, least, most] = [value("at")?, value("from")?, value("to")?];
        if !(least <= first && first <= most) {
            let [first, least, most] = [first, least, most].map(|value| with_unit(value, unit));
            let reason = format!("{first} is not between {least} and {most}");
            return Err(fault(
                reason,
                "write limits that enclose the first value, the lower one as `from`",
            ));
        }
        let field = Live::field(key, unit, &known.spec.help);
        check_dotted("live value's", &field.name)
            .map_err(|reason| fault(reason, "write a number"))?;
        Ok(LiveKey { field, first, limits: [least, most] })
    }
}

impl FilledCase<'_> {
    /// Returns the histories of the case. Checks the times of the rows, and that histories suit the
    /// kind of case.
    pub(super) fn histories(&mut self) -> Option<Histories> {
        let Columns { mut values, names, table, incomplete } = std::mem::take(&mut self.columns);
        let mode = self.scope.selection.timing;
        let (steady, rows) = (mode == TimeMode::Steady, mode == TimeMode::Sequence);
        for axis in [TIME, DISTANCE] {
            if self.values.has(axis) && !values.contains_key(axis) {
                self.faults.at(axis, "is a number, not a column of a table", COLUMN_FORM);
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
                self.faults.at("time.mode", reason, COLUMN_FORM);
            }
            return None;
        };
        if steady {
            let reason = "is a column, and a steady case has a single instant";
            let fix =
                "write time.mode = \"sequence\" for a steady contact in every row, or a number";
            self.faults.at(&key, reason, fix);
            return None;
        }
        let count = values[&key].len();
        let (time, distance) = (values.remove(TIME), values.remove(DISTANCE));
        let axis = if time.is_none() && distance.is_some() { DISTANCE } else { TIME };
        let along = time.as_ref().or(distance.as_ref());
        let (file, table) = table.and_then(|(file, table)| Some((file, table?)))?;
        // A vehicle at rest stays at its place. Two rows at one time are a slip.
        let may_stay = rows && axis == DISTANCE;
        let order = along.map(|along| table.check_rising(&names[axis], along, may_stay));
        if let Some(Err(error)) = order {
            let reason = format!("`{}` {error}", file.display());
            self.faults.at(axis, reason, "sort the rows by time");
            return None;
        }
        let times = match (time, distance) {
            (Some(times), _) => times,
            (None, Some(distances)) => self.covered(&distances, values.get(SPEED), &table)?,
            (None, None) if rows => vec![0.0; count],
            (None, None) => {
                let reason = format!("missing; `{key}` is a column over time");
                self.faults.at(TIME, reason, "add `time.history = { file = ..., column = \"t\" }`");
                return None;
            }
        };
        if !rows {
            self.refuse_beyond(axis, &times);
        }
        let histories = Histories { rows, times, values, live: None };
        if let Err(why) = histories.check() {
            self.faults.at(axis, why, "sort the rows by time");
            return None;
        }
        Some(histories)
    }

    /// Refuses a run with a window outside its history, unless the case holds the values of the
    /// first and the last row there. A window takes the values at its middle; an adaptive window
    /// has no known middle.
    fn refuse_beyond(&mut self, axis: &str, times: &[f64]) {
        let number = |key: &str| self.values.get(key).and_then(Json::as_f64);
        let word = |key: &str| self.values.get(key).and_then(Json::as_str);
        let (Some(window), Some(end)) = (number("time.window"), number("time.end")) else { return };
        let (Some(first), Some(last)) = (times.first(), times.last()) else { return };
        let before_last = (end / window * (1.0 - ROUNDING)).floor().max(0.0) * window;
        let [from, to] = match word("time.control") {
            Some(word) if word == Lengths::Adaptive.word() => [0.0, end],
            _ => [0.5 * window, 0.5 * (before_last + end)],
        };
        let within = *first <= from + ROUNDING * end && *last >= to - ROUNDING * end;
        if word(BEYOND) != Some(Beyond::Hold.word()) && !within {
            let reason =
                format!("the rows are from {first} to {last} s, and the run is from 0 to {end} s");
            let fix = format!(
                "extend the table, change time.end, or write {BEYOND} = \"hold\" to keep the values of the first and the last row"
            );
            self.faults.at(axis, reason, fix);
        }
    }

    /// Returns the times at which distances are reached. The speed between two rows is the mean of
    /// their speeds.
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
                    format!("line {} of the table is reached at zero speed", table.line(row));
                self.faults.at(
                    DISTANCE,
                    reason,
                    format!("give a `{SPEED}` above 0 m/s, or {TIME}"),
                );
                return None;
            }
            times.push(time);
        }
        Some(times)
    }

    /// Returns the histories of a case with live values, which excludes other varying values.
    fn live_histories(&mut self, columns: bool) -> Option<Histories> {
        let key = self.live.keys().next()?.clone();
        let mode = self.scope.selection.timing;
        let steady = mode == TimeMode::Steady;
        if columns {
            let reason = "is a live value, and other keys are columns of a table";
            self.faults.at(&key, reason, "make all of them live, or all of them columns");
        } else if mode == TimeMode::Sequence {
            let reason = "is a live value, and a sequence has the rows of a table";
            let fix =
                "write time.mode = \"steady\": driven from outside it is a row for every window";
            self.faults.at(&key, reason, fix);
        } else if self.live.len() > Live::MOST {
            let (found, most) = (self.live.len(), Live::MOST);
            let reason = format!("one of {found} live values, at most {most} are allowed");
            self.faults.at(&key, reason, "write numbers for some of them");
        } else {
            let keys = self.live.iter().map(|(key, live)| (key.clone(), (live.first, live.limits)));
            return Some(Histories::live(steady, &keys.collect::<BTreeMap<_, _>>()));
        }
        None
    }
}

fn reference<'a>(table: &'a Table, folder: &Path) -> Result<Reference<'a>, Fault> {
    let text = |name: &str| match table.get(name).map(|node| &node.value) {
        Some(Value::Text(text)) => Ok(Some(text.as_str())),
        Some(_) => {
            Err(Fault { reason: format!("`{name}` is not a text"), fix: COLUMN_FORM.to_owned() })
        }
        None => Ok(None),
    };
    if let Some((name, _)) =
        table.entries.iter().find(|(name, _)| !COLUMN_ENTRIES.contains(&name.as_str()))
    {
        return Err(Fault { reason: format!("unknown key `{name}`"), fix: COLUMN_FORM.to_owned() });
    }
    let missing =
        |name: &str| Fault { reason: format!("`{name}` is missing"), fix: COLUMN_FORM.to_owned() };
    let file = text("file")?.ok_or_else(|| missing("file"))?;
    let column = text("column")?.ok_or_else(|| missing("column"))?;
    Ok(Reference { file: folder.join(file), column, unit: text("unit")? })
}
