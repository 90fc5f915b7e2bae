//! The summary as a person reads it.

mod contact;
mod numbers;

use crate::format::{bytes, counted, number, seconds};
use numbers::{rise, with_unit};
use serde_json::Value;
use std::fmt::Write as _;

/// The lines printed at the end of a run. What the summary does not have is left out.
#[must_use]
pub fn text(summary: &Value, title: Option<&str>) -> String {
    let of = |pointer: &str| summary.pointer(pointer).and_then(Value::as_f64);
    let word = |pointer: &str| summary.pointer(pointer).and_then(Value::as_str).unwrap_or("");
    let mut out = word("/case").to_owned();
    if let Some(title) = title {
        let _ = write!(out, " · {title}");
    }
    let _ = writeln!(out, "\n  {}: {}", word("/status"), word("/reason"));
    line(&mut out, "contact", &contact::extent(summary));
    for (head, entries) in contact::patches(summary) {
        line(&mut out, &head, &entries);
    }
    line(&mut out, "friction", &contact::friction(summary));
    for body in ["rail", "wheel"] {
        let at = |key: &str| of(&format!("/temperature/{body}/{key}"));
        line(
            &mut out,
            body,
            &[
                at("max_rise_k").map(rise),
                at("x_over_a").map(|v| format!("at x/a {v:.4}")),
                at("y_m").map(|v| format!("y {:.3} mm", v * 1e3)),
                at("penetration_depth_m").map(|v| format!("1/e at depth {}", with_unit(v, "m", 3))),
            ],
        );
    }
    line(
        &mut out,
        "coupling",
        &[
            Some(word("/coupling/scheme").to_owned()).filter(|scheme| !scheme.is_empty()),
            Some(word("/coupling/acceleration").to_owned())
                .filter(|word| !word.is_empty() && word != "none"),
            of("/coupling/windows").map(|v| counted(v as u64, "window")),
            of("/coupling/iterations").map(|v| counted(v as u64, "iteration")),
            of("/coupling/final_residual").map(|v| format!("residual {v:.1e}")),
            of("/coupling/energy_imbalance").map(imbalance),
        ],
    );
    line(&mut out, "accuracy", &accuracy(summary));
    line(&mut out, "cost", &cost(summary));
    out
}

fn imbalance(value: f64) -> String {
    if value == 0.0 {
        "heat balance exact".to_owned()
    } else {
        format!("heat imbalance {value:.1e}")
    }
}

/// What a run with a target of accuracy states of its error.
fn accuracy(summary: &Value) -> Vec<Option<String>> {
    let Some(section) = summary.get("accuracy") else { return Vec::new() };
    let of = |key: &str| section.get(key).and_then(Value::as_f64);
    let percent = |key: &str| of(key).map(|error| format!("{} %", number(100.0 * error, 2)));
    let word = |key: &str| section.get(key).and_then(Value::as_str).map(str::to_owned);
    let value = of("value").map(|value| number(value, 5)).unwrap_or_default();
    vec![
        word("quantity").map(|key| format!("{key} {value}")),
        percent("estimated_error").map(|error| format!("± {error}")),
        percent("target").map(|error| format!("of {error} asked for")),
        percent("grid_error").map(|error| format!("grid {error}")),
        percent("model_error").map(|error| format!("models {error}")),
        of("extrapolated").map(|value| format!("extrapolated {}", number(value, 5))),
        word("models"),
    ]
}

fn cost(summary: &Value) -> Vec<Option<String>> {
    let section = summary.get("cost").and_then(Value::as_object);
    let entries = section.into_iter().flatten().filter_map(|(key, value)| {
        let value = value.as_f64()?;
        let name = key.strip_suffix("_s")?;
        Some(Some(format!("{name} {}", seconds(value))))
    });
    let exchanged = summary.pointer("/cost/bytes_exchanged").and_then(Value::as_u64);
    entries.chain([exchanged.map(|v| format!("{} exchanged", bytes(v)))]).collect()
}

fn line(out: &mut String, head: &str, entries: &[Option<String>]) {
    let there: Vec<&str> = entries.iter().flatten().map(String::as_str).collect();
    if !there.is_empty() {
        let _ = writeln!(out, "  {head:9} {}", there.join("   "));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_absent_leaves_no_trace() {
        let summary = serde_json::json!({
            "case": "c", "status": "completed", "reason": "done",
            "temperature": {"rail": {"max_rise_k": 298.2, "x_over_a": -0.829}},
            "cost": {"wall_s": 0.12, "bytes_exchanged": 64},
        });
        let text = text(&summary, None);
        let expected = "c\n  completed: done\n  rail      +298.20 K   at x/a -0.8290\n  \
                        cost      wall 120.000 ms   64 B exchanged\n";
        assert_eq!(text, expected);
    }
}
