//! What ran: effects, plan, versions, the case, and what the processes complained of.

use crate::report::page::{Block, Section};
use crate::report::source::Results;
use crate::report::table::Table;
use run::format::Scale;
use run::plan_file::{law, parts};
use serde_json::Value;

/// Effects on and off, and the plan as it was printed.
pub(super) fn plan(results: &Results) -> Option<Section> {
    let (text, _) = parts(&results.plan);
    let mut blocks = Vec::new();
    let effects = effects(results, text);
    if !effects.is_empty() {
        blocks.push(Block::Switches(effects));
    }
    if !text.is_empty() {
        let title = "Scheme, processes, fields and bytes as planned".to_owned();
        blocks.push(Block::Verbatim(title, text.trim_end().to_owned()));
    }
    Section::of("Plan", blocks)
}

fn effects(results: &Results, plan: &str) -> Vec<(String, bool, String)> {
    let mut all = Vec::new();
    for (list, on) in [("active", true), ("inactive", false)] {
        let names = results.summary.pointer(&format!("/effects/{list}")).and_then(Value::as_array);
        for name in names.into_iter().flatten().filter_map(Value::as_str) {
            let why = if on { "named in the case" } else { "not named in the case" };
            let what = law(plan, name).map_or(why.to_owned(), |law| format!("{why}; {law}"));
            all.push((name.to_owned(), on, what));
        }
    }
    all
}

/// Programs and versions.
pub(super) fn versions(results: &Results) -> Option<Section> {
    let (_, rows) = parts(&results.plan);
    let mut table = Table::new(["role", "program", "version", "remark"], 9);
    rows.iter().for_each(|row| table.row(row.map(str::to_owned)));
    (!table.rows.is_empty()).then(|| Section::of("Versions", vec![Block::Table(table)]))?
}

/// The case as it was run.
pub(super) fn case(results: &Results) -> Option<Section> {
    let blocks = match results.case.trim_end() {
        "" => Vec::new(),
        text => vec![Block::Verbatim("case.toml".to_owned(), text.to_owned())],
    };
    Section::of("Case as run", blocks)
}

/// Recordings, warnings and errors, and what could not be read.
pub(super) fn log(results: &Results) -> Option<Section> {
    let mut blocks = Vec::new();
    for (name, bytes) in &results.recordings {
        let size = Scale::of("byte", *bytes as f64).show(*bytes as f64, 3);
        blocks.push(Block::Text(format!(
            "{name} ({size}) holds every exchange: coordinator inspect, replay and export read it."
        )));
    }
    let mut table = Table::new(["level", "who", "message"], 9);
    for event in &results.log {
        table.row(event.clone());
    }
    if !table.rows.is_empty() {
        blocks.push(Block::Table(table));
    }
    blocks.extend(results.troubles.iter().map(|trouble| Block::Text(trouble.clone())));
    Section::of("Recordings, warnings and errors", blocks)
}
