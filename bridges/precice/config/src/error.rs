//! Errors of a configuration, with their lines.

use thiserror::Error;

/// Reason why a text is no configuration.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ConfigError {
    /// The text is longer than any configuration.
    #[error("the configuration has {bytes} bytes, at most {most} are read")]
    Size {
        /// Length of the text.
        bytes: usize,
        /// Largest length.
        most: usize,
    },
    /// Elements are nested too deep.
    #[error("line {line}: elements are nested more than {most} deep")]
    Depth {
        /// Line of the first element that is too deep.
        line: usize,
        /// Largest depth.
        most: usize,
    },
    /// Elements have too many different prefixes.
    #[error("line {line}: more than {most} different prefixes of elements")]
    Prefixes {
        /// Line of the first prefix that is too much.
        line: usize,
        /// Largest number.
        most: usize,
    },
    /// The text is not XML.
    #[error("line {line}: not XML: {reason}")]
    Xml {
        /// Line at which reading stopped.
        line: usize,
        /// Reason from the XML parser.
        reason: String,
    },
    /// The root element has another name.
    #[error(
        "line {line}: the root element is <{found}>, not <precice-configuration>{}",
        of_version_two(.found)
    )]
    Root {
        /// Line of the root element.
        line: usize,
        /// Name of the root element.
        found: String,
    },
    /// A required attribute is absent.
    #[error("line {line}: <{element}> has no attribute `{attribute}`")]
    Attribute {
        /// Line of the element.
        line: usize,
        /// Name of the element.
        element: String,
        /// Name of the attribute.
        attribute: &'static str,
    },
    /// The value of an attribute cannot be read.
    #[error("line {line}: <{element}>: {attribute}=\"{value}\" is not {expected}")]
    Value {
        /// Line of the element.
        line: usize,
        /// Name of the element.
        element: String,
        /// Name of the attribute.
        attribute: &'static str,
        /// Value of the attribute, shortened.
        value: String,
        /// Kind of value that is expected.
        expected: String,
    },
    /// A required element is absent.
    #[error("line {line}: <{element}> has no element <{child}>")]
    Element {
        /// Line of the surrounding element.
        line: usize,
        /// Name of the surrounding element.
        element: String,
        /// Name of the absent element.
        child: &'static str,
    },
    /// An element occurs twice where one is allowed.
    #[error("line {line}: <{element}> has a second <{child}>; remove one of them")]
    Repeated {
        /// Line of the second one.
        line: usize,
        /// Name of the surrounding element.
        element: String,
        /// Name of the repeated element.
        child: String,
    },
    /// An element has too many attributes.
    #[error("line {line}: an element has more than {most} attributes")]
    Attributes {
        /// Line of the element.
        line: usize,
        /// Largest number.
        most: usize,
    },
    /// A defined name is used where it does not belong.
    #[error("line {line}: {reason}")]
    Misplaced {
        /// Line of the use.
        line: usize,
        /// Reason and fix.
        reason: String,
    },
    /// A name is defined twice.
    #[error("line {line}: the {what} \"{name}\" is defined a second time; rename one of them")]
    Twice {
        /// Line of the second definition.
        line: usize,
        /// Kind of thing.
        what: &'static str,
        /// Name.
        name: String,
    },
    /// A name is used but not defined.
    #[error("line {line}: the {what} \"{name}\" is not defined; defined are: {}", list(.known))]
    Undefined {
        /// Line of the use.
        line: usize,
        /// Kind of thing.
        what: &'static str,
        /// Name.
        name: String,
        /// Names that are defined.
        known: Vec<String>,
    },
    /// A mesh does not carry some data.
    #[error(
        "line {line}: the mesh \"{mesh}\" has no data \"{data}\"; \
         add <use-data name=\"{data}\" /> to the mesh"
    )]
    DataOfMesh {
        /// Line of the use.
        line: usize,
        /// Mesh.
        mesh: String,
        /// Data.
        data: String,
    },
    /// A participant uses a mesh that it neither provides nor receives.
    #[error(
        "line {line}: the participant \"{participant}\" neither provides nor receives the mesh \
         \"{mesh}\"; add <provide-mesh name=\"{mesh}\" />, or <receive-mesh /> with the participant \
         that provides the mesh"
    )]
    MeshOfParticipant {
        /// Line of the use.
        line: usize,
        /// Participant.
        participant: String,
        /// Mesh.
        mesh: String,
    },
}

/// Returns a hint if the root element is that of an older configuration.
fn of_version_two(found: &str) -> &'static str {
    match found {
        "solver-interface" => "; configurations of version 2 have this root",
        _ => "",
    }
}

/// Returns a list of names, of which the first twenty are shown.
fn list(names: &[String]) -> String {
    const SHOWN: usize = 20;
    let shown: Vec<&str> = names.iter().take(SHOWN).map(String::as_str).collect();
    match (names.len(), shown.join(", ")) {
        (0, _) => "none".to_owned(),
        (many, text) if many > SHOWN => format!("{text}, and {} more", many - SHOWN),
        (_, text) => text,
    }
}

/// Returns the start of a name or a value for a message.
pub(crate) fn shown(text: &str) -> String {
    beginning(text, 60)
}

/// Returns the start of a text of the configuration for a message.
pub(crate) fn beginning(text: &str, most: usize) -> String {
    match text.char_indices().nth(most) {
        Some((end, _)) => visible(&text[..end]) + "…",
        None => visible(text),
    }
}

/// Returns whether a character changes a line of a message, or cannot be seen in it.
pub(crate) fn is_hidden(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}')
}

/// Returns a text with a question mark for each hidden character.
pub(crate) fn visible(text: &str) -> String {
    text.chars().map(|c| if is_hidden(c) { '?' } else { c }).collect()
}
