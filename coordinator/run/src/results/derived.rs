//! Figures that the coordinator derives from others, according to their descriptions.

use contract::figure::{Derived, ENTRY, FigureSpec, value};
use serde_json::{Map, Value};

/// Adds the derived figures to the sections of a summary. Existing entries stay.
pub fn complete(sections: &mut Map<String, Value>, figures: &[FigureSpec]) {
    let mut all = Value::Object(std::mem::take(sections));
    for FigureSpec { key, derived, .. } in figures {
        match derived {
            Some(Derived::Ratio { of, over }) => {
                let parts = of.iter().map(|key| value(&all, key));
                if let Some(ratio) = ratio(parts, value(&all, over)) {
                    insert(&mut all, key, ratio.into());
                }
            }
            Some(Derived::Within { of, interval, place, count }) => {
                within(&mut all, key, (of, interval), (place, count));
            }
            None => {}
        }
    }
    if let Value::Object(all) = all {
        *sections = all;
    }
}

/// Returns the ratio of a figure, or of the length of the vector of several figures, to another
/// figure. Returns `None` if a figure is missing or the ratio is not finite.
pub(super) fn ratio(
    mut parts: impl Iterator<Item = Option<f64>>,
    over: Option<f64>,
) -> Option<f64> {
    let first = parts.next()??;
    let size = parts.fold(first, |length, part| length.hypot(part.unwrap_or(0.0)));
    Some(size / over?).filter(|ratio| ratio.is_finite())
}

/// Copies a value from the entries of one list into the entries of another. An entry receives the
/// value of the interval in which it lies, if no other entry lies there. Does nothing if the list
/// is incomplete.
fn within(
    all: &mut Value,
    key: &str,
    (of, [from, to]): (&str, &[String; 2]),
    (place, count): (&str, &str),
) {
    let list_and_name = |key: &str| {
        let (list, name) = key.split_once(&format!(".{ENTRY}."))?;
        Some((format!("/{}", list.replace('.', "/")), name.to_owned()))
    };
    let (Some((list, name)), Some((other, taken))) = (list_and_name(key), list_and_name(of)) else {
        return;
    };
    let number = |of: &Value, key: &str| of.get(key).and_then(Value::as_f64);
    let others = all.pointer(&other).and_then(Value::as_array).cloned().unwrap_or_default();
    let count = value(all, count);
    let Some(entries) = all.pointer_mut(&list).and_then(Value::as_array_mut) else { return };
    if count != Some(entries.len() as f64) {
        return;
    }
    for interval in &others {
        let ends = (number(interval, from), number(interval, to));
        let ((Some(from), Some(to)), Some(value)) = (ends, interval.get(&taken)) else { continue };
        let inside =
            |entry: &&mut Value| number(entry, place).is_some_and(|at| (from..=to).contains(&at));
        let mut held: Vec<&mut Value> = entries.iter_mut().filter(inside).collect();
        if let [Value::Object(entry)] = &mut held[..] {
            entry.entry(&name).or_insert_with(|| value.clone());
        }
    }
}

/// Inserts a value under a dotted key, if its section exists.
fn insert(all: &mut Value, key: &str, value: Value) {
    let Some((section, name)) = key.rsplit_once('.') else { return };
    let inner = all.pointer_mut(&format!("/{}", section.replace('.', "/")));
    if let Some(Value::Object(inner)) = inner {
        inner.entry(name).or_insert(value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn completed(sections: Value, figures: &[FigureSpec]) -> Value {
        let Value::Object(mut sections) = sections else { unreachable!("an object") };
        complete(&mut sections, figures);
        Value::Object(sections)
    }

    #[test]
    fn a_place_is_scaled_and_a_vector_has_a_length() {
        let figure = |key: &str| FigureSpec::new(key, "1", "a ratio");
        let place = figure("heat.*.x_over_a").ratio(&["heat.*.x_m"], "contact.a_m");
        let force = figure("contact.ratio").ratio(&["contact.x_n", "contact.y_n"], "contact.n_n");
        let figures = [place.of_body("disc"), place.of_body("pin"), force];
        let contact = json!({"a_m": 0.008, "x_n": 3.0, "y_n": -4.0, "n_n": 10.0, "ratio": 0.5});
        let all = completed(
            json!({
                "contact": {"a_m": 0.008, "x_n": 3.0, "y_n": -4.0, "n_n": 10.0},
                "heat": {"disc": {"x_m": -0.004}, "pin": {}},
            }),
            &figures,
        );
        let heat = json!({"disc": {"x_m": -0.004, "x_over_a": -0.5}, "pin": {}});
        assert_eq!(all, json!({"contact": contact, "heat": heat}));
        let nowhere = json!({"contact": {"a_m": 0.0}, "heat": {"disc": {"x_m": 1.0}}});
        assert_eq!(completed(nowhere.clone(), &figures), nowhere);
    }

    #[test]
    fn an_entry_has_the_value_of_the_interval_that_it_is_alone_in() {
        let figure = FigureSpec::new("contact.each.#.disc_rise_k", "K", "rise").within(
            "heat.disc.each.#.rise_k",
            ["from_m", "to_m"],
            "y_m",
            "contact.count",
        );
        let strip =
            |from: f64, to: f64, rise: f64| json!({"from_m": from, "to_m": to, "rise_k": rise});
        let of = |count: u32| {
            let sections = json!({
                "contact": {"count": count, "each": [{"y_m": -2.0}, {"y_m": 1.0}, {"y_m": 1.2}]},
                "heat": {"disc": {"each": [strip(-3.0, -1.0, 5.0), strip(0.5, 2.0, 7.0)]}},
            });
            completed(sections, std::slice::from_ref(&figure))["contact"]["each"].clone()
        };
        let known = json!([{"y_m": -2.0, "disc_rise_k": 5.0}, {"y_m": 1.0}, {"y_m": 1.2}]);
        assert_eq!(of(3), known);
        assert_eq!(of(4), json!([{"y_m": -2.0}, {"y_m": 1.0}, {"y_m": 1.2}]));
    }
}
