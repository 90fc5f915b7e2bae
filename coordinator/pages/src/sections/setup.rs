//! Sections about the setup of a run: warnings, effects, the plan, versions, the case, and the log.

use crate::page::{Block, Section};
use crate::source::Results;
use crate::table::Table;
use run::format::{Scale, counted};
use run::plan_file::{EffectPlan, PlanFile};
use run::warnings::Warning;

/// Warnings about implausible values and figures.
pub(super) fn warnings(results: &Results) -> Option<Section> {
    let blocks =
        results.warnings().iter().map(|warning| Block::Text(warning.to_string())).collect();
    Section::of("Warnings", blocks)
}

/// Active and inactive effects, and the plan as printed.
pub(super) fn plan(results: &Results) -> Option<Section> {
    let PlanFile { effects, text, .. } = results.plan.as_ref()?;
    let (on, off): (Vec<&EffectPlan>, Vec<&EffectPlan>) =
        effects.iter().partition(|effect| effect.active);
    let what = |effect: &EffectPlan| format!("{}; {}", effect.reason, effect.law);
    let mut blocks = Vec::new();
    if !on.is_empty() {
        let switch = |effect: &&EffectPlan| (effect.name.clone(), what(effect));
        blocks.push(Block::Effects(on.iter().map(switch).collect()));
    }
    if !off.is_empty() {
        let mut table = Table::new(["effect", "law"], 9);
        off.iter().for_each(|effect| table.row([effect.name.clone(), effect.law.clone()]));
        let title = format!(
            "{} off, because the case does not name them",
            counted(off.len() as u64, "effect")
        );
        blocks.push(Block::Folded(title, table));
    }
    let title = "Planned scheme, processes, fields and bytes".to_owned();
    blocks.push(Block::Verbatim(title, text.trim_end().to_owned()));
    Section::of("Plan", blocks)
}

/// Programs and versions.
pub(super) fn versions(results: &Results) -> Option<Section> {
    let plan = results.plan.as_ref()?;
    let mut table = Table::new(["role", "program", "version", "remark"], 9);
    let (own, protocol) = ("coordinator".to_owned(), format!("protocol {}", plan.protocol));
    table.row([own.clone(), own, plan.coordinator.clone(), protocol]);
    for one in &plan.participants {
        let model = format!("model {}", one.model);
        table.row([one.role.clone(), one.program.clone(), one.version.clone(), model]);
    }
    Section::of("Versions", vec![Block::Table(table)])
}

pub(super) fn case(results: &Results) -> Option<Section> {
    let blocks = match results.case.trim_end() {
        "" => Vec::new(),
        text => vec![Block::Verbatim("case.toml".to_owned(), text.to_owned())],
    };
    Section::of("Case as run", blocks)
}

/// Recordings, warnings, errors and unreadable files.
pub(super) fn log(results: &Results) -> Option<Section> {
    let mut blocks = Vec::new();
    for (name, bytes) in &results.recordings {
        let size = Scale::of("byte", *bytes as f64).show(*bytes as f64, 3);
        blocks.push(Block::Text(format!(
            "{name} ({size}) holds all exchanged data; read it with coordinator inspect, replay or \
             export."
        )));
    }
    let mut table = Table::new(["level", "source", "message"], 9);
    let told: Vec<String> = results.warnings().iter().map(Warning::to_string).collect();
    for event in results.log.iter().filter(|[.., message]| !told.contains(message)) {
        table.row(event.clone());
    }
    if !table.rows.is_empty() {
        blocks.push(Block::Table(table));
    }
    blocks.extend(results.troubles.iter().map(|trouble| Block::Text(trouble.clone())));
    Section::of("Recordings, warnings and errors", blocks)
}
