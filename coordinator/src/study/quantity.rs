//! The quantities of a summary that studies compare.

use run::format::number;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// How an error of a quantity is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Measure {
    /// Relative to its own value.
    Relative,
    /// As it is: a place, or what is a ratio already.
    Absolute,
    /// Its value is an error itself; nothing is compared.
    Itself,
}

impl Measure {
    /// An error as it is measured: in per cent, or as it is.
    #[must_use]
    pub(crate) fn show(self, error: f64) -> String {
        match self {
            Self::Relative => format!("{} %", number(100.0 * error, 2)),
            Self::Absolute | Self::Itself => number(error, 2),
        }
    }

    /// A change with its sign, as it is measured.
    #[must_use]
    pub(crate) fn show_change(self, change: f64) -> String {
        match change {
            0.0 => "same".to_owned(),
            _ if change > 0.0 => format!("+{}", self.show(change)),
            _ => self.show(change),
        }
    }
}

/// One quantity of a summary.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Quantity {
    /// Dotted key in `summary.json`.
    pub key: String,
    /// What it is, in few words.
    pub name: String,
    /// How its error is measured.
    pub measure: Measure,
}

/// The quantities that a study reports where a summary has them; the first is what a target of
/// accuracy means, if nothing else is named.
const INTEREST: [(&str, &str, Measure); 11] = [
    ("temperature.rail.max_rise_k", "rail rise", Measure::Relative),
    ("temperature.rail.x_over_a", "place x/a", Measure::Absolute),
    ("temperature.rail.penetration_depth_m", "depth to 1/e", Measure::Relative),
    ("contact.max_pressure_pa", "max pressure", Measure::Relative),
    ("contact.creepage_xi", "creepage", Measure::Relative),
    ("contact.friction_power_w", "friction power", Measure::Relative),
    ("coupling.energy_imbalance", "heat imbalance", Measure::Itself),
    ("temperature.wheel.max_rise_k", "wheel rise", Measure::Relative),
    ("contact.creep_force_x_n", "creep force x", Measure::Relative),
    ("contact.slip_area_ratio", "slip area", Measure::Absolute),
    ("contact.approach_m", "approach", Measure::Relative),
];

/// Sections of a summary that are about the run and not about the contact.
const NOT_PHYSICAL: [&str; 4] = ["schema", "coupling", "cost", "accuracy"];

/// The dotted keys of all quantities of a section.
fn numeric_keys(value: &Value, path: &str, keys: &mut Vec<String>) {
    match value {
        Value::Number(_) => keys.push(path.to_owned()),
        Value::Object(entries) => {
            entries
                .iter()
                .for_each(|(key, value)| numeric_keys(value, &format!("{path}.{key}"), keys));
        }
        _ => {}
    }
}

impl Quantity {
    /// The quantities of interest.
    #[must_use]
    pub(crate) fn of_interest() -> Vec<Self> {
        let quantity = |(key, name, measure): &(&str, &str, Measure)| Self {
            key: (*key).to_owned(),
            name: (*name).to_owned(),
            measure: *measure,
        };
        INTEREST.iter().map(quantity).collect()
    }

    /// The quantity of a key; any number of a summary is one.
    #[must_use]
    pub(crate) fn of(key: &str) -> Self {
        let known = Self::of_interest().into_iter().find(|quantity| quantity.key == key);
        let name = || run::format::words(key.rsplit('.').next().unwrap_or(key));
        let other = || Self { key: key.to_owned(), name: name(), measure: Measure::Relative };
        known.unwrap_or_else(other)
    }

    /// The quantities of interest, and every other quantity of the participants' sections, of a
    /// summary.
    #[must_use]
    pub(crate) fn all(summary: &Value) -> Vec<Self> {
        let mut keys = Vec::new();
        for section in summary.as_object().into_iter().flatten() {
            if !NOT_PHYSICAL.contains(&section.0.as_str()) {
                numeric_keys(section.1, section.0, &mut keys);
            }
        }
        let mut all = Self::of_interest();
        keys.retain(|key| all.iter().all(|known| known.key != *key));
        all.extend(keys.iter().map(|key| Self::of(key)));
        all
    }

    /// Its value in a summary.
    #[must_use]
    pub(crate) fn value(&self, summary: &Value) -> Option<f64> {
        let inner = |value, name: &str| Value::get(value, name);
        self.key.split('.').try_fold(summary, inner)?.as_f64()
    }

    /// The error of a value against a reference, as its measure says; never negative.
    #[must_use]
    pub(crate) fn error(&self, value: f64, reference: f64) -> f64 {
        match self.measure {
            Measure::Relative if reference == 0.0 && value == 0.0 => 0.0,
            Measure::Relative => ((value - reference) / reference).abs(),
            Measure::Absolute => (value - reference).abs(),
            Measure::Itself => value.abs(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_change_has_its_sign() {
        assert_eq!(Measure::Relative.show_change(0.123), "+12 %");
        assert_eq!(Measure::Relative.show_change(-0.004), "−0.40 %");
        assert_eq!(Measure::Absolute.show_change(-0.2), "−0.20");
        assert_eq!(Measure::Relative.show_change(0.0), "same");
    }

    #[test]
    fn figures_are_found_and_compared() {
        let summary = json!({"temperature": {"rail": {"max_rise_k": 220.0, "x_over_a": -0.8}}});
        let rise = Quantity::of("temperature.rail.max_rise_k");
        let place = Quantity::of("temperature.rail.x_over_a");
        assert_eq!(rise.value(&summary), Some(220.0));
        assert!((rise.error(220.0, 200.0) - 0.1).abs() < 1e-15);
        assert!((place.error(-0.8, -0.83) - 0.03).abs() < 1e-15);
        assert_eq!(Quantity::of("contact.creepage_xi").value(&summary), None);
        assert_eq!(Quantity::of("coupling.energy_imbalance").error(-1e-9, 5.0), 1e-9);
        assert_eq!(rise.error(0.0, 0.0), 0.0);
        assert_eq!(Quantity::of("wear.wear_depth_m").name, "wear depth m");
    }
}
