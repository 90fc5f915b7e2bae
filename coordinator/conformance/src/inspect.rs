//! `coordinator inspect`: shows the content of a recording, in one pass over the file.

pub(crate) mod against;
mod survey;

pub use survey::{Details, FieldSurvey, ListFilter, Range, RecordingSummary, survey};

use crate::recording_file::{find, open, unreadable};
use crate::replay::difference;
use clap::Args;
use console::command::{Command, Context, Group};
use console::output::print;
use contract::text::{json, one_line};
use run::error::RunError;
use run::format::{self, bytes, counted, seconds};
use run::signals;
use run::wrap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Options of `coordinator inspect`.
#[derive(Debug, Args)]
pub struct InspectCommand {
    /// Recording to inspect, or a result directory with one.
    recording: PathBuf,
    /// List the samples of this field (or topic) one by one.
    #[arg(long, value_name = "NAME")]
    field: Option<String>,
    /// List iterations and samples of this window.
    #[arg(long, value_name = "NUMBER")]
    window: Option<u64>,
    /// List all iterations.
    #[arg(long)]
    iterations: bool,
    /// Find the first difference from another recording of the case, and its cause.
    #[arg(long, value_name = "RECORDING", conflicts_with_all = ["field", "window", "iterations"])]
    against: Option<PathBuf>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

impl Command for InspectCommand {
    const NAME: &'static str = "inspect";
    const GROUP: Group = Group::Look;
    const ABOUT: &'static str = "List windows, iterations, fields and times of a recording";
    const EXAMPLES: &'static [&'static str] = &[
        "coordinator inspect results/latest/recording.mcap",
        "coordinator inspect results/latest/recording.mcap --window 0",
        "coordinator inspect results/latest/recording.mcap --against good/recording.mcap",
    ];

    fn run(&self, _: &Context<'_>) -> Result<(), RunError> {
        let _reading = signals::end_at_once();
        let path = &find(&self.recording)?;
        if let Some(reference) = &self.against {
            return self.compare(path, reference);
        }
        let wanted = ListFilter {
            field: self.field.clone(),
            window: self.window,
            iterations: self.iterations,
        };
        let mut recording = open(path)?;
        let survey = survey(&mut recording, &wanted);
        let damaged = |damage: &String| Err(unreadable(path, damage));
        if self.json {
            print(&json(&survey))?;
            return survey.damage.as_ref().map_or(Ok(()), damaged);
        }
        print(&text(&survey, path))?;
        if let Some(details) = &survey.details {
            print(&details_text(&survey, details, &wanted))?;
        }
        survey.damage.as_ref().map_or(Ok(()), damaged)
    }
}

impl InspectCommand {
    /// Compares the recording with a reference.
    fn compare(&self, path: &Path, reference: &Path) -> Result<(), RunError> {
        let paths = [path, &find(reference)?];
        let [mut now, mut then] = [open(paths[0])?, open(paths[1])?];
        let found = against::compare((&mut now, paths[0]), (&mut then, paths[1]))?;
        print(&if self.json { json(&found) } else { against::text(&found, paths) })?;
        let compared = &found.comparison;
        let first = compared.first.as_ref().map(difference);
        let what = first.or_else(|| compared.other.clone());
        what.map_or(Ok(()), |what| Err(RunError::Differs(format!("the recordings differ: {what}"))))
    }
}

/// Describes the whole recording.
#[must_use]
pub fn text(survey: &RecordingSummary, path: &Path) -> String {
    let mut out = format!("{} · {}\n", survey.case, path.display());
    let state = match &survey.damage {
        _ if survey.complete => "complete",
        Some(_) => "DAMAGED: only the part before the damage",
        None => "TRUNCATED: it has no end",
    };
    let _ = writeln!(
        out,
        "  recording     {}, {state}, {} of run time, by {}",
        bytes(survey.bytes),
        seconds(survey.duration_s),
        survey.writer
    );
    match &survey.error {
        Some(error) => {
            let _ = writeln!(out, "  the run       FAILED: {}", one_line(error));
        }
        None if survey.complete => out += "  the run       completed\n",
        None => {}
    }
    participants(&mut out, survey);
    coupling(&mut out, survey);
    out = wrap::columns(&out);
    if !survey.fields.is_empty() {
        fields(&mut out, survey);
    }
    out
}

fn participants(out: &mut String, survey: &RecordingSummary) {
    for (n, one) in survey.participants.iter().enumerate() {
        let title = if n == 0 { "participants" } else { "" };
        let states = match one.states {
            0 => String::new(),
            n => format!(", {}", counted(n, "state")),
        };
        let model = if one.model.is_empty() { "?".into() } else { one_line(&one.model) };
        let _ = writeln!(
            out,
            "  {title:13} {:10} {model:14} {} in {}{states}, by {}",
            one.role,
            counted(one.solves, "solve"),
            seconds(one.model_s),
            one.program
        );
    }
}

fn coupling(out: &mut String, survey: &RecordingSummary) {
    let acceleration = match survey.acceleration.as_str() {
        "none" => String::new(),
        word => format!(", {word}"),
    };
    let repeated = match survey.repeated_windows {
        0 => String::new(),
        n => format!(", {n} repeated"),
    };
    let _ = writeln!(
        out,
        "  coupling      {}{acceleration}: {}{repeated} up to {} s, {}, at most {} in a window, {} \
         beside the models",
        survey.scheme,
        counted(survey.windows, "window"),
        survey.end_s,
        counted(survey.iterations, "iteration"),
        survey.max_iterations_in_window,
        seconds(survey.coupling_s)
    );
    for (field, residual) in &survey.final_residuals {
        let _ = writeln!(
            out,
            "  residual      {} {residual} in the last iteration",
            one_line(&shown(survey, field)),
            residual = format::number(*residual, 4)
        );
    }
    if let Some(imbalance) = survey.energy_imbalance {
        let _ = writeln!(
            out,
            "  energy        sent and received differ by at most {imbalance}",
            imbalance = format::number(imbalance, 2)
        );
    }
}

/// Returns a topic or field under the names of the case: `thermal/rail_temperature` for
/// `thermal/lower_temperature`.
fn shown(survey: &RecordingSummary, topic: &str) -> String {
    let (path, name) = match topic.rfind('/') {
        Some(slash) => topic.split_at(slash + 1),
        None => ("", topic),
    };
    let name = survey.bodies.as_ref().map_or_else(|| name.to_owned(), |bodies| bodies.shown(name));
    format!("{path}{name}")
}

fn fields(out: &mut String, survey: &RecordingSummary) {
    let fields = &survey.fields;
    let short =
        |field: &FieldSurvey| shown(survey, &field.topic).trim_start_matches("field/").to_owned();
    let wide = fields.iter().map(|f| short(f).len()).max().unwrap_or(0).max(5);
    let _ = writeln!(
        out,
        "\n  {:wide$} {:>5} {:>8} {:>7} {:>10} {:>10}",
        "field", "unit", "values", "samples", "min", "max"
    );
    for field in fields {
        let Range { min, max, first_non_finite, .. } = field.range.without_rounding();
        let _ = writeln!(
            out,
            "  {:wide$} {:>5} {:>8} {:>7} {} {}",
            short(field),
            field.unit,
            field.values,
            field.samples,
            number(min),
            number(max)
        );
        if let (Some(index), Some((window, iteration))) = (first_non_finite, field.non_finite_at) {
            let _ = writeln!(
                out,
                "  {:wide$} NOT FINITE: index {index} in window {window}, iteration {iteration}",
                ""
            );
        }
    }
}

/// Returns the tables of iterations and of samples, as far as the options ask for them.
#[must_use]
pub fn details_text(survey: &RecordingSummary, details: &Details, wanted: &ListFilter) -> String {
    let mut out = String::new();
    if details.cut {
        let listed = details.iterations.len() + details.samples.len();
        let _ =
            writeln!(out, "\n  only the first {listed} entries are listed; give --window NUMBER");
    }
    let with_iterations = wanted.iterations || wanted.window.is_some();
    if with_iterations && !details.iterations.is_empty() {
        let _ = writeln!(
            out,
            "\n  {:>6} {:>9} {:>10} {:>10} {:>7} {:>8} {:>10} {:>12}",
            "window",
            "iteration",
            "residual",
            "relaxation",
            "columns",
            "beside",
            "sent [W]",
            "received [W]"
        );
        for one in &details.iterations {
            let columns = one.columns.map_or_else(|| "-".to_owned(), |n| n.to_string());
            let relaxation = one.relaxation.map_or_else(|| "-".to_owned(), |w| format!("{w:.4}"));
            let _ = writeln!(
                out,
                "  {:>6} {:>9} {} {relaxation:>10} {columns:>7} {:>8} {} {:>12}",
                one.window,
                one.iteration,
                number(one.residual),
                seconds(one.coupling_seconds),
                number(one.sent),
                number(one.received)
            );
        }
    }
    if wanted.field.is_none() && wanted.window.is_none() {
        return out;
    }
    if details.samples.is_empty() {
        out += "\n  the recording has no such sample\n";
        return out;
    }
    let short = |topic: &str| shown(survey, topic).trim_start_matches("field/").to_owned();
    let topics: Vec<String> = details.samples.iter().map(|one| short(&one.topic)).collect();
    let wide = topics.iter().map(String::len).max().unwrap_or(0).max(5);
    let _ = writeln!(
        out,
        "\n  {:wide$} {:>6} {:>9} {:>6} {:>8} {:>10} {:>10}",
        "topic", "window", "iteration", "sample", "at", "min", "max"
    );
    for (one, topic) in details.samples.iter().zip(&topics) {
        let range = one.range.without_rounding();
        let bad = range
            .first_non_finite
            .map_or_else(String::new, |index| format!("  NOT FINITE at index {index}"));
        let _ = writeln!(
            out,
            "  {topic:wide$} {:>6} {:>9} {:>6} {:>8} {} {}{bad}",
            one.window,
            one.iteration,
            one.sequence,
            seconds(one.at_s),
            number(range.min),
            number(range.max)
        );
    }
    out
}

fn number(value: Option<f64>) -> String {
    value.map_or_else(|| format!("{:>10}", "-"), |value| format!("{value:>10.3e}"))
}
