//! Interface common to all schedulers.

use super::tasks::Tasks;

/// A scheduler of task arrays.
pub(super) trait Scheduler {
    /// Name for messages.
    fn name(&self) -> &'static str;

    /// Advice for a scheduler that accepts no array.
    fn fix(&self) -> &'static str;

    /// Submits these parts as an array and returns its identifier.
    fn submit(&self, tasks: &Tasks, parts: &[usize], options: &[String]) -> Result<String, String>;

    /// Queries the state of an array; all counts are zero after its end.
    fn look(&self, array: &str) -> Result<ArrayStatus, String>;

    /// Cancels an array.
    fn cancel(&self, array: &str) -> Result<(), String>;
}

/// State of the tasks of an array.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct ArrayStatus {
    /// Number of tasks in the queue.
    pub waiting: usize,
    /// Number of running tasks.
    pub running: usize,
    /// Reason why the first waiting task waits.
    pub why: Option<String>,
}

impl ArrayStatus {
    /// Progress text shown while waiting.
    pub(super) fn told(&self, scheduler: &str, array: &str) -> String {
        let why = self.why.as_ref().map_or_else(String::new, |why| format!(" ({why})"));
        let (waiting, running) = (self.waiting, self.running);
        format!("array {array} of {scheduler}: {waiting} waiting{why}, {running} running")
    }
}
