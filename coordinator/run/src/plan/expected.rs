//! Warnings about a case: implausible values, keys without effect, and keys that an option has
//! replaced.

use super::contents::Participant;
use crate::warnings::{Implausible, Warning};
use case::schema::{OwnKey, own_keys};
use case::{Case, Replaced, Unread};
use contract::bodies::{POSITIONS, TABLE};
use contract::configuration::{Configuration, Refusal};
use contract::description::KeySpec;
use contract::history::Histories;
use contract::params::Params;
use contract::plausible::Plausible;
use contract::table::{Column, Reading, Table};
use serde_json::Value;
use std::path::Path;

/// Largest table that is checked [byte].
const MOST_BYTES: u64 = 1 << 30;

/// Returns a warning for each implausible value that participants read, in the case and in its
/// tables.
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
        for spec in keys.chain(effects.flat_map(|effect| &effect.keys)) {
            let found = of_numbers(case, spec, &given.case, given.histories.as_ref());
            let found: Vec<Warning> = found.chain(of_tables(case, spec, &given.case)).collect();
            for warning in found {
                if warnings.iter().all(|other| other.key() != warning.key()) {
                    warnings.push(warning);
                }
            }
        }
    }
    for OwnKey { spec, .. } in own_keys() {
        warnings.extend(of_numbers(case, spec, &case.values, None));
    }
    warnings
}

/// Returns warnings about the numbers of a key, and about the rows of a key that varies.
fn of_numbers<'a>(
    case: &'a Case,
    spec: &'a KeySpec,
    values: &'a Params,
    histories: Option<&'a Histories>,
) -> impl Iterator<Item = Warning> {
    let expected = spec.plausible.as_ref();
    let keys = expected.map(|_| instances(values, &spec.path)).unwrap_or_default();
    keys.into_iter().filter_map(move |(key, value)| {
        let value = value.as_f64()?;
        let expected = expected?;
        let rows = histories.and_then(|histories| histories.values.get(&key));
        let beyond =
            |rows: &Vec<f64>| rows.iter().position(|value| expected.bound_passed(*value).is_some());
        let row = rows.and_then(beyond);
        let (value, quantity) = match (rows, row) {
            (Some(rows), Some(row)) => {
                (rows[row], Some(format!("value in row {} of its table", row + 1)))
            }
            _ => (value, None),
        };
        implausible(case, &key, quantity, value, spec.kind.unit(), expected)
    })
}

/// Returns warnings about the columns of the table that a key names.
fn of_tables<'a>(
    case: &'a Case,
    spec: &'a KeySpec,
    values: &'a Params,
) -> impl Iterator<Item = Warning> {
    let keys = if spec.columns.is_empty() { Vec::new() } else { instances(values, &spec.path) };
    keys.into_iter().flat_map(move |(key, path)| {
        // Participants have already refused tables that cannot be read.
        let table =
            path.as_str().map(|path| Table::read(Path::new(path), MOST_BYTES, Reading::NUMBERS));
        let table = table.and_then(Result::ok);
        let found = table.as_ref().and_then(|table| table.columns(&spec.columns).ok());
        let columns = spec.columns.iter().zip(found.unwrap_or_default());
        let of = |(column, values): (&Column, Vec<f64>)| {
            let expected = column.plausible.as_ref()?;
            let row = values.iter().position(|value| expected.bound_passed(*value).is_some())?;
            let line = table.as_ref()?.line(row);
            let quantity = Some(format!("{} in line {line}", column.names[0]));
            implausible(case, &key, quantity, values[row], &column.unit, expected)
        };
        // One warning for each table is enough.
        columns.filter_map(of).take(1).collect::<Vec<_>>()
    })
}

fn implausible(
    case: &Case,
    key: &str,
    quantity: Option<String>,
    value: f64,
    unit: &str,
    expected: &Plausible,
) -> Option<Warning> {
    let place = Some(case.problem_at(key, "", "").place.to_string());
    let mut warning = Warning::of(key, place, value, unit, expected)?;
    if let Warning::Value(implausible) = &mut warning {
        implausible.quantity = quantity;
    }
    Some(warning)
}

/// Largest relative error of a model without a warning. The estimates of the models are upper
/// bounds.
const MOST_LEFT_OUT: f64 = 0.15;

/// Returns the warnings of participants about the case, and warnings about models whose estimated
/// error in this scene is large.
pub(super) fn estimated<'a>(
    case: &Case,
    participants: impl Iterator<Item = &'a Participant>,
) -> Vec<Warning> {
    let of = |participant: &'a Participant| {
        let key = format!("{}.model", participant.role);
        let place = case.problem_at(&key, "", "").place.to_string();
        let layout = participant.estimate.iter();
        let told = layout.clone().flat_map(|layout| &layout.warnings);
        let told =
            told.map(|Refusal { key, reason, fix }| case.problem_at(key, reason, fix).into());
        let large =
            layout.flat_map(|layout| &layout.left_out).filter(|one| one.error > MOST_LEFT_OUT);
        let large = large.map(move |one| {
            Warning::Value(Implausible {
                key: key.clone(),
                place: Some(place.clone()),
                quantity: Some("relative error".to_owned()),
                value: one.error,
                unit: String::new(),
                bound: MOST_LEFT_OUT,
                why: format!("{} ({})", one.what, one.source),
            })
        });
        told.chain(large)
    };
    participants.flat_map(of).collect()
}

/// Returns warnings about values that make the bodies differ, which a participant sends on as a
/// field of the same name, and which another participant that computes both bodies neither reads
/// nor receives.
pub(super) fn ignored<'a>(
    case: &Case,
    participants: impl Iterator<Item = &'a Participant> + Clone,
) -> Vec<Warning> {
    let mut warnings = Vec::new();
    for sender in participants.clone() {
        for field in provided(sender) {
            let path = format!("{TABLE}.*.{field}");
            let given = instances(&sender.configuration.case, &path);
            let Some((key, _)) = given.first() else { continue };
            let deaf = participants.clone().find(|other| {
                let Configuration { inputs, case, .. } = &other.configuration;
                other.role != sender.role
                    && provided(other).any(|field| is_of_a_body(field))
                    && inputs.iter().all(|input| input.field.name != *field)
                    && instances(case, &path).is_empty()
            });
            let Some(Participant { role, .. }) = deaf else { continue };
            let reason = format!(
                "has no effect in {role}, which neither reads it nor receives the field `{field}`: it computes \
                 both bodies as if they did not differ"
            );
            let fix = format!("choose a program or a model of {role} that consumes `{field}`");
            warnings.push(case.problem_at(key, reason, fix).into());
        }
    }
    warnings
}

/// Returns the fields that the model and the active effects of a participant provide.
fn provided(participant: &Participant) -> impl Iterator<Item = &String> {
    let Participant { description, configuration, .. } = participant;
    let model = description.models.iter().filter(|model| model.name == configuration.model);
    let effects = description.effects.iter();
    let effects = effects.filter(|effect| configuration.has_effect(&effect.name));
    model.flat_map(|model| &model.provides).chain(effects.flat_map(|effect| &effect.provides))
}

/// Returns whether a field belongs to one of the bodies.
fn is_of_a_body(field: &str) -> bool {
    let rest = POSITIONS.iter().find_map(|position| field.strip_prefix(position));
    rest.is_some_and(|rest| rest.starts_with('_'))
}

/// Largest number of readers that a message names.
const MOST_READERS: usize = 4;

/// Returns one warning about all keys without effect, except the usual ones.
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

/// Names the models and effects that would read these keys.
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

/// Returns warnings about the keys of the file that options have replaced.
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

/// Returns the values of a case under a path in which `*` stands for any one name.
pub(super) fn instances<'a>(case: &'a Params, path: &str) -> Vec<(String, &'a Value)> {
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
    found
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
        let expected =
            [("bodies.a.r".to_owned(), &json!(1.0)), ("bodies.b.r".to_owned(), &json!(2.0))];
        assert_eq!(found, expected);
        assert!(instances(&case, "bodies.*.t").is_empty());
    }
}
