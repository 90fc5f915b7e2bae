//! The command line.

use crate::ablate;
use crate::accuracy::{self, Decision, Search};
use crate::advise;
use crate::ask;
use crate::case_arguments::CaseArguments;
use crate::catalogue;
use crate::colour::{self, Colours};
use crate::compare;
use crate::conform;
use crate::cost;
use crate::drive;
use crate::export;
use crate::fit;
use crate::fmu;
use crate::inspect;
use crate::keys;
use crate::listing::Listing;
use crate::logging::{Level, Logging, log_warnings};
use crate::manual;
use crate::new;
use crate::new_solver;
use crate::output;
use crate::picture;
use crate::progress::Progress;
use crate::relay;
use crate::replay;
use crate::report;
use crate::report::page::Page;
use crate::reproduce;
use crate::solvers;
use crate::stability;
use crate::states;
use crate::study::output::{Kind, kind};
use crate::study::{Variant, expected_seconds};
use crate::sweep;
use clap::{Args, CommandFactory as _, FromArgMatches as _, Parser, Subcommand};
use contract::description::Description;
use contract::text::{json, one_line, visible};
use run::checkpoint::{Checkpoint, Checkpoints, Corrupt};
use run::crew;
use run::error::{RunError, file_failure};
use run::perform::{self, Outcome, RunStart};
use run::plan::{Planned, Shown, plan};
use run::plan_file::PlanFile;
use run::programs;
use run::record::Compression;
use run::results::place::RESULTS;
use run::results::{Existing, ResultFolder, show};
use run::signals;
use run::warnings::{self, Warning};
use serde_json::{Value, json};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::time::{Duration, Instant};

/// Plans, runs and couples mechanical-thermal contact simulations.
#[derive(Debug, Parser)]
#[command(name = "coordinator", version = env!("COORDINATOR_VERSION"), propagate_version = true, max_term_width = 80)]
pub struct Arguments {
    /// What reaches the screen [default: RUST_LOG, or warn].
    #[arg(long, global = true, value_name = "LEVEL")]
    log: Option<Level>,
    /// Print errors only, whatever else says what reaches the screen.
    #[arg(long, short, global = true)]
    quiet: bool,
    /// Colours: on a terminal, always or never.
    #[arg(
        long,
        global = true,
        value_name = "WHEN",
        default_value = "auto",
        hide_possible_values = true
    )]
    color: Colours,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run a case and write its results.
    Run(RunArguments),
    /// Drive a run from outside, window by window: JSON lines on standard input and output.
    Drive(drive::Arguments),
    /// Check a case: every error at once, each with its place, reason and fix. Starts the programs
    /// that the case names, to ask them what they read.
    Check {
        #[command(flatten)]
        case: CaseArguments,
        /// Start no program: judge a case from elsewhere by the coordinator's own keys alone.
        #[arg(long)]
        no_start: bool,
        /// Print JSON: errors and warnings, each with key, place, reason and fix.
        #[arg(long, conflicts_with = "no_start")]
        json: bool,
    },
    /// Show what a case will run and what not, and why. Starts the programs that the case names, to
    /// ask them what they offer.
    Plan {
        #[command(flatten)]
        case: CaseArguments,
        /// Start no program: show what a case from elsewhere says, and what it would start.
        #[arg(long)]
        no_start: bool,
        /// Say of every effect, in the case or not, whether it matters, by about how much, and what it costs.
        #[arg(long, conflicts_with = "no_start")]
        advise: bool,
        /// Print JSON, as plan.json has it.
        #[arg(long, conflicts_with_all = ["no_start", "advise"])]
        json: bool,
    },
    /// Write a case that runs, with a line on every key, to begin from.
    New(new::Arguments),
    /// Write a solver that conforms to the contract, in Python, C, Fortran or Rust, to begin from.
    NewSolver(new_solver::Arguments),
    /// Show the models and effects that the installed solvers offer.
    Solvers(solvers::Arguments),
    /// Show every key that a case may have: unit, range, default, and who reads it.
    Keys(keys::Arguments),
    /// Show every field that participants exchange or write: unit, components, and who gives it.
    Fields(Listing),
    /// Show every number of a summary: unit, meaning, what is expected, and who gives it.
    Figures(Listing),
    /// Show what a recording holds: windows, iterations, ranges, residuals, timings.
    Inspect(inspect::Arguments),
    /// Drive one participant through a recording, and compare all that it sends.
    Replay(replay::Arguments),
    /// Carry a participant on another machine to the run at home.
    #[command(disable_help_flag = true)]
    Relay(relay::Arguments),
    /// Put a participant through the whole contract, and print how it went.
    Conform(conform::Arguments),
    /// Run the hard cases, drive their parameters to the edge, and print what held.
    Stability(stability::Arguments),
    /// Find the steady states of a case with a loop, and which of them last.
    States(states::Arguments),
    /// Run a case over values of its keys: a row a point, plots over what varies.
    Sweep(sweep::Arguments),
    /// Fit the figures of a sweep, with errors, for `ask` and for simulations that link to them.
    Fit(fit::Arguments),
    /// Write a case, or a surrogate, as an FMU (FMI 3.0): live values or keys are inputs, figures outputs.
    Fmu(fmu::Arguments),
    /// Print the figures of a surrogate at a point, with their errors, or at the rows of a table.
    Ask(ask::Arguments),
    /// Write the fields of a recording as VTK series or CSV.
    Export(export::Arguments),
    /// Switch off each effect in turn: what it changes in the answer, and what it costs.
    Ablate(ablate::Arguments),
    /// Show what accuracy costs in time, over models, resolutions, windows and tolerances.
    Cost(cost::Arguments),
    /// Write report.html about the run, or the study, in a folder, with plots, in one file.
    Report {
        /// The result directory.
        #[arg(value_name = "DIR")]
        folder: PathBuf,
    },
    /// Say what differs between two results: case, figures, fields and time.
    Compare(compare::Arguments),
    /// Draw the fields of a run as PNG, SVG or PDF, for papers and slides.
    Picture(picture::Arguments),
    /// Run a published study again, and lay tables and figures beside what was printed.
    Reproduce(reproduce::Arguments),
    /// Print the script with which a shell completes commands.
    Completions(manual::Completions),
    /// Write the pages of the manual.
    Man(manual::Pages),
}

#[derive(Clone, Debug, Args)]
struct RunArguments {
    /// The case file, or - for standard input.
    #[arg(required_unless_present = "resume")]
    case: Option<PathBuf>,
    /// Change a key: dotted name and TOML value (a bare word is a text).
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Remove a key.
    #[arg(long, value_name = "KEY")]
    unset: Vec<String>,
    /// Result directory [default: results/NAME, or NAME-2 and so on; the last one is results/latest].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace the results of an earlier run in DIR.
    #[arg(long)]
    replace: bool,
    /// Record every exchange in DIR/recording.mcap, uncompressed or by zstd.
    #[arg(long, value_name = "COMPRESSION", num_args = 0..=1, require_equals = true,
          default_missing_value = "none", value_parser = compression)]
    record: Option<Compression>,
    /// Write DIR/report.html at the end, whatever the end is.
    #[arg(long)]
    report: bool,
    /// Make errors of warnings: of the case before anything runs, of the answer at the end.
    #[arg(long)]
    strict: bool,
    /// Print JSON at the end, as summary.json has it.
    #[arg(long)]
    json: bool,
    /// Choose models and resolution, the cheapest expected to meet this error, and state the error.
    #[arg(long, value_name = "ERROR", group = "stated", conflicts_with = "resume", value_parser = accuracy::Target::read_error)]
    accuracy: Option<f64>,
    /// Run on grids twice and four times coarser too, and state what the three are extrapolated to, with the error.
    #[arg(long, group = "stated", conflicts_with = "resume")]
    extrapolate: bool,
    /// The quantity whose error is stated, a dotted key of summary.json [default: that which participants rank first].
    #[arg(long, value_name = "KEY", requires = "stated")]
    quantity: Option<String>,
    /// Go on with the run of this result directory from its last checkpoint.
    #[arg(long, value_name = "DIR", conflicts_with_all = ["case", "set", "unset", "out", "replace"])]
    resume: Option<PathBuf>,
}

/// An error of a command, and the log in which there is more to read.
#[derive(Debug)]
struct Ended {
    error: Box<RunError>,
    log: Option<PathBuf>,
}

impl From<RunError> for Ended {
    fn from(error: RunError) -> Self {
        Self { error: Box::new(error), log: None }
    }
}

/// Does what the command line asks for; the exit code.
pub fn main(since: Instant) -> u8 {
    let command = Arguments::command().color(colour::of_help(std::env::args_os()));
    let parsed = command.try_get_matches().and_then(|found| Arguments::from_arg_matches(&found));
    let arguments = match parsed {
        Ok(arguments) => arguments,
        Err(error) => return usage_error(&error),
    };
    colour::choose(arguments.color);
    let level = if arguments.quiet { Some(Level::Error) } else { arguments.log };
    let log = Logging::install(level);
    match act(&arguments, &log, since) {
        Ok(()) => 0,
        Err(ended) => {
            print_error(&ended.error);
            if let Some(log) = &ended.log {
                let _ = writeln!(std::io::stderr(), "  log: {}", log.display());
            }
            ended.error.exit_code()
        }
    }
}

/// Help, the version, or what is wrong with the command line.
fn usage_error(error: &clap::Error) -> u8 {
    match error.print().and_then(|()| std::io::stdout().flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            let error = output::failure(&error);
            print_error(&error);
            error.exit_code()
        }
        _ => u8::try_from(error.exit_code()).unwrap_or(2),
    }
}

fn act(arguments: &Arguments, log: &Logging, since: Instant) -> Result<(), Ended> {
    match &arguments.command {
        Command::Run(run) => {
            let screen = Screen { quiet: arguments.quiet, log, since };
            match &run.resume {
                _ if run.accuracy.is_some() || run.extrapolate => run_to(run, &screen),
                Some(folder) => match resume(folder, log)? {
                    Some(begun) => run_case(&begun, run, &screen),
                    None => {
                        let shown = folder.display();
                        let text = format!("the run in {shown} has already finished\n");
                        Ok(print(arguments.quiet, &text)?)
                    }
                },
                None => {
                    let _participants = crew::start_early();
                    run_case(&begin(run, log)?, run, &screen)
                }
            }
        }
        Command::Drive(asked) => Ok(drive::main(asked, log, since)?),
        Command::Check { case, no_start: true, .. } => {
            let _asking = signals::end_at_once();
            let (shown, rest) = (case.shown(), case.alone()?.not_judged_text());
            let text = format!("{shown}: no errors in what was checked\n{rest}");
            Ok(print(arguments.quiet, &text)?)
        }
        Command::Check { case, json: true, .. } => Ok(check_as_json(case)?),
        Command::Check { case, .. } => {
            let _asking = signals::end_at_once();
            let planned = case.plan()?;
            let warnings = planned.plan.warnings.iter();
            let warnings: String =
                warnings.map(|warning| format!("warning: {warning}\n")).collect();
            let text = format!("{warnings}{}: no errors\n", case.shown());
            Ok(print(arguments.quiet, &text)?)
        }
        Command::Plan { case, no_start, advise, json: as_json } => {
            let _asking = signals::end_at_once();
            let text = match (no_start, advise, as_json) {
                (true, ..) => Shown(&case.alone()?).to_string(),
                (_, _, true) => json(&PlanFile::of(&case.plan()?.plan)),
                (_, false, _) => case.plan()?.plan.to_string(),
                (_, true, _) => advised(case)?,
            };
            let printed = if *as_json { print(false, &text) } else { print_lines(false, &text) };
            Ok(printed?)
        }
        Command::New(asked) => Ok(print(arguments.quiet, &new::act(asked, installed)?)?),
        Command::NewSolver(asked) => Ok(print(arguments.quiet, &new_solver::act(asked)?)?),
        Command::Solvers(asked) => Ok(solvers::main(asked, &installed()?)?),
        Command::Keys(asked) => Ok(keys::main(asked, &installed()?)?),
        Command::Fields(asked) => Ok(catalogue::fields(asked, &installed()?)?),
        Command::Figures(asked) => Ok(catalogue::figures(asked, &installed()?)?),
        Command::Inspect(asked) => Ok(inspect::main(asked)?),
        Command::Replay(asked) => Ok(replay::main(asked, arguments.quiet)?),
        Command::Relay(asked) => Ok(relay::main(asked)?),
        Command::Conform(asked) => Ok(conform::main(asked, arguments.quiet)?),
        Command::States(asked) => Ok(states::main(asked, arguments.quiet)?),
        Command::Sweep(asked) => Ok(sweep::main(asked, arguments.quiet)?),
        Command::Fit(asked) => Ok(fit::main(asked, arguments.quiet)?),
        Command::Fmu(asked) => Ok(fmu::main(asked, arguments.quiet)?),
        Command::Ask(asked) => Ok(ask::main(asked)?),
        Command::Ablate(asked) => Ok(ablate::main(asked, arguments.quiet)?),
        Command::Cost(asked) => Ok(cost::main(asked, arguments.quiet)?),
        Command::Stability(asked) => Ok(stability::main(asked, arguments.quiet)?),
        Command::Export(asked) => Ok(export::main(asked, arguments.quiet)?),
        Command::Report { folder } => {
            let _reading = signals::end_at_once();
            let path = report::write(&page_about(folder)?, folder)?;
            Ok(print(arguments.quiet, &format!("{}\n", path.display()))?)
        }
        Command::Compare(asked) => Ok(compare::main(asked, arguments.quiet)?),
        Command::Picture(asked) => {
            let _reading = signals::end_at_once();
            Ok(print(arguments.quiet, &picture::act(asked)?)?)
        }
        Command::Reproduce(asked) => Ok(reproduce::main(asked, arguments.quiet)?),
        Command::Completions(asked) => {
            Ok(print(false, &manual::completions(asked, Arguments::command()))?)
        }
        Command::Man(asked) => {
            Ok(print(arguments.quiet, &manual::pages(asked, Arguments::command())?)?)
        }
    }
}

/// Prints the errors or the warnings of a case; its errors are those of the command.
fn check_as_json(asked: &CaseArguments) -> Result<(), RunError> {
    let _asking = signals::end_at_once();
    let planned = asked.plan();
    let problem = |one: &case::Problem| json!({"key": one.key, "place": one.place.to_string(), "reason": one.reason, "fix": one.fix});
    let (errors, warnings) = match &planned {
        Ok(planned) => (Vec::new(), planned.plan.warnings.clone()),
        Err(RunError::Case(problems)) => {
            (problems.list().iter().map(problem).collect(), Vec::new())
        }
        Err(other) => {
            let nowhere = json!({"key": "", "place": "", "reason": other.to_string(), "fix": ""});
            (vec![nowhere], Vec::new())
        }
    };
    let warnings: Vec<Value> = warnings.iter().map(warning_as_json).collect();
    print(false, &json(&json!({"case": asked.case, "errors": errors, "warnings": warnings})))?;
    planned.map(drop)
}

/// A warning with the same entries as an error has, besides its own.
fn warning_as_json(warning: &Warning) -> Value {
    let mut entries = json!(warning);
    let usual = [("place", String::new()), ("reason", warning.to_string()), ("fix", String::new())];
    for (name, value) in usual {
        if entries.get(name).is_none() {
            entries[name] = value.into();
        }
    }
    entries
}

/// The plan of a case, and what its effects are worth.
fn advised(asked: &CaseArguments) -> Result<String, RunError> {
    let planned = asked.plan()?;
    let base = Variant { set: asked.set.clone(), unset: asked.unset.clone() };
    let all = advise::advise(&asked.case, &base, &planned)?;
    Ok(format!("{}{}", planned.plan, advise::text(&all, &planned)))
}

/// A run that has been planned and has its folder.
struct Begun {
    planned: Planned,
    folder: ResultFolder,
    plan_seconds: f64,
    from: Option<Checkpoint>,
}

impl Begun {
    /// An error, with the log in which there is more to read.
    fn report(&self, error: RunError) -> Ended {
        Ended { error: Box::new(error), log: Some(self.folder.shown_log()) }
    }
}

impl RunArguments {
    fn case(&self) -> CaseArguments {
        let case = self.case.clone().expect("required unless a run is resumed");
        CaseArguments { case, set: self.set.clone(), unset: self.unset.clone() }
    }

    /// Where the run goes that has been planned: into the folder that the user names, or else into the
    /// next of its name.
    fn folder(&self, planned: &Planned, case: &Path) -> Result<ResultFolder, RunError> {
        let (name, results) = (&planned.plan.name, Path::new(RESULTS));
        match &self.out {
            None if !self.replace => ResultFolder::next(results, name),
            out => {
                let path = out.clone().unwrap_or_else(|| results.join(name));
                ResultFolder::prepare(&path, case, Existing::option(self.replace))
            }
        }
    }
}

fn begin(run: &RunArguments, log: &Logging) -> Result<Begun, RunError> {
    let planning = Instant::now();
    let case = run.case();
    let planned = case.plan()?;
    match run.strict {
        true => refuse_warnings(&planned.plan.warnings)?,
        false => log_warnings(&planned.plan.warnings),
    }
    let plan_seconds = planning.elapsed().as_secs_f64();
    let folder = run.folder(&planned, &case.case)?;
    log_into(&folder, log)?;
    Ok(Begun { planned, folder, plan_seconds, from: None })
}

/// A run resumes from its newest intact checkpoint, with the case as it was run; `None` if it has
/// come to its end.
fn resume(path: &Path, log: &Logging) -> Result<Option<Begun>, RunError> {
    let planning = Instant::now();
    let folder = ResultFolder::resume(path)?;
    if folder.has_ended() {
        return Ok(None);
    }
    let (newest, corrupt) = Checkpoints::of(&folder.path()).newest();
    for Corrupt { name, reason } in &corrupt {
        let next = if newest.is_some() { "; using the previous one" } else { "" };
        tracing::warn!("checkpoint {name} is not used: {reason}{next}");
    }
    let shown = path.display();
    let checkpoint = newest.ok_or_else(|| {
        let whole = if corrupt.is_empty() { "no checkpoint" } else { "no intact checkpoint" };
        RunError::Usage(format!(
            "{shown} holds {whole}; a case writes them with output.checkpoint_every"
        ))
    })?;
    let raw = folder.read_case()?.with_folder(checkpoint.state.origin.folder.clone());
    let planned = tracing::info_span!("plan").in_scope(|| plan(raw))?;
    perform::check_origin(&checkpoint.state.origin, &perform::origin(&planned)?)?;
    log_into(&folder, log)?;
    folder.reopen()?;
    let plan_seconds = planning.elapsed().as_secs_f64();
    Ok(Some(Begun { planned, folder, plan_seconds, from: Some(checkpoint) }))
}

fn log_into(folder: &ResultFolder, log: &Logging) -> Result<(), RunError> {
    log.write_to(folder.log()?).map_err(|error| file_failure(&folder.shown_log(), &error))
}

fn compression(word: &str) -> Result<Compression, String> {
    match word {
        "none" => Ok(Compression::None),
        "zstd" => Ok(Compression::Zstd),
        other => Err(format!("`{other}` is neither none nor zstd")),
    }
}

/// Where a run shows how far it is, and since when.
struct Screen<'a> {
    quiet: bool,
    log: &'a Logging,
    since: Instant,
}

fn run_case(begun: &Begun, asked: &RunArguments, screen: &Screen) -> Result<(), Ended> {
    conclude(begun, perform(begun, asked, screen), asked, screen)
}

/// The error is stated. With a target models and resolution are chosen, and once more if the error turns out too large. The answer that there
/// is stays until a better one has come to its end.
fn run_to(asked: &RunArguments, screen: &Screen) -> Result<(), Ended> {
    let _participants = crew::keep();
    let case = asked.case.as_ref().expect("required unless a run is resumed");
    let base = Variant { set: asked.set.clone(), unset: asked.unset.clone() };
    let (relative, quantity) = (asked.accuracy, asked.quantity.clone());
    let mut search = match asked.extrapolate {
        true => Search::extrapolate(case, &base, quantity)?,
        false => Search::begin(case, &base, accuracy::Target { relative, quantity })?,
    };
    let mut answer: Option<ResultFolder> = None;
    loop {
        let Variant { set, unset } = search.variant();
        let chosen = RunArguments { set, unset, ..asked.clone() };
        let begin_at = Instant::now();
        let mut begun = match &answer {
            None => begin(&chosen, screen.log)?,
            Some(answer) => refine(&chosen, answer, screen.log)?,
        };
        let mut outcome = perform(&begun, &chosen, screen);
        if outcome.error.is_some() {
            return conclude(&begun, outcome, &chosen, screen);
        }
        let decision = search.judge(&mut outcome.summary, begin_at.elapsed().as_secs_f64())?;
        begun.folder.write_summary(&perform::json(&outcome.summary))?;
        begun.folder = match answer.take() {
            None => begun.folder,
            Some(answer) => answer.take_over(begun.folder)?,
        };
        match decision {
            Decision::Refine => {
                search.refine();
                screen.log.release();
                answer = Some(begun.folder);
                continue;
            }
            Decision::Missed => outcome.error = Some(search.missed()),
            Decision::Met => {}
        }
        return conclude(&begun, outcome, &chosen, screen);
    }
}

/// A run that is to take the place of an answer.
fn refine(run: &RunArguments, answer: &ResultFolder, log: &Logging) -> Result<Begun, RunError> {
    let planning = Instant::now();
    let planned = run.case().plan()?;
    let plan_seconds = planning.elapsed().as_secs_f64();
    let folder = answer.refined()?;
    log_into(&folder, log)?;
    Ok(Begun { planned, folder, plan_seconds, from: None })
}

fn perform(begun: &Begun, asked: &RunArguments, screen: &Screen) -> Outcome {
    let Begun { planned, folder, plan_seconds, from } = begun;
    let start = RunStart { since: screen.since, plan_seconds: *plan_seconds };
    let plan = &planned.plan;
    let progress = Progress::new(screen.quiet, plan.windows.count(), expected_seconds(plan));
    screen.log.share_screen(progress.bar());
    let progress: Rc<dyn run::progress::Progress> = Rc::new(progress);
    let mut outcome = perform::run(planned, folder, &progress, start, from.as_ref(), asked.record);
    if let Some(error) = screen.log.failure() {
        outcome = outcome.fail(file_failure(&folder.shown_log(), &error), folder);
    }
    outcome
}

/// Writes the report that is asked for, and prints how the run went.
fn conclude(
    begun: &Begun,
    outcome: Outcome,
    asked: &RunArguments,
    screen: &Screen,
) -> Result<(), Ended> {
    let folder = &begun.folder;
    let written = if asked.report { report_on(&folder.path()) } else { Ok(()) };
    let text = || {
        let shown = folder.shown().display().to_string();
        let next = match asked.report {
            true => format!("  page      {shown}/{}\n", report::FILE),
            false => format!("  next      coordinator report {shown}\n"),
        };
        perform::report(&outcome, &begun.planned.plan, folder) + &next
    };
    // However the run ended: what it has is what is printed.
    let print_json = || print(false, &json(&outcome.summary));
    match outcome.error {
        Some(error) if asked.json => Err(begun.report(error.and(written).and(print_json()))),
        // It has an answer, if not as accurate as was asked for.
        Some(error @ RunError::Inaccurate { .. }) => {
            let plan = &begun.planned.plan;
            let text = show::text(&outcome.summary, plan.title.as_deref(), &plan.figures);
            let printed = print_lines(screen.quiet, &text);
            Err(begun.report(error.and(written).and(printed)))
        }
        Some(error) => Err(begun.report(error.and(written))),
        None => {
            let printed = written.and_then(|()| match asked.json {
                true => print_json(),
                false => print_lines(screen.quiet, &text()),
            });
            let strict = || match asked.strict {
                true => refuse_warnings(&warnings::of_summary(&outcome.summary)),
                false => Ok(()),
            };
            printed.and_then(|()| strict()).map_err(|error| begun.report(error))
        }
    }
}

/// Warnings are errors.
fn refuse_warnings(warnings: &[Warning]) -> Result<(), RunError> {
    let said: Vec<String> = warnings.iter().map(Warning::to_string).collect();
    if said.is_empty() {
        return Ok(());
    }
    Err(RunError::Usage(format!("{}; change it, or leave out --strict", said.join("\n  "))))
}

/// Every kind of study that leaves a page.
const STUDIES: [Kind; 6] = [
    kind::<cost::Study>(),
    kind::<ablate::Study>(),
    kind::<states::Study>(),
    kind::<sweep::Study>(),
    kind::<stability::Report>(),
    kind::<reproduce::Record>(),
];

/// The page about what is in a folder, a study or a run.
fn page_about(folder: &Path) -> Result<Page, RunError> {
    match STUDIES.iter().find(|study| folder.join(study.file).is_file()) {
        Some(study) => (study.page)(folder),
        None => report::of_run(folder),
    }
}

/// Writes the report about the run in a folder.
fn report_on(folder: &Path) -> Result<(), RunError> {
    report::write(&report::of_run(folder)?, folder).map(drop)
}

/// What the installed programs say of themselves.
fn installed() -> Result<Vec<Description>, RunError> {
    let _asking = signals::end_at_once();
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()
        .map_err(|error| file_failure(std::path::Path::new("tokio"), &error))?;
    let described = programs::installed().into_iter().map(|(role, program)| {
        let described = runtime.block_on(program.describe(&role, Duration::from_secs(30)))?;
        described.check().map_err(|fault| program.misled(&role, fault))?;
        Ok(described)
    });
    described.collect()
}

fn print(quiet: bool, text: &str) -> Result<(), RunError> {
    if quiet { Ok(()) } else { output::print(text) }
}

/// Prints lines with names, in colours where there are some.
fn print_lines(quiet: bool, text: &str) -> Result<(), RunError> {
    match quiet {
        true => Ok(()),
        false if colour::on(&std::io::stdout()) => {
            output::print_raw(&colour::named_lines(&visible(text)))
        }
        false => output::print(text),
    }
}

fn print_error(error: &RunError) {
    if let RunError::Both { first, second } = error {
        print_error(first);
        return print_error(second);
    }
    let mut stderr = std::io::stderr().lock();
    let _ = match error {
        RunError::Case(problems) => {
            writeln!(stderr, "{}", problems.render(colour::on(&stderr)))
        }
        // Whatever it quotes, an error is one line.
        other => {
            let error = colour::error(colour::on(&stderr));
            writeln!(stderr, "{error}: {}", one_line(&other.to_string()))
        }
    };
}
