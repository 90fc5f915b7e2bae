//! Lines and numbers of a text.

use super::error::ProfileError;
use tables::input_file::into_text;

/// Trimmed lines without comments, numbered from 1; empty lines are omitted.
pub(super) fn lines<'a>(
    text: &'a str,
    comment: &'static [char],
) -> impl Iterator<Item = (usize, &'a str)> {
    let plain = move |line: &'a str| line.split(comment).next().unwrap_or_default().trim();
    let numbered = (1..).zip(text.lines()).map(move |(number, line)| (number, plain(line)));
    numbered.filter(|(_, line)| !line.is_empty())
}

/// Decodes a text and removes a byte order mark.
pub(super) fn decoded(bytes: &[u8]) -> Result<String, ProfileError> {
    into_text(bytes.to_vec()).map_err(|error| ProfileError::NotText(error.to_string()))
}

/// Numbers of a line, separated by blanks, commas, semicolons or quotes; `None` if anything else
/// occurs.
pub(super) fn numbers(line: &str) -> Option<Vec<f64>> {
    let parts = line.split(|c: char| c.is_whitespace() || matches!(c, ',' | ';' | '"'));
    let finite = |part: &str| part.parse::<f64>().ok().filter(|value| value.is_finite());
    parts.filter(|part| !part.is_empty()).map(finite).collect()
}

/// Parses a finite number after `key =`.
pub(super) fn number(line: usize, key: &str, value: &str) -> Result<f64, ProfileError> {
    let value = value.trim();
    let found = value.parse::<f64>().ok().filter(|number| number.is_finite());
    found.ok_or_else(|| ProfileError::line(line, format!("has no number at `{key}`")))
}
