//! `coordinator fields` and `coordinator figures`: fields that participants exchange or write, and
//! figures of a summary, with unit, meaning and source.
//!
//! Both come from the contract's table and from the descriptions of the installed programs.
//! docs/fields.md and docs/figures.md are generated from them.

use clap::Args;
use console::command::{Command, Context, Group};
use console::keys::plain;
use console::listing::{Entry, Listing};
use console::output::print;
use contract::description::{Description, EffectSpec, KeySpec, ModelSpec};
use contract::field::{self, FieldKind, FieldSpec};
use contract::figure::FigureSpec;
use contract::text::json;
use run::error::RunError;
use run::fleet::installed;
use serde_json::{Value, json};
use std::fmt::Write as _;

/// A field or a figure.
struct Output {
    name: String,
    unit: String,
    meaning: String,
    given_by: Vec<String>,
    read_by: Vec<String>,
    /// Description, as its program gives it.
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
    const ABOUT: &'static str = "List the fields that participants exchange or write";
    const EXAMPLES: &'static [&'static str] = &["coordinator fields speed"];

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
    const ABOUT: &'static str = "List the figures of a summary";
    const EXAMPLES: &'static [&'static str] = &["coordinator figures creepage"];

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
        let mut all = json!(kind);
        all["provided_by"] = json!(provided_by);
        all["consumed_by"] = json!(consumed_by);
        Output {
            meaning: format!("{}{components}", kind.meaning),
            name: kind.name,
            unit: kind.unit,
            given_by: provided_by,
            read_by: consumed_by,
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
            let least = bounds.least.map(|least| format!("at least {}", plain(least)));
            let most = bounds.most.map(|most| format!("at most {}", plain(most)));
            let both: Vec<String> = least.into_iter().chain(most).collect();
            format!("; expected {}: {}", both.join(" and "), bounds.why)
        });
        let mut all = json!(spec);
        all["given_by"] = json!([giver]);
        Output {
            name: spec.key.clone(),
            unit: spec.unit.clone(),
            meaning: format!("{}{expected}", spec.words),
            given_by: vec![giver],
            read_by: Vec::new(),
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
                 `coordinator figures PATTERN` shows some. `*` stands for the name of a body, `#` for a place in a list. A model omits \
                 figures that it does not compute. Unexpected values give a warning, and with `--strict` an error.";
    show(asked, all.collect(), "Figures", intro)
}

/// Returns the roles with a matching model, and the matching effects.
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
    let matches = |output: &Output| asked.matches([&output.name, &output.meaning]);
    let all = asked.found(all.into_iter().filter(matches).collect())?;
    print(&match (asked.json, asked.markdown) {
        (true, _) => json(&all.iter().map(|one| &one.described).collect::<Vec<_>>()),
        (_, true) => markdown(&all, title, intro),
        _ => all.iter().map(|output| asked.lines(&entry(output))).collect(),
    })
}

fn entry(output: &Output) -> Entry<'_> {
    let Output { name, unit, meaning, read_by, given_by, .. } = output;
    let mut details = vec![format!("from {}", given_by.join(", "))];
    if !read_by.is_empty() {
        details.push(format!("read by {}", read_by.join(", ")));
    }
    Entry { name, text: format!("{meaning} [{unit}]"), details }
}

fn markdown(all: &[Output], title: &str, intro: &str) -> String {
    let mut text = format!(
        "# {title}\n\n{intro}\n\n| name | unit | what | from |\n| --- | --- | --- | --- |\n"
    );
    for Output { name, unit, meaning, given_by, read_by, .. } in all {
        let readers = match read_by.is_empty() {
            true => String::new(),
            false => format!("; read by {}", read_by.join(", ")),
        };
        let (meaning, given) = (meaning.replace('|', "\\|") + &readers, given_by.join(", "));
        let _ = writeln!(text, "| `{name}` | {unit} | {meaning} | {given} |");
    }
    text
}
