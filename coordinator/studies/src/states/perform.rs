//! The runs from all starts, and which of their answers are the same.

use super::study::{State, Study};
use crate::study::axis::Axis;
use crate::study::levels::reason;
use crate::study::output::Kept;
use crate::study::quantity::{Quantities, Quantity};
use crate::study::{Variant, ends_study, run};
use console::steps::Steps;
use coupling::windows::Windows;
use run::error::RunError;
use run::plan::Planned;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Answers are the same within this part of their quantities: what a tolerance of the coupling leaves, many times over.
const SAME: f64 = 1e-3;

/// What is to be studied.
#[derive(Clone, Debug)]
pub(super) struct Request {
    /// The case file.
    pub(super) case: PathBuf,
    /// What is changed in it for all runs.
    pub(super) base: Variant,
    /// What varies between them.
    pub(super) starts: Axis,
}

/// Runs a steady case from every start.
///
/// # Errors
/// The case is not steady or has no loop, the file system.
pub(super) fn study(
    request: &Request,
    standing: &Planned,
    quiet: bool,
    scratch: &Path,
) -> Result<Study, RunError> {
    let plan = &standing.plan;
    let steady = plan.windows == Windows::Steady;
    if !steady || !plan.scheme.scheme.is_implicit() {
        let why = if steady { "its effects close no loop" } else { "it is not steady" };
        let fix = "write time.mode = \"steady\", and name effects that close a loop";
        let file = request.case.display();
        return Err(RunError::Usage(format!("{file} has one state: {why}; {fix}")));
    }
    let key = &request.starts.key;
    let Some((starts, _)) = request.starts.numbers() else {
        let fix = "write SI numbers";
        return Err(RunError::Usage(format!("--start {key}: a start is no number; {fix}")));
    };
    let quantities = Quantities::of_figures(&plan.figures);
    let mut steps = Steps::new(quiet, starts.len());
    let (mut states, mut failed): (Vec<State>, _) = (Vec::new(), Vec::new());
    let mut known: Vec<Quantity> = Vec::new();
    for (start, written) in starts.into_iter().zip(&request.starts.values) {
        steps.step(&format!("{key} = {written}"));
        let variant = request.base.with(key, written).with("output.fields", "none");
        let summary = match run(&request.case, &variant, scratch) {
            Ok(summary) => summary,
            Err(error) if ends_study(&error) => return Err(error),
            Err(error) => {
                failed.push((start, reason(&error)));
                continue;
            }
        };
        let all = quantities.all(&summary);
        let all = all.iter().filter(|one| !one.key.starts_with("coupling."));
        let values: BTreeMap<String, f64> =
            all.clone().filter_map(|one| Some((one.key.clone(), one.value(&summary)?))).collect();
        for one in all.filter(|one| values.contains_key(&one.key)) {
            if known.iter().all(|other| other.key != one.key) {
                known.push(one.clone());
            }
        }
        let gain = summary["coupling"]["loop_gain"].as_f64();
        match states.iter_mut().find(|state| same(&state.values, &values)) {
            Some(state) => {
                state.starts.push(start);
                state.loop_gain = state.loop_gain.or(gain);
            }
            None => {
                states.push(State { starts: vec![start], loop_gain: gain, stable: None, values });
            }
        }
    }
    steps.finish();
    for state in &mut states {
        state.stable = state.loop_gain.map(|gain| gain < 1.0);
    }
    let differs = |one: &Quantity| {
        let mut values = states.iter().map(|state| state.values.get(&one.key));
        let first = values.next().flatten();
        values.any(|value| match (first, value) {
            (Some(a), Some(b)) => !close(*a, *b),
            (a, b) => a.is_some() != b.is_some(),
        })
    };
    let described = |one: &Quantity| plan.figures.iter().any(|figure| figure.key == one.key);
    let quantities = known.into_iter().filter(|one| described(one));
    let quantities: Vec<Quantity> =
        quantities.filter(|one| states.len() < 2 || differs(one)).collect();
    Ok(Study {
        schema: Study::SCHEMA,
        case: plan.name.clone(),
        title: plan.title.clone(),
        file: request.case.display().to_string(),
        starts: request.starts.clone(),
        quantities,
        states,
        failed,
    })
}

fn same(one: &BTreeMap<String, f64>, other: &BTreeMap<String, f64>) -> bool {
    let equal = |(key, value): (&String, &f64)| other.get(key).is_some_and(|b| close(*value, *b));
    one.len() == other.len() && one.iter().all(equal)
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME * a.abs().max(b.abs())
}
