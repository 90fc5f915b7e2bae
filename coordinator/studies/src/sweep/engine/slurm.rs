//! Slurm: `sbatch --array`, `squeue`, `scancel`.

use super::ask::{listed, text_of};
use super::scheduler::{Look, Scheduler};
use super::tasks::Tasks;
use std::process::Command;

/// What `squeue` says of an array that it has forgotten.
const FORGOTTEN: &str = "Invalid job id";

/// The scheduler.
#[derive(Debug)]
pub(super) struct Slurm;

impl Scheduler for Slurm {
    fn name(&self) -> &'static str {
        "slurm"
    }

    fn submit(&self, tasks: &Tasks, parts: &[usize], options: &[String]) -> Result<String, String> {
        let mut sbatch = Command::new("sbatch");
        sbatch.args(["--parsable", "--open-mode=append", "--job-name"]).arg(tasks.title());
        sbatch.arg("--output").arg(tasks.log("%a"));
        sbatch.arg(format!("--array={}", listed(parts))).args(options).arg(tasks.script());
        let said = text_of(sbatch)?;
        // The identifier, and the cluster where there are several.
        Ok(said.trim().split(';').next().unwrap_or_default().to_owned())
    }

    fn look(&self, array: &str) -> Result<Look, String> {
        let mut squeue = Command::new("squeue");
        squeue.args(["--noheader", "--array", "--format=%T %r", "--jobs"]).arg(array);
        match text_of(squeue) {
            Ok(text) => Ok(read(&text)),
            Err(why) if why.contains(FORGOTTEN) => Ok(Look::default()),
            Err(why) => Err(why),
        }
    }

    fn cancel(&self, array: &str) -> Result<(), String> {
        let mut scancel = Command::new("scancel");
        // The script too, which is the coordinator: it ends in order.
        scancel.arg("--full").arg(array);
        text_of(scancel).map(drop)
    }
}

/// A line a task: its state, and why it has that.
fn read(text: &str) -> Look {
    let mut look = Look::default();
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
        assert_eq!(read(text), Look { waiting: 2, running: 2, why: Some("Resources".to_owned()) });
        assert_eq!(read("\n"), Look::default());
    }
}
