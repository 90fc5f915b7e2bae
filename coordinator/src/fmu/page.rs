//! The documentation inside an FMU: its variables, and what a step does.

use super::variables::{Variable, Variables};
use pages::html::escape;

/// A page about an FMU.
pub(super) fn text(name: &str, title: Option<&str>, variables: &Variables) -> String {
    let title = escape(title.unwrap_or(name));
    let row = |one: &Variable| {
        let limits = one
            .input
            .map(|(first, [least, most])| format!("{first} at first, from {least} to {most}"));
        format!(
            "<tr><td><code>{}</code></td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
            escape(&one.key),
            escape(&one.unit),
            escape(&one.words),
            limits.unwrap_or_default()
        )
    };
    let step = match variables.window {
        _ if variables.algebraic => "Outputs follow from the inputs by a surrogate, at any time. Outside of the limits of the inputs they are NaN, with a warning.".to_owned(),
        None => "Every step is a steady contact of its own, with the inputs that hold at its start; its length does not matter.".to_owned(),
        Some(window) => format!("Every step is one coupling window, with the inputs that hold at its start. The case has windows of {window} s; others are possible."),
    };
    let states = match variables.rewinds {
        true => "States can be kept and returned to.",
        false => "No state can be returned to.",
    };
    let source = match variables.algebraic {
        true => "The surrogate is resources/surrogate.json.",
        false => {
            "Outputs are NaN before the first step, and for what the models do not give. The case is resources/case.toml."
        }
    };
    let rows: String = variables.all().map(row).collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{title}</title></head><body>\n\
         <h1>{title}</h1>\n<p>{step} {states} {source}</p>\n<table>\n\
         <tr><th>variable</th><th>unit</th><th>what</th><th>input</th></tr>\n{rows}</table>\n</body></html>\n"
    )
}
