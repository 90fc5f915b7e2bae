//! Fields of the iteration over the set C of elements in contact ([`super`]).

use numerics::vector::dot;

/// Fields of the iteration, zero outside C unless stated otherwise.
#[derive(Debug)]
pub(super) struct Workspace {
    pub(super) in_contact: Vec<bool>,
    /// u = A p, everywhere [m].
    pub(super) displacement: Vec<f64>,
    /// Residual r, and the one of the previous step [m].
    pub(super) residual: Vec<f64>,
    pub(super) last_residual: Vec<f64>,
    /// z = M r [Pa].
    pub(super) step: Vec<f64>,
    /// w = M 1 [Pa/m].
    pub(super) punch: Vec<f64>,
    /// d [Pa].
    pub(super) direction: Vec<f64>,
    /// Result of a convolution, everywhere.
    pub(super) image: Vec<f64>,
}

impl Workspace {
    /// Creates the fields of a grid of `len` elements.
    pub(super) fn new(len: usize) -> Self {
        let zeros = || vec![0.0; len];
        Self {
            in_contact: vec![false; len],
            displacement: zeros(),
            residual: zeros(),
            last_residual: zeros(),
            step: zeros(),
            punch: zeros(),
            direction: zeros(),
            image: zeros(),
        }
    }

    /// Sets a field to zero outside C.
    pub(super) fn cut(&mut self, field: impl Fn(&mut Self) -> &mut Vec<f64>) {
        let mut values = std::mem::take(field(self));
        for (value, flag) in values.iter_mut().zip(&self.in_contact) {
            if !*flag {
                *value = 0.0;
            }
        }
        *field(self) = values;
    }

    /// Chooses the change of δ so that Σ z = 0 and adds its part to r and z; returns it.
    pub(super) fn balance(&mut self) -> f64 {
        let approach = -self.step.iter().sum::<f64>() / self.punch.iter().sum::<f64>();
        for (at, flag) in self.in_contact.iter().enumerate() {
            if *flag {
                self.residual[at] += approach;
                self.step[at] += approach * self.punch[at];
            }
        }
        approach
    }

    pub(super) fn root_mean_square(&self, count: usize) -> f64 {
        (dot(&self.residual, &self.residual) / count.max(1) as f64).sqrt()
    }
}
