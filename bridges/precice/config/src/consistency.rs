//! Checks of a configuration as a whole: names are unique and defined, and stand where they belong.
//!
//! The rules are those of preCICE, which refuses the same configurations.

use crate::configuration::Configuration;
use crate::error::ConfigError;
use crate::participant::{Direction, Mapping, MeshData, Participant, ReceivedMesh};
use crate::scheme::{CouplingScheme, Exchange};
use std::collections::{BTreeMap, BTreeSet};

/// Checks the configuration.
pub(crate) fn check(configuration: &Configuration) -> Result<(), ConfigError> {
    unique("data", configuration.data.iter().map(|data| (&data.name, data.line)))?;
    unique("mesh", configuration.meshes.iter().map(|mesh| (&mesh.name, mesh.line)))?;
    unique("participant", configuration.participants.iter().map(|one| (&one.name, one.line)))?;
    let known = Known::new(configuration);
    for mesh in &configuration.meshes {
        mesh.data.iter().try_for_each(|data| known.data(data, mesh.line))?;
    }
    for participant in &configuration.participants {
        known.check_participant(participant)?;
    }
    for connection in &configuration.connections {
        known.participant(&connection.acceptor, connection.line)?;
        known.participant(&connection.connector, connection.line)?;
    }
    configuration.schemes.iter().try_for_each(|scheme| known.check_scheme(scheme))
}

/// Defined names, for look-ups.
struct Known<'a> {
    configuration: &'a Configuration,
    data: BTreeSet<&'a str>,
    /// Data of each mesh.
    meshes: BTreeMap<&'a str, BTreeSet<&'a str>>,
    participants: BTreeSet<&'a str>,
}

impl<'a> Known<'a> {
    fn new(configuration: &'a Configuration) -> Self {
        let carried = |data: &'a [String]| data.iter().map(String::as_str).collect();
        let meshes = configuration.meshes.iter();
        Self {
            configuration,
            data: configuration.data.iter().map(|data| data.name.as_str()).collect(),
            meshes: meshes.map(|mesh| (mesh.name.as_str(), carried(&mesh.data))).collect(),
            participants: configuration.participants.iter().map(|one| one.name.as_str()).collect(),
        }
    }

    fn data(&self, name: &str, line: usize) -> Result<(), ConfigError> {
        let known = self.configuration.data.iter().map(|data| &data.name);
        defined("data", name, line, self.data.contains(name), known)
    }

    fn mesh(&self, name: &str, line: usize) -> Result<(), ConfigError> {
        let known = self.configuration.meshes.iter().map(|mesh| &mesh.name);
        defined("mesh", name, line, self.meshes.contains_key(name), known)
    }

    fn participant(&self, name: &str, line: usize) -> Result<(), ConfigError> {
        let known = self.configuration.participants.iter().map(|one| &one.name);
        defined("participant", name, line, self.participants.contains(name), known)
    }

    /// Checks that a mesh and its data are defined.
    fn carried(&self, used: &MeshData) -> Result<(), ConfigError> {
        self.data(&used.data, used.line)?;
        self.mesh(&used.mesh, used.line)?;
        let data = self.meshes.get(used.mesh.as_str());
        match data.is_some_and(|data| data.contains(used.data.as_str())) {
            true => Ok(()),
            false => Err(ConfigError::DataOfMesh {
                line: used.line,
                mesh: used.mesh.clone(),
                data: used.data.clone(),
            }),
        }
    }

    fn check_participant(&self, participant: &Participant) -> Result<(), ConfigError> {
        for provided in &participant.provides {
            self.mesh(&provided.mesh, provided.line)?;
        }
        for received in &participant.receives {
            self.mesh(&received.mesh, received.line)?;
            self.participant(&received.from, received.line)?;
            self.check_received(participant, received)?;
        }
        let uses = |mesh: &str, line: usize| match participant.uses(mesh) {
            true => Ok(()),
            false => Err(ConfigError::MeshOfParticipant {
                line,
                participant: participant.name.clone(),
                mesh: mesh.to_owned(),
            }),
        };
        for used in participant.reads.iter().chain(&participant.writes) {
            self.carried(used)?;
            uses(&used.mesh, used.line)?;
        }
        for mapping in &participant.mappings {
            for mesh in [&mapping.from, &mapping.to].into_iter().flatten() {
                self.mesh(mesh, mapping.line)?;
                uses(mesh, mapping.line)?;
            }
            check_direction(participant, mapping)?;
        }
        Ok(())
    }

    /// Checks that a mesh is received from another participant, which provides it.
    fn check_received(
        &self,
        participant: &Participant,
        received: &ReceivedMesh,
    ) -> Result<(), ConfigError> {
        let ReceivedMesh { mesh, from, line, .. } = received;
        let own = &participant.name;
        if own == from {
            return misplaced(
                *line,
                format!(
                    "the participant \"{own}\" receives the mesh \"{mesh}\" from itself; write \
                     <provide-mesh name=\"{mesh}\" />, or the participant that provides it"
                ),
            );
        }
        let provides = |one: &&Participant| one.provides(mesh);
        if self.configuration.participant(from).is_some_and(|one| provides(&one)) {
            return Ok(());
        }
        let providers = self.configuration.participants.iter().filter(provides);
        let providers: Vec<&str> = providers.map(|one| one.name.as_str()).collect();
        let providers =
            if providers.is_empty() { "nobody".to_owned() } else { providers.join(", ") };
        misplaced(
            *line,
            format!(
                "the participant \"{own}\" receives the mesh \"{mesh}\" from \"{from}\", which does \
                 not provide it; it is provided by {providers}"
            ),
        )
    }

    fn check_scheme(&self, scheme: &CouplingScheme) -> Result<(), ConfigError> {
        for participant in &scheme.participants {
            self.participant(participant, scheme.line)?;
        }
        let all = &scheme.participants;
        let twice = (1..all.len()).find(|&place| all[..place].contains(&all[place]));
        if let Some(place) = twice {
            let name = &all[place];
            let reason =
                format!("the participant \"{name}\" is coupled with itself; name each one once");
            return misplaced(scheme.line, reason);
        }
        if let (Some(least), Some(most)) = (scheme.min_iterations, scheme.max_iterations)
            && least.value > most.value
        {
            let (least, most, line) = (least.value, most.value, least.line);
            let reason = format!("min-iterations {least} is above max-iterations {most}");
            return misplaced(line, reason);
        }
        scheme.exchanges.iter().try_for_each(|exchange| self.check_exchange(scheme, exchange))?;
        for measure in &scheme.measures {
            self.carried(&measure.of)?;
            check_exchanged(scheme, &measure.of)?;
        }
        let accelerated = scheme.acceleration.iter().flat_map(|acceleration| &acceleration.data);
        for accelerated in accelerated {
            self.carried(&accelerated.of)?;
            check_accelerated(scheme, &accelerated.of)?;
        }
        Ok(())
    }

    fn check_exchange(
        &self,
        scheme: &CouplingScheme,
        exchange: &Exchange,
    ) -> Result<(), ConfigError> {
        let Exchange { data, from, to, line, .. } = exchange;
        self.carried(&exchange.carried())?;
        for name in [from, to] {
            self.participant(name, *line)?;
            if !scheme.participants.contains(name) {
                let reason = format!(
                    "the exchange of \"{data}\" names \"{name}\", which is no participant of its \
                     scheme: {}",
                    scheme.participants.join(", ")
                );
                return misplaced(*line, reason);
            }
        }
        if from == to {
            let reason =
                format!("\"{data}\" goes from \"{from}\" to itself; name the receiver in `to`");
            return misplaced(*line, reason);
        }
        Ok(())
    }
}

/// Checks that a mapping leads from a mesh of the participant to a received one, or back.
fn check_direction(participant: &Participant, mapping: &Mapping) -> Result<(), ConfigError> {
    let (own, other, word) = match mapping.direction {
        Direction::Write => (&mapping.from, &mapping.to, "from"),
        Direction::Read => (&mapping.to, &mapping.from, "to"),
    };
    let own_mesh = own.as_ref().is_none_or(|mesh| participant.provides(mesh));
    let received = |name: &String| participant.receives.iter().any(|one| one.mesh == *name);
    if own_mesh && other.as_ref().is_none_or(received) {
        return Ok(());
    }
    misplaced(
        mapping.line,
        format!(
            "a mapping with direction=\"{}\" leads {word} a mesh that \"{}\" provides, and its other \
             mesh is a received one; change the direction, or exchange `from` and `to`",
            mapping.direction.word(),
            participant.name
        ),
    )
}

/// Returns the exchanges of some data on a mesh.
fn exchanges<'a>(
    scheme: &'a CouplingScheme,
    of: &'a MeshData,
) -> impl Iterator<Item = &'a Exchange> {
    scheme.exchanges.iter().filter(|one| one.data == of.data && one.mesh == of.mesh)
}

/// Checks that data to be measured or accelerated are exchanged.
fn check_exchanged(scheme: &CouplingScheme, of: &MeshData) -> Result<(), ConfigError> {
    if exchanges(scheme, of).next().is_some() {
        return Ok(());
    }
    let elsewhere = scheme.exchanges.iter().find(|one| one.data == of.data);
    let elsewhere = elsewhere.map(|one| format!("; it is exchanged on \"{}\"", one.mesh));
    let reason = format!(
        "\"{}\" on the mesh \"{}\" is not exchanged in this scheme, so it can neither be measured \
         nor accelerated{}",
        of.data,
        of.mesh,
        elsewhere.unwrap_or_default()
    );
    misplaced(of.line, reason)
}

/// Checks that data of an acceleration are exchanged, and return in a serial scheme.
fn check_accelerated(scheme: &CouplingScheme, of: &MeshData) -> Result<(), ConfigError> {
    check_exchanged(scheme, of)?;
    let first = scheme.participants.first();
    let mut sent = exchanges(scheme, of);
    if scheme.kind.is_serial() && sent.all(|exchange| first == Some(&exchange.from)) {
        let reason = format!(
            "\"{}\" goes from the first to the second participant; a serial scheme accelerates the \
             data that return",
            of.data
        );
        return misplaced(of.line, reason);
    }
    Ok(())
}

fn misplaced(line: usize, reason: String) -> Result<(), ConfigError> {
    Err(ConfigError::Misplaced { line, reason })
}

/// Checks that a name is defined.
fn defined<'a>(
    what: &'static str,
    name: &str,
    line: usize,
    is_known: bool,
    known: impl Iterator<Item = &'a String>,
) -> Result<(), ConfigError> {
    match is_known {
        true => Ok(()),
        false => Err(ConfigError::Undefined {
            line,
            what,
            name: name.to_owned(),
            known: known.cloned().collect(),
        }),
    }
}

/// Checks that no name is defined twice.
fn unique<'a>(
    what: &'static str,
    names: impl Iterator<Item = (&'a String, usize)>,
) -> Result<(), ConfigError> {
    let mut seen = BTreeSet::new();
    for (name, line) in names {
        if !seen.insert(name) {
            return Err(ConfigError::Twice { line, what, name: name.clone() });
        }
    }
    Ok(())
}
