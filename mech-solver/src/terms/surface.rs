//! Input field of a surface, on a grid that may differ from that of the contact.

use crate::case::scene::Body;
use proto::field::{self, FieldSpec};
use proto::grid::Structured;
use proto::model::{Inputs, StepError, first_non_finite};
use serde::{Deserialize, Serialize};

/// Values at the elements of a grid along x and y. The grid may differ in every solve.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface<'a> {
    grid: &'a Structured,
    values: &'a [f64],
}

/// Stored copy of the values of a surface.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct KeptSurface {
    grid: Structured,
    values: Vec<f64>,
}

impl KeptSurface {
    /// Reads an input field.
    ///
    /// # Errors
    /// Same errors as [`Surface::of`].
    pub(crate) fn of(inputs: &dyn Inputs, field: &FieldSpec) -> Result<Self, StepError> {
        let Surface { grid, values } = Surface::of(inputs, field)?;
        Ok(Self { grid: *grid, values: values.to_vec() })
    }

    /// Returns true if there is a value for every element.
    pub(crate) fn is_whole(&self) -> bool {
        self.values.len() == self.grid.points()
    }

    /// Returns a view of the values.
    pub(crate) fn seen(&self) -> Surface<'_> {
        Surface { grid: &self.grid, values: &self.values }
    }
}

impl<'a> Surface<'a> {
    /// Returns grid and values.
    pub(crate) fn parts(&self) -> (&'a Structured, &'a [f64]) {
        (self.grid, self.values)
    }

    /// Reads an input field.
    ///
    /// # Errors
    /// A field that is missing, not finite, or not on a structured grid along x and y.
    pub(crate) fn of(inputs: &'a dyn Inputs, field: &FieldSpec) -> Result<Self, StepError> {
        let missing = || StepError::MissingInput { field: field.name.to_owned() };
        let input = inputs.get(field).ok_or_else(missing)?;
        if let Some(index) = first_non_finite(input.values) {
            let (field, value) = (field.name.to_owned(), input.values[index]);
            return Err(StepError::NonFiniteInput { field, index, value });
        }
        match input.grid.as_structured().filter(|from| is_along_axes(from)) {
            Some(grid) => Ok(Self { grid, values: input.values }),
            None => {
                let name = field.name;
                let reason = format!("`{name}` is not on a structured grid along x and y");
                Err(StepError::NoSolution(reason))
            }
        }
    }

    /// Value by bilinear interpolation between the centres of the elements; beyond them that of the
    /// nearest one.
    pub(crate) fn at(&self, x: f64, y: f64) -> f64 {
        let Self { grid, values } = self;
        let cell = |at: f64, first: f64, step: f64, count: usize| {
            let at = ((at - first) / step).clamp(0.0, (count - 1) as f64);
            let low = (at as usize).min(count.saturating_sub(2));
            (low, (low + 1).min(count - 1), at - low as f64)
        };
        let (i, right, s) = cell(x, grid.x(0), grid.dx(), grid.ni);
        let (j, upper, t) = cell(y, grid.y(0), grid.dy(), grid.nj);
        let at = |i: usize, j: usize| values[j * grid.ni + i];
        (1.0 - t) * ((1.0 - s) * at(i, j) + s * at(right, j))
            + t * ((1.0 - s) * at(i, upper) + s * at(right, upper))
    }
}

/// Adds the thermal expansion of both surfaces together at the elements of a grid [m]: 2(1 + ν)α W
/// of each body ([`crate::effects::thermal_expansion`]), with the expansion coefficients α [1/K]
/// and the depth integral W of the temperature rise.
///
/// # Errors
/// An input that is missing or unusable.
pub(crate) fn raise(
    inputs: &dyn Inputs,
    bodies: &[Body; 2],
    coefficients: [f64; 2],
    grid: &Structured,
    rises: &mut [f64],
) -> Result<(), StepError> {
    let fields = [&field::UPPER_RISE_INTEGRAL, &field::LOWER_RISE_INTEGRAL];
    for ((body, field), coefficient) in bodies.iter().zip(fields).zip(coefficients) {
        let integral = Surface::of(inputs, field)?;
        let factor = 2.0 * (1.0 + body.material.poisson_ratio) * coefficient;
        for (index, rise) in rises.iter_mut().enumerate() {
            *rise += factor * integral.at(grid.x(index % grid.ni), grid.y(index / grid.ni));
        }
    }
    Ok(())
}

/// Returns true if i runs along +x and j along +y.
fn is_along_axes(grid: &Structured) -> bool {
    let flat = grid.step_i[1] == 0.0 && grid.step_j[0] == 0.0;
    flat && grid.dx() > 0.0 && grid.dy() > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A linear field is reproduced exactly inside, also between shifted grids.
    #[test]
    fn bilinear_between_grids() {
        let grid = Structured::contact_plane(-1.0, -2.0, 0.5, 1.0, 5, 4);
        let values: Vec<f64> = (0..20).map(|k| 3.0 * grid.x(k % 5) - grid.y(k / 5)).collect();
        let linear = Surface { grid: &grid, values: &values };
        for (x, y) in [(-1.0, -2.0), (0.3, 0.4), (1.0, 1.0), (-0.75, 0.0)] {
            assert!((linear.at(x, y) - (3.0 * x - y)).abs() < 1e-14);
        }
        assert_eq!(linear.at(9.0, -9.0), 3.0 * 1.0 + 2.0);
        let point = Structured::contact_plane(0.0, 0.0, 1.0, 1.0, 1, 1);
        assert_eq!(Surface { grid: &point, values: &[7.0] }.at(3.0, 3.0), 7.0);
    }
}
