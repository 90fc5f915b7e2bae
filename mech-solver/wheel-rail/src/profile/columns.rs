//! Two columns of numbers: y and z, in the units of a header or, without a header, in millimetres.
//!
//! ```text
//! # rail 3, km 12.4, left
//! y [mm], z [mm]
//! -36.0, -14.12
//! -35.9, -13.87
//! ```
//!
//! The format is that of every table ([`tables::table`]): columns in any order, separated by
//! blanks, tabs, commas or semicolons. Text behind `#`, `%` or `!` is a comment.

use super::error::ProfileError;
use tables::table::{Column, Reading, Table};

/// Reads the points in the axes of the file [m].
///
/// # Errors
/// Fails if a line does not hold two numbers, a column is missing, or a unit is not a length.
pub fn points(text: String) -> Result<Vec<[f64; 2]>, ProfileError> {
    let wrong = |error: tables::table::TableError| ProfileError::Table(error.to_string());
    let table = Table::parse(text, Reading::PROFILE).map_err(wrong)?;
    let columns = ["y", "z"].map(|name| Column::new(&[name], "m").bare("mm"));
    let found = table.columns(&columns).map_err(wrong)?;
    Ok(found[0].iter().zip(&found[1]).map(|(y, z)| [*y, *z]).collect())
}
