//! Configurations of a participant: a case, planned for every model and mode that it offers.
//!
//! The case is planned as for a run, with its other participants. Thus case values, inputs, outputs
//! and the grids of the inputs are the same as in that run. The other participants do not run.

use super::input::{self, InputSource, RecordedInputs};
use case::RawCase;
use console::case_arguments::Changes;
use console::case_arguments::read_case;
use console::scenes::{self, FIRST};
use contract::configuration::{Configuration, Mode};
use contract::description::Description;
use contract::message::Interpolation;
use contract::step::Step;
use run::error::RunError;
use run::fleet::Fleet;
use run::plan::{Plan, plan};
use run::program::Program;
use std::path::PathBuf;
use std::time::Duration;

/// Participant to be checked, and the conditions of the checks.
#[derive(Clone, Debug)]
pub(crate) struct Request {
    /// Role of the participant.
    pub role: String,
    /// Executable.
    pub program: Program,
    /// Case for the configurations; `None`: the scene wheel-rail.
    pub case: Option<PathBuf>,
    /// Changes of the case.
    pub changes: Changes,
    /// Recording whose inputs are used instead of artificial ones.
    pub recording: Option<PathBuf>,
    /// Names of the checks to make; all if empty.
    pub only: Vec<String>,
    /// Whether to check only the cheapest model and mode, on small grids.
    pub quick: bool,
    /// Longest wait for an answer.
    pub patience: Duration,
}

/// Window of a transient setting whose case has none [s]: rolling over a fraction of the contact.
const WINDOW: &str = "20 us";
/// End of a transient setting whose case has none. No check reaches it.
const END: &str = "1 ms";

/// Key of a figure that no participant has.
const UNKNOWN_FIGURE: &str = "no.such_figure";

/// A model in a mode.
#[derive(Clone, Debug)]
pub(super) struct Setting {
    /// Configuration, with a known grid for every input.
    pub(super) configuration: Configuration,
    /// Sources of the input values, in the order of the inputs.
    pub(super) sources: Vec<InputSource>,
    pub(super) interpolation: Interpolation,
    /// Whether the model can solve a window more than once.
    pub(super) rewinds: bool,
    /// Keys of the requested figures, including one that does not exist; empty if the participant
    /// describes no figures.
    pub(super) figures: Vec<String>,
    /// Length of a window [s].
    window: f64,
}

impl Setting {
    /// Returns model and mode.
    pub(super) fn label(&self) -> String {
        let Configuration { model, mode, .. } = &self.configuration;
        label(model, *mode)
    }

    pub(super) fn is_transient(&self) -> bool {
        self.configuration.mode == Mode::Transient
    }

    /// Returns the first iteration of a window, counted from 0; a steady case has one window.
    pub(super) fn step(&self, window: u64) -> Step {
        if !self.is_transient() {
            return Step::STEADY;
        }
        let at = |number: u64| number as f64 * self.window;
        Step { window, iteration: 1, start: at(window), end: at(window + 1) }
    }

    /// Returns the step after an accepted one: the next window, or in a steady case a further
    /// iteration.
    pub(super) fn after(&self, step: &Step) -> Step {
        match self.is_transient() {
            true => {
                let end = step.end + self.window;
                Step { window: step.window + 1, iteration: 1, start: step.end, end }
            }
            false => Step { iteration: step.iteration + 1, ..*step },
        }
    }

    /// Returns the setting with its inputs on grids of this many elements; `None` if no input has a
    /// grid that can be resized.
    pub(super) fn resized(&self, elements: [usize; 2]) -> Option<Self> {
        let (mut setting, mut any) = (self.clone(), false);
        for input in &mut setting.configuration.inputs {
            if let Some(grid) = input.grid.as_ref().and_then(|g| input::resized(g, elements)) {
                (input.grid, any) = (Some(grid), true);
            }
        }
        any.then_some(setting)
    }
}

/// Returns the name of a model in a mode.
fn label(model: &str, mode: Mode) -> String {
    let mode = match mode {
        Mode::Steady => "steady",
        Mode::Transient => "transient",
    };
    format!("{model}, {mode}")
}

/// Settings that a case gives for all models and modes, and labels of all others.
#[derive(Debug, Default)]
pub(super) struct Settings {
    pub(super) settings: Vec<Setting>,
    /// Settings that do not fit the case, or that the participant refuses.
    pub(super) left_out: Vec<String>,
    /// Settings for which the participant, or a partner, failed while the case was planned.
    pub(super) misled: Vec<String>,
}

/// Plans the case for every model and mode.
///
/// # Errors
/// The case cannot be read or changed as requested, or the user has interrupted the command.
pub(super) fn all(
    request: &Request,
    description: &Description,
    recorded: Option<&RecordedInputs>,
) -> Result<Settings, RunError> {
    let mut raw = match &request.case {
        Some(file) => read_case(file)?,
        None => RawCase::parse(FIRST, scenes::text(FIRST).expect("it is built in"))?,
    };
    raw.apply(&request.changes.set, &request.changes.unset)?;
    let mut all = Settings::default();
    let offered = description.models.iter().flat_map(|model| {
        let modes = [(model.steady, Mode::Steady), (model.transient, Mode::Transient)];
        modes.into_iter().filter(|(offered, _)| *offered).map(|(_, mode)| (&*model.name, mode))
    });
    let mut fleet = Fleet::for_one_run();
    for (model, mode) in offered {
        match one(request, &raw, (model, mode), recorded, &mut fleet) {
            Ok(_) if request.quick && !all.settings.is_empty() => {
                all.left_out.push(format!("{}: --quick", label(model, mode)));
            }
            Ok(setting) => all.settings.push(setting),
            Err(interrupted @ RunError::Interrupted { .. }) => return Err(interrupted),
            Err(error) => {
                let failed = matches!(error, RunError::Failed(_));
                let list = if failed { &mut all.misled } else { &mut all.left_out };
                list.push(format!("{}: {}", label(model, mode), words(&error)));
            }
        }
    }
    Ok(all)
}

fn words(error: &RunError) -> String {
    match error {
        RunError::Case(problems) => {
            let reasons = problems.list().iter().map(|p| format!("{}: {}", p.key, p.reason));
            reasons.take(3).collect::<Vec<_>>().join("; ")
        }
        other => other.to_string(),
    }
}

fn one(
    request: &Request,
    raw: &RawCase,
    (model, mode): (&str, Mode),
    recorded: Option<&RecordedInputs>,
    fleet: &mut Fleet,
) -> Result<Setting, RunError> {
    let (role, mut raw) = (&request.role, raw.clone());
    let program = &request.program;
    let words: Vec<String> = std::iter::once(program.path.display().to_string())
        .chain(program.arguments.iter().cloned())
        .collect();
    let command = serde_json::to_string(&words).expect("words are plain data");
    let mut set = vec![
        format!("{role}.model={model:?}"),
        format!("{role}.command={command}"),
        "output.fields=\"all\"".to_owned(),
    ];
    match mode {
        Mode::Steady if raw.has("time") => raw.apply::<&str>(&[], &["time"])?,
        Mode::Steady => {}
        Mode::Transient => {
            set.push("time.mode=\"transient\"".to_owned());
            let absent = |(key, _): &(&str, &str)| !raw.has(key);
            let times = [("time.window", WINDOW), ("time.end", END)].into_iter().filter(absent);
            set.extend(times.map(|(key, value)| format!("{key}={value:?}")));
        }
    }
    raw.apply(&set, &[])?;
    let plan = plan(raw, fleet)?.plan;
    let found = plan.participants.iter().find(|participant| participant.role == *role);
    let Some(participant) = found else {
        return Err(RunError::Usage("no active effect of the case needs it".to_owned()));
    };
    let mut configuration = participant.configuration.clone();
    // A live value is held at its first value.
    if let Some(live) = configuration.histories.as_ref().and_then(|known| known.live.clone()) {
        configuration.inputs.retain(|input| !live.limits.contains_key(&input.field.name));
        configuration.histories = None;
    }
    let mut figures = participant.figures.clone();
    if !figures.is_empty() {
        figures.push(UNKNOWN_FIGURE.to_owned());
    }
    Ok(Setting { figures, ..with_inputs(configuration, &plan, recorded) })
}

/// Places every input on a grid: the recorded one, the one its producer estimates, or a default
/// one.
fn with_inputs(
    mut configuration: Configuration,
    plan: &Plan,
    recorded: Option<&RecordedInputs>,
) -> Setting {
    let mut sources = Vec::new();
    for index in 0..configuration.inputs.len() {
        let input = &configuration.inputs[index];
        let mut source = InputSource::new(&input.field, &configuration);
        let producer = plan.participants.iter().find(|p| p.role == input.producer);
        let estimate = producer.and_then(|producer| producer.estimate.as_ref());
        let estimated = estimate.and_then(|layout| layout.grid_of(&input.field.name)).cloned();
        let taken = recorded.and_then(|recorded| recorded.field(&input.field.name));
        let grid = match taken {
            Some((grid, values)) => {
                source.recorded = Some(values.to_vec());
                grid.clone()
            }
            None => estimated.unwrap_or_else(|| input::default_grid(&input.field)),
        };
        configuration.inputs[index].grid = Some(grid);
        sources.push(source);
    }
    let window = match plan.windows {
        coupling::windows::Windows::Steady | coupling::windows::Windows::Sequence(_) => 0.0,
        coupling::windows::Windows::Fixed { window, .. } => window,
        coupling::windows::Windows::Open { window } => window.unwrap_or(0.0),
        coupling::windows::Windows::Adaptive { shortest, .. } => shortest,
    };
    let own = plan.participants.iter().find(|p| p.role == configuration.role);
    let model =
        own.and_then(|p| p.description.models.iter().find(|m| m.name == configuration.model));
    let rewinds = model.is_none_or(|model| model.rewinds);
    let (figures, interpolation) = (Vec::new(), plan.interpolation);
    Setting { configuration, sources, interpolation, figures, rewinds, window }
}
