//! Phases and near rows of rows that are displaced along x ([`super::Convolution::displace_rows`]).

use crate::fourier::{Complex, Real};

/// Phases of displaced rows, row by row: index j (P_x/2 + 1) + m.
#[derive(Clone, Debug)]
pub(super) struct Phases<T>(pub(super) Vec<Complex<T>>);

impl<T: Real> Phases<T> {
    /// Displaces columns of ny values, from the wave `first` on, with `len` waves a row.
    pub(super) fn displace(&self, len: usize, first: usize, columns: &mut [Complex<T>]) {
        let ny = self.0.len() / len;
        for (wave, column) in columns.chunks_exact_mut(ny).enumerate() {
            for (row, value) in column.iter_mut().enumerate() {
                *value = *value * self.0[row * len + first + wave];
            }
        }
    }
}

/// Corrections of a kernel between near rows.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct NearRows<T> {
    /// Largest distance r of rows.
    pub(super) reach: usize,
    /// Ĉ_jk/(P_x P_y), for each j first k = j − 1 … j − r, then k = j + 1 … j + r, wave by wave.
    pub(super) values: Vec<Complex<T>>,
}

impl<T: Real> NearRows<T> {
    /// Correction between a row and the `place`-th of its near rows.
    fn row(&self, row: usize, place: usize, columns: usize) -> &[Complex<T>] {
        let start = (row * 2 * self.reach + place) * columns;
        &self.values[start..start + columns]
    }

    /// Adds the effect of the near rows of a field, transformed along x, to columns of an image
    /// transformed along x. `rows` has `columns` waves a row, `image` ny values a wave, from the
    /// wave `first` on.
    pub(super) fn add(
        &self,
        rows: &[Complex<T>],
        columns: usize,
        first: usize,
        image: &mut [Complex<T>],
    ) {
        let ny = rows.len() / columns;
        let count = image.len() / ny;
        for row in 0..ny {
            for (place, source) in near(row, self.reach, ny) {
                let kernel = &self.row(row, place, columns)[first..first + count];
                let field = &rows[source * columns + first..][..count];
                for (column, (kernel, value)) in kernel.iter().zip(field).enumerate() {
                    let sum = &mut image[column * ny + row];
                    *sum = *sum + *kernel * *value;
                }
            }
        }
    }
}

/// Places and indices of the rows up to `reach` away from a row.
fn near(row: usize, reach: usize, ny: usize) -> impl Iterator<Item = (usize, usize)> {
    let below = (1..=reach.min(row)).map(move |m| (m - 1, row - m));
    let above = (1..=reach.min(ny - 1 - row)).map(move |m| (reach + m - 1, row + m));
    below.chain(above)
}

impl NearRows<f64> {
    /// Maps every value of a wave by its factor.
    pub(super) fn along(&self, factors: &[Complex<f64>]) -> Self {
        let factors = factors.iter().cycle();
        let values = self.values.iter().zip(factors).map(|(value, factor)| value * factor);
        Self { values: values.collect(), ..*self }
    }

    /// Returns the corrections times a factor, in single precision.
    pub(super) fn rounded(&self, factor: f64) -> NearRows<f32> {
        let values = self.values.iter().map(|value| single(value * factor)).collect();
        NearRows { reach: self.reach, values }
    }
}

/// Rounds to single precision.
fn single(value: Complex<f64>) -> Complex<f32> {
    Complex::new(value.re as f32, value.im as f32)
}
