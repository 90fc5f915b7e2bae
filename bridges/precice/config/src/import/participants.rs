//! Tables of the participants, with the commands that start them.

use super::source::Source;
use super::tables::{Tables, list, text};
use crate::names::{self, MODEL, PROGRAM};
use crate::notes::NoteKind;
use crate::participant::{MeshData, Participant};

/// Writes the table of every participant.
pub(super) fn write(source: &mut Source<'_>, tables: &mut Tables) {
    let configuration = source.configuration;
    for (place, name) in source.order.clone().into_iter().enumerate() {
        let Some(participant) = configuration.participant(name) else { continue };
        let role = source.names.role(name).to_owned();
        match place {
            0 => tables.open_apart(&role),
            _ => tables.open(&role),
        }
        let command = command(source, participant, &role);
        let wire = |word: &str| word == "--wire" || word == "--";
        tables.key("model", text(MODEL));
        tables.key("command", list(&command, wire));
        meshes(source, participant);
        others(source, participant);
    }
}

/// Returns the words of the command.
fn command(source: &mut Source<'_>, participant: &Participant, role: &str) -> Vec<String> {
    let name = &participant.name;
    let mut words: Vec<String> =
        [PROGRAM, &source.options.path, "--participant", name].map(str::to_owned).into();
    if role != names::role(name) {
        words.extend(["--role", role].map(str::to_owned));
    }
    for wire in wires(source, participant) {
        words.extend(["--wire".to_owned(), wire]);
    }
    if let Some(directory) = source.options.directories.get(name) {
        words.extend(["--directory", directory].map(str::to_owned));
    }
    words.push("--".to_owned());
    match source.options.commands.get(name).filter(|words| !words.is_empty()) {
        Some(program) => words.extend(program.iter().cloned()),
        None => {
            let word = names::placeholder(name);
            let reason = format!("the configuration does not name the program of {name}");
            let instead = format!(
                "write it in place of \"{word}\" in [{role}], or import with --command; the folder \
                 in which it runs is an option of precice-participant, --directory"
            );
            let element = "participant";
            let instead = Some(instead.as_str());
            source.notes.advise(NoteKind::Todo, participant.line, element, reason, instead);
            words.push(word);
        }
    }
    words
}

/// Returns the wires of data whose fields have other names.
fn wires(source: &mut Source<'_>, participant: &Participant) -> Vec<String> {
    let mut wires = Vec::new();
    for data in distinct(source, &participant.writes, "write-data") {
        let Some(field) = source.names.field(data, &participant.name) else { continue };
        if field != data {
            wires.push(format!("{} -> {field}", names::quoted(data)));
        }
        if source.options.reserved.iter().any(|reserved| *reserved == names::field(data)) {
            let line = participant.writes.iter().find(|one| one.data == data).map_or(0, |w| w.line);
            let reason = format!("`{data}` becomes `{field}`: a case has a field of this name");
            let instead =
                format!("wire it to {} if it is that field, in its unit", names::field(data));
            source.notes.advise(NoteKind::Changed, line, "write-data", reason, Some(&instead));
        }
    }
    for data in distinct(source, &participant.reads, "read-data") {
        let line = participant.reads.iter().find(|read| read.data == data).map_or(0, |r| r.line);
        let mut senders: Vec<&str> = Vec::new();
        for exchange in source.exchanges() {
            let sent = exchange.data == data && exchange.to == participant.name;
            if sent && !senders.contains(&exchange.from.as_str()) {
                senders.push(&exchange.from);
            }
        }
        if let [first, other, ..] = senders.as_slice() {
            let reason =
                format!("`{data}` comes from {first} and from {other}, and only the first is read");
            let instead = Some("give the data different names");
            source.notes.advise(NoteKind::Missing, line, "read-data", reason, instead);
        }
        let Some(field) = senders.first().and_then(|sender| source.names.field(data, sender))
        else {
            let reason = format!("no participant sends `{data}`");
            let instead = Some("remove it, or add an exchange; the plan fails without a sender");
            source.notes.advise(NoteKind::Todo, line, "read-data", reason, instead);
            continue;
        };
        if field != data {
            wires.push(format!("{} <- {field}", names::quoted(data)));
        }
    }
    wires
}

/// Returns the names of data without repetitions, and notes data on several meshes.
fn distinct<'b>(source: &mut Source<'_>, used: &'b [MeshData], element: &str) -> Vec<&'b str> {
    let mut names: Vec<&str> = Vec::new();
    for one in used {
        if names.contains(&one.data.as_str()) {
            let reason = format!("`{}` is used on several meshes, and a field has one", one.data);
            let instead = Some("give the data of each mesh a name of their own");
            source.notes.advise(NoteKind::Todo, one.line, element, reason, instead);
        } else {
            names.push(&one.data);
        }
    }
    names
}

/// Notes the use of meshes of other participants.
fn meshes(source: &mut Source<'_>, participant: &Participant) {
    let notes = &mut source.notes;
    for (element, used) in [("read-data", &participant.reads), ("write-data", &participant.writes)]
    {
        for one in used.iter().filter(|one| !participant.provides(&one.mesh)) {
            let reason = format!("{} is a mesh of another participant (direct access)", one.mesh);
            let instead = Some("use a mesh of its own, with a mapping");
            notes.advise(NoteKind::Todo, one.line, element, reason, instead);
        }
    }
    for received in participant.receives.iter().filter(|received| received.safety_factor != 0.5) {
        let reason = "meshes are received as a whole";
        notes.add(NoteKind::Unneeded, received.line, "receive-mesh, safety-factor", reason);
    }
}

/// Notes actions, watches and the communication within a participant.
fn others(source: &mut Source<'_>, participant: &Participant) {
    let notes = &mut source.notes;
    for action in &participant.actions {
        let targets = action.targets.join(", ");
        let reason = format!("no action changes `{targets}` on {}", action.mesh);
        let instead = Some("change the values in the program");
        notes.advise(
            NoteKind::Missing,
            action.line,
            format!("action:{}", action.kind),
            reason,
            instead,
        );
    }
    for watch in &participant.watches {
        let reason = "no file of single values is written";
        let instead = Some("evaluate the fields in the result folder (output.every = 1)");
        notes.advise(NoteKind::Missing, watch.line, &watch.element, reason, instead);
    }
    if let Some(line) = participant.intra_comm {
        let reason = "the processes of a program use its own communication";
        notes.add(NoteKind::Unneeded, line, "intra-comm", reason);
    }
}
