//! Tags of an XML text, found without recursion: nesting depth, and prefixes without a declaration.
//!
//! A configuration has elements such as `<data:scalar>`, but declares no namespace `data`. The
//! prefixes are declared on the root element before parsing, within its line, so that the lines of
//! all elements stay the same. The XML parser recurses into elements, so that the depth is checked
//! before, too.

use crate::error::ConfigError;
use std::collections::BTreeSet;
use std::fmt::Write as _;

/// Largest text \[byte\]. The longest public configurations have a hundredth of this length.
pub const LARGEST: usize = 1 << 20;
/// Largest nesting depth of elements.
const DEEPEST: usize = 32;
/// Largest number of prefixes.
const MOST_PREFIXES: usize = 64;
/// Largest number of attributes of an element. The XML parser compares each with all others.
const MOST_ATTRIBUTES: usize = 64;

/// Start and end marks of text that is not an element.
const SKIPPED: [(&str, &str); 4] =
    [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>"), ("<!", ">")];

/// Returns the text with every prefix declared on the root element.
///
/// # Errors
/// Fails if the text exceeds a limit.
pub(crate) fn declared(text: &str) -> Result<String, ConfigError> {
    if text.len() > LARGEST {
        return Err(ConfigError::Size { bytes: text.len(), most: LARGEST });
    }
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let line = |at: usize| 1 + text[..at].matches('\n').count();
    let mut root: Option<(usize, &str)> = None;
    let mut prefixes: BTreeSet<&str> = BTreeSet::new();
    let mut depth = 0_usize;
    for (at, tag) in Tags::new(text) {
        if tag.starts_with("</") {
            depth = depth.saturating_sub(1);
            continue;
        }
        root.get_or_insert((at, tag));
        // The first name is that of the element.
        if names(tag).nth(MOST_ATTRIBUTES + 1).is_some() {
            return Err(ConfigError::Attributes { line: line(at), most: MOST_ATTRIBUTES });
        }
        prefixes.extend(prefixes_of(tag));
        if prefixes.len() > MOST_PREFIXES {
            return Err(ConfigError::Prefixes { line: line(at), most: MOST_PREFIXES });
        }
        if !tag.ends_with("/>") {
            depth += 1;
        }
        if depth > DEEPEST {
            return Err(ConfigError::Depth { line: line(at), most: DEEPEST });
        }
    }
    let Some((at, tag)) = root else { return Ok(text.to_owned()) };
    let own: BTreeSet<&str> = names(tag).filter_map(|name| name.strip_prefix("xmlns:")).collect();
    let end = at + names(tag).next().map_or(1, |name| 1 + name.len());
    let mut whole = text[..end].to_owned();
    for prefix in prefixes.difference(&own) {
        let _ = write!(whole, " xmlns:{prefix}=\"{prefix}\"");
    }
    whole += &text[end..];
    Ok(whole)
}

/// Returns the prefixes of a tag and of its attributes.
fn prefixes_of(tag: &str) -> impl Iterator<Item = &str> {
    let plain = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_' | '.');
    let prefix = names(tag).filter_map(|name| Some(name.split_once(':')?.0));
    prefix.filter(move |prefix| {
        !prefix.is_empty() && prefix.chars().all(plain) && !["xml", "xmlns"].contains(prefix)
    })
}

/// Returns the name of a tag and the names of its attributes.
fn names(tag: &str) -> impl Iterator<Item = &str> {
    let mut quote = None;
    let outside = move |c: char| {
        match (c, quote) {
            ('"' | '\'', None) => quote = Some(c),
            (c, Some(open)) if c == open => quote = None,
            (c, None) => return c.is_whitespace() || matches!(c, '<' | '>' | '/' | '='),
            _ => {}
        }
        false
    };
    let parts = tag.split(outside);
    parts.filter(|part| !part.is_empty() && !part.starts_with(['"', '\'']))
}

/// Tags of a text with their places, up to the first place where the text is no valid XML.
struct Tags<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> Tags<'a> {
    fn new(text: &'a str) -> Self {
        Self { text, at: 0 }
    }
}

impl<'a> Iterator for Tags<'a> {
    type Item = (usize, &'a str);

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let start = self.at + self.text[self.at..].find('<')?;
            let rest = &self.text[start..];
            let skipped = SKIPPED.iter().find(|(begin, _)| rest.starts_with(begin));
            let Some((begin, end)) = skipped else {
                let tag = &rest[..tag_length(rest)];
                self.at = start + tag.len();
                return Some((start, tag));
            };
            let length = rest[begin.len()..].find(end)?;
            self.at = start + begin.len() + length + end.len();
        }
    }
}

/// Returns the length of the tag at the start of `text`. A `>` within quotes does not end the tag.
fn tag_length(text: &str) -> usize {
    let mut quote = None;
    for (place, byte) in text.bytes().enumerate() {
        match (byte, quote) {
            (b'>', None) => return place + 1,
            (b'"' | b'\'', None) => quote = Some(byte),
            (byte, Some(open)) if byte == open => quote = None,
            _ => {}
        }
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prefixes_are_declared_on_the_root() {
        let text = "<?xml version='1.0'?>\n<!-- <x:y/> -->\n<root\n  a='b:c'>\n<data:scalar/>\
                    <data:vector q:r=\"<\"/></root>";
        let expected = text.replace("<root", "<root xmlns:data=\"data\" xmlns:q=\"q\"");
        assert_eq!(declared(text), Ok(expected));
    }

    #[test]
    fn declared_prefixes_stay_as_they_are() {
        for text in ["<r xmlns:data='http://x'><data:a/></r>", "<r xml:lang='en'/>", "no xml", ""] {
            assert_eq!(declared(text).as_deref(), Ok(text));
        }
        let inner = "<r><data:a xmlns:data='x'/></r>";
        assert_eq!(declared(inner), Ok(inner.replace("<r>", "<r xmlns:data=\"data\">")));
    }

    #[test]
    fn the_root_may_have_a_prefix_and_a_byte_order_mark() {
        let expected = "<p:r xmlns:p=\"p\"/>".to_owned();
        assert_eq!(declared("\u{feff}<p:r/>"), Ok(expected));
    }

    #[test]
    fn limits_name_their_lines() {
        let deep = "<a>\n".repeat(DEEPEST + 1);
        assert_eq!(declared(&deep), Err(ConfigError::Depth { line: DEEPEST + 1, most: DEEPEST }));
        assert!(declared(&"<a>".repeat(DEEPEST)).is_ok());
        let many: String = (0..=MOST_PREFIXES).map(|n| format!("<p{n}:a/>\n")).collect();
        let found = ConfigError::Prefixes { line: MOST_PREFIXES + 2, most: MOST_PREFIXES };
        assert_eq!(declared(&format!("<r>\n{many}</r>")), Err(found));
        let long = " ".repeat(LARGEST + 1);
        assert_eq!(declared(&long), Err(ConfigError::Size { bytes: LARGEST + 1, most: LARGEST }));
    }
}
