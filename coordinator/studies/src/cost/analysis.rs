//! Derives errors from runs: references, orders of convergence, the Pareto front and recommended
//! runs.

use super::study::{
    Compared, LevelEstimate, LevelSummary, Recommendation, Reference, Request, Run, Study,
};
use super::sweep::{Sweep, WINDOW};
use crate::study::axis::Axis;
use crate::study::levels::Level;
use crate::study::output::StudyFile;
use crate::study::quantity::Quantity;
use crate::study::richardson::{Estimate, Sample};
use contract::accuracy::EDGE_ELEMENTS;
use contract::figure::Measure;
use run::error::RunError;
use std::collections::BTreeMap;

/// Targets for which a study recommends a run.
const TARGETS: [f64; 3] = [0.1, 0.01, 0.001];
/// Error of models, above which they are no reference if more faithful ones were skipped.
const FAITHFUL: f64 = 0.01;
/// Order of convergence with the window length, for constant power density within a window.
const WINDOW_ORDER: f64 = 1.0;

/// Compares the runs of a sweep.
pub(super) fn study(request: &Request, sweep: Sweep) -> Result<Study, RunError> {
    let quantities = quantities(request, &sweep)?;
    check_references(request, &quantities)?;
    let compared: Vec<Compared> =
        quantities.iter().map(|one| compared(one, request, &sweep)).collect();
    let mut study = Study {
        schema: Study::SCHEMA,
        case: sweep.name.clone(),
        title: sweep.title.clone(),
        file: request.case.display().to_string(),
        options: request.base.options(),
        levels: Vec::new(),
        refused: sweep.refused.clone(),
        left_out: sweep.left_out.clone(),
        more_faithful: quantities
            .first()
            .and_then(|one| sweep.more_faithful(&one.key))
            .map(Level::name),
        runs: sweep.runs.clone(),
        picks: Vec::new(),
        quantities: compared,
    };
    for run in &mut study.runs {
        run.compare(&study.quantities);
    }
    study.levels = (0..sweep.levels.len()).map(|level| seen(level, &sweep, &study)).collect();
    mark_front(&mut study);
    study.picks = TARGETS.iter().map(|target| study.pick(*target, &sweep)).collect();
    Ok(study)
}

/// Values that agree within this are prescribed rather than computed, so a comparison is pointless.
const PRESCRIBED: f64 = 1e-5;

/// Returns whether all runs have the same value.
fn is_prescribed(key: &str, runs: &[Run]) -> bool {
    let values = || runs.iter().filter_map(|run| run.values.get(key).copied());
    let [low, high] =
        [values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max)];
    high - low <= PRESCRIBED * low.abs().max(high.abs())
}

/// Quantities that occur in the runs, with the ranking one first.
fn quantities(request: &Request, sweep: &Sweep) -> Result<Vec<Quantity>, RunError> {
    let Sweep { runs, closed_forms, known, .. } = sweep;
    let there = |key: &str| runs.iter().any(|run| run.values.contains_key(key));
    let mut all: Vec<Quantity> =
        known.of_interest.iter().filter(|one| there(&one.key)).cloned().collect();
    let kept = |one: &Quantity| one.measure == Measure::Itself || !is_prescribed(&one.key, runs);
    if runs.len() > 1 {
        all.retain(|one| kept(one) || closed_forms.contains_key(&one.key));
    }
    if let Some(key) = &request.quantity {
        if !there(key) {
            let keys: Vec<&str> = all.iter().map(|one| one.key.as_str()).collect();
            let fix = format!("name one of {}", keys.join(", "));
            return Err(RunError::Usage(format!("no run has the quantity `{key}`; {fix}")));
        }
        all.retain(|one| one.key != *key);
        all.insert(0, known.of(key));
    }
    match all.is_empty() {
        false => Ok(all),
        true => {
            let failed = runs.iter().filter_map(|run| run.failed.clone());
            let other = sweep.refused.iter().chain(&sweep.left_out);
            let cause = failed.chain(other.map(|(what, why)| format!("{what}: {why}"))).next();
            let cause = cause.unwrap_or_else(|| "no run has any quantity of interest".to_owned());
            let fix = "name a quantity of the summary with --quantity";
            Err(RunError::Usage(format!("no run gave a quantity to compare: {cause}; {fix}")))
        }
    }
}

/// Refuses a reference for a quantity that no run has, which probably is a typing error.
fn check_references(request: &Request, quantities: &[Quantity]) -> Result<(), RunError> {
    let unknown = |(key, _): &&(String, f64)| quantities.iter().all(|one| one.key != *key);
    match request.references.iter().find(unknown) {
        None => Ok(()),
        Some((key, _)) => {
            let keys: Vec<&str> = quantities.iter().map(|one| one.key.as_str()).collect();
            let known = keys.join(", ");
            Err(RunError::Usage(format!(
                "--reference {key}: no run has this quantity; the runs have {known}"
            )))
        }
    }
}

fn compared(quantity: &Quantity, request: &Request, sweep: &Sweep) -> Compared {
    let Quantity { key, name, measure, .. } = quantity.clone();
    let exact = |value: f64, source: &str| Reference {
        value,
        uncertainty: Some(0.0),
        source: source.to_owned(),
    };
    let given = request.references.iter().find(|(known, _)| *known == key);
    let given = given.map(|(_, value)| exact(*value, "given"));
    let closed = || sweep.closed_forms.get(&key).map(|value| exact(*value, "closed form"));
    let reference = match measure {
        Measure::Itself => None,
        Measure::Relative | Measure::Absolute => {
            given.or_else(closed).or_else(|| extrapolated(quantity, sweep))
        }
    };
    Compared { key, name, measure, reference }
}

/// Extrapolates the finest runs of the most faithful models along every axis with a known order.
/// Among equally faithful models, the one with the smallest uncertainty is taken. Models with an
/// error of their own are no reference if more faithful ones were skipped.
fn extrapolated(quantity: &Quantity, sweep: &Sweep) -> Option<Reference> {
    let error = |level: usize| sweep.levels[level].model_error();
    let ran =
        || (0..sweep.levels.len()).filter(|level| sweep.finest(*level, &quantity.key).is_some());
    let least = ran().map(error).min_by(f64::total_cmp)?;
    if least > FAITHFUL && sweep.more_faithful(&quantity.key).is_some() {
        return None;
    }
    let limits = ran().filter(|level| error(*level) <= least);
    let limits = limits.filter_map(|level| sweep.limit(level, quantity));
    // A single grid gives no error estimate.
    let known = |one: &Reference| one.uncertainty.unwrap_or(f64::MAX);
    limits.min_by(|a, b| known(a).total_cmp(&known(b)))
}

impl Sweep {
    /// The most faithful models, if none of their runs has a quantity and less faithful ones do.
    fn more_faithful(&self, key: &str) -> Option<&Level> {
        let ran = |level: usize| self.finest(level, key).is_some();
        let error = |level: &usize| self.levels[*level].model_error();
        let all = || 0..self.levels.len();
        let least = all().filter(|level| ran(*level)).map(|level| error(&level));
        let least = least.min_by(f64::total_cmp)?;
        let best = all().min_by(|a, b| error(a).total_cmp(&error(b)))?;
        (error(&best) < least).then(|| &self.levels[best])
    }

    /// Returns whether a run differs from another only by a finer resolution.
    fn is_finer(&self, run: &Run, other: &Run) -> bool {
        let others = self.levels.get(run.level).map_or(0, |level| level.refinements.len());
        run.level == other.level
            && run.step > other.step
            && run.settings[others..] == other.settings[others..]
    }

    /// Finest run of a level that has a quantity: the last one in the order of the sweep.
    fn finest(&self, level: usize, key: &str) -> Option<&Run> {
        self.runs.iter().rfind(|run| run.level == level && run.values.contains_key(key))
    }

    /// Extrapolated limit of a level's runs, with its uncertainty.
    fn limit(&self, level: usize, quantity: &Quantity) -> Option<Reference> {
        let finest = self.finest(level, &quantity.key)?;
        let value = finest.values[&quantity.key];
        let estimates = self.estimates(level, finest, &quantity.key);
        let limit = estimates.iter().fold(value, |limit, one| limit + (one.limit - value));
        let error: f64 = estimates.iter().map(|one| one.error).sum();
        let name = self.levels[level].name();
        let how = if estimates.is_empty() { "the finest run" } else { "extrapolated" };
        Some(Reference {
            value: limit,
            uncertainty: (!estimates.is_empty())
                .then(|| quantity.error(limit + error, limit) + self.levels[level].model_error()),
            source: format!("{name} to {}, {how}", finest.settings_text()),
        })
    }

    /// Error estimates of the finest run along the resolution and along the window length.
    fn estimates(&self, level: usize, finest: &Run, key: &str) -> Vec<Estimate> {
        let order = self.levels[level].order();
        let along = order.and_then(|order| Estimate::of(&self.samples(finest, key), order));
        let window = self.axes.iter().find(|axis| axis.key == WINDOW);
        let window = window
            .and_then(|axis| Estimate::of(&self.window_samples(finest, key, axis), WINDOW_ORDER));
        [along, window].into_iter().flatten().collect()
    }

    /// Values of the runs that differ from the finest one only in resolution, coarsest first.
    fn samples(&self, finest: &Run, key: &str) -> Vec<Sample> {
        let Some(level) = self.levels.get(finest.level) else { return Vec::new() };
        let others = level.refinements.len();
        let alike = |run: &&Run| {
            run.level == finest.level && run.settings[others..] == finest.settings[others..]
        };
        let sample = |run: &Run| {
            let (_, level) = level.keys_at(run.step).next()?;
            let slip_zone = run.values.get(EDGE_ELEMENTS).copied();
            Some(Sample { level: f64::from(level), value: *run.values.get(key)?, slip_zone })
        };
        self.runs.iter().filter(alike).filter_map(sample).collect()
    }

    /// Values of the runs that differ from the finest one only in window length, longest first.
    fn window_samples(&self, finest: &Run, key: &str, axis: &Axis) -> Vec<Sample> {
        let alike = |run: &&Run| {
            let same = |(a, b): (&(String, String), &(String, String))| a == b || a.0 == axis.key;
            run.level == finest.level && run.settings.iter().zip(&finest.settings).all(same)
        };
        let sample = |run: &Run| {
            let (_, window) = run.settings.iter().find(|(key, _)| *key == axis.key)?;
            let window: f64 = window.parse().ok()?;
            Some(Sample { level: 1.0 / window, value: *run.values.get(key)?, slip_zone: None })
        };
        let mut samples: Vec<Sample> = self.runs.iter().filter(alike).filter_map(sample).collect();
        samples.sort_by(|a, b| a.level.total_cmp(&b.level));
        samples
    }
}

impl Run {
    /// Computes the errors of the run's quantities.
    fn compare(&mut self, quantities: &[Compared]) {
        for one in quantities {
            let reference = one.reference.as_ref().map(|reference| reference.value);
            let (Some(value), true) =
                (self.values.get(&one.key), reference.is_some() || one.measure == Measure::Itself)
            else {
                continue;
            };
            let error = one.quantity().error(*value, reference.unwrap_or(0.0));
            self.errors.insert(one.key.clone(), error);
        }
    }
}

/// Summarises the runs of a level.
fn seen(number: usize, sweep: &Sweep, study: &Study) -> LevelSummary {
    let level = &sweep.levels[number];
    let mut shows = BTreeMap::new();
    for one in &study.quantities {
        let Some(reference) = &one.reference else { continue };
        let Some(finest) = sweep.finest(number, &one.key) else { continue };
        let samples = sweep.samples(finest, &one.key);
        let along = level.order().and_then(|order| Estimate::of(&samples, order));
        let limit = along.map_or_else(|| finest.values.get(&one.key).copied(), |a| Some(a.limit));
        let error = |limit: f64| one.quantity().error(limit, reference.value);
        shows.insert(
            one.key.clone(),
            LevelEstimate {
                order: along.and_then(|along| along.observed_order),
                limit,
                model_error: limit.map(error),
            },
        );
    }
    let stops_paying = stops_paying(number, level, sweep, study, &shows);
    LevelSummary { name: level.name(), left_out: level.left_out.clone(), shows, stops_paying }
}

/// Resolution from which the grid error is below the model error.
fn stops_paying(
    number: usize,
    level: &Level,
    sweep: &Sweep,
    study: &Study,
    shows: &BTreeMap<String, LevelEstimate>,
) -> Option<String> {
    let first = study.quantities.first()?;
    let reference = first.reference.as_ref()?;
    let LevelEstimate { limit, model_error, .. } = shows.get(&first.key)?;
    let (limit, model_error) = ((*limit)?, (*model_error)?);
    if reference.uncertainty.is_none_or(|off| model_error <= off) {
        return None;
    }
    let finest = sweep.finest(number, &first.key)?;
    let samples = sweep.samples(finest, &first.key);
    let grid_error = |sample: &Sample| first.quantity().error(sample.value, limit);
    let enough = samples.iter().find(|sample| grid_error(sample) < model_error)?;
    let key = &level.refinements.first()?.key;
    Some(format!(
        "from {key} {} onwards: the error of the grid is {} there, the error of the models {}",
        enough.level,
        first.show_error(grid_error(enough)),
        first.show_error(model_error),
    ))
}

/// Marks the runs that no other beats in both error and cost.
fn mark_front(study: &mut Study) {
    let Some(first) = study.quantities.first().map(|one| one.key.clone()) else { return };
    let place = |run: &Run| Some((run.cost.solve_s, *run.errors.get(&first)?));
    let places: Vec<Option<(f64, f64)>> = study.runs.iter().map(place).collect();
    let beats = |a: (f64, f64), b: (f64, f64)| a.0 <= b.0 && a.1 <= b.1 && (a.0 < b.0 || a.1 < b.1);
    for (run, own) in study.runs.iter_mut().zip(&places) {
        run.pareto =
            own.is_some_and(|own| !places.iter().flatten().any(|other| beats(*other, own)));
    }
}

impl Study {
    /// Fastest run that meets a target. All finer runs must meet the target as well, because an
    /// error that changes sign is small at one resolution by chance.
    fn pick(&self, target: f64, sweep: &Sweep) -> Recommendation {
        let first = self.quantities.first().map(|one| one.key.as_str()).unwrap_or_default();
        let within = |run: &Run| run.errors.get(first).is_none_or(|error| *error <= target);
        let meets = |run: &Run| {
            let mut finer = self.runs.iter().filter(|other| sweep.is_finer(other, run));
            run.errors.contains_key(first) && within(run) && finer.all(within)
        };
        let cost = |index: &usize| self.runs[*index].cost.solve_s;
        let meeting = (0..self.runs.len()).filter(|index| meets(&self.runs[*index]));
        Recommendation { target, run: meeting.min_by(|a, b| cost(a).total_cmp(&cost(b))) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::quantity::Quantities;
    use crate::study::spent::RunCost;
    use console::case_arguments::Changes;
    use contract::accuracy::{Refinement, Simplification};
    use contract::figure::FigureSpec;

    const RISE: &str = "temperature.wheel.max_rise_k";

    /// Two levels: columns with an error of this size and runs on three grids, and exact ones that
    /// were skipped.
    fn sweep(error: f64) -> Sweep {
        let level = |model: &str, error: f64| Level {
            models: vec![("thermal".to_owned(), model.to_owned())],
            refinements: vec![Refinement {
                key: "mech.resolution".to_owned(),
                levels: vec![10, 20, 40],
                order: 1.0,
                error: 0.01,
                source: "a study".to_owned(),
            }],
            left_out: vec![Simplification::always("something", error, "a study")],
            silent: Vec::new(),
            variant: Changes::default(),
        };
        let run = |(step, value): (usize, f64)| Run {
            level: 0,
            step,
            settings: vec![("mech.resolution".to_owned(), (10 << step).to_string())],
            options: Vec::new(),
            failed: None,
            cost: RunCost::default(),
            values: BTreeMap::from([(RISE.to_owned(), value)]),
            errors: BTreeMap::new(),
            pareto: false,
        };
        Sweep {
            levels: vec![level("columns", error), level("moving-source", 0.0)],
            refused: Vec::new(),
            axes: Vec::new(),
            runs: [104.0, 102.0, 101.0].into_iter().enumerate().map(run).collect(),
            left_out: vec![("moving-source".to_owned(), "3 s expected".to_owned())],
            closed_forms: BTreeMap::new(),
            known: Quantities::of_figures(&[FigureSpec::new(RISE, "K", "rise").rank(1)]),
            name: "crane".to_owned(),
            title: None,
        }
    }

    fn analysed(sweep: Sweep) -> Study {
        let request = Request {
            case: "crane.toml".into(),
            base: Changes::default(),
            vary: Vec::new(),
            quantity: None,
            references: Vec::new(),
            repeat: 1,
            longest_run: 2.0,
        };
        study(&request, sweep).unwrap()
    }

    /// A model that is off by a half is no reference for others, nor for itself, while a better one
    /// was skipped; one that is nearly exact is.
    #[test]
    fn a_worse_model_is_no_reference_for_a_better_one() {
        let wrong = analysed(sweep(0.6));
        assert_eq!(wrong.quantities[0].reference, None);
        let text = wrong.missing_models().unwrap();
        assert!(text.contains("moving-source") && text.contains("no reference"), "{text}");
        let near = analysed(sweep(0.002));
        let reference = near.quantities[0].reference.as_ref().unwrap();
        assert!((reference.value - 100.0).abs() < 1e-9);
        assert!(reference.uncertainty.unwrap() > 0.002);
        assert!(near.missing_models().unwrap().contains("moving-source"));
        let mut alone = sweep(0.6);
        alone.levels.pop();
        let alone = analysed(alone);
        assert!(alone.quantities[0].reference.as_ref().unwrap().uncertainty.unwrap() > 0.6);
        assert_eq!(alone.missing_models(), None);
    }
}
