//! A case judged without asking anybody: syntax, the coordinator's own keys and their rules.
//!
//! What the participants read, and with it what would run, only their programs can say; what was not
//! judged is listed by key.

use super::checker::{Checker, fill_defaults};
use super::diagnostics::Problems;
use super::known::{instances, known_keys};
use super::raw::{RawCase, RawParticipant};
use super::schema::WELL_KNOWN_ROLES;
use super::selection::Selection;
use super::settings::Settings;
use super::settled::{Coupling, Output, Timing};

/// What a case says of itself.
#[derive(Clone, Debug)]
pub struct Alone {
    /// Short name of the case.
    pub name: String,
    /// One line for people.
    pub title: Option<String>,
    /// Steady, or transient with its times.
    pub timing: Timing,
    /// How the participants are coupled.
    pub coupling: Coupling,
    /// What a run writes.
    pub output: Output,
    /// The sections that may name participants.
    pub participants: Vec<RawParticipant>,
    /// Sections and keys that nobody was asked about.
    pub not_judged: Vec<String>,
}

impl Alone {
    /// What was not judged, and why, as a text.
    #[must_use]
    pub fn not_judged_text(&self) -> String {
        let roles: Vec<&str> = self.participants.iter().map(|one| one.role.as_str()).collect();
        let mut text = format!(
            "not checked, as no program was started: models, effects and fields, which the programs of \
         {} describe, and the scheme that follows from them",
            roles.join(", ")
        );
        if !self.not_judged.is_empty() {
            text += &format!("; the keys {}", self.not_judged.join(", "));
        }
        text + "\n"
    }
}

/// Judges what can be judged of a case without a description.
///
/// # Errors
/// Everything that is wrong with the coordinator's own keys.
pub fn judge_alone(raw: &RawCase) -> Result<Alone, Problems> {
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
    let mut checker = Checker::new(raw, &selection, &known, &[]);
    checker.unasked = true;
    checker.walk(&raw.tree, "");
    let all = instances(&known, &raw.tree, &checker.references);
    let active: Vec<_> = all.iter().filter(|instance| instance.known.active).cloned().collect();
    fill_defaults(&mut checker.values, &active);
    checker.missing(&all, &active);
    checker.own_values();
    if participants.is_empty() {
        checker.somebody_runs();
    }
    let Checker { values, problems, not_judged, .. } = checker;
    if let Some(problems) = raw.report(problems) {
        return Err(problems);
    }
    let settings = Settings(&values);
    Ok(Alone {
        name: settings.text("case.name").expect("a name is required and checked"),
        title: settings.text("case.title"),
        timing: settings.timing(),
        coupling: settings.coupling(),
        output: settings.output(),
        participants,
        not_judged,
    })
}
