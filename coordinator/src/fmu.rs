//! `coordinator fmu`: a case or a surrogate as an FMU (FMI 3.0).

mod archive;
mod description;
mod variables;

use crate::drive::{planned, refusal};
use archive::{Entry, OPTIONS, Parts, Resources};
use clap::Args;
use console::case_arguments::{CaseArguments, Changes};
use console::command::{Command, Context, Group};
use console::output;
use contact_fmu::manifest::{Of, SURROGATE};
use contract::description::KeySpec;
use run::error::RunError;
use run::fleet::Fleet;
use run::plan::{Plan, Planned};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use studies::ask;
use surrogate::Document;
use variables::Variables;

/// Options of `coordinator fmu`; the case may be a surrogate instead.
#[derive(Debug, Args)]
pub(crate) struct FmuCommand {
    #[command(flatten)]
    of: CaseArguments,
    /// The FMU to write [default: NAME.fmu].
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
}

impl Command for FmuCommand {
    const NAME: &'static str = "fmu";
    const GROUP: Group = Group::Connect;
    const ABOUT: &'static str = "Write a case or a surrogate as an FMU. Live values and varied keys are inputs, figures are outputs (FMI 3.0)";
    const EXAMPLES: &'static [&'static str] = &["coordinator fmu CASE --out contact.fmu"];

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        let FmuCommand { of, out } = self;
        let made = match is_surrogate(&of.case) {
            false => of_case(of, out.clone())?,
            true if of.changes == Changes::default() => {
                of_surrogate(&ask::document(&of.case)?, out.clone())?
            }
            true => {
                return Err(RunError::Usage(
                    "--set and --unset change a case, and a surrogate has none of its keys any more; leave them out"
                        .to_owned(),
                ));
            }
        };
        if context.quiet { Ok(()) } else { output::print(&made) }
    }
}

/// Returns true for the file of a surrogate, and for the folder of a sweep with one.
fn is_surrogate(path: &Path) -> bool {
    path.extension().is_some_and(|end| end == "json") || path.is_dir()
}

/// Writes the FMU, and returns the text to print.
///
/// # Errors
/// The case is invalid or has no live values, or the file cannot be written.
fn of_case(of: &CaseArguments, path: Option<PathBuf>) -> Result<String, RunError> {
    let mut of = of.clone();
    of.changes.set.extend(OPTIONS.map(str::to_owned));
    let planned = planned(&of, &mut Fleet::for_one_run())?;
    let plan = &planned.plan;
    let variables = Variables::of(plan);
    if variables.inputs.is_empty() {
        return Err(without_inputs(&planned));
    }
    let Resources { entries, options, programs, outside } = archive::gather(&planned)?;
    let parts = Parts {
        name: &plan.name,
        title: plan.title.as_deref(),
        text: &planned.case.text(),
        of: Of::Case { options, programs },
        variables: &variables,
        entries,
    };
    let made = archive::write(parts, path)?;
    for (role, command) in outside {
        tracing::warn!(
            "`{command}`, which plays {role}, is not in the FMU: it has to be on every machine that runs it"
        );
    }
    Ok(made)
}

/// Returns the error for a case without live values.
fn without_inputs(planned: &Planned) -> RunError {
    let Planned { case, plan } = planned;
    let reason = "an FMU has the live values of its case as inputs, and this case has none";
    let keys: Vec<String> = may_vary(plan).into_iter().collect();
    let fix = format!(
        "write one of {} as {{ at = ..., from = ..., to = ... }}: its first value, and the limits \
         of all others",
        keys.join(", ")
    );
    refusal(case, "case.name", reason, fix)
}

/// Returns the keys of a case that may vary.
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

/// Writes the FMU, and returns the text to print.
///
/// # Errors
/// The file cannot be written.
fn of_surrogate(document: &Document, path: Option<PathBuf>) -> Result<String, RunError> {
    let text = serde_json::to_string(document).expect("a surrogate is plain data");
    let entry = Entry {
        name: format!("resources/{SURROGATE}"),
        content: text.clone().into_bytes(),
        executable: false,
    };
    let parts = Parts {
        name: &document.origin.case,
        title: None,
        text: &text,
        of: Of::Surrogate,
        variables: &Variables::of_surrogate(document),
        entries: vec![entry],
    };
    archive::write(parts, path)
}
