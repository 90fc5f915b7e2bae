//! What a study varies: a key of the case and its values.

use run::error::RunError;

/// A key and the values it takes, one run after the other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Axis {
    /// Dotted key of the case.
    pub key: String,
    /// TOML values.
    pub values: Vec<String>,
}

impl Axis {
    /// Reads `key=v1,v2,…`; a comma within brackets, braces or quotes belongs to its value.
    ///
    /// # Errors
    /// No key, or no value between two commas.
    pub(crate) fn parse(option: &str) -> Result<Self, RunError> {
        let wrong = || {
            let fix = "write --vary key=v1,v2";
            RunError::Usage(format!("`--vary {option}` names no key with values; {fix}"))
        };
        let (key, list) = option.split_once('=').ok_or_else(wrong)?;
        let values: Vec<String> = split(list).iter().map(|text| text.trim().to_owned()).collect();
        if key.trim().is_empty() || values.iter().any(String::is_empty) {
            return Err(wrong());
        }
        Ok(Self { key: key.trim().to_owned(), values })
    }
}

/// Splits at the commas that stand outside of brackets, braces and quotes.
fn split(list: &str) -> Vec<String> {
    let mut parts = vec![String::new()];
    let (mut depth, mut quote) = (0i32, None);
    for c in list.chars() {
        match (quote, c) {
            (Some(open), _) if c == open => quote = None,
            (Some(_), _) => {}
            (None, '"' | '\'') => quote = Some(c),
            (None, '[' | '{') => depth += 1,
            (None, ']' | '}') => depth -= 1,
            (None, ',') if depth == 0 => {
                parts.push(String::new());
                continue;
            }
            (None, _) => {}
        }
        parts.last_mut().expect("there is one from the start").push(c);
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_parted_at_outer_commas() {
        let axis = Axis::parse("a.b= 1, [2, 3],{ x = 4, y = 5 },\"six, seven\"").unwrap();
        assert_eq!(axis.key, "a.b");
        assert_eq!(axis.values, ["1", "[2, 3]", "{ x = 4, y = 5 }", "\"six, seven\""]);
    }

    #[test]
    fn an_axis_without_key_or_value_is_refused() {
        for wrong in ["a", "=1", "a=", "a=1,,2", "a=1,"] {
            assert!(Axis::parse(wrong).unwrap_err().to_string().contains("--vary key=v1,v2"));
        }
    }
}
