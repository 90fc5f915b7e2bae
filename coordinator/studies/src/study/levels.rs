//! Models and resolutions that the installed programs offer for a case: every combination of models
//! that can run the case, and the resolutions that the models recommend.

use super::ends_study;
use super::richardson::ORDER_OF_LIMITS;
use crate::study::bench::Bench;
use case::Problem;
use console::case_arguments::Changes;
use contract::accuracy::{Refinement, Simplification};
use run::error::RunError;
use run::plan::Planned;
use std::path::Path;

/// One combination of models, one for every participant.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// Role and model of each participant that runs, in the order of the data flow.
    pub models: Vec<(String, String)>,
    /// Available refinements, with distinct keys.
    pub refinements: Vec<Refinement>,
    /// Simplifications of the models that matter in this case.
    pub left_out: Vec<Simplification>,
    /// Roles whose models state nothing about their errors.
    pub silent: Vec<String>,
    /// Changes of the case that select these models.
    pub variant: Changes,
}

impl Level {
    /// Builds the level of these models, with the effects that are active in a plan of the case.
    fn of(standing: &Planned, models: Vec<(String, String)>, base: &Changes) -> Self {
        let plan = &standing.plan;
        let active = |name: &str| plan.effects.iter().any(|e| e.active && e.name == name);
        let with =
            |v: Changes, (role, model): &(String, String)| v.with(&format!("{role}.model"), model);
        let variant = models.iter().fold(base.clone(), with);
        let (mut refinements, mut left_out) = (Vec::<Refinement>::new(), Vec::new());
        let mut silent = Vec::new();
        for (participant, (role, name)) in plan.participants.iter().zip(&models) {
            let models = &participant.description.models;
            let Some(model) = models.iter().find(|model| model.name == *name) else { continue };
            if model.accuracy.is_silent() {
                silent.push(role.clone());
            }
            let counts = model.accuracy.simplifications.iter().filter(|one| one.applies(&active));
            left_out.extend(counts.cloned());
            let known = |key: &str| refinements.iter().any(|other| other.key == key);
            let refinement = model.accuracy.refinement.iter().find(|one| !known(&one.key));
            refinements.extend(refinement.cloned());
        }
        Self { models, refinements, left_out, silent, variant }
    }

    /// Adds the simplifications that the participants estimate for this particular case.
    #[must_use]
    pub fn in_case(mut self, planned: &Planned) -> Self {
        let estimates = planned.plan.participants.iter().filter_map(|p| p.estimate.as_ref());
        self.left_out.extend(estimates.flat_map(|layout| layout.left_out.iter().cloned()));
        self
    }

    /// Names of the models, joined by `+`.
    #[must_use]
    pub fn name(&self) -> String {
        let names: Vec<&str> = self.models.iter().map(|(_, model)| model.as_str()).collect();
        names.join(" + ")
    }

    /// Number of resolutions; one for models without refinements.
    #[must_use]
    pub fn steps(&self) -> usize {
        self.refinements.iter().map(|one| one.levels.len()).max().unwrap_or(1)
    }

    /// Value of each refinement's key at a step, coarsest first. A refinement with fewer levels
    /// stays at its finest.
    pub fn keys_at(&self, step: usize) -> impl Iterator<Item = (&Refinement, u32)> {
        let at = move |one: &Refinement| one.levels[step.min(one.levels.len() - 1)];
        self.refinements.iter().map(move |one| (one, at(one)))
    }

    /// Changes that select these models at a step of resolution.
    #[must_use]
    pub fn at(&self, step: usize) -> Changes {
        self.keys_at(step)
            .fold(self.variant.clone(), |variant, (one, level)| variant.with(&one.key, level))
    }

    /// Order of convergence of the error: the lowest order of all refinements.
    #[must_use]
    pub fn order(&self) -> Option<f64> {
        self.refinements.iter().map(|one| one.order).min_by(f64::total_cmp)
    }

    /// Expected relative error that remains at any resolution.
    #[must_use]
    pub fn model_error(&self) -> f64 {
        self.left_out.iter().map(|one| one.error).sum()
    }

    /// Expected relative error of the resolution at a step.
    #[must_use]
    pub fn grid_error(&self, step: usize) -> f64 {
        self.keys_at(step).map(|(one, level)| one.at(f64::from(level))).sum()
    }

    /// Expected relative error of the limit that is extrapolated from the resolution at a step and
    /// the two coarser ones; `None` if fewer than three exist.
    #[must_use]
    pub fn limit_error(&self, step: usize) -> Option<f64> {
        let falls = |(one, level): (&Refinement, u32)| {
            let part = one.at(f64::from(level)) / one.error.max(f64::MIN_POSITIVE);
            one.error * part.powf(ORDER_OF_LIMITS)
        };
        (step >= 2).then(|| self.keys_at(step).map(falls).sum())
    }
}

/// Combinations of models for a case, usable and refused.
#[derive(Debug)]
pub struct ModelChoices {
    /// Combinations that can run the case, cheapest first.
    pub levels: Vec<Level>,
    /// Refused combinations and the reason. A model that fails in every combination is listed
    /// alone.
    pub refused: Vec<(String, String)>,
}

/// Returns the models of a case with its own grid and with grids coarser by the factors in
/// `coarser`.
///
/// # Errors
/// Fails if no model names a refinement, or if a grid is too coarse to be made coarser.
pub fn standing(planned: &Planned, base: &Changes, coarser: &[u32]) -> Result<Level, RunError> {
    let participants = &planned.plan.participants;
    let models = participants.iter().map(|p| (p.role.clone(), p.configuration.model.clone()));
    let mut level = Level::of(planned, models.collect(), base).in_case(planned);
    if level.refinements.is_empty() {
        return Err(RunError::Usage(format!(
            "{} cannot be extrapolated: none of its models names a key that refines the grid; run \
             without --extrapolate",
            level.name()
        )));
    }
    for one in &mut level.refinements {
        let own = participants.iter().find_map(|participant| set_to(participant, &one.key));
        let own = own.filter(|own| own / coarser[0] > 0).ok_or_else(|| {
            RunError::Usage(format!(
                "--extrapolate takes grids {} times coarser; set {} to {} or more, or run without",
                coarser[0], one.key, coarser[0]
            ))
        })?;
        one.error = one.at(f64::from(own / coarser[0]));
        one.levels = coarser.iter().map(|factor| own / factor).chain([own]).collect();
    }
    Ok(level)
}

/// Value of a key that a participant reads: the value in the case, or the default.
fn set_to(participant: &run::plan::Participant, key: &str) -> Option<u32> {
    let configuration = &participant.configuration;
    let models = participant.description.models.iter();
    let keys =
        models.filter(|model| model.name == configuration.model).flat_map(|model| &model.keys);
    let default = keys.filter(|spec| spec.path == key).find_map(|spec| spec.default.as_ref());
    let value = configuration.case.get(key).or(default)?;
    value.as_u64().and_then(|value| u32::try_from(value).ok())
}

/// Lists every combination of models for a case and finds the usable ones by planning each.
///
/// # Errors
/// The case itself is invalid.
pub fn offered(case: &Path, base: &Changes, bench: &mut Bench) -> Result<ModelChoices, RunError> {
    let (mut levels, mut others) = (Vec::new(), Vec::new());
    for level in all(&bench.planned(case, base)?, base) {
        match bench.planned(case, &level.variant) {
            Ok(planned) => levels.push(level.in_case(&planned)),
            Err(error) if ends_study(&error) => return Err(error),
            Err(error) => others.push((level, reason(&error))),
        }
    }
    let runs = |model: &(String, String)| levels.iter().any(|level| level.models.contains(model));
    let mut refused: Vec<(String, String)> = Vec::new();
    for (level, why) in &others {
        let alone = level.models.iter().find(|model| !runs(model));
        let name = alone.map_or_else(|| level.name(), |(role, model)| format!("{role} {model}"));
        if refused.iter().all(|(known, _)| *known != name) {
            refused.push((name, why.clone()));
        }
    }
    Ok(ModelChoices { levels, refused })
}

/// Lists every combination of models that the programs of a planned case describe, usable or not;
/// cheapest first.
#[must_use]
pub fn all(standing: &Planned, base: &Changes) -> Vec<Level> {
    choices(standing).into_iter().map(|models| Level::of(standing, models, base)).collect()
}

/// Product of the models of all participants.
fn choices(planned: &Planned) -> Vec<Vec<(String, String)>> {
    let mut all = vec![Vec::new()];
    for participant in &planned.plan.participants {
        let models = participant.description.models.iter().map(|model| model.name.clone());
        let with = |choice: &Vec<(String, String)>, model: String| {
            let mut longer = choice.clone();
            longer.push((participant.role.clone(), model));
            longer
        };
        let models: Vec<String> = models.collect();
        all = all
            .iter()
            .flat_map(|choice| models.iter().map(|model| with(choice, model.clone())))
            .collect();
    }
    all
}

/// Reason for which a case is refused, in one line.
#[must_use]
pub fn reason(error: &RunError) -> String {
    match error {
        RunError::Case(problems) => {
            let line = |problem: &Problem| format!("{}: {}", problem.key, problem.reason);
            problems.list().first().map(line).unwrap_or_default()
        }
        other => other.to_string().lines().next().unwrap_or_default().to_owned(),
    }
}
