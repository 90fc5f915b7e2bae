//! Second step of a validation: the values of a case with their defaults, before the rules between
//! keys are checked.

use super::alternatives::groups;
use super::checked_keys::{CheckedKeys, Columns, Faults, LiveKey, Scope, put};
use super::known::{Instance, Keys};
use contract::description::KeyKind;
use contract::params::Params;
use serde_json::{Map, Value as Json};
use std::collections::BTreeMap;

/// A case in which every key that is read has a value, unless it is reported as missing.
pub(super) struct FilledCase<'a> {
    pub(super) scope: Scope<'a>,
    pub(super) keys: &'a Keys<'a>,
    /// Accepted values and defaults, in SI units.
    pub(super) values: Params,
    /// The columns of tables that keys refer to.
    pub(super) columns: Columns,
    /// Values that are set from outside, by key.
    pub(super) live: BTreeMap<String, LiveKey>,
    /// Probable targets of misspelt keys. They are not reported as missing as well.
    pub(super) meant: Vec<String>,
    pub(super) faults: Faults<'a>,
}

impl<'a> FilledCase<'a> {
    /// Fills in the defaults of active keys, and an empty table for every active effect without
    /// parameters.
    pub(super) fn of(written: CheckedKeys<'a>, keys: &'a Keys<'a>) -> Self {
        let CheckedKeys { scope, mut values, columns, live, meant, faults, not_judged: _ } =
            written;
        fill_defaults(&mut values, &keys.active);
        for effect in scope.selection.effects.iter().filter(|e| !e.contains('.')) {
            let key = format!("effects.{effect}");
            if scope.is_section(&key) && !values.has(&key) {
                put(&mut values.0, &key, Json::Object(Map::new()));
            }
        }
        Self { scope, keys, values, columns, live, meant, faults }
    }
}

/// Fills in the defaults of keys without a value; of alternatives, only those of the given one.
pub(super) fn fill_defaults(values: &mut Params, active: &[Instance<'_>]) {
    let groups = groups(active);
    for instance in active {
        let Some(default) = &instance.known.spec.default else { continue };
        let group = groups.iter().find_map(|group| group.alternative_of(&instance.path));
        let chosen = group.is_none_or(|a| a.members.iter().any(|key| values.has(key)));
        if chosen && !values.has(&instance.path) {
            let quantity = matches!(instance.known.spec.kind, KeyKind::Quantity { .. });
            let number = default.as_f64().filter(|_| quantity).map(Json::from);
            put(&mut values.0, &instance.path, number.unwrap_or_else(|| default.clone()));
        }
    }
}
