//! The runs: the case as it is, and once more without each of its effects.

use super::study::{Run, Study};
use crate::study::levels::reason;
use crate::study::output::Kept;
use crate::study::progress::Steps;
use crate::study::quantity::{Quantities, Quantity};
use crate::study::spent::Stopwatch;
use crate::study::{Variant, ends_study, perform, planned};
use run::error::RunError;
use std::path::{Path, PathBuf};

/// What is to be studied.
#[derive(Clone, Debug)]
pub(super) struct Request {
    /// The case file.
    pub(super) case: PathBuf,
    /// What is changed in it for all runs.
    pub(super) base: Variant,
    /// How often each run is made; its times are the least.
    pub(super) repeat: u32,
}

/// Runs a case as it is and without each of its effects.
///
/// # Errors
/// The case as it is does not run; the file system.
pub(super) fn study(request: &Request, quiet: bool, scratch: &Path) -> Result<Study, RunError> {
    let Request { case, base, .. } = request;
    let standing = planned(case, base)?;
    let plan = standing.plan;
    let interest = Quantities::of_figures(&plan.figures).of_interest;
    let active: Vec<&str> =
        plan.effects.iter().filter(|effect| effect.active).map(|e| e.name.as_str()).collect();
    let mut steps = Steps::new(quiet, active.len() + 1);
    steps.step("with all effects");
    let whole = run("", request, base, (&interest, scratch))?;
    if let Some(why) = whole.failed {
        return Err(RunError::Usage(format!("the unmodified case does not run: {why}")));
    }
    let mut without = Vec::new();
    for effect in active {
        steps.step(&format!("without {effect}"));
        let mut off = base.clone();
        off.unset.push(format!("effects.{effect}"));
        let mut run = run(effect, request, &off, (&interest, scratch))?;
        run.compare(&whole, &interest);
        without.push(run);
    }
    steps.finish();
    let known = |one: &Quantity| {
        let mut all = without.iter().chain([&whole]);
        all.any(|run| run.values.contains_key(&one.key))
    };
    let quantities: Vec<Quantity> = interest.iter().filter(|one| known(one)).cloned().collect();
    Ok(Study {
        schema: Study::SCHEMA,
        case: plan.name.clone(),
        title: plan.title.clone(),
        file: case.display().to_string(),
        quantities,
        whole,
        without,
    })
}

/// One run, as often as is asked; what is refused or fails has a reason and no quantities.
fn run(
    effect: &str,
    request: &Request,
    off: &Variant,
    (interest, scratch): (&[Quantity], &Path),
) -> Result<Run, RunError> {
    let mut run = Run { effect: effect.to_owned(), ..Run::default() };
    let silent = off.with("output.fields", "none");
    for _ in 0..request.repeat {
        let stopwatch = Stopwatch::start();
        let made = planned(&request.case, &silent);
        match made.and_then(|planned| perform(&request.case, &planned, stopwatch.since, scratch)) {
            Ok(summary) => run.take(&summary, interest, &stopwatch),
            Err(error) if ends_study(&error) => return Err(error),
            Err(error) => {
                run.failed = Some(reason(&error));
                break;
            }
        }
    }
    Ok(run)
}
