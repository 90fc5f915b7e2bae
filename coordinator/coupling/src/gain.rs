//! Loop gain: the factor by which a pass through the participants amplifies a small change of the
//! coupling data.
//!
//! The differences Δx of the sent and Δx̃ of the returned vectors, the newest iterations of a
//! window first, give the Jacobian of the pass on the space of the Δx: with Δx = QR it is Qᵀ Δx̃
//! R⁻¹ there. The gain γ is its eigenvalue with the largest real part. A steady state with γ > 1 is
//! unstable: every pass leads further away from it. A steady state with γ < 1 is stable if the
//! delays of the participants are diffusive, because diffusion turns real gains into real growth
//! rates.
//!
//! Changes that are mere rounding, or linearly dependent on newer ones, are left out.

use nalgebra::DMatrix;

/// Largest number of changes that are kept.
const MOST: usize = 8;
/// Fraction of the data below which a change is rounding.
const ROUNDING: f64 = 1e-12;
/// Fraction of a change that must be orthogonal to the others; with less the change is left out.
const NEW: f64 = 1e-3;

/// Estimates the loop gain from the iterations of a window.
#[derive(Clone, Debug, Default)]
pub(crate) struct LoopGain {
    last: Option<[Vec<f64>; 2]>,
    /// Δx and Δx̃, the newest last.
    changes: Vec<[Vec<f64>; 2]>,
}

impl LoopGain {
    /// Begins a window.
    pub(crate) fn begin_window(&mut self) {
        self.last = None;
        self.changes.clear();
    }

    /// Takes in an iteration.
    pub(crate) fn learn(&mut self, sent: &[f64], returned: &[f64]) {
        let now = [sent.to_vec(), returned.to_vec()];
        if let Some(last) = self.last.replace(now) {
            let change = |now: &[f64], last: &[f64]| -> Vec<f64> {
                now.iter().zip(last).map(|(a, b)| a - b).collect()
            };
            let changes = [change(sent, &last[0]), change(returned, &last[1])];
            if norm(&changes[0]) > ROUNDING * norm(sent) {
                if self.changes.len() == MOST {
                    self.changes.remove(0);
                }
                self.changes.push(changes);
            }
        }
    }

    /// Returns the gain; `None` before two iterations that differ.
    pub(crate) fn value(&self) -> Option<f64> {
        let mut basis: Vec<Vec<f64>> = Vec::new();
        let mut columns: Vec<(Vec<f64>, &[f64])> = Vec::new();
        for [sent, returned] in self.changes.iter().rev() {
            let mut rest = sent.clone();
            let mut parts: Vec<f64> = basis
                .iter()
                .map(|direction| {
                    let part = dot(direction, &rest);
                    rest.iter_mut().zip(direction).for_each(|(r, d)| *r -= part * d);
                    part
                })
                .collect();
            let size = norm(&rest);
            if size > NEW * norm(sent) {
                rest.iter_mut().for_each(|value| *value /= size);
                parts.push(size);
                basis.push(rest);
                columns.push((parts, returned));
            }
        }
        if basis.is_empty() {
            return None;
        }
        let count = basis.len();
        let triangle =
            DMatrix::from_fn(count, count, |i, j| columns[j].0.get(i).copied().unwrap_or(0.0));
        let image = DMatrix::from_fn(count, count, |i, j| dot(&basis[i], columns[j].1));
        let jacobian = image * triangle.try_inverse()?;
        let values = jacobian.complex_eigenvalues();
        values.iter().map(|value| value.re).reduce(f64::max).filter(|gain| gain.is_finite())
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The gain of a linear pass is the largest eigenvalue once the changes span the space.
    #[test]
    fn of_a_linear_pass() {
        let pass = |x: &[f64]| vec![0.5 * x[0] + 0.7 * x[1] + 1.0, 1.2 * x[1] - 3.0];
        let mut gain = LoopGain::default();
        assert_eq!(gain.value(), None);
        for sent in [[1.0, 2.0], [1.1, 2.0], [1.3, 2.5]] {
            gain.learn(&sent, &pass(&sent));
        }
        assert!((gain.value().unwrap() - 1.2).abs() < 1e-12);
        gain.begin_window();
        gain.learn(&[1.0, 2.0], &pass(&[1.0, 2.0]));
        gain.learn(&[1.0, 2.0], &pass(&[1.0, 2.0]));
        assert_eq!(gain.value(), None);
    }
}
