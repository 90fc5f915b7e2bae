//! Elements of the configuration, with their lines and attributes.

use crate::error::{ConfigError, shortened};
use crate::words::Words;
use roxmltree::{Document, Node};
use std::rc::Rc;

/// An element or an attribute that was not understood.
#[derive(Clone, Debug, PartialEq)]
pub struct Unknown {
    /// Line of the element.
    pub line: usize,
    /// Name of the element.
    pub element: String,
    /// Name of the attribute; `None` if the element itself is unknown.
    pub attribute: Option<String>,
}

/// A value with the line of its element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting<T> {
    /// Value.
    pub value: T,
    /// Line of the element.
    pub line: usize,
}

/// An element. Its name has its prefix: `data:scalar`.
#[derive(Clone, Debug)]
pub(crate) struct Element<'a> {
    node: Node<'a, 'a>,
    lines: Rc<[usize]>,
    /// Name with prefix.
    pub(crate) name: &'a str,
    /// Line of its tag, from 1.
    pub(crate) line: usize,
}

impl<'a> Element<'a> {
    /// Returns the root element.
    pub(crate) fn root(document: &'a Document<'a>) -> Self {
        let text = document.input_text();
        let lines = text.match_indices('\n').map(|(at, _)| at).collect();
        Self::at(document.root_element(), lines)
    }

    fn at(node: Node<'a, 'a>, lines: Rc<[usize]>) -> Self {
        let start = node.range().start;
        let text = node.document().input_text();
        let inside = text.get(start + 1..).unwrap_or_default();
        let end = inside.find(|c: char| c.is_whitespace() || matches!(c, '/' | '>'));
        let name = &inside[..end.unwrap_or(inside.len())];
        let line = 1 + lines.partition_point(|&newline| newline < start);
        Self { node, lines, name, line }
    }

    /// Returns the elements directly inside.
    pub(crate) fn children(&self) -> impl Iterator<Item = Self> {
        let inside = self.node.children().filter(Node::is_element);
        inside.map(|node| Self::at(node, Rc::clone(&self.lines)))
    }

    /// Splits the name into prefix and rest.
    pub(crate) fn split(&self) -> (&'a str, &'a str) {
        self.name.split_once(':').unwrap_or(("", self.name))
    }

    /// Returns the value of an attribute.
    pub(crate) fn optional(&self, attribute: &str) -> Option<&'a str> {
        self.node.attribute(attribute).map(str::trim)
    }

    /// Returns the value of a required attribute.
    pub(crate) fn text(&self, attribute: &'static str) -> Result<String, ConfigError> {
        let value = self.optional(attribute).filter(|value| !value.is_empty());
        value.map(str::to_owned).ok_or_else(|| ConfigError::Attribute {
            line: self.line,
            element: self.name.to_owned(),
            attribute,
        })
    }

    /// Reads an attribute by a function.
    fn parse<T>(
        &self,
        attribute: &'static str,
        expected: impl Fn() -> String,
        read: impl Fn(&str) -> Option<T>,
    ) -> Result<Option<T>, ConfigError> {
        let Some(value) = self.optional(attribute) else { return Ok(None) };
        read(value).map(Some).ok_or_else(|| self.refused(attribute, expected()))
    }

    /// Returns a finite number, which may be a quotient of two: `1/3`.
    pub(crate) fn number(&self, attribute: &'static str) -> Result<Option<f64>, ConfigError> {
        let finite = |text: &str| text.trim().parse().ok().filter(|value: &f64| value.is_finite());
        self.parse(
            attribute,
            || "a finite number".to_owned(),
            |value| {
                let quotient = value.split_once('/');
                let value = match quotient {
                    Some((above, below)) => finite(above)? / finite(below)?,
                    None => finite(value)?,
                };
                value.is_finite().then_some(value)
            },
        )
    }

    /// Returns a whole number.
    pub(crate) fn integer(&self, attribute: &'static str) -> Result<Option<i64>, ConfigError> {
        self.parse(attribute, || "a whole number".to_owned(), |value| value.parse().ok())
    }

    /// Returns a flag, false if the attribute is absent.
    pub(crate) fn flag(&self, attribute: &'static str) -> Result<bool, ConfigError> {
        self.flag_or(attribute, false)
    }

    /// Returns a flag, with its default.
    pub(crate) fn flag_or(
        &self,
        attribute: &'static str,
        default: bool,
    ) -> Result<bool, ConfigError> {
        let read = |value: &str| match value.to_ascii_lowercase().as_str() {
            "true" | "yes" | "on" | "1" => Some(true),
            "false" | "no" | "off" | "0" => Some(false),
            _ => None,
        };
        Ok(self.parse(attribute, || "true or false".to_owned(), read)?.unwrap_or(default))
    }

    /// Returns one of several words.
    pub(crate) fn choice<T: Words>(
        &self,
        attribute: &'static str,
    ) -> Result<Option<T>, ConfigError> {
        let words = || {
            let words: Vec<&str> = T::ALL.iter().map(|(word, _)| *word).collect();
            format!("one of {}", words.join(", "))
        };
        self.parse(attribute, words, T::from_word)
    }

    /// Returns the value of an attribute that is read by one of the functions above and required.
    pub(crate) fn required<T>(
        &self,
        attribute: &'static str,
        value: Option<T>,
    ) -> Result<T, ConfigError> {
        let missing =
            ConfigError::Attribute { line: self.line, element: self.name.to_owned(), attribute };
        value.ok_or(missing)
    }

    /// Returns the attribute `value`, a number above zero.
    pub(crate) fn positive(&self) -> Result<Setting<f64>, ConfigError> {
        let value = self.required("value", self.number("value")?)?;
        match value > 0.0 {
            true => Ok(Setting { value, line: self.line }),
            false => Err(self.refused("value", "a number above 0".to_owned())),
        }
    }

    /// Returns the attribute `value`, a whole number of at least zero.
    pub(crate) fn count(&self) -> Result<Setting<u64>, ConfigError> {
        let value = self.required("value", self.integer("value")?)?;
        let value = u64::try_from(value)
            .map_err(|_| self.refused("value", "a whole number from 0".to_owned()))?;
        Ok(Setting { value, line: self.line })
    }

    /// Returns the error for the value of an attribute.
    fn refused(&self, attribute: &'static str, expected: String) -> ConfigError {
        ConfigError::Value {
            line: self.line,
            element: self.name.to_owned(),
            attribute,
            value: shortened(self.optional(attribute).unwrap_or_default()),
            expected,
        }
    }
}

/// Collection of unknown elements and attributes.
#[derive(Debug, Default)]
pub(crate) struct Strangers(pub(crate) Vec<Unknown>);

impl Strangers {
    /// Collects an unknown element.
    pub(crate) fn element(&mut self, element: &Element<'_>) {
        self.0.push(Unknown {
            line: element.line,
            element: element.name.to_owned(),
            attribute: None,
        });
    }

    /// Collects all attributes of an element that are not known.
    pub(crate) fn attributes(&mut self, element: &Element<'_>, known: &[&str]) {
        for attribute in element.node.attributes() {
            if attribute.namespace().is_some() || !known.contains(&attribute.name()) {
                self.0.push(Unknown {
                    line: element.line,
                    element: element.name.to_owned(),
                    attribute: Some(attribute.name().to_owned()),
                });
            }
        }
    }

    /// Collects all elements inside an element that has none.
    pub(crate) fn children(&mut self, element: &Element<'_>) {
        element.children().for_each(|child| self.element(&child));
    }
}
