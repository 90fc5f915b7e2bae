//! Patches of a contact: connected sets of loaded elements that share sides.

use super::extent::Moments;
use grids::Structured;

/// One patch of a contact.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    /// Elements of the patch, in rising order.
    pub elements: Vec<usize>,
    /// Position and size.
    pub moments: Moments,
    /// Sum of the pressures of its elements [Pa].
    pub sum: f64,
    /// Largest pressure [Pa].
    pub max_pressure: f64,
    /// First and last row of the patch.
    pub rows: [usize; 2],
}

impl Patch {
    fn of(grid: &Structured, pressure: &[f64], mut elements: Vec<usize>) -> Self {
        elements.sort_unstable();
        let loaded = || elements.iter().map(|at| (*at, pressure[*at]));
        Self {
            moments: Moments::of_elements(grid, loaded()),
            sum: loaded().map(|(_, p)| p).sum(),
            max_pressure: loaded().map(|(_, p)| p).fold(0.0, f64::max),
            // Elements are numbered row after row.
            rows: [elements[0] / grid.ni, elements[elements.len() - 1] / grid.ni],
            elements,
        }
    }

    /// Number of rows.
    #[must_use]
    pub fn row_count(&self) -> usize {
        self.rows[1] - self.rows[0] + 1
    }

    /// Lateral coordinates of the patch's sides [m].
    #[must_use]
    pub fn sides(&self, grid: &Structured) -> [f64; 2] {
        let half = 0.5 * grid.dy();
        [grid.y(self.rows[0]) - half, grid.y(self.rows[1]) + half]
    }
}

/// Splits a pressure into patches, in the order of their lateral positions.
#[must_use]
pub fn patches(grid: &Structured, pressure: &[f64]) -> Vec<Patch> {
    let mut seen: Vec<bool> = pressure.iter().map(|p| *p <= 0.0).collect();
    let mut patches = Vec::new();
    for start in 0..seen.len() {
        if !std::mem::replace(&mut seen[start], true) {
            patches.push(Patch::of(grid, pressure, connected(grid, start, &mut seen)));
        }
    }
    patches.sort_by(|a, b| a.moments.centre[1].total_cmp(&b.moments.centre[1]));
    patches
}

/// Elements connected with `start`, which is already marked as seen; marks the others.
fn connected(grid: &Structured, start: usize, seen: &mut [bool]) -> Vec<usize> {
    let mut elements = vec![start];
    let mut next = 0;
    while let Some(&at) = elements.get(next) {
        next += 1;
        let (i, j) = (at % grid.ni, at / grid.ni);
        let neighbours = [
            (i > 0).then(|| at - 1),
            (i + 1 < grid.ni).then(|| at + 1),
            (j > 0).then(|| at - grid.ni),
            (j + 1 < grid.nj).then(|| at + grid.ni),
        ];
        for neighbour in neighbours.into_iter().flatten() {
            if !std::mem::replace(&mut seen[neighbour], true) {
                elements.push(neighbour);
            }
        }
    }
    elements
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patches_have_their_elements_loads_and_places() {
        let grid = Structured::contact_plane(0.0, 0.0, 1.0, 1.0, 4, 3);
        let pressure = [1.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 3.0, 0.0, 1.0, 0.0, 0.0];
        let found = patches(&grid, &pressure);
        let elements: Vec<_> = found.iter().map(|patch| patch.elements.clone()).collect();
        assert_eq!(elements, [vec![0, 4], vec![2, 3, 7], vec![9]]);
        assert_eq!(found[1].sum, 5.0);
        assert_eq!(found[1].max_pressure, 3.0);
        assert_eq!((found[1].row_count(), found[1].sides(&grid)), (2, [-0.5, 1.5]));
        assert!((found[1].moments.centre[1] - 0.6).abs() < 1e-15);
        assert!(patches(&grid, &[0.0; 12]).is_empty());
    }
}
