//! Chooses the cheapest models that can meet a target.

use super::Target;
use crate::study::bench::Bench;
use crate::study::levels::{Level, all, reason};
use crate::study::{ends_study, expected_seconds};
use console::case_arguments::{CaseArguments, Changes};
use contract::accuracy::Simplification;
use coupling::windows::Windows;
use run::error::RunError;
use run::format::{number, percent};
use run::plan::{Plan, Planned};

/// Chosen models, and the coarsest resolution at which they are expected to meet the target.
pub(super) struct Choice {
    pub(super) level: Level,
    pub(super) step: usize,
}

/// Chooses among all models that can run the case.
pub(super) fn choose(
    of: &CaseArguments,
    standing: &Planned,
    target: &Target,
    bench: &mut Bench,
) -> Result<Choice, RunError> {
    let mut best: Option<(f64, Choice)> = None;
    for level in chosen(standing, &of.changes).into_iter().filter(|level| level.silent.is_empty()) {
        let Some(step) = coarsest(&level, target) else { continue };
        match bench.planned(&of.case, &level.at(step)) {
            Ok(planned) => {
                let level = level.in_case(&planned);
                // The simplifications of the models may be too large in this particular case.
                let Some(step) = coarsest(&level, target) else { continue };
                let seconds = expected_seconds(&planned.plan);
                if best.as_ref().is_none_or(|(least, _)| seconds < *least) {
                    best = Some((seconds, Choice { level, step }));
                }
            }
            Err(error) if ends_study(&error) => return Err(error),
            Err(_) => {}
        }
    }
    best.map(|(_, choice)| choice).ok_or_else(|| none(of, standing, target, bench))
}

/// Lists all levels, restricted to models that the user has set.
fn chosen(standing: &Planned, base: &Changes) -> Vec<Level> {
    let fixed = |role: &str| {
        let key = format!("{role}.model=");
        base.set.iter().any(|option| option.trim_start().starts_with(&key))
    };
    let configured = |role: &str| {
        let participants = &standing.plan.participants;
        participants.iter().find(|p| p.role == role).map(|p| p.configuration.model.clone())
    };
    let mut levels = all(standing, base);
    levels.retain(|level| {
        let kept = |(role, model): &(String, String)| {
            !fixed(role) || configured(role).as_ref() == Some(model)
        };
        level.models.iter().all(kept)
    });
    levels
}

/// Refuses a resolution set by the user, which would leave nothing to choose.
pub(super) fn refuse_resolution(level: &Level, base: &Changes) -> Result<(), RunError> {
    let set = |key: &str| {
        base.set.iter().any(|option| option.split_once('=').is_some_and(|(k, _)| k.trim() == key))
    };
    match level.refinements.iter().find(|one| set(&one.key)) {
        None => Ok(()),
        Some(one) => Err(RunError::Usage(format!(
            "--accuracy chooses {0}; remove --set {0}, or run without --accuracy",
            one.key
        ))),
    }
}

fn most_left_out(level: &Level) -> String {
    let most = level.left_out.iter().max_by(|a, b| a.error.total_cmp(&b.error));
    let told = |one: &Simplification| format!(" ({}, {:.2} %)", one.what, 100.0 * one.error);
    most.map(told).unwrap_or_default()
}

/// Coarsest resolution at which a level is expected to meet the target. The very first resolution
/// is excluded, because a coarser one is needed for comparison.
fn coarsest(level: &Level, target: &Target) -> Option<usize> {
    let first = usize::from(level.steps() > 1);
    let error = |step| {
        let limit = level.limit_error(step).unwrap_or(f64::INFINITY);
        limit.min(level.grid_error(step))
    };
    let meets = |step: &usize| level.model_error() + error(*step) <= target.most();
    (first..level.steps()).find(meets)
}

/// Error for a target that no models meet. Names the models that can run the case and come closest.
fn none(of: &CaseArguments, standing: &Planned, target: &Target, bench: &mut Bench) -> RunError {
    let mut best: Option<(f64, Level)> = None;
    let mut refused = Vec::new();
    for level in chosen(standing, &of.changes) {
        let name = level.name();
        match bench.planned(&of.case, &level.variant) {
            Ok(_) if !level.silent.is_empty() => {
                let silent = level.silent.join(", ");
                refused.push(format!("{name}: {silent} does not state its accuracy"));
            }
            Ok(planned) => {
                let level = level.in_case(&planned);
                let finest = level.grid_error(level.steps().saturating_sub(1));
                let error = level.model_error() + finest;
                if best.as_ref().is_none_or(|(least, _)| error < *least) {
                    best = Some((error, level));
                }
            }
            Err(error) => refused.push(format!("{name}: {}", reason(&error))),
        }
    }
    let mut text = match best {
        Some((error, level)) => format!(
            "no models are expected to reach an error of {} %; the best that can run this case, \
             {}, reach {} %{}",
            percent(target.most()),
            level.name(),
            number(100.0 * error, 2),
            most_left_out(&level)
        ),
        None => "no models that state their accuracy can run this case".to_owned(),
    };
    for one in refused {
        text += &format!("; {one}");
    }
    RunError::Usage(text + "; relax the target, or run without --accuracy")
}

/// Window length and end of a transient case \[s\].
pub(super) fn window(plan: &Plan) -> Option<[f64; 2]> {
    match plan.windows {
        Windows::Fixed { window, end } => Some([window, end]),
        Windows::Steady
        | Windows::Sequence(_)
        | Windows::Open { .. }
        | Windows::Adaptive { .. } => None,
    }
}
