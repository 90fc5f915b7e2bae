//! A survey as a person reads it.

use super::range::Range;
use super::survey::{Details, FieldSurvey, Survey};
use contract::text::one_line;
use run::format::{bytes, counted, seconds};
use std::fmt::Write as _;
use std::path::Path;

/// The whole recording on a page.
#[must_use]
pub fn text(survey: &Survey, path: &Path) -> String {
    let mut out = format!("{} · {}\n", survey.case, path.display());
    let state = match &survey.damage {
        _ if survey.complete => "complete",
        Some(_) => "DAMAGED: what precedes the damage",
        None => "TRUNCATED: it has no end",
    };
    let _ = writeln!(
        out,
        "  recording     {}, {state}, {} of run time, by {}",
        bytes(survey.bytes),
        seconds(survey.duration_s),
        survey.writer
    );
    match &survey.error {
        Some(error) => {
            let _ = writeln!(out, "  the run       FAILED: {}", one_line(error));
        }
        None if survey.complete => out += "  the run       completed\n",
        None => {}
    }
    participants(&mut out, survey);
    coupling(&mut out, survey);
    if !survey.fields.is_empty() {
        fields(&mut out, survey);
    }
    out
}

fn participants(out: &mut String, survey: &Survey) {
    for (n, one) in survey.participants.iter().enumerate() {
        let title = if n == 0 { "participants" } else { "" };
        let states = match one.states {
            0 => String::new(),
            n => format!(", {}", counted(n, "state")),
        };
        let model = if one.model.is_empty() { "?".into() } else { one_line(&one.model) };
        let _ = writeln!(
            out,
            "  {title:13} {:10} {model:14} {} in {}{states}, by {}",
            one.role,
            counted(one.solves, "solve"),
            seconds(one.model_s),
            one.program
        );
    }
}

fn coupling(out: &mut String, survey: &Survey) {
    let acceleration = match survey.acceleration.as_str() {
        "none" => String::new(),
        word => format!(", {word}"),
    };
    let repeated = match survey.repeated_windows {
        0 => String::new(),
        n => format!(", {n} solved again"),
    };
    let _ = writeln!(
        out,
        "  coupling      {}{acceleration}: {}{repeated} up to {} s, {}, at most {} in a window, {} \
         beside the models",
        survey.scheme,
        counted(survey.windows, "window"),
        survey.end_s,
        counted(survey.iterations, "iteration"),
        survey.max_iterations_in_window,
        seconds(survey.coupling_s)
    );
    for (field, residual) in &survey.final_residuals {
        let _ = writeln!(
            out,
            "  residual      {} {residual:.3e} in the last iteration",
            one_line(&shown(survey, field))
        );
    }
    if let Some(imbalance) = survey.energy_imbalance {
        let _ =
            writeln!(out, "  energy        sent and received differ by at most {imbalance:.1e}");
    }
}

/// A topic or a field as the case names it: `thermal/rail_temperature` for `thermal/lower_temperature`.
fn shown(survey: &Survey, topic: &str) -> String {
    let (path, name) = match topic.rfind('/') {
        Some(slash) => topic.split_at(slash + 1),
        None => ("", topic),
    };
    let name = survey.bodies.as_ref().map_or_else(|| name.to_owned(), |bodies| bodies.shown(name));
    format!("{path}{name}")
}

fn fields(out: &mut String, survey: &Survey) {
    let fields = &survey.fields;
    let short =
        |field: &FieldSurvey| shown(survey, &field.topic).trim_start_matches("field/").to_owned();
    let wide = fields.iter().map(|f| short(f).len()).max().unwrap_or(0).max(5);
    let _ = writeln!(
        out,
        "\n  {:wide$} {:>6} {:>9} {:>8} {:>10} {:>12} {:>12} {:>12}",
        "field", "unit", "values", "samples", "bytes", "min", "mean", "max"
    );
    for field in fields {
        let Range { min, max, mean, first_non_finite } = field.range.without_rounding();
        let _ = writeln!(
            out,
            "  {:wide$} {:>6} {:>9} {:>8} {:>10} {} {} {}",
            short(field),
            field.unit,
            field.values,
            field.samples,
            bytes(field.bytes),
            number(min),
            number(mean),
            number(max)
        );
        if let (Some(index), Some((window, iteration))) = (first_non_finite, field.non_finite_at) {
            let _ = writeln!(
                out,
                "  {:wide$} NOT FINITE: index {index} in window {window}, iteration {iteration}",
                ""
            );
        }
    }
}

/// Iterations and samples one by one.
#[must_use]
pub fn details_text(survey: &Survey, details: &Details, fields_only: bool) -> String {
    let mut out = String::new();
    if !fields_only && !details.iterations.is_empty() {
        let _ = writeln!(
            out,
            "\n  {:>7} {:>9} {:>12} {:>10} {:>7} {:>11} {:>14} {:>14}",
            "window",
            "iteration",
            "residual",
            "relaxation",
            "columns",
            "beside",
            "sent [W]",
            "received [W]"
        );
        for one in &details.iterations {
            let columns = one.columns.map_or_else(|| "-".to_owned(), |n| n.to_string());
            let relaxation = one.relaxation.map_or_else(|| "-".to_owned(), |w| format!("{w:.4}"));
            let _ = writeln!(
                out,
                "  {:>7} {:>9} {} {relaxation:>10} {columns:>7} {:>11} {:>14} {:>14}",
                one.window,
                one.iteration,
                number(one.residual),
                seconds(one.coupling_seconds),
                number(one.heat_sent),
                number(one.heat_received)
            );
        }
    }
    if details.samples.is_empty() {
        out += "\n  the recording has no such sample\n";
        return out;
    }
    let topics: Vec<_> = details.samples.iter().map(|one| shown(survey, &one.topic)).collect();
    let wide = topics.iter().map(String::len).max().unwrap_or(0).max(5);
    let _ = writeln!(
        out,
        "\n  {:wide$} {:>7} {:>9} {:>8} {:>12} {:>12} {:>12} {:>12}",
        "topic", "window", "iteration", "sample", "at [s]", "min", "mean", "max"
    );
    for (one, topic) in details.samples.iter().zip(&topics) {
        let range = one.range.without_rounding();
        let bad = range
            .first_non_finite
            .map_or_else(String::new, |index| format!("  NOT FINITE at index {index}"));
        let _ = writeln!(
            out,
            "  {topic:wide$} {:>7} {:>9} {:>8} {:>12.6} {} {} {}{bad}",
            one.window,
            one.iteration,
            one.sequence,
            one.at_s,
            number(range.min),
            number(range.mean),
            number(range.max)
        );
    }
    out
}

fn number(value: Option<f64>) -> String {
    value.map_or_else(|| format!("{:>12}", "-"), |value| format!("{value:>12.4e}"))
}
