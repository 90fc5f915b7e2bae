//! Participants that cannot solve a window again, or only windows of one length, and what would ask them to.

use super::route::Candidate;
use case::{Case, Control, Problem, Timing};
use coupling::settings::Scheme;
use coupling::windows::Windows;

/// Every participant that would have to solve a window more than once, and cannot.
pub(super) fn cannot_rewind<'a>(
    case: &Case,
    running: impl Iterator<Item = &'a Candidate<'a>>,
    scheme: Scheme,
) -> Vec<Problem> {
    let adaptive =
        matches!(case.timing, Timing::Transient { control: Control::Adaptive { .. }, .. });
    let (what, fix) = match scheme.is_implicit() {
        true => (
            format!("{} solves a window until it has converged", scheme.word()),
            "set coupling.scheme to \"serial-explicit\"",
        ),
        false if adaptive => (
            "adaptive windows are solved again where their error is too large".to_owned(),
            "remove time.control",
        ),
        false => return Vec::new(),
    };
    let problem = |one: &Candidate<'_>| {
        let (key, model) = (format!("{}.model", one.role), &one.model.name);
        let reason = format!("`{model}` can solve a window once only, and {what}");
        case.problem_at(&key, reason, format!("{fix}, or choose a model that can go back"))
    };
    running.filter(|one| !one.model.rewinds).map(problem).collect()
}

/// Every participant whose windows would differ in length, and may not.
pub(super) fn cannot_vary<'a>(
    case: &Case,
    running: impl Iterator<Item = &'a Candidate<'a>>,
    windows: &Windows,
) -> Vec<Problem> {
    let (key, what, fix) = match windows {
        Windows::Adaptive { .. } => {
            ("time.control", "the lengths of adaptive windows differ", "remove time.control")
        }
        fixed if !fixed.are_equal() => (
            "time.end",
            "the last window is cut at time.end",
            "let time.end be a multiple of time.window",
        ),
        _ => return Vec::new(),
    };
    let problem = |one: &Candidate<'_>| {
        let (role, model) = (&one.role, &one.model.name);
        let reason =
            format!("{role}.model `{model}` solves windows of one length only, and {what}");
        case.problem_at(key, reason, format!("{fix}, or choose another model"))
    };
    running.filter(|one| !one.model.varies_step).map(problem).collect()
}
