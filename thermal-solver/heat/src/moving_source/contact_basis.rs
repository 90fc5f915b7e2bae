//! Elements where two surfaces touch, and shape functions for the heat that flows between them.
//!
//! The flux is Σ c_k s_k, and an error e at the elements is measured by its means over the shapes,
//! Σ s_k e / Σ s_k. The shapes are either the elements themselves, or hat functions along the rows
//! with tops two to three elements apart. Some nodes lie between the elements of the contact, such
//! as nodes of material that moves through it. They average out a flux that alternates in sign from
//! element to element, and cannot resolve such a temperature; hats exclude both. A row shorter than
//! two elements has a single hat.

/// Kind of shape functions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shapes {
    /// One shape for each element.
    Elements,
    /// Hat functions along the rows.
    Hats,
}

/// Elements in contact, with their shape functions.
#[derive(Clone, Debug)]
pub struct ContactBasis {
    shapes: Shapes,
    elements: Vec<usize>,
    /// For each element, the first of two consecutive shapes, and the weight of the second.
    at: Vec<(usize, f64)>,
    /// Sum of each shape over the elements.
    sums: Vec<f64>,
}

impl ContactBasis {
    /// Creates an empty basis.
    #[must_use]
    pub fn new(shapes: Shapes) -> Self {
        Self { shapes, elements: Vec::new(), at: Vec::new(), sums: Vec::new() }
    }

    /// Finds the elements in contact from a flux or pressure with `columns` columns: in every row,
    /// from the first to the last element with a nonzero value.
    pub fn find(&mut self, values: &[f64], columns: usize) {
        self.elements.clear();
        self.at.clear();
        let mut first_shape = 0;
        for (row, values) in values.chunks_exact(columns).enumerate() {
            let touches = |value: &f64| *value != 0.0;
            let ends = (values.iter().position(touches), values.iter().rposition(touches));
            if let (Some(first), Some(last)) = ends {
                let (start, spaces) = (row * columns, last - first);
                self.elements.extend(start + first..=start + last);
                let between = match self.shapes {
                    Shapes::Elements => spaces,
                    Shapes::Hats => spaces / 2,
                };
                self.at.extend((0..=spaces).map(|i| {
                    let place = (i * between) as f64 / spaces.max(1) as f64;
                    (first_shape + place as usize, place.fract())
                }));
                first_shape += between + 1;
            }
        }
        self.sums.clear();
        self.sums.resize(first_shape, 0.0);
        let Self { at, sums, .. } = self;
        at.iter().for_each(|at| add(sums, *at, 1.0));
    }

    /// Returns the elements in contact.
    #[must_use]
    pub fn elements(&self) -> &[usize] {
        &self.elements
    }

    /// Returns the number of shapes.
    #[must_use]
    pub fn shapes(&self) -> usize {
        self.sums.len()
    }

    /// Computes the values at the elements of a sum of shapes with these coefficients.
    pub fn spread(&self, coefficients: &[f64], values: &mut Vec<f64>) {
        values.clear();
        values.extend(self.at.iter().map(|(shape, part)| {
            let next = coefficients.get(shape + 1).copied().unwrap_or(0.0);
            (1.0 - part) * coefficients[*shape] + part * next
        }));
    }

    /// Computes the means of element values over the shapes.
    pub fn gather(&self, values: &[f64], means: &mut [f64]) {
        means.fill(0.0);
        self.at.iter().zip(values).for_each(|(at, value)| add(means, *at, *value));
        means.iter_mut().zip(&self.sums).for_each(|(mean, sum)| *mean /= sum);
    }
}

fn add(sums: &mut [f64], (shape, part): (usize, f64), value: f64) {
    sums[shape] += (1.0 - part) * value;
    if part > 0.0 {
        sums[shape + 1] += part * value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn touching(shapes: Shapes, flux: &[f64], columns: usize) -> ContactBasis {
        let mut touching = ContactBasis::new(shapes);
        touching.find(flux, columns);
        touching
    }

    #[test]
    fn elements_are_themselves() {
        let flux = [0.0, 2.0, 0.0, 3.0, 0.0, 0.0, 0.0, 1.0];
        let touching = touching(Shapes::Elements, &flux, 4);
        assert_eq!(touching.elements(), [1, 2, 3, 7]);
        let (values, mut means, mut back) = ([1.0, -2.0, 3.0, 4.0], [0.0; 4], Vec::new());
        touching.gather(&values, &mut means);
        touching.spread(&means, &mut back);
        assert_eq!(back, values);
    }

    /// Hats reproduce straight lines, and their means filter out values that alternate in sign, for
    /// any number of elements in a row.
    #[test]
    fn hats_are_straight_between_their_tops() {
        for count in 1..40 {
            let hats = touching(Shapes::Hats, &vec![1.0; count], count);
            assert_eq!(hats.shapes(), (count - 1) / 2 + 1);
            let tops = hats.shapes() - 1;
            let line: Vec<f64> = (0..=tops).map(|top| 3.0 + top as f64).collect();
            let mut values = Vec::new();
            hats.spread(&line, &mut values);
            for (i, value) in values.iter().enumerate() {
                let along = i as f64 * tops as f64 / (count - 1).max(1) as f64;
                assert!((value - 3.0 - along).abs() < 1e-12, "{count} {i} {value}");
            }
            let mut means = vec![0.0; hats.shapes()];
            hats.gather(&vec![7.0; count], &mut means);
            assert!(means.iter().all(|mean| (mean - 7.0).abs() < 1e-12), "{count}");
        }
    }
}
