//! One value against one key: type, unit, range and words.

use super::example::{example, in_range, range, with_unit};
use super::known::Known;
use super::schema::Shape;
use super::tree::{Node, Origin, Value};
use contract::description::{KeyKind, KeySpec};
use contract::quantity::{QuantityError, parse_difference, parse_quantity};
use contract::suggest::{any_of, nearest};
use contract::text::check_line;
use serde_json::{Number, Value as Json};
use std::path::{Path, absolute};

/// Why a value cannot be, and what to write.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Fault {
    pub(super) reason: String,
    pub(super) fix: String,
}

/// The SI value of a node, or what is wrong with it. Files of the case are meant from `folder`, those
/// of options from where the program runs.
pub(super) fn check(known: &Known<'_>, node: &Node, folder: &Path) -> Result<Json, Fault> {
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

/// A difference of temperatures in °C as one in K.
fn in_kelvin(text: &str) -> String {
    let number = text.trim_end_matches(['°', 'C']).trim_end_matches("deg").trim_end();
    format!("{number} K")
}

/// The absolute path of a file that exists.
fn file(path: &Path) -> Result<Json, Fault> {
    let shown = path.display();
    if !path.is_file() {
        let reason = format!("there is no file `{shown}`");
        let fix = "name a file; a relative name is meant from the case file's folder, in an option \
                   from the working directory";
        return Err(Fault { reason, fix: fix.to_owned() });
    }
    let path = absolute(path).ok().and_then(|path| path.to_str().map(Json::from));
    path.ok_or_else(|| Fault {
        reason: format!("the path of `{shown}` is not plain text"),
        fix: "move the file to a folder whose name is UTF-8".to_owned(),
    })
}

fn mismatch(value: &Value, what: &str, spec: &KeySpec, shape: Shape) -> Fault {
    let reason = format!("is {}, not {what}", value.describe());
    let fix = match (&spec.kind, value) {
        // What was meant is plain; it only lacks its quotes.
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

/// What a quantity can be, with an example.
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

/// "\"a\", \"b\" or \"c\"", as they stand in TOML.
pub(super) fn words<S: AsRef<str>>(of: &[S]) -> String {
    any_of(&of.iter().map(|word| super::quote::quoted(word.as_ref())).collect::<Vec<_>>())
}

/// "unknown material `steeel`; did you mean `steel`?"; the noun is the last part of the key.
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
