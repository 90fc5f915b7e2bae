//! Inputs and outputs of the FMU of a plan, or of a surrogate.

use contract::description::ModelSpec;
use contract::figure::FigureSpec;
use coupling::windows::Windows;
use run::format::{number, stem_and_unit};
use run::plan::{LiveValue, Plan};
use surrogate::{Document, FittedFigure, Key, Measure};

/// A variable of the FMU.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Variable {
    /// Dotted key.
    pub(super) key: String,
    /// SI unit; "1" for a plain number.
    pub(super) unit: String,
    /// One line for people.
    pub(super) words: String,
    /// First value and limits of an input; `None` for an output.
    pub(super) input: Option<(f64, [f64; 2])>,
}

/// Variables of an FMU, and capabilities of its steps.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Variables {
    pub(super) inputs: Vec<Variable>,
    pub(super) outputs: Vec<Variable>,
    /// Length of a window of a transient case [s].
    pub(super) window: Option<f64>,
    /// States can be saved and restored.
    pub(super) rewinds: bool,
    /// Steps may differ in length.
    pub(super) varies_step: bool,
    /// Outputs depend only on inputs. The FMU supports model exchange too, and its states are a
    /// few bytes.
    pub(super) algebraic: bool,
}

impl Variables {
    /// Returns the variables of a driven plan.
    pub(super) fn of(plan: &Plan) -> Self {
        let input = |live: &LiveValue| Variable {
            key: live.kind.name.clone(),
            unit: live.kind.unit.clone(),
            words: live.kind.meaning.clone(),
            input: Some((live.first, live.limits)),
        };
        let output = |figure: &FigureSpec| Variable {
            key: figure.key.clone(),
            unit: figure.unit.clone(),
            words: figure.words.clone(),
            input: None,
        };
        let own = plan.live.iter().filter(|live| live.provider.is_none());
        let figures = plan.figures.iter().filter(|figure| !figure.is_of_a_list());
        Self {
            inputs: own.map(input).collect(),
            outputs: figures.map(output).collect(),
            window: match plan.windows {
                Windows::Open { window } => window,
                _ => None,
            },
            rewinds: every_model(plan, |model| model.rewinds) && !moves(plan),
            varies_step: every_model(plan, |model| model.varies_step),
            algebraic: false,
        }
    }

    /// Returns the variables of a surrogate: its keys, whose start values are the middle of its
    /// box, and its figures.
    pub(super) fn of_surrogate(document: &Document) -> Self {
        let middle = middle(document);
        let input = |(key, first): (&Key, f64)| Variable {
            key: key.key.clone(),
            unit: if key.unit.is_empty() { "1".to_owned() } else { key.unit.clone() },
            words: format!("a key of the case {}", document.origin.case),
            input: Some((first, [key.from, key.to])),
        };
        Self {
            inputs: document.keys.iter().zip(middle).map(input).collect(),
            outputs: document.figures.iter().map(fitted).collect(),
            window: None,
            rewinds: true,
            varies_step: true,
            algebraic: true,
        }
    }

    pub(super) fn all(&self) -> impl Iterator<Item = &Variable> {
        self.inputs.iter().chain(&self.outputs)
    }
}

/// Describes a figure of a surrogate, with the largest error at points held out.
fn fitted(figure: &FittedFigure) -> Variable {
    let unit = match stem_and_unit(&figure.key).1 {
        "-" => "1",
        unit => unit,
    };
    let largest = figure.held.largest;
    let error = match figure.held.measure {
        Measure::Relative => format!("{} %", number(100.0 * largest, 2)),
        Measure::Absolute if unit == "1" => number(largest, 2),
        Measure::Absolute => format!("{} {unit}", number(largest, 2)),
    };
    let words = if figure.words.is_empty() { &figure.key } else { &figure.words };
    Variable {
        key: figure.key.clone(),
        unit: unit.to_owned(),
        words: format!("{words}; largest error at points held out {error}"),
        input: None,
    }
}

/// Returns the middle of the box. A quotient that limits the box has its middle value, too.
fn middle(document: &Document) -> Vec<f64> {
    let half = |from: f64, to: f64| 0.5 * (from + to);
    let mut at: Vec<f64> = document.keys.iter().map(|key| half(key.from, key.to)).collect();
    for one in &document.coordinates {
        let by = one.per.as_deref().and_then(|per| document.place(per));
        if let (Some(of), Some(by)) = (document.place(&one.key), by) {
            let Key { from, to, .. } = document.keys[of];
            at[of] = (half(one.from, one.to) * at[by]).clamp(from, to);
        }
    }
    at
}

fn every_model(plan: &Plan, can: impl Fn(&ModelSpec) -> bool) -> bool {
    plan.participants.iter().all(|one| {
        let model = one.description.models.iter().find(|m| m.name == one.configuration.model);
        model.is_some_and(&can)
    })
}

/// Returns true if a grid moves.
fn moves(plan: &Plan) -> bool {
    plan.participants.iter_enumerated().any(|(index, one)| {
        one.estimate.iter().any(|layout| plan.travelling(index, layout).next().is_some())
    })
}
