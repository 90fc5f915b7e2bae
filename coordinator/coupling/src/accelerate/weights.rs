//! Weights that make fields of different units and sizes comparable.
//!
//! An inner product over several fields is Σ_f w_f² a_fᵀb_f. With x̃ the returned vector and r the
//! residual of an iteration, the weight w_f of a field is 1/‖x̃_f‖ (`value`), 1/‖r_f‖ (`residual`),
//! or 1 over the sum of its shares ‖r_f‖/‖r‖ in the iterations of the window (`residual-sum`). A
//! field of norm 0, and a single field, have the weight 1. Source: Uekermann, *Partitioned
//! Fluid-Structure Interaction on Massively Parallel Systems* (2016), section 3.2.

use crate::settings::Preconditioner;

/// Weights of the fields, updated in every iteration.
#[derive(Clone, Debug)]
pub(super) struct Weights {
    kind: Preconditioner,
    shares: Vec<f64>,
    squares: Vec<f64>,
}

/// Returns w² of a field with this norm.
fn square(norm: f64) -> f64 {
    let square = (norm * norm).recip();
    if square.is_finite() && square > 0.0 { square } else { 1.0 }
}

impl Weights {
    pub(super) fn new(kind: Preconditioner, fields: usize) -> Self {
        Self { kind, shares: vec![0.0; fields], squares: vec![1.0; fields] }
    }

    pub(super) fn begin_window(&mut self) {
        self.shares.fill(0.0);
    }

    /// Updates the weights from rᵀr and x̃ᵀx̃ of every field in an iteration.
    pub(super) fn update(&mut self, residual: &[f64], returned: &[f64]) {
        if self.squares.len() < 2 {
            return;
        }
        let total: f64 = residual.iter().sum();
        for (share, of) in self.shares.iter_mut().zip(residual) {
            *share += if total > 0.0 { (of / total).sqrt() } else { 0.0 };
        }
        for (index, weight) in self.squares.iter_mut().enumerate() {
            *weight = square(match self.kind {
                Preconditioner::Value => returned[index].sqrt(),
                Preconditioner::Residual => residual[index].sqrt(),
                Preconditioner::ResidualSum => self.shares[index],
            });
        }
    }

    /// Returns w_f² of every field.
    pub(super) fn squares(&self) -> &[f64] {
        &self.squares
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(kind: Preconditioner, iterations: &[([f64; 2], [f64; 2])]) -> Vec<f64> {
        let mut weights = Weights::new(kind, 2);
        weights.begin_window();
        for (residual, returned) in iterations {
            weights.update(residual, returned);
        }
        weights.squares().to_vec()
    }

    #[test]
    fn each_kind_measures_what_it_says() {
        // Squared norms: residuals 9 and 16, then 1 and 0; values 4 and 1e12.
        let iterations = [([9.0, 16.0], [4.0, 1e12]), ([1.0, 0.0], [4.0, 1e12])];
        assert_eq!(after(Preconditioner::Value, &iterations), [0.25, 1e-12]);
        assert_eq!(after(Preconditioner::Residual, &iterations[..1]), [1.0 / 9.0, 1.0 / 16.0]);
        assert_eq!(after(Preconditioner::Residual, &iterations), [1.0, 1.0], "0 has no scale");
        let shares = [0.6_f64 + 1.0, 0.8];
        let expected = shares.map(|share| 1.0 / (share * share));
        assert_eq!(after(Preconditioner::ResidualSum, &iterations), expected);
    }

    #[test]
    fn a_single_field_is_not_weighed() {
        let mut weights = Weights::new(Preconditioner::Value, 1);
        weights.update(&[1e-9], &[1e9]);
        assert_eq!(weights.squares(), [1.0]);
    }
}
