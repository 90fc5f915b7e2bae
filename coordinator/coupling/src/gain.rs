//! The gain of the loop: by how much a pass through the participants enlarges a small change of the coupling data.
//!
//! From the differences Δx of what was sent and Δx̃ of what was returned, the newest iterations of a window first, the Jacobian of
//! the pass is known on the space of the Δx: with Δx = QR it is Qᵀ Δx̃ R⁻¹ there. Its eigenvalue with the largest real part is the
//! gain γ. A steady state with γ > 1 does not last: in time every pass leads further away from it. Below 1 it lasts, as far as the
//! delays of the participants are those of diffusion, which only makes real rates of real gains.
//!
//! Changes that are rounding against the data are left out, and those that hold nothing new.

use nalgebra::DMatrix;

/// Changes that are kept.
const MOST: usize = 8;
/// A change below this part of the data is rounding.
const ROUNDING: f64 = 1e-12;
/// A change holds nothing new with less than this part of itself orthogonal to the others.
const NEW: f64 = 1e-3;

/// Learns from the iterations of a window.
#[derive(Clone, Debug, Default)]
pub(crate) struct LoopGain {
    last: Option<[Vec<f64>; 2]>,
    /// Δx and Δx̃, the newest last.
    changes: Vec<[Vec<f64>; 2]>,
}

impl LoopGain {
    /// A window begins.
    pub(crate) fn begin_window(&mut self) {
        self.last = None;
        self.changes.clear();
    }

    /// An iteration has ended.
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

    /// The gain; `None` before two iterations that differ.
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

    /// Of a linear pass the gain is the largest eigenvalue, once its changes span the space.
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
