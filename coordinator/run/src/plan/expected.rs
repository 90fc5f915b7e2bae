//! Values of a case beyond what is expected of them.

use super::contents::Participant;
use crate::warnings::Warning;
use contract::description::KeySpec;
use contract::params::Params;

/// Of the values that participants read.
pub(super) fn warnings<'a>(participants: impl Iterator<Item = &'a Participant>) -> Vec<Warning> {
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
                let warning = Warning::of(&key, value, kind.unit(), expected);
                warnings.extend(
                    warning.filter(|one| warnings.iter().all(|other| other.key != one.key)),
                );
            }
        }
    }
    warnings
}

/// A model that leaves out more is no model of the scene. What models say here is an upper bound.
const MOST_LEFT_OUT: f64 = 0.15;

/// Of what models leave out in this scene, as they estimate it.
pub(super) fn left_out<'a>(participants: impl Iterator<Item = &'a Participant>) -> Vec<Warning> {
    let of = |participant: &'a Participant| {
        let key = format!("{}.model", participant.role);
        let layout = participant.estimate.iter();
        let large =
            layout.flat_map(|layout| &layout.left_out).filter(|one| one.error > MOST_LEFT_OUT);
        large.map(move |one| Warning {
            key: key.clone(),
            quantity: Some("relative error".to_owned()),
            value: one.error,
            unit: String::new(),
            bound: MOST_LEFT_OUT,
            why: format!("{} ({})", one.what, one.source),
        })
    };
    participants.flat_map(of).collect()
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
