//! The settings under `[mapping]`: methods for all fields, or for one.

use super::settled::Settings;
use crate::map::Method;
use proto::field::FieldKind;
use serde_json::Value as Json;
use std::collections::BTreeMap;

/// The word for the method that suits the field.
pub(super) const AUTO: &str = "auto";

/// The words of a method in a case.
pub(super) fn words() -> Vec<&'static str> {
    std::iter::once(AUTO).chain(Method::ALL.map(Method::name)).collect()
}

/// How fields come to a consumer whose grid does not match.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Mappings {
    /// For every field; `None` for the one that suits it.
    pub method: Option<Method>,
    /// For single fields, by name; `None` for the one that suits it.
    pub fields: BTreeMap<String, Option<Method>>,
}

impl Mappings {
    /// The method for a field.
    #[must_use]
    pub fn method_of(&self, field: &FieldKind) -> Method {
        let chosen = self.fields.get(&field.name).unwrap_or(&self.method);
        chosen.unwrap_or_else(|| Method::suited_to(field.mapping))
    }
}

impl Settings<'_> {
    pub(super) fn mappings(&self) -> Mappings {
        let word = |key: &str| self.0.get(key).and_then(Json::as_str);
        let fields = self.0.get("mapping.fields").and_then(Json::as_object);
        let names = fields.into_iter().flat_map(|fields| fields.keys());
        let own = |name: &String| {
            let method = word(&format!("mapping.fields.{name}.method"))?;
            Some((name.clone(), Method::from_name(method)))
        };
        Mappings {
            method: word("mapping.method").and_then(Method::from_name),
            fields: names.filter_map(own).collect(),
        }
    }
}
