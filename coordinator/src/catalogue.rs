//! `coordinator fields` and `coordinator figures`: every field that participants exchange or write, and every number of a summary, with
//! unit, meaning, and who gives it.
//!
//! They are those of the contract's table and of what the installed programs describe; docs/fields.md and docs/figures.md are
//! written from them.

use crate::output::print;
use clap::Args;
use contract::description::{Description, EffectSpec, ModelSpec};
use contract::field::{self, FieldKind, FieldSpec};
use contract::figure::FigureSpec;
use contract::text::json;
use run::error::RunError;
use run::wrap;
use serde::Serialize;
use std::fmt::Write as _;

/// What is asked of either.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Show those alone whose name or meaning holds this.
    pattern: Option<String>,
    /// Print JSON.
    #[arg(long, conflicts_with = "markdown")]
    json: bool,
    /// Print them as the page in docs has them.
    #[arg(long)]
    markdown: bool,
}

/// Something that participants give.
trait Output: Serialize {
    fn name(&self) -> &str;
    fn unit(&self) -> &str;
    fn meaning(&self) -> String;
    fn given_by(&self) -> &[String];
}

#[derive(Debug, Serialize)]
struct Field {
    #[serde(flatten)]
    kind: FieldKind,
    provided_by: Vec<String>,
    consumed_by: Vec<String>,
}

#[derive(Debug, Serialize)]
struct Figure {
    #[serde(flatten)]
    spec: FigureSpec,
    given_by: Vec<String>,
}

impl Output for Field {
    fn name(&self) -> &str {
        &self.kind.name
    }

    fn unit(&self) -> &str {
        &self.kind.unit
    }

    fn meaning(&self) -> String {
        let Self { kind, consumed_by, .. } = self;
        let components = match kind.components {
            1 => String::new(),
            count => format!("; {count} components"),
        };
        let read = match consumed_by.is_empty() {
            true => String::new(),
            false => format!("; read by {}", consumed_by.join(", ")),
        };
        format!("{}{components}{read}", kind.meaning)
    }

    fn given_by(&self) -> &[String] {
        &self.provided_by
    }
}

impl Output for Figure {
    fn name(&self) -> &str {
        &self.spec.key
    }

    fn unit(&self) -> &str {
        &self.spec.unit
    }

    fn meaning(&self) -> String {
        let expected = self.spec.plausible.as_ref().map_or(String::new(), |bounds| {
            let least = bounds.least.map(|least| format!("at least {least}"));
            let most = bounds.most.map(|most| format!("at most {most}"));
            let both: Vec<String> = least.into_iter().chain(most).collect();
            format!("; expected is {}: {}", both.join(" and "), bounds.why)
        });
        format!("{}{expected}", self.spec.words)
    }

    fn given_by(&self) -> &[String] {
        &self.given_by
    }
}

/// Prints the fields.
///
/// # Errors
/// They cannot be printed, or none is like the pattern.
pub(crate) fn fields(asked: &Arguments, described: &[Description]) -> Result<(), RunError> {
    let own = described.iter().flat_map(|of| of.fields.iter().cloned());
    let kinds = field::TABLE.iter().map(FieldSpec::kind).chain(own);
    // The geometry of a grid travels on a topic of its own.
    let exchanged = kinds.filter(|kind| kind.name != field::GEOMETRY.name);
    let of = |kind: FieldKind| {
        let provides = |model: &ModelSpec| model.provides.contains(&kind.name);
        let consumes = |model: &ModelSpec| model.consumes.contains(&kind.name);
        let with = |effect: &EffectSpec| effect.provides.contains(&kind.name);
        let needs = |effect: &EffectSpec| effect.consumes.contains(&kind.name);
        Field {
            provided_by: those(described, provides, with),
            consumed_by: those(described, consumes, needs),
            kind,
        }
    };
    let intro = "Every field that the installed programs exchange or write out, as `coordinator fields --markdown` writes them; \
                 `coordinator fields PATTERN` shows some. In results `upper` and `lower` are the names that the case gives its bodies. \
                 Values are component-major on the grid that the plan names.";
    show(asked, exchanged.map(of).collect(), "Fields", intro)
}

/// Prints the figures.
///
/// # Errors
/// They cannot be printed, or none is like the pattern.
pub(crate) fn figures(asked: &Arguments, described: &[Description]) -> Result<(), RunError> {
    let of =
        |spec: &FigureSpec, giver: String| Figure { spec: spec.clone(), given_by: vec![giver] };
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

fn show<T: Output>(
    asked: &Arguments,
    mut all: Vec<T>,
    title: &str,
    intro: &str,
) -> Result<(), RunError> {
    if let Some(pattern) = &asked.pattern {
        let wanted = pattern.to_lowercase();
        let like = |text: &str| text.to_lowercase().contains(&wanted);
        all.retain(|one| like(one.name()) || like(&one.meaning()));
        if all.is_empty() {
            let fix = "leave the pattern out to see all of them";
            return Err(RunError::Usage(format!("nothing is like `{pattern}`; {fix}")));
        }
    }
    print(&match (asked.json, asked.markdown) {
        (true, _) => json(&all),
        (_, true) => markdown(&all, title, intro),
        _ => all.iter().map(terminal).collect(),
    })
}

fn terminal<T: Output>(one: &T) -> String {
    let given = one.given_by().join(", ");
    let text =
        format!("{}  [{}]\n    {}\n    from {given}\n", one.name(), one.unit(), one.meaning());
    wrap::columns(&text)
}

fn markdown<T: Output>(all: &[T], title: &str, intro: &str) -> String {
    let mut text = format!(
        "# {title}\n\n{intro}\n\n| name | unit | what | from |\n| --- | --- | --- | --- |\n"
    );
    for one in all {
        let meaning = one.meaning().replace('|', "\\|");
        let _ = writeln!(
            text,
            "| `{}` | {} | {meaning} | {} |",
            one.name(),
            one.unit(),
            one.given_by().join(", ")
        );
    }
    text
}
