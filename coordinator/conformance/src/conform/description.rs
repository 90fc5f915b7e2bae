//! Check of the description of a participant.

use super::bench::TestBench;
use super::check::Check;
use super::fault::{CheckFailure, Finding, broken};
use case::parse_quantity;
use contract::description::{Description, EffectSpec, KeyKind, KeySpec, ModelSpec};
use contract::grid::check_name;
use contract::message::{Command, CommandKind};
use run::format::counted;
use std::time::Instant;

pub(super) const DESCRIBE: Check = Check {
    name: "describe",
    demand: "Describe is answered with a Description, every time the same; names are plain words, \
             models and effects cite their sources, keys are well formed",
    fix: "the descriptions of our solvers: thermal-solver --describe",
    run: describe,
};

fn describe(bench: &TestBench) -> Result<Finding, CheckFailure> {
    let said = &bench.subject.description;
    if said.protocol != contract::PROTOCOL_VERSION {
        let ours = contract::PROTOCOL_VERSION;
        return broken(format!("it speaks protocol {}, this coordinator {ours}", said.protocol));
    }
    if said.role != bench.subject.role {
        return broken(format!("it plays the role `{}`", said.role));
    }
    well_formed(bench, said)?;
    let begun = Instant::now();
    let mut life = bench.joined()?;
    let answer = life.ask(Command::new(CommandKind::Describe), &[])?.done()?;
    let took = begun.elapsed();
    if answer.json::<Description>("a description")? != *said {
        return broken("a second process describes itself differently");
    }
    bench.keep_joined(life);
    Finding::kept(format!(
        "{}, {}, in {:.0} ms",
        counted(said.models.len() as u64, "model"),
        counted(said.effects.len() as u64, "effect"),
        1e3 * took.as_secs_f64()
    ))
}

fn well_formed(bench: &TestBench, said: &Description) -> Result<(), CheckFailure> {
    said.check()?;
    check_name("program", &said.name)?;
    if said.models.is_empty() {
        return broken("it has no model");
    }
    for (index, model) in said.models.iter().enumerate() {
        check_name("model", &model.name)?;
        if said.models[..index].iter().any(|other| other.name == model.name) {
            return broken(format!("two models are called `{}`", model.name));
        }
        well_formed_model(bench, model).map_err(|f| f.at(&format!("model `{}`", model.name)))?;
    }
    for effect in &said.effects {
        check_name("effect", &effect.name)?;
        let place = format!("effect `{}`", effect.name);
        well_formed_effect(bench, said, effect).map_err(|f| f.at(&place))?;
    }
    said.keys.iter().try_for_each(well_formed_key)
}

fn well_formed_model(bench: &TestBench, model: &ModelSpec) -> Result<(), CheckFailure> {
    if model.source.trim().is_empty() || model.summary.trim().is_empty() {
        return broken("it has no summary or cites no source");
    }
    if !model.steady && !model.transient {
        return broken("it answers neither steady nor transient cases");
    }
    known_fields(bench, &model.consumes, &model.provides)?;
    model.keys.iter().try_for_each(well_formed_key)
}

fn well_formed_effect(
    bench: &TestBench,
    said: &Description,
    effect: &EffectSpec,
) -> Result<(), CheckFailure> {
    if effect.source.trim().is_empty() || effect.law.trim().is_empty() {
        return broken("it has no law or cites no source");
    }
    let has = |name: &String| said.models.iter().any(|model| model.name == *name);
    if let Some(unknown) = effect.models.iter().find(|name| !has(name)) {
        return broken(format!("there is no model `{unknown}`"));
    }
    known_fields(bench, &effect.consumes, &effect.provides)?;
    for fields in effect.keys.iter().flat_map(|key| key.consumes.values()) {
        known_fields(bench, fields, &[])?;
    }
    effect.keys.iter().try_for_each(well_formed_key)
}

fn known_fields(
    bench: &TestBench,
    consumes: &[String],
    provides: &[String],
) -> Result<(), CheckFailure> {
    match consumes
        .iter()
        .chain(provides)
        .find(|name| bench.subject.description.field_kind(name).is_none())
    {
        Some(name) => broken(format!("the field `{name}` is in no table and not described")),
        None => Ok(()),
    }
}

fn well_formed_key(key: &KeySpec) -> Result<(), CheckFailure> {
    let path = &key.path;
    let plain = |part: &str| part == "*" || check_name("key", part).is_ok();
    if !path.split('.').all(plain) {
        return broken(format!("the key {path:?} is not made of plain words"));
    }
    if key.help.trim().is_empty() {
        return broken(format!("the key `{path}` has no help"));
    }
    let fits = match (&key.kind, &key.default) {
        (KeyKind::Quantity { unit }, default) => {
            parse_quantity(&format!("1 {unit}"), unit).is_ok()
                && default.as_ref().is_none_or(|value| in_range(key, value.as_f64()))
        }
        (KeyKind::Integer, Some(value)) => value.is_i64() && in_range(key, value.as_f64()),
        (KeyKind::Flag, Some(value)) => value.is_boolean(),
        (KeyKind::Choice { of }, default) => {
            let word = default.as_ref().map(|value| value.as_str().unwrap_or_default());
            !of.is_empty() && word.is_none_or(|word| of.iter().any(|one| one == word))
        }
        (KeyKind::Text | KeyKind::File | KeyKind::NameIn { .. }, Some(value)) => value.is_string(),
        (_, None) => true,
    };
    match fits {
        true => Ok(()),
        false => broken(format!("unit, words or default of the key `{path}` do not fit its type")),
    }
}

fn in_range(key: &KeySpec, value: Option<f64>) -> bool {
    value.is_some_and(|value| {
        key.above.is_none_or(|bound| value > bound)
            && key.at_least.is_none_or(|bound| value >= bound)
            && key.at_most.is_none_or(|bound| value <= bound)
    })
}
