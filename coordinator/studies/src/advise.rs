//! What the effects of a case are worth, before it is run: `coordinator plan CASE --advise`.
//!
//! Participants estimate which figure an effect moves, and by how much; what it costs is the difference of two plans.

use crate::study::levels::reason;
use crate::study::quantity::Quantities;
use crate::study::{Variant, ends_study, expected_seconds, planned};
use contract::advice::{Advice, Change, MATTERS};
use contract::figure::FigureSpec;
use run::advice::ask;
use run::error::RunError;
use run::format::{number, seconds};
use run::plan::Planned;
use std::fmt::Write as _;
use std::path::Path;

/// Costs that differ by less than this part are the same.
const SAME: f64 = 0.05;

/// An effect, with what there is to say of it.
#[derive(Clone, Debug)]
pub struct Advised {
    /// The advice of its participant.
    pub advice: Advice,
    /// The case names it.
    pub active: bool,
    /// The case without it, or with it.
    other: Other,
}

/// A case with an effect more or less.
#[derive(Clone, Debug)]
enum Other {
    /// It could run.
    Runs {
        /// Expected processor seconds of the case as it is, and of the other one.
        seconds: [f64; 2],
        /// Whether each of them iterates.
        iterates: [bool; 2],
    },
    /// It would be refused, for this reason.
    Refused(String),
    /// The case has to give what cannot be guessed.
    Open,
}

impl Advised {
    /// What makes the case have the effect, or not have it.
    pub fn variant(&self, base: &Variant) -> Variant {
        let mut variant = base.clone();
        match self.active {
            true => variant.unset.push(format!("effects.{}", self.advice.effect)),
            false => variant.set.extend(self.advice.set.iter().cloned()),
        }
        variant
    }

    /// It is not in the case, matters, and could be.
    pub fn is_missing(&self) -> bool {
        !self.active && self.advice.matters() && matches!(self.other, Other::Runs { .. })
    }
}

/// All effects that somebody has something to say of, those that matter first.
///
/// # Errors
/// A program that fails.
pub fn advise(case: &Path, base: &Variant, standing: &Planned) -> Result<Vec<Advised>, RunError> {
    let mut all = Vec::new();
    for advice in ask(standing)? {
        let active = standing.case.effects.contains(&advice.effect);
        let mut one = Advised { advice, active, other: Other::Open };
        if active || !one.advice.set.is_empty() {
            one.other = other(case, &one.variant(base), standing)?;
        }
        all.push(one);
    }
    let size =
        |one: &Advised| one.advice.change.as_ref().map_or(-1.0, |change| change.relative.abs());
    all.sort_by(|a, b| size(b).total_cmp(&size(a)));
    Ok(all)
}

fn other(case: &Path, variant: &Variant, standing: &Planned) -> Result<Other, RunError> {
    match planned(case, variant) {
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

/// As a person reads it.
pub fn text(all: &[Advised], standing: &Planned) -> String {
    let quantities = Quantities::of_figures(&figures(standing));
    let name = |key: &str| quantities.of(key).name;
    let mut text = String::from(
        "\nadvice     what each effect is worth here, estimated; `coordinator ablate` measures it\n",
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

/// The figures of the case, and of the effects that it does not have.
fn figures(standing: &Planned) -> Vec<FigureSpec> {
    let plan = &standing.plan;
    let effects = plan.participants.iter().flat_map(|one| &one.description.effects);
    let names = plan.bodies.iter().flat_map(|bodies| &bodies.0);
    let others = effects.flat_map(|effect| &effect.figures);
    let of_bodies =
        |figure: &FigureSpec| names.clone().map(|name| figure.of_body(name)).collect::<Vec<_>>();
    plan.figures.iter().cloned().chain(others.flat_map(of_bodies)).collect()
}

/// Whether it matters, and which figure it moves.
fn verdict(advice: &Advice, name: &impl Fn(&str) -> String) -> String {
    if advice.impossible {
        return "matters: with it the scene has no answer".to_owned();
    }
    let Some(Change { figure, relative }) = &advice.change else {
        return "not estimated".to_owned();
    };
    let figure = name(figure);
    match *relative {
        f64::INFINITY => format!("matters: no {figure} without it"),
        0.0 => format!("does not matter: {figure} stays"),
        relative if relative.abs() >= MATTERS => {
            format!("matters: {figure} about {}", percent(relative))
        }
        relative => format!("hardly matters: {figure} about {}", percent(relative)),
    }
}

/// A relative change, in per cent with its sign.
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

/// For a shell.
fn quoted(option: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "._=-+/".contains(c);
    if option.chars().all(plain) { option.to_owned() } else { format!("'{option}'") }
}
