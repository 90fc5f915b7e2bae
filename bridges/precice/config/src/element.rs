//! Elements of the configuration, with their lines and attributes.

use crate::error::{ConfigError, is_hidden, shown};
use crate::words::Words;
use roxmltree::{Document, Node};
use std::rc::Rc;

/// Longest name \[byte\].
const LONGEST_NAME: usize = 255;

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

    /// Returns the name in a required attribute.
    pub(crate) fn text(&self, attribute: &'static str) -> Result<String, ConfigError> {
        let value = self.optional(attribute).filter(|value| !value.is_empty());
        let name = self.required(attribute, value)?;
        if name.len() > LONGEST_NAME || name.contains(is_hidden) {
            let expected =
                format!("a name of at most {LONGEST_NAME} bytes without control characters");
            return Err(self.refused(attribute, expected));
        }
        Ok(name.to_owned())
    }

    /// Checks that elements of these names occur once at most. A name that ends with a colon stands
    /// for all elements with this prefix.
    pub(crate) fn at_most_once(&self, names: &[&str]) -> Result<(), ConfigError> {
        for name in names {
            let same = |child: &Self| {
                child.name == *name || (name.ends_with(':') && child.name.starts_with(name))
            };
            if let Some(second) = self.children().filter(same).nth(1) {
                return Err(ConfigError::Repeated {
                    line: second.line,
                    element: shown(self.name),
                    child: shown(second.name),
                });
            }
        }
        Ok(())
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
        value.ok_or_else(|| ConfigError::Attribute {
            line: self.line,
            element: shown(self.name),
            attribute,
        })
    }

    /// Returns the attribute `value`, a number above zero.
    pub(crate) fn positive(&self) -> Result<Setting<f64>, ConfigError> {
        let value = self.required("value", self.above_zero("value")?)?;
        Ok(Setting { value, line: self.line })
    }

    /// Returns a number above zero.
    pub(crate) fn above_zero(&self, attribute: &'static str) -> Result<Option<f64>, ConfigError> {
        match self.number(attribute)? {
            Some(value) if value <= 0.0 => {
                Err(self.refused(attribute, "a number above 0".to_owned()))
            }
            value => Ok(value),
        }
    }

    /// Returns the attribute `value`, a whole number of at least `least`.
    pub(crate) fn count_from(&self, least: u64) -> Result<Setting<u64>, ConfigError> {
        let value = self.required("value", self.integer("value")?)?;
        let value = u64::try_from(value).ok().filter(|value| *value >= least);
        let value =
            value.ok_or_else(|| self.refused("value", format!("a whole number from {least}")))?;
        Ok(Setting { value, line: self.line })
    }

    /// Returns the error for the value of an attribute.
    pub(crate) fn refused(&self, attribute: &'static str, expected: String) -> ConfigError {
        ConfigError::Value {
            line: self.line,
            element: shown(self.name),
            attribute,
            value: shown(self.optional(attribute).unwrap_or_default()),
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
