//! Sections of `summary.json`.

use serde_json::Value;

/// Adds the keys of one object to another.
pub(super) fn extend(section: &mut Value, more: Value) {
    if let (Value::Object(section), Value::Object(more)) = (section, more) {
        section.extend(more);
    }
}
