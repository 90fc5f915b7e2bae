//! `coordinator solvers`: the models and effects that the installed programs offer; docs/models.md is written from them.

use crate::installed::installed;
use console::command::{Command, Context, Group};
use console::output::print;
use contract::description::{Description, EffectSpec, KeySpec, ModelSpec};
use contract::text::json;
use run::error::RunError;
use std::fmt::Write as _;

/// What is asked for.
#[derive(clap::Args, Debug)]
pub(crate) struct SolversCommand {
    /// Print JSON: the descriptions, as the programs give them.
    #[arg(long, conflicts_with = "markdown")]
    json: bool,
    /// Print the page docs/models.md.
    #[arg(long)]
    markdown: bool,
}

impl Command for SolversCommand {
    const NAME: &'static str = "solvers";
    const GROUP: Group = Group::Solvers;
    const ABOUT: &'static str = "Show the models and effects that the installed solvers offer";

    fn run(&self, _: &Context<'_>) -> Result<(), RunError> {
        let described = &installed()?;
        print(&match (self.json, self.markdown) {
            (true, _) => json(described),
            (_, true) => page(described),
            _ => described.iter().map(lines).collect(),
        })
    }
}

/// The cases that a model answers.
fn modes(steady: bool, transient: bool) -> &'static str {
    match (steady, transient) {
        (true, true) => "steady, transient",
        (true, false) => "steady",
        _ => "transient",
    }
}

fn lines(of: &Description) -> String {
    let mut text = format!("{} {} (role {})\n", of.name, of.version, of.role);
    for model in &of.models {
        text += &format!(
            "  model   {:16} {} [{}]\n",
            model.name,
            model.summary,
            modes(model.steady, model.transient)
        );
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
        let _ = write!(text, "\n## Models of role {role}\n");
        for ModelSpec { name, summary, source, keys, steady, transient, .. } in models {
            let lines = [
                ("cases", modes(*steady, *transient).to_owned()),
                ("keys of its own", named(keys)),
                ("source", source.clone()),
            ];
            text += &section(name, summary, &lines);
        }
    }
    for Description { role, effects, .. } in described.iter().filter(|of| !of.effects.is_empty()) {
        let _ = write!(text, "\n## Effects of role {role}\n");
        for EffectSpec { name, law, models, keys, source, .. } in effects {
            let lines =
                [("models", models.join(", ")), ("keys", named(keys)), ("source", source.clone())];
            text += &section(name, law, &lines);
        }
    }
    text
}

/// What is said under a name, line by line; a line without a text is left out.
fn section(name: &str, what: &str, lines: &[(&str, String)]) -> String {
    let mut text = format!("\n### {name}\n\n{}\n\n", escaped(what));
    for (word, line) in lines.iter().filter(|(_, line)| !line.is_empty()) {
        let _ = writeln!(text, "- {word}: {line}");
    }
    text
}

/// Names of keys, as code.
fn named(keys: &[KeySpec]) -> String {
    let names: Vec<String> = keys.iter().map(|key| format!("`{}`", key.path)).collect();
    names.join(", ")
}

/// A formula as it is: nothing in it is a mark of the page.
fn escaped(text: &str) -> String {
    let mut escaped = String::new();
    for letter in text.chars() {
        if matches!(letter, '*' | '_' | '<' | '[' | '|') {
            escaped.push('\\');
        }
        escaped.push(letter);
    }
    escaped
}
