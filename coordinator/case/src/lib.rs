//! The case file, from text to a validated [`Case`].
//!
//! ```text
//! bytes ──RawCase::read──► RawCase ──set, unset──► RawCase ──validate(descriptions)──► Case
//! ```
//!
//! Each step reports all of its errors at once, every one with its place, key, reason and fix.
//! The coordinator's own keys ([`schema`]) and those of the participants (their descriptions) are
//! declared by the same [`contract::description::KeySpec`] and checked by the same code; which keys
//! exist, their units and their ranges are known from nowhere else.
//!
//! What is decided here, and not in the types:
//! - A section is a participant if its role has a description; a participant that does not stand
//!   alone and claims no active effect is idle: its keys may be in the case but are not required.
//! - A key that only another model of a participant, an effect that is off, or the usual program of a
//!   role whose place another one has taken reads is no error, so that a case survives
//!   `--set mech.model=...` and `--set thermal.command=...`; its value must still be of the right kind.
//!   It is noted in [`Case::unread`], which becomes a warning. An effect that nobody offers stays an error:
//!   without it the answer is another one.
//! - Of alternatives (`one_of`) exactly one must be given whenever any of them is read. One set by
//!   an option replaces those of the file; two set by options, or two in the file, are an error.
//! - A member of an alternative that is marked required or has a default is so only if its
//!   alternative is given.
//! - Of a table that `name_in` keys refer to (`materials`), only the entries referred to are read.
//! - Names with a dot in them are refused: dotted keys address values everywhere else.

mod alone;
mod alternatives;
mod check;
mod checker;
mod coupling;
mod diagnostics;
mod example;
mod groups;
mod history;
mod known;
mod live;
mod live_key;
mod mapping;
mod missing;
mod quote;
mod raw;
mod rules;
pub mod schema;
mod selection;
mod set;
mod settings;
mod settled;
#[cfg(test)]
mod tests;
mod text;
mod tree;
mod unread;
mod walk;

pub use alone::{Alone, judge_alone};
pub use alternatives::Replaced;
pub use contract::quantity::{QuantityError, parse_quantity};
pub use contract::unit::si_exponents;
pub use diagnostics::{Place, Problem, Problems};
pub use live_key::LiveKey;
pub use raw::{RawCase, RawParticipant};
pub use settled::{Case, Control, Coupling, Limits, Output, OutputFields, ParticipantCase, Timing};
pub use unread::Unread;

use checker::{Checker, fill_defaults};
use contract::bodies::Bodies;
use contract::description::Description;
use known::{instances, known_keys};
use selection::Selection;
use settings::Settings;

/// Validates a case against what its participants, by role, say of themselves; `swapped` are the usual
/// programs of roles that others play.
///
/// # Errors
/// Everything that is wrong with the case.
pub fn validate(
    raw: &RawCase,
    descriptions: &[(String, Description)],
    swapped: &[(String, Description)],
) -> Result<Case, Problems> {
    let selection = Selection::new(&raw.tree, descriptions);
    let known = known_keys(&selection, &undescribed(raw, &selection));
    let (case, replaced) = alternatives::resolve(raw, &known);
    let mut checker = Checker::new(&case, &selection, &known, swapped);
    checker.walk(&case.tree, "");
    checker.refer();
    let all = instances(&known, &case.tree, &checker.references);
    let active: Vec<_> = all.iter().filter(|instance| instance.known.active).cloned().collect();
    fill_defaults(&mut checker.values, &active);
    checker.put_effects();
    checker.missing(&all, &active);
    checker.bodies(&active);
    checker.names(&active);
    checker.magnitudes(&active);
    checker.effects();
    checker.models();
    checker.own_rules();
    let histories = checker.histories();
    let unread = checker.unread();
    let Checker { values, references, problems, live, .. } = checker;
    let live = live.into_values().collect();
    match case.report(problems) {
        Some(problems) => Err(problems),
        None => Ok(Case {
            replaced,
            unread,
            histories,
            live,
            ..settle(case, &selection, values, references)
        }),
    }
}

/// Roles that have a command or are well known, but that no participant has described.
fn undescribed(raw: &RawCase, selection: &Selection<'_>) -> Vec<String> {
    let unknown = |role: &str| selection.players.iter().all(|player| player.role != role);
    let meant = |role: &str| {
        let has = |name: &str| raw.tree.find(&format!("{role}.{name}")).is_some();
        schema::WELL_KNOWN_ROLES.contains(&role) || has("command") || has("attach")
    };
    let roles = raw.participants().into_iter().map(|participant| participant.role);
    roles.filter(|role| unknown(role) && meant(role)).collect()
}

fn settle(
    case: RawCase,
    selection: &Selection<'_>,
    values: contract::params::Params,
    references: known::References,
) -> Case {
    let settings = Settings(&values);
    let roles = |needed| {
        let present = selection.players.iter().filter(|player| player.present);
        present.filter(move |player| player.needed == needed).map(|player| player.role)
    };
    Case {
        name: settings.text("case.name").expect("a name is required and checked"),
        title: settings.text("case.title"),
        participants: roles(true).map(|role| settings.participant(role)).collect(),
        idle: roles(false).map(str::to_owned).collect(),
        effects: selection.effects.clone(),
        bodies: Bodies::read(&values).ok(),
        timing: settings.timing(),
        coupling: settings.coupling(),
        mappings: settings.mappings(),
        limits: settings.limits(),
        output: settings.output(),
        unread: Vec::new(),
        histories: None,
        live: Vec::new(),
        values,
        raw: case,
        references,
        replaced: Vec::new(),
    }
}
