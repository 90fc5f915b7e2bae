//! Routing: the participants that run, their order, and the fields with their producers and
//! consumers. Also finds participants that cannot solve the resulting windows.

use super::contents::{Effect, Field};
use case::{Case, Control, OutputFields, Problem, Timing};
use contract::description::{Description, EffectSpec, ModelSpec};
use contract::suggest::any_of;
use coupling::ParticipantIndex;
use coupling::settings::Scheme;
use coupling::windows::Windows;
use std::sync::Arc;
use typed_index_collections::TiSlice;

/// Largest number of effects and models that the advice about a missing field names.
const MOST_PROVIDERS: usize = 4;

/// A participant during routing, with the fields that it could exchange.
#[derive(Clone, Debug)]
pub(super) struct Candidate<'a> {
    pub(super) role: &'a str,
    pub(super) model: &'a ModelSpec,
    pub(super) description: &'a Arc<Description>,
    /// Live values of the case that the participant reads.
    pub(super) live: Vec<&'a str>,
    /// Fields that values of keys require, each with its key.
    pub(super) by_keys: Vec<(&'a str, &'a str)>,
}

/// A required field that no participant provides.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Unprovided {
    pub(super) field: String,
    pub(super) consumer: String,
    pub(super) because: String,
    /// Key of the case that requires the field.
    pub(super) key: String,
}

impl<'a> Candidate<'a> {
    /// Returns the active effects of the participant.
    fn effects(&self, case: &Case) -> impl Iterator<Item = &'a EffectSpec> {
        let active = case.effects.clone();
        self.description.effects.iter().filter(move |e| active.contains(&e.name))
    }

    /// Returns the consumed fields, each with the reason and the key that requires it.
    fn consumes(&self, case: &Case) -> Vec<(&'a str, String, String)> {
        let model = self.model.consumes.iter().map(|field| {
            let why = format!("model `{}`", self.model.name);
            (field.as_str(), why, format!("{}.model", self.role))
        });
        let effects = self.effects(case).flat_map(|effect| {
            let (why, key) =
                (format!("effect `{}`", effect.name), format!("effects.{}", effect.name));
            effect.consumes.iter().map(move |f| (f.as_str(), why.clone(), key.clone()))
        });
        let live = self
            .live
            .iter()
            .map(|key| (*key, format!("the live value `{key}`"), (*key).to_owned()));
        let keys = self
            .by_keys
            .iter()
            .map(|(field, key)| (*field, format!("its value of `{key}`"), (*key).to_owned()));
        model.chain(effects).chain(keys).chain(live).collect()
    }

    fn provides(&self, case: &Case) -> Vec<&'a str> {
        let effects = self.effects(case).flat_map(|effect| &effect.provides);
        self.model.provides.iter().chain(effects).map(String::as_str).collect()
    }
}

/// Sorts candidates in the order in which data flows. Candidates in a loop keep the order of the
/// case.
pub(super) fn order<'a>(mut waiting: Vec<Candidate<'a>>, case: &Case) -> Vec<Candidate<'a>> {
    let mut ordered = Vec::with_capacity(waiting.len());
    while !waiting.is_empty() {
        let needs_none = |one: &Candidate| {
            let consumed = one.consumes(case);
            waiting.iter().filter(|other| other.role != one.role).all(|other| {
                other.provides(case).iter().all(|p| consumed.iter().all(|(c, ..)| c != p))
            })
        };
        let next = waiting.iter().position(needs_none).unwrap_or(0);
        ordered.push(waiting.remove(next));
    }
    ordered
}

/// Returns the fields that exist at run time: all consumed fields, and fields to be written.
pub(super) fn fields(
    participants: &TiSlice<ParticipantIndex, Candidate>,
    case: &Case,
) -> Result<Vec<Field>, Vec<Unprovided>> {
    let mut fields: Vec<Field> = Vec::new();
    for (producer, one) in participants.iter_enumerated() {
        for name in one.provides(case) {
            if let Some(kind) = one.description.field_kind(name)
                && fields.iter().all(|f| f.kind.name != name)
            {
                let wanted = wanted(&case.output.fields, name);
                let method = case.mappings.method_of(&kind);
                fields.push(Field {
                    kind,
                    method,
                    producer,
                    consumers: Vec::new(),
                    fed_back: Vec::new(),
                    wanted,
                });
            }
        }
    }
    let mut unprovided = Vec::new();
    for (consumer, one) in participants.iter_enumerated() {
        for (name, because, key) in one.consumes(case) {
            let from_other = |f: &&mut Field| f.kind.name == name && f.producer != consumer;
            match fields.iter_mut().find(from_other) {
                Some(field) if field.consumers.contains(&consumer) => {}
                Some(field) => field.consumers.push(consumer),
                // The coordinator provides this field.
                None if one.live.contains(&name) => {}
                None => unprovided.push(Unprovided {
                    field: name.to_owned(),
                    consumer: one.role.to_owned(),
                    because,
                    key,
                }),
            }
        }
    }
    fields.retain(|field| !field.observed_only() || field.wanted);
    if unprovided.is_empty() { Ok(fields) } else { Err(unprovided) }
}

/// Returns the advice for a field that no participant provides: what would provide it.
pub(super) fn provider(described: &[(String, Arc<Description>)], field: &str) -> String {
    let provides = |fields: &[String]| fields.iter().any(|provided| provided == field);
    let effects = described.iter().flat_map(|(role, description)| {
        let effects = description.effects.iter().filter(|effect| provides(&effect.provides));
        effects.map(move |effect| format!("[effects.{}] of {role}", effect.name))
    });
    let models = described.iter().flat_map(|(role, description)| {
        let models = description.models.iter().filter(|model| provides(&model.provides));
        models.map(move |model| format!("{role}.model = \"{}\"", model.name))
    });
    let found: Vec<String> = effects.chain(models).take(MOST_PROVIDERS).collect();
    match found.as_slice() {
        [] => "add a participant that provides it, or remove what needs it".to_owned(),
        found => format!("add {}, or remove what needs it", any_of(found)),
    }
}

fn wanted(selection: &OutputFields, name: &str) -> bool {
    match selection {
        OutputFields::All => true,
        OutputFields::None => false,
        OutputFields::Named(names) => names.iter().any(|n| n == name),
    }
}

/// Returns the fields that two participants provide, with both roles.
pub(super) fn provided_twice(
    participants: &TiSlice<ParticipantIndex, Candidate>,
    case: &Case,
) -> Vec<(String, String, String)> {
    let mut twice = Vec::new();
    for (index, one) in participants.iter_enumerated() {
        for other in &participants[..index] {
            let theirs = other.provides(case);
            for name in one.provides(case).into_iter().filter(|name| theirs.contains(name)) {
                twice.push((name.to_owned(), other.role.to_owned(), one.role.to_owned()));
            }
        }
    }
    twice
}

/// Returns the fields that close a loop: a participant needs the field of a later one.
pub(super) fn feedback(fields: &[Field]) -> Vec<&Field> {
    fields.iter().filter(|f| f.consumers.iter().any(|&c| c <= f.producer)).collect()
}

/// Determines which consumers receive the coordinator's iterates. With an implicit scheme these are
/// the consumers that solve before, or at the same time as, the producer. An explicit scheme has
/// none.
pub(super) fn feed_back(fields: &mut [Field], scheme: Scheme) {
    for field in fields.iter_mut().filter(|_| scheme.is_implicit()) {
        let late = |c: &&ParticipantIndex| scheme.is_parallel() || **c <= field.producer;
        field.fed_back = field.consumers.iter().filter(late).copied().collect();
    }
}

/// Returns every effect that a participant offers, with the roles of its participants.
pub(super) fn effects(offers: &[(&str, &Description)], case: &Case) -> Vec<Effect> {
    let mut effects: Vec<Effect> = Vec::new();
    for (role, description) in offers {
        for spec in &description.effects {
            let known = effects.iter_mut().find(|e| e.name == spec.name);
            match known {
                Some(effect) => effect.roles.push((*role).to_owned()),
                None => effects.push(Effect {
                    name: spec.name.clone(),
                    active: case.effects.contains(&spec.name),
                    roles: vec![(*role).to_owned()],
                    law: spec.law.clone(),
                }),
            }
        }
    }
    effects
}

/// Returns a problem for every participant that would have to solve a window more than once, but
/// cannot.
pub(super) fn cannot_rewind<'a>(
    case: &Case,
    running: impl Iterator<Item = &'a Candidate<'a>>,
    scheme: Scheme,
) -> Vec<Problem> {
    let adaptive =
        matches!(case.timing, Timing::Transient { control: Control::Adaptive { .. }, .. });
    let (what, fix) = match scheme.is_implicit() {
        true => (
            format!("{} solves a window until it has converged", scheme.word()),
            "set coupling.scheme to \"serial-explicit\"",
        ),
        false if adaptive => (
            "adaptive windows are repeated if their error is too large".to_owned(),
            "remove time.control",
        ),
        false => return Vec::new(),
    };
    let problem = |one: &Candidate<'_>| {
        let (key, model) = (format!("{}.model", one.role), &one.model.name);
        let reason = format!("`{model}` can solve a window only once, and {what}");
        case.problem_at(&key, reason, format!("{fix}, or choose a model that can go back"))
    };
    running.filter(|one| !one.model.rewinds).map(problem).collect()
}

/// Returns a problem for every participant that needs windows of equal length, but would get
/// others.
pub(super) fn cannot_vary<'a>(
    case: &Case,
    running: impl Iterator<Item = &'a Candidate<'a>>,
    windows: &Windows,
) -> Vec<Problem> {
    let (key, what, fix) = match windows {
        Windows::Adaptive { .. } => {
            ("time.control", "the lengths of adaptive windows differ", "remove time.control")
        }
        fixed if !fixed.are_equal() => (
            "time.end",
            "the last window is cut at time.end",
            "let time.end be a multiple of time.window",
        ),
        _ => return Vec::new(),
    };
    let problem = |one: &Candidate<'_>| {
        let (role, model) = (&one.role, &one.model.name);
        let reason =
            format!("{role}.model `{model}` solves windows of one length only, and {what}");
        case.problem_at(key, reason, format!("{fix}, or choose another model"))
    };
    running.filter(|one| !one.model.varies_step).map(problem).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_advice_for_a_missing_field_names_what_provides_it() {
        let effect = EffectSpec {
            name: "friction_heat".to_owned(),
            law: String::new(),
            source: String::new(),
            models: Vec::new(),
            consumes: Vec::new(),
            provides: vec!["friction_power".to_owned()],
            keys: Vec::new(),
            figures: Vec::new(),
        };
        let mech = Description { effects: vec![effect], ..Description::default() };
        let described = [("mech".to_owned(), Arc::new(mech))];
        let advice = "add [effects.friction_heat] of mech, or remove what needs it";
        assert_eq!(provider(&described, "friction_power"), advice);
        let nobody = "add a participant that provides it, or remove what needs it";
        assert_eq!(provider(&described, "wear_depth"), nobody);
    }
}
