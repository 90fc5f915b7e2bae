//! Small dense matrices, by rows: products, spectral radius, direct solve.

/// y = Ax.
pub(super) fn apply(a: &[f64], x: &[f64], y: &mut [f64]) {
    for (y, row) in y.iter_mut().zip(a.chunks_exact(x.len())) {
        *y = row.iter().zip(x).map(|(a, x)| a * x).sum();
    }
}

/// Spectral radius, by Gelfand's formula ρ = lim ‖A^m‖^(1/m) over m = 2, 4, 8, ...; fifty squarings
/// leave an error of 2⁻⁵⁰ ln(constant).
pub(super) fn spectral_radius(a: &[f64], n: usize) -> f64 {
    let mut power = a.to_vec();
    let (mut logarithm, mut share) = (0.0, 1.0);
    for _ in 0..50 {
        let norm = power.iter().map(|v| v * v).sum::<f64>().sqrt();
        if norm == 0.0 {
            return 0.0;
        }
        logarithm += share * norm.ln();
        share /= 2.0;
        power.iter_mut().for_each(|v| *v /= norm);
        power = square(&power, n);
    }
    logarithm.exp()
}

fn square(a: &[f64], n: usize) -> Vec<f64> {
    let mut product = vec![0.0; n * n];
    for (row, left) in product.chunks_exact_mut(n).zip(a.chunks_exact(n)) {
        for (factor, right) in left.iter().zip(a.chunks_exact(n)) {
            for (entry, value) in row.iter_mut().zip(right) {
                *entry += factor * value;
            }
        }
    }
    product
}

/// LU factorisation with row pivoting.
#[derive(Clone, Debug)]
pub(super) struct Factors {
    lu: Vec<f64>,
    rows: Vec<usize>,
}

impl Factors {
    /// Factorises I − A.
    pub(super) fn of_identity_minus(a: &[f64], n: usize) -> Self {
        let entry = |(at, value): (usize, &f64)| f64::from(at / n == at % n) - value;
        let mut lu: Vec<f64> = a.iter().enumerate().map(entry).collect();
        let mut rows: Vec<usize> = (0..n).collect();
        for column in 0..n {
            let size = |row: &usize| lu[row * n + column].abs();
            let pivot = (column..n).max_by(|a, b| size(a).total_cmp(&size(b)));
            let pivot = pivot.expect("there are rows left");
            rows.swap(column, pivot);
            for k in 0..n {
                lu.swap(column * n + k, pivot * n + k);
            }
            let (above, below) = lu.split_at_mut((column + 1) * n);
            let above = &above[column * n..];
            for row in below.chunks_exact_mut(n) {
                let factor = row[column] / above[column];
                row[column] = factor;
                for (entry, above) in row[column + 1..].iter_mut().zip(&above[column + 1..]) {
                    *entry -= factor * above;
                }
            }
        }
        Self { lu, rows }
    }

    /// Solves for a right side.
    pub(super) fn solve(&self, right: &[f64]) -> Vec<f64> {
        let n = right.len();
        let row = |row: usize| &self.lu[row * n..][..n];
        let mut x: Vec<f64> = self.rows.iter().map(|&row| right[row]).collect();
        for i in 0..n {
            x[i] -= row(i)[..i].iter().zip(&x[..i]).map(|(a, x)| a * x).sum::<f64>();
        }
        for i in (0..n).rev() {
            let rest = row(i)[i + 1..].iter().zip(&x[i + 1..]).map(|(a, x)| a * x);
            x[i] = (x[i] - rest.sum::<f64>()) / row(i)[i];
        }
        x
    }
}
