//! Values that are given from outside as the run goes, in the place of numbers:
//! `{ at = "134 kN", from = "60 kN", to = "140 kN" }`.

use super::check::{Fault, check};
use super::checker::{Checker, put};
use super::example::with_unit;
use super::known::Known;
use super::live_key::LiveKey;
use super::tree::{Node, Table};
use contract::description::KeyKind;
use contract::grid::check_dotted;
use contract::history::Histories;
use contract::live::Live;
use serde_json::Value as Json;
use std::collections::BTreeMap;

/// What a live value says: its first value and its limits.
const ENTRIES: [&str; 3] = ["at", "from", "to"];
/// How it is written.
const FORM: &str = "write { at = \"134 kN\", from = \"60 kN\", to = \"140 kN\" }";

/// The table at a key is a live value.
pub(super) fn is_live(table: &Table) -> bool {
    ENTRIES.iter().any(|entry| table.get(entry).is_some())
}

impl Checker<'_> {
    /// A table at a key that takes a number: a value that is given from outside.
    pub(super) fn live(&mut self, key: &str, node: &Node, table: &Table, readers: &[&Known<'_>]) {
        match self.read_live(key, table, readers) {
            Ok(live) => {
                put(&mut self.values.0, key, Json::from(live.first));
                self.live.insert(key.to_owned(), live);
            }
            Err(Fault { reason, fix }) => self.fault_at_name(node, key, reason, fix),
        }
    }

    fn read_live(
        &self,
        key: &str,
        table: &Table,
        readers: &[&Known<'_>],
    ) -> Result<LiveKey, Fault> {
        let fault = |reason: String, fix: &str| Fault { reason, fix: fix.to_owned() };
        let active: Vec<&&Known<'_>> = readers.iter().filter(|known| known.active).collect();
        let readers = if active.is_empty() { readers.iter().collect() } else { active };
        if let Some(constant) = readers.iter().find(|known| !known.spec.varies) {
            let reason = format!("is a live value, and {} reads one number", constant.owner);
            return Err(fault(reason, "write a number"));
        }
        let Some((known, KeyKind::Quantity { unit })) =
            readers.first().map(|known| (known, &known.spec.kind))
        else {
            return Err(fault("is a table, not a value".to_owned(), "write a value"));
        };
        if let Some((name, _)) =
            table.entries.iter().find(|(name, _)| !ENTRIES.contains(&name.as_str()))
        {
            return Err(fault(format!("unknown key `{name}` of a live value"), FORM));
        }
        let value = |name: &str| {
            let node = table.get(name);
            let node = node.ok_or_else(|| fault(format!("`{name}` is missing"), FORM))?;
            let mut value = Json::Null;
            for known in &readers {
                value =
                    check(known, node, self.case.folder()).map_err(|Fault { reason, fix }| {
                        Fault { reason: format!("`{name}` {reason}"), fix }
                    })?;
            }
            value.as_f64().ok_or_else(|| fault(format!("`{name}` is no number"), FORM))
        };
        let [first, least, most] = [value("at")?, value("from")?, value("to")?];
        if !(least <= first && first <= most) {
            let [first, least, most] = [first, least, most].map(|value| with_unit(value, unit));
            let reason = format!("{first} is not between {least} and {most}");
            return Err(fault(
                reason,
                "write limits that hold the first value, the lower one as `from`",
            ));
        }
        let field = Live::field(key, unit, &known.spec.help);
        check_dotted("live value's", &field.name)
            .map_err(|reason| fault(reason, "write a number"))?;
        Ok(LiveKey { field, first, limits: [least, most] })
    }

    /// The histories of a case with live values; nothing else varies beside them.
    pub(super) fn live_histories(&mut self, columns: bool) -> Option<Histories> {
        let key = self.live.keys().next()?.clone();
        let mode = self.values.get("time.mode").and_then(Json::as_str).unwrap_or("steady");
        let steady = mode == "steady";
        if columns {
            let reason = "is a live value, and other keys are columns of a table";
            self.fault(&key, reason, "make all of them live, or all of them columns");
        } else if mode == "sequence" {
            let reason = "is a live value, and a sequence has the rows of a table";
            let fix =
                "write time.mode = \"steady\": driven from outside it is a row for every window";
            self.fault(&key, reason, fix);
        } else if self.live.len() > Live::MOST {
            let (found, most) = (self.live.len(), Live::MOST);
            let reason = format!("one of {found} live values, at most {most} are allowed");
            self.fault(&key, reason, "write numbers for some of them");
        } else {
            let keys = self.live.iter().map(|(key, live)| (key.clone(), (live.first, live.limits)));
            return Some(Histories::live(steady, &keys.collect::<BTreeMap<_, _>>()));
        }
        None
    }
}
