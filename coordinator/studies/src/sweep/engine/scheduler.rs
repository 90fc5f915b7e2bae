//! What the schedulers have in common.

use super::tasks::Tasks;

/// A scheduler.
pub(super) trait Scheduler {
    /// Its name in messages.
    fn name(&self) -> &'static str;

    /// Submits these parts as an array; its identifier.
    fn submit(&self, tasks: &Tasks, parts: &[usize], options: &[String]) -> Result<String, String>;

    /// What its tasks do; nothing if it has ended.
    fn look(&self, array: &str) -> Result<Look, String>;

    /// Ends it.
    fn cancel(&self, array: &str) -> Result<(), String>;
}

/// What the tasks of an array do.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Look {
    /// Tasks in the queue.
    pub waiting: usize,
    /// Tasks that run.
    pub running: usize,
    /// Why the first of those that wait does.
    pub why: Option<String>,
}

impl Look {
    /// What is shown while one waits.
    pub(super) fn told(&self, scheduler: &str, array: &str) -> String {
        let why = self.why.as_ref().map_or_else(String::new, |why| format!(" ({why})"));
        let (waiting, running) = (self.waiting, self.running);
        format!("array {array} of {scheduler}: {waiting} waiting{why}, {running} running")
    }
}
