//! The FMU of a case.

use super::resources::{self, OPTIONS, Resources};
use super::variables::Variables;
use super::whole::{self, Parts};
use crate::drive::planned;
use console::case_arguments::CaseArguments;
use contact_fmu::manifest::Of;
use contract::description::KeySpec;
use run::error::RunError;
use run::plan::{Plan, Planned};
use std::collections::BTreeSet;
use std::path::PathBuf;

/// Writes it; what to print.
///
/// # Errors
/// That of the case, one without live values, the file system.
pub(super) fn make(of: &CaseArguments, path: Option<PathBuf>) -> Result<String, RunError> {
    let mut of = of.clone();
    of.set.extend(OPTIONS.map(str::to_owned));
    let planned = planned(&of)?;
    let plan = &planned.plan;
    let variables = Variables::of(plan);
    if variables.inputs.is_empty() {
        return Err(without_inputs(&planned));
    }
    let Resources { entries, options, programs, outside } = resources::gather(&planned)?;
    let parts = Parts {
        name: &plan.name,
        title: plan.title.as_deref(),
        text: &planned.case.text(),
        of: Of::Case { options, programs },
        variables: &variables,
        entries,
    };
    let made = whole::write(parts, path)?;
    for (role, command) in outside {
        tracing::warn!(
            "`{command}`, which plays {role}, is not in the FMU: it has to be on every machine that runs it"
        );
    }
    Ok(made)
}

/// There is nothing to drive the case by.
fn without_inputs(planned: &Planned) -> RunError {
    let Planned { case, plan } = planned;
    let reason = "an FMU has the live values of its case as inputs, and this case has none";
    let keys: Vec<String> = may_vary(plan).into_iter().collect();
    let fix = format!(
        "write one of {} as {{ at = ..., from = ..., to = ... }}: its first value, and the limits \
         of all others",
        keys.join(", ")
    );
    let problem = case.problem_at("case.name", reason, fix);
    case.report(vec![problem]).expect("there is a problem").into()
}

/// The keys of a case that may vary.
fn may_vary(plan: &Plan) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for one in &plan.participants {
        let description = &one.description;
        let models = description.models.iter().flat_map(|model| &model.keys);
        let effects = description.effects.iter().flat_map(|effect| &effect.keys);
        let all = description.keys.iter().chain(models).chain(effects);
        let read = |spec: &&KeySpec| spec.varies && one.configuration.case.has(&spec.path);
        found.extend(all.filter(read).map(|spec| spec.path.clone()));
    }
    found
}
