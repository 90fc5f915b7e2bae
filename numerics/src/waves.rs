//! Periodic fields in x and y as sums of waves.
//!
//! A field on nx × ny elements is f(i, j) = Σ_{k,l} f̂(k, l) e^{2πi(ik/nx + jl/ny)}, |k| ≤ nx/2,
//! |l| ≤ ny/2. The field is real, so only the waves 0 ≤ k ≤ nx/2 are stored, row by row of constant
//! l. nx is even. Nothing is allocated after construction.

use crate::convolution::{Complex64, signed};
use crate::fourier::{ComplexToReal, Fft, Real, RealToComplex};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Plans and working memory for the waves of one grid.
pub struct Waves {
    nx: usize,
    ny: usize,
    rows: (Arc<dyn RealToComplex<f64>>, Arc<dyn ComplexToReal<f64>>),
    columns: [Arc<dyn Fft<f64>>; 2],
    row: Vec<f64>,
    half: Vec<Complex64>,
    column: Vec<Complex64>,
    scratch: Vec<Complex64>,
}

impl Waves {
    /// Plans the transforms of nx × ny elements.
    ///
    /// # Panics
    /// Panics if ny is zero, or if nx is odd or zero.
    #[must_use]
    pub fn new(nx: usize, ny: usize) -> Self {
        let even = nx > 0 && nx.is_multiple_of(2);
        assert!(even && ny > 0, "{nx} x {ny} elements are not an even number along x");
        let rows = f64::real(nx);
        let columns = f64::complex(ny);
        let scratch = [
            rows.0.get_scratch_len(),
            rows.1.get_scratch_len(),
            columns[0].get_inplace_scratch_len(),
            columns[1].get_inplace_scratch_len(),
        ];
        let zeros = |len: usize| vec![Complex64::default(); len];
        Self {
            nx,
            ny,
            rows,
            columns,
            row: vec![0.0; nx],
            half: zeros((nx / 2 + 1) * ny),
            column: zeros(ny),
            scratch: zeros(scratch.into_iter().max().unwrap_or(0)),
        }
    }

    /// Returns the number of stored waves.
    #[must_use]
    pub fn count(&self) -> usize {
        self.half.len()
    }

    /// Returns the wave numbers (k, l): the numbers of periods along x and y.
    #[must_use]
    pub fn numbers(&self, wave: usize) -> (i32, i32) {
        let columns = self.nx / 2 + 1;
        (signed(wave % columns, self.nx), signed(wave / columns, self.ny))
    }

    /// Computes the waves f̂ of a field.
    ///
    /// # Panics
    /// Panics if a length differs from that of the grid.
    pub fn of(&mut self, field: &[f64], waves: &mut [Complex64]) {
        let columns = self.nx / 2 + 1;
        assert!(field.len() == self.nx * self.ny && waves.len() == self.count());
        for (values, waves) in field.chunks_exact(self.nx).zip(waves.chunks_exact_mut(columns)) {
            self.row.copy_from_slice(values);
            let done = self.rows.0.process_with_scratch(&mut self.row, waves, &mut self.scratch);
            done.expect("all lengths are the plan's");
        }
        let scale = ((self.nx * self.ny) as f64).recip();
        waves.iter_mut().for_each(|wave| *wave *= scale);
        let forward = Arc::clone(&self.columns[0]);
        self.along_y(waves, &*forward);
    }

    /// Computes the field of a set of waves.
    ///
    /// # Panics
    /// Panics if a length differs from that of the grid.
    pub fn sum(&mut self, waves: &[Complex64], field: &mut [f64]) {
        let columns = self.nx / 2 + 1;
        assert!(field.len() == self.nx * self.ny && waves.len() == self.count());
        let mut half = std::mem::take(&mut self.half);
        half.copy_from_slice(waves);
        let inverse = Arc::clone(&self.columns[1]);
        self.along_y(&mut half, &*inverse);
        for (waves, values) in half.chunks_exact_mut(columns).zip(field.chunks_exact_mut(self.nx)) {
            // Real within rounding; the plan requires exactly real values.
            waves[0].im = 0.0;
            waves[columns - 1].im = 0.0;
            let done = self.rows.1.process_with_scratch(waves, values, &mut self.scratch);
            done.expect("all lengths are the plan's and the ends are real");
        }
        self.half = half;
    }

    /// Returns the sum of waves at a point, given in elements from the first element.
    #[must_use]
    pub fn at(&self, waves: &[Complex64], i: f64, j: f64) -> f64 {
        let last = (self.nx / 2) as i32;
        let part = |(wave, value): (usize, &Complex64)| {
            let (k, l) = self.numbers(wave);
            let angle =
                TAU * (i * f64::from(k) / self.nx as f64 + j * f64::from(l) / self.ny as f64);
            let twice = if k == 0 || k == last { 1.0 } else { 2.0 };
            twice * (value.re * angle.cos() - value.im * angle.sin())
        };
        waves.iter().enumerate().map(part).sum()
    }

    fn along_y(&mut self, waves: &mut [Complex64], plan: &dyn Fft<f64>) {
        if self.ny == 1 {
            return;
        }
        let columns = self.nx / 2 + 1;
        for first in 0..columns {
            for (line, value) in self.column.iter_mut().enumerate() {
                *value = waves[line * columns + first];
            }
            plan.process_with_scratch(&mut self.column, &mut self.scratch);
            for (line, value) in self.column.iter().enumerate() {
                waves[line * columns + first] = *value;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Given waves are recovered, and their sum equals the field, at elements and, by direct
    /// summation, between them. Tolerance: rounding.
    #[test]
    fn there_and_back() {
        for (nx, ny) in [(8, 1), (8, 6), (6, 5), (2, 3)] {
            let mut waves = Waves::new(nx, ny);
            let value = |at: usize| ((at * 7919 + 13) % 101) as f64 / 101.0;
            let field: Vec<f64> = (0..nx * ny).map(value).collect();
            let mut found = vec![Complex64::default(); waves.count()];
            let mut back = vec![0.0; field.len()];
            waves.of(&field, &mut found);
            waves.sum(&found, &mut back);
            for (at, value) in field.iter().enumerate() {
                assert!((back[at] - value).abs() < 1e-14, "{nx} x {ny}: {at}");
                let place = waves.at(&found, (at % nx) as f64, (at / nx) as f64);
                assert!((place - value).abs() < 1e-13, "{nx} x {ny}: {place} {value}");
            }
        }
    }

    #[test]
    fn one_wave() {
        let mut waves = Waves::new(16, 8);
        let angle = |i: f64, j: f64| TAU * (3.0 * i / 16.0 - 2.0 * j / 8.0) + 0.4;
        let field: Vec<f64> =
            (0..128).map(|at| angle((at % 16) as f64, (at / 16) as f64).cos()).collect();
        let mut found = vec![Complex64::default(); waves.count()];
        waves.of(&field, &mut found);
        for (wave, value) in found.iter().enumerate() {
            let expected = if waves.numbers(wave) == (3, -2) { 0.5 } else { 0.0 };
            assert!((value.norm() - expected).abs() < 1e-15, "{:?} {value}", waves.numbers(wave));
        }
        assert!((waves.at(&found, 2.3, 5.7) - angle(2.3, 5.7).cos()).abs() < 1e-14);
    }
}
