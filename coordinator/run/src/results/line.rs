//! Fields along a line of a structured grid, as a table for plots.
//!
//! The line runs through the largest value of the first scalar field, or of the first field if all
//! are vectors. On a surface it runs along i, the rolling direction. In a section it runs through
//! all levels of depth. Among several largest values, as on mirrored patches, the one nearest to
//! the origin counts. If all values are zero, the line nearest to the origin is taken. For points
//! that a case names, the table holds all of them.

use super::vtk::FieldLabel;
use contract::grid::{Places, Structured};
use std::io::{self, Write};

/// Relative difference of squared values below which they count as equal.
const SAME: f64 = 1e-9;

/// Names of the components of vectors.
const VECTOR: [&str; 3] = ["x", "y", "z"];
/// Names of the components of symmetric tensors, in VTK's order.
const TENSOR: [&str; 6] = ["xx", "yy", "zz", "xy", "yz", "xz"];

/// Writes coordinates and values along a line, with a header of quantities and units.
pub(super) fn write(
    grid: &Structured,
    out: &mut impl Write,
    fields: &[(&FieldLabel, &[f64])],
) -> io::Result<()> {
    let elements = elements(grid, fields).into_iter();
    let points = elements.map(|(i, j)| (grid.centre(i, j), j * grid.ni + i));
    table(points, grid.points(), out, fields)
}

/// Writes coordinates and values at all points of a block, with the same header.
pub(super) fn write_points(
    places: &Places,
    out: &mut impl Write,
    fields: &[(&FieldLabel, &[f64])],
) -> io::Result<()> {
    let count = places.count();
    table((0..count).map(|at| (places.point(at), at)), count, out, fields)
}

/// Writes a row for each point, given by its coordinates and its index among `points` values.
fn table(
    rows: impl Iterator<Item = ([f64; 3], usize)>,
    points: usize,
    out: &mut impl Write,
    fields: &[(&FieldLabel, &[f64])],
) -> io::Result<()> {
    write!(out, "x [m],y [m],z [m]")?;
    for (kind, _) in fields {
        let components = kind.components as usize;
        let names: &[&str] = if components == TENSOR.len() { &TENSOR } else { &VECTOR };
        for component in 0..components {
            match (components, names.get(component)) {
                (1, _) => write!(out, ",{} [{}]", kind.name, kind.unit)?,
                (_, Some(axis)) => write!(out, ",{}_{axis} [{}]", kind.name, kind.unit)?,
                (_, None) => write!(out, ",{}_{component} [{}]", kind.name, kind.unit)?,
            }
        }
    }
    writeln!(out)?;
    for ([x, y, z], index) in rows {
        write!(out, "{x:e},{y:e},{z:e}")?;
        for (kind, values) in fields {
            for component in 0..kind.components as usize {
                let at = component * points + index;
                write!(out, ",{:e}", values.get(at).copied().unwrap_or(f64::NAN))?;
            }
        }
        writeln!(out)?;
    }
    Ok(())
}

/// Returns the elements of the line.
fn elements(grid: &Structured, fields: &[(&FieldLabel, &[f64])]) -> Vec<(usize, usize)> {
    let (i, j) = largest(grid, fields).unwrap_or_else(|| nearest(grid, |_| true));
    match grid.step_j[2] {
        0.0 => (0..grid.ni).map(|i| (i, j)).collect(),
        _ => (0..grid.nj).map(|j| (i, j)).collect(),
    }
}

/// Returns the element of the largest value; `None` if all values are zero.
fn largest(grid: &Structured, fields: &[(&FieldLabel, &[f64])]) -> Option<(usize, usize)> {
    let (kind, values) = fields.iter().find(|(kind, _)| kind.components == 1).or(fields.first())?;
    let points = grid.points();
    let size = |at: usize| {
        let components = (0..kind.components as usize).map(|c| values.get(c * points + at));
        components.flatten().map(|value| value * value).sum::<f64>()
    };
    let largest = (0..points).map(size).fold(0.0, f64::max);
    (largest > 0.0).then(|| nearest(grid, |at| size(at) >= (1.0 - SAME) * largest))
}

/// Returns the element nearest to the origin among those that qualify.
fn nearest(grid: &Structured, qualifies: impl Fn(usize) -> bool) -> (usize, usize) {
    let place = |at: usize| (at % grid.ni, at / grid.ni);
    let distance = |at: &usize| {
        let (i, j) = place(*at);
        grid.centre(i, j).iter().map(|value| value * value).sum::<f64>()
    };
    let qualified = (0..grid.points()).filter(|at| qualifies(*at));
    place(qualified.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(grid: &Structured, fields: &[(&FieldLabel, &[f64])]) -> String {
        let mut out = Vec::new();
        write(grid, &mut out, fields).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn the_row_through_the_largest_scalar_with_all_components() {
        let grid = Structured::contact_plane(-1.0, -0.5, 1.0, 0.5, 2, 3);
        let (power, traction) = (
            FieldLabel::of(&contract::field::FRICTION_POWER.kind(), None),
            FieldLabel::of(&contract::field::TRACTION.kind(), None),
        );
        let one = [0.0, 1.0, 2.0, 3.0, 9.0, 5.0];
        let two: Vec<f64> = (10..22).map(f64::from).collect();
        let expected = "x [m],y [m],z [m],traction_x [Pa],traction_y [Pa],friction_power [W/m2]\n\
                        -1e0,5e-1,0e0,1.4e1,2e1,9e0\n\
                        0e0,5e-1,0e0,1.5e1,2.1e1,5e0\n";
        assert_eq!(written(&grid, &[(&traction, &two), (&power, &one)]), expected);
    }

    #[test]
    fn of_equal_rows_the_one_nearest_to_the_origin() {
        let grid = Structured::contact_plane(0.0, -1.0, 1.0, 1.0, 2, 3);
        let pressure = FieldLabel::of(&contract::field::PRESSURE.kind(), None);
        let row = |values: &[f64]| written(&grid, &[(&pressure, values)]);
        assert!(row(&[1.0, 2.0, 0.0, 0.0, 4.0, 3.0]).contains("0e0,1e0,0e0,4e0"));
        assert!(row(&[4.0, 0.0, 4.0 - 1e-12, 3.9, 4.0, 0.0]).contains("1e0,0e0,0e0,3.9e0"));
        assert!(row(&[0.0; 6]).contains("0e0,0e0,0e0,0e0"));
    }

    /// Each point has a row, and the components of tensors have names.
    #[test]
    fn points_are_a_table() {
        let places = Places::Lattice([vec![1.0, 2.0], vec![0.0], vec![-3.0]]);
        let stress = FieldLabel::of(&contract::field::POINT_STRESS.kind(), None);
        let mut out = Vec::new();
        let values: Vec<f64> = (0..12).map(f64::from).collect();
        write_points(&places, &mut out, &[(&stress, &values)]).unwrap();
        let text = String::from_utf8(out).unwrap();
        let mut lines = text.lines();
        assert!(
            lines
                .next()
                .unwrap()
                .starts_with("x [m],y [m],z [m],point_stress_xx [Pa],point_stress_yy")
        );
        assert_eq!(lines.next(), Some("1e0,0e0,-3e0,0e0,2e0,4e0,6e0,8e0,1e1"));
        assert_eq!(lines.next(), Some("2e0,0e0,-3e0,1e0,3e0,5e0,7e0,9e0,1.1e1"));
    }

    /// A section has a line in depth through its largest value, across all levels.
    #[test]
    fn a_section_has_its_depth_line() {
        let grid = Structured {
            origin: [0.0, 0.5, -0.1],
            step_i: [1.0, 0.0, 0.0],
            step_j: [0.0, 0.0, -0.2],
            ni: 3,
            nj: 2,
        };
        let stress = FieldLabel::of(&contract::field::LOWER_SECTION_VON_MISES.kind(), None);
        let values = [1.0, 2.0, 3.0, 4.0, 9.0, 5.0];
        let text = written(&grid, &[(&stress, &values)]);
        let rows: Vec<&str> = text.lines().skip(1).collect();
        assert_eq!(rows, ["1e0,5e-1,-1e-1,2e0", "1e0,5e-1,-3.0000000000000004e-1,9e0"]);
    }
}
