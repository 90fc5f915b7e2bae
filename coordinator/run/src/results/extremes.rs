//! The section `extremes` of the summary: smallest and largest values over several windows.

use contract::figure::value;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

/// Smallest and largest values over several windows, or over the rows of a sequence.
///
/// In the file the values stand under `smallest` and `largest`, below the keys of their figures.
/// `places` holds the windows in which they occur.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "Value", from = "Value")]
pub struct Extremes {
    /// Whether the windows are rows of a sequence, each a contact of its own.
    pub rows: bool,
    /// Number of windows with an answer.
    pub windows: u64,
    /// Figures whose values differ between windows.
    pub figures: Vec<FigureRange>,
}

/// Smallest and largest value of a figure.
#[derive(Clone, Debug, PartialEq)]
pub struct FigureRange {
    /// Dotted key of the figure.
    pub key: String,
    /// Smallest value.
    pub least: WindowValue,
    /// Largest value.
    pub most: WindowValue,
}

/// Value of a figure in a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowValue {
    /// Value in the unit of the figure.
    pub value: f64,
    /// Number of the window, from 0; or of the row, from 1, as in the table of a sequence.
    pub window: u64,
    /// End of the window \[s\].
    pub end: f64,
}

impl Extremes {
    /// Returns the word for a window.
    #[must_use]
    pub fn word(&self) -> &'static str {
        if self.rows { "row" } else { "window" }
    }

    /// Returns the range of a figure.
    #[must_use]
    pub fn of(&self, key: &str) -> Option<&FigureRange> {
        self.figures.iter().find(|figure| figure.key == key)
    }
}

impl From<Extremes> for Value {
    fn from(extremes: Extremes) -> Self {
        let word = extremes.word();
        let (mut smallest, mut largest, mut places) = (Map::new(), Map::new(), Vec::new());
        for FigureRange { key, least, most } in &extremes.figures {
            put(&mut smallest, key, least.value);
            put(&mut largest, key, most.value);
            let mut place = json!({"key": key});
            for (name, bound) in [("smallest", least), ("largest", most)] {
                place[format!("{name}_{word}")] = bound.window.into();
                place[format!("{name}_s")] = bound.end.into();
            }
            places.push(place);
        }
        json!({
            format!("{word}s"): extremes.windows,
            "smallest": smallest,
            "largest": largest,
            "places": places,
        })
    }
}

/// Reads the section. Incomplete figures are left out.
impl From<Value> for Extremes {
    fn from(section: Value) -> Self {
        let rows = section.get("rows").is_some();
        let word = if rows { "row" } else { "window" };
        let places = section["places"].as_array().map_or(&[][..], Vec::as_slice);
        let figure = |place: &Value| {
            let key = place.get("key")?.as_str()?;
            let bound = |name: &str| {
                let window = place.get(format!("{name}_{word}"))?.as_u64()?;
                let end = place.get(format!("{name}_s"))?.as_f64()?;
                Some(WindowValue { value: value(section.get(name)?, key)?, window, end })
            };
            let (least, most) = (bound("smallest")?, bound("largest")?);
            Some(FigureRange { key: key.to_owned(), least, most })
        };
        let figures = places.iter().filter_map(figure).collect();
        let windows = section[format!("{word}s")].as_u64().unwrap_or(0);
        Self { rows, windows, figures }
    }
}

/// Inserts a number under a dotted key.
fn put(into: &mut Map<String, Value>, key: &str, value: f64) {
    match key.split_once('.') {
        Some((section, rest)) => {
            let inner = into.entry(section).or_insert_with(|| Value::Object(Map::new()));
            if let Value::Object(inner) = inner {
                put(inner, rest, value);
            }
        }
        None => drop(into.insert(key.to_owned(), value.into())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_section_gives_its_extremes_back() {
        let at = |value, window, end| WindowValue { value, window, end };
        let figure = |key: &str, least, most| FigureRange { key: key.to_owned(), least, most };
        for rows in [false, true] {
            let figures = vec![
                figure("heat.rise_k", at(30.0, 1, 0.0), at(73.8, 2, 0.5)),
                figure("heat.depth_m", at(1e-4, 2, 0.5), at(2e-4, 1, 0.0)),
            ];
            let extremes = Extremes { rows, windows: 3, figures };
            let section = Value::from(extremes.clone());
            assert_eq!(section["largest"]["heat"]["rise_k"], 73.8);
            assert_eq!(section[if rows { "rows" } else { "windows" }], 3);
            assert_eq!(Extremes::from(section), extremes);
        }
        assert_eq!(Extremes::from(json!({"places": [{"key": "a.b"}]})).figures, []);
    }
}
