//! A case as dotted keys.

use std::collections::BTreeMap;
use toml::Value;

/// Every key of a case with its value, as it is written there; empty for what is no case.
#[must_use]
pub(super) fn case(text: &str) -> BTreeMap<String, String> {
    let mut all = BTreeMap::new();
    if let Ok(table) = toml::from_str::<toml::Table>(text) {
        spread(&Value::Table(table), String::new(), &mut all);
    }
    all
}

fn spread(value: &Value, key: String, all: &mut BTreeMap<String, String>) {
    match value {
        Value::Table(entries) if !entries.is_empty() => {
            for (name, value) in entries {
                let inner = if key.is_empty() { name.clone() } else { format!("{key}.{name}") };
                spread(value, inner, all);
            }
        }
        Value::String(text) => drop(all.insert(key, text.clone())),
        other => drop(all.insert(key, other.to_string())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_spread_and_empty_ones_stay() {
        let all = case("[a]\nb = \"1 kN\"\nc = [1, 2]\n[effects.x]\n[a.d]\ne = 2.5\n");
        let all: Vec<(&str, &str)> = all.iter().map(|(k, v)| (k.as_str(), v.as_str())).collect();
        let expected = [("a.b", "1 kN"), ("a.c", "[1, 2]"), ("a.d.e", "2.5"), ("effects.x", "{}")];
        assert_eq!(all, expected);
        assert!(case("= 3").is_empty());
    }
}
