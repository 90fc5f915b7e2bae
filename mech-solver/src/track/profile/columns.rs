//! Two columns of numbers: y and z, in millimetres, or in the units of a header.
//!
//! ```text
//! # rail 3, km 12.4, left
//! y [mm], z [mm]
//! -36.0, -14.12
//! -35.9, -13.87
//! ```
//!
//! The header may be missing; the columns may be set apart by blanks, tabs, commas or semicolons; what follows
//! `#`, `%` or `!` is a comment.

use super::error::ProfileError;
use super::text::{lines, numbers};

/// Points in the axes of the file [m].
///
/// # Errors
/// A line that is not two numbers, or a unit that is not known.
pub fn points(text: &str) -> Result<Vec<[f64; 2]>, ProfileError> {
    let mut units = [1e-3; 2];
    let mut found = Vec::new();
    for (at, (line, content)) in lines(text, &['#', '%', '!']).enumerate() {
        if at == 0 && content.contains('[') {
            units = header(line, content)?;
            continue;
        }
        match numbers(content).as_deref() {
            Some([y, z]) => found.push([y * units[0], z * units[1]]),
            _ => return Err(ProfileError::line(line, "is not two numbers, y and z")),
        }
    }
    Ok(found)
}

/// Metres in the units of `y [mm], z [mm]`.
fn header(line: usize, content: &str) -> Result<[f64; 2], ProfileError> {
    let unit = |name: &str| {
        let (_, rest) = content.split_once(name)?;
        let (_, rest) = rest.split_once('[')?;
        match rest.split(']').next()?.trim() {
            "m" => Some(1.0),
            "mm" => Some(1e-3),
            "um" | "µm" => Some(1e-6),
            "in" => Some(25.4e-3),
            _ => None,
        }
    };
    match (unit("y"), unit("z")) {
        (Some(y), Some(z)) => Ok([y, z]),
        _ => {
            let what = "is a header without `y [unit], z [unit]`; units are m, mm, um and in";
            Err(ProfileError::line(line, what))
        }
    }
}
