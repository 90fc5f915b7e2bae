//! A grid that holds a contact: enlarged until the contact stays off its edge and the bodies touch
//! nowhere beside it.

use super::aligned::AlignedGrid;
use super::influence::Influence;
use super::normal::{NormalContact, NormalError, NormalSolver, Prescribed};
use super::viscoelastic::Bodies;
use grids::Structured;
use numerics::quadrature::GAUSS_8;

/// Growth of the grid at a side that the contact touches, as a share of its length.
const GROWTH: f64 = 0.25;
/// Free rows round a contact found beside the grid.
const MARGIN: usize = 2;
/// Largest number of rows examined beside the grid on either side; of more rows, every n-th is
/// examined.
const MOST_ROWS: f64 = 1e6;

/// Solution of a normal contact on a grid that holds it.
#[derive(Clone, Debug)]
pub struct FittedContact {
    /// The grid.
    pub grid: Structured,
    /// Pressure of each element [Pa].
    pub pressure: Vec<f64>,
    /// Result of the solver.
    pub contact: NormalContact,
    /// Number of enlargements of the grid.
    pub enlargements: usize,
}

/// Solves a normal contact with the undeformed distance `distance(x, y)` [m] on a grid that grows
/// until it holds the contact. The size of the elements is kept. The grid grows at the sides that
/// the contact touches, and over the rows beside it in which the deformed bodies would penetrate
/// each other, so that it ends only where the gap is open. The shapes are defined for the lateral
/// coordinates `within` [m]. Rows beside the grid are not examined on sides where `within` is
/// infinite, nor for viscoelastic bodies. `pressure_bound` is the largest possible pressure [Pa]
/// and may be infinite.
///
/// # Errors
/// Errors of [`NormalSolver::solve`]; the contact needs more than `limit` elements; the contact
/// reaches the end of the shapes.
pub fn fit_grid(
    mut grid: Structured,
    bodies: impl Into<Bodies>,
    distance: &dyn Fn(f64, f64) -> f64,
    prescribed: Prescribed,
    within: [f64; 2],
    limit: usize,
    pressure_bound: f64,
) -> Result<FittedContact, NormalError> {
    let bodies = bodies.into();
    let mut pressure = vec![0.0; grid.points()];
    for enlargements in 0.. {
        let sides = [grid.dx(), grid.dy()];
        let influence = Influence::of_grid(&grid, bodies.instantaneous);
        let mut solver = NormalSolver::of_bodies(grid.ni, grid.nj, sides, &bodies);
        solver.pressure_bound = pressure_bound;
        let contact = solver.solve(&sample(&grid, distance), prescribed, &mut pressure)?;
        if !contact.touches_edge {
            let outside = Outside { grid: &grid, pressure: &pressure, influence: &influence };
            let rows = match bodies.remember() {
                true => [0, 0],
                false => outside.penetrated(distance, contact.approach, within),
            };
            if rows == [0, 0] {
                return Ok(FittedContact { grid, pressure, contact, enlargements });
            }
            let added = rows[0].saturating_add(rows[1]);
            let elements = grid.nj.saturating_add(added).saturating_mul(grid.ni);
            if elements > limit {
                let below = grid.y(0) - rows[0] as f64 * grid.dy();
                let above = grid.y(grid.nj - 1) + rows[1] as f64 * grid.dy();
                let y = if rows[0] > 0 { below } else { above };
                return Err(NormalError::FarApart { y, elements, limit });
            }
            let larger = enlarged(&grid, [0, 0, rows[0], rows[1]]);
            pressure = embed(&grid, &larger, &pressure);
            grid = larger;
            continue;
        }
        let touched = touched(&grid, &pressure);
        let (low, high) = (grid.y(0) - grid.dy(), grid.y(grid.nj - 1) + grid.dy());
        if touched[2] && low < within[0] || touched[3] && high > within[1] {
            return Err(NormalError::EndOfShape);
        }
        let larger = grown(&grid, touched);
        if larger.points() > limit {
            break;
        }
        pressure = embed(&grid, &larger, &pressure);
        grid = larger;
    }
    Err(NormalError::GridLimit { nx: grid.ni, ny: grid.nj, limit })
}

/// Samples a function of (x, y) at the elements' centres.
#[must_use]
pub fn sample(grid: &Structured, function: &dyn Fn(f64, f64) -> f64) -> Vec<f64> {
    let at = |index: usize| function(grid.x(index % grid.ni), grid.y(index / grid.ni));
    (0..grid.points()).map(at).collect()
}

/// Means of √(1 − (x/a)² − (y/b)²) over the elements whose centres are inside the ellipse. On a
/// single row, a line contact, means of √(1 − (x/a)²). The integral is exact along x and uses
/// Gauss's rule of eight points across.
#[must_use]
pub fn elliptic(rows: &AlignedGrid, [a, b]: [f64; 2]) -> Vec<f64> {
    let grid = rows.grid();
    let (dx, dy) = (grid.dx() / a, grid.dy() / b);
    // Mean along x over the part inside a half chord, in the unit circle.
    let along = |x: f64, chord: f64| {
        let integral = |x: f64| {
            let x = x.clamp(-chord, chord);
            0.5 * (x * (chord * chord - x * x).max(0.0).sqrt() + chord * chord * (x / chord).asin())
        };
        (integral(x + 0.5 * dx) - integral(x - 0.5 * dx)) / dx
    };
    let at = |x: f64, y: f64| {
        let (x, y) = (x / a, y / b);
        if x * x + y * y >= 1.0 {
            return 0.0;
        }
        if grid.nj == 1 {
            return along(x, (1.0 - y * y).sqrt());
        }
        let chord = |place: f64| (1.0 - (y + 0.5 * dy * place).powi(2)).max(0.0).sqrt();
        let mean =
            |place: f64| Some(chord(place)).filter(|c| *c > 0.0).map_or(0.0, |c| along(x, c));
        GAUSS_8.iter().map(|(place, weight)| 0.5 * weight * mean(*place)).sum()
    };
    rows.sample(at)
}

/// Returns which sides a pressure reaches: those of least x, largest x, least y and largest y.
fn touched(grid: &Structured, pressure: &[f64]) -> [bool; 4] {
    let loaded = |i: usize, j: usize| pressure[j * grid.ni + i] > 0.0;
    let (right, top) = (grid.ni - 1, grid.nj - 1);
    // A line contact has no sides along y.
    let plane = grid.nj > 1;
    [
        (0..grid.nj).any(|j| loaded(0, j)),
        (0..grid.nj).any(|j| loaded(right, j)),
        plane && (0..grid.ni).any(|i| loaded(i, 0)),
        plane && (0..grid.ni).any(|i| loaded(i, top)),
    ]
}

/// Enlarges the grid by a share of its length at these sides.
fn grown(grid: &Structured, sides: [bool; 4]) -> Structured {
    let added = |count: usize| (GROWTH * count as f64).ceil() as usize;
    let counts = [grid.ni, grid.ni, grid.nj, grid.nj];
    enlarged(grid, std::array::from_fn(|k| if sides[k] { added(counts[k]) } else { 0 }))
}

/// Adds whole elements to the grid at its sides.
fn enlarged(grid: &Structured, [left, right, low, high]: [usize; 4]) -> Structured {
    let x0 = grid.x(0) - left as f64 * grid.dx();
    let y0 = grid.y(0) - low as f64 * grid.dy();
    let (nx, ny) = (grid.ni + left + right, grid.nj + low + high);
    Structured::contact_plane(x0, y0, grid.dx(), grid.dy(), nx, ny)
}

/// Surroundings of the grid of a solution.
struct Outside<'a> {
    grid: &'a Structured,
    pressure: &'a [f64],
    influence: &'a Influence,
}

impl Outside<'_> {
    /// Rows to be added below and above, so that the grid holds all points at which the bodies
    /// penetrate each other, and a margin.
    fn penetrated(
        &self,
        distance: &dyn Fn(f64, f64) -> f64,
        approach: f64,
        within: [f64; 2],
    ) -> [usize; 2] {
        let grid = self.grid;
        let loaded = self.pressure.iter().enumerate().filter(|(_, p)| **p > 0.0);
        let loaded: Vec<(usize, f64)> = loaded.map(|(at, p)| (at, *p)).collect();
        let total: f64 = loaded.iter().map(|(_, p)| p).sum();
        let sides = [(grid.y(0), -1.0), (grid.y(grid.nj - 1), 1.0)];
        std::array::from_fn(|side| {
            let (edge, sign) = sides[side];
            let room = sign * (within[side] - edge) / grid.dy();
            if !room.is_finite() {
                return 0;
            }
            let penetrates = |row: &usize| {
                let y = edge + sign * *row as f64 * grid.dy();
                let open = approach - self.least_displacement(y, total);
                (0..grid.ni).map(|i| grid.x(i)).any(|x| {
                    let undeformed = distance(x, y);
                    undeformed < open && undeformed + self.displacement([x, y], &loaded) < approach
                })
            };
            let every = (room / MOST_ROWS).ceil().max(1.0);
            let rows = (1..=(room / every).max(0.0) as usize).map(|k| k * every as usize);
            rows.rev().find(penetrates).map_or(0, |row| row + MARGIN)
        })
    }

    /// Normal displacement at a point [m].
    fn displacement(&self, [x, y]: [f64; 2], loaded: &[(usize, f64)]) -> f64 {
        let by = |(at, p): &(usize, f64)| {
            let [from_x, from_y, _] = self.grid.centre(at % self.grid.ni, at / self.grid.ni);
            p * self.influence.zz_at(x - from_x, y - from_y)
        };
        loaded.iter().map(by).sum()
    }

    /// Lower bound of the displacement in a row beside the grid [m]: the sum `total` of all
    /// pressures [Pa] at the greatest distance.
    fn least_displacement(&self, y: f64, total: f64) -> f64 {
        let grid = self.grid;
        let ends = [grid.y(0), grid.y(grid.nj - 1)];
        let away = ends.iter().map(|end| (y - end).abs()).fold(0.0, f64::max) + grid.dy();
        let length = (grid.ni + 1) as f64 * grid.dx();
        total * self.influence.zz_at(length, away)
    }
}

/// Copies a field of a grid into a larger grid of the same elements, zero elsewhere.
fn embed(grid: &Structured, larger: &Structured, field: &[f64]) -> Vec<f64> {
    let left = ((grid.x(0) - larger.x(0)) / grid.dx()).round() as usize;
    let low = ((grid.y(0) - larger.y(0)) / grid.dy()).round() as usize;
    let mut embedded = vec![0.0; larger.points()];
    for (j, row) in field.chunks_exact(grid.ni).enumerate() {
        let start = (low + j) * larger.ni + left;
        embedded[start..start + grid.ni].copy_from_slice(row);
    }
    embedded
}

/// Centre and size of a loaded area.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    /// Centre of pressure, x and y [m].
    pub centre: [f64; 2],
    /// Semi-axes along x and y [m] of the semi-ellipsoidal pressure with the same second moments
    /// about its centre, ⟨x²⟩ = a²/5, each element's own Δx²/12 included. For a line contact, a
    /// single row, ⟨x²⟩ = a²/4, and b is half the width of the row. Where these exceed half the
    /// length of the loaded elements by more than half an element, as on a flat body or on several
    /// patches, the pressure is no semi-ellipsoid, and the semi-axis is that half length.
    pub semi_axes: [f64; 2],
}

impl Moments {
    /// Moments of a pressure; all zero without pressure.
    #[must_use]
    pub fn of(grid: &Structured, pressure: &[f64]) -> Self {
        Self::of_elements(grid, pressure.iter().copied().enumerate())
    }

    /// Moments of the pressures on a selection of elements.
    #[must_use]
    pub fn of_elements(
        grid: &Structured,
        pressures: impl IntoIterator<Item = (usize, f64)>,
    ) -> Self {
        let mut sums = [0.0; 5];
        let mut ends = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for (index, p) in pressures {
            let (x, y) = (grid.x(index % grid.ni), grid.y(index / grid.ni));
            for ([low, high], at) in ends.iter_mut().zip([x, y]).filter(|_| p > 0.0) {
                (*low, *high) = (low.min(at), high.max(at));
            }
            for (sum, weight) in sums.iter_mut().zip([1.0, x, y, x * x, y * y]) {
                *sum += p * weight;
            }
        }
        if sums[0] <= 0.0 {
            return Self::default();
        }
        let [total, x, y, xx, yy] = sums;
        let centre = [x / total, y / total];
        let semi_axis = |square: f64, centre: f64, side: f64| {
            (5.0 * (square / total - centre * centre + side * side / 12.0)).max(0.0).sqrt()
        };
        let within = |axis: f64, [low, high]: [f64; 2], side: f64| {
            let half_length = 0.5 * (high - low + side);
            if axis > half_length + 0.5 * side { half_length } else { axis }
        };
        let along = semi_axis(xx, centre[0], grid.dx());
        let along_x = |axis: f64| within(axis, ends[0], grid.dx());
        let semi_axes = match grid.nj {
            1 => [along_x(0.8_f64.sqrt() * along), 0.5 * grid.dy()],
            _ => {
                let across = semi_axis(yy, centre[1], grid.dy());
                [along_x(along), within(across, ends[1], grid.dy())]
            }
        };
        Self { centre, semi_axes }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use elastic::Elasticity;
    use elastic::Material;

    const LOAD: Prescribed = Prescribed::Load(134e3);
    const EVERYWHERE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

    fn steel() -> Elasticity {
        let body = Material { youngs_modulus: 210e9, poisson_ratio: 0.3 };
        Elasticity::of_pair(&body, &body)
    }

    fn grid(half_x: usize, half_y: usize, side: f64) -> Structured {
        let (x0, y0) = (-(half_x as f64) * side, -(half_y as f64) * side);
        Structured::contact_plane(x0, y0, side, side, 2 * half_x + 1, 2 * half_y + 1)
    }

    /// A grid that starts too small, or beside the contact, ends with the same solution as a grid
    /// that was large enough. Tolerance: the iteration.
    #[test]
    fn a_small_grid_grows_to_the_same_solution() {
        let gap = |x: f64, y: f64| 0.5 / 0.46 * x * x + 0.5 / 0.3 * y * y;
        let fit =
            |start, limit| fit_grid(start, steel(), &gap, LOAD, EVERYWHERE, limit, f64::INFINITY);
        let whole = fit(grid(13, 13, 8e-4), 10_000).unwrap();
        assert_eq!((whole.enlargements, whole.grid), (0, grid(13, 13, 8e-4)));
        let small = Structured::contact_plane(-2.4e-3, -0.8e-3, 8e-4, 8e-4, 9, 4);
        let grown = fit(small, 10_000).unwrap();
        assert!(grown.enlargements > 3);
        assert_eq!(grown.contact.contact_elements, whole.contact.contact_elements);
        assert!((grown.contact.approach / whole.contact.approach - 1.0).abs() < 1e-9);
        let refused = fit(small, 200).unwrap_err();
        assert!(matches!(refused, NormalError::GridLimit { limit: 200, .. }));
        let end =
            fit_grid(small, steel(), &gap, LOAD, [-1e-3, 1.0], 10_000, f64::INFINITY).unwrap_err();
        assert_eq!(end, NormalError::EndOfShape);
    }

    /// Tolerances: the area of the elements cut by the edge, second order in their size, and the
    /// rounding that decides about elements on the edge.
    #[test]
    fn moments_of_a_known_pressure() {
        let grid = Structured::contact_plane(-2.0, -1.0, 0.05, 0.04, 81, 51);
        let ellipsoid =
            |x: f64, y: f64| (1.0 - ((x - 0.2) / 1.5).powi(2) - (y / 0.8).powi(2)).max(0.0).sqrt();
        let Moments { centre, semi_axes: [a, b] } = Moments::of(&grid, &sample(&grid, &ellipsoid));
        assert!((a / 1.5 - 1.0).abs() < 2e-3 && (b / 0.8 - 1.0).abs() < 2e-3, "{a} {b}");
        assert!((centre[0] - 0.2).abs() < 1e-6 && centre[1].abs() < 1e-6);
        assert_eq!(Moments::of(&grid, &vec![0.0; grid.points()]), Moments::default());
    }

    /// A flat punch of 2.45 × 1.24 with the singular pressure of its edges across, and two patches:
    /// the semi-axes end with the contact. Tolerance: rounding; the size of a patch.
    #[test]
    fn semi_axes_end_with_the_contact() {
        let grid = Structured::contact_plane(-2.0, -1.0, 0.05, 0.04, 81, 51);
        let punch = |x: f64, y: f64| {
            if x.abs() < 1.21 && y.abs() < 0.61 { (0.41 - y * y).sqrt().recip() } else { 0.0 }
        };
        let [a, b] = Moments::of(&grid, &sample(&grid, &punch)).semi_axes;
        assert!((a - 1.225).abs() < 1e-12 && (b - 0.62).abs() < 1e-12, "{a} {b}");
        let patches = |x: f64, y: f64| if (x.abs() - 1.0).hypot(y) < 0.1 { 1.0 } else { 0.0 };
        let [a, b] = Moments::of(&grid, &sample(&grid, &patches)).semi_axes;
        assert!((1.05..1.15).contains(&a) && b < 0.15, "{a} {b}");
    }
}
