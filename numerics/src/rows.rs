//! Convolution with kernels that depend on the distance along x and on both positions across x.
//!
//! out(i, t) = Σ_{i', q} A(i − i'; t, q) in(i', q) on a grid of nx × ny elements, with zero input
//! outside. Rows are transformed along x by real Fourier transforms, padded to 2 nx, where the sum
//! over i' becomes a product. The sum over the rows q is computed wave by wave. Kernels are even or
//! odd along x, so that their transforms are real or imaginary.
//!
//! A product takes ny² nx operations, plus nx log nx per row.

use crate::convolution::{Complex64, smooth_size};
use crate::fourier::{ComplexToReal, Real, RealToComplex};
use std::sync::Arc;

/// Parity of a kernel in the distance along x.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parity {
    /// A(−i) = A(i).
    Even,
    /// A(−i) = −A(i), zero at i = 0.
    Odd,
}

/// Transform of a kernel, for the grid of a [`Rows`].
#[derive(Clone, Debug, PartialEq)]
pub struct Kernel {
    parity: Parity,
    /// Real or imaginary part over the padded length, ordered by t, then q, then wave.
    values: Vec<f64>,
}

/// Plans and working memory for one grid.
pub struct Rows {
    nx: usize,
    ny: usize,
    padded: usize,
    forward: Arc<dyn RealToComplex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
    row: Vec<f64>,
    scratch: Vec<Complex64>,
    /// Transformed rows.
    input: Vec<Complex64>,
    output: Vec<Complex64>,
}

impl std::fmt::Debug for Rows {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "Rows({} x {}, padded to {})", self.nx, self.ny, self.padded)
    }
}

impl Rows {
    /// Plans the transforms for nx × ny elements.
    ///
    /// # Panics
    /// Panics if a count is zero.
    #[must_use]
    pub fn new(nx: usize, ny: usize) -> Self {
        assert!(nx > 0 && ny > 0, "a grid of {nx} x {ny} elements is empty");
        let padded = 2 * smooth_size(nx);
        let (forward, inverse) = f64::real(padded);
        let scratch = forward.get_scratch_len().max(inverse.get_scratch_len());
        let half = vec![Complex64::default(); ny * (padded / 2 + 1)];
        Self {
            nx,
            ny,
            padded,
            forward,
            inverse,
            row: vec![0.0; padded],
            scratch: vec![Complex64::default(); scratch],
            input: half.clone(),
            output: half,
        }
    }

    /// Returns the numbers of elements along x and y.
    #[must_use]
    pub fn shape(&self) -> (usize, usize) {
        (self.nx, self.ny)
    }

    /// Returns the transform of the kernel `kernel(i, t, q)`: the effect of row q on row t at a
    /// distance of i ≥ 0 elements, target minus source.
    #[must_use]
    pub fn kernel(
        &mut self,
        parity: Parity,
        kernel: impl Fn(usize, usize, usize) -> f64,
    ) -> Kernel {
        let (ny, waves) = (self.ny, self.padded / 2 + 1);
        let mut values = Vec::with_capacity(ny * ny * waves);
        let mut transformed = vec![Complex64::default(); waves];
        for at in 0..ny * ny {
            let (t, q) = (at / ny, at % ny);
            self.row.fill(0.0);
            for i in 0..self.nx {
                let value = kernel(i, t, q);
                match (parity, i) {
                    (Parity::Even, 0) => self.row[0] = value,
                    (Parity::Odd, 0) => {}
                    (Parity::Even, _) => (self.row[i], self.row[self.padded - i]) = (value, value),
                    (Parity::Odd, _) => (self.row[i], self.row[self.padded - i]) = (value, -value),
                }
            }
            self.transform(&mut transformed);
            let size = self.padded as f64;
            values.extend(transformed.iter().map(|value| match parity {
                Parity::Even => value.re / size,
                Parity::Odd => value.im / size,
            }));
        }
        Kernel { parity, values }
    }

    /// Computes the sum of the convolutions of fields of nx·ny values, each with its kernel.
    ///
    /// # Panics
    /// Panics if a field or a kernel belongs to another grid.
    pub fn apply(&mut self, terms: &[(&Kernel, &[f64])], output: &mut [f64]) {
        let (nx, ny, waves) = (self.nx, self.ny, self.padded / 2 + 1);
        assert_eq!(output.len(), nx * ny, "a field is not of the grid of {nx} x {ny} elements");
        self.output.fill(Complex64::default());
        for (kernel, field) in terms {
            assert!(
                field.len() == nx * ny && kernel.values.len() == ny * ny * waves,
                "a field or kernel is not of the grid of {nx} x {ny} elements"
            );
            let mut input = std::mem::take(&mut self.input);
            for (values, row) in field.chunks_exact(nx).zip(input.chunks_exact_mut(waves)) {
                self.row[..nx].copy_from_slice(values);
                self.row[nx..].fill(0.0);
                self.transform(row);
            }
            if kernel.parity == Parity::Odd {
                input.iter_mut().for_each(|value| *value = Complex64::new(-value.im, value.re));
            }
            let targets = self.output.chunks_exact_mut(waves);
            for (target, factors) in targets.zip(kernel.values.chunks_exact(ny * waves)) {
                for (source, factors) in input.chunks_exact(waves).zip(factors.chunks_exact(waves))
                {
                    for ((sum, value), factor) in target.iter_mut().zip(source).zip(factors) {
                        *sum += value * factor;
                    }
                }
            }
            self.input = input;
        }
        for (row, values) in self.output.chunks_exact_mut(waves).zip(output.chunks_exact_mut(nx)) {
            // Zero within rounding; the plan requires exact zeros.
            (row[0].im, row[waves - 1].im) = (0.0, 0.0);
            self.inverse
                .process_with_scratch(row, &mut self.row, &mut self.scratch)
                .expect("all lengths are the plan's and the ends are real");
            values.copy_from_slice(&self.row[..nx]);
        }
    }

    /// Transforms `row`, whose content is destroyed.
    fn transform(&mut self, transformed: &mut [Complex64]) {
        self.forward
            .process_with_scratch(&mut self.row, transformed, &mut self.scratch)
            .expect("all lengths are the plan's");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares with the direct sum, for an even and an odd kernel.
    #[test]
    fn products_are_the_sums() {
        let (nx, ny) = (7, 4);
        let even = |i: usize, t: usize, q: usize| ((1 + i) as f64).recip() + (t * t + 3 * q) as f64;
        let odd = |i: usize, t: usize, q: usize| i as f64 * (0.3 + t as f64 - 2.0 * q as f64);
        let field = |seed: usize| -> Vec<f64> {
            (0..nx * ny).map(|at| ((at * 37 + seed) % 11) as f64 - 5.0).collect()
        };
        let (one, other) = (field(1), field(4));
        let mut rows = Rows::new(nx, ny);
        let kernels = [rows.kernel(Parity::Even, even), rows.kernel(Parity::Odd, odd)];
        let mut output = vec![0.0; nx * ny];
        rows.apply(&[(&kernels[0], &one), (&kernels[1], &other)], &mut output);
        for (at, value) in output.iter().enumerate() {
            let (i, t) = (at % nx, at / nx);
            let mut sum = 0.0;
            for q in 0..ny {
                for source in 0..nx {
                    let distance = i.abs_diff(source);
                    let sign = if i < source { -1.0 } else { 1.0 };
                    let from = q * nx + source;
                    sum +=
                        even(distance, t, q) * one[from] + sign * odd(distance, t, q) * other[from];
                }
            }
            assert!((value - sum).abs() < 1e-9, "{at}: {value} {sum}");
        }
    }
}
