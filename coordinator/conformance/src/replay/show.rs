//! How a replay went, for a person.

use super::compare::Difference;
use super::request::{Replay, Request};
use contract::text::one_line;
use run::format::{counted, seconds};
use std::fmt::Write as _;

/// A few lines: what was driven, what was compared, where it first differs and how that grows.
#[must_use]
pub(crate) fn text(replay: &Replay, request: &Request) -> String {
    let mut out = format!(
        "replay of {} by {} from {}\n",
        replay.role,
        one_line(&replay.program),
        request.recording.display()
    );
    if replay.program != replay.recorded_program {
        let _ = writeln!(out, "  recorded was {}", one_line(&replay.recorded_program));
    }
    for remark in &replay.remarks {
        let _ = writeln!(out, "  {}", one_line(remark));
    }
    let compared = &replay.comparison;
    let _ = writeln!(
        out,
        "  windows {} to {}: {}, {} of {} compared{}",
        replay.from_window,
        replay.last_window,
        counted(replay.solves, "solve"),
        counted(compared.samples, "sample"),
        counted(compared.values, "value"),
        if replay.cut { "; the recording is truncated here" } else { "" }
    );
    let verdict = match (compared.differs(), request.tolerance) {
        (false, _) if compared.samples == 0 => "  nothing to compare".to_owned(),
        (false, None) => "  bit-identical".to_owned(),
        (false, Some(tolerance)) => format!(
            "  within {tolerance:e} of the recording except for {}, by {:.2e} at most",
            counted(compared.unequal_samples, "sample"),
            compared.largest
        ),
        (true, _) if compared.first.is_none() => "  DIFFERS, though not in its fields".to_owned(),
        (true, _) => format!("  DIFFERS in {}", counted(compared.different_samples, "sample")),
    };
    let _ = writeln!(out, "{verdict}");
    if let Some(first) = &compared.first {
        let _ = writeln!(out, "  first     {}", difference(first));
        let growth: Vec<String> = thinned(replay).collect();
        let _ = writeln!(out, "  growth    {}", growth.join("\n            "));
    }
    if let Some(other) = &compared.other {
        let word = if compared.first.is_some() { "also" } else { "what" };
        let _ = writeln!(out, "  {word}      {}", one_line(other));
    }
    if let Some(damage) = &replay.damage {
        let _ =
            writeln!(out, "  the recording cannot be read beyond this point: {}", one_line(damage));
    }
    let _ = writeln!(
        out,
        "  time      {} in the model, {} when recorded; {} in all",
        seconds(replay.model_s),
        seconds(replay.recorded_model_s),
        seconds(replay.wall_s)
    );
    out
}

/// The first difference in a line.
#[must_use]
pub(crate) fn difference(first: &Difference) -> String {
    format!(
        "window {}, iteration {}: {}[{}] is {:e} {unit}, recorded {:e} {unit} (off by \
         {:.3e} of the largest)",
        first.window,
        first.iteration,
        first.field,
        first.index,
        first.now,
        first.recorded,
        first.relative,
        unit = first.unit
    )
}

/// At most eight steps of the growth, the last among them.
fn thinned(replay: &Replay) -> impl Iterator<Item = String> + '_ {
    let steps = &replay.comparison.growth.steps;
    let stride = steps.len().div_ceil(8).max(1);
    let last = steps.len().saturating_sub(1);
    let chosen = move |(n, _): &(usize, _)| n.is_multiple_of(stride) || *n == last;
    steps.iter().enumerate().filter(chosen).map(|(_, step)| {
        format!("window {}, iteration {}: {:.3e}", step.window, step.iteration, step.relative)
    })
}
