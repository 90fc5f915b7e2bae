//! The table of a sweep, a row a point, in two forms: `sweep.csv` to be looked at and read by anything, and
//! `sweep.parquet`, column by column, for analysis. Columns: the keys that vary, quantities by their keys in
//! `summary.json`, seconds, and why there is no answer.

use super::study::{Row, Study};
use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{Type, TypePtr};
use std::borrow::Cow;
use std::io::{self, Write};
use std::sync::Arc;

/// Rows that are in memory as columns at a time.
const GROUP: usize = 1 << 16;

/// A column: its name, and its cell in a row.
struct Column<'a> {
    name: &'a str,
    cells: Cells<'a>,
}

/// A number of a row.
type Number<'a> = Box<dyn Fn(&Row) -> Option<f64> + 'a>;

enum Cells<'a> {
    Numbers(Number<'a>),
    /// Why there is no answer.
    Failed,
    /// The value of a row at this place of its keys.
    Values(usize, &'a [String]),
}

/// Writes `sweep.csv`.
///
/// # Errors
/// It cannot be written.
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

/// A text that no spreadsheet program takes for a formula: one that begins as a formula does, and is no number,
/// gets an apostrophe before it.
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

/// Writes `sweep.parquet`: cells without a value are null, keys whose values are plain numbers are numbers.
///
/// # Errors
/// It cannot be written.
pub(super) fn parquet(study: &Study, out: &mut (impl Write + Send)) -> io::Result<()> {
    let columns = columns(study, true);
    let written = || -> Result<(), ParquetError> {
        let fields = columns.iter().map(Column::field).collect::<Result<_, _>>()?;
        let schema = Type::group_type_builder("sweep").with_fields(fields).build()?;
        let properties = WriterProperties::builder().set_dictionary_enabled(false).build();
        let mut file = SerializedFileWriter::new(out, Arc::new(schema), Arc::new(properties))?;
        for rows in study.rows.chunks(GROUP) {
            let mut group = file.next_row_group()?;
            columns.iter().try_for_each(|one| one.write(rows, &mut group))?;
            group.close()?;
        }
        file.close().map(drop)
    };
    written().map_err(io::Error::other)
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

impl Column<'_> {
    fn field(&self) -> Result<TypePtr, ParquetError> {
        let (physical, logical) = match &self.cells {
            Cells::Numbers(_) => (Physical::DOUBLE, None),
            Cells::Failed | Cells::Values(..) => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
        };
        let field = Type::primitive_type_builder(self.name, physical);
        field.with_logical_type(logical).with_repetition(Repetition::OPTIONAL).build().map(Arc::new)
    }

    fn write<W: Write + Send>(
        &self,
        rows: &[Row],
        group: &mut SerializedRowGroupWriter<'_, W>,
    ) -> Result<(), ParquetError> {
        let text = |text: &str| ByteArray::from(text.as_bytes().to_vec());
        match &self.cells {
            Cells::Numbers(of) => append::<DoubleType, W>(group, rows.iter().map(of)),
            Cells::Failed => {
                let cells = rows.iter().map(|row| row.failed.as_deref().map(text));
                append::<ByteArrayType, W>(group, cells)
            }
            Cells::Values(key, values) => {
                let cells =
                    rows.iter().map(|row| values.get(row.at[*key]).map(|value| text(value)));
                append::<ByteArrayType, W>(group, cells)
            }
        }
    }
}

/// Writes the next column of a group: the cells that there are, and for every cell whether there is one.
fn append<T: DataType, W: Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    cells: impl Iterator<Item = Option<T::T>>,
) -> Result<(), ParquetError> {
    let Some(mut column) = group.next_column()? else { return Ok(()) };
    let (mut there, mut values) = (Vec::new(), Vec::new());
    for cell in cells {
        there.push(i16::from(cell.is_some()));
        values.extend(cell);
    }
    column.typed::<T>().write_batch(&values, Some(&there), None)?;
    column.close()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::axis::Axis;
    use crate::study::quantity::Quantity;
    use contract::figure::Measure;
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field;

    fn study() -> Study {
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
            wall_s: 0.5,
        };
        study.rows.push(row([0, 0], &[1.0 / 3.0, 5e-324], None));
        study.rows.push(row([1, 0], &[], Some("no \"grip\", µ")));
        study
    }

    /// Values that a spreadsheet program would run as formulas are written as texts in CSV. Numbers
    /// stay numbers. The columnar file keeps all values as they are.
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
        let (mut study, mut text, mut columns) = (study(), Vec::new(), Vec::new());
        study.rows[1].failed = Some("=cmd".to_owned());
        csv(&study, &mut text).unwrap();
        assert!(String::from_utf8(text).unwrap().ends_with(",'=cmd\n"));
        parquet(&study, &mut columns).unwrap();
        let file = SerializedFileReader::new(bytes(columns)).unwrap();
        let row = file.get_row_iter(None).unwrap().nth(1).unwrap().unwrap();
        let last = row.get_column_iter().last().map(|(_, cell)| cell.clone());
        assert_eq!(last, Some(Field::Str("=cmd".to_owned())));
    }

    #[test]
    fn both_forms_hold_the_same_to_the_bit() {
        let (mut text, mut columns) = (Vec::new(), Vec::new());
        csv(&study(), &mut text).unwrap();
        parquet(&study(), &mut columns).unwrap();
        assert_eq!(
            String::from_utf8(text).unwrap(),
            format!(
                "motion.speed,load.normal_force,heat.rise_k,load.force_n,wall_s,failed\n\
                 10,60 kN,{},{},0.5,\n20,60 kN,,,0.5,\"no \"\"grip\"\", µ\"\n",
                1.0 / 3.0,
                5e-324
            )
        );
        let file = SerializedFileReader::new(bytes(columns)).unwrap();
        let rows: Vec<_> = file.get_row_iter(None).unwrap().map(Result::unwrap).collect();
        let cells =
            |n: usize| rows[n].get_column_iter().map(|(_, cell)| cell.clone()).collect::<Vec<_>>();
        let text = |text: &str| Field::Str(text.to_owned());
        let number = Field::Double;
        assert_eq!(
            cells(0),
            [
                number(10.0),
                text("60 kN"),
                number(1.0 / 3.0),
                number(5e-324),
                number(0.5),
                Field::Null
            ]
        );
        assert_eq!(
            cells(1),
            [
                number(20.0),
                text("60 kN"),
                Field::Null,
                Field::Null,
                number(0.5),
                text("no \"grip\", µ")
            ]
        );
    }

    /// A file that a reader can have.
    fn bytes(content: Vec<u8>) -> std::fs::File {
        use std::io::Seek;
        let mut file = tempfile::tempfile().unwrap();
        file.write_all(&content).unwrap();
        file.rewind().unwrap();
        file
    }
}
