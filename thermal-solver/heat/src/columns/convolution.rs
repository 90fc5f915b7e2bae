//! Convolution of the weights with the flux, along the rows of a grid.
//!
//! The sum runs over blocks of [`LANES`] neighbouring points. Their partial sums stay in registers,
//! and each pair of weights is read once a block. Only elements with a flux are visited, so a point
//! ahead of all flux gets exactly 0.

use super::reconstruction::{Flux, FluxRow, LANES};
use super::spectral::Spectral;
use super::stencil::{Part, Segment, Stencil, walk};

/// Number of elements in a row from which the steady convolution uses Fourier transforms. On a full
/// row the costs cross between 41 elements (direct 0.32 µs, transforms 0.36 µs) and 81 (0.72 and
/// 0.58 µs), measured by the benchmark `columns` of this crate in a plain x86-64 build.
pub const CROSSOVER: usize = 64;

/// Adds the contribution of one part of a stencil to a row of values, one for each point. Returns
/// the number of multiply-adds.
pub fn accumulate(part: &Part<'_>, row: FluxRow<'_>, values: &mut [f64]) -> u64 {
    let (support, end) = row.support;
    let (mut work, weights) = (0, part.edge.len());
    for (block, values) in values.chunks_mut(LANES).enumerate() {
        let start = block * LANES;
        if start > end || end == 0 {
            break;
        }
        let low = support.saturating_sub(start + LANES - 1).max(part.first);
        let high = (end - start + 1).min(part.first + weights);
        if low >= high {
            continue;
        }
        let span = low - part.first..high - part.first;
        let sums = block_sums(
            &part.middle[span.clone()],
            &part.edge[span],
            &row.middle[start + low..],
            &row.edge[start + low..],
        );
        for (value, sum) in values.iter_mut().zip(sums) {
            *value += sum;
        }
        work += (2 * LANES * (high - low)) as u64;
    }
    work
}

#[inline]
fn block_sums(wm: &[f64], we: &[f64], m: &[f64], e: &[f64]) -> [f64; LANES] {
    let mut sums = [0.0; LANES];
    let flux = m.windows(LANES).zip(e.windows(LANES));
    for ((wm, we), (m, e)) in wm.iter().zip(we).zip(flux) {
        for lane in 0..LANES {
            sums[lane] += wm * m[lane] + we * e[lane];
        }
    }
    sums
}

/// Returns the integral at one point of a row: the position `theta` inside `element`, at the depth
/// c = z/(2√κ) [√s], for the segments of `past` with their flux.
#[must_use]
pub fn at_point<'a>(
    past: impl Iterator<Item = (Segment, &'a Flux)> + Clone,
    row: usize,
    element: usize,
    theta: f64,
    depth: f64,
) -> f64 {
    let rows: Vec<FluxRow<'_>> = past.clone().map(|(_, flux)| flux.row(row)).collect();
    let Some((_, newest)) = past.clone().next() else { return 0.0 };
    let reach = newest.columns() - element;
    let mut sum = 0.0;
    walk(past.map(|(segment, _)| segment), theta, reach, depth, |index, k, weights| {
        let (FluxRow { middle, edge, .. }, i) = (rows[index], element + k);
        sum += weights[0] * edge[i] + weights[1] * middle[i] + weights[2] * edge[i + 1];
    });
    sum
}

/// The steady surface convolution, in units in which the material passes an element in unit time.
///
/// The result times share/(β√π) · √(h/V) is the temperature rise of a body [K].
#[derive(Clone)]
pub struct Steady {
    stencil: Stencil,
    spectral: Option<Spectral>,
}

impl Steady {
    /// Selects the faster method for rows of `columns` elements.
    #[must_use]
    pub fn new(columns: usize) -> Self {
        if columns < CROSSOVER { Self::direct(columns) } else { Self::over_fourier(columns) }
    }

    /// Uses direct summation.
    #[must_use]
    pub fn direct(columns: usize) -> Self {
        let mut stencil = Stencil::default();
        let segment = Segment { duration: f64::INFINITY, rate: 1.0, factor: 1.0 };
        stencil.build(std::iter::once(segment), columns, 0.0);
        Self { stencil, spectral: None }
    }

    /// Uses Fourier transforms.
    #[must_use]
    pub fn over_fourier(columns: usize) -> Self {
        let direct = Self::direct(columns);
        let spectral = direct.stencil.parts().next().map(|part| Spectral::new(&part, columns));
        Self { spectral, ..direct }
    }

    /// Writes the convolution of one row. Returns the number of multiply-adds.
    pub fn apply(&mut self, row: FluxRow<'_>, values: &mut [f64]) -> u64 {
        if row.support.1 == 0 {
            values.fill(0.0);
            return 0;
        }
        match &mut self.spectral {
            Some(spectral) => {
                let work = spectral.apply(row, values);
                // Transforms spread rounding errors over the whole row; by causality the rise here
                // is zero.
                values[row.support.1..].fill(0.0);
                work
            }
            None => {
                values.fill(0.0);
                self.stencil.parts().map(|part| accumulate(&part, row, values)).sum()
            }
        }
    }
}

/// Removes rounding errors from rises that cannot be negative, because no flux was negative. The
/// exact value is at least 0, so raising a negative value to 0 always reduces the error.
pub fn remove_negative_rounding(values: &mut [f64]) {
    for value in values {
        *value = value.max(0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(n: usize) -> Vec<f64> {
        let mut state = 7_u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 40) as f64 / (1 << 24) as f64
        };
        (0..n).map(|i| if i % 7 < 2 { 0.0 } else { next() }).collect()
    }

    #[test]
    fn both_ways_agree_to_rounding_at_every_length() {
        for columns in [1, 2, 3, 7, 8, 9, 80, 81, 161, 320, 321] {
            let mut flux = Flux::zero(columns, 1);
            flux.reconstruct(&noise(columns));
            let (mut direct, mut fourier) = (vec![1.0; columns], vec![2.0; columns]);
            Steady::direct(columns).apply(flux.row(0), &mut direct);
            Steady::over_fourier(columns).apply(flux.row(0), &mut fourier);
            let largest = direct.iter().copied().fold(0.0, f64::max);
            for (a, b) in direct.iter().zip(&fourier) {
                // Rounding of the transforms grows like the logarithm of the length.
                assert!((a - b).abs() <= 4e-15 * largest, "{columns}: {a} {b}");
            }
        }
    }

    #[test]
    fn row_and_single_points_agree() {
        let columns = 21;
        let mut flux = Flux::zero(columns, 1);
        flux.reconstruct(&noise(columns));
        let mut row = vec![0.0; columns];
        Steady::direct(columns).apply(flux.row(0), &mut row);
        let past = [(Segment { duration: f64::INFINITY, rate: 1.0, factor: 1.0 }, &flux)];
        for (i, value) in row.iter().enumerate() {
            let point = at_point(past.iter().copied(), 0, i, 0.5, 0.0);
            // Rounding: the order of summation differs.
            assert!((value - point).abs() <= 1e-14 * value.abs(), "{i}: {value} {point}");
        }
    }

    #[test]
    fn exactly_zero_ahead_of_the_flux() {
        let columns = 200;
        let mut means = noise(columns);
        means[60..].fill(0.0);
        let last = means.iter().rposition(|mean| *mean != 0.0).unwrap();
        let mut flux = Flux::zero(columns, 1);
        flux.reconstruct(&means);
        for mut way in [Steady::direct(columns), Steady::over_fourier(columns)] {
            let mut row = vec![1.0; columns];
            way.apply(flux.row(0), &mut row);
            assert!(row[last] > 0.0);
            assert!(row[last + 1..].iter().all(|value| *value == 0.0));
        }
    }

    #[test]
    fn work_of_a_full_row_is_a_triangle_of_blocks() {
        let columns = 80;
        let mut flux = Flux::zero(columns, 1);
        flux.reconstruct(&vec![1.0; columns]);
        let work = Steady::direct(columns).apply(flux.row(0), &mut vec![0.0; columns]);
        let blocks = (0..columns).step_by(LANES).map(|start| columns - start + 1);
        assert_eq!(work, 2 * LANES as u64 * blocks.sum::<usize>() as u64);
    }
}
