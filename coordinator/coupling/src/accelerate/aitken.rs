//! Aitken's dynamic relaxation.
//!
//! x ↦ x + ω_k r_k with ω_k = −ω_{k−1} r_{k−1}ᵀ(r_k − r_{k−1})/‖r_k − r_{k−1}‖². The first ω of the
//! run is `relaxation`. The first ω of a later window keeps the sign of the last one and is no
//! larger than `relaxation`. Several fields enter the inner products with their weights. Source:
//! Küttler & Wall, *Comput. Mech.* 43 (2008), section 3.1.

use super::accelerator::relax;
use super::accelerator::{AccelerationStats, Accelerator};
use super::weights::Weights;
use crate::settings::Implicit;
use crate::vector::{BLOCK, Part, blocks, dot};
use crate::vector::{StateMismatch, StateReader};

/// Relaxation with a factor that is estimated anew in every iteration.
#[derive(Clone, Debug)]
pub struct Aitken {
    parts: Vec<Part>,
    initial: f64,
    relaxation: f64,
    /// ω at the end of the last accepted window.
    accepted: f64,
    residual: Vec<f64>,
    /// Whether `residual` belongs to this window.
    known: bool,
    weights: Weights,
    products: Vec<Products>,
    /// rᵀr of every field.
    residual_squares: Vec<f64>,
    /// x̃ᵀx̃ of every field.
    returned_squares: Vec<f64>,
}

/// Inner products of one field.
#[derive(Clone, Copy, Debug, Default)]
struct Products {
    /// r_{k−1}ᵀ(r_k − r_{k−1}).
    across: f64,
    /// ‖r_k − r_{k−1}‖².
    change: f64,
}

impl Aitken {
    /// Creates an accelerator that begins with the factor `settings.relaxation`.
    #[must_use]
    pub fn new(settings: &Implicit, parts: &[Part]) -> Self {
        let length = parts.last().map_or(0, |part| part.range.end);
        Self {
            parts: parts.to_vec(),
            initial: settings.relaxation,
            relaxation: settings.relaxation,
            accepted: settings.relaxation,
            residual: vec![0.0; length],
            known: false,
            weights: Weights::new(settings.preconditioner, parts.len()),
            products: vec![Products::default(); parts.len()],
            residual_squares: vec![0.0; parts.len()],
            returned_squares: vec![0.0; parts.len()],
        }
    }

    /// Computes the inner products of this residual with the previous one, then replaces the
    /// previous one.
    fn measure(&mut self, sent: &[f64], returned: &[f64]) {
        let (mut now, mut change) = ([0.0; BLOCK], [0.0; BLOCK]);
        for (field, part) in self.parts.iter().enumerate() {
            let (mut products, mut residual, mut value) = (Products::default(), 0.0, 0.0);
            for block in blocks(&part.range, BLOCK) {
                let (now, change) = (&mut now[..block.len()], &mut change[..block.len()]);
                let last = &mut self.residual[block.clone()];
                let values = sent[block.clone()].iter().zip(&returned[block.clone()]);
                for (index, (sent, returned)) in values.enumerate() {
                    now[index] = returned - sent;
                    change[index] = now[index] - last[index];
                }
                products.across += dot(last, change);
                products.change += dot(change, change);
                residual += dot(now, now);
                value += dot(&returned[block.clone()], &returned[block]);
                last.copy_from_slice(now);
            }
            self.products[field] = products;
            (self.residual_squares[field], self.returned_squares[field]) = (residual, value);
        }
    }

    fn estimate(&self) -> f64 {
        let weighed = |of: fn(&Products) -> f64| -> f64 {
            let squares = self.weights.squares().iter();
            self.products.iter().zip(squares).map(|(products, w)| w * of(products)).sum()
        };
        let ratio = weighed(|p| p.across) / weighed(|p| p.change);
        // An unchanged residual gives no information: keep the factor.
        if ratio.is_finite() { -self.relaxation * ratio } else { self.relaxation }
    }
}

impl Accelerator for Aitken {
    fn begin_window(&mut self) {
        self.relaxation = self.accepted.abs().min(self.initial).copysign(self.accepted);
        self.known = false;
        self.weights.begin_window();
    }

    fn next(&mut self, sent: &mut [f64], returned: &[f64]) -> AccelerationStats {
        self.measure(sent, returned);
        self.weights.update(&self.residual_squares, &self.returned_squares);
        if self.known {
            self.relaxation = self.estimate();
        }
        self.known = true;
        relax(self.relaxation, sent, returned);
        AccelerationStats { relaxation: Some(self.relaxation), ..AccelerationStats::default() }
    }

    fn accept_window(&mut self, _sent: &[f64], _returned: &[f64]) {
        self.accepted = self.relaxation;
    }

    fn save(&mut self, into: &mut Vec<u8>) {
        into.extend(self.accepted.to_le_bytes());
    }

    fn restore(&mut self, from: &mut StateReader<'_>) -> Result<(), StateMismatch> {
        self.accepted = from.f64()?;
        Ok(())
    }
}
