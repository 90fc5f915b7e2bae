//! Rules between keys: existing names, products that bound a value, compatible effects and models,
//! and the coordinator's own rules.

use super::check::{example, unknown_word, with_unit, words};
use super::filled_case::FilledCase;
use super::known::{Instance, all_keys};
use super::schema::WELL_KNOWN_ROLES;
use super::selection::Selection;
use super::settings::OutputWord;
use contract::bodies::{Bodies, TABLE, position_key};
use contract::configuration::Mode;
use contract::description::{KeyKind, ModelSpec};
use contract::suggest::{all_of, any_of, nearest};
use coupling::map::{Basis, Method};
use std::collections::BTreeSet;

impl FilledCase<'_> {
    /// Checks the rules of the participants, then the coordinator's own.
    pub(super) fn rules(&mut self) {
        self.bodies();
        self.names();
        self.magnitudes();
        self.effects();
        self.models();
        self.own_rules();
    }

    /// Checks that a case with bodies has one at each position.
    fn bodies(&mut self) {
        let active = &self.keys.active;
        let position = position_key().path;
        let asked = self.scope.known.iter().any(|k| k.active && k.spec.path == position);
        let placed = |i: &&Instance<'_>| i.known.spec.path == position;
        let each = active.iter().filter(placed).all(|i| self.values.has(&i.path));
        // A missing or misspelt position has already been reported.
        if !asked || (!each && self.scope.case.tree.find(TABLE).is_some()) {
            return;
        }
        if let Err(refusal) = Bodies::read(&self.values) {
            self.faults.at(&refusal.key, refusal.reason, refusal.fix);
        }
    }

    /// Checks that every name refers to an existing table.
    fn names(&mut self) {
        let active = &self.keys.active;
        for instance in active {
            let KeyKind::NameIn { table } = &instance.known.spec.kind else { continue };
            let key = &instance.path;
            let Some(name) = self.values.get(key).and_then(|v| v.as_str()) else { continue };
            let there = self.scope.case.tree.names(table);
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
            self.faults.at(key, reason, fix);
        }
    }

    /// Suggests the required keys of a table entry: "add [materials.steel] with ...".
    fn add_entry(&self, table: &str, name: &str) -> String {
        let plain = !name.is_empty() && !name.contains('.');
        let name = if plain { name } else { "NAME" };
        let prefix = format!("{table}.*.");
        let mut required: Vec<String> = Vec::new();
        for known in self.scope.known.iter().filter(|k| k.active && k.spec.required) {
            let Some(key) = known.spec.path.strip_prefix(&prefix) else { continue };
            let entry = format!("`{key} = {}`", example(&known.spec, known.shape));
            if !required.contains(&entry) {
                required.push(entry);
            }
        }
        let with = if required.is_empty() { "" } else { " with " };
        format!("add [{table}.{name}]{with}{}", all_of(&required))
    }

    /// Checks that values are below the products that bound them.
    fn magnitudes(&mut self) {
        let active = &self.keys.active;
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
            self.faults.at(&instance.path, reason, fix);
        }
    }

    /// Checks that the needed participants support the active effects.
    fn effects(&mut self) {
        for name in self.scope.selection.effects.iter().filter(|name| !name.contains('.')) {
            let key = format!("effects.{name}");
            let claimants: Vec<_> = self.scope.selection.claimants(name).collect();
            if !claimants.is_empty() && !claimants.iter().any(|(player, _)| player.present) {
                let roles: Vec<String> =
                    claimants.iter().map(|(player, _)| format!("[{}]", player.role)).collect();
                let fix = format!("add {} with a model, or remove the effect", any_of(&roles));
                self.faults.at(&key, "no participant of this case offers it", fix);
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
                self.faults.at(&key, reason, fix);
            }
        }
    }

    /// Checks that a participant runs, and that the models support the kind of case.
    fn models(&mut self) {
        let mode = self.scope.selection.timing.mode();
        let (word, other) = match mode {
            Mode::Steady => ("steady", "transient"),
            Mode::Transient => ("transient", "steady"),
        };
        let can = |m: &ModelSpec| if mode == Mode::Steady { m.steady } else { m.transient };
        for player in self.scope.selection.players.iter().filter(|player| player.needed) {
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
            let reason = format!("model `{}` does not support a {word} case", model.name);
            self.faults.at(&format!("{}.model", player.role), reason, fix);
        }
        for role in self.scope.selection.undescribed(self.scope.case) {
            let reason = "the participant of this section has not described itself";
            let by_hand = self.scope.case.has(&format!("{role}.attach"));
            let fix = match by_hand && !self.scope.case.has(&format!("{role}.command")) {
                true => format!(
                    "name the program that you start by hand as `{role}.command`: it is asked what \
                     it is, and not started"
                ),
                false => format!("check `{role}.command`, or remove [{role}]"),
            };
            self.faults.at(&role, reason, fix);
        }
        self.somebody_runs();
    }

    pub(super) fn somebody_runs(&mut self) {
        let present: Vec<&str> =
            self.scope.selection.players.iter().filter(|p| p.present).map(|p| p.role).collect();
        let reported =
            !self.scope.selection.undescribed(self.scope.case).is_empty() || !self.meant.is_empty();
        if reported || self.scope.selection.players.iter().any(|p| p.needed) {
            return;
        }
        match present.first() {
            Some(first) => {
                let reason = format!("nothing would run: no active effect needs {first}");
                self.faults.at(first, reason, "add an effect, or another participant");
            }
            None => {
                let sections: Vec<String> =
                    WELL_KNOWN_ROLES.iter().map(|role| format!("[{role}]")).collect();
                let fix = format!("add {} with a model", any_of(&sections));
                self.faults.at("", "nothing would run: the case has no participant", fix);
            }
        }
    }

    /// Checks the coordinator's own rules.
    fn own_rules(&mut self) {
        self.own_values();
        self.coupled_fields();
        self.mapped_fields();
        if let Some(serde_json::Value::Array(names)) = self.values.get("output.fields").cloned() {
            for name in names.iter().filter_map(|n| n.as_str()) {
                self.provided_field("output.fields", name, "write \"all\" or \"none\"");
            }
        }
    }

    /// Checks those of the coordinator's rules that need no participant.
    pub(super) fn own_values(&mut self) {
        self.case_name();
        let number = |key: &str| self.values.get(key).and_then(serde_json::Value::as_f64);
        if let (Some(window), Some(end)) = (number("time.window"), number("time.end"))
            && window > end
        {
            let reason = format!("{window} s is longer than time.end = {end} s");
            self.faults.at("time.window", reason, "shorten it, or raise time.end");
        }
        self.window_bounds();
        self.iterations();
        self.basis_functions();
        let key = "output.fields";
        let word = self.values.get(key).and_then(serde_json::Value::as_str);
        if let Some(word) = word.filter(|word| OutputWord::from_word(word).is_none()) {
            let reason = format!("`{word}` is neither `all` nor `none`");
            let fix = "write \"all\", \"none\" or a list of field names";
            self.faults.at(key, reason, fix);
        }
    }

    /// Checks that the bounds of adaptive windows enclose the window of the case.
    fn window_bounds(&mut self) {
        let number = |key: &str| self.values.get(key).and_then(serde_json::Value::as_f64);
        let (window, least, most) =
            (number("time.window"), number("time.window_min"), number("time.window_max"));
        let Some(window) = window else { return };
        if let Some(least) = least.filter(|least| *least > window) {
            let reason = format!("{least} s is longer than time.window = {window} s");
            self.faults.at("time.window_min", reason, "lower it, or raise time.window");
        }
        if let Some(most) = most.filter(|most| *most < window) {
            let reason = format!("{most} s is shorter than time.window = {window} s");
            self.faults.at("time.window_max", reason, "raise it, or shorten time.window");
        }
    }

    /// Checks that the numbers of iterations are consistent.
    fn iterations(&mut self) {
        let count = |name: &str| self.values.get(&format!("coupling.{name}"))?.as_u64();
        if let (Some(least), Some(most)) = (count("min_iterations"), count("max_iterations"))
            && least > most
        {
            let reason = format!("{least} is more than coupling.max_iterations = {most}");
            let fix = "lower it, or raise coupling.max_iterations";
            self.faults.at("coupling.min_iterations", reason, fix);
        }
    }

    /// Checks that a radial basis function goes with its method, and a radius with its function.
    fn basis_functions(&mut self) {
        let own = self.scope.case.tree.names("mapping.fields");
        let own = own.into_iter().map(|name| format!("mapping.fields.{name}"));
        for section in std::iter::once("mapping".to_owned()).chain(own) {
            let [method, basis, radius] =
                ["method", "basis", "radius"].map(|name| format!("{section}.{name}"));
            let word = |key: &str| self.values.get(key).and_then(serde_json::Value::as_str);
            let radial = Method::RadialBasis.word();
            let chosen = word(&basis).and_then(Basis::from_word);
            let with_radius = self.values.has(&radius);
            // An unknown word has already been reported.
            let written = self.scope.case.tree.text(&method);
            let unknown = self.scope.case.has(&method) && written != word(&method);
            if chosen.is_some() && word(&method) != Some(radial) && !unknown {
                let reason = match word(&method) {
                    Some(other) => format!("`{other}` has no radial basis function"),
                    None => format!("a radial basis function needs {method}"),
                };
                let fix = format!("set {method} to \"{radial}\", or remove the key");
                self.faults.at(&basis, reason, fix);
            }
            match chosen {
                Some(chosen) if chosen.has_radius() && !self.scope.case.has(&radius) => {
                    let reason = format!("`{}` needs a radius", chosen.word());
                    let fix = format!(
                        "add {radius}, for example five times the distance between neighbouring \
                         points"
                    );
                    self.faults.at(&basis, reason, fix);
                }
                Some(chosen) if !chosen.has_radius() && with_radius => {
                    let reason = format!("`{}` has no radius", chosen.word());
                    self.faults.at(&radius, reason, "remove the key");
                }
                None if with_radius && !self.scope.case.has(&basis) => {
                    let reason = "a radius needs a radial basis function";
                    let fix =
                        format!("add {basis}, for example \"wendland-c2\", or remove the key");
                    self.faults.at(&radius, reason, fix);
                }
                _ => {}
            }
        }
    }

    /// Checks that tolerances are for provided fields.
    fn coupled_fields(&mut self) {
        for name in self.scope.case.tree.names("coupling.fields") {
            self.provided_field(&format!("coupling.fields.{name}"), &name, "remove it");
        }
    }

    /// Checks that mapping methods are for consumed fields.
    fn mapped_fields(&mut self) {
        let consumed: BTreeSet<String> =
            consumed(self.scope.selection).into_iter().map(|name| self.shown(name)).collect();
        for name in self.scope.case.tree.names("mapping.fields") {
            let key = format!("mapping.fields.{name}");
            if consumed.contains(&self.shown(&name)) {
                continue;
            }
            let before = self.faults.len();
            self.provided_field(&key, &name, "remove it");
            if self.faults.len() > before {
                continue;
            }
            let known: Vec<&str> = consumed.iter().map(String::as_str).collect();
            let fix = match known.as_slice() {
                [] => "remove it".to_owned(),
                known => format!("remove it; the participants consume {}", all_of(known)),
            };
            self.faults.at(
                &key,
                format!("no participant consumes `{name}`: it is never mapped"),
                fix,
            );
        }
    }

    /// Checks that the name of the case can name its result folder.
    fn case_name(&mut self) {
        let key = "case.name";
        let Some(name) = self.values.get(key).and_then(serde_json::Value::as_str) else { return };
        if let Some(reason) = name_fault(name) {
            let fix = "write a name of letters, digits, `-`, `_` and `.`, such as \"rolling-1\"";
            self.faults.at(key, reason, fix);
        }
    }

    /// Returns the name of a field as shown to the user.
    fn shown(&self, name: &str) -> String {
        Bodies::read(&self.values).map_or_else(|_| name.to_owned(), |bodies| bodies.shown(name))
    }

    /// Checks that a participant provides a field; `otherwise` is the fix if no fields exist.
    fn provided_field(&mut self, key: &str, name: &str, otherwise: &str) {
        let provided =
            self.scope.selection.players.iter().filter(|p| p.needed).flat_map(|player| {
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
        self.faults.at(key, format!("unknown field `{name}`{hint}"), fix);
    }
}

/// Returns the fields that the needed participants consume with any of their models and effects.
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

/// Returns why a text cannot be the name of a case and of its result folder.
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
