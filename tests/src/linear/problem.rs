//! Linear problems, generated from a seed.

use super::dense::{Factors, apply, spectral_radius};

/// Names of the problems.
pub const PROBLEMS: &[&str] = &["P1", "P2", "P3", "P4", "P5", "P6", "diagonal"];

/// Maximum number of unknowns of a problem with a dense matrix.
pub const LARGEST_DENSE: usize = 1000;

/// Random numbers in [−1, 1) by splitmix64 (Steele, Lea & Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^= z >> 31;
        2.0 * ((z >> 11) as f64 * 2.0_f64.powi(-53)) - 1.0
    }

    fn vector(&mut self, n: usize) -> Vec<f64> {
        (0..n).map(|_| self.next()).collect()
    }
}

/// Matrix M, in the form used to apply it.
#[derive(Clone, Debug)]
enum Operator {
    /// QΛQᵀ: the eigenvalues, and the vectors v of the reflections that form Q.
    Spectral { eigenvalues: Vec<f64>, reflections: Vec<Vec<f64>> },
    /// Dense matrix by rows, and the factors of I − M.
    Dense { matrix: Vec<f64>, factors: Factors },
}

/// Problem x = Mx + b_w.
#[derive(Clone, Debug)]
pub struct Problem {
    steady: Vec<f64>,
    varying: Vec<f64>,
    operator: Operator,
}

impl Problem {
    /// Creates the problem of a name in [`PROBLEMS`], with `size` unknowns; `None` for any other
    /// name.
    #[must_use]
    pub fn new(name: &str, seed: u64, size: usize) -> Option<Self> {
        let mut random = Random(seed);
        let (steady, varying) = (random.vector(size), random.vector(size));
        let mut reflections: Vec<_> = (0..10).map(|_| random.vector(size)).collect();
        let place = |i: usize| 2.0 * i as f64 / (size - 1) as f64;
        let spectral = |of: &dyn Fn(usize) -> f64, reflections| Operator::Spectral {
            eigenvalues: (0..size).map(of).collect(),
            reflections,
        };
        let operator = match name {
            "P1" => spectral(&|i| 0.95 * (place(i) - 1.0), reflections),
            "P2" => spectral(&|i| place(i) - 1.5, reflections),
            "P3" => spectral(&|i| -1.5 * 0.8_f64.powi(i as i32), reflections),
            "P4" => spectral(&|i| 0.95 * 0.8_f64.powi(i as i32), reflections),
            "P5" | "P6" => {
                let radius = if name == "P5" { 0.95 } else { 1.5 };
                dense(random.vector(size * size), size, radius)
            }
            "diagonal" => {
                reflections.clear();
                spectral(&|i| 0.95 * (place(i) - 1.0), reflections)
            }
            _ => return None,
        };
        Some(Self { steady, varying, operator })
    }

    /// Number of unknowns.
    #[must_use]
    pub fn size(&self) -> usize {
        self.steady.len()
    }

    /// Writes b_w to `b`.
    pub fn right_side(&self, window: u64, b: &mut [f64]) {
        let (steady, varying) = shares(window);
        for (b, (b0, b1)) in b.iter_mut().zip(self.steady.iter().zip(&self.varying)) {
            *b = steady * b0 + varying * b1;
        }
    }

    /// y = Mx + b_w.
    pub fn apply(&self, window: u64, x: &[f64], y: &mut [f64]) {
        match &self.operator {
            Operator::Dense { matrix, .. } => apply(matrix, x, y),
            Operator::Spectral { eigenvalues, reflections } => {
                y.copy_from_slice(x);
                transform(y, reflections, |i| eigenvalues[i]);
            }
        }
        let (steady, varying) = shares(window);
        for (y, (b0, b1)) in y.iter_mut().zip(self.steady.iter().zip(&self.varying)) {
            *y += steady * b0 + varying * b1;
        }
    }

    /// Exact solution of window w.
    #[must_use]
    pub fn solution(&self, window: u64) -> Vec<f64> {
        let mut b = vec![0.0; self.size()];
        self.right_side(window, &mut b);
        match &self.operator {
            Operator::Dense { factors, .. } => factors.solve(&b),
            Operator::Spectral { eigenvalues, reflections } => {
                transform(&mut b, reflections, |i| 1.0 / (1.0 - eigenvalues[i]));
                b
            }
        }
    }

    /// Relative error of x in a window, ‖x − solution‖/‖solution‖.
    #[must_use]
    pub fn true_error(&self, window: u64, x: &[f64]) -> f64 {
        let solution = self.solution(window);
        let error = x.iter().zip(&solution).map(|(x, s)| (x - s).powi(2)).sum::<f64>();
        (error / solution.iter().map(|s| s * s).sum::<f64>()).sqrt()
    }
}

/// Factors of b₀ and b₁ in b_w.
fn shares(window: u64) -> (f64, f64) {
    let (sine, cosine) = (window as f64).sin_cos();
    (1.0 + 0.2 * sine, 0.2 * cosine)
}

fn dense(mut matrix: Vec<f64>, size: usize, radius: f64) -> Operator {
    let scale = radius / spectral_radius(&matrix, size);
    matrix.iter_mut().for_each(|entry| *entry *= scale);
    let factors = Factors::of_identity_minus(&matrix, size);
    Operator::Dense { matrix, factors }
}

/// Replaces x by Q diag(scale) Qᵀ x, with Q = H₁H₂…
fn transform(x: &mut [f64], reflections: &[Vec<f64>], scale: impl Fn(usize) -> f64) {
    reflections.iter().for_each(|v| reflect(x, v));
    x.iter_mut().enumerate().for_each(|(i, x)| *x *= scale(i));
    reflections.iter().rev().for_each(|v| reflect(x, v));
}

/// Replaces x by x − 2v vᵀx/vᵀv.
fn reflect(x: &mut [f64], v: &[f64]) {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let factor = 2.0 * dot(v, x) / dot(v, v);
    x.iter_mut().zip(v).for_each(|(x, v)| *x -= factor * v);
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

    use super::*;

    #[test]
    fn the_numbers_of_seed_42() {
        let problem = Problem::new("P1", 42, 100).unwrap();
        assert_eq!(problem.steady[0], 0.483_129_757_543_646_6);
        let norm = problem.steady.iter().map(|b| b * b).sum::<f64>().sqrt();
        assert!((norm - 5.844_233_177_930_53).abs() < 1e-13, "{norm}: rounding of a hundred terms");
        let mut random = Random(42);
        random.vector(1200);
        let radius = spectral_radius(&random.vector(10_000), 100);
        assert!((radius - 5.879_325_598_123_42).abs() < 1e-12, "{radius}: rounding of a product");
    }

    #[test]
    fn first_entries_of_the_matrices() {
        let entries = [-0.682_354, -1.218_268, -1.122_895, 0.711_167, 0.068_936, 0.108_846];
        for (name, expected) in PROBLEMS.iter().zip(entries) {
            let problem = Problem::new(name, 42, 100).unwrap();
            let (mut unit, mut column, mut zero) = (vec![0.0; 100], vec![0.0; 100], vec![0.0; 100]);
            problem.apply(0, &unit, &mut zero);
            unit[0] = 1.0;
            problem.apply(0, &unit, &mut column);
            let entry = column[0] - zero[0];
            assert!((entry - expected).abs() < 1e-6, "{name}: {entry}, given to six digits");
        }
    }

    #[test]
    fn the_direct_solution_is_the_fixed_point() {
        for name in PROBLEMS {
            let problem = Problem::new(name, 7, 60).unwrap();
            let solution = problem.solution(3);
            let mut image = vec![0.0; 60];
            problem.apply(3, &solution, &mut image);
            let largest = solution.iter().fold(0.0_f64, |m, s| m.max(s.abs()));
            for (image, solution) in image.iter().zip(&solution) {
                // Rounding errors, amplified by the condition number of I − M, at most some
                // hundreds.
                assert!((image - solution).abs() < 1e-12 * largest, "{name}");
            }
        }
    }

    #[test]
    fn spectral_radius_of_known_matrices() {
        let rotation = [0.6, -0.8, 0.8, 0.6].map(|v| 3.0 * v);
        let jordan = [2.0, 1.0, 0.0, 2.0];
        for (matrix, radius) in [(rotation, 3.0), (jordan, 2.0), ([0.0; 4], 0.0)] {
            let found = spectral_radius(&matrix, 2);
            assert!((found - radius).abs() < 1e-11 * radius.max(1e-300), "{found} for {radius}");
        }
    }
}
