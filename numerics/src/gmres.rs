//! Restart-free, right-preconditioned GMRES for a few iterations on a tall vector.
//!
//! Solves A x = b approximately: in the Krylov space of A P, with any approximation P of A⁻¹, finds
//! the x that minimises ‖b − A x‖₂. The preconditioned directions are stored (flexible GMRES), so
//! that P is applied once per iteration. Orthogonalisation is by modified Gram–Schmidt (Arnoldi),
//! the least-squares solution by Givens rotations. Working memory is reused between solves.
//!
//! Source: Saad, *Iterative Methods for Sparse Linear Systems* (2003), algorithms 6.9 and 9.6.

use crate::vector::{add_scaled, dot, norm};

/// Maximum dimension of the Krylov space.
const MOST_STEPS: usize = 40;

/// Working memory of the solver.
#[derive(Debug, Default)]
pub struct Gmres {
    /// Orthonormal basis.
    basis: Vec<Vec<f64>>,
    /// Preconditioned basis.
    directions: Vec<Vec<f64>>,
    /// Columns of the triangular factor.
    factor: Vec<Vec<f64>>,
    rotations: Vec<(f64, f64)>,
    target: Vec<f64>,
}

/// Result of a solve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Achieved {
    /// Number of iterations, that is, of products with the operator.
    pub steps: usize,
    /// Relative residual ‖b − A x‖/‖b‖.
    pub reduction: f64,
}

/// An operator and its preconditioner. The operator may have more unknowns than equations, if every
/// result of the preconditioner satisfies the remaining equations (constraint preconditioner).
pub trait Preconditioned {
    /// Computes out = A x.
    fn operate(&mut self, x: &[f64], out: &mut [f64]);
    /// Computes out ≈ A⁻¹ x.
    fn precondition(&mut self, x: &[f64], out: &mut [f64]);
}

impl Gmres {
    /// Solves A x = b to ‖b − A x‖ ≤ `reduction` ‖b‖, or until the Krylov space is full; x starts
    /// from zero.
    pub fn solve(
        &mut self,
        system: &mut dyn Preconditioned,
        right: &[f64],
        reduction: f64,
        x: &mut [f64],
    ) -> Achieved {
        x.fill(0.0);
        self.rotations.clear();
        self.target.clear();
        let scale = norm(right);
        if scale == 0.0 {
            return Achieved { steps: 0, reduction: 0.0 };
        }
        self.target.push(scale);
        copy_scaled(slot(&mut self.basis, 0), right, 1.0 / scale);
        let mut steps = 0;
        while steps < MOST_STEPS && self.target[steps].abs() > reduction * scale {
            let next = self.expand(system, steps, [right.len(), x.len()]);
            steps += 1;
            if next == 0.0 {
                break;
            }
        }
        self.combine(steps, x);
        Achieved { steps, reduction: self.target[steps].abs() / scale }
    }

    /// Performs one Arnoldi step; returns the norm of the new direction.
    fn expand(
        &mut self,
        system: &mut dyn Preconditioned,
        step: usize,
        [equations, unknowns]: [usize; 2],
    ) -> f64 {
        let direction = slot(&mut self.directions, step);
        direction.resize(unknowns, 0.0);
        system.precondition(&self.basis[step], direction);
        let mut vector = std::mem::take(slot(&mut self.basis, step + 1));
        vector.resize(equations, 0.0);
        system.operate(&self.directions[step], &mut vector);
        let column = slot(&mut self.factor, step);
        column.clear();
        for earlier in &self.basis[..=step] {
            let overlap = dot(earlier, &vector);
            add_scaled(&mut vector, earlier, -overlap);
            column.push(overlap);
        }
        let length = norm(&vector);
        if length > 0.0 {
            vector.iter_mut().for_each(|value| *value /= length);
        }
        self.basis[step + 1] = vector;
        self.rotate(step, length);
        length
    }

    /// Reduces the new column of the Hessenberg matrix to upper triangular form.
    fn rotate(&mut self, step: usize, below: f64) {
        let column = &mut self.factor[step];
        for (row, (cos, sin)) in self.rotations.iter().enumerate() {
            let (upper, lower) = (column[row], column[row + 1]);
            column[row] = cos * upper + sin * lower;
            column[row + 1] = cos * lower - sin * upper;
        }
        let diagonal = column[step];
        let radius = diagonal.hypot(below);
        let (cos, sin) =
            if radius > 0.0 { (diagonal / radius, below / radius) } else { (1.0, 0.0) };
        column[step] = radius;
        self.rotations.push((cos, sin));
        let last = self.target[step];
        self.target[step] = cos * last;
        self.target.push(-sin * last);
    }

    /// Computes x = Σ y_i z_i with the solution y of the triangular system.
    fn combine(&mut self, steps: usize, x: &mut [f64]) {
        for row in (0..steps).rev() {
            let mut value = self.target[row];
            for (column, weight) in self.factor[row + 1..steps].iter().zip(&self.target[row + 1..])
            {
                value -= column[row] * weight;
            }
            let diagonal = self.factor[row][row];
            self.target[row] = if diagonal == 0.0 { 0.0 } else { value / diagonal };
        }
        for (direction, weight) in self.directions[..steps].iter().zip(&self.target) {
            add_scaled(x, direction, *weight);
        }
    }
}

/// Returns the vector with this index, created on first use.
fn slot(vectors: &mut Vec<Vec<f64>>, index: usize) -> &mut Vec<f64> {
    while vectors.len() <= index {
        vectors.push(Vec::new());
    }
    &mut vectors[index]
}

fn copy_scaled(into: &mut Vec<f64>, from: &[f64], factor: f64) {
    into.clear();
    into.extend(from.iter().map(|value| value * factor));
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bidiagonal matrix, not symmetric, with an approximate inverse.
    struct Bidiagonal;

    impl Preconditioned for Bidiagonal {
        fn operate(&mut self, x: &[f64], out: &mut [f64]) {
            for i in 0..x.len() {
                let next = x.get(i + 1).copied().unwrap_or(0.0);
                out[i] = (2.0 + i as f64) * x[i] - 1.5 * next;
            }
        }

        fn precondition(&mut self, x: &[f64], out: &mut [f64]) {
            for i in 0..x.len() {
                out[i] = x[i] / (2.0 + i as f64);
            }
        }
    }

    #[test]
    fn residual_is_as_small_as_it_says() {
        let right: Vec<f64> = (0..50).map(|i| (0.3 * f64::from(i)).sin()).collect();
        let mut x = vec![0.0; 50];
        for reduction in [0.1, 1e-6, 1e-12] {
            let achieved = Gmres::default().solve(&mut Bidiagonal, &right, reduction, &mut x);
            let mut product = vec![0.0; 50];
            Bidiagonal.operate(&x, &mut product);
            let rest: Vec<f64> = product.iter().zip(&right).map(|(a, b)| b - a).collect();
            let found = norm(&rest) / norm(&right);
            assert!(found <= reduction * (1.0 + 1e-3), "{found} > {reduction}");
            // Rounding of the recurrence compared with the true residual.
            assert!((found - achieved.reduction).abs() < 1e-13);
        }
    }

    #[test]
    fn nothing_to_do_for_a_right_side_of_zero() {
        let mut x = vec![1.0; 3];
        let achieved = Gmres::default().solve(&mut Bidiagonal, &[0.0; 3], 1e-3, &mut x);
        assert_eq!((achieved.steps, x), (0, vec![0.0; 3]));
    }
}
