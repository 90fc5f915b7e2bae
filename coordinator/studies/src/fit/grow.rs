//! A sum of products of Chebyshev polynomials, grown term by term to fit values at points.
//!
//! The terms are a lower set: a product is there only with all products of lower degrees. From those that may
//! come next the one is taken that reduces the residual most (orthogonal least squares: Chen, Billings and Luo,
//! Int. J. Control 50 (1989) 1873; lower sets: Chkifa, Cohen, Schwab, J. Math. Pures Appl. 103 (2015) 400), so that
//! degrees go where the figure needs them: one in a variable of a power law, ten towards a singularity. After
//! each term the error is that at points held out ([`super::held`]); the growth ends when it falls no more, and
//! as many terms are kept as the least error needs.

use super::held::{Checks, HeldOut, axpy, dot};

/// Most terms.
const MOST: usize = 160;
/// Points for each term, at least.
const POINTS_A_TERM: usize = 2;
/// Terms that are tried after the best so far, and as many again as a part of its number.
const PATIENCE: (usize, usize) = (8, 2);
/// Fewer terms are kept if their error is at most so many times the least.
const AS_GOOD: f64 = 1.02;
/// Of a column less than this is left by the others: it is made of them.
const DEPENDENT: f64 = 1e-7;

/// The polynomials of one coordinate at all points, from degree 0 on, in one scale.
pub(super) type Axis = Vec<Vec<f64>>;

/// What is fitted.
pub(super) struct Task<'a> {
    /// One for each coordinate, up to the largest degree it may have.
    pub axes: &'a [&'a Axis],
    /// The values at the points.
    pub values: &'a [f64],
    /// Which points are held out together.
    pub held: &'a HeldOut,
    /// The error of the figure at a held-out point, from its number and the error `value - fit` there.
    pub judge: &'a dyn Fn(usize, f64) -> f64,
}

/// A sum.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sum {
    /// The degrees of each term.
    pub degrees: Vec<Vec<u8>>,
    /// The factor of each term.
    pub coefficients: Vec<f64>,
    /// The largest error at held-out points.
    pub largest: f64,
    /// The root of their mean square.
    pub rms: f64,
}

/// Grows the sum; `None` where not even a constant is determined.
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

/// A column that may come next.
struct Candidate {
    degrees: Vec<u8>,
    /// What the basis leaves of it.
    column: Vec<f64>,
    /// Its products with the basis.
    upper: Vec<f64>,
    /// Its length at first.
    length: f64,
}

struct Growth<'a> {
    task: &'a Task<'a>,
    terms: Vec<Vec<u8>>,
    /// The orthonormal basis.
    basis: Vec<Vec<f64>>,
    /// Columns of the triangle by which the basis makes the terms.
    upper: Vec<Vec<f64>>,
    /// Products of the values with the basis.
    along: Vec<f64>,
    residuals: Vec<f64>,
    candidates: Vec<Candidate>,
    checks: Checks<'a>,
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
            checks: Checks::new(task.held),
            held: Vec::new(),
        };
        growth.offer(vec![0; task.axes.len()]);
        growth
    }

    /// Adds the best term; false if there is none.
    fn step(&mut self) -> bool {
        while let Some(Candidate { degrees, column, mut upper, length }) = self.take_best() {
            // Once more, for what rounding has left.
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

    /// All products of one degree less are there.
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

    /// The largest error at held-out points, and the root of their mean square.
    fn judge(&mut self) -> [f64; 2] {
        self.checks.errors(&self.residuals, &mut self.held);
        let points = self.task.held.points();
        let errors = points.zip(&self.held).map(|(n, error)| (self.task.judge)(n, *error).abs());
        let sum = |[largest, sum]: [f64; 2], error: f64| [largest.max(error), sum + error * error];
        let [largest, sum] = errors.fold([0.0; 2], sum);
        let rms = (sum / self.held.len().max(1) as f64).sqrt();
        if rms.is_finite() { [largest, rms] } else { [f64::INFINITY; 2] }
    }

    /// The factors of the first terms alone: the triangle solved from its end.
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
