//! What the files of all data sets have in common.

use super::label;
use super::shown::{Fields, ShownKind};
use std::fmt::Write as _;
use std::io::{self, Write};

/// Opens a data set of this VTK type, with what is said of its fields and the time [s] of their
/// values.
pub(super) fn opening(data: &str, attributes: &str, fields: &Fields, time: f64) -> String {
    let table = label::table(fields);
    format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"{data}\" version=\"1.0\" \
         byte_order=\"LittleEndian\" header_type=\"UInt64\">\n  <{data}{attributes}>\n    \
         <FieldData>\n      <DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" \
         format=\"ascii\">{time:e}</DataArray>\n{table}    </FieldData>\n"
    )
}

/// The arrays of cell data, appended from `offset` bytes on, and the end of the data set.
pub(super) fn cell_data(data: &str, fields: &Fields, cells: usize, offset: usize) -> String {
    values_of("CellData", data, fields, cells, offset)
}

/// The same of values that belong to points.
pub(super) fn point_data(data: &str, fields: &Fields, points: usize, offset: usize) -> String {
    values_of("PointData", data, fields, points, offset)
}

fn values_of(what: &str, data: &str, fields: &Fields, count: usize, mut offset: usize) -> String {
    let mut text = format!("      <{what}>\n");
    for (kind, _) in fields {
        let components = components(kind);
        let (name, unit) = (label::escape(&label::array_name(kind)), label::unit(kind));
        let _ = writeln!(
            text,
            "        <DataArray type=\"Float64\" Name=\"{name}\" \
             NumberOfComponents=\"{components}\" format=\"appended\" offset=\"{offset}\">\n          \
             {unit}\n        </DataArray>"
        );
        offset += 8 + 8 * components * count;
    }
    text + "      </"
        + what
        + ">\n    </Piece>\n  </"
        + data
        + ">\n  \
            <AppendedData encoding=\"raw\">\n_"
}

/// The values of all fields, cell by cell in this order of the grid's elements, and the end of the
/// file.
pub(super) fn write_values(
    out: &mut impl Write,
    fields: &Fields,
    order: impl ExactSizeIterator<Item = usize> + Clone,
) -> io::Result<()> {
    let points = order.len();
    for (kind, values) in fields {
        let components = components(kind);
        out.write_all(&(8 * (components * points) as u64).to_le_bytes())?;
        for point in order.clone() {
            for component in 0..components {
                let value = values.get(component * points + point).copied().unwrap_or(0.0);
                out.write_all(&value.to_le_bytes())?;
            }
        }
    }
    out.write_all(b"\n  </AppendedData>\n</VTKFile>\n")
}

/// Components in the file: a vector of the plane becomes one of space.
fn components(kind: &ShownKind) -> usize {
    if kind.components == 2 { 3 } else { kind.components as usize }
}
