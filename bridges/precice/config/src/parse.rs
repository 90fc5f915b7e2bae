//! The text of a configuration: read as XML within limits, and checked as a whole.

use crate::configuration::Configuration;
use crate::consistency;
use crate::element::Element;
use crate::error::{ConfigError, beginning, shown};
use crate::markup;
use roxmltree::{Document, ParsingOptions};

/// Largest number of elements, attributes and texts.
const MOST_NODES: u32 = 100_000;
/// Longest reason of the XML parser, which may quote a name [character].
const LONGEST_REASON: usize = 200;

impl Configuration {
    /// Parses the text of a configuration.
    ///
    /// # Errors
    /// Fails if the text is not XML or exceeds a limit, if a required attribute is absent or has an
    /// unreadable value, and if a name is used that is not defined.
    pub fn parse(text: &str) -> Result<Self, ConfigError> {
        let text = markup::declared(text)?;
        let options = ParsingOptions { allow_dtd: false, nodes_limit: MOST_NODES };
        let document = Document::parse_with_options(&text, options).map_err(|error| {
            let place = error.pos();
            let line = usize::try_from(place.row).unwrap_or(1);
            // The column would be that of the text with its prefixes declared.
            let reason = error.to_string().replace(&format!(" at {place}"), "");
            let reason = beginning(&reason, LONGEST_REASON);
            ConfigError::Xml { line, reason }
        })?;
        let root = Element::root(&document);
        if root.name != "precice-configuration" {
            let found = shown(root.name);
            return Err(ConfigError::Root { line: root.line, found });
        }
        let configuration = Self::read(&root)?;
        consistency::check(&configuration)?;
        Ok(configuration)
    }
}
