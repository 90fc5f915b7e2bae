//! Fields on a plane of cells, as the report draws them.

use run::results::cells::Cells;
use run::results::last::LastField;
use run::results::vtk::INTERFACE;

/// A box of cells with fields.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Corner of the box with the smallest coordinates \[m\].
    pub corner: [f64; 3],
    /// Side lengths of a cell \[m\].
    pub spacing: [f64; 3],
    /// Number of cells along x, y, z; 0 along the normal of the plane.
    pub cells: [usize; 3],
    /// Fields on the cells.
    pub fields: Vec<Field>,
}

/// A field on the cells of an image.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Name of the field.
    pub name: String,
    /// SI unit.
    pub unit: String,
    /// Short description.
    pub meaning: String,
    /// Number of vector components; 1 for a scalar.
    pub components: usize,
    /// Whether the field exists only where the bodies touch. A field of a body is everywhere.
    pub in_contact: bool,
    /// Values cell by cell, x fastest; the components of a cell are adjacent.
    pub values: Vec<f64>,
}

impl Image {
    /// Collects the fields of one grid; `None` without a field, or if the grid is not aligned with
    /// the axes.
    #[must_use]
    pub fn of<'a>(fields: impl Iterator<Item = &'a LastField<'a>>) -> Option<Self> {
        let mut fields = fields.peekable();
        let Cells { corner, spacing, counts, order } = Cells::of(&fields.peek()?.grid)?;
        let fields = fields.map(|field| Field::of(field, &order)).collect();
        Some(Self { corner, spacing, cells: counts, fields })
    }

    /// Looks up a field by name.
    #[must_use]
    pub fn field(&self, name: &str) -> Option<&Field> {
        self.fields.iter().find(|field| field.name == name)
    }

    /// The two axes of the plane of cells, in the order x, y, z.
    #[must_use]
    pub fn plane(&self) -> Option<[usize; 2]> {
        let axes: Vec<usize> = (0..3).filter(|&axis| self.cells[axis] > 0).collect();
        axes.try_into().ok()
    }

    /// Lower and upper border along an axis \[m\].
    #[must_use]
    pub fn borders(&self, axis: usize) -> [f64; 2] {
        let low = self.corner[axis];
        [low, low + self.cells[axis] as f64 * self.spacing[axis]]
    }

    /// Centre of the n-th cell along an axis \[m\].
    #[must_use]
    pub fn middle(&self, axis: usize, n: usize) -> f64 {
        self.corner[axis] + (n as f64 + 0.5) * self.spacing[axis]
    }

    /// Column of cells through the largest value of a field: its position along the first axis of
    /// the plane \[m\]; distance from the origin of the second axis \[m\] and value for each cell.
    #[must_use]
    pub fn through_largest(&self, field: &Field) -> Option<(f64, Vec<[f64; 2]>)> {
        let [along, upright] = self.plane()?;
        let columns = self.cells[along];
        let (largest, _) = field.values.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1))?;
        let column = largest % columns;
        let point = |row: usize| {
            let value = field.values[row * columns + column];
            [self.middle(upright, row).abs(), value]
        };
        let mut points: Vec<[f64; 2]> = (0..self.cells[upright]).map(point).collect();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        Some((self.middle(along, column), points))
    }

    /// Row of cells nearest to the origin of the second axis of the plane, which is the surface of
    /// a section: position \[m\] and value for each cell.
    #[must_use]
    pub fn along_surface(&self, field: &Field) -> Option<Vec<[f64; 2]>> {
        let [along, upright] = self.plane()?;
        let columns = self.cells[along];
        let from_surface = |row: &usize| self.middle(upright, *row).abs();
        let row =
            (0..self.cells[upright]).min_by(|a, b| from_surface(a).total_cmp(&from_surface(b)))?;
        let point =
            |column: usize| [self.middle(along, column), field.values[row * columns + column]];
        Some((0..columns).map(point).collect())
    }
}

impl Field {
    /// Copies a field with its cells in this order.
    fn of(field: &LastField<'_>, order: &[usize]) -> Self {
        let components = field.kind.components as usize;
        let of = |&at: &usize| (0..components).map(move |component| component * order.len() + at);
        Self {
            name: field.kind.name.clone(),
            unit: field.kind.unit.clone(),
            meaning: field.kind.meaning.clone(),
            components,
            in_contact: field.kind.body == INTERFACE,
            values: order.iter().flat_map(of).map(|at| field.values[at]).collect(),
        }
    }

    /// One number per cell: the value, or the length of the vector.
    #[must_use]
    pub fn magnitudes(&self) -> Vec<f64> {
        let length = |cell: &[f64]| match cell {
            [value] => *value,
            vector => vector.iter().map(|v| v * v).sum::<f64>().sqrt(),
        };
        self.values.chunks_exact(self.components).map(length).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contract::field::{PRESSURE, TRACTION};
    use contract::grid::Structured;
    use run::results::vtk::FieldLabel;
    use std::borrow::Cow;

    #[test]
    fn values_stand_in_their_cells() {
        let grid = Structured {
            origin: [-0.25, 0.0, -1.5],
            step_i: [0.5, 0.0, 0.0],
            step_j: [0.0, 0.0, -1.0],
            ni: 3,
            nj: 2,
        };
        let field = |kind, values: Vec<f64>| {
            let (kind, values) = (Cow::Owned(kind), Cow::Owned(values));
            LastField { series: String::new(), grid, kind, values }
        };
        let scalar =
            field(FieldLabel::of(&PRESSURE.kind(), None), vec![1.0, 2.0, 3.0, 4.0, 9.0, 6.0]);
        let vector =
            field(FieldLabel::of(&TRACTION.kind(), None), (0..12).map(f64::from).collect());
        let image = Image::of([&scalar, &vector].into_iter()).unwrap();
        assert_eq!((image.plane(), image.cells), (Some([0, 2]), [3, 0, 2]));
        assert_eq!((image.borders(0), image.borders(2)), ([-0.5, 1.0], [-3.0, -1.0]));
        assert_eq!(image.middle(0, 2), 0.75);
        let [p, t] = &image.fields[..] else { panic!("{image:?}") };
        assert_eq!((p.name.as_str(), p.unit.as_str()), ("pressure", "Pa"));
        assert_eq!(p.values, [4.0, 9.0, 6.0, 1.0, 2.0, 3.0], "the lower row first");
        assert_eq!(t.values[..4], [3.0, 9.0, 4.0, 10.0]);
        assert_eq!(t.magnitudes()[3], 6.0);
        let (place, points) = image.through_largest(p).unwrap();
        assert_eq!((place, points), (0.25, vec![[1.5, 2.0], [2.5, 9.0]]));
    }
}
