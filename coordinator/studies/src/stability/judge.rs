//! Compares a run with its expected outcome.

use super::case_run::CaseRun;
use super::report::{Finding, RunResult};
use super::suite::{Bound, Check, Expected, Limits};

/// Checks the quantities of a run against their bounds, and its outcome against the expected one.
pub(super) fn judge(
    run: &CaseRun,
    expected: &Expected,
    limits: &Limits,
    checks: &[Check],
) -> RunResult {
    let answered = run.error.is_none();
    let findings = if answered { findings(run, limits, checks) } else { Vec::new() };
    let mut row = RunResult {
        as_expected: true,
        otherwise: Vec::new(),
        error: run.error.clone(),
        bounded: answered.then(|| run.fields().all(|field| field.non_finite_at.is_none())),
        energy_imbalance: run.coupling.energy_imbalance,
        findings,
        iterations: run.coupling.iterations,
        seconds: run.seconds,
    };
    row.otherwise = otherwise(&row, expected);
    row.otherwise.extend(unreadable(run));
    row.as_expected = row.otherwise.is_empty();
    row
}

/// Findings: undershoot and heat imbalance where they are known, and the checks of the case.
fn findings(run: &CaseRun, limits: &Limits, checks: &[Check]) -> Vec<Finding> {
    let mut findings = Vec::new();
    let below = run.fields().filter_map(|field| {
        let name = field.topic.rsplit('/').next().unwrap_or_default();
        let (min, max) = (field.range.min?, field.range.max?);
        let counts = limits.not_negative.iter().any(|other| other == name);
        counts.then(|| (name.to_owned(), if min < 0.0 { -min / max.max(-min) } else { 0.0 }))
    });
    let worst = below.max_by(|a, b| a.1.total_cmp(&b.1));
    findings.extend(worst.map(|(name, undershoot)| {
        finding(format!("undershoot of {name}"), undershoot, Bound::AtMost(limits.undershoot))
    }));
    findings.extend(run.coupling.energy_imbalance.map(|imbalance| {
        finding("heat imbalance".to_owned(), imbalance, Bound::AtMost(limits.energy))
    }));
    findings.extend(checks.iter().map(|check| match check.of.value(&run.quantities) {
        Ok(value) => finding(check.name.clone(), value, check.bound),
        Err(key) => Finding {
            name: check.name.clone(),
            value: None,
            bound: format!("{} (the run has no {key})", check.bound),
            share: None,
        },
    }));
    findings
}

fn finding(name: String, value: f64, bound: Bound) -> Finding {
    let share = match bound {
        Bound::AtMost(most) => value.max(0.0) / most,
        Bound::AtLeast(least) => least / value.max(0.0),
        Bound::Near(0.0, within) => value.abs() / within,
        Bound::Near(wanted, within) => (value / wanted - 1.0).abs() / within,
    };
    let number = |value: f64| value.is_finite().then_some(value);
    let share = number(value).and(number(share));
    Finding { name, value: number(value), bound: bound.to_string(), share }
}

/// Lists the differences from the expected outcome.
fn otherwise(row: &RunResult, expected: &Expected) -> Vec<String> {
    match (expected, &row.error) {
        (Expected::Answer, None) => {
            let unbounded =
                (row.bounded == Some(false)).then(|| "a value is not finite".to_owned());
            let beyond = row.findings.iter().filter(|finding| !finding.holds()).map(described);
            unbounded.into_iter().chain(beyond).collect()
        }
        (Expected::Breach(name), None) => {
            let holds = row.findings.iter().any(|one| one.name == *name && one.holds());
            holds.then(|| format!("`{name}` holds")).into_iter().collect()
        }
        (Expected::Refusal { .. }, None) => vec!["the run gave a result".to_owned()],
        (Expected::Answer | Expected::Breach(_), Some((code, message))) => {
            vec![format!("the run ended with exit code {code}: {message}")]
        }
        (Expected::Refusal { exit_code, saying }, Some((code, message))) => {
            let other = (code != exit_code).then(|| format!("the exit code is {code}"));
            let missing = saying.iter().filter(|words| !message.contains(*words));
            let missing = missing.map(|words| format!("“{words}” is not in: {message}"));
            other.into_iter().chain(missing).collect()
        }
    }
}

fn described(finding: &Finding) -> String {
    let Finding { name, value, bound, .. } = finding;
    match value {
        Some(value) => format!("{name}: {value:e} is not {bound}"),
        None => format!("{name}: no value, expected {bound}"),
    }
}

/// Checks that the recording is complete, however the run ended.
fn unreadable(run: &CaseRun) -> Option<String> {
    let survey = run.recorded.as_ref()?;
    match &survey.damage {
        Some(damage) => Some(format!("the recording is damaged: {damage}")),
        None => (!survey.complete).then(|| "the recording is incomplete".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_of_bounds() {
        let share = |value, bound| finding(String::new(), value, bound).share;
        assert_eq!(share(3.0, Bound::AtMost(6.0)), Some(0.5));
        assert_eq!(share(-3.0, Bound::AtMost(6.0)), Some(0.0));
        assert_eq!(share(3.0, Bound::AtLeast(6.0)), Some(2.0));
        assert_eq!(share(-1.0, Bound::AtLeast(6.0)), None);
        assert_eq!(share(-2.2, Bound::Near(-2.0, 0.2)).map(|s| (s * 10.0).round()), Some(5.0));
        assert_eq!(share(0.5, Bound::Near(0.0, 1.0)), Some(0.5));
        assert_eq!(share(f64::NAN, Bound::AtMost(1.0)), None);
    }

    fn row(error: Option<(u8, &str)>, share: f64) -> RunResult {
        let finding = Finding {
            name: "rise".into(),
            value: Some(1.0),
            bound: "≤ 1".into(),
            share: Some(share),
        };
        RunResult {
            as_expected: true,
            otherwise: Vec::new(),
            bounded: error.is_none().then_some(true),
            error: error.map(|(code, message)| (code, message.to_owned())),
            energy_imbalance: None,
            findings: vec![finding],
            iterations: 1,
            seconds: 0.0,
        }
    }

    #[test]
    fn every_end_is_distinguished_from_every_other() {
        let refusal = Expected::Refusal { exit_code: 2, saying: vec!["too hot".into()] };
        let breach = Expected::Breach("rise".into());
        let fits = |expected: &Expected, row: &RunResult| otherwise(row, expected).is_empty();
        let (good, bad) = (row(None, 0.5), row(None, 1.5));
        let (refused, failed) =
            (row(Some((2, "it is too hot")), 0.0), row(Some((1, "too hot")), 0.0));
        for (expected, fitting) in
            [(&Expected::Answer, &good), (&breach, &bad), (&refusal, &refused)]
        {
            for row in [&good, &bad, &refused, &failed] {
                assert_eq!(fits(expected, row), row == fitting, "{expected} {row:?}");
            }
        }
        assert!(!fits(&refusal, &self::row(Some((2, "cold")), 0.0)));
    }
}
