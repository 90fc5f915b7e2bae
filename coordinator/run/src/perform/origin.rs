//! Origin of a run, and the check that a resumed run has the same origin.

use crate::checkpoint::Origin;
use crate::error::RunError;
use crate::identity::{Identity, keys};
use crate::plan::{Participant, Planned};
use crate::sealed::sum;
use contract::configuration::Configuration;
use coupling::ParticipantIndex;
use serde_json::json;
use std::path::{Path, absolute};

fn numbers(of: &[ParticipantIndex]) -> Vec<usize> {
    of.iter().map(|&one| one.into()).collect()
}

/// Returns the origin of a planned run.
///
/// # Errors
/// A file that the case names cannot be read.
pub fn origin(planned: &Planned) -> Result<Origin, RunError> {
    let Planned { case, plan } = planned;
    let participants = plan.participants.iter().map(|p| (p.role.clone(), identity(p)));
    let routes: Vec<_> = plan
        .fields
        .iter()
        .map(|f| {
            json!([
                f.kind,
                usize::from(f.producer),
                numbers(&f.consumers),
                numbers(&f.fed_back),
                f.wanted
            ])
        })
        .collect();
    let routes = sum(json!([plan.scheme.scheme.word(), routes]).to_string().as_bytes());
    let routes = ("the routing of the fields".to_owned(), routes);
    let folder = case.folder();
    // Empty for a case in the working directory, which has no absolute path of its own.
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    Ok(Origin {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        protocol: contract::PROTOCOL_VERSION,
        case: case.text(),
        folder: absolute(folder).unwrap_or_else(|_| folder.to_owned()),
        plan: participants.chain([routes]).collect(),
        files: Identity::files(planned)?,
    })
}

/// Returns the checksum of a participant, used to check that a run can be resumed. It covers the
/// description with its version, the configuration, and the grids of the estimate. The number of
/// threads does not count, because results do not depend on it.
fn identity(participant: &Participant) -> u64 {
    let layout = participant
        .estimate
        .as_ref()
        .map(|layout| json!([layout.grids, layout.fields, layout.inputs, layout.moving]));
    let configuration = Configuration { threads: 1, ..participant.configuration.clone() };
    let all = json!([*participant.description, configuration, layout]);
    sum(all.to_string().as_bytes())
}

/// Checks that a run has the same origin as its checkpoint.
///
/// # Errors
/// [`RunError::Usage`] names the first difference.
pub fn check_origin(expected: &Origin, found: &Origin) -> Result<(), RunError> {
    let refuse = |what: String| {
        Err(RunError::Usage(format!(
            "the run cannot be resumed: {what}; start the case from the beginning"
        )))
    };
    let versions = |of: &Origin| format!("coordinator {}, protocol {}", of.version, of.protocol);
    if versions(expected) != versions(found) {
        let (was, is) = (versions(expected), versions(found));
        return refuse(format!("its checkpoint was written by {was}, this is {is}"));
    }
    if expected.case != found.case {
        return refuse("case.toml is not the case of its checkpoint".to_owned());
    }
    let mut files = keys(&expected.files, &found.files).into_iter();
    if let Some(key) = files.find(|key| expected.files.get(*key) != found.files.get(*key)) {
        return refuse(format!("the content of the file that `{key}` names changed"));
    }
    let differs = |(part, now): &(&(String, u64), &(String, u64))| part != now;
    let mut parts = expected.plan.iter().zip(&found.plan);
    match parts.find(differs) {
        Some(((name, _), _)) => refuse(format!("{name} differs from its state at the checkpoint")),
        None if expected.plan.len() != found.plan.len() => {
            refuse("it has other participants than at the checkpoint".to_owned())
        }
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;
    use std::path::PathBuf;

    #[test]
    fn what_differs_is_named() {
        let was = Origin {
            version: "1".to_owned(),
            protocol: 2,
            case: "a".to_owned(),
            folder: PathBuf::from("/a"),
            plan: vec![("mech".to_owned(), 1), ("thermal".to_owned(), 2)],
            files: BTreeMap::from([("bodies.rail.profile".to_owned(), "1".to_owned())]),
        };
        assert!(check_origin(&was, &was).is_ok());
        let moved = Origin { folder: PathBuf::from("/b"), ..was.clone() };
        assert!(check_origin(&was, &moved).is_ok(), "paths are in the configurations");
        let mut thermal = was.clone();
        thermal.plan[1].1 = 3;
        let mut profile = was.clone();
        profile.files.insert("bodies.rail.profile".to_owned(), "2".to_owned());
        let rows = [
            (profile, "the file that `bodies.rail.profile` names"),
            (Origin { version: "2".to_owned(), ..was.clone() }, "this is coordinator 2"),
            (Origin { protocol: 3, ..was.clone() }, "protocol 3"),
            (Origin { case: "b".to_owned(), ..was.clone() }, "case.toml"),
            (thermal, "thermal differs"),
            (Origin { plan: was.plan[..1].to_vec(), ..was.clone() }, "other participants"),
        ];
        for (found, part) in rows {
            let error = check_origin(&was, &found).unwrap_err();
            assert_eq!(error.exit_code(), 2);
            assert!(error.to_string().contains(part), "{error}");
        }
    }
}
