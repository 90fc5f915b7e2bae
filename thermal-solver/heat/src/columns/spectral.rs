//! The steady convolution over Fourier space.
//!
//! T_i = Σ_k (wᵐ_k m_{i+k} + wᵉ_k e_{i+k}) is a correlation: its transform is the flux's times the
//! conjugate of the weights'. Rows are padded with zeros to twice their length (at least), so that
//! nothing wraps round, and on to the next product of small primes. Plans and the spectra of the
//! weights are made once; a row costs two forward transforms and one back, in place, with scratch
//! held here. The transforms' rounding error is a few ε log₂N of the row's largest value.

use super::reconstruction::FluxRow;
use super::stencil::Part;
use realfft::num_complex::Complex;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use std::sync::Arc;

type Spectrum = Vec<Complex<f64>>;

/// Plans, spectra of the weights and scratch for rows of one length.
#[derive(Clone)]
pub struct Spectral {
    columns: usize,
    forward: Arc<dyn RealToComplex<f64>>,
    back: Arc<dyn ComplexToReal<f64>>,
    /// Conjugate spectra of the weights of middles and edges, divided by the length.
    weights: [Spectrum; 2],
    flux: [Spectrum; 2],
    line: Vec<f64>,
    scratch: Spectrum,
}

impl Spectral {
    /// For the single part of a steady stencil over rows of `columns` elements.
    #[must_use]
    pub fn new(part: &Part<'_>, columns: usize) -> Self {
        let length = padded_length(columns);
        let mut planner = RealFftPlanner::new();
        let (forward, back) = (planner.plan_fft_forward(length), planner.plan_fft_inverse(length));
        let scratch = forward.get_scratch_len().max(back.get_scratch_len());
        let spectrum = vec![Complex::default(); length / 2 + 1];
        let mut new = Self {
            columns,
            forward,
            back,
            weights: [spectrum.clone(), spectrum.clone()],
            flux: [spectrum.clone(), spectrum],
            line: vec![0.0; length],
            scratch: vec![Complex::default(); scratch],
        };
        for (index, weights) in [part.middle, part.edge].into_iter().enumerate() {
            new.transform(index, weights);
            for (weight, value) in new.weights[index].iter_mut().zip(&new.flux[index]) {
                *weight = value.conj() / length as f64;
            }
        }
        new
    }

    /// Writes the correlation for one row; returns the number of multiply-adds, a transform of
    /// length N counted as N log₂N (rounded up).
    pub fn apply(&mut self, row: FluxRow<'_>, values: &mut [f64]) -> u64 {
        self.transform(0, &row.middle[..=self.columns]);
        self.transform(1, &row.edge[..=self.columns]);
        let [middle, edge] = &mut self.flux;
        for (i, value) in middle.iter_mut().enumerate() {
            *value = *value * self.weights[0][i] + edge[i] * self.weights[1][i];
        }
        clear_imaginary_ends(middle);
        self.back
            .process_with_scratch(middle, &mut self.line, &mut self.scratch)
            .expect("lengths are the plan's and the ends are real");
        values.copy_from_slice(&self.line[..self.columns]);
        self.work()
    }

    /// Transform of a line padded with zeros, into the flux spectrum `index`.
    fn transform(&mut self, index: usize, values: &[f64]) {
        let (head, tail) = self.line.split_at_mut(values.len());
        head.copy_from_slice(values);
        tail.fill(0.0);
        self.forward
            .process_with_scratch(&mut self.line, &mut self.flux[index], &mut self.scratch)
            .expect("lengths are the plan's");
    }

    fn work(&self) -> u64 {
        let length = self.line.len() as u64;
        let transforms = 3 * length * u64::from(length.next_power_of_two().ilog2());
        transforms + 8 * self.weights[0].len() as u64
    }
}

/// The first and last coefficient of an even real transform are real; rounding left by the
/// products is removed because the transform back insists.
fn clear_imaginary_ends(spectrum: &mut [Complex<f64>]) {
    let last = spectrum.len() - 1;
    spectrum[0].im = 0.0;
    spectrum[last].im = 0.0;
}

/// The smallest even product of 2, 3 and 5 that is at least twice the number of points.
fn padded_length(columns: usize) -> usize {
    let smooth = |mut n: usize| {
        for prime in [2, 3, 5] {
            while n.is_multiple_of(prime) {
                n /= prime;
            }
        }
        n == 1
    };
    // Offsets of points and of edges reach `columns`, so that index i + k stays below twice that.
    let least = 2 * columns + 2;
    (least..).step_by(2).find(|n| smooth(*n)).expect("powers of two are unbounded")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn padded_lengths_are_even_smooth_and_long_enough() {
        assert_eq!(padded_length(1), 4);
        assert_eq!(padded_length(80), 162);
        assert_eq!(padded_length(1281), 2592);
    }
}
