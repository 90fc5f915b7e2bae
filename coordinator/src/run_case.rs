//! `coordinator run`: runs a case and writes its results, or resumes a run from a checkpoint.

use clap::Args;
use console::case_arguments::{CaseArguments, Changes};
use console::command::{Command, Context, Group};
use console::logging::{Logging, log_warnings};
use console::output;
use console::progress::Progress;
use contract::text::json;
use run::checkpoint::Checkpoint;
use run::error::{RunError, file_failure};
use run::fleet::Fleet;
use run::perform::{self, Outcome, RunOptions};
use run::plan::{Planned, plan};
use run::record::Compression;
use run::results::place::RESULTS;
use run::results::{Existing, ResultFolder, show};
use run::stopped::StoppedRun;
use run::warnings::Warning;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::time::Instant;
use studies::accuracy::{Decision, Search, Target};
use studies::study::bench::Bench;
use studies::study::expected_seconds;

/// Options of `coordinator run`.
#[derive(Clone, Debug, Args)]
pub(crate) struct RunCommand {
    /// The case file, or - for standard input.
    #[arg(required_unless_present = "resume")]
    case: Option<PathBuf>,
    #[command(flatten)]
    changes: Changes,
    /// Result directory [default: results/NAME, then NAME-2 and so on; results/latest links to it].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace the results of an earlier run in DIR.
    #[arg(long)]
    replace: bool,
    /// Record every exchange in DIR/recording.mcap; COMPRESSION is none or lz4.
    #[arg(long, value_name = "COMPRESSION", num_args = 0..=1, require_equals = true,
          default_missing_value = "none", value_parser = compression)]
    record: Option<Compression>,
    /// Write DIR/report.html at the end, also of a run that fails.
    #[arg(long)]
    report: bool,
    /// Turn warnings into errors: those of the case before the run starts, others at its end.
    #[arg(long)]
    strict: bool,
    /// Print summary.json at the end.
    #[arg(long)]
    json: bool,
    /// Choose the cheapest models and resolution expected to meet this error, and state the error.
    #[arg(long, value_name = "ERROR", group = "stated", conflicts_with = "resume", value_parser = Target::read_error)]
    accuracy: Option<f64>,
    /// Run on grids twice and four times coarser too, extrapolate, and state the error.
    #[arg(long, group = "stated", conflicts_with = "resume")]
    extrapolate: bool,
    /// Quantity whose error is stated, a dotted key of summary.json [default: the first ranked by
    /// participants].
    #[arg(long, value_name = "KEY", requires = "stated")]
    quantity: Option<String>,
    /// Resume the run of this result directory from its last checkpoint. A recorded run is recorded
    /// on, in a file of its own.
    #[arg(long, value_name = "DIR", conflicts_with_all = ["case", "set", "unset", "out", "replace"])]
    resume: Option<PathBuf>,
}

impl Command for RunCommand {
    const NAME: &'static str = "run";
    const GROUP: Group = Group::Run;
    const ABOUT: &'static str = "Run a case and write its results";
    const EXAMPLES: &'static [&'static str] = &[
        "coordinator run CASE --set motion.speed=30 --report",
        "coordinator run CASE --accuracy 1%",
        "coordinator run --resume results/latest",
    ];

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        if self.accuracy.is_some() || self.extrapolate {
            return run_to(self, context);
        }
        let Some(folder) = &self.resume else {
            let mut fleet = Fleet::for_one_run();
            let begun = begin(self, &mut fleet, context.log)?;
            return run_case(&begun, &mut fleet, self, context);
        };
        let mut fleet = Fleet::for_one_run();
        match resume(self, folder, &mut fleet, context.log)? {
            Some(begun) => run_case(&begun, &mut fleet, self, context),
            None => {
                let shown = folder.display();
                context.print(&format!(
                    "the run in {shown} has already finished; for a later end, run its case again \
                     with a later time.end\n"
                ))
            }
        }
    }
}

/// A planned run with its folder.
struct Begun {
    planned: Planned,
    folder: ResultFolder,
    plan_seconds: f64,
    from: Option<Checkpoint>,
}

impl RunCommand {
    fn case(&self) -> CaseArguments {
        let case = self.case.clone().expect("required unless a run is resumed");
        CaseArguments { case, changes: self.changes.clone() }
    }

    /// Logs the warnings of a plan, or refuses them before anything runs.
    fn judge(&self, planned: &Planned) -> Result<(), RunError> {
        let warnings = &planned.plan.warnings;
        if !self.strict || warnings.is_empty() {
            log_warnings(warnings);
            return Ok(());
        }
        let said = texts(warnings).join("; ");
        Err(RunError::Usage(format!("{said}; change it, or leave out --strict")))
    }

    /// Returns the folder of a planned run: the one that the user names, or the next one of the
    /// case's name.
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

fn begin(run: &RunCommand, fleet: &mut Fleet, log: &Logging) -> Result<Begun, RunError> {
    let planning = Instant::now();
    let case = run.case();
    let planned = case.plan(fleet)?;
    run.judge(&planned)?;
    let plan_seconds = planning.elapsed().as_secs_f64();
    let folder = run.folder(&planned, &case.case)?;
    log_into(&folder, log)?;
    Ok(Begun { planned, folder, plan_seconds, from: None })
}

/// Resumes a run from its newest intact checkpoint. Returns `None` for a finished run.
fn resume(
    run: &RunCommand,
    path: &Path,
    fleet: &mut Fleet,
    log: &Logging,
) -> Result<Option<Begun>, RunError> {
    let planning = Instant::now();
    let Some(stopped) = StoppedRun::read(path)? else { return Ok(None) };
    let StoppedRun { folder, checkpoint, case } = stopped;
    let planned = tracing::info_span!("plan").in_scope(|| plan(case, fleet))?;
    perform::check_origin(&checkpoint.state.origin, &perform::origin(&planned)?)?;
    run.judge(&planned)?;
    log_into(&folder, log)?;
    let plan_seconds = planning.elapsed().as_secs_f64();
    Ok(Some(Begun { planned, folder, plan_seconds, from: Some(checkpoint) }))
}

fn log_into(folder: &ResultFolder, log: &Logging) -> Result<(), RunError> {
    log.write_to(folder.log()?, folder.shown_log())
        .map_err(|error| file_failure(&folder.shown_log(), &error))
}

fn compression(word: &str) -> Result<Compression, String> {
    match word {
        "none" => Ok(Compression::None),
        "lz4" => Ok(Compression::Lz4),
        other => Err(format!("`{other}` is neither none nor lz4")),
    }
}

fn run_case(
    begun: &Begun,
    fleet: &mut Fleet,
    asked: &RunCommand,
    context: &Context<'_>,
) -> Result<(), RunError> {
    conclude(begun, compute(begun, fleet, asked, context), asked, context)
}

/// Runs a case and states its error. A target selects models and resolution, and selects them again
/// if the error turns out too large. An answer is replaced only by a complete better one.
fn run_to(asked: &RunCommand, context: &Context<'_>) -> Result<(), RunError> {
    let mut bench = Bench::new(Fleet::for_study());
    let case = asked.case();
    let (relative, quantity) = (asked.accuracy, asked.quantity.clone());
    let mut search = match asked.extrapolate {
        true => Search::extrapolate(&case, quantity, &mut bench)?,
        false => Search::begin(&case, Target { relative, quantity }, &mut bench)?,
    };
    let mut answer: Option<ResultFolder> = None;
    loop {
        let chosen = RunCommand { changes: search.variant(), ..asked.clone() };
        let begin_at = Instant::now();
        let mut begun = match &answer {
            None => begin(&chosen, &mut bench.fleet, context.log)?,
            Some(answer) => refine(&chosen, answer, &mut bench.fleet, context.log)?,
        };
        let mut outcome = compute(&begun, &mut bench.fleet, &chosen, context);
        if outcome.error.is_some() {
            return conclude(&begun, outcome, &chosen, context);
        }
        let decision = search.judge(&mut outcome.summary, begin_at.elapsed().as_secs_f64())?;
        begun.folder.write_summary(&outcome.summary)?;
        begun.folder = match answer.take() {
            None => begun.folder,
            Some(answer) => answer.take_over(begun.folder)?,
        };
        match decision {
            Decision::Refine => {
                search.refine();
                context.log.release();
                answer = Some(begun.folder);
                continue;
            }
            Decision::Missed => outcome.error = Some(search.missed()),
            Decision::Met => {}
        }
        return conclude(&begun, outcome, &chosen, context);
    }
}

/// A run that is to replace an earlier answer.
fn refine(
    run: &RunCommand,
    answer: &ResultFolder,
    fleet: &mut Fleet,
    log: &Logging,
) -> Result<Begun, RunError> {
    let planning = Instant::now();
    let planned = run.case().plan(fleet)?;
    run.judge(&planned)?;
    let plan_seconds = planning.elapsed().as_secs_f64();
    let folder = answer.refined()?;
    log_into(&folder, log)?;
    Ok(Begun { planned, folder, plan_seconds, from: None })
}

fn compute(begun: &Begun, fleet: &mut Fleet, asked: &RunCommand, context: &Context<'_>) -> Outcome {
    let Begun { planned, folder, plan_seconds, from } = begun;
    let plan = &planned.plan;
    let progress = Progress::new(context.quiet, plan.windows.count(), expected_seconds(plan));
    context.log.share_screen(progress.bar());
    let progress: Rc<dyn run::progress::Progress> = Rc::new(progress);
    let options = RunOptions {
        progress,
        since: context.since,
        plan_seconds: *plan_seconds,
        from: from.as_ref(),
        record: asked.record,
        driver: None,
    };
    let mut outcome = perform::run(planned, fleet, folder, options);
    if let Some(error) = context.log.failure() {
        outcome = outcome.fail(file_failure(&folder.shown_log(), &error), folder);
    }
    outcome
}

/// Writes the requested report, and prints the outcome of the run.
fn conclude(
    begun: &Begun,
    outcome: Outcome,
    asked: &RunCommand,
    context: &Context<'_>,
) -> Result<(), RunError> {
    let folder = &begun.folder;
    let written = if asked.report { report_on(&folder.path()) } else { Ok(()) };
    let text = || {
        let shown = folder.shown().display().to_string();
        let next = match asked.report {
            true => format!("  page      {shown}/{}\n", pages::FILE),
            false => format!("  next      coordinator report {shown}\n"),
        };
        perform::report(&outcome, &begun.planned.plan, folder) + &next
    };
    // Print the results that exist, however the run ended.
    let print_json = || output::print(&json(&outcome.summary));
    match outcome.error {
        Some(error) if asked.json => Err(error.and(written).and(print_json())),
        // The run has an answer, but a less accurate one than requested.
        Some(error @ RunError::Inaccurate { .. }) => {
            let plan = &begun.planned.plan;
            let text = show::text(&outcome.summary, plan.title.as_deref(), &plan.figures);
            let printed = context.print_lines(&text);
            Err(error.and(written).and(printed))
        }
        Some(error) => Err(error.and(written)),
        None => {
            let printed = written.and_then(|()| match asked.json {
                true => print_json(),
                false => context.print_lines(&text()),
            });
            let warnings = texts(&outcome.summary.warnings);
            match printed {
                Ok(()) if asked.strict && !warnings.is_empty() => {
                    Err(RunError::Warned { warnings })
                }
                printed => printed,
            }
        }
    }
}

fn texts(warnings: &[Warning]) -> Vec<String> {
    warnings.iter().map(Warning::to_string).collect()
}

/// Writes the report of the run in a folder.
fn report_on(folder: &Path) -> Result<(), RunError> {
    pages::write(&pages::of_run(folder)?, folder).map(drop)
}
