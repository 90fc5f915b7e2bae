//! Warnings of a case: values beyond what is expected of them, keys without effect, and keys that an
//! option has replaced.

use super::contents::Participant;
use crate::warnings::{Implausible, Warning};
use case::{Case, Replaced, Unread};
use contract::description::KeySpec;
use contract::params::Params;

/// The implausible ones among the values that participants read.
pub(super) fn warnings<'a>(
    case: &Case,
    participants: impl Iterator<Item = &'a Participant>,
) -> Vec<Warning> {
    let mut warnings: Vec<Warning> = Vec::new();
    for participant in participants {
        let (description, given) = (&participant.description, &participant.configuration);
        let model = description.models.iter().find(|model| model.name == given.model);
        let effects = description.effects.iter().filter(|effect| given.has_effect(&effect.name));
        let keys = description.keys.iter().chain(model.into_iter().flat_map(|model| &model.keys));
        for KeySpec { path, kind, plausible, .. } in
            keys.chain(effects.flat_map(|effect| &effect.keys))
        {
            let Some(expected) = plausible else { continue };
            for (key, value) in instances(&given.case, path) {
                let place = Some(case.problem_at(&key, "", "").place.to_string());
                let warning = Warning::of(&key, place, value, kind.unit(), expected);
                let new = |one: &Warning| warnings.iter().all(|other| other.key() != one.key());
                let warning = warning.filter(new);
                warnings.extend(warning);
            }
        }
    }
    warnings
}

/// A model that leaves out more is no model of the scene. What models say here is an upper bound.
const MOST_LEFT_OUT: f64 = 0.15;

/// What models leave out in this scene, as they estimate it, if it is much.
pub(super) fn left_out<'a>(
    case: &Case,
    participants: impl Iterator<Item = &'a Participant>,
) -> Vec<Warning> {
    let of = |participant: &'a Participant| {
        let key = format!("{}.model", participant.role);
        let place = case.problem_at(&key, "", "").place.to_string();
        let layout = participant.estimate.iter();
        let large =
            layout.flat_map(|layout| &layout.left_out).filter(|one| one.error > MOST_LEFT_OUT);
        large.map(move |one| {
            Warning::Value(Implausible {
                key: key.clone(),
                place: Some(place.clone()),
                quantity: Some("relative error".to_owned()),
                value: one.error,
                unit: String::new(),
                bound: MOST_LEFT_OUT,
                why: format!("{} ({})", one.what, one.source),
            })
        })
    };
    participants.flat_map(of).collect()
}

/// Most words that say what would read a key.
const MOST_READERS: usize = 4;

/// One warning of all keys of the case that have no effect, but for those that are usual.
pub(super) fn unread(case: &Case) -> Option<Warning> {
    let unusual: Vec<&Unread> = case.unread.iter().filter(|unread| !unread.is_usual).collect();
    let keys: Vec<&str> = unusual.iter().map(|unread| unread.key.as_str()).collect();
    let first = keys.first()?;
    let mut groups: Vec<(&[String], Vec<&str>)> = Vec::new();
    for Unread { key, readers, .. } in unusual {
        match groups.iter_mut().find(|(others, _)| others == readers) {
            Some((_, keys)) => keys.push(key),
            None => groups.push((readers.as_slice(), vec![key.as_str()])),
        }
    }
    let alone = groups.len() == 1;
    let fixes: Vec<String> = groups.iter().map(|(of, keys)| reading(of, keys, alone)).collect();
    let reason = match keys.as_slice() {
        [_] => "nothing in this case reads it: it has no effect",
        _ => "nothing in this case reads them: they have no effect",
    };
    let mut problem = case.problem_at(first, reason, fixes.join("; "));
    problem.key = keys.join(", ");
    Some(problem.into())
}

/// What would read these keys, in words.
fn reading(readers: &[String], keys: &[&str], alone: bool) -> String {
    let (shown, more) = readers.split_at(readers.len().min(MOST_READERS));
    let more = if more.is_empty() { String::new() } else { format!(" or {} more", more.len()) };
    let which = match (alone, keys.len()) {
        (false, _) => keys.join(", "),
        (true, 1) => "it".to_owned(),
        (true, _) => "them".to_owned(),
    };
    match shown {
        [] => format!("remove {which}, or name its entry where it is to be used"),
        shown => format!("remove {which}, or choose {}{more}", shown.join(" or ")),
    }
}

/// The keys of the file that options have replaced.
pub(super) fn replaced(case: &Case) -> impl Iterator<Item = Warning> {
    case.replaced.iter().map(|Replaced { option, keys }| {
        let (reason, fix) = match keys.as_slice() {
            [_] => (format!("{option} replaces it"), "remove it by --unset"),
            _ => (format!("{option} replaces them"), "remove them by --unset"),
        };
        let mut problem = case.problem_at(&keys[0], reason, fix);
        problem.key = keys.join(", ");
        problem.into()
    })
}

/// The numbers of a case under a path in which `*` stands for any one name.
fn instances(case: &Params, path: &str) -> Vec<(String, f64)> {
    let mut found = vec![(String::new(), &case.0)];
    for part in path.split('.') {
        found = found
            .into_iter()
            .flat_map(|(key, value)| {
                let table = value.as_object().into_iter().flatten();
                table.filter(|(name, _)| part == "*" || part == *name).map(move |(name, value)| {
                    let key = if key.is_empty() { name.clone() } else { format!("{key}.{name}") };
                    (key, value)
                })
            })
            .collect();
    }
    found.into_iter().filter_map(|(key, value)| Some((key, value.as_f64()?))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn names_stand_for_stars() {
        let case =
            Params(json!({"bodies": {"a": {"r": 1.0}, "b": {"r": 2.0, "s": 3.0}}, "r": 4.0}));
        let found = instances(&case, "bodies.*.r");
        assert_eq!(found, [("bodies.a.r".to_owned(), 1.0), ("bodies.b.r".to_owned(), 2.0)]);
        assert!(instances(&case, "bodies.*.t").is_empty());
    }
}
