//! Grids whose rows begin at the leading edge of the contact.
//!
//! An element is either in contact or not, so that on a regular grid the contact begins up to half
//! an element before or behind its leading edge, differently in every row. Here row j is displaced
//! along x by δ_j elements, |δ_j| ≤ ½, so that its edge lies between two elements:
//!
//! x_ij = x_0 + (i + δ_j) Δx.
//!
//! Influence numbers between rows then depend on δ_j − δ_k too
//! ([`numerics::convolution::Convolution::displace_rows`]); differences along x stay in their row
//! and are unchanged, and so is the balance of power. Elements at the trailing edge are in contact
//! if their centre is.
//!
//! Fields leave on the regular grid ([`AlignedGrid::onto_grid`]): every element divides its value
//! among the two elements that it covers. Sums and first moments stay, and with them forces,
//! moments and powers.

use grids::Structured;

/// Displacements below this are rounding: mirrored rows are displaced alike [elements].
const ROUNDING: f64 = 1e-9;

/// Part of a row that is in contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chord {
    /// Trailing edge [m].
    pub trailing: f64,
    /// Leading edge [m].
    pub leading: f64,
}

impl Chord {
    /// Chords of the rows of a grid in an ellipse around the origin with the semi-axes `a` and `b`
    /// [m]; a single row is a line contact.
    #[must_use]
    pub fn of_ellipse(grid: &Structured, [a, b]: [f64; 2]) -> Vec<Option<Self>> {
        let half = |j: usize| match grid.nj {
            1 => a,
            _ => a * (1.0 - (grid.y(j) / b).powi(2)).max(0.0).sqrt(),
        };
        let chord = |half: f64| (half > 0.0).then_some(Self { trailing: -half, leading: half });
        (0..grid.nj).map(|j| chord(half(j))).collect()
    }
}

/// A grid and the displacements of its rows along x.
#[derive(Clone, Debug, PartialEq)]
pub struct AlignedGrid {
    grid: Structured,
    /// Displacement of each row [elements]; empty on a regular grid.
    displacements: Vec<f64>,
}

impl AlignedGrid {
    /// Grid without displacements.
    #[must_use]
    pub fn regular(grid: Structured) -> Self {
        Self { grid, displacements: Vec::new() }
    }

    /// Displaces the rows so that the leading edge `edge(j)` [m] of row j lies between two
    /// elements. Rows without an edge stay.
    #[must_use]
    pub fn new(grid: Structured, edge: impl Fn(usize) -> Option<f64>) -> Self {
        let beyond = |edge: f64| {
            let place = (edge - grid.x(0)) / grid.dx() - 0.5;
            let place = (place / ROUNDING).round() * ROUNDING;
            let by = place - place.round();
            if by.abs() < ROUNDING { 0.0 } else { by }
        };
        let displacements: Vec<f64> = (0..grid.nj).map(|j| edge(j).map_or(0.0, beyond)).collect();
        match displacements.iter().all(|by| *by == 0.0) {
            true => Self::regular(grid),
            false => Self { grid, displacements },
        }
    }

    /// Displaces the rows to the edge of an ellipse around the origin with the semi-axes `a` and
    /// `b` [m]; a single row is a line contact.
    #[must_use]
    pub fn of_ellipse(grid: Structured, semi_axes: [f64; 2]) -> Self {
        let chords = Chord::of_ellipse(&grid, semi_axes);
        Self::new(grid, |j| chords[j].map(|chord| chord.leading))
    }

    /// Regular grid.
    #[must_use]
    pub fn grid(&self) -> &Structured {
        &self.grid
    }

    /// Displacements of the rows [elements]; `None` on a regular grid.
    #[must_use]
    pub fn displacements(&self) -> Option<&[f64]> {
        (!self.displacements.is_empty()).then_some(&self.displacements)
    }

    /// Displacement of a row [m].
    #[must_use]
    pub fn offset(&self, row: usize) -> f64 {
        self.displacements.get(row).map_or(0.0, |elements| elements * self.grid.dx())
    }

    /// Centre of an element [m].
    #[must_use]
    pub fn centre(&self, index: usize) -> [f64; 2] {
        let (i, j) = (index % self.grid.ni, index / self.grid.ni);
        [self.grid.x(i) + self.offset(j), self.grid.y(j)]
    }

    /// Samples a function of (x, y) at the elements' centres.
    #[must_use]
    pub fn sample(&self, function: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        (0..self.grid.points())
            .map(|index| self.centre(index))
            .map(|[x, y]| function(x, y))
            .collect()
    }

    /// Values on the regular grid, with the sums and first moments of these values.
    #[must_use]
    pub fn onto_grid(&self, values: &[f64]) -> Vec<f64> {
        self.resampled(values, |displacement| displacement)
    }

    /// Values at the displaced elements of values on the regular grid, by linear interpolation.
    #[must_use]
    pub fn from_grid(&self, values: &[f64]) -> Vec<f64> {
        self.resampled(values, |displacement| -displacement)
    }

    /// Moves every row by a part of an element, and divides each value among two elements.
    fn resampled(&self, values: &[f64], by: impl Fn(f64) -> f64) -> Vec<f64> {
        if self.displacements.is_empty() {
            return values.to_vec();
        }
        let nx = self.grid.ni;
        let mut moved = vec![0.0; values.len()];
        let rows = values.chunks_exact(nx).zip(moved.chunks_exact_mut(nx)).zip(&self.displacements);
        for ((row, moved), displacement) in rows {
            let by = by(*displacement);
            for (i, value) in row.iter().enumerate() {
                let beside = if by < 0.0 { i.saturating_sub(1) } else { (i + 1).min(nx - 1) };
                moved[i] += (1.0 - by.abs()) * value;
                moved[beside] += by.abs() * value;
            }
        }
        moved
    }

    /// Grid of every second element along x and y, at the same places.
    #[must_use]
    pub(super) fn coarser(&self) -> Self {
        let mut grid = self.grid;
        grid.ni = grid.ni.div_ceil(2);
        grid.step_i = grid.step_i.map(|value| 2.0 * value);
        let rows = if grid.nj > 1 { 2 } else { 1 };
        if grid.nj > 1 {
            grid.nj = grid.nj.div_ceil(2);
            grid.step_j = grid.step_j.map(|value| 2.0 * value);
        }
        let displacements = self.displacements.iter().step_by(rows).map(|by| 0.5 * by).collect();
        Self { grid, displacements }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid() -> AlignedGrid {
        let grid = Structured::contact_plane(-1.3, -0.8, 0.1, 0.1, 27, 17);
        AlignedGrid::of_ellipse(grid, [1.0, 0.7])
    }

    /// Every edge lies between two elements, and mirrored rows are displaced alike.
    #[test]
    fn rows_begin_at_the_edge() {
        let aligned = grid();
        for j in 2..15 {
            let y = aligned.grid().y(j);
            let edge = (1.0 - (y / 0.7).powi(2)).max(0.0).sqrt();
            let [x, _] = aligned.centre(27 * j);
            let elements = (edge - x) / 0.1 + 0.5;
            assert!((elements - elements.round()).abs() < 1e-8, "row {j}: {elements}");
            assert!((aligned.offset(j) - aligned.offset(16 - j)).abs() < 1e-12);
            assert!(aligned.offset(j).abs() <= 0.05 + 1e-12);
        }
    }

    /// Sums and first moments stay; a linear function inside the grid is met.
    #[test]
    fn fields_leave_with_their_sums_and_moments() {
        let aligned = grid();
        let values = aligned.sample(|x, y| (1.0 - x * x - y * y).max(0.0) * (2.0 + x));
        let moved = aligned.onto_grid(&values);
        let regular = AlignedGrid::regular(*aligned.grid());
        let moment = |grid: &AlignedGrid, values: &[f64]| -> [f64; 2] {
            let sums = values.iter().enumerate().map(|(at, v)| [*v, v * grid.centre(at)[0]]);
            sums.fold([0.0; 2], |sum, more| [sum[0] + more[0], sum[1] + more[1]])
        };
        let [before, after] = [moment(&aligned, &values), moment(&regular, &moved)];
        for (before, after) in before.into_iter().zip(after) {
            assert!((before - after).abs() < 1e-12, "{before} {after}");
        }
        let line = aligned.from_grid(&regular.sample(|x, y| 3.0 * x - y));
        for (at, value) in line.iter().enumerate().filter(|(at, _)| (1..26).contains(&(at % 27))) {
            let [x, y] = aligned.centre(at);
            assert!((value - (3.0 * x - y)).abs() < 1e-12);
        }
    }
}
