//! Slurm: `sbatch --array`, `squeue`, `scancel`.

use super::ask::{listed, text_of};
use super::scheduler::{ArrayStatus, Scheduler};
use super::tasks::Tasks;
use std::process::Command;

/// Message of `squeue` about an array that it no longer knows.
const FORGOTTEN: &str = "Invalid job id";

#[derive(Debug)]
pub(super) struct Slurm;

impl Scheduler for Slurm {
    fn name(&self) -> &'static str {
        "slurm"
    }

    fn fix(&self) -> &'static str {
        "sweep where Slurm accepts jobs, and pass what it needs with --engine-options"
    }

    fn submit(&self, tasks: &Tasks, parts: &[usize], options: &[String]) -> Result<String, String> {
        let mut sbatch = Command::new("sbatch");
        sbatch.args(["--parsable", "--open-mode=append", "--job-name"]).arg(tasks.title());
        sbatch.arg("--output").arg(tasks.log("%a"));
        sbatch.arg(format!("--array={}", listed(parts))).args(options).arg(tasks.script());
        let said = text_of(sbatch)?;
        // The output is the identifier, followed by the cluster if there are several.
        Ok(said.trim().split(';').next().unwrap_or_default().to_owned())
    }

    fn look(&self, array: &str) -> Result<ArrayStatus, String> {
        let mut squeue = Command::new("squeue");
        squeue.args(["--noheader", "--array", "--format=%T %r", "--jobs"]).arg(array);
        match text_of(squeue) {
            Ok(text) => Ok(read(&text)),
            Err(why) if why.contains(FORGOTTEN) => Ok(ArrayStatus::default()),
            Err(why) => Err(why),
        }
    }

    fn cancel(&self, array: &str) -> Result<(), String> {
        let mut scancel = Command::new("scancel");
        // Cancel the batch script as well: it is the coordinator, which then ends in order.
        scancel.arg("--full").arg(array);
        text_of(scancel).map(drop)
    }
}

/// Parses one line per task: its state and the reason for the state.
fn read(text: &str) -> ArrayStatus {
    let mut look = ArrayStatus::default();
    for line in text.lines() {
        let (state, why) = line.trim().split_once(' ').unwrap_or((line.trim(), ""));
        match state {
            "PENDING" => {
                look.waiting += 1;
                look.why.get_or_insert_with(|| why.to_owned());
            }
            "" => {}
            _ => look.running += 1,
        }
    }
    look
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_are_counted() {
        let text = "PENDING Resources\nPENDING Priority\nRUNNING None\nCOMPLETING None\n";
        assert_eq!(
            read(text),
            ArrayStatus { waiting: 2, running: 2, why: Some("Resources".to_owned()) }
        );
        assert_eq!(read("\n"), ArrayStatus::default());
    }
}
