//! A structured grid as cells of a box, the form of VTK images.

use contract::grid::Structured;

/// Cells along x, y, z from a corner, with positive spacing.
#[derive(Clone, Debug, PartialEq)]
pub struct Cells {
    /// The corner with the smallest coordinates [m].
    pub corner: [f64; 3],
    /// Lengths of a cell [m].
    pub spacing: [f64; 3],
    /// Number of cells along x, y, z; 0 along the normal of the plane.
    pub counts: [usize; 3],
    /// Index in the grid of the n-th cell, with x running fastest, then y.
    pub order: Vec<usize>,
}

impl Cells {
    /// Returns the cells of a grid. Returns `None` if a step is oblique, or if both steps are along
    /// the same axis.
    #[must_use]
    pub fn of(grid: &Structured) -> Option<Self> {
        let axis = |step: &[f64; 3]| {
            let mut along = (0..3).filter(|&k| step[k] != 0.0);
            along.next().filter(|_| along.next().is_none())
        };
        let (ai, aj) = (axis(&grid.step_i)?, axis(&grid.step_j)?);
        if ai == aj {
            return None;
        }
        let (si, sj) = (grid.step_i[ai], grid.step_j[aj]);
        let mut cells = Self {
            corner: grid.origin,
            spacing: [si.abs().min(sj.abs()); 3],
            counts: [0; 3],
            order: Vec::with_capacity(grid.points()),
        };
        for (axis, step, count) in [(ai, si, grid.ni), (aj, sj, grid.nj)] {
            let first = if step > 0.0 { 0.0 } else { (count - 1) as f64 * step };
            cells.corner[axis] += first - 0.5 * step.abs();
            cells.spacing[axis] = step.abs();
            cells.counts[axis] = count;
        }
        let along = |step: f64, count: usize, n: usize| if step > 0.0 { n } else { count - 1 - n };
        let index = |i: usize, j: usize| along(sj, grid.nj, j) * grid.ni + along(si, grid.ni, i);
        if ai < aj {
            cells.order.extend((0..grid.nj).flat_map(|j| (0..grid.ni).map(move |i| index(i, j))));
        } else {
            cells.order.extend((0..grid.ni).flat_map(|i| (0..grid.nj).map(move |j| index(i, j))));
        }
        Some(cells)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_section_that_points_down_is_turned_over() {
        let section = Structured {
            origin: [1.0, 0.5, 0.0],
            step_i: [0.1, 0.0, 0.0],
            step_j: [0.0, 0.0, -0.2],
            ni: 2,
            nj: 3,
        };
        let cells = Cells::of(&section).unwrap();
        assert_eq!(cells.counts, [2, 0, 3]);
        assert_eq!(cells.order, [4, 5, 2, 3, 0, 1]);
        assert!((cells.corner[2] - -0.5).abs() < 1e-15, "{:?}", cells.corner);
    }

    #[test]
    fn oblique_grids_have_no_cells() {
        let mut grid = Structured::contact_plane(0.0, 0.0, 1.0, 1.0, 2, 2);
        assert!(Cells::of(&grid).is_some());
        grid.step_j = [0.1, 1.0, 0.0];
        assert!(Cells::of(&grid).is_none());
        grid.step_j = [1.0, 0.0, 0.0];
        assert!(Cells::of(&grid).is_none());
    }
}
