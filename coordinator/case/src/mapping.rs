//! The settings under `[mapping]`: methods for all fields, or for one.

use super::settings::Settings;
use coupling::map::{Mappings, Method};
use serde_json::Value as Json;

impl Settings<'_> {
    pub(super) fn mappings(&self) -> Mappings {
        let word = |key: &str| self.0.get(key).and_then(Json::as_str);
        let fields = self.0.get("mapping.fields").and_then(Json::as_object);
        let names = fields.into_iter().flat_map(|fields| fields.keys());
        let own = |name: &String| {
            let method = word(&format!("mapping.fields.{name}.method"))?;
            Some((self.field_name(name), Method::from_name(method)))
        };
        Mappings {
            method: word("mapping.method").and_then(Method::from_name),
            fields: names.filter_map(own).collect(),
        }
    }
}
