//! Natural modes of conduction along an axis: K φ = μ W φ with the conductance K over the
//! conductivity, the widths W of the nodes, and φᵀ W φ = 1.
//!
//! In these modes the equations of a mesh that is a product of axes decouple (R. E. Lynch, J. R.
//! Rice, D. H. Thomas, Numer. Math. 6 (1964) 185–199).

use super::mesh::Axis;
use faer::{Mat, Side};

/// Modes along an axis.
#[derive(Clone, Debug)]
pub struct Modes {
    /// Rates μ [1/m²], ascending.
    pub rates: Vec<f64>,
    /// φ_m at node k [1/√m], mode after mode.
    pub shapes: Vec<f64>,
    nodes: usize,
}

impl Modes {
    /// Computes all modes of an axis.
    ///
    /// # Panics
    /// Never for the finite, positive lengths of an axis.
    #[must_use]
    pub fn new(axis: &Axis) -> Self {
        let nodes = axis.len();
        let roots: Vec<f64> = axis.widths.iter().map(|width| width.sqrt()).collect();
        let between = axis.conductances();
        let matrix = Mat::from_fn(nodes, nodes, |row, column| match row.abs_diff(column) {
            0 => (between[row] + between[row + 1]) / axis.widths[row],
            1 => -between[row.max(column)] / (roots[row] * roots[column]),
            _ => 0.0,
        });
        let solved = matrix.self_adjoint_eigen(Side::Lower).expect("a finite symmetric matrix");
        let (rates, vectors) = (solved.S().column_vector(), solved.U());
        // A mode of an insulated axis has rate zero; rounding must not make it grow.
        let rates: Vec<f64> = rates.iter().map(|rate| rate.max(0.0)).collect();
        let mut shapes = Vec::with_capacity(nodes * nodes);
        for mode in 0..nodes {
            shapes.extend(roots.iter().enumerate().map(|(k, root)| vectors[(k, mode)] / root));
        }
        Self { rates, shapes, nodes }
    }

    /// Returns the number of nodes, which is also the number of modes.
    #[must_use]
    pub fn len(&self) -> usize {
        self.nodes
    }

    /// Returns whether there are no modes.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.nodes == 0
    }

    /// Returns a mode at the nodes.
    #[must_use]
    pub fn shape(&self, mode: usize) -> &[f64] {
        &self.shapes[mode * self.nodes..(mode + 1) * self.nodes]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The modes are orthogonal and satisfy Kφ = μWφ, on layers from 1 to 70. Tolerance: rounding
    /// of the largest rate.
    #[test]
    fn modes_diagonalise_the_axis() {
        let axis = Axis::graded(1e-6, 1.3, 1e-3).ending([0.0, 100.0]);
        let modes = Modes::new(&axis);
        let n = axis.len();
        let between = axis.conductances();
        for m in 0..n {
            let phi = modes.shape(m);
            for other in 0..n {
                let product: f64 =
                    (0..n).map(|k| axis.widths[k] * phi[k] * modes.shape(other)[k]).sum();
                assert!((product - f64::from(u8::from(m == other))).abs() < 1e-12);
            }
            for k in 0..n {
                let below = if k > 0 { phi[k - 1] } else { 0.0 };
                let above = if k + 1 < n { phi[k + 1] } else { 0.0 };
                let image = between[k] * (phi[k] - below) + between[k + 1] * (phi[k] - above);
                let scale = modes.rates[n - 1] * axis.widths[k] * phi[k].abs().max(1.0);
                let wrong = image - modes.rates[m] * axis.widths[k] * phi[k];
                assert!(wrong.abs() < 1e-10 * scale, "{m} {k} {wrong} {scale}");
            }
        }
    }
}
