//! Columns of tables in the place of numbers: `{ file = "run.csv", column = "Q", unit = "kN" }`.
//!
//! All columns of a case come from one table; one of them, `time.history` or `time.distance`, says where
//! its rows are in time.

use super::check::Fault;
use super::checker::{Checker, put};
use super::data_table::{Columns, DataTable};
use super::example::{in_range, range, with_unit};
use super::known::Known;
use super::schema::{DISTANCE, TIME};
use super::tree::{Node, Origin, Table, Value};
use contract::description::KeyKind;
use contract::history::Histories;
use serde_json::Value as Json;
use std::path::{Path, PathBuf};

/// The speed with which a distance is covered.
const SPEED: &str = "motion.speed";
/// What a reference to a column may say.
const ENTRIES: [&str; 3] = ["file", "column", "unit"];
/// How a reference is written.
const FORM: &str = "write { file = \"run.csv\", column = \"Q\", unit = \"kN\" }";

/// Which column a key is, as the case says.
struct Reference<'a> {
    file: PathBuf,
    column: &'a str,
    unit: Option<&'a str>,
}

impl Checker<'_> {
    /// A table at a key that takes a number: a column of a table of data.
    pub(super) fn column(&mut self, key: &str, node: &Node, table: &Table, readers: &[&Known]) {
        match self.read_column(node, table, readers) {
            Ok(values) => {
                put(&mut self.values.0, key, Json::from(values[0]));
                self.columns.values.insert(key.to_owned(), values);
            }
            Err(Fault { reason, fix }) => self.fault(key, reason, fix),
        }
    }

    fn read_column(
        &mut self,
        node: &Node,
        table: &Table,
        readers: &[&Known],
    ) -> Result<Vec<f64>, Fault> {
        let fault = |reason: String, fix: &str| Fault { reason, fix: fix.to_owned() };
        let active: Vec<&&Known> = readers.iter().filter(|known| known.active).collect();
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
        let values = data.column(reference.column, reference.unit, si);
        let values = values.map_err(|(reason, fix)| Fault { reason, fix })?;
        for known in readers {
            let outside = |value: &f64| !in_range(&known.spec, *value);
            if let Some(row) = values.iter().position(outside) {
                let value = with_unit(values[row], si);
                let reason =
                    format!("{value} in row {} is not {}", row + 1, range(&known.spec, si));
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
    fn table(&mut self, file: &Path) -> Result<&DataTable, Fault> {
        match &self.columns.table {
            Some((known, _)) if known != file => {
                let (known, file) = (known.display(), file.display());
                return Err(Fault {
                    reason: format!("is of `{file}`, and other columns are of `{known}`"),
                    fix: "put all columns into one file".to_owned(),
                });
            }
            Some(_) => {}
            None => {
                let table = DataTable::read(file).map_err(|why| Fault {
                    reason: format!("`{}` {why}", file.display()),
                    fix:
                        "give lines of numbers separated by commas, the names of the columns first"
                            .to_owned(),
                })?;
                self.columns.table = Some((file.to_owned(), table));
            }
        }
        let (_, table) = self.columns.table.as_ref().expect("a table was just read");
        Ok(table)
    }

    /// Where the rows are in time, and whether they suit the kind of case; the histories of the case.
    pub(super) fn histories(&mut self) -> Option<Histories> {
        let Columns { mut values, .. } = std::mem::take(&mut self.columns);
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
        let times = match (time, distance) {
            (Some(times), _) => times,
            (None, Some(distances)) => self.covered(&distances, values.get(SPEED))?,
            (None, None) if rows => vec![0.0; count],
            (None, None) => {
                let reason = format!("missing; `{key}` is a column over time");
                self.fault(TIME, reason, "add `time.history = { file = ..., column = \"t\" }`");
                return None;
            }
        };
        let histories = Histories { rows, times, values, live: None };
        if let Err(why) = histories.check() {
            self.fault(TIME, why, "sort the rows by time");
            return None;
        }
        Some(histories)
    }

    /// The times at which distances are reached, with the mean of the speeds at both ends of every way.
    fn covered(&mut self, distances: &[f64], speeds: Option<&Vec<f64>>) -> Option<Vec<f64>> {
        let constant = self.values.get(SPEED).and_then(Json::as_f64).unwrap_or(0.0);
        let speed = |row: usize| speeds.map_or(constant, |speeds| speeds[row]);
        let mut times = vec![0.0];
        for row in 1..distances.len() {
            let mean = 0.5 * (speed(row - 1) + speed(row));
            let time = times[row - 1] + (distances[row] - distances[row - 1]) / mean;
            if !time.is_finite() {
                let reason = format!("row {} is reached at no speed", row + 1);
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
