//! Structured grids as image data.

use super::file::{cell_data, opening, write_values};
use super::shown::Fields;
use contract::grid::Structured;
use std::io::{self, Write};

/// A structured grid as VTK sees it: cells along x, y, z from a corner, with positive spacing.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Image {
    corner: [f64; 3],
    spacing: [f64; 3],
    cells: [usize; 3],
    /// The grid's own index of the cell at VTK's `n`-th place.
    order: Vec<usize>,
}

impl Image {
    /// `None` if a step is not along one axis, or both are along the same.
    pub(super) fn of(grid: &Structured) -> Option<Self> {
        let axis = |step: &[f64; 3]| {
            let mut along = (0..3).filter(|&k| step[k] != 0.0);
            along.next().filter(|_| along.next().is_none())
        };
        let (ai, aj) = (axis(&grid.step_i)?, axis(&grid.step_j)?);
        if ai == aj {
            return None;
        }
        let (si, sj) = (grid.step_i[ai], grid.step_j[aj]);
        let mut image = Self {
            corner: grid.origin,
            spacing: [si.abs().min(sj.abs()); 3],
            cells: [0; 3],
            order: Vec::with_capacity(grid.points()),
        };
        for (axis, step, count) in [(ai, si, grid.ni), (aj, sj, grid.nj)] {
            let first = if step > 0.0 { 0.0 } else { (count - 1) as f64 * step };
            image.corner[axis] += first - 0.5 * step.abs();
            image.spacing[axis] = step.abs();
            image.cells[axis] = count;
        }
        let along = |step: f64, count: usize, n: usize| if step > 0.0 { n } else { count - 1 - n };
        let index = |i: usize, j: usize| along(sj, grid.nj, j) * grid.ni + along(si, grid.ni, i);
        if ai < aj {
            image.order.extend((0..grid.nj).flat_map(|j| (0..grid.ni).map(move |i| index(i, j))));
        } else {
            image.order.extend((0..grid.ni).flat_map(|i| (0..grid.nj).map(move |j| index(i, j))));
        }
        Some(image)
    }

    /// Writes the whole file.
    pub(super) fn write(&self, out: &mut impl Write, fields: &Fields, time: f64) -> io::Result<()> {
        let [nx, ny, nz] = self.cells;
        let extent = format!("0 {nx} 0 {ny} 0 {nz}");
        let three = |v: &[f64; 3]| format!("{:e} {:e} {:e}", v[0], v[1], v[2]);
        let attributes = format!(
            " WholeExtent=\"{extent}\" Origin=\"{}\" Spacing=\"{}\"",
            three(&self.corner),
            three(&self.spacing)
        );
        out.write_all(opening("ImageData", &attributes, fields, time).as_bytes())?;
        writeln!(out, "    <Piece Extent=\"{extent}\">")?;
        out.write_all(cell_data("ImageData", fields, self.order.len(), 0).as_bytes())?;
        write_values(out, fields, self.order.iter().copied())
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
        let image = Image::of(&section).unwrap();
        assert_eq!(image.cells, [2, 0, 3]);
        assert_eq!(image.order, [4, 5, 2, 3, 0, 1]);
        assert!((image.corner[2] - -0.5).abs() < 1e-15, "{:?}", image.corner);
    }

    #[test]
    fn oblique_grids_are_no_images() {
        let mut grid = Structured::contact_plane(0.0, 0.0, 1.0, 1.0, 2, 2);
        assert!(Image::of(&grid).is_some());
        grid.step_j = [0.1, 1.0, 0.0];
        assert!(Image::of(&grid).is_none());
        grid.step_j = [1.0, 0.0, 0.0];
        assert!(Image::of(&grid).is_none());
    }
}
