//! Where two surfaces touch, and the shapes in which what flows between them is sought.
//!
//! What flows is Σ c_k s_k, and an error e at the elements is measured as its means over the shapes,
//! Σ s_k e / Σ s_k. The shapes are either the elements themselves, or hats along the rows whose tops are two to three
//! elements apart. Nodes that lie between the elements of the contact, as those of material that moves through it,
//! receive nothing of a flux that changes its sign from one element to the next, and show nothing of such a temperature:
//! in hats neither occurs. A row that is shorter than two elements is one hat.

/// Kind of the shapes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shapes {
    /// One each element.
    Elements,
    /// Hats along the rows.
    Hats,
}

/// Elements that touch, and the shapes on them.
#[derive(Clone, Debug)]
pub struct ContactBasis {
    shapes: Shapes,
    elements: Vec<usize>,
    /// For each element the first of two shapes that follow each other, and the part of the second.
    at: Vec<(usize, f64)>,
    /// Σ of a shape over the elements.
    sums: Vec<f64>,
}

impl ContactBasis {
    /// Nothing touches yet.
    #[must_use]
    pub fn new(shapes: Shapes) -> Self {
        Self { shapes, elements: Vec::new(), at: Vec::new(), sums: Vec::new() }
    }

    /// Finds the elements that touch, by a flux or pressure of so many columns: in every row from the first element with some to the last.
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

    /// The elements.
    #[must_use]
    pub fn elements(&self) -> &[usize] {
        &self.elements
    }

    /// Number of shapes.
    #[must_use]
    pub fn shapes(&self) -> usize {
        self.sums.len()
    }

    /// Values of a sum of shapes with these coefficients at the elements.
    pub fn spread(&self, coefficients: &[f64], values: &mut Vec<f64>) {
        values.clear();
        values.extend(self.at.iter().map(|(shape, part)| {
            let next = coefficients.get(shape + 1).copied().unwrap_or(0.0);
            (1.0 - part) * coefficients[*shape] + part * next
        }));
    }

    /// Means over the shapes of values at the elements.
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

    /// Hats make straight lines, and their means see no values that change sign from element to element, however many
    /// elements a row has.
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
