//! What a participant is configured with: a case, planned for every model and mode that it offers.
//!
//! The plan is made as for a run, with the case's other participants, so that case values, inputs,
//! outputs and the grids of the inputs are those that it would meet there. None of the others runs.

use super::given::{self, Given};
use super::recorded::Recorded;
use super::request::Request;
use case::RawCase;
use console::case_arguments::read_case;
use console::scenes::{self, FIRST};
use contract::configuration::{Configuration, Mode};
use contract::description::Description;
use contract::message::Interpolation;
use contract::step::Step;
use run::error::RunError;
use run::plan::{Plan, plan};

/// Window of a transient setting whose case has none [s]: rolling over a fraction of the contact.
const WINDOW: &str = "20 us";
/// Its end, which no check reaches.
const END: &str = "1 ms";

/// A figure that nobody has.
const UNKNOWN_FIGURE: &str = "no.such_figure";

/// One model in one mode.
#[derive(Clone, Debug)]
pub(super) struct Setting {
    /// Its configuration; the grid of every input is known.
    pub(super) configuration: Configuration,
    /// What it will be given, in the order of the inputs.
    pub(super) given: Vec<Given>,
    pub(super) interpolation: Interpolation,
    /// Its model can solve a window more than once.
    pub(super) rewinds: bool,
    /// Keys of the figures that it is asked for, one that there is not among them; none, if it describes
    /// none.
    pub(super) figures: Vec<String>,
    /// Length of a window [s].
    window: f64,
}

impl Setting {
    /// Model and mode.
    pub(super) fn label(&self) -> String {
        let Configuration { model, mode, .. } = &self.configuration;
        label(model, *mode)
    }

    pub(super) fn is_transient(&self) -> bool {
        self.configuration.mode == Mode::Transient
    }

    /// The first iteration of a window, from 0; a steady case has one window.
    pub(super) fn step(&self, window: u64) -> Step {
        if !self.is_transient() {
            return Step::STEADY;
        }
        let at = |number: u64| number as f64 * self.window;
        Step { window, iteration: 1, start: at(window), end: at(window + 1) }
    }

    /// What is solved after a step has been accepted: the next window; in a steady case one more
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

    /// The same with the inputs on grids of this many elements; `None` if no input has a grid that
    /// can be resized.
    pub(super) fn resized(&self, elements: [usize; 2]) -> Option<Self> {
        let (mut setting, mut any) = (self.clone(), false);
        for input in &mut setting.configuration.inputs {
            if let Some(grid) = input.grid.as_ref().and_then(|g| given::resized(g, elements)) {
                (input.grid, any) = (Some(grid), true);
            }
        }
        any.then_some(setting)
    }
}

/// A model that describes itself, in a mode that it offers.
fn label(model: &str, mode: Mode) -> String {
    let mode = match mode {
        Mode::Steady => "steady",
        Mode::Transient => "transient",
    };
    format!("{model}, {mode}")
}

/// What a case makes of all models and modes, each with its label.
#[derive(Debug, Default)]
pub(super) struct Settings {
    pub(super) settings: Vec<Setting>,
    /// The case does not fit, or the participant refuses it.
    pub(super) left_out: Vec<String>,
    /// The participant, or one of its partners, failed while the case was planned.
    pub(super) misled: Vec<String>,
}

/// Plans the case for every model and mode.
///
/// # Errors
/// The case cannot be read or changed as asked, or the user wants to stop.
pub(super) fn all(
    request: &Request,
    description: &Description,
    recorded: Option<&Recorded>,
) -> Result<Settings, RunError> {
    let mut raw = match &request.case {
        Some(file) => read_case(file)?,
        None => RawCase::parse(FIRST, scenes::text(FIRST).expect("it is built in"))?,
    };
    raw.apply(&request.set, &request.unset)?;
    let mut all = Settings::default();
    let offered = description.models.iter().flat_map(|model| {
        let modes = [(model.steady, Mode::Steady), (model.transient, Mode::Transient)];
        modes.into_iter().filter(|(offered, _)| *offered).map(|(_, mode)| (&*model.name, mode))
    });
    let offered: Vec<(&str, Mode)> = offered.collect();
    // Each plan starts programs, and waits for them.
    let plans: Vec<Result<Setting, RunError>> = std::thread::scope(|scope| {
        let raw = &raw;
        let plan = |of| scope.spawn(move || one(request, raw, of, recorded));
        let plans: Vec<_> = offered.iter().copied().map(plan).collect();
        plans.into_iter().map(|plan| plan.join().expect("planning does not panic")).collect()
    });
    for ((model, mode), planned) in offered.into_iter().zip(plans) {
        match planned {
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
    recorded: Option<&Recorded>,
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
    let plan = plan(raw)?.plan;
    let found = plan.participants.iter().find(|participant| participant.role == *role);
    let Some(participant) = found else {
        return Err(RunError::Usage("no active effect of the case needs it".to_owned()));
    };
    let mut configuration = participant.configuration.clone();
    // A live value is held at its first one.
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

/// Places every input on a grid: as recorded, as its producer estimates, or made up.
fn with_inputs(
    mut configuration: Configuration,
    plan: &Plan,
    recorded: Option<&Recorded>,
) -> Setting {
    let mut all_given = Vec::new();
    for index in 0..configuration.inputs.len() {
        let input = &configuration.inputs[index];
        let mut given = Given::new(&input.field, &configuration);
        let producer = plan.participants.iter().find(|p| p.role == input.producer);
        let estimate = producer.and_then(|producer| producer.estimate.as_ref());
        let estimated = estimate.and_then(|layout| layout.grid_of(&input.field.name)).cloned();
        let taken = recorded.and_then(|recorded| recorded.field(&input.field.name));
        let grid = match taken {
            Some((grid, values)) => {
                given.recorded = Some(values.to_vec());
                grid.clone()
            }
            None => estimated.unwrap_or_else(|| given::grid(&input.field)),
        };
        configuration.inputs[index].grid = Some(grid);
        all_given.push(given);
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
    Setting { configuration, given: all_given, interpolation, figures, rewinds, window }
}
