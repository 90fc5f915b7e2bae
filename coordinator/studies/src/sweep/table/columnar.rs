//! The table as Parquet.

use super::{Cells, Column, columns};
use crate::sweep::study::{Row, Study};
use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{Type, TypePtr};
use std::io::{self, Write};
use std::sync::Arc;

/// Number of rows held in memory as columns at a time.
const GROUP: usize = 1 << 16;

/// Writes `sweep.parquet`. Missing values are null; keys whose values are plain numbers are written
/// as numbers.
///
/// # Errors
/// Writing fails.
pub(in crate::sweep) fn write(study: &Study, out: &mut (impl Write + Send)) -> io::Result<()> {
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

/// Writes the next column of a group: the present values, and a definition level for every cell.
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
    use crate::sweep::table::tests::study;
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field;

    /// Values are written unchanged, including text that looks like a formula. Missing values are
    /// null.
    #[test]
    fn values_are_written_to_the_bit() {
        let (mut study, mut columns) = (study(), Vec::new());
        study.rows[1].failed = Some("=cmd, µ".to_owned());
        write(&study, &mut columns).unwrap();
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
            [number(20.0), text("60 kN"), Field::Null, Field::Null, number(0.5), text("=cmd, µ")]
        );
    }

    /// Writes the content to a temporary file for the reader.
    fn bytes(content: Vec<u8>) -> std::fs::File {
        use std::io::Seek;
        let mut file = tempfile::tempfile().unwrap();
        file.write_all(&content).unwrap();
        file.rewind().unwrap();
        file
    }
}
