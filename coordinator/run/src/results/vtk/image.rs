//! Structured grids as image data.

use super::file::{cell_data, opening, write_values};
use super::shown::Fields;
use crate::results::cells::Cells;
use std::io::{self, Write};

/// Writes the whole file.
pub(super) fn write(
    cells: &Cells,
    out: &mut impl Write,
    fields: &Fields,
    time: f64,
) -> io::Result<()> {
    let [nx, ny, nz] = cells.counts;
    let extent = format!("0 {nx} 0 {ny} 0 {nz}");
    let three = |v: &[f64; 3]| format!("{:e} {:e} {:e}", v[0], v[1], v[2]);
    let attributes = format!(
        " WholeExtent=\"{extent}\" Origin=\"{}\" Spacing=\"{}\"",
        three(&cells.corner),
        three(&cells.spacing)
    );
    out.write_all(opening("ImageData", &attributes, fields, time).as_bytes())?;
    writeln!(out, "    <Piece Extent=\"{extent}\">")?;
    out.write_all(cell_data("ImageData", fields, cells.order.len(), 0).as_bytes())?;
    write_values(out, fields, cells.order.iter().copied())
}
