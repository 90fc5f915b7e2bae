//! The normal contact that a model starts from: solved on a grid, or a given ellipse.

use super::influence::{Elasticity, Influence};
use super::normal::{NormalError, NormalSolver, Prescribed};
use crate::ellipse::Ellipse;
use proto::grid::Structured;

/// Pressures on a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct NormalContact {
    /// Pressure of each element [Pa].
    pub pressure: Vec<f64>,
    /// Approach of the bodies [m]; unknown for a given ellipse.
    pub approach: Option<f64>,
    /// Iterations of the solver.
    pub iterations: u32,
}

impl NormalContact {
    /// Solves for bodies whose gap is A x² + B y² [A, B in 1/m] under a load [N].
    ///
    /// # Errors
    /// The load is out of range, the iteration does not converge, or the contact reaches the edge of
    /// the grid, beyond which it would be cut.
    pub fn solve(
        grid: &Structured,
        bodies: &Elasticity,
        [gap_x, gap_y]: [f64; 2],
        load: f64,
    ) -> Result<Self, NormalError> {
        let influence = Influence { dx: grid.dx(), dy: grid.dy(), elasticity: *bodies };
        let mut solver = NormalSolver::new(grid.ni, grid.nj, &influence);
        let distance: Vec<f64> = at_centres(grid, |x, y| gap_x * x * x + gap_y * y * y);
        let mut pressure = vec![0.0; grid.points()];
        let found = solver.solve(&distance, Prescribed::Load(load), &mut pressure)?;
        if found.touches_edge {
            return Err(NormalError::Edge { nx: grid.ni, ny: grid.nj });
        }
        Ok(Self {
            pressure,
            approach: Some(found.approach),
            iterations: u32::try_from(found.iterations).unwrap_or(u32::MAX),
        })
    }

    /// The semi-elliptic pressure of an ellipse, at the elements' centres, scaled so that it
    /// carries the ellipse's load.
    #[must_use]
    pub(crate) fn elliptic(grid: &Structured, ellipse: &Ellipse) -> Self {
        let Ellipse { semi_axis_a: a, semi_axis_b: b, max_pressure, normal_force, .. } = *ellipse;
        let mut pressure = at_centres(grid, |x, y| {
            max_pressure * (1.0 - (x / a).powi(2) - (y / b).powi(2)).max(0.0).sqrt()
        });
        let sum = pressure.iter().sum::<f64>() * grid.element_area();
        pressure.iter_mut().for_each(|value| *value *= normal_force / sum);
        Self { pressure, approach: None, iterations: 0 }
    }
}

fn at_centres(grid: &Structured, value: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let at = |index: usize| value(grid.x(index % grid.ni), grid.y(index / grid.ni));
    (0..grid.points()).map(at).collect()
}
