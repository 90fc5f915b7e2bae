//! `coordinator fields` and `coordinator figures`: every field that participants exchange or write, and every number of a summary, with
//! unit, meaning, and who gives it.
//!
//! They are those of the contract's table and of what the installed programs describe; docs/fields.md and docs/figures.md are
//! written from them.

use crate::installed::installed;
use clap::Args;
use console::command::{Command, Context, Group};
use console::listing::Listing;
use console::output::print;
use contract::description::{Description, EffectSpec, KeySpec, ModelSpec};
use contract::field::{self, FieldKind, FieldSpec};
use contract::figure::FigureSpec;
use contract::text::json;
use run::error::RunError;
use run::wrap;
use serde_json::{Value, json};
use std::fmt::Write as _;

/// Something that participants give.
struct Output {
    name: String,
    unit: String,
    meaning: String,
    given_by: Vec<String>,
    /// All that is described of it.
    described: Value,
}

/// Options of `coordinator fields`.
#[derive(Debug, Args)]
pub(crate) struct FieldsCommand {
    #[command(flatten)]
    of: Listing,
}

impl Command for FieldsCommand {
    const NAME: &'static str = "fields";
    const GROUP: Group = Group::Reference;
    const ABOUT: &'static str =
        "Show every field that participants exchange or write: unit, components, and who gives it";

    fn run(&self, _: &Context<'_>) -> Result<(), RunError> {
        fields(&self.of, &installed()?)
    }
}

/// Options of `coordinator figures`.
#[derive(Debug, Args)]
pub(crate) struct FiguresCommand {
    #[command(flatten)]
    of: Listing,
}

impl Command for FiguresCommand {
    const NAME: &'static str = "figures";
    const GROUP: Group = Group::Reference;
    const ABOUT: &'static str =
        "Show every number of a summary: unit, meaning, what is expected, and who gives it";

    fn run(&self, _: &Context<'_>) -> Result<(), RunError> {
        figures(&self.of, &installed()?)
    }
}

/// Prints the fields.
fn fields(asked: &Listing, described: &[Description]) -> Result<(), RunError> {
    let own = described.iter().flat_map(|of| of.fields.iter().cloned());
    let kinds = field::TABLE.iter().map(FieldSpec::kind).chain(own);
    // The geometry of a grid travels on a topic of its own.
    let exchanged = kinds.filter(|kind| kind.name != field::GEOMETRY.name);
    let of = |kind: FieldKind| {
        let provides = |model: &ModelSpec| model.provides.contains(&kind.name);
        let consumes = |model: &ModelSpec| model.consumes.contains(&kind.name);
        let with = |effect: &EffectSpec| effect.provides.contains(&kind.name);
        let asks = |key: &KeySpec| key.consumes.values().any(|fields| fields.contains(&kind.name));
        let needs = |effect: &EffectSpec| {
            effect.consumes.contains(&kind.name) || effect.keys.iter().any(asks)
        };
        let provided_by = those(described, provides, with);
        let consumed_by = those(described, consumes, needs);
        let components = match kind.components {
            1 => String::new(),
            count => format!("; {count} components"),
        };
        let read = match consumed_by.is_empty() {
            true => String::new(),
            false => format!("; read by {}", consumed_by.join(", ")),
        };
        let mut all = json!(kind);
        all["provided_by"] = json!(provided_by);
        all["consumed_by"] = json!(consumed_by);
        Output {
            meaning: format!("{}{components}{read}", kind.meaning),
            name: kind.name,
            unit: kind.unit,
            given_by: provided_by,
            described: all,
        }
    };
    let intro = "Every field that the installed programs exchange or write out, as `coordinator fields --markdown` writes them; \
                 `coordinator fields PATTERN` shows some. In results `upper` and `lower` are the names that the case gives its bodies. \
                 Values are component-major on the grid that the plan names.";
    show(asked, exchanged.map(of).collect(), "Fields", intro)
}

/// Prints the figures.
fn figures(asked: &Listing, described: &[Description]) -> Result<(), RunError> {
    let of = |spec: &FigureSpec, giver: String| {
        let expected = spec.plausible.as_ref().map_or(String::new(), |bounds| {
            let least = bounds.least.map(|least| format!("at least {least}"));
            let most = bounds.most.map(|most| format!("at most {most}"));
            let both: Vec<String> = least.into_iter().chain(most).collect();
            format!("; expected is {}: {}", both.join(" and "), bounds.why)
        });
        let mut all = json!(spec);
        all["given_by"] = json!([giver]);
        Output {
            name: spec.key.clone(),
            unit: spec.unit.clone(),
            meaning: format!("{}{expected}", spec.words),
            given_by: vec![giver],
            described: all,
        }
    };
    let all = described.iter().flat_map(|Description { role, figures, effects, .. }| {
        let with_effects = effects.iter().flat_map(move |effect| {
            let giver = format!("effect {}", effect.name);
            effect.figures.iter().map(move |spec| of(spec, giver.clone()))
        });
        figures.iter().map(move |spec| of(spec, role.clone())).chain(with_effects)
    });
    let intro = "Every number of `summary.json` that the installed programs describe, as `coordinator figures --markdown` writes them; \
                 `coordinator figures PATTERN` shows some. `*` stands for the name of a body, `#` for a place in a list. A model without one leaves \
                 it out. What is beyond what is expected is told, and an error with `--strict`.";
    show(asked, all.collect(), "Figures", intro)
}

/// The roles with a model that does, and the effects that do.
fn those(
    described: &[Description],
    model: impl Fn(&ModelSpec) -> bool,
    effect: impl Fn(&EffectSpec) -> bool,
) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for one in described {
        let models: Vec<&ModelSpec> = one.models.iter().filter(|spec| model(spec)).collect();
        if models.len() == one.models.len() {
            found.push(one.role.clone());
        } else {
            found.extend(models.iter().map(|spec| format!("{} {}", one.role, spec.name)));
        }
        let effects = one.effects.iter().filter(|spec| effect(spec));
        for name in effects.map(|spec| format!("effect {}", spec.name)) {
            if !found.contains(&name) {
                found.push(name);
            }
        }
    }
    found
}

fn show(asked: &Listing, all: Vec<Output>, title: &str, intro: &str) -> Result<(), RunError> {
    let all = asked.pick(all, |one| [&one.name, &one.meaning])?;
    print(&match (asked.json, asked.markdown) {
        (true, _) => json(&all.iter().map(|one| &one.described).collect::<Vec<_>>()),
        (_, true) => markdown(&all, title, intro),
        _ => all.iter().map(terminal).collect(),
    })
}

fn terminal(Output { name, unit, meaning, given_by, .. }: &Output) -> String {
    let given = given_by.join(", ");
    wrap::columns(&format!("{name}  [{unit}]\n    {meaning}\n    from {given}\n"))
}

fn markdown(all: &[Output], title: &str, intro: &str) -> String {
    let mut text = format!(
        "# {title}\n\n{intro}\n\n| name | unit | what | from |\n| --- | --- | --- | --- |\n"
    );
    for Output { name, unit, meaning, given_by, .. } in all {
        let (meaning, given) = (meaning.replace('|', "\\|"), given_by.join(", "));
        let _ = writeln!(text, "| `{name}` | {unit} | {meaning} | {given} |");
    }
    text
}
