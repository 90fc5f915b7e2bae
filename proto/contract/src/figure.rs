//! The figures of a summary, as the participant that gives them describes them: what they are, how a
//! person reads them, and what a change of them is measured against.
//!
//! A key is the dotted path of a number in `summary.json`. In it `*` stands for the name of a body of the
//! case, and a part `#` for the place in a list, whose entries a person reads line by line:
//! `contact.max_pressure_pa`, `temperature.*.max_rise_k`, `contact.each_patch.#.y_m`.

pub mod contact;

use crate::plausible::Plausible;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Stands for the name of a body.
const BODY: char = '*';
/// The part of a key that stands for the place in a list.
pub const ENTRY: &str = "#";
/// Significant digits of a figure that asks for no other number of them.
const DIGITS: usize = 5;

/// One figure of the summary.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FigureSpec {
    /// Dotted path in `summary.json`.
    pub key: String,
    /// Its SI unit, "1" for a plain number.
    pub unit: String,
    /// What it is, in words. The name of the body goes before those of a figure of a body.
    pub words: String,
    /// The line of the terminal that it stands on, in the order of the list; absent for one that stands on
    /// none. For entries of a list the word for one of them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub line: Option<String>,
    /// Its name on the line; empty for one that the line itself names.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub short: String,
    /// It stands large in a report, and what follows on its line small below it. In a list it says which
    /// entries matter most.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub headline: bool,
    /// Significant digits.
    #[serde(default = "digits")]
    pub digits: usize,
    /// How it is written.
    #[serde(default)]
    pub style: Style,
    /// When it is left out of its line.
    #[serde(default, skip_serializing_if = "Hidden::is_never")]
    pub hidden: Hidden,
    /// What a change or an error is measured against.
    #[serde(default)]
    pub measure: Measure,
    /// Its place among the figures that studies compare, the least first; those of the upper body come after
    /// all others. Absent for one that is compared only when it is named.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rank: Option<usize>,
    /// Key of a figure whose error is an error of this one, too.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub driven_by: Option<String>,
    /// How the coordinator makes it of other figures, those of other participants among them. The
    /// participant itself does not give it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub derived: Option<Derived>,
    /// What is expected of it; what is otherwise is told.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plausible: Option<Plausible>,
}

fn digits() -> usize {
    DIGITS
}

/// How a figure is written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Style {
    /// With a unit that suits its size.
    #[default]
    Number,
    /// In per cent.
    Percent,
    /// With its sign, whether positive or negative.
    Signed,
    /// A coordinate [m]: in millimetres, to three decimals.
    Place,
    /// A number of things, each of which is what its short name says; shown where there are several.
    Count,
}

/// When a figure is left out of its line.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Hidden {
    /// Never.
    #[default]
    Never,
    /// Where it is zero.
    Zero,
    /// Where it is below a millionth of the product of these figures: rounding.
    Below(Vec<String>),
    /// Where this count is above one: there are several of what it is about.
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

/// What a change or an error of a figure is measured against.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Measure {
    /// Relative to its own value.
    #[default]
    Relative,
    /// As it is: a place, or what is a ratio already.
    Absolute,
    /// Its value is an error itself; nothing is compared.
    Itself,
}

/// A figure that the coordinator makes of others.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Derived {
    /// A figure, or the length of the vector of several, over another one.
    Ratio {
        /// What is divided. Of several figures those after the first may be absent, and are zero then.
        of: Vec<String>,
        /// What it is divided by.
        over: String,
    },
    /// For an entry of a list: the value of the entry of another list within whose interval it lies alone.
    Within {
        /// Key of the value, in the other list.
        of: String,
        /// Last parts of the keys of the ends of the interval, in the other list.
        interval: [String; 2],
        /// Last part of the key of the place, in the list.
        place: String,
        /// Key of the number of entries: where fewer are listed, nothing is known.
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
    /// A figure that stands on no line.
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
        }
    }

    /// Expected up to this magnitude, and why.
    #[must_use]
    pub fn expected_below(mut self, most: f64, why: &str) -> Self {
        self.plausible = Some(Plausible { least: None, most: Some(most), why: why.to_owned() });
        self
    }

    /// Less is told, as beyond what is expected for a reason.
    #[must_use]
    pub fn expected_above(mut self, least: f64, why: &str) -> Self {
        self.plausible = Some(Plausible { least: Some(least), most: None, why: why.to_owned() });
        self
    }

    /// On this line, under this name.
    #[must_use]
    pub fn on(mut self, line: &str, short: &str) -> Self {
        (self.line, self.short) = (Some(line.to_owned()), short.to_owned());
        self
    }

    /// One that matters most.
    #[must_use]
    pub fn headline(mut self) -> Self {
        self.headline = true;
        self
    }

    /// To so many significant digits.
    #[must_use]
    pub fn digits(mut self, digits: usize) -> Self {
        self.digits = digits;
        self
    }

    /// Written in this way.
    #[must_use]
    pub fn style(mut self, style: Style) -> Self {
        self.style = style;
        self
    }

    /// Left out where it is zero.
    #[must_use]
    pub fn unless_zero(mut self) -> Self {
        self.hidden = Hidden::Zero;
        self
    }

    /// Left out where it is rounding against the product of these figures.
    #[must_use]
    pub fn unless_below(mut self, keys: &[&str]) -> Self {
        self.hidden = Hidden::Below(keys.iter().map(|key| (*key).to_owned()).collect());
        self
    }

    /// Left out where this count is above one.
    #[must_use]
    pub fn unless_several(mut self, key: &str) -> Self {
        self.hidden = Hidden::Several(key.to_owned());
        self
    }

    /// Its errors are absolute.
    #[must_use]
    pub fn absolute(mut self) -> Self {
        self.measure = Measure::Absolute;
        self
    }

    /// Compared by studies, in this place.
    #[must_use]
    pub fn rank(mut self, rank: usize) -> Self {
        self.rank = Some(rank);
        self
    }

    /// No better known than this figure.
    #[must_use]
    pub fn driven_by(mut self, key: &str) -> Self {
        self.driven_by = Some(key.to_owned());
        self
    }

    /// A figure, or the length of a vector, over another figure.
    #[must_use]
    pub fn ratio(mut self, of: &[&str], over: &str) -> Self {
        let of = of.iter().map(|key| (*key).to_owned()).collect();
        self.derived = Some(Derived::Ratio { of, over: over.to_owned() });
        self
    }

    /// The value of that entry of another list within whose interval an entry lies alone.
    #[must_use]
    pub fn within(mut self, of: &str, interval: [&str; 2], place: &str, count: &str) -> Self {
        let [of, place, count] = [of, place, count].map(str::to_owned);
        let interval = interval.map(str::to_owned);
        self.derived = Some(Derived::Within { of, interval, place, count });
        self
    }

    /// There is one for each body.
    #[must_use]
    pub fn is_of_a_body(&self) -> bool {
        self.key.contains(BODY)
    }

    /// There is one for each entry of a list.
    #[must_use]
    pub fn is_of_a_list(&self) -> bool {
        is_of_a_list(&self.key)
    }

    /// A participant gives it, once.
    #[must_use]
    pub fn is_given(&self) -> bool {
        self.derived.is_none() && !self.is_of_a_list()
    }

    /// The figure of the body of this name; itself, if it is of no body.
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

    /// Everything in which a body's name may stand.
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

    /// What is wrong with a figure that came from outside.
    ///
    /// # Errors
    /// A key that is no dotted path of plain words, a unit that cannot be one, a number without digits, a
    /// place that is no length, or one that is made of others as it cannot be.
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

/// At least a section and a name in it.
fn is_path(key: &str) -> bool {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-' || c == BODY;
    let mut parts = key.split('.');
    let is_part = |part: &str| part == ENTRY || !part.is_empty() && part.chars().all(plain);
    parts.clone().count() > 1 && parts.all(is_part)
}

/// The value under a dotted key of a summary.
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
