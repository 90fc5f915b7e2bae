//! Solvers linked into this program. They take part in a run on threads of their own, over the same
//! shared memory and protocol as processes. No process is started, and a debugger sees both sides
//! of the coupling.

use proto::model::Solver;
use proto::participant::{Host, Stop, take_part};
use std::any::Any;
use std::collections::BTreeMap;
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Arc;

/// A solver that is linked into this program.
#[derive(Clone)]
pub struct LinkedSolver(Arc<dyn Solver + Send + Sync>);

impl PartialEq for LinkedSolver {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl Eq for LinkedSolver {}

impl fmt::Debug for LinkedSolver {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("LinkedSolver")
    }
}

impl LinkedSolver {
    /// Takes part in a run until its end. Returns the exit code and last words that a process would
    /// have.
    pub(crate) fn take_part(&self, folder: &Path, role: &str, stop: Stop) -> (u8, Option<String>) {
        let part = || take_part(folder, role, &*self.0, Host::Thread(stop));
        match catch_unwind(AssertUnwindSafe(part)) {
            Ok(Ok(())) => (0, None),
            Ok(Err(error)) => (1, Some(format!("error: {error}"))),
            Err(panic) => (101, Some(format!("panicked: {}", text(&*panic)))),
        }
    }
}

/// Returns the message of a panic.
fn text(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref().copied()).unwrap_or("without a message")
}

/// Linked solvers by the command that each replaces: `ROLE-solver`, or the name and the arguments
/// in the command of a case, separated by spaces.
#[derive(Clone, Debug, Default)]
pub struct LinkedSolvers(BTreeMap<String, LinkedSolver>);

impl LinkedSolvers {
    /// Adds a solver that replaces this command.
    #[must_use]
    pub fn with(mut self, command: &str, solver: impl Solver + Send + Sync + 'static) -> Self {
        self.0.insert(command.to_owned(), LinkedSolver(Arc::new(solver)));
        self
    }

    /// Returns the solver that replaces this command.
    pub(crate) fn get(&self, command: &str) -> Option<LinkedSolver> {
        self.0.get(command).cloned()
    }
}
