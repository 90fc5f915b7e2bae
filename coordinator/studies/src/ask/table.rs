//! Evaluation of a surrogate at the rows of a table.

use super::file::place;
use crate::fit::number;
use case::parse_quantity;
use console::output::print;
use contract::input_file::into_text;
use contract::table::{Heading, Reading, Table, TableError};
use run::error::{RunError, file_failure};
use std::io::{self, Read as _};
use std::path::Path;
use surrogate::Surrogate;

/// Size above which a table is refused [byte].
const MOST_BYTES: u64 = 1 << 30;

/// Prints the rows, each followed by its figures. Nothing is printed if any row is invalid.
///
/// # Errors
/// [`RunError::Usage`] with the line that is not a point of the surrogate; an input error if the
/// file cannot be read.
pub(super) fn answer(surrogate: &Surrogate, rows: &Path) -> Result<(), RunError> {
    let table = read(rows)?;
    let headings = table.headings().unwrap_or_default();
    let places = columns(surrogate, headings)?;
    let mut out = csv::Writer::from_writer(Vec::new());
    let keys = places.iter().map(|n| surrogate.keys()[*n].key.as_str());
    let figures = surrogate.figures().iter().map(|one| one.key.as_str());
    // Writing to memory cannot fail.
    let _ = out.write_record(keys.chain(figures));
    let (mut at, mut room) = (vec![0.0; places.len()], surrogate.room());
    let mut digits = Digits::default();
    for row in 0..table.rows() {
        let named = |why: &dyn std::fmt::Display| {
            let line = table.line(row);
            RunError::Usage(format!("--table {}: line {line}: {why}", rows.display()))
        };
        for ((n, heading), text) in places.iter().zip(headings).zip(table.words(row)) {
            let key = &surrogate.keys()[*n];
            at[*n] = match &heading.unit {
                Some(unit) => parse_quantity(&format!("{text} {unit}"), &key.unit)
                    .map_err(|error| named(&error))?,
                None => number(&key.key, &text, &key.unit).map_err(|error| named(&error))?,
            };
        }
        let values = surrogate.ask(&at, &mut room).map_err(|refused| named(&refused))?;
        for value in places.iter().map(|n| at[*n]).chain(values.iter().copied()) {
            let _ = out.write_field(digits.of(value));
        }
        let _ = out.write_record(None::<&[u8]>);
    }
    let text = out.into_inner().unwrap_or_default();
    print(&String::from_utf8_lossy(&text))
}

/// Reads the table from a file or from standard input.
fn read(rows: &Path) -> Result<Table, RunError> {
    let table = if rows == Path::new("-") {
        let mut bytes = Vec::new();
        let read = io::stdin().lock().take(MOST_BYTES).read_to_end(&mut bytes);
        read.map_err(|error| file_failure(rows, &error))?;
        into_text(bytes)
            .map_err(TableError::File)
            .and_then(|text| Table::parse(text, Reading::WORDS))
    } else {
        Table::read(rows, MOST_BYTES, Reading::WORDS)
    };
    let wrong =
        |why: &dyn std::fmt::Display| RunError::Usage(format!("--table {}: {why}", rows.display()));
    let table = table.map_err(|error| wrong(&error))?;
    match table.headings().unwrap_or_default().iter().all(Heading::is_dotted_key) {
        true => Ok(table),
        false => Err(wrong(&"its first line is not a list of keys of a case")),
    }
}

/// Key of each column; every key must have exactly one column.
fn columns(surrogate: &Surrogate, head: &[Heading]) -> Result<Vec<usize>, RunError> {
    let places = head.iter().map(|one| place(surrogate, &one.name));
    let places = places.collect::<Result<Vec<_>, _>>()?;
    for (n, key) in surrogate.keys().iter().enumerate() {
        let columns = places.iter().filter(|place| **place == n).count();
        if columns != 1 {
            let told = format!("{} has {columns} columns in the table; each key has one", key.key);
            return Err(RunError::Usage(told));
        }
    }
    Ok(places)
}

/// Formats numbers in a reused buffer.
#[derive(Default)]
struct Digits(String);

impl Digits {
    fn of(&mut self, value: f64) -> &str {
        use std::fmt::Write as _;
        self.0.clear();
        let _ = write!(self.0, "{value}");
        &self.0
    }
}
