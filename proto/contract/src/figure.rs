//! Figures of a summary, as described by their participant: meaning, presentation, and the
//! reference of changes and errors.
//!
//! A key is the dotted path of a number in `summary.json`. In a key, `*` stands for the name of a
//! body, and a part `#` for the index in a list. Entries of a list are printed line by line.
//! Examples: `contact.max_pressure_pa`, `temperature.*.max_rise_k`, `contact.each_patch.#.y_m`.

pub mod contact;

use crate::plausible::Plausible;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Placeholder for the name of a body.
const BODY: char = '*';
/// Part of a key that stands for the index in a list.
pub const ENTRY: &str = "#";
/// Default number of significant digits.
const DIGITS: usize = 5;

/// One figure of the summary.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FigureSpec {
    /// Dotted path in `summary.json`.
    pub key: String,
    /// SI unit, "1" for a dimensionless number.
    pub unit: String,
    /// Meaning of the figure, in words. For a figure of a body, the name of the body is put in
    /// front.
    pub words: String,
    /// Line of the terminal on which the figure is printed; lines keep the order of the list.
    /// `None` if the figure is not printed. For entries of a list, the word for one entry.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub line: Option<String>,
    /// Name of the figure on its line; empty if the name of the line suffices.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub short: String,
    /// The figure is printed large in a report, and the following figures of its line small below
    /// it. In a list, the headline figure ranks the entries.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub headline: bool,
    /// Significant digits.
    #[serde(default = "digits")]
    pub digits: usize,
    /// Number format.
    #[serde(default)]
    pub style: Style,
    /// Condition under which the figure is omitted from its line.
    #[serde(default, skip_serializing_if = "Hidden::is_never")]
    pub hidden: Hidden,
    /// Reference of a change or an error.
    #[serde(default)]
    pub measure: Measure,
    /// Rank among the figures that studies compare, lowest first; figures of the upper body follow
    /// all others. `None` if the figure is compared only on request.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rank: Option<usize>,
    /// Key of a figure whose error also affects this one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub driven_by: Option<String>,
    /// Rule by which the coordinator derives the figure from other figures, also from those of
    /// other participants. The participant itself does not supply a derived figure.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub derived: Option<Derived>,
    /// Plausible range; values outside produce a warning.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plausible: Option<Plausible>,
    /// Dotted key of the case, with `*` for any name. A case that gives it sets the figure itself,
    /// so that the plausible range does not apply.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plausible_unless: Option<String>,
}

fn digits() -> usize {
    DIGITS
}

/// Number format of a figure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Style {
    /// Number with a unit prefix that suits its magnitude.
    #[default]
    Number,
    /// Percentage.
    Percent,
    /// Number with an explicit sign.
    Signed,
    /// Coordinate [m], printed in millimetres with three decimals.
    Place,
    /// Number of objects, which the short name denotes; printed if greater than one.
    Count,
}

/// Condition under which a figure is omitted from its line.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Hidden {
    /// Never omitted.
    #[default]
    Never,
    /// Omitted if zero.
    Zero,
    /// Omitted if below a millionth of the product of these figures, hence rounding.
    Below(Vec<String>),
    /// Omitted if this count is above one, because the figure describes a single object.
    Several(String),
}

impl Hidden {
    fn is_never(&self) -> bool {
        *self == Self::Never
    }

    fn keys(&self) -> &[String] {
        match self {
            Self::Never | Self::Zero => &[],
            Self::Below(keys) => keys,
            Self::Several(key) => std::slice::from_ref(key),
        }
    }
}

/// Reference of a change or an error of a figure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Measure {
    /// The value of the figure itself.
    #[default]
    Relative,
    /// None: the difference is used as it is, for places and ratios.
    Absolute,
    /// None: the value itself is an error and is not compared.
    Itself,
}

/// Rule by which the coordinator derives a figure from others.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Derived {
    /// A figure, or the magnitude of a vector of figures, divided by another figure.
    Ratio {
        /// Keys of the dividend. Figures after the first count as zero if absent.
        of: Vec<String>,
        /// Key of the divisor.
        over: String,
    },
    /// For an entry of a list: the value of the entry of another list, if this entry is the only
    /// one in its interval.
    Within {
        /// Key of the value, in the other list.
        of: String,
        /// Last parts of the keys of the interval's ends, in the other list.
        interval: [String; 2],
        /// Last part of the key of the place, in this list.
        place: String,
        /// Key of the number of entries; if fewer entries are listed, the figure is unknown.
        count: String,
    },
}

impl Derived {
    fn keys_mut(&mut self) -> Vec<&mut String> {
        match self {
            Self::Ratio { of, over } => of.iter_mut().chain([over]).collect(),
            Self::Within { of, count, .. } => vec![of, count],
        }
    }
}

impl FigureSpec {
    /// Returns a figure that is printed on no line.
    #[must_use]
    pub fn new(key: &str, unit: &str, words: &str) -> Self {
        Self {
            key: key.to_owned(),
            unit: unit.to_owned(),
            words: words.to_owned(),
            line: None,
            short: String::new(),
            headline: false,
            digits: DIGITS,
            style: Style::default(),
            hidden: Hidden::default(),
            measure: Measure::default(),
            rank: None,
            driven_by: None,
            derived: None,
            plausible: None,
            plausible_unless: None,
        }
    }

    /// Sets the largest plausible magnitude and its reason.
    #[must_use]
    pub fn expected_below(mut self, most: f64, why: &str) -> Self {
        self.plausible = Some(Plausible { least: None, most: Some(most), why: why.to_owned() });
        self
    }

    /// Sets the smallest plausible magnitude and its reason.
    #[must_use]
    pub fn expected_above(mut self, least: f64, why: &str) -> Self {
        self.plausible = Some(Plausible { least: Some(least), most: None, why: why.to_owned() });
        self
    }

    /// Lifts the plausible range in a case that gives this key.
    #[must_use]
    pub fn unless_given(mut self, key: &str) -> Self {
        self.plausible_unless = Some(key.to_owned());
        self
    }

    /// Prints the figure on this line, under this name.
    #[must_use]
    pub fn on(mut self, line: &str, short: &str) -> Self {
        (self.line, self.short) = (Some(line.to_owned()), short.to_owned());
        self
    }

    /// Makes the figure a headline.
    #[must_use]
    pub fn headline(mut self) -> Self {
        self.headline = true;
        self
    }

    /// Sets the number of significant digits.
    #[must_use]
    pub fn digits(mut self, digits: usize) -> Self {
        self.digits = digits;
        self
    }

    /// Sets the number format.
    #[must_use]
    pub fn style(mut self, style: Style) -> Self {
        self.style = style;
        self
    }

    /// Omits the figure if zero.
    #[must_use]
    pub fn unless_zero(mut self) -> Self {
        self.hidden = Hidden::Zero;
        self
    }

    /// Omits the figure if negligible against the product of these figures.
    #[must_use]
    pub fn unless_below(mut self, keys: &[&str]) -> Self {
        self.hidden = Hidden::Below(keys.iter().map(|key| (*key).to_owned()).collect());
        self
    }

    /// Omits the figure if this count is above one.
    #[must_use]
    pub fn unless_several(mut self, key: &str) -> Self {
        self.hidden = Hidden::Several(key.to_owned());
        self
    }

    /// Makes errors of the figure absolute.
    #[must_use]
    pub fn absolute(mut self) -> Self {
        self.measure = Measure::Absolute;
        self
    }

    /// Sets the rank among the figures that studies compare.
    #[must_use]
    pub fn rank(mut self, rank: usize) -> Self {
        self.rank = Some(rank);
        self
    }

    /// Declares that the error of another figure also affects this one.
    #[must_use]
    pub fn driven_by(mut self, key: &str) -> Self {
        self.driven_by = Some(key.to_owned());
        self
    }

    /// Derives the figure as the ratio of a figure, or the magnitude of a vector of figures, to
    /// another figure.
    #[must_use]
    pub fn ratio(mut self, of: &[&str], over: &str) -> Self {
        let of = of.iter().map(|key| (*key).to_owned()).collect();
        self.derived = Some(Derived::Ratio { of, over: over.to_owned() });
        self
    }

    /// Derives the figure from an entry of another list, see [`Derived::Within`].
    #[must_use]
    pub fn within(mut self, of: &str, interval: [&str; 2], place: &str, count: &str) -> Self {
        let [of, place, count] = [of, place, count].map(str::to_owned);
        let interval = interval.map(str::to_owned);
        self.derived = Some(Derived::Within { of, interval, place, count });
        self
    }

    /// Returns true if there is one such figure for each body.
    #[must_use]
    pub fn is_of_a_body(&self) -> bool {
        self.key.contains(BODY)
    }

    /// Returns true if there is one such figure for each entry of a list.
    #[must_use]
    pub fn is_of_a_list(&self) -> bool {
        is_of_a_list(&self.key)
    }

    /// Returns true if a participant supplies the figure, once per run.
    #[must_use]
    pub fn is_given(&self) -> bool {
        self.derived.is_none() && !self.is_of_a_list()
    }

    /// Returns the figure for the body of this name; a clone if the figure belongs to no body.
    #[must_use]
    pub fn of_body(&self, name: &str) -> Self {
        let mut own = self.clone();
        if self.is_of_a_body() {
            own.words = format!("{name} {}", self.words);
        }
        for text in own.texts() {
            *text = text.replace(BODY, name);
        }
        own
    }

    /// All texts in which the name of a body may stand.
    fn texts(&mut self) -> Vec<&mut String> {
        let hidden: Vec<&mut String> = match &mut self.hidden {
            Hidden::Never | Hidden::Zero => Vec::new(),
            Hidden::Below(keys) => keys.iter_mut().collect(),
            Hidden::Several(key) => vec![key],
        };
        let derived = self.derived.iter_mut().flat_map(Derived::keys_mut);
        let own = [&mut self.key, &mut self.short].into_iter();
        own.chain(&mut self.line).chain(&mut self.driven_by).chain(hidden).chain(derived).collect()
    }

    /// Checks a figure received from another process.
    ///
    /// # Errors
    /// Fails for a key that is not a dotted path of plain words, an invalid unit, a number of
    /// digits outside 1 to 17, a place that is not a length, a line without a name, and an
    /// inconsistent rule of derivation.
    pub fn check(&self) -> Result<(), String> {
        let key = &self.key;
        let wrong = |what: String| Err(format!("figure `{key}` {what}"));
        let others = self.hidden.keys().iter().chain(&self.driven_by);
        for path in others.chain([key]) {
            if !is_path(path) {
                return Err(format!("`{path}` is no dotted key of a figure in a section"));
            }
        }
        if self.unit.is_empty() || self.unit.len() > 15 || !self.unit.is_ascii() {
            return wrong(format!("has the unit {:?}", self.unit));
        }
        if !(1..=17).contains(&self.digits) {
            return wrong(format!("has {} digits", self.digits));
        }
        if self.style == Style::Place && self.unit != "m" {
            return wrong(format!("is a place in {}", self.unit));
        }
        if self.line.as_ref().is_some_and(|line| line.trim().is_empty()) {
            return wrong("stands on a line without a name".to_owned());
        }
        match &self.derived {
            Some(Derived::Ratio { of, .. }) if of.is_empty() || self.is_of_a_list() => {
                wrong("is the ratio of nothing, or in a list".to_owned())
            }
            Some(Derived::Within { of, .. }) if !(is_of_a_list(of) && self.is_of_a_list()) => {
                wrong("is within an interval, but not in a list".to_owned())
            }
            _ => Ok(()),
        }
    }
}

fn is_of_a_list(key: &str) -> bool {
    key.split('.').any(|part| part == ENTRY)
}

/// Returns true for at least a section and a name in it.
fn is_path(key: &str) -> bool {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-' || c == BODY;
    let mut parts = key.split('.');
    let is_part = |part: &str| part == ENTRY || !part.is_empty() && part.chars().all(plain);
    parts.clone().count() > 1 && parts.all(is_part)
}

/// Returns the value under a dotted key of a summary.
#[must_use]
pub fn value(summary: &Value, key: &str) -> Option<f64> {
    key.split('.').try_fold(summary, |inner, part| inner.get(part))?.as_f64()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_figure_of_a_body_has_its_name_wherever_a_person_looks() {
        let place = FigureSpec::new("heat.*.x_over_a", "1", "place of the largest rise")
            .on("*", "at x/a")
            .ratio(&["heat.*.x_m"], "contact.semi_axis_a_m");
        let own = place.of_body("disc");
        assert_eq!(own.key, "heat.disc.x_over_a");
        assert_eq!(own.words, "disc place of the largest rise");
        assert_eq!(own.line.as_deref(), Some("disc"));
        let over = "contact.semi_axis_a_m".to_owned();
        assert_eq!(
            own.derived,
            Some(Derived::Ratio { of: vec!["heat.disc.x_m".to_owned()], over })
        );
        let power = FigureSpec::new("contact.power_w", "W", "power");
        assert_eq!(power.of_body("disc"), power);
    }

    #[test]
    fn what_makes_no_sense_is_refused() {
        let of = |key: &str, unit: &str| FigureSpec::new(key, unit, "a figure");
        let within =
            |key, from| of(key, "K").within(from, ["from_m", "to_m"], "y_m", "contact.patches");
        let good = [
            of("contact.power_w", "W"),
            of("heat.*.max_rise_k", "K").style(Style::Signed),
            within("contact.each.#.*_rise_k", "heat.*.each.#.rise_k"),
        ];
        assert!(good.iter().all(|figure| figure.check() == Ok(())));
        let wrong = [
            of("power", "W"),
            of("contact..power", "W"),
            of("contact.power w", "W"),
            of("contact.power", ""),
            of("contact.power", "W").digits(0),
            of("contact.power", "W").style(Style::Place),
            of("contact.power", "W").on("", "P"),
            of("contact.power", "W").ratio(&[], "contact.load"),
            within("contact.power", "heat.each.#.rise_k"),
            of("contact.power", "W").driven_by("load"),
        ];
        for figure in wrong {
            assert!(figure.check().is_err(), "{figure:?}");
        }
    }

    #[test]
    fn what_is_not_given_travels_not() {
        let figure = FigureSpec::new("contact.power_w", "W", "power");
        let text = json!({
            "key": "contact.power_w", "unit": "W", "words": "power", "digits": 5, "style": "number",
            "measure": "relative",
        });
        assert_eq!(serde_json::to_value(&figure).unwrap(), text);
        let least = json!({"key": "contact.power_w", "unit": "W", "words": "power"});
        assert_eq!(serde_json::from_value::<FigureSpec>(least).unwrap(), figure);
    }

    #[test]
    fn a_value_is_found_by_its_key() {
        let summary = json!({"contact": {"patches": 3, "each": [1.0]}});
        assert_eq!(value(&summary, "contact.patches"), Some(3.0));
        assert_eq!(value(&summary, "contact.each"), None);
        assert_eq!(value(&summary, "heat.rise"), None);
    }
}
