//! The case of a configuration.
//!
//! Each participant becomes a table with the command that starts it. Windows, scheme, acceleration,
//! tolerances and mappings become keys of the case. Everything that has no counterpart, or a
//! different one, becomes a [`Note`].

mod acceleration;
mod coupling;
mod mapping;
mod output;
mod participants;
mod source;
mod tables;
mod time;

use crate::configuration::Configuration;
use crate::error::visible;
use crate::notes::{Note, NoteKind};
use source::Source;
pub use source::{ImportOptions, Refusal};
use tables::{Tables, comment, text};
use thiserror::Error;

/// A case and the notes on it.
#[derive(Clone, Debug, PartialEq)]
pub struct Import {
    /// Text of the case file. The notes are in the comments at its beginning.
    pub text: String,
    /// Notes, by kind and line.
    pub notes: Vec<Note>,
}

/// Reason why there is no case.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ImportError {
    /// The configuration has no scheme.
    #[error(
        "the configuration has no <coupling-scheme:…>; add one with the participants to couple"
    )]
    NoScheme,
    /// A command is for a participant that is not in the configuration.
    #[error(
        "the configuration has no participant \"{name}\"; its participants are: {}",
        .known.join(", ")
    )]
    Participant {
        /// Name.
        name: String,
        /// Participants of the configuration.
        known: Vec<String>,
    },
}

/// Returns the case of a configuration.
///
/// # Errors
/// Fails if the configuration has no coupling scheme, and if a command is for an unknown
/// participant.
pub fn case_of(
    configuration: &Configuration,
    options: &ImportOptions,
) -> Result<Import, ImportError> {
    let known = || configuration.participants.iter().map(|one| one.name.clone()).collect();
    let named = options.commands.keys().chain(options.directories.keys());
    let unknown = named.into_iter().find(|name| configuration.participant(name).is_none());
    if let Some(name) = unknown {
        return Err(ImportError::Participant { name: name.clone(), known: known() });
    }
    let mut source = Source::new(configuration, options).ok_or(ImportError::NoScheme)?;
    let mut tables = Tables::default();
    tables.open("case");
    tables.key("name", text(&options.name));
    tables.key("title", text(&title(configuration)));
    participants::write(&mut source, &mut tables);
    time::write(&mut source, &mut tables);
    coupling::write(&mut source, &mut tables);
    mapping::write(&mut source, &mut tables);
    output::write(&mut source, &mut tables);
    source.remaining();
    source.refusals();
    let notes = source.notes.into_list();
    Ok(Import { text: format!("{}{}", heading(options, &notes), tables.finish()), notes })
}

/// Returns a title that names the participants.
fn title(configuration: &Configuration) -> String {
    let names: Vec<String> =
        configuration.participants.iter().map(|one| visible(&one.name)).collect();
    match names.as_slice() {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// Returns the comments at the beginning of the case.
fn heading(options: &ImportOptions, notes: &[Note]) -> String {
    let path = visible(&options.path);
    let mut heading =
        comment("# ", "# ", &format!("Imported from {path}, a configuration of preCICE."));
    for kind in NoteKind::ALL {
        let mut of_kind = notes.iter().filter(|note| note.kind == kind).peekable();
        if of_kind.peek().is_some() {
            heading += &format!("#\n# {}:\n", kind.heading());
        }
        of_kind.for_each(|note| heading += &comment("# - ", "#   ", &note.to_string()));
    }
    heading
}
