//! Configuration, options and names from which the tables of a case are written.

use crate::configuration::Configuration;
use crate::names::Names;
use crate::notes::{NoteKind, Notes};
use crate::scheme::{CouplingScheme, Exchange};
use std::collections::BTreeMap;

/// Names and programs that a configuration does not have.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImportOptions {
    /// Name of the case.
    pub name: String,
    /// Path of the configuration, as the participants find it.
    pub path: String,
    /// Programs by the names of their participants, each with its arguments.
    pub commands: BTreeMap<String, Vec<String>>,
    /// Folders in which the programs run, by the names of their participants.
    pub directories: BTreeMap<String, String>,
    /// Names of fields that have a meaning of their own, which data of the configuration lack.
    pub reserved: Vec<String>,
    /// Reasons for which a check refuses the case; they become notes.
    pub refusals: Vec<Refusal>,
}

/// Reason for which a check refuses the case.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Refusal {
    /// Key of the case; empty for the case as a whole.
    pub key: String,
    /// Reason.
    pub reason: String,
    /// Advice; may be empty.
    pub fix: String,
}

/// Everything from which the tables of the case are written.
pub(super) struct Source<'a> {
    pub(super) configuration: &'a Configuration,
    /// Scheme whose settings the case takes.
    pub(super) leading: &'a CouplingScheme,
    pub(super) options: &'a ImportOptions,
    pub(super) names: Names,
    /// Participants in the order of the case.
    pub(super) order: Vec<&'a str>,
    pub(super) notes: Notes,
}

impl<'a> Source<'a> {
    /// Returns the source of a configuration; `None` without a coupling scheme.
    pub(super) fn new(
        configuration: &'a Configuration,
        options: &'a ImportOptions,
    ) -> Option<Self> {
        let leading = leading(&configuration.schemes)?;
        Some(Self {
            configuration,
            leading,
            options,
            names: Names::new(configuration, &options.reserved),
            order: order(configuration, leading),
            notes: Notes::default(),
        })
    }

    /// Returns all exchanges.
    pub(super) fn exchanges(&self) -> impl Iterator<Item = &'a Exchange> + use<'a> {
        self.configuration.schemes.iter().flat_map(|scheme| &scheme.exchanges)
    }

    /// Returns the field that an exchange sends.
    pub(super) fn field(&self, exchange: &Exchange) -> Option<&str> {
        self.names.field(&exchange.data, &exchange.from)
    }

    /// Returns the place of a participant in the order of the case.
    pub(super) fn place(&self, participant: &str) -> usize {
        self.order.iter().position(|name| *name == participant).unwrap_or(self.order.len())
    }

    /// Notes the reasons for which a check refuses the case.
    pub(super) fn refusals(&mut self) {
        for Refusal { key, reason, fix } in &self.options.refusals {
            let element = if key.is_empty() { "coordinator check" } else { key };
            let fix = Some(fix.as_str()).filter(|fix| !fix.is_empty());
            self.notes.of_case(NoteKind::Todo, element, reason, fix);
        }
    }

    /// Notes elements that no table of the case is concerned with.
    pub(super) fn remaining(&mut self) {
        let (configuration, notes) = (self.configuration, &mut self.notes);
        for connection in &configuration.connections {
            notes.advise(
                NoteKind::Unneeded,
                connection.line,
                format!("m2n:{}", connection.kind),
                "participants of one machine share memory",
                Some("for other machines: coordinator relay"),
            );
        }
        for service in &configuration.services {
            let reason = "the coordinator has its own messages and times";
            let instead = Some("see --log, and the summary of a run");
            notes.advise(NoteKind::Unneeded, service.line, &service.element, reason, instead);
        }
        for data in configuration.data.iter().filter(|data| data.bounded) {
            let reason = format!("`{}` may leave its bounds in an iteration", data.name);
            notes.add(NoteKind::Missing, data.line, "data, bounds", reason);
        }
        if let Some(line) = configuration.remeshing {
            let reason = "the vertices of a mesh stay the same during a run";
            notes.add(NoteKind::Missing, line, "precice-configuration, allow-remeshing", reason);
        }
        for unknown in &configuration.unknown {
            let element = match &unknown.attribute {
                Some(attribute) => format!("{}, {attribute}", unknown.element),
                None => unknown.element.clone(),
            };
            let reason = "not known, and left out";
            notes.add(NoteKind::Missing, unknown.line, element, reason);
        }
    }
}

/// Returns the scheme whose settings the case takes: the first implicit one, or the first one.
fn leading(schemes: &[CouplingScheme]) -> Option<&CouplingScheme> {
    schemes.iter().find(|scheme| scheme.kind.is_implicit()).or(schemes.first())
}

/// Returns the participants in the order of the schemes, the leading scheme first.
fn order<'a>(configuration: &'a Configuration, leading: &'a CouplingScheme) -> Vec<&'a str> {
    let coupled = std::iter::once(leading).chain(&configuration.schemes);
    let coupled = coupled.flat_map(|scheme| &scheme.participants);
    let all = coupled.chain(configuration.participants.iter().map(|one| &one.name));
    let mut order: Vec<&str> = Vec::new();
    for name in all {
        if !order.contains(&name.as_str()) {
            order.push(name);
        }
    }
    order
}
