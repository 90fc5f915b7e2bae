//! Kernels that are even under a reversal of both distances, as those of elastic bodies are.
//!
//! Their transforms are real, which takes half of the memory and of the work. Factors of the waves
//! along x, as of a difference, belong to the [`Convolution`] ([`Convolution::with_factors`]).

use super::near_rows::NearRows;
use super::{Convolution, Spectrum};
use crate::fourier::{Complex, Real};
use crate::vector::unit_of;
use std::ops::Range;

/// Real transform of an even kernel on the padded grid.
#[derive(Clone, Debug, PartialEq)]
pub struct EvenSpectrum<T = f64> {
    /// Â(k, l)/(P_x P_y), in the order of a [`Spectrum`].
    values: Vec<T>,
    /// P_x P_y.
    size: f64,
    /// Corrections between near rows, if rows are displaced.
    pub(super) near: Option<NearRows<T>>,
}

impl Spectrum {
    /// Returns the transform of the even part of the kernel.
    #[must_use]
    pub fn even(&self) -> EvenSpectrum {
        let values = self.values.iter().map(|value| value.re).collect();
        EvenSpectrum { values, size: self.size, near: None }
    }
}

impl EvenSpectrum {
    /// Power of two next below the largest value.
    #[must_use]
    pub fn unit(&self) -> f64 {
        unit_of(&self.values)
    }

    /// Returns the spectrum times a factor, in single precision.
    #[must_use]
    pub fn rounded(&self, factor: f64) -> EvenSpectrum<f32> {
        let values = self.values.iter().map(|value| (value * factor) as f32).collect();
        let near = self.near.as_ref().map(|near| near.rounded(factor));
        EvenSpectrum { values, size: self.size, near }
    }
}

impl<T: Real> Convolution<T> {
    /// Computes the convolution of `input` with an even kernel; both fields have nx·ny values.
    ///
    /// # Panics
    /// Panics if a field or the spectrum belongs to another grid.
    pub fn apply_even(&mut self, kernel: &EvenSpectrum<T>, input: &[T], output: &mut [T]) {
        self.check_even(&[kernel]);
        self.check(&[], &[input], &[output]);
        self.rows_in(0, input);
        let multiply = |range: Range<usize>, [block, _]: [&mut [Complex<T>]; 2]| {
            for (value, factor) in block.iter_mut().zip(&kernel.values[range]) {
                *value = value.scale(*factor);
            }
        };
        let near = [[kernel.near.as_ref(), None], [None; 2]];
        self.through([true, false], [true, false], multiply, near);
        self.rows_out(0, output);
    }

    /// Computes the convolution of a vector field with a symmetric tensor \[xx, yy, xy\] of even
    /// kernels.
    ///
    /// # Panics
    /// Panics if a field or a spectrum belongs to another grid.
    pub fn apply_even_tensor(
        &mut self,
        kernels: &[EvenSpectrum<T>; 3],
        input: [&[T]; 2],
        output: [&mut [T]; 2],
    ) {
        let [xx, yy, xy] = kernels;
        let [output_x, output_y] = output;
        self.check_even(&[xx, yy, xy]);
        self.check(&[], &input, &[output_x, output_y]);
        self.rows_in(0, input[0]);
        self.rows_in(1, input[1]);
        let multiply = |range: Range<usize>, [block_x, block_y]: [&mut [Complex<T>]; 2]| {
            let [xx, yy, xy] = [xx, yy, xy].map(|kernel| &kernel.values[range.clone()]);
            let fields = block_x.iter_mut().zip(block_y.iter_mut());
            for (((x, y), xx), (yy, xy)) in fields.zip(xx).zip(yy.iter().zip(xy)) {
                (*x, *y) = (x.scale(*xx) + y.scale(*xy), x.scale(*xy) + y.scale(*yy));
            }
        };
        let [xx, yy, xy] = [xx, yy, xy].map(|kernel| kernel.near.as_ref());
        self.through([true, true], [true, true], multiply, [[xx, xy], [xy, yy]]);
        self.rows_out(0, output_x);
        self.rows_out(1, output_y);
    }

    fn check_even(&self, kernels: &[&EvenSpectrum<T>]) {
        let (len, size) = (self.columns() * self.padded_y, (self.padded_x * self.padded_y) as f64);
        let fits = |kernel: &&EvenSpectrum<T>| kernel.values.len() == len && kernel.size == size;
        let [nx, ny] = [self.nx, self.ny];
        assert!(kernels.iter().all(fits), "a spectrum is not of the grid of {nx} x {ny} elements");
    }
}
