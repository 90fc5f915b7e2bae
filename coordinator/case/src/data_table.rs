//! A table of data: a text of columns separated by commas, with a line of their names first, each perhaps
//! with its unit (`Q [kN]`), and comments from `#`.

use super::quantity::parse_quantity;
use super::suggest::{all_of, nearest};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Larger files are refused.
const MOST_BYTES: u64 = 1 << 30;

/// The columns that a case refers to.
#[derive(Clone, Debug, Default)]
pub(super) struct Columns {
    /// The table that was read.
    pub(super) table: Option<(PathBuf, DataTable)>,
    /// Values in SI units by key, in the order of the rows.
    pub(super) values: BTreeMap<String, Vec<f64>>,
}

/// A table of numbers.
#[derive(Clone, Debug)]
pub(super) struct DataTable {
    /// Name and unit of each column.
    names: Vec<(String, Option<String>)>,
    /// Row by row.
    rows: Vec<Vec<f64>>,
}

impl DataTable {
    /// Reads a file.
    pub(super) fn read(path: &Path) -> Result<Self, String> {
        let found = std::fs::metadata(path).map_err(|error| format!("cannot be read: {error}"))?;
        if !found.is_file() {
            return Err("is no file".to_owned());
        }
        let bytes = found.len();
        if bytes > MOST_BYTES {
            return Err(format!("has {bytes} bytes, more than a table may"));
        }
        let text = std::fs::read(path).map_err(|error| format!("cannot be read: {error}"))?;
        Self::parse(&text)
    }

    fn parse(text: &[u8]) -> Result<Self, String> {
        let mut reader =
            csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(text);
        let wrong = |error: &csv::Error| format!("is no table: {error}");
        let names = reader.headers().map_err(|error| wrong(&error))?.iter().map(name_and_unit);
        let names: Vec<_> = names.collect();
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|error| wrong(&error))?;
            let line = record.position().map_or(0, csv::Position::line);
            let number = |(column, text): (usize, &str)| {
                let value = text.parse().ok().filter(|value: &f64| value.is_finite());
                value.ok_or_else(|| {
                    let name = &names[column].0;
                    format!("has no number in column `{name}` of line {line}, but {text:?}")
                })
            };
            rows.push(record.iter().enumerate().map(number).collect::<Result<Vec<f64>, _>>()?);
        }
        if rows.is_empty() {
            return Err("has no rows".to_owned());
        }
        Ok(Self { names, rows })
    }

    /// A column in the unit `si`; `unit` is that of the case, or else its head has one. Or what is wrong,
    /// and what to do.
    pub(super) fn column(
        &self,
        name: &str,
        unit: Option<&str>,
        si: &str,
    ) -> Result<Vec<f64>, (String, String)> {
        let names = || self.names.iter().map(|(name, _)| name.as_str());
        let Some(index) = names().position(|known| known == name) else {
            let near = nearest(name, names());
            let near = near.map(|near| format!("; did you mean `{near}`?")).unwrap_or_default();
            let listed: Vec<String> = names().map(|name| format!("`{name}`")).collect();
            let reason = format!("there is no column `{name}`{near}");
            return Err((reason, format!("name one of {}", all_of(&listed))));
        };
        let unit = unit.or(self.names[index].1.as_deref());
        let in_si = |value: &f64| match unit {
            None => Ok(*value),
            Some(unit) => parse_quantity(&format!("{value:e} {unit}"), si),
        };
        let values = self.rows.iter().map(|row| in_si(&row[index])).collect::<Result<Vec<_>, _>>();
        values.map_err(|error| (error.to_string(), format!("give a unit that {si} can be made of")))
    }
}

/// "Q [kN]" is the column `Q` in kN.
fn name_and_unit(header: &str) -> (String, Option<String>) {
    match header.strip_suffix(']').and_then(|rest| rest.rsplit_once('[')) {
        Some((name, unit)) => (name.trim().to_owned(), Some(unit.trim().to_owned())),
        None => (header.to_owned(), None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn column(text: &str, name: &str, unit: Option<&str>, si: &str) -> Result<Vec<f64>, String> {
        let table = DataTable::parse(text.as_bytes())?;
        table.column(name, unit, si).map_err(|(reason, fix)| format!("{reason}: {fix}"))
    }

    const TABLE: &str = "# measured\nt [s], Q [kN], xi\n0, 80, -0.001\n0.1, 90.5, 2e-3\n";

    #[test]
    fn columns_have_the_unit_of_their_head_or_of_the_case() {
        assert_eq!(column(TABLE, "Q", None, "N"), Ok(vec![80e3, 90.5e3]));
        assert_eq!(column(TABLE, "Q", Some("N"), "N"), Ok(vec![80.0, 90.5]));
        assert_eq!(column(TABLE, "xi", None, "1"), Ok(vec![-0.001, 0.002]));
    }

    #[test]
    fn faults_name_what_is_wrong() {
        let fault = |text: &str, name: &str, si: &str| column(text, name, None, si).unwrap_err();
        assert!(fault(TABLE, "q", "N").contains("did you mean `Q`?"));
        assert!(fault(TABLE, "Q", "m").contains("kN"));
        assert!(fault("a,b\n1,x\n", "a", "1").contains("column `b` of line 2"));
        assert!(fault("a,b\n1\n", "a", "1").contains("is no table"));
        assert!(fault("a,b\n", "a", "1").contains("has no rows"));
        assert!(fault("a\nNaN\n", "a", "1").contains("no number"));
    }

    proptest! {
        #[test]
        fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            let _ = DataTable::parse(&bytes);
        }
    }
}
