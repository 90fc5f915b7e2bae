//! What is expected of a value, and remarked on if it is otherwise.

use serde::{Deserialize, Serialize};

/// Bounds of the magnitude of a value in scenes that there are; beyond them a number is likely to be mistyped, or a model to
/// have left what it is made for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plausible {
    /// Least magnitude, of a value that is not zero (SI).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub least: Option<f64>,
    /// Largest magnitude (SI).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub most: Option<f64>,
    /// Why, or where this is from.
    pub why: String,
}

impl Plausible {
    /// Returns the bounds of a range of magnitudes; 0 and infinity are none.
    #[must_use]
    pub fn within(range: std::ops::RangeInclusive<f64>, why: &str) -> Self {
        let (least, most) = (*range.start(), *range.end());
        Self {
            least: (least > 0.0).then_some(least),
            most: most.is_finite().then_some(most),
            why: why.to_owned(),
        }
    }

    /// The bound that a value is beyond, if it is.
    #[must_use]
    pub fn bound_passed(&self, value: f64) -> Option<f64> {
        let size = value.abs();
        let least = self.least.filter(|least| size > 0.0 && size < *least);
        least.or(self.most.filter(|most| size > *most))
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
    }
}
