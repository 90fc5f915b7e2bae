//! Reconstruction of the heat flux inside elements from element means.
//!
//! Along a row, with θ ∈ [0, 1] the position inside an element in the direction of x, the flux is
//! the parabola in Bernstein form
//!
//! q(θ) = l (1−θ)² + 2 m θ(1−θ) + r θ²,  mean (l + m + r)/3,
//!
//! with the values l and r at the element's edges, shared by neighbours, and the middle coefficient
//! m = 3q̄ − l − r, which keeps the mean q̄. The edge values are those of the cubic through the
//! means of the four elements around the edge (Colella & Woodward, J. Comput. Phys. 54 (1984)
//! 174–201): (7/12)(q̄₋₁ + q̄₁) − (1/12)(q̄₋₂ + q̄₂). Near the ends of the row, where the grid has
//! no neighbour, the parabola through three means gives them. At the upstream end itself (large x)
//! the value is 0: the entering material has received no heat.
//!
//! Limiter. The parabola is non-negative if l, r ≥ 0 and m ≥ −√(lr), that is if
//! l + r − √(lr) ≤ 3q̄. The left-hand side is at most max(l, r), so each edge value is kept between
//! 0 and 3 times the smaller of the two neighbouring means. A resolved flux stays far below this
//! bound: a smooth flux is never clipped, extrema included. Deviation from Colella & Woodward:
//! their limiter flattens extrema. Between means of opposite sign the edge value is 0. Negative
//! means (cooling) mirror positive ones, so that the reconstruction of −q is the negative of that
//! of q. An element with mean 0 has zero flux throughout.

use grids::blocked_sum;
use grids::state::{read_bytes, read_numbers, write_numbers};
use std::io::{self, Read, Write};
use std::ops::Range;

/// Values read at once by the inner loops; rows are padded with as many zeros.
pub const LANES: usize = 8;

/// A reconstructed flux on a grid of rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Flux {
    columns: usize,
    rows: usize,
    stride: usize,
    /// Middle coefficients, `stride` values a row.
    middle: Vec<f64>,
    /// Edge values, `stride` a row; edge i is the edge before element i.
    edge: Vec<f64>,
    /// First and last element with a flux, for each row.
    support: Vec<(u32, u32)>,
    /// Whether no mean is negative.
    heating: bool,
}

/// A row of a [`Flux`]: coefficients padded with [`LANES`] zeros.
#[derive(Clone, Copy, Debug)]
pub struct FluxRow<'a> {
    /// Middle coefficients [W/m²].
    pub middle: &'a [f64],
    /// Edge values [W/m²]; edge i is the edge before element i.
    pub edge: &'a [f64],
    /// First element with a flux, and the element after the last.
    pub support: (usize, usize),
}

/// Some rows of a [`Flux`] to be reconstructed.
pub struct Piece<'a> {
    columns: usize,
    means: &'a [f64],
    middle: &'a mut [f64],
    edge: &'a mut [f64],
    support: &'a mut [(u32, u32)],
}

impl Piece<'_> {
    /// Reconstructs the rows from the element means.
    pub fn reconstruct(self) {
        let stride = self.columns + 1 + LANES;
        let coefficients = self.middle.chunks_mut(stride).zip(self.edge.chunks_mut(stride));
        let rows = self.means.chunks(self.columns).zip(self.support);
        for ((means, support), (middle, edge)) in rows.zip(coefficients) {
            *support = support_of(means);
            if support.1 == 0 {
                middle.fill(0.0);
                edge.fill(0.0);
            } else {
                reconstruct_row(means, middle, edge);
            }
        }
    }
}

impl Flux {
    /// Creates a zero flux on `rows` rows of `columns` elements.
    #[must_use]
    pub fn zero(columns: usize, rows: usize) -> Self {
        let stride = columns + 1 + LANES;
        let zeros = vec![0.0; rows * stride];
        Self {
            columns,
            rows,
            stride,
            middle: zeros.clone(),
            edge: zeros,
            support: vec![(0, 0); rows],
            heating: true,
        }
    }

    /// Returns the memory [byte] of a flux on `rows` rows of `columns` elements.
    #[must_use]
    pub fn bytes(columns: usize, rows: usize) -> u64 {
        (rows * (2 * (columns + 1 + LANES) * size_of::<f64>() + 2 * size_of::<u32>())) as u64
    }

    /// Returns whether no element mean is negative, which makes the flux nowhere negative.
    #[must_use]
    pub fn is_heating(&self) -> bool {
        self.heating
    }

    /// Returns a row of the flux.
    #[must_use]
    pub fn row(&self, row: usize) -> FluxRow<'_> {
        let span = self.span(row);
        let (first, end) = self.support[row];
        FluxRow {
            middle: &self.middle[span.clone()],
            edge: &self.edge[span],
            support: (first as usize, end as usize),
        }
    }

    fn span(&self, row: usize) -> Range<usize> {
        row * self.stride..(row + 1) * self.stride
    }

    /// Replaces this flux by another one on the same grid.
    pub fn copy_from(&mut self, other: &Self) {
        self.middle.copy_from_slice(&other.middle);
        self.edge.copy_from_slice(&other.edge);
        self.support.copy_from_slice(&other.support);
        self.heating = other.heating;
    }

    /// Sets the flux to zero.
    pub fn clear(&mut self) {
        self.middle.fill(0.0);
        self.edge.fill(0.0);
        self.support.fill((0, 0));
        self.heating = true;
    }

    /// Reconstructs the flux from element means [W/m²], `columns` values a row.
    pub fn reconstruct(&mut self, means: &[f64]) {
        self.pieces(means, self.rows).for_each(Piece::reconstruct);
    }

    /// Adds `factor` times a flux given at some elements, in ascending order [W/m²]; the result is
    /// linear in the values. An edge between two of these elements gets the value of the cubic,
    /// with 0 for any other element. Any other edge gets 0.
    pub fn add(&mut self, elements: &[usize], values: &[f64], factor: f64) {
        let columns = self.columns;
        let follows = |k: usize| {
            k > 0
                && k < elements.len()
                && elements[k - 1] + 1 == elements[k]
                && !elements[k].is_multiple_of(columns)
        };
        for (k, (at, value)) in elements.iter().zip(values).enumerate() {
            let (row, column) = (at / columns, at % columns);
            let place = row * self.stride + column;
            self.middle[place] += 3.0 * factor * value;
            if follows(k) {
                let behind = if follows(k - 1) { values[k - 2] } else { 0.0 };
                let ahead = if follows(k + 1) { values[k + 1] } else { 0.0 };
                let edge = factor * (7.0 * (values[k - 1] + value) - behind - ahead) / 12.0;
                self.edge[place] += edge;
                self.middle[place - 1] -= edge;
                self.middle[place] -= edge;
            }
            self.heating &= factor * value >= 0.0;
            let column = column as u32;
            let support = &mut self.support[row];
            *support = match *support {
                (_, 0) => (column, column + 1),
                (first, end) => (first.min(column), end.max(column + 1)),
            };
        }
    }

    /// Splits [`Flux::reconstruct`] into pieces of `rows` rows, which may be reconstructed in any
    /// order.
    pub fn pieces<'a>(
        &'a mut self,
        means: &'a [f64],
        rows: usize,
    ) -> impl Iterator<Item = Piece<'a>> + Send {
        self.heating = means.iter().fold(true, |all, mean| all & (*mean >= 0.0));
        let (columns, stride) = (self.columns, self.stride);
        let coefficients =
            self.middle.chunks_mut(rows * stride).zip(self.edge.chunks_mut(rows * stride));
        let supports = self.support.chunks_mut(rows).zip(means.chunks(rows * columns));
        coefficients.zip(supports).map(move |((middle, edge), (support, means))| Piece {
            columns,
            means,
            middle,
            edge,
            support,
        })
    }

    /// Replaces this flux by the mean of itself over `own` seconds and `other` over `others`
    /// seconds.
    pub fn merge(&mut self, own: f64, other: &Self, others: f64) {
        let (keep, take) = (own / (own + others), others / (own + others));
        for (mine, theirs) in [(&mut self.middle, &other.middle), (&mut self.edge, &other.edge)] {
            for (a, b) in mine.iter_mut().zip(theirs) {
                *a = keep * *a + take * b;
            }
        }
        self.heating &= other.heating;
        for (mine, &theirs) in self.support.iter_mut().zip(&other.support) {
            *mine = match (*mine, theirs) {
                ((_, 0), any) | (any, (_, 0)) => any,
                (a, b) => (a.0.min(b.0), a.1.max(b.1)),
            };
        }
    }

    /// Writes the means of one row's parabolas, `columns` values [W/m²].
    pub fn means_into(&self, row: usize, means: &mut [f64]) {
        let FluxRow { middle, edge, .. } = self.row(row);
        for (i, mean) in means.iter_mut().enumerate() {
            *mean = (edge[i] + middle[i] + edge[i + 1]) / 3.0;
        }
    }

    /// Returns the flux [W/m²] at the position θ ∈ [0, 1] inside an element.
    #[must_use]
    pub fn at(&self, row: usize, element: usize, theta: f64) -> f64 {
        let FluxRow { middle, edge, .. } = self.row(row);
        let back = 1.0 - theta;
        edge[element] * back * back
            + 2.0 * middle[element] * theta * back
            + edge[element + 1] * theta * theta
    }

    /// Writes coefficients and supports, in the order in which [`Flux::restore`] reads them.
    ///
    /// # Errors
    /// Writing to `into` fails.
    pub fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        write_numbers(into, self.middle.iter().chain(&self.edge))?;
        for (first, end) in &self.support {
            into.write_all(&first.to_le_bytes())?;
            into.write_all(&end.to_le_bytes())?;
        }
        into.write_all(&[u8::from(self.heating)])
    }

    /// Restores the flux written by [`Flux::save`].
    ///
    /// # Errors
    /// The data end too early, or a support is not inside the row.
    pub fn restore(&mut self, from: &mut dyn Read) -> io::Result<()> {
        read_numbers(from, self.middle.iter_mut().chain(&mut self.edge))?;
        for support in &mut self.support {
            *support =
                (u32::from_le_bytes(read_bytes(from)?), u32::from_le_bytes(read_bytes(from)?));
            if support.0 > support.1 || support.1 as usize > self.columns {
                return Err(io::Error::other("a support is not inside the row"));
            }
        }
        let [heating] = read_bytes(from)?;
        self.heating = heating == 1;
        Ok(())
    }

    /// Number of elements in a row.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }
}

/// Returns the sum of the element means of a flux, computed from its parabolas [W/m²].
pub fn sum_of_means(flux: &Flux, row_sums: &mut [f64], line: &mut [f64]) -> f64 {
    for (row, sum) in row_sums.iter_mut().enumerate() {
        flux.means_into(row, line);
        *sum = blocked_sum(line);
    }
    blocked_sum(row_sums)
}

fn support_of(means: &[f64]) -> (u32, u32) {
    let first = means.iter().position(|mean| *mean != 0.0);
    let last = means.iter().rposition(|mean| *mean != 0.0);
    match (first, last) {
        (Some(first), Some(last)) => (first as u32, last as u32 + 1),
        _ => (0, 0),
    }
}

fn reconstruct_row(means: &[f64], middle: &mut [f64], edge: &mut [f64]) {
    let n = means.len();
    for (window, value) in means.windows(4).zip(&mut edge[2..]) {
        let wide = window[0] + window[3];
        let near = window[1] + window[2];
        *value = limited((7.0 * near - wide) / 12.0, window[1], window[2]);
    }
    end_edges(means.iter().copied(), |i, value| edge[i] = value);
    end_edges(means.iter().rev().copied(), |i, value| edge[n - i] = value);
    edge[n] = 0.0;
    for (i, (middle, mean)) in middle.iter_mut().zip(means).enumerate() {
        *middle = if *mean == 0.0 { 0.0 } else { 3.0 * mean - edge[i] - edge[i + 1] };
    }
}

/// Sets the first two edge values of a row that begins with `means` from one-sided parabolas, or
/// from straight lines or constants if the row is too short.
fn end_edges(mut means: impl Iterator<Item = f64>, mut set: impl FnMut(usize, f64)) {
    let Some(first) = means.next() else { return };
    match (means.next(), means.next()) {
        (Some(second), Some(third)) => {
            let outer = (11.0 * first - 7.0 * second + 2.0 * third) / 6.0;
            let inner = (2.0 * first + 5.0 * second - third) / 6.0;
            set(0, limited(outer, first, first));
            set(1, limited(inner, first, second));
        }
        (Some(second), None) => {
            set(0, limited(1.5 * first - 0.5 * second, first, first));
            set(1, limited(0.5 * (first + second), first, second));
        }
        _ => set(0, first),
    }
}

/// Limits an edge value to between 0 and three times the smaller of the neighbouring means.
fn limited(value: f64, left: f64, right: f64) -> f64 {
    let sign = left.signum();
    if left == 0.0 || right == 0.0 || sign != right.signum() {
        return 0.0;
    }
    sign * (sign * value).clamp(0.0, 3.0 * left.abs().min(right.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn reconstructed(means: &[f64]) -> Flux {
        let mut flux = Flux::zero(means.len(), 1);
        flux.reconstruct(means);
        flux
    }

    #[test]
    fn exact_for_parabolas_up_to_the_upstream_end() {
        let q = |x: f64| 9.0 + 0.5 * x - 0.1 * x * x;
        let mean = |i: usize| {
            let x = i as f64;
            q(x + 0.5) - 0.1 / 12.0
        };
        let flux = reconstructed(&(0..9).map(mean).collect::<Vec<_>>());
        for i in 0..8 {
            for theta in [0.0, 0.3, 0.5, 1.0] {
                let error = flux.at(0, i, theta) - q(i as f64 + theta);
                // Tolerance: rounding only.
                assert!(error.abs() < 1e-13, "{i} {theta}: {error:e}");
            }
        }
    }

    #[test]
    fn smooth_extrema_are_not_clipped_and_the_order_is_three() {
        let q = |x: f64| 1.001 + (7.0 * x).sin();
        let primitive = |x: f64| 1.001 * x - (7.0 * x).cos() / 7.0;
        let errors: Vec<f64> = [20_usize, 40, 80, 160]
            .iter()
            .map(|&n| {
                let h = 1.0 / n as f64;
                let edges = |i: usize| primitive(i as f64 * h);
                let means: Vec<f64> = (0..n).map(|i| (edges(i + 1) - edges(i)) / h).collect();
                let flux = reconstructed(&means);
                let places = (0..n - 1).flat_map(|i| (0..=4).map(move |k| (i, f64::from(k) / 4.0)));
                places
                    .map(|(i, theta)| (flux.at(0, i, theta) - q((i as f64 + theta) * h)).abs())
                    .fold(0.0, f64::max)
            })
            .collect();
        for pair in errors.windows(2) {
            // Third order expected; 0.3 of an order for coarse grids.
            assert!((pair[0] / pair[1]).log2() > 2.7, "{errors:?}");
        }
    }

    #[test]
    fn short_rows_keep_their_means() {
        for means in [vec![2.0], vec![2.0, 1.0], vec![2.0, 1.0, 5.0], vec![0.0, 3.0]] {
            let flux = reconstructed(&means);
            let mut back = vec![0.0; means.len()];
            flux.means_into(0, &mut back);
            for (a, b) in means.iter().zip(&back) {
                // Tolerance: rounding of two sums.
                assert!((a - b).abs() < 4e-15, "{means:?} {back:?}");
            }
        }
    }

    #[test]
    fn no_flux_where_the_mean_is_zero_and_mirror_images_mirror() {
        let means = [0.0, 0.0, 1.0, 4.0, 2.0, 0.0, 0.5, 0.0, 0.0];
        let flux = reconstructed(&means);
        let mirrored = reconstructed(&means.iter().rev().copied().collect::<Vec<_>>());
        let negative = reconstructed(&means.map(|mean| -mean));
        assert_eq!(flux.row(0).support, (2, 7));
        for (i, mean) in means.iter().enumerate() {
            for theta in [0.0, 0.25, 1.0] {
                let value = flux.at(0, i, theta);
                assert!(*mean != 0.0 || value == 0.0);
                assert!((value - mirrored.at(0, 8 - i, 1.0 - theta)).abs() < 1e-14);
                assert_eq!(value, -negative.at(0, i, theta));
            }
        }
    }

    proptest! {
        #[test]
        fn never_negative_and_keeps_the_means(means in prop::collection::vec(
            prop_oneof![Just(0.0), 0.0..1.0, 0.0..1e6], 1..40)) {
            let flux = reconstructed(&means);
            let mut back = vec![0.0; means.len()];
            flux.means_into(0, &mut back);
            for i in 0..means.len() {
                // Rounding of sums of terms up to three times the largest neighbouring mean.
                let scale = means[i.saturating_sub(1)..(i + 2).min(means.len())]
                    .iter().fold(0.0, |a: f64, b| a.max(*b));
                prop_assert!((back[i] - means[i]).abs() <= 1e-15 * scale.max(means[i]));
                for k in 0..=16 {
                    let value = flux.at(0, i, f64::from(k) / 16.0);
                    prop_assert!(value >= -1e-15 * means[i], "{i} {k}: {value}");
                }
            }
        }

        #[test]
        fn saved_bytes_restore_every_bit(means in prop::collection::vec(-1.0..1.0, 12)) {
            let mut flux = Flux::zero(4, 3);
            flux.reconstruct(&means);
            let mut bytes = Vec::new();
            flux.save(&mut bytes).unwrap();
            let mut back = Flux::zero(4, 3);
            let mut rest = bytes.as_slice();
            back.restore(&mut rest).unwrap();
            prop_assert!(rest.is_empty());
            prop_assert_eq!(&back, &flux);
            prop_assert!(back.restore(&mut &bytes[1..]).is_err());
        }
    }
}
