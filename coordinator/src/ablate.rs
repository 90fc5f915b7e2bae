//! `coordinator ablate`: what each effect changes, and what it costs.
//!
//! A case is run as it is, and once more without each of its effects. The difference in the answer is what
//! the effect is worth in this scene; the difference in time is its price. Effects that need another, or
//! that a model cannot do without, are reported with the reason. Which effects there are is in the
//! plan; nothing here names one.

mod cli;
mod page;
mod show;

pub use cli::{Arguments, main};
pub use page::page;

use crate::study::levels::reason;
use crate::study::progress::Steps;
use crate::study::quantity::{Measure, Quantity};
use crate::study::spent::{Clock, Spent};
use crate::study::{Variant, ends_study, perform, planned};
use run::error::RunError;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Name of a study in its folder.
pub const FILE: &str = "ablate.json";
/// Version of its layout.
const SCHEMA: u32 = 1;

/// A study, as `ablate.json` has it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Study {
    /// Version of this layout.
    pub schema: u32,
    /// Name of the case.
    pub case: String,
    /// What the case is about.
    pub title: Option<String>,
    /// The case file.
    pub file: String,
    /// Keys of the quantities of interest that the runs have.
    pub quantities: Vec<String>,
    /// The case as it is.
    pub whole: Run,
    /// The case without each of its effects.
    pub without: Vec<Run>,
}

/// One run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// The effect that is off; empty for the case as it is.
    pub effect: String,
    /// Why it has no quantities.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failed: Option<String>,
    /// Its quantities by key.
    pub values: BTreeMap<String, f64>,
    /// Its quantities' change against the case as it is, by key: relative, or the difference for a
    /// place or a share; absent for a quantity that one of the two does not have.
    pub changes: BTreeMap<String, f64>,
    /// What it cost.
    pub cost: Spent,
}

impl Run {
    fn take(&mut self, summary: &Value, clock: &Clock) {
        let cost = Spent::of(summary, clock);
        if self.values.is_empty() || cost.solve_s < self.cost.solve_s {
            self.cost = cost;
        }
        let values = Quantity::of_interest().into_iter();
        self.values =
            values.filter_map(|one| Some((one.key.clone(), one.value(summary)?))).collect();
    }

    fn compare(&mut self, whole: &Self) {
        let change = |(key, value): (&String, &f64)| {
            let with = *whole.values.get(key)?;
            let change = match Quantity::of(key).measure {
                Measure::Relative if with == *value => 0.0,
                // Of what has a sign and keeps it, the size counts.
                Measure::Relative if value * with > 0.0 => value / with - 1.0,
                Measure::Relative => (value - with) / with.abs(),
                Measure::Absolute | Measure::Itself => value - with,
            };
            change.is_finite().then(|| (key.clone(), change))
        };
        self.changes = self.values.iter().filter_map(change).collect();
    }
}

/// What is to be studied.
#[derive(Clone, Debug)]
struct Request {
    /// The case file.
    case: PathBuf,
    /// What is changed in it for all runs.
    base: Variant,
    /// How often each run is made; its times are the least.
    repeat: u32,
}

/// Runs a case as it is and without each of its effects.
///
/// # Errors
/// The case as it is does not run; the file system.
fn study(request: &Request, quiet: bool, scratch: &Path) -> Result<Study, RunError> {
    let Request { case, base, .. } = request;
    let standing = planned(case, base)?;
    let plan = standing.plan;
    let active: Vec<&str> =
        plan.effects.iter().filter(|effect| effect.active).map(|e| e.name.as_str()).collect();
    let mut steps = Steps::new(quiet, active.len() + 1);
    steps.step("with all effects");
    let whole = run("", request, base, scratch)?;
    if let Some(why) = whole.failed {
        return Err(RunError::Usage(format!("the unmodified case does not run: {why}")));
    }
    let mut without = Vec::new();
    for effect in active {
        steps.step(&format!("without {effect}"));
        let mut off = base.clone();
        off.unset.push(format!("effects.{effect}"));
        let mut run = run(effect, request, &off, scratch)?;
        run.compare(&whole);
        without.push(run);
    }
    steps.finish();
    let known = |one: &Quantity| {
        let mut all = without.iter().chain([&whole]);
        all.any(|run| run.values.contains_key(&one.key))
    };
    let quantities = Quantity::of_interest().into_iter().filter(known).map(|one| one.key);
    Ok(Study {
        schema: SCHEMA,
        case: plan.name.clone(),
        title: plan.title.clone(),
        file: case.display().to_string(),
        quantities: quantities.collect(),
        whole,
        without,
    })
}

/// One run, as often as is asked; what is refused or fails has a reason and no quantities.
fn run(effect: &str, request: &Request, off: &Variant, scratch: &Path) -> Result<Run, RunError> {
    let mut run = Run { effect: effect.to_owned(), ..Run::default() };
    let silent = off.with("output.fields", "none");
    for _ in 0..request.repeat {
        let clock = Clock::start();
        let made = planned(&request.case, &silent);
        match made.and_then(|planned| perform(&request.case, &planned, clock.since, scratch)) {
            Ok(summary) => run.take(&summary, &clock),
            Err(error) if ends_study(&error) => return Err(error),
            Err(error) => {
                run.failed = Some(reason(&error));
                break;
            }
        }
    }
    Ok(run)
}
