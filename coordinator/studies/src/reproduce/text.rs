//! Text with figures in it: templates in the language of Jinja.
//!
//! | in a template | is |
//! |---|---|
//! | `value(run, key)` | a figure of a run's summary |
//! | `input(run, key)` | a number of its case |
//! | `table(id)`, `figure(id)` | a table, a figure, in Markdown |
//! | `x \| digits(4)` | a number to so many significant digits |
//! | `x \| fixed(1)` | and to so many decimals |
//! | `x \| per(1e6)`, `x \| under(1.0)` | a number over another, and another over it |
//!
//! What is not there is an error, never an empty text; in cells of tables, where a figure may be
//! absent, a filter writes a dash for it.

use super::values::Values;
use minijinja::{Environment, Error, ErrorKind, UndefinedBehavior, Value};
use run::error::RunError;
use run::format::number;
use std::collections::BTreeMap;
use std::sync::Arc;

/// What stands for a figure that is absent.
pub(super) const ABSENT: &str = "–";

/// Drawings and tables by their names, in Markdown.
#[derive(Clone, Debug, Default)]
pub(super) struct Parts {
    /// Tables.
    pub(super) tables: BTreeMap<String, String>,
    /// Figures.
    pub(super) figures: BTreeMap<String, String>,
}

/// Fills the template `text`, which is called `name`.
///
/// # Errors
/// [`RunError::Usage`] with the template's name and line.
pub(super) fn page(
    name: &str,
    text: &str,
    values: &Arc<Values>,
    parts: Parts,
) -> Result<String, RunError> {
    let mut templates = templates();
    let figures = Arc::clone(values);
    templates.add_function("value", move |run: String, key: String| {
        figures.get(&run, &key).map_err(wrong)
    });
    let inputs = Arc::clone(values);
    templates.add_function("input", move |run: String, key: String| {
        inputs.input(&run, &key).map_err(wrong)
    });
    let Parts { tables, figures } = parts;
    templates.add_function("table", move |id: String| part("table", &tables, &id));
    templates.add_function("figure", move |id: String| part("figure", &figures, &id));
    templates.render_named_str(name, text, Value::UNDEFINED).map_err(|error| refusal(&error))
}

/// Fills the cell of a table.
///
/// # Errors
/// [`RunError::Usage`] with `place` and the reason.
pub(super) fn cell(
    place: &str,
    text: &str,
    run: Option<String>,
    printed: &[String],
    values: &Arc<Values>,
) -> Result<String, RunError> {
    let mut templates = templates();
    let values = Arc::clone(values);
    templates.add_function("get", move |key: String| match &run {
        Some(run) => Value::from(values.find(run, &key)),
        None => Value::from(()),
    });
    let context = Value::from_pairs([("printed", Value::from(printed.to_vec()))]);
    templates.render_named_str(place, text, context).map_err(|error| refusal(&error))
}

fn templates() -> Environment<'static> {
    let mut templates = Environment::new();
    templates.set_undefined_behavior(UndefinedBehavior::Strict);
    templates.add_filter("digits", |value: Value, digits: usize| {
        shown(&value, |value| number(value, digits))
    });
    templates.add_filter("fixed", |value: Value, decimals: usize| {
        shown(&value, |value| format!("{value:.decimals$}").replace('-', "−"))
    });
    templates.add_filter("per", |value: Value, unit: f64| over(&value, |value| value / unit));
    templates.add_filter("under", |value: Value, whole: f64| over(&value, |value| whole / value));
    templates
}

/// A figure that is computed from another, where there is one.
fn over(value: &Value, of: impl Fn(f64) -> f64) -> Result<Option<f64>, Error> {
    if value.is_none() {
        return Ok(None);
    }
    f64::try_from(value.clone()).map(|value| Some(of(value)))
}

fn shown(value: &Value, write: impl Fn(f64) -> String) -> Result<String, Error> {
    if value.is_none() {
        return Ok(ABSENT.to_owned());
    }
    f64::try_from(value.clone()).map(write)
}

fn part(what: &str, all: &BTreeMap<String, String>, id: &str) -> Result<String, Error> {
    all.get(id).cloned().ok_or_else(|| {
        let known: Vec<&str> = all.keys().map(String::as_str).collect();
        wrong(format!("there is no {what} `{id}`; there is {}", known.join(", ")))
    })
}

fn wrong(reason: String) -> Error {
    Error::new(ErrorKind::InvalidOperation, reason)
}

fn refusal(error: &Error) -> RunError {
    let place = match (error.name(), error.line()) {
        (Some(name), Some(line)) => format!("{name}:{line}"),
        (name, _) => name.unwrap_or("text").to_owned(),
    };
    let reason = error.detail().map_or_else(|| error.kind().to_string(), str::to_owned);
    RunError::Usage(format!("{place}: {reason}"))
}
