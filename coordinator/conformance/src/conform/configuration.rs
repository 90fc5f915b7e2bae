//! Checks of runs and configurations that a participant must accept or refuse.

use super::bench::TestBench;
use super::check::Check;
use super::fault::{CheckFailure, Finding, broken};
use super::life::{Subject, nothing_left};
use super::setting::Setting;
use contract::configuration::Configuration;
use contract::description::{Description, KeySpec};
use contract::message::{Command, CommandKind};
use contract::params::Params;
use proto::run_dir::{RunDir, RunInfo};
use run::supervise::{Launch, Supervisor};
use serde_json::{Value, json};
use std::{fs, slice};

pub(super) const VERSION: Check = Check {
    name: "version",
    demand: "a run of another version of the contract is not joined: the program ends with an error \
             that names both versions and with an exit code other than 0, and leaves nothing",
    fix: "compare `protocol` of run.json with your own before anything else",
    run: version,
};

pub(super) const CONFIGURE: Check = Check {
    name: "configure",
    demand: "Configure answers with a Layout that places every output, observed field and wish on a \
             grid of its own; the same configuration always gives the same layout",
    fix: "fields and grids of the Layout",
    run: configure,
};

pub(super) const UNKNOWN_MODEL: Check = Check {
    name: "unknown-model",
    demand: "a configuration with a model that is not described is refused with key, reason and fix; \
             a valid one is accepted afterwards",
    fix: "status 2 and {key, reason, fix}; stay in the loop",
    run: unknown_model,
};

pub(super) const UNKNOWN_EFFECT: Check = Check {
    name: "unknown-effect",
    demand: "a configuration whose case has an effect that is not described is refused, naming it; \
             a valid one is accepted afterwards",
    fix: "the names under `case.effects`",
    run: unknown_effect,
};

pub(super) const MISSING_KEY: Check = Check {
    name: "missing-key",
    demand: "a configuration that lacks a required key is refused with that key; a valid one is accepted \
             afterwards",
    fix: "read required keys without a default of your own",
    run: missing_key,
};

pub(super) const UNKNOWN_FIELD: Check = Check {
    name: "unknown-field",
    demand: "a configuration that asks for a field that is not provided is refused; a valid one is \
             accepted afterwards",
    fix: "`outputs` and `observed` of the configuration",
    run: unknown_field,
};

/// A version that no program uses.
const OTHER_VERSION: u32 = 999;

fn version(bench: &TestBench) -> Result<Finding, CheckFailure> {
    let Subject { role, program, patience, .. } = bench.subject.clone();
    let run = RunDir::create(slice::from_ref(&role))?;
    let info = RunInfo { protocol: OTHER_VERSION, ..run.info().clone() };
    fs::write(info.folder.join("run.json"), json!(info).to_string())?;
    let supervisor = Supervisor::start(&[Launch { role, program }], &info.folder)
        .map_err(|(_, error)| format!("it does not start: {error}"))?;
    let exit = match supervisor.wait_for_exits(patience) {
        true => supervisor.exits().pop(),
        false => None,
    };
    drop((supervisor, run));
    let exit = exit.ok_or_else(|| "it stays in a run of another version".to_owned())?;
    nothing_left(&info)?;
    let words = exit.last_words.clone().unwrap_or_default();
    if exit.is_success() {
        return broken(format!("it {}", exit));
    }
    let numbers =
        [OTHER_VERSION, bench.subject.description.protocol].map(|number| number.to_string());
    match numbers.iter().find(|number| !words.contains(*number)) {
        Some(number) => broken(format!("it {}; {number} is not named", exit)),
        None => Finding::kept(words),
    }
}

fn configure(bench: &TestBench) -> Result<Finding, CheckFailure> {
    if let Some(left_out) = bench.misled.first() {
        return broken(left_out.clone());
    }
    bench.each(|setting| {
        let mut life = bench.joined()?;
        let first = life.configure(&setting.configuration)?;
        if life.configure(&setting.configuration)? != first {
            return broken("a second Configure answers with another layout");
        }
        bench.keep_joined(life);
        let names: Vec<&str> = first.grids.iter().map(|grid| grid.name.as_str()).collect();
        Finding::kept(match names.is_empty() {
            true => "no grid".to_owned(),
            false => format!("grids {}", names.join(", ")),
        })
    })
}

/// Sends a wrong configuration, expects its refusal, and then sends a good one. Returns the text of
/// the refusal.
fn refuses(
    bench: &TestBench,
    setting: &Setting,
    (because, key): (&str, Option<&str>),
    spoil: impl FnOnce(&mut Configuration),
) -> Result<String, CheckFailure> {
    let mut wrong = setting.configuration.clone();
    spoil(&mut wrong);
    let mut life = bench.joined()?;
    let answer = life.ask_with(Command::new(CommandKind::Configure), &wrong)?;
    let refusal = answer.refused(because)?;
    if let Some(key) = key.filter(|key| refusal.key != *key) {
        return broken(format!("{because} is refused with the key `{}`, not `{key}`", refusal.key));
    }
    let good = life.configure(&setting.configuration);
    good.map_err(|fault| fault.at("after a refusal"))?;
    bench.keep_joined(life);
    Ok(refusal.to_string())
}

fn unknown_model(bench: &TestBench) -> Result<Finding, CheckFailure> {
    let because = ("a model that does not exist", None);
    let message = refuses(bench, bench.first()?, because, |configuration| {
        "no-such-model".clone_into(&mut configuration.model);
    })?;
    Finding::kept(message)
}

fn unknown_effect(bench: &TestBench) -> Result<Finding, CheckFailure> {
    let because = ("an effect that does not exist", Some("effects.no_such_effect"));
    let message = refuses(bench, bench.first()?, because, |configuration| {
        if let Some(case) = configuration.case.0.as_object_mut() {
            let effects = case.entry("effects").or_insert_with(|| json!({}));
            effects["no_such_effect"] = json!({});
        }
    })?;
    Finding::kept(message)
}

fn unknown_field(bench: &TestBench) -> Result<Finding, CheckFailure> {
    let setting = bench.first()?;
    for observed in [false, true] {
        refuses(bench, setting, ("a field that it does not provide", None), |configuration| {
            let list =
                if observed { &mut configuration.observed } else { &mut configuration.outputs };
            list.push("no_such_field".to_owned());
        })?;
    }
    Finding::kept("as an output and as an observed field")
}

fn missing_key(bench: &TestBench) -> Result<Finding, CheckFailure> {
    bench.each(|setting| {
        let keys = required(&bench.subject.description, &setting.configuration);
        if keys.is_empty() {
            return Finding::inapplicable("no key is required");
        }
        for key in &keys {
            let because = format!("the missing key `{key}`");
            refuses(bench, setting, (&because, Some(key)), |configuration| {
                remove(&mut configuration.case.0, key);
            })?;
        }
        Finding::kept(keys.join(", "))
    })
}

/// Returns the required keys of a configuration, with their actual names.
fn required(said: &Description, configuration: &Configuration) -> Vec<String> {
    let model = said.models.iter().filter(|model| model.name == configuration.model);
    let effects = said.effects.iter().filter(|effect| configuration.has_effect(&effect.name));
    let specs = said.keys.iter().chain(model.flat_map(|m| &m.keys));
    let specs = specs.chain(effects.flat_map(|effect| &effect.keys));
    // Keys with alternatives, and keys that are required only together, are excluded.
    let alone = |spec: &&KeySpec| spec.one_of.is_none() && spec.together.is_none();
    let needed = specs.filter(|spec| spec.required).filter(alone);
    let mut keys: Vec<String> =
        needed.flat_map(|spec| instances(&configuration.case, &spec.path)).collect();
    keys.dedup();
    keys
}

/// Returns the keys of a case that match a path with `*`.
fn instances(case: &Params, path: &str) -> Vec<String> {
    let Some((table, rest)) = path.split_once(".*.") else {
        return if case.has(path) { vec![path.to_owned()] } else { Vec::new() };
    };
    let names = case.get(table).and_then(Value::as_object).into_iter().flatten();
    names.flat_map(|(name, _)| instances(case, &format!("{table}.{name}.{rest}"))).collect()
}

fn remove(tree: &mut Value, key: &str) {
    match key.split_once('.') {
        Some((table, rest)) => {
            if let Some(inner) = tree.get_mut(table) {
                remove(inner, rest);
            }
        }
        None => {
            tree.as_object_mut().map(|table| table.remove(key));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_with_a_star_are_found_and_removed() {
        let mut case = Params(json!({"materials": {"a": {"x": 1}, "b": {"x": 2, "y": 3}}, "n": 4}));
        assert_eq!(instances(&case, "materials.*.x"), ["materials.a.x", "materials.b.x"]);
        assert_eq!(instances(&case, "materials.*.y"), ["materials.b.y"]);
        assert_eq!((instances(&case, "n"), instances(&case, "m")), (vec!["n".to_owned()], vec![]));
        remove(&mut case.0, "materials.b.x");
        remove(&mut case.0, "absent.key");
        assert_eq!(case.0, json!({"materials": {"a": {"x": 1}, "b": {"y": 3}}, "n": 4}));
    }
}
