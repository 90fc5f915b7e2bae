//! Inputs and outputs of the FMU of a plan.

use contract::figure::FigureSpec;
use coupling::windows::Windows;
use run::plan::{LiveValue, Plan};

/// A variable of the FMU.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Variable {
    /// Dotted key.
    pub(super) key: String,
    /// SI unit, "1" for a plain number.
    pub(super) unit: String,
    /// What it is.
    pub(super) words: String,
    /// First value and limits of an input; absent for an output.
    pub(super) input: Option<(f64, [f64; 2])>,
}

/// All of an FMU.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Variables {
    pub(super) inputs: Vec<Variable>,
    pub(super) outputs: Vec<Variable>,
    /// Length of a window of a case in time [s].
    pub(super) window: Option<f64>,
    /// States can be kept and returned to.
    pub(super) rewinds: bool,
}

impl Variables {
    /// Those of a plan that is to be driven.
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
            rewinds: rewinds(plan),
        }
    }

    pub(super) fn all(&self) -> impl Iterator<Item = &Variable> {
        self.inputs.iter().chain(&self.outputs)
    }
}

/// Every participant can go back, and no grid moves.
fn rewinds(plan: &Plan) -> bool {
    plan.participants.iter_enumerated().all(|(index, one)| {
        let model = one.description.models.iter().find(|m| m.name == one.configuration.model);
        let moves =
            one.estimate.iter().any(|layout| plan.travelling(index, layout).next().is_some());
        model.is_some_and(|model| model.rewinds) && !moves
    })
}
