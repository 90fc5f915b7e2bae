//! The steady convolution by Fourier transforms.
//!
//! T_i = Σ_k (wᵐ_k m_{i+k} + wᵉ_k e_{i+k}) is a correlation: its transform is the transform of the
//! flux times the conjugate transform of the weights. Rows are padded with zeros to at least twice
//! their length, which avoids wrap-around, and on to the next product of small primes. Plans and
//! spectra of the weights are computed once. A row costs two forward transforms and one backward
//! transform, in place, with scratch memory held here. The rounding error of the transforms is a
//! few ε log₂N of the row's largest value.

use super::reconstruction::FluxRow;
use super::stencil::Part;
use numerics::fourier::{Complex, ComplexToReal, Real, RealToComplex};
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
    /// Prepares the single part of a steady stencil over rows of `columns` elements.
    #[must_use]
    pub fn new(part: &Part<'_>, columns: usize) -> Self {
        let length = padded_length(columns);
        let (forward, back) = f64::real(length);
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

    /// Writes the correlation for one row. Returns the number of multiply-adds; a transform of
    /// length N counts as N log₂N (rounded up).
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
            .expect("lengths match the plan and the ends are real");
        values.copy_from_slice(&self.line[..self.columns]);
        self.work()
    }

    /// Transforms a line padded with zeros, into the flux spectrum `index`.
    fn transform(&mut self, index: usize, values: &[f64]) {
        let (head, tail) = self.line.split_at_mut(values.len());
        head.copy_from_slice(values);
        tail.fill(0.0);
        self.forward
            .process_with_scratch(&mut self.line, &mut self.flux[index], &mut self.scratch)
            .expect("lengths match the plan");
    }

    fn work(&self) -> u64 {
        let length = self.line.len() as u64;
        let transforms = 3 * length * u64::from(length.next_power_of_two().ilog2());
        transforms + 8 * self.weights[0].len() as u64
    }
}

/// Sets the imaginary parts of the first and last coefficient to zero, as in any real transform of
/// even length. The products leave rounding there, which the inverse transform would reject.
fn clear_imaginary_ends(spectrum: &mut [Complex<f64>]) {
    let last = spectrum.len() - 1;
    spectrum[0].im = 0.0;
    spectrum[last].im = 0.0;
}

/// Returns the smallest even product of 2, 3 and 5 that is at least twice the number of points.
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
