//! The runs: the case as it is, once more without each of its effects, and with each that is advised.

use super::study::{Judged, Run, Study};
use crate::advise::advise;
use crate::study::levels::reason;
use crate::study::output::Kept;
use crate::study::quantity::{Quantities, Quantity};
use crate::study::spent::Stopwatch;
use crate::study::{Variant, ends_study, perform, planned};
use console::steps::Steps;
use contract::advice::{Advice, Change, MATTERS};
use run::error::RunError;
use std::path::{Path, PathBuf};

/// Within which advice of the first order agrees with a run.
const FACTOR: f64 = 3.0;

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

/// Runs a case as it is, without each of its effects, and with each that it lacks and that is advised.
///
/// # Errors
/// The case as it is does not run; the file system.
pub(super) fn study(request: &Request, quiet: bool, scratch: &Path) -> Result<Study, RunError> {
    let Request { case, base, .. } = request;
    let standing = planned(case, base)?;
    let advised = advise(case, base, &standing)?;
    let plan = standing.plan;
    let quantities = Quantities::of_figures(&plan.figures);
    let mut interest = quantities.of_interest.clone();
    for change in advised.iter().filter_map(|one| one.advice.change.as_ref()) {
        if interest.iter().all(|known| known.key != change.figure) {
            interest.push(quantities.of(&change.figure));
        }
    }
    let active: Vec<&str> =
        plan.effects.iter().filter(|effect| effect.active).map(|e| e.name.as_str()).collect();
    let missing = advised.iter().filter(|one| one.is_missing()).count();
    let mut steps = Steps::new(quiet, active.len() + 1 + missing);
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
    let mut with = Vec::new();
    for one in advised.iter().filter(|one| one.is_missing()) {
        let effect = &one.advice.effect;
        steps.step(&format!("with {effect}"));
        let mut run = run(effect, request, &one.variant(base), (&interest, scratch))?;
        run.compare(&whole, &interest);
        with.push(run);
    }
    steps.finish();
    let judged = advised.iter().filter_map(|one| {
        let others = if one.active { &without } else { &with };
        let other = others.iter().find(|run| run.effect == one.advice.effect)?;
        let (on, off) = if one.active { (&whole, other) } else { (other, &whole) };
        judge(&one.advice, on, off)
    });
    let judged = judged.collect();
    let known = |one: &Quantity| {
        let mut all = without.iter().chain(&with).chain([&whole]);
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
        with,
        advice: judged,
    })
}

/// Advice beside the runs with and without the effect; `None` where nothing was said, or no run was made.
fn judge(advice: &Advice, on: &Run, off: &Run) -> Option<Judged> {
    if advice.impossible {
        let (effect, figure) = (advice.effect.clone(), String::new());
        let agrees = on.failed.is_some();
        return Some(Judged { effect, figure, advised: None, measured: None, agrees });
    }
    let Change { figure, relative } = advice.change.as_ref()?;
    if on.failed.is_some() || off.failed.is_some() {
        return None;
    }
    let of = |run: &Run| run.values.get(figure).copied();
    let measured = match (of(on), of(off)) {
        (Some(on), Some(off)) if on == off => Some(0.0),
        // Of what has a sign and keeps it, the size counts.
        (Some(on), Some(off)) if on * off > 0.0 => Some(on / off - 1.0),
        (Some(on), Some(off)) => Some((on - off) / off.abs()),
        _ => None,
    };
    let agrees = match (relative.is_finite(), measured) {
        (true, Some(measured)) => agree(*relative, measured),
        (true, None) => false,
        (false, _) => of(on).is_some_and(|on| on != 0.0) && of(off).is_none_or(|off| off == 0.0),
    };
    let advised = relative.is_finite().then_some(*relative);
    Some(Judged {
        effect: advice.effect.clone(),
        figure: figure.clone(),
        advised,
        measured,
        agrees,
    })
}

/// Sign, and size to a factor; or both below what matters.
fn agree(advised: f64, measured: f64) -> bool {
    if advised.abs() < MATTERS && measured.abs() < MATTERS {
        return true;
    }
    let ratio = advised / measured;
    (1.0 / FACTOR..=FACTOR).contains(&ratio)
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
