//! Target of accuracy: a relative error of a quantity.

use crate::study::quantity::{Quantities, Quantity};
use contract::figure::Measure;
use run::error::RunError;
use run::results::summary::Summary;

/// A target of accuracy.
#[derive(Clone, Debug, PartialEq)]
pub struct Target {
    /// Largest relative error; `None` to accept the error of the case's own grid.
    pub relative: Option<f64>,
    /// Key of the quantity in the summary; `None` for the first quantity of interest in the
    /// summary.
    pub quantity: Option<String>,
}

impl Target {
    /// Largest relative error, infinite without a target.
    #[must_use]
    pub fn most(&self) -> f64 {
        self.relative.unwrap_or(f64::INFINITY)
    }

    /// Parses `1%` or `0.01`.
    ///
    /// # Errors
    /// The text is not a number above 0 and below 1.
    pub fn read_error(text: &str) -> Result<f64, String> {
        let (number, unit) = match text.trim().strip_suffix('%') {
            Some(number) => (number, 0.01),
            None => (text, 1.0),
        };
        let error = number.trim().parse::<f64>().ok().map(|number| number * unit);
        error
            .filter(|error| *error > 0.0 && *error < 1.0)
            .ok_or_else(|| format!("`{text}` is not a relative error; write 1% or 0.01"))
    }

    /// Returns the quantity and its driver.
    ///
    /// # Errors
    /// The summary lacks the quantity, or the quantity has no relative error.
    pub(super) fn quantities(
        &self,
        summary: &Summary,
        quantities: &Quantities,
    ) -> Result<Vec<Quantity>, RunError> {
        let there = |quantity: &Quantity| quantity.value(summary).is_some();
        let known = quantities.all(summary);
        let suits = |one: &&Quantity| one.measure == Measure::Relative && there(one);
        let first = match &self.quantity {
            Some(key) => known.iter().find(|one| one.key == *key && suits(one)),
            None => known.iter().find(suits),
        };
        let first = first.cloned().ok_or_else(|| {
            let keys: Vec<&str> = known.iter().filter(suits).map(|one| one.key.as_str()).collect();
            let asked = match &self.quantity {
                Some(key) => {
                    format!(
                        "the run has no quantity `{key}` with a relative error; positions, \
                             fractions and counts have none"
                    )
                }
                None => "the run has no quantity with a relative error".to_owned(),
            };
            RunError::Usage(format!(
                "{asked}; name one of these with --quantity: {}",
                keys.join(", ")
            ))
        })?;
        let driver = quantities.driver(&first).filter(there);
        Ok(std::iter::once(first).chain(driver).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contract::figure::FigureSpec;
    use serde_json::json;

    #[test]
    fn errors_are_read_in_per_cent_or_as_they_are() {
        assert!((Target::read_error("1%").unwrap() - 0.01).abs() < 1e-15);
        assert!((Target::read_error(" 0.2 % ").unwrap() - 0.002).abs() < 1e-15);
        assert_eq!(Target::read_error("0.05"), Ok(0.05));
        for wrong in ["", "%", "0", "-1%", "100%", "nan", "one"] {
            assert!(Target::read_error(wrong).unwrap_err().contains("write 1% or 0.01"), "{wrong}");
        }
    }

    #[test]
    fn a_quantity_is_watched_with_what_drives_it() {
        let figures = [
            FigureSpec::new("temperature.rail.max_rise_k", "K", "rise")
                .rank(1)
                .driven_by("contact.friction_power_w"),
            FigureSpec::new("contact.friction_power_w", "W", "power").rank(2),
        ];
        let known = Quantities::of_figures(&figures);
        let summary = Summary::of_sections(json!({
            "temperature": {"rail": {"max_rise_k": 1.0}},
            "contact": {"friction_power_w": 2.0, "max_pressure_pa": 3.0},
        }));
        let keys = |quantity: Option<&str>| -> Result<Vec<String>, RunError> {
            let target = Target { relative: Some(0.01), quantity: quantity.map(str::to_owned) };
            Ok(target.quantities(&summary, &known)?.into_iter().map(|one| one.key).collect())
        };
        let both = ["temperature.rail.max_rise_k", "contact.friction_power_w"];
        assert_eq!(keys(None).unwrap(), both);
        assert_eq!(keys(Some("contact.max_pressure_pa")).unwrap(), ["contact.max_pressure_pa"]);
        let refused = keys(Some("contact.area")).unwrap_err().to_string();
        assert!(
            refused.contains("no quantity `contact.area`") && refused.contains("max_pressure_pa")
        );
    }
}
