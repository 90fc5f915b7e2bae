//! Plans and performs the runs of a study.

use super::study::{Request, Run};
use crate::study::axis::Axis;
use crate::study::levels::{Level, ModelChoices, offered, reason};
use crate::study::quantity::{Quantities, Quantity};
use crate::study::runner::{Attempt, Outcome, Point, Runner};
use crate::study::spent::RunCost;
use crate::study::variants::Variants;
use console::case_arguments::Changes;
use coupling::windows::Windows;
use run::error::RunError;
use run::plan::{Plan, Planned};
use std::collections::{BTreeMap, BTreeSet};

/// Key of the window length.
pub(super) const WINDOW: &str = "time.window";
/// Key of the coupling tolerance.
const TOLERANCE: &str = "coupling.relative";
/// Window lengths of a default plan, relative to the case's own.
const WINDOW_PARTS: [f64; 4] = [4.0, 2.0, 1.0, 0.5];
/// Coupling tolerances of a default plan.
const TOLERANCES: [&str; 4] = ["1e-2", "1e-4", "1e-6", "1e-10"];
/// Results of all runs of a study.
#[derive(Debug)]
pub(super) struct Sweep {
    pub(super) levels: Vec<Level>,
    pub(super) refused: Vec<(String, String)>,
    /// Varied keys besides models and resolutions, each from the coarsest to the finest value.
    pub(super) axes: Vec<Axis>,
    pub(super) runs: Vec<Run>,
    pub(super) left_out: Vec<(String, String)>,
    /// Quantities for which participants have a closed form.
    pub(super) closed_forms: BTreeMap<String, f64>,
    pub(super) known: Quantities,
    pub(super) name: String,
    pub(super) title: Option<String>,
}

/// Models, resolution and all other settings of a run.
#[derive(Clone, Debug)]
struct Setting {
    level: usize,
    step: usize,
    settings: Vec<(String, String)>,
    variant: Changes,
}

/// Performs the runs of a request.
pub(super) fn sweep(
    request: &Request,
    standing: &Planned,
    runner: &mut Runner<'_, Variants<'_>>,
) -> Result<Sweep, RunError> {
    let ModelChoices { mut levels, refused } =
        offered(&request.case, &request.base, &mut runner.bench)?;
    check(&levels, &refused, &request.vary)?;
    let set = request.base.values().map(|(key, value)| Axis::of_one(key, value));
    let held: Vec<Axis> = request.vary.iter().cloned().chain(set).collect();
    choose(&mut levels, &held);
    let axes = axes(&levels, request, &standing.plan);
    let mut sweep = Sweep {
        refused,
        axes,
        runs: Vec::new(),
        left_out: Vec::new(),
        closed_forms: BTreeMap::new(),
        known: Quantities::of_figures(&standing.plan.figures),
        name: standing.plan.name.clone(),
        title: standing.plan.title.clone(),
        levels,
    };
    let settings = sweep.settings();
    let point = |one: &Setting| Point { name: sweep.describe(one), changes: one.variant.clone() };
    let points: Vec<Point> = settings.iter().map(point).collect();
    runner.run(&points, |n, attempt| {
        sweep.take(&settings[n], attempt);
        Ok(())
    })?;
    Ok(sweep)
}

/// Prefixes of numerical keys, besides the roles: keys that change how a case is solved, but not
/// the problem.
const NUMERICAL: [&str; 3] = ["time.", "coupling.", "mapping."];

/// Checks that varied keys exist and leave the problem unchanged.
fn check(levels: &[Level], refused: &[(String, String)], vary: &[Axis]) -> Result<(), RunError> {
    let wrong =
        |axis: &Axis, what: String| Err(RunError::Usage(format!("--vary {}: {what}", axis.key)));
    for axis in vary {
        let models = || levels.iter().flat_map(|level| &level.models);
        let role = axis.key.split('.').next().unwrap_or_default();
        let of_role = models().any(|(own, _)| own == role);
        if axis.key == format!("{role}.model") && of_role {
            let known: BTreeSet<&str> =
                models().filter(|(own, _)| own == role).map(|(_, model)| model.as_str()).collect();
            let value = axis.values.iter().map(|value| value.trim_matches('"'));
            if let Some(other) = value.into_iter().find(|value| !known.contains(value)) {
                let why = refused.iter().find(|(name, _)| name.split(" + ").any(|m| m == other));
                let why = why.map(|(_, why)| format!(" ({why})")).unwrap_or_default();
                let known: Vec<&str> = known.into_iter().collect();
                let fix = format!("choose from {}", known.join(", "));
                return wrong(axis, format!("`{other}` cannot run this case{why}; {fix}"));
            }
        } else if levels.iter().flat_map(|l| &l.refinements).any(|one| one.key == axis.key) {
            let count = |value: &&String| value.parse::<u32>().is_ok_and(|count| count > 0);
            if let Some(other) = axis.values.iter().find(|value| !count(value)) {
                return wrong(
                    axis,
                    format!("`{other}` is not a positive whole number of elements"),
                );
            }
        } else if !of_role && !NUMERICAL.iter().any(|section| axis.key.starts_with(section)) {
            let fix = "run one study for each value, with --set";
            return wrong(
                axis,
                format!("this key changes the problem rather than its solution; {fix}"),
            );
        }
    }
    Ok(())
}

/// Restricts models and resolutions to the ones given by `--vary` or `--set`.
fn choose(levels: &mut Vec<Level>, held: &[Axis]) {
    let wanted = |role: &str| held.iter().find(|axis| axis.key == format!("{role}.model"));
    levels.retain(|level| {
        let asked = |(role, model): &(String, String)| {
            wanted(role).is_none_or(|axis| axis.values.iter().any(|v| v.trim_matches('"') == model))
        };
        level.models.iter().all(asked)
    });
    for refinement in levels.iter_mut().flat_map(|level| &mut level.refinements) {
        let asked = held.iter().find(|axis| axis.key == refinement.key);
        let mut given: Vec<u32> =
            asked.iter().flat_map(|a| &a.values).filter_map(|v| v.parse().ok()).collect();
        if !given.is_empty() {
            given.sort_unstable();
            given.dedup();
            // The expected error belongs to the resolution for which it was stated.
            refinement.error = refinement.at(f64::from(given[0]));
            refinement.levels = given;
        }
    }
}

/// Varied keys besides models and resolutions.
fn axes(levels: &[Level], request: &Request, plan: &Plan) -> Vec<Axis> {
    let is_level = |key: &str| {
        let refined = levels.iter().flat_map(|level| &level.refinements).any(|r| r.key == key);
        refined || key.strip_suffix(".model").is_some_and(|role| !role.contains('.'))
    };
    let mut axes: Vec<Axis> =
        request.vary.iter().filter(|axis| !is_level(&axis.key)).cloned().collect();
    let set: Vec<Axis> =
        request.base.values().map(|(key, value)| Axis::of_one(key, value)).collect();
    let mut by_default = |key: &str, values: Vec<String>| {
        if axes.iter().chain(&set).all(|axis| axis.key != key) {
            axes.push(Axis { key: key.to_owned(), values });
        }
    };
    if let Windows::Fixed { window, .. } = plan.windows {
        by_default(
            WINDOW,
            WINDOW_PARTS.iter().map(|part| format!("{:e}", part * window)).collect(),
        );
    }
    if plan.scheme.scheme.is_implicit() {
        by_default(TOLERANCE, TOLERANCES.map(str::to_owned).to_vec());
    }
    axes
}

impl Sweep {
    /// Full product of levels, resolutions and all other axes.
    fn settings(&self) -> Vec<Setting> {
        let mut points = Vec::new();
        for (number, level) in self.levels.iter().enumerate() {
            for step in 0..level.steps() {
                let keys = level.keys_at(step);
                let settings = keys.map(|(one, value)| (one.key.clone(), value.to_string()));
                let variant = level.at(step);
                let first = Setting { level: number, step, settings: settings.collect(), variant };
                points.extend(
                    self.axes.iter().fold(vec![first], |points, axis| spread(&points, axis)),
                );
            }
        }
        points
    }

    fn describe(&self, point: &Setting) -> String {
        let settings: Vec<String> =
            point.settings.iter().map(|(key, value)| format!("{key} {value}")).collect();
        format!("{}, {}", self.levels[point.level].name(), settings.join(", "))
    }

    /// Records a run; a refused or failed one has a reason and no quantities.
    fn take(&mut self, setting: &Setting, attempt: Attempt) {
        let mut run = Run::of(setting);
        match attempt.outcome {
            Outcome::Finished(made) => {
                for (key, value) in &made.closed_forms {
                    self.closed_forms.entry(key.clone()).or_insert(*value);
                }
                let all = self.known.all(&made.summary).into_iter();
                let value = |one: Quantity| Some((one.value(&made.summary)?, one.key));
                run.values = all.filter_map(value).map(|(value, key)| (key, value)).collect();
                run.cost = made.spent;
            }
            Outcome::LeftOut(why) => {
                self.left_out.push((self.describe(setting), why));
                return;
            }
            Outcome::Failed(error) => run.failed = Some(reason(&error)),
        }
        self.runs.push(run);
    }
}

/// Copies each point for every value of an axis.
fn spread(points: &[Setting], axis: &Axis) -> Vec<Setting> {
    let with = |point: &Setting, value: &String| {
        let mut more = point.clone();
        more.variant = point.variant.with(&axis.key, value);
        more.settings.push((axis.key.clone(), value.clone()));
        more
    };
    points.iter().flat_map(|p| axis.values.iter().map(move |value| with(p, value))).collect()
}

impl Run {
    fn of(point: &Setting) -> Self {
        Self {
            level: point.level,
            step: point.step,
            settings: point.settings.clone(),
            options: point.variant.options(),
            failed: None,
            cost: RunCost::default(),
            values: BTreeMap::new(),
            errors: BTreeMap::new(),
            pareto: false,
        }
    }
}
