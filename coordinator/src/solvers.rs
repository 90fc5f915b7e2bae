//! `coordinator solvers`: the models and effects that the installed programs offer; docs/models.md is written from them.

use crate::output::print;
use contract::description::{Description, EffectSpec, KeySpec, ModelSpec};
use contract::text::json;
use run::error::RunError;
use std::fmt::Write as _;

/// What is asked for.
#[derive(clap::Args, Debug)]
pub(crate) struct Arguments {
    /// Print JSON: the descriptions, as the programs give them.
    #[arg(long, conflicts_with = "markdown")]
    json: bool,
    /// Print the page docs/models.md.
    #[arg(long)]
    markdown: bool,
}

/// Prints what the programs offer.
///
/// # Errors
/// It cannot be printed.
pub(crate) fn main(asked: &Arguments, described: &[Description]) -> Result<(), RunError> {
    print(&match (asked.json, asked.markdown) {
        (true, _) => json(&described),
        (_, true) => page(described),
        _ => described.iter().map(lines).collect(),
    })
}

/// The cases that a model answers.
fn modes(model: &ModelSpec) -> &'static str {
    match (model.steady, model.transient) {
        (true, true) => "steady, transient",
        (true, false) => "steady",
        _ => "transient",
    }
}

fn lines(of: &Description) -> String {
    let mut text = format!("{} {} (role {})\n", of.name, of.version, of.role);
    for model in &of.models {
        text += &format!("  model   {:16} {} [{}]\n", model.name, model.summary, modes(model));
        text += &format!("          {:16} source: {}\n", "", model.source);
    }
    for effect in &of.effects {
        text += &format!("  effect  {:16} {}\n", effect.name, effect.law);
        text += &format!("          {:16} models: {}\n", "", effect.models.join(", "));
        text += &format!("          {:16} source: {}\n", "", effect.source);
    }
    text
}

fn page(described: &[Description]) -> String {
    let mut text = "# Models and effects\n\nWhat the installed programs offer, as `coordinator solvers --markdown` writes it; `coordinator \
                    solvers` shows it in a terminal. A case chooses a model by `ROLE.model`, and names an effect by the table `[effects.NAME]`. What \
                    each effect is held against: [effects.md](effects.md); every key: [case.md](case.md).\n"
        .to_owned();
    for Description { role, models, .. } in described {
        let _ = write!(
            text,
            "\n## Models of role {role}\n\n| model | what | cases | keys of its own | source |\n| --- | --- | --- | --- | --- |\n"
        );
        for model in models {
            let ModelSpec { name, summary, source, keys, .. } = model;
            let cells = [summary.as_str(), modes(model), &named(keys), source].map(cell);
            let _ = writeln!(text, "| `{name}` | {} |", cells.join(" | "));
        }
    }
    for Description { role, effects, .. } in described.iter().filter(|of| !of.effects.is_empty()) {
        let _ = write!(
            text,
            "\n## Effects of role {role}\n\n| effect | law | models | keys | source |\n| --- | --- | --- | --- | --- |\n"
        );
        for EffectSpec { name, law, models, keys, source, .. } in effects {
            let cells = [law.as_str(), &models.join(", "), &named(keys), source].map(cell);
            let _ = writeln!(text, "| `{name}` | {} |", cells.join(" | "));
        }
    }
    text
}

/// Names of keys, as code.
fn named(keys: &[KeySpec]) -> String {
    let names: Vec<String> = keys.iter().map(|key| format!("`{}`", key.path)).collect();
    names.join(", ")
}

/// A text in a cell of a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}
