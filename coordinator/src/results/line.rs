//! Fields along the centre line of a structured grid, as a table for plots: the row of elements along
//! i whose centre line passes nearest to the origin; where all is zero there, as between two patches,
//! the row of the first field's largest value.

use proto::field::FieldKind;
use proto::grid::Structured;
use std::io::{self, Write};

/// Names of the components of vectors.
const COMPONENTS: [&str; 3] = ["x", "y", "z"];

/// Writes places and values, with a header that names quantities and units.
pub(super) fn write(
    grid: &Structured,
    out: &mut impl Write,
    fields: &[(&FieldKind, &[f64])],
) -> io::Result<()> {
    let row = told_row(grid, fields);
    write!(out, "x [m],y [m],z [m]")?;
    for (kind, _) in fields {
        for component in 0..kind.components as usize {
            match (kind.components, COMPONENTS.get(component)) {
                (1, _) => write!(out, ",{} [{}]", kind.name, kind.unit)?,
                (_, Some(axis)) => write!(out, ",{}_{axis} [{}]", kind.name, kind.unit)?,
                (_, None) => write!(out, ",{}_{component} [{}]", kind.name, kind.unit)?,
            }
        }
    }
    writeln!(out)?;
    for i in 0..grid.ni {
        let [x, y, z] = grid.centre(i, row);
        write!(out, "{x:e},{y:e},{z:e}")?;
        for (kind, values) in fields {
            for component in 0..kind.components as usize {
                let at = component * grid.points() + row * grid.ni + i;
                write!(out, ",{:e}", values.get(at).copied().unwrap_or(f64::NAN))?;
            }
        }
        writeln!(out)?;
    }
    Ok(())
}

fn told_row(grid: &Structured, fields: &[(&FieldKind, &[f64])]) -> usize {
    let nearest = nearest_row(grid);
    let in_row = |index: usize| index % grid.points() / grid.ni == nearest;
    let told = |values: &[f64]| values.iter().enumerate().any(|(k, v)| in_row(k) && *v != 0.0);
    if fields.iter().any(|(_, values)| told(values)) {
        return nearest;
    }
    let first = fields.first().map_or(&[][..], |(_, values)| *values);
    let largest = first.iter().enumerate().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    match largest {
        Some((index, value)) if *value != 0.0 => index % grid.points() / grid.ni,
        _ => nearest,
    }
}

fn nearest_row(grid: &Structured) -> usize {
    let distance = |j: usize| {
        let ([x, y, z], [dx, dy, dz]) = (grid.centre(0, j), grid.step_i);
        let cross = [y * dz - z * dy, z * dx - x * dz, x * dy - y * dx];
        cross.iter().map(|value| value * value).sum::<f64>()
    };
    (0..grid.nj).min_by(|a, b| distance(*a).total_cmp(&distance(*b))).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_row_with_all_components() {
        let grid = Structured::contact_plane(-1.0, -0.4, 1.0, 0.5, 2, 3);
        let (power, traction) =
            (proto::field::FRICTION_POWER.kind(), proto::field::TRACTION.kind());
        let one: Vec<f64> = (0..6).map(f64::from).collect();
        let two: Vec<f64> = (10..22).map(f64::from).collect();
        let mut out = Vec::new();
        write(&grid, &mut out, &[(&power, &one), (&traction, &two)]).unwrap();
        let text = String::from_utf8(out).unwrap();
        let expected = "x [m],y [m],z [m],friction_power [W/m2],traction_x [Pa],traction_y [Pa]\n\
                        -1e0,9.999999999999998e-2,0e0,2e0,1.2e1,1.8e1\n\
                        0e0,9.999999999999998e-2,0e0,3e0,1.3e1,1.9e1\n";
        assert_eq!(text, expected);
    }

    #[test]
    fn between_two_patches_the_row_of_the_larger_one() {
        let grid = Structured::contact_plane(0.0, -1.0, 1.0, 1.0, 2, 3);
        let pressure = proto::field::PRESSURE.kind();
        let mut out = Vec::new();
        write(&grid, &mut out, &[(&pressure, &[1.0, 2.0, 0.0, 0.0, 4.0, 3.0])]).unwrap();
        assert!(String::from_utf8(out).unwrap().contains("0e0,1e0,0e0,4e0"));
    }
}
