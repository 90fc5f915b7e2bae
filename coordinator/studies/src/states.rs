//! `coordinator states`: finds the steady states of a case with a feedback loop, and which of them
//! are stable.
//!
//! A steady case runs from several starts, which differ in one key. Equal results form one state,
//! listed with the loop gain there. If the gain exceeds one, every pass leads away from the state,
//! so the state is unstable in time.

use crate::study::arguments::StudyArguments;
use crate::study::axis::Axis;
use crate::study::finished::FinishedRuns;
use crate::study::levels::reason;
use crate::study::output::{Printing, StudyFile, StudyPage};
use crate::study::quantity::{Quantities, Quantity};
use crate::study::refuse_unread;
use crate::study::runner::{Outcome, Point, Runner};
use crate::study::table::{Cell, Column, Table};
use crate::study::variants::Variants;
use clap::Args;
use console::case_arguments::CaseArguments;
use console::command::{Command, Context, Group};
use coupling::windows::Windows;
use pages::page::{Block, Page, RunStatus, Section};
use run::error::RunError;
use run::format::{counted, number, of_key};
use run::plan::Planned;
use run::results::figures::is_rounding;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::collections::BTreeMap;
use std::path::Path;

/// Relative difference within which results count as equal, many times the tolerance of the
/// coupling.
const SAME: f64 = 1e-3;

/// Options of `coordinator states`.
#[derive(Debug, Args)]
pub struct StatesCommand {
    #[command(flatten)]
    of: CaseArguments,
    /// Key whose value sets the start of a run, with its values or a range [SI].
    #[arg(long, value_name = "KEY=A,B,C|FROM..TO/COUNT", value_parser = Axis::read)]
    start: Axis,
    #[command(flatten)]
    folder: StudyArguments,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

impl Command for StatesCommand {
    const NAME: &'static str = "states";
    const GROUP: Group = Group::Study;
    const ABOUT: &'static str = "Find the steady states of a coupled case";
    const EXAMPLES: &'static [&'static str] = &["coordinator states CASE --start KEY=0..330/12"];

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        let mut bench = self.folder.bench();
        let (case, key) = (&self.of.case, &self.start.key);
        let standing = bench.planned(case, &self.of.changes.with(key, &self.start.values[0]))?;
        refuse_unread(&standing, key, "--start")?;
        console::logging::log_warnings(&standing.plan.warnings);
        refuse_one_state(&standing, case)?;
        let starts = self.start.numbers().map(|(starts, _)| starts).ok_or_else(|| {
            let fix = "write plain numbers in SI units";
            RunError::Usage(format!("--start {key}: a start is not a number; {fix}"))
        })?;
        let none = FinishedRuns::none(&json!([key, self.start.values]), &standing)?;
        let name = format!("{}-states", standing.plan.name);
        let folder = self.folder.choose(Study::COMMAND, &name, &|folder| none.are_in(folder))?;
        let printing = Printing { json: self.json, quiet: context.quiet };
        let mut runner =
            Runner::new(Variants::of(case), &self.folder, bench, printing.is_silent())?
                .keep_finished(none, &folder)?;
        let study = self.study(&standing, &starts, &mut runner)?;
        study.publish(&folder)?;
        runner.complete()?;
        printing.print(&study, || text(&study), &folder)
    }
}

/// Refuses a case that has a single steady state.
fn refuse_one_state(standing: &Planned, file: &Path) -> Result<(), RunError> {
    let plan = &standing.plan;
    let steady = plan.windows == Windows::Steady;
    if steady && plan.scheme.scheme.is_implicit() {
        return Ok(());
    }
    let why = if steady { "its effects close no feedback loop" } else { "it is not steady" };
    let fix = "write time.mode = \"steady\", and add effects that close a feedback loop";
    Err(RunError::Usage(format!("{} has a single state: {why}; {fix}", file.display())))
}

impl StatesCommand {
    /// Runs the case from every start and groups equal results.
    fn study(
        &self,
        standing: &Planned,
        starts: &[f64],
        runner: &mut Runner<'_, Variants<'_>>,
    ) -> Result<Study, RunError> {
        let (plan, key) = (&standing.plan, &self.start.key);
        let point = |written: &String| Point {
            name: format!("{key} = {written}"),
            changes: self.of.changes.with(key, written),
        };
        let points: Vec<Point> = self.start.values.iter().map(point).collect();
        let quantities = Quantities::of_figures(&plan.figures);
        let (mut states, mut failed): (Vec<State>, _) = (Vec::new(), Vec::new());
        let mut known: Vec<Quantity> = Vec::new();
        runner.run(&points, |n, attempt| {
            let summary = match attempt.outcome {
                Outcome::Finished(run) => run.summary,
                Outcome::Failed(error) => {
                    failed.push((starts[n], reason(&error)));
                    return Ok(());
                }
                Outcome::LeftOut(why) => {
                    failed.push((starts[n], why));
                    return Ok(());
                }
            };
            let all = quantities.all(&summary);
            let all = all.iter().filter(|one| !one.key.starts_with("coupling."));
            let value = |one: &Quantity| {
                let value = one.value(&summary)?;
                let figure = plan.figures.iter().find(|figure| figure.key == one.key);
                let nothing = figure.is_some_and(|it| is_rounding(it, value, &summary.sections));
                Some((one.key.clone(), if nothing { 0.0 } else { value }))
            };
            let values: BTreeMap<String, f64> = all.clone().filter_map(value).collect();
            for one in all.filter(|one| values.contains_key(&one.key)) {
                if known.iter().all(|other| other.key != one.key) {
                    known.push(one.clone());
                }
            }
            let loop_gain = summary.coupling.loop_gain;
            match states.iter_mut().find(|state| same(&state.values, &values)) {
                Some(state) => {
                    state.starts.push(starts[n]);
                    state.loop_gain = state.loop_gain.or(loop_gain);
                }
                None => {
                    states.push(State { starts: vec![starts[n]], loop_gain, stable: None, values });
                }
            }
            Ok(())
        })?;
        for state in &mut states {
            state.stable = state.loop_gain.map(|gain| gain < 1.0);
        }
        let described = |one: &Quantity| plan.figures.iter().any(|figure| figure.key == one.key);
        let quantities = known.into_iter().filter(described);
        let quantities = quantities.filter(|one| states.len() < 2 || differs(&states, one));
        Ok(Study {
            schema: Study::SCHEMA,
            case: plan.name.clone(),
            title: plan.title.clone(),
            file: self.of.case.display().to_string(),
            starts: self.start.clone(),
            quantities: quantities.collect(),
            states,
            failed,
        })
    }
}

/// Returns whether a quantity differs between the states.
fn differs(states: &[State], one: &Quantity) -> bool {
    let mut values = states.iter().map(|state| state.values.get(&one.key));
    let first = values.next().flatten();
    values.any(|value| match (first, value) {
        (Some(a), Some(b)) => !close(*a, *b),
        (a, b) => a.is_some() != b.is_some(),
    })
}

fn same(one: &BTreeMap<String, f64>, other: &BTreeMap<String, f64>) -> bool {
    let equal = |(key, value): (&String, &f64)| other.get(key).is_some_and(|b| close(*value, *b));
    one.len() == other.len() && one.iter().all(equal)
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME * a.abs().max(b.abs())
}

/// Contents of `states.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Study {
    /// Version of the file's layout.
    schema: u32,
    /// Name of the case.
    case: String,
    /// Title of the case.
    title: Option<String>,
    /// The case file.
    file: String,
    /// Key that sets the start, with its values.
    starts: Axis,
    /// Quantities in which the states differ.
    quantities: Vec<Quantity>,
    /// States, in the order of the first start that leads to each.
    states: Vec<State>,
    /// Starts without a result, with the reason.
    failed: Vec<(f64, String)>,
}

impl StudyFile for Study {
    const COMMAND: &'static str = "states";
    const FILE: &'static str = "states.json";
    const SCHEMA: u32 = 2;
}

/// A steady state.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct State {
    /// Starts that lead to this state [SI].
    starts: Vec<f64>,
    /// Loop gain; absent if no two iterations differed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    loop_gain: Option<f64>,
    /// Whether the state is stable in time, judged by the gain.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    stable: Option<bool>,
    /// Values of the quantities by key.
    values: BTreeMap<String, f64>,
}

/// Number of quantities with a column; the file contains all.
const COLUMNS: usize = 6;

impl StudyPage for Study {
    fn page(&self, _: &Path) -> Result<Page, RunError> {
        let states: Vec<&State> = self.states.iter().collect();
        let remarks = failures(self).map(Block::Text);
        let blocks = std::iter::once(Block::Table(table(self).page(&states))).chain(remarks);
        let varied = &self.starts;
        Ok(Page {
            name: format!("Steady states of {}", self.case),
            title: self.title.clone().unwrap_or_default(),
            status: counted(self.states.len() as u64, "state"),
            mood: if self.failed.is_empty() { RunStatus::Good } else { RunStatus::Open },
            reason: format!(
                "{} from {} to {}, {} runs of `{}`",
                varied.key,
                varied.values.first().map_or("", String::as_str),
                varied.values.last().map_or("", String::as_str),
                varied.values.len(),
                self.file
            ),
            sections: Section::of("States", blocks.collect()).into_iter().collect(),
        })
    }
}

/// Renders the study for the terminal.
fn text(study: &Study) -> String {
    let title = study.title.as_ref().map(|title| format!(" · {title}")).unwrap_or_default();
    let states: Vec<&State> = study.states.iter().collect();
    let table = table(study).terminal(&states);
    let failed: String = failures(study).map(|line| format!("  {line}\n")).collect();
    format!("steady states of {}{title}\n{table}{failed}", study.case)
}

fn failures(study: &Study) -> impl Iterator<Item = String> {
    study.failed.iter().map(|(start, why)| format!("from {} = {start}: {why}", study.starts.key))
}

fn table(study: &Study) -> Table<'_, State> {
    let mut columns = vec![
        Column::text("state", |state: &State| {
            match state.stable {
                Some(true) => "stable",
                Some(false) => "unstable",
                None => "unknown",
            }
            .to_owned()
        })
        .naming(),
        Column::quantity("loop gain", |state: &State| {
            Cell::optional(state.loop_gain.as_ref(), |gain| number(gain, 4))
        }),
    ];
    columns.extend(study.quantities.iter().take(COLUMNS).map(|one| {
        Column::quantity(one.name.clone(), move |state: &State| {
            Cell::optional(state.values.get(&one.key), |value| {
                of_key(&one.key, value).show(value, 5)
            })
        })
    }));
    columns.push(Column::text("from", |state: &State| {
        let [first, last] = [state.starts.first(), state.starts.last()];
        let show = |start: Option<&f64>| start.map_or(String::new(), |start| number(*start, 3));
        if first == last { show(first) } else { format!("{} to {}", show(first), show(last)) }
    }));
    Table::new(columns)
}
