//! Rows that are displaced along x by parts of an element.
//!
//! Element (i, j) lies at i + δ_j, with the displacement δ_j of its row [elements]. A function of x
//! is displaced by a phase of its transform. With the transforms p̂_k of the rows, the sum of the
//! effects of all rows k is, wave by wave,
//!
//! û_j = φ_j (Σ_k Â_{j−k} φ̄_k p̂_k + Σ_{|j−k| ≤ r} Ĉ_jk φ̄_k p̂_k),   φ_j(m) = e^(2πi m δ_j/P_x).
//!
//! The first sum is a convolution between two phases, and exact for kernels that are smooth on the
//! scale of an element. Between near rows they are not: φ_j Ĉ_jk φ̄_k is the difference of the
//! exact kernel, sampled at i + δ_j − δ_k, and the displaced one. In a row itself both agree. The
//! alternating wave m = P_x/2 cannot be displaced, and its phase is 1.
//!
//! A symmetric kernel stays symmetric, and the sum over each pair of rows stays a cyclic
//! convolution along x, which commutes with differences along x. The kernel fills the padding, so
//! that nothing is cut off.

use super::near_rows::{NearRows, Phases};
use super::{Complex64, Convolution, EvenSpectrum, offset, smooth_size, wrapped};
use crate::fourier::{Complex, Real};
use std::f64::consts::TAU;

/// Elements of padding needed by differences along x over up to two elements.
const MARGIN: usize = 2;

impl<T: Real> Convolution<T> {
    /// Plans the transforms for nx × ny elements in rows that will be displaced, with padding for
    /// differences along x.
    ///
    /// # Panics
    /// Panics if a count is zero.
    #[must_use]
    pub fn of_rows(nx: usize, ny: usize) -> Self {
        assert!(nx > 0 && ny > 0, "a grid of {nx} x {ny} elements is empty");
        Self::padded(nx, ny, 2 * smooth_size(nx + MARGIN), smooth_size(2 * ny - 1))
    }

    /// Displaces the rows along x by parts of an element, towards larger x.
    ///
    /// # Panics
    /// Panics if there is not one displacement a row.
    #[must_use]
    pub fn displace_rows(mut self, displacements: &[f64]) -> Self {
        assert_eq!(displacements.len(), self.ny, "one displacement a row is expected");
        let (last, padded) = (self.columns() - 1, self.padded_x as f64);
        let phase = |displacement: f64, wave: usize| match wave == last {
            true => Complex64::ONE,
            false => Complex64::cis(TAU * displacement * wave as f64 / padded),
        };
        let values = displacements.iter().flat_map(|by| (0..=last).map(move |m| phase(*by, m)));
        let number = |value: f64| T::from_f64(value).expect("a phase is a number of any precision");
        let values = values.map(|phase| Complex::new(number(phase.re), number(phase.im)));
        let phases = Phases(values.collect());
        (self.leaving, self.phases) = (Some(phases.clone()), Some(phases));
        self
    }

    /// Multiplies the waves along x of every image by these factors, as a difference along x does.
    ///
    /// # Panics
    /// Panics if there is not one factor a wave.
    #[must_use]
    pub fn with_factors(mut self, factors: &[Complex64]) -> Self {
        assert_eq!(factors.len(), self.columns(), "one factor a wave is expected");
        let number =
            |value: f64| T::from_f64(value).expect("a factor is a number of any precision");
        let factors = factors.iter().map(|value| Complex::new(number(value.re), number(value.im)));
        let factors: Vec<_> = factors.collect();
        let Phases(leaving) = self.leaving.get_or_insert_with(|| {
            Phases(vec![Complex::new(T::one(), T::zero()); self.ny * factors.len()])
        });
        for row in leaving.chunks_exact_mut(factors.len()) {
            row.iter_mut().zip(&factors).for_each(|(value, factor)| *value = *value * factor);
        }
        self
    }
}

impl Convolution<f64> {
    /// Factors of the waves along x of a sum over elements at these offsets with these weights.
    #[must_use]
    pub fn factors_along(&self, weights: &[(i32, f64)]) -> Vec<Complex64> {
        let wave = |m: usize| TAU * m as f64 / self.padded_x as f64;
        let factor = |m: usize| -> Complex64 {
            weights
                .iter()
                .map(|(at, weight)| weight * Complex64::cis(f64::from(*at) * wave(m)))
                .sum()
        };
        (0..self.columns()).map(factor).collect()
    }

    /// Returns the transform of a kernel between displaced rows, exact for rows up to `reach`
    /// apart.
    /// `kernel(di, dj)` is the effect over whole elements, `between(x, dj)` over any distance along
    /// x [elements]. Both are even under a reversal of both distances.
    ///
    /// # Panics
    /// Panics if there is not one displacement a row.
    #[must_use]
    pub fn spectrum_of_rows(
        &mut self,
        displacements: &[f64],
        reach: usize,
        kernel: impl Fn(i32, i32) -> f64,
        between: impl Fn(f64, i32) -> f64,
    ) -> EvenSpectrum {
        assert_eq!(displacements.len(), self.ny, "one displacement a row is expected");
        let half = offset(self.padded_x / 2);
        // The middle of the padding is as far away on either side.
        let filled = |di: i32, dj: i32| match di.abs() == half {
            true => 0.5 * (kernel(half, dj) + kernel(-half, dj)),
            false => kernel(di, dj),
        };
        let reach = reach.min(self.ny - 1);
        let mut spectrum = self.transform(half, &filled).even();
        let columns = self.columns();
        let mut near = NearRows::zero(self.ny, reach, columns);
        let mut values = vec![0.0; self.padded_x];
        let mut exact = vec![Complex64::default(); columns];
        for distance in 1..=reach {
            let dj = offset(distance);
            for di in 1 - half..=half {
                values[wrapped(di, self.padded_x)] = filled(di, dj);
            }
            let mut regular = vec![Complex64::default(); columns];
            self.transform_row(&mut values, &mut regular);
            for row in distance..self.ny {
                let source = row - distance;
                let apart = displacements[row] - displacements[source];
                for di in 1 - half..=half {
                    values[wrapped(di, self.padded_x)] = between(f64::from(di) + apart, dj);
                }
                self.transform_row(&mut values, &mut exact);
                for (wave, (exact, regular)) in exact.iter().zip(&regular).enumerate() {
                    let angle = TAU * apart * wave as f64 / self.padded_x as f64;
                    let last = wave + 1 == columns;
                    let phase = if last { Complex64::ONE } else { Complex64::cis(angle) };
                    let value = (exact * phase.conj() - regular) / self.padded_x as f64;
                    near.set(row, distance, wave, value);
                }
            }
        }
        spectrum.near = (reach > 0).then_some(near);
        spectrum
    }

    fn transform_row(&mut self, values: &mut [f64], transformed: &mut [Complex64]) {
        let scratch = &mut self.team.first().scratch;
        self.rows_forward
            .process_with_scratch(values, transformed, scratch)
            .expect("all lengths are the plan's");
    }
}

#[cfg(test)]
mod tests;
