//! HyperQueue: `hq submit --array`, `hq job info`, `hq job cancel`.

use super::ask::{listed, text_of};
use super::scheduler::{ArrayStatus, Scheduler};
use super::tasks::Tasks;
use serde_json::Value;
use std::process::Command;

#[derive(Debug)]
pub(super) struct HyperQueue;

impl Scheduler for HyperQueue {
    fn name(&self) -> &'static str {
        "hyperqueue"
    }

    fn fix(&self) -> &'static str {
        "start a server, and put its command `hq` on the PATH; with the Python package hyperqueue \
         alone, use --engine list (docs/how-to/run-on-a-cluster.md)"
    }

    fn submit(&self, tasks: &Tasks, parts: &[usize], options: &[String]) -> Result<String, String> {
        let mut hq = Command::new("hq");
        let log = tasks.log("%{TASK_ID}");
        hq.args(["--output-mode", "quiet", "submit", "--name"]).arg(tasks.title());
        hq.arg(format!("--array={}", listed(parts)))
            .arg("--stdout")
            .arg(&log)
            .arg("--stderr")
            .arg(&log);
        hq.args(options).arg("--").arg("sh").arg(tasks.script());
        Ok(text_of(hq)?.trim().to_owned())
    }

    fn look(&self, array: &str) -> Result<ArrayStatus, String> {
        let mut hq = Command::new("hq");
        hq.args(["--output-mode", "json", "job", "info"]).arg(array);
        read(&text_of(hq)?)
    }

    fn cancel(&self, array: &str) -> Result<(), String> {
        let mut hq = Command::new("hq");
        hq.args(["job", "cancel"]).arg(array);
        text_of(hq).map(drop)
    }
}

fn read(text: &str) -> Result<ArrayStatus, String> {
    let info: Value =
        serde_json::from_str(text).map_err(|error| format!("hq job info: {error}"))?;
    let count =
        |of: &str| info.pointer(&format!("/0/info/task_stats/{of}")).and_then(Value::as_u64);
    match (count("waiting"), count("running")) {
        (Some(waiting), Some(running)) => {
            Ok(ArrayStatus { waiting: waiting as usize, running: running as usize, why: None })
        }
        _ => Err("the output of hq job info contains no task counts".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_are_counted() {
        let text =
            r#"[{"info": {"id": 1, "task_stats": {"running": 2, "finished": 1, "waiting": 3}}}]"#;
        assert_eq!(read(text), Ok(ArrayStatus { waiting: 3, running: 2, why: None }));
        assert!(read("[]").unwrap_err().contains("no task counts"));
        assert!(read("").is_err());
    }
}
