//! What the installed models offer for a case: every choice of models that can run it, and the
//! resolutions worth running, as their descriptions say.

use super::richardson::ORDER_OF_LIMITS;
use super::{Variant, ends_study, planned};
use case::Problem;
use contract::accuracy::{Refinement, Simplification};
use run::error::RunError;
use run::plan::Planned;
use std::path::Path;

/// One choice of a model for every participant.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// Role and model of each participant that runs, in the order in which data flows.
    pub models: Vec<(String, String)>,
    /// What can be refined, by distinct keys.
    pub refinements: Vec<Refinement>,
    /// What its models leave out that matters in this case.
    pub left_out: Vec<Simplification>,
    /// Roles whose models say nothing of their errors.
    pub silent: Vec<String>,
    /// The case with these models.
    pub variant: Variant,
}

impl Level {
    /// The level of these models, with the effects that are active in a plan of the case.
    fn of(standing: &Planned, models: Vec<(String, String)>, base: &Variant) -> Self {
        let plan = &standing.plan;
        let active = |name: &str| plan.effects.iter().any(|e| e.active && e.name == name);
        let with =
            |v: Variant, (role, model): &(String, String)| v.with(&format!("{role}.model"), model);
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

    /// The same, with what its models leave out in this very case, as they estimate it.
    #[must_use]
    pub fn in_case(mut self, planned: &Planned) -> Self {
        let estimates = planned.plan.participants.iter().filter_map(|p| p.estimate.as_ref());
        self.left_out.extend(estimates.flat_map(|layout| layout.left_out.iter().cloned()));
        self
    }

    /// The models, in one word.
    #[must_use]
    pub fn name(&self) -> String {
        let names: Vec<&str> = self.models.iter().map(|(_, model)| model.as_str()).collect();
        names.join(" + ")
    }

    /// How many resolutions there are; one for models that have none.
    #[must_use]
    pub fn steps(&self) -> usize {
        self.refinements.iter().map(|one| one.levels.len()).max().unwrap_or(1)
    }

    /// The value of each refinement's key at a step, coarsest first; one with fewer stays at its
    /// finest.
    pub fn keys_at(&self, step: usize) -> impl Iterator<Item = (&Refinement, u32)> {
        let at = move |one: &Refinement| one.levels[step.min(one.levels.len() - 1)];
        self.refinements.iter().map(move |one| (one, at(one)))
    }

    /// The case with these models at a step of resolution.
    #[must_use]
    pub fn at(&self, step: usize) -> Variant {
        self.keys_at(step)
            .fold(self.variant.clone(), |variant, (one, level)| variant.with(&one.key, level))
    }

    /// The order with which the error falls: that of the slowest refinement.
    #[must_use]
    pub fn order(&self) -> Option<f64> {
        self.refinements.iter().map(|one| one.order).min_by(f64::total_cmp)
    }

    /// Expected relative error that no resolution removes.
    #[must_use]
    pub fn model_error(&self) -> f64 {
        self.left_out.iter().map(|one| one.error).sum()
    }

    /// Expected relative error of the resolution at a step.
    #[must_use]
    pub fn grid_error(&self, step: usize) -> f64 {
        self.keys_at(step).map(|(one, level)| one.at(f64::from(level))).sum()
    }

    /// Expected relative error of what the resolution at a step and the two before it are extrapolated to; `None`
    /// without them.
    #[must_use]
    pub fn limit_error(&self, step: usize) -> Option<f64> {
        let falls = |(one, level): (&Refinement, u32)| {
            let part = one.at(f64::from(level)) / one.error.max(f64::MIN_POSITIVE);
            one.error * part.powf(ORDER_OF_LIMITS)
        };
        (step >= 2).then(|| self.keys_at(step).map(falls).sum())
    }
}

/// What can run a case, and what cannot.
#[derive(Debug)]
pub struct Offer {
    /// Choices of models that can run it, cheapest first.
    pub levels: Vec<Level>,
    /// The others by their models, and why not; a model that cannot run it with any other stands alone.
    pub refused: Vec<(String, String)>,
}

/// The models that a case has, on its own grid and those `coarser`, as the factors by which they are.
///
/// # Errors
/// None of the models says what refines it, or a grid is too coarse to be made coarser.
pub fn standing(planned: &Planned, base: &Variant, coarser: &[u32]) -> Result<Level, RunError> {
    let participants = &planned.plan.participants;
    let models = participants.iter().map(|p| (p.role.clone(), p.configuration.model.clone()));
    let mut level = Level::of(planned, models.collect(), base).in_case(planned);
    if level.refinements.is_empty() {
        return Err(RunError::Usage(format!(
            "{} cannot be extrapolated: none of its models says which key refines it; run without \
             --extrapolate",
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

/// The value of a key that a participant reads: the case's, or its default.
fn set_to(participant: &run::plan::Participant, key: &str) -> Option<u32> {
    let configuration = &participant.configuration;
    let models = participant.description.models.iter();
    let keys =
        models.filter(|model| model.name == configuration.model).flat_map(|model| &model.keys);
    let default = keys.filter(|spec| spec.path == key).find_map(|spec| spec.default.as_ref());
    let value = configuration.case.get(key).or(default)?;
    value.as_u64().and_then(|value| u32::try_from(value).ok())
}

/// Every choice of models for a case: those that its programs describe, tried by planning.
///
/// # Errors
/// What is wrong with the case as it stands.
pub fn offered(case: &Path, base: &Variant) -> Result<Offer, RunError> {
    let (mut levels, mut others) = (Vec::new(), Vec::new());
    for level in all(&planned(case, base)?, base) {
        match planned(case, &level.variant) {
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
    Ok(Offer { levels, refused })
}

/// Every choice of models that the programs of a planned case describe, whether it can run the case or
/// not; cheapest first.
#[must_use]
pub fn all(standing: &Planned, base: &Variant) -> Vec<Level> {
    choices(standing).into_iter().map(|models| Level::of(standing, models, base)).collect()
}

/// The product of all participants' models.
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

/// Why a case is refused, in one line.
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
