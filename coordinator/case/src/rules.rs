//! Rules between keys: names that must exist, products that bound a value, effects and models
//! that must suit each other, and the coordinator's own.

use super::check::{unknown_word, words};
use super::checker::Checker;
use super::example::{example, with_unit};
use super::known::{Instance, all_keys};
use super::schema::WELL_KNOWN_ROLES;
use super::selection::Selection;
use contract::bodies::{Bodies, TABLE, position_key};
use contract::configuration::Mode;
use contract::description::{KeyKind, ModelSpec};
use contract::suggest::{all_of, any_of, nearest};
use std::collections::BTreeSet;

impl Checker<'_> {
    /// Checks that a case of bodies has one at each position.
    pub(super) fn bodies(&mut self, active: &[Instance<'_>]) {
        let position = position_key().path;
        let asked = self.known.iter().any(|k| k.active && k.spec.path == position);
        let placed = |i: &&Instance<'_>| i.known.spec.path == position;
        let each = active.iter().filter(placed).all(|i| self.values.has(&i.path));
        // A position that is missing or misspelt has been reported where it stands.
        if !asked || (!each && self.case.tree.find(TABLE).is_some()) {
            return;
        }
        if let Err(refusal) = Bodies::read(&self.values) {
            self.fault(&refusal.key, refusal.reason, refusal.fix);
        }
    }

    /// Checks that every name refers to a table that is there.
    pub(super) fn names(&mut self, active: &[Instance<'_>]) {
        for instance in active {
            let KeyKind::NameIn { table } = &instance.known.spec.kind else { continue };
            let key = &instance.path;
            let Some(name) = self.values.get(key).and_then(|v| v.as_str()) else { continue };
            let there = self.case.tree.names(table);
            if there.iter().any(|n| n == name) {
                continue;
            }
            let reason = unknown_word(key, name, there.iter().map(String::as_str));
            let add = self.add_entry(table, name);
            let fix = match nearest(name, there.iter().map(String::as_str)) {
                Some(near) => format!("write \"{near}\", or {add}"),
                None if there.is_empty() => add,
                None => format!("write {}, or {add}", words(&there)),
            };
            self.fault(key, reason, fix);
        }
    }

    /// "add [materials.steel] with ...": everything that an entry of a table requires.
    fn add_entry(&self, table: &str, name: &str) -> String {
        let plain = !name.is_empty() && !name.contains('.');
        let name = if plain { name } else { "NAME" };
        let prefix = format!("{table}.*.");
        let mut required: Vec<String> = Vec::new();
        for known in self.known.iter().filter(|k| k.active && k.spec.required) {
            let Some(key) = known.spec.path.strip_prefix(&prefix) else { continue };
            let entry = format!("`{key} = {}`", example(&known.spec, known.shape));
            if !required.contains(&entry) {
                required.push(entry);
            }
        }
        let with = if required.is_empty() { "" } else { " with " };
        format!("add [{table}.{name}]{with}{}", all_of(&required))
    }

    /// Checks that values are smaller than the products that bound them.
    pub(super) fn magnitudes(&mut self, active: &[Instance<'_>]) {
        for instance in active.iter().filter(|i| !i.known.spec.magnitude_below.is_empty()) {
            let number = |key: &str| self.values.get(key).and_then(serde_json::Value::as_f64);
            let mut names = instance.binding.split('.');
            let bind = |key: &String| match names.next() {
                Some(name) => key.replacen('*', name, 1),
                None => key.clone(),
            };
            let keys: Vec<String> = instance.known.spec.magnitude_below.iter().map(bind).collect();
            let Some(value) = number(&instance.path) else { continue };
            let Some(bound) = keys.iter().map(|key| number(key)).product::<Option<f64>>() else {
                continue;
            };
            if value.abs() < bound {
                continue;
            }
            let unit = match &instance.known.spec.kind {
                KeyKind::Quantity { unit } => unit.as_str(),
                _ => "",
            };
            let sign = if value < 0.0 { " in magnitude" } else { "" };
            let reason = format!(
                "{} is not below {} = {}{sign}",
                with_unit(value, unit),
                keys.join(" × "),
                with_unit(bound, unit)
            );
            let fix = format!("lower it, or raise {}", any_of(&keys));
            self.fault(&instance.path, reason, fix);
        }
    }

    /// Checks that the participants needed can take part in the active effects.
    pub(super) fn effects(&mut self) {
        for name in self.selection.effects.iter().filter(|name| !name.contains('.')) {
            let key = format!("effects.{name}");
            let claimants: Vec<_> = self.selection.claimants(name).collect();
            if !claimants.is_empty() && !claimants.iter().any(|(player, _)| player.present) {
                let roles: Vec<String> =
                    claimants.iter().map(|(player, _)| format!("[{}]", player.role)).collect();
                let fix = format!("add {} with a model, or remove the effect", any_of(&roles));
                self.fault(&key, "no participant of this case offers it", fix);
            }
            for (player, effect) in claimants.into_iter().filter(|(player, _)| player.present) {
                let role = player.role;
                let Some(model) = player.model.filter(|m| !effect.models.contains(&m.name)) else {
                    continue;
                };
                let reason = format!("{role}.model `{}` does not support it", model.name);
                let fix = match effect.models.as_slice() {
                    [] => "remove it: no model supports it".to_owned(),
                    models => {
                        format!("set {role}.model to {}, or remove the effect", words(models))
                    }
                };
                self.fault(&key, reason, fix);
            }
        }
    }

    /// Checks that something runs, and that the models can answer the kind of case.
    pub(super) fn models(&mut self) {
        let mode = self.selection.timing.mode();
        let (word, other) = match mode {
            Mode::Steady => ("steady", "transient"),
            Mode::Transient => ("transient", "steady"),
        };
        let can = |m: &ModelSpec| if mode == Mode::Steady { m.steady } else { m.transient };
        for player in self.selection.players.iter().filter(|player| player.needed) {
            let Some(model) = player.model.filter(|model| !can(model)) else { continue };
            let able: Vec<&str> = player
                .description
                .models
                .iter()
                .filter(|m| can(m))
                .map(|m| m.name.as_str())
                .collect();
            let switch = format!("set time.mode to \"{other}\"");
            let fix = match able.as_slice() {
                [] => switch,
                able => format!("write {}, or {switch}", words(able)),
            };
            let reason = format!("model `{}` cannot answer a {word} case", model.name);
            self.fault(&format!("{}.model", player.role), reason, fix);
        }
        for role in self.undescribed() {
            let reason = "the participant of this section has not described itself";
            let by_hand = self.case.has(&format!("{role}.attach"));
            let fix = match by_hand && !self.case.has(&format!("{role}.command")) {
                true => format!(
                    "name the program that you start by hand as `{role}.command`: it is asked what \
                     it is, and not started"
                ),
                false => format!("check `{role}.command`, or remove [{role}]"),
            };
            self.fault(&role, reason, fix);
        }
        self.somebody_runs();
    }

    pub(super) fn somebody_runs(&mut self) {
        let present: Vec<&str> =
            self.selection.players.iter().filter(|p| p.present).map(|p| p.role).collect();
        let reported = !self.undescribed().is_empty() || !self.meant.is_empty();
        if reported || self.selection.players.iter().any(|p| p.needed) {
            return;
        }
        match present.first() {
            Some(first) => {
                let reason = format!("nothing would run: without an effect {first} has no part");
                self.fault(first, reason, "add an effect, or another participant");
            }
            None => {
                let sections: Vec<String> =
                    WELL_KNOWN_ROLES.iter().map(|role| format!("[{role}]")).collect();
                let fix = format!("add {} with a model", any_of(&sections));
                self.fault("", "nothing would run: the case has no participant", fix);
            }
        }
    }

    /// Roles that the case gives a command, or that are well known, and that nobody described.
    pub(super) fn undescribed(&self) -> Vec<String> {
        super::undescribed(self.case, self.selection)
    }

    /// Checks the coordinator's own rules.
    pub(super) fn own_rules(&mut self) {
        self.own_values();
        self.coupled_fields();
        self.mapped_fields();
        if let Some(serde_json::Value::Array(names)) = self.values.get("output.fields").cloned() {
            for name in names.iter().filter_map(|n| n.as_str()) {
                self.provided_field("output.fields", name, "write \"all\" or \"none\"");
            }
        }
    }

    /// Checks those of its rules for which nobody has to be asked.
    pub(super) fn own_values(&mut self) {
        self.case_name();
        let number = |key: &str| self.values.get(key).and_then(serde_json::Value::as_f64);
        if let (Some(window), Some(end)) = (number("time.window"), number("time.end"))
            && window > end
        {
            let reason = format!("{window} s is longer than time.end = {end} s");
            self.fault("time.window", reason, "shorten it, or raise time.end");
        }
        self.window_bounds();
        self.iterations();
        let key = "output.fields";
        let word = self.values.get(key).and_then(serde_json::Value::as_str);
        if let Some(word) = word.filter(|word| *word != "all" && *word != "none") {
            let reason = format!("`{word}` is neither `all` nor `none`");
            let fix = "write \"all\", \"none\" or a list of field names";
            self.fault(key, reason, fix);
        }
    }

    /// Bounds of adaptive windows that hold the window of the case.
    fn window_bounds(&mut self) {
        let number = |key: &str| self.values.get(key).and_then(serde_json::Value::as_f64);
        let (window, least, most) =
            (number("time.window"), number("time.window_min"), number("time.window_max"));
        let Some(window) = window else { return };
        if let Some(least) = least.filter(|least| *least > window) {
            let reason = format!("{least} s is longer than time.window = {window} s");
            self.fault("time.window_min", reason, "lower it, or raise time.window");
        }
        if let Some(most) = most.filter(|most| *most < window) {
            let reason = format!("{most} s is shorter than time.window = {window} s");
            self.fault("time.window_max", reason, "raise it, or shorten time.window");
        }
    }

    /// Iterations that fit together.
    fn iterations(&mut self) {
        let count = |name: &str| self.values.get(&format!("coupling.{name}"))?.as_u64();
        if let (Some(least), Some(most)) = (count("min_iterations"), count("max_iterations"))
            && least > most
        {
            let reason = format!("{least} is more than coupling.max_iterations = {most}");
            let fix = "lower it, or raise coupling.max_iterations";
            self.fault("coupling.min_iterations", reason, fix);
        }
    }

    /// Tolerances are for fields that somebody provides.
    fn coupled_fields(&mut self) {
        for name in self.case.tree.names("coupling.fields") {
            self.provided_field(&format!("coupling.fields.{name}"), &name, "remove it");
        }
    }

    /// Methods are for fields that somebody may receive.
    fn mapped_fields(&mut self) {
        let consumed: BTreeSet<String> =
            consumed(self.selection).into_iter().map(|name| self.shown(name)).collect();
        for name in self.case.tree.names("mapping.fields") {
            let key = format!("mapping.fields.{name}");
            if consumed.contains(&self.shown(&name)) {
                continue;
            }
            let before = self.problems.len();
            self.provided_field(&key, &name, "remove it");
            if self.problems.len() > before {
                continue;
            }
            let known: Vec<&str> = consumed.iter().map(String::as_str).collect();
            let fix = match known.as_slice() {
                [] => "remove it".to_owned(),
                known => format!("remove it; the participants consume {}", all_of(known)),
            };
            self.fault(&key, format!("no participant consumes `{name}`: it is never mapped"), fix);
        }
    }

    /// The name of the case names its result folder: it is one plain part of a path.
    fn case_name(&mut self) {
        let key = "case.name";
        let Some(name) = self.values.get(key).and_then(serde_json::Value::as_str) else { return };
        if let Some(reason) = name_fault(name) {
            let fix = "write a name of letters, digits, `-`, `_` and `.`, such as \"rolling-1\"";
            self.fault(key, reason, fix);
        }
    }

    /// What a person reads for the name of a field.
    fn shown(&self, name: &str) -> String {
        Bodies::read(&self.values).map_or_else(|_| name.to_owned(), |bodies| bodies.shown(name))
    }

    /// Checks that a participant provides a field; `otherwise` is the fix if there are no fields.
    fn provided_field(&mut self, key: &str, name: &str, otherwise: &str) {
        let provided = self.selection.players.iter().filter(|p| p.needed).flat_map(|player| {
            let effects = player.description.effects.iter().flat_map(|e| &e.provides);
            player.description.models.iter().flat_map(|m| &m.provides).chain(effects)
        });
        let fields: BTreeSet<String> = provided.map(|field| self.shown(field)).collect();
        if fields.contains(&self.shown(name)) {
            return;
        }
        let near = nearest(name, fields.iter().map(String::as_str));
        let hint = near.map(|n| format!("; did you mean `{n}`?")).unwrap_or_default();
        let known: Vec<&str> = fields.iter().map(String::as_str).collect();
        let fix = match known.as_slice() {
            [] => otherwise.to_owned(),
            known => format!("the participants provide {}", all_of(known)),
        };
        self.fault(key, format!("unknown field `{name}`{hint}"), fix);
    }
}

/// Fields that the participants needed may consume, whatever models and effects are chosen.
fn consumed<'a>(selection: &'a Selection<'a>) -> BTreeSet<&'a str> {
    let needed = selection.players.iter().filter(|p| p.needed);
    let consumed = needed.flat_map(|player| {
        let effects = player.description.effects.iter().flat_map(|e| &e.consumes);
        let keys = all_keys(player.description).flat_map(|key| key.consumes.values().flatten());
        player.description.models.iter().flat_map(|m| &m.consumes).chain(effects).chain(keys)
    });
    consumed.map(String::as_str).collect()
}

/// Longest name of a case [byte].
const LONGEST_NAME: usize = 64;

/// Why a text cannot be the name of a case and of its result folder.
fn name_fault(name: &str) -> Option<String> {
    let plain = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_' | '.' | ' ');
    if name.is_empty() {
        Some("is empty".to_owned())
    } else if name.len() > LONGEST_NAME {
        Some(format!("has {} bytes, {LONGEST_NAME} at most", name.len()))
    } else if let Some(other) = name.chars().find(|c| !plain(*c)) {
        Some(format!("{other:?} is not allowed in the name of a result folder"))
    } else if name.starts_with('.') {
        Some("starts with a dot".to_owned())
    } else if name.trim() != name {
        Some("starts or ends with a space".to_owned())
    } else {
        None
    }
}
