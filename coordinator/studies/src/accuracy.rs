//! `run --accuracy 1%`: finds the cheapest models and resolution that meet a target, and states the
//! error estimated from several grids.
//!
//! 1. **Models.** The expected error ([`contract::accuracy`]) of a candidate must leave room for
//!    the error of a grid. Among all combinations of models that can run the case and satisfy this,
//!    the one with the lowest expected cost is chosen.
//! 2. **Pilot.** The case runs on the two coarsest grids, which give an error estimate
//!    ([`crate::study::richardson`]). If the estimate is within the target, the second run is the
//!    answer.
//! 3. **Climb.** Otherwise the case runs on ever finer grids until the error is within the target.
//!    The search fails if the finest grid misses the target. All coarser grids together cost less
//!    than the last one.
//!
//! With three or more grids, the extrapolated limit may meet the target before the finest grid
//! does. The limit then is the answer, with its own error.
//!
//! `run --extrapolate` has no target: the models of the case run on the case's own grid and on two
//! coarser ones, and the result is the extrapolated limit with its error.
//!
//! The stated error is the error of the grid, including the factor of safety, plus the expected
//! error of the models. A peak that jumps between elements can agree on two grids by chance. Hence
//! the error of a figure is at least the error of its driver, as described by the participant: for
//! a temperature, the heating power. The error is also at least the grid error that the models
//! expect. In a transient case, the windows are refined together with the grid.

mod choice;
mod target;

pub use target::Target;

use crate::study::bench::Bench;
use crate::study::levels::{Level, standing};
use crate::study::quantity::{Quantities, Quantity};
use crate::study::richardson::{Estimate, Limit, Sample, too_narrow};

use choice::Choice;
use console::case_arguments::{CaseArguments, Changes};
use contract::accuracy::EDGE_ELEMENTS;
use contract::figure::Measure;
use run::error::RunError;
use run::results::ResultFolder;
use run::results::stated::{ResultSource, Stated, StatedFigure, StatedRun};
use run::results::summary::Summary;
use run::scratch::Scratch;
use run::warnings::Warning;
use std::path::PathBuf;
use std::time::Instant;

/// Limit of the window length in a pilot, as a power of two: the longest windows are four times the
/// case's own.
const LONGEST_WINDOW: i32 = -2;
/// Order of convergence with the window length.
const WINDOW_ORDER: f64 = 1.0;

/// Coarsening factors of the additional grids of `run --extrapolate`.
const COARSER: [u32; 2] = [4, 2];

/// One run of a search.
#[derive(Clone, Debug, PartialEq)]
pub struct GridRun {
    /// Index of the resolution among those of the level, coarsest first.
    pub step: usize,
    /// Values of all compared quantities.
    values: Vec<Option<f64>>,
    /// Width of the slip zone \[element\]; `None` without an edge inside the contact.
    slip_zone: Option<f64>,
    /// Time of the run \[s\].
    pub wall_s: f64,
}

/// Next step after a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decision {
    /// The estimated error is within the target.
    Met,
    /// The error is too large; a finer grid is next.
    Refine,
    /// The error is too large, and no finer grid is left.
    Missed,
}

/// Search for the cheapest run that meets a target.
#[derive(Debug)]
pub struct Search {
    case: PathBuf,
    target: Target,
    known: Quantities,
    /// Quantity of the target and its driver, followed by all others with a relative error.
    quantities: Vec<Quantity>,
    /// Number of quantities that must meet the target: the first ones.
    watched: usize,
    level: Level,
    /// Window length and end of the run \[s\], and the step of the resolution at which this window
    /// length applies; `None` for a steady case.
    window: Option<([f64; 2], usize)>,
    step: usize,
    runs: Vec<GridRun>,
}

impl Search {
    /// Chooses the models and runs the first, coarser half of the pilot.
    ///
    /// # Errors
    /// The case cannot run, no models can meet the target, no run has the quantity, or the pilot
    /// fails.
    pub fn begin(of: &CaseArguments, target: Target, bench: &mut Bench) -> Result<Self, RunError> {
        let standing = bench.planned(&of.case, &of.changes)?;
        let Choice { level, step } = choice::choose(of, &standing, &target, bench)?;
        choice::refuse_resolution(&level, &of.changes)?;
        let window = choice::window(&standing.plan).map(|times| (times, step));
        let mut search = Self {
            case: of.case.clone(),
            known: Quantities::of_figures(&standing.plan.figures),
            quantities: Vec::new(),
            watched: 0,
            target,
            level,
            window,
            step,
            runs: Vec::new(),
        };
        if search.level.steps() > 1 {
            search.try_out(0, bench)?;
            search.step = 1;
        }
        Ok(search)
    }

    /// Keeps the models and the grid of the case, and runs on two coarser grids.
    ///
    /// # Errors
    /// The case cannot run, its models have no resolution, or a run fails.
    pub fn extrapolate(
        of: &CaseArguments,
        quantity: Option<String>,
        bench: &mut Bench,
    ) -> Result<Self, RunError> {
        let planned = bench.planned(&of.case, &of.changes)?;
        let level = standing(&planned, &of.changes, &COARSER)?;
        let step = COARSER.len();
        let mut search = Self {
            case: of.case.clone(),
            known: Quantities::of_figures(&planned.plan.figures),
            quantities: Vec::new(),
            watched: 0,
            target: Target { relative: None, quantity },
            window: choice::window(&planned.plan).map(|times| (times, step)),
            level,
            step,
            runs: Vec::new(),
        };
        (0..step).try_for_each(|coarser| search.try_out(coarser, bench))?;
        Ok(search)
    }

    /// Changes of the case for the next run.
    #[must_use]
    pub fn variant(&self) -> Changes {
        self.at(self.step)
    }

    fn at(&self, step: usize) -> Changes {
        let variant = self.level.at(step);
        match self.window {
            None => variant,
            Some(([window, end], own)) => {
                let finer = 2f64.powi((step as i32 - own as i32).max(LONGEST_WINDOW));
                variant.with("time.window", format!("{:e}", (window / finer).min(end)))
            }
        }
    }

    /// Performs a run without fields at a resolution and notes its quantities.
    fn try_out(&mut self, step: usize, bench: &mut Bench) -> Result<(), RunError> {
        let begun = Instant::now();
        let scratch = Scratch::new()?;
        let folder = ResultFolder::transient(scratch.path())?;
        let variant = self.at(step).with("output.fields", "none");
        let summary = bench.run(&self.case, &variant, &folder)?;
        self.note(step, &summary, begun.elapsed().as_secs_f64())
    }

    fn note(&mut self, step: usize, summary: &Summary, wall_s: f64) -> Result<(), RunError> {
        if self.quantities.is_empty() {
            self.quantities = self.target.quantities(summary, &self.known)?;
            self.watched = self.quantities.len();
            let others = self.known.all(summary).into_iter();
            let relative = |one: &Quantity| one.measure == Measure::Relative;
            let new: Vec<_> =
                others.filter(|one| relative(one) && !self.quantities.contains(one)).collect();
            self.quantities.extend(new);
        }
        let values = self.quantities.iter().map(|one| one.value(summary)).collect();
        self.runs.retain(|run| run.step != step);
        let slip_zone = slip_zone(summary);
        self.runs.push(GridRun { step, values, slip_zone, wall_s });
        self.runs.sort_by_key(|run| run.step);
        Ok(())
    }

    /// Order of convergence when grid and windows are refined together.
    fn order(&self) -> Option<f64> {
        let windows = self.window.map_or(f64::INFINITY, |_| WINDOW_ORDER);
        self.level.order().map(|order| order.min(windows))
    }

    fn fineness(&self, step: usize) -> f64 {
        self.level.keys_at(step).next().map_or(1.0, |(_, level)| f64::from(level))
    }

    /// Estimated relative error of the finest grid so far, at least the error that the models
    /// expect of that grid. `None` with fewer than two grids.
    fn grid_error(&self) -> Option<f64> {
        let last = self.runs.last()?;
        let errors = (0..self.watched).filter_map(|index| {
            let estimate = self.estimate(index)?;
            Some(relative(estimate.error, last.values[index]?))
        });
        let expected = self.level.grid_error(last.step);
        errors.max_by(f64::total_cmp).map(|error| error.max(expected))
    }

    /// Estimated relative error of the extrapolated limit, at least the error that the models
    /// expect of the finest grid. `None` with fewer than three grids.
    fn limit_error(&self) -> Option<f64> {
        let limits = (0..self.watched).filter_map(|index| self.limit(index));
        let error =
            limits.map(|limit| relative(limit.error, limit.value)).max_by(f64::total_cmp)?;
        Some(error.max(self.level.grid_error(self.runs.last()?.step)))
    }

    /// Error estimate of a quantity from all grids.
    fn estimate(&self, index: usize) -> Option<Estimate> {
        Estimate::of(&self.samples(index), self.order()?)
    }

    /// Extrapolated limit of a quantity.
    fn limit(&self, index: usize) -> Option<Limit> {
        Limit::of(&self.samples(index), self.order()?)
    }

    fn samples(&self, index: usize) -> Vec<Sample> {
        let sample = |run: &GridRun| {
            let (level, slip_zone) = (self.fineness(run.step), run.slip_zone);
            Some(Sample { level, value: run.values[index]?, slip_zone })
        };
        self.runs.iter().filter_map(sample).collect()
    }

    /// Takes the summary of the run of [`Search::variant`], adds the section `accuracy` and returns
    /// the next step.
    ///
    /// # Errors
    /// The summary lacks the quantity.
    pub fn judge(&mut self, summary: &mut Summary, wall_s: f64) -> Result<Decision, RunError> {
        self.note(self.step, summary, wall_s)?;
        let stated = self.stated();
        let met = stated.met;
        summary.accuracy = Some(stated);
        if met {
            return Ok(Decision::Met);
        }
        match self.step + 1 < self.level.steps() {
            true => Ok(Decision::Refine),
            false => Ok(Decision::Missed),
        }
    }

    /// Moves to the next finer grid.
    pub fn refine(&mut self) {
        self.step += 1;
    }

    /// States the error of the last run, or of the limit, from all runs so far.
    fn stated(&self) -> Stated {
        let of_run = self.runs.last().and_then(|run| run.values[0]).unwrap_or(f64::NAN);
        // Models without a resolution have no grid error.
        let run_error = self.grid_error().unwrap_or(0.0);
        let model_error = self.level.model_error();
        let meets = |error: f64| error + model_error <= self.target.most();
        // The more accurate of the two is the answer if there is no target.
        let enough = |error: f64| self.target.relative.is_some() && meets(error);
        let limit = self.limit_error().zip(self.limit(0));
        let (taken, value, grid_error) = match limit.filter(|_| !enough(run_error)) {
            Some((error, limit)) if error < run_error => {
                (ResultSource::Extrapolated, limit.value, error)
            }
            _ => (ResultSource::Run, of_run, run_error),
        };
        let figure = |(index, of): (usize, &Quantity)| {
            let Limit { value, error } = self.limit(index)?;
            Some(StatedFigure { key: of.key.clone(), value, grid_error: relative(error, value) })
        };
        let figures = match taken {
            ResultSource::Extrapolated => {
                self.quantities.iter().enumerate().filter_map(figure).collect()
            }
            ResultSource::Run => Vec::new(),
        };
        let estimated_error = grid_error + model_error;
        let narrow_slip_zone = too_narrow(&self.samples(0)).filter(|_| self.runs.len() > 1);
        let run = |run: &GridRun| StatedRun {
            settings: self.level.keys_at(run.step).map(|(r, n)| (r.key.clone(), n)).collect(),
            value: run.values[0],
            wall_s: run.wall_s,
        };
        Stated {
            quantity: self.quantities[0].key.clone(),
            target: self.target.relative,
            estimated_error,
            grid_error,
            model_error,
            met: meets(grid_error),
            taken,
            value,
            extrapolated: limit
                .map(|(_, limit)| limit.value)
                .or(self.estimate(0).filter(|_| narrow_slip_zone.is_none()).map(|of| of.limit)),
            narrow_slip_zone,
            figures,
            models: self.level.name(),
            runs: self.runs.iter().map(run).collect(),
        }
    }

    /// Error for a search that misses its target.
    #[must_use]
    pub fn missed(&self) -> RunError {
        let Stated { quantity, estimated_error, target, .. } = self.stated();
        RunError::Inaccurate {
            quantity,
            estimated: estimated_error,
            target: target.unwrap_or_default(),
            fix: "relax the target, or set a finer resolution and run without --accuracy"
                .to_owned(),
        }
    }
}

/// Width of the slip zone \[element\]: of the last row or window, or of the narrowest one that gave
/// a warning.
fn slip_zone(summary: &Summary) -> Option<f64> {
    let warned = summary.warnings.iter().filter_map(|warning| match warning {
        Warning::Value(one) if one.key == EDGE_ELEMENTS => Some(one.value),
        _ => None,
    });
    summary.value(EDGE_ELEMENTS).into_iter().chain(warned).reduce(f64::min)
}

/// Relative error; zero if the error is zero, also for a value of zero.
fn relative(error: f64, value: f64) -> f64 {
    if error == 0.0 { 0.0 } else { (error / value).abs() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contract::accuracy::{Refinement, Simplification};
    use serde_json::json;

    const RISE: &str = "temperature.rail.max_rise_k";
    const POWER: &str = "contact.friction_power_w";

    /// A search on grids of 5, 10 and 20 elements; the coarsest one has already run.
    fn search(target: f64, order: f64, rise: f64, power: f64) -> Search {
        let refinement = Refinement {
            key: "mech.resolution".to_owned(),
            levels: vec![5, 10, 20],
            order,
            error: 0.02,
            source: "a study".to_owned(),
        };
        let level = Level {
            models: vec![("mech".to_owned(), "fine".to_owned())],
            refinements: vec![refinement],
            left_out: vec![Simplification::always("something", 0.001, "a study")],
            silent: Vec::new(),
            variant: Changes::default(),
        };
        let values = vec![Some(rise), Some(power)];
        Search {
            case: PathBuf::new(),
            target: Target { relative: Some(target), quantity: None },
            quantities: [RISE, POWER].map(|key| Quantities::default().of(key)).to_vec(),
            watched: 2,
            known: Quantities::default(),
            level,
            window: None,
            step: 1,
            runs: vec![GridRun { step: 0, values, slip_zone: None, wall_s: 0.1 }],
        }
    }

    fn summary(rise: f64, power: f64) -> Summary {
        Summary::of_sections(json!({
            "temperature": {"rail": {"max_rise_k": rise}},
            "contact": {"friction_power_w": power},
        }))
    }

    fn stated(summary: Summary) -> Stated {
        summary.accuracy.expect("judged")
    }

    #[test]
    fn an_answer_within_the_target_ends_the_search() {
        let mut search = search(0.07, 1.0, 102.0, 102.0);
        let mut summary = summary(100.0, 100.0);
        assert_eq!(search.judge(&mut summary, 0.2).unwrap(), Decision::Met);
        // The limit is 98. The stated error is two times 2 %, plus the error of the models.
        let stated = stated(summary);
        assert!((stated.estimated_error - 0.041).abs() < 1e-12, "{stated:?}");
        assert!((stated.extrapolated.unwrap() - 98.0).abs() < 1e-9);
    }

    /// Two grids agree on a peak by chance, but not on the power.
    #[test]
    fn a_temperature_is_no_better_known_than_its_heat() {
        let mut search = search(0.05, 1.0, 100.0, 110.0);
        let mut summary = summary(100.0, 100.0);
        assert_eq!(search.judge(&mut summary, 0.2).unwrap(), Decision::Refine);
        assert!((stated(summary).grid_error - 0.2).abs() < 1e-12);
    }

    /// If grids agree, the stated error is still at least the one that the model expects.
    #[test]
    fn what_a_model_expects_is_the_least_error() {
        let mut search = search(0.05, 1.0, 100.0, 100.0);
        let mut summary = summary(100.0, 100.0);
        assert_eq!(search.judge(&mut summary, 0.2).unwrap(), Decision::Met);
        assert!((stated(summary).grid_error - 0.01).abs() < 1e-12);
    }

    #[test]
    fn the_last_grid_meets_the_target_or_misses_it() {
        let mut met = search(0.02, 1.0, 104.0, 104.0);
        assert_eq!(met.judge(&mut summary(102.0, 102.0), 0.2).unwrap(), Decision::Refine);
        met.refine();
        assert_eq!(met.variant().set, ["mech.resolution=20"]);
        assert_eq!(met.judge(&mut summary(101.0, 101.0), 0.4).unwrap(), Decision::Met);
        let mut missed = search(0.01, 1.0, 120.0, 120.0);
        assert_eq!(missed.judge(&mut summary(110.0, 110.0), 0.2).unwrap(), Decision::Refine);
        missed.refine();
        assert_eq!(missed.judge(&mut summary(105.0, 105.0), 0.4).unwrap(), Decision::Missed);
        let error = missed.missed();
        assert_eq!(error.exit_code(), 3);
        let text = error.to_string();
        assert!(
            text.contains("above the requested 1 %") && text.contains("finer resolution"),
            "{text}"
        );
    }

    /// Three grids with agreeing limits: the finest has an error of 5 %, the limit an error of 1 %.
    #[test]
    fn a_limit_may_be_the_answer() {
        let mut search = search(0.02, 1.0, 120.0, 240.0);
        assert_eq!(search.judge(&mut summary(110.0, 220.0), 0.2).unwrap(), Decision::Refine);
        search.refine();
        let mut last = summary(105.0, 210.0);
        assert_eq!(search.judge(&mut last, 0.4).unwrap(), Decision::Met);
        let stated = stated(last);
        assert_eq!((stated.taken, stated.value), (ResultSource::Extrapolated, 100.0));
        assert!((stated.estimated_error - 0.011).abs() < 1e-12, "{stated:?}");
        let power = &stated.figures[1];
        assert_eq!((power.key.as_str(), power.value), (POWER, 200.0));
    }

    /// The same grids with a slip zone of a few elements: agreement of limits is chance. The error
    /// covers the difference of neighbouring grids.
    #[test]
    fn a_narrow_slip_zone_is_not_extrapolated() {
        let narrow = |mut summary: Summary, width: f64| {
            let (section, name) = EDGE_ELEMENTS.split_once('.').unwrap();
            summary.sections[section][name] = json!(width);
            summary
        };
        let mut search = search(0.02, 1.0, 120.0, 240.0);
        search.runs[0].slip_zone = Some(1.5);
        let mut second = narrow(summary(110.0, 220.0), 3.0);
        assert_eq!(search.judge(&mut second, 0.2).unwrap(), Decision::Refine);
        search.refine();
        let mut last = narrow(summary(105.0, 210.0), 6.0);
        assert_eq!(search.judge(&mut last, 0.4).unwrap(), Decision::Missed);
        let stated = stated(last);
        assert_eq!((stated.taken, stated.value), (ResultSource::Run, 105.0));
        assert_eq!((stated.narrow_slip_zone, stated.extrapolated), (Some(1.5), None));
        assert!(stated.grid_error >= 10.0 / 105.0, "{stated:?}");
    }

    #[test]
    fn windows_shorten_with_the_grid() {
        let mut search = search(0.02, 2.0, 1.0, 1.0);
        search.window = Some(([1e-3, 1.5e-3], 1));
        assert_eq!(search.at(2).set, ["mech.resolution=20", "time.window=5e-4"]);
        assert_eq!(search.at(0).set, ["mech.resolution=5", "time.window=1.5e-3"]);
        assert_eq!(search.order(), Some(WINDOW_ORDER));
    }
}
