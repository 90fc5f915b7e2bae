//! `coordinator plan CASE --advise`: estimates the influence and the cost of effects before a run.
//!
//! Participants estimate which figure an effect changes and by how much. The cost is the difference
//! in expected time between two plans.

use crate::study::bench::Bench;
use crate::study::levels::reason;
use crate::study::quantity::Quantities;
use crate::study::{ends_study, expected_seconds};
use console::case_arguments::Changes;
use contract::advice::{Advice, Change, SIGNIFICANT_CHANGE};
use contract::figure::FigureSpec;
use run::advice::ask;
use run::error::RunError;
use run::format::{number, seconds};
use run::plan::Planned;
use std::fmt::Write as _;
use std::path::Path;

/// Relative difference below which costs count as equal.
const SAME: f64 = 0.05;
/// Relative change that is attributed to rounding.
const ROUNDING: f64 = 1e-9;

/// An effect with its estimated influence and cost.
#[derive(Clone, Debug)]
pub struct Advised {
    /// Advice of the participant.
    pub advice: Advice,
    /// Whether the case includes the effect.
    pub active: bool,
    /// Plan of the case with the effect toggled.
    other: Other,
}

/// Plan of the case with one effect more or less.
#[derive(Clone, Debug)]
enum Other {
    /// The case could run.
    Runs {
        /// Expected processor time of the case, and of the case with the effect toggled \[s\].
        seconds: [f64; 2],
        /// Whether each of the two iterates.
        iterates: [bool; 2],
    },
    /// The case would be refused for this reason.
    Refused(String),
    /// Unknown, because the effect needs inputs that only the user can give.
    Open,
}

impl Advised {
    /// Changes that add or remove the effect.
    pub fn changes(&self, base: &Changes) -> Changes {
        let mut changes = base.clone();
        match self.active {
            true => changes.unset.push(format!("effects.{}", self.advice.effect)),
            false => changes.set.extend(self.advice.set.iter().cloned()),
        }
        changes
    }

    /// Returns whether the effect matters and could be added, but is missing from the case.
    pub fn is_missing(&self) -> bool {
        !self.active && self.advice.matters() && matches!(self.other, Other::Runs { .. })
    }
}

/// Collects the advice on all effects, most influential first. Effects on which no program advises
/// are listed as not estimated, so that silence is not taken for advice.
///
/// # Errors
/// A program fails.
pub fn advise(
    case: &Path,
    base: &Changes,
    standing: &Planned,
    bench: &mut Bench,
) -> Result<Vec<Advised>, RunError> {
    let mut all = Vec::new();
    let asked = ask(standing, &mut bench.fleet)?;
    for advice in complete(asked, standing.plan.effects.iter().map(|one| &*one.name)) {
        let active = standing.case.effects.contains(&advice.effect);
        let mut one = Advised { advice, active, other: Other::Open };
        if active || !one.advice.set.is_empty() {
            one.other = other(case, &one.changes(base), standing, bench)?;
        }
        all.push(one);
    }
    let size =
        |one: &Advised| one.advice.change.as_ref().map_or(-1.0, |change| change.relative.abs());
    all.sort_by(|a, b| size(b).total_cmp(&size(a)));
    Ok(all)
}

/// Adds an entry without an estimate for every effect that lacks advice.
fn complete<'a>(mut advice: Vec<Advice>, effects: impl Iterator<Item = &'a str>) -> Vec<Advice> {
    for effect in effects {
        if advice.iter().all(|known| known.effect != effect) {
            advice.push(Advice::new(effect, "no program estimates it in this case"));
        }
    }
    advice
}

fn other(
    case: &Path,
    changes: &Changes,
    standing: &Planned,
    bench: &mut Bench,
) -> Result<Other, RunError> {
    match bench.planned(case, changes) {
        Ok(other) => {
            let plans = [&standing.plan, &other.plan];
            Ok(Other::Runs {
                seconds: plans.map(expected_seconds),
                iterates: plans.map(|plan| plan.scheme.scheme.is_implicit()),
            })
        }
        Err(error) if ends_study(&error) => Err(error),
        Err(error) => Ok(Other::Refused(reason(&error))),
    }
}

/// Formats the advice for the terminal.
pub fn text(all: &[Advised], standing: &Planned) -> String {
    let quantities = Quantities::of_figures(&figures(standing));
    let name = |key: &str| quantities.of(key).name;
    let mut text = String::from(
        "\nadvice     estimated influence of each effect in this case; `coordinator ablate` \
         measures it\n",
    );
    for one in all {
        let Advised { advice, active, .. } = one;
        let state = if *active { "on " } else { "off" };
        let _ =
            writeln!(text, "           {state} {:22} {}", advice.effect, verdict(advice, &name));
        let mut lines = vec![advice.why.clone()];
        let numbers =
            advice.numbers.iter().map(|one| format!("{} {}", one.name, number(one.value, 2)));
        lines[0].extend(numbers.map(|number| format!("; {number}")));
        lines.extend(cost(one));
        if matches!(one.other, Other::Runs { .. }) && !active {
            let options = advice.set.iter().map(|set| format!("--set {}", quoted(set)));
            lines.push(format!("to add it: {}", options.collect::<Vec<_>>().join(" ")));
        }
        for line in lines {
            let _ = writeln!(text, "               {line}");
        }
    }
    text
}

/// Figures of the case, and of effects that the case lacks.
fn figures(standing: &Planned) -> Vec<FigureSpec> {
    let plan = &standing.plan;
    let effects = plan.participants.iter().flat_map(|one| &one.description.effects);
    let names = plan.bodies.iter().flat_map(|bodies| &bodies.0);
    let others = effects.flat_map(|effect| &effect.figures);
    let of_bodies =
        |figure: &FigureSpec| names.clone().map(|name| figure.of_body(name)).collect::<Vec<_>>();
    plan.figures.iter().cloned().chain(others.flat_map(of_bodies)).collect()
}

/// Summary of the advice: whether the effect matters, and which figure changes.
fn verdict(advice: &Advice, name: &impl Fn(&str) -> String) -> String {
    if advice.impossible {
        return "matters: the case has no result with this effect".to_owned();
    }
    let Some(Change { figure, relative }) = &advice.change else {
        return "not estimated".to_owned();
    };
    let figure = name(figure);
    match *relative {
        f64::INFINITY => format!("matters: no {figure} without this effect"),
        relative if relative.abs() < ROUNDING => format!("does not matter: {figure} unchanged"),
        relative if relative.abs() >= SIGNIFICANT_CHANGE => {
            format!("matters: {figure} about {}", percent(relative))
        }
        relative => format!("hardly matters: {figure} about {}", percent(relative)),
    }
}

/// Formats a relative change in per cent, with its sign.
pub fn percent(relative: f64) -> String {
    let sign = if relative > 0.0 { "+" } else { "" };
    format!("{sign}{} %", number(100.0 * relative, 2))
}

fn cost(one: &Advised) -> Option<String> {
    let verb = if one.active { "without it" } else { "with it" };
    match &one.other {
        Other::Open => None,
        Other::Refused(why) => Some(format!("{verb} the case is refused: {why}")),
        Other::Runs { seconds: [now, then], iterates } => {
            let loops = match iterates {
                [false, true] => ", and iterates",
                [true, false] => ", and no longer iterates",
                _ => "",
            };
            let same = (then / now - 1.0).abs() < SAME && loops.is_empty();
            let cost = || {
                let [then, now] = [then, now].map(|time| seconds(*time));
                format!("{verb} the run takes about {then}, now {now}{loops}")
            };
            (!same).then(cost)
        }
    }
}

/// Quotes an option for a shell.
fn quoted(option: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "._=-+/".contains(c);
    if option.chars().all(plain) { option.to_owned() } else { format!("'{option}'") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_effect_without_advice_is_not_left_out() {
        let given = vec![Advice::new("wear", "a law").moves("contact.area_m2", 0.1)];
        let all = complete(given.clone(), ["friction_heat", "wear"].into_iter());
        assert_eq!((all.len(), &all[0]), (2, &given[0]));
        let verdict = verdict(&all[1], &|key: &str| key.to_owned());
        assert_eq!((&*all[1].effect, &*verdict), ("friction_heat", "not estimated"));
    }

    #[test]
    fn a_change_by_rounding_is_none() {
        let advice = Advice::new("wear", "a law").moves("contact.area_m2", -2.2e-16);
        let verdict = verdict(&advice, &|_: &str| "area".to_owned());
        assert_eq!(verdict, "does not matter: area unchanged");
    }
}
