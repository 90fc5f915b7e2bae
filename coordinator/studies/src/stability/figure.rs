//! A quantity of a run: a product of powers of what the run gives.
//!
//! A product of powers is the form of every dimensionless group, so that one bound can hold along a
//! whole sweep. Its factors are dotted keys: of `summary.json`, `field.NAME.min`, `.max` and `.mean`
//! over all that a participant has sent, and `case.KEY` for a value of the case in SI units.

use contract::figure::value;
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt;

/// Keys and exponents.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(transparent)]
pub(super) struct PowerProduct(BTreeMap<String, f64>);

impl PowerProduct {
    /// Its value, or the key that the run does not give.
    pub(super) fn value(&self, quantities: &Value) -> Result<f64, &str> {
        self.0.iter().try_fold(1.0, |product, (key, exponent)| {
            let factor = value(quantities, key).ok_or(key.as_str())?;
            Ok(product * factor.powf(*exponent))
        })
    }
}

impl fmt::Display for PowerProduct {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, (key, exponent)) in self.0.iter().enumerate() {
            let space = if index == 0 { "" } else { " · " };
            match *exponent {
                1.0 => write!(f, "{space}{key}")?,
                other => write!(f, "{space}{key}^{other}")?,
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_product_of_powers() {
        let product: PowerProduct = toml::from_str("\"a.b\" = 2\n\"c\" = -0.5").unwrap();
        assert_eq!(product.value(&json!({"a": {"b": 3.0}, "c": 4.0})), Ok(4.5));
        assert_eq!(product.value(&json!({"a": {"b": 3.0}})), Err("c"));
        assert_eq!(product.to_string(), "a.b^2 · c^-0.5");
        assert!(product.value(&json!({"a": {"b": 3.0}, "c": -1.0})).unwrap().is_nan());
    }
}
