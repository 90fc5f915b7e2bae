//! Extent of the values of a field.

use serde::Serialize;

/// Smallest, largest and mean value, and the first that is none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Range {
    /// Smallest finite value.
    pub min: Option<f64>,
    /// Largest finite value.
    pub max: Option<f64>,
    /// Mean of the finite values.
    pub mean: Option<f64>,
    /// Index of the first value that is not finite.
    pub first_non_finite: Option<usize>,
}

impl Range {
    /// The range of a sample; in lanes, so that a compiler vectorises it.
    #[must_use]
    pub fn of(values: &[f64]) -> Self {
        let first_non_finite = proto::model::first_non_finite(values);
        let finite: Vec<f64>;
        let values = match first_non_finite {
            None => values,
            Some(_) => {
                finite = values.iter().copied().filter(|v| v.is_finite()).collect();
                &finite
            }
        };
        if values.is_empty() {
            return Self { first_non_finite, ..Self::default() };
        }
        let (mut low, mut high) = ([f64::INFINITY; 8], [f64::NEG_INFINITY; 8]);
        let chunks = values.chunks_exact(8);
        let rest = chunks.remainder();
        for chunk in chunks.chain(std::iter::once(rest)) {
            for ((low, high), value) in low.iter_mut().zip(&mut high).zip(chunk) {
                *low = if *value < *low { *value } else { *low };
                *high = if *value > *high { *value } else { *high };
            }
        }
        let sum = contract::grid::blocked_sum(values);
        Self {
            min: low.into_iter().reduce(f64::min),
            max: high.into_iter().reduce(f64::max),
            mean: Some(sum / values.len() as f64),
            first_non_finite,
        }
    }

    /// The range with 0 for an end that is rounding beside the other one.
    #[must_use]
    pub fn without_rounding(self) -> Self {
        let size = |value: Option<f64>| value.unwrap_or(0.0).abs();
        let least = f64::EPSILON * size(self.min).max(size(self.max));
        let whole = |value: f64| if value.abs() < least { 0.0 } else { value };
        Self {
            min: self.min.map(whole),
            max: self.max.map(whole),
            mean: self.mean.map(whole),
            ..self
        }
    }

    /// The range of both; the mean is over equally many values of each.
    #[must_use]
    pub fn and(self, other: Self, samples_so_far: u64) -> Self {
        let join = |a: Option<f64>, b: Option<f64>, of: fn(f64, f64) -> f64| match (a, b) {
            (Some(a), Some(b)) => Some(of(a, b)),
            (one, None) | (None, one) => one,
        };
        let n = samples_so_far as f64;
        let mean = match (self.mean, other.mean) {
            (Some(a), Some(b)) => Some(a + (b - a) / (n + 1.0)),
            (one, None) | (None, one) => one,
        };
        Self {
            min: join(self.min, other.min, f64::min),
            max: join(self.max, other.max, f64::max),
            mean,
            first_non_finite: self.first_non_finite.or(other.first_non_finite),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_many_and_few_values() {
        let values: Vec<f64> = (0..21).map(f64::from).collect();
        let range = Range::of(&values);
        assert_eq!((range.min, range.max, range.mean), (Some(0.0), Some(20.0), Some(10.0)));
        assert_eq!(Range::of(&[]), Range::default());
        let rise = Range::of(&[8.4948e-289, 1e-3, 226.0]).without_rounding();
        assert_eq!((rise.min, rise.max), (Some(0.0), Some(226.0)));
        let broken = Range::of(&[1.0, f64::NAN, -3.0]);
        assert_eq!((broken.min, broken.max, broken.mean), (Some(-3.0), Some(1.0), Some(-1.0)));
        assert_eq!(broken.first_non_finite, Some(1));
    }

    #[test]
    fn joined_ranges_are_those_of_all_values() {
        let parts = [[1.0, 5.0], [-2.0, 0.0], [3.0, 11.0]];
        let joined = parts
            .iter()
            .enumerate()
            .fold(Range::default(), |all, (n, part)| all.and(Range::of(part), n as u64));
        let whole = Range::of(parts.as_flattened());
        assert_eq!((joined.min, joined.max), (whole.min, whole.max));
        assert!((joined.mean.unwrap() - whole.mean.unwrap()).abs() < 1e-15);
    }
}
