//! Many points: the rows of a table.

use super::file::place;
use crate::fit::number;
use crate::output::print;
use run::error::{RunError, file_failure};
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;
use surrogate::Surrogate;

/// Prints the rows with the figures behind them. If one has no answer nothing is printed.
///
/// # Errors
/// [`RunError::Usage`] names the line that is no point of the surrogate; the file system.
pub(super) fn answer(surrogate: &Surrogate, rows: &Path) -> Result<(), RunError> {
    let mut reader =
        csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(open(rows)?);
    let wrong = |error: csv::Error| RunError::Usage(format!("--table {}: {error}", rows.display()));
    let places = columns(surrogate, reader.headers().map_err(wrong)?)?;
    let mut out = csv::Writer::from_writer(Vec::new());
    let keys = places.iter().map(|n| surrogate.keys()[*n].key.as_str());
    let figures = surrogate.figures().iter().map(|one| one.key.as_str());
    // A writer into memory does not fail.
    let _ = out.write_record(keys.chain(figures));
    let (mut at, mut room) = (vec![0.0; places.len()], surrogate.room());
    let (mut row, mut digits) = (csv::StringRecord::new(), Digits::default());
    while reader.read_record(&mut row).map_err(wrong)? {
        let named = |why: &dyn std::fmt::Display| {
            let line = row.position().map_or(0, csv::Position::line);
            RunError::Usage(format!("--table {}: line {line}: {why}", rows.display()))
        };
        for (n, text) in places.iter().zip(&row) {
            let key = &surrogate.keys()[*n];
            at[*n] = number(&key.key, text, &key.unit).map_err(|error| named(&error))?;
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

fn open(rows: &Path) -> Result<Box<dyn Read>, RunError> {
    if rows == Path::new("-") {
        return Ok(Box::new(io::stdin().lock()));
    }
    File::open(rows).map(|file| Box::new(file) as _).map_err(|error| file_failure(rows, &error))
}

/// The key of each column; every key has one.
fn columns(surrogate: &Surrogate, head: &csv::StringRecord) -> Result<Vec<usize>, RunError> {
    let places = head.iter().map(|key| place(surrogate, key)).collect::<Result<Vec<_>, _>>()?;
    for (n, key) in surrogate.keys().iter().enumerate() {
        let columns = places.iter().filter(|place| **place == n).count();
        if columns != 1 {
            let told = format!("{} has {columns} columns in the table; each key has one", key.key);
            return Err(RunError::Usage(told));
        }
    }
    Ok(places)
}

/// A number as text, in room that is used again.
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
