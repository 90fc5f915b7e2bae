//! Preconditioner M of the normal contact: the inverse of the symbol of A under a triangular
//! window, in single precision.
//!
//! The window lets the kernel end smoothly within the grid. Its transform is positive (Fejér), and
//! so is the transform of A. The symbol is their convolution and thus positive too. Without the
//! window, the ripple of the cut kernel makes some values negative, and the iteration fails.

use numerics::convolution::{Complex64, Convolution, EvenSpectrum};
use numerics::vector::unit_of;

/// Approximate inverse of A, with its working memory.
#[derive(Debug)]
pub(super) struct Preconditioner {
    convolution: Convolution<f32>,
    /// Transform of the inverse, over the unit below.
    inverse: EvenSpectrum<f32>,
    unit: f64,
    field: Vec<f32>,
    image: Vec<f32>,
}

impl Preconditioner {
    /// Creates the inverse of a kernel on nx × ny elements.
    pub(super) fn new(nx: usize, ny: usize, kernel: impl Fn(i32, i32) -> f64) -> Self {
        let window = |offset: i32, count: usize| 1.0 - f64::from(offset.abs()) / count as f64;
        let symbol = Convolution::barely_padded(nx, ny)
            .spectrum(|i, j| kernel(i, j) * window(i, nx) * window(j, ny));
        let inverse = symbol.map(|value| Complex64::new(1.0 / value.re, 0.0)).even();
        Self::of(Convolution::barely_padded(nx, ny), &inverse)
    }

    /// Creates the preconditioner from the inverse of a symbol.
    pub(super) fn of(convolution: Convolution<f32>, inverse: &EvenSpectrum) -> Self {
        let (nx, ny) = convolution.shape();
        let zeros = || vec![0.0; nx * ny];
        let unit = inverse.unit();
        let inverse = inverse.rounded(unit.recip());
        Self { convolution, inverse, unit, field: zeros(), image: zeros() }
    }

    /// Multiplies waves by a factor that depends on the wave of an upstream shift alone.
    pub(super) fn with_factors(self, factor: impl Fn(Complex64) -> Complex64) -> Self {
        let (nx, ny) = self.convolution.shape();
        // A line of one element has no upstream element.
        let weight = if nx > 1 { 1.0 } else { 0.0 };
        let upstream = Convolution::<f64>::barely_padded(nx, ny).factors_along(&[(1, weight)]);
        let factors: Vec<Complex64> = upstream.into_iter().map(factor).collect();
        Self { convolution: self.convolution.with_factors(&factors), ..self }
    }

    /// Sets output = M input.
    pub(super) fn apply(&mut self, input: &[f64], output: &mut [f64]) {
        let unit = unit_of(input);
        for (single, value) in self.field.iter_mut().zip(input) {
            *single = (value / unit) as f32;
        }
        self.convolution.apply_even(&self.inverse, &self.field, &mut self.image);
        for (value, single) in output.iter_mut().zip(&self.image) {
            *value = unit * self.unit * f64::from(*single);
        }
    }
}
