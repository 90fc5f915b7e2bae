//! Runs cases in this process. Linked solvers run on threads: no process is started, and a test can
//! replace a program by its own solver.

pub(crate) use tests::harness::{Table, case, field_files, flat, number, root, sets};

use crate::stopping::Stopping;
use ::case::RawCase;
use mech_solver::MechSolver;
use run::error::RunError;
use run::fleet::Fleet;
use run::linked::LinkedSolvers;
use run::perform::{self, RunOptions};
use run::plan::{Planned, plan};
use run::results::{Existing, ResultFolder};
use run::stopped::StoppedRun;
use serde_json::Value;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::time::Instant;
use tempfile::TempDir;
use tests::linear::Linear;
use tests::lumped::Lumped;
use tests::moving::Moving;
use tests::toy::Toy;
use tests::volume::Block;
use thermal_solver::ThermalSolver;
use tracing_subscriber::Layer as _;
use tracing_subscriber::filter::LevelFilter;
use tracing_subscriber::layer::SubscriberExt as _;

/// Solvers of the shipped cases, in place of their programs.
pub(crate) fn solvers() -> LinkedSolvers {
    solvers_that_stop_at(u64::MAX)
}

/// The same solvers, which find no solution in this window, counted from 0.
pub(crate) fn solvers_that_stop_at(window: u64) -> LinkedSolvers {
    LinkedSolvers::default()
        .with("mech-solver", Stopping { solver: MechSolver, window })
        .with("thermal-solver", Stopping { solver: ThermalSolver, window })
        .with("toy left", Stopping { solver: Toy::LEFT, window })
        .with("toy right", Stopping { solver: Toy::RIGHT, window })
        .with("toy operator", Stopping { solver: Linear::Operator, window })
        .with("toy relay", Stopping { solver: Linear::Relay, window })
        .with("toy source", Stopping { solver: Lumped::Source, window })
        .with("toy body", Stopping { solver: Lumped::Body, window })
        .with("toy mover", Stopping { solver: Moving::Mover, window })
        .with("toy plate", Stopping { solver: Moving::Plate, window })
        .with("toy volume", Stopping { solver: Block, window })
}

/// Runs a shipped case with these settings and asserts success. Returns the place and the summary.
pub(crate) fn completed(name: &str, settings: &[&str]) -> (Place, Value) {
    let place = Place::new();
    let summary = place.summary(&case(name), &sets(settings));
    (place, summary)
}

/// Isolated result folder of runs.
#[derive(Debug)]
pub(crate) struct Place {
    out: TempDir,
}

/// Outcome of a run, as on the command line.
#[derive(Debug)]
pub(crate) struct Ended {
    /// Exit code.
    pub(crate) code: Option<i32>,
    /// Report on the results.
    pub(crate) stdout: String,
    /// Warnings and the error.
    pub(crate) stderr: String,
}

impl From<&RunError> for Ended {
    fn from(error: &RunError) -> Self {
        let stderr = match error {
            RunError::Case(problems) => problems.render(false),
            other => format!("error: {other}"),
        };
        Self { code: Some(error.exit_code().into()), stdout: String::new(), stderr }
    }
}

impl Place {
    /// Creates a new folder.
    pub(crate) fn new() -> Self {
        Self { out: tempfile::tempdir().unwrap() }
    }

    /// Result folder.
    pub(crate) fn out(&self) -> PathBuf {
        self.out.path().join("out")
    }

    /// Runs a case to its end; changes are `--set` and `--unset`.
    pub(crate) fn run(&self, case: &str, changes: &[&str]) -> Ended {
        self.run_with(case, changes, &solvers())
    }

    /// Runs a case to its end with these solvers.
    pub(crate) fn run_with(&self, case: &str, changes: &[&str], solvers: &LinkedSolvers) -> Ended {
        self.logged(|| {
            let since = Instant::now();
            let mut fleet = Fleet::for_one_run().with(solvers.clone());
            let planned = planned(case, changes, &mut fleet)?;
            planned.plan.warnings.iter().for_each(|warning| tracing::warn!("{warning}"));
            let folder = ResultFolder::prepare(&self.out(), case.as_ref(), Existing::Replace)?;
            completed_run(&planned, &mut fleet, &folder, RunOptions::planned_since(since))
        })
    }

    /// Plans a case; the output is that of `plan`.
    pub(crate) fn plan(&self, case: &str, changes: &[&str]) -> Ended {
        self.logged(|| Ok(planned(case, changes, &mut fleet())?.plan.to_string()))
    }

    /// Resumes the run that was stopped here.
    pub(crate) fn resume(&self) -> Ended {
        self.logged(|| {
            let stopped = StoppedRun::read(&self.out())?.expect("the run has not ended");
            let StoppedRun { folder, checkpoint, case } = stopped;
            let mut fleet = fleet();
            let planned = plan(case, &mut fleet)?;
            perform::check_origin(&checkpoint.state.origin, &perform::origin(&planned)?)?;
            let options = RunOptions { from: Some(&checkpoint), ..RunOptions::default() };
            completed_run(&planned, &mut fleet, &folder, options)
        })
    }

    /// Calls `act` with a new log, which replaces an earlier one.
    fn logged(&self, act: impl FnOnce() -> Result<String, RunError>) -> Ended {
        let file = File::create(self.log_path()).unwrap();
        let layer = tracing_subscriber::fmt::layer().json().with_writer(file);
        let log = tracing_subscriber::registry().with(layer.with_filter(LevelFilter::DEBUG));
        let ended = tracing::subscriber::with_default(log, act);
        let warned = self.log().into_iter().filter(|event| event["level"] == "WARN");
        let warned =
            warned.filter_map(|e| Some(format!("warning: {}\n", e["fields"]["message"].as_str()?)));
        let warnings: String = warned.collect();
        match ended {
            Ok(stdout) => Ended { code: Some(0), stdout, stderr: warnings },
            Err(error) => {
                let failed = Ended::from(&error);
                Ended { stderr: warnings + &failed.stderr, ..failed }
            }
        }
    }

    fn log_path(&self) -> PathBuf {
        self.out.path().join("log.jsonl")
    }

    /// Text of the report page of the last run.
    pub(crate) fn page(&self) -> String {
        let folder = self.out();
        let written = pages::write(&pages::of_run(&folder).unwrap(), &folder).unwrap();
        std::fs::read_to_string(written).unwrap()
    }

    /// Events of the last run.
    pub(crate) fn log(&self) -> Vec<Value> {
        let text = std::fs::read_to_string(self.log_path()).unwrap();
        text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
    }

    /// Runs a case, asserts success and returns the summary.
    pub(crate) fn summary(&self, case: &str, changes: &[&str]) -> Value {
        let ended = self.run(case, changes);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        let summary = self.read_summary();
        assert_eq!(summary["schema"], 1);
        let status = summary["status"].as_str().unwrap();
        assert!(["completed", "converged"].contains(&status), "{status}");
        summary
    }

    /// Reads `summary.json` of the last run.
    pub(crate) fn read_summary(&self) -> Value {
        let text = std::fs::read(self.out().join("summary.json")).unwrap();
        serde_json::from_slice(&text).unwrap()
    }

    /// Reads a table of the results, by its path in the result folder.
    pub(crate) fn table(&self, file: &str) -> Table {
        Table::read(&self.out().join(file))
    }
}

/// Answers like `check` of a case with this file name and text.
pub(crate) fn checked(name: &str, text: &str) -> Ended {
    let planned = RawCase::parse(name, text).map_err(RunError::from);
    match planned.and_then(|raw| plan(raw, &mut fleet())) {
        Err(error) => Ended::from(&error),
        Ok(planned) => {
            let warnings = planned.plan.warnings.iter();
            let warnings: String =
                warnings.map(|warning| format!("warning: {warning}\n")).collect();
            let stdout = format!("{warnings}{name}: no errors\n");
            Ended { code: Some(0), stdout, stderr: String::new() }
        }
    }
}

/// Returns a fleet with the linked solvers.
pub(crate) fn fleet() -> Fleet {
    Fleet::for_one_run().with(solvers())
}

/// Plans a case with changes, each preceded by `--set` or `--unset`.
pub(crate) fn planned(
    case: &str,
    changes: &[&str],
    fleet: &mut Fleet,
) -> Result<Planned, RunError> {
    let mut raw = RawCase::read(Path::new(case))?;
    let (mut set, mut unset) = (Vec::new(), Vec::new());
    for [option, change] in changes.as_chunks().0 {
        match *option {
            "--set" => set.push((*change).to_owned()),
            "--unset" => unset.push((*change).to_owned()),
            other => panic!("`{other}` is an option of the command line"),
        }
    }
    raw.apply(&set, &unset)?;
    plan(raw, fleet)
}

fn completed_run(
    planned: &Planned,
    fleet: &mut Fleet,
    folder: &ResultFolder,
    options: RunOptions<'_>,
) -> Result<String, RunError> {
    let mut outcome = perform::run(planned, fleet, folder, options);
    match outcome.error.take() {
        Some(error) => Err(error),
        None => Ok(perform::report(&outcome, &planned.plan, folder)),
    }
}
