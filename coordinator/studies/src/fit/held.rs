//! Points that are held out of a fit together, and what a least-squares fit without them gives at them.
//!
//! A point whose neighbours in one direction are all in the fit says little of the error between the values of
//! that direction. So a set that is held out is all points with one value of one key, the outermost values apart:
//! without those the rest would not reach. In a grid that is a whole plane of it; where every point has values of
//! its own it is one point.
//!
//! Where no point lies in a corner of the box, those nearest to it are held out together, too: the fit reaches from
//! the rest to them about as far as it reaches from them to the corner.
//!
//! With an orthonormal basis `Q` of the columns, residuals `r` and `Q_S` the rows of the set, the fit without the
//! set errs at it by
//!
//! ```text
//! e_S = (I - Q_S Q_Sᵀ)⁻¹ r_S = r_S + Q_S (I - Q_Sᵀ Q_S)⁻¹ Q_Sᵀ r_S ,
//! ```
//!
//! no fit made again (Woodbury; for one point `e = r / (1 - h)`, PRESS: Allen, Technometrics 16 (1974) 125). The
//! factor of the inner matrix grows by a row with each column (Cholesky by bordering).

use std::collections::BTreeMap;

/// Below this part of a column a set has, or a point, nothing is left to determine it by.
const LEAST: f64 = 1e-8;

/// The sets: points by number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct HeldOut {
    /// Sets of one point.
    single: Vec<u32>,
    /// The others.
    sets: Vec<Vec<u32>>,
}

impl HeldOut {
    /// The sets of points whose keys have these values.
    #[must_use]
    pub(super) fn of(keys: &[Vec<f64>]) -> Self {
        let inner = keys.iter().flat_map(|values| inner_sets(values));
        let mut sets: Vec<Vec<u32>> = inner.chain(corner_sets(keys)).collect();
        sets.sort();
        sets.dedup();
        let (single, sets) = sets.into_iter().partition::<Vec<_>, _>(|set| set.len() == 1);
        Self { single: single.concat(), sets }
    }

    /// The points of all sets, one set after the other.
    pub(super) fn points(&self) -> impl Iterator<Item = usize> {
        self.single.iter().chain(self.sets.iter().flatten()).map(|n| *n as usize)
    }
}

/// Points by value, without the least and the largest one.
fn inner_sets(values: &[f64]) -> Vec<Vec<u32>> {
    let mut by_value: BTreeMap<u64, Vec<u32>> = BTreeMap::new();
    for (n, value) in (0..).zip(values) {
        by_value.entry(ordered(*value)).or_default().push(n);
    }
    by_value.pop_first();
    by_value.pop_last();
    by_value.into_values().collect()
}

/// Most keys of which the corners are looked at: they have twice as many with each.
const MOST_CORNERED: usize = 8;
/// One of so many points is held out for a corner.
const ONE_OF: usize = 12;

/// The points nearest to each corner that is empty. Twice as far from it lie about `2^keys` times as many: so many at
/// most are taken.
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

/// From 0 at the least value to 1 at the largest.
fn scaled(values: &[f64]) -> Vec<f64> {
    let ends = |[from, to]: [f64; 2], value: &f64| [from.min(*value), to.max(*value)];
    let [from, to] = values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], ends);
    values.iter().map(|value| (value - from) / (to - from)).collect()
}

/// Bits in the order of the numbers.
fn ordered(value: f64) -> u64 {
    let bits = (value + 0.0).to_bits();
    if bits >> 63 == 0 { bits | 1 << 63 } else { !bits }
}

/// What is known of each set as columns are added.
pub(super) struct Checks<'a> {
    of: &'a HeldOut,
    /// `1 - h` of the single points.
    left: Vec<f64>,
    sets: Vec<Check>,
}

/// One set: the rows of the columns, column by column, and the factor of `I - Q_Sᵀ Q_S`, row by row.
#[derive(Default)]
struct Check {
    columns: Vec<Vec<f64>>,
    factor: Vec<Vec<f64>>,
}

impl<'a> Checks<'a> {
    /// Those of a fit without columns.
    #[must_use]
    pub(super) fn new(of: &'a HeldOut) -> Self {
        Self {
            of,
            left: vec![1.0; of.single.len()],
            sets: of.sets.iter().map(|_| Check::default()).collect(),
        }
    }

    /// Adds a column of the orthonormal basis; false, and nothing is added, if without one of the sets it is
    /// not determined.
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

    /// The errors at the points of all sets, one set after the other, of residuals `r = y - fit`.
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

impl Check {
    /// The next row of the factor.
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

    /// Solves with the lower triangle.
    fn forward(&self, right: &mut [f64]) {
        for (n, row) in self.factor.iter().enumerate() {
            right[n] = (right[n] - dot(&row[..n], &right[..n])) / row[n];
        }
    }
}

/// The scalar product.
#[must_use]
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    // Eight sums that do not wait for each other.
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
