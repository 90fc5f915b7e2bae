//! Quantities that studies compare: the ones that participants describe, and any other number in a
//! summary.

use contract::figure::{FigureSpec, Measure, Style};
use run::format::{Scale, number, of_key, words};
use run::results::summary::Summary;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Formats an error: relative errors in per cent, absolute ones as a number.
#[must_use]
pub fn show_error(measure: Measure, error: f64) -> String {
    match measure {
        Measure::Relative => format!("{} %", number(100.0 * error, 2)),
        Measure::Absolute | Measure::Itself => number(error, 2),
    }
}

/// Formats a change with its sign, relative changes in per cent.
#[must_use]
pub fn show_change(measure: Measure, change: f64) -> String {
    match change {
        0.0 => "same".to_owned(),
        _ if change > 0.0 => format!("+{}", show_error(measure, change)),
        _ => show_error(measure, change),
    }
}

/// One quantity of a summary.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Quantity {
    /// Dotted key in `summary.json`.
    pub key: String,
    /// Short name.
    pub name: String,
    /// Measure of its error.
    pub measure: Measure,
    /// Number format.
    #[serde(default)]
    pub style: Style,
}

/// All quantities known to a study.
#[derive(Clone, Debug, Default)]
pub struct Quantities {
    /// Quantities to report wherever a summary has them. The first is the default for an accuracy
    /// target.
    pub of_interest: Vec<Quantity>,
    /// Other quantities that participants describe.
    others: Vec<Quantity>,
    /// Pairs of a quantity and its driver: an error of the driver carries over to the quantity.
    drivers: Vec<(String, String)>,
}

/// Quantity of the coordinator: the imbalance of the heat that participants exchange.
const IMBALANCE: (&str, &str) = ("coupling.energy_imbalance", "heat imbalance");

/// Collects the dotted keys of all numbers in a section.
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

impl Quantities {
    /// Builds the list from the figures of the participants, and adds the coordinator's own
    /// quantity.
    #[must_use]
    pub fn of_figures(figures: &[FigureSpec]) -> Self {
        let quantity = |one: &FigureSpec| Quantity {
            key: one.key.clone(),
            name: one.words.clone(),
            measure: one.measure,
            style: one.style,
        };
        let mut ranked: Vec<_> = figures.iter().filter(|one| one.rank.is_some()).collect();
        ranked.sort_by_key(|one| one.rank);
        let (key, name) = (IMBALANCE.0.to_owned(), IMBALANCE.1.to_owned());
        let own = Quantity { key, name, measure: Measure::Itself, style: Style::Number };
        let driver = |one: &FigureSpec| Some((one.key.clone(), one.driven_by.clone()?));
        Self {
            of_interest: ranked.into_iter().map(quantity).chain([own]).collect(),
            others: figures.iter().filter(|one| one.rank.is_none()).map(quantity).collect(),
            drivers: figures.iter().filter_map(driver).collect(),
        }
    }

    /// Returns the quantity of a key. Any number of a summary can be a quantity.
    #[must_use]
    pub fn of(&self, key: &str) -> Quantity {
        let mut known = self.of_interest.iter().chain(&self.others);
        let name = || words(key.rsplit('.').next().unwrap_or(key));
        let other = || Quantity::new(key, &name(), Measure::Relative);
        known.find(|quantity| quantity.key == key).cloned().unwrap_or_else(other)
    }

    /// Returns the quantities of interest, followed by every other number in the participants'
    /// sections of a summary, and by the extremes over windows.
    #[must_use]
    pub fn all(&self, summary: &Summary) -> Vec<Quantity> {
        let mut keys = Vec::new();
        for (name, section) in summary.sections.as_object().into_iter().flatten() {
            numeric_keys(section, name, &mut keys);
        }
        if let Some(extremes) = &summary.extremes {
            numeric_keys(&extremes.clone().into(), "extremes", &mut keys);
        }
        let mut all = self.of_interest.clone();
        keys.retain(|key| all.iter().all(|known| known.key != *key));
        all.extend(keys.iter().map(|key| self.of(key)));
        all
    }

    /// Rank of a quantity: quantities of interest first, then other described ones, then the rest.
    #[must_use]
    pub fn place(&self, key: &str) -> usize {
        let mut known = self.of_interest.iter().chain(&self.others);
        known.position(|one| one.key == key).unwrap_or(usize::MAX)
    }

    /// Returns the quantity whose error carries over to `of`, if any.
    #[must_use]
    pub fn driver(&self, of: &Quantity) -> Option<Quantity> {
        let (_, driver) = self.drivers.iter().find(|(key, _)| *key == of.key)?;
        Some(self.of(driver))
    }
}

impl Quantity {
    /// Returns a quantity with this key and name, formatted as a number.
    #[must_use]
    pub fn new(key: &str, name: &str, measure: Measure) -> Self {
        Self { key: key.to_owned(), name: name.to_owned(), measure, style: Style::Number }
    }

    /// Unit suitable for values up to `largest` in magnitude.
    #[must_use]
    pub fn scale(&self, largest: f64) -> Scale {
        match self.style {
            Style::Percent => Scale { factor: 0.01, unit: "%".to_owned() },
            Style::Place => Scale { factor: 1e-3, unit: "mm".to_owned() },
            Style::Number | Style::Signed | Style::Count => of_key(&self.key, largest),
        }
    }

    /// Value of the quantity in a summary.
    #[must_use]
    pub fn value(&self, summary: &Summary) -> Option<f64> {
        summary.value(&self.key)
    }

    /// Change from the first value to the second, either relative to the first or absolute, as the
    /// measure demands. `None` if a ratio is needed and the first value is zero.
    #[must_use]
    pub fn change(&self, from: f64, to: f64) -> Option<f64> {
        let change = match self.measure {
            Measure::Relative if from == to => 0.0,
            // Compare magnitudes if the signs agree.
            Measure::Relative if from * to > 0.0 => to / from - 1.0,
            Measure::Relative => (to - from) / from.abs(),
            Measure::Absolute | Measure::Itself => to - from,
        };
        Some(change).filter(|change| change.is_finite())
    }

    /// Error of a value against a reference, as the measure demands; never negative.
    #[must_use]
    pub fn error(&self, value: f64, reference: f64) -> f64 {
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
        assert_eq!(show_change(Measure::Relative, 0.123), "+12 %");
        assert_eq!(show_change(Measure::Relative, -0.004), "−0.40 %");
        assert_eq!(show_change(Measure::Absolute, -0.2), "−0.20");
        assert_eq!(show_change(Measure::Relative, 0.0), "same");
    }

    #[test]
    fn figures_are_found_and_compared() {
        let sections = json!({"heat": {"max_rise_k": 220.0, "x_over_a": -0.8}});
        let summary = Summary::of_sections(sections);
        let figures = [
            FigureSpec::new("heat.x_over_a", "1", "place").rank(2).absolute(),
            FigureSpec::new("heat.max_rise_k", "K", "rise").rank(1).driven_by("contact.power_w"),
            FigureSpec::new("contact.power_w", "W", "power"),
        ];
        let known = Quantities::of_figures(&figures);
        let names: Vec<&str> = known.of_interest.iter().map(|one| one.name.as_str()).collect();
        assert_eq!(names, ["rise", "place", "heat imbalance"]);
        let [rise, place] = ["heat.max_rise_k", "heat.x_over_a"].map(|key| known.of(key));
        assert_eq!(rise.value(&summary), Some(220.0));
        assert!((rise.error(220.0, 200.0) - 0.1).abs() < 1e-15);
        assert!((place.error(-0.8, -0.83) - 0.03).abs() < 1e-15);
        assert_eq!(known.driver(&rise), Some(known.of("contact.power_w")));
        assert_eq!(known.driver(&place), None);
        let keys = ["wear.depth_m", "contact.power_w", "heat.x_over_a", "heat.max_rise_k"];
        assert_eq!(keys.map(|key| known.place(key)), [usize::MAX, 3, 1, 0]);
        assert_eq!(known.of("contact.creepage_xi").value(&summary), None);
        assert_eq!(known.of("coupling.energy_imbalance").error(-1e-9, 5.0), 1e-9);
        assert_eq!(rise.error(0.0, 0.0), 0.0);
        assert_eq!([rise.change(200.0, 250.0), rise.change(-200.0, -250.0)], [Some(0.25); 2]);
        assert_eq!([rise.change(-200.0, 50.0), rise.change(0.0, 1.0)], [Some(1.25), None]);
        assert_eq!(place.change(-0.8, -0.5), Some(-0.5 - -0.8));
        assert_eq!(known.of("wear.wear_depth_m").name, "wear depth m");
    }
}
