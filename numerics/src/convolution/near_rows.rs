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
    /// Number of rows ny.
    count: usize,
    /// Largest distance r of rows.
    reach: usize,
    /// Ĉ_jk/P_x, wave by wave; in each k = j − 1 … j − r, then k = j + 1 … j + r, each with
    /// one value for every row j.
    values: Vec<Complex<T>>,
}

impl<T: Real> NearRows<T> {
    /// Creates corrections of zero for `count` rows of `columns` waves.
    pub(super) fn zero(count: usize, reach: usize, columns: usize) -> Self {
        let values = vec![Complex::new(T::zero(), T::zero()); columns * 2 * reach * count];
        Self { count, reach, values }
    }

    /// Adds the effects of the near rows of a field on an image, both as columns of ny values, from
    /// the wave `first` on.
    pub(super) fn add(&self, field: &[Complex<T>], first: usize, image: &mut [Complex<T>]) {
        let Self { count, reach, values } = self;
        let kernels = values[first * 2 * reach * count..].chunks_exact(2 * reach * count);
        let columns = field.chunks_exact(*count).zip(image.chunks_exact_mut(*count));
        for ((field, image), kernels) in columns.zip(kernels) {
            for (place, kernel) in kernels.chunks_exact(*count).enumerate() {
                let (image, kernel, field) = match place < *reach {
                    true => {
                        let apart = place + 1;
                        (&mut image[apart..], &kernel[apart..], &field[..count - apart])
                    }
                    false => {
                        let apart = place - reach + 1;
                        (&mut image[..count - apart], kernel, &field[apart..])
                    }
                };
                for ((sum, kernel), value) in image.iter_mut().zip(kernel).zip(field) {
                    *sum = *sum + *kernel * *value;
                }
            }
        }
    }
}

impl NearRows<f64> {
    /// Sets the correction between a row and the one `apart` before it.
    pub(super) fn set(&mut self, row: usize, apart: usize, wave: usize, value: Complex<f64>) {
        let Self { count, reach, values } = self;
        let start = wave * 2 * *reach;
        values[(start + apart - 1) * *count + row] = value;
        values[(start + *reach + apart - 1) * *count + row - apart] = value.conj();
    }

    /// Returns the corrections times a factor, in single precision.
    pub(super) fn rounded(&self, factor: f64) -> NearRows<f32> {
        let values = self.values.iter().map(|value| single(value * factor)).collect();
        NearRows { count: self.count, reach: self.reach, values }
    }
}

/// Rounds to single precision.
fn single(value: Complex<f64>) -> Complex<f32> {
    Complex::new(value.re as f32, value.im as f32)
}
