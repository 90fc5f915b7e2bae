//! The table of a sweep, one row per point, in two formats: `sweep.csv`, and `sweep.parquet` in
//! builds with the feature `parquet`. Columns: the varied keys, the quantities by their keys in
//! `summary.json`, the time of the run, and the reason for a missing result.

#[cfg(feature = "parquet")]
pub(super) mod columnar;

use super::study::{Row, Study};
use std::borrow::Cow;
use std::io::{self, Write};

/// A column: its name, and its cells.
struct Column<'a> {
    name: &'a str,
    cells: Cells<'a>,
}

/// A function that returns a number of a row.
type Number<'a> = Box<dyn Fn(&Row) -> Option<f64> + 'a>;

enum Cells<'a> {
    Numbers(Number<'a>),
    /// Reason for a missing result.
    Failed,
    /// Value of the varied key with this index.
    Values(usize, &'a [String]),
}

/// Writes `sweep.csv`.
///
/// # Errors
/// Writing fails.
pub(super) fn csv(study: &Study, out: &mut impl Write) -> io::Result<()> {
    let columns = columns(study, false);
    let mut out = csv::Writer::from_writer(out);
    out.write_record(columns.iter().map(|one| one.name))?;
    for row in &study.rows {
        for one in &columns {
            match &one.cells {
                Cells::Numbers(of) => {
                    out.write_field(of(row).map(|value| value.to_string()).unwrap_or_default())?;
                }
                Cells::Failed => {
                    out.write_field(&*inert(row.failed.as_deref().unwrap_or_default()))?;
                }
                Cells::Values(key, values) => out.write_field(&*inert(&values[row.at[*key]]))?,
            }
        }
        out.write_record(None::<&[u8]>)?;
    }
    out.flush()
}

/// Escapes text that a spreadsheet program would take for a formula, by putting an apostrophe
/// before it. Numbers stay unchanged.
fn inert(text: &str) -> Cow<'_, str> {
    let number = || {
        text.starts_with(['+', '-'])
            && text[1..].starts_with(|c: char| c.is_ascii_digit() || c == '.')
    };
    match text.starts_with(['=', '@', '+', '-', '\t', '\r']) && !number() {
        true => Cow::Owned(format!("'{text}")),
        false => Cow::Borrowed(text),
    }
}

fn columns(study: &Study, numbers: bool) -> Vec<Column<'_>> {
    let keys = study.vary.iter().enumerate().map(|(n, one)| {
        let plain = one.numbers().filter(|(_, unit)| numbers && unit.is_empty());
        let cells = match plain {
            Some((places, _)) => {
                Cells::Numbers(Box::new(move |row| places.get(row.at[n]).copied()))
            }
            None => Cells::Values(n, &one.values),
        };
        Column { name: &one.key, cells }
    });
    let quantities = study.quantities.iter().enumerate().map(|(n, one)| Column {
        name: &one.key,
        cells: Cells::Numbers(Box::new(move |row| row.value(n))),
    });
    let wall = Column { name: "wall_s", cells: Cells::Numbers(Box::new(|row| Some(row.wall_s))) };
    let failed = Column { name: "failed", cells: Cells::Failed };
    keys.chain(quantities).chain([wall, failed]).collect()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::study::axis::Axis;
    use crate::study::quantity::Quantity;
    use contract::figure::Measure;

    pub(crate) fn study() -> Study {
        let vary =
            ["motion.speed=10,20", "load.normal_force=60 kN"].map(|text| Axis::read(text).unwrap());
        let quantity = |key: &str| Quantity::new(key, key, Measure::Relative);
        let head = serde_json::json!({
            "schema": 3, "complete": true, "case": "c", "title": null, "file": "c.toml", "options": [],
            "identity": {"programs": {}, "values": {}, "files": {}},
            "vary": vary, "drawn": [], "quantities": [quantity("heat.rise_k"), quantity("load.force_n")],
            "wall_s": 0.0
        });
        let mut study: Study = serde_json::from_value(head).unwrap();
        let row = |at: [usize; 2], values: &[f64], failed: Option<&str>| Row {
            at: at.to_vec(),
            values: values.to_vec(),
            failed: failed.map(str::to_owned),
            warnings: Vec::new(),
            wall_s: 0.5,
        };
        study.rows.push(row([0, 0], &[1.0 / 3.0, 5e-324], None));
        study.rows.push(row([1, 0], &[], Some("no \"grip\", µ")));
        study
    }

    /// Text that a spreadsheet program would run as a formula is escaped. Numbers stay numbers.
    #[test]
    fn a_formula_is_written_as_a_text() {
        for (text, written) in [
            ("=1+1", "'=1+1"),
            ("@SUM(A1)", "'@SUM(A1)"),
            ("+A1", "'+A1"),
            ("-A1", "'-A1"),
            ("\t=1", "'\t=1"),
            ("-5", "-5"),
            ("+.5 kN", "+.5 kN"),
            ("60 kN", "60 kN"),
            ("a=b", "a=b"),
            ("", ""),
        ] {
            assert_eq!(inert(text), written);
        }
        let (mut study, mut text) = (study(), Vec::new());
        study.rows[1].failed = Some("=cmd".to_owned());
        csv(&study, &mut text).unwrap();
        assert!(String::from_utf8(text).unwrap().ends_with(",'=cmd\n"));
    }

    #[test]
    fn numbers_are_written_to_the_bit() {
        let mut text = Vec::new();
        csv(&study(), &mut text).unwrap();
        assert_eq!(
            String::from_utf8(text).unwrap(),
            format!(
                "motion.speed,load.normal_force,heat.rise_k,load.force_n,wall_s,failed\n\
                 10,60 kN,{},{},0.5,\n20,60 kN,,,0.5,\"no \"\"grip\"\", µ\"\n",
                1.0 / 3.0,
                5e-324
            )
        );
    }

    /// Figures that do not change are hidden only beside others that do.
    #[test]
    fn a_sweep_of_one_point_shows_its_figures() {
        let mut study = study();
        let shown = |study: &Study| study.found().map(|(column, _)| column).collect::<Vec<_>>();
        assert_eq!(shown(&study), [0, 1]);
        study.rows.push(Row { values: vec![2.0 / 3.0, 5e-324], ..study.rows[0].clone() });
        assert_eq!(shown(&study), [0]);
    }
}
