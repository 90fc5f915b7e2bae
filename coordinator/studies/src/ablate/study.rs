//! Runs and results of an ablation: `ablate.json`.

use crate::advise::{Advised, advise};
use crate::study::levels::reason;
use crate::study::output::StudyFile;
use crate::study::quantity::{Quantities, Quantity};
use crate::study::runner::{Attempt, Outcome, Point, Runner};
use crate::study::spent::RunCost;
use crate::study::variants::Variants;
use console::case_arguments::CaseArguments;
use contract::advice::{Advice, Change, SIGNIFICANT_CHANGE};
use run::error::RunError;
use run::plan::Planned;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Factor within which first-order advice counts as agreeing with a run.
const FACTOR: f64 = 3.0;

/// Contents of `ablate.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Study {
    /// Version of the file's layout.
    pub schema: u32,
    /// Name of the case.
    pub case: String,
    /// Title of the case.
    pub title: Option<String>,
    /// The case file.
    pub file: String,
    /// Quantities of interest that occur in the runs.
    pub quantities: Vec<Quantity>,
    /// Run of the unmodified case.
    pub whole: Run,
    /// Runs without each of the case's effects.
    pub without: Vec<Run>,
    /// Runs with each advised effect that the case lacks.
    #[serde(default)]
    pub with: Vec<Run>,
    /// Advice given before the runs, compared with the measurements.
    #[serde(default)]
    pub advice: Vec<Judged>,
}

/// Advice for one effect, compared with the measurement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Judged {
    /// Name of the effect.
    pub effect: String,
    /// Key of the figure that the effect should change most; empty if the case should have no
    /// result with the effect.
    pub figure: String,
    /// Advised relative change; absent if the figure does not exist without the effect.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub advised: Option<f64>,
    /// Measured relative change; absent if one of the runs lacks the figure.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measured: Option<f64>,
    /// Whether both agree: in sign and, up to a factor of three, in size; or both are too small to
    /// matter.
    pub agrees: bool,
}

impl StudyFile for Study {
    const COMMAND: &'static str = "ablate";
    const FILE: &'static str = "ablate.json";
    const SCHEMA: u32 = 3;
}

/// One run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Run {
    /// Effect that is switched off or added; empty for the unmodified case.
    pub effect: String,
    /// Reason why the run has no quantities.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failed: Option<String>,
    /// Values of the quantities by key.
    pub values: BTreeMap<String, f64>,
    /// Changes relative to the unmodified case by key: relative changes, or differences for
    /// positions and fractions. Absent if one of the two runs lacks the quantity.
    pub changes: BTreeMap<String, f64>,
    /// Cost of the run.
    pub cost: RunCost,
}

impl Run {
    /// Converts an attempt without, or with, an effect. A failed or refused attempt has a reason
    /// and no quantities.
    fn of(effect: &str, attempt: Attempt, quantities: &[Quantity]) -> Self {
        let run = Self { effect: effect.to_owned(), ..Self::default() };
        match attempt.outcome {
            Outcome::Finished(made) => {
                let value = |one: &Quantity| Some((one.key.clone(), one.value(&made.summary)?));
                let values = quantities.iter().filter_map(value).collect();
                Self { values, cost: made.spent, ..run }
            }
            Outcome::Failed(error) => Self { failed: Some(reason(&error)), ..run },
            Outcome::LeftOut(why) => Self { failed: Some(why), ..run },
        }
    }

    /// Computes the changes of the quantities relative to the unmodified case.
    pub(super) fn compare(&mut self, whole: &Self, quantities: &[Quantity]) {
        let change = |quantity: &Quantity| {
            let key = &quantity.key;
            let (value, with) = (*self.values.get(key)?, *whole.values.get(key)?);
            Some((key.clone(), quantity.change(with, value)?))
        };
        self.changes = quantities.iter().filter_map(change).collect();
    }
}

/// Runs a case unmodified, without each of its effects, and with each advised effect that the case
/// lacks.
///
/// # Errors
/// The unmodified case does not run, or the file system fails.
pub(super) fn study(
    of: &CaseArguments,
    standing: &Planned,
    runner: &mut Runner<'_, Variants<'_>>,
) -> Result<Study, RunError> {
    let advised = advise(&of.case, &of.changes, standing, &mut runner.bench)?;
    let plan = &standing.plan;
    let quantities = Quantities::of_figures(&plan.figures);
    let mut interest = quantities.of_interest.clone();
    for change in advised.iter().filter_map(|one| one.advice.change.as_ref()) {
        if interest.iter().all(|known| known.key != change.figure) {
            interest.push(quantities.of(&change.figure));
        }
    }
    let active: Vec<&str> =
        plan.effects.iter().filter(|effect| effect.active).map(|e| e.name.as_str()).collect();
    let missing: Vec<&Advised> = advised.iter().filter(|one| one.is_missing()).collect();
    let whole = Point { name: "with all effects".to_owned(), changes: of.changes.clone() };
    let without = active.iter().map(|effect| {
        let mut changes = of.changes.clone();
        changes.unset.push(format!("effects.{effect}"));
        Point { name: format!("without {effect}"), changes }
    });
    let with = missing.iter().map(|one| Point {
        name: format!("with {}", one.advice.effect),
        changes: one.changes(&of.changes),
    });
    let points: Vec<Point> = std::iter::once(whole).chain(without).chain(with).collect();
    let effects = active.iter().copied().chain(missing.iter().map(|one| &*one.advice.effect));
    let effects: Vec<&str> = std::iter::once("").chain(effects).collect();
    let mut runs: Vec<Run> = Vec::new();
    runner.run(&points, |n, attempt| {
        let mut run = Run::of(effects[n], attempt, &interest);
        match (runs.first(), &run.failed) {
            (Some(whole), _) => run.compare(whole, &interest),
            (None, Some(why)) => {
                let why = format!("the unmodified case does not run: {why}");
                return Err(RunError::Usage(why));
            }
            (None, None) => {}
        }
        runs.push(run);
        Ok(())
    })?;
    let known = |one: &&Quantity| runs.iter().any(|run| run.values.contains_key(&one.key));
    let quantities = interest.iter().filter(known).cloned().collect();
    let with = runs.split_off(1 + active.len());
    let without = runs.split_off(1);
    let whole = runs.remove(0);
    let judged = advised.iter().filter_map(|one| {
        let others = if one.active { &without } else { &with };
        let other = others.iter().find(|run| run.effect == one.advice.effect)?;
        let (on, off) = if one.active { (&whole, other) } else { (other, &whole) };
        judge(&one.advice, on, off)
    });
    let advice = judged.collect();
    Ok(Study {
        schema: Study::SCHEMA,
        case: plan.name.clone(),
        title: plan.title.clone(),
        file: of.case.display().to_string(),
        quantities,
        whole,
        without,
        with,
        advice,
    })
}

/// Compares advice with the runs with and without the effect; `None` without advice or if a run
/// failed.
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
        // If both values have the same sign, compare magnitudes.
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

/// Returns whether both agree in sign and up to a factor in size, or are both too small to matter.
fn agree(advised: f64, measured: f64) -> bool {
    if advised.abs() < SIGNIFICANT_CHANGE && measured.abs() < SIGNIFICANT_CHANGE {
        return true;
    }
    let ratio = advised / measured;
    (1.0 / FACTOR..=FACTOR).contains(&ratio)
}
