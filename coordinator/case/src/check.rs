//! Check of one value against its key: type, unit, range and words. Also builds an acceptable
//! example value for messages.

use super::known::KnownKey;
use super::schema::Shape;
use super::tree::{Node, Origin, Value, quoted};
use contract::description::{KeyKind, KeySpec};
use contract::quantity::{QuantityError, parse_difference, parse_quantity};
use contract::suggest::{any_of, nearest};
use contract::text::check_line;
use serde_json::{Number, Value as Json};
use std::path::{Path, absolute};

/// Reason for refusing a value, and its fix.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Fault {
    pub(super) reason: String,
    pub(super) fix: String,
}

/// Returns the SI value of a node, or its fault. Relative files of the case start at `folder`,
/// those of options at the working directory.
pub(super) fn check(known: &KnownKey<'_>, node: &Node, folder: &Path) -> Result<Json, Fault> {
    match (known.shape, &node.value) {
        (Shape::List, Value::List(items)) if items.is_empty() => {
            let wanted = example(&known.spec, known.shape);
            Err(Fault { reason: "the list is empty".to_owned(), fix: format!("write {wanted}") })
        }
        (Shape::List | Shape::OneOrList, Value::List(items)) => {
            items.iter().map(|item| one(&known.spec, item, folder)).collect()
        }
        (Shape::List, value) => Err(mismatch(value, "a list", &known.spec, known.shape)),
        _ => one(&known.spec, node, folder),
    }
}

fn one(spec: &KeySpec, node: &Node, folder: &Path) -> Result<Json, Fault> {
    let expect = |what: &str| Err(mismatch(&node.value, what, spec, Shape::One));
    if let Value::Text(text) = &node.value {
        let fix = "write one line of plain text".to_owned();
        check_line("the text", text).map_err(|reason| Fault { reason, fix })?;
    }
    match (&spec.kind, &node.value) {
        (KeyKind::Quantity { unit }, Value::Number { value, .. }) => within(spec, *value, unit),
        (KeyKind::Quantity { unit }, Value::Text(text)) => {
            let parse = if spec.difference { parse_difference } else { parse_quantity };
            let value = parse(text, unit).map_err(|error| {
                let fix = match &error {
                    QuantityError::Difference(text) => {
                        format!("write \"{}\"", in_kelvin(text))
                    }
                    QuantityError::DecimalComma(text) => {
                        format!("write \"{}\"", text.replacen(',', ".", 1))
                    }
                    _ => format!("write {}", wanted(spec, unit)),
                };
                Fault { reason: error.to_string(), fix }
            })?;
            within(spec, value, unit)
        }
        (KeyKind::Integer, Value::Number { whole: Some(whole), .. }) => {
            within(spec, *whole as f64, "").map(|_| Json::from(*whole))
        }
        (KeyKind::Flag, Value::Flag(flag)) => Ok(Json::from(*flag)),
        (KeyKind::Choice { of }, Value::Text(word)) => choice(spec, of, word),
        (KeyKind::Text | KeyKind::NameIn { .. }, Value::Text(text)) => {
            Ok(Json::from(text.as_str()))
        }
        (KeyKind::File, Value::Text(name)) => match node.origin {
            Origin::Argument(_) => file(Path::new(name)),
            Origin::File { .. } => file(&folder.join(name)),
        },
        (KeyKind::Quantity { unit }, _) if unit == "1" => expect("a number"),
        (KeyKind::Quantity { unit }, _) => expect(&format!("a number or a text in {unit}")),
        (KeyKind::Integer, _) => expect("a whole number"),
        (KeyKind::Flag, _) => expect("true or false"),
        (KeyKind::Choice { .. } | KeyKind::NameIn { .. }, _) => expect("a word"),
        (KeyKind::Text, _) => expect("a text"),
        (KeyKind::File, _) => expect("the name of a file"),
    }
}

/// Rewrites a temperature difference in °C as a difference in K.
fn in_kelvin(text: &str) -> String {
    let number = text.trim_end_matches(['°', 'C']).trim_end_matches("deg").trim_end();
    format!("{number} K")
}

/// Returns the absolute path of an existing file.
fn file(path: &Path) -> Result<Json, Fault> {
    let shown = path.display();
    if !path.is_file() {
        let reason = format!("there is no file `{shown}`");
        let fix = "name a file; a relative path starts at the case file's folder, or, in an \
                   option, at the working directory";
        return Err(Fault { reason, fix: fix.to_owned() });
    }
    let path = absolute(path).ok().and_then(|path| path.to_str().map(Json::from));
    path.ok_or_else(|| Fault {
        reason: format!("the path of `{shown}` is not UTF-8"),
        fix: "move the file to a folder whose name is UTF-8".to_owned(),
    })
}

fn mismatch(value: &Value, what: &str, spec: &KeySpec, shape: Shape) -> Fault {
    let reason = format!("is {}, not {what}", value.describe());
    let fix = match (&spec.kind, value) {
        // The intended value is clear; only its quotes are missing.
        (
            KeyKind::Text | KeyKind::File,
            Value::Number { written: text, .. } | Value::Date(text),
        ) if shape == Shape::One => {
            format!("write \"{text}\", with quotes")
        }
        (KeyKind::Quantity { unit }, _) => format!("write {}", wanted(spec, unit)),
        (KeyKind::Choice { of }, _) => format!("write {}", words(of)),
        _ => format!("write for example {}", example(spec, shape)),
    };
    Fault { reason, fix }
}

/// Describes the values that a quantity accepts, with an example.
fn wanted(spec: &KeySpec, unit: &str) -> String {
    let example = example(spec, Shape::One);
    if unit == "1" {
        return format!("a number, for example {example}");
    }
    format!("a number in {unit} or a text with a unit, for example {example}")
}

fn within(spec: &KeySpec, value: f64, unit: &str) -> Result<Json, Fault> {
    let number = Number::from_f64(value);
    match number {
        Some(number) if in_range(spec, value) => Ok(Json::Number(number)),
        Some(_) => Err(Fault {
            reason: format!("{} is not {}", with_unit(value, unit), range(spec, unit)),
            fix: format!(
                "write a value that is {}, for example {}",
                range(spec, unit),
                sample(spec)
            ),
        }),
        None => Err(Fault {
            reason: format!("{value} is not a finite number"),
            fix: format!("write for example {}", sample(spec)),
        }),
    }
}

fn sample(spec: &KeySpec) -> String {
    example(spec, Shape::One)
}

fn choice(spec: &KeySpec, of: &[String], word: &str) -> Result<Json, Fault> {
    if of.iter().any(|known| known == word) {
        return Ok(Json::from(word));
    }
    let reason = unknown_word(&spec.path, word, of.iter().map(String::as_str));
    Err(Fault { reason, fix: format!("write {}", words(of)) })
}

/// Lists words as they stand in TOML: "\"a\", \"b\" or \"c\"".
pub(super) fn words<S: AsRef<str>>(of: &[S]) -> String {
    any_of(&of.iter().map(|word| quoted(word.as_ref())).collect::<Vec<_>>())
}

/// Builds "unknown material `steeel`; did you mean `steel`?". The noun is the last part of the key.
pub(super) fn unknown_word<'a>(
    key: &str,
    word: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> String {
    let noun = key.rsplit('.').next().unwrap_or(key);
    let near = nearest(word, candidates);
    let hint = near.map(|near| format!("; did you mean `{near}`?")).unwrap_or_default();
    format!("unknown {noun} `{word}`{hint}")
}

/// Familiar magnitudes by unit. A key gets the first one that lies within its expected range.
const FAMILIAR: &[(&str, &str)] = &[
    ("m", "0.5 m"),
    ("m", "0.1 mm"),
    ("N", "100 kN"),
    ("N", "1 kN"),
    ("Pa", "200 GPa"),
    ("Pa", "500 MPa"),
    ("W/(m K)", "50 W/(m K)"),
    ("J/(kg K)", "450 J/(kg K)"),
    ("1/K", "1.2e-5 1/K"),
    ("N m", "100 N m"),
    ("m2", "1e-4 m2"),
    ("kg", "1000 kg"),
    ("N/m", "1e6 N/m"),
    ("N s/m", "2500 N s/m"),
    ("A", "100 A"),
    ("K/s", "100 K/s"),
    ("m3/J", "1e-14 m3/J"),
    ("V m/A", "2e-7 V m/A"),
    ("W/(m2 K)", "20 W/(m2 K)"),
    ("Pa s", "0.1 Pa s"),
    ("m/Pa", "1e-15 m/Pa"),
    ("s/m", "0.01 s/m"),
    ("m/s", "30 m/s"),
    ("s", "1 ms"),
    ("kg/m3", "7850 kg/m3"),
    ("kg/m^3", "7850 kg/m^3"),
    ("K", "300 K"),
    ("B", "64 MB"),
];

/// Returns whether the number is within the range of the key.
pub(super) fn in_range(spec: &KeySpec, number: f64) -> bool {
    number.is_finite()
        && spec.above.is_none_or(|bound| number > bound)
        && spec.at_least.is_none_or(|bound| number >= bound)
        && spec.at_most.is_none_or(|bound| number <= bound)
}

/// Describes the range with its unit, as "above 0 m"; empty for an unlimited range.
pub(super) fn range(spec: &KeySpec, unit: &str) -> String {
    let word = |name: &str, bound: Option<f64>| {
        bound.map(|bound| format!("{name} {}", with_unit(bound, unit)))
    };
    let words =
        [word("above", spec.above), word("at least", spec.at_least), word("at most", spec.at_most)];
    words.into_iter().flatten().collect::<Vec<_>>().join(" and ")
}

/// Formats a number with its unit for messages.
pub(super) fn with_unit(number: f64, unit: &str) -> String {
    let magnitude = number.abs();
    let plain = magnitude == 0.0 || (1e-4..1e7).contains(&magnitude);
    let digits = if plain { number.to_string() } else { format!("{number:e}") };
    if unit == "1" || unit.is_empty() { digits } else { format!("{digits} {unit}") }
}

/// Returns an acceptable value of the key, in TOML.
pub(super) fn example(spec: &KeySpec, shape: Shape) -> String {
    let one = match &spec.kind {
        KeyKind::Quantity { unit } => quantity(spec, unit),
        KeyKind::Integer => number(spec, &[40.0, 1.0]).to_string(),
        KeyKind::Flag => "true".to_owned(),
        KeyKind::Choice { of } => quoted(of.first().map_or("", String::as_str)),
        KeyKind::Text | KeyKind::NameIn { .. } => "\"NAME\"".to_owned(),
        KeyKind::File => "\"FILE\"".to_owned(),
    };
    if shape == Shape::List { format!("[{one}]") } else { one }
}

fn quantity(spec: &KeySpec, unit: &str) -> String {
    let familiar = FAMILIAR.iter().filter(|(of, _)| *of == unit).map(|(_, text)| *text);
    let allowed = |value| in_range(spec, value);
    let expected = |value| spec.plausible.as_ref().is_none_or(|p| p.bound_passed(value).is_none());
    let find = |fits: &dyn Fn(f64) -> bool| {
        let fits = |text: &&str| parse_quantity(text, unit).is_ok_and(fits);
        familiar.clone().find(fits)
    };
    let found = find(&|value| allowed(value) && expected(value)).or_else(|| find(&allowed));
    if let Some(text) = found {
        return quoted(text);
    }
    // Usual numbers: Poisson's ratio of metals, and a coefficient of friction.
    let text = with_unit(number(spec, &[0.3, 1.0]), unit);
    if unit == "1" { text } else { quoted(&text) }
}

/// Returns a number within the range: a usual one, or one derived from the bounds.
fn number(spec: &KeySpec, usual: &[f64]) -> f64 {
    let low = spec.above.or(spec.at_least);
    let middle = low.zip(spec.at_most).map(|(low, high)| f64::midpoint(low, high));
    let made = [middle, spec.at_least, spec.at_most, spec.above.map(|bound| bound + 1.0)];
    let mut candidates = usual.iter().copied().chain(made.into_iter().flatten());
    candidates.find(|candidate| in_range(spec, *candidate)).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_familiar_magnitude_is_one() {
        for (unit, text) in FAMILIAR {
            assert!(parse_quantity(text, unit).is_ok(), "{text} in {unit}");
        }
    }

    #[test]
    fn examples_lie_in_the_range() {
        let of = |spec: KeySpec| example(&spec, Shape::One);
        assert_eq!(of(KeySpec::quantity("a", "N", "").above(0.0)), "\"100 kN\"");
        assert_eq!(of(KeySpec::quantity("a", "N", "").at_most(-1.0)), "\"-1 N\"");
        assert_eq!(of(KeySpec::quantity("a", "J/(kg K)", "")), "\"450 J/(kg K)\"");
        assert_eq!(of(KeySpec::quantity("a", "m", "").expected(0.0..=1e-3, "small")), "\"0.1 mm\"");
        assert_eq!(of(KeySpec::quantity("a", "m", "").expected(9.0..=9.0, "large")), "\"0.5 m\"");
        assert_eq!(of(KeySpec::quantity("a", "rad", "")), "\"0.3 rad\"");
        assert_eq!(of(KeySpec::number("a", "").above(2.0).at_most(3.0)), "2.5");
        assert_eq!(of(KeySpec::integer("a", "").at_most(9.0)), "1");
        assert_eq!(of(KeySpec::choice("a", &["x", "y"], "")), "\"x\"");
        assert_eq!(example(&KeySpec::text("a", ""), Shape::List), "[\"NAME\"]");
    }

    #[test]
    fn ranges_read_well() {
        let spec = KeySpec::quantity("a", "Pa", "").above(0.0).at_most(2.1e11);
        assert_eq!(range(&spec, "Pa"), "above 0 Pa and at most 2.1e11 Pa");
    }
}
