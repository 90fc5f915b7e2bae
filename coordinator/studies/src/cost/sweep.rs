//! The runs of a study: which ones, and what each of them gives.

use super::finished::FinishedRuns;
use super::study::{Request, Run};
use crate::study::axis::Axis;
use crate::study::folder::StudyFolder;
use crate::study::levels::{Level, Offer, offered, reason};
use crate::study::quantity::Quantities;
use crate::study::spent::{Spent, Stopwatch};
use crate::study::{Variant, ends_study, expected_run_seconds, expected_seconds, perform, planned};
use console::steps::Steps;
use coupling::windows::Windows;
use run::error::RunError;
use run::plan::{Plan, Planned};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Key of the length of a window.
pub(super) const WINDOW: &str = "time.window";
/// Key of the tolerance of the coupling.
const TOLERANCE: &str = "coupling.relative";
/// Windows of a default plan, as parts of the case's own.
const WINDOW_PARTS: [f64; 4] = [4.0, 2.0, 1.0, 0.5];
/// Tolerances of a default plan.
const TOLERANCES: [&str; 4] = ["1e-2", "1e-4", "1e-6", "1e-10"];
/// Everything that the runs of a study gave.
#[derive(Debug)]
pub(super) struct Sweep {
    pub(super) levels: Vec<Level>,
    pub(super) refused: Vec<(String, String)>,
    /// What is varied besides models and resolutions, each from the coarsest to the finest value.
    pub(super) axes: Vec<Axis>,
    pub(super) runs: Vec<Run>,
    pub(super) left_out: Vec<(String, String)>,
    /// Quantities that participants know in closed form.
    pub(super) closed_forms: BTreeMap<String, f64>,
    pub(super) known: Quantities,
    pub(super) name: String,
    pub(super) title: Option<String>,
}

/// One run to be made.
#[derive(Clone, Debug)]
struct Point {
    level: usize,
    step: usize,
    settings: Vec<(String, String)>,
    variant: Variant,
}

/// Where runs are made, and where finished ones are kept.
pub(super) struct Places<'a> {
    pub(super) scratch: &'a Path,
    pub(super) study: &'a StudyFolder,
    pub(super) kept: FinishedRuns,
}

/// Makes the runs that a request asks for, but those that are kept.
pub(super) fn sweep(
    request: &Request,
    standing: &Planned,
    quiet: bool,
    places: &mut Places<'_>,
) -> Result<Sweep, RunError> {
    let Offer { mut levels, refused } = offered(&request.case, &request.base)?;
    check(&levels, &refused, &request.vary)?;
    let held: Vec<Axis> = request.vary.iter().cloned().chain(request.base.axes()).collect();
    choose(&mut levels, &held);
    let axes = axes(&levels, request, &standing.plan);
    let mut sweep = Sweep {
        refused,
        axes,
        runs: Vec::new(),
        left_out: Vec::new(),
        closed_forms: places.kept.closed_forms().clone(),
        known: Quantities::of_figures(&standing.plan.figures),
        name: standing.plan.name.clone(),
        title: standing.plan.title.clone(),
        levels,
    };
    let points = sweep.points();
    // Runs made before or left out take no time now; runs that cannot be planned end at once.
    let made = |seconds: f64| if seconds > request.longest_run { 0.0 } else { seconds };
    let expected = |point: &Point| match places.kept.run(&point.variant.options()) {
        Some(_) => 0.0,
        None if quiet => 1.0,
        None => made(expected_run_seconds(planned(&request.case, &point.variant).ok().as_ref())),
    };
    let work = points.iter().map(expected).collect();
    let mut steps = Steps::of_work(quiet, work);
    for point in &points {
        steps.step(&sweep.describe(point));
        match places.kept.run(&point.variant.options()) {
            Some(run) => sweep.runs.push(run.clone()),
            None => sweep.make(request, point, places)?,
        }
    }
    steps.finish();
    Ok(sweep)
}

/// Keys that change how a case is computed, and not what it is, begin like this, or with a role.
const NUMERICAL: [&str; 3] = ["time.", "coupling.", "mapping."];

/// What is varied has to be there, and leave the problem as it is.
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
                let fix = format!("choose among {}", known.join(", "));
                return wrong(axis, format!("`{other}` cannot run this case{why}; {fix}"));
            }
        } else if levels.iter().flat_map(|l| &l.refinements).any(|one| one.key == axis.key) {
            let count = |value: &&String| value.parse::<u32>().is_ok_and(|count| count > 0);
            if let Some(other) = axis.values.iter().find(|value| !count(value)) {
                return wrong(axis, format!("`{other}` is not a number of elements"));
            }
        } else if !of_role && !NUMERICAL.iter().any(|section| axis.key.starts_with(section)) {
            let fix = "make one study for each value, with --set";
            return wrong(axis, format!("it changes the problem, not how it is solved; {fix}"));
        }
    }
    Ok(())
}

/// Keeps the models, and takes the resolutions, that were asked for, by `--vary` or by `--set`.
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
            // The expected error stays with the resolution that it was stated for.
            refinement.error = refinement.at(f64::from(given[0]));
            refinement.levels = given;
        }
    }
}

/// What is varied besides models and resolutions.
fn axes(levels: &[Level], request: &Request, plan: &Plan) -> Vec<Axis> {
    let is_level = |key: &str| {
        let refined = levels.iter().flat_map(|level| &level.refinements).any(|r| r.key == key);
        refined || key.strip_suffix(".model").is_some_and(|role| !role.contains('.'))
    };
    let mut axes: Vec<Axis> =
        request.vary.iter().filter(|axis| !is_level(&axis.key)).cloned().collect();
    let set: Vec<Axis> = request.base.axes().collect();
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
    /// Levels, their resolutions and all other axes, in full product.
    fn points(&self) -> Vec<Point> {
        let mut points = Vec::new();
        for (number, level) in self.levels.iter().enumerate() {
            for step in 0..level.steps() {
                let keys = level.keys_at(step);
                let settings = keys.map(|(one, value)| (one.key.clone(), value.to_string()));
                let variant = level.at(step);
                let first = Point { level: number, step, settings: settings.collect(), variant };
                points.extend(
                    self.axes.iter().fold(vec![first], |points, axis| spread(&points, axis)),
                );
            }
        }
        points
    }

    fn describe(&self, point: &Point) -> String {
        let settings: Vec<String> =
            point.settings.iter().map(|(key, value)| format!("{key} {value}")).collect();
        format!("{}, {}", self.levels[point.level].name(), settings.join(", "))
    }

    /// Makes a run as often as is asked; one that is refused or fails has a reason and no
    /// quantities.
    fn make(
        &mut self,
        request: &Request,
        point: &Point,
        places: &mut Places<'_>,
    ) -> Result<(), RunError> {
        let mut run = Run::of(point);
        let silent = point.variant.with("output.fields", "none");
        for _ in 0..request.repeat {
            let stopwatch = Stopwatch::start();
            let made = planned(&request.case, &silent).and_then(|planned| {
                let seconds = expected_seconds(&planned.plan);
                if seconds > request.longest_run {
                    return Ok(Err(seconds));
                }
                self.note_closed_forms(&planned);
                perform(&request.case, &planned, stopwatch.since, places.scratch).map(Ok)
            });
            match made {
                Ok(Ok(summary)) => run.take(&summary, &self.known, &stopwatch),
                Ok(Err(seconds)) => {
                    let limit = request.longest_run;
                    let why = format!("{seconds:.1} s expected, above --longest-run {limit} s");
                    self.left_out.push((self.describe(point), why));
                    return Ok(());
                }
                Err(error) if ends_study(&error) => return Err(error),
                Err(error) => run.failed = Some(reason(&error)),
            }
        }
        places.kept.add(&run, &self.closed_forms, places.study)?;
        self.runs.push(run);
        Ok(())
    }

    fn note_closed_forms(&mut self, planned: &Planned) {
        let estimates = planned.plan.participants.iter().filter_map(|p| p.estimate.as_ref());
        for (key, value) in estimates.flat_map(|layout| &layout.closed_forms) {
            self.closed_forms.entry(key.clone()).or_insert(*value);
        }
    }
}

/// One copy of each point for every value of an axis.
fn spread(points: &[Point], axis: &Axis) -> Vec<Point> {
    let with = |point: &Point, value: &String| {
        let mut more = point.clone();
        more.variant = point.variant.with(&axis.key, value);
        more.settings.push((axis.key.clone(), value.clone()));
        more
    };
    points.iter().flat_map(|p| axis.values.iter().map(move |value| with(p, value))).collect()
}

impl Run {
    fn of(point: &Point) -> Self {
        Self {
            level: point.level,
            step: point.step,
            settings: point.settings.clone(),
            options: point.variant.options(),
            failed: None,
            cost: Spent::default(),
            values: BTreeMap::new(),
            errors: BTreeMap::new(),
            pareto: false,
        }
    }

    /// Takes the quantities of a run, and its times where they are the least so far.
    fn take(&mut self, summary: &Value, known: &Quantities, stopwatch: &Stopwatch) {
        let cost = Spent::of(summary, stopwatch);
        if self.values.is_empty() || cost.solve_s < self.cost.solve_s {
            let wall_s = match self.values.is_empty() {
                true => cost.wall_s,
                false => cost.wall_s.min(self.cost.wall_s),
            };
            self.cost = Spent { wall_s, ..cost };
        }
        for quantity in known.all(summary) {
            if let Some(value) = quantity.value(summary) {
                self.values.insert(quantity.key, value);
            }
        }
    }
}
