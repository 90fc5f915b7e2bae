//! What a check is, and how it can go.

use super::bench::Bench;
use super::fault::{Fault, Seen};
use contract::text::one_line;
use serde::Serialize;
use std::time::Duration;

/// One demand of the contract.
#[derive(Debug)]
pub(super) struct Check {
    /// A word, for `--only`.
    pub(super) name: &'static str,
    /// What the contract demands.
    pub(super) demand: &'static str,
    /// Where to look when it fails.
    pub(super) fix: &'static str,
    /// Puts the participant through it.
    pub(super) run: fn(&Bench) -> Result<Seen, Fault>,
}

/// How a check went.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum CheckOutcome {
    /// The demand is kept.
    Passed,
    /// It is not.
    Failed,
    /// It does not concern this participant, or this case.
    Inapplicable,
    /// It was not made: the participant does not describe itself, or never joins a run.
    NotMade,
}

/// A check that was made.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct CheckResult {
    /// Its name.
    pub name: &'static str,
    /// How it went.
    pub verdict: CheckOutcome,
    /// What was seen, or why there was nothing to see.
    pub seen: String,
    /// What the contract demands.
    pub demand: &'static str,
    /// Where to look if it failed.
    pub fix: &'static str,
    /// An earlier check that failed in the same words.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub same_as: Option<&'static str>,
    /// Seconds it took.
    pub seconds: f64,
}

impl CheckResult {
    pub(super) fn new(check: &Check, outcome: Result<Seen, Fault>, took: Duration) -> Self {
        let (verdict, seen) = match outcome {
            Ok(Seen::Kept(seen)) => (CheckOutcome::Passed, seen),
            Ok(Seen::Inapplicable(why)) => (CheckOutcome::Inapplicable, why),
            Err(Fault::Broken(what) | Fault::Late(what)) => (CheckOutcome::Failed, what),
            Err(Fault::Interrupted(signal)) => {
                (CheckOutcome::Failed, format!("stopped by {signal}"))
            }
        };
        let Check { name, demand, fix, .. } = *check;
        let seen = one_line(&seen).into_owned();
        let seconds = took.as_secs_f64();
        Self { name, verdict, seen, demand, fix, same_as: None, seconds }
    }

    /// A check that cannot be made.
    pub(super) fn not_made(check: &Check, because: &str) -> Self {
        let Check { name, demand, fix, .. } = *check;
        let (verdict, seen) = (CheckOutcome::NotMade, because.to_owned());
        Self { name, verdict, seen, demand, fix, same_as: None, seconds: 0.0 }
    }
}
