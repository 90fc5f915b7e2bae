//! Case values, checked against the specifications that the description publishes.
//!
//! A coordinator has normally checked all values already. A participant that is started otherwise
//! refuses the same values, because both read the same [`KeySpec`].

use proto::configuration::Refusal;
use proto::description::{KeyKind, KeySpec};
use proto::params::Params;
use std::borrow::Cow;

/// Case values together with the specifications of the keys that may be read.
pub(crate) struct CheckedParams<'a> {
    params: &'a Params,
    specs: Cow<'a, [KeySpec]>,
}

impl<'a> CheckedParams<'a> {
    /// Selects the values of `params` that `specs` describe.
    pub(crate) fn new(params: &'a Params, specs: impl Into<Cow<'a, [KeySpec]>>) -> Self {
        Self { params, specs: specs.into() }
    }

    /// Reads a number in SI units, or its default; refuses a value that is missing or out of range.
    pub(crate) fn number(&self, key: &str) -> Result<f64, Refusal> {
        self.maybe_number(key)?.ok_or_else(|| missing(key))
    }

    /// Reads a number in SI units, or its default, if there is one; refuses a value out of range.
    pub(crate) fn maybe_number(&self, key: &str) -> Result<Option<f64>, Refusal> {
        let spec = self.spec(key);
        let value = self.params.maybe_number(key)?;
        let value = value.or_else(|| spec.default.as_ref().and_then(serde_json::Value::as_f64));
        value.map(|number| in_range(key, spec, number)).transpose()
    }

    /// Reads a number or a list of numbers in SI units, if there is one; refuses an empty list and
    /// values out of range.
    pub(crate) fn maybe_numbers(&self, key: &str) -> Result<Option<Vec<f64>>, Refusal> {
        let Some(serde_json::Value::Array(items)) = self.params.get(key) else {
            return Ok(self.maybe_number(key)?.map(|value| vec![value]));
        };
        let spec = self.spec(key);
        let number = |item: &serde_json::Value| match item.as_f64() {
            Some(number) if number.is_finite() => in_range(key, spec, number),
            _ => {
                let reason = format!("{item} is not a finite number");
                Err(Refusal::new(key, reason, "write a list of numbers"))
            }
        };
        if items.is_empty() {
            return Err(Refusal::new(key, "the list is empty", "write a list of numbers"));
        }
        items.iter().map(number).collect::<Result<_, _>>().map(Some)
    }

    /// Reads an integer, or its default; refuses a value that is missing or out of range.
    pub(crate) fn integer(&self, key: &str) -> Result<i64, Refusal> {
        let spec = self.spec(key);
        let default = spec.default.as_ref().and_then(serde_json::Value::as_i64);
        let value = match default {
            Some(default) if !self.params.has(key) => default,
            _ => self.params.integer(key)?,
        };
        in_range(key, spec, value as f64).map(|_| value)
    }

    /// Reads a text or a choice, or its default; refuses a value that is missing or not one of the
    /// choices.
    pub(crate) fn text(&self, key: &str) -> Result<&str, Refusal> {
        let spec = self.spec(key);
        let default = spec.default.as_ref().and_then(serde_json::Value::as_str);
        let value = match default {
            Some(default) if !self.params.has(key) => default,
            _ => self.params.text(key)?,
        };
        match &spec.kind {
            KeyKind::Choice { of } if !of.iter().any(|word| word == value) => Err(Refusal::new(
                key,
                format!("`{value}` is not a choice"),
                format!("write one of {}", of.join(", ")),
            )),
            _ => Ok(value),
        }
    }

    /// Returns true if the case itself contains the key; defaults do not count.
    pub(crate) fn has(&self, key: &str) -> bool {
        self.params.has(key)
    }

    fn spec(&self, key: &str) -> &KeySpec {
        let spec = self.specs.iter().find(|spec| matches(&spec.path, key));
        spec.expect("every key that is read is in the list of specifications")
    }
}

/// Returns true if a dotted key matches a path, in which `*` stands for any one name.
fn matches(path: &str, key: &str) -> bool {
    let (mut path, mut key) = (path.as_bytes(), key.as_bytes());
    // Compares byte by byte, which is fast: a history searches its keys for every row, and most
    // paths differ early.
    while let [first, rest @ ..] = path {
        let taken = match first {
            b'*' => key.iter().take_while(|byte| **byte != b'.').count(),
            _ if key.first() == Some(first) => 1,
            _ => return false,
        };
        (path, key) = (rest, &key[taken..]);
    }
    key.is_empty()
}

fn missing(key: &str) -> Refusal {
    Refusal::new(key, "missing", format!("add `{key}`"))
}

fn in_range(key: &str, spec: &KeySpec, value: f64) -> Result<f64, Refusal> {
    let unit = match &spec.kind {
        KeyKind::Quantity { unit } if unit != "1" => format!(" {unit}"),
        _ => String::new(),
    };
    let refuse = |bound: &str, limit: f64| {
        let reason = format!("{value}{unit} is not {bound} {limit}{unit}");
        Err(Refusal::new(key, reason, format!("write a value {bound} {limit}{unit}")))
    };
    match (spec.above, spec.at_least, spec.at_most) {
        (Some(limit), _, _) if value <= limit => refuse("above", limit),
        (_, Some(limit), _) if value < limit => refuse("at least", limit),
        (_, _, Some(limit)) if value > limit => refuse("at most", limit),
        _ => Ok(value),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn specs() -> Vec<KeySpec> {
        vec![
            KeySpec::quantity("materials.*.stiffness", "Pa", "").above(0.0).at_most(5.0),
            KeySpec::integer("grid.count", "").at_least(2.0).default_value(7),
            KeySpec::choice("law", &["one", "two"], "").default_value("two"),
        ]
    }

    #[test]
    fn values_defaults_and_ranges() {
        let params = Params(json!({"materials": {"steel": {"stiffness": 3.0}}}));
        let case = CheckedParams::new(&params, specs());
        assert_eq!(case.number("materials.steel.stiffness"), Ok(3.0));
        assert_eq!(case.maybe_number("materials.wood.stiffness"), Ok(None));
        assert_eq!(case.integer("grid.count"), Ok(7));
        assert_eq!(case.text("law"), Ok("two"));
        assert_eq!(case.number("materials.wood.stiffness").unwrap_err().reason, "missing");
    }

    #[test]
    fn a_refusal_names_key_reason_and_fix() {
        let params = Params(json!({
            "materials": {"soft": {"stiffness": 0.0}, "hard": {"stiffness": 6.0}},
            "grid": {"count": 1}, "law": "three",
        }));
        let case = CheckedParams::new(&params, specs());
        let soft = case.number("materials.soft.stiffness").unwrap_err();
        assert_eq!(soft.key, "materials.soft.stiffness");
        assert_eq!(soft.reason, "0 Pa is not above 0 Pa");
        assert_eq!(soft.fix, "write a value above 0 Pa");
        assert!(case.number("materials.hard.stiffness").unwrap_err().reason.contains("at most 5"));
        assert!(case.integer("grid.count").unwrap_err().reason.contains("at least 2"));
        assert!(case.text("law").unwrap_err().fix.contains("one, two"));
    }
}
