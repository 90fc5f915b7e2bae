//! Sums of products of Chebyshev polynomials, grown term by term to fit values at scattered points.
//!
//! The terms form a lower set: a product is included only if all products of lower degrees are.
//! Among the admissible next terms, the one that reduces the residual most is added (orthogonal
//! least squares: Chen, Billings and Luo, Int. J. Control 50 (1989) 1873; lower sets: Chkifa,
//! Cohen, Schwab, J. Math. Pures Appl. 103 (2015) 400). High degrees thus appear only where the
//! figure needs them: degree one in a variable of a power law, ten towards a singularity. After
//! each term, the error at held-out points is computed ([`super::held`]). Growth ends when the
//! error no longer falls, and only the terms needed for the least error are kept.

use super::held::{HeldOut, HeldOutErrors, axpy, dot};

/// Maximum number of terms.
const MOST: usize = 160;
/// Minimum number of points per term.
const POINTS_A_TERM: usize = 2;
/// Number of terms tried beyond the best so far: a constant, plus the number of the best term
/// divided by the second value.
const PATIENCE: (usize, usize) = (8, 2);
/// The shortest sum is kept whose error is at most this factor times the least error.
const AS_GOOD: f64 = 1.02;
/// A column counts as linearly dependent if orthogonalisation leaves less than this share of its
/// length.
const DEPENDENT: f64 = 1e-7;

/// Polynomials of one coordinate at all points in one scale, from degree 0 upwards.
pub(super) type Axis = Vec<Vec<f64>>;

/// Data of a fit.
pub(super) struct Task<'a> {
    /// One entry for each coordinate, up to the largest permitted degree.
    pub axes: &'a [&'a Axis],
    /// Values at the points.
    pub values: &'a [f64],
    /// Sets of points that are held out together.
    pub held: &'a HeldOut,
    /// Error of the figure at a held-out point, as a function of the point's number and of the
    /// error `value - fit`.
    pub judge: &'a dyn Fn(usize, f64) -> f64,
}

/// A fitted sum.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sum {
    /// Degrees of each term.
    pub degrees: Vec<Vec<u8>>,
    /// Coefficient of each term.
    pub coefficients: Vec<f64>,
    /// Largest error at the held-out points.
    pub largest: f64,
    /// Root mean square of the errors at the held-out points.
    pub rms: f64,
}

/// Grows the sum; `None` if the points cannot determine even a constant.
#[must_use]
pub(super) fn grow(task: &Task<'_>) -> Option<Sum> {
    let mut growth = Growth::new(task);
    let mut errors: Vec<[f64; 2]> = Vec::new();
    let most = MOST.min(task.values.len() / POINTS_A_TERM).max(1);
    let mut best = 0;
    while errors.len() < most && growth.step() {
        errors.push(growth.judge());
        let n = errors.len() - 1;
        if errors[n][1] < errors[best][1] {
            best = n;
        }
        if n > best + PATIENCE.0 + best / PATIENCE.1 || errors[best][1] == 0.0 {
            break;
        }
    }
    let least = errors.get(best)?[1];
    let kept = errors.iter().position(|error| error[1] <= AS_GOOD * least)?;
    let [largest, rms] = errors[kept];
    let coefficients = growth.coefficients(kept + 1);
    growth.terms.truncate(kept + 1);
    Some(Sum { degrees: growth.terms, coefficients, largest, rms })
}

/// A term that may be added next.
struct Candidate {
    degrees: Vec<u8>,
    /// Component of the column orthogonal to the basis.
    column: Vec<f64>,
    /// Products of the column with the basis vectors.
    upper: Vec<f64>,
    /// Length before orthogonalisation.
    length: f64,
}

struct Growth<'a> {
    task: &'a Task<'a>,
    terms: Vec<Vec<u8>>,
    /// Orthonormal basis of the columns.
    basis: Vec<Vec<f64>>,
    /// Columns of the upper triangle R in A = Q R, where the columns of A are the terms.
    upper: Vec<Vec<f64>>,
    /// Products of the values with the basis vectors.
    along: Vec<f64>,
    residuals: Vec<f64>,
    candidates: Vec<Candidate>,
    checks: HeldOutErrors<'a>,
    held: Vec<f64>,
}

impl<'a> Growth<'a> {
    fn new(task: &'a Task<'a>) -> Self {
        let mut growth = Self {
            task,
            terms: Vec::new(),
            basis: Vec::new(),
            upper: Vec::new(),
            along: Vec::new(),
            residuals: task.values.to_vec(),
            candidates: Vec::new(),
            checks: HeldOutErrors::new(task.held),
            held: Vec::new(),
        };
        growth.offer(vec![0; task.axes.len()]);
        growth
    }

    /// Adds the best term; returns false if no admissible term is left.
    fn step(&mut self) -> bool {
        while let Some(Candidate { degrees, column, mut upper, length }) = self.take_best() {
            // Orthogonalise a second time, to remove rounding errors.
            let mut column = column;
            for (n, other) in self.basis.iter().enumerate() {
                let more = dot(other, &column);
                axpy(-more, other, &mut column);
                upper[n] += more;
            }
            let left = dot(&column, &column).sqrt();
            if left <= DEPENDENT * length {
                continue;
            }
            column.iter_mut().for_each(|value| *value /= left);
            if !self.checks.add(&column) {
                continue;
            }
            upper.push(left);
            self.accept(degrees, column, upper);
            return true;
        }
        false
    }

    fn take_best(&mut self) -> Option<Candidate> {
        let gain = |one: &Candidate| {
            let square = dot(&one.column, &one.column);
            let along = dot(&one.column, &self.residuals);
            if square > 0.0 { along * along / square } else { 0.0 }
        };
        let gains = self.candidates.iter().map(gain).enumerate();
        let (best, _) = gains.max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(self.candidates.swap_remove(best))
    }

    fn accept(&mut self, degrees: Vec<u8>, column: Vec<f64>, upper: Vec<f64>) {
        let along = dot(&column, &self.residuals);
        axpy(-along, &column, &mut self.residuals);
        for one in &mut self.candidates {
            let product = dot(&column, &one.column);
            axpy(-product, &column, &mut one.column);
            one.upper.push(product);
        }
        self.along.push(along);
        self.basis.push(column);
        self.upper.push(upper);
        self.terms.push(degrees.clone());
        for n in 0..degrees.len() {
            let mut next = degrees.clone();
            next[n] += 1;
            if usize::from(next[n]) < self.task.axes[n].len() && self.is_supported(&next) {
                self.offer(next);
            }
        }
    }

    /// Returns whether all products with one degree less are included.
    fn is_supported(&self, degrees: &[u8]) -> bool {
        (0..degrees.len()).filter(|n| degrees[*n] > 0).all(|n| {
            let mut lower = degrees.to_vec();
            lower[n] -= 1;
            self.terms.contains(&lower)
        })
    }

    fn offer(&mut self, degrees: Vec<u8>) {
        let mut column = vec![1.0; self.task.values.len()];
        for (axis, degree) in self.task.axes.iter().zip(&degrees) {
            if *degree > 0 {
                let factors = &axis[usize::from(*degree)];
                column.iter_mut().zip(factors).for_each(|(value, factor)| *value *= factor);
            }
        }
        let length = dot(&column, &column).sqrt();
        let mut upper = Vec::with_capacity(self.basis.len());
        for other in &self.basis {
            let product = dot(other, &column);
            axpy(-product, other, &mut column);
            upper.push(product);
        }
        self.candidates.push(Candidate { degrees, column, upper, length });
    }

    /// Largest error at the held-out points, and root mean square of the errors.
    fn judge(&mut self) -> [f64; 2] {
        self.checks.errors(&self.residuals, &mut self.held);
        let points = self.task.held.points();
        let errors = points.zip(&self.held).map(|(n, error)| (self.task.judge)(n, *error).abs());
        let sum = |[largest, sum]: [f64; 2], error: f64| [largest.max(error), sum + error * error];
        let [largest, sum] = errors.fold([0.0; 2], sum);
        let rms = (sum / self.held.len().max(1) as f64).sqrt();
        if rms.is_finite() { [largest, rms] } else { [f64::INFINITY; 2] }
    }

    /// Coefficients of the first `count` terms, by back substitution.
    fn coefficients(&self, count: usize) -> Vec<f64> {
        let mut factors = self.along[..count].to_vec();
        for n in (0..count).rev() {
            factors[n] /= self.upper[n][n];
            let factor = factors[n];
            axpy(-factor, &self.upper[n][..n], &mut factors[..n]);
        }
        factors
    }
}
