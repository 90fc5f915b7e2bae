//! Miniprof files, `.ban` for rails and `.whl` for wheels: lines `Key=Value`, then one point per
//! line.
//!
//! `ColumnDef` names the columns, of which X (lateral) and Y (vertical) are read; `XYPoints` is the
//! number of points. Lengths are in millimetres. X usually points from the field side to the middle
//! of the track. Y points up or down, depending on the setting of the instrument:
//! [`super::read::Reading`] chooses. Areas, tilts and reference points of the instrument are
//! ignored; points are as measured.

use super::error::ProfileError;
use super::text::{lines, numbers};

/// Reads the points in the axes of the file [m].
///
/// # Errors
/// Fails if a line is neither a key with a value nor a point, or if the number of points differs
/// from the announced one.
pub fn points(text: &str) -> Result<Vec<[f64; 2]>, ProfileError> {
    let (mut found, mut announced) = (Vec::new(), None);
    let (mut columns, mut count) = ([0, 1], 2);
    for (line, content) in lines(text, &[]) {
        if let Some((key, value)) = content.split_once('=') {
            match key.trim() {
                "XYPoints" => announced = value.trim().parse::<usize>().ok(),
                "ColumnDef" => (columns, count) = column_places(line, value)?,
                _ => {}
            }
            continue;
        }
        let values = numbers(content).filter(|values| values.len() >= count.min(2));
        let Some(values) = values.filter(|values| columns.iter().all(|at| *at < values.len()))
        else {
            return Err(ProfileError::line(line, format!("is not a point of {count} numbers")));
        };
        found.push(columns.map(|at| 1e-3 * values[at]));
    }
    match announced {
        // Some writers announce no number or zero.
        Some(announced) if announced > 0 && announced != found.len() => {
            Err(ProfileError::Count { announced, found: found.len() })
        }
        _ => Ok(found),
    }
}

/// Positions of X and Y among the columns, and the number of columns.
fn column_places(line: usize, value: &str) -> Result<([usize; 2], usize), ProfileError> {
    let names: Vec<&str> = value.split([',', ';']).map(str::trim).collect();
    let of = |name: &str| names.iter().position(|one| one.eq_ignore_ascii_case(name));
    match (of("X"), of("Y")) {
        (Some(x), Some(y)) => Ok(([x, y], names.len())),
        _ => Err(ProfileError::line(line, "names no columns X and Y in `ColumnDef`")),
    }
}
