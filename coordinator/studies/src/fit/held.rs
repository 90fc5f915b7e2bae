//! Sets of points held out of a fit, and the error of a least-squares fit without each set.
//!
//! If all neighbours of a point in one direction remain in the fit, holding out the point says
//! little about the error between the values in that direction. Hence a set holds all points with
//! one value of one key, except the outermost values, which would leave the rest to extrapolate. In
//! a grid such a set is a whole plane. Where every point has its own values, a set is a single
//! point.
//!
//! If no point lies in a corner of the box, the points nearest to that corner are held out together
//! as well. The fit then extrapolates to these points about as far as it extrapolates from them to
//! the corner.
//!
//! With an orthonormal basis `Q` of the columns, residuals `r`, and the rows `Q_S` of the set, the
//! fit without the set has the following error at the set:
//!
//! ```text
//! e_S = (I - Q_S Q_Sᵀ)⁻¹ r_S = r_S + Q_S (I - Q_Sᵀ Q_S)⁻¹ Q_Sᵀ r_S ,
//! ```
//!
//! The fit need not be repeated (Woodbury; for one point `e = r / (1 - h)`, PRESS: Allen,
//! Technometrics 16 (1974) 125). The Cholesky factor of the inner matrix gains one row with each
//! column (bordering).

use std::collections::BTreeMap;

/// A set or point is undetermined if less than this share of a column remains without it.
const LEAST: f64 = 1e-8;

/// Held-out sets, as point numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct HeldOut {
    /// Sets of a single point.
    single: Vec<u32>,
    /// Sets of several points.
    sets: Vec<Vec<u32>>,
}

impl HeldOut {
    /// Builds the sets for points with these key values.
    #[must_use]
    pub(super) fn of(keys: &[Vec<f64>]) -> Self {
        let inner = keys.iter().flat_map(|values| inner_sets(values));
        let mut sets: Vec<Vec<u32>> = inner.chain(corner_sets(keys)).collect();
        sets.sort();
        sets.dedup();
        let (single, sets) = sets.into_iter().partition::<Vec<_>, _>(|set| set.len() == 1);
        Self { single: single.concat(), sets }
    }

    /// Points of all sets, one set after the other.
    pub(super) fn points(&self) -> impl Iterator<Item = usize> {
        self.single.iter().chain(self.sets.iter().flatten()).map(|n| *n as usize)
    }
}

/// Groups points by value, without the smallest and the largest value.
fn inner_sets(values: &[f64]) -> Vec<Vec<u32>> {
    let mut by_value: BTreeMap<u64, Vec<u32>> = BTreeMap::new();
    for (n, value) in (0..).zip(values) {
        by_value.entry(ordered(*value)).or_default().push(n);
    }
    by_value.pop_first();
    by_value.pop_last();
    by_value.into_values().collect()
}

/// Maximum number of keys for which corners are considered, because the number of corners doubles
/// with each key.
const MOST_CORNERED: usize = 8;
/// At most one of this many points is held out for a corner.
const ONE_OF: usize = 12;

/// Finds the points nearest to each empty corner. Twice as far from a corner lie about `2^keys`
/// times as many points, so at most that many are taken.
fn corner_sets(keys: &[Vec<f64>]) -> Vec<Vec<u32>> {
    if keys.len() > MOST_CORNERED {
        return Vec::new();
    }
    let scaled: Vec<Vec<f64>> = keys.iter().map(|values| scaled(values)).collect();
    let points = keys.first().map_or(0, Vec::len);
    let count = (points / ONE_OF).clamp(1, 1 << keys.len());
    let set = |corner: usize| {
        let distance = |n: u32| {
            let apart = |(i, values): (usize, &Vec<f64>)| {
                (values[n as usize] - f64::from(u8::from(corner >> i & 1 == 1))).abs()
            };
            scaled.iter().enumerate().map(apart).fold(0.0, f64::max)
        };
        let mut nearest: Vec<(f64, u32)> = (0..).take(points).map(|n| (distance(n), n)).collect();
        nearest.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut set: Vec<u32> = nearest.iter().take(count).map(|(_, n)| *n).collect();
        set.sort_unstable();
        nearest.first().is_some_and(|(distance, _)| *distance > 0.0).then_some(set)
    };
    (0..1 << keys.len()).filter_map(set).collect()
}

/// Scales the values to the range from 0 to 1.
fn scaled(values: &[f64]) -> Vec<f64> {
    let ends = |[from, to]: [f64; 2], value: &f64| [from.min(*value), to.max(*value)];
    let [from, to] = values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], ends);
    values.iter().map(|value| (value - from) / (to - from)).collect()
}

/// Maps a number to bits that sort in numeric order.
fn ordered(value: f64) -> u64 {
    let bits = (value + 0.0).to_bits();
    if bits >> 63 == 0 { bits | 1 << 63 } else { !bits }
}

/// State of the held-out errors while columns are added.
pub(super) struct HeldOutErrors<'a> {
    of: &'a HeldOut,
    /// `1 - h` for each set of a single point.
    left: Vec<f64>,
    sets: Vec<HeldOutSet>,
}

/// One set: its rows of the columns, stored by column, and the Cholesky factor of `I - Q_Sᵀ Q_S`,
/// stored by row.
#[derive(Default)]
struct HeldOutSet {
    columns: Vec<Vec<f64>>,
    factor: Vec<Vec<f64>>,
}

impl<'a> HeldOutErrors<'a> {
    /// Starts with a fit without columns.
    #[must_use]
    pub(super) fn new(of: &'a HeldOut) -> Self {
        Self {
            of,
            left: vec![1.0; of.single.len()],
            sets: of.sets.iter().map(|_| HeldOutSet::default()).collect(),
        }
    }

    /// Adds a column of the orthonormal basis. Returns false and leaves the state unchanged if the
    /// column is undetermined without one of the sets.
    #[must_use]
    pub(super) fn add(&mut self, column: &[f64]) -> bool {
        let single = || self.of.single.iter().map(|n| column[*n as usize]);
        let left: Vec<f64> = self.left.iter().zip(single()).map(|(left, q)| left - q * q).collect();
        if left.iter().any(|left| *left <= LEAST) {
            return false;
        }
        let mut rows = Vec::with_capacity(self.sets.len());
        for (check, points) in self.sets.iter().zip(&self.of.sets) {
            let own: Vec<f64> = points.iter().map(|n| column[*n as usize]).collect();
            match check.border(&own) {
                Some(row) => rows.push((own, row)),
                None => return false,
            }
        }
        self.left = left;
        for (check, (own, row)) in self.sets.iter_mut().zip(rows) {
            check.columns.push(own);
            check.factor.push(row);
        }
        true
    }

    /// Computes the errors at the points of all sets, one set after the other, from the residuals
    /// `r = y - fit`.
    pub(super) fn errors(&self, residuals: &[f64], errors: &mut Vec<f64>) {
        errors.clear();
        let single = self.of.single.iter().zip(&self.left);
        errors.extend(single.map(|(n, left)| residuals[*n as usize] / left));
        for (check, points) in self.sets.iter().zip(&self.of.sets) {
            let begin = errors.len();
            errors.extend(points.iter().map(|n| residuals[*n as usize]));
            check.correct(&mut errors[begin..]);
        }
    }
}

impl HeldOutSet {
    /// Next row of the Cholesky factor; `None` if the factor would be singular.
    fn border(&self, own: &[f64]) -> Option<Vec<f64>> {
        let mut row: Vec<f64> = self.columns.iter().map(|column| -dot(column, own)).collect();
        self.forward(&mut row);
        let left = 1.0 - dot(own, own) - dot(&row, &row);
        row.push((left > LEAST).then(|| left.sqrt())?);
        Some(row)
    }

    fn correct(&self, errors: &mut [f64]) {
        let mut inner: Vec<f64> = self.columns.iter().map(|column| dot(column, errors)).collect();
        self.forward(&mut inner);
        for n in (0..inner.len()).rev() {
            let value = inner[n] / self.factor[n][n];
            inner[n] = value;
            axpy(-value, &self.factor[n][..n], &mut inner[..n]);
        }
        for (column, value) in self.columns.iter().zip(&inner) {
            axpy(*value, column, errors);
        }
    }

    /// Solves with the lower triangle, in place.
    fn forward(&self, right: &mut [f64]) {
        for (n, row) in self.factor.iter().enumerate() {
            right[n] = (right[n] - dot(&row[..n], &right[..n])) / row[n];
        }
    }
}

/// Scalar product of two vectors.
#[must_use]
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    // Eight independent sums allow vectorisation.
    let mut sums = [0.0; 8];
    let (a8, b8) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f64 = a8.remainder().iter().zip(b8.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a8.zip(b8) {
        sums.iter_mut().zip(a).zip(b).for_each(|((sum, a), b)| *sum += a * b);
    }
    rest + sums.iter().sum::<f64>()
}

/// `b += factor a`.
pub(super) fn axpy(factor: f64, a: &[f64], b: &mut [f64]) {
    for (b, a) in b.iter_mut().zip(a) {
        *b += factor * a;
    }
}
