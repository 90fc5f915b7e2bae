//! Plausible ranges of values; a value outside produces a warning.

use serde::{Deserialize, Serialize};

/// Bounds of the magnitude of a value in realistic scenes. A value outside is probably mistyped, or
/// a model is used outside its range.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plausible {
    /// Smallest magnitude of a nonzero value (SI).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub least: Option<f64>,
    /// Largest magnitude (SI).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub most: Option<f64>,
    /// Reason for the bounds, or their source.
    pub why: String,
}

impl Plausible {
    /// Returns the bounds of a range of magnitudes; 0 and infinity mean no bound.
    #[must_use]
    pub fn within(range: std::ops::RangeInclusive<f64>, why: &str) -> Self {
        let (least, most) = (*range.start(), *range.end());
        Self {
            least: (least > 0.0).then_some(least),
            most: most.is_finite().then_some(most),
            why: why.to_owned(),
        }
    }

    /// Returns the bound that a value violates, if any.
    #[must_use]
    pub fn bound_passed(&self, value: f64) -> Option<f64> {
        let size = value.abs();
        let least = self.least.filter(|least| size > 0.0 && size < *least);
        least.or(self.most.filter(|most| size > *most))
    }

    /// Returns the ratio, above 1, by which a value violates its bound; `None` within the range.
    #[must_use]
    pub fn excess(&self, value: f64) -> Option<f64> {
        let (size, bound) = (value.abs(), self.bound_passed(value)?);
        Some(if size < bound { bound / size } else { size / bound })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn magnitudes() {
        let of = |least, most| Plausible { least, most, why: String::new() };
        let both = of(Some(1.0), Some(10.0));
        assert_eq!((both.bound_passed(0.5), both.bound_passed(-20.0)), (Some(1.0), Some(10.0)));
        assert_eq!((both.bound_passed(0.0), both.bound_passed(-5.0)), (None, None));
        assert_eq!(of(None, None).bound_passed(1e300), None);
        assert_eq!((both.excess(0.5), both.excess(-20.0)), (Some(2.0), Some(2.0)));
        assert_eq!(both.excess(-5.0), None);
    }
}
