//! The grid of a contact: its extent from an estimate, enlarged when the contact outgrows it.
//!
//! nx × ny elements of dx × dy with odd counts, so that an element's centre lies at the origin:
//! x_i = (i − (nx − 1)/2) dx and y_j likewise.

use super::influence::{Elasticity, Influence};
use super::normal::{NormalContact, NormalError, NormalSolver, Prescribed};
use crate::reference::hertz::EllipticContact;

/// Room around the estimated contact, as a share of its semi-axes.
const MARGIN: f64 = 0.05;

/// Growth of a side that the contact touches.
const GROWTH: f64 = 1.5;

/// Rectangular elements around the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Elements along x, odd.
    pub nx: usize,
    /// Elements along y, odd.
    pub ny: usize,
    /// Side of an element along x [m].
    pub dx: f64,
    /// Side of an element along y [m].
    pub dy: f64,
}

impl Grid {
    /// Covers |x| ≤ `extent_x`, |y| ≤ `extent_y` [m] with elements dx × dy [m], all positive; the
    /// outermost elements lie wholly outside.
    #[must_use]
    pub fn covering(extent_x: f64, extent_y: f64, dx: f64, dy: f64) -> Self {
        let count = |extent: f64, side: f64| 2 * ((extent / side + 0.5).ceil() as usize) + 1;
        Self { nx: count(extent_x, dx), ny: count(extent_y, dy), dx, dy }
    }

    /// Covers an estimated ellipse and a margin with square elements of a/`resolution`.
    #[must_use]
    pub fn of_ellipse(estimate: &EllipticContact, resolution: usize) -> Self {
        let side = estimate.semi_axis_a / resolution.max(1) as f64;
        let extent = |semi_axis: f64| (1.0 + MARGIN) * semi_axis;
        Self::covering(extent(estimate.semi_axis_a), extent(estimate.semi_axis_b), side, side)
    }

    /// Number of elements.
    #[must_use]
    pub fn elements(&self) -> usize {
        self.nx * self.ny
    }

    /// Centre of column i along x [m].
    #[must_use]
    pub fn x(&self, i: usize) -> f64 {
        (i as f64 - (self.nx / 2) as f64) * self.dx
    }

    /// Centre of row j along y [m].
    #[must_use]
    pub fn y(&self, j: usize) -> f64 {
        (j as f64 - (self.ny / 2) as f64) * self.dy
    }

    /// Values of a function of (x, y) at the elements' centres.
    #[must_use]
    pub fn sample(&self, function: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        let at = |index: usize| function(self.x(index % self.nx), self.y(index / self.nx));
        (0..self.elements()).map(at).collect()
    }

    /// Influence numbers of the grid's elements.
    #[must_use]
    pub fn influence(&self, elasticity: Elasticity) -> Influence {
        Influence { dx: self.dx, dy: self.dy, elasticity }
    }

    /// Whether a pressure reaches the sides across x and across y.
    fn touched(&self, pressure: &[f64]) -> (bool, bool) {
        let loaded = |index: usize| pressure[index] > 0.0;
        let side_x = |j: usize| loaded(j * self.nx) || loaded((j + 1) * self.nx - 1);
        let side_y = |i: usize| loaded(i) || loaded((self.ny - 1) * self.nx + i);
        ((0..self.ny).any(side_x), (0..self.nx).any(side_y))
    }

    fn enlarged(&self, along_x: bool, along_y: bool) -> Self {
        let grown = |count: usize, grow: bool| {
            if grow { 2 * ((GROWTH * count as f64 / 2.0).ceil() as usize) + 1 } else { count }
        };
        Self { nx: grown(self.nx, along_x), ny: grown(self.ny, along_y), ..*self }
    }

    /// A field of a smaller grid in the middle of this one, zero around it.
    fn embed(&self, smaller: &Self, field: &[f64]) -> Vec<f64> {
        let (left, low) = ((self.nx - smaller.nx) / 2, (self.ny - smaller.ny) / 2);
        let mut embedded = vec![0.0; self.elements()];
        for (j, row) in field.chunks_exact(smaller.nx).enumerate() {
            let start = (low + j) * self.nx + left;
            embedded[start..start + smaller.nx].copy_from_slice(row);
        }
        embedded
    }
}

/// A normal contact, solved on a grid that holds it.
#[derive(Debug)]
pub struct PatchSolution {
    /// The grid.
    pub grid: Grid,
    /// Pressure of its elements [Pa].
    pub pressure: Vec<f64>,
    /// Approach, load and counts of the last solution.
    pub contact: NormalContact,
    /// Solver of the grid, for further solutions on it.
    pub solver: NormalSolver,
    /// How often the grid was enlarged.
    pub enlargements: usize,
}

/// Solves a normal contact with the undeformed distance `distance(x, y)` [m] and enlarges the grid,
/// elements unchanged, until the contact stays off its edge.
///
/// # Errors
/// Those of [`NormalSolver::solve`], and a contact that needs more than `limit` elements.
pub fn solve_normal_on_growing_grid(
    mut grid: Grid,
    elasticity: Elasticity,
    distance: impl Fn(f64, f64) -> f64,
    prescribed: Prescribed,
    limit: usize,
) -> Result<PatchSolution, NormalError> {
    let mut pressure = vec![0.0; grid.elements()];
    for enlargements in 0.. {
        let mut solver = NormalSolver::new(grid.nx, grid.ny, &grid.influence(elasticity));
        let contact = solver.solve(&grid.sample(&distance), prescribed, &mut pressure)?;
        let (along_x, along_y) = grid.touched(&pressure);
        if !along_x && !along_y {
            return Ok(PatchSolution { grid, pressure, contact, solver, enlargements });
        }
        let larger = grid.enlarged(along_x, along_y);
        if larger.elements() > limit {
            break;
        }
        pressure = larger.embed(&grid, &pressure);
        grid = larger;
    }
    Err(NormalError::GridLimit { nx: grid.nx, ny: grid.ny, limit })
}

/// Semi-axes along x and y [m] of the ellipse whose semi-ellipsoidal pressure has the second
/// moments of the given one about its centre: ⟨x²⟩ = a²/5, an element's own dx²/12 included.
/// Zero without pressure.
#[must_use]
pub fn equivalent_semi_axes(grid: &Grid, pressure: &[f64]) -> (f64, f64) {
    let total: f64 = pressure.iter().sum();
    if total <= 0.0 {
        return (0.0, 0.0);
    }
    let semi_axis = |coordinate: &dyn Fn(usize) -> f64, side: f64| {
        let mean = |power: i32| {
            let term = |(at, p): (usize, &f64)| p * coordinate(at).powi(power);
            pressure.iter().enumerate().map(term).sum::<f64>() / total
        };
        (5.0 * (mean(2) - mean(1).powi(2) + side * side / 12.0)).sqrt()
    };
    (semi_axis(&|at| grid.x(at % grid.nx), grid.dx), semi_axis(&|at| grid.y(at / grid.nx), grid.dy))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::hertz;
    use crate::scene::Material;

    const STEEL: Material = Material { youngs_modulus: 210e9, poisson_ratio: 0.3 };

    #[test]
    fn covers_with_odd_counts_and_an_empty_rim() {
        for (extent, side) in [(1.0, 0.1), (1.0, 0.3), (0.0, 1.0), (0.99, 0.02)] {
            let grid = Grid::covering(extent, 2.0 * extent, side, side);
            assert_eq!((grid.nx % 2, grid.ny % 2), (1, 1));
            assert_eq!((grid.x(grid.nx / 2), grid.y(grid.ny / 2)), (0.0, 0.0));
            assert!(grid.x(grid.nx - 1) - 0.5 * side >= extent * (1.0 - 1e-12));
            assert!(grid.y(0) + 0.5 * side <= -2.0 * extent * (1.0 - 1e-12));
        }
    }

    /// From a grid of three elements to the same answer as on a sufficient one. Tolerance: the
    /// iteration's.
    #[test]
    fn grows_until_it_holds_the_contact() {
        let elasticity = Elasticity::of_pair(&STEEL, &STEEL);
        let gap = |x: f64, y: f64| 0.2 * x * x + y * y;
        let load = Prescribed::Load(1e3);
        let hertz = hertz::elliptic_contact(0.2, 1.0, 1e3, elasticity.contact_compliance());
        let whole = Grid::of_ellipse(&hertz, 20);
        let small = Grid { nx: 3, ny: 3, ..whole };
        let expected = solve_normal_on_growing_grid(whole, elasticity, gap, load, 10_000).unwrap();
        assert_eq!((expected.enlargements, expected.grid), (0, whole));
        let grown = solve_normal_on_growing_grid(small, elasticity, gap, load, 10_000).unwrap();
        assert!(grown.enlargements > 3 && !grown.contact.touches_edge);
        assert_eq!(grown.contact.contact_elements, expected.contact.contact_elements);
        assert!((grown.contact.approach / expected.contact.approach - 1.0).abs() < 1e-9);
        let refused = solve_normal_on_growing_grid(small, elasticity, gap, load, 1000);
        assert!(matches!(refused.unwrap_err(), NormalError::GridLimit { limit: 1000, .. }));
    }

    /// Tolerance: the area of the elements that the edge cuts, second order in their size.
    #[test]
    fn semi_axes_of_a_known_pressure() {
        let grid = Grid::covering(2.0, 1.0, 0.05, 0.04);
        let ellipsoid =
            |x: f64, y: f64| (1.0 - ((x - 0.2) / 1.5).powi(2) - (y / 0.8).powi(2)).max(0.0).sqrt();
        let (a, b) = equivalent_semi_axes(&grid, &grid.sample(ellipsoid));
        assert!((a / 1.5 - 1.0).abs() < 2e-3 && (b / 0.8 - 1.0).abs() < 2e-3, "{a} {b}");
        assert_eq!(equivalent_semi_axes(&grid, &vec![0.0; grid.elements()]), (0.0, 0.0));
    }
}
