//! Checks of the content of a recording, which may come from anywhere. Names obey the same rule as
//! in messages, grids are checked like those of a participant, and lengths are limited to those of
//! a recording.

use super::{CONTROL, FILES, Head, LONGEST_RECORD, STATE};
use crate::field::GEOMETRY;
use crate::grid::{Grid, check_dotted, check_name};
use crate::message::{FieldHeader, MAX_INPUTS, MOST_PARTICIPANTS, Topics};
use crate::text::{check_line, check_lines, one_line};

/// Maximum number of components of a field.
const MOST_COMPONENTS: u32 = 64;
/// Maximum number of topics of a participant.
const MOST_OUTPUTS: usize = 256;

/// Checks a head.
pub(super) fn head(head: &Head) -> Result<(), String> {
    check_lines("head", head)?;
    let count = head.participants.len();
    if count > MOST_PARTICIPANTS {
        return Err(format!("{count} participants, at most {MOST_PARTICIPANTS} are allowed"));
    }
    for (index, one) in head.participants.iter().enumerate() {
        let role = &one.role;
        check_name("role", role)?;
        if head.participants[..index].iter().any(|other| other.role == *role) {
            return Err(format!("two participants play `{role}`"));
        }
        one.description.check().map_err(|fault| format!("participant `{role}`: {fault}"))?;
        if one.program.contains('/') {
            return Err(format!("the program of `{role}`, `{}`, is a path", one.program));
        }
    }
    match head.files.iter().find(|file| !file.attachment.starts_with(FILES)) {
        Some(file) => {
            Err(format!("the file of `{}` is attached as `{}`", file.key, file.attachment))
        }
        None => Ok(()),
    }
}

/// Checks the name of a channel.
pub(super) fn channel(name: &str) -> Result<(), String> {
    let parts: Vec<&str> = name.split('/').collect();
    let known = match parts.as_slice() {
        [control] => *control == CONTROL,
        ["state", _] | ["geometry", _, _] | ["field", _, _] => true,
        ["field", sender, _, _] => *sender == "coordinator",
        _ => false,
    };
    if !known {
        let shown: String = one_line(name).chars().take(80).collect();
        return Err(format!("a channel `{shown}`, which does not belong to a recording"));
    }
    parts.iter().try_for_each(|part| check_dotted("channel's", part))
}

/// Checks the label of a sample from a valid channel.
pub(super) fn label(channel: &str, header: &FieldHeader) -> Result<(), String> {
    let [name, producer, grid] =
        [header.name.as_str(), header.producer.as_str(), header.grid.as_str()];
    check_dotted("field", name)?;
    check_name("producer", producer)?;
    check_name("grid", grid)?;
    if !(1..=MOST_COMPONENTS).contains(&header.components) {
        return Err(format!("{} components", header.components));
    }
    let unit = header.unit.as_str();
    if !unit.is_ascii() || unit.contains(|c: char| c.is_control()) {
        return Err(format!("the unit {unit:?}"));
    }
    let mut parts = channel.split('/');
    let (kind, sender, subject) = (parts.next(), parts.next(), parts.next());
    let expected = match kind {
        Some("geometry") => (name == GEOMETRY.name).then_some(grid),
        _ => Some(name),
    };
    match sender == Some(producer) && subject == expected {
        true => Ok(()),
        false => Err(format!("the label `{name}` from `{producer}` on `{grid}`")),
    }
}

/// Checks the topics of a participant.
pub(super) fn topics(topics: &Topics) -> Result<(), String> {
    let Topics { inputs, outputs, geometry, .. } = topics;
    if inputs.len() > MAX_INPUTS || outputs.len().max(geometry.len()) > MOST_OUTPUTS {
        return Err(format!("{} inputs and {} outputs", inputs.len(), outputs.len()));
    }
    for topic in inputs.iter().chain(outputs) {
        check_dotted("field", &topic.field)?;
        grid(&topic.grid)?;
    }
    if let Some(topic) = inputs.iter().find(|topic| topic.grid.only_written()) {
        return Err(format!("the input `{}` on a volume or at points", topic.field));
    }
    for topic in geometry {
        check_name("grid", &topic.grid)?;
    }
    let moving = inputs.iter().chain(outputs).filter_map(|topic| topic.geometry.as_ref());
    let services = inputs.iter().chain(outputs).map(|topic| &topic.service).chain(moving);
    let own = geometry.iter().map(|topic| &topic.service);
    services.chain(own).try_for_each(|service| match service.starts_with(STATE) {
        true => Err(format!("the topic `{service}`")),
        false => channel(service),
    })
}

/// Checks a grid more strictly than for a run, because its samples must fit into a recording.
fn grid(grid: &Grid) -> Result<(), String> {
    grid.check()?;
    match grid.points() {
        points if points > LONGEST_RECORD / 8 => Err(format!(
            "grid `{}` has {points} points: no recording holds a field on it",
            grid.name
        )),
        _ => Ok(()),
    }
}

/// Checks the name of an attachment.
pub(super) fn attachment(name: &str) -> Result<(), String> {
    check_line("an attachment", name)
}
