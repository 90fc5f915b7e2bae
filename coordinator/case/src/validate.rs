//! Validation of a raw case, step by step, up to a [`Case`]; or as far as possible without asking
//! any participant.
//!
//! ```text
//! RawCase ──resolve──► RawCase ──CheckedKeys::read──► CheckedKeys
//!         ──FilledCase::of──► FilledCase ──missing, rules, histories──► Case
//! ```
//!
//! Each step takes the type that the previous step produces. Errors are collected and reported
//! together.

use super::alternatives::resolve;
use super::case::Case;
use super::checked_keys::{CheckedKeys, Scope};
use super::diagnostics::Problems;
use super::filled_case::FilledCase;
use super::known::{Keys, Readers, known_keys};
use super::raw::{RawCase, RawParticipant};
use super::schema::WELL_KNOWN_ROLES;
use super::selection::Selection;
use super::settings::{Coupling, Output, ParticipantCase, Settings, Timing};
use contract::bodies::Bodies;
use contract::description::Description;
use std::sync::Arc;

/// Validates a case against the descriptions of its participants, by role. `swapped` describes the
/// default programs of roles that another program plays.
///
/// The steps, with their needs and guarantees:
///
/// 1. `Selection::new` reads roles, models, effects and the mode in time from a case that may
///    contain any error.
/// 2. `known_keys` needs the selection. It lists every known key, and marks those that are active
///    in this case.
/// 3. `resolve` needs the known keys. An alternative set by an option replaces those of the file.
/// 4. `Keys::of` substitutes the names of the case for `*`.
/// 5. `CheckedKeys::read` checks each key by itself. Its values are in SI units; every wrong key or
///    value is reported.
/// 6. `FilledCase::of` needs the checked keys and those of step 4. Every key that is read has a
///    value, unless it is missing.
/// 7. `missing` and `rules` compare several keys, so they need defaults. `histories` takes the
///    columns out of the filled case, after the rules.
/// 8. A case without errors gets its settings deserialised from the values, and is complete.
///
/// # Errors
/// Lists every error of the case.
pub fn validate(
    raw: &RawCase,
    descriptions: &[(String, Arc<Description>)],
    swapped: &[(String, Arc<Description>)],
) -> Result<Case, Problems> {
    let selection = Selection::new(&raw.tree, descriptions);
    let known = known_keys(&selection, &selection.undescribed(raw));
    let (raw, replaced) = resolve(raw, &known);
    let keys = Keys::of(&known, &raw.tree);
    let scope = Scope { case: &raw, selection: &selection, known: &known, swapped, asked: true };
    let mut filled = FilledCase::of(CheckedKeys::read(scope), &keys);
    filled.missing();
    filled.rules();
    let histories = filled.histories();
    let FilledCase { values, live, faults, .. } = filled;
    if let Some(problems) = raw.report(faults.into_list()) {
        return Err(problems);
    }
    let readers = Readers { known: &known, references: &keys.references, swapped };
    let unread = readers.unread(&raw.tree);
    let roles = |needed| {
        let present = selection.players.iter().filter(|player| player.present);
        present.filter(move |player| player.needed == needed).map(|player| player.role)
    };
    let settings = Settings::read(&values);
    Ok(Case {
        name: settings.case.name,
        title: settings.case.title,
        participants: roles(true).map(|role| ParticipantCase::read(&values, role)).collect(),
        idle: roles(false).map(str::to_owned).collect(),
        bodies: Bodies::read(&values).ok(),
        timing: settings.time,
        histories,
        live: live.into_values().collect(),
        coupling: settings.coupling,
        mappings: settings.mapping,
        limits: settings.limits,
        output: settings.output,
        unread,
        values,
        replaced,
        references: keys.references.clone(),
        effects: selection.effects.clone(),
        raw,
    })
}

/// A case checked as far as possible without its participants.
#[derive(Clone, Debug)]
pub struct StandaloneCheck {
    /// Short name of the case.
    pub name: String,
    /// Title of the case, in one line.
    pub title: Option<String>,
    /// Steady, or transient with its times.
    pub timing: Timing,
    /// Settings of the coupling.
    pub coupling: Coupling,
    /// Fields and checkpoints that a run writes.
    pub output: Output,
    /// The sections that may name participants.
    pub participants: Vec<RawParticipant>,
    /// Sections and keys that only a participant could check.
    pub not_judged: Vec<String>,
}

impl StandaloneCheck {
    /// Lists the keys that were not checked, and says why.
    #[must_use]
    pub fn not_judged_text(&self) -> String {
        let roles: Vec<&str> = self.participants.iter().map(|one| one.role.as_str()).collect();
        let mut text = format!(
            "not checked, because no program was started: models, effects and fields, which the programs of \
         {} describe, and the scheme that follows from them",
            roles.join(", ")
        );
        if !self.not_judged.is_empty() {
            text += &format!("; the keys {}", self.not_judged.join(", "));
        }
        text + "\n"
    }
}

/// Checks a case without any description: the coordinator's own keys and their rules. Keys that
/// only participants can check are listed.
///
/// # Errors
/// Lists every error of the coordinator's own keys.
pub fn check_without_participants(raw: &RawCase) -> Result<StandaloneCheck, Problems> {
    let participants = raw.participants();
    let marked = |p: &&RawParticipant| {
        let known = WELL_KNOWN_ROLES.contains(&p.role.as_str());
        known || p.attach || raw.has(&format!("{}.command", p.role))
    };
    let roles: Vec<String> = participants.iter().filter(marked).map(|p| p.role.clone()).collect();
    let selection = Selection::new(&raw.tree, &[]);
    let mut known = known_keys(&selection, &roles);
    for key in &mut known {
        key.active |= roles.iter().any(|role| key.spec.path.split('.').next() == Some(role));
    }
    let keys = Keys::of(&known, &raw.tree);
    let scope =
        Scope { case: raw, selection: &selection, known: &known, swapped: &[], asked: false };
    let mut written = CheckedKeys::read(scope);
    let not_judged = std::mem::take(&mut written.not_judged);
    let mut filled = FilledCase::of(written, &keys);
    filled.missing();
    filled.own_values();
    if participants.is_empty() {
        filled.somebody_runs();
    }
    let FilledCase { values, faults, .. } = filled;
    if let Some(problems) = raw.report(faults.into_list()) {
        return Err(problems);
    }
    let Settings { case, time, coupling, output, .. } = Settings::read(&values);
    let (name, title) = (case.name, case.title);
    Ok(StandaloneCheck { name, title, timing: time, coupling, output, participants, not_judged })
}
