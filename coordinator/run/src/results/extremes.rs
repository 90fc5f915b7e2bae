//! The extremes of a run of several windows: section `extremes` of the summary.
//!
//! The other figures of a summary are those of the last window. Of a sequence of steady contacts that is
//! one contact of many, so the smallest and the largest value over all windows stand beside it, with the
//! windows in which they occur.

use contract::figure::FigureSpec;
use serde_json::{Map, Value, json};

/// The smallest and the largest values of some columns of the history.
#[derive(Clone, Debug, PartialEq)]
pub struct Extremes {
    columns: Vec<Column>,
    /// Windows with an answer.
    windows: u64,
}

#[derive(Clone, Debug, PartialEq)]
struct Column {
    key: String,
    /// Index of the column in a row.
    at: usize,
    /// The smallest and the largest value.
    bounds: Option<[Bound; 2]>,
}

/// A value, and the window in which it occurs.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Bound {
    value: f64,
    window: f64,
    end: f64,
}

impl Extremes {
    /// Extremes of the headline figures, in a table with this header.
    #[must_use]
    pub(super) fn of(head: &[String], figures: &[FigureSpec]) -> Self {
        let large = figures.iter().filter(|figure| figure.headline && !figure.is_of_a_list());
        let column = |figure: &FigureSpec| {
            let at = head.iter().position(|name| *name == figure.key)?;
            Some(Column { key: figure.key.clone(), at, bounds: None })
        };
        Self { columns: large.filter_map(column).collect(), windows: 0 }
    }

    /// Takes a row, whose first cells are the number of its window, its start and its end.
    pub(super) fn add(&mut self, cells: &[&str]) {
        let number = |at: usize| cells.get(at)?.parse::<f64>().ok();
        let (Some(window), Some(end)) = (number(0), number(2)) else { return };
        let mut answered = false;
        for Column { at, bounds, .. } in &mut self.columns {
            let Some(value) = number(*at) else { continue };
            answered = true;
            let own = Bound { value, window, end };
            let [least, most] = bounds.get_or_insert([own; 2]);
            if value < least.value {
                *least = own;
            }
            if value > most.value {
                *most = own;
            }
        }
        self.windows += u64::from(answered);
    }

    /// The section of the summary; `None` if there is one window, or nothing has changed. Rows count from
    /// one, as those of the table of a sequence.
    #[must_use]
    pub(super) fn section(&self, rows: bool) -> Option<Value> {
        let changed = self.columns.iter().filter_map(|column| {
            let [least, most] = column.bounds?;
            (least.value < most.value).then_some((&column.key, least, most))
        });
        let changed: Vec<_> = changed.collect();
        if self.windows < 2 || changed.is_empty() {
            return None;
        }
        let word = if rows { "row" } else { "window" };
        let (mut smallest, mut largest, mut places) = (Map::new(), Map::new(), Vec::new());
        for (key, least, most) in changed {
            put(&mut smallest, key, least.value);
            put(&mut largest, key, most.value);
            let mut place = json!({"key": key});
            for (name, bound) in [("smallest", least), ("largest", most)] {
                place[format!("{name}_{word}")] = (bound.window as u64 + u64::from(rows)).into();
                place[format!("{name}_s")] = bound.end.into();
            }
            places.push(place);
        }
        let count = if rows { "rows" } else { "windows" };
        Some(json!({
            count: self.windows,
            "smallest": smallest,
            "largest": largest,
            "places": places,
        }))
    }
}

/// Puts a number under a dotted key.
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
